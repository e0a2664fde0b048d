//! Which recoveries and strategies a scene needs, judged by leaving each out.

use std::collections::BTreeSet;
use std::sync::Arc;
use stickslip::model::Strategy;
use stickslip::scene::Scene;
use stickslip::step::event::{MotionEvent, Outcome};
use stickslip::step::recovery::{self, fallback::Fallback, left_out::OmittedStep};
use stickslip::step::stepper::Stepper;

/// Minor iterations after which a run counts as not finished.
const PATIENCE: u64 = 60_000;

/// What a run used, and whether it reached its end.
pub fn run(scene: &Scene, without: Option<OmittedStep>) -> (bool, BTreeSet<String>) {
    let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
    if let Some(without) = without {
        stepper.leave_out(without);
    }
    let mut used = BTreeSet::new();
    for _ in 0..PATIENCE {
        let Some(event) = stepper.step() else {
            return (true, used);
        };
        let name = match &event.outcome {
            Outcome::Failed(_) => return (false, used),
            Outcome::Cut { .. } if event.arc.is_some() => "shorter-arc".to_owned(),
            Outcome::Cut { .. } => "halve".to_owned(),
            Outcome::WholeIncrement { .. } => "whole".to_owned(),
            Outcome::PathCorner { .. } => "turn".to_owned(),
            Outcome::Motion(MotionEvent::DynamicStart { .. }) => "release".to_owned(),
            Outcome::Motion(MotionEvent::Slower(_)) => "slower".to_owned(),
            Outcome::Fallback {
                by: Fallback::Release,
                ..
            } => "motion".to_owned(),
            Outcome::Fallback { by, .. } => format!("{by:?}").to_lowercase(),
            Outcome::StrategyChange { frozen: true, .. } => "frozen".to_owned(),
            Outcome::StrategyChange { to, .. } => format!("{to:?}"),
            _ => continue,
        };
        used.insert(name);
    }
    (false, used)
}

/// Recoveries and strategies without which a scene does not reach its end.
pub fn needs(scene: &Scene, used: &BTreeSet<String>) -> Vec<String> {
    let recoveries = recovery::names().map(|name| (name.to_owned(), OmittedStep::Recovery(name)));
    let rungs = stickslip::strategy::rungs(Strategy::Ladder).iter();
    let strategies = rungs.map(|rung| (format!("{rung:?}"), OmittedStep::Strategy(*rung)));
    let asked = recoveries.chain(strategies).filter(|(name, _)| {
        let turns = name == "turn-at-last" && used.contains("turn");
        used.contains(name) || turns
    });
    let needed = asked.filter(|(_, without)| !run(scene, Some(*without)).0);
    needed.map(|(name, _)| name).collect()
}
