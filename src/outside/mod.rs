//! What comes from outside: files that are read, and texts of them that are shown.
//!
//! - [`input`]: the one way in which files are read: regular ones only, never waiting, never more than a stated size.
//! - [`shown`]: the one way in which texts of others reach a terminal, a table or a picture.

pub mod input;
pub mod shown;
