//! A page of the manual over the whole screen: scrolled, searched, and turned to the next page.

use crate::manual::render::{self, Line as Shown, Style};
use crate::manual::{PAGES, Page};
use crate::tui::paint;
use crate::tui::theme::Theme;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Widget};

/// Lines that a page key goes past.
const PAGE: usize = 16;

/// A page that is being read. Its lines are 80 columns wide on any screen, so that a place in it is the same on all.
#[derive(Debug, Clone)]
pub struct Reader {
    page: &'static Page,
    lines: Vec<Shown>,
    /// The first line that is shown.
    top: usize,
    /// What is being typed to search for.
    typed: Option<String>,
    /// What was searched for last, in small letters.
    sought: String,
    /// Whether it was not found.
    missed: bool,
}

impl Reader {
    /// A reader at the top of a page.
    pub fn new(page: &'static Page) -> Reader {
        Reader {
            page,
            lines: render::render(page.text, render::WIDTH),
            top: 0,
            typed: None,
            sought: String::new(),
            missed: false,
        }
    }

    /// What is being typed to search for.
    pub fn typed(&self) -> Option<&str> {
        self.typed.as_deref()
    }

    /// What a key does; false if it leaves the page.
    pub fn key(&mut self, name: &str) -> bool {
        if let Some(typed) = &mut self.typed {
            match name {
                "Esc" => self.typed = None,
                "Enter" => {
                    self.sought = typed.to_lowercase();
                    self.typed = None;
                    self.find(self.top);
                }
                "Backspace" => {
                    typed.pop();
                }
                "Space" => typed.push(' '),
                _ if name.chars().count() == 1 => typed.push_str(name),
                _ => {}
            }
            return true;
        }
        let last = self.lines.len().saturating_sub(1);
        match name {
            "Esc" | "q" | "?" | "F1" => return false,
            "Up" | "k" => self.top = self.top.saturating_sub(1),
            "Down" | "j" | "Enter" => self.top = (self.top + 1).min(last),
            "PageUp" => self.top = self.top.saturating_sub(PAGE),
            "PageDown" | "Space" => self.top = (self.top + PAGE).min(last),
            "Home" | "g" => self.top = 0,
            "End" | "G" => self.top = self.lines.len().saturating_sub(PAGE),
            "Left" | "h" => self.turn(PAGES.len() - 1),
            "Right" | "l" => self.turn(1),
            "/" => self.typed = Some(String::new()),
            "n" => self.find(self.top + 1),
            _ => {}
        }
        true
    }

    /// Turns to another page, so many further on.
    fn turn(&mut self, by: usize) {
        let here = PAGES.iter().position(|page| page.topic == self.page.topic);
        let next = (here.unwrap_or(0) + by) % PAGES.len();
        let sought = std::mem::take(&mut self.sought);
        *self = Reader {
            sought,
            ..Reader::new(&PAGES[next])
        };
    }

    /// Goes to the next line from `from` on that holds what is sought, round from the page's start.
    fn find(&mut self, from: usize) {
        if self.sought.is_empty() {
            return;
        }
        let count = self.lines.len();
        let order = (0..count).map(|k| (from + k) % count);
        let holds = |line: &usize| {
            self.lines[*line]
                .text()
                .to_lowercase()
                .contains(&self.sought)
        };
        let found = order.into_iter().find(holds);
        self.missed = found.is_none();
        self.top = found.unwrap_or(self.top);
    }
}

/// Draws the page under a line with its topic, or with what is searched for.
pub fn draw(buffer: &mut Buffer, area: Rect, reader: &Reader, theme: &Theme) {
    let title = match &reader.typed {
        Some(typed) => format!("/{typed}_"),
        None if reader.missed => {
            format!("{}: nothing holds '{}'", reader.page.topic, reader.sought)
        }
        None => {
            let (line, count) = (reader.top + 1, reader.lines.len());
            format!(
                "Manual: {}  {line}/{count}  {}",
                reader.page.topic, reader.page.about
            )
        }
    };
    let room = area.width.saturating_sub(4) as usize;
    let title = Line::styled(format!(" {} ", paint::cut(&title, room)), theme.focus);
    let block = Block::new()
        .borders(Borders::TOP)
        .border_style(theme.focus)
        .title(title);
    let inner = block.inner(area);
    block.render(area, buffer);
    let shown = reader
        .lines
        .iter()
        .skip(reader.top)
        .take(inner.height as usize);
    let lines: Vec<Line> = shown
        .map(|line| styled(line, &reader.sought, theme))
        .collect();
    paint::lines(buffer, inner, &lines);
}

fn styled(line: &Shown, sought: &str, theme: &Theme) -> Line<'static> {
    if !sought.is_empty() && line.text().to_lowercase().contains(sought) {
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
