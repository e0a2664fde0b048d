//! What one minor iteration did, typed.

use crate::contact::laws::Finding;
use crate::contact::record::ContactRecord;
use crate::fem::deformation::PointDeformation;
use crate::interface::method::NotFound;
use crate::interface::minor_history::Cycle;
use crate::linear::norms::Norms;
use crate::linear::singular::Singular;
use crate::linear::stability::Stability;
use crate::model::{Model, Strategy};
use crate::step::major_history::MajorCycle;
use crate::step::recovery::fallback::Fallback;
use crate::step::recovery::motion::Motion;
use crate::step::watch::StabilityLoss;
use crate::step::way::{Change, ROUNDING, farthest};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Where the solver is. All counts start at 1.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
pub struct Position {
    /// Increment.
    pub increment: u32,
    /// How often this increment was started (with another size).
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

/// What one minor iteration did.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// The minor iteration.
    pub position: Position,
    /// Load factor at the end of this increment.
    pub load_factor: f64,
    /// Arc from the start of the history to that of this increment, and where it was accepted to its end. `None` under load
    /// control.
    pub arc: Option<f64>,
    /// Drag of the damped motion of which this is a part (force by length); 0 where there is none.
    pub drag: f64,
    /// One record a slave node, in the order of the scene.
    pub nodes: Vec<ContactRecord>,
    /// Residual at the start of this major iteration, about which the minor iterations are linearised.
    pub before: Norms,
    /// An attached solver's own words; empty for a solver of our own.
    pub words: Arc<Words>,
    /// What follows from it.
    pub outcome: Outcome,
}

/// What a solver of another program reports in its own words. An empty list has no entry for any contact.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Words {
    /// The iteration as a whole, in place of its changes of modes; may be empty.
    pub iteration: String,
    /// Each contact: why it takes its next mode, or its status.
    pub contacts: Vec<String>,
    /// Status of each contact as an ASCII letter for the timeline, where it is not a mode.
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
            words: Arc::default(),
            outcome: Outcome::Minor,
        }
    }
}

impl Event {
    /// Whether a history along the path ends here at the maximum arc length, before its last corner.
    pub fn is_cut_short(&self, model: &Model) -> bool {
        let last = matches!(self.outcome, Outcome::Increment { last: true, .. });
        let bound = farthest(model) * (1.0 - ROUNDING);
        let corner = model.path.last() == Some(&self.load_factor);
        last && !corner && self.arc.is_some_and(|arc| arc >= bound)
    }
}

/// What follows.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Modes or T_max changed: another minor iteration.
    Minor,
    /// The minor iterations cycle, and the settings want this major iteration damped: it starts its minor iterations
    /// again, aiming at this load factor.
    Damped {
        /// The cycle.
        cycle: Cycle,
        /// Load factor that is aimed at.
        target: f64,
    },
    /// The strategy cannot go on, and the ladder's next one leads this major iteration from its start on.
    Climbed {
        /// What the last strategy failed of.
        why: Failure,
        /// The next strategy.
        to: Strategy,
    },
    /// The increment failed, and is started again with this size.
    Cut {
        /// What it failed of.
        why: Failure,
        /// Size of the part that is tried (load factor; along the path in what is measured).
        size: f64,
    },
    /// The halves of an increment that may jump failed: it is started again, and taken whole, which is this size.
    Leaps {
        /// What its halves failed of.
        why: Failure,
        /// Size of the whole (load factor).
        size: f64,
    },
    /// Along the path: the increment failed at a corner of it, and is started again behind that (`step::recovery::path_corner`).
    Turns {
        /// What it failed of.
        why: Failure,
        /// The contacts that take another mode there.
        changes: Arc<Vec<Change>>,
    },
    /// Sliding is held back ([`crate::step::recovery::proximal`]), and is so more from here on; the major iteration starts again.
    HeldBack {
        /// What its minor iterations failed of. `None` where they settled, and a node slid too far or against its force.
        why: Option<Failure>,
        /// Stiffness that holds sliding back from now on (force by length).
        stiffness: f64,
    },
    /// A damped motion past a limit point begins, has made a step, or makes one again.
    Moves(Moves),
    /// The halves of an increment failed: it is started again on a way round.
    Fallback {
        /// What was tried last failed of.
        why: Failure,
        /// The way that is tried now.
        by: Fallback,
        /// Size of the part that is tried (load factor).
        size: f64,
    },
    /// The minor iterations are done, but equilibrium is not reached: another major iteration.
    Major {
        /// Norms at the end of this major iteration.
        after: Norms,
        /// False if the limit of minor iterations was accepted instead.
        settled: bool,
    },
    /// The increment would be done, but the judge found that a node's net slip is against Coulomb's law: another major
    /// iteration, and from here on net slip counts.
    Refused {
        /// The law that is broken, and where.
        why: Finding,
        /// Norms at the end of this major iteration.
        after: Norms,
    },
    /// The increment is accepted.
    Increment {
        /// Norms at its end.
        after: Norms,
        /// Number of loops of minor or major iterations that ended at their limit, which was accepted.
        unsettled: u32,
        /// The law that is broken although the increment is accepted; `None` if all laws hold.
        marked: Option<Finding>,
        /// Whether the increment leaves the branch of stable equilibrium on which it started: it ends on another branch or in an
        /// unstable state.
        jumped: bool,
        /// Loss of stability: set if the end state is unstable and the start state was not known to be unstable.
        unstable: Option<StabilityLoss>,
        /// The damped motion that it ends, if any.
        motion: Option<Motion>,
        /// Worst point at which a solid leaves the range of its law in this increment. `None` if all points are inside, or if a
        /// point was outside before.
        left_range: Option<PointDeformation>,
        /// Whether the history ends here.
        last: bool,
    },
    /// The increment failed.
    Failed(Failure),
}

