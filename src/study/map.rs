//! Convergence maps of scenes: a cell for each combination of settings.
//!
//! A finished run may be on a wrong branch. Its end is compared with that of a reference. Candidates are all
//! runs that differ only in how they are computed (`settings.…`, `history.increment`); the reference is the one
//! with the smallest increment that finished with every loop settled; among equals the one with the default
//! strategy, then the first. If the reference is wrong, so is the map; it therefore names its references.
//! Without a reference, a finished run counts as converged, and the table shows that it was not compared.

use super::figure::{changes, label, name, short_names};
use super::log::Outcome;
use super::monitor_kind::{MonitorKind, kind};
use super::origin;
use super::plan::{Plan, poses};
use super::result::{CaseEnd, Run};
use super::run::cells;
use super::sweep::Sweep;
use super::verdict::RunVerdict;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeSet, HashMap};
use std::fmt::Write;
use std::sync::Arc;
use stickslip_core::Model;
use stickslip_core::groups::distinct;
use stickslip_core::plane::max_abs;
use stickslip_scene::{first_of, joined};

/// Default tolerance: runs whose ends differ by more than this fraction of the largest value are on different
/// branches.
pub const TOLERANCE: f64 = 1e-2;

/// The strategy of scenes that do not set one.
const DEFAULT_STRATEGY: &str = "ladder";

/// The result of a run, reduced to what a map needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapRun {
    /// Verdict, increment and load factor of a failure; `None` if the run finished.
    pub failed: Option<(RunVerdict, u32, f64)>,
    /// Accepted increments.
    pub increments: u64,
    /// Major iterations.
    pub majors: u64,
    /// Minor iterations.
    pub minors: u64,
    /// Increments accepted although a loop had not settled.
    pub unsettled: u64,
    /// Increments that jumped to another branch of equilibrium.
    #[serde(default)]
    pub jumped: u64,
    /// The monitors that are compared.
    pub monitors: Vec<FinalMonitor>,
}

/// A monitor of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FinalMonitor {
    /// Name of the monitor.
    pub name: String,
    /// Kind of the monitor, which determines the scale of differences.
    pub kind: MonitorKind,
    /// Its final value.
    pub end: f64,
    /// Its largest magnitude.
    pub largest: f64,
}

/// A cell of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapCell {
    /// The result of the run.
    pub ended: MapRun,
    /// Its verdict.
    pub verdict: RunVerdict,
    /// The reference case (its own number if it is one), and the largest difference of a monitor's final value,
    /// relative to the largest value of that kind.
    pub reference: Option<(usize, f64)>,
}

/// A convergence map.
#[derive(Debug, Clone)]
pub struct Map {
    /// The plan of the runs.
    pub plan: Arc<Plan>,
    /// Title.
    pub title: String,
    /// Larger differences mean a wrong branch.
    pub tolerance: f64,
    /// One entry per case of the plan; `None` if interrupted before.
    pub cells: Vec<Option<MapCell>>,
}

/// A grid of cells: the last column of the plan is horizontal, the one before it vertical.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Panel {
    /// The settings that all its cells share; may be empty.
    pub name: String,
    /// Name of the horizontal axis.
    pub x: String,
    /// Name of the vertical axis.
    pub y: String,
    /// Values of the horizontal axis.
    pub columns: Vec<String>,
    /// Values of the vertical axis.
    pub rows: Vec<String>,
    /// Numbers of cases, row by row.
    pub cells: Vec<Vec<usize>>,
}

impl Outcome for MapRun {
    const MAX_BYTES: usize = 1 << 20;

    fn is_sound(&self) -> bool {
        let failed = self.failed.is_none_or(|(_, _, load)| load.is_finite());
        let mut monitors = self.monitors.iter();
        failed && monitors.all(|seen| seen.end.is_finite() && seen.largest.is_finite())
    }
}

impl MapRun {
    /// The result of a run; `None` if interrupted.
    pub fn from_run(run: &Run, model: &Model) -> Option<MapRun> {
        let failed = match &run.end {
            CaseEnd::Finished => None,
            CaseEnd::Failed(failed) => Some((failed.verdict, failed.increment, failed.load)),
            CaseEnd::Interrupted | CaseEnd::NotRun => return None,
        };
        let monitor = |k: usize| {
            let value = |row: &super::Row| row.monitors.get(k).copied().unwrap_or(0.0);
            let all = std::iter::once(&run.start).chain(&run.rows);
            FinalMonitor {
                name: run.monitors[k].clone(),
                kind: kind(model, &model.monitors[k].of),
                end: value(run.last()),
                largest: max_abs(all.map(value)),
            }
        };
        Some(MapRun {
            failed,
            increments: run.rows.len() as u64,
            majors: run.majors(),
            minors: run.minors(),
            unsettled: run.unsettled() as u64,
            jumped: run.jumped() as u64,
            monitors: (0..run.monitors.len()).map(monitor).collect(),
        })
    }

