//! Studies: scenes solved with many settings, and what came of it as tables and figures.
//!
//! - [`read`]: a study as its author writes it, RON or arguments; [`builtin`]: the studies that the program carries.
//! - [`plan`]: the product of all settings, every case of it found sound before anything runs.
//! - [`run`](mod@run): the cases side by side, each on one thread; [`result`]: what one of them came to;
//!   [`monitor_kind`]: what its numbers are measured in.
//! - [`csv`]: all results as one table; [`figure`]: as curves; [`plot`]: curves as SVG and PNG;
//!   [`bitmap`]: the letters of the latter; [`placing`]: places for labels; [`log_axis`]: an axis in powers of ten.
//!
//! Values that are known from elsewhere: [`benchmarks`].
//!
//! Stability maps:
//!
//! - [`random`]: random interface problems; [`trial`]: one of them with every strategy, judged; [`survey`]: all of them.
//! - [`map`]: scenes over settings, judged; [`verdict_figure`]: both as pictures; [`sheet`]: pictures as plain data.
//! - [`verdict`]: what a run is worth; [`log`]: results that outlive a kill; [`origin`]: where results come from.
//!
//! Work-precision charts:
//!
//! - [`chart_file`]: a chart as its author writes it; [`precision`]: run and measured; [`precision_table`]: as a table;
//!   [`precision_figure`]: drawn.
//! - [`reference`](mod@reference): what runs are measured against; [`measuring`]: a chart measured beside other work.
//!
//! Nothing here knows a command line.

pub mod benchmarks;
pub mod bitmap;
pub mod builtin;
pub mod chart_file;
pub mod csv;
pub mod figure;
pub mod log;
pub mod log_axis;
pub mod map;
pub mod measuring;
pub mod monitor_kind;
pub mod origin;
pub mod placing;
pub mod plan;
pub mod plot;
pub mod precision;
pub mod precision_figure;
pub mod precision_table;
pub mod random;
pub mod read;
pub mod reason;
pub mod reference;
pub mod result;
pub mod run;
pub mod sheet;
pub mod survey;
pub mod trial;
pub mod verdict;
pub mod verdict_figure;

pub use plan::{Case, Plan};
pub use read::{AxisQuantity, Study, Vary};
pub use reason::Reason;
pub use result::{CaseEnd, Row, Run};
pub use run::{Watch, run};
