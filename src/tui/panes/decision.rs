//! The decision on the selected node: Table 2 with the cell that fired, and the tested inequalities with their values.

use crate::app::App;
use crate::copied::value;
use crate::layout::Pane;
use crate::paint;
use crate::pane_entry::{PaneEntry, frame};
use crate::theme::Theme;
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};
use stickslip_core::contact::record::SideForce;
use stickslip_core::model::TieRule;
use stickslip_core::{ContactRecord, Decision, Forced, Mode, Rule, Test, TestedQuantity};
use stickslip_debugger::explain::bond;
use stickslip_debugger::explain::influence::Influence;
use stickslip_debugger::explain::names::{self, MODES, TABLE_2};
use stickslip_debugger::explain::report;
use stickslip_debugger::explain::reported_pushes;
use stickslip_debugger::explain::round_off::NOTE;
use stickslip_debugger::explain::tested::{self, Dimension};
use stickslip_debugger::{NodePush, WatchQuantity};
use stickslip_scene::number::{self, shortest, sig4};
use unicode_width::UnicodeWidthStr;

/// Width of the row headings.
const LABEL: usize = 9;
/// Width of the widest cell.
const CELL: usize = 15;
/// Lines of the table without rules: the headings, and two lines per row except for the last, which has one.
const GRID: usize = 6;
/// Lines of the headings and one row.
const ROW: usize = 3;

/// The pane.
pub const PANE: PaneEntry = PaneEntry {
    draw,
    actions: &[],
    copied: |app, view| value(WatchQuantity::Margin, app, view),
    is_ahead: false,
};

/// Draws the decision.
fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let theme = &app.theme;
    let count = view.model.contacts.len();
    let slave = app.slave(view);
    let title = if count == 0 {
        "Decision".into()
    } else {
        format!("Decision  {}", view.slave(slave))
    };
    let inner = frame(buffer, area, Pane::Decision, &title, app);
    if view.is_finished() {
        let words = view.words(slave).unwrap_or("No decision at the start.");
        let lines = paint::wrapped(words, inner.width.into(), theme.text);
        return paint::lines(buffer, inner, &lines);
    }
    let record = view.record(slave);
    let decision = record.map(|record| record.decision);
    let hidden = app.learning.hides(view, slave);
    let tests = record.filter(|_| !hidden).map_or(Vec::new(), |record| {
        let tests = tests(record, view, inner.width.into(), theme);
        let sides = sides(record, slave, view, theme);
        [tests, sides, bond(record, slave, view, theme)].concat()
    });
    let words = match (hidden, &app.learning.lesson) {
        (false, _) => words(record, slave, view),
        (true, Some(_)) => "The numbers are in the table above. What does Table 2 choose?".into(),
        (true, None) if view.attached.is_some() => {
            "Which mode does the solver choose next? Predict it: press a, then f, s or x.".into()
        }
        (true, None) => {
            "Which mode does Table 2 choose? Predict it: press a, then f, s or x.".into()
        }
    };

    // The essential lines come first; blank lines are added if there is room.
    let style = if !hidden && decision.is_some_and(|d| d.changes()) {
        theme.strong
    } else {
        theme.text
    };
    let words = paint::wrapped(&words, inner.width.into(), style);
    let wide = inner.width as usize >= LABEL + 6 + 3 * CELL;
    let height = inner.height as usize;
    let row_fits = wide && height >= ROW + tests.len() + words.len();
    let needed = GRID + tests.len() + words.len();
    let (short, spare) = (height < needed, height.saturating_sub(needed));
    let row = |decision, mode| {
        grid(
            decision,
            Some(mode),
            hidden,
            inner.width.into(),
            false,
            theme,
        )
    };
    let air = |enough: bool| enough.then(Line::default);
    let crowded = !wide || inner.height < 9;
    let mut all = match decision {
        Some(decision) if decision.rule == Rule::Tied => Vec::new(),
        // Where there is no room for the table, its row that applies is shown.
        Some(decision)
            if (short || crowded && !hidden) && row_fits && table(&decision).is_some() =>
        {
            row(Some(&decision), decision.before)
        }
        None if short && row_fits && count > 0 => row(None, view.mode(slave)),
        Some(decision) if (crowded || !has_cells(&decision)) && !hidden => {
            vec![fired(&decision, view.differs(slave), theme)]
        }
        Some(decision) if (inner.height as usize) < GRID => choices(decision.before, theme),
        _ => grid(
            decision.as_ref(),
            None,
            hidden,
            inner.width as usize,
            spare >= 4,
            theme,
        ),
    };
    all.extend(air(spare >= 1));
    all.extend(tests);
    all.extend(air(spare >= 5 || (2..4).contains(&spare)));
    all.extend(words);
    let pushes = record
        .filter(|_| !hidden)
        .map_or(Vec::new(), |record| pushes(slave, record, view, theme));
    let room = (inner.height as usize).saturating_sub(all.len());
    let width = usize::from(inner.width);
    let measured = record.map_or(Vec::new(), |record| {
        measured(record, slave, width, view, theme)
    });
    let zoomed = !measured.is_empty() && room > measured.len() + 1 + pushes.len();
    if !zoomed && room > 1 && pushes.len() > 1 {
        all.push(Line::default());
        let least = usize::from(room < 4);
        all.extend(pushes.iter().skip(least).cloned());
    }
    if zoomed {
        all.push(Line::default());
        all.extend(measured);
        all.push(Line::default());
        all.extend(pushes);
    }
    paint::lines(buffer, inner, &all);
}

