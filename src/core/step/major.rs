//! The end of a major iteration: updates displacements, forces and geometry, and checks whether the increment has converged.

use crate::contact::corner::least_friction;
use crate::model::{AtLimit, Prescribed, ResidualMethod, SlipCount, Sticking};
use crate::step::iterate::Iterate;
use crate::step::major_history::RepeatScales;
use crate::step::recovery::PATIENCE;
use crate::{
    ContactRecord, ContactState, Failure, Friction, MajorCycle, Mode, Model, Norms, Outcome,
    SearchProgress, Singular, SolveResult, State, Stepper,
};
use std::sync::Arc;

/// A displacement larger than this multiple of the scene's length is divergence.
pub(super) const DIVERGED: f64 = 1e4;
/// If round-off keeps the residual above the tolerance, displacements must change by less than this fraction of the length.
const STILL: f64 = 1e-8;
/// Largest difference of the forces of the last minor iteration from those of an accepted state, by the force scale: between
/// linear bodies the judge's, otherwise the digits that are shown.
const REPORTED: [f64; 2] = [1e-8, 1e-6];
/// With old factors, displacements have converged within this fraction of the length, whatever the tolerance.
const NEAR: f64 = 1e-10;
/// Fraction of the out-of-balance force that a major iteration with old factors may leave before the factors are renewed.
const ENOUGH: f64 = 0.1;
/// First major iteration from which an inverted element is refused, and the stiffness is always the current one: earlier
/// iterations may overshoot and recover.
const OVERSHOOT: u32 = 8;
/// An increment along the path fails after this multiple of the major iterations that keep its size.
const LOST: u32 = 2;

impl Stepper {
    /// Updates displacements and forces, renews the geometry, and checks whether the increment has converged. `settled` is false
    /// if the limit of minor iterations was accepted instead.
    pub(super) fn end_major(&mut self, settled: bool) -> Outcome {
        let held = self.now.hold(&self.event.nodes);
        // The correction of new factors measures what the previous ones left.
        let constant = self.now.model.has_constant_stiffness();
        let fresh = constant || self.now.state.major.factored.is_none();
        let before = self.now.state.major.correction;
        let asked = if self.now.keeps_factors() {
            self.now.source.required_force()
        } else {
            f64::INFINITY
        };
        if self.now.source.recover() == SolveResult::Not {
            let singular = self.now.explain();
            return self.fail(Failure::Singular(singular));
        }
        self.now.update(&self.event.nodes);
        let search = &mut self.now.state.attempt.search;
        (search.first, search.fewest, search.rounds) = (None, None, 0);
        let frozen = std::mem::take(&mut search.frozen);
        search.searched = SearchProgress::Not;
        self.now.state.record.searched.frozen |= frozen;
        self.now.kept = None;
        let norms = self.norms();
        if let Some(again) = held.and_then(|held| self.now.hold_back(held)) {
            return again;
        }
        let state = &self.now.state;
        note_releases(
            &mut self.event.nodes,
            &state.nodes,
            &state.controls.friction,
        );
        self.now.state.attempt.unsettled += u32::from(!settled);
        let Some(after) = norms else {
            return self.fail(Failure::Singular(Singular::Unexplained));
        };
        let settings = self.now.state.controls.settings;
        let size = self.now.source.largest_motion(&self.now.state.u);
        let bounded = after.relative.is_finite() && size < DIVERGED * self.now.model.length;
        let exact = self.now.state.is_balanced(&after);
        let balanced = exact && (fresh || self.now.is_near(before));
        let braked = self.now.state.recovery.brake.is_some();
        let most = self.now.most_majors(braked);
        let at_limit = self.now.state.next.major.is_multiple_of(most);
        let drowned = after.noise > Norms::LOUDEST;
        // A motion larger than the scene's length has diverged, however large its round-off.
        let still = after.correction < 1.0;
        // Forces between linear bodies that stick balance at once, whatever the directions along which they were solved for, and
        // so do those on nodes whose motion is given by supports and contacts.
        let [linear, nonlinear] = REPORTED;
        let least = if constant { linear } else { nonlinear };
        let reported = least.max(settings.tolerance) * after.scale;
        // A damped motion balances other forces, too, and what it ends with is judged at rest.
        let turned = !at_limit
            && self.now.state.recovery.motion.is_none()
            && after.correction > STILL
            && differ(&self.event.nodes, &self.now.state.nodes, reported);
        let unfinished =
            turned || self.now.state.is_carried(&after) || lags(&self.now.model, &self.now.state);
        if settled && balanced && !drowned && !unfinished {
            return self.finish(after);
        }
        let accepts = settings.at_major_limit == AtLimit::Accept && !drowned;
        if at_limit && bounded && accepts {
            self.now.state.attempt.unsettled += 1;
            return self.finish(after);
        }
        if bounded
            && self.now.state.next.major >= OVERSHOOT
            && let Some(point) = self.now.inverted()
        {
            return self.refuse_inverted(point);
        }
        let carried = !fresh && !exact && self.now.state.next.major == 1;
        let before = if fresh { 0.0 } else { before };
        let poor = leaves_much(asked, before, &after)
            || carried && needs_more(asked, settings.tolerance, &after);
        if poor && !constant {
            self.now.renew_factors();
        }
        self.now.state.next_major();
        if !bounded {
            return self.fail(Failure::Diverged {
                relative: after.relative,
            });
        }
        if drowned && (at_limit && still || settled && balanced) {
            return self.fail(Failure::RoundOff { noise: after.noise });
        }
        if settings.at_major_limit == AtLimit::Stop
            && !braked
            && let Some(cycle) = self.now.find_major_cycle()
        {
            self.now.state.forget_majors();
            return self.fail(Failure::MajorCycle(cycle));
        }
        if at_limit {
            return self.fail(Failure::MajorLimit {
                limit: most,
                relative: after.relative,
                interface: after.interface,
            });
        }
        Outcome::Major { after, settled }
    }
}

