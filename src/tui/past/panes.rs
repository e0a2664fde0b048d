//! What stands on the screen of a run that is over.

use super::actions;
use super::app::{App, Overlay, Pane};
use crate::action::Entry;
use crate::explain::number::plain;
use crate::explain::past::run::{Touch, limits};
use crate::explain::past::{summary, words};
use crate::manual::search::Search;
use crate::model::Mode;
use crate::tui::app::Tone;
use crate::tui::columns::{self, Column};
use crate::tui::convergence::{self, Point};
use crate::tui::paint;
use crate::tui::panes::footer::{fitted, is_always};
use crate::tui::theme::Theme;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};
use unicode_width::UnicodeWidthStr;

/// Rows of the timeline that are no contacts, its border included: increments, attempts, the cursor's mark, what each attempt
/// led to, brackets, and what the letters mean.
pub const FRAME: u16 = 8;
/// Rows without which it shows nothing, inside the border.
const LEAST: u16 = 5;
/// Width of the contacts' names, and of what stands before them.
const NAME: usize = 11;
/// Height from which on the numbers over a chart have two lines.
const ROOMY: u16 = 9;

/// The marks of the timeline.
const MARKS: &[(&str, &str)] = &[
    (
        "C ·",
        "closed: it has contact elements in this iteration; open: it has none",
    ),
    (
        "M",
        "closed on another master face than in the iteration before",
    ),
    (
        "1 to 9",
        "a slave face with so many tenths of the integration points in contact that it ever had there",
    ),
    (
        "bold",
        "its contact elements are others than in the iteration before",
    ),
    (
        "held fixed",
        "dim: after iteration 8 of an attempt, or with SMALL SLIDING after the first, CalculiX keeps the contact elements of nodes",
    ),
    (
        "?",
        "the .cel does not have the contact elements that the .cvg counts",
    ),
    (
        "║ │",
        "another increment begins; another attempt at the same one",
    ),
    ("✓", "the increment converged"),
    ("½", "the attempt did not converge: the increment was cut"),
    ("✗", "it did not, and the run ended"),
    ("╰╯", "the first turn of a cycle"),
    (
        "limit",
        "what an iteration must get under by CalculiX's defaults: residual 0.5 % (2 % after 9 iterations), correction 1 %; \
        the files do not tell whether *CONTROLS changed them, nor that the set of contact elements has to settle, too",
    ),
    (
        "numbers",
        "are CalculiX's: in plane models, which it makes three-dimensional, master and slave faces have nodes of its own",
    ),
];

/// Draws a pane.
pub fn draw(pane: Pane, buffer: &mut Buffer, area: Rect, app: &App) {
    match pane {
        Pane::Timeline => timeline(buffer, area, app),
        Pane::Residual => residual(buffer, area, app),
        Pane::Contacts => contacts(buffer, area, app),
        Pane::Attempts => attempts(buffer, area, app),
    }
}

/// Which run, where in it, and how its attempt went, in so many rows.
pub fn status(app: &App, width: usize, rows: usize) -> Vec<Line<'static>> {
    let (past, theme) = (&app.past, &app.theme);
    let attempt = past.attempt(app.cursor);
    let tells = format!("  {}", words::READ_ONLY);
    let name = paint::cut(&past.name, width.saturating_sub(12 + tells.width()).max(8));
    let place = words::place(past, app.cursor);
    let time = words::time(past, attempt).map_or(String::new(), |time| format!("  {time}"));
    let norms = words::norms(past, app.cursor);
    let norms = norms.map_or(String::new(), |norms| format!("  {norms}"));
    let ended = words::ended(past, attempt);
    let cycle = words::cycle(past, attempt).map_or(String::new(), |cycle| format!("; {cycle}"));
    let mut lines = vec![
        Line::from(vec![
            Span::styled(" stickslip ", theme.faint),
            Span::styled(name, theme.heading),
            Span::styled(tells, theme.faint),
        ]),
        Line::from(vec![
            Span::styled(format!(" {place}"), theme.strong),
            Span::styled(time, theme.text),
        ]),
        Line::styled(
            format!(" {}{norms}", words::closed(past, app.cursor)),
            theme.text,
        ),
    ];
    let style = match words::end_word(past, attempt) {
        "converged" => theme.text,
        _ => theme.strong,
    };
    let room = rows.saturating_sub(lines.len());
    let mut told = paint::wrap(&format!("{ended}{cycle}"), width.saturating_sub(3));
    if told.len() > room {
        told.truncate(room);
        told.last_mut().into_iter().for_each(|last| last.push('…'));
    }
    let told = told.into_iter();
    lines.extend(told.map(|line| Line::styled(format!(" {line}"), style)));
    lines
}

