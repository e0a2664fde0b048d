//! Cards: a keyword with its parameters, and the data lines after it.
//!
//! ```text
//! ** a comment
//! *NODE PRINT, NSET=TOP, TOTALS=ONLY
//! U, RF
//! ```
//!
//! Case and spaces within words do not matter, as in CalculiX. Parameters continue on the next line after a trailing comma.

use super::source::{DeckLocation, Done, Fault, SourceLine, plain};
use crate::bail;

/// A keyword with its parameters and data.
#[derive(Debug)]
pub(super) struct Card<'t> {
    /// Uppercase, without the star and without spaces.
    pub key: String,
    /// As written, without the star.
    pub shown: String,
    pub place: DeckLocation,
    parameters: Vec<Parameter>,
    pub lines: Vec<SourceLine<'t>>,
}

#[derive(Debug, Clone)]
pub(super) struct Parameter {
    /// Uppercase, without spaces.
    pub name: String,
    /// Uppercase, without spaces and quotes.
    pub value: Option<String>,
    pub place: DeckLocation,
}

/// All parameters are supported.
pub(super) const ANY: &[&str] = &["*"];

/// A word of a data line.
#[derive(Debug, Clone, Copy)]
pub(super) struct CardCell<'t> {
    pub text: &'t str,
    line: SourceLine<'t>,
    byte: usize,
}

/// The cards of a deck.
pub(super) fn cards<'t>(lines: impl Iterator<Item = SourceLine<'t>>) -> Done<Vec<Card<'t>>> {
    let mut cards: Vec<Card<'t>> = Vec::new();
    let mut open = false;
    for line in lines {
        if line.is_nothing() {
            continue;
        }
        match cards.last_mut() {
            _ if line.is_keyword() => {
                let (card, goes_on) = Card::begin(line)?;
                cards.push(card);
                open = goes_on;
            }
            Some(card) if open => {
                let parameters;
                (parameters, open) = parameters_of(line, 0)?;
                card.parameters.extend(parameters);
            }
            Some(card) => card.lines.push(line),
            None => {
                bail!(
                    line.place(0),
                    "data before the first keyword; a deck begins with a keyword, e.g. *HEADING or *NODE"
                );
            }
        }
    }
    Ok(cards)
}

impl<'t> Card<'t> {
    /// A card without its data, and whether its parameters continue on the next line.
    fn begin(line: SourceLine<'t>) -> Done<(Card<'t>, bool)> {
        let star = line.text.find('*').unwrap_or(0);
        let end = line.text.find(',').unwrap_or(line.text.len());
        let word = line.text.get(star + 1..end).unwrap_or_default().trim();
        let key = plain(word);
        let place = line.place(star);
        if key.is_empty() {
            bail!(
                place,
                "the star must be followed by a keyword; comments start with two stars"
            );
        }
        let (parameters, open) = if end < line.text.len() {
            parameters_of(line, end + 1)?
        } else {
            (Vec::new(), false)
        };
        let card = Card {
            shown: short(&word.to_uppercase()),
            key,
            place,
            parameters,
            lines: Vec::new(),
        };
        Ok((card, open))
    }

    /// An error about the card.
    pub fn wrong(&self, message: impl std::fmt::Display) -> Fault {
        Fault::new(self.place, format!("*{}: {message}", self.shown))
    }

    /// An error about a parameter.
    pub fn wrong_at(&self, name: &str, message: impl std::fmt::Display) -> Fault {
        Fault::new(self.place_of(name), format!("*{}: {message}", self.shown))
    }

