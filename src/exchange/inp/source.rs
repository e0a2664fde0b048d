//! The lines of a deck with those of its include files, and their locations.

/// A location: file number ([`Deck::files`](super::Deck::files)), line and column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub struct DeckLocation {
    /// 0 is the deck itself.
    pub file: usize,
    /// From 1.
    pub line: usize,
    /// From 1, counted in characters.
    pub column: usize,
}

/// An error in a deck.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{}:{}: {message}", place.line, place.column)]
pub struct DeckError {
    /// Name of the file.
    pub file: String,
    /// Location.
    pub place: DeckLocation,
    /// What is wrong and what is expected.
    pub message: String,
}

/// A word as CalculiX compares it: uppercase, without spaces and quotes.
pub(super) fn plain(word: &str) -> String {
    word.chars()
        .filter(|c| !c.is_whitespace() && *c != '"')
        .flat_map(char::to_uppercase)
        .collect()
}

/// An error before its file name is known.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Location.
    pub place: DeckLocation,
    /// What is wrong and what is expected.
    pub message: String,
}

/// The result of reading a part of a deck.
pub(super) type Done<T = ()> = Result<T, Fault>;

impl Fault {
    /// An error from its parts.
    pub fn new(place: DeckLocation, message: impl Into<String>) -> Self {
        let message = message.into();
        Fault { place, message }
    }
}

impl From<(DeckLocation, String)> for Fault {
    fn from((place, message): (DeckLocation, String)) -> Self {
        Fault { place, message }
    }
}

/// The texts of a deck and its include files.
#[derive(Debug, Default)]
pub(super) struct Sources {
    pub names: Vec<String>,
    texts: Vec<String>,
    /// Line ranges in reading order: file, first line (from 0), and byte range.
    pieces: Vec<(usize, usize, std::ops::Range<usize>)>,
}

/// A line of a deck.
#[derive(Debug, Clone, Copy)]
pub(super) struct SourceLine<'t> {
    pub text: &'t str,
    pub file: usize,
    /// From 1.
    pub number: usize,
}

impl SourceLine<'_> {
    /// The location of a byte of the line.
    pub fn place(&self, byte: usize) -> DeckLocation {
        let before = self.text.get(..byte).unwrap_or(self.text);
        DeckLocation {
            file: self.file,
            line: self.number,
            column: before.chars().count() + 1,
        }
    }

    /// Whether it is a comment or blank.
    pub fn is_nothing(&self) -> bool {
        let text = self.text.trim_start();
        text.is_empty() || text.starts_with("**")
    }

    /// Whether it begins a card.
    pub fn is_keyword(&self) -> bool {
        self.text.trim_start().starts_with('*') && !self.is_nothing()
    }
}

/// Maximum depth of nested includes.
const DEEPEST: usize = 16;
/// Maximum number of inclusions.
const INCLUSIONS: usize = 1000;
/// Maximum size of a deck in bytes, including all inclusions.
pub const DECK_BYTES: usize = 512 << 20;

/// Returns the text of an include file, or the reason for a failure.
pub type Include<'a> = dyn FnMut(&str) -> Result<String, String> + 'a;

impl Sources {
    /// Collects a deck and its include files. On an error, returns what was read until then.
    pub fn gather(
        name: &str,
        text: &str,
        include: &mut Include<'_>,
    ) -> (Sources, Result<(), Fault>) {
        let mut sources = Sources {
            names: vec![name.to_owned()],
            texts: vec![text.to_owned()],
            pieces: Vec::new(),
        };
        let mut budget = Budget {
            bytes: text.len(),
            inclusions: 0,
        };
        let result = sources.walk(0, &mut vec![0], &mut budget, include);
        (sources, result)
    }

