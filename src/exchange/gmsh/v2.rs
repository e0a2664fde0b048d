//! Nodes and elements of version 2.2: one by one, each element with its groups.

use super::cursor::{Cursor, CursorForm};
use super::elements::{RawCell, RawNode, kind};
use super::raw::TaggedMesh;
use crate::FormatError;

/// Reads `count`, then number, x, y, z of each node.
pub(super) fn nodes(cursor: &mut Cursor<'_>, raw: &mut TaggedMesh) -> Result<(), FormatError> {
    let count = announced(cursor, 4, "nodes")?;
    raw.nodes.reserve_exact(count);
    for _ in 0..count {
        let tag = tag(cursor, "the number of a node")?;
        let byte = cursor.last();
        let at = [
            cursor.float("x of a node")?,
            cursor.float("y of a node")?,
            cursor.float("z of a node")?,
        ];
        raw.nodes.push(RawNode { tag, at, byte });
    }
    Ok(())
}

/// Reads `count`, then number, type, tags and nodes of each element; in binary files, elements with the same type and number of
/// tags share a header.
pub(super) fn elements(cursor: &mut Cursor<'_>, raw: &mut TaggedMesh) -> Result<(), FormatError> {
    let count = announced(cursor, 3, "elements")?;
    raw.cells.reserve_exact(count);
    let mut left = count;
    while left > 0 {
        let mut first = None;
        if cursor.form == CursorForm::Text {
            cursor.int("the number of an element")?;
            first = Some(cursor.last());
        }
        let type_of = cursor.int("the type of an element")?;
        let kind = kind(type_of).map_err(|message| cursor.wrong(message))?;
        let alike = match first {
            Some(_) => 1,
            None => cursor.int("a number of elements")?,
        };
        let alike = usize::try_from(alike)
            .ok()
            .filter(|alike| (1..=left).contains(alike));
        let Some(alike) = alike else {
            return Err(cursor.wrong(format!(
                "{left} elements are left, so this must be 1 to {left}"
            )));
        };
        let tags = cursor.int("the number of tags of an element")?;
        let tags =
            u64::try_from(tags).map_err(|_| cursor.wrong("the number of tags is negative"))?;
        let tags = cursor.count(tags, 1, "tags")?;
        for _ in 0..alike {
            if first.is_none() {
                cursor.int("the number of an element")?;
            }
            let byte = first.unwrap_or(cursor.last());
            let (mut physical, mut entity) = (0, 0);
            for k in 0..tags {
                let value = cursor.int("a tag of an element")?;
                match k {
                    0 => physical = value,
                    1 => entity = value,
                    _ => {}
                }
            }
            for _ in 0..kind.nodes() {
                let node = tag(cursor, "a node of an element")?;
                raw.tags.push(node);
            }
            raw.cells.push(RawCell {
                kind,
                entity,
                physical: Some(physical),
                byte,
            });
        }
        left -= alike;
    }
    Ok(())
}

/// A count; text even in binary files.
fn announced(cursor: &mut Cursor<'_>, numbers: usize, what: &str) -> Result<usize, FormatError> {
    let count = cursor.number("a count", "a nonnegative whole number")?;
    let count = cursor.count(count, numbers, what)?;
    if cursor.form != CursorForm::Text {
        cursor.line();
    }
    Ok(count)
}

/// The number of a node or an element.
fn tag(cursor: &mut Cursor<'_>, what: &str) -> Result<u64, FormatError> {
    let value = cursor.int(what)?;
    u64::try_from(value)
        .map_err(|_| cursor.wrong(format!("{what} is {value}; it must not be negative")))
}
