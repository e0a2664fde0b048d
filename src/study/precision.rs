//! Work-precision charts: the cost and the error of settings.
//!
//! A chart contains series of runs of one scene. The **error** of a run is the largest difference between a
//! monitor and the reference, relative to the largest value of that monitor in the reference, at fixed loads that
//! are chosen before the runs ([`PlannedChart`]); a failed run has no error. Contact forces have their own error. The
//! **cost** of a run is the processor time of its thread, from the built scene to the end of the history (the
//! median of some repetitions), its factorizations (with condensation one per major iteration, otherwise one
//! per minor), and its minor iterations. The **front** consists of the finished runs that no other run beats in
//! both error and cost; differences below 2 % are ties, and errors at round-off ([`ROUND_OFF`]) count as equal.

use super::chart_file::{Chart, Truth};
use super::chart_runs::{PlannedChart, TimedRun, sweep};
use super::figure::{assigned, name};
use super::monitor_kind::{MonitorKind, kind};
use super::origin;
use super::reference::{Reference, ReferencePoint};
use super::result::Run;
use super::richardson;
use super::run_error::RunError;
use super::solver_pool::Watch;
use std::collections::HashMap;
use std::num::NonZeroUsize;
use stickslip_core::{Model, counted};
use stickslip_scene::{joined, number};

/// Errors below this are round-off: a few thousand times the machine precision.
pub const ROUND_OFF: f64 = 4096.0 * f64::EPSILON;

/// Costs and errors that differ by less than this part are ties.
pub(super) const TIE: f64 = 0.02;

/// There is no run that the others could be compared with.
const NO_RUN: &str = "no run finished, so there is no reference; compare settings that converge, such as `--over settings.strategy=ladder,newton`";

/// A monitor that stays below this part of another of its kind is measured by the other's scale.
const FLAT: f64 = 1e-6;

/// A work-precision chart of one scene.
#[derive(Debug, Clone, Default)]
pub struct Precision {
    /// The scene's name.
    pub scene: String,
    /// Title.
    pub title: String,
    /// The monitors whose errors are measured.
    pub monitors: Vec<String>,
    /// The contact forces whose errors are measured.
    pub forces: Vec<String>,
    /// Error bars of the reference, relative as the errors: of the monitors, and of the forces.
    pub uncertainty: [Option<f64>; 2],
    /// Origin of the chart, for footers.
    pub about: Vec<String>,
    /// Names of the series.
    pub series: Vec<String>,
    /// The runs.
    pub points: Vec<Point>,
    /// Kind of cost.
    pub cost: Cost,
    /// Target error, if any.
    pub target: Option<f64>,
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Number of its series.
    pub series: usize,
    /// The settings that distinguish it within its series.
    pub name: String,
    /// All its settings: path and value.
    pub settings: Vec<(String, String)>,
    /// Median processor time in seconds.
    pub seconds: f64,
    /// Shortest and longest processor time, if the run was repeated.
    pub spread: Option<(f64, f64)>,
    /// Number of repetitions.
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
    /// Why it failed; `None` if it finished.
    pub failed: Option<String>,
    /// Increments accepted although a loop had not settled.
    pub unsettled: usize,
    /// Relative error; `None` if the run failed or is the reference.
    pub error: Option<f64>,
    /// Relative error of the contact forces, if the reference has them.
    pub force_error: Option<f64>,
    /// Whether it is the reference.
    pub reference: bool,
    /// Whether it is on the front.
    pub front: bool,
}

impl Point {
    /// Whether its error is round-off: such errors count as equal.
    pub fn is_round_off(&self) -> bool {
        self.error.is_some_and(|error| error < ROUND_OFF)
    }
}

stickslip_core::words! {
    /// Kind of cost.
    #[derive(Default)]
    pub enum Cost, ALL, word {
        /// Processor time, seconds.
        #[default]
        Time "time",
        /// Factorizations of the bodies.
        Factorizations "factorizations",
        /// Minor iterations.
        Minors "minors",
    }
}

stickslip_core::words! {
    Cost, axis:
    Time "processor time (s)",
    Factorizations "factorizations",
    Minors "minor iterations",
}

impl Cost {
    /// The cost of a run.
    pub fn of(self, point: &Point) -> f64 {
        match self {
            Cost::Time => point.seconds,
            Cost::Factorizations => point.factorizations as f64,
            Cost::Minors => point.minors as f64,
        }
    }
}

/// How to measure a chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure {
    /// Kind of cost.
    pub cost: Cost,
    /// Target error (relative), if any.
    pub target: Option<f64>,
    /// Number of repetitions of each run; the median time counts.
    pub repeats: usize,
}

