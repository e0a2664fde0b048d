//! `stickslip replay`: recomputes snapshots, and compares.

use super::base::{Error, Exit, distinct, notify, say, scene_instead, tolerance, usage};
use super::json::{self, JsonArgs};
use super::junit::{self, TestCase, TestResult};
use super::records::{DifferenceRecord, ReplayRecord, ReplayedRecord};
use super::sink::Sink;
use super::solver::SolverArgs;
use std::path::{Path, PathBuf};
use std::time::Instant;
use stickslip_core::counted;
use stickslip_debugger::record::differences::{Difference, Differences, compare_within};
use stickslip_debugger::{Snapshot, SnapshotError};
use stickslip_platform::files::finish_all;

/// Maximum number of differences per snapshot in the text.
const MOST_SHOWN: usize = 12;
/// Maximum number of differences per snapshot in the record.
const MOST_DIFFERENCES: usize = 100;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Snapshots
    #[arg(required = true, value_name = "SNAPSHOT")]
    files: Vec<PathBuf>,
    /// Numbers may differ by this part of their scale; all else must be equal
    #[arg(long, value_name = "PART", default_value = "1e-9", value_parser = tolerance)]
    tolerance: f64,
    #[command(flatten)]
    solver: SolverArgs,
    #[command(flatten)]
    json: JsonArgs,
    /// Writes a test case per snapshot as JUnit XML (page json); - is standard output, instead of the text there
    #[arg(long, value_name = "FILE|-")]
    junit: Option<String>,
    /// Overwrites existing files
    #[arg(long)]
    force: bool,
}

/// What recomputing a snapshot found.
enum ReplayResult {
    /// The snapshot is equal, or differs.
    Compared {
        recorded: Box<Snapshot>,
        minors: u64,
        differences: Differences,
    },
    /// Its steps cannot be repeated.
    NotRepeatable(Box<Snapshot>, String),
    /// It cannot be read, and why.
    Unreadable(String),
}

use ReplayResult::*;

impl ReplayResult {
    fn exit(&self) -> Exit {
        match self {
            Compared { differences, .. } if differences.is_empty() => Exit::Good,
            Compared { .. } | NotRepeatable(..) => Exit::Differ,
            Unreadable(_) => Exit::Bad,
        }
    }
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let junit = args.junit.as_deref();
    distinct(&[("--json", args.json.to()), ("--junit", junit)])?;
    for to in [args.json.to(), junit].into_iter().flatten() {
        if args.files.iter().any(|file| file == Path::new(to)) {
            return Err(usage!(
                "{to} is a snapshot to replay; the result needs another file"
            ));
        }
    }
    let says = !args.json.is_on_standard_output() && junit != Some("-");
    let json = args.json.open(args.force)?;
    let junit = junit.map(|to| Sink::open(to, args.force)).transpose()?;
    let mut exit = Exit::Good;
    let (mut records, mut cases) = (Vec::new(), Vec::new());
    for file in &args.files {
        let began = Instant::now();
        let replayed = one(file, args)?;
        let seconds = began.elapsed().as_secs_f64();
        print(file, &replayed, says)?;
        let this = replayed.exit();
        // An unreadable file is worse than one that differs.
        if this as u8 > exit as u8 {
            exit = this;
        }
        records.push(record(file, &replayed, seconds));
        cases.push(TestCase {
            name: file.display().to_string(),
            seconds,
            result: result(&replayed),
        });
    }
    write(
        json,
        junit,
        &cases,
        ReplayRecord {
            schema: "stickslip-replay-1",
            exit_code: exit as u8,
            snapshots: records,
        },
    )?;
    Ok(exit)
}

/// Writes the requested files, all or none.
fn write(
    json: Option<Sink>,
    junit: Option<Sink>,
    cases: &[TestCase],
    record: ReplayRecord,
) -> Result<(), Error> {
    let mut files = Vec::new();
    if let Some(mut sink) = junit {
        sink.send(&junit::document("stickslip replay", cases))?;
        files.extend(sink.into_file());
    }
    if let Some(sink) = json {
        files.extend(json::unfinished(sink, &record)?);
    }
    Ok(finish_all(files)?)
}

