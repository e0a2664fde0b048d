//! Files of CalculiX: how a run went, and the stiffness that it stores.
//!
//! - `lines`: lines of such files, no longer than they can be, and the fields in them.
//! - [`cel`]: the contact elements of every iteration.
//! - [`sta`]: how every attempt of an increment ended.
//! - [`cvg`]: residual and correction of every iteration.
//! - [`past`]: the three together: a run that is over.
//! - [`stiffness`]: the stiffness matrix that it stores.

pub mod cel;
pub mod cvg;
mod lines;
pub mod past;
pub mod sta;
pub mod stiffness;

/// Where a file could not be read to its end, by its line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// It breaks off in the middle of something: whoever wrote it was stopped.
    Cut(usize),
    /// A whole number had no room in its column, so that it is not known which iterations follow.
    NoRoom(usize),
}

/// The rows of a table, in its order, and where it breaks off, if it does.
pub type Table<T> = (Vec<T>, Option<Stop>);
