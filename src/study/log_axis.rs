//! Logarithmic axes, fitted to the data.

/// A logarithmic axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogAxis {
    /// Decimal logarithm of the lower end.
    low: f64,
    /// Decimal logarithm of the upper end.
    high: f64,
}

/// Margin at either end as a fraction of the range, and the minimum range of an axis in decades.
const AIR: f64 = 0.06;
const LEAST: f64 = 0.5;

/// The smallest and the largest number; `None` without numbers.
pub(super) fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range: Option<(f64, f64)>, v| {
        Some(range.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
    })
}

impl LogAxis {
    /// An axis that contains some positive numbers, with a small margin.
    pub fn new(values: impl Iterator<Item = f64>) -> LogAxis {
        let values = values.filter(|v| v.is_finite() && *v > 0.0);
        let (low, high) = range(values.map(f64::log10)).unwrap_or((0.0, 1.0));
        let missing = 0.5 * (LEAST - (high - low)).max(0.0);
        let air = AIR * (high - low).max(LEAST) + missing;
        LogAxis {
            low: low - air,
            high: high + air,
        }
    }

    /// Position of a number, from 0 to 1.
    pub fn part(self, value: f64) -> f64 {
        let value = value.max(f64::MIN_POSITIVE).log10();
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// About `most` round numbers along the axis: powers of ten and, if these are few, their multiples.
    pub fn ticks(self, most: usize) -> Vec<f64> {
        const STEPS: [&[f64]; 3] = [
            &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
            &[1.0, 2.0, 5.0],
            &[1.0],
        ];
        STEPS
            .iter()
            .map(|steps| self.multiples(steps, 1))
            .chain((2..100).map(|every| self.multiples(&[1.0], every)))
            .find(|ticks| ticks.len() <= most.max(2))
            .unwrap_or_default()
    }

    fn multiples(self, steps: &[f64], every: i32) -> Vec<f64> {
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        let all = decades
            .filter(|decade| decade.rem_euclid(every) == 0)
            .flat_map(|decade| steps.iter().map(move |step| (step, decade)));
        // Formatted and parsed, so that the value equals its label.
        all.filter_map(|(step, decade)| format!("{step}e{decade}").parse::<f64>().ok())
            .filter(|v| (self.low..=self.high).contains(&v.log10()))
            .collect()
    }
}

/// Formats a number of an axis.
pub fn written(value: f64) -> String {
    if (1e-3..1e5).contains(&value) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_contains_its_values_with_a_small_margin() {
        let values = [3e-3, 0.2];
        let axis = LogAxis::new(values.into_iter().chain([f64::INFINITY, 0.0]));
        let parts = values.map(|v| axis.part(v));
        assert!(0.02 < parts[0] && parts[0] < 0.1, "{parts:?}");
        assert!(0.9 < parts[1] && parts[1] < 0.98, "{parts:?}");
        let one = LogAxis::new([1.0].into_iter());
        assert!((one.part(1.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn there_are_ticks_on_short_and_on_long_axes() {
        let ticks = |low: f64, high: f64| LogAxis::new([low, high].into_iter()).ticks(9);
        assert_eq!(ticks(1.1e-2, 3e-2), [0.01, 0.015, 0.02, 0.03]);
        assert_eq!(ticks(1e-3, 1.0), [1e-3, 1e-2, 0.1, 1.0]);
        for (low, high) in [(1.0, 1.0), (0.9, 8.0), (1e-12, 1.0), (1e-300, 1e300)] {
            let ticks = ticks(low, high);
            assert!((2..=9).contains(&ticks.len()), "{low} to {high}: {ticks:?}");
        }
        assert_eq!(
            [1e-4, 2e-3, 0.5, 300.0, 2e6].map(written),
            ["1e-4", "0.002", "0.5", "300", "2e6"]
        );
    }
}
