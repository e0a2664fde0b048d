//! What the terminal shows and what keys do: screens by hand, screens of real scenes, and whole sessions of the built
//! program in a pseudo-terminal.
//!
//! Tests that need a process of their own (a panic, a terminal that is gone) start this program once more with a part to play.

#[path = "../common/terminal.rs"]
mod terminal;

#[path = "../common/causes.rs"]
mod stored;

// Shared: frames made by hand.
mod by_hand;
mod failures;
// Whole screens at every size; what does not fit says so.
mod screens;
// The main screens as stored texts, and as pictures.
mod main_screens;
// What can be opened: found, looked at, taken; files completed.
mod chooser;
// The table of slave nodes: marks with and without colour, ties, order, words.
mod nodes;
// Keys and typed lines become commands; help lists them all.
mod keyboard;
// What is done in real scenes is seen.
mod real_scenes;
// Diagnosis, timeline, branches, remedies and charts, on scenes that do not converge.
mod panes;
// Keys, colours and the mouse as the user wants them; what is copied and looked for.
mod custom;
// Keys typed ahead of the solver.
mod walks;
// The real program: keys in, screens out, the terminal as it was after whatever ends it.
mod sessions;
// Arrows, angles and views of a solver in space.
mod space;
// Journals that cannot be written, what is no file, what would harm the terminal.
mod session_files;
// A finished CalculiX run, looked at.
mod past;
mod pictures;
// A journal as a film shows the session's screens.
mod film;
// A solver of another's, attached; and an exchange with one that was kept.
mod attached;
// The report of a version asks the terminal.
mod report;
