//! Measures how fast a scene moves, to detect increments that may have jumped.
//!
//! A pace applies to a direction of loading. Over a span of the load factor, load k changes by Δ_k, relative to its largest value.
//! Two spans have the same direction if their vectors Δ are parallel; the expected motion is then proportional to |Δ|. At a corner
//! of the path or a kink in the scale of a load the direction changes, and the previous increments predict nothing.
//!
//! An increment is suspected if its motion is more than `RATIO` times the prediction of its tangent, or than the motion of the
//! fastest previous increment. It is also suspected if the tangent did not hold (its correction is more than `OFF` of its
//! prediction) and the motion is more than `FASTER` times that of the previous increment. This criterion detects a limit point
//! after a soft stretch, where the tangent and the fastest increment both predict large motions. If increments are not cut, halves
//! cannot confirm a jump, and the fastest previous increment is ignored: a node that starts to slide is not a jump.

use crate::model::Factor;
use crate::plane::max_abs;
use crate::{Model, SubIncrement};
use serde::{Deserialize, Serialize};

/// Maximum ratio of the motion of an increment to the expected motion, beyond which it is suspected.
pub const RATIO: f64 = 4.0;

/// The same if the halves of a suspected increment have failed: there is less doubt.
const RATIO_OVER: f64 = 2.0;
/// Maximum ratio of the motion of an increment whose tangent does not hold to the motion of the previous increment.
const FASTER: f64 = 2.5;
/// A tangent holds if its corrections sum to at most this fraction of its prediction.
const OFF: f64 = 0.5;
/// Minimum cosine of the angle between two changes of the loads that count as parallel.
const PARALLEL: f64 = 0.999;
/// Rates of loading that differ by less than this fraction count as equal.
const SAME: f64 = 1e-9;

/// Record of how fast the scene moves.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Pace {
    /// Largest displacement of the first major iteration of the current attempt.
    pub predicted: f64,
    /// Sum of the largest displacements of the later major iterations (length).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub corrected: f64,
    /// Largest displacement per unit load factor of the fastest accepted increment since the last jump, converted to the loading
    /// over `span`.
    pub fastest: f64,
    /// Largest displacement per unit load factor of the last accepted increment.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub last: f64,
    /// Load factors at the start and end of the last accepted increment.
    #[serde(default, skip_serializing_if = "is_at_zero")]
    pub span: [f64; 2],
    /// The suspected increment that the current one is a part of.
    pub suspect: Option<SuspectIncrement>,
    /// Whether its halves have failed, so that it is no longer cut on suspicion.
    pub over: bool,
}

/// An increment that moved more than expected.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SuspectIncrement {
    /// Its largest displacement.
    pub motion: f64,
    /// Its size.
    pub size: f64,
    /// Where it ends.
    #[serde(rename = "piece")]
    pub sub_increment: SubIncrement,
}

/// Expected motions of an increment (length), by the tangent and by the previous increments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ExpectedMotion {
    /// Predicted by the tangent; 0 without a prediction.
    tangent: f64,
    /// Whether the tangent held.
    holds: bool,
    /// Predicted by the fastest previous increment, and by the last increment. `None` if they were loaded in another direction.
    before: Option<[f64; 2]>,
    ratio: f64,
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

fn is_at_zero(span: &[f64; 2]) -> bool {
    *span == [0.0; 2]
}

impl Pace {
    /// The pace without the fields added after the first journals: digests of states cover the older fields only
    /// ([`State::digested`]).
    ///
    /// [`State::digested`]: crate::step::state::State::digested
    pub(super) fn digested(self) -> Pace {
        Pace {
            corrected: 0.0,
            last: 0.0,
            span: [0.0; 2],
            ..self
        }
    }

