//! The subject of a run: a scene for stickslip's own solver, or an attached solver.

use super::base::{Error, SetArgs, notify, usage};
use super::interrupt::Interrupt;
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use stickslip_attach::{Attached, Channel, Start};
use stickslip_core::step::drive::drive;
use stickslip_core::{RunEnd, Solver, Until};
use stickslip_debugger::record::journal::Record;
use stickslip_debugger::{Log, Session};
use stickslip_scene::Scene;
use stickslip_scene::solver::any_solver;

/// An attached solver and its time limits.
#[derive(Debug, clap::Args)]
pub struct SolverArgs {
    /// A solver that speaks the protocol (`stickslip help protocol`), and its arguments
    #[arg(last = true, value_name = "COMMAND")]
    pub command: Vec<String>,
    /// Time limit for an answer of the solver
    #[arg(long, value_name = "SECONDS", default_value_t = 600.0, value_parser = seconds)]
    pub timeout: f64,
    /// Time limit for the start of the solver
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds)]
    pub start_timeout: f64,
    /// Waits for the solver to connect (unix:PATH, tcp:PORT, tcp:HOST:PORT), or makes its standard input a socket for both
    /// directions (fd:0)
    #[arg(long, value_name = "ADDRESS", value_parser = Channel::parse)]
    pub listen: Option<Channel>,
    /// Lets other machines connect to --listen tcp:HOST:PORT
    #[arg(long, requires = "listen")]
    pub remote: bool,
    /// Records all messages between debugger and solver in a new file, which can be opened later without the solver
    #[arg(long, value_name = "FILE", requires = "command")]
    pub exchange: Option<PathBuf>,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        // A year means no limit.
        Ok(seconds) if seconds > 0.0 && seconds <= 3.2e7 => Ok(seconds),
        _ => Err("expected a positive number of seconds".to_owned()),
    }
}

impl SolverArgs {
    /// Whether a solver is given.
    pub fn is_named(&self) -> bool {
        !self.command.is_empty() || self.listen.is_some()
    }

    /// The command and its time limits.
    pub fn start(&self) -> Start {
        Start {
            start: Duration::from_secs_f64(self.start_timeout),
            answer: Duration::from_secs_f64(self.timeout),
            channel: self.listen.clone().unwrap_or_default(),
            ..Start::new(self.command.clone())
        }
    }

    /// Log of the exchange, stored in a file if requested; `overwrite` allows replacing an existing file.
    pub fn log(&self, overwrite: bool) -> Result<Log, Error> {
        let log = Log::default();
        if let Some(path) = &self.exchange {
            let kept = log.keep(path, overwrite);
            kept.map_err(|error| {
                let how = match error.kind() {
                    std::io::ErrorKind::AlreadyExists => {
                        "the file exists already (use --force)".into()
                    }
                    _ => format!("the file cannot be written: {error}"),
                };
                usage!("{}: {how}", path.display())
            })?;
        }
        Ok(log)
    }

    /// Starts the solver, if one is given; changes to a scene are refused. `interrupt` also ends its iterations.
    pub fn attached(
        &self,
        set: &SetArgs,
        overwrite: bool,
        interrupt: Option<&Interrupt>,
    ) -> Result<Option<(Scene, Attached)>, Error> {
        if !self.is_named() {
            return Ok(None);
        }
        if let Some((path, _)) = set.set.first() {
            return Err(usage!(
                "--set {path}: only for scenes; set a solver's parameters by its arguments or in the debugger (:set)"
            ));
        }
        let (scene, attached, _) = self.attach(overwrite, interrupt)?;
        Ok(Some((scene, attached)))
    }

