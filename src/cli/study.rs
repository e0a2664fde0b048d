//! `stickslip study`: runs a scene with many settings, and makes a table and a figure.

use super::base::{Error, Exit, SetArgs, usage};
use super::benchmarks;
use super::interrupt::Interrupt;
use super::sweep::{Report, SweepArgs};
use stickslip_scene::{aligned, sig6};
use stickslip_study::benchmarks::Benchmarks;
use stickslip_study::figure;
use stickslip_study::{AxisQuantity, CaseEnd, Plan, Run, Study, Vary, csv, run};

/// Monitors shown in the table of runs.
const MONITORS: usize = 2;

#[derive(Debug, clap::Args)]
#[command(after_help = "\
A study file is RON, (title: \"...\", scene: \"...\", vary: [(\"history.increment\", [0.01, 0.02])], \
set: [...], x: \"u_x\", y: \"load\", about: \"...\"). Built-in studies: fig-08-increment, fig-09-majors, \
fig-10-minors, fig-11-roles (the paper's), geometry-01, geometry-02, limit-point-02, residual-methods, \
t-max-friction and t-max-osc.

benchmarks is a list of scenes with published reference values. A benchmark file is RON, \
(title: \"...\", benchmarks: [(scene: \"...\", what: \"...\", of: \"MONITOR\", source: \"...\", value: 1.0, \
within: 0.01)]). Exit code 1 if one fails.

Runs that fail are results. The exit code is 0 if the study is complete, 2 for bad input or usage, 4 if runs \
are missing to --merge, 75 if a log is busy or cannot be written, and 130 if interrupted; files then \
contain the finished runs.")]
pub struct Args {
    /// A study or a scene: a file, or a built-in name
    #[arg(value_name = "SCENE|STUDY")]
    study: String,
    /// Runs with each of the values; may be repeated for the product of all
    #[arg(long, value_name = "PATH=A,B,C", value_parser = Vary::parse)]
    vary: Vec<Vary>,
    #[command(flatten)]
    set: SetArgs,
    /// Horizontal axis: a monitor's name, load, increment, majors or minors [default: the first monitor]
    #[arg(long, value_name = "QUANTITY")]
    x: Option<String>,
    /// Vertical axis, likewise [default: load]
    #[arg(long, value_name = "QUANTITY")]
    y: Option<String>,
    #[command(flatten)]
    sweep: SweepArgs,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    if let Some(list) = Benchmarks::open(&args.study)? {
        refuse_changes(args)?;
        return benchmarks::main(&list, &args.sweep.out);
    }
    let interrupt = Interrupt::listen();
    let plan = plan(args)?;
    args.sweep.run(&run::sweep(&plan), &interrupt, |runs| {
        let (cases, runs): (_, Vec<Run>) = plan
            .cases
            .iter()
            .cloned()
            .zip(runs)
            .filter_map(|(c, run)| Some((c, run?)))
            .unzip();
        let plan = Plan {
            cases,
            ..plan.clone()
        };
        let chart = figure::chart(&plan, &runs);
        Ok(Report {
            table: csv::table(&plan, &runs),
            picture: Box::new(move || chart.sheet()),
            lines: lines(&plan, &runs),
            warnings: warnings(&plan, &runs),
        })
    })
}

/// Rejects changes to benchmarks: reference values exist only for the original scenes.
fn refuse_changes(args: &Args) -> Result<(), Error> {
    let given = [
        ("--vary", !args.vary.is_empty()),
        ("--set", !args.set.set.is_empty()),
        ("--x", args.x.is_some()),
        ("--y", args.y.is_some()),
        ("--log", args.sweep.is_kept()),
    ];
    match given.iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((option, _)) => Err(usage!(
            "{}: benchmarks cannot be changed; {option} is for studies and scenes only",
            args.study
        )),
    }
}

fn plan(args: &Args) -> Result<Plan, Error> {
    let mut study = Study::open(&args.study)?;
    for (k, vary) in args.vary.iter().enumerate() {
        if args.vary[..k].iter().any(|other| other.path == vary.path) {
            let path = &vary.path;
            return Err(usage!("--vary {path}: given twice"));
        }
        study.vary(vary.clone());
    }
    study.set.extend(args.set.set.iter().cloned());
    if args.x.is_some() || args.y.is_some() {
        study.text.clear();
    }
    if let Some(x) = &args.x {
        study.x = Some(AxisQuantity::named(x));
    }
    if let Some(y) = &args.y {
        study.y = Some(AxisQuantity::named(y));
    }
    Ok(Plan::new(study)?)
}

/// One line per run.
fn lines(plan: &Plan, runs: &[Run]) -> Vec<String> {
    let mut lines = vec![plan.title.clone()];
    if !plan.study.about.is_empty() {
        lines.push(plan.study.about.clone());
    }
    let monitors = || plan.monitors.iter().take(MONITORS);
    let mut header = figure::short_names(&plan.columns);
    let words = ["increments", "majors", "minors", "load"];
    header.extend(words.map(str::to_owned));
    header.extend(monitors().cloned());
    header.extend(["unsettled", "end"].map(str::to_owned));
    let mut table = vec![header];
    for (case, run) in plan.cases.iter().zip(runs) {
        let mut row = case.values.clone();
        row.push(format!("{}/{}", run.rows.len(), case.increments));
        row.push(run.majors().to_string());
        row.push(run.minors().to_string());
        row.push(sig6(run.last().load));
        for name in monitors() {
            let value = run.value(run.last(), &AxisQuantity::Monitor(name.clone()));
            row.push(value.map(sig6).unwrap_or_default());
        }
        row.push(run.unsettled().to_string());
        row.push(end(run));
        table.push(row);
    }
    lines.extend(aligned(&table, plan.columns.len()));
    lines
}

fn end(run: &Run) -> String {
    match &run.end {
        CaseEnd::Finished => "whole".to_owned(),
        CaseEnd::Failed(failed) => format!(
            "{} in increment {}, major {}, load {}",
            failed.reason,
            failed.increment,
            failed.major,
            sig6(failed.load)
        ),
        CaseEnd::Interrupted => "interrupted".to_owned(),
        CaseEnd::NotRun => "not run".to_owned(),
    }
}

/// Counts the runs that failed, were accepted unsettled, or jumped.
fn warnings(plan: &Plan, runs: &[Run]) -> Vec<String> {
    let (name, all) = (&plan.study.name, runs.len());
    type Is = fn(&Run) -> bool;
    let kinds: [(Is, &str); 3] = [
        (|run| run.failed().is_some(), "failed"),
        (
            |run| run.unsettled() > 0,
            "have increments accepted unsettled",
        ),
        (|run| run.jumped() > 0, "jumped to another branch"),
    ];
    kinds
        .map(|(is, words)| (runs.iter().filter(|run| is(run)).count(), words))
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, words)| format!("{name}: {count} of {all} runs {words}"))
        .collect()
}
