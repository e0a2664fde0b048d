//! A page of the manual over the whole screen, with scrolling, search and links to the neighbouring pages.

use crate::paint;
use crate::scroll::scrolled;
use crate::theme::Theme;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Widget};
use stickslip_manual::render::{self, Line as Shown, Style};
use stickslip_manual::search::Search;
use stickslip_manual::{PAGES, Page};

/// Lines per page key.
const PAGE: usize = 16;

/// An open page. Its lines are 80 columns wide on any screen, so that line numbers do not depend on the screen.
#[derive(Debug, Clone)]
pub struct Reader {
    page: &'static Page,
    lines: Vec<Shown>,
    /// The first visible line.
    top: usize,
    search: Search,
}

impl Reader {
    /// Opens a page at its top.
    pub fn new(page: &'static Page) -> Reader {
        Reader {
            page,
            lines: render::render(page.text(), render::WIDTH),
            top: 0,
            search: Search::default(),
        }
    }

    /// The search text that is being typed.
    pub fn typed(&self) -> Option<&str> {
        self.search.typed()
    }

    /// Handles a key; returns false if it closes the page.
    pub fn key(&mut self, name: &str) -> bool {
        let lines: Vec<String> = self.lines.iter().map(Shown::text).collect();
        if let Some(to) = self.search.key(name, self.top, &lines) {
            self.top = to.unwrap_or(self.top);
            return true;
        }
        let last = self.lines.len().saturating_sub(1);
        match name {
            "Esc" | "q" | "?" | "F1" => return false,
            "Enter" => self.top = (self.top + 1).min(last),
            "End" | "G" => self.top = self.lines.len().saturating_sub(PAGE),
            "Left" | "h" => self.turn(PAGES.len() - 1),
            "Right" | "l" => self.turn(1),
            _ => self.top = scrolled(self.top, name, PAGE, last).unwrap_or(self.top),
        }
        true
    }

    /// Opens the page `by` pages further on.
    fn turn(&mut self, by: usize) {
        let here = PAGES.iter().position(|page| page.topic == self.page.topic);
        let next = (here.unwrap_or(0) + by) % PAGES.len();
        let search = std::mem::take(&mut self.search);
        *self = Reader {
            search,
            ..Reader::new(&PAGES[next])
        };
    }
}

/// Draws the page below a line with its topic, or with the search text.
pub fn draw(buffer: &mut Buffer, area: Rect, reader: &Reader, theme: &Theme) {
    let (line, count) = (reader.top + 1, reader.lines.len());
    let title = match (reader.search.typed(), reader.search.title()) {
        (Some(_), Some(typed)) => typed,
        (_, Some(missed)) => format!("{}: {missed}", reader.page.topic),
        _ => format!(
            "Manual: {}  {line}/{count}  {}",
            reader.page.topic, reader.page.about
        ),
    };
    let room = area.width.saturating_sub(4) as usize;
    let title = Line::styled(format!(" {} ", paint::cut(&title, room)), theme.focus);
    let block = Block::new()
        .borders(Borders::TOP)
        .border_style(theme.focus)
        .title(title);
    let inner = block.inner(area);
    block.render(area, buffer);
    let lines: Vec<Line> = reader
        .lines
        .iter()
        .skip(reader.top)
        .take(inner.height as usize)
        .map(|line| styled(line, &reader.search, theme))
        .collect();
    paint::lines(buffer, inner, &lines);
}

fn styled(line: &Shown, search: &Search, theme: &Theme) -> Line<'static> {
    if search.holds(&line.text()) {
        return Line::styled(line.text(), theme.selected);
    }
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
