//! Looking closer without disturbing: what needs solves of its own, made on a thread of its own beside the session's.
//!
//! - **Pushes**: what the changes of all nodes since the minor iteration before did to one node ([`pushes`]). The
//!   thread goes over both iterations again and takes the frozen interface problem between them.
//! - **Findings**: the diagnosis of the cycle that the shown state runs into, or else the census of the frozen problem
//!   that is solved next from it.
//! - **Exports**: files of a state ([`exports`](super::exports)).
//! - **Remedies**: trials of every way out ([`remedies`]).
//!
//! The thread has a solver of its own, of the session's scene. Where the session's solver has the frozen problem at hand, it lends
//! it, so that nothing is factored twice; a large solver is dropped when nothing is asked, so that the session takes no more
//! memory than a run.
//!
//! Pushes and examinations are kept by place (branch and step on its line), which never changes its meaning.

use super::exports::{Export, is_of_problem, write, write_posed};
use super::worker::Lender;
use crate::explain::attached;
use crate::explain::examination::{Examination, examine_nodes};
use crate::explain::influence::{Push, Way, between, pushed, pushes};
use crate::explain::page::page;
use crate::explain::pushes_told::{self, Iterations};
use crate::explain::remedies::{self, Trial};
use crate::explain::remedy::Remedy;
use crate::record::export::shown::ExportError;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;
use stickslip_core::linear::estimate::Estimate;
use stickslip_core::model::Model;
use stickslip_core::step::solver::{Lost, Offers, Posed};
use stickslip_core::step::state::{State, Status};
use stickslip_core::step::stepper::Stepper;
use stickslip_scene::format::spec::Spec;
use stickslip_scene::solver::solver;

/// Most entries that are kept of pushes, and of examinations.
const KEPT: usize = 512;
/// Bytes from which on a solver takes much memory.
const LARGE: f64 = 2e8;
/// What a page says that was stopped.
const STOPPED: &str = "stopped; :census goes on from the beginning";
/// A place: branch, and step on its line.
pub type LinePlace = (usize, usize);

/// The remedies that were tried from a place, as far as they are.
#[derive(Debug, Clone)]
pub struct Tried {
    /// The place that it starts from.
    pub place: LinePlace,
    /// How many there are to try; `None` until that is known.
    pub all: Option<usize>,
    /// The one that is being tried now.
    pub now: String,
    /// Done, in the order of [`remedies::sort`].
    pub trials: Vec<Trial>,
    /// Whether it was stopped before all were tried.
    pub stopped: bool,
}

enum Ask {
    Pushes(LinePlace, usize, Between),
    /// With what is known already, of an attached solver.
    Examination(LinePlace, Box<State>, Vec<usize>, Vec<String>),
    Remedies(Box<State>),
    Export(Export),
}

/// The two minor iterations between which a node was pushed.
pub(super) enum Between {
    /// How to come to them again.
    Way(Way),
    /// What an attached solver told of them.
    Told(Iterations),
}

enum Told {
    Pushes(LinePlace, usize, Option<Vec<Push>>),
    /// The solver was at work.
    NotNow,
    /// The page as far as it is made, or (not `going_on`) whole.
    Examination {
        place: LinePlace,
        nodes: Vec<usize>,
        found: Option<Box<Examination>>,
        going_on: bool,
    },
    Trying {
        all: usize,
        now: String,
    },
    Tried(Box<Trial>),
    Done {
        stopped: bool,
    },
    Exported(Result<String, ExportError>),
}

/// What the thread works with.
struct Helper {
    model: Arc<Model>,
    /// The scene, where a solver of ours solves it.
    spec: Option<Spec>,
    /// What the session's solver offers.
    offers: Offers,
    /// What stops it, for who works elsewhere.
    stopping: Arc<AtomicBool>,
    /// Made when something is asked.
    stepper: Option<Stepper>,
    /// The problem that an attached solver told last beside the session, and of which state.
    posed: Option<(State, Posed)>,
    /// Whether the solver takes much memory.
    large: bool,
    /// Where the session's solver is asked for what it has at hand.
    lender: Lender,
}

