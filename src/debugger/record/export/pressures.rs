//! Contact pressures in a picture.

use super::picture::ShapeDrawing;
use super::window::FORCE;
use crate::RoundOff;
use stickslip_study::sheet::Colour;

/// Colour of pressures.
const BLUE: Colour = (86, 180, 233);

impl ShapeDrawing<'_> {
    /// Draws contact pressures along the sides of bodies whose nodes are all slaves, from the nodes along the
    /// master's normal; the largest has half the length of the longest force. Returns the largest that is
    /// drawn, 0 if none.
    pub(super) fn pressures(&mut self) -> f64 {
        let (model, Some(event)) = (&self.shown.scene.model, self.shown.event) else {
            return 0.0;
        };
        let round_off = RoundOff::new(model, &event.before);
        let mut of_node = vec![None; model.nodes.len()];
        for (contact, found) in model.contacts.iter().zip(&event.nodes) {
            let pressure = contact.pressure(round_off.arrow(found.f_n), 0.0);
            of_node[contact.node] = pressure.map(|[pressure, _]| (pressure, found.normal));
        }
        let sizes = of_node.iter().flatten().map(|(pressure, _)| pressure.abs());
        let largest = sizes.filter(|p| p.is_finite()).fold(0.0, f64::max);
        if largest == 0.0 {
            return 0.0;
        }
        let scale = 0.5 * FORCE / largest;
        let mut drawn = 0.0_f64;
        let lines = model.bodies.iter().flat_map(|body| body.kind.lines());
        for line in lines {
            let ends: Option<Vec<[(f64, f64); 2]>> = line
                .iter()
                .map(|&node| {
                    let (pressure, n) = of_node[node]?;
                    let foot = self.at(node);
                    let tip = (
                        foot.0 + scale * pressure * n[0],
                        foot.1 - scale * pressure * n[1],
                    );
                    Some([foot, tip])
                })
                .collect();
            let Some(ends) =
                ends.filter(|ends| ends.iter().flatten().all(|at| self.window.holds(*at)))
            else {
                continue;
            };
            let sizes = line.iter().filter_map(|&node| of_node[node]);
            drawn = sizes.fold(drawn, |most, (pressure, _)| most.max(pressure.abs()));
            let tips: Vec<(f64, f64)> = ends.iter().map(|end| end[1]).collect();
            self.sheet.line(&tips, 1.6, BLUE);
            for end in &ends {
                self.sheet.line(end, 0.8, BLUE);
            }
        }
        drawn
    }
}
