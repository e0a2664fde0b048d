//! Analyses a frozen problem without a solution: whether its compliance is indefinite only by rounding, and
//! whether it can be solved without that.
//!
//! Small negative eigenvalues are set to zero, and the problem is solved again by minor iterations, by pivoting or by a census. The
//! solution is checked with the original matrix.

use super::core::end;
use super::diagnosis::{condition_words, modes_words};
use stickslip_core::interface::census::search;
use stickslip_core::interface::definite::Compliance;
use stickslip_core::interface::pivoting::{CoulombForm, PathEnd, Pivoting};
use stickslip_core::interface::problem::Answer;
use stickslip_core::{AssumedMode, BoundUpdate, InterfaceProblem, Strategy, Trials};
use stickslip_scene::sig4;

/// Negative eigenvalues up to this fraction of the largest one may be due to rounding.
const SMALL: f64 = 1e-2;
/// Maximum number of nodes of a problem.
const MOST: usize = 100;
/// Maximum number of branches in the search for a state.
const BRANCHES: usize = 1000;
/// Relative violation of a condition below which it is satisfied.
const OBEYED: f64 = 1e-9;
/// Largest tolerance tried, as a power of ten.
const COARSEST: i32 = -3;
/// Maximum number of nodes named.
const MOST_NAMED: usize = 8;

/// Analysis of a compliance with a negative eigenvalue.
#[derive(Debug, Clone, PartialEq)]
pub struct Indefinite {
    /// Smallest and largest eigenvalue (length per force).
    pub ends: [f64; 2],
    /// The conclusion.
    pub outcome: IndefiniteOutcome,
}

/// Conclusion about a negative eigenvalue.
#[derive(Debug, Clone, PartialEq)]
pub enum IndefiniteOutcome {
    /// Too large to be due to rounding.
    NotByRounding,
    /// The problem is solved all the same, by this strategy.
    SolvedAsItIs(Strategy),
    /// The problem is not solved; results of the trials.
    Tried {
        /// The solution after the problem is made semidefinite.
        semidefinite: Option<ConsistentState>,
        /// The smallest tolerance tried (`settings.tolerance`) with which the original problem is solved.
        tolerance: Option<(f64, (Strategy, Answer))>,
    },
}

/// A consistent state, and the strategy that found it.
#[derive(Debug, Clone, PartialEq)]
pub struct ConsistentState {
    /// The strategy.
    pub by: Strategy,
    /// The state.
    pub answer: Answer,
    /// The state with the same modes for the original matrix; `None` if its equations are singular.
    pub as_given: Option<Answer>,
}

/// Analyses a problem's compliance. `None` if no eigenvalue is negative, if there is no compliance, or if there
/// are too many nodes.
pub fn indefinite(problem: &InterfaceProblem, stop: &dyn Fn() -> bool) -> Option<Indefinite> {
    if problem.nodes.len() > MOST {
        return None;
    }
    let compliance = Compliance::from_problem(problem)?;
    let [least, largest] = compliance.ends();
    if least >= -compliance.round_off() {
        return None;
    }
    let ended = |outcome| {
        Some(Indefinite {
            ends: [least, largest],
            outcome,
        })
    };
    if -least > SMALL * largest {
        return ended(IndefiniteOutcome::NotByRounding);
    }
    if let Some((by, _)) = solved(problem, OBEYED, stop) {
        return ended(IndefiniteOutcome::SolvedAsItIs(by));
    }
    // Eigenvalues of the same size as the negative one become zero, too.
    let without = compliance.raised(-least, 0.0);
    let semidefinite = without.and_then(|raised| {
        let (by, answer) = solved(&raised, OBEYED, stop)?;
        let as_given = as_given(problem, &answer);
        Some(ConsistentState {
            by,
            answer,
            as_given,
        })
    });
    let from = (-least / largest).log10().floor() as i32;
    let tolerance = (from..=COARSEST).find_map(|power| {
        let mut coarse = problem.clone();
        let tolerance = 10_f64.powi(power);
        coarse.settings.tolerance = tolerance;
        Some((tolerance, solved(&coarse, tolerance, stop)?))
    });
    ended(IndefiniteOutcome::Tried {
        semidefinite,
        tolerance,
    })
}

/// The state with the same modes in another problem.
fn as_given(problem: &InterfaceProblem, answer: &Answer) -> Option<Answer> {
    let assumed: Vec<AssumedMode> = answer.nodes.iter().map(|node| node.assumed).collect();
    Trials::new(problem)?.answer(&assumed)
}

/// A state that satisfies all conditions up to a tolerance, and the strategy that finds it.
fn solved(
    problem: &InterfaceProblem,
    tolerance: f64,
    stop: &dyn Fn() -> bool,
) -> Option<(Strategy, Answer)> {
    let by_census = || {
        let found = search(problem, BRANCHES, stop).ok()?;
        Some(found.answers.into_iter().next()?.answer)
    };
    let ways: [(Strategy, &dyn Fn() -> Option<Answer>); 3] = [
        (Strategy::Sliding, &|| by_iterations(problem)),
        (Strategy::Lemke, &|| by_pivoting(problem, tolerance)),
        (Strategy::Census, &by_census),
    ];
    ways.into_iter().find_map(|(strategy, find)| {
        let found = find().filter(|answer| answer.obeys(tolerance))?;
        Some((strategy, found))
    })
}

