//! What one minor iteration did, typed.

use crate::contact::decision::Decision;
use crate::contact::judge::Finding;
use crate::contact::projection::Spot;
use crate::scene::Mode;
use crate::scene::spec::Strategy;
use crate::solve::rounds::Round;
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
    pub nodes: Vec<NodeRecord>,
    /// Residual at the start of this major iteration, about which the minor iterations are linearised.
    pub before: Norms,
    pub outcome: Outcome,
}

/// What a minor iteration found at one slave node. Forces are totals, on the slave node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeRecord {
    /// Table 2's verdict, with the numbers that it compared. `decision.before` is the mode of this solve and
    /// `decision.next` the mode that the next one takes.
    pub decision: Decision,
    /// Whether the mode of this solve, or the next, was forced by the user.
    pub forced: Forced,
    /// Gap after this solve, on the frozen geometry; negative is penetration.
    pub gap: f64,
    /// Normal force; compression positive.
    pub f_n: f64,
    /// Tangential force along t (n turned 90 degrees anticlockwise).
    pub f_t: f64,
    /// Largest tangential force that friction can give, with the sign that it would have (eqn 20), from this solve.
    pub t_max: f64,
    /// T_max that this solve was made with (the lagged one); equal to `t_max` where it has settled.
    pub t_max_used: f64,
    /// Slip u_tS* − u_tS, as the settings count it.
    pub slip: f64,
    /// How far it is from where it stuck, along the surface and with the sign of slip; 0 while it is free.
    pub drift: f64,
    /// Where S* lies; none past the ends of all surfaces.
    pub spot: Option<Spot>,
    /// Outward normal n at S*.
    pub normal: [f64; 2],
    /// Position of S* at the start of this major iteration.
    pub foot: [f64; 2],
    /// A force component was left to the support, since nothing else in its equation could move (normal, tangential).
    pub carried: [bool; 2],
}

/// How the user stands behind a node's mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Forced {
    #[default]
    No,
    /// Forced for one minor iteration.
    Once(Mode),
    /// Forced until released.
    Held(Mode),
}

/// Sizes of what is not yet in balance; relative ones against the scene's own scales.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Norms {
    /// Largest out-of-balance force (a moment over the scene's length counts as a force), in force.
    pub force: f64,
    /// The same over the force scale.
    pub relative: f64,
    /// Largest violation of the interface conditions, relative: gaps of touching nodes and penetration of free
    /// ones, and drift of fixed ones where they are anchored, over the length scale; force on free nodes and |F_t − T_max| of sliding ones over the force scale.
    pub interface: f64,
    /// Largest displacement change in the last major iteration over the length scale; 0 before the first.
    pub correction: f64,
    /// The force scale.
    pub scale: f64,
    /// What `relative` must not exceed to be in balance: the tolerance, or the round-off of the stiffest forces
    /// where that is larger.
    pub limit: f64,
    /// Round-off of the stiffest forces over the loads and contact forces: what part of these is not known. Also of
    /// lengths that are to vanish, over the length scale.
    #[serde(default)]
    pub noise: f64,
}

impl Norms {
    /// Noise above which no answer is accepted.
    pub const LOUDEST: f64 = 1e-2;
    /// Noise from which on a run says what accuracy is left.
    pub const AUDIBLE: f64 = 1e-6;
}

/// What follows.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Modes or T_max changed: another minor iteration.
    Minor,
    /// The minor iterations cycle, and the settings want this major iteration damped: it starts its minor iterations
    /// again, aiming at this load factor.
    Damped { cycle: Cycle, aim: f64 },
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
    MajorCycle(Round),
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
    Jammed { slave: usize, gap: f64 },
}

/// Why pivoting, or the census, found nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotFound {
    /// Pivoting ended on a ray, from every start.
    Ray,
    /// The equations of every start of pivoting are singular.
    NoStart,
    /// So many nodes can touch that their assumptions are too many to try.
    TooMany { nodes: usize },
    /// The equations of the nodes that cannot touch are singular.
    Loose,
    /// The bodies cannot be condensed to the interface.
    NotCondensed,
    /// So many states were found, and the minor iteration that checked each did not confirm it.
    Unconfirmed { states: usize },
}

/// A true cycle of minor iterations: same modes, same numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// Minor iteration from which on it repeats.
    pub start: u32,
    /// Number of minor iterations after which it repeats.
    pub period: u32,
    /// Slave nodes (by slave number) that change in it, with the modes that each takes over one period.
    pub members: Vec<(usize, Vec<Mode>)>,
}

/// A singular system.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Singular {
    /// Nothing holds a body against a rigid motion.
    Rigid { motions: Vec<RigidMotion> },
    /// No rigid motion explains it: a limit point, a bifurcation, or dependent constraints.
    Unexplained,
}

/// A rigid motion that meets no resistance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RigidMotion {
    pub body: String,
    pub motion: Motion,
}

/// A rigid motion of the plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Motion {
    /// Along this unit vector.
    Translation([f64; 2]),
    /// About this point.
    Rotation([f64; 2]),
}