    /// Largest difference of a monitor's final value from the reference's, relative to the largest value of its
    /// kind in the reference's run; infinite if a number is NaN.
    pub fn difference(&self, reference: &MapRun) -> f64 {
        let scale = |kind: MonitorKind| {
            reference
                .monitors
                .iter()
                .filter(|m| m.kind == kind)
                .map(|m| m.largest)
                .fold(f64::MIN_POSITIVE, f64::max)
        };
        let differences = reference
            .monitors
            .iter()
            .filter(|m| m.kind.is_compared())
            .map(|theirs| {
                let ours = self.monitors.iter().find(|m| m.name == theirs.name);
                let difference = ours.map_or(f64::INFINITY, |ours| {
                    (ours.end - theirs.end).abs() / scale(theirs.kind)
                });
                if difference.is_nan() {
                    f64::INFINITY
                } else {
                    difference
                }
            });
        differences.fold(0.0, f64::max)
    }
}

impl MapCell {
    /// The glyph of the cell; with the period for a cycle, and the letter of the reason for a failure. A run
    /// that jumped has `↯` after it.
    pub fn label(&self) -> String {
        let glyph = self.verdict.glyph();
        let jumped = if self.ended.jumped > 0 { "↯" } else { "" };
        let label = match self.verdict {
            RunVerdict::Cycle { period, .. } => format!("{glyph}{period}"),
            RunVerdict::Failed(reason) => format!("{glyph}{}", reason.letter()),
            _ => format!("{glyph}{}", self.verdict.letter()),
        };
        label + jumped
    }
}

/// The cases of a plan as cells of a sweep; the cases of one problem, which are compared with each other,
/// belong to one shard.
pub fn sweep(plan: &Plan) -> Sweep<'_, MapRun> {
    cells(plan, ["map", "cells"], poses, |run, model| {
        MapRun::from_run(&run, model)
    })
}

impl Map {
    /// Compares the final values.
    pub fn judged(plan: impl Into<Arc<Plan>>, tolerance: f64, ended: Vec<Option<MapRun>>) -> Map {
        let plan = plan.into();
        let mut groups: HashMap<Vec<&str>, Vec<usize>> = HashMap::new();
        for (k, case) in plan.cases.iter().enumerate() {
            groups.entry(plan.posed(case)).or_default().push(k);
        }
        let mut references = vec![None; plan.cases.len()];
        for members in groups.values() {
            let reference = reference(&plan, members, &ended);
            // A single run has no reference.
            if members.len() > 1 {
                members.iter().for_each(|&k| references[k] = reference);
            }
        }
        let cell = |k: usize| -> Option<MapCell> {
            let own = ended[k].as_ref()?;
            let compared =
                references[k].and_then(|r: usize| Some((r, own.difference(ended[r].as_ref()?))));
            let verdict = match (own.failed, compared) {
                (Some((verdict, ..)), _) => verdict,
                (None, Some((_, difference))) if difference > tolerance => RunVerdict::Wrong,
                (None, _) => RunVerdict::Right,
            };
            Some(MapCell {
                verdict,
                reference: compared.filter(|_| own.failed.is_none()),
                ended: own.clone(),
            })
        };
        let cells = (0..plan.cases.len()).map(cell).collect();
        Map {
            title: title(&plan),
            plan,
            tolerance,
            cells,
        }
    }

    /// The map as grids.
    pub fn panels(&self) -> Vec<Panel> {
        let names = short_names(&self.plan.columns);
        let count = names.len();
        let mut panels: Vec<Panel> = Vec::new();
        for (k, case) in self.plan.cases.iter().enumerate() {
            let inner = count.min(2);
            let (outer, inner) = case.values.split_at(count - inner);
            let name = label(&names[..outer.len()], outer);
            let (row, column) = match inner {
                [] => (String::new(), String::new()),
                [column] => (String::new(), column.clone()),
                [row, column, ..] => (row.clone(), column.clone()),
            };
            if panels.last().is_none_or(|panel| panel.name != name) {
                let axis = |back: usize| count.checked_sub(back).map(|k| names[k].clone());
                panels.push(Panel {
                    name,
                    x: axis(1).unwrap_or_default(),
                    y: axis(2).unwrap_or_default(),
                    columns: Vec::new(),
                    rows: Vec::new(),
                    cells: Vec::new(),
                });
            }
            let Some(panel) = panels.last_mut() else {
                continue;
            };
            if panel.rows.last() != Some(&row) {
                panel.rows.push(row);
                panel.cells.push(Vec::new());
            }
            if !panel.columns.contains(&column) {
                panel.columns.push(column);
            }
            if let Some(cells) = panel.cells.last_mut() {
                cells.push(k);
            }
        }
        panels
    }

