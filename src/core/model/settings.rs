//! Choices of the method and its limits: which of the paper's variants is used where it leaves a choice.

use super::documented::documented;
use serde::{Deserialize, Serialize};

documented! {
    /// Choices of the method, and its limits.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    pub struct Settings {
        /// How the next modes are chosen. Default: ladder.
        pub strategy: Strategy,
        /// How the total force of a slave node is found after a major iteration. Default: stress.
        pub residual: ResidualMethod,
        /// What the minor iterations solve. Default: auto.
        pub solver: Solver,
        /// How often the bodies' stiffness is taken and factored. Default: each.
        #[serde(skip_serializing_if = "Refactor::is_default")]
        pub factor: Refactor,
        /// Whether the tangent knows that the contact geometry changes. Default: consistent.
        pub geometry: Geometry,
        /// What a beam with a shear stiffness gives where a slave node presses on it. Default: exact.
        #[serde(skip_serializing_if = "PointForce::is_default")]
        pub point_force: PointForce,
        /// How the sliding node's T_max enters the equations. Default: lagged.
        pub t_max: BoundUpdate,
        /// Over what the slip of Table 2's sliding row is counted. Default: increment.
        pub slip: SlipCount,
        /// What a fixed node holds on to. Default: anchored.
        pub sticking: Sticking,
        /// Where a node is held that touches within an increment. Default: auto.
        pub touch: Touch,
        /// What a tie in Table 2 does. Default: keep.
        pub ties: Ties,
        /// Most minor iterations in a major one. Default: 100.
        pub minors: u32,
        /// Most major iterations in an increment. Default: 60.
        pub majors: u32,
        /// What happens when `minors` are used up. Default: stop.
        pub at_minor_limit: AtLimit,
        /// What happens when the minor iterations cycle. Default: stop.
        pub at_cycle: AtCycle,
        /// What happens when `majors` are used up. Default: stop.
        pub at_major_limit: AtLimit,
        /// Relative tolerance of equilibrium, gap, and T_max. Default: 1e-11.
        pub tolerance: f64,
        /// With `history.jumps: dynamic`, the load at which equilibrium ends is found to this part of the path's largest load
        /// factor. Default: 1e-6.
        #[serde(skip_serializing_if = "is_default_limit_load")]
        pub limit_load: f64,
        /// Whether the strategy `ladder` searches for a way out where an increment fails. Default: auto.
        #[serde(skip_serializing_if = "Search::is_default")]
        pub search: Search,
        /// Maximum number of factorizations that a run spends on such searches. Default: 5000.
        #[serde(skip_serializing_if = "is_default_search_limit")]
        pub search_limit: u32,
        /// What becomes of gaps that are there before the first increment. Default: keep.
        #[serde(skip_serializing_if = "InitialGaps::is_default")]
        pub initial_gaps: InitialGaps,
        /// With `initial_gaps: adjust`, nodes with a gap of at most this are moved onto their surface, too (length). Default: 0.
        #[serde(skip_serializing_if = "is_zero")]
        pub adjust_gap: f64,
        /// Memory that the scene may take, in GB. Default: what is free.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub memory: Option<f64>,
    }
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            strategy: Strategy::default(),
            residual: ResidualMethod::default(),
            solver: Solver::default(),
            factor: Refactor::default(),
            geometry: Geometry::default(),
            point_force: PointForce::default(),
            t_max: BoundUpdate::default(),
            slip: SlipCount::default(),
            sticking: Sticking::default(),
            touch: Touch::default(),
            ties: Ties::default(),
            minors: 100,
            majors: 60,
            at_minor_limit: AtLimit::default(),
            at_cycle: AtCycle::default(),
            at_major_limit: AtLimit::default(),
            tolerance: 1e-11,
            limit_load: LIMIT_LOAD,
            search: Search::default(),
            search_limit: SEARCH_LIMIT,
            initial_gaps: InitialGaps::default(),
            adjust_gap: 0.0,
            memory: None,
        }
    }
}

