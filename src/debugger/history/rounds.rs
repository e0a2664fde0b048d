//! Detects repeating contact modes on a line, for solvers that do not report cycles.
//!
//! Modes and, in space, directions of sliding are compared over the minor and major iterations of one attempt at an increment. A
//! sequence of period 2 or more that has occurred twice in a row is reported as a cycle. If no mode changes, the margins of the
//! tests are compared instead: a friction bound or a slip may repeat while the modes stay. Without a cycle, the nodes that keep
//! changing are reported.

use super::strip::Strip;
use crate::explain::cycles::pattern;
use crate::explain::names;
use std::collections::VecDeque;
use stickslip_core::contact::record;
use stickslip_core::interface::cycle;
use stickslip_core::plane::max_abs;
use stickslip_core::{Mode, Model, counted};
use stickslip_scene::{first_of, joined};

/// Longest period searched for.
const LONGEST: usize = 200;
/// Periods above this must lie within one major iteration, or consist of major iterations of one minor iteration each: major
/// iterations that start alike may pass through the same modes.
const SHORT: usize = 12;
/// Largest relative difference of equal margins, above their rounding.
const SAME_MARGIN: f64 = 1e-6;
/// Margins with a smaller relative difference may still converge.
const DIFFERENT_MARGIN: f64 = 1e-3;
/// Margins below this fraction of the largest are round-off.
const NO_MARGIN: f64 = 1e-9;
/// Number of latest iterations searched for nodes that keep changing.
const BACK: usize = 8;
/// Number of changes among them from which a node keeps changing.
const OFTEN: usize = 3;
/// Largest difference of equal directions (degrees).
const SAME: f64 = 2.0;
/// Maximum number of nodes named.
const NAMED: usize = 6;

/// Detects, iteration by iteration, when the modes of an attached solver start to repeat.
#[derive(Debug, Default)]
pub struct CycleWatch {
    recent: VecDeque<Strip>,
    /// Whether they repeated at the last iteration.
    round: bool,
}

impl CycleWatch {
    /// Adds an iteration. Returns a cycle when it is first detected.
    pub fn see(&mut self, strip: &Strip) -> Option<Rounds> {
        if self.recent.len() == 2 * LONGEST + 2 {
            self.recent.pop_front();
        }
        self.recent.push_back(strip.clone());
        let found = rounds(self.recent.make_contiguous());
        let round = matches!(found, Some(Rounds::Cycle { .. }));
        let began = round && !self.round;
        self.round = round;
        found.filter(|_| began)
    }

    /// The behaviour of the modes over the last iterations.
    pub fn now(&mut self) -> Option<Rounds> {
        rounds(self.recent.make_contiguous())
    }
}

/// Mode of a node in a solve, and the direction of friction on it in degrees, if it slides in space.
pub type Phase = (Mode, Option<i16>);

/// Behaviour of the modes up to the end of a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Rounds {
    /// They repeat.
    Cycle {
        /// Number of iterations in one period.
        period: usize,
        /// Index on the line where the first period starts.
        since: usize,
        /// Participating slave nodes, with their modes over the last period, and in space the directions of sliding.
        members: Vec<(usize, Vec<Phase>)>,
    },
    /// They change without a period.
    Irregular {
        /// Slave nodes that changed, and how often in the last [`Rounds::Irregular::over`] iterations.
        members: Vec<(usize, usize)>,
        /// Number of iterations examined.
        over: usize,
    },
}

