//! The slave-node table: the values of every slave node in the shown minor iteration.

use crate::app::App;
use crate::columns::rows_shown;
use crate::copied;
use crate::layout::Pane;
use crate::paint;
use crate::pane_entry::{PaneEntry, frame};
use crate::theme::Theme;
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};
use stickslip_core::{ContactRecord, Forced, Mode, TestedQuantity};
use stickslip_debugger::RoundOff;
use stickslip_debugger::action::{self, Filter, Sort};
use stickslip_debugger::explain::tested::Dimension;
use stickslip_scene::number;
use stickslip_scene::shown;
use unicode_width::UnicodeWidthStr;

/// Widths of the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Columns {
    name: usize,
    /// Whether modes are words instead of letters.
    words: bool,
    /// Width of each number.
    number: usize,
    /// Width of the ratio.
    ratio: usize,
    /// How many of gap, F_n, F_t, T_max, ratio and slip are shown.
    shown: usize,
    /// Whether pressure and shear are shown.
    pressures: bool,
    /// Whether the angle between F_t and slip is shown.
    angle: bool,
}

/// Width of the three marks: selected, changed, forced.
const MARKS: usize = 3;
/// Width of the angle between F_t and slip, with a blank before it.
const ANGLE: usize = 6;
/// Width of `sliding → sliding`.
const WORDS: usize = 17;
/// Width of `s→x`.
const LETTERS: usize = 3;

impl Columns {
    /// The widest arrangement that fits: modes become letters first, then numbers lose digits, then columns are left out.
    fn fit(width: usize, name: usize) -> Self {
        let arrangements = [
            (true, 13, 13),
            (true, 12, 9),
            (true, 11, 9),
            (false, 11, 9),
            (false, 10, 9),
            (false, 9, 8),
        ];
        let last = Columns {
            name,
            words: false,
            number: 9,
            ratio: 8,
            shown: 6,
            pressures: false,
            angle: false,
        };
        let wide = arrangements.map(|(words, number, ratio)| Columns {
            words,
            number,
            ratio,
            ..last
        });
        let fewer = (0..6).rev().map(|shown| Columns { shown, ..last });
        wide.into_iter()
            .chain(fewer)
            .find(|columns| columns.width() <= width)
            .unwrap_or(Columns { shown: 0, ..last })
    }

    /// Adds pressure and shear if they fit.
    fn with_pressures(self, width: usize) -> Self {
        let pressures = self.shown == 6 && self.width() + 2 * self.number < width;
        Columns { pressures, ..self }
    }

    fn modes(&self) -> usize {
        if self.words { WORDS } else { LETTERS }
    }

    fn width(&self) -> usize {
        let ratio = if self.shown > 4 { self.ratio } else { 0 };
        let numbers = self.shown - usize::from(self.shown > 4);
        // The last number needs no gap after it.
        MARKS + self.name + 1 + self.modes() + 1 + numbers * self.number + ratio
            - usize::from(self.shown > 0)
    }
}

/// The pane.
pub const PANE: PaneEntry = PaneEntry {
    draw,
    actions: &[],
    copied: copied::row,
    is_ahead: false,
};

