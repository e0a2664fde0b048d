//! Rules on pairs and ties as the deck defines them: faces, gaps, laws, and slave nodes.

use super::numbers::{plain, rounded, rounded_up};
use super::shape::{DeckShape, PairShape, SortedPoints, SurfaceFace, Vector};
use super::supports::is_free;
use std::collections::{BTreeMap, BTreeSet};
use stickslip_core::RunFinding;
use stickslip_exchange::inp::Deck;
use stickslip_exchange::inp::deck::{Direction, Faces, Pair, Value};
use stickslip_scene::number::sig4;
use stickslip_scene::shown::first_of;

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
            let other: Vec<Vector> = match other.is_empty() {
                false => other.iter().map(|face| body_centre(shape, face)).collect(),
                true => pair.nodes.iter().map(|node| shape.at(node.node)).collect(),
            };
            let sorted = SortedPoints::new(&other);
            (own, (other, sorted))
        });
        for (which, (own, other)) in both.iter().enumerate() {
            let wrong = |face: &&SurfaceFace| shape.is_inner(face) || looks_away(face, other);
            let bad: Vec<&SurfaceFace> = own.iter().filter(wrong).collect();
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

fn body_centre(shape: &DeckShape, face: &SurfaceFace) -> Vector {
    let nodes = &shape.deck.elements[face.element].nodes;
    nodes.iter().map(|&node| shape.at(node)).sum::<Vector>() / nodes.len() as f64
}

/// Cosine between a face's normal and the direction to the nearest of some points.
fn facing(face: &SurfaceFace, (points, sorted): &(Vec<Vector>, SortedPoints)) -> Option<f64> {
    let mut best: Option<(f64, Vector)> = None;
    for (along, k) in sorted.from(face.centre) {
        if best.is_some_and(|(known, _)| along >= known) {
            break;
        }
        let to = points[k] - face.centre;
        if best.is_none_or(|(known, _)| to.norm() < known) {
            best = Some((to.norm(), to));
        }
    }
    let to = best?.1.try_normalize(0.0)?;
    Some(to.dot(&face.normal))
}

/// Whether no face of a slave looks at the master face that is nearest to it.
fn looks_aside(shape: &DeckShape, pair: &PairShape) -> bool {
    let nearest = |face: &SurfaceFace| {
        let (nearest, ..) = shape.nearest(face.centre, (&pair.masters, &pair.centres))?;
        Some(face.normal.dot(&pair.masters[nearest].normal))
    };
    let aside = |face| nearest(face).is_none_or(|cosine| cosine > ASIDE);
    !pair.slaves.is_empty() && !pair.masters.is_empty() && pair.slaves.iter().all(aside)
}

/// Whether a face looks away from the nearest of some points.
fn looks_away(face: &SurfaceFace, others: &(Vec<Vector>, SortedPoints)) -> bool {
    facing(face, others).is_some_and(|cosine| cosine < -AWAY)
}

/// A surface with faces that look away from the other; without such faces it looks aside.
fn reversed(
    shape: &DeckShape,
    pair: &PairShape,
    which: usize,
    bad: &[&SurfaceFace],
    others: &(Vec<Vector>, SortedPoints),
) -> Option<RunFinding> {
    let deck = shape.deck;
    let surface = &deck.surfaces[pair.surfaces[which]];
    let own = [&pair.slaves, &pair.masters][which];
    let first = bad.first().copied().or(own.first())?;
    let inner = bad.iter().filter(|face| shape.is_inner(face)).count();
    let label = |side: usize| format!("S{}", side + 1);
    // The outer side of the same element that looks at the other surface.
    let better = |face: &SurfaceFace| {
        let sides = 0..deck.elements[face.element].kind.cell.sides().len();
        let faces = sides.filter_map(|side| shape.face(face.element, side));
        let faces = faces.filter(|face| !shape.is_inner(face) && !looks_away(face, others));
        let to = |face: &SurfaceFace| facing(face, others).unwrap_or(-1.0);
        faces.max_by(|a, b| to(a).total_cmp(&to(b)))
    };
    let mut right: BTreeMap<Option<usize>, Vec<u64>> = BTreeMap::new();
    for face in bad {
        let side = better(face).map(|face| face.side);
        let element = deck.elements[face.element].label;
        right.entry(side).or_default().push(element);
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
    let (cure, lines) = match same_element {
        Some((side, elements)) => {
            let lines: Vec<String> = elements
                .iter()
                .map(|element| format!("{element}, {}", label(side)))
                .collect();
            (
                format!("{} instead of {} in {card}", label(side), label(first.side)),
                lines,
            )
        }
        None => {
            let body = shape.body_of[first.corners[0]];
            let name = body.map_or("the body", |body| shape.bodies[body].as_str());
            let looks: Vec<String> = faces_towards(shape, body, others)
                .iter()
                .map(|face| {
                    let element = deck.elements[face.element].label;
                    format!("{element}, {}", label(face.side))
                })
                .collect();
            let cure = match looks.is_empty() {
                true => format!(
                    "none in *SURFACE: no outer face of {name} looks at {other}; move the nodes of {name}"
                ),
                false => format!("the faces of {name} that look at {other} in {card}"),
            };
            (cure, looks)
        }
    };
    let which = match bad.len() {
        0 => format!(
            "none of {} faces of {} looks at {other}",
            own.len(),
            surface.name
        ),
        away => format!(
            "{away} of {} faces of {} look away from {other}",
            own.len(),
            surface.name
        ),
    };
    Some(RunFinding {
        rule: "reversed faces",
        cause: format!(
            "{which}, such as {} of element {}{between}",
            label(first.side),
            deck.elements[first.element].label
        ),
        cure,
        lines: lines.join("\n"),
    })
}

/// The outer faces of a body that look at the nearest of some points.
fn faces_towards(
    shape: &DeckShape,
    body: Option<usize>,
    others: &(Vec<Vector>, SortedPoints),
) -> Vec<SurfaceFace> {
    let elements = &shape.deck.elements;
    let of_body = (0..elements.len()).filter(|k| shape.body_of[elements[*k].nodes[0]] == body);
    let sides = of_body.flat_map(|k| {
        let sides = 0..elements[k].kind.cell.sides().len();
        sides.filter_map(move |side| shape.face(k, side))
    });
    let outer: Vec<SurfaceFace> = sides.filter(|face| !shape.is_inner(face)).collect();
    let towards =
        |face: &SurfaceFace, least: f64| facing(face, others).is_some_and(|cosine| cosine > least);
    let ahead = outer.iter().filter(|face| towards(face, AWAY));
    let normal: Vector = ahead.map(|face| face.normal).sum();
    let looks = outer
        .iter()
        .filter(|face| face.normal.dot(&normal) > AWAY * normal.norm() && towards(face, 0.0));
    looks.cloned().collect()
}

/// Ties of which nodes are beyond the position tolerance, so that they are not tied.
pub fn tie_too_far(shape: &DeckShape) -> Vec<RunFinding> {
    let too_far = shape.ties.iter().zip(&shape.deck.ties).filter_map(|(tie, card)| {
        let far: Vec<_> = tie.nodes.iter().filter(|node| !tie.is_closed(node)).collect();
        let most = far.iter().map(|node| node.gap.abs().hypot(node.beyond));
        let most = most.fold(0.0, f64::max);
        let needed = rounded_up(most);
        (!far.is_empty()).then(|| RunFinding {
            rule: "tie out of reach",
            cause: format!(
                "the tie {} leaves {} of {} nodes untied: they are up to {} from the master, beyond its position tolerance of {}",
                shape.pair_name(tie),
                far.len(),
                tie.nodes.len(),
                sig4(most),
                sig4(tie.closes.unwrap_or(0.0))
            ),
            cure: format!("a larger tolerance (line {})", card.place.line),
            lines: format!("*TIE, POSITION TOLERANCE={}", plain(needed)),
        })
    });
    too_far.collect()
}

/// Slave nodes that start inside the master.
pub fn overlap(shape: &DeckShape) -> Vec<RunFinding> {
    let mut found = Vec::new();
    for (k, pair) in shape.pairs.iter().enumerate() {
        let size = pair.sizes[0];
        let in_front = pair
            .nodes
            .iter()
            .filter(|node| node.beyond <= OVERLAP * size);
        let inside: Vec<_> = in_front.filter(|node| node.gap < -OVERLAP * size).collect();
        let Some(deepest) = inside.iter().min_by(|a, b| a.gap.total_cmp(&b.gap)) else {
            continue;
        };
        // A press fit of bodies that supports hold is meant so, and a very deep overlap is a surface on the wrong side.
        let is_expelled = pair.groups.iter().any(|group| is_free(shape, *group));
        if (-deepest.gap < DEEP * size && !is_expelled)
            || pair.closes.is_some()
            || -deepest.gap > 0.5 * pair.sizes[1]
        {
            continue;
        }
        let deck = shape.deck;
        let pressure = match (shape.stiffness(k), shape.young(pair)) {
            (Some(stiffness), Some((young, _))) => -stiffness * deepest.gap / young,
            _ => f64::INFINITY,
        };
        if pressure < LIGHT {
            continue;
        }
        let pressure = match pressure.is_finite() {
            true => format!(", a pressure of {} Young's moduli at once", sig4(pressure)),
            false => String::new(),
        };
        let card = &deck.pairs[k];
        found.push(RunFinding {
            rule: "overlap at the start",
            cause: format!(
                "{} of {} slave nodes of {} start inside the master, at most {} (node {}), which is {} % of a \
                 slave face{pressure}",
                inside.len(),
                pair.nodes.len(),
                shape.pair_name(pair),
                sig4(-deepest.gap),
                deck.nodes[deepest.node].label,
                sig4(-100.0 * deepest.gap / size)
            ),
            cure: format!(
                "move the nodes onto the master at the start (*CONTACT PAIR before line {})",
                card.place.line
            ),
            lines: pair_card(deck, card, ", ADJUST=0."),
        });
    }
    found
}

/// The card of a contact pair, without SMALL SLIDING and ADJUST.
pub fn pair_card(deck: &Deck, card: &Pair, more: &str) -> String {
    let kind = if card.faces { "SURFACE" } else { "NODE" };
    let law = &deck.interactions[card.interaction].name;
    format!("*CONTACT PAIR, INTERACTION={law}, TYPE={kind} TO SURFACE{more}")
}

/// Contact far stiffer than the bodies, along the normal or along the surface.
pub fn stiff_contact(shape: &DeckShape) -> Vec<RunFinding> {
    let mut found = Vec::new();
    for (k, pair) in shape.pairs.iter().enumerate() {
        let law = &shape.deck.interactions[shape.deck.pairs[k].interaction];
        let (Some(stiffness), Some((young, material))) = (shape.stiffness(k), shape.young(pair))
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
        let why = format!(
            "the contact stiffness of {} is K = {}",
            law.name,
            plain(stiffness)
        );
        found.extend(match (is_stiff, slope) {
            (false, None) => None,
            (true, None) => Some(RunFinding {
                rule: "stiff contact",
                cause: format!("{why}: K {}; CalculiX recommends 5 to 50", compared(stiffness)),
                cure: format!("K of {ADVISED} moduli per element size (line {line})"),
                lines: plain(advised),
            }),
            (true, Some(slope)) => Some(RunFinding {
                rule: "stiff contact",
                cause: format!(
                    "{why}: K {}; CalculiX recommends 5 to 50; the stick slope is {}",
                    compared(stiffness),
                    plain(slope)
                ),
                cure: format!(
                    "K of {ADVISED} moduli per element size, and a hundredth of it as stick slope (lines {line} and {places})"
                ),
                lines: format!("{}\n*FRICTION\n{friction}", plain(advised)),
            }),
            (false, Some(slope)) => Some(RunFinding {
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
            }),
        });
    }
    found.dedup();
    found
}

/// Slave nodes that are supported against their contact, tied, or slaves of two pairs.
pub fn constrained_slaves(shape: &DeckShape) -> Vec<RunFinding> {
    let deck = shape.deck;
    let motions = deck.steps.iter().flat_map(|step| &step.motions);
    let supports = deck.supports.iter().chain(motions);
    let supports: Vec<&Value> = supports.filter(|_| !deck.is_incomplete).collect();
    let mut found = Vec::new();
    let names = |nodes: &BTreeSet<usize>| {
        first_of(
            nodes.iter().map(|&node| deck.nodes[node].label),
            NAMED,
            ", ",
        )
    };
    for (k, pair) in shape.pairs.iter().enumerate() {
        let own: BTreeMap<usize, Vector> = pair
            .nodes
            .iter()
            .map(|node| (node.node, pair.masters[node.face].normal))
            .collect();
        let near = pair.nodes.iter().filter(|n| n.beyond <= pair.sizes[1]);
        let near: BTreeSet<usize> = near.map(|node| node.node).collect();
        let against = supports.iter().filter(|value| {
            let axis = match value.direction {
                Direction::X => Vector::x(),
                Direction::Y => Vector::y(),
                Direction::Z => Vector::z(),
                Direction::Rotation => return false,
            };
            let normal = own.get(&value.node);
            let is_against = normal.is_some_and(|normal| normal.dot(&axis).abs() > 0.9);
            is_against && near.contains(&value.node)
        });
        let against: Vec<&&Value> = against.collect();
        let held: BTreeSet<usize> = against.iter().map(|value| value.node).collect();
        if let Some(first) = against.first() {
            let rest = supports.iter().filter(|value| {
                value.place == first.place && !against.iter().any(|other| other == value)
            });
            let rest: Vec<String> = rest.map(|value| support_line(shape, value)).collect();
            found.push(RunFinding {
                rule: "constrained slave nodes",
                cause: format!(
                    "{} of {} slave nodes of {} are supported along the contact normal: {}",
                    held.len(),
                    own.len(),
                    shape.pair_name(pair),
                    names(&held)
                ),
                cure: format!(
                    "leave these nodes out of *BOUNDARY (line {})",
                    first.place.line
                ),
                lines: match rest.is_empty() {
                    true => "** supports no other node".into(),
                    false => rest.join("\n"),
                },
            });
        }
        let tied: BTreeSet<usize> = shape
            .ties
            .iter()
            .flat_map(|tie| tie.nodes.iter().filter(|node| tie.is_closed(node)))
            .map(|node| node.node)
            .filter(|node| own.contains_key(node))
            .collect();
        let others = shape.pairs.iter().take(k);
        let twice: BTreeSet<usize> = others
            .flat_map(|pair| pair.nodes.iter().map(|node| node.node))
            .filter(|node| own.contains_key(node))
            .collect();
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
                    shape.pair_name(pair),
                    names(&nodes)
                ),
                cure: match count == own.len() {
                    true => format!("leave the pair out (line {})", deck.pairs[k].place.line),
                    false => format!(
                        "leave these nodes out of the slave surface {} (line {})",
                        surface.name, surface.place.line
                    ),
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
    own: &BTreeMap<usize, Vector>,
    without: &BTreeSet<usize>,
    shape: &DeckShape,
    name: &str,
) -> String {
    let rest = own.keys().filter(|node| !without.contains(node));
    let rest: Vec<String> = rest
        .map(|&node| format!("{},", shape.deck.nodes[node].label))
        .collect();
    match rest.is_empty() {
        true => format!("** {name} is in no pair"),
        false => format!("*SURFACE, NAME={name}, TYPE=NODE\n{}", rest.join("\n")),
    }
}

/// Slave surfaces coarser than their master.
pub fn coarse_slave(shape: &DeckShape) -> Vec<RunFinding> {
    let coarse = shape.pairs.iter().filter(|pair| !pair.slaves.is_empty());
    let coarse = coarse.filter(|pair| pair.sizes[0] > COARSE * pair.sizes[1]);
    coarse
        .map(|pair| {
            let deck = shape.deck;
            let [slave, master] = pair.surfaces.map(|k| deck.surfaces[k].name.as_str());
            let card = deck.pairs.iter().find(|card| [card.slave, card.master] == pair.surfaces);
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
                cure: format!(
                    "swap the surfaces (line {})",
                    card.map_or(0, |card| card.place.line)
                ),
                lines: match swaps {
                    true => format!("{master}, {slave}"),
                    false => String::new(),
                },
            }
        })
        .collect()
}
