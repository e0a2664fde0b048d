//! `stickslip run`: solves a scene from start to end.

use super::base::{Error, Exit, OutputState, notify, quoted, usage, whole};
use super::interrupt::Interrupt;
use super::json;
use super::records::{FailureKind, FailureRecord, RunRecord};
use super::remedies;
use super::run_outputs::{RunOutputArgs, RunOutputs};
use super::solver::{Subject, SubjectArgs};
use super::tally::{MOST_STRETCHES, Stretches, Tally};
use std::ops::ControlFlow;
use stickslip_core::step::drive::drive;
use stickslip_core::{Control, Failure, Jumps, RunEnd, Solver, SolverLost, Touch, Until, counted};
use stickslip_debugger::Snapshot;
use stickslip_debugger::explain::names;
use stickslip_debugger::explain::page;
use stickslip_debugger::explain::report;
use stickslip_debugger::explain::touch::TouchWatch;
use stickslip_debugger::explain::unforced::PlaceWatch;
use stickslip_platform::files::Output;
use stickslip_scene::solver::solver;
use stickslip_scene::{Scene, first_of, gaps, shortest, shown, sig4, sig6};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    subject: SubjectArgs,
    #[command(flatten)]
    outputs: RunOutputArgs,
    /// Maximum iterations per increment (attached solvers)
    #[arg(
        long = "max-iterations",
        alias = "most",
        value_name = "ITERATIONS",
        default_value_t = 1000,
        value_parser = whole::<u64>
    )]
    most: u64,
    /// Tests the stability of each accepted state: a column of --csv, and a summary at the end
    #[arg(long)]
    stability: bool,
    /// Overwrites existing files
    #[arg(long)]
    force: bool,
    /// Prints nothing but warnings and errors
    #[arg(long, short)]
    quiet: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let interrupt = Interrupt::listen();
    let Subject { scene, mut solver } = args.subject.open(args.force, Some(&interrupt))?;
    if args.outputs.vtu.is_some() && solver.stepper().is_none() {
        return Err(usage!(
            "--vtu cannot be used here: there are no bodies, only contacts"
        ));
    }
    // Opened before the solve, so that its results can be written.
    let mut outputs = RunOutputs::open(&args.outputs, &scene, args.force)?;
    let mut run = Run::new(&scene, solver, args);
    if !args.quiet || args.outputs.json.to().is_some() {
        for warning in gaps::warnings(&scene.model) {
            run.tally.messages.warn_of_scene(warning);
        }
    }
    let end = run.go(&mut outputs, &interrupt)?;
    run.tally.progress.clear();
    let last = outputs.close()?;
    if let Some(wrote) = last.wrote.filter(|_| !args.quiet) {
        notify(&wrote);
    }
    if let Some(output) = last.snapshot {
        write_snapshot(output, &run)?;
    }
    let result = run.notify(end, args, &interrupt);
    let exit = result.exit;
    if last.json.is_some() {
        json::write(last.json, &run.record(result))?;
    }
    Ok(exit)
}

fn write_snapshot(mut output: Output, run: &Run) -> Result<(), Error> {
    let (scene, steps) = (run.tally.scene, run.tally.steps);
    let event = (steps > 0).then(|| run.solver.event());
    let snapshot = Snapshot::take(scene, &[], steps, run.solver.state(), event);
    output.append(snapshot.to_text()?.as_bytes())?;
    Ok(output.finish()?)
}

/// The state of a run.
struct Run<'a> {
    solver: Box<dyn Solver>,
    /// Whether the solver is stickslip's own.
    is_own: bool,
    tally: Tally<'a>,
}

/// How a run ended: its exit code, and what its record says about that.
struct RunResult {
    exit: Exit,
    record: RunRecord,
}

impl RunResult {
    fn new(exit: Exit, outcome: &'static str) -> RunResult {
        RunResult {
            exit,
            record: RunRecord {
                outcome,
                exit_code: exit as u8,
                ..RunRecord::default()
            },
        }
    }
}

/// How a run ended: stopped by `StopReason`, or lost if an attached solver fails.
type Ending = Result<RunEnd<StopReason>, SolverLost>;

/// Why the run was stopped here.
enum StopReason {
    /// All readers have closed their pipes.
    Pipe,
    /// An attached solver exceeded its maximum iterations; describes its last modes.
    Endless(String),
}

impl<'a> Run<'a> {
    fn new(scene: &'a Scene, mut solver: Box<dyn Solver>, args: &Args) -> Self {
        let (model, spec) = (&scene.model, &scene.spec);
        let chosen = spec.settings.touch == Touch::Auto && model.settings.touch == Touch::Ratio;
        let watched = chosen && model.control != Control::Arc && !args.quiet;
        let is_own = solver.stepper().is_some();
        let stepper = solver.stepper().filter(|_| watched);
        let touch = stepper.map(|stepper| TouchWatch::new(stepper.state()));
        let stepper = solver.stepper();
        let unforced = stepper.map(|stepper| PlaceWatch::new(model, &stepper.state().start));
        let most = args.subject.solver.is_named().then_some(args.most);
        let mut tally = Tally::new(scene, args.quiet, args.stability, most);
        tally.touch = touch;
        tally.unforced = unforced;
        Run {
            solver,
            is_own,
            tally,
        }
    }

