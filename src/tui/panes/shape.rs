//! The shape at the start of the shown major iteration: its lines (`shape_lines`), the names of the bodies if there are several,
//! supports, loads and prescribed motions, contact forces on the slave nodes, and slave nodes by the letters of their modes. Small
//! displacements are magnified.

use crate::app::App;
use crate::camera::Camera;
use crate::canvas::{Canvas, Dot};
use crate::copied::row;
use crate::layout::{Pane, top};
use crate::paint;
use crate::pane_entry::{PaneEntry, frame};
use crate::run_shape;
use crate::shape_lines::{self, Look};
use crate::shape_marks::Marks;
use crate::theme::Theme;
use crate::view::View;
use crate::window::Window;
use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::{Margin, Position, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Span};
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_4;
use std::rc::Rc;
use stickslip_core::{BodyKind, Model, PointDeformation};
use stickslip_debugger::Examination;
use stickslip_debugger::action;
use stickslip_debugger::explain::conditions::{ConditionArrow, Given};
use stickslip_debugger::explain::names;
use stickslip_debugger::explain::outline;
use stickslip_debugger::explain::strain;
use stickslip_scene::number;
use unicode_width::UnicodeWidthStr;

/// Length of the largest force, as a fraction of the visible extent.
const FORCE: f64 = 0.25;
/// Length of the largest rigid-body motion, as a fraction of the visible extent.
const MOTION: f64 = 0.15;
/// Length of the largest load and of the largest prescribed motion, as a fraction of the visible extent.
const LOAD: f64 = 0.14;
/// Caption of the reference configuration.
const UNLOADED: &str = " faint: unloaded";
/// Loads and prescribed motions have every second dot, so that they differ from contact forces without colour.
const SPARSE: usize = 2;
/// Dots between a load and its node.
const CLEAR: f64 = 4.0;
/// Cells between two slave nodes from which on their names are written.
const APART: u16 = 8;
/// Arrow heads by eighths of a turn, anticlockwise from the right.
const HEADS: [&str; 8] = names::ARROWS;
const DOUBLE_HEADS: [&str; 8] = ["⇒", "⇗", "⇑", "⇖", "⇐", "⇙", "⇓", "⇘"];
/// Mark of a diagnosed node, right of its letter.
const MARK: &str = "!";
/// Mark of a solid's worst point, which is inverted or outside the range of its law.
const WORST: &str = "◆";

/// The pane.
pub const PANE: PaneEntry = PaneEntry {
    draw,
    actions: &[
        ("enlarge", "enlarge"),
        ("shrink", "shrink"),
        ("fit", "fit"),
        ("magnify", "magnify"),
    ],
    copied: row,
    is_ahead: false,
};

/// Draws the shape.
fn draw(buffer: &mut Buffer, area: Rect, app: &App, view: &View) {
    let inner = frame(buffer, area, Pane::Shape, "Shape", app);
    if let Some(run) = &view.model.finished {
        return run_shape::draw(buffer, inner, run, app, view);
    }
    if let (Some(shown), 2..) = (picture(buffer, inner, app, view), inner.height) {
        let moves = found(view).is_some_and(|found| !found.arrows.is_empty());
        caption(buffer, inner, shown, moves, app, view);
    }
}

/// The scales of a drawn picture.
#[derive(Debug, Clone, Copy)]
pub struct Scales {
    /// The largest contact force; 0 without one.
    longest: f64,
    /// The magnification of displacements.
    magnified: f64,
}

/// Draws the shape in all rows but the last; `None` if there is no room.
pub fn picture(buffer: &mut Buffer, inner: Rect, app: &App, view: &View) -> Option<Scales> {
    if inner.is_empty() {
        return None;
    }
    let (mut canvas, window, marks) = lines(inner, app, view);
    let (forces, longest) = forces(&window, &marks, view);
    let mut tips: HashMap<[u64; 2], Vec<Dot>> = HashMap::new();
    for [tail, tip] in &forces {
        tips.entry(tail.map(f64::to_bits)).or_default().push(*tip);
    }
    let arrows = marks.arrows.iter();
    let arrows: Vec<_> = arrows.map(|one| drawn(one, &tips, &window, app)).collect();
    for (line, style, _) in &arrows {
        canvas.dotted(line[0], line[1], *style, SPARSE);
    }
    let style = app.theme.bad.remove_modifier(Modifier::REVERSED);
    forces
        .iter()
        .for_each(|[from, to]| canvas.line(*from, *to, style));
    let motions = motions(&mut canvas, &window, app, view);
    canvas.render(buffer);
    for (line, style, glyphs) in &arrows {
        head(buffer, &canvas, line, (*glyphs, *style));
    }
    for &(cell, glyph) in &marks.glyphs {
        paint::label(buffer, cell, glyph, app.theme.good, &app.theme);
    }
    forces
        .iter()
        .for_each(|line| head(buffer, &canvas, line, (HEADS, style)));
    for line in &motions {
        head(buffer, &canvas, line, (HEADS, app.theme.strong));
    }
    slaves(buffer, &canvas, (&window, &marks), app, view);
    body_names(buffer, &canvas, (&window, &marks), app, view);
    if let Some((x, y)) = view
        .worst_point()
        .and_then(|point| canvas.cell(window.dot(point.at)))
        && let Some(cell) = buffer.cell_mut((x, y))
    {
        cell.set_symbol(WORST).set_style(app.theme.bad);
    }
    let magnified = window.magnified;
    Some(Scales { longest, magnified })
}

