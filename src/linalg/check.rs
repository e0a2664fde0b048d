//! Checks of solves.

use std::borrow::Borrow;

/// Why a system could not be solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolveError {
    /// A pivot vanished, or the solution is not finite or does not satisfy the equations.
    Singular,
    /// Not enough memory for the factors.
    OutOfMemory,
}

/// Size from which a solution can be checked relative to its vectors; smaller ones have lost digits to underflow. A body without
/// loads gets there if every solve divides its displacements by the accuracy.
pub(super) const UNDERFLOW: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// Fills in a fixed vector that contains all frequencies, with magnitudes between 1 and 2.
pub(super) fn fill_probe(probe: &mut [f64]) {
    for (i, p) in probe.iter_mut().enumerate() {
        *p = 1.0 + (1.618_033_988_749_895 * i as f64).fract();
        if i % 2 == 1 {
            *p = -*p;
        }
    }
}

/// Largest magnitude of some numbers; infinite if one is not finite (`max` would ignore NaN).
pub fn largest(values: impl IntoIterator<Item: Borrow<f64>>) -> f64 {
    // The bits of magnitudes are ordered as the magnitudes are, with infinity and NaN last.
    let bits = values
        .into_iter()
        .map(|value| value.borrow().abs().to_bits());
    f64::from_bits(bits.fold(0, u64::max).min(f64::INFINITY.to_bits()))
}

/// Whether two vectors of the same length are equal; compares all entries, which is faster than stopping at the first difference.
pub(super) fn are_equal(a: &[f64], b: &[f64]) -> bool {
    let pairs = a.iter().zip(b);
    !pairs.fold(false, |differ, (a, b)| differ | (a != b))
}
