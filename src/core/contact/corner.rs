//! Forces that two sides of a master together can exert where they meet at an angle.
//!
//! On a side with normal n and tangent t (n turned 90 degrees anticlockwise) Coulomb's law allows the forces { F_n n + F_t t :
//! F_n >= 0, |F_t| <= tan φ F_n + c }, a cone that cohesion widens by the segment ±c t. In a concave corner both sides press on
//! the node, and the force is the sum of one force from each cone. With h, half the angle between the two normals, and the mean
//! normal as n, this is again the cone of a single side, with
//!
//! ```text
//! |F_t| <= tan(φ + h) F_n + c cos φ / cos(φ + h)
//! ```
//!
//! This holds for φ + h < 90 degrees. The two sides share the cohesion c: without pressure, the admissible forces are the convex
//! hull of the segments ±c t of both sides. Their sum would give 2 c at a straight border.
//!
//! If a node has slid along side A into the corner since the last accepted state, the friction of A was at its limit. Further
//! loading can only rotate the force towards the limit of the far side B, where the node slides out along B. With s = ±1 the
//! direction along t of the friction that opposes the slip:
//!
//! ```text
//! tan(φ − h) F_n + c cos φ / cos(φ − h) <= s F_t <= tan(φ + h) F_n + c cos φ / cos(φ + h)
//! ```
//!
//! and the force lies in the convex hull of the limit forces of A and B, so that s F_t >= c cos h if φ > h. For h → 0 this is
//! Coulomb's law of a sliding node. Force as a function of slip is continuous: the force is at the lower bound on A and at the
//! upper bound on B.
//!
//! On a convex vertex the node stays as long as it slides down neither side, F·n_i >= 0 and F·t_i >= −(tan φ F·n_i + c) with t_i
//! pointing from the vertex along side i: this is the law above with −h instead of h. If φ <= h, no force satisfies it, and the
//! node moves to one of the sides.

use crate::Friction;
use crate::plane::{cross, dot, unit};

/// A side of a master at a point, with its friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    /// Outward normal (unit).
    pub normal: [f64; 2],
    /// tan φ.
    pub coefficient: f64,
    /// Cohesion c (force).
    pub cohesion: f64,
}

/// Largest φ + h in degrees; beyond it, the corner resists every force without tension.
const STEEPEST: f64 = 89.999;
/// Forces may exceed a bound by this fraction of their magnitude.
const ROUND_OFF: f64 = 1e-12;
/// Directions with a smaller product are perpendicular.
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

/// Friction of a node in a corner or on a vertex that [`holds`] it, about the mean of the two normals; on a vertex it is narrower
/// than that of one side.
pub fn widened(friction: &Friction, half: f64) -> Friction {
    let angle = (friction.angle + half.to_degrees()).min(STEEPEST);
    Friction {
        angle,
        cohesion: friction.cohesion * friction.angle.to_radians().cos() / angle.to_radians().cos(),
    }
}

/// Lower bound of the friction s F_t (force, positive against the slip) of a node that slid into a corner of half angle `half`
/// (radians) under the normal force `f_n`. Below it the node slides back along the side it came from, which has this `friction`.
/// F_n and F_t refer to the mean of the two normals.
pub fn least_friction(friction: &Friction, half: f64, f_n: f64) -> f64 {
    let slope = (friction.angle.to_radians() - half).tan();
    let (sin, cos) = half.sin_cos();
    let pressed = f_n - friction.cohesion * sin;
    // The hull of both cohesion segments does not extend to tension on the side.
    let pressed = if slope > 0.0 {
        pressed.max(0.0)
    } else {
        pressed
    };
    friction.cohesion * cos + slope * pressed
}

/// Distance (force) of a force on the node from the convex hull of the forces that each side alone admits; zero or negative
/// inside the hull.
pub fn beyond_corner(force: [f64; 2], sides: [&Side; 2]) -> f64 {
    beyond_hull(force, sides, &[1.0, -1.0])
}

/// Like [`beyond_corner`], for a node that slid along the first side into the corner. The friction of both sides is at its
/// limit in the direction `against` the slip (±1, along t), and the friction on the first side is at least its limit.
pub fn beyond_slid(force: [f64; 2], [along, far]: [&Side; 2], against: f64) -> f64 {
    let [f_n, f_t] = along.components(force);
    let lacks = along.coefficient * f_n + along.cohesion - against * f_t;
    let length = (1.0 + along.coefficient * along.coefficient).sqrt();
    beyond_hull(force, [along, far], &[against]).max(lacks / length)
}

