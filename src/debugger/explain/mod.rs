//! Explanations of what happened, why, and what to do about it, in the wording shared by the command line and
//! the debugger.
//!
//! - `current_scene`: the scene with the changes made during a run.
//! - [`names`]: words for nodes, modes and positions; [`round_off`]: which numbers are round-off; [`report`]:
//!   what happened, in sentences; [`cycles`]: cycles of modes; [`judged`]: the judge's findings.
//! - [`influence`]: which node pushed which; [`tested`]: the quantities that Table 2 tests; [`core`]: the smallest set of nodes that still cycles;
//!   [`diagnosis`]: the cause of a cycle; [`step_size_probe`]: whether a smaller increment has a consistent state.
//! - [`proven`]: what a matrix proves: uniqueness, and the limit of T_max while the modes repeat;
//!   [`indefinite`]: whether a matrix is indefinite only by rounding, and the solution without that.
//! - [`advice`]: what to do about a failure; [`remedy`]: what can be tried; [`remedies`]: trials of all
//!   remedies.
//! - [`attempt`]: repeats the failed attempt; [`majors`]: why its major iterations do not converge; [`rigid_motion`]:
//!   unrestrained bodies; [`strain`]: solids outside the range of their law; [`load_limit_probe`]: the load that smaller
//!   steps reach; [`surface_end`]: nodes behind the end of their surface; [`moves_away`]: a damped
//!   motion that leaves the last equilibrium; [`restart`]: trials of a changed scene.
//! - [`touch`]: how far the forces depend on where nodes in new contact are held.
//!   [`unforced`]: bodies that move although no force acts on them.
//! - [`examination`]: the frozen problem of a state; [`page`]: the whole diagnosis, as the debugger shows it; [`headline`]: what
//!   happened in one line; [`facts`]: the parts of the page; [`try_list`]: what can be done, with the outcome of each trial.
//! - [`attached`]: the diagnosis for an attached solver, from the problem that it reports; [`interface_scene`]: that problem
//!   as a scene; [`walk`]: which iteration that solver performs; [`reported_pushes`]: the pushes there.
//! - [`audit`]: the judge's findings over a history; [`outline`]: the shape of a state as lines; [`conditions`]: its supports and
//!   loads as marks; [`trail`]: the last iterations of one contact.

pub mod accuracy;
pub mod advice;
pub mod attached;
pub mod attempt;
pub mod audit;
pub mod bond;
pub mod conditions;
pub mod cone_problem;
pub mod core;
pub(crate) mod current_scene;
pub mod cycles;
pub mod diagnosis;
pub mod examination;
pub mod facts;
pub mod failures;
pub mod headline;
pub mod indefinite;
pub mod influence;
pub mod interface_scene;
pub mod judged;
pub mod jumped;
pub mod limit_load;
pub mod load_limit_probe;
pub mod majors;
pub mod model_facts;
pub mod moves_away;
pub mod names;
pub mod outline;
pub mod page;
pub mod proven;
pub mod remedies;
pub mod remedy;
pub mod report;
pub mod reported_pushes;
pub mod restart;
pub mod rigid_motion;
pub mod round_off;
pub mod step_size_probe;
pub mod strain;
pub mod surface_end;
pub mod tested;
pub mod touch;
pub mod trail;
pub mod try_list;
pub mod unforced;
pub mod walk;
