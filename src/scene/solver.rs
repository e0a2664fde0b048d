//! Creates the solver of a scene, which processes bodies in parallel on all threads of the program.
//!
//! The core starts no threads; this module uses rayon's. Results are bitwise independent of the number of threads. If many scenes
//! are solved at the same time (maps, studies), each has a single-threaded solver instead.

use std::sync::Arc;
use stickslip_core::executor::Executor;
use stickslip_core::step::cone_solver::ConeSolver;
use stickslip_core::{Model, Solver, Stepper};

/// Rayon's threads.
struct Threads;

impl Executor for Threads {
    fn join(&self, first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
        rayon::join(first, second);
    }
}

/// The solver of any scene, also of an interface problem in space, at the start of its history.
pub fn any_solver(model: Arc<Model>) -> Box<dyn Solver> {
    match ConeSolver::new(model.clone()) {
        Some(solver) => Box::new(solver),
        None => Box::new(solver(model)),
    }
}

/// A solver at the start of the scene's history.
pub fn solver(model: Arc<Model>) -> Stepper {
    Stepper::with_executor(model, Arc::new(Threads))
}
