//! What the judge found, in words: the law, the node, the amount.

use crate::explain::names::slave;
use stickslip_core::contact::laws::{Finding, Law, Numbers};
use stickslip_core::model::Model;
use stickslip_scene::number::four;

/// What a finding says, as a part of a sentence.
pub fn finding(model: &Model, finding: &Finding) -> String {
    let Numbers {
        gap,
        f_n,
        f_t,
        limit,
        slip,
    } = finding.numbers;
    let node = finding.slave.map_or("a node", |s| slave(model, s));
    let told = match finding.law {
        Law::Penetration => format!("{node} is inside its surface by {:.3e}", -gap),
        Law::Gap if finding.amount.is_infinite() => {
            format!("{node} bears a force and has no surface to touch")
        }
        Law::Gap => format!(
            "{node} bears a force, and its surface is {:.3e} away",
            gap.abs()
        ),
        Law::Tension => format!("the surface pulls {node}: F_n {f_n:.6e}"),
        Law::Cone => format!(
            "at {node} F_t {f_t:.6e} is more than friction can give (limit {limit:.6e}), or more than \
             the sides of its corner can"
        ),
        Law::Slip if f_t * slip > 0.0 => format!(
            "friction drives the slip of {node} instead of opposing it: it slipped by {slip:.6e} along t, and F_t is {f_t:.6e}"
        ),
        Law::Slip => format!(
            "{node} slipped by {slip:.6e} along t, and friction is not at its limit against that: F_t is \
             {f_t:.6e}, the limit {limit:.6e}"
        ),
        Law::Touch => format!(
            "friction drives {node} wherever it touched: its foot went {slip:.6e} along t since the last increment, when it was \
             open, and F_t is {f_t:.6e}"
        ),
        Law::Work => format!(
            "friction gave work at {node}: it slipped by {slip:.6e} along t, and F_t is {f_t:.6e} at the end"
        ),
        Law::Penalty if finding.amount.is_infinite() => {
            format!("{node} bears a force and has no surface to touch")
        }
        Law::Penalty => format!(
            "{node} is inside its surface by {:.6e}, which is not what its penalty gives to F_n {f_n:.6e}",
            -gap
        ),
        Law::Tied => format!("{node} has left the point of the surface that it is tied to"),
        Law::Stick => format!(
            "{node} slipped by {slip:.6e} along t beyond its elastic slip, and friction is not at its limit against that: F_t is \
             {f_t:.6e}, the limit {limit:.6e}"
        ),
        Law::Balance => format!("the forces on {node} are not in balance"),
        Law::Moments => "loads and reactions are not in balance".into(),
    };
    format!("{told} ({}: {:.1e})", finding.law.name(), finding.amount)
}

/// Where a finding is, as a part of a sentence: the node and its place, with its numbers.
pub fn place(model: &Model, places: &[[f64; 2]], finding: &Finding) -> String {
    let Some(contact) = finding.slave.and_then(|s| model.contacts.get(s)) else {
        return "in the scene as a whole".into();
    };
    let [x, y] = places[contact.node].map(four);
    let Numbers {
        gap,
        f_n,
        f_t,
        limit,
        ..
    } = finding.numbers;
    let name = &model.nodes[contact.node].name;
    format!(
        "{name} at ({x}, {y}): gap {}, F_n {}, F_t {} of at most {}",
        four(gap),
        four(f_n),
        four(f_t),
        four(limit)
    )
}
