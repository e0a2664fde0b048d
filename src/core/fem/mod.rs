//! The bodies: materials, elements and assembly.
//!
//! - [`continuum`]: continuum elements of each kind ([`kinds`]).
//! - [`isoparametric`]: their common formulation for finite strains; [`small`]: linear elasticity.
//! - [`material`]: stress-strain laws; [`deformation`]: det F and stretches of elements, and the range of each law.
//! - [`beam`]: beams; [`truss`]: bars; [`matrix`]: bodies given by a sparse matrix.
//! - [`pressure`]: following pressures; [`recovery`]: stresses for output.
//! - [`element`]: the element interface; [`assembly`]: assembles all elements into one system.

mod assembled;
pub mod assembly;
pub mod beam;
pub mod continuum;
pub mod deformation;
pub mod element;
pub mod isoparametric;
pub mod material;
pub mod matrix;
pub mod pressure;
pub mod recovery;
pub mod small;
pub mod truss;

pub use crate::elements::{kinds, lagrange, quadrature};

#[cfg(test)]
mod tests;
