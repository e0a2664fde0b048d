//! Figures of convergence maps: one bar per strategy for random problems, a grid of cells for scenes.

use super::drawn::PlotError;
use super::map::{Map, Panel};
use super::reason::Reason;
use super::sheet::{Anchor, BLACK, Colour, GREY, LABEL, MARGIN, PALE, SMALL, Sheet, widest};
use super::survey::{Survey, Tally};
use super::verdict::RunVerdict;

/// Height of a row of bars or cells.
const ROW: f64 = 28.0;
/// Length of a bar of 1,000 problems.
const BAR: f64 = 560.0;
/// Width of a cell with two letters.
const CELL: f64 = 44.0;
/// Positions of the numbers of problems without a solution, right of the bars.
const NONE: (f64, f64) = (430.0, 470.0);
const WHITE: Colour = (255, 255, 255);

fn colour(verdict: RunVerdict) -> Colour {
    match verdict {
        RunVerdict::Right => (0, 158, 115),
        RunVerdict::Wrong => (213, 94, 0),
        RunVerdict::Cycle { .. } => (230, 159, 0),
        RunVerdict::Diverged => (204, 121, 167),
        RunVerdict::NoAnswer => (86, 180, 233),
        RunVerdict::Failed(_) => (60, 60, 60),
    }
}

/// Every kind of verdict once, as in the legend.
const KINDS: [(RunVerdict, &str); 6] = [
    (RunVerdict::Right, "converged"),
    (RunVerdict::Wrong, "wrong branch or state"),
    (
        RunVerdict::Cycle {
            period: 0,
            majors: false,
        },
        "cycle, with its period",
    ),
    (RunVerdict::Diverged, "diverged"),
    (RunVerdict::NoAnswer, "reported unsolvable"),
    (RunVerdict::Failed(Reason::MinorLimit), "other failure"),
];

/// Draws the legend, wrapped.
fn legend(sheet: &mut Sheet) -> Result<(), PlotError> {
    let (mut x, mut y) = (MARGIN, sheet.height + 0.5 * ROW);
    for (verdict, words) in KINDS {
        let width = 30.0 + widest([words], SMALL)? + MARGIN;
        if x + width > sheet.width && x > MARGIN {
            (x, y) = (MARGIN, y + ROW);
        }
        letter(
            sheet,
            (x, y - 10.0),
            (22.0, 20.0),
            verdict,
            &verdict.glyph().to_string(),
        );
        sheet.text((x + 28.0, y), words, SMALL, BLACK, Anchor::Left);
        x += width;
    }
    sheet.height = y + ROW;
    Ok(())
}

/// Text colour with good contrast on a background, also in greyscale.
fn ink((r, g, b): Colour) -> Colour {
    let light = 0.3 * f64::from(r) + 0.6 * f64::from(g) + 0.1 * f64::from(b);
    if light > 115.0 { BLACK } else { WHITE }
}

/// Draws a coloured rectangle with text in it.
fn letter(sheet: &mut Sheet, at: (f64, f64), size: (f64, f64), verdict: RunVerdict, text: &str) {
    sheet.bar(at, size, colour(verdict));
    let middle = (at.0 + 0.5 * size.0, at.1 + 0.5 * size.1);
    sheet.text(middle, text, LABEL, ink(colour(verdict)), Anchor::Middle);
}

