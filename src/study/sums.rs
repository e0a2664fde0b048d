//! Sweeps of so many cells that their results are kept as sums, a block of cells at a time.
//!
//! A block is what [`merge`](super::merge) calls a cell: it falls to a shard, is kept in one line, and is done again if it is lost. Its
//! sums are counts, sums of whole numbers, extremes and sketches, all of which come to the same bits in whatever order they are
//! added; and every cell that failed, by its number.

use super::csv::{comments, field};
use super::log::{LogError, ResultKind};
use super::merge::{Cells, Keeping, Kept, Reading, same};
use super::run::{RunError, Watch, pool};
use super::shard::Key;
use super::sketch::Sketch;
use super::sweep_input::Input;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::num::{NonZeroU64, NonZeroUsize};
use std::ops::Range;

/// A sweep of more cells than this is kept as sums.
pub const MANY: u64 = super::plan::MOST_CASES;
/// Cells of a block, where nobody says otherwise.
pub const BLOCK: NonZeroU64 = NonZeroU64::new(10_000).unwrap();
/// Most bytes of the sums of a block in a file: more than what 10,000 cells have that all fail with 17 strategies.
const MOST_LINE: usize = 64 << 20;

/// What a run came to, as far as sums need it.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// What it is counted under, one a head of the sweep.
    pub labels: Vec<String>,
    /// What the labels leave out: the period of a cycle, the reason of a failure.
    pub detail: String,
    /// Major iterations.
    pub majors: u64,
    /// Minor iterations.
    pub minors: u64,
    /// The error by which runs are called worse or better, from 0 to infinity; `None` where there is nothing to compare with.
    pub error: Option<f64>,
    /// Whether it is told by its number.
    pub failing: bool,
}

/// Runs that are counted together.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Count {
    /// How many.
    pub runs: u64,
    majors: u64,
    minors: u64,
    most_minors: u64,
    of_minors: Sketch,
    of_error: Sketch,
    /// The largest error, and the first cell that has it.
    worst: Option<(f64, u64)>,
}

/// A cell that failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Failing {
    cell: u64,
    labels: Vec<String>,
    detail: String,
    majors: u64,
    minors: u64,
    error: Option<f64>,
}

/// Sums over some cells.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Sums {
    counts: BTreeMap<Vec<String>, Count>,
    failing: Vec<Failing>,
}

impl Count {
    fn add(&mut self, other: &Count) {
        self.runs += other.runs;
        self.majors += other.majors;
        self.minors += other.minors;
        self.most_minors = self.most_minors.max(other.most_minors);
        self.of_minors.add_all(&other.of_minors);
        self.of_error.add_all(&other.of_error);
        let larger = |other: &(f64, u64), own: &(f64, u64)| {
            let errors = other.0.total_cmp(&own.0);
            errors.then(own.1.cmp(&other.1)).is_gt()
        };
        if let Some(worst) = other.worst
            && self.worst.is_none_or(|own| larger(&worst, &own))
        {
            self.worst = Some(worst);
        }
    }
}

impl Sums {
    /// Whether runs can have these numbers: errors are from 0 to infinity.
    fn is_sound(&self) -> bool {
        let worst = self.counts.values().filter_map(|count| count.worst);
        let failing = self.failing.iter().filter_map(|run| run.error);
        worst
            .map(|(error, _)| error)
            .chain(failing)
            .all(|error| error >= 0.0)
    }

    /// Counts a run of a cell.
    pub fn count(&mut self, cell: u64, outcome: Outcome) {
        let Outcome {
            labels,
            detail,
            majors,
            minors,
            error,
            failing,
        } = outcome;
        let mut one = Count {
            runs: 1,
            majors,
            minors,
            most_minors: minors,
            worst: error.map(|error| (error, cell)),
            ..Count::default()
        };
        one.of_minors.add(minors as f64);
        error.inspect(|error| one.of_error.add(*error));
        if failing {
            self.failing.push(Failing {
                cell,
                labels: labels.clone(),
                detail,
                majors,
                minors,
                error,
            });
        }
        self.counts.entry(labels).or_default().add(&one);
    }

