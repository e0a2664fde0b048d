//! What to solve: the scene file and the checked model made of it.

pub mod model;
pub mod spec;

pub use model::Model;
pub use spec::{Friction, Mode, Settings, Spec};
