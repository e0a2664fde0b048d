//! Contact laws of the pairs: tributary areas, bonds, and friction of each node.

use super::super::areas::{NamedSides, tributary};
use super::super::limits;
use super::super::nodes::Names;
use crate::Spec;
use crate::format::contact_law::{ContactLaw, FrictionSpec};
use crate::format::error::{Fault, Path, at, bail, fault};
use crate::format::spec::SlaveSpec;
use crate::number::sig4;
use std::collections::HashSet;
use stickslip_core::contact::facing::is_piece;
use stickslip_core::contact::projection::{project, projection_at};
use stickslip_core::plane::{self, minus};
use stickslip_core::{Body, Bond, Contact, Dofs, InitialState, Mode, Node, Surface};

/// Maximum distance that a tied node is moved, relative to the scene's length; nodes further away are not meant to be tied.
const JOINED: f64 = 0.05;

/// Fractions of a side below this are round-off.
const TOUCHES: f64 = 1e-9;

/// Rejects invalid parameters of a pair's law.
pub(super) fn check(here: &Path, group: &SlaveSpec) -> Result<(), Fault> {
    if let Some(stiffness) = group.law.stiffness() {
        let place = here.then("law").then("stiffness");
        limits::stiffness(&place, stiffness, "the stiffness")?;
    }
    if !group.by.is_node() && group.law.stiffness().is_none() {
        bail!(
            here.then("by"),
            "points of faces need a law with a stiffness: Penalty or Bonded; with other laws use by: node"
        );
    }
    if !group.by.is_node() && group.area.is_some() {
        bail!(
            here.then("area"),
            "points of faces have areas of their sides; leave area out"
        );
    }
    if let Some(stick) = group.stick {
        limits::stiffness(&here.then("stick"), stick, "the stick stiffness")?;
    }
    if let Some(area) = group.area {
        limits::positive(&here.then("area"), area, "the tributary area")?;
    }
    if !group.law.is_tied() {
        return Ok(());
    }
    let idle = |field: &str, why: &str| {
        Err(fault!(
            here.then(field),
            "a tied node {why}; leave {field} out"
        ))
    };
    let InitialState {
        t_max, slip, ratio, ..
    } = group.state;
    match group {
        SlaveSpec {
            friction: Some(_), ..
        } => idle("friction", "has no friction"),
        SlaveSpec {
            stick: Some(_),
            law: ContactLaw::Tied,
            ..
        } => idle("stick", "is tied rigidly"),
        SlaveSpec {
            start: Mode::Sliding,
            ..
        } => idle("start", "is always fixed"),
        _ if [t_max, slip, ratio] != [0.0; 3] => {
            idle("state", "never slides; only its forces can be given")
        }
        _ => Ok(()),
    }
}

/// Moves the tied nodes onto their surfaces and ties them.
pub(super) fn tie(
    spec: &Spec,
    names: &mut Names,
    surfaces: &[Surface],
    pairs: &[usize],
    slaves: &mut [Contact],
    length: f64,
) -> Result<bool, Fault> {
    let mut places: Vec<[f64; 2]> = names.nodes.iter().map(|node| node.at).collect();
    let mut moved = false;
    for (slave, &pair) in slaves.iter_mut().zip(pairs) {
        if !spec.slaves[pair].law.is_tied() {
            continue;
        }
        let at = places[slave.node];
        let refused = |why: String| {
            fault!(
                slave_path(spec, names, slave.node),
                "node {:?} cannot be tied: it {why}",
                names.nodes[slave.node].name
            )
        };
        let Some(spot) = project(at, surfaces, &slave.surfaces, &places, None) else {
            let why = "lies beyond the ends of its surface; remove it from the list, or extend the surface";
            return Err(refused(why.to_owned()));
        };
        let over = projection_at(surfaces, spot, &places, at);
        if over.gap.abs() > JOINED * length {
            let why = format!(
                "is {} away from its surface, more than 5 % of the scene's size; move it closer, or remove it from the list",
                sig4(over.gap.abs())
            );
            return Err(refused(why));
        }
        moved |= over.foot != at;
        places[slave.node] = over.foot;
        names.nodes[slave.node].at = over.foot;
        (slave.bond, slave.start) = (Bond::tied(), Mode::Fixed);
    }
    Ok(moved)
}

