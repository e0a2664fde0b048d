//! Guided lessons: a script for a scene, without a terminal.
//!
//! - [`spec`]: the file format; [`lesson`]: lessons checked against their scene, and the built-in ones.
//! - [`quantity`]: numbers by name, for texts and questions; [`frame_values`]: their values in a state; [`runs`]: those
//!   of a chart.
//! - [`tutor`]: a lesson in progress; [`question`]: its questions; [`guess`]: free mode, with decisions hidden until predicted.
//! - [`play`]: plays a lesson automatically, to check it; [`progress`]: saves the user's progress; [`hand_in`]: what
//!   students hand in.

pub mod frame_values;
pub mod guess;
pub mod hand_in;
pub mod lesson;
pub mod play;
pub mod progress;
pub mod quantity;
pub mod question;
pub mod runs;
pub mod spec;
pub mod task;
pub mod tutor;

pub use frame_values::FrameValues;
pub use guess::Guess;
pub use lesson::{Lesson, find, list};
pub use tutor::Tutor;