/// The thread, and what it found.
#[derive(Debug)]
pub struct Background {
    asks: Sender<Ask>,
    told: Receiver<Told>,
    stop: Arc<AtomicBool>,
    /// Asked and not yet answered.
    waiting: usize,
    pushes: HashMap<(LinePlace, usize), Option<Vec<Push>>>,
    /// By place: the nodes that were asked for, and what was found.
    examinations: HashMap<LinePlace, (Vec<usize>, Option<Examination>)>,
    exported: Option<Result<String, ExportError>>,
    tried: Option<Tried>,
    trying: bool,
    /// Pages that are being made, or wait for it.
    examining: usize,
}

impl Background {
    /// Starts the idle thread.
    ///
    /// `spec` is the scene as its author wrote it, of which a finer mesh may be tried.
    /// `lender` takes looks at the session's own solver.
    pub fn new(model: Arc<Model>, spec: Spec, lender: Lender) -> Background {
        Background::begun(model, Some(spec), Offers::all(), lender)
    }

    /// The same beside a solver of another's, which alone knows what deforms.
    pub fn beside(model: Arc<Model>, offers: Offers, lender: Lender) -> Background {
        Background::begun(model, None, offers, lender)
    }

    fn begun(model: Arc<Model>, spec: Option<Spec>, offers: Offers, lender: Lender) -> Background {
        let (asks, orders) = channel::<Ask>();
        let (news, told) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let flag = stop.clone();
        thread::spawn(move || {
            let effort = Estimate::of(&model).with(model.settings.solver).0;
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
            while let Ok(ask) = orders.recv() {
                if helper.answer(ask, &news, &flag).is_none() {
                    return;
                }
                helper.rest();
            }
        });
        Background {
            asks,
            told,
            stop,
            waiting: 0,
            pushes: HashMap::new(),
            examinations: HashMap::new(),
            exported: None,
            tried: None,
            trying: false,
            examining: 0,
        }
    }

    /// Whether something is asked and not yet answered.
    pub fn is_busy(&self) -> bool {
        self.waiting > 0
    }

    /// What pushed a slave node at a place: `None` while it is not known; an inner `None` if it cannot be told.
    pub fn pushes(&self, place: LinePlace, slave: usize) -> Option<Option<&[Push]>> {
        let found = self.pushes.get(&(place, slave))?;
        Some(found.as_deref())
    }

    /// What is known of the problem at a place; an inner `None` while it is being found out.
    pub fn examination(&self, place: LinePlace) -> Option<Option<&Examination>> {
        Some(self.examinations.get(&place)?.1.as_ref())
    }

    /// The remedies that were tried last.
    pub fn tried(&self) -> Option<&Tried> {
        self.tried.as_ref()
    }

    /// Whether remedies are being tried.
    pub fn is_trying(&self) -> bool {
        self.trying
    }

    /// Whether a page is being made.
    pub fn is_examining(&self) -> bool {
        self.examining > 0
    }

    /// Asks what pushed a node. One question at a time: while another waits, this one may be asked again later.
    pub(super) fn ask_pushes(
        &mut self,
        place: LinePlace,
        slave: usize,
        between: impl FnOnce() -> Option<Between>,
    ) {
        if self.waiting == 0
            && !self.pushes.contains_key(&(place, slave))
            && let Some(between) = between()
        {
            self.send(Ask::Pushes(place, slave, between));
        }
    }

    /// Nobody but an attached solver knows what pushed a node.
    pub(super) fn pushes_untold(&mut self, place: LinePlace, slave: usize) {
        self.keep_pushes(place, slave, None);
    }

    fn keep_pushes(&mut self, place: LinePlace, slave: usize, found: Option<Vec<Push>>) {
        if self.pushes.len() >= KEPT {
            self.pushes.clear();
        }
        self.pushes.insert((place, slave), found);
    }

