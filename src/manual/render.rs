//! Renders the manual's pages for a terminal, supporting only the Markdown that they use: headings, paragraphs, lists, tables,
//! fenced code and HTML comments (dropped); within a line, code, strong text and links.

use unicode_width::UnicodeWidthStr;

/// Columns for which the pages are written.
pub const WIDTH: usize = 80;
/// Indentation of code, if there is room.
const INDENT: usize = 4;

/// The style of a piece of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Ordinary text.
    Plain,
    /// A heading.
    Heading,
    /// Strong text.
    Strong,
    /// Code.
    Code,
}

use Style::*;

/// A line of a page.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Line {
    /// Pieces of text with their styles.
    pub pieces: Vec<(Style, String)>,
}

impl Line {
    fn new(style: Style, text: impl Into<String>) -> Line {
        Line {
            pieces: vec![(style, text.into())],
        }
    }

    /// The text without styles.
    pub fn text(&self) -> String {
        self.pieces.iter().map(|(_, text)| text.as_str()).collect()
    }

    /// The text for output without styles: a heading is underlined by a second line.
    pub fn plain(&self) -> String {
        let text = self.text();
        let text = text.trim_end();
        if self.is_heading() {
            format!("{text}\n{}", "─".repeat(text.width()))
        } else {
            text.to_owned()
        }
    }

    /// Whether it is a heading.
    pub fn is_heading(&self) -> bool {
        self.pieces.iter().any(|(style, _)| *style == Heading)
    }

    fn is_blank(&self) -> bool {
        self.pieces.iter().all(|(_, text)| text.trim().is_empty())
    }

    /// The text with escape sequences for bold and underline.
    pub fn ansi(&self) -> String {
        self.pieces
            .iter()
            .map(|(style, text)| match style {
                Plain => text.clone(),
                Heading => format!("\u{1b}[1;4m{text}\u{1b}[0m"),
                Strong | Code => format!("\u{1b}[1m{text}\u{1b}[0m"),
            })
            .collect()
    }
}

/// Renders a page in lines of at most `width` columns; only code may be wider.
pub fn render(markdown: &str, width: usize) -> Vec<Line> {
    let mut page = Vec::new();
    let mut lines = markdown.lines().peekable();
    while let Some(line) = lines.next() {
        let trimmed = line.trim();
        if trimmed.is_empty() || (trimmed.starts_with("<!--") && trimmed.ends_with("-->")) {
            gap(&mut page);
        } else if trimmed.starts_with("```") {
            let code: Vec<&str> = lines
                .by_ref()
                .take_while(|line| line.trim() != "```")
                .collect();
            gap(&mut page);
            page.extend(block(&code, width));
            gap(&mut page);
        } else if let Some(heading) = heading(line) {
            gap(&mut page);
            page.push(heading);
            gap(&mut page);
        } else if trimmed.starts_with('|') {
            let mut rows = vec![trimmed];
            while let Some(row) = lines.next_if(|line| line.trim().starts_with('|')) {
                rows.push(row.trim());
            }
            gap(&mut page);
            page.extend(table(&rows, width));
            gap(&mut page);
        } else {
            let (lead, first) = item(line);
            let mut text = first.to_owned();
            while let Some(next) = lines.next_if(|line| goes_on(line)) {
                text.push(' ');
                text.push_str(next.trim());
            }
            page.extend(paragraph(&lead, &text, width));
        }
    }
    while page.last().is_some_and(Line::is_blank) {
        page.pop();
    }
    page
}

/// Adds an empty line, unless there is one already or the page is empty.
fn gap(page: &mut Vec<Line>) {
    if page.last().is_some_and(|last| !last.is_blank()) {
        page.push(Line::default());
    }
}

fn heading(line: &str) -> Option<Line> {
    let text = line.trim_start_matches('#');
    let level = line.len() - text.len();
    ((1..=6).contains(&level) && text.starts_with(' ')).then(|| {
        let words: String = inline(text.trim())
            .into_iter()
            .map(|(_, text)| text)
            .collect();
        Line::new(Heading, words)
    })
}

/// Code unchanged, indented if it fits.
fn block(code: &[&str], width: usize) -> Vec<Line> {
    let widest = code.iter().map(|line| line.width()).max().unwrap_or(0);
    let indent = INDENT.min(width.saturating_sub(widest));
    code.iter()
        .map(|line| {
            if line.is_empty() {
                Line::default()
            } else {
                Line::new(Plain, format!("{:indent$}{line}", ""))
            }
        })
        .collect()
}

/// The marker of a list item and its text; a plain paragraph has an empty marker.
fn item(line: &str) -> (String, &str) {
    let text = line.trim_start();
    let indent = line.len() - text.len();
    let number = text.chars().take_while(char::is_ascii_digit).count();
    let mark = match text {
        _ if text.starts_with("- ") => 2,
        _ if number > 0 && text[number..].starts_with(". ") => number + 2,
        _ => 0,
    };
    let lead = format!("{:indent$}{}", "", &text[..mark]);
    (lead, text[mark..].trim_start())
}

