//! The laws of contact and friction, checked on the numbers that an attached solver tells of an accepted state.
//!
//! Nothing but those numbers is looked at: g >= 0 where nothing gives way, no force over an open gap, F_n >= 0,
//! |F_t| <= |T_max|, and friction against the slip of a node that slides. What the solver does not tell is not judged.

use stickslip_core::contact::laws::{Finding, Law, Numbers};
use stickslip_core::contact::record::ContactRecord;
use stickslip_core::model::{Mode, Model};

/// Forces and lengths against a law that are accepted without a word, over the largest force and the largest motion. Other
/// solvers stop where their own criterion is met, which is often a thousandth, or meet the laws on the average of an element.
pub const ALLOWED: f64 = 1e-2;

/// Forces below this fraction of the solver's residual scale are round-off or negligible.
pub(super) const ROUND_OFF: f64 = 1e-6;

/// Reference sizes for relative amounts.
pub struct Sizes {
    /// The largest contact force on the way to the state. Once all contacts are open again, only round-off is left.
    pub force: f64,
    /// The largest displacement (length).
    pub length: f64,
}

/// The largest force of the contacts in a state.
pub fn largest_force(nodes: &[ContactRecord]) -> f64 {
    let forces = nodes.iter().flat_map(|node| [node.f_n, node.f_t]);
    forces
        .filter(|f| f.is_finite())
        .fold(0.0, |most: f64, f| most.max(f.abs()))
}

/// The law with the largest violation in an accepted state.
pub fn broken(model: &Model, nodes: &[ContactRecord], sizes: &Sizes) -> Option<Finding> {
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
                numbers: Numbers {
                    gap: node.gap,
                    f_n: node.f_n,
                    f_t: node.f_t,
                    limit: node.t_max.abs(),
                    slip: node.slip,
                },
            }
        })
    });
    found
        .filter(|found| found.amount > ALLOWED)
        .max_by(|a, b| a.amount.total_cmp(&b.amount))
}

/// How far a node is from each law; a number that is not told makes NaN, which breaks none.
fn of_node(
    node: &ContactRecord,
    hard: bool,
    tied: bool,
    force: f64,
    length: f64,
) -> [(Law, f64); 5] {
    let (gap, f_n, f_t, limit) = (node.gap, node.f_n, node.f_t, node.t_max.abs());
    let acts = f_n.abs() > ALLOWED * force;
    let slides = node.decision.before == Mode::Sliding && node.slip * node.t_max < 0.0;
    let slip = node.slip.abs() / length;
    let unless = |without: bool, amount: f64| if without { 0.0 } else { amount };
    [
        (Law::Penetration, unless(!hard, -gap / length)),
        (Law::Gap, unless(!acts || !hard, gap / length)),
        (Law::Tension, unless(tied, -f_n / force)),
        (Law::Cone, unless(tied, (f_t.abs() - limit) / force)),
        // Friction drives where it should hold back: twice its force is missing.
        (
            Law::Slip,
            unless(tied || !slides || slip <= ALLOWED, 2.0 * f_t.abs() / force),
        ),
    ]
}
