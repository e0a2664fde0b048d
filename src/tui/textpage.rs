//! Pages of text over the panes, with scrolling and search: the actions, the key bindings, the manual, and the log, the parameters
//! and the text of an attached solver or a finished run.

use crate::paint;
use crate::panes::{help, manual, solver};
use crate::scroll::scrolled;
use crate::theme::Theme;
use crate::view::View;
use PageText::{Actions, Keys, Log, Manual, Parameters, Run};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::Line;
use ratatui::widgets::{Block, Borders, Widget};
use stickslip_debugger::action::{Context, Keymap};
use stickslip_manual::search::Search;
use stickslip_manual::{PAGES, Page};

/// Columns per key.
const ASIDE: usize = 20;

/// The text of a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PageText {
    /// All actions.
    Actions,
    /// The current key bindings, in the format of their file.
    Keys,
    /// A page of the manual.
    Manual(&'static Page),
    /// The log of an attached solver, which follows the end until it is scrolled.
    Log,
    /// A finished run as text.
    Run,
    /// The parameters of an attached solver.
    Parameters,
}

impl PageText {
    /// Lines per page key.
    fn page(self) -> usize {
        match self {
            Manual(_) => 16,
            _ => 10,
        }
    }

    /// The largest first line.
    fn last(self, lines: usize, height: usize) -> usize {
        match self {
            Manual(_) => lines.saturating_sub(1),
            _ => lines.saturating_sub(height),
        }
    }

    /// The keys of the page, with their labels.
    pub fn keys(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Actions | Keys => &[("↑↓", "scroll")],
            Manual(_) => &[("↑↓", "scroll"), ("←→", "page")],
            Log | Run | Parameters => &[("↑↓ ←→", "scroll"), ("End", "follow")],
        }
    }

    /// Its lines on a page of this width.
    pub fn lines(
        self,
        width: usize,
        theme: &Theme,
        keymap: &Keymap,
        context: &Context,
        view: Option<&View>,
    ) -> paint::Lines {
        let attached = view.and_then(|view| view.attached);
        match (self, attached) {
            (Actions, _) => help::page(width, theme, keymap, context),
            (Keys, _) => help::keys(theme, keymap),
            (Manual(page), _) => manual::lines(page, theme),
            (Log, Some(attached)) => solver::log(attached.log, theme),
            (Run, Some(attached)) => solver::run(attached.log, width, theme),
            (Parameters, Some(attached)) => {
                solver::parameters(&attached.offers.parameters, width, context, theme)
            }
            (Log | Run | Parameters, None) => Vec::new(),
        }
    }
}

/// An open page.
#[derive(Debug, Clone)]
pub struct TextPage {
    text: PageText,
    /// The first visible line, from 0; `None` is the end of the log, and the top of other texts.
    top: Option<usize>,
    /// Columns scrolled out on the left.
    aside: usize,
    /// The search in it.
    pub search: Search,
}

impl TextPage {
    /// Opens a page: the log at its end, others at the top.
    pub fn new(text: PageText) -> TextPage {
        TextPage {
            text,
            top: None,
            aside: 0,
            search: Search::default(),
        }
    }

    /// The text.
    pub fn text(&self) -> PageText {
        self.text
    }

    /// Index of the first visible line, out of this many, on a page of this height.
    fn first(&self, lines: usize, height: usize) -> usize {
        let last = self.text.last(lines, height);
        match (self.top, self.text) {
            (Some(top), _) => top.min(last),
            (None, Log) => last,
            (None, _) => 0,
        }
    }

