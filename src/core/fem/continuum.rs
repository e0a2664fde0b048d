//! The kinds of continuum elements, one file each: a new one is a file, a kind in [`ElementKind`], and a line in each of
//! the functions here.

use crate::fem::element::Element;
use crate::fem::material::Material;
use crate::fem::quad8;
use crate::model::{ElementKind, Update};

/// An element of a kind on these undeformed positions; `None` where there are not as many as it has nodes.
pub fn element(
    kind: ElementKind,
    at: &[[f64; 2]],
    material: Material,
    update: Update,
) -> Option<Box<dyn Element>> {
    match kind {
        ElementKind::Quad8 => {
            let at = at.try_into().ok()?;
            Some(Box::new(quad8::Element::new(at, material, update)))
        }
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