/// A heading, and the mode changes since the previous minor iteration that contributed most to the tested quantity.
fn pushes(slave: usize, record: &ContactRecord, view: &View, theme: &Theme) -> paint::Lines {
    const MOST: usize = 6;
    let heading = |text: &str| Line::styled(format!(" {text}"), theme.heading);
    let Some(found) = view.pushes(slave) else {
        let on_demand = "Who pushed it: focus this pane (Tab) to compute it";
        return if view.is_costly() {
            vec![heading(on_demand)]
        } else {
            Vec::new()
        };
    };
    let Some(found) = found else {
        return vec![heading(match view.attached {
            Some(attached) if reported_pushes::are_available(view.model, attached.offers) => {
                "Who pushed it: unknown, the interface problem does not match the numbers"
            }
            Some(_) => "Who pushed it: known only to the solver",
            None => "Who pushed it: not available here",
        })];
    };
    let quantity = tested::deciding(&record.decision);
    let (symbol, _) = tested::effect(quantity, &Influence::default());
    let found = tested::effects(quantity, found);
    let together: f64 = found.iter().map(|(_, effect)| effect).sum();
    let mut lines = vec![heading("Who pushed it since the previous minor iteration")];
    for (push, effect) in found.iter().take(MOST) {
        let text = format!(" {}: {symbol} = {}", deed(push, view), signed(*effect));
        lines.push(Line::styled(text, theme.text));
    }
    if found.len() > MOST {
        let text = format!(
            " sum of all {}: {symbol} = {}",
            found.len(),
            signed(together)
        );
        lines.push(Line::styled(text, theme.faint));
    }
    lines
}

/// A number with its sign and four digits.
fn signed(value: f64) -> String {
    match value {
        value if value < 0.0 => number::sig4(value),
        value => format!("+{}", number::sig4(value)),
    }
}

/// Describes a mode change.
fn deed(push: &NodePush, view: &View) -> String {
    let name = view.slave(push.slave);
    match push.modes {
        [a, b] if a == b && view.model.space.is_some() => format!("the new force on {name}"),
        [a, b] if a == b => format!("the new T_max of {name}"),
        [_, Mode::Free] => format!("opening {name}"),
        [Mode::Free, _] => format!("closing {name}"),
        [_, Mode::Sliding] => format!("letting {name} slide"),
        [_, Mode::Fixed] => format!("sticking {name}"),
    }
}

/// Widths of the names and values in [`measured`].
const NAME: usize = 13;
const VALUE: usize = 20;