fn timeline(buffer: &mut Buffer, area: Rect, app: &App) {
    let (past, theme) = (&app.past, &app.theme);
    let count = past.run.slaves.len();
    // A low screen does without the marks of ends, and of cycles.
    let spare = area.height.saturating_sub(2 + LEAST).min(2);
    let rows = usize::from(area.height.saturating_sub(LEAST + 1 + spare));
    let mut title = format!("Timeline  iteration {} of {}", app.cursor + 1, past.len());
    if rows < count {
        title += &format!("  contact {} of {count}", app.selected + 1);
    }
    let inner = paint::frame(buffer, area, &title, app.focus == Pane::Timeline, theme);
    if inner.height < LEAST || usize::from(inner.width) < NAME + 6 {
        return;
    }
    let left = inner.x + NAME as u16;
    let ruled = |at: usize| rule(app, at).is_some();
    let room = usize::from(inner.right() - left);
    let shown = columns::around(past.len(), app.cursor, left, room, ruled);
    let contacts = columns::rows_shown(rows, app.selected, count);
    let (first, below) = (inner.y + 3, inner.y + 3 + contacts.len() as u16);
    for (y, text) in [(0, "increment"), (1, "attempt")] {
        buffer.set_string(inner.x + 1, inner.y + y, text, theme.faint);
    }
    let leftmost = shown.first().map(|column| column.at);
    columns::headings(buffer, inner, &shown, theme.heading, |at| {
        let attempt = &past.run.attempts[past.attempt(at)];
        let (step, increment) = (attempt.step, attempt.increment);
        // A step is told where it begins, and on the left.
        let name = match increment == 1 || leftmost == Some(at) {
            true => format!("{step}.{increment}"),
            false => increment.to_string(),
        };
        [
            ((step, increment, 0), name),
            (
                (step, increment, attempt.attempt),
                attempt.attempt.to_string(),
            ),
        ]
    });
    for (row, slave) in contacts.clone().enumerate() {
        let (mark, style) = match slave == app.selected {
            true => ("▸", theme.selected),
            false => (" ", theme.text),
        };
        let y = first + row as u16;
        buffer.set_string(inner.x, y, mark, theme.focus);
        buffer.set_string(
            inner.x + 1,
            y,
            paint::cut(&past.slave(slave), NAME - 2),
            style,
        );
    }
    for column in &shown {
        let here = column.at == app.cursor;
        if here {
            buffer.set_string(column.x, first - 1, "▼", theme.focus);
        }
        if let Some(rule) = rule(app, column.at).filter(|_| column.x > left) {
            for y in inner.y + 1..below {
                buffer.set_string(column.x - 1, y, rule, theme.faint);
            }
        }
        for (row, slave) in contacts.clone().enumerate() {
            let (letter, style) = cell(app, column.at, slave);
            let style = match here {
                true => style.add_modifier(Modifier::REVERSED),
                false => style,
            };
            buffer.set_string(column.x, first + row as u16, letter, style);
        }
        if spare > 0 {
            let (end, style) = end(app, column.at);
            buffer.set_string(column.x, below, end, style);
        }
    }
    if spare > 1 {
        rounds(buffer, inner, below + 1, &shown, app);
    }
    let letters = match past.corners(app.selected) {
        None => "C closed  · open  M on another face",
        Some(_) => "C closed  · open  1-9 tenths of it",
    };
    let legend = format!("{}   {letters}", words::NO_MODES);
    let legend = paint::cut(&legend, usize::from(inner.width) - 1);
    buffer.set_string(inner.x + 1, inner.bottom() - 1, legend, theme.warning);
}

/// What stands before an iteration: a double rule where an increment begins, a single one at another attempt.
fn rule(app: &App, at: usize) -> Option<&'static str> {
    let before = app.past.attempt(at.checked_sub(1)?);
    let now = app.past.attempt(at);
    let key = |k: usize| {
        let attempt = &app.past.run.attempts[k];
        (attempt.step, attempt.increment)
    };
    match key(before) == key(now) {
        false => Some("║"),
        true => (before != now).then_some("│"),
    }
}

