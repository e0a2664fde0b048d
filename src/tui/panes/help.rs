//! The help (`?`): all actions with their keys, and the marks on the screen; and the list of current key bindings, in the
//! format of the file that changes them.

use crate::layout::Pane;
use crate::paint;
use crate::theme::Theme;
use ratatui::text::{Line, Span};
use stickslip_debugger::action::config;
use stickslip_debugger::action::{ACTIONS, Context, Group, Keymap};
use stickslip_scene::joined;

/// The marks on the screen.
const MARKS: &[(&str, &str)] = &[
    ("f s x", "free, sliding, fixed"),
    ("*", "the mode changes"),
    (
        "~",
        "T_max has not settled: the next minor iteration uses a new value",
    ),
    ("◇ ◆", "mode forced once; mode held"),
    (
        "◀ ◁",
        "the cell of Table 2 that fired; the one that fires if the mode is not held",
    ),
    (
        "margin",
        "distance of the tested inequality from switching; negative: switched",
    ),
    (
        "≠",
        "an attached solver's decision differs from Table 2 (or Newton) for the same values",
    ),
    ("tie", "closer to switching than the tolerance"),
];

/// The first keys to learn.
const FIRST: [&str; 10] = [
    "step",
    "next",
    "finish",
    "continue",
    "reverse-step",
    "pane",
    "zoom",
    "explain",
    "diagnosis",
    "command",
];

/// Widths of the columns of keys and names.
const KEYS: usize = 14;
const NAMES: usize = 23;

/// The whole page. Help texts wrap on a narrow screen. Actions that the current solver does not support are dim and state the
/// reason.
pub fn page(width: usize, theme: &Theme, keymap: &Keymap, context: &Context) -> paint::Lines {
    let finished = context.model.filter(|model| model.finished.is_some());
    let mut lines = match finished {
        Some(model) => paint::wrapped(&model.about, width, theme.warning),
        None => Vec::new(),
    };
    let first = || ACTIONS.iter().filter(|entry| FIRST.contains(&entry.name));
    let panes = joined(Pane::ALL.into_iter().map(Pane::title), ", ");
    let groups = Group::ALL.into_iter().map(|group| {
        let entries = ACTIONS.iter().filter(|entry| entry.group == group);
        (group.title(), entries.collect::<Vec<_>>())
    });
    let text = format!("Panes, in the order of Tab: {panes}.");
    lines.extend(paint::wrapped(&text, width, theme.text));
    lines.push(Line::default());
    for (title, entries) in [("The first ten keys", first().collect())]
        .into_iter()
        .chain(groups)
    {
        lines.push(Line::styled(format!(" {title}"), theme.heading));
        for entry in &entries {
            let name = format!("{} {}", entry.name, entry.arguments);
            let room = width.saturating_sub(3 + KEYS + NAMES + 1).max(20);
            let (help, [key_style, style]) = match entry.offered(context) {
                Ok(()) => (entry.help.to_owned(), [theme.key, theme.text]),
                Err(why) => (
                    format!("({}) Not available: {why}.", entry.help),
                    [theme.faint; 2],
                ),
            };
            let keys = joined(keymap.keys(entry), " ");
            let lead = [
                Span::styled(format!("   {keys:<KEYS$}"), key_style),
                Span::styled(format!("{name:<NAMES$}"), style),
            ];
            lines.extend(paint::hanging(&lead, &help, room, style));
        }
        lines.push(Line::default());
    }
    lines.push(Line::styled(" Marks", theme.heading));
    let room = width.saturating_sub(3 + KEYS + 1).max(20);
    for (mark, meaning) in MARKS {
        let lead = Span::styled(format!("   {mark:<KEYS$}"), theme.key);
        lines.extend(paint::hanging(&[lead], meaning, room, theme.text));
    }
    lines
}

/// The current key bindings, and the file that changes them.
pub fn keys(theme: &Theme, keymap: &Keymap) -> paint::Lines {
    let file = config::folder().map(|folder| folder.join(config::KEYS));
    let file = file.map_or(config::KEYS.into(), |file| file.display().to_string());
    let state = if keymap.is_changed() {
        "key bindings, with the changes in this file; :copy keys copies them"
    } else {
        "key bindings, in the format of this file; :copy keys copies them"
    };
    let mut lines = vec![
        Line::styled(format!(" {state}"), theme.faint),
        Line::styled(format!(" {file}"), theme.faint),
        Line::raw(" {"),
    ];
    for (group, entries) in keymap.listed() {
        lines.push(Line::styled(
            format!("     // {}", group.title()),
            theme.faint,
        ));
        lines.extend(entries.iter().map(|line| Line::raw(format!("     {line}"))));
    }
    lines.push(Line::raw(" }"));
    lines
}
