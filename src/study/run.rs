//! The cases of a plan, side by side: each on one thread, so that its bits are those of a run alone.

use super::log::{LogError, ResultKind};
use super::merge::{Cells, Keeping, Kept, Reading, same};
use super::plan::{Case, Plan};
use super::reason::Reason;
use super::result::{CaseEnd, Failed, Row, Run};
use super::room::Room;
use super::sweep_input::Input;
use super::verdict::RunVerdict;
use crate::format::SceneError;
use crate::model::Model;
use crate::step::drive::{RunEnd, Until};
use crate::step::event::Outcome;
use crate::step::stepper::Stepper;
use rayon::prelude::*;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};

/// A scene is read by recursion; as much stack as a program starts with is enough for all that it accepts.
const STACK: usize = 8 << 20;

/// Who watches a study from outside. Both are called from all threads.
pub struct Watch<'a> {
    /// Whether the study is to end now.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// An increment was accepted, or that many will never be, because their run has ended.
    pub done: &'a (dyn Fn(u64) + Sync),
}

/// Solvers whose runs have ended. The next run goes on with the workspace of one where its scene is laid out alike.
#[derive(Default)]
pub struct Spare {
    steppers: Mutex<Vec<Stepper>>,
    room: Room,
}

impl Spare {
    /// A solver at the start of a model's history.
    fn take(&self, model: Arc<Model>) -> Stepper {
        let spare = self
            .steppers
            .lock()
            .unwrap_or_else(|e| e.into_inner())
            .pop();
        let renewed = spare.and_then(|mut stepper| stepper.renew(&model).then_some(stepper));
        renewed.unwrap_or_else(|| Stepper::new(model))
    }

    fn give(&self, stepper: Stepper) {
        self.steppers
            .lock()
            .unwrap_or_else(|e| e.into_inner())
            .push(stepper);
    }
}

/// Why a study could not be run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The threads cannot be started.
    #[error("no threads to run on: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A scene is unsound.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The results cannot be kept, or taken up.
    #[error(transparent)]
    Log(#[from] LogError),
}

/// Runs all cases of a plan on a number of threads. The results are in the order of the plan.
///
/// # Errors
/// If there are no threads to be had. What fails in a run is its result.
pub fn run(plan: &Plan, jobs: NonZeroUsize, watch: &Watch) -> Result<Vec<Run>, RunError> {
    let kept = open(plan, &Keeping::Nowhere)?;
    let runs = run_kept(plan, &kept, jobs, watch)?;
    Ok(runs.into_iter().flatten().collect())
}

/// Most bytes of a run in a file: some 10,000 increments with 100 monitors.
pub(super) const MOST_LINE: usize = 32 << 20;

/// What there is of the runs of a plan.
///
/// # Errors
/// If a file will not do.
pub fn open(plan: &Plan, keeping: &Keeping) -> Result<Kept<Run>, LogError> {
    let cells = Cells {
        keys: plan.cases.iter().map(Case::key).collect(),
        unit: "runs",
        name: &|k| super::figure::name(plan, k),
    };
    let reading = Reading {
        kind: ResultKind {
            most: MOST_LINE,
            is_sound: Run::is_sound,
        },
        join: same,
    };
    Kept::open(
        keeping,
        || Input::new("study", plan.input()),
        cells,
        &reading,
    )
}

/// Runs those cases of a plan that are to be run here and whose runs are not there; `None` for the others.
///
/// # Errors
/// As [`run`], and if a run cannot be kept.
pub fn run_kept(
    plan: &Plan,
    kept: &Kept<Run>,
    jobs: NonZeroUsize,
    watch: &Watch,
) -> Result<Vec<Option<Run>>, RunError> {
    let pool = pool(jobs, plan.cases.len())?;
    let spare = Spare::default();
    let of = |case: &Case| -> Result<Option<Run>, RunError> {
        let key = case.key();
        if let Some(found) = kept.get(key) {
            (watch.done)(case.increments);
            return Ok(Some(found.value.clone()));
        }
        if !kept.does(key) {
            return Ok(None);
        }
        let run = one(case.increments, Arc::new(case.model()?), &spare, watch);
        if run.is_over() {
            kept.keep(key, &run)?;
        }
        Ok(Some(run))
    };
    // One by one: cases differ much in what they cost, and the first ones are to be done first.
    pool.install(|| plan.cases.par_iter().with_max_len(1).map(of).collect())
}

/// Threads for a number of runs.
pub(super) fn pool(
    jobs: NonZeroUsize,
    runs: usize,
) -> Result<rayon::ThreadPool, rayon::ThreadPoolBuildError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(jobs.get().min(runs.max(1)))
        .stack_size(STACK)
        .build()
}

/// Runs a model to the end of its history, which has so many increments, to its first failure, or to where it is stopped.
pub fn one(increments: u64, model: Arc<Model>, spare: &Spare, watch: &Watch) -> Run {
    let _place = spare.room.take(&model);
    let monitors = model.monitors.iter().map(|m| m.name.clone()).collect();
    let mut stepper = spare.take(model);
    let mut run = Run {
        monitors,
        start: row(&mut stepper, 0, 0, 0),
        rows: Vec::new(),
        begun: 0,
        factorizations: 0,
        end: CaseEnd::NotRun,
    };
    let mut minors = 0;
    let until = Until::end().interrupted_by(watch.stop);
    let end = stepper.drive(until, |stepper| {
        minors += 1;
        let event = stepper.event();
        let (at, outcome) = (event.position, &event.outcome);
        run.begun += u64::from(!matches!(outcome, Outcome::Minor | Outcome::Climbed { .. }));
        if let Outcome::Increment {
            unsettled, jumped, ..
        } = *outcome
        {
            let mut row = row(stepper, at.major, minors, unsettled);
            (row.increment, row.jumped) = (at.increment, jumped);
            run.rows.push(row);
            minors = 0;
            (watch.done)(1);
        }
        ControlFlow::<Infallible>::Continue(())
    });
    run.factorizations = stepper.work().factorizations;
    run.end = match end {
        RunEnd::Failed(failure) => {
            let event = stepper.event();
            CaseEnd::Failed(Failed {
                reason: Reason::from(&failure),
                verdict: RunVerdict::of(&failure),
                increment: event.position.increment,
                load: event.load_factor,
                major: event.position.major,
                minors,
                unsettled: stepper.state().unsettled,
            })
        }
        RunEnd::Interrupted if run.rows.is_empty() && minors == 0 => CaseEnd::NotRun,
        RunEnd::Interrupted => CaseEnd::Interrupted,
        RunEnd::Finished | RunEnd::Spent => CaseEnd::Finished,
        RunEnd::Stopped(never) => match never {},
    };
    (watch.done)(increments.saturating_sub(run.rows.len() as u64));
    spare.give(stepper);
    run
}

/// What the stepper stands at: the start of an increment.
fn row(stepper: &mut Stepper, majors: u32, minors: u64, unsettled: u32) -> Row {
    let mut monitors = Vec::new();
    stepper.monitors(&mut monitors);
    Row {
        increment: 0,
        load: stepper.state().start.load_factor,
        majors,
        minors,
        unsettled,
        jumped: false,
        monitors,
    }
}
