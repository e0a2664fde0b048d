//! Work against precision: what a setting costs, and how far it is from the truth.
//!
//! A chart has series of runs of one scene. Each run's **error** is the largest difference of a monitor to the
//! reference's, over the reference's largest value of that kind (length, rotation, force), at those loads that the reference
//! and every run that went to its end have in common; a run that failed has none. Its **cost** is the processor time of its
//! thread, from the made scene to the end of the history (the median of some repetitions), its factorizations (as the
//! stepper makes them: one a major iteration where it condenses, else one a minor), and its minor iterations. Of the runs
//! that went to the end, those that no other one beats in both are the **front**; errors at round-off ([`ROUND_OFF`]) are equal there.

use super::chart_file::{Chart, Truth};
use super::chart_runs::{Planned, Timed, sweep};
use super::csv::TableError;
use super::figure::{assigned, name};
use super::monitor_kind::{MonitorKind, kind};
use super::one::Watch;
use super::origin;
use super::reference::{self, Reference};
use super::result::Run;
use super::sweep::RunError;
use std::collections::HashMap;
use std::num::NonZeroUsize;
use stickslip_core::model::Model;

/// Errors below this are round-off: a few thousand operations with the numbers' own.
pub const ROUND_OFF: f64 = 4096.0 * f64::EPSILON;

/// A work-precision chart of one scene.
#[derive(Debug, Clone)]
pub struct Precision {
    /// The scene's name.
    pub scene: String,
    /// What the chart is called.
    pub title: String,
    /// The monitors whose errors count.
    pub monitors: Vec<String>,
    /// What it was made from, and by what.
    pub about: Vec<String>,
    /// Names of the series.
    pub series: Vec<String>,
    /// The runs.
    pub points: Vec<Point>,
    /// What is counted as cost.
    pub cost: Cost,
    /// The error that is wanted, if any.
    pub target: Option<f64>,
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Number of its series.
    pub series: usize,
    /// What tells it from the others of its series.
    pub name: String,
    /// The same in full, as one would set it.
    pub settings: Vec<(String, String)>,
    /// Median processor time (seconds), of so many repetitions.
    pub seconds: f64,
    /// How many repetitions.
    pub repeats: usize,
    /// Factorizations of the bodies.
    pub factorizations: u64,
    /// Major iterations.
    pub majors: u64,
    /// Minor iterations.
    pub minors: u64,
    /// Accepted increments.
    pub increments: u64,
    /// Number of equations of the bodies.
    pub unknowns: usize,
    /// Why it did not get to its end; `None` if it did.
    pub failed: Option<String>,
    /// Increments that were accepted although a loop had not settled.
    pub unsettled: usize,
    /// `None` if it failed, or if it is itself the reference.
    pub error: Option<f64>,
    /// Whether it is itself the reference.
    pub reference: bool,
    /// No other run is both cheaper and nearer.
    pub front: bool,
}

impl Point {
    /// Whether its error is round-off: such runs are equally near.
    pub fn is_round_off(&self) -> bool {
        self.error.is_some_and(|error| error < ROUND_OFF)
    }
}

/// What is counted as cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Cost {
    /// Processor time, seconds.
    #[default]
    Time,
    /// Factorizations of the bodies.
    Factorizations,
    /// Minor iterations.
    Minors,
}

stickslip_core::words! {
    Cost, ALL, word:
    Time "time",
    Factorizations "factorizations",
    Minors "minors",
}

stickslip_core::words! {
    Cost, axis:
    Time "processor time (s)",
    Factorizations "factorizations",
    Minors "minor iterations",
}

impl Cost {
    /// That of a run.
    pub fn of(self, point: &Point) -> f64 {
        match self {
            Cost::Time => point.seconds,
            Cost::Factorizations => point.factorizations as f64,
            Cost::Minors => point.minors as f64,
        }
    }
}

/// How a chart is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure {
    /// What is counted as cost.
    pub cost: Cost,
    /// The error that is wanted, if any; relative.
    pub target: Option<f64>,
    /// Repetitions of every run, of which the median time counts.
    pub repeats: usize,
}

/// Why a chart could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PrecisionError {
    /// The table of the reference cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// There is nothing to compare with.
    #[error("{0}")]
    Reference(String),
    /// The runs cannot be had.
    #[error(transparent)]
    Run(Box<RunError>),
}

impl From<RunError> for PrecisionError {
    fn from(error: RunError) -> PrecisionError {
        PrecisionError::Run(Box::new(error))
    }
}

/// A run with what it is compared by.
struct Measured {
    point: Point,
    run: Run,
    kinds: Vec<MonitorKind>,
    path: Vec<f64>,
}

