//! The interface between slave nodes and master surfaces.
//!
//! - [`projection`]: where a slave node stands over its surface: S*, gap, normal, shape functions.
//! - [`turning`]: how the force turns and travels with the surface, for the tangent.
//! - [`anchor`]: where a stuck node stuck, and how far it has drifted from there.
//! - [`table1`]: the equations that a node adds in each of the three modes, and T_max (eqn 20).
//! - [`corner`]: where two sides of a master meet at an angle; [`feet`]: all points of a chain that are closest to another.
//! - [`judge`] and [`balance`]: whether a state obeys the laws, from positions and forces alone.
//! - [`decision`]: Table 2, the mode that a node takes next, with the reason; [`strategy`]: what else may choose it.

pub mod anchor;
pub mod balance;
pub mod corner;
pub mod decision;
pub mod feet;
pub mod judge;
pub mod projection;
pub mod strategy;
pub mod table1;
pub mod turning;
