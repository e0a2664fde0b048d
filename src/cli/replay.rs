//! `stickslip replay`: computes snapshots again, and compares.

use super::base::{Error, Exit, say, scene_instead, tell};
use crate::record::differences::compare;
use crate::record::snapshot::{Snapshot, SnapshotError};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Snapshots
    #[arg(required = true, value_name = "SNAPSHOT")]
    files: Vec<PathBuf>,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let mut exit = Exit::Good;
    for file in &args.files {
        let this = one(file)?;
        // What cannot be read is worse than what differs.
        if this as u8 > exit as u8 {
            exit = this;
        }
    }
    Ok(exit)
}

fn one(file: &Path) -> Result<Exit, Error> {
    let shown = file.display();
    let recorded = match Snapshot::read(file) {
        Ok(recorded) => recorded,
        Err(error) => {
            tell(&scene_instead(file).unwrap_or_else(|| error.to_string()));
            return Ok(Exit::Bad);
        }
    };
    let found = match recorded.replay() {
        Ok(found) => found,
        Err(error @ SnapshotError::Replay(_)) => {
            say(&format!("{shown}: {error}\n"))?;
            return Ok(Exit::Differ);
        }
        Err(error) => {
            tell(&format!("{shown}: {error}"));
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
        "{shown}: differs (left: recorded, right: computed again)\n{differences}"
    ))?;
    Ok(Exit::Differ)
}