/// The behaviour of the modes up to the end of these strips; `None` if they do not keep changing.
pub fn rounds(strips: &[Strip]) -> Option<Rounds> {
    let last = strips.last()?.position;
    let solved = strips
        .iter()
        .enumerate()
        .filter(|(_, strip)| strip.kind.is_solved());
    let tail: Vec<(usize, &Strip)> = solved
        .rev()
        .take_while(|(_, strip)| {
            let at = strip.position;
            (at.increment, at.attempt) == (last.increment, last.attempt)
        })
        .collect();
    let nodes = strips.last()?.slaves();
    // Counted back from the last iteration: the modes used in each solve; 0 are the modes for the next one.
    let modes = |back: usize, slave: usize| match back {
        0 => tail[0].1.next(slave),
        back => tail[back - 1].1.before(slave),
    };
    // The next solve has no direction yet.
    let direction = |back: usize, slave: usize| tail[back.checked_sub(1)?].1.direction(slave);
    let same = |a: usize, b: usize| {
        let same_direction = |slave: usize| {
            a == 0 || b == 0 || turn(direction(a, slave), direction(b, slave)) <= SAME
        };
        (0..nodes).all(|slave| modes(a, slave) == modes(b, slave) && same_direction(slave))
    };
    if tail.is_empty() {
        return None;
    }
    let can_repeat = |period: usize| {
        let turns = || tail[..2 * period].iter().map(|(_, strip)| strip.position);
        (2..=LONGEST.min(tail.len() / 2)).contains(&period)
            && (period <= SHORT
                || turns().all(|at| at.major == last.major)
                || turns().all(|at| at.minor == 1))
    };
    // Equal modes may be a coincidence, so that two full periods have to agree.
    let repeats = |then: usize| {
        let period = tail.len() - then;
        can_repeat(period)
            && (0..=period).all(|back| same(back, back + period))
            && (1..period).any(|back| !same(0, back) || !same(1, back + 1))
    };
    let margin = |back: usize, slave: usize| f64::from(tail[back - 1].1.margin(slave));
    let margins = (0..nodes).map(|slave| margin(1, slave));
    let largest = max_abs(margins.filter(|margin| margin.is_finite()));
    let near = |slave: usize, a: usize, b: usize, limit: f64| {
        let [a, b] = [a, b].map(|back| margin(back, slave));
        a == b || (a - b).abs() <= limit * a.abs().max(b.abs()).max(NO_MARGIN * largest)
    };
    let within = |a: usize, b: usize, limit: f64| {
        same(a, b) && (0..nodes).all(|slave| near(slave, a, b, limit))
    };
    let values_repeat = |then: usize| {
        let period = tail.len() - then;
        can_repeat(period) && (1..=period).all(|back| within(back, back + period, SAME_MARGIN))
    };
    let elsewhere = |then: usize| !within(1, 1 + tail.len() - then, DIFFERENT_MARGIN);
    let by_modes = cycle::closed(tail.len(), 2, repeats, |_| true);
    let values = by_modes.is_none();
    if let Some(round) = by_modes.or_else(|| cycle::closed(tail.len(), 2, values_repeat, elsewhere))
    {
        let period = round.len();
        let again = |back: usize| {
            if values {
                within(back + 1, back + 1 + period, SAME_MARGIN)
            } else {
                same(back, back + period)
            }
        };
        let until = tail.len() - usize::from(values);
        let first = (0..)
            .take_while(|&back| back + period <= until && again(back))
            .count()
            + period
            - usize::from(!values);
        let phase = |back: usize, slave: usize| {
            let solved = if back == 0 { period } else { back };
            (modes(back, slave), direction(solved, slave))
        };
        let pattern = |slave: usize| -> Vec<Phase> {
            (0..period).rev().map(|back| phase(back, slave)).collect()
        };
        let members = (0..nodes).map(|slave| (slave, pattern(slave)));
        let changing = |(slave, phases): &(usize, Vec<Phase>)| {
            let (mode, direction) = phases[0];
            let mut back = 2..=period;
            values && back.any(|back| !near(*slave, 1, back, DIFFERENT_MARGIN))
                || phases
                    .iter()
                    .any(|(other, way)| *other != mode || turn(*way, direction) > SAME)
        };
        return Some(Rounds::Cycle {
            period,
            since: tail[first.saturating_sub(1).min(tail.len() - 1)].0,
            members: members.filter(changing).collect(),
        });
    }
    let over = BACK.min(tail.len());
    let count = |slave: usize| {
        tail[..over]
            .iter()
            .filter(|(_, strip)| strip.changes(slave))
            .count()
    };
    let mut members: Vec<(usize, usize)> = (0..nodes)
        .map(|slave| (slave, count(slave)))
        .filter(|(_, count)| *count >= OFTEN)
        .collect();
    members.sort_by_key(|&(slave, count)| (usize::MAX - count, slave));
    (!members.is_empty()).then_some(Rounds::Irregular { members, over })
}

