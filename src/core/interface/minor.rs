//! One minor iteration at one slave node: Table 1's equations before the solve, and the strategy's decision after it.
//!
//! These are pure functions of the node's state and the solution, so that a minor iteration on a separate interface problem
//! ([`super::trials::Trials`]) is the same as one of the stepper.

use crate::contact::table1::{direction, t_max};
use crate::contact::table2::Entry;
use crate::interface::method;
use crate::interface::rows::{carried, moves};
use crate::model::{Bond, SlipCount, Touch};
use crate::{
    BoundUpdate, ContactRecord, ContactState, Decision, Forced, Friction, Method, Mode,
    NodeIncrement, NodeKinematics, Numbers, Rule, Settings, Ties,
};

/// Parameters for checking modes.
#[derive(Clone, Copy)]
pub struct Check<'a> {
    /// The effective settings; their strategy is never the ladder itself ([`crate::strategy::in_force`]).
    pub settings: Settings,
    /// The implementation of that strategy.
    pub method: &'a dyn Method,
    /// Tie tolerances.
    pub ties: Ties,
    /// Stiffness of the springs that relate lengths to forces (force per length).
    pub stiffness: f64,
}

/// Checks a node's mode and sets that of the next minor iteration; returns the record and whether mode and T_max have converged.
pub fn check(
    node: &mut ContactState,
    kinematics: Option<&NodeKinematics>,
    given: NodeIncrement,
    friction: &Friction,
    check: &Check<'_>,
) -> (ContactRecord, bool) {
    let before = *node;
    let ties = &check.ties;
    let (record, turned) = record(&before, kinematics, given, friction, check);
    let [normal, tangential] = given.motion;
    node.travel = if normal.abs() > f64::MIN_POSITIVE {
        tangential / normal
    } else {
        0.0
    };
    let sense = sense(&before, &record, tangential, &check.settings);
    node.sign = turned
        .unwrap_or_else(|| direction(record.f_t, ties.force, sense, ties.length, before.sign));
    node.t_max = t_max(friction, record.f_n, node.sign);
    node.mode = record.decision.next;
    if let Forced::Once(_) = node.forced {
        node.forced = Forced::No;
    }
    // A motion below the tolerance, as at the start of a major iteration near equilibrium, has no direction.
    let ratio = if normal.abs() > ties.length {
        node.travel
    } else {
        0.0
    };
    leave_or_enter(node, &before, check.settings.touch, ratio);
    let lag = before.mode == Mode::Sliding
        && (record.t_max_used - node.t_max).abs() > ties.force.max(f64::MIN_POSITIVE);
    let settled = !record.decision.changes() && !lag;
    let record = ContactRecord {
        t_max: node.t_max,
        ..record
    };
    (record, settled)
}

