//! Finds the position of a value in a RON text.
//!
//! ron reports the position of syntax and type errors, but not of valid values with a wrong meaning, such as an unknown name.
//! [`locate`] finds such a value again by walking the text along its path. Conversely, [`path_at`] finds the path at an error
//! position of ron, so that the deserializer need not track paths. Both assume that the text up to that position is valid RON; on
//! other text they return some position, but never fail.

use super::error::{Path, Step};
use std::ops::Range;
pub use stickslip_exchange::words::place as line_and_column;

/// Byte range of the value at a path, or of the innermost enclosing value that the text contains.
pub fn locate(text: &str, path: &Path) -> Range<usize> {
    let mut scan = Scan::new(text);
    scan.skip_attributes();
    let mut here = scan.at;
    for step in &path.0 {
        scan.at = here;
        match scan.enter(step) {
            Some(inner) => here = inner,
            None => break,
        }
    }
    scan.at = here;
    scan.skip_value();
    here..scan.end_of_value.max(here)
}

/// Byte offset of a line and column, both from 1.
pub fn byte_at(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text
        .split_inclusive('\n')
        .take(line.saturating_sub(1))
        .map(str::len)
        .sum();
    let within = text
        .get(start..)
        .unwrap_or("")
        .chars()
        .take(column.saturating_sub(1))
        .map(char::len_utf8);
    start + within.sum::<usize>()
}

/// Path of the innermost value at or just before a byte; field names are not values.
pub fn path_at(text: &str, byte: usize) -> Path {
    let mut scan = Scan::new(text);
    scan.skip_attributes();
    let mut path = Path::default();
    for _ in 0..DEEPEST {
        match scan.enter_at(byte) {
            Some(Some(step)) => path.0.push(step),
            Some(None) => {}
            None => break,
        }
    }
    path
}

/// The name before the first bracket, if there is one.
pub fn head(text: &str) -> Option<&str> {
    let mut scan = Scan::new(text);
    scan.skip_attributes();
    scan.word()
}

/// Maximum nesting depth of brackets; the files of this program use less than a fifth of it.
pub const DEEPEST: usize = 64;

/// Byte offset of the first bracket that is nested too deep. Recursive readers and position searches check this first.
pub fn too_deep(text: &str) -> Option<usize> {
    let mut scan = Scan::new(text);
    let mut depth = 0usize;
    while let Some(c) = scan.peek() {
        match c {
            '(' | '[' | '{' if depth == DEEPEST => return Some(scan.at),
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        match c {
            '\'' => scan.skip_char(),
            _ => match scan.starts_string() {
                Some((opening, raw)) => scan.skip_string(opening, raw),
                None if scan.word().is_some() => {}
                None => scan.bump(),
            },
        }
        scan.skip_blanks();
    }
    None
}

/// A cursor in the text.
struct Scan<'a> {
    text: &'a str,
    at: usize,
    /// End of the last skipped value, before the blanks and comments after it.
    end_of_value: usize,
}

impl<'a> Scan<'a> {
    fn new(text: &'a str) -> Self {
        let mut scan = Scan {
            text,
            at: 0,
            end_of_value: 0,
        };
        scan.skip_blanks();
        scan
    }

    fn rest(&self) -> &'a str {
        // Every move should end on a character boundary; if it does not, avoid a panic.
        self.text.get(self.at..).unwrap_or("")
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn bump(&mut self) {
        self.at += self.peek().map_or(0, char::len_utf8);
    }

    /// Moves past a literal if it is next.
    fn eat(&mut self, literal: &str) -> bool {
        let here = self.rest().starts_with(literal);
        if here {
            self.at += literal.len();
        }
        here
    }

    /// Moves past the next occurrence of a text, or to the end.
    fn past(&mut self, needle: &str) {
        self.at += self
            .rest()
            .find(needle)
            .map_or(self.rest().len(), |k| k + needle.len());
    }

