//! Measures how far the forces depend on where nodes are held that touch within an increment.
//!
//! `touch: auto` holds them where their straight path meets the surface (ρ, eqn 14) if a body is a mesh; an implicit step
//! of Coulomb's law, as in other codes, holds them at the projection of their starting point (`touch: start`). The
//! increment of a run in which nodes with the largest friction limit touched is solved again with `touch: start`, and the
//! forces are compared.

use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip_core::{
    ContactState, Event, Intervention, Mode, Model, Outcome, RunEnd, State, Stepper, Touch, Until,
};

/// Smallest reported difference of forces, relative to the largest force.
const TOLD: f64 = 1e-4;
/// Maximum number of minor iterations in the increment solved again.
const MOST_MINORS: u64 = 1000;

/// Watches a run for the increment that depends most on the point of first contact.
pub struct TouchWatch {
    /// The state at the start of the current increment.
    start: State,
    /// Current increment and attempt, and the nodes that touched in it.
    attempt: (u32, u32),
    touched: Vec<bool>,
    decided: Option<TouchDecision>,
}

/// An increment in which nodes touched.
struct TouchDecision {
    start: State,
    increment: u32,
    load: f64,
    /// The largest friction limit of a node that touched (force).
    limit: f64,
    /// Forces on the slave nodes (Cartesian) at its end.
    forces: Vec<[f64; 2]>,
}

/// Result of an increment with `touch: start`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TouchDifference {
    /// The increment.
    pub increment: u32,
    /// The largest difference of a force on a slave node, relative to the largest such force; `None` if the increment does
    /// not converge in one attempt.
    pub forces: Option<f64>,
}

impl TouchWatch {
    /// Starts to watch a run from a state.
    pub fn new(start: &State) -> TouchWatch {
        TouchWatch {
            start: start.clone(),
            attempt: (0, 0),
            touched: vec![false; start.nodes.len()],
            decided: None,
        }
    }

    /// Records the event of a minor iteration and the state after it.
    pub fn see(&mut self, event: &Event, state: &State) {
        let at = event.position;
        if self.attempt != (at.increment, at.attempt) {
            self.attempt = (at.increment, at.attempt);
            self.touched.fill(false);
        }
        let found = event.nodes.iter().zip(&state.nodes);
        for (touched, (record, node)) in self.touched.iter_mut().zip(found) {
            let entered = record.decision.before == Mode::Free && node.mode != Mode::Free;
            *touched |= entered && node.ratio != 0.0;
        }
        let Outcome::Increment { jumped, motion, .. } = event.outcome else {
            return;
        };
        let limit = self
            .touched
            .iter()
            .zip(&event.nodes)
            .map(|(touched, record)| match touched {
                true if record.decision.next != Mode::Free => record.t_max.abs(),
                _ => 0.0,
            })
            .fold(0.0, f64::max);
        let most = self.decided.as_ref().map_or(0.0, |decided| decided.limit);
        if limit > most && !jumped && motion.is_none() {
            self.decided = Some(TouchDecision {
                start: self.start.clone(),
                increment: at.increment,
                load: event.load_factor,
                limit,
                forces: forces(state),
            });
        }
        self.start.clone_from(state);
    }

    /// Solves the recorded increment again; `None` if no node touched, or if the forces agree.
    pub fn measure(&self, model: &Arc<Model>) -> Option<TouchDifference> {
        let decided = self.decided.as_ref()?;
        let mut stepper = Stepper::new(model.clone());
        stepper.restore(&decided.start);
        let mut settings = decided.start.controls.settings;
        settings.touch = Touch::Start;
        stepper.intervene(&Intervention::Settings(settings)).ok()?;
        let until = Until::end().minors(MOST_MINORS);
        let end = stepper.drive(until, |stepper| match stepper.event().outcome {
            Outcome::Increment { .. } => ControlFlow::Break(true),
            Outcome::Cut { .. } | Outcome::WholeIncrement { .. } | Outcome::Fallback { .. } => {
                ControlFlow::Break(false)
            }
            _ => ControlFlow::Continue(()),
        });
        let accepted = matches!(end, RunEnd::Stopped(true) | RunEnd::Finished);
        let same = accepted && stepper.event().load_factor == decided.load;
        let difference = same.then(|| difference(&decided.forces, &forces(stepper.state())));
        let counts = difference.is_none_or(|difference| difference > TOLD);
        counts.then_some(TouchDifference {
            increment: decided.increment,
            forces: difference,
        })
    }
}

/// Forces on the slave nodes (Cartesian).
fn forces(state: &State) -> Vec<[f64; 2]> {
    state.nodes.iter().map(ContactState::force).collect()
}

/// The largest difference, relative to the largest force in `ours`.
fn difference(ours: &[[f64; 2]], theirs: &[[f64; 2]]) -> f64 {
    let largest = ours.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
    ours.iter()
        .zip(theirs)
        .map(|([a, b], [x, y])| (a - x).hypot(b - y))
        .fold(0.0, f64::max)
        / largest.max(f64::MIN_POSITIVE)
}

impl TouchDifference {
    /// Describes the difference and how to avoid it.
    pub fn words(&self) -> String {
        let start = "touch: start (one implicit step of Coulomb's law)";
        let what = match self.forces {
            Some(forces) => format!(
                "with {start}, increment {} has contact forces that differ by {:.2} % of the largest",
                self.increment,
                100.0 * forces
            ),
            None => format!(
                "with {start}, increment {} does not converge at once",
                self.increment
            ),
        };
        format!("{what}; to compare with other codes, use --set settings.touch=start")
    }
}
