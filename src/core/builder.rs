//! Builds a [`Model`] in code, without a scene file.

use crate::model::{
    Body, BodyKind, Component, Contact, Dofs, Factor, Load, Monitor, Node, Prescribed, Surface,
    diagonal,
};
use crate::words::counted;
use crate::{Model, Settings};
use std::collections::BTreeSet;

/// A [`Model`] in the making: the methods that add something return its number.
///
/// The history is one increment from load factor 0 to 1, with default settings, unless it is set.
#[derive(Debug, Clone)]
pub struct ModelBuilder {
    model: Model,
    fixed: BTreeSet<(usize, Component)>,
    loads: Vec<(usize, Component, f64)>,
    motions: Vec<(usize, Component, f64)>,
}

/// Why a model cannot be built.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A node number without a node.
    #[error("{what} refers to node {node}; the model has {}", counted(*count, "node"))]
    NoNode {
        /// What refers to it.
        what: String,
        /// The number.
        node: usize,
        /// Number of nodes.
        count: usize,
    },
    /// A contact with a surface that does not exist.
    #[error("contact {contact} refers to surface {surface}, and there are {count} surfaces")]
    NoSurface {
        /// The contact.
        contact: usize,
        /// The number.
        surface: usize,
        /// Number of surfaces.
        count: usize,
    },
    /// A support, load or motion of a component that the node does not have.
    #[error("node {node} has no {component}: only nodes of beams have a rotation")]
    NoComponent {
        /// The node.
        node: usize,
        /// The component.
        component: Component,
    },
    /// A load on a node that is on no body.
    #[error("node {node} is on no body, so a load there has no effect")]
    NoBody {
        /// The node.
        node: usize,
    },
    /// The corners of the path or the increment.
    #[error("the path needs at least two finite load factors, and the increment must be positive")]
    History,
    /// All nodes are in one place.
    #[error("all nodes are in one place, so the model has no size to compare lengths with")]
    NoSize,
}

impl Model {
    /// Starts a model with a title.
    pub fn builder(title: &str) -> ModelBuilder {
        ModelBuilder {
            model: Model::from_contacts(title, Vec::new(), Vec::new(), Vec::new()),
            fixed: BTreeSet::new(),
            loads: Vec::new(),
            motions: Vec::new(),
        }
    }
}

impl ModelBuilder {
    /// Adds a node at a position (length).
    pub fn node(&mut self, name: &str, at: [f64; 2]) -> usize {
        let name = name.to_owned();
        self.model.nodes.push(Node { name, at });
        self.model.nodes.len() - 1
    }

    /// Adds a body on these nodes.
    pub fn body(&mut self, name: &str, nodes: Vec<usize>, kind: BodyKind) -> usize {
        let name = name.to_owned();
        self.model.bodies.push(Body { name, nodes, kind });
        self.model.bodies.len() - 1
    }

    /// Adds a master surface.
    pub fn surface(&mut self, surface: Surface) -> usize {
        self.model.surfaces.push(surface);
        self.model.surfaces.len() - 1
    }

    /// Adds a slave node with the surfaces that it may touch.
    pub fn contact(&mut self, contact: Contact) -> usize {
        self.model.contacts.push(contact);
        self.model.contacts.len() - 1
    }

    /// Adds a number to report.
    pub fn monitor(&mut self, monitor: Monitor) -> usize {
        self.model.monitors.push(monitor);
        self.model.monitors.len() - 1
    }

    /// Holds a component of a node at zero.
    pub fn fix(&mut self, node: usize, component: Component) -> &mut Self {
        self.fixed.insert((node, component));
        self
    }

    /// Adds a force (or moment) at load factor 1.
    pub fn load(&mut self, node: usize, component: Component, value: f64) -> &mut Self {
        self.loads.push((node, component, value));
        self
    }

    /// Prescribes a displacement (or rotation) at load factor 1.
    pub fn prescribe(&mut self, node: usize, component: Component, value: f64) -> &mut Self {
        self.motions.push((node, component, value));
        self
    }

