//! Motions: forward, back, and to a step; over recorded steps, and past the end of the line.

use super::machine::{Session, Task};
use super::worker::Steps;
use crate::refusal::{Refusal, refusal};
use crate::{Breakpoints, Unit};
use stickslip_core::{Status, counted};

impl Session {
    /// Moves the cursor over recorded steps, then solves.
    pub(super) fn forward(&mut self, unit: Unit, count: u32) -> String {
        let (at, left, hits) = self.timeline.forward(unit, count, &self.breakpoints);
        let finished = self.frames()[at].state.status == Status::Finished;
        if left == 0 || !hits.is_empty() || finished {
            return self.go_to(at, &hits);
        }
        self.timeline.move_to(at);
        self.solve(unit, left, self.breakpoints.clone()) + "running; Ctrl-C interrupts"
    }

    /// Solves new minor iterations from the cursor, which is at the tip; returns as [`Session::work`].
    pub(super) fn solve(&mut self, unit: Unit, count: u32, breakpoints: Breakpoints) -> String {
        let run = Steps::Run {
            before: self.timeline.strip().clone(),
            unit,
            count,
            breakpoints,
        };
        self.work(self.cursor(), Task::Run, run)
    }

    /// Starts steps from a point of the line. Returns what an attached solver has to repeat to get there, as
    /// the beginning of a reply.
    pub(super) fn work(&mut self, from: usize, task: Task, steps: Steps) -> String {
        let repeats = self.connection.way_back(&self.timeline, from);
        let reply = repeats.iter().map(|way| format!("{way}; ")).collect();
        self.connection.set_repeats(repeats);
        self.task = Some(task);
        self.worker.start(self.frames()[from].state.clone(), steps);
        reply
    }

    /// Moves the cursor back.
    pub(super) fn back(&mut self, unit: Unit, count: u32) -> Result<String, Refusal> {
        if self.cursor() == 0 {
            return Err(refusal!("already at the start"));
        }
        let (at, hits) = self.timeline.backward(unit, count, &self.breakpoints);
        Ok(self.go_to(at, &hits))
    }

    /// Moves the cursor to a step of the line.
    pub(super) fn jump(&mut self, step: usize) -> Result<String, Refusal> {
        let last = self.timeline.tip();
        if step > last {
            return Err(refusal!(
                "step {step} does not exist yet; the last one is {last}"
            ));
        }
        Ok(self.go_to(step, &[]))
    }

    /// Moves the cursor to a point of the line. A thinned frame is recomputed first.
    fn go_to(&mut self, target: usize, hits: &[u32]) -> String {
        if let Some((from, again)) = self.timeline.recompute(target) {
            let task = Task::Again {
                next: from + 1,
                target,
            };
            self.work(from, task, again);
            return format!(
                "recomputing {}; Ctrl-C interrupts",
                counted(target - from, "step")
            );
        }
        self.timeline.move_to(target);
        let way = match self.connection.way_back(&self.timeline, target) {
            Some(way) if self.frame().state.status != Status::Finished => {
                format!("; to continue from here, {way}")
            }
            _ => String::new(),
        };
        self.breakpoints.describe_hits(self.model(), hits) + &self.timeline.outcome() + &way
    }
}
