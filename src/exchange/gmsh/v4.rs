//! Entities, nodes and elements of version 4.1: block by block, each of one geometric entity.

use super::cursor::Cursor;
use super::elements::{RawCell, RawNode, kind};
use super::raw::Raw;
use crate::broken::Broken;

/// What each geometric entity is in: its physical groups.
pub(super) fn entities(cursor: &mut Cursor<'_>, raw: &mut Raw) -> Result<(), Broken> {
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = cursor.size("a number of entities")?;
    }
    for (dimension, count) in (0..).zip(counts) {
        for _ in 0..cursor.count(count, 4, "entities")? {
            let entity = cursor.int("the number of an entity")?;
            // Of a point its place, of others the box around it.
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

/// A count and so many numbers.
fn list(cursor: &mut Cursor<'_>, what: &str) -> Result<Vec<i64>, Broken> {
    let count = cursor.size("a count")?;
    let count = cursor.count(count, 1, "numbers")?;
    (0..count).map(|_| cursor.int(what)).collect()
}

/// How many blocks there are, and how many nodes or elements in all; their least and greatest numbers follow.
fn announced(
    cursor: &mut Cursor<'_>,
    numbers: usize,
    what: &str,
) -> Result<(usize, usize), Broken> {
    let blocks = cursor.size("the number of blocks")?;
    let blocks = cursor.count(blocks, 4, "blocks")?;
    let count = cursor.size("a count")?;
    let count = cursor.count(count, numbers, what)?;
    cursor.size("the least number")?;
    cursor.size("the greatest number")?;
    Ok((blocks, count))
}

/// The blocks of nodes: their numbers, then their coordinates, with those on their entity behind where they are parametric.
pub(super) fn nodes(cursor: &mut Cursor<'_>, raw: &mut Raw) -> Result<(), Broken> {
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
        let parametric = cursor.int("whether nodes are parametric")?;
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

/// The blocks of elements: number and nodes of each.
pub(super) fn elements(cursor: &mut Cursor<'_>, raw: &mut Raw) -> Result<(), Broken> {
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

/// How many a block has of those that are left.
fn within(cursor: &Cursor<'_>, alike: u64, left: usize, what: &str) -> Result<usize, Broken> {
    let alike = usize::try_from(alike).ok().filter(|alike| *alike <= left);
    alike.ok_or_else(|| {
        cursor.wrong(format!(
            "the block has more {what} than the {left} that are left of those announced"
        ))
    })
}

/// Refuses blocks that have fewer together than were announced.
fn whole(cursor: &Cursor<'_>, found: usize, count: usize, what: &str) -> Result<(), Broken> {
    match found == count {
        true => Ok(()),
        false => Err(cursor.wrong(format!(
            "the blocks have {found} {what}, and {count} were announced"
        ))),
    }
}
