//! The history of a session as it is shown: the current line of its tree of branches, and the cursor on it.

use super::background_messages::Reported;
use super::worker::Steps;
use crate::explain::failures;
use crate::explain::headline::headline;
use crate::explain::influence::PushPath;
use crate::explain::report;
use crate::explain::reported_pushes::Iterations;
use crate::explain::walk::MOST_REPORTED;
use crate::history::branches;
use crate::history::compare::{self, Comparison};
use crate::history::rounds::{self, rounds};
use crate::history::run_report::unforced;
use crate::history::verdicts;
use crate::record::export::export_state::COLUMNS;
use crate::record::snapshot::AppliedIntervention;
use crate::refusal::{Refusal, refusal};
use crate::{BranchTarget, Breakpoints, Frame, PointKind, ReportedIterations, Strip, Tree, Unit};
use std::sync::Arc;
use stickslip_core::{Event, Intervention, Model, Norms, Outcome, Position, State, Status};
use stickslip_scene::{shortest, shown};

/// A tree of branches, and the cursor on its current line.
pub struct Timeline {
    tree: Tree,
    cursor: usize,
}

impl Timeline {
    /// The timeline at the start of a tree.
    pub(super) fn new(tree: Tree) -> Timeline {
        Timeline { tree, cursor: 0 }
    }

    /// The whole history, for [`branches`] and [`compare`].
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The scene as checked.
    pub fn model(&self) -> &Model {
        self.tree.model()
    }

    /// The frames of the current line, oldest first; never empty. Frame 0 is the start.
    pub fn frames(&self) -> &[Frame] {
        self.tree.frames()
    }

    /// The compact records of the same frames; complete even where frames were thinned.
    pub fn strips(&self) -> &[Strip] {
        self.tree.strips()
    }

    /// Index of the shown frame.
    pub fn cursor(&self) -> usize {
        self.cursor
    }

    /// The shown frame.
    pub fn frame(&self) -> &Frame {
        &self.tree.frames()[self.cursor]
    }

    /// The compact record of the shown frame.
    pub(super) fn strip(&self) -> &Strip {
        &self.tree.strips()[self.cursor]
    }

    /// Index of the last frame of the line.
    pub(super) fn tip(&self) -> usize {
        self.frames().len() - 1
    }

    /// Branch and step of the cursor, the key of the results in
    /// [`Background`](super::background::Background).
    pub fn place(&self) -> (usize, usize) {
        (self.tree.current(), self.cursor)
    }

    /// Moves the cursor to a point of the line, whose frame is whole.
    pub(super) fn move_to(&mut self, step: usize) {
        self.cursor = step;
    }

    /// Appends a minor iteration to the line and moves there.
    pub(super) fn push(&mut self, frame: Frame, strip: Strip) {
        self.tree.push(frame, strip);
        self.cursor = self.tip();
    }

    /// Appends an intervention to the line and moves there.
    pub(super) fn append(&mut self, state: State, intervention: Intervention) {
        self.cursor = self.tip();
        self.tree.intervene(self.cursor, state, intervention);
        self.cursor += 1;
    }

    /// Adds an intervention at the cursor and moves there. Returns the name of the new branch, if it starts one.
    pub(super) fn intervene(
        &mut self,
        state: State,
        intervention: Intervention,
        label: String,
    ) -> Option<String> {
        let before = self.strip().kind;
        let forks = self.tree.intervene(self.cursor, state, intervention);
        self.cursor += 1;
        let branch = &self.tree.branches()[self.tree.current()];
        if forks {
            self.tree.rename(label, false);
            return Some(self.name());
        }
        let begins = branch.parent.is_some() && branch.from < self.cursor;
        if begins && !branch.named && before == PointKind::Intervention {
            // Changes made before the first solve belong to the same branch.
            let label = format!("{}, {label}", branch.label);
            self.tree.rename(label, false);
        }
        None
    }

    /// Rejects a new branch when the branches have used up their memory budget.
    pub(super) fn check_room(&self) -> Result<(), Refusal> {
        let (taken, most) = (self.tree.permanent_bytes(), self.tree.budget().branches);
        if taken < most {
            Ok(())
        } else {
            Err(refusal!(
                "no new branch: the existing ones take {} MB (limit {} MB); continue from the tip of a \
         branch instead",
                taken >> 20,
                most >> 20
            ))
        }
    }