/// The state at which the minor iterations settle.
fn by_iterations(problem: &InterfaceProblem) -> Option<Answer> {
    let mut problem = problem.clone();
    problem.settings.strategy = Strategy::Sliding;
    problem.settings.t_max = BoundUpdate::Consistent;
    let records = end(&problem)?.ok()?;
    let assumed = records.iter().zip(&problem.nodes).map(|(record, node)| {
        let assumed = AssumedMode::from_mode(record.decision.next, record.t_max_used);
        if node.choices().contains(&assumed) {
            assumed
        } else {
            AssumedMode::from_mode(record.decision.next, 1.0)
        }
    });
    Trials::new(&problem)?.answer(&assumed.collect::<Vec<_>>())
}

/// The state at which pivoting ends.
fn by_pivoting(problem: &InterfaceProblem, tolerance: f64) -> Option<Answer> {
    let brought: Vec<AssumedMode> = problem
        .nodes
        .iter()
        .map(|node| {
            let state = &node.state;
            AssumedMode::from_mode(state.mode, state.t_max)
        })
        .collect();
    let mut trials = Trials::new(problem)?;
    (0..CoulombForm::Klarbring.starts()).find_map(|start| {
        let mut path = Pivoting::new(CoulombForm::Klarbring, problem, &brought, start)?;
        while path.tableau.ended().is_none() {
            path.tableau.pivot()?;
        }
        let found = path.tableau.ended() == Some(PathEnd::Solved);
        let assumed: Vec<AssumedMode> = (0..brought.len()).map(|k| path.assumed(k)).collect();
        let answer = found.then(|| trials.answer(&assumed)).flatten()?;
        answer.obeys(tolerance).then_some(answer)
    })
}

impl Indefinite {
    /// Whether rounding of the entries may be the cause of a failure.
    pub fn is_by_rounding(&self) -> bool {
        match &self.outcome {
            IndefiniteOutcome::NotByRounding | IndefiniteOutcome::SolvedAsItIs(_) => false,
            IndefiniteOutcome::Tried {
                semidefinite,
                tolerance,
            } => semidefinite.is_some() || tolerance.is_some(),
        }
    }
}

/// The analysis in words, most important first.
pub fn words<'a>(found: &Indefinite, name: &impl Fn(usize) -> &'a str) -> Vec<String> {
    let [least, largest] = found.ends;
    let head = format!(
        "W, the compliance of the interface, has the eigenvalue {} ({} of the largest)",
        sig4(least),
        sig4(-least / largest)
    );
    let (semidefinite, tolerance) = match &found.outcome {
        IndefiniteOutcome::NotByRounding => {
            return vec![format!(
                "{head}: it is indefinite, not only by rounding; some forces move their points in the opposite direction"
            )];
        }
        IndefiniteOutcome::SolvedAsItIs(by) => {
            return vec![format!(
                "{head}: it is indefinite, perhaps by rounding; strategy {} still solves it",
                by.name()
            )];
        }
        IndefiniteOutcome::Tried {
            semidefinite,
            tolerance,
        } => (semidefinite, tolerance),
    };
    let coarsest = format!("1e{COARSEST}");
    if semidefinite.is_none() && tolerance.is_none() {
        return vec![format!(
            "{head}: it is indefinite, perhaps by rounding of its entries; neither making it \
             semidefinite nor settings.tolerance up to {coarsest} gives a solution"
        )];
    }
    let mut lines = vec![format!(
        "{head}: it is indefinite, perhaps by rounding of its entries"
    )];
    lines.push(match tolerance {
        Some((tolerance, (by, answer))) => format!(
            "what would help: settings.tolerance={tolerance:e}; strategy {} then solves this frozen problem: {}",
            by.name(),
            does(answer, name)
        ),
        None => format!("  settings.tolerance up to {coarsest} gives no solution"),
    });
    lines.push(match semidefinite {
        Some(solved) => format!(
            "what would help: more digits of W may make it semidefinite; strategy {} then solves it: {}; {}",
            solved.by.name(),
            does(&solved.answer, name),
            in_given(solved, name)
        ),
        None => "  making it semidefinite gives no solution".into(),
    });
    lines
}

/// The state in the original matrix.
fn in_given<'a>(solved: &ConsistentState, name: &impl Fn(usize) -> &'a str) -> String {
    let worst = |answer: &Answer| answer.worst().filter(|_| !answer.obeys(OBEYED));
    match &solved.as_given {
        None => "with the original W its equations are singular".to_owned(),
        Some(answer) => match worst(answer) {
            None => "the state is consistent with the original W, too".to_owned(),
            Some((place, margin)) => format!(
                "with the original W the state violates \"{}\" at {} by {}",
                condition_words(margin.condition),
                name(place),
                sig4(-margin.value)
            ),
        },
    }
}

/// The modes of the nodes, one letter each; with names if there are few.
fn does<'a>(answer: &Answer, name: &impl Fn(usize) -> &'a str) -> String {
    if answer.nodes.len() > MOST_NAMED {
        return answer.letters();
    }
    modes_words(answer, name)
}