/// How exactly the load at which equilibrium ends is found, unless the scene says otherwise.
const LIMIT_LOAD: f64 = 1e-6;

fn is_default_limit_load(value: &f64) -> bool {
    *value == LIMIT_LOAD
}

/// Maximum number of factorizations of searches, unless the scene sets it.
const SEARCH_LIMIT: u32 = 5000;

fn is_default_search_limit(value: &u32) -> bool {
    *value == SEARCH_LIMIT
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

documented! {
    /// How the modes of the next minor iteration are chosen, as README's list of strategies says.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum Strategy {
        /// Table 2 first; if it cycles or cannot go on, then `sliding`, `sliding_least`, `lemke`, `census`, `gauss_seidel`
        /// and `copositive`, the last two right after `sliding` with more than 20 contacts, with T_max in the matrix. If none of them finds a consistent state, the increment is halved, down to
        /// `history.least`, and grows again afterwards.
        #[default]
        Ladder,
        /// Table 2 as printed.
        Table2,
        /// Table 2, but a rough node that touches enters sliding, against its travel.
        Sliding,
        /// Table 2, one change at a time: of all nodes that would change, only the first does.
        Least,
        /// `sliding`, one change at a time.
        SlidingLeast,
        /// `sliding`, all changes at once; one at a time while their number does not fall.
        Block,
        /// Semismooth Newton on the projections of the forces; T_max stands in the matrix.
        Newton,
        /// Lemke's pivoting on the linear complementarity problem of Coulomb's law in the plane.
        Lemke,
        /// All assumptions of what the nodes do, tried; for few nodes.
        Census,
        /// Lemke's pivoting with the friction force in two parts, from all nodes free. Wherever forces that move nothing take
        /// no energy, its path ends in an answer, however long it is; it is given up after 100 pivots per row.
        Copositive,
        /// Projected Gauss-Seidel: Coulomb's law at one node after the other, the forces of all others held, and then a solve
        /// for the modes that this comes to.
        GaussSeidel,
    }
}

crate::words! {
    Strategy, ALL, name:
    Ladder "ladder",
    Table2 "table2",
    Sliding "sliding",
    Least "least",
    SlidingLeast "sliding_least",
    Block "block",
    Newton "newton",
    Lemke "lemke",
    Census "census",
    Copositive "copositive",
    GaussSeidel "gauss_seidel",
}

documented! {
    /// What becomes of gaps that are there before the first increment.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum InitialGaps {
        /// They are what they are: a node that starts inside is pushed out by the first increment.
        #[default]
        Keep,
        /// Slave nodes that start inside, or up to `adjust_gap` away, are moved onto their surface before anything is
        /// solved, without stress, as decks of other codes do.
        Adjust,
        /// Slave nodes that start inside stay there, and are pushed out over the first leg of the path, in proportion to the
        /// load factor: a press fit.
        Ramp,
    }
}

impl InitialGaps {
    /// Whether it is what a scene that does not name it has.
    pub fn is_default(&self) -> bool {
        *self == InitialGaps::default()
    }
}

documented! {
    /// Where a node is held that touches within an increment.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Touch {
        /// `ratio` where a body is a mesh; `start` where all are given by numbers, as interface problems are posed.
        #[default]
        Auto,
        /// Where its straight way meets the surface (ρ, eqn 14), as in the paper.
        Ratio,
        /// At the foot of where it was when the major iteration started: one step of Coulomb's law.
        Start,
    }
}

documented! {
    /// The paper's two residual methods ("Formulation of the residual force vector").
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum ResidualMethod {
        /// Method 1: interaction forces at the slave nodes are accumulated over the major iterations.
        Accumulate,
        /// Method 2: the interaction force at a slave node is the nodal force of the current stresses less the load.
        #[default]
        Stress,
    }
}

documented! {
    /// What the minor iterations solve; all give the same to round-off.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Solver {
        /// Condensed where the bodies have many times more unknowns than the interface and their displacements there are few
        /// enough for it to be cheaper, else augmented; the other one where only that fits the memory.
        #[default]
        Auto,
        /// The whole system of bodies and interface (eqn 9), factored anew for every assumption of modes.
        Augmented,
        /// The bodies condensed to the interface (eqn 6) once a major iteration, as in the paper; a minor iteration then
        /// costs a dense solve of the size of the interface.
        Condensed,
    }
}