    /// Asks for the finding at a place, with the state there: of these nodes, or (none) of what matters.
    /// `told` is what the line tells already of an attached solver.
    pub(super) fn ask_examination(
        &mut self,
        place: LinePlace,
        state: &State,
        nodes: &[usize],
        told: Vec<String>,
    ) {
        let known = self.examinations.get(&place);
        if known.is_none_or(|(asked, _)| asked != nodes) {
            if self.examinations.len() >= KEPT {
                self.examinations.clear();
            }
            self.examinations.insert(place, (nodes.to_vec(), None));
            let state = Box::new(state.clone());
            self.stop.store(false, Ordering::Relaxed);
            self.examining += 1;
            self.send(Ask::Examination(place, state, nodes.to_vec(), told));
        }
    }

    /// Has a scene written.
    pub(super) fn ask_export(&mut self, export: Export) {
        self.send(Ask::Export(export));
    }

    /// What came of the scene that was written last; once.
    pub(super) fn exported(&mut self) -> Option<Result<String, ExportError>> {
        self.exported.take()
    }

    /// Tries all remedies from the state at a place.
    pub(super) fn ask_remedies(&mut self, place: LinePlace, state: &State) {
        self.stop.store(false, Ordering::Relaxed);
        self.tried = Some(Tried {
            place,
            all: None,
            now: String::new(),
            trials: Vec::new(),
            stopped: false,
        });
        self.trying = true;
        self.send(Ask::Remedies(Box::new(state.clone())));
    }

