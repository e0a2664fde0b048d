//! A debugging session: the scene, its history, and a cursor.
//!
//! The solver runs on a worker thread, one job at a time, so that the owner of the session (the TUI, a test, a
//! script) can always respond to input. [`Session::submit`] takes a command, [`Session::poll`] collects results
//! of the worker, [`Session::wait`] blocks until it is idle.
//!
//! The history is a [`Tree`] of branches. The session shows one line of it, from the start to the tip of the
//! current branch. A frame is the result of one minor iteration or of one intervention. Motions move the
//! cursor; only motions past the end of the line solve. An intervention before the end starts a new branch, so
//! that nothing is lost. Frames that were thinned to save memory are recomputed by the worker when the cursor
//! moves there.

use super::background::Background;
use super::connection::Connection;
use super::journal_writer::JournalWriter;
use super::timeline::Timeline;
use super::worker::{Message, Worker};
use crate::history::tree::Budget;
use crate::history::verdicts;
use crate::history::watches::Watches;
use crate::record::journal::{self, Entry};
use crate::record::state_digest::StateDigests;
use crate::recorded::calculix::words::NO_MODES;
use crate::refusal::{Refusal, refusal};
use crate::{Breakpoints, Command, Frame, Log, Tree};
use std::sync::Arc;
use std::time::Duration;
use stickslip_core::step::cone_solver::ConeSolver;
use stickslip_core::{Capabilities, Intervention, Model, Solver, Stepper};
use stickslip_platform::clock::Instant;
use stickslip_scene::solver::solver;
use stickslip_scene::{Scene, gaps, joined, shortest};

/// Maximum duration of one call of `poll`, so that the caller stays responsive.
const SLICE: Duration = Duration::from_millis(10);

/// Result of a command, as one line for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply(pub String);

/// A debugging session.
pub struct Session {
    pub(super) scene: Scene,
    /// The start gaps in words.
    start_gaps: String,
    pub(super) connection: Connection,
    pub(super) timeline: Timeline,
    pub(super) worker: Worker,
    pub(super) task: Option<Task>,
    pub(super) breakpoints: Breakpoints,
    watches: Watches,
    pub(super) background: Background,
    pub(super) journal: JournalWriter,
    digests: StateDigests,
    /// The command that the worker is executing.
    pending: Option<Command>,
    /// Minor iterations solved by the current command, and increments accepted among them.
    pub(super) solved: u64,
    accepted: u64,
    /// Whether the worker has more results than one `poll` could collect.
    is_behind: bool,
}

/// The worker's task.
#[derive(Debug, Clone, Copy)]
pub(super) enum Task {
    /// New minor iterations past the tip.
    Run,
    /// Recomputes thinned frames: the next one, and the one wanted.
    Again { next: usize, target: usize },
}

impl Session {
    /// A session at the start of a scene.
    pub fn new(scene: Scene) -> Self {
        Session::with_budget(scene, Budget::default())
    }

    /// A session whose history stays within a budget.
    pub fn with_budget(scene: Scene, budget: Budget) -> Self {
        let model = Arc::new(scene.model.clone());
        if let Some(solver) = ConeSolver::new(model.clone()) {
            return Session::attached(scene, Box::new(solver), Log::default());
        }
        let start = Stepper::new(model.clone()).state().clone();
        let own = model.clone();
        let worker = Worker::new(move || Box::new(solver(own))).unattended();
        let tree = Tree::new(model, start, budget);
        Session::from_parts(scene, tree, worker, Capabilities::all(), None)
    }

    /// A session with an attached solver, at the start of the scene that it reported.
    pub fn attached(scene: Scene, solver: Box<dyn Solver>, log: Log) -> Self {
        let (model, start) = (solver.model().clone(), solver.state().clone());
        let offers = solver.capabilities();
        let worker = Worker::new(move || solver);
        let tree = Tree::new(model, start, Budget::default());
        Session::from_parts(scene, tree, worker, offers, Some(log))
    }

    fn from_parts(
        scene: Scene,
        tree: Tree,
        worker: Worker,
        offers: Capabilities,
        log: Option<Log>,
    ) -> Self {
        // Only an attached solver knows its deformable bodies.
        let spec = log.is_none().then(|| scene.spec.clone());
        let model = tree.model().clone();
        Session {
            scene,
            start_gaps: gaps::words(&model).join(", "),
            background: Background::new(model, spec, offers.clone(), worker.lender()),
            connection: Connection::new(offers, log),
            timeline: Timeline::new(tree),
            worker,
            task: None,
            breakpoints: Breakpoints::default(),
            watches: Watches::default(),
            journal: JournalWriter::default(),
            digests: StateDigests::default(),
            pending: None,
            solved: 0,
            accepted: 0,
            is_behind: false,
        }
    }

