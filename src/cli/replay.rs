//! `stickslip replay`: recomputes snapshots, and compares.

use super::base::{Error, Exit, notify, say, scene_instead};
use super::solver::SolverArgs;
use std::path::{Path, PathBuf};
use stickslip_debugger::record::differences::compare;
use stickslip_debugger::record::snapshot::{Snapshot, SnapshotError};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Snapshots
    #[arg(required = true, value_name = "SNAPSHOT")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    solver: SolverArgs,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let mut exit = Exit::Good;
    for file in &args.files {
        let this = one(file, &args.solver)?;
        // An unreadable file is worse than one that differs.
        if this as u8 > exit as u8 {
            exit = this;
        }
    }
    Ok(exit)
}

fn one(file: &Path, solver: &SolverArgs) -> Result<Exit, Error> {
    let shown = file.display();
    let recorded = match Snapshot::read(file) {
        Ok(recorded) => recorded,
        Err(error) => {
            notify(&scene_instead(file).unwrap_or_else(|| error.to_string()));
            return Ok(Exit::Bad);
        }
    };
    let replayed = match solver.is_named() {
        true => {
            let (_, mut attached, _) = solver.attach(false)?;
            recorded.replay_with(&mut attached)
        }
        false => recorded.replay(),
    };
    let found = match replayed {
        Ok(found) => found,
        Err(error @ SnapshotError::Replay(_)) => {
            say(&format!("{shown}: {error}\n"))?;
            return Ok(Exit::Differ);
        }
        Err(error) => {
            notify(&format!("{shown}: {error}"));
            return Ok(Exit::Bad);
        }
    };
    let differences = compare(&recorded, &found);
    if differences.is_empty() {
        say(&format!(
            "{shown}: equal, after {} minor iterations\n",
            found.steps
        ))?;
        return Ok(Exit::Good);
    }
    say(&format!(
        "{shown}: differs (left: recorded, right: recomputed)\n{differences}"
    ))?;
    Ok(Exit::Differ)
}
