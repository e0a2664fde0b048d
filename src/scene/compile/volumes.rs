//! Nodal forces of loads per undeformed volume.

use super::super::limits;
use super::super::nodes::Names;
use crate::format::error::{AtPath, Fault, Path, none_called};
use std::collections::{BTreeMap, HashMap, HashSet};
use stickslip_core::fem::continuum::{self, Sample};
use stickslip_core::model::{Body, Elastic, ElementKind, Law, Solid, SolidElement, Update};

/// Consistent forces ∫ N_i b w dA of a force b per volume, by ascending node number, where w is the width across the plane; `on`
/// names a solid, or a block or mesh used by solids.
pub(super) fn forces(
    here: &Path,
    names: &Names,
    bodies: &[Body],
    on: &str,
    vector: [f64; 2],
) -> Result<Vec<(usize, [f64; 2])>, Fault> {
    for (field, value) in ["x", "y"].into_iter().zip(vector) {
        limits::finite(&here.then(field), value, "the load")?;
    }
    let parts = parts(names, bodies, on).at(here.then("on"))?;
    let mut rules: HashMap<ElementKind, Vec<Sample>> = HashMap::new();
    let mut sums = BTreeMap::new();
    for (element, elastic) in parts {
        let rule = rules
            .entry(element.kind)
            .or_insert_with(|| continuum::formulation(element.kind).rule());
        let at: Vec<[f64; 2]> = element.nodes.iter().map(|&n| names.nodes[n].at).collect();
        for point in rule.iter() {
            let volume = point.weight * jacobian(point, &at) * width(point, &at, elastic);
            for (node, n) in element.nodes.iter().zip(&point.n) {
                let sum = sums.entry(*node).or_insert([0.0; 2]);
                *sum = [0, 1].map(|k| sum[k] + n * vector[k] * volume);
            }
        }
    }
    Ok(sums.into_iter().collect())
}

/// The elements that a name refers to, with their materials.
fn parts<'b>(
    names: &Names,
    bodies: &'b [Body],
    on: &str,
) -> Result<Vec<(&'b SolidElement, &'b Elastic)>, String> {
    let solids = || bodies.iter().filter_map(|body| Some((body, body.solid()?)));
    let of = |solid: &'b Solid| {
        solid
            .elements
            .iter()
            .map(|element| (element, &solid.materials[element.material]))
    };
    if let Some((_, solid)) = solids().find(|(body, _)| body.name == on) {
        return Ok(of(solid).collect());
    }
    if bodies.iter().any(|body| body.name == on) {
        return Err(format!("body {on:?} is not a solid and has no volume"));
    }
    let Ok(mesh) = names.mesh(on) else {
        let known = solids().map(|(body, _)| body.name.as_str());
        return Err(none_called("solid", on, "solids", known) + ", and no block or mesh");
    };
    let wanted: HashSet<Vec<usize>> = mesh.elements.into_iter().map(|(_, nodes)| nodes).collect();
    let found: Vec<_> = solids()
        .flat_map(|(_, solid)| of(solid))
        .filter(|(element, _)| wanted.contains(&element.nodes))
        .collect();
    if found.is_empty() {
        return Err(format!(
            "no solid uses {on:?}, so a load there has no effect"
        ));
    }
    Ok(found)
}

/// The body that an expansion acts on.
pub(super) fn expanding(bodies: &[Body], on: &str) -> Result<usize, String> {
    let found = bodies.iter().position(|body| body.name == on);
    let Some((place, solid)) = found.and_then(|k| Some((k, bodies[k].solid()?))) else {
        let solids = bodies.iter().filter(|body| body.solid().is_some());
        let names = solids.map(|body| body.name.as_str());
        return Err(none_called("solid", on, "solids", names));
    };
    if !solid
        .materials
        .iter()
        .all(|m| m.law == Law::Svk && m.update != Update::Updated)
    {
        return Err(format!(
            "body {on:?} cannot expand: this needs law svk, and update total or small"
        ));
    }
    Ok(place)
}

fn jacobian(point: &Sample, at: &[[f64; 2]]) -> f64 {
    let sum =
        |k: usize, by: usize| -> f64 { at.iter().zip(&point.d).map(|(x, d)| x[k] * d[by]).sum() };
    sum(0, 0) * sum(1, 1) - sum(0, 1) * sum(1, 0)
}

fn width(point: &Sample, at: &[[f64; 2]], elastic: &Elastic) -> f64 {
    elastic.width(at.iter().zip(&point.n).map(|(x, n)| n * x[0]).sum())
}
