//! The linearised equations of a major iteration.

mod bodies;
pub mod condensed;
mod coupling;
pub mod estimate;
pub mod norms;
pub mod singular;
mod sizes;
pub mod system;
