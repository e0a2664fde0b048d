//! `stickslip chart`: error over cost for different settings.

use super::base::{Error, Exit, SetArgs, usage};
use super::interrupt::Interrupt;
use super::outputs::Outputs;
use super::sweep::{Report, SweepArgs};
use std::path::{Path, PathBuf};
use stickslip_core::counted;
use stickslip_scene::number::significant;
use stickslip_scene::readers::or_mistaken;
use stickslip_scene::{FileKind, aligned, sig2, sig6};
use stickslip_study::chart_file::{Chart, Truth};
use stickslip_study::chart_runs::{PlannedChart, sweep};
use stickslip_study::precision::{Cost, Measure, Point, Precision, ROUND_OFF};
use stickslip_study::precision_table;
use stickslip_study::{Vary, precision_figure};

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Scenes 01 to 05 and osc-inclined-cantilever have predefined charts (problems/charts): meshes, increments, \
element orders, settings. Other scenes are run with several meshes, increments and both kinds of T_max.

Runs that fail are results, drawn in a row at the top of the picture. The exit code is 0 if the chart is \
complete, 2 for bad input or usage, 4 if runs are missing to --merge, 75 if a log is busy or cannot be written, \
and 130 if interrupted; files then contain the finished runs.")]
pub struct Args {
    /// Scene files, or names of built-in scenes
    #[arg(
        value_name = "SCENE",
        required_unless_present = "from",
        conflicts_with = "from"
    )]
    scenes: Vec<String>,
    /// Draws the table of an earlier chart (--csv) without running anything
    #[arg(long, value_name = "FILE", conflicts_with_all = ["log", "merge"])]
    from: Option<PathBuf>,
    /// Runs with each of the values, instead of the scene's predefined chart; may be repeated for the product of all
    #[arg(long, value_name = "PATH=A,B,C", value_parser = Vary::parse)]
    over: Vec<Vary>,
    #[command(flatten)]
    set: SetArgs,
    /// Measures errors by this monitor (a displacement or contact force); may be repeated [default: the chart's monitors, or all
    /// displacements]
    #[arg(long, value_name = "MONITOR", conflicts_with = "from")]
    by: Vec<String>,
    /// Marks the cheapest run whose error is at most this
    #[arg(long, value_name = "ERROR", value_parser = target)]
    target: Option<f64>,
    /// The cost: time, factorizations or minors
    #[arg(long, value_name = "WHAT", default_value = "time", value_parser = cost)]
    cost: Cost,
    /// Adds the runs of other programs, from a table like that of --csv; may be repeated (`help maps-and-charts`)
    #[arg(long, value_name = "FILE")]
    peers: Vec<PathBuf>,
    /// Draws the error on the horizontal axis and the cost on the vertical one
    #[arg(long)]
    error_on_x: bool,
    /// The reference: a table (CSV with the columns load and monitors), finest: the finest run of the chart, or richardson: the
    /// limit of the three finest runs of a series, with its error bar [default: the built-in table if there is one, else finest]
    #[arg(long, value_name = "FILE|finest|richardson")]
    reference: Option<String>,
    /// Repeats every run this many times, and takes the median of the times
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = repeats)]
    repeats: usize,
    #[command(flatten)]
    sweep: SweepArgs,
}

fn target(text: &str) -> Result<f64, String> {
    text.parse::<f64>()
        .ok()
        .filter(|t| *t > 0.0 && t.is_finite())
        .ok_or_else(|| "expected a positive number, such as 1e-3".to_owned())
}

fn repeats(text: &str) -> Result<usize, String> {
    const MOST: usize = 1000;
    let count = text.parse().ok().filter(|n| (1..=MOST).contains(n));
    count.ok_or_else(|| format!("expected a whole number from 1 to {MOST}"))
}

