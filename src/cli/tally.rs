//! Counters, warnings and notes of `stickslip run`.

use super::base::{Error, OutputState, notify};
use super::progress::Progress;
use super::records::{FallbackRecord, MonitorRecord, MotionRecord, SlaveRecord, StabilityRecord};
use super::run_outputs::{RunOutputs, first_closed, send};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use stickslip_core::{
    ContactRecord, Event, Fallback, Mode, MotionEvent, Norms, Outcome, Solver, Stability, State,
    Status, counted,
};
use stickslip_debugger::Strip;
use stickslip_debugger::explain::accuracy;
use stickslip_debugger::explain::bond;
use stickslip_debugger::explain::limit_load::body_without_friction;
use stickslip_debugger::explain::names;
use stickslip_debugger::explain::report;
use stickslip_debugger::explain::touch::TouchWatch;
use stickslip_debugger::explain::unforced::PlaceWatch;
use stickslip_debugger::history::rounds::{self, CycleWatch};
use stickslip_debugger::record::table;
use stickslip_scene::number::UNREPORTED;
use stickslip_scene::{Scene, aligned, first_of, joined, shortest, sig6};

/// Warnings that are printed individually; others are only counted.
const MOST_WARNINGS: usize = 10;
/// Recoveries up to this number need no summary.
const LEAST_SUMMARY: u32 = 3;
/// Maximum number of slave nodes in the final table.
const MOST_SLAVES: usize = 40;
/// Maximum number of bodies named in a note about loose bodies.
const MOST_LOOSE: usize = 8;
/// Maximum number of load ranges or loads listed in a message about stability.
pub const MOST_STRETCHES: usize = 8;

/// Warnings and notes of a run: printed as they arise, and stored for `--json`.
#[derive(Default)]
pub struct Messages {
    /// Whether only warnings are printed.
    quiet: bool,
    pub warnings: Vec<String>,
    pub notes: Vec<String>,
}

impl Messages {
    pub fn new(quiet: bool) -> Messages {
        Messages {
            quiet,
            ..Messages::default()
        }
    }

    /// Adds a warning, which is always printed.
    pub fn warn(&mut self, text: String) {
        notify(&format!("warning: {text}"));
        self.warnings.push(text);
    }

    /// Adds a warning about the scene, which is printed unless the run is quiet.
    pub fn warn_of_scene(&mut self, text: String) {
        if !self.quiet {
            notify(&format!("warning: {text}"));
        }
        self.warnings.push(text);
    }

    /// Adds a note, which is printed unless the run is quiet.
    pub fn note(&mut self, text: String) {
        if !self.quiet {
            notify(&format!("note: {text}"));
        }
        self.notes.push(text);
    }
}

/// Counters and results of a run.
pub struct Tally<'a> {
    pub scene: &'a Scene,
    pub messages: Messages,
    pub progress: Progress,
    /// Minor iterations in total, and in the current increment.
    pub steps: u64,
    minors: u64,
    /// Accepted increments, and their major iterations.
    pub accepted: u64,
    pub majors: u64,
    /// Numbers of the increments accepted with a warning.
    pub doubtful: Vec<u32>,
    /// Whether a slave node was closed in an accepted increment.
    touched: bool,
    /// Accepted increments of an attached solver that violate a law.
    pub violated: u64,
    /// Load factors of increments that were accepted with a fallback.
    pub found: BTreeMap<Fallback, Vec<f64>>,
    /// Load factors of accepted increments that jumped, and of those that lost stability.
    pub jumps: Vec<f64>,
    /// Accepted increments that end a damped motion.
    pub motions: Vec<MotionRecord>,
    pub losses: Vec<f64>,
    /// Before the first of these: the body that has no friction left, and the load factor since when.
    pub without_friction: Option<(String, f64)>,
    /// What kept the run going, each with how often and its first and last increment.
    recoveries: BTreeMap<&'static str, (u32, RangeInclusive<u32>)>,
    /// Bodies without enough contact to be held, in the order of the scene, with the first and last increment in which they were.
    loose: BTreeMap<(usize, String), RangeInclusive<u32>>,
    /// Norms of the accepted increment with the largest round-off in its forces.
    noisiest: Norms,
    /// Largest relative error of an accepted increment that is within its limit.
    reached: f64,
    /// Largest natural map of forces that their modes do not determine.
    settled: Option<f64>,
    /// Stability of the accepted states, if requested.
    pub stability: Option<Stretches>,
    /// Maximum iterations per increment of an attached solver, and the detection of repeating modes.
    most: Option<(u64, CycleWatch)>,
    /// Monitors and slave-node values after the last accepted increment.
    pub monitors: Vec<f64>,
    slaves: Vec<ContactRecord>,
    /// Present if `touch: auto` has a choice.
    pub touch: Option<TouchWatch>,
    /// Present if this program solves the scene.
    pub unforced: Option<PlaceWatch>,
}

