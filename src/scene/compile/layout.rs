//! Layout of the degrees of freedom: supports, loads, and equation numbers.

use super::super::limits;
use super::super::nodes::Names;
use super::{pressures, tractions, volumes};
use crate::Spec;
use crate::format::error::{AtPath, Fault, Path, at, bail, fault};
use crate::format::spec::{LoadSpec, Point};
use std::collections::HashMap;
use stickslip_core::model::{Factor, Load, Prescribed, Pressure};
use stickslip_core::{Body, Component, Dofs};

/// The loads of a scene on the model's degrees of freedom.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Loads {
    /// Dead loads.
    pub dead: Vec<Load>,
    /// Following pressures.
    pub pressures: Vec<Pressure>,
    /// Prescribed displacements.
    pub prescribed: Vec<Prescribed>,
}

/// The degrees of freedom while their supports are being determined.
pub(super) struct Layout {
    dofs: Dofs,
    /// Node and component of each degree of freedom.
    of: Vec<(usize, Component)>,
    on_body: Vec<bool>,
    held: HashMap<usize, Path>,
}

const COMPONENTS: [Component; 3] = [Component::X, Component::Y, Component::Rotation];

impl Layout {
    /// Three degrees of freedom for each beam node, two for other nodes; none is restrained yet.
    pub(super) fn new(on_body: Vec<bool>, bodies: &[Body]) -> Self {
        let dofs = Dofs::new(on_body.len(), bodies);
        let of = dofs
            .count
            .iter()
            .enumerate()
            .flat_map(|(node, &count)| {
                COMPONENTS
                    .iter()
                    .take(count.into())
                    .map(move |component| (node, *component))
            })
            .collect();
        Layout {
            dofs,
            of,
            on_body,
            held: HashMap::new(),
        }
    }

    fn dof(&self, names: &Names, node: usize, component: Component) -> Result<usize, String> {
        self.dofs
            .dof(node, component)
            .ok_or_else(|| no_rotation(names, node))
    }

    /// Applies the supports.
    pub(super) fn supports(&mut self, spec: &Spec, names: &Names) -> Result<(), Fault> {
        for (k, support) in spec.supports.iter().enumerate() {
            let here = at!["supports", k];
            let nodes = names.nodes(&support.node).at(here.then("node"))?;
            if support.fix.is_empty() {
                bail!(
                    here.then("fix"),
                    "the list is empty; it must contain some of x, y, rotation"
                );
            }
            for (j, component) in support.fix.iter().enumerate() {
                let fault = |message| Fault::new(here.then("fix").then(j), message);
                if support.fix[..j].contains(component) {
                    return Err(fault(format!("{component} is named twice")));
                }
                for &node in &nodes {
                    let dof = self.dof(names, node, *component).map_err(fault)?;
                    self.held.insert(dof, here.clone());
                }
            }
        }
        Ok(())
    }

    /// Applies loads and prescribed displacements.
    pub(super) fn loads(
        &mut self,
        spec: &Spec,
        names: &Names,
        bodies: &[Body],
    ) -> Result<Loads, Fault> {
        // Prescribed displacements come first, because a force on one of them has no effect.
        let mut loads = Loads {
            prescribed: self.prescribed(spec, names)?,
            ..Loads::default()
        };
        self.forces(spec, names, bodies, &mut loads)?;
        Ok(loads)
    }

    /// Applies prescribed displacements.
    pub(super) fn prescribed(
        &mut self,
        spec: &Spec,
        names: &Names,
    ) -> Result<Vec<Prescribed>, Fault> {
        let mut made = Vec::new();
        for (k, load) in spec.loads.iter().enumerate() {
            let LoadSpec::Displacement {
                node,
                component,
                value,
                scale,
            } = load
            else {
                continue;
            };
            let here = at!["loads", k];
            let scale = factor(&here.then("scale"), scale)?;
            limits::finite(&here.then("value"), *value, "the prescribed value")?;
            for node in names.nodes(node).at(here.then("node"))? {
                let dof = self.prescribe(&here, names, node, *component)?;
                // A prescribed zero is a support.
                if *value != 0.0 {
                    made.push(Prescribed {
                        dof,
                        value: *value,
                        scale: scale.clone(),
                    });
                }
            }
        }
        Ok(made)
    }

