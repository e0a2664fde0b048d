//! The interface that a debugger steps.
//!
//! [`Stepper`] is one such solver. Others are external programs, attached through a protocol, or iterations written in Rust:
//! anything that owns a [`State`] and an [`Event`], updates both at every iteration, and can return to an earlier state. A
//! debugger reads nothing else, so timeline, breakpoints, branches and records work for all of them.
//!
//! A solver whose iterations depend only on the numbers of the [`State`] goes back by restoring a state. A solver that needs more
//! data stores them itself, in [`StoredStates`] or in an external program: its states contain the number of the stored data
//! ([`ExternalState::place`]) and the changes made by the user since ([`ExternalState::asked`]), which it receives when it continues from
//! there.
//!
//! # Example
//!
//! A node on a spring of stiffness 10 hangs 0.1 above a floor and is pressed on it in two increments of 2; it opens or closes
//! until its mode is consistent. The state is all the data it needs.
//!
//! ```
//! use std::sync::Arc;
//! use stickslip_core::contact::record::{ContactRecord, Forced};
//! use stickslip_core::linear::norms::Norms;
//! use stickslip_core::model::{Contact, Friction, InitialState, Mode, Model, Node, Surface};
//! use stickslip_core::step::intervene::Intervention;
//! use stickslip_core::step::solver::{Capabilities, Now, RewindSupport, SolverLost};
//! use stickslip_core::{Event, Outcome, Solver, State};
//!
//! struct Pressed {
//!     model: Arc<Model>,
//!     state: State,
//!     event: Event,
//! }
//!
//! impl Solver for Pressed {
//!     fn now(&self) -> Now<'_> {
//!         Now::new(&self.model, &self.state, &self.event)
//!     }
//!     fn state_mut(&mut self) -> &mut State {
//!         &mut self.state
//!     }
//!     fn advance(&mut self) -> Result<(), SolverLost> {
//!         let (spring, distance) = (10.0, 0.1);
//!         let load = self.state.start.load_factor + 0.5;
//!         let (node, press) = (self.state.nodes[0], 4.0 * load);
//!         let (gap, f_n) = match node.mode {
//!             Mode::Free => (distance - press / spring, 0.0),
//!             _ => (0.0, press - spring * distance),
//!         };
//!         let next = match (node.forced, node.mode) {
//!             (Forced::Held(mode), _) => mode,
//!             (_, Mode::Free) if gap < 0.0 => Mode::Fixed,
//!             (_, Mode::Fixed | Mode::Sliding) if f_n < 0.0 => Mode::Free,
//!             (_, same) => same,
//!         };
//!         let found = ContactRecord::from_modes(node.mode, next, &node);
//!         self.event = Event {
//!             position: self.state.next,
//!             load_factor: load,
//!             nodes: vec![ContactRecord { gap, f_n, ..found }],
//!             outcome: match next == node.mode {
//!                 true => Outcome::accepted(Norms::default(), load == 1.0),
//!                 false => Outcome::Minor,
//!             },
//!             ..Event::nothing_yet(&self.model)
//!         };
//!         self.state.follow(&self.event, 0);
//!         Ok(())
//!     }
//!     fn capabilities(&self) -> Capabilities {
//!         Capabilities { name: "pressed".into(), force: true, hold: true, goes_back: RewindSupport::ToAny, ..Capabilities::default() }
//!     }
//! }
//!
//! let node = |name: &str, at| Node { name: name.into(), at };
//! let nodes = vec![node("slave", [0.0, 0.1]), node("floor.1", [1.0, 0.0]), node("floor.2", [-1.0, 0.0])];
//! let floor = Surface { name: "floor".into(), elements: vec![vec![1, 2]], rigid: true, endless: true, past_ends: [0.0; 2], smooth: Vec::new(), gives: Vec::new() };
//! let contact = Contact::new(0, vec![0], Friction { angle: 20.0, cohesion: 0.0 });
//! let model = Arc::new(Model::from_contacts("A node pressed on a floor", nodes, vec![floor], vec![contact]));
//! let (state, event) = (State::outside_start(&model), Event::nothing_yet(&model));
//! let mut solver = Pressed { model, state, event };
//!
//! let start = solver.state().clone();
//! // Free, it penetrates; then it touches with 2 - 1 and with 4 - 1.
//! while solver.step().unwrap() {}
//! assert_eq!(solver.state().nodes[0].f_n, 3.0);
//! // Back, and held away from the floor.
//! solver.restore(&start).unwrap();
//! solver.intervene(&Intervention::Force { slave: 0, mode: Mode::Free, hold: true }).unwrap();
//! while solver.step().unwrap() {}
//! assert_eq!((solver.state().nodes[0].mode, solver.event().nodes[0].gap), (Mode::Free, 0.1 - 0.4));
//! ```
//!
//! [`ExternalState::place`]: super::state::ExternalState::place
//! [`ExternalState::asked`]: super::state::ExternalState::asked
//! [`StoredStates`]: super::stored_states::StoredStates

