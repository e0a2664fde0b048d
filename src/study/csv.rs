//! All results of a study as one table.
//!
//! Columns: the varied settings; `status`; `increment,load,majors,minors,unsettled`; the monitors; `jumped`.
//! One row per accepted increment, with the status `converged`, or `accepted` if a loop did not settle. A
//! failed run has one more row whose status is the reason (`minor-cycle`, `major-limit`, …), with the
//! increment, load and major iteration of the failure and the number of minor iterations until then, without
//! monitors. An interrupted run has a last row `interrupted`; a run that had not started has no rows.
//!
//! `jumped` is 1 if an increment leaves its branch of stable equilibrium, otherwise 0.
//!
//! Floats have enough digits to read back to the same bits.

use super::plan::Plan;
use super::result::{CaseEnd, Run};
use super::run_error::error_at;
use std::fmt::Write;
use stickslip_platform::input::MARK;
use stickslip_scene::{SceneError, joined, shown};

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
    let names = plan
        .columns
        .iter()
        .map(String::as_str)
        .chain(words)
        .chain(plan.monitors.iter().map(String::as_str))
        .chain(["jumped"]);
    joined(names.map(field), ",") + "\n"
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
    if text.contains([',', '"']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.into_owned()
    }
}

/// Comment lines before a table, with its origin.
pub fn comments<'a>(lines: impl IntoIterator<Item = &'a String>) -> String {
    lines
        .into_iter()
        .map(|line| format!("# {}\n", shown::line(line)))
        .collect()
}

/// A table to be read: CSV with `#` lines as comments and a header. Spaces around fields are ignored.
pub(super) struct Table<'a> {
    file: &'a str,
    text: &'a str,
    header: CsvRow,
    /// The rows below the header, each with any number of fields.
    pub(super) rows: Vec<CsvRow>,
}

/// A row of a [`Table`].
pub(super) struct CsvRow {
    pub(super) fields: csv::StringRecord,
    /// Byte offset of its line.
    start: usize,
}

impl<'a> Table<'a> {
    /// Parses a table; `file` is its name for messages.
    ///
    /// # Errors
    /// If there is no header.
    pub(super) fn read(file: &'a str, text: &'a str) -> Result<Table<'a>, SceneError> {
        let text = text.strip_prefix(MARK).unwrap_or(text);
        let wrong = |message: String| error_at(file, (1, 1), message);
        let mut reader = csv::ReaderBuilder::new();
        reader.has_headers(false).flexible(true);
        reader.trim(csv::Trim::All).comment(Some(b'#'));
        let mut rows = Vec::new();
        for fields in reader.from_reader(text.as_bytes()).into_records() {
            let fields = fields.map_err(|error| wrong(error.to_string()))?;
            let first = fields.get(0).unwrap_or_default();
            if first.starts_with('#') || (first.is_empty() && fields.len() == 1) {
                continue;
            }
            let start = fields.position().map_or(0, |at| at.byte() as usize);
            let start = start + skipped(&text[start..]);
            rows.push(CsvRow { fields, start });
        }
        if rows.is_empty() {
            return Err(wrong("there is no header".into()));
        }
        let header = rows.remove(0);
        Ok(Table {
            file,
            text,
            header,
            rows,
        })
    }

    /// The texts of its comments.
    pub(super) fn comments(&self) -> impl Iterator<Item = &'a str> {
        self.text
            .lines()
            .filter_map(|line| line.strip_prefix('#').map(str::trim))
    }

    /// Names of its columns.
    pub(super) fn heads(&self) -> Vec<&str> {
        self.header.fields.iter().collect()
    }

    /// The header line of the file.
    pub(super) fn header_line(&self) -> &'a str {
        self.line(&self.header).trim()
    }

    /// Rejects a row whose number of fields differs from the header's.
    pub(super) fn check(&self, row: &CsvRow) -> Result<(), SceneError> {
        let (has, wants) = (row.fields.len(), self.header.fields.len());
        if has == wants {
            return Ok(());
        }
        let message = format!("the row has {has} fields, the header {wants}");
        Err(self.wrong(row, 0, message))
    }

    /// An error about the header, or about the whole table.
    pub(super) fn wrong_header(&self, message: String) -> SceneError {
        self.wrong(&self.header, 0, message)
    }

    /// An error at a field (from 0) of a row.
    pub(super) fn wrong(&self, row: &CsvRow, field: usize, message: String) -> SceneError {
        let line = 1 + self.text[..row.start].matches('\n').count();
        error_at(self.file, (line, column(self.line(row), field)), message)
    }

    fn line(&self, row: &CsvRow) -> &'a str {
        self.text[row.start..].lines().next().unwrap_or_default()
    }
}

/// Length of the comments and blank lines at the beginning of a text: record positions do not include these.
fn skipped(text: &str) -> usize {
    let lines = text.split_inclusive('\n');
    lines
        .take_while(|line| line.trim().is_empty() || line.starts_with('#'))
        .map(str::len)
        .sum()
}

/// The column (from 1, in characters) at which a field (from 0) of a line begins; past the end if there are
/// fewer fields.
fn column(line: &str, wanted: usize) -> usize {
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
    fn fields_survive_joining_and_splitting() {
        let fields = ["a", "b,c", "", "say \"no\"", "✗"];
        let line: Vec<String> = fields.iter().map(|f| field(f)).collect();
        let line = line.join(",");
        let table = Table::read("x", &line).ok().unwrap();
        assert_eq!(table.heads(), fields);
        let places: Vec<usize> = (0..6).map(|k| column(&line, k)).collect();
        assert_eq!(places, [1, 3, 9, 10, 23, 24]);
    }

    #[test]
    fn rows_are_located_after_comments_blank_lines_and_multi_line_fields() {
        let text = "# \"a\n\n  # b\nh,i\r\n \t\n# c\n1,\"2\n3\"\n\n4, 5\n";
        let table = Table::read("x", text).ok().unwrap();
        assert_eq!(table.heads(), ["h", "i"]);
        assert_eq!(table.header_line(), "h,i");
        assert_eq!(table.comments().collect::<Vec<_>>(), ["\"a", "c"]);
        let rows: Vec<Vec<&str>> = table
            .rows
            .iter()
            .map(|row| row.fields.iter().collect())
            .collect();
        assert_eq!(rows, [["1", "2\n3"], ["4", "5"]]);
        let wrong =
            |row: usize, field| table.wrong(&table.rows[row], field, "!".into()).to_string();
        assert_eq!(
            [wrong(0, 1), wrong(1, 0), wrong(1, 1)],
            ["x:7:3: !", "x:10:1: !", "x:10:3: !"]
        );
        assert_eq!(table.wrong_header("!".into()).to_string(), "x:4:1: !");
    }
}
