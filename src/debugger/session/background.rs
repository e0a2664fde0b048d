//! Analyses that need extra solves, run on a separate thread so that they do not disturb the session's solver.
//!
//! - **Pushes**: how much the changes of all nodes since the previous minor iteration moved one node
//!   ([`pushes`]). The thread repeats both iterations and reads the frozen interface problem between them.
//! - **Examinations**: the diagnosis of the cycle that the shown state runs into, or otherwise the census of
//!   the frozen problem that is solved next.
//! - **Exports**: files made from a state ([`exports`](super::exports)).
//! - **Remedies**: a trial of each remedy ([`remedies`]).
//! - **Worst points** of the solids, which the shape marks.
//!
//! The thread has a separate solver for the session's scene. If the session's solver already has the frozen
//! problem, the thread borrows it, so that nothing is factored twice. A large solver is dropped when the queue
//! is empty, so that the session needs no more memory than a run. Pushes between many slave nodes, or that need a large solver,
//! are computed on demand.
//!
//! Pushes and examinations are cached by position (branch, step on its line), because the state at a position
//! never changes.

mod attached_solver;

use super::background_messages::{
    BackgroundReply, BackgroundRequest, BetweenRuns, LinePlace, Reported,
};
use super::exports::{Export, is_of_problem, write, write_posed};
use super::trials::try_remedies;
use super::worker::Lender;
use crate::explain::examination::examine_nodes;
use crate::explain::influence::{PushPath, between, pushed, pushes};
use crate::explain::page::page;
use crate::explain::remedies;
use crate::explain::reported_pushes;
use crate::memo::Memo;
use crate::refusal::Refusal;
use crate::{DiagnosisPage, NodePush, RemedyTrial};
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use stickslip_core::fem::deformation::deformation;
use stickslip_core::{
    Capabilities, Estimate, Model, PointDeformation, ReportedProblem, State, Stepper,
};
use stickslip_platform::task::{self, Next};
use stickslip_scene::Spec;
use stickslip_scene::solver::solver;

/// Maximum number of cached entries, for pushes and for examinations separately.
const KEPT: usize = 512;
/// A solver that takes more bytes than this is dropped when idle.
const LARGE: f64 = 2e8;
/// With more slave nodes, pushes are computed only on demand: their equations are dense.
const MANY: usize = 100;
/// Last line of a page whose analysis was interrupted.
const STOPPED: &str = "interrupted; :census starts it again";
/// The remedies tried from one position so far.
#[derive(Debug, Clone)]
pub struct RemedyTrials {
    /// Position that the trials start from.
    pub place: LinePlace,
    /// Number of remedies to try; `None` until it is known.
    pub all: Option<usize>,
    /// The remedy that is running.
    pub now: String,
    /// Finished trials, in the order of [`remedies::sort`].
    pub trials: Vec<RemedyTrial>,
    /// Whether the trials were interrupted before the last one.
    pub stopped: bool,
}

/// State of the background thread.
struct Helper {
    model: Arc<Model>,
    /// The scene, for our own solver.
    spec: Option<Spec>,
    /// Capabilities of the session's solver.
    offers: Capabilities,
    /// Stop flag, for trials that run on the session's thread.
    stopping: Arc<AtomicBool>,
    /// Built on the first request.
    stepper: Option<Stepper>,
    /// State and interface problem that an attached solver last reported.
    posed: Option<(State, ReportedProblem)>,
    /// Whether the solver takes much memory.
    large: bool,
    /// Access to the session's solver.
    lender: Lender,
}

