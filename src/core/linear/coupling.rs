//! A slave node's part of the linearised system: the displacements in its equations, and their matrix entries.

use crate::contact::geometric_tangent::Variation;
use crate::contact::point_force::LinearisedForce;
use crate::contact::projection::{Projection, tangent};
use crate::linalg::Pattern;
use crate::model::{Bond, Contact};
use crate::plane::dot;
use crate::{ContactState, Model};

/// A Cartesian displacement in a slave node's equations, with its weight in u_S* − u_S.
#[derive(Debug, Clone, Copy)]
pub struct Link {
    pub dof: usize,
    pub axis: usize,
    pub weight: f64,
    /// Derivative of the weight with respect to ξ.
    pub slope: f64,
    pub variation: Variation,
    /// Entries (normal row, dof), (dof, normal column), (tangential row, dof), (dof, tangential column); `None` if the degree of
    /// freedom has no equation.
    pub slots: Option<[usize; 4]>,
    /// Its index among the unknowns of the condensed bodies' interface.
    pub unknown: Option<usize>,
}

/// Coupling of a contact with another contact on the same element with local flexibility, and its entries in the whole system.
#[derive(Debug, Clone, Default)]
pub struct Partner {
    /// Number of the other contact.
    pub other: usize,
    /// c_ij (length per force).
    pub give: f64,
    /// ∂c_ij/∂ξ_i and ∂c_ij/∂ξ_j; `cross` is ∂²c_ij/∂ξ_i∂ξ_j (all length per force).
    pub slopes: [f64; 2],
    pub cross: f64,
    /// F_j, and its derivative with respect to F_n of the other contact.
    pub force: f64,
    pub force_slope: f64,
    /// Index of the entry (normal row, normal column of the other contact).
    pub block: usize,
    /// Indices of the entries (normal row, other link), (link, normal column of the other), and (link, other link), row by row;
    /// `None` where a degree of freedom has no equation.
    pub row: Vec<Option<usize>>,
    pub column: Vec<Option<usize>>,
    pub pairs: Vec<Option<usize>>,
}

/// A slave node's part of the system.
#[derive(Debug, Default)]
pub struct Interface {
    pub projection: Option<Projection>,
    /// Remaining initial overlap (length), which is an allowed penetration.
    pub allowed: f64,
    /// Contact law, and its deformation along n under the current normal force (length).
    pub bond: Bond,
    pub given: f64,
    /// The linearised contact on an element with local flexibility (a single entry); empty for other elements.
    pub point: Vec<LinearisedForce>,
    /// Couplings with the other contacts on that element.
    pub partners: Vec<Partner>,
    pub links: Vec<Link>,
    /// The element that `links` refer to, once they are listed.
    linked: Option<Option<(usize, usize)>>,
    /// Whether the entry positions belong to the current matrices.
    pub placed: bool,
    /// Entry (link i, link j), row by row, for the geometric tangent: in the full system or in the condensed matrix, depending on
    /// whether [`Interface::find_slots`] or [`Interface::find_unknowns`] ran last; `None` if either link has no equation.
    pub pairs: Vec<Option<usize>>,
    /// Entries of the 2 by 2 block of ΔF_n, ΔF_t.
    pub block: [usize; 4],
    /// Distances along −t and +t to the ends of the side, where it meets another side at an angle (length).
    pub room: [Option<f64>; 2],
    /// Whether the normal and the tangential motion have nonzero coefficients of unknowns.
    pub moves: [bool; 2],
    /// Contribution of prescribed motion to u_S* − u_S in this major iteration, by axis.
    pub prescribed: [f64; 2],
    /// Contribution of prescribed motions to the normal and tangential rows on an element with local flexibility (length).
    pub pushed: [f64; 2],
}

impl Interface {
    /// n and t, frozen; without a surface, the previous ones of the node.
    pub fn frame(&self, node: &ContactState) -> [[f64; 2]; 2] {
        let normal = self.projection.map_or(node.normal, |f| f.normal);
        [normal, tangent(normal)]
    }

    /// Coefficient of a link in the normal (k = 0) or tangential (k = 1) motion.
    pub fn row(&self, link: usize, k: usize, frame: &[[f64; 2]; 2]) -> f64 {
        match self.point.first() {
            Some(point) => point.rows[k][link],
            None => {
                let link = &self.links[link];
                link.weight * frame[k][link.axis]
            }
        }
    }

