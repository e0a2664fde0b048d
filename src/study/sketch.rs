//! Quantiles of many numbers in little room: counts of numbers that begin with the same bits.
//!
//! A number's bucket is the upper 18 bits of its 64: sign, exponent, and 6 bits of the mantissa. A quantile is the least number of
//! its bucket, at most 1/64 below the true one; whole numbers up to 128 are exact. Counts add up, so that sketches are put together
//! in any order to the same bytes. (DDSketch, Masson et al. 2019, has buckets of one ratio; these need no logarithm.)

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How often numbers of a bucket came.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sketch(BTreeMap<u32, u64>);

/// Bits of a number that its bucket does not tell.
const LOST: u32 = 64 - 18;

impl Sketch {
    /// Counts a number from 0 to infinity; what is no number counts as infinite.
    pub fn add(&mut self, value: f64) {
        let value = if value.is_nan() {
            f64::INFINITY
        } else {
            value.abs()
        };
        *self.0.entry((value.to_bits() >> LOST) as u32).or_default() += 1;
    }

    /// Counts all that another one has counted.
    pub fn add_all(&mut self, other: &Sketch) {
        for (bucket, count) in &other.0 {
            *self.0.entry(*bucket).or_default() += count;
        }
    }

    /// The number below or at which that part of all lies; 0 where there are none.
    pub fn quantile(&self, part: f64) -> f64 {
        let all: u64 = self.0.values().sum();
        let wanted = ((part * all as f64).ceil() as u64).max(1);
        let mut seen = 0;
        let bucket = self.0.iter().find(|(_, count)| {
            seen += **count;
            seen >= wanted
        });
        bucket.map_or(0.0, |(bucket, _)| {
            f64::from_bits(u64::from(*bucket) << LOST)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(values: &[f64]) -> Sketch {
        let mut sketch = Sketch::default();
        values.iter().for_each(|value| sketch.add(*value));
        sketch
    }

    proptest! {
        #[test]
        fn a_quantile_is_at_most_a_64th_below_the_true_one(
            mut values in prop::collection::vec(1e-300_f64..1e300, 1..200), part in 0.0_f64..1.0
        ) {
            let found = of(&values).quantile(part);
            values.sort_by(f64::total_cmp);
            let rank = ((part * values.len() as f64).ceil() as usize).max(1);
            let exact = values[rank - 1];
            prop_assert!(found <= exact && found >= exact * (1.0 - 1.0 / 64.0), "{found} {exact}");
        }

        #[test]
        fn sketches_are_put_together_in_any_order(
            a in prop::collection::vec(0.0_f64..1e9, 0..50), b in prop::collection::vec(0.0_f64..1e9, 0..50)
        ) {
            let (mut ab, mut ba) = (of(&a), of(&b));
            ab.add_all(&of(&b));
            ba.add_all(&of(&a));
            prop_assert_eq!(&ab, &ba);
            prop_assert_eq!(ab, of(&[a, b].concat()));
        }
    }

    #[test]
    fn small_whole_numbers_are_exact_and_what_is_no_number_is_the_largest() {
        for k in 0..=128 {
            assert_eq!(of(&[f64::from(k)]).quantile(0.5), f64::from(k));
        }
        assert_eq!(of(&[1.0, f64::NAN]).quantile(1.0), f64::INFINITY);
        assert_eq!(Sketch::default().quantile(0.5), 0.0);
    }
}
