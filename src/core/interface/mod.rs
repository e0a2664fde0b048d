//! The interface problem of one major iteration, with frozen geometry and stiffness and without the bodies.
//!
//! - [`problem`]: the problem, and its solution for a combination of modes; [`response`]: dependence of its forces on motions;
//!   [`kinematics`]: position of a node relative to its surface.
//! - [`minor`]: a minor iteration at one node; [`method`]: the strategy's decisions in it; [`minor_history`]: inputs of the minor
//!   iterations so far, and their cycles; [`cycle`]: cycle detection for any iterations.
//! - [`blocks`]: a sparse compliance; [`census`], [`pivoting`] and [`sweep`]: searches for a consistent state over all nodes; [`tableau`]: pivoting
//!   for two of them; [`vertex`]: selects unique forces if they are not unique; [`branches`] and [`feasible`]: rule out
//!   inconsistent combinations in a census of many nodes.
//! - [`cone`], `cone_law`, [`cone_census`]: problems in space, with friction cones.
//! - [`t_max_iteration`]: evolution of T_max while the modes repeat.
//! - [`uniqueness`]: whether the matrix alone excludes a second state; [`family`]: states that differ only in their forces;
//!   [`definite`]: eigenvalues of the compliance, and the problem without negative ones.

pub mod blocks;
pub mod branches;
pub mod census;
pub mod cone;
pub mod cone_census;
mod cone_law;
pub mod cycle;
pub mod definite;
pub mod family;
pub mod feasible;
pub mod kinematics;
pub mod line_search;
pub mod method;
pub mod minor;
pub mod minor_history;
pub mod pivoting;
pub mod problem;
pub mod response;
pub mod rows;
pub mod sweep;
pub mod t_max_iteration;
pub mod tableau;
pub mod trials;
pub mod uniqueness;
pub mod vertex;
