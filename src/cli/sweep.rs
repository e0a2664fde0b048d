//! Shared by all sweeps: `--shard`, `--log`, `--merge`, running, and reporting.

use super::base::{Error, Exit, notify, quoted, usage};
use super::interrupt::Interrupt;
use super::outputs::{OutputArgs, Outputs};
use std::path::PathBuf;
use stickslip_scene::joined;
use stickslip_study::Watch;
use stickslip_study::drawn::PlotError;
use stickslip_study::log::Outcome;
use stickslip_study::origin;
use stickslip_study::shard::{Shard, ranges};
use stickslip_study::sheet::Sheet;
use stickslip_study::sweep::{MissingCells, ResultStorage, Store, Sweep};

/// Which part of a sweep is run, and where its results are stored and written.
#[derive(Debug, clap::Args)]
pub struct SweepArgs {
    /// Runs only the cells of shard K of N, and writes their rows (--csv) or stores them (--log); page cluster
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// Stores each result in this file as it arrives, and continues from the results in it
    #[arg(long, value_name = "FILE", alias = "resume")]
    log: Option<PathBuf>,
    /// Runs nothing, and combines the logs of all shards, in any order
    #[arg(long, value_name = "LOG", num_args = 1.., conflicts_with_all = ["log", "shard"])]
    merge: Vec<PathBuf>,
    #[command(flatten)]
    pub out: OutputArgs,
}

/// The results of a sweep.
pub struct Report<'a> {
    pub table: String,
    /// Drawn only if a picture is requested.
    pub picture: Box<dyn FnOnce() -> Result<Sheet, PlotError> + 'a>,
    /// Summary for the user, left out with `--quiet`.
    pub lines: Vec<String>,
    pub warnings: Vec<String>,
}

impl Report<'_> {
    /// Writes all files, and prints the summary.
    pub fn write(self, outputs: Outputs, quiet: bool) -> Result<(), Error> {
        outputs.write(&self.table, self.picture)?;
        self.lines
            .iter()
            .filter(|_| !quiet)
            .chain(&self.warnings)
            .for_each(|line| notify(line));
        Ok(())
    }
}

impl SweepArgs {
    /// Whether an option of shards and logs is given.
    pub fn is_kept(&self) -> bool {
        self.log.is_some() || !self.merge.is_empty()
    }

    /// The shard to run, if it is not the whole sweep.
    pub fn part(&self) -> Option<Shard> {
        self.shard.filter(|shard| shard.of().get() > 1)
    }

    fn keeping(&self) -> Result<ResultStorage, Error> {
        let shard = self.shard.unwrap_or(Shard::WHOLE);
        let wrong = |why: &str| Err(usage!("--shard {shard} {why}"));
        if self.part().is_some() && self.out.draws() {
            return wrong(
                "runs only part of the cells; draw the picture with --merge from all logs",
            );
        }
        if self.shard.is_some() && self.log.is_none() && !self.out.writes() {
            return wrong("needs an output file: --csv FILE for rows, --log FILE for --merge");
        }
        Ok(if self.merge.is_empty() {
            ResultStorage::Log(self.log.clone(), shard)
        } else {
            ResultStorage::Merge(self.merge.clone())
        })
    }

    /// Runs or merges a sweep, and writes the report on its results.
    pub fn run<'a, T: Outcome>(
        &self,
        sweep: &Sweep<'_, T>,
        interrupt: &Interrupt,
        report: impl FnOnce(Vec<Option<T>>) -> Result<Report<'a>, Error>,
    ) -> Result<Exit, Error> {
        let keeping = self.keeping()?;
        // Opened before the runs, so that their results can be written.
        let outputs = Outputs::open(&self.out)?;
        let store = Store::open(&keeping, sweep)?;
        let (cells, [unit, step]) = (&sweep.cells, sweep.units);
        if let Some(missing) = store.missing(cells) {
            report_missing(&missing, cells.len(), unit);
            return Ok(Exit::Incomplete);
        }
        report_machines(&store);
        let progress = self.out.progress(sweep.steps(), step);
        let watch = Watch {
            stop: &|| interrupt.has_arrived(),
            done: &|steps| progress.inc(steps),
        };
        let results = sweep.run_with(&store, self.out.jobs(), &watch);
        progress.finish_and_clear();
        let mut results = results?;
        if let Some(shard) = self.part() {
            for (cell, result) in cells.iter().zip(&mut results) {
                result.take_if(|_| !store.does(cell));
            }
            let own = || cells.iter().filter(|cell| store.does(cell));
            let (all, there) = (own().count(), own().filter(|cell| store.has(cell)).count());
            let done = count_done(&results);
            if done < all {
                notify(&format!(
                    "interrupted after {done} of {all} {unit} of shard {shard}; repeat the command to continue"
                ));
                return Ok(Exit::Interrupted);
            }
            if self.out.writes() {
                outputs.write_table(&report(results)?.table)?;
            }
            if !self.out.quiet {
                notify(&format!(
                    "shard {shard}: {all} {unit}, {there} of them from the log"
                ));
            }
            return Ok(Exit::Good);
        }
        let (all, done) = (results.len(), count_done(&results));
        let report = match report(results) {
            Err(_) if interrupt.has_arrived() => {
                notify("interrupted before any result");
                return Ok(Exit::Interrupted);
            }
            report => report?,
        };
        report.write(outputs, self.out.quiet)?;
        if done < all {
            notify(&format!("interrupted after {done} of {all} {unit}"));
            return Ok(Exit::Interrupted);
        }
        Ok(Exit::Good)
    }
}

