//! An element of a master surface as a curve: the Lagrange curve through its nodes, or its piece of a smooth chain
//! ([`super::smooth`]). The first and the last element may extend past their nodes; ξ = ±1 is then beyond the node, on the same
//! curve.

use crate::contact::smooth;
use crate::fem::lagrange::{self, MAX_NODES, Shape};
use crate::model::{Piece, Surface};

/// Number of samples of a piece of a smooth chain; the same as for a cubic Lagrange curve.
const SAMPLES: usize = 7;
/// Well-shaped curves leave the bounding box of their nodes by less than this, relative to the sum of its sides.
const BULGE: f64 = 0.5;

/// An element of a master surface. Its curve is x(ξ) = Σ N_i(ξ) x_i over its nodes, −1 <= ξ <= 1.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceElement<'a> {
    /// The nodes that its curve depends on.
    pub nodes: &'a [usize],
    piece: Option<&'a Piece>,
    /// ξ of the curve at ξ = 0 of the element, and its derivative; 0 and 1 unless the element extends past a node.
    middle: f64,
    scale: f64,
}

impl<'a> SurfaceElement<'a> {
    /// Element `number` of a surface.
    pub fn from_surface(surface: &'a Surface, number: usize) -> Self {
        let [mut before, mut behind] = surface.past_ends;
        before = if number == 0 { before } else { 0.0 };
        behind = if number + 1 == surface.elements.len() {
            behind
        } else {
            0.0
        };
        SurfaceElement {
            nodes: &surface.elements[number],
            piece: surface.smooth.get(number),
            middle: 0.5 * (behind - before),
            scale: 1.0 + 0.5 * (before + behind),
        }
    }

    /// The Lagrange curve through these nodes.
    pub fn lagrange(nodes: &'a [usize]) -> Self {
        SurfaceElement {
            nodes,
            piece: None,
            middle: 0.0,
            scale: 1.0,
        }
    }

    /// All elements of a surface.
    pub fn all(surface: &'a Surface) -> impl Iterator<Item = SurfaceElement<'a>> {
        (0..surface.elements.len()).map(|number| SurfaceElement::from_surface(surface, number))
    }

    /// The functions N_i at ξ, with two derivatives.
    pub fn shape(&self, xi: f64) -> Shape {
        let along = self.along(xi);
        let s = match self.piece {
            Some(piece) => smooth::shape(piece, along),
            None => lagrange::shape(self.nodes.len(), along),
        };
        Shape {
            n: s.n,
            d: s.d.map(|d| d * self.scale),
            dd: s.dd.map(|dd| dd * self.scale * self.scale),
        }
    }

    /// ξ of the curve.
    fn along(&self, xi: f64) -> f64 {
        self.middle + self.scale * xi
    }

    /// dN_i/dξ alone.
    pub fn slopes(&self, xi: f64) -> [f64; MAX_NODES] {
        let [slopes] = self.slopes_at([xi]);
        slopes
    }

    /// The same at several ξ.
    pub fn slopes_at<const COUNT: usize>(&self, xi: [f64; COUNT]) -> [[f64; MAX_NODES]; COUNT] {
        let along = xi.map(|xi| self.along(xi));
        let slopes = match self.piece {
            Some(piece) => along.map(|xi| smooth::shape(piece, xi).d),
            None => lagrange::slopes(self.nodes.len(), along),
        };
        slopes.map(|slopes| slopes.map(|d| d * self.scale))
    }

    /// The node where it begins.
    pub fn first(&self) -> Option<&'a usize> {
        self.nodes.get(self.piece.map_or(0, |piece| piece.first))
    }

