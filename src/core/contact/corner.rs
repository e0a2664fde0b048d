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
//! convex vertex the node stays as long as it slides down neither of the two sides, F·n_i >= 0 and F·t_i >= −(tan φ F·n_i +
//! c) with t_i from the vertex along side i: the same with −h in place of h. Where φ <= h no force does that, and the node
//! goes on to one of the sides.

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
/// Forces are within a bound up to this part of their size.
const ROUND_OFF: f64 = 1e-12;
/// Directions whose product is below this are perpendicular.
const PERPENDICULAR: f64 = 1e-12;

/// Half the angle between the normals of two sides that meet, in radians, from their tangents along the walk (of any
/// length): positive in a concave corner, negative at a convex vertex, 0 if they are straight.
pub fn half_angle(before: [f64; 2], behind: [f64; 2]) -> f64 {
    let turn = cross(before, behind).atan2(dot(before, behind));
    // Outside lies on the right of the walk.
    -0.5 * turn
}

/// Whether friction can keep a node on a convex vertex (`half` < 0): it must be steeper than the two sides.
pub fn holds(friction: &Friction, half: f64) -> bool {
    friction.angle.to_radians() + half > 0.0
}

/// Friction of a node in a corner or on a vertex that [`holds`] it, about the mean of the two normals; narrower than one
/// side's on a vertex.
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

/// The forces of two sides that add up to `force`, each within its side's cone, of which the sum of squares is least
/// (Cartesian force; friction leaves a choice, and this is the one that asks least of both). `None` if they cannot give it.
///
/// With F_1 = F/2 + d and F_2 = F/2 − d, d is the point closest to zero of a polygon: the sides' bounds are half-planes.
pub fn split(force: [f64; 2], sides: [&Side; 2]) -> Option<[[f64; 2]; 2]> {
    let half = force.map(|f| 0.5 * f);
    let signs = [1.0, -1.0];
    let bounds: Vec<([f64; 2], f64)> = (sides.iter().zip(signs))
        .flat_map(|(side, sign)| {
            // a·F_i <= b, with F_i = F/2 + sign d.
            side.bounds()
                .map(|(a, b)| (a.map(|x| sign * x), b - dot(a, half)))
        })
        .collect();
    let size = dot(force, force)
        .sqrt()
        .max(sides[0].cohesion)
        .max(sides[1].cohesion);
    let holds = |d: [f64; 2]| {
        bounds
            .iter()
            .all(|(a, b)| dot(*a, d) <= b + ROUND_OFF * size)
    };
    let feet = bounds.iter().map(|(a, b)| a.map(|x| x * b));
    let meets = bounds.iter().enumerate().flat_map(|(k, one)| {
        let rest = bounds[k + 1..].iter();
        rest.filter_map(move |other| crossing(*one, *other))
    });
    let all = std::iter::once([0.0; 2]).chain(feet).chain(meets);
    let d = all
        .filter(|d| holds(*d))
        .min_by(|a, b| dot(*a, *a).total_cmp(&dot(*b, *b)))?;
    Some([add(half, d, 1.0), add(half, d, -1.0)])
}

/// Where two lines a·x = b meet. `None` if they are parallel.
fn crossing(one: ([f64; 2], f64), other: ([f64; 2], f64)) -> Option<[f64; 2]> {
    let ((a, b), (c, d)) = (one, other);
    let area = cross(a, c);
    (area.abs() > PERPENDICULAR)
        .then(|| [(b * c[1] - d * a[1]) / area, (a[0] * d - c[0] * b) / area])
}

impl Side {
    /// The sides of a node that is held where two meet, in the order of the walk: `mean` is the mean of their normals, and
    /// `half` half the angle between them ([`half_angle`]).
    pub fn pair(mean: [f64; 2], half: f64, friction: &Friction) -> [Side; 2] {
        let turned = |angle: f64| {
            let (s, c) = angle.sin_cos();
            [c * mean[0] - s * mean[1], s * mean[0] + c * mean[1]]
        };
        [half, -half].map(|angle| Side {
            normal: turned(angle),
            coefficient: friction.coefficient(),
            cohesion: friction.cohesion,
        })
    }

    /// F_n and F_t of a Cartesian force on this side.
    pub fn components(&self, force: [f64; 2]) -> [f64; 2] {
        [dot(force, self.normal), dot(force, tangent(self.normal))]
    }