    fn go(&mut self, outputs: &mut RunOutputs, interrupt: &Interrupt) -> Result<Ending, Error> {
        let Run { solver, tally, .. } = self;
        let solver = &mut **solver;
        let stability = tally.stability.is_some();
        if outputs.headers(&tally.scene.model, stability)? == OutputState::Closed {
            return Ok(Ok(RunEnd::Stopped(StopReason::Pipe)));
        }
        if let Some((grids, stepper)) = outputs.grids.as_mut().zip(solver.stepper()) {
            grids.start(stepper)?;
        }
        let came = || interrupt.has_arrived();
        let until = Until::end().interrupted_by(&came);
        let end = drive(solver, until, |solver| match tally.see(solver, outputs) {
            Ok(OutputState::Well) => match tally.endless(solver) {
                None => ControlFlow::Continue(()),
                Some(text) => ControlFlow::Break(Ok(StopReason::Endless(text))),
            },
            Ok(OutputState::Closed) => ControlFlow::Break(Ok(StopReason::Pipe)),
            Err(error) => ControlFlow::Break(Err(error)),
        });
        let end = match end {
            Ok(end) => end,
            Err(_) if interrupt.has_arrived() => RunEnd::Interrupted,
            Err(lost) => return Ok(Err(lost)),
        };
        Ok(Ok(match end {
            RunEnd::Stopped(stopped) => RunEnd::Stopped(stopped?),
            RunEnd::Failed(failure) => RunEnd::Failed(failure),
            RunEnd::Interrupted => RunEnd::Interrupted,
            RunEnd::Finished | RunEnd::Spent => RunEnd::Finished,
        }))
    }

    /// Prints the summary, and how the run ended.
    fn notify(&mut self, end: Ending, args: &Args, interrupt: &Interrupt) -> RunResult {
        self.tally.sum_up(self.solver.state());
        if !args.quiet {
            self.report_summary(args.outputs.csv.is_none());
            if self.tally.scene.model.monitors.is_empty() {
                self.tally.report_slaves();
            }
        }
        if let Some(touch) = self
            .tally
            .touch
            .as_ref()
            .filter(|_| !interrupt.has_arrived())
            && let Some(difference) = touch.measure(self.solver.model())
        {
            self.tally.messages.note(difference.words());
        }
        let end = match end {
            Ok(end) => end,
            Err(lost) => {
                let state = self.solver.state();
                let (kind, words) = (FailureKind::SolverLost, lost.to_string());
                let failure = FailureRecord::reported(kind, words, state.next, state.load_factor);
                return self.report_lost(failure);
            }
        };
        match end {
            RunEnd::Finished | RunEnd::Spent => self.report_branches(),
            // A reader that closes the pipe has all the data it wants.
            RunEnd::Stopped(StopReason::Pipe) => RunResult::new(Exit::Good, "finished"),
            RunEnd::Stopped(StopReason::Endless(words)) => {
                let (event, kind) = (self.solver.event(), FailureKind::IterationLimit);
                let (at, load) = (event.position, event.load_factor);
                self.report_lost(FailureRecord::reported(kind, words, at, load))
            }
            RunEnd::Interrupted => {
                let at = names::position(self.solver.state().next);
                let result = RunResult::new(Exit::Interrupted, "interrupted");
                self.with_message(result, format!("interrupted before {at}"))
            }
            RunEnd::Failed(failure) => self.report_failure(&failure, interrupt),
        }
    }

    /// Prints the message of a result, and adds it.
    fn with_message(&self, mut result: RunResult, message: String) -> RunResult {
        notify(&format!("{}: {message}", self.tally.scene.name));
        result.record.message = Some(message);
        result
    }

    /// Reports an attached solver that cannot continue, or does not end.
    fn report_lost(&self, failure: FailureRecord) -> RunResult {
        let mut result = RunResult::new(Exit::Unconverged, "failed");
        let words = failure.words.clone();
        result.record.failure = Some(failure);
        self.with_message(result, words)
    }

    /// Reports where and why the run failed.
    fn report_failure(&mut self, failure: &Failure, interrupt: &Interrupt) -> RunResult {
        let (event, state) = (self.solver.event(), self.solver.state());
        let (model, at, load) = (&self.tally.scene.model, event.position, event.load_factor);
        self.report_marks();
        let mut result = RunResult::new(Exit::Unconverged, "failed");
        result.record.failure = Some(FailureRecord::new(model, at, load, failure));
        let text = report::failure(model, state, at, load, failure);
        let mut result = self.with_message(result, text);
        if !self.is_own {
            // Only an attached solver knows the cause.
            let how = match self.tally.scene.spec.in_space {
                None => "`stickslip attach`".to_owned(),
                Some(_) => format!("`stickslip {}`", quoted(&self.tally.scene.name)),
            };
            notify(&format!(
                "  {how} opens it in the debugger; d shows the cause"
            ));
            result.record.why.extend(self.tally.rounds());
            for line in &result.record.why {
                notify(&format!("  why: {line}"));
            }
            return result;
        }
        let mut scratch = solver(self.solver.model().clone());
        let remedies = remedies::command(self.tally.scene);
        notify(&format!(
            "  `{remedies}` tries every remedy; in the debugger, d shows the cause"
        ));
        let stop = || interrupt.has_arrived();
        let most = (&self.tally.scene.spec, self.tally.steps);
        let record = &mut result.record;
        record.why = page::causes(&mut scratch, state, failure, &stop);
        for line in &record.why {
            notify(&format!("  why: {line}"));
        }
        let works = page::first_that_works(&mut scratch, state, failure, most, &stop);
        record.works = works.map(|line| line.option());
        if let Some(line) = &record.works {
            notify(&format!("  try: {line}"));
        }
        result
    }

