//! Loads of a deck as functions of time, over all steps.
//!
//! A load given in a step changes from its previous value to the new one: in proportion to time, at once, or by its amplitude.
//! Other loads stay constant. A load that is applied at once is fully present in the step's first increment.
//!
//! The load factor counts time: a step from t0 to t1 is the leg of the path between these values, with the step's increment size.

use stickslip_exchange::inp::deck::{Amplitude, Deck, Step, Time};

/// Maximum number of increments per step with automatic increments, because the first increment of a deck is often much smaller
/// than the following ones.
const AUTOMATIC: f64 = 10.0;

/// The times of a deck's steps, and their load factors.
pub(super) struct Clock {
    steps: Vec<Leg>,
}

/// A step.
#[derive(Debug, Clone, Copy)]
struct Leg {
    /// Start time, measured from the start of the first step.
    begin: f64,
    period: f64,
    increment: f64,
}

impl Leg {
    fn end(&self) -> f64 {
        self.begin + self.period
    }
}

/// Increment size of a step.
fn increment(time: &Time) -> f64 {
    if time.direct {
        return time.initial;
    }
    let wanted = time.initial.max(time.period / AUTOMATIC);
    time.most.map_or(wanted, |most| wanted.min(most))
}

impl Clock {
    pub fn from_deck(deck: &Deck) -> Clock {
        let mut begin = 0.0;
        let leg = |step: &Step| {
            let leg = Leg {
                begin,
                period: step.time.period,
                increment: increment(&step.time),
            };
            begin = leg.end();
            leg
        };
        Clock {
            steps: deck.steps.iter().map(leg).collect(),
        }
    }

    /// The corners of the path.
    pub fn path(&self) -> Vec<f64> {
        let ends = self.steps.iter().map(Leg::end);
        std::iter::once(0.0).chain(ends).collect()
    }

    /// Increment size of each step.
    pub fn increments(&self) -> impl Iterator<Item = f64> + use<'_> {
        self.steps.iter().map(|leg| leg.increment)
    }
}

/// Values given for a load in a step.
#[derive(Debug, Clone, Default)]
pub(super) struct StepValues {
    /// Values with their amplitudes, which are the same; they are added.
    pub values: Vec<(f64, Option<usize>)>,
    /// Whether values of earlier steps are removed.
    pub new: bool,
    /// Whether values without an amplitude apply at once.
    pub at_once: bool,
}

/// A value as a function of the load factor: points with ascending load factors, starting at (0, 0).
pub(super) fn curve(
    clock: &Clock,
    amplitudes: &[Amplitude],
    given: &[StepValues],
) -> Vec<(f64, f64)> {
    let mut points = vec![(0.0, 0.0)];
    let mut before = 0.0;
    let mut acting: Vec<(f64, Option<usize>)> = Vec::new();
    for (step, given) in given.iter().enumerate() {
        let leg = clock.steps[step];
        let fresh = !given.values.is_empty();
        if fresh {
            acting = given.values.clone();
        } else if given.new {
            acting.clear();
        }
        let goes_on =
            |&(_, amplitude): &(f64, Option<usize>)| amplitude.is_some_and(|a| amplitudes[a].total);
        let of_step = StepLoad {
            loads: &acting,
            amplitudes,
            begin: leg.begin,
            period: leg.period,
            before,
            jump: given.at_once && fresh,
        };
        let still = !fresh && !acting.iter().any(goes_on);
        if still {
            before = if given.new { 0.0 } else { before }
        } else {
            let jumps = (of_step.at(0.0) - before).abs() > 0.0;
            let from = if jumps {
                leg.increment.min(leg.period)
            } else {
                0.0
            };
            for time in of_step.corners(from) {
                points.push((leg.begin + time, of_step.at(time)));
            }
            before = of_step.at(leg.period);
        }
        points.push((leg.end(), before));
    }
    points
}

/// A load within a step.
struct StepLoad<'a> {
    loads: &'a [(f64, Option<usize>)],
    amplitudes: &'a [Amplitude],
    begin: f64,
    period: f64,
    /// Value at the start of the step.
    before: f64,
    /// Whether values without an amplitude apply at once.
    jump: bool,
}

impl StepLoad<'_> {
    /// Value at a time since the start of the step.
    fn at(&self, time: f64) -> f64 {
        let own = |a: usize| {
            if self.amplitudes[a].total {
                self.begin + time
            } else {
                time
            }
        };
        let swung: f64 = self
            .loads
            .iter()
            .filter_map(|&(value, amplitude)| {
                amplitude.map(|a| value * interpolated(&self.amplitudes[a].points, own(a)))
            })
            .sum();
        let plain: Vec<f64> = self
            .loads
            .iter()
            .filter(|(_, a)| a.is_none())
            .map(|(value, _)| *value)
            .collect();
        if plain.is_empty() {
            return swung;
        }
        let goal: f64 = plain.iter().sum();
        let part = if self.jump { 1.0 } else { time / self.period };
        self.before + (goal - self.before) * part
    }

    /// Times within the step at which the value has a corner; `from` is included if it is not 0.
    fn corners(&self, from: f64) -> Vec<f64> {
        let mut corners: Vec<f64> = self
            .loads
            .iter()
            .filter_map(|&(_, amplitude)| {
                let amplitude = &self.amplitudes[amplitude?];
                let begin = if amplitude.total { self.begin } else { 0.0 };
                Some(amplitude.points.iter().map(move |(time, _)| time - begin))
            })
            .flatten()
            .collect();
        corners.push(from);
        corners.retain(|&time| time > 0.0 && time >= from && time < self.period);
        corners.sort_by(f64::total_cmp);
        corners.dedup();
        corners
    }
}

/// Piecewise linear, constant beyond the ends.
fn interpolated(points: &[(f64, f64)], time: f64) -> f64 {
    stickslip_core::model::Factor(points.to_vec()).at(time)
}

/// A curve as a value and a scale: its largest magnitude, and the fraction that acts. `None` if it is always zero.
pub(super) fn scaled(points: &[(f64, f64)]) -> Option<(f64, Vec<(f64, f64)>)> {
    let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    let largest = points.iter().map(|p| p.1).fold(0.0, larger);
    if largest == 0.0 {
        return None;
    }
    match points {
        [(_, _), (end, value)] if *end == 1.0 => Some((*value, Vec::new())),
        _ => {
            // Avoids negative zeros.
            let part = |&(at, value): &(f64, f64)| (at, value / largest + 0.0);
            Some((largest, points.iter().map(part).collect()))
        }
    }
}
