//! Analyses the interface problem that an attached solver reports: its consistent states, and whether Table 2
//! (or Newton's method) would cycle on it.
//!
//! The problem becomes a scene of contacts ([`interface_scene`](super::interface_scene)). It is examined like a frozen problem of our own bodies; results are reported with the node
//! numbers of the solver's scene.

use super::cone_problem;
use super::examination::{DONE, Examination, census, examine_nodes, frozen, nothing};
use super::facts::{Fact, Part};
use super::interface_scene::stepper;
use super::walk::{ReportedIterations, walk};
use stickslip_core::{Model, ReportedProblem, State, Status};

/// Shown without reported minor iterations of the problem.
const NOT_COMPARED: &str =
    "Table 2 applied to its interface problem; not compared with minor iterations of the solver";

/// Examines the problem that is solved next from a state, for these contacts or, if there are none, for all
/// relevant ones. If no rule reproduces the reported minor iterations, consistent states are counted, but no
/// cause is given. Stops early if `stop` returns true.
pub fn examine(
    model: &Model,
    state: &State,
    posed: &ReportedProblem,
    reported: &ReportedIterations,
    contacts: &[usize],
    stop: &dyn Fn() -> bool,
) -> Examination {
    if state.status == Status::Finished {
        return nothing(DONE);
    }
    if posed.tangents == 2 {
        return cone_problem::examine(model, posed, stop);
    }
    let walk = walk(model, state, posed, reported);
    let mut asked = reported.problem(model, state, posed);
    if let Some(walk) = &walk {
        asked.settings = walk.settings;
    }
    let mut stepper = match stepper(asked) {
        Ok((_, stepper)) => stepper,
        Err(why) => {
            return nothing(&format!(
                "The reported interface problem is invalid: {why}."
            ));
        }
    };
    let start = stepper.state().clone();
    let is_other = walk.as_ref().is_some_and(|walk| !walk.is_complete());
    let mut found = match contacts {
        [] if is_other => census(&mut stepper, &start, stop),
        [] => frozen(&mut stepper, &start, stop),
        some => {
            let places: Vec<usize> = some
                .iter()
                .filter_map(|slave| posed.contacts.iter().position(|known| known == slave))
                .collect();
            examine_nodes(&mut stepper, &start, &places, stop)
        }
    };
    let part = if is_other { Part::Why } else { Part::Details };
    let compared = walk.map_or_else(|| NOT_COMPARED.to_owned(), |walk| walk.words());
    found.facts.push(Fact::new(part, compared));
    // Maps nodes of the problem to contacts of the scene.
    let slave = |place: usize| posed.contacts.get(place).copied().unwrap_or(place);
    found.nodes = found.nodes.iter().map(|&place| slave(place)).collect();
    if let Some(problem) = &mut found.problem {
        for node in &mut problem.nodes {
            node.slave = slave(node.slave);
        }
    }
    found
}
