//! Texts of others, made harmless: what a terminal would obey is shown instead, as `\u{1b}`.
//!
//! Everything that the program writes for people or as a table goes through [`text`], texts that stand within a line through
//! [`line()`]. Both leave what is harmless as it is, so that it does no harm to go through them twice.

use std::borrow::Cow;
use std::convert::Infallible;
use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// Whether a terminal or a viewer may take a character for an order: C0 and C1 controls and DEL, marks that turn the
/// direction of writing or end lines, and what is never seen at all.
pub fn is_order(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{61c}'
                | '\u{200e}'
                | '\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2066}'..='\u{206f}'
                | '\u{feff}'
                | '\u{fff9}'..='\u{fffb}'
                | '\u{e0000}'..='\u{e007f}'
        )
}

/// A text of one or more lines: line ends and tabs stay.
pub fn text(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_order(c) && !matches!(c, '\n' | '\t'))
}

/// A text within a line: nothing that is an order stays.
pub fn line(text: &str) -> Cow<'_, str> {
    escaped(text, is_order)
}

/// A text within a line that has room for so many characters of it.
pub fn cut(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}…", line(&text[..end])),
        None => line(text).into_owned(),
    }
}

/// The first of some items, with a separator between them; the others are counted.
pub fn first_of<T: std::fmt::Display>(
    items: impl IntoIterator<Item = T>,
    most: usize,
    separator: &str,
) -> String {
    let mut items = items.into_iter();
    let first: Vec<String> = items
        .by_ref()
        .take(most)
        .map(|item| item.to_string())
        .collect();
    match items.count() {
        0 => first.join(separator),
        more => format!("{} and {more} more", first.join(separator)),
    }
}

/// Joins words by blanks into lines that fit; a word that does not fit is a line by itself.
///
/// # Errors
/// If it cannot be found out whether a line fits.
pub fn wrapped<E>(
    words: impl IntoIterator<Item = String>,
    fits: impl Fn(&str) -> Result<bool, E>,
) -> Result<Vec<String>, E> {
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        let longer = lines.last().map(|last| format!("{last} {word}"));
        match (lines.last_mut(), longer) {
            (Some(last), Some(longer)) if fits(&longer)? => *last = longer,
            _ => lines.push(word),
        }
    }
    Ok(lines)
}

/// Breaks a text into lines at its blanks, and a word that is longer than a line where the line ends.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let text = line(text);
    let words = text.split(' ').flat_map(|word| broken(word, width.max(2)));
    let Ok(lines) = wrapped(words, |line| Ok::<_, Infallible>(line.width() <= width));
    lines
}

/// A word in pieces that are no wider than a line.
fn broken(word: &str, width: usize) -> Vec<String> {
    let mut pieces = vec![String::new()];
    let mut used = 0;
    for letter in word.chars() {
        let wide = letter.width().unwrap_or(0);
        if used + wide > width {
            pieces.push(String::new());
            used = 0;
        }
        used += wide;
        if let Some(piece) = pieces.last_mut() {
            piece.push(letter);
        }
    }
    pieces
}

/// A text filled up with blanks at its end to so many columns of a terminal, in which a Chinese character takes two.
pub fn padded(text: &str, columns: usize) -> String {
    let missing = columns.saturating_sub(text.width());
    format!("{text}{}", " ".repeat(missing))
}

/// The same with the blanks before it.
pub fn padded_before(text: &str, columns: usize) -> String {
    let missing = columns.saturating_sub(text.width());
    format!("{}{text}", " ".repeat(missing))
}

/// Most characters of a cell of a table for people.
const MOST_CELL: usize = 200;

/// Lines of a table: the first columns, so many, and the last one are flush left, the others flush right.
pub fn aligned<R: AsRef<[String]>>(table: &[R], first: usize) -> Vec<String> {
    let harmless = |row: &R| {
        row.as_ref()
            .iter()
            .map(|cell| cut(cell, MOST_CELL))
            .collect()
    };
    let table: Vec<Vec<String>> = table.iter().map(harmless).collect();
    let columns = table.first().map_or(0, Vec::len);
    let is_left = |k: usize| k < first || k + 1 == columns;
    let width = |k: usize| table.iter().map(|row| row[k].width()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let cell = |(k, text): (usize, &String)| match is_left(k) {
        true => padded(text, widths[k]),
        false => padded_before(text, widths[k]),
    };
    let line = |row: &Vec<String>| {
        let cells: Vec<String> = row.iter().enumerate().map(cell).collect();
        cells.join("  ").trim_end().to_owned()
    };
    table.iter().map(line).collect()
}

fn escaped(text: &str, harmful: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&harmful) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match harmful(c) {
            true => shown.extend(c.escape_unicode()),
            false => shown.push(c),
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_wrapped_text_is_all_there_and_no_line_of_it_is_too_wide() {
        let text = "a path /that/is/longer/than/any/line and 接触の摩擦角と滑りの長さ to the end";
        for width in 2..60 {
            let lines = wrap(text, width);
            assert!(lines.iter().all(|line| line.width() <= width), "{lines:?}");
            let letters = |text: &str| text.replace(' ', "");
            assert_eq!(letters(&lines.concat()), letters(text));
        }
    }

    #[test]
    fn orders_are_shown_and_letters_stay() {
        assert_eq!(line("\u{1b}]0;x\u{7}"), "\\u{1b}]0;x\\u{7}");
        assert_eq!(
            line("a\u{202e}b\u{9b}31m\r\n\t"),
            "a\\u{202e}b\\u{9b}31m\\u{d}\\u{a}\\u{9}"
        );
        assert_eq!(text("one\n\ttwo\r\n"), "one\n\ttwo\\u{d}\n");
        assert_eq!(
            line("φ → 90°, “Wörter”, 日本, עברית"),
            "φ → 90°, “Wörter”, 日本, עברית"
        );
        assert_eq!(cut("abc\u{1b}def", 4), "abc\\u{1b}…");
        assert_eq!(cut("abcd", 4), "abcd");
    }

    proptest! {
        #[test]
        fn nothing_harmful_is_left_and_nothing_changes_twice(any in any::<String>()) {
            let once = line(&any).into_owned();
            prop_assert!(!once.contains(is_order));
            prop_assert_eq!(line(&once), once.as_str());
            let once = text(&any).into_owned();
            prop_assert!(!once.contains(|c| is_order(c) && c != '\n' && c != '\t'));
            prop_assert_eq!(text(&once), once.as_str());
        }
    }
}
