//! Materials, bodies, and the elements along chains.

use super::super::curves::point;
use super::super::geometry;
use super::super::limits;
use super::super::nodes::checks::unique;
use super::super::nodes::{Mesh, NameEntry, Names};
use super::linear;
use crate::Spec;
use crate::format::error::{AtPath, Fault, Path, at, bail, fault, none_called};
use crate::format::spec::{BodySpec, Material, Point, Region};
use std::collections::HashSet;
use stickslip_core::model::{Beam, SolidElement, boundary};
use stickslip_core::{Body, BodyKind, Elastic, Law, Node, Plane, Solid, Update};

/// Rejects materials with invalid stiffnesses.
pub(super) fn materials(spec: &Spec) -> Result<(), Fault> {
    unique("materials", spec.materials.iter().map(Material::id))?;
    for (k, material) in spec.materials.iter().enumerate() {
        let here = at!["materials", k];
        match material {
            Material::Section { EA, EI, GA, .. } => {
                limits::stiffness(&here.then("EA"), *EA, "EA")?;
                limits::stiffness(&here.then("EI"), *EI, "EI")?;
                if let Some(ga) = GA {
                    limits::stiffness(&here.then("GA"), *ga, "GA")?;
                }
            }
            Material::Elastic { .. } => elastic(&here, material)?,
        }
    }
    Ok(())
}

/// Rejects invalid elastic constants.
fn elastic(here: &Path, material: &Material) -> Result<(), Fault> {
    let Some(made) = elastic_of(material) else {
        return Ok(());
    };
    limits::stiffness(&here.then("E"), made.young, "E")?;
    if !(0.0..limits::POISSON).contains(&made.poisson) {
        bail!(
            here.then("nu"),
            "nu is {:?}; it must be at least 0 and below 0.5 (incompressible)",
            made.poisson
        );
    }
    let thickness = made.thickness;
    limits::positive(&here.then("thickness"), thickness, "the thickness")?;
    if made.plane == Plane::Axisymmetric && thickness != 1.0 {
        bail!(
            here.then("thickness"),
            "a body of revolution has no thickness, because forces refer to the whole circumference; leave it out"
        );
    }
    let why = match made.update {
        Update::Updated => "update: updated uses the moduli of svk in every increment",
        Update::Small => "update: small is linear elasticity for every law",
        Update::Total => return Ok(()),
    };
    if made.law != Law::Svk {
        bail!(here.then("update"), "{why}; take law: svk or update: total");
    }
    Ok(())
}

/// The elastic constants of a material; `None` for a section.
fn elastic_of(material: &Material) -> Option<Elastic> {
    match *material {
        Material::Section { .. } => None,
        Material::Elastic {
            E,
            nu,
            law,
            plane,
            thickness,
            update,
            ..
        } => Some(Elastic {
            young: E,
            poisson: nu,
            law,
            plane,
            thickness,
            update,
        }),
    }
}

/// The bodies. Their shear unknowns are numbered later, with all others.
pub(super) fn bodies(spec: &Spec, names: &Names) -> Result<Vec<Body>, Fault> {
    if spec.bodies.is_empty() {
        bail!(
            at!["bodies"],
            "the scene has no body, so nothing can deform"
        );
    }
    unique("bodies", spec.bodies.iter().map(BodySpec::id))?;
    let mut total = 0;
    spec.bodies
        .iter()
        .enumerate()
        .map(|(k, body)| match body {
            BodySpec::Beam {
                id,
                along,
                material,
            } => beam(
                &at!["bodies", k],
                (id, along, material),
                spec,
                names,
                &mut total,
            ),
            BodySpec::Solid { id, mesh, .. } => {
                let here = at!["bodies", k];
                let path = here.then("mesh");
                let mesh = names.mesh(mesh).at(&path)?;
                total += mesh
                    .elements
                    .iter()
                    .map(|(kind, _)| kind.nodes())
                    .sum::<usize>();
                limits::element_nodes(&path, total, spec.settings.memory)?;
                Ok(Body {
                    name: id.clone(),
                    nodes: mesh.nodes.clone(),
                    kind: BodyKind::Solid(solid(&here, mesh, body, spec, names)?),
                })
            }
            BodySpec::Matrix { .. } => linear::matrix(&at!["bodies", k], body, names),
            BodySpec::Truss { .. } => linear::truss(&at!["bodies", k], body, names),
            BodySpec::Springs { id, bars } => linear::springs(&at!["bodies", k], id, bars, names),
        })
        .collect()
}

