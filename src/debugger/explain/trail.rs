//! The last iterations of one contact: its force in the Coulomb cone, and T_max as a map from the value used to the value found.

use stickslip_core::plane::range;
use stickslip_core::{ContactRecord, Event, Friction, Mode};

/// Maximum number of iterations in a trail.
pub const LONGEST: usize = 12;

/// The iterations of a slave node in the attempt of the last event, oldest first, at most [`LONGEST`]; `events` runs backwards.
pub fn trail<'a>(events: impl Iterator<Item = &'a Event>, slave: usize) -> Vec<ContactRecord> {
    let mut attempt = None;
    let mut points: Vec<ContactRecord> = events
        .take_while(|event| {
            let at = (event.position.increment, event.position.attempt);
            *attempt.get_or_insert(at) == at
        })
        .map_while(|event| event.nodes.get(slave))
        .take(LONGEST)
        .copied()
        .collect();
    points.retain(|point| point.f_n.is_finite() && point.f_t.is_finite());
    points.reverse();
    points
}

/// The friction cone with the forces of a trail: F_t to the right, F_n upwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Cone {
    /// Largest |F_t| of the drawing.
    pub f_t: f64,
    /// Largest F_n of the drawing.
    pub f_n: f64,
    /// Smallest F_n of the drawing, at most 0.
    pub least: f64,
    /// The left edge of the cone from its tip outwards, as pairs (F_t, F_n); the right edge is its mirror image.
    pub edge: [[f64; 2]; 2],
}

impl Cone {
    /// A cone around these forces; `None` if none is larger than `drawn`.
    pub fn new(trail: &[ContactRecord], friction: &Friction, drawn: f64) -> Option<Cone> {
        let largest = |of: &dyn Fn(&ContactRecord) -> f64| trail.iter().map(of).fold(0.0, f64::max);
        let mu = friction.coefficient();
        let (f_n, f_t) = (largest(&|p| p.f_n), largest(&|p| p.f_t.abs()));
        let least = trail.iter().map(|p| p.f_n).fold(0.0, f64::min);
        // An attached solver may report no scale of forces.
        if f_n.max(f_t).max(-least) <= drawn.max(0.0) {
            return None;
        }
        // Without compression the cone is as high as the shear that it is compared with.
        let high = 1.15 * if f_n > 0.0 { f_n } else { f_t.max(-least) };
        let bound = mu * high + friction.cohesion;
        Some(Cone {
            f_t: 1.15 * f_t.max(bound).max(0.2 * high),
            f_n: high,
            least: 1.15 * least,
            edge: [[-friction.cohesion, 0.0], [-bound, high]],
        })
    }

    /// The cone with more room on one axis, so that both have the same scale in a drawing of this size, and the friction angle
    /// is true.
    #[must_use]
    pub fn to_scale(self, (width, height): (f64, f64), friction: &Friction) -> Cone {
        let scale = (0.5 * width / self.f_t).min(height / (self.f_n - self.least));
        // Not less by round-off.
        let f_n = (self.least + height / scale).max(self.f_n);
        let f_t = (0.5 * width / scale).max(self.f_t);
        let mu = friction.coefficient();
        let bound = mu * f_n + friction.cohesion;
        // The edge ends at the frame.
        let end = if bound > f_t {
            [-f_t, (f_t - friction.cohesion) / mu]
        } else {
            [-bound, f_n]
        };
        Cone {
            f_t,
            f_n,
            edge: [self.edge[0], end],
            ..self
        }
    }
}

/// Part of T_max below which the differences are drawn instead.
const CLOSE: f64 = 1e-2;

/// The cobweb of T_max: from the diagonal up to the value found, and across to the diagonal.
#[derive(Debug, Clone, PartialEq)]
pub struct Cobweb {
    /// What the values of the path are less, if they are close to each other; otherwise 0.
    pub origin: f64,
    /// Pairs of the value used and the value found.
    pub path: Vec<[f64; 2]>,
    /// The range of the path with a margin; `None` if T_max does not change by more than round-off.
    pub range: Option<[f64; 2]>,
}