    fn forces(
        &self,
        spec: &Spec,
        names: &Names,
        bodies: &[Body],
        loads: &mut Loads,
    ) -> Result<(), Fault> {
        let made = &mut loads.dead;
        let round = bodies.iter().any(Body::is_axisymmetric);
        for (k, load) in spec.loads.iter().enumerate() {
            let (node, parts, scale) = match load {
                LoadSpec::Force { node, x, y, scale } => (
                    node,
                    vec![(Component::X, "x", *x), (Component::Y, "y", *y)],
                    scale,
                ),
                LoadSpec::Moment { node, value, scale } => {
                    (node, vec![(Component::Rotation, "value", *value)], scale)
                }
                LoadSpec::Traction {
                    along,
                    normal,
                    x,
                    y,
                    scale,
                } => {
                    let scale = factor(&at!["loads", k, "scale"], scale)?;
                    let load = tractions::Load {
                        along,
                        normal: *normal,
                        vector: [*x, *y],
                        round,
                    };
                    let here = at!["loads", k];
                    let forces = tractions::forces(&here, names, &load)?;
                    made.extend(self.acting(&here.then("along"), names, along, forces, &scale)?);
                    continue;
                }
                LoadSpec::Volume { on, x, y, scale } => {
                    let here = at!["loads", k];
                    let scale = factor(&here.then("scale"), scale)?;
                    let forces = volumes::forces(&here, names, bodies, on, [*x, *y])?;
                    let parts = self.acting(&here.then("on"), names, on, forces, &scale)?;
                    let volume = Some(k);
                    made.extend(parts.into_iter().map(|load| Load { volume, ..load }));
                    continue;
                }
                LoadSpec::Pressure {
                    along,
                    value,
                    scale,
                } => {
                    let here = at!["loads", k];
                    let scale = factor(&here.then("scale"), scale)?;
                    limits::finite(&here.then("value"), *value, "the pressure")?;
                    let here = here.then("along");
                    let pressed = pressures::faces(&here, names, bodies, along)?;
                    let forces = pressures::dead(names, &pressed.small, *value);
                    made.extend(self.acting(&here, names, along, forces, &scale)?);
                    if !pressed.following.is_empty() {
                        loads.pressures.push(Pressure {
                            faces: pressed.following,
                            expands: None,
                            value: *value,
                            scale,
                        });
                    }
                    continue;
                }
                LoadSpec::Expansion { on, strain, scale } => {
                    let here = at!["loads", k];
                    limits::finite(&here.then("strain"), *strain, "the strain")?;
                    let body = volumes::expanding(bodies, on).at(here.then("on"))?;
                    let scale = factor(&here.then("scale"), scale)?;
                    loads.pressures.push(Pressure {
                        faces: Vec::new(),
                        expands: Some(body),
                        value: *strain,
                        scale,
                    });
                    continue;
                }
                LoadSpec::Displacement { .. } => continue,
            };
            let here = at!["loads", k];
            let node = names.node(node).at(here.then("node"))?;
            let scale = factor(&here.then("scale"), scale)?;
            for (component, field, value) in parts {
                limits::finite(&here.then(field), value, "the load")?;
                let dof = self.loaded(&here, names, (node, component), (field, value))?;
                if value != 0.0 {
                    made.push(Load {
                        dof,
                        value,
                        scale: scale.clone(),
                        volume: None,
                    });
                }
            }
        }
        Ok(())
    }