/// Rejects scenes that are only partly axisymmetric, and bodies of revolution that extend beyond the axis; `length` is the
/// scene's.
pub(super) fn check_axis(
    spec: &Spec,
    names: &Names,
    bodies: &[Body],
    length: f64,
) -> Result<(), Fault> {
    let Some(round) = bodies.iter().find(|body| body.is_axisymmetric()) else {
        return Ok(());
    };
    let name = &round.name;
    for (k, body) in bodies.iter().enumerate() {
        let plane = |m: &Elastic| m.plane != Plane::Axisymmetric;
        let (field, what) = match &body.kind {
            BodyKind::Beam(_) => ("along", "is a plane beam"),
            BodyKind::Solid(solid) if solid.materials.iter().any(plane) => {
                ("material", "has a plane material")
            }
            _ => continue,
        };
        bail!(
            at!["bodies", k, field],
            "body {:?} {what}, but body {name:?} is axisymmetric; a scene is axisymmetric as a whole or not at all",
            body.name
        );
    }
    let nodes = bodies.iter().flat_map(|body| &body.nodes);
    let Some(node) = nodes
        .copied()
        .collect::<Vec<_>>()
        .iter()
        .find(|node| names.nodes[**node].at[0] < -limits::SHORTEST * length)
        .copied()
    else {
        return Ok(());
    };
    let Node { name, at } = &names.nodes[node];
    let entry = spec.nodes.iter().position(|nodes| {
        let id = nodes.id();
        name == id
            || name
                .strip_prefix(id)
                .is_some_and(|rest| rest.starts_with('.'))
    });
    Err(fault!(
        entry.map_or_else(|| at!["nodes"], |k| at!["nodes", k]),
        "node {name:?} is at x = {:?}; in axisymmetry x is the radius and must not be negative",
        at[0]
    ))
}

/// Chain for elements, by id; `total` counts the nodes of the elements.
pub(super) fn chain<'n>(
    here: &Path,
    names: &'n Names,
    along: &str,
    total: &mut usize,
    spec: &Spec,
) -> Result<&'n NameEntry, Fault> {
    let chain = names.chain(along).at(here)?;
    // An element has at most twice as many nodes as it adds to its chain.
    *total += 2 * chain.nodes.len();
    limits::element_nodes(here, *total, spec.settings.memory)?;
    Ok(chain)
}

/// The material with an id.
fn material<'s>(here: &Path, spec: &'s Spec, id: &str) -> Result<&'s Material, Fault> {
    let ids = spec.materials.iter().map(Material::id);
    spec.materials.iter().find(|m| m.id() == id).ok_or_else(|| {
        let message = none_called("material", id, "materials", ids);
        Fault::new(here, message)
    })
}

