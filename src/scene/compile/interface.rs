//! Surfaces, slave nodes and friction.

use super::super::corners;
use super::super::geometry;
use super::super::limits;
use super::super::nodes::Names;
use super::super::nodes::checks::unique;
use super::bodies::{chain, check_chain};
use super::laws;
use super::meeting_ends::{self, coincide, end_nodes};
use crate::Spec;
use crate::format::contact_law::FrictionSpec;
use crate::format::error::{Fault, Path, at, bail, none_called, quoted};
use crate::format::spec::{LoadSpec, Nodes, Side, SlaveSpec};
use crate::joined;
use std::collections::HashSet;
use stickslip_core::contact::element::closed;
use stickslip_core::contact::smooth::smooth;
use stickslip_core::{Component, Contact, Dofs, Friction, InitialState, Surface};

/// The surfaces of a scene in list order, one per piece.
pub(super) struct Surfaces {
    pub made: Vec<Surface>,
    /// Index of each surface in the scene's list.
    pub listed: Vec<usize>,
    /// Whether the program chooses how far a surface continues past its start and its end.
    pub automatic: Vec<[bool; 2]>,
}

impl Surfaces {
    /// Numbers of the surfaces that are pieces of a cut surface.
    pub(super) fn cut(&self, spec: &Spec) -> Vec<usize> {
        let listed = self.listed.iter().enumerate();
        listed
            .filter(|(_, listed)| spec.surfaces[**listed].cut)
            .map(|(number, _)| number)
            .collect()
    }
}

/// The surfaces, walked so that the outward side is on the right. Unconnected sides of a given mesh become separate surfaces
/// `ID.1`, `ID.2`, …
pub(super) fn surfaces(
    spec: &Spec,
    names: &Names,
    on_body: &[bool],
    length: f64,
) -> Result<Surfaces, Fault> {
    unique("surfaces", spec.surfaces.iter().map(|s| s.id.as_str()))?;
    let mut all = Surfaces {
        made: Vec::with_capacity(spec.surfaces.len()),
        listed: Vec::with_capacity(spec.surfaces.len()),
        automatic: Vec::with_capacity(spec.surfaces.len()),
    };
    let mut total = 0;
    for (k, surface) in spec.surfaces.iter().enumerate() {
        let here = at!["surfaces", k, "along"];
        let chain = chain(&here, names, &surface.along, &mut total, spec)?;
        if chain.is_inside() {
            bail!(
                here,
                "{} has sides between two elements, which have no outward side; bodies that should touch \
                 must not share nodes there",
                quoted(&surface.along)
            );
        }
        let mut pieces = chain.pieces();
        for elements in &mut pieces {
            check_chain(names, &surface.along, elements, length)?;
            if surface.reverse {
                elements.reverse();
                elements.iter_mut().for_each(|element| element.reverse());
            }
            let stays = |ends| moves_alike(spec, names, ends);
            meeting_ends::close(elements, &names.nodes, on_body, stays, length);
        }
        if surface.cut {
            pieces = pieces
                .into_iter()
                .flat_map(|elements| corners::cut(elements, &names.nodes))
                .collect();
        }
        let several = pieces.len() > 1;
        let past_ends = surface.past_ends.unwrap_or(0.0);
        if surface.endless && past_ends != 0.0 {
            bail!(
                at!["surfaces", k, "past_ends"],
                "an endless surface has no ends; leave past_ends out"
            );
        }
        if !(0.0..=1.0).contains(&past_ends) {
            bail!(
                at!["surfaces", k, "past_ends"],
                "must be between 0 and 1, in lengths of the last element"
            );
        }
        let ends: Vec<_> = pieces.iter().map(|piece| end_nodes(piece)).collect();
        if several && surface.endless {
            bail!(
                at!["surfaces", k, "endless"],
                "the surface has {} pieces; an endless surface must have one",
                pieces.len()
            );
        }
        for ((number, elements), own) in (1..).zip(pieces).zip(&ends) {
            if surface.endless && !geometry::straight(&names.nodes, &elements, length) {
                bail!(
                    at!["surfaces", k, "endless"],
                    "an endless surface must be straight"
                );
            }
            let name = if several {
                format!("{}.{number}", surface.id)
            } else {
                surface.id.clone()
            };
            all.listed.push(k);
            let open = open_ends(*own, &ends);
            let chosen = surface.past_ends.is_none() && !surface.endless;
            all.automatic.push(open.map(|open| open && chosen));
            all.made.push(Surface {
                name,
                elements,
                rigid: false,
                endless: surface.endless,
                past_ends: open.map(|open| if open { 2.0 * past_ends } else { 0.0 }),
                smooth: Vec::new(),
                gives: Vec::new(),
            });
        }
    }
    limits::entries("surfaces", all.made.len())?;
    Ok(all)
}

