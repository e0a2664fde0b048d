//! The diagnosis: why the minor iterations cycle from the shown state, or which states are consistent. The consistent states are
//! listed side by side; the selected one can be started from.

use crate::app::App;
use crate::layout::Pane;
use crate::paint;
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use stickslip_core::interface::census::Census;
use stickslip_core::interface::problem::NodeAnswer;
use stickslip_debugger::explain::examination::Examination;
use stickslip_scene::number;
use stickslip_scene::shown;

/// Width of a consistent state's column: a letter and three numbers.
const CELL: usize = 34;
const NAME: usize = 12;
/// Maximum number of nodes listed; if there are more, nodes in which the states differ come first.
const MOST_LISTED: usize = 8;

/// Draws the diagnosis.
pub fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let theme = &app.theme;
    let focused = app.panes.focus == Pane::Diagnosis;
    let width = usize::from(area.width.saturating_sub(2));
    let height = usize::from(area.height.saturating_sub(2));
    let mut title = "Diagnosis".to_string();
    let found = match view.examination() {
        None => Err(
            " No diagnosis yet. Press d (or :census) to analyse the problem that is solved next.",
        ),
        Some(None) => Err(" Analysing …"),
        Some(Some(found)) => Ok(found),
    };
    let lines = match found {
        Err(text) => paint::wrap(text, width)
            .into_iter()
            .map(|line| Line::styled(line, theme.faint))
            .collect(),
        Ok(found) => {
            let answers = answers(found, width, app, view);
            if !found.going_on.is_empty() {
                title += &format!(" ({})", found.going_on);
            }
            let mut lines = words(found, width, app);
            // The list of states must be visible; the text above it scrolls.
            let room = height.saturating_sub(answers.len());
            let top = app.scroll.min(lines.len().saturating_sub(room));
            if room < lines.len() {
                let end = top + room;
                title += &format!("  lines {} to {end} of {} (PageDown)", top + 1, lines.len());
            }
            lines = lines.into_iter().skip(top).take(room).collect();
            lines.extend(answers);
            lines
        }
    };
    let inner = paint::frame(buffer, area, &title, focused, theme);
    paint::lines(buffer, inner, &lines);
}

fn words(found: &Examination, width: usize, app: &App) -> paint::Lines {
    let mut lines = Vec::new();
    for (index, text) in found.lines.iter().enumerate() {
        let style = match index {
            0 if found.fails => app.theme.strong,
            _ if text.starts_with("do:") => app.theme.strong,
            _ => app.theme.text,
        };
        let indent = text.len() - text.trim_start().len() + 1;
        for (part, line) in paint::wrap(text.trim_start(), width.saturating_sub(indent + 4))
            .into_iter()
            .enumerate()
        {
            let indent = if part == 0 { indent } else { indent + 3 };
            lines.push(Line::styled(format!("{:indent$}{line}", ""), style));
        }
    }
    lines
}

/// The consistent states side by side, as many as fit, including the selected one.
fn answers(found: &Examination, width: usize, app: &App, view: &View) -> paint::Lines {
    let theme = &app.theme;
    let (Some(census), Some(problem)) = (&found.census, &found.problem) else {
        return Vec::new();
    };
    let count = census.answers.len();
    if count == 0 {
        return Vec::new();
    }
    let at = app.answer.min(count - 1);
    let fit = (width.saturating_sub(NAME + 2) / CELL).clamp(1, count);
    let first = (at + 1).saturating_sub(fit);
    let shown = first..(first + fit).min(count);
    let mut head = vec![Span::styled(
        format!(" {:<NAME$} ", "consistent"),
        theme.heading,
    )];
    for number in shown.clone() {
        let style = if number == at {
            theme.selected
        } else {
            theme.heading
        };
        let mark = if number == at { "▸" } else { " " };
        let text = format!("{mark}{} ", number + 1);
        let rest = format!(
            "{:<width$}",
            " F_n       F_t       gap/slip",
            width = CELL - 3
        );
        head.extend([Span::styled(text, style), Span::styled(rest, theme.faint)]);
    }
    let mut lines = vec![Line::default(), Line::from(head)];
    let listed = listed(census, problem.nodes.len());
    for &place in &listed {
        let node = &problem.nodes[place];
        let differs = differs(census, place);
        let name = paint::cut(view.slave(node.slave), NAME);
        let mark = if differs { "*" } else { " " };
        let style = if differs { theme.strong } else { theme.text };
        let mut spans = vec![Span::styled(
            format!("{mark}{} ", shown::padded(&name, NAME)),
            style,
        )];
        for number in shown.clone() {
            let answer = &census.answers[number].answer.nodes[place];
            spans.extend(cell(answer, app));
        }
        lines.push(Line::from(spans));
    }
    let left = problem.nodes.len() - listed.len();
    if left > 0 {
        let all = (0..problem.nodes.len()).filter(|&place| differs(census, place));
        let text = match all.count() > listed.len() {
            true => format!(" and {left} more"),
            false => format!(" and {left} more, the same in all states"),
        };
        lines.push(Line::styled(text, theme.faint));
    }
    let more = if !census.exact {
        format!(" at least {count} in all;")
    } else if count > fit {
        format!(" {count} in all;")
    } else {
        String::new()
    };
    let text = format!(
        "{more} Up and Down select, Enter starts from it (:start-from {})",
        at + 1
    );
    lines.push(Line::styled(format!(" {}", text.trim_start()), theme.faint));
    lines
}

/// Indices of the listed nodes: all if they fit, otherwise first those in which the states differ.
fn listed(census: &Census, nodes: usize) -> Vec<usize> {
    let mut listed: Vec<usize> = (0..nodes).collect();
    if nodes > MOST_LISTED {
        listed.sort_by_key(|&place| !differs(census, place));
        listed.truncate(MOST_LISTED);
        listed.sort_unstable();
    }
    listed
}

/// Whether the consistent states differ at a node.
fn differs(census: &Census, place: usize) -> bool {
    let mut all = census
        .answers
        .iter()
        .map(|found| found.answer.nodes[place].assumed);
    let first = all.next();
    all.any(|assumed| Some(assumed) != first)
}

fn cell(answer: &NodeAnswer, app: &App) -> [Span<'static>; 2] {
    let mode = answer.assumed.mode();
    let letter = match answer.assumed {
        stickslip_core::interface::problem::Assumed::Plus => "S+",
        stickslip_core::interface::problem::Assumed::Minus => "S-",
        stickslip_core::interface::problem::Assumed::Free => "F ",
        stickslip_core::interface::problem::Assumed::Fixed => "X ",
    };
    let last = match mode {
        stickslip_core::model::Mode::Free => answer.gap,
        _ => answer.slip,
    };
    let numbers = [answer.f_n, answer.f_t, last].map(|value| number::cell(value, 10));
    [
        Span::styled(format!(" {letter}"), app.theme.lit(mode)),
        Span::raw(format!(" {:<width$}", numbers.concat(), width = CELL - 4)),
    ]
}
