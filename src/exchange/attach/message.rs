//! What debugger and solver say to each other. Units are the solver's; forces act on the slave node, compression positive.

use serde::{Deserialize, Serialize};
use serde_json::Value;
pub use stickslip_core::contact::table2::Test;
pub use stickslip_core::model::{Mode, Node, ToldKind};
pub use stickslip_core::step::event::Position;
pub use stickslip_core::step::solver::PosedForm;

/// What the debugger asks. Each gets one answer, but for [`Request::Interrupt`] and [`Request::Bye`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Request {
    /// Who is there; answered by [`Answer::Hello`].
    Hello {
        /// The version that the debugger speaks.
        protocol: u32,
        /// The debugger's name.
        name: String,
        /// Its version.
        version: String,
    },
    /// What is solved; answered by [`Answer::Scene`].
    Scene,
    /// One iteration; answered by [`Answer::State`].
    Step,
    /// Force a contact into a mode; answered by [`Answer::Ok`].
    Force {
        /// The contact.
        contact: Id,
        /// The mode.
        mode: Mode,
        /// Whether it is held until released; else it is for the next iteration.
        #[serde(default)]
        hold: bool,
    },
    /// Give a contact back to the solver; answered by [`Answer::Ok`].
    Release {
        /// The contact.
        contact: Id,
    },
    /// Change a parameter; answered by [`Answer::Ok`].
    Set {
        /// Its name.
        name: String,
        /// Its value: a number, a flag or a text.
        value: Value,
    },
    /// Keep the present state; answered by [`Answer::Saved`].
    Save,
    /// Go to a state that was kept; answered by [`Answer::Ok`].
    Restore {
        /// What `saved` gave.
        token: Value,
    },
    /// The frozen interface problem; answered by [`Answer::Problem`].
    Problem,
    /// End the request at hand soon; not answered.
    Interrupt,
    /// End; not answered.
    Bye,
}

/// What the solver says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Answer {
    /// Who it is.
    Hello(Box<Hello>),
    /// What it solves.
    Scene(Box<Scene>),
    /// What an iteration did.
    State(Box<State>),
    /// Done as asked.
    Ok,
    /// Not done.
    Refused {
        /// Why.
        reason: String,
    },
    /// The present state is kept.
    Saved {
        /// By which it is found again.
        token: Value,
    },
    /// The frozen interface problem.
    Problem(Box<Problem>),
    /// Something for the user to read; no answer to anything.
    Message {
        /// How grave it is.
        #[serde(default)]
        level: Level,
        /// What it says.
        text: String,
    },
    /// The solver ends on its own.
    Bye {
        /// Why.
        #[serde(default)]
        reason: String,
    },
}

/// By what a solver calls a contact.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(untagged, expecting = "an id is a whole number or a text")]
pub enum Id {
    /// A number.
    Number(i64),
    /// A text.
    Text(String),
}

impl std::fmt::Display for Id {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Id::Number(number) => number.fmt(f),
            Id::Text(text) => text.fmt(f),
        }
    }
}

/// How grave a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Good to know.
    #[default]
    Info,
    /// Doubtful.
    Warning,
    /// Wrong.
    Error,
}

/// Who the solver is, and what it can do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// The version that it speaks.
    pub protocol: u32,
    /// Its name.
    pub name: String,
    /// Its version.
    #[serde(default)]
    pub version: String,
    /// What it offers.
    #[serde(default)]
    pub abilities: Abilities,
    /// By which rules it chooses modes, where the debugger is to check them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decides: Option<Decides>,
    /// What can be changed during a run.
    #[serde(default)]
    pub parameters: Vec<Parameter>,
}

/// What a solver offers; what is left out it does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Abilities {
    /// Modes can be forced for one iteration.
    pub force: bool,
    /// Modes can be held until released.
    pub hold: bool,
    /// Which states can be kept and gone back to.
    pub restore: Restore,
    /// The frozen interface problem can be asked for.
    pub problem: bool,
    /// It looks at its input while it works.
    pub interrupt: bool,
}

/// Which states can be kept and gone back to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Restore {
    /// None: going back starts the solver anew.
    #[default]
    None,
    /// The start, and those in which an increment was accepted.
    Increment,
    /// Every one.
    Any,
}

/// By which rules a solver chooses the next modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Decides {
    /// Table 2 of El-Sawy & Moore (1996).
    Table2,
    /// Newton's method on the projections, with [`State::spring`].
    Newton,
}