/// A run with the data for comparison.
struct MeasuredRun {
    point: Point,
    run: Run,
    kinds: Vec<MonitorKind>,
    path: Vec<f64>,
}

/// Runs all cases of a chart, one at a time.
///
/// # Errors
/// As [`Precision::new`], and if a scene cannot be opened.
pub fn run(planned: &PlannedChart, measure: Measure, watch: &Watch) -> Result<Precision, RunError> {
    let sweep = sweep(std::slice::from_ref(planned), measure.repeats);
    let results = sweep.run(NonZeroUsize::MIN, watch)?;
    Precision::new(planned, results, measure)
}

/// A run as a point of its series.
fn measured(
    timed: TimedRun,
    model: &Model,
    series: usize,
    name: String,
    settings: Vec<(String, String)>,
) -> MeasuredRun {
    let TimedRun {
        seconds,
        spread,
        repeats,
        run,
    } = timed;
    let failed = run.failed().map(|failed| {
        let load = number::sig6(failed.load);
        format!("{} at load {load}", failed.verdict)
    });
    let point = Point {
        series,
        name,
        settings,
        seconds,
        spread: (repeats > 1).then_some(spread),
        repeats,
        factorizations: run.factorizations,
        majors: run.begun,
        minors: run.minors(),
        increments: run.rows.len() as u64,
        unknowns: model.dofs.equations,
        failed,
        unsettled: run.unsettled(),
        error: None,
        force_error: None,
        reference: false,
        front: false,
    };
    MeasuredRun {
        point,
        kinds: kinds(model),
        path: model.path.clone(),
        run,
    }
}

fn kinds(model: &Model) -> Vec<MonitorKind> {
    model.monitors.iter().map(|m| kind(model, &m.of)).collect()
}

/// The reference of a chart, and the number of its run if it is one of the runs.
fn truth(
    planned: &PlannedChart,
    all: &[MeasuredRun],
    run: Option<TimedRun>,
) -> Result<(Reference, Option<usize>), RunError> {
    let chart = &planned.chart;
    let path = all.first().map_or(&[][..], |m| m.path.as_slice());
    let wrong = RunError::Incomparable;
    match (&chart.truth, &planned.table) {
        (Truth::Table(_) | Truth::Builtin, table) => {
            let none = || wrong("the reference table was not read".to_owned());
            Ok((table.clone().ok_or_else(none)?, None))
        }
        (Truth::Run(settings), _) => {
            let names = joined(assigned(settings), ", ");
            let name = format!("a run with {names}");
            let stopped = "interrupted before the reference was computed";
            let run = run.ok_or_else(|| wrong(stopped.to_owned()))?.run;
            match run.failed() {
                None => Ok((Reference::from_run(&run, name, path), None)),
                Some(failed) => Err(wrong(format!(
                    "the reference, {name}, failed: {}",
                    failed.verdict
                ))),
            }
        }
        (Truth::Finest, _) => {
            let (k, m) = by_fineness(all)
                .last()
                .copied()
                .ok_or_else(|| wrong(NO_RUN.to_owned()))?;
            let series = &chart.series[m.point.series].name;
            let name = format!("the finest run of the set ({series}, {})", m.point.name);
            Ok((Reference::from_run(&m.run, name, &m.path), Some(k)))
        }
        (Truth::Richardson, _) => {
            let runs = by_fineness(all);
            let mut series: Vec<usize> = runs.iter().rev().map(|(_, m)| m.point.series).collect();
            series.dedup();
            let found = series.into_iter().find_map(|s| {
                let own = runs.iter().filter(|(_, m)| m.point.series == s);
                let own: Vec<&MeasuredRun> = own.map(|(_, m)| *m).collect();
                let &[a, b, c] = own.last_chunk::<3>()?;
                Some(([a, b, c], ratio([a, b, c])?))
            });
            let failed = all.iter().filter_map(|m| {
                let why = match (&m.point.failed, m.point.unsettled) {
                    (Some(why), _) => why,
                    (None, 0) => return None,
                    (None, _) => "accepted, but not converged",
                };
                Some(format!("; {}: {why}", m.point.name))
            });
            let none = || {
                "Richardson extrapolation needs three finished runs of a series with one varied number that changes by a \
                 constant ratio, such as --over refine=1,2,4"
                    .to_owned()
                    + &joined(failed, "")
            };
            let (runs, ratio) = found.ok_or_else(|| wrong(none()))?;
            let curves = runs.map(|m| Reference::from_run(&m.run, String::new(), &m.path));
            let [a, b, c] = &curves;
            let fixed = |leg, load| planned.counts(path, leg, load);
            let (mut limit, orders) = richardson::limit([a, b, c], ratio, fixed);
            let names = limit.monitors.iter().zip(orders);
            let orders: Vec<String> = names
                .filter_map(|(name, order)| Some(format!("{name} {}", number::sig2(order?))))
                .collect();
            limit.source = format!(
                "Richardson extrapolation of {} ({}); orders: {}",
                chart.series[runs[0].point.series].name,
                runs.map(|m| m.point.name.clone()).join("; "),
                orders.join(", ")
            );
            Ok((limit, None))
        }
    }
}

