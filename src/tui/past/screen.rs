//! The whole screen of a run that is over, and where everything stands on it.

use super::app::{App, Overlay, Pane};
use super::panes;
use crate::tui::paint;
use crate::tui::screen::{harmless, plain};
use ratatui::buffer::Buffer;
use ratatui::layout::{Constraint, Layout, Rect};

/// Rows of the status: the run, the place, the iteration, and two of how the attempt ended with its cycle.
const STATUS: u16 = 5;
/// Fewest rows of a pane under the timeline.
const PAGE: u16 = 7;
/// Size from which on all panes are seen at once.
const WIDE: u16 = 110;
const HIGH: u16 = 24;

/// Draws everything.
pub fn draw(buffer: &mut Buffer, area: Rect, app: &App) {
    buffer.set_style(area, app.theme.ground);
    let width = usize::from(area.width);
    let status = match area.height {
        0..=5 => area.height.min(1),
        6..=15 => 2,
        _ => STATUS,
    };
    let (message, keys) = panes::footer(app, width);
    let footer = u16::from(area.height > 6);
    let rows = [status, area.height - status - 2 * footer, 2 * footer].map(Constraint::Length);
    let [status, body, foot] = Layout::vertical(rows).areas(area);
    match &app.overlay {
        Overlay::Help(top, search) => panes::draw_help(buffer, body, (*top, search), app),
        _ => {
            for (pane, area) in places(body, app) {
                panes::draw(pane, buffer, area, app);
            }
        }
    }
    // The place is what a screen of one line must show.
    let skipped = usize::from(status.height < 3);
    let told = panes::status(app, width, usize::from(status.height) + skipped);
    paint::over(buffer, status, &told[skipped..], &app.theme);
    // A message of several lines begins further up, over the panes.
    let most = usize::from(area.height / 2).max(1);
    let lines: Vec<_> = match footer {
        0 => Vec::new(),
        _ if message.is_empty() => [vec![" ".into()], keys].concat(),
        _ => [message, keys].concat(),
    };
    let lines = &lines[..lines.len().min(most.max(2))];
    let height = lines.len() as u16;
    let foot = Rect {
        y: foot.bottom().saturating_sub(height),
        height,
        ..foot
    };
    paint::over(buffer, foot, lines, &app.theme);
    harmless(buffer, area);
}

/// Which panes are shown where.
fn places(body: Rect, app: &App) -> Vec<(Pane, Rect)> {
    if app.zoomed {
        return vec![(app.focus, body)];
    }
    let contacts = app.past.run.slaves.len().min(usize::from(u16::MAX / 2)) as u16;
    let wanted = (panes::FRAME + contacts.max(1)).min(body.height.saturating_sub(PAGE));
    if wanted <= panes::FRAME {
        return vec![(app.focus, body)];
    }
    let is_large = body.width >= WIDE && body.height >= HIGH;
    // A large screen leaves the other panes at least half of it.
    let timeline = match is_large {
        true => wanted.min((body.height / 2).max(panes::FRAME + 1)),
        false => wanted,
    };
    let rows = [Constraint::Length(timeline), Constraint::Min(0)];
    let [above, below] = Layout::vertical(rows).areas(body);
    if !is_large {
        return vec![(Pane::Timeline, above), (app.page, below)];
    }
    let columns: [Rect; 3] = Layout::horizontal([2, 3, 2].map(Constraint::Fill)).areas(below);
    let others = [Pane::Residual, Pane::Contacts, Pane::Attempts];
    let mut all = vec![(Pane::Timeline, above)];
    all.extend(others.into_iter().zip(columns));
    all
}

/// The screen as plain text.
pub fn text(app: &App, width: u16, height: u16) -> String {
    plain(width, height, |buffer, area| draw(buffer, area, app))
}
