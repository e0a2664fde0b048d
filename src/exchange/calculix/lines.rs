//! Reads possibly huge files line by line, and splits lines into fields.
//!
//! Fields are separated by spaces and commas. Numbers use Fortran formats: `0.1000-100` is 1e-101, and `****` is a number that
//! does not fit its column.

use super::Stop;
use crate::FormatError;
use std::io::{BufRead, Read};

/// Maximum length of a line in bytes; the longest line of CalculiX has 160.
const MOST: usize = 4096;

/// The lines of a file.
pub(super) struct Lines<R> {
    from: R,
    bytes: Vec<u8>,
    number: usize,
}

/// A line.
#[derive(Debug, Clone, Copy)]
pub(super) struct ResultLine<'a> {
    /// Line number, from 1.
    pub number: usize,
    /// Content without the line end.
    pub bytes: &'a [u8],
    /// Whether it has a line end; only the last line may lack one.
    pub whole: bool,
}

impl<R: BufRead> Lines<R> {
    pub fn new(from: R) -> Self {
        Lines {
            from,
            bytes: Vec::new(),
            number: 0,
        }
    }

    /// The next line; `None` at the end of the file.
    ///
    /// # Errors
    /// If it cannot be read, or is longer than any line of such a file.
    pub fn next(&mut self) -> Result<Option<ResultLine<'_>>, FormatError> {
        self.bytes.clear();
        self.number += 1;
        let most = MOST as u64 + 1;
        let read = self
            .from
            .by_ref()
            .take(most)
            .read_until(b'\n', &mut self.bytes);
        read.map_err(|error| FormatError::at(self.number, 1, format!("reading failed: {error}")))?;
        if self.bytes.is_empty() {
            return Ok(None);
        }
        let whole = self.bytes.last() == Some(&b'\n');
        if !whole && self.bytes.len() > MOST {
            let message =
                format!("the line is longer than {MOST} bytes; CalculiX writes no such lines");
            return Err(FormatError::at(self.number, 1, message));
        }
        let end = self.bytes.len() - usize::from(whole);
        let bytes = &self.bytes[..end];
        Ok(Some(ResultLine {
            number: self.number,
            bytes: bytes.strip_suffix(b"\r").unwrap_or(bytes),
            whole,
        }))
    }
}

/// A field of a line: its first byte, from 1, and its content.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field<'a> {
    line: ResultLine<'a>,
    start: usize,
    /// Content.
    pub bytes: &'a [u8],
}

impl<'a> ResultLine<'a> {
    /// The nonempty fields.
    pub fn fields(self) -> impl Iterator<Item = Field<'a>> {
        let parts = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
        let mut start = 0;
        std::iter::from_fn(move || {
            start += self.bytes[start..].iter().position(|byte| !parts(byte))?;
            let rest = &self.bytes[start..];
            let length = rest.iter().position(parts).unwrap_or(rest.len());
            let field = Field {
                line: self,
                start,
                bytes: &rest[..length],
            };
            start += length;
            Some(field)
        })
    }

    /// An error after a byte of the line.
    pub fn wrong(self, byte: usize, message: impl Into<String>) -> FormatError {
        let before = String::from_utf8_lossy(&self.bytes[..byte.min(self.bytes.len())]);
        FormatError::at(self.number, 1 + before.chars().count(), message)
    }

    /// Something is missing at the end of the line.
    pub fn ends_early(self, message: impl Into<String>) -> FormatError {
        self.wrong(self.bytes.len(), message)
    }
}

impl Field<'_> {
    /// The field without this suffix, if it has it.
    pub fn without(self, end: &[u8]) -> Self {
        Field {
            bytes: self.bytes.strip_suffix(end).unwrap_or(self.bytes),
            ..self
        }
    }

    /// An error in the field.
    pub fn wrong(self, message: impl Into<String>) -> FormatError {
        self.line.wrong(self.start, message)
    }

    /// The field for a message.
    fn shown(self) -> String {
        const MOST: usize = 20;
        let text = String::from_utf8_lossy(self.bytes);
        text.chars()
            .filter(|c| !c.is_control())
            .take(MOST)
            .collect()
    }

    /// Whether this is a number that did not fit its column.
    pub fn overflows(self) -> bool {
        !self.bytes.is_empty() && self.bytes.iter().all(|byte| *byte == b'*')
    }

    /// The field as a whole number; `what` names it in errors.
    pub fn whole_number(self, what: &str) -> Result<u32, FormatError> {
        let text = std::str::from_utf8(self.bytes).ok();
        let number = text
            .filter(|text| text.bytes().all(|byte| byte.is_ascii_digit()))
            .and_then(|text| text.parse().ok());
        number.ok_or_else(|| {
            let shown = self.shown();
            self.wrong(format!(
                "found '{shown}' where the {what}, a whole number, was expected"
            ))
        })
    }

    /// The field as a number; `what` names it in errors.
    pub fn number(self, what: &str) -> Result<f64, FormatError> {
        let text = std::str::from_utf8(self.bytes).ok();
        text.and_then(fortran).ok_or_else(|| {
            let shown = self.shown();
            self.wrong(format!(
                "found '{shown}' where the {what}, a number, was expected"
            ))
        })
    }
}