    /// Stops trying remedies, for the list or for a page, after the present minor iteration, and counting states.
    pub fn interrupt(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    fn send(&mut self, ask: Ask) {
        // A failing send means that the thread is gone; nothing is waited for then.
        if self.asks.send(ask).is_ok() {
            self.waiting += 1;
        }
    }

    /// Gathers what was found since the last call, never blocking. Returns whether there was anything.
    pub fn gather(&mut self) -> bool {
        let mut any = false;
        loop {
            match self.told.try_recv() {
                Ok(told) => self.take(told),
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

    /// Blocks until all that was asked is answered.
    pub fn wait(&mut self) {
        while self.waiting > 0 {
            match self.told.recv() {
                Ok(told) => self.take(told),
                Err(_) => self.gone(),
            }
        }
    }

    /// The thread is gone: nothing is waited for.
    fn gone(&mut self) {
        (self.waiting, self.trying, self.examining) = (0, false, 0);
    }

    fn take(&mut self, told: Told) {
        match told {
            Told::Pushes(place, slave, found) => {
                self.keep_pushes(place, slave, found);
                self.waiting -= 1;
            }
            Told::NotNow => self.waiting -= 1,
            Told::Examination {
                place,
                nodes,
                found,
                going_on,
            } => {
                // Something else may have been asked for in the meantime.
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
            Told::Exported(result) => {
                self.exported = Some(result);
                self.waiting -= 1;
            }
            Told::Trying { all, now } => {
                if let Some(tried) = &mut self.tried {
                    (tried.all, tried.now) = (Some(all), now);
                }
            }
            Told::Tried(trial) => {
                if let Some(tried) = &mut self.tried {
                    tried.trials.push(*trial);
                    remedies::sort(&mut tried.trials);
                }
            }
            Told::Done { stopped } => {
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
    /// Answers; `None` if nobody listens any more.
    fn answer(&mut self, ask: Ask, news: &Sender<Told>, stop: &AtomicBool) -> Option<()> {
        match ask {
            Ask::Pushes(place, slave, between) => {
                let found = match between {
                    Between::Way(way) => Some(self.pushes(slave, way)),
                    Between::Told(iterations) => {
                        let posed = self.posed_aside(&iterations.start);
                        posed.map(|posed| {
                            pushes_told::pushes(&self.model, &iterations, &posed.ok()?, slave)
                        })
                    }
                };
                let told = found.map_or(Told::NotNow, |found| Told::Pushes(place, slave, found));
                news.send(told).ok()
            }
            Ask::Examination(place, state, nodes, known) if self.spec.is_none() => {
                let found = self.examine_attached(&state, &nodes, known, stop);
                let found = (!stop.load(Ordering::Relaxed)).then(|| Box::new(found));
                news.send(Told::Examination {
                    place,
                    nodes,
                    found,
                    going_on: false,
                })
                .ok()
            }
            Ask::Examination(place, state, nodes, _) => {
                self.borrow(&state);
                let (stepper, spec) = self.solver();
                examine(stepper, spec, (place, &state, nodes), news, stop)
            }
            Ask::Export(ask) if self.spec.is_none() && is_of_problem(&ask) => {
                let done = self
                    .posed(&ask.state)
                    .map_err(ExportError::from)
                    .and_then(|posed| write_posed(&self.model, &posed, &ask));
                let told = done.map(|()| format!("wrote {}", ask.file.display()));
                news.send(Told::Exported(told)).ok()
            }
            Ask::Export(ask) => {
                let done = write(self.solver().0, &ask);
                let told = done.map(|()| format!("wrote {}", ask.file.display()));
                news.send(Told::Exported(told)).ok()
            }
            Ask::Remedies(state) if self.spec.is_none() => self.try_attached(&state, news, stop),
            Ask::Remedies(state) => {
                let (stepper, spec) = self.solver();
                try_remedies(stepper, spec, &state, news, stop)
            }
        }
    }

    /// Its own solver, and the scene as written.
    fn solver(&mut self) -> (&mut Stepper, Option<&Spec>) {
        let model = &self.model;
        let stepper = self.stepper.get_or_insert_with(|| solver(model.clone()));
        (stepper, self.spec.as_ref())
    }

    /// The interface problem that an attached solver tells of a state.
    fn posed(&self, state: &State) -> Result<Posed, Lost> {
        if !self.offers.problem {
            return Err(Lost::new(self.offers.lacks("its interface problem")));
        }
        let wanted = state.clone();
        let asked = self.lender.look(move |solver| solver.posed(&wanted));
        asked.unwrap_or_else(|| Err(Lost::new("the solver is at work; :census asks again")))
    }

    /// The same, and the solver stands afterwards where it stood; `None` where it is at work.
    fn posed_aside(&mut self, state: &State) -> Option<Result<Posed, Lost>> {
        if let Some((known, posed)) = &self.posed
            && known == state
        {
            return Some(Ok(posed.clone()));
        }
        let wanted = state.clone();
        let posed = self.lender.look(move |solver| {
            let stood = solver.state().clone();
            let posed = solver.posed(&wanted);
            // A solver that does not find back says so when it goes on.
            let _ = solver.restore(&stood);
            posed
        })?;
        if let Ok(posed) = &posed {
            self.posed = Some((state.clone(), posed.clone()));
        }
        Some(posed)
    }

    /// What is known of an attached solver's state: what its line tells, and what is found in its interface problem.
    fn examine_attached(
        &self,
        state: &State,
        nodes: &[usize],
        known: Vec<String>,
        stop: &AtomicBool,
    ) -> Examination {
        let stopped = || stop.load(Ordering::Relaxed);
        let mut found = match self.posed(state) {
            Ok(posed) => attached::examine(&self.model, state, &posed, nodes, &stopped),
            Err(lost) => Examination {
                lines: vec![format!(
                    "Nothing can be told of the frozen problem: {lost}."
                )],
                ..Examination::default()
            },
        };
        found.fails |= matches!(state.status, Status::Failed(_));
        let mut lines = known;
        let told: Vec<String> = match &found.census {
            Some(census) if self.offers.force => (1..=census.answers.len().min(2))
                .map(|n| format!("not tried: the consistent state {n} as a start: :start-from {n}, its modes are sent as forces"))
                .collect(),
            _ => Vec::new(),
        };
        let by_hand = self.offers.force && told.is_empty() && !lines.is_empty();
        if found.problem.is_some() {
            lines.push("Its interface problem, gone through by Table 2:".into());
        }
        // What the settings of our own method do is nothing that it offers.
        let offered = |line: &String| !line.starts_with("tried: settings.");
        lines.extend(found.lines.drain(..).filter(offered));
        lines.extend(told);
        if by_hand {
            lines.push("not tried: one of the nodes that change forced to another mode (m)".into());
        }
        found.lines = lines;
        found
    }

    /// Tries what an attached solver offers, on it.
    fn try_attached(&self, state: &State, news: &Sender<Told>, stop: &AtomicBool) -> Option<()> {
        let stopped = || stop.load(Ordering::Relaxed);
        let found = match self.posed(state) {
            Ok(posed) => attached::examine(&self.model, state, &posed, &[], &stopped),
            Err(_) => Examination::default(),
        };
        let all = remedies::offered(&self.model, state, &self.offers, &found);
        try_all(&all, news, |remedy| {
            let (remedy, state) = (remedy.clone(), state.clone());
            let stopping = self.stopping.clone();
            let tried = self.lender.look(move |solver| {
                let stopped = || stopping.load(Ordering::Relaxed);
                let tried = remedies::attempt(solver, &state, None, &remedy, &stopped);
                // Where the session stands, whatever came of the trial; a solver that does not find back says so when it goes on.
                let _ = solver.restore(&state);
                tried
            });
            tried.flatten().map(Some)
        })
    }

    /// What pushed a node: by the session's solver where that has the problem at hand, else by its own.
    fn pushes(&mut self, slave: usize, way: Way) -> Option<Vec<Push>> {
        let way = Arc::new(way);
        let theirs = way.clone();
        // Their solver goes the way alone; what takes time is found out here.
        let between = self.lender.look(move |solver| {
            let stepper = solver.stepper()?;
            let at_hand = stepper.condenses() && stepper.stands_for(&theirs.state);
            at_hand.then(|| between(stepper, &theirs))
        });
        match between.flatten() {
            Some(between) => pushed(&between?, slave),
            None => pushes(self.solver().0, slave, &way),
        }
    }

    /// Takes over the frozen problem of a state that the session's solver has at hand.
    fn borrow(&mut self, state: &State) {
        let wanted = state.clone();
        let lent = self
            .lender
            .look(move |solver| solver.stepper()?.lend(&wanted));
        if let Some(lent) = lent.flatten() {
            self.solver().0.borrow(lent);
        }
    }

    /// Nothing is asked for now.
    fn rest(&mut self) {
        if self.large {
            self.stepper = None;
        }
    }
}

/// Finds out what there is to say of a state: of these nodes, or (none) of what matters.
fn examine(
    stepper: &mut Stepper,
    spec: Option<&Spec>,
    (place, state, nodes): (LinePlace, &State, Vec<usize>),
    news: &Sender<Told>,
    stop: &AtomicBool,
) -> Option<()> {
    let stopped = || stop.load(Ordering::Relaxed);
    let send = |found: Option<Examination>, going_on: bool| {
        news.send(Told::Examination {
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
            &stopped,
            // That nobody listens any more shows at the end.
            &mut |part| drop(send(Some(part.clone()), true)),
        ),
        some => {
            let found = examine_nodes(stepper, state, some, &stopped);
            match stopped() {
                false => Some(found),
                true => {
                    drop(send(Some(found), true));
                    None
                }
            }
        }
    };
    send(found, false).ok()
}

/// Tries every way out of a state.
fn try_remedies(
    stepper: &mut Stepper,
    spec: Option<&Spec>,
    state: &State,
    news: &Sender<Told>,
    stop: &AtomicBool,
) -> Option<()> {
    let stopped = || stop.load(Ordering::Relaxed);
    let all = remedies::all(stepper, state, spec, &stopped);
    try_all(&all, news, |remedy| {
        let tried = remedies::attempt(stepper, state, spec, remedy, &stopped);
        (tried.is_some() || !stopped()).then_some(tried)
    })
}

/// Tries remedies until `attempt` gives none; where it gives an inner `None`, there was nothing to try.
fn try_all(
    all: &[Remedy],
    news: &Sender<Told>,
    mut attempt: impl FnMut(&Remedy) -> Option<Option<Trial>>,
) -> Option<()> {
    let mut stopped = false;
    for remedy in all {
        let (all, now) = (all.len(), remedy.label.clone());
        news.send(Told::Trying { all, now }).ok()?;
        match attempt(remedy) {
            Some(Some(trial)) => news.send(Told::Tried(Box::new(trial))).ok()?,
            Some(None) => {}
            None => {
                stopped = true;
                break;
            }
        }
    }
    news.send(Told::Done { stopped }).ok()
}