fn count_done<T: Outcome>(results: &[Option<T>]) -> usize {
    results
        .iter()
        .flatten()
        .filter(|result| result.is_over())
        .count()
}

/// Reports other machines that computed results, since last digits can differ between machines and tables name only this one.
fn report_machines<T: Outcome>(store: &Store<T>) {
    let here = origin::processor();
    let others = joined(store.machines().filter(|other| *other != here), "; ");
    if !others.is_empty() {
        notify(&format!(
            "computed on {others}, merged on {here}, which tables and pictures name; last digits may differ"
        ));
    }
}

/// Maximum number of ranges and commands in a message.
const MOST: usize = 8;

fn report_missing(missing: &MissingCells, all: usize, unit: &str) {
    let count = missing.cells.len();
    notify(&format!(
        "{count} of {all} {unit} are missing (numbers from 0, in the order of the table): {}",
        ranges(&missing.cells, MOST)
    ));
    let given: Vec<String> = std::env::args().skip(1).collect();
    let sweep = words(&given);
    notify("To compute them, run this; then merge again with the new logs:");
    for (shard, file) in missing.shards.iter().take(MOST) {
        let (number, of) = (shard.number(), shard.of());
        let file = file
            .as_ref()
            .map(|file| file.display().to_string())
            .unwrap_or_else(|| format!("shard-{number}-of-{of}.log"));
        let part = match of.get() {
            1 => String::new(),
            _ => format!(" --shard {shard}"),
        };
        notify(&format!(
            "  stickslip {sweep}{part} --log {}",
            quoted(&file)
        ));
    }
    if missing.shards.len() > MOST {
        let numbers: Vec<usize> = missing
            .shards
            .iter()
            .skip(MOST)
            .map(|(s, _)| s.number() as usize)
            .collect();
        notify(&format!(
            "  and the same for shards {}",
            ranges(&numbers, usize::MAX)
        ));
    }
}

/// The words of a command line that define the sweep, without options for storage and output.
fn words(given: &[String]) -> String {
    const WITH_VALUE: [&str; 7] = [
        "--csv", "--svg", "--png", "--jobs", "--log", "--resume", "--shard",
    ];
    const ALONE: [&str; 3] = ["--force", "--quiet", "-q"];
    let (mut words, mut left_out) = (Vec::new(), 0);
    for word in given {
        let option = word.split('=').next().unwrap_or_default();
        if word.starts_with('-') && word != "-" {
            left_out = 0;
        }
        if left_out > 0 {
            left_out -= 1;
        } else if option == "--merge" {
            left_out = if word == option { usize::MAX } else { 0 };
        } else if WITH_VALUE.contains(&option) {
            left_out = usize::from(word == option);
        } else if !ALONE.contains(&word.as_str()) {
            words.push(quoted(word));
        }
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_of_a_sweep_leave_out_storage_and_output() {
        let given = "map a.ron --over x=1,2 --merge b.log c.log --csv - -q --over y=1 --jobs=3 --set z=it's";
        let given: Vec<String> = given.split(' ').map(str::to_owned).collect();
        assert_eq!(
            words(&given),
            "map a.ron --over x=1,2 --over y=1 --set 'z=it'\\''s'"
        );
    }
}
