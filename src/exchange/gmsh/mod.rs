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
mod elements;
mod groups;
mod raw;
mod sections;
mod v2;
mod v4;

use crate::broken::Broken;
use crate::mesh::Mesh;
use cursor::Cursor;
use sections::HEAD;

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

#[cfg(test)]
mod tests;
