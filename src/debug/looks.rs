//! Looking closer without disturbing: what needs solves of its own, made on a thread of its own beside the session's.
//!
//! - **Pushes**: what the changes of all nodes since the minor iteration before did to one node ([`influences`]). The
//!   thread goes over both iterations again and takes the frozen interface problem between them.
//! - **Findings**: the diagnosis of the cycle that the shown state runs into, or else the census of the frozen problem
//!   that is solved next from it.
//! - **Exports**: the frozen problem, or the core of its cycle, written as a scene of its own ([`export`]).
//! - **Remedies**: trials of every way out ([`remedies`]).
//!
//! Pushes and findings are kept by place (branch and step on its line), which never changes its meaning.

use crate::contact::state::ContactState;
use crate::debug::command::Exported;
use crate::debug::core::{core, cycle};
use crate::debug::diagnosis::{self, Cause, Diagnosis, MOST_NODES, cycling, started, too_many};
use crate::debug::export::{self, Origin};
use crate::debug::files;
use crate::debug::influence::{Influence, influences};
use crate::debug::remedies::{self, Trial};
use crate::debug::report;
use crate::debug::smaller::smaller;
use crate::interface::census::{Census, MOST, census};
use crate::interface::minor_history::Cycle;
use crate::interface::problem::InterfaceProblem;
use crate::model::{Mode, Model};
use crate::step::event::{Failure, Outcome};
use crate::step::intervene::{Intervention, Start};
use crate::step::state::{State, Status};
use crate::step::stepper::Stepper;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

/// Most entries that are kept of pushes, and of findings.
const KEPT: usize = 512;
const NOT_CONDENSED: &str =
    "The bodies cannot be condensed to the interface here, so there is no small problem to study.";

/// A place: branch, and step on its line.
pub type Place = (usize, usize);

/// What the change of one node did to the node that is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push {
    /// Slave number of the node that changed.
    pub slave: usize,
    /// Its modes in the iteration before and in this one.
    pub modes: [Mode; 2],
    pub influence: Influence,
}

/// What is known of the frozen problem at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// In words, most important first.
    pub lines: Vec<String>,
    /// Whether the minor iterations cycle from here.
    pub cycles: bool,
    /// The problem that the census was held over.
    pub problem: Option<InterfaceProblem>,
    pub census: Option<Census>,
}

impl Finding {
    /// The starts that lead to a consistent state of the census; none where there is no such state.
    pub fn starts(&self, number: usize) -> Option<Vec<Start>> {
        let started = started(self.problem.as_ref()?, self.census.as_ref()?, number)?;
        let start = |node: &crate::interface::problem::ProblemNode| Start {
            slave: node.slave,
            mode: node.state.mode,
            t_max: node.state.t_max,
        };
        Some(started.nodes.iter().map(start).collect())
    }
}

/// The remedies that were tried from a place, as far as they are.
#[derive(Debug, Clone)]
pub struct Tried {
    pub place: Place,
    /// How many there are to try; none until that is known.
    pub all: Option<usize>,
    /// The one that is being tried now.
    pub now: String,
    /// Done, in the order of [`remedies::sort`].
    pub trials: Vec<Trial>,
    /// Whether it was stopped before all were tried.
    pub stopped: bool,
}

/// How to come to the iteration that is looked at: from a state, by steps done before.
pub struct Way {
    pub state: Box<State>,
    /// Minor iterations (none) and interventions, up to the state that the shown iteration started from.
    pub steps: Vec<Option<Intervention>>,
    /// Which of the steps is the minor iteration before the shown one.
    pub before: usize,
}

/// A scene to be written of the problem that is frozen at a state.
pub struct Export {
    pub what: Exported,
    pub file: PathBuf,
    pub overwrite: bool,
    pub origin: Origin,
    pub state: Box<State>,
}

enum Ask {
    Pushes(Place, usize, Way),
    Finding(Place, Box<State>, Vec<usize>),
    Remedies(Box<State>),
    Export(Export),
}

enum Told {
    Pushes(Place, usize, Option<Vec<Push>>),
    Finding(Place, Vec<usize>, Box<Finding>),
    Trying { all: usize, now: String },
    Tried(Box<Trial>),
    Done { stopped: bool },
    Exported(Result<String, String>),
}

