//! Positions of the slave nodes relative to their surfaces before the first solve: initial gaps, warnings about them, and the
//! effect of `settings.initial_gaps`.

use crate::few;
use crate::number::sig4;
use crate::overlaps;
use crate::pressed;
use crate::unmatched;
use std::collections::BTreeMap;
use stickslip_core::contact::element::closed;
use stickslip_core::contact::facing::{MOST as MOST_SURFACES, faced};
use stickslip_core::contact::projection::{project, projection_apart, projection_at};
use stickslip_core::fem::lagrange;
use stickslip_core::groups::{distinct, marked};
use stickslip_core::plane::{dot, plus, range};
use stickslip_core::{
    Body, Contact, InitialGaps, Model, Node, Surface, SurfaceElement, SurfacePoint,
};

/// Gaps below this fraction of the scene's length count as zero.
const NONE: f64 = 1e-9;
/// `past_ends` with which nodes flush with an end of a surface are on it.
const FLUSH: f64 = 0.5;
/// Maximum number of names in a warning.
const MOST: usize = 5;
/// Above this cosine, the outward sides of a slave's body and of its surface count as facing the same way.
const SAME_WAY: f64 = 0.5;

/// The initial gaps of the slave nodes above one surface.
#[derive(Debug, Clone, PartialEq)]
pub struct StartGaps {
    /// Number of the surface.
    pub surface: usize,
    /// Number of slave nodes above it.
    pub nodes: usize,
    /// Smallest and largest gap (length); negative is penetration.
    pub range: [f64; 2],
    /// Slave numbers of nodes that start inside.
    pub inside: Vec<usize>,
}

/// Projections of each slave node on its surfaces, with the gap (length); `None` if it is beyond the ends of all of them.
fn stands(
    nodes: &[Node],
    surfaces: &[Surface],
    contacts: &[Contact],
) -> Vec<Option<(SurfacePoint, f64)>> {
    let places: Vec<[f64; 2]> = nodes.iter().map(|node| node.at).collect();
    contacts
        .iter()
        .map(|contact| {
            let at = places[contact.node];
            let mut room = [0; MOST_SURFACES];
            let on = faced(contact, surfaces, &places, &mut room);
            let spot = project(at, surfaces, on, &places, None)?;
            Some((spot, projection_at(surfaces, spot, &places, at).gap))
        })
        .collect()
}

/// The initial gaps of each surface that has slave nodes above it; empty in space.
pub fn start_gaps(model: &Model) -> Vec<StartGaps> {
    if model.space.is_some() {
        return Vec::new();
    }
    let stands = stands(&model.nodes, &model.surfaces, &model.contacts);
    let of = |surface: usize| {
        let over: Vec<(usize, f64)> = stands
            .iter()
            .enumerate()
            .filter_map(|(slave, stand)| {
                let (spot, gap) = (*stand)?;
                (spot.surface == surface).then_some((slave, gap))
            })
            .collect();
        let inside = over.iter().filter(|(_, gap)| *gap < -NONE * model.length);
        (!over.is_empty()).then(|| StartGaps {
            surface,
            nodes: over.len(),
            range: range(over.iter().map(|(_, gap)| *gap)),
            inside: inside.map(|(slave, _)| *slave).collect(),
        })
    };
    (0..model.surfaces.len()).filter_map(of).collect()
}

/// A range in words; only one number if both ends are equal as shown.
pub(crate) fn from_to(least: f64, largest: f64) -> String {
    let [least, largest] = [least, largest].map(sig4);
    if least == largest {
        least
    } else {
        format!("{least} to {largest}")
    }
}

/// The initial gaps of each surface as short text, for `check` and the debugger's first screen.
pub fn words(model: &Model) -> Vec<String> {
    let line = |found: StartGaps| {
        let name = &model.surfaces[found.surface].name;
        let [least, largest] = found.range.map(|gap| {
            if gap.abs() <= NONE * model.length {
                0.0
            } else {
                gap
            }
        });
        let range = from_to(least, largest);
        let inside = match found.inside.len() {
            0 => String::new(),
            n => format!(", {n} of {} inside", found.nodes),
        };
        format!("{name} {range}{inside}")
    };
    let mut all: Vec<String> = start_gaps(model).into_iter().map(line).collect();
    let away = faces_none(model);
    if !away.is_empty() {
        let names = some(model, &away);
        let (count, of) = (away.len(), model.contacts.len());
        all.push(format!(
            "off all surfaces: {names} ({count} of {of} slave nodes)"
        ));
    }
    all
}

/// Slave numbers of the nodes that face no surface before the first solve.
fn faces_none(model: &Model) -> Vec<usize> {
    if model.space.is_some() {
        return Vec::new();
    }
    let stands = stands(&model.nodes, &model.surfaces, &model.contacts);
    let away = stands
        .iter()
        .enumerate()
        .filter(|(_, stand)| stand.is_none());
    away.map(|(slave, _)| slave).collect()
}

