//! Whether the modes of a line go round, as seen from outside: for solvers that do not say so themselves.
//!
//! Only modes are looked at, over minor and major iterations of one increment: a sequence that has repeated itself twice with a
//! period of at least two is called a cycle; where none has, the nodes that keep changing are told.

use super::strip::Strip;
use crate::explain::names;
use std::collections::VecDeque;
use stickslip_core::interface::cycle;
use stickslip_core::model::{Mode, Model};

/// Longest period that is looked for.
const LONGEST: usize = 12;
/// Iterations that are looked back for nodes that keep changing.
const BACK: usize = 8;
/// Fewest changes among them that count as going on.
const OFTEN: usize = 3;
/// Nodes that are named.
const NAMED: usize = 6;

/// Whether the modes of an attached solver have begun to go round, seen iteration by iteration.
#[derive(Debug, Default)]
pub struct Watch {
    recent: VecDeque<Strip>,
    /// Whether they went round at the last look.
    round: bool,
}

impl Watch {
    /// Looks at one iteration more; the cycle, where it is seen first here.
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

    /// What the last iterations did.
    pub fn now(&mut self) -> Option<Rounds> {
        rounds(self.recent.make_contiguous())
    }
}

/// What the modes did up to the end of a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Rounds {
    /// They repeat.
    Cycle {
        /// Iterations of a round.
        period: usize,
        /// Place on the line at which the first round began.
        since: usize,
        /// Who takes part, by slave number, and its modes over the last round.
        members: Vec<(usize, Vec<Mode>)>,
    },
    /// They change without an order.
    Restless {
        /// Who changed, by slave number, and how often in the last [`Rounds::Restless::over`] iterations.
        members: Vec<(usize, usize)>,
        /// Iterations that were looked at.
        over: usize,
    },
}

/// What the modes did up to the end of these strips; `None` where they are at rest.
pub fn rounds(strips: &[Strip]) -> Option<Rounds> {
    let last = strips.last()?.position.increment;
    let solved = strips.iter().enumerate();
    let solved = solved.filter(|(_, strip)| strip.kind.is_solved());
    let tail: Vec<(usize, &Strip)> = solved
        .rev()
        .take_while(|(_, strip)| strip.position.increment == last)
        .collect();
    let nodes = strips.last()?.slaves();
    // From the last iteration back: the modes with which each was solved, and those that follow the last.
    let modes = |back: usize, slave: usize| match back {
        0 => tail[0].1.next(slave),
        back => tail[back - 1].1.before(slave),
    };
    let same = |a: usize, b: usize| (0..nodes).all(|slave| modes(a, slave) == modes(b, slave));
    if tail.is_empty() {
        return None;
    }
    // Modes alone prove nothing, so that the turn before must be the same.
    let repeats = |then: usize| {
        let period = tail.len() - then;
        (2..=LONGEST.min(tail.len() / 2)).contains(&period)
            && (0..=period).all(|back| same(back, back + period))
            && (1..period).any(|back| !same(0, back))
    };
    if let Some(turn) = cycle::closed(tail.len(), 2, repeats, |_| true) {
        let period = turn.len();
        let rounds =
            (0..).take_while(|&back| back + period <= tail.len() && same(back, back + period));
        let first = rounds.count() + period - 1;
        let pattern = |slave: usize| -> Vec<Mode> {
            (0..period).rev().map(|back| modes(back, slave)).collect()
        };
        let members = (0..nodes).map(|slave| (slave, pattern(slave)));
        let changing = |(_, modes): &(usize, Vec<Mode>)| modes.iter().any(|m| *m != modes[0]);
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
    (!members.is_empty()).then_some(Rounds::Restless { members, over })
}

/// The same in a sentence; `since` says whether it tells the step from which on.
pub fn words(model: &Model, rounds: &Rounds, tells_since: bool) -> String {
    match rounds {
        Rounds::Cycle {
            period,
            since,
            members,
        } => {
            let since = match tells_since {
                true => format!(" since step {since}"),
                false => String::new(),
            };
            let member = |(slave, modes): &(usize, Vec<Mode>)| {
                let modes: Vec<&str> = modes
                    .iter()
                    .map(|mode| names::status(model, *mode))
                    .collect();
                format!("{} {}", names::slave(model, *slave), modes.join(" → "))
            };
            let told: Vec<String> = members.iter().take(NAMED).map(member).collect();
            format!(
                "the modes {period}-cycle{since}: {}{}",
                told.join("; "),
                more(members.len())
            )
        }
        Rounds::Restless { members, over } => {
            let member = |(slave, count): &(usize, usize)| {
                format!("{} ({count} times)", names::slave(model, *slave))
            };
            let told: Vec<String> = members.iter().take(NAMED).map(member).collect();
            // Fewer iterations have had no time to repeat.
            let order = if *over < BACK {
                ""
            } else {
                ", without a period"
            };
            format!(
                "in the last {over} iterations these changed{order}: {}{}",
                told.join(", "),
                more(members.len())
            )
        }
    }
}

fn more(count: usize) -> String {
    match count.saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(", and {more} more"),
    }
}
