//! Checks the geometry of elements, and measures the distance of a point from a chain of elements.

use super::limits;
use crate::format::error::{Fault, Path, bail};
use stickslip_core::fem::continuum;
use stickslip_core::plane::{cross, distance, distance_to_segment, minus};
use stickslip_core::{ElementKind, Node};

/// Rejects chains with an element whose nodes coincide or whose curve folds back or has zero velocity.
///
/// `length` is the diagonal of the scene. An element is the Lagrange curve through its nodes at equal parameter steps; with
/// unevenly spaced nodes the curve can run back and forth, and its Jacobian changes sign.
pub(crate) fn check_elements(
    path: &Path,
    nodes: &[Node],
    elements: &[Vec<usize>],
    length: f64,
) -> Result<(), Fault> {
    let mut table = slopes(elements.first().map_or(2, Vec::len));
    for element in elements {
        // The boundary of a mesh of several kinds may have elements with 2 nodes and with 3.
        if table[0].len() != element.len() {
            table = slopes(element.len());
        }
        check_distances(path, nodes, element, length)?;
        let points: Vec<[f64; 2]> = element.iter().map(|&n| nodes[n].at).collect();
        if folds(&table, &points) {
            let (first, last) = (
                &nodes[element[0]].name,
                &nodes[element[element.len() - 1]].name,
            );
            bail!(
                path,
                "the element {first} to {last} is folded: its Jacobian vanishes or changes sign; space its \
                 nodes more evenly"
            );
        }
    }
    Ok(())
}

fn check_distances(
    path: &Path,
    nodes: &[Node],
    element: &[usize],
    length: f64,
) -> Result<(), Fault> {
    for (k, pair) in element.windows(2).enumerate() {
        let (a, b) = (&nodes[pair[0]], &nodes[pair[1]]);
        let message = if element[..=k].contains(&pair[1]) {
            format!("node {} occurs twice in one element", b.name)
        } else if distance(a.at, b.at) <= limits::SHORTEST * length {
            let [x, y] = b.at;
            format!(
                "an element has zero length: its nodes {} and {} are both at ({x:?}, {y:?})",
                a.name, b.name
            )
        } else {
            continue;
        };
        return Err(Fault::new(path, message));
    }
    Ok(())
}

/// Whether the tangent of a Lagrange curve nearly vanishes, or turns by more than a right angle within a small step.
fn folds(slopes: &[Vec<f64>], points: &[[f64; 2]]) -> bool {
    const SMALLEST: f64 = 1e-3;
    let tangents: Vec<[f64; 2]> = slopes
        .iter()
        .map(|slopes| {
            let add =
                |sum: [f64; 2], (s, p): (&f64, &[f64; 2])| [sum[0] + s * p[0], sum[1] + s * p[1]];
            slopes.iter().zip(points).fold([0.0, 0.0], add)
        })
        .collect();
    let norm = |t: &[f64; 2]| t[0].hypot(t[1]);
    let largest = tangents.iter().map(norm).fold(0.0, f64::max);
    let still = tangents.iter().any(|t| norm(t) <= SMALLEST * largest);
    let turns = tangents
        .windows(2)
        .any(|t| t[0][0] * t[1][0] + t[0][1] * t[1][1] <= 0.0);
    still || turns
}

/// Derivatives of the m Lagrange functions at many points, for nodes at the parameters 0, 1, 2, …
fn slopes(m: usize) -> Vec<Vec<f64>> {
    let steps = 8 * (m - 1);
    let place = |k: usize| (m - 1) as f64 * k as f64 / steps as f64;
    (0..=steps)
        .map(|k| (0..m).map(|i| slope(m, i, place(k))).collect())
        .collect()
}

/// Derivative of the Lagrange function i of m at t.
pub(crate) fn slope(m: usize, i: usize, t: f64) -> f64 {
    let others = |skip: usize| (0..m).filter(move |j| *j != i && *j != skip);
    let factor = |j: usize| (t - j as f64) / (i as f64 - j as f64);
    others(i)
        .map(|skip| others(skip).map(factor).product::<f64>() / (i as f64 - skip as f64))
        .sum()
}

/// Shape function derivatives of a kind of element at points distributed over the parent element, including its corners.
pub(crate) struct Folds(Vec<Vec<[f64; 2]>>);

impl Folds {
    /// The table for a kind, at 5 by 5 points.
    pub fn from_kind(kind: ElementKind) -> Self {
        let part = |k: usize| k as f64 / 4.0;
        let places = (0..25)
            .map(|k| (part(k % 5), part(k / 5)))
            .filter(|(r, s)| !kind.is_triangle() || r + s <= 1.0);
        // With three nodes the derivatives are constant.
        let places = places.take(if kind == ElementKind::Triangle3 {
            1
        } else {
            25
        });
        Folds(
            places
                .map(|(r, s)| {
                    let (xi, eta) = if kind.is_triangle() {
                        (r, s)
                    } else {
                        (2.0 * r - 1.0, 2.0 * s - 1.0)
                    };
                    continuum::formulation(kind).shape(xi, eta).1
                })
                .collect(),
        )
    }

