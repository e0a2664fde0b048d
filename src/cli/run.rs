//! `stickslip run`: solves a scene from start to end.

use super::base::{Error, Exit, Sent, distinct, notify};
use super::grids::{Each, Grids};
use super::interrupt::Interrupt;
use super::progress::Progress;
use super::remedies;
use super::sink::Sink;
use super::solver::{Subject, SubjectArgs};
use super::table;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use stickslip_core::contact::record::ContactRecord;
use stickslip_core::linear::norms::Norms;
use stickslip_core::linear::stability::Stability;
use stickslip_core::model::{Control, Jumps, Model, Touch};
use stickslip_core::step::drive::{RunEnd, Until, drive};
use stickslip_core::step::event::{Event, Moves, Outcome};
use stickslip_core::step::recovery::fallback::Fallback;
use stickslip_core::step::solver::{Lost, Solver};
use stickslip_debugger::explain::accuracy;
use stickslip_debugger::explain::bond;
use stickslip_debugger::explain::names;
use stickslip_debugger::explain::page;
use stickslip_debugger::explain::report;
use stickslip_debugger::explain::touch::TouchWatch;
use stickslip_debugger::history::rounds::{self, CycleWatch};
use stickslip_debugger::history::strip::Strip;
use stickslip_debugger::record::snapshot::Snapshot;
use stickslip_platform::files::Output;
use stickslip_scene::Scene;
use stickslip_scene::gaps;
use stickslip_scene::number::{four, six};
use stickslip_scene::shown;
use stickslip_scene::shown::{aligned, first_of};
use stickslip_scene::solver::solver;

/// Warnings that are printed individually; others are only counted.
const MOST_WARNINGS: u32 = 10;
/// Maximum number of slave nodes in the final table.
const MOST_SLAVES: usize = 40;
/// Maximum number of load ranges or loads listed in a message about stability.
const MOST_STRETCHES: usize = 8;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    subject: SubjectArgs,
    /// Writes a row per converged increment; - is standard output
    #[arg(long, value_name = "FILE|-")]
    csv: Option<String>,
    /// Writes a row per slave node and minor iteration; - is standard output
    #[arg(long, value_name = "FILE|-")]
    trace: Option<String>,
    /// Writes the state at the end, or at the failure
    #[arg(long, value_name = "FILE")]
    snapshot: Option<PathBuf>,
    /// Writes ParaView files, and a collection of them (.pvd), to a folder
    #[arg(long, value_name = "DIR")]
    vtu: Option<PathBuf>,
    /// When --vtu writes a file
    #[arg(
        long,
        value_name = "WHAT",
        value_enum,
        default_value = "increment",
        requires = "vtu"
    )]
    each: Each,
    /// Maximum iterations per increment (attached solvers)
    #[arg(long, value_name = "ITERATIONS", default_value_t = 1000)]
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
    let Subject { scene, mut solver } = args.subject.open(args.force)?;
    if args.vtu.is_some() && args.subject.solver.is_named() {
        return Err(Error::Usage(
            "--vtu cannot be used with an attached solver, which reports only its contacts".into(),
        ));
    }
    let asks = Arc::new(AtomicUsize::new(0));
    interrupt.count(&asks);
    solver.heed(asks);
    // Opened before the solve, so that its results can be written.
    let mut outputs = RunOutputs::open(args, &scene)?;
    if !args.quiet {
        for warning in gaps::warnings(&scene.model) {
            notify(&format!("warning: {warning}"));
        }
    }
    let mut run = Run::new(&scene, solver, args);
    let end = run.go(&mut outputs, &interrupt)?;
    run.tally.progress.clear();
    let (snapshot, wrote) = outputs.close()?;
    if let Some(wrote) = wrote.filter(|_| !args.quiet) {
        notify(&wrote);
    }
    if let Some(output) = snapshot {
        write_snapshot(output, &run)?;
    }
    Ok(run.notify(&end, args, &interrupt))
}