/// The thread, and what it found.
#[derive(Debug)]
pub struct Looks {
    asks: Sender<Ask>,
    told: Receiver<Told>,
    stop: Arc<AtomicBool>,
    /// Asked and not yet answered.
    waiting: usize,
    pushes: HashMap<(Place, usize), Option<Vec<Push>>>,
    /// By place: the nodes that were asked for, and what was found.
    findings: HashMap<Place, (Vec<usize>, Option<Finding>)>,
    exported: Option<Result<String, String>>,
    tried: Option<Tried>,
    trying: bool,
}

impl Looks {
    /// Starts the idle thread.
    pub fn new(model: Arc<Model>) -> Looks {
        let (asks, orders) = channel::<Ask>();
        let (news, told) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let flag = stop.clone();
        thread::spawn(move || {
            let mut stepper = None;
            while let Ok(ask) = orders.recv() {
                let stepper = stepper.get_or_insert_with(|| Stepper::new(model.clone()));
                if answer(stepper, ask, &news, &flag).is_none() {
                    return;
                }
            }
        });
        Looks {
            asks,
            told,
            stop,
            waiting: 0,
            pushes: HashMap::new(),
            findings: HashMap::new(),
            exported: None,
            tried: None,
            trying: false,
        }
    }

    /// Whether something is asked and not yet answered.
    pub fn is_busy(&self) -> bool {
        self.waiting > 0
    }

    /// What pushed a slave node at a place: none while it is not known; an inner none where it cannot be told.
    pub fn pushes(&self, place: Place, slave: usize) -> Option<Option<&[Push]>> {
        let found = self.pushes.get(&(place, slave))?;
        Some(found.as_deref())
    }

    /// What is known of the problem at a place; an inner none while it is being found out.
    pub fn finding(&self, place: Place) -> Option<Option<&Finding>> {
        Some(self.findings.get(&place)?.1.as_ref())
    }

    /// The remedies that were tried last.
    pub fn tried(&self) -> Option<&Tried> {
        self.tried.as_ref()
    }

    /// Whether remedies are being tried.
    pub fn is_trying(&self) -> bool {
        self.trying
    }

    /// Asks what pushed a node. One question at a time: while another waits, this one may be asked again later.
    pub(super) fn ask_pushes(&mut self, place: Place, slave: usize, way: impl FnOnce() -> Way) {
        if self.waiting == 0 && !self.pushes.contains_key(&(place, slave)) {
            self.send(Ask::Pushes(place, slave, way()));
        }
    }

    /// Asks for the finding at a place, with the state there: of these nodes, or (none) of what matters.
    pub(super) fn ask_finding(&mut self, place: Place, state: &State, nodes: &[usize]) {
        let known = self.findings.get(&place);
        if known.is_none_or(|(asked, _)| asked != nodes) {
            if self.findings.len() >= KEPT {
                self.findings.clear();
            }
            self.findings.insert(place, (nodes.to_vec(), None));
            let state = Box::new(state.clone());
            self.send(Ask::Finding(place, state, nodes.to_vec()));
        }
    }

    /// Has a scene written.
    pub(super) fn ask_export(&mut self, export: Export) {
        self.send(Ask::Export(export));
    }

    /// What came of the scene that was written last; once.
    pub(super) fn exported(&mut self) -> Option<Result<String, String>> {
        self.exported.take()
    }

