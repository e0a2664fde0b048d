//! Looking closer without disturbing: what needs solves of its own, made on a thread of its own beside the session's.
//!
//! - **Pushes**: what the changes of all nodes since the minor iteration before did to one node ([`pushes`]). The
//!   thread goes over both iterations again and takes the frozen interface problem between them.
//! - **Findings**: the diagnosis of the cycle that the shown state runs into, or else the census of the frozen problem
//!   that is solved next from it.
//! - **Exports**: files of a state: pictures, the frozen problem, the core of its cycle ([`export`]).
//! - **Remedies**: trials of every way out ([`remedies`]).
//!
//! The thread has a solver of its own, of the session's scene. Where the session's solver has the frozen problem at hand, it lends
//! it, so that nothing is factored twice; a large solver is dropped when nothing is asked, so that the session takes no more
//! memory than a run.
//!
//! Pushes and examinations are kept by place (branch and step on its line), which never changes its meaning.

use super::worker::Lender;
use crate::explain::core::core;
use crate::explain::diagnosis::too_many;
use crate::explain::examination::{Examination, NOT_CONDENSED, Untold, examine_nodes, going_round};
use crate::explain::influence::{Push, Way, between, pushed, pushes};
use crate::explain::page::page;
use crate::explain::remedies::{self, Trial};
use crate::explain::report;
use crate::format::spec::Spec;
use crate::history::strip::Strip;
use crate::linear::estimate::Estimate;
use crate::model::Model;
use crate::outside::files::{self, FileError};
use crate::record::command::Exported;
use crate::record::export::shown::{NotMade, Shown};
use crate::record::export::{self, Kind, NoExport, Origin, UnknownKind};
use crate::scene::Scene;
use crate::scene::solver::solver;
use crate::step::event::Event;
use crate::step::state::{State, Status};
use crate::step::stepper::Stepper;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

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

/// A file to be made of a state.
pub struct Export {
    /// What is written.
    pub what: Exported,
    /// Where to.
    pub file: PathBuf,
    /// Whether a file of that name may be overwritten.
    pub overwrite: bool,
    /// What the file says of where it comes from.
    pub origin: Origin,
    /// The shown state.
    pub state: Box<State>,
    /// What a picture shows of it besides.
    pub shown: Option<Box<Seen>>,
}

/// What there is to be seen of a state.
pub struct Seen {
    /// The scene that led there.
    pub scene: Scene,
    /// The last minor iteration.
    pub event: Option<Arc<Event>>,
    /// The last ones.
    pub strips: Vec<Strip>,
    /// The state in which the last major iteration began, if it is known.
    pub last_major: Option<State>,
}

/// Why no scene was written.
#[derive(Debug, thiserror::Error)]
pub enum NotWritten {
    /// The history is done.
    #[error("the history is done; nothing is solved next from here")]
    Finished,
    /// The bodies cannot be condensed to the interface here.
    #[error("{NOT_CONDENSED}")]
    NotCondensed,
    /// The minor iterations do not cycle here.
    #[error("the minor iterations do not cycle from here, so there is no core")]
    NoCycle,
    /// Too many nodes take part; the words say how many.
    #[error("{0}")]
    TooMany(String),
    /// What is to be written could not be found out.
    #[error(transparent)]
    Untold(#[from] Untold),
    /// No file can say what the problem says.
    #[error(transparent)]
    NoExport(#[from] NoExport),
    /// No file of that kind can be made of the state.
    #[error(transparent)]
    NotMade(#[from] NotMade),
    /// The extension is none that is known.
    #[error(transparent)]
    UnknownKind(#[from] UnknownKind),
    /// The kind is made of a journal.
    #[error(
        "a .cast is made of a journal; `stickslip export JOURNAL -o FILE` does it, and :journal tells where it is"
    )]
    OfJournal,
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}

enum Ask {
    Pushes(LinePlace, usize, Way),
    Examination(LinePlace, Box<State>, Vec<usize>),
    Remedies(Box<State>),
    Export(Export),
}

enum Told {
    Pushes(LinePlace, usize, Option<Vec<Push>>),
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
    Exported(Result<String, NotWritten>),
}

/// What the thread works with.
struct Helper {
    model: Arc<Model>,
    spec: Spec,
    /// Made when something is asked.
    stepper: Option<Stepper>,
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
    exported: Option<Result<String, NotWritten>>,
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
                stepper: None,
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
    pub(super) fn ask_pushes(&mut self, place: LinePlace, slave: usize, way: impl FnOnce() -> Way) {
        if self.waiting == 0 && !self.pushes.contains_key(&(place, slave)) {
            self.send(Ask::Pushes(place, slave, way()));
        }
    }

    /// Asks for the finding at a place, with the state there: of these nodes, or (none) of what matters.
    pub(super) fn ask_examination(&mut self, place: LinePlace, state: &State, nodes: &[usize]) {
        let known = self.examinations.get(&place);
        if known.is_none_or(|(asked, _)| asked != nodes) {
            if self.examinations.len() >= KEPT {
                self.examinations.clear();
            }
            self.examinations.insert(place, (nodes.to_vec(), None));
            let state = Box::new(state.clone());
            self.stop.store(false, Ordering::Relaxed);
            self.examining += 1;
            self.send(Ask::Examination(place, state, nodes.to_vec()));
        }
    }

    /// Has a scene written.
    pub(super) fn ask_export(&mut self, export: Export) {
        self.send(Ask::Export(export));
    }

    /// What came of the scene that was written last; once.
    pub(super) fn exported(&mut self) -> Option<Result<String, NotWritten>> {
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
                if self.pushes.len() >= KEPT {
                    self.pushes.clear();
                }
                self.pushes.insert((place, slave), found);
                self.waiting -= 1;
            }
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
            Ask::Pushes(place, slave, way) => {
                let found = self.pushes(slave, way);
                news.send(Told::Pushes(place, slave, found)).ok()
            }
            Ask::Examination(place, state, nodes) => {
                self.borrow(&state);
                let (stepper, spec) = self.solver();
                examine(stepper, spec, (place, &state, nodes), news, stop)
            }
            Ask::Export(ask) => {
                let done = write(self.solver().0, &ask);
                let told = done.map(|()| format!("wrote {}", ask.file.display()));
                news.send(Told::Exported(told)).ok()
            }
            Ask::Remedies(state) => try_remedies(self.solver().0, &state, news, stop),
        }
    }

