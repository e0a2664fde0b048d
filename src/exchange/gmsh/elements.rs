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
        4..=7 | 11..=14 | 17..=19 => {
            return Err(format!(
                "elements of type {number} are solids; only plane meshes are supported: mesh only the surfaces, with `gmsh -2`"
            ));
        }
        _ => {
            return Err(format!(
                "elements of type {number} are not supported, only those of first and second order; set Mesh.ElementOrder to 1 or 2"
            ));
        }
    })
}