    fn walk(
        &mut self,
        file: usize,
        above: &mut Vec<usize>,
        budget: &mut Budget,
        include: &mut Include<'_>,
    ) -> Result<(), Fault> {
        let text = std::mem::take(&mut self.texts[file]);
        let found = inclusions(file, &text);
        let whole = text.len();
        self.texts[file] = text;
        let (mut first, mut begin) = (0, 0);
        for inclusion in found {
            self.pieces.push((file, first, begin..inclusion.begin));
            (first, begin) = (inclusion.line, inclusion.end);
            let wrong = |message: String| Fault::new(inclusion.place, message);
            let wanted = inclusion.file.map_err(|why| wrong(why.to_owned()))?;
            let inner = self
                .included(&wanted, above, budget, include)
                .map_err(wrong)?;
            above.push(inner);
            self.walk(inner, above, budget, include)?;
            above.pop();
        }
        self.pieces.push((file, first, begin..whole));
        Ok(())
    }

    /// Number of the file with this name; reads it on first use.
    fn included(
        &mut self,
        wanted: &str,
        above: &[usize],
        budget: &mut Budget,
        include: &mut Include<'_>,
    ) -> Result<usize, String> {
        let known = self.names.iter().position(|name| name == wanted);
        let inner = match known.filter(|&k| k > 0) {
            Some(inner) => inner,
            None => {
                let text = include(wanted)?;
                self.names.push(wanted.to_owned());
                self.texts.push(text);
                self.texts.len() - 1
            }
        };
        if above.contains(&inner) {
            return Err(format!("the file {wanted:?} includes itself"));
        }
        if above.len() > DEEPEST {
            return Err(format!("includes are nested more than {DEEPEST} deep"));
        }
        budget.inclusions += 1;
        budget.bytes += self.texts[inner].len();
        if budget.inclusions > INCLUSIONS || budget.bytes > DECK_BYTES {
            return Err(format!(
                "the deck with its include files is too large; at most {INCLUSIONS} inclusions and {} MB are supported",
                DECK_BYTES >> 20
            ));
        }
        Ok(inner)
    }

    /// All lines in reading order.
    pub fn lines(&self) -> impl Iterator<Item = SourceLine<'_>> {
        self.pieces.iter().flat_map(|(file, first, bytes)| {
            let text = self
                .texts
                .get(*file)
                .and_then(|text| text.get(bytes.clone()));
            text.unwrap_or_default()
                .lines()
                .enumerate()
                .map(move |(k, text)| SourceLine {
                    text,
                    file: *file,
                    number: first + k + 1,
                })
        })
    }
}

struct Budget {
    bytes: usize,
    inclusions: usize,
}

/// An `*INCLUDE` in a text.
struct Inclusion {
    /// First byte of its line.
    begin: usize,
    end: usize,
    /// Number of lines up to and including it.
    line: usize,
    place: DeckLocation,
    file: Result<String, &'static str>,
}

fn inclusions(file: usize, text: &str) -> Vec<Inclusion> {
    let mut found = Vec::new();
    let mut begin = 0;
    for (k, line) in text.split_inclusive('\n').enumerate() {
        let end = begin + line.len();
        let (keyword, rest) = line.split_once(',').unwrap_or((line, ""));
        if plain(keyword) == "*INCLUDE" {
            let whole = SourceLine {
                text: line,
                file,
                number: k + 1,
            };
            found.push(Inclusion {
                begin,
                end,
                line: k + 1,
                place: whole.place(line.len() - line.trim_start().len()),
                file: input(rest),
            });
        }
        begin = end;
    }
    found
}

/// The file named by the parameters of an include.
fn input(parameters: &str) -> Result<String, &'static str> {
    const RIGHT: &str =
        "*INCLUDE takes exactly one parameter, its file, as in \"*INCLUDE, INPUT=mesh.inp\"";
    let (name, value) = parameters.split_once('=').ok_or(RIGHT)?;
    let value = value.trim().trim_end_matches(',').trim().trim_matches('"');
    if name.trim().eq_ignore_ascii_case("input") && !value.is_empty() {
        Ok(value.to_owned())
    } else {
        Err(RIGHT)
    }
}
