//! Draws the whole screen.

use crate::app::{App, Overlay};
use crate::canvas;
use crate::chooser_state::Preview;
use crate::layout::{self, Choice, Pane, ScreenAreas};
use crate::paint;
use crate::pane_entry::frame;
use crate::panes::chooser;
use crate::panes::entry;
use crate::panes::footer;
use crate::panes::lesson;
use crate::panes::shape;
use crate::panes::status;
use crate::panes::workprecision;
use crate::textpage;
use crate::theme::Theme;
use crate::view::View;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use stickslip_debugger::Session;
use stickslip_debugger::action::Filter;
use stickslip_scene::shown;

/// The area that a page over the panes covers.
pub fn body(places: &ScreenAreas, view: Option<&View>) -> Rect {
    let body = places
        .panes
        .iter()
        .map(|pane| pane.1)
        .reduce(Rect::union)
        .unwrap_or_default();
    match view {
        Some(_) => body,
        // Without a scene the status is only the program's name.
        None => Rect {
            y: places.status.y + 1,
            height: body.bottom().saturating_sub(places.status.y + 1),
            ..body
        },
    }
}

/// Draws everything; without a view (no scene yet), only the chooser.
pub fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: Option<&View>) {
    buffer.set_style(area, app.theme.ground);
    let places = places(app, view, area);
    let body = body(&places, view);
    match (&app.overlay, view) {
        (Overlay::Text(page), _) => {
            let context = app.context(view, &[]);
            textpage::draw(buffer, body, page, &app.theme, &app.keymap, &context, view);
        }
        (Overlay::Chart(page), _) => workprecision::draw(buffer, body, page, &app.theme),
        (Overlay::Chooser(chooser), _) => {
            let picture = chooser::draw(buffer, body, chooser, app);
            if let Some(view) = app.preview.as_ref().and_then(Preview::view) {
                let own = App::new(app.theme, Vec::new());
                shape::picture(buffer, picture, &own, &view);
            }
        }
        (_, None) => {}
        (_, Some(view)) => {
            for (pane, area) in &places.panes {
                draw_pane(*pane, buffer, *area, app, view);
            }
        }
    }
    // These may be longer than their rows.
    status::draw(buffer, &places, app, view);
    footer::draw(buffer, &places, app, view);
    harmless(buffer, area);
    if app.octants {
        canvas::use_octants(buffer);
    }
}

/// The layout for a screen of this size.
pub fn places(app: &App, view: Option<&View>, area: Rect) -> ScreenAreas {
    let rows = view.map_or(0, |_| lesson::rows(app, area.width));
    let model = view.map(|view| view.model);
    let mut panes = app.panes;
    // Before the first iteration there is no decision to show below the table.
    let has_shape = model.is_none_or(|model| model.finished.is_none());
    let is_start = has_shape && view.is_some_and(|view| view.event().is_none());
    if is_start && (panes.focus, panes.page) == (Pane::Nodes, Pane::Decision) {
        panes.page = Pane::Shape;
    }
    let choice = Choice {
        panes,
        slaves: view.map_or(0, |view| match app.filter {
            Filter::All => view.model.contacts.len(),
            _ => app.order(view).len(),
        }),
        all: model.map_or(0, |model| model.contacts.len()),
        has_shape,
        lesson: rows,
    };
    layout::places(area, &choice)
}

/// Removes control characters from the cells, which a terminal would obey.
fn harmless(buffer: &mut Buffer, area: Rect) {
    for at in area.intersection(buffer.area).positions() {
        let cell = &mut buffer[at];
        if cell.symbol().contains(shown::is_order) {
            let left: String = cell
                .symbol()
                .chars()
                .filter(|c| !shown::is_order(*c))
                .collect();
            cell.set_symbol(if left.is_empty() { " " } else { &left });
        }
    }
}

/// Whether a pane is hidden because it shows what the user still has to predict.
pub fn is_hidden(pane: Pane, app: &App, view: &View) -> bool {
    entry(pane).is_ahead && app.learning.hides_any(view)
}

fn draw_pane(pane: Pane, buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    if is_hidden(pane, app, view) {
        let inner = frame(buffer, area, pane, "Hidden", app);
        paint::note(buffer, inner, "until you predict what follows", &app.theme);
        return;
    }
    (entry(pane).draw)(buffer, area, app, view);
}

/// The screen of a session as plain text, one line per row, without trailing blanks.
pub fn picture(session: &Session, width: u16, height: u16) -> String {
    text(
        &App::new(Theme::mono(), Vec::new()),
        Some(&View::new(session)),
        width,
        height,
    )
}

/// A screen as plain text.
pub fn text(app: &App, view: Option<&View>, width: u16, height: u16) -> String {
    let area = Rect::new(0, 0, width, height);
    let mut buffer = Buffer::empty(area);
    draw(&mut buffer, area, app, view);
    let rows = area.rows().map(|row| {
        let row: String = row
            .columns()
            .map(|cell| buffer[(cell.x, cell.y)].symbol())
            .collect();
        row.trim_end().to_string() + "\n"
    });
    rows.collect()
}
