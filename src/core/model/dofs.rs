//! Numbering of the degrees of freedom and of the unknowns among them.

use super::body::{Body, BodyKind, Form};
use crate::documented::documented;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Numbering of the degrees of freedom and of the unknowns among them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Dofs {
    /// First degree of freedom of each node.
    pub first: Vec<usize>,
    /// Number of degrees of freedom of each node: 2, or 3 on beams.
    pub count: Vec<u8>,
    /// Equation number of each degree of freedom; `None` if it is restrained or prescribed.
    pub equation: Vec<Option<usize>>,
    /// Number of equations.
    pub equations: usize,
    /// Number of internal unknowns of bodies; they belong to no node and come last.
    pub inner: usize,
}

impl Dofs {
    /// Degrees of freedom of this many nodes: three for each node on a beam, two for the others; no equations yet.
    pub fn new(nodes: usize, bodies: &[Body]) -> Self {
        let mut count = vec![2; nodes];
        for body in bodies {
            if matches!(body.kind, BodyKind::Beam(_)) {
                body.nodes.iter().for_each(|&node| count[node] = 3);
            }
        }
        let mut next = 0;
        let first = count.iter().map(|&count| {
            next += usize::from(count);
            next - usize::from(count)
        });
        Dofs {
            first: first.collect(),
            equation: vec![None; next],
            count,
            ..Dofs::default()
        }
    }

    /// Numbers the equations: the free degrees of freedom node by node, then the bodies' own unknowns, which it enters in the
    /// bodies.
    pub fn number(&mut self, bodies: &mut [Body], is_free: impl Fn(usize) -> bool) {
        for (dof, equation) in self.equation.iter_mut().enumerate() {
            *equation = is_free(dof).then_some(self.equations);
            self.equations += usize::from(equation.is_some());
        }
        for body in bodies {
            let first = self.equation.len();
            let count: usize = match &mut body.kind {
                BodyKind::Beam(beam) if beam.ga.is_none() => {
                    beam.first_shear = Some(first);
                    beam.elements.iter().map(|element| element.len() - 1).sum()
                }
                BodyKind::Linear(linear) if linear.form != Form::Stiffness => {
                    linear.form = Form::Compliance { first_force: first };
                    2 * body.nodes.len()
                }
                _ => 0,
            };
            let own = (0..count).map(|k| Some(self.equations + k));
            self.equation.extend(own);
            self.equations += count;
            self.inner += count;
        }
    }
    /// Number of degrees of freedom, restrained ones included.
    pub fn len(&self) -> usize {
        self.equation.len()
    }

    /// Whether there are no degrees of freedom.
    pub fn is_empty(&self) -> bool {
        self.equation.is_empty()
    }

    /// The degrees of freedom of a node.
    pub fn of_node(&self, node: usize) -> Range<usize> {
        let first = self.first[node];
        first..first + usize::from(self.count[node])
    }

    /// The node of a degree of freedom, and the number of its component there; `None` for internal unknowns of bodies.
    pub fn node_of(&self, dof: usize) -> Option<(usize, usize)> {
        let after = self.first.partition_point(|first| *first <= dof);
        let node = after.checked_sub(1)?;
        let component = dof - self.first[node];
        (component < usize::from(self.count[node])).then_some((node, component))
    }

    /// Number of a node's degree of freedom; `None` if the node has no such component.
    pub fn dof(&self, node: usize, component: Component) -> Option<usize> {
        let k = component as usize;
        (k < self.count[node] as usize).then(|| self.first[node] + k)
    }
}

documented! {
    /// A degree of freedom of a node. `Display` prints the word of the scene file.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Component {
        /// Displacement along x (length).
        X,
        /// Displacement along y (length).
        Y,
        /// Rotation, anticlockwise (radians).
        Rotation,
    }
}

impl std::fmt::Display for Component {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Component::X => "x",
            Component::Y => "y",
            Component::Rotation => "rotation",
        })
    }
}

documented! {
    /// A Cartesian axis.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Axis {
        /// The x axis.
        X,
        /// The y axis.
        Y,
    }
}