/// Handle of the background thread, with its results.
#[derive(Debug)]
pub struct Background {
    asks: Sender<BackgroundRequest>,
    replies: Receiver<BackgroundReply>,
    stop: Arc<AtomicBool>,
    /// Requests without an answer yet.
    waiting: usize,
    pushes: HashMap<(LinePlace, usize), Option<Vec<NodePush>>>,
    /// Position at which pushes need a large solver, and the one at which they are computed nevertheless.
    costly: Option<LinePlace>,
    demanded: Option<LinePlace>,
    /// Worst points of the solids by displacements; `None` if no point is bad, or while it is being computed.
    pub(super) worst: Memo<Vec<f64>, Option<PointDeformation>>,
    /// By position: the requested nodes, and the result.
    examinations: HashMap<LinePlace, (Vec<usize>, Option<DiagnosisPage>)>,
    exported: Option<Result<String, Refusal>>,
    /// Number of requested exports without a result.
    exporting: usize,
    tried: Option<RemedyTrials>,
    trying: bool,
    /// Examinations running or queued.
    examining: usize,
}

impl Background {
    /// The worst point of the solids at displacements; `None` if there is none, or while it is being computed.
    pub fn worst_point(&self, u: &Arc<Vec<f64>>) -> Option<PointDeformation> {
        self.worst.find(u).flatten()
    }

    /// Requests the worst point at displacements, once.
    pub(super) fn ask_worst_point(&mut self, u: &Arc<Vec<f64>>) {
        if self.worst.find(u).is_none() {
            self.worst.keep(u, None);
            self.send(BackgroundRequest::WorstPoint(u.clone()));
        }
    }

    /// Starts the thread, idle.
    ///
    /// `spec` is the scene as written by its author, from which a finer mesh may be generated; `None` for an attached solver.
    /// `lender` gives access to the session's solver.
    pub fn new(
        model: Arc<Model>,
        spec: Option<Spec>,
        offers: Capabilities,
        lender: Lender,
    ) -> Background {
        let (asks, orders) = channel::<BackgroundRequest>();
        let (news, replies) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let flag = stop.clone();
        let start = move || {
            let effort = Estimate::from_model(&model).with(model.settings.solver).0;
            let mut helper = Helper {
                large: effort.bytes > LARGE,
                model,
                spec,
                offers,
                stopping: flag.clone(),
                stepper: None,
                posed: None,
                lender,
            };
            move |ask| match helper.answer(ask, &news, &flag) {
                Some(()) => {
                    helper.rest();
                    Next::Job
                }
                None => Next::End,
            }
        };
        task::serve(orders, start);
        Background {
            asks,
            replies,
            stop,
            waiting: 0,
            pushes: HashMap::new(),
            costly: None,
            demanded: None,
            worst: Memo::default(),
            examinations: HashMap::new(),
            exported: None,
            exporting: 0,
            tried: None,
            trying: false,
            examining: 0,
        }
    }

    /// Whether any request is still unanswered.
    pub fn is_busy(&self) -> bool {
        self.waiting > 0
    }

    /// The pushes on a slave node at a position: `None` if not computed yet, inner `None` if they cannot be
    /// computed.
    pub fn pushes(&self, place: LinePlace, slave: usize) -> Option<Option<&[NodePush]>> {
        let found = self.pushes.get(&(place, slave))?;
        Some(found.as_deref())
    }

    /// Whether the pushes at a position are computed only on demand.
    pub fn is_costly(&self, place: LinePlace) -> bool {
        self.costly == Some(place) && self.demanded != Some(place)
    }

    /// Computes the pushes at a position whatever they cost.
    pub(super) fn demand_pushes(&mut self, place: LinePlace) {
        self.demanded = Some(place);
    }

    /// The examination at a position; the inner value is `None` while it is running.
    pub fn examination(&self, place: LinePlace) -> Option<Option<&DiagnosisPage>> {
        Some(self.examinations.get(&place)?.1.as_ref())
    }

    /// The latest remedy trials.
    pub fn tried(&self) -> Option<&RemedyTrials> {
        self.tried.as_ref()
    }

    /// Whether remedy trials are running.
    pub fn is_trying(&self) -> bool {
        self.trying
    }

    /// Whether an examination is running.
    pub fn is_examining(&self) -> bool {
        self.examining > 0
    }

