//! The interface problem of one major iteration, by itself: geometry and stiffness frozen, no bodies in sight.

pub mod census;
pub mod kinematics;
pub mod lemke;
pub mod minor;
pub mod problem;
pub mod response;
