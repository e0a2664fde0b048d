//! Surveys: runs all random problems of a population with all variants, and counts the verdicts.

use super::figure::assigned;
use super::origin;
use super::random::Population;
use super::shard::Key;
use super::solver_pool::{SolverPool, Watch};
use super::sweep::{Cell, Sweep};
use super::sweep_input::Input;
use super::trial::{JudgedProblem, Trial, Variant, prepared, try_variants};
use super::verdict::RunVerdict;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The problems, the variants and the verdicts.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// The problems.
    pub population: Population,
    /// Variants tried on each problem.
    pub variants: Vec<Variant>,
    /// One entry per problem, in order; `None` if interrupted before.
    pub judged: Vec<Option<JudgedProblem>>,
}

/// Number of problems by verdict of a variant, separately for problems with and without a solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    /// Problems with a solution.
    pub solvable: usize,
    /// Of these: ended in a right state.
    pub solved: usize,
    /// Of these: ended in a wrong state.
    pub wrong: usize,
    /// Of these: the iterations cycle.
    pub cycled: usize,
    /// Of these: failed in another way.
    pub failed: usize,
    /// Of these: wrongly reported unsolvable.
    pub denied: usize,
    /// Problems without a solution.
    pub unsolvable: usize,
    /// Of these: reported unsolvable.
    pub admitted: usize,
    /// Of these: ended in a state, which is wrong.
    pub invented: usize,
}

/// The problems of a population as cells of a sweep.
pub fn sweep<'a>(population: &'a Population, variants: &'a [Variant]) -> Sweep<'a, JudgedProblem> {
    let name = population.name();
    let settings: Vec<&str> = variants
        .iter()
        .flat_map(|v| &v.settings)
        .flat_map(|(path, value)| [path.as_str(), value])
        .collect();
    let cell = |k: usize| {
        let parts = [name.as_str(), &k.to_string()];
        let key = Key::from_parts(parts.into_iter().chain(settings.iter().copied()));
        Cell {
            key,
            shard: key.mixed(),
            steps: 1,
        }
    };
    // The number of problems does not matter: the first problems of a larger population are the same.
    let tried = variants.iter().map(|variant| {
        let pairs: Vec<String> = assigned(&variant.settings).collect();
        ("strategy".to_owned(), pairs.join(" "))
    });
    let input = std::iter::once(("population".to_owned(), name.clone())).chain(tried);
    let prepared = prepared(variants);
    let compute = move |k: usize, _: &SolverPool, watch: &Watch| {
        if (watch.stop)() {
            return Ok(None);
        }
        let judged = try_variants(population, k, &prepared, watch.stop)?;
        (watch.done)(u64::from(judged.is_some()));
        Ok(judged)
    };
    Sweep {
        input: Input::new("map --random", input.collect()),
        cells: (0..population.count).map(cell).collect(),
        units: ["problems", "problems"],
        is_timed: false,
        runs: variants.len(),
        name: Box::new(move |k| format!("problem {k} of {}", population.name())),
        compute: Box::new(compute),
    }
}

impl Survey {
    /// The completed problems, with their numbers.
    pub fn done(&self) -> impl Iterator<Item = (usize, &JudgedProblem)> {
        self.judged
            .iter()
            .enumerate()
            .filter_map(|(k, judged)| Some((k, judged.as_ref()?)))
    }

    /// Counts the verdicts of variant number `v` on the problems selected by `selected`.
    pub fn tally(&self, v: usize, selected: impl Fn(&JudgedProblem) -> bool) -> Tally {
        let mut tally = Tally::default();
        for (_, judged) in self.done().filter(|(_, judged)| selected(judged)) {
            tally.add(judged.solvable(), judged.trials[v].verdict);
        }
        tally
    }