/// Reads a table: a title, headings, and rows that begin with a whole number. Returns where it is truncated, if it is; text after
/// a number that does not fit its column is ignored.
///
/// # Errors
/// If the first line does not begin with the title, or a row is rejected.
pub(super) fn table(
    from: impl BufRead,
    title: &str,
    what: &str,
    mut take: impl FnMut(ResultLine, &[Field]) -> Result<(), FormatError>,
) -> Result<Option<Stop>, FormatError> {
    let mut lines = Lines::new(from);
    let mut headings = true;
    while let Some(line) = lines.next()? {
        if !line.whole {
            return Ok(Some(Stop::Cut(line.number)));
        }
        if line.number == 1 && !line.bytes.trim_ascii_start().starts_with(title.as_bytes()) {
            let message = format!("this is not a CalculiX {what}: it must begin with '{title}'");
            return Err(line.wrong(0, message));
        }
        let fields: Vec<Field> = line.fields().collect();
        let Some(first) = fields.first() else {
            continue;
        };
        headings &= !first.overflows() && !first.bytes.iter().all(u8::is_ascii_digit);
        if headings {
            continue;
        }
        if fields.iter().any(|field| field.overflows()) {
            return Ok(Some(Stop::NoRoom(line.number)));
        }
        take(line, &fields)?;
    }
    Ok(None)
}

/// Parses a Fortran number: before an exponent of three digits, the letter is omitted.
fn fortran(text: &str) -> Option<f64> {
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let sign = text.rfind(['+', '-']).filter(|at| *at > 0)?;
    let (mantissa, exponent) = text.split_at(sign);
    let digits = exponent[1..].bytes().all(|byte| byte.is_ascii_digit());
    let plain = mantissa.ends_with(|c: char| c.is_ascii_digit() || c == '.');
    (digits && plain).then(|| format!("{mantissa}e{exponent}").parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_fortran_writes_them() {
        for (text, number) in [
            ("0.1140E+04", Some(1140.0)),
            ("-0.5000-100", Some(-0.5e-100)),
            ("0.1000+101", Some(0.1e101)),
            ("+1", Some(1.0)),
            ("Infinity", Some(f64::INFINITY)),
            ("1-", None),
            ("1--2", None),
            ("-", None),
            ("1e-x", None),
        ] {
            let read = fortran(text);
            // An exponent needs digits.
            assert_eq!(read, number, "{text}");
        }
        assert!(fortran("NaN").is_some_and(f64::is_nan));
    }

    #[test]
    fn field_columns_count_characters() {
        let text = " 12 ,ü, x".as_bytes();
        let line = ResultLine {
            number: 3,
            bytes: text,
            whole: true,
        };
        let fields: Vec<Field> = line.fields().collect();
        assert_eq!(fields.len(), 3);
        let wrong = fields[2].whole_number("node").unwrap_err();
        assert_eq!(wrong.at, Some((3, 9)));
        assert_eq!(
            wrong.message,
            "found 'x' where the node, a whole number, was expected"
        );
        assert_eq!(line.ends_early("").at, Some((3, 10)));
    }

    #[test]
    fn an_unterminated_last_line_is_marked_and_an_endless_one_rejected() {
        let mut lines = Lines::new(&b"a\r\nbc"[..]);
        let first = lines.next().unwrap().unwrap();
        assert_eq!((first.bytes, first.whole), (&b"a"[..], true));
        let second = lines.next().unwrap().unwrap();
        assert_eq!((second.bytes, second.whole), (&b"bc"[..], false));
        assert!(lines.next().unwrap().is_none());
        let endless = std::io::repeat(b'x');
        let refused = Lines::new(std::io::BufReader::new(endless))
            .next()
            .unwrap_err();
        assert_eq!(refused.at, Some((1, 1)));
    }
}
