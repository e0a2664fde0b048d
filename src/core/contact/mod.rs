//! The interface between slave nodes and master surfaces.

pub mod balance;
mod closest_history;
pub mod closest_points;
pub mod corner;
pub mod crossing;
pub mod element;
pub mod facing;
pub mod geometric_tangent;
pub mod judge;
pub mod laws;
pub mod point_force;
pub mod projection;
pub mod record;
mod side_laws;
pub mod smooth;
pub mod state;
pub mod stick_point;
pub mod table1;
pub mod table2;
pub mod tracking;

#[cfg(test)]
mod tests;
