//! Messages between debugger and solver. Units are the solver's; forces act on the slave node, and compression is positive.

pub use super::components::Components;
use serde::{Deserialize, Serialize};
use serde_json::Value;
pub use stickslip_core::contact::table2::Test;
pub use stickslip_core::model::{Mode, ReportedKind};
pub use stickslip_core::step::event::Position;
pub use stickslip_core::step::solver::ReportedForm;

/// A request from the debugger. Each has one answer, except [`Request::Interrupt`] and [`Request::Bye`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Request {
    /// Identify yourself; answered by [`Answer::Hello`].
    Hello {
        /// Oldest protocol version of the debugger.
        protocol: u32,
        /// All of its protocol versions.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        protocols: Vec<u32>,
        /// What it reads beyond version 1.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        reads: Vec<String>,
        /// The debugger's name.
        name: String,
        /// Its version.
        version: String,
    },
    /// Describe the scene; answered by [`Answer::Scene`].
    Scene,
    /// Perform one iteration; answered by [`Answer::State`].
    Step,
    /// Force a contact into a mode; answered by [`Answer::Ok`].
    Force {
        /// The contact.
        contact: Id,
        /// The mode.
        mode: Mode,
        /// Whether to hold it until it is released; otherwise only for the next iteration.
        #[serde(default)]
        hold: bool,
    },
    /// Release a forced contact; answered by [`Answer::Ok`].
    Release {
        /// The contact.
        contact: Id,
    },
    /// Change a parameter; answered by [`Answer::Ok`].
    Set {
        /// Its name.
        name: String,
        /// A number, a flag or a text.
        value: Value,
    },
    /// Save the current state; answered by [`Answer::Saved`].
    Save,
    /// Return to a saved state; answered by [`Answer::Ok`].
    Restore {
        /// The token from `saved`.
        token: Value,
    },
    /// Send the frozen interface problem; answered by [`Answer::Problem`].
    Problem,
    /// Stop the current request soon; not answered.
    Interrupt,
    /// Exit; not answered.
    Bye,
}

/// A message from the solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Answer {
    /// Identification of the solver.
    Hello(Box<Hello>),
    /// The scene.
    Scene(Box<Scene>),
    /// Result of an iteration.
    State(Box<State>),
    /// The request succeeded.
    Ok,
    /// The request was refused.
    Refused {
        /// Reason.
        reason: String,
    },
    /// The current state was saved.
    Saved {
        /// Token for restoring it.
        token: Value,
    },
    /// The frozen interface problem.
    Problem(Box<ProblemMessage>),
    /// Text for the user; not an answer to a request.
    Message {
        /// Severity.
        #[serde(default)]
        level: Level,
        /// The text.
        text: String,
    },
    /// How far the solver is with the current request; not an answer to it.
    Progress(Progress),
    /// The solver exits on its own.
    Bye {
        /// Reason.
        #[serde(default)]
        reason: String,
    },
}

/// Identifier of a contact.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(untagged, expecting = "an id is a whole number or a text")]
pub enum Id {
    /// A number.
    Number(i64),
    /// A text.
    Text(String),
}

impl Default for Id {
    fn default() -> Id {
        Id::Number(0)
    }
}

impl std::fmt::Display for Id {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Id::Number(number) => number.fmt(f),
            Id::Text(text) => text.fmt(f),
        }
    }
}

/// How far a solver is with a request.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// What it does.
    #[serde(default)]
    pub text: String,
    /// Units of work done.
    #[serde(default)]
    pub done: Option<f64>,
    /// All units.
    #[serde(default)]
    pub of: Option<f64>,
}

/// Severity of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Information.
    #[default]
    Info,
    /// A possible problem.
    Warning,
    /// A definite problem.
    Error,
}

/// Identity and abilities of the solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// Protocol version of the solver's messages.
    pub protocol: u32,
    /// All versions that the solver supports; may be empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub protocols: Vec<u32>,
    /// Its name.
    pub name: String,
    /// Its version.
    #[serde(default)]
    pub version: String,
    /// Supported features.
    #[serde(default)]
    pub abilities: Abilities,
    /// The rules by which it chooses modes, if the debugger should check them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decides: Option<Decides>,
    /// Parameters that can be changed during a run.
    #[serde(default)]
    pub parameters: Vec<ParameterMessage>,
}

