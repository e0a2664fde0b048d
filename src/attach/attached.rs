//! An attached solver: a child process that implements the core's solver trait.
//!
//! The solver stores its states. This module stores the tree of all states that it has reached: each is a node with its
//! predecessor, the interventions there, and the token to restore it, if the solver gave one. Going to a state restores the nearest
//! predecessor that is available (the start always is, by restarting the solver) and repeats the iterations from there, which must
//! give the same modes.

use super::link::{Link, Start, name};
use super::started_solver::{self, StartedSolver, meet};
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use stickslip_core::{
    Capabilities, Intervention, Mode, Model, Now, Position, ReportedProblem, Solver, SolverLost,
    State, StoredStates, counted,
};
use stickslip_debugger::explain::names;
use stickslip_debugger::recorded::decode::{self, RecordedStep, WireFrame};
use stickslip_debugger::recorded::interface_problem::read_problem;
use stickslip_debugger::recorded::orders::requests;
use stickslip_debugger::{Fault, Log};
use stickslip_exchange::attach::message::{self, ContactResult, EndedLevel, Hello, Id, Restore};
use stickslip_exchange::attach::{Answer, Request};
use stickslip_scene::{Scene, joined};

/// A solver in a child process.
pub struct Attached {
    start: Start,
    model: Arc<Model>,
    scene: message::Scene,
    ids: Vec<Id>,
    hello: Hello,
    offers: Capabilities,
    link: Option<Link>,
    log: Log,
    asks: Arc<AtomicUsize>,
    places: StoredStates<StoredState>,
    /// The tree node that the running solver is at, without interventions since; `None` if it is not known.
    at: Option<u64>,
    /// The current state, and the iteration that produced it.
    now: RecordedStep,
    /// Iterations repeated to reach the current node.
    again: usize,
    /// Whether the solver was restarted for that.
    anew: bool,
}

/// A state that the solver has reached: how to restore it, and how to verify a repeated iteration.
#[derive(Default)]
struct StoredState {
    /// Token to restore it.
    token: Option<serde_json::Value>,
    /// Position, outcome and modes of the iteration that produced it; `None` at the start.
    led: Option<(Position, EndedLevel, Vec<Mode>)>,
    /// Its contacts, if the next state may leave some out.
    contacts: Vec<ContactResult>,
}

/// A state with all contacts, and those that the next one may leave out.
struct ReportedState {
    state: message::State,
    contacts: Vec<ContactResult>,
}

impl StoredState {
    fn from_message(reported: ReportedState, position: Position) -> StoredState {
        let ReportedState { state, contacts } = reported;
        let next = state.contacts.iter().map(|found| found.next);
        StoredState {
            token: None,
            led: Some((position, state.ended, next.collect())),
            contacts,
        }
    }

    /// Whether an increment starts here.
    fn begins(&self) -> bool {
        self.led
            .as_ref()
            .is_none_or(|(_, ended, _)| matches!(ended, EndedLevel::Increment | EndedLevel::Done))
    }
}

impl Attached {
    /// Starts a solver, and reads its greeting and its scene.
    ///
    /// # Errors
    /// The [`Fault`] that ended it.
    pub fn attach(start: Start, log: Log) -> Result<(Scene, Attached), Fault> {
        Attached::with_cancel(start, log, Arc::default())
    }

    /// As [`Attached::attach`], with the counter of the user's requests to stop.
    ///
    /// # Errors
    /// The [`Fault`] that ended it.
    pub fn with_cancel(
        start: Start,
        log: Log,
        asks: Arc<AtomicUsize>,
    ) -> Result<(Scene, Attached), Fault> {
        let StartedSolver {
            link,
            hello,
            scene: message,
            offers,
        } = meet(&start, &log, &asks)?;
        let (scene, ids, now) = decode::start(&offers.name, &message, offers.begins_with())?;
        let mut attached = Attached {
            ids,
            now,
            start,
            model: Arc::new(scene.model.clone()),
            scene: message,
            hello,
            offers,
            link: Some(link),
            log,
            asks,
            places: StoredStates::new(StoredState::default()),
            at: Some(0),
            again: 0,
            anew: false,
        };
        attached.save(0)?;
        Ok((scene, attached))
    }