/// The record of a minor iteration at a node, and the direction of T_max if the strategy determines it.
fn record(
    node: &ContactState,
    kinematics: Option<&NodeKinematics>,
    given: NodeIncrement,
    friction: &Friction,
    check: &Check<'_>,
) -> (ContactRecord, Option<f64>) {
    let (settings, ties) = (&check.settings, &check.ties);
    let (f_n, f_t) = (node.f_n + given.force[0], node.f_t + given.force[1]);
    let [normal, tangential] = given.motion;
    let gap = kinematics.map_or(f64::INFINITY, |k| k.gap);
    let moves = moves(kinematics);
    let here = tangential
        - if node.ratio == 0.0 {
            0.0
        } else {
            gap * node.ratio
        };
    let slip = match (node.mode, settings.slip) {
        (Mode::Free, _) => 0.0,
        (_, SlipCount::Increment) => node.slipped(settings) + here,
        (_, SlipCount::Major) => tangential,
    };
    let sign = direction(f_t, ties.force, slip, ties.length, node.sign);
    let limit = t_max(friction, f_n, sign);
    let entry = if friction.is_smooth() {
        Entry::Smooth
    } else {
        check.method.entry()
    };
    let numbers = Numbers {
        mode: node.mode,
        gap: gap - normal,
        f_n,
        f_t,
        t_max: limit,
        slip,
        entry,
    };
    let known = method::NodeContext {
        friction,
        ties,
        spring: check.stiffness,
        sign: node.sign,
        slip: node.slipped(settings) + here,
    };
    let method::Choice {
        mut decision,
        sign: turned,
    } = check.method.choose(&numbers, &known);
    let fixed = decision.before == Mode::Fixed && decision.next == Mode::Fixed;
    if fixed && !moves[1] && slip.abs() > ties.length {
        decision = decision.dragged(slip);
    }
    if node.corner.is_some() {
        decision = decision.in_corner();
    } else if let Some(room) = kinematics.and_then(|k| k.room_for(tangential)) {
        decision = decision.with_room(tangential.abs(), room, ties);
    }
    let bond = kinematics.map_or(Bond::Hard, |k| k.bond);
    if bond.is_tied() {
        decision = Decision::tied();
    } else if kinematics.is_none() {
        decision.rule = Rule::OffSurface;
        (decision.next, decision.wanted, decision.tests) = (Mode::Free, Mode::Free, [None; 2]);
    } else if let Forced::Held(mode) = node.forced {
        decision.next = mode;
        if decision.wanted != mode {
            decision.rule = Rule::Held;
        }
    }
    let record = ContactRecord {
        decision,
        forced: node.forced,
        gap: match bond.give()[0] {
            0.0 => numbers.gap,
            give => numbers.gap - give * f_n,
        },
        f_n,
        f_t,
        t_max: limit,
        t_max_used: match (node.mode, settings.t_max) {
            (Mode::Sliding, BoundUpdate::Lagged) => node.t_max,
            (Mode::Sliding, BoundUpdate::Consistent) => f_t,
            _ => limit,
        },
        slip,
        drift: match node.mode {
            Mode::Free => 0.0,
            _ => node.drift + here,
        },
        spot: node.spot,
        normal: kinematics.map_or(node.normal, |k| k.normal),
        foot: kinematics.map_or([f64::NAN; 2], |k| k.foot),
        directions: None,
        corner: node.corner.filter(|_| node.mode == Mode::Fixed),
        carried: carried(node.mode, moves),
    };
    (record, turned)
}

/// Lets only the first of all changing nodes change its mode. The others keep their mode from `before` the iteration, and their
/// records show that they wait.
pub fn one_at_a_time(
    nodes: &mut [ContactState],
    before: &[ContactState],
    records: &mut [ContactRecord],
) {
    for ((node, before), record) in nodes
        .iter_mut()
        .zip(before)
        .zip(records)
        .filter(|(_, record)| record.decision.changes())
        .skip(1)
    {
        *node = ContactState {
            travel: node.travel,
            forced: node.forced,
            ..*before
        };
        (record.decision.next, record.decision.rule) = (before.mode, Rule::Waits);
    }
}

/// The motion along t (length) whose sign gives the direction of T_max: the slip of a touching node; the motion of a free one,
/// measured from its anchor if it keeps one.
fn sense(
    before: &ContactState,
    record: &ContactRecord,
    tangential: f64,
    settings: &Settings,
) -> f64 {
    if before.mode == Mode::Free {
        if before.kept {
            before.slipped(settings) + tangential
        } else {
            tangential
        }
    } else {
        record.slip
    }
}

/// Sets the ratio ρ (eqn 14) when a node touches and resets it when the node opens. A node that has kept its anchor has no ρ,
/// because it returns to its anchor.
fn leave_or_enter(node: &mut ContactState, before: &ContactState, touch: Touch, ratio: f64) {
    match (before.mode, node.mode) {
        (_, Mode::Free) => node.ratio = 0.0,
        (Mode::Free, _) if touch != Touch::Start && !before.kept => {
            node.ratio = ratio;
        }
        _ => {}
    }
}
