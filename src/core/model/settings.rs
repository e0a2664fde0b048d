//! Options and limits of the method: which of the paper's variants is used where it offers several.

use crate::documented::documented;
use crate::words::is_default;
use serde::{Deserialize, Serialize};

documented! {
    /// Options and limits of the method.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    pub struct Settings {
        /// How the next modes are selected. Default: ladder.
        pub strategy: Strategy,
        /// How the total force on a slave node is computed after a major iteration. Default: stress.
        pub residual: ResidualMethod,
        /// The system that the minor iterations solve. Default: auto.
        pub solver: LinearSolver,
        /// How often the stiffness of the bodies is computed and factored. Default: auto.
        #[serde(skip_serializing_if = "is_default")]
        pub factor: Refactor,
        /// Whether the tangent includes the change of the contact geometry. Default: consistent.
        pub geometry: Geometry,
        /// Local deformation of a beam with a shear stiffness under the point force of a slave node. Default: exact.
        #[serde(skip_serializing_if = "is_default")]
        pub point_force: PointForce,
        /// How T_max of a sliding node enters the equations. Default: lagged.
        pub t_max: BoundUpdate,
        /// Period over which the slip in Table 2's sliding row is accumulated. Default: increment.
        pub slip: SlipCount,
        /// Reference point of a fixed node. Default: anchored.
        pub sticking: Sticking,
        /// Stick point of a node that touches within an increment. Default: auto.
        pub touch: Touch,
        /// How ties in Table 2 are resolved. Default: keep.
        pub ties: TieRule,
        /// Maximum number of minor iterations per major iteration; on the ladder, after its first strategy, at least two per contact.
        /// Default: 100.
        pub minors: u32,
        /// Maximum number of major iterations per increment. Default: 60.
        pub majors: u32,
        /// What to do after `minors` minor iterations. Default: stop.
        pub at_minor_limit: AtLimit,
        /// What to do if the minor iterations cycle. Default: stop.
        pub at_cycle: AtCycle,
        /// What to do after `majors` major iterations. Default: stop.
        pub at_major_limit: AtLimit,
        /// Relative tolerance for equilibrium, gaps and T_max. Default: 1e-11.
        pub tolerance: f64,
        /// With `history.jumps: dynamic`, accuracy of the limit load relative to the largest load factor of the path. Default:
        /// 1e-6.
        #[serde(skip_serializing_if = "is_default_limit_load")]
        pub limit_load: f64,
        /// Relative accuracy of the matrix of an interface problem that its file gives with few digits. The forces of Gauss-Seidel
        /// are accepted at this natural map where more sweeps do not improve them. Default: 0; 5e-6 for the six digits of
        /// Siconos' sparse matrices.
        #[serde(skip_serializing_if = "is_zero")]
        pub matrix_accuracy: f64,
        /// Whether the strategy `ladder` searches for other solutions where an increment fails. A number limits the factorizations
        /// that a run spends on such searches: a minor iteration counts as one, a major iteration as one more. Default: auto.
        #[serde(skip_serializing_if = "is_default", alias = "search_limit")]
        pub search: SearchBudget,
        /// How gaps before the first increment are treated. Default: keep.
        #[serde(skip_serializing_if = "is_default")]
        pub initial_gaps: InitialGaps,
        /// With `initial_gaps: adjust`, nodes with a gap up to this value are moved onto their surface too (length). Default: 0.
        #[serde(skip_serializing_if = "is_zero")]
        pub adjust_gap: f64,
        /// Memory that the scene may use, in GB. Default: the free memory.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub memory: Option<f64>,
    }
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            strategy: Strategy::default(),
            residual: ResidualMethod::default(),
            solver: LinearSolver::default(),
            factor: Refactor::default(),
            geometry: Geometry::default(),
            point_force: PointForce::default(),
            t_max: BoundUpdate::default(),
            slip: SlipCount::default(),
            sticking: Sticking::default(),
            touch: Touch::default(),
            ties: TieRule::default(),
            minors: 100,
            majors: 60,
            at_minor_limit: AtLimit::default(),
            at_cycle: AtCycle::default(),
            at_major_limit: AtLimit::default(),
            tolerance: 1e-11,
            limit_load: LIMIT_LOAD,
            matrix_accuracy: 0.0,
            search: SearchBudget::default(),
            initial_gaps: InitialGaps::default(),
            adjust_gap: 0.0,
            memory: None,
        }
    }
}