    /// Its greeting.
    pub fn hello(&self) -> &Hello {
        &self.hello
    }

    /// The log of its messages and output.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// Its command and time limits.
    pub fn start(&self) -> &Start {
        &self.start
    }

    /// Sends a request. A fault ends the solver.
    fn ask(&mut self, request: &Request) -> Result<Answer, Fault> {
        let Some(link) = &mut self.link else {
            return Err(Fault::Died {
                how: "before".into(),
                asked: name(request),
            });
        };
        let answer = link.ask(request, self.start.answer);
        if answer.is_err() {
            self.end();
        }
        answer
    }

    /// Sends a request whose answer is `ok`.
    fn order(&mut self, request: &Request) -> Result<(), Fault> {
        match self.ask(request)? {
            Answer::Ok => Ok(()),
            Answer::Refused { reason } => {
                // A part of the interventions may have been applied.
                self.at = None;
                Err(Fault::Refused {
                    asked: name(request),
                    why: reason,
                })
            }
            other => Err(self.other(request, other, "ok")),
        }
    }

    /// The fault for an answer of the wrong type.
    fn other(&mut self, request: &Request, answer: Answer, expected: &'static str) -> Fault {
        match answer {
            Answer::Refused { .. } => {}
            _ => self.end(),
        }
        started_solver::other(request, answer, expected)
    }

    /// Ends the child process.
    fn end(&mut self) {
        self.link = None;
        self.at = None;
        self.places.iter_mut().for_each(|kept| kept.token = None);
    }

    /// Brings the solver to the current state.
    fn go(&mut self) -> Result<(), Fault> {
        let target = self.place()?;
        if self.link.is_some() && self.at == Some(target) {
            return Ok(());
        }
        let reach = |place: &u64| {
            let here = self.at == Some(*place);
            let token = self
                .places
                .get(*place)
                .is_some_and(|kept| kept.token.is_some());
            self.link.is_some() && (here || token)
        };
        // Nodes to repeat, the last one first, and the node to start from.
        let again: Vec<u64> = self
            .places
            .back(target)
            .take_while(|place| !reach(place))
            .collect();
        let from = match again.last() {
            None => target,
            Some(&first) => match self.places.from(first) {
                Some((from, _)) => from,
                None => 0,
            },
        };
        if self.at != Some(from) || self.link.is_none() {
            match self.take_up(from) {
                // The solver has dropped this state; try an earlier one, at last the start.
                Err(Fault::Refused { .. }) if self.forget(from) => return self.go(),
                other => other?,
            }
        }
        let again = again.into_iter().filter(|&place| place != 0).rev();
        for place in again {
            self.do_again(place)?;
            self.again += 1;
        }
        Ok(())
    }

    /// Goes to a node without repeating iterations: restores it, or restarts the solver.
    fn take_up(&mut self, place: u64) -> Result<(), Fault> {
        let token = self.places.get(place).and_then(|kept| kept.token.clone());
        match token {
            Some(token) if self.link.is_some() => self.order(&Request::Restore { token })?,
            _ => {
                self.end();
                let met = meet(&self.start, &self.log, &self.asks)?;
                if let Some(what) = another(&self.scene, &self.hello, &met) {
                    return Err(Fault::OtherScene { what });
                }
                self.link = Some(met.link);
                self.anew = true;
                self.at = Some(0);
                self.save(0)?;
            }
        }
        self.at = Some(place);
        Ok(())
    }

    /// Drops a token; returns whether there was one.
    fn forget(&mut self, place: u64) -> bool {
        let kept = self.places.get_mut(place);
        let token = kept.and_then(|kept| kept.token.take());
        if token.is_some() {
            self.log
                .noted("restore was refused; its iterations are repeated");
        }
        token.is_some()
    }

