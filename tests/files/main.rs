//! Files and names that come from outside, and what the program and its README are made of.

#[path = "../common/causes.rs"]
mod causes;
#[path = "../common/pages.rs"]
mod pages;
#[path = "../common/program.rs"]
mod program;
#[path = "../common/terminal.rs"]
mod terminal;

// Shared: scenes as text.
mod scenes;
// Built-in scenes are sound, found, and numbered as the solver wants.
mod built_in;
// Nodes lie where they should and have the names that the format promises.
mod meshes;
// Meshes that are given node by node, and those of Gmsh.
mod given;
// Loads, supports, regions, monitors and settings mean what they say.
mod meaning;
// A scene that is read once has every bit of one that is read with its settings.
mod bases;
// Each fault has one message with its place.
mod faults;
// Whatever is in a file, there is an answer and no panic.
mod damage;
// Shared: the program run with a deadline.
mod hostile;
// Orders to the terminal are shown and never obeyed.
mod orders;
// What is no file, too large, too deep or does not fit is refused in one line.
mod refusals;
// Lines may end as on Windows.
mod line_ends;
// What is written is whole, or not there at all.
mod writing;
// The program may be passed on with all that it is made of.
mod licences;
// The declared Rust version is true, and the same everywhere.
mod versions;
// The pages of the manual show what the program shows, and are found.
mod manual;
// Every message that the manual shows of the protocol is one.
mod protocol;
// The README shows what the program shows.
mod readme;
