//! stickslip-core: the two-level iteration for contact and friction of El-Sawy & Moore (1996), as a resumable stepper.

pub mod contact;
pub mod fem;
pub mod interface;
pub mod linear;
pub mod model;
pub mod step;
pub mod strategy;

pub use stickslip_linalg as linalg;