    /// Requests the pushes on a node. Ignored while another such request is waiting; ask again later.
    pub(super) fn ask_pushes(
        &mut self,
        place: LinePlace,
        slave: usize,
        between: impl FnOnce() -> Option<BetweenRuns>,
    ) {
        if self.waiting == 0
            && !self.pushes.contains_key(&(place, slave))
            && !self.is_costly(place)
            && let Some(between) = between()
        {
            let demanded = self.demanded == Some(place);
            self.send(BackgroundRequest::Pushes(place, slave, between, demanded));
        }
    }

    /// Records that the pushes cannot be computed: only the attached solver knows them.
    pub(super) fn pushes_unknown(&mut self, place: LinePlace, slave: usize) {
        self.keep_pushes(place, slave, None);
    }

    fn keep_pushes(&mut self, place: LinePlace, slave: usize, found: Option<Vec<NodePush>>) {
        if self.pushes.len() >= KEPT {
            self.pushes.clear();
        }
        self.pushes.insert((place, slave), found);
    }

    /// Requests the examination of the state at a position, for these nodes or, if there are none, for the
    /// relevant ones. `reported` contains what the line shows about an attached solver.
    pub(super) fn ask_examination(
        &mut self,
        place: LinePlace,
        state: &State,
        nodes: &[usize],
        reported: Reported,
    ) {
        let known = self.examinations.get(&place);
        let stopped = |found: &Option<DiagnosisPage>| {
            found
                .as_ref()
                .is_some_and(|found| found.going_on == STOPPED)
        };
        if known.is_none_or(|(asked, found)| asked != nodes || stopped(found)) {
            if self.examinations.len() >= KEPT {
                self.examinations.clear();
            }
            self.examinations.insert(place, (nodes.to_vec(), None));
            let state = Box::new(state.clone());
            self.stop.store(false, Ordering::Relaxed);
            self.examining += 1;
            self.send(BackgroundRequest::Examination(
                place,
                state,
                nodes.to_vec(),
                reported,
            ));
        }
    }

    /// Stores a page that is made without the thread.
    pub(super) fn set_examination(&mut self, place: LinePlace, page: DiagnosisPage) {
        self.examinations.insert(place, (Vec::new(), Some(page)));
    }

    /// Requests an export.
    pub(super) fn ask_export(&mut self, export: Export) {
        self.exporting += 1;
        self.send(BackgroundRequest::Export(export));
    }

    /// Whether a requested file is not written yet.
    pub fn is_exporting(&self) -> bool {
        self.exporting > 0
    }

    /// Result of the latest export; returned once.
    pub fn exported(&mut self) -> Option<Result<String, Refusal>> {
        self.exported.take()
    }

    /// Tries all remedies from the state at a position.
    pub(super) fn ask_remedies(&mut self, place: LinePlace, state: &State) {
        self.stop.store(false, Ordering::Relaxed);
        self.tried = Some(RemedyTrials {
            place,
            all: None,
            now: String::new(),
            trials: Vec::new(),
            stopped: false,
        });
        self.trying = true;
        self.send(BackgroundRequest::Remedies(Box::new(state.clone())));
    }