fn cell(app: &App, at: usize, slave: usize) -> (&'static str, Style) {
    const PARTS: [&str; 10] = ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9"];
    let (letter, style) = match app.past.touch(at, slave) {
        Touch::Unknown => ("?", app.theme.faint),
        Touch::Open => ("·", app.theme.mode(Mode::Free)),
        Touch::Closed => ("C", app.theme.mode(Mode::Fixed)),
        Touch::Moved => ("M", app.theme.mode(Mode::Sliding)),
        Touch::Part(tenths) => (PARTS[usize::from(tenths) % 10], app.theme.mode(Mode::Fixed)),
    };
    let kept = app.past.run.iterations[at].kept;
    match (app.past.switches(at, slave), kept) {
        (true, _) => (letter, style.add_modifier(Modifier::BOLD)),
        (false, true) => (letter, style.add_modifier(Modifier::DIM)),
        (false, false) => (letter, style),
    }
}

/// How the attempt ended that ends with an iteration.
fn end(app: &App, at: usize) -> (&'static str, Style) {
    let attempt = app.past.attempt(at);
    if at + 1 != app.past.run.attempts[attempt].iterations.end {
        return (" ", app.theme.faint);
    }
    match words::end_word(&app.past, attempt) {
        "converged" => ("✓", app.theme.good),
        "cut" => ("½", app.theme.warning),
        "failed" => ("✗", app.theme.bad),
        _ => ("?", app.theme.faint),
    }
}

/// Brackets under the cycles that are visible.
fn rounds(buffer: &mut Buffer, inner: Rect, y: u16, shown: &[Column], app: &App) {
    let Some((first, last)) = shown.first().zip(shown.last()) else {
        return;
    };
    let attempts = app.past.attempt(first.at)..=app.past.attempt(last.at);
    let mut free = inner.x;
    for round in attempts.filter_map(|attempt| app.past.rounds[attempt].as_ref()) {
        let mut columns = shown
            .iter()
            .filter(|column| round.iterations.contains(&column.at));
        let Some(from) = columns.next() else {
            continue;
        };
        let to = columns.next_back().unwrap_or(from);
        if from.x < free {
            continue;
        }
        let text = format!("{}-cycle", round.period());
        columns::bracket(
            buffer,
            inner.right(),
            y,
            (from.x, to.x),
            &text,
            app.theme.bad,
        );
        free = to.x + 3 + text.len() as u16;
    }
}

fn residual(buffer: &mut Buffer, area: Rect, app: &App) {
    let (past, theme) = (&app.past, &app.theme);
    let title = "Residual by iteration of this attempt";
    let inner = paint::frame(buffer, area, title, app.focus == Pane::Residual, theme);
    let iterations = past.run.attempts[past.attempt(app.cursor)]
        .iterations
        .clone();
    let points: Vec<Point> = iterations.filter_map(|at| point(app, at)).collect();
    if points.is_empty() {
        let told = " No file tells the residuals of this attempt.";
        return paint::lines(buffer, inner, &[Line::styled(told, theme.faint)]);
    }
    let last = past.norms(app.cursor);
    let number =
        |value: Option<f64>| value.map_or("-".into(), |value| format!("{} %", plain(value)));
    let residual = number(last.map(|norms| norms.residual));
    let correction = number(last.map(|norms| norms.correction));
    let [limit, other] = limits(past.run.iterations[app.cursor].number);
    let part = |what: &str, value: String, limit: f64| {
        [
            Span::styled(format!(" {what} "), theme.faint),
            Span::styled(value, theme.strong),
            Span::styled(format!("  ┄ limit {limit} % "), theme.faint),
        ]
    };
    let parts = [
        part("● residual", residual, limit),
        part("○ correction", correction, other),
    ];
    // A low pane has both in one line.
    let caption: Vec<Line> = match inner.height < ROOMY {
        true => vec![Line::from(parts.concat())],
        false => parts.map(|part| Line::from(part.to_vec())).to_vec(),
    };
    let above = caption.len() as u16;
    paint::lines(buffer, inner, &caption);
    let plot = Rect {
        y: inner.y + above.min(inner.height),
        height: inner.height.saturating_sub(above),
        ..inner
    };
    if convergence::fits(plot) {
        convergence::draw(buffer, plot, &points, theme);
    }
}

