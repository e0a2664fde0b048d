//! The bodies: shape functions, quadrature, materials, elements, and their assembly.
//!
//! - [`lagrange`]: interpolation on curves, and Gauss points; [`quadrature`]: rules over triangles and squares.
//! - [`kinds`]: the continuum elements, one file each: places, shape functions, rule; [`continuum`]: them by name.
//! - [`isoparametric`]: one formulation for all of them, finite strains; [`small`]: about rest.
//! - [`material`]: stress from strain; [`deformation`]: det F and stretches of elements, and the range of each law.
//! - [`beam`]: beams; [`truss`]: bars; [`matrix`]: bodies that are given by a matrix, sparse as they come.
//! - [`pressure`]: loads that follow the faces they act on; [`recovery`]: stresses for output.
//! - [`element`]: what an element is to the assembly; [`assembly`]: all of them in one system.

pub mod assembly;
pub mod beam;
pub mod continuum;
pub mod deformation;
pub mod element;
pub mod isoparametric;
pub mod kinds;
pub mod lagrange;
pub mod material;
pub mod matrix;
pub mod pressure;
pub mod quadrature;
pub mod recovery;
pub mod small;
pub mod truss;

#[cfg(test)]
mod tests;
