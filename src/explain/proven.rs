//! What the matrix of a frozen problem proves, in words: that there is one state at most, and where T_max goes while the
//! modes repeat.

use crate::interface::census::MOST_SEARCHED;
use crate::interface::problem::InterfaceProblem;
use crate::interface::spiral::{Fate, Spiral, spiral};
use crate::interface::uniqueness::{Inapplicable, Uniqueness};
use crate::strategy::method;

/// Minor iterations that are run to see where T_max goes.
const AHEAD: usize = 200;
/// Most nodes whose factors are told.
const MOST_NAMED: usize = 3;

/// What the matrix says of the number of states; `name` names a node by its place.
pub fn uniqueness_words<'a>(found: Uniqueness, name: &impl Fn(usize) -> &'a str) -> String {
    let why = match found {
        Uniqueness::Unique { spare, carried } => {
            let but = if carried {
                " (but for forces that supports carry)"
            } else {
                ""
            };
            return match spare.is_infinite() {
                true => format!(
                    "unique, for this frozen problem: without friction its matrix allows one state at most{but}"
                ),
                false => format!(
                    "unique, for this frozen problem: its matrix allows one state at most{but}, and would with tan φ up to \
                     {spare:.3} times as large"
                ),
            };
        }
        Uniqueness::Unproven { spare } => {
            return format!(
                "the matrix alone does not prove that there is one state at most: it would with tan φ {spare:.3} times as large"
            );
        }
        Uniqueness::Not(why) => why,
    };
    let why = match why {
        Inapplicable::Cohesion(place) => {
            format!("{} has cohesion, which it loses when it opens", name(place))
        }
        Inapplicable::Singular => "some forces move nothing, or nothing holds a body".into(),
        Inapplicable::Indefinite => "it is not positive definite".into(),
    };
    format!("the matrix alone says nothing of how many states there are: {why}")
}

/// More nodes than a search is made over.
pub fn too_many(nodes: usize) -> String {
    format!("States are counted of at most {MOST_SEARCHED} slave nodes, and {nodes} can touch.")
}

/// Where T_max goes while the modes repeat.
pub fn spiral_words(problem: &InterfaceProblem, spiral: &Spiral) -> String {
    let Spiral { period, radius, .. } = spiral;
    let round = match period {
        1 => "an iteration".to_owned(),
        _ => format!("a round of {period} iterations"),
    };
    let more = match spiral.iterations(problem.force) {
        Some(more) => format!("after {more} more iterations it repeats to 1e-12"),
        None => "it never repeats".to_owned(),
    };
    let away = spiral.distance;
    match spiral.fate {
        Fate::Cycles => format!(
            "T_max spirals into the cycle by a factor of {radius:.4} {round} ({away:.3e} away after {} iterations); {more}, \
             but the modes go round for ever",
            spiral.start
        ),
        Fate::Settles => format!(
            "the modes have settled; T_max converges by a factor of {radius:.4} {round} ({away:.3e} away after {} \
             iterations); {more}",
            spiral.start
        ),
        Fate::SwingsApart => format!(
            "T_max swings apart by a factor of {radius:.4} {round}: it cannot settle with these modes"
        ),
        Fate::Passes => "the modes repeat for a while, and will change".to_owned(),
    }
}

/// Where T_max goes from a problem's states, and on what that depends: nothing where the minor iterations soon settle.
pub fn slow_words<'a>(problem: &InterfaceProblem, name: &impl Fn(usize) -> &'a str) -> Vec<String> {
    let Some(found) = spiral(problem, method(problem.settings.strategy), AHEAD) else {
        return Vec::new();
    };
    let mut lines = vec![spiral_words(problem, &found)];
    let factors = found
        .places
        .iter()
        .filter_map(|&place| Some((place, factor(problem, place)?)));
    let mut factors: Vec<(usize, f64)> = factors.collect();
    factors.sort_by(|a, b| b.1.total_cmp(&a.1));
    lines.extend(factors.iter().take(MOST_NAMED).map(|&(place, factor)| {
        format!(
            "  tan φ |W_nt / W_nn| = {factor:.4} at {}, by itself",
            name(place)
        )
    }));
    if found.fate == Fate::SwingsApart {
        lines.push("  settings.t_max=consistent solves with the T_max of this iteration".into());
    }
    lines
}

/// tan φ |W_nt / W_nn| of a node, if it slides alone: the factor by which its lagged T_max converges, an iteration. W is
/// the compliance of the node, all others going on with what they do. `None` where it cannot be told.
pub fn factor(problem: &InterfaceProblem, place: usize) -> Option<f64> {
    let alone = problem.reduced(&[place])?;
    let r = &alone.relation.response;
    let spring = 1.0 / alone.relation.stiffness;
    let size = r[0] * r[3] - r[1] * r[2];
    // W = −(R⁻¹ + 1/k), R = [r0 r2; r1 r3].
    let (w_nn, w_nt) = (-r[3] / size - spring, r[2] / size);
    let factor = (problem.nodes[place].friction.coefficient() * w_nt / w_nn).abs();
    factor.is_finite().then_some(factor)
}
