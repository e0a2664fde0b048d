//! Breakpoints: conditions that stop a run, forward or backward.
//!
//! A condition depends only on the [`Strip`]s of a minor iteration and of the point before it. Strips are never
//! discarded, so running backward finds exactly the points where running forward stopped, without solving.

use crate::explain::names;
use crate::refusal::{Refusal, refusal};
use crate::{PointKind, Strip};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use stickslip_core::words::noun_for;
use stickslip_core::{Mode, Model, Position};
use stickslip_scene::joined;

/// Condition of a breakpoint. A node is a slave number; `None` matches any node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Condition {
    /// A node's mode changes for the next iteration.
    Mode {
        /// Slave number, from 0; `None` for any.
        node: Option<usize>,
        /// Mode before; `None` for any.
        from: Option<Mode>,
        /// Mode after; `None` for any.
        to: Option<Mode>,
    },
    /// A node's margin (force or length, in single precision) falls below a value.
    Margin {
        /// Slave number, from 0; `None` for any.
        node: Option<usize>,
        /// Threshold: a force or a length, depending on which inequality is closest to switching.
        below: f64,
    },
    /// A node changes its interface element, or leaves or reaches a surface.
    Element {
        /// Slave number, from 0; `None` for any.
        node: Option<usize>,
    },
    /// The minor iterations form a cycle.
    Cycle,
    /// A major iteration ends with a larger relative residual than it started with.
    Residual,
    /// The increment fails.
    Failure,
    /// A position is reached or passed.
    At(RunPlace),
}

/// A position in a run; a missing minor or major iteration means the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename = "Place")]
pub struct RunPlace {
    /// From 1.
    pub increment: u32,
    /// From 1.
    pub major: u32,
    /// From 1.
    pub minor: u32,
}

impl From<Position> for RunPlace {
    fn from(at: Position) -> RunPlace {
        RunPlace {
            increment: at.increment,
            major: at.major,
            minor: at.minor,
        }
    }
}

impl FromStr for RunPlace {
    type Err = Refusal;

    fn from_str(text: &str) -> Result<RunPlace, Refusal> {
        let [increment, major, minor] = parts(text)
            .ok_or_else(|| refusal!("invalid position '{text}'; expected INC[.MAJOR[.MINOR]]"))?;
        Ok(RunPlace {
            increment: increment.unwrap_or(1),
            major: major.unwrap_or(1),
            minor: minor.unwrap_or(1),
        })
    }
}

/// The numbers of a position `INC[.MAJOR[.MINOR]]`; the first is never missing.
pub fn parts(text: &str) -> Option<[Option<u32>; 3]> {
    let mut all = [None; 3];
    for (k, part) in text.split('.').enumerate() {
        let number = part.parse().ok().filter(|number| *number > 0)?;
        *all.get_mut(k)? = Some(number);
    }
    Some(all)
}

impl fmt::Display for RunPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}.{}", self.increment, self.major, self.minor)
    }
}

/// A breakpoint.
#[derive(Debug, Clone, PartialEq)]
pub struct Breakpoint {
    /// Number, from 1; never reused in a session.
    pub id: u32,
    /// When it stops a run.
    pub condition: Condition,
    /// Whether it is enabled.
    pub enabled: bool,
}

/// The breakpoints of a session, oldest first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Breakpoints {
    all: Vec<Breakpoint>,
    /// Number of the latest one.
    last: u32,
}

impl Breakpoints {
    /// All breakpoints, oldest first.
    pub fn all(&self) -> &[Breakpoint] {
        &self.all
    }

    /// Adds an enabled breakpoint and describes it.
    pub(crate) fn add(&mut self, condition: Condition, model: &Model) -> String {
        self.last += 1;
        let breakpoint = Breakpoint {
            id: self.last,
            condition,
            enabled: true,
        };
        let described = format!("breakpoint {}", describe(model, &breakpoint));
        self.all.push(breakpoint);
        described
    }

    /// Deletes one breakpoint, or all, and lists the others.
    pub(crate) fn delete(&mut self, id: Option<u32>, model: &Model) -> Result<String, Refusal> {
        self.check(id, model)?;
        self.all.retain(|b| id.is_some_and(|id| b.id != id));
        Ok(self.describe(model))
    }

    /// Enables or disables one breakpoint, or all, and lists all.
    pub(crate) fn enable(
        &mut self,
        id: Option<u32>,
        on: bool,
        model: &Model,
    ) -> Result<String, Refusal> {
        self.check(id, model)?;
        self.all
            .iter_mut()
            .filter(|b| id.is_none_or(|id| b.id == id))
            .for_each(|b| b.enabled = on);
        Ok(self.describe(model))
    }

