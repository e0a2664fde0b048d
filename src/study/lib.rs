//! Studies: scenes solved with many settings, and what came of it as tables and figures.
//!
//! - [`read`]: a study as its author writes it, RON or arguments; [`builtin`]: the studies that the program carries.
//! - [`plan`]: the product of all settings, every case of it found sound before anything runs.
//! - [`run`](mod@run): the cases as a sweep; [`one`](mod@one): one run, on one thread; [`room`]: as many as the memory has room for;
//!   [`result`]: what one of them came to;
//!   [`monitor_kind`]: what its numbers are measured in.
//! - [`csv`]: all results as one table; [`figure`]: as [`curves`]; [`sheet`]: drawings as plain data, of [`drawn`] shapes;
//!   [`pen`]: these as SVG and PNG, with the feature `plot`; [`placing`]: places for labels; [`log_axis`]: an axis in powers of ten.
//!
//! Values that are known from elsewhere: [`benchmarks`].
//!
//! Convergence maps:
//!
//! - [`random`]: random interface problems; [`trial`]: one of them with every strategy, judged; [`survey`]: all of them.
//! - [`map`]: scenes over settings, judged; [`verdict_figure`]: both as pictures.
//! - [`verdict`]: what a run is worth; [`origin`]: where results come from.
//!
//! What all sweeps share:
//!
//! - [`sweep`]: cells that are computed side by side, stored, and put together.
//! - [`log`]: a file of results; [`sweep_input`]: what these are of; [`shard`]: which cells a shard does.
//!
//! Work-precision charts:
//!
//! - [`chart_file`]: a chart as its author writes it; [`chart_runs`]: its runs; [`precision`]: measured; [`precision_table`]: as a table;
//!   [`precision_figure`]: drawn.
//! - [`reference`](mod@reference): what runs are measured against; [`measuring`]: a chart measured beside other work.
//!
//! Nothing here knows a command line.

#![forbid(unsafe_code)]

pub mod benchmarks;
pub mod builtin;
pub mod chart_file;
pub mod chart_runs;
pub mod csv;
pub mod curves;
pub mod drawn;
pub mod figure;
pub mod log;
pub mod log_axis;
pub mod map;
pub mod measuring;
pub mod monitor_kind;
pub mod one;
pub mod origin;
#[cfg(feature = "plot")]
pub mod pen;
#[cfg(not(feature = "plot"))]
#[path = "penless.rs"]
pub mod pen;
pub mod placing;
pub mod plan;
pub mod precision;
pub mod precision_figure;
pub mod precision_table;
pub mod random;
pub mod read;
pub mod reason;
pub mod reference;
pub mod result;
pub mod room;
pub mod run;
pub mod shard;
pub mod sheet;
pub mod survey;
pub mod sweep;
pub mod sweep_input;
pub mod trial;
pub mod verdict;
pub mod verdict_figure;

pub use one::Watch;
pub use plan::{Case, Plan};
pub use read::{AxisQuantity, Study, Vary};
pub use reason::Reason;
pub use result::{CaseEnd, Row, Run};
pub use run::run;
