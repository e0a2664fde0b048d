//! A journal as readable text: what the user did and what happened.

use crate::explain::names;
use crate::record::journal::{Entry, JournalError, Record, date};
use crate::{BranchTarget, Command, Unit};
use stickslip_core::{Model, counted};
use stickslip_scene::few;

/// The text of a journal.
///
/// # Errors
/// If this version rejects the journal's scene.
pub fn story(record: &Record) -> Result<String, JournalError> {
    let model = record.scene()?.model;
    let header = &record.header;
    let [year, month, day, hour, minute, _] = date(header.began);
    let mut text = format!("{}: {}\n", header.name, model.title);
    text += &format!(
        "Session of {year:04}-{month:02}-{day:02} {hour:02}:{minute:02} UTC with stickslip {}.\n",
        header.version
    );
    let names = (0..model.contacts.len()).map(|s| names::slave(&model, s));
    text += &format!("Slave nodes: {}.\n\n", few(names, 6));
    let shown: Vec<&Entry> = record.entries.iter().map(|(_, entry)| entry).collect();
    let mut number = 0;
    for (k, entry) in shown.iter().enumerate() {
        // Of consecutive cursor moves only the last one matters.
        let next = shown.get(k + 1);
        if is_look(entry) && next.is_some_and(|next| is_look(next)) {
            continue;
        }
        number += 1;
        text += &format!("{number:>3}. {}\n", done(&model, entry));
        for line in result_lines(entry) {
            text += &format!("     {line}\n");
        }
    }
    if number == 0 {
        text += "No commands were recorded.\n";
    }
    text += &end(record);
    Ok(text)
}

/// Whether an entry only moved the cursor.
fn is_look(entry: &Entry) -> bool {
    entry.command.is_motion() && entry.solved == 0
}

/// The command, in a sentence.
pub fn done(model: &Model, entry: &Entry) -> String {
    let slave = |s: &usize| names::slave(model, *s);
    match &entry.command {
        Command::Forward { unit, count } if entry.solved > 0 => {
            format!("{}.", forward(*unit, *count))
        }
        Command::Forward { .. } | Command::Back { .. } | Command::Goto { .. } => {
            "Moved to another iteration.".into()
        }
        Command::Force {
            slave: s,
            mode,
            hold,
        } => {
            let how = if *hold {
                "until released"
            } else {
                "for one minor iteration"
            };
            format!("Forced {} to {} {how}.", slave(s), mode.word())
        }
        Command::Assume(starts) => {
            format!(
                "Started from a consistent state: {}.",
                names::starts(model, starts, usize::MAX)
            )
        }
        Command::Follow { label, steps } => {
            format!(
                "Applied a remedy ({}): {label}.",
                counted(steps.len(), "step")
            )
        }
        Command::Release { slave: s } => {
            format!("Released {}, so that Table 2 decides again.", slave(s))
        }
        Command::Increment(size) => format!("Restarted the increment with size {size}."),
        Command::Set { path, value } => format!("Set {path} to {value}."),
        Command::Branch(BranchTarget::Named(name)) => format!("Went to branch {name}."),
        Command::Branch(_) => "Went to another branch.".into(),
        Command::Rename(name) => format!("Renamed the branch to '{name}'."),
        Command::Break(condition) => {
            format!("Set a breakpoint: {}.", condition.describe(model))
        }
        Command::Delete(id) => format!("Deleted {}.", breakpoint(*id)),
        Command::Enable { id, on: true } => format!("Enabled {}.", breakpoint(*id)),
        Command::Enable { id, on: false } => format!("Disabled {}.", breakpoint(*id)),
        Command::Watch(watch) => format!("Watched {}.", watch.name),
        Command::Unwatch(name) => format!("Stopped watching {name}."),
        Command::Branches
        | Command::Compare(_)
        | Command::Breakpoints
        | Command::Census(_)
        | Command::Remedies
        | Command::Export { .. }
        | Command::Journal(_)
        | Command::Snapshot { .. } => "Viewed or wrote results.".into(),
    }
}

fn breakpoint(id: Option<u32>) -> String {
    id.map_or("all breakpoints".into(), |id| format!("breakpoint {id}"))
}

fn forward(unit: Unit, count: u32) -> String {
    let what = match unit {
        Unit::Minor => "minor iteration",
        Unit::Major => "major iteration",
        Unit::Increment => "increment",
        Unit::Run => return "Continued the run".into(),
    };
    match count {
        1 => format!("Advanced by a {what}").replace("a increment", "an increment"),
        n => format!("Advanced by {n} {what}s"),
    }
}

/// The result of the command.
fn result_lines(entry: &Entry) -> Vec<String> {
    let mut lines = Vec::new();
    if entry.solved > 0 {
        let increments = match entry.accepted {
            0 => String::new(),
            n => format!(", {} accepted", counted(n, "increment")),
        };
        lines.push(format!(
            "Solved {}{increments}.",
            counted(entry.solved, "minor iteration")
        ));
    }
    lines.push(format!("Result: {}", entry.said));
    lines
}

fn end(record: &Record) -> String {
    let mut text = String::new();
    if let Some((_, last)) = record.entries.last() {
        text += &format!(
            "\nThe session ended in branch b{} at step {}, state {}",
            last.branch.saturating_add(1),
            last.cursor,
            last.digest
        );
        text += &record.reservations();
        text += ".\n";
    }
    text
}
