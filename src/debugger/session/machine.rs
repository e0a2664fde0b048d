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
use super::diary::Diary;
use super::refusal::Refusal;
use super::worker::{Message, Worker};
use crate::explain::report;
use crate::history::branches;
use crate::history::breakpoints::Breakpoint;
use crate::history::compare::{self, Comparison};
use crate::history::frame::{Frame, curve};
use crate::history::strip::{PointKind, Strip};
use crate::history::tree::{self, Tree};
use crate::history::verdicts::{self, Summary};
use crate::history::watches::Watch;
use crate::record::command::Command;
use crate::record::journal::{self, Entry, Journal};
use crate::recorded::calculix::words::NO_MODES;
use crate::recorded::log::Log;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stickslip_core::linear::norms::Norms;
use stickslip_core::model::Model;
use stickslip_core::step::intervene::Intervention;
use stickslip_core::step::solver::{Offers, Solver};
use stickslip_core::step::state::State;
use stickslip_core::step::stepper::Stepper;
use stickslip_scene::Scene;
use stickslip_scene::gaps;
use stickslip_scene::solver::solver;

/// Maximum duration of one call of `poll`, so that the caller stays responsive.
const SLICE: Duration = Duration::from_millis(10);

/// Result of a command, as one line for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply(pub String);

/// A debugging session.
pub struct Session {
    pub(super) scene: Scene,
    /// Capabilities of the solver.
    pub(super) offers: Offers,
    /// Output of an attached solver; `None` for our own.
    log: Option<Log>,
    /// What is known about the state of an attached solver.
    pub(super) stands: Stands,
    /// The start gaps, and warnings about them.
    start: (String, Vec<String>),
    pub(super) tree: Tree,
    /// No new branch once all branches together exceed this size in bytes.
    pub(super) branch_budget: usize,
    pub(super) cursor: usize,
    pub(super) worker: Worker,
    pub(super) task: Option<Task>,
    pub(super) breakpoints: Vec<Breakpoint>,
    /// Number of the latest breakpoint.
    pub(super) numbered: u32,
    pub(super) watches: Vec<Watch>,
    pub(super) background: Background,
    pub(super) diary: Diary,
    /// The command that the worker is executing.
    pub(super) pending: Option<Command>,
    /// Minor iterations solved by the current command, and increments accepted among them.
    pub(super) solved: u64,
    pub(super) accepted: u64,
    /// Whether the worker has more results than one `poll` could collect.
    is_behind: bool,
}

/// State of an attached solver.
#[derive(Debug, Clone, Default)]
pub(super) struct Stands {
    /// Identifier of the state that it is in ([`stickslip_core::step::state::Outside::place`]); `None` if
    /// unknown.
    pub(super) at: Option<u64>,
    /// Why the connection failed; the next job starts the solver again.
    pub(super) lost: Option<String>,
    /// Steps it has to repeat before it can continue, as a sentence.
    pub(super) again: String,
}

/// The worker's task.
#[derive(Debug, Clone, Copy)]
pub(super) enum Task {
    /// New minor iterations past the tip.
    Run,
    /// Recomputes thinned frames: the next one, and the one wanted. `sound` is whether all of them so far equal
    /// the originals.
    Again {
        next: usize,
        target: usize,
        sound: bool,
    },
}

impl Session {
    /// A session at the start of a scene.
    pub fn new(scene: Scene) -> Self {
        Session::with_budget(scene, tree::BUDGET)
    }

    /// A session whose whole frames take at most this many bytes (default [`tree::BUDGET`]).
    pub fn with_budget(scene: Scene, bytes: usize) -> Self {
        let model = Arc::new(scene.model.clone());
        let start = Stepper::new(model.clone()).state().clone();
        let own = model.clone();
        let worker = Worker::new(move || Box::new(solver(own))).unattended();
        let background = Background::new(model.clone(), scene.spec.clone(), worker.lender());
        Session::begun(scene, model, start, (worker, background), bytes)
    }

    /// Sets the size in bytes of all branches above which no branch can start (default
    /// [`tree::BRANCH_BUDGET`]).
    pub fn limit_branches(&mut self, bytes: usize) {
        self.branch_budget = bytes;
    }

    /// A session with an attached solver, at the start of the scene that it reported.
    pub fn attached(scene: Scene, solver: Box<dyn Solver>, log: Log) -> Self {
        let (model, start) = (solver.model().clone(), solver.state().clone());
        let offers = solver.offers();
        let worker = Worker::new(move || solver);
        let background = Background::beside(model.clone(), offers.clone(), worker.lender());
        let parts = (worker, background);
        Session {
            offers,
            log: Some(log),
            stands: Stands {
                at: Some(0),
                ..Stands::default()
            },
            ..Session::begun(scene, model, start, parts, tree::BUDGET)
        }
    }