    /// Coefficient of ΔF_n (k = 0) or ΔF_t (k = 1) in the equation of a link.
    pub fn column(&self, link: usize, k: usize, frame: &[[f64; 2]; 2]) -> f64 {
        match self.point.first() {
            Some(point) => -point.columns[k][link],
            None => {
                let link = &self.links[link];
                link.weight * frame[k][link.axis]
            }
        }
    }

    /// Contribution of prescribed motions to the normal (k = 0) or tangential (k = 1) row (length).
    pub fn prescribed_along(&self, k: usize, frame: &[[f64; 2]; 2]) -> f64 {
        match self.point.is_empty() {
            true => dot(frame[k], self.prescribed),
            false => self.pushed[k],
        }
    }

    /// Compliances along n and t (length per force): bond and element in series.
    pub fn give(&self) -> [f64; 2] {
        let [normal, tangential] = self.bond.give();
        let own = self.point.first().map_or(0.0, |point| point.give);
        [normal + own, tangential]
    }

    /// Lists the displacements of S and S*; on an unchanged element, only updates their weights.
    pub fn link(&mut self, model: &Model, node: &ContactState, slave: &Contact) {
        let on = node.spot.zip(self.projection);
        let element = on.map(|(spot, _)| (spot.surface, spot.element));
        if self.linked != Some(element) {
            (self.linked, self.placed) = (Some(element), false);
            self.links.clear();
            slave.carriers().for_each(|(n, _)| self.list(model, n));
            if let Some((surface, element)) = element {
                for &n in &model.surfaces[surface].elements[element] {
                    self.list(model, n);
                }
            }
        }
        let (own, of_element) = self.links.split_at_mut(2 * slave.carriers().count());
        for (pair, (_, weight)) in own.chunks_exact_mut(2).zip(slave.carriers()) {
            pair.iter_mut().for_each(|link| link.weight = -weight);
        }
        if let Some((_, projection)) = on {
            let shares = projection.shape.iter().zip(&projection.shape_slope);
            for (pair, (&weight, &slope)) in of_element.chunks_exact_mut(2).zip(shares) {
                for link in pair {
                    (link.weight, link.slope) = (weight, slope);
                }
            }
        }
    }

    fn list(&mut self, model: &Model, node: usize) {
        let first = model.dofs.first[node];
        self.links.extend((0..2).map(|axis| Link {
            dof: first + axis,
            axis,
            weight: 0.0,
            slope: 0.0,
            variation: Variation::default(),
            slots: None,
            unknown: None,
        }));
    }

    /// Looks up its entries in the full system if necessary; its two equations start at row `row`.
    pub fn find_slots(&mut self, model: &Model, pattern: &Pattern, row: usize) {
        if std::mem::replace(&mut self.placed, true) {
            return;
        }
        let slot = |i, j| pattern.slot(i, j);
        for link in &mut self.links {
            link.slots = model.dofs.equation[link.dof].and_then(|e| {
                Some([
                    slot(row, e)?,
                    slot(e, row)?,
                    slot(row + 1, e)?,
                    slot(e, row + 1)?,
                ])
            });
        }
        let equations = |l: &Link| model.dofs.equation[l.dof];
        self.pairs.clear();
        for i in self.links.iter().map(equations) {
            let pair = |j: Option<usize>| slot(i?, j?);
            self.pairs
                .extend(self.links.iter().map(equations).map(pair));
        }
        let block = [
            (row, row),
            (row, row + 1),
            (row + 1, row),
            (row + 1, row + 1),
        ];
        for (place, (i, j)) in self.block.iter_mut().zip(block) {
            *place = slot(i, j).unwrap_or(*place);
        }
    }

    /// Looks up its entries in the condensed bodies if necessary: `number` maps equations to unknowns, `place` maps entries to
    /// matrix indices.
    pub fn find_unknowns(
        &mut self,
        model: &Model,
        number: impl Fn(usize) -> Option<usize>,
        place: impl Fn(usize, usize) -> Option<usize>,
    ) {
        if std::mem::replace(&mut self.placed, true) {
            return;
        }
        for link in &mut self.links {
            link.unknown = model.dofs.equation[link.dof].and_then(&number);
        }
        self.pairs.clear();
        for row in &self.links {
            let pair = |col: &Link| place(row.unknown?, col.unknown?);
            self.pairs.extend(self.links.iter().map(pair));
        }
    }
}
