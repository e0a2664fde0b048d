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
    let mut text = brief(model, failure);
    text.truncate(end_of_part(&text));
    text
}

/// Where the longest part of a text ends that has at most 80 characters and no open parenthesis.
fn end_of_part(text: &str) -> usize {
    const LONGEST: usize = 80;
    let Some((end, _)) = text.char_indices().nth(LONGEST) else {
        return text.len();
    };
    let ends = ["; ", ": ", ", "].map(|between| text[..end].rfind(between));
    let end = ends[0].max(ends[1]).or(ends[2]).unwrap_or(text.len());
    match text[..end].rfind(" (") {
        Some(open) if !text[open..end].contains(')') => open,
        _ => end,
    }
}

#[cfg(test)]
mod tests {
    use super::end_of_part;

    #[test]
    fn a_cut_text_has_no_open_parenthesis() {
        let long =
            "contact modes repeat with period 4 from minor 17 (sheet.156, sheet.155 and 36 more)";
        assert_eq!(
            &long[..end_of_part(long)],
            "contact modes repeat with period 4 from minor 17"
        );
        let closed = "refused: friction drives the slip of up.2 (slip -0.18, F_t -0.004); the last equilibrium is increment 1";
        assert_eq!(
            &closed[..end_of_part(closed)],
            "refused: friction drives the slip of up.2 (slip -0.18, F_t -0.004)"
        );
        let short = "contact modes repeat with period 4 from minor 7 (a, b)";
        assert_eq!(end_of_part(short), short.len());
    }
}
