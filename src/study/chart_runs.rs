//! The runs of work-precision charts: planned, timed and stored.
//!
//! Errors are measured at fixed loads, which are chosen before anything runs. Every run is required to end an
//! increment at each of them, so that its error does not depend on the other runs of the chart.

use super::chart_file::{Chart, Truth};
use super::figure::name;
use super::log::{Outcome, same};
use super::plan::{Case, Plan};
use super::read::{Study, Vary};
use super::reference::{Reference, SAME_LOAD};
use super::result::Run;
use super::run_error::RunError;
use super::solver_pool::{SolverPool, Watch, one};
use super::sweep::Sweep;
use super::sweep_input::Input;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use stickslip_core::Model;
use stickslip_core::plane::max_abs;
use stickslip_platform::system;
use stickslip_scene::increments;

/// Runs that take this long in total (seconds) are not repeated again.
const LONG: f64 = 20.0;

/// Maximum number of fixed loads within a leg of the load path that are taken from a table.
const MOST_FIXED: usize = 15;

/// A run with its time, as stored in a log.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TimedRun {
    /// Median processor time, seconds.
    pub seconds: f64,
    /// Shortest and longest processor time.
    #[serde(default)]
    pub spread: (f64, f64),
    /// Number of repetitions.
    pub repeats: usize,
    /// The result.
    pub run: Run,
}

impl Outcome for TimedRun {
    const MAX_BYTES: usize = Run::MAX_BYTES;

    fn is_sound(&self) -> bool {
        self.seconds.is_finite() && self.run.is_sound()
    }

    /// Two results must be equal except for their times. The one with more repetitions counts or, if equal, the
    /// shorter time.
    fn join(&self, other: &TimedRun) -> Option<TimedRun> {
        let more = other.repeats.cmp(&self.repeats);
        let less = more.then(self.seconds.total_cmp(&other.seconds));
        let better = if less.is_le() { self } else { other };
        same(&self.run, &other.run).then(|| better.clone())
    }
}

/// A chart whose runs are all planned.
pub struct PlannedChart {
    /// The chart as requested.
    pub chart: Chart,
    /// Its series.
    pub plans: Vec<Plan>,
    /// The reference run, if it is a separate run.
    pub truth: Option<Plan>,
    /// The reference, if it is a table.
    pub table: Option<Reference>,
    /// Leg and load factor where errors are measured, between the corners of the load path.
    fixed: Vec<(usize, f64)>,
}

impl PlannedChart {
    /// Plans the runs of a chart.
    ///
    /// # Errors
    /// If a path or a value is invalid, or the reference table cannot be read.
    pub fn new(chart: Chart) -> Result<PlannedChart, RunError> {
        let lay_out = |vary: &[Vary], set: &[(String, String)]| {
            Plan::new(Study {
                vary: vary.to_vec(),
                set: [&chart.set, set].concat(),
                ..Study::from_scene(&chart.scene)
            })
        };
        let plans = chart
            .series
            .iter()
            .map(|series| lay_out(&series.vary, &series.set))
            .collect::<Result<Vec<Plan>, _>>()?;
        let truth = match &chart.truth {
            Truth::Run(settings) => Some(lay_out(&[], settings)?),
            _ => None,
        };
        let first = plans
            .iter()
            .flat_map(|plan| &plan.cases)
            .next()
            .map(Case::model)
            .transpose()?;
        let path = first
            .as_ref()
            .map_or(&[][..], |model| model.path.as_slice());
        let table = table(&chart, path)?;
        let mut fixed = fixed(&chart.loads, path, table.as_ref());
        // Initial overlaps are closed over the whole first leg.
        if first
            .iter()
            .flat_map(|model| &model.contacts)
            .any(|contact| contact.overlap != 0.0)
        {
            fixed.retain(|(leg, _)| *leg > 0);
        }
        Ok(PlannedChart {
            fixed,
            chart,
            plans,
            truth,
            table,
        })
    }

    /// Whether errors are measured at a load on a leg of this path: at a fixed load, or at the leg's end.
    pub(super) fn counts(&self, path: &[f64], leg: usize, load: f64) -> bool {
        let same = |at: &f64| is_same(path, *at, load);
        let mut fixed = self.fixed.iter().filter(|(own, _)| *own == leg);
        path.get(leg + 1).is_some_and(same) || fixed.any(|(_, at)| same(at))
    }

