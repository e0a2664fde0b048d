//! The timeline in a picture: the modes of slave nodes in the last minor iterations, one cell each.

use super::export_state::COLUMNS;
use crate::explain::names;
use crate::{PointKind, Strip};
use stickslip_core::{Mode, Model};
use stickslip_scene::shortest;
use stickslip_study::drawn::PlotError;
use stickslip_study::sheet::{Anchor, BLACK, Colour, GREY, LABEL, MARGIN, SMALL, Sheet, widest};

/// Size of a cell, and the factors by which it and its width alone grow where there is room.
const CELL: (f64, f64) = (14.0, 16.0);
const LARGEST: f64 = 3.0;
const WIDEST: f64 = 8.0;
/// Maximum number of slave nodes in the timeline of a whole picture, and height of everything but its rows.
const ROWS: usize = 14;
const FRAME: f64 = 110.0;
/// Height of the signs and positions below the rows.
const BELOW: f64 = 40.0;

/// Number of rows in a timeline of this height.
fn rows(height: f64) -> usize {
    ((height - FRAME) / CELL.1).max(1.0) as usize
}

/// Fill colour of a mode's marker.
fn colour(mode: Mode) -> Colour {
    match mode {
        Mode::Free => (255, 255, 255),
        Mode::Sliding => (230, 159, 0),
        Mode::Fixed => (0, 90, 140),
    }
}

/// The marker of a mode: a circle for free, a triangle for sliding, a square for fixed.
pub(super) fn marker(sheet: &mut Sheet, at: (f64, f64), mode: Mode, r: f64) {
    let kind = match mode {
        Mode::Free => 0,
        Mode::Sliding => 2,
        Mode::Fixed => 1,
    };
    sheet.ringed(at, kind, r, colour(mode));
}

