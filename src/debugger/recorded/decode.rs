//! Converts the messages of an attached solver into states and events of the core.
//!
//! Numbers that a solver does not report are NaN; an unreported gap or margin is infinite, as if nothing were
//! near. If the solver names its decision rules, each decision is repeated here with its numbers ([`decide`],
//! or Newton's method on the projections), to show where the two differ.

use super::fault::Fault;
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::{Error as NoName, StrDeserializer};
use std::sync::Arc;
use stickslip_core::contact::table2::{Entry, decide};
use stickslip_core::interface::method::NodeContext;
use stickslip_core::plane::max_abs;
use stickslip_core::step::event::{Frame, Words};
use stickslip_core::step::judged::{self, ReferenceSizes};
use stickslip_core::strategy::method;
use stickslip_core::{
    ContactRecord, Decision, Event, Failure, Forced, Friction, Mode, Model, Norms, Numbers,
    Outcome, Position, Rule, State, Strategy, SurfacePoint, Test, TestedQuantity, Ties, counted,
};
use stickslip_exchange::attach::message::{
    self, Components, ContactResult, Decides, EndedLevel, Id,
};
use stickslip_scene::{Scene, shown};

/// Relative difference of forces and lengths below which a repeated decision is a tie.
const TIE: f64 = 1e-9;

/// Largest accepted counter.
const MOST_COUNT: u32 = 1_000_000_000;
/// Tolerance for the length of a unit normal.
const UNIT: f64 = 1e-3;
/// Maximum number of characters kept of a solver's texts.
const MOST_WORDS: usize = 400;

/// The context in which messages are converted.
pub struct WireFrame<'a> {
    /// The scene.
    pub model: &'a Model,
    /// The solver's ids of the contacts.
    pub ids: &'a [Id],
    /// The solver's decision rules.
    pub decides: Option<Decides>,
}

/// Result of an iteration.
#[derive(Clone)]
pub struct RecordedStep {
    /// The event of the iteration.
    pub event: Event,
    /// The state from which the next iteration starts; its identifier is set later.
    pub state: State,
    /// Values of the monitors reported.
    pub monitors: Vec<f64>,
}

/// The scene of an attached solver, with its ids of the contacts, and the start state. `increment` is the first
/// increment, if the solver reports it.
///
/// # Errors
/// [`Fault::Unfit`].
pub fn start(
    name: &str,
    sent: &message::Scene,
    increment: Option<f64>,
) -> Result<(Scene, Vec<Id>, RecordedStep), Fault> {
    let scene = Scene::from_message(name, sent, increment).map_err(|error| Fault::Unfit {
        message: "scene",
        why: error.message,
    })?;
    let ids = sent.contacts.iter().map(|contact| contact.id.clone());
    let start = RecordedStep {
        state: State::outside_start(&scene.model),
        event: Event::nothing_yet(&scene.model),
        monitors: Vec::new(),
    };
    Ok((scene, ids.collect(), start))
}

fn unfit<T>(why: impl Into<String>) -> Result<T, Fault> {
    Err(Fault::Unfit {
        message: "state",
        why: why.into(),
    })
}

