//! All random problems of a population with all variants: run, counted, and as a table.

use super::log::{LogError, ResultKind};
use super::merge::{Cells, Keeping, Kept, Reading, same};
use super::origin;
use super::random::Population;
use super::run::{RunError, Watch, pool};
use super::shard::Key;
use super::sums::{Outcome, Sums as BlockSums};
use super::sweep_input::Input;
use super::trial::{Judged, Prepared, Trial, Variant, prepared, try_variants};
use super::verdict::RunVerdict;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::num::NonZeroUsize;
use std::path::Path;

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

/// Most bytes of a result in a file.
const MOST_LINE: usize = 1 << 20;

/// The key of a problem's result.
fn key(population: &Population, variants: &[Variant], k: usize) -> Key {
    let (name, number) = (population.name(), k.to_string());
    let settings = variants.iter().flat_map(|v| &v.settings);
    let settings = settings.flat_map(|(path, value)| [path.as_str(), value]);
    Key::of([name.as_str(), &number].into_iter().chain(settings))
}

/// What there is of the results of a population's problems.
///
/// # Errors
/// If a file will not do.
pub fn open(
    population: &Population,
    variants: &[Variant],
    keeping: &Keeping,
) -> Result<Kept<Judged>, LogError> {
    let numbers = 0..population.count;
    let cells = Cells {
        keys: numbers.map(|k| key(population, variants, k)).collect(),
        unit: "problems",
        name: &|k| format!("problem {k} of {}", population.name()),
    };
    let reading = Reading {
        kind: ResultKind {
            most: MOST_LINE,
            is_sound: Judged::is_sound,
        },
        join: same,
    };
    let input = || Input::new("map --random", input(population, variants));
    Kept::open(keeping, input, cells, &reading)
}

/// All that the results of problems depend on, by name; not how many there are.
pub fn input(population: &Population, variants: &[Variant]) -> Vec<(String, String)> {
    let settings = |variant: &Variant| {
        let pairs = variant.settings.iter();
        let pairs: Vec<String> = pairs
            .map(|(path, value)| format!("{path}={value}"))
            .collect();
        pairs.join(" ")
    };
    let of = ("population".to_owned(), population.name());
    let tried = variants
        .iter()
        .map(|v| ("strategy".to_owned(), settings(v)));
    std::iter::once(of).chain(tried).collect()
}

/// What the sums of a population are counted under.
pub const HEADS: [&str; 7] = [
    "nodes", "form", "cohesion", "answers", "solvable", "strategy", "verdict",
];

