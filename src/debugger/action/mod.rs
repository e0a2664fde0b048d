//! Actions: what can be done by name, by key, or by a typed line.
//!
//! An action is either a [`Command`](crate::record::command::Command) for the session or a [`Ui`] action of the terminal
//! around it. A key press and a typed line both end in [`Entry::act`], so whatever has a key has a name and the other way
//! round. An action that lacks an argument it needs asks for it ([`Ui::Ask`]).
//!
//! - [`meaning`]: what an action can be; [`table`]: all of them by name; [`context`]: what their arguments are read against.
//! - [`keymap`]: which key does which; [`config`]: what the user has set; `turns`: what must wait for the solver.
//! - `offered`: what the solver that is open lets be done; `parameters`: what `set` changes in an attached one.
//! - [`arguments`]: reading a line; [`complete`](mod@complete): what a line could go on as, `paths` for files;
//!   [`misread`]: why it means nothing.

pub mod arguments;
pub mod complete;
pub mod config;
pub mod context;
pub mod keymap;
pub mod meaning;
pub mod misread;
mod offered;
mod parameters;
mod paths;
pub mod table;
#[cfg(test)]
mod tests;
mod turns;

pub use arguments::{increment, mode, parse};
pub use complete::{complete, takes_path};
pub use context::{Context, exact};
pub use keymap::Keymap;
pub use meaning::{
    Action, ChartOf, Colours, Copied, Filter, Page, Question, Sort, Step, Ui, Whose,
};
pub use misread::Misread;
pub use parameters::{parameter, present};
pub use table::{ACTIONS, Entry, Group, by_key, by_name, markdown};
