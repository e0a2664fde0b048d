//! Rules on pairs and ties as the deck defines them: faces, gaps, laws, and slave nodes.

use super::numbers::{plain, rounded, rounded_up};
use super::shape::{DeckShape, PairShape, SlaveGap, SurfaceFace, Vector};
use super::sorted_points::SortedPoints;
use super::supports::is_free;
use std::collections::{BTreeMap, BTreeSet};
use stickslip_core::RunFinding;
use stickslip_exchange::inp::deck::{Faces, Value};
use stickslip_scene::{first_of, joined, sig4};

/// A contact stiffness above this many Young's moduli, by itself and times the element size, is reported. CalculiX recommends 5 to
/// 50 in its usual units; the size makes the rule independent of them.
const STIFF: f64 = 100.0;
/// Contact stiffness times element size that is advised, in Young's moduli.
const ADVISED: f64 = 20.0;
/// Overlap at the start that is reported, in sizes of a slave face.
const OVERLAP: f64 = 0.01;
/// Overlap at the start that is reported if supports hold both bodies, in sizes of a slave face.
const DEEP: f64 = 0.1;
/// Pressure of an overlap that is not reported, in Young's moduli.
const LIGHT: f64 = 1e-6;
/// Slave faces this much larger than master faces are reported.
const COARSE: f64 = 2.0;
/// Cosine between a face and the direction to the other surface, above which it looks away.
const AWAY: f64 = 0.5;
/// Cosine between normals of two surfaces, above which they do not face each other.
const ASIDE: f64 = -0.3;
/// Maximum number of nodes named.
const NAMED: usize = 4;

/// Surfaces whose faces look away from the other surface of their pair, or lie between two elements.
pub fn reversed_faces(shape: &DeckShape) -> Vec<RunFinding> {
    let mut found: Vec<RunFinding> = Vec::new();
    for pair in &shape.pairs {
        let before = found.len();
        let both = [(&pair.slaves, &pair.masters), (&pair.masters, &pair.slaves)];
        let both = both.map(|(own, other)| {
            let mut points: Vec<Vector> = other
                .iter()
                .filter_map(|face| shape.element_centre(face.element))
                .collect();
            if points.is_empty() {
                points.extend(pair.nodes.iter().map(|node| shape.at(node.node)));
            }
            (own, SortedPoints::new(points))
        });
        for (which, (own, other)) in both.iter().enumerate() {
            let bad: Vec<&SurfaceFace> = own
                .iter()
                .filter(|face| shape.is_inner(face) || looks_away(face, other))
                .collect();
            if 2 * bad.len() > own.len() {
                found.extend(reversed(shape, pair, which, &bad, other));
            }
        }
        if found.len() == before && looks_aside(shape, pair) {
            found.extend(reversed(shape, pair, 0, &[], &both[0].1));
        }
    }
    found.dedup();
    found
}

/// Cosine between a face's normal and the direction to the nearest of some points.
fn facing(face: &SurfaceFace, points: &SortedPoints) -> Option<f64> {
    Some(points.towards(face.centre)?.dot(&face.normal))
}

/// Whether no face of a slave looks at the master face that is nearest to it.
fn looks_aside(shape: &DeckShape, pair: &PairShape) -> bool {
    let nearest = |face: &SurfaceFace| {
        let (nearest, ..) = shape.nearest(face.centre, pair)?;
        Some(face.normal.dot(&pair.masters[nearest].normal))
    };
    !pair.slaves.is_empty()
        && !pair.masters.is_empty()
        && pair
            .slaves
            .iter()
            .all(|face| nearest(face).is_none_or(|cosine| cosine > ASIDE))
}

/// Whether a face looks away from the nearest of some points.
fn looks_away(face: &SurfaceFace, others: &SortedPoints) -> bool {
    facing(face, others).is_some_and(|cosine| cosine < -AWAY)
}

