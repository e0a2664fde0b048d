//! Pages of an attached solver: its log (messages, standard error and events), which follows the end until it is scrolled, and the
//! parameters that
//! `:set` changes, with their current values; and the text of a finished run.

use crate::paint;
use crate::scroll::scrolled;
use crate::theme::Theme;
use crate::view::{View, context};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;
use stickslip_core::step::intervene::Value;
use stickslip_core::{Parameter, counted};
use stickslip_debugger::action::present;
use stickslip_debugger::recorded::log::{LogLine, LogOrigin};
use stickslip_exchange::attach::message::Level;
use stickslip_manual::search::Search;
use stickslip_scene::{joined, number, shown};

/// Rows and columns per page key.
const PAGE: usize = 10;
const ASIDE: usize = 20;
/// Width of the column with the kind of a log line.
const HOW: usize = 8;

/// The page that is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Page {
    /// The solver's log.
    Log,
    /// A finished run as text.
    Run,
    /// The solver's parameters.
    Parameters,
}

/// An open page.
#[derive(Debug, Clone)]
pub struct SolverReader {
    /// The page.
    pub page: Page,
    /// The first visible row, from 0; `None` follows the end of a growing page and shows the top of others.
    top: Option<usize>,
    /// Columns scrolled out on the left.
    aside: usize,
    /// The search in it.
    pub search: Search,
}

impl SolverReader {
    /// Opens a page: the log at its end, others at the top.
    pub fn new(page: Page) -> SolverReader {
        SolverReader {
            page,
            top: None,
            aside: 0,
            search: Search::default(),
        }
    }

    /// The first visible row of `rows`, for a page of this height.
    fn first(&self, rows: usize, height: usize) -> usize {
        let last = rows.saturating_sub(height);
        match (self.top, self.page) {
            (Some(top), _) => top.min(last),
            (None, Page::Log) => last,
            (None, _) => 0,
        }
    }

    /// Handles a key in a page of this size; returns false if it closes the page.
    pub fn key(&mut self, name: &str, size: Rect, view: Option<&View>) -> bool {
        let rows = rows(self.page, size.width.into(), view, &Theme::mono());
        let height = usize::from(size.height);
        let (top, last) = (
            self.first(rows.len(), height),
            rows.len().saturating_sub(height),
        );
        let texts: Vec<String> = rows.iter().map(Line::to_string).collect();
        if let Some(to) = self.search.key(name, top, &texts) {
            self.top = to.or(self.top);
            return true;
        }
        match name {
            "Esc" | "q" | "Enter" | "O" => return false,
            "Left" | "h" => self.aside = self.aside.saturating_sub(ASIDE),
            "Right" | "l" => self.aside += ASIDE,
            _ => {
                if let Some(to) = scrolled(top, name, PAGE, last) {
                    // Scrolling back to the end follows it again.
                    self.top = (to < last || self.page != Page::Log).then_some(to);
                }
            }
        }
        true
    }
}

/// Draws the page.
pub fn draw(
    buffer: &mut Buffer,
    area: Rect,
    reader: &SolverReader,
    view: Option<&View>,
    theme: &Theme,
) {
    let width = usize::from(area.width.saturating_sub(2));
    let rows = rows(reader.page, width, view, theme);
    let height = usize::from(area.height.saturating_sub(2));
    let top = reader.first(rows.len(), height);
    let name = view
        .and_then(|view| view.attached)
        .map_or("", |attached| &attached.offers.name);
    let title = reader.search.title().unwrap_or_else(|| {
        let what = match reader.page {
            Page::Log => format!("Log of {name}"),
            Page::Run => "Text of the run".into(),
            Page::Parameters => format!("Parameters of {name}"),
        };
        if rows.len() > height {
            format!(
                "{what}  lines {} to {} of {}",
                top + 1,
                (top + height).min(rows.len()),
                rows.len()
            )
        } else {
            what
        }
    });
    let inner = paint::frame(
        buffer,
        area,
        &paint::cut(&title, width.saturating_sub(2)),
        true,
        theme,
    );
    let line = |row: &Line| {
        let whole = row.to_string();
        let text: String = whole.chars().skip(reader.aside).collect();
        let style = if reader.search.holds(&whole) {
            theme.selected
        } else {
            row.style
        };
        let text = paint::cut(&text, width.saturating_sub(1));
        Line::styled(format!(" {text}"), style)
    };
    let lines: Vec<Line> = rows.iter().skip(top).take(height).map(line).collect();
    paint::lines(buffer, inner, &lines);
}

