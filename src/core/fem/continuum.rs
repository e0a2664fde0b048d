//! The kinds of continuum elements, one file each: a new one is a file, a kind in [`ElementKind`], and a line in each of
//! the functions here.

use crate::fem::element::{Element, Past};
use crate::fem::material::Material;
use crate::fem::quad8;
use crate::model::{ElementKind, Update};

/// An element of a kind on these undeformed positions. One that has not as many as its kind has nodes never answers, so that
/// no state of it can be accepted.
pub fn element(
    kind: ElementKind,
    at: &[[f64; 2]],
    material: Material,
    update: Update,
) -> Box<dyn Element> {
    match (kind, at.try_into()) {
        (ElementKind::Quad8, Ok(at)) => Box::new(quad8::Element::new(at, material, update)),
        (kind, Err(_)) => Box::new(Malformed {
            dofs: 2 * at.len(),
            history: history_len(kind, update),
        }),
    }
}

/// An element with the wrong number of nodes.
struct Malformed {
    dofs: usize,
    history: usize,
}

impl Element for Malformed {
    fn dofs(&self) -> usize {
        self.dofs
    }

    fn history_len(&self) -> usize {
        self.history
    }

    fn add(&self, _: &Past<'_>, _: &[f64], _: &mut [f64], _: &mut [f64]) -> bool {
        false
    }
}

/// How many numbers an element of a kind remembers from increment to increment.
pub fn history_len(kind: ElementKind, update: Update) -> usize {
    match kind {
        ElementKind::Quad8 => quad8::history_len(update),
    }
}

/// Shape functions of a kind, and their derivatives by ξ and η, at a point of the parent element.
pub fn shape(kind: ElementKind, xi: f64, eta: f64) -> (Vec<f64>, Vec<[f64; 2]>) {
    match kind {
        ElementKind::Quad8 => {
            let (n, d) = quad8::shape(xi, eta);
            (n.to_vec(), d.to_vec())
        }
    }
}

/// Places of the nodes of a kind in its parent element.
pub fn places(kind: ElementKind) -> Vec<[f64; 2]> {
    match kind {
        ElementKind::Quad8 => quad8::PLACES.to_vec(),
    }
}
