//! Branches: their names, their cost, and where they accepted increments.

use crate::explain::names;
use crate::refusal::{Refusal, refusal};
use crate::{Strip, Tree};
use stickslip_core::{Intervention, Model};
use stickslip_scene::joined;

/// Cost of a part of the history.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cost {
    /// Minor iterations.
    pub minors: u64,
    /// Major iterations.
    pub majors: u64,
    /// Accepted increments.
    pub increments: u64,
    /// Wall time of the solves.
    pub seconds: f64,
}

/// The name of a branch: `b2: beam.5 sliding`.
pub fn name(tree: &Tree, branch: usize) -> String {
    let label = tree
        .branches()
        .get(branch)
        .map_or("?", |b| b.label.as_str());
    format!("b{}: {label}", branch + 1)
}

/// Finds a branch by number (`b2`), label, whole name, or a unique prefix of its label.
///
/// # Errors
/// If none or several match; the message lists the branches.
pub fn find(tree: &Tree, word: &str) -> Result<usize, Refusal> {
    let all = 0..tree.branches().len();
    let label = |b: usize| tree.branches()[b].label.as_str();
    let exact =
        |b: &usize| word == format!("b{}", b + 1) || word == label(*b) || word == name(tree, *b);
    if let Some(found) = all.clone().find(exact) {
        return Ok(found);
    }
    let begun: Vec<usize> = all
        .clone()
        .filter(|&b| label(b).starts_with(word))
        .collect();
    let name = |b: usize| name(tree, b);
    match begun[..] {
        [found] => Ok(found),
        [] => {
            let all = joined(all.map(name), ", ");
            Err(refusal!("branch '{word}' does not exist; branches: {all}"))
        }
        _ => {
            let begun = joined(begun.into_iter().map(name), ", ");
            Err(refusal!("branch '{word}' is ambiguous: {begun}"))
        }
    }
}

/// The label of a branch that starts with this intervention.
pub fn label(model: &Model, intervention: &Intervention, setting: Option<(&str, &str)>) -> String {
    if let Some((path, value)) = setting {
        let path = path.strip_prefix("settings.").unwrap_or(path);
        return format!("{path} {value}");
    }
    match intervention {
        Intervention::Force { slave, mode, hold } => {
            let held = if *hold { "held " } else { "" };
            let slave = names::slave(model, *slave);
            format!("{slave} {held}{}", mode.word())
        }
        Intervention::Assume(starts) => names::starts(model, starts, 3),
        Intervention::Release { slave } => format!("{} released", names::slave(model, *slave)),
        Intervention::Increment(size) => format!("increment {size}"),
        Intervention::Friction(friction) => format!("friction {}", friction.angle),
        Intervention::Frictions(all) => match all.first() {
            Some(friction) => format!("friction {}", friction.angle),
            None => "friction".into(),
        },
        Intervention::Settings(_) => "settings".into(),
        Intervention::Parameter { name, value } => format!("{name} {value}"),
    }
}

/// Cost of a range of points on a branch's line.
pub fn cost(tree: &Tree, branch: usize, places: std::ops::Range<usize>) -> Cost {
    let strips = places
        .filter_map(|at| tree.point(branch, at))
        .map(|(_, strip)| strip);
    let mut cost = Cost::default();
    // A cycle and what continues from it end the same major.
    let mut ended = None;
    for strip in strips.filter(|strip| strip.kind.is_solved()) {
        cost.minors += 1;
        let at = strip.position;
        let major = Some((at.increment, at.attempt, at.major));
        if strip.kind.ends_major() && ended != major {
            (cost.majors, ended) = (cost.majors + 1, major);
        }
        cost.increments += u64::from(strip.kind.is_accepted());
        cost.seconds += f64::from(strip.seconds);
    }
    cost
}

/// The last point on a branch's line where an increment was accepted at the same load on the same leg of the
/// path.
pub(super) fn accepted_like(tree: &Tree, branch: usize, like: &Strip) -> Option<usize> {
    let same = |strip: &Strip| (strip.load_factor, strip.leg) == (like.load_factor, like.leg);
    accepted(tree, branch)
        .find(|(_, strip)| same(strip))
        .map(|(at, _)| at)
}

/// Points of a branch's line where an increment was accepted, last first.
pub(super) fn accepted(tree: &Tree, branch: usize) -> impl Iterator<Item = (usize, &Strip)> {
    strips(tree, branch, 0).filter(|(_, strip)| strip.kind.is_accepted())
}

/// Points of a branch's line from `start` on, last first.
pub(super) fn strips(
    tree: &Tree,
    branch: usize,
    start: usize,
) -> impl Iterator<Item = (usize, &Strip)> {
    (start..tree.len(branch))
        .rev()
        .filter_map(move |at| tree.point(branch, at).map(|(_, strip)| (at, strip)))
}
