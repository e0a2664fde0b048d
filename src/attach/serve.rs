//! `stickslip serve SCENE`: stickslip's own solver as an attachable program.
//!
//! A debugger attached to it shows bit-identical results to those of the scene itself.

use super::wire;
use serde_json::Value;
use std::io::{self, BufRead, Write};
use std::sync::Arc;
use stickslip_core::{Intervention, ReportedForm, State, Stepper};
use stickslip_debugger::record::export::frozen;
use stickslip_debugger::recorded::orders::{self, COHESION, FRICTION, INCREMENT};
use stickslip_exchange::attach::message::{
    Abilities, Hello, Id, MatrixMessage, ParameterKind, ParameterMessage, ProblemMessage, Restore,
};
use stickslip_exchange::attach::{Answer, Line, LineReader, MOST_BYTES, PROTOCOLS, Request};
use stickslip_scene::Scene;
use stickslip_scene::format::error::{quoted, shortened};
use stickslip_scene::format::paths;
use stickslip_scene::solver::solver;

/// Answers requests line by line until the input ends.
///
/// # Errors
/// If the streams cannot be read or written; of kind `InvalidData` if the input ends within a line, or a line is too long.
pub fn serve(scene: &Scene, from: impl BufRead, mut to: impl Write) -> io::Result<()> {
    let mut server = Server::new(scene);
    let mut lines = LineReader::new(from, MOST_BYTES);
    loop {
        let request = match lines.next_line()? {
            Line::Text(text) => Request::read(&text).map_err(|broken| broken.to_string()),
            Line::NoText(_) => Err("not UTF-8".to_owned()),
            Line::End => return Ok(()),
            Line::Torn(_) => return Err(unusable("the input ends within a request")),
            Line::TooLong(_) => return Err(unusable("a request is longer than 64 MiB")),
        };
        let answer = match request {
            Ok(Request::Bye) => return Ok(()),
            Ok(Request::Interrupt) => continue,
            Ok(request) => server.answer(&request),
            Err(why) => refused(format!("invalid request: {why}")),
        };
        to.write_all(answer.line().as_bytes())?;
        to.flush()?;
    }
}

/// The error of an input that cannot be read further.
fn unusable(why: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, why)
}

fn refused(reason: impl Into<String>) -> Answer {
    let reason = reason.into();
    Answer::Refused { reason }
}

struct Server<'a> {
    scene: &'a Scene,
    stepper: Stepper,
    saved: Vec<State>,
}

impl<'a> Server<'a> {
    fn new(scene: &'a Scene) -> Self {
        Server {
            scene,
            stepper: solver(Arc::new(scene.model.clone())),
            saved: Vec::new(),
        }
    }

    fn answer(&mut self, request: &Request) -> Answer {
        match request {
            Request::Hello { .. } => Answer::Hello(Box::new(self.hello())),
            Request::Scene => Answer::Scene(Box::new(wire::scene(&self.scene.model))),
            Request::Step => self.step(),
            Request::Force {
                contact,
                mode,
                hold,
            } => self.on_contact(contact, |slave| Intervention::Force {
                slave,
                mode: *mode,
                hold: *hold,
            }),
            Request::Release { contact } => {
                self.on_contact(contact, |slave| Intervention::Release { slave })
            }
            Request::Set { name, value } => match self.setting(name, value) {
                Ok(intervention) => self.intervene(&intervention),
                Err(why) => refused(why),
            },
            Request::Save => {
                self.saved.push(self.stepper.state().clone());
                Answer::Saved {
                    token: Value::from(self.saved.len() - 1),
                }
            }
            Request::Restore { token } => {
                let place = token.as_u64().and_then(|place| usize::try_from(place).ok());
                match place.and_then(|place| self.saved.get(place)) {
                    Some(state) => {
                        self.stepper.restore(state);
                        Answer::Ok
                    }
                    None => refused(format!("no saved state {}", shortened(&token.to_string()))),
                }
            }
            Request::Problem => self.problem(),
            Request::Interrupt | Request::Bye => Answer::Ok,
        }
    }

    fn hello(&self) -> Hello {
        Hello {
            protocol: PROTOCOLS[0],
            protocols: PROTOCOLS.to_vec(),
            name: format!("stickslip {}", self.scene.name),
            version: env!("CARGO_PKG_VERSION").into(),
            abilities: Abilities {
                force: true,
                hold: true,
                restore: Restore::Any,
                problem: true,
                interrupt: false,
                partial: false,
            },
            decides: None,
            parameters: parameters(self.scene),
        }
    }

    fn step(&mut self) -> Answer {
        if self.stepper.step().is_none() {
            return refused("the history is complete");
        }
        let mut monitors = Vec::new();
        let event = self.stepper.event();
        if event.outcome.is_accepted() {
            self.stepper.monitors(&mut monitors);
        }
        let (state, event) = (self.stepper.state(), self.stepper.event());
        let state = wire::state(self.stepper.model(), state, event, &monitors);
        Answer::State(Box::new(state))
    }

