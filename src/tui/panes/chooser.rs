//! The chooser: scenes, lessons and files, with a preview of the selection if there is room.

use crate::app::App;
use crate::chooser_state::{Chooser, Group, Offer, Preview, PreviewContent};
use crate::layout::top;
use crate::paint;
use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::text::{Line, Span};
use unicode_width::UnicodeWidthStr;

/// Minimum width for a preview next to the list, and minimum height for a preview below it.
const SIDE_BY_SIDE: u16 = 110;
const BELOW: u16 = 16;
/// Rows of a preview below the list, and columns of its picture.
const ROWS: u16 = 7;
const PICTURE: u16 = 30;
/// Minimum width of a preview next to the list.
const LOOK: u16 = 36;
/// Maximum rows of text above the picture of a preview next to the list.
const WORDS: u16 = 12;

/// Draws the list, and returns the area for the preview's picture, which may be empty.
pub fn draw(buffer: &mut Buffer, area: Rect, chooser: &Chooser, app: &App) -> Rect {
    let left = chooser.left(&app.offers);
    let title = match chooser.typed.as_str() {
        "" => "Choose a scene or a lesson; type to find one".into(),
        typed => format!("Choose: {typed}▏ {} of {}", left.len(), app.offers.len()),
    };
    let inner = paint::frame(buffer, area, &title, true, &app.theme);
    let width = width(&app.offers);
    let side_by_side = inner.width >= width.max(SIDE_BY_SIDE - LOOK) + LOOK;
    let (list, preview) = match () {
        _ if side_by_side => {
            let columns = [
                Constraint::Length(width.max(inner.width / 2)),
                Constraint::Fill(1),
            ];
            let [list, preview] = Layout::horizontal(columns).areas(inner);
            (list, Some(preview))
        }
        _ if inner.height >= BELOW => {
            let rows = [Constraint::Fill(1), Constraint::Length(ROWS)];
            let [list, preview] = Layout::vertical(rows).areas(inner);
            let rule = "─".repeat(usize::from(preview.width));
            buffer.set_string(preview.x, preview.y, rule, app.theme.faint);
            let [_, below] = top(preview, 1);
            (list, Some(below))
        }
        _ => (inner, None),
    };
    let (lines, at) = lines(&left, chooser.at, usize::from(list.width), app);
    // The heading of a group is visible with its first entry.
    let room = usize::from(list.height);
    let top = (at + 1).saturating_sub(room);
    let lines: Vec<Line> = lines.into_iter().skip(top).collect();
    if left.is_empty() {
        let text = "no name or title contains these words; Esc clears them";
        paint::note(buffer, list, text, &app.theme);
    } else {
        paint::lines(buffer, list, &lines)
    }
    let selected = left.get(chooser.at);
    let known = app.preview.as_ref();
    let seen = selected.and_then(|offer| known.filter(|preview| preview.name == offer.name));
    match (preview, seen) {
        (Some(area), Some(preview)) => look(buffer, area, preview, side_by_side, app),
        _ => Rect::ZERO,
    }
}

/// Columns for the whole names and titles of the list.
fn width(offers: &[Offer]) -> u16 {
    let names = offers.iter().map(|offer| offer.name.width());
    let texts = offers
        .iter()
        .map(|offer| offer.title.width() + done(offer).width());
    (names.max().unwrap_or(0) + texts.max().unwrap_or(0) + 6).min(1000) as u16
}

/// The user's progress in a lesson.
fn done(offer: &Offer) -> String {
    match &offer.reached {
        None => String::new(),
        Some(reached) if reached.is_done() => format!("✓ {}  ", reached.words()),
        Some(reached) => format!("{}  ", reached.words()),
    }
}

/// The lines of the list, and the index of the selected one.
fn lines<'a>(left: &[&'a Offer], at: usize, width: usize, app: &App) -> (Vec<Line<'a>>, usize) {
    let theme = &app.theme;
    let names = left
        .iter()
        .map(|offer| offer.name.width())
        .max()
        .unwrap_or(0)
        .min(width / 2);
    let is_new = app.offers.iter().all(|offer| offer.reached.is_none());
    let (mut lines, mut here, mut group) = (Vec::new(), 0, None);
    for (index, offer) in left.iter().enumerate() {
        if group.replace(offer.group) != Some(offer.group) {
            let title = match offer.group {
                Group::Lessons if is_new => "New here? Start with the first lesson",
                group => group.title(),
            };
            lines.push(Line::styled(format!(" {title}"), theme.heading));
        }
        let (mark, style) = if index == at {
            ("▸", theme.selected)
        } else {
            (" ", theme.text)
        };
        if index == at {
            here = lines.len();
        }
        let [name, blank] = paint::cell(&offer.name, names, style);
        let done = done(offer);
        let room = width.saturating_sub(names + 6 + done.width());
        lines.push(Line::from(vec![
            Span::styled(format!(" {mark} "), theme.focus),
            name,
            blank,
            Span::raw("   "),
            Span::styled(done, theme.good),
            Span::styled(paint::cut(&offer.title, room), theme.faint),
        ]));
    }
    (lines, here)
}

/// Draws title and description of the selected entry, and returns the area for its picture.
fn look(buffer: &mut Buffer, area: Rect, preview: &Preview, side_by_side: bool, app: &App) -> Rect {
    let theme = &app.theme;
    let glance = match &preview.what {
        Ok(glance) => glance,
        Err(why) => {
            let lines = paint::wrapped(why, area.width.into(), theme.warning);
            paint::lines(buffer, area, &lines);
            return Rect::ZERO;
        }
    };
    let [words, picture] = if side_by_side {
        let rows = description(glance, area.width, app).len() as u16 + 1;
        top(area, rows.min(WORDS))
    } else {
        let columns = [Constraint::Fill(1), Constraint::Length(PICTURE)];
        Layout::horizontal(columns).areas(area)
    };
    let mut lines = description(glance, words.width, app);
    let room = usize::from(words.height);
    if lines.len() > room && room > 0 {
        lines.truncate(room);
        // The opened scene shows the full text.
        lines[room - 1].push_span(Span::styled(" …", theme.faint));
    }
    paint::lines(buffer, words, &lines);
    picture
}

fn description(glance: &PreviewContent, width: u16, app: &App) -> paint::Lines {
    let width = usize::from(width.saturating_sub(2));
    let mut lines = paint::wrapped(&glance.title, width, app.theme.heading);
    lines.extend(paint::wrapped(&glance.about, width, app.theme.text));
    lines
}
