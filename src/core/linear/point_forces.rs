//! Point forces of all contacts on elements with local flexibility ([`crate::contact::point_force`]), including their
//! interaction.

use crate::contact::point_force::{self, OtherForces, Pair, tilt, turned};
use crate::contact::projection::projection_at;
use crate::model::PointGive;
use crate::{ContactState, Mode, Model, SurfaceElement, SurfacePoint};

/// Fixed-point iterations for normal forces and angles: each reduces the error by the factor tan² α.
const ROUNDS: usize = 8;

/// A contact over an element with local flexibility.
#[derive(Debug, Clone, Copy)]
pub struct FlexibleContact {
    /// Number of the contact.
    pub contact: usize,
    /// Closest point on the master surface.
    pub spot: SurfacePoint,
    /// Local flexibilities of the element, and its polynomial degree.
    pub give: PointGive,
    pub degree: usize,
    /// F_n, and F = F_n cos α.
    f_n: f64,
    pub force: f64,
    /// tan α, and n rotated by α (unit).
    tilt: f64,
    pub normal: [f64; 2],
    /// √m / (m − g k), and n of the element's line.
    lever: f64,
    pub line: [f64; 2],
    own: Pair,
    /// Contribution of the other forces on the element at this point.
    pub others: OtherForces,
}

impl FlexibleContact {
    fn new(
        model: &Model,
        positions: &[[f64; 2]],
        s: usize,
        node: &ContactState,
    ) -> Option<FlexibleContact> {
        let (slave, spot) = (&model.contacts[s], node.spot?);
        let surface = &model.surfaces[spot.surface];
        let give = point_force::of(surface, spot)?;
        if node.corner.is_some() || slave.bond.is_tied() {
            return None;
        }
        let over = projection_at(&model.surfaces, spot, positions, positions[slave.node]);
        let degree = SurfaceElement::from_surface(surface, spot.element).degree();
        let f_n = if node.mode == Mode::Free {
            0.0
        } else {
            node.f_n
        };
        Some(FlexibleContact {
            contact: s,
            spot,
            give,
            degree,
            f_n,
            force: f_n,
            tilt: 0.0,
            normal: over.normal,
            lever: over.lever()?,
            line: over.normal,
            own: Pair::new(&give, degree, spot.xi, spot.xi),
            others: OtherForces::default(),
        })
    }

    /// c_ij and its derivatives for this contact and another contact on the same element.
    pub fn with(&self, other: &FlexibleContact) -> Pair {
        Pair::new(&self.give, self.degree, self.spot.xi, other.spot.xi)
    }

    /// Local deflection of the surface at this point (length).
    pub fn deflection(&self) -> f64 {
        self.own.give * self.force + self.others.give
    }

    /// Offset (length) of the point at which the node is judged, along n of the element's line.
    pub fn way_out(&self) -> [f64; 2] {
        self.line.map(|n| n * self.deflection())
    }

    fn turn(&mut self) {
        self.tilt = tilt(&self.own, self.lever, self.f_n, &self.others);
        self.force = self.f_n / (1.0 + self.tilt * self.tilt).sqrt();
        self.normal = turned(self.line, self.tilt);
    }
}

/// All contacts over elements with local flexibility, grouped by element.
#[derive(Debug, Default)]
pub struct PointForces {
    presses: Vec<FlexibleContact>,
}

impl PointForces {
    /// Updates the list for contacts in these states.
    pub fn find(&mut self, model: &Model, positions: &[[f64; 2]], contacts: &[ContactState]) {
        let nodes = contacts.iter().enumerate();
        let found = nodes.filter_map(|(s, node)| FlexibleContact::new(model, positions, s, node));
        self.presses.clear();
        self.presses.extend(found);
        let key = |press: &FlexibleContact| (press.spot.surface, press.spot.element, press.contact);
        self.presses.sort_unstable_by_key(key);
        for group in self.presses.chunk_by_mut(on_one_element) {
            settle(group);
        }
    }

    /// Iterates over the contacts of each element.
    pub fn groups(&self) -> impl Iterator<Item = &[FlexibleContact]> {
        self.presses.chunk_by(on_one_element)
    }

    /// All contacts in the list.
    pub fn all(&self) -> &[FlexibleContact] {
        &self.presses
    }
}

fn on_one_element(a: &FlexibleContact, b: &FlexibleContact) -> bool {
    (a.spot.surface, a.spot.element) == (b.spot.surface, b.spot.element)
}

/// Computes angles and forces of the contacts on an element.
fn settle(group: &mut [FlexibleContact]) {
    if let [alone] = group {
        return alone.turn();
    }
    for _ in 0..ROUNDS {
        for i in 0..group.len() {
            let mut others = OtherForces::default();
            for (_, other) in group.iter().enumerate().filter(|(j, _)| *j != i) {
                others.add(&group[i].with(other), other.force);
            }
            group[i].others = others;
        }
        group.iter_mut().for_each(FlexibleContact::turn);
    }
}