/// Draws the table.
fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let count = view.model.contacts.len();
    let selected = app.slave(view);
    let order = app.order(view);
    let at = order
        .iter()
        .position(|slave| *slave == selected)
        .unwrap_or(0);
    let title = title(at, order.len(), count, app);
    let inner = frame(buffer, area, Pane::Nodes, &title, app);
    if count == 0 {
        paint::note(buffer, inner, "This scene has no slave nodes.", &app.theme);
        return;
    }
    let longest = (0..count)
        .map(|slave| view.slave(slave).width())
        .max()
        .unwrap_or(0);
    let in_space = view.model.space.is_some();
    // The last number needs a gap after it then.
    let spare = if in_space { ANGLE + 1 } else { 0 };
    let columns = Columns {
        angle: in_space,
        ..Columns::fit(
            (inner.width as usize).saturating_sub(spare),
            longest.clamp(4, 20),
        )
    };
    let columns = if view
        .model
        .contacts
        .iter()
        .any(|contact| contact.area.is_some())
    {
        columns.with_pressures(inner.width as usize)
    } else {
        columns
    };
    let rows = (inner.height as usize).saturating_sub(1);
    let round_off = view.round_off();
    let top = rows_shown(rows, at, order.len()).start;
    let mut lines = vec![match view.model.finished {
        None => headings(&columns, app),
        Some(_) => Line::styled(format!("{:MARKS$}contact", ""), app.theme.heading),
    }];
    lines.extend(
        order
            .iter()
            .skip(top)
            .take(rows)
            .map(|&slave| row(slave, slave == selected, &columns, &round_off, app, view)),
    );
    paint::lines(buffer, inner, &lines);
}

/// The slave node in the row at a screen position.
pub fn slave_at(area: Rect, app: &App, view: &View, at: Position) -> Option<usize> {
    let order = app.order(view);
    let selected = app.slave(view);
    let here = order.iter().position(|slave| *slave == selected);
    // Border and headings.
    let rows = usize::from(area.height).saturating_sub(3);
    let row = usize::from(at.y).checked_sub(usize::from(area.y) + 2)?;
    let top = rows_shown(rows, here.unwrap_or(0), order.len()).start;
    let inside = row < rows && at.x > area.x && at.x + 1 < area.right();
    order.get(top + row).copied().filter(|_| inside)
}

/// Title: the selected node, the number of nodes shown, the filter and the sort order.
fn title(at: usize, shown: usize, count: usize, app: &App) -> String {
    if count < 2 {
        return "Slave nodes".into();
    }
    let mut title = format!("Slave nodes  {}/{shown}", at + 1);
    title += &match app.filter {
        Filter::All => String::new(),
        Filter::Active => format!(" active, of {count}"),
        Filter::Surface => format!(" on this surface, of {count}"),
        filter => format!(" {}, of {count}", filter.word()),
    };
    title += &match app.sort {
        Sort::Scene => String::new(),
        sort => format!("  by {}", sort.word()),
    };
    if app.backward {
        title += ", reversed";
    }
    title
}

fn headings(columns: &Columns, app: &App) -> Line<'static> {
    let modes = if columns.words {
        "mode → next"
    } else {
        "m→n"
    };
    let ratio = if columns.ratio > 11 {
        "|F_t|/T_max"
    } else {
        "ratio"
    };
    let names = [" gap", " F_n", " F_t", " T_max", ratio, " slip"];
    let mut text = format!(
        "{:MARKS$}{:<name$} {:<mode$} ",
        "",
        "node",
        modes,
        name = columns.name,
        mode = columns.modes()
    );
    for (index, name) in names.iter().take(columns.shown).enumerate() {
        let width = if index == 4 {
            columns.ratio
        } else {
            columns.number
        };
        text += &format!("{name:<width$}");
    }
    if columns.pressures {
        text += &format!(" {:<width$}{}", " F_n/A", " F_t/A", width = columns.number);
    }
    if columns.angle {
        text += &format!("{:>ANGLE$}", "angle");
    }
    Line::styled(text, app.theme.heading)
}

