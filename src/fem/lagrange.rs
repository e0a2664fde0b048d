//! Lagrange interpolation on m equally spaced nodes in −1 <= ξ <= 1, and Gauss-Legendre quadrature.
//!
//! Beams and interface elements of the paper have 3 or 5 nodes; 2 to 9 are possible here.

/// Most nodes that an element on a curve can have.
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
pub fn node(m: usize, i: usize) -> f64 {
    -1.0 + 2.0 * i as f64 / (m - 1) as f64
}

/// The m shape functions and their first two derivatives at ξ.
///
/// Each N_i is a product of m − 1 linear factors; its derivatives leave out one and two of them.
pub fn shape(m: usize, xi: f64) -> Shape {
    let mut s = Shape {
        n: [0.0; MAX_NODES],
        d: [0.0; MAX_NODES],
        dd: [0.0; MAX_NODES],
    };
    for i in 0..m {
        // Value, first and second derivative of the product so far: multiply by (ξ − ξ_j)/(ξ_i − ξ_j) in turn.
        let (mut v, mut d, mut dd) = (1.0, 0.0, 0.0);
        for j in (0..m).filter(|&j| j != i) {
            let slope = 1.0 / (node(m, i) - node(m, j));
            let factor = (xi - node(m, j)) * slope;
            dd = dd * factor + 2.0 * d * slope;
            d = d * factor + v * slope;
            v *= factor;
        }
        (s.n[i], s.d[i], s.dd[i]) = (v, d, dd);
    }
    s
}

/// Points and weights of the Gauss-Legendre rule of `count` points, by Newton's method on the Legendre polynomial.
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

/// Legendre polynomial of this degree and its derivative, for |x| < 1.
fn legendre(degree: usize, x: f64) -> (f64, f64) {
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
