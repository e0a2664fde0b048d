//! All results of a study as one table.
//!
//! Columns: what differs between the runs; `status`; `increment,load,majors,minors,unsettled`; the monitors; `jumped`. One row
//! per accepted increment: its status is `converged`, or `accepted` where a loop was cut off unsettled. A run that
//! failed has one last row whose status is the reason (`minor-cycle`, `major-limit`, …): it says at which increment,
//! tried load and major iteration, after how many minor ones, and has no monitors. One that was stopped from outside
//! has a last row `interrupted`; one that had not begun has none.
//!
//! `jumped` is 1 where an increment ends on another branch of equilibrium than it began on, else 0.
//!
//! Floats have as many digits as they need to read back to the same bits.

use super::plan::Plan;
use super::result::{CaseEnd, Run};
use crate::outside::input::Unreadable;
use crate::outside::shown;
use std::fmt::Write;
use std::path::Path;

/// Why a table cannot be read: where, and what is wrong.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    #[error("{}", why.of(file))]
    Unreadable { file: String, why: Unreadable },
    #[error("{file}:{line}:{column}: {message}")]
    Wrong {
        file: String,
        line: usize,
        column: usize,
        message: String,
    },
}

impl TableError {
    /// A file that cannot be read at all.
    pub(super) fn unreadable(file: &Path, why: Unreadable) -> TableError {
        let file = file.display().to_string();
        TableError::Unreadable { file, why }
    }
}

/// The table, header first.
pub fn table(plan: &Plan, runs: &[Run]) -> String {
    let mut text = header(plan);
    for (case, run) in plan.cases.iter().zip(runs) {
        let leading: String = case.values.iter().map(|v| field(v) + ",").collect();
        rows(&mut text, &leading, plan, run);
    }
    text
}

fn header(plan: &Plan) -> String {
    let words = [
        "status",
        "increment",
        "load",
        "majors",
        "minors",
        "unsettled",
    ];
    let names = plan.columns.iter().map(String::as_str).chain(words);
    let names = names.chain(plan.monitors.iter().map(String::as_str));
    let names = names.chain(["jumped"]);
    names.map(field).collect::<Vec<_>>().join(",") + "\n"
}

/// The rows of one run. Writing to a string does not fail.
fn rows(text: &mut String, leading: &str, plan: &Plan, run: &Run) {
    let place = |name: &String| run.monitors.iter().position(|own| own == name);
    let places: Vec<Option<usize>> = plan.monitors.iter().map(place).collect();
    for row in &run.rows {
        let status = match row.unsettled {
            0 => "converged",
            _ => "accepted",
        };
        let _ = write!(
            text,
            "{leading}{status},{},{:?},{},{},{}",
            row.increment, row.load, row.majors, row.minors, row.unsettled
        );
        for place in &places {
            text.push(',');
            if let Some(value) = place.and_then(|k| row.monitors.get(k)) {
                let _ = write!(text, "{value:?}");
            }
        }
        text.push_str(if row.jumped { ",1\n" } else { ",0\n" });
    }
    let blanks = ",".repeat(plan.monitors.len() + 1);
    match &run.end {
        CaseEnd::Finished | CaseEnd::NotRun => {}
        CaseEnd::Failed(failed) => {
            let _ = writeln!(
                text,
                "{leading}{},{},{:?},{},{},{}{blanks}",
                failed.reason,
                failed.increment,
                failed.load,
                failed.major,
                failed.minors,
                failed.unsettled
            );
        }
        CaseEnd::Interrupted => {
            let _ = writeln!(text, "{leading}interrupted,,,,,{blanks}");
        }
    }
}

/// A text as a field of a CSV file.
pub fn field(text: &str) -> String {
    let text = shown::line(text);
    match text.contains([',', '"']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.into_owned(),
    }
}

/// Lines before a table that say what it is.
pub fn comments<'a>(lines: impl IntoIterator<Item = &'a String>) -> String {
    let comment = |line: &'a String| format!("# {}\n", shown::line(line));
    lines.into_iter().map(comment).collect()
}

/// The fields of a line of a CSV file; quoted ones may have commas, and quotes twice.
pub fn split(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        let doubled = quoted && letter == '"' && letters.peek() == Some(&'"');
        match (letter, fields.last_mut()) {
            ('"', Some(field)) if doubled => {
                letters.next();
                field.push('"');
            }
            ('"', _) => quoted = !quoted,
            (',', _) if !quoted => fields.push(String::new()),
            (letter, Some(field)) => field.push(letter),
            (_, None) => {}
        }
    }
    fields
}

/// The column, from 1 and in characters, at which field number `wanted` (from 0) of a line begins; behind the line where it
/// has fewer.
pub fn column(line: &str, wanted: usize) -> usize {
    let (mut field, mut quoted) = (0, false);
    for (k, letter) in line.chars().enumerate() {
        if field == wanted {
            return k + 1;
        }
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => field += 1,
            _ => {}
        }
    }
    line.chars().count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_split_as_they_were_joined() {
        let fields = ["a", "b,c", "", "say \"no\"", "✗"];
        let line: Vec<String> = fields.iter().map(|f| field(f)).collect();
        assert_eq!(split(&line.join(",")), fields);
        let places: Vec<usize> = (0..6).map(|k| column(&line.join(","), k)).collect();
        assert_eq!(places, [1, 3, 9, 10, 23, 24]);
    }
}
