//! Numbering of the degrees of freedom and of the unknowns among them.

use super::documented::documented;
use serde::{Deserialize, Serialize};

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
    /// Number of degrees of freedom, including restrained ones.
    pub fn len(&self) -> usize {
        self.equation.len()
    }

    /// Whether there are no degrees of freedom.
    pub fn is_empty(&self) -> bool {
        self.equation.is_empty()
    }

    /// Number of a node's degree of freedom; `None` if the node has no such component.
    pub fn dof(&self, node: usize, component: Component) -> Option<usize> {
        let k = component as usize;
        (k < self.count[node] as usize).then(|| self.first[node] + k)
    }
}

documented! {
    /// A degree of freedom of a node. `Display` prints the word of the scene file.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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
