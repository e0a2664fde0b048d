//! Checks whether a state obeys the laws of contact, friction and equilibrium before it is accepted.
//!
//! The check uses only positions and forces, now and in the last accepted state; none of the iterations' variables (modes, S*,
//! anchors, accumulated slip). The laws:
//!
//! - g >= 0, also for surfaces other than the nearest that a node has passed through; no force acts across a gap; F_n >= 0; |F_t|
//!   <= tan φ F_n + c (eqn 20);
//! - a node that touches in both states has a net slip: the distance along the surface between the two closest points, across
//!   element borders. If it is not zero, friction opposes it and is at its limit;
//! - a node that was open, or on another surface, may have touched anywhere on its path. Only friction that is at its limit and
//!   acts along the whole path violates the law, because no touching point explains it;
//! - if a bond has compliances c_n, c_t, all this holds for a point shifted outwards, x + c_n F_n n: g + c_n F_n = 0 if a force
//!   acts; c_t times the change of −F_t is elastic and is excluded from the net slip that friction must oppose;
//! - over a beam element with local flexibility under point forces, the laws hold for a point shifted outwards by the local
//!   deflection, with n and t of the rotated axis ([`super::point_force::judged`]);
//! - a tied node stays at its point of the surface for all forces;
//! - in a corner the force lies in the convex hull of the forces that each of the two sides admits; after a slip into the corner,
//!   in the hull of the forces with friction at its limit against that slip ([`super::corner`]);
//! - every node is in equilibrium, and so are the bodies as a whole with their reactions ([`super::balance`]).
//!
//! All amounts are relative to the scene's length or force. Lengths and forces have separate tolerances, because very stiff
//! bodies reduce the accuracy of forces but not of positions.

use crate::contact::closest_history::{ClosestPoints, FEW};
use crate::contact::closest_points::{self, ClosestPoint, direction, place};
use crate::contact::corner::Side;
use crate::contact::element::closed;
use crate::contact::facing::{MOST, faced};
use crate::contact::point_force::judged::{JudgedGives, LoadedInterface, hand_on};
use crate::contact::projection::{projection_at, tangent};
use crate::contact::side_laws::{Amounts, SideHistory, TouchedSide};
use crate::contact::side_laws::{beyond_border, in_corner, on_side, slip_into};
use crate::contact::stick_point::{ahead, distance};
use crate::model::{Bond, Contact, Surface};
use crate::plane::{self, dot, length, minus, plus, unit};
use crate::{
    Finding, Friction, JudgedLaw, JudgedNumbers, Scales, SurfaceElement, SurfacePoint, Verdict,
};

/// Input of the judge: an interface, now and in the last accepted state.
#[derive(Debug, Clone, Copy)]
pub struct JudgedState<'a> {
    /// Master surfaces of the scene.
    pub surfaces: &'a [Surface],
    /// Slave nodes of the scene.
    pub contacts: &'a [Contact],
    /// Current friction, by slave.
    pub friction: &'a [Friction],
    /// Positions of all nodes in the last accepted state.
    pub before: &'a [[f64; 2]],
    /// Positions of all nodes now.
    pub now: &'a [[f64; 2]],
    /// Outward shift of the point at which each slave node is judged (Cartesian length), now and in the last accepted state: the
    /// remaining overlap of a press fit. Empty if there is none.
    pub out: [&'a [[f64; 2]]; 2],
    /// Interaction force on each slave node now (Cartesian).
    pub forces: &'a [[f64; 2]],
    /// Initial slip u_tS* − u_tS of each slave node, if the last accepted state is the start of the scene; else 0.
    pub brought: &'a [f64],
    /// Tangential force F_t on each slave node in the last accepted state.
    pub earlier: &'a [f64],
    /// Elastic slip of each contact when it was last anchored, in the last accepted state (length).
    pub anchored: &'a [f64],
    /// The point of its surface to which each contact is tied.
    pub ties: &'a [Option<SurfacePoint>],
    /// Units of amounts, and tolerances.
    pub scales: Scales,
}

