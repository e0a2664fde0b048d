//! The protocol by which a debugger steps a solver that is a program of its own: lines of JSON, version [`PROTOCOL`].
//!
//! The debugger asks ([`Request`]), the solver answers ([`Answer`]), one line each. JSON knows no infinity and no NaN: `null`
//! stands for what is infinite or missing. Floats are written with as many digits as they need to read back to the same bits.
//! The manual's page `protocol` describes all messages; the types here say the same in Rust.
//!
//! - [`message`]: what the two sides say; `reading`: as lines, and from lines.
//! - [`mod@line`]: lines of bounded length from a stream that may hold anything.
//! - [`conversation`]: a kept exchange, line by line with its direction.

pub mod conversation;
pub mod line;
pub mod message;
mod reading;

pub use conversation::{Kept, Side};
pub use line::{Line, Lines};
pub use message::{Answer, Request};

/// The version of the protocol that is spoken here.
pub const PROTOCOL: u32 = 1;

/// Most bytes of a message: a state of 100,000 contacts takes about a third of it.
pub const MOST_BYTES: usize = 64 << 20;
