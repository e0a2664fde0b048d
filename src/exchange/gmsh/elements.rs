//! Nodes and elements as they stand in a file, and the kinds of elements by Gmsh's numbers.

use crate::mesh::CellKind;

/// A node.
pub(super) struct RawNode {
    pub tag: u64,
    pub at: [f64; 3],
    /// Where it stands in the file.
    pub byte: usize,
}

/// An element.
pub(super) struct RawCell {
    pub kind: CellKind,
    /// Geometric entity, of the cell's own dimension.
    pub entity: i64,
    /// Physical group where the cell itself names it, 0 for none; else that of its entity.
    pub physical: Option<i64>,
    pub byte: usize,
}

/// The kind of cell that a number of Gmsh stands for.
pub(super) fn kind(number: i64) -> Result<CellKind, String> {
    Ok(match number {
        1 => CellKind::Line2,
        2 => CellKind::Triangle3,
        3 => CellKind::Quad4,
        8 => CellKind::Line3,
        9 => CellKind::Triangle6,
        10 => CellKind::Quad9,
        15 => CellKind::Point,
        16 => CellKind::Quad8,
        other => return Err(refused(other)),
    })
}

/// Why elements of another kind are not read.
fn refused(number: i64) -> String {
    let order = "elements of first and second order are read; set Mesh.ElementOrder to 1 or 2";
    let plane = "only plane meshes are read; mesh the surfaces alone, by `gmsh -2`";
    let (what, right) = match number {
        4 => ("a tetrahedron of 4 nodes", plane),
        5 => ("a hexahedron of 8 nodes", plane),
        6 => ("a prism of 6 nodes", plane),
        7 => ("a pyramid of 5 nodes", plane),
        11 => ("a tetrahedron of 10 nodes", plane),
        12 => ("a hexahedron of 27 nodes", plane),
        13 => ("a prism of 18 nodes", plane),
        14 => ("a pyramid of 14 nodes", plane),
        17 => ("a hexahedron of 20 nodes", plane),
        18 => ("a prism of 15 nodes", plane),
        19 => ("a pyramid of 13 nodes", plane),
        20 => ("a triangle of 9 nodes", order),
        21 => ("a triangle of 10 nodes", order),
        22 => ("a triangle of 12 nodes", order),
        23 | 24 => ("a triangle of 15 nodes", order),
        25 => ("a triangle of 21 nodes", order),
        26 => ("a line of 4 nodes", order),
        27 => ("a line of 5 nodes", order),
        28 => ("a line of 6 nodes", order),
        36 => ("a quadrilateral of 16 nodes", order),
        37 => ("a quadrilateral of 25 nodes", order),
        39 => ("a quadrilateral of 12 nodes", order),
        other => {
            return format!("elements of type {other} are not read: {order}, and in the plane");
        }
    };
    format!("the element is {what}; {right}")
}