/// The behaviour in a sentence; `tells_since` adds the first step.
pub fn words(model: &Model, rounds: &Rounds, tells_since: bool) -> String {
    match rounds {
        Rounds::Cycle {
            period,
            since,
            members,
        } => {
            let since = if tells_since {
                format!(" from step {since}")
            } else {
                String::new()
            };
            let keeps = |(_, phases): &&(usize, Vec<Phase>)| {
                phases.iter().all(|(mode, _)| *mode == phases[0].0)
            };
            let member = |member: &(usize, Vec<Phase>)| {
                let (slave, phases) = member;
                let name = names::slave(model, *slave);
                let mut modes = phases.iter().map(|(mode, _)| names::status(model, *mode));
                if keeps(&member)
                    && let Some(mode) = modes.next()
                {
                    return format!("{name} stays {mode} while its margin repeats");
                }
                let modes: Vec<&str> = modes.collect();
                format!("{name} {}", pattern(&modes))
            };
            let swings: Vec<(usize, f64)> = swings(members).collect();
            let swings_only = |found: &&(usize, Vec<Phase>)| {
                keeps(found) && swings.iter().any(|swing| swing.0 == found.0)
            };
            let named = members.iter().filter(|found| !swings_only(found));
            let lines = first_of(named.map(member), NAMED, "; ");
            let most = swings
                .iter()
                .copied()
                .reduce(|a, b| if b.1 > a.1 { b } else { a });
            let swing = most.map(|(slave, degrees)| {
                let others = match swings.len() - 1 {
                    0 => String::new(),
                    others => format!(" (and at {})", counted(others, "more node")),
                };
                format!(
                    "the direction of friction at {}{others} swings by up to {degrees:.0} degrees per iteration",
                    names::slave(model, slave)
                )
            });
            let lines = (!lines.is_empty()).then_some(lines);
            format!(
                "cycle of period {period}{since}: {}",
                joined(swing.into_iter().chain(lines), "; ")
            )
        }
        Rounds::Irregular { members, over } => {
            let line = |(slave, count): &(usize, usize)| {
                let name = names::slave(model, *slave);
                format!("{name} ({})", counted(*count, "time"))
            };
            // Fewer iterations have had no time to repeat.
            let order = if *over < BACK {
                ""
            } else {
                " without a period"
            };
            format!(
                "changed in the last {}{order}: {}",
                counted(*over, "iteration"),
                first_of(members.iter().map(line), NAMED, ", ")
            )
        }
    }
}

/// The angle between two directions (degrees); infinite if only one of them is known.
fn turn(a: Option<i16>, b: Option<i16>) -> f64 {
    let radians = |degrees: i16| f64::from(degrees).to_radians();
    match (a, b) {
        (None, None) => 0.0,
        (Some(a), Some(b)) => record::turn(radians(a), radians(b)).to_degrees().abs(),
        _ => f64::INFINITY,
    }
}

/// The nodes whose direction of sliding changes in a cycle, with the largest change per iteration (degrees).
fn swings(members: &[(usize, Vec<Phase>)]) -> impl Iterator<Item = (usize, f64)> {
    let largest = members.iter().map(|(slave, phases)| {
        let next = phases.iter().cycle().skip(1);
        let finite = phases
            .iter()
            .zip(next)
            .map(|((_, a), (_, b))| turn(*a, *b))
            .filter(|turn| turn.is_finite());
        (*slave, finite.fold(0.0, f64::max))
    });
    largest.filter(|(_, degrees)| *degrees > SAME)
}