fn point(app: &App, at: usize) -> Option<Point> {
    let norms = app.past.norms(at)?;
    let number = app.past.run.iterations[at].number;
    let [residual, correction] = limits(number);
    Some(Point {
        number,
        main: norms.residual,
        limit: residual,
        other: norms.correction,
        other_limit: Some(correction),
        here: at == app.cursor,
    })
}

fn contacts(buffer: &mut Buffer, area: Rect, app: &App) {
    let (past, theme) = (&app.past, &app.theme);
    let title = match past.chatter.len() {
        0 => "Contacts: none switches".to_owned(),
        count => format!("Contacts: {count} of {} switch", past.run.slaves.len()),
    };
    let inner = paint::frame(buffer, area, &title, app.focus == Pane::Contacts, theme);
    let masters = words::masters(past, app.cursor, app.selected);
    let corners = past.corners(app.selected);
    let corners = corners.map_or(String::new(), |corners| format!(" ({corners})"));
    let told = format!("{}{corners}: {masters}", past.slave(app.selected));
    let width = usize::from(inner.width);
    let mut lines = vec![Line::styled(
        paint::cut(&format!(" {told}"), width),
        theme.text,
    )];
    if past.chatter.is_empty() {
        let none = " No contact closes, opens or moves between the iterations of an attempt.";
        lines.push(Line::styled(paint::cut(none, width), theme.faint));
        return paint::lines(buffer, inner, &lines);
    }
    lines.push(Line::styled("  contact    here  all most  in", theme.faint));
    let rows = usize::from(inner.height).saturating_sub(lines.len());
    let at = past
        .chatter
        .iter()
        .position(|chatter| chatter.slave == app.selected);
    let attempt = past.attempt(app.cursor);
    for index in columns::rows_shown(rows, at.unwrap_or(0), past.chatter.len()) {
        let chatter = &past.chatter[index];
        let here = chatter.attempts.iter().find(|(own, _)| *own == attempt);
        let here = here.map_or(0, |(_, count)| *count);
        let mut places: Vec<String> = Vec::new();
        for (attempt, _) in &chatter.attempts {
            let attempt = &past.run.attempts[*attempt];
            let place = format!("{}.{}", attempt.step, attempt.increment);
            if places.last() != Some(&place) && places.len() < width {
                places.push(place);
            }
        }
        let (mark, style) = match Some(index) == at {
            true => ("▸", theme.selected),
            false => (" ", theme.text),
        };
        let name = paint::cut(&past.slave(chatter.slave), NAME - 2);
        let (all, most) = (chatter.switches, chatter.most());
        let row = format!(
            "{mark} {name:<9} {here:>5} {all:>4} {most:>4}  {}",
            places.join(" ")
        );
        lines.push(Line::styled(paint::cut(&row, width), style));
    }
    paint::lines(buffer, inner, &lines);
}

fn attempts(buffer: &mut Buffer, area: Rect, app: &App) {
    let (past, theme) = (&app.past, &app.theme);
    let all = &past.run.attempts;
    let title = format!("Attempts: {}", all.len());
    let inner = paint::frame(buffer, area, &title, app.focus == Pane::Attempts, theme);
    let mut lines = vec![Line::styled("  attempt   iter  ended", theme.faint)];
    let rows = usize::from(inner.height).saturating_sub(1);
    let here = past.attempt(app.cursor);
    for index in columns::rows_shown(rows, here, all.len()) {
        let place = summary::place_of(past, index);
        let word = words::end_word(past, index);
        let cycle = past.rounds[index].as_ref();
        let cycle = cycle.map_or(String::new(), |round| format!(", {}-cycle", round.period()));
        let count = match all[index].row {
            Some(row) => row.iterations as usize,
            None => all[index].iterations.len(),
        };
        let (mark, style) = match (index == here, word) {
            (true, _) => ("▸", theme.selected),
            (false, "converged") => (" ", theme.text),
            (false, _) => (" ", theme.strong),
        };
        let row = format!("{mark} {place:<8} {count:>5}  {word}{cycle}");
        lines.push(Line::styled(
            paint::cut(&row, usize::from(inner.width)),
            style,
        ));
    }
    paint::lines(buffer, inner, &lines);
}