/// Optional features of a solver; omitted ones are not supported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Abilities {
    /// Can force a mode for one iteration.
    pub force: bool,
    /// Can hold a mode until it is released.
    pub hold: bool,
    /// States that can be saved and restored.
    pub restore: Restore,
    /// Can send the frozen interface problem.
    pub problem: bool,
    /// Reads its input while it works.
    pub interrupt: bool,
    /// States may leave out contacts that did not change.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub partial: bool,
}

/// States that can be saved and restored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Restore {
    /// None: going back restarts the solver.
    #[default]
    None,
    /// The start, and states in which an increment was accepted.
    Increment,
    /// Every state.
    Any,
}

/// Rules by which a solver chooses the next modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Decides {
    /// Table 2 of El-Sawy & Moore (1996).
    Table2,
    /// Newton's method on the projected forces, with [`State::spring`].
    Newton,
}

/// A parameter that can be changed during a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterMessage {
    /// Its name. `increment`, `friction` and `cohesion` have a predefined meaning.
    pub name: String,
    /// Kind of value.
    pub kind: ParameterKind,
    /// Current value.
    pub value: Value,
    /// Lower bound; `None` if there is none.
    pub least: Option<f64>,
    /// Upper bound; `None` if there is none.
    pub most: Option<f64>,
    /// The options of a choice.
    #[serde(default)]
    pub choices: Vec<String>,
    /// One-line description.
    #[serde(default)]
    pub about: String,
    /// Whether it changes how the solver iterates, but not the answer; remedies try smaller values.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tunes: bool,
}

/// Kind of a parameter's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ParameterKind {
    /// A float.
    Number,
    /// A whole number.
    Integer,
    /// True or false.
    Flag,
    /// One of several texts.
    Choice,
    /// A text.
    Text,
}

/// The scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// One-line title.
    pub title: String,
    /// Description for the reader.
    #[serde(default)]
    pub about: String,
    /// Number of coordinates: 2 or 3.
    #[serde(default = "count::<2>", skip_serializing_if = "is_count::<2>")]
    pub dimension: usize,
    /// File with the mesh, whose nodes precede `nodes`; only in the message of a running solver.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<String>,
    /// Nodes for drawing, including those of the contacts.
    #[serde(default)]
    pub nodes: Vec<NodeMessage>,
    /// Curves through nodes, as indices into `nodes`.
    #[serde(default)]
    pub lines: Vec<Vec<usize>>,
    /// Faces to draw, as their corners in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faces: Vec<Vec<usize>>,
    /// Masters.
    #[serde(default)]
    pub surfaces: Vec<SurfaceMessage>,
    /// The slave nodes.
    pub contacts: Vec<Contact>,
    /// Load factors at the start and at the end of the history.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<[f64; 2]>,
    /// Numbers that states report.
    #[serde(default)]
    pub monitors: Vec<Monitor>,
    /// Whether states report the arc along the equilibrium path, which drives the history.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub arc: bool,
    /// Whether states report the drag of damped motions.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub drag: bool,
}

fn count<const N: usize>() -> usize {
    N
}

fn is_count<const N: usize>(count: &usize) -> bool {
    *count == N
}

/// A node in the reference configuration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NodeMessage {
    /// Name shown to the user; generated if it is empty.
    #[serde(default)]
    pub name: String,
    /// Position (length), two or three coordinates; `None` if only its motion is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<Components>,
}

/// A number that states report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "a monitor must be a name, or an object with name and kind"
)]
pub enum Monitor {
    /// Only a name.
    Name(String),
    /// With its kind.
    Kind {
        /// Name shown to the user.
        name: String,
        /// Kind of number.
        kind: ReportedKind,
    },
}

/// A master surface: in the plane a chain of nodes with the outward side on the right of the walk, in space faces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SurfaceMessage {
    /// Name shown to the user.
    pub name: String,
    /// The chain, as indices into [`Scene::nodes`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub nodes: Vec<usize>,
    /// The faces, each as its corners in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faces: Vec<Vec<usize>>,
    /// Whether the surface is fixed.
    #[serde(default)]
    pub rigid: bool,
}