    /// All plans, the reference's last.
    fn all(&self) -> impl Iterator<Item = &Plan> {
        self.plans.iter().chain(&self.truth)
    }

    /// Number of runs, including the reference's.
    pub fn runs(&self) -> usize {
        self.all().map(|plan| plan.cases.len()).sum()
    }
}

/// The runs of some charts as cells of a sweep: chart by chart, with the reference of each one last.
pub fn sweep(charts: &[PlannedChart], repeats: usize) -> Sweep<'_, TimedRun> {
    let plans = || charts.iter().flat_map(PlannedChart::all);
    let places = |plan: &Plan| 0..plan.cases.len();
    let fixed: Vec<&[(usize, f64)]> = charts
        .iter()
        .flat_map(|chart| {
            let cases = chart.all();
            cases.flat_map(move |plan| places(plan).map(|_| chart.fixed.as_slice()))
        })
        .collect();
    let loads = charts.iter().map(|chart| &chart.fixed).collect::<Vec<_>>();
    let loads = ("fixed loads".to_owned(), format!("{loads:?}"));
    let cases: Vec<(&Plan, usize)> = plans()
        .flat_map(|plan| places(plan).map(move |k| (plan, k)))
        .collect();
    let names = cases.clone();
    let repeated = ("repeats".to_owned(), repeats.to_string());
    let truths: Vec<&Plan> = charts
        .iter()
        .filter_map(|chart| chart.truth.as_ref())
        .collect();
    let compute = move |k: usize, _: &SolverPool, watch: &Watch| {
        let fixed = fixed[k];
        let (plan, k) = cases[k];
        let is_truth = truths.iter().any(|truth| std::ptr::eq(*truth, plan));
        let repeats = if is_truth { 1 } else { repeats };
        timed(&plan.cases[k], fixed, repeats, watch)
    };
    Sweep {
        input: Input::new(
            "chart",
            plans()
                .flat_map(Plan::input)
                .chain([repeated, loads])
                .collect(),
        ),
        cells: plans().flat_map(|plan| plan.cells(|_| true)).collect(),
        units: ["runs", "increments"],
        is_timed: true,
        runs: 1,
        name: Box::new(move |k| {
            let (plan, k) = names[k];
            format!("{}, {}", plan.study.name, name(plan, k))
        }),
        compute: Box::new(compute),
    }
}

/// The reference table of a chart, if its reference is one.
fn table(chart: &Chart, path: &[f64]) -> Result<Option<Reference>, RunError> {
    match &chart.truth {
        Truth::Table(file) => Ok(Some(Reference::open(file, path)?)),
        Truth::Builtin => {
            let name = chart.scene.strip_suffix(".ron").unwrap_or(&chart.scene);
            let none =
                || RunError::Incomparable(format!("there is no built-in reference for {name}"));
            Ok(Some(Reference::builtin(name, path).ok_or_else(none)??))
        }
        Truth::Run(_) | Truth::Finest | Truth::Richardson => Ok(None),
    }
}

fn is_same(path: &[f64], a: f64, b: f64) -> bool {
    let size = max_abs(path);
    (a - b).abs() <= SAME_LOAD * size
}

/// The fixed loads between the corners of a path, in its order: the listed ones, otherwise those of the table, thinned out from the
/// end of each leg, otherwise the middle of each leg.
fn fixed(listed: &[f64], path: &[f64], table: Option<&Reference>) -> Vec<(usize, f64)> {
    let mut fixed = Vec::new();
    for (leg, ends) in path.windows(2).enumerate() {
        let &[from, to] = ends else { continue };
        let mut loads: Vec<f64> = match table {
            _ if !listed.is_empty() => listed.to_vec(),
            Some(table) => table
                .rows
                .iter()
                .filter(|row| row.leg == leg)
                .map(|row| row.load)
                .collect(),
            None => vec![0.5 * (from + to)],
        };
        loads.retain(|load| {
            let ends = is_same(path, *load, from) || is_same(path, *load, to);
            !ends && (from.min(to)..from.max(to)).contains(load)
        });
        loads.sort_by(|a, b| (a - from).abs().total_cmp(&(b - from).abs()));
        let every = loads.len().div_ceil(MOST_FIXED).max(1);
        let last = loads.len();
        let kept = loads
            .iter()
            .enumerate()
            .filter(|(k, _)| (last - k).is_multiple_of(every));
        fixed.extend(kept.map(|(_, load)| (leg, *load)));
    }
    fixed
}