/// Something that can be changed during a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// What it is called. `increment`, `friction` and `cohesion` have a meaning.
    pub name: String,
    /// What values it takes.
    pub kind: ParameterKind,
    /// The value that it has.
    pub value: Value,
    /// The least; `None` is no bound.
    #[serde(default)]
    pub least: Option<f64>,
    /// The most; `None` is no bound.
    #[serde(default)]
    pub most: Option<f64>,
    /// What a choice is between.
    #[serde(default)]
    pub choices: Vec<String>,
    /// What it does, in a line.
    #[serde(default)]
    pub about: String,
}

/// What values a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ParameterKind {
    /// A float.
    Number,
    /// A whole number.
    Integer,
    /// True or false.
    Flag,
    /// One of some texts.
    Choice,
    /// A text.
    Text,
}

/// What is solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// One line.
    pub title: String,
    /// More for the reader.
    #[serde(default)]
    pub about: String,
    /// What there is to draw, and the contacts' nodes.
    pub nodes: Vec<Node>,
    /// Curves through nodes, by their place in `nodes`.
    #[serde(default)]
    pub lines: Vec<Vec<usize>>,
    /// Masters.
    #[serde(default)]
    pub surfaces: Vec<Surface>,
    /// The slave nodes.
    pub contacts: Vec<Contact>,
    /// Load factors between which the history goes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<[f64; 2]>,
    /// The numbers that states report.
    #[serde(default)]
    pub monitors: Vec<Monitor>,
    /// Whether states tell the arc along the path of equilibrium, which drives the history.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub arc: bool,
    /// Whether states tell the drag of damped motions.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub drag: bool,
}

/// A number that states report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "a monitor is a name, or an object with name and kind"
)]
pub enum Monitor {
    /// By its name alone.
    Name(String),
    /// With what it is.
    Kind {
        /// What the user reads.
        name: String,
        /// What it is.
        kind: ToldKind,
    },
}

/// A master surface: a chain of nodes, the outward side on the right of the walk.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// What the user reads.
    pub name: String,
    /// Places in [`Scene::nodes`].
    pub nodes: Vec<usize>,
    /// Whether it moves with no body.
    #[serde(default)]
    pub rigid: bool,
}

/// A slave node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// By what requests call it.
    pub id: Id,
    /// What the user reads; that of its node where it is left out.
    #[serde(default)]
    pub name: String,
    /// Place in [`Scene::nodes`].
    pub node: usize,
    /// Name of the surface that it may touch.
    #[serde(default)]
    pub surface: Option<String>,
    /// Coulomb's law at it.
    #[serde(default)]
    pub friction: Friction,
    /// Mode of the first iteration.
    #[serde(default)]
    pub mode: Mode,
    /// Tributary area (of the undeformed shape).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// Compliances in series along n and along t (length by force): what touches gives way, and penetrates by that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gives: Option<[f64; 2]>,
    /// Whether it is held at its point of the surface, in tension too.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tied: bool,
}

/// Coulomb's law: |F_t| <= mu F_n + cohesion.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Friction {
    /// Coefficient.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mu: Option<f64>,
    /// The same as an angle, in degrees; it goes before `mu`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle: Option<f64>,
    /// What friction gives without a normal force (force).
    #[serde(default)]
    pub cohesion: f64,
}

/// What an iteration did, and what is solved next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// The iteration.
    pub at: Position,
    /// Load factor at the end of its increment.
    #[serde(default)]
    pub load: Option<f64>,
    /// What ended with it.
    pub ended: Ended,
    /// Why, where something failed or was cut.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub reason: String,
    /// Size of the increment that is tried next, where it was cut (load factor).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<f64>,
    /// All contacts, in the order of the scene; none where the iteration could not be solved.
    pub contacts: Vec<Found>,
    /// Norms about which the iteration was solved.
    #[serde(default)]
    pub residual: Norms,
    /// Norms at the end of a major iteration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after: Option<Norms>,
    /// Of the scene's nodes, along x and y (length); as before where it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacements: Option<Vec<[f64; 2]>>,
    /// Stiffness that compares gaps with forces, for [`Decides::Newton`] (force by length).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spring: Option<f64>,
    /// The numbers that the scene named, where an increment was accepted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub monitors: Vec<Option<f64>>,
    /// Arc along the path, where the scene says that it is told.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arc: Option<f64>,
    /// Drag of the damped motion that it is a part of (force by length).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drag: Option<f64>,
}

