//! Shape functions and integration rules.
//!
//! - [`lagrange`]: interpolation on curves, and Gauss points; [`quadrature`]: integration rules for triangles and squares.
//! - [`kinds`]: the continuum elements, one file each: nodes, faces, shape functions, rule, VTK cell type.

pub mod kinds;
pub mod lagrange;
pub mod quadrature;
