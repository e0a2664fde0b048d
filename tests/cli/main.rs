//! The program from outside, without a terminal: exit codes, streams, tables, files.

#[path = "../common/program.rs"]
mod program;

// run, check, list, record, replay: what ends with which code, and where its words go.
mod run;
// Warnings of bodies that overlap, or move without a force.
mod warnings;
// Studies run what they list, in that order, with the bits of a run alone.
mod study;
// Convergence maps count honestly, and a kill loses nothing.
mod map;
// What is known from elsewhere is found.
mod benchmarks;
// Shards put together are the whole.
mod shards;
// Work-precision charts draw what they measured, failures too.
mod chart;
// One thread or two, one job or two: the same bytes.
mod threads;
// Pictures and other files of what is there: whole, equal, and of the state that they say.
mod export;
// Results as data agree with tables, text and exit codes, and have the fields of their page.
mod json;
// Files for ParaView and for other solvers.
mod vtu;
// Shells complete command lines, and man shows the pages.
mod shells;
// Wrong kinds of files, mistyped words, readers that have seen enough.
mod manners;
