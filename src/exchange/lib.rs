//! stickslip-exchange: files of other programs, as plain data.
//!
//! A reader takes bytes and gives what stands in them, or says at which line and column something is wrong and what would be
//! right; a writer takes plain data and gives bytes. Nothing here opens a file, knows a scene or solves anything: what the data
//! mean to stickslip is said by those who use them. No input makes a reader panic, or take more memory than its own size calls
//! for.
//!
//! - [`broken`]: what is wrong with a file, and where.
//! - [`calculix`]: how a run of CalculiX went.
//! - [`inp`]: decks of CalculiX and Abaqus.
//! - [`gmsh`]: meshes of Gmsh.
//! - [`mesh`]: nodes, cells and groups, as all readers of meshes give them.

#![forbid(unsafe_code)]

pub mod broken;
pub mod calculix;
pub mod gmsh;
pub mod inp;
pub mod mesh;