fn rows(page: Page, width: usize, view: Option<&View>, theme: &Theme) -> paint::Lines {
    let Some((view, attached)) = view.and_then(|view| Some((view, view.attached?))) else {
        return Vec::new();
    };
    match page {
        Page::Log => log_rows(attached.log.lines(), theme),
        Page::Run => printed(attached.log.lines().1, width, theme),
        Page::Parameters => parameters(&attached.offers.parameters, width, view, theme),
    }
}

/// The text of a finished run; sentences wrap, tables do not.
fn printed(lines: Vec<LogLine>, width: usize, theme: &Theme) -> paint::Lines {
    lines
        .into_iter()
        .filter(|said| said.how == LogOrigin::Printed)
        .flat_map(|said| {
            if said.text.contains("  ") {
                vec![said.text]
            } else {
                paint::wrap(&said.text, width.saturating_sub(2))
            }
        })
        .map(|text| Line::styled(text, theme.text))
        .collect()
}

/// The log, one line per row, the newest last.
fn log_rows((first, lines): (usize, Vec<LogLine>), theme: &Theme) -> paint::Lines {
    let mut rows = Vec::with_capacity(lines.len() + 1);
    match (first, lines.is_empty()) {
        (0, true) => rows.push(Line::styled("No messages yet.", theme.faint)),
        (0, false) => {}
        (gone, _) => rows.push(Line::styled(
            format!("No longer stored: the first {}.", counted(gone, "line")),
            theme.faint,
        )),
    }
    rows.extend(lines.into_iter().map(|said| {
        let style = match said.how {
            LogOrigin::Message(Level::Error) => theme.bad,
            LogOrigin::Message(Level::Warning) => theme.warning,
            LogOrigin::Message(Level::Info) | LogOrigin::Printed => theme.text,
            LogOrigin::Noted => theme.faint,
        };
        Line::styled(format!("{:<HOW$} {}", said.how.word(), said.text), style)
    }));
    rows
}

/// The parameters: current value, range and description.
fn parameters(all: &[Parameter], width: usize, view: &View, theme: &Theme) -> paint::Lines {
    let context = context(Some(view), 0, &[]);
    let mut rows = Vec::new();
    for known in all {
        let name = shown::line(&known.name);
        let began = match &known.value {
            Value::Number(value) => number::shortest(*value),
            other => other.to_string(),
        };
        let now = present(known, &context);
        let began = if now == began {
            String::new()
        } else {
            format!("initially {began}")
        };
        let range = known.range.to_string();
        // A description that lists the choices wraps; the range would be cut.
        let range = if known.about == range { "" } else { &range };
        let notes = joined(
            [range, &began].into_iter().filter(|text| !text.is_empty()),
            ", ",
        );
        let notes = if notes.is_empty() {
            notes
        } else {
            format!("   ({notes})")
        };
        let text = format!("{name} = {now}{notes}");
        rows.push(Line::styled(shown::line(&text).into_owned(), theme.strong));
        let about = paint::wrap(&known.about, width.saturating_sub(6));
        let about = about.iter().filter(|line| !line.is_empty());
        rows.extend(about.map(|line| Line::styled(format!("    {line}"), theme.text)));
    }
    let last = if all.is_empty() {
        "The solver has no parameters."
    } else {
        ":set NAME VALUE changes one from here on."
    };
    rows.push(Line::styled(last, theme.faint));
    rows
}
