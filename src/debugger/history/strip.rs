//! What is kept of every minor iteration, whatever happens to its frame: enough for a timeline, breakpoints and costs.
//!
//! Memory: [`Strip::BYTES_PER_NODE`] bytes for each slave node, and [`Strip::BYTES_PER_ITERATION`] for the iteration. An
//! iteration that moves a node to another element adds 4 bytes a node, one that begins an increment or ends a major iteration its norms.

use std::sync::Arc;
use stickslip_core::contact::record::{ContactRecord, Forced};
use stickslip_core::linear::norms::Norms;
use stickslip_core::model::{Mode, Model};
use stickslip_core::step::event::{Event, Failure, Outcome, Position};
use stickslip_core::step::state::State;

/// How a point of the history came to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointKind {
    /// The start of the scene.
    Start,
    /// The user changed something.
    Intervention,
    /// A minor iteration after which the minors go on.
    Minor,
    /// A cycle of minors, damped.
    Damped,
    /// The ladder's next strategy took over.
    Climbed,
    /// The increment was cut.
    Cut,
    /// The end of a major iteration.
    Major,
    /// The same; the judge refused the state, and net slip counts from here on.
    Refused,
    /// The end of an increment: accepted.
    Increment,
    /// The same, and it jumped to another branch of equilibrium.
    Jumped,
    /// Accepted, and the end of the history.
    Last,
    /// The same, and it jumped.
    LastJumped,
    /// A cycle of minors: failed.
    Cycle,
    /// Failed for another reason.
    Failed,
}

impl PointKind {
    /// What an outcome makes of an iteration.
    pub fn of(outcome: &Outcome) -> PointKind {
        match outcome {
            Outcome::Minor => PointKind::Minor,
            Outcome::Damped { .. } => PointKind::Damped,
            Outcome::Climbed { .. } => PointKind::Climbed,
            Outcome::Cut { .. }
            | Outcome::Leaps { .. }
            | Outcome::Fallback { .. }
            | Outcome::Turns { .. }
            | Outcome::Moves(_) => PointKind::Cut,
            Outcome::HeldBack { .. } => PointKind::Damped,
            Outcome::Major { .. } => PointKind::Major,
            Outcome::Refused { .. } => PointKind::Refused,
            Outcome::Increment { last, jumped, .. } => match (last, jumped) {
                (false, false) => PointKind::Increment,
                (false, true) => PointKind::Jumped,
                (true, false) => PointKind::Last,
                (true, true) => PointKind::LastJumped,
            },
            Outcome::Failed(Failure::Cycle(_)) => PointKind::Cycle,
            Outcome::Failed(_) => PointKind::Failed,
        }
    }

    /// Whether a minor iteration was solved here.
    pub fn is_solved(self) -> bool {
        !matches!(self, PointKind::Start | PointKind::Intervention)
    }

    /// Whether a major iteration ended here, well or not.
    pub fn ends_major(self) -> bool {
        self.is_solved()
            && !matches!(
                self,
                PointKind::Minor | PointKind::Damped | PointKind::Climbed
            )
    }

    /// Whether the increment failed here.
    pub fn is_failure(self) -> bool {
        matches!(self, PointKind::Cycle | PointKind::Failed)
    }

    /// Whether an increment was accepted here.
    pub fn is_accepted(self) -> bool {
        matches!(
            self,
            PointKind::Increment | PointKind::Jumped | PointKind::Last | PointKind::LastJumped
        )
    }

    /// Whether the history ended here.
    pub fn is_last(self) -> bool {
        matches!(self, PointKind::Last | PointKind::LastJumped)
    }
}

/// The compact record of one minor iteration, or of the start or an intervention.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// The minor iteration; at the start the first to come; of an intervention the last one before it.
    pub position: Position,
    /// Load factor at the end of its increment.
    pub load_factor: f64,
    /// Leg of the load path on which the next increment lies.
    pub leg: u32,
    /// What happened there.
    pub kind: PointKind,
    /// Relative residual about which the minor iteration was linearised.
    pub residual: f64,
    /// Norms before it, where this is the first minor iteration of an increment's attempt, or any of a finished run.
    pub first: Option<Box<Norms>>,
    /// Norms after it, where a major iteration ended here and did not fail.
    pub after: Option<Box<Norms>>,
    /// Wall time that it took to solve; not a part of the state, and never compared.
    pub seconds: f32,
    /// A byte a slave node: bits 0-1 the mode before, 2-3 the mode next, 4 forced once, 5 held, 6 held where two sides meet, 7 an
    /// attached solver decided otherwise than the rules that it names.
    marks: Box<[u8]>,
    /// Signed distance of the deciding inequality from switching, by slave node (force or length), rounded.
    margins: Box<[f32]>,
    /// Interface element that each slave node is on for the next iteration, numbered over all surfaces; shared with the
    /// strip before where nothing moved.
    elements: Arc<[u32]>,
    /// Letters of a solver that does not distinguish stick from slip, by slave node; else empty.
    letters: Box<[u8]>,
}

/// No element.
const NOWHERE: u32 = u32::MAX;
const ONCE: u8 = 1 << 4;
const HELD: u8 = 1 << 5;
const CORNER: u8 = 1 << 6;
const DIFFERS: u8 = 1 << 7;

