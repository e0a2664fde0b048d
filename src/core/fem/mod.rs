//! The bodies: shape functions, quadrature, materials, elements and assembly.
//!
//! - [`lagrange`]: interpolation on curves, and Gauss points; [`quadrature`]: integration rules for triangles and squares.
//! - [`kinds`]: the continuum elements, one file each: node positions, shape functions, rule; [`continuum`]: access by name.
//! - [`isoparametric`]: their common formulation for finite strains; [`small`]: linear elasticity.
//! - [`material`]: stress-strain laws; [`deformation`]: det F and stretches of elements, and the range of each law.
//! - [`beam`]: beams; [`truss`]: bars; [`matrix`]: bodies given by a sparse matrix.
//! - [`pressure`]: following pressures; [`recovery`]: stresses for output.
//! - [`element`]: the element interface; [`assembly`]: assembles all elements into one system.

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
