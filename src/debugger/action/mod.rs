//! Actions: everything a user can do, by name, by key or as a typed line.
//!
//! An action is either a [`Command`](crate::record::command::Command) for the session or a [`Ui`] action of the
//! terminal. Key presses and typed lines both end in [`ActionEntry::act`], so that every key has a name. An action
//! with a missing argument asks for it ([`Ui::Ask`]).
//!
//! - [`meaning`]: the types of actions; [`table`]: all actions by name; [`context`]: what their arguments refer
//!   to.
//! - [`keymap`]: the key bindings; [`config`]: the user's configuration; `turns`: which actions wait for the
//!   solver.
//! - `offered`: which actions the current solver supports; `parameters`: what `set` changes in an attached one.
//! - [`arguments`]: parsing of lines; [`complete`](mod@complete): completion, with `paths` for files.

pub mod arguments;
pub mod complete;
pub mod config;
pub mod context;
mod cycle_focus;
pub mod keymap;
pub mod meaning;
mod offered;
mod parameters;
mod paths;
pub mod table;
#[cfg(test)]
mod tests;

pub use arguments::{increment, letter, mode, parse};
pub use complete::{complete, takes_path};
pub use context::{Context, exact};
pub use keymap::Keymap;
pub use meaning::{
    Action, ChartOf, Colours, CopyTarget, Filter, HiddenDecisions, Page, Question, Sort, Step, Ui,
};
pub use parameters::{parameter, present};
pub use table::{ACTIONS, ActionEntry, Group, by_key, by_name, markdown, named};
