//! Richardson extrapolation: the limit of three runs whose element or increment size h falls by a constant ratio r.
//!
//! With e₁ and e₂ the largest changes of a monitor from the first run to the second and from the second to the third, its order is
//! p = ln(e₁/e₂) / ln r, its limit u₃ + (u₃ − u₂) / (rᵖ − 1), and the error bar 1.25 |u₃ − u₂| / (rᵖ − 1), with Roache's factor
//! of safety. A monitor that shows no order is not extrapolated; its error bar is 1.25 |u₃ − u₂|.

use super::reference::{Reference, ReferencePoint};

/// Roache's factor of safety for three meshes.
const SAFETY: f64 = 1.25;
/// Orders that are taken as such.
const ORDERS: std::ops::RangeInclusive<f64> = 0.5..=12.0;

/// The limit of three runs, from coarse to fine, at those loads of the finest that `counts` and that all three have; and the order
/// of each monitor that shows one.
pub fn limit(
    runs: [&Reference; 3],
    ratio: f64,
    counts: impl Fn(usize, f64) -> bool,
) -> (Reference, Vec<Option<f64>>) {
    let [first, second, third] = runs;
    let at = |row: &ReferencePoint| {
        let [a, b] = [first, second].map(|run| run.at(row.leg, row.load));
        Some([a?.values.clone(), b?.values.clone(), row.values.clone()])
    };
    let rows: Vec<_> = third
        .rows
        .iter()
        .filter(|row| counts(row.leg, row.load))
        .filter_map(|row| Some((row.leg, row.load, at(row)?)))
        .collect();
    let change = |k: usize, from: usize| {
        rows.iter()
            .map(|(.., u)| (u[from + 1][k] - u[from][k]).abs())
            .fold(0.0, f64::max)
    };
    let order = |k: usize| {
        let order = (change(k, 0) / change(k, 1)).ln() / ratio.ln();
        Some(order).filter(|order| ORDERS.contains(order))
    };
    let orders: Vec<Option<f64>> = (0..third.monitors.len()).map(order).collect();
    let point = |(leg, load, [_, second, third]): &(usize, f64, [Vec<f64>; 3])| {
        let all = second
            .iter()
            .zip(third)
            .zip(&orders)
            .map(|((u2, u3), order)| match order {
                Some(order) => {
                    let rest = (u3 - u2) / (ratio.powf(*order) - 1.0);
                    (u3 + rest, SAFETY * rest.abs())
                }
                None => (*u3, SAFETY * (u3 - u2).abs()),
            });
        let (values, bars) = all.unzip();
        ReferencePoint {
            leg: *leg,
            load: *load,
            values,
            bars,
        }
    };
    let limit = Reference {
        source: String::new(),
        monitors: third.monitors.clone(),
        rows: rows.iter().map(point).collect(),
    };
    (limit, orders)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// u = 1 + λ h², and a second monitor that grows instead of converging.
    fn run(h: f64) -> Reference {
        let row = |load: f64| ReferencePoint {
            leg: 0,
            load,
            values: vec![1.0 + load * h * h, 1.0 / h],
            bars: Vec::new(),
        };
        Reference {
            source: String::new(),
            monitors: vec!["u".to_owned(), "v".to_owned()],
            rows: [0.5, 1.0].map(row).into(),
        }
    }

    #[test]
    fn the_limit_of_second_order_is_found_and_its_bar_covers_the_error_of_the_finest() {
        let runs = [0.4, 0.2, 0.1].map(run);
        let (limit, orders) = limit([&runs[0], &runs[1], &runs[2]], 2.0, |_, load| load == 1.0);
        assert!((orders[0].unwrap() - 2.0).abs() < 1e-9, "{orders:?}");
        let [row] = limit.rows.as_slice() else {
            panic!("{limit:?}");
        };
        assert!((row.values[0] - 1.0).abs() < 1e-12, "{row:?}");
        assert!((row.bars[0] - 1.25 * 0.01).abs() < 1e-12, "{row:?}");
        // What grows has no order: the finest value, and the whole change as its bar.
        assert_eq!((orders[1], row.values[1]), (None, 10.0));
        assert!((row.bars[1] - 1.25 * 5.0).abs() < 1e-12, "{row:?}");
    }
}
