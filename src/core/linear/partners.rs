//! Contacts on elements with local flexibility in the whole system: linearisation, and coupling of the contacts on the same
//! element.
//!
//! With c_ij and X_j of [`crate::contact::point_force`], contact j adds c_ij ΔF_j + ∂c_ij/∂ξ_j F_j X_j Δu to the normal row of i,
//! and rotates the force of i by ∂c_ij/∂ξ_i ΔF_j + ∂²c_ij/∂ξ_i∂ξ_j F_j X_j Δu.

use super::coupling::{Interface, Partner};
use super::point_forces::{FlexibleContact, PointForces};
use super::source::LinearisationPoint;
use crate::Model;
use crate::contact::point_force::{NodeOverElement, linearise};
use crate::fem::lagrange::MAX_NODES;
use crate::linalg::Pattern;

/// Linearises all contacts on elements with local flexibility at the current forces.
pub fn find_points(
    (points, interfaces): (&mut PointForces, &mut [Interface]),
    (positions, step): (&[[f64; 2]], &[f64]),
    pattern: Option<&Pattern>,
    model: &Model,
    at: &LinearisationPoint<'_>,
) {
    interfaces.iter_mut().for_each(|i| i.point.clear());
    points.find(model, positions, at.contacts);
    for group in points.groups() {
        for press in group {
            let slave = model.contacts[press.contact].node;
            let element = &model.surfaces[press.spot.surface].elements[press.spot.element];
            let mut nodes = [[0.0; 2]; MAX_NODES];
            for (place, &node) in nodes.iter_mut().zip(element) {
                *place = positions[node];
            }
            let state = &at.contacts[press.contact];
            let interface = &mut interfaces[press.contact];
            interface.point.push(linearise(&NodeOverElement {
                slave: positions[slave],
                nodes: &nodes[..element.len()],
                xi: press.spot.xi,
                force: [state.f_n, state.f_t],
                give: &press.give,
                others: press.others,
            }));
            interface.push_by(model, step);
        }
        if let (Some(pattern), [_, _, ..]) = (pattern, group) {
            pair_up(interfaces, group, model, pattern);
        }
    }
}

/// Adds the coupling entries of contacts on the same element to the pattern of the whole system.
pub fn join_partners(
    interfaces: &[Interface],
    pairing: &[Option<(usize, usize)>],
    model: &Model,
    entries: &mut Vec<(usize, usize)>,
) {
    let equations = |s: usize| {
        let links = interfaces[s].links.iter();
        links.filter_map(|link| model.dofs.equation[link.dof])
    };
    let mut paired: Vec<_> = pairing.iter().enumerate().collect();
    paired.sort_unstable_by_key(|(s, pair)| (**pair, *s));
    for group in paired.chunk_by(|(_, a), (_, b)| a == b && a.is_some()) {
        for (k, &(s, _)) in group.iter().enumerate() {
            for &(t, _) in &group[k + 1..] {
                let [own, its] = [s, t].map(|s| model.dofs.equations + 2 * s);
                let both = equations(s).chain([own]);
                for i in both {
                    for j in equations(t).chain([its]) {
                        entries.extend([(i, j), (j, i)]);
                    }
                }
            }
        }
    }
}

/// Adds the coupling of contact `s` with the other contacts on its element to the column and, if `motion` is set, to the normal
/// row.
pub fn place_partners(interfaces: &[Interface], values: &mut [f64], s: usize, motion: bool) {
    let Some(point) = interfaces[s].point.first() else {
        return;
    };
    for partner in &interfaces[s].partners {
        let Some(other) = interfaces[partner.other].point.first() else {
            continue;
        };
        let turned = partner.slopes[0] * partner.force_slope;
        for (slot, by_turn) in partner.column.iter().zip(&point.columns[2]) {
            if let Some(slot) = slot {
                values[*slot] -= turned * by_turn;
            }
        }
        if motion {
            values[partner.block] -= partner.give * partner.force_slope;
            for (slot, travel) in partner.row.iter().zip(&other.travel) {
                if let Some(slot) = slot {
                    values[*slot] -= partner.slopes[1] * partner.force * travel;
                }
            }
        }
    }
}

/// Contribution of the other contacts on the element to the normal motion of a contact (length), computed after the solution from
/// the increments of the degrees of freedom and of the forces.
pub fn partners_motion(
    interfaces: &[Interface],
    s: usize,
    increment: impl Fn(usize) -> f64,
    forces: &[[f64; 2]],
) -> f64 {
    let partners = interfaces[s].partners.iter();
    let did = partners.filter_map(|partner| {
        let other = &interfaces[partner.other];
        let travel = other.links.iter().zip(&other.point.first()?.travel);
        let way: f64 = travel.map(|(link, x)| x * increment(link.dof)).sum();
        let force = partner.force_slope * forces[partner.other][0];
        Some(partner.give * force + partner.slopes[1] * partner.force * way)
    });
    did.sum()
}

