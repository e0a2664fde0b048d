//! The interface problem of one major iteration, by itself: geometry and stiffness frozen, no bodies in sight.
//!
//! - [`problem`]: the problem, and its answer to one assumption of what every node does; [`response`]: how its forces
//!   answer motions; [`kinematics`]: how a node stands over its surface.
//! - [`minor`]: one minor iteration at one node; [`method`]: what a strategy decides in it; [`minor_history`]: what went
//!   into the minor iterations so far, and cycles of them; [`cycle`]: what closes a cycle of any iterations.
//! - [`census`], [`lemke`], [`copositive`] and [`sweep`]: what finds a consistent state, all nodes together; [`tableau`]: how
//!   the two of pivoting pivot; [`vertex`]: from forces that are not unique to some that are; [`branches`] and [`feasible`]:
//!   what cannot be consistent, which a census of many nodes leaves out.
//! - [`spiral`]: where T_max goes while the modes repeat.
//! - [`uniqueness`]: whether the matrix alone allows no second state; [`family`]: states that differ in their forces alone;
//!   [`definite`]: the eigenvalues of the compliance, and what is left of the problem without the negative ones.

pub mod branches;
pub mod census;
pub mod copositive;
pub mod cycle;
pub mod definite;
pub mod family;
pub mod feasible;
pub mod kinematics;
pub mod lemke;
pub mod method;
pub mod minor;
pub mod minor_history;
pub mod problem;
pub mod response;
pub mod rows;
pub mod spiral;
pub mod sweep;
pub mod tableau;
pub mod trials;
pub mod uniqueness;
pub mod vertex;
