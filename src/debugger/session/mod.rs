//! A session of the debugger, without a terminal: commands in, frames out.
//!
//! - [`machine`]: the state machine itself: what it holds, and how commands are begun and ended. What they do stands
//!   beside it by subject: going through the history (`motion`), interfering (`change`), what lists are kept of (`lists`),
//!   what is written (`writing`), what is asked beside the run (`questions`).
//! - [`worker`]: the thread that solves; [`background`]: the one that looks closer, [`exports`]: what it makes files of.
//! - `kept`: a session on what an attached solver did, as a file keeps it.
//! - `diary`: where what was done is kept; [`replay`]: doing it again; [`refusal`]: why something is not done.

pub mod background;
mod change;
mod diary;
pub mod exports;
mod kept;
mod lists;
pub mod machine;
mod motion;
mod questions;
pub mod refusal;
pub mod replay;
pub mod worker;
mod writing;

pub use machine::{Reply, Session};
pub use refusal::Refusal;
