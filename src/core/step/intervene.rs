//! What a user does to a run: force a mode, change the increment, friction or settings.

use crate::contact::record::Forced;
use crate::contact::state::ContactState;
use crate::contact::table1::t_max;
use crate::linear::estimate::{Estimate, TooLarge};
use crate::model::{Friction, Settings, Touch, least};
use crate::model::{Mode, Model};
use crate::step::brake::Brake;
use crate::step::state::{Progress, State, Status};
use crate::step::sub_increment::SubIncrement;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A change from outside; recorded in snapshots and replayed from them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Intervention {
    /// Force a slave node (by slave number) into a mode: for the next minor iteration, or until released.
    Force {
        /// Slave number.
        slave: usize,
        /// The mode.
        mode: Mode,
        /// Whether it is held until released.
        hold: bool,
    },
    /// Start several slave nodes at once from a state that is known: each in a mode, for the next minor iteration.
    Assume(Vec<Start>),
    /// Give a slave node back to Table 2.
    Release {
        /// Slave number.
        slave: usize,
    },
    /// Change the increment size and start the present increment again. Where the scene lists increments of each leg of the
    /// path, the next leg begins with its own.
    Increment(f64),
    /// Replace the friction of every slave node.
    Friction(Friction),
    /// Replace the friction of each slave node by its own, in the order of the scene.
    Frictions(Vec<Friction>),
    /// Replace the settings.
    Settings(Settings),
}

/// Why an intervention is refused; the state stays as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// There is nothing left to change.
    #[error("the history is done; step back first")]
    Done,
    /// No contact has this number.
    #[error("there are {count} slave nodes, numbered from 0; {slave} is none")]
    NoContact {
        /// The number that was asked for.
        slave: usize,
        /// How many there are.
        count: usize,
    },
    /// A contact without a surface can only be free.
    #[error("the node is past the end of its surface: it has nothing to touch")]
    OffSurface,
    /// A tied contact is fixed for ever.
    #[error("the node is tied to its surface: it is always fixed")]
    Tied,
    /// A friction out of bounds.
    #[error("a friction angle is at least 0 and less than 90 degrees, a cohesion not negative")]
    Friction,
    /// Gaps of the start are long past.
    #[error(
        "initial_gaps and adjust_gap are settled when a scene is opened: set them in its file, or with --set"
    )]
    StartGaps,
    /// A limit of no iterations.
    #[error("limits of iterations are at least 1")]
    Limits,
    /// An increment that is no positive number.
    #[error("an increment is a positive number, not {0}")]
    Increment(f64),
    /// The solver that was asked for does not fit the memory.
    #[error(transparent)]
    TooLarge(TooLarge),
}

/// Where a slave node is to start from in the next minor iteration, known from elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Slave number.
    pub slave: usize,
    /// Mode of the next minor iteration.
    pub mode: Mode,
    /// T_max, signed (force).
    pub t_max: f64,
}

impl State {
    /// Applies an intervention. The position stays, except that a new increment size starts the present increment
    /// again.
    ///
    /// # Errors
    /// A message for values that make no sense, and when the history is done.
    pub fn intervene(&mut self, model: &Model, intervention: &Intervention) -> Result<(), Refusal> {
        if self.status == Status::Finished {
            return Err(Refusal::Done);
        }
        let tied = |slave: &usize| model.contacts.get(*slave).is_some_and(|c| c.bond.is_tied());
        let refused = match intervention {
            Intervention::Force { slave, mode, .. } => tied(slave) && *mode != Mode::Fixed,
            Intervention::Assume(starts) => {
                let mut starts = starts.iter();
                starts.any(|start| tied(&start.slave) && start.mode != Mode::Fixed)
            }
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
        }
        self.search = Progress::default();
        self.forget_minors();
        self.forget_majors();
        Ok(())
    }

    /// Forgets what went into the minor iterations so far.
    pub(super) fn forget_minors(&mut self) {
        if !self.minor_history.is_empty() {
            Arc::make_mut(&mut self.minor_history).clear();
        }
    }

    /// Forgets what went into the major iterations so far.
    pub(super) fn forget_majors(&mut self) {
        if !self.major_history.is_empty() {
            Arc::make_mut(&mut self.major_history).clear();
        }
    }

    /// Sets out on the increment that follows `start`.
    pub(super) fn begin(&mut self) {
        (self.next.major, self.next.minor) = (1, 1);
        (self.minors, self.unsettled, self.correction) = (0, 0, 0.0);
        (self.net, self.brake, self.factored) = (false, None, None);
        self.load_factor = self.sub_increment.target();
        self.search = Progress::default();
        (self.target, self.last_target) = (self.load_factor, self.start.load_factor);
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

    /// Replaces the friction of all slave nodes, one entry each.
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
        let gaps = |settings: &Settings| (settings.initial_gaps, settings.adjust_gap);
        if gaps(settings) != gaps(&self.controls.settings) {
            return Err(Refusal::StartGaps);
        }
        if settings.solver != self.controls.settings.solver
            && let Some(why) = Estimate::of(model).too_large(settings.solver)
        {
            return Err(Refusal::TooLarge(why));
        }
        Arc::make_mut(&mut self.controls).settings = *settings;
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
        self.motion = None;
        self.sub_increment = SubIncrement::whole(model, self.start.place(), increment);
        self.detour = None;
        self.start_again();
        Ok(())
    }

    /// The state in which the present attempt of the increment began. What was changed by hand since then is not in it,
    /// except modes that are held.
    pub fn attempt_again(&self) -> State {
        let mut again = self.clone();
        again.start_again();
        again.brake = self.brake.map(|brake| Brake::new(brake.spring));
        again
    }

    /// Starts the present increment again, from its start to the end of the present piece.
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
