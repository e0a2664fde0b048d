//! The debugger without a screen: what a session does, remembers, explains, records and teaches.

#[path = "../common/mod.rs"]
mod common;

// Nothing done is lost by going back; how branches end is judged.
mod branches;
// A run stops where it should, forward and backward, and says why.
mod breakpoints;
// Decks that fail in CalculiX are explained by the rule for their cause, with the cure that helps there.
mod causes;
// Scenes that cycle are diagnosed as their notes say.
mod diagnosis;
// A cycle's core, and whole frozen problems, are scenes of their own that take the same way.
mod cores;
// Snapshots lead to the state that they hold, whatever files go through.
mod replay;
// Journals replay to the same bits, and are told as stories.
mod journal;
// Exercise sheets and what students hand in.
mod exercises;
// Lessons can be played through, tell nothing early, and say where they are wrong.
mod lessons;
// Lessons on small screens, and what of them is kept.
mod reading;