impl Iterate {
    /// Whether the settings keep old factors where they help: under load control, without damping.
    pub(super) fn keeps_factors(&self) -> bool {
        let state = &self.state;
        let loaded = state.way.is_none() && state.recovery.motion.is_none();
        // The stiffness of a pressure that follows its faces changes with the load.
        let dead = self.model.has_dead_loads();
        let settings = &state.controls.settings;
        let condensed = self.source.condenses(settings);
        loaded && dead && self.model.keeps_factors(settings.factor, condensed)
    }

    /// Reuses the current stiffness in the next major iteration, if the settings allow it and the increment is not a hard one.
    fn keep_factors(&mut self) {
        let next = &self.state.next;
        let hard = next.major >= OVERSHOOT || next.attempt > 1;
        let suits = !hard || self.model.has_constant_stiffness();
        if !suits || !self.keeps_factors() {
            self.drop_factors();
        } else if self.state.major.factored.is_none() {
            let mut about = self.room.take().unwrap_or_default();
            Arc::make_mut(&mut about).clone_from(&self.state.u);
            self.state.major.factored = Some(about);
        }
    }

    /// Has the stiffness recomputed; returns whether the current one was that of the current displacements.
    pub(super) fn drop_factors(&mut self) -> bool {
        match self.state.major.factored.take() {
            Some(about) => {
                self.room = Some(about);
                false
            }
            None => true,
        }
    }

    /// Whether the remaining error of the displacements is at most the tolerance times the motion of the increment. With old
    /// factors the displacements converge linearly, and in soft directions small forces do not bound the error; the ratio of the
    /// last correction to the one `before` does.
    fn is_near(&self, before: f64) -> bool {
        let (state, last) = (&self.state, self.state.major.correction);
        if last == 0.0 {
            return true;
        }
        // Slow convergence shows late in this ratio.
        let ratio = (last / before).clamp(ENOUGH, 0.5);
        let left = last * ratio / (1.0 - ratio);
        let moved = self.source.moved(&state.u, &state.start.u) / self.model.length;
        left <= (state.controls.settings.tolerance * moved).max(NEAR)
    }

    /// Has the stiffness recomputed at the current displacements.
    fn renew_factors(&mut self) {
        if !self.drop_factors() {
            (self.linearised, self.measured) = (false, false);
        }
    }

    /// Number of major iterations after which an increment fails. Along the path, a slow increment has lost the path: it may
    /// converge to another branch.
    fn most_majors(&self, braked: bool) -> u32 {
        let majors = self.state.controls.settings.majors;
        match (braked, &self.state.way) {
            (true, _) => majors * PATIENCE,
            (false, Some(_)) => majors.min(LOST * self.model.arc.iterations),
            (false, None) => majors,
        }
    }

    /// Finds a cycle: whether the next major iteration starts from the same state as an earlier one of this increment.
    fn find_major_cycle(&mut self) -> Option<MajorCycle> {
        let scales = RepeatScales {
            force: self.force_scale(),
            length: self.model.length,
        };
        let (major, contacts) = (self.state.next.major, self.state.nodes.len());
        let source = &self.source;
        let places = (0..contacts).map(|contact| source.position(contact));
        let history = Arc::make_mut(&mut self.state.attempt.major_history);
        history.push(&self.state.nodes, places);
        history.cycle(contacts, major, scales)
    }

    /// Updates the state with displacements and forces of the last minor iteration, and linearises there.
    fn update(&mut self, records: &[ContactRecord]) {
        self.measured = false;
        self.state.major.last_target = self.state.major.target;
        self.state.major.target = self.state.load_factor;
        self.keep_factors();
        let largest = self
            .source
            .advance(Arc::make_mut(&mut self.state.u).as_mut_slice());
        self.state.major.correction = largest / self.model.length;
        let (whole, part) = (self.state.load_factor, self.state.major.last_target);
        let pace = &mut self.state.record.pace;
        if self.state.next.major == 1 {
            // A damped iteration covers only part of the increment.
            let from = self.state.start.load_factor;
            let times = (whole - from) / (part - from);
            let times = if times.is_finite() { times } else { 1.0 };
            (pace.predicted, pace.corrected) = (largest * times, 0.0);
        } else {
            pace.corrected += largest;
        }
        self.take_load();
        for (contact, record) in records.iter().enumerate() {
            self.take_increment(contact, record);
        }
        self.state.forget_minors();
        self.follow();
        self.linearised = self.source.linearise(&self.state.at()).is_ok();
        self.measured = self.linearised;
        let by_stress = self.state.controls.settings.residual == ResidualMethod::Stress;
        if by_stress && self.source.take_forces_from_stresses(&mut self.state.nodes) {
            self.source.rebalance(&self.state.at());
        }
        self.source.turn(&self.state.at());
    }