/// All quantities of the node in this minor iteration, with explanations; shown if there is room.
fn measured(
    record: &ContactRecord,
    slave: usize,
    width: usize,
    view: &View,
    theme: &Theme,
) -> paint::Lines {
    let round_off = view.round_off();
    let long = |value| view.long(value);
    let signed = |value: f64| {
        let blank = if value < 0.0 { "" } else { " " };
        format!("{blank}{}", long(value))
    };
    let force = |value| signed(round_off.force(value));
    let length = |value| signed(round_off.length(value));
    let pair = |[x, y]: [f64; 2]| format!(" ({}, {})", long(x), long(y));
    let place = match record.spot {
        None => " past the ends of every surface".into(),
        // Only the solver knows the position on the surface.
        Some(_) if view.attached.is_some() => {
            let own = view.model.contacts[slave].surfaces.first();
            let surface = own.and_then(|own| view.model.surfaces.get(*own));
            surface.map_or(" -".into(), |surface| format!(" {}", surface.name))
        }
        Some(spot) => {
            let surface = view
                .model
                .surfaces
                .get(spot.surface)
                .map_or("?", |surface| &surface.name);
            format!(
                " {surface}, element {}, ξ = {}",
                spot.element + 1,
                long(spot.xi)
            )
        }
    };
    let ratio = if view.is_unreported(record.f_t / record.t_max) {
        number::UNREPORTED.into()
    } else {
        round_off.ratio(record.f_t, record.t_max)
    };
    let rows = [
        (
            "gap",
            length(record.gap),
            "negative: penetration; on this major iteration's frozen geometry",
        ),
        (
            "F_n",
            force(record.f_n),
            "total normal force on the slave node; compression is positive",
        ),
        (
            "F_t",
            force(record.f_t),
            "total tangential force, along t (n turned anticlockwise)",
        ),
        (
            "T_max",
            force(record.t_max),
            "signed friction limit: |F_n| tan φ + cohesion",
        ),
        (
            "T_max used",
            force(record.t_max_used),
            "the value used in this minor iteration",
        ),
        (
            "|F_t|/T_max",
            format!(" {ratio}"),
            "used fraction of the friction limit",
        ),
        (
            "slip",
            length(record.slip),
            "u_tS* − u_tS, measured as settings.slip says",
        ),
        (
            "drift",
            length(record.drift),
            "along the surface, from the point where it stuck or where the increment started",
        ),
        ("S*", place, ""),
        ("at", pair(record.foot.map(|x| round_off.length(x))), ""),
        (
            "normal",
            pair(record.normal.map(|x| round_off.component(x))),
            "",
        ),
    ];
    let contact = &view.model.contacts[slave];
    let by_area = contact.pressure(round_off.force(record.f_n), round_off.force(record.f_t));
    let of_area = by_area.map_or(Vec::new(), |[pressure, shear]| {
        vec![
            (
                "F_n / A",
                signed(pressure),
                "contact pressure on the node's undeformed tributary area",
            ),
            ("F_t / A", signed(shear), "contact shear"),
        ]
    });
    let heading = Line::styled(" Values of this minor iteration", theme.heading);
    let row = |(name, value, meaning): (&str, String, &str)| {
        let lead = [
            Span::styled(format!("   {name:<NAME$}"), theme.key),
            Span::raw(format!("{value:<VALUE$}")),
        ];
        let room = width.saturating_sub(NAME + VALUE + 4);
        paint::hanging(&lead, meaning, room, theme.faint)
    };
    [heading]
        .into_iter()
        .chain(rows.into_iter().chain(of_area).flat_map(row))
        .collect()
}

