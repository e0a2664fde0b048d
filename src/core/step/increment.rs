//! Increments: accepted, cut into halves, led round, damped, or failed.

use crate::contact::laws::Verdict;
use crate::linear::norms::Norms;
use crate::linear::singular::Singular;
use crate::model::{BodyKind, Factor, Jumps, Mode, least};
use crate::step::brake::Brake;
use crate::step::detour::{Detour, Route};
use crate::step::event::{Failure, Outcome, Slow};
use crate::step::jump::Landing;
use crate::step::state::Status;
use crate::step::stepper::Stepper;
use crate::step::sub_increment::SubIncrement;
use crate::step::verdict::range_left;
use crate::strategy;
use std::sync::Arc;

/// Sums of halves of an increment are this exact.
const ROUNDING: f64 = 1e-9;
/// Smallest part of an increment that halves can be.
const SMALLEST_HALF: f64 = 1e-9;
/// Maximum number of cuts of a whole increment because of the same node, before the increment fails.
const MOST_CUTS: u32 = 300;
/// A major iteration is not damped below this part of its load.
const SMALLEST_PART: f64 = 1e-6;

impl Stepper {
    /// The increment fails; on the ladder it is cut, where that can help and it is not at its smallest yet.
    pub(super) fn fail(&mut self, mut why: Failure) -> Outcome {
        if let Failure::LadderEnded { scales, .. } = &mut why {
            *scales = self.scales();
        }
        if let Some(stop) = self.cut_too_often(&why) {
            return Outcome::Failed(stop);
        }
        let again = self.cut(&why).or_else(|| self.detour(&why));
        again.unwrap_or(Outcome::Failed(why))
    }

    /// Failure of an increment that was cut [`MOST_CUTS`] times because of the same node: each part is accepted, and the next part
    /// fails at the same node.
    pub(super) fn cut_too_often(&self, why: &Failure) -> Option<Failure> {
        let slave = why.culprit()?;
        let cuts = *self.state.cuts.get(&slave)?;
        (cuts >= MOST_CUTS).then(|| Failure::CutTooOften {
            slave,
            cuts,
            last: Box::new(why.clone()),
        })
    }

    /// Whether an increment that failed so may succeed with another size.
    fn size_helps(&self, why: &Failure) -> bool {
        match why {
            Failure::OverConstrained { .. } | Failure::RoundOff { .. } => false,
            Failure::Singular(Singular::Rigid { .. }) => !self.starts_loose(),
            Failure::LadderEnded { scales, .. } => !scales,
            _ => true,
        }
    }

    /// Starts the increment again with half its size. `None` where the strategy does not cut, where that cannot help, and
    /// where the increment is at its smallest.
    pub(super) fn cut(&mut self, why: &Failure) -> Option<Outcome> {
        if self.state.motion.is_some() {
            return self.slow_down(Slow::Failed(why.clone()));
        }
        let helps = self.size_helps(why);
        if self.state.way.is_some() {
            return self.cut_along(why, helps);
        }
        let halved = if helps { self.halve(why) } else { None };
        match halved {
            None if helps => self.leap_over(why).or_else(|| self.let_go(why)),
            None if matches!(why, Failure::Singular(_)) => self.let_go(why),
            halved => halved,
        }
    }

    /// Starts the increment again with half its size, unless it is at its smallest, or the strategy does not cut.
    fn halve(&mut self, why: &Failure) -> Option<Outcome> {
        let half = self.state.sub_increment.halved();
        let least = self.least() * (1.0 - ROUNDING);
        let rungs = strategy::rungs(self.state.controls.settings.strategy);
        let cuts = !rungs.is_empty() || self.can_move();
        if !cuts || half.size() < least || half.size() == 0.0 {
            return None;
        }
        if let Some(slave) = why.culprit() {
            *self.state.cuts.entry(slave).or_default() += 1;
        }
        self.restart(half);
        let (why, size) = (why.clone(), half.size());
        Some(Outcome::Cut { why, size })
    }

    /// The same along the path, whatever the strategy: the size is the control's own.
    fn cut_along(&mut self, why: &Failure, helps: bool) -> Option<Outcome> {
        if !helps {
            return None;
        }
        if let Some(turns) = self.turn_corner(why, false) {
            return Some(turns);
        }
        let Some(size) = self.cut_way() else {
            return self.turn_corner(why, true);
        };
        self.restart(self.state.sub_increment);
        let why = why.clone();
        Some(Outcome::Cut { why, size })
    }

