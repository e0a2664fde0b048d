//! Who pushed whom: what the changes at other nodes did to one node's gap and forces, from one minor iteration to the next.
//!
//! On the frozen interface problem both iterations are linear systems that differ only in the equations of the nodes
//! that changed. With M the matrix of the later one, and δ_j the amount by which the earlier answer misses row j of it,
//! the answers differ by `Σ_j M⁻¹ e_j δ_j`, exactly: each term is what node j's change did.

use crate::contact::state::ContactState;
use crate::contact::table1::{Equation, Motion};
use crate::interface::kinematics::NodeIncrement;
use crate::interface::minor;
use crate::interface::problem::{InterfaceProblem, Trials};

/// What one node's change did to another node.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Influence {
    /// Place of the node that changed.
    pub from: usize,
    /// Change of the other node's gap and slip (length) and forces that is due to it.
    pub gap: f64,
    pub slip: f64,
    pub f_n: f64,
    pub f_t: f64,
}

/// What the change of every node did to each of the nodes `targets`, from the iteration that the nodes go into with
/// `before` to that with `after`; nodes that changed nothing are left out. None where either has no solution.
pub fn influences(
    problem: &InterfaceProblem,
    before: &[ContactState],
    after: &[ContactState],
    targets: &[usize],
) -> Option<Vec<Vec<Influence>>> {
    let mut trials = Trials::new(problem)?;
    let old = trials.given(before)?;
    trials.given(after)?;
    let mut found = vec![Vec::new(); targets.len()];
    for (from, node) in problem.nodes.iter().enumerate() {
        let rows = minor::rows(
            &after[from],
            node.kinematics.as_ref(),
            &node.friction,
            &problem.settings,
        );
        let none = Influence {
            from,
            ..Influence::default()
        };
        let mut on = vec![none; targets.len()];
        for (k, row) in rows.iter().enumerate() {
            let missed = row.value - left_side(row, &old[from]);
            if missed == 0.0 {
                continue;
            }
            let changes = trials.answers_to(from, k)?;
            for (influence, &target) in on.iter_mut().zip(targets) {
                let change = changes[target];
                influence.gap -= missed * change.motion[0];
                influence.slip += missed * change.motion[1];
                influence.f_n += missed * change.force[0];
                influence.f_t += missed * change.force[1];
            }
        }
        for (all, influence) in found.iter_mut().zip(on) {
            all.push(influence);
        }
    }
    let tiny = f64::EPSILON * 64.0;
    for all in &mut found {
        all.retain(|i| {
            i.gap.abs().max(i.slip.abs()) > tiny * problem.length
                || i.f_n.abs().max(i.f_t.abs()) > tiny * problem.force
        });
    }
    Some(found)
}

fn left_side(row: &Equation, given: &NodeIncrement) -> f64 {
    let motion = match row.motion {
        Motion::None => 0.0,
        Motion::Normal => given.motion[0],
        Motion::Tangential => given.motion[1],
    };
    motion + row.d_n * given.force[0] + row.d_t * given.force[1]
}