/// Adds the effect of rotating and moving contact forces to the stiffness (if `both` is set), and that of prescribed motions to the
/// coupling.
pub fn turn_points(
    interfaces: &[Interface],
    (stiffness, both): (&mut [f64], bool),
    (coupling, step): (&mut [f64], &[f64]),
    model: &Model,
) {
    for interface in interfaces {
        let Some(point) = interface.point.first() else {
            continue;
        };
        let mut enter = |equation: usize, slot: Option<usize>, dof: usize, value: f64| match slot {
            Some(slot) if both => stiffness[slot] -= value,
            Some(_) => {}
            None => coupling[equation] -= value * step[dof],
        };
        let count = interface.links.len();
        for (i, row) in interface.links.iter().enumerate() {
            let Some(equation) = model.dofs.equation[row.dof] else {
                continue;
            };
            for (j, col) in interface.links.iter().enumerate() {
                let slot = interface.pairs[i * count + j];
                enter(equation, slot, col.dof, point.stiffness[i][j]);
            }
            for partner in &interface.partners {
                let other = &interfaces[partner.other];
                let Some(its) = other.point.first() else {
                    continue;
                };
                let turned = point.columns[2][i] * partner.cross * partner.force;
                for (j, col) in other.links.iter().enumerate() {
                    let slot = partner.pairs[i * other.links.len() + j];
                    enter(equation, slot, col.dof, turned * its.travel[j]);
                }
            }
        }
    }
}

impl Interface {
    /// Computes the contribution of prescribed motions to the rows of this contact.
    fn push_by(&mut self, model: &Model, step: &[f64]) {
        let Some(point) = self.point.first() else {
            return;
        };
        self.pushed = [0, 1].map(|k| {
            let links = self.links.iter().zip(&point.rows[k]);
            let given = links.filter(|(link, _)| model.dofs.equation[link.dof].is_none());
            given.map(|(link, row)| row * step[link.dof]).sum()
        });
    }
}

/// Updates the couplings between the contacts of a group; looks up the matrix entries of new pairs.
fn pair_up(
    interfaces: &mut [Interface],
    group: &[FlexibleContact],
    model: &Model,
    pattern: &Pattern,
) {
    for press in group {
        let others = || group.iter().filter(|other| other.contact != press.contact);
        let own = &interfaces[press.contact].partners;
        let met = own.iter().map(|p| p.other).eq(others().map(|o| o.contact));
        if !met {
            let found = others().map(|other| places(interfaces, press, other, model, pattern));
            interfaces[press.contact].partners = found.collect();
        }
        let mut partners = std::mem::take(&mut interfaces[press.contact].partners);
        for (partner, other) in partners.iter_mut().zip(others()) {
            let (pair, back) = (press.with(other), other.with(press));
            partner.give = pair.give;
            partner.slopes = [pair.slope, back.slope];
            partner.cross = pair.cross;
            let point = interfaces[other.contact].point.first();
            partner.force_slope = point.map_or(0.0, |point| point.force_slope);
            partner.force = other.force;
        }
        interfaces[press.contact].partners = partners;
    }
}

/// Indices of the coupling entries of two contacts in the whole system.
fn places(
    interfaces: &[Interface],
    press: &FlexibleContact,
    other: &FlexibleContact,
    model: &Model,
    pattern: &Pattern,
) -> Partner {
    let [own, its] = [press, other].map(|press| {
        let links = interfaces[press.contact].links.iter();
        let equations = links.map(|link| model.dofs.equation[link.dof]);
        let row = model.dofs.equations + 2 * press.contact;
        (row, equations.collect::<Vec<_>>())
    });
    let slot = |i: Option<usize>, j: Option<usize>| pattern.slot(i?, j?);
    let to_all = |i: Option<usize>| its.1.iter().map(move |&j| (i, j));
    Partner {
        other: other.contact,
        block: pattern.slot(own.0, its.0).unwrap_or_default(),
        row: to_all(Some(own.0)).map(|(i, j)| slot(i, j)).collect(),
        column: own.1.iter().map(|&i| slot(i, Some(its.0))).collect(),
        pairs: own
            .1
            .iter()
            .flat_map(|&i| to_all(i))
            .map(|(i, j)| slot(i, j))
            .collect(),
        ..Partner::default()
    }
}