/// The output files of a run.
struct RunOutputs {
    csv: Option<Sink>,
    trace: Option<Sink>,
    snapshot: Option<Output>,
    grids: Option<Grids>,
}

impl RunOutputs {
    fn open(args: &Args, scene: &Scene) -> Result<RunOutputs, Error> {
        let snapshot = args.snapshot.as_ref().map(|path| path.to_string_lossy());
        distinct(&[
            ("--csv", args.csv.as_deref()),
            ("--trace", args.trace.as_deref()),
            ("--snapshot", snapshot.as_deref()),
        ])?;
        let sink = |to: &Option<String>| match to {
            Some(to) => Sink::open(to, args.force).map(Some),
            None => Ok(None),
        };
        let output = |path: &PathBuf| Output::create(path, args.force);
        let grids = |folder: &PathBuf| Grids::open(folder, &scene.name, args.each, args.force);
        Ok(RunOutputs {
            csv: sink(&args.csv)?,
            trace: sink(&args.trace)?,
            snapshot: args.snapshot.as_ref().map(output).transpose()?,
            grids: args.vtu.as_ref().map(grids).transpose()?,
        })
    }

    fn headers(&mut self, model: &Model, stability: bool) -> Result<Sent, Error> {
        let csv = send(&mut self.csv, || table::csv_header(model, stability))?;
        let trace = send(&mut self.trace, || table::trace_header(model))?;
        Ok(self.after(first_closed(csv, trace)))
    }

    /// `Closed` only if all readers are gone and no other output is requested, so that the solve can stop.
    fn after(&self, sent: Sent) -> Sent {
        let wanted = self.csv.is_some()
            || self.trace.is_some()
            || self.snapshot.is_some()
            || self.grids.is_some();
        if wanted { Sent::Well } else { sent }
    }

    /// Finishes the tables and ParaView files. Returns the open snapshot, and a message about the ParaView files.
    fn close(self) -> Result<(Option<Output>, Option<String>), Error> {
        self.csv.map(Sink::finish).transpose()?;
        self.trace.map(Sink::finish).transpose()?;
        let wrote = self.grids.map(Grids::finish).transpose()?;
        Ok((self.snapshot, wrote))
    }
}

/// Sends lines to a requested table; a table whose reader has closed the pipe is dropped.
fn send(sink: &mut Option<Sink>, lines: impl FnOnce() -> String) -> Result<Sent, Error> {
    let sent = sink.as_mut().map_or(Ok(Sent::Well), |s| s.send(&lines()))?;
    if sent == Sent::Closed {
        *sink = None;
    }
    Ok(sent)
}

fn first_closed(a: Sent, b: Sent) -> Sent {
    if a == Sent::Closed { a } else { b }
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
    tally: Tally<'a>,
}

/// Counters and warnings of a run.
struct Tally<'a> {
    scene: &'a Scene,
    progress: Progress,
    /// Minor iterations in total, and in the current increment.
    steps: u64,
    minors: u64,
    /// Accepted increments, and their major iterations.
    accepted: u64,
    majors: u64,
    /// Increments accepted with a warning.
    doubtful: u32,
    /// Load factors of increments that were accepted with a fallback.
    found: BTreeMap<Fallback, Vec<f64>>,
    /// Load factors of accepted increments that jumped, and of those that lost stability.
    jumps: Vec<f64>,
    losses: Vec<f64>,
    /// Number of strategy changes and step-size reductions.
    notes: u32,
    /// Norms of the accepted increment with the largest round-off in its forces.
    noisiest: Norms,
    /// Largest relative error of an accepted increment that is within its limit.
    reached: f64,
    /// Largest natural map of forces that their modes do not determine.
    settled: Option<f64>,
    quiet: bool,
    /// Stability of the accepted states, if requested.
    stability: Option<Stretches>,
    /// Maximum iterations per increment of an attached solver, and the detection of repeating modes.
    most: Option<(u64, CycleWatch)>,
    /// Monitors and slave-node values after the last accepted increment.
    monitors: Vec<f64>,
    slaves: Vec<ContactRecord>,
    /// Present if `touch: auto` has a choice.
    touch: Option<TouchWatch>,
}

