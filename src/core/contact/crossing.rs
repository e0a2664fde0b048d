//! Concave corners between two surfaces: where the chains of two rigid surfaces cross, both press on a node that may touch them.
//!
//! A node that has passed through one of its surfaces may be closer to a far part of the other one. Its correct position is the
//! corner where the two cross, x_1(ξ_1) = x_2(ξ_2). The crossing is a corner if each chain continues on the outside of the other
//! one; the ends of two chains that meet at a convex edge are not.
//!
//! The corner holds a node like one within a chain ([`crate::contact::corner`]), with the force assigned to the first surface.
//! That is valid only for rigid surfaces, whose supports carry it; corners between other surfaces are not supported.

use crate::contact::projection::{STRAIGHT, blend, right_of};
use crate::model::Surface;
use crate::plane::{cross, dot, length, minus, plus, unit};
use crate::{SurfaceElement, SurfacePoint};

/// Maximum number of Newton steps; straight chains need one.
const STEPS: usize = 20;
/// Distance of two points, relative to the elements, below which they coincide.
const CLOSED: f64 = 1e-12;
/// Directions with a smaller product are parallel.
const PARALLEL: f64 = 1e-9;

/// The crossing of two chains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// The crossing point on each surface.
    pub spots: [SurfacePoint; 2],
    /// Outward normal of each (unit).
    pub normals: [[f64; 2]; 2],
    /// Half the angle between the normals (radians).
    pub half: f64,
}

impl Crossing {
    /// Mean of the two normals (unit).
    pub fn normal(&self) -> [f64; 2] {
        let [a, b] = self.normals;
        unit(plus(a, b)).unwrap_or(a)
    }
}

/// The concave corner in which the elements of two surface points cross. `None` if they do not cross, or not in a concave corner.
pub fn find(
    surfaces: &[Surface],
    spots: [SurfacePoint; 2],
    positions: &[[f64; 2]],
) -> Option<Crossing> {
    let elements =
        spots.map(|spot| SurfaceElement::from_surface(&surfaces[spot.surface], spot.element));
    let endless = spots.map(|spot| surfaces[spot.surface].endless);
    let mut xi = spots.map(|spot| spot.xi);
    let mut at = [[0.0; 2]; 2];
    let mut slopes = [[0.0; 2]; 2];
    for _ in 0..STEPS {
        for k in 0..2 {
            let s = elements[k].shape(xi[k]);
            at[k] = blend(elements[k].nodes, positions, &s.n);
            slopes[k] = blend(elements[k].nodes, positions, &s.d);
        }
        let area = cross(slopes[0], slopes[1]);
        if area.abs() <= PARALLEL * length(slopes[0]) * length(slopes[1]) {
            return None;
        }
        let away = [at[1][0] - at[0][0], at[1][1] - at[0][1]];
        if length(away) <= CLOSED * (length(slopes[0]) + length(slopes[1])) {
            break;
        }
        xi[0] += cross(away, slopes[1]) / area;
        xi[1] += cross(away, slopes[0]) / area;
    }
    let away = [at[1][0] - at[0][0], at[1][1] - at[0][1]];
    let met = length(away) <= CLOSED * (length(slopes[0]) + length(slopes[1]));
    let within = |k: usize| endless[k] || xi[k].abs() <= 1.0;
    let normals = slopes.map(right_of);
    // The outer part of a chain lies on the outside of the other.
    let goes_on = |k: usize| {
        let other = normals[1 - k];
        endless[k]
            || [-1.0, 1.0].into_iter().any(|end| {
                let there = blend(elements[k].nodes, positions, &elements[k].shape(end).n);
                let out = minus(there, at[k]);
                dot(out, other) > PARALLEL * length(slopes[k])
            })
    };
    let turn = cross(normals[0], normals[1]).abs();
    let half = 0.5 * turn.atan2(dot(normals[0], normals[1]));
    let is_corner = met && within(0) && within(1) && goes_on(0) && goes_on(1) && half > STRAIGHT;
    is_corner.then(|| Crossing {
        spots: [0, 1].map(|k| SurfacePoint {
            xi: xi[k],
            ..spots[k]
        }),
        normals,
        half,
    })
}

/// Whether two surfaces whose ends coincide (0: the start, 1: the end of each) form a concave corner there: past it, each would
/// continue inside the other.
pub fn ends_in_corner(surfaces: [&Surface; 2], ends: [usize; 2], positions: &[[f64; 2]]) -> bool {
    let slopes = [0, 1].map(|k| end_slope(surfaces[k], ends[k], positions));
    let normals = slopes.map(right_of);
    let half = 0.5
        * cross(normals[0], normals[1])
            .abs()
            .atan2(dot(normals[0], normals[1]));
    let enters = |k: usize| {
        let along = dot(slopes[k], normals[1 - k]) / length(slopes[k]);
        let out = if ends[k] == 0 { -along } else { along };
        out < -PARALLEL
    };
    enters(0) && enters(1) && half > STRAIGHT
}

/// dx/dξ at an end of a surface (0: its start).
pub fn end_slope(surface: &Surface, end: usize, positions: &[[f64; 2]]) -> [f64; 2] {
    let (number, xi) = match end {
        0 => (0, -1.0),
        _ => (surface.elements.len() - 1, 1.0),
    };
    let element = SurfaceElement::from_surface(surface, number);
    blend(element.nodes, positions, &element.shape(xi).d)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(name: &str, nodes: [usize; 2]) -> Surface {
        Surface::new(name, vec![nodes.to_vec()], true)
    }

    fn spots() -> [SurfacePoint; 2] {
        [0, 1].map(|surface| SurfacePoint {
            surface,
            element: 0,
            xi: 0.3,
        })
    }

    #[test]
    fn a_floor_and_a_wall_cross_in_a_corner_and_the_sides_of_a_block_do_not() {
        // A floor walked towards −x, and a wall on its right walked downwards, whose outward side is −x.
        let x = [[3.0, 0.0], [-1.0, 0.0], [1.0, 2.0], [1.0, -1.0]];
        let both = [surface("floor", [0, 1]), surface("wall", [2, 3])];
        let found = find(&both, spots(), &x).unwrap();
        assert!((found.half.to_degrees() - 45.0).abs() < 1e-12);
        assert!(
            (found.spots[0].xi - 0.0).abs() < 1e-15
                && (found.spots[1].xi - 1.0 / 3.0).abs() < 1e-15
        );
        let n = found.normal();
        assert!(n[0] < 0.0 && n[1] > 0.0 && (n[0] + n[1]).abs() < 1e-15);
        // The top of a block and its right side, which end where they meet, at (1, 0).
        let x = [[1.0, 0.0], [-1.0, 0.0], [1.0, -2.0], [1.0, 0.0]];
        assert_eq!(find(&both, spots(), &x), None);
        // Parallel, and at a distance.
        let x = [[1.0, 0.0], [-1.0, 0.0], [1.0, -1.0], [-1.0, -1.0]];
        assert_eq!(find(&both, spots(), &x), None);
        let x = [[3.0, 0.0], [2.0, 0.0], [1.0, 2.0], [1.0, -1.0]];
        assert_eq!(find(&both, spots(), &x), None);
    }
}
