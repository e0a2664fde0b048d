//! Branches in words and verdicts: what each is called, what it cost, and how it ended.

use crate::debug::compare::{self, Sameness};
use crate::debug::report;
use crate::debug::strip::{Kind, Strip};
use crate::debug::tree::Tree;
use crate::interface::minor_history::Cycle;
use crate::model::Model;
use crate::step::event::{Failure, Outcome, Position};
use crate::step::intervene::Intervention;

/// What a stretch of the history cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cost {
    pub minors: u64,
    pub majors: u64,
    /// Accepted increments.
    pub increments: u64,
    /// Wall time of the solves.
    pub seconds: f64,
}

/// How a branch ends, as far as it goes. Branches are numbers in [`Tree::branches`].
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// In the middle of an increment, or nothing is solved in it yet.
    Running,
    /// At an accepted increment that no other branch has reached; nothing to compare with.
    Accepted,
    /// Displacements and forces are those of an earlier branch at the same load.
    Same { branch: usize, load: f64 },
    /// An earlier branch accepted another state at the same load; this one is as valid.
    Other { branch: usize, load: f64 },
    /// The cycle that an earlier branch ends in, too, in the same increment.
    SameCycle { branch: usize },
    /// A cycle.
    Cycle,
    /// The residual or the displacements grew out of all bounds.
    Diverged,
    /// Failed for another reason.
    Failed,
}

/// A branch, summed up.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Number in the order of making, from 0; `b1` is number 0.
    pub number: usize,
    /// `b2: beam.5 sliding`
    pub name: String,
    pub parent: Option<usize>,
    /// Place on its line of the first point of its own.
    pub from: usize,
    /// Number of points on its line, those that it shares included.
    pub length: usize,
    pub is_current: bool,
    /// The last minor iteration on it.
    pub position: Position,
    pub load_factor: f64,
    pub verdict: Verdict,
    /// What its own points cost, and its whole line.
    pub own: Cost,
    pub whole: Cost,
}

/// The name of a branch: `b2: beam.5 sliding`.
pub fn name(tree: &Tree, branch: usize) -> String {
    let label = tree
        .branches()
        .get(branch)
        .map_or("?", |b| b.label.as_str());
    format!("b{}: {label}", branch + 1)
}

/// The branch that a word stands for: `b2`, its label, its whole name, or the beginning of one label only.
///
/// # Errors
/// A message that lists the branches.
pub fn find(tree: &Tree, word: &str) -> Result<usize, String> {
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
    let list = |some: &[usize]| {
        let names: Vec<String> = some.iter().map(|&b| name(tree, b)).collect();
        names.join(", ")
    };
    match begun[..] {
        [found] => Ok(found),
        [] => {
            let all: Vec<usize> = all.collect();
            Err(format!(
                "no branch is called '{word}'; there are {}",
                list(&all)
            ))
        }
        _ => Err(format!("'{word}' could be {}", list(&begun))),
    }
}

/// What was done, in the few words of a branch's name.
pub fn label(model: &Model, intervention: &Intervention, setting: Option<(&str, &str)>) -> String {
    if let Some((path, value)) = setting {
        let path = path.strip_prefix("settings.").unwrap_or(path);
        return format!("{path} {value}");
    }
    match intervention {
        Intervention::Force { slave, mode, hold } => {
            let held = if *hold { "held " } else { "" };
            let slave = report::slave(model, *slave);
            format!("{slave} {held}{}", report::mode(*mode))
        }
        Intervention::Assume(starts) => {
            const SHOWN: usize = 3;
            let some = starts.iter().take(SHOWN).map(|start| {
                format!(
                    "{} {}",
                    report::slave(model, start.slave),
                    report::mode(start.mode)
                )
            });
            let more = if starts.len() > SHOWN { ", …" } else { "" };
            some.collect::<Vec<_>>().join(", ") + more
        }
        Intervention::Release { slave } => format!("{} released", report::slave(model, *slave)),
        Intervention::Increment(size) => format!("increment {size}"),
        Intervention::Friction(friction) => format!("friction {}", friction.angle),
        Intervention::Settings(_) => "settings".into(),
    }
}

/// All branches, summed up.
pub fn summaries(tree: &Tree) -> Vec<Summary> {
    (0..tree.branches().len())
        .filter_map(|branch| summary(tree, branch))
        .collect()
}

fn summary(tree: &Tree, number: usize) -> Option<Summary> {
    let (_, tip) = tree.tip(number)?;
    let branch = tree.branches().get(number)?;
    let length = tree.len(number);
    Some(Summary {
        number,
        name: name(tree, number),
        parent: branch.parent,
        from: branch.from,
        length,
        is_current: number == tree.current(),
        position: tip.position,
        load_factor: tip.load_factor,
        verdict: verdict(tree, number),
        own: cost(tree, number, branch.from..length),
        whole: cost(tree, number, 0..length),
    })
}