    /// Starts an empty branch at the cursor and returns its name.
    pub(super) fn fork(&mut self, label: &str) -> Result<String, Refusal> {
        self.check_room()?;
        self.tree.fork(self.cursor);
        self.tree.rename(shown::line(label).into_owned(), false);
        Ok(self.name())
    }

    /// Makes a branch the current one, and moves to its tip.
    pub(super) fn switch(&mut self, branch: usize) {
        self.tree.switch(branch);
        self.cursor = self.tip();
    }

    /// Switches to another branch, and reports how it ends.
    pub(super) fn switch_to(&mut self, to: &BranchTarget) -> Result<String, Refusal> {
        let (count, current) = (self.tree.branches().len(), self.tree.current());
        let to = match to {
            BranchTarget::Next => (current + 1) % count,
            BranchTarget::Previous => (current + count - 1) % count,
            BranchTarget::Named(name) => branches::find(&self.tree, name)?,
        };
        if count == 1 {
            return Err(refusal!(
                "there is only one branch; an intervention before the tip starts another"
            ));
        }
        self.switch(to);
        let verdict = verdicts::describe(&self.tree, &verdicts::verdict(&self.tree, to));
        let frame = self.frame();
        let end = match frame.event.as_deref().map(|event| &event.outcome) {
            Some(Outcome::Failed(failure)) => headline(self.model(), &frame.state, failure),
            _ => self.outcome(),
        };
        Ok(format!("{} ({verdict}): {end}", self.name()))
    }

    /// The name of the current branch.
    pub(super) fn name(&self) -> String {
        branches::name(&self.tree, self.tree.current())
    }

    /// Renames the current branch.
    pub(super) fn rename(&mut self, label: &str) -> Result<String, Refusal> {
        let label = label.trim().to_owned();
        let is_number = label
            .strip_prefix('b')
            .is_some_and(|n| n.parse::<u32>().is_ok());
        if label.is_empty() || label.contains(shown::is_order) {
            return Err(refusal!("a branch name must be one line of text"));
        } else if self.tree.branches().iter().any(|b| b.label == label) {
            return Err(refusal!("branch name '{label}' is already in use"));
        } else if is_number {
            return Err(refusal!(
                "branch name '{label}' looks like a branch number; choose another"
            ));
        }
        self.tree.rename(label, true);
        Ok(format!("this branch is {}", self.name()))
    }

    /// Two branches side by side, by number; `None` if one does not exist.
    pub fn compare(&self, a: usize, b: usize) -> Option<Comparison> {
        let count = self.tree.branches().len();
        (a < count && b < count)
            .then(|| compare::compare(&self.tree, a, b))
            .flatten()
    }

    /// Compares the current branch with another one, by default with its parent.
    pub(super) fn compare_with(&self, other: Option<&str>) -> Result<String, Refusal> {
        let current = self.tree.current();
        let others = self.tree.branches();
        let unnamed = match others.len() {
            1 => {
                refusal!("there is only one branch; an intervention before the tip starts another")
            }
            _ => refusal!("which branch? :compare BRANCH"),
        };
        let other = match other {
            Some(name) => branches::find(&self.tree, name)?,
            None => others[current].parent.ok_or(unnamed)?,
        };
        if other == current {
            return Err(refusal!(
                "this is the current branch; name another one to compare it with"
            ));
        }
        let comparison = self
            .compare(current, other)
            .ok_or_else(|| refusal!("there is nothing to compare"))?;
        Ok(compare::describe(&self.tree, &comparison))
    }

    /// Where a motion forward over recorded steps ends, the units left to solve there, and the breakpoints hit.
    pub(super) fn forward(
        &self,
        unit: Unit,
        count: u32,
        breakpoints: &Breakpoints,
    ) -> (usize, u32, Vec<u32>) {
        let strips = self.strips();
        let (mut at, mut left, mut hits) = (self.cursor, count, Vec::new());
        while left > 0 && hits.is_empty() && at + 1 < strips.len() {
            at += 1;
            left -= u32::from(self.ends(unit, &strips[at]));
            if strips[at].kind.is_failure() {
                left = 0;
            }
            hits = breakpoints.hits(&strips[at - 1], &strips[at]);
        }
        (at, left, hits)
    }

