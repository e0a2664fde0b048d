//! The sections of a file of any version.

use super::cursor::{Cursor, CursorForm};
use super::raw::TaggedMesh;
use super::{v2, v4};
use crate::FormatError;

/// Required start of a file.
pub(super) const HEAD: &[u8] = b"$MeshFormat";

/// Versions with different sections.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    Two,
    Four,
}

/// Reads all sections that a mesh needs.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<TaggedMesh, FormatError> {
    if cursor.word() != Some(HEAD) {
        let message = "a Gmsh mesh must begin with $MeshFormat";
        return Err(cursor.wrong(message));
    }
    let version = head(cursor)?;
    let mut raw = TaggedMesh::default();
    let mut seen: Vec<&[u8]> = Vec::new();
    while let Some(word) = cursor.word() {
        let Some(name) = word.strip_prefix(b"$").filter(|name| !name.is_empty()) else {
            let shown: String = String::from_utf8_lossy(word).chars().take(40).collect();
            return Err(cursor.wrong(format!(
                "found {shown:?} where a section, e.g. $Nodes, was expected"
            )));
        };
        let begin = cursor.last();
        cursor.line();
        let reader: fn(&mut Cursor<'_>, &mut TaggedMesh) -> Result<(), FormatError> = match (
            name, version,
        ) {
            (b"PhysicalNames", _) => names,
            (b"Entities", Version::Four) => v4::entities,
            (b"Nodes", Version::Two) => v2::nodes,
            (b"Nodes", Version::Four) => v4::nodes,
            (b"Elements", Version::Two) => v2::elements,
            (b"Elements", Version::Four) => v4::elements,
            (b"PartitionedEntities", _) => {
                let message = "the mesh is partitioned; save it unpartitioned, with Mesh.PartitionCreateTopology = 0";
                return Err(cursor.fault(begin, message));
            }
            _ => {
                let end = [b"$End", name].concat();
                if !cursor.skip_to(&end) {
                    return Err(cursor.fault(
                        begin,
                        format!("the section does not end: {} is missing", shown(&end)),
                    ));
                }
                continue;
            }
        };
        if seen.contains(&name) {
            return Err(cursor.fault(begin, format!("duplicate section ${}", shown(name))));
        }
        seen.push(name);
        reader(cursor, &mut raw)?;
        end(cursor, name)?;
    }
    for needed in [&b"Nodes"[..], b"Elements"] {
        if !seen.contains(&needed) {
            return Err(FormatError::whole(format!(
                "the file has no section ${}",
                shown(needed)
            )));
        }
    }
    Ok(raw)
}

fn shown(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).chars().take(40).collect()
}

/// Reads the end of a section.
fn end(cursor: &mut Cursor<'_>, name: &[u8]) -> Result<(), FormatError> {
    let wanted = [b"$End", name].concat();
    match cursor.word() {
        Some(word) if word == wanted => Ok(()),
        Some(word) => {
            let message = format!(
                "found {:?} where {} was expected",
                shown(word),
                shown(&wanted)
            );
            Err(cursor.wrong(message))
        }
        None => Err(cursor.wrong(format!("the file ends before {}", shown(&wanted)))),
    }
}

/// Reads version and number format.
fn head(cursor: &mut Cursor<'_>) -> Result<Version, FormatError> {
    let version: f64 = cursor.number("the version", "4.1 or 2.2")?;
    let known = match version {
        v if (2.0..3.0).contains(&v) => Version::Two,
        4.1 => Version::Four,
        other => {
            let message = format!(
                "version {other} of the format is not supported; convert the file to 4.1 with `gmsh FILE -save -format msh41`, or to 2.2"
            );
            return Err(cursor.wrong(message));
        }
    };
    let binary: u8 = cursor.number("the number format", "0 (text) or 1 (binary)")?;
    if binary > 1 {
        return Err(cursor.wrong("the number format must be 0 (text) or 1 (binary)"));
    }
    let size: u8 = cursor.number("the size of a number", "8")?;
    if binary == 1 {
        if size != 8 {
            return Err(cursor.wrong(format!("numbers of {size} bytes are not supported, only 8")));
        }
        cursor.line();
        cursor.form = CursorForm::Binary { big: false };
        let one = cursor.int("the number 1")?;
        match one {
            1 => {}
            // The bytes of 1 in reverse order.
            0x0100_0000 => cursor.form = CursorForm::Binary { big: true },
            _ => {
                return Err(cursor.wrong("the byte-order mark is not 1 in either byte order"));
            }
        }
    }
    end(cursor, b"MeshFormat")?;
    Ok(known)
}

/// Names of physical groups; text even in binary files.
fn names(cursor: &mut Cursor<'_>, raw: &mut TaggedMesh) -> Result<(), FormatError> {
    let count: u64 = cursor.number("the number of physical names", "a whole number")?;
    for _ in 0..count {
        let dimension: u8 = cursor.number("the dimension of a physical group", "0 to 3")?;
        let tag: i64 = cursor.number("the number of a physical group", "a whole number")?;
        let line = cursor.line().trim_ascii();
        let quoted = line
            .strip_prefix(b"\"")
            .and_then(|rest| rest.strip_suffix(b"\""));
        let name = quoted.and_then(|name| std::str::from_utf8(name).ok());
        let Some(name) = name else {
            return Err(cursor.wrong("the name of a physical group must be in quotes and in UTF-8"));
        };
        raw.groups.name(dimension, tag, name);
    }
    Ok(())
}