/// Table 2, or only one row of it, as lines, with the row of the previous mode highlighted and, unless hidden, the cell that fired.
fn grid(
    decision: Option<&Decision>,
    only: Option<Mode>,
    hidden: bool,
    width: usize,
    ruled: bool,
    theme: &Theme,
) -> paint::Lines {
    let table = decision.and_then(table).unwrap_or(TABLE_2);
    let cell = width.saturating_sub(LABEL + 6) / 3;
    let bar = Span::styled("│ ", theme.faint);
    let mut head = vec![Span::styled(format!("{:<LABEL$}", " mode"), theme.heading)];
    for mode in MODES {
        let text = format!("→ {}", mode.word());
        head.extend([
            bar.clone(),
            Span::styled(format!("{text:<cell$}"), theme.heading),
        ]);
    }
    let mut lines = vec![Line::from(head)];
    let rows = MODES.iter().enumerate();
    for (row, mode) in rows.filter(|(_, mode)| only.is_none_or(|only| only == **mode)) {
        if ruled {
            let stroke = format!("┼{}", "─".repeat(cell + 1)).repeat(3);
            let rule: String = ("─".repeat(LABEL) + &stroke)
                .chars()
                .chain(std::iter::repeat('─'))
                .take(width)
                .collect();
            lines.push(Line::styled(rule, theme.faint));
        }
        let here = decision.is_some_and(|decision| decision.before == *mode);
        let parts: &[usize] = if *mode == Mode::Free { &[0] } else { &[0, 1] };
        for &part in parts {
            let label = match (part, here) {
                (0, true) => format!("▸{}", mode.word()),
                (0, false) => format!(" {}", mode.word()),
                _ => String::new(),
            };
            let style = if here {
                theme.mode(*mode).add_modifier(Modifier::BOLD)
            } else {
                theme.faint
            };
            let mut spans = vec![Span::styled(format!("{label:<LABEL$}"), style)];
            for (column, next) in MODES.iter().enumerate() {
                let (mark, style) = match cell_look(decision, *mode, *next, theme) {
                    _ if hidden && here => (" ", theme.text),
                    look => look,
                };
                let mark = if part == 0 { mark } else { " " };
                let text = table[row][column][part];
                // The last column takes the remainder.
                let cell = if column == 2 {
                    width.saturating_sub(LABEL + 6 + 2 * cell)
                } else {
                    cell
                };
                let room = cell.saturating_sub(1);
                spans.extend([
                    bar.clone(),
                    Span::styled(format!("{text:<room$.room$}{mark}"), style),
                ]);
            }
            lines.push(Line::from(spans));
        }
    }
    lines
}

/// The cells that can fire, one per line, if the table does not fit and the cell that fired is hidden.
fn choices(before: Mode, theme: &Theme) -> paint::Lines {
    let row = MODES.iter().position(|mode| *mode == before).unwrap_or(0);
    let cell = |(column, next): (usize, &Mode)| {
        let [first, second] = TABLE_2[row][column];
        let comma = if second.is_empty() { "" } else { ", " };
        let (before, next) = (before.word(), next.word());
        Line::styled(
            format!(" {before} → {next}:  {first}{comma}{second}"),
            theme.text,
        )
    };
    MODES.iter().enumerate().map(cell).collect()
}

/// The table that was applied; `None` if it is not known.
fn table(decision: &Decision) -> Option<[[[&'static str; 2]; 3]; 3]> {
    match (decision.rule, rules(decision)) {
        (Rule::Theirs, Some(NEWTON)) => Some(names::table(Rule::NewtonOpens)),
        (Rule::Theirs, Some(_)) => Some(TABLE_2),
        (Rule::Theirs, None) => None,
        (rule, _) => Some(names::table(rule)),
    }
}

/// Whether a table decided on this node alone.
fn has_cells(decision: &Decision) -> bool {
    table(decision).is_some_and(|[[[first, _], ..], ..]| !first.is_empty())
}

const NEWTON: &str = "Newton";

/// Name of the rules that an attached solver's values were compared with, from the tested quantities.
fn rules(decision: &Decision) -> Option<&'static str> {
    match decision.tests[0]?.tested {
        TestedQuantity::Pressure | TestedQuantity::Drag => Some(NEWTON),
        TestedQuantity::Own => None,
        _ => Some("Table 2"),
    }
}

/// The cell that fired, if the table does not fit, and the mode that the solver's rules want if it differs.
fn fired(decision: &Decision, differs: bool, theme: &Theme) -> Line<'static> {
    let place = |mode: Mode| MODES.iter().position(|m| *m == mode).unwrap_or(0);
    let [first, second] = names::table(decision.rule)[place(decision.before)][place(decision.next)];
    let cell = match decision.rule {
        Rule::OffSurface
        | Rule::Held
        | Rule::Waits
        | Rule::CornerReleases
        | Rule::Pivots
        | Rule::Sweeps
        | Rule::Found
        | Rule::Settled
        | Rule::Theirs => String::new(),
        _ if second.is_empty() => format!(" {first} "),
        _ => format!(" {first}, {second} "),
    };
    let wanted = match (differs, rules(decision)) {
        (true, Some(rules)) => format!("≠ {rules}: {}", decision.wanted.word()),
        _ => String::new(),
    };
    Line::from(vec![
        Span::styled(
            format!(" {} → {}  ", decision.before.word(), decision.next.word()),
            theme.heading,
        ),
        Span::styled(cell, theme.lit(decision.next)),
        Span::styled(wanted, theme.warning),
    ])
}