    /// Computes the expected motions over a span of the load factor.
    pub(super) fn expected(&self, model: &Model, span: [f64; 2]) -> ExpectedMotion {
        let before = if self.fastest > 0.0 {
            parallel(model, self.span, span)
        } else {
            None
        };
        ExpectedMotion {
            tangent: self.predicted,
            holds: self.corrected <= OFF * self.predicted,
            before: before
                .map(|times| [self.fastest, self.last].map(|rate| rate * times * length(span))),
            ratio: if self.over { RATIO_OVER } else { RATIO },
        }
    }

    /// Records an accepted motion (length) over a span of the load factor.
    pub(super) fn take(&mut self, model: &Model, motion: f64, span: [f64; 2]) {
        let carried = parallel(model, self.span, span).map_or(0.0, |times| self.fastest * times);
        let rate = motion / length(span);
        self.fastest = carried.max(rate);
        (self.last, self.span) = (rate, span);
        // A suspected increment is dropped once the run has passed its end.
        let passed = |suspect: &SuspectIncrement| {
            let whole = suspect.sub_increment;
            (span[1] - whole.target()) * (whole.to - whole.from).signum() >= 0.0
        };
        if self.suspect.as_ref().is_some_and(passed) {
            (self.suspect, self.over) = (None, false);
        }
    }
}

impl ExpectedMotion {
    /// Smaller of the motions predicted by the tangent and by the fastest previous increment (length).
    pub(super) fn least(&self) -> f64 {
        self.before
            .map_or(self.tangent, |[fastest, _]| self.tangent.min(fastest))
    }

    /// Whether a motion (length) exceeds the expected motion. `cuts`: whether increments are cut, so that halves can confirm a
    /// jump.
    pub(super) fn is_exceeded(&self, motion: f64, cuts: bool) -> bool {
        let expected = if cuts { self.least() } else { self.tangent };
        let faster = FASTER * self.ratio / RATIO;
        motion > self.ratio * expected
            || self
                .before
                .is_some_and(|[_, last]| !self.holds && motion > faster * last)
    }
}

impl SuspectIncrement {
    /// Whether the motion of a part of it is large enough for a jump.
    pub(super) fn jumps(&self, motion: f64, size: f64) -> bool {
        motion > self.motion * (size / self.size).sqrt().sqrt()
    }
}

/// Ratio of the rates of change of loads, pressures and prescribed motions per unit load factor: span `now` over span `before`.
/// `None` if the changes are not parallel.
fn parallel(model: &Model, before: [f64; 2], now: [f64; 2]) -> Option<f64> {
    let loads = model.loads.iter().map(|load| (load.value, &load.scale));
    let pressures = model
        .pressures
        .iter()
        .map(|pressure| (pressure.value, &pressure.scale));
    let moved = model
        .prescribed
        .iter()
        .map(|moved| (moved.value, &moved.scale));
    let (mut product, mut there, mut here) = (0.0, 0.0, 0.0);
    let mut named = false;
    let mut add = |a: f64, b: f64| {
        (product, there, here) = (product + a * b, there + a * a, here + b * b);
    };
    for (value, scale) in loads.chain(pressures).chain(moved) {
        let peak = peak(&model.path, scale);
        if value != 0.0 && peak > 0.0 {
            let change = |[from, to]: [f64; 2]| (scale.at(to) - scale.at(from)) / peak;
            add(change(before), change(now));
            named = true;
        }
    }
    if !named || model.contacts.iter().any(|contact| contact.overlap != 0.0) {
        // Overlaps are being closed, or the scene names no loads: only the load factor changes.
        let whole = peak(&model.path, &Factor::default());
        let change = |[from, to]: [f64; 2]| (to - from) / whole;
        add(change(before), change(now));
    }
    let both = (there * here).sqrt();
    if both == 0.0 || product.abs() < PARALLEL * both {
        return None;
    }
    let times = (here / there).sqrt() * length(before) / length(now);
    // Loads linear in the load factor give a ratio of exactly 1.
    Some(if (times - 1.0).abs() < SAME {
        1.0
    } else {
        times
    })
}

/// Length of a span of the load factor.
fn length([from, to]: [f64; 2]) -> f64 {
    (to - from).abs()
}

