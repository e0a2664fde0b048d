//! The runs of work-precision charts: planned, timed and stored.

use super::chart_file::{Chart, Truth};
use super::figure::name;
use super::log::{Outcome, same};
use super::plan::{Case, Plan};
use super::read::{Study, Vary};
use super::result::Run;
use super::solver_pool::{SolverPool, Watch, one};
use super::sweep::{RunError, Sweep};
use super::sweep_input::Input;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use stickslip_platform::system;
use stickslip_scene::format::SceneError;

/// Runs that take this long in total (seconds) are not repeated again.
const LONG: f64 = 20.0;

/// A run with its time, as stored in a log.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TimedRun {
    /// Median processor time, seconds.
    pub seconds: f64,
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
}

impl PlannedChart {
    /// Plans the runs of a chart.
    ///
    /// # Errors If a path or a value is invalid.
    pub fn new(chart: Chart) -> Result<PlannedChart, SceneError> {
        let lay_out = |vary: &[Vary], set: &[(String, String)]| {
            Plan::new(Study {
                vary: vary.to_vec(),
                set: [&chart.set, set].concat(),
                ..Study::from_scene(&chart.scene)
            })
        };
        let plans = chart.series.iter();
        let plans = plans.map(|series| lay_out(&series.vary, &series.set));
        let plans = plans.collect::<Result<_, _>>()?;
        let truth = match &chart.truth {
            Truth::Run(settings) => Some(lay_out(&[], settings)?),
            _ => None,
        };
        Ok(PlannedChart {
            chart,
            plans,
            truth,
        })
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
    let cases = plans().flat_map(|plan| places(plan).map(move |k| (plan, k)));
    let cases: Vec<(&Plan, usize)> = cases.collect();
    let names = cases.clone();
    let repeated = ("repeats".to_owned(), repeats.to_string());
    let truths = charts.iter().filter_map(|chart| chart.truth.as_ref());
    let truths: Vec<&Plan> = truths.collect();
    let compute = move |k: usize, _: &SolverPool, watch: &Watch| {
        let (plan, k) = cases[k];
        let is_truth = truths.iter().any(|truth| std::ptr::eq(*truth, plan));
        let repeats = if is_truth { 1 } else { repeats };
        timed(&plan.cases[k], repeats, watch)
    };
    Sweep {
        input: Input::new(
            "chart",
            plans().flat_map(Plan::input).chain([repeated]).collect(),
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

/// Runs a case repeatedly; `None` if interrupted.
fn timed(case: &Case, repeats: usize, watch: &Watch) -> Result<Option<TimedRun>, RunError> {
    let model = Arc::new(case.model()?);
    let quiet = Watch {
        stop: watch.stop,
        done: &|_| {},
    };
    let mut times = Vec::new();
    loop {
        let start = system::thread_time().as_secs_f64();
        let run = one(
            case.increments,
            model.clone(),
            &SolverPool::default(),
            &quiet,
        );
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
            repeats: times.len(),
            run,
        }));
    }
}
