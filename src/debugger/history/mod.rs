//! The history of a session: frames, and the tree of branches that they form.
//!
//! - [`frame`]: a point of the history in full; [`strip`]: the compact record of a point, which is never
//!   discarded.
//! - [`tree`]: the branches, within a memory budget; [`branches`]: their names and cost; [`compare`]: two of
//!   them side by side; [`verdicts`]: how each one ended.
//! - [`rounds`]: whether the modes on a line repeat; [`run_report`]: the report of a finished run.
//! - [`breakpoints`]: where a run stops; [`watches`]: quantities to observe.

pub mod branches;
pub mod breakpoints;
pub mod compare;
pub mod frame;
pub mod rounds;
pub mod run_report;
pub mod strip;
pub mod tree;
pub mod verdicts;
pub mod watches;
