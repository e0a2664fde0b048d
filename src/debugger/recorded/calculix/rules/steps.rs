//! Rules on steps: how far prescribed displacements move contacts per increment and in all, and whether increments can be cut.

use super::numbers::{boundary, displaced, plain, rounded, two_digits};
use super::pairs::pair_card;
use super::shape::{DeckShape, PairShape, Vector};
use std::collections::{HashMap, HashSet};
use stickslip_core::RunFinding;
use stickslip_exchange::inp::deck::{Direction, Step};
use stickslip_scene::{joined, sig4};

/// Motion of the first increment that is reported, in sizes of a slave face.
const FIRST: f64 = 0.5;
/// Motion of an increment that is advised, in sizes of a slave face.
const ADVISED: f64 = 0.1;
/// Sliding that needs large displacements, in sizes of a slave face.
const SLIDING: f64 = 1.0;
/// Part of a body's height by which squeezing it is reported, and the part that is advised.
const SQUEEZED: f64 = 0.5;
const SQUEEZABLE: f64 = 0.3;
/// A body this much softer than the other bears all of the squeezing.
const SOFT: f64 = 10.0;
/// Increments that cannot be cut to this part are reported.
const CUT: f64 = 0.5;

/// Displacement that a step prescribes on a group: per axis the largest change of its nodes, at two times of the step.
fn travel(shape: &DeckShape, step: usize, group: usize, times: [f64; 2]) -> Vector {
    let deck = shape.deck;
    let mut travel = Vector::zeros();
    let this = &deck.steps[step];
    let mut before: HashMap<(usize, Direction), f64> = HashMap::new();
    for earlier in &deck.steps[..step] {
        for value in &earlier.motions {
            let part = shape.last_factor(earlier, value.amplitude);
            before.insert(value.target(), value.value * part);
        }
    }
    for value in &this.motions {
        let Some(axis) = value.direction.axis() else {
            continue;
        };
        if shape.group(value.node) != Some(group) {
            continue;
        }
        let before = before.get(&value.target()).copied().unwrap_or(0.0);
        let [from, to] = times.map(|time| match value.amplitude {
            None => before + (value.value - before) * shape.factor(this, None, time),
            amplitude => value.value * shape.factor(this, amplitude, time),
        });
        if (to - from).abs() > travel[axis].abs() {
            travel[axis] = to - from;
        }
    }
    travel
}

/// Motion of the slave of a pair relative to its master in a part of a step.
fn relative(shape: &DeckShape, step: usize, pair: &PairShape, times: [f64; 2]) -> Vector {
    let [slave, master] = pair.groups.map(|group| travel(shape, step, group, times));
    slave - master
}

/// The steps that may be the cause, with their numbers and each pair.
fn moves<'s>(shape: &'s DeckShape) -> impl Iterator<Item = (usize, &'s Step, &'s PairShape)> {
    shape
        .suspects()
        .flat_map(|(k, step)| shape.pairs.iter().map(move |pair| (k, step, pair)))
}

/// First increments that move a contact by much of an element.
pub fn first_increment(shape: &DeckShape) -> Vec<RunFinding> {
    let large = moves(shape).filter_map(|(k, step, pair)| {
        let time = step.time;
        let first = relative(shape, k, pair, [0.0, time.initial]).norm();
        let size = pair.sizes[0];
        if first <= FIRST * size * (1.0 + 1e-4) || time.period == 0.0 {
            return None;
        }
        let initial = rounded(time.initial * ADVISED * size / first);
        let least = initial / 100.0;
        Some(RunFinding {
            rule: "large first increment",
            cause: format!(
                "the first increment of step {} moves {} by {}, {} times the size {} of a slave face",
                k + 1,
                pair.name,
                sig4(first),
                sig4(first / size),
                sig4(size)
            ),
            cure: format!("smaller increments (line {})", step.static_place.line),
            lines: [initial, time.period, least, initial].map(plain).join(", "),
        })
    });
    large.collect()
}

/// Steps whose increments can hardly be cut.
pub fn no_cuts(shape: &DeckShape) -> Vec<RunFinding> {
    let fixed = shape.suspects().filter_map(|(k, step)| {
        let time = step.time;
        let line = step.static_place.line;
        let times = [time.initial, time.period, rounded(time.initial / 1000.0)];
        let times = joined(times.into_iter().chain(time.most).map(plain), ", ");
        // Before a run, DIRECT is taken as intended.
        let (why, cure, lines) = match time.direct {
            true if shape.failed.is_none() => return None,
            true => (
                format!("have the fixed size {} (DIRECT)", plain(time.initial)),
                format!("*STATIC without DIRECT, and a minimum (before line {line})"),
                format!("*STATIC\n{times}"),
            ),
            false => {
                let least = time.least.filter(|least| *least > CUT * time.initial)?;
                (
                    format!(
                        "start at {} and must not fall below {}",
                        plain(time.initial),
                        plain(least)
                    ),
                    format!("a smaller minimum (line {line})"),
                    times,
                )
            }
        };
        Some(RunFinding {
            rule: "no room for cuts",
            cause: format!(
                "increments of step {} {why}: after the first failure the run stops",
                k + 1
            ),
            cure,
            lines,
        })
    });
    fixed.collect()
}