/// A surface with faces that look away from the other; without such faces it looks aside.
fn reversed(
    shape: &DeckShape,
    pair: &PairShape,
    which: usize,
    bad: &[&SurfaceFace],
    others: &SortedPoints,
) -> Option<RunFinding> {
    let deck = shape.deck;
    let surface = &deck.surfaces[pair.surfaces[which]];
    let own = [&pair.slaves, &pair.masters][which];
    let first = bad.first().copied().or(own.first())?;
    let inner = bad.iter().filter(|face| shape.is_inner(face)).count();
    let label = |side: usize| format!("S{}", side + 1);
    // The outer side of the same element that looks at the other surface.
    let better = |face: &SurfaceFace| {
        let faces = shape
            .outer_faces(face.element)
            .filter(|face| !looks_away(face, others));
        let to = |face: &SurfaceFace| facing(face, others).unwrap_or(-1.0);
        faces.max_by(|a, b| to(a).total_cmp(&to(b)))
    };
    let mut right: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
    for face in bad {
        let side = better(face).map(|face| face.side);
        right.entry(side).or_default().push(face.element);
    }
    let most = right.into_iter().max_by_key(|(_, elements)| elements.len());
    let same_element = most.and_then(|(side, elements)| Some((side?, elements)));
    let other = &deck.surfaces[pair.surfaces[1 - which]].name;
    let between = match inner {
        0 => String::new(),
        count => format!("; {count} of them lie between two elements"),
    };
    let line = surface.place.line;
    let card = format!("*SURFACE, NAME={} (line {line})", surface.name);
    let (cure, lines): (_, Vec<String>) = match same_element {
        Some((side, elements)) => (
            format!("{} instead of {} in {card}", label(side), label(first.side)),
            elements
                .iter()
                .map(|k| shape.surface_line(*k, side))
                .collect(),
        ),
        None => {
            let body = shape.body_of[first.corners[0]]?;
            let name = &shape.bodies[body];
            let faces = faces_towards(shape, body, others);
            let cure = match faces.len() {
                0 => format!(
                    "none in *SURFACE: no outer face of {name} looks at {other}; move the nodes of {name}"
                ),
                _ => format!("the faces of {name} that look at {other} in {card}"),
            };
            (
                cure,
                faces
                    .iter()
                    .map(|face| shape.surface_line(face.element, face.side))
                    .collect(),
            )
        }
    };
    let (which, looks) = match bad.len() {
        0 => ("none".to_owned(), "looks at"),
        away => (away.to_string(), "look away from"),
    };
    Some(RunFinding {
        rule: "reversed faces",
        cause: format!(
            "{which} of {} faces of {} {looks} {other}, such as {} of element {}{between}",
            own.len(),
            surface.name,
            label(first.side),
            deck.elements[first.element].label
        ),
        cure,
        lines: lines.join("\n"),
    })
}

/// The outer faces of a body that look at the nearest of some points.
fn faces_towards(shape: &DeckShape, body: usize, others: &SortedPoints) -> Vec<SurfaceFace> {
    let mut towards: Vec<(f64, SurfaceFace)> = shape
        .elements(body)
        .flat_map(|k| shape.outer_faces(k))
        .filter_map(|face| Some((facing(&face, others)?, face)))
        .collect();
    let normal: Vector = towards
        .iter()
        .filter(|(cosine, _)| *cosine > AWAY)
        .map(|(_, face)| face.normal)
        .sum();
    towards
        .retain(|(cosine, face)| face.normal.dot(&normal) > AWAY * normal.norm() && *cosine > 0.0);
    towards.into_iter().map(|(_, face)| face).collect()
}

/// Ties of which nodes are beyond the position tolerance, so that they are not tied.
pub fn tie_too_far(shape: &DeckShape) -> Vec<RunFinding> {
    let too_far = shape.ties.iter().filter_map(|tie| {
        let far: Vec<_> = tie.nodes.iter().filter(|node| !tie.is_closed(node)).collect();
        let most = far.iter().map(|node| node.gap.abs().hypot(node.beyond)).fold(0.0, f64::max);
        (!far.is_empty()).then(|| RunFinding {
            rule: "tie out of reach",
            cause: format!(
                "the tie {} leaves {} of {} nodes untied: they are up to {} from the master, beyond its position tolerance of {}",
                tie.name,
                far.len(),
                tie.nodes.len(),
                sig4(most),
                sig4(tie.closes.unwrap_or(0.0))
            ),
            cure: format!("a larger tolerance (line {})", shape.deck.ties[tie.number].place.line),
            lines: format!("*TIE, POSITION TOLERANCE={}", plain(rounded_up(most))),
        })
    });
    too_far.collect()
}

