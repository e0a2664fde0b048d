//! How the stepper gets to an answer, or says why there is none: minor iterations, strategies, cycles, singular systems,
//! jumps, sizes, and the same bits whatever the threads.

#[path = "../common/mod.rs"]
mod common;
#[path = "../outside/hyperstatic.rs"]
mod hyperstatic;
#[path = "../outside/needs.rs"]
mod needs;
#[path = "../common/packing.rs"]
mod packing;
#[path = "../common/program.rs"]
mod program;

// At the edges: singular systems, limits, held modes, new increments, settings.
mod stepper;
// Large meshes are assembled in parts that share no entries.
mod assembly;
// Each leg of the path may have increments of its own.
mod legs;
// A solver that goes over to another model of the same bodies has every bit of a new one.
mod renewed;
// The condensed interface takes the steps of the whole system, whatever the bodies.
mod condensation;
// Loads of decks over several steps, and supports by name.
mod deck_loads;
// Constant pressure across SURFACE TO SURFACE contacts of decks.
mod deck_patches;
// Thermal expansion in decks, free and restrained.
mod expansion;
// Bodies given by a matrix, endless floors, and what slave nodes bring along.
mod interfaces;
mod linear;
// Many contacts whose forces are not unique.
mod packings;
// Friction problems of Siconos are read, solved, written, and refused with a line where broken.
mod siconos;
// Planted cycles are found where they start and as long as they are, and diagnosed.
mod cycles;
// The census finds every consistent state of a frozen problem.
mod census;
// Where T_max goes while the modes repeat, and what a matrix proves.
mod spirals;
// The small scenes that fail do what their heads say.
mod oscillators;
mod recoveries;
mod search;
// No strategy accepts what is no Coulomb state; the ladder finds an answer wherever there is one.
mod strategies;
// Springs in series at contacts: random problems against hard ones with the springs in the matrix, and tangents by differences.
mod compliant;
// Bodies that come loose are told at the load at which they do; advice holds.
mod loose;
// Jumps to another branch are found, said and decided on; other sudden motions are none.
mod jumps;
// Limit loads and lost stability against closed forms; jumps that were once passed without a word.
mod limits;
// Paths are followed past limit points: closed forms, corners, bounds.
mod arc;
// Answers of zero, other units, stiffnesses that round-off spoils, scenes near the limits of memory.
mod scales;
// The examples of the library run, and write what they promise.
mod examples;
// Nothing is assembled or factored twice, and old factors lead to the same answers.
mod work;
// Structures that hold each other by more contacts than they have motions.
mod structures;
// Forces that are not unique, and matrices that are indefinite by rounding.
mod families;
// Stability of accepted states, against closed forms and a tangent by differences of forces.
mod stability;
// Damped motions past limit points: where a scene lets go and where it rests.
mod dynamic;