use crate::step::intervene::Value;
use crate::{Event, Friction, Intervention, Model, Refusal, State, Status, Stepper};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

/// A solver that cannot continue: it has exited, or violates its interface. Its earlier iterations remain valid.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct SolverLost {
    /// What happened, and what was expected.
    pub reason: String,
}

impl SolverLost {
    /// With the reason.
    pub fn new(reason: impl Into<String>) -> Self {
        SolverLost {
            reason: reason.into(),
        }
    }
}

/// The scene of a solver, its current state, and the last minor iteration.
#[derive(Debug, Clone, Copy)]
pub struct Now<'a> {
    /// The scene.
    pub model: &'a Arc<Model>,
    /// Current state.
    pub state: &'a State,
    /// Last minor iteration.
    pub event: &'a Event,
}

impl<'a> Now<'a> {
    /// From its parts.
    pub fn new(model: &'a Arc<Model>, state: &'a State, event: &'a Event) -> Self {
        Now {
            model,
            state,
            event,
        }
    }
}

/// A solver that can be stepped.
pub trait Solver: Send {
    /// Where the solver is.
    fn now(&self) -> Now<'_>;

    /// Current state of the solver, to which [`Solver::restore`] and [`Solver::intervene`] apply their changes.
    fn state_mut(&mut self) -> &mut State;

    /// Does one minor iteration of a history that is not finished, and updates event and state.
    ///
    /// # Errors
    /// [`SolverLost`] if it cannot continue; state and event are unchanged.
    fn advance(&mut self) -> Result<(), SolverLost>;

    /// Does one minor iteration; `false` if the history is finished and nothing was solved.
    ///
    /// # Errors
    /// [`SolverLost`] if it cannot continue.
    fn step(&mut self) -> Result<bool, SolverLost> {
        match self.state().status {
            Status::Finished => Ok(false),
            _ => self.advance().map(|()| true),
        }
    }

    /// Returns to an earlier state, with the changes made there.
    ///
    /// # Errors
    /// [`SolverLost`] if it cannot return to that state.
    fn restore(&mut self, state: &State) -> Result<(), SolverLost> {
        self.state_mut().clone_from(state);
        Ok(())
    }

    /// Applies a change made by the user.
    ///
    /// # Errors
    /// If the change is invalid or not offered.
    fn intervene(&mut self, intervention: &Intervention) -> Result<(), Refusal> {
        self.capabilities().check(intervention)?;
        let model = self.model().clone();
        self.state_mut().intervene(&model, intervention)
    }

    /// The scene.
    fn model(&self) -> &Arc<Model> {
        self.now().model
    }

    /// Current state of the solver.
    fn state(&self) -> &State {
        self.now().state
    }

    /// The last minor iteration.
    fn event(&self) -> &Event {
        self.now().event
    }