    /// Whether the Jacobian of an element is below a thousandth of its maximum at one of the points, that is, not clearly
    /// positive.
    pub fn is_folded(&self, nodes: impl Iterator<Item = [f64; 2]> + Clone) -> bool {
        const SMALLEST: f64 = 1e-3;
        let jacobian = |slopes: &Vec<[f64; 2]>| {
            let mut sums = [[0.0; 2]; 2];
            for (x, d) in nodes.clone().zip(slopes) {
                for (axis, row) in sums.iter_mut().enumerate() {
                    for (by, sum) in row.iter_mut().enumerate() {
                        *sum += x[axis] * d[by];
                    }
                }
            }
            sums[0][0] * sums[1][1] - sums[0][1] * sums[1][0]
        };
        let jacobians: Vec<f64> = self.0.iter().map(jacobian).collect();
        let greatest = jacobians.iter().copied().fold(0.0, f64::max);
        !jacobians.iter().all(|&j| j > SMALLEST * greatest)
    }
}

/// Distance of a point from the polygon through the nodes of elements. The search stops at any distance up to `enough`, because
/// callers only compare with that and there may be many elements.
pub(crate) fn distance_up_to(
    enough: f64,
    at: [f64; 2],
    nodes: &[Node],
    elements: &[Vec<usize>],
) -> f64 {
    let mut least = f64::INFINITY;
    for pair in elements.iter().flat_map(|element| element.windows(2)) {
        least = least.min(distance_to_segment(
            at,
            nodes[pair[0]].at,
            nodes[pair[1]].at,
        ));
        if least <= enough {
            break;
        }
    }
    least
}

/// Diagonal of the bounding box of nodes; 0 without nodes.
/// Whether all nodes of a chain's elements lie in order on the line from the first to the last; `length` is the scene's.
pub(crate) fn straight(nodes: &[Node], elements: &[Vec<usize>], length: f64) -> bool {
    const OFF: f64 = 1e-9;
    let all: Vec<[f64; 2]> = elements.iter().flatten().map(|&n| nodes[n].at).collect();
    let (Some(&start), Some(&end)) = (all.first(), all.last()) else {
        return false;
    };
    let whole = distance(start, end);
    let along = [(end[0] - start[0]) / whole, (end[1] - start[1]) / whole];
    let off = |at: &[f64; 2]| {
        let to = minus(*at, start);
        cross(to, along).abs()
    };
    let place = |at: &[f64; 2]| (at[0] - start[0]) * along[0] + (at[1] - start[1]) * along[1];
    let tiny = OFF * length.max(whole);
    whole > 0.0
        && all.iter().all(|at| off(at) <= tiny)
        && all
            .windows(2)
            .all(|pair| place(&pair[1]) - place(&pair[0]) >= -tiny)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folds(points: &[[f64; 2]]) -> bool {
        super::folds(&slopes(points.len()), points)
    }

    #[test]
    fn even_curves_are_valid_and_folded_ones_are_not() {
        assert!(!folds(&[[0.0, 0.0], [1.0, 0.0]]));
        assert!(!folds(&[[-1.0, 0.0], [0.0, 1.0], [1.0, 0.0]]));
        assert!(!folds(&[[0.0, 0.0], [0.3, 0.0], [1.0, 0.0]]));
        assert!(
            folds(&[[0.0, 0.0], [0.2, 0.0], [1.0, 0.0]]),
            "runs back before it goes"
        );
        assert!(
            folds(&[[0.0, 0.0], [0.25, 0.0], [1.0, 0.0]]),
            "stands still at its start"
        );
        assert!(
            folds(&[[1.0, 0.0], [-1.0, 0.0], [1.0, 0.0]]),
            "goes and comes back"
        );
    }

    #[test]
    fn a_quadrilateral_is_valid_while_midside_nodes_are_in_the_middle_half_of_their_sides() {
        let with = |x: f64| {
            [
                [0.0, 0.0],
                [4.0, 0.0],
                [4.0, 2.0],
                [0.0, 2.0],
                [x, 0.0],
                [4.0, 1.0],
                [2.0, 2.0],
                [0.0, 1.0],
            ]
        };
        let folds = Folds::from_kind(ElementKind::Quad8);
        let is_folded = |nodes: &[[f64; 2]; 8]| folds.is_folded(nodes.iter().copied());
        assert!(!is_folded(&with(2.0)) && !is_folded(&with(1.2)));
        assert!(is_folded(&with(1.0)) && is_folded(&with(3.1)));
        assert!(is_folded(&[[0.0; 2]; 8]) && is_folded(&with(2.0).map(|[x, y]| [y, x])));
    }

    #[test]
    fn distance_to_a_segment_ends_at_its_ends() {
        let (a, b) = ([0.0, 0.0], [2.0, 0.0]);
        assert_eq!(distance_to_segment([1.0, 3.0], a, b), 3.0);
        assert_eq!(distance_to_segment([5.0, 4.0], a, b), 5.0);
        assert_eq!(distance_to_segment([0.0, 1.0], a, a), 1.0);
    }
}
