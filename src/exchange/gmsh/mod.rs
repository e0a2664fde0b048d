//! Meshes of Gmsh: MSH files of version 2.2 and 4.1, text and binary.
//!
//! A file is a row of sections, `$Nodes` to `$EndNodes`; those that no mesh needs (`$Periodic`, `$NodeData`, …) are skipped.
//! The format is that of the reference manual of Gmsh, "MSH file format". Gmsh numbers the nodes of an element as we do: the
//! corners, then the middles of the sides that start at them, then the middle. Nodes and cells are named by tags, which need
//! neither be dense nor in order.
//!
//! Physical groups become [`Group`](crate::mesh::Group)s; one without a name is called after its dimension and number, `surface2`. A file
//! without any groups has one for each geometric entity, by the same rule. Coordinates must lie in a plane z = const.
//!
//! The reader is our own: of the crates there are, mshio reads version 4.1 only and has had no release since 2020, and it takes
//! memory as a file's counts claim.

mod cursor;
mod groups;
mod sections;
mod v2;
mod v4;

use crate::broken::Broken;
use crate::mesh::{Cell, CellKind, Mesh};
use cursor::Cursor;
use groups::Groups;

/// What a file is to begin with.
const HEAD: &[u8] = b"$MeshFormat";
/// Nodes are in one plane if their z differ by no more than this part of what they measure in x and y.
const FLAT: f64 = 1e-9;

/// Whether a file says that it is one of Gmsh.
pub fn is_one(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(HEAD)
}

/// Reads a mesh.
///
/// # Errors
/// If the file is none of Gmsh, broken, of another version, or has cells that are not of the plane or of third order; in text
/// with line and column, in a binary file with the number of the byte.
pub fn read(bytes: &[u8]) -> Result<Mesh, Broken> {
    let mut cursor = Cursor::new(bytes);
    let raw = sections::read(&mut cursor)?;
    raw.mesh(&cursor)
}

/// What stands in a file, by its own tags.
#[derive(Default)]
struct Raw {
    nodes: Vec<RawNode>,
    cells: Vec<RawCell>,
    /// Tags of the nodes of all cells, one cell after the other.
    tags: Vec<u64>,
    groups: Groups,
}

struct RawNode {
    tag: u64,
    at: [f64; 3],
    /// Where it stands in the file.
    byte: usize,
}

struct RawCell {
    kind: CellKind,
    /// Geometric entity, of the cell's own dimension.
    entity: i64,
    /// Physical group where the cell itself names it, 0 for none; else that of its entity.
    physical: Option<i64>,
    byte: usize,
}

impl Raw {
    fn mesh(self, cursor: &Cursor<'_>) -> Result<Mesh, Broken> {
        if self.cells.is_empty() {
            let message =
                "the file has no elements; a mesh is made first, by `gmsh -2` or Mesh > 2D";
            return Err(Broken::whole(message));
        }
        let index = self.index(cursor)?;
        let mut cells = Vec::with_capacity(self.cells.len());
        let mut tags = self.tags.as_slice();
        for cell in &self.cells {
            let (own, rest) = tags.split_at(cell.kind.nodes());
            tags = rest;
            let place = |tag: &u64| {
                place(&index, *tag).ok_or_else(|| {
                    cursor.fault(
                        cell.byte,
                        format!("the element names node {tag}, which the file does not have"),
                    )
                })
            };
            cells.push(Cell {
                kind: cell.kind,
                nodes: own.iter().map(place).collect::<Result<_, _>>()?,
            });
        }
        self.check_flat(&cells, cursor)?;
        let (cells, groups) = self.groups.of_cells(&self.cells, cells);
        Ok(Mesh {
            nodes: self
                .nodes
                .iter()
                .map(|node| [node.at[0], node.at[1]])
                .collect(),
            labels: self.nodes.iter().map(|node| node.tag).collect(),
            cells,
            groups,
        })
    }

    /// Tags of the nodes with their positions, ascending.
    fn index(&self, cursor: &Cursor<'_>) -> Result<Vec<(u64, usize)>, Broken> {
        let tags = self.nodes.iter().enumerate();
        let mut index: Vec<(u64, usize)> = tags.map(|(k, node)| (node.tag, k)).collect();
        index.sort_unstable();
        match index.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => {
                let node = &self.nodes[pair[1].1];
                Err(cursor.fault(
                    node.byte,
                    format!("node {} stands in the file twice", node.tag),
                ))
            }
            None => Ok(index),
        }
    }

    /// Refuses nodes of cells that do not lie in one plane z = const.
    fn check_flat(&self, cells: &[Cell], cursor: &Cursor<'_>) -> Result<(), Broken> {
        let used = || {
            cells
                .iter()
                .flat_map(|cell| &cell.nodes)
                .map(|&n| &self.nodes[n])
        };
        let Some(first) = used().next() else {
            return Ok(());
        };
        let far = |axis: usize| {
            used()
                .map(|n| (n.at[axis] - first.at[axis]).abs())
                .fold(0.0, f64::max)
        };
        let allowed = FLAT * far(0).max(far(1));
        let Some(other) = used().find(|node| (node.at[2] - first.at[2]).abs() > allowed) else {
            return Ok(());
        };
        let message = format!(
            "the mesh is not plane: node {} is at z = {:?} and node {} at z = {:?}; draw it in the x-y plane",
            other.tag, other.at[2], first.tag, first.at[2]
        );
        Err(cursor.fault(other.byte, message))
    }
}

/// Position of a node by its tag.
fn place(index: &[(u64, usize)], tag: u64) -> Option<usize> {
    // Tags without gaps, which are the rule, are found at once.
    let guess = index.first().and_then(|(first, _)| tag.checked_sub(*first));
    let guess = guess.and_then(|far| index.get(usize::try_from(far).ok()?));
    if let Some((_, place)) = guess.filter(|(found, _)| *found == tag) {
        return Some(*place);
    }
    let found = index.binary_search_by_key(&tag, |(tag, _)| *tag).ok()?;
    Some(index[found].1)
}

/// The kind of cell that a number of Gmsh stands for.
fn kind(number: i64) -> Result<CellKind, String> {
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

#[cfg(test)]
mod tests;
