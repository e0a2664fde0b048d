//! A page of the manual over the whole screen.

use crate::paint;
use crate::theme::Theme;
use ratatui::text::{Line, Span};
use stickslip_manual::Page;
use stickslip_manual::render::{self, Line as Shown, Style};

/// The lines of a page. They are 80 columns wide on any screen, so that line numbers do not depend on the screen.
pub fn lines(page: &Page, theme: &Theme) -> paint::Lines {
    let lines = render::render(page.text(), render::WIDTH);
    lines.iter().map(|line| styled(line, theme)).collect()
}

fn styled(line: &Shown, theme: &Theme) -> Line<'static> {
    let span = |(style, text): &(Style, String)| {
        let style = match style {
            Style::Plain => theme.text,
            Style::Heading => theme.heading.underlined(),
            Style::Strong => theme.strong,
            Style::Code => theme.key,
        };
        Span::styled(text.clone(), style)
    };
    Line::from(line.pieces.iter().map(span).collect::<Vec<_>>())
}