/// The finished runs and their numbers, the finest last: by unknowns and, among equals, by increments. Of equals the first is last.
fn by_fineness(all: &[MeasuredRun]) -> Vec<(usize, &MeasuredRun)> {
    let whole = |m: &(usize, &MeasuredRun)| m.1.point.failed.is_none() && m.1.point.unsettled == 0;
    let mut runs: Vec<_> = all.iter().enumerate().filter(whole).collect();
    runs.sort_by_key(|(k, m)| (m.point.unknowns, m.point.increments, usize::MAX - k));
    runs
}

/// The constant ratio, above 1, of the only setting that three runs vary.
fn ratio(runs: [&MeasuredRun; 3]) -> Option<f64> {
    let [a, b, c] = runs.map(|m| {
        let varied = m.point.name.split_once('=')?.1.trim_end_matches('x');
        varied.parse::<f64>().ok()
    });
    let (first, second) = (b? / a?, c? / b?);
    let constant = (first - second).abs() <= 1e-9 * first.abs() && first > 0.0 && first != 1.0;
    constant.then(|| first.max(1.0 / first))
}

/// Measures all errors; returns the number of loads compared.
fn compare(
    precision: &mut Precision,
    all: &mut [MeasuredRun],
    reference: &Reference,
    planned: &PlannedChart,
) -> Result<usize, RunError> {
    let Some(first) = all.first() else {
        return Ok(0);
    };
    let names = first.run.monitors.join(", ");
    let kinds = first.run.monitors.iter().cloned().zip(first.kinds.clone());
    let kinds: HashMap<String, MonitorKind> = kinds.collect();
    let kind = |name: &String| kinds.get(name).copied();
    let wanted = if planned.chart.by.is_empty() {
        &planned.chart.monitors
    } else {
        &planned.chart.by
    };
    let counts = |name: &&String| match wanted.as_slice() {
        [] => kind(name) == Some(MonitorKind::Length),
        some => some.contains(name) && kind(name).is_some(),
    };
    precision.monitors = reference.monitors.iter().filter(counts).cloned().collect();
    if precision.monitors.is_empty() {
        return Err(RunError::Incomparable(format!(
            "{} has none of the scene's monitors ({names})",
            reference.source
        )));
    }
    let curve = |m: &MeasuredRun| Reference::from_run(&m.run, String::new(), &m.path);
    let curves: Vec<Option<Reference>> = all
        .iter()
        .map(|m| m.point.failed.is_none().then(|| curve(m)))
        .collect();
    let fixed = |row: &&ReferencePoint| planned.counts(&first.path, row.leg, row.load);
    let rows: Vec<_> = reference.rows.iter().filter(fixed).collect();
    if rows.is_empty() {
        return Err(RunError::Incomparable(format!(
            "{} has none of the fixed loads at which errors are measured",
            reference.source
        )));
    }
    let largest = |k: usize| {
        let values = reference.rows.iter().map(|row| row.values[k].abs());
        values.fold(f64::MIN_POSITIVE, f64::max)
    };
    // Contact forces have their own panel, unless the monitors were requested by name.
    let force = |(k, name): &(usize, &String)| {
        let is_zero = largest(*k) <= f64::MIN_POSITIVE;
        kind(name) == Some(MonitorKind::Force) && !is_zero && !precision.monitors.contains(name)
    };
    let columns = || reference.monitors.iter().enumerate();
    let forces: Vec<(usize, &String)> = if planned.chart.by.is_empty() {
        columns().filter(force).collect()
    } else {
        Vec::new()
    };
    let own = |(_, name): &(usize, &String)| precision.monitors.contains(name);
    let own: Vec<(usize, &String)> = columns().filter(own).collect();
    precision.forces = forces.iter().map(|(_, name)| (*name).clone()).collect();
    for (is_force, columns) in [(false, own), (true, forces)] {
        if columns.is_empty() {
            continue;
        }
        // Where a monitor is only round-off, its largest value is no scale: the largest of its kind is used.
        let scale = |k: usize, name: &String| {
            let of_kind = columns.iter().filter(|(_, own)| kind(own) == kind(name));
            let most = of_kind.map(|(k, _)| largest(*k)).fold(0.0, f64::max);
            largest(k).max(FLAT * most)
        };
        // The largest of all fixed loads and monitors; a number that is missing counts as infinite.
        let worst = |part: &dyn Fn(&ReferencePoint, usize, &String) -> Option<f64>| {
            let parts = rows.iter().flat_map(|row| {
                let part = move |(k, name): &(usize, &String)| part(row, *k, name);
                columns.iter().map(part).zip(&columns)
            });
            parts.fold(0.0_f64, |most, (part, (k, name))| {
                let part = part.map_or(f64::NAN, |part| part / scale(*k, name));
                if part.is_nan() {
                    f64::INFINITY
                } else {
                    most.max(part)
                }
            })
        };
        if rows.iter().all(|row| !row.bars.is_empty()) {
            let bar = worst(&|row, k, _| row.bars.get(k).copied());
            precision.uncertainty[usize::from(is_force)] = Some(bar);
        }
        for (measured, curve) in all.iter_mut().zip(&curves) {
            let Some(curve) = curve.as_ref().filter(|_| !measured.point.reference) else {
                continue;
            };
            let error = worst(&|row, k, name| {
                let place = curve.monitors.iter().position(|own| own == name)?;
                let value = curve.at(row.leg, row.load)?.values[place];
                Some((value - row.values[k]).abs())
            });
            if is_force {
                measured.point.force_error = Some(error)
            } else {
                measured.point.error = Some(error)
            }
        }
    }
    Ok(rows.len())
}

