//! Bodies that supports and closed contacts leave free to move.

use super::motion::{GroupMotion, LOADED, Motion, is_tied, pairs_of, words};
use super::numbers::{rounded_up, vector};
use super::resting::is_pressed_by_loads;
use super::shape::{DeckShape, PairShape, SlaveGap, Vector};
use nalgebra::Matrix3;
use std::collections::BTreeSet;
use stickslip_core::RunFinding;
use stickslip_scene::number::sig4;

/// Part of a free motion along an axis above which a support along it stops the motion.
const MOVES: f64 = 1e-3;

/// The groups of bodies.
pub fn groups(shape: &DeckShape) -> BTreeSet<usize> {
    shape.group_of.iter().copied().collect()
}

/// Whether supports alone leave a group free.
pub fn is_free(shape: &DeckShape, group: usize) -> bool {
    !GroupMotion::new(shape, group, 0)
        .free(shape.modes(group))
        .is_empty()
}

/// A loaded body that only contact holds, and all of it is open at the start.
pub fn open_at_start(shape: &DeckShape) -> Vec<RunFinding> {
    free_groups(shape, 0, |shape, group, motion, free| {
        if !motion.is_loaded(free) {
            return None;
        }
        let pairs: Vec<&PairShape> = pairs_of(shape, group).map(|(_, pair)| pair).collect();
        let closed = pairs
            .iter()
            .any(|pair| pair.nodes.iter().any(|n| pair.is_closed(n)));
        let first = *pairs.first()?;
        if closed {
            return None;
        }
        let nearest = pairs
            .iter()
            .filter_map(|pair| Some((*pair, pair.nearest()?)));
        let nearest = nearest.min_by(|a, b| a.1.gap.total_cmp(&b.1.gap));
        let name = shape.group_name(group);
        let force = motion.force();
        let set = shape.set_name(&motion.loaded());
        let modes = shape.modes(group);
        let moves = |k: usize| free.iter().any(|motion| motion[k].abs() > MOVES);
        // The direction in which the body closes the gap.
        let closing = nearest.map(|(pair, node)| {
            let normal = pair.masters[node.face].normal;
            let is_slave = pair.groups[0] == group;
            (node.gap, if is_slave { -normal } else { normal })
        });
        // Supports that keep the body from following the load also keep it from closing the gap.
        let closes = closing.filter(|(_, to)| moves(to.iamax()));
        let held = (0..3).filter(|&k| match closes {
            Some((_, to)) => modes[k] && k != to.iamax(),
            None => moves(k),
        });
        let mut lines: Vec<String> = held
            .map(|k| format!("{set}, {0}, {0}, 0.", k + 1))
            .collect();
        lines.extend(closes.map(|(gap, to)| {
            let along = to.iamax();
            let travel = rounded_up(1.2 * gap / to[along].abs()).copysign(to[along]);
            format!("{set}, {0}, {0}, {travel}", along + 1)
        }));
        let cure = match (closing, closes) {
            (_, Some(_)) => format!(
                "close the gap first: a step before the load with a displacement of {set} by more than the gap"
            ),
            (Some(_), None) => {
                format!("hold {name} in these directions until the contact is closed")
            }
            (None, None) => format!("move {name} to its contact, or hold it in these directions"),
        };
        let open = match nearest {
            Some((pair, node)) => format!(
                "smallest gap {}, node {} of {}",
                sig4(node.gap),
                shape.deck.nodes[node.node].label,
                shape.pair_name(pair)
            ),
            None => format!(
                "no slave node is in front of the master, {}",
                shape.pair_name(first)
            ),
        };
        let away = match closing.is_some_and(|(_, to)| to.dot(&force) < -LOADED * force.norm()) {
            true => ", away from it",
            false => "",
        };
        Some(RunFinding {
            rule: "held by open contact",
            cause: format!(
                "{name} is free {} until it touches: all its contact is open at the start ({open}), and step 1 loads it \
                 with the force {}{away}",
                words(free),
                vector(force)
            ),
            cure,
            lines: match lines.is_empty() {
                true => String::new(),
                false => format!("*BOUNDARY\n{}", lines.join("\n")),
            },
        })
    })
}

/// A loaded body that can slide along its closed contact, because it has no friction.
pub fn free_to_slide(shape: &DeckShape) -> Vec<RunFinding> {
    first_of_suspects(shape, |step| {
        free_groups(shape, step, |shape, group, motion, free| {
            let touching = |k: &(usize, &PairShape)| touches(k.1, step) && !sticks(shape, k.0);
            let (_, pair) = pairs_of(shape, group).find(touching)?;
            if !motion.is_loaded(free) {
                return None;
            }
            let name = shape.group_name(group);
            let lines = holding(shape, motion, free);
            Some(RunFinding {
                rule: "free to slide",
                cause: format!(
                    "{name} is free {}: {} touches without friction, no support acts that way, and step {} \
                     loads it with the force {}",
                    words(free),
                    shape.pair_name(pair),
                    step + 1,
                    vector(motion.force())
                ),
                cure: format!("hold {name} in these directions, or give the pair *FRICTION"),
                lines: match lines.is_empty() {
                    true => "*FRICTION\n0.1, 1e4".into(),
                    false => lines,
                },
            })
        })
    })
}

