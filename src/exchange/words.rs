//! Words of a text apart by blanks, with their places.

use crate::broken::Broken;

/// Most characters of a word that a message shows.
const SHOWN: usize = 40;

/// The words of a text that are not read yet.
pub struct Words<'t> {
    whole: &'t str,
    rest: &'t str,
    /// Byte at which the last word begins.
    last: usize,
}

impl<'t> Words<'t> {
    /// All words of a text.
    pub fn new(text: &'t str) -> Self {
        Words {
            whole: text,
            rest: text,
            last: 0,
        }
    }

    /// Something wrong with the last word.
    pub fn broken(&self, message: impl Into<String>) -> Broken {
        let (line, column) = self.place();
        Broken::at(line, column, message)
    }

    /// Line and column of the last word, both from 1.
    pub fn place(&self) -> (usize, usize) {
        place(self.whole, self.last)
    }

    /// The last word is not what is wanted.
    pub fn unlike(&self, word: &str, wanted: &str) -> Broken {
        self.broken(format!("{} stands where {wanted} should", quoted(word)))
    }

    /// The next word; none at the end.
    pub fn peek(&self) -> Option<&'t str> {
        self.rest.split_whitespace().next()
    }

    /// The words that are left, unread.
    pub fn left(&self) -> impl Iterator<Item = &'t str> + use<'t> {
        self.rest.split_whitespace()
    }

    /// The next word.
    ///
    /// # Errors
    /// At the end of the text; `what` says what should stand there.
    pub fn next(&mut self, what: &str) -> Result<&'t str, Broken> {
        let trimmed = self.rest.trim_start();
        let end = trimmed.find(char::is_whitespace).unwrap_or(trimmed.len());
        if end == 0 {
            return Err(self.broken(format!("the file ends where {what} should stand")));
        }
        self.last = self.whole.len() - trimmed.len();
        self.rest = &trimmed[end..];
        Ok(&trimmed[..end])
    }

    /// What is left of the line of the last word.
    pub fn line(&mut self) -> &'t str {
        let end = self.rest.find('\n').unwrap_or(self.rest.len());
        let line = &self.rest[..end];
        self.rest = &self.rest[end..];
        line
    }

    /// The next word as a whole number.
    ///
    /// # Errors
    /// If it is none.
    pub fn count(&mut self, what: &str) -> Result<usize, Broken> {
        let word = self.next(what)?;
        word.parse()
            .map_err(|_| self.unlike(word, &format!("{what}, a whole number,")))
    }

    /// The same, at most so large.
    ///
    /// # Errors
    /// If it is none, or larger.
    pub fn count_up_to(&mut self, most: usize, what: &str) -> Result<usize, Broken> {
        match self.count(what)? {
            count if count <= most => Ok(count),
            count => Err(self.broken(format!("{what} is {count}; it must be at most {most}"))),
        }
    }

    /// Reads a whole number that can only be one.
    ///
    /// # Errors
    /// If it is another.
    pub fn exactly(&mut self, wanted: usize, what: &str) -> Result<(), Broken> {
        match self.count(what)? {
            count if count == wanted => Ok(()),
            count => Err(self.broken(format!("{what} is {count}; it must be {wanted}"))),
        }
    }

    /// The next word as a finite number.
    ///
    /// # Errors
    /// If it is none.
    pub fn number(&mut self, what: &str) -> Result<f64, Broken> {
        let word = self.next(what)?;
        number(word).ok_or_else(|| self.unlike(word, &format!("{what}, a finite number,")))
    }

    /// So many of them.
    ///
    /// # Errors
    /// If one is none.
    pub fn numbers(&mut self, count: usize, what: &str) -> Result<Vec<f64>, Broken> {
        (0..count).map(|_| self.number(what)).collect()
    }

    /// Coefficients of friction, none of them negative.
    ///
    /// # Errors
    /// If one is no number, or negative.
    pub fn coefficients(&mut self, count: usize) -> Result<Vec<f64>, Broken> {
        let coefficient = |_| {
            let value = self.number("a friction coefficient")?;
            match value < 0.0 {
                true => Err(self.broken(format!(
                    "the friction coefficient is {value:?}; it must not be negative"
                ))),
                false => Ok(value),
            }
        };
        (0..count).map(coefficient).collect()
    }
}

/// A finite number; Fortran's `1.0D+00` is one, too.
pub fn number(word: &str) -> Option<f64> {
    let value = match word.parse() {
        Ok(value) => value,
        Err(_) => word.replace(['d', 'D'], "e").parse::<f64>().ok()?,
    };
    value.is_finite().then_some(value)
}

/// A word in quotes, cut where it is long; what a terminal would obey is escaped.
pub fn quoted(word: &str) -> String {
    match word.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{:?}…", &word[..end]),
        None => format!("{word:?}"),
    }
}

/// Line and column of a byte, both from 1, the column in characters.
pub fn place(text: &str, byte: usize) -> (usize, usize) {
    let before = &text[..byte];
    let start = before.rfind('\n').map_or(0, |k| k + 1);
    let line = 1 + before.bytes().filter(|&b| b == b'\n').count();
    (line, 1 + before[start..].chars().count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_counted_in_characters() {
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
    fn numbers_of_fortran_are_read_and_no_infinities() {
        assert_eq!(number("1.5D+02"), Some(150.0));
        for wrong in ["inf", "NaN", "1e999", "ded", ""] {
            assert_eq!(number(wrong), None, "{wrong}");
        }
    }
}
