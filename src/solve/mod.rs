//! The two-level solver as a stepper: one call, one minor iteration, one event.

pub mod event;
pub mod state;

pub use event::{Event, Failure, Forced, NodeRecord, Norms, Outcome, Position};
pub use state::State;
