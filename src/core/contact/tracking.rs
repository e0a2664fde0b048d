//! Positions of the slave nodes at the start of a major iteration: S*, anchor, drift, and corners.
//!
//! Where two elements meet in a concave corner, a node that stops there may alternate between them forever. Therefore a
//! sliding node that returns to the element that it left, and any node beyond both sides, is held in the corner: it is fixed
//! there, about the mean of the two normals, with the friction of both sides together ([`crate::contact::corner`]). At the
//! friction bound it slides out along one side, as from any fixed mode. If a node slid into the corner since the last accepted
//! state, and the friction against that slip is below the least friction ([`corner::least_friction`]), the node slides again on
//! the side that it came from.
//!
//! A node that lands on a convex vertex also sticks there about the mean normal, with a narrower friction bound that prevents it
//! from sliding down either side. If friction is too weak for that, it is assigned to one of the sides: a vertex that holds a
//! node without friction would be an unstable state.

use crate::contact::corner;
use crate::contact::crossing;
use crate::contact::facing::{MOST, faced, is_piece};
use crate::contact::point_force;
use crate::contact::projection::{
    Projection, STRAIGHT, border, element_size, mean_normal, neighbour, normal, point_on_side,
    project, projection_apart, projection_at, sharpen, slopes_at_border, tangent,
};
use crate::contact::stick_point::distance;
use crate::contact::table1::t_max;
use crate::model::{Bond, Contact, Surface};
use crate::plane::{cross, dot};
use crate::{ContactState, Friction, Mode, SurfaceElement, SurfacePoint};

/// A node is at a corner or vertex if its distance is below this fraction of the element's size.
const AT_VERTEX: f64 = 1e-9;

/// The chains, and the current positions of all nodes of the scene.
#[derive(Debug, Clone, Copy)]
pub struct Ground<'a> {
    /// Surfaces of the scene.
    pub surfaces: &'a [Surface],
    /// Current positions of all nodes (length).
    pub positions: &'a [[f64; 2]],
    /// Forces that differ by less than this (force) count as equal.
    pub same_force: f64,
    /// Fraction of the initial overlaps that is still open.
    pub unclosed: f64,
}

