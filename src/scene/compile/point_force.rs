//! Compliance of beam elements with a shear stiffness under point forces, for surfaces
//! ([`stickslip_core::contact::point_force`]).

use std::collections::HashMap;
use stickslip_core::fem::lagrange::{gauss, shape};
use stickslip_core::model::{Beam, Body, BodyKind, Node, PointForce, PointGive, Surface};

/// Number of Gauss points for the length of an element, which may be strongly curved.
const POINTS: usize = 36;

/// Computes the compliances of all surfaces. Smooth surfaces do not follow the beam's axis and have none.
pub(super) fn find_gives(
    wanted: PointForce,
    bodies: &[Body],
    nodes: &[Node],
    surfaces: &mut [Surface],
) {
    let beams = bodies.iter().filter_map(|body| match &body.kind {
        BodyKind::Beam(beam) => Some((beam, beam.ga?)),
        _ => None,
    });
    let mut gives = HashMap::new();
    for (beam, ga) in beams.filter(|_| wanted != PointForce::Plain) {
        for element in &beam.elements {
            gives.insert(walked(element), give(wanted, beam, ga, element, nodes));
        }
    }
    let smooth = |surface: &Surface| !surface.smooth.is_empty();
    for surface in surfaces.iter_mut().filter(|surface| !smooth(surface)) {
        let all = surface
            .elements
            .iter()
            .map(|element| gives.get(&walked(element)).copied());
        if all.clone().any(|give| give.is_some()) {
            surface.gives = all.map(Option::unwrap_or_default).collect();
        }
    }
}

/// The nodes of an element, independent of its direction.
fn walked(element: &[usize]) -> Vec<usize> {
    let mut nodes = element.to_vec();
    if nodes.first() > nodes.last() {
        nodes.reverse();
    }
    nodes
}

fn give(wanted: PointForce, beam: &Beam, ga: f64, element: &[usize], nodes: &[Node]) -> PointGive {
    let count = element.len();
    let speed = |xi: f64| {
        let slopes = shape(count, xi).d;
        let along = |axis: usize| -> f64 {
            element
                .iter()
                .zip(slopes)
                .map(|(&node, d)| d * nodes[node].at[axis])
                .sum()
        };
        along(0).hypot(along(1))
    };
    let length: f64 = gauss(POINTS).iter().map(|(xi, w)| w * speed(*xi)).sum();
    PointGive {
        shear: length / (8.0 * ga),
        bending: match wanted {
            PointForce::Exact => length.powi(3) / (32.0 * beam.ei),
            _ => 0.0,
        },
    }
}
