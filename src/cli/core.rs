//! `stickslip core SCENE`, or `-- COMMAND`: solves up to the first true cycle of minor iterations, reduces it to the fewest nodes
//! that still cycle, and writes these as a separate scene. For an attached solver, the cycle is that of Table 2 on the interface
//! problem that the solver reports after the first increment that fails.
//!
//! Exit code 0: the scene was written. Exit code 3: there is none, and the message gives the reason: the scene converges, fails
//! otherwise, or its core cannot be written as a matrix.

use super::base::{Error, Exit, notify, put, run_to_end, spare_input};
use super::solver::{SubjectArgs, step_to_end};
use std::path::PathBuf;
use std::sync::Arc;
use stickslip_attach::Attached;
use stickslip_core::model::{AtCycle, AtLimit};
use stickslip_core::{Failure, RunEnd, Solver, Strategy};
use stickslip_debugger::Refusal;
use stickslip_debugger::explain::core::core;
use stickslip_debugger::explain::diagnosis::cycling;
use stickslip_debugger::explain::report;
use stickslip_debugger::record::export::{self, Origin};
use stickslip_debugger::session::exports;
use stickslip_platform::files::Output;
use stickslip_scene::Scene;
use stickslip_scene::solver::solver;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    subject: SubjectArgs,
    /// Output file; - is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    output: PathBuf,
    /// Overwrites an existing file
    #[arg(long)]
    force: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    if args.output.as_os_str() != "-" {
        spare_input(
            args.subject.scene.as_deref().unwrap_or_default(),
            &args.output,
        )?;
        // Checked before the solve, so that the result of a long solve can be written; leaves no file behind.
        drop(Output::create(&args.output, args.force)?);
    }
    let attached = args
        .subject
        .solver
        .attached(&args.subject.set, args.force, None)?;
    let (name, text) = match attached {
        Some((scene, mut solver)) => (scene.name, of_solver(&mut solver)?),
        None => {
            let scene = args.subject.scene()?;
            let text = text(&scene);
            (scene.name, text)
        }
    };
    let text = text.map_err(|why| Error::ended(Exit::Unconverged, &name, why))?;
    put(Some(&args.output), &text, args.force)
}

/// What an error begins with if there is no cycle.
const CONVERGES: &str = "the scene converges, so there is no cycle";

/// The core of the interface problem that an attached solver reports after its first failure, or why there is none.
fn of_solver(solver: &mut Attached) -> Result<Result<String, Refusal>, Error> {
    let end = step_to_end(solver, None, &mut |_| ())?;
    if !matches!(end, RunEnd::Failed(_)) {
        return Ok(Err(Refusal::new(CONVERGES)));
    }
    let (model, state) = (solver.model().clone(), solver.state().clone());
    let posed = solver.interface_problem(&state).map_err(Error::usage)?;
    let event = solver.event();
    let origin = Origin {
        scene: model.title.clone(),
        changes: Vec::new(),
        at: event.position,
        load: event.load_factor,
    };
    Ok(exports::core_of_reported(&model, &state, &posed, &origin))
}

/// The core's file, or why there is none.
fn text(scene: &Scene) -> Result<String, Refusal> {
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
        return Err(Refusal::new(format_args!("{CONVERGES}{hint}")));
    };
    let Failure::Cycle(cycle) = failure else {
        let words = report::outcome(&scene.model, stepper.event());
        return Err(Refusal::new(format_args!(
            "the scene fails, but not in a cycle of minor iterations: {words}"
        )));
    };
    if scene.model.settings.at_cycle != AtCycle::Stop {
        notify("note: settings.at_cycle was ignored; with it the scene may escape this cycle");
    }
    let (at, load) = (stepper.event().position, stepper.state().major.target);
    let problem = stepper
        .interface_problem()
        .and_then(|problem| cycling(problem, &cycle))
        .ok_or_else(|| {
            Refusal::new(
                "the bodies cannot be condensed to the interface in the cycle, so there is no core to write",
            )
        })?;
    let core = core(&problem).ok_or_else(|| {
        Refusal::new(
            "no core found: too many nodes take part in the cycle, or it depends on round-off",
        )
    })?;
    let origin = Origin::new(scene, at, load);
    export::core(&scene.model, &origin, &cycle, &core)
}
