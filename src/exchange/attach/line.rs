//! Reads lines from an untrusted stream: line length is bounded, and invalid lines are reported.

use std::io::{self, BufRead, Read};

/// Result of reading a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Line {
    /// A whole line, without its line end.
    Text(String),
    /// A line that is not UTF-8: its beginning, with placeholders for invalid bytes.
    NoText(String),
    /// A line longer than the limit: its beginning.
    TooLong(String),
    /// The stream ended in the middle of a line.
    Torn(String),
    /// The stream ended.
    End,
}

/// Number of characters shown of a rejected line.
const SHOWN: usize = 80;

/// Reads a stream line by line.
#[derive(Debug)]
pub struct LineReader<R> {
    stream: R,
    most: usize,
}

impl<R: BufRead> LineReader<R> {
    /// Limits lines to `most` bytes.
    pub fn new(stream: R, most: usize) -> Self {
        LineReader { stream, most }
    }

    /// Waits for the next line. After [`Line::TooLong`] the rest of the stream is unusable.
    ///
    /// # Errors
    /// If the stream cannot be read.
    pub fn next_line(&mut self) -> io::Result<Line> {
        let mut bytes = Vec::new();
        let bound = self.most as u64 + 1;
        self.stream
            .by_ref()
            .take(bound)
            .read_until(b'\n', &mut bytes)?;
        Ok(match bytes.pop() {
            None => Line::End,
            Some(b'\n') => match String::from_utf8(bytes) {
                Ok(text) => Line::Text(text),
                Err(error) => Line::NoText(beginning(error.as_bytes())),
            },
            Some(last) => {
                bytes.push(last);
                let begun = beginning(&bytes);
                if bytes.len() > self.most {
                    Line::TooLong(begun)
                } else {
                    Line::Torn(begun)
                }
            }
        })
    }
}

/// The first characters of a line, up to any invalid bytes.
pub fn beginning(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * SHOWN)]);
    let mut begun: String = text.chars().take(SHOWN).collect();
    if text.chars().count() > SHOWN {
        begun.push('…');
    }
    begun
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8], most: usize) -> Vec<Line> {
        let mut lines = LineReader::new(bytes, most);
        let mut found = Vec::new();
        loop {
            let line = lines.next_line().expect("memory can be read");
            let ends = matches!(line, Line::End | Line::TooLong(_) | Line::Torn(_));
            found.push(line);
            if ends {
                return found;
            }
        }
    }

    #[test]
    fn a_stream_is_split_at_line_feeds() {
        let text = |s: &str| Line::Text(s.into());
        assert_eq!(
            all(b"a\n\nb\n", 9),
            [text("a"), text(""), text("b"), Line::End]
        );
        assert_eq!(all(b"a\nb", 9), [text("a"), Line::Torn("b".into())]);
        assert_eq!(all(b"\xff\n", 9)[0], Line::NoText("\u{fffd}".into()));
    }

    #[test]
    fn lines_longer_than_the_limit_are_rejected() {
        assert_eq!(all(b"1234\n", 4)[0], Line::Text("1234".into()));
        assert_eq!(all(b"12345\n", 4), [Line::TooLong("12345".into())]);
        assert_eq!(all(b"12345678", 4), [Line::TooLong("12345".into())]);
    }
}
