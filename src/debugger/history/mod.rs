//! What was done so far: frames, and the tree of branches that they make.
//!
//! - [`frame`]: a point of the history in full; [`strip`]: what is kept of every point, whatever happens to its frame.
//! - [`tree`]: the branches and their memory; [`branches`]: their names and costs; [`compare`]: two of them side by side;
//!   [`verdicts`]: how each ended.
//! - [`rounds`]: whether the modes of a line go round.
//! - [`breakpoints`], [`watches`]: where a run stops, and what is looked at.

pub mod branches;
pub mod breakpoints;
pub mod compare;
pub mod frame;
pub mod rounds;
pub mod strip;
pub mod tree;
pub mod verdicts;
pub mod watches;
