//! The mesh data of a file, identified by the file's tags, and its conversion to a mesh.

use super::cursor::Cursor;
use super::elements::{RawCell, RawNode};
use super::groups::Groups;
use crate::FormatError;
use crate::mesh::{Cell, Mesh};

/// Nodes are in one plane if their z differ by at most this fraction of the extent in x and y.
const FLAT: f64 = 1e-9;

/// Contents of a file, identified by its tags.
#[derive(Default)]
pub(super) struct TaggedMesh {
    pub nodes: Vec<RawNode>,
    pub cells: Vec<RawCell>,
    /// Node tags of all cells, in sequence.
    pub tags: Vec<u64>,
    pub groups: Groups,
}

impl TaggedMesh {
    /// The mesh, if its nodes exist and lie in a plane.
    pub fn mesh(self, cursor: &Cursor<'_>) -> Result<Mesh, FormatError> {
        if self.cells.is_empty() {
            let message =
                "the file has no elements; generate a mesh first, with `gmsh -2` or Mesh > 2D";
            return Err(FormatError::whole(message));
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
                        format!("the element refers to node {tag}, which is not in the file"),
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

    /// Tags of the nodes with their indices, ascending.
    fn index(&self, cursor: &Cursor<'_>) -> Result<Vec<(u64, usize)>, FormatError> {
        let mut index: Vec<(u64, usize)> = self
            .nodes
            .iter()
            .enumerate()
            .map(|(k, node)| (node.tag, k))
            .collect();
        index.sort_unstable();
        match index.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => {
                let node = &self.nodes[pair[1].1];
                Err(cursor.fault(
                    node.byte,
                    format!("node {} occurs twice in the file", node.tag),
                ))
            }
            None => Ok(index),
        }
    }

    /// Rejects cells whose nodes do not lie in one plane z = const.
    fn check_flat(&self, cells: &[Cell], cursor: &Cursor<'_>) -> Result<(), FormatError> {
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

/// Index of a node by its tag.
fn place(index: &[(u64, usize)], tag: u64) -> Option<usize> {
    // Fast path for consecutive tags, the usual case.
    let guess = index
        .first()
        .and_then(|(first, _)| tag.checked_sub(*first))
        .and_then(|far| index.get(usize::try_from(far).ok()?));
    if let Some((_, place)) = guess.filter(|(found, _)| *found == tag) {
        return Some(*place);
    }
    let found = index.binary_search_by_key(&tag, |(tag, _)| *tag).ok()?;
    Some(index[found].1)
}