impl JudgedState<'_> {
    /// Position at which a slave node is judged now.
    fn point(&self, slave: usize) -> [f64; 2] {
        self.loaded().point(slave)
    }

    /// The interface in its current state.
    fn loaded(&self) -> LoadedInterface<'_> {
        LoadedInterface {
            surfaces: self.surfaces,
            contacts: self.contacts,
            now: self.now,
            out: self.out[0],
            forces: self.forces,
        }
    }

    /// Position at which a slave node was judged in the last accepted state.
    fn was(&self, slave: usize) -> [f64; 2] {
        further(
            self.before[self.contacts[slave].node],
            self.out[1].get(slave),
        )
    }
}

/// A position shifted by a displacement, if there is one.
fn further(at: [f64; 2], way: Option<&[f64; 2]>) -> [f64; 2] {
    way.map_or(at, |way| plus(at, *way))
}

/// The judge and its workspace.
#[derive(Debug)]
pub struct Judge {
    feet: Vec<ClosestPoint>,
    earlier: Vec<ClosestPoint>,
    others: Vec<ClosestPoint>,
    sides: Vec<TouchedSide>,
    gives: JudgedGives,
    /// Cached data of the state judged last, which is usually the one accepted before the next.
    last: ClosestPoints,
    next: ClosestPoints,
}

impl Judge {
    /// A judge with workspace for a scene of this size.
    pub fn with_capacity(nodes: usize, slaves: usize) -> Self {
        closest_points::prepare();
        Judge {
            feet: Vec::with_capacity(FEW),
            earlier: Vec::with_capacity(FEW),
            others: Vec::with_capacity(FEW),
            sides: Vec::with_capacity(FEW),
            gives: JudgedGives::with_capacity(slaves),
            last: ClosestPoints::with_capacity(nodes, slaves),
            next: ClosestPoints::with_capacity(nodes, slaves),
        }
    }

    /// Judges contact and friction. `contact` (one entry per node of the scene) receives the interaction force on every node, x
    /// and y; the closest points found here distribute a slave's force over the nodes of its master element.
    pub fn interface(&mut self, seen: &JudgedState, contact: &mut [[f64; 2]]) -> Verdict {
        let mut verdict = Verdict::default();
        contact.fill([0.0; 2]);
        let near = seen.scales.near();
        // With compliant surfaces or bonds, the shifted points of that state depend on its forces, whose round-off differs from
        // that of the cached points.
        if !seen.out[1].is_empty() || !self.last.is(seen.before, near, seen.contacts.len()) {
            self.last.clear();
        }
        self.next.clear();
        self.gives.find(&seen.loaded(), &mut self.feet);
        for slave in 0..seen.contacts.len() {
            self.node(seen, slave, contact, &mut verdict);
        }
        self.next.near = near;
        self.next.at.clear();
        self.next.at.extend_from_slice(seen.now);
        std::mem::swap(&mut self.last, &mut self.next);
        verdict
    }

    /// Where a slave node at `at` touches one of its surfaces, to within `near` (length). `None` if it does not.
    pub fn touched(
        surfaces: &[Surface],
        slave: &Contact,
        at: [f64; 2],
        positions: &[[f64; 2]],
        near: f64,
    ) -> Option<SurfacePoint> {
        let (mut feet, mut room) = (Vec::new(), [0; MOST]);
        let on = faced(slave, surfaces, positions, &mut room);
        closest_points::find(at, surfaces, on, positions, 0.0, &mut feet);
        let foot = feet.first().filter(|foot| foot.distance <= near)?;
        (!is_past_end_at(foot, at, surfaces, positions, near)).then_some(foot.spot)
    }

