//! Makes external text safe to print: characters that a terminal would interpret are shown as escapes, e.g. `\u{1b}`.
//!
//! All output for people and all tables pass through [`text`], and text within a line through [`line()`]. Both leave safe text
//! unchanged, so applying them twice does no harm.

use std::borrow::Cow;
use std::convert::Infallible;
use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// Whether a terminal or viewer may interpret a character: C0 and C1 controls, DEL, bidirectional and line-ending marks, and
/// invisible characters.
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

/// Text of one or more lines: line ends and tabs are kept.
pub fn text(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_order(c) && !matches!(c, '\n' | '\t'))
}

/// Text within a line: everything special is escaped.
pub fn line(text: &str) -> Cow<'_, str> {
    escaped(text, is_order)
}

/// Text within a line, truncated to `most` characters.
pub fn cut(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}…", line(&text[..end])),
        None => line(text).into_owned(),
    }
}

/// All items, with a separator between them.
pub fn joined<T: std::fmt::Display>(items: impl IntoIterator<Item = T>, separator: &str) -> String {
    let items: Vec<String> = items.into_iter().map(|item| item.to_string()).collect();
    items.join(separator)
}

/// The first few items, and an ellipsis if there are more.
pub fn few<T: std::fmt::Display>(items: impl IntoIterator<Item = T>, most: usize) -> String {
    let mut items = items.into_iter();
    let first = joined(items.by_ref().take(most), ", ");
    match items.next() {
        None => first,
        Some(_) => first + ", …",
    }
}

/// The first few items, with a separator between them, and the number of the others.
pub fn first_of<T: std::fmt::Display>(
    items: impl IntoIterator<Item = T>,
    most: usize,
    separator: &str,
) -> String {
    let mut items = items.into_iter();
    let first = joined(items.by_ref().take(most), separator);
    match items.count() {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}

/// Joins words with spaces into lines that fit; a word that does not fit gets a separate line.
///
/// # Errors
/// If the check whether a line fits fails.
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

/// Breaks text into lines at spaces; a word that is longer than a line is broken at the line's end.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let text = line(text);
    let words = text.split(' ').flat_map(|word| broken(word, width.max(2)));
    let Ok(lines) = wrapped(words, |line| Ok::<_, Infallible>(line.width() <= width));
    lines
}

/// Splits a word into pieces that are no wider than a line.
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

/// Pads text on the right to a number of terminal columns; wide characters, such as Chinese ones, take two.
pub fn padded(text: &str, columns: usize) -> String {
    let missing = columns.saturating_sub(text.width());
    format!("{text}{}", " ".repeat(missing))
}

/// Pads text on the left.
pub fn padded_before(text: &str, columns: usize) -> String {
    let missing = columns.saturating_sub(text.width());
    format!("{}{text}", " ".repeat(missing))
}

/// Maximum number of characters in a table cell.
const MOST_CELL: usize = 200;

/// Lines of a table: the first `first` columns and the last one are left-aligned, the others right-aligned.
pub fn aligned<R: AsRef<[String]>>(table: &[R], first: usize) -> Vec<String> {
    let table: Vec<Vec<String>> = table
        .iter()
        .map(|row| {
            row.as_ref()
                .iter()
                .map(|cell| cut(cell, MOST_CELL))
                .collect()
        })
        .collect();
    let columns = table.first().map_or(0, Vec::len);
    let is_left = |k: usize| k < first || k + 1 == columns;
    let widths: Vec<usize> = (0..columns)
        .map(|k| table.iter().map(|row| row[k].width()).max().unwrap_or(0))
        .collect();
    let cell = |(k, text): (usize, &String)| {
        if is_left(k) {
            padded(text, widths[k])
        } else {
            padded_before(text, widths[k])
        }
    };
    table
        .iter()
        .map(|row| {
            let cells: Vec<String> = row.iter().enumerate().map(cell).collect();
            cells.join("  ").trim_end().to_owned()
        })
        .collect()
}

fn escaped(text: &str, harmful: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&harmful) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if harmful(c) {
            shown.extend(c.escape_unicode())
        } else {
            shown.push(c)
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn wrapping_keeps_all_text_within_the_width() {
        let text = "a path /that/is/longer/than/any/line and 接触の摩擦角と滑りの長さ to the end";
        for width in 2..60 {
            let lines = wrap(text, width);
            assert!(lines.iter().all(|line| line.width() <= width), "{lines:?}");
            let letters = |text: &str| text.replace(' ', "");
            assert_eq!(letters(&lines.concat()), letters(text));
        }
    }

    #[test]
    fn control_characters_are_escaped_and_letters_kept() {
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
        fn escaping_is_complete_and_idempotent(any in any::<String>()) {
            let once = line(&any).into_owned();
            prop_assert!(!once.contains(is_order));
            prop_assert_eq!(line(&once), once.as_str());
            let once = text(&any).into_owned();
            prop_assert!(!once.contains(|c| is_order(c) && c != '\n' && c != '\t'));
            prop_assert_eq!(text(&once), once.as_str());
        }
    }
}
