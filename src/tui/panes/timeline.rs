//! The timeline: slave nodes by minor iterations, with a letter for each mode; in space, sliding nodes have an arrow for the
//! direction of friction.
//!
//! Rules separate majors and increments, a bracket marks a cycle, and forced modes are lower-case letters. Only the columns around
//! the cursor are computed, so that drawing does not depend on the length of the history.

use crate::app::App;
use crate::columns::{self, Column, rows_shown};
use crate::layout::Pane;
use crate::paint;
use crate::pane_entry::{PaneEntry, frame};
use crate::view::View;
use PointKind::*;
use ratatui::buffer::Buffer;
use ratatui::layout::{Margin, Position, Rect};
use ratatui::style::{Modifier, Style};
use std::ops::Range;
use stickslip_core::{Failure, Mode, Outcome};
use stickslip_debugger::explain::names;
use stickslip_debugger::{PointKind, Strip};
use unicode_width::UnicodeWidthStr;

/// Rows besides nodes: increments, majors, the cursor, outcomes, brackets.
pub const FRAME: u16 = 5;
/// Legend of a finished run's letters.
const LETTERS: &str =
    " C closed  · open  M other face  1-9 tenths of a face  lower case: held fixed ";
/// Minimum and maximum width of the names.
const NAME: Range<usize> = 9..14;

/// The pane.
pub const PANE: PaneEntry = PaneEntry {
    draw,
    actions: &[("left", "back"), ("right", "forward")],
    copied: |_, view| Ok(("a command".into(), format!("goto {}", view.cursor))),
    is_ahead: true,
};

/// Draws the timeline.
fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let theme = &app.theme;
    let strips = view.strips;
    let mut title = title(view);
    let count = view.model.contacts.len();
    let selected = app.slave(view);
    let rows = usize::from(area.height.saturating_sub(2 + FRAME));
    if rows < count {
        title += &format!("  node {} of {count}, folded", selected + 1);
    }
    let inner = frame(buffer, area, Pane::Timeline, &title, app);
    if view.is_finished() && area.height > 2 {
        let legend = paint::cut(LETTERS, inner.width.into());
        buffer.set_string(inner.x, area.bottom() - 1, legend, theme.faint);
    }
    if strips.is_empty() || inner.height <= FRAME {
        return;
    }
    let (left, columns) = visible(inner, view);
    let name = usize::from(left - inner.x);
    let folded = folded(rows, &columns, app, view);
    let shown = rows_shown(rows, row_of(selected, &folded), folded.len());
    let shown = &folded[shown];
    let nodes = inner.y + 3;
    let below = nodes + shown.len() as u16;

    let finished = view.is_finished();
    let second = if finished { "attempt" } else { "major" };
    for (y, text) in [(0, "increment"), (1, second)] {
        buffer.set_string(inner.x + 1, inner.y + y, text, theme.faint);
    }
    headings(buffer, inner, &columns, view, theme.heading);
    for (row, slaves) in shown.iter().enumerate() {
        let (mark, style) = if slaves.contains(&selected) {
            ("▸", theme.selected)
        } else {
            (" ", theme.text)
        };
        let y = nodes + row as u16;
        buffer.set_string(inner.x, y, mark, theme.focus);
        let text = paint::cut(&row_name(slaves, view), name - 2);
        buffer.set_string(inner.x + 1, y, text, style);
    }
    for column in &columns {
        let strip = &strips[column.at];
        let here = column.at == view.cursor;
        let reversed = |style: Style| {
            if here {
                style.add_modifier(Modifier::REVERSED)
            } else {
                style
            }
        };
        if here {
            buffer.set_string(column.x, nodes - 1, "▼", theme.focus);
        }
        if let Some(rule) = rule(view, column.at)
            && column.x > left
        {
            for y in inner.y + 1..below {
                buffer.set_string(column.x - 1, y, rule, theme.faint);
            }
        }
        for (row, slaves) in shown.iter().enumerate() {
            let (letter, style) = cell(strip, slaves.start, finished, app);
            buffer.set_string(column.x, nodes + row as u16, letter, reversed(style));
        }
        // Only attached solvers differ from their rules, and they have no cycle brackets in this row.
        if (0..count).any(|slave| strip.differs(slave)) {
            buffer.set_string(column.x, below + 1, "≠", theme.warning);
        }
        let (end, style) = end(strip.kind, app);
        buffer.set_string(column.x, below, end, style);
    }
    brackets(buffer, inner, below + 1, &columns, app, view);
}