    /// All results of the run.
    fn record(&self, result: RunResult) -> RunRecord {
        let tally = &self.tally;
        let stability = tally.stability.as_ref();
        RunRecord {
            schema: "stickslip-run-1",
            scene: tally.scene.name.clone(),
            increments: tally.accepted,
            majors: tally.majors,
            minors: tally.steps,
            load: self.solver.state().start.load_factor,
            fallbacks: tally.fallbacks(),
            jumps: tally.jumps.clone(),
            motions: tally.motions.clone(),
            unstable: tally.losses.clone(),
            stability: stability.map(Stretches::records).unwrap_or_default(),
            warnings: tally.messages.warnings.clone(),
            doubtful: tally.doubtful.clone(),
            notes: tally.messages.notes.clone(),
            monitors: tally.monitors(),
            slaves: tally.slaves(),
            ..result.record
        }
    }

    /// Reports where the accepted states leave the branch of stable equilibrium.
    fn report_marks(&self) {
        let Tally {
            scene,
            found,
            jumps,
            losses,
            without_friction,
            ..
        } = &self.tally;
        let name = &scene.name;
        let loads = |all: &[f64]| {
            let mut texts: Vec<String> = all.iter().map(|&x| sig4(x)).collect();
            texts.dedup();
            first_of(texts, MOST_STRETCHES, ", ")
        };
        for (by, found) in found {
            let (by, at) = (by.words(), loads(found));
            notify(&format!("{name}: found with {by} at load {at}"));
        }
        if !jumps.is_empty() {
            let at = loads(jumps);
            notify(&format!(
                "{name}: jumped to another equilibrium branch at load {at}"
            ));
        }
        if let Some((body, load)) = without_friction
            && !(jumps.is_empty() && losses.is_empty())
        {
            let at = sig4(*load);
            notify(&format!(
                "{name}: limit load: friction is used up at load {at}: all contacts of body {body} slide"
            ));
        }
        if !losses.is_empty() {
            let at = loads(losses);
            notify(&format!(
                "{name}: equilibrium becomes unstable at load {at}; a structure does not stay in the states after it (--stability checks each state; page jumps)"
            ));
        }
    }

    /// Reports whether the accepted states follow the requested stable path; the exit code reflects it, too.
    fn report_branches(&self) -> RunResult {
        let model = &self.tally.scene.model;
        self.report_marks();
        let event = self.solver.event();
        if event.is_cut_short(model) {
            let (arc, load) = (sig4(event.arc.unwrap_or(f64::NAN)), event.load_factor);
            let text = format!(
                "path incomplete: its maximum length {arc} was reached at load {} instead of load {}; page limit-points",
                sig4(load),
                shortest(model.path.last().copied().unwrap_or(f64::NAN))
            );
            return self.with_message(RunResult::new(Exit::Unconverged, "incomplete"), text);
        }
        if self.tally.violated > 0 {
            let text = format!(
                "{} of {} violate a law of contact; `stickslip audit` lists them",
                self.tally.violated,
                counted(self.tally.accepted, "accepted increment")
            );
            return self.with_message(RunResult::new(Exit::Unconverged, "finished"), text);
        }
        let exit = match model.jumps {
            Jumps::Cut | Jumps::Stop | Jumps::Dynamic if !self.tally.losses.is_empty() => {
                Exit::Unconverged
            }
            _ => Exit::Good,
        };
        RunResult::new(exit, "finished")
    }

    fn report_summary(&self, monitors: bool) {
        notify(&format!(
            "{}: {} accepted, up to load {}; {} major and {}",
            self.tally.scene.name,
            counted(self.tally.accepted, "increment"),
            shortest(self.solver.state().start.load_factor),
            self.tally.majors,
            counted(self.tally.steps, "minor iteration"),
        ));
        let stability = self.tally.stability.as_ref();
        if let Some(stability) = stability.and_then(Stretches::words) {
            notify(&stability);
        }
        if !monitors {
            return;
        }
        for (monitor, value) in self
            .tally
            .scene
            .model
            .monitors
            .iter()
            .zip(&self.tally.monitors)
        {
            let name = shown::padded(&monitor.name, 12);
            notify(&format!("  {name} {}", sig6(*value)));
        }
    }
}
