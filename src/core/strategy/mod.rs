//! What else than Table 2 as printed may choose the modes of the next minor iteration.
//!
//! A strategy solves for one assumption of every node's mode, as Table 2 does, and differs in how it goes on from there:
//! in the mode with which a node enters contact, in how many nodes may change at once, or in the test itself. Those that
//! look at all nodes together, Lemke's pivoting and the census, are [`crate::interface::lemke`] and
//! [`crate::interface::census`].

use crate::contact::table2::{Decision, Numbers, Rule, Tested, Ties};
use crate::model::{BoundUpdate, Strategy};
use crate::model::{Friction, Mode};
use serde::{Deserialize, Serialize};

/// The rungs of the ladder, the cheapest first.
pub const LADDER: [Strategy; 5] = [
    Strategy::Table2,
    Strategy::Sliding,
    Strategy::SlidingLeast,
    Strategy::Lemke,
    Strategy::Census,
];

/// Whether a rough node that touches slides.
pub fn enters_sliding(strategy: Strategy) -> bool {
    matches!(
        strategy,
        Strategy::Sliding | Strategy::SlidingLeast | Strategy::Block
    )
}

/// Whether only one node changes at a time; `stalled` says that the number of changing nodes has not fallen for a
/// while.
pub fn one_at_a_time(strategy: Strategy, stalled: bool) -> bool {
    match strategy {
        Strategy::Least | Strategy::SlidingLeast => true,
        Strategy::Block => stalled,
        _ => false,
    }
}

/// How T_max enters the equations: what looks at the whole of Coulomb's law needs it in the matrix.
pub fn limit(strategy: Strategy, wanted: BoundUpdate) -> BoundUpdate {
    match strategy {
        Strategy::Newton | Strategy::Lemke | Strategy::Census => BoundUpdate::Consistent,
        _ => wanted,
    }
}

/// Newton's verdict, and the direction of T_max: a node is pressed where F_n exceeds what a spring of stiffness k would
/// push off it through the gap, and slides where force and spring together exceed the friction that this gives.
/// `numbers.slip` is counted for a free node, too; `had` is the direction that T_max had.
pub fn newton(
    numbers: &Numbers,
    friction: &Friction,
    stiffness: f64,
    had: f64,
    ties: &Ties,
) -> (Decision, f64) {
    let before = numbers.mode;
    let pressure = numbers.f_n - stiffness * numbers.gap;
    let drag = numbers.f_t + stiffness * numbers.slip;
    let limit = friction.coefficient() * pressure + friction.cohesion;
    // A tie keeps what the node does.
    let tie = if ties.keep { ties.force } else { 0.0 };
    let opens = pressure <= if before == Mode::Free { tie } else { -tie };
    let goes_on = before == Mode::Sliding && had * drag >= limit - tie;
    let (next, rule) = if opens {
        (Mode::Free, Rule::NewtonOpens)
    } else if friction.is_smooth() || goes_on || drag.abs() > limit + tie {
        (Mode::Sliding, Rule::NewtonSlides)
    } else {
        (Mode::Fixed, Rule::NewtonSticks)
    };
    let sign = if goes_on || drag == 0.0 {
        had
    } else {
        drag.signum()
    };
    let kept = |keeps: bool, distance: f64| {
        if keeps {
            distance.abs()
        } else {
            -distance.abs()
        }
    };
    let touch = kept(opens == (before == Mode::Free), pressure);
    let pressed = ties.test(Tested::Pressure, pressure, 0.0, touch, ties.force);
    let shear = kept(next == before && sign == had, drag.abs() - limit);
    let sheared = ties.test(Tested::Drag, drag.abs(), limit, shear, ties.force);
    let decision = Decision {
        before,
        next,
        rule,
        tests: [
            Some(pressed),
            (!opens && !friction.is_smooth()).then_some(sheared),
        ],
        wanted: next,
    };
    (decision, sign)
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
