//! What an attached solver offers, and what it does not, with the reason: the one place that greys keys, help and completions, and
//! that refuses what is asked for all the same.

use super::context::Context;
use super::meaning::{Action, ChartOf, Page, Question, Ui};
use super::table::{Entry, Verb};
use crate::record::command::{Command, Exported};
use crate::record::export;
use stickslip_core::model::{Friction, Mode};
use stickslip_core::step::intervene::Intervention;
use stickslip_core::step::solver::Offers;

/// What an action needs of the solver that is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Need {
    /// A mode can be forced once.
    Force,
    /// A mode can be held.
    Hold,
    /// One of the two.
    ForceOrHold,
    Increment,
    Friction,
    Cohesion,
    /// Settings of the two-level method.
    Settings,
    /// Something that `set` changes.
    Parameters,
    /// The frozen interface problem.
    Problem,
    /// The same, and its answers can be sent as forces.
    Answers,
    /// A scene that is measured again and again.
    Chart,
    /// A scene as a file of its own.
    Scene,
    /// A run that goes on, and can be written down.
    Journal,
    /// A solver that is attached, and says something besides.
    Attached,
}

impl Need {
    /// Whether it is met; `None` is a solver of our own.
    fn check(self, solver: Option<&Offers>) -> Result<(), String> {
        match (solver, self) {
            (None, Need::Attached) => Err(
                "this is our own solver, which has no messages and no parameters of its own; `stickslip attach` steps another"
                    .into(),
            ),
            (None, _) => Ok(()),
            (Some(offers), need) => need.of(offers),
        }
    }

    fn of(self, offers: &Offers) -> Result<(), String> {
        let takes = |one: Intervention| offers.check(&one).map_err(|why| why.to_string());
        let has = |has: bool, what: &str| match has {
            true => Ok(()),
            false => Err(offers.lacks(what)),
        };
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
            Need::Friction if !offers.friction => has(false, "another friction"),
            Need::Friction => takes(Intervention::Friction(Friction::default())),
            Need::Cohesion => has(offers.cohesion, "another cohesion"),
            Need::Settings => has(offers.settings, "settings of the two-level method"),
            Need::Parameters => has(!offers.parameters.is_empty(), "parameters that can be set"),
            Need::Problem => has(offers.problem, "its interface problem"),
            Need::Answers => has(offers.problem, "its interface problem").and_then(|()| takes(force(false))),
            Need::Chart => Err(
                "a chart is measured on scenes that stickslip solves itself (:chart FILE shows a table)".into(),
            ),
            Need::Scene => Err(
                "the scene is the solver's own, and no file of ours; `export --frozen` writes its interface problem, where it offers that"
                    .into(),
            ),
            Need::Journal => offers.past.map_or(Ok(()), |record| Err(format!("{record}: it is its own journal"))),
            Need::Attached => Ok(()),
        }
    }

    fn of_verb(verb: &Verb) -> Option<Need> {
        Some(match verb {
            Verb::Force { hold: false } => Need::ForceOrHold,
            Verb::Force { hold: true } => Need::Hold,
            Verb::Release => Need::ForceOrHold,
            Verb::Increment => Need::Increment,
            Verb::SetPath(path) => return Need::of_path(path),
            Verb::Set => Need::Parameters,
            Verb::StartFrom => Need::Answers,
            Verb::Apply | Verb::Census => Need::Problem,
            Verb::Export {
                what: Exported::Core,
                ..
            } => Need::Problem,
            Verb::Chart => Need::Chart,
            Verb::Journal => Need::Journal,
            Verb::Do(ui) => return Need::of_ui(ui),
            _ => return None,
        })
    }

    fn of_path(path: &str) -> Option<Need> {
        match path {
            "friction.angle" => Some(Need::Friction),
            "friction.cohesion" => Some(Need::Cohesion),
            path if path.starts_with("settings.") => Some(Need::Settings),
            _ => None,
        }
    }

    fn of_ui(ui: &Ui) -> Option<Need> {
        Some(match ui {
            Ui::Ask(Question::Mode) => Need::ForceOrHold,
            Ui::Ask(Question::Increment) => Need::Increment,
            Ui::Page(Page::Remedies) | Ui::Apply(_) => Need::Problem,
            Ui::StartFrom(_) => Need::Answers,
            Ui::Chart(ChartOf::Scene | ChartOf::Settings(_)) => Need::Chart,
            Ui::Log | Ui::Parameters => Need::Attached,
            _ => return None,
        })
    }

    fn of_command(command: &Command) -> Option<Need> {
        Some(match command {
            Command::Force { hold: false, .. } => Need::Force,
            Command::Force { hold: true, .. } => Need::Hold,
            Command::Release { .. } => Need::ForceOrHold,
            Command::Increment(_) => Need::Increment,
            Command::Set { path, .. } => return Need::of_path(path),
            Command::Assume(_) => Need::Answers,
            Command::Census(_) | Command::Remedies => Need::Problem,
            Command::Journal(_) => Need::Journal,
            Command::Export {
                what: Exported::Core | Exported::Whole,
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

impl Entry {
    /// Whether the solver that is open offers what this needs, as it stands without arguments.
    ///
    /// # Errors
    /// Why not.
    pub fn offered(&self, context: &Context) -> Result<(), String> {
        Need::of_verb(&self.verb).map_or(Ok(()), |need| need.check(context.offers))
    }
}

impl Action {
    /// Whether the solver that is open offers what this needs.
    ///
    /// # Errors
    /// Why not.
    pub fn offered(&self, context: &Context) -> Result<(), String> {
        let need = match self {
            Action::Session(command) => Need::of_command(command),
            Action::Ui(ui) => Need::of_ui(ui),
        };
        need.map_or(Ok(()), |need| need.check(context.offers))
    }
}
