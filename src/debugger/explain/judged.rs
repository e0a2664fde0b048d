//! Describes the judge's findings: the law, the node, the amount.

use crate::explain::names::slave;
use stickslip_core::{Finding, JudgedLaw, JudgedNumbers, Model};
use stickslip_scene::number::{sig2, sig4, significant};

/// A finding, as part of a sentence.
pub fn finding(model: &Model, finding: &Finding) -> String {
    let JudgedNumbers {
        gap,
        f_n,
        f_t,
        limit,
        slip,
        deviation,
    } = finding.numbers;
    let drives = f_t * slip > 0.0;
    // Seven digits show by how little a limit is missed.
    let [gap, f_n, f_t, limit, slip] =
        [gap.abs(), f_n, f_t, limit, slip].map(|x| significant(x, 7));
    let node = finding.slave.map_or("a node", |s| slave(model, s));
    let text = match finding.law {
        JudgedLaw::Penetration => format!("{node} penetrates its surface by {gap}"),
        JudgedLaw::Gap | JudgedLaw::Penalty if finding.amount.is_infinite() => {
            format!("{node} carries a force without facing a surface")
        }
        JudgedLaw::Gap => format!("{node} carries a force across a gap of {gap}"),
        JudgedLaw::Tension => format!("the surface pulls {node}: F_n {f_n}"),
        JudgedLaw::Cone => format!(
            "F_t at {node} exceeds the friction limit of the node or of its corner (F_t \
             {f_t}, limit {limit})"
        ),
        JudgedLaw::Slip if deviation.is_some() => format!(
            "friction at {node} is not at its limit along the slip (|F_t| {f_t}, limit {limit}, {:.1} degrees off)",
            deviation.unwrap_or_default().to_degrees()
        ),
        JudgedLaw::Slip if drives => format!(
            "friction drives the slip of {node} instead of opposing it (slip {slip}, F_t {f_t})"
        ),
        JudgedLaw::Slip => format!(
            "{node} slipped by {slip} while friction is not at its limit against the slip (F_t \
             {f_t}, limit {limit})"
        ),
        JudgedLaw::Touch => format!(
            "friction drives {node}, wherever it made contact: since the last increment, in \
             which it was open, its projection moved by {slip} along t (F_t {f_t})"
        ),
        JudgedLaw::Work => {
            format!("friction produced work at {node} (slip {slip}, final F_t {f_t})")
        }
        JudgedLaw::Penalty => format!(
            "{node} penetrates its surface by {gap}, which does not match its penalty law for F_n {f_n}"
        ),
        JudgedLaw::Tied => format!("{node} has left the point of the surface that it is tied to"),
        JudgedLaw::Stick => format!(
            "{node} slipped by {slip} beyond its elastic slip while friction is not at its \
             limit against the slip (F_t {f_t}, limit {limit})"
        ),
        JudgedLaw::Balance => format!("the forces on {node} are not in balance"),
        JudgedLaw::Moments => "loads and reactions are not in balance".into(),
    };
    format!("{text} ({}: {})", finding.law.name(), sig2(finding.amount))
}

/// Location of a finding, as part of a sentence: the node, its coordinates and its numbers.
pub fn place(model: &Model, places: &[[f64; 2]], finding: &Finding) -> String {
    let Some(contact) = finding.slave.and_then(|s| model.contacts.get(s)) else {
        return "in the scene as a whole".into();
    };
    let [x, y] = places[contact.node].map(sig4);
    let JudgedNumbers {
        gap,
        f_n,
        f_t,
        limit,
        ..
    } = finding.numbers;
    let name = &model.nodes[contact.node].name;
    format!(
        "{name} at ({x}, {y}): gap {}, F_n {}, F_t {} (limit {})",
        sig4(gap),
        sig4(f_n),
        sig4(f_t),
        sig4(limit)
    )
}
