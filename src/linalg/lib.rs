//! Linear systems: patterns, factors, checked solves. The only files that name faer.
//!
//! - [`Factors`]: sparse LU of anything square, the augmented system of eqn (9) above all; `fronts`, `front`,
//!   `tree`, `graph` and `dissection`: the way in which that is factored;
//! - [`SymmetricFactors`]: sparse LDLᵀ of the bodies alone, condensed to their interface (eqn 6) on the way;
//! - [`DenseFactors`]: LU of the interface's own small systems.
//!
//! faer reports a singular matrix as success and returns infinities, so every solve is checked (`check`).

#![forbid(unsafe_code)]

mod check;
mod dense;
mod dissection;
mod front;
mod fronts;
mod graph;
mod lu;
#[cfg(mutants)]
pub mod mutants;
mod order;
mod pattern;
mod symmetric;
mod tree;

pub use check::SolveError;
pub use dense::{DenseFactors, subtract_product};
pub use lu::Factors;
pub use pattern::Pattern;
pub use symmetric::SymmetricFactors;