/// How a run ended: stopped by `Closed`, or lost if an attached solver fails.
type Ending = Result<RunEnd<Closed>, Lost>;

/// Why the run was stopped here.
enum Closed {
    /// All readers have closed their pipes.
    Pipe,
    /// An attached solver exceeded its maximum iterations; describes its last modes.
    Endless(String),
}

impl<'a> Run<'a> {
    fn new(scene: &'a Scene, mut solver: Box<dyn Solver>, args: &Args) -> Self {
        let quiet = args.quiet;
        let (model, spec) = (&scene.model, &scene.spec);
        let chosen = spec.settings.touch == Touch::Auto && model.settings.touch == Touch::Ratio;
        let watched = chosen && model.control != Control::Arc && !quiet;
        let stepper = solver.stepper().filter(|_| watched);
        let touch = stepper.map(|stepper| TouchWatch::new(stepper.state()));
        Run {
            solver,
            tally: Tally {
                scene,
                progress: Progress::new(quiet),
                steps: 0,
                minors: 0,
                accepted: 0,
                majors: 0,
                doubtful: 0,
                found: BTreeMap::new(),
                jumps: Vec::new(),
                losses: Vec::new(),
                notes: 0,
                noisiest: Norms::default(),
                reached: 0.0,
                settled: None,
                quiet,
                most: args
                    .subject
                    .solver
                    .is_named()
                    .then(|| (args.most, CycleWatch::default())),
                stability: args.stability.then(Stretches::default),
                monitors: Vec::new(),
                slaves: Vec::new(),
                touch,
            },
        }
    }

    fn go(&mut self, outputs: &mut RunOutputs, interrupt: &Interrupt) -> Result<Ending, Error> {
        let Run { solver, tally } = self;
        let solver = &mut **solver;
        let stability = tally.stability.is_some();
        if outputs.headers(&tally.scene.model, stability)? == Sent::Closed {
            return Ok(Ok(RunEnd::Stopped(Closed::Pipe)));
        }
        if let Some((grids, stepper)) = outputs.grids.as_mut().zip(solver.stepper()) {
            grids.start(stepper)?;
        }
        let came = || interrupt.came();
        let until = Until::end().interrupted_by(&came);
        let end = drive(solver, until, |solver| match tally.see(solver, outputs) {
            Ok(Sent::Well) => match tally.endless(solver) {
                None => ControlFlow::Continue(()),
                Some(text) => ControlFlow::Break(Ok(Closed::Endless(text))),
            },
            Ok(Sent::Closed) => ControlFlow::Break(Ok(Closed::Pipe)),
            Err(error) => ControlFlow::Break(Err(error)),
        });
        let end = match end {
            Ok(end) => end,
            Err(lost) => return Ok(Err(lost)),
        };
        Ok(Ok(match end {
            RunEnd::Stopped(stopped) => RunEnd::Stopped(stopped?),
            RunEnd::Failed(failure) => RunEnd::Failed(failure),
            RunEnd::Interrupted => RunEnd::Interrupted,
            RunEnd::Finished | RunEnd::Spent => RunEnd::Finished,
        }))
    }

