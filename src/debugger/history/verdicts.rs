//! How each branch ended, found by comparing it with earlier branches.

use super::branches::{Cost, cost, name};
use super::compare;
use super::frame::Frame;
use super::strip::PointKind;
use super::tree::Tree;
use stickslip_core::{Cycle, Failure, Outcome};
use stickslip_scene::shortest;

/// How a branch ends so far. Branches are numbers in [`Tree::branches`].
#[derive(Debug, Clone, PartialEq)]
pub enum BranchEnd {
    /// Inside an increment, or before the first iteration.
    Unfinished,
    /// At an accepted increment that no other branch has reached.
    Accepted,
    /// Displacements and forces equal those of an earlier branch at the same load.
    Same {
        /// The earlier branch.
        branch: usize,
        /// Load factor λ of the comparison.
        load: f64,
    },
    /// At an accepted increment whose state fails the check; no earlier branch has the same state.
    Marked,
    /// An earlier branch accepted a different state at the same load; both are valid.
    Other {
        /// The earlier branch.
        branch: usize,
        /// Load factor λ of the comparison.
        load: f64,
    },
    /// The same cycle as an earlier branch, in the same increment.
    SameCycle {
        /// The earlier branch.
        branch: usize,
    },
    /// A cycle.
    Cycle,
    /// The residual or the displacements diverged.
    Diverged,
    /// Failed for another reason.
    Failed,
}

/// Summary of a branch.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Number in order of creation, from 0; `b1` has number 0.
    pub number: usize,
    /// `b2: beam.5 sliding`
    pub name: String,
    /// Number of its parent; `None` for the first.
    pub parent: Option<usize>,
    /// Number of points on its line, including those of its parents.
    pub length: usize,
    /// Whether it is the session's current branch.
    pub is_current: bool,
    /// Load factor λ of its last minor iteration.
    pub load_factor: f64,
    /// How it ends.
    pub verdict: BranchEnd,
    /// Cost of the points after the fork.
    pub own: Cost,
    /// Cost of its whole line.
    pub whole: Cost,
}

/// Summaries of all branches.
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
        length,
        is_current: number == tree.current(),
        load_factor: tip.load_factor,
        verdict: verdict(tree, number),
        own: cost(tree, number, branch.from..length),
        whole: cost(tree, number, 0..length),
    })
}

/// How a branch ends. It is compared with earlier branches only: of several equal ones, the first is the
/// reference.
pub fn verdict(tree: &Tree, branch: usize) -> BranchEnd {
    let Some((frame, tip)) = tree.tip(branch) else {
        return BranchEnd::Unfinished;
    };
    let others = || (0..tree.branches().len()).filter(|&other| other < branch);
    match tip.kind {
        PointKind::Start
        | PointKind::Intervention
        | PointKind::Minor
        | PointKind::Damped
        | PointKind::Climbed
        | PointKind::Cut
        | PointKind::Refused
        | PointKind::Major => BranchEnd::Unfinished,
        PointKind::Cycle => {
            let own = cycle(frame);
            let same = |&other: &usize| {
                let Some((frame, strip)) = tree.tip(other) else {
                    return false;
                };
                strip.position.increment == tip.position.increment
                    && own
                        .zip(cycle(frame))
                        .is_some_and(|(a, b)| is_same_cycle(a, b))
            };
            others()
                .find(same)
                .map_or(BranchEnd::Cycle, |branch| BranchEnd::SameCycle { branch })
        }
        PointKind::Failed => match frame.event.as_deref().map(|event| &event.outcome) {
            Some(Outcome::Failed(Failure::Diverged { .. })) => BranchEnd::Diverged,
            _ => BranchEnd::Failed,
        },
        PointKind::Increment | PointKind::Jumped | PointKind::Last | PointKind::LastJumped => {
            let mut other = None;
            for earlier in others() {
                match compare::sameness(tree, branch, earlier) {
                    Some((true, load)) => {
                        return BranchEnd::Same {
                            branch: earlier,
                            load,
                        };
                    }
                    // A state that fails the check does not count as another valid state.
                    Some((false, load)) if !ends_marked(tree, earlier) => {
                        other.get_or_insert(BranchEnd::Other {
                            branch: earlier,
                            load,
                        });
                    }
                    _ => {}
                }
            }
            if ends_marked(tree, branch) {
                BranchEnd::Marked
            } else {
                other.unwrap_or(BranchEnd::Accepted)
            }
        }
    }
}

/// Whether the last state of a branch fails the check.
fn ends_marked(tree: &Tree, branch: usize) -> bool {
    let event = tree
        .tip(branch)
        .and_then(|(frame, _)| frame.event.as_deref());
    event.is_some_and(|event| {
        matches!(
            &event.outcome,
            Outcome::Increment {
                marked: Some(_),
                ..
            }
        )
    })
}

fn cycle(frame: &Frame) -> Option<&Cycle> {
    match &frame.event.as_deref()?.outcome {
        Outcome::Failed(Failure::Cycle(cycle)) => Some(cycle),
        _ => None,
    }
}

/// Whether two cycles have the same period, members and patterns, up to a shift.
fn is_same_cycle(a: &Cycle, b: &Cycle) -> bool {
    if a.period != b.period || a.members.len() != b.members.len() {
        return false;
    }
    let period = a.period as usize;
    (0..period).any(|by| {
        a.members
            .iter()
            .zip(&b.members)
            .all(|((s, modes), (t, others))| {
                s == t && (0..period).all(|k| modes.get((k + by) % period) == others.get(k))
            })
    })
}

/// A verdict in words.
pub fn describe(tree: &Tree, verdict: &BranchEnd) -> String {
    let b = |branch: &usize| format!("b{}", branch + 1);
    match verdict {
        BranchEnd::Unfinished => "unfinished".into(),
        BranchEnd::Accepted => "accepted".into(),
        BranchEnd::Marked => "accepted, but fails the check".into(),
        BranchEnd::Same { branch, load } => {
            format!("same state as {} at load {}", b(branch), shortest(*load))
        }
        BranchEnd::Other { branch, load } => {
            format!(
                "valid, but different from {} at load {}",
                b(branch),
                shortest(*load)
            )
        }
        BranchEnd::SameCycle { branch } => format!("same cycle as {}", name(tree, *branch)),
        BranchEnd::Cycle => "cycle".into(),
        BranchEnd::Diverged => "diverged".into(),
        BranchEnd::Failed => "failed".into(),
    }
}

/// The branches in the order of the tree view: number and depth, children after their parent.
pub fn order(all: &[Summary]) -> Vec<(usize, usize)> {
    let mut order = Vec::with_capacity(all.len());
    let mut left: Vec<(usize, usize)> = all
        .iter()
        .filter(|branch| branch.parent.is_none())
        .map(|branch| (branch.number, 0))
        .collect();
    while let Some((number, depth)) = left.pop() {
        order.push((number, depth));
        let children = all.iter().rev().filter(|b| b.parent == Some(number));
        left.extend(children.map(|b| (b.number, depth + 1)));
    }
    order
}

/// All branches in one line.
pub fn listed(tree: &Tree) -> String {
    let all: Vec<String> = summaries(tree)
        .into_iter()
        .map(|summary| {
            let mark = if summary.is_current { "▸" } else { "" };
            let verdict = describe(tree, &summary.verdict);
            format!(
                "{mark}{} ({verdict}, {} minor)",
                summary.name, summary.whole.minors
            )
        })
        .collect();
    all.join("; ")
}