/// Bars for random problems: for each strategy the verdicts per 1,000 problems with a solution, and on those
/// without.
///
/// # Errors
/// If the font cannot be read.
pub fn bars(survey: &Survey) -> Result<Sheet, PlotError> {
    let tallies: Vec<Tally> = (0..survey.variants.len())
        .map(|v| survey.tally(v, |_| true))
        .collect();
    let variants = &survey.variants;
    let names = variants.iter().map(|v| v.name.as_str());
    let left = MARGIN + widest(names, LABEL)? + MARGIN;
    let numbers = left + BAR + MARGIN;
    let (some, none) = tallies
        .first()
        .map_or((0, 0), |t| (t.solvable, t.unsolvable));
    let title =
        format!("Random interface problems by strategy, per 1,000 of {some} with a solution");
    let mut sheet = Sheet::new(numbers + NONE.1 + MARGIN, &title)?;
    let y = sheet.height + 0.5 * ROW;
    let heads = ["✓", "≠", "↺", "✗", "∅"].iter().enumerate();
    for (k, head) in heads {
        let x = numbers + 52.0 * (k + 1) as f64;
        sheet.text((x, y), head, LABEL, BLACK, Anchor::Right);
    }
    let head = format!("of {none} without: ∅");
    sheet.text((numbers + NONE.0, y), &head, LABEL, BLACK, Anchor::Right);
    sheet.text((numbers + NONE.1, y), "≠", LABEL, BLACK, Anchor::Right);
    sheet.height += ROW;
    for (variant, tally) in variants.iter().zip(&tallies) {
        let y = sheet.height;
        sheet.text(
            (left - MARGIN / 2.0, y + 0.5 * ROW),
            &variant.name,
            LABEL,
            BLACK,
            Anchor::Right,
        );
        sheet.bar((left, y + 3.0), (BAR, ROW - 6.0), PALE);
        let parts = [
            tally.solved,
            tally.wrong,
            tally.cycled,
            tally.failed,
            tally.denied,
        ];
        let kinds = [0, 1, 2, 5, 4].map(|k| KINDS[k].0);
        let mut x = left;
        for (k, (part, verdict)) in parts.into_iter().zip(kinds).enumerate() {
            let thousand = tally.per_thousand(part);
            let width = BAR * thousand / 1000.0;
            let text = if width > 18.0 {
                verdict.glyph().to_string()
            } else {
                String::new()
            };
            letter(&mut sheet, (x, y + 3.0), (width, ROW - 6.0), verdict, &text);
            let at = (numbers + 52.0 * (k + 1) as f64, y + 0.5 * ROW);
            sheet.text(at, &format!("{thousand:.1}"), SMALL, BLACK, Anchor::Right);
            x += width;
        }
        for (x, count) in [(NONE.0, tally.admitted), (NONE.1, tally.invented)] {
            let at = (numbers + x, y + 0.5 * ROW);
            sheet.text(at, &count.to_string(), SMALL, BLACK, Anchor::Right);
        }
        sheet.height += ROW;
    }
    sheet.height += 0.5 * ROW;
    legend(&mut sheet)?;
    sheet.paragraph(&survey.origin(), SMALL, GREY)?;
    Ok(sheet)
}

/// Grids of cells for scenes, one per panel.
///
/// # Errors
/// If the font cannot be read.
pub fn grid(map: &Map) -> Result<Sheet, PlotError> {
    let panels = map.panels();
    let rows = panels.iter().flat_map(|p| &p.rows).map(String::as_str);
    let left = 2.5 * MARGIN + widest(rows, SMALL)? + MARGIN;
    let columns = panels.iter().flat_map(|p| &p.columns).map(String::as_str);
    let cell = CELL.max(widest(columns, SMALL)? + 10.0);
    let most = panels.iter().map(|p| p.columns.len()).max().unwrap_or(0);
    let width = (left + cell * most as f64 + 2.0 * MARGIN).max(640.0);
    let mut sheet = Sheet::new(width, &map.title)?;
    for panel in &panels {
        draw_panel(&mut sheet, map, panel, left, cell)?;
    }
    legend(&mut sheet)?;
    sheet.paragraph(&map.signs().into_iter().collect::<Vec<_>>(), SMALL, BLACK)?;
    sheet.paragraph(&map.origin(), SMALL, GREY)?;
    Ok(sheet)
}

fn draw_panel(
    sheet: &mut Sheet,
    map: &Map,
    panel: &Panel,
    left: f64,
    cell: f64,
) -> Result<(), PlotError> {
    if !panel.name.is_empty() {
        sheet.paragraph(std::slice::from_ref(&panel.name), LABEL, BLACK)?;
    }
    let top = sheet.height;
    for (i, row) in panel.rows.iter().enumerate() {
        let y = top + ROW * i as f64;
        let at = (left - MARGIN / 2.0, y + 0.5 * ROW);
        sheet.text(at, row, SMALL, BLACK, Anchor::Right);
        for (j, &case) in panel.cells[i].iter().enumerate() {
            let at = (left + cell * j as f64 + 1.0, y + 1.0);
            let size = (cell - 2.0, ROW - 2.0);
            match map.cells[case].as_ref() {
                Some(found) => letter(sheet, at, size, found.verdict, &found.label()),
                None => sheet.bar(at, size, PALE),
            }
        }
    }
    let bottom = top + ROW * panel.rows.len() as f64;
    let middle = (MARGIN, 0.5 * (top + bottom));
    sheet.upright(middle, &panel.y, SMALL);
    for (j, column) in panel.columns.iter().enumerate() {
        let at = (left + cell * (j as f64 + 0.5), bottom + 0.5 * LABEL);
        sheet.text(at, column, SMALL, BLACK, Anchor::Middle);
    }
    let below = (
        left + 0.5 * cell * panel.columns.len() as f64,
        bottom + 1.7 * LABEL,
    );
    sheet.text(below, &panel.x, SMALL, BLACK, Anchor::Middle);
    sheet.height = bottom + 3.0 * LABEL;
    Ok(())
}
