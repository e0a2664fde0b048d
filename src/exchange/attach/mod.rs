//! The protocol by which the debugger steps a solver in another process: lines of JSON, versions [`PROTOCOLS`].
//!
//! The debugger sends requests ([`Request`]) and the solver answers ([`Answer`]), one message per line. JSON has no infinity and
//! NaN: infinite and missing numbers are written as `null`. Floats are written with enough digits to be read back exactly. The
//! manual's page `protocol` describes all messages; the types here define the same in Rust.
//!
//! - [`message`]: the messages; `components`: the vectors in them; `reading`: converts them to and from lines.
//! - [`mod@line`]: reads lines of bounded length from an untrusted stream.
//! - [`conversation`]: transcripts of exchanges.

mod components;
pub mod conversation;
pub mod line;
pub mod message;
mod reading;

pub use conversation::{Side, TranscriptLine};
pub use line::{Line, LineReader};
pub use message::{Answer, Request};

/// Supported protocol versions: 1 for the plane, 2 for space as well.
pub const PROTOCOLS: [u32; 2] = [1, 2];

/// Maximum size of a message in bytes; a state of 100,000 contacts needs about a third of it.
pub const MOST_BYTES: usize = 64 << 20;