fn beam(
    here: &Path,
    (id, along, of): (&str, &str, &str),
    spec: &Spec,
    names: &Names,
    total: &mut usize,
) -> Result<Body, Fault> {
    let path = here.then("along");
    let elements = chain(&path, names, along, total, spec)?.elements();
    if elements.iter().any(|e| e.len() != elements[0].len()) {
        bail!(
            path,
            "{along:?} has sides with 2 and with 3 nodes; the elements of a beam must all have the same number"
        );
    }
    let here = here.then("material");
    let Material::Section { EA, EI, GA, .. } = material(&here, spec, of)? else {
        bail!(
            here,
            "material {of:?} is a continuum material; a beam needs a Section"
        );
    };
    let mut seen = HashSet::new();
    Ok(Body {
        name: id.to_owned(),
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

/// A mesh with the material of each element.
fn solid(
    here: &Path,
    mesh: Mesh,
    body: &BodySpec,
    spec: &Spec,
    names: &Names,
) -> Result<Solid, Fault> {
    let BodySpec::Solid {
        material: of,
        regions,
        ..
    } = body
    else {
        bail!(here, "the body is not a solid");
    };
    let faces = mesh
        .elements
        .iter()
        .map(|(kind, nodes)| (*kind, nodes.as_slice()));
    let edges = boundary(faces);
    let elements = mesh.elements.into_iter().map(|(kind, nodes)| SolidElement {
        kind,
        nodes,
        material: 0,
    });
    let mut made = Solid {
        materials: vec![continuum(&here.then("material"), spec, of)?],
        material_names: vec![of.clone()],
        edges,
        elements: elements.collect(),
    };
    for (k, region) in regions.iter().enumerate() {
        apply(
            &here.then("regions").then(k),
            region,
            spec,
            &names.nodes,
            &mut made,
        )?;
    }
    Ok(made)
}

fn continuum(here: &Path, spec: &Spec, id: &str) -> Result<Elastic, Fault> {
    elastic_of(material(here, spec, id)?).ok_or_else(|| {
        fault!(
            here,
            "material {id:?} is a beam section; a solid needs Elastic"
        )
    })
}

/// Assigns the material of a region to its elements.
fn apply(
    here: &Path,
    region: &Region,
    spec: &Spec,
    nodes: &[Node],
    solid: &mut Solid,
) -> Result<(), Fault> {
    let Region { from, to, material } = region;
    let number = solid.materials.len();
    solid
        .materials
        .push(continuum(&here.then("material"), spec, material)?);
    solid.material_names.push(material.clone());
    for (corner, at) in [("from", from), ("to", to)] {
        point(&here.then(corner), *at)?;
    }
    let mut none = true;
    for element in &mut solid.elements {
        if contains((*from, *to), middle(nodes, element)) {
            (element.material, none) = (number, false);
        }
    }
    if none {
        bail!(
            here,
            "the region from {from:?} to {to:?} contains no element's midpoint; give its lower left \
             corner, then its upper right one"
        );
    }
    Ok(())
}

/// Mean of an element's corners.
fn middle(nodes: &[Node], element: &SolidElement) -> [f64; 2] {
    let at = |place: usize| nodes[element.nodes[place]].at;
    let corners = || element.kind.corners();
    let count = corners().count() as f64;
    [0, 1].map(|k| corners().map(|place| at(place)[k]).sum::<f64>() / count)
}

fn contains((from, to): (Point, Point), [x, y]: [f64; 2]) -> bool {
    (from.0..=to.0).contains(&x) && (from.1..=to.1).contains(&y)
}

/// Rejects bodies with invalid elements or edges.
pub(super) fn check_bodies(
    spec: &Spec,
    names: &Names,
    bodies: &[Body],
    length: f64,
) -> Result<(), Fault> {
    for (body, named) in bodies.iter().zip(&spec.bodies) {
        match (&body.kind, named) {
            (BodyKind::Beam(beam), BodySpec::Beam { along, .. }) => {
                check_chain(names, along, &beam.elements, length)?;
            }
            // The elements were already checked when their block was generated.
            (BodyKind::Solid(solid), BodySpec::Solid { mesh, .. }) => {
                check_chain(names, mesh, &solid.edges, length)?;
            }
            _ => {}
        }
    }
    Ok(())
}

/// Rejects chains with invalid elements.
pub(super) fn check_chain(
    names: &Names,
    along: &str,
    elements: &[Vec<usize>],
    length: f64,
) -> Result<(), Fault> {
    let at = names
        .place(along)
        .map_or_else(|| at!["nodes"], |at| at!["nodes", at]);
    geometry::check_elements(&at, &names.nodes, elements, length)
}
