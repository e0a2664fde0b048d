//! What happened, in one line: the increment, its load, and the failure with at most a few node names.

use super::failures;
use super::names::slave;
use stickslip_core::words::times;
use stickslip_core::{Failure, Model, State};
use stickslip_scene::{first_of, shortest};

/// Maximum number of nodes named.
const MOST: usize = 3;

/// The line for a failed state.
pub fn headline(model: &Model, state: &State, failure: &Failure) -> String {
    at(state, &brief(model, failure))
}

/// A line with the increment and load of a state.
pub fn at(state: &State, text: &str) -> String {
    let load = shortest(state.load_factor);
    format!("increment {}, load {load}: {text}", state.next.increment)
}

/// The failure without lists of modes.
pub fn brief(model: &Model, failure: &Failure) -> String {
    let named = |slaves: &mut dyn Iterator<Item = usize>| {
        first_of(slaves.map(|s| slave(model, s)), MOST, ", ")
    };
    match failure {
        Failure::Cycle(cycle) => format!(
            "contact modes repeat with period {} from minor {} ({})",
            cycle.period,
            cycle.start,
            named(&mut cycle.members.iter().map(|member| member.0))
        ),
        Failure::MajorCycle(round) => format!(
            "major iterations repeat with period {} from major {} ({})",
            round.period,
            round.start,
            named(&mut round.members.iter().map(|member| member.0))
        ),
        Failure::NoAnswer { .. } => "no modes are consistent in this increment".into(),
        Failure::LadderEnded { first, .. } => format!(
            "no strategy found a consistent state; first failure: {}",
            brief(model, first)
        ),
        Failure::CutTooOften {
            slave: s,
            cuts,
            last,
        } => format!(
            "cut {} because of {}: {}",
            times(*cuts),
            slave(model, *s),
            brief(model, last)
        ),
        _ => failures::describe(model, failure),
    }
}

/// The failure without lists of modes, cut at the end of a part if it would not fit into a line with its position.
pub fn first_part(model: &Model, failure: &Failure) -> String {
    const LONGEST: usize = 80;
    let mut text = brief(model, failure);
    if let Some((end, _)) = text.char_indices().nth(LONGEST) {
        let ends = ["; ", ": ", ", "].map(|between| text[..end].rfind(between));
        let end = ends[0].max(ends[1]).or(ends[2]);
        text.truncate(end.unwrap_or(text.len()));
    }
    text
}
