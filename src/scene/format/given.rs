//! Parts of a mesh that is given node by node: elements, node sets and side sets.

use super::described::macros::described;
use stickslip_core::ElementKind;

described! {
    /// Elements of a given mesh with the same kind and part.
    pub struct Cells {
        /// Name of the part; several lists may use the same name.
        pub part: String,
        /// Other parts that also contain these elements. Default: none.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub also: Vec<String>,
        /// Kind of element.
        pub kind: ElementKind,
        /// Node labels of each element: the corners around it, then the midside nodes, starting on the side after the first
        /// corner, then the centre. Clockwise elements are reversed.
        pub nodes: Vec<Vec<usize>>,
    }
}

described! {
    /// A named set of nodes of a given mesh.
    pub struct NodeSet {
        /// Name; `ID.name` refers to all these nodes.
        pub name: String,
        /// Node labels.
        pub nodes: Vec<usize>,
    }
}

described! {
    /// A named set of element sides, or of lines that belong to no element, of a given mesh.
    pub struct SideSet {
        /// Name; `ID.name` can be used wherever a chain or an edge of a block can.
        pub name: String,
        /// Node labels of each side from start to end, with the nodes between them, if any. Sides of elements are sorted
        /// into walking order with the element on the left; their order here does not matter.
        pub sides: Vec<Vec<usize>>,
    }
}
