//! `stickslip audit`: the largest violation of each law over entire histories.

use super::base::{Error, Exit, SetArgs, notify, say, usage};
use super::course::Course;
use super::interrupt::Interrupt;
use super::json::{self, JsonArgs};
use super::records::{
    AuditRecord, FailureRecord, FindingRecord, HistoryRecord, InsideRecord, StretchRecord,
};
use super::solver::{SolverArgs, step_to_end};
use std::path::Path;
use std::sync::Arc;
use stickslip_attach::Attached;
use stickslip_core::{JudgedLaw, Model, Outcome, PointDeformation, RunEnd, Solver, counted};
use stickslip_debugger::Snapshot;
use stickslip_debugger::explain::audit::{Audit, PenetratingMaster, WorstFinding};
use stickslip_debugger::explain::judged;
use stickslip_debugger::explain::names;
use stickslip_debugger::explain::report;
use stickslip_debugger::explain::strain;
use stickslip_scene::solver::solver;
use stickslip_scene::{FileKind, Scene, shortest, sig2, sig4};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scene files, names of built-in scenes, or snapshots
    #[arg(
        required_unless_present_any = ["command", "listen"],
        conflicts_with_all = ["command", "listen"],
        value_name = "SCENE|SNAPSHOT"
    )]
    inputs: Vec<String>,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    json: JsonArgs,
    #[command(flatten)]
    solver: SolverArgs,
    /// Overwrites existing files
    #[arg(long)]
    force: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let interrupt = Interrupt::listen();
    let json = args.json.open(args.force)?;
    let mut exit = Exit::Good;
    let mut histories = Vec::new();
    let says = !args.json.is_on_standard_output();
    let mut solver = args
        .solver
        .attached(&args.set, args.force, Some(&interrupt))?;
    let of_solver = solver
        .iter_mut()
        .map(|(scene, solver)| attached(scene, solver, says, &interrupt));
    let of_scenes = args.inputs.iter().map(|input| {
        let course = open(input, args)?;
        one(&course, says, &interrupt)
    });
    for history in of_solver.chain(of_scenes) {
        let history = history?;
        match history.outcome {
            INTERRUPTED => exit = Exit::Interrupted,
            _ if history.violated => exit = Exit::Unconverged,
            _ => {}
        }
        histories.push(history);
        if exit == Exit::Interrupted {
            break;
        }
    }
    let record = AuditRecord {
        schema: "stickslip-audit-1",
        exit_code: exit as u8,
        histories,
    };
    json::write(json, &record)?;
    Ok(exit)
}

/// Opens a snapshot, or otherwise a scene; a snapshot file names its format.
fn open(input: &str, args: &Args) -> Result<Course, Error> {
    let path = Path::new(input);
    let kind = FileKind::from_file(path);
    if !matches!(kind, Some(FileKind::Journal | FileKind::Snapshot)) {
        return Ok(Course::from_scene(Scene::open(input, &args.set.set)?));
    }
    if !args.set.set.is_empty() {
        return Err(usage!(
            "{input}: snapshots are audited as recorded; --set is for scenes only"
        ));
    }
    Course::from_snapshot(input, Snapshot::read(path)?)
}

const INTERRUPTED: &str = "interrupted";

/// Audits a history; `says` is whether the report is printed.
fn one(course: &Course, says: bool, interrupt: &Interrupt) -> Result<HistoryRecord, Error> {
    let mut stepper = solver(Arc::new(course.scene.model.clone()));
    let mut audit = Audit::default();
    let end = course.go(&mut stepper, interrupt, |stepper| {
        let failed = matches!(stepper.event().outcome, Outcome::Failed(_));
        if !failed || course.steps.is_some() {
            audit.take(stepper);
        }
    })?;
    history(&course.scene, &audit, end, &stepper, says)
}

/// Audits the history of an attached solver.
fn attached(
    scene: &Scene,
    solver: &mut Attached,
    says: bool,
    interrupt: &Interrupt,
) -> Result<HistoryRecord, Error> {
    let mut audit = Audit::default();
    let see = &mut |solver: &dyn Solver| audit.take_reported(solver);
    let end = step_to_end(solver, Some(interrupt), see)?;
    history(scene, &audit, end, solver, says)
}

/// The report of an audited history.
fn history<S>(
    scene: &Scene,
    audit: &Audit,
    end: RunEnd<S>,
    solver: &dyn Solver,
    says: bool,
) -> Result<HistoryRecord, Error> {
    let (name, model) = (&scene.name, &scene.model);
    let mut history = record(name, model, audit);
    let failed = match end {
        RunEnd::Interrupted => {
            notify(&format!("{name}: interrupted"));
            history.outcome = INTERRUPTED;
            return Ok(history);
        }
        RunEnd::Failed(failure) => {
            let event = solver.event();
            Some((event.position, event.load_factor, failure))
        }
        RunEnd::Finished | RunEnd::Spent | RunEnd::Stopped(_) => None,
    };
    if says {
        say(&table(name, model, audit))?;
    }
    if let Some((position, load, failure)) = failed {
        let text = report::failure(model, solver.state(), position, load, &failure);
        notify(&format!("{name}: history ends early: {text}"));
        history.outcome = "failed";
        history.failure = Some(FailureRecord::new(model, position, load, &failure));
    }
    Ok(history)
}

