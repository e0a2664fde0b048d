//! The compact record of a point of the history, which is never thinned: enough for the timeline, breakpoints
//! and costs.
//!
//! Memory: [`Strip::BYTES_PER_NODE`] bytes per slave node and [`Strip::BYTES_PER_ITERATION`] per iteration. An
//! iteration in which a node moves to another element takes 4 more bytes per node; the start of an increment
//! and the end of a major iteration add their norms.

use crate::explain::unforced::PlaceFinding;
use std::sync::Arc;
use stickslip_core::{
    ContactRecord, Event, Failure, Forced, Mode, Model, Norms, Outcome, Position, State,
};

/// Kind of a point of the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointKind {
    /// The start of the scene.
    Start,
    /// An intervention of the user.
    Intervention,
    /// A minor iteration; the modes have not settled.
    Minor,
    /// A cycle of minor iterations, damped.
    Damped,
    /// The next strategy of the ladder took over.
    Climbed,
    /// The increment was cut and is tried again.
    Cut,
    /// The end of a major iteration.
    Major,
    /// The end of a major iteration; the state was refused by the check, and from here on net slip counts.
    Refused,
    /// The end of an increment: accepted.
    Increment,
    /// Accepted after a jump to another equilibrium branch.
    Jumped,
    /// Accepted, and the end of the history.
    Last,
    /// Accepted after a jump, and the end of the history.
    LastJumped,
    /// A cycle of minor iterations: failed.
    Cycle,
    /// Failed for another reason.
    Failed,
}

use PointKind::*;

impl PointKind {
    /// The kind of an iteration with this outcome.
    pub fn from_outcome(outcome: &Outcome) -> PointKind {
        match outcome {
            Outcome::Minor => Minor,
            Outcome::Damped { .. } => Damped,
            Outcome::StrategyChange { .. } => Climbed,
            Outcome::Cut { .. }
            | Outcome::WholeIncrement { .. }
            | Outcome::Fallback { .. }
            | Outcome::PathCorner { .. }
            | Outcome::Motion(_) => Cut,
            Outcome::HeldBack { .. } => Damped,
            Outcome::Major { .. } => Major,
            Outcome::Refused { .. } => Refused,
            Outcome::Increment { last, jumped, .. } => match (last, jumped) {
                (false, false) => Increment,
                (false, true) => Jumped,
                (true, false) => Last,
                (true, true) => LastJumped,
            },
            Outcome::Failed(Failure::Cycle(_)) => Cycle,
            Outcome::Failed(_) => Failed,
        }
    }

    /// Whether a minor iteration was solved.
    pub fn is_solved(self) -> bool {
        !matches!(self, Start | Intervention)
    }

    /// Whether a major iteration ended, successfully or not.
    pub fn ends_major(self) -> bool {
        self.is_solved() && !matches!(self, Minor | Damped | Climbed)
    }

    /// Whether the increment failed.
    pub fn is_failure(self) -> bool {
        matches!(self, Cycle | Failed)
    }

    /// Whether an increment was accepted.
    pub fn is_accepted(self) -> bool {
        matches!(self, Increment | Jumped | Last | LastJumped)
    }

    /// Whether the history ended.
    pub fn is_last(self) -> bool {
        matches!(self, Last | LastJumped)
    }
}

/// The compact record of one minor iteration, or of the start or an intervention.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// The minor iteration; at the start, the first one to be solved; for an intervention, the last one before
    /// it.
    pub position: Position,
    /// Load factor at the end of its increment.
    pub load_factor: f64,
    /// Leg of the load path that the next increment lies on.
    pub leg: u32,
    /// What happened there.
    pub kind: PointKind,
    /// Relative residual at the start of the major iteration.
    pub residual: f64,
    /// Norms before the iteration, if it is the first of an attempt or belongs to a finished run.
    pub first: Option<Box<Norms>>,
    /// Norms after the iteration, if a major iteration ended successfully.
    pub after: Option<Box<Norms>>,
    /// Bodies that moved without a force in the increment that was accepted here, and nodes past the ends of surfaces.
    pub unforced: Box<[PlaceFinding]>,
    /// Wall time of the solve; not part of the state.
    pub seconds: f32,
    /// One byte per slave node: bits 0-1 mode before, 2-3 next mode, 4 forced once, 5 held, 6 held in a corner,
    /// 7 an attached solver departed from its own rules.
    marks: Box<[u8]>,
    /// Margin of each slave node: signed distance of the deciding inequality from switching (force or length),
    /// rounded.
    margins: Box<[f32]>,
    /// Interface element of each slave node for the next iteration, numbered over all surfaces; shared with the
    /// previous strip if no node moved.
    elements: Arc<[u32]>,
    /// In space, the direction of friction on each slave node in whole degrees, or [`STILL`]; otherwise empty.
    directions: Box<[i16]>,
    /// One letter per slave node, for solvers that do not distinguish stick from slip; otherwise empty.
    letters: Box<[u8]>,
}

