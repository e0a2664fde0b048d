//! A solver under test.

use super::super::link::{Link, Start};
use super::super::started_solver::{StartedSolver, meet, other};
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use stickslip_core::Mode;
use stickslip_debugger::{Fault, Log};
use stickslip_exchange::attach::message::{ContactResult, EndedLevel, Hello, Id, Scene, State};
use stickslip_exchange::attach::{Answer, Request};

/// Time limit for optional repetitions within one check.
const BUDGET: Duration = Duration::from_secs(20);

/// A solver under test.
pub struct Trial {
    pub link: Link,
    pub hello: Hello,
    pub scene: Scene,
    /// Duration of its start.
    pub began: Duration,
    start: Start,
    log: Log,
    asks: Arc<AtomicUsize>,
    until: Instant,
    /// Contacts of the current state and of saved ones, which the next state may leave out.
    contacts: Vec<ContactResult>,
    saved: Vec<(Value, Vec<ContactResult>)>,
}

impl Trial {
    /// Starts the solver; the log records the messages.
    ///
    /// # Errors
    /// The fault that ended it.
    pub fn begin(start: &Start, log: &Log) -> Result<Trial, Fault> {
        let began = Instant::now();
        let asks = Arc::new(AtomicUsize::new(0));
        let StartedSolver {
            link, hello, scene, ..
        } = meet(start, log, &asks)?;
        Ok(Trial {
            link,
            hello,
            scene,
            began: began.elapsed(),
            start: start.clone(),
            log: log.clone(),
            asks,
            until: Instant::now() + BUDGET,
            contacts: Vec::new(),
            saved: Vec::new(),
        })
    }

    /// Restarts it; the time limit of the check is not reset.
    ///
    /// # Errors
    /// The fault that ended it.
    pub fn again(&mut self) -> Result<(), Fault> {
        let until = self.until;
        *self = Trial::begin(&self.start, &self.log)?;
        self.until = until;
        Ok(())
    }

    /// Whether the time limit of the check is exceeded.
    pub fn is_late(&self) -> bool {
        Instant::now() > self.until
    }

    /// Sends a request.
    ///
    /// # Errors
    /// The fault that ended the solver.
    pub fn ask(&mut self, request: &Request) -> Result<Answer, Fault> {
        self.link.ask(request, self.start.answer)
    }

    /// Sends a request whose answer is ok; the inner error is the reason of a refusal.
    ///
    /// # Errors
    /// The fault that ended the solver.
    pub fn order(&mut self, request: &Request) -> Result<Result<(), String>, Fault> {
        match self.ask(request)? {
            Answer::Ok => Ok(Ok(())),
            Answer::Refused { reason } => Ok(Err(reason)),
            answer => Err(other(request, answer, "ok")),
        }
    }

    /// Makes one iteration; `None` if it is refused.
    ///
    /// # Errors
    /// The fault that ended the solver.
    pub fn step(&mut self) -> Result<Option<State>, Fault> {
        match self.ask(&Request::Step)? {
            Answer::State(mut state) => {
                if self.hello.abilities.partial {
                    let ids: Vec<Id> = self
                        .scene
                        .contacts
                        .iter()
                        .map(|contact| contact.id.clone())
                        .collect();
                    let all = state.complete(&ids, &self.contacts);
                    self.contacts = all.map_err(|why| Fault::Unfit {
                        message: "state",
                        why,
                    })?;
                }
                state.fill_ids(self.scene.contacts.iter().map(|contact| &contact.id));
                Ok(Some(*state))
            }
            Answer::Refused { .. } => Ok(None),
            answer => Err(other(&Request::Step, answer, "state")),
        }
    }

    /// Makes up to `count` iterations.
    ///
    /// # Errors
    /// The fault that ended the solver.
    pub fn steps(&mut self, count: usize) -> Result<Vec<State>, Fault> {
        let mut states = Vec::new();
        for _ in 0..count {
            match self.step()? {
                Some(state) => states.push(state),
                None => break,
            }
            if states.last().is_some_and(is_last) {
                break;
            }
        }
        Ok(states)
    }

    /// Makes one iteration, and sends an interrupt during it.
    ///
    /// # Errors
    /// The fault that ended the solver.
    pub fn interrupted_step(&mut self) -> Result<Option<State>, Fault> {
        self.asks.store(1, Ordering::Relaxed);
        let state = self.step();
        self.asks.store(0, Ordering::Relaxed);
        state
    }

    /// Saves the current state: its token, or the reason of a refusal.
    ///
    /// # Errors
    /// The fault that ended the solver.
    pub fn save(&mut self) -> Result<Result<Value, String>, Fault> {
        match self.ask(&Request::Save)? {
            Answer::Saved { token } => {
                self.saved.push((token.clone(), self.contacts.clone()));
                Ok(Ok(token))
            }
            Answer::Refused { reason } => Ok(Err(reason)),
            answer => Err(other(&Request::Save, answer, "saved")),
        }
    }

    /// Restores a saved state; the inner error is the reason of a refusal.
    ///
    /// # Errors
    /// The fault that ended the solver.
    pub fn restore(&mut self, token: &Value) -> Result<Result<(), String>, Fault> {
        if let Some((_, contacts)) = self.saved.iter().find(|(known, _)| known == token) {
            self.contacts.clone_from(contacts);
        }
        let token = token.clone();
        self.order(&Request::Restore { token })
    }

    /// Forces a contact; the inner error is the reason of a refusal.
    ///
    /// # Errors
    /// The fault that ended the solver.
    pub fn force(
        &mut self,
        contact: &Id,
        mode: Mode,
        hold: bool,
    ) -> Result<Result<(), String>, Fault> {
        let contact = contact.clone();
        self.order(&Request::Force {
            contact,
            mode,
            hold,
        })
    }

    /// Sets a parameter; the inner error is the reason of a refusal.
    ///
    /// # Errors
    /// The fault that ended the solver.
    pub fn set(
        &mut self,
        name: &str,
        value: impl Into<Value>,
    ) -> Result<Result<(), String>, Fault> {
        self.order(&Request::Set {
            name: name.to_owned(),
            value: value.into(),
        })
    }

    /// At most `most` contacts, spread over the scene.
    pub fn some_contacts(&self, most: usize) -> Vec<Id> {
        let all = &self.scene.contacts;
        let count = all.len().min(most);
        let place = |k: usize| k * all.len() / count.max(1);
        (0..count).map(|k| all[place(k)].id.clone()).collect()
    }
}

/// Whether no regular state follows this one.
pub fn is_last(state: &State) -> bool {
    matches!(state.ended, EndedLevel::Done | EndedLevel::Failure)
}

/// The values of a contact in a state.
pub fn at<'a>(state: &'a State, contact: &Id) -> Option<&'a ContactResult> {
    state
        .contacts
        .iter()
        .find(|found| found.id.as_ref() == Some(contact))
}

/// Milliseconds.
pub fn millis(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}