    /// Skips white space and comments.
    fn skip_blanks(&mut self) {
        loop {
            if self.peek().is_some_and(is_blank) {
                self.bump();
            } else if self.rest().starts_with("//") {
                self.past("\n");
            } else if self.eat("/*") {
                self.skip_block_comment();
            } else {
                return;
            }
        }
    }

    fn skip_block_comment(&mut self) {
        let mut depth = 1;
        while depth > 0 && self.peek().is_some() {
            if self.eat("/*") {
                depth += 1;
            } else if self.eat("*/") {
                depth -= 1;
            } else {
                self.bump();
            }
        }
    }

    /// Skips headers like `#![enable(implicit_some)]`.
    fn skip_attributes(&mut self) {
        self.skip_blanks();
        while self.rest().starts_with('#') {
            self.past("]");
            self.skip_blanks();
        }
    }

    fn is_word_start(c: char) -> bool {
        c == '_' || c.is_alphabetic()
    }

    /// Reads an identifier; a raw one (`r#name`) without its prefix.
    fn word(&mut self) -> Option<&'a str> {
        if self.rest().starts_with("r#") && !self.rest()[2..].starts_with(['"', '#']) {
            self.at += 2;
        } else if !self.peek().is_some_and(Self::is_word_start) || self.starts_string().is_some() {
            return None;
        }
        let start = self.at;
        while self
            .peek()
            .is_some_and(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-'))
        {
            self.bump();
        }
        Some(&self.text[start..self.at])
    }

    /// Whether a string starts here: length of its opening, and number of hash marks if it is raw.
    fn starts_string(&self) -> Option<(usize, Option<usize>)> {
        let rest = self.rest();
        let body = rest.strip_prefix('b').unwrap_or(rest);
        let prefix = rest.len() - body.len();
        if body.starts_with('"') {
            return Some((prefix + 1, None));
        }
        let hashes = body.strip_prefix('r')?;
        let count = hashes.len() - hashes.trim_start_matches('#').len();
        hashes[count..]
            .starts_with('"')
            .then_some((prefix + 2 + count, Some(count)))
    }

    fn skip_string(&mut self, opening: usize, raw: Option<usize>) {
        self.at += opening;
        if let Some(hashes) = raw {
            return self.past(&format!("\"{}", "#".repeat(hashes)));
        }
        while let Some(c) = self.peek() {
            self.bump();
            match c {
                '\\' => self.bump(),
                '"' => return,
                _ => {}
            }
        }
    }

    /// Skips a character literal, or a single apostrophe that does not start one.
    fn skip_char(&mut self) {
        self.bump();
        if self.eat("\\") {
            self.bump();
            return self.past("'");
        }
        let mut ahead = self.rest().chars();
        if let (Some(_), Some('\'')) = (ahead.next(), ahead.next()) {
            self.bump();
            self.bump();
        }
    }

    /// Moves to the end of the value that starts here: a comma, a colon, the closing bracket of the enclosing value, or the end
    /// of the text.
    fn skip_value(&mut self) {
        let mut depth = 0usize;
        self.skip_blanks();
        self.end_of_value = self.at;
        while let Some(c) = self.peek() {
            match c {
                ',' | ':' | ')' | ']' | '}' if depth == 0 => return,
                '(' | '[' | '{' => {
                    depth += 1;
                    self.bump();
                }
                ')' | ']' | '}' => {
                    depth -= 1;
                    self.bump();
                }
                '\'' => self.skip_char(),
                _ => match self.starts_string() {
                    Some((opening, raw)) => self.skip_string(opening, raw),
                    None if self.word().is_some() => {}
                    None => self.bump(),
                },
            }
            self.end_of_value = self.at;
            self.skip_blanks();
        }
    }

    /// Moves past the name and the opening bracket of the value that starts here, and returns them.
    fn head(&mut self) -> Option<(Option<&'a str>, char)> {
        self.skip_blanks();
        let name = self.word();
        self.skip_blanks();
        let bracket = self.peek().filter(|c| matches!(c, '(' | '[' | '{'))?;
        self.bump();
        Some((name, bracket))
    }

