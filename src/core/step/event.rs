//! Typed record of one minor iteration.

use crate::contact::projection::tangent;
use crate::step::arc_state::{Change, ROUNDING, farthest};
use crate::{
    ContactRecord, Cycle, Fallback, Finding, MajorCycle, Model, Motion, Norms, NotFound,
    PointDeformation, Singular, Stability, StabilityLoss, Strategy,
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Position of the solver. All counts start at 1.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
pub struct Position {
    /// Increment.
    pub increment: u32,
    /// Number of the attempt at this increment, each with another size.
    #[serde(default = "one")]
    pub attempt: u32,
    /// Major iteration of the attempt.
    #[serde(default = "one")]
    pub major: u32,
    /// Minor iteration of the major one.
    #[serde(default = "one")]
    pub minor: u32,
}

fn one() -> u32 {
    1
}

/// Record of one minor iteration.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// Position of the minor iteration.
    pub position: Position,
    /// Load factor at the end of this increment.
    pub load_factor: f64,
    /// Arc length from the start of the history to the start of this increment, or to its end once it is accepted. `None` under
    /// load control.
    pub arc: Option<f64>,
    /// Drag of the damped motion that this step belongs to (force per length); 0 if there is none.
    pub drag: f64,
    /// One record per slave node, in the order of the scene.
    pub nodes: Vec<ContactRecord>,
    /// Residual at the start of this major iteration, where the minor iterations are linearised.
    pub before: Norms,
    /// In space, the frame (n, t) at each contact; empty in the plane.
    pub frames: Arc<Vec<Frame>>,
    /// Texts of an attached solver; empty for the built-in solver.
    pub words: Arc<Words>,
    /// Result of the iteration.
    pub outcome: Outcome,
}

/// Outward normal n and tangent t at a contact in space, both of length 1.
pub type Frame = [[f64; 3]; 2];

/// The second tangent n × t of a frame.
fn second_tangent(&[n, t]: &Frame) -> [f64; 3] {
    [
        n[1] * t[2] - n[2] * t[1],
        n[2] * t[0] - n[0] * t[2],
        n[0] * t[1] - n[1] * t[0],
    ]
}

/// Texts reported by an attached solver. An empty list has no entry for any contact.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Words {
    /// The iteration as a whole, shown instead of its mode changes; may be empty.
    pub iteration: String,
    /// For each contact: its status, or why it takes its next mode.
    pub contacts: Vec<String>,
    /// Status of each contact as an ASCII letter for the timeline, if it is not a mode.
    pub letters: Vec<u8>,
}

impl Event {
    /// The event before the first one.
    pub fn nothing_yet(model: &Model) -> Event {
        Event {
            position: Position::default(),
            load_factor: 0.0,
            arc: None,
            drag: 0.0,
            nodes: Vec::with_capacity(model.contacts.len()),
            before: Norms::default(),
            frames: Arc::default(),
            words: Arc::default(),
            outcome: Outcome::Minor,
        }
    }

    /// The contact force on a slave node along the axes; z is 0 in the plane. `None` without a record.
    pub fn force(&self, slave: usize) -> Option<[f64; 3]> {
        let found = self.nodes.get(slave)?;
        Some(match (self.frames.get(slave), found.shear()) {
            (Some(frame), Some([f_1, f_2])) => {
                let ([n, t], b) = (frame, second_tangent(frame));
                [0, 1, 2].map(|k| found.f_n * n[k] + f_1 * t[k] + f_2 * b[k])
            }
            _ => {
                let (n, t) = (found.normal, tangent(found.normal));
                let [x, y] = [0, 1].map(|axis| found.f_n * n[axis] + found.f_t * t[axis]);
                [x, y, 0.0]
            }
        })
    }

    /// Contacts whose mode changed, or whose T_max changed by more than `force`.
    pub(super) fn changing(&self, force: f64) -> Vec<usize> {
        let moves =
            |r: &ContactRecord| r.decision.changes() || (r.t_max - r.t_max_used).abs() > force;
        self.nodes
            .iter()
            .enumerate()
            .filter(|(_, r)| moves(r))
            .map(|(s, _)| s)
            .collect()
    }
}

impl Event {
    /// Whether a history along the path ends here because of the maximum arc length, before its last corner.
    pub fn is_cut_short(&self, model: &Model) -> bool {
        let last = matches!(self.outcome, Outcome::Increment { last: true, .. });
        let bound = farthest(model) * (1.0 - ROUNDING);
        let corner = model.path.last() == Some(&self.load_factor);
        last && !corner && self.arc.is_some_and(|arc| arc >= bound)
    }
}

