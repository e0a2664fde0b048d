//! The last two rows: the message or prompt, and the most relevant keys of the key table.

use crate::app::{App, Overlay, Tone};
use crate::commandline::Purpose;
use crate::layout::{Pane, ScreenAreas};
use crate::paint::{self, wrapped};
use crate::theme::Theme;
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use stickslip_debugger::Tutor;
use stickslip_debugger::action::{ACTIONS, ActionEntry, Group, by_name};
use stickslip_debugger::teach::question::AnswerKind;
use stickslip_scene::number;
use unicode_width::UnicodeWidthStr;

/// Maximum number of message lines above the keys with a lesson on the screen.
const OVER_LESSON: usize = 2;
/// Actions that the footer shows at any width.
const ALWAYS: [&str; 3] = ["pane", "help", "quit"];

/// Draws message and keys. A message that needs more rows starts further up, over the last rows inside the panes; their lower
/// borders move above it.
pub fn draw(buffer: &mut Buffer, places: &ScreenAreas, app: &App, view: Option<&View>) {
    let width = places.message.width as usize;
    let mut lines = message(app, view, places, width);
    let keys = keys(app, view, places);
    // A screen without a row for keys has no second row for the message either.
    let most = match places.footer.height {
        0 => return paint::lines(buffer, places.message, &lines),
        _ => usize::from(places.footer.bottom() / 2).max(2),
    };
    let lesson = places.panes.iter().any(|(pane, _)| *pane == Pane::Lesson);
    // The task of a lesson stays visible above a message.
    let most = match app.overlay {
        Overlay::None if lesson => most.min(keys.len() + OVER_LESSON),
        _ => most,
    };
    shorten(&mut lines, most.saturating_sub(keys.len()).max(1), width);
    lines.extend(keys.into_iter().take(most - lines.len()));
    let height = lines.len() as u16;
    let area = Rect {
        y: places.footer.bottom() - height,
        height,
        ..places.footer
    };
    // The text of a lesson needs its rows.
    let bare = matches!(app.overlay, Overlay::None | Overlay::Line(_)) && !lesson;
    if bare && view.is_some() && area.y < places.message.y {
        for x in area.left()..area.right() {
            buffer[(x, area.y - 1)] = buffer[(x, places.message.y - 1)].clone();
        }
    }
    paint::over(buffer, area, &lines, &app.theme);
}

/// Leaves out the lines after the first `most`, and marks the last one if there were more.
fn shorten(lines: &mut paint::Lines, most: usize, width: usize) {
    if lines.len() <= most {
        return;
    }
    lines.truncate(most);
    if let Some(last) = lines.last_mut() {
        let text = paint::cut(&format!("{last} …"), width.saturating_sub(1));
        *last = Line::styled(text, last.style);
    }
}

fn message(app: &App, view: Option<&View>, places: &ScreenAreas, width: usize) -> paint::Lines {
    let theme = &app.theme;
    if let Overlay::Line(line) = &app.overlay {
        let prompt = match line.purpose {
            Purpose::Command => ":".into(),
            Purpose::Node => "/".into(),
            Purpose::Answer => "your answer: ".into(),
            Purpose::Increment => question(app, view).unwrap_or_else(|| "increment: ".into()),
        };
        return line.lines(&prompt, width, theme);
    }
    if let Some(question) = question(app, view) {
        return wrapped(&question, width, theme.key);
    }
    if let Some(note) = app.ahead.note() {
        return wrapped(&note, width, theme.warning);
    }
    if let Some(count) = app.count {
        return vec![Line::styled(format!(" {count} ×"), theme.key)];
    }
    let has_pane = places.panes.iter().any(|(pane, _)| *pane == Pane::Lesson);
    let covered = matches!(app.overlay, Overlay::Chart(_));
    let shown = has_pane && !covered;
    if let (false, "", Some(tutor)) = (shown, app.message.text.as_str(), &app.learning.lesson) {
        // The keys of the lesson work behind the chart only.
        let first = if covered {
            "Esc closes the chart, then: "
        } else {
            ""
        };
        return wrapped(&format!("▶ {first}{}", tutor.todo()), width, theme.key);
    }
    let mut lines = message_lines(app, view, width);
    if let Some(notice) = &app.notice {
        lines.retain(|line| line.width() > 1);
        lines.splice(0..0, wrapped(notice, width, theme.bad));
    }
    lines
}