    /// As [`head`](Self::head), and moves past any `Some(`; returns whether there is a name.
    fn open(&mut self) -> Option<(bool, char)> {
        loop {
            let (name, bracket) = self.head()?;
            if name != Some("Some") {
                return Some((name.is_some(), bracket));
            }
        }
    }

    /// Start of an inner value of the value that starts here.
    fn enter(&mut self, step: &Step) -> Option<usize> {
        // No value has more layers than this, and a text of only brackets would take very long.
        const LAYERS: usize = 4;
        for _ in 0..LAYERS {
            let (named, bracket) = self.open()?;
            let first = self.at;
            let found = match step {
                // A list in a variant, `Name([...])`.
                Step::Index(_) if named && bracket == '(' && self.is_list() => None,
                Step::Index(index) => self.nth(*index),
                Step::Key(key) => self.keyed(key),
            };
            if found.is_some() {
                return found;
            }
            // A newtype, `Name((...))`, is transparent.
            self.at = first;
            self.skip_blanks();
            let inner = match step {
                Step::Index(_) => named && bracket == '(' && self.is_list(),
                Step::Key(_) => bracket == '(' && self.is_newtype(),
            };
            if !inner {
                return None;
            }
        }
        None
    }

    /// Moves to the start of the inner value that contains a byte; the separator before a value belongs to it. Returns the step
    /// to it, if there is one; `None` without such a value.
    fn enter_at(&mut self, byte: usize) -> Option<Option<Step>> {
        let (name, bracket) = self.head()?;
        for index in 0.. {
            if byte < self.at {
                return None;
            }
            self.skip_blanks();
            let first = self.at;
            self.skip_value();
            let key = (bracket != '[' && self.peek() == Some(':')).then(|| {
                let key = self.text.get(first..self.end_of_value).unwrap_or("");
                key.trim_start_matches("r#").trim_matches('"').to_owned()
            });
            let start = if key.is_some() {
                self.bump();
                let start = self.at;
                self.skip_value();
                start
            } else {
                first
            };
            let (end, last) = (self.end_of_value, self.peek() != Some(','));
            if byte <= end && (key.is_none() || byte >= start) {
                let step = match key {
                    Some(key) => Some(Step::Key(key)),
                    // `Some(x)`, `Name(x)`, `((...))`: the wrapper is transparent.
                    None if bracket == '(' && index == 0 && last => None,
                    None if name == Some("Some") => None,
                    None => Some(Step::Index(index)),
                };
                self.at = start;
                return Some(step);
            }
            if byte <= end || !self.eat(",") {
                return None;
            }
        }
        None
    }

    /// Whether an opening bracket is followed by a list. Does not move the cursor.
    fn is_list(&mut self) -> bool {
        let start = self.at;
        self.skip_blanks();
        let list = self.peek() == Some('[');
        self.at = start;
        list
    }

    /// Whether an opening bracket is followed by a single value without a key. Does not move the cursor.
    fn is_newtype(&mut self) -> bool {
        let start = self.at;
        self.skip_value();
        let alone = self.peek() != Some(':') && self.at > start;
        self.at = start;
        alone
    }

    /// Start of value number `index` of a list or tuple; the cursor is just behind its bracket.
    fn nth(&mut self, index: usize) -> Option<usize> {
        for _ in 0..index {
            self.skip_value();
            if !self.eat(",") {
                return None;
            }
        }
        self.skip_blanks();
        let start = self.at;
        self.peek()
            .filter(|c| !matches!(c, ')' | ']' | '}'))
            .map(|_| start)
    }

