//! What comes from outside and goes there: files that are read and written, and texts of others that are shown.
//!
//! - [`input`]: the one way in which files are read: regular ones only, never waiting, never more than a stated size.
//! - [`files`]: the one way in which files are written: whole or not at all, and never over another one unasked.
//! - [`carried`]: files that the program carries inside itself.
//! - [`calculix`]: a finished CalculiX run.
//! - [`terminal`]: what the terminal is, and what it says when it is asked.
//! - [`shown`]: the one way in which texts of others reach a terminal, a table or a picture.

pub mod calculix;
pub mod carried;
pub mod files;
pub mod input;
pub mod shown;
pub mod terminal;
