//! The cases of a plan as a sweep.

use super::figure::name;
use super::plan::Plan;
use super::result::Run;
use super::run_error::RunError;
use super::solver_pool::{SolverPool, Watch, one};
use super::sweep::Sweep;
use super::sweep_input::Input;
use std::num::NonZeroUsize;
use std::sync::Arc;
use stickslip_core::Model;

/// The runs of a plan as cells of a sweep.
pub fn sweep(plan: &Plan) -> Sweep<'_, Run> {
    cells(plan, ["study", "runs"], |_| true, |run, _| Some(run))
}

/// The cases of a plan as cells of a sweep with these names; `result` is what is kept of a run, and the shard of a case depends on
/// the paths selected by `counts`.
pub(super) fn cells<'a, T: 'a>(
    plan: &'a Plan,
    [what, unit]: [&'static str; 2],
    counts: fn(&str) -> bool,
    result: fn(Run, &Model) -> Option<T>,
) -> Sweep<'a, T> {
    let compute = move |k: usize, spare: &SolverPool, watch: &Watch| {
        let case = &plan.cases[k];
        let model = Arc::new(case.model()?);
        let run = one(case.increments, model.clone(), spare, watch);
        Ok(result(run, &model))
    };
    Sweep {
        input: Input::new(what, plan.input()),
        cells: plan.cells(counts),
        units: [unit, "increments"],
        is_timed: false,
        runs: 1,
        name: Box::new(|k| name(plan, k)),
        compute: Box::new(compute),
    }
}

/// Runs all cases of a plan on some threads. The results are in the order of the plan.
///
/// # Errors
/// If the threads cannot be started. The failure of a run is a result.
pub fn run(plan: &Plan, jobs: NonZeroUsize, watch: &Watch) -> Result<Vec<Run>, RunError> {
    let runs = sweep(plan).run(jobs, watch)?;
    Ok(runs.into_iter().flatten().collect())
}