    /// Size below which an increment is not cut: where a damped motion follows, that which the limit load is found to.
    fn least(&self) -> f64 {
        let controls = &self.state.controls;
        if !self.can_move() {
            return controls.least;
        }
        let largest = self.model.path.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
        // The smallest half is less than twice the least.
        let wanted = controls.settings.limit_load * largest / 2.0;
        // Halves are counted in 32 bits.
        let whole = (self.state.sub_increment.to - self.state.sub_increment.from).abs();
        wanted.max(whole * SMALLEST_HALF).min(controls.least)
    }

    /// Starts the increment again on the next detour. `None` where the strategy cuts nothing, where smaller increments cannot
    /// help, and where all detours have been tried. Where all bodies are given by numbers it is the interface problem itself
    /// that fails, of which the ladder has tried all that it knows; there sliding can be held back at most.
    pub(super) fn detour(&mut self, why: &Failure) -> Option<Outcome> {
        let state = &self.state;
        let chosen = &state.controls.settings;
        if strategy::rungs(chosen.strategy).is_empty()
            || matches!(why, Failure::Leapt { .. }) && state.detour.is_none()
            || !(self.size_helps(why) || self.drowned(why))
            || state.way.is_some()
            || self.model.jumps == Jumps::Dynamic
        {
            return None;
        }
        let last = state.detour.map(|way| way.by);
        let from = state.detour.map_or(state.sub_increment, |way| way.from);
        let rest = from.rest(state.start.load_factor);
        // What the scene names as the least is one; else the section may be finer than a 64th.
        let too_fine = self
            .model
            .least
            .is_some_and(|least| rest.section().size() < least);
        let mut by = Detour::after(last, chosen)?;
        let given = self.is_given();
        let inverted = matches!(why, Failure::Inverted(_));
        let helps = |by: Detour| match by {
            Detour::Back => last.is_some(),
            _ if inverted => false,
            Detour::Held => self.can_hold(why),
            Detour::Section => !given && !too_fine,
            _ => !given,
        };
        while !helps(by) {
            by = Detour::after(Some(by), chosen)?;
        }
        let part = match by {
            Detour::Section => rest.section(),
            Detour::Held | Detour::Back => from,
            _ => rest,
        };
        self.state.detour = Some(Route { by, from });
        self.restart(part);
        if by == Detour::Held {
            self.state.brake = Some(Brake::new(self.source.spring()));
        }
        let (why, size) = (why.clone(), part.size());
        Some(Outcome::Detour { why, by, size })
    }

    /// Whether all bodies are given by numbers.
    fn is_given(&self) -> bool {
        let mut bodies = self.model.bodies.iter();
        bodies.all(|body| matches!(body.kind, BodyKind::Linear(_)))
    }

    /// Starts the increment again, up to the end of this part.
    pub(super) fn restart(&mut self, part: SubIncrement) {
        self.state.sub_increment = part;
        self.drop_factors();
        self.state.start_again();
        self.forget_workspace();
    }

    /// Whether the problem at a part of the load is the same in every way: matrices without gaps, cohesion and prescribed
    /// motions, loaded in proportion for the first time. Motions and forces scale then, and modes are the same.
    fn scales(&self) -> bool {
        let (model, start) = (&self.model, &self.state.start);
        let matrices = !model.bodies.is_empty()
            && model
                .bodies
                .iter()
                .all(|body| matches!(body.kind, BodyKind::Linear(_)))
            && model.surfaces.iter().all(|surface| surface.endless)
            && model.prescribed.is_empty();
        let proportional = model
            .loads
            .iter()
            .all(|load| load.scale == Factor::default());
        let unloaded = start.load_factor == 0.0
            && start.u.iter().all(|u| *u == 0.0)
            && start
                .nodes
                .iter()
                .all(|n| n.f_n == 0.0 && n.f_t == 0.0 && n.slip == 0.0);
        let closed = |contact: usize| {
            self.source
                .kinematics(contact)
                .is_some_and(|k| k.gap == 0.0)
        };
        matrices
            && proportional
            && unloaded
            && self.state.next.major == 1
            && self
                .state
                .controls
                .friction
                .iter()
                .all(|f| f.cohesion == 0.0)
            && (0..model.contacts.len()).all(closed)
    }

