//! `stickslip core SCENE`: solves up to the first true cycle of minor iterations, reduces it to the fewest nodes that still cycle,
//! and writes these as a separate scene.
//!
//! Exit code 0: the scene was written. Exit code 3: there is none, and the message gives the reason: the scene converges, fails
//! otherwise, or its core cannot be written as a matrix.

use super::base::{Error, Exit, SceneArgs, notify, put, run_to_end};
use std::path::PathBuf;
use std::sync::Arc;
use stickslip_core::model::{AtCycle, AtLimit, Strategy};
use stickslip_core::step::event::Failure;
use stickslip_debugger::explain::core::core;
use stickslip_debugger::explain::diagnosis::cycling;
use stickslip_debugger::explain::report;
use stickslip_debugger::record::export::{self, NoExport, Origin};
use stickslip_platform::files::Output;
use stickslip_scene::Scene;
use stickslip_scene::solver::solver;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,
    /// Output file; - is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,
    /// Overwrites an existing file
    #[arg(long)]
    force: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let scene = args.scene.open()?;
    if args.output.as_os_str() != "-" {
        // Checked before the solve, so that the result of a long solve can be written; leaves no file behind.
        drop(Output::create(&args.output, args.force)?);
    }
    let text = match text(&scene) {
        Ok(text) => text,
        Err(why) => {
            notify(&format!("{}: {why}", scene.name));
            return Ok(Exit::Unconverged);
        }
    };
    put(Some(&args.output), &text, args.force)
}

/// Why there is no core.
#[derive(Debug, thiserror::Error)]
enum NoCore {
    #[error("the scene converges, so there is no cycle{0}")]
    Converges(&'static str),
    #[error("the scene fails, but not in a cycle of minor iterations: {0}")]
    OtherFailure(String),
    #[error(
        "the bodies cannot be condensed to the interface in the cycle, so there is no core to write"
    )]
    NotCondensed,
    #[error("no core found: too many nodes take part in the cycle, or it depends on round-off")]
    NotFound,
    #[error(transparent)]
    NoExport(#[from] NoExport),
}

/// The core's file, or why there is none.
fn text(scene: &Scene) -> Result<String, NoCore> {
    let mut model = scene.model.clone();
    // The solve must stop at the cycle instead of escaping it.
    model.settings.at_cycle = AtCycle::Stop;
    if model.settings.strategy == Strategy::Ladder {
        model.settings.strategy = Strategy::Table2;
    }
    let passes = model.settings.at_minor_limit == AtLimit::Accept;
    let mut stepper = solver(Arc::new(model));
    let Some(failure) = run_to_end(&mut stepper) else {
        let hint = if passes {
            "; settings.at_minor_limit: accept skips cycles (try stop)"
        } else {
            ""
        };
        return Err(NoCore::Converges(hint));
    };
    let Failure::Cycle(cycle) = failure else {
        let words = report::outcome(&scene.model, stepper.event());
        return Err(NoCore::OtherFailure(words));
    };
    if scene.model.settings.at_cycle != AtCycle::Stop {
        notify("note: settings.at_cycle was ignored; with it the scene may escape this cycle");
    }
    let (at, load) = (stepper.event().position, stepper.state().major.target);
    let problem = stepper
        .interface_problem()
        .and_then(|problem| cycling(problem, &cycle))
        .ok_or(NoCore::NotCondensed)?;
    let core = core(&problem).ok_or(NoCore::NotFound)?;
    let origin = Origin::new(scene, at, load);
    Ok(export::core(&scene.model, &origin, &cycle, &core)?)
}
