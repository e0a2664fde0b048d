//! Where the slave nodes stand at the start of a major iteration: S*, anchor, drift, and corners.
//!
//! Where two elements meet in a concave corner, a node that comes to rest there may go back and forth between them for
//! ever. A sliding node that comes back to the element that it had left is therefore held in the corner: it is fixed there,
//! about the mean of the two normals, with the friction that both sides give together ([`crate::contact::corner`]). At the
//! friction bound it slides out along one side, as out of any fixed mode.

use crate::contact::projection::{SurfacePoint, border, concave, project, projection_at, tangent};
use crate::contact::state::ContactState;
use crate::contact::stick_point::distance;
use crate::model::Mode;
use crate::model::{Contact, Surface};

/// The chains that nodes stand on, and where all nodes of the scene are now.
#[derive(Debug, Clone, Copy)]
pub struct Ground<'a> {
    /// Surfaces of the scene.
    pub surfaces: &'a [Surface],
    /// Current positions of all nodes (length).
    pub positions: &'a [[f64; 2]],
}

impl Ground<'_> {
    /// Finds where a node stands. Forces keep their components in the frame (n, t), which turns with the surface. When a node
    /// enters or leaves a corner, the frame jumps, and the force keeps its direction instead. With `anew` a sliding node is
    /// anchored anew where it stands.
    pub fn stand(&self, node: &mut ContactState, slave: &Contact, anew: bool) {
        let at = self.positions[slave.node];
        let (previous, force, was_held) = (node.spot, node.force(), node.corner.is_some());
        if !self.stays_in_corner(node) {
            node.corner = None;
            node.spot = project(at, self.surfaces, &slave.surfaces, self.positions, previous);
            if !was_held {
                self.cross(node, previous);
            }
        }
        match node.spot {
            Some(spot) => {
                node.normal = projection_at(self.surfaces, spot, self.positions, at).normal;
                if was_held != node.corner.is_some() {
                    let ([c, s], [f_x, f_y]) = (node.normal, force);
                    (node.f_n, node.f_t) = (c * f_x + s * f_y, c * f_y - s * f_x);
                }
            }
            None => {
                node.mode = Mode::Free;
                (node.t_max, node.slip) = (0.0, 0.0);
            }
        }
        if node.mode == Mode::Free {
            (node.f_n, node.f_t) = (0.0, 0.0);
        }
        if anew && node.mode == Mode::Sliding {
            node.anchor = node.spot;
        }
        self.find_anchor(node, at);
    }

    /// Whether a node that is held in a corner still sticks there, and the corner is still one; its angle is renewed.
    fn stays_in_corner(&self, node: &mut ContactState) -> bool {
        let (Some(_), Some(spot), Mode::Fixed) = (node.corner, node.spot, node.mode) else {
            return false;
        };
        node.corner = concave(&self.surfaces[spot.surface], spot, self.positions);
        node.corner.is_some()
    }

    /// Notes that a node has come to another element, and holds it in the corner where it slides back to the one that it
    /// had left.
    fn cross(&self, node: &mut ContactState, previous: Option<SurfacePoint>) {
        let (Some(from), Some(to)) = (previous, node.spot) else {
            return;
        };
        if from.surface != to.surface || from.element == to.element {
            return;
        }
        let surface = &self.surfaces[from.surface];
        let meet = border(surface, from.surface, from.element, to.element);
        let corner =
            meet.and_then(|border| Some((border, concave(surface, border, self.positions)?)));
        if let Some((border, half)) = corner
            && node.left == Some(to.element)
            && node.mode == Mode::Sliding
        {
            (node.spot, node.corner, node.mode) = (Some(border), Some(half), Mode::Fixed);
            node.left = None;
        } else {
            node.left = Some(from.element);
        }
    }

    /// Anchors a touching node that has no anchor where it stands, removes the anchor of a free node that does not keep it,
    /// and measures the drift. A node that has come to another surface is anchored anew there. In a corner, the drift is the
    /// distance of the node from the corner.
    pub fn find_anchor(&self, node: &mut ContactState, at: [f64; 2]) {
        let free = node.mode == Mode::Free;
        let Some(spot) = node.spot.filter(|_| !free || node.kept) else {
            node.drift = 0.0;
            if !node.kept {
                node.anchor = None;
            }
            return;
        };
        let anchor = node.anchor.filter(|a| a.surface == spot.surface);
        if !free {
            node.anchor = anchor.or(Some(spot));
        }
        node.drift = match (node.corner, anchor) {
            (Some(_), _) => {
                let here = projection_at(self.surfaces, spot, self.positions, at);
                let t = tangent(here.normal);
                (here.foot[0] - at[0]) * t[0] + (here.foot[1] - at[1]) * t[1]
            }
            (None, Some(anchor)) => {
                distance(&self.surfaces[spot.surface], spot, anchor, self.positions)
            }
            (None, None) => 0.0,
        };
    }

    /// Anchors a node that brings slip into the scene at the distance of that slip. A node that starts free is not anchored;
    /// it still takes its slip back if it sticks in the first major iteration.
    pub fn place_anchor(&self, node: &mut ContactState, slave: &Contact) {
        let at = self.positions[slave.node];
        if node.mode == Mode::Free {
            node.drift = node.slip;
        }
        let slipped = node.mode != Mode::Free && node.slip != 0.0;
        let Some(spot) = node.spot.filter(|_| slipped) else {
            return;
        };
        let projection = projection_at(self.surfaces, spot, self.positions, at);
        let t = tangent(projection.normal);
        let point = [0, 1].map(|k| projection.foot[k] + node.slip * t[k]);
        node.anchor = project(
            point,
            self.surfaces,
            &[spot.surface],
            self.positions,
            Some(spot),
        );
        self.find_anchor(node, at);
    }
}