/// Determines areas, bonds and friction of all slave nodes. A node under a penalty that has no area carries no force and is
/// removed.
pub(super) fn apply(
    spec: &Spec,
    names: &Names,
    bodies: &[Body],
    pairs: &[usize],
    named: &NamedSides,
    slaves: &mut Vec<Contact>,
) -> Result<(), Fault> {
    let mut pair_of = vec![None; names.nodes.len()];
    for (slave, &pair) in slaves.iter().zip(pairs) {
        pair_of[slave.node] = Some(pair);
    }
    let gives = |pair: usize| spec.slaves[pair].law.stiffness().is_some();
    let areas = tributary(&names.nodes, bodies, &pair_of, named, gives);
    // Contacts of one node share its area equally.
    let carrier = |slave: &Contact| match slave.weights[..] {
        [(node, _)] => node,
        _ => slave.node,
    };
    let mut shares = vec![0.0; names.nodes.len()];
    slaves
        .iter()
        .for_each(|slave| shares[carrier(slave)] += 1.0);
    for (slave, &pair) in slaves.iter_mut().zip(pairs) {
        let group = &spec.slaves[pair];
        let node = carrier(slave);
        let whole = || group.area.or(areas[node]);
        slave.area = slave.area.or_else(|| Some(whole()? / shares[node]));
        let own = if group.law.is_tied() {
            FrictionSpec::default()
        } else {
            group.friction.unwrap_or(spec.friction)
        };
        check_area(spec, names, group, &own, slave)?;
        slave.friction = own.of_node(slave.area);
        slave.bond = bond(group, slave.area.unwrap_or(0.0));
    }
    slaves.retain(|slave| slave.bond.give().iter().all(|give| give.is_finite()));
    Ok(())
}

/// Marks the tied nodes that, because of supports, can move along one axis only relative to their surfaces.
pub(super) fn stand_upright(dofs: &Dofs, surfaces: &[Surface], slaves: &mut [Contact]) {
    for slave in slaves.iter_mut().filter(|slave| slave.bond.is_tied()) {
        let nodes: Vec<usize> = slave
            .surfaces
            .iter()
            .flat_map(|&s| surfaces[s].nodes())
            .copied()
            .chain([slave.node])
            .collect();
        let moves = |k: usize| {
            nodes
                .iter()
                .any(|&n| dofs.equation[dofs.first[n] + k].is_some())
        };
        let own = |k: usize| dofs.equation[dofs.first[slave.node] + k].is_some();
        if let Bond::Tied { give, upright } = &mut slave.bond {
            // Springs keep the equations independent.
            *upright = *give == [0.0; 2] && (own(0) != own(1) || moves(0) != moves(1));
        }
    }
}

/// Rejects points of faces over elements with local flexibility under point forces.
pub(super) fn check_points(surfaces: &[Surface], slaves: &[Contact]) -> Result<(), Fault> {
    let is_flexible = |surface: &usize| !surfaces[*surface].gives.is_empty();
    let mut points = slaves.iter().filter(|slave| slave.weights.len() > 1);
    if points.any(|slave| slave.surfaces.iter().any(is_flexible)) {
        bail!(
            at!["slaves"],
            "points of faces (by: surface) cannot touch shear-flexible beams; use by: node"
        );
    }
    Ok(())
}

