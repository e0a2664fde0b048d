//! Motions: forward, back, and to a step; over recorded steps, and past the end of the line.

use super::machine::{Reply, Session, Task};
use super::refusal::Refusal;
use super::worker::Steps;
use crate::history::breakpoints::{self, Breakpoint};
use crate::history::strip::{PointKind, Strip};
use crate::record::command::Unit;
use std::sync::Arc;
use stickslip_core::step::event::Event;
use stickslip_core::step::solver::GoesBack;
use stickslip_core::step::state::{State, Status};

impl Session {
    /// Moves the cursor over recorded steps, then solves.
    pub(super) fn forward(&mut self, unit: Unit, count: u32) -> Reply {
        let mut left = count;
        let (mut at, mut hits) = (self.cursor, Vec::new());
        let strips = self.strips();
        while left > 0 && hits.is_empty() && at + 1 < strips.len() {
            at += 1;
            left -= u32::from(self.ends(unit, &strips[at]));
            if strips[at].kind.is_failure() {
                left = 0;
            }
            hits = breakpoints::hits(&self.breakpoints, &strips[at - 1], &strips[at]);
        }
        let finished = self.frames()[at].state.status == Status::Finished;
        if left == 0 || !hits.is_empty() || finished {
            return self.go_to(at, &hits);
        }
        self.cursor = at;
        self.solve(unit, left, self.breakpoints.clone());
        Reply(self.way() + "running; Ctrl-C interrupts")
    }

    /// Whether a motion by this unit ends at a point. A run over a finished record also ends at each attempt
    /// that was given up.
    fn ends(&self, unit: Unit, strip: &Strip) -> bool {
        let given_up = unit == Unit::Run && strip.kind == PointKind::Cut;
        unit.ends(strip.kind) || (given_up && self.model().finished.is_some())
    }

    /// Solves new minor iterations from the cursor, which is at the tip.
    pub(super) fn solve(&mut self, unit: Unit, count: u32, breakpoints: Vec<Breakpoint>) {
        let run = Steps::Run {
            before: self.strips()[self.cursor].clone(),
            unit,
            count,
            breakpoints,
        };
        self.work(self.cursor, Task::Run, run);
    }

    /// Starts steps from a point of the line. An attached solver may have to return there first.
    pub(super) fn work(&mut self, from: usize, task: Task, steps: Steps) {
        self.stands.again = self.back_to(from).unwrap_or_default();
        self.task = Some(task);
        self.worker.start(self.frames()[from].state.clone(), steps);
    }

    pub(super) fn back(&mut self, unit: Unit, count: u32) -> Result<Reply, Refusal> {
        if self.cursor == 0 {
            return Err(Refusal::Start);
        }
        let strips = self.strips();
        let (mut at, mut hits) = (self.cursor, Vec::new());
        for _ in 0..count {
            if at == 0 {
                // The start is reached before the count is used up.
                break;
            }
            let here = |k: usize| match k {
                0 => Vec::new(),
                k => breakpoints::hits(&self.breakpoints, &strips[k - 1], &strips[k]),
            };
            let stops = |k: &usize| match unit {
                Unit::Minor => true,
                Unit::Run => self.ends(unit, &strips[*k]) || !here(*k).is_empty(),
                _ => unit.ends(strips[*k].kind),
            };
            at = (0..at).rev().find(stops).unwrap_or(0);
            hits = if unit == Unit::Run {
                here(at)
            } else {
                Vec::new()
            };
        }
        Ok(self.go_to(at, &hits))
    }

    pub(super) fn jump(&mut self, step: usize) -> Result<Reply, Refusal> {
        let last = self.frames().len() - 1;
        if step > last {
            return Err(Refusal::NoStep { step, last });
        }
        Ok(self.go_to(step, &[]))
    }

    /// Moves the cursor to a point of the line. A thinned frame is recomputed first, from the nearest whole
    /// frame before it.
    pub(super) fn go_to(&mut self, target: usize, hits: &[u32]) -> Reply {
        let from = self.tree.whole_before(target);
        if from == target {
            self.cursor = target;
            let way = match self.back_to(target) {
                Some(way) if self.frame().state.status != Status::Finished => {
                    format!("; to continue from here, {way}")
                }
                _ => String::new(),
            };
            return Reply(self.stops(hits) + &self.told() + &way);
        }
        let frames = &self.frames()[from..=target];
        let steps = frames[1..].iter().map(|frame| frame.intervention.clone());
        let again = Steps::Again {
            event: frames[0].event.clone(),
            steps: steps.collect(),
        };
        let task = Task::Again {
            next: from + 1,
            target,
            sound: true,
        };
        self.work(from, task, again);
        Reply(format!(
            "recomputing {} steps; Ctrl-C interrupts",
            target - from
        ))
    }

    /// What an attached solver has to repeat before it can continue from a point of the line; `None` if it is
    /// there already or gets there directly.
    pub(super) fn back_to(&self, target: usize) -> Option<String> {
        self.log()?;
        let place = self.frames()[target].state.outside.as_ref()?.place;
        let lost = self.stands.lost.is_some();
        if self.offers.past.is_some() || self.stands.at == Some(place) {
            return None;
        }
        let way = &self.strips()[..=target];
        let solved =
            |strips: &[Strip]| strips.iter().filter(|strip| strip.kind.is_solved()).count();
        let again = |count: usize| match count {
            0 => String::new(),
            1 => " and repeats 1 iteration".into(),
            count => format!(" and repeats {count} iterations"),
        };
        match self.offers.goes_back {
            _ if lost => Some(format!(
                "the solver, whose connection was lost, restarts{}",
                again(solved(way))
            )),
            GoesBack::Again => Some(format!("the solver restarts{}", again(solved(way)))),
            GoesBack::ToIncrements => {
                let begun = way.iter().rposition(|strip| strip.kind.is_accepted());
                match solved(&way[begun.map_or(0, |at| at + 1)..]) {
                    0 => None,
                    count => Some(format!(
                        "the solver returns to the start of the increment{}",
                        again(count)
                    )),
                }
            }
            GoesBack::ToAny => None,
        }
    }

    /// What the solver of the running job has to repeat, as the beginning of a reply.
    pub(super) fn way(&self) -> String {
        match self.stands.again.as_str() {
            "" => String::new(),
            again => format!("{again}; "),
        }
    }

    /// Notes that an attached solver has reached a state.
    pub(super) fn stand_at(&mut self, state: &State) {
        self.stands.at = state.outside.as_ref().map(|outside| outside.place);
        self.stands.lost = None;
    }

    pub(super) fn refill(&mut self, state: State, event: Option<Arc<Event>>) {
        if let Some(Task::Again { next, sound, .. }) = &mut self.task {
            *sound &= self.tree.refill(*next, state, event);
            self.tree.thin([*next, self.cursor]);
            *next += 1;
        }
    }

    /// The breakpoints that a run stopped at, as the beginning of a reply.
    pub(super) fn stops(&self, hits: &[u32]) -> String {
        let hit = self.breakpoints.iter().filter(|b| hits.contains(&b.id));
        let told: Vec<String> = hit
            .map(|b| breakpoints::describe(self.model(), b))
            .collect();
        match told.len() {
            0 => String::new(),
            1 => format!("breakpoint {}: ", told[0]),
            _ => format!("breakpoints {}: ", told.join(", ")),
        }
    }
}
