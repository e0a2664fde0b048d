//! stickslip-core: the two-level iteration for contact and friction of El-Sawy & Moore (1996), as a resumable stepper.
//!
//! It knows no file format, no terminal and no threads. The map of the house, from the ground up: each line uses those
//! above it and none below.
//!
//! - [`model`]: what to solve: bodies, surfaces, contacts, loads, and the choices of the method.
//! - [`fem`]: elements, materials, and their assembly.
//! - [`contact`]: one slave node and its surface: projection, Table 1, T_max, Table 2, and the judge of the laws.
//! - [`interface`]: all contacts of one major iteration, the bodies frozen to a response: minor iterations, pivoting,
//!   census.
//! - [`linear`]: the linearised equations behind the seam [`linear::source::Source`].
//! - [`strategy`]: how the next modes are chosen, one file a strategy.
//! - [`step`]: the stepper: increments, major iterations, minor iterations, one per call.

pub mod contact;
pub mod fem;
pub mod interface;
pub mod linear;
pub mod model;
pub mod step;
pub mod strategy;

pub use stickslip_linalg as linalg;