    /// The node where it ends.
    pub fn last(&self) -> Option<&'a usize> {
        match self.piece {
            Some(piece) => self.nodes.get(piece.first + 1),
            None => self.nodes.last(),
        }
    }

    /// Whether ξ is in the outer half of an extension, where only nodes that already touch are over the surface. Without this margin
    /// a node that bulges past an end would be freed, draw back, and touch again.
    pub fn only_holds(&self, xi: f64) -> bool {
        let (along, both) = (self.along(xi), self.scale - 1.0);
        let [before, behind] = [both - self.middle, both + self.middle];
        both > 0.0 && (along < -1.0 - 0.5 * before || along > 1.0 + 0.5 * behind)
    }

    /// Whether its curve is the Lagrange curve from its first to its last node.
    pub fn is_plain(&self) -> bool {
        self.piece.is_none() && self.scale == 1.0
    }

    /// Degree of its curve in ξ.
    pub fn degree(&self) -> usize {
        match self.piece {
            Some(_) => 3,
            None => self.nodes.len() - 1,
        }
    }

    /// Passes each start value ξ of a search for the closest point, equally spaced from −1 to 1, with its N_i to `look`.
    pub fn samples(&self, mut look: impl FnMut(f64, &[f64; MAX_NODES])) {
        if self.is_plain() {
            let table = lagrange::samples(self.nodes.len());
            table.iter().for_each(|(xi, n)| look(*xi, n));
        } else {
            for k in 0..SAMPLES {
                let xi = lagrange::node(SAMPLES, k);
                look(xi, &self.shape(xi).n);
            }
        }
    }

    /// Maximum distance by which the curve leaves the bounding box of its nodes along each axis, where `sides` are the sides of
    /// the box. On m equally spaced nodes that is the largest sum of the negative N_i, times the side.
    pub fn bulge(&self, sides: [f64; 2]) -> [f64; 2] {
        let by = |share: f64| sides.map(|side| share * side);
        match (self.piece, self.nodes.len()) {
            _ if self.scale != 1.0 => [BULGE * (sides[0] + sides[1]); 2],
            (None, 2) => [0.0; 2],
            (None, 3) => by(0.126),
            (None, 4) => by(0.316),
            (None, 5) => by(0.605),
            _ => [BULGE * (sides[0] + sides[1]); 2],
        }
    }
}

/// Positions of an element's nodes, looked up once for all ξ of a search. Unused entries have N_i = 0, because sums of fixed
/// length need no loop.
pub struct ElementPositions([[f64; 2]; MAX_NODES]);

impl ElementPositions {
    /// Looks up the positions of these nodes.
    pub fn from_nodes(nodes: &[usize], positions: &[[f64; 2]]) -> Self {
        let mut places = [[0.0; 2]; MAX_NODES];
        for (place, &n) in places.iter_mut().zip(nodes) {
            *place = positions[n];
        }
        ElementPositions(places)
    }

    /// Weighted sum of the positions.
    pub fn sum(&self, weights: &[f64; MAX_NODES]) -> [f64; 2] {
        self.sum_from([0.0; 2], weights)
    }

    /// The same, added to an initial value.
    pub fn sum_from(&self, mut sum: [f64; 2], weights: &[f64; MAX_NODES]) -> [f64; 2] {
        for (at, w) in self.0.iter().zip(weights) {
            sum = [sum[0] + w * at[0], sum[1] + w * at[1]];
        }
        sum
    }
}

/// Whether a chain is closed.
pub fn closed(surface: &Surface) -> bool {
    let count = surface.elements.len();
    count > 1
        && SurfaceElement::from_surface(surface, 0).first()
            == SurfaceElement::from_surface(surface, count - 1).last()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_curve_leaves_the_box_around_its_nodes_by_more_than_its_bulge() {
        // The worst nodes are at the low end of the box where N_i is positive, and at the high end elsewhere.
        for m in 2..=5 {
            let nodes: Vec<usize> = (0..m).collect();
            let [bulge, _] = SurfaceElement::lagrange(&nodes).bulge([1.0; 2]);
            let out = |k: u32| {
                let n = lagrange::shape(m, -1.0 + f64::from(k) * 1e-3).n;
                n.iter().map(|n| (-n).max(0.0)).sum::<f64>()
            };
            let worst = (0..=2000).map(out).fold(0.0, f64::max);
            assert!(
                worst <= bulge && bulge <= 1.01 * worst,
                "{m}: {worst} {bulge}"
            );
        }
    }

    #[test]
    fn weighted_sums_match_the_nodes() {
        let (nodes, positions) = ([2, 0], [[1.0, 2.0], [9.0, 9.0], [3.0, -4.0]]);
        let n = SurfaceElement::lagrange(&nodes).shape(0.5).n;
        let exact = [0.25 * 3.0 + 0.75 * 1.0, 0.25 * -4.0 + 0.75 * 2.0];
        assert_eq!(
            ElementPositions::from_nodes(&nodes, &positions).sum(&n),
            exact
        );
    }
}