/// Slave nodes that start inside the master.
pub fn overlap(shape: &DeckShape) -> Vec<RunFinding> {
    let overlap = shape.pairs.iter().filter_map(|pair| {
        let size = pair.sizes[0];
        let limit = OVERLAP * size;
        let inside = pair.nodes.iter().filter(|n| n.beyond <= limit && n.gap < -limit);
        let deepest = inside.clone().min_by(|a, b| a.gap.total_cmp(&b.gap))?;
        let depth = -deepest.gap;
        // A press fit of bodies that supports hold is meant so, and a very deep overlap is a surface on the wrong side.
        let is_expelled = pair.groups.iter().any(|group| is_free(shape, *group));
        let is_meant = depth < DEEP * size && !is_expelled;
        if is_meant || pair.closes.is_some() || depth > 0.5 * pair.sizes[1] {
            return None;
        }
        let pressure = shape.stiffness(pair).zip(shape.young(pair)).map(|(stiffness, (young, _))| stiffness * depth / young);
        if pressure.is_some_and(|pressure| pressure < LIGHT) {
            return None;
        }
        let pressure = pressure.map(|pressure| {
            format!(", a pressure of {} Young's moduli at once", sig4(pressure))
        }).unwrap_or_default();
        Some(RunFinding {
            rule: "overlap at the start",
            cause: format!(
                "{} of {} slave nodes of {} start inside the master, at most {} (node {}), which is {} % of a \
                 slave face{pressure}",
                inside.count(),
                pair.nodes.len(),
                pair.name,
                sig4(depth),
                shape.deck.nodes[deepest.node].label,
                sig4(100.0 * depth / size)
            ),
            cure: format!(
                "move the nodes onto the master at the start (*CONTACT PAIR before line {})",
                shape.deck.pairs[pair.number].place.line
            ),
            lines: pair_card(shape, pair, ", ADJUST=0."),
        })
    });
    overlap.collect()
}

/// The card of a contact pair, without SMALL SLIDING and ADJUST.
pub fn pair_card(shape: &DeckShape, pair: &PairShape, more: &str) -> String {
    let faces = shape.deck.pairs[pair.number].faces;
    let kind = if faces { "SURFACE" } else { "NODE" };
    let law = &shape.law(pair).name;
    format!("*CONTACT PAIR, INTERACTION={law}, TYPE={kind} TO SURFACE{more}")
}

/// Contact far stiffer than the bodies, along the normal or along the surface.
pub fn stiff_contact(shape: &DeckShape) -> Vec<RunFinding> {
    let mut found = Vec::new();
    for pair in &shape.pairs {
        let law = shape.law(pair);
        let (Some(stiffness), Some((young, material))) = (shape.stiffness(pair), shape.young(pair))
        else {
            continue;
        };
        let ratio = |stiffness: f64| stiffness * pair.sizes[0] / young;
        let compared = |stiffness: f64| {
            format!(
                "times the element size {} is {} times Young's modulus {} of {material}",
                sig4(pair.sizes[0]),
                sig4(ratio(stiffness)),
                plain(young)
            )
        };
        let advised = rounded(ADVISED * young / pair.sizes[0]);
        let is_far = |stiffness: f64| ratio(stiffness) > STIFF && stiffness > STIFF * young;
        let is_stiff = is_far(stiffness);
        let normal = if is_stiff { advised } else { stiffness };
        let slope = law.stick.filter(|slope| is_far(*slope) || *slope > normal);
        let friction = format!(
            "{}, {}",
            plain(law.friction),
            plain(rounded(normal / 100.0))
        );
        let (line, places) = (law.normal_place.line, law.friction_place.line);
        let mut finding = RunFinding {
            rule: "stiff contact",
            cause: format!(
                "the contact stiffness of {} is K = {}: K {}; CalculiX recommends 5 to 50",
                law.name,
                plain(stiffness),
                compared(stiffness)
            ),
            cure: format!("K of {ADVISED} moduli per element size (line {line})"),
            lines: plain(advised),
        };
        match slope {
            None if !is_stiff => continue,
            None => {}
            Some(slope) if is_stiff => {
                finding.cause += &format!("; the stick slope is {}", plain(slope));
                finding.cure = format!(
                    "K of {ADVISED} moduli per element size, and a hundredth of it as stick slope (lines {line} and {places})"
                );
                finding.lines += &format!("\n*FRICTION\n{friction}");
            }
            Some(slope) => {
                finding = RunFinding {
                    rule: "stick slope",
                    cause: format!(
                        "the stick slope of {} is {}, {} times its contact stiffness {}: the slope {}; it should be about a \
                         hundredth of K",
                        law.name,
                        plain(slope),
                        sig4(slope / stiffness),
                        plain(stiffness),
                        compared(slope)
                    ),
                    cure: format!("a smaller slope (line {places})"),
                    lines: friction,
                }
            }
        }
        found.push(finding);
    }
    found.dedup();
    found
}

