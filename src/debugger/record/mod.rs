//! Files of the debugger: snapshots, journals, and exports.
//!
//! - [`snapshot`]: recorded states; [`differences`]: comparison of two snapshots.
//! - [`command`]: the commands of a session, as recorded in journals; [`journal`]: the record of a session;
//!   [`story`]: a journal as readable text; [`bits`]: the digest of a state.
//! - [`table`]: rows of `--csv` and `--trace`.
//! - [`export`]: files made from a state, with the kind chosen by the extension: pictures, scenes, problems for
//!   other programs.

pub mod bits;
pub mod command;
pub mod differences;
pub mod export;
pub mod journal;
pub mod snapshot;
pub mod state_digest;
pub mod story;
pub mod table;
