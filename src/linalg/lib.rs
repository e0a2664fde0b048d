//! Linear systems: patterns, factors, checked solves. The only package that uses faer.
//!
//! - [`Factors`]: sparse LU of square matrices, mainly the augmented system of eqn (9); `fronts`, `front`, `tree`, `graph` and
//!   `dissection` implement its multifrontal factorization;
//! - [`SymmetricFactors`]: sparse LDLᵀ of the bodies alone, which also condenses them to their interface (eqn 6); `supernodes` and
//!   `subtrees` are its structure and its factorization, on the threads of an [`executor::Executor`];
//! - [`DenseFactors`]: dense LU of the small interface systems.
//!
//! faer reports a singular matrix as success and returns infinities, so every solve is checked (`check`).

#![forbid(unsafe_code)]

mod check;
mod dense;
mod dissection;
pub mod executor;
mod front;
mod fronts;
mod graph;
mod lu;
mod order;
mod pattern;
mod registers;
mod substitution;
mod subtrees;
mod supernodes;
mod symmetric;
mod tree;

pub use check::{SolveError, largest};
pub use dense::{DenseFactors, subtract_product};
pub use lu::Factors;
pub use pattern::Pattern;
pub use registers::vectorise;
pub use symmetric::SymmetricFactors;