/// The keys of the modes.
const MODES: &str = "f free   s sliding   x fixed";

/// The prompt of the message line; `None` if there is no question.
fn question(app: &App, view: Option<&View>) -> Option<String> {
    let view = view?;
    match &app.overlay {
        Overlay::Mode => {
            let held = match view.attached.map(|attached| attached.offers) {
                Some(offers) if !offers.hold => "this solver cannot hold it",
                Some(offers) if !offers.force => {
                    "capital letters only: this solver can only hold it, until M releases it"
                }
                _ => "capital letter: hold",
            };
            Some(format!(
                "mode of {}:  {MODES}   ({held})",
                view.slave(app.selected)
            ))
        }
        Overlay::Answer => Some(
            match app.learning.lesson.as_ref().and_then(Tutor::question) {
                Some(question) if question.kind() == AnswerKind::Choice => {
                    format!("your answer:  1 to {}", question.options.len())
                }
                Some(_) => format!("your answer:  {MODES}"),
                None => format!("next mode of {}:  {MODES}", view.slave(app.selected)),
            },
        ),
        Overlay::Line(line) if line.purpose == Purpose::Increment => Some(format!(
            "new increment (now {}): ",
            number::shortest(view.frame().state.controls.increment)
        )),
        _ => None,
    }
}

/// The last message, and the watches.
fn message_lines(app: &App, view: Option<&View>, width: usize) -> paint::Lines {
    let theme = &app.theme;
    let aside = view.map_or("", |view| view.aside.as_str());
    let text = app.message.text.as_str();
    match app.message.tone {
        Tone::Plain if text.is_empty() => wrapped(aside, width, theme.text),
        Tone::Plain if aside.is_empty() => wrapped(text, width, theme.text),
        Tone::Plain => wrapped(&format!("{text}   {aside}"), width, theme.text),
        Tone::Error => {
            let mut lines = wrapped(text, width, theme.bad);
            if !aside.is_empty() {
                lines.extend(wrapped(aside, width, theme.text));
            }
            lines
        }
    }
}

fn keys(app: &App, view: Option<&View>, places: &ScreenAreas) -> paint::Lines {
    let room = places.footer.width as usize;
    let typed = match &app.overlay {
        Overlay::Text(page) => page.search.typed(),
        _ => None,
    };
    let line = match &app.overlay {
        _ if typed.is_some() => listed(&[("Enter", "find"), ("Esc", "back")], app),
        Overlay::None => table_keys(app, view, places, room),
        Overlay::Text(page) => {
            let search = [("/", "search"), ("n N", "again"), ("Esc", "back")];
            listed(&[page.text().keys(), &search].concat(), app)
        }
        Overlay::Chart(page) => {
            let mut keys = vec![("←→", "run"), ("x", "cost")];
            keys.extend(page.has_forces().then_some(("f", "forces")));
            keys.extend((page.charts.len() > 1).then_some(("Tab", "next chart")));
            keys.push(("Esc", "back"));
            listed(&keys, app)
        }
        Overlay::Chooser(chooser) => {
            let (back, leave) = match (chooser.typed.is_empty(), view.is_some()) {
                (false, _) => ("clear", None),
                (true, true) => ("back", None),
                (true, false) => ("back", Some(("q", "quit"))),
            };
            let mut keys = vec![("↑↓", "choose"), ("Enter", "open"), (":", "a file")];
            keys.extend([("letters", "find"), ("Esc", back)]);
            keys.extend(leave);
            listed(&keys, app)
        }
        Overlay::Mode => {
            let offers = view
                .and_then(|view| view.attached)
                .map(|attached| attached.offers);
            let may = |may: bool, word, not| if may { word } else { not };
            let once = may(offers.is_none_or(|offers| offers.force), "once", "(once)");
            let hold = may(offers.is_none_or(|offers| offers.hold), "hold", "(hold)");
            listed(&[("f s x", once), ("F S X", hold), ("Esc", "cancel")], app)
        }
        Overlay::Answer => listed(&[("Esc", "back to the panes")], app),
        Overlay::Line(line) => {
            let scenes = app.scenes();
            return line.hint(&app.context(view, &scenes), room, &app.theme);
        }
    };
    vec![line]
}