/// Whether a line continues the paragraph above it.
fn goes_on(line: &str) -> bool {
    let text = line.trim();
    let begins = ["|", "```", "#", "<!--"];
    !text.is_empty()
        && !begins.iter().any(|sign| text.starts_with(sign))
        && item(line).0.trim().is_empty()
}

/// A wrapped paragraph whose first line starts with `lead`.
fn paragraph(lead: &str, text: &str, width: usize) -> Vec<Line> {
    let margin = lead.width();
    let wrapped = wrap(&inline(text), width.saturating_sub(margin).max(20));
    let line = |(k, line): (usize, Line)| {
        let before = match k {
            0 => lead.to_owned(),
            _ => " ".repeat(margin),
        };
        let mut pieces = vec![(Plain, before)];
        pieces.retain(|(_, text)| !text.is_empty());
        pieces.extend(line.pieces);
        Line { pieces }
    };
    wrapped.into_iter().enumerate().map(line).collect()
}

/// Splits a text into code, strong text, link texts and plain text.
fn inline(text: &str) -> Vec<(Style, String)> {
    let mut pieces = Vec::new();
    let mut plain = String::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let found = match first {
            '`' => between(rest, "`", "`").map(|(inner, after)| (Code, inner, after)),
            // A star after a letter, as in S*, opens nothing.
            '*' if plain.ends_with(char::is_alphanumeric) => None,
            '*' => between(rest, "**", "**")
                .map(|(inner, after)| (Strong, inner, after))
                .or_else(|| between(rest, "*", "*").map(|(inner, after)| (Plain, inner, after))),
            '[' => between(rest, "[", "](").and_then(|(inner, after)| {
                let (_, after) = after.split_once(')')?;
                Some((Plain, inner, after))
            }),
            '<' => rest
                .strip_prefix("<!--")
                .and_then(|comment| comment.split_once("-->"))
                .map(|(_, after)| (Plain, "", after)),
            _ => None,
        };
        match found {
            Some((style, inner, after)) => {
                pieces.push((Plain, std::mem::take(&mut plain)));
                pieces.push((style, inner.to_owned()));
                rest = after;
            }
            None => {
                plain.push(first);
                rest = &rest[first.len_utf8()..];
            }
        }
    }
    pieces.push((Plain, plain));
    pieces.retain(|(_, text)| !text.is_empty());
    pieces
}

/// The text between two delimiters at the start of a text, and the rest.
fn between<'a>(text: &'a str, open: &str, close: &str) -> Option<(&'a str, &'a str)> {
    let (inner, after) = text.strip_prefix(open)?.split_once(close)?;
    (!inner.is_empty() && !inner.starts_with(' ')).then_some((inner, after))
}

/// Wraps pieces to a width at blanks; a longer word gets a separate line.
fn wrap(pieces: &[(Style, String)], width: usize) -> Vec<Line> {
    let mut lines = vec![Line::default()];
    let mut used = 0;
    // A word is everything between two blanks, in any styles.
    let mut word: Vec<(Style, String)> = Vec::new();
    let mut end = |word: &mut Vec<(Style, String)>, lines: &mut Vec<Line>| {
        let wide: usize = word.iter().map(|(_, text)| text.width()).sum();
        if wide == 0 {
            return word.clear();
        }
        if used > 0 && used + 1 + wide > width {
            lines.push(Line::default());
            used = 0;
        }
        let Some(line) = lines.last_mut() else { return };
        if used > 0 {
            push(line, Plain, " ");
            used += 1;
        }
        for (style, text) in word.drain(..) {
            push(line, style, &text);
        }
        used += wide;
    };
    for (style, text) in pieces {
        for (k, part) in text.split(' ').enumerate() {
            if k > 0 {
                end(&mut word, &mut lines);
            }
            if !part.is_empty() {
                word.push((*style, part.to_owned()));
            }
        }
    }
    end(&mut word, &mut lines);
    lines
}

/// Appends a text, to the last piece if that has the same style.
fn push(line: &mut Line, style: Style, text: &str) {
    match line.pieces.last_mut() {
        Some((last, written)) if *last == style => written.push_str(text),
        _ => line.pieces.push((style, text.to_owned())),
    }
}

