//! Snapshots: recorded states in self-contained RON files, which can be recomputed and compared.
//!
//! A snapshot contains the scene, the interventions with the minor iterations at which they happened, and the
//! resulting state. Recomputing starts the scene and repeats the steps; it does not use the recorded state.
//! Floats are written so that they read back to the same bits, including NaN and the infinities.

use crate::history::strip::norms_after;
use crate::record::journal::{check_format, numbered};
use crate::refusal::refused_by;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stickslip_core::step::drive::drive;
use stickslip_core::{
    Event, Forced, Intervention, Mode, Model, Norms, Position, Rule, RunEnd, Solver, SolverLost,
    State, Status, Until, counted,
};
use stickslip_platform::disk;
use stickslip_platform::files::{self, FileError};
use stickslip_platform::input::{self, RECORD_BYTES};
use stickslip_scene::format::error::at;
use stickslip_scene::format::{notation, read};
use stickslip_scene::readers::or_mistaken;
use stickslip_scene::solver::any_solver;
use stickslip_scene::{FileKind, Scene, SceneError, Spec};

/// Format version written by this program, and the only one it reads.
pub const FORMAT: u32 = 1;

/// A recorded state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Snapshot {
    /// Format version.
    pub format: u32,
    /// Name of the scene.
    pub name: String,
    /// The whole scene, with all `--set` overrides.
    pub scene: Spec,
    /// Interventions in order.
    pub interventions: Vec<AppliedIntervention>,
    /// Number of minor iterations.
    pub steps: u64,
    /// The last minor iteration; the first one to be solved if there is none.
    pub position: Position,
    /// The resulting state.
    pub state: Recorded,
}

/// An intervention, and the number of minor iterations before it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AppliedIntervention {
    /// Number of minor iterations before it.
    pub step: u64,
    /// The intervention.
    pub intervention: Intervention,
}

/// The state after a minor iteration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Load factor at the end of the last minor iteration's increment.
    pub load_factor: f64,
    /// Status of the run.
    pub status: Status,
    /// Residual at the start of the last major iteration.
    pub before: Option<Norms>,
    /// Residual at its end, if it has ended.
    pub after: Option<Norms>,
    /// One entry per slave node, in the order of the scene.
    pub slaves: Vec<SlaveRecord>,
    /// One entry per moving node.
    pub displacements: Vec<Displacement>,
    /// Shear forces of shear-rigid beams, body by body.
    pub shear: Vec<f64>,
}

/// A slave node after the last minor iteration. Forces act on the slave node; compression is positive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlaveRecord {
    /// Name of the node.
    pub node: String,
    /// Mode of the last minor iteration.
    pub mode: Mode,
    /// Mode of the next one.
    pub next: Mode,
    /// The cell of Table 2 that applied, named as in traces; `None` if nothing was solved.
    #[serde(with = "rule_name")]
    pub rule: Option<Rule>,
    /// Gap, negative for penetration; `None` if nothing was solved.
    pub gap: Option<f64>,
    /// Normal force; compression is positive.
    pub f_n: f64,
    /// Tangential force.
    pub f_t: f64,
    /// The friction bound T_max, force.
    pub t_max: f64,
    /// Slip, length.
    pub slip: f64,
    /// Whether the user forced its mode.
    pub forced: Forced,
}

/// A rule by name, as a string because RON has no bare words with hyphens.
mod rule_name {
    use serde::de::IntoDeserializer;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use stickslip_core::contact::table2::Rule;

    pub fn serialize<S: Serializer>(rule: &Option<Rule>, to: S) -> Result<S::Ok, S::Error> {
        rule.map(Rule::name).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Rule>, D::Error> {
        let name = Option::<String>::deserialize(from)?;
        name.map(|name| Rule::deserialize(name.as_str().into_deserializer()))
            .transpose()
    }
}

/// Displacement of a node at the start of the next major iteration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Displacement {
    /// Name of the node.
    pub node: String,
    /// Along x, length.
    pub x: f64,
    /// Along y, length.
    pub y: f64,
    /// Rotation, for beam nodes only.
    pub rotation: Option<f64>,
}

/// Why a snapshot cannot be written, read or recomputed.
#[derive(Debug, thiserror::Error)]
pub enum SnapshotError {
    /// The file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file cannot be read, is not a snapshot, or is damaged.
    #[error(transparent)]
    Read(Box<SceneError>),
    /// The state cannot be written as text.
    #[error("the snapshot cannot be written as text: {0}")]
    Unwritable(ron::Error),
    /// The snapshot's scene is invalid.
    #[error("the snapshot's scene is invalid: {0}")]
    Scene(#[from] SceneError),
    /// The snapshot belongs to an attached solver.
    #[error(
        "the snapshot was taken from the attached solver {name}; use stickslip replay FILE -- COMMAND"
    )]
    Attached {
        /// Name of the solver.
        name: String,
    },
    /// The steps cannot be repeated.
    #[error("the snapshot cannot be recomputed: {0}")]
    Replay(String),
}

