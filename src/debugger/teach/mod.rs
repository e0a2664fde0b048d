//! Guided lessons: a script over a scene, without a terminal.
//!
//! - [`spec`]: the file as its author writes it; [`lesson`]: read, checked against its scene, and the built-in ones.
//! - [`quantity`]: numbers by name, for texts and questions; [`look`]: where they come from, [`runs`]:
//!   where those of a chart do.
//! - [`tutor`]: a lesson being taken; [`guess`]: free mode, where decisions hide until predicted; [`refusal`]: why something
//!   is not done now.
//! - [`play`]: a lesson played through by the program itself, to check it; [`progress`]: how far the user came, kept.

pub mod guess;
pub mod lesson;
pub mod look;
pub mod play;
pub mod progress;
pub mod quantity;
pub mod refusal;
pub mod runs;
pub mod spec;
pub mod tutor;

pub use guess::Guess;
pub use lesson::{Lesson, find, list};
pub use look::Look;
pub use tutor::Tutor;
