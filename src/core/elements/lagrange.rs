//! Lagrange interpolation on m equally spaced nodes in −1 <= ξ <= 1, and Gauss-Legendre quadrature.
//!
//! Beams and interface elements of the paper have 3 or 5 nodes; this program supports 2 to 9.

use std::sync::LazyLock;

/// Maximum number of nodes of an element on a curve.
pub const MAX_NODES: usize = 9;

/// Values and derivatives of the m shape functions at one ξ; entries beyond m are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// N_i(ξ).
    pub n: [f64; MAX_NODES],
    /// dN_i/dξ.
    pub d: [f64; MAX_NODES],
    /// d²N_i/dξ².
    pub dd: [f64; MAX_NODES],
}

/// Position of node i of m on the reference element.
pub const fn node(m: usize, i: usize) -> f64 {
    -1.0 + 2.0 * i as f64 / (m - 1) as f64
}

/// ξ_i of the m nodes, and 1 / Π (ξ_i − ξ_j) over the other nodes; indexed by m.
const NODES: [[(f64, f64); MAX_NODES]; MAX_NODES + 1] = nodes();

const fn nodes() -> [[(f64, f64); MAX_NODES]; MAX_NODES + 1] {
    let mut table = [[(0.0, 0.0); MAX_NODES]; MAX_NODES + 1];
    let mut m = 2;
    while m <= MAX_NODES {
        let mut i = 0;
        while i < m {
            let (mut product, mut j) = (1.0, 0);
            while j < m {
                if j != i {
                    product *= node(m, i) - node(m, j);
                }
                j += 1;
            }
            table[m][i] = (node(m, i), 1.0 / product);
            i += 1;
        }
        m += 1;
    }
    table
}

/// Calls a function that is compiled for every number of nodes from 2 to [`MAX_NODES`]; for fewer nodes there are no shape
/// functions.
macro_rules! for_count {
    ($m:expr, $function:ident($($argument:expr),*)) => {
        match $m {
            2 => $function::<2>($($argument),*),
            3 => $function::<3>($($argument),*),
            4 => $function::<4>($($argument),*),
            5 => $function::<5>($($argument),*),
            6 => $function::<6>($($argument),*),
            7 => $function::<7>($($argument),*),
            8 => $function::<8>($($argument),*),
            MAX_NODES => $function::<MAX_NODES>($($argument),*),
            _ => {}
        }
    };
}

/// The m shape functions and their first two derivatives at ξ.
///
/// N_i is the product of the factors ξ − ξ_j before i and of those after i, divided by its value at ξ_i; each product is computed
/// together with its derivatives.
pub fn shape(m: usize, xi: f64) -> Shape {
    let mut s = Shape {
        n: [0.0; MAX_NODES],
        d: [0.0; MAX_NODES],
        dd: [0.0; MAX_NODES],
    };
    for_count!(m, shape_of(xi, &mut s));
    s
}

/// dN_i/dξ only, at several ξ, for lengths and angles of curves.
pub fn slopes<const COUNT: usize>(m: usize, xi: [f64; COUNT]) -> [[f64; MAX_NODES]; COUNT] {
    let mut slopes = [[0.0; MAX_NODES]; COUNT];
    for_count!(m, slopes_of(&xi, &mut slopes));
    slopes
}

/// d³N_i/dξ³ of the m shape functions, needed for the second derivatives of the contact geometry.
pub fn third(m: usize, xi: f64) -> [f64; MAX_NODES] {
    let mut all = [0.0; MAX_NODES];
    for (i, (third, &(_, weight))) in all.iter_mut().zip(&NODES[m][..m]).enumerate() {
        let (mut value, mut by) = (weight, [0.0; 3]);
        for (_, &(at, _)) in NODES[m][..m].iter().enumerate().filter(|(j, _)| *j != i) {
            let factor = xi - at;
            by[2] = by[2] * factor + 3.0 * by[1];
            by[1] = by[1] * factor + 2.0 * by[0];
            by[0] = by[0] * factor + value;
            value *= factor;
        }
        *third = by[2];
    }
    all
}

/// Generic over the number of nodes, so that all loops are unrolled: projections evaluate millions of shape functions.
#[inline]
fn shape_of<const M: usize>(xi: f64, s: &mut Shape) {
    let nodes = &NODES[M][..M];
    let mut before = (1.0, 0.0, 0.0);
    for (i, &(at, _)) in nodes.iter().enumerate() {
        (s.n[i], s.d[i], s.dd[i]) = before;
        before = times(before, xi - at);
    }
    let mut behind = (1.0, 0.0, 0.0);
    for (i, &(at, weight)) in nodes.iter().enumerate().rev() {
        let (v, d, dd) = behind;
        let (n, n_d, n_dd) = (s.n[i], s.d[i], s.dd[i]);
        s.n[i] = weight * (n * v);
        s.d[i] = weight * (n_d * v + n * d);
        s.dd[i] = weight * (n_dd * v + 2.0 * n_d * d + n * dd);
        behind = times(behind, xi - at);
    }
}