/// Result of a minor iteration.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Modes or T_max changed: another minor iteration follows.
    Minor,
    /// The minor iterations cycle, and the settings damp this major iteration: its minor iterations restart with this load factor
    /// as their target.
    Damped {
        /// The cycle.
        cycle: Cycle,
        /// Target load factor.
        target: f64,
    },
    /// The strategy cannot continue; the next strategy of the ladder restarts this major iteration.
    StrategyChange {
        /// Why the previous strategy failed.
        why: Failure,
        /// The next strategy.
        to: Strategy,
        /// Whether the tangent of this major iteration omits the change of the contact geometry.
        frozen: bool,
    },
    /// The increment failed and is restarted with this size.
    Cut {
        /// Cause of the failure.
        why: Failure,
        /// Size of the part that is tried (load factor; along the path, in the measured quantity).
        size: f64,
    },
    /// The halves of an increment that may jump failed: the whole increment is taken, which has this size.
    WholeIncrement {
        /// Why its halves failed.
        why: Failure,
        /// Size of the whole (load factor).
        size: f64,
    },
    /// Along the path: the increment failed at a corner of the path and is restarted behind it (`step::recovery::path_corner`).
    PathCorner {
        /// Cause of the failure.
        why: Failure,
        /// Contacts that take another mode there.
        changes: Arc<Vec<Change>>,
    },
    /// Sliding is held back ([`crate::step::recovery::proximal`]), more strongly from here on; the major iteration restarts.
    HeldBack {
        /// Why its minor iterations failed. `None` if they converged, and a node slid too far or against its force.
        why: Option<Failure>,
        /// Stiffness that holds sliding back from now on (force per length).
        stiffness: f64,
    },
    /// A damped motion past a limit point begins, has completed a step, or repeats one.
    Motion(MotionEvent),
    /// The halves of an increment failed: it is restarted with a fallback.
    Fallback {
        /// Why the last attempt failed.
        why: Failure,
        /// Fallback that is tried now.
        by: Fallback,
        /// Size of the part that is tried (load factor).
        size: f64,
    },
    /// The minor iterations converged, but equilibrium is not reached: another major iteration follows.
    Major {
        /// Norms at the end of this major iteration.
        after: Norms,
        /// False if the limit of minor iterations was reached and accepted instead.
        settled: bool,
    },
    /// The increment would be accepted, but the judge found that a node's net slip violates Coulomb's law: another major
    /// iteration follows, and net slip counts from here on.
    Refused {
        /// Law that is violated, and where.
        why: Finding,
        /// Norms at the end of this major iteration.
        after: Norms,
    },
    /// The increment is accepted.
    Increment {
        /// Norms at its end.
        after: Norms,
        /// Number of loops of minor or major iterations whose limit was reached and accepted.
        unsettled: u32,
        /// Law that is violated although the increment is accepted; `None` if all laws hold.
        marked: Option<Finding>,
        /// Whether the increment leaves the branch of stable equilibrium on which it started: it ends on another branch or in an
        /// unstable state.
        jumped: bool,
        /// Loss of stability: set if the end state is unstable and the start state was not known to be unstable.
        unstable: Option<StabilityLoss>,
        /// The damped motion that it completes, if any.
        motion: Option<Motion>,
        /// The fallback with which it was found. `None` without one.
        found: Option<Fallback>,
        /// Worst point at which a solid leaves the range of its law in this increment. `None` if all points are inside, or if a
        /// point was outside before.
        left_range: Option<PointDeformation>,
        /// Smallest principal stretch at the integration points of solids. `None` without solids in the plane, and from attached
        /// solvers.
        stretch: Option<f64>,
        /// Whether the history ends here.
        last: bool,
    },
    /// The increment failed.
    Failed(Failure),
}

impl Outcome {
    /// An accepted increment without reservations.
    pub fn accepted(after: Norms, last: bool) -> Outcome {
        Outcome::Increment {
            after,
            unsettled: 0,
            marked: None,
            jumped: false,
            unstable: None,
            motion: None,
            found: None,
            left_range: None,
            stretch: None,
            last,
        }
    }

    /// Whether the increment is accepted.
    pub fn is_accepted(&self) -> bool {
        matches!(self, Outcome::Increment { .. })
    }

    /// Whether a major iteration ends here, converged or not.
    pub fn ends_major(&self) -> bool {
        !matches!(
            self,
            Outcome::Minor
                | Outcome::Damped { .. }
                | Outcome::StrategyChange { .. }
                | Outcome::HeldBack { .. }
        )
    }
}

/// Progress of a damped motion.
#[derive(Debug, Clone, PartialEq)]
pub enum MotionEvent {
    /// It begins: there is no longer an equilibrium near the last one.
    DynamicStart {
        /// Why the smallest increment failed.
        why: Failure,
        /// Load factor of the last equilibrium.
        load: f64,
    },
    /// A step is completed.
    Step {
        /// Largest displacement in the step (length).
        motion: f64,
        /// Step number, from 1.
        number: u32,
    },
    /// A step is repeated more slowly, or an attempt at rest was premature and the motion continues.
    Slower(SmallerStepReason),
}

