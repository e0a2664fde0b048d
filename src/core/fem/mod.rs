//! The bodies: shape functions, quadrature, materials, elements, and their assembly.
//!
//! - [`element`]: what an element is to the assembly; [`beam`], [`quad8`]: one file an element; [`continuum`]: the kinds
//!   of continuum elements; [`matrix`]: bodies that are given by a matrix, sparse as they come.
//! - [`material`]: stress by strain; [`lagrange`]: interpolation on curves, and quadrature.
//! - [`assembly`]: all of them in one system.

pub mod assembly;
pub mod beam;
pub mod continuum;
pub mod element;
pub mod lagrange;
pub mod material;
pub mod matrix;
pub mod quad8;

#[cfg(test)]
mod tests;
