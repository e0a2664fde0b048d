//! Arc length: an increment covers a given length of the equilibrium path, with the load factor as an unknown.
//!
//! ```text
//! tangent    the motion for the modes and the stiffness at the start, in the direction of the previous increment
//! majors     residual at the load factor reached so far; the constraint c · Δu = s fixes the length s that is left
//! ```
//!
//! c is the tangent (all increments end on the plane normal to it, at a distance s ahead: Riks 1979), one displacement, or the
//! slip of one contact. The sign of the tangent is that of its inner product with the previous increment, or, at the start of a
//! leg, that of the load towards the leg's corner. No determinant is used, so limit points, where load and tangent reverse, and
//! turning points, where the displacement reverses, need no special treatment.
//!
//! If a converged state is beyond the leg's corner, or beyond a bound of the history, the increment continues with that as its
//! constraint and ends exactly there. The next size follows from the number of major iterations. A failed increment is cut, or
//! restarted behind the corner of the path at its start ([`crate::step::recovery::path_corner`]).

use crate::model::{ArcLength, ArcMeasure, Jumps};
use crate::step::arc_state::{ArcConstraint, ArcState, Change, ROUNDING, farthest};
use crate::step::iterate::Iterate;
use crate::step::jump::AcceptanceNotes;
use crate::step::pace::RATIO;
use crate::{
    Failure, Finding, Mode, Model, Norms, Outcome, Pace, Singular, State, Stepper, Verdict,
};
use std::sync::Arc;

/// A step doubles back if its angle to the reverse of the previous step has at least this cosine.
const BACK: f64 = 0.999;
/// Motions below this fraction of the scene's length count as zero: round-off can be as large.
const NOTHING: f64 = 1e-9;
/// Minimum and maximum ratio of the size of the next increment to the last.
const CHANGE: [f64; 2] = [0.5, 2.0];

/// A point between two states at which an increment has to end.
struct Goal {
    aim: ArcConstraint,
    /// Its fraction of the distance between them.
    part: f64,
}

impl Stepper {
    /// Accepts a state that passes the judge; cuts an increment that jumps or doubles back.
    pub(super) fn land_on_way(
        &mut self,
        after: Norms,
        verdict: Verdict,
        marked: Option<Finding>,
    ) -> Outcome {
        let motion = self
            .now
            .source
            .moved(&self.now.state.u, &self.now.state.start.u);
        let predicted = self.now.state.record.pace.predicted;
        let moves = motion > NOTHING * self.now.model.length;
        let leaps = moves && motion > RATIO * predicted;
        let why = if self.now.state.doubles_back() {
            Some(Failure::PathReversal)
        } else {
            leaps.then_some(Failure::BranchJump {
                motion,
                predicted,
                unstable: None,
            })
        };
        let mut jumped = false;
        if let Some(why) = why {
            let jumps = self.now.model.jumps;
            let leapt = matches!(why, Failure::BranchJump { .. });
            if !(leapt && jumps == Jumps::Accept)
                && let Some(cut) = self.cut(&why)
            {
                return cut;
            }
            if !leapt || jumps == Jumps::Stop {
                self.now.state.next_major();
                return Outcome::Failed(why);
            }
            jumped = true;
        }
        let landing = AcceptanceNotes {
            jumped,
            ..AcceptanceNotes::marked(marked)
        };
        self.now.accept(after, verdict, landing)
    }
}

impl Iterate {
    /// Computes the tangent at the start of an increment, and with it the constraint of the increment. Does nothing under load
    /// control, or if the tangent is known.
    ///
    /// # Errors
    /// If there is no tangent, or the tangent is zero.
    pub(super) fn find_tangent(&mut self) -> Result<(), Failure> {
        if self.state.way.as_ref().is_none_or(|way| way.known) {
            return Ok(());
        }
        if !self.source.follows_paths() {
            return Err(Failure::ZeroMeasure);
        }
        let turned = self.state.way.as_ref().is_some_and(|way| way.turned);
        let (motion, slips, next) = if turned {
            let (motion, slips) = self.tangent_behind()?;
            (motion, slips, None)
        } else {
            let (mut motion, given) = self.solve_tangent()?;
            let sign = self.state.onwards(&given);
            motion.iter_mut().for_each(|motion| *motion *= sign);
            let slips = given.iter().map(|given| sign * given.motion[1]);
            (motion, slips.collect(), Some(self.next_changes(sign)))
        };
        self.take_tangent(&motion, &slips, next)?;
        self.linearised = false;
        if self.linearise() {
            Ok(())
        } else {
            Err(Failure::Singular(Singular::Unexplained))
        }
    }

