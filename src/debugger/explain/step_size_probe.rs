//! Checks whether a smaller increment has a consistent state if the current one has none. A scene may have
//! none, however small the increment.

use crate::explain::diagnosis::undecided;
use stickslip_core::interface::census::census;
use stickslip_core::{Intervention, State, Stepper};
use stickslip_scene::shortest;

/// Maximum number of halvings of the increment.
const HALVINGS: i32 = 6;

/// Describes whether a smaller increment from the start of a state's current one has a consistent state, with the bodies linearised
/// at its start. `None` if unknown. The stepper's final state is unspecified.
pub fn smaller(stepper: &mut Stepper, state: &State) -> Option<String> {
    let size = (state.load_factor - state.start.load_factor).abs();
    let mut smallest = size;
    for halvings in 1..=HALVINGS {
        smallest = size / 2f64.powi(halvings);
        stepper.restore(state);
        stepper.intervene(&Intervention::Increment(smallest)).ok()?;
        let problem = stepper.interface_problem()?;
        let problem = problem.reduced(&undecided(&problem))?;
        if !census(&problem).ok()?.answers.is_empty() {
            let size = shortest(smallest);
            return Some(format!(
                "a smaller increment of {size} has a consistent state"
            ));
        }
    }
    let size = shortest(smallest);
    Some(format!(
        "smaller increments have no consistent state either (halved down to {size})"
    ))
}
