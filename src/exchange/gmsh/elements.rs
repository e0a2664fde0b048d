//! Nodes and elements as stored in a file, and Gmsh's numbers of element kinds.

use crate::mesh::CellKind;

/// A node.
pub(super) struct RawNode {
    pub tag: u64,
    pub at: [f64; 3],
    /// Byte offset in the file.
    pub byte: usize,
}

/// An element.
pub(super) struct RawCell {
    pub kind: CellKind,
    /// Geometric entity of the cell's dimension.
    pub entity: i64,
    /// Physical group if given for the cell itself, 0 for none; otherwise that of its entity.
    pub physical: Option<i64>,
    pub byte: usize,
}

/// The cell kind for a number of Gmsh.
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

/// Error for an unsupported element kind.
fn refused(number: i64) -> String {
    let order =
        "only first- and second-order elements are supported; set Mesh.ElementOrder to 1 or 2";
    let plane = "only plane meshes are supported; mesh only the surfaces, with `gmsh -2`";
    let (what, right) = match number {
        4 => ("a 4-node tetrahedron", plane),
        5 => ("an 8-node hexahedron", plane),
        6 => ("a 6-node prism", plane),
        7 => ("a 5-node pyramid", plane),
        11 => ("a 10-node tetrahedron", plane),
        12 => ("a 27-node hexahedron", plane),
        13 => ("an 18-node prism", plane),
        14 => ("a 14-node pyramid", plane),
        17 => ("a 20-node hexahedron", plane),
        18 => ("a 15-node prism", plane),
        19 => ("a 13-node pyramid", plane),
        20 => ("a 9-node triangle", order),
        21 => ("a 10-node triangle", order),
        22 => ("a 12-node triangle", order),
        23 | 24 => ("a 15-node triangle", order),
        25 => ("a 21-node triangle", order),
        26 => ("a 4-node line", order),
        27 => ("a 5-node line", order),
        28 => ("a 6-node line", order),
        36 => ("a 16-node quadrilateral", order),
        37 => ("a 25-node quadrilateral", order),
        39 => ("a 12-node quadrilateral", order),
        other => {
            return format!("elements of type {other} are not supported: {order}, and plane");
        }
    };
    format!("the element is {what}; {right}")
}