    /// Stores a tangent of any size, with the slips of the contacts and the next corner along it, and starts the increment.
    fn take_tangent(
        &mut self,
        motion: &[f64],
        slips: &[f64],
        next: Option<(f64, Vec<Change>)>,
    ) -> Result<(), Failure> {
        let (model, still) = (self.model.clone(), vec![0.0; motion.len()]);
        let largest = self.source.moved(motion, &still);
        let Some(way) = self.state.way.as_mut() else {
            return Ok(());
        };
        let (size, sign) = match way.measured {
            ArcMeasure::Displacements => (largest, 1.0),
            ArcMeasure::Dof(dof) => (motion[dof].abs(), motion[dof].signum()),
            ArcMeasure::Slip(contact) => (slips[contact].abs(), slips[contact].signum()),
        };
        if !(largest.is_finite() && largest > 0.0 && size > NOTHING * largest) {
            return Err(Failure::ZeroMeasure);
        }
        if way.step == 0.0 {
            way.first = model.arc.step.unwrap_or(size);
            way.step = way.first;
        }
        let most = model.arc.largest.unwrap_or(ArcLength::MOST * way.first);
        let all = farthest(&model);
        way.step = way.step.min(most).min(all - way.length);
        let mut row = displacements(&model, motion);
        let square: f64 = row.iter().map(|t| t * t).sum();
        row.iter_mut().for_each(|t| *t *= largest / square);
        (way.row, way.sign, way.known) = (Arc::new(row), sign, true);
        if let Some(next) = next {
            way.expect(next, size);
        }
        way.begin(&self.state.start.u, self.state.controls.increment);
        Ok(())
    }

    /// Stores the load factor of the last solve, with its displacements, in the state.
    pub(super) fn take_load(&mut self) {
        let state = &mut self.state;
        let Some(way) = &mut state.way else { return };
        let reached = match way.aim {
            ArcConstraint::Load(to) => to,
            _ => state.major.target + self.source.load_step(),
        };
        way.left = way.remaining(&state.u, &state.start.u);
        (
            state.major.last_target,
            state.major.target,
            state.load_factor,
        ) = (reached, reached, reached);
    }

    /// Continues from a converged state beyond the end of the increment, with that end as the constraint. `None` if it is not
    /// beyond.
    pub(super) fn turn_to_goal(&mut self, after: Norms) -> Option<Outcome> {
        let goal = self.goal_passed()?;
        self.state.aim_at(goal.aim);
        self.state.next_major();
        let settled = true;
        Some(Outcome::Major { after, settled })
    }

    /// The first corner or bound that the increment has passed.
    fn goal_passed(&self) -> Option<Goal> {
        let (state, model) = (&self.state, &self.model);
        let way = state.way.as_ref()?;
        let part = |from: f64, to: f64, goal: f64| {
            let part = (goal - from) / (to - from);
            (part > 0.0 && part < 1.0 && goal != to).then_some(part)
        };
        let corner = model.path[state.start.leg + 1];
        let of_load = part(state.start.load_factor, state.load_factor, corner).map(|part| Goal {
            aim: ArcConstraint::Load(corner),
            part,
        });
        let bounds = model.arc.bounds.iter().filter_map(|bound| {
            let [from, to] = [&state.start.u, &state.u].map(|u| u[bound.dof]);
            let part = part(from, to, bound.at)?;
            let (dof, to) = (bound.dof, bound.at);
            Some(Goal {
                aim: ArcConstraint::Dof { dof, to },
                part,
            })
        });
        of_load
            .into_iter()
            .chain(bounds)
            .filter(|goal| goal.aim != way.aim)
            .min_by(|a, b| a.part.total_cmp(&b.part))
    }

    /// Updates the arc data with an increment that is about to be accepted: its length, and the size of the next. Returns whether
    /// the history ends at a bound.
    pub(super) fn go_along(&mut self, leg: usize) -> bool {
        let (model, state) = (self.model.clone(), &mut self.state);
        let Some(way) = &mut state.way else {
            return false;
        };
        let (u, start) = (&state.u, &state.start.u);
        way.length += match way.measured {
            ArcMeasure::Displacements => way.gone(u, start),
            ArcMeasure::Dof(dof) => (u[dof] - start[dof]).abs(),
            ArcMeasure::Slip(contact) => state.nodes[contact].slip.abs(),
        };
        let bounded = |aim: ArcConstraint| {
            model.arc.bounds.iter().any(
                |bound| matches!(aim, ArcConstraint::Dof { dof, to } if (dof, to) == (bound.dof, bound.at)),
            )
        };
        let ends = bounded(way.aim) || way.length >= farthest(&model) * (1.0 - ROUNDING);
        let whole = !matches!(way.aim, ArcConstraint::Load(_)) && !bounded(way.aim);
        if whole {
            let wanted = f64::from(model.arc.iterations) / f64::from(state.next.major);
            way.step *= wanted.sqrt().clamp(CHANGE[0], CHANGE[1]);
        }
        let motion: Vec<f64> = u
            .iter()
            .zip(start.iter())
            .map(|(u, start)| u - start)
            .collect();
        let mut last = displacements(&model, &motion);
        let square: f64 = last.iter().map(|d| d * d).sum();
        last.iter_mut().for_each(|d| *d /= square);
        way.last_load = state.load_factor - state.start.load_factor;
        if leg != state.start.leg || square == 0.0 {
            last.clear();
            if let Some(corner) = model.path.get(leg + 1) {
                way.ahead = (corner - state.load_factor).signum();
            }
        }
        way.slips = Arc::new(
            state
                .nodes
                .iter()
                .map(|node| match node.mode {
                    Mode::Sliding => node.slip,
                    _ => 0.0,
                })
                .collect(),
        );
        (way.last, way.known, way.turned) = (Arc::new(last), false, false);
        ends
    }
}

