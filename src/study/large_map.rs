//! Convergence maps with too many cells to list: groups of runs of one problem, created on demand.
//!
//! Cells are numbered group by group: all runs that differ only in how they are computed stand together, since they are compared
//! with one of them ([`map`](super::map)); scenes and what is varied of their problems change slower, the last path fastest.

use super::figure::{label, short_names};
use super::map::{Ended, Map};
use super::origin;
use super::plan::{self, Layout, Plan, says_how, set_and_varied};
use super::read::{AxisQuantity, Study, Vary};
use super::run::{RunError, Spare, Watch, one};
use super::sums::{Outcome, Sums};
use super::trial::Variant;
use super::verdict::RunVerdict;
use crate::format::SceneError;
use std::num::NonZeroU64;
use std::sync::Arc;

/// More runs than this are a slip of the finger.
const MOST_CELLS: u64 = 10_000_000_000;

/// A map whose cells are not listed.
#[derive(Debug)]
pub struct LargeMap {
    study: Study,
    columns: Vec<String>,
    layouts: Vec<Layout>,
    /// Numbers of cells of a scene, and of those that stand together.
    of_scene: u64,
    together: NonZeroU64,
    tolerance: f64,
}

impl LargeMap {
    /// Lays a map out. That every case is sound shows when its turn comes.
    ///
    /// # Errors
    /// If a scene, a path or the first of all values will not do.
    pub fn new(mut study: Study, tolerance: f64) -> Result<LargeMap, SceneError> {
        plan::check_values(&mut study, MOST_CELLS)?;
        let count = |vary: &mut dyn Iterator<Item = &Vary>| -> u64 {
            vary.map(|vary| vary.values.len() as u64).product()
        };
        let of_scene = count(&mut study.vary.iter());
        let together = count(&mut study.vary.iter().filter(|vary| says_how(&vary.path)));
        let layouts = study.scenes.iter().map(|name| Layout::new(&study, name));
        let map = LargeMap {
            columns: plan::columns(&study),
            layouts: layouts.collect::<Result<_, _>>()?,
            of_scene,
            together: NonZeroU64::new(together).unwrap_or(NonZeroU64::MIN),
            tolerance,
            study,
        };
        for k in 0..map.layouts.len() as u64 {
            map.group(k * map.of_scene)?;
        }
        Ok(map)
    }

    /// Number of all cells.
    pub fn cells(&self) -> u64 {
        self.of_scene * self.layouts.len() as u64
    }

    /// Number of cells that are compared with each other.
    pub fn together(&self) -> NonZeroU64 {
        self.together
    }

    /// All that its results depend on, by name.
    pub fn input(&self) -> Vec<(String, String)> {
        let scenes = self.layouts.iter().map(Layout::input);
        let parts = scenes.chain(set_and_varied(&self.study));
        let tolerance = ("tolerance".to_owned(), format!("{:?}", self.tolerance));
        parts.chain([tolerance]).collect()
    }

    /// What its runs are counted under: the scene where there are several, settings, and what they came to.
    pub fn heads(&self) -> Vec<&str> {
        let heads = self.columns.iter().map(String::as_str);
        let heads = heads.filter(|head| counted(head));
        heads.chain(["verdict"]).collect()
    }

    /// The cells that begin with a number, as a plan.
    fn group(&self, first: u64) -> Result<Plan, SceneError> {
        let layout = &self.layouts[(first / self.of_scene) as usize];
        let problem = first % self.of_scene / self.together;
        let case = |member: u64| {
            let (mut problem, mut member) = (problem, member);
            let mut value = |vary: &Vary| {
                let number = match says_how(&vary.path) {
                    true => &mut member,
                    false => &mut problem,
                };
                let count = vary.values.len() as u64;
                let value = vary.values[(*number % count) as usize].clone();
                *number /= count;
                value
            };
            let mut values: Vec<String> = self.study.vary.iter().rev().map(&mut value).collect();
            values.reverse();
            Ok(layout.case(&self.study, values)?.0)
        };
        let cases = (0..self.together.get()).map(case);
        Ok(Plan {
            study: Study::default(),
            title: String::new(),
            columns: self.columns.clone(),
            cases: cases.collect::<Result<_, SceneError>>()?,
            monitors: Vec::new(),
            x: AxisQuantity::Increment,
            y: AxisQuantity::Load,
        })
    }

    /// Runs the cells that begin with a number, and adds them to sums; false if it was stopped from outside.
    ///
    /// # Errors
    /// If a case is unsound.
    pub fn count(
        &self,
        first: u64,
        sums: &mut Sums,
        spare: &Spare,
        watch: &Watch,
    ) -> Result<bool, RunError> {
        let plan = self.group(first)?;
        let quiet = Watch {
            stop: watch.stop,
            done: &|_| {},
        };
        let mut ended = Vec::with_capacity(plan.cases.len());
        for case in &plan.cases {
            let model = Arc::new(case.model()?);
            let run = one(case.increments, model.clone(), spare, &quiet);
            let Some(end) = Ended::of(&run, &model) else {
                return Ok(false);
            };
            ended.push(Some(end));
        }
        let map = Map::judged(plan, self.tolerance, ended);
        let names = short_names(&self.columns);
        for (k, cell) in map.cells.iter().enumerate() {
            let Some(cell) = cell else { continue };
            let values = &map.plan.cases[k].values;
            let counted = self.columns.iter().zip(values).filter(|(h, _)| counted(h));
            let labels = counted.map(|(_, value)| value.clone());
            let failing = cell.verdict != RunVerdict::Right;
            let detail = match (failing, cell.verdict.detail()) {
                (false, _) => String::new(),
                (true, detail) if detail.is_empty() => label(&names, values),
                (true, detail) => format!("{}: {detail}", label(&names, values)),
            };
            let outcome = Outcome {
                labels: labels.chain([cell.verdict.word().to_owned()]).collect(),
                detail,
                majors: cell.ended.majors,
                minors: cell.ended.minors,
                error: cell.reference.map(|(_, difference)| difference),
                failing,
            };
            sums.count(first + k as u64, outcome);
        }
        Ok(true)
    }

    /// What tables and pictures of it say: what it was made from, and by what.
    pub fn about(&self) -> Vec<String> {
        let mut made = format!("Scenes: {}", self.study.scenes.join(", "));
        for (path, value) in set_and_varied(&self.study) {
            made += &match path.strip_suffix(" over") {
                Some(path) => format!("; {} values of {path}", value.split(", ").count()),
                None => format!("; {path}={value}"),
            };
        }
        let compared = format!(
            "Each end is compared with that of the finest run of the same problem; wrong: a monitor differs by more than {} of the \
             largest value of its kind.",
            self.tolerance
        );
        let by = format!("{} on {}", origin::program(), origin::machine());
        vec![made, compared, by]
    }

    /// Ways in which problems were computed, as the picture calls them.
    pub fn variants(sums: &Sums) -> Vec<Variant> {
        let mut names: Vec<String> = Vec::new();
        for (labels, _) in sums.counts() {
            let name = way(labels);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let variant = |name| Variant {
            name,
            settings: Vec::new(),
        };
        names.into_iter().map(variant).collect()
    }
}

/// Whether runs are counted by the values of a column: strategies and other settings are few, increments may be many.
fn counted(column: &str) -> bool {
    column == "scene" || column.starts_with("settings.")
}

/// How runs that are counted together were computed: their labels but for the verdict.
pub fn way(labels: &[String]) -> String {
    let way = labels.split_last().map_or(&[][..], |(_, way)| way);
    way.join(" ")
}
