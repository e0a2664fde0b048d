//! The debugger in a web page: the screens, sessions, scenes and lessons of the terminal program.
//!
//! The program runs in a web worker (`page/worker.js`), so the page always responds. The worker sends a `Request` for each input
//! and calls `Page::advance` in a loop while the solver works; each call solves for a few milliseconds and returns the rows of
//! the screen that changed. `src/web/build` builds the page.

#![cfg(target_family = "wasm")]
#![deny(unsafe_code)]

mod exports;
mod message;
mod page;
mod paint;
mod pictures;
mod trace;

pub use message::{Content, MouseKind, Request, Update};
pub use page::Page;
pub use pictures::{Pictures, pictures};
pub use trace::trace;
