//! `stickslip remedies SCENE`, or `-- COMMAND`: solves up to the first increment that fails, tries every remedy there, and prints
//! their cost and result.

use super::base::{Error, Exit, notify, quoted, run_to_end, say};
use super::json::{self, JsonArgs};
use super::records::{FailureKind, FailureRecord, RemediesRecord, RemedyRecord};
use super::solver::{Subject, SubjectArgs, step_to_end};
use stickslip_core::{Failure, RunEnd, Solver, State};
use stickslip_debugger::explain::remedies::{self, COLUMNS, RemainingViolations, TrialEnd};
use stickslip_debugger::explain::remedy::Remedy;
use stickslip_debugger::explain::report;
use stickslip_debugger::explain::{attached, failures, page};
use stickslip_debugger::history::rounds::{self, CycleWatch};
use stickslip_debugger::{DiagnosisPage, Examination, RemedyTrial, ReportedIterations, Strip};
use stickslip_scene::{Scene, aligned};

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Exit codes: 0 a remedy gets the scene past the failure, or nothing fails; 3 no remedy does.")]
pub struct Args {
    #[command(flatten)]
    subject: SubjectArgs,
    #[command(flatten)]
    json: JsonArgs,
    /// Overwrites existing files
    #[arg(long)]
    force: bool,
}

/// The command that tries the remedies of a scene, with its options.
pub fn command(scene: &Scene) -> String {
    let set = scene.overrides();
    let set = set.map(|(path, value)| format!(" --set {}", quoted(&format!("{path}={value}"))));
    format!(
        "stickslip remedies {}{}",
        quoted(&scene.name),
        set.collect::<String>()
    )
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let Subject { scene, mut solver } = args.subject.open(args.force, None)?;
    let json = args.json.open(args.force)?;
    let spec = Some(&scene.spec);
    let mut record = RemediesRecord {
        schema: "stickslip-remedies-1",
        scene: scene.name.clone(),
        exit_code: Exit::Good as u8,
        failure: None,
        why: Vec::new(),
        remedies: Vec::new(),
    };
    let mut watch = Watch {
        state: solver.state().clone(),
        iterations: ReportedIterations::default(),
        cycle: CycleWatch::default(),
    };
    let failure = match solver.stepper() {
        Some(stepper) => run_to_end(stepper),
        None => match step_to_end(solver.as_mut(), None, &mut |solver| watch.see(solver))? {
            RunEnd::Failed(failure) => Some(failure),
            _ => None,
        },
    };
    let Some(failure) = failure else {
        notify("the scene converges; nothing to remedy");
        json::write(json, &record)?;
        return Ok(Exit::Good);
    };
    let state = solver.state().clone();
    let (model, event) = (solver.model().clone(), solver.event());
    let (at, load) = (event.position, event.load_factor);
    record.failure = Some(FailureRecord::new(&model, at, load, &failure));
    notify(&report::failure(&model, &state, at, load, &failure));
    let (why, all) = match solver.stepper() {
        Some(stepper) => (
            page::causes(stepper, &state, &failure, &|| false),
            remedies::all(stepper, &state, spec, &|| false),
        ),
        None => offered(solver.as_mut(), &state, &failure, watch),
    };
    record.why = why;
    for line in &record.why {
        notify(&format!("  why: {line}"));
    }
    let (mut trials, mut untried) = (Vec::new(), Vec::new());
    for remedy in all {
        match remedies::attempt(solver.as_mut(), &state, spec, &remedy, &|| false) {
            Some(trial) => trials.push(trial),
            None => untried.push(remedy),
        }
    }
    remedies::sort(&mut trials);
    if !args.json.is_on_standard_output() {
        say(&table(&trials))?;
    }
    let any = trials.iter().any(|trial| trial.end == TrialEnd::Converged);
    let exit = if any { Exit::Good } else { Exit::Unconverged };
    record.exit_code = exit as u8;
    record.remedies = trials.iter().map(tried).collect();
    record.remedies.extend(untried.iter().map(not_tried));
    json::write(json, &record)?;
    Ok(exit)
}

/// The last iterations of an attached solver.
struct Watch {
    state: State,
    iterations: ReportedIterations,
    cycle: CycleWatch,
}

impl Watch {
    fn see(&mut self, solver: &dyn Solver) {
        let (event, state) = (solver.event(), solver.state());
        self.iterations.add(&self.state, event, state);
        let strip = Strip::new(solver.model(), state, Some(event), None, 0.0);
        self.cycle.see(&strip);
        self.state = state.clone();
    }
}

/// The causes that the iterations of an attached solver and its interface problem show, as on the page of the debugger, and the
/// remedies that the solver offers.
fn offered(
    solver: &mut dyn Solver,
    state: &State,
    failure: &Failure,
    mut watch: Watch,
) -> (Vec<String>, Vec<Remedy>) {
    let model = solver.model().clone();
    let found = match solver.interface_problem(state) {
        Ok(posed) => attached::examine(&model, state, &posed, &watch.iterations, &[], &|| false),
        Err(_) => Examination::default(),
    };
    let all = remedies::offered(&model, state, &solver.capabilities(), &found);
    let rounds = watch.cycle.now();
    let rounds = rounds.map(|found| rounds::words(&model, &found, false));
    let reported = [failures::describe(&model, failure)].into_iter();
    let head = Some(found.head.clone()).filter(|head| !head.is_empty());
    let page = DiagnosisPage::attached(reported.chain(rounds).collect(), found, Vec::new());
    let why = if page.why.is_empty() {
        head.into_iter().collect()
    } else {
        page.why
    };
    (why, all)
}

/// The trials as text.
fn table(trials: &[RemedyTrial]) -> String {
    let mut headings = vec!["remedy".to_owned()];
    headings.extend(COLUMNS.map(String::from));
    headings.push("how".to_owned());
    let mut rows = vec![headings];
    rows.extend(trials.iter().map(|trial| {
        let mut row = vec![trial.label.clone()];
        row.extend(remedies::row(trial));
        row.push(trial.how.typed());
        row
    }));
    aligned(&rows, 1).join("\n") + "\n"
}

fn not_tried(remedy: &Remedy) -> RemedyRecord {
    RemedyRecord {
        remedy: remedy.label.clone(),
        command: remedy.how.typed(),
        ..RemedyRecord::default()
    }
}

fn tried(trial: &RemedyTrial) -> RemedyRecord {
    let (outcome, failure, law) = match &trial.end {
        TrialEnd::Converged => ("converged", None, None),
        TrialEnd::Against(law) => ("law-violated", None, Some(law.name())),
        TrialEnd::Failed(failure) => (
            "failed",
            Some(FailureKind::from_failure(failure).word()),
            None,
        ),
        TrialEnd::Budget => ("limit", None, None),
    };
    let left = |of: fn(&RemainingViolations) -> f64| trial.left.as_ref().map(of);
    RemedyRecord {
        remedy: trial.label.clone(),
        command: trial.how.typed(),
        tried: true,
        outcome: Some(outcome),
        failure,
        law,
        minors: Some(trial.minors),
        majors: Some(trial.majors),
        factorizations: Some(trial.factorizations),
        seconds: Some(trial.seconds),
        penetration: left(|left| left.penetration),
        tension: left(|left| left.tension),
        shear: left(|left| left.shear),
        residual: left(|left| left.residual),
        held: trial.left.map(|left| left.held),
    }
}
