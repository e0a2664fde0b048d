//! An element of a master surface as a curve: the Lagrange curve through its nodes, or its piece of a smooth chain
//! ([`super::smooth`]).

use crate::contact::smooth;
use crate::fem::lagrange::{self, MAX_NODES, Shape};
use crate::model::{Piece, Surface};

/// Samples of a piece of a smooth chain, as many as of a cubic Lagrange curve.
const SAMPLES: usize = 7;

/// An element of a master surface. Its curve is x(ξ) = Σ N_i(ξ) x_i over its nodes, −1 <= ξ <= 1.
#[derive(Debug, Clone, Copy)]
pub struct Element<'a> {
    /// The nodes that its curve depends on.
    pub nodes: &'a [usize],
    piece: Option<&'a Piece>,
}

impl<'a> Element<'a> {
    /// Element `number` of a surface.
    pub fn of(surface: &'a Surface, number: usize) -> Self {
        Element {
            nodes: &surface.elements[number],
            piece: surface.smooth.get(number),
        }
    }

    /// The Lagrange curve through these nodes.
    pub fn lagrange(nodes: &'a [usize]) -> Self {
        Element { nodes, piece: None }
    }

    /// All elements of a surface.
    pub fn all(surface: &'a Surface) -> impl Iterator<Item = Element<'a>> {
        (0..surface.elements.len()).map(|number| Element::of(surface, number))
    }

    /// The functions N_i at ξ, with two derivatives.
    pub fn shape(&self, xi: f64) -> Shape {
        match self.piece {
            Some(piece) => smooth::shape(piece, xi),
            None => lagrange::shape(self.nodes.len(), xi),
        }
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

    /// Whether it is a piece of a smooth chain.
    pub fn is_smooth(&self) -> bool {
        self.piece.is_some()
    }

    /// Degree of its curve in ξ.
    pub fn degree(&self) -> usize {
        match self.piece {
            Some(_) => 3,
            None => self.nodes.len() - 1,
        }
    }

    /// At how many ξ a search for the closest point looks first.
    pub fn samples(&self) -> usize {
        match self.piece {
            Some(_) => SAMPLES,
            None => lagrange::samples(self.nodes.len()).len(),
        }
    }

    /// One of these ξ, equally spaced from −1 to 1, and N_i there.
    pub fn sample(&self, k: usize) -> (f64, [f64; MAX_NODES]) {
        match self.piece {
            Some(piece) => {
                let xi = lagrange::node(SAMPLES, k);
                (xi, smooth::shape(piece, xi).n)
            }
            None => lagrange::samples(self.nodes.len())[k],
        }
    }
}

/// Whether a chain ends where it begins.
pub fn closed(surface: &Surface) -> bool {
    let count = surface.elements.len();
    count > 1 && Element::of(surface, 0).first() == Element::of(surface, count - 1).last()
}