/// Screen column of the first iteration, and the visible iterations.
fn visible(inner: Rect, view: &View) -> (u16, Vec<Column>) {
    let count = view.model.contacts.len();
    let names = (0..count).map(|slave| view.slave(slave).width());
    let name = names.max().unwrap_or(0);
    // A folded row has two names.
    let name = if usize::from(inner.height.saturating_sub(FRAME)) < count {
        (2 * name + 3).clamp(NAME.start, 2 * NAME.end)
    } else {
        name.clamp(NAME.start, NAME.end)
    };
    let name = name + 2;
    let left = inner.x + name as u16;
    let room = usize::from(inner.right().saturating_sub(left));
    let ruled = |at: usize| rule(view, at).is_some();
    let shown = columns::around(view.strips.len(), view.cursor, left, room, ruled);
    (left, shown)
}

/// The area inside the frame, if it is not empty.
fn inside(area: Rect, view: &View) -> Option<Rect> {
    let inner = area.inner(Margin::new(1, 1));
    (!view.strips.is_empty() && inner.height > FRAME).then_some(inner)
}

/// The step of the branch in the column at a screen position.
pub fn step_at(area: Rect, view: &View, at: Position) -> Option<usize> {
    let inner = inside(area, view).filter(|inner| inner.contains(at))?;
    let (_, columns) = visible(inner, view);
    let column = columns.into_iter().rev().find(|column| column.x <= at.x);
    column.map(|column| column.at)
}

/// The slave node in the row at a screen position.
pub fn slave_at(area: Rect, app: &App, view: &View, at: Position) -> Option<usize> {
    let inner = inside(area, view).filter(|inner| inner.contains(at))?;
    let rows = usize::from(inner.height - FRAME);
    let row = usize::from(at.y).checked_sub(usize::from(inner.y) + 3)?;
    let folded = folded(rows, &visible(inner, view).1, app, view);
    let shown = rows_shown(rows, row_of(app.slave(view), &folded), folded.len());
    folded[shown].get(row).map(|slaves| slaves.start)
}

/// The slave nodes in rows: one each if all fit, or neighbours with the same cells in all visible columns together.
fn folded(rows: usize, columns: &[Column], app: &App, view: &View) -> Vec<Range<usize>> {
    let count = view.model.contacts.len();
    let finished = view.is_finished();
    let alike = |one: usize, other: usize| {
        columns.iter().all(|column| {
            let strip = &view.strips[column.at];
            // Faster than two cells.
            strip.is_alike(one, other)
                || cell(strip, one, finished, app) == cell(strip, other, finished, app)
        })
    };
    let mut all: Vec<Range<usize>> = Vec::new();
    for slave in 0..count {
        match all.last_mut() {
            Some(last) if rows < count && alike(last.start, slave) => last.end = slave + 1,
            _ => all.push(slave..slave + 1),
        }
    }
    all
}

/// The row of a slave node.
fn row_of(slave: usize, folded: &[Range<usize>]) -> usize {
    folded.partition_point(|slaves| slaves.end <= slave)
}

/// The names in a row: one, or the first and the last.
fn row_name(slaves: &Range<usize>, view: &View) -> String {
    let (first, last) = (view.slave(slaves.start), view.slave(slaves.end - 1));
    match slaves.len() {
        1 => first.to_owned(),
        _ => format!("{first} … {last}"),
    }
}

fn title(view: &View) -> String {
    let Some(strip) = view.strips.get(view.cursor) else {
        return "Timeline".into();
    };
    let at = strip.position;
    let what = match strip.kind {
        Start => "start".into(),
        _ if view.is_finished() => names::position_in(view.model, at),
        Intervention => "an intervention".into(),
        kind => format!(
            "increment {}, major {}, minor {}{}",
            at.increment,
            at.major,
            at.minor,
            match kind {
                Jumped | LastJumped => ", jumped",
                _ => "",
            }
        ),
    };
    let last = view.strips.len() - 1;
    format!("Timeline  step {} of {last}: {what}", view.cursor)
}

/// The rule before an iteration: double between increments, single between majors (in a finished run, between attempts).
fn rule(view: &View, at: usize) -> Option<&'static str> {
    let before = view.strips.get(at.checked_sub(1)?)?;
    let (then, now) = (before.position, view.strips[at].position);
    let of = |at: stickslip_core::step::event::Position| (at.increment, at.attempt);
    match before.kind == Start {
        false if view.is_finished() => {
            if then.increment == now.increment {
                (then.attempt != now.attempt).then_some("│")
            } else {
                Some("║")
            }
        }
        true => None,
        false if of(then) != of(now) => Some("║"),
        false => (then.major != now.major).then_some("│"),
    }
}

/// Numbers of increments and majors (in a finished run, attempts) above their first columns.
fn headings(buffer: &mut Buffer, inner: Rect, shown: &[Column], view: &View, style: Style) {
    let finished = view.is_finished();
    columns::headings(buffer, inner, shown, style, |at| {
        let now = view.strips[at].position;
        let mut name = view.model.increment_name(now.increment);
        // In a finished run the step is named only at its first increment and in the leftmost column.
        let leftmost = shown.first().is_some_and(|first| first.at == at);
        if let Some((_, number)) = name.split_once('.').filter(|(_, n)| *n != "1" && !leftmost) {
            name = number.to_owned();
        }
        let attempt = if finished { 1 } else { now.attempt };
        let second = if finished { now.attempt } else { now.major };
        let increment = (now.increment, attempt);
        [
            ((increment, 0), name),
            ((increment, second), second.to_string()),
        ]
    });
}

