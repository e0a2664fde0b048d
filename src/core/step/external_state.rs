//! States of solvers that store their own data: what a debugger shows of them, updated from event to event.

use crate::step::state::ExternalState;
use crate::{
    ContactRecord, ContactState, Decision, Event, Forced, IncrementStart, Intervention, Mode,
    Model, Outcome, Position, Rule, State, Status, SurfacePoint,
};
use std::sync::Arc;

impl ExternalState {
    /// At a place, without changes since.
    pub fn at(&self, place: u64) -> ExternalState {
        ExternalState {
            place,
            asked: Vec::new(),
            set: self.set.clone(),
            largest_force: self.largest_force,
        }
    }
}

impl State {
    /// Start of a solver that stores its own data: place 0, every node over its first surface.
    pub fn outside_start(model: &Model) -> State {
        let mut state = State::at_start(model, vec![0.0; model.dofs.len()], Vec::new());
        state.way = None;
        for (node, contact) in state.nodes.iter_mut().zip(&model.contacts) {
            node.spot = Some(SurfacePoint {
                surface: contact.surfaces.first().copied().unwrap_or(0),
                element: 0,
                xi: 0.0,
            });
        }
        let start = IncrementStart {
            nodes: state.nodes.clone(),
            ..(*state.start).clone()
        };
        state.start = Arc::new(start);
        state.outside = Some(Box::default());
        state
    }

    /// Number of the place of an attached solver; `None` for the built-in solver.
    pub fn place(&self) -> Option<u64> {
        self.outside.as_ref().map(|outside| outside.place)
    }

    /// Changes since it reached that place.
    pub fn changes(&self) -> &[Intervention] {
        self.outside.as_ref().map_or(&[], |outside| &outside.asked)
    }

    /// Moves to the result of an event, at the place with this number: updates modes and numbers of the contacts, the next
    /// iteration, and the start of the increment if one was accepted. The caller sets the displacements (`u`) first.
    pub fn follow(&mut self, event: &Event, place: u64) {
        self.attempt.minors = self.attempt.minors.saturating_add(1);
        for (node, record) in self.nodes.iter_mut().zip(&event.nodes) {
            node.renew(record);
        }
        self.load_factor = event.load_factor;
        (self.major.last_target, self.major.target) = (event.load_factor, event.load_factor);
        self.next = after(event.position, &event.outcome);
        self.status = match &event.outcome {
            Outcome::Failed(failure) => Status::Failed(failure.clone()),
            Outcome::Increment { last: true, .. } => Status::Finished,
            _ => Status::Running,
        };
        match event.outcome {
            Outcome::Cut { size, .. } if size.is_finite() => {
                Arc::make_mut(&mut self.controls).increment = size;
            }
            Outcome::Increment { .. } => {
                self.attempt.minors = 0;
                self.start = Arc::new(IncrementStart {
                    load_factor: event.load_factor,
                    leg: self.start.leg,
                    u: self.u.clone(),
                    nodes: self.nodes.clone(),
                    history: Vec::new(),
                    verdict: None,
                });
            }
            _ => {}
        }
        let outside = self.outside.take().unwrap_or_default();
        self.outside = Some(Box::new(outside.at(place)));
    }
}

/// Position of the iteration after one with this outcome.
fn after(at: Position, outcome: &Outcome) -> Position {
    let next = |count: u32| count.saturating_add(1);
    match outcome {
        Outcome::Minor
        | Outcome::Damped { .. }
        | Outcome::StrategyChange { .. }
        | Outcome::HeldBack { .. }
        | Outcome::Failed(_) => Position {
            minor: next(at.minor),
            ..at
        },
        Outcome::Major { .. } | Outcome::Refused { .. } => Position {
            major: next(at.major),
            minor: 1,
            ..at
        },
        Outcome::Cut { .. }
        | Outcome::WholeIncrement { .. }
        | Outcome::PathCorner { .. }
        | Outcome::Fallback { .. }
        | Outcome::Motion(_) => Position {
            attempt: next(at.attempt),
            major: 1,
            minor: 1,
            ..at
        },
        // The history is finished.
        Outcome::Increment { last: true, .. } => at,
        Outcome::Increment { .. } => Position {
            increment: next(at.increment),
            attempt: 1,
            major: 1,
            minor: 1,
        },
    }
}

impl ContactState {
    /// Stores the results of an iteration. A mode forced for that iteration is released.
    fn renew(&mut self, record: &ContactRecord) {
        self.mode = record.decision.next;
        if let Forced::Once(_) = self.forced {
            self.forced = Forced::No;
        }
        (self.f_n, self.f_t, self.t_max) = (record.f_n, record.f_t, record.t_max);
        self.sign = match record.t_max {
            t_max if t_max > 0.0 => 1.0,
            t_max if t_max < 0.0 => -1.0,
            _ => 0.0,
        };
        (self.slip, self.drift) = (record.slip, record.drift);
        (self.normal, self.corner, self.spot) = (record.normal, record.corner, record.spot);
    }
}

impl ContactRecord {
    /// Record of an attached solver for a node that solved in one mode and continues in another, by its own rules: no force and
    /// no slip, an infinite gap and the upward normal, until they are filled in.
    pub fn from_modes(before: Mode, next: Mode, node: &ContactState) -> ContactRecord {
        ContactRecord {
            decision: Decision {
                before,
                next,
                rule: Rule::Theirs,
                tests: [None, None],
                wanted: next,
            },
            forced: node.forced,
            gap: f64::INFINITY,
            f_n: 0.0,
            f_t: 0.0,
            t_max: 0.0,
            t_max_used: 0.0,
            slip: 0.0,
            drift: 0.0,
            spot: node.spot,
            normal: [0.0, 1.0],
            foot: [0.0, 0.0],
            directions: None,
            corner: None,
            carried: [false; 2],
        }
    }
}