impl WireFrame<'_> {
    /// Converts a state message about the iteration that started from `from`.
    ///
    /// # Errors [`Fault::Unfit`] if the message does not match the scene.
    pub fn recorded_step(
        &self,
        from: &State,
        sent: &message::State,
    ) -> Result<RecordedStep, Fault> {
        let at = self.check(sent)?;
        let load = sent.load.unwrap_or(from.load_factor);
        let ties = self.ties(sent);
        let mut nodes = Vec::with_capacity(sent.contacts.len());
        let mut words = Vec::new();
        for (k, found) in sent.contacts.iter().enumerate() {
            let (record, word) = self.record(from, k, found, sent.spring, &ties);
            if !word.is_empty() {
                words.resize(sent.contacts.len(), String::new());
                words[k] = word;
            }
            nodes.push(record);
        }
        let before = from
            .outside
            .as_ref()
            .map_or(0.0, |outside| outside.largest_force);
        let force = before.max(judged::largest_force(&nodes));
        let mut outcome = outcome(sent);
        if let Outcome::Increment { marked, .. } = &mut outcome {
            let sizes = ReferenceSizes {
                force: force.max(judged::ROUND_OFF * sent.residual.scale.unwrap_or(0.0)),
                length: largest(sent.displacements.as_deref()),
            };
            *marked = judged::broken(self.model, &nodes, &sizes);
        }
        let event = Event {
            position: at,
            load_factor: load,
            arc: sent.arc,
            drag: sent.drag.unwrap_or(0.0),
            frames: Arc::new(self.frames(sent)),
            nodes,
            before: norms(&sent.residual),
            words: Arc::new(Words {
                contacts: words,
                ..Words::default()
            }),
            outcome,
        };
        let mut state = self.next(from, sent, &event);
        if let Some(outside) = &mut state.outside {
            outside.largest_force = force;
        }
        let monitors = self.model.monitors.iter().enumerate();
        let monitor = |(k, _)| sent.monitors.get(k).copied().flatten().unwrap_or(f64::NAN);
        Ok(RecordedStep {
            state,
            monitors: monitors.map(monitor).collect(),
            event,
        })
    }

    /// Checks that a message matches the scene; returns the position of its iteration.
    ///
    /// # Errors
    /// [`Fault::Unfit`].
    pub fn check(&self, sent: &message::State) -> Result<Position, Fault> {
        let at = sent.at;
        let counts = [at.increment, at.attempt, at.major, at.minor];
        if counts.iter().any(|count| !(1..=MOST_COUNT).contains(count)) {
            return unfit(format!("at: counters must be from 1 to {MOST_COUNT}"));
        }
        if sent.size.is_some_and(|size| size <= 0.0) {
            return unfit("size: must be positive");
        }
        let count = self.ids.len();
        let solved = matches!(
            sent.ended,
            EndedLevel::Equilibrium | EndedLevel::Increment | EndedLevel::Done
        );
        if sent.contacts.len() != count && (solved || !sent.contacts.is_empty()) {
            return unfit(format!(
                "it has {}; the scene has {count}",
                counted(sent.contacts.len(), "contact")
            ));
        }
        for (k, (found, id)) in sent.contacts.iter().zip(self.ids).enumerate() {
            if let Some(other) = found.id.as_ref().filter(|found| *found != id) {
                return unfit(format!(
                    "contacts[{k}].id is {other}; it must be {id}, as in the scene"
                ));
            }
            self.check_vectors(k, found)?;
        }
        let nodes = self.model.nodes.len();
        match &sent.displacements {
            Some(all) if all.len() != nodes => unfit(format!(
                "it has {}; the scene has {}",
                counted(all.len(), "displacement"),
                counted(nodes, "node")
            )),
            Some(all)
                if all
                    .iter()
                    .any(|moved| moved.as_slice().len() != self.dimension()) =>
            {
                unfit(format!(
                    "displacements: each must be {} numbers",
                    self.dimension()
                ))
            }
            _ => Ok(at),
        }
    }

    /// Number of coordinates.
    fn dimension(&self) -> usize {
        if self.model.space.is_some() { 3 } else { 2 }
    }

    /// Checks the numbers of components of a contact's vectors, and the lengths of unit vectors.
    fn check_vectors(&self, k: usize, found: &ContactResult) -> Result<(), Fault> {
        let space = self.dimension();
        let vectors = [
            ("f_t", found.f_t, space - 1),
            ("slip", found.slip, space - 1),
            ("normal", found.normal, space),
            ("tangent", found.tangent, space),
            ("foot", found.foot, space),
        ];
        let other = |given: &Components, wanted: usize| given.as_slice().len() != wanted;
        for (name, given, wanted) in vectors {
            if given.is_some_and(|given| other(&given, wanted)) {
                let numbers = counted(wanted, "number");
                return unfit(format!("contacts[{k}].{name}: must be {numbers}"));
            }
        }
        for (name, given) in [("normal", found.normal), ("tangent", found.tangent)] {
            if given.is_some_and(|given| (given.size() - 1.0).abs() >= UNIT) {
                return unfit(format!("contacts[{k}].{name}: must have length 1"));
            }
        }
        if found
            .normal
            .zip(found.tangent)
            .is_some_and(|(n, t)| dot(n.in_space(), t.in_space()).abs() >= UNIT)
        {
            return unfit(format!(
                "contacts[{k}].tangent: must be at right angles to normal"
            ));
        }
        Ok(())
    }

    /// The frames of all contacts in space; empty in the plane.
    fn frames(&self, sent: &message::State) -> Vec<Frame> {
        sent.contacts
            .iter()
            .filter(|_| self.model.space.is_some())
            .map(|found| {
                let n = found.normal.map_or([0.0, 0.0, 1.0], |n| n.in_space());
                [n, found.tangent.map_or_else(|| along(n), |t| t.in_space())]
            })
            .collect()
    }

    /// Tolerances for ties, relative to the forces.
    fn ties(&self, sent: &message::State) -> Ties {
        let found = sent.contacts.iter();
        let forces = found.flat_map(|found| [found.f_n, found.f_t.map(|f| f.size())]);
        let largest = max_abs(forces.flatten());
        Ties {
            force: TIE * largest,
            length: TIE * self.model.length,
            keep: true,
        }
    }

    /// The record of a contact, and the solver's own reason.
    fn record(
        &self,
        from: &State,
        k: usize,
        found: &ContactResult,
        spring: Option<f64>,
        ties: &Ties,
    ) -> (ContactRecord, String) {
        let friction = &from.controls.friction[k];
        let named = rule(&found.rule);
        let word = match named {
            Some(_) => String::new(),
            None => shown::cut(&found.rule, MOST_WORDS),
        };
        let forced = forced(from, k, found);
        let known = |x: Option<f64>| x.unwrap_or(f64::NAN);
        let t_max = known(found.limit);
        let record = ContactRecord {
            decision: self.decision(found, friction, spring, ties, (named, forced)),
            forced,
            gap: found.gap.unwrap_or(f64::INFINITY),
            f_n: known(found.f_n),
            f_t: known(length(found.f_t)),
            t_max,
            t_max_used: found.limit_used.unwrap_or(t_max),
            slip: known(length(found.slip)),
            drift: known(found.drift.or(length(found.slip))),
            spot: self.spot(k, found),
            normal: pair(found.normal).unwrap_or(from.nodes[k].normal),
            foot: pair(found.foot).unwrap_or(self.model.nodes[self.model.contacts[k].node].at),
            directions: (self.dimension() == 3).then(|| [found.f_t, found.slip].map(direction)),
            corner: found.corner,
            carried: found.carried,
        };
        (record, word)
    }

    /// A point on the node's surface, or `None` past its ends. Only the solver knows the element.
    fn spot(&self, k: usize, found: &ContactResult) -> Option<SurfacePoint> {
        found.over.then(|| SurfacePoint {
            surface: self.model.contacts[k]
                .surfaces
                .first()
                .copied()
                .unwrap_or(0),
            element: 0,
            xi: 0.0,
        })
    }

    /// The decision, and what our rules yield for the solver's numbers.
    fn decision(
        &self,
        found: &ContactResult,
        friction: &Friction,
        spring: Option<f64>,
        ties: &Ties,
        (named, forced): (Option<Rule>, Forced),
    ) -> Decision {
        let ours = match self.decides {
            // The rules are those of the plane.
            _ if !found.tests.is_empty() || self.dimension() == 3 => None,
            Some(Decides::Table2) => by_table_2(found, friction, ties),
            Some(Decides::Newton) => by_newton(found, friction, spring, ties),
            None => None,
        };
        let own = found.margin.map(|margin| Test {
            tested: TestedQuantity::Own,
            value: margin,
            bound: 0.0,
            margin,
            tie: false,
        });
        let mut tested = found.tests.iter().copied();
        let (next, wanted) = (found.next, ours.map_or(found.next, |ours| ours.next));
        Decision {
            before: found.mode,
            next,
            rule: match (named, ours) {
                (Some(rule), _) => rule,
                (None, Some(ours)) if ours.next == next => ours.rule,
                (None, None) if !found.over => Rule::OffSurface,
                (None, _) if matches!(forced, Forced::Held(_)) => Rule::Held,
                (None, _) => Rule::Theirs,
            },
            tests: ours.map_or([tested.next().or(own), tested.next()], |ours| ours.tests),
            wanted: found.wanted.unwrap_or(wanted),
        }
    }

    /// The state from which the solver continues.
    fn next(&self, from: &State, sent: &message::State, event: &Event) -> State {
        let mut state = from.clone();
        if let Some(displacements) = &sent.displacements {
            let u = displacements
                .iter()
                .flat_map(Components::as_slice)
                .copied()
                .collect();
            state.u = Arc::new(u);
        }
        state.follow(event, from.place().unwrap_or(0));
        if let Some(size) = sent.size {
            Arc::make_mut(&mut state.controls).increment = size;
        }
        state
    }
}

