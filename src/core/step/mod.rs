//! The two-level solver as a stepper: one call, one minor iteration, one event.
//!
//! - [`stepper`]: the algorithm box; [`state`]: plain data from which everything goes on; [`event`]: what a minor
//!   iteration did, typed.
//! - `minor`, `major`, `increment`: the three levels; `search`: what happens where the modes do not settle.
//! - [`sub_increment`]: increments whole and cut; `jump`: those that end on another branch of equilibrium; `verdict`: what
//!   becomes of a state that the judge refuses.
//! - [`recovery`]: how an increment that failed is tried again, one file for each way.
//! - `arc`: increments of arc length, the load factor an unknown; [`way`]: how far they have come.
//! - [`major_history`]: cycles of major iterations.
//! - [`solver`]: the seam above the stepper, for whatever else can be stepped; `outside`: states of such a solver;
//!   [`places`]: the tree of those that it has had.
//! - [`drive`]: the one loop over minor iterations; [`intervene`]: what a user changes in between, which is an [`intervention`].

mod arc;
pub mod drive;
pub mod event;
mod increment;
pub mod intervene;
pub mod intervention;
mod jump;
mod major;
pub mod major_history;
mod minor;
mod outside;
pub mod pace;
pub mod places;
pub mod recovery;
mod search;
pub mod solver;
pub mod state;
pub mod stepper;
pub mod sub_increment;
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
