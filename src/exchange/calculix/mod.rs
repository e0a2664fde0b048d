//! CalculiX files: the progress of a run, and a stored stiffness.
//!
//! - `lines`: lines of bounded length, and their fields.
//! - [`cel`]: the contact elements of every iteration.
//! - [`sta`]: result of every attempt at an increment.
//! - [`cvg`]: residual and correction of every iteration.
//! - [`files`]: these three together: a finished run.
//! - [`frd`]: contact pressures of the last result.
//! - [`stiffness`]: a stored stiffness matrix.

pub mod cel;
pub mod cvg;
pub mod files;
pub mod frd;
mod lines;
pub mod sta;
pub mod stiffness;

/// Where and why reading a file stopped, with the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The file is truncated: its writer was stopped.
    Cut(usize),
    /// A whole number did not fit its column, so the following iterations are unknown.
    NoRoom(usize),
}

/// The rows of a table, in order, and where it is truncated, if it is.
pub type Table<T> = (Vec<T>, Option<Stop>);
