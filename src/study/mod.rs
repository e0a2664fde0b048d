//! Studies: one scene (or a few) solved with many settings, and what came of it as a table and as a figure.
//!
//! - [`read`]: a study as its author writes it, RON or arguments; [`builtin`]: the studies that the program carries.
//! - [`plan`]: the product of all settings, every case of it found sound before anything runs.
//! - [`run`]: the cases side by side, each on one thread; [`result`]: what one of them came to.
//! - [`csv`]: all results as one table; [`figure`]: as curves; [`plot`]: curves as SVG and PNG.
//!
//! Nothing here knows a command line.

pub mod builtin;
pub mod csv;
pub mod figure;
pub mod plan;
pub mod plot;
pub mod read;
pub mod result;
pub mod run;

pub use plan::{Case, Plan};
pub use read::{Quantity, Study, Vary};
pub use result::{End, Reason, Row, Run};
pub use run::{Watch, run};