/// Rejects monitors requested by name that the reference does not have, or that are always zero.
fn measurable(reference: &Reference, by: &[String]) -> Result<(), RunError> {
    for name in by {
        let place = reference.monitors.iter().position(|own| own == name);
        let Some(place) = place else {
            return Err(RunError::Incomparable(format!(
                "{} has no monitor {name}; it has {} (with --reference finest, a run with all monitors of the scene is the reference)",
                reference.source,
                reference.monitors.join(", ")
            )));
        };
        let values = reference.rows.iter().map(|row| row.values[place].abs());
        if values.fold(0.0, f64::max) == 0.0 {
            return Err(RunError::Incomparable(format!(
                "{name} is always zero in the reference, so it has no relative error"
            )));
        }
    }
    Ok(())
}

/// Marks the runs on the front.
pub(super) fn mark_front(points: &mut [Point], cost: Cost) {
    let measured: Vec<Option<(f64, f64)>> = points
        .iter()
        .map(|point| Some((cost.of(point), point.error?.max(ROUND_OFF))))
        .collect();
    let beaten = |(x, y): (f64, f64)| {
        let less = |a: f64, b: f64| a * (1.0 + TIE) < b;
        let better =
            |&(a, b): &(f64, f64)| !less(x, a) && !less(y, b) && (less(a, x) || less(b, y));
        measured.iter().flatten().any(better)
    };
    for (point, own) in points.iter_mut().zip(&measured) {
        point.front = own.is_some_and(|own| !beaten(own));
    }
}

impl Precision {
    /// A chart of the completed runs, in the order of [`sweep`].
    ///
    /// # Errors
    /// If the reference is not suitable.
    pub fn new(
        planned: &PlannedChart,
        results: Vec<Option<TimedRun>>,
        measure: Measure,
    ) -> Result<Precision, RunError> {
        let (chart, plans) = (&planned.chart, &planned.plans);
        let mut results = results.into_iter();
        let mut all: Vec<MeasuredRun> = Vec::new();
        for (s, plan) in plans.iter().enumerate() {
            for (k, case) in plan.cases.iter().enumerate() {
                let Some(timed) = results.next().flatten() else {
                    continue;
                };
                let own = plan.columns.iter().cloned();
                let own = own.zip(case.values.iter().cloned()).collect();
                let settings = [chart.series[s].set.clone(), own].concat();
                let model = case.model()?;
                all.push(measured(timed, &model, s, name(plan, k), settings));
            }
        }
        let (reference, own) = truth(planned, &all, results.next().flatten())?;
        let series = chart.series.iter().map(|series| series.name.clone());
        let mut precision = Precision {
            scene: chart.scene.clone(),
            title: chart.title.clone(),
            series: series.collect(),
            cost: measure.cost,
            target: measure.target,
            ..Precision::default()
        };
        if let Some(own) = own {
            all[own].point.reference = true;
        }
        measurable(&reference, &chart.by)?;
        let loads = compare(&mut precision, &mut all, &reference, planned)?;
        precision.points = all.into_iter().map(|measured| measured.point).collect();
        precision.about = origin(chart, &precision, loads, &reference);
        mark_front(&mut precision.points, measure.cost);
        Ok(precision)
    }