/// Why a step of a damped motion is rejected.
#[derive(Debug, Clone, PartialEq)]
pub enum SmallerStepReason {
    /// It failed.
    Failed(Failure),
    /// It moves further than a step may.
    Far {
        /// Its largest displacement (length).
        motion: f64,
    },
    /// Its end is unstable, so it does not follow the motion.
    Unstable,
}

/// Why an increment failed. The state is the failed one; stepping may continue from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Failure {
    /// The minor iterations returned to an earlier state: they repeat endlessly.
    Cycle(Cycle),
    /// The minor iterations did not converge within their limit.
    MinorLimit {
        /// The limit.
        limit: u32,
        /// Slave numbers of the nodes that still changed in the last iteration.
        changing: Vec<usize>,
    },
    /// No equilibrium was found within the limit of major iterations.
    MajorLimit {
        /// The limit.
        limit: u32,
        /// Residual at the end, relative to the forces.
        relative: f64,
        /// Error of the interface conditions at the end (relative).
        #[serde(default)]
        interface: f64,
    },
    /// The major iterations returned to an earlier state: they repeat endlessly.
    MajorCycle(MajorCycle),
    /// The equations have no unique solution.
    Singular(Singular),
    /// The round-off of the stiffest forces is too large relative to the loads: the residual is meaningless.
    RoundOff {
        /// Round-off over loads, more than [`Norms::LOUDEST`].
        noise: f64,
    },
    /// Along the path: the increment would return along the path that it came from.
    #[serde(rename = "DoubledBack")]
    PathReversal,
    /// Along the path: the measured quantity does not change while the load does, so that no step size can be defined; or the
    /// source cannot solve for the load factor ([`crate::linear::source::Source::follows_paths`]).
    #[serde(rename = "Unmoved")]
    ZeroMeasure,
    /// The increment moved further than its tangent and the previous increments predict: it may have jumped to another branch of
    /// equilibrium.
    #[serde(rename = "Leapt")]
    BranchJump {
        /// Motion (length).
        motion: f64,
        /// Predicted motion (length).
        predicted: f64,
        /// Kind of instability: set if the end state is unstable and the start state was not known to be unstable.
        #[serde(skip_serializing_if = "Option::is_none")]
        unstable: Option<Stability>,
    },
    /// A damped motion past a limit point does not end at rest.
    #[serde(rename = "Restless")]
    NoRest {
        /// Number of steps.
        steps: u32,
    },
    /// The residual or the displacements grew without bound.
    Diverged {
        /// Residual relative to the forces.
        relative: f64,
    },
    /// No combination of modes is consistent; all were tried.
    NoAnswer {
        /// Why the first strategy of the major iteration failed. `None` if no other was tried.
        first: Option<Box<Failure>>,
        /// Number of combinations.
        tried: usize,
    },
    /// No strategy of the ladder found a consistent state, and not all combinations could be tried.
    LadderEnded {
        /// Why the first strategy of the major iteration failed.
        first: Box<Failure>,
        /// Why the last strategy failed.
        last: Box<Failure>,
        /// Whether the increment was not cut because the problem is the same at any part of its load.
        #[serde(default)]
        scales: bool,
    },
    /// Pivoting or the census found no consistent state, which does not prove that none exists.
    NotFound(NotFound),
    /// Converged, but a law of contact or balance is violated.
    Refused(Finding),
    /// An element of a solid is inverted: det F is not positive at one of its points.
    Inverted(PointDeformation),
    /// The increment was cut repeatedly because of the same slave node, whose state does not depend on the increment size.
    CutTooOften {
        /// Slave number.
        slave: usize,
        /// Number of cuts because of this node.
        cuts: u32,
        /// Cause of the last failure.
        last: Box<Failure>,
    },
    /// Neither a touching node nor its master can move to close the gap.
    #[serde(rename = "Jammed")]
    OverConstrained {
        /// Slave number.
        slave: usize,
        /// Gap that stays (length).
        gap: f64,
    },
    /// Failure reported by an attached solver.
    Reported {
        /// Text from the solver; may be empty.
        reason: String,
        /// Residual at the end, relative to the forces, if the solver reported it.
        relative: Option<f64>,
    },
}

impl Failure {
    /// Slave node that caused the failure, the first if there are several. `None` if the failure is not due to a slave node.
    pub fn culprit(&self) -> Option<usize> {
        match self {
            Failure::Cycle(cycle) => cycle.members.first().map(|(slave, _)| *slave),
            Failure::MajorCycle(cycle) => cycle.changing().next().map(|(slave, _)| *slave),
            Failure::MinorLimit { changing, .. } => changing.first().copied(),
            Failure::Refused(found) => found.slave,
            Failure::CutTooOften { slave, .. } | Failure::OverConstrained { slave, .. } => {
                Some(*slave)
            }
            Failure::LadderEnded { first, last, .. } => last.culprit().or_else(|| first.culprit()),
            _ => None,
        }
    }
}
