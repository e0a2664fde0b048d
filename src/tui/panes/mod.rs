//! The panes, pages and bars of the screen, one file each. Each is a function that draws the app and the view into an area, with
//! the helpers of [`crate::paint`] and without reference to another pane.

pub mod branches;
pub mod chooser;
pub mod contact;
pub mod curve;
pub mod decision;
pub mod diagnosis;
pub mod footer;
pub mod help;
pub mod lesson;
pub mod manual;
pub mod nodes;
pub mod remedies;
pub mod residual;
pub mod shape;
pub mod solver;
pub mod status;
pub mod timeline;
pub mod workprecision;

use crate::app::App;
use crate::layout::Pane;
use crate::paint;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// Draws the frame of a pane, and returns the area inside.
pub fn frame(buffer: &mut Buffer, area: Rect, pane: Pane, title: &str, app: &App) -> Rect {
    paint::frame(buffer, area, title, app.panes.focus == pane, &app.theme)
}
