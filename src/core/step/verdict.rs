//! The judge is asked before an increment is accepted, and what becomes of a state that it refuses.
//!
//! A first refusal for slip is repaired: the nodes that touched when the increment started get back the anchors that they had
//! then, also those that are open, and the increment goes on with the true net slip. A second refusal, or one for
//! another law, cuts the increment, since smaller ones tell a node that truly left and came back from one that only
//! seemed to. Where it cannot be cut, it fails. What the user asked for is marked and never refused: held modes, readings
//! of the paper that leave the law, and limits that are to be accepted.

use crate::contact::balance::{self, Forces};
use crate::contact::judge::{Finding, Judge, Law, Scales, Seen, Verdict};
use crate::contact::record::Forced;
use crate::contact::tracking::Ground;
use crate::linear::norms::Norms;
use crate::model::Model;
use crate::model::{SlipCount, Sticking, Ties};
use crate::step::event::{Failure, Outcome};
use crate::step::stepper::Stepper;

/// What a relative amount against a law may be at least; more where the settings' tolerance or round-off is larger.
const TOLERANCE: f64 = 1e-8;
/// How many times the tolerance of the iterations a judged amount may be.
const TIMES: f64 = 10.0;

/// The judge, with the memory that it works in.
#[derive(Debug)]
pub struct Bench {
    judge: Judge,
    /// Positions of all nodes in the last accepted state.
    before: Vec<[f64; 2]>,
    forces: Vec<[f64; 2]>,
    brought: Vec<f64>,
    earlier: Vec<f64>,
    /// Contact force at every node.
    contact: Vec<[f64; 2]>,
    /// Load at every degree of freedom.
    load: Vec<f64>,
}

impl Bench {
    /// Memory for a scene.
    pub fn new(model: &Model) -> Self {
        let (nodes, slaves) = (model.nodes.len(), model.contacts.len());
        Bench {
            judge: Judge::with_capacity(nodes, slaves),
            before: Vec::with_capacity(nodes),
            forces: Vec::with_capacity(slaves),
            brought: Vec::with_capacity(slaves),
            earlier: Vec::with_capacity(slaves),
            contact: vec![[0.0; 2]; nodes],
            load: vec![0.0; model.dofs.len()],
        }
    }
}

impl Stepper {
    /// Accepts a converged state, or does with it what the judge makes necessary.
    pub(super) fn finish(&mut self, after: Norms) -> Outcome {
        let verdict = self.judge_state(&after);
        let Some(worst) = worst_of(&verdict) else {
            return self.land(after, verdict);
        };
        if self.only_marks() {
            return self.accept(after, verdict, Some(worst), false);
        }
        if worst.law == Law::Slip && !self.state.net {
            self.count_net_slip();
            return Outcome::Refused { why: worst, after };
        }
        let why = Failure::Refused(worst);
        match self.cut(&why) {
            Some(cut) => cut,
            None if worst.law == Law::Touch => self.accept(after, verdict, Some(worst), false),
            None => {
                self.state.next.major += 1;
                self.state.next.minor = 1;
                Outcome::Failed(why)
            }
        }
    }

    /// Judges the present state, at the end of a major iteration whose norms these are.
    pub(super) fn judge_state(&mut self, after: &Norms) -> Verdict {
        let (model, state, bench) = (&self.model, &self.state, &mut self.bench);
        let tolerance = state.controls.settings.tolerance;
        let scales = Scales {
            length: model.length,
            force: after.scale.max(f64::MIN_POSITIVE),
            lengths: (TIMES * tolerance).max(TOLERANCE),
            forces: (TIMES * tolerance.max(after.limit)).max(TOLERANCE),
        };
        bench.before.clear();
        let at_start = model.dofs.first.iter().zip(&model.nodes);
        bench.before.extend(at_start.map(|(&first, node)| {
            let u = &state.start.u[first..first + 2];
            [node.at[0] + u[0], node.at[1] + u[1]]
        }));
        bench.forces.clear();
        bench
            .forces
            .extend(state.nodes.iter().map(|node| node.force()));
        bench.brought.clear();
        bench
            .brought
            .extend(state.start.nodes.iter().map(|node| node.slip));
        bench.earlier.clear();
        bench
            .earlier
            .extend(state.start.nodes.iter().map(|node| node.f_t));
        let now = &self.system.positions;
        let seen = Seen {
            surfaces: &model.surfaces,
            slaves: &model.contacts,
            friction: &state.controls.friction,
            before: &bench.before,
            now,
            forces: &bench.forces,
            brought: &bench.brought,
            earlier: &bench.earlier,
            scales,
        };
        let mut verdict = bench.judge.interface(&seen, &mut bench.contact);
        bench.load.fill(0.0);
        for load in &model.loads {
            bench.load[load.dof] += load.value * load.scale.at(state.last_target);
        }
        let forces = Forces {
            internal: self.system.internal(),
            load: &bench.load,
            contact: &bench.contact,
        };
        balance::check(model, &forces, now, &scales, &mut verdict);
        verdict
    }

    /// Whether states against a law are accepted, since the user asked for what leads to them.
    fn only_marks(&self) -> bool {
        let settings = &self.state.controls.settings;
        let held =
            |node: &crate::contact::state::ContactState| matches!(node.forced, Forced::Held(_));
        self.state.unsettled > 0
            || settings.slip == SlipCount::Major
            || settings.sticking == Sticking::Increments
            || settings.ties == Ties::Printed
            || self.state.nodes.iter().any(held)
    }

    /// Gives the nodes that touched when the increment started their anchors back, for the rest of the attempt, and goes on
    /// with another major iteration.
    fn count_net_slip(&mut self) {
        let tolerance = self.state.controls.settings.tolerance;
        let near = (TIMES * tolerance).max(TOLERANCE) * self.model.length;
        let ground = Ground {
            surfaces: &self.model.surfaces,
            positions: &self.system.positions,
        };
        let start = self.state.start.clone();
        let nodes = self.state.nodes.iter_mut().zip(&start.nodes);
        for ((node, was), slave) in nodes.zip(&self.model.contacts) {
            let at = self.bench.before[slave.node];
            let touched = Judge::touched(&self.model.surfaces, slave, at, &self.bench.before, near);
            let Some(touched) = touched else { continue };
            let anchor = was.anchor.filter(|a| a.surface == touched.surface);
            (node.anchor, node.kept) = (anchor.or(Some(touched)), true);
            (node.ratio, node.travel) = (0.0, 0.0);
            ground.find_anchor(node, ground.positions[slave.node]);
            node.slip = node.drift;
        }
        self.state.net = true;
        self.state.next.major += 1;
        self.state.next.minor = 1;
        self.state.forget_trail();
        self.state.forget_rounds();
        self.linearised = false;
    }
}

/// The worst of the laws that are broken: slip before all others, since that can be repaired, and the touch of an open
/// node last, since that may be nothing.
fn worst_of(verdict: &Verdict) -> Option<Finding> {
    let rank = |finding: &Finding| match finding.law {
        Law::Slip => 2,
        Law::Touch => 0,
        _ => 1,
    };
    let worse = |a: &&Finding, b: &&Finding| {
        let by_rank = rank(a).cmp(&rank(b));
        by_rank.then(a.amount.total_cmp(&b.amount))
    };
    verdict.broken().max_by(worse).copied()
}
