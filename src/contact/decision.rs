//! Table 2: which mode a slave node takes next, and why.

use crate::scene::Mode;
use serde::{Deserialize, Serialize};

/// The cell of Table 2 that fired (row: mode before; column: mode after).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// F_n > 0 and |F_t| < |T_max|.
    FixedStays,
    /// F_n > 0 and |F_t| > |T_max|.
    FixedSlides,
    /// F_n <= 0.
    FixedOpens,
    /// F_n > 0 and T_max · slip < 0.
    SlidingSticks,
    /// F_n > 0 and T_max · slip > 0.
    SlidingStays,
    /// F_n <= 0.
    SlidingOpens,
    /// g < 0, rough interface.
    FreeSticks,
    /// g < 0, smooth interface: straight to sliding.
    FreeSlides,
    /// g > 0.
    FreeStays,
    /// The node's projection lies past an end of every surface: nothing to touch.
    OffSurface,
    /// The user holds the mode; Table 2 was not obeyed.
    Held,
}

/// What an inequality of Table 2 compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Tested {
    /// F_n against 0 (force).
    NormalForce,
    /// |F_t| against |T_max| (force).
    ShearForce,
    /// sgn(T_max) · slip against 0 (length).
    Slip,
    /// g against 0 (length).
    Gap,
}

/// One inequality of Table 2 with its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Test {
    pub tested: Tested,
    /// Left-hand side.
    pub value: f64,
    /// Right-hand side.
    pub bound: f64,
    /// Signed distance from switching: positive keeps the mode, negative changes it; force or length.
    pub margin: f64,
    /// |margin| is within the tie tolerance.
    pub tie: bool,
}

/// Table 2's verdict on one node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    pub before: Mode,
    pub next: Mode,
    pub rule: Rule,
    /// The inequalities that were tested, in Table 2's order (F_n first); one or two.
    pub tests: [Option<Test>; 2],
    /// What Table 2 wanted; differs from `next` only where the user holds the mode.
    pub wanted: Mode,
}
