//! The cases of a plan as a sweep.

use super::figure::name;
use super::plan::Plan;
use super::result::Run;
use super::solver_pool::{SolverPool, Watch, one};
use super::sweep::{RunError, Sweep};
use super::sweep_input::Input;
use std::num::NonZeroUsize;
use std::sync::Arc;

/// The runs of a plan as cells of a sweep.
pub fn sweep(plan: &Plan) -> Sweep<'_, Run> {
    let compute = |k: usize, spare: &SolverPool, watch: &Watch| {
        let case = &plan.cases[k];
        Ok(Some(one(
            case.increments,
            Arc::new(case.model()?),
            spare,
            watch,
        )))
    };
    Sweep {
        input: Input::new("study", plan.input()),
        cells: plan.cells(|_| true),
        units: ["runs", "increments"],
        is_timed: false,
        runs: 1,
        name: Box::new(|k| name(plan, k)),
        compute: Box::new(compute),
    }
}

/// Runs all cases of a plan on some threads. The results are in the order of the plan.
///
/// # Errors If the threads cannot be started. The failure of a run is a result.
pub fn run(plan: &Plan, jobs: NonZeroUsize, watch: &Watch) -> Result<Vec<Run>, RunError> {
    let runs = sweep(plan).run(jobs, watch)?;
    Ok(runs.into_iter().flatten().collect())
}