    /// Sets the corners of the path of the load factor, and the increment.
    pub fn history(&mut self, path: Vec<f64>, increment: f64) -> &mut Self {
        (self.model.path, self.model.increment) = (path, increment);
        self
    }

    /// Sets the choices of the method.
    pub fn settings(&mut self, settings: Settings) -> &mut Self {
        self.model.settings = settings;
        self
    }

    /// The model, checked, with its degrees of freedom numbered.
    ///
    /// # Errors
    /// [`ModelError`].
    pub fn build(self) -> Result<Model, ModelError> {
        let ModelBuilder {
            mut model,
            fixed,
            loads,
            motions,
        } = self;
        check(&model)?;
        let on_body: BTreeSet<usize> = model
            .bodies
            .iter()
            .flat_map(|b| &b.nodes)
            .copied()
            .collect();
        let mut dofs = Dofs::new(model.nodes.len(), &model.bodies);
        let dof = |(node, component): (usize, Component)| {
            if node >= model.nodes.len() {
                return Err(no_node("a support or load", node, model.nodes.len()));
            }
            let missing = ModelError::NoComponent { node, component };
            dofs.dof(node, component).ok_or(missing)
        };
        let mut held = BTreeSet::new();
        for at in fixed {
            held.insert(dof(at)?);
        }
        for (node, component, value) in motions {
            let dof = dof((node, component))?;
            held.insert(dof);
            model.prescribed.push(Prescribed {
                dof,
                value,
                scale: Factor::default(),
            });
        }
        for (node, component, value) in loads {
            if !on_body.contains(&node) {
                return Err(ModelError::NoBody { node });
            }
            model.loads.push(Load {
                dof: dof((node, component))?,
                value,
                scale: Factor::default(),
                volume: None,
            });
        }
        let mut is_on_body = vec![false; dofs.equation.len()];
        for &node in &on_body {
            is_on_body[dofs.of_node(node)].fill(true);
        }
        dofs.number(&mut model.bodies, |dof| {
            is_on_body[dof] && !held.contains(&dof)
        });
        model.dofs = dofs;
        let all = || diagonal(model.nodes.iter());
        model.length = match diagonal(on_body.iter().map(|&node| &model.nodes[node])) {
            length if length > 0.0 => length,
            _ => all(),
        };
        if model.length > 0.0 {
            Ok(model)
        } else {
            Err(ModelError::NoSize)
        }
    }
}

fn no_node(what: impl Into<String>, node: usize, count: usize) -> ModelError {
    ModelError::NoNode {
        what: what.into(),
        node,
        count,
    }
}

fn check(model: &Model) -> Result<(), ModelError> {
    let count = model.nodes.len();
    let exist = |what: String, nodes: &[usize]| match nodes.iter().find(|&&node| node >= count) {
        Some(&node) => Err(no_node(what, node, count)),
        None => Ok(()),
    };
    for body in &model.bodies {
        exist(format!("body {:?}", body.name), &body.nodes)?;
    }
    for surface in &model.surfaces {
        for element in &surface.elements {
            exist(format!("surface {:?}", surface.name), element)?;
        }
    }
    for (k, contact) in model.contacts.iter().enumerate() {
        let carriers: Vec<usize> = contact.carriers().map(|(node, _)| node).collect();
        exist(format!("contact {k}"), &[contact.node])?;
        exist(format!("contact {k}"), &carriers)?;
        let surfaces = model.surfaces.len();
        if let Some(&surface) = contact
            .surfaces
            .iter()
            .find(|&&surface| surface >= surfaces)
        {
            return Err(ModelError::NoSurface {
                contact: k,
                surface,
                count: surfaces,
            });
        }
    }
    let moves = model.path.len() > 1 && model.path.iter().all(|load| load.is_finite());
    if moves && model.increment > 0.0 && model.increment.is_finite() {
        Ok(())
    } else {
        Err(ModelError::History)
    }
}