/// A slave node.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Contact {
    /// Identifier used in requests.
    pub id: Id,
    /// Name shown to the user; by default that of its node.
    #[serde(default)]
    pub name: String,
    /// Index into [`Scene::nodes`].
    pub node: usize,
    /// Name of the surface that it may touch.
    pub surface: Option<String>,
    /// Coulomb's law.
    #[serde(default)]
    pub friction: Friction,
    /// Mode of the first iteration.
    #[serde(default)]
    pub mode: Mode,
    /// Undeformed tributary area.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// Compliances in series along n and t (length per force); a touching node penetrates by compliance times force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gives: Option<[f64; 2]>,
    /// Whether it is tied to its point of the surface, in tension too.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tied: bool,
}

/// Coulomb's law: |F_t| <= mu F_n + cohesion.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Friction {
    /// Coefficient.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<f64>,
    /// The same as an angle in degrees; takes precedence over `mu`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<f64>,
    /// Friction without a normal force (force).
    #[serde(default)]
    pub cohesion: f64,
}

/// Result of an iteration, and modes of the next one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Number of the iteration.
    pub at: Position,
    /// Load factor at the end of the increment.
    pub load: Option<f64>,
    /// The level that ended with this iteration.
    pub ended: EndedLevel,
    /// Reason of a failure or cut.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub reason: String,
    /// Size of the next increment after a cut (load factor).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<f64>,
    /// All contacts in scene order; empty if the iteration could not be solved.
    pub contacts: Vec<ContactResult>,
    /// Norms before the solve.
    #[serde(default)]
    pub residual: NormsMessage,
    /// Norms at the end of a major iteration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<NormsMessage>,
    /// Displacements of the scene's nodes along the axes (length); unchanged if omitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacements: Option<Vec<Components>>,
    /// Stiffness that relates gaps to forces, for [`Decides::Newton`] (force per length).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spring: Option<f64>,
    /// Values of the scene's monitors, if an increment was accepted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub monitors: Vec<Option<f64>>,
    /// Arc along the path, if the scene declares it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arc: Option<f64>,
    /// Drag of the current damped motion (force per length).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drag: Option<f64>,
}

/// The level that ended with an iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EndedLevel {
    /// Only the iteration.
    Iteration,
    /// The major iteration.
    Equilibrium,
    /// The increment was accepted.
    Increment,
    /// The attempt was cut: the increment restarts with a different size.
    Cut,
    /// The increment failed.
    Failure,
    /// The increment was accepted and the history is complete.
    Done,
}

/// Result of an iteration at a contact. `None` if a number is unknown or infinite.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ContactResult {
    /// The contact; by default the one at the same position of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<Id>,
    /// Mode used in this solve.
    pub mode: Mode,
    /// Mode of the next solve.
    pub next: Mode,
    /// Gap after the solve (length); negative is penetration.
    pub gap: Option<f64>,
    /// Normal force; compression is positive.
    pub f_n: Option<f64>,
    /// Tangential force along t; in space along t and n × t.
    pub f_t: Option<Components>,
    /// T_max, with the sign of the friction force on a sliding node; in space the radius of the friction cone at this `f_n`.
    pub limit: Option<f64>,
    /// Motion of the surface relative to the node along t (length); in space along t and n × t.
    pub slip: Option<Components>,
    /// Rule that selected the next mode: the name of a row of Table 2, or the solver's own text.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub rule: String,
    /// Signed distance from switching; positive if the mode is kept (force or length).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
    /// The tested inequalities.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tests: Vec<Test>,
    /// Mode selected by the rules, if it was overridden (by a hold).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wanted: Option<Mode>,
    /// T_max used in this solve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_used: Option<f64>,
    /// Distance along the surface from the stick point, with the sign of slip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift: Option<f64>,
    /// Outward normal of the master.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<Components>,
    /// In space the unit vector t; by default the projection of the x axis, or of the y axis if n is nearly along x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tangent: Option<Components>,
    /// The closest point on the master.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub foot: Option<Components>,
    /// Half the angle (radians) between the normals of the two sides of a corner that holds the node.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corner: Option<f64>,
    /// Whether the supports carry a force component.
    #[serde(default, skip_serializing_if = "no")]
    pub carried: [bool; 2],
    /// Whether the mode of this or the next solve was forced from outside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forced: Option<Forced>,
    /// False beyond the ends of all surfaces, where no contact is possible.
    #[serde(default = "yes", skip_serializing_if = "Clone::clone")]
    pub over: bool,
}

