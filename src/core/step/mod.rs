//! The two-level solver as a stepper: one call, one minor iteration, one event.
//!
//! - [`stepper`]: the algorithm box; [`state`]: plain data from which everything goes on; [`event`]: what a minor
//!   iteration did, typed.
//! - `minor`, `major`, `increment`: the three levels; `search`: what happens where the modes do not settle.
//! - [`sub_increment`]: increments whole and cut; [`detour`]: ways round one whose halves all fail; `jump`: those that
//!   end on another branch of equilibrium; `verdict`: what becomes of a state that the judge refuses.
//! - [`brake`], `hold`: sliding that is held back, where nothing else has helped.
//! - `arc`: increments of arc length, the load factor an unknown; [`way`]: how far they have come;
//!   `turn`: corners of the path, where contacts change their modes.
//! - `damped`: damped motion past a limit point; [`motion`]: what it carries along.
//! - [`major_history`]: cycles of major iterations.
//! - [`solver`]: the seam above the stepper, for whatever else can be stepped; `outside`: states of such a solver;
//!   [`places`]: the tree of those that it has had.
//! - [`drive`]: the one loop over minor iterations; [`intervene`]: what a user changes in between, which is an [`intervention`].

mod arc;
pub mod brake;
mod damped;
pub mod detour;
pub mod drive;
pub mod event;
mod hold;
mod increment;
pub mod intervene;
pub mod intervention;
mod jump;
mod major;
pub mod major_history;
mod minor;
pub mod motion;
mod outside;
pub mod pace;
pub mod places;
mod search;
pub mod solver;
pub mod state;
pub mod stepper;
pub mod sub_increment;
mod turn;
mod verdict;
pub mod watch;
pub mod way;

#[cfg(test)]
mod tests;

pub use drive::{RunEnd, Until};
pub use event::{Event, Failure, Outcome};
pub use solver::Solver;
pub use state::{State, Status};
pub use stepper::Stepper;