/// Warnings about the initial state, one sentence each, the most serious first.
pub fn warnings(model: &Model) -> Vec<String> {
    let mut all: Vec<String> = turned(model)
        .iter()
        .map(|found| found.words(model))
        .collect();
    let gaps = start_gaps(model);
    for found in gaps.iter().filter(|found| !found.inside.is_empty()) {
        let names = some(model, &found.inside);
        let name = &model.surfaces[found.surface].name;
        let count = found.inside.len();
        let deepest = -found.range[0];
        let next = match model.settings.initial_gaps {
            InitialGaps::Keep if count == found.nodes => {
                "the surface's outward side, on the right of its walk, may be wrong (reverse). Otherwise the first increment pushes them out; settings.initial_gaps=adjust moves them onto the surface without stress, and ramp pushes them out over the first leg"
            }
            InitialGaps::Keep => {
                "the first increment pushes them out; settings.initial_gaps=adjust moves them onto the surface without stress, ramp pushes them out over the first leg"
            }
            InitialGaps::Ramp => "they are pushed out over the first leg of the path",
            InitialGaps::Adjust => {
                "their surface moved with them, because its own nodes are slaves too"
            }
        };
        let start = if count == 1 { "starts" } else { "start" };
        all.push(format!(
            "{count} of {} slave nodes {start} inside surface {name}, by at most {} ({names}): {next}",
            found.nodes,
            sig4(deepest)
        ));
    }
    let away = faces_none(model);
    if !away.is_empty() && away.len() == model.contacts.len() {
        let names = some(model, &away);
        all.push(format!("no slave node faces a surface at the start ({names}): all are past the ends of their surfaces"));
    }
    all.extend(missed_by_ramp(model));
    all.extend(unheld(model));
    all.extend(overlaps::at_start(model));
    all.extend(pressed::warnings(model));
    let stands = stands(&model.nodes, &model.surfaces, &model.contacts);
    all.extend(unmatched::warnings(model, &stands));
    all
}

/// A surface with the wrong orientation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TurnedSurface {
    /// Number of the surface.
    pub surface: usize,
    /// Number of slave nodes that it faces away from, and of all above it.
    pub away: [usize; 2],
}

impl TurnedSurface {
    /// Describes the surface, and what to do.
    pub fn words(&self, model: &Model) -> String {
        let name = &model.surfaces[self.surface].name;
        let nodes = match self.away {
            [away, all] if away == all => "all its slave nodes".to_owned(),
            [away, all] => format!("{away} of its {all} slave nodes"),
        };
        format!(
            "surface {name} faces away from {nodes}: its outward side, on the right of its walk, points the same way as the outward sides of their bodies, so they start behind it; set reverse, or walk it in the other direction"
        )
    }
}

/// Surfaces whose outward side faces the same way as those of the bodies of most slave nodes on them.
pub fn turned(model: &Model) -> Vec<TurnedSurface> {
    let stands = stands(&model.nodes, &model.surfaces, &model.contacts);
    let outward = outward(model);
    let looks = |surface: usize| {
        let over = stands
            .iter()
            .zip(&model.contacts)
            .filter_map(|(stand, contact)| {
                let (spot, _) = (*stand)?;
                let own = outward_of(contact, &outward)?;
                (spot.surface == surface).then(|| {
                    let element =
                        SurfaceElement::from_surface(&model.surfaces[surface], spot.element);
                    let slopes = element.shape(spot.xi).d;
                    let n = normal(element.nodes, &model.nodes, &slopes);
                    dot(own, n)
                })
            });
        let over: Vec<f64> = over.collect();
        let away = over.iter().filter(|cosine| **cosine > SAME_WAY).count();
        (2 * away > over.len()).then_some(TurnedSurface {
            surface,
            away: [away, over.len()],
        })
    };
    (0..model.surfaces.len()).filter_map(looks).collect()
}

/// Unit normal on the right of an element, at these shape function derivatives.
fn normal(element: &[usize], nodes: &[Node], slopes: &[f64]) -> [f64; 2] {
    let mut slope = [0.0; 2];
    for (&node, d) in element.iter().zip(slopes) {
        slope[0] += d * nodes[node].at[0];
        slope[1] += d * nodes[node].at[1];
    }
    let size = slope[0].hypot(slope[1]).max(f64::MIN_POSITIVE);
    [slope[1] / size, -slope[0] / size]
}

/// Mean outward direction at each outline node of a solid (not a unit vector at a corner).
fn outward(model: &Model) -> Vec<Option<[f64; 2]>> {
    let mut all: Vec<Option<[f64; 2]>> = vec![None; model.nodes.len()];
    let solids = model.bodies.iter().filter_map(Body::solid);
    for edge in solids.flat_map(|solid| &solid.edges) {
        let count = edge.len().saturating_sub(1).max(1);
        for (k, &node) in edge.iter().enumerate() {
            let xi = -1.0 + 2.0 * k as f64 / count as f64;
            let n = normal(edge, &model.nodes, &lagrange::shape(edge.len(), xi).d);
            let sum = all[node].get_or_insert([0.0; 2]);
            *sum = plus(*sum, n);
        }
    }
    for sum in all.iter_mut().flatten() {
        let size = sum[0].hypot(sum[1]).max(f64::MIN_POSITIVE);
        *sum = sum.map(|x| x / size);
    }
    all
}

