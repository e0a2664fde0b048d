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
use super::result::{End, Run};
use std::fmt::Write;

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
        End::Finished | End::NotRun => {}
        End::Failed(failed) => {
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
        End::Interrupted => {
            let _ = writeln!(text, "{leading}interrupted,,,,,{blanks}");
        }
    }
}

/// A text as a field of a CSV file.
pub(super) fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_split_as_they_were_joined() {
        let fields = ["a", "b,c", "", "say \"no\"", "✗"];
        let line: Vec<String> = fields.iter().map(|f| field(f)).collect();
        assert_eq!(split(&line.join(",")), fields);
    }
}
