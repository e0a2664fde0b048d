//! A run that is over as text, for who has no terminal.

use super::run::Past;
use super::words;
use crate::explain::number::plain;
use std::fmt::Write;

/// The whole run: attempts with their ends and cycles, then who chattered.
pub fn text(past: &Past) -> String {
    let mut text = format!(
        "{}: {}\n{}\n",
        past.name,
        words::READ_ONLY,
        words::size(past)
    );
    for note in words::notes(past) {
        text += &format!("note: {note}\n");
    }
    text += &format!("{}\n\n", words::NO_MODES_IN_FULL);
    text += &attempts(past);
    text += &cycles(past);
    text += &chatter(past);
    text
}

const HEADINGS: [&str; 9] = [
    "step",
    "increment",
    "attempt",
    "iterations",
    "ended",
    "residual %",
    "correction %",
    "closed",
    "switches",
];

/// A row for every attempt.
fn attempts(past: &Past) -> String {
    let mut switches = vec![0; past.run.attempts.len()];
    for (attempt, count) in past.chatter.iter().flat_map(|c| &c.attempts) {
        switches[*attempt] += count;
    }
    let mut rows = vec![HEADINGS.map(str::to_owned)];
    for (index, attempt) in past.run.attempts.iter().enumerate() {
        let last = attempt.iterations.clone().last();
        let norms = last.and_then(|last| past.norms(last));
        let number = |value: Option<f64>| value.map_or("-".into(), plain);
        let closed = last.and_then(|last| past.closed(last));
        let count = match attempt.row {
            Some(row) => row.iterations.to_string(),
            None => attempt.iterations.len().to_string(),
        };
        rows.push([
            attempt.step.to_string(),
            attempt.increment.to_string(),
            attempt.attempt.to_string(),
            count,
            words::end_word(past, index).to_owned(),
            number(norms.map(|norms| norms.residual)),
            number(norms.map(|norms| norms.correction)),
            closed.map_or("-".into(), |closed| closed.to_string()),
            switches[index].to_string(),
        ]);
    }
    table(&rows)
}

/// The cycles, a line each.
fn cycles(past: &Past) -> String {
    let mut text = String::new();
    for (index, attempt) in past.run.attempts.iter().enumerate() {
        let Some(cycle) = words::cycle(past, index) else {
            continue;
        };
        let (step, increment, number) = (attempt.step, attempt.increment, attempt.attempt);
        let _ = writeln!(
            text,
            "step {step}, increment {increment}, attempt {number}: {cycle}"
        );
    }
    match text.is_empty() {
        true => "\nNo attempt cycles.\n".into(),
        false => format!("\nCycles\n{text}"),
    }
}

/// Who switched, most often first.
fn chatter(past: &Past) -> String {
    if past.chatter.is_empty() {
        return "\nNo contact switches between the iterations of an attempt.\n".into();
    }
    let mut rows = vec![["contact", "switches", "most", "in", "attempts"].map(str::to_owned)];
    for chatter in &past.chatter {
        let most = chatter.most();
        let place = chatter.attempts.iter().find(|(_, count)| *count == most);
        let place = place.map(|(attempt, _)| place_of(past, *attempt));
        let corners = past.corners(chatter.slave);
        let corners = corners.map_or(String::new(), |corners| format!(" ({corners})"));
        rows.push([
            format!("{}{corners}", past.slave(chatter.slave)),
            chatter.switches.to_string(),
            most.to_string(),
            place.unwrap_or_default(),
            chatter.attempts.len().to_string(),
        ]);
    }
    let head = "\nContacts that switch between the iterations of an attempt: how often, most in one attempt, and in how many\n";
    head.to_owned() + &table(&rows)
}

/// An attempt by its numbers: step.increment.attempt.
pub fn place_of(past: &Past, attempt: usize) -> String {
    let attempt = &past.run.attempts[attempt];
    format!("{}.{}.{}", attempt.step, attempt.increment, attempt.attempt)
}

/// Rows in columns, the first flush left and the others right.
fn table<const N: usize>(rows: &[[String; N]]) -> String {
    let mut widths = [0; N];
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = cell.len().max(*width);
        }
    }
    let line = |row: &[String; N]| {
        let cells = row.iter().zip(widths).enumerate();
        let cells = cells.map(|(column, (cell, width))| match column {
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        cells.collect::<Vec<_>>().join("  ") + "\n"
    };
    rows.iter().map(line).collect()
}