/// Mean outward direction of a contact: of its node, or of the nodes of its side.
fn outward_of(contact: &Contact, at_nodes: &[Option<[f64; 2]>]) -> Option<[f64; 2]> {
    contact
        .carriers()
        .try_fold([0.0; 2], |sum, (node, weight)| {
            let own = at_nodes[node]?;
            Some([sum[0] + weight * own[0], sum[1] + weight * own[1]])
        })
}

/// Bodies without a support, prescribed displacement or contact.
fn unheld(model: &Model) -> Vec<String> {
    let held = |node: usize| {
        let own = model.dofs.of_node(node);
        model.dofs.equation[own].iter().any(Option::is_none)
    };
    let mut bodies_at = vec![0_usize; model.nodes.len()];
    for &node in model.bodies.iter().flat_map(|body| &body.nodes) {
        bodies_at[node] += 1;
    }
    let joined = |body: &Body| body.nodes.iter().any(|&node| bodies_at[node] > 1);
    let contacts = model.contacts.iter();
    let slaves: Vec<usize> = contacts
        .flat_map(|contact| contact.carriers().map(|(node, _)| node))
        .collect();
    let contacts = model.contacts.iter();
    let met = distinct(contacts.flat_map(|contact| contact.surfaces.iter().copied()));
    let masters = met.iter().flat_map(|&k| model.surfaces[k].nodes());
    let at_contact = marked(model.nodes.len(), slaves.iter().chain(masters));
    let touches = |body: &Body| body.nodes.iter().any(|&node| at_contact[node]);
    model
        .bodies
        .iter()
        .filter(|body| !body.is_linear())
        .filter(|body| !body.nodes.iter().any(|&node| held(node)))
        .filter(|body| !joined(body) && !touches(body))
        .map(|body| {
            format!(
                "body {} has neither a support nor a contact, so nothing holds it",
                body.name
            )
        })
        .collect()
}

fn some(model: &Model, slaves: &[usize]) -> String {
    let name = |&slave: &usize| &model.nodes[model.contacts[slave].node].name;
    few(slaves.iter().map(name), MOST)
}

/// Moves slave nodes that start inside, or at most `within` away (length), onto their surfaces.
pub(super) fn adjust(nodes: &mut [Node], surfaces: &[Surface], contacts: &[Contact], within: f64) {
    for contact in contacts {
        // One after the other, because a master's nodes may be slaves too.
        let places: Vec<[f64; 2]> = nodes.iter().map(|node| node.at).collect();
        let at = places[contact.node];
        let mut room = [0; MOST_SURFACES];
        let on = faced(contact, surfaces, &places, &mut room);
        if let Some(spot) = project(at, surfaces, on, &places, None) {
            let over = projection_at(surfaces, spot, &places, at);
            if over.gap <= within {
                nodes[contact.node].at = over.foot;
            }
        }
    }
}

/// Records the initial penetration of the slave nodes, to be closed over the first leg.
pub(super) fn ramp(nodes: &[Node], surfaces: &[Surface], contacts: &mut [Contact]) {
    let places: Vec<[f64; 2]> = nodes.iter().map(|node| node.at).collect();
    let stands = stands(nodes, surfaces, contacts);
    for (contact, stand) in contacts.iter_mut().zip(stands) {
        contact.overlap = stand.map_or(0.0, |(spot, _)| {
            let at = places[contact.node];
            let over = projection_apart(true, surfaces, spot, &places, at);
            (-over.gap).max(0.0)
        });
    }
}

/// Warns of the nodes of a press fit that are inside a body, but past the ends of its surface: they have no overlap to be closed
/// gradually.
fn missed_by_ramp(model: &Model) -> Vec<String> {
    if model.settings.initial_gaps != InitialGaps::Ramp {
        return Vec::new();
    }
    let mut longer = model.surfaces.clone();
    for surface in longer.iter_mut().filter(|s| !closed(s) && !s.endless) {
        surface.past_ends = surface.past_ends.map(|past| past.max(2.0 * FLUSH));
    }
    let [own, all] = [&model.surfaces, &longer].map(|s| stands(&model.nodes, s, &model.contacts));
    let mut missed: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (slave, (own, stand)) in own.iter().zip(all).enumerate() {
        if let (None, Some((spot, gap))) = (own, stand)
            && gap < -NONE * model.length
        {
            missed.entry(spot.surface).or_default().push(slave);
        }
    }
    let words = |(surface, slaves): (usize, Vec<usize>)| {
        format!(
            "{} start inside surface {}, past its ends: they are not pushed out over the first leg, but at once when they touch it; \
             past_ends: {FLUSH} makes them start on the surface",
            some(model, &slaves),
            model.surfaces[surface].name
        )
    };
    missed.into_iter().map(words).collect()
}