    /// Prints how the run ended.
    fn notify(&mut self, end: &Ending, args: &Args, interrupt: &Interrupt) -> Exit {
        if self.tally.doubtful > MOST_WARNINGS {
            notify(&format!(
                "warning: {} increments in total were accepted with warnings",
                self.tally.doubtful
            ));
        }
        if let Some(left) = accuracy::left(&self.tally.noisiest) {
            notify(&format!("warning: {left}"));
        }
        let tolerance = self.tally.scene.model.settings.tolerance;
        if let Some(raised) =
            accuracy::raised(tolerance, self.tally.reached).filter(|_| !args.quiet)
        {
            notify(&format!("note: {raised}"));
        }
        if let Some(error) = self.tally.settled.filter(|_| !args.quiet) {
            notify(&format!("note: {}", accuracy::not_unique(error)));
        }
        if self.tally.notes > MOST_WARNINGS && !args.quiet {
            notify(&format!(
                "note: {} such notes in total; the rest is not shown",
                self.tally.notes
            ));
        }
        if !args.quiet {
            self.tell_summary(args.csv.is_none());
            if self.tally.scene.model.monitors.is_empty() {
                self.tally.tell_slaves();
            }
        }
        if let Some(touch) = self.tally.touch.as_ref().filter(|_| !interrupt.came())
            && let Some(difference) = touch.measure(self.solver.model())
        {
            notify(&format!("note: {}", difference.words()));
        }
        let name = &self.tally.scene.name;
        let end = match end {
            Ok(end) => end,
            Err(lost) => {
                notify(&format!("{name}: {lost}"));
                return Exit::Unconverged;
            }
        };
        match end {
            RunEnd::Finished | RunEnd::Spent => self.tell_branches(),
            // A reader that closes the pipe has all the data it wants.
            RunEnd::Stopped(Closed::Pipe) => Exit::Good,
            RunEnd::Stopped(Closed::Endless(text)) => {
                notify(&format!("{name}: {text}"));
                Exit::Unconverged
            }
            RunEnd::Interrupted => {
                let at = names::position(self.solver.state().next);
                notify(&format!("{name}: interrupted before {at}"));
                Exit::Interrupted
            }
            RunEnd::Failed(failure) => {
                let (event, state) = (self.solver.event(), self.solver.state());
                let text = report::failure(
                    &self.tally.scene.model,
                    state,
                    event.position,
                    event.load_factor,
                    failure,
                );
                self.tell_marks();
                notify(&format!("{name}: {text}"));
                if self.solver.stepper().is_none() {
                    // Only an attached solver knows the cause.
                    notify("  `stickslip attach` opens it in the debugger; d shows the cause");
                    return Exit::Unconverged;
                }
                let (state, model) = (self.solver.state().clone(), self.solver.model().clone());
                let mut scratch = solver(model);
                let remedies = remedies::command(self.tally.scene);
                notify(&format!(
                    "  `{remedies}` tries every remedy; in the debugger, d shows the cause"
                ));
                let stop = || interrupt.came();
                let most = (&self.tally.scene.spec, self.tally.steps);
                for line in page::causes(&mut scratch, &state, failure, &stop) {
                    notify(&format!("  why: {line}"));
                }
                let works = page::first_that_works(&mut scratch, &state, failure, most, &stop);
                if let Some(line) = works {
                    notify(&format!("  try: {}", line.option()));
                }
                Exit::Unconverged
            }
        }
    }

    /// Reports where the accepted states leave the branch of stable equilibrium.
    fn tell_marks(&self) {
        let Tally {
            scene,
            found,
            jumps,
            losses,
            ..
        } = &self.tally;
        let name = &scene.name;
        let loads = |all: &[f64]| first_of(all.iter().map(|&x| four(x)), MOST_STRETCHES, ", ");
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
        if !losses.is_empty() {
            let at = loads(losses);
            notify(&format!(
                "{name}: equilibrium becomes unstable at load {at}; a structure does not stay in the states after it (--stability checks each state; page jumps)"
            ));
        }
    }

    /// Reports whether the accepted states follow the requested stable path; the exit code reflects it, too.
    fn tell_branches(&self) -> Exit {
        let (name, model) = (&self.tally.scene.name, &self.tally.scene.model);
        self.tell_marks();
        let event = self.solver.event();
        if event.is_cut_short(model) {
            let (arc, load) = (four(event.arc.unwrap_or(f64::NAN)), event.load_factor);
            notify(&format!(
                "{name}: path incomplete: its maximum length {arc} was reached at load {} instead of load {}; page limit-points",
                four(load),
                model.path.last().unwrap_or(&f64::NAN)
            ));
            return Exit::Unconverged;
        }
        match model.jumps {
            Jumps::Cut | Jumps::Stop | Jumps::Dynamic if !self.tally.losses.is_empty() => {
                Exit::Unconverged
            }
            _ => Exit::Good,
        }
    }