    fn check(&self, id: Option<u32>, model: &Model) -> Result<(), Refusal> {
        match id.filter(|id| self.all.iter().all(|b| b.id != *id)) {
            Some(id) => Err(refusal!(
                "there is no breakpoint {id}; {}",
                self.describe(model)
            )),
            None => Ok(()),
        }
    }

    /// The numbers of the enabled breakpoints that are hit at a point. `before` is the previous point of the
    /// line.
    pub fn hits(&self, before: &Strip, now: &Strip) -> Vec<u32> {
        self.all
            .iter()
            .filter(|b| b.enabled && b.condition.holds(before, now))
            .map(|b| b.id)
            .collect()
    }

    /// All breakpoints in one line.
    pub(crate) fn describe(&self, model: &Model) -> String {
        if self.all.is_empty() {
            "there are no breakpoints; :break sets one".into()
        } else {
            format!("breakpoints {}", listed(model, self.all.iter()))
        }
    }

    /// The breakpoints that a run stopped at, as the beginning of a reply.
    pub(crate) fn describe_hits(&self, model: &Model, hits: &[u32]) -> String {
        let hit = self.all.iter().filter(|b| hits.contains(&b.id));
        match hit.clone().count() {
            0 => String::new(),
            count => {
                let noun = noun_for(&count, "breakpoint");
                format!("{noun} {}: ", listed(model, hit))
            }
        }
    }
}

impl Condition {
    /// Whether the condition is met at a minor iteration; never at the start or at an intervention.
    pub fn holds(&self, before: &Strip, now: &Strip) -> bool {
        if !now.kind.is_solved() {
            return false;
        }
        let any = |node: &Option<usize>, holds: &dyn Fn(usize) -> bool| match node {
            Some(node) => *node < now.slaves() && holds(*node),
            None => (0..now.slaves()).any(holds),
        };
        match self {
            Condition::Mode { node, from, to } => any(node, &|s| {
                now.changes(s)
                    && from.is_none_or(|mode| mode == now.before(s))
                    && to.is_none_or(|mode| mode == now.next(s))
            }),
            Condition::Margin { node, below } => any(node, &|s| {
                let below = *below as f32;
                now.margin(s) < below && !(before.kind.is_solved() && before.margin(s) < below)
            }),
            Condition::Element { node } => any(node, &|s| now.element(s) != before.element(s)),
            Condition::Cycle => matches!(
                now.kind,
                PointKind::Cycle | PointKind::Damped | PointKind::Climbed
            ),
            Condition::Residual => now
                .after
                .as_ref()
                .is_some_and(|after| after.relative > now.residual),
            Condition::Failure => {
                now.kind.is_failure() || matches!(now.kind, PointKind::Cut | PointKind::Refused)
            }
            Condition::At(place) => {
                let reaches = |strip: &Strip| RunPlace::from(strip.position) >= *place;
                reaches(now) && !(before.kind.is_solved() && reaches(before))
            }
        }
    }

    /// The condition in words.
    pub fn describe(&self, model: &Model) -> String {
        let name = |node: &Option<usize>| match node {
            Some(node) => names::slave(model, *node),
            None => "any node",
        };
        let mode = |mode: &Option<Mode>| mode.map_or("any mode", |mode| names::status(model, mode));
        match self {
            Condition::Mode { node, from, to } => match (from, to) {
                (None, None) => format!("{} changes mode", name(node)),
                (Some(_), None) => format!("{} leaves {}", name(node), mode(from)),
                (None, Some(_)) => format!("{} becomes {}", name(node), mode(to)),
                _ => format!("{} changes from {} to {}", name(node), mode(from), mode(to)),
            },
            Condition::Margin { node, below } => format!("margin of {} below {below}", name(node)),
            Condition::Element { node } => format!("{} changes element", name(node)),
            Condition::Cycle => "a cycle closes".into(),
            Condition::Residual => "the residual rises".into(),
            Condition::Failure => "an increment fails".into(),
            Condition::At(place) => format!("at {place}"),
        }
    }
}

/// Number and condition: `2 (any node leaves sliding)`.
fn describe(model: &Model, breakpoint: &Breakpoint) -> String {
    let off = if breakpoint.enabled { "" } else { ", disabled" };
    let condition = breakpoint.condition.describe(model);
    format!("{} ({condition}{off})", breakpoint.id)
}

fn listed<'a>(model: &Model, breakpoints: impl Iterator<Item = &'a Breakpoint>) -> String {
    joined(breakpoints.map(|b| describe(model, b)), ", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_default_to_the_first_iteration() {
        let read = |text: &str| text.parse::<RunPlace>().map(|place| place.to_string());
        assert_eq!(read("3"), Ok("3.1.1".into()));
        assert_eq!(read("3.2"), Ok("3.2.1".into()));
        assert_eq!(read("3.2.7"), Ok("3.2.7".into()));
        for wrong in ["", "0", "1.0", "1.2.3.4", "a", "1.", "-1"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