    /// Start of the value of a key in a struct or map; the cursor is just behind its bracket.
    fn keyed(&mut self, key: &str) -> Option<usize> {
        loop {
            self.skip_blanks();
            let start = self.at;
            let word = self.word();
            self.skip_blanks();
            let found = match word {
                Some(word) if self.peek() == Some(':') => word == key,
                _ => {
                    self.at = start;
                    self.skip_value();
                    self.text
                        .get(start..self.end_of_value)
                        .is_some_and(|name| name.trim_matches('"') == key)
                }
            };
            if self.eat(":") {
                self.skip_blanks();
                if found {
                    return Some(self.at);
                }
                self.skip_value();
            }
            if !self.eat(",") {
                return None;
            }
        }
    }
}

/// Whether RON treats a character as white space.
fn is_blank(c: char) -> bool {
    matches!(
        c,
        ' ' | '\t'
            | '\n'
            | '\r'
            | '\x0B'
            | '\x0C'
            | '\u{85}'
            | '\u{200E}'
            | '\u{200F}'
            | '\u{2028}'
            | '\u{2029}'
    )
}

#[cfg(test)]
mod tests {
    use super::super::error::at;
    use super::*;
    use proptest::prelude::*;

    fn found(text: &str, path: Path) -> &str {
        &text[locate(text, &path)]
    }

    #[test]
    fn fields_and_elements() {
        let text = "(title: \"a, b: (c\", slaves: [(nodes: [\"x\", \"y\"], on: []), ( nodes : [ \"z\" , ] )])";
        assert_eq!(found(text, at!["title"]), "\"a, b: (c\"");
        assert_eq!(found(text, at!["slaves", 0, "nodes", 1]), "\"y\"");
        assert_eq!(found(text, at!["slaves", 1, "nodes", 0]), "\"z\"");
        assert_eq!(found(text, at!["slaves", 0, "on"]), "[]");
    }

    #[test]
    fn a_missing_value_is_located_at_the_innermost_enclosing_one() {
        let text = "(friction: (angle: 3), slaves: [(nodes: [])])";
        assert_eq!(found(text, at!["friction", "cohesion"]), "(angle: 3)");
        assert_eq!(found(text, at!["slaves", 0, "nodes", 4]), "[]");
        assert_eq!(found(text, at!["slaves", 7]), "[(nodes: [])]");
        assert_eq!(found(text, at!["nothing"]), text);
    }

    #[test]
    fn paths_and_positions_are_inverse() {
        let text = "#![enable(implicit_some)]\n(\n  a: 1, /* ( */ b: [(x: \"),\", y: Some(2)), (3, 4)],\n  c: Name(u: {\"k\": 5}),\n  d: Two([6]),\n)";
        for (value, path) in [
            ("1", "a"),
            ("\"),\"", "b[0].x"),
            ("2", "b[0].y"),
            ("3", "b[1][0]"),
            ("4", "b[1][1]"),
            ("5", "c.u.k"),
            ("6", "d[0]"),
        ] {
            let byte = text.rfind(value).unwrap();
            let (line, column) = line_and_column(text, byte);
            assert_eq!(byte_at(text, line, column), byte);
            let found = path_at(text, byte);
            assert_eq!(found.to_string(), path, "{value}");
            assert!(text[locate(text, &found)].contains(value), "{value}");
        }
        // A field's name belongs to the enclosing value, and so does the text after an error.
        assert_eq!(path_at(text, byte_at(text, 4, 11)).to_string(), "c");
        assert_eq!(path_at(text, byte_at(text, 99, 1)), Path::default());
    }

    #[test]
    fn brackets_in_comments_strings_and_characters_are_ignored() {
        let text = "#![enable(implicit_some)] // (a: 1)\n/* [ /* nested ) */ \" */\nScene(\n  // b: 2,\n  \
                    a: r#\"raw \" , ) \"#, c: '\\'', d: '(', e: b\"x\\\")\", s: \"\\\\\", /* ] */ b : 5 /* x */ , )";
        assert_eq!(found(text, at!["a"]), "r#\"raw \" , ) \"#");
        assert_eq!(found(text, at!["c"]), "'\\''");
        assert_eq!(found(text, at!["d"]), "'('");
        assert_eq!(found(text, at!["e"]), "b\"x\\\")\"");
        assert_eq!(found(text, at!["b"]), "5");
    }

