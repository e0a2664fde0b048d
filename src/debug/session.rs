//! A debugging session: the scene, everything done so far, and a cursor in it.
//!
//! The solver runs on a worker thread, one job at a time, so that whoever owns the session (the TUI, a test, a
//! script) stays free to answer keys. [`Session::submit`] takes a command, [`Session::poll`] gathers what the
//! worker has done since, [`Session::wait`] blocks until it is idle.
//!
//! The history is a [`Tree`] of branches; what is shown is a line of it, from the start to the tip of the current
//! branch. A frame is what one minor iteration left behind, or what one intervention changed; going back moves the
//! cursor, going forward moves it again and solves only past the line's end. An intervention before the end starts a
//! new branch, so that nothing is lost. Frames that were thinned to save memory are computed again on the worker when
//! the cursor goes there.

use crate::debug::branches::{self, Summary};
use crate::debug::breakpoints::{self, Breakpoint, Condition};
use crate::debug::command::{Command, Exported, To, Unit};
use crate::debug::compare::{self, Comparison};
use crate::debug::export::Origin;
use crate::debug::files;
use crate::debug::journal::{self, Entry, Journal, JournalError};
use crate::debug::looks::{Export, Looks, Way};
use crate::debug::report;
use crate::debug::snapshot::{Applied, Snapshot};
use crate::debug::strip::{Kind, Strip};
use crate::debug::tree::{self, Tree};
use crate::debug::watches::Watch;
use crate::debug::worker::{Job, Message, Worker};
use crate::linear::norms::Norms;
use crate::model::Model;
use crate::outside::shown;
use crate::scene::{Scene, paths};
use crate::step::event::Event;
use crate::step::intervene::Intervention;
use crate::step::state::{State, Status};
use crate::step::stepper::Stepper;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A point of the history.
///
/// A frame that was thinned has neither event nor slave nodes nor displacements ([`Frame::is_whole`]); its
/// intervention and monitors stay. The frame under the cursor and the last one are always whole.
#[derive(Debug, Clone)]
pub struct Frame {
    /// The state from which the next minor iteration goes on.
    pub state: State,
    /// The last minor iteration; none at the start.
    pub event: Option<Arc<Event>>,
    /// What the user changed here, if this frame is due to that and not to a minor iteration.
    pub intervention: Option<Intervention>,
    /// Values of the scene's monitors, where this frame ends an accepted increment.
    pub monitors: Option<Arc<Vec<f64>>>,
}

impl Frame {
    /// Whether state and event are there, and were not thinned.
    pub fn is_whole(&self) -> bool {
        !self.state.u.is_empty()
    }
}

/// What a command led to, as a line for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply(pub String);

/// A debugging session.
pub struct Session {
    scene: Scene,
    tree: Tree,
    cursor: usize,
    worker: Worker,
    task: Option<Task>,
    breakpoints: Vec<Breakpoint>,
    /// Number that the last breakpoint was given.
    numbered: u32,
    watches: Vec<Watch>,
    looks: Looks,
    journal: Kept,
    /// What was done so far, where a journal is wanted: another file can be begun with it.
    entries: Vec<Entry>,
    /// That the journal was lost, until it is said.
    trouble: String,
    /// The command that the worker is at.
    pending: Option<Command>,
    /// Minor iterations solved by the present command, and increments accepted among them.
    solved: u64,
    accepted: u64,
}

/// Where the journal of a session is.
enum Kept {
    Nowhere,
    /// In memory only, so that it can be written yet.
    Memory,
    /// At the default place, once there is something to write.
    Due,
    Open(Journal),
    /// It could not be written, and why.
    Lost(String),
}

/// What the worker is at.
#[derive(Debug, Clone, Copy)]
enum Task {
    /// New minor iterations.
    Run,
    /// Thinned frames again: the next to come, and the one that is wanted. `sound` as long as each tells what it told
    /// the first time.
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

