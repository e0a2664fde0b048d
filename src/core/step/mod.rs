//! The two-level solver as a stepper: one call, one minor iteration, one event.

pub mod event;
pub mod intervene;
mod jump;
pub mod major_history;
pub mod minor_history;
pub mod state;
pub mod stepper;
pub mod sub_increment;
mod verdict;