impl State {
    /// Whether the state is on the path of the previous increment, or behind the start of this one.
    fn doubles_back(&self) -> bool {
        let state = self;
        let Some(way) = &state.way else { return false };
        let behind = way.measured == ArcMeasure::Displacements
            && way.gone(&state.u, &state.start.u) <= -ROUNDING * way.step;
        if behind || self.turned_back() || way.turned || way.last.is_empty() {
            return behind || self.turned_back();
        }
        let moved = state
            .u
            .iter()
            .zip(state.start.u.iter())
            .map(|(u, start)| u - start);
        let load = state.load_factor - state.start.load_factor;
        goes_back(moved, &way.last) && load * way.last_load <= 0.0
    }

    fn aim_at(&mut self, aim: ArcConstraint) {
        let state = &mut *self;
        let Some(way) = &mut state.way else { return };
        way.aim = aim;
        way.left = match aim {
            ArcConstraint::Load(to) => to - state.load_factor,
            _ => way.remaining(&state.u, &state.start.u),
        };
    }
}

impl State {
    /// Starts along the path from the start of the current increment.
    pub(super) fn set_out(&mut self) {
        let start = self.start.clone();
        let Some(way) = &mut self.way else { return };
        way.known = way.known && !way.turned;
        way.begin(&start.u, self.controls.increment);
        self.load_factor = start.load_factor;
        (self.major.target, self.major.last_target) = (start.load_factor, start.load_factor);
        self.change_modes();
    }

    /// The last accepted state, from which the path continues by arc length, first over a largest displacement of `step`. `None`
    /// at the end of the history.
    pub fn along_path(&self, model: &Model, step: f64) -> Option<State> {
        let corner = model.path.get(self.start.leg + 1)?;
        let mut along = self.clone();
        (along.recovery.motion, along.recovery.fallback) = (None, None);
        along.record.pace = Pace::default();
        along.way = Some(Box::new(ArcState {
            measured: ArcMeasure::Displacements,
            ahead: (corner - self.start.load_factor).signum(),
            step,
            first: step,
            ..ArcState::new(model)
        }));
        along.start_again();
        Some(along)
    }

    /// Gives contacts the modes behind the corner, if the current increment starts there.
    pub(super) fn change_modes(&mut self) {
        if let Some(way) = &self.way {
            way.change(&mut self.nodes, &self.controls.friction);
        }
    }
}

/// Whether displacements oppose the last ones, within the angle of [`BACK`].
fn goes_back(moved: impl Iterator<Item = f64>, last: &[f64]) -> bool {
    let (mut product, mut here, mut there) = (0.0, 0.0, 0.0);
    for (now, &then) in moved.zip(last).filter(|(_, then)| **then != 0.0) {
        (product, here, there) = (product + now * then, here + now * now, there + then * then);
    }
    here > 0.0 && product < -BACK * (here * there).sqrt()
}

/// The displacements of a motion of all degrees of freedom: without rotations and unknown forces.
fn displacements(model: &Model, motion: &[f64]) -> Vec<f64> {
    let mut kept = vec![0.0; motion.len()];
    for &first in &model.dofs.first {
        kept[first..first + 2].copy_from_slice(&motion[first..first + 2]);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_way_that_was_come_is_the_way_back() {
        let last = [1.0, 0.5, 0.0, -2.0];
        let along = |factor: f64, aside: f64| {
            let moved = last.map(|l| factor * l);
            goes_back(
                [moved[0] + aside, moved[1], 9.0, moved[3]].into_iter(),
                &last,
            )
        };
        assert!(along(-1.0, 0.0) && along(-0.01, 0.0) && along(-3.0, 0.01));
        assert!(!along(1.0, 0.0) && !along(-1.0, 0.5) && !along(0.0, 0.0));
    }
}
