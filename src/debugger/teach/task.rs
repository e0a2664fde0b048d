//! A task: a state to reach by any means except some. The solver's state decides, not the keys.

use super::frame_values::FrameValues;
use super::quantity::Template;
use super::spec::Aid;
use crate::Frame;
use crate::action::Action;
use stickslip_core::{Intervention, Status, Strategy};
use stickslip_scene::{joined, shortest};

/// Relative difference of load factors that counts as none.
const SAME_LOAD: f64 = 1e-9;

/// The reply if the task is a failure and the history ends without one.
const NOTHING_FAILS: &str =
    "This history reaches its end: nothing fails here. Begin the lesson on a scene that fails.";

/// A task.
#[derive(Debug, Clone)]
pub struct LessonTask {
    /// The task, in words.
    pub text: Template,
    /// What to reach.
    pub goal: Goal,
    /// What must not be used on the way.
    pub without: Vec<Aid>,
    /// Shown on request.
    pub hint: Template,
    /// Shown when the goal is reached.
    pub then: Template,
    /// Actions that reach it; used to play lessons automatically.
    pub solution: Vec<Action>,
}

/// What a task asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// An accepted increment at this load factor.
    Load(f64),
    /// The end of the history.
    End,
    /// A failed increment.
    Failure,
}

impl LessonTask {
    /// Checks the frames up to the shown one. Returns the reply if the goal is reached.
    ///
    /// # Errors
    /// If it is reached with a forbidden aid, if it can no longer be reached, or if the reply has an unknown number.
    pub(super) fn check(
        &self,
        frames: &[Frame],
        look: &FrameValues,
    ) -> Result<Option<String>, String> {
        let frame = &look.frame;
        if !self.goal.is_reached(frame) {
            let nothing_fails =
                self.goal == Goal::Failure && frame.state.status == Status::Finished;
            return if nothing_fails {
                Err(NOTHING_FAILS.into())
            } else {
                Ok(None)
            };
        }
        let used = self.without.iter().find(|aid| uses(**aid, frames));
        if let Some(aid) = used {
            return Err(format!(
                "You are there, but with {}. Go back to before that and try without it.",
                aid.words()
            ));
        }
        let then = self.then.fill(look, "").map_err(|why| why.to_string())?;
        Ok(Some(format!("Done. {then}").trim_end().to_owned()))
    }

    /// The goal in words, with the key of the hint.
    pub(super) fn todo(&self) -> String {
        let goal = match self.goal {
            Goal::Load(load) => format!("reach load {}", shortest(load)),
            Goal::End => "reach the end of the history".into(),
            Goal::Failure => "run until an increment fails".into(),
        };
        format!("your turn: {goal}{}; H hint", without(&self.without))
    }
}

impl Goal {
    fn is_reached(self, frame: &Frame) -> bool {
        match self {
            Goal::Load(load) => {
                let accepted = frame
                    .event
                    .as_ref()
                    .is_some_and(|event| event.outcome.is_accepted());
                let reached = frame.state.start.load_factor;
                accepted && (reached - load).abs() <= SAME_LOAD * load.abs().max(1.0)
            }
            Goal::End => frame.state.status == Status::Finished,
            Goal::Failure => matches!(frame.state.status, Status::Failed(_)),
        }
    }
}

/// Whether an aid was used in these frames.
fn uses(aid: Aid, frames: &[Frame]) -> bool {
    let intervened = |is: fn(&Intervention) -> bool| {
        frames
            .iter()
            .any(|frame| frame.intervention.as_ref().is_some_and(is))
    };
    match aid {
        Aid::Ladder => frames
            .iter()
            .any(|frame| frame.state.controls.settings.strategy == Strategy::Ladder),
        Aid::Force => {
            intervened(|i| matches!(i, Intervention::Force { .. } | Intervention::Assume(_)))
        }
        Aid::Friction => {
            intervened(|i| matches!(i, Intervention::Friction(_) | Intervention::Frictions(_)))
        }
        Aid::Increment => intervened(|i| matches!(i, Intervention::Increment(_))),
        Aid::Settings => intervened(|i| matches!(i, Intervention::Settings(_))),
    }
}

/// What a task excludes, in words; empty if nothing.
fn without(aids: &[Aid]) -> String {
    let words: Vec<&str> = aids.iter().map(|aid| aid.words()).collect();
    match words.split_last() {
        None => String::new(),
        Some((only, [])) => format!(" without {only}"),
        Some((last, others)) => format!(" without {} or {last}", joined(others, ", ")),
    }
}
