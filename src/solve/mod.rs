//! The two-level solver as a stepper: one call, one minor iteration, one event.
//!
//! - [`state`]: plain data from which everything goes on; [`stepper`]: the state machine over it.
//! - [`system`]: the linearised equations of a major iteration; `interface`: a slave node's part of them; `bodies`: the
//!   bodies condensed; `condensed`: the interface alone; [`singular`]: why there is no solution.
//! - [`minor`]: a minor iteration at one slave node; [`frozen`]: the interface problem by itself.
//! - [`census`] and [`lemke`]: what finds a consistent state of it, all nodes together.
//! - `jump`: increments that end on another branch of equilibrium.
//! - `place`: where the slave nodes stand; `verdict`: what becomes of a state that the judge refuses.
//! - `sizes`: what is large, what is nothing, and what double precision leaves.
//! - [`rounds`]: cycles of major iterations.
//! - [`intervene`]: what a user changes in between; [`event`]: what a minor iteration did, typed.

mod bodies;
pub mod census;
pub mod condensed;
pub mod event;
pub mod frozen;
mod interface;
pub mod intervene;
mod jump;
pub mod lemke;
pub mod minor;
mod place;
pub mod rounds;
pub mod singular;
mod sizes;
pub mod state;
pub mod stepper;
pub mod system;
mod verdict;

pub use event::{Event, Failure, Forced, NodeRecord, Norms, NotFound, Outcome, Position};
pub use intervene::{Intervention, Start};
pub use state::{State, Status};
pub use stepper::Stepper;