/// The largest displacement (length); 0 if none are reported.
fn largest(displacements: Option<&[Components]>) -> f64 {
    let displacements = displacements.unwrap_or_default().iter();
    max_abs(displacements.map(Components::size))
}

/// The signed component along t; in space the length of the vector.
fn length(given: Option<Components>) -> Option<f64> {
    given.map(|given| given.scalar().unwrap_or_else(|| given.size()))
}

/// Angle of a tangential vector from t towards n × t (radians); 0 if it is not reported.
fn direction(given: Option<Components>) -> f64 {
    let [a, b] = pair(given).unwrap_or_default();
    b.atan2(a)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn pair(given: Option<Components>) -> Option<[f64; 2]> {
    given.and_then(|given| given.pair())
}

/// The tangent of a contact in space that reports none: the x axis projected, or the y axis if n is nearly along x.
fn along(n: [f64; 3]) -> [f64; 3] {
    let axis = usize::from(n[0].abs() > 0.9);
    let t = [0, 1, 2].map(|k| f64::from(u8::from(k == axis)) - n[axis] * n[k]);
    let size = dot(t, t).sqrt();
    t.map(|x| x / size)
}

impl RecordedStep {
    /// Sets the identifier of the state.
    pub fn state_at(&mut self, place: u64) {
        if let Some(outside) = &mut self.state.outside {
            outside.place = place;
        }
    }
}

/// Whether a node is forced: as reported, or as requested.
fn forced(from: &State, k: usize, found: &ContactResult) -> Forced {
    match found.forced {
        Some(message::Forced::Once) => Forced::Once(found.mode),
        Some(message::Forced::Held) => Forced::Held(found.next),
        None => from.nodes[k].forced,
    }
}

fn by_table_2(found: &ContactResult, friction: &Friction, ties: &Ties) -> Option<Decision> {
    let before = found.mode;
    // Numbers that the row does not use may be missing.
    let rest = |x: Option<f64>, needed: bool| match (x, needed) {
        (Some(x), _) => Some(x),
        (None, false) => Some(0.0),
        (None, true) => None,
    };
    let touches = before != Mode::Free;
    let numbers = Numbers {
        mode: before,
        gap: rest(found.gap, !touches)?,
        f_n: rest(found.f_n, touches)?,
        f_t: rest(length(found.f_t), before == Mode::Fixed)?,
        t_max: rest(found.limit, touches)?,
        slip: rest(length(found.slip), before == Mode::Sliding)?,
        entry: if friction.is_smooth() {
            Entry::Smooth
        } else {
            Entry::Fixed
        },
    };
    Some(decide(&numbers, ties))
}

fn by_newton(
    found: &ContactResult,
    friction: &Friction,
    spring: Option<f64>,
    ties: &Ties,
) -> Option<Decision> {
    let before = found.mode;
    let sticks = before == Mode::Fixed;
    let numbers = Numbers {
        mode: before,
        gap: found.gap.unwrap_or(if sticks { 0.0 } else { f64::NAN }),
        f_n: found.f_n?,
        f_t: length(found.f_t)?,
        t_max: found.limit?,
        slip: length(found.slip)?,
        entry: Entry::Fixed,
    };
    if numbers.gap.is_nan() {
        return None;
    }
    let known = NodeContext {
        spring: spring?,
        friction,
        ties,
        slip: numbers.slip,
        sign: if numbers.t_max < 0.0 { -1.0 } else { 1.0 },
    };
    Some(method(Strategy::Newton).choose(&numbers, &known).decision)
}

/// A row of Table 2 or of another strategy of ours, by name.
fn rule(name: &str) -> Option<Rule> {
    let name: StrDeserializer<'_, NoName> = name.into_deserializer();
    Rule::deserialize(name).ok()
}

/// Residual norms; unreported ones are NaN.
fn norms(sent: &message::NormsMessage) -> Norms {
    let known = |x: Option<f64>| x.unwrap_or(f64::NAN);
    Norms {
        force: known(sent.force),
        relative: known(sent.relative),
        interface: known(sent.interface),
        correction: known(sent.correction),
        scale: known(sent.scale),
        limit: known(sent.limit),
        noise: sent.noise.unwrap_or(0.0),
    }
}

fn outcome(sent: &message::State) -> Outcome {
    let after = norms(sent.after.as_ref().unwrap_or(&sent.residual));
    let why = || Failure::Reported {
        reason: shown::cut(sent.reason.trim(), MOST_WORDS),
        // JSON cannot represent infinity.
        relative: sent
            .after
            .map(|after| after.relative.unwrap_or(f64::INFINITY)),
    };
    match sent.ended {
        EndedLevel::Iteration => Outcome::Minor,
        EndedLevel::Equilibrium => Outcome::Major {
            after,
            settled: true,
        },
        EndedLevel::Cut => Outcome::Cut {
            why: why(),
            size: sent.size.unwrap_or(f64::NAN),
        },
        EndedLevel::Failure => Outcome::Failed(why()),
        EndedLevel::Increment | EndedLevel::Done => {
            Outcome::accepted(after, sent.ended == EndedLevel::Done)
        }
    }
}