/// Rejects nodes with a compliance over two rigid surfaces that cross: in the corner both laws would apply.
pub(super) fn check_corners(
    spec: &Spec,
    names: &Names,
    surfaces: &[Surface],
    slaves: &[Contact],
) -> Result<(), Fault> {
    let mut apart = HashSet::new();
    for slave in slaves.iter().filter(|slave| slave.bond.give() != [0.0; 2]) {
        for (k, &one) in slave.surfaces.iter().enumerate() {
            for &other in &slave.surfaces[k + 1..] {
                let both = [&surfaces[one], &surfaces[other]];
                let rigid = both.iter().all(|surface| surface.rigid);
                let pieces = is_piece(slave, one) && is_piece(slave, other);
                if !rigid || pieces || apart.contains(&(one, other)) {
                    continue;
                }
                if cross(&names.nodes, both) {
                    bail!(
                        slave_path(spec, names, slave.node),
                        "node {:?} has a penalty or a stick stiffness, but the surfaces {:?} and {:?} cross, and both laws would apply in their corner; name one of them, or use hard contact",
                        names.nodes[slave.node].name,
                        both[0].name,
                        both[1].name
                    );
                }
                apart.insert((one, other));
            }
        }
    }
    Ok(())
}

/// Whether two surfaces cross or meet at an angle; each is treated as straight between nodes.
fn cross(nodes: &[Node], surfaces: [&Surface; 2]) -> bool {
    let on = |part: f64, surface: &Surface| {
        surface.endless || (-TOUCHES..=1.0 + TOUCHES).contains(&part)
    };
    let [one, other] = surfaces.map(|surface| -> Vec<[[f64; 2]; 2]> {
        surface
            .elements
            .iter()
            .flat_map(|element| element.windows(2))
            .map(|pair| [nodes[pair[0]].at, nodes[pair[1]].at])
            .collect()
    });
    one.iter().any(|&[a, b]| {
        other.iter().any(|&[c, d]| {
            let (r, u) = (minus(b, a), minus(d, c));
            let to = minus(c, a);
            let turn = plane::cross(r, u);
            let along = plane::cross(to, u) / turn;
            let across = plane::cross(to, r) / turn;
            turn != 0.0 && on(along, surfaces[0]) && on(across, surfaces[1])
        })
    })
}

/// Contact law at a node of a pair.
fn bond(group: &SlaveSpec, area: f64) -> Bond {
    let compliance = |stiffness: f64| 1.0 / (stiffness * area);
    let normal = group.law.stiffness().map_or(0.0, compliance);
    // A hard node without an area has no friction if there is no cohesion per node.
    let yields = group.law.is_tied() || !group.by.is_node();
    let tangential = match (group.law.stiffness(), group.stick) {
        (Some(stiffness), None) if yields => compliance(stiffness),
        (_, Some(stick)) if area > 0.0 => compliance(stick),
        _ => 0.0,
    };
    let give = [normal, tangential];
    if group.law.is_tied() {
        Bond::Tied {
            give,
            upright: false,
        }
    } else {
        Bond::giving(give)
    }
}

/// Rejects laws per area at a node without an area.
fn check_area(
    spec: &Spec,
    names: &Names,
    group: &SlaveSpec,
    friction: &FrictionSpec,
    slave: &Contact,
) -> Result<(), Fault> {
    let wants = match (group.law, group.stick, friction.adhesion != 0.0) {
        _ if slave.area.is_some() => return Ok(()),
        _ if group.law.stiffness().is_some() => "a stiffness is a pressure per length",
        (_, Some(_), _) => "a stick stiffness is a stress per length",
        (_, _, true) => "an adhesion is a force per area",
        _ => return Ok(()),
    };
    Err(fault!(
        slave_path(spec, names, slave.node),
        "{wants}, but node {:?} has no tributary area, because it is on no side of a beam or solid; give the pair an `area` per node",
        names.nodes[slave.node].name
    ))
}

/// Location of the name that made a node a slave.
pub(super) fn slave_path(spec: &Spec, names: &Names, node: usize) -> Path {
    for (k, group) in spec.slaves.iter().enumerate() {
        for (j, name) in group.nodes.iter().enumerate() {
            if names.nodes(name).is_ok_and(|nodes| nodes.contains(&node)) {
                return at!["slaves", k, "nodes", j];
            }
        }
    }
    at!["slaves"]
}