    /// Handles a key in a page of this height; returns false if it closes the page.
    pub fn key(&mut self, name: &str, height: usize, lines: &[String]) -> bool {
        let top = self.first(lines.len(), height);
        // A match near the end is shown at the bottom of the last page.
        let from = self.top.unwrap_or(top);
        if let Some(to) = self.search.key(name, from, lines) {
            self.top = to.or(self.top);
            return true;
        }
        let (page, last) = (self.text.page(), self.text.last(lines.len(), height));
        let name = match (self.text, name) {
            (_, "Esc" | "q")
            | (Actions | Keys, "?" | "F1" | "Enter")
            | (Manual(_), "?" | "F1")
            | (Log | Run | Parameters, "Enter" | "O") => return false,
            (Manual(_), "Left" | "h") => return self.turn(PAGES.len() - 1),
            (Manual(_), "Right" | "l") => return self.turn(1),
            (Manual(_), "End" | "G") => {
                self.top = Some(lines.len().saturating_sub(page));
                return true;
            }
            (Manual(_), "Enter") => "Down",
            (Log | Run | Parameters, "Left" | "h") => {
                self.aside = self.aside.saturating_sub(ASIDE);
                return true;
            }
            (Log | Run | Parameters, "Right" | "l") => {
                self.aside += ASIDE;
                return true;
            }
            (_, name) => name,
        };
        if let Some(to) = scrolled(top, name, page, last) {
            // Scrolling back to the end of the log follows it again.
            self.top = (to < last || self.text != Log).then_some(to);
        }
        true
    }

    /// Goes to another page of the manual.
    fn turn(&mut self, by: usize) -> bool {
        let here = PAGES.iter().position(|page| self.text == Manual(page));
        let next = &PAGES[(here.unwrap_or(0) + by) % PAGES.len()];
        let search = std::mem::take(&mut self.search);
        *self = TextPage {
            search,
            ..TextPage::new(Manual(next))
        };
        true
    }

    fn title(&self, top: usize, lines: usize, height: usize, view: Option<&View>) -> String {
        let found = self.search.title();
        let of_solver = || {
            let attached = view.and_then(|view| view.attached);
            attached.map_or("", |attached| &attached.offers.name)
        };
        let what = match (self.text, found) {
            (Manual(page), Some(missed)) if self.search.typed().is_none() => {
                return format!("{}: {missed}", page.topic);
            }
            (_, Some(found)) => return found,
            (Manual(page), None) => {
                let (topic, about) = (page.topic, page.about);
                return format!("Manual: {topic}  {}/{lines}  {about}", top + 1);
            }
            (Actions, None) => return "Help".into(),
            (Keys, None) => return "Keys".into(),
            (Log, None) => format!("Log of {}", of_solver()),
            (Run, None) => "Text of the run".into(),
            (Parameters, None) => format!("Parameters of {}", of_solver()),
        };
        if lines <= height {
            return what;
        }
        let end = (top + height).min(lines);
        format!("{what}  lines {} to {end} of {lines}", top + 1)
    }
}

/// Draws the page.
pub fn draw(
    buffer: &mut Buffer,
    area: Rect,
    page: &TextPage,
    theme: &Theme,
    keymap: &Keymap,
    context: &Context,
    view: Option<&View>,
) {
    let width = usize::from(area.width.saturating_sub(2));
    let height = usize::from(area.height.saturating_sub(2));
    let lines = page.text.lines(width, theme, keymap, context, view);
    let top = page.first(lines.len(), height);
    let title = page.title(top, lines.len(), height, view);
    let inner = if let Manual(_) = page.text {
        let title = paint::cut(&title, width.saturating_sub(2));
        let block = Block::new()
            .borders(Borders::TOP)
            .border_style(theme.focus)
            .title(Line::styled(format!(" {title} "), theme.focus));
        let inner = block.inner(area);
        block.render(area, buffer);
        inner
    } else {
        paint::frame(buffer, area, &title, true, theme)
    };
    let line = |line: &Line<'static>| {
        let whole = line.to_string();
        let found = page.search.holds(&whole);
        let style = if found { theme.selected } else { line.style };
        match page.text {
            Log | Run | Parameters => {
                let text: String = whole.chars().skip(page.aside).collect();
                let text = paint::cut(&text, width.saturating_sub(1));
                Line::styled(format!(" {text}"), style)
            }
            _ if found => Line::styled(whole, style),
            _ => line.clone(),
        }
    };
    let shown = lines.iter().skip(top).take(inner.height.into()).map(line);
    paint::lines(buffer, inner, &shown.collect::<Vec<_>>());
}