    /// The scene as read.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The range of the start gaps of each surface, in a few words; empty if no slave node faces a surface.
    pub fn start_gaps(&self) -> &str {
        &self.start_gaps
    }

    /// The solver as the session sees it.
    pub fn connection(&self) -> &Connection {
        &self.connection
    }

    /// The history and the cursor.
    pub fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// The scene as checked.
    pub fn model(&self) -> &Model {
        self.timeline.model()
    }

    /// The frames of the current line ([`Timeline::frames`]).
    pub fn frames(&self) -> &[Frame] {
        self.timeline.frames()
    }

    /// The frames of the current line up to the shown one.
    pub fn shown_frames(&self) -> &[Frame] {
        &self.frames()[..=self.cursor()]
    }

    /// Index of the shown frame.
    pub fn cursor(&self) -> usize {
        self.timeline.cursor()
    }

    /// The shown frame.
    pub fn frame(&self) -> &Frame {
        self.timeline.frame()
    }

    /// The breakpoints.
    pub fn breakpoints(&self) -> &Breakpoints {
        &self.breakpoints
    }

    /// The watches.
    pub fn watches(&self) -> &Watches {
        &self.watches
    }

    /// Results of the background thread.
    pub fn background(&self) -> &Background {
        &self.background
    }

    /// As [`background`](Session::background), to collect results.
    pub fn background_mut(&mut self) -> &mut Background {
        &mut self.background
    }

    /// The journal.
    pub fn journal(&self) -> &JournalWriter {
        &self.journal
    }

    /// As [`journal`](Session::journal), to start it.
    pub fn journal_mut(&mut self) -> &mut JournalWriter {
        &mut self.journal
    }

    /// One line: what a finished run lacks, the branch (if there are several), and the watches with their
    /// values.
    pub fn aside(&self) -> String {
        let several = self.timeline.tree().branches().len() > 1;
        let branch = several.then(|| format!("in {}", self.timeline.name()));
        let watches =
            self.watches
                .values(self.frame())
                .into_iter()
                .map(|(name, value)| match value {
                    Some(value) => format!("{name} = {}", shortest(value)),
                    None => format!("{name} = none"),
                });
        let finished = self.model().finished.as_ref();
        joined(
            finished
                .map(|_| NO_MODES.to_owned())
                .into_iter()
                .chain(branch)
                .chain(watches),
            "   ",
        )
    }

    /// Whether the worker is busy.
    pub fn is_running(&self) -> bool {
        self.task.is_some()
    }

    /// Asks a running job to stop after the current minor iteration.
    pub fn interrupt(&self) {
        self.worker.interrupt();
    }

    /// Executes a command, or starts it on the worker.
    ///
    /// # Errors
    /// A message that says what is wrong and what would be right.
    pub fn submit(&mut self, command: Command) -> Result<Reply, Refusal> {
        if self.is_running() {
            return Err(refusal!(
                "the solver is running; interrupt it first (Ctrl-C)"
            ));
        }
        (self.solved, self.accepted) = (0, 0);
        let reply = self.carry_out(command.clone())?;
        if self.is_running() {
            self.begin(&command);
            self.pending = Some(command);
            return Ok(Reply(reply));
        }
        Ok(self.note(command, reply))
    }

    fn carry_out(&mut self, command: Command) -> Result<String, Refusal> {
        let model = self.timeline.tree().model();
        Ok(match command {
            Command::Forward { unit, count } => self.forward(unit, count.max(1)),
            Command::Back { unit, count } => self.back(unit, count.max(1))?,
            Command::Goto { step } => self.jump(step)?,
            Command::Force { slave, mode, hold } => {
                self.intervene(Intervention::Force { slave, mode, hold }, None)?
            }
            Command::Release { slave } => self.intervene(Intervention::Release { slave }, None)?,
            Command::Increment(increment) => {
                self.intervene(Intervention::Increment(increment), None)?
            }
            Command::Set { path, value } => {
                let intervention = self.setting(&path, &value)?;
                self.intervene(intervention, Some((&path, &value)))?
            }
            Command::Assume(starts) => self.intervene(Intervention::Assume(starts), None)?,
            Command::Follow { label, steps } => self.follow(&label, steps)?,
            Command::Census(nodes) => self.census(&nodes),
            Command::Export {
                what,
                file,
                overwrite,
            } => self.export(what, file, overwrite)?,
            Command::Remedies => self.remedies(),
            Command::Branch(to) => self.timeline.switch_to(&to)?,
            Command::Rename(label) => self.timeline.rename(&label)?,
            Command::Branches => verdicts::listed(self.timeline.tree()),
            Command::Compare(with) => self.timeline.compare_with(with.as_deref())?,
            Command::Break(condition) => self.breakpoints.add(condition, model),
            Command::Breakpoints => self.breakpoints.describe(model),
            Command::Delete(id) => self.breakpoints.delete(id, model)?,
            Command::Enable { id, on } => self.breakpoints.enable(id, on, model)?,
            Command::Watch(watch) => self.watches.add(watch)?,
            Command::Unwatch(name) => self.watches.remove(&name)?,
            Command::Snapshot { file, overwrite } => self.snapshot(file, overwrite)?,
            Command::Journal(file) => {
                let tree = self.timeline.tree();
                let has_steps = tree.len(tree.current()) > 1;
                self.journal.begin(file, &self.scene, has_steps)?
            }
        })
    }