    /// A session whose whole frames take no more than so many bytes ([`tree::BUDGET`] for others).
    pub fn with_budget(scene: Scene, bytes: usize) -> Self {
        let model = Arc::new(scene.model.clone());
        let start = Stepper::new(model.clone()).state().clone();
        Session {
            scene,
            tree: Tree::new(model.clone(), start, bytes),
            cursor: 0,
            worker: Worker::new(model.clone()),
            task: None,
            breakpoints: Vec::new(),
            numbered: 0,
            watches: Vec::new(),
            looks: Looks::new(model),
            journal: Kept::Nowhere,
            entries: Vec::new(),
            trouble: String::new(),
            pending: None,
            solved: 0,
            accepted: 0,
        }
    }

    /// Keeps a journal from now on.
    pub fn keep(&mut self, journal: Journal) {
        self.journal = Kept::Open(journal);
    }

    /// Keeps a journal at the default place, which is made when there is something to write.
    pub fn keep_at_default_place(&mut self) {
        self.journal = Kept::Due;
    }

    /// Keeps what is done in memory, so that a journal can be begun later.
    pub(super) fn keep_entries(&mut self) {
        self.journal = Kept::Memory;
    }

    /// Why there is no journal any more although one was wanted.
    pub fn lost_journal(&self) -> Option<&str> {
        match &self.journal {
            Kept::Lost(why) => Some(why),
            _ => None,
        }
    }

    /// Where the journal is, if there is one.
    pub fn journal(&self) -> Option<&Path> {
        match &self.journal {
            Kept::Open(journal) => Some(journal.path()),
            _ => None,
        }
    }

    /// Scene as read.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Scene as checked.
    pub fn model(&self) -> &Model {
        self.tree.model()
    }

    /// Path or built-in name that the scene came from.
    pub fn scene_name(&self) -> &str {
        &self.scene.name
    }

    /// The frames of the current branch's line, oldest first; never empty. Frame 0 is the start.
    pub fn frames(&self) -> &[Frame] {
        self.tree.frames()
    }

    /// The compact records of the same points: all there, whether their frames were thinned or not.
    pub fn strips(&self) -> &[Strip] {
        self.tree.strips()
    }

    /// The whole history, for [`branches`] and [`compare`].
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Index of the frame that is shown.
    pub fn cursor(&self) -> usize {
        self.cursor
    }

    /// The frame that is shown.
    pub fn frame(&self) -> &Frame {
        &self.tree.frames()[self.cursor]
    }

    /// All branches, summed up.
    pub fn branches(&self) -> Vec<Summary> {
        branches::summaries(&self.tree)
    }

    /// Two branches side by side, by number; none where one does not exist.
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

    /// The watches and their values at the cursor; none where nothing was solved for one.
    pub fn watched(&self) -> Vec<(&str, Option<f64>)> {
        let value = |watch: &Watch| watch.value(self.frame());
        self.watches
            .iter()
            .map(|watch| (watch.name.as_str(), value(watch)))
            .collect()
    }

    /// The branch, if there are several, and the watches with their values, in a line; empty where there is neither.
    pub fn aside(&self) -> String {
        let several = self.tree.branches().len() > 1;
        let branch =
            several.then(|| format!("in {}", branches::name(&self.tree, self.tree.current())));
        let watches = self.watched().into_iter().map(|(name, value)| match value {
            Some(value) => format!("{name} = {value:.6e}"),
            None => format!("{name} = none"),
        });
        branch
            .into_iter()
            .chain(watches)
            .collect::<Vec<_>>()
            .join("   ")
    }

    /// Whether the worker is busy.
    pub fn is_running(&self) -> bool {
        self.task.is_some()
    }

    /// Asks a running job to stop after the present minor iteration.
    pub fn interrupt(&self) {
        self.worker.interrupt();
    }