/// Whether every prescribed displacement moves both nodes or neither.
fn moves_alike(spec: &Spec, names: &Names, [a, b]: [usize; 2]) -> bool {
    spec.loads.iter().all(|load| match load {
        LoadSpec::Displacement { node, .. } => names
            .nodes(node)
            .is_ok_and(|moved| moved.contains(&a) == moved.contains(&b)),
        _ => true,
    })
}

/// Whether a prescribed displacement moves a node along an axis.
pub(super) fn is_moved(spec: &Spec, names: &Names, node: usize, axis: Component) -> bool {
    spec.loads.iter().any(|load| match load {
        LoadSpec::Displacement {
            node: of,
            component,
            ..
        } => *component == axis && names.nodes(of).is_ok_and(|moved| moved.contains(&node)),
        _ => false,
    })
}

/// Whether no chain, of which these are the ends, continues at the beginning and at the end of one of them.
fn open_ends([first, last]: [Option<usize>; 2], all: &[[Option<usize>; 2]]) -> [bool; 2] {
    [
        all.iter().all(|[_, end]| *end != first),
        all.iter().all(|[start, _]| *start != last),
    ]
}

/// Smooths the surfaces with `smooth`, at the undeformed positions of the nodes.
pub(super) fn smoothed(spec: &Spec, names: &Names, surfaces: &mut Surfaces) -> Result<(), Fault> {
    for (surface, &k) in surfaces.made.iter_mut().zip(&surfaces.listed) {
        let wanted = &spec.surfaces[k];
        // A piece with one straight element is already smooth.
        if !wanted.smooth || wanted.cut && surface.elements.len() == 1 {
            continue;
        }
        let fault = |message: &str| Err(Fault::new(at!["surfaces", k, "smooth"], message));
        if wanted.endless {
            return fault("an endless surface is already smooth; leave smooth out");
        }
        let distinct: HashSet<usize> = surface.nodes().copied().collect();
        if closed(surface) && distinct.len() < 3 {
            return fault("a smooth closed surface needs at least three nodes");
        }
        smooth(surface, &names.nodes);
    }
    Ok(())
}

/// The slave nodes in file order, with the pair (entry of the list) of each. Their contact laws are added later
/// ([`super::laws`]).
pub(super) fn slaves(
    spec: &Spec,
    names: &Names,
    all: &Surfaces,
    length: f64,
) -> Result<(Vec<Contact>, Vec<usize>), Fault> {
    let surfaces = all.made.as_slice();
    friction(&at!["friction"], &spec.friction)?;
    let members: Vec<HashSet<usize>> = surfaces
        .iter()
        .map(|surface| surface.nodes().copied().collect())
        .collect();
    let (mut made, mut pairs) = (Vec::new(), Vec::new());
    let mut taken = HashSet::new();
    for (k, group) in spec.slaves.iter().enumerate() {
        let here = at!["slaves", k];
        if let Some(own) = &group.friction {
            friction(&here.then("friction"), own)?;
        }
        let on = candidates(&here, group, spec, all)?;
        initial_state(&here.then("state"), &group.state)?;
        laws::check(&here, group)?;
        if group.nodes.is_empty() {
            bail!(
                here.then("nodes"),
                "the list is empty; name at least one slave node"
            );
        }
        let mut ends = HashSet::new();
        for (j, name) in group.nodes.iter().enumerate() {
            let fault = |message: String| Fault::new(here.then("nodes").then(j), message);
            let found = names.nodes(name).map_err(fault)?;
            // Two edges of a block share their corner.
            let own_ends: Vec<usize> = match found[..] {
                [first, .., last] => vec![first, last],
                _ => Vec::new(),
            };
            let met = |node: &usize| own_ends.contains(node) && ends.contains(node);
            let fresh_ones: Vec<usize> = found.into_iter().filter(|node| !met(node)).collect();
            for node in fresh_ones {
                let slave = Contact {
                    start: group.start,
                    state: group.state,
                    ..Contact::new(node, on.clone(), Friction::default())
                };
                // Sides of several pairs may share nodes.
                let of_sides = (!group.by.is_node()).then_some(k);
                let fresh = taken.insert((node, of_sides));
                check_slave(&slave, fresh, names, surfaces, &members, length).map_err(fault)?;
                made.push(slave);
                pairs.push(k);
            }
            ends.extend(own_ends);
        }
    }
    Ok((made, pairs))
}