/// The direction of a node that does not slide.
const STILL: i16 = i16::MAX;
/// No element.
const NOWHERE: u32 = u32::MAX;
const ONCE: u8 = 1 << 4;
const HELD: u8 = 1 << 5;
const CORNER: u8 = 1 << 6;
const DIFFERS: u8 = 1 << 7;

impl Strip {
    /// A mark and a margin.
    pub const BYTES_PER_NODE: usize = size_of::<u8>() + size_of::<f32>();
    /// Size of an iteration without its nodes.
    pub const BYTES_PER_ITERATION: usize = size_of::<Strip>();

    /// The strip of a state after a minor iteration, or before the first one.
    pub fn new(
        model: &Model,
        state: &State,
        event: Option<&Event>,
        before: Option<&Strip>,
        seconds: f32,
    ) -> Strip {
        let record = |s: usize| event.and_then(|event| event.nodes.get(s));
        let mark = |s: usize| {
            let now = &state.nodes[s];
            let (mode, forced) = match record(s) {
                Some(found) => (found.decision.before, found.forced),
                None => (now.mode, now.forced),
            };
            let corner = record(s).is_some_and(|found| found.corner.is_some());
            let differs = state.outside.is_some() && record(s).is_some_and(ContactRecord::differs);
            let flag = |is: bool, flag: u8| if is { flag } else { 0 };
            mark(mode, now.mode, forced) | flag(corner, CORNER) | flag(differs, DIFFERS)
        };
        let count = state.nodes.len();
        Strip {
            position: event.map_or(state.next, |event| event.position),
            load_factor: event.map_or(state.load_factor, |event| event.load_factor),
            leg: state.start.leg as u32,
            kind: event.map_or(Start, |event| PointKind::from_outcome(&event.outcome)),
            residual: event.map_or(0.0, |event| event.before.relative),
            first: event
                .filter(|event| begins(event) || model.finished.is_some())
                .map(|event| Box::new(event.before)),
            after: event.and_then(|event| norms_after(&event.outcome).copied().map(Box::new)),
            unforced: Box::default(),
            seconds,
            marks: (0..count).map(mark).collect(),
            margins: (0..count)
                .map(|s| record(s).map_or(f32::INFINITY, |found| found.decision.margin() as f32))
                .collect(),
            elements: elements(model, state, before),
            directions: event.map_or_else(Box::default, |event| {
                event
                    .frames
                    .iter()
                    .zip(&event.nodes)
                    .map(|(_, found)| direction(found))
                    .collect()
            }),
            letters: event.map_or_else(Box::default, |event| event.words.letters.clone().into()),
        }
    }

    /// The strip of a state after an intervention; `before` is the previous strip.
    pub fn intervention(model: &Model, state: &State, before: &Strip) -> Strip {
        let mark = |node: &stickslip_core::contact::state::ContactState| {
            mark(node.mode, node.mode, node.forced)
        };
        Strip {
            position: before.position,
            load_factor: state.load_factor,
            leg: state.start.leg as u32,
            kind: Intervention,
            residual: before.residual,
            first: None,
            after: None,
            unforced: Box::default(),
            seconds: 0.0,
            marks: state.nodes.iter().map(mark).collect(),
            margins: before.margins.clone(),
            elements: elements(model, state, Some(before)),
            directions: Box::default(),
            letters: Box::default(),
        }
    }

    /// Number of slave nodes.
    pub fn slaves(&self) -> usize {
        self.marks.len()
    }

    /// Mode of a slave node in this iteration.
    pub fn before(&self, slave: usize) -> Mode {
        mode(self.marks[slave])
    }