/// Mark and style of a cell: fired, wanted by Table 2 but overruled, in the row of the previous mode, or other.
fn cell_look(
    decision: Option<&Decision>,
    before: Mode,
    next: Mode,
    theme: &Theme,
) -> (&'static str, Style) {
    let Some(decision) = decision.filter(|decision| decision.before == before) else {
        return (" ", theme.faint);
    };
    match decision.rule {
        Rule::OffSurface => (" ", theme.text),
        Rule::Held | Rule::Waits if decision.wanted == next => {
            ("◁", theme.text.add_modifier(Modifier::UNDERLINED))
        }
        Rule::Held | Rule::Waits => (" ", theme.text),
        _ if decision.next == next => ("◀", theme.lit(next)),
        // The cell that the rules want and an attached solver did not take.
        _ if decision.wanted == next => ("◁", theme.text.add_modifier(Modifier::UNDERLINED)),
        _ => (" ", theme.text),
    }
}

/// The inequalities with their values, on one line each if they fit, otherwise on two.
fn tests(record: &ContactRecord, view: &View, width: usize, theme: &Theme) -> paint::Lines {
    let mut lines = Vec::new();
    for test in record.decision.tests.iter().flatten() {
        let inequality = inequality(test, view);
        let (margin, style) = if test.tie && !record.is_tie(test) {
            ("no friction ".to_owned(), theme.faint)
        } else {
            margin(test, view, theme)
        };
        let style_left = if test.margin < 0.0 && !test.tie {
            theme.strong
        } else {
            theme.text
        };
        let used = inequality.width() + margin.width();
        if used < width {
            lines.push(Line::from(vec![
                Span::styled(inequality, style_left),
                Span::raw(" ".repeat(width - used)),
                Span::styled(margin, style),
            ]));
        } else {
            lines.push(Line::styled(inequality, style_left));
            lines.push(Line::styled(format!("{margin:>width$}"), style));
        }
    }
    lines
}

/// The forces on each of the two sides that hold a node in a corner.
fn sides(record: &ContactRecord, slave: usize, view: &View, theme: &Theme) -> paint::Lines {
    let friction = &view.frame().state.controls.friction[slave];
    let Some(sides) = record.sides(friction) else {
        return Vec::new();
    };
    let one = |(k, side): (usize, &SideForce)| {
        let (f_n, f_t, limit) = (sig4(side.f_n), sig4(side.f_t), sig4(side.limit));
        let text = format!(" side {}: F_n {f_n}, F_t {f_t}, limit {limit}", k + 1);
        Line::styled(text, theme.text)
    };
    let note = if friction.is_smooth() {
        " unique split"
    } else {
        " split of least norm; with friction it is not unique"
    };
    let mut lines: Vec<Line> = sides.iter().enumerate().map(one).collect();
    lines.push(Line::styled(note, theme.faint));
    lines
}

/// The state of the contact law, if it is not hard contact.
fn bond(record: &ContactRecord, slave: usize, view: &View, theme: &Theme) -> paint::Lines {
    let lines = bond::lines(&view.model.contacts[slave], record);
    let line = |text: String| Line::styled(format!(" {text}"), theme.text);
    lines.into_iter().map(line).collect()
}