    /// Stores a contact's forces and slip of the last minor iteration; a node that has touched sticks where its path crossed the
    /// surface.
    ///
    /// T_max stays that of the last minor iteration: forces from stresses carry the whole error of the linearisation,
    /// which can exceed F_n itself, and a first trial with such a T_max opens contacts that are closed.
    fn take_increment(&mut self, contact: usize, record: &ContactRecord) {
        let (before, f_n, f_t) = (record.decision.before, record.f_n, record.f_t);
        let node = &mut self.state.nodes[contact];
        (node.f_n, node.f_t) = (f_n, f_t);
        node.slip = if before == Mode::Free && !node.kept {
            0.0
        } else {
            let motion = self.source.increment(contact).motion;
            let touched = self.source.kinematics(contact).map_or(0.0, |over| {
                if node.ratio == 0.0 {
                    0.0
                } else {
                    over.gap * node.ratio
                }
            });
            node.slip + motion[1] - touched
        };
        if before != Mode::Free && node.anchor.is_none() {
            node.anchor = self.source.stick_point(contact, node);
            node.stretched = 0.0;
        }
        node.ratio = 0.0;
        node.travel = 0.0;
    }

    /// Finds the position of every contact on its surface.
    pub(super) fn follow(&mut self) {
        // If slip is counted from each major iteration, the stick point is renewed as well.
        let settings = self.state.settings();
        let anew = settings.slip == SlipCount::Major && settings.sticking == Sticking::Anchored;
        let (u, friction) = (&self.state.u, &self.state.controls.friction);
        let unclosed = self
            .model
            .unclosed(self.state.start.leg, self.state.major.target);
        self.source
            .follow(u, &mut self.state.nodes, friction, anew, unclosed);
        self.linearised = false;
    }
}

impl State {
    /// Whether forces and interface conditions are satisfied at the full load of the increment.
    fn is_balanced(&self, after: &Norms) -> bool {
        let tolerance = self.controls.settings.tolerance;
        let exact = after.relative <= tolerance;
        self.major.last_target == self.load_factor
            && (exact || (after.relative <= after.limit && after.correction <= STILL))
            && after.interface <= after.limit.max(tolerance)
    }

    /// Starts the first minor iteration of another major iteration.
    pub(super) fn next_major(&mut self) {
        self.count_cost(1);
        self.next.major += 1;
        self.next.minor = 1;
    }
}

/// Whether a prescribed displacement is not yet that of the load factor: a solution along an arc may leave the range of the path, where
/// its amplitude bends.
fn lags(model: &Model, state: &State) -> bool {
    let is_late = |p: &Prescribed| {
        let wanted = p.value * p.scale.at(state.load_factor);
        (wanted - state.u[p.dof]).abs() > NEAR * wanted.abs().max(p.value.abs())
    };
    state.way.is_some() && model.prescribed.iter().any(is_late)
}

/// Whether the forces of the last minor iteration, along the directions frozen in it, differ from those of the state by more than
/// `allowed`.
fn differ(records: &[ContactRecord], nodes: &[ContactState], allowed: f64) -> bool {
    let differences = records.iter().zip(nodes).map(|(record, node)| {
        let [n, t] = [record.f_n - node.f_n, record.f_t - node.f_t];
        n.abs().max(t.abs())
    });
    differences.fold(0.0, f64::max) > allowed
}

/// Whether a major iteration left more than [`ENOUGH`] of the out-of-balance force `asked` of it, or of the correction `before`:
/// the next one with the same factors would leave as much.
fn leaves_much(asked: f64, before: f64, after: &Norms) -> bool {
    let slow = before > 0.0 && after.correction > ENOUGH * before;
    slow || after.relative > ENOUGH * asked
}

/// Whether more than one further major iteration is needed if it leaves as much as this one.
fn needs_more(asked: f64, tolerance: f64, after: &Norms) -> bool {
    after.relative * after.relative > tolerance.max(after.limit) * asked
}

/// Marks the records of contacts that were held in a corner in the last minor iteration and now slide.
fn note_releases(records: &mut [ContactRecord], nodes: &[ContactState], friction: &[Friction]) {
    for (record, (node, friction)) in records.iter_mut().zip(nodes.iter().zip(friction)) {
        let stayed = record.decision.next == Mode::Fixed && node.mode == Mode::Sliding;
        if let Some(half) = record.corner.filter(|_| stayed) {
            let least = least_friction(friction, half, record.f_n);
            record.decision = record.decision.released(node.sign * record.f_t, least);
        }
    }
}
