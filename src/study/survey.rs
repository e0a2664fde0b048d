//! All random problems of a population with all variants: run, counted, and as a table.

use super::figure::assigned;
use super::one::{Spare, Watch};
use super::origin;
use super::random::Population;
use super::shard::Key;
use super::sweep::{Cell, Sweep};
use super::sweep_input::Input;
use super::trial::{Judged, Trial, Variant, prepared, try_variants};
use super::verdict::RunVerdict;
use std::collections::BTreeMap;
use std::fmt::Write;

/// What is tried, and what came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// The problems.
    pub population: Population,
    /// What is tried on each of them.
    pub variants: Vec<Variant>,
    /// One a problem, in order; `None` if it was stopped before.
    pub judged: Vec<Option<Judged>>,
}

/// How a variant fared, in numbers of problems. Those that have an answer are told apart from those that have none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    /// Problems with an answer, and what the runs on them came to.
    pub solvable: usize,
    /// Those of them that ended in a right state.
    pub solved: usize,
    /// Those that ended in a wrong one.
    pub wrong: usize,
    /// Those whose iterations went round for ever.
    pub cycled: usize,
    /// Those that failed in another way.
    pub failed: usize,
    /// Said to have no answer, wrongly.
    pub denied: usize,
    /// Problems without an answer, and those of them that were said to have none.
    pub unsolvable: usize,
    /// Those without an answer that were said to have none.
    pub admitted: usize,
    /// Those that ended in a state, which is wrong.
    pub invented: usize,
}

/// The problems of a population as cells of a sweep.
pub fn sweep<'a>(population: &'a Population, variants: &'a [Variant]) -> Sweep<'a, Judged> {
    let name = population.name();
    let settings = variants.iter().flat_map(|v| &v.settings);
    let settings = settings.flat_map(|(path, value)| [path.as_str(), value]);
    let settings: Vec<&str> = settings.collect();
    let cell = |k: usize| {
        let parts = [name.as_str(), &k.to_string()];
        let key = Key::of(parts.into_iter().chain(settings.iter().copied()));
        Cell {
            key,
            shard: key.mixed(),
            steps: 1,
        }
    };
    // Not how many there are: the first problems of a larger population are the same.
    let tried = variants.iter().map(|variant| {
        let pairs: Vec<String> = assigned(&variant.settings).collect();
        ("strategy".to_owned(), pairs.join(" "))
    });
    let input = std::iter::once(("population".to_owned(), name.clone())).chain(tried);
    let prepared = prepared(variants);
    let compute = move |k: usize, _: &Spare, watch: &Watch| {
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
    /// The problems that were done, with their numbers.
    pub fn done(&self) -> impl Iterator<Item = (usize, &Judged)> {
        let all = self.judged.iter().enumerate();
        all.filter_map(|(k, judged)| Some((k, judged.as_ref()?)))
    }

    /// How variant number `v` fared on the problems that are meant.
    pub fn tally(&self, v: usize, meant: impl Fn(&Judged) -> bool) -> Tally {
        let mut tally = Tally::default();
        for (_, judged) in self.done().filter(|(_, judged)| meant(judged)) {
            tally.add(judged.solvable(), judged.trials[v].verdict);
        }
        tally
    }

    /// A table with a row for each problem and variant, after lines that say what it is.
    pub fn csv(&self) -> String {
        let mut text = super::csv::comments(&self.origin());
        text += "seed,problem,nodes,form,cohesion,answers,strategy,verdict,detail,majors,minors,violation\n";
        for (k, judged) in self.done() {
            for (variant, trial) in self.variants.iter().zip(&judged.trials) {
                let Judged {
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

    /// The same as sums: a row for each kind of problem, variant and verdict, with the number of problems, their minor
    /// iterations together and the most of one, and the largest violation. However many problems there are, it has a few
    /// hundred rows.
    pub fn totals(&self) -> String {
        let mut sums: BTreeMap<Kind<'_>, Sums> = BTreeMap::new();
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

    /// What it was made of, and by what.
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

/// Problems and runs that are counted together.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Kind<'a> {
    nodes: usize,
    form: &'a str,
    cohesive: bool,
    answers: usize,
    variant: usize,
    verdict: &'static str,
}

/// What is known of those that are counted together.
#[derive(Default)]
struct Sums {
    problems: usize,
    minors: u64,
    most_minors: u64,
    violation: f64,
}

impl Sums {
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

    /// A number of problems that have an answer, per 1,000 of them.
    pub fn per_thousand(&self, count: usize) -> f64 {
        1000.0 * count as f64 / self.solvable.max(1) as f64
    }
}
