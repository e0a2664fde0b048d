//! The contact surfaces of a finished run of another program, from the chosen side, with its contacts: C closed, · open.

use crate::app::App;
use crate::canvas::Canvas;
use crate::layout::top;
use crate::paint;
use crate::view::View;
use crate::window::Window;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Modifier;
use stickslip_core::Mode;
use stickslip_core::model::FinishedRun;
use stickslip_debugger::explain::outline::{Bounds, Point};

/// Draws the surfaces, or why there are none.
pub fn draw(buffer: &mut Buffer, inner: Rect, run: &FinishedRun, app: &App, view: &View) {
    let shape = &run.shape;
    let points = || shape.faces.iter().flatten().flatten();
    if points().next().is_none() || inner.height < 2 {
        let none = "The surfaces are drawn from the deck (.inp) next to the run; there is none that can be read.";
        return paint::note(buffer, inner, none, &app.theme);
    }
    let is_plane = points().all(|point| point[2] == 0.0);
    let flat = |[x, y, z]: [f64; 3]| {
        if is_plane {
            [x, y]
        } else {
            app.camera.projection.sheet([x, y, z])
        }
    };
    let mut bounds = Bounds::NOTHING;
    points().for_each(|point| bounds.add(flat(*point)));
    let place = |slave: usize| shape.slaves.get(slave).copied().flatten().map(flat);
    let selected = app.slave(view);
    let [field, last] = top(inner, inner.height - 1);
    let mut canvas = Canvas::new(field);
    let window = Window::new(&canvas, &bounds, &app.camera, place(selected));
    for (faces, style) in shape.faces.iter().zip([app.theme.faint, app.theme.strong]) {
        for face in faces {
            let dots: Vec<_> = face
                .iter()
                .chain(face.first())
                .map(|point| window.dot(flat(*point)))
                .collect();
            canvas.polyline(&dots, style);
        }
    }
    canvas.render(buffer);
    for slave in (0..shape.slaves.len())
        .filter(|slave| *slave != selected)
        .chain([selected])
    {
        let at = |place: Point| canvas.cell(window.dot(place));
        let Some(at) = place(slave).and_then(at) else {
            continue;
        };
        let mode = app.shown_mode(view, slave);
        let style = app.theme.mode(mode).add_modifier(Modifier::BOLD);
        let letter = if mode == Mode::Free { "·" } else { "C" };
        let style = if slave == selected {
            style.add_modifier(Modifier::REVERSED)
        } else {
            style
        };
        paint::label(buffer, at, letter, style, &app.theme);
    }
    let side = if is_plane {
        String::new()
    } else {
        format!(" {} view (V)  ", app.camera.projection.word())
    };
    let text = format!("{side} faint: master   C closed  · open   undeformed");
    paint::lines(buffer, last, &[text.into()]);
}
