//! The drag of a damped motion, a force against all displacements since the last accepted state, and its derivative.
//!
//! ```text
//! −d (u − u_accepted),   d = c / Δt      ([`crate::step`], damped motion)
//! ```

use super::sizes::{BalancedQuantity, Sizes};
use super::source::LinearisationPoint;
use crate::Model;

/// Degrees of freedom with a drag: all free displacements.
fn dragged<'a>(model: &'a Model, sizes: &'a Sizes) -> impl Iterator<Item = (usize, usize)> + 'a {
    let kinds = sizes.kind.iter().zip(&model.dofs.equation).enumerate();
    kinds.filter_map(|(dof, (kind, equation))| {
        let displaced = *kind == BalancedQuantity::Force;
        equation.filter(|_| displaced).map(|e| (dof, e))
    })
}

/// Adds the drag to the load on every degree of freedom.
pub fn add_drag(model: &Model, at: &LinearisationPoint<'_>, sizes: &Sizes, load: &mut [f64]) {
    let Some(drag) = at.drag else { return };
    for (dof, _) in dragged(model, sizes) {
        load[dof] -= drag * (at.u[dof] - at.accepted.u[dof]);
    }
}

/// Adds its derivative to a stiffness; `place` maps an equation to the index of its diagonal entry.
pub fn stiffen(
    model: &Model,
    at: &LinearisationPoint<'_>,
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