/// What was said last or is being typed, and the keys.
pub fn footer(app: &App, width: usize) -> (Vec<Line<'static>>, Vec<Line<'static>>) {
    let theme = &app.theme;
    if let Overlay::Line(line) = &app.overlay {
        use crate::action::Context;
        use crate::tui::commandline::Purpose;
        let prompt = if line.purpose == Purpose::Node {
            "/"
        } else {
            ":"
        };
        let context = Context {
            keymap: Some(&app.keymap),
            ..Context::default()
        };
        return (
            line.lines(prompt, width, theme),
            line.hint(&context, width, theme),
        );
    }
    let style = match app.message.tone {
        Tone::Plain => theme.text,
        Tone::Error => theme.bad,
    };
    let text = match app.count {
        Some(count) => format!("{count} ×"),
        None => app.message.text.clone(),
    };
    let told = paint::wrap(&text, width.saturating_sub(2)).into_iter();
    let told = told
        .map(|line| Line::styled(format!(" {line}"), style))
        .collect();
    let keys: Vec<(bool, String, String)> = match app.overlay {
        Overlay::Help(..) => [
            ("↑↓", "scroll"),
            ("/", "search"),
            ("n N", "again"),
            ("Esc", "back"),
        ]
        .map(|(key, label)| (true, key.into(), label.into()))
        .to_vec(),
        _ => {
            let labelled = actions::all().filter(|(entry, _)| !entry.label.is_empty());
            let key = |entry| app.keymap.keys(entry).next().map(str::to_owned);
            let hint =
                |entry: &'static Entry| Some((is_always(entry), key(entry)?, entry.label.into()));
            labelled.filter_map(|(entry, _)| hint(entry)).collect()
        }
    };
    (told, vec![fitted(&keys, width, theme)])
}

/// Width of the columns of keys and of names.
const KEYS: usize = 14;
const NAMES: usize = 18;

/// The help page: actions, marks, and what the files do not tell.
pub fn help(app: &App, width: usize) -> Vec<Line<'static>> {
    let theme = &app.theme;
    let heading = |text: &str| Line::styled(format!(" {text}"), theme.heading);
    let head = paint::wrap(words::NO_MODES_IN_FULL, width.saturating_sub(3).max(20));
    let head = head
        .into_iter()
        .map(|text| Line::styled(format!(" {text}"), theme.warning));
    let mut lines: Vec<Line> = head.collect();
    lines.push(Line::default());
    lines.push(heading("What can be done; all else needs a solver"));
    for (entry, text) in actions::all() {
        let keys: Vec<&str> = app.keymap.keys(entry).collect();
        let keys = format!("{:<KEYS$}{:<NAMES$}", keys.join(" "), entry.name);
        lines.extend(explained(&keys, text, width, theme));
    }
    lines.push(Line::default());
    lines.push(heading("Marks"));
    for (mark, text) in MARKS {
        lines.extend(explained(&format!("{mark:<KEYS$}"), text, width, theme));
    }
    let notes = words::notes(&app.past);
    if !notes.is_empty() {
        lines.push(Line::default());
        lines.push(heading("The files"));
    }
    for note in notes {
        lines.extend(explained("", &note, width, theme));
    }
    lines
}

/// A key or a mark, and beside it what it means, in as many lines as that needs.
fn explained(key: &str, text: &str, width: usize, theme: &Theme) -> Vec<Line<'static>> {
    let indent = 3 + key.width();
    let texts = paint::wrap(text, width.saturating_sub(indent + 1).max(20));
    let line = |(row, text): (usize, String)| {
        let key = if row == 0 { key } else { "" };
        let room = indent - 3;
        Line::from(vec![
            Span::styled(format!("   {key:<room$}"), theme.key),
            Span::styled(text, theme.text),
        ])
    };
    texts.into_iter().enumerate().map(line).collect()
}

/// Draws the help page from a line on.
pub fn draw_help(buffer: &mut Buffer, area: Rect, (top, search): (usize, &Search), app: &App) {
    let title = search.title().unwrap_or_else(|| "Help".into());
    let inner = paint::frame(buffer, area, &title, true, &app.theme);
    let mut lines = help(app, inner.width as usize);
    for line in &mut lines {
        if search.holds(&line.to_string()) {
            *line = Line::styled(line.to_string(), app.theme.selected);
        }
    }
    let top = top.min(lines.len().saturating_sub(inner.height as usize));
    paint::lines(buffer, inner, &lines[top..]);
}
