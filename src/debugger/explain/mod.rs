//! Explanations: what happened, why, and what could be done about it, in the words that the command line and the debugger
//! share.
//!
//! - [`names`]: the words for things; [`round_off`]: which of them are nothing; [`report`]: sentences about what happened; [`judged`]: about what the judge found.
//! - [`influence`]: who pushed whom; [`core`]: the fewest nodes that still cycle; [`diagnosis`]: why a cycle goes round;
//!   [`smaller`]: whether a smaller increment has a consistent state, where one has none.
//! - [`proven`]: what a matrix proves: one state at most, and where T_max goes while the modes repeat; [`indefinite`]: whether
//!   it is indefinite by rounding, and what comes of it without.
//! - [`advice`]: what to do about a failure; [`remedy`]: what can be tried; [`remedies`]: every way out, tried.
//! - [`attempt`]: the attempt that failed, seen again; [`majors`]: why its major iterations do not end; [`loose`]: what moves
//!   where nothing holds it; [`strain`]: solids outside the range of their law; [`reach`]: up to which load there is an answer;
//!   [`finer`]: whether a finer mesh has one; [`restart`]: a changed scene, tried from its start.
//! - [`touch`]: how far the forces depend on where touching nodes are held.
//! - [`examination`]: the frozen problem at a state; [`page`]: all of that, as the debugger shows it.
//! - [`attached`]: the same of a solver of another's, from the problem that it offers; [`pushes_told`]: who pushed whom there.
//! - [`audit`]: the judge's findings over a history; [`outline`]: the shape of a state as lines.

pub mod accuracy;
pub mod advice;
pub mod attached;
pub mod attempt;
pub mod audit;
pub mod bond;
pub mod core;
pub mod diagnosis;
pub mod examination;
pub mod finer;
pub mod indefinite;
pub mod influence;
pub mod judged;
pub mod jumped;
pub mod limit_load;
pub mod loose;
pub mod majors;
pub mod names;
pub mod outline;
pub mod page;
pub mod proven;
pub mod pushes_told;
pub mod reach;
pub mod remedies;
pub mod remedy;
pub mod report;
pub mod restart;
pub mod round_off;
pub mod smaller;
pub mod strain;
pub mod touch;
