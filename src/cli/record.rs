//! `stickslip record`: solves up to a position, and writes a snapshot of it.

use super::base::{Error, Exit, answer, notify, spare_input};
use super::interrupt::Interrupt;
use super::place::{RunPosition, missed, seek};
use super::solver::{Subject, SubjectArgs};
use std::path::PathBuf;
use stickslip_debugger::Snapshot;
use stickslip_platform::files::{self, Output};
use stickslip_scene::Scene;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    subject: SubjectArgs,
    /// The minor iteration to record; without MINOR the end of the major, without MAJOR the end of the increment
    #[arg(long, value_name = "INC[.MAJOR[.MINOR]]")]
    at: RunPosition,
    /// Output file; - is standard output [default: the scene's name and the position, in the working directory]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrites an existing file
    #[arg(long)]
    force: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let interrupt = Interrupt::listen();
    let Subject { scene, mut solver } = args.subject.open(args.force, Some(&interrupt))?;
    let path = args
        .output
        .clone()
        .unwrap_or_else(|| default_name(&scene, args.at));
    spare_input(&scene.name, &path)?;
    let output = match path.as_os_str() {
        name if name == "-" => None,
        _ => Some(Output::create(&path, args.force)?),
    };
    let steps = seek(&mut *solver, args.at, &interrupt, &mut |_| {})
        .map_err(|why| missed(&scene, &*solver, args.at, why))?;
    let event = Some(solver.event());
    let text = Snapshot::take(&scene, &[], steps, solver.state(), event).to_text()?;
    let Some(mut output) = output else {
        return answer(&text);
    };
    output.append(text.as_bytes())?;
    output.finish()?;
    notify(&format!("wrote {}", path.display()));
    Ok(Exit::Good)
}

fn default_name(scene: &Scene, at: RunPosition) -> PathBuf {
    PathBuf::from(format!("{}-{at}.ron", files::stem(&scene.name)))
}