refused_by!(SnapshotError);

impl Snapshot {
    /// Records a state. `applied` are the interventions so far, `steps` is the number of minor iterations, and
    /// `event` the last one.
    pub fn take(
        scene: &Scene,
        applied: &[AppliedIntervention],
        steps: u64,
        state: &State,
        event: Option<&Event>,
    ) -> Snapshot {
        Snapshot {
            format: FORMAT,
            name: scene.name.clone(),
            scene: scene.spec.clone(),
            interventions: applied.to_vec(),
            steps,
            position: event.map_or(state.next, |e| e.position),
            state: Recorded::new(&scene.model, state, event),
        }
    }

    /// The snapshot as text.
    ///
    /// # Errors
    /// If it cannot be represented in RON; no such snapshot is known.
    pub fn to_text(&self) -> Result<String, SnapshotError> {
        let layout = ron::ser::PrettyConfig::new()
            .new_line("\n")
            // Tables of slaves and nodes: one row per line.
            .depth_limit(3);
        let text = notation::lines(self, layout).map_err(SnapshotError::Unwritable)?;
        Ok(text + "\n")
    }

    /// Writes the snapshot to a file, completely or not at all.
    ///
    /// # Errors
    /// If the file exists and `overwrite` is not set, or cannot be written.
    pub fn write(&self, path: &Path, overwrite: bool) -> Result<(), SnapshotError> {
        Ok(files::write(path, &self.to_text()?, overwrite)?)
    }

    /// Reads a snapshot from a file.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged, or has an unknown format.
    pub fn read(path: &Path) -> Result<Snapshot, SnapshotError> {
        let file = path.display().to_string();
        let text = input::text(path, RECORD_BYTES, "too large for a snapshot")
            .map_err(|why| SnapshotError::Read(Box::new(read::not_read(&file, &why))))?;
        Snapshot::from_text(&file, &text)
    }

    /// Reads a snapshot from text; `file` is its name for messages.
    ///
    /// # Errors
    /// If the text is damaged, or has an unknown format.
    pub fn from_text(file: &str, text: &str) -> Result<Snapshot, SnapshotError> {
        let text = text.strip_prefix(input::MARK).unwrap_or(text);
        let read = || {
            read::shallow(file, text, "snapshot")?;
            let instead = "; use the version that wrote it";
            check_format(file, text, "snapshot", FORMAT, instead)?;
            let snapshot: Snapshot = notation::read(text).map_err(|e| {
                let error = read::refused(file, 1, "", &e);
                or_mistaken(error, file, text, FileKind::Snapshot)
            })?;
            Scene::within(file, text, &at!["scene"], snapshot.scene.clone())?;
            Ok(snapshot)
        };
        read().map_err(|error| SnapshotError::Read(Box::new(error)))
    }

    /// Recomputes the snapshot from the start of its scene.
    ///
    /// # Errors
    /// If the scene is invalid, or the run does not get that far.
    pub fn replay(&self) -> Result<Snapshot, SnapshotError> {
        if self.scene.attached.is_some() {
            let name = self.name.clone();
            return Err(SnapshotError::Attached { name });
        }
        let scene = Scene::from_spec(&self.name, self.scene.clone())?;
        self.replay_on(&scene, any_solver(Arc::new(scene.model.clone())).as_mut())
    }

    /// Recomputes the snapshot with an attached solver, from its start.
    ///
    /// # Errors
    /// As [`Snapshot::replay`]; also if the solver has another scene or cannot continue.
    pub fn replay_with(&self, solver: &mut dyn Solver) -> Result<Snapshot, SnapshotError> {
        let scene = Scene::from_spec(&self.name, self.scene.clone())?;
        if scene.model != **solver.model() {
            return Err(SnapshotError::Replay(
                "the solver's scene differs from the snapshot's".into(),
            ));
        }
        self.replay_on(&scene, solver)
    }

