//! The conditions that recoveries check on a failed increment.

use super::fallback::{DEEPER, Fallback};
use crate::model::{Body, Factor, Jumps};
use crate::plane::max_abs;
use crate::strategy;
use crate::{Failure, Mode, Model, Singular, Source, State, SubIncrement};

/// Minimum size of a half, as a fraction of the whole increment.
const SMALLEST_HALF: f64 = 1e-9;
/// Maximum gap of a contact that is closed at the start if a body is loose, over the scene's length.
const NEAR: f64 = 1e-4;
/// If no gap is that small: how much larger than the smallest one the others may be, over the scene's length. Of a round body this
/// closes more than one contact, which hold its rotation.
const ALIKE: f64 = 5e-3;

/// A failed increment.
pub(in crate::step) struct FailedIncrement<'a> {
    pub model: &'a Model,
    pub state: &'a State,
    pub source: &'a dyn Source,
}

impl FailedIncrement<'_> {
    /// Whether an increment with this failure may succeed with another size.
    pub fn size_helps(&self, why: &Failure) -> bool {
        match why {
            Failure::OverConstrained { .. } | Failure::RoundOff { .. } => false,
            Failure::Singular(Singular::Rigid { .. }) => !self.starts_loose(),
            Failure::LadderEnded { scales, .. } => !scales,
            _ => true,
        }
    }

    /// Size below which an increment is not cut; before a damped motion, the accuracy of the limit load.
    pub fn least(&self) -> f64 {
        let controls = &self.state.controls;
        let fallback = self.state.recovery.fallback.map(|route| route.by);
        if fallback == Some(Fallback::Deeper) && self.searches(Fallback::Deeper) {
            return controls.least / DEEPER;
        }
        if !self.can_move() {
            return controls.least;
        }
        let largest = max_abs(&self.model.path);
        // The smallest half is less than twice the minimum.
        let wanted = controls.settings.limit_load * largest / 2.0;
        // Halves are counted in 32 bits.
        let whole = (self.state.sub_increment.to - self.state.sub_increment.from).abs();
        wanted.max(whole * SMALLEST_HALF).min(controls.least)
    }

    /// Whether the scene requests damped motions and its source supports them.
    pub fn can_move(&self) -> bool {
        self.model.jumps == Jumps::Dynamic && self.source.damps()
    }

    /// Whether the search may continue with a fallback: not if jumps end the history, or if all bodies are given as matrices.
    pub fn searches(&self, by: Fallback) -> bool {
        let budget = self.state.controls.settings.search;
        self.state.record.searched.can_afford(by, budget)
            && self.model.jumps != Jumps::Stop
            && !self.is_given()
    }

    /// Whether a body is unsupported at the start of the history, and a free contact is near there.
    pub fn can_touch(&self, why: &Failure) -> bool {
        let loose = match why {
            Failure::Singular(_) => true,
            Failure::LadderEnded { first, .. } => matches!(**first, Failure::Singular(_)),
            _ => false,
        };
        loose && self.state.start.verdict.is_none() && self.near().next().is_some()
    }

    /// Whether a body is unsupported in the first minor iteration of the history, and no strategy after the first can help
    /// ([`strategy::needs_support`]).
    pub fn starts_unsupported(&self, why: &Failure) -> bool {
        let state = self.state;
        let contacts = state.nodes.len();
        let over = |contact: &usize| {
            !self.model.contacts[*contact].bond.is_tied()
                && self.source.kinematics(*contact).is_some()
        };
        matches!(why, Failure::Singular(Singular::Rigid { .. }))
            && state.start.verdict.is_none()
            && (state.next.major, state.next.minor) == (1, 1)
            && strategy::needs_support(contacts, (0..contacts).filter(over).count())
    }

    /// Free contacts whose gap is small, or else those with about the smallest gap.
    pub fn near(&self) -> impl Iterator<Item = usize> {
        let gaps = || {
            let nodes = self.state.start.nodes.iter().enumerate();
            let free = nodes.filter(|(_, node)| node.mode == Mode::Free);
            free.filter_map(|(contact, _)| {
                Some((contact, self.source.kinematics(contact)?.gap.abs()))
            })
        };
        let least = gaps().fold(f64::INFINITY, |least, (_, gap)| least.min(gap));
        let near = if least > NEAR * self.model.length {
            least + ALIKE * self.model.length
        } else {
            NEAR * self.model.length
        };
        gaps()
            .filter(move |(_, gap)| *gap <= near)
            .map(|(contact, _)| contact)
    }

    /// Whether a damped motion may begin at the last equilibrium: none has begun there yet, and jumps are accepted.
    pub fn can_release(&self) -> bool {
        let start = self.state.start.load_factor;
        self.source.damps()
            && self.state.start.verdict.is_some()
            && self.state.record.searched.released != Some(start)
    }

    /// Twice the increment from the last accepted state, at most to the end of the leg. `None` if it ends before this load factor.
    pub fn longer(&self, end: f64) -> Option<SubIncrement> {
        // A damped motion has another start.
        let state = self.state;
        let start = state
            .record
            .searched
            .origin
            .as_ref()
            .unwrap_or(&state.start);
        let longer = SubIncrement::whole(self.model, start.place(), 2.0 * state.controls.increment);
        (longer.size() > (end - start.load_factor).abs()).then_some(longer)
    }

    /// Whether the search may not go on with longer increments.
    pub fn is_exhausted(&self) -> bool {
        let by = self.state.recovery.fallback.map(|fallback| fallback.by);
        by == Some(Fallback::Longer) && !self.searches(Fallback::Longer)
    }

    /// Whether an increment with this failure may succeed if sliding is held back.
    pub fn can_hold(&self, why: &Failure) -> bool {
        let helps = matches!(
            why,
            Failure::MajorCycle(_)
                | Failure::MajorLimit { .. }
                | Failure::Diverged { .. }
                | Failure::LadderEnded { .. }
                | Failure::NoAnswer { .. }
                | Failure::Refused(_)
                | Failure::BranchJump { .. }
        );
        let mut nodes = self.state.nodes.iter().chain(&self.state.start.nodes);
        (helps || self.drowned(why))
            && nodes.any(|node| node.mode != Mode::Free)
            && self.source.brakes()
            && self.model.jumps != Jumps::Stop
    }

    /// Whether a round-off failure is due to divergence: round-off then dominates before the bounds of divergence are exceeded.
    pub fn drowned(&self, why: &Failure) -> bool {
        matches!(why, Failure::RoundOff { .. }) && self.state.next.major > 2
    }

    /// Whether all bodies are given as matrices.
    pub fn is_given(&self) -> bool {
        self.model.bodies.iter().all(Body::is_linear)
    }

    /// Whether the problem is the same at any part of the load: matrices without gaps, cohesion or prescribed motions, loaded in
    /// proportion for the first time. Motions and forces then scale with the load, and the modes are the same.
    pub fn scales(&self) -> bool {
        let (model, start) = (self.model, &self.state.start);
        let matrices = !model.bodies.is_empty()
            && self.is_given()
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
            && (0..model.contacts.len()).all(|contact| {
                self.source
                    .kinematics(contact)
                    .is_some_and(|k| k.gap == 0.0)
            })
    }

    /// Whether a body is unsupported in the modes at the start of the increment, whatever its size.
    fn starts_loose(&self) -> bool {
        let found = self.source.explain(&self.state.start.nodes);
        matches!(found, Singular::Rigid { .. })
    }
}
