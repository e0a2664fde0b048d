//! Applies what a user changes in a run: modes, the increment, friction or settings.

use crate::contact::table1::t_max;
use crate::model::{Touch, least};
use crate::step::recovery::proximal::SlipStiffness;
use crate::step::state::Progress;
use crate::{
    ContactState, Estimate, Forced, Friction, Mode, Model, Settings, State, Status, SubIncrement,
};
use std::sync::Arc;

pub use crate::step::intervention::{Intervention, Refusal, Start, Value};

impl State {
    /// Applies an intervention. The position stays, except that a new increment size restarts the current increment.
    ///
    /// # Errors
    /// If a value is invalid, or the history is finished.
    pub fn intervene(&mut self, model: &Model, intervention: &Intervention) -> Result<(), Refusal> {
        // An attached solver may continue after its end; ours has nothing left to solve.
        if self.status == Status::Finished && self.outside.is_none() {
            return Err(Refusal::Done);
        }
        let tied = |slave: &usize| model.contacts.get(*slave).is_some_and(|c| c.bond.is_tied());
        let refused = match intervention {
            Intervention::Force { slave, mode, .. } => tied(slave) && *mode != Mode::Fixed,
            Intervention::Assume(starts) => starts
                .iter()
                .any(|start| tied(&start.slave) && start.mode != Mode::Fixed),
            _ => false,
        };
        if refused {
            return Err(Refusal::Tied);
        }
        match intervention {
            Intervention::Force { slave, mode, hold } => self.force(*slave, *mode, *hold)?,
            Intervention::Assume(starts) => self.assume(starts)?,
            Intervention::Release { slave } => self.node_mut(*slave)?.forced = Forced::No,
            Intervention::Increment(increment) => self.retry(model, *increment)?,
            Intervention::Friction(friction) => {
                self.set_friction(&vec![*friction; self.nodes.len()])?;
            }
            Intervention::Frictions(all) => self.set_friction(all)?,
            Intervention::Settings(settings) => self.set(model, settings)?,
            Intervention::Parameter { name, value } => self.set_parameter(name, value)?,
        }
        if let Some(outside) = &mut self.outside {
            if self.status == Status::Finished {
                self.status = Status::Running;
            }
            outside.asked.push(intervention.clone());
        }
        self.attempt.search = Progress::default();
        self.forget_minors();
        self.forget_majors();
        Ok(())
    }

    /// Clears the record of the minor iterations.
    pub(super) fn forget_minors(&mut self) {
        self.major.line = None;
        if !self.major.minor_history.is_empty() {
            Arc::make_mut(&mut self.major.minor_history).clear();
        }
    }

    /// Clears the record of the major iterations.
    pub(super) fn forget_majors(&mut self) {
        if !self.attempt.major_history.is_empty() {
            Arc::make_mut(&mut self.attempt.major_history).clear();
        }
    }

    /// Starts the increment that follows `start`.
    pub(super) fn begin(&mut self) {
        (self.next.major, self.next.minor) = (1, 1);
        (
            self.attempt.minors,
            self.attempt.unsettled,
            self.major.correction,
        ) = (0, 0, 0.0);
        (self.attempt.net, self.recovery.brake, self.major.factored) = (false, None, None);
        self.load_factor = self.sub_increment.target();
        self.attempt.search = Progress::default();
        (self.major.target, self.major.last_target) = (self.load_factor, self.start.load_factor);
        self.set_out();
        self.forget_minors();
        self.forget_majors();
    }

    fn node_mut(&mut self, slave: usize) -> Result<&mut ContactState, Refusal> {
        let count = self.nodes.len();
        self.nodes
            .get_mut(slave)
            .ok_or(Refusal::NoContact { slave, count })
    }

    fn force(&mut self, slave: usize, mode: Mode, hold: bool) -> Result<(), Refusal> {
        let touch = self.controls.settings.touch;
        let node = self.node_mut(slave)?;
        if node.spot.is_none() && mode != Mode::Free {
            return Err(Refusal::OffSurface);
        }
        if node.mode == Mode::Free && mode != Mode::Free && touch != Touch::Start && !node.kept {
            node.ratio = node.travel;
        }
        node.mode = mode;
        node.forced = if hold {
            Forced::Held(mode)
        } else {
            Forced::Once(mode)
        };
        Ok(())
    }