    /// Starts the solver; `overwrite` allows the exchange to replace an existing file.
    pub fn attach(
        &self,
        overwrite: bool,
        interrupt: Option<&Interrupt>,
    ) -> Result<(Scene, Attached, Log), Error> {
        if let Some(channel) = &self.listen {
            if !(self.remote || channel.is_local()) {
                return Err(usage!(
                    "--listen {channel}: other machines could connect; add --remote if they may"
                ));
            }
            if self.command.is_empty() {
                notify(&channel.invitation());
            }
        }
        let log = self.log(overwrite)?;
        let asks = interrupt.map(Interrupt::asks).unwrap_or_default();
        let attached = Attached::with_cancel(self.start(), log.clone(), asks);
        let (scene, attached) = attached.map_err(Error::usage)?;
        Ok((scene, attached, log))
    }
}

/// Maximum number of iterations of an attached solver.
const MOST_STEPS: u64 = 10_000;

/// Steps an attached solver until an increment fails, and calls `see` after each iteration.
pub fn step_to_end(
    solver: &mut dyn Solver,
    interrupt: Option<&Interrupt>,
    see: &mut dyn FnMut(&dyn Solver),
) -> Result<RunEnd<Infallible>, Error> {
    let has_arrived = || interrupt.is_some_and(Interrupt::has_arrived);
    let until = Until::end().interrupted_by(&has_arrived);
    let end = drive(solver, until.minors(MOST_STEPS), |solver| {
        see(solver);
        ControlFlow::Continue(())
    });
    match end {
        Err(_) if has_arrived() => Ok(RunEnd::Interrupted),
        Err(lost) => Err(Error::usage(lost)),
        Ok(RunEnd::Spent) => Err(usage!(
            "the solver neither failed nor ended within {MOST_STEPS} iterations"
        )),
        Ok(end) => Ok(end),
    }
}

/// A scene with changes, or an attached solver.
#[derive(Debug, clap::Args)]
pub struct SubjectArgs {
    /// A scene file, or the name of a built-in scene
    #[arg(required_unless_present_any = ["command", "listen"], conflicts_with_all = ["command", "listen"])]
    pub scene: Option<String>,
    #[command(flatten)]
    pub set: SetArgs,
    #[command(flatten)]
    pub solver: SolverArgs,
}

/// What is solved, and by which solver.
pub struct Subject {
    pub scene: Scene,
    pub solver: Box<dyn Solver>,
}

impl SubjectArgs {
    /// Opens the scene, or attaches the solver.
    pub fn open(&self, overwrite: bool, interrupt: Option<&Interrupt>) -> Result<Subject, Error> {
        if let Some((scene, attached)) = self.solver.attached(&self.set, overwrite, interrupt)? {
            return Ok(Subject {
                scene,
                solver: Box::new(attached),
            });
        }
        let name = self.scene.as_deref().unwrap_or_default();
        let scene = Scene::open_any(name, &self.set.set)?;
        let solver = any_solver(Arc::new(scene.model.clone()));
        Ok(Subject { scene, solver })
    }

    /// Opens the scene.
    pub fn scene(&self) -> Result<Scene, Error> {
        let name = self.scene.as_deref().unwrap_or_default();
        Ok(Scene::open(name, &self.set.set)?)
    }
}

/// A new session for a journal, at its start.
pub fn session_of(record: &Record, solver: &SolverArgs) -> Result<Session, Error> {
    let (file, header) = (&record.file, &record.header);
    let wrong = |why: String| Err(usage!("{file}: {why}"));
    match (solver.is_named(), &header.scene.attached) {
        (false, None) => Ok(Session::new(record.scene()?)),
        (true, Some(_)) => {
            let (scene, attached, log) = solver.attach(false, None)?;
            if scene.spec == header.scene {
                Ok(Session::attached(scene, Box::new(attached), log))
            } else {
                wrong("the solver's scene differs from the journal's".into())
            }
        }
        (false, Some(_)) => wrong(format!(
            "the journal needs the attached solver {}; add -- COMMAND",
            header.name
        )),
        (true, None) => wrong("the journal needs no attached solver; omit -- COMMAND".into()),
    }
}