    fn tell_summary(&self, monitors: bool) {
        notify(&format!(
            "{}: {} increments accepted, up to load {}; {} major and {} minor iterations",
            self.tally.scene.name,
            self.tally.accepted,
            self.solver.state().start.load_factor,
            self.tally.majors,
            self.tally.steps,
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
            notify(&format!("  {} {value:?}", shown::padded(&monitor.name, 12)));
        }
    }
}

impl Tally<'_> {
    /// Records and reports a minor iteration.
    fn see(&mut self, solver: &mut dyn Solver, outputs: &mut RunOutputs) -> Result<Sent, Error> {
        if let Some((grids, stepper)) = outputs.grids.as_mut().zip(solver.stepper()) {
            grids.see(stepper)?;
        }
        let event = solver.event();
        if let Some(touch) = &mut self.touch {
            touch.see(event, solver.state());
        }
        (self.steps, self.minors) = (self.steps + 1, self.minors + 1);
        self.progress.show(event, self.steps);
        let sent = send(&mut outputs.trace, || {
            let friction = &solver.state().controls.friction;
            table::trace_rows(&self.scene.model, friction, event)
        })?;
        match event.outcome {
            // The failure is reported even if no reader is left.
            Outcome::Failed(_) => return Ok(Sent::Well),
            Outcome::Climbed { .. }
            | Outcome::Cut { .. }
            | Outcome::Leaps { .. }
            | Outcome::Turns { .. }
            | Outcome::Fallback { .. }
            | Outcome::Damped { .. }
            | Outcome::Refused { .. } => self.note(event),
            Outcome::Increment { .. } => {
                let sent = first_closed(sent, self.accept(solver, outputs)?);
                return Ok(outputs.after(sent));
            }
            Outcome::Moves(Moves::LetsGo { .. }) => self.note(event),
            Outcome::Minor
            | Outcome::Major { .. }
            | Outcome::HeldBack { .. }
            | Outcome::Moves(_) => {}
        }
        Ok(outputs.after(sent))
    }

    /// If an attached solver has exceeded its maximum iterations in this increment, a message that describes its last modes.
    fn endless(&mut self, solver: &dyn Solver) -> Option<String> {
        let (most, watch) = self.most.as_mut()?;
        let (event, state) = (solver.event(), solver.state());
        watch.see(&Strip::new(solver.model(), state, Some(event), None, 0.0));
        if self.minors < *most {
            return None;
        }
        let rounds = watch
            .now()
            .map(|now| rounds::words(solver.model(), &now, false));
        Some(format!(
            "stopped after {most} iterations in one increment (--most): {}",
            rounds.unwrap_or_else(|| "the modes no longer change".into())
        ))
    }

    fn accept(&mut self, solver: &mut dyn Solver, outputs: &mut RunOutputs) -> Result<Sent, Error> {
        self.monitors.clear();
        solver.monitors(&mut self.monitors);
        let stability = self.stability.is_some().then(|| match solver.stepper() {
            Some(stepper) => stepper.stability(),
            None => Stability::NotKnown,
        });
        let event = solver.event();
        self.slaves.clone_from(&event.nodes);
        self.warn(event);
        let (minors, monitors) = (self.minors, &self.monitors);
        if let Some((stretches, stability)) = self.stability.as_mut().zip(stability) {
            stretches.add(event.load_factor, stability);
        }
        let model = &self.scene.model;
        let u = &solver.state().start.u;
        let row = || table::csv_row(model, event, minors, monitors, stability, u);
        let sent = send(&mut outputs.csv, row)?;
        self.accepted += 1;
        self.majors += u64::from(event.position.major);
        self.minors = 0;
        Ok(sent)
    }

