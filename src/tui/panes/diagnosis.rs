//! The diagnosis: What, Why and Try, and below them the loop, the census, the rates and the details. Enter takes the selected line
//! of Try, or folds the selected part below. If nothing failed, the consistent states are listed side by side, and Enter starts from the selected one.

use crate::app::App;
use crate::copied::NamedText;
use crate::layout::Pane;
use crate::paint;
use crate::pane_entry::{PaneEntry, frame};
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use stickslip_core::NodeAnswer;
use stickslip_core::interface::census::Census;
use stickslip_debugger::DiagnosisPage;
use stickslip_debugger::explain::facts::Part;
use stickslip_debugger::explain::try_list::TryOutcome;
use stickslip_scene::number;
use stickslip_scene::shown;
use unicode_width::UnicodeWidthStr;

/// Width of a consistent state's column: a letter and three numbers.
const CELL: usize = 34;
const NAME: usize = 12;
/// Maximum number of nodes listed; if there are more, nodes in which the states differ come first.
const MOST_LISTED: usize = 8;

/// Number of rows of the diagnosis that can be selected above its parts: lines of Try, or consistent states.
pub fn choices(page: &DiagnosisPage) -> usize {
    let states = page.found.census.as_ref();
    match page.tries.len() {
        0 => states.map_or(0, |census| census.answers.len()),
        tries => tries,
    }
}

/// The pane.
pub const PANE: PaneEntry = PaneEntry {
    draw,
    actions: &[("repeat", "take"), ("page-down", "scroll")],
    copied,
    is_ahead: true,
};

/// The diagnosis; of a finished run, the lines of the selected cure for its deck.
fn copied(app: &App, view: &View) -> Result<NamedText, String> {
    if let Some(run) = &view.model.finished {
        // As many as in the list Try.
        let cure = run
            .findings
            .iter()
            .filter(|found| !found.cure.is_empty())
            .take(app.answer + 1)
            .last();
        let cure = cure.filter(|cure| !cure.lines.is_empty());
        let cure = cure.ok_or("this cure has no lines for the deck")?;
        return Ok(("the lines for the deck".into(), cure.lines.clone()));
    }
    let found = view
        .examination()
        .flatten()
        .ok_or("no diagnosis yet; press d")?;
    Ok(("the diagnosis".into(), found.lines().join("\n")))
}

/// Draws the diagnosis.
fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let theme = &app.theme;
    let width = usize::from(area.width.saturating_sub(2));
    let height = usize::from(area.height.saturating_sub(2));
    let mut title = "Diagnosis".to_string();
    let found = match view.examination() {
        None => Err(
            "No diagnosis yet. Press d (or :census) to analyse the problem that is solved next.",
        ),
        Some(None) => Err("Analysing …"),
        Some(Some(found)) => Ok(found),
    };
    let lines = match found {
        Err(text) => paint::wrapped(text, width, theme.faint),
        Ok(page) => {
            if !page.going_on.is_empty() {
                title += &format!(" ({})", page.going_on);
            }
            let (mut lines, selected) = words(page, width, app);
            let mut answers = answers(page, width, app, view);
            if page.found.fails {
                lines.append(&mut answers);
            }
            // A list of states to select from must be visible; the text above it scrolls.
            let room = height.saturating_sub(answers.len());
            let least = match app.scroll {
                0 => (selected + 1).saturating_sub(room),
                scroll => scroll,
            };
            let top = least.min(lines.len().saturating_sub(room));
            if room < lines.len() {
                let end = top + room;
                title += &format!("  lines {} to {end} of {} (PageDown)", top + 1, lines.len());
            }
            lines = lines.into_iter().skip(top).take(room).collect();
            lines.extend(answers);
            lines
        }
    };
    let inner = frame(buffer, area, Pane::Diagnosis, &title, app);
    paint::lines(buffer, inner, &lines);
}

/// Width of the column of headings.
const HEADINGS: usize = 7;

