//! Rows of the screen as HTML. The page has a class for each colour and text style.

use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};
use std::fmt::Write;
use stickslip_tui::theme::terminal_number;

/// A row of the screen. Cells with the same style form one element of their width, so that columns stay aligned in every font;
/// a character beyond ASCII, whose width differs between fonts, has its own element.
pub fn row(buffer: &Buffer, at: usize) -> String {
    let width = usize::from(buffer.area.width);
    let cells = buffer.content.get(at * width..(at + 1) * width);
    let mut html = String::new();
    let mut cells = cells.unwrap_or_default().iter().peekable();
    while let Some(first) = cells.next() {
        let style = classes(first);
        let (mut text, mut columns) = (first.symbol().to_owned(), 1);
        if text.is_ascii() {
            while let Some(next) =
                cells.next_if(|next| next.symbol().is_ascii() && classes(next) == style)
            {
                text += next.symbol();
                columns += 1;
            }
        }
        if style.is_empty() && text.bytes().all(|byte| byte == b' ') && cells.peek().is_none() {
            break;
        }
        element(&mut html, &style, columns, &text);
    }
    html
}

fn element(html: &mut String, classes: &str, columns: usize, text: &str) {
    // Writing to a string cannot fail.
    let _ = write!(html, "<b style=\"--w:{columns}\"");
    if !classes.is_empty() {
        let _ = write!(html, " class=\"{classes}\"");
    }
    html.push('>');
    for letter in text.chars() {
        match letter {
            '<' => html.push_str("&lt;"),
            '&' => html.push_str("&amp;"),
            _ => html.push(letter),
        }
    }
    html.push_str("</b>");
}

/// The classes of a cell's style.
fn classes(cell: &Cell) -> String {
    let mut classes: Vec<String> = Vec::new();
    let colour =
        |ground: &str, colour: Color| terminal_number(colour).map(|name| format!("{ground}{name}"));
    classes.extend(colour("f", cell.fg));
    classes.extend(colour("g", cell.bg));
    let modifiers = [
        (Modifier::BOLD, "bold"),
        (Modifier::DIM, "dim"),
        (Modifier::REVERSED, "reversed"),
        (Modifier::UNDERLINED, "underlined"),
        (Modifier::ITALIC, "italic"),
    ];
    let set = modifiers
        .iter()
        .filter(|(own, _)| cell.modifier.contains(*own));
    classes.extend(set.map(|(_, name)| (*name).to_owned()));
    classes.join(" ")
}
