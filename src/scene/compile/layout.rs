//! Degrees of freedom: which there are, what holds them, what loads them, and the numbers of the rest.

use super::super::limits;
use super::super::nodes::Names;
use super::{pressures, tractions, volumes};
use crate::format::error::{Fault, Path, at};
use crate::format::spec::{LoadSpec, Point, Spec};
use std::collections::HashMap;
use stickslip_core::model::Component;
use stickslip_core::model::{Body, Dofs, Factor, Load, Prescribed, Pressure};

/// What the loads of a scene make of a model's degrees of freedom.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Loads {
    /// Loads that stay as they are.
    pub dead: Vec<Load>,
    /// Pressures that follow their faces.
    pub pressures: Vec<Pressure>,
    /// Motions.
    pub prescribed: Vec<Prescribed>,
}

/// The degrees of freedom while it is found out which are held, and by what.
pub(super) struct Layout {
    dofs: Dofs,
    /// Node and component of each degree of freedom.
    of: Vec<(usize, Component)>,
    on_body: Vec<bool>,
    held: HashMap<usize, Path>,
}

const COMPONENTS: [Component; 3] = [Component::X, Component::Y, Component::Rotation];

impl Layout {
    /// Three degrees of freedom for each node on a beam, two for the others; nothing held yet.
    pub(super) fn new(on_body: Vec<bool>, bodies: &[Body]) -> Self {
        let dofs = Dofs::new(on_body.len(), bodies);
        let components = |(node, &count): (usize, &u8)| {
            let held = COMPONENTS.iter().take(count.into());
            held.map(move |component| (node, *component))
        };
        let of = dofs.count.iter().enumerate().flat_map(components).collect();
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

    /// Holds what the supports name.
    pub(super) fn supports(&mut self, spec: &Spec, names: &Names) -> Result<(), Fault> {
        for (k, support) in spec.supports.iter().enumerate() {
            let here = at!["supports", k];
            let nodes = names
                .nodes(&support.node)
                .map_err(|m| Fault::new(here.then("node"), m))?;
            if support.fix.is_empty() {
                let message = "the list is empty; it must hold some of x, y, rotation";
                return Err(Fault::new(here.then("fix"), message));
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

    /// Loads and prescribed displacements.
    pub(super) fn loads(
        &mut self,
        spec: &Spec,
        names: &Names,
        bodies: &[Body],
    ) -> Result<Loads, Fault> {
        // Prescribed displacements first: a force on one of them acts on nothing.
        let mut loads = Loads {
            prescribed: self.prescribed(spec, names)?,
            ..Loads::default()
        };
        self.forces(spec, names, bodies, &mut loads)?;
        Ok(loads)
    }

    fn prescribed(&mut self, spec: &Spec, names: &Names) -> Result<Vec<Prescribed>, Fault> {
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
            for node in names
                .nodes(node)
                .map_err(|m| Fault::new(here.then("node"), m))?
            {
                let dof = self.prescribe(&here, names, node, *component)?;
                // What is held at zero is simply restrained.
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
                    made.extend(self.acting(&here.then("on"), names, on, forces, &scale)?);
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
                            value: *value,
                            scale,
                        });
                    }
                    continue;
                }
                LoadSpec::Displacement { .. } => continue,
            };
            let here = at!["loads", k];
            let node = names
                .node(node)
                .map_err(|m| Fault::new(here.then("node"), m))?;
            let scale = factor(&here.then("scale"), scale)?;
            for (component, field, value) in parts {
                limits::finite(&here.then(field), value, "the load")?;
                let dof = self.loaded(&here, names, (node, component), (field, value))?;
                if value != 0.0 {
                    made.push(Load {
                        dof,
                        value,
                        scale: scale.clone(),
                    });
                }
            }
        }
        Ok(())
    }

    /// Loads of forces at the nodes of what has a name. What falls on a held degree of freedom goes into the support, where
    /// it counts for the reaction.
    fn acting(
        &self,
        here: &Path,
        names: &Names,
        on: &str,
        forces: Vec<(usize, [f64; 2])>,
        scale: &Factor,
    ) -> Result<Vec<Load>, Fault> {
        let fault = |message: String| Fault::new(here.clone(), message);
        if let Some((node, _)) = forces.iter().find(|(node, _)| !self.on_body[*node]) {
            let name = &names.nodes[*node].name;
            return Err(fault(format!(
                "node {name:?} is on no body; a load there would act on nothing"
            )));
        }
        let mut made = Vec::new();
        for (node, force) in forces {
            for (k, value) in force.into_iter().enumerate().filter(|(_, v)| *v != 0.0) {
                made.push(Load {
                    dof: self.dofs.first[node] + k,
                    value,
                    scale: scale.clone(),
                });
            }
        }
        if !made.is_empty() && made.iter().all(|load| self.held.contains_key(&load.dof)) {
            return Err(fault(format!(
                "every node of {on:?} is held where this load acts; it does nothing"
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
                "{component} of node {name:?} is held by {other} already"
            )));
        }
        Ok(dof)
    }

    /// The degree of freedom on which a load acts, if it can act there.
    fn loaded(
        &self,
        here: &Path,
        names: &Names,
        (node, component): (usize, Component),
        (field, value): (&str, f64),
    ) -> Result<usize, Fault> {
        let name = &names.nodes[node].name;
        if !self.on_body[node] {
            let message = format!("node {name:?} is on no body; a load there would act on nothing");
            return Err(Fault::new(here.then("node"), message));
        }
        let dof = self
            .dof(names, node, component)
            .map_err(|m| Fault::new(here.then("node"), m))?;
        match self.held.get(&dof) {
            Some(holder) if value != 0.0 => {
                let message = format!(
                    "{component} of node {name:?} is held by {holder}; a load there does nothing"
                );
                Err(Fault::new(here.then(field), message))
            }
            _ => Ok(dof),
        }
    }

    /// Numbers the equations.
    pub(super) fn number(mut self, bodies: &mut [Body]) -> Dofs {
        let is_free = |dof: usize| self.on_body[self.of[dof].0] && !self.held.contains_key(&dof);
        self.dofs.number(bodies, is_free);
        self.dofs
    }
}

/// What to say of a node that is asked for its rotation and has none.
pub(super) fn no_rotation(names: &Names, node: usize) -> String {
    format!(
        "node {:?} is on no beam and has no rotation, only x and y",
        names.nodes[node].name
    )
}

/// A scale of a load, its load factors rising.
fn factor(here: &Path, scale: &[Point]) -> Result<Factor, Fault> {
    for (k, (x, y)) in scale.iter().enumerate() {
        let point = here.then(k);
        limits::finite(&point.then(0), *x, "the load factor")?;
        limits::finite(&point.then(1), *y, "the own factor")?;
        if k > 0 && *x <= scale[k - 1].0 {
            return Err(Fault::new(
                point.then(0),
                format!(
                    "the load factors of a scale must rise; {x:?} follows {:?}",
                    scale[k - 1].0
                ),
            ));
        }
    }
    Ok(Factor(scale.to_vec()))
}
