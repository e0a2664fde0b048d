//! Rules that explain why a contact run did not converge, from its deck and from its record.
//!
//! - [`shape`]: the deck's geometry; `pairs`, `supports` and `steps`: rules on the deck; `record`: rules on the run.
//!
//! A rule returns its findings with their numbers, the names of the deck, and a cure as lines of the deck. Rules that do not apply
//! return none.

mod pairs;
mod record;
pub mod shape;
mod steps;
mod supports;

use super::run::CalculixRun;
use shape::DeckShape;
use stickslip_core::RunFinding;

/// What a rule looks at.
enum Rule {
    /// The deck, before or after a run.
    Deck(fn(&DeckShape) -> Vec<RunFinding>),
    /// The record of a run, with its deck if there is one.
    Record(fn(&CalculixRun, Option<&DeckShape>) -> Vec<RunFinding>),
}

use Rule::{Deck, Record};

/// The rules, those that explain most failures by themselves first.
const RULES: &[Rule] = &[
    Deck(pairs::reversed_faces),
    Deck(supports::unconnected),
    Deck(pairs::tie_too_far),
    Deck(supports::open_at_start),
    Deck(supports::free_to_slide),
    Deck(supports::beyond_friction),
    Deck(supports::off_the_contact),
    Deck(pairs::overlap),
    Deck(pairs::stiff_contact),
    Deck(steps::first_increment),
    Deck(steps::past_the_edge),
    Deck(steps::small_sliding),
    Deck(steps::no_cuts),
    Record(record::increments_used),
    Deck(pairs::coarse_slave),
    Deck(pairs::constrained_slaves),
    Record(record::chatter),
    Record(record::capped_correction),
    Record(record::never_closed),
];

/// The findings of all rules, in the order of the rules. A run that reached its end has one at most: that its contact never closed.
pub fn examine(deck: Option<&DeckShape>, run: Option<&CalculixRun>) -> Vec<RunFinding> {
    if let (Some(shape), Some(run)) = (deck, run)
        && record::is_complete(run, shape)
    {
        return record::never_closed(run, deck);
    }
    let findings = RULES.iter().flat_map(|rule| match (rule, deck, run) {
        (Deck(rule), Some(deck), _) => rule(deck),
        (Record(rule), _, Some(run)) => rule(run, deck),
        _ => Vec::new(),
    });
    findings.collect()
}