/// What points of a branch's line cost.
pub fn cost(tree: &Tree, branch: usize, places: std::ops::Range<usize>) -> Cost {
    let strips = places
        .filter_map(|at| tree.point(branch, at))
        .map(|(_, strip)| strip);
    let mut cost = Cost::default();
    for strip in strips.filter(|strip| strip.kind.is_solved()) {
        cost.minors += 1;
        cost.majors += u64::from(strip.kind.ends_major());
        cost.increments += u64::from(strip.kind.is_accepted());
        cost.seconds += f64::from(strip.seconds);
    }
    cost
}

/// How a branch ends. It is compared with earlier branches only, so that the first of several alike is the one that
/// the others are like.
pub fn verdict(tree: &Tree, branch: usize) -> Verdict {
    let Some((frame, tip)) = tree.tip(branch) else {
        return Verdict::Running;
    };
    let others = || (0..tree.branches().len()).filter(|&other| other < branch);
    match tip.kind {
        Kind::Start
        | Kind::Intervention
        | Kind::Minor
        | Kind::Damped
        | Kind::Climbed
        | Kind::Cut
        | Kind::Refused
        | Kind::Major => Verdict::Running,
        Kind::Cycle => {
            let own = frame
                .event
                .as_deref()
                .and_then(|event| cycle(&event.outcome));
            let same = |&other: &usize| {
                let Some((frame, strip)) = tree.tip(other) else {
                    return false;
                };
                let theirs = frame
                    .event
                    .as_deref()
                    .and_then(|event| cycle(&event.outcome));
                strip.position.increment == tip.position.increment
                    && own.zip(theirs).is_some_and(|(a, b)| alike(a, b))
            };
            others()
                .find(same)
                .map_or(Verdict::Cycle, |branch| Verdict::SameCycle { branch })
        }
        Kind::Failed => match frame.event.as_deref().map(|event| &event.outcome) {
            Some(Outcome::Failed(Failure::Diverged { .. })) => Verdict::Diverged,
            _ => Verdict::Failed,
        },
        Kind::Increment | Kind::Jumped | Kind::Last | Kind::LastJumped => {
            let mut other = None;
            for earlier in others() {
                match compare::sameness(tree, branch, earlier) {
                    Some((Sameness::Same, load)) => {
                        return Verdict::Same {
                            branch: earlier,
                            load,
                        };
                    }
                    Some((Sameness::Different, load)) => {
                        other.get_or_insert(Verdict::Other {
                            branch: earlier,
                            load,
                        });
                    }
                    None => {}
                }
            }
            other.unwrap_or(Verdict::Accepted)
        }
    }
}

fn cycle(outcome: &Outcome) -> Option<&Cycle> {
    match outcome {
        Outcome::Failed(Failure::Cycle(cycle)) => Some(cycle),
        _ => None,
    }
}

/// Whether two cycles have the same period and members with the same patterns, wherever in the period they start.
fn alike(a: &Cycle, b: &Cycle) -> bool {
    if a.period != b.period || a.members.len() != b.members.len() {
        return false;
    }
    let period = a.period as usize;
    let turned = |by: usize| {
        a.members
            .iter()
            .zip(&b.members)
            .all(|((s, modes), (t, others))| {
                s == t && (0..period).all(|k| modes.get((k + by) % period) == others.get(k))
            })
    };
    (0..period).any(turned)
}

/// A verdict in words.
pub fn describe(tree: &Tree, verdict: &Verdict) -> String {
    let b = |branch: &usize| format!("b{}", branch + 1);
    match verdict {
        Verdict::Running => "running".into(),
        Verdict::Accepted => "accepted".into(),
        Verdict::Same { branch, load } => format!("same state as {} at load {load}", b(branch)),
        Verdict::Other { branch, load } => {
            format!("another valid state than {} at load {load}", b(branch))
        }
        Verdict::SameCycle { branch } => format!("same cycle as {}", name(tree, *branch)),
        Verdict::Cycle => "cycle".into(),
        Verdict::Diverged => "diverged".into(),
        Verdict::Failed => "failed".into(),
    }
}

/// All branches in one line.
pub fn listed(tree: &Tree) -> String {
    let one = |summary: Summary| {
        let mark = if summary.is_current { "▸" } else { "" };
        let verdict = describe(tree, &summary.verdict);
        format!(
            "{mark}{} ({verdict}, {} minors)",
            summary.name, summary.whole.minors
        )
    };
    let all: Vec<String> = summaries(tree).into_iter().map(one).collect();
    all.join("; ")
}

/// The last place on a branch's line where an increment was accepted at the same load on the same leg of the path.
pub(super) fn accepted_like(tree: &Tree, branch: usize, like: &Strip) -> Option<usize> {
    let same = |strip: &Strip| (strip.load_factor, strip.leg) == (like.load_factor, like.leg);
    accepted(tree, branch)
        .find(|(_, strip)| same(strip))
        .map(|(at, _)| at)
}

/// Places of a branch's line where an increment was accepted, last first.
pub(super) fn accepted(tree: &Tree, branch: usize) -> impl Iterator<Item = (usize, &Strip)> {
    (0..tree.len(branch))
        .rev()
        .filter_map(move |at| tree.point(branch, at).map(|(_, strip)| (at, strip)))
        .filter(|(_, strip)| strip.kind.is_accepted())
}