/// The lines, the part of the scene that they show, and the places of marks.
fn lines(inner: Rect, app: &App, view: &View) -> (Canvas, Window, Rc<Marks>) {
    let look = Look {
        camera: &app.camera,
        theme: &app.theme,
        selected: app.slave(view),
    };
    shape_lines::drawn(&app.lines, inner, look, view)
}

/// The slave node closest to a screen position, if it is near enough.
pub fn slave_at(area: Rect, app: &App, view: &View, at: Position) -> Option<usize> {
    // A cell is about twice as high as wide.
    const NEAR: u32 = 3;
    let inner = area.inner(Margin::new(1, 1));
    if inner.is_empty() {
        return None;
    }
    let (canvas, window, marks) = lines(inner, app, view);
    marks
        .slaves
        .iter()
        .enumerate()
        .filter_map(|(slave, &place)| {
            let (x, y) = canvas.cell(window.dot(place))?;
            let far = u32::from(x.abs_diff(at.x)) + 2 * u32::from(y.abs_diff(at.y));
            (far <= NEAR).then_some((far, slave))
        })
        .min()
        .map(|(_, slave)| slave)
}

/// Names of the bodies if there are several and they fit: in the middle of a solid, next to a beam.
fn body_names(
    buffer: &mut Buffer,
    canvas: &Canvas,
    (window, marks): (&Window, &Marks),
    app: &App,
    view: &View,
) {
    let area = canvas.area();
    for (body, &at) in view.model.bodies.iter().zip(&marks.bodies) {
        let name = paint::cut(&body.name, 12);
        let wide = name.width() as u16;
        let aside = match &body.kind {
            BodyKind::Beam(_) => 2,
            _ => -i32::from(wide / 2),
        };
        let Some((x, y)) = canvas.cell(window.dot(at)) else {
            continue;
        };
        let left = i32::from(x) + aside;
        if left < i32::from(area.x) || left + i32::from(wide) > i32::from(area.right()) {
            continue;
        }
        let left = left as u16;
        // A letter next to the name would read as a part of it.
        let is_apart = |at: (u16, u16)| {
            let cell = buffer.cell(at);
            cell.is_none_or(|cell| !cell.symbol().contains(char::is_alphanumeric))
        };
        let blank = |row: u16| {
            (area.top()..area.bottom()).contains(&row)
                && (left..left + wide).all(|x| gives_way(&buffer[(x, row)]))
                && (1..=2).all(|k| is_apart((left.wrapping_sub(k), row)))
                && (0..2).all(|k| is_apart((left + wide + k, row)))
        };
        let rows = [y, y.saturating_sub(1), y + 1, y.saturating_sub(2), y + 2];
        if let Some(row) = rows.into_iter().find(|row| blank(*row)) {
            paint::label(buffer, (left, row), &name, app.theme.heading, &app.theme);
        }
    }
}

/// Whether a name may cover a cell: dim lines, such as those between elements, but not outlines, forces and letters.
fn gives_way(cell: &Cell) -> bool {
    let is_line = cell.symbol() >= "\u{2800}";
    cell.symbol() == " " || (is_line && cell.modifier.contains(Modifier::DIM))
}

