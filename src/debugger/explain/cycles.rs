//! Describes cycles of minor and major iterations.

use crate::explain::core::changes;
use crate::explain::names::{mode, slave};
use stickslip_core::step::major_history::Stop;
use stickslip_core::{Cycle, MajorCycle, Mode, Model};
use stickslip_scene::{first_of, joined};

/// Maximum number of nodes named in a cycle.
const MOST_NODES: usize = 6;

/// A sequence of modes in words; long runs are counted.
pub fn pattern(words: &[&str]) -> String {
    joined(
        words.chunk_by(|a, b| a == b).map(|stay| match stay {
            [word, _, _, ..] => format!("{word} ({} times)", stay.len()),
            _ => stay.join(" → "),
        }),
        " → ",
    )
}

/// Maximum number of stops named per node in a cycle of major iterations.
const MOST_STOPS: usize = 4;

/// Describes a cycle of major iterations.
pub fn major_cycle(model: &Model, round: &MajorCycle) -> String {
    let member = |(s, stops): &(usize, Vec<Stop>)| {
        let elements: Vec<_> = stops.iter().map(|stop| stop.element).collect();
        let modes: Vec<_> = stops.iter().map(|stop| stop.mode).collect();
        let (moves, switches) = (changes(&elements), changes(&modes));
        let words: Vec<String> = stops
            .iter()
            .take(MOST_STOPS)
            .map(|stop| match (moves, switches) {
                (true, false) => place(model, stop.element),
                (false, true) => mode(stop.mode).to_string(),
                _ => format!("{} on {}", mode(stop.mode), place(model, stop.element)),
            })
            .collect();
        match (moves, switches) {
            (false, false) => format!("{} stays {}", slave(model, *s), words[0]),
            _ => format!("{} {} → …", slave(model, *s), words.join(" → ")),
        }
    };
    format!(
        "major iterations cycle with period {} from major {}: {}",
        round.period,
        round.start,
        first_of(round.members.iter().map(member), MOST_NODES, "; ")
    )
}

/// Name of a master element: its surface, and its number from 1.
pub fn place(model: &Model, element: Option<(usize, usize)>) -> String {
    match element {
        Some((surface, element)) => {
            let name = model.surfaces.get(surface).map_or("?", |s| s.name.as_str());
            format!("{name} element {}", element + 1)
        }
        None => "no surface".into(),
    }
}

/// Maximum number of cycle members with constant modes that are named.
const MOST_FOLLOWING: usize = 3;

/// Describes a cycle of modes.
pub fn cycle(model: &Model, cycle: &Cycle) -> String {
    let member = |(s, modes): &(usize, Vec<Mode>)| {
        let name = slave(model, *s);
        match modes.as_slice() {
            [first, rest @ ..] if rest.iter().all(|m| m == first) => {
                format!("{name} stays {} while its T_max repeats", mode(*first))
            }
            modes => {
                let words: Vec<&str> = modes.iter().map(|m| mode(*m)).collect();
                format!("{name} {} → …", pattern(&words))
            }
        }
    };
    // Members whose modes change come first: the T_max of many others may follow them.
    let (changing, following): (Vec<_>, Vec<_>) =
        cycle.members.iter().partition(|(_, modes)| changes(modes));
    let mut text = Vec::new();
    if !changing.is_empty() {
        text.push(first_of(changing.into_iter().map(member), MOST_NODES, "; "));
    }
    match following.len() {
        0 => {}
        n if n > MOST_FOLLOWING => {
            text.push(format!(
                "{n} nodes keep their modes while their T_max repeats"
            ));
        }
        _ => text.extend(following.into_iter().map(member)),
    }
    format!(
        "cycle of period {} from minor {}: {}",
        cycle.period,
        cycle.start,
        text.join("; ")
    )
}