/// Default accuracy of the limit load.
const LIMIT_LOAD: f64 = 1e-6;

fn is_default_limit_load(value: &f64) -> bool {
    *value == LIMIT_LOAD
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

documented! {
    /// How the modes of the next minor iteration are selected.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum Strategy {
        /// Table 2 first. If it cycles or fails: `sliding`, `sliding_least`, `lemke`, `census`, `gauss_seidel` and `copositive`,
        /// the last two directly after `sliding` with more than 20 contacts, with T_max in the matrix. If none of them finds a
        /// consistent state, the increment is halved, down to `history.least`, and grows again afterwards.
        #[default]
        Ladder,
        /// Table 2 as printed.
        Table2,
        /// Table 2, except that a node with friction that touches starts to slide, with friction opposing its motion.
        Sliding,
        /// Table 2, one change at a time: only the first of all nodes that would change does.
        Least,
        /// `sliding`, one change at a time.
        SlidingLeast,
        /// `sliding` with all changes at once; one at a time while the number of changes does not fall.
        Block,
        /// Semismooth Newton on the projected forces; T_max is in the matrix.
        Newton,
        /// Lemke's pivoting on the linear complementarity problem of planar Coulomb friction.
        Lemke,
        /// Tries all combinations of modes; for few nodes.
        Census,
        /// Lemke's pivoting with the friction force split into two parts, starting with all nodes free. If forces that cause no
        /// motion do no work, it always ends at a solution, but the path may be long; it stops after 100 pivots per row.
        Copositive,
        /// Projected Gauss-Seidel: applies Coulomb's law at one node after the other with all other forces frozen, then solves
        /// for the resulting modes.
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
    /// What to do with gaps that exist before the first increment.
    pub choice InitialGaps {
        /// Leave them: the first increment pushes out nodes that start inside.
        #[default]
        Keep,
        /// Before the first solve, move slave nodes that start inside, or at most `adjust_gap` away, onto their surface without
        /// stress, as input decks of other codes do.
        Adjust,
        /// Press fit: slave nodes that start inside are pushed out over the first leg of the path, in proportion to the load
        /// factor.
        Ramp,
    }
}

documented! {
    /// Stick point of a node that touches within an increment.
    pub choice Touch {
        /// `ratio` if any body is a mesh; `start` if all bodies are given by matrices or springs, as in interface problems.
        #[default]
        Auto,
        /// Where the node's straight path meets the surface (ρ, eqn 14), as in the paper.
        Ratio,
        /// The projection of its position at the start of the major iteration: one step of Coulomb's law.
        Start,
    }
}

documented! {
    /// The paper's two residual methods ("Formulation of the residual force vector").
    pub choice ResidualMethod {
        /// Method 1: accumulate the interaction forces at the slave nodes over the major iterations.
        Accumulate,
        /// Method 2: the interaction force at a slave node is the nodal force of the current stresses minus the load.
        #[default]
        Stress,
    }
}

documented! {
    /// The system that the minor iterations solve; the results agree to round-off.
    pub choice LinearSolver {
        /// `condensed` if the bodies have many times more unknowns than the interface and it is cheaper, else `augmented`; the
        /// other one if only that fits into memory.
        #[default]
        Auto,
        /// The full system of bodies and interface (eqn 9), factored for every combination of modes.
        Augmented,
        /// Bodies condensed to the interface (eqn 6) once per major iteration, as in the paper. A minor iteration then costs a
        /// dense solve of the interface's size.
        Condensed,
    }
}

/// How much a run may spend on searches for other solutions where an increment fails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected auto, off, or a number of factorizations"
)]
pub enum SearchBudget {
    /// By a rule.
    Mode(SearchMode),
    /// At most this many factorizations; 0 is `auto`, as in the setting `search_limit` of earlier revisions.
    Limit(u32),
}

impl Default for SearchBudget {
    fn default() -> Self {
        SearchBudget::Mode(SearchMode::default())
    }
}