    /// Appends the values of the scene's monitors at the end of an increment that was just accepted to `out`; nothing if the
    /// scene has none.
    fn monitors(&mut self, _out: &mut Vec<f64>) {}

    /// Capabilities offered to a debugger.
    fn capabilities(&self) -> Capabilities {
        Capabilities::default()
    }

    /// The interface problem of a state with everything else frozen, if the solver offers it.
    ///
    /// # Errors
    /// Why it is not available.
    fn interface_problem(&mut self, _state: &State) -> Result<ReportedProblem, SolverLost> {
        Err(SolverLost::new(
            "the solver does not offer its interface problem",
        ))
    }

    /// The built-in stepper, if the solver is one.
    fn stepper(&mut self) -> Option<&mut Stepper> {
        None
    }

    /// Installs the counter of the user's interrupt requests. A solver that cannot interrupt an iteration stops after it.
    fn set_cancel(&mut self, _asks: Arc<AtomicUsize>) {}

    /// A notice for the user about how the current state was reached; returned once.
    fn take_notice(&mut self) -> Option<String> {
        None
    }
}

/// Capabilities of a solver offered to a debugger; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Capabilities {
    /// Name of the solver; empty for the built-in one.
    pub name: String,
    /// Version reported by the solver; may be empty.
    pub version: String,
    /// Kind of read-only record, if only the record of a run exists; `None` for a solver that can be stepped.
    pub past: Option<&'static str>,
    /// Modes can be forced for one iteration.
    pub force: bool,
    /// Modes can be held until released.
    pub hold: bool,
    /// The increment can be changed.
    pub increment: bool,
    /// The friction of all contacts can be changed.
    pub friction: bool,
    /// The cohesion of all contacts can be changed.
    pub cohesion: bool,
    /// Settings of the two-level method can be changed.
    pub settings: bool,
    /// How the solver returns to earlier states.
    pub goes_back: RewindSupport,
    /// Its frozen interface problem is available ([`Solver::interface_problem`]).
    pub problem: bool,
    /// The diagnosis has cures from the record itself.
    pub cures: bool,
    /// Other parameters that can be changed.
    pub parameters: Vec<Parameter>,
}

impl Capabilities {
    /// Everything that the built-in stepper offers.
    pub fn all() -> Capabilities {
        Capabilities {
            name: String::new(),
            version: String::new(),
            past: None,
            force: true,
            hold: true,
            increment: true,
            friction: true,
            cohesion: true,
            settings: true,
            goes_back: RewindSupport::ToAny,
            problem: true,
            cures: false,
            parameters: Vec::new(),
        }
    }

    /// Checks whether an intervention is accepted.
    ///
    /// # Errors
    /// [`Refusal::NotOffered`] with the missing capability, or with the error in a parameter's value.
    pub fn check(&self, intervention: &Intervention) -> Result<(), Refusal> {
        let (offered, what) = match intervention {
            Intervention::Force { hold: false, .. } | Intervention::Assume(_) => {
                (self.force, "forced modes")
            }
            Intervention::Force { hold: true, .. } => (self.hold, "modes that are held"),
            Intervention::Release { .. } => (self.force || self.hold, "forced modes"),
            Intervention::Increment(_) => (self.increment, "another increment"),
            Intervention::Friction(_) | Intervention::Frictions(_) => {
                (self.friction || self.cohesion, "another friction")
            }
            Intervention::Settings(_) => (self.settings, "settings of the two-level method"),
            Intervention::Parameter { name, value } => {
                let known = self
                    .parameters
                    .iter()
                    .find(|known| known.name == *name)
                    .ok_or_else(|| Refusal::NoParameter(name.clone()))?;
                return known.check(value);
            }
        };
        if offered {
            Ok(())
        } else {
            Err(Refusal::NotOffered(self.lacks(what)))
        }
    }

