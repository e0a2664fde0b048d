//! Where two sides of a master meet at an angle: which forces both together can give.
//!
//! On a side with normal n and tangent t (n turned 90 degrees anticlockwise) Coulomb's law allows the forces
//! { F_n n + F_t t : F_n >= 0, |F_t| <= tan φ F_n + c }, a cone that cohesion widens by the segment ±c t. In a concave
//! corner a node is pressed by both sides at once, and the force is a sum of one from each cone. With h, half the angle
//! between the two normals, and the mean normal as n, that is the cone of one side again, with
//!
//! ```text
//! |F_t| <= tan(φ + h) F_n + c cos φ / cos(φ + h)
//! ```
//!
//! This holds for φ + h < 90 degrees, and only the side along which the node leaves the corner contributes cohesion. On a
//! convex vertex the node stays as long as it slides down neither of the two sides.

use crate::model::Friction;

/// A side of a master at a point of it, with the friction there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    /// Outward normal (unit).
    pub normal: [f64; 2],
    /// tan φ.
    pub coefficient: f64,
    /// Cohesion c (force).
    pub cohesion: f64,
}

/// Largest φ + h, in degrees: beyond, the corner holds whatever does not pull.
const STEEPEST: f64 = 89.999;
/// Directions whose product is below this are perpendicular.
const PERPENDICULAR: f64 = 1e-12;

/// Half the angle between two sides where they form a concave corner, in radians, from their tangents along the walk (of
/// any length). `None` if they are straight or convex.
pub fn concave(before: [f64; 2], behind: [f64; 2]) -> Option<f64> {
    let turn = cross(before, behind).atan2(dot(before, behind));
    // Outside lies on the right of the walk.
    (turn < 0.0).then(|| -0.5 * turn)
}

/// Friction of a node in a concave corner, about the mean of the two normals.
pub fn widened(friction: &Friction, half: f64) -> Friction {
    let angle = (friction.angle + half.to_degrees()).min(STEEPEST);
    Friction {
        angle,
        cohesion: friction.cohesion * friction.angle.to_radians().cos() / angle.to_radians().cos(),
    }
}

/// By how much a force on the node exceeds what two sides can give together, as a sum of one force from each (force; zero
/// or negative if they can give it). `mobilised` is, for each side whose friction is at its limit, the direction of that
/// friction along the side's t (±1).
pub fn beyond_sum(force: [f64; 2], sides: [&Side; 2], mobilised: [Option<f64>; 2]) -> f64 {
    let mut rays = [[0.0; 2]; 4];
    // Segments ±c t, or the point that is left of one.
    let (mut segments, mut point) = ([[0.0; 2]; 2], [0.0; 2]);
    for (k, side) in sides.iter().enumerate() {
        let (n, t) = (side.normal, tangent(side.normal));
        let edge = |sign: f64| add(n, t, sign * side.coefficient);
        match mobilised[k] {
            Some(sign) => {
                (rays[2 * k], rays[2 * k + 1]) = (edge(sign), edge(sign));
                point = add(point, t, sign * side.cohesion);
            }
            None => {
                (rays[2 * k], rays[2 * k + 1]) = (edge(1.0), edge(-1.0));
                segments[k] = [side.cohesion * t[0], side.cohesion * t[1]];
            }
        }
    }
    let lines = rays.iter().chain(&segments).filter_map(|&line| unit(line));
    let normals = lines.flat_map(|line| [tangent(line), tangent(line).map(|x| -x)]);
    let bounds = normals.filter(|&u| {
        let mut all = rays.iter().filter_map(|&ray| unit(ray));
        all.all(|ray| dot(u, ray) <= PERPENDICULAR)
    });
    let rest = add(force, point, -1.0);
    bounds.fold(f64::NEG_INFINITY, |worst, u| {
        let reach: f64 = segments.iter().map(|&s| dot(u, s).abs()).sum();
        worst.max(dot(u, rest) - reach)
    })
}

/// By how much a force exceeds what keeps a node on a convex vertex: it must press on both sides (`tension`), and the
/// friction of each side must keep it from sliding down there (`cone`). `before` is the side that comes first along the
/// walk.
pub fn beyond_vertex(force: [f64; 2], before: &Side, behind: &Side) -> Beyond {
    let mut beyond = Beyond::default();
    for (side, away) in [(before, -1.0), (behind, 1.0)] {
        let (f_n, f_t) = (
            dot(force, side.normal),
            away * dot(force, tangent(side.normal)),
        );
        beyond.tension = beyond.tension.max(-f_n);
        beyond.cone = beyond
            .cone
            .max(-f_t - (side.coefficient * f_n + side.cohesion));
    }
    beyond
}

/// By how much a force breaks two laws (force, not negative; 0 where it obeys).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beyond {
    /// By how much it pulls on one of the sides.
    pub tension: f64,
    /// By how much it exceeds the friction of one of the sides.
    pub cone: f64,
}

fn tangent(normal: [f64; 2]) -> [f64; 2] {
    [-normal[1], normal[0]]
}

