//! The terminal front end: draws a session and turns keys into commands.
//!
//! The two halves share only plain data. Drawing is a pure function: [`screen::draw`] draws a [`View`] (the session's data) and an
//! [`App`] (focus, selection, prompts), with one file per pane ([`panes`]). Input: [`App::key`] looks a key up in the table of
//! [`stickslip_debugger::action`], changes the app and returns at most one [`Effect`]. Only [`run`](mod@run) and [`terminal`]
//! access the terminal, signals and the session.

#![forbid(unsafe_code)]

pub mod app;
#[cfg(feature = "terminal")]
mod background;
pub mod camera;
pub mod canvas;
pub mod cast;
pub mod chartframe;
pub mod chartpage;
pub mod chooser_state;
pub mod columns;
pub mod commandline;
pub mod convergence;
mod copied;
mod copying;
pub mod debugger;
pub mod event;
pub mod input_queue;
pub mod keys;
pub mod layout;
pub mod learning;
mod lesson_text;
mod lists;
pub mod loading;
mod log_counts;
pub mod main_screens;
mod mouse;
mod order;
pub mod paint;
mod pane_entry;
pub mod panes;
mod prompts;
#[cfg(feature = "terminal")]
pub mod run;
mod run_shape;
pub mod screen;
pub mod screenshot;
mod scroll;
mod shape_lines;
mod shape_marks;
#[cfg(feature = "terminal")]
pub mod terminal;
pub mod textpage;
pub mod theme;
pub mod view;
mod waiting;
mod window;

pub use app::{App, Effect};
pub use debugger::{Debugger, after_keys, screen};
#[cfg(feature = "terminal")]
pub use run::{Error, resume, run, run_lesson};
pub use screen::picture;
pub use view::View;
