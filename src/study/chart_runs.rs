//! The runs of work-precision charts: laid out, timed, and kept.

use super::chart_file::{Chart, Series, Truth};
use super::figure::name;
use super::log::{LogError, ResultKind};
use super::merge::{Cells, Keeping, Kept, Reading, same};
use super::plan::{Case, Plan};
use super::read::Study;
use super::result::Run;
use super::run::{MOST_LINE, RunError, Spare, Watch, one};
use super::sweep_input::Input;
use crate::format::SceneError;
use crate::model::Model;
use rustix::time::{ClockId, clock_gettime};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Runs that take this long altogether (seconds) are not repeated any more.
const LONG: f64 = 20.0;

/// A run and its times, as a file keeps it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Timed {
    /// Median processor time, seconds.
    pub seconds: f64,
    /// Of so many repetitions.
    pub repeats: usize,
    /// What it came to.
    pub run: Run,
}

impl Timed {
    /// Whether its numbers are finite, as in every real run.
    fn is_sound(&self) -> bool {
        self.seconds.is_finite() && self.run.is_sound()
    }

    /// What two runs of one cell come to: they must be the same but for their times. That which was repeated more
    /// often counts, and of equals the shorter time.
    fn join(one: &Timed, other: &Timed) -> Option<Timed> {
        same(&one.run, &other.run)?;
        let more = other.repeats.cmp(&one.repeats);
        let less = more.then(one.seconds.total_cmp(&other.seconds));
        Some(if less.is_le() { one } else { other }.clone())
    }
}

/// All series of a chart as plans.
///
/// # Errors
/// If a path or a value will not do.
pub fn plans(chart: &Chart) -> Result<Vec<Plan>, SceneError> {
    let plan = |series: &Series| {
        Plan::new(Study {
            name: chart.scene.clone(),
            scenes: vec![chart.scene.clone()],
            vary: series.vary.clone(),
            set: [chart.set.clone(), series.set.clone()].concat(),
            ..Study::default()
        })
    };
    chart.series.iter().map(plan).collect()
}

/// A chart that is laid out: every run of it is known.
pub struct Planned {
    /// As its author asked for it.
    pub chart: Chart,
    /// Its series.
    pub plans: Vec<Plan>,
    /// The run that is the reference, where a run of its own is.
    pub truth: Option<Plan>,
}

impl Planned {
    /// Lays a chart out.
    ///
    /// # Errors
    /// If a path or a value will not do.
    pub fn new(chart: Chart) -> Result<Planned, SceneError> {
        let plans = plans(&chart)?;
        Planned::of(chart, plans)
    }

    /// A chart whose series are laid out.
    ///
    /// # Errors
    /// If the settings of its reference will not do.
    pub fn of(chart: Chart, plans: Vec<Plan>) -> Result<Planned, SceneError> {
        let truth = truth_plan(&chart)?;
        Ok(Planned {
            chart,
            plans,
            truth,
        })
    }

    /// All runs, the reference's last.
    fn cases(&self) -> impl Iterator<Item = (&Plan, usize)> {
        let plans = self.plans.iter().chain(&self.truth);
        plans.flat_map(|plan| (0..plan.cases.len()).map(move |k| (plan, k)))
    }

    /// Increments of all runs together.
    pub fn increments(&self) -> u64 {
        self.cases().map(|(plan, k)| plan.cases[k].increments).sum()
    }

    /// All that the results depend on, by name.
    fn input(&self) -> impl Iterator<Item = (String, String)> {
        let plans = self.plans.iter().chain(&self.truth);
        plans.flat_map(Plan::input)
    }
}

/// The run that a chart's reference is, where it is one of its own.
fn truth_plan(chart: &Chart) -> Result<Option<Plan>, SceneError> {
    let Truth::Run(settings) = &chart.truth else {
        return Ok(None);
    };
    Plan::new(Study {
        set: [chart.set.clone(), settings.clone()].concat(),
        ..Study::of_scene(&chart.scene)
    })
    .map(Some)
}

/// What there is of the runs of some charts.
///
/// # Errors
/// If a file will not do.
pub fn open(
    charts: &[Planned],
    repeats: usize,
    keeping: &Keeping,
) -> Result<Kept<Timed>, LogError> {
    let cases: Vec<(&Plan, usize)> = charts.iter().flat_map(Planned::cases).collect();
    let cells = Cells {
        keys: cases.iter().map(|(plan, k)| plan.cases[*k].key()).collect(),
        unit: "runs",
        name: &|k| {
            let (plan, case) = cases[k];
            format!("{}, {}", plan.study.name, name(plan, case))
        },
    };
    let reading = Reading {
        kind: ResultKind {
            most: MOST_LINE,
            is_sound: Timed::is_sound,
        },
        join: Timed::join,
    };
    let input = || {
        let parts = charts.iter().flat_map(Planned::input);
        let repeats = ("repeats".to_owned(), repeats.to_string());
        Input::new("chart", parts.chain([repeats]).collect())
    };
    Kept::open(keeping, input, cells, &reading)
}

/// Runs what is to be run here and is not there, and compares nothing; whether each run of [`open`]'s cells is there then.
///
/// # Errors
/// If a scene will not open, or a run cannot be kept.
pub fn run_part(
    charts: &[Planned],
    repeats: usize,
    kept: &Kept<Timed>,
    watch: &Watch,
) -> Result<Vec<bool>, RunError> {
    let cases = charts.iter().flat_map(Planned::cases);
    let there = |(plan, k): (&Plan, usize)| {
        let case = &plan.cases[k];
        Ok(timed(case, &case.model()?.into(), repeats, kept, watch)?.is_some())
    };
    cases.map(there).collect()
}

/// A case's run with its times: that which is kept, or it is run some times; `None` if it is not to be run here, or was stopped
/// from outside.
///
/// # Errors
/// If its scene will not open, or the run cannot be kept.
pub fn timed(
    case: &Case,
    model: &Arc<Model>,
    repeats: usize,
    kept: &Kept<Timed>,
    watch: &Watch,
) -> Result<Option<Timed>, RunError> {
    let key = case.key();
    if let Some(found) = kept.get(key) {
        (watch.done)(case.increments);
        return Ok(Some(found.value.clone()));
    }
    if !kept.does(key) {
        return Ok(None);
    }
    let quiet = Watch {
        stop: watch.stop,
        done: &|_| {},
    };
    let (mut times, mut last) = (Vec::new(), None);
    while times.len() < repeats.max(1) {
        let start = thread_seconds();
        let run = one(case.increments, model.clone(), &Spare::default(), &quiet);
        times.push(thread_seconds() - start);
        if !run.is_over() {
            return Ok(None);
        }
        last = Some(run);
        if times.iter().sum::<f64>() > LONG {
            break;
        }
    }
    (watch.done)(case.increments);
    let Some(run) = last else { return Ok(None) };
    times.sort_by(f64::total_cmp);
    let timed = Timed {
        seconds: times[times.len() / 2],
        repeats: times.len(),
        run,
    };
    kept.keep(key, &timed)?;
    Ok(Some(timed))
}

/// Processor time of this thread, in seconds.
fn thread_seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