impl<'a> Tally<'a> {
    /// `most` limits the iterations per increment of an attached solver.
    pub fn new(scene: &'a Scene, quiet: bool, stability: bool, most: Option<u64>) -> Self {
        Tally {
            scene,
            messages: Messages::new(quiet),
            progress: Progress::new(quiet),
            steps: 0,
            minors: 0,
            accepted: 0,
            majors: 0,
            doubtful: Vec::new(),
            touched: false,
            violated: 0,
            found: BTreeMap::new(),
            jumps: Vec::new(),
            motions: Vec::new(),
            losses: Vec::new(),
            without_friction: None,
            recoveries: BTreeMap::new(),
            loose: BTreeMap::new(),
            noisiest: Norms::default(),
            reached: 0.0,
            settled: None,
            stability: stability.then(Stretches::default),
            most: most.map(|most| (most, CycleWatch::default())),
            monitors: Vec::new(),
            slaves: Vec::new(),
            touch: None,
            unforced: None,
        }
    }

    /// Records and reports a minor iteration.
    pub fn see(
        &mut self,
        solver: &mut dyn Solver,
        outputs: &mut RunOutputs,
    ) -> Result<OutputState, Error> {
        if let Some((grids, stepper)) = outputs.grids.as_mut().zip(solver.stepper()) {
            grids.see(stepper)?;
        }
        let event = solver.event();
        if let Some(touch) = &mut self.touch {
            touch.see(event, solver.state());
        }
        (self.steps, self.minors) = (self.steps + 1, self.minors + 1);
        let state = solver.state();
        self.progress
            .show(&self.scene.model, state, event, self.steps);
        let sent = send(&mut outputs.trace, || {
            let friction = &solver.state().controls.friction;
            table::trace_rows(&self.scene.model, friction, event)
        })?;
        match event.outcome {
            // The failure is reported even if no reader is left.
            Outcome::Failed(_) => return Ok(OutputState::Well),
            Outcome::StrategyChange { .. }
            | Outcome::Cut { .. }
            | Outcome::WholeIncrement { .. }
            | Outcome::PathCorner { .. }
            | Outcome::Fallback { .. }
            | Outcome::Damped { .. }
            | Outcome::Refused { .. } => self.note(event),
            Outcome::Increment { .. } => {
                let sent = first_closed(sent, self.accept(solver, outputs)?);
                return Ok(outputs.after(sent));
            }
            Outcome::Motion(MotionEvent::DynamicStart { .. }) => self.note(event),
            Outcome::Minor
            | Outcome::Major { .. }
            | Outcome::HeldBack { .. }
            | Outcome::Motion(_) => {}
        }
        Ok(outputs.after(sent))
    }

    /// If an attached solver has exceeded its maximum iterations in this increment, a message that describes its last modes.
    pub fn endless(&mut self, solver: &dyn Solver) -> Option<String> {
        let (most, watch) = self.most.as_mut()?;
        let (event, state) = (solver.event(), solver.state());
        watch.see(&Strip::new(solver.model(), state, Some(event), None, 0.0));
        if self.minors < *most {
            return None;
        }
        let most = counted(*most, "iteration");
        let rounds = self.rounds();
        Some(format!(
            "stopped after {most} in one increment (--max-iterations): {}",
            rounds.unwrap_or_else(|| "the modes no longer change".into())
        ))
    }

    /// How the modes of an attached solver keep changing.
    pub fn rounds(&mut self) -> Option<String> {
        let (_, watch) = self.most.as_mut()?;
        Some(rounds::words(&self.scene.model, &watch.now()?, false))
    }

    fn accept(
        &mut self,
        solver: &mut dyn Solver,
        outputs: &mut RunOutputs,
    ) -> Result<OutputState, Error> {
        self.monitors.clear();
        solver.monitors(&mut self.monitors);
        let stability = self.stability.is_some().then(|| match solver.stepper() {
            Some(stepper) => stepper.stability(),
            None => Stability::NotKnown,
        });
        let event = solver.event();
        self.slaves.clone_from(&event.nodes);
        let is_closed = |node: &ContactRecord| node.decision.before != Mode::Free;
        self.touched |= event.nodes.iter().any(is_closed);
        self.warn(event);
        let (minors, monitors) = (self.minors, &self.monitors);
        if let Some((stretches, stability)) = self.stability.as_mut().zip(stability) {
            stretches.add(event.load_factor, stability);
        }
        let model = &self.scene.model;
        let last = &solver.state().start;
        if let Some(unforced) = &mut self.unforced {
            unforced.see(model, event, last);
        }
        let row = || table::csv_row(model, event, minors, monitors, stability, &last.u);
        let sent = send(&mut outputs.csv, row)?;
        self.accepted += 1;
        self.majors += u64::from(event.position.major);
        self.minors = 0;
        Ok(sent)
    }