    /// Repeats the iteration that leads to a node, from its predecessor.
    fn do_again(&mut self, place: u64) -> Result<(), Fault> {
        let (from, asked) = match self.places.from(place) {
            Some((from, asked)) => (from, asked.to_vec()),
            None => return Err(Fault::Unknown),
        };
        self.change(&asked)?;
        let reported = self.step_there(from)?;
        let position = self.frame().check(&reported.state)?;
        self.same(place, &StoredState::from_message(reported, position))?;
        self.at = Some(place);
        self.save(place)
    }

    /// Checks that a repeated iteration gives the same result.
    fn same(&self, place: u64, now: &StoredState) -> Result<(), Fault> {
        let then = self.places.get(place).ok_or(Fault::Unknown)?;
        match differs(then, now, &self.model) {
            None => Ok(()),
            Some(why) => Err(Fault::Changed {
                iteration: self.places.depth(place),
                why,
            }),
        }
    }

    /// Sends interventions to the solver.
    fn change(&mut self, asked: &[Intervention]) -> Result<(), Fault> {
        for request in asked
            .iter()
            .flat_map(|one| requests(one, &self.model.contacts, &self.ids, &self.offers))
            .collect::<Vec<_>>()
        {
            self.order(&request)?;
        }
        Ok(())
    }

    /// Makes one iteration from the solver's current state, which is that of a node.
    fn step_there(&mut self, from: u64) -> Result<ReportedState, Fault> {
        // Unknown until the answer is evaluated.
        self.at = None;
        match self.ask(&Request::Step)? {
            Answer::State(mut state) => {
                let before = self
                    .places
                    .get(from)
                    .filter(|_| self.hello.abilities.partial);
                let contacts = before
                    .map(|before| state.complete(&self.ids, &before.contacts))
                    .unwrap_or_else(|| Ok(Vec::new()))
                    .map_err(|why| Fault::Unfit {
                        message: "state",
                        why,
                    })?;
                let state = *state;
                Ok(ReportedState { state, contacts })
            }
            other => Err(self.other(&Request::Step, other, "state")),
        }
    }

    /// Saves the solver's state, if it offers that here.
    fn save(&mut self, place: u64) -> Result<(), Fault> {
        let kept = self.places.get(place).ok_or(Fault::Unknown)?;
        let wanted = match self.hello.abilities.restore {
            Restore::Any => true,
            Restore::Increment => kept.begins(),
            Restore::None => false,
        };
        if !wanted || kept.token.is_some() {
            return Ok(());
        }
        match self.ask(&Request::Save)? {
            Answer::Saved { token } => {
                if let Some(kept) = self.places.get_mut(place) {
                    kept.token = Some(token);
                }
                Ok(())
            }
            // The solver may be out of space; an earlier state can still be restored.
            Answer::Refused { reason } => {
                self.log.noted(&format!("save was refused: {reason}"));
                Ok(())
            }
            other => Err(self.other(&Request::Save, other, "saved")),
        }
    }

    /// The tree node of the current state.
    fn place(&self) -> Result<u64, Fault> {
        self.now
            .state
            .place()
            .filter(|place| self.places.get(*place).is_some())
            .ok_or(Fault::Unknown)
    }

    fn frame(&self) -> WireFrame<'_> {
        WireFrame {
            model: &self.model,
            ids: &self.ids,
            decides: self.hello.decides,
        }
    }

    /// Makes one iteration from the current state.
    fn iterate(&mut self) -> Result<(), Fault> {
        self.go()?;
        let (from, asked) = (self.place()?, self.now.state.changes().to_vec());
        self.change(&asked)?;
        let reported = self.step_there(from)?;
        let mut led = self
            .frame()
            .recorded_step(&self.now.state, &reported.state)?;
        let kept = StoredState::from_message(reported, led.event.position);
        let place = match self.places.follows(from, &asked) {
            Some(place) => {
                self.same(place, &kept)?;
                place
            }
            None => self.places.add(from, asked, kept),
        };
        led.state_at(place);
        self.at = Some(place);
        // If saving fails the solver is unusable, but this iteration is valid.
        if let Err(fault) = self.save(place) {
            self.log.noted(&fault.to_string());
        }
        self.now = led;
        Ok(())
    }

    /// Requests the frozen interface problem of the current state.
    fn ask_problem(&mut self) -> Result<ReportedProblem, Fault> {
        self.go()?;
        let asked = self.now.state.changes().to_vec();
        if !asked.is_empty() {
            // The interventions are part of the problem, so the solver is no longer at this node.
            self.change(&asked)?;
            self.at = None;
        }
        match self.ask(&Request::Problem)? {
            Answer::Problem(problem) => read_problem(&problem, &self.ids),
            other => Err(self.other(&Request::Problem, other, "problem")),
        }
    }
}

