//! The debugger as a state machine without a terminal: commands in, frames out.
//!
//! - [`session`]: the history and a cursor in it; [`command`]: what it can be told.
//! - [`tree`]: the history's branches and its memory; [`strip`]: what is kept of every iteration; [`branches`] and
//!   [`compare`]: how branches ended, and two side by side.
//! - [`journal`]: the record of a session, written as it happens, and replayed; [`story`]: it as text to read.
//! - [`breakpoints`], [`watches`]: where a run stops, and what is looked at.
//! - [`looks`]: what is found out beside the run: who pushed whom, censuses, and [`remedies`] tried.
//! - [`smaller`]: whether a smaller increment has a consistent state, where one has none.
//! - [`snapshot`]: recorded states; [`differences`]: what differs between two; [`files`]: how anything is written.
//! - [`core`]: the fewest nodes that still cycle; [`export`]: they, or the whole frozen problem, as a scene of their own.
//! - [`lesson`]: guided lessons, and free mode.
//! - [`report`]: what happened, in words; [`judged`]: what the judge found; [`audit`]: over a history.

pub mod audit;
pub mod branches;
pub mod breakpoints;
pub mod command;
pub mod compare;
pub mod core;
pub mod diagnosis;
pub mod differences;
pub mod export;
pub mod files;
pub mod influence;
pub mod journal;
pub mod judged;
pub mod lesson;
pub mod looks;
pub mod remedies;
pub mod report;
pub mod session;
pub mod smaller;
pub mod snapshot;
pub mod story;
pub mod strip;
pub mod tree;
pub mod watches;
mod worker;
