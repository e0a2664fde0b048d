//! What the diagnosis page of a failed run must not contain: advice that is neither tried nor marked as untried, or lines that
//! contradict each other.

use std::collections::HashSet;
use std::sync::Arc;
use stickslip::explain::page::{DiagnosisPage, page};
use stickslip::explain::remedies::{compare, rank};
use stickslip::explain::try_list::{TryLine, TryOutcome};
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;
use stickslip::step::stepper::Stepper;

/// Minor iterations after which a run is given up.
const MOST: usize = 60_000;

/// Causes that no other iteration can remove: the path ends, or no modes are consistent.
const ENDS: [&str; 2] = ["limit load: ", "so no strategy can settle there"];

/// A state exists, but not for the scene's strategy.
const EXISTS: &str = "a state exists at this load";

/// The page of a failure, checked.
pub struct CheckedPage {
    pub faults: Vec<String>,
    /// The first cause; one of [`ENDS`] if there is one.
    pub cause: String,
    /// Whether there is one of [`ENDS`].
    pub ends: bool,
    /// What Try shows to work, if anything does.
    pub works: Option<String>,
}

/// The page of a scene's failure. `None` if the scene does not fail.
pub fn check(scene: &Scene) -> Option<CheckedPage> {
    let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
    let mut failed = false;
    for _ in 0..MOST {
        match stepper.step() {
            None => return None,
            Some(event) => failed = matches!(event.outcome, Outcome::Failed(_)),
        }
        if failed {
            break;
        }
    }
    let state = failed.then(|| stepper.state().clone())?;
    let made = page(
        &mut stepper,
        &state,
        Some(&scene.spec),
        Vec::new(),
        &|| false,
        &mut |_| {},
    );
    let Some(page) = made else {
        return Some(CheckedPage {
            faults: vec!["no page".into()],
            cause: String::new(),
            ends: false,
            works: None,
        });
    };
    let shows = |why: &&String| ENDS.iter().any(|words| why.contains(words));
    let end = page.why.iter().find(shows);
    let exists = || page.why.iter().find(|why| why.contains(EXISTS)).cloned();
    let works = page.works().map(|line| line.words()).or_else(exists);
    Some(CheckedPage {
        faults: faults(&page),
        cause: end.or(page.why.first()).cloned().unwrap_or_default(),
        ends: end.is_some(),
        works,
    })
}

fn faults(page: &DiagnosisPage) -> Vec<String> {
    let mut faults = Vec::new();
    let mut seen = HashSet::new();
    if page.what.is_empty() || page.why.is_empty() {
        faults.push("What or Why is empty".into());
    }
    if !page.is_complete() {
        faults.push(format!("a trial still runs: {}", page.going_on));
    }
    for line in &page.tries {
        let words = line.words();
        let tried = line.end.starts_with("tried");
        let marked = line.end.starts_with("not tried");
        let fits = match line.outcome {
            TryOutcome::Untried => marked && line.trial.is_none(),
            TryOutcome::Works => tried && line.trial.as_ref().is_none_or(|t| rank(t) == 0),
            TryOutcome::Fails => tried && line.trial.as_ref().is_none_or(|t| rank(t) > 0),
        };
        if !fits {
            faults.push(format!("outcome and words differ: {words}"));
        }
        if !seen.insert(line.command().to_owned()) {
            faults.push(format!("listed twice: {words}"));
        }
    }
    let trials: Vec<_> = page
        .tries
        .iter()
        .filter_map(|line| line.trial.as_ref())
        .collect();
    if !trials.is_sorted_by(|a, b| compare(a, b).is_le()) {
        faults.push("Try is not in the order of the list of remedies".into());
    }
    // No choice of modes helps where none is consistent.
    let nothing = page
        .why
        .iter()
        .find(|why| why.contains("so no strategy can settle there"));
    let is_choice = |line: &&TryLine| {
        line.command().starts_with(":start-from") || line.words().starts_with("forcing a node")
    };
    if let (Some(why), Some(line)) = (nothing, page.tries.iter().find(is_choice)) {
        faults.push(format!(
            "Why rules out what Try lists: {why}; {}",
            line.words()
        ));
    }
    faults
}
