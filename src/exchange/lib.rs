//! stickslip-exchange: reads and writes files of other programs as plain data.
//!
//! A reader parses bytes, or reports an error with line, column and the expected input; a writer converts plain data to bytes.
//! This package opens no files, reads no scenes and solves nothing; its callers interpret the data. Of stickslip-core it uses
//! only the records that messages of [`attach`] contain. No input makes a reader panic, or use more memory than the input size
//! justifies.
//!
//! Each module depends only on those above it:
//!
//! - [`format_error`]: errors in a file, with their position.
//! - [`seal`]: lines with a digest.
//! - [`words`]: words of a text, with their positions.
//! - [`mesh`]: nodes, cells and groups, the common result of all mesh readers.
//! - [`gmsh`]: Gmsh meshes.
//! - [`inp`]: CalculiX and Abaqus decks.
//! - [`problem`]: friction problems, the common result of all readers of interface problems.
//! - [`calculix`]: CalculiX runs and stored stiffness matrices.
//! - [`siconos`]: Siconos friction problems in text form.
//! - [`matrix_market`]: single matrices in Matrix Market format.
//! - [`fclib`]: friction problems in HDF5 files of the library fclib, with the feature `fclib`.
//! - [`vtu`]: results for ParaView: VTK unstructured grids, and collections of them; [`vtu_reader`]: their meshes.
//! - [`attach`]: the protocol for stepping other programs' solvers.

#![forbid(unsafe_code)]

pub mod attach;
pub mod calculix;
pub mod fclib;
pub mod format_error;
pub mod gmsh;
pub mod inp;
pub mod matrix_market;
pub mod mesh;
pub mod problem;
pub mod seal;
pub mod siconos;
pub mod vtu;
pub mod vtu_reader;
pub mod words;

pub use format_error::FormatError;