    /// Nodal loads for the nodes of a name. Forces on restrained degrees of freedom go into the support and count in its
    /// reaction.
    fn acting(
        &self,
        here: &Path,
        names: &Names,
        on: &str,
        forces: Vec<(usize, [f64; 2])>,
        scale: &Factor,
    ) -> Result<Vec<Load>, Fault> {
        let fault = |message: String| Fault::new(here, message);
        if let Some((node, _)) = forces.iter().find(|(node, _)| !self.on_body[*node]) {
            let name = &names.nodes[*node].name;
            return Err(fault(format!(
                "node {name:?} belongs to no body, so a load there has no effect"
            )));
        }
        let mut made = Vec::new();
        for (node, force) in forces {
            for (k, value) in force.into_iter().enumerate().filter(|(_, v)| *v != 0.0) {
                made.push(Load {
                    dof: self.dofs.first[node] + k,
                    value,
                    scale: scale.clone(),
                    volume: None,
                });
            }
        }
        if !made.is_empty() && made.iter().all(|load| self.held.contains_key(&load.dof)) {
            return Err(fault(format!(
                "every node of {on:?} is restrained in the direction of this load, so it has no effect"
            )));
        }
        Ok(made)
    }

    fn prescribe(
        &mut self,
        here: &Path,
        names: &Names,
        node: usize,
        component: Component,
    ) -> Result<usize, Fault> {
        let fault = |message| Fault::new(here.then("component"), message);
        let dof = self.dof(names, node, component).map_err(fault)?;
        if let Some(other) = self.held.insert(dof, here.clone()) {
            let name = &names.nodes[node].name;
            return Err(fault(format!(
                "{component} of node {name:?} is already restrained by {other}"
            )));
        }
        Ok(dof)
    }

    /// The degree of freedom that a load acts on, if it is free.
    fn loaded(
        &self,
        here: &Path,
        names: &Names,
        (node, component): (usize, Component),
        (field, value): (&str, f64),
    ) -> Result<usize, Fault> {
        let name = &names.nodes[node].name;
        if !self.on_body[node] {
            bail!(
                here.then("node"),
                "node {name:?} belongs to no body, so a load there has no effect"
            );
        }
        let dof = self.dof(names, node, component).at(here.then("node"))?;
        match self.held.get(&dof) {
            Some(holder) if value != 0.0 => Err(fault!(
                here.then(field),
                "{component} of node {name:?} is restrained by {holder}, so a load there has no effect"
            )),
            _ => Ok(dof),
        }
    }

    /// Whether a component of a node is no unknown.
    pub(super) fn is_held(&self, node: usize, component: Component) -> bool {
        let dof = self.dofs.dof(node, component);
        !self.on_body[node] || dof.is_none_or(|dof| self.held.contains_key(&dof))
    }

    /// Whether a node can move along the axis across this one only, or belongs to no body.
    pub(super) fn is_guided(&self, node: usize, axis: Component) -> bool {
        let across = match axis {
            Component::X => Component::Y,
            _ => Component::X,
        };
        self.is_held(node, axis) && !(self.on_body[node] && self.is_held(node, across))
    }

    /// Numbers the equations node by node, followed by those of the bodies' internal unknowns.
    pub(super) fn number(mut self, bodies: &mut [Body]) -> Dofs {
        let is_free = |dof: usize| self.on_body[self.of[dof].0] && !self.held.contains_key(&dof);
        self.dofs.number(bodies, is_free);
        self.dofs
    }
}

/// Error for a node without a rotation.
pub(super) fn no_rotation(names: &Names, node: usize) -> String {
    format!(
        "node {:?} is not on a beam and has only x and y, no rotation",
        names.nodes[node].name
    )
}

/// Checks the amplitude of a load: its load factors must be ascending.
fn factor(here: &Path, scale: &[Point]) -> Result<Factor, Fault> {
    for (k, (x, y)) in scale.iter().enumerate() {
        let point = here.then(k);
        limits::finite(&point.then(0), *x, "the load factor")?;
        limits::finite(&point.then(1), *y, "the factor")?;
        if k > 0 && *x <= scale[k - 1].0 {
            bail!(
                point.then(0),
                "the load factors of a scale must be ascending; {x:?} follows {:?}",
                scale[k - 1].0
            );
        }
    }
    Ok(Factor(scale.to_vec()))
}