    /// Carries out (or starts) a command.
    ///
    /// # Errors
    /// A message that says what is wrong and what would be right.
    pub fn submit(&mut self, command: Command) -> Result<Reply, String> {
        if self.is_running() {
            return Err("the solver is running; interrupt it first (Ctrl-C)".into());
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

    fn carry_out(&mut self, command: Command) -> Result<Reply, String> {
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
            Command::Branches => Ok(Reply(branches::listed(&self.tree))),
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

    /// Gathers what the worker did since the last call; a message when a job came to its end. Never blocks.
    pub fn poll(&mut self) -> Option<Reply> {
        while self.is_running() {
            let message = self.worker.try_next()?;
            if let Some(reply) = self.take(message) {
                return Some(reply);
            }
        }
        None
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
                self.refill(*state, event);
                None
            }
            Message::Done { interrupted, hits } => Some(self.done(interrupted, &hits)),
            Message::Died => {
                self.task = None;
                Some(Reply(
                    "the solver stopped unexpectedly; what was done so far is kept".into(),
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
                told += "computed again, it is not what it was, please report this; ";
            }
        }
        if interrupted {
            told += "interrupted; ";
        }
        Reply(told + &self.told())
    }

    /// A command with the steps only that it took: one that was interrupted is replayed as far as it went.
    fn as_far_as_done(&self, command: Command) -> Command {
        match command {
            Command::Follow { label, mut steps } => {
                let own = self.tree.branches()[self.tree.current()].from;
                steps.truncate(self.frames().len() - own);
                Command::Follow { label, steps }
            }
            command => command,
        }
    }

    /// Notes in the journal that a motion begins to solve.
    fn begin(&mut self, command: &Command) {
        if matches!(self.task, Some(Task::Run)) {
            self.journal_with(|journal| journal.begun(command));
        }
    }

    /// Notes in the journal what a command led to.
    fn note(&mut self, command: Command, Reply(said): Reply) -> Reply {
        if is_look(&command) || matches!(self.journal, Kept::Nowhere) {
            return Reply(said + &std::mem::take(&mut self.trouble));
        }
        let changes = self.solved > 0 || !is_motion(&command);
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
        self.entries.push(entry.clone());
        self.journal_with(|journal| journal.done(entry, changes));
        Reply(said + &std::mem::take(&mut self.trouble))
    }

    /// Writes to the journal, if there is one. Where that fails it ends, and the next reply says so.
    fn journal_with(&mut self, write: impl FnOnce(&mut Journal) -> Result<(), JournalError>) {
        if matches!(self.journal, Kept::Due) {
            match Journal::create_default(&self.scene) {
                Ok(journal) => self.journal = Kept::Open(journal),
                Err(error) => return self.lose("there is no journal", &error),
            }
        }
        let Kept::Open(journal) = &mut self.journal else {
            return;
        };
        if let Err(error) = write(journal) {
            self.lose("the journal ends here", &error);
        }
    }

    fn lose(&mut self, what: &str, error: &JournalError) {
        self.journal = Kept::Lost(error.to_string());
        self.trouble =
            format!("; {what}: {error}; :journal FILE begins one with all that was done");
    }

    /// Begins a journal with all that was done, and goes on there; without a file, tells where it is.
    fn begin_journal(&mut self, file: Option<PathBuf>) -> Result<Reply, String> {
        let Some(file) = file else {
            return Ok(Reply(match (&self.journal, self.journal()) {
                (_, Some(path)) => format!("the journal is {}", path.display()),
                (Kept::Lost(why), _) => {
                    format!("the journal is lost: {why}; :journal FILE begins one")
                }
                _ => "there is no journal yet; :journal FILE begins one".into(),
            }));
        };
        if matches!(self.journal, Kept::Nowhere) && self.tree.len(self.tree.current()) > 1 {
            return Err(
                "this session keeps no journal, and what it did is not known any more".into(),
            );
        }
        let journal =
            Journal::create(&file, &self.scene, &self.entries).map_err(|e| e.to_string())?;
        self.journal = Kept::Open(journal);
        let count = self.entries.len();
        Ok(Reply(format!(
            "the journal is {} from now on; {count} entries are in it already",
            file.display()
        )))
    }

    /// Does what an entry of a journal says.
    ///
    /// # Errors
    /// A message where it leads elsewhere than it did.
    pub(super) fn replay(&mut self, entry: &Entry) -> Result<(), String> {
        match &entry.command {
            // Those that write files must not be done on the word of a file.
            command if is_look(command) => return Err("no journal has such a command".into()),
            command if is_motion(command) => self.travel(entry.solved, entry.cursor)?,
            command => {
                self.submit(command.clone())?;
                self.wait();
            }
        }
        let place = (self.tree.current(), self.cursor);
        if place != (entry.branch, entry.cursor) {
            let (branch, cursor) = place;
            return Err(format!(
                "it leads to step {cursor} of branch b{}, and led to step {} of b{}",
                branch + 1,
                entry.cursor,
                entry.branch.saturating_add(1)
            ));
        }
        let digest = journal::digest(&self.frame().state);
        if digest != entry.digest {
            return Err(format!(
                "the state is {digest}, and was {}",
                shown::cut(&entry.digest, 40)
            ));
        }
        // A motion is replayed as far as it went, and not as it was told.
        if is_motion(&entry.command) {
            self.entries.push(entry.clone());
        } else if let Some(own) = self.entries.last_mut() {
            *own = entry.clone();
        }
        Ok(())
    }

    /// Solves so many minor iterations from the tip of the branch, then goes to a step.
    fn travel(&mut self, solved: u64, step: usize) -> Result<(), String> {
        if solved > 0 {
            self.solved = 0;
            self.cursor = self.frames().len() - 1;
            let count = u32::try_from(solved).map_err(|_| "it solves too much for one motion")?;
            self.solve(Unit::Minor, count, Vec::new());
            self.wait();
        }
        if solved > 0 && self.solved != solved {
            return Err(format!(
                "it solves {} minor iterations, and solved {solved}",
                self.solved
            ));
        }
        self.jump(step)?;
        self.wait();
        Ok(())
    }

    /// Moves the cursor over what is known already, then solves on.
    fn forward(&mut self, unit: Unit, count: u32) -> Reply {
        let mut left = count;
        let (mut at, mut hits) = (self.cursor, Vec::new());
        let strips = self.strips();
        while left > 0 && hits.is_empty() && at + 1 < strips.len() {
            at += 1;
            left -= u32::from(ends(unit, strips[at].kind));
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
        Reply("running; Ctrl-C interrupts".into())
    }

    /// Starts new minor iterations from the cursor, which is at the tip.
    fn solve(&mut self, unit: Unit, count: u32, breakpoints: Vec<Breakpoint>) {
        self.task = Some(Task::Run);
        self.worker.start(Job::Run {
            state: Box::new(self.frame().state.clone()),
            before: Box::new(self.strips()[self.cursor].clone()),
            unit,
            count,
            breakpoints,
        });
    }

    fn back(&mut self, unit: Unit, count: u32) -> Result<Reply, String> {
        if self.cursor == 0 {
            return Err("this is the start".into());
        }
        let strips = self.strips();
        let (mut at, mut hits) = (self.cursor, Vec::new());
        for _ in 0..count {
            if at == 0 {
                // However much farther it was to go.
                break;
            }
            let here = |k: usize| match k {
                0 => Vec::new(),
                k => breakpoints::hits(&self.breakpoints, &strips[k - 1], &strips[k]),
            };
            let stops = |k: &usize| match unit {
                Unit::Minor => true,
                Unit::Run => strips[*k].kind.is_failure() || !here(*k).is_empty(),
                _ => ends(unit, strips[*k].kind),
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

    fn jump(&mut self, step: usize) -> Result<Reply, String> {
        let last = self.frames().len() - 1;
        if step > last {
            return Err(format!(
                "there is no step {step} yet; the last one is {last}"
            ));
        }
        Ok(self.go_to(step, &[]))
    }

    /// Puts the cursor on a point of the line; a thinned one is computed first, from the nearest whole one before it.
    fn go_to(&mut self, target: usize, hits: &[u32]) -> Reply {
        let from = self.tree.whole_before(target);
        if from == target {
            self.cursor = target;
            return Reply(self.stops(hits) + &self.told());
        }
        let frames = &self.frames()[from..=target];
        let job = Job::Again {
            state: Box::new(frames[0].state.clone()),
            event: frames[0].event.clone(),
            steps: frames[1..]
                .iter()
                .map(|frame| frame.intervention.clone())
                .collect(),
        };
        self.task = Some(Task::Again {
            next: from + 1,
            target,
            sound: true,
        });
        self.worker.start(job);
        Reply(format!(
            "computing {} steps again; Ctrl-C interrupts",
            target - from
        ))
    }

    fn refill(&mut self, state: State, event: Option<Arc<Event>>) {
        if let Some(Task::Again { next, sound, .. }) = &mut self.task {
            *sound &= self.tree.refill(*next, state, event);
            self.tree.thin([*next, self.cursor]);
            *next += 1;
        }
    }

    /// Which breakpoints a run stopped at, as the beginning of a reply.
    fn stops(&self, hits: &[u32]) -> String {
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

    /// Changes something at the cursor; `setting` is the path and the value that it came from.
    fn intervene(
        &mut self,
        intervention: Intervention,
        setting: Option<(&str, &str)>,
    ) -> Result<Reply, String> {
        let mut state = self.frame().state.clone();
        state
            .intervene(self.model(), &intervention)
            .map_err(|why| why.to_string())?;
        let mut told = report::intervention(self.model(), &intervention);
        let label = branches::label(self.model(), &intervention, setting);
        let before = self.strips()[self.cursor].kind;
        let forks = self.tree.intervene(self.cursor, state, intervention);
        self.cursor += 1;
        let branch = &self.tree.branches()[self.tree.current()];
        if forks {
            self.tree.rename(label, false);
            let name = branches::name(&self.tree, self.tree.current());
            told += &format!(" (in the new branch {name})");
        } else if !branch.named
            && before == Kind::Intervention
            && branch.from < self.cursor
            && branch.parent.is_some()
        {
            // What is done before anything is solved belongs to the same trial.
            let label = format!("{}, {label}", branch.label);
            self.tree.rename(label, false);
        }
        Ok(Reply(told))
    }

    /// Takes given steps from the cursor, in a branch of their own.
    fn follow(&mut self, label: String, steps: Vec<Option<Intervention>>) -> Result<Reply, String> {
        let (state, before) = (
            self.frame().state.clone(),
            self.strips()[self.cursor].clone(),
        );
        self.tree.fork(self.cursor);
        self.tree.rename(shown::line(&label).into_owned(), false);
        self.task = Some(Task::Run);
        self.worker.start(Job::Follow {
            state: Box::new(state),
            before: Box::new(before),
            steps,
        });
        let name = branches::name(&self.tree, self.tree.current());
        Ok(Reply(format!("running in the new branch {name}")))
    }

    /// What is found out beside the run.
    pub fn looks(&self) -> &Looks {
        &self.looks
    }

    /// Gathers what was found out; whether there was anything new. Never blocks.
    pub fn gather_looks(&mut self) -> bool {
        self.looks.gather()
    }

    /// Blocks until all that was asked is found out.
    pub fn wait_for_looks(&mut self) {
        self.looks.wait();
    }

    /// The place of the cursor, by which [`Looks`] keeps what it found.
    pub fn place(&self) -> (usize, usize) {
        (self.tree.current(), self.cursor)
    }

    /// Asks, where it is not known yet, what pushed a slave node in the shown minor iteration, and for the diagnosis
    /// where that closed a cycle. Answers come with [`Session::gather_looks`].
    pub fn look(&mut self, slave: usize) {
        if self.is_running() || slave >= self.model().contacts.len() {
            return;
        }
        let place = self.place();
        if self.strips()[self.cursor].kind == Kind::Cycle && self.looks.finding(place).is_none() {
            self.census(&[]);
        }
        let Some(before) = self.minor_before() else {
            return;
        };
        let (tree, cursor) = (&self.tree, self.cursor);
        self.looks.ask_pushes(place, slave, || {
            let from = tree.whole_before(before - 1);
            let frames = &tree.frames()[from..cursor];
            let steps = frames[1..].iter().map(|frame| frame.intervention.clone());
            Way {
                state: Box::new(frames[0].state.clone()),
                steps: steps.collect(),
                before: before - from - 1,
            }
        });
    }

    /// The minor iteration before the shown one in the same frozen problem, as a step of the line.
    pub fn minor_before(&self) -> Option<usize> {
        let strips = self.strips();
        let shown = &strips[self.cursor];
        let before = (1..self.cursor)
            .rev()
            .find(|&at| strips[at].kind.is_solved())?;
        let of = |strip: &Strip| {
            let at = strip.position;
            (at.increment, at.attempt, at.major)
        };
        let same = of(&strips[before]) == of(shown)
            && matches!(
                strips[before].kind,
                Kind::Minor | Kind::Climbed | Kind::Cycle | Kind::Failed
            );
        (shown.kind.is_solved() && same).then_some(before)
    }

    /// Finds out why the minor iterations cycle from the shown state, or which states are consistent; of some nodes only,
    /// where these are given.
    fn census(&mut self, nodes: &[usize]) -> Reply {
        let place = self.place();
        let state = &self.tree.frames()[self.cursor].state;
        self.looks.ask_finding(place, state, nodes);
        Reply("the diagnosis (d) tells what is found".into())
    }

    /// Has the core or the whole interface problem of the shown state written; what came of it comes with
    /// [`Session::exported`].
    fn export(&mut self, what: Exported, file: PathBuf, overwrite: bool) -> Result<Reply, String> {
        // Sooner rather than later; it leaves nothing behind.
        files::regular(&file).map_err(|e| e.to_string())?;
        drop(files::Output::create(&file, overwrite).map_err(|e| e.to_string())?);
        let frame = self.frame();
        let at = match &frame.event {
            Some(event) if matches!(frame.state.status, Status::Failed(_)) => event.position,
            _ => frame.state.next,
        };
        let mut origin = Origin::of(&self.scene, at, frame.state.target);
        let changed = self.record().1;
        let words = changed
            .iter()
            .map(|a| report::intervention(self.model(), &a.intervention));
        origin.changes.extend(words);
        let told = format!("writing {}", file.display());
        let state = Box::new(frame.state.clone());
        self.looks.ask_export(Export {
            what,
            file,
            overwrite,
            origin,
            state,
        });
        Ok(Reply(told))
    }

    /// What came of the last file that [`Command::Export`] wrote; once.
    pub fn exported(&mut self) -> Option<Result<Reply, String>> {
        Some(self.looks.exported()?.map(Reply))
    }

    fn remedies(&mut self) -> Reply {
        if self.looks.is_trying() {
            return Reply("remedies are being tried; Ctrl-C stops that".into());
        }
        let place = self.place();
        let state = &self.tree.frames()[self.cursor].state;
        self.looks.ask_remedies(place, state);
        Reply("trying every remedy from here; Ctrl-C stops".into())
    }

    fn branch(&mut self, to: &To) -> Result<Reply, String> {
        let (count, current) = (self.tree.branches().len(), self.tree.current());
        let to = match to {
            To::Next => (current + 1) % count,
            To::Previous => (current + count - 1) % count,
            To::Named(name) => branches::find(&self.tree, name)?,
        };
        if count == 1 {
            return Err(
                "there is no other branch; an intervention before the tip starts one".into(),
            );
        }
        self.tree.switch(to);
        self.cursor = self.frames().len() - 1;
        let name = branches::name(&self.tree, to);
        let verdict = branches::describe(&self.tree, &branches::verdict(&self.tree, to));
        Ok(Reply(format!("{name} ({verdict}): {}", self.told())))
    }

    fn rename(&mut self, label: String) -> Result<Reply, String> {
        let label = label.trim().to_owned();
        let number = |text: &str| {
            text.strip_prefix('b')
                .is_some_and(|n| n.parse::<u32>().is_ok())
        };
        let taken = self
            .tree
            .branches()
            .iter()
            .any(|branch| branch.label == label);
        if label.is_empty() || label.contains(shown::is_order) {
            return Err("a branch's name is one line of text".into());
        } else if taken {
            return Err(format!("another branch is called '{label}'"));
        } else if number(&label) {
            return Err(format!(
                "'{label}' looks like a branch's number; any other name would do"
            ));
        }
        self.tree.rename(label, true);
        let name = branches::name(&self.tree, self.tree.current());
        Ok(Reply(format!("this branch is {name}")))
    }

    /// Compares the current branch with another, by default the one that it left.
    fn side_by_side(&self, with: Option<&str>) -> Result<Reply, String> {
        let current = self.tree.current();
        let with = match with {
            Some(name) => branches::find(&self.tree, name)?,
            None => self.tree.branches()[current]
                .parent
                .ok_or("which branch? :compare BRANCH")?,
        };
        if with == current {
            return Err("that is this branch; another one would be compared with it".into());
        }
        let comparison = self
            .compare(current, with)
            .ok_or("there is nothing to compare")?;
        Ok(Reply(compare::describe(&self.tree, &comparison)))
    }

    fn add_breakpoint(&mut self, condition: Condition) -> Reply {
        self.numbered += 1;
        let breakpoint = Breakpoint {
            id: self.numbered,
            condition,
            enabled: true,
        };
        let told = breakpoints::describe(self.model(), &breakpoint);
        self.breakpoints.push(breakpoint);
        Reply(format!("breakpoint {told}"))
    }

    fn list_breakpoints(&self) -> String {
        let told = |b: &Breakpoint| breakpoints::describe(self.model(), b);
        let all: Vec<String> = self.breakpoints.iter().map(told).collect();
        match all.is_empty() {
            true => "there are no breakpoints; :break sets one".into(),
            false => format!("breakpoints {}", all.join(", ")),
        }
    }

    /// The breakpoint of a number.
    fn breakpoint(&mut self, id: u32) -> Result<&mut Breakpoint, String> {
        let listed = self.list_breakpoints();
        let found = self.breakpoints.iter_mut().find(|b| b.id == id);
        found.ok_or(format!("there is no breakpoint {id}; {listed}"))
    }

    fn delete(&mut self, id: Option<u32>) -> Result<Reply, String> {
        match id {
            Some(id) => {
                self.breakpoint(id)?;
                self.breakpoints.retain(|b| b.id != id);
            }
            None => self.breakpoints.clear(),
        }
        Ok(Reply(self.list_breakpoints()))
    }

    fn enable(&mut self, id: Option<u32>, on: bool) -> Result<Reply, String> {
        match id {
            Some(id) => self.breakpoint(id)?.enabled = on,
            None => self.breakpoints.iter_mut().for_each(|b| b.enabled = on),
        }
        Ok(Reply(self.list_breakpoints()))
    }

    fn watch(&mut self, watch: Watch) -> Result<Reply, String> {
        if self.watches.iter().any(|other| other.name == watch.name) {
            return Err(format!(
                "there is a watch '{}' already; unwatch ends it",
                watch.name
            ));
        }
        let value = watch.value(self.frame());
        let told = match value {
            Some(value) => format!("{} = {value:e}", watch.name),
            None => format!("{}: nothing is solved for it here", watch.name),
        };
        self.watches.push(watch);
        Ok(Reply(told))
    }

    fn unwatch(&mut self, name: &str) -> Result<Reply, String> {
        let names: Vec<String> = self.watches.iter().map(|w| w.name.clone()).collect();
        if !names.iter().any(|other| other == name) {
            return Err(match names.is_empty() {
                true => "there are no watches; :watch adds one".into(),
                false => format!(
                    "no watch is called '{name}'; there are {}",
                    names.join(", ")
                ),
            });
        }
        self.watches.retain(|watch| watch.name != name);
        Ok(Reply(format!("{name} is not watched any more")))
    }

    /// What `:set` means, on top of what was set before.
    fn setting(&self, path: &str, value: &str) -> Result<Intervention, String> {
        let controls = &self.frame().state.controls;
        let mut spec = self.scene.spec.clone();
        spec.settings = controls.settings;
        spec.history.increment = controls.increment;
        if let Some(friction) = controls.friction.first() {
            spec.friction = *friction;
        }
        paths::set(&mut spec, path, value)?;
        let sound = Scene::from_spec(&self.scene.name, spec).map_err(|e| e.message)?;
        if path.starts_with("settings.") {
            Ok(Intervention::Settings(sound.model.settings))
        } else if path.starts_with("friction.") {
            Ok(Intervention::Friction(sound.spec.friction))
        } else if path == "history.increment" {
            Ok(Intervention::Increment(sound.spec.history.increment))
        } else {
            Err(format!(
                "{path} cannot change during a run; friction.*, settings.* and history.increment can (or start again with --set {path}={value})"
            ))
        }
    }

    /// Number of minor iterations done up to the cursor, and the interventions among them.
    fn record(&self) -> (u64, Vec<Applied>) {
        let (mut step, mut applied) = (0, Vec::new());
        for frame in &self.frames()[1..=self.cursor] {
            match &frame.intervention {
                Some(intervention) => applied.push(Applied {
                    step,
                    intervention: intervention.clone(),
                }),
                None => step += 1,
            }
        }
        (step, applied)
    }

    fn snapshot(&self, file: Option<PathBuf>, overwrite: bool) -> Result<Reply, String> {
        let (steps, applied) = self.record();
        let frame = self.frame();
        let snapshot = Snapshot::take(
            &self.scene,
            &applied,
            steps,
            &frame.state,
            frame.event.as_deref(),
        );
        let file = file.unwrap_or_else(|| self.free_name());
        files::regular(&file).map_err(|e| e.to_string())?;
        snapshot
            .write(&file, overwrite)
            .map_err(|e| e.to_string())?;
        Ok(Reply(format!("wrote {}", file.display())))
    }

    /// `SCENE-INC.MAJOR.MINOR.ron` in the working directory, with a number where that exists.
    fn free_name(&self) -> PathBuf {
        let scene = files::stem(self.scene_name());
        let at = match &self.frame().event {
            Some(event) => event.position,
            None => self.frame().state.next,
        };
        let stem = format!("{scene}-{}.{}.{}", at.increment, at.major, at.minor);
        let name = |k: u32| {
            PathBuf::from(if k == 0 {
                format!("{stem}.ron")
            } else {
                format!("{stem}-{k}.ron")
            })
        };
        (0..1000)
            .map(name)
            .find(|name| !name.exists())
            .unwrap_or_else(|| name(1000))
    }

    /// Residual norms of the shown increment attempt up to the cursor: before its first major iteration (0), and
    /// after each.
    pub fn residual_history(&self) -> Vec<(u32, Norms)> {
        let Some(event) = &self.frame().event else {
            return Vec::new();
        };
        let shown = event.position;
        let mut history: Vec<(u32, Norms)> = Vec::new();
        for strip in self.strips()[..=self.cursor].iter().rev() {
            let at = strip.position;
            if strip.kind == Kind::Start
                || (at.increment, at.attempt) != (shown.increment, shown.attempt)
            {
                break;
            }
            history.extend(strip.after.as_deref().map(|after| (at.major, *after)));
            history.extend(strip.first.as_deref().map(|first| (0, *first)));
        }
        history.reverse();
        history.dedup_by_key(|entry| entry.0);
        history
    }

    /// A monitor against the load factor, at the end of every accepted increment up to the cursor.
    pub fn curve(&self, monitor: usize) -> Vec<[f64; 2]> {
        curve(&self.frames()[..=self.cursor], monitor)
    }

    fn told(&self) -> String {
        let frame = self.frame();
        match &frame.event {
            None => "at the start".into(),
            Some(event) => report::outcome(self.model(), event),
        }
    }
}

/// Whether a command changes nothing, and is in no journal.
fn is_look(command: &Command) -> bool {
    matches!(
        command,
        Command::Branches
            | Command::Census(_)
            | Command::Remedies
            | Command::Export { .. }
            | Command::Compare(_)
            | Command::Breakpoints
            | Command::Snapshot { .. }
            | Command::Journal(_)
    )
}

/// Whether a command only goes along a branch.
fn is_motion(command: &Command) -> bool {
    matches!(
        command,
        Command::Forward { .. } | Command::Back { .. } | Command::Goto { .. }
    )
}

/// A monitor's value and the load factor at the end of every accepted increment among these frames.
pub fn curve(frames: &[Frame], monitor: usize) -> Vec<[f64; 2]> {
    let point = |frame: &Frame| {
        let value = *frame.monitors.as_ref()?.get(monitor)?;
        let accepted = frame.state.start.load_factor;
        Some([
            value,
            frame
                .event
                .as_ref()
                .map_or(accepted, |event| event.load_factor),
        ])
    };
    frames.iter().filter_map(point).collect()
}

/// Whether a point of this kind ends a motion by this unit.
pub(super) fn ends(unit: Unit, kind: Kind) -> bool {
    match unit {
        Unit::Minor => kind.is_solved(),
        Unit::Major => kind.ends_major(),
        Unit::Increment => kind.is_accepted() || kind.is_failure(),
        Unit::Run => kind.is_last() || kind.is_failure(),
    }
}
