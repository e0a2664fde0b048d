//! Semismooth Newton's method on the projection equations of contact and friction.
//!
//! With a spring stiffness k that relates lengths to forces, Coulomb's law is
//!
//! ```text
//! F_n = max(0, F_n − k g)
//! F_t = projection of F_t + k slip on |F_t| <= tan φ (F_n − k g) + c
//! ```
//!
//! and a Newton step uses the branch of each equation that holds at the current numbers:
//!
//! ```text
//! opens    F_n − k g <= 0
//! slides   |F_t + k slip| > tan φ (F_n − k g) + c
//! ```
//!
//! If full steps cycle, a line search repeats them ([`crate::interface::line_search`]).

use crate::interface::method::{Choice, NodeContext};
use crate::{BoundUpdate, Decision, Method, Mode, Numbers, Rule, TestedQuantity};

/// Newton's method on the projection equations.
pub struct Newton;

impl Method for Newton {
    fn bound(&self, _wanted: BoundUpdate) -> BoundUpdate {
        BoundUpdate::Consistent
    }

    fn compares_by_springs(&self) -> bool {
        true
    }

    fn searches_line(&self) -> bool {
        true
    }

    fn choose(&self, numbers: &Numbers, known: &NodeContext<'_>) -> Choice {
        let (friction, ties) = (known.friction, known.ties);
        let (stiffness, had) = (known.spring, known.sign);
        let before = numbers.mode;
        let pressure = numbers.f_n - stiffness * numbers.gap;
        let drag = numbers.f_t + stiffness * known.slip;
        let limit = friction.limit(pressure);
        // A tie keeps the current mode.
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
        let pressed = ties.test(TestedQuantity::Pressure, pressure, 0.0, touch, ties.force);
        let shear = kept(next == before && sign == had, drag.abs() - limit);
        let sheared = ties.test(TestedQuantity::Drag, drag.abs(), limit, shear, ties.force);
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
        Choice {
            decision,
            sign: Some(sign),
        }
    }
}
