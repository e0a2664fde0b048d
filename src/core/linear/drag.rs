//! The drag of a damped motion: a force against every displacement since the last accepted state, and its derivative.
//!
//! ```text
//! −d (u − u_accepted),   d = c / Δt      ([`crate::step`], damped motion)
//! ```

use super::sizes::{Balanced, Sizes};
use super::source::At;
use crate::model::Model;

/// Degrees of freedom with a drag: displacements that have an equation.
fn dragged<'a>(model: &'a Model, sizes: &'a Sizes) -> impl Iterator<Item = (usize, usize)> + 'a {
    let kinds = sizes.kind.iter().zip(&model.dofs.equation).enumerate();
    kinds.filter_map(|(dof, (kind, equation))| {
        let displaced = *kind == Balanced::Force;
        equation.filter(|_| displaced).map(|e| (dof, e))
    })
}

/// Adds the drag to the load at every degree of freedom.
pub fn add_drag(model: &Model, at: &At<'_>, sizes: &Sizes, load: &mut [f64]) {
    let Some(drag) = at.drag else { return };
    for (dof, _) in dragged(model, sizes) {
        load[dof] -= drag * (at.u[dof] - at.accepted.u[dof]);
    }
}

/// Adds its derivative to a stiffness whose diagonal is found by `place`, by equation.
pub fn stiffen(
    model: &Model,
    at: &At<'_>,
    sizes: &Sizes,
    place: impl Fn(usize) -> Option<usize>,
    stiffness: &mut [f64],
) {
    let Some(drag) = at.drag else { return };
    for (_, equation) in dragged(model, sizes) {
        if let Some(slot) = place(equation) {
            stiffness[slot] += drag;
        }
    }
}
