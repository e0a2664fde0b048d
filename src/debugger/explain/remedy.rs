//! Remedies for an increment that fails, with their names and what to type to apply them.
//!
//! A remedy consists of interventions before the first minor iteration (a consistent state of the census,
//! another strategy or setting, another increment size, other initial modes) and possibly hysteresis, which
//! corrects the decisions after each one. [`super::remedies`] tries them; [`super::advice`] selects them by the
//! kind of failure.

use super::examination::Examination;
use super::names;
use super::strain::{self, MaterialCause};
use stickslip_core::contact::projection::projection_at;
use stickslip_core::step::intervene::Value;
use stickslip_core::{Failure, InitialGaps, Intervention, Jumps, Mode, Model, Parameter, State};
use stickslip_scene::format::paths;
use stickslip_scene::gaps::{StartGaps, start_gaps, turned};
use stickslip_scene::{Spec, joined, number};

/// Factor by which iteration limits are raised.
const MORE: u32 = 10;

/// Kind of remedy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RemedyKind {
    /// Start from the consistent state with this number in the census.
    Answer(usize),
    /// A setting: label, path and value.
    Set(&'static str, &'static str, &'static str),
    /// This fraction of the increment.
    Part(f64),
    /// More minor iterations.
    MoreMinors,
    /// More major iterations.
    MoreMajors,
    /// A smaller value of a parameter of an attached solver.
    Tuned,
    /// Start the nodes on their surface in this mode; if there are none, the closest node.
    Start(Mode),
    /// Nodes keep their mode as long as they violate its condition only slightly.
    Hysteresis,
    /// Treatment of nodes that start inside their surface; tried from the start of the scene.
    Gaps(&'static str),
    /// The surface with this number the other way round; tried from the start of the scene.
    Reverse(usize),
    /// The surface with this number continued past its ends; tried from the start of the scene.
    PastEnds(usize),
    /// The surface with this number as a smooth curve; tried from the start of the scene.
    Smooth(usize),
    /// Another treatment of increments that jump to another branch; tried from the start of the scene.
    Jumps(&'static str, &'static str),
    /// Every generated element divided in two; tried from the start of the scene.
    Finer,
    /// A material law whose range contains the state of a solid; tried from the start of the scene.
    Law,
}

/// The strategies that are advised.
pub(super) const LADDER: RemedyKind =
    RemedyKind::Set("the ladder of strategies", "settings.strategy", "ladder");
pub(super) const NEWTON: RemedyKind =
    RemedyKind::Set("semismooth Newton", "settings.strategy", "newton");
pub(super) const BLOCK: RemedyKind = RemedyKind::Set(
    "block changes, least-index fallback",
    "settings.strategy",
    "block",
);
/// T_max in the matrix.
pub(super) const CONSISTENT_LIMIT: RemedyKind =
    RemedyKind::Set("t_max consistent", "settings.t_max", "consistent");
/// A tangent that includes the change of geometry.
pub(super) const CONSISTENT_GEOMETRY: RemedyKind =
    RemedyKind::Set("geometry consistent", "settings.geometry", "consistent");
/// Residuals from stresses.
pub(super) const STRESS_RESIDUAL: RemedyKind =
    RemedyKind::Set("residual stress", "settings.residual", "stress");
/// Hold nodes in new contact where they were.
pub(super) const TOUCH_AT_START: RemedyKind =
    RemedyKind::Set("touch at the start", "settings.touch", "start");
/// Solve half the load first after a cycle.
pub(super) const DAMP: RemedyKind = RemedyKind::Set("at_cycle damp", "settings.at_cycle", "damp");
/// Search for a way out.
pub(super) const RAMP: RemedyKind = RemedyKind::Gaps("ramp");
pub(super) const ADJUST: RemedyKind = RemedyKind::Gaps("adjust");
pub(super) const CUT_AT_JUMPS: RemedyKind =
    RemedyKind::Jumps("history.jumps: cut (continues on the other branch)", "cut");
pub(super) const MOVE_AT_JUMPS: RemedyKind = RemedyKind::Jumps(
    "history.jumps: dynamic (a damped motion to the next equilibrium)",
    "dynamic",
);
pub(super) const SEARCH: RemedyKind = RemedyKind::Set("search", "settings.search", "auto");

/// What to type to apply a remedy.
#[derive(Debug, Clone, PartialEq)]
pub enum RemedyInput {
    /// A setting: path and value.
    Set(&'static str, String),
    /// An increment size.
    Increment(f64),
    /// The leg and the increment size, if each leg of the path has its own size.
    IncrementOn(usize, f64),
    /// A parameter of an attached solver, and its value.
    Parameter(String, f64),
    /// Number of a consistent state in the census, from 0.
    StartFrom(usize),
    /// Values to change in the scene, by path, for a restart.
    Restart(Vec<(String, String)>),
    /// Available only in the list of remedies.
    Listed,
}

impl RemedyInput {
    /// The entry of the scene file that it changes, if it is a single one.
    pub fn scene_entry(&self) -> Option<String> {
        match self {
            RemedyInput::Set(path, value) => {
                let key = path.strip_prefix("settings.")?;
                Some(format!("settings: ({key}: {value}),"))
            }
            RemedyInput::Increment(size) => Some(format!(
                "history: (increment: {}),",
                number::shortest(*size)
            )),
            _ => None,
        }
    }

    /// What to type in the debugger.
    pub fn typed(&self) -> String {
        match self {
            RemedyInput::Set(path, value) => format!(":set {path} {value}"),
            RemedyInput::Parameter(name, value) => {
                format!(":set {name} {}", number::shortest(*value))
            }
            RemedyInput::Increment(size) | RemedyInput::IncrementOn(_, size) => {
                format!(":increment {}", number::shortest(*size))
            }
            RemedyInput::StartFrom(answer) => format!(":start-from {}", answer + 1),
            RemedyInput::Restart(changes) => joined(
                changes
                    .iter()
                    .map(|(path, value)| format!("--set {path}={value}")),
                " ",
            ),
            RemedyInput::Listed => "r, then select it and press Enter".into(),
        }
    }
}

/// A remedy at a state.
#[derive(Debug, Clone, PartialEq)]
pub struct Remedy {
    /// What kind it is.
    pub kind: RemedyKind,
    /// Short name, also used for its branch.
    pub label: String,
    /// What to type to apply it.
    pub how: RemedyInput,
    /// Interventions before the first minor iteration.
    pub first: Vec<Intervention>,
}

impl Remedy {
    /// The remedy that starts nodes in contact in another mode than their surface's; `None` if they have it.
    pub fn touching(state: &State, mode: Mode) -> Option<Remedy> {
        let first: Vec<Intervention> = state
            .nodes
            .iter()
            .enumerate()
            .filter(|(_, node)| node.mode != Mode::Free && node.mode != mode)
            .map(|(slave, _)| Intervention::Force {
                slave,
                mode,
                hold: false,
            })
            .collect();
        (!first.is_empty()).then(|| Remedy {
            kind: RemedyKind::Start(mode),
            label: format!("start contacts {}", mode.word()),
            how: RemedyInput::Listed,
            first,
        })
    }

    /// A tenth and a hundredth of a parameter of an attached solver that changes only how it iterates.
    pub fn tuned(parameter: &Parameter) -> Vec<Remedy> {
        let now = match parameter.value {
            Value::Number(now) if parameter.tunes && now != 0.0 => now,
            _ => return Vec::new(),
        };
        let remedy = |value: f64| Remedy {
            kind: RemedyKind::Tuned,
            label: format!("{} {}", parameter.name, number::shortest(value)),
            how: RemedyInput::Parameter(parameter.name.clone(), value),
            first: vec![Intervention::Parameter {
                name: parameter.name.clone(),
                value: Value::Number(value),
            }],
        };
        vec![remedy(now / 10.0), remedy(now / 100.0)]
    }

    /// The remedy of a kind at a state; `None` if it would change nothing or does not apply.
    pub fn from_kind(kind: RemedyKind, model: &Model, state: &State) -> Option<Remedy> {
        let remedy = |label: &str, how: RemedyInput, first: Vec<Intervention>| Remedy {
            kind,
            label: label.to_owned(),
            how,
            first,
        };
        let set = |label: &str, path: &'static str, value: String| {
            let settings = state.controls.settings;
            let mut spec = Spec {
                settings,
                ..Spec::default()
            };
            paths::set(&mut spec, path, &value).ok()?;
            let first = vec![Intervention::Settings(spec.settings)];
            (spec.settings != settings).then(|| remedy(label, RemedyInput::Set(path, value), first))
        };
        match kind {
            RemedyKind::Answer(_) | RemedyKind::Finer | RemedyKind::Law | RemedyKind::Tuned => None,
            RemedyKind::Reverse(surface) => {
                let name = &model.surfaces.get(surface)?.name;
                let label = format!("reverse surface {name}");
                let how = of_surface(model, name, "reverse", "true");
                Some(remedy(&label, how, Vec::new()))
            }
            RemedyKind::PastEnds(surface) => {
                let surface = model.surfaces.get(surface)?;
                let name = &surface.name;
                let label = format!("continue surface {name} past its ends");
                let how = of_surface(model, name, "past_ends", "0.5");
                let ends = surface.past_ends.contains(&0.0);
                ends.then(|| remedy(&label, how, Vec::new()))
            }
            RemedyKind::Smooth(surface) => {
                let surface = model.surfaces.get(surface)?;
                let label = format!("surface {} without kinks", surface.name);
                let how = of_surface(model, &surface.name, "smooth", "true");
                let has_kinks = surface.smooth.is_empty() && surface.elements.len() > 1;
                has_kinks.then(|| remedy(&label, how, Vec::new()))
            }
            RemedyKind::Gaps(gaps) => {
                // Only the first increment starts with the overlap.
                let starts = state.next.increment == 1;
                let keeps = model.settings.initial_gaps == InitialGaps::Keep;
                let inside = |found: &StartGaps| !found.inside.is_empty();
                let label = format!("initial_gaps: {gaps}");
                let how = restarted("settings.initial_gaps", gaps);
                let overlaps = starts && keeps && start_gaps(model).iter().any(inside);
                // If a surface has the wrong orientation, all nodes are inside.
                (overlaps && turned(model).is_empty()).then(|| remedy(&label, how, Vec::new()))
            }
            RemedyKind::Jumps(label, jumps) => {
                let how = restarted("history.jumps", jumps);
                (model.jumps == Jumps::Stop).then(|| remedy(label, how, Vec::new()))
            }
            RemedyKind::Hysteresis => Some(remedy(
                "hysteresis of 1e-3",
                RemedyInput::Listed,
                Vec::new(),
            )),
            RemedyKind::Part(part) => {
                let size = state.controls.increment * part;
                let label = match part {
                    0.5 => "half the increment".to_owned(),
                    0.1 => "a tenth of the increment".to_owned(),
                    part => format!("{part} of the increment"),
                };
                let first = vec![Intervention::Increment(size)];
                let how = if model.increments.is_empty() {
                    RemedyInput::Increment(size)
                } else {
                    RemedyInput::IncrementOn(state.start.leg, size)
                };
                Some(remedy(&label, how, first))
            }
            RemedyKind::Start(mode) => {
                let first = starts(model, state, mode);
                let label = format!("start contacts {}", mode.word());
                (!first.is_empty()).then(|| remedy(&label, RemedyInput::Listed, first))
            }
            RemedyKind::Set(label, path, value) => set(label, path, value.to_owned()),
            RemedyKind::MoreMinors => {
                let most = state.controls.settings.minors.saturating_mul(MORE);
                set(
                    "10 times the minor limit",
                    "settings.minors",
                    most.to_string(),
                )
            }
            RemedyKind::MoreMajors => {
                let most = state.controls.settings.majors.saturating_mul(MORE);
                set(
                    "10 times the major limit",
                    "settings.majors",
                    most.to_string(),
                )
            }
        }
    }

    /// A scene with twice its refinement.
    pub fn finer(spec: &Spec) -> Remedy {
        Remedy {
            kind: RemedyKind::Finer,
            label: "a finer mesh".to_owned(),
            how: restarted("refine", &(2 * spec.refine).to_string()),
            first: Vec::new(),
        }
    }

    /// Another law for materials outside the range of theirs in a failed state, and whether the law is
    /// certainly the cause. `None` if all are inside.
    pub fn law(model: &Model, state: &State, failure: &Failure) -> Option<(Remedy, bool)> {
        let cause = MaterialCause::find(model, state, failure)?;
        let points = cause.before.into_iter().chain([cause.point]);
        let mut changes: Vec<(String, String)> = Vec::new();
        for change in points.filter_map(|point| strain::other_law(model, &point)) {
            if !changes.contains(&change) {
                changes.push(change);
            }
        }
        let label = changes.first().map(|(path, value)| {
            let (_, field) = path.rsplit_once('.').unwrap_or(("", path));
            format!("{field}: {value}")
        })?;
        let law = Remedy {
            kind: RemedyKind::Law,
            label,
            how: RemedyInput::Restart(changes),
            first: Vec::new(),
        };
        Some((law, cause.is_certain()))
    }

    /// The remedies that start from each consistent state found.
    pub fn answers(model: &Model, found: &Examination) -> Vec<Remedy> {
        let count = found.census.as_ref().map_or(0, |c| c.answers.len());
        let answer = |number: usize| {
            let starts = found.starts(number)?;
            let some = names::starts(model, &starts, 2);
            Some(Remedy {
                kind: RemedyKind::Answer(number),
                label: format!("state {}: {some}", number + 1),
                how: RemedyInput::StartFrom(number),
                first: vec![Intervention::Assume(starts)],
            })
        };
        (0..count).filter_map(answer).collect()
    }
}

/// What to type for a value that is set from the start of the scene.
fn restarted(path: &str, value: &str) -> RemedyInput {
    RemedyInput::Restart(vec![(path.to_owned(), value.to_owned())])
}

/// A changed field of a surface, or of the scene's surface of which it is a piece, `ID.1`, `ID.2`, ….
fn of_surface(model: &Model, name: &str, field: &str, value: &str) -> RemedyInput {
    let pieces = |id: &str| {
        let has = |piece: &str| model.surfaces.iter().any(|s| s.name == piece);
        has(&format!("{id}.1")) && has(&format!("{id}.2"))
    };
    let id = match name.rsplit_once('.') {
        Some((id, _)) if pieces(id) => id,
        _ => name,
    };
    restarted(&format!("surfaces.{id}.{field}"), value)
}

/// Initial modes to restart the increment with: for the nodes on their surface, or else for the closest one.
fn starts(model: &Model, state: &State, mode: Mode) -> Vec<Intervention> {
    let places = model.places(&state.start.u);
    let gaps: Vec<(usize, f64)> = (0..model.contacts.len())
        .filter_map(|slave| {
            let contact = &model.contacts[slave];
            let spot = state.start.nodes[slave].spot?;
            let found = projection_at(&model.surfaces, spot, &places, places[contact.node]);
            Some((slave, found.gap))
        })
        .collect();
    let touches = |gap: f64| gap <= TOUCHES * model.length;
    let mut chosen: Vec<usize> = gaps
        .iter()
        .filter(|(_, gap)| touches(*gap))
        .map(|(slave, _)| *slave)
        .collect();
    if chosen.is_empty() {
        let nearest = gaps.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        chosen.extend(nearest.map(|(slave, _)| *slave));
    }
    let forced = chosen
        .into_iter()
        .filter(|slave| state.start.nodes[*slave].mode != mode)
        .map(|slave| Intervention::Force {
            slave,
            mode,
            hold: false,
        });
    let mut all = vec![Intervention::Increment(state.controls.increment)];
    all.extend(forced);
    if all.len() == 1 { Vec::new() } else { all }
}

/// A node closer to its surface than this fraction of the scene's length is on it.
const TOUCHES: f64 = 1e-6;
