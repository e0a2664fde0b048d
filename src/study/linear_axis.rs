//! Linear axes with round numbers: 1, 2 or 5 times a power of ten.

/// The smallest round step that divides a range into at most `most` intervals.
pub fn step((low, high): (f64, f64), most: f64) -> f64 {
    let least = (high - low) / most;
    let decade = 10_f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|step| step * decade)
        .into_iter()
        .find(|step| *step >= least);
    step.unwrap_or(least)
}

/// The multiples of a step within a range.
pub fn ticks((low, high): (f64, f64), step: f64) -> impl Iterator<Item = f64> {
    let first = (low / step - SLACK).ceil();
    let count = ((high / step + SLACK).floor() - first).clamp(0.0, MOST) as u32;
    (0..=count).map(move |k| (first + f64::from(k)) * step)
}

/// Part of a step by which an end of the range may miss a multiple because of round-off.
const SLACK: f64 = 1e-9;
/// Limit of the number of ticks.
const MOST: f64 = 100.0;

/// A range that contains this one and ends at multiples of the step.
pub fn rounded((low, high): (f64, f64), step: f64) -> (f64, f64) {
    let down = (low / step + SLACK).floor() * step;
    let up = (high / step - SLACK).ceil() * step;
    (down, up)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_ranges_end_at_them() {
        for (range, most, wanted, ticked) in [
            ((0.0, 0.25), 9.0, 0.05, 6),
            ((-0.0127, 0.0), 9.0, 0.002, 8),
            ((-2.993e-9, 2.993e-9), 5.0, 2e-9, 5),
            ((0.0, 1.026), 4.0, 0.5, 4),
        ] {
            let step = step(range, most);
            assert!((step / wanted - 1.0).abs() < 1e-12, "{step}");
            let (low, high) = rounded(range, step);
            assert!(low <= range.0 && range.1 <= high);
            let ticks: Vec<f64> = ticks((low, high), step).collect();
            assert_eq!(ticks.len(), ticked, "{ticks:?}");
            assert_eq!((ticks[0], ticks[ticked - 1]), (low, high));
        }
    }
}