    /// Rejects parameters other than these.
    pub fn only(&self, known: &[&str]) -> Done {
        let is_known = |name: &str| known == ANY || known.contains(&name);
        let Some(other) = self.parameters.iter().find(|own| !is_known(&own.name)) else {
            return Ok(());
        };
        let list = match known {
            [] => "it has no supported parameters".to_owned(),
            _ => format!("supported are {}", known.join(", ")),
        };
        let what = format!(
            "the parameter {} is not supported; {list}",
            short(&other.name)
        );
        Err(self.wrong_at(&other.name, what))
    }

    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|p| p.name == plain(name))
    }

    pub fn has(&self, name: &str) -> bool {
        self.parameter(name).is_some()
    }

    /// The value of a parameter, if present.
    pub fn value(&self, name: &str) -> Done<Option<&str>> {
        let Some(parameter) = self.parameter(name) else {
            return Ok(None);
        };
        match parameter.value.as_deref() {
            Some(value) if !value.is_empty() => Ok(Some(value)),
            _ => Err(self.wrong_at(name, format!("{name} has no value; it must be {name}=..."))),
        }
    }

    pub fn required(&self, name: &str) -> Done<&str> {
        self.value(name)?
            .ok_or_else(|| self.wrong(format!("the parameter {name}=... is missing")))
    }

    /// The index of a parameter's value in a list of words; 0 if the parameter is missing.
    pub fn choice(&self, name: &str, words: &[&str]) -> Done<usize> {
        let Some(value) = self.value(name)? else {
            return Ok(0);
        };
        let found = words.iter().position(|word| plain(word) == value);
        found.ok_or_else(|| self.unlike(name, value, &words.join(" or ")))
    }

    /// A length given by a parameter; `kind` describes it in messages.
    pub fn length(&self, name: &str, kind: &str) -> Done<Option<f64>> {
        let Some(value) = self.value(name)? else {
            return Ok(None);
        };
        match value.parse::<f64>() {
            Ok(length) if length.is_finite() && length >= 0.0 => Ok(Some(length)),
            _ => Err(self.unlike(name, value, kind)),
        }
    }

    fn unlike(&self, name: &str, value: &str, kind: &str) -> Fault {
        let value = short(value);
        self.wrong_at(
            name,
            format!("{name}={value} is not supported; it must be {kind}"),
        )
    }

    /// Location of a parameter.
    pub fn place_of(&self, name: &str) -> DeckLocation {
        self.parameter(name).map_or(self.place, |p| p.place)
    }

    /// The only data line.
    pub fn one_line(&self, what: &str) -> Done<Vec<CardCell<'t>>> {
        match self.lines.as_slice() {
            [line] => Ok(cells(*line)),
            [] => bail!(self, "a line with {what} is missing"),
            [_, more, ..] => bail!(
                more,
                "*{}: unexpected second data line; only one with {what} is allowed",
                self.shown
            ),
        }
    }

    /// Rejects data lines.
    pub fn no_lines(&self) -> Done {
        match self.lines.first() {
            None => Ok(()),
            Some(line) => bail!(line, "*{} has no data; a keyword was expected", self.shown),
        }
    }

    /// The words of all lines.
    pub fn cells(&self) -> impl Iterator<Item = CardCell<'t>> {
        self.lines.iter().flat_map(|line| cells(*line))
    }
}

fn parameters_of(line: SourceLine<'_>, from: usize) -> Done<(Vec<Parameter>, bool)> {
    let mut parameters = Vec::new();
    let mut open = true;
    let mut byte = from;
    for part in line.text.get(from..).unwrap_or_default().split(',') {
        let blanks = part.len() - part.trim_start().len();
        let place = line.place(byte + blanks);
        byte += part.len() + 1;
        open = part.trim().is_empty();
        if open {
            continue;
        }
        let (name, value) = match part.split_once('=') {
            Some((name, value)) => (name, Some(plain(value))),
            None => (part, None),
        };
        let name = plain(name);
        if name.is_empty() {
            bail!(place, "a parameter has no name before its \"=\"");
        }
        parameters.push(Parameter { name, value, place });
    }
    Ok((parameters, open))
}

/// The words of a line; text after the last comma counts only if it is not empty.
pub(super) fn cells(line: SourceLine<'_>) -> Vec<CardCell<'_>> {
    let mut found = Vec::new();
    let mut byte = 0;
    for part in line.text.split(',') {
        let blanks = part.len() - part.trim_start().len();
        found.push(CardCell {
            text: part.trim(),
            line,
            byte: byte + blanks,
        });
        byte += part.len() + 1;
    }
    if found.last().is_some_and(|cell| cell.text.is_empty()) {
        found.pop();
    }
    found
}

impl CardCell<'_> {
    pub fn place(&self) -> DeckLocation {
        self.line.place(self.byte)
    }

    pub fn wrong(&self, message: impl Into<String>) -> Fault {
        Fault::new(self.place(), message)
    }

    /// A number; Fortran exponents with D are accepted too.
    pub fn number(&self, what: &str) -> Done<f64> {
        let read = self.text.parse().ok().or_else(|| {
            let fortran: String = self.text.replace(['d', 'D'], "e");
            fortran.parse().ok()
        });
        read.filter(|value: &f64| value.is_finite())
            .ok_or_else(|| self.unlike(what, "a number"))
    }

    /// A nonnegative whole number.
    pub fn whole(&self, what: &str) -> Done<u64> {
        self.text
            .parse()
            .map_err(|_| self.unlike(what, "a whole number"))
    }

    fn unlike(&self, what: &str, kind: &str) -> Fault {
        let found = short(self.text);
        self.wrong(format!(
            "found {found:?} where {what}, {kind}, was expected"
        ))
    }
}

impl From<(&CardCell<'_>, String)> for Fault {
    fn from((cell, message): (&CardCell<'_>, String)) -> Self {
        cell.wrong(message)
    }
}

impl From<(&SourceLine<'_>, String)> for Fault {
    fn from((line, message): (&SourceLine<'_>, String)) -> Self {
        Fault::new(line.place(0), message)
    }
}

impl From<(&Card<'_>, String)> for Fault {
    fn from((card, message): (&Card<'_>, String)) -> Self {
        card.wrong(message)
    }
}

/// The number at an index of a line; 0 if omitted.
pub(super) fn number_or_zero(cells: &[CardCell<'_>], at: usize, what: &str) -> Done<f64> {
    match cells.get(at).filter(|cell| !cell.text.is_empty()) {
        Some(cell) => cell.number(what),
        None => Ok(0.0),
    }
}

/// A word for a message.
pub(super) fn short(word: &str) -> String {
    const MOST: usize = 60;
    match word.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &word[..end]),
        None => word.to_owned(),
    }
}