/// A body that the nodes which touch at the start leave free although they stick, such as a roll. Before a run that may be intended:
/// other nodes can touch later.
pub fn free_to_move(shape: &DeckShape) -> Vec<RunFinding> {
    if shape.failed != Some(0) {
        return Vec::new();
    }
    free_groups(shape, 0, |shape, group, motion, free| {
        let (_, pair) = pairs_of(shape, group).find(|(_, pair)| touches(pair, 0))?;
        let touching = pair.nodes.iter().filter(|node| pair.is_closed(node));
        let slides =
            motion.is_loaded(free) && pairs_of(shape, group).all(|(k, _)| !sticks(shape, k));
        (!slides).then(|| RunFinding {
            rule: "free to move",
            cause: format!(
                "{} is free {}: {} slave nodes of {} touch at the start, and no support acts that way",
                shape.group_name(group),
                words(free),
                touching.count(),
                shape.pair_name(pair)
            ),
            cure: format!("hold {} in these directions", shape.group_name(group)),
            lines: holding(shape, motion, free),
        })
    })
}

/// A body that only friction holds against a load, with a contact force that does not follow from the loads.
pub fn held_by_friction(shape: &DeckShape) -> Vec<RunFinding> {
    if shape.deck.is_incomplete || shape.failed.is_none() {
        return Vec::new();
    }
    first_of_suspects(shape, |step| {
        let of = |group: usize| {
            let mut motion = GroupMotion::new(shape, group, step);
            let mut rough = 0.0_f64;
            for (k, pair) in pairs_of(shape, group) {
                let law = &shape.deck.interactions[shape.deck.pairs[k].interaction];
                rough = rough.max(law.friction);
                let touching = pair.in_front();
                motion.hold_contacts(shape, pair, touching, is_tied(shape, k));
            }
            let free = motion.free(shape.modes(group));
            let (_, pair) = pairs_of(shape, group).next()?;
            // The load along free translations.
            let all: Matrix3<f64> = free
                .iter()
                .map(|m| m.fixed_rows::<3>(0) * m.fixed_rows::<3>(0).transpose())
                .sum();
            let force = all * motion.force();
            let is_small = force.norm() <= LOADED * motion.force().norm();
            if rough == 0.0 || is_small || is_pressed_by_loads(shape, group, step) {
                return None;
            }
            let name = shape.group_name(group);
            Some(RunFinding {
                rule: "held by friction",
                cause: format!(
                    "only friction of {} holds {name} against {} in step {}: this takes a contact force of at least {} in all, \
                     with friction {}",
                    shape.pair_name(pair),
                    vector(force),
                    step + 1,
                    sig4(force.norm() / rough),
                    sig4(rough)
                ),
                cure: format!("prescribe the displacement of {name} instead of the force"),
                lines: holding(shape, &motion, &[axis_motion(force)]),
            })
        };
        groups(shape).into_iter().filter_map(of).collect()
    })
}

/// The motion along a force.
fn axis_motion(force: Vector) -> Motion {
    let along = force.normalize();
    Motion::from_iterator(along.iter().copied().chain([0.0; 3]))
}

/// The findings on the first of the steps that may be the cause with any.
fn first_of_suspects(
    shape: &DeckShape,
    findings: impl Fn(usize) -> Vec<RunFinding>,
) -> Vec<RunFinding> {
    let found = shape.suspects().map(|(step, _)| findings(step));
    let mut found = found.filter(|found| !found.is_empty());
    found.next().unwrap_or_default()
}

/// Whether the nodes of a pair that touch stick.
fn sticks(shape: &DeckShape, pair: usize) -> bool {
    let law = &shape.deck.interactions[shape.deck.pairs[pair].interaction];
    law.friction > 0.0 || is_tied(shape, pair)
}

/// Whether a pair touches at the start of a step; steps before it have closed the gaps in front of the master.
fn touches(pair: &PairShape, step: usize) -> bool {
    touching(pair, step).next().is_some()
}

fn touching(pair: &PairShape, step: usize) -> impl Iterator<Item = &SlaveGap> {
    let nodes = pair.in_front();
    nodes.filter(move |node| step > 0 || pair.is_closed(node))
}

/// Supports that stop free motions, on the loaded nodes, or else on the nodes that displacements drive, or all of the group.
fn holding(shape: &DeckShape, motion: &GroupMotion, free: &[Motion]) -> String {
    let own = |node: &usize| shape.group(*node) == Some(motion.group);
    let motions = shape.deck.steps.iter().flat_map(|step| &step.motions);
    let driven = shape.deck.supports.iter().chain(motions);
    let driven = driven.map(|value| value.node).filter(own).collect();
    let all = (0..shape.deck.nodes.len()).filter(own).collect();
    let sets: [BTreeSet<usize>; 3] = [motion.loaded(), driven, all];
    let nodes = sets.into_iter().find(|set| !set.is_empty());
    let set = shape.set_name(&nodes.unwrap_or_default());
    let moving = (0..3).filter(|&k| free.iter().any(|m| m[k].abs() > MOVES));
    let lines: Vec<String> = moving
        .map(|k| format!("{set}, {0}, {0}, 0.", k + 1))
        .collect();
    match lines.is_empty() {
        true => String::new(),
        false => format!("*BOUNDARY\n{}", lines.join("\n")),
    }
}

/// The findings on groups that touching contacts and supports leave free in a step.
fn free_groups(
    shape: &DeckShape,
    step: usize,
    finding: impl Fn(&DeckShape, usize, &GroupMotion, &[Motion]) -> Option<RunFinding>,
) -> Vec<RunFinding> {
    if shape.deck.is_incomplete {
        return Vec::new();
    }
    let of = |group: usize| {
        let mut motion = GroupMotion::new(shape, group, step);
        for (k, pair) in pairs_of(shape, group) {
            motion.hold_contacts(shape, pair, touching(pair, step), sticks(shape, k));
        }
        let free = motion.free(shape.modes(group));
        (!free.is_empty())
            .then(|| finding(shape, group, &motion, &free))
            .flatten()
    };
    groups(shape).into_iter().filter_map(of).collect()
}
