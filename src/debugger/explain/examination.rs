//! Examines the frozen problem that is solved next from a state: the diagnosis of its cycle, or otherwise the
//! census of its consistent states.

use super::core::cycle;
use super::diagnosis::{self, Cause, Diagnosis, MOST_NODES, cycling, too_many};
use super::facts::{Fact, Part};
use super::names;
use super::proven;
use super::step_size_probe::smaller;
use crate::refusal::Refusal;
use stickslip_core::interface::census::{BUDGET, Census, MOST_SEARCHED, search};
use stickslip_core::interface::uniqueness::uniqueness;
use stickslip_core::step::intervene::Start;
use stickslip_core::strategy::method;
use stickslip_core::{Cycle, Failure, InterfaceProblem, Model, State, Status, Stepper, Trials};
use stickslip_scene::joined;

/// Shown at the end of the history.
pub const DONE: &str = "The history is complete, so there is no next problem.";
/// Shown if there is no condensed problem.
pub const NOT_CONDENSED: &str = "The bodies cannot be condensed to the interface here, so there is no small problem to examine.";

/// Result of an examination.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Examination {
    /// What was found, in one line.
    pub head: String,
    /// The facts.
    pub facts: Vec<Fact>,
    /// Whether the minor iterations cycle from here, or the increment failed.
    pub fails: bool,
    /// Slave numbers of the nodes concerned.
    pub nodes: Vec<usize>,
    /// Motion of unrestrained bodies: points, with directions of length one at most.
    pub arrows: Vec<[[f64; 2]; 2]>,
    /// The problem of the census.
    pub problem: Option<InterfaceProblem>,
    /// All consistent states; `None` if they were not counted.
    pub census: Option<Census>,
}

impl Examination {
    /// The initial modes for a consistent state of the census; `None` if it does not exist.
    pub fn starts(&self, number: usize) -> Option<Vec<Start>> {
        let found = self.census.as_ref()?.answers.get(number)?;
        let nodes = self.problem.as_ref()?.nodes.iter();
        let starts = nodes.zip(&found.answer.nodes).map(|(node, found)| Start {
            slave: node.slave,
            mode: found.assumed.mode(),
            t_max: found.limit * found.f_t.signum(),
        });
        Some(starts.collect())
    }
}

/// An examination without a result, and why.
pub fn nothing(why: &str) -> Examination {
    Examination {
        head: why.into(),
        ..Examination::default()
    }
}

/// The frozen problem that is solved next from a state, or why there is none.
fn next_problem(stepper: &mut Stepper, state: &State) -> Result<InterfaceProblem, &'static str> {
    if state.status == Status::Finished {
        return Err(DONE);
    }
    stepper.restore(state);
    stepper.interface_problem().ok_or(NOT_CONDENSED)
}

/// Examines the frozen problem that is solved next from a state: the diagnosis of its cycle, or otherwise its
/// census. Stops early if `stop` returns true.
pub fn frozen(stepper: &mut Stepper, state: &State, stop: &dyn Fn() -> bool) -> Examination {
    let problem = match next_problem(stepper, state) {
        Err(why) => return nothing(why),
        Ok(problem) => problem,
    };
    let round = match going_round(stepper, state, &problem) {
        Err(why) => return nothing(&why.to_string()),
        Ok(round) => round,
    };
    let model = stepper.model();
    if let Some((problem, cycle)) = round
        && let Some(diagnosis) = Diagnosis::find(&problem, stop)
    {
        let mut facts = diagnosis::words(model, &problem, &diagnosis);
        let head = diagnosis::head(model, &problem, &diagnosis);
        if diagnosis.cause == Cause::NoAnswer {
            let found = smaller(stepper, state);
            facts.extend(found.map(Fact::why));
        }
        return Examination {
            head,
            facts,
            fails: true,
            nodes: cycle.members.iter().map(|member| member.0).collect(),
            problem: Some(diagnosis.problem),
            census: diagnosis.census,
            ..Examination::default()
        };
    }
    let name = |place: usize| names::slave(model, problem.nodes[place].slave);
    let mut proven: Vec<Fact> = Vec::new();
    if problem.nodes.len() <= MOST_NODES {
        proven = Fact::all(Part::Rates, proven::slow_words(&problem, &name));
        if let Status::Failed(Failure::MinorLimit { .. }) = state.status
            && let Some(first) = proven.first_mut()
        {
            first.part = Part::Why;
        }
        let unique = proven::uniqueness_words(uniqueness(&problem), &name);
        proven.push(Fact::new(Part::Census, unique));
    }
    let head = "The minor iterations do not cycle from here.";
    let mut found = of_undecided(model, &problem, head, stop);
    found.facts.extend(proven);
    if found
        .census
        .as_ref()
        .is_some_and(|census| census.answers.is_empty())
    {
        let smaller = smaller(stepper, state);
        found.facts.extend(smaller.map(Fact::why));
    }
    found
}