    fn on_contact(&mut self, id: &Id, what: impl FnOnce(usize) -> Intervention) -> Answer {
        match wire::contact(id, self.stepper.model()) {
            Some(slave) => self.intervene(&what(slave)),
            None => refused(format!("no contact {}", shortened(&id.to_string()))),
        }
    }

    fn intervene(&mut self, intervention: &Intervention) -> Answer {
        match self.stepper.intervene(intervention) {
            Ok(()) => Answer::Ok,
            Err(why) => refused(why.to_string()),
        }
    }

    /// The intervention for a parameter's new value.
    fn setting(&self, name: &str, value: &Value) -> Result<Intervention, String> {
        let controls = &self.stepper.state().controls;
        match name {
            INCREMENT | FRICTION | COHESION => {
                if value.is_number() {
                    let contacts = &self.stepper.model().contacts;
                    Ok(orders::set(name, value, &controls.friction, contacts))
                } else {
                    let value = shortened(&value.to_string());
                    Err(format!("{name} must be a number, not {value}"))
                }
            }
            path if path.starts_with("settings.") => {
                let mut spec = self.scene.spec.clone();
                spec.settings = controls.settings;
                let word = match (value, value.as_f64()) {
                    (Value::String(text), _) => text.clone(),
                    // Formats a whole number without a decimal point.
                    (_, Some(number)) => number.to_string(),
                    (other, None) => other.to_string(),
                };
                paths::set(&mut spec, path, &word).map_err(|why| why.to_string())?;
                Ok(Intervention::Settings(spec.settings))
            }
            _ => Err(format!("no parameter {}", quoted(name))),
        }
    }

    fn problem(&mut self) -> Answer {
        let Some(problem) = self.stepper.interface_problem() else {
            return refused("the bodies cannot be condensed to the interface here");
        };
        match frozen::total(self.stepper.model(), &problem) {
            Ok(total) => {
                let friction = &self.stepper.state().controls.friction;
                let of = |&slave: &usize| friction[slave];
                Answer::Problem(Box::new(ProblemMessage {
                    tangents: 1,
                    contacts: total.slaves.iter().map(|&slave| wire::id(slave)).collect(),
                    kind: ReportedForm::Compliance,
                    matrix: MatrixMessage::Rows(total.w),
                    q: total.q,
                    load: Vec::new(),
                    mu: total
                        .slaves
                        .iter()
                        .map(|slave| of(slave).coefficient())
                        .collect(),
                    cohesion: total
                        .slaves
                        .iter()
                        .map(|slave| of(slave).cohesion)
                        .collect(),
                }))
            }
            Err(why) => refused(why.to_string()),
        }
    }
}

/// The parameters that can be changed during a run.
fn parameters(scene: &Scene) -> Vec<ParameterMessage> {
    let friction = scene.spec.friction.of_node(None);
    let number = |name: &str, value: f64, about: &str| ParameterMessage {
        name: name.into(),
        kind: ParameterKind::Number,
        value: Value::from(value),
        least: Some(0.0),
        most: None,
        choices: Vec::new(),
        about: about.into(),
        tunes: false,
    };
    let mut all = vec![
        number(
            INCREMENT,
            scene.model.on_leg(0),
            "Increment of the load factor; a change restarts the current increment",
        ),
        number(
            FRICTION,
            friction.coefficient(),
            "Friction coefficient of all contacts",
        ),
        number(COHESION, friction.cohesion, "Cohesion of all contacts"),
    ];
    let settings = paths::list(&scene.spec).into_iter();
    let settings = settings.filter(|listed| listed.path.starts_with("settings."));
    all.extend(settings.map(|listed| {
        let choices: Vec<String> = listed.words.iter().map(|word| (*word).to_owned()).collect();
        let (kind, value) = match listed.value.parse::<f64>() {
            _ if !choices.is_empty() => (ParameterKind::Choice, Value::from(listed.value)),
            Ok(_) if listed.kind.contains("whole") => {
                let whole: Option<i64> = listed.value.parse().ok();
                (ParameterKind::Integer, Value::from(whole))
            }
            Ok(number) => (ParameterKind::Number, Value::from(number)),
            Err(_) => match listed.value.parse::<bool>() {
                Ok(flag) => (ParameterKind::Flag, Value::from(flag)),
                Err(_) => (ParameterKind::Text, Value::from(listed.value)),
            },
        };
        ParameterMessage {
            name: listed.path,
            kind,
            value,
            least: None,
            most: None,
            choices,
            about: listed.kind,
            tunes: false,
        }
    }));
    all
}
