//! The bodies: shape functions, quadrature, elements, and their assembly.

pub mod assembly;
pub mod beam;
pub mod lagrange;
