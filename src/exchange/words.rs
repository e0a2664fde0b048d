//! Splits a text into words and tracks their positions.

use crate::FormatError;
use crate::bail;

/// Maximum number of characters of a word in a message.
const SHOWN: usize = 60;

/// The unread words of a text.
pub struct Words<'t> {
    whole: &'t str,
    rest: &'t str,
    /// First byte of the last word read.
    last: usize,
}

impl<'t> Words<'t> {
    /// Starts at the beginning of a text.
    pub fn new(text: &'t str) -> Self {
        Words {
            whole: text,
            rest: text,
            last: 0,
        }
    }

    /// An error at the last word.
    pub fn broken(&self, message: impl Into<String>) -> FormatError {
        let (line, column) = self.place();
        FormatError::at(line, column, message)
    }

    /// Line and column of the last word, both from 1.
    pub fn place(&self) -> (usize, usize) {
        place(self.whole, self.last)
    }

    /// Error: the last word is not what was expected.
    pub fn unlike(&self, word: &str, wanted: &str) -> FormatError {
        self.broken(format!(
            "found {} where {wanted} was expected",
            quoted(word)
        ))
    }

    /// The next word without consuming it; `None` at the end.
    pub fn peek(&self) -> Option<&'t str> {
        self.rest.split_whitespace().next()
    }

    /// The remaining words, without consuming them.
    pub fn left(&self) -> impl Iterator<Item = &'t str> + use<'t> {
        self.rest.split_whitespace()
    }

    /// The next word.
    ///
    /// # Errors
    /// At the end of the text; `what` names the missing item.
    pub fn next(&mut self, what: &str) -> Result<&'t str, FormatError> {
        let trimmed = self.rest.trim_start();
        let end = trimmed.find(char::is_whitespace).unwrap_or(trimmed.len());
        if end == 0 {
            bail!(self.place(), "the file ends where {what} was expected");
        }
        self.last = self.whole.len() - trimmed.len();
        self.rest = &trimmed[end..];
        Ok(&trimmed[..end])
    }

    /// The rest of the last word's line.
    pub fn line(&mut self) -> &'t str {
        let end = self.rest.find('\n').unwrap_or(self.rest.len());
        let line = &self.rest[..end];
        self.rest = &self.rest[end..];
        line
    }

    /// The next word as a whole number.
    ///
    /// # Errors
    /// If it is not a whole number.
    pub fn count(&mut self, what: &str) -> Result<usize, FormatError> {
        let word = self.next(what)?;
        word.parse()
            .map_err(|_| self.unlike(word, &format!("{what}, a whole number,")))
    }

    /// The next word as a whole number of at most `most`.
    ///
    /// # Errors
    /// If it is not a whole number, or larger.
    pub fn count_up_to(&mut self, most: usize, what: &str) -> Result<usize, FormatError> {
        match self.count(what)? {
            count if count <= most => Ok(count),
            count => Err(self.broken(format!("{what} is {count}; it must be at most {most}"))),
        }
    }

    /// Reads a whole number that must have a given value.
    ///
    /// # Errors
    /// If it has another value.
    pub fn exactly(&mut self, wanted: usize, what: &str) -> Result<(), FormatError> {
        match self.count(what)? {
            count if count == wanted => Ok(()),
            count => Err(self.broken(format!("{what} is {count}; it must be {wanted}"))),
        }
    }

    /// The next word as a finite number.
    ///
    /// # Errors
    /// If it is not a finite number.
    pub fn number(&mut self, what: &str) -> Result<f64, FormatError> {
        let word = self.next(what)?;
        number(word).ok_or_else(|| self.unlike(word, &format!("{what}, a finite number,")))
    }

    /// Reads several finite numbers.
    ///
    /// # Errors
    /// If one of them is not a finite number.
    pub fn numbers(&mut self, count: usize, what: &str) -> Result<Vec<f64>, FormatError> {
        (0..count).map(|_| self.number(what)).collect()
    }

    /// Reads coefficients of friction, which must not be negative.
    ///
    /// # Errors
    /// If one of them is not a number, or negative.
    pub fn coefficients(&mut self, count: usize) -> Result<Vec<f64>, FormatError> {
        let coefficient = |_| {
            let value = self.number("a friction coefficient")?;
            if value < 0.0 {
                Err(self.broken(format!(
                    "the friction coefficient is {value:?}; it must not be negative"
                )))
            } else {
                Ok(value)
            }
        };
        (0..count).map(coefficient).collect()
    }
}

/// A finite number; Fortran's `1.0D+00` is accepted too.
pub fn number(word: &str) -> Option<f64> {
    let value = match word.parse() {
        Ok(value) => value,
        Err(_) => word.replace(['d', 'D'], "e").parse::<f64>().ok()?,
    };
    value.is_finite().then_some(value)
}

/// A word in quotes, shortened, with terminal control characters escaped.
pub fn quoted(word: &str) -> String {
    match word.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{:?}…", &word[..end]),
        None => format!("{word:?}"),
    }
}

/// Line and column of a byte, both from 1; columns count characters.
pub fn place(text: &str, byte: usize) -> (usize, usize) {
    let mut byte = byte.min(text.len());
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    let before = &text[..byte];
    let line = 1 + before.matches('\n').count();
    let start = before.rfind('\n').map_or(0, |k| k + 1);
    (line, 1 + before[start..].chars().count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_characters() {
        let text = "ä 1\n  ü x\n";
        let mut words = Words::new(text);
        assert_eq!(words.next("a").unwrap(), "ä");
        assert_eq!(words.number("b").unwrap(), 1.0);
        assert_eq!(words.next("c").unwrap(), "ü");
        let broken = words.number("d").unwrap_err();
        assert_eq!(broken.at, Some((2, 5)));
        assert!(
            words
                .next("e")
                .unwrap_err()
                .message
                .contains("ends where e")
        );
    }

    #[test]
    fn fortran_numbers_are_read_and_infinities_rejected() {
        assert_eq!(number("1.5D+02"), Some(150.0));
        for wrong in ["inf", "NaN", "1e999", "ded", ""] {
            assert_eq!(number(wrong), None, "{wrong}");
        }
    }
}