/// Runs a problem with all variants and adds it to sums; false if it was stopped from outside.
///
/// # Errors
/// If a variant will not do.
pub fn count(
    population: &Population,
    variants: &[Prepared<'_>],
    k: u64,
    sums: &mut BlockSums,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<bool, RunError> {
    let Some(judged) = try_variants(population, k as usize, variants, stop)? else {
        return Ok(false);
    };
    let solvable = judged.solvable();
    for (variant, trial) in variants.iter().zip(&judged.trials) {
        let wanted = match solvable {
            true => RunVerdict::Right,
            false => RunVerdict::NoAnswer,
        };
        let labels = [
            judged.nodes.to_string(),
            judged.form.clone(),
            judged.cohesive.to_string(),
            judged.answers.to_string(),
            solvable.to_string(),
            variant.name().to_owned(),
            trial.verdict.word().to_owned(),
        ];
        let outcome = Outcome {
            labels: labels.to_vec(),
            detail: trial.verdict.detail(),
            majors: trial.majors,
            minors: trial.minors,
            error: Some(trial.violation),
            failing: trial.verdict != wanted,
        };
        sums.count(k, outcome);
    }
    Ok(true)
}

/// How each variant fared, by the sums of a population.
pub fn tallies(variants: &[Variant], sums: &BlockSums) -> Vec<Tally> {
    let mut tallies = vec![Tally::default(); variants.len()];
    for (labels, count) in sums.counts() {
        let [.., solvable, strategy, verdict] = labels else {
            continue;
        };
        let own = variants.iter().zip(&mut tallies);
        for (_, tally) in own.filter(|(variant, _)| variant.name == *strategy) {
            tally.add(solvable == "true", verdict, count.runs as usize);
        }
    }
    tallies
}

impl Survey {
    /// Runs what has to be run. With a file, what is kept there is not run again, and what is run is kept there.
    ///
    /// # Errors
    /// If there are no threads to be had, a variant will not do, or the file will not.
    pub fn run(
        population: Population,
        variants: Vec<Variant>,
        kept: Option<&Path>,
        jobs: NonZeroUsize,
        watch: &Watch,
    ) -> Result<Survey, RunError> {
        let keeping = kept.map_or(Keeping::Nowhere, |path| Keeping::Beside(path.to_owned()));
        let kept = open(&population, &variants, &keeping)?;
        Survey::run_kept(population, variants, &kept, jobs, watch)
    }

    /// Runs what is to be run here and is not there.
    ///
    /// # Errors
    /// As [`Survey::run`].
    pub fn run_kept(
        population: Population,
        variants: Vec<Variant>,
        kept: &Kept<Judged>,
        jobs: NonZeroUsize,
        watch: &Watch,
    ) -> Result<Survey, RunError> {
        let prepared = prepared(&variants);
        let one = |k: usize| -> Result<Option<Judged>, RunError> {
            let key = key(&population, &variants, k);
            if let Some(found) = kept.get(key) {
                if found.value.trials.len() != variants.len() {
                    let (has, wants) = (found.value.trials.len(), variants.len());
                    let message = format!("it is of {has} trials, and its problem has {wants}");
                    return Err(kept.broken(key, &message).into());
                }
                (watch.done)(1);
                return Ok(Some(found.value.clone()));
            }
            if !kept.does(key) || (watch.stop)() {
                return Ok(None);
            }
            let judged = try_variants(&population, k, &prepared, watch.stop)?;
            if let Some(judged) = &judged {
                kept.keep(key, judged)?;
            }
            (watch.done)(u64::from(judged.is_some()));
            Ok(judged)
        };
        let pool = pool(jobs, population.count)?;
        let judged: Result<Vec<_>, RunError> =
            pool.install(|| (0..population.count).into_par_iter().map(one).collect());
        let judged = judged?;
        Ok(Survey {
            population,
            variants,
            judged,
        })
    }

    /// The problems that were done, with their numbers.
    pub fn done(&self) -> impl Iterator<Item = (usize, &Judged)> {
        let all = self.judged.iter().enumerate();
        all.filter_map(|(k, judged)| Some((k, judged.as_ref()?)))
    }

    /// How variant number `v` fared on the problems that are meant.
    pub fn tally(&self, v: usize, meant: impl Fn(&Judged) -> bool) -> Tally {
        let mut tally = Tally::default();
        for (_, judged) in self.done().filter(|(_, judged)| meant(judged)) {
            tally.add(judged.solvable(), judged.trials[v].verdict.word(), 1);
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
        about(&self.population)
    }
}

/// What a table of a population was made of, and by what.
pub fn about(population: &Population) -> Vec<String> {
    let Population { count, .. } = population;
    let made = format!("{count} random interface problems, {}", population.name());
    vec![
        made,
        format!("{} on {}", origin::program(), origin::machine()),
    ]
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
    /// Counts some runs of a verdict, by its word.
    pub fn add(&mut self, solvable: bool, verdict: &str, runs: usize) {
        if !solvable {
            self.unsolvable += runs;
            match verdict {
                "no-answer" => self.admitted += runs,
                "wrong" => self.invented += runs,
                _ => {}
            }
            return;
        }
        self.solvable += runs;
        *match verdict {
            "converged" => &mut self.solved,
            "wrong" => &mut self.wrong,
            "cycle" => &mut self.cycled,
            "no-answer" => &mut self.denied,
            _ => &mut self.failed,
        } += runs;
    }

    /// A number of problems that have an answer, per 1,000 of them.
    pub fn per_thousand(&self, count: usize) -> f64 {
        1000.0 * count as f64 / self.solvable.max(1) as f64
    }
}
