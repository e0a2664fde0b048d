//! The linearised equations of a major iteration, behind a seam.
//!
//! - [`source`]: what the stepper needs of what deforms; [`bodies`]: our own bodies as one; [`constant`]: a constant
//!   interface response as another.
//! - `system`: the bodies' system about a state; `residual`: its out-of-balance forces; [`norms`] of them; `sizes`: what is
//!   large, what is nothing, and what double precision leaves.
//! - `augmented` (eqn 9) and `reduced` (eqn 6): the two ways to solve a minor iteration; `condensation`: the bodies
//!   condensed; `condensed`: the interface alone; `coupling`: a contact's part of the equations; `point_forces` and `partners`: contacts
//!   on elements with local flexibility; `ordering`: the order of elimination; `bordered` and `border`: the load factor as an additional
//!   unknown; `drag`: resistance of a damped motion.
//! - [`singular`]: why there is no solution; [`stability`]: which way a state of equilibrium leads, by its `tangent`;
//!   [`estimate`]: what a scene takes of time and memory.

mod augmented;
pub mod bodies;
mod border;
mod bordered;
mod condensation;
pub mod condensed;
pub mod constant;
mod coupling;
mod drag;
pub mod estimate;
pub mod norms;
mod ordering;
mod partners;
mod point_forces;
mod reduced;
mod residual;
pub mod singular;
pub mod sizes;
pub mod source;
pub mod stability;
mod system;
mod tangent;
pub mod violation;