    fn node(
        &mut self,
        seen: &JudgedState,
        slave: usize,
        contact: &mut [[f64; 2]],
        verdict: &mut Verdict,
    ) {
        let contact_of = &seen.contacts[slave];
        let Contact { bond, .. } = contact_of;
        let mut room = [0; MOST];
        let surfaces = faced(contact_of, seen.surfaces, seen.now, &mut room);
        let (mut point, force) = (seen.point(slave), seen.forces[slave]);
        let Scales { length, forces, .. } = seen.scales;
        let near = seen.scales.near();
        let pressed = plane::length(force) > forces * seen.scales.force;
        closest_points::find(
            point,
            seen.surfaces,
            surfaces,
            seen.now,
            2.0 * near,
            &mut self.feet,
        );
        let mut report = |law: JudgedLaw, amount: f64, numbers: JudgedNumbers| {
            verdict.add(Finding {
                law,
                slave: Some(slave),
                amount,
                allowed: seen.scales.allowed(law),
                numbers,
            });
        };
        let over = |feet: &[ClosestPoint], point: [f64; 2]| {
            feet.iter()
                .find(|foot| {
                    let surface = &seen.surfaces[foot.spot.surface];
                    let element = SurfaceElement::from_surface(surface, foot.spot.element);
                    let is_over = pressed || !element.only_holds(foot.spot.xi);
                    is_over && !is_past_end(foot, point, seen)
                })
                .copied()
        };
        let mut foot = over(&self.feet, point);
        let mut given = 0.0;
        let way = self.gives.way(slave);
        if let Some(way) = way {
            point = [0, 1].map(|k| point[k] + way[k]);
        }
        let soft = pressed && bond.give()[0] > 0.0;
        if let (Some(found), true) = (foot, soft || way.is_some()) {
            if soft {
                let n = outward(&found, seen.surfaces, seen.now);
                let f_n = self.gives.normal_force(slave).unwrap_or(dot(force, n));
                given = bond.give()[0] * f_n;
                point = [0, 1].map(|k| point[k] + given * n[k]);
            }
            let feet = &mut self.feet;
            closest_points::find(point, seen.surfaces, surfaces, seen.now, 2.0 * near, feet);
            foot = over(feet, point);
        }
        self.next.add(&self.feet);
        if let (Bond::Tied { give, .. }, Some(spot)) = (bond, seen.ties[slave])
            && *give != [0.0; 2]
        {
            // The springs act between the point and its anchor, wherever the surface is closest.
            let anchor = projection_at(seen.surfaces, spot, seen.now, seen.point(slave));
            let (n, t) = (anchor.normal, tangent(anchor.normal));
            let to = [0, 1].map(|k| anchor.foot[k] - seen.point(slave)[k]);
            let off = [
                anchor.gap + give[0] * dot(force, n),
                dot(to, t) - give[1] * dot(force, t),
            ];
            let held = ClosestPoint {
                spot,
                at: anchor.foot,
                distance: 0.0,
            };
            hand_on(&seen.loaded(), slave, &held, false, contact);
            let amount = off[0].abs().max(off[1].abs());
            report(JudgedLaw::Tied, amount / length, JudgedNumbers::default());
            return;
        }
        if bond.is_tied() {
            let amount = foot.map_or(f64::INFINITY, |foot| {
                hand_on(&seen.loaded(), slave, &foot, false, contact);
                foot.distance.max(self.strayed(seen, slave, &foot).abs())
            });
            report(JudgedLaw::Tied, amount / length, JudgedNumbers::default());
            return;
        }
        let Some(foot) = foot else {
            if pressed {
                report(JudgedLaw::Gap, f64::INFINITY, JudgedNumbers::default());
            }
            return;
        };
        let gap = signed_gap(&foot, point, seen.surfaces, seen.now);
        let others = surfaces
            .iter()
            .copied()
            .filter(|&other| other != foot.spot.surface);
        let through = through(seen, (slave, point), others, near, &mut self.others);
        if through > near {
            let numbers = JudgedNumbers {
                gap: -through,
                ..JudgedNumbers::default()
            };
            report(JudgedLaw::Penetration, through / length, numbers);
        }
        let numbers = JudgedNumbers {
            gap: gap - given,
            ..JudgedNumbers::default()
        };
        if !pressed {
            // A spring whose force is below the force tolerance lets the node penetrate.
            let soft = bond.give()[0] * forces * seen.scales.force;
            report(
                JudgedLaw::Penetration,
                ((-gap - soft) / length).max(0.0),
                numbers,
            );
            return;
        }
        let [law_of_gap, law_of_slip] = match bond.give().map(|give| give > 0.0) {
            [normal, tangential] => [
                if normal {
                    JudgedLaw::Penalty
                } else {
                    JudgedLaw::Gap
                },
                if tangential {
                    JudgedLaw::Stick
                } else {
                    JudgedLaw::Slip
                },
            ],
        };
        report(law_of_gap, foot.distance / length, numbers);
        hand_on(&seen.loaded(), slave, &foot, way.is_some(), contact);
        if foot.distance > near {
            return;
        }
        self.find_sides(seen, slave, point, near);
        let amounts = self.least(seen, slave);
        let numbers = JudgedNumbers {
            gap: gap - given,
            ..amounts.numbers
        };
        for (law, amount) in [
            (JudgedLaw::Tension, amounts.tension),
            (JudgedLaw::Cone, amounts.cone),
            (law_of_slip, amounts.slip),
            (JudgedLaw::Touch, amounts.touch),
        ] {
            report(law, amount, numbers);
        }
        let mean = 0.5 * (seen.earlier[slave] + numbers.f_t);
        let work = mean * numbers.slip / (length * seen.scales.force);
        if amounts.touched && work > 0.0 {
            report(JudgedLaw::Work, work, numbers);
        }
    }

