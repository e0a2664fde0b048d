//! Analyses the interface problem that an attached solver in space reports: one state that obeys all laws, and who moved whom.

use super::examination::{Examination, nothing};
use super::facts::{Fact, Part};
use super::influence::{Influence, NodePush};
use super::names;
use std::sync::Arc;
use stickslip_core::interface::cone::{self, ConeContact};
use stickslip_core::interface::cone_census;
use stickslip_core::{ContactRecord, Event, Mode, Model, ReportedProblem};
use stickslip_scene::sig4;

/// Maximum number of contacts, because the matrix is dense.
const MOST: usize = 500;

/// Searches consistent states of the problem that is solved next. Stops early if `stop` returns true.
pub fn examine(model: &Model, posed: &ReportedProblem, stop: &dyn Fn() -> bool) -> Examination {
    let count = posed.contacts.len();
    if count > MOST {
        return nothing(&format!(
            "The interface problem has {count} contacts; problems in space are examined up to {MOST}."
        ));
    }
    let Some((w, q)) = posed.compliance() else {
        return nothing("The reported stiffness is singular.");
    };
    let mut states: Vec<_> = cone::solve(&w, &q, &posed.friction).into_iter().collect();
    let is_unique = !states.is_empty() && cone_census::is_unique(&w, &posed.friction);
    let mut tried = None;
    if !is_unique && let Some(census) = cone_census::census(&w, &q, &posed.friction, stop) {
        tried = Some(census.combinations);
        if census.states.len() >= states.len() {
            states = census.states;
        }
    }
    let head = match states.as_slice() {
        [] => "Block Gauss-Seidel sweeps on the interface problem do not converge: no consistent state was found.".to_owned(),
        [state] if is_unique => format!(
            "The interface problem has exactly one consistent state, because friction is weak against the stiffness: {}.",
            counts(state)
        ),
        [state] => format!(
            "A consistent state of the interface problem was found (others may exist): {}.",
            counts(state)
        ),
        all => format!(
            "{} consistent states of the interface problem were found (others may exist).",
            all.len()
        ),
    };
    let several = states.len() > 1;
    let mut lines = Vec::new();
    for (number, state) in (1..).zip(&states) {
        if several {
            lines.push(format!("state {number}: {}", counts(state)));
        }
        let contacts = state.iter().zip(&posed.contacts);
        lines.extend(contacts.map(|(contact, &slave)| words(model, slave, contact)));
    }
    lines.extend(tried.map(|count| {
        format!("all {count} combinations of modes were tried, each from 4 directions of sliding")
    }));
    Examination {
        facts: Fact::all(Part::Census, lines),
        ..nothing(&head)
    }
}

/// The number of contacts in each mode.
fn counts(state: &[ConeContact]) -> String {
    let of = |mode: Mode| state.iter().filter(|contact| contact.mode == mode).count();
    format!(
        "{} free, {} sliding, {} fixed",
        of(Mode::Free),
        of(Mode::Sliding),
        of(Mode::Fixed)
    )
}

/// A contact of the state in one line.
fn words(model: &Model, slave: usize, contact: &ConeContact) -> String {
    let [f_n, f_1, f_2] = contact.force;
    let (normal, shear) = (sig4(f_n), sig4(f_1.hypot(f_2)));
    let name = names::slave(model, slave);
    let mode = contact.mode.word();
    match contact.mode {
        Mode::Free => format!("{name} {mode}, gap {}", sig4(contact.motion[0])),
        Mode::Fixed => format!("{name} {mode}, F_n {normal}, |F_t| {shear}"),
        Mode::Sliding => format!(
            "{name} {mode} with friction at {:.0}°, F_n {normal}",
            f_2.atan2(f_1).to_degrees()
        ),
    }
}

/// The changes of a contact's gap and slip by the changes of the other contacts' forces between two iterations: W_ij Δf_j, with
/// three rows per contact. `None` if forces were not reported.
pub fn pushes(
    [before, after]: &[Arc<Event>; 2],
    posed: &ReportedProblem,
    slave: usize,
) -> Option<Vec<NodePush>> {
    let Some(target) = posed.contacts.iter().position(|&known| known == slave) else {
        return Some(Vec::new());
    };
    let (w, _) = posed.compliance()?;
    let [_, sliding] = after.nodes.get(slave)?.directions?;
    let mut found = Vec::new();
    for (place, &from) in posed.contacts.iter().enumerate() {
        let (then, now) = (before.nodes.get(from)?, after.nodes.get(from)?);
        let (old, new) = (force(then)?, force(now)?);
        let change = [0, 1, 2].map(|k| new[k] - old[k]);
        if place == target || change == [0.0; 3] {
            continue;
        }
        let moved = [0, 1, 2].map(|row| {
            (0..3)
                .map(|k| w[(3 * target + row, 3 * place + k)] * change[k])
                .sum::<f64>()
        });
        found.push(NodePush {
            slave: from,
            modes: [then.decision.before, now.decision.before],
            influence: Influence {
                from: place,
                gap: moved[0],
                // Slip is the motion of the surface relative to the node.
                slip: -(moved[1] * sliding.cos() + moved[2] * sliding.sin()),
                ..Influence::default()
            },
        });
    }
    Some(found)
}

/// The force (f_n, f_1, f_2) of a contact in space, if it is known.
fn force(record: &ContactRecord) -> Option<[f64; 3]> {
    let [f_1, f_2] = record.shear()?;
    let force = [record.f_n, f_1, f_2];
    force.iter().all(|x| x.is_finite()).then_some(force)
}
