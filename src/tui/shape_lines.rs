//! The lines of the shape: bodies in the reference (dim) and current configuration, boundaries between materials, elements if these
//! are large enough, and master surfaces with their outward side. They are kept until something that they depend on has changed.

use crate::camera::Camera;
use crate::canvas::{Canvas, Dot};
use crate::shape_marks::Marks;
use crate::theme::Theme;
use crate::view::View;
use crate::window::Window;
use ratatui::layout::Rect;
use ratatui::style::Style;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::{Arc, Weak};
use stickslip_core::SurfaceElement;
use stickslip_core::fem::lagrange;
use stickslip_core::plane::distance;
use stickslip_debugger::Frame;
use stickslip_debugger::explain::model_facts::{self, solid_elements};
use stickslip_debugger::explain::outline::{self, Point, bounds, curve};

/// Length of a normal, as a fraction of the visible extent.
const NORMAL: f64 = 0.04;
/// Minimum diagonal of a drawn element, in dots.
const ELEMENT: f64 = 12.0;
/// Dots between two nodes of an element that is drawn straight between them.
const CLOSE: f64 = 2.0;
/// How many times its undeformed diagonal an element's drawn one is at most taken for.
const GROWN: f64 = 2.0;
/// Dots between two normals of an element.
const SPACING: f64 = 16.0;

/// How the user looks at the shape.
#[derive(Clone, Copy)]
pub(crate) struct Look<'a> {
    pub camera: &'a Camera,
    pub theme: &'a Theme,
    /// The selected slave node.
    pub selected: usize,
}

/// The lines that were drawn last, and the places of marks over them.
#[derive(Debug, Clone)]
pub(crate) struct ShapeLines {
    source: LinesSource,
    /// The reference configuration, and all lines.
    reference: Canvas,
    canvas: Canvas,
    window: Window,
    marks: Rc<Marks>,
}

/// All that the lines depend on.
#[derive(Debug, Clone)]
struct LinesSource {
    /// Displacements of the shown and of the last state.
    moved: [Weak<Vec<f64>>; 2],
    /// Those of the first state, which identify the model.
    start: Weak<Vec<f64>>,
    area: Rect,
    camera: Camera,
    /// The selected node, if zooming keeps it visible.
    towards: Option<usize>,
    styles: [Style; 3],
}

impl LinesSource {
    fn new(area: Rect, look: Look, view: &View) -> LinesSource {
        let motions = |frame: Option<&Frame>| {
            frame.map_or_else(Weak::new, |frame| Arc::downgrade(&frame.state.u))
        };
        LinesSource {
            moved: [Some(view.frame()), view.frames.last()].map(motions),
            start: motions(view.frames.first()),
            area,
            camera: *look.camera,
            towards: (look.camera.zoom != 1.0).then_some(look.selected),
            styles: [look.theme.faint, look.theme.text, look.theme.strong],
        }
    }

    fn is(&self, other: &LinesSource) -> bool {
        let mut moved = self.moved.iter().zip(&other.moved);
        moved.all(|(one, other)| one.ptr_eq(other)) && self.has_same_reference(other)
    }

    /// Whether the reference configuration looks alike in the same window.
    fn has_same_reference(&self, other: &LinesSource) -> bool {
        self.start.ptr_eq(&other.start)
            && (self.area, self.camera) == (other.area, other.camera)
            && (self.towards, self.styles) == (other.towards, other.styles)
    }
}

/// The lines in all rows but the last, the part of the scene that they show, and the places of marks.
pub(crate) fn drawn(
    kept: &RefCell<Option<ShapeLines>>,
    inner: Rect,
    look: Look,
    view: &View,
) -> (Canvas, Window, Rc<Marks>) {
    let source = LinesSource::new(inner, look, view);
    let load_factor = match view.event() {
        Some(event) => event.load_factor,
        None => view.frame().state.load_factor,
    };
    let mut kept = kept.borrow_mut();
    let mut lines = match kept.take() {
        Some(lines) if lines.source.is(&source) => lines,
        before => {
            let (empty, window) = field(inner, look, view);
            let reference = before
                .filter(|lines| lines.window == window)
                .filter(|lines| lines.source.has_same_reference(&source))
                .map(|lines| lines.reference);
            let reference = reference.unwrap_or_else(|| undeformed(empty, &window, look, view));
            let mut canvas = reference.clone();
            bodies(&mut canvas, &window, look, view);
            surfaces(&mut canvas, &window, look, view);
            ShapeLines {
                source,
                reference,
                marks: Rc::new(Marks::new(&canvas, &window, view, load_factor)),
                canvas,
                window,
            }
        }
    };
    if lines.marks.load_factor.to_bits() != load_factor.to_bits() {
        let marks = Marks::new(&lines.canvas, &lines.window, view, load_factor);
        lines.marks = Rc::new(marks);
    }
    let lines = kept.insert(lines);
    (lines.canvas.clone(), lines.window, lines.marks.clone())
}

/// The canvas, and the part of the scene that it shows.
fn field(inner: Rect, look: Look, view: &View) -> (Canvas, Window) {
    let field = Rect {
        height: inner.height.saturating_sub(1).max(1),
        ..inner
    };
    let canvas = Canvas::new(field);
    let magnified = look.camera.magnified(view);
    let projection = look.camera.projection;
    let place = |node: usize| view.magnified(node, (magnified, projection));
    let selected = view.model.contacts.get(look.selected);
    let towards = selected
        .map(|slave| place(slave.node))
        .filter(|place| place.iter().all(|x| x.is_finite()));
    let bounds = bounds(view.model, projection, &place);
    let window = Window::new(&canvas, &bounds, look.camera, towards);
    (
        canvas,
        Window {
            magnified,
            projection,
            ..window
        },
    )
}