/// Distance (force) of a force from the convex hull of the rays { F_n n + sign (tan φ F_n + c) t : F_n >= 0 } of both sides;
/// zero or negative inside the hull.
fn beyond_hull(force: [f64; 2], sides: [&Side; 2], signs: &[f64]) -> f64 {
    let edges = || {
        sides
            .iter()
            .flat_map(|side| signs.iter().map(move |&sign| (side, sign)))
    };
    let rays = || {
        edges().filter_map(|(side, sign)| {
            let t = tangent(side.normal);
            unit(add(side.normal, t, sign * side.coefficient))
        })
    };
    let starts =
        || edges().map(|(side, sign)| tangent(side.normal).map(|t| sign * side.cohesion * t));
    // The hull of the starts has edges along the mean normal and across it. Where the rays are nearly parallel, only these
    // edges detect tension.
    let mean = unit(add(sides[0].normal, sides[1].normal, 1.0));
    rays()
        .chain(mean)
        .chain(mean.map(tangent))
        .flat_map(|line| [tangent(line), tangent(line).map(|x| -x)])
        .filter(|&u| rays().all(|ray| dot(u, ray) <= PERPENDICULAR))
        .fold(f64::NEG_INFINITY, |worst, u| {
            let reach = starts().fold(f64::NEG_INFINITY, |most, start| most.max(dot(u, start)));
            worst.max(dot(u, force) - reach)
        })
}

/// Splits `force` (Cartesian) into two forces within the cones of their sides, with the least sum of squares, because friction
/// makes the split ambiguous. `None` if the sides cannot give the force.
///
/// With F_1 = F/2 + d and F_2 = F/2 − d, d is the point of a polygon closest to zero: the sides' bounds are half-planes.
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
        bounds[k + 1..]
            .iter()
            .filter_map(move |other| crossing(*one, *other))
    });
    let d = std::iter::once([0.0; 2])
        .chain(feet)
        .chain(meets)
        .filter(|d| holds(*d))
        .min_by(|a, b| dot(*a, *a).total_cmp(&dot(*b, *b)))?;
    Some([add(half, d, 1.0), add(half, d, -1.0)])
}

/// Intersection of two lines a·x = b. `None` if they are parallel.
fn crossing(one: ([f64; 2], f64), other: ([f64; 2], f64)) -> Option<[f64; 2]> {
    let ((a, b), (c, d)) = (one, other);
    let area = cross(a, c);
    (area.abs() > PERPENDICULAR)
        .then(|| [(b * c[1] - d * a[1]) / area, (a[0] * d - c[0] * b) / area])
}