    /// Adds the sums of the cells that follow.
    pub fn add(&mut self, other: &Sums) {
        for (labels, count) in &other.counts {
            self.counts.entry(labels.clone()).or_default().add(count);
        }
        self.failing.extend(other.failing.iter().cloned());
    }

    /// The counts, each with its labels.
    pub fn counts(&self) -> impl Iterator<Item = (&[String], &Count)> {
        let counts = self.counts.iter();
        counts.map(|(labels, count)| (labels.as_slice(), count))
    }

    /// Number of runs that failed.
    pub fn failing(&self) -> usize {
        self.failing.len()
    }

    /// A row for each combination of labels; `heads` are their names, `lines` say what the table is of.
    pub fn table(&self, heads: &[&str], lines: &[String]) -> String {
        const PARTS: [f64; 3] = [0.5, 0.9, 0.99];
        let mut text = comments(lines);
        text += &heads.join(",");
        text += ",runs,majors,minors,minors_50,minors_90,minors_99,most_minors,error_50,error_90,error_99,worst_error,worst_cell\n";
        for (labels, count) in &self.counts {
            let labels: Vec<String> = labels.iter().map(|label| field(label)).collect();
            let minors = PARTS.map(|part| count.of_minors.quantile(part).to_string());
            let (errors, error, cell) = match count.worst {
                Some((error, cell)) => (
                    PARTS.map(|part| format!("{:?}", count.of_error.quantile(part))),
                    format!("{error:?}"),
                    cell.to_string(),
                ),
                None => Default::default(),
            };
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{},{error},{cell}",
                labels.join(","),
                count.runs,
                count.majors,
                count.minors,
                minors.join(","),
                count.most_minors,
                errors.join(","),
            );
        }
        text
    }

    /// A row for each run that failed, by the number of its cell.
    pub fn failing_table(&self, heads: &[&str], lines: &[String]) -> String {
        let mut text = comments(lines);
        text += &format!("cell,{},detail,majors,minors,error\n", heads.join(","));
        for run in &self.failing {
            let labels: Vec<String> = run.labels.iter().map(|label| field(label)).collect();
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "{},{},{},{},{},{}",
                run.cell,
                labels.join(","),
                field(&run.detail),
                run.majors,
                run.minors,
                run.error
                    .map_or_else(String::new, |error| format!("{error:?}"))
            );
        }
        text
    }
}

/// Runs the cells that belong together and begin with a number, and counts what they came to; false if it was stopped from outside.
type RunCell<'a> = dyn Fn(u64, &mut Sums) -> Result<bool, RunError> + Sync + 'a;

/// A sweep that is kept as sums.
pub struct Large<'a> {
    /// What does it.
    pub what: &'static str,
    /// All that its results depend on, by name.
    pub input: Vec<(String, String)>,
    /// Number of cells.
    pub cells: u64,
    /// Cells that are run together, since they are compared with each other.
    pub together: NonZeroU64,
    /// Cells of a block; as many more as make whole groups of those.
    pub block: NonZeroU64,
    /// Runs those that begin with a number.
    pub run: &'a RunCell<'a>,
}