    /// Initial increment of the solver, if it can be changed.
    pub fn begins_with(&self) -> Option<f64> {
        let increment = self
            .parameters
            .iter()
            .find(|known| known.name == "increment")?;
        match increment.value {
            Value::Number(size) => Some(size),
            Value::Flag(_) | Value::Text(_) => None,
        }
    }

    /// Message that something is not offered.
    pub fn lacks(&self, what: &str) -> String {
        let name = &self.name;
        match self.past {
            Some(record) => format!("{record}: {what} would need the solver {name} itself"),
            None => format!("the solver {name} does not offer {what}"),
        }
    }
}

/// How a solver returns to an earlier state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RewindSupport {
    /// By restarting and repeating everything.
    #[default]
    Again,
    /// To the start of an increment, from which it repeats the rest.
    ToIncrements,
    /// To any state.
    ToAny,
}

/// A parameter that can be changed in an attached solver during a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Parameter name.
    pub name: String,
    /// Initial value.
    pub value: Value,
    /// Accepted values.
    pub range: Range,
    /// One-line description; may be empty.
    pub about: String,
    /// Whether it changes how the solver iterates, but not the answer.
    pub tunes: bool,
}

/// Accepted values of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Range {
    /// Numbers between two bounds, integers only or any.
    Numbers {
        /// Minimum.
        least: f64,
        /// Maximum.
        most: f64,
        /// Whether only integers are accepted.
        whole: bool,
    },
    /// True or false.
    Flag,
    /// One of these strings.
    Choice(Vec<String>),
    /// Any string.
    Text,
}

impl Parameter {
    /// Checks whether a value is accepted.
    ///
    /// # Errors
    /// Which values are accepted.
    pub fn check(&self, value: &Value) -> Result<(), Refusal> {
        let takes = match (&self.range, value) {
            (&Range::Numbers { least, most, whole }, Value::Number(x)) => {
                (least..=most).contains(x) && (!whole || x.fract() == 0.0)
            }
            (Range::Flag, Value::Flag(_)) | (Range::Text, Value::Text(_)) => true,
            (Range::Choice(choices), Value::Text(text)) => choices.contains(text),
            _ => false,
        };
        if takes {
            Ok(())
        } else {
            let (name, range) = (&self.name, &self.range);
            let message = format!("{name} takes {range}, and {value} is none");
            Err(Refusal::NotOffered(message))
        }
    }

    /// Value in a state: the last value set, or else the initial one. Three names have a meaning, and the state stores their
    /// values: increment, friction (mu) and cohesion of all contacts.
    pub fn now(&self, model: &Model, state: &State) -> Value {
        let controls = &state.controls;
        let coulomb = controls
            .friction
            .first()
            .zip(model.contacts.first())
            .filter(|(now, first)| **now != first.friction);
        let number = match (self.name.as_str(), coulomb) {
            ("increment", _) if controls.increment != model.increment => Some(controls.increment),
            ("friction", Some((now, _))) => Some(now.coefficient()),
            ("cohesion", Some((now, _))) => Some(now.cohesion),
            _ => None,
        };
        let outside = state.outside.as_ref();
        let set =
            outside.and_then(|outside| outside.set.iter().find(|(name, _)| *name == self.name));
        match (number, set) {
            (Some(number), _) => Value::Number(number),
            (None, Some((_, value))) => value.clone(),
            (None, None) => self.value.clone(),
        }
    }

    /// Parses a value.
    ///
    /// # Errors
    /// Which values are accepted.
    pub fn read(&self, word: &str) -> Result<Value, Refusal> {
        let text = || Value::Text(word.to_owned());
        let value = match self.range {
            Range::Numbers { .. } => word.parse().map_or_else(|_| text(), Value::Number),
            Range::Flag => word.parse().map_or_else(|_| text(), Value::Flag),
            Range::Choice(_) | Range::Text => text(),
        };
        self.check(&value)?;
        Ok(value)
    }
}