    /// Closest points of a node in the last accepted state.
    fn find_earlier(&mut self, seen: &JudgedState, slave: usize, near: f64) {
        // The results from judging that state are still valid.
        if !self.last.ends.is_empty() {
            self.earlier.clear();
            self.earlier.extend_from_slice(self.last.of(slave));
            return;
        }
        let (was, mut room) = (seen.was(slave), [0; MOST]);
        let surfaces = faced(&seen.contacts[slave], seen.surfaces, seen.before, &mut room);
        let earlier = &mut self.earlier;
        closest_points::find(
            was,
            seen.surfaces,
            surfaces,
            seen.before,
            2.0 * near,
            earlier,
        );
    }

    /// Motion of a tied node along its surface since the last accepted state; infinite if it is on another surface.
    fn strayed(&mut self, seen: &JudgedState, slave: usize, foot: &ClosestPoint) -> f64 {
        self.find_earlier(seen, slave, seen.scales.near());
        let here = |earlier: &&ClosestPoint| earlier.spot.surface == foot.spot.surface;
        let surface = &seen.surfaces[foot.spot.surface];
        let earlier = self.earlier.iter().find(here);
        earlier.map_or(f64::INFINITY, |earlier| {
            distance(surface, earlier.spot, foot.spot, seen.now)
        })
    }

    /// The sides that a node touches: those of its closest points, and both sides at a border between elements.
    fn find_sides(&mut self, seen: &JudgedState, slave: usize, point: [f64; 2], near: f64) {
        self.find_earlier(seen, slave, near);
        self.sides.clear();
        for foot in self.feet.iter().filter(|foot| foot.distance <= near) {
            let across = [-1.0, 1.0].map(|end| {
                let border = SurfacePoint {
                    xi: end,
                    ..foot.spot
                };
                let element =
                    SurfaceElement::from_surface(&seen.surfaces[border.surface], border.element);
                let at = place(element, seen.now, end);
                let there = length(minus(point, at)) <= near;
                there
                    .then(|| beyond_border(seen.surfaces, border))
                    .flatten()
            });
            for spot in [Some(foot.spot), across[0], across[1]]
                .into_iter()
                .flatten()
            {
                let known = |side: &TouchedSide| {
                    (side.spot.surface, side.spot.element) == (spot.surface, spot.element)
                };
                if !self.sides.iter().any(known)
                    && let Some(side) =
                        touching(seen, slave, point, spot, (&self.earlier, &self.gives), near)
                {
                    self.sides.push(side);
                }
            }
        }
        for k in 0..self.sides.len() {
            let this = self.sides[k];
            if let SideHistory::Open(_) | SideHistory::Elsewhere = this.past
                && let Some(slip) = slip_into(seen.surfaces, &self.sides, &this, near)
            {
                self.sides[k].past = SideHistory::Touched(slip);
            }
        }
    }

