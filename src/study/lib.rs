//! Studies: solves scenes with many settings, and presents the results as tables and figures.
//!
//! - [`read`]: studies from RON or arguments; [`builtin`]: the built-in studies.
//! - [`plan`]: all combinations of the settings, each checked before anything runs.
//! - [`run`](mod@run): the cases as a sweep; [`solver_pool`]: one run on one thread; [`memory_pool`]: limits parallel
//!   runs by memory; [`result`]: the result of a run; [`monitor_kind`]: the units of its numbers.
//! - [`csv`]: all results as one table; [`figure`]: as [`curves`]; [`sheet`]: drawings as plain data, made of
//!   [`drawn`] shapes; [`pen`]: written as SVG and PNG, with the feature `plot`; [`placing`]: positions of
//!   labels; [`linear_axis`], [`log_axis`]: axes with round numbers.
//!
//! Comparison with values from other sources: [`benchmarks`].
//!
//! Convergence maps:
//!
//! - [`random`]: random interface problems; [`trial`]: one of them with every strategy, with verdicts;
//!   [`survey`]: all of them.
//! - [`map`]: scenes over settings, with verdicts; [`verdict_figure`]: figures of both.
//! - [`verdict`]: the classes of runs; [`origin`]: program and machine.
//!
//! Shared by all sweeps:
//!
//! - [`sweep`]: cells that are computed in parallel, stored and merged.
//! - [`log`]: the file of results; [`sweep_input`]: what the results depend on; [`shard`]: which cells belong
//!   to a shard; [`run_error`]: why there are no results.
//!
//! Work-precision charts:
//!
//! - [`chart_file`]: the file format; [`chart_runs`]: the runs; [`precision`]: the measured chart;
//!   [`precision_table`]: as a table; [`precision_figure`]: as a picture.
//! - [`reference`](mod@reference): reference curves; [`richardson`]: the limit of three runs; [`measuring`]: measures a chart in the background.
//!
//! This package is independent of the command line.

#![forbid(unsafe_code)]

pub mod benchmarks;
pub mod builtin;
pub mod chart_file;
pub mod chart_runs;
pub mod csv;
pub mod curves;
pub mod drawn;
pub mod figure;
pub mod linear_axis;
pub mod log;
pub mod log_axis;
pub mod map;
pub mod measuring;
pub mod memory_pool;
pub mod monitor_kind;
pub mod origin;
#[cfg(feature = "plot")]
pub mod pen;
#[cfg(not(feature = "plot"))]
#[path = "pen/disabled.rs"]
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
pub mod richardson;
pub mod run;
pub mod run_error;
pub mod shard;
pub mod sheet;
pub mod solver_pool;
pub mod survey;
pub mod sweep;
pub mod sweep_input;
pub mod trial;
pub mod verdict;
pub mod verdict_figure;

pub use plan::{Case, Plan};
pub use read::{AxisQuantity, Study, Vary};
pub use reason::Reason;
pub use result::{CaseEnd, Row, Run};
pub use run::run;
pub use solver_pool::Watch;
