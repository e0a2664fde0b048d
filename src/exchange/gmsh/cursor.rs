//! A cursor in a file whose numbers are text or binary, as its header states.

use crate::FormatError;
use crate::words::place;

/// Number format of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CursorForm {
    Text,
    /// Binary, big-endian if `big`.
    Binary {
        big: bool,
    },
}

pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    next: usize,
    /// Start of the last item read.
    last: usize,
    pub form: CursorForm,
}

impl<'a> Cursor<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Cursor {
            bytes,
            next: 0,
            last: 0,
            form: CursorForm::Text,
        }
    }

    /// Start of the last item read.
    pub fn last(&self) -> usize {
        self.last
    }

    /// An error at a byte; in a text file with line and column.
    pub fn fault(&self, byte: usize, message: impl Into<String>) -> FormatError {
        let message = message.into();
        if self.form != CursorForm::Text {
            return FormatError::whole(format!("byte {byte}: {message}"));
        }
        let before = String::from_utf8_lossy(&self.bytes[..byte.min(self.bytes.len())]);
        let (line, column) = place(&before, before.len());
        FormatError::at(line, column, message)
    }

    /// An error in the last item read.
    pub fn wrong(&self, message: impl Into<String>) -> FormatError {
        self.fault(self.last, message)
    }

    /// The next word, up to white space; `None` at the end of the file.
    pub fn word(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.next..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let rest = &rest[start..];
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let word = &rest[..end.unwrap_or(rest.len())];
        self.last = self.next + start;
        self.next = self.last + word.len();
        Some(word)
    }

    /// The rest of the line, including its end.
    pub fn line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.next..];
        let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.last = self.next;
        self.next = (self.next + end + 1).min(self.bytes.len());
        &rest[..end]
    }

    /// Moves past the next occurrence of these bytes; returns whether there is one.
    pub fn skip_to(&mut self, mark: &[u8]) -> bool {
        let rest = &self.bytes[self.next..];
        let Some(found) = rest.windows(mark.len()).position(|window| window == mark) else {
            return false;
        };
        self.next += found + mark.len();
        true
    }

    /// A count or a tag.
    pub fn size(&mut self, what: &str) -> Result<u64, FormatError> {
        match self.form {
            CursorForm::Text => self.number(what, "a nonnegative whole number"),
            CursorForm::Binary { big } => Ok(u64::from_le_bytes(self.take(big, what)?)),
        }
    }

    /// A signed 32-bit number.
    pub fn int(&mut self, what: &str) -> Result<i64, FormatError> {
        match self.form {
            CursorForm::Text => self.number(what, "a whole number"),
            CursorForm::Binary { big } => Ok(i32::from_le_bytes(self.take(big, what)?).into()),
        }
    }

    /// A finite coordinate.
    pub fn float(&mut self, what: &str) -> Result<f64, FormatError> {
        let value = match self.form {
            CursorForm::Text => self.number(what, "a number")?,
            CursorForm::Binary { big } => f64::from_le_bytes(self.take(big, what)?),
        };
        if f64::is_finite(value) {
            return Ok(value);
        }
        Err(self.wrong(format!("{what} is {value}; it must be a finite number")))
    }

    /// Checks a count of items with at least this many numbers each against the rest of the file.
    pub fn count(&self, count: u64, numbers: usize, what: &str) -> Result<usize, FormatError> {
        let least = match self.form {
            // One digit and a space.
            CursorForm::Text => 2,
            CursorForm::Binary { .. } => 4,
        };
        // The last number of a text need not be followed by a space.
        let room = (self.bytes.len() + 1 - self.next) / (least * numbers.max(1));
        match usize::try_from(count) {
            Ok(count) if count <= room => Ok(count),
            _ => Err(self.wrong(format!(
                "{count} {what} are declared, but the file ends before that"
            ))),
        }
    }

    /// A number that is text, possibly in a binary file.
    pub fn number<T: std::str::FromStr>(
        &mut self,
        what: &str,
        kind: &str,
    ) -> Result<T, FormatError> {
        let Some(word) = self.word() else {
            return Err(self.fault(
                self.bytes.len(),
                format!("the file ends where {what} was expected"),
            ));
        };
        let text = std::str::from_utf8(word).ok();
        text.and_then(|text| text.parse().ok()).ok_or_else(|| {
            let shown: String = String::from_utf8_lossy(word).chars().take(40).collect();
            self.wrong(format!(
                "found {shown:?} where {what} was expected; it must be {kind}"
            ))
        })
    }

    /// The bytes of a number, least significant first; in a `big` file they are stored in reverse.
    fn take<const N: usize>(&mut self, big: bool, what: &str) -> Result<[u8; N], FormatError> {
        self.last = self.next;
        let found = self.bytes[self.next..].first_chunk::<N>();
        let mut found =
            *found.ok_or_else(|| self.wrong(format!("the file ends where {what} was expected")))?;
        self.next += N;
        if big {
            found.reverse();
        }
        Ok(found)
    }
}