    /// Where a motion backward ends, and the breakpoints that stop it.
    pub(super) fn backward(
        &self,
        unit: Unit,
        count: u32,
        breakpoints: &Breakpoints,
    ) -> (usize, Vec<u32>) {
        let strips = self.strips();
        let here = |k: usize| match k {
            0 => Vec::new(),
            k => breakpoints.hits(&strips[k - 1], &strips[k]),
        };
        let stops = |k: &usize| match unit {
            Unit::Minor => true,
            Unit::Run => self.ends(unit, &strips[*k]) || !here(*k).is_empty(),
            _ => unit.ends(strips[*k].kind),
        };
        let mut at = self.cursor;
        for _ in 0..count {
            if at == 0 {
                // The start is reached before the count is used up.
                return (0, Vec::new());
            }
            at = (0..at).rev().find(stops).unwrap_or(0);
        }
        match unit {
            Unit::Run => (at, here(at)),
            _ => (at, Vec::new()),
        }
    }

    /// Whether a motion by this unit ends at a point. A run over a finished record also ends at each attempt
    /// that was given up.
    fn ends(&self, unit: Unit, strip: &Strip) -> bool {
        let given_up = unit == Unit::Run && strip.kind == PointKind::Cut;
        unit.ends(strip.kind) || (given_up && self.model().finished.is_some())
    }

    /// The steps that recompute a thinned frame, from the nearest whole frame before it; `None` if it is whole.
    pub(super) fn recompute(&self, target: usize) -> Option<(usize, Steps)> {
        let from = self.tree.whole_before(target);
        let again = || Steps::Again {
            event: self.frames()[from].event.clone(),
            steps: self.interventions(from, target),
        };
        (from < target).then(|| (from, again()))
    }

    /// The steps from a point of the line to a later one.
    fn interventions(&self, from: usize, to: usize) -> Vec<Option<Intervention>> {
        let frames = &self.frames()[from + 1..=to];
        frames
            .iter()
            .map(|frame| frame.intervention.clone())
            .collect()
    }

    /// Restores a thinned frame.
    pub(super) fn refill(&mut self, at: usize, state: State, event: Option<Arc<Event>>) {
        self.tree.refill(at, state, event);
        self.tree.thin([at, self.cursor]);
    }

    /// Number of minor iterations up to the cursor, and the interventions among them.
    pub(super) fn applied(&self) -> (u64, Vec<AppliedIntervention>) {
        let (mut step, mut applied) = (0, Vec::new());
        for frame in &self.frames()[1..=self.cursor] {
            match &frame.intervention {
                Some(intervention) => applied.push(AppliedIntervention {
                    step,
                    intervention: intervention.clone(),
                }),
                None => step += 1,
            }
        }
        (step, applied)
    }

    /// The shown minor iteration; at the start, the first one.
    pub(super) fn position(&self) -> Position {
        let frame = self.frame();
        match &frame.event {
            Some(event) => event.position,
            None => frame.state.next,
        }
    }

    /// The outcome of the shown minor iteration, in words.
    pub(super) fn outcome(&self) -> String {
        match &self.frame().event {
            None => "at the start".into(),
            Some(event) => report::outcome(self.model(), event),
        }
    }

    /// Residual norms of the shown attempt up to the cursor: before its first major iteration (0) and after
    /// each one; for a finished run, of each iteration.
    pub fn residual_history(&self) -> Vec<(u32, Norms)> {
        let Some(event) = &self.frame().event else {
            return Vec::new();
        };
        let shown = event.position;
        let finished = self.model().finished.is_some();
        let mut history: Vec<(u32, Norms)> = Vec::new();
        for strip in self.strips()[..=self.cursor].iter().rev() {
            let at = strip.position;
            if strip.kind == PointKind::Start
                || (at.increment, at.attempt) != (shown.increment, shown.attempt)
            {
                break;
            }
            if !finished {
                history.extend(strip.after.as_deref().map(|after| (at.major, *after)));
            }
            let number = if finished { at.minor } else { 0 };
            history.extend(strip.first.as_deref().map(|first| (number, *first)));
        }
        history.reverse();
        history.dedup_by_key(|entry| entry.0);
        history
    }

    /// The minor iteration before the shown one in the same frozen problem, as a step of the line.
    pub fn minor_before(&self) -> Option<usize> {
        let (strips, shown) = (self.strips(), self.strip());
        let before = (1..self.cursor)
            .rev()
            .find(|&at| strips[at].kind.is_solved())?;
        let same = major(strips[before].position) == major(shown.position)
            && matches!(
                strips[before].kind,
                PointKind::Minor | PointKind::Climbed | PointKind::Cycle | PointKind::Failed
            );
        (shown.kind.is_solved() && same).then_some(before)
    }