    /// Prints modes and forces of the last accepted increment, for scenes without monitors.
    pub fn report_slaves(&self) {
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
                found.decision.before.word().to_owned(),
                // Off all surfaces there is no gap.
                match found.gap.is_finite() {
                    true => sig6(found.gap),
                    false => UNREPORTED.to_owned(),
                },
                sig6(found.f_n),
                sig6(found.f_t),
            ]);
            if let (true, Some(row)) = (bonds, table.last_mut()) {
                let contact = &contacts[slave];
                let by_area = contact.pressure(found.f_n, found.f_t);
                let text = by_area.map_or(["-".into(), "-".into()], |both| both.map(sig6));
                row.extend(text);
                row.push(bond::name(contact).to_owned());
            }
        }
        for line in aligned(&table, 3) {
            notify(&line);
        }
        if self.slaves.len() > MOST_SLAVES {
            let more = counted(self.slaves.len() - MOST_SLAVES, "more slave node");
            notify(&format!("  and {more}; --trace writes all"));
        }
    }

    /// Number of recoveries so far.
    fn count_notes(&self) -> u32 {
        self.recoveries.values().map(|(count, _)| count).sum()
    }

    /// Reports a recovery of the strategy.
    fn note(&mut self, event: &Event) {
        let now = event.position.increment;
        let extended = |seen: &RangeInclusive<u32>| *seen.start()..=now;
        if let Some(kind) = report::recovery(&event.outcome) {
            let seen = self.recoveries.entry(kind).or_insert((0, now..=now));
            *seen = (seen.0 + 1, extended(&seen.1));
        }
        for body in report::loose_bodies(&event.outcome) {
            let bodies = &self.scene.model.bodies;
            let number = bodies.iter().position(|own| own.name == body);
            let key = (number.unwrap_or(bodies.len()), body.to_owned());
            let seen = self.loose.entry(key).or_insert(now..=now);
            *seen = extended(seen);
        }
        if self.count_notes() as usize <= MOST_WARNINGS {
            self.progress.clear();
            self.messages.note(report::note(&self.scene.model, event));
        }
    }

    /// Reports what the last increment was accepted in spite of.
    fn warn(&mut self, event: &Event) {
        let Outcome::Increment {
            after,
            jumped,
            unstable,
            found,
            motion,
            ref marked,
            ..
        } = event.outcome
        else {
            return;
        };
        self.violated += u64::from(self.most.is_some() && marked.is_some());
        if let Some(by) = found {
            self.found.entry(by).or_default().push(event.load_factor);
        }
        self.motions.extend(motion.map(|motion| MotionRecord {
            increment: event.position.increment,
            load: event.load_factor,
            from: motion.from,
            steps: motion.steps,
            dissipated: motion.dissipated,
        }));
        match unstable {
            Some(_) => self.losses.push(event.load_factor),
            None if jumped => self.jumps.push(event.load_factor),
            None => {}
        }
        if self.jumps.is_empty() && self.losses.is_empty() {
            let body = body_without_friction(&self.scene.model, &event.nodes);
            let since = self.without_friction.take();
            self.without_friction = body.map(|body| match since {
                Some(since) if since.0 == body => since,
                _ => (body.to_owned(), event.load_factor),
            });
        }
        if after.noise > self.noisiest.noise {
            self.noisiest = after;
        }
        let error = after.relative.max(after.interface);
        if let Some(error) = accuracy::natural_map(event) {
            self.settled = Some(self.settled.map_or(error, |most| most.max(error)));
        } else if error <= after.limit && self.most.is_none() {
            // An attached solver has its own tolerance.
            self.reached = self.reached.max(error);
        }
        let although = report::reservations(&self.scene.model, event);
        if although.is_empty() {
            return;
        }
        let (increment, load) = (event.position.increment, shortest(event.load_factor));
        self.doubtful.push(increment);
        if self.doubtful.len() <= MOST_WARNINGS {
            self.progress.clear();
            self.messages.warn(format!(
                "increment {increment} (load {load}) was accepted{although}"
            ));
        }
    }

    /// Adds the warnings and notes that summarise the run; `state` is its last state.
    pub fn sum_up(&mut self, state: &State) {
        if self.doubtful.len() > MOST_WARNINGS {
            self.messages.warn(format!(
                "{} increments in total were accepted with warnings",
                self.doubtful.len()
            ));
        }
        if let Some(left) = accuracy::left(&self.noisiest) {
            self.messages.warn(left);
        }
        if let Some(unforced) = &self.unforced {
            let log = unforced.log();
            for warning in log.warnings(&self.scene.model, &state.start) {
                self.messages.warn(warning);
            }
        }
        let tolerance = self.scene.model.settings.tolerance;
        if let Some(raised) = accuracy::raised(tolerance, self.reached) {
            self.messages.note(raised);
        }
        if let Some(error) = self.settled {
            self.messages.note(accuracy::not_unique(error));
        }
        if state.status == Status::Finished && !self.touched && !self.slaves.is_empty() {
            self.messages.note("no slave node touched a surface".into());
        }
        let within = |seen: &RangeInclusive<u32>| match (seen.start(), seen.end()) {
            (first, last) if first == last => format!("increment {first}"),
            (first, last) => format!("first in increment {first}, last in {last}"),
        };
        // Bodies that were loose in the same increments share a line.
        let mut alike: Vec<(&RangeInclusive<u32>, Vec<&str>)> = Vec::new();
        for ((_, body), seen) in &self.loose {
            match alike.iter_mut().find(|(other, _)| *other == seen) {
                Some((_, bodies)) => bodies.push(body),
                None => alike.push((seen, vec![body])),
            }
        }
        let loose = alike.iter().map(|(seen, bodies)| {
            let named = first_of(bodies, MOST_LOOSE, ", ");
            format!("loose until first contact: {named}, {}", within(seen))
        });
        let loose: Vec<String> = loose.collect();
        for line in loose {
            self.messages.note(line);
        }
        if self.count_notes() > LEAST_SUMMARY {
            let kinds = joined(
                self.recoveries
                    .iter()
                    .map(|(kind, (count, seen))| format!("{kind} {count} × ({})", within(seen))),
                ", ",
            );
            self.messages.note(format!("in total: {kinds}"));
        }
    }

    /// The monitors of the last accepted increment.
    pub fn monitors(&self) -> Vec<MonitorRecord> {
        self.scene
            .model
            .monitors
            .iter()
            .zip(&self.monitors)
            .map(|(monitor, &value)| MonitorRecord {
                name: monitor.name.clone(),
                value,
            })
            .collect()
    }

    /// The slave nodes in the last accepted increment.
    pub fn slaves(&self) -> Vec<SlaveRecord> {
        self.slaves
            .iter()
            .enumerate()
            .map(|(slave, found)| SlaveRecord {
                node: names::slave(&self.scene.model, slave).to_owned(),
                mode: found.decision.before.word(),
                gap: found.gap,
                f_n: found.f_n,
                f_t: found.f_t,
            })
            .collect()
    }

    /// The increments that were accepted with a fallback.
    pub fn fallbacks(&self) -> Vec<FallbackRecord> {
        self.found
            .iter()
            .flat_map(|(by, loads)| {
                let fallback = by.words();
                loads
                    .iter()
                    .map(move |&load| FallbackRecord { fallback, load })
                    .collect::<Vec<_>>()
            })
            .collect()
    }
}

/// Load ranges of equal stability, each with its initial load.
#[derive(Default)]
pub struct Stretches(Vec<(f64, Stability)>);

impl Stretches {
    fn add(&mut self, load: f64, stability: Stability) {
        if self.0.last().is_none_or(|(_, last)| *last != stability) {
            self.0.push((load, stability));
        }
    }

    /// The ranges.
    pub fn records(&self) -> Vec<StabilityRecord> {
        self.0
            .iter()
            .map(|&(load, stability)| StabilityRecord {
                load,
                stability: stability.to_string(),
            })
            .collect()
    }

    /// A one-line summary; `None` if no increment was accepted.
    pub fn words(&self) -> Option<String> {
        if self.0.is_empty() {
            return None;
        }
        let first = joined(
            self.0
                .iter()
                .take(MOST_STRETCHES)
                .map(|(load, stability)| format!("{stability} from load {}", shortest(*load))),
            ", ",
        );
        let more = match self.0.len().saturating_sub(MOST_STRETCHES) {
            0 => String::new(),
            more => format!(", and {}; --csv lists all", counted(more, "more change")),
        };
        Some(format!("stability: {first}{more}"))
    }
}