/// Runs all of a chart, one run at a time.
///
/// # Errors
/// As [`Precision::new`], and if a scene will not open.
pub fn run(
    planned: &Planned,
    measure: Measure,
    watch: &Watch,
) -> Result<Precision, PrecisionError> {
    let sweep = sweep(std::slice::from_ref(planned), measure.repeats);
    let results = sweep.run(NonZeroUsize::MIN, watch)?;
    Precision::new(planned, results, measure)
}

/// A run as a point of its series.
fn measured(
    timed: Timed,
    model: &Model,
    series: usize,
    name: String,
    settings: Vec<(String, String)>,
) -> Measured {
    let Timed {
        seconds,
        repeats,
        run,
    } = timed;
    let failed = run.failed().map(|failed| {
        let load = stickslip_scene::number::six(failed.load);
        format!("{} at load {load}", failed.verdict)
    });
    let point = Point {
        series,
        name,
        settings,
        seconds,
        repeats,
        factorizations: run.factorizations,
        majors: run.begun,
        minors: run.minors(),
        increments: run.rows.len() as u64,
        unknowns: model.dofs.equations,
        failed,
        unsettled: run.unsettled(),
        error: None,
        reference: false,
        front: false,
    };
    Measured {
        point,
        kinds: kinds(model),
        path: model.path.clone(),
        run,
    }
}

fn kinds(model: &Model) -> Vec<MonitorKind> {
    model.monitors.iter().map(|m| kind(model, &m.of)).collect()
}

/// The reference of a chart; with the number of the run that it is, if it is one of them.
fn truth(
    chart: &Chart,
    all: &[Measured],
    run: Option<Timed>,
) -> Result<(Reference, Option<usize>), PrecisionError> {
    let path = all.first().map(|m| m.path.clone()).unwrap_or_default();
    let wrong = PrecisionError::Reference;
    match &chart.truth {
        Truth::Table(file) => {
            let table = Reference::open(file, &path)?;
            Ok((table, None))
        }
        Truth::Builtin => {
            let name = chart.scene.strip_suffix(".ron").unwrap_or(&chart.scene);
            let known = Reference::builtin(name, &path);
            let none = || wrong(format!("there is no reference for {name} in the program"));
            Ok((known.ok_or_else(none)??, None))
        }
        Truth::Run(settings) => {
            let names: Vec<String> = assigned(settings).collect();
            let name = format!("a run with {}", names.join(", "));
            let stopped = "it was interrupted before its reference was there";
            let run = run.ok_or_else(|| wrong(stopped.to_owned()))?.run;
            match run.failed() {
                None => Ok((Reference::of(&run, name, &path), None)),
                Some(failed) => Err(wrong(format!(
                    "the reference, {name}, failed: {}",
                    failed.verdict
                ))),
            }
        }
        Truth::Finest => {
            let whole =
                |m: &&(usize, &Measured)| m.1.point.failed.is_none() && m.1.point.unsettled == 0;
            let rank = |m: &(usize, &Measured)| {
                (m.1.point.unknowns, m.1.point.increments, usize::MAX - m.0)
            };
            let finest = all
                .iter()
                .enumerate()
                .filter(|m| whole(&m))
                .max_by_key(rank);
            let (k, m) = finest.ok_or_else(|| {
                wrong("no run went to its end, so that there is nothing to compare with".to_owned())
            })?;
            let series = &chart.series[m.point.series].name;
            let name = format!("the finest run of the set ({series}, {})", m.point.name);
            Ok((Reference::of(&m.run, name, &m.path), Some(k)))
        }
    }
}

