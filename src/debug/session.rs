//! A debugging session: the scene, everything done so far, and a cursor in it.
//!
//! The solver runs on a worker thread, one job at a time, so that whoever owns the session (the TUI, a test, a
//! script) stays free to answer keys. [`Session::submit`] takes a command, [`Session::poll`] gathers what the
//! worker has done since, [`Session::wait`] blocks until it is idle.
//!
//! The history is a line of [`Frame`]s. A frame is what one minor iteration left behind, or what one intervention
//! changed; going back moves the cursor, going forward moves it again and solves only past the line's end. An
//! intervention before the end forgets what came after it.

use crate::debug::command::{Command, Unit};
use crate::debug::report;
use crate::debug::snapshot::{Applied, Snapshot};
use crate::debug::worker::{Job, Message, Worker};
use crate::scene::{Model, Scene, paths};
use crate::solve::{Event, Intervention, Norms, Outcome, State, Status};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A point of the history.
#[derive(Debug, Clone)]
pub struct Frame {
    /// The state from which the next minor iteration goes on.
    pub state: State,
    /// The last minor iteration; none at the start.
    pub event: Option<Arc<Event>>,
    /// What the user changed here, if this frame is due to that and not to a minor iteration.
    pub intervention: Option<Intervention>,
    /// Values of the scene's monitors, where this frame ends an accepted increment.
    pub monitors: Option<Arc<Vec<f64>>>,
}

/// What a command led to, as a line for the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply(pub String);

/// A debugging session.
pub struct Session {
    scene: Scene,
    model: Arc<Model>,
    frames: Vec<Frame>,
    cursor: usize,
    worker: Worker,
    running: bool,
}

impl Session {
    /// A session at the start of a scene.
    pub fn new(scene: Scene) -> Self {
        let model = Arc::new(scene.model.clone());
        let worker = Worker::new(model.clone());
        let start = Frame {
            state: crate::solve::Stepper::new(model.clone()).state().clone(),
            event: None,
            intervention: None,
            monitors: None,
        };
        Session {
            scene,
            model,
            frames: vec![start],
            cursor: 0,
            worker,
            running: false,
        }
    }

    /// Scene as read.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Scene as checked.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Path or built-in name that the scene came from.
    pub fn scene_name(&self) -> &str {
        &self.scene.name
    }

    /// All frames so far, oldest first; never empty. Frame 0 is the start.
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// Index of the frame that is shown.
    pub fn cursor(&self) -> usize {
        self.cursor
    }

    /// The frame that is shown.
    pub fn frame(&self) -> &Frame {
        &self.frames[self.cursor]
    }

    /// Whether the worker is busy.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Asks a running job to stop after the present minor iteration.
    pub fn interrupt(&self) {
        self.worker.interrupt();
    }

    /// Carries out (or starts) a command.
    ///
    /// # Errors
    /// A message that says what is wrong and what would be right.
    pub fn submit(&mut self, command: Command) -> Result<Reply, String> {
        if self.running {
            return Err("the solver is running; interrupt it first (Ctrl-C)".into());
        }
        match command {
            Command::Forward { unit, count } => Ok(self.forward(unit, count.max(1))),
            Command::Back { unit, count } => self.back(unit, count.max(1)),
            Command::Force { slave, mode, hold } => {
                self.intervene(Intervention::Force { slave, mode, hold })
            }
            Command::Release { slave } => self.intervene(Intervention::Release { slave }),
            Command::Increment(increment) => self.intervene(Intervention::Increment(increment)),
            Command::Set { path, value } => {
                let intervention = self.setting(&path, &value)?;
                self.intervene(intervention)
            }
            Command::Snapshot { file, overwrite } => self.snapshot(file, overwrite),
        }
    }

    /// Gathers what the worker did since the last call; a message when a job came to its end. Never blocks.
    pub fn poll(&mut self) -> Option<Reply> {
        while self.running {
            let message = self.worker.try_next()?;
            if let Some(reply) = self.take(message) {
                return Some(reply);
            }
        }
        None
    }