    /// The smallest violation: with the force on one of the sides, or on two sides together.
    fn least(&self, seen: &JudgedState, slave: usize) -> Amounts {
        let force = seen.forces[slave];
        let single = self
            .sides
            .iter()
            .map(|side| on_side(&seen.scales, force, side));
        let pairs = self.sides.iter().enumerate().flat_map(|(k, one)| {
            self.sides[k + 1..]
                .iter()
                .map(move |other| in_corner(seen.surfaces, &seen.scales, force, [one, other]))
        });
        let best = single.chain(pairs).reduce(|best, next| {
            if next.worst() < best.worst() {
                next
            } else {
                best
            }
        });
        best.unwrap_or_default()
    }
}

/// Depth (length) by which a slave node has passed through a surface other than its nearest since the last accepted state; 0 if
/// it has not. Only a node that was above the surface and is now below it counts, not one that went round an end. `others` are
/// the surfaces that the node may touch, except the nearest. `point` is the node's position without the penetration that its
/// spring allows: where two surfaces continue each other, the node is as deep in the other one.
fn through(
    seen: &JudgedState,
    (slave, point): (usize, [f64; 2]),
    others: impl Iterator<Item = usize>,
    near: f64,
    feet: &mut Vec<ClosestPoint>,
) -> f64 {
    let mut over = |other: usize, point: [f64; 2], positions: &[[f64; 2]]| {
        closest_points::find(point, seen.surfaces, &[other], positions, 0.0, feet);
        let foot = feet.first()?;
        let ends = foot.spot.xi.abs() == 1.0 && !seen.surfaces[other].endless;
        let at_end = ends && beyond_border(seen.surfaces, foot.spot).is_none();
        (!at_end).then(|| signed_gap(foot, point, seen.surfaces, positions))
    };
    others.fold(0.0, |most: f64, other| {
        let now = over(other, point, seen.now).filter(|gap| *gap < -near);
        let Some(gap) = now else {
            return most;
        };
        let was = over(other, seen.was(slave), seen.before);
        if was.is_some_and(|was| was >= -near) {
            most.max(-gap)
        } else {
            most
        }
    })
}

/// ξ (±1) of the end of the spot's chain that is within `near` (length) of a point. `None` away from the ends.
fn end_at(seen: &JudgedState, point: [f64; 2], spot: SurfacePoint, near: f64) -> Option<f64> {
    let surface = &seen.surfaces[spot.surface];
    [-1.0, 1.0]
        .into_iter()
        .filter(|_| !surface.endless)
        .filter(|&xi| {
            let at = place(
                SurfaceElement::from_surface(surface, spot.element),
                seen.now,
                xi,
            );
            length(minus(point, at)) <= near
        })
        .find(|&xi| beyond_border(seen.surfaces, SurfacePoint { xi, ..spot }).is_none())
}

