//! Integration rules for the parent triangle and the parent square.

use crate::elements::lagrange::gauss;

/// A point of the parent element, and its weight.
pub type Point = ([f64; 2], f64);

/// The centroid of the parent triangle: exact for linear functions.
pub const TRIANGLE_1: [Point; 1] = [([1.0 / 3.0, 1.0 / 3.0], 0.5)];

/// Three interior points of the parent triangle: exact for quadratic functions.
pub const TRIANGLE_3: [Point; 3] = [
    ([1.0 / 6.0, 1.0 / 6.0], 1.0 / 6.0),
    ([2.0 / 3.0, 1.0 / 6.0], 1.0 / 6.0),
    ([1.0 / 6.0, 2.0 / 3.0], 1.0 / 6.0),
];

/// The Gauss-Legendre rule with `count` by `count` points (P in total) on the parent square, row by row.
pub fn square<const P: usize>(count: usize) -> [Point; P] {
    let line = gauss(count);
    std::array::from_fn(|p| {
        let ((xi, a), (eta, b)) = (line[p % count], line[p / count]);
        ([xi, eta], a * b)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integral(rule: &[Point], i: i32, j: i32) -> f64 {
        let term = |([x, y], weight): &Point| weight * x.powi(i) * y.powi(j);
        rule.iter().map(term).sum()
    }

    #[test]
    fn triangle_rules_integrate_polynomials_of_their_degree() {
        // ∫ ξ^i η^j = i! j! / (i + j + 2)!
        let factorial = |n: i32| f64::from((1..=n).product::<i32>());
        for (rule, degree) in [(&TRIANGLE_1[..], 1), (&TRIANGLE_3[..], 2)] {
            for (i, j) in (0..=degree).flat_map(|i| (0..=degree - i).map(move |j| (i, j))) {
                let exact = factorial(i) * factorial(j) / factorial(i + j + 2);
                assert!((integral(rule, i, j) - exact).abs() < 1e-15, "{i} {j}");
            }
        }
    }

    #[test]
    fn square_rules_integrate_polynomials_of_their_degree() {
        let line = |k: i32| {
            if k % 2 == 0 {
                2.0 / f64::from(k + 1)
            } else {
                0.0
            }
        };
        for i in 0..6 {
            for j in 0..6 {
                let exact = line(i) * line(j);
                assert!((integral(&square::<9>(3), i, j) - exact).abs() < 1e-14);
                if i < 4 && j < 4 {
                    assert!((integral(&square::<4>(2), i, j) - exact).abs() < 1e-14);
                }
            }
        }
    }
}
