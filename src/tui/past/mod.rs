//! A CalculiX run that is over, to be looked at: the debugger's timeline, residuals and keys on what its files tell.
//!
//! - [`app`]: what a key does; [`actions`]: which of the debugger's actions there are here.
//! - [`screen`]: the whole screen, from its [`panes`].
//! - [`run`](mod@run): the terminal.

pub mod actions;
pub mod app;
pub mod panes;
pub mod run;
pub mod screen;

pub use run::{picture, run};