    /// The letters of the failures in the map, and the mark of jumps.
    pub fn signs(&self) -> Option<String> {
        let cells = || self.cells.iter().flatten();
        let failed = cells().filter_map(|cell| match cell.verdict {
            RunVerdict::Failed(reason) => Some(format!("✗{} {reason}", reason.letter())),
            _ => None,
        });
        let jumped = cells().filter(|cell| cell.ended.jumped > 0);
        let signs = joined(
            failed
                .chain(jumped.map(|_| "↯ jumped on the way".to_owned()))
                .collect::<BTreeSet<_>>(),
            "   ",
        );
        (!signs.is_empty()).then_some(signs)
    }

    /// Origin of the map, for footers.
    pub fn origin(&self) -> Vec<String> {
        let study = &self.plan.study;
        let mut made = match study.scenes.len() {
            0..=4 => format!("Scene: {}", study.scenes.join(", ")),
            n => format!("{n} scenes"),
        };
        made += &changes(study);
        let cells = self.cells.iter().flatten();
        let named = distinct(cells.filter_map(|c| Some(c.reference?.0)));
        const SHOWN: usize = 4;
        let names = first_of(named.iter().map(|&k| self.name(k)), SHOWN, "; ");
        let compared = if names.is_empty() {
            "Nothing was compared: no two finished runs solve the same problem.".to_owned()
        } else {
            format!(
                "Ends are compared with those of {names}; wrong: a monitor differs by more than {} of the largest value \
                 of its kind.",
                self.tolerance
            )
        };
        vec![made, compared, origin::made_by()]
    }

    /// The settings that distinguish a case.
    pub fn name(&self, case: usize) -> String {
        name(&self.plan, case)
    }

    /// A table with a row for each cell, after comment lines with its origin.
    pub fn csv(&self) -> String {
        let mut text = super::csv::comments(&self.origin());
        let words = [
            "verdict",
            "detail",
            "failed_increment",
            "failed_load",
            "increments",
            "majors",
            "minors",
            "unsettled",
            "difference",
            "reference",
            "jumped",
        ];
        let heads = self.plan.columns.iter().map(String::as_str).chain(words);
        text += &(joined(heads, ",") + "\n");
        for (case, cell) in self.plan.cases.iter().zip(&self.cells) {
            let Some(cell) = cell else { continue };
            let MapRun {
                failed,
                increments,
                majors,
                minors,
                unsettled,
                jumped,
                ..
            } = &cell.ended;
            for value in &case.values {
                text += &(super::csv::field(value) + ",");
            }
            let (increment, load) = match failed {
                Some((_, increment, load)) => (increment.to_string(), format!("{load:?}")),
                None => Default::default(),
            };
            let (difference, reference) = match cell.reference {
                Some((k, difference)) => {
                    (format!("{difference:?}"), super::csv::field(&self.name(k)))
                }
                None => Default::default(),
            };
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "{},{},{increment},{load},{increments},{majors},{minors},{unsettled},{difference},{reference},{jumped}",
                cell.verdict.word(),
                cell.verdict.detail(),
            );
        }
        text
    }
}

/// The reference among some cases.
fn reference(plan: &Plan, members: &[usize], ended: &[Option<MapRun>]) -> Option<usize> {
    members
        .iter()
        .copied()
        .filter(|k| {
            ended[*k]
                .as_ref()
                .is_some_and(|e| e.failed.is_none() && e.unsettled == 0)
        })
        .min_by_key(|k| {
            let case = &plan.cases[*k];
            let strategy = case.value("settings.strategy");
            let other = strategy.is_some_and(|strategy| strategy != DEFAULT_STRATEGY);
            (std::cmp::Reverse(case.increments), other, *k)
        })
}

fn title(plan: &Plan) -> String {
    match plan.study.scenes.as_slice() {
        [_] => format!("Convergence of “{}”", plan.title),
        scenes => format!("Convergence of {} scenes", scenes.len()),
    }
}
