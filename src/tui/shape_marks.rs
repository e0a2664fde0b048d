//! Places of what the shape shows besides its lines: supports, loads and prescribed motions, slave nodes, and names of bodies.

use crate::canvas::Canvas;
use crate::view::View;
use crate::window::Window;
use stickslip_core::{Body, BodyKind};
use stickslip_debugger::explain::conditions::{ConditionArrow, Conditions, conditions};
use stickslip_debugger::explain::outline::{Point, outer_nodes};

/// Number of outer nodes that determine the place of a body's name.
const ENOUGH: usize = 1000;

/// Places of a shape's marks at a load factor.
#[derive(Debug)]
pub(crate) struct Marks {
    pub load_factor: f64,
    /// The slave nodes.
    pub slaves: Vec<Point>,
    /// Loads and prescribed motions.
    pub arrows: Vec<ConditionArrow>,
    /// Supports and turns with their cells.
    pub glyphs: Vec<((u16, u16), &'static str)>,
    /// Where each body's name belongs; empty for a single body, which is not named.
    pub bodies: Vec<Point>,
}

impl Marks {
    pub fn new(canvas: &Canvas, window: &Window, view: &View, load_factor: f64) -> Self {
        let place = |node: usize| window.place(view, node);
        let Conditions { arrows, turns } = conditions(view.model, load_factor, &place);
        let bodies = &view.model.bodies[..];
        let named = if bodies.len() > 1 { bodies } else { &[] };
        let facts = view.facts();
        let supports = facts.supports.iter();
        let supports = supports.map(|&(node, held)| (node, support(held)));
        let turns = turns.into_iter();
        let turns = turns.map(|(node, _, left)| (node, if left { "↺" } else { "↻" }));
        let in_cell = |(node, glyph)| Some((canvas.cell(window.dot(place(node)))?, glyph));
        let mut glyphs: Vec<_> = supports.chain(turns).filter_map(in_cell).collect();
        // Of a fine mesh many nodes are in one cell.
        glyphs.dedup();
        Marks {
            load_factor,
            slaves: view.model.contacts.iter().map(|c| place(c.node)).collect(),
            arrows,
            glyphs,
            bodies: named.iter().map(|body| middle(body, &place)).collect(),
        }
    }
}

/// A triangle for a restrained component, a filled one for both, a square if the rotation is restrained as well.
fn support(held: [bool; 3]) -> &'static str {
    match held {
        [true, true, true] => "■",
        [true, true, false] => "▲",
        [true, false, _] => "▷",
        [false, true, _] => "△",
        [false, false, _] => "◇",
    }
}

/// The middle of a solid's outline, or of a beam.
fn middle(body: &Body, place: &dyn Fn(usize) -> Point) -> Point {
    if let BodyKind::Beam(_) = body.kind {
        return place(body.nodes[body.nodes.len() / 2]);
    }
    let step = 1 + outer_nodes(body).count() / ENOUGH;
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    for [x, y] in outer_nodes(body).step_by(step).map(place) {
        (sum, count) = ([sum[0] + x, sum[1] + y], count + 1.0);
    }
    sum.map(|x| x / count)
}