impl State {
    /// Adds the contacts that the message leaves out: they keep the numbers of `before`, and their next mode. Returns the contacts
    /// that the next state may leave out.
    ///
    /// # Errors
    /// If a contact has no id, is not in the order of `ids`, or is left out before it was reported.
    pub fn complete(
        &mut self,
        ids: &[Id],
        before: &[ContactResult],
    ) -> Result<Vec<ContactResult>, String> {
        let unsolved = matches!(self.ended, EndedLevel::Cut | EndedLevel::Failure);
        if self.contacts.is_empty() && unsolved {
            return Ok(before.to_vec());
        }
        if self.contacts.len() < ids.len() {
            let mut sent = std::mem::take(&mut self.contacts).into_iter().peekable();
            for (k, id) in ids.iter().enumerate() {
                let found = sent.next_if(|found| found.id.as_ref() == Some(id));
                let kept = || before.get(k).map(ContactResult::unchanged);
                let found = found.or_else(kept);
                self.contacts
                    .push(found.ok_or_else(|| format!("contact {id} has not been reported yet"))?);
            }
            if let Some(other) = sent.next() {
                let id = other.label();
                return Err(format!(
                    "contact {id:?} is not in the scene, or not in its order; a state without all contacts needs their ids"
                ));
            }
        }
        Ok(self.contacts.clone())
    }

    /// Enters the ids of contacts that have none.
    pub fn fill_ids<'a>(&mut self, ids: impl Iterator<Item = &'a Id>) {
        for (found, id) in self.contacts.iter_mut().zip(ids) {
            found.id.get_or_insert_with(|| id.clone());
        }
    }
}

impl ContactResult {
    /// The same numbers after another iteration.
    fn unchanged(&self) -> ContactResult {
        ContactResult {
            mode: self.next,
            wanted: None,
            forced: self.forced.filter(|forced| *forced == Forced::Held),
            ..self.clone()
        }
    }

    /// The id for messages to the user.
    pub fn label(&self) -> String {
        self.id.as_ref().map(Id::to_string).unwrap_or_default()
    }
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
    /// Until it is released.
    Held,
}

/// Residual norms; all except `force` and `scale` are relative.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct NormsMessage {
    /// Out-of-balance force divided by the force scale.
    pub relative: Option<f64>,
    /// Out-of-balance force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// Violation of the interface conditions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interface: Option<f64>,
    /// Displacement correction of the last major iteration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction: Option<f64>,
    /// The force scale.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// Tolerance for `relative`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Round-off level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<f64>,
}

/// The frozen interface problem: (gap, u) = W f + q, with the total forces f = (f_n, f_t) at the end of the increment and the
/// motion u of the node relative to its master along t since the start of the increment; u = 0 for stick. In space f_t and u have
/// two components.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProblemMessage {
    /// The participating contacts, in the order of the rows.
    pub contacts: Vec<Id>,
    /// Number of tangential components: 1 or 2.
    #[serde(default = "count::<1>", skip_serializing_if = "is_count::<1>")]
    pub tangents: usize,
    /// Kind of matrix.
    pub kind: ReportedForm,
    /// The matrix, with `1 + tangents` rows per contact.
    pub matrix: MatrixMessage,
    /// Gap and motion without forces (length).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub q: Vec<f64>,
    /// Replaces `q` for a stiffness: f = K (gap, u) − load (force).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub load: Vec<f64>,
    /// Friction coefficient of each contact.
    pub mu: Vec<f64>,
    /// Cohesion of each contact (force); 0 if omitted.
    #[serde(default)]
    pub cohesion: Vec<f64>,
}

/// A matrix, by rows or by entries.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum MatrixMessage {
    /// Rows.
    Rows(Vec<Vec<f64>>),
    /// Row, column (from 0) and value; duplicate entries are added.
    Triplets {
        /// Number of rows and columns.
        size: usize,
        /// The entries.
        triplets: Vec<(usize, usize, f64)>,
    },
}

/// A number for JSON: `None` if it is not finite.
pub fn number(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

impl Answer {
    /// The value of its `type` field.
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
            Answer::Progress(_) => "progress",
            Answer::Bye { .. } => "bye",
        }
    }
}