/// Largest absolute value of a factor over the path.
fn peak(path: &[f64], scale: &Factor) -> f64 {
    let points = scale.0.iter().map(|point| point.1);
    let corners = path.iter().map(|&at| scale.at(at));
    max_abs(points.chain(corners))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Load;

    fn model(scales: &[&[(f64, f64)]]) -> Model {
        let mut model = Model::from_contacts("t", Vec::new(), Vec::new(), Vec::new());
        model.path = vec![0.0, 1.0, 2.0];
        model.loads = scales
            .iter()
            .map(|points| Load {
                dof: 0,
                value: 3.0,
                scale: Factor(points.to_vec()),
                volume: None,
            })
            .collect();
        model
    }

    #[test]
    fn what_shrinks_with_the_increment_or_its_root_is_no_jump_and_what_stays_is_one() {
        let whole = SuspectIncrement {
            motion: 1.0,
            size: 1.0,
            sub_increment: SubIncrement::default(),
        };
        for halvings in 1..=10 {
            let size = 0.5_f64.powi(halvings);
            assert!(!whole.jumps(size, size) && !whole.jumps(size.sqrt(), size));
            assert!(whole.jumps(0.9, size) && whole.jumps(1.0, size));
        }
    }

    #[test]
    fn an_increment_is_suspected_by_its_tangent_or_by_those_before_it() {
        let model = model(&[&[]]);
        let exceeds = |predicted: f64, corrected: f64, fastest: f64, last: f64, motion: f64| {
            let pace = Pace {
                predicted,
                corrected,
                fastest: fastest / 0.1,
                last: last / 0.1,
                span: [0.0, 0.1],
                ..Pace::default()
            };
            let expected = pace.expected(&model, [0.1, 0.2]);
            [true, false].map(|cuts| expected.is_exceeded(motion, cuts))
        };
        assert_eq!(
            exceeds(1.0, 0.0, 0.0, 0.0, 3.9),
            [false; 2],
            "nothing moved before"
        );
        assert_eq!(exceeds(1.0, 0.0, 0.0, 0.0, 4.1), [true; 2]);
        assert_eq!(
            exceeds(5.0, 0.0, 0.1, 0.1, 0.5),
            [true, false],
            "a soft tangent"
        );
        assert_eq!(exceeds(5.0, 0.0, 0.2, 0.2, 0.5), [false; 2]);
        assert_eq!(
            exceeds(5.0, 9.0, 2.0, 0.1, 0.5),
            [true; 2],
            "a limit point after a soft stretch"
        );
        assert_eq!(
            exceeds(5.0, 1.0, 2.0, 0.1, 0.5),
            [false; 2],
            "the tangent holds"
        );
    }

    #[test]
    fn a_pace_is_that_of_a_way_of_loading() {
        let pressed: &[(f64, f64)] = &[(0.0, 0.0), (1.0, 1.0)];
        let pulled: &[(f64, f64)] = &[(1.0, 0.0), (2.0, 5.0)];
        let two_steps = model(&[pressed, pulled]);
        assert_eq!(parallel(&two_steps, [0.0, 0.5], [0.5, 0.75]), Some(1.0));
        assert_eq!(
            parallel(&two_steps, [0.9, 1.0], [1.0, 1.1]),
            None,
            "the next step"
        );
        let faster = model(&[&[(0.0, 0.0), (0.5, 0.02), (1.0, 1.0)]]);
        let times = parallel(&faster, [0.4, 0.5], [0.5, 0.6]).unwrap();
        assert!((times - 49.0).abs() < 1e-9, "{times}");
        let held = model(&[&[(0.0, 0.0), (0.5, 1.0), (2.0, 1.0)]]);
        assert_eq!(
            parallel(&held, [0.4, 0.5], [0.5, 0.6]),
            None,
            "nothing changes any more"
        );
        assert_eq!(parallel(&model(&[]), [0.0, 0.1], [0.1, 0.2]), Some(1.0));
    }
}