    /// Adds the runs of another chart of the same scene as further series, except those without the cost of this one.
    pub fn add(&mut self, other: &Precision) {
        let before = self.series.len();
        self.series.extend(other.series.iter().cloned());
        let runs = other.points.iter().filter(|p| self.cost.of(p) > 0.0);
        self.points.extend(runs.cloned().map(|point| Point {
            series: before + point.series,
            ..point
        }));
        self.about.extend(other.about.iter().cloned());
        mark_front(&mut self.points, self.cost);
    }

    /// The cheapest run with at most the target error.
    pub fn cheapest(&self) -> Option<&Point> {
        let target = self.target?;
        let near = self
            .points
            .iter()
            .filter(|p| p.error.is_some_and(|error| error <= target));
        near.min_by(|a, b| self.cost.of(a).total_cmp(&self.cost.of(b)))
    }

    /// A sentence about the target error.
    pub fn verdict(&self) -> Option<String> {
        let target = self.target?;
        let meets = |point: &Point| {
            let series = &self.series[point.series];
            let cost = number::sig6(self.cost.of(point));
            let error = point.error.map(number::sig6).unwrap_or_default();
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

/// The origin of a chart, for footers.
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
    let forces = match precision.forces.join(", ") {
        none if none.is_empty() => none,
        forces => format!(" (separately of {forces})"),
    };
    let bars = precision
        .uncertainty
        .iter()
        .flatten()
        .map(|bar| number::sig2(*bar));
    let bar = match joined(bars, ", forces ") {
        none if none.is_empty() => none,
        bars => format!("; its error bar: {bars}"),
    };
    vec![
        format!("Scene: {}{set}", chart.scene),
        format!(
            "Error: largest difference of {}{forces}, each relative to its largest value, at {}, where every run ends an increment; reference: {}{bar}",
            precision.monitors.join(", "),
            counted(loads, "fixed load"),
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
            spread: None,
            repeats: 1,
            factorizations: 1,
            majors: 1,
            minors: 1,
            increments: 1,
            unknowns: 1,
            failed: error.is_none().then(|| "failed".to_owned()),
            unsettled: 0,
            error,
            force_error: None,
            reference: false,
            front: false,
        }
    }

    #[test]
    fn the_front_has_the_runs_that_no_other_beats_in_both() {
        let mut points = vec![
            point(1.0, Some(1e-2)),
            point(2.0, Some(1e-3)),
            point(3.0, Some(2e-3)), // worse than the previous one
            point(4.0, Some(1e-4)),
            point(0.1, None),           // failed
            point(4.0, Some(1e-4)),     // equal in cost
            point(4.05, Some(1.01e-4)), // a tie
            point(4.1, Some(1e-4)),     // more expensive by more than 2 %
        ];
        mark_front(&mut points, Cost::Time);
        let front: Vec<bool> = points.iter().map(|p| p.front).collect();
        assert_eq!(front, [true, true, false, true, false, true, true, false]);
    }

    #[test]
    fn peers_are_further_series_and_change_the_front() {
        let mut chart = Precision {
            series: vec!["own".to_owned()],
            points: vec![point(2.0, Some(1e-3))],
            ..Precision::default()
        };
        let peer = Precision {
            series: vec!["peer".to_owned()],
            points: vec![point(1.0, Some(1e-4)), point(0.0, Some(1e-9))],
            about: vec!["a peer".to_owned()],
            ..chart.clone()
        };
        chart.add(&peer);
        let rows: Vec<_> = chart.points.iter().map(|p| (p.series, p.front)).collect();
        // The one without a time has no place on the axis.
        assert_eq!(rows, [(0, false), (1, true)]);
        assert_eq!(
            (chart.series, chart.about),
            (
                vec!["own".to_owned(), "peer".to_owned()],
                vec!["a peer".to_owned()]
            )
        );
    }

    #[test]
    fn of_errors_at_round_off_only_the_cheapest_is_on_the_front() {
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
    fn every_built_in_chart_is_valid() {
        for name in chart_file::names() {
            let chart = Chart::open(name, &[]).unwrap_or_else(|e| panic!("{e}"));
            let planned = PlannedChart::new(chart).unwrap_or_else(|e| panic!("{e}"));
            assert!(
                planned.plans.iter().all(|plan| !plan.cases.is_empty()),
                "{name}"
            );
            assert!(!planned.chart.title.is_empty());
        }
    }
}