    /// Blocks until the worker is idle and returns its last message.
    pub fn wait(&mut self) -> Option<Reply> {
        while self.running {
            let message = self.worker.next();
            if let Some(reply) = self.take(message) {
                return Some(reply);
            }
        }
        None
    }

    fn take(&mut self, message: Message) -> Option<Reply> {
        match message {
            Message::Frame(state, event, monitors) => {
                self.frames.push(Frame {
                    state: *state,
                    event: Some(event),
                    intervention: None,
                    monitors,
                });
                self.cursor = self.frames.len() - 1;
                None
            }
            Message::Done { interrupted } => {
                self.running = false;
                let here = self.told();
                Some(Reply(if interrupted {
                    format!("interrupted; {here}")
                } else {
                    here
                }))
            }
            Message::Died => {
                self.running = false;
                Some(Reply(
                    "the solver stopped unexpectedly; what was done so far is kept".into(),
                ))
            }
        }
    }

    /// Moves the cursor over what is known already, then solves on.
    fn forward(&mut self, unit: Unit, count: u32) -> Reply {
        let mut left = count;
        while left > 0 && self.cursor + 1 < self.frames.len() {
            self.cursor += 1;
            let frame = &self.frames[self.cursor];
            if let (Some(event), None) = (&frame.event, &frame.intervention) {
                left -= u32::from(ends(unit, &event.outcome));
                if matches!(event.outcome, Outcome::Failed(_)) {
                    left = 0;
                }
            }
        }
        if left == 0 || self.frame().state.status == Status::Finished {
            return Reply(self.told());
        }
        self.running = true;
        self.worker.start(Job {
            state: self.frame().state.clone(),
            unit,
            count: left,
        });
        Reply("running; Ctrl-C interrupts".into())
    }

    fn back(&mut self, unit: Unit, count: u32) -> Result<Reply, String> {
        if self.cursor == 0 {
            return Err("this is the start".into());
        }
        for _ in 0..count {
            let stops = |frame: &Frame| match (unit, &frame.event) {
                (Unit::Minor, _) => true,
                (_, None) => false,
                (Unit::Run, Some(event)) => matches!(event.outcome, Outcome::Failed(_)),
                (_, Some(event)) => frame.intervention.is_none() && ends(unit, &event.outcome),
            };
            self.cursor = (0..self.cursor)
                .rev()
                .find(|&k| stops(&self.frames[k]))
                .unwrap_or(0);
        }
        Ok(Reply(self.told()))
    }

    fn intervene(&mut self, intervention: Intervention) -> Result<Reply, String> {
        let mut state = self.frame().state.clone();
        state.intervene(&self.model, &intervention)?;
        let forgotten = self.frames.len() - 1 - self.cursor;
        self.frames.truncate(self.cursor + 1);
        let event = self.frame().event.clone();
        let mut told = report::intervention(&self.model, &intervention);
        self.frames.push(Frame {
            state,
            event,
            intervention: Some(intervention),
            monitors: None,
        });
        self.cursor += 1;
        if forgotten > 0 {
            told += &format!(" ({forgotten} later steps are forgotten)");
        }
        Ok(Reply(told))
    }

    /// What `:set` means, on top of what was set before.
    fn setting(&self, path: &str, value: &str) -> Result<Intervention, String> {
        let controls = &self.frame().state.controls;
        let mut spec = self.scene.spec.clone();
        spec.settings = controls.settings;
        spec.history.increment = controls.increment;
        if let Some(friction) = controls.friction.first() {
            spec.friction = *friction;
        }
        paths::set(&mut spec, path, value)?;
        let sound = Scene::from_spec(&self.scene.name, spec).map_err(|e| e.message)?;
        if path.starts_with("settings.") {
            Ok(Intervention::Settings(sound.spec.settings))
        } else if path.starts_with("friction.") {
            Ok(Intervention::Friction(sound.spec.friction))
        } else if path == "history.increment" {
            Ok(Intervention::Increment(sound.spec.history.increment))
        } else {
            Err(format!(
                "{path} cannot change during a run; friction.*, settings.* and history.increment can (or start again with --set {path}={value})"
            ))
        }
    }