impl std::fmt::Display for Range {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Range::Numbers { least, most, whole } => {
                let kind = if *whole { "a whole number" } else { "a number" };
                match (least.is_finite(), most.is_finite()) {
                    (true, true) => write!(f, "{kind} from {least} to {most}"),
                    (true, false) => write!(f, "{kind} from {least} on"),
                    (false, true) => write!(f, "{kind} up to {most}"),
                    (false, false) => f.write_str(kind),
                }
            }
            Range::Flag => f.write_str("true or false"),
            Range::Choice(choices) => write!(f, "one of {}", choices.join(", ")),
            Range::Text => f.write_str("a text"),
        }
    }
}

/// Frozen interface problem reported by an attached solver: with the total forces f = (f_n, f_t) of the listed contacts at the
/// end of the increment,
///
/// ```text
/// (gap, u) = W f + q        or        f = K ((gap, u) − q)
/// ```
///
/// where u is the motion of the node relative to its master along t since the increment began, so that u = 0 sticks.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportedProblem {
    /// Contact numbers, in the order of the rows.
    pub contacts: Vec<usize>,
    /// Number of tangential components: 2 in space, where u and f_t are vectors.
    pub tangents: usize,
    /// Kind of the matrix.
    pub form: ReportedForm,
    /// Rows: `1 + tangents` rows per contact.
    pub matrix: Vec<Vec<f64>>,
    /// Gap and motion without any force (length), one number per row.
    pub q: Vec<f64>,
    /// Load, one number per row (force): with a stiffness, f = K ((gap, u) − q) − load, so that the bodies may be supported by the
    /// contacts alone.
    pub load: Vec<f64>,
    /// Friction of each contact.
    pub friction: Vec<Friction>,
}

impl ReportedProblem {
    /// W and q of the same problem; `None` if K is singular.
    pub fn compliance(&self) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let size = self.q.len();
        let matrix = DMatrix::from_fn(size, size, |i, j| self.matrix[i][j]);
        let q = DVector::from_column_slice(&self.q);
        match self.form {
            ReportedForm::Compliance => Some((matrix, q)),
            ReportedForm::Stiffness => {
                let inverse = matrix.try_inverse()?;
                let loaded = &inverse * DVector::from_column_slice(&self.load);
                Some((inverse, q + loaded))
            }
        }
    }

    /// Gap and motion u of each contact under total forces (length); `None` if K is singular.
    pub fn motion(&self, forces: &DVector<f64>) -> Option<DVector<f64>> {
        let size = self.q.len();
        let matrix = DMatrix::from_fn(size, size, |i, j| self.matrix[i][j]);
        let pushed = match self.form {
            ReportedForm::Compliance => matrix * forces,
            ReportedForm::Stiffness => {
                let load = DVector::from_column_slice(&self.load);
                matrix.lu().solve(&(forces + load))?
            }
        };
        Some(pushed + DVector::from_column_slice(&self.q))
    }
}

/// Kind of the matrix of a [`ReportedProblem`] problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ReportedForm {
    /// W (length per force).
    Compliance,
    /// K (force per length).
    Stiffness,
}

impl Solver for Stepper {
    fn now(&self) -> Now<'_> {
        Now::new(&self.now.model, &self.now.state, &self.event)
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.now.state
    }

    fn advance(&mut self) -> Result<(), SolverLost> {
        Stepper::step(self);
        Ok(())
    }

    fn restore(&mut self, state: &State) -> Result<(), SolverLost> {
        Stepper::restore(self, state);
        Ok(())
    }

    fn intervene(&mut self, intervention: &Intervention) -> Result<(), Refusal> {
        Stepper::intervene(self, intervention)
    }

    fn monitors(&mut self, out: &mut Vec<f64>) {
        Stepper::monitors(self, out);
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities::all()
    }

    fn stepper(&mut self) -> Option<&mut Stepper> {
        Some(self)
    }
}