fn listed(keys: &[(&str, &str)], app: &App) -> Line<'static> {
    let spans = keys
        .iter()
        .flat_map(|(key, label)| hint(key, label, &app.theme));
    Line::from(spans.collect::<Vec<_>>())
}

/// Whether a label is in parentheses, which mark an unavailable action without relying on colour.
fn is_grey(label: &str) -> bool {
    label.starts_with('(')
}

/// A key and its label.
fn hint(key: &str, label: &str, theme: &Theme) -> [Span<'static>; 2] {
    [
        Span::styled(
            format!(" {key}"),
            if is_grey(label) {
                theme.faint
            } else {
                theme.key
            },
        ),
        Span::styled(format!(" {label} "), theme.faint),
    ]
}

/// The labelled actions of the table that fit, in table order; the ones in [`ALWAYS`] get space first.
fn table_keys(app: &App, view: Option<&View>, places: &ScreenAreas, room: usize) -> Line<'static> {
    let teaches = app.learning.lesson.is_some() || app.learning.guess.is_some();
    // An action without a key is left out; it can still be typed by name.
    let key = |entry: &'static ActionEntry| app.keymap.keys(entry).next().map(str::to_owned);
    let context = app.context(view, &[]);
    // A count is a prefix: only the actions that it applies to follow it.
    let follows = |entry: &&ActionEntry| app.count.is_none() || entry.takes_count();
    let own = super::entry(app.panes.focus)
        .actions
        .iter()
        .filter_map(|(name, label)| {
            let entry = by_name(name).ok().filter(|_| app.count.is_none())?;
            let label = match *name {
                "repeat" => app.enter_label(label, view)?,
                _ => *label,
            };
            Some((entry, key(entry)?, label.to_owned()))
        });
    let general = ACTIONS
        .iter()
        .filter(|entry| !entry.label.is_empty() && (teaches || entry.group != Group::Learn))
        .filter(|entry| follows(entry) || is_always(entry))
        .filter_map(|entry| {
            let label = match entry.offered(&context) {
                Ok(()) => label(entry, app, places),
                Err(_) => format!("({})", entry.label),
            };
            Some((entry, key(entry)?, label))
        });
    let labelled: Vec<(&ActionEntry, String, String)> = own.chain(general).collect();
    let needed = |entry: &ActionEntry| is_always(entry) || entry.group == Group::Learn;
    let hints = labelled
        .into_iter()
        .map(|(entry, key, label)| (needed(entry), key, label));
    fitted(&hints.collect::<Vec<_>>(), room, &app.theme)
}

/// Whether the footer always shows an action.
fn is_always(entry: &ActionEntry) -> bool {
    ALWAYS.contains(&entry.name)
}

/// The hints that fit, in order; the required ones get space first. Each is a flag for required, a key and a label.
fn fitted(hints: &[(bool, String, String)], room: usize, theme: &Theme) -> Line<'static> {
    let width = |key: &str, label: &str| key.width() + label.width() + 3;
    let needed = hints.iter().filter(|(needed, ..)| *needed);
    let mut left = needed.fold(room, |left, (_, key, label)| {
        left.saturating_sub(width(key, label))
    });
    let mut spans = Vec::new();
    for (needed, key, label) in hints {
        let width = width(key, label);
        if !needed {
            if width > left {
                continue;
            }
            left -= width;
        }
        spans.extend(hint(key, label, theme));
    }
    Line::from(spans)
}

/// Label of an action; for Tab, the page number if panes are shown one at a time.
fn label(entry: &ActionEntry, app: &App, places: &ScreenAreas) -> String {
    if entry.name == "pane" && places.paged {
        return format!("page {}/{}", app.panes.focus.page(), Pane::ALL.len());
    }
    entry.label.into()
}