/// A side at a surface point. `None` if dx/dξ = 0.
fn touching(
    seen: &JudgedState,
    slave: usize,
    point: [f64; 2],
    spot: SurfacePoint,
    (earlier, gives): (&[ClosestPoint], &JudgedGives),
    near: f64,
) -> Option<TouchedSide> {
    let surface = &seen.surfaces[spot.surface];
    let tangent = direction(
        SurfaceElement::from_surface(surface, spot.element),
        seen.now,
        spot.xi,
    )?;
    let tangent = gives.turned(&seen.loaded(), slave, spot, tangent);
    let friction = &seen.friction[slave];
    let elastic = match seen.contacts[slave].bond.give()[1] {
        0.0 => 0.0,
        give => give * (dot(seen.forces[slave], tangent) - seen.earlier[slave]),
    };
    let way = |foot: &ClosestPoint| {
        distance(surface, foot.spot, spot, seen.now) - seen.brought[slave] + elastic
    };
    // The elastic slip since the node was anchored is a length on the surface in the last accepted state, which has stretched
    // since.
    let beyond_stretch = |way: f64, foot: &ClosestPoint| {
        let give = seen.contacts[slave].bond.give()[1];
        if give == 0.0 {
            return way;
        }
        let length = give * seen.earlier[slave] - seen.anchored[slave];
        let anchor = ahead(surface, foot.spot, length, seen.before);
        let stretched = distance(surface, foot.spot, anchor, seen.now) - length;
        way - stretched
    };
    let here = earlier.iter().find(|f| f.spot.surface == spot.surface);
    let was = seen.was(slave);
    let past = match here {
        Some(foot) if is_past_end_at(foot, was, seen.surfaces, seen.before, near) => {
            SideHistory::Elsewhere
        }
        Some(foot) if foot.distance <= near => {
            SideHistory::Touched(beyond_stretch(way(foot), foot))
        }
        Some(foot) => SideHistory::Open(way(foot)),
        None => SideHistory::Elsewhere,
    };
    Some(TouchedSide {
        spot,
        side: Side {
            normal: [tangent[1], -tangent[0]],
            coefficient: friction.coefficient(),
            cohesion: friction.cohesion,
        },
        tangent,
        end: end_at(seen, point, spot, near),
        past,
    })
}

/// Outward unit direction at a closest point; `None` if undefined.
fn outward(foot: &ClosestPoint, surfaces: &[Surface], positions: &[[f64; 2]]) -> [f64; 2] {
    let n = outward_at(foot, surfaces, positions);
    unit(n).unwrap_or(n)
}

/// Sum of the outward normals of the sides at a closest point.
fn outward_at(foot: &ClosestPoint, surfaces: &[Surface], positions: &[[f64; 2]]) -> [f64; 2] {
    let normal = |spot: SurfacePoint| {
        let element = SurfaceElement::from_surface(&surfaces[spot.surface], spot.element);
        let t = direction(element, positions, spot.xi);
        t.map_or([0.0; 2], |t| [t[1], -t[0]])
    };
    let n = normal(foot.spot);
    let across = beyond_border(surfaces, foot.spot).filter(|_| foot.spot.xi.abs() == 1.0);
    across.map_or(n, |across| {
        let other = normal(across);
        plus(n, other)
    })
}

/// Signed distance: negative if the point lies inside.
fn signed_gap(
    foot: &ClosestPoint,
    point: [f64; 2],
    surfaces: &[Surface],
    positions: &[[f64; 2]],
) -> f64 {
    let n = outward_at(foot, surfaces, positions);
    let to = minus(point, foot.at);
    if dot(to, n) < 0.0 {
        -foot.distance
    } else {
        foot.distance
    }
}

fn is_past_end(foot: &ClosestPoint, point: [f64; 2], seen: &JudgedState) -> bool {
    is_past_end_at(foot, point, seen.surfaces, seen.now, seen.scales.near())
}

/// Whether a point lies beyond the end of the chain at its closest point by more than `near`.
fn is_past_end_at(
    foot: &ClosestPoint,
    point: [f64; 2],
    surfaces: &[Surface],
    positions: &[[f64; 2]],
    near: f64,
) -> bool {
    let SurfacePoint {
        surface,
        element,
        xi,
    } = foot.spot;
    let chain = &surfaces[surface];
    if chain.endless || xi.abs() < 1.0 {
        return false;
    }
    let is_last = if xi > 0.0 {
        element + 1 == chain.elements.len()
    } else {
        element == 0
    };
    if !is_last || closed(chain) {
        return false;
    }
    let to = minus(point, foot.at);
    let t =
        direction(SurfaceElement::from_surface(chain, element), positions, xi).unwrap_or([0.0; 2]);
    xi * dot(to, t) > near
}