/// Draws the curve of an element. Where its nodes are close, straight lines between them set the same dots.
fn draw_curve(canvas: &mut Canvas, window: &Window, nodes: &[Point], style: Style) {
    let dots = |points: &[Point]| -> Vec<Dot> { points.iter().map(|&p| window.dot(p)).collect() };
    let straight = dots(nodes);
    if straight
        .windows(2)
        .all(|ends| distance(ends[0], ends[1]) < CLOSE)
    {
        canvas.polyline(&straight, style)
    } else {
        canvas.polyline(&dots(&curve(nodes)), style)
    }
}

/// Draws the bodies in the reference configuration.
fn undeformed(mut canvas: Canvas, window: &Window, look: Look, view: &View) -> Canvas {
    for element in view.model.bodies.iter().flat_map(|body| body.kind.lines()) {
        let nodes = element.iter();
        let nodes: Vec<Point> = nodes
            .map(|&node| window.projection.at(view.model, node))
            .collect();
        draw_curve(&mut canvas, window, &nodes, look.theme.faint);
    }
    canvas
}

/// Draws the bodies in the current configuration.
fn bodies(canvas: &mut Canvas, window: &Window, look: Look, view: &View) {
    inside(canvas, window, look, view);
    for element in view.model.bodies.iter().flat_map(|body| body.kind.lines()) {
        let nodes = element.iter().map(|&node| window.place(view, node));
        let nodes: Vec<Point> = nodes.collect();
        draw_curve(canvas, window, &nodes, look.theme.strong);
    }
}

/// Lines between the elements of solids if there is room, and between their materials.
fn inside(canvas: &mut Canvas, window: &Window, look: Look, view: &View) {
    let draw = |canvas: &mut Canvas, face: &[usize], style| {
        let now: Vec<Point> = face.iter().map(|&node| window.place(view, node)).collect();
        draw_curve(canvas, window, &now, style);
    };
    let facts = view.facts();
    if GROWN * facts.largest_element * window.scale >= ELEMENT {
        for element in view.model.bodies.iter().flat_map(solid_elements) {
            let [a, b] = model_facts::diagonal(element).map(|node| window.place(view, node));
            let size = distance(a, b) * window.scale;
            if size >= ELEMENT && window.sees(a, size) {
                for face in element.kind.faces_of(&element.nodes) {
                    draw(canvas, &face, look.theme.faint);
                }
            }
        }
    }
    for face in &facts.seams {
        draw(canvas, face, look.theme.text);
    }
}

/// Master surfaces, with normals on the outward side.
fn surfaces(canvas: &mut Canvas, window: &Window, look: Look, view: &View) {
    let style = look.theme.text;
    let mut walked = SPACING;
    for element in view.model.surfaces.iter().flat_map(SurfaceElement::all) {
        let nodes = outline::element(element, |node| window.place(view, node));
        draw_curve(canvas, window, &nodes, style);
        if view.model.space.is_some() {
            continue;
        }
        // Short elements share one normal.
        let (Some(first), Some(last)) = (nodes.first(), nodes.last()) else {
            continue;
        };
        walked += distance(*last, *first) * window.scale;
        if walked < SPACING {
            continue;
        }
        walked = 0.0;
        for (from, to) in normals(&nodes, window) {
            canvas.line(window.dot(from), window.dot(to), style);
        }
    }
}

/// Normals of an element from base to tip, about evenly spaced. The outward side is on the right when traversing the nodes in
/// order.
fn normals(nodes: &[Point], window: &Window) -> Vec<(Point, Point)> {
    let (Some(first), Some(last)) = (nodes.first(), nodes.last()) else {
        return Vec::new();
    };
    let dots = distance(*last, *first) * window.scale;
    let count = (dots / SPACING).clamp(1.0, 40.0) as usize;
    let length = NORMAL * window.extent;
    let normal = |index: usize| {
        let xi = -1.0 + (2 * index + 1) as f64 / count as f64;
        let shape = lagrange::shape(nodes.len(), xi);
        let sum = |n: &[f64], axis: usize| {
            nodes
                .iter()
                .zip(n)
                .map(|(node, n)| n * node[axis])
                .sum::<f64>()
        };
        let (foot, walk) = (
            [0, 1].map(|axis| sum(&shape.n, axis)),
            [0, 1].map(|axis| sum(&shape.d, axis)),
        );
        let size = walk[0].hypot(walk[1]);
        let tip = [
            foot[0] + length * walk[1] / size,
            foot[1] - length * walk[0] / size,
        ];
        (size > 0.0).then_some((foot, tip))
    };
    match nodes.len() {
        2..=lagrange::MAX_NODES => (0..count).filter_map(normal).collect(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_debugger::explain::outline::Projection;

    #[test]
    fn the_normal_is_on_the_right_of_the_node_order() {
        let window = Window {
            middle: [0.0; 2],
            scale: 1.0,
            size: [1.0; 2],
            extent: 0.5 / NORMAL,
            magnified: 1.0,
            projection: Projection::Oblique,
        };
        assert_eq!(
            normals(&[[0.0, 0.0], [-2.0, 0.0]], &window),
            [([-1.0, 0.0], [-1.0, 0.5])]
        );
        assert!(normals(&[[0.0, 0.0], [0.0, 0.0]], &window).is_empty());
    }
}