fn row<'a>(
    slave: usize,
    selected: bool,
    columns: &Columns,
    round_off: &RoundOff,
    app: &App,
    view: &View<'a>,
) -> Line<'a> {
    let theme = &app.theme;
    let record = view.record(slave);
    let hidden = app.learning.hides(view, slave);
    let changed = !hidden && view.mode_before(slave) != view.mode(slave);
    let differs = !hidden && view.differs(slave);
    let name_style = match (selected, changed) {
        (true, _) => theme.selected,
        (_, true) => theme.strong,
        _ => theme.text,
    };
    let mut spans = vec![
        paint::cursor(selected, theme),
        Span::styled(
            change_mark(differs, changed, !hidden && view.t_max_moves(slave)),
            theme.strong,
        ),
        forced_mark(view.forced(slave), theme),
        Span::styled(fitted(view.slave(slave), columns.name), name_style),
        Span::raw(" "),
    ];
    if view.is_finished() {
        let words = view.words(slave).unwrap_or_default();
        spans.push(Span::styled(words, theme.mode(view.mode_before(slave))));
        return Line::from(spans);
    }
    spans.extend(modes(slave, changed, columns, app, view));
    spans.push(Span::raw(" "));
    if let Some(record) = record {
        spans.extend(numbers(record, round_off, columns, app, view));
        if columns.pressures {
            let forces = [record.f_n, record.f_t].map(|force| round_off.force(force));
            let found = view.model.contacts[slave].pressure(forces[0], forces[1]);
            let message = found.map_or([String::new(), String::new()], |both| {
                both.map(|value| view.cell(value, columns.number))
            });
            let text = format!(
                " {:<width$}{}",
                message[0],
                message[1],
                width = columns.number
            );
            spans.push(Span::styled(text, theme.text));
        }
        if columns.angle {
            let angle = record
                .deviation()
                .map(|angle| format!("{:.0}°", angle.to_degrees()));
            let text = format!("{:>ANGLE$}", angle.unwrap_or_default());
            spans.push(Span::styled(text, theme.text));
        }
    }
    Line::from(spans)
}

/// `≠` if an attached solver's decision differs from its rules, `*` if the mode changes, `~` if T_max has not settled.
fn change_mark(differs: bool, changed: bool, t_max_moves: bool) -> &'static str {
    match (differs, changed, t_max_moves) {
        (true, ..) => "≠",
        (_, true, _) => "*",
        (.., true) => "~",
        _ => " ",
    }
}

/// `◆` if the user holds the mode, `◇` if it is forced once.
fn forced_mark(forced: Forced, theme: &Theme) -> Span<'static> {
    match forced {
        Forced::Held(_) => Span::styled("◆", theme.warning),
        Forced::Once(_) => Span::styled("◇", theme.warning),
        Forced::No => Span::raw(" "),
    }
}

/// The previous and next mode, as words or letters, padded to the column.
fn modes(
    slave: usize,
    changed: bool,
    columns: &Columns,
    app: &App,
    view: &View,
) -> Vec<Span<'static>> {
    let spell = if columns.words {
        Mode::word
    } else {
        action::letter
    };
    let style = |mode| {
        if changed {
            app.theme.mode(mode).add_modifier(Modifier::BOLD)
        } else {
            app.theme.mode(mode)
        }
    };
    let (before, next) = (view.mode_before(slave), view.mode(slave));
    let arrow = if columns.words { " → " } else { "→" };
    let hidden = app.learning.hides(view, slave);
    let (first, second) = (spell(before), if hidden { "?" } else { spell(next) });
    let next_style = if hidden {
        app.theme.strong
    } else {
        style(next)
    };
    let used = first.width() + arrow.width() + second.width();
    let arrow_style = if changed {
        app.theme.strong
    } else {
        app.theme.faint
    };
    vec![
        Span::styled(first, style(before)),
        Span::styled(arrow, arrow_style),
        Span::styled(second, next_style),
        Span::raw(" ".repeat(columns.modes().saturating_sub(used))),
    ]
}