    /// Coulomb's law as half-planes a·F <= b, with a of length 1: F_n >= 0, and ±F_t <= tan φ F_n + c.
    fn bounds(&self) -> [([f64; 2], f64); 3] {
        let (n, t) = (self.normal, tangent(self.normal));
        let length = (1.0 + self.coefficient * self.coefficient).sqrt();
        let edge = |sign: f64| {
            let a = add(t.map(|x| sign * x), n, -self.coefficient);
            (a.map(|x| x / length), self.cohesion / length)
        };
        [(n.map(|x| -x), 0.0), edge(1.0), edge(-1.0)]
    }
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

pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
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
        let turn = |before, behind| half_angle(before, behind).to_degrees();
        assert!((turn([-1.0, -1.0], [-1.0, 1.0]) - 45.0).abs() < 1e-12);
        assert!((turn([-1.0, 1.0], [-1.0, -1.0]) + 45.0).abs() < 1e-12);
        assert_eq!(turn([1.0, 0.0], [1.0, 0.0]), 0.0);
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
    fn the_narrowed_friction_is_what_a_vertex_holds() {
        // A ridge with slopes of 15 degrees: normals at 75 and 105 degrees, walked from right to left.
        for (angle, cohesion) in [(20.0, 0.0), (40.0, 0.0), (30.0, 0.2)] {
            let friction = Friction { angle, cohesion };
            let half = -15_f64.to_radians();
            assert!(holds(&friction, half));
            let narrow = widened(&friction, half);
            let mu = friction.coefficient();
            let (before, behind) = (side(75.0, mu, cohesion), side(105.0, mu, cohesion));
            for f_n in [0.7, 3.0] {
                let limit = narrow.coefficient() * f_n + narrow.cohesion;
                for (part, held) in [
                    (0.999, true),
                    (-0.999, true),
                    (1.001, false),
                    (-1.001, false),
                ] {
                    let beyond = beyond_vertex([part * limit, f_n], &before, &behind);
                    assert_eq!(
                        beyond.cone <= 0.0,
                        held,
                        "{angle} {cohesion} {f_n} {part}: {beyond:?}"
                    );
                }
            }
        }
        let smooth = Friction {
            angle: 15.0,
            cohesion: 0.0,
        };
        assert!(!holds(&smooth, -15.1_f64.to_radians()));
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
    fn the_split_of_least_norm_lies_in_both_cones_and_no_other_split_is_shorter() {
        for (angle, phi, half, cohesion) in [
            (90.0, 20.0, 30.0, 0.0),
            (130.0, 20.0, 30.0, 0.0),
            (139.9, 20.0, 30.0, 0.0),
            (100.0, 0.0, 40.0, 0.0),
            (60.0, 15.0, 10.0, 0.8),
            (95.0, 40.0, -20.0, 0.0),
        ] {
            let friction = Friction {
                angle: phi,
                cohesion,
            };
            let sides = Side::pair([0.0, 1.0], f64::to_radians(half), &friction);
            let whole = force(angle, 2.0);
            let [one, other] = split(whole, [&sides[0], &sides[1]]).unwrap();
            let inside = |side: &Side, f: [f64; 2], slack: f64| {
                let [f_n, f_t] = side.components(f);
                f_n >= -slack && f_t.abs() <= side.coefficient * f_n + side.cohesion + slack
            };
            assert!(
                (one[0] + other[0] - whole[0]).abs() + (one[1] + other[1] - whole[1]).abs() < 1e-14
            );
            assert!(inside(&sides[0], one, 1e-11) && inside(&sides[1], other, 1e-11));
            let norm = dot(one, one) + dot(other, other);
            for (i, j) in (-60..=60).flat_map(|i| (-60..=60).map(move |j| (i, j))) {
                let d = [0.05 * f64::from(i), 0.05 * f64::from(j)];
                let (f, g) = (d, add(whole, d, -1.0));
                if inside(&sides[0], f, 0.0) && inside(&sides[1], g, 0.0) {
                    assert!(
                        dot(f, f) + dot(g, g) >= norm - 1e-9,
                        "{angle} {phi}: {f:?} {g:?}"
                    );
                }
            }
        }
        let smooth = Friction {
            angle: 0.0,
            cohesion: 0.0,
        };
        let sides = Side::pair([0.0, 1.0], f64::to_radians(30.0), &smooth);
        assert_eq!(split(force(121.0, 1.0), [&sides[0], &sides[1]]), None);
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
