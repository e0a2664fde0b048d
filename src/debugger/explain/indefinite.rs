//! What the numbers of a frozen problem tell where nothing solves it: whether its compliance is indefinite by no more than
//! rounding, and whether it is solved without that.
//!
//! Small negative eigenvalues are set to zero, and the problem is solved again with all that the ladder has. What it finds
//! is looked at in the matrix as it was given.

use super::diagnosis::{answer_words, condition_words};
use stickslip_core::interface::census::search;
use stickslip_core::interface::definite::Compliance;
use stickslip_core::interface::lemke::{Lemke, PathEnd, STARTS};
use stickslip_core::interface::problem::{Answer, Assumed, InterfaceProblem};
use stickslip_core::interface::trials::Trials;
use stickslip_core::model::Strategy;
use stickslip_core::strategy::{in_force, method, rungs};
use stickslip_scene::number::four;

/// A negative eigenvalue up to this part of the largest one may be due to rounding.
const SMALL: f64 = 1e-2;
/// Most nodes of a problem that is looked at.
const MOST: usize = 100;
/// Most minor iterations of a strategy.
const MINORS: u32 = 400;
/// Branches of the search for a state.
const BRANCHES: usize = 1000;
/// Conditions that are broken by less than this (relative) count as obeyed.
const OBEYED: f64 = 1e-9;
/// Largest tolerance that is tried, a power of ten.
const COARSEST: i32 = -3;
/// Most nodes of which it is told what they do.
const MOST_NAMED: usize = 8;

/// What was found of a compliance with a negative eigenvalue.
#[derive(Debug, Clone, PartialEq)]
pub struct Indefinite {
    /// Smallest and largest eigenvalue (length by force).
    pub ends: [f64; 2],
    /// What came of it.
    pub came: Came,
}

/// What comes of a negative eigenvalue.
#[derive(Debug, Clone, PartialEq)]
pub enum Came {
    /// It is too large to be due to rounding.
    NotByRounding,
    /// The problem is solved all the same, by this rung of the ladder.
    SolvedAsItIs(Strategy),
    /// It is not, and this was tried.
    Tried {
        /// What solves the problem once it is made semidefinite.
        semidefinite: Option<Solved>,
        /// The least tolerance (`settings.tolerance`) with which it is solved as it is, of those that were tried.
        tolerance: Option<(f64, Solved)>,
    },
}

/// A consistent state, and what found it.
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    /// What found it.
    pub by: Strategy,
    /// The state.
    pub answer: Answer,
    /// The same assumption in the matrix as it is given; `None` where its equations are singular.
    pub as_given: Option<Answer>,
}