impl Solver for Attached {
    fn now(&self) -> Now<'_> {
        Now::new(&self.model, &self.now.state, &self.now.event)
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.now.state
    }

    fn advance(&mut self) -> Result<(), SolverLost> {
        self.iterate().map_err(|fault| {
            let lost = fault.to_string();
            self.log.noted(&lost);
            SolverLost::new(lost)
        })
    }

    fn restore(&mut self, state: &State) -> Result<(), SolverLost> {
        self.now.state.clone_from(state);
        match self.place() {
            Ok(_) => Ok(()),
            Err(fault) => Err(SolverLost::new(fault.to_string())),
        }
    }

    fn monitors(&mut self, out: &mut Vec<f64>) {
        out.extend_from_slice(&self.now.monitors);
    }

    fn capabilities(&self) -> Capabilities {
        self.offers.clone()
    }

    fn interface_problem(&mut self, state: &State) -> Result<ReportedProblem, SolverLost> {
        if !self.hello.abilities.problem {
            return Err(SolverLost::new(self.offers.lacks("its interface problem")));
        }
        self.restore(state)?;
        self.ask_problem()
            .map_err(|fault| SolverLost::new(fault.to_string()))
    }

    fn set_cancel(&mut self, asks: Arc<AtomicUsize>) {
        if let Some(link) = &mut self.link {
            link.set_cancel(asks.clone());
        }
        self.asks = asks;
    }

    fn take_notice(&mut self) -> Option<String> {
        let again = std::mem::take(&mut self.again);
        let lost = self.log.lost();
        let anew = std::mem::take(&mut self.anew);
        let iterations = counted(again, "iteration");
        let repeated = match (anew, again) {
            (true, 0) => Some("the solver was restarted".to_owned()),
            (true, _) => Some(format!(
                "the solver was restarted and repeated {iterations}"
            )),
            (false, 0) => None,
            (false, _) => Some(format!("the solver repeated {iterations}")),
        };
        let parts = joined(repeated.into_iter().chain(lost), "; ");
        (!parts.is_empty()).then_some(parts)
    }
}

/// The first difference to the greeting and scene of the first start.
fn another(first: &message::Scene, hello: &Hello, met: &StartedSolver) -> Option<&'static str> {
    let scene = &met.scene;
    let parts = [
        (hello.abilities == met.hello.abilities, "list of abilities"),
        (hello.decides == met.hello.decides, "decision rule"),
        (
            hello.parameters == met.hello.parameters,
            "set of parameters",
        ),
        (first.contacts == scene.contacts, "list of contacts"),
        (first.nodes == scene.nodes, "list of nodes"),
        (first == scene, "scene"),
    ];
    parts.iter().find(|(same, _)| !same).map(|(_, what)| *what)
}

/// The difference between a repeated iteration and the original; `None` if position, modes and outcome are the same.
fn differs(then: &StoredState, now: &StoredState, model: &Model) -> Option<String> {
    let ((was, ended, modes), (is, ends, now)) = then.led.as_ref().zip(now.led.as_ref())?;
    if was != is {
        let (is, was) = (names::position(*is), names::position(*was));
        return Some(format!("position {is} instead of {was}"));
    }
    let other = modes.iter().zip(now).position(|(then, now)| then != now);
    if let Some(k) = other {
        return Some(format!(
            "the next mode of {} is {} instead of {}",
            names::slave(model, k),
            now[k].word(),
            modes[k].word()
        ));
    }
    (ended != ends || modes.len() != now.len()).then(|| "the outcome differs".to_owned())
}