    fn begun(
        scene: Scene,
        model: Arc<Model>,
        start: State,
        (worker, background): (Worker, Background),
        bytes: usize,
    ) -> Self {
        Session {
            offers: Offers::all(),
            log: None,
            stands: Stands::default(),
            is_behind: false,
            start: (gaps::words(&model).join(", "), gaps::warnings(&model)),
            scene,
            tree: Tree::new(model.clone(), start, bytes),
            branch_budget: tree::BRANCH_BUDGET,
            cursor: 0,
            worker,
            task: None,
            breakpoints: Vec::new(),
            numbered: 0,
            watches: Vec::new(),
            background,
            diary: Diary::default(),
            pending: None,
            solved: 0,
            accepted: 0,
        }
    }

    /// Writes a journal from now on.
    pub fn keep(&mut self, journal: Journal) {
        self.diary.keep(journal);
    }

    /// Writes a journal to the default path, created with the first entry.
    pub fn keep_at_default_place(&mut self) {
        self.diary.keep_at_default_place();
    }

    /// Why the journal failed.
    pub fn lost_journal(&self) -> Option<&str> {
        self.diary.lost()
    }

    /// The path of the journal, if there is one.
    pub fn journal(&self) -> Option<&Path> {
        self.diary.path()
    }

    /// Capabilities of the solver.
    pub fn offers(&self) -> &Offers {
        &self.offers
    }

    /// The output of an attached solver, line by line; `None` for our own.
    pub fn log(&self) -> Option<&Log> {
        self.log.as_ref()
    }

    /// Why the connection to an attached solver failed; the next step starts the solver again.
    pub fn lost(&self) -> Option<&str> {
        self.stands.lost.as_deref()
    }

    /// What an attached solver repeats in the running job before it continues; empty if nothing.
    pub fn again(&self) -> &str {
        match self.is_running() {
            true => &self.stands.again,
            false => "",
        }
    }

    /// The scene as read.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The range of the start gaps of each surface, in a few words; empty if no slave node faces a surface.
    pub fn start_gaps(&self) -> &str {
        &self.start.0
    }

    /// Warnings about the start of the scene, the most severe first.
    pub fn doubts(&self) -> &[String] {
        &self.start.1
    }

    /// The scene as checked.
    pub fn model(&self) -> &Model {
        self.tree.model()
    }

    /// File or name of the built-in scene.
    pub fn scene_name(&self) -> &str {
        &self.scene.name
    }

    /// The frames of the current line, oldest first; never empty. Frame 0 is the start.
    pub fn frames(&self) -> &[Frame] {
        self.tree.frames()
    }

    /// The compact records of the same frames; complete even where frames were thinned.
    pub fn strips(&self) -> &[Strip] {
        self.tree.strips()
    }

    /// The whole history, for [`branches`] and [`compare`].
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Index of the shown frame.
    pub fn cursor(&self) -> usize {
        self.cursor
    }

    /// The shown frame.
    pub fn frame(&self) -> &Frame {
        &self.tree.frames()[self.cursor]
    }

    /// Summaries of all branches.
    pub fn branches(&self) -> Vec<Summary> {
        verdicts::summaries(&self.tree)
    }

    /// Two branches side by side, by number; `None` if one does not exist.
    pub fn compare(&self, a: usize, b: usize) -> Option<Comparison> {
        let count = self.tree.branches().len();
        (a < count && b < count)
            .then(|| compare::compare(&self.tree, a, b))
            .flatten()
    }

    /// Breakpoints, oldest first.
    pub fn breakpoints(&self) -> &[Breakpoint] {
        &self.breakpoints
    }

    /// Watches, oldest first.
    pub fn watches(&self) -> &[Watch] {
        &self.watches
    }

    /// The watches and their values at the cursor; `None` where no value has been solved.
    pub fn watched(&self) -> Vec<(&str, Option<f64>)> {
        let value = |watch: &Watch| watch.value(self.frame());
        self.watches
            .iter()
            .map(|watch| (watch.name.as_str(), value(watch)))
            .collect()
    }

