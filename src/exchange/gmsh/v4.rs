//! Entities, nodes and elements of version 4.1: in blocks, each for one geometric entity.

use super::cursor::Cursor;
use super::elements::{RawCell, RawNode, kind};
use super::raw::TaggedMesh;
use crate::FormatError;

/// Reads the physical groups of each geometric entity.
pub(super) fn entities(cursor: &mut Cursor<'_>, raw: &mut TaggedMesh) -> Result<(), FormatError> {
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = cursor.size("a number of entities")?;
    }
    for (dimension, count) in (0..).zip(counts) {
        for _ in 0..cursor.count(count, 4, "entities")? {
            let entity = cursor.int("the number of an entity")?;
            // A point has its position, other entities a bounding box.
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                cursor.float("a coordinate of an entity")?;
            }
            for tag in list(cursor, "the number of a physical group")? {
                raw.groups.has(dimension, entity, tag);
            }
            if dimension > 0 {
                list(cursor, "the number of a bounding entity")?;
            }
        }
    }
    Ok(())
}

/// A count and that many numbers.
fn list(cursor: &mut Cursor<'_>, what: &str) -> Result<Vec<i64>, FormatError> {
    let count = cursor.size("a count")?;
    let count = cursor.count(count, 1, "numbers")?;
    (0..count).map(|_| cursor.int(what)).collect()
}

/// Number of blocks, and total number of nodes or elements; their smallest and largest numbers follow.
fn announced(
    cursor: &mut Cursor<'_>,
    numbers: usize,
    what: &str,
) -> Result<(usize, usize), FormatError> {
    let blocks = cursor.size("the number of blocks")?;
    let blocks = cursor.count(blocks, 4, "blocks")?;
    let count = cursor.size("a count")?;
    let count = cursor.count(count, numbers, what)?;
    cursor.size("the smallest number")?;
    cursor.size("the largest number")?;
    Ok((blocks, count))
}

/// Reads the blocks of nodes: their numbers, then their coordinates, followed by parameters on their entity if they are
/// parametric.
pub(super) fn nodes(cursor: &mut Cursor<'_>, raw: &mut TaggedMesh) -> Result<(), FormatError> {
    let (blocks, count) = announced(cursor, 4, "nodes")?;
    raw.nodes.reserve_exact(count);
    for _ in 0..blocks {
        let dimension = cursor.int("the dimension of an entity")?;
        if !(0..=3).contains(&dimension) {
            return Err(cursor.wrong(format!(
                "the dimension of an entity is {dimension}; it must be 0 to 3"
            )));
        }
        cursor.int("the number of an entity")?;
        let parametric = cursor.int("the flag for parametric nodes")?;
        let more = if parametric == 0 { 0 } else { dimension };
        let alike = cursor.size("a number of nodes")?;
        let alike = within(cursor, alike, count - raw.nodes.len(), "nodes")?;
        let first = raw.nodes.len();
        for _ in 0..alike {
            let tag = cursor.size("the number of a node")?;
            let byte = cursor.last();
            raw.nodes.push(RawNode {
                tag,
                at: [0.0; 3],
                byte,
            });
        }
        for node in &mut raw.nodes[first..] {
            for (x, what) in node
                .at
                .iter_mut()
                .zip(["x of a node", "y of a node", "z of a node"])
            {
                *x = cursor.float(what)?;
            }
            for _ in 0..more {
                cursor.float("a parameter of a node")?;
            }
        }
    }
    whole(cursor, raw.nodes.len(), count, "nodes")
}

/// Reads the blocks of elements: number and nodes of each.
pub(super) fn elements(cursor: &mut Cursor<'_>, raw: &mut TaggedMesh) -> Result<(), FormatError> {
    let (blocks, count) = announced(cursor, 2, "elements")?;
    raw.cells.reserve_exact(count);
    for _ in 0..blocks {
        cursor.int("the dimension of an entity")?;
        let entity = cursor.int("the number of an entity")?;
        let type_of = cursor.int("the type of elements")?;
        let kind = kind(type_of).map_err(|message| cursor.wrong(message))?;
        let alike = cursor.size("a number of elements")?;
        let alike = within(cursor, alike, count - raw.cells.len(), "elements")?;
        for _ in 0..alike {
            cursor.size("the number of an element")?;
            let byte = cursor.last();
            for _ in 0..kind.nodes() {
                let node = cursor.size("a node of an element")?;
                raw.tags.push(node);
            }
            raw.cells.push(RawCell {
                kind,
                entity,
                physical: None,
                byte,
            });
        }
    }
    whole(cursor, raw.cells.len(), count, "elements")
}

/// Size of a block, limited by the remaining total.
fn within(cursor: &Cursor<'_>, alike: u64, left: usize, what: &str) -> Result<usize, FormatError> {
    usize::try_from(alike)
        .ok()
        .filter(|alike| *alike <= left)
        .ok_or_else(|| {
            cursor.wrong(format!(
                "the block has more {what} than the {left} left of the declared total"
            ))
        })
}

/// Rejects blocks with fewer items than declared.
fn whole(cursor: &Cursor<'_>, found: usize, count: usize, what: &str) -> Result<(), FormatError> {
    if found == count {
        Ok(())
    } else {
        Err(cursor.wrong(format!(
            "the blocks have {found} {what}, but {count} were declared"
        )))
    }
}
