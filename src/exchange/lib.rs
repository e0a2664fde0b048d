//! stickslip-exchange: files of other programs, as plain data.
//!
//! A reader takes bytes and gives what stands in them, or says at which line and column something is wrong and what would be
//! right; a writer takes plain data and gives bytes. Nothing here opens a file, reads a scene or solves anything: what the data
//! mean to stickslip is said by those who use them. Of stickslip-core only the records are used that messages of [`attach`] name.
//! No input makes a reader panic, or take more memory than its own size calls for.
//!
//! Each takes only from those above it:
//!
//! - [`broken`]: what is wrong with a file, and where.
//! - [`seal`]: lines with a digest.
//! - [`words`]: words of a text apart by blanks, with their places.
//! - [`mesh`]: nodes, cells and groups, as all readers of meshes give them.
//! - [`gmsh`]: meshes of Gmsh.
//! - [`inp`]: decks of CalculiX and Abaqus.
//! - [`problem`]: friction problems, as all readers of interface problems give them.
//! - [`calculix`]: how a run of CalculiX went, and the stiffness that it stores.
//! - [`siconos`]: friction problems of Siconos, as text.
//! - [`matrix_market`]: single matrices in the Matrix Market's exchange format.
//! - [`fclib`]: friction problems in the HDF5 files of the library fclib, with the feature `fclib`.
//! - [`vtu`]: results for ParaView: VTK's unstructured grids, and collections of them.
//! - [`attach`]: the protocol by which other programs' solvers are stepped.

#![forbid(unsafe_code)]

pub mod attach;
pub mod broken;
pub mod calculix;
pub mod fclib;
pub mod gmsh;
pub mod inp;
pub mod matrix_market;
pub mod mesh;
pub mod problem;
pub mod seal;
pub mod siconos;
pub mod vtu;
pub mod words;