    #[test]
    fn variants_tuples_maps_and_options() {
        let text = "(nodes: [Line(id: \"a\", from: (0, -1.5e3)), Arc((radius: 2))], m: {\"k\": 1, \"l\": {3: 4}}, \
                    f: Some((angle: Some(7))), r#type: 8, g: None)";
        assert_eq!(
            found(text, at!["nodes", 0]),
            "Line(id: \"a\", from: (0, -1.5e3))"
        );
        assert_eq!(found(text, at!["nodes", 0, "from", 1]), "-1.5e3");
        assert_eq!(found(text, at!["nodes", 1, "radius"]), "2");
        assert_eq!(found(text, at!["m", "l", "3"]), "4");
        assert_eq!(found(text, at!["f", "angle"]), "Some(7)");
        assert_eq!(found(text, at!["type"]), "8");
        assert_eq!(found(text, at!["g", "angle"]), "None");
    }

    #[test]
    fn a_list_in_a_variant_is_entered() {
        let text = "Contacts(matrix: Stiffness( [[1, 2], [3, 4]]), at: P(5, 6), l: Name([7], [8]))";
        assert_eq!(found(text, at!["matrix", 1, 0]), "3");
        assert_eq!(found(text, at!["matrix", 0, 1]), "2");
        assert_eq!(found(text, at!["at", 1]), "6");
    }

    #[test]
    fn excessive_nesting_is_found_and_only_brackets_count() {
        let deep = |k: usize| format!("{}1{}", "[(".repeat(k), ")]".repeat(k));
        assert_eq!(too_deep(&deep(DEEPEST / 2)), None);
        assert_eq!(too_deep(&deep(DEEPEST / 2 + 1)), Some(DEEPEST));
        let hidden = format!(
            "[\"{0}\", r#\"{0}\"#, /* {0} */ '(', '[', // {0}\n]",
            "(".repeat(99)
        );
        assert_eq!(too_deep(&hidden), None);
        for piece in [
            "(", "[", "{", "Scene((", "Some(", "a:(", "'", "r#", "/*", "r\"", "\"\\",
        ] {
            let text = piece.repeat(1 << 17);
            let begun = std::time::Instant::now();
            let _ = (
                too_deep(&text),
                locate(&text, &at!["a", 1, "b"]),
                head(&text),
            );
            let took = begun.elapsed();
            assert!(took.as_secs() < 5, "{piece}: {took:?}");
        }
    }

    #[test]
    fn lines_and_columns_count_from_one_in_characters() {
        assert_eq!(line_and_column("ab\ncé d", 0), (1, 1));
        assert_eq!(line_and_column("ab\ncé d", 3), (2, 1));
        assert_eq!(line_and_column("ab\ncé d", 7), (2, 4));
        assert_eq!(line_and_column("ab", 99), (1, 3));
        assert_eq!(line_and_column("é", 1), (1, 1));
    }

    fn any_path() -> impl Strategy<Value = Path> {
        let step = prop_oneof![
            (0usize..4).prop_map(Step::Index),
            "[a-c]{1,2}".prop_map(Step::Key),
            Just(Step::Key("nodes".into())),
        ];
        prop::collection::vec(step, 0..5).prop_map(Path)
    }

    proptest! {
        #[test]
        fn no_text_makes_it_fail(text in "[\\PC\n]{0,80}", path in any_path()) {
            let range = locate(&text, &path);
            prop_assert!(text.get(range).is_some());
        }

        #[test]
        fn no_text_similar_to_ron_makes_it_fail(text in "[](){}\"'/*,:abSomer#\\\\\n é1]{0,60}", path in any_path()) {
            let range = locate(&text, &path);
            prop_assert!(text.get(range).is_some());
        }
    }
}
