//! Which iteration an attached solver performs: its interface problem is walked with each rule, and compared with the minor
//! iterations that it reported.
//!
//! The walk starts with the modes and friction bounds of the first reported iteration of the frozen problem. An
//! iteration is reproduced if all contacts take the same next modes, with the same forces.

use super::interface_scene;
use std::sync::Arc;
use stickslip_core::model::SlipCount;
use stickslip_core::plane::max_abs;
use stickslip_core::strategy::method;
use stickslip_core::{
    BoundUpdate, Event, InterfaceProblem, Mode, Model, Position, ReportedProblem, Settings, State,
    Strategy, Touch, Trials,
};
use stickslip_scene::format::condensed::Problem;

/// Maximum number of contacts of a walked problem, because each iteration is a dense solve.
const MOST: usize = 100;
/// Maximum number of minor iterations compared with the interface problem.
pub const MOST_REPORTED: usize = 200;
/// Relative tolerance of forces.
const SAME: f64 = 1e-6;

/// What a solver reported of the current frozen problem.
#[derive(Default)]
pub struct ReportedIterations {
    /// The state before the first of them.
    pub start: Option<Box<State>>,
    /// The minor iterations, oldest first.
    pub events: Vec<Arc<Event>>,
}

impl ReportedIterations {
    /// Adds the iteration between two states. Those of an earlier major iteration are dropped, and all if it has ended.
    pub fn add(&mut self, before: &State, event: &Event, after: &State) {
        let major = |at: Position| (at.increment, at.attempt, at.major);
        let at = major(event.position);
        if self
            .events
            .last()
            .is_none_or(|last| major(last.position) != at)
            || self.events.len() == MOST_REPORTED
        {
            self.events.clear();
            self.start = Some(Box::new(before.clone()));
        }
        self.events.push(Arc::new(event.clone()));
        if major(after.next) != at {
            self.events.clear();
        }
    }

    /// The gap of a contact at the start, from which it travels to its gap without force; `None` if unknown.
    fn start_gap(&self, model: &Model, slave: usize) -> Option<f64> {
        let (start, record) = (self.start.as_ref()?, self.events.first()?.nodes.get(slave)?);
        let at = model.place(&start.u, model.contacts[slave].node);
        let gap = (0..2)
            .map(|k| (at[k] - record.foot[k]) * record.normal[k])
            .sum::<f64>();
        gap.is_finite().then_some(gap)
    }

    /// The interface problem as a scene that begins where the reported iterations begin.
    pub fn problem(&self, model: &Model, state: &State, posed: &ReportedProblem) -> Problem {
        let mut problem = interface_scene::problem(model, state, posed);
        for (place, &slave) in posed.contacts.iter().enumerate() {
            if let Some(gap) = self.start_gap(model, slave) {
                problem.contacts[place].gap = gap;
                problem.free[2 * place] = posed.q[2 * place] - gap;
            }
        }
        problem
    }
}

/// How well the best rule reproduces the reported iterations.
#[derive(Debug, Clone, PartialEq)]
pub struct Walk {
    /// The settings of the best rule.
    pub settings: Settings,
    /// Number of reported iterations.
    pub reported: usize,
    /// Number of first iterations that each rule for T_max reproduces: lagged, consistent.
    pub reproduced: [usize; 2],
}

impl Walk {
    /// Whether all reported iterations are reproduced.
    pub fn is_complete(&self) -> bool {
        self.reproduced.contains(&self.reported)
    }

    /// The result in one line.
    pub fn words(&self) -> String {
        let of = match self.reported {
            1 => "the solver's only minor iteration here".to_owned(),
            count => format!("the solver's {count} minor iterations here"),
        };
        match (
            self.reproduced.map(|count| count == self.reported),
            self.reproduced,
        ) {
            ([true, true], _) => format!("lagged and consistent T_max both reproduce {of}"),
            ([true, false], [_, other]) => {
                format!("a lagged T_max reproduces {of}, a consistent one {other} of them")
            }
            ([false, true], [other, _]) => {
                format!("a consistent T_max reproduces {of}, a lagged one {other} of them")
            }
            (_, [lagged, consistent]) => format!(
                "of {of}, its interface problem reproduces {lagged} with a lagged T_max and {consistent} with a consistent one"
            ),
        }
    }
}

/// Walks a reported problem with each rule. `None` without minor iterations, or if the problem is too large or singular.
pub fn walk(
    model: &Model,
    state: &State,
    posed: &ReportedProblem,
    reported: &ReportedIterations,
) -> Option<Walk> {
    let iterations = &reported.events;
    let first = iterations.first()?;
    if posed.contacts.len() > MOST || !posed.contacts.iter().all(|&s| s < first.nodes.len()) {
        return None;
    }
    let (_, mut stepper) = interface_scene::stepper(reported.problem(model, state, posed)).ok()?;
    let mut problem = stepper.interface_problem()?;
    for (node, &slave) in problem.nodes.iter_mut().zip(&posed.contacts) {
        let record = &first.nodes[slave];
        let is_sliding = record.decision.before == Mode::Sliding;
        node.state.mode = record.decision.before;
        node.state.t_max = if is_sliding { record.f_t } else { 0.0 };
        node.state.sign = if is_sliding { record.f_t.signum() } else { 0.0 };
    }
    let mut best: Option<(usize, Settings)> = None;
    let reproduced = [BoundUpdate::Lagged, BoundUpdate::Consistent].map(|t_max| {
        let mut most = 0;
        for settings in rules(problem.settings, t_max) {
            problem.settings = settings;
            let count = reproduced(&problem, posed, iterations);
            most = most.max(count);
            if best.as_ref().is_none_or(|(most, _)| count > *most) {
                best = Some((count, settings));
            }
        }
        most
    });
    Some(Walk {
        settings: best?.1,
        reported: iterations.len(),
        reproduced,
    })
}

/// The rules that are tried with this T_max.
fn rules(base: Settings, t_max: BoundUpdate) -> impl Iterator<Item = Settings> {
    [Strategy::Table2, Strategy::Newton]
        .into_iter()
        .flat_map(|strategy| [Touch::Start, Touch::Ratio].map(|touch| (strategy, touch)))
        .flat_map(move |(strategy, touch)| {
            [SlipCount::Increment, SlipCount::Major].map(|slip| Settings {
                strategy,
                touch,
                slip,
                t_max,
                ..base
            })
        })
}

/// The number of first iterations that the problem reproduces.
fn reproduced(
    problem: &InterfaceProblem,
    posed: &ReportedProblem,
    iterations: &[Arc<Event>],
) -> usize {
    let Some(mut trials) = Trials::new(problem) else {
        return 0;
    };
    let mut nodes = problem.states();
    let reported = iterations.iter().flat_map(|event| &event.nodes);
    let tolerance = SAME * max_abs(reported.flat_map(|record| [record.f_n, record.f_t]));
    let mut is_same = |event: &Arc<Event>| {
        let found = trials.minor(&mut nodes, method(problem.settings.strategy));
        let Some((records, _)) = found else {
            return false;
        };
        records.iter().zip(&posed.contacts).all(|(ours, &slave)| {
            event.nodes.get(slave).is_some_and(|theirs| {
                // Forces that are not reported are NaN, and are not compared.
                let differs = |a: f64, b: f64| (a - b).abs() > tolerance;
                ours.decision.next == theirs.decision.next
                    && !differs(ours.f_n, theirs.f_n)
                    && !differs(ours.f_t, theirs.f_t)
            })
        })
    };
    iterations.iter().take_while(|event| is_same(event)).count()
}