/// The census of the frozen problem that is solved next from a state, whatever its minor iterations do.
pub fn census(stepper: &mut Stepper, state: &State, stop: &dyn Fn() -> bool) -> Examination {
    let head = "Another solver's iteration: consistent states only.";
    match next_problem(stepper, state) {
        Err(why) => nothing(why),
        Ok(problem) => of_undecided(stepper.model(), &problem, head, stop),
    }
}

/// The census of all nodes with more than one possible mode.
fn of_undecided(
    model: &Model,
    problem: &InterfaceProblem,
    head: &str,
    stop: &dyn Fn() -> bool,
) -> Examination {
    let undecided = diagnosis::undecided(problem);
    if undecided.len() > MOST_SEARCHED {
        let mut found = nothing(head);
        let many = proven::too_many(undecided.len());
        found.facts.push(Fact::new(Part::Census, many));
        return found;
    }
    match problem.reduced(&undecided) {
        Some(studied) => counted(model, &studied, head, stop),
        None => nothing("The frozen interface problem is singular here."),
    }
}

/// The census of these slave nodes at a state, with all others frozen. Stops early if `stop` returns true.
pub fn examine_nodes(
    stepper: &mut Stepper,
    state: &State,
    slaves: &[usize],
    stop: &dyn Fn() -> bool,
) -> Examination {
    let problem = match next_problem(stepper, state) {
        Err(why) => return nothing(why),
        Ok(problem) => problem,
    };
    let places: Vec<usize> = (0..problem.nodes.len())
        .filter(|place| slaves.contains(&problem.nodes[*place].slave))
        .collect();
    let Some(studied) = problem.reduced(&places) else {
        return nothing("With all other nodes frozen, the interface problem is singular.");
    };
    let model = stepper.model();
    let names = joined(slaves.iter().map(|&slave| names::slave(model, slave)), ", ");
    let head = format!("For {names}, with all other nodes frozen:");
    counted(model, &studied, &head, stop)
}

/// The result of a census.
fn counted(
    model: &Model,
    studied: &InterfaceProblem,
    head: &str,
    stop: &dyn Fn() -> bool,
) -> Examination {
    let census = match search(studied, BUDGET, stop) {
        Err(why) => return nothing(&why.to_string()),
        Ok(census) => census,
    };
    let name = |place: usize| names::slave(model, studied.nodes[place].slave);
    let mut lines = diagnosis::census_words(&census, &name);
    lines.extend(proven::family_words(studied, &census, &name));
    Examination {
        head: head.to_owned(),
        facts: Fact::all(Part::Census, lines),
        census: Some(census),
        problem: Some(studied.clone()),
        ..Examination::default()
    }
}

/// The problem whose minor iterations cycle from a state of the stepper, and the cycle by slave number; `None`
/// if there is no cycle. The problem's states are at the start of the cycle. A large problem is stepped to its
/// cycle and reduced to the nodes that take part.
///
/// # Errors
/// If it is unknown whether there is a cycle.
pub fn going_round(
    stepper: &mut Stepper,
    state: &State,
    problem: &InterfaceProblem,
) -> Result<Option<(InterfaceProblem, Cycle)>, Refusal> {
    let by_slave = |cycle: Cycle| Cycle {
        members: cycle
            .members
            .into_iter()
            .map(|(place, modes)| (problem.nodes[place].slave, modes))
            .collect(),
        ..cycle
    };
    if problem.nodes.len() <= MOST_NODES {
        return Ok(cycle(problem).map(|cycle| (at_start(problem, &cycle), by_slave(cycle))));
    }
    let known = match &state.status {
        Status::Failed(Failure::Cycle(cycle)) => Some(cycle.clone()),
        _ => stepper.cycle_ahead(),
    };
    let Some(cycle) = known else {
        return Ok(None);
    };
    let problem = stepper
        .interface_problem()
        .ok_or_else(|| Refusal::new(NOT_CONDENSED))?;
    match cycling(problem, &cycle) {
        Some(problem) => Ok(Some((problem, cycle))),
        None => Err(Refusal::new(too_many(&cycle))),
    }
}

/// The problem with the states at the start of its cycle.
fn at_start(problem: &InterfaceProblem, cycle: &Cycle) -> InterfaceProblem {
    let mut nodes = problem.states();
    if let Some(mut trials) = Trials::new(problem) {
        for _ in 1..cycle.start {
            // The iterations before the cycle have been solved before.
            let _ = trials.minor(&mut nodes, method(problem.settings.strategy));
        }
    }
    let mut started = problem.clone();
    for (node, state) in started.nodes.iter_mut().zip(nodes) {
        node.state = state;
    }
    started
}