/// Measures all errors; the number of loads at which.
fn compare(
    precision: &mut Precision,
    all: &mut [Measured],
    reference: &Reference,
    wanted: &[String],
) -> Result<usize, PrecisionError> {
    let Some(first) = all.first() else {
        return Ok(0);
    };
    let names = first.run.monitors.join(", ");
    let kinds = first.run.monitors.iter().cloned().zip(first.kinds.clone());
    let kinds: HashMap<String, MonitorKind> = kinds.collect();
    let kind = |name: &String| kinds.get(name).copied();
    let counts = |name: &&String| match wanted {
        [] => kind(name) == Some(MonitorKind::Length),
        some => some.contains(name) && kind(name).is_some(),
    };
    precision.monitors = reference.monitors.iter().filter(counts).cloned().collect();
    if precision.monitors.is_empty() {
        return Err(PrecisionError::Reference(format!(
            "the reference has no monitor to measure by; the scene has {names}"
        )));
    }
    let curve = |m: &Measured| Reference::of(&m.run, String::new(), &m.path);
    let curves: Vec<Option<Reference>> = all
        .iter()
        .map(|m| m.point.failed.is_none().then(|| curve(m)))
        .collect();
    let common = |row: &&reference::Point| {
        let mut whole = curves.iter().flatten();
        whole.all(|curve| curve.at(row.leg, row.load).is_some())
    };
    let rows: Vec<_> = reference.rows.iter().filter(common).collect();
    if rows.is_empty() {
        return Err(PrecisionError::Reference(
            "there is no load that the reference and all runs have in common".to_owned(),
        ));
    }
    let columns: Vec<(usize, &String)> = precision
        .monitors
        .iter()
        .filter_map(|name| Some((reference.monitors.iter().position(|own| own == name)?, name)))
        .collect();
    let scale = |wanted: Option<MonitorKind>| {
        let of_kind = columns.iter().filter(|(_, name)| kind(name) == wanted);
        let values =
            of_kind.flat_map(|(k, _)| reference.rows.iter().map(|row| row.values[*k].abs()));
        values.fold(f64::MIN_POSITIVE, f64::max)
    };
    for (measured, curve) in all.iter_mut().zip(&curves) {
        let Some(curve) = curve.as_ref().filter(|_| !measured.point.reference) else {
            continue;
        };
        let mut error = 0.0_f64;
        for row in &rows {
            let Some(own) = curve.at(row.leg, row.load) else {
                continue;
            };
            for (k, name) in &columns {
                let place = curve.monitors.iter().position(|own| own == *name);
                let value = place.map_or(f64::NAN, |place| own.values[place]);
                let part = (value - row.values[*k]).abs() / scale(kind(name));
                error = if part.is_nan() {
                    f64::INFINITY
                } else {
                    error.max(part)
                };
            }
        }
        measured.point.error = Some(error);
    }
    Ok(rows.len())
}

/// Refuses monitors that are asked for by name where the reference does not have them, or they are zero all along.
fn measurable(reference: &Reference, by: &[String]) -> Result<(), PrecisionError> {
    for name in by {
        let place = reference.monitors.iter().position(|own| own == name);
        let Some(place) = place else {
            return Err(PrecisionError::Reference(format!(
                "{} has no {name}; it has {} (--reference finest takes a run of the set, which has all monitors of the scene)",
                reference.source,
                reference.monitors.join(", ")
            )));
        };
        let values = reference.rows.iter().map(|row| row.values[place].abs());
        if values.fold(0.0, f64::max) == 0.0 {
            return Err(PrecisionError::Reference(format!(
                "{name} is zero all along in the reference, so that no error is a part of it"
            )));
        }
    }
    Ok(())
}

/// Marks the runs that none beats in cost and error.
pub(super) fn mark_front(points: &mut [Point], cost: Cost) {
    let measured: Vec<Option<(f64, f64)>> = points
        .iter()
        .map(|point| Some((cost.of(point), point.error?.max(ROUND_OFF))))
        .collect();
    let beaten = |(x, y): (f64, f64)| {
        let better = |&(a, b): &(f64, f64)| a <= x && b <= y && (a < x || b < y);
        measured.iter().flatten().any(better)
    };
    for (point, own) in points.iter_mut().zip(&measured) {
        point.front = own.is_some_and(|own| !beaten(own));
    }
}

impl Precision {
    /// A chart of its runs, in the order of [`sweep`]: those that were done.
    ///
    /// # Errors
    /// If the reference will not do.
    pub fn new(
        planned: &Planned,
        results: Vec<Option<Timed>>,
        measure: Measure,
    ) -> Result<Precision, PrecisionError> {
        let (chart, plans) = (&planned.chart, &planned.plans);
        let mut results = results.into_iter();
        let mut all: Vec<Measured> = Vec::new();
        for (s, plan) in plans.iter().enumerate() {
            for (k, case) in plan.cases.iter().enumerate() {
                let Some(timed) = results.next().flatten() else {
                    continue;
                };
                let own = plan.columns.iter().cloned();
                let own = own.zip(case.values.iter().cloned()).collect();
                let settings = [chart.series[s].set.clone(), own].concat();
                let model = case.model().map_err(RunError::from)?;
                all.push(measured(timed, &model, s, name(plan, k), settings));
            }
        }
        let (reference, own) = truth(chart, &all, results.next().flatten())?;
        let series = chart.series.iter().map(|series| series.name.clone());
        let mut precision = Precision {
            scene: chart.scene.clone(),
            title: chart.title.clone(),
            monitors: Vec::new(),
            about: Vec::new(),
            series: series.collect(),
            points: Vec::new(),
            cost: measure.cost,
            target: measure.target,
        };
        if let Some(own) = own {
            all[own].point.reference = true;
        }
        let wanted = match chart.by.is_empty() {
            true => &chart.monitors,
            false => &chart.by,
        };
        measurable(&reference, &chart.by)?;
        let loads = compare(&mut precision, &mut all, &reference, wanted)?;
        precision.points = all.into_iter().map(|measured| measured.point).collect();
        precision.about = origin(chart, &precision, loads, &reference);
        mark_front(&mut precision.points, measure.cost);
        Ok(precision)
    }