/// Contact forces on the slave nodes as lines from the node in the direction in which the master pushes it, and the largest.
fn forces(window: &Window, marks: &Marks, view: &View) -> (Vec<[Dot; 2]>, f64) {
    let Some(event) = view.event() else {
        return (Vec::new(), 0.0);
    };
    let round_off = view.round_off();
    let size = |f_n: f64, f_t: f64| round_off.arrow(f_n.hypot(f_t));
    let largest = event
        .nodes
        .iter()
        .map(|node| size(node.f_n, node.f_t))
        .filter(|f| f.is_finite())
        .fold(0.0, f64::max);
    let scale = FORCE * window.extent / largest;
    let lines = marks
        .slaves
        .iter()
        .zip(&event.nodes)
        .enumerate()
        .filter(|(_, (_, node))| size(node.f_n, node.f_t) > 0.0)
        .map(|(slave, (&tail, _))| {
            let force = window.projection.force(view.model, event, slave);
            let tip = [0, 1].map(|axis| tail[axis] + scale * force[axis]);
            [window.dot(tail), window.dot(tip)]
        });
    (lines.collect(), largest)
}

/// The line of a load, which ends at its node, or of a prescribed motion, which starts there; its style and its heads. It is drawn
/// next to a contact force that covers it; `tips` are those of the forces, by the bits of their other ends.
fn drawn(
    arrow: &ConditionArrow,
    tips: &HashMap<[u64; 2], Vec<Dot>>,
    window: &Window,
    app: &App,
) -> ([Dot; 2], Style, [&'static str; 8]) {
    let length = LOAD * window.extent;
    // The head of a load stays clear of the letter of its node.
    let off = CLEAR / (window.scale * arrow.along[0].hypot(arrow.along[1])).max(1e-300);
    let part = |by: f64| [0, 1].map(|axis| arrow.at[axis] + by * length * arrow.along[axis]);
    let (from, to, heads) = match arrow.given {
        Given::Load => (part(-1.0 - off / length), part(-off / length), HEADS),
        Given::Motion => (arrow.at, part(1.0), DOUBLE_HEADS),
    };
    let (at, line) = (window.dot(arrow.at), [window.dot(from), window.dot(to)]);
    let mut tips = tips.get(&at.map(f64::to_bits)).into_iter().flatten();
    let is_covered = tips.any(|tip| arrow.is_under([tip[0] - at[0], at[1] - tip[1]]));
    let line = if is_covered { beside(line) } else { line };
    (line, app.theme.good, heads)
}

/// A line moved sideways by a row of cells: upwards, unless it is vertical.
fn beside([from, to]: [Dot; 2]) -> [Dot; 2] {
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    let length = x.hypot(y).max(1e-300).copysign(-x);
    let aside = [-y, x].map(|part| CLEAR * part / length);
    [from, to].map(|[x, y]| [x + aside[0], y + aside[1]])
}

/// The diagnosis, if the solve fails in the shown state.
fn found<'a>(view: &View<'a>) -> Option<&'a Examination> {
    let page = view.examination().flatten()?;
    Some(&page.found).filter(|found| found.fails)
}

/// Rigid-body motions of bodies without support, as lines; returns the lines, which end in arrow heads.
fn motions(canvas: &mut Canvas, window: &Window, app: &App, view: &View) -> Vec<[Dot; 2]> {
    let Some(found) = found(view) else {
        return Vec::new();
    };
    let length = MOTION * window.extent;
    let lines: Vec<[Dot; 2]> = found
        .arrows
        .iter()
        .map(|&[at, along]| {
            let tip = [0, 1].map(|axis| at[axis] + length * along[axis]);
            [window.dot(at), window.dot(tip)]
        })
        .collect();
    for [from, to] in &lines {
        canvas.line(*from, *to, app.theme.strong);
    }
    lines
}

