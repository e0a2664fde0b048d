//! `stickslip study`: a scene with many settings, as a table and as a figure.

use super::base::{Error, Exit, SetArgs, tell};
use super::benchmarks;
use super::interrupt::Interrupt;
use super::outputs::{OutputArgs, Outputs};
use super::parts::{PartArgs, failed};
use crate::explain::number::six;
use crate::outside::shown::aligned;
use crate::study::benchmarks::Benchmarks;
use crate::study::figure;
use crate::study::{AxisQuantity, CaseEnd, Plan, Run, Study, Vary, Watch, csv, plot, run};

/// Monitors shown in the table of runs.
const MONITORS: usize = 2;

#[derive(Debug, clap::Args)]
#[command(after_help = "\
A study file is RON, (title: \"...\", scene: \"...\", vary: [(\"history.increment\", [0.01, 0.02])],
set: [...], x: \"u_x\", y: \"load\", about: \"...\"). Built in are fig-08-increment, fig-09-majors,
fig-10-minors, fig-11-roles (the paper's), geometry-01, geometry-02, limit-point-02, residual-methods,
t-max-friction and t-max-osc.

benchmarks is a list of scenes whose answers are known from elsewhere; a file of such a list is RON,
(title: \"...\", benchmarks: [(scene: \"...\", what: \"...\", of: \"MONITOR\", source: \"...\", value: 1.0,
within: 0.01)]). Exit code 1 where one does not hold.

Runs that fail are results: the exit code is 0 if the study was done, 2 for bad input or usage, 4 if runs
are missing to --merge, 75 if a log is busy or cannot be written, and 130 if it was interrupted; files are
whole then and have what was done.")]
pub struct Args {
    /// A scene or a study: a file, or a built-in name
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
    part: PartArgs,
    #[command(flatten)]
    out: OutputArgs,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    if let Some(list) = Benchmarks::open(&args.study)? {
        refuse_changes(args)?;
        return benchmarks::main(&list, &args.out);
    }
    let interrupt = Interrupt::listen();
    let plan = plan(args)?;
    // Before the runs, so that nobody waits for a result that then has no place to go.
    let outputs = Outputs::open(&args.out)?;
    let progress = args.out.progress(plan.increments(), "increments");
    let watch = Watch {
        stop: &|| interrupt.came(),
        done: &|increments| progress.inc(increments),
    };
    let keeping = args.part.keeping(&args.out)?;
    let kept = run::open(&plan, &keeping).map_err(|e| failed(e.into()))?;
    if let Some(incomplete) = args.part.whole(&kept) {
        return Ok(incomplete);
    }
    let runs = run::run_kept(&plan, &kept, args.out.jobs(), &watch);
    progress.finish_and_clear();
    let runs = runs.map_err(failed)?;
    if args.part.is_part() {
        let done = |k: usize| runs[k].as_ref().is_some_and(Run::is_over);
        return Ok(args.part.end(&kept, done, args.out.quiet));
    }
    let runs: Vec<Run> = runs.into_iter().flatten().collect();
    let chart = figure::chart(&plan, &runs);
    outputs.write(
        &csv::table(&plan, &runs),
        || plot::svg(&chart),
        || plot::png(&chart),
    )?;
    if !args.out.quiet {
        tell_table(&plan, &runs);
    }
    Ok(match tell_end(&plan, &runs) {
        true => Exit::Good,
        false => Exit::Interrupted,
    })
}

/// Benchmarks are run as they stand: what is changed has no value elsewhere.
fn refuse_changes(args: &Args) -> Result<(), Error> {
    let given = [
        ("--vary", !args.vary.is_empty()),
        ("--set", !args.set.set.is_empty()),
        ("--x", args.x.is_some()),
        ("--y", args.y.is_some()),
        ("--log", args.part.any()),
    ];
    match given.iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((option, _)) => Err(Error::Usage(format!(
            "{}: benchmarks are run as they stand; {option} is for studies and scenes",
            args.study
        ))),
    }
}

fn plan(args: &Args) -> Result<Plan, Error> {
    let mut study = Study::open(&args.study)?;
    for (k, vary) in args.vary.iter().enumerate() {
        if args.vary[..k].iter().any(|other| other.path == vary.path) {
            let path = &vary.path;
            return Err(Error::Usage(format!("--vary {path}: it is varied twice")));
        }
        study.vary(vary.clone());
    }
    study.set.extend(args.set.set.iter().cloned());
    if let Some(x) = &args.x {
        study.x = Some(AxisQuantity::named(x));
    }
    if let Some(y) = &args.y {
        study.y = Some(AxisQuantity::named(y));
    }
    Ok(Plan::new(study)?)
}

/// Tells what each run came to.
fn tell_table(plan: &Plan, runs: &[Run]) {
    tell(&plan.title);
    if !plan.study.about.is_empty() {
        tell(&plan.study.about);
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
        row.push(six(run.last().load));
        for name in monitors() {
            let value = run.value(run.last(), &AxisQuantity::Monitor(name.clone()));
            row.push(value.map_or_else(String::new, six));
        }
        row.push(run.unsettled().to_string());
        row.push(end(run));
        table.push(row);
    }
    for line in aligned(&table, plan.columns.len()) {
        tell(&line);
    }
}

fn end(run: &Run) -> String {
    match &run.end {
        CaseEnd::Finished => "whole".to_owned(),
        CaseEnd::Failed(failed) => format!(
            "{} in increment {}, major {}, load {}",
            failed.reason,
            failed.increment,
            failed.major,
            six(failed.load)
        ),
        CaseEnd::Interrupted => "interrupted".to_owned(),
        CaseEnd::NotRun => "not run".to_owned(),
    }
}

/// Tells what is not as one would wish; true if no run was stopped.
fn tell_end(plan: &Plan, runs: &[Run]) -> bool {
    let count = |is: fn(&Run) -> bool| runs.iter().filter(|run| is(run)).count();
    let (name, all) = (&plan.study.name, runs.len());
    let failed = count(|run| run.failed().is_some());
    if failed > 0 {
        tell(&format!("{name}: {failed} of {all} runs failed"));
    }
    let doubtful = count(|run| run.unsettled() > 0);
    if doubtful > 0 {
        tell(&format!(
            "{name}: {doubtful} of {all} runs have increments that were accepted unsettled"
        ));
    }
    let jumped = count(|run| run.jumped() > 0);
    if jumped > 0 {
        tell(&format!(
            "{name}: {jumped} of {all} runs jumped to another branch"
        ));
    }
    let left = count(|run| matches!(run.end, CaseEnd::Interrupted | CaseEnd::NotRun));
    if left > 0 {
        tell(&format!(
            "{name}: interrupted; {} of {all} runs were done",
            all - left
        ));
    }
    left == 0
}
