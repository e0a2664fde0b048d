//! The two-level solver as a stepper: one call, one minor iteration, one event.
//!
//! - [`stepper`]: the algorithm box; [`state`]: the plain data that determine all later iterations; [`event`]: typed record of a
//!   minor iteration.
//! - `minor`, `major`, `increment`: the three levels; `search`: next strategies, if the modes do not converge.
//! - [`sub_increment`]: whole and cut increments; `jump`: increments that end on another branch of equilibrium; `verdict`:
//!   handles states that the judge refuses.
//! - [`recovery`]: retries of failed increments, one method per file.
//! - `arc`: arc-length increments, with the load factor as an unknown; [`arc_state`]: their data.
//! - [`major_history`]: cycles of major iterations.
//! - [`solver`]: the interface of everything that can be stepped; `external_state`: states of attached solvers; [`stored_states`]: the tree of
//!   these states.
//! - [`cone_solver`]: sweeps over an interface problem in space; [`judged`]: the contact laws, checked with reported numbers.
//! - [`drive`]: the loop over minor iterations; [`intervene`]: applies an [`intervention`] of the user.

mod arc;
pub mod arc_state;
pub mod cone_solver;
pub mod drive;
pub mod event;
mod external_state;
mod increment;
pub mod intervene;
pub mod intervention;
mod iterate;
pub mod judged;
mod jump;
mod major;
pub mod major_history;
mod minor;
pub mod pace;
pub mod recovery;
mod search;
pub mod solver;
pub mod state;
pub mod stepper;
pub mod stored_states;
pub mod sub_increment;
mod verdict;
pub mod watch;

#[cfg(test)]
mod tests;

pub use drive::{RunEnd, Until};
pub use event::{Event, Failure, Outcome};
pub use solver::Solver;
pub use state::{State, Status};
pub use stepper::Stepper;