    /// Number of minor iterations done up to the cursor, and the interventions among them.
    fn record(&self) -> (u64, Vec<Applied>) {
        let (mut step, mut applied) = (0, Vec::new());
        for frame in &self.frames[1..=self.cursor] {
            match &frame.intervention {
                Some(intervention) => applied.push(Applied {
                    step,
                    intervention: intervention.clone(),
                }),
                None => step += 1,
            }
        }
        (step, applied)
    }

    fn snapshot(&self, file: Option<PathBuf>, overwrite: bool) -> Result<Reply, String> {
        let (steps, applied) = self.record();
        let frame = self.frame();
        let snapshot = Snapshot::take(
            &self.scene,
            &applied,
            steps,
            &frame.state,
            frame.event.as_deref(),
        );
        let file = file.unwrap_or_else(|| self.free_name());
        snapshot
            .write(&file, overwrite)
            .map_err(|e| e.to_string())?;
        Ok(Reply(format!("wrote {}", file.display())))
    }

    /// `SCENE-INC.MAJOR.MINOR.ron` in the working directory, with a number where that exists.
    fn free_name(&self) -> PathBuf {
        let scene = Path::new(self.scene_name())
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let at = match &self.frame().event {
            Some(event) => event.position,
            None => self.frame().state.next,
        };
        let stem = format!("{scene}-{}.{}.{}", at.increment, at.major, at.minor);
        let name = |k: u32| {
            PathBuf::from(if k == 0 {
                format!("{stem}.ron")
            } else {
                format!("{stem}-{k}.ron")
            })
        };
        (0..1000)
            .map(name)
            .find(|name| !name.exists())
            .unwrap_or_else(|| name(1000))
    }

    /// Residual norms of the shown increment attempt up to the cursor: before its first major iteration (0), and
    /// after each.
    pub fn residual_history(&self) -> Vec<(u32, Norms)> {
        let Some(shown) = self.frame().event.as_ref().map(|e| e.position) else {
            return Vec::new();
        };
        let mut history: Vec<(u32, Norms)> = Vec::new();
        for frame in self.frames[..=self.cursor].iter().rev() {
            let Some(event) = &frame.event else { break };
            let at = event.position;
            if (at.increment, at.attempt) != (shown.increment, shown.attempt) {
                break;
            }
            let after = match &event.outcome {
                Outcome::Major { after, .. } | Outcome::Increment { after, .. } => {
                    Some((at.major, *after))
                }
                _ => None,
            };
            history.extend(
                after
                    .into_iter()
                    .chain((at.major == 1).then_some((0, event.before))),
            );
        }
        history.reverse();
        history.dedup_by_key(|entry| entry.0);
        history
    }

    /// A monitor against the load factor, at the end of every accepted increment up to the cursor.
    pub fn curve(&self, monitor: usize) -> Vec<[f64; 2]> {
        curve(&self.frames[..=self.cursor], monitor)
    }

    fn told(&self) -> String {
        let frame = self.frame();
        match &frame.event {
            None => "at the start".into(),
            Some(event) => report::outcome(&self.model, event),
        }
    }
}

/// A monitor's value and the load factor at the end of every accepted increment among these frames.
pub fn curve(frames: &[Frame], monitor: usize) -> Vec<[f64; 2]> {
    let point = |frame: &Frame| {
        let value = *frame.monitors.as_ref()?.get(monitor)?;
        Some([value, frame.event.as_ref()?.load_factor])
    };
    frames.iter().filter_map(point).collect()
}

/// Whether a minor iteration that ended like this ends a motion by this unit.
pub(super) fn ends(unit: Unit, outcome: &Outcome) -> bool {
    match unit {
        Unit::Minor => true,
        Unit::Major => !matches!(outcome, Outcome::Minor | Outcome::Damped { .. }),
        Unit::Increment => matches!(outcome, Outcome::Increment { .. } | Outcome::Failed(_)),
        Unit::Run => matches!(
            outcome,
            Outcome::Failed(_) | Outcome::Increment { last: true, .. }
        ),
    }
}