/// The letter of a node's mode in an iteration, V for a node fixed in a corner; lower case if it was forced.
fn cell(strip: &Strip, slave: usize, finished: bool, app: &App) -> (&'static str, Style) {
    let (mode, forced) = (strip.before(slave), strip.is_forced(slave));
    if strip.kind == Intervention && !forced {
        return ("·", app.theme.faint);
    }
    match strip.letter(slave) {
        Some(letter) => return finished_cell(strip, slave, letter, app),
        None if finished => return (" ", app.theme.faint),
        None => {}
    }
    let letter = match (mode, forced) {
        (Mode::Free, false) => "F",
        (Mode::Sliding, false) => strip
            .direction(slave)
            .map_or("S", |degrees| names::arrow(f64::from(degrees).to_radians())),
        (Mode::Fixed, false) if strip.in_corner(slave) => "V",
        (Mode::Fixed, false) => "X",
        (Mode::Free, true) => "f",
        (Mode::Sliding, true) => "s",
        (Mode::Fixed, true) if strip.in_corner(slave) => "v",
        (Mode::Fixed, true) => "x",
    };
    let mut style = app.theme.mode(mode);
    if strip.differs(slave) {
        style = style.patch(app.theme.warning);
    }
    if strip.changes(slave) {
        style = style.add_modifier(Modifier::BOLD);
    }
    if forced {
        style = style.add_modifier(Modifier::UNDERLINED);
    }
    (letter, style)
}

/// The letter of a contact in a finished run.
fn finished_cell(strip: &Strip, slave: usize, letter: u8, app: &App) -> (&'static str, Style) {
    const DIGITS: [&str; 10] = ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9"];
    let (letter, mode) = match letter {
        b'C' => ("C", Mode::Fixed),
        b'c' => ("c", Mode::Fixed),
        b'M' => ("M", Mode::Sliding),
        b'm' => ("m", Mode::Sliding),
        b'0'..=b'9' => (DIGITS[usize::from(letter - b'0')], Mode::Fixed),
        b'.' => ("·", Mode::Free),
        _ => ("?", Mode::Free),
    };
    let style = app.theme.mode(mode);
    if strip.changes(slave) {
        (letter, style.add_modifier(Modifier::BOLD))
    } else {
        (letter, style)
    }
}

/// Glyph of an iteration's outcome.
fn end(kind: PointKind, app: &App) -> (&'static str, Style) {
    let theme = &app.theme;
    match kind {
        Start => ("┊", theme.faint),
        Minor => (" ", theme.faint),
        Intervention => ("◇", theme.warning),
        Damped | Cut => ("½", theme.warning),
        Climbed => ("⇑", theme.warning),
        Refused => ("⊘", theme.warning),
        Major => ("▸", theme.faint),
        Increment | Last => ("✓", theme.good),
        Jumped | LastJumped => ("↯", theme.warning),
        Cycle => ("↺", theme.bad),
        Failed => ("✗", theme.bad),
    }
}

/// Brackets under the last periods of cycles that end in a column, and under the first ones of a finished run's.
fn brackets(buffer: &mut Buffer, inner: Rect, y: u16, columns: &[Column], app: &App, view: &View) {
    let ended = columns.iter().filter_map(|column| {
        let frame = &view.frames[column.at];
        let event = frame
            .event
            .as_ref()
            .filter(|_| frame.intervention.is_none());
        let (Outcome::Failed(Failure::Cycle(cycle))
        | Outcome::Damped { cycle, .. }
        | Outcome::StrategyChange {
            why: Failure::Cycle(cycle),
            ..
        }) = &event?.outcome
        else {
            return None;
        };
        let end = column.at + 1;
        Some(end.saturating_sub(cycle.period as usize)..end)
    });
    let finished = view.model.finished.iter().flat_map(|run| &run.cycles);
    // Step 0 is the start, before the first iteration.
    let finished = finished.map(|cycle| cycle.start + 1..cycle.end + 1);
    let mut free = inner.x;
    for steps in ended.chain(finished) {
        let mut shown = columns.iter().filter(|column| steps.contains(&column.at));
        let Some(from) = shown.next() else { continue };
        if view.is_finished() && from.x < free {
            continue;
        }
        let to = shown.next_back().unwrap_or(from).x;
        let text = format!("{}-cycle", steps.len());
        columns::bracket(buffer, inner.right(), y, (from.x, to), &text, app.theme.bad);
        free = to + 3 + text.len() as u16;
    }
}