fn add(a: [f64; 2], b: [f64; 2], times: f64) -> [f64; 2] {
    [a[0] + times * b[0], a[1] + times * b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn unit(v: [f64; 2]) -> Option<[f64; 2]> {
    let length = dot(v, v).sqrt();
    (length > 0.0).then(|| [v[0] / length, v[1] / length])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn side(angle: f64, coefficient: f64, cohesion: f64) -> Side {
        let a = f64::to_radians(angle);
        Side {
            normal: [a.cos(), a.sin()],
            coefficient,
            cohesion,
        }
    }

    fn force(angle: f64, size: f64) -> [f64; 2] {
        let a = f64::to_radians(angle);
        [size * a.cos(), size * a.sin()]
    }

    #[test]
    fn a_turn_to_the_right_is_a_concave_corner_and_one_to_the_left_is_none() {
        let half = concave([-1.0, -1.0], [-1.0, 1.0]).unwrap();
        assert!((half.to_degrees() - 45.0).abs() < 1e-12);
        assert_eq!(concave([-1.0, 1.0], [-1.0, -1.0]), None);
        assert_eq!(concave([1.0, 0.0], [1.0, 0.0]), None);
    }

    #[test]
    fn a_corner_gives_the_forces_between_the_outer_edges_of_both_cones() {
        // Walls whose normals are 30 degrees to each side of up, with 20 degrees of friction: from 40 to 140 degrees.
        let mu = 20_f64.to_radians().tan();
        let walls = [side(60.0, mu, 0.0), side(120.0, mu, 0.0)];
        for (angle, inside) in [
            (41.0, true),
            (90.0, true),
            (139.0, true),
            (39.0, false),
            (141.0, false),
        ] {
            let beyond = beyond_sum(force(angle, 2.0), [&walls[0], &walls[1]], [None, None]);
            assert_eq!(beyond <= 0.0, inside, "{angle}: {beyond}");
        }
        let off = beyond_sum(force(39.0, 2.0), [&walls[0], &walls[1]], [None, None]);
        assert!((off - 2.0 * 1_f64.to_radians().sin()).abs() < 1e-12);
    }

    #[test]
    fn the_widened_friction_is_the_cone_of_the_corner() {
        let friction = Friction {
            angle: 20.0,
            cohesion: 0.3,
        };
        let wide = widened(&friction, 30_f64.to_radians());
        let (mu, c) = (friction.coefficient(), friction.cohesion);
        // Leaving along the side behind, only that one gives force, friction and cohesion against it.
        let side = side(60.0, mu, c);
        let t = tangent(side.normal);
        for f_n in [0.5, 2.0] {
            let f = add(
                [f_n * side.normal[0], f_n * side.normal[1]],
                t,
                -(mu * f_n + c),
            );
            // Walked from right to left: t of the mean normal is −x.
            let (mean_n, mean_t) = (f[1], -f[0]);
            let limit = wide.coefficient() * mean_n + wide.cohesion;
            assert!((mean_t + limit).abs() < 1e-12, "{mean_t} {limit}");
        }
    }

    #[test]
    fn friction_that_is_mobilised_narrows_the_cone_of_its_side() {
        let mu = 20_f64.to_radians().tan();
        let walls = [side(60.0, mu, 0.0), side(120.0, mu, 0.0)];
        // It slid down the wall before the corner along t (210 degrees): friction points to 30, and the force of that wall to
        // 100 degrees; the corner gives nothing steeper on that side.
        let beyond = |angle: f64, mobilised: f64| {
            let both = [&walls[1], &walls[0]];
            beyond_sum(force(angle, 1.0), both, [Some(mobilised), None])
        };
        assert!(beyond(41.0, -1.0) <= 0.0 && beyond(99.0, -1.0) <= 0.0);
        assert!(beyond(39.0, -1.0) > 0.0 && beyond(101.0, -1.0) > 0.0);
        // With friction the other way that wall gives 140 degrees.
        assert!(beyond(101.0, 1.0) <= 0.0 && beyond(139.0, 1.0) <= 0.0 && beyond(141.0, 1.0) > 0.0);
    }

    #[test]
    fn cohesion_of_both_sides_carries_in_a_corner() {
        let walls = [side(60.0, 0.0, 0.5), side(120.0, 0.0, 0.5)];
        let pull = add([0.0, 0.0], tangent(walls[0].normal), 0.5);
        let both = add(pull, tangent(walls[1].normal), 0.5);
        assert!(beyond_sum(both, [&walls[0], &walls[1]], [None, None]) < 1e-15);
        let more = add(both, [1.0, 0.0], -0.01);
        assert!(beyond_sum(more, [&walls[0], &walls[1]], [None, None]) > 1e-3);
    }

    #[test]
    fn a_rough_vertex_holds_what_slides_down_neither_side_and_a_smooth_one_nothing() {
        // A ridge with slopes of 15 degrees: normals at 75 and 105 degrees, walked from right to left.
        for (angle, holds) in [(20.0, true), (10.0, false), (0.0, false)] {
            let mu = f64::to_radians(angle).tan();
            let (before, behind) = (side(75.0, mu, 0.0), side(105.0, mu, 0.0));
            let beyond = beyond_vertex(force(90.0, 1.0), &before, &behind);
            assert_eq!(beyond.cone <= 0.0, holds, "{angle}: {beyond:?}");
            assert_eq!(beyond.tension, 0.0);
        }
        let (before, behind) = (side(75.0, 9.0, 0.0), side(105.0, 9.0, 0.0));
        assert!(beyond_vertex(force(0.0, 1.0), &before, &behind).tension > 0.0);
    }
}
