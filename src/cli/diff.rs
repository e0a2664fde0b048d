//! `stickslip diff`: two snapshots, node by node.

use super::base::{Error, Exit, say, scene_instead};
use std::path::PathBuf;
use stickslip_debugger::Snapshot;
use stickslip_debugger::record::differences::compare;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The first snapshot
    #[arg(value_name = "A")]
    left: PathBuf,
    /// The second snapshot
    #[arg(value_name = "B")]
    right: PathBuf,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let read = |file: &PathBuf| {
        Snapshot::read(file).map_err(|why| match scene_instead(file) {
            Some(instead) => Error::Usage(instead),
            None => why.into(),
        })
    };
    let (left, right) = (read(&args.left)?, read(&args.right)?);
    let differences = compare(&left, &right);
    if differences.is_empty() {
        return Ok(Exit::Good);
    }
    say(&format!(
        "left: {}\nright: {}\n{differences}",
        args.left.display(),
        args.right.display()
    ))?;
    Ok(Exit::Differ)
}