    /// One line: what a finished run lacks, the branch (if there are several), and the watches with their
    /// values.
    pub fn aside(&self) -> String {
        let several = self.tree.branches().len() > 1;
        let branch =
            several.then(|| format!("in {}", branches::name(&self.tree, self.tree.current())));
        let watches = self.watched().into_iter().map(|(name, value)| match value {
            Some(value) => format!("{name} = {value:.6e}"),
            None => format!("{name} = none"),
        });
        let finished = self.model().finished.as_ref();
        finished
            .map(|_| NO_MODES.to_owned())
            .into_iter()
            .chain(branch)
            .chain(watches)
            .collect::<Vec<_>>()
            .join("   ")
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
            return Err(Refusal::Running);
        }
        (self.solved, self.accepted) = (0, 0);
        let kept = command.clone();
        let reply = self.carry_out(command)?;
        if self.is_running() {
            self.begin(&kept);
            self.pending = Some(kept);
            return Ok(reply);
        }
        Ok(self.note(kept, reply))
    }

    fn carry_out(&mut self, command: Command) -> Result<Reply, Refusal> {
        match command {
            Command::Forward { unit, count } => Ok(self.forward(unit, count.max(1))),
            Command::Back { unit, count } => self.back(unit, count.max(1)),
            Command::Goto { step } => self.jump(step),
            Command::Force { slave, mode, hold } => {
                self.intervene(Intervention::Force { slave, mode, hold }, None)
            }
            Command::Release { slave } => self.intervene(Intervention::Release { slave }, None),
            Command::Increment(increment) => {
                self.intervene(Intervention::Increment(increment), None)
            }
            Command::Set { path, value } => {
                let intervention = self.setting(&path, &value)?;
                self.intervene(intervention, Some((&path, &value)))
            }
            Command::Assume(starts) => self.intervene(Intervention::Assume(starts), None),
            Command::Follow { label, steps } => self.follow(label, steps),
            Command::Census(nodes) => Ok(self.census(&nodes)),
            Command::Export {
                what,
                file,
                overwrite,
            } => self.export(what, file, overwrite),
            Command::Remedies => Ok(self.remedies()),
            Command::Branch(to) => self.branch(&to),
            Command::Rename(label) => self.rename(label),
            Command::Branches => Ok(Reply(verdicts::listed(&self.tree))),
            Command::Compare(with) => self.side_by_side(with.as_deref()),
            Command::Break(condition) => Ok(self.add_breakpoint(condition)),
            Command::Breakpoints => Ok(Reply(self.list_breakpoints())),
            Command::Delete(id) => self.delete(id),
            Command::Enable { id, on } => self.enable(id, on),
            Command::Watch(watch) => self.watch(watch),
            Command::Unwatch(name) => self.unwatch(&name),
            Command::Snapshot { file, overwrite } => self.snapshot(file, overwrite),
            Command::Journal(file) => self.begin_journal(file),
        }
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
        Some(match self.pending.take() {
            Some(command) => {
                let command = self.as_far_as_done(command);
                self.note(command, reply)
            }
            None => reply,
        })
    }

    fn gather(&mut self, message: Message) -> Option<Reply> {
        match message {
            Message::Made(frame, strip) => {
                self.stand_at(&frame.state);
                self.solved += 1;
                self.accepted += u64::from(strip.kind.is_accepted());
                self.tree.push(*frame, *strip);
                self.cursor = self.frames().len() - 1;
                None
            }
            Message::Changed(state, intervention) => {
                let last = self.frames().len() - 1;
                self.tree.intervene(last, *state, intervention);
                self.cursor = last + 1;
                None
            }
            Message::Again(state, event) => {
                self.stand_at(&state);
                self.refill(*state, event);
                None
            }
            Message::Done {
                interrupted,
                hits,
                remark,
            } => {
                let Reply(told) = self.done(interrupted, &hits);
                let remark = remark.map_or(String::new(), |remark| remark + "; ");
                Some(Reply(remark + &told))
            }
            Message::Lost(lost) => {
                self.task = None;
                if self.offers.past.is_some() {
                    return Some(Reply(lost.to_string()));
                }
                self.stands.at = None;
                self.stands.lost = Some(lost.to_string());
                Some(Reply(format!("{lost}; all steps so far are kept")))
            }
            Message::Died => {
                self.task = None;
                Some(Reply(
                    "the solver stopped unexpectedly; all steps so far are kept".into(),
                ))
            }
        }
    }

    fn done(&mut self, interrupted: bool, hits: &[u32]) -> Reply {
        let mut told = self.stops(hits);
        if let Some(Task::Again {
            next,
            target,
            sound,
        }) = self.task.take()
            && next > target
        {
            self.cursor = target;
            if !sound {
                told += "the recomputed state differs from the original (please report this bug); ";
            }
        }
        if interrupted {
            told += "interrupted; ";
        }
        Reply(told + &self.told())
    }

    /// Records in the journal that a motion starts solving.
    fn begin(&mut self, command: &Command) {
        self.diary.renew(&self.scene);
        if matches!(self.task, Some(Task::Run)) {
            let scene = &self.scene;
            self.diary.write(scene, |journal| journal.begun(command));
        }
    }

    /// Records a completed command in the journal.
    fn note(&mut self, command: Command, Reply(said): Reply) -> Reply {
        self.diary.renew(&self.scene);
        if command.is_look() || !self.diary.is_kept() {
            return Reply(said + &self.diary.take_trouble());
        }
        let changes = self.solved > 0 || !command.is_motion();
        let entry = Entry {
            at: journal::now(),
            command,
            solved: self.solved,
            accepted: self.accepted,
            branch: self.tree.current(),
            cursor: self.cursor,
            digest: journal::digest(&self.frame().state),
            said: said.clone(),
        };
        self.diary.done(&self.scene, entry, changes);
        Reply(said + &self.diary.take_trouble())
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

    /// A monitor over the load factor, at the end of each accepted increment up to the cursor.
    pub fn curve(&self, monitor: usize) -> Vec<[f64; 2]> {
        curve(&self.frames()[..=self.cursor], monitor)
    }

    pub(super) fn told(&self) -> String {
        let frame = self.frame();
        match &frame.event {
            None => "at the start".into(),
            Some(event) => report::outcome(self.model(), event),
        }
    }
}
