//! A course of steps to be gone again: a scene to its end, or a snapshot as far as it went, with what was done to it.

use super::base::Error;
use super::interrupt::Interrupt;
use std::ops::ControlFlow;
use stickslip_core::step::drive::{RunEnd, Until};
use stickslip_core::step::stepper::Stepper;
use stickslip_debugger::record::snapshot::{Applied, Snapshot, SnapshotError};
use stickslip_scene::Scene;

/// A scene, and of a snapshot what was done to it, and how far.
pub struct Course {
    /// The scene.
    pub scene: Scene,
    /// What was done to it, in order of the steps.
    pub applied: Vec<Applied>,
    /// Minor iterations of a snapshot; `None` goes to the end of the history, or to its first failure.
    pub steps: Option<u64>,
}

/// How a course ended; an error stops it as [`RunEnd::Stopped`].
pub type CourseEnd = RunEnd<Error>;

impl Course {
    /// All of a scene.
    pub fn of_scene(scene: Scene) -> Course {
        Course {
            scene,
            applied: Vec::new(),
            steps: None,
        }
    }

    /// What a snapshot went through; `name` is what messages call its scene.
    ///
    /// # Errors
    /// If its scene is unsound.
    pub fn of_snapshot(name: &str, snapshot: Snapshot) -> Result<Course, Error> {
        if snapshot.scene.attached.is_some() {
            let name = snapshot.name;
            return Err(SnapshotError::Attached { name }.into());
        }
        Ok(Course {
            scene: Scene::from_spec(name, snapshot.scene)?,
            applied: snapshot.interventions,
            steps: Some(snapshot.steps),
        })
    }

    /// Goes it with a stepper that stands at the start; `see` looks after every minor iteration.
    ///
    /// # Errors
    /// If what was done before the first minor iteration cannot be done.
    pub fn go(
        &self,
        stepper: &mut Stepper,
        interrupt: &Interrupt,
        see: &mut dyn FnMut(&mut Stepper),
    ) -> Result<CourseEnd, Error> {
        let name = &self.scene.name;
        let mut applied = self.applied.iter().peekable();
        let mut intervene = |stepper: &mut Stepper, done: u64| {
            while let Some(next) = applied.next_if(|a| a.step == done) {
                stepper
                    .intervene(&next.intervention)
                    .map_err(|e| Error::Usage(format!("{name}: after step {done}: {e}")))?;
            }
            Ok(())
        };
        intervene(stepper, 0)?;
        let came = || interrupt.came();
        let until = Until::end().interrupted_by(&came);
        // A snapshot goes on from a failure, as its user did.
        let until = match self.steps {
            Some(steps) => until.minors(steps).past_failures(),
            None => until,
        };
        let mut done = 0;
        Ok(stepper.drive(until, |stepper| {
            done += 1;
            see(stepper);
            match intervene(stepper, done) {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => ControlFlow::Break(error),
            }
        }))
    }
}
