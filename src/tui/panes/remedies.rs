//! The remedies that were tried, with their cost and result; the selected one can be applied.

use crate::app::App;
use crate::copied::NamedText;
use crate::layout::Pane;
use crate::paint;
use crate::pane_entry::{PaneEntry, frame};
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use stickslip_debugger::RemedyTrial;
use stickslip_debugger::explain::remedies::{self, COLUMNS, TrialEnd, rank};
use unicode_width::UnicodeWidthStr;

/// Indices into [`COLUMNS`], the most important first; a narrow screen shows those that fit.
const ORDER: [usize; 10] = [0, 1, 3, 5, 6, 7, 9, 8, 4, 2];
/// Lines above the first remedy.
const HEAD: usize = 2;
/// Minimum width of the remedies' names.
const NAME: usize = 26;

/// The pane.
pub const PANE: PaneEntry = PaneEntry {
    draw,
    actions: &[("repeat", "apply")],
    copied,
    is_ahead: true,
};

/// The selected remedy: its entry for the scene, or its row.
fn copied(app: &App, view: &View) -> Result<NamedText, String> {
    let trials = view.trials();
    let at = app.remedy.min(trials.len().saturating_sub(1));
    let trial = trials
        .get(at)
        .ok_or("no remedy tried yet; press r to try all")?;
    if let Some(entry) = trial.how.scene_entry() {
        return Ok(("the entry for the scene".into(), entry));
    }
    let mut cells = vec![trial.label.clone()];
    cells.extend(remedies::row(trial));
    Ok(("the remedy".into(), cells.join("\t")))
}

/// Draws the list.
fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let theme = &app.theme;
    let tried = view.background.and_then(|background| background.tried());
    let Some(tried) = tried else {
        let inner = frame(buffer, area, Pane::Remedies, "Remedies", app);
        let text = match view.model.finished {
            None => "Press r to try every remedy separately from the shown state.",
            Some(_) => "The cures of a finished run are in its diagnosis (d).",
        };
        paint::note(buffer, inner, text, theme);
        return;
    };
    let title = format!(
        "Remedies  tried from step {} of b{}",
        tried.place.1,
        tried.place.0 + 1
    );
    let inner = frame(buffer, area, Pane::Remedies, &title, app);
    let trying = view.is_trying();
    let count = tried.trials.len();
    let state = match (trying, tried.all) {
        (true, Some(all)) => format!("{count} of {all} tried; Ctrl-C stops; now: {}", tried.now),
        (true, None) => "running a census; Ctrl-C stops after it …".into(),
        (false, _) if tried.stopped => format!("stopped after {count}"),
        (false, _) if count == 0 => "nothing to remedy: the history is complete".into(),
        (false, _) => {
            let good = tried
                .trials
                .iter()
                .filter(|t| t.end == TrialEnd::Converged)
                .count();
            format!("{good} of {count} converge; Enter applies the selected one in a new branch")
        }
    };
    let width = usize::from(inner.width);
    let rows: Vec<[String; 10]> = tried.trials.iter().map(remedies::row).collect();
    let shown = shown(&rows, width);
    let digits = count.to_string().len();
    let longest = tried.trials.iter().map(|trial| trial.label.width() + 3);
    let names = width
        .saturating_sub(3 + shown.iter().map(|(_, w)| w + 2).sum::<usize>())
        .min(longest.max().unwrap_or(0).max(NAME));
    let mut head = vec![Span::raw(format!("   {:<names$}", "remedy"))];
    head.extend(
        shown
            .iter()
            .map(|&(k, w)| Span::raw(format!("  {:>w$}", COLUMNS[k]))),
    );
    let mut lines = vec![
        Line::styled(
            format!(" {state}"),
            if trying { theme.warning } else { theme.text },
        ),
        Line::from(head).style(theme.heading),
    ];
    let at = app.remedy.min(count.saturating_sub(1));
    let room = usize::from(inner.height).saturating_sub(HEAD);
    let top = (at + 1).saturating_sub(room);
    for (number, (trial, row)) in tried
        .trials
        .iter()
        .zip(&rows)
        .enumerate()
        .skip(top)
        .take(room)
    {
        let (mark, style) = mark(trial, app);
        let selected = number == at;
        let name = format!("{:<digits$} {}", number + 1, trial.label);
        let name_style = if selected { theme.selected } else { theme.text };
        let [name, blank] = paint::cell(&name, names, name_style);
        let mut spans = vec![
            paint::cursor(selected, theme),
            Span::styled(mark, style),
            Span::raw(" "),
            name,
            blank,
        ];
        spans.extend(shown.iter().flat_map(|&(k, w)| {
            let style = if k == 0 { style } else { theme.text };
            let before = " ".repeat(2 + w.saturating_sub(row[k].width()));
            [Span::raw(before), Span::styled(row[k].clone(), style)]
        }));
        lines.push(Line::from(spans));
    }
    paint::lines(buffer, inner, &lines);
}

/// The remedy in the row at a screen position.
pub fn row_at(area: Rect, app: &App, view: &View, at: Position) -> Option<usize> {
    let tried = view.background?.tried()?;
    let selected = app.remedy.min(tried.trials.len().saturating_sub(1));
    let room = usize::from(area.height).saturating_sub(2 + HEAD);
    let top = (selected + 1).saturating_sub(room);
    let row = usize::from(at.y).checked_sub(usize::from(area.y) + 1 + HEAD)?;
    (row < room && top + row < tried.trials.len()).then_some(top + row)
}

/// The columns that fit, in the order of [`COLUMNS`], with their widths.
fn shown(rows: &[[String; 10]], width: usize) -> Vec<(usize, usize)> {
    let wide = |k: usize| {
        rows.iter()
            .map(|row| row[k].width())
            .chain([COLUMNS[k].len()])
            .max()
            .unwrap_or(0)
    };
    let mut room = width.saturating_sub(3 + NAME);
    let mut shown = Vec::new();
    for k in ORDER {
        let wide = wide(k);
        if wide + 2 <= room {
            room -= wide + 2;
            shown.push((k, wide));
        }
    }
    shown.sort_unstable();
    shown
}

/// Mark of a trial: converged cleanly, converged with warnings, or not converged.
fn mark(trial: &RemedyTrial, app: &App) -> (&'static str, Style) {
    let theme = &app.theme;
    match rank(trial) {
        0 => ("✓", theme.good),
        1 => ("~", theme.warning),
        _ => ("✗", theme.bad),
    }
}