/// The cobweb of a trail; `scale` is that of the forces.
pub fn cobweb(trail: &[ContactRecord], scale: f64) -> Cobweb {
    let points = trail
        .iter()
        .filter(|point| point.decision.before == Mode::Sliding);
    let steps: Vec<[f64; 2]> = points
        .map(|point| [point.t_max_used, point.t_max])
        .filter(|step| step.iter().all(|value| value.is_finite()))
        .collect();
    let last = steps.last().map_or(0.0, |step| step[1]);
    let origin = if steps
        .iter()
        .flatten()
        .any(|value| (value - last).abs() > CLOSE * last.abs())
    {
        0.0
    } else {
        last
    };
    let path = steps.into_iter().flat_map(|step| {
        let [used, found] = step.map(|value| value - origin);
        [[used, used], [used, found], [found, found]]
    });
    let path: Vec<[f64; 2]> = path.collect();
    let [low, high] = range(path.iter().flatten().copied());
    let margin = 0.06 * (high - low);
    Cobweb {
        origin,
        range: (high - low > 1e-12 * scale).then_some([low - margin, high + margin]),
        path,
    }
}

/// The factor by which the change of T_max shrinks (or grows) per iteration, from the last three values; `None` if unknown.
pub fn factor(trail: &[ContactRecord]) -> Option<f64> {
    let [.., one, two] = trail else { return None };
    let (before, now) = (one.t_max - one.t_max_used, two.t_max - two.t_max_used);
    let slide = [one, two].map(|point| point.decision.before) == [Mode::Sliding; 2];
    (slide && before.abs() > 0.0)
        .then_some(now / before)
        .filter(|factor| factor.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_core::ContactState;

    fn point(t_max_used: f64, t_max: f64) -> ContactRecord {
        let mode = Mode::Sliding;
        ContactRecord {
            f_n: 1.0,
            f_t: 0.2,
            t_max,
            t_max_used,
            ..ContactRecord::from_modes(mode, mode, &ContactState::default())
        }
    }

    #[test]
    fn the_cobweb_goes_from_the_diagonal_to_the_map_and_back() {
        let trail = [point(0.0, 1.0), point(1.0, 0.5)];
        let wanted = [
            [0.0, 0.0],
            [0.0, 1.0],
            [1.0, 1.0],
            [1.0, 1.0],
            [1.0, 0.5],
            [0.5, 0.5],
        ];
        let web = cobweb(&trail, 1.0);
        assert_eq!((web.origin, web.path), (0.0, wanted.to_vec()));
        assert_eq!(web.range, Some([-0.06, 1.06]));
        let close = cobweb(&[point(1.0, 1.001)], 1.0);
        assert_eq!((close.origin, close.path[2]), (1.001, [0.0, 0.0]));
        assert_eq!(cobweb(&[point(1.0, 1.0)], 1.0).range, None);
        assert_eq!(factor(&trail), Some(-0.5));
        assert_eq!(factor(&trail[..1]), None);
    }

    #[test]
    fn the_cone_contains_its_forces() {
        let friction = Friction {
            angle: 45.0,
            cohesion: 0.5,
        };
        let cone = Cone::new(&[point(0.0, 0.0)], &friction, 0.0).unwrap();
        assert!(cone.f_n > 1.0 && cone.f_t > 0.2 && cone.least == 0.0);
        assert_eq!(cone.edge[0], [-0.5, 0.0]);
        assert!((cone.edge[1][0] + cone.f_n + 0.5).abs() < 1e-9);
        let drawn = cone.clone().to_scale((300.0, 100.0), &friction);
        let per_unit = [150.0 / drawn.f_t, 100.0 / (drawn.f_n - drawn.least)];
        assert!((per_unit[0] / per_unit[1] - 1.0).abs() < 1e-12);
        assert!(drawn.f_t >= cone.f_t && drawn.f_n >= cone.f_n);
        assert!((drawn.edge[1][0] + drawn.f_n + 0.5).abs() < 1e-9);
        let high = cone.clone().to_scale((100.0, 300.0), &friction);
        assert_eq!(high.edge[1][0], -high.f_t);
        assert!((high.edge[1][1] - (high.f_t - 0.5)).abs() < 1e-9);
        let none = ContactRecord {
            f_n: 0.0,
            f_t: 0.0,
            ..point(0.0, 0.0)
        };
        assert_eq!(Cone::new(&[none], &friction, 0.0), None);
    }
}
