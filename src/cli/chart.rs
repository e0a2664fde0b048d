//! `stickslip chart`: what settings cost, and how far from the truth they are.

use super::base::{Error, Exit, NoValue, SetArgs, tell};
use super::interrupt::Interrupt;
use super::outputs::{OutputArgs, Outputs};
use super::parts::{PartArgs, failed};
use crate::explain::number::six;
use crate::format::kind::{FileKind, mistaken};
use crate::outside::shown::aligned;
use crate::study::chart_file::{Chart, Truth};
use crate::study::chart_runs::{self, Planned};
use crate::study::precision::{self, Cost, Measure, Point, Precision, PrecisionError, ROUND_OFF};
use crate::study::precision_table;
use crate::study::{Vary, Watch, precision_figure};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Scenes 01 to 05 and osc-inclined-cantilever have charts of their own (problems/charts): meshes, increments,
element orders, settings. Any other scene is run with meshes, increments and both kinds of T_max.

Runs that fail are results, and stand on a rail at the top of the picture: the exit code is 0 if the chart was
done, 2 for bad input or usage, 4 if runs are missing to --merge, 75 if a log is busy or cannot be written,
and 130 if it was interrupted; files have what was done.")]
pub struct Args {
    /// Scenes: files, or built-in names
    #[arg(
        value_name = "SCENE",
        required_unless_present = "from",
        conflicts_with = "from"
    )]
    scenes: Vec<String>,
    /// Draws the table of a chart that was made before (--csv), and runs nothing
    #[arg(long, value_name = "FILE", conflicts_with_all = ["log", "merge"])]
    from: Option<PathBuf>,
    /// Runs with each of the values, instead of the scene's own chart; may be repeated for the product of all
    #[arg(long, value_name = "PATH=A,B,C", value_parser = Vary::parse)]
    over: Vec<Vary>,
    #[command(flatten)]
    set: SetArgs,
    /// Measures errors by this monitor, whatever it is: a displacement, a contact force; may be repeated
    /// [default: the chart's own, else all displacements]
    #[arg(long, value_name = "MONITOR", conflicts_with = "from")]
    by: Vec<String>,
    /// Names the cheapest run whose error is at most this
    #[arg(long, value_name = "ERROR", value_parser = target)]
    target: Option<f64>,
    /// What is drawn as cost: time, factorizations or minors
    #[arg(long, value_name = "WHAT", default_value = "time", value_parser = cost)]
    cost: Cost,
    /// What is the truth: a table (CSV with the columns load and monitors), or finest: the finest run of the set
    /// [default: the program's own table where it has one, else finest]
    #[arg(long, value_name = "FILE|finest")]
    reference: Option<String>,
    /// Runs everything so often, and takes the median of the times
    #[arg(long, value_name = "N", default_value_t = 3)]
    repeats: usize,
    #[command(flatten)]
    part: PartArgs,
    #[command(flatten)]
    out: OutputArgs,
}

fn target(text: &str) -> Result<f64, NoValue> {
    let target = text
        .parse::<f64>()
        .ok()
        .filter(|t| *t > 0.0 && t.is_finite());
    target.ok_or_else(|| NoValue::new("it must be a number above 0, as 1e-3"))
}

