//! Finds cycles in CalculiX's iterations, as for our own solver ([`stickslip_core::interface::cycle`]).
//!
//! Two iterations are equal if they have the same contact elements, and their residuals and corrections differ
//! by at most one unit in the last of the four printed digits.

use std::ops::Range;
use stickslip_core::groups::distinct;
use stickslip_core::interface::cycle;
use stickslip_exchange::calculix::cel::ClosedContact;
use stickslip_exchange::calculix::files::{Attempt, CalculixFiles, End};

/// Number of digits printed.
const DIGITS: i32 = 4;
/// Largest difference of equal numbers, in units of the last digit.
const SAME: f64 = 1.0;
/// Numbers that differ by more than this are different; in between, the iteration may still be converging.
const DIFFERENT: f64 = 10.0;

/// A cycle of iterations.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cycle {
    /// Iterations of the first period, by index in the run.
    pub iterations: Range<usize>,
    /// Slaves whose contact elements change, by index in the run.
    pub members: Vec<usize>,
}

impl Cycle {
    /// Period of the cycle, at least 2.
    pub fn period(&self) -> usize {
        self.iterations.len()
    }
}

/// The first cycle in an attempt: two whole turns, with a contact closed in each. Without residuals, only contact elements are compared, and only in attempts
/// that did not converge, because contact elements can also recur on the way to convergence.
pub fn first(run: &CalculixFiles, attempt: &Attempt) -> Option<Cycle> {
    let of = |k: usize| attempt.iterations.start + k;
    let found = (0..attempt.iterations.len()).find_map(|here| {
        let (same, elsewhere) = (
            |then: usize| differ(run, attempt, of(then), of(here), SAME) == Some(false),
            |then: usize| differ(run, attempt, of(then), of(here), DIFFERENT) == Some(true),
        );
        let turn = cycle::closed(here, 2, same, elsewhere)?;
        // One return to an earlier iteration can be chance; in a cycle the second turn repeats the first.
        let again = |k: usize| {
            let next = k + turn.len();
            next < attempt.iterations.len()
                && differ(run, attempt, of(k), of(next), SAME) == Some(false)
        };
        let is_cycle = turn.clone().all(again)
            && turn
                .clone()
                .any(|k| run.closed(of(k)).is_some_and(|closed| !closed.is_empty()));
        is_cycle.then_some(turn)
    })?;
    let iterations = of(found.start)..of(found.end);
    let members = iterations
        .clone()
        .filter_map(|k| Some(changed(run.closed(k)?, run.closed(iterations.start)?)))
        .flatten();
    let members = distinct(members);
    Some(Cycle {
        iterations,
        members,
    })
}

/// Whether two iterations differ by more than `limit` units of the last digit, or in contact elements; `None`
/// if unknown.
fn differ(run: &CalculixFiles, attempt: &Attempt, a: usize, b: usize, limit: f64) -> Option<bool> {
    let (one, other) = (&run.iterations[a], &run.iterations[b]);
    let touches = run.closed(a)? != run.closed(b)?;
    match (one.norms, other.norms) {
        (Some(one), Some(other)) => {
            let far = |a: f64, b: f64| apart(a, b).is_none_or(|apart| apart > limit);
            let numbers =
                far(one.residual, other.residual) || far(one.correction, other.correction);
            Some(touches || numbers)
        }
        (None, None) if attempt.end != End::Converged => Some(touches),
        _ => None,
    }
}

/// Difference of two printed numbers, in units of the last digit of the larger; `None` if one is NaN.
fn apart(a: f64, b: f64) -> Option<f64> {
    if a == b {
        return Some(0.0);
    }
    let size = a.abs().max(b.abs());
    let unit = 10_f64.powi(size.log10().floor() as i32 + 1 - DIGITS);
    let units = (a - b).abs() / unit;
    // Remove binary round-off of decimal fractions.
    units.is_finite().then(|| (units * 1e3).round() / 1e3)
}

/// The slaves whose contact elements differ between two iterations, in ascending order.
pub fn changed(one: &[ClosedContact], other: &[ClosedContact]) -> Vec<usize> {
    let of_one = one
        .iter()
        .filter(|closed| other.binary_search(closed).is_err());
    let of_other = other
        .iter()
        .filter(|closed| one.binary_search(closed).is_err());
    distinct(of_one.chain(of_other).map(|closed| closed.slave as usize))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_in_units_of_the_last_printed_digit() {
        for (a, b, units) in [
            (1081.0, 1082.0, Some(1.0)),
            (0.9988e2, 0.9987e2, Some(1.0)),
            (0.0, 0.0, Some(0.0)),
            (0.0, 0.1, Some(1000.0)),
            (1e30, 1e30, Some(0.0)),
            (f64::NAN, f64::NAN, None),
        ] {
            assert_eq!(apart(a, b), units, "{a} {b}");
        }
    }

    #[test]
    fn changed_slaves_include_those_of_one_iteration_only() {
        let of = |slaves: &[(u32, u32)]| -> Vec<ClosedContact> {
            let closed = |&(slave, master): &(u32, u32)| ClosedContact {
                slave,
                master,
                elements: 1,
            };
            slaves.iter().map(closed).collect()
        };
        let (a, b) = (
            of(&[(0, 0), (2, 0), (3, 1), (3, 2)]),
            of(&[(1, 0), (2, 0), (3, 1)]),
        );
        assert_eq!(changed(&a, &b), [0, 1, 3]);
        assert_eq!(changed(&a, &a), [0; 0]);
        assert_eq!(changed(&a, &[]), [0, 2, 3]);
    }
}
