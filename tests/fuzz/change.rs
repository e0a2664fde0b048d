//! Random changes of texts, in their structure: words, numbers, texts in quotes, and what stands between brackets.

use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use std::ops::Range;

/// Changed texts of a corpus, the same for the same seed.
pub struct Change<'a> {
    random: Pcg64,
    corpus: &'a [String],
    /// The corpus in pieces.
    pieces: Vec<Vec<&'a str>>,
}

/// Numbers at which something may break.
const NUMBERS: [&str; 24] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "0.5",
    "1e-9",
    "1e-300",
    "5e-324",
    "1e9",
    "1e300",
    "-1e300",
    "1.7976931348623157e308",
    "NaN",
    "inf",
    "-inf",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "18446744073709551616",
    "-9223372036854775808",
    "999999999999",
    "1e",
    "0x10",
];

/// Words that mean something, or harm a terminal.
const WORDS: [&str; 22] = [
    "None",
    "Some(",
    "true",
    "free",
    "sliding",
    "fixed",
    "\"\"",
    "()",
    "[]",
    "(())",
    "r#\"",
    "/*",
    "//",
    "'",
    "\\",
    "@",
    "\u{1b}]0;x\u{7}",
    "\u{202e}",
    "\u{9b}31m",
    "\u{feff}",
    "\u{0}",
    "é日",
];

impl<'a> Change<'a> {
    pub fn new(seed: u64, corpus: &'a [String]) -> Self {
        Change {
            random: Pcg64::new(u128::from(seed), 7),
            corpus,
            pieces: corpus.iter().map(|text| pieces(text)).collect(),
        }
    }

    /// A whole number below another one.
    fn below(&mut self, count: usize) -> usize {
        (self.random.next_u64() % count.max(1) as u64) as usize
    }

    /// The next text.
    pub fn next(&mut self) -> String {
        let which = self.below(self.corpus.len());
        let mut text: Vec<&str> = self.pieces[which].clone();
        for _ in 0..1 + self.below(4) {
            if text.is_empty() {
                break;
            }
            self.change(&mut text);
        }
        let mut text = text.concat();
        if self.below(12) == 0 {
            self.cut(&mut text);
        }
        text
    }

    fn change(&mut self, text: &mut Vec<&'a str>) {
        let at = self.below(text.len());
        match self.below(13) {
            0 => drop(text.remove(at)),
            1 => text.insert(at, text[at]),
            2 => {
                let other = self.below(text.len());
                text.swap(at, other);
            }
            3..=5 => {
                // A number, if there is one from here on.
                let is_number = |piece: &&str| piece.starts_with(|c: char| c.is_ascii_digit());
                let at = text[at..].iter().position(is_number).map_or(at, |k| at + k);
                text[at] = NUMBERS[self.below(NUMBERS.len())];
            }
            6 => text[at] = WORDS[self.below(WORDS.len())],
            7 => text.insert(at, WORDS[self.below(WORDS.len())]),
            8 => {
                let own = self.below(self.pieces.len());
                let place = self.below(self.pieces[own].len());
                text[at] = self.pieces[own][place];
            }
            9 => drop(text.drain(group(text, at))),
            10 => {
                let times = [1, 2, 3, 40][self.below(4)];
                let range = group(text, at);
                let copy = text[range.clone()].repeat(times);
                // Not ever larger ones.
                if copy.len() < 20_000 {
                    text.splice(range.end..range.end, copy);
                }
            }
            11 => {
                let own = self.below(self.pieces.len());
                let place = self.below(self.pieces[own].len());
                let other = self.pieces[own][group(&self.pieces[own], place)].to_vec();
                let range = group(text, at);
                text.splice(range, other);
            }
            _ => {
                let line = line(text, at);
                let to = self.below(text.len() - line.len() + 1);
                let moved: Vec<&str> = text.drain(line).collect();
                text.splice(to..to, moved);
            }
        }
    }

    /// Cuts the end off, or puts a character in.
    fn cut(&mut self, text: &mut String) {
        let mut at = self.below(text.len() + 1);
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        match self.below(2) {
            0 => text.truncate(at),
            _ => text.insert(at, char::from((self.below(127) + 1) as u8)),
        }
    }
}

/// Words, numbers, texts in quotes, blanks, and single characters.
fn pieces(text: &str) -> Vec<&str> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let run = |is: fn(char) -> bool| rest.find(|c| !is(c)).unwrap_or(rest.len());
        let length = match first {
            '"' => rest[1..].find('"').map_or(rest.len(), |k| k + 2),
            c if is_letter(c) => run(is_letter),
            c if c.is_whitespace() => run(char::is_whitespace),
            c => c.len_utf8(),
        };
        pieces.push(&rest[..length]);
        rest = &rest[length..];
    }
    pieces
}

fn is_letter(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '+')
}

/// The pieces from an opening bracket to its closing one, where one stands here or before; else this piece alone.
fn group(text: &[&str], at: usize) -> Range<usize> {
    let opens = |piece: &&str| matches!(*piece, "(" | "[" | "{");
    let closes = |piece: &&str| matches!(*piece, ")" | "]" | "}");
    let Some(start) = text[..=at].iter().rposition(&opens) else {
        return at..at + 1;
    };
    let mut depth = 0;
    for (k, piece) in text[start..].iter().enumerate() {
        depth += i32::from(opens(piece)) - i32::from(closes(piece));
        if depth == 0 {
            return start..start + k + 1;
        }
    }
    at..at + 1
}

/// The pieces of the line that this one stands in.
fn line(text: &[&str], at: usize) -> Range<usize> {
    let ends = |piece: &&str| piece.contains('\n');
    let start = text[..at].iter().rposition(ends).map_or(0, |k| k + 1);
    let end = text[at..]
        .iter()
        .position(ends)
        .map_or(text.len(), |k| at + k + 1);
    start..end
}