/// Surfaces that a group of slaves may touch.
fn candidates(
    here: &Path,
    group: &SlaveSpec,
    spec: &Spec,
    surfaces: &Surfaces,
) -> Result<Vec<usize>, Fault> {
    if group.on.is_empty() {
        bail!(
            here.then("on"),
            "the list is empty; name at least one surface"
        );
    }
    let ids = || spec.surfaces.iter().map(|s| s.id.as_str());
    let mut on = Vec::with_capacity(group.on.len());
    for (k, name) in group.on.iter().enumerate() {
        let fault = |message| Err(Fault::new(here.then("on").then(k), message));
        if group.on[..k].contains(name) {
            return fault(format!("surface {name:?} is named twice"));
        }
        let Some(listed) = ids().position(|id| id == name) else {
            return fault(none_called("surface", name, "surfaces", ids()));
        };
        let pieces = (0..surfaces.made.len()).filter(|&s| surfaces.listed[s] == listed);
        on.extend(pieces);
    }
    Ok(on)
}

/// Rejects a slave node that is listed twice, lies on its own master, or is far away from it.
fn check_slave(
    slave: &Contact,
    fresh: bool,
    names: &Names,
    surfaces: &[Surface],
    members: &[HashSet<usize>],
    length: f64,
) -> Result<(), String> {
    let node = &names.nodes[slave.node];
    if !fresh {
        return Err(format!("node {:?} is already a slave node", node.name));
    }
    let mut least = f64::INFINITY;
    for &s in &slave.surfaces {
        if members[s].contains(&slave.node) {
            return Err(format!(
                "node {:?} belongs to the surface {:?} that it may touch; a node cannot touch itself",
                node.name, surfaces[s].name
            ));
        }
        if surfaces[s].endless {
            return Ok(());
        }
        if least > length {
            let elements = &surfaces[s].elements;
            least = least.min(geometry::distance_up_to(
                length,
                node.at,
                &names.nodes,
                elements,
            ));
        }
    }
    if least <= length {
        return Ok(());
    }
    let on = joined(
        slave.surfaces.iter().map(|&s| surfaces[s].name.as_str()),
        " and ",
    );
    Err(format!(
        "node {:?} at ({:?}, {:?}) is {least:.4} away from {}, more than the size of all bodies \
         together ({length:.4}); check the node and the surface",
        node.name, node.at[0], node.at[1], on
    ))
}

/// Rejects an invalid initial state.
fn initial_state(here: &Path, state: &InitialState) -> Result<(), Fault> {
    let InitialState {
        f_n,
        f_t,
        t_max,
        slip,
        ratio,
    } = *state;
    let fields = [
        ("f_n", f_n),
        ("f_t", f_t),
        ("t_max", t_max),
        ("slip", slip),
        ("ratio", ratio),
    ];
    fields
        .iter()
        .try_for_each(|(field, value)| limits::finite(&here.then(*field), *value, "the value"))
}

/// Rejects invalid friction.
pub(super) fn friction(here: &Path, friction: &FrictionSpec) -> Result<(), Fault> {
    let FrictionSpec {
        angle,
        cohesion,
        adhesion,
    } = *friction;
    if !(0.0..90.0).contains(&angle) {
        bail!(
            here.then("angle"),
            "the friction angle is {angle:?}; it must be at least 0 and below 90 degrees"
        );
    }
    limits::finite(&here.then("cohesion"), cohesion, "the cohesion")?;
    if cohesion < 0.0 {
        bail!(
            here.then("cohesion"),
            "the cohesion is {cohesion:?}; it is a force per slave node and must not be negative"
        );
    }
    limits::finite(&here.then("adhesion"), adhesion, "the adhesion")?;
    if adhesion < 0.0 {
        bail!(
            here.then("adhesion"),
            "the adhesion is {adhesion:?}; it is a force per area and must not be negative"
        );
    }
    Ok(())
}

