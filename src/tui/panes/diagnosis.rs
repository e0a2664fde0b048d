//! The diagnosis: What, Why and Try, and below them the loop, the census, the rates and the details. Enter takes the selected line
//! of Try, or folds the selected part below.

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
use stickslip_debugger::DiagnosisPage;
use stickslip_debugger::explain::facts::Part;
use stickslip_debugger::explain::try_list::TryOutcome;
use unicode_width::UnicodeWidthStr;

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
            let (lines, selected) = words(page, width, app);
            let least = match app.scroll {
                0 => (selected + 1).saturating_sub(height),
                scroll => scroll,
            };
            let top = least.min(lines.len().saturating_sub(height));
            if height < lines.len() {
                let end = top + height;
                title += &format!("  lines {} to {end} of {} (PageDown)", top + 1, lines.len());
            }
            lines.into_iter().skip(top).take(height).collect()
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
    let choices = page.tries.len();
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