    /// Mode of a slave node in the next iteration: that of Table 2, unless the user, damping or the end of the
    /// surface decided.
    pub fn next(&self, slave: usize) -> Mode {
        mode(self.marks[slave] >> 2)
    }

    /// Whether a node's mode changes.
    pub fn changes(&self, slave: usize) -> bool {
        self.before(slave) != self.next(slave)
    }

    /// Whether a node's mode was forced for this iteration, or held.
    pub fn is_forced(&self, slave: usize) -> bool {
        self.marks[slave] & (ONCE | HELD) != 0
    }

    /// Whether a node was held in a corner between two sides.
    pub fn in_corner(&self, slave: usize) -> bool {
        self.marks[slave] & CORNER != 0
    }

    /// Whether an attached solver departed from its own rules at a node.
    pub fn differs(&self, slave: usize) -> bool {
        self.marks[slave] & DIFFERS != 0
    }

    /// Whether a node's mode is held until released.
    pub fn is_held(&self, slave: usize) -> bool {
        self.marks[slave] & HELD != 0
    }

    /// Margin of a node: signed distance from switching (force or length), in single precision; infinite if
    /// nothing was tested.
    pub fn margin(&self, slave: usize) -> f32 {
        self.margins[slave]
    }

    /// Interface element of a slave node for the next iteration, numbered over all surfaces; `None` past the
    /// ends.
    pub fn element(&self, slave: usize) -> Option<u32> {
        Some(self.elements[slave]).filter(|element| *element != NOWHERE)
    }

    /// In space, the direction of friction on a sliding node: degrees from t towards n × t, from -180 to 180.
    pub fn direction(&self, slave: usize) -> Option<i16> {
        let direction = self.directions.get(slave).copied();
        direction.filter(|direction| *direction != STILL)
    }

    /// Letter of a slave node, if the solver reports letters instead of modes.
    pub fn letter(&self, slave: usize) -> Option<u8> {
        self.letters.get(slave).copied()
    }

    /// Whether everything but the margin is the same for two slave nodes.
    pub fn is_alike(&self, one: usize, other: usize) -> bool {
        self.marks[one] == self.marks[other]
            && self.direction(one) == self.direction(other)
            && self.letter(one) == self.letter(other)
    }
}

/// The direction of friction on a sliding node in whole degrees.
fn direction(found: &ContactRecord) -> i16 {
    let slides = found.decision.before == Mode::Sliding && found.f_t > 0.0;
    match found.directions {
        Some([force, _]) if slides => force.to_degrees().round() as i16,
        _ => STILL,
    }
}

/// Whether an event is the first of an attempt.
fn begins(event: &Event) -> bool {
    (event.position.major, event.position.minor) == (1, 1)
}

/// Norms at the end of a major iteration, if the outcome is one.
pub fn norms_after(outcome: &Outcome) -> Option<&Norms> {
    match outcome {
        Outcome::Major { after, .. }
        | Outcome::Refused { after, .. }
        | Outcome::Increment { after, .. } => Some(after),
        _ => None,
    }
}

fn mark(before: Mode, next: Mode, forced: Forced) -> u8 {
    let flag = match forced {
        Forced::No => 0,
        Forced::Once(_) => ONCE,
        Forced::Held(_) => HELD,
    };
    before as u8 | (next as u8) << 2 | flag
}

fn mode(bits: u8) -> Mode {
    match bits & 3 {
        0 => Mode::Free,
        1 => Mode::Sliding,
        _ => Mode::Fixed,
    }
}

/// Elements of a state's nodes; shared with the previous strip if equal.
fn elements(model: &Model, state: &State, before: Option<&Strip>) -> Arc<[u32]> {
    let number = |node: &stickslip_core::contact::state::ContactState| match node.spot {
        None => NOWHERE,
        Some(spot) => {
            let count: usize = model
                .surfaces
                .iter()
                .take(spot.surface)
                .map(|surface| surface.elements.len())
                .sum();
            u32::try_from(count + spot.element).unwrap_or(NOWHERE)
        }
    };
    if let Some(before) = before
        && state
            .nodes
            .iter()
            .map(number)
            .eq(before.elements.iter().copied())
    {
        return before.elements.clone();
    }
    state.nodes.iter().map(number).collect()
}
