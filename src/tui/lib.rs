//! The terminal front end: what the session holds, drawn; what the keys mean, from one table.
//!
//! Two halves that meet only in plain data. Drawing is a pure function: [`screen::draw`] makes a screen from a
//! [`View`] (what the session shows) and an [`App`] (what the terminal alone knows: focus, selection, prompts),
//! one file a pane ([`panes`]). Input is another: [`App::key`] turns a key, by way of the table in
//! [`stickslip_debugger::action`], into a changed app and at most one [`Effect`] on the world. Only [`run`](mod@run)
//! and [`terminal`] touch the world: the real terminal, signals, and the session.

#![forbid(unsafe_code)]

pub mod ahead;
pub mod app;
pub mod camera;
pub mod canvas;
pub mod cast;
pub mod chartframe;
pub mod chartpage;
pub mod choosing;
pub mod columns;
pub mod commandline;
pub mod convergence;
mod copying;
pub mod debugger;
mod hearing;
pub mod keys;
pub mod layout;
mod learning;
mod lists;
pub mod loading;
mod mouse;
mod order;
pub mod paint;
pub mod panes;
mod prompts;
mod reading;
pub mod run;
pub mod screen;
pub mod terminal;
pub mod theme;
pub mod view;
mod waiting;

pub use app::{App, Effect};
pub use debugger::Debugger;
pub use run::{Error, resume, run, run_lesson, screen};
pub use screen::picture;
pub use view::View;
