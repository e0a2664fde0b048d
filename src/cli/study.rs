//! `stickslip study`: a scene with many settings, as a table and as a figure.

use super::interrupt::Interrupt;
use super::sink::{Sent, Sink};
use super::{Error, Exit, SetArgs, tell};
use crate::debug::files::Output;
use crate::study::figure::{self, short};
use crate::study::{self, End, Plan, Quantity, Run, Study, Vary, Watch, csv, plot};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use unicode_width::UnicodeWidthStr;

/// Monitors shown in the table of runs.
const MONITORS: usize = 2;

#[derive(Debug, clap::Args)]
#[command(after_help = "\
A study file is RON, (title: \"...\", scene: \"...\", vary: [(\"history.increment\", [0.01, 0.02])],
set: [...], x: \"u_x\", y: \"load\", about: \"...\"). Built in are fig-08-increment, fig-09-majors,
fig-10-minors, fig-11-roles (the paper's), geometry-01, geometry-02, residual-methods, t-max-friction and
t-max-osc.

Runs that fail are results: the exit code is 0 if the study was done, 2 for bad input or usage,
and 130 if it was interrupted; files are whole then and have what was done.")]
pub struct Args {
    /// A scene or a study: a file, or a built-in name
    #[arg(value_name = "SCENE|STUDY")]
    study: String,
    /// Runs with each of the values; may be repeated for the product of all
    #[arg(long, value_name = "PATH=A,B,C", value_parser = variation)]
    vary: Vec<Vary>,
    #[command(flatten)]
    set: SetArgs,
    /// Horizontal axis: a monitor's name, load, increment, majors or minors [default: the first monitor]
    #[arg(long, value_name = "QUANTITY")]
    x: Option<String>,
    /// Vertical axis, likewise [default: load]
    #[arg(long, value_name = "QUANTITY")]
    y: Option<String>,
    /// Writes a row per run and accepted increment; - is standard output
    #[arg(long, value_name = "FILE|-")]
    csv: Option<String>,
    /// Draws the figure
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Draws the figure as a bitmap
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// Runs at the same time [default: one per core]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// Overwrites files that exist
    #[arg(long)]
    force: bool,
    /// Prints nothing but warnings and errors
    #[arg(long, short)]
    quiet: bool,
}

fn variation(text: &str) -> Result<Vary, String> {
    match text.split_once('=') {
        Some((path, values)) => Ok(Vary {
            path: path.trim().to_owned(),
            values: values.split(',').map(|v| v.trim().to_owned()).collect(),
        }),
        None => Err("it must be PATH=A,B,C, as history.increment=0.01,0.02".to_owned()),
    }
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let interrupt = Interrupt::listen();
    let plan = plan(args)?;
    // Before the runs, so that nobody waits for a result that then has no place to go.
    let outputs = Outputs::open(args)?;
    let progress = Progress::new(&plan, args.quiet);
    let watch = Watch {
        stop: &|| interrupt.came(),
        done: &|increments| progress.bar.inc(increments),
    };
    let runs = study::run(&plan, jobs(args), &watch);
    progress.bar.finish_and_clear();
    let runs = runs.map_err(|e| Error::Usage(e.to_string()))?;
    let sent = outputs.write(&plan, &runs)?;
    if !args.quiet {
        tell_table(&plan, &runs);
    }
    let whole = tell_end(&plan, &runs);
    Ok(match (sent, whole) {
        (Sent::Well, true) => Exit::Good,
        _ => Exit::Interrupted,
    })
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
        study.x = Some(Quantity::named(x));
    }
    if let Some(y) = &args.y {
        study.y = Some(Quantity::named(y));
    }
    Ok(Plan::new(study)?)
}

fn jobs(args: &Args) -> NonZeroUsize {
    let cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    args.jobs.unwrap_or_else(cores)
}

/// What a study writes.
struct Outputs {
    csv: Option<Sink>,
    svg: Option<Output>,
    png: Option<Output>,
}

impl Outputs {
    fn open(args: &Args) -> Result<Outputs, Error> {
        let named = [
            args.csv.as_deref().filter(|to| *to != "-").map(Path::new),
            args.svg.as_deref(),
            args.png.as_deref(),
        ];
        let named: Vec<&Path> = named.into_iter().flatten().collect();
        for (k, name) in named.iter().enumerate() {
            if named[..k].contains(name) {
                return Err(Error::Usage(format!(
                    "{}: only one of --csv, --svg and --png can go there",
                    name.display()
                )));
            }
        }
        let output = |path: &PathBuf| Output::create(path, args.force);
        let csv = args.csv.as_deref().map(|to| Sink::open(to, args.force));
        Ok(Outputs {
            csv: csv.transpose()?,
            svg: args.svg.as_ref().map(output).transpose()?,
            png: args.png.as_ref().map(output).transpose()?,
        })
    }

    fn write(self, plan: &Plan, runs: &[Run]) -> Result<Sent, Error> {
        let mut sent = Sent::Well;
        // The numbers first: they are kept even if a figure cannot be drawn.
        if let Some(mut sink) = self.csv {
            sent = sink.send(&csv::table(plan, runs))?;
            sink.finish()?;
        }
        let chart = figure::chart(plan, runs);
        let undrawn = |e: plot::PlotError| Error::Usage(e.to_string());
        if let Some(output) = self.svg {
            write(output, plot::svg(&chart).map_err(undrawn)?.as_bytes())?;
        }
        if let Some(output) = self.png {
            write(output, &plot::png(&chart).map_err(undrawn)?)?;
        }
        Ok(sent)
    }
}

fn write(mut output: Output, bytes: &[u8]) -> Result<(), Error> {
    output.write_all(bytes).map_err(|e| output.failed(e))?;
    Ok(output.finish()?)
}

/// A bar on a terminal that says how far all runs together are.
struct Progress {
    bar: ProgressBar,
}

impl Progress {
    fn new(plan: &Plan, quiet: bool) -> Progress {
        let target = match !quiet && io::stderr().is_terminal() {
            true => ProgressDrawTarget::stderr(),
            false => ProgressDrawTarget::hidden(),
        };
        let bar = ProgressBar::with_draw_target(Some(plan.increments()), target);
        let shape = "{wide_bar} {pos} of {len} increments, {eta} left";
        if let Ok(style) = ProgressStyle::with_template(shape) {
            bar.set_style(style);
        }
        Progress { bar }
    }
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
        row.push(short(run.last().load));
        for name in monitors() {
            let value = run.value(run.last(), &Quantity::Monitor(name.clone()));
            row.push(value.map_or_else(String::new, short));
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
        End::Finished => "whole".to_owned(),
        End::Failed(failed) => format!(
            "{} in increment {}, major {}, load {}",
            failed.reason,
            failed.increment,
            failed.major,
            short(failed.load)
        ),
        End::Interrupted => "interrupted".to_owned(),
        End::NotRun => "not run".to_owned(),
    }
}

/// Lines of a table: values and the last column to the left, numbers to the right.
fn aligned(table: &[Vec<String>], values: usize) -> Vec<String> {
    let columns = table.first().map_or(0, Vec::len);
    let width = |k: usize| table.iter().map(|row| row[k].width()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let cell = |k: usize, text: &String| {
        let blanks = " ".repeat(widths[k] - text.width());
        match k < values || k + 1 == columns {
            true => format!("{text}{blanks}"),
            false => format!("{blanks}{text}"),
        }
    };
    let line = |row: &Vec<String>| {
        let cells: Vec<String> = row.iter().enumerate().map(|(k, t)| cell(k, t)).collect();
        cells.join("  ").trim_end().to_owned()
    };
    table.iter().map(line).collect()
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
    let left = count(|run| matches!(run.end, End::Interrupted | End::NotRun));
    if left > 0 {
        tell(&format!(
            "{name}: interrupted; {} of {all} runs were done",
            all - left
        ));
    }
    left == 0
}