/// Sliding over elements in steps, or pairs, with small displacements.
pub fn small_sliding(shape: &DeckShape) -> Vec<RunFinding> {
    let mut found: Vec<RunFinding> = Vec::new();
    for (k, step, pair) in moves(shape) {
        let along = pair
            .along(relative(shape, k, pair, [0.0, step.time.period]))
            .norm();
        let card = &shape.deck.pairs[pair.number];
        if along <= SLIDING * pair.sizes[0] || (step.nlgeom && !card.small_sliding) {
            continue;
        }
        let (why, cure, lines) = if step.nlgeom {
            (
                "the pair has SMALL SLIDING, which keeps the first master face",
                format!(
                    "leave SMALL SLIDING out (*CONTACT PAIR before line {})",
                    card.place.line
                ),
                pair_card(shape, pair, ""),
            )
        } else {
            (
                "the step has no NLGEOM",
                format!(
                    "large displacements in all steps (line {})",
                    step.place.line
                ),
                step.increments.map_or("*STEP, NLGEOM".into(), |most| {
                    format!("*STEP, NLGEOM, INC={most}")
                }),
            )
        };
        found.push(RunFinding {
            rule: "small displacements",
            cause: format!(
                "step {} slides {} by {}, {} slave faces, but {why}",
                k + 1,
                pair.name,
                sig4(along),
                sig4(along / pair.sizes[0])
            ),
            cure,
            lines,
        });
    }
    found
}

/// Prescribed displacements that squeeze the bodies of a pair by much of their height.
pub fn squeezed(shape: &DeckShape) -> Vec<RunFinding> {
    let squeezed = moves(shape).filter_map(|(k, step, pair)| {
        let normal = pair.normal();
        let moved = relative(shape, k, pair, [0.0, step.time.period]);
        let gap = pair.nearest()?.gap.max(0.0);
        let squeezed = -moved.dot(&normal) - gap;
        let moduli = [&pair.slaves, &pair.masters].map(|faces| {
            let material = faces.first().and_then(|face| shape.material(face.element));
            material.and_then(|k| shape.deck.materials[k].elastic)
        });
        let soft = match moduli {
            [Some((a, _)), Some((b, _))] if a > SOFT * b => &pair.groups[1..],
            [Some((a, _)), Some((b, _))] if b > SOFT * a => &pair.groups[..1],
            _ => &pair.groups,
        };
        let height: f64 = soft.iter().map(|group| shape.height(*group, normal)).sum();
        let names = joined(soft.iter().map(|group| shape.group_name(*group)), " and ");
        let name = names;
        let stays = (gap + SQUEEZABLE * height) / (gap + squeezed);
        (height > 0.0 && squeezed > SQUEEZED * height).then(|| RunFinding {
            rule: "squeezed flat",
            cause: format!(
                "step {} squeezes {name} by {}, {} of its height {}: elements at its edges fold before",
                k + 1,
                sig4(squeezed),
                sig4(squeezed / height),
                sig4(height)
            ),
            cure: format!("a smaller displacement, {SQUEEZABLE} of the height"),
            lines: shorter(shape, step, pair, stays),
        })
    });
    squeezed.collect()
}

/// Prescribed displacements that move slave nodes past the edge of their master.
pub fn past_the_edge(shape: &DeckShape) -> Vec<RunFinding> {
    let first = |pair: &PairShape| {
        let mut moved = Vector::zeros();
        shape.reached().find_map(|(k, step)| {
            moved += relative(shape, k, pair, [0.0, step.time.period]);
            let along = pair.along(moved);
            let limit = 0.1 * pair.sizes[0];
            let past = |part: f64, limit: f64| {
                pair.nodes.iter().filter(|node| node.beyond <= limit).filter(|node| {
                    let at = shape.at(node.node) + part * along;
                    let off = shape.nearest(at, pair);
                    off.is_some_and(|(_, _, beyond)| beyond > limit)
                }).count()
            };
            let lost = past(1.0, 5.0 * limit);
            if along.norm() <= limit || lost == 0 {
                return None;
            }
            // The part of the way on which all nodes stay on the master.
            let (mut stays, mut leaves) = (0.0, 1.0);
            for _ in 0..20 {
                let half = (stays + leaves) / 2.0;
                match past(half, limit) {
                    0 => stays = half,
                    _ => leaves = half,
                }
            }
            let master = &shape.deck.surfaces[pair.surfaces[1]];
            Some(RunFinding {
                rule: "past the edge",
                cause: format!(
                    "step {} moves {lost} of {} slave nodes of {} past the edge of the master: they slide {}, and the \
                     first leaves it after {}",
                    k + 1,
                    pair.nodes.len(),
                    pair.name,
                    sig4(along.norm()),
                    sig4(along.norm() * stays)
                ),
                cure: format!(
                    "add the faces that the slave reaches to {} (line {}), or slide less",
                    master.name, master.place.line
                ),
                lines: shorter(shape, step, pair, stays),
            })
        })
    };
    shape.pairs.iter().filter_map(first).collect()
}

/// The lines of a step's displacements of both bodies of a pair, scaled.
fn shorter(shape: &DeckShape, step: &Step, pair: &PairShape, part: f64) -> String {
    let mut places = HashSet::new();
    let lines = step
        .motions
        .iter()
        .filter(|value| {
            let own = shape.group(value.node);
            let own = own.is_some_and(|own| pair.groups.contains(&own));
            own && value.value != 0.0 && places.insert((value.place, value.direction))
        })
        .filter_map(|value| {
            let same = step
                .motions
                .iter()
                .filter(|other| other.place == value.place);
            let set = shape.set_name(&same.map(|other| other.node).collect());
            let size = two_digits(0.95 * part * value.value);
            Some(displaced(&set, value.direction.axis()?, plain(size)))
        });
    boundary(lines)
}