    /// An earlier minor iteration and the shown one, as reported, if all their frames are whole.
    pub(super) fn iterations(&self, before: usize) -> Option<Iterations> {
        let whole = |at: usize| self.frames().get(at).filter(|frame| frame.is_whole());
        Some(Iterations {
            start: Box::new(whole(self.cursor.checked_sub(1)?)?.state.clone()),
            found: [
                whole(before)?.event.clone()?,
                whole(self.cursor)?.event.clone()?,
            ],
        })
    }

    /// The steps to repeat to reach an earlier minor iteration and the shown one.
    pub(super) fn push_path(&self, before: usize) -> PushPath {
        let from = self.tree.whole_before(before - 1);
        PushPath {
            state: Box::new(self.frames()[from].state.clone()),
            steps: self.interventions(from, self.cursor - 1),
            before: before - from - 1,
        }
    }

    /// The warnings of our own solver's run up to a failed state.
    pub(super) fn warnings(&self) -> Reported {
        let state = &self.frame().state;
        let findings = match state.status {
            Status::Failed(_) => {
                unforced(&self.strips()[..=self.cursor]).warnings(self.model(), &state.start)
            }
            _ => Vec::new(),
        };
        Reported {
            findings,
            ..Reported::default()
        }
    }

    /// What the line shows about an attached solver up to the cursor.
    pub(super) fn reported(&self) -> Reported {
        let frame = self.frame();
        let doubt = frame.event.as_ref().and_then(|event| {
            let doubt = report::reservations(self.model(), event);
            (!doubt.is_empty())
                .then(|| format!("load {} accepted{doubt}", shortest(event.load_factor)))
        });
        let what = match &frame.state.status {
            Status::Failed(failure) => Some(failures::describe(self.model(), failure)),
            _ => doubt,
        };
        // Changes before an increment was accepted are over.
        let accepted = |event: &Arc<Event>| event.outcome.is_accepted();
        let is_over = what.is_none() && frame.event.as_ref().is_some_and(accepted);
        let found = rounds(&self.strips()[..=self.cursor]).filter(|_| !is_over);
        let place = found.map(|found| rounds::words(self.model(), &found, true));
        Reported {
            changing: place.is_some(),
            findings: what.into_iter().chain(place).collect(),
            iterations: self.iterations_reported(),
        }
    }

    /// The minor iterations of the shown major one since the last change by the user, oldest first; empty if a frame among them
    /// was thinned, or the major iteration has ended.
    fn iterations_reported(&self) -> ReportedIterations {
        let shown = self.frame().state.next;
        let frames = &self.frames()[..=self.cursor];
        let mut events: Vec<_> = frames
            .iter()
            .rev()
            .take_while(|frame| {
                let event = frame.event.as_ref();
                frame.is_whole()
                    && frame.intervention.is_none()
                    && event.is_some_and(|event| major(event.position) == major(shown))
            })
            .take(MOST_REPORTED)
            .filter_map(|frame| frame.event.clone())
            .collect();
        events.reverse();
        let before = frames.len().checked_sub(events.len() + 1);
        let start = before
            .map(|at| &frames[at])
            .filter(|frame| frame.is_whole());
        ReportedIterations {
            start: start.map(|frame| Box::new(frame.state.clone())),
            events,
        }
    }

    /// The latest strips up to the cursor, oldest first, for a picture.
    pub(super) fn latest(&self) -> &[Strip] {
        let strips = &self.strips()[..=self.cursor];
        &strips[strips.len().saturating_sub(2 * COLUMNS)..]
    }

    /// The state at the start of the shown major iteration, unless its frame was thinned.
    pub(super) fn major_start(&self) -> Option<&State> {
        let frames = &self.frames()[..=self.cursor];
        let state = &frames
            .iter()
            .rev()
            .find(|frame| {
                let state = &frame.state;
                frame.is_whole() && state.next.minor == 1 && state.status == Status::Running
            })?
            .state;
        // If the frame of its start was thinned, the whole frame found belongs to another major iteration.
        let shown = self.frame().event.as_ref()?.position;
        (major(shown) == major(state.next)).then_some(state)
    }
}

/// The major iteration of a position: increment, attempt, major.
fn major(at: Position) -> (u32, u32, u32) {
    (at.increment, at.attempt, at.major)
}