    fn replay_on(&self, scene: &Scene, solver: &mut dyn Solver) -> Result<Snapshot, SnapshotError> {
        let mut done = 0;
        let until = Until::end().minors(self.steps).past_failures();
        let end = repeat(solver, &self.interventions, until, |_| done += 1);
        match end.map_err(|lost| SnapshotError::Replay(lost.to_string()))? {
            RunEnd::Stopped(why) => return Err(SnapshotError::Replay(why)),
            RunEnd::Spent => {}
            RunEnd::Finished | RunEnd::Failed(_) | RunEnd::Interrupted => {
                return Err(SnapshotError::Replay(format!(
                    "the history ends after {}, but the snapshot was taken after {}",
                    counted(done, "minor iteration"),
                    self.steps
                )));
            }
        }
        let last = self.interventions.last().map_or(0, |a| a.step);
        if last > self.steps || !self.interventions.is_sorted_by_key(|a| a.step) {
            return Err(SnapshotError::Replay(
                "its interventions are out of order or after its last step".into(),
            ));
        }
        let event = (self.steps > 0).then(|| solver.event());
        Ok(Snapshot::take(
            scene,
            &self.interventions,
            self.steps,
            solver.state(),
            event,
        ))
    }
}

/// Runs a solver from its start with interventions, and calls `see` after each minor iteration. An intervention that is not
/// possible stops the run, with the reason.
///
/// # Errors
/// If the solver cannot continue.
pub fn repeat<T: Solver + ?Sized>(
    solver: &mut T,
    interventions: &[AppliedIntervention],
    until: Until<'_>,
    mut see: impl FnMut(&mut T),
) -> Result<RunEnd<String>, SolverLost> {
    let mut left = interventions.iter().peekable();
    let mut done = 0;
    let mut intervene = |solver: &mut T, done: u64| {
        while let Some(next) = left.next_if(|a| a.step == done) {
            if let Err(why) = solver.intervene(&next.intervention) {
                return ControlFlow::Break(format!("after step {done}: {why}"));
            }
        }
        ControlFlow::Continue(())
    };
    if let ControlFlow::Break(why) = intervene(solver, done) {
        return Ok(RunEnd::Stopped(why));
    }
    drive(solver, until, |solver| {
        done += 1;
        see(solver);
        intervene(solver, done)
    })
}

impl Recorded {
    fn new(model: &Model, state: &State, event: Option<&Event>) -> Recorded {
        let slaves = (0..model.contacts.len())
            .map(|s| SlaveRecord::new(model, state, event, s))
            .collect();
        let displacements = (0..model.nodes.len())
            .map(|n| displacement(model, &state.u, n))
            .collect();
        let dofs = &model.dofs;
        let nodal: usize = dofs.count.iter().map(|&count| usize::from(count)).sum();
        Recorded {
            load_factor: event.map_or(state.start.load_factor, |e| e.load_factor),
            status: state.status.clone(),
            before: event.map(|e| e.before),
            after: event.and_then(|e| norms_after(&e.outcome).copied()),
            slaves,
            displacements,
            shear: state.u[nodal..].to_vec(),
        }
    }
}

impl SlaveRecord {
    fn new(model: &Model, state: &State, event: Option<&Event>, slave: usize) -> SlaveRecord {
        let now = &state.nodes[slave];
        let node = model.nodes[model.contacts[slave].node].name.clone();
        // A minor iteration that cannot be solved has no records.
        let found = event.and_then(|e| e.nodes.get(slave));
        let [f_n, f_t, t_max, slip] = match found {
            Some(found) => [found.f_n, found.f_t, found.t_max, found.slip],
            None => [now.f_n, now.f_t, now.t_max, now.slip],
        };
        SlaveRecord {
            node,
            mode: found.map_or(now.mode, |found| found.decision.before),
            next: now.mode,
            rule: found.map(|found| found.decision.rule),
            gap: found.map(|found| found.gap),
            f_n,
            f_t,
            t_max,
            slip,
            forced: now.forced,
        }
    }
}

fn displacement(model: &Model, u: &[f64], node: usize) -> Displacement {
    let own = &u[model.dofs.of_node(node)];
    let at = |k: usize| own.get(k).copied();
    Displacement {
        node: model.nodes[node].name.clone(),
        x: at(0).unwrap_or(0.0),
        y: at(1).unwrap_or(0.0),
        rotation: at(2),
    }
}

/// `SCENE-INC.MAJOR.MINOR.ron` in the working directory, numbered if that exists.
pub fn free_name(scene: &str, at: Position) -> PathBuf {
    let scene = files::stem(scene);
    let stem = format!("{scene}-{}.{}.{}", at.increment, at.major, at.minor);
    let name = |k: u32| PathBuf::from(numbered(&stem, k, "ron"));
    (0..1000)
        .map(name)
        .find(|name| !disk::exists(name))
        .unwrap_or_else(|| name(1000))
}
