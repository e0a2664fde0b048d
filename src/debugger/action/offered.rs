//! Which actions an attached solver supports, and why not the others. Keys, help and completions are greyed,
//! and commands are refused, from this list only.

use super::context::Context;
use super::meaning::{Action, ChartOf, Page, Question, Ui};
use super::table::{ActionEntry, Verb};
use crate::explain::names;
use crate::record::export;
use crate::{Command, ExportScope};
use stickslip_core::{Capabilities, Forced, Intervention, Mode};

/// What an action needs of the current solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Need {
    /// Forcing a mode for one iteration.
    Force,
    /// Holding a mode.
    Hold,
    /// Either of the two.
    ForceOrHold,
    Increment,
    Friction,
    Cohesion,
    /// The settings of the two-level method.
    Settings,
    /// Anything that `set` changes.
    Parameters,
    /// The frozen interface problem.
    Problem,
    /// The same, or a finished run, whose diagnosis has the cures.
    Cures,
    /// The frozen interface problem, with forced modes to start from its states.
    Answers,
    /// A scene that can be solved repeatedly.
    Chart,
    /// A scene that can be written to a file.
    Scene,
    /// A run that can continue and be recorded.
    Journal,
    /// An attached solver with a log.
    Attached,
}

use Need::*;

impl Need {
    /// Checks the need; `None` is our own solver.
    fn check(self, solver: Option<&Capabilities>) -> Result<(), String> {
        match (solver, self) {
            (None, Attached) => {
                Err("only attached solvers (`stickslip attach`) have a log and parameters".into())
            }
            (None, _) => Ok(()),
            (Some(offers), need) => need.of(offers),
        }
    }

    fn of(self, offers: &Capabilities) -> Result<(), String> {
        let takes = |one: Intervention| offers.check(&one).map_err(|why| why.to_string());
        let has = |has: bool, what: &str| if has { Ok(()) } else { Err(offers.lacks(what)) };
        let force = |hold: bool| Intervention::Force {
            slave: 0,
            mode: Mode::Free,
            hold,
        };
        match self {
            Force => takes(force(false)),
            Hold => takes(force(true)),
            ForceOrHold => takes(force(false)).or_else(|why| takes(force(true)).map_err(|_| why)),
            Increment => takes(Intervention::Increment(1.0)),
            Friction if !offers.friction => has(false, "a friction change"),
            Friction => takes(Intervention::Friction(Default::default())),
            Cohesion => has(offers.cohesion, "a cohesion change"),
            Settings => has(offers.settings, "settings of the two-level method"),
            Parameters => has(!offers.parameters.is_empty(), "parameters that can be set"),
            Cures if offers.cures => Ok(()),
            Problem | Cures => has(offers.problem, "its interface problem"),
            Answers => has(offers.problem, "its interface problem").and_then(|()| takes(force(false))),
            Chart => Err(
                "charts can be measured only on scenes that stickslip solves itself (:chart FILE shows a table)".into(),
            ),
            Scene => Err(
                "the scene is known only to the solver; `export --frozen` writes its interface problem, if the solver offers it"
                    .into(),
            ),
            Journal => offers.past.map_or(Ok(()), |record| Err(format!("{record}: it does not need a journal"))),
            Attached => Ok(()),
        }
    }

    fn from_verb(verb: &Verb) -> Option<Need> {
        Some(match verb {
            Verb::Force { hold: false } => ForceOrHold,
            Verb::Force { hold: true } => Hold,
            Verb::Release => ForceOrHold,
            Verb::Increment => Increment,
            Verb::SetPath(path) => return Need::from_path(path),
            Verb::Set => Parameters,
            Verb::StartFrom => Answers,
            Verb::Apply | Verb::Census => Problem,
            Verb::Export {
                what: ExportScope::Core,
                ..
            } => Problem,
            Verb::Chart => Chart,
            Verb::Journal => Journal,
            Verb::Do(ui) => return Need::from_ui(ui),
            _ => return None,
        })
    }

    fn from_path(path: &str) -> Option<Need> {
        match path {
            "friction.angle" => Some(Friction),
            "friction.cohesion" => Some(Cohesion),
            path if path.starts_with("settings.") => Some(Settings),
            _ => None,
        }
    }

    fn from_ui(ui: &Ui) -> Option<Need> {
        Some(match ui {
            Ui::Ask(Question::Mode) => ForceOrHold,
            Ui::Ask(Question::Increment) => Increment,
            Ui::Page(Page::Remedies) => Cures,
            Ui::Apply(_) => Problem,
            Ui::StartFrom(_) => Answers,
            Ui::Chart(ChartOf::Scene | ChartOf::Settings(_)) => Chart,
            Ui::Log | Ui::Parameters => Attached,
            _ => return None,
        })
    }

    fn from_command(command: &Command) -> Option<Need> {
        Some(match command {
            Command::Force { hold: false, .. } => Force,
            Command::Force { hold: true, .. } => Hold,
            Command::Release { .. } => ForceOrHold,
            Command::Increment(_) => Increment,
            Command::Set { path, .. } => return Need::from_path(path),
            Command::Assume(_) => Answers,
            Command::Census(_) | Command::Remedies => Problem,
            Command::Journal(_) => Journal,
            Command::Export {
                what: ExportScope::Core | ExportScope::Whole,
                ..
            } => Problem,
            Command::Export { file, .. } => match export::kind(file) {
                Ok(kind) if kind.extension == "ron" => Scene,
                Ok(kind) if kind.may_be_frozen => Problem,
                _ => return None,
            },
            _ => return None,
        })
    }
}

impl ActionEntry {
    /// Whether the current solver supports this action, without arguments.
    ///
    /// # Errors
    /// The reason why not.
    pub fn offered(&self, context: &Context) -> Result<(), String> {
        Need::from_verb(&self.verb).map_or(Ok(()), |need| need.check(context.offers))
    }
}

impl Action {
    /// Whether the current solver supports this action, and it changes something.
    ///
    /// # Errors
    /// The reason why not.
    pub fn offered(&self, context: &Context) -> Result<(), String> {
        if let Action::Session(Command::Release { slave }) = self {
            released(*slave, context)?;
        }
        let need = match self {
            Action::Session(command) => Need::from_command(command),
            Action::Ui(ui) => Need::from_ui(ui),
        };
        need.map_or(Ok(()), |need| need.check(context.offers))
    }
}

/// Refuses to release a node that is not forced. Allowed before an intervention, because the release then starts a branch without
/// that intervention, and with an attached solver, which may not report all that it holds.
fn released(slave: usize, context: &Context) -> Result<(), String> {
    let (Some(state), Some(model), None) = (context.state, context.model, context.offers) else {
        return Ok(());
    };
    let is_followed = context.next.is_some_and(|next| next.intervention.is_some());
    match state.nodes.get(slave).map(|node| node.forced) {
        Some(Forced::No) if !is_followed => {
            Err(format!("{} is not forced", names::slave(model, slave)))
        }
        _ => Ok(()),
    }
}