    fn assume(&mut self, starts: &[Start]) -> Result<(), Refusal> {
        let mut assumed = self.clone();
        for start in starts {
            assumed.force(start.slave, start.mode, false)?;
            let node = assumed.node_mut(start.slave)?;
            node.ratio = 0.0;
            node.t_max = start.t_max;
            node.sign = match start.t_max {
                0.0 => 0.0,
                t_max => t_max.signum(),
            };
        }
        *self = assumed;
        Ok(())
    }

    /// Replaces the friction of all slave nodes, one entry per node.
    fn set_friction(&mut self, all: &[Friction]) -> Result<(), Refusal> {
        let sound = |friction: &Friction| {
            (0.0..90.0).contains(&friction.angle)
                && (0.0..f64::INFINITY).contains(&friction.cohesion)
        };
        if all.len() != self.nodes.len() || !all.iter().all(sound) {
            return Err(Refusal::Friction);
        }
        Arc::make_mut(&mut self.controls)
            .friction
            .copy_from_slice(all);
        for (node, friction) in self.nodes.iter_mut().zip(all) {
            node.t_max = t_max(friction, node.f_n, node.sign);
        }
        Ok(())
    }

    fn set(&mut self, model: &Model, settings: &Settings) -> Result<(), Refusal> {
        if settings.minors == 0 || settings.majors == 0 {
            return Err(Refusal::Limits);
        }
        let gaps = |settings: &Settings| {
            let Settings {
                initial_gaps,
                adjust_gap,
                point_force,
                ..
            } = *settings;
            (initial_gaps, adjust_gap, point_force)
        };
        if gaps(settings) != gaps(&self.controls.settings) {
            return Err(Refusal::StartGaps);
        }
        if settings.solver != self.controls.settings.solver
            && let Some(why) = Estimate::from_model(model).too_large(settings.solver)
        {
            return Err(Refusal::TooLarge(why));
        }
        Arc::make_mut(&mut self.controls).settings = *settings;
        Ok(())
    }

    fn set_parameter(&mut self, name: &str, value: &Value) -> Result<(), Refusal> {
        let outside = self
            .outside
            .as_mut()
            .ok_or_else(|| Refusal::NoParameter(name.to_owned()))?;
        outside.set.retain(|(known, _)| known != name);
        outside.set.push((name.to_owned(), value.clone()));
        Ok(())
    }

    fn retry(&mut self, model: &Model, increment: f64) -> Result<(), Refusal> {
        if !(increment.is_finite() && increment > 0.0) {
            return Err(Refusal::Increment(increment));
        }
        let controls = Arc::make_mut(&mut self.controls);
        if let Some(way) = &mut self.way {
            way.step *= increment / controls.increment;
        }
        controls.increment = increment;
        controls.least = least(model.least, increment).min(increment);
        self.recovery.motion = None;
        self.sub_increment = SubIncrement::whole(model, self.start.place(), increment);
        self.recovery.fallback = None;
        self.start_again();
        Ok(())
    }

    /// The state in which the current attempt at the increment began, without later changes by the user, except modes that are
    /// held.
    pub fn attempt_again(&self) -> State {
        let mut again = self.clone();
        again.start_again();
        again.recovery.brake = self
            .recovery
            .brake
            .map(|brake| SlipStiffness::new(brake.spring));
        again
    }

    /// Restarts the current increment, from its start to the end of the current part.
    pub(super) fn start_again(&mut self) {
        self.u = self.start.u.clone();
        for (node, start) in self.nodes.iter_mut().zip(&self.start.nodes) {
            let forced = node.forced;
            *node = *start;
            node.forced = Forced::No;
            if let Forced::Held(mode) = forced {
                (node.forced, node.mode) = (forced, mode);
            }
        }
        self.next.attempt += 1;
        self.status = Status::Running;
        self.begin();
    }
}