documented! {
    /// Whether to search for a way out where an increment fails.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Search {
        /// After the strategies and the other parts of the increment: nodes that touch at the start are held, the increment is cut
        /// below its least size, and where equilibrium ends the nodes move damped to the next one, which is marked.
        #[default]
        Auto,
        /// The increment fails.
        Off,
    }
}

impl Search {
    /// Whether it is the default.
    pub fn is_default(&self) -> bool {
        *self == Search::default()
    }
}

documented! {
    /// How often the bodies' stiffness is taken and factored.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Refactor {
        /// In each major iteration, as in the paper.
        #[default]
        Each,
        /// In the first of an increment, and where the out-of-balance force or the correction of the displacements fell by less
        /// than ten times. That force is always the true one and the interface's geometry that of the major iteration, so that
        /// the answers are the same within the tolerance; there are more major iterations, and they cost less. With `history.control: arc`, in
        /// damped motions and under a following pressure as `each`.
        Needed,
    }
}

impl Refactor {
    /// Whether it is what a scene that does not name it has.
    pub fn is_default(&self) -> bool {
        *self == Refactor::default()
    }
}

documented! {
    /// Whether the change of normal, projection and gap stands in the tangent of a major iteration.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Geometry {
        /// It does: major iterations converge quadratically at the end.
        #[default]
        Consistent,
        /// It does not, as in the paper: they converge linearly where nodes slide.
        Frozen,
    }
}

documented! {
    /// What a beam with a shear stiffness GA gives where a slave node presses on it. Shear-rigid beams are the plain elements
    /// always.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum PointForce {
        /// What the beam theory says: a kink of F_n / GA in its line and a kink in its moment, which the element's polynomials
        /// smear, are put back in closed form (page `theory`).
        #[default]
        Exact,
        /// The kink in the line alone.
        Shear,
        /// The plain element, as in the paper.
        Plain,
    }
}

impl PointForce {
    /// Whether the value is the default, which scenes omit.
    pub fn is_default(&self) -> bool {
        *self == PointForce::default()
    }
}

documented! {
    /// How T_max enters the equations of a sliding node.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum BoundUpdate {
        /// From the previous minor iteration, as in the paper.
        #[default]
        Lagged,
        /// tan φ ΔF_n stands in the matrix (unsymmetric); no lag.
        Consistent,
    }
}

documented! {
    /// Over what the slip of a sliding node is counted.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum SlipCount {
        /// Since the last converged increment, or since touch.
        #[default]
        Increment,
        /// Over the present major iteration only: the literal reading of Table 2.
        Major,
    }
}

documented! {
    /// What a fixed node holds on to.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Sticking {
        /// To the point of the surface where it stuck, which it remembers: what it has gone from there, it takes back.
        #[default]
        Anchored,
        /// To nothing, as in the paper: no tangential motion in a major iteration, but that the slip counted is taken back.
        Increments,
    }
}

documented! {
    /// What a tie in Table 2 does.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Ties {
        /// A tie, within the tolerance, keeps the mode that the node has.
        #[default]
        Keep,
        /// The inequalities as printed, without a tolerance: F_n <= 0 opens.
        Printed,
    }
}

documented! {
    /// What happens when a limit of iterations is reached.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum AtLimit {
        /// The increment fails.
        #[default]
        Stop,
        /// Go on with what there is, as the paper's studies do; the increment is marked.
        Accept,
    }
}

documented! {
    /// What happens when the minor iterations return to where they had been.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum AtCycle {
        /// The increment fails.
        #[default]
        Stop,
        /// Aim the present major iteration at half the load that is left of the increment, and at half of that again,
        /// until its minor iterations settle; the next major iteration aims at the whole again. For cycles that the
        /// error of the linearisation makes, as where a force goes to zero. Fails where no part can be taken.
        Damp,
    }
}