/// Rejects unused nodes.
pub(super) fn check_use(
    spec: &Spec,
    names: &Names,
    on_body: &[bool],
    surfaces: &[Surface],
    slaves: &[Contact],
    length: f64,
) -> Result<(), Fault> {
    let mut used = on_body.to_vec();
    surfaces
        .iter()
        .flat_map(|s| s.nodes())
        .for_each(|&n| used[n] = true);
    slaves.iter().for_each(|s| used[s.node] = true);
    for entry in names.entries() {
        // A block's edges share its nodes, and the block has a separate entry. A given mesh may have unused nodes: `check` counts
        // them.
        let shares = matches!(
            spec.nodes[entry.at],
            Nodes::Chain { .. } | Nodes::Mesh { .. } | Nodes::Given { .. }
        ) || is_side(spec, spec.nodes[entry.at].id());
        // The first node of a closed chain stands for the last one, at the same place.
        let closed = |n: usize| match entry.nodes[..] {
            [first, .., last] => {
                let other = if n == last { first } else { last };
                [first, last].contains(&n)
                    && used[other]
                    && coincide(&names.nodes, [first, last], length)
            }
            _ => false,
        };
        let idle = entry.nodes.iter().find(|&&n| !used[n] && !closed(n));
        if let (Some(&node), false) = (idle, shares) {
            bail!(
                at!["nodes", entry.at, "id"],
                "node {:?} is not used by any body, surface or slave; remove it or use it",
                names.nodes[node].name
            );
        }
    }
    Ok(())
}

/// Whether a block uses the curve of the chain with this id.
fn is_side(spec: &Spec, id: &str) -> bool {
    let follows = |side: &&Side| matches!(side, Side::Along { chain } if chain == id);
    spec.nodes.iter().any(|nodes| match nodes {
        Nodes::Block { sides, .. } => sides.around().iter().flatten().any(follows),
        _ => false,
    })
}

/// Marks the surfaces that have no unknowns, and turns each endless surface into a single element.
///
/// # Errors
/// If an endless surface is not rigid.
pub(super) fn find_rigid(dofs: &Dofs, surfaces: &mut Surfaces) -> Result<(), Fault> {
    for (surface, &k) in surfaces.made.iter_mut().zip(&surfaces.listed) {
        let rigid = surface.nodes().all(|&n| !can_move(dofs, n));
        surface.rigid = rigid;
        if surface.endless && !surface.rigid {
            bail!(
                at!["surfaces", k, "endless"],
                "endless surfaces must be rigid; this one moves with a body"
            );
        }
        let mut nodes = surface.elements.iter().flatten();
        if surface.endless
            && let (Some(&first), Some(&last)) = (nodes.next(), nodes.next_back())
        {
            surface.elements = vec![vec![first, last]];
        }
    }
    Ok(())
}

/// Whether x or y of a node is an unknown.
fn can_move(dofs: &Dofs, node: usize) -> bool {
    [Component::X, Component::Y].iter().any(|c| {
        dofs.dof(node, *c)
            .is_some_and(|d| dofs.equation[d].is_some())
    })
}

/// Whether x or y of a node that carries a slave node is an unknown.
fn has_motion(dofs: &Dofs, slave: &Contact) -> bool {
    slave.carriers().any(|(node, _)| can_move(dofs, node))
}

/// Removes slave nodes that were listed only through a collective name and cannot do anything: fixed nodes over fixed surfaces.
pub(super) fn drop_idle_slaves(
    spec: &Spec,
    names: &Names,
    dofs: &Dofs,
    surfaces: &[Surface],
    slaves: &mut Vec<Contact>,
) {
    let single = |node: usize| {
        spec.slaves
            .iter()
            .flat_map(|group| &group.nodes)
            .any(|name| names.node(name) == Ok(node))
    };
    slaves.retain(|slave| {
        has_motion(dofs, slave)
            || !slave.surfaces.iter().all(|&s| surfaces[s].rigid)
            || single(slave.node)
    });
}

/// Rejects slave nodes whose constraint would contain no unknown.
pub(super) fn check_held_slaves(
    spec: &Spec,
    names: &Names,
    dofs: &Dofs,
    surfaces: &[Surface],
    slaves: &[Contact],
) -> Result<(), Fault> {
    for slave in slaves.iter().filter(|slave| !has_motion(dofs, slave)) {
        let Some(&rigid) = slave.surfaces.iter().find(|&&s| surfaces[s].rigid) else {
            continue;
        };
        bail!(
            laws::slave_path(spec, names, slave.node),
            "node {:?} and surface {:?} are both fixed, so their contact has no unknown; free one of \
             them, or remove the node from the list",
            names.nodes[slave.node].name,
            surfaces[rigid].name
        );
    }
    Ok(())
}