/// The most relevant slave nodes, in the order of the scene: those that change in the last minor iterations,
/// then those in contact; the others only if all fit.
pub(super) fn chosen(model: &Model, strips: &[Strip], most: usize) -> Vec<usize> {
    let last = last(strips, COLUMNS);
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
fn last(strips: &[Strip], most: usize) -> Vec<&Strip> {
    let solved: Vec<&Strip> = strips.iter().filter(|s| s.kind.is_solved()).collect();
    solved[solved.len().saturating_sub(most)..].to_vec()
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

/// The arrangement of a timeline: minor iterations from left to right, in bands below each other.
struct Bands {
    /// Slave nodes, a row each.
    rows: Vec<usize>,
    /// Minor iterations in all bands, and per band.
    count: usize,
    per_band: usize,
    /// Size of a cell.
    cell: (f64, f64),
    /// Left edge of the cells.
    left: f64,
}

impl Bands {
    /// Fits a timeline into a width and, if it has one, into a height; otherwise it is one band.
    fn new(
        model: &Model,
        strips: &[Strip],
        width: f64,
        high: Option<f64>,
    ) -> Result<Bands, PlotError> {
        let solved = strips.iter().filter(|s| s.kind.is_solved()).count();
        let rows = chosen(model, strips, high.map_or(ROWS, rows));
        let words = rows.iter().map(|&slave| names::slave(model, slave));
        let left = MARGIN + widest(words, SMALL)? + 12.0;
        let room = width - MARGIN - left;
        let Some(high) = high else {
            let count = solved.min(COLUMNS);
            let wide = (room / count.max(1) as f64).min(CELL.0);
            return Ok(Bands {
                rows,
                count,
                per_band: count,
                cell: (wide, CELL.1),
                left,
            });
        };
        let high = high - FRAME + BELOW;
        let fitting = |factor: f64| {
            let per_band = ((room / (factor * CELL.0)) as usize).max(1);
            let bands = high / (factor * CELL.1 * rows.len() as f64 + BELOW);
            (per_band, per_band * (bands as usize).max(1))
        };
        // The largest cells with which all minor iterations fit, or else the smallest.
        let fits = (0..=20)
            .map(|k| LARGEST - 0.1 * f64::from(k))
            .into_iter()
            .find(|f| fitting(*f).1 >= solved);
        let factor = fits.unwrap_or(1.0);
        let (per_band, most) = fitting(factor);
        let (count, per_band) = (solved.min(most), per_band.min(solved.max(1)));
        let bands = count.div_ceil(per_band).max(1);
        let each = (high / bands as f64 - BELOW) / rows.len().max(1) as f64;
        let wide = (room / per_band as f64).min(WIDEST * CELL.0);
        Ok(Bands {
            count,
            per_band,
            cell: (wide, each.clamp(CELL.1, LARGEST * CELL.1)),
            rows,
            left,
        })
    }

    /// Draws some consecutive minor iterations below the sheet's contents; `before` is the one before them.
    fn draw(
        &self,
        sheet: &mut Sheet,
        model: &Model,
        columns: &[&Strip],
        before: Option<&Strip>,
    ) -> Result<(), PlotError> {
        let (left, (wide, tall), top) = (self.left, self.cell, sheet.height);
        for (row, &slave) in self.rows.iter().enumerate() {
            let y = top + row as f64 * tall;
            let name = names::slave(model, slave);
            let middle = y + 0.5 * tall;
            sheet.text((left - 8.0, middle), name, SMALL, BLACK, Anchor::Right);
            for (column, strip) in columns.iter().enumerate() {
                let x = left + wide * column as f64;
                cell(sheet, (x, y), self.cell, strip.before(slave));
            }
        }
        let below = top + tall * self.rows.len() as f64;
        let mut free = f64::NEG_INFINITY;
        for (column, strip) in columns.iter().enumerate() {
            let x = left + wide * (column as f64 + 0.5);
            let mark = sign(strip.kind);
            sheet.text((x, below + 9.0), mark, SMALL, BLACK, Anchor::Middle);
            let last = match column {
                0 => before,
                _ => Some(columns[column - 1]),
            };
            let begins = last.is_none_or(|last| last.kind.ends_major());
            let text = format!("{}.{}", strip.position.increment, strip.position.major);
            if (begins || column == 0) && x > free {
                sheet.text((x, below + 25.0), &text, SMALL, GREY, Anchor::Middle);
                free = x + widest([text.as_str()], SMALL)? + 6.0;
            }
        }
        sheet.height = below + BELOW;
        Ok(())
    }
}

/// Draws the timeline below the sheet's contents: as many minor iterations as a height has room for, or the last few.
pub(super) fn draw(
    sheet: &mut Sheet,
    model: &Model,
    strips: &[Strip],
    high: Option<f64>,
) -> Result<(), PlotError> {
    let bands = Bands::new(model, strips, sheet.width, high)?;
    let columns = last(strips, bands.count);
    let (Some(first), Some(end)) = (columns.first(), columns.last()) else {
        return Ok(());
    };
    if bands.rows.is_empty() {
        return Ok(());
    }
    let all = strips.iter().filter(|s| s.kind.is_solved()).count();
    let head = if all > columns.len() {
        let (from, to) = (shortest(first.load_factor), shortest(end.load_factor));
        let loads = if from == to {
            format!("load {to}")
        } else {
            format!("loads {from} to {to}")
        };
        format!(
            "Modes by minor iteration, the last {}, {loads}",
            columns.len()
        )
    } else {
        "Modes by minor iteration".to_owned()
    };
    sheet.paragraph(&[head], LABEL, BLACK)?;
    let mut before = None;
    for band in columns.chunks(bands.per_band) {
        bands.draw(sheet, model, band, before)?;
        before = band.last().copied();
    }
    let key = "f free, s sliding, x fixed; | end of a major iteration, ✓ accepted, ✗ failed; bottom row: increment.major";
    sheet.paragraph(&[key.to_owned()], SMALL, GREY)
}

fn cell(sheet: &mut Sheet, (x, y): (f64, f64), (wide, tall): (f64, f64), mode: Mode) {
    let (letter, ink): (&str, Colour) = match mode {
        Mode::Free => ("f", GREY),
        Mode::Sliding => ("s", BLACK),
        Mode::Fixed => ("x", (255, 255, 255)),
    };
    sheet.bar((x, y), (wide, tall), (190, 190, 190));
    sheet.bar((x + 0.5, y + 0.5), (wide - 1.0, tall - 1.0), colour(mode));
    let middle = (x + 0.5 * wide, y + 0.5 * tall);
    sheet.text(middle, letter, SMALL, ink, Anchor::Middle);
}
