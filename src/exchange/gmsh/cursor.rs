//! A walk through a file whose numbers are words or bytes, as its head says.

use crate::broken::Broken;

/// How the numbers of a file are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    Text,
    /// Bytes, the greatest first if `big`.
    Binary {
        big: bool,
    },
}

pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    next: usize,
    /// Where the last thing that was read begins.
    last: usize,
    pub form: Form,
}

impl<'a> Cursor<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Cursor {
            bytes,
            next: 0,
            last: 0,
            form: Form::Text,
        }
    }

    /// Where the last thing that was read begins.
    pub fn last(&self) -> usize {
        self.last
    }

    /// Something wrong at a byte: told by line and column in a text.
    pub fn fault(&self, byte: usize, message: impl Into<String>) -> Broken {
        let message = message.into();
        if self.form != Form::Text {
            return Broken::whole(format!("byte {byte}: {message}"));
        }
        let before = &self.bytes[..byte.min(self.bytes.len())];
        let line = before
            .iter()
            .rposition(|&b| b == b'\n')
            .map_or(0, |k| k + 1);
        let column = 1 + String::from_utf8_lossy(&before[line..]).chars().count();
        Broken::at(
            1 + before.iter().filter(|&&b| b == b'\n').count(),
            column,
            message,
        )
    }

    /// Something wrong with what was read last.
    pub fn wrong(&self, message: impl Into<String>) -> Broken {
        self.fault(self.last, message)
    }

    /// The next word, up to a blank or the end of a line; `None` at the end of the file.
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

    /// The rest of the line, its end included.
    pub fn line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.next..];
        let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.last = self.next;
        self.next = (self.next + end + 1).min(self.bytes.len());
        &rest[..end]
    }

    /// Goes behind the next place where these bytes stand; whether there is one.
    pub fn skip_to(&mut self, mark: &[u8]) -> bool {
        let rest = &self.bytes[self.next..];
        let Some(found) = rest.windows(mark.len()).position(|window| window == mark) else {
            return false;
        };
        self.next += found + mark.len();
        true
    }

    /// A count or a tag.
    pub fn size(&mut self, what: &str) -> Result<u64, Broken> {
        match self.form {
            Form::Text => self.parsed(what, "a whole number that is not negative"),
            Form::Binary { big } => {
                let bytes = self.take(what)?;
                Ok(if big {
                    u64::from_be_bytes(bytes)
                } else {
                    u64::from_le_bytes(bytes)
                })
            }
        }
    }

    /// A number of 32 bits, of either sign.
    pub fn int(&mut self, what: &str) -> Result<i64, Broken> {
        match self.form {
            Form::Text => self.parsed(what, "a whole number"),
            Form::Binary { big } => {
                let bytes = self.take(what)?;
                let value = if big {
                    i32::from_be_bytes(bytes)
                } else {
                    i32::from_le_bytes(bytes)
                };
                Ok(value.into())
            }
        }
    }

    /// A coordinate: a finite number.
    pub fn float(&mut self, what: &str) -> Result<f64, Broken> {
        let value = match self.form {
            Form::Text => self.parsed(what, "a number")?,
            Form::Binary { big } => {
                let bytes = self.take(what)?;
                if big {
                    f64::from_be_bytes(bytes)
                } else {
                    f64::from_le_bytes(bytes)
                }
            }
        };
        if f64::is_finite(value) {
            return Ok(value);
        }
        Err(self.wrong(format!("{what} is {value}; it must be a finite number")))
    }

    /// A number that is a word in binary files, too.
    pub fn number<T: std::str::FromStr>(&mut self, what: &str, kind: &str) -> Result<T, Broken> {
        self.parsed(what, kind)
    }

    /// How many of something that takes at least so many numbers each: no more than the rest of the file can hold.
    pub fn count(&self, count: u64, numbers: usize, what: &str) -> Result<usize, Broken> {
        let least = match self.form {
            // A digit and a blank.
            Form::Text => 2,
            Form::Binary { .. } => 4,
        };
        // The last one of a text may end the file.
        let room = (self.bytes.len() + 1 - self.next) / (least * numbers.max(1));
        match usize::try_from(count) {
            Ok(count) if count <= room => Ok(count),
            _ => Err(self.wrong(format!(
                "{count} {what} are announced, and the file ends before that many"
            ))),
        }
    }

    fn parsed<T: std::str::FromStr>(&mut self, what: &str, kind: &str) -> Result<T, Broken> {
        let Some(word) = self.word() else {
            return Err(self.fault(
                self.bytes.len(),
                format!("the file ends where {what} should stand"),
            ));
        };
        let text = std::str::from_utf8(word).ok();
        text.and_then(|text| text.parse().ok()).ok_or_else(|| {
            let shown: String = String::from_utf8_lossy(word).chars().take(40).collect();
            self.wrong(format!(
                "{shown:?} stands where {what} should; it must be {kind}"
            ))
        })
    }

    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Broken> {
        self.last = self.next;
        let found = self.bytes[self.next..].first_chunk::<N>();
        let found =
            found.ok_or_else(|| self.wrong(format!("the file ends where {what} should stand")))?;
        self.next += N;
        Ok(*found)
    }
}