impl Outcome {
    /// An increment that is accepted, and what is left in it.
    pub fn accepted(after: Norms, last: bool) -> Outcome {
        Outcome::Increment {
            after,
            unsettled: 0,
            marked: None,
            jumped: false,
            unstable: None,
            motion: None,
            left_range: None,
            last,
        }
    }

    /// Whether a major iteration ends here, settled or not.
    pub fn ends_major(&self) -> bool {
        !matches!(
            self,
            Outcome::Minor
                | Outcome::Damped { .. }
                | Outcome::Climbed { .. }
                | Outcome::HeldBack { .. }
        )
    }
}

/// What a damped motion does.
#[derive(Debug, Clone, PartialEq)]
pub enum Moves {
    /// It begins: there is no equilibrium near the last one any more.
    LetsGo {
        /// What the smallest increment failed of.
        why: Failure,
        /// Load factor of the last equilibrium.
        load: f64,
    },
    /// A step of it is done.
    Step {
        /// Largest displacement in the step (length).
        motion: f64,
        /// Its number, from 1.
        number: u32,
    },
    /// A step is tried again, slower; or coming to rest was too early, and the motion goes on.
    Slower(Slow),
}

/// Why a step of a damped motion is not taken.
#[derive(Debug, Clone, PartialEq)]
pub enum Slow {
    /// It failed.
    Failed(Failure),
    /// It goes further than a step may.
    Far {
        /// Its largest displacement (length).
        motion: f64,
    },
    /// Its end is unstable, so that the motion goes elsewhere.
    Unstable,
}

/// Why an increment failed. The state is that in which it failed; stepping on from it is allowed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Failure {
    /// The minor iterations returned to a state in which they had been: they will cycle for ever.
    Cycle(Cycle),
    /// The minor iterations did not settle within their limit.
    MinorLimit {
        /// The limit.
        limit: u32,
        /// Slave numbers of the nodes that still changed in the last one.
        changing: Vec<usize>,
    },
    /// No equilibrium within the limit of major iterations.
    MajorLimit {
        /// The limit.
        limit: u32,
        /// Residual at the end, relative to the forces.
        relative: f64,
        /// Error of the interface conditions at the end (relative).
        #[serde(default)]
        interface: f64,
    },
    /// The major iterations returned to where they had been: they will cycle for ever.
    MajorCycle(MajorCycle),
    /// The equations have no unique solution.
    Singular(Singular),
    /// The round-off of the stiffest forces is too large against the loads, so that a residual says nothing.
    RoundOff {
        /// Round-off over loads, more than [`Norms::LOUDEST`].
        noise: f64,
    },
    /// Along the path: the increment would go back the way that it came.
    DoubledBack,
    /// Along the path: what is measured does not move while the load does, so that no size can be given to it; or the source
    /// cannot solve for the load factor ([`crate::linear::source::Source::follows_paths`]).
    Unmoved,
    /// The increment moved beyond what its tangent and the increments before it predict: it may have jumped to another
    /// branch of equilibrium.
    Leapt {
        /// How far it moved (length).
        motion: f64,
        /// How far it was predicted to move (length).
        predicted: f64,
        /// Kind of instability: set if the end state is unstable and the start state was not known to be unstable.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        unstable: Option<Stability>,
    },
    /// A damped motion past a limit point came to no rest.
    Restless {
        /// Steps that it made.
        steps: u32,
    },
    /// The residual or the displacements grew out of all bounds.
    Diverged {
        /// Residual relative to the forces.
        relative: f64,
    },
    /// No assumption of what the nodes do is consistent; all were tried.
    NoAnswer {
        /// What the strategy failed of that the major iteration began with. `None` if no other was tried.
        first: Option<Box<Failure>>,
        /// Number of assumptions.
        tried: usize,
    },
    /// No rung of the ladder found a consistent state, and not all assumptions could be tried.
    LadderEnded {
        /// What the strategy failed of that the major iteration began with.
        first: Box<Failure>,
        /// What the last rung failed of.
        last: Box<Failure>,
        /// Whether the increment was not cut, since at any part of its load the problem is the same.
        #[serde(default)]
        scales: bool,
    },
    /// Pivoting, or the census, found no consistent state, which does not prove that there is none.
    NotFound(NotFound),
    /// Converged, but against a law of contact or balance.
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
    /// An attached solver said so.
    Reported {
        /// Its words; may be empty.
        reason: String,
        /// Residual at the end, relative to the forces, where it said that.
        #[serde(default)]
        relative: Option<f64>,
    },
}

impl Failure {
    /// Slave node that caused the failure, the first if there are several. `None` if the failure is not due to a slave node.
    pub fn culprit(&self) -> Option<usize> {
        match self {
            Failure::Cycle(cycle) => cycle.members.first().map(|(slave, _)| *slave),
            Failure::MajorCycle(cycle) => cycle.members.first().map(|(slave, _)| *slave),
            Failure::MinorLimit { changing, .. } => changing.first().copied(),
            Failure::Refused(found) => found.slave,
            Failure::CutTooOften { slave, .. } | Failure::OverConstrained { slave, .. } => {
                Some(*slave)
            }
            Failure::LadderEnded { last, .. } => last.culprit(),
            _ => None,
        }
    }
}