fn one(file: &Path, args: &Args) -> Result<ReplayResult, Error> {
    let solver = &args.solver;
    let recorded = match Snapshot::read(file) {
        Ok(recorded) => Box::new(recorded),
        Err(error) => {
            let why = scene_instead(file).unwrap_or_else(|| error.to_string());
            return Ok(Unreadable(why));
        }
    };
    let replayed = if solver.is_named() {
        let (_, mut attached, _) = solver.attach(false, None)?;
        recorded.replay_with(&mut attached)
    } else {
        recorded.replay()
    };
    Ok(match replayed {
        Ok(found) => Compared {
            minors: found.steps,
            differences: compare_within(&recorded, &found, args.tolerance),
            recorded,
        },
        Err(error @ SnapshotError::Replay(_)) => NotRepeatable(recorded, error.to_string()),
        Err(error) => Unreadable(format!("{}: {error}", file.display())),
    })
}

/// Prints the result; `says` is whether standard output carries text.
fn print(file: &Path, replayed: &ReplayResult, says: bool) -> Result<(), Error> {
    let file = file.display();
    let text = match replayed {
        Unreadable(why) => {
            notify(why);
            return Ok(());
        }
        NotRepeatable(_, why) => format!("{file}: {why}\n"),
        Compared {
            minors,
            differences,
            ..
        } if differences.is_empty() => {
            format!(
                "{file}: equal, after {}\n",
                counted(*minors, "minor iteration")
            )
        }
        Compared { differences, .. } => {
            let table = differences.largest(MOST_SHOWN);
            format!("{file}: differs (left: recorded, right: recomputed)\n{table}")
        }
    };
    if says {
        say(&text)?;
    }
    Ok(())
}

/// The result as data.
fn record(file: &Path, replayed: &ReplayResult, seconds: f64) -> ReplayedRecord {
    let (outcome, message, snapshot) = match replayed {
        Compared {
            recorded,
            differences,
            ..
        } => {
            if differences.is_empty() {
                ("equal", None, Some(recorded))
            } else {
                ("differs", None, Some(recorded))
            }
        }
        NotRepeatable(recorded, why) => ("not-repeatable", Some(why), Some(recorded)),
        Unreadable(why) => ("unreadable", Some(why), None),
    };
    let (minors, rows) = match replayed {
        Compared {
            minors,
            differences,
            ..
        } => (Some(*minors), differences.rows.as_slice()),
        _ => (None, [].as_slice()),
    };
    let at = snapshot.map(|snapshot| snapshot.position);
    ReplayedRecord {
        file: file.display().to_string(),
        outcome,
        message: message.cloned(),
        scene: snapshot.map(|snapshot| snapshot.name.clone()),
        increment: at.map(|at| at.increment),
        attempt: at.map(|at| at.attempt),
        major: at.map(|at| at.major),
        minor: at.map(|at| at.minor),
        minors,
        differences: rows.len(),
        first: rows.iter().take(MOST_DIFFERENCES).map(difference).collect(),
        seconds,
    }
}

fn difference(row: &Difference) -> DifferenceRecord {
    DifferenceRecord {
        node: row.node.clone(),
        field: row.field.clone(),
        expected: row.left.clone(),
        found: row.right.clone(),
        apart: row.apart.map(|(apart, _)| apart),
        allowed: row.apart.map(|(_, allowed)| allowed),
    }
}

/// The result as that of a test.
fn result(replayed: &ReplayResult) -> TestResult {
    match replayed {
        Unreadable(why) => TestResult::Error(why.clone()),
        NotRepeatable(_, why) => TestResult::Failed(why.clone(), String::new()),
        Compared { differences, .. } => match differences.rows.len() {
            0 => TestResult::Passed,
            n => TestResult::Failed(counted(n, "difference"), differences.to_string()),
        },
    }
}
