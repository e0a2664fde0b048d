//! Gmsh meshes: MSH files of version 2.2 and 4.1, text and binary.
//!
//! A file is a sequence of sections, `$Nodes` to `$EndNodes`; sections without mesh data (`$Periodic`, `$NodeData`, …) are
//! skipped. The format is described in the Gmsh reference manual, "MSH file format". Gmsh uses the same node order as this
//! program: the corners, then the midside nodes, starting on the side after the first corner, then the centre. Nodes and cells
//! are identified by tags, which need not be dense or ordered.
//!
//! Physical groups become [`Group`](crate::mesh::Group)s; one without a name is named by dimension and number, `surface2`. A file
//! without groups gets one group per geometric entity, named by the same rule. Coordinates must lie in a plane z = const.
//!
//! This reader replaces existing crates: mshio reads version 4.1 only, has had no release since 2020, and allocates as much
//! memory as a file's counts claim.

mod cursor;
mod elements;
mod groups;
mod raw;
mod sections;
mod v2;
mod v4;

use crate::FormatError;
use crate::mesh::Mesh;
use cursor::Cursor;
use sections::HEAD;

/// Whether a file is a Gmsh mesh.
pub fn is_one(bytes: &[u8]) -> bool {
    bytes.trim_ascii_start().starts_with(HEAD)
}

/// Reads a mesh.
///
/// # Errors
/// If the file is not a Gmsh mesh, has errors or another version, or has non-plane or third-order cells. Errors have a line and
/// column in a text file, and a byte offset in a binary one.
pub fn read(bytes: &[u8]) -> Result<Mesh, FormatError> {
    let mut cursor = Cursor::new(bytes);
    let raw = sections::read(&mut cursor)?;
    raw.mesh(&cursor)
}

#[cfg(test)]
mod tests;
