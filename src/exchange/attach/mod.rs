//! The protocol by which the debugger steps a solver in another process: lines of JSON, version [`PROTOCOL`].
//!
//! The debugger sends requests ([`Request`]) and the solver answers ([`Answer`]), one message per line. JSON has no infinity and
//! NaN: infinite and missing numbers are written as `null`. Floats are written with enough digits to be read back exactly. The
//! manual's page `protocol` describes all messages; the types here define the same in Rust.
//!
//! - [`message`]: the messages; `reading`: converts them to and from lines.
//! - [`mod@line`]: reads lines of bounded length from an untrusted stream.
//! - [`conversation`]: transcripts of exchanges.

pub mod conversation;
pub mod line;
pub mod message;
mod reading;

pub use conversation::{Side, TranscriptLine};
pub use line::{Line, LineReader};
pub use message::{Answer, Request};

/// Supported protocol version.
pub const PROTOCOL: u32 = 1;

/// Maximum size of a message in bytes; a state of 100,000 contacts needs about a third of it.
pub const MOST_BYTES: usize = 64 << 20;
