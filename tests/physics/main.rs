//! Whether the answers are right: against closed forms, exact solutions, other codes, the laws of contact, and a judge from
//! outside.

#[path = "../common/mod.rs"]
mod common;
#[path = "../outside/mod.rs"]
mod outside;
#[path = "../common/program.rs"]
mod program;

// Beams alone meet closed forms, at their elements' order; Newton converges quadratically.
mod beams;
// Shared: a block alone.
mod blocks;
// Solids alone meet closed forms and beam theory; a distorted patch is exact.
mod solids;
// Stretches and det F meet closed forms and finite differences; no inverted element is accepted.
mod start_gaps;
mod strains;
// Penalty, stick stiffness, ties and cohesion by area meet closed forms, and each other.
mod laws;
// The same laws on an axis, in press fits, along arcs, changed by hand, and in snapshots.
mod bonds;
// Decks of another program mean what scenes written by hand mean.
mod decks;
// The paper's problems meet solutions found without any contact algorithm, at the rate that they claim.
mod references;
// What round-off leaves: press fits, soft springs, far from the origin, far too stiff.
mod round_off;
// A cantilever beside an elastic block: its end, its work, its mesh, the paper's figures.
mod problem_05;
// A rigid cylinder presses a block as Hertz says.
mod hertz;
// Smooth masters: what they change of error and iterations, and what they get through.
mod smooth;
// Any node on any chain, over borders and corners, from one body to the next.
mod pairing;
// A beam that shears gives as its theory says where a node presses on it, wherever in an element.
mod point_forces;
// Two sides of a surface at once: corners, vertices, steps.
mod corners;
// What a node bears that slid to where two sides meet, as the kink goes to zero.
mod corner_law;
// Masters cut at their corners: what goes past one at a depth.
mod cut_masters;
// Elements of every kind in whole scenes: patches, closed forms, rates, locking, loads that follow.
mod elements;
// Stuck nodes stay where they stuck; without an anchor they drift in third order.
mod drift;
// Equilibrium, contact and friction hold in every accepted increment; turned scenes give turned results.
mod invariants;
// The judge refuses states made wrong, one law at a time, and what was once accepted wrongly.
mod judge;
// What is shipped obeys every law, and `stickslip audit` says so.
mod audit;
// No accepted increment of a random scene is wrong to a judge that shares no code with the program.
mod random_scenes;
// The diagnosis pages of failed scenes list no untried advice that is not marked, and no contradictions.
mod pages;