    /// A table with a row for each problem and variant, after comment lines with its origin.
    pub fn csv(&self) -> String {
        let mut text = super::csv::comments(&self.origin());
        text += "seed,problem,nodes,form,cohesion,answers,strategy,verdict,detail,majors,minors,violation\n";
        for (k, judged) in self.done() {
            for (variant, trial) in self.variants.iter().zip(&judged.trials) {
                let JudgedProblem {
                    nodes,
                    form,
                    cohesive,
                    answers,
                    ..
                } = judged;
                let (word, detail) = (trial.verdict.word(), trial.verdict.detail());
                // Writing to a string does not fail.
                let _ = writeln!(
                    text,
                    "{},{k},{nodes},{form},{cohesive},{answers},{},{word},{detail},{},{},{:?}",
                    self.population.seed,
                    super::csv::field(&variant.name),
                    trial.majors,
                    trial.minors,
                    trial.violation
                );
            }
        }
        text
    }

    /// Totals: a row for each kind of problem, variant and verdict, with the number of problems, the total and
    /// maximum of minor iterations, and the largest violation. It has a few hundred rows, however many problems
    /// there are.
    pub fn totals(&self) -> String {
        let mut sums: BTreeMap<Kind<'_>, Aggregate> = BTreeMap::new();
        for (_, judged) in self.done() {
            for (v, trial) in judged.trials.iter().enumerate() {
                let kind = Kind {
                    nodes: judged.nodes,
                    form: &judged.form,
                    cohesive: judged.cohesive,
                    answers: judged.answers,
                    variant: v,
                    verdict: trial.verdict.word(),
                };
                sums.entry(kind).or_default().add(trial);
            }
        }
        let mut text = super::csv::comments(&self.origin());
        text += "seed,nodes,form,cohesion,answers,strategy,verdict,problems,minors,most_minors,violation\n";
        for (kind, sums) in &sums {
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{},{},{},{},{:?}",
                self.population.seed,
                kind.nodes,
                kind.form,
                kind.cohesive,
                kind.answers,
                super::csv::field(&self.variants[kind.variant].name),
                kind.verdict,
                sums.problems,
                sums.minors,
                sums.most_minors,
                sums.violation
            );
        }
        text
    }

    /// The origin of the survey, for tables and figures.
    pub fn origin(&self) -> Vec<String> {
        let Population { count, .. } = self.population;
        vec![
            format!(
                "{count} random interface problems, {}",
                self.population.name()
            ),
            origin::made_by(),
        ]
    }
}

/// Key of problems and runs that are counted together.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Kind<'a> {
    nodes: usize,
    form: &'a str,
    cohesive: bool,
    answers: usize,
    variant: usize,
    verdict: &'static str,
}

/// Totals of a kind.
#[derive(Default)]
struct Aggregate {
    problems: usize,
    minors: u64,
    most_minors: u64,
    violation: f64,
}

impl Aggregate {
    fn add(&mut self, trial: &Trial) {
        self.problems += 1;
        self.minors += trial.minors;
        self.most_minors = self.most_minors.max(trial.minors);
        self.violation = self.violation.max(trial.violation);
    }
}

impl Tally {
    fn add(&mut self, solvable: bool, verdict: RunVerdict) {
        let counted = match (solvable, verdict) {
            (false, _) => &mut self.unsolvable,
            (true, _) => &mut self.solvable,
        };
        *counted += 1;
        *match (solvable, verdict) {
            (false, RunVerdict::NoAnswer) => &mut self.admitted,
            (false, RunVerdict::Wrong) => &mut self.invented,
            (false, _) => return,
            (true, RunVerdict::Right) => &mut self.solved,
            (true, RunVerdict::Wrong) => &mut self.wrong,
            (true, RunVerdict::Cycle { .. }) => &mut self.cycled,
            (true, RunVerdict::NoAnswer) => &mut self.denied,
            (true, RunVerdict::Failed(_) | RunVerdict::Diverged) => &mut self.failed,
        } += 1;
    }

    /// Converts a number of problems with a solution to a rate per 1,000 of them.
    pub fn per_thousand(&self, count: usize) -> f64 {
        1000.0 * count as f64 / self.solvable.max(1) as f64
    }
}