#[inline]
fn slopes_of<const M: usize>(xi: &[f64], all: &mut [[f64; MAX_NODES]]) {
    let nodes = &NODES[M][..M];
    for (xi, slopes) in xi.iter().zip(all) {
        let (mut values, mut before) = ([0.0; MAX_NODES], (1.0, 0.0));
        for (i, &(at, _)) in nodes.iter().enumerate() {
            (values[i], slopes[i]) = before;
            let factor = xi - at;
            before = (before.0 * factor, before.1 * factor + before.0);
        }
        let mut behind = (1.0, 0.0);
        for (i, &(at, weight)) in nodes.iter().enumerate().rev() {
            slopes[i] = weight * (slopes[i] * behind.0 + values[i] * behind.1);
            let factor = xi - at;
            behind = (behind.0 * factor, behind.1 * factor + behind.0);
        }
    }
}

/// A product with its first two derivatives, multiplied by one more factor of slope 1.
fn times((v, d, dd): (f64, f64, f64), factor: f64) -> (f64, f64, f64) {
    (v * factor, d * factor + v, dd * factor + 2.0 * d)
}

/// ξ, and N_i there.
type Sample = (f64, [f64; MAX_NODES]);

/// The m shape functions at 2m − 1 equally spaced ξ from −1 to 1, computed once.
pub fn samples(m: usize) -> &'static [Sample] {
    static TABLE: LazyLock<Vec<Vec<Sample>>> = LazyLock::new(|| {
        let of = |m: usize| {
            (0..2 * m - 1)
                .map(|k| node(2 * m - 1, k))
                .map(|xi| (xi, shape(m, xi).n))
                .collect()
        };
        (0..=MAX_NODES)
            .map(|m| if m < 2 { Vec::new() } else { of(m) })
            .collect()
    });
    &TABLE[m]
}

/// Points and weights of the Gauss-Legendre rule with `count` points, by Newton's method on the Legendre polynomial.
pub fn gauss(count: usize) -> Vec<(f64, f64)> {
    (0..count)
        .map(|k| {
            let mut x = -(std::f64::consts::PI * (k as f64 + 0.75) / (count as f64 + 0.5)).cos();
            let mut derivative = 1.0;
            for _ in 0..20 {
                let (p, d) = legendre(count, x);
                derivative = d;
                let step = p / d;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * derivative * derivative))
        })
        .collect()
}

/// The Legendre polynomial of this degree and its derivative, for |x| < 1.
pub fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut p0, mut p1) = (1.0, x);
    if degree == 0 {
        return (1.0, 0.0);
    }
    for k in 2..=degree {
        let k = k as f64;
        (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
    }
    (p1, degree as f64 * (x * p1 - p0) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_functions_reproduce_polynomials_of_their_degree_with_two_derivatives() {
        for m in 2..=MAX_NODES {
            for xi in [-1.0, -0.83, 0.0, 0.31, 1.0] {
                let s = shape(m, xi);
                assert_eq!([s.d], slopes(m, [xi]));
                for degree in 0..m as i32 {
                    let at = |x: f64| x.powi(degree);
                    let sum =
                        |c: &[f64; MAX_NODES]| (0..m).map(|i| c[i] * at(node(m, i))).sum::<f64>();
                    let k = f64::from(degree);
                    assert!((sum(&s.n) - at(xi)).abs() < 1e-12);
                    let first = if degree > 0 {
                        k * xi.powi(degree - 1)
                    } else {
                        0.0
                    };
                    assert!((sum(&s.d) - first).abs() < 1e-11);
                    let second = if degree > 1 {
                        k * (k - 1.0) * xi.powi(degree - 2)
                    } else {
                        0.0
                    };
                    assert!((sum(&s.dd) - second).abs() < 1e-9);
                    let cubic = if degree > 2 {
                        k * (k - 1.0) * (k - 2.0) * xi.powi(degree - 3)
                    } else {
                        0.0
                    };
                    assert!((sum(&third(m, xi)) - cubic).abs() < 1e-8);
                }
            }
        }
    }

    #[test]
    fn gauss_rules_integrate_polynomials_of_degree_2n_minus_1() {
        for count in 1..=MAX_NODES {
            for degree in 0..2 * count {
                let sum: f64 = gauss(count)
                    .iter()
                    .map(|(x, w)| w * x.powi(degree as i32))
                    .sum();
                let exact = if degree % 2 == 0 {
                    2.0 / (degree as f64 + 1.0)
                } else {
                    0.0
                };
                assert!((sum - exact).abs() < 1e-14, "{count} {degree} {sum}");
            }
        }
    }
}