    /// Tries all remedies from the state at a place.
    pub(super) fn ask_remedies(&mut self, place: Place, state: &State) {
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

    /// Stops trying remedies after the present minor iteration.
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
                    (self.waiting, self.trying) = (0, false);
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
                Err(_) => (self.waiting, self.trying) = (0, false),
            }
        }
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
            Told::Finding(place, nodes, found) => {
                // Something else may have been asked for in the meantime.
                if let Some(kept) = self.findings.get_mut(&place)
                    && kept.0 == nodes
                {
                    kept.1 = Some(*found);
                }
                self.waiting -= 1;
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

impl Drop for Looks {
    fn drop(&mut self) {
        self.interrupt();
    }
}

/// Answers on the thread; none if nobody listens any more.
fn answer(stepper: &mut Stepper, ask: Ask, news: &Sender<Told>, stop: &AtomicBool) -> Option<()> {
    match ask {
        Ask::Pushes(place, slave, way) => {
            let found = pushes(stepper, slave, &way);
            news.send(Told::Pushes(place, slave, found)).ok()
        }
        Ask::Finding(place, state, nodes) => {
            let found = Box::new(match nodes.as_slice() {
                [] => finding(stepper, &state),
                some => census_of(stepper, &state, some),
            });
            news.send(Told::Finding(place, nodes, found)).ok()
        }
        Ask::Export(ask) => {
            let done = write(stepper, &ask).map(|()| format!("wrote {}", ask.file.display()));
            news.send(Told::Exported(done)).ok()
        }
        Ask::Remedies(state) => {
            let all = remedies::all(stepper, &state);
            let mut stopped = false;
            for remedy in &all {
                let now = remedy.label.clone();
                news.send(Told::Trying {
                    all: all.len(),
                    now,
                })
                .ok()?;
                match remedies::attempt(stepper, &state, remedy, &|| stop.load(Ordering::Relaxed)) {
                    Some(trial) => news.send(Told::Tried(Box::new(trial))).ok()?,
                    None => {
                        stopped = true;
                        break;
                    }
                }
            }
            news.send(Told::Done { stopped }).ok()
        }
    }
}

/// What pushed a node in the iteration that comes after the way; none where that cannot be told.
fn pushes(stepper: &mut Stepper, slave: usize, way: &Way) -> Option<Vec<Push>> {
    stepper.restore(&way.state);
    let mut before: Vec<ContactState> = Vec::new();
    for (place, step) in way.steps.iter().enumerate() {
        if place == way.before {
            before.clone_from(&stepper.state().nodes);
        }
        match step {
            Some(intervention) => stepper.intervene(intervention).ok()?,
            None => {
                stepper.step()?;
            }
        }
    }
    let problem = stepper.interface_problem()?;
    let after = problem.states();
    let target = problem.nodes.iter().position(|node| node.slave == slave)?;
    let of = |node: usize| problem.nodes[node].slave;
    let found = influences(&problem, &pick(&problem, &before), &after, &[target])?;
    let push = |influence: Influence| Push {
        slave: of(influence.from),
        modes: [before[of(influence.from)].mode, after[influence.from].mode],
        influence,
    };
    Some(found.into_iter().flatten().map(push).collect())
}

/// States of a problem's nodes among those of all slave nodes.
fn pick(problem: &InterfaceProblem, nodes: &[ContactState]) -> Vec<ContactState> {
    problem.nodes.iter().map(|node| nodes[node.slave]).collect()
}

fn nothing(why: &str) -> Finding {
    Finding {
        lines: vec![why.into()],
        cycles: false,
        problem: None,
        census: None,
    }
}

/// Diagnosis or census at a state.
pub fn finding(stepper: &mut Stepper, state: &State) -> Finding {
    if state.status == Status::Finished {
        return nothing("The history is done; nothing is solved next from here.");
    }
    stepper.restore(state);
    let Some(problem) = stepper.interface_problem() else {
        return nothing(NOT_CONDENSED);
    };
    let round = match going_round(stepper, state, &problem) {
        Err(why) => return nothing(&why.to_string()),
        Ok(round) => round,
    };
    let model = stepper.model();
    if let Some((problem, _)) = round
        && let Some(diagnosis) = Diagnosis::of(&problem)
    {
        let mut lines = diagnosis::words(model, &problem, &diagnosis);
        if diagnosis.cause == Cause::NoAnswer {
            lines.extend(smaller(stepper, state).map(|found| found.words()));
        }
        return Finding {
            lines,
            cycles: true,
            problem: Some(diagnosis.problem),
            census: diagnosis.census,
        };
    }
    let undecided = diagnosis::undecided(&problem);
    if undecided.len() > MOST {
        return nothing(&format!(
            "The minor iterations do not cycle from here. A census is held over at most {MOST} slave nodes, and {} can touch.",
            undecided.len()
        ));
    }
    let Some(studied) = problem.reduced(&undecided) else {
        return nothing("The frozen interface problem is singular here.");
    };
    counted(
        model,
        &studied,
        "The minor iterations do not cycle from here.",
    )
}

/// Census of these slave nodes at a state, all others going on with what they do.
fn census_of(stepper: &mut Stepper, state: &State, slaves: &[usize]) -> Finding {
    if state.status == Status::Finished {
        return nothing("The history is done; nothing is solved next from here.");
    }
    stepper.restore(state);
    let Some(problem) = stepper.interface_problem() else {
        return nothing(NOT_CONDENSED);
    };
    let wanted = |place: &usize| slaves.contains(&problem.nodes[*place].slave);
    let places: Vec<usize> = (0..problem.nodes.len()).filter(wanted).collect();
    let Some(studied) = problem.reduced(&places) else {
        return nothing("With what all other nodes do, the frozen interface problem is singular.");
    };
    let model = stepper.model();
    let names = slaves.iter().map(|&slave| report::slave(model, slave));
    let names = names.collect::<Vec<_>>().join(", ");
    let head = format!("Of {names}, all other nodes going on with what they do:");
    counted(model, &studied, &head)
}

/// What a census finds.
fn counted(model: &Model, studied: &InterfaceProblem, head: &str) -> Finding {
    let census = match census(studied) {
        Err(why) => return nothing(&why.to_string()),
        Ok(census) => census,
    };
    let name = |place: usize| report::slave(model, studied.nodes[place].slave);
    let mut lines = vec![head.to_owned()];
    lines.extend(diagnosis::census_words(&census, &name));
    Finding {
        lines,
        cycles: false,
        census: Some(census),
        problem: Some(studied.clone()),
    }
}

/// The problem that goes round in a cycle from a state that the stepper stands at, and the cycle by slave number; none
/// where there is no cycle. A large problem is stepped on to its cycle, so that only those nodes are looked at that take
/// part.
///
/// # Errors
/// Why that cannot be told.
fn going_round(
    stepper: &mut Stepper,
    state: &State,
    problem: &InterfaceProblem,
) -> Result<Option<(InterfaceProblem, Cycle)>, String> {
    let by_slave = |cycle: Cycle| Cycle {
        members: cycle
            .members
            .into_iter()
            .map(|(place, modes)| (problem.nodes[place].slave, modes))
            .collect(),
        ..cycle
    };
    if problem.nodes.len() <= MOST_NODES {
        return Ok(cycle(problem).map(|cycle| (problem.clone(), by_slave(cycle))));
    }
    let known = match &state.status {
        Status::Failed(Failure::Cycle(cycle)) => Some(cycle.clone()),
        _ => step_to_cycle(stepper),
    };
    let Some(cycle) = known else {
        return Ok(None);
    };
    let problem = stepper.interface_problem().ok_or(NOT_CONDENSED)?;
    match cycling(problem, &cycle) {
        Some(problem) => Ok(Some((problem, cycle))),
        None => Err(too_many(&cycle)),
    }
}

fn step_to_cycle(stepper: &mut Stepper) -> Option<Cycle> {
    while let Some(event) = stepper.step() {
        match &event.outcome {
            Outcome::Minor => {}
            Outcome::Failed(Failure::Cycle(cycle)) => return Some(cycle.clone()),
            _ => return None,
        }
    }
    None
}

/// Writes a core, or a whole problem, as a scene.
fn write(stepper: &mut Stepper, ask: &Export) -> Result<(), String> {
    if ask.state.status == Status::Finished {
        return Err("the history is done; nothing is solved next from here".into());
    }
    stepper.restore(&ask.state);
    let problem = stepper.interface_problem().ok_or(NOT_CONDENSED)?;
    let text = match ask.what {
        Exported::Whole => export::whole(stepper.model(), &ask.origin, &problem)?,
        Exported::Core => {
            let (problem, cycle) = going_round(stepper, &ask.state, &problem)?
                .ok_or("the minor iterations do not cycle from here, so there is no core")?;
            let core = core(&problem).ok_or_else(|| too_many(&cycle))?;
            export::core(stepper.model(), &ask.origin, &cycle, &core)?
        }
    };
    files::write(&ask.file, &text, ask.overwrite).map_err(|e| e.to_string())
}
