//! The connection of a session with its solver: what the solver can do, the state that it is in, and its loss.

use super::timeline::Timeline;
use crate::recorded::orders::changed_friction;
use crate::refusal::{Refusal, refusal};
use crate::{Log, Strip};
use stickslip_core::step::state::Controls;
use stickslip_core::{
    Capabilities, Contact, Friction, Intervention, RewindSupport, State, counted,
};
use stickslip_scene::joined;

/// A solver as its session sees it.
pub struct Connection {
    offers: Capabilities,
    /// Output of an attached solver; `None` for our own.
    log: Option<Log>,
    /// Identifier of the state that an attached solver is in
    /// ([`stickslip_core::step::state::ExternalState::place`]); `None` if unknown.
    at: Option<u64>,
    lost: Option<String>,
    repeats: String,
}

impl Connection {
    /// The connection with a solver at its start; `log` is the output of an attached one.
    pub(super) fn new(offers: Capabilities, log: Option<Log>) -> Connection {
        Connection {
            offers,
            at: log.as_ref().map(|_| 0),
            log,
            lost: None,
            repeats: String::new(),
        }
    }

    /// Capabilities of the solver.
    pub fn capabilities(&self) -> &Capabilities {
        &self.offers
    }

    /// The output of an attached solver, line by line; `None` for our own.
    pub fn log(&self) -> Option<&Log> {
        self.log.as_ref()
    }

    /// Why the connection to an attached solver failed; the next step starts the solver again.
    pub fn lost(&self) -> Option<&str> {
        self.lost.as_deref()
    }

    /// What an attached solver repeats in the running job before it continues; empty if nothing.
    pub fn repeats(&self) -> &str {
        &self.repeats
    }

    /// Notes that a job starts, or (with an empty text) ends.
    pub(super) fn set_repeats(&mut self, repeats: Option<String>) {
        self.repeats = repeats.unwrap_or_default();
    }

    /// Notes that the solver has reached a state; `None` if it is moved to an unknown one.
    pub(super) fn reach(&mut self, state: Option<&State>) {
        self.at = state.and_then(|state| Some(state.outside.as_ref()?.place));
    }

    /// Notes that the solver has taken a step, to this state.
    pub(super) fn step(&mut self, state: &State) {
        self.reach(Some(state));
        self.lost = None;
    }

    /// Notes that the connection failed.
    pub(super) fn lose(&mut self, why: String) {
        self.at = None;
        self.lost = Some(why);
    }

    /// What an attached solver has to repeat before it can continue from a point of the line; `None` if it is
    /// there already or gets there directly.
    pub(super) fn way_back(&self, timeline: &Timeline, target: usize) -> Option<String> {
        self.log()?;
        let place = timeline.frames()[target].state.outside.as_ref()?.place;
        if self.offers.past.is_some() || self.at == Some(place) {
            return None;
        }
        let way = &timeline.strips()[..=target];
        let solved =
            |strips: &[Strip]| strips.iter().filter(|strip| strip.kind.is_solved()).count();
        let again = |start: &str, count: usize| match count {
            0 => start.to_owned(),
            count => format!("{start} and repeats {}", counted(count, "iteration")),
        };
        match self.offers.goes_back {
            _ if self.lost.is_some() => Some(again(
                "the solver, whose connection was lost, restarts",
                solved(way),
            )),
            RewindSupport::Again => Some(again("the solver restarts", solved(way))),
            RewindSupport::ToIncrements => {
                let begun = way.iter().rposition(|strip| strip.kind.is_accepted());
                let count = solved(&way[begun.map_or(0, |at| at + 1)..]);
                let start = "the solver returns to the start of the increment";
                (count > 0).then(|| again(start, count))
            }
            RewindSupport::ToAny => None,
        }
    }

    /// The intervention of `:set` for an attached solver: one of its parameters, or a setting of the debugger.
    pub(super) fn intervention(
        &self,
        path: &str,
        value: &str,
        controls: &Controls,
        contacts: &[Contact],
    ) -> Result<Intervention, Refusal> {
        let number = || {
            let number: Option<f64> = value.parse().ok();
            number.ok_or_else(|| refusal!("{value} is not a number"))
        };
        let now = &controls.friction;
        let known = &self.offers.parameters;
        let parameter = known.iter().find(|known| known.name == path);
        Ok(match (path, parameter) {
            ("increment" | "history.increment", _) => Intervention::Increment(number()?),
            ("friction", Some(_)) => {
                let mu = number()?;
                changed_friction(now, contacts, |f| {
                    Friction::from_coefficient(mu, f.cohesion)
                })
            }
            ("friction.angle", _) if self.offers.friction => {
                let angle = number()?;
                changed_friction(now, contacts, |f| Friction { angle, ..f })
            }
            ("friction.angle", _) => {
                return Err(Refusal::new(self.offers.lacks("a friction change")));
            }
            ("cohesion" | "friction.cohesion", _) if self.offers.cohesion => {
                let cohesion = number()?;
                changed_friction(now, contacts, |f| Friction { cohesion, ..f })
            }
            ("cohesion" | "friction.cohesion", _) => {
                return Err(Refusal::new(self.offers.lacks("a cohesion change")));
            }
            (_, Some(parameter)) => Intervention::Parameter {
                name: path.to_owned(),
                value: parameter.read(value).map_err(Refusal::new)?,
            },
            (_, None) => {
                let names = joined(known.iter().map(|known| &known.name), ", ");
                return Err(refusal!(
                    "the solver has no parameter '{path}'; {known}",
                    known = if names.is_empty() {
                        "it has none".into()
                    } else {
                        format!("it has {names}")
                    }
                ));
            }
        })
    }
}