/// Looks at a problem's compliance. `None` where no eigenvalue is negative, where there is no compliance, or where there are
/// too many nodes.
pub fn indefinite(problem: &InterfaceProblem, stop: &dyn Fn() -> bool) -> Option<Indefinite> {
    if problem.nodes.len() > MOST {
        return None;
    }
    let compliance = Compliance::of(problem)?;
    let [least, largest] = compliance.ends();
    if least >= -compliance.round_off() {
        return None;
    }
    let came = |came| {
        Some(Indefinite {
            ends: [least, largest],
            came,
        })
    };
    if -least > SMALL * largest {
        return came(Came::NotByRounding);
    }
    if let Some((by, _)) = solved(problem, OBEYED, stop) {
        return came(Came::SolvedAsItIs(by));
    }
    // What is as small as the negative one is zero, too.
    let without = compliance.raised(-least, 0.0);
    let semidefinite = without.and_then(|raised| {
        let (by, answer) = solved(&raised, OBEYED, stop)?;
        let as_given = as_given(problem, &answer);
        Some(Solved {
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
        let (by, answer) = solved(&coarse, tolerance, stop)?;
        let as_given = Some(answer.clone());
        let solved = Solved {
            by,
            answer,
            as_given,
        };
        Some((tolerance, solved))
    });
    came(Came::Tried {
        semidefinite,
        tolerance,
    })
}

/// The same assumption in another problem.
fn as_given(problem: &InterfaceProblem, answer: &Answer) -> Option<Answer> {
    let assumed: Vec<Assumed> = answer.nodes.iter().map(|node| node.assumed).collect();
    Trials::new(problem)?.answer(&assumed)
}

/// A state that obeys up to a tolerance, and which rung of the ladder finds it.
fn solved(
    problem: &InterfaceProblem,
    tolerance: f64,
    stop: &dyn Fn() -> bool,
) -> Option<(Strategy, Answer)> {
    let mut of_ladder = problem.clone();
    of_ladder.settings.strategy = Strategy::Ladder;
    let rungs = rungs(Strategy::Ladder);
    rungs.iter().enumerate().find_map(|(rung, &strategy)| {
        if stop() {
            return None;
        }
        let mut problem = of_ladder.clone();
        problem.settings = in_force(&of_ladder.settings, rung);
        let found = match strategy {
            // What they find, if anything, is what the run says; here forces are to be unique.
            Strategy::Copositive | Strategy::GaussSeidel => return None,
            Strategy::Lemke => by_pivoting(&problem, tolerance),
            Strategy::Census => {
                let found = search(&problem, BRANCHES, stop).ok()?;
                found.answers.into_iter().next().map(|state| state.answer)
            }
            _ => by_iterations(&problem),
        };
        found
            .filter(|answer| answer.obeys(tolerance))
            .map(|answer| (strategy, answer))
    })
}

/// Where the minor iterations settle.
fn by_iterations(problem: &InterfaceProblem) -> Option<Answer> {
    let mut nodes = problem.states();
    let mut trials = Trials::new(problem)?;
    let method = method(problem.settings.strategy);
    for _ in 0..problem.settings.minors.min(MINORS) {
        let (records, settled) = trials.minor(&mut nodes, method)?;
        if settled {
            let of = records.iter().zip(&problem.nodes).map(|(record, node)| {
                let assumed = Assumed::of(record.decision.next, record.t_max_used);
                match node.choices().contains(&assumed) {
                    true => assumed,
                    false => Assumed::of(record.decision.next, 1.0),
                }
            });
            return trials.answer(&of.collect::<Vec<_>>());
        }
    }
    None
}

/// Where pivoting ends.
fn by_pivoting(problem: &InterfaceProblem, tolerance: f64) -> Option<Answer> {
    let brought = problem.nodes.iter().map(|node| {
        let state = &node.state;
        Assumed::of(state.mode, state.t_max)
    });
    let brought: Vec<Assumed> = brought.collect();
    let mut trials = Trials::new(problem)?;
    (0..STARTS).find_map(|start| {
        let mut path = Lemke::new(problem, &brought, start)?;
        while path.ended().is_none() {
            path.pivot()?;
        }
        let found = path.ended() == Some(PathEnd::Solved);
        let assumed: Vec<Assumed> = (0..brought.len()).map(|k| path.assumed(k)).collect();
        let answer = found.then(|| trials.answer(&assumed)).flatten()?;
        answer.obeys(tolerance).then_some(answer)
    })
}

/// What was found, in words, most important first.
pub fn words<'a>(found: &Indefinite, name: &impl Fn(usize) -> &'a str) -> Vec<String> {
    let [least, largest] = found.ends;
    let head = format!(
        "W, the compliance of the interface, has an eigenvalue of {} ({} of the largest)",
        four(least),
        four(-least / largest)
    );
    let (semidefinite, tolerance) = match &found.came {
        Came::NotByRounding => {
            return vec![format!(
                "{head}: it is indefinite, and not by rounding; some forces move their points against them"
            )];
        }
        Came::SolvedAsItIs(by) => {
            return vec![format!(
                "{head}: it is indefinite, perhaps by rounding; strategy {} solves it all the same",
                by.name()
            )];
        }
        Came::Tried {
            semidefinite,
            tolerance,
        } => (semidefinite, tolerance),
    };
    let coarsest = format!("1e{COARSEST}");
    if semidefinite.is_none() && tolerance.is_none() {
        return vec![format!(
            "{head}: it is indefinite, perhaps by rounding of its entries; made semidefinite it is not solved either, nor \
             with settings.tolerance up to {coarsest}"
        )];
    }
    let mut lines = vec![format!(
        "why: {head}: it is indefinite, perhaps by rounding of its entries"
    )];
    lines.push(match tolerance {
        Some((tolerance, solved)) => format!(
            "what would help: with settings.tolerance={tolerance:e} this frozen problem is solved as it is, by strategy {}: {}",
            solved.by.name(),
            does(&solved.answer, name)
        ),
        None => format!("  with settings.tolerance up to {coarsest} it is not solved"),
    });
    lines.push(match semidefinite {
        Some(solved) => format!(
            "what would help: made semidefinite, as more digits of W may make it, it is solved by strategy {}: {}; {}",
            solved.by.name(),
            does(&solved.answer, name),
            in_given(solved, name)
        ),
        None => "  made semidefinite it is not solved".into(),
    });
    lines
}

/// What a state is in the matrix as it is given.
fn in_given<'a>(solved: &Solved, name: &impl Fn(usize) -> &'a str) -> String {
    let worst = |answer: &Answer| answer.worst().filter(|_| !answer.obeys(OBEYED));
    match &solved.as_given {
        None => "in W as it is its equations are singular".to_owned(),
        Some(answer) => match worst(answer) {
            None => "in W as it is that state obeys, too".to_owned(),
            Some((place, margin)) => format!(
                "in W as it is that state breaks \"{}\" at {} by {}",
                condition_words(margin.condition),
                name(place),
                four(-margin.value)
            ),
        },
    }
}

/// What the nodes do, a letter each; by name where they are few.
fn does<'a>(answer: &Answer, name: &impl Fn(usize) -> &'a str) -> String {
    if answer.nodes.len() > MOST_NAMED {
        return answer.letters();
    }
    let nodes = answer.nodes.iter().enumerate();
    let words = nodes.map(|(place, node)| format!("{} {}", name(place), answer_words(node)));
    words.collect::<Vec<_>>().join(", ")
}