    /// Stops remedy trials after the current minor iteration, and any running census.
    pub fn interrupt(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    pub(super) fn send(&mut self, ask: BackgroundRequest) {
        // If sending fails, the thread has ended and no answer will come.
        if self.asks.send(ask).is_ok() {
            self.waiting += 1;
        }
    }

    /// Collects new results without blocking. Returns whether there were any.
    pub fn gather(&mut self) -> bool {
        let mut any = false;
        loop {
            match self.replies.try_recv() {
                Ok(reply) => self.take(reply),
                Err(TryRecvError::Empty) => return any,
                Err(TryRecvError::Disconnected) => {
                    any |= self.waiting > 0;
                    self.gone();
                    return any;
                }
            }
            any = true;
        }
    }

    /// Blocks until all requests are answered.
    pub fn wait(&mut self) {
        while self.waiting > 0 {
            match task::receive(&self.replies) {
                Ok(reply) => self.take(reply),
                Err(_) => self.gone(),
            }
        }
    }

    /// The thread has ended: no answers will come.
    fn gone(&mut self) {
        (self.waiting, self.trying, self.examining) = (0, false, 0);
    }

    fn take(&mut self, reply: BackgroundReply) {
        match reply {
            BackgroundReply::Pushes(place, slave, found) => {
                self.keep_pushes(place, slave, found);
                self.waiting -= 1;
            }
            BackgroundReply::NotNow => self.waiting -= 1,
            BackgroundReply::Costly(place) => {
                self.costly = Some(place);
                self.waiting -= 1;
            }
            BackgroundReply::WorstPoint(u, found) => {
                self.worst.keep(&u, found);
                self.waiting -= 1;
            }
            BackgroundReply::Examination {
                place,
                nodes,
                found,
                going_on,
            } => {
                // Another set of nodes may have been requested in the meantime.
                match (found, self.examinations.get_mut(&place)) {
                    (Some(found), Some(kept)) if kept.0 == nodes => kept.1 = Some(*found),
                    (None, Some(kept)) if kept.0 == nodes => match &mut kept.1 {
                        Some(part) => STOPPED.clone_into(&mut part.going_on),
                        None => {
                            self.examinations.remove(&place);
                        }
                    },
                    _ => {}
                }
                self.examining -= usize::from(!going_on);
                self.waiting -= usize::from(!going_on);
            }
            BackgroundReply::Exported(result) => {
                self.exported = Some(result);
                self.exporting -= 1;
                self.waiting -= 1;
            }
            BackgroundReply::Trying { all, now } => {
                if let Some(tried) = &mut self.tried {
                    (tried.all, tried.now) = (Some(all), now);
                }
            }
            BackgroundReply::Trial(trial) => {
                if let Some(tried) = &mut self.tried {
                    tried.trials.push(*trial);
                    remedies::sort(&mut tried.trials);
                }
            }
            BackgroundReply::Done { stopped } => {
                if let Some(tried) = &mut self.tried {
                    tried.stopped = stopped;
                }
                self.trying = false;
                self.waiting -= 1;
            }
        }
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        self.interrupt();
    }
}

impl Helper {
    /// Answers a request; `None` if the receiver is gone.
    fn answer(
        &mut self,
        ask: BackgroundRequest,
        news: &Sender<BackgroundReply>,
        stop: &AtomicBool,
    ) -> Option<()> {
        match ask {
            BackgroundRequest::WorstPoint(u) => {
                let found = deformation(&self.model, &u);
                let found = found.and_then(|found| found.inverted().or(found.outside));
                news.send(BackgroundReply::WorstPoint(u, found)).ok()
            }
            BackgroundRequest::Pushes(place, slave, between, demanded) => {
                let found = match between {
                    BetweenRuns::Path(way) => match self.pushes(slave, way, demanded) {
                        Some(found) => Some(found),
                        None => return news.send(BackgroundReply::Costly(place)).ok(),
                    },
                    BetweenRuns::Reported(iterations) => {
                        let posed = self.posed_aside(&iterations.start);
                        posed.map(|posed| {
                            reported_pushes::pushes(&self.model, &iterations, &posed.ok()?, slave)
                        })
                    }
                };
                let reply = found.map_or(BackgroundReply::NotNow, |found| {
                    BackgroundReply::Pushes(place, slave, found)
                });
                news.send(reply).ok()
            }
            BackgroundRequest::Examination(place, state, nodes, reported)
                if self.spec.is_none() =>
            {
                let found = self.examine_attached(&state, &nodes, reported, stop);
                let found = (!stop.load(Ordering::Relaxed)).then(|| Box::new(found));
                news.send(BackgroundReply::Examination {
                    place,
                    nodes,
                    found,
                    going_on: false,
                })
                .ok()
            }
            BackgroundRequest::Examination(place, state, nodes, reported) => {
                self.borrow(&state);
                let (stepper, spec) = self.solver();
                let warnings = reported.findings;
                examine(stepper, spec, warnings, (place, &state, nodes), news, stop)
            }
            BackgroundRequest::Export(ask) => {
                let done = if self.spec.is_none() && is_of_problem(&ask) {
                    self.interface_problem(&ask.state)
                        .map_err(Refusal::from)
                        .and_then(|posed| write_posed(&self.model, &posed, &ask))
                } else {
                    write(self.solver().0, &ask)
                };
                let done = done.map(|()| format!("wrote {}", ask.file.display()));
                news.send(BackgroundReply::Exported(done)).ok()
            }
            BackgroundRequest::Remedies(state) if self.spec.is_none() => {
                self.try_attached(&state, news, stop)
            }
            BackgroundRequest::Remedies(state) => {
                let (stepper, spec) = self.solver();
                try_remedies(stepper, spec, &state, news, stop)
            }
        }
    }