/// A table in columns; cells that are too long wrap.
fn table(rows: &[&str], width: usize) -> Vec<Line> {
    const APART: usize = 2;
    let is_rule = |row: &&&str| row.chars().all(|c| matches!(c, '|' | '-' | ':' | ' '));
    let cells: Vec<Vec<Vec<(Style, String)>>> = rows
        .iter()
        .filter(|row| !is_rule(row))
        .map(|row| split(row))
        .collect();
    let columns = cells.iter().map(Vec::len).max().unwrap_or(0);
    let measure = |column: usize, of: fn(&[(Style, String)]) -> usize| {
        let wide = cells
            .iter()
            .filter_map(|row| row.get(column))
            .map(|cell| of(cell));
        wide.max().unwrap_or(0)
    };
    let wanted: Vec<usize> = (0..columns)
        .map(|column| measure(column, whole_width))
        .collect();
    let least: Vec<usize> = (0..columns)
        .map(|column| measure(column, longest_word))
        .collect();
    let room = width.saturating_sub(APART * columns.saturating_sub(1));
    let widths = share(&wanted, &least, room);
    let header = rows.get(1).is_some_and(|row| is_rule(&row));
    let mut lines = Vec::new();
    for (k, row) in cells.iter().enumerate() {
        let wrapped: Vec<Vec<Line>> = row
            .iter()
            .zip(&widths)
            .map(|(cell, wide)| wrap(cell, *wide))
            .collect();
        let tall = wrapped.iter().map(Vec::len).max().unwrap_or(0);
        for level in 0..tall {
            let mut line = Line::default();
            for (column, wide) in widths.iter().enumerate() {
                let mut cell = wrapped
                    .get(column)
                    .and_then(|cell| cell.get(level))
                    .cloned()
                    .unwrap_or_default();
                let used = cell.text().width();
                if k == 0 && header {
                    cell.pieces
                        .iter_mut()
                        .for_each(|(style, _)| *style = Strong);
                }
                for (style, text) in cell.pieces {
                    push(&mut line, style, &text);
                }
                if column + 1 < columns {
                    push(
                        &mut line,
                        Plain,
                        &" ".repeat(wide.saturating_sub(used) + APART),
                    );
                }
            }
            lines.push(line);
        }
        if k == 0 && header {
            let rules: Vec<String> = widths.iter().map(|wide| "─".repeat(*wide)).collect();
            lines.push(Line::new(Plain, rules.join(&" ".repeat(APART))));
        }
    }
    lines
}

/// The cells of a row; `\|` is a literal bar.
fn split(row: &str) -> Vec<Vec<(Style, String)>> {
    let row = row.replace("\\|", "\u{0}");
    let row = row.trim_matches('|');
    row.split('|')
        .map(|cell| inline(cell.trim().replace('\u{0}', "|").as_str()))
        .collect()
}

fn whole_width(cell: &[(Style, String)]) -> usize {
    cell.iter().map(|(_, text)| text.width()).sum()
}

fn longest_word(cell: &[(Style, String)]) -> usize {
    let text: String = cell.iter().map(|(_, text)| text.as_str()).collect();
    text.split(' ')
        .map(UnicodeWidthStr::width)
        .max()
        .unwrap_or(0)
}

/// Column widths that fit: the wanted ones if possible, otherwise the widest columns shrink first.
fn share(wanted: &[usize], least: &[usize], room: usize) -> Vec<usize> {
    let mut widths = wanted.to_vec();
    while widths.iter().sum::<usize>() > room {
        let Some(widest) = (0..widths.len())
            .filter(|column| widths[*column] > least[*column])
            .max_by_key(|column| widths[*column])
        else {
            break;
        };
        widths[widest] -= 1;
    }
    widths
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(markdown: &str, width: usize) -> Vec<String> {
        render(markdown, width)
            .iter()
            .map(|line| line.text().trim_end().to_owned())
            .collect()
    }

    #[test]
    fn paragraphs_and_lists_are_wrapped_within_their_margins() {
        let text = "one two three `four five` six seven eight\n\n- a long item of a list that continues\n  here\n1. next";
        let expected = [
            "one two three four",
            "five six seven eight",
            "",
            "- a long item of a",
            "  list that continues",
            "  here",
            "1. next",
        ];
        assert_eq!(shown(text, 20), expected);
    }

    #[test]
    fn code_is_kept_and_comments_are_dropped() {
        let text = "<!-- keys -->\n```text\na  b\n\n   c\n```\nafter<!-- all --> it";
        assert_eq!(
            shown(text, 80),
            ["    a  b", "", "       c", "", "after it"]
        );
        assert_eq!(shown("```text\n123456789\n```", 10), [" 123456789"]);
    }

    #[test]
    fn tables_stay_aligned_and_long_cells_wrap() {
        let text = "| a | b |\n|---|---|\n| `x\\|y` | one two three |\n| long | z |";
        let expected = [
            "a     b",
            "────  ───────",
            "x|y   one two",
            "      three",
            "long  z",
        ];
        assert_eq!(shown(text, 13), expected);
    }

    #[test]
    fn styles_are_marked() {
        let line = &render("see **this** and [that](there.md), `code`, 2 * 3 * 4", 80)[0];
        assert_eq!(line.text(), "see this and that, code, 2 * 3 * 4");
        assert_eq!(line.pieces[1], (Style::Strong, "this".into()));
        assert!(render("# Title", 80)[0].is_heading());
        assert_eq!(render("## Two", 80)[0].plain(), "Two\n───");
        assert_eq!(render("## A", 80)[0].ansi(), "\u{1b}[1;4mA\u{1b}[0m");
    }
}
