//! A solver of a scene whose bodies are worked on side by side, on the threads that the program has.
//!
//! The core starts no threads; those are rayon's. What comes out has the same bits on one thread and on many. Where many scenes
//! are solved at the same time (maps, studies) each has a solver of one thread instead.

use std::sync::Arc;
use stickslip_core::executor::Executor;
use stickslip_core::model::Model;
use stickslip_core::step::stepper::Stepper;

/// The threads that the program has.
struct Threads;

impl Executor for Threads {
    fn join(&self, first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
        rayon::join(first, second);
    }
}

/// A solver at the start of the scene's history.
pub fn solver(model: Arc<Model>) -> Stepper {
    Stepper::with_executor(model, Arc::new(Threads))
}
