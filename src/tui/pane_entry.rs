//! What every pane has: an entry, and a frame.

use crate::app::App;
use crate::copied::NamedText;
use crate::layout::Pane;
use crate::paint;
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// What a pane shows and does.
pub struct PaneEntry {
    /// Draws it, with its frame.
    pub draw: fn(&mut Buffer, Rect, &App, &View),
    /// Its actions in the footer, with their labels.
    pub actions: &'static [(&'static str, &'static str)],
    /// The text that `Y` copies, with a name for the message.
    pub copied: fn(&App, &View) -> Result<NamedText, String>,
    /// Whether it shows what a learner still has to predict.
    pub is_ahead: bool,
}

/// Draws the frame of a pane, and returns the area inside.
pub fn frame(buffer: &mut Buffer, area: Rect, pane: Pane, title: &str, app: &App) -> Rect {
    paint::frame(buffer, area, title, app.panes.focus == pane, &app.theme)
}
