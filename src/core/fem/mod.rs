//! The bodies: shape functions, quadrature, materials, elements, and their assembly.

pub mod assembly;
pub mod beam;
pub mod lagrange;
pub mod material;
pub mod matrix;
pub mod quad8;
