//! A sequence of steps to repeat: a scene to its end, or a snapshot's history with its interventions.

use super::base::{Error, usage};
use super::interrupt::Interrupt;
use stickslip_core::{RunEnd, Stepper, Until};
use stickslip_debugger::record::snapshot::{AppliedIntervention, repeat};
use stickslip_debugger::{Snapshot, SnapshotError};
use stickslip_scene::{IN_SPACE, Scene};

/// A scene, with the interventions and the number of steps of a snapshot.
pub struct Course {
    /// The scene.
    pub scene: Scene,
    /// Interventions, in order of the steps.
    pub applied: Vec<AppliedIntervention>,
    /// Minor iterations of a snapshot; `None` continues to the end of the history, or to the first failure.
    pub steps: Option<u64>,
}

impl Course {
    /// The whole history of a scene.
    pub fn from_scene(scene: Scene) -> Course {
        Course {
            scene,
            applied: Vec::new(),
            steps: None,
        }
    }

    /// The history of a snapshot; `name` is the scene's name in messages.
    ///
    /// # Errors
    /// If the scene is invalid, or belongs to an attached solver.
    pub fn from_snapshot(name: &str, snapshot: Snapshot) -> Result<Course, Error> {
        if snapshot.scene.attached.is_some() {
            let name = snapshot.name;
            return Err(SnapshotError::Attached { name }.into());
        }
        if snapshot.scene.in_space.is_some() {
            return Err(usage!("{name}: {IN_SPACE}"));
        }
        Ok(Course {
            scene: Scene::from_spec(name, snapshot.scene)?,
            applied: snapshot.interventions,
            steps: Some(snapshot.steps),
        })
    }

    /// Runs the course with a stepper at the start; calls `see` after every minor iteration.
    ///
    /// # Errors
    /// If an intervention is not possible.
    pub fn go(
        &self,
        stepper: &mut Stepper,
        interrupt: &Interrupt,
        see: impl FnMut(&mut Stepper),
    ) -> Result<RunEnd<String>, Error> {
        let has_arrived = || interrupt.has_arrived();
        let until = Until::end().interrupted_by(&has_arrived);
        // A snapshot continues after a failure if its user did.
        let until = match self.steps {
            Some(steps) => until.minors(steps).past_failures(),
            None => until,
        };
        match repeat(stepper, &self.applied, until, see).map_err(Error::usage)? {
            RunEnd::Stopped(why) => Err(usage!("{}: {why}", self.scene.name)),
            end => Ok(end),
        }
    }
}