    /// Its own solver, and the scene as written.
    fn solver(&mut self) -> (&mut Stepper, &Spec) {
        let model = &self.model;
        let stepper = self.stepper.get_or_insert_with(|| solver(model.clone()));
        (stepper, &self.spec)
    }

    /// What pushed a node: by the session's solver where that has the problem at hand, else by its own.
    fn pushes(&mut self, slave: usize, way: Way) -> Option<Vec<Push>> {
        let way = Arc::new(way);
        let theirs = way.clone();
        // Their solver goes the way alone; what takes time is found out here.
        let between = self.lender.look(move |stepper| {
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
        let lent = self.lender.look(move |stepper| stepper.lend(&wanted));
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
    spec: &Spec,
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
            Some(spec),
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
    state: &State,
    news: &Sender<Told>,
    stop: &AtomicBool,
) -> Option<()> {
    let stopped = || stop.load(Ordering::Relaxed);
    let all = remedies::all(stepper, state, &stopped);
    let mut ended = false;
    for remedy in &all {
        let now = remedy.label.clone();
        news.send(Told::Trying {
            all: all.len(),
            now,
        })
        .ok()?;
        match remedies::attempt(stepper, state, remedy, &stopped) {
            Some(trial) => news.send(Told::Tried(Box::new(trial))).ok()?,
            None => {
                ended = true;
                break;
            }
        }
    }
    news.send(Told::Done { stopped: ended }).ok()
}

/// Makes a file of a state.
fn write(stepper: &mut Stepper, ask: &Export) -> Result<(), NotWritten> {
    let bytes = match ask.what {
        Exported::Core => {
            let text = core_of(stepper, ask)?;
            return Ok(files::write(&ask.file, text, ask.overwrite)?);
        }
        // Any name will do for it, as it always did.
        Exported::Whole => match export::kind(&ask.file) {
            Ok(kind) if kind.may_be_frozen => shown(stepper, ask, kind)?,
            _ => shown(stepper, ask, export::kind(Path::new("a.ron"))?)?,
        },
        Exported::Shown => shown(stepper, ask, export::kind(&ask.file)?)?,
    };
    let kind = export::kind(&ask.file).ok();
    let names = match kind.filter(|_| bytes.len() > 1) {
        Some(kind) => kind.files(&ask.file).map_err(NotMade::NoFile)?,
        None => vec![ask.file.clone()],
    };
    let whole: Vec<_> = names.into_iter().zip(bytes).collect();
    Ok(files::write_all(&whole, ask.overwrite)?)
}

/// The scene of the core of the cycle that a state runs into.
fn core_of(stepper: &mut Stepper, ask: &Export) -> Result<String, NotWritten> {
    if ask.state.status == Status::Finished {
        return Err(NotWritten::Finished);
    }
    stepper.restore(&ask.state);
    let problem = stepper
        .interface_problem()
        .ok_or(NotWritten::NotCondensed)?;
    let (problem, cycle) =
        going_round(stepper, &ask.state, &problem)?.ok_or(NotWritten::NoCycle)?;
    let core = core(&problem).ok_or_else(|| NotWritten::TooMany(too_many(&cycle)))?;
    Ok(export::core(stepper.model(), &ask.origin, &cycle, &core)?)
}

/// What is in the files of a kind.
fn shown(stepper: &mut Stepper, ask: &Export, kind: &Kind) -> Result<Vec<Vec<u8>>, NotWritten> {
    let Some(seen) = &ask.shown else {
        return Err(NotWritten::Finished);
    };
    let ended = match &ask.state.status {
        Status::Failed(failure) => report::describe_failure(stepper.model(), failure),
        _ => String::new(),
    };
    let shown = Shown {
        scene: &seen.scene,
        origin: &ask.origin,
        state: &ask.state,
        event: seen.event.as_deref(),
        strips: &seen.strips,
        last_major: seen.last_major.as_ref(),
        ended,
        frozen: ask.what == Exported::Whole,
    };
    let made = kind.made(&shown, stepper).ok_or(NotWritten::OfJournal)?;
    Ok(made?)
}