/// The report as data.
fn record(name: &str, model: &Model, audit: &Audit) -> HistoryRecord {
    let finding = |found: &WorstFinding| finding_record(model, found);
    let stretch = |found: &WorstFinding<PointDeformation>| stretch_record(model, found);
    HistoryRecord {
        name: name.to_owned(),
        outcome: "finished",
        violated: audit.broken().next().is_some(),
        increments: audit.increments,
        marked: audit.marked,
        findings: audit.worst.iter().flatten().map(finding).collect(),
        marked_findings: audit.worst_marked.iter().flatten().map(finding).collect(),
        work: audit.work.as_ref().map(finding),
        stretch: audit.stretch.as_ref().map(stretch),
        outside_range: audit.outside.as_ref().map(stretch),
        master_inside: audit
            .inside
            .as_ref()
            .map(|found| inside_record(model, found)),
        failure: None,
    }
}

fn finding_record(model: &Model, found: &WorstFinding) -> FindingRecord {
    let finding = &found.finding;
    FindingRecord {
        law: finding.law.name(),
        violated: finding.is_broken(),
        increment: found.increment,
        load: found.load_factor,
        node: finding
            .slave
            .map(|slave| names::slave(model, slave).to_owned()),
        amount: finding.amount,
        allowed: finding.allowed,
    }
}

fn stretch_record(model: &Model, found: &WorstFinding<PointDeformation>) -> StretchRecord {
    let point = &found.finding;
    let body = model.bodies.get(point.body);
    StretchRecord {
        increment: found.increment,
        load: found.load_factor,
        body: body.map(|body| body.name.clone()).unwrap_or_default(),
        element: point.element + 1,
        stretch: point.stretch,
        determinant: point.determinant,
    }
}

fn inside_record(model: &Model, found: &WorstFinding<PenetratingMaster>) -> InsideRecord {
    let PenetratingMaster { node, body, depth } = found.finding;
    InsideRecord {
        increment: found.increment,
        load: found.load_factor,
        node: model.nodes[node].name.clone(),
        body: model.bodies[body].name.clone(),
        depth,
    }
}

/// The report as text.
fn table(name: &str, model: &Model, audit: &Audit) -> String {
    let Audit {
        increments, marked, ..
    } = audit;
    let accepted = counted(*increments, "increment");
    let mut text = match marked {
        0 => format!("{name}: {accepted} accepted\n"),
        _ => format!("{name}: {accepted} accepted, {marked} of them marked\n"),
    };
    text += "  law          worst     allowed   where\n";
    let of_bonds = JudgedLaw::OF_BONDS
        .into_iter()
        .filter(|law| audit.of(*law).is_some());
    for law in JudgedLaw::ALL.into_iter().chain(of_bonds) {
        text += &match audit.of(law) {
            None => format!("  {:<11}  -\n", law.name()),
            Some(found) => row(model, law, found),
        };
    }
    if let Some(found) = &audit.stretch {
        text += &format!(
            "  {:<11}  {:<8}            {}, {}\n",
            "stretch",
            sig4(found.finding.stretch),
            place(found),
            strain::element(model, &found.finding)
        );
    }
    if *marked > 0 {
        text += "  marked, not counted:\n";
        for found in audit.worst_marked.iter().flatten() {
            text += &row(model, found.finding.law, found);
        }
    }
    for found in audit.broken() {
        text += &format!(
            "  broken: {}: {}\n",
            place(found),
            judged::finding(model, &found.finding)
        );
    }
    if let Some(found) = audit
        .work
        .as_ref()
        .filter(|found| found.finding.is_broken())
    {
        text += &format!(
            "  also: {}: {}\n",
            place(found),
            judged::finding(model, &found.finding)
        );
    }
    if let Some(found) = &audit.outside {
        text += &format!(
            "  also: from {} on: {}\n",
            place(found),
            strain::left(model, &found.finding)
        );
    }
    if let Some(found) = &audit.inside {
        let PenetratingMaster { node, body, depth } = found.finding;
        text += &format!(
            "  also: {}: master node {} penetrates {} by {}; contact tests only slave nodes\n",
            place(found),
            model.nodes[node].name,
            model.bodies[body].name,
            sig4(depth)
        );
    }
    text
}

fn place<T>(found: &WorstFinding<T>) -> String {
    let load = shortest(found.load_factor);
    format!("increment {} (load {load})", found.increment)
}

fn row(model: &Model, law: JudgedLaw, found: &WorstFinding) -> String {
    let node = found
        .finding
        .slave
        .map_or("all", |s| names::slave(model, s));
    let over = if found.finding.is_broken() {
        "  BROKEN"
    } else {
        ""
    };
    format!(
        "  {:<11}  {:<8}  {:<8}  {}, {node}{over}\n",
        law.name(),
        sig2(found.finding.amount),
        sig2(found.finding.allowed),
        place(found)
    )
}
