//! What one minor iteration did, typed.

use crate::contact::judge::Finding;
use crate::contact::record::ContactRecord;
use crate::interface::method::NotFound;
use crate::interface::minor_history::Cycle;
use crate::linear::norms::Norms;
use crate::linear::singular::Singular;
use crate::model::Strategy;
use crate::step::major_history::MajorCycle;
use serde::{Deserialize, Serialize};

/// Where the solver is. All counts start at 1.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
pub struct Position {
    pub increment: u32,
    /// How often this increment was started (with another size).
    pub attempt: u32,
    pub major: u32,
    pub minor: u32,
}

/// What one minor iteration did.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    pub position: Position,
    /// Load factor at the end of this increment.
    pub load_factor: f64,
    /// One record a slave node, in the order of the scene.
    pub nodes: Vec<ContactRecord>,
    /// Residual at the start of this major iteration, about which the minor iterations are linearised.
    pub before: Norms,
    pub outcome: Outcome,
}

/// What follows.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Modes or T_max changed: another minor iteration.
    Minor,
    /// The minor iterations cycle, and the settings want this major iteration damped: it starts its minor iterations
    /// again, aiming at this load factor.
    Damped { cycle: Cycle, target: f64 },
    /// The strategy cannot go on, and the ladder's next one leads this major iteration from its start on.
    Climbed { why: Failure, to: Strategy },
    /// The increment failed, and is started again with this size.
    Cut { why: Failure, size: f64 },
    /// The halves of an increment that may jump failed: it is started again, and taken whole, which is this size.
    Leaps { why: Failure, size: f64 },
    /// The minor iterations are done, but equilibrium is not reached: another major iteration. `settled` is false
    /// where the limit of minor iterations was accepted.
    Major { after: Norms, settled: bool },
    /// The increment would be done, but the judge found that a node's net slip is against Coulomb's law: another major
    /// iteration, and from here on net slip counts.
    Refused { why: Finding, after: Norms },
    /// The increment is accepted. `unsettled` counts minor loops and majors whose limits were accepted instead of
    /// reached; `marked` is what the judge found against a law, where it was accepted all the same; `jumped` says that it
    /// ends on another branch of equilibrium; `last` says that the history ends here.
    Increment {
        after: Norms,
        unsettled: u32,
        marked: Option<Finding>,
        jumped: bool,
        last: bool,
    },
    /// The increment failed.
    Failed(Failure),
}

impl Outcome {
    /// Whether a major iteration ends here, settled or not.
    pub fn ends_major(&self) -> bool {
        !matches!(
            self,
            Outcome::Minor | Outcome::Damped { .. } | Outcome::Climbed { .. }
        )
    }
}

/// Why an increment failed. The state is that in which it failed; stepping on from it is allowed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Failure {
    /// The minor iterations returned to a state in which they had been: they will cycle for ever.
    Cycle(Cycle),
    /// The minor iterations did not settle within their limit; nodes that still changed in the last one.
    MinorLimit { limit: u32, changing: Vec<usize> },
    /// No equilibrium within the limit of major iterations.
    MajorLimit {
        limit: u32,
        relative: f64,
        #[serde(default)]
        interface: f64,
    },
    /// The major iterations returned to where they had been: they will cycle for ever.
    MajorCycle(MajorCycle),
    /// The equations have no unique solution.
    Singular(Singular),
    /// The round-off of the stiffest forces is this part of the loads: more than [`Norms::LOUDEST`], so that no residual
    /// tells an answer from none.
    RoundOff { noise: f64 },
    /// The increment moved beyond what its tangent and the increments before it predict: it may have jumped to another
    /// branch of equilibrium.
    Leapt { motion: f64, predicted: f64 },
    /// The residual or the displacements grew out of all bounds.
    Diverged { relative: f64 },
    /// No assumption of what the nodes do is consistent: all were tried. `first` is what Table 2 failed of before, where it
    /// led.
    NoAnswer {
        first: Option<Box<Failure>>,
        tried: usize,
    },
    /// Nothing on the ladder found a consistent state, though not everything could be tried: what Table 2 failed of, and
    /// the last rung.
    LadderEnded {
        first: Box<Failure>,
        last: Box<Failure>,
    },
    /// Pivoting, or the census, found no consistent state, which does not prove that there is none.
    NotFound(NotFound),
    /// Converged, but against a law of contact or balance.
    Refused(Finding),
    /// A touching node and its master can neither of them move to close the gap (slave number).
    #[serde(rename = "Jammed")]
    OverConstrained { slave: usize, gap: f64 },
}