/// The page as lines, and the row of the selected line of Try.
fn words(page: &DiagnosisPage, width: usize, app: &App) -> (paint::Lines, usize) {
    let theme = &app.theme;
    let mut lines = Vec::new();
    let strong = if page.found.fails {
        theme.strong
    } else {
        theme.text
    };
    hang(&mut lines, "What", &page.what, (width, strong, ""), app);
    for (k, text) in page.why.iter().enumerate() {
        let heading = if k == 0 { "Why" } else { "" };
        hang(&mut lines, heading, text, (width, theme.text, ""), app);
    }
    let choices = choices(page);
    // Trials that end may shorten the page.
    let at = app
        .answer
        .min((choices + page.below.len()).saturating_sub(1));
    let mut selected = 0;
    for (k, line) in page.tries.iter().enumerate() {
        let heading = if k == 0 { "Try" } else { "" };
        let style = match line.outcome {
            _ if k == at => theme.selected,
            TryOutcome::Works => theme.good,
            TryOutcome::Untried => theme.text,
            TryOutcome::Fails => theme.faint,
        };
        let cursor = if k == at { "▸" } else { " " };
        let number = format!("{cursor}{} {} ", k + 1, line.mark());
        hang(
            &mut lines,
            heading,
            &line.words(),
            (width, style, &number),
            app,
        );
        if k == at {
            selected = lines.len() - 1;
        }
    }
    for (k, (part, texts)) in page.below.iter().enumerate() {
        let (mut heading, mut style) = (format!(" {}", part.heading()), theme.heading);
        let folded = app.folded.contains(part);
        if folded {
            heading += " … (Enter)";
        }
        if at == choices + k {
            (style, selected) = (theme.selected, lines.len());
        }
        lines.push(Line::styled(heading, style));
        for text in texts.iter().filter(|_| !folded) {
            match part {
                // A table is not wrapped.
                Part::Loop => {
                    let text = paint::cut(text, width.saturating_sub(4));
                    lines.push(Line::styled(format!("   {text}"), theme.text));
                }
                _ => below(&mut lines, text, width, app),
            }
        }
    }
    (lines, selected)
}

/// Adds a text next to a heading; further lines are indented to the text, which begins after `lead`.
fn hang(
    lines: &mut paint::Lines,
    heading: &str,
    text: &str,
    (width, style, lead): (usize, Style, &str),
    app: &App,
) {
    let room = width.saturating_sub(HEADINGS + 1 + lead.width());
    let heading = format!(" {heading:<width$}", width = HEADINGS - 1);
    let lead = [
        Span::styled(heading, app.theme.heading),
        Span::styled(lead.to_owned(), style),
    ];
    lines.extend(paint::hanging(&lead, text, room, style));
}

/// Adds a line below a heading; its further lines are indented.
fn below(lines: &mut paint::Lines, text: &str, width: usize, app: &App) {
    let indent = text.len() - text.trim_start().len() + 3;
    let wrapped = paint::wrap(text.trim_start(), width.saturating_sub(indent + 3));
    for (k, part) in wrapped.into_iter().enumerate() {
        let indent = if k == 0 { indent } else { indent + 2 };
        let text = format!("{:indent$}{part}", "");
        lines.push(Line::styled(text, app.theme.text));
    }
}

/// The consistent states side by side, as many as fit, including the selected one.
fn answers(page: &DiagnosisPage, width: usize, app: &App, view: &View) -> paint::Lines {
    let (theme, found) = (&app.theme, &page.found);
    let (Some(census), Some(problem)) = (&found.census, &found.problem) else {
        return Vec::new();
    };
    let count = census.answers.len();
    if count == 0 {
        return Vec::new();
    }
    // Where there are lines of Try, those are selected.
    let selects = page.tries.is_empty();
    let at = if selects {
        app.answer.min(count - 1)
    } else {
        0
    };
    let fit = (width.saturating_sub(NAME + 2) / CELL).clamp(1, count);
    let first = (at + 1).saturating_sub(fit);
    let shown = first..(first + fit).min(count);
    let mut head = vec![Span::styled(
        format!(" {:<NAME$} ", "consistent"),
        theme.heading,
    )];
    for number in shown.clone() {
        let style = if selects && number == at {
            theme.selected
        } else {
            theme.heading
        };
        let mark = if selects && number == at { "▸" } else { " " };
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
            spans.extend(cell(answer, app, view));
        }
        lines.push(Line::from(spans));
    }
    let left = problem.nodes.len() - listed.len();
    if left > 0 {
        let all = (0..problem.nodes.len()).filter(|&place| differs(census, place));
        let text = if all.count() > listed.len() {
            format!(" and {left} more")
        } else {
            format!(" and {left} more, the same in all states")
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
    let text = if selects {
        format!(
            "{more} Up and Down select, Enter starts from it (:start-from {})",
            at + 1
        )
    } else {
        format!("{more} :start-from N starts from state N")
    };
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

fn cell(answer: &NodeAnswer, app: &App, view: &View) -> [Span<'static>; 2] {
    let mode = answer.assumed.mode();
    let letter = match answer.assumed {
        stickslip_core::interface::problem::AssumedMode::Plus => "S+",
        stickslip_core::interface::problem::AssumedMode::Minus => "S-",
        stickslip_core::interface::problem::AssumedMode::Free => "F ",
        stickslip_core::interface::problem::AssumedMode::Fixed => "X ",
    };
    let last = match mode {
        stickslip_core::Mode::Free => answer.gap,
        _ => answer.slip,
    };
    let round_off = view.round_off();
    let [f_n, f_t] = [answer.f_n, answer.f_t].map(|force| round_off.force(force));
    let numbers = [f_n, f_t, round_off.length(last)].map(|value| number::fixed_width(value, 10));
    [
        Span::styled(format!(" {letter}"), app.theme.lit(mode)),
        Span::raw(format!(" {:<width$}", numbers.concat(), width = CELL - 4)),
    ]
}
