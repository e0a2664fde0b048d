//! Which actions an attached solver supports, and why not the others. Keys, help and completions are greyed,
//! and commands are refused, from this list only.

use super::context::Context;
use super::meaning::{Action, ChartOf, Page, Question, Ui};
use super::table::{ActionEntry, Verb};
use crate::record::export;
use crate::{Command, ExportScope};
use stickslip_core::{Capabilities, Friction, Intervention, Mode};

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

impl Need {
    /// Checks the need; `None` is our own solver.
    fn check(self, solver: Option<&Capabilities>) -> Result<(), String> {
        match (solver, self) {
            (None, Need::Attached) => {
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
            Need::Force => takes(force(false)),
            Need::Hold => takes(force(true)),
            Need::ForceOrHold => takes(force(false)).or_else(|why| takes(force(true)).map_err(|_| why)),
            Need::Increment => takes(Intervention::Increment(1.0)),
            Need::Friction if !offers.friction => has(false, "a friction change"),
            Need::Friction => takes(Intervention::Friction(Friction::default())),
            Need::Cohesion => has(offers.cohesion, "a cohesion change"),
            Need::Settings => has(offers.settings, "settings of the two-level method"),
            Need::Parameters => has(!offers.parameters.is_empty(), "parameters that can be set"),
            Need::Cures if offers.cures => Ok(()),
            Need::Problem | Need::Cures => has(offers.problem, "its interface problem"),
            Need::Answers => has(offers.problem, "its interface problem").and_then(|()| takes(force(false))),
            Need::Chart => Err(
                "charts can be measured only on scenes that stickslip solves itself (:chart FILE shows a table)".into(),
            ),
            Need::Scene => Err(
                "the scene is known only to the solver; `export --frozen` writes its interface problem, if the solver offers it"
                    .into(),
            ),
            Need::Journal => offers.past.map_or(Ok(()), |record| Err(format!("{record}: it does not need a journal"))),
            Need::Attached => Ok(()),
        }
    }

    fn from_verb(verb: &Verb) -> Option<Need> {
        Some(match verb {
            Verb::Force { hold: false } => Need::ForceOrHold,
            Verb::Force { hold: true } => Need::Hold,
            Verb::Release => Need::ForceOrHold,
            Verb::Increment => Need::Increment,
            Verb::SetPath(path) => return Need::from_path(path),
            Verb::Set => Need::Parameters,
            Verb::StartFrom => Need::Answers,
            Verb::Apply | Verb::Census => Need::Problem,
            Verb::Export {
                what: ExportScope::Core,
                ..
            } => Need::Problem,
            Verb::Chart => Need::Chart,
            Verb::Journal => Need::Journal,
            Verb::Do(ui) => return Need::from_ui(ui),
            _ => return None,
        })
    }

    fn from_path(path: &str) -> Option<Need> {
        match path {
            "friction.angle" => Some(Need::Friction),
            "friction.cohesion" => Some(Need::Cohesion),
            path if path.starts_with("settings.") => Some(Need::Settings),
            _ => None,
        }
    }

    fn from_ui(ui: &Ui) -> Option<Need> {
        Some(match ui {
            Ui::Ask(Question::Mode) => Need::ForceOrHold,
            Ui::Ask(Question::Increment) => Need::Increment,
            Ui::Page(Page::Remedies) => Need::Cures,
            Ui::Apply(_) => Need::Problem,
            Ui::StartFrom(_) => Need::Answers,
            Ui::Chart(ChartOf::Scene | ChartOf::Settings(_)) => Need::Chart,
            Ui::Log | Ui::Parameters => Need::Attached,
            _ => return None,
        })
    }

    fn from_command(command: &Command) -> Option<Need> {
        Some(match command {
            Command::Force { hold: false, .. } => Need::Force,
            Command::Force { hold: true, .. } => Need::Hold,
            Command::Release { .. } => Need::ForceOrHold,
            Command::Increment(_) => Need::Increment,
            Command::Set { path, .. } => return Need::from_path(path),
            Command::Assume(_) => Need::Answers,
            Command::Census(_) | Command::Remedies => Need::Problem,
            Command::Journal(_) => Need::Journal,
            Command::Export {
                what: ExportScope::Core | ExportScope::Whole,
                ..
            } => Need::Problem,
            Command::Export { file, .. } => match export::kind(file) {
                Ok(kind) if kind.extension == "ron" => Need::Scene,
                Ok(kind) if kind.may_be_frozen => Need::Problem,
                _ => return None,
            },
            _ => return None,
        })
    }
}

impl ActionEntry {
    /// Whether the current solver supports this action, without arguments.
    ///
    /// # Errors The reason why not.
    pub fn offered(&self, context: &Context) -> Result<(), String> {
        Need::from_verb(&self.verb).map_or(Ok(()), |need| need.check(context.offers))
    }
}

impl Action {
    /// Whether the current solver supports this action.
    ///
    /// # Errors The reason why not.
    pub fn offered(&self, context: &Context) -> Result<(), String> {
        let need = match self {
            Action::Session(command) => Need::from_command(command),
            Action::Ui(ui) => Need::from_ui(ui),
        };
        need.map_or(Ok(()), |need| need.check(context.offers))
    }
}
