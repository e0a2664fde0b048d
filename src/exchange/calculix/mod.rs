//! Files of CalculiX.
//!
//! - [`stiffness`]: the stiffness matrix that it stores.

pub mod stiffness;
