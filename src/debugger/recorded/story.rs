//! A stored exchange as text: iterations, interventions, and cycles.

use super::exchange::{Line, OpenedExchange};
use super::log::LogOrigin;
use crate::Strip;
use crate::explain::{names, report};
use crate::history::rounds::{Rounds, rounds, words};
use std::fmt::Write;
use stickslip_core::{Model, Solver};
use stickslip_exchange::attach::message::Level;
use stickslip_scene::few;

/// Maximum number of contacts named, and of messages shown.
const NAMED: usize = 6;
const TOLD: usize = 20;

/// The text of the file with this name.
pub fn story(file: &str, opened: &mut OpenedExchange) -> String {
    let model = opened.past.model().clone();
    let offers = opened.past.capabilities();
    let who = format!("{} {}", offers.name, offers.version);
    let mut text = format!(
        "{file}: {}\nStored exchange with {} (read-only).\n",
        model.title,
        who.trim()
    );
    let named = (0..model.contacts.len()).map(|s| names::slave(&model, s));
    let _ = writeln!(text, "Contacts: {}.", few(named, NAMED));
    if opened.lines.is_empty() {
        text += "\nNo iterations.\n";
    }
    for number in 0..opened.lines.len() {
        let (before, line) = (&opened.lines[..number], &opened.lines[number]);
        let (along, whose) = before
            .iter()
            .enumerate()
            .map(|(k, other)| (in_common(line, other), k))
            .max_by_key(|&(along, k)| (along, std::cmp::Reverse(k)))
            .unwrap_or((0, 0));
        text += "\n";
        let _ = match (number, opened.lines.len()) {
            (0, 1) => Ok(()),
            (0, _) => writeln!(text, "Branch b1:"),
            _ => writeln!(
                text,
                "Branch b{}, from b{} after step {along}:",
                number + 1,
                whose + 1
            ),
        };
        text += &way(&model, &mut opened.past, line, along);
    }
    text += &last_messages(opened);
    text
}

/// Number of steps that two paths share.
pub fn in_common(a: &Line, b: &Line) -> usize {
    a.iter().zip(b).take_while(|(a, b)| a == b).count()
}

/// The steps of a path, from a step on.
fn way(
    model: &Model,
    past: &mut super::exchange::RecordedSolver,
    line: &Line,
    from: usize,
) -> String {
    past.rewind();
    let mut strips = vec![Strip::new(model, past.state(), None, None, 0.0)];
    let mut text = String::new();
    for (number, step) in line.iter().enumerate() {
        let before = &strips[strips.len() - 1];
        let (strip, words) = match step {
            Some(intervention) => {
                // It was accepted in the original session.
                let _ = past.intervene(intervention);
                let strip = Strip::intervention(model, past.state(), before);
                (
                    strip,
                    format!("◇ {}", report::intervention(model, intervention)),
                )
            }
            None => {
                if !past.step().is_ok_and(|solved| solved) {
                    break;
                }
                let event = past.event();
                let strip = Strip::new(model, past.state(), Some(event), Some(before), 0.0);
                let mut words = report::outcome(model, event);
                let differ = (0..model.contacts.len()).filter(|&slave| strip.differs(slave));
                let differ = few(differ.map(|slave| names::slave(model, slave)), NAMED);
                if !differ.is_empty() {
                    words += &format!("; ≠ own rules at {differ}");
                }
                (strip, words)
            }
        };
        let next = strip.position;
        let then = before.position;
        let begins = (next.increment, next.attempt) != (then.increment, then.attempt);
        if begins && strips.len() > 1 && number > from {
            text += &cycle(model, &strips);
        }
        strips.push(strip);
        if number >= from {
            let _ = writeln!(text, "{:>5}. {words}", number + 1);
        }
    }
    text + &cycle(model, &strips)
}

/// The cycle at the end of an attempt, if there is one, as a line.
fn cycle(model: &Model, strips: &[Strip]) -> String {
    match rounds(strips) {
        Some(found @ Rounds::Cycle { .. }) => format!("       ↺ {}\n", words(model, &found, true)),
        _ => String::new(),
    }
}

/// The last warnings and errors, and the last remark.
fn last_messages(opened: &OpenedExchange) -> String {
    let (_, lines) = opened.log.lines();
    let grave = |how: LogOrigin| matches!(how, LogOrigin::Message(Level::Warning | Level::Error));
    let all: Vec<String> = lines
        .iter()
        .filter(|said| grave(said.how))
        .map(|said| format!("  {}: {}\n", said.how.word(), said.text))
        .collect();
    let mut text = String::new();
    if !all.is_empty() {
        let _ = writeln!(text, "\nWarnings and errors: {}", all.len());
        text += &all[all.len().saturating_sub(TOLD)..].concat();
    }
    if let Some(last) = lines.iter().rev().find(|said| said.how == LogOrigin::Noted) {
        let _ = writeln!(text, "\nLast remark: {}", last.text);
    }
    text
}
