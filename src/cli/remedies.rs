//! `stickslip remedies SCENE`: solves up to the first increment that fails, tries every remedy there, and prints their cost and
//! result.

use super::base::{Error, Exit, SceneArgs, notify, quoted, run_to_end, say};
use std::sync::Arc;
use stickslip_debugger::explain::page;
use stickslip_debugger::explain::remedies::{self, COLUMNS, TrialEnd};
use stickslip_debugger::explain::report;
use stickslip_scene::Scene;
use stickslip_scene::shown::aligned;
use stickslip_scene::solver::solver;

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Exit codes: 0 a remedy gets the scene past the failure, or nothing fails; 3 no remedy does.")]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,
}

/// The command that tries the remedies of a scene, with its options.
pub fn command(scene: &Scene) -> String {
    let set = scene.overrides();
    let set = set.map(|(path, value)| format!(" --set {}", quoted(&format!("{path}={value}"))));
    format!(
        "stickslip remedies {}{}",
        quoted(&scene.name),
        set.collect::<String>()
    )
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let scene = args.scene.open()?;
    let spec = Some(&scene.spec);
    let mut stepper = solver(Arc::new(scene.model.clone()));
    let Some(failure) = run_to_end(&mut stepper) else {
        notify("the scene converges; nothing to remedy");
        return Ok(Exit::Good);
    };
    let state = stepper.state().clone();
    let (model, event) = (stepper.model().clone(), stepper.event());
    notify(&report::failure(
        &model,
        &state,
        event.position,
        event.load_factor,
        &failure,
    ));
    for line in page::causes(&mut stepper, &state, &failure, &|| false) {
        notify(&format!("  why: {line}"));
    }
    let mut trials = Vec::new();
    for remedy in remedies::all(&mut stepper, &state, spec, &|| false) {
        trials.extend(remedies::attempt(
            &mut stepper,
            &state,
            spec,
            &remedy,
            &|| false,
        ));
    }
    remedies::sort(&mut trials);
    let mut headings = vec!["remedy".to_owned()];
    headings.extend(COLUMNS.map(String::from));
    headings.push("how".to_owned());
    let mut rows = vec![headings];
    rows.extend(trials.iter().map(|trial| {
        let mut row = vec![trial.label.clone()];
        row.extend(remedies::row(trial));
        row.push(trial.how.typed());
        row
    }));
    say(&(aligned(&rows, 1).join("\n") + "\n"))?;
    let any = trials.iter().any(|trial| trial.end == TrialEnd::Converged);
    Ok(if any { Exit::Good } else { Exit::Unconverged })
}