/// The inequality with ten digits on both sides.
fn inequality(test: &Test, view: &View) -> String {
    let long = |value| view.long(value);
    let sign = match test.value.partial_cmp(&test.bound) {
        _ if test.tie && test.value != test.bound => "≈",
        Some(std::cmp::Ordering::Less) => "<",
        Some(std::cmp::Ordering::Greater) => ">",
        Some(std::cmp::Ordering::Equal) => "=",
        None => "?",
    };
    let (name, bound) = tested::sides(test.tested);
    let bound = bound.map_or(String::new(), |bound| format!("{bound} ")) + &long(test.bound);
    format!(" {name} {} {sign} {bound}", long(test.value))
}

/// The distance of the inequality from switching, with its unit.
fn margin(test: &Test, view: &View, theme: &Theme) -> (String, Style) {
    let long = |value| view.long(value);
    let round_off = view.round_off();
    let dimension = Dimension::from(test.tested);
    let unit = match dimension {
        Dimension::Force => "force",
        Dimension::Length => "length",
        Dimension::Ratio => "(relative)",
        Dimension::Unknown => "",
    };
    if test.tie {
        (
            format!("tie, margin {} {unit} ", long(test.margin)),
            theme.warning,
        )
    } else {
        let rounded = match dimension {
            Dimension::Force => round_off.force(test.value),
            Dimension::Length => round_off.length(test.value),
            _ => test.value,
        };
        let nothing = rounded == 0.0 && test.value != 0.0;
        let note = if nothing { NOTE } else { "" };
        let text = format!("margin {} {unit} {note}", long(test.margin));
        (format!("{} ", text.trim_end()), theme.faint)
    }
}

/// An attached solver's explanation of its decision, and the mode that its rules want if it differs.
fn theirs(record: &ContactRecord, slave: usize, view: &View) -> Option<String> {
    let decision = &record.decision;
    let said = view.words(slave);
    let differs = view.differs(slave);
    if view.attached.is_none() || (said.is_none() && !differs && decision.rule != Rule::Theirs) {
        return None;
    }
    let next = decision.next.word();
    let own = match (said, decision.rule) {
        (Some(words), _) => format!("The solver chooses {next}: “{words}”."),
        (None, Rule::Theirs) => format!("The solver chooses {next} and gives no reason."),
        (None, _) => report::reason(decision, record.t_max != 0.0),
    };
    let rules = rules(decision).unwrap_or("its rule");
    Some(if differs {
        format!(
            "{own} ≠ {rules} (◁), which gives {} for the same values.",
            decision.wanted.word()
        )
    } else {
        own
    })
}

/// The decision in words.
fn words(record: Option<&ContactRecord>, slave: usize, view: &View) -> String {
    if view.model.contacts.is_empty() {
        return "This scene has no slave nodes to decide on.".into();
    }
    let next = view.mode(slave);
    let Some(record) = record else {
        return format!("No decision yet; the node starts {}.", next.word());
    };
    let decision = &record.decision;
    let mut text = match theirs(record, slave, view) {
        Some(text) => text,
        None => report::reason(decision, record.t_max != 0.0),
    };
    let mut tests = decision.tests.iter().flatten();
    if tests.any(|test| record.is_tie(test)) {
        text += match view.frame().state.controls.settings.ties {
            TieRule::Keep => " A tie keeps the mode.",
            TieRule::Printed => " An exact tie, decided by the table as printed.",
        };
    }
    if view.t_max_moves(slave) {
        text += &format!(
            " T_max has not settled: {} was used.",
            shortest(view.round_off().force(record.t_max_used))
        );
    }
    if record.carried.contains(&true) {
        text += " A support carries part of the force.";
    }
    match view.frame().state.nodes[slave].forced {
        Forced::Once(mode) if next == mode && mode != decision.next => {
            text += &format!(" Forced to {} for the next minor iteration.", mode.word());
        }
        Forced::Held(mode) if record.forced != Forced::Held(mode) => {
            text += &format!(" Held {} from here on.", mode.word());
        }
        Forced::Held(_) if decision.rule != Rule::Held => text += " Held; Table 2 agrees.",
        _ => {}
    }
    text
}
