//! Rules that explain why a contact run did not converge, from its deck and from its record.
//!
//! - [`shape`]: the deck's geometry; `bodies`, `pairs`, `supports`, `resting` and `steps`: rules on the deck, with the rigid motions
//!   of `motion`; `record`: rules on the run.
//!
//! A rule returns its findings with their numbers, the names of the deck, and a cure as lines of the deck. Rules that do not apply
//! return none.

mod bodies;
mod motion;
mod numbers;
mod pairs;
mod record;
mod resting;
pub mod shape;
mod sorted_points;
mod steps;
mod supports;

pub use record::ended_converged;

use super::run::CalculixRun;
use shape::DeckShape;
use stickslip_core::RunFinding;

/// What a rule looks at.
enum Rule {
    /// The mesh, its surfaces and ties. The findings also apply to a run that converged.
    Mesh(fn(&DeckShape) -> Vec<RunFinding>),
    /// The deck, before or after a run, given that its surfaces face each other.
    Deck(fn(&DeckShape) -> Vec<RunFinding>),
    /// The record of a run, with its deck if there is one.
    Record(fn(&CalculixRun, Option<&DeckShape>) -> Option<RunFinding>),
}

use Rule::{Deck, Mesh, Record};

/// The rules, those that explain most failures by themselves first; reversed faces come before them.
const RULES: &[Rule] = &[
    Mesh(bodies::unconnected),
    Mesh(bodies::unmerged),
    Mesh(pairs::tie_too_far),
    Deck(supports::open_at_start),
    Deck(supports::free_to_slide),
    Deck(resting::beyond_friction),
    Deck(resting::off_the_contact),
    Deck(resting::beyond_plastic_limit),
    Deck(pairs::overlap),
    Deck(pairs::stiff_contact),
    Deck(bodies::reduced_row),
    Deck(steps::first_increment),
    Deck(steps::past_the_edge),
    Deck(steps::small_sliding),
    Deck(steps::squeezed),
    Deck(steps::no_cuts),
    Record(record::increments_used),
    Deck(pairs::coarse_slave),
    Deck(supports::held_by_friction),
    Deck(supports::free_to_move),
    Deck(pairs::constrained_slaves),
];

/// Rules on what any cause may lead to. They advise only if no other rule does.
const SYMPTOMS: &[Rule] = &[Record(record::chatter), Record(record::capped_correction)];

/// The findings of all rules, in the order of the rules. Of a run that reached its end only those on the mesh, and that its contact
/// never closed. Rules that rely on the faces do not apply if faces are reversed.
pub fn examine(deck: Option<&DeckShape>, run: Option<&CalculixRun>) -> Vec<RunFinding> {
    let is_complete = deck
        .zip(run)
        .is_some_and(|(shape, run)| record::is_complete(run, shape));
    let mut found = deck.map(pairs::reversed_faces).unwrap_or_default();
    let is_reversed = !found.is_empty();
    let findings = |rules: &[Rule]| -> Vec<RunFinding> {
        let findings = rules.iter().flat_map(|rule| match (rule, deck, run) {
            (Mesh(rule), Some(deck), _) => rule(deck),
            (Deck(rule), Some(deck), _) if !is_complete && !is_reversed => rule(deck),
            (Record(rule), _, Some(run)) if !is_complete => rule(run, deck).into_iter().collect(),
            _ => Vec::new(),
        });
        findings.collect()
    };
    found.extend(findings(RULES));
    let mut symptoms = findings(SYMPTOMS);
    if !found.is_empty() {
        symptoms
            .iter_mut()
            .flat_map(|f| [&mut f.cure, &mut f.lines])
            .for_each(String::clear);
    }
    found.append(&mut symptoms);
    if let Some(run) = run.filter(|_| !is_reversed) {
        found.extend(record::never_closed(run, deck));
    }
    found
}
