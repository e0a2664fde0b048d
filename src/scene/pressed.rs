//! Detects, before any solve, prescribed displacements that compress a solid beyond the range of its law.
//!
//! Two points of a solid on a line along an axis, with prescribed displacements along that axis, determine the mean stretch
//! between them: s = (ΔX + Δu) / ΔX. If cross lines stay straight, as under flat plates, the mean of the smallest principal
//! stretch is at most s, regardless of lateral motion. A point is prescribed by a support, by a prescribed displacement, or by a
//! rigid surface that approaches it by more than its gap.

use stickslip_core::contact::projection::{project, projection_at};
use stickslip_core::fem::deformation::{SOFTENING, StretchRange};
use stickslip_core::plane::range;
use stickslip_core::{Body, Model, Solid};

/// Cosine above which a surface's normal counts as along an axis.
const ALONG: f64 = 0.99;
/// Two points are above each other within this fraction of their distance.
const ABOVE: f64 = 0.1;
/// Maximum number of points of a body that are compared in pairs.
const MOST: usize = 2000;

/// A point of a solid whose motion along an axis is prescribed.
struct HeldPoint {
    at: [f64; 2],
    /// Motion along the axis (length).
    motion: f64,
    node: usize,
}

/// One sentence for each solid that prescribed displacements compress beyond the range of St Venant-Kirchhoff's law.
pub fn warnings(model: &Model) -> Vec<String> {
    let motions = Motions::from_model(model);
    model
        .bodies
        .iter()
        .filter_map(|body| warning(&motions, body, body.solid()?))
        .collect()
}

fn warning(motions: &Motions, body: &Body, solid: &Solid) -> Option<String> {
    let model = motions.model;
    let softens = |number: &usize| {
        let elastic = &solid.materials[*number];
        StretchRange::from_elastic(elastic) == StretchRange::Stretch(SOFTENING)
    };
    let number = (0..solid.materials.len()).find(softens)?;
    let mut worst: Option<(f64, f64, [usize; 2])> = None;
    for load in loads(model) {
        for axis in 0..2 {
            let points = held_points(body, motions, (axis, load));
            let Some((stretch, nodes)) = smallest_stretch(&points, axis) else {
                continue;
            };
            if stretch < worst.map_or(SOFTENING, |(least, ..)| least) {
                worst = Some((stretch, load, nodes));
            }
        }
    }
    let (stretch, load, nodes) = worst?;
    let [a, b] = nodes.map(|node| &model.nodes[node].name);
    Some(format!(
        "the motions prescribed up to load {load} compress body {} to {stretch:.3} of its length between {a} and {b}; St Venant-Kirchhoff (law: svk) softens below {SOFTENING:.4}, materials.{}.law=neohookean does not",
        body.name, solid.material_names[number]
    ))
}

/// The load factors at which a prescribed displacement can be largest: corners of the path and of the amplitudes.
fn loads(model: &Model) -> Vec<f64> {
    let scales = model.prescribed.iter().flat_map(|p| &p.scale.0);
    let [low, high] = range(model.path.iter().copied());
    let corners = scales
        .map(|(load, _)| *load)
        .filter(|load| (low..=high).contains(load));
    let mut all: Vec<f64> = model.path.iter().copied().chain(corners).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Values of the degrees of freedom without an equation, and what else is found by node.
struct Motions<'a> {
    model: &'a Model,
    /// Number of the prescribed value for each degree of freedom.
    prescribed: Vec<Option<usize>>,
    positions: Vec<[f64; 2]>,
    /// The contacts of each node, as slave node or as node of the face of a slave point.
    contacts: Vec<Vec<usize>>,
}

impl<'a> Motions<'a> {
    fn from_model(model: &'a Model) -> Self {
        let mut prescribed = vec![None; model.dofs.len()];
        for (number, one) in model.prescribed.iter().enumerate() {
            prescribed[one.dof] = Some(number);
        }
        let mut contacts = vec![Vec::new(); model.nodes.len()];
        for (number, contact) in model.contacts.iter().enumerate() {
            for (node, _) in contact.carriers() {
                contacts[node].push(number);
            }
        }
        Motions {
            model,
            prescribed,
            positions: model.nodes.iter().map(|node| node.at).collect(),
            contacts,
        }
    }

    /// Displacement of a node along an axis at a load factor; `None` if unknown.
    fn at(&self, node: usize, axis: usize, load: f64) -> Option<f64> {
        let dof = self.model.dofs.first[node] + axis;
        if self.model.dofs.equation.get(dof)?.is_some() {
            return None;
        }
        Some(self.prescribed[dof].map_or(0.0, |number| {
            let one = &self.model.prescribed[number];
            one.value * one.scale.at(load)
        }))
    }
}

/// The points of a body whose motion along an axis is prescribed at a load factor.
fn held_points(body: &Body, motions: &Motions, (axis, load): (usize, f64)) -> Vec<HeldPoint> {
    let (model, places) = (motions.model, &motions.positions);
    let point = |node: usize, motion: f64| HeldPoint {
        at: places[node],
        motion,
        node,
    };
    let own = body
        .nodes
        .iter()
        .filter_map(|&node| Some(point(node, motions.at(node, axis, load)?)));
    let mut contacts: Vec<usize> = body
        .nodes
        .iter()
        .flat_map(|&node| &motions.contacts[node])
        .copied()
        .collect();
    contacts.sort_unstable();
    contacts.dedup();
    let pushed = contacts.iter().filter_map(|&number| {
        let contact = &model.contacts[number];
        let mut carriers = contact.carriers();
        if carriers.all(|(node, _)| motions.at(node, axis, load).is_some()) {
            return None;
        }
        let at = places[contact.node];
        let spot = project(at, &model.surfaces, &contact.surfaces, places, None)?;
        let surface = &model.surfaces[spot.surface];
        let over = projection_at(&model.surfaces, spot, places, at);
        let along = over.normal[axis];
        let mover = *surface.elements.get(spot.element)?.first()?;
        if !surface.rigid || along.abs() < ALONG {
            return None;
        }
        let motion = motions.at(mover, axis, load)?;
        let push = motion * along - over.gap;
        (push > 0.0).then(|| point(contact.node, push * along.signum()))
    });
    own.chain(pushed).take(MOST).collect()
}

/// The smallest mean stretch between two points, one above the other, and their nodes.
fn smallest_stretch(points: &[HeldPoint], axis: usize) -> Option<(f64, [usize; 2])> {
    let mut least: Option<(f64, [usize; 2])> = None;
    for (k, a) in points.iter().enumerate() {
        for b in &points[k + 1..] {
            let apart = [0, 1].map(|axis| b.at[axis] - a.at[axis]);
            if apart[1 - axis].abs() > ABOVE * apart[axis].abs() || apart[axis] == 0.0 {
                continue;
            }
            let stretch = 1.0 + (b.motion - a.motion) / apart[axis];
            if least.is_none_or(|(least, _)| stretch < least) {
                least = Some((stretch, [a.node, b.node]));
            }
        }
    }
    least
}
