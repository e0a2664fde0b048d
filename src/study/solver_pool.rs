//! One run of a study on one thread, and the solvers that runs share.

use super::memory_pool::MemoryPool;
use super::reason::Reason;
use super::result::{CaseEnd, Row, Run, RunFailure};
use super::verdict::RunVerdict;
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};
use stickslip_core::{Model, Outcome, RunEnd, Stepper, Until};

/// Callbacks of a study, called from all threads.
pub struct Watch<'a> {
    /// Whether the study should end now.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Reports accepted increments, or those skipped because their run has ended.
    pub done: &'a (dyn Fn(u64) + Sync),
}

/// Solvers of finished runs. The next run reuses the workspace of one with the same layout.
#[derive(Default)]
pub struct SolverPool {
    steppers: Mutex<Vec<Stepper>>,
    pool: MemoryPool,
}

impl SolverPool {
    /// A solver at the start of a model's history.
    fn take(&self, model: Arc<Model>) -> Stepper {
        let spare = self
            .steppers
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
            .pop();
        let renewed = spare.and_then(|mut stepper| stepper.renew(&model).then_some(stepper));
        renewed.unwrap_or_else(|| Stepper::new(model))
    }

    fn give(&self, stepper: Stepper) {
        self.steppers
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
            .push(stepper);
    }
}

/// Runs a model to the end of its history (with this number of increments), to its first failure, or until
/// interrupted.
pub fn one(increments: u64, model: Arc<Model>, spare: &SolverPool, watch: &Watch) -> Run {
    let _place = spare.pool.take(&model);
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
        run.begun += u64::from(!matches!(
            outcome,
            Outcome::Minor | Outcome::StrategyChange { .. }
        ));
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
            CaseEnd::Failed(RunFailure {
                reason: Reason::from(&failure),
                verdict: RunVerdict::from_failure(&failure),
                increment: event.position.increment,
                load: event.load_factor,
                major: event.position.major,
                minors,
                unsettled: stepper.state().attempt.unsettled,
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

/// The row of the stepper's state, at the start of an increment.
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
