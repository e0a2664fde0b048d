//! `stickslip check`: validates a scene and estimates its cost.

use super::base::{Error, Exit, SceneArgs, answer, notify, say};
use super::json::{self, JsonArgs};
use super::records::{CheckRecord, DeckRecord};
use std::path::Path;
use stickslip_debugger::recorded::calculix::rules::{self, shape::DeckShape};
use stickslip_exchange::inp::Deck;
use stickslip_scene::calculix;
use stickslip_scene::cost::Cost;
use stickslip_scene::format::paths;
use stickslip_scene::gaps;
use stickslip_scene::precision;
use stickslip_scene::{Scene, SceneError};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,
    /// Lists every value that --set can change: path, value and range (separated by tabs)
    #[arg(long, conflicts_with = "json")]
    paths: bool,
    #[command(flatten)]
    json: JsonArgs,
    /// Overwrites an existing file
    #[arg(long, requires = "json")]
    force: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let outlined = outlined(&args.scene.scene);
    let deck = outlined
        .as_ref()
        .and_then(|outlined| outlined.as_ref().ok());
    let scene = match (args.scene.open(), deck) {
        (Err(_), Some(deck)) if deck.is_solid() => return check_solid(args, deck),
        (Ok(scene), _) => scene,
        (Err(why), Some(deck)) => {
            // The rules would warn of what a card that cannot be read leaves out.
            if !deck.has_faults {
                warn(&causes(deck));
            }
            return Err(why.into());
        }
        (Err(why), None) => return Err(outlined.and_then(located).unwrap_or(why).into()),
    };
    if args.paths {
        return answer(&all_paths(&scene));
    }
    let json = args.json.open(args.force)?;
    let cost = Cost::from_scene(&scene);
    if !args.json.is_on_standard_output() {
        say(&format!("{}: sound\n{cost}", scene.name))?;
    }
    let mut notes = scene.remarks.clone();
    notes.extend(scene.names().notes(scene.spec.refine));
    notes.extend(scene.spec.notes());
    for note in &notes {
        notify(&format!("note: {note}"));
    }
    let mut warnings = gaps::warnings(&scene.model);
    warnings.extend(precision::warning(&scene.model));
    warnings.extend(deck.into_iter().flat_map(causes));
    warn(&warnings);
    json::write(json, &record(&scene, cost, notes, warnings))?;
    Ok(Exit::Good)
}

/// The outline of a deck; `None` for other files.
fn outlined(name: &str) -> Option<Result<Deck, SceneError>> {
    let is_deck = Path::new(name).extension()?.eq_ignore_ascii_case("inp");
    is_deck.then(|| calculix::outline(name))
}

/// The error of an outline, if it has a place in the deck.
fn located(outlined: Result<Deck, SceneError>) -> Option<SceneError> {
    outlined.err().filter(|why| why.at.is_some())
}

fn warn(warnings: &[String]) {
    for warning in warnings {
        notify(&format!("warning: {warning}"));
    }
}

/// What the rules find in a deck, with the cures.
fn causes(deck: &Deck) -> Vec<String> {
    let findings = rules::examine(Some(&DeckShape::new(deck)), None);
    findings
        .iter()
        .map(|found| format!("{}. Cure: {}", found.cause, found.advice()))
        .collect()
}

/// Checks a three-dimensional deck, which only CalculiX solves.
fn check_solid(args: &Args, deck: &Deck) -> Result<Exit, Error> {
    let json = args.json.open(args.force)?;
    let notes = deck.remarks.iter().map(|remark| {
        let (file, line) = (deck.file(remark.place), remark.place.line);
        format!("{file}:{line}: {}", remark.text)
    });
    let record = DeckRecord {
        schema: "stickslip-check-deck-1",
        deck: args.scene.scene.clone(),
        exit_code: Exit::Good as u8,
        nodes: deck.nodes.len(),
        elements: deck.elements.len(),
        pairs: deck.pairs.len(),
        ties: deck.ties.len(),
        steps: deck.steps.len(),
        notes: notes.collect(),
        warnings: causes(deck),
    };
    if !args.json.is_on_standard_output() {
        say(&format!(
            "{}: three-dimensional deck for CalculiX\nnodes {}, elements {}, contact pairs {}, ties {}, steps {}\n",
            record.deck, record.nodes, record.elements, record.pairs, record.ties, record.steps
        ))?;
    }
    for note in &record.notes {
        notify(&format!("note: {note}"));
    }
    warn(&record.warnings);
    json::write(json, &record)?;
    Ok(Exit::Good)
}

fn record(scene: &Scene, cost: Cost, notes: Vec<String>, warnings: Vec<String>) -> CheckRecord {
    CheckRecord {
        schema: "stickslip-check-1",
        scene: scene.name.clone(),
        exit_code: Exit::Good as u8,
        nodes: cost.nodes.0,
        nodes_on_bodies: cost.nodes.1,
        unknowns: cost.unknowns(),
        translations: cost.translations,
        rotations: cost.rotations,
        shear_forces: cost.shears,
        body_forces: cost.forces,
        interface_forces: cost.interface,
        restrained: cost.held,
        bodies: cost.bodies,
        surfaces: cost.surfaces,
        slaves: cost.slaves,
        laws: cost.laws,
        axis: cost.axis,
        gaps: cost.gaps,
        history: cost.history,
        solvers: cost.solvers,
        without: cost.without,
        notes,
        warnings,
    }
}

fn all_paths(scene: &Scene) -> String {
    paths::list(&scene.spec)
        .iter()
        .map(|l| format!("{}\t{}\t{}\n", l.path, l.value, l.kind))
        .collect()
}