    /// Prints modes and forces of the last accepted increment, for scenes without monitors.
    fn tell_slaves(&self) {
        if self.slaves.is_empty() {
            return;
        }
        let heads = ["", "node", "mode", "gap", "F_n", "F_t"];
        let mut table = vec![heads.map(str::to_owned).to_vec()];
        let contacts = &self.scene.model.contacts;
        let bonds = contacts.iter().any(|contact| !contact.bond.is_hard());
        if bonds {
            table[0].extend(["F_n/A", "F_t/A", "law"].map(str::to_owned));
        }
        for (slave, found) in self.slaves.iter().enumerate().take(MOST_SLAVES) {
            table.push(vec![
                String::new(),
                names::slave(&self.scene.model, slave).to_owned(),
                names::mode(found.decision.before).to_owned(),
                six(found.gap),
                six(found.f_n),
                six(found.f_t),
            ]);
            if let (true, Some(row)) = (bonds, table.last_mut()) {
                let contact = &contacts[slave];
                let by_area = contact.pressure(found.f_n, found.f_t);
                let text = by_area.map_or(["-".into(), "-".into()], |both| both.map(six));
                row.extend(text);
                row.push(bond::name(contact).to_owned());
            }
        }
        for line in aligned(&table, 3) {
            notify(&line);
        }
        if self.slaves.len() > MOST_SLAVES {
            let more = self.slaves.len() - MOST_SLAVES;
            notify(&format!(
                "  and {more} more slave nodes; --trace writes all"
            ));
        }
    }

    /// Reports a recovery of the strategy.
    fn note(&mut self, event: &Event) {
        self.notes += 1;
        if self.notes <= MOST_WARNINGS && !self.quiet {
            self.progress.clear();
            let text = report::outcome(&self.scene.model, event);
            notify(&format!("note: {text}"));
        }
    }

    /// Reports what the last increment was accepted in spite of.
    fn warn(&mut self, event: &Event) {
        let Outcome::Increment {
            after,
            jumped,
            unstable,
            found,
            ..
        } = event.outcome
        else {
            return;
        };
        if let Some(by) = found {
            self.found.entry(by).or_default().push(event.load_factor);
        }
        match unstable {
            Some(_) => self.losses.push(event.load_factor),
            None if jumped => self.jumps.push(event.load_factor),
            None => {}
        }
        if after.noise > self.noisiest.noise {
            self.noisiest = after;
        }
        let error = after.relative.max(after.interface);
        if let Some(error) = accuracy::natural_map(event) {
            self.settled = Some(self.settled.map_or(error, |most| most.max(error)));
        } else if error <= after.limit {
            self.reached = self.reached.max(error);
        }
        let although = report::reservations(&self.scene.model, event);
        if although.is_empty() {
            return;
        }
        self.doubtful += 1;
        if self.doubtful <= MOST_WARNINGS {
            let (increment, load) = (event.position.increment, event.load_factor);
            self.progress.clear();
            notify(&format!(
                "warning: increment {increment} (load {load}) was accepted{although}"
            ));
        }
    }
}

/// Load ranges of equal stability, each with its initial load.
#[derive(Default)]
struct Stretches(Vec<(f64, Stability)>);

impl Stretches {
    fn add(&mut self, load: f64, stability: Stability) {
        if self.0.last().is_none_or(|(_, last)| *last != stability) {
            self.0.push((load, stability));
        }
    }

    /// A one-line summary; `None` if no increment was accepted.
    fn words(&self) -> Option<String> {
        if self.0.is_empty() {
            return None;
        }
        let stretch =
            |(load, stability): &(f64, Stability)| format!("{stability} from load {load}");
        let first: Vec<String> = self.0.iter().take(MOST_STRETCHES).map(stretch).collect();
        let more = match self.0.len().saturating_sub(MOST_STRETCHES) {
            0 => String::new(),
            more => format!(", and {more} more changes; --csv lists all"),
        };
        Some(format!("stability: {}{more}", first.join(", ")))
    }
}