impl Large<'_> {
    /// Cells of block number b.
    fn block(&self, b: usize) -> Range<u64> {
        let first = b as u64 * self.size();
        first..(first + self.size()).min(self.cells)
    }

    fn size(&self) -> u64 {
        self.block.get().next_multiple_of(self.together.get())
    }

    /// What there is of the sums of the blocks.
    ///
    /// # Errors
    /// If a file will not do.
    pub fn open(&self, keeping: &Keeping) -> Result<Kept<Sums>, LogError> {
        let parts = self.input.iter().flat_map(|(name, value)| [name, value]);
        let input = Key::of(parts.map(String::as_str)).to_string();
        let key = |b: usize| {
            let Range { start, end } = self.block(b);
            let (start, end) = (start.to_string(), end.to_string());
            Key::of(["cells", &start, &end, &input])
        };
        let blocks = self.cells.div_ceil(self.size()) as usize;
        let cells = Cells {
            keys: (0..blocks).map(key).collect(),
            unit: "blocks",
            name: &|b| {
                let Range { start, end } = self.block(b);
                format!("the block of cells {start} to {}", end.saturating_sub(1))
            },
        };
        let reading = Reading {
            kind: ResultKind {
                most: MOST_LINE,
                is_sound: Sums::is_sound,
            },
            join: same,
        };
        let input = || {
            let block = ("block of cells".to_owned(), self.size().to_string());
            let parts = self.input.iter().cloned();
            Input::new(self.what, parts.chain([block]).collect())
        };
        Kept::open(keeping, input, cells, &reading)
    }

    /// Runs those blocks that are to be run here and whose sums are not there; the sums of each, `None` for the others.
    ///
    /// # Errors
    /// If there are no threads to be had, a scene will not do, or sums cannot be kept.
    pub fn run_kept(
        &self,
        kept: &Kept<Sums>,
        jobs: NonZeroUsize,
        watch: &Watch,
    ) -> Result<Vec<Option<Sums>>, RunError> {
        let one = |b: usize| -> Result<Option<Sums>, RunError> {
            let (cells, key) = (self.block(b), kept.key(b));
            if let Some(found) = kept.get(key) {
                (watch.done)(cells.end - cells.start);
                return Ok(Some(found.value.clone()));
            }
            if !kept.does(key) {
                return Ok(None);
            }
            let mut sums = Sums::default();
            for cell in cells.step_by(self.together.get() as usize) {
                if (watch.stop)() || !(self.run)(cell, &mut sums)? {
                    return Ok(None);
                }
                (watch.done)(self.together.get());
            }
            kept.keep(key, &sums)?;
            Ok(Some(sums))
        };
        let pool = pool(jobs, kept.len())?;
        let blocks = (0..kept.len()).into_par_iter().with_max_len(1);
        pool.install(|| blocks.map(one).collect())
    }
}

/// The sums of all blocks together.
pub fn total(blocks: &[Option<Sums>]) -> Sums {
    let mut total = Sums::default();
    blocks.iter().flatten().for_each(|sums| total.add(sums));
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn outcome(k: u64) -> Outcome {
        Outcome {
            labels: vec![(k % 3).to_string()],
            detail: String::new(),
            majors: k % 5,
            minors: (k * k) % 101,
            error: Some(((k * 7) % 13) as f64 / 13.0),
            failing: k.is_multiple_of(7),
        }
    }

    fn sums(cells: Range<u64>) -> Sums {
        let mut sums = Sums::default();
        cells.for_each(|k| sums.count(k, outcome(k)));
        sums
    }

    proptest! {
        #[test]
        fn sums_of_blocks_are_those_of_all_cells(cut in 0_u64..200) {
            let parts = [Some(sums(0..cut)), None, Some(sums(cut..200))];
            prop_assert_eq!(total(&parts), sums(0..200));
        }
    }

    #[test]
    fn a_table_counts_every_run_and_names_every_failing_cell() {
        let sums = sums(0..200);
        let table = sums.table(&["kind"], &["of made-up cells".to_owned()]);
        assert!(
            table.starts_with("# of made-up cells\nkind,runs,majors"),
            "{table}"
        );
        let runs = table
            .lines()
            .skip(2)
            .map(|row| row.split(',').nth(1).unwrap());
        assert_eq!(runs.map(|n| n.parse::<u64>().unwrap()).sum::<u64>(), 200);
        let failing = sums.failing_table(&["kind"], &[]);
        let cells = failing
            .lines()
            .skip(1)
            .map(|row| row.split(',').next().unwrap());
        let cells: Vec<u64> = cells.map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(cells, (0..200).step_by(7).collect::<Vec<_>>());
    }

    #[test]
    fn the_worst_is_the_first_of_equals_in_any_order() {
        let (mut a, mut b) = (sums(0..100), sums(100..200));
        let counts = |sums: &Sums| sums.counts.clone();
        let (first, second) = (a.clone(), b.clone());
        a.add(&second);
        b.add(&first);
        assert_eq!(counts(&a), counts(&b));
    }
}
