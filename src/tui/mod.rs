//! The terminal front end: what the session holds, drawn; what the keys mean, from one table.
//!
//! Two halves that meet only in plain data. Drawing is a pure function: [`draw::draw`] makes a screen from a
//! [`View`] (what the session shows) and an [`App`] (what the terminal alone knows: focus, selection, prompts),
//! one file per pane. Input is another: [`App::key`] turns a key, by way of the table in
//! [`crate::debug::command`], into a changed app and at most one [`Effect`] on the world. Only [`run`](mod@run)
//! and [`terminal`] touch the world: the real terminal, signals, and the session.

pub mod app;
pub mod branches;
pub mod canvas;
pub mod chooser;
pub mod commandline;
pub mod curve;
pub mod decision;
pub mod diagnosis;
pub mod draw;
pub mod footer;
pub mod help;
pub mod keys;
pub mod layout;
pub mod lesson;
pub mod loading;
pub mod manual;
pub mod nodes;
pub mod number;
pub mod remedies;
pub mod residual;
pub mod run;
pub mod shape;
pub mod status;
pub mod terminal;
pub mod theme;
pub mod timeline;
pub mod view;
pub mod workprecision;

pub use app::{App, Effect};
pub use draw::picture;
pub use run::{Debugger, Error, resume, run, run_lesson, screen};
pub use terminal::width;
pub use view::View;