impl Ground<'_> {
    /// Finds the positions of all nodes.
    pub fn follow(
        &self,
        nodes: &mut [ContactState],
        slaves: &[Contact],
        friction: &[Friction],
        anew: bool,
    ) {
        for ((node, slave), friction) in nodes.iter_mut().zip(slaves).zip(friction) {
            self.stand(node, slave, friction, anew);
        }
    }

    /// Anchors all nodes with an initial slip.
    pub fn place_anchors(&self, nodes: &mut [ContactState], slaves: &[Contact]) {
        for (node, slave) in nodes.iter_mut().zip(slaves) {
            self.place_anchor(node, slave);
        }
    }

    /// Finds the position of a node. Forces keep their components in the frame (n, t), which rotates with the surface. When a
    /// node enters or leaves a corner, the frame jumps, and the force keeps its direction instead. With `anew`, a sliding node is
    /// anchored at its new position.
    pub fn stand(&self, node: &mut ContactState, slave: &Contact, friction: &Friction, anew: bool) {
        let at = self.positions[slave.node];
        if slave.bond.is_tied() {
            return self.stay_tied(node, slave, at);
        }
        let (previous, force, was_held) = (node.spot, node.force(), node.corner.is_some());
        let (second, mean) = (node.second, node.normal);
        let mut is_released = false;
        if slave.is_apart(self.unclosed) {
            // Compliant bonds and overlaps transmit forces across a distance: such nodes are not held in corners, and the law of a
            // single side applies.
            node.spot = self.find(node.mode, slave, at, previous);
        } else if self.stays_in_corner(node, friction) {
            is_released = self.release(node, friction);
        } else {
            (node.corner, node.second) = (None, None);
            node.spot = self.find(node.mode, slave, at, previous);
            if !was_held {
                self.cross(node, previous);
            }
            match (was_held, second, previous) {
                (true, Some(second), Some(first)) => {
                    self.leave_between(node, [first, second], mean)
                }
                (true, ..) => self.leave(node, previous),
                _ => {}
            }
            if !was_held && node.corner.is_none() {
                self.meet_both(node, at, friction);
            }
            if !was_held && node.corner.is_none() && slave.surfaces.len() > 1 {
                self.meet_between(node, slave, at);
            }
            if node
                .spot
                .is_some_and(|spot| !self.surfaces[spot.surface].gives.is_empty())
            {
                leave_border(self.surfaces, node);
            }
        }
        match node.spot {
            Some(spot) => {
                if node.second.is_none() {
                    let apart = slave.is_apart(self.unclosed);
                    let over = projection_apart(apart, self.surfaces, spot, self.positions, at);
                    node.normal = if node.corner.is_some() || over.curve.is_none() {
                        self.border_normal(spot, node.f_n, &over)
                    } else {
                        point_force::normal(&self.surfaces[spot.surface], spot, &over, node.f_n)
                    };
                }
                if was_held != node.corner.is_some() {
                    let ([c, s], [f_x, f_y]) = (node.normal, force);
                    (node.f_n, node.f_t) = (c * f_x + s * f_y, c * f_y - s * f_x);
                }
                if is_released {
                    node.t_max = t_max(friction, node.f_n, node.sign);
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
            node.anchor_at(node.spot, slave.bond.give()[1]);
        }
        self.find_anchor(node, slave);
    }

    /// S* of a node on the surfaces that it may touch; `previous` is S* of the last major iteration.
    fn find(
        &self,
        mode: Mode,
        slave: &Contact,
        at: [f64; 2],
        previous: Option<SurfacePoint>,
    ) -> Option<SurfacePoint> {
        let mut room = [0; MOST];
        let on = faced(slave, self.surfaces, self.positions, &mut room);
        let previous = previous.filter(|spot| on.contains(&spot.surface));
        let spot = project(at, self.surfaces, on, self.positions, previous)?;
        let surface = &self.surfaces[spot.surface];
        let element = SurfaceElement::from_surface(surface, spot.element);
        if mode == Mode::Free && element.only_holds(spot.xi) {
            return None;
        }
        // A node that presses on an element with local flexibility penetrates by the local deflection.
        let gives = point_force::of(surface, spot).is_some();
        Some(if slave.is_apart(self.unclosed) || gives {
            sharpen(at, self.surfaces, spot, self.positions)
        } else {
            spot
        })
    }

    /// Keeps a tied node at its point of the surface; its force keeps its direction, because the surface may have rotated.
    fn stay_tied(&self, node: &mut ContactState, slave: &Contact, at: [f64; 2]) {
        node.mode = Mode::Fixed;
        let Some(spot) = node
            .anchor
            .or_else(|| project(at, self.surfaces, &slave.surfaces, self.positions, None))
        else {
            node.drift = 0.0;
            return;
        };
        let over = projection_at(self.surfaces, spot, self.positions, at);
        let normal = match slave.bond {
            Bond::Tied { upright: true, .. } => axis(over.normal),
            _ => over.normal,
        };
        let ([c, s], t, [f_x, f_y]) = (normal, tangent(normal), node.force());
        if node.anchor.is_some() && node.normal != normal {
            (node.f_n, node.f_t) = (c * f_x + s * f_y, c * f_y - s * f_x);
        }
        (node.spot, node.anchor, node.normal) = (Some(spot), Some(spot), normal);
        node.drift = (over.foot[0] - at[0]) * t[0] + (over.foot[1] - at[1]) * t[1];
        let give = slave.bond.give()[1];
        if give > 0.0 {
            node.drift -= give * node.f_t;
        }
    }

    /// Whether a node held in a corner still sticks there, and the corner still exists; updates its angle.
    fn stays_in_corner(&self, node: &mut ContactState, friction: &Friction) -> bool {
        let (Some(was), Some(spot), Mode::Fixed) = (node.corner, node.spot, node.mode) else {
            return false;
        };
        // The crossing of rigid surfaces does not change.
        if node.second.is_some() {
            return true;
        }
        let half = self.half_angle(spot, node.f_n);
        node.corner = half.filter(|half| {
            let is_corner = *half > 0.0;
            is_corner == (was > 0.0) && (is_corner || corner::holds(friction, *half))
        });
        node.corner.is_some()
    }

    /// Releases a node that slid into a concave corner: it slides again on the side that it came from if the friction against that
    /// slip is below the least friction of the corner. Returns whether it was released.
    fn release(&self, node: &mut ContactState, friction: &Friction) -> bool {
        let Some(half) = node.corner.filter(|half| *half > 0.0 && !node.is_forced()) else {
            return false;
        };
        let Some((side, sign)) = self.came_along(node) else {
            return false;
        };
        let least = corner::least_friction(friction, half, node.f_n);
        if sign * node.f_t >= least - self.same_force {
            return false;
        }
        (node.spot, node.mode, node.sign) = (Some(side), Mode::Sliding, sign);
        (node.corner, node.second, node.left) = (None, None, None);
        true
    }

    /// For a node held in a corner: the spot on the side along which it slid there from its anchor, and the direction (±1, along t)
    /// of the friction against that slip. `None` if the node was in the corner before.
    fn came_along(&self, node: &ContactState) -> Option<(SurfacePoint, f64)> {
        let (anchor, spot) = (node.anchor?, node.spot?);
        let both = [Some(spot), node.second];
        let on = both
            .into_iter()
            .flatten()
            .find(|on| on.surface == anchor.surface)?;
        let surface = &self.surfaces[on.surface];
        let way = distance(surface, anchor, on, self.positions);
        if way.abs() <= AT_VERTEX * element_size(surface, on, self.positions) {
            return None;
        }
        let Some(second) = node.second else {
            return Some((point_on_side(surface, on, way < 0.0), -way.signum()));
        };
        let other = if on == second { spot } else { second };
        let [own, across] =
            [on, other].map(|at| normal(&self.surfaces[at.surface], at, self.positions));
        // Motion along t on the first side of the walk, or against t on the second side, is motion into a concave corner.
        (cross(own, across) * way < 0.0).then_some((on, -way.signum()))
    }

    /// dx/dξ of the two sides of a border, rotated by F_n where they have local flexibility ([`point_force`]).
    fn sides(&self, border: SurfacePoint, f_n: f64) -> Option<[[f64; 2]; 2]> {
        let surface = &self.surfaces[border.surface];
        let turned = |end, slope| point_force::turned_end(surface, end, slope, f_n);
        slopes_at_border(surface, border, self.positions, turned)
    }

    /// Half the angle (radians) of a corner ([`corner::half_angle`]): positive if it is concave, negative at a convex vertex. The
    /// kink that F_n causes in elements with local flexibility is subtracted.
    fn half_angle(&self, border: SurfacePoint, f_n: f64) -> Option<f64> {
        let [before, behind] = self.sides(border, f_n)?;
        Some(corner::half_angle(before, behind))
    }

    /// n (unit) at a border of one chain: the mean of both sides' normals.
    fn border_normal(&self, border: SurfacePoint, f_n: f64, over: &Projection) -> [f64; 2] {
        let rigid_lines = self.surfaces[border.surface].gives.is_empty();
        self.sides(border, f_n)
            .filter(|_| !rigid_lines)
            .map_or(over.normal, |[before, behind]| mean_normal(before, behind))
    }

    /// Records that a node has moved to another element, and holds it in the corner if it slides back to the one that it left.
    fn cross(&self, node: &mut ContactState, previous: Option<SurfacePoint>) {
        let (Some(from), Some(to)) = (previous, node.spot) else {
            return;
        };
        if from.surface != to.surface || from.element == to.element {
            return;
        }
        let surface = &self.surfaces[from.surface];
        let meet = border(surface, from.surface, from.element, to.element);
        let corner = meet.and_then(|border| Some((border, self.half_angle(border, node.f_n)?)));
        if let Some((border, half)) = corner
            && half > STRAIGHT
            && node.left == Some(to.element)
            && node.mode == Mode::Sliding
            && !node.is_forced()
        {
            (node.spot, node.corner, node.mode) = (Some(border), Some(half), Mode::Fixed);
            node.left = None;
        } else {
            node.left = Some(from.element);
        }
    }

    /// The state of a node held in a concave corner: at the end of its side towards which it slides if S* moves along t relative
    /// to the node by `motion` (the node itself moves in the opposite direction along the surface); without a motion, in the
    /// corner where it sticks. `None` if there is no such corner.
    pub fn held_in_corner(
        &self,
        node: &ContactState,
        slave: &Contact,
        motion: Option<f64>,
    ) -> Option<ContactState> {
        let spot = node
            .spot
            .filter(|_| node.corner.is_none() && slave.bond.is_hard())?;
        let xi = match (motion, node.mode) {
            (Some(motion), Mode::Sliding) => -motion.signum(),
            (None, Mode::Fixed) => spot.xi,
            _ => return None,
        };
        let end = SurfacePoint { xi, ..spot };
        let half = self.half_angle(end, node.f_n);
        let half = half.filter(|half| *half > STRAIGHT)?;
        let (at, [f_x, f_y]) = (self.positions[slave.node], node.force());
        let over = projection_at(self.surfaces, end, self.positions, at);
        let [c, s] = self.border_normal(end, node.f_n, &over);
        let mut held = ContactState {
            mode: Mode::Fixed,
            spot: Some(end),
            anchor: Some(end),
            corner: Some(half),
            left: None,
            normal: [c, s],
            f_n: c * f_x + s * f_y,
            f_t: c * f_y - s * f_x,
            ..*node
        };
        self.find_anchor(&mut held, slave);
        Some(held)
    }

    /// Assigns a node that has left a corner to the side along which it slides.
    fn leave(&self, node: &mut ContactState, held: Option<SurfacePoint>) {
        if let (Some(held), Some(spot), Mode::Sliding) = (held, node.spot, node.mode)
            && spot.xi.abs() >= 1.0 - AT_VERTEX
            && held.surface == spot.surface
        {
            // Slip is the motion of S* relative to the node, which itself moves in the opposite direction.
            node.spot = Some(point_on_side(
                &self.surfaces[held.surface],
                held,
                node.sign < 0.0,
            ));
        }
    }

    /// The same if the two sides are `held`, on two surfaces that cross; `mean` is the normal about which the node was held.
    fn leave_between(&self, node: &mut ContactState, held: [SurfacePoint; 2], mean: [f64; 2]) {
        if node.mode != Mode::Sliding || node.spot.is_none() {
            return;
        }
        let t = tangent(mean);
        let out = held.map(|spot| {
            let surface = &self.surfaces[spot.surface];
            let n = normal(surface, spot, self.positions);
            -node.sign * dot(t, n)
        });
        // It leaves the side from which its motion points away.
        node.spot = Some(if out[0] < out[1] { held[0] } else { held[1] });
    }

    /// Holds a node that is inside two of its surfaces, or on one and inside the other, where these cross in a corner.
    fn meet_between(&self, node: &mut ContactState, slave: &Contact, at: [f64; 2]) {
        let Some(spot) = node.spot.filter(|spot| self.surfaces[spot.surface].rigid) else {
            return;
        };
        let size = element_size(&self.surfaces[spot.surface], spot, self.positions);
        let here = projection_at(self.surfaces, spot, self.positions, at);
        if here.gap > AT_VERTEX * size {
            return;
        }
        let others = slave
            .surfaces
            .iter()
            .filter(|&&other| other != spot.surface && self.surfaces[other].rigid)
            // Pieces of a master meet at its convex corners: a point inside both pieces is inside the master.
            .filter(|other| !is_piece(slave, **other));
        for &other in others {
            let Some(across) = project(at, self.surfaces, &[other], self.positions, None) else {
                continue;
            };
            let there = projection_at(self.surfaces, across, self.positions, at);
            let deep = element_size(&self.surfaces[other], across, self.positions);
            if there.gap >= -AT_VERTEX * deep || there.gap < -deep {
                continue;
            }
            if node.mode == Mode::Sliding && node.is_forced() {
                return;
            }
            let Some(met) = crossing::find(self.surfaces, [spot, across], self.positions) else {
                continue;
            };
            (node.spot, node.second) = (Some(met.spots[0]), Some(met.spots[1]));
            (node.corner, node.normal) = (Some(met.half), met.normal());
            if node.mode == Mode::Sliding {
                node.mode = Mode::Fixed;
            }
            return;
        }
    }

    /// Holds a node whose S* is exactly where two sides meet: in a concave corner, because it is beyond both sides; on a convex
    /// vertex if friction can hold it. Otherwise assigns it to a side of the vertex. A mode forced by the user is kept.
    fn meet_both(&self, node: &mut ContactState, at: [f64; 2], friction: &Friction) {
        let Some(spot) = node.spot.map(|spot| self.at_bottom(node, spot)) else {
            return;
        };
        let half = self.half_angle(spot, node.f_n);
        let Some(half) = half.filter(|half| half.abs() > STRAIGHT) else {
            return;
        };
        if half > 0.0 {
            // A node that sticks between two deformable elements does not need the friction of a corner. On a rigid surface the
            // corner exists from the start: with the friction of a single side the node would slide out under forces that both
            // sides together can hold.
            let rigid = self.surfaces[spot.surface].rigid;
            let held = node.mode == Mode::Sliding || rigid && node.mode == Mode::Fixed;
            if held && !node.is_forced() {
                (node.spot, node.corner, node.mode) = (Some(spot), Some(half), Mode::Fixed);
            }
        } else if node.mode != Mode::Sliding && corner::holds(friction, half) {
            node.corner = Some(half);
        } else if node.mode != Mode::Free {
            let here = projection_at(self.surfaces, spot, self.positions, at);
            let size = element_size(&self.surfaces[spot.surface], spot, self.positions);
            if here.gap.abs() <= AT_VERTEX * size {
                let surface = &self.surfaces[spot.surface];
                node.spot = Some(point_on_side(surface, spot, spot.xi < 0.0));
                if node.mode == Mode::Fixed && !node.is_forced() {
                    // Friction points back to the vertex, which is ahead along t at ξ = 1.
                    (node.mode, node.sign) = (Mode::Sliding, spot.xi);
                    node.t_max = t_max(friction, node.f_n, node.sign);
                }
            }
        }
    }

    /// S* of a node that sticks on a rigid surface, moved to the concave border of two elements if it is there up to round-off.
    fn at_bottom(&self, node: &ContactState, spot: SurfacePoint) -> SurfacePoint {
        let surface = &self.surfaces[spot.surface];
        let near = 1.0 - spot.xi.abs() <= 2.0 * AT_VERTEX;
        let end = SurfacePoint {
            xi: spot.xi.signum(),
            ..spot
        };
        let sticks = node.mode == Mode::Fixed && surface.rigid && !surface.endless && near;
        let is_corner = || {
            self.half_angle(end, node.f_n)
                .is_some_and(|half| half > STRAIGHT)
        };
        if sticks && is_corner() { end } else { spot }
    }

    /// Anchors a touching node without an anchor at its position, removes the anchor of a free node unless it is kept, and
    /// measures the drift. A node that has moved to another surface is anchored there with its current elastic slip. In a corner,
    /// the drift is the distance of the node from the corner.
    pub fn find_anchor(&self, node: &mut ContactState, slave: &Contact) {
        let (at, give) = (self.positions[slave.node], slave.bond.give()[1]);
        let free = node.mode == Mode::Free;
        let Some(spot) = node.spot.filter(|_| !free || node.kept) else {
            node.drift = 0.0;
            if !node.kept {
                (node.anchor, node.stretched) = (None, 0.0);
            }
            return;
        };
        // In a corner between two surfaces the node may have slid along either surface.
        let second = node.second.map(|second| second.surface);
        let here = |a: &SurfacePoint| a.surface == spot.surface || Some(a.surface) == second;
        let anchor = node.anchor.filter(here);
        if !free && anchor.is_none() {
            node.anchor_at(Some(spot), give);
        }
        node.drift = match (node.corner, anchor) {
            (Some(_), _) => {
                let here = projection_at(self.surfaces, spot, self.positions, at);
                let t = tangent(node.normal);
                (here.foot[0] - at[0]) * t[0] + (here.foot[1] - at[1]) * t[1]
            }
            (None, Some(anchor)) => {
                distance(&self.surfaces[spot.surface], spot, anchor, self.positions)
            }
            (None, None) => 0.0,
        };
        if give > 0.0 && anchor.is_some() {
            node.drift += node.stretched - give * node.f_t;
        }
    }

    /// Anchors a node with an initial slip at the distance of that slip. A node that starts free is not anchored; it still undoes
    /// its slip if it sticks in the first major iteration.
    pub fn place_anchor(&self, node: &mut ContactState, slave: &Contact) {
        let at = self.positions[slave.node];
        if node.mode == Mode::Free {
            node.drift = node.slip;
        }
        let slipped = node.mode != Mode::Free && node.slip != 0.0 && !slave.bond.is_tied();
        let Some(spot) = node.spot.filter(|_| slipped) else {
            return;
        };
        let projection = projection_at(self.surfaces, spot, self.positions, at);
        let t = tangent(projection.normal);
        let point = [0, 1].map(|k| projection.foot[k] + node.slip * t[k]);
        let there = project(
            point,
            self.surfaces,
            &[spot.surface],
            self.positions,
            Some(spot),
        );
        node.anchor_at(there, slave.bond.give()[1]);
        self.find_anchor(node, slave);
    }
}

/// Assigns a node that slides away from a border to the side along which it slides, so that the side's curvature enters its
/// tangent.
pub fn leave_border(surfaces: &[Surface], node: &mut ContactState) {
    let slides = node.mode == Mode::Sliding && node.corner.is_none();
    let spot = node.spot.filter(|spot| slides && spot.xi.abs() == 1.0);
    let Some(spot) = spot else { return };
    let surface = &surfaces[spot.surface];
    if neighbour(surface, spot).is_some() {
        node.spot = Some(point_on_side(surface, spot, node.sign < 0.0));
    }
}

/// The axis nearest to a direction.
fn axis([x, y]: [f64; 2]) -> [f64; 2] {
    if x.abs() > y.abs() {
        [x.signum(), 0.0]
    } else {
        [0.0, y.signum()]
    }
}
