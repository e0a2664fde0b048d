//! Bodies that supports and closed contacts leave free to move.

use super::motion::{GroupMotion, LOADED, Motion, words};
use super::numbers::{boundary, displaced, rounded_up, vector};
use super::resting::is_pressed_by_loads;
use super::shape::{DeckShape, PairShape, SlaveGap, nearest};
use nalgebra::Matrix3;
use std::collections::BTreeSet;
use stickslip_core::RunFinding;
use stickslip_scene::sig4;

/// Part of a free motion along an axis above which a support along it stops the motion.
const MOVES: f64 = 1e-3;

/// Whether supports alone leave a group free.
pub fn is_free(shape: &DeckShape, group: usize) -> bool {
    let motion = GroupMotion::new(shape, group, 0);
    !motion.free(shape).is_empty()
}

/// A loaded body that only contact holds, and all of it is open at the start.
pub fn open_at_start(shape: &DeckShape) -> Vec<RunFinding> {
    free_groups(shape, 0, |shape, group, motion, free| {
        if !motion.is_loaded(free) {
            return None;
        }
        let first = shape.pairs_of(group).next()?;
        if shape
            .pairs_of(group)
            .any(|pair| pair.closed().next().is_some())
        {
            return None;
        }
        let nearest = nearest(shape.pairs_of(group));
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
        let held = (0..3)
            .filter(|&k| match closes {
                Some((_, to)) => modes[k] && k != to.iamax(),
                None => moves(k),
            })
            .map(|k| displaced(&set, k, "0."));
        let lines = held.chain(closes.map(|(gap, to)| {
            let along = to.iamax();
            let travel = rounded_up(1.2 * gap / to[along].abs()).copysign(to[along]);
            displaced(&set, along, travel)
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
                pair.name
            ),
            None => format!("no slave node is in front of the master, {}", first.name),
        };
        let is_away = closing.is_some_and(|(_, to)| to.dot(&force) < -LOADED * force.norm());
        let away = if is_away { ", away from it" } else { "" };
        Some(RunFinding {
            rule: "held by open contact",
            cause: format!(
                "{name} is free {} until it touches: all its contact is open at the start ({open}), and step 1 loads it \
                 with the force {}{away}",
                words(free),
                vector(force)
            ),
            cure,
            lines: boundary(lines),
        })
    })
}

/// A loaded body that can slide along its closed contact, because it has no friction.
pub fn free_to_slide(shape: &DeckShape) -> Vec<RunFinding> {
    first_of_suspects(shape, |step| {
        free_groups(shape, step, |shape, group, motion, free| {
            let pair = shape
                .pairs_of(group)
                .find(|pair| touches(pair, step) && !sticks(shape, pair))?;
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
                    pair.name,
                    step + 1,
                    vector(motion.force())
                ),
                cure: format!("hold {name} in these directions, or give the pair *FRICTION"),
                lines: if lines.is_empty() {
                    "*FRICTION\n0.1, 1e4".into()
                } else {
                    lines
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
        let mut pairs = shape.pairs_of(group);
        let slides = motion.is_loaded(free) && pairs.all(|pair| !sticks(shape, pair));
        let pair = shape.pairs_of(group).find(|pair| touches(pair, 0))?;
        (!slides).then(|| RunFinding {
            rule: "free to move",
            cause: format!(
                "{} is free {}: {} slave nodes of {} touch at the start, and no support acts that way",
                shape.group_name(group),
                words(free),
                pair.closed().count(),
                pair.name
            ),
            cure: format!("hold {} in these directions", shape.group_name(group)),
            lines: holding(shape, motion, free),
        })
    })
}

/// A body that only friction holds against a load, with a contact force that does not follow from the loads.
pub fn held_by_friction(shape: &DeckShape) -> Vec<RunFinding> {
    if shape.failed.is_none() {
        return Vec::new();
    }
    first_of_suspects(shape, |step| {
        let of = |group: usize| {
            let mut motion = GroupMotion::new(shape, group, step);
            let mut rough = 0.0_f64;
            for pair in shape.pairs_of(group) {
                rough = rough.max(shape.law(pair).friction);
                motion.hold_contacts(shape, pair, pair.in_front(), shape.is_tied(pair));
            }
            let free = motion.free(shape);
            let pair = shape.pairs_of(group).next()?;
            // The load along free translations.
            let all: Matrix3<f64> = free
                .iter()
                .map(|m| m.fixed_rows::<3>(0).into_owned())
                .map(|m| m * m.transpose())
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
                    pair.name,
                    vector(force),
                    step + 1,
                    sig4(force.norm() / rough),
                    sig4(rough)
                ),
                cure: format!("prescribe the displacement of {name} instead of the force"),
                lines: holding(
                    shape,
                    &motion,
                    &[motion.motion(motion.centre, force.normalize())],
                ),
            })
        };
        shape.groups().into_iter().filter_map(of).collect()
    })
}

/// The findings on the first of the steps that may be the cause with any.
fn first_of_suspects(
    shape: &DeckShape,
    findings: impl Fn(usize) -> Vec<RunFinding>,
) -> Vec<RunFinding> {
    let mut found = shape.suspects().map(|(step, _)| findings(step));
    found.find(|found| !found.is_empty()).unwrap_or_default()
}

/// Whether the nodes of a pair that touch stick.
fn sticks(shape: &DeckShape, pair: &PairShape) -> bool {
    shape.law(pair).friction > 0.0 || shape.is_tied(pair)
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
    let driven = shape
        .all_supports()
        .map(|value| value.node)
        .filter(|node| shape.group(*node) == Some(motion.group))
        .collect();
    let all = shape.group_nodes(motion.group).collect();
    let sets: [BTreeSet<usize>; 3] = [motion.loaded(), driven, all];
    let nodes = sets.into_iter().find(|set| !set.is_empty());
    let set = shape.set_name(&nodes.unwrap_or_default());
    let moving = (0..3).filter(|&k| free.iter().any(|m| m[k].abs() > MOVES));
    boundary(moving.map(|k| displaced(&set, k, "0.")))
}

/// The findings on groups that touching contacts and supports leave free in a step.
fn free_groups(
    shape: &DeckShape,
    step: usize,
    finding: impl Fn(&DeckShape, usize, &GroupMotion, &[Motion]) -> Option<RunFinding>,
) -> Vec<RunFinding> {
    let of = |group: usize| {
        let mut motion = GroupMotion::new(shape, group, step);
        for pair in shape.pairs_of(group) {
            motion.hold_contacts(shape, pair, touching(pair, step), sticks(shape, pair));
        }
        let free = motion.free(shape);
        (!free.is_empty())
            .then(|| finding(shape, group, &motion, &free))
            .flatten()
    };
    shape.groups().into_iter().filter_map(of).collect()
}
