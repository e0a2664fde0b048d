//! Texts about an attached solver: its log (messages, standard error and events), the parameters that `:set` changes with their
//! current values, and the text of a finished run.

use crate::paint;
use crate::theme::Theme;
use ratatui::text::Line;
use stickslip_core::step::intervene::Value;
use stickslip_core::{Parameter, counted};
use stickslip_debugger::action::{Context, present};
use stickslip_debugger::recorded::log::{Log, LogOrigin};
use stickslip_exchange::attach::message::Level;
use stickslip_scene::{joined, number, shown};

/// Width of the column with the kind of a log line.
const HOW: usize = 8;

/// The text of a finished run; sentences wrap, tables do not.
pub fn run(log: &Log, width: usize, theme: &Theme) -> paint::Lines {
    log.lines()
        .1
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
pub fn log(log: &Log, theme: &Theme) -> paint::Lines {
    let (first, lines) = log.lines();
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
pub fn parameters(
    all: &[Parameter],
    width: usize,
    context: &Context,
    theme: &Theme,
) -> paint::Lines {
    let mut rows = Vec::new();
    for known in all {
        let name = shown::line(&known.name);
        let began = match &known.value {
            Value::Number(value) => number::shortest(*value),
            other => other.to_string(),
        };
        let now = present(known, context);
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
