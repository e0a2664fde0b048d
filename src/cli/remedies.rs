//! `stickslip remedies SCENE`: solves up to the first increment that fails, tries every remedy there, and prints what each
//! costs and leaves.

use super::base::{Error, Exit, SceneArgs, quoted, say, tell};
use crate::explain::page;
use crate::explain::remedies::{self, COLUMNS, TrialEnd};
use crate::explain::report;
use crate::outside::shown;
use crate::scene::Scene;
use crate::scene::solver::solver;
use crate::step::drive::{RunEnd, Until};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::Arc;
use unicode_width::UnicodeWidthStr;

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Exit codes: 0 some remedy gets the scene past the failure, or nothing fails; 3 none does.")]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,
}

/// The command line that tries the remedies of a scene with its original options.
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
    let end = stepper.drive(Until::end(), |_| ControlFlow::<Infallible>::Continue(()));
    let RunEnd::Failed(failure) = end else {
        tell("it converges; there is nothing to remedy");
        return Ok(Exit::Good);
    };
    let state = stepper.state().clone();
    let (model, event) = (stepper.model().clone(), stepper.event());
    tell(&report::failure(
        &model,
        &state,
        event.position,
        event.load_factor,
        &failure,
    ));
    for line in page::facts(&mut stepper, &state, &failure, &|| false) {
        tell(&format!("  {line}"));
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
    let rows = trials.iter().map(|trial| {
        let mut row = vec![trial.label.clone()];
        row.extend(remedies::row(trial));
        row.push(trial.how.typed());
        row
    });
    let mut headings = vec!["remedy".to_owned()];
    headings.extend(COLUMNS.map(String::from));
    headings.push("how".to_owned());
    say(&table(&headings, &rows.collect::<Vec<_>>()))?;
    let any = trials.iter().any(|trial| trial.end == TrialEnd::Converged);
    Ok(if any { Exit::Good } else { Exit::Unconverged })
}

/// Columns, the first to the left, all others to the right.
fn table(headings: &[String], rows: &[Vec<String>]) -> String {
    let width = |k: usize| {
        let cells = rows.iter().map(|row| row[k].width());
        cells.chain([headings[k].len()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..headings.len()).map(width).collect();
    let line = |row: &[String]| {
        let cells = row.iter().zip(&widths).enumerate();
        let cells: Vec<String> = cells
            .map(|(k, (cell, &width))| match k {
                0 => shown::padded(cell, width),
                _ if k + 1 == widths.len() => cell.clone(),
                _ => shown::padded_before(cell, width),
            })
            .collect();
        cells.join("  ").trim_end().to_owned() + "\n"
    };
    let mut text = line(headings);
    text.extend(rows.iter().map(|row| line(row)));
    text
}