documented! {
    /// Whether to search for other solutions where an increment fails.
    pub choice SearchMode {
        /// After the strategies and the other parts of the increment: contacts near each other at the start are closed, the increment is cut
        /// below its least size, where equilibrium ends the nodes move damped to the next one, and at last parts of
        /// twice the increment are tried. The last two are marked. At most 4 times the factorizations of the rest of the run are
        /// spent, 5 times with parts of twice the increment.
        #[default]
        Auto,
        /// The increment fails.
        Off,
    }
}

documented! {
    /// How often the bodies' stiffness is taken and factored.
    pub choice Refactor {
        /// `needed` if the scene has solids and no beams and is solved `condensed`, where it mostly saves time (page `speed`); else
        /// `each`.
        #[default]
        Auto,
        /// In every major iteration, as in the paper.
        Each,
        /// Only where the old factors are too poor: after a major iteration that left more than a tenth of the out-of-balance
        /// force or of the displacement correction, and after the first one of an increment, which has the factors of the
        /// increment before, if one more would not be enough. In a hard increment (from the eighth major iteration or the second
        /// attempt on), and at the start of one if elements have a memory (`update: updated`), it is always computed. The
        /// out-of-balance force and the contact geometry are always current, so the result is the same within the tolerance;
        /// there are more major iterations, but each costs less. With `update: small` the stiffness is constant, and is factored
        /// once. Acts like `each` with `history.control: arc`, in damped motions and under a following pressure.
        Needed,
    }
}

documented! {
    /// Whether the tangent includes the change of normal, projection and gap within a major iteration.
    pub choice Geometry {
        /// It does: major iterations converge quadratically near the solution.
        #[default]
        Consistent,
        /// It does not, as in the paper: convergence is linear if nodes slide.
        Frozen,
    }
}

documented! {
    /// Local deformation of a beam with a shear stiffness GA under the point force of a slave node. Shear-rigid beams are always
    /// plain elements.
    pub choice PointForce {
        /// Beam theory: a slope jump of F_n / GA in the axis and a kink in the moment, which the element's polynomials smear out,
        /// are added in closed form (page `theory`).
        #[default]
        Exact,
        /// The slope jump of the axis only.
        Shear,
        /// Plain element, as in the paper.
        Plain,
    }
}

documented! {
    /// How T_max of a sliding node enters the equations.
    pub choice BoundUpdate {
        /// Taken from the previous minor iteration, as in the paper.
        #[default]
        Lagged,
        /// tan φ ΔF_n is in the matrix, which becomes unsymmetric; T_max does not lag.
        Consistent,
    }
}

documented! {
    /// Period over which the slip of a sliding node is accumulated.
    pub choice SlipCount {
        /// Since the last converged increment, or since the node touched.
        #[default]
        Increment,
        /// Within the current major iteration only: the literal reading of Table 2.
        Major,
    }
}

documented! {
    /// Reference point of a fixed node.
    pub choice Sticking {
        /// The surface point where it stuck: any motion away from that point is undone.
        #[default]
        Anchored,
        /// None, as in the paper: no tangential motion within a major iteration, except that slip already accumulated is undone.
        Increments,
    }
}

documented! {
    /// How ties in Table 2 are resolved.
    pub choice TieRule {
        /// Within the tolerance, a tie keeps the current mode.
        #[default]
        Keep,
        /// The inequalities as printed, without tolerance: F_n <= 0 opens.
        Printed,
    }
}

documented! {
    /// What to do when an iteration limit is reached.
    pub choice AtLimit {
        /// The increment fails.
        #[default]
        Stop,
        /// Continue with the current state, as the paper's studies do; the increment is marked.
        Accept,
    }
}

documented! {
    /// What to do when the minor iterations return to an earlier state.
    pub choice AtCycle {
        /// The increment fails.
        #[default]
        Stop,
        /// The current major iteration applies half of the increment's remaining load, then a quarter, and so on, until its minor
        /// iterations converge; the next major iteration applies the full load again. Helps with cycles caused by linearisation
        /// errors, for example if a force drops to zero. Fails if no fraction works.
        Damp,
    }
}
