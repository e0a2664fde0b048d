//! The linearised equations of a major iteration, behind the trait [`source::Source`].
//!
//! - [`source`]: what the stepper needs from the deformable part; [`bodies`]: the program's bodies as a source; [`sparse`]:
//!   contacts with a sparse compliance as a source, and [`sparse_contacts`], which recognises them.
//! - `system`: the linearised system of the bodies; `residual`: its out-of-balance forces; [`norms`]: their norms; `sizes`: force
//!   scales and round-off levels.
//! - `augmented` (eqn 9) and `reduced` (eqn 6): the two methods for minor iterations; `condensation`: condenses the bodies;
//!   `condensed`: the interface alone; `coupling`: a contact's part of the equations; `point_forces` and `partners`: contacts on
//!   elements with local flexibility; `ordering`: elimination order; `bordered` and `border`: the load factor as an additional
//!   unknown; `drag`: resistance of a damped motion.
//! - [`singular`]: explains a singular system; [`stability`]: stability of an equilibrium state, from its `tangent`;
//!   [`estimate`]: estimated time and memory of a scene.

mod augmented;
pub mod bodies;
mod border;
mod bordered;
mod condensation;
pub mod condensed;
mod coupling;
mod drag;
pub mod estimate;
mod far_masters;
pub mod norms;
mod ordering;
mod partners;
mod point_forces;
mod reduced;
mod residual;
pub mod singular;
pub mod sizes;
pub mod source;
pub mod sparse;
pub mod sparse_contacts;
pub mod stability;
mod system;
mod tangent;
pub mod violation;
