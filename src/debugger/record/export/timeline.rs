//! The timeline in a picture: the modes of slave nodes in the last minor iterations, one cell each.

use super::export_state::COLUMNS;
use crate::explain::names;
use crate::history::strip::{PointKind, Strip};
use stickslip_core::model::{Mode, Model};
use stickslip_scene::number::shortest;
use stickslip_study::drawn::PlotError;
use stickslip_study::sheet::{Anchor, BLACK, Colour, GREY, LABEL, MARGIN, SMALL, Sheet, widest};

/// Size of a cell.
const CELL: (f64, f64) = (14.0, 16.0);
/// Maximum number of slave nodes in the timeline of a whole picture, and height of everything but its rows.
pub(super) const ROWS: usize = 14;
const FRAME: f64 = 110.0;

/// Number of rows in a timeline of this height.
pub(super) fn rows(height: f64) -> usize {
    ((height - FRAME) / CELL.1).max(1.0) as usize
}

/// Fill colour of a mode's marker.
pub(super) fn colour(mode: Mode) -> Colour {
    match mode {
        Mode::Free => (255, 255, 255),
        Mode::Sliding => (230, 159, 0),
        Mode::Fixed => (0, 90, 140),
    }
}

/// The most relevant slave nodes, in the order of the scene: those that change in the last minor iterations,
/// then those in contact; the others only if all fit.
pub(super) fn chosen(model: &Model, strips: &[Strip], most: usize) -> Vec<usize> {
    let last = last(strips);
    let count = model.contacts.len();
    let rank = |slave: usize| {
        let changes = last.iter().any(|strip| strip.changes(slave));
        let touches = last
            .last()
            .is_some_and(|strip| strip.before(slave) != Mode::Free);
        (!changes, !touches, slave)
    };
    let mut all: Vec<usize> = (0..count).collect();
    if count <= most {
        return all;
    }
    all.sort_by_key(|slave| rank(*slave));
    let telling = all
        .iter()
        .filter(|slave| !(rank(**slave).0 && rank(**slave).1))
        .count();
    all.truncate(telling.clamp(1, most));
    all.sort_unstable();
    all
}

/// The last minor iterations.
fn last(strips: &[Strip]) -> Vec<&Strip> {
    let solved: Vec<&Strip> = strips.iter().filter(|s| s.kind.is_solved()).collect();
    solved[solved.len().saturating_sub(COLUMNS)..].to_vec()
}

/// The sign below a minor iteration that ends a major iteration or an increment.
fn sign(kind: PointKind) -> &'static str {
    match kind {
        _ if kind.is_accepted() => "✓",
        _ if kind.is_failure() => "✗",
        PointKind::Cut => "✂",
        _ if kind.ends_major() => "|",
        _ => "",
    }
}

/// Draws the timeline at the bottom of the sheet.
pub(super) fn draw(
    sheet: &mut Sheet,
    model: &Model,
    strips: &[Strip],
    most: usize,
) -> Result<(), PlotError> {
    let columns = last(strips);
    let rows = chosen(model, strips, most);
    let (Some(first), Some(end)) = (columns.first(), columns.last()) else {
        return Ok(());
    };
    if rows.is_empty() {
        return Ok(());
    }
    let all = strips.iter().filter(|s| s.kind.is_solved()).count();
    let head = match all > columns.len() {
        true => format!(
            "Modes by minor iteration, the last {}, loads {} to {}",
            columns.len(),
            shortest(first.load_factor),
            shortest(end.load_factor)
        ),
        false => "Modes by minor iteration".to_owned(),
    };
    sheet.paragraph(&[head], LABEL, BLACK)?;
    let words = rows.iter().map(|&slave| names::slave(model, slave));
    let left = MARGIN + widest(words, SMALL)? + 12.0;
    let room = (sheet.width - MARGIN - left) / columns.len() as f64;
    let wide = room.min(CELL.0);
    let top = sheet.height;
    for (row, &slave) in rows.iter().enumerate() {
        let y = top + (row as f64 + 0.5) * CELL.1;
        let name = names::slave(model, slave);
        sheet.text((left - 8.0, y), name, SMALL, BLACK, Anchor::Right);
        for (column, strip) in columns.iter().enumerate() {
            let x = left + wide * column as f64;
            cell(sheet, (x, y - 0.5 * CELL.1), wide, strip.before(slave));
        }
    }
    let below = top + CELL.1 * rows.len() as f64;
    let mut free = f64::NEG_INFINITY;
    for (column, strip) in columns.iter().enumerate() {
        let x = left + wide * (column as f64 + 0.5);
        sheet.text(
            (x, below + 9.0),
            sign(strip.kind),
            SMALL,
            BLACK,
            Anchor::Middle,
        );
        let begins = column == 0 || columns[column - 1].kind.ends_major();
        let text = format!("{}.{}", strip.position.increment, strip.position.major);
        if begins && x > free {
            sheet.text((x, below + 25.0), &text, SMALL, GREY, Anchor::Middle);
            free = x + widest([text.as_str()], SMALL)? + 6.0;
        }
    }
    sheet.height = below + 36.0;
    let key = "f free, s sliding, x fixed; | end of a major iteration, ✓ accepted, ✗ failed; bottom row: increment.major";
    sheet.paragraph(&[key.to_owned()], SMALL, GREY)
}

fn cell(sheet: &mut Sheet, (x, y): (f64, f64), wide: f64, mode: Mode) {
    let (letter, ink): (&str, Colour) = match mode {
        Mode::Free => ("f", GREY),
        Mode::Sliding => ("s", BLACK),
        Mode::Fixed => ("x", (255, 255, 255)),
    };
    sheet.bar((x, y), (wide, CELL.1), (190, 190, 190));
    sheet.bar((x + 0.5, y + 0.5), (wide - 1.0, CELL.1 - 1.0), colour(mode));
    let middle = (x + 0.5 * wide, y + 0.5 * CELL.1);
    sheet.text(middle, letter, SMALL, ink, Anchor::Middle);
}