fn cost(text: &str) -> Result<Cost, NoValue> {
    Cost::named(text)
        .ok_or_else(|| NoValue::new(format!("it must be one of {}", Cost::WORDS.join(", "))))
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    if let Some(file) = &args.from {
        let name = file.display().to_string();
        let text = precision_table::open(file).map_err(|e| Error::Usage(e.to_string()))?;
        let charts = precision_table::read(&name, &text, args.cost, args.target);
        let charts = charts.map_err(|error| {
            let told = mistaken(&name, &text, FileKind::ChartTable);
            Error::Usage(told.map_or(error.to_string(), |told| format!("{name}: {told}")))
        })?;
        let outputs = Outputs::open(&args.out)?;
        return finish(args, outputs, &charts);
    }
    let interrupt = Interrupt::listen();
    let mut planned = Vec::new();
    for scene in &args.scenes {
        let mut chart = Chart::open(scene, &args.over)?;
        chart.set.extend(args.set.set.iter().cloned());
        chart.by.clone_from(&args.by);
        match args.reference.as_deref() {
            Some("finest") => chart.truth = Truth::Finest,
            Some(file) => chart.truth = Truth::Table(Path::new(file).to_owned()),
            None => {}
        }
        planned.push(Planned::new(chart)?);
    }
    let outputs = Outputs::open(&args.out)?;
    let increments = planned.iter().map(Planned::increments).sum();
    let progress = args.out.progress(increments, "increments");
    let watch = Watch {
        stop: &|| interrupt.came(),
        done: &|increments| progress.inc(increments),
    };
    let keeping = args.part.keeping(&args.out)?;
    let kept = chart_runs::open(&planned, args.repeats, &keeping).map_err(|e| failed(e.into()))?;
    if let Some(incomplete) = args.part.whole(&kept) {
        return Ok(incomplete);
    }
    if args.part.is_part() {
        let done = chart_runs::run_part(&planned, args.repeats, &kept, &watch);
        progress.finish_and_clear();
        let done = done.map_err(failed)?;
        return Ok(args.part.end(&kept, |k| done[k], args.out.quiet));
    }
    let measure = Measure {
        cost: args.cost,
        target: args.target,
        repeats: args.repeats,
    };
    let made = |planned: &Planned| precision::run_kept(planned, measure, &kept, &watch);
    let charts: Result<Vec<Precision>, _> = planned.iter().map(made).collect();
    progress.finish_and_clear();
    let charts = match charts {
        Err(_) if interrupt.came() => {
            tell("interrupted before there was anything to compare");
            return Ok(Exit::Interrupted);
        }
        Err(PrecisionError::Run(error)) => return Err(failed(*error)),
        charts => charts.map_err(|e| Error::Usage(e.to_string()))?,
    };
    finish(args, outputs, &charts)
}

/// Writes, draws and tells charts.
fn finish(args: &Args, outputs: Outputs, charts: &[Precision]) -> Result<Exit, Error> {
    outputs.write(
        &precision_table::csv(charts),
        || precision_figure::sheet(charts)?.svg(),
        || precision_figure::sheet(charts)?.png(),
    )?;
    for chart in charts {
        if !args.out.quiet {
            tell_chart(chart);
        }
    }
    let left: usize = charts.iter().map(|c| c.planned - c.points.len()).sum();
    if left > 0 {
        tell(&format!("interrupted; {left} runs were not done"));
    }
    Ok(match left {
        0 => Exit::Good,
        _ => Exit::Interrupted,
    })
}

fn tell_chart(chart: &Precision) {
    tell(&chart.title);
    let heads = [
        "",
        "series",
        "run",
        "error",
        "time (s)",
        "factorizations",
        "majors",
        "minors",
        "end",
    ];
    let mut table = vec![heads.map(str::to_owned).to_vec()];
    for point in &chart.points {
        let end = match (&point.failed, point.reference, point.unsettled) {
            (Some(why), ..) => format!("✗ {why}"),
            (None, true, _) => "the reference".to_owned(),
            (None, false, 0) => String::new(),
            (None, false, n) => format!("{n} increments unsettled"),
        };
        let near = point
            .error
            .zip(chart.target)
            .is_some_and(|(error, target)| error <= target);
        let round_off = if point.is_round_off() { " =" } else { "" };
        table.push(vec![
            format!(
                "{}{}",
                if point.front { '*' } else { ' ' },
                if near { '+' } else { ' ' }
            ),
            chart.series[point.series].clone(),
            point.name.clone(),
            point
                .error
                .map_or_else(String::new, |error| format!("{error:.2e}{round_off}")),
            six((point.seconds * 1e5).round() / 1e5),
            point.factorizations.to_string(),
            point.majors.to_string(),
            point.minors.to_string(),
            end,
        ]);
    }
    for line in aligned(&table, 3) {
        tell(&line);
    }
    tell("* beaten by no other run in cost and error   + as near as is wanted");
    if chart.points.iter().any(Point::is_round_off) {
        tell(&format!(
            "= round-off: errors below {ROUND_OFF:.1e} are equal"
        ));
    }
    for line in chart
        .verdict()
        .into_iter()
        .chain(chart.about.iter().cloned())
    {
        tell(&line);
    }
}