/// The arrow head at the end of a line, or where the line leaves the picture.
fn head(
    buffer: &mut Buffer,
    canvas: &Canvas,
    [from, to]: &[Dot; 2],
    (heads, style): ([&'static str; 8], Style),
) {
    let (x, y) = (to[0] - from[0], from[1] - to[1]);
    let eighth = (y.atan2(x) / FRAC_PI_4).round().rem_euclid(8.0) as usize;
    let last = canvas.size().map(|side| side - 1.0);
    if let Some((_, end)) = outline::clip(*from, *to, [0.0; 2], last)
        && let Some(at) = canvas.cell(end)
        && let Some(cell) = buffer.cell_mut(at)
    {
        cell.set_symbol(heads[eighth % heads.len()])
            .set_style(style);
    }
}

/// Letters of the modes at the slave nodes; the selected node is reversed. A node that is far enough from the others is named.
fn slaves(
    buffer: &mut Buffer,
    canvas: &Canvas,
    (window, marks): (&Window, &Marks),
    app: &App,
    view: &View,
) {
    let theme = &app.theme;
    let selected = app.slave(view);
    let places = marks.slaves.iter();
    let cells: Vec<_> = places.map(|&at| canvas.cell(window.dot(at))).collect();
    let seen = || cells.iter().flatten();
    let others = (0..cells.len()).filter(|slave| *slave != selected);
    for slave in others.chain([selected]) {
        let Some(&Some((x, y))) = cells.get(slave) else {
            continue;
        };
        let is_marked = found(view).is_some_and(|found| found.nodes.contains(&slave));
        // Of a fine mesh many nodes are in one cell; the last letter stays.
        let is_covered = cells.get(slave + 1) == Some(&Some((x, y)));
        if is_covered && !is_marked && ![slave, slave + 1].contains(&selected) {
            continue;
        }
        // The mode in which the drawn forces were found.
        let mode = view.mode_before(slave);
        let style = theme.mode(mode).add_modifier(Modifier::BOLD);
        let style = if slave == selected {
            style.add_modifier(Modifier::REVERSED)
        } else {
            style
        };
        paint::label(buffer, (x, y), action::letter(mode), style, theme);
        let right = (x + 1, y);
        if app.camera.zoom > 1.0
            && seen()
                .filter(|&&(a, b)| a.abs_diff(x) < APART && b.abs_diff(y) < 2)
                .count()
                == 1
        {
            name(buffer, canvas, (x, y), view.slave(slave), theme);
        }
        if is_marked && canvas.area().contains(right.into()) {
            paint::label(buffer, right, MARK, theme.strong, theme);
        }
    }
}

/// Writes the name of the node in this cell next to it, where it covers only faint lines; not at all if there is no room.
fn name(buffer: &mut Buffer, canvas: &Canvas, (x, y): (u16, u16), name: &str, theme: &Theme) {
    let area = canvas.area();
    let name = paint::cut(name, 12);
    let width = name.width() as u16;
    let is_free = |buffer: &Buffer, at: (u16, u16)| {
        area.contains(at.into()) && buffer.cell(at).is_some_and(gives_way)
    };
    let places = [x + 2, x.saturating_sub(width + 1)]
        .into_iter()
        .flat_map(|x| [y.saturating_sub(1), y + 1, y].map(|y| (x, y)));
    let free = { places }.find(|&(x, y)| (x..x + width).all(|x| is_free(buffer, (x, y))));
    if let Some(at) = free {
        paint::label(buffer, at, &name, theme.faint, theme);
    }
}

/// Caption of the worst point: its mark, its element, and its stretch or that it is inverted.
fn worst_words(model: &Model, point: &PointDeformation) -> String {
    let element = strain::element(model, point);
    if point.determinant > 0.0 {
        format!(
            " {WORST} {element}: stretch {}  ",
            number::sig4(point.stretch)
        )
    } else {
        format!(" {WORST} {element}: inverted  ")
    }
}

fn caption(buffer: &mut Buffer, inner: Rect, shown: Scales, moves: bool, app: &App, view: &View) {
    let theme = &app.theme;
    let Scales { longest, magnified } = shown;
    // First, so that a narrow pane does not cut it off.
    let mut spans: Vec<Span> = view
        .worst_point()
        .map(|point| Span::styled(worst_words(view.model, &point), theme.text))
        .into_iter()
        .collect();
    if magnified != 1.0 {
        let text = format!(" displacements ×{} (*)  ", number::shortest(magnified));
        spans.push(Span::styled(text, theme.strong));
    }
    if view.model.space.is_some() {
        let text = format!(" {} view (V)  ", app.camera.projection.word());
        spans.push(Span::styled(text, theme.strong));
    }
    if view.is_deformed() {
        spans.push(Span::styled(UNLOADED, theme.faint));
    }
    if longest > 0.0 {
        spans.push(Span::styled(
            format!("   longest force {}", number::sig4(longest)),
            theme.faint,
        ));
    }
    if moves {
        spans.push(Span::styled("   → rigid motion", theme.faint));
    }
    if found(view).is_some_and(|found| !found.nodes.is_empty()) {
        spans.push(Span::styled(format!("   {MARK} diagnosed"), theme.faint));
    }
    if (app.camera.zoom, app.camera.pan) != (Camera::ALL.zoom, Camera::ALL.pan) {
        spans.push(Span::styled(
            format!("   ×{:.2}  0: fit", app.camera.zoom),
            theme.faint,
        ));
    }
    // A narrow pane leaves out the least important part.
    let mut line = Line::from(spans);
    if line.width() > usize::from(inner.width) {
        line.spans.retain(|span| span.content != UNLOADED);
    }
    if let Some(first) = line.spans.first_mut() {
        first.content = format!(" {}", first.content.trim_start()).into();
    }
    let [_, last] = top(inner, inner.height - 1);
    paint::lines(buffer, last, &[line]);
}
