//! Checks equilibrium at every node, and of the bodies as a whole with their reactions.
//!
//! At every node, r = internal force − load − contact force. r vanishes at free degrees of freedom and is the reaction at
//! restrained ones. Internal forces are invariant under rigid motions, so their sum and the sum of their moments vanish; the same
//! then holds for the reactions and the loads together.

use crate::model::Body;
use crate::{Finding, JudgedLaw, JudgedNumbers, Model, Scales, Verdict};

/// Forces by degree of freedom ([`crate::model::Dofs`]), and the contact forces by node.
#[derive(Debug, Clone, Copy)]
pub struct Forces<'a> {
    /// Internal forces of the elements; in equilibrium they equal the loads.
    pub internal: &'a [f64],
    /// Loads at the current load factor.
    pub load: &'a [f64],
    /// Interaction forces on each node, slave or master (x, y).
    pub contact: &'a [[f64; 2]],
}

/// Adds to `verdict` the worst node of [`JudgedLaw::Balance`] and the sum of [`JudgedLaw::Moments`]; `now` are the positions of all nodes.
/// Bodies given by a matrix are not checked as a whole, because the matrix may contain supports.
pub fn check(
    model: &Model,
    forces: &Forces,
    now: &[[f64; 2]],
    scales: &Scales,
    verdict: &mut Verdict,
) {
    let dofs = &model.dofs;
    let small = model.bodies.iter().all(Body::is_small);
    let (mut worst, mut total) = ((0.0_f64, None), Total::default());
    for (node, (&first, &count)) in dofs.first.iter().zip(&dofs.count).enumerate() {
        let mut bears = [0.0; 3];
        for (k, bears) in bears.iter_mut().enumerate().take(count as usize) {
            let dof = first + k;
            let contact = forces.contact[node].get(k).copied().unwrap_or(0.0);
            *bears = forces.internal[dof] - forces.load[dof] - contact;
            let lever = if k < 2 { 1.0 } else { scales.length };
            let amount = bears.abs() / lever / scales.force;
            if dofs.equation[dof].is_some() && (amount > worst.0 || amount.is_nan()) {
                worst = (amount, Some(node));
            }
        }
        let at = |k: usize| forces.internal[first + k];
        let moment = if count > 2 { at(2) } else { 0.0 };
        // With small displacements, equilibrium refers to the undeformed shape.
        let place = if small {
            model.nodes[node].at
        } else {
            now[node]
        };
        total.add(place, [at(0), at(1)], moment);
    }
    let slave = |node| model.contacts.iter().position(|s| s.node == node);
    verdict.add(Finding {
        law: JudgedLaw::Balance,
        slave: worst.1.and_then(slave),
        amount: worst.0,
        allowed: scales.allowed(JudgedLaw::Balance),
        numbers: JudgedNumbers::default(),
    });
    // The matrix of a body may contain supports. If small and large displacements are mixed, there is no common shape for the
    // moments.
    if model.bodies.iter().any(Body::is_linear)
        || (!small && model.bodies.iter().any(Body::has_small_part))
    {
        return;
    }
    verdict.add(Finding {
        law: JudgedLaw::Moments,
        slave: None,
        amount: total.size(scales.length, model.is_axisymmetric()) / scales.force,
        allowed: scales.allowed(JudgedLaw::Moments),
        numbers: JudgedNumbers::default(),
    });
}

/// Sum of forces, and of their moments about `middle`.
#[derive(Debug, Clone, Copy, Default)]
struct Total {
    force: [f64; 2],
    moment: f64,
    /// Mean point of application, so that a large distance from the origin does not cause round-off in the moments.
    middle: [f64; 2],
    count: f64,
}

impl Total {
    fn add(&mut self, at: [f64; 2], force: [f64; 2], moment: f64) {
        for k in 0..2 {
            self.force[k] += force[k];
            self.middle[k] += at[k];
        }
        self.moment += moment + at[0] * force[1] - at[1] * force[0];
        self.count += 1.0;
    }

    /// The larger of the force and the moment about the middle divided by a length; in axisymmetry only the axial force, because
    /// the others balance around the axis.
    fn size(&self, length: f64, axisymmetric: bool) -> f64 {
        if axisymmetric {
            return self.force[1].abs();
        }
        let [x, y] = self.middle.map(|sum| sum / self.count.max(1.0));
        let moment = self.moment - (x * self.force[1] - y * self.force[0]);
        let [f_x, f_y] = self.force;
        (moment.abs() / length).max((f_x * f_x + f_y * f_y).sqrt())
    }
}
