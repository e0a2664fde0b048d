//! Checks the laws of contact and friction with the numbers that another solver reports for an accepted state.
//!
//! Only those numbers are used: g >= 0 for rigid contact, no force across an open gap, F_n >= 0, |F_t| <=
//! |T_max|, and friction that opposes the slip of a sliding node; in space, friction at its limit along the slip. Unreported
//! quantities are not checked.

use crate::plane::max_abs;
use crate::{ContactRecord, Event, Finding, JudgedLaw, JudgedNumbers, Mode, Model, State, Verdict};

/// Violations below this limit are accepted silently, relative to the largest force and the largest motion.
/// Other solvers stop at their own criterion, often a thousandth, or satisfy the laws only on average over an
/// element.
pub const ALLOWED: f64 = 1e-2;

/// Forces below this fraction of the solver's residual scale are round-off or negligible.
pub const ROUND_OFF: f64 = 1e-6;

/// Reference sizes for relative amounts.
pub struct ReferenceSizes {
    /// The largest contact force on the way to the state. Once all contacts are open again, only round-off is
    /// left.
    pub force: f64,
    /// The largest displacement (length).
    pub length: f64,
}

/// The largest contact force in a state.
pub fn largest_force(nodes: &[ContactRecord]) -> f64 {
    let forces = nodes.iter().flat_map(|node| [node.f_n, node.f_t]);
    max_abs(forces.filter(|f| f.is_finite()))
}

impl ReferenceSizes {
    /// The sizes for a state that was accepted with an iteration.
    pub fn from_state(state: &State, event: &Event) -> ReferenceSizes {
        let known = state
            .outside
            .as_ref()
            .map_or(0.0, |outside| outside.largest_force);
        let count = event.frames.first().map_or(2, |_| 3);
        let moved = state
            .u
            .chunks(count)
            .map(|u| u.iter().map(|x| x * x).sum::<f64>().sqrt());
        ReferenceSizes {
            // The scale is NaN if it was not reported.
            force: known.max(ROUND_OFF * event.before.scale),
            length: moved.fold(0.0, f64::max),
        }
    }
}

/// The law with the largest violation in an accepted state.
pub fn broken(model: &Model, nodes: &[ContactRecord], sizes: &ReferenceSizes) -> Option<Finding> {
    let all = verdict(model, nodes, sizes);
    all.broken()
        .copied()
        .max_by(|a, b| a.amount.total_cmp(&b.amount))
}

/// The largest amount by which each law is violated in an accepted state.
pub fn verdict(model: &Model, nodes: &[ContactRecord], sizes: &ReferenceSizes) -> Verdict {
    let force = sizes.force;
    let length = if sizes.length > 0.0 {
        sizes.length
    } else {
        model.length
    };
    let found = nodes.iter().enumerate().flat_map(|(slave, node)| {
        let bond = &model.contacts[slave].bond;
        of_node(node, bond.is_hard(), bond.is_tied(), force, length).map(move |(law, amount)| {
            Finding {
                law,
                slave: Some(slave),
                amount,
                allowed: ALLOWED,
                numbers: JudgedNumbers {
                    gap: node.gap,
                    f_n: node.f_n,
                    f_t: node.f_t,
                    limit: node.t_max.abs(),
                    slip: node.slip,
                    deviation: node.deviation(),
                },
            }
        })
    });
    let mut verdict = Verdict::default();
    found
        .filter(|found| !found.amount.is_nan())
        .for_each(|found| verdict.add(found));
    verdict
}

/// The violation of each law at a node; an unreported number gives NaN, which violates none.
fn of_node(
    node: &ContactRecord,
    hard: bool,
    tied: bool,
    force: f64,
    length: f64,
) -> [(JudgedLaw, f64); 5] {
    let (gap, f_n, f_t, limit) = (node.gap, node.f_n, node.f_t, node.t_max.abs());
    let acts = f_n.abs() > ALLOWED * force;
    let slides = node.decision.before == Mode::Sliding && node.slip.abs() / length > ALLOWED;
    let wrong = match (node.directions, node.deviation()) {
        // Friction pushes in the direction of slip: the violation is twice its force.
        (None, _) if node.slip * node.t_max < 0.0 => 2.0 * f_t.abs(),
        (None, _) => 0.0,
        (Some(_), None) => limit - f_t,
        // The distance of the force from the point of the circle that the slip demands.
        (Some(_), Some(angle)) => (f_t * angle.cos() - limit).hypot(f_t * angle.sin()),
    };
    // A law that is satisfied with room to spare is not violated; NaN stays.
    let unless = |without: bool, amount: f64| {
        if without || amount < 0.0 { 0.0 } else { amount }
    };
    [
        (JudgedLaw::Penetration, unless(!hard, -gap / length)),
        (JudgedLaw::Gap, unless(!acts || !hard, gap / length)),
        (JudgedLaw::Tension, unless(tied, -f_n / force)),
        (JudgedLaw::Cone, unless(tied, (f_t.abs() - limit) / force)),
        (JudgedLaw::Slip, unless(tied || !slides, wrong / force)),
    ]
}
