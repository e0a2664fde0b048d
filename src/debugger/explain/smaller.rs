//! Whether a smaller increment has a consistent state where an increment has none. That is found out, not supposed: a
//! scene may have none however small the increment.

use crate::explain::diagnosis::undecided;
use stickslip_core::interface::census::census;
use stickslip_core::step::intervene::Intervention;
use stickslip_core::step::state::State;
use stickslip_core::step::stepper::Stepper;

/// How often the increment is halved in search of a consistent state.
const HALVINGS: i32 = 6;

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Smaller {
    /// An increment of this size has a consistent state, as the bodies are linearised at its start.
    Found(f64),
    /// None has, halved down to this size.
    None(f64),
}

impl Smaller {
    /// In words.
    pub fn words(&self) -> String {
        match self {
            Smaller::Found(size) => {
                format!("a smaller increment has a consistent state: one of {size} has")
            }
            Smaller::None(size) => {
                format!(
                    "nor has a smaller increment a consistent state: none, halved down to {size}"
                )
            }
        }
    }
}

/// Looks for a consistent state at smaller increments from where the present one of a state starts. `None` if that cannot
/// be told. The stepper is left anywhere.
pub fn smaller(stepper: &mut Stepper, state: &State) -> Option<Smaller> {
    let size = (state.load_factor - state.start.load_factor).abs();
    let mut smallest = size;
    for halvings in 1..=HALVINGS {
        smallest = size / 2f64.powi(halvings);
        stepper.restore(state);
        stepper.intervene(&Intervention::Increment(smallest)).ok()?;
        let problem = stepper.interface_problem()?;
        let problem = problem.reduced(&undecided(&problem))?;
        if !census(&problem).ok()?.answers.is_empty() {
            return Some(Smaller::Found(smallest));
        }
    }
    Some(Smaller::None(smallest))
}
