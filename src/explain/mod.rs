//! Explanations: what happened, why, and what could be done about it, in the words that the command line and the debugger
//! share.
//!
//! - [`names`]: the words for things; [`number`]: numbers for a person; [`report`]: sentences about what happened; [`judged`]: about what the judge found.
//! - [`influence`]: who pushed whom; [`core`]: the fewest nodes that still cycle; [`diagnosis`]: why a cycle goes round;
//!   [`smaller`]: whether a smaller increment has a consistent state, where one has none.
//! - [`examination`]: all of that at a state; [`remedies`]: every way out, tried.
//! - [`audit`]: the judge's findings over a history; [`outline`]: the shape of a state as lines.

pub mod audit;
pub mod core;
pub mod diagnosis;
pub mod examination;
pub mod influence;
pub mod judged;
pub mod names;
pub mod number;
pub mod outline;
pub mod remedies;
pub mod report;
pub mod smaller;