impl Side {
    /// The sides of a node held where two sides meet, in walking order: `mean` is the mean of their normals, and `half` half the
    /// angle between them ([`half_angle`]).
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

/// How much a force exceeds the limits for staying on a convex vertex: it must press on both sides (`tension`), and the friction
/// of each side must prevent sliding down (`cone`). `before` is the first side in walking order.
pub fn beyond_vertex(force: [f64; 2], before: &Side, behind: &Side) -> CornerViolation {
    let mut beyond = CornerViolation::default();
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

/// Violations of two laws (force; 0 if satisfied).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CornerViolation {
    /// Tension on one of the sides.
    pub tension: f64,
    /// Excess over the friction bound of one of the sides.
    pub cone: f64,
}

fn tangent(normal: [f64; 2]) -> [f64; 2] {
    [-normal[1], normal[0]]
}

fn add(a: [f64; 2], b: [f64; 2], times: f64) -> [f64; 2] {
    [a[0] + times * b[0], a[1] + times * b[1]]
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
    fn a_right_turn_is_a_concave_corner_and_a_left_turn_is_not() {
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
            let beyond = beyond_corner(force(angle, 2.0), [&walls[0], &walls[1]]);
            assert_eq!(beyond <= 0.0, inside, "{angle}: {beyond}");
        }
        let off = beyond_corner(force(39.0, 2.0), [&walls[0], &walls[1]]);
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
        // When the node leaves along the second side, only that side exerts a force, with friction and cohesion opposing the
        // motion.
        let side = side(60.0, mu, c);
        let t = tangent(side.normal);
        for f_n in [0.5, 2.0] {
            let f = add(
                [f_n * side.normal[0], f_n * side.normal[1]],
                t,
                -(mu * f_n + c),
            );
            // The walk runs from right to left: t of the mean normal is −x.
            let (mean_n, mean_t) = (f[1], -f[0]);
            let limit = wide.limit(mean_n);
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
                let limit = narrow.limit(f_n);
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
    fn after_a_slip_the_force_lies_between_the_opposing_edges_of_both_cones() {
        for (phi, half) in [
            (20.0, 30.0),
            (30.0, 5.0),
            (70.0, 40.0),
            (31.0, 1e-6),
            (0.0, 10.0),
        ] {
            let mu = f64::to_radians(phi).tan();
            // The walk runs from right to left: first `before`, then `behind`. The node slid along t, so friction acts along −t.
            let [before, behind] = [side(90.0 + half, mu, 0.0), side(90.0 - half, mu, 0.0)];
            let step = 0.25 * half;
            for (angle, inside) in [
                (half - phi - step, true),
                (-phi, true),
                (-half - phi + step, true),
                (half - phi + step, false),
                (-half - phi - step, false),
            ] {
                let whole = force(90.0 + angle, 1.0);
                let beyond = beyond_slid(whole, [&before, &behind], -1.0);
                assert_eq!(beyond <= 1e-15, inside, "{phi} {half} {angle}: {beyond}");
                let mirrored = beyond_slid([-whole[0], whole[1]], [&behind, &before], 1.0);
                assert!((mirrored - beyond).abs() < 1e-15);
            }
            // Tension is detected even where the two sides are nearly parallel.
            for angle in [270.0, 270.0 - phi] {
                assert!(beyond_slid(force(angle, 1.0), [&before, &behind], -1.0) > 0.3);
            }
        }
    }

    #[test]
    fn friction_after_a_slip_is_between_the_least_friction_and_the_corner_bound() {
        for (angle, half, cohesion) in [
            (20.0, 30.0, 0.4),
            (30.0, 20.0, 0.4),
            (30.0, 1e-6, 0.4),
            (0.0, 5.0, 0.2),
            (12.0, 12.0, 0.0),
        ] {
            let (friction, half) = (Friction { angle, cohesion }, f64::to_radians(half));
            let [before, behind] = Side::pair([0.0, 1.0], half, &friction);
            let wide = widened(&friction, half);
            for f_n in [0.0, 0.05, 0.3, 2.0] {
                let least = least_friction(&friction, half, f_n);
                let most = wide.limit(f_n);
                // The walk runs from right to left: t of the mean normal is −x.
                let beyond = |f_t: f64| beyond_slid([-f_t, f_n], [&before, &behind], -1.0);
                let off = 1e-9;
                for (f_t, inside) in [
                    (least - off, false),
                    (least + 0.5 * (most - least).min(off), true),
                    (most - 0.5 * (most - least).min(off), true),
                    (most + off, false),
                ] {
                    let beyond = beyond(-f_t);
                    assert_eq!(
                        beyond <= 1e-12,
                        inside,
                        "{friction:?} {half} {f_n} {f_t}: {beyond}"
                    );
                }
            }
        }
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

    /// Parallel sides act as a single side: the cohesion counts once.
    #[test]
    fn two_sides_share_their_cohesion_in_a_corner() {
        for half in [0.0, 1e-9, 5.0, 30.0] {
            let walls = [side(90.0 + half, 0.3, 0.5), side(90.0 - half, 0.3, 0.5)];
            let edge = tangent(walls[0].normal).map(|t| 0.5 * t);
            assert!(beyond_corner(edge, [&walls[0], &walls[1]]) < 1e-15);
            let more = beyond_corner(add(edge, [1.0, 0.0], -0.01), [&walls[0], &walls[1]]);
            assert!(more > 5e-3, "{half}: {more}");
            // Where φ > h, the cohesion of this side alone can hold a node that slid in along the other side.
            let slid = beyond_slid(edge, [&walls[1], &walls[0]], 1.0);
            assert_eq!(slid < 1e-15, half < 10.0, "{half}: {slid}");
        }
        let smooth = [side(90.0 + 1e-8, 0.0, 0.0), side(90.0 - 1e-8, 0.0, 0.0)];
        let pull = beyond_corner([0.0, -1.0], [&smooth[0], &smooth[1]]);
        assert!((pull - 1.0).abs() < 1e-12, "{pull}");
    }

    #[test]
    fn a_vertex_holds_a_node_only_if_friction_prevents_sliding_down_either_side() {
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