    /// Our own solver, and the scene as written.
    fn solver(&mut self) -> (&mut Stepper, Option<&Spec>) {
        let model = &self.model;
        let stepper = self.stepper.get_or_insert_with(|| solver(model.clone()));
        (stepper, self.spec.as_ref())
    }

    /// The pushes on a node: from the session's solver if it has the frozen problem, otherwise from our own. The outer `None` if
    /// there are many slave nodes or ours is large, and they are not `demanded`.
    fn pushes(
        &mut self,
        slave: usize,
        way: PushPath,
        demanded: bool,
    ) -> Option<Option<Vec<NodePush>>> {
        if self.model.contacts.len() > MANY && !demanded {
            return None;
        }
        let way = Arc::new(way);
        let theirs = way.clone();
        // The session's solver only repeats the steps; the expensive part runs on this thread.
        let between = self.lender.look(move |solver| {
            let stepper = solver.stepper()?;
            let at_hand = stepper.condenses() && stepper.stands_for(&theirs.state);
            at_hand.then(|| between(stepper, &theirs))
        });
        match between.flatten() {
            Some(between) => Some(between.and_then(|between| pushed(&between, slave))),
            None if self.large && !demanded => None,
            None => Some(pushes(self.solver().0, slave, &way)),
        }
    }

    /// Copies the frozen problem of a state from the session's solver, if it has it.
    fn borrow(&mut self, state: &State) {
        let wanted = state.clone();
        let lent = self
            .lender
            .look(move |solver| solver.stepper()?.lend(&wanted));
        if let Some(lent) = lent.flatten() {
            self.solver().0.borrow(lent);
        }
    }

    /// Called when the queue is empty.
    fn rest(&mut self) {
        if self.large {
            self.stepper = None;
        }
    }
}

/// Examines a state, for these nodes or, if there are none, for the relevant ones.
fn examine(
    stepper: &mut Stepper,
    spec: Option<&Spec>,
    warnings: Vec<String>,
    (place, state, nodes): (LinePlace, &State, Vec<usize>),
    news: &Sender<BackgroundReply>,
    stop: &AtomicBool,
) -> Option<()> {
    let stopped = || stop.load(Ordering::Relaxed);
    let send = |found: Option<DiagnosisPage>, going_on: bool| {
        news.send(BackgroundReply::Examination {
            place,
            nodes: nodes.clone(),
            found: found.map(Box::new),
            going_on,
        })
    };
    let found = match nodes.as_slice() {
        [] => page(
            stepper,
            state,
            spec,
            warnings,
            &stopped,
            // A closed channel is noticed after the last part.
            &mut |part| drop(send(Some(part.clone()), true)),
        ),
        some => {
            let found = examine_nodes(stepper, state, some, &stopped);
            let found = DiagnosisPage::new(stepper.model(), found);
            if stopped() {
                drop(send(Some(found), true));
                None
            } else {
                Some(found)
            }
        }
    };
    send(found, false).ok()
}