/// What ended with an iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ended {
    /// Nothing else.
    Iteration,
    /// The major iteration.
    Equilibrium,
    /// The increment: it is accepted.
    Increment,
    /// The attempt: the increment starts again with another size.
    Cut,
    /// The increment: it failed.
    Failure,
    /// The increment is accepted, and the history is over.
    Done,
}

/// What an iteration found at a contact. `None` where the solver does not know a number, or it is infinite.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// The contact.
    pub id: Id,
    /// Mode of the solve that was made.
    pub mode: Mode,
    /// Mode of the next one.
    pub next: Mode,
    /// Gap after the solve (length), negative inside.
    #[serde(default)]
    pub gap: Option<f64>,
    /// Normal force, compression positive.
    #[serde(default)]
    pub f_n: Option<f64>,
    /// Tangential force along t.
    #[serde(default)]
    pub f_t: Option<f64>,
    /// T_max, with the sign of the friction force that a sliding node has.
    #[serde(default)]
    pub limit: Option<f64>,
    /// How far the surface has gone ahead of the node, along t (length).
    #[serde(default)]
    pub slip: Option<f64>,
    /// Why it takes its next mode: a row of Table 2 by its name, or words of the solver's own.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub rule: String,
    /// Signed distance from switching; positive kept the mode (force or length).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
    /// The inequalities that were tested.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tests: Vec<Test>,
    /// Mode that its rules want, where something else (a hold) had the last word.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wanted: Option<Mode>,
    /// T_max that the solve was made with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit_used: Option<f64>,
    /// Length of the surface to where the node stuck, with the sign of slip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<f64>,
    /// Outward normal of the master.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 2]>,
    /// The point of the master.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub foot: Option<[f64; 2]>,
    /// Half the angle (radians) between the normals of two sides that hold it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corner: Option<f64>,
    /// Whether a force component is left to the supports.
    #[serde(default, skip_serializing_if = "no")]
    pub carried: [bool; 2],
    /// Whether the mode of the solve, or the next, was forced from outside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forced: Option<Forced>,
    /// False past the ends of all surfaces: there is nothing to touch.
    #[serde(default = "yes", skip_serializing_if = "Clone::clone")]
    pub over: bool,
}

fn no(carried: &[bool; 2]) -> bool {
    *carried == [false; 2]
}

fn yes() -> bool {
    true
}

/// How a mode was forced from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Forced {
    /// For one iteration.
    Once,
    /// Until released.
    Held,
}

/// Sizes of what is not yet in balance; all but `force` and `scale` are relative.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Norms {
    /// Out-of-balance force over the force scale.
    pub relative: Option<f64>,
    /// Out-of-balance force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// Violation of the interface conditions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interface: Option<f64>,
    /// Displacement change in the last major iteration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction: Option<f64>,
    /// The force scale.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// What `relative` must not exceed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Round-off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<f64>,
}

/// The frozen interface problem: (gap, u) = W f + q, with f = (f_n, f_t) in total at the end of the increment and u the motion of
/// the node relative to its master along t since the increment began; u = 0 sticks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Problem {
    /// The contacts that take part, in the order of the pairs.
    pub contacts: Vec<Id>,
    /// What the matrix is.
    pub kind: PosedForm,
    /// Of size 2n.
    pub matrix: Matrix,
    /// Gap and motion without any force (length).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub q: Vec<f64>,
    /// In place of `q`, with a stiffness: f = K (gap, u) − load (force).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub load: Vec<f64>,
    /// Friction coefficient of each.
    pub mu: Vec<f64>,
    /// Cohesion of each (force); none where it is left out.
    #[serde(default)]
    pub cohesion: Vec<f64>,
}

/// A matrix, row by row or entry by entry.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Matrix {
    /// Rows.
    Rows(Vec<Vec<f64>>),
    /// Row, column (from 0) and value; entries of one place add up.
    Triplets {
        /// Rows and columns.
        size: usize,
        /// The entries.
        triplets: Vec<(usize, usize, f64)>,
    },
}

/// A number as it is sent: `None` for what JSON has no word for.
pub fn number(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

impl Answer {
    /// Its `type`.
    pub fn kind(&self) -> &'static str {
        match self {
            Answer::Hello(_) => "hello",
            Answer::Scene(_) => "scene",
            Answer::State(_) => "state",
            Answer::Ok => "ok",
            Answer::Refused { .. } => "refused",
            Answer::Saved { .. } => "saved",
            Answer::Problem(_) => "problem",
            Answer::Message { .. } => "message",
            Answer::Bye { .. } => "bye",
        }
    }
}
