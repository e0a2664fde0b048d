//! Materials, bodies, and the elements along chains.

use super::super::error::{Fault, Path, at, did_you_mean, quoted, some_of};
use super::super::geometry;
use super::super::limits;
use super::super::model::{Beam, Body, BodyKind};
use super::super::nodes::{Names, unique};
use super::super::spec::{BodySpec, Material, Spec};
use std::collections::HashSet;

/// Refuses materials without usable stiffnesses.
pub(super) fn materials(spec: &Spec) -> Result<(), Fault> {
    unique("materials", spec.materials.iter().map(Material::id))?;
    for (k, material) in spec.materials.iter().enumerate() {
        let here = at!["materials", k];
        let Material::Section { EA, EI, GA, .. } = material;
        limits::stiffness(&here.then("EA"), *EA, "EA")?;
        limits::stiffness(&here.then("EI"), *EI, "EI")?;
        if let Some(ga) = GA {
            limits::stiffness(&here.then("GA"), *ga, "GA")?;
        }
    }
    Ok(())
}

/// The bodies. Their shear unknowns are numbered later, with the others.
pub(super) fn bodies(spec: &Spec, names: &Names) -> Result<Vec<Body>, Fault> {
    if spec.bodies.is_empty() {
        return Err(Fault::new(
            at!["bodies"],
            "the scene has no body; nothing could deform",
        ));
    }
    unique("bodies", spec.bodies.iter().map(BodySpec::id))?;
    let mut total = 0;
    spec.bodies
        .iter()
        .enumerate()
        .map(|(k, body)| beam(k, body, spec, names, &mut total))
        .collect()
}

/// The elements along a chain; `total` counts their nodes.
pub(super) fn elements(
    here: &Path,
    names: &Names,
    along: &str,
    total: &mut usize,
) -> Result<Vec<Vec<usize>>, Fault> {
    let chain = names
        .chain(along)
        .map_err(|message| Fault::new(here.clone(), message))?;
    // An element has at most twice as many nodes as it adds to its chain.
    *total += 2 * chain.nodes.len();
    limits::element_nodes(here, *total)?;
    Ok(chain.elements())
}

fn beam(
    k: usize,
    body: &BodySpec,
    spec: &Spec,
    names: &Names,
    total: &mut usize,
) -> Result<Body, Fault> {
    let BodySpec::Beam {
        id,
        along,
        material,
    } = body;
    let here = at!["bodies", k];
    let elements = elements(&here.then("along"), names, along, total)?;
    let ids = || spec.materials.iter().map(Material::id);
    let Some(section) = spec.materials.iter().find(|m| m.id() == material) else {
        let message = format!(
            "no material called {}{} (materials: {})",
            quoted(material),
            did_you_mean(material, ids()),
            some_of(ids())
        );
        return Err(Fault::new(here.then("material"), message));
    };
    let Material::Section { EA, EI, GA, .. } = section;
    let mut seen = HashSet::new();
    Ok(Body {
        name: id.clone(),
        nodes: elements
            .iter()
            .flatten()
            .copied()
            .filter(|n| seen.insert(*n))
            .collect(),
        kind: BodyKind::Beam(Beam {
            elements,
            ea: *EA,
            ei: *EI,
            ga: *GA,
            first_shear: None,
        }),
    })
}

/// Refuses bodies whose elements are no sound curves.
pub(super) fn check_bodies(
    spec: &Spec,
    names: &Names,
    bodies: &[Body],
    length: f64,
) -> Result<(), Fault> {
    for (body, BodySpec::Beam { along, .. }) in bodies.iter().zip(&spec.bodies) {
        let BodyKind::Beam(beam) = &body.kind;
        check_chain(names, along, &beam.elements, length)?;
    }
    Ok(())
}

/// Refuses elements along a chain that are no sound curves.
pub(super) fn check_chain(
    names: &Names,
    along: &str,
    elements: &[Vec<usize>],
    length: f64,
) -> Result<(), Fault> {
    // The chain was found when the elements were made.
    let at = names
        .chain(along)
        .map_or_else(|_| at!["nodes"], |chain| at!["nodes", chain.at]);
    geometry::check_elements(&at, &names.nodes, elements, length)
}