/// Slave nodes that are supported against their contact, tied, or slaves of two pairs.
pub fn constrained_slaves(shape: &DeckShape) -> Vec<RunFinding> {
    let deck = shape.deck;
    let supports = shape.all_supports().filter(|_| !deck.is_incomplete);
    let mut found = Vec::new();
    let names = |nodes: &BTreeSet<usize>| {
        let labels = nodes.iter().map(|&node| deck.nodes[node].label);
        first_of(labels, NAMED, ", ")
    };
    for (k, pair) in shape.pairs.iter().enumerate() {
        let own: BTreeMap<usize, &SlaveGap> = pair.nodes.iter().map(|n| (n.node, n)).collect();
        let is_against = |value: &&Value| {
            let node = own
                .get(&value.node)
                .filter(|node| node.beyond <= pair.sizes[1]);
            let along = |(node, axis): (&&SlaveGap, usize)| pair.masters[node.face].normal[axis];
            node.zip(value.direction.axis())
                .is_some_and(|of| along(of).abs() > 0.9)
        };
        let mut against = supports.clone().filter(is_against);
        let held: BTreeSet<usize> = against.clone().map(|value| value.node).collect();
        if let Some(first) = against.next() {
            let rest = joined(
                supports
                    .clone()
                    .filter(|value| value.place == first.place && !is_against(value))
                    .map(|value| support_line(shape, value)),
                "\n",
            );
            found.push(RunFinding {
                rule: "constrained slave nodes",
                cause: format!(
                    "{} of {} slave nodes of {} are supported along the contact normal: {}",
                    held.len(),
                    own.len(),
                    pair.name,
                    names(&held)
                ),
                cure: format!(
                    "leave these nodes out of *BOUNDARY (line {})",
                    first.place.line
                ),
                lines: if rest.is_empty() {
                    "** supports no other node".into()
                } else {
                    rest
                },
            });
        }
        let shared = |nodes: &mut dyn Iterator<Item = &SlaveGap>| -> BTreeSet<usize> {
            nodes
                .map(|node| node.node)
                .filter(|node| own.contains_key(node))
                .collect()
        };
        let tied = shared(&mut shape.ties.iter().flat_map(PairShape::closed));
        let twice = shared(&mut shape.pairs[..k].iter().flat_map(|pair| &pair.nodes));
        let surface = &deck.surfaces[pair.surfaces[0]];
        for (nodes, why) in [
            (tied, "are tied, too"),
            (twice, "are slaves of another pair, too"),
        ] {
            if nodes.is_empty() {
                continue;
            }
            let count = nodes.len();
            found.push(RunFinding {
                rule: "constrained slave nodes",
                cause: format!(
                    "{count} of {} slave nodes of {} {why}: {}",
                    own.len(),
                    pair.name,
                    names(&nodes)
                ),
                cure: if count == own.len() {
                    format!("leave the pair out (line {})", deck.pairs[k].place.line)
                } else {
                    format!(
                        "leave these nodes out of the slave surface {} (line {})",
                        surface.name, surface.place.line
                    )
                },
                lines: remaining(&own, &nodes, shape, surface.name.as_str()),
            });
        }
    }
    found
}

/// A support as a line of *BOUNDARY.
fn support_line(shape: &DeckShape, value: &Value) -> String {
    let label = shape.deck.nodes[value.node].label;
    let direction = value.direction.number();
    format!("{label}, {direction}, {direction}, {}", plain(value.value))
}

/// A surface of the slave nodes without some of them; a comment if that leaves none.
fn remaining(
    own: &BTreeMap<usize, &SlaveGap>,
    without: &BTreeSet<usize>,
    shape: &DeckShape,
    name: &str,
) -> String {
    let rest = joined(
        own.keys()
            .filter(|node| !without.contains(node))
            .map(|&node| format!("{},", shape.deck.nodes[node].label)),
        "\n",
    );
    if rest.is_empty() {
        format!("** {name} is in no pair")
    } else {
        format!("*SURFACE, NAME={name}, TYPE=NODE\n{rest}")
    }
}

/// Slave surfaces coarser than their master.
pub fn coarse_slave(shape: &DeckShape) -> Vec<RunFinding> {
    let coarse = shape
        .pairs
        .iter()
        .filter(|pair| !pair.slaves.is_empty())
        .filter(|pair| pair.sizes[0] > COARSE * pair.sizes[1]);
    coarse
        .map(|pair| {
            let deck = shape.deck;
            let [slave, master] = pair.surfaces.map(|k| deck.surfaces[k].name.as_str());
            let swaps = matches!(deck.surfaces[pair.surfaces[1]].of, Faces::Elements(_));
            RunFinding {
                rule: "coarse slave",
                cause: format!(
                    "the slave {slave} is {} times coarser than its master {master} (faces of {} and {}), so master nodes \
                     pass between slave nodes",
                    sig4(pair.sizes[0] / pair.sizes[1]),
                    sig4(pair.sizes[0]),
                    sig4(pair.sizes[1])
                ),
                cure: format!("swap the surfaces (line {})", deck.pairs[pair.number].place.line),
                lines: if swaps { format!("{master}, {slave}") } else { String::new() },
            }
        })
        .collect()
}
