//! Parts of a mesh that is given node by node: elements, sets of nodes, and sets of sides.

use super::described::macros::described;
use serde::{Deserialize, Serialize};
use stickslip_core::model::ElementKind;

described! {
    /// Elements of a given mesh that are of one kind and belong to one part.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct Cells {
        /// Name of the part; several lists may name the same one.
        pub part: String,
        /// Other parts to which these elements belong as well. Default: none.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub also: Vec<String>,
        /// What the elements are.
        pub kind: ElementKind,
        /// The labels of the nodes of each element: the corners around it, then the middles of the sides that start at
        /// them, then the middle. Whichever way round: an element that is given clockwise is turned.
        pub nodes: Vec<Vec<usize>>,
    }
}

described! {
    /// Nodes of a given mesh under a name.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct NodeSet {
        /// Its name; `ID.name` stands for all these nodes.
        pub name: String,
        /// Their labels.
        pub nodes: Vec<usize>,
    }
}

described! {
    /// Sides of elements of a given mesh, or lines that belong to no element, under a name.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct SideSet {
        /// Its name; `ID.name` can be used wherever a chain or the edge of a block can.
        pub name: String,
        /// The labels of the nodes of each side from its start to its end, the middle between them where it has one. Sides
        /// of elements are put in walking order, with the element on the left, whatever their order here.
        pub sides: Vec<Vec<usize>>,
    }
}