    /// The cheapest run that is as near as is wanted.
    pub fn cheapest(&self) -> Option<&Point> {
        let target = self.target?;
        let near = self
            .points
            .iter()
            .filter(|p| p.error.is_some_and(|error| error <= target));
        near.min_by(|a, b| self.cost.of(a).total_cmp(&self.cost.of(b)))
    }

    /// What there is to say about the wanted error.
    pub fn verdict(&self) -> Option<String> {
        let target = self.target?;
        let meets = |point: &Point| {
            let series = &self.series[point.series];
            let cost = stickslip_scene::number::six(self.cost.of(point));
            let error = point
                .error
                .map(stickslip_scene::number::six)
                .unwrap_or_default();
            format!(
                "The cheapest run with an error of at most {target:?}: {series}, {}: error {error}, {} {cost}.",
                point.name,
                self.cost.axis()
            )
        };
        let none = || format!("No run has an error of at most {target:?}.");
        Some(self.cheapest().map_or_else(none, meets))
    }
}

/// What a chart was made from, and by what.
fn origin(
    chart: &Chart,
    precision: &Precision,
    loads: usize,
    reference: &Reference,
) -> Vec<String> {
    let set: String = assigned(&chart.set)
        .map(|pair| format!("; {pair}"))
        .collect();
    let repeats = precision.points.iter().map(|point| point.repeats).max();
    vec![
        format!("Scene: {}{set}", chart.scene),
        format!(
            "Error: largest difference of {} over the largest value, at {loads} loads that all whole runs have, to {}",
            precision.monitors.join(", "),
            reference.source
        ),
        format!(
            "Time: processor time of the solve, median of {}. {}",
            repeats.unwrap_or(0),
            origin::made_by()
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart_file;

    fn point(seconds: f64, error: Option<f64>) -> Point {
        Point {
            series: 0,
            name: String::new(),
            settings: Vec::new(),
            seconds,
            repeats: 1,
            factorizations: 1,
            majors: 1,
            minors: 1,
            increments: 1,
            unknowns: 1,
            failed: error.is_none().then(|| "failed".to_owned()),
            unsettled: 0,
            error,
            reference: false,
            front: false,
        }
    }

    #[test]
    fn the_front_is_what_nothing_beats_in_both() {
        let mut points = vec![
            point(1.0, Some(1e-2)),
            point(2.0, Some(1e-3)),
            point(3.0, Some(2e-3)), // beaten by the one before
            point(4.0, Some(1e-4)),
            point(0.1, None),       // failed
            point(4.0, Some(1e-4)), // a tie beats nobody
        ];
        mark_front(&mut points, Cost::Time);
        let front: Vec<bool> = points.iter().map(|p| p.front).collect();
        assert_eq!(front, [true, true, false, true, false, true]);
    }

    #[test]
    fn errors_at_round_off_tie_so_that_the_cheapest_of_them_stays() {
        let mut points = vec![
            point(1.0, Some(3e-14)),
            point(2.0, Some(1e-16)),
            point(0.5, Some(1e-11)),
            point(3.0, Some(0.0)),
        ];
        mark_front(&mut points, Cost::Time);
        let front: Vec<bool> = points.iter().map(|p| p.front).collect();
        assert_eq!(front, [true, false, true, false]);
        let equal: Vec<bool> = points.iter().map(Point::is_round_off).collect();
        assert_eq!(equal, [true, true, false, true]);
    }

    #[test]
    fn every_built_in_chart_is_sound() {
        for name in chart_file::names() {
            let chart = Chart::open(name, &[]).unwrap_or_else(|e| panic!("{e}"));
            let planned = Planned::new(chart).unwrap_or_else(|e| panic!("{e}"));
            assert!(
                planned.plans.iter().all(|plan| !plan.cases.is_empty()),
                "{name}"
            );
            assert!(!planned.chart.title.is_empty());
        }
    }
}