impl Strip {
    /// A mark and a margin.
    pub const BYTES_PER_NODE: usize = size_of::<u8>() + size_of::<f32>();
    /// What an iteration takes besides its nodes.
    pub const BYTES_PER_ITERATION: usize = size_of::<Strip>();

    /// The strip of a state that a minor iteration left behind, or of one before any.
    pub fn of(
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
            kind: event.map_or(PointKind::Start, |event| PointKind::of(&event.outcome)),
            residual: event.map_or(0.0, |event| event.before.relative),
            first: event
                .filter(|event| begins(event) || model.finished.is_some())
                .map(|event| Box::new(event.before)),
            after: event.and_then(after),
            seconds,
            marks: (0..count).map(mark).collect(),
            margins: (0..count)
                .map(|s| record(s).map_or(f32::INFINITY, |found| found.decision.margin() as f32))
                .collect(),
            elements: elements(model, state, before),
            letters: event.map_or_else(Box::default, |event| event.words.letters.clone().into()),
        }
    }

    /// The strip of an intervention that led from the strip before to a state.
    pub fn intervention(model: &Model, state: &State, before: &Strip) -> Strip {
        let mark = |node: &stickslip_core::contact::state::ContactState| {
            mark(node.mode, node.mode, node.forced)
        };
        Strip {
            position: before.position,
            load_factor: state.load_factor,
            leg: state.start.leg as u32,
            kind: PointKind::Intervention,
            residual: before.residual,
            first: None,
            after: None,
            seconds: 0.0,
            marks: state.nodes.iter().map(mark).collect(),
            margins: before.margins.clone(),
            elements: elements(model, state, Some(before)),
            letters: Box::default(),
        }
    }

    /// Number of slave nodes.
    pub fn slaves(&self) -> usize {
        self.marks.len()
    }

    /// Mode that a slave node had in this iteration.
    pub fn before(&self, slave: usize) -> Mode {
        mode(self.marks[slave])
    }

    /// Mode that it has in the next one: Table 2's verdict, or another where the user, damping or the end of the surface
    /// had the last word.
    pub fn next(&self, slave: usize) -> Mode {
        mode(self.marks[slave] >> 2)
    }

    /// Whether its mode changes here.
    pub fn changes(&self, slave: usize) -> bool {
        self.before(slave) != self.next(slave)
    }

    /// Whether its mode was forced for this iteration, or held.
    pub fn is_forced(&self, slave: usize) -> bool {
        self.marks[slave] & (ONCE | HELD) != 0
    }

    /// Whether it was held where two sides meet.
    pub fn in_corner(&self, slave: usize) -> bool {
        self.marks[slave] & CORNER != 0
    }

    /// Whether an attached solver decided otherwise on it than the rules that it names.
    pub fn differs(&self, slave: usize) -> bool {
        self.marks[slave] & DIFFERS != 0
    }

    /// Whether its mode was held until released.
    pub fn is_held(&self, slave: usize) -> bool {
        self.marks[slave] & HELD != 0
    }

    /// Signed distance from switching (force or length), rounded to single precision; infinite where nothing was tested.
    pub fn margin(&self, slave: usize) -> f32 {
        self.margins[slave]
    }

    /// Interface element of a slave node for the next iteration, numbered over all surfaces; none past all ends.
    pub fn element(&self, slave: usize) -> Option<u32> {
        Some(self.elements[slave]).filter(|element| *element != NOWHERE)
    }

    /// Letter of a slave node, where the solver gives one in place of a mode.
    pub fn letter(&self, slave: usize) -> Option<u8> {
        self.letters.get(slave).copied()
    }

    /// Whether two strips tell the same, but for the time that it took.
    pub fn tells_the_same(&self, other: &Strip) -> bool {
        let numbers = |strip: &Strip| {
            let margins = strip.margins.iter().map(|margin| margin.to_bits());
            let rest = [strip.load_factor.to_bits(), strip.residual.to_bits()];
            (margins.collect::<Vec<_>>(), rest)
        };
        (self.position, self.kind) == (other.position, other.kind)
            && self.marks == other.marks
            && self.elements == other.elements
            && self.letters == other.letters
            && numbers(self) == numbers(other)
    }
}

/// Whether an event is the first of an increment's attempt.
fn begins(event: &Event) -> bool {
    (event.position.major, event.position.minor) == (1, 1)
}

fn after(event: &Event) -> Option<Box<Norms>> {
    match &event.outcome {
        Outcome::Major { after, .. }
        | Outcome::Refused { after, .. }
        | Outcome::Increment { after, .. } => Some(Box::new(*after)),
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

/// Elements of a state's nodes; the strip's before where they are the same.
fn elements(model: &Model, state: &State, before: Option<&Strip>) -> Arc<[u32]> {
    let number = |node: &stickslip_core::contact::state::ContactState| match node.spot {
        None => NOWHERE,
        Some(spot) => {
            let earlier = model.surfaces.iter().take(spot.surface);
            let count: usize = earlier.map(|surface| surface.elements.len()).sum();
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