    /// Whether nothing holds a body in the modes that the increment starts with, whatever its size.
    fn starts_loose(&self) -> bool {
        let found = self.source.explain(&self.state.start.nodes);
        matches!(found, Singular::Rigid { .. })
    }

    /// Starts the minor iterations of this major one again, with half the load; false if too little is left of it.
    pub(super) fn damp(&mut self) -> bool {
        if self.state.way.is_some() {
            return false;
        }
        let left = self.state.target - self.state.last_target;
        let whole = self.state.load_factor - self.state.start.load_factor;
        if left.abs() < SMALLEST_PART * whole.abs() {
            return false;
        }
        self.state.target = self.state.last_target + left / 2.0;
        self.linearised = false;
        self.begin_again();
        true
    }

    /// Makes the present state the start of the next increment.
    pub(super) fn accept(&mut self, after: Norms, verdict: Verdict, landing: Landing) -> Outcome {
        let unsettled = self.state.unsettled;
        let leg = self.leg_reached();
        let bounded = self.go_along(leg);
        self.settle_contacts();
        let motion = self.state.motion.take();
        let left_range = range_left(&*self.source, &self.state);
        let start = Arc::make_mut(&mut self.state.start);
        start.load_factor = self.state.load_factor;
        let turned = leg != start.leg;
        start.leg = leg;
        self.renew_start(verdict);
        let last = bounded || leg + 1 == self.model.path.len();
        if last {
            self.state.status = Status::Finished;
        } else {
            if turned && !self.model.increments.is_empty() {
                self.take_size(leg);
            }
            self.next_increment();
        }
        Outcome::Increment {
            after,
            unsettled,
            marked: landing.marked,
            jumped: landing.jumped,
            unstable: landing.unstable,
            motion,
            left_range,
            last,
        }
    }

    /// Makes the present displacements and contacts those that are accepted.
    pub(super) fn renew_start(&mut self, verdict: Verdict) {
        let start = Arc::make_mut(&mut self.state.start);
        start.verdict = Some(verdict);
        self.source
            .accept(&self.state.u, &start.u, &mut start.history);
        Arc::make_mut(&mut start.u).copy_from_slice(&self.state.u);
        start.nodes.clone_from(&self.state.nodes);
    }

    /// Slip is counted from here on, and stick points are those of the accepted state.
    pub(super) fn settle_contacts(&mut self) {
        for (node, slave) in self.state.nodes.iter_mut().zip(&self.model.contacts) {
            (node.slip, node.left, node.kept) = (0.0, None, false);
            if node.mode == Mode::Sliding {
                node.anchor_at(node.spot, slave.bond.give()[1]);
                node.drift = 0.0;
            } else if node.corner.is_some() {
                node.anchor = node.spot;
            } else if node.mode == Mode::Free {
                (node.anchor, node.drift, node.stretched) = (None, 0.0, 0.0);
            }
        }
    }

    /// The leg of the path that the load factor has come to.
    fn leg_reached(&self) -> usize {
        let (path, mut leg) = (&self.model.path, self.state.start.leg);
        while leg + 1 < path.len() && self.state.load_factor == path[leg + 1] {
            leg += 1;
        }
        leg
    }

    /// Goes on with the increments that the scene lists for a leg of the path.
    fn take_size(&mut self, leg: usize) {
        let controls = Arc::make_mut(&mut self.state.controls);
        controls.increment = self.model.on_leg(leg);
        controls.least = least(self.model.least, controls.increment);
    }

    fn next_increment(&mut self) {
        // The stiffness that the next increment starts with is that of its own start.
        let taken_here = self.drop_factors();
        let next = &mut self.state.next;
        (next.increment, next.attempt) = (next.increment + 1, 1);
        let whole = || {
            let (start, increment) = (&self.state.start, self.state.controls.increment);
            SubIncrement::whole(&self.model, start.place(), increment)
        };
        self.state.detour = None;
        let rest = self.state.sub_increment.next();
        self.state.sub_increment = rest.unwrap_or_else(whole);
        if rest.is_none() {
            self.state.cuts.clear();
        }
        self.state.begin();
        self.linearised = self.linearised && taken_here && self.source.aim(&self.state.at());
    }
}