fn cost(text: &str) -> Result<Cost, String> {
    let all = Cost::NAMES.join(", ");
    Cost::from_word(text).ok_or_else(|| format!("expected one of {all}"))
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let peers = args
        .peers
        .iter()
        .map(|file| table(file, args))
        .collect::<Result<Vec<_>, _>>()?
        .concat();
    if let Some(file) = &args.from {
        let charts = with_peers(table(file, args)?, &peers)?;
        let outputs = Outputs::open(&args.sweep.out)?;
        report(charts, args.error_on_x).write(outputs, args.sweep.out.quiet)?;
        return Ok(Exit::Good);
    }
    if let Some(shard) = args.sweep.part().filter(|_| args.sweep.out.writes()) {
        return Err(usage!(
            "--shard {shard} runs only part of the cells, but a chart compares all; use --log, then --merge"
        ));
    }
    let interrupt = Interrupt::listen();
    let mut planned = Vec::new();
    for scene in &args.scenes {
        let mut chart = Chart::open(scene, &args.over)?;
        chart.set.extend(args.set.set.iter().cloned());
        chart.by.clone_from(&args.by);
        match args.reference.as_deref() {
            Some("finest") => chart.truth = Truth::Finest,
            Some("richardson") => chart.truth = Truth::Richardson,
            Some(file) => chart.truth = Truth::Table(Path::new(file).to_owned()),
            None => {}
        }
        planned.push(PlannedChart::new(chart)?);
    }
    let measure = Measure {
        cost: args.cost,
        target: args.target,
        repeats: args.repeats,
    };
    let sweep = sweep(&planned, args.repeats);
    args.sweep.run(&sweep, &interrupt, |mut results| {
        let mut charts = Vec::new();
        for planned in &planned {
            let rest = results.split_off(planned.runs());
            let own = std::mem::replace(&mut results, rest);
            charts.push(Precision::new(planned, own, measure)?);
        }
        Ok(report(with_peers(charts, &peers)?, args.error_on_x))
    })
}

/// The charts of a table.
fn table(file: &Path, args: &Args) -> Result<Vec<Precision>, Error> {
    let name = file.display().to_string();
    let text = precision_table::open(file)?;
    let charts = precision_table::read(&name, &text, args.cost, args.target);
    Ok(charts.map_err(|error| or_mistaken(error, &name, &text, FileKind::ChartTable))?)
}

/// Adds the runs of other programs to the charts of their scenes.
fn with_peers(mut charts: Vec<Precision>, peers: &[Precision]) -> Result<Vec<Precision>, Error> {
    for peer in peers {
        let Some(chart) = charts.iter_mut().find(|chart| chart.scene == peer.scene) else {
            let scene = &peer.scene;
            return Err(usage!(
                "--peers: no chart of the scene {scene}; each row needs the scene of a chart"
            ));
        };
        chart.add(peer);
    }
    Ok(charts)
}

fn report(charts: Vec<Precision>, error_on_x: bool) -> Report<'static> {
    Report {
        table: precision_table::csv(&charts),
        lines: charts.iter().flat_map(lines).collect(),
        warnings: Vec::new(),
        picture: Box::new(move || precision_figure::sheet(&charts, error_on_x)),
    }
}

fn lines(chart: &Precision) -> Vec<String> {
    let heads = [
        "",
        "series",
        "run",
        "error",
        "of forces",
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
            (None, true, _) => "reference".to_owned(),
            (None, false, 0) => String::new(),
            (None, false, n) => format!("{} unsettled", counted(n, "increment")),
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
                .map(|error| format!("{}{round_off}", significant(error, 3)))
                .unwrap_or_default(),
            point
                .force_error
                .map(|error| significant(error, 3))
                .unwrap_or_default(),
            sig6((point.seconds * 1e5).round() / 1e5),
            point.factorizations.to_string(),
            point.majors.to_string(),
            point.minors.to_string(),
            end,
        ]);
    }
    if chart.points.iter().all(|point| point.force_error.is_none()) {
        table.iter_mut().for_each(|row| drop(row.remove(4)));
    }
    let mut lines = vec![chart.title.clone()];
    lines.extend(aligned(&table, 3));
    lines.push("* on the Pareto front of cost and error   + within the target error".to_owned());
    if chart.points.iter().any(Point::is_round_off) {
        lines.push(format!(
            "= round-off: errors below {} are equal",
            sig2(ROUND_OFF)
        ));
    }
    lines.extend(chart.verdict());
    lines.extend(chart.about.iter().cloned());
    lines
}