fn numbers(
    record: &ContactRecord,
    round_off: &RoundOff,
    columns: &Columns,
    app: &App,
    view: &View,
) -> Vec<Span<'static>> {
    // The value that changed the mode is shown exactly, even within round-off.
    let decided = |tested: TestedQuantity| {
        let mut tests = record.decision.tests.iter().flatten();
        record.decision.changes() && tests.any(|test| test.tested == tested)
    };
    let cell = |value| view.cell(value, columns.number);
    let number = |value: f64, tested: TestedQuantity| match Dimension::from(tested) {
        _ if decided(tested) => cell(value),
        Dimension::Force => cell(round_off.force(value)),
        _ => cell(round_off.length(value)),
    };
    let ratio = match decided(TestedQuantity::ShearForce) {
        _ if view.is_unreported(record.f_t / record.t_max) => number::UNREPORTED.into(),
        true => number::ratio(record.f_t, record.t_max),
        // Round-off of a force over no friction is no ratio.
        false if record.decision.before == Mode::Free && record.t_max == 0.0 => "–".into(),
        // T_max is settled to the tolerance, and so is its ratio to the force of a sliding node.
        false if is_at_limit(record, view) => "1".into(),
        false => round_off.ratio(record.f_t, record.t_max),
    };
    let texts = [
        number(record.gap, TestedQuantity::Gap),
        number(record.f_n, TestedQuantity::NormalForce),
        number(record.f_t, TestedQuantity::ShearForce),
        number(record.t_max, TestedQuantity::ShearForce),
        format!("{ratio:<width$}", width = columns.ratio),
        number(record.slip, TestedQuantity::Slip),
    ];
    let style = |index: usize| number_style(index, record, app);
    texts
        .into_iter()
        .take(columns.shown)
        .enumerate()
        .map(|(index, text)| Span::styled(text, style(index)))
        .collect()
}

/// Whether a sliding node carries T_max to within the tolerance.
fn is_at_limit(record: &ContactRecord, view: &View) -> bool {
    let scale = view.event().map_or(0.0, |event| event.before.scale);
    let tolerance = view.frame().state.controls.settings.tolerance * scale;
    let sizes = [record.f_t, record.t_max].map(|force| view.round_off().force(force).abs());
    record.decision.before == Mode::Sliding
        && sizes[1] > 0.0
        && (sizes[0] - sizes[1]).abs() <= tolerance
}

/// Highlights tested values that are ties.
fn number_style(column: usize, record: &ContactRecord, app: &App) -> Style {
    let tested = match column {
        0 => TestedQuantity::Gap,
        1 => TestedQuantity::NormalForce,
        2 | 4 => TestedQuantity::ShearForce,
        5 => TestedQuantity::Slip,
        _ => return app.theme.text,
    };
    if record
        .decision
        .tests
        .iter()
        .flatten()
        .any(|test| test.tested == tested && record.is_tie(test))
    {
        app.theme.warning
    } else {
        app.theme.text
    }
}

/// A name cut or padded to a width, with `…` in place of the rest.
fn fitted(name: &str, width: usize) -> String {
    shown::padded(&paint::cut(name, width), width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eighty_columns_keep_every_number() {
        assert_eq!(
            Columns::fit(78, 6),
            Columns {
                name: 6,
                words: false,
                number: 11,
                ratio: 9,
                shown: 6,
                pressures: false,
                angle: false,
            }
        );
        assert_eq!(Columns::fit(118, 8).number, 13);
        assert_eq!(Columns::fit(20, 8).shown, 0);
        assert_eq!(Columns::fit(0, 20).shown, 0);
    }

    #[test]
    fn pressures_have_columns_where_there_is_room_for_them() {
        assert!(!Columns::fit(78, 6).with_pressures(78).pressures);
        assert!(Columns::fit(160, 6).with_pressures(160).pressures);
    }

    #[test]
    fn the_selection_is_always_visible() {
        for count in [1, 5, 300] {
            for rows in [1, 4, 10] {
                for selected in 0..count {
                    let top = rows_shown(rows, selected, count).start;
                    assert!(top <= selected && selected < top + rows);
                }
            }
        }
    }

    #[test]
    fn names_are_cut_to_the_column() {
        assert_eq!(fitted("beam.5", 8), "beam.5  ");
        assert_eq!(fitted("a-long-name", 6), "a-lon…");
    }
}
