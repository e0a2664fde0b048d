//! Supports, loads and prescribed motions in a picture.

use super::picture::{LOAD, OBLIQUE, ShapeDrawing};
use crate::explain::conditions::{ConditionArrow, Given, conditions, supports};
use stickslip_study::sheet::Colour;

/// Colour of supports, loads and prescribed motions.
const GREEN: Colour = (0, 120, 86);
/// Pixels between a contact force and a load on the same line.
const ASIDE: f64 = 9.0;

impl ShapeDrawing<'_> {
    /// Supports, loads and prescribed motions.
    pub fn conditions(&mut self) {
        let load_factor = self.shown.event.map_or(0.0, |event| event.load_factor);
        let found = conditions(&self.shown.scene.model, load_factor, self.now);
        for (node, held) in supports(&self.shown.scene.model) {
            let at = self.at(node);
            let kind = match held {
                [true, true, true] => 1,
                [true, true, false] | [false, true, _] => 2,
                [true, false, _] | [false, false, _] => 3,
            };
            if self.window.holds(at) {
                self.sheet.marker(at, kind, 3.5, GREEN);
            }
        }
        for arrow in &found.arrows {
            let at = self.window.at(arrow.at);
            let [x, y] = arrow.along.map(|x| LOAD * x);
            let clear = (self.marked + 3.0) / x.hypot(y).max(1e-300);
            let part = |by: f64| (at.0 + by * x, at.1 - by * y);
            let (from, to) = match arrow.given {
                Given::Load => (part(-1.0 - clear), part(-clear)),
                Given::Motion => (part(clear), part(1.0 + clear)),
            };
            if !self.window.holds(at) {
                continue;
            }
            let aside = self.aside(arrow);
            let [from, to] = [from, to].map(|p| (p.0 + aside.0, p.1 + aside.1));
            self.sheet.arrow(from, to, 1.6, GREEN);
            if arrow.given == Given::Motion {
                let (side, length) = ([-y, x], x.hypot(y).max(1e-300));
                let beside =
                    |p: (f64, f64)| (p.0 + 3.0 * side[0] / length, p.1 - 3.0 * side[1] / length);
                self.sheet.line(&[beside(from), beside(to)], 1.2, GREEN);
            }
            self.taken.take_line(from, to);
        }
        for (node, _, left) in found.turns {
            let at = self.at(node);
            if self.window.holds(at) {
                let sign = if left { 1.0 } else { -1.0 };
                let arc: Vec<(f64, f64)> = (0..=12)
                    .map(|k| sign * (0.35 + 0.4 * f64::from(k)))
                    .map(|a| (at.0 + 12.0 * a.cos(), at.1 - 12.0 * a.sin()))
                    .collect();
                self.sheet.line(&arc, 1.6, GREEN);
                if let [.., before, end] = arc[..] {
                    let far = |a: f64, b: f64| b + 3.0 * (b - a);
                    let tip = (far(before.0, end.0), far(before.1, end.1));
                    self.sheet.arrow(before, tip, 1.6, GREEN);
                }
            }
        }
    }

    /// How far a load or motion is moved sideways, so that no contact force covers it: upwards, unless it is vertical.
    fn aside(&self, arrow: &ConditionArrow) -> (f64, f64) {
        let model = &self.shown.scene.model;
        let is_covered = self.shown.event.is_some_and(|event| {
            model.contacts.iter().enumerate().any(|(slave, contact)| {
                let force = || OBLIQUE.force(model, event, slave);
                (self.now)(contact.node) == arrow.at && arrow.is_under(force())
            })
        });
        let [x, y] = arrow.along;
        let length = x.hypot(y).max(1e-300).copysign(-x);
        if is_covered {
            (ASIDE * y / length, ASIDE * x / length)
        } else {
            (0.0, 0.0)
        }
    }
}