    /// Collects results of the worker without blocking, for at most `SLICE`. Returns a message when a job has
    /// ended.
    pub fn poll(&mut self) -> Option<Reply> {
        let began = Instant::now();
        self.is_behind = false;
        while self.is_running() {
            let message = self.worker.try_next()?;
            if let Some(reply) = self.take(message) {
                return Some(reply);
            }
            if began.elapsed() > SLICE {
                self.is_behind = true;
                return None;
            }
        }
        None
    }

    /// Whether the worker has more results than the last [`poll`](Session::poll) collected.
    pub fn is_behind(&self) -> bool {
        self.is_behind
    }

    /// Blocks until the worker is idle and returns its last message.
    pub fn wait(&mut self) -> Option<Reply> {
        while self.is_running() {
            let message = self.worker.next();
            if let Some(reply) = self.take(message) {
                return Some(reply);
            }
        }
        None
    }

    fn take(&mut self, message: Message) -> Option<Reply> {
        let reply = self.gather(message)?;
        self.connection.set_repeats(None);
        Some(match self.pending.take() {
            Some(mut command) => {
                if let Command::Follow { steps, .. } = &mut command {
                    // Without the steps that were not taken before an interruption.
                    let tree = self.timeline.tree();
                    let own = tree.branches()[tree.current()].from;
                    steps.truncate(self.frames().len() - own);
                }
                self.note(command, reply)
            }
            None => Reply(reply),
        })
    }

    fn gather(&mut self, message: Message) -> Option<String> {
        match message {
            Message::Made(frame, strip) => {
                self.connection.step(&frame.state);
                self.solved += 1;
                self.accepted += u64::from(strip.kind.is_accepted());
                self.timeline.push(*frame, *strip);
                None
            }
            Message::Changed(state, intervention) => {
                self.timeline.append(*state, intervention);
                None
            }
            Message::Again(state, event) => {
                self.connection.step(&state);
                if let Some(Task::Again { next, .. }) = &mut self.task {
                    self.timeline.refill(*next, *state, event);
                    *next += 1;
                }
                None
            }
            Message::Done {
                interrupted,
                hits,
                remark,
            } => {
                let remark = remark.map(|remark| remark + "; ").unwrap_or_default();
                Some(remark + &self.done(interrupted, &hits))
            }
            Message::Lost(lost) => {
                self.task = None;
                if self.connection.capabilities().past.is_some() {
                    return Some(lost.to_string());
                }
                self.connection.lose(lost.to_string());
                Some(format!("{lost}; all steps so far are kept"))
            }
            Message::Died => {
                self.task = None;
                Some("the solver stopped unexpectedly; all steps so far are kept".into())
            }
        }
    }

    fn done(&mut self, interrupted: bool, hits: &[u32]) -> String {
        let mut reply = self.breakpoints.describe_hits(self.model(), hits);
        if let Some(Task::Again { next, target }) = self.task.take()
            && next > target
        {
            self.timeline.move_to(target);
        }
        if interrupted {
            reply += "interrupted; ";
        }
        reply + &self.timeline.outcome()
    }

    /// Records in the journal that a motion starts solving.
    fn begin(&mut self, command: &Command) {
        self.journal.renew(&self.scene);
        if matches!(self.task, Some(Task::Run)) {
            let scene = &self.scene;
            self.journal.write(scene, |journal| journal.begun(command));
        }
    }

    /// Records a completed command in the journal.
    fn note(&mut self, command: Command, reply: String) -> Reply {
        self.journal.renew(&self.scene);
        if !command.is_look() && self.journal.is_on() {
            let changes = self.solved > 0 || !command.is_motion();
            let (branch, cursor) = self.timeline.place();
            let entry = Entry {
                at: journal::now(),
                command,
                solved: self.solved,
                accepted: self.accepted,
                branch,
                cursor,
                digest: self.digests.digest(&self.timeline.frame().state),
                said: reply.clone(),
            };
            self.journal.done(&self.scene, entry, changes);
        }
        Reply(reply + &self.journal.take_trouble())
    }
}
