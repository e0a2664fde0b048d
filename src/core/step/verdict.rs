//! Asks the judge before an increment is accepted, and handles states that it refuses.
//!
//! A first refusal for slip is repaired: the nodes that touched when the increment started, including those that are open now,
//! get back their anchors from that time, and the increment continues with the true net slip. A second refusal, or one for
//! another law, cuts the increment: smaller increments distinguish a node that truly opened and closed again from one that only
//! seemed to. If it cannot be cut, it fails. Violations that the user asked for are marked and never refused: held modes,
//! interpretations of the paper that violate the law, and limits that are to be accepted.
//!
//! A state with an inverted element (det F ≤ 0 at an integration point or a node of a solid) is always rejected: the increment
//! is cut, and fails if it cannot be cut. Other interpretations of the contact status are not tried for such a state.

use crate::model::{SlipCount, Sticking, TieRule};
use crate::step::iterate::Iterate;
use crate::{
    Failure, Finding, Forced, JudgedLaw, Norms, Outcome, PointDeformation, State, Stepper, Verdict,
};

impl Stepper {
    /// Accepts a converged state, or handles its refusal by the judge.
    pub(super) fn finish(&mut self, after: Norms) -> Outcome {
        if let Some(on) = self.now.turn_to_goal(after) {
            return on;
        }
        if let Some(point) = self.now.inverted() {
            return self.refuse_inverted(point);
        }
        let verdict = self.now.source.judge(&self.now.state.at(), &after);
        if self.now.state.recovery.motion.is_some() {
            let worst = worst_of(&verdict);
            return match worst.filter(|found| is_slip(found.law) && !self.now.state.attempt.net) {
                Some(why) => {
                    self.now.count_net_slip();
                    Outcome::Refused { why, after }
                }
                None => self.end_step(after, verdict, worst),
            };
        }
        let Some(worst) = worst_of(&verdict) else {
            return self.land(after, verdict, None);
        };
        if self.now.state.only_marks() {
            return self.land(after, verdict, Some(worst));
        }
        if is_slip(worst.law) && !self.now.state.attempt.net {
            self.now.count_net_slip();
            return Outcome::Refused { why: worst, after };
        }
        let why = Failure::Refused(worst);
        if let Some(stop) = self.now.state.cut_too_often(&why) {
            self.now.state.next_major();
            return Outcome::Failed(stop);
        }
        match self.cut(&why) {
            Some(cut) => cut,
            None if worst.law == JudgedLaw::Touch => self.land(after, verdict, Some(worst)),
            None => self.fall_back(&why).unwrap_or_else(|| {
                self.now.state.next_major();
                Outcome::Failed(why)
            }),
        }
    }

    /// Cuts an increment that ends with an inverted element at `point`, or fails if it cannot be cut.
    pub(super) fn refuse_inverted(&mut self, point: PointDeformation) -> Outcome {
        self.now.state.next_major();
        self.fail(Failure::Inverted(point))
    }
}

impl Iterate {
    /// Worst point of an inverted element of the current state. `None` if no element is inverted. The same pass over all points
    /// renews `deformation`.
    pub(super) fn inverted(&mut self) -> Option<PointDeformation> {
        self.deformation = self.source.deformation(&self.state.u);
        self.deformation?.inverted()
    }

    /// Takes the worst point outside the range of its law in the state that is being accepted. `None` if all are inside, or if a
    /// point was already outside in the last accepted state.
    pub(super) fn take_range_left(&mut self) -> Option<PointDeformation> {
        let inside_before = || {
            let before = self.source.deformation(&self.state.start.u);
            before.is_none_or(|found| found.outside.is_none())
        };
        let outside = self.deformation.take()?.outside;
        outside.filter(|_| inside_before())
    }

    /// Restores the anchors of the nodes that touched when the increment started, for the rest of the attempt, and continues with
    /// another major iteration.
    fn count_net_slip(&mut self) {
        let start = self.state.start.clone();
        let tolerance = self.state.controls.settings.tolerance;
        self.source
            .count_net_slip(tolerance, &start.nodes, &mut self.state.nodes);
        self.state.attempt.net = true;
        self.state.next_major();
        self.state.forget_minors();
        self.state.forget_majors();
        self.linearised = false;
    }
}

impl State {
    /// Whether states that violate a law are accepted, since the user asked for what causes them.
    fn only_marks(&self) -> bool {
        let settings = &self.controls.settings;
        self.attempt.unsettled > 0
            || settings.slip == SlipCount::Major
            || settings.sticking == Sticking::Increments
            || settings.ties == TieRule::Printed
            || self
                .nodes
                .iter()
                .any(|node| matches!(node.forced, Forced::Held(_)))
    }
}

/// Whether a law concerns the net slip of a node.
fn is_slip(law: JudgedLaw) -> bool {
    matches!(law, JudgedLaw::Slip | JudgedLaw::Stick)
}

/// The worst violation of a law: slip first, since it can be repaired, and the touch of an open node last, since it may be
/// harmless.
pub(super) fn worst_of(verdict: &Verdict) -> Option<Finding> {
    let rank = |finding: &Finding| match finding.law {
        law if is_slip(law) => 2,
        JudgedLaw::Touch => 0,
        _ => 1,
    };
    verdict
        .broken()
        .max_by(|a, b| {
            let by_rank = rank(a).cmp(&rank(b));
            by_rank.then(a.amount.total_cmp(&b.amount))
        })
        .copied()
}