/// Makes a model end increments at fixed loads: they become corners of its path, with the increments of their leg.
fn stop_at(model: &mut Model, fixed: &[(usize, f64)]) {
    let mut path: Vec<f64> = model.path.first().copied().into_iter().collect();
    let mut sizes = Vec::new();
    for (leg, ends) in model.path.windows(2).enumerate() {
        let &[from, to] = ends else { continue };
        let own = fixed
            .iter()
            .filter(|(of, _)| *of == leg)
            .map(|(_, load)| *load);
        path.extend(own.filter(|load| (from.min(to)..from.max(to)).contains(load)));
        path.push(to);
        sizes.resize(path.len() - 1, model.on_leg(leg));
    }
    if !model.increments.is_empty() {
        model.increments = sizes;
    }
    model.path = path;
}

/// Runs a case repeatedly, with increments that end at the fixed loads; `None` if interrupted.
fn timed(
    case: &Case,
    fixed: &[(usize, f64)],
    repeats: usize,
    watch: &Watch,
) -> Result<Option<TimedRun>, RunError> {
    let mut model = case.model()?;
    stop_at(&mut model, fixed);
    let increments = increments(&model.path, |leg| model.on_leg(leg)) as u64;
    let model = Arc::new(model);
    let quiet = Watch {
        stop: watch.stop,
        done: &|_| {},
    };
    let mut times = Vec::new();
    loop {
        let start = system::thread_time().as_secs_f64();
        let run = one(increments, model.clone(), &SolverPool::default(), &quiet);
        times.push(system::thread_time().as_secs_f64() - start);
        if !run.is_over() {
            return Ok(None);
        }
        if times.len() < repeats && times.iter().sum::<f64>() <= LONG {
            continue;
        }
        (watch.done)(case.increments);
        times.sort_by(f64::total_cmp);
        return Ok(Some(TimedRun {
            seconds: times[times.len() / 2],
            spread: (times[0], times[times.len() - 1]),
            repeats: times.len(),
            run,
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_gives_the_fixed_loads_of_each_leg_thinned_out_from_its_end() {
        let path = [0.0, 2.0, 0.0];
        let row = |leg: usize, load: f64| format!("{},{load},1\n", leg + 1);
        let up = (1..=20).map(|k| row(0, 0.1 * f64::from(k)));
        let down = [1.5, 0.5, 0.0].map(|load| row(1, load));
        let text: String = up.chain(down).collect();
        let table = Reference::read("x", &format!("leg,load,u_x\n{text}"), &path).unwrap();
        let found = fixed(&[], &path, Some(&table));
        let of = |wanted: usize| {
            let own = found.iter().filter(|(leg, _)| *leg == wanted);
            own.map(|(_, load)| (10.0 * load).round())
                .collect::<Vec<_>>()
        };
        // Of 19 loads before the corner every second one, with the corner.
        assert_eq!(of(0), [2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0]);
        assert_eq!(of(1), [15.0, 5.0]);
        assert_eq!(fixed(&[], &path, None), [(0, 1.0), (1, 1.0)]);
        assert_eq!(
            fixed(&[0.5, 3.0, 1.5], &path, None),
            [(0, 0.5), (0, 1.5), (1, 1.5), (1, 0.5)]
        );
    }

    #[test]
    fn a_model_ends_increments_at_the_fixed_loads_with_the_sizes_of_their_leg() {
        let scene = stickslip_scene::Scene::open("01-pinned-beam-rough-floor", &[]);
        let mut model = scene.unwrap_or_else(|e| panic!("{e}")).model;
        (model.path, model.increments) = (vec![0.0, 1.0, 0.0], vec![0.4, 0.5]);
        stop_at(&mut model, &[(0, 0.25), (1, 0.5), (1, 2.0)]);
        assert_eq!(model.path, [0.0, 0.25, 1.0, 0.5, 0.0]);
        let sizes: Vec<f64> = (0..4).map(|leg| model.on_leg(leg)).collect();
        assert_eq!(sizes, [0.4, 0.4, 0.5, 0.5]);
    }
}
