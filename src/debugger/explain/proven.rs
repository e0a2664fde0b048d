//! What the matrix of a frozen problem proves: that there is at most one consistent state, and the limit of
//! T_max while the modes repeat.

use stickslip_core::interface::census::{Census, MOST_SEARCHED};
use stickslip_core::interface::family::{Family, families};
use stickslip_core::interface::t_max_iteration::{TMaxIteration, TMaxLimit, spiral};
use stickslip_core::interface::uniqueness::{Inapplicable, Uniqueness};
use stickslip_core::strategy::method;
use stickslip_core::{InterfaceProblem, counted};
use stickslip_scene::{first_of, joined, sig4};

/// Number of minor iterations used to follow T_max.
const AHEAD: usize = 200;
/// Maximum number of nodes of a cycle for which T_max is analysed.
const MOST_OF_CYCLE: usize = 64;
/// Factors below this are round-off: T_max reaches its fixed point within one period.
const AT_ONCE: f64 = 1e-9;
/// Maximum number of nodes named.
const MOST_NAMED: usize = 3;

/// What the matrix proves about the number of states; `name` returns the name of a node by index.
pub fn uniqueness_words<'a>(found: Uniqueness, name: &impl Fn(usize) -> &'a str) -> String {
    let why = match found {
        Uniqueness::Unique { spare, carried } => {
            let but = if carried {
                " (except for forces carried by supports)"
            } else {
                ""
            };
            return if spare.is_infinite() {
                format!(
                    "unique for this frozen problem: without friction its matrix allows at most one state{but}"
                )
            } else {
                format!(
                    "unique for this frozen problem: its matrix allows at most one state{but}, \
                     even with tan φ up to {spare:.3} times as large"
                )
            };
        }
        Uniqueness::Unproven { spare } => {
            return format!(
                "the matrix does not prove uniqueness; it would with tan φ {spare:.3} times as large"
            );
        }
        Uniqueness::Not(why) => why,
    };
    let why = match why {
        Inapplicable::Cohesion(place) => {
            format!("{} has cohesion, which it loses when it opens", name(place))
        }
        Inapplicable::Singular => "some forces cause no motion, or a body is unrestrained".into(),
        Inapplicable::Semidefinite(zero) => {
            let are = if zero == 1 { "is" } else { "are" };
            format!(
                "it is singular ({zero} of its eigenvalues {are} 0), so that forces need not be unique"
            )
        }
        Inapplicable::Indefinite => "it is not positive definite".into(),
    };
    format!("the number of states does not follow from the matrix: {why}")
}

/// Families of states that differ only in their forces, one line each.
pub fn family_words<'a>(
    problem: &InterfaceProblem,
    census: &Census,
    name: &impl Fn(usize) -> &'a str,
) -> Vec<String> {
    let words = |family: &Family| {
        let numbers: Vec<String> = family.states.iter().map(|k| (k + 1).to_string()).collect();
        let which = match numbers.as_slice() {
            [one] => format!("state {one} is one of them"),
            many => format!("states {} belong to it", many.join(", ")),
        };
        let forces = family.ranges.iter().map(|&(place, ranges)| {
            let lines = ["F_n", "F_t"]
                .into_iter()
                .zip(ranges)
                .filter(|(_, [low, high])| low < high)
                .map(|(word, [low, high])| format!("{word} {} to {}", end(low), end(high)));
            format!("{} {}", name(place), joined(lines, ", "))
        });
        format!(
            "the forces are not unique, with a family of dimension {} for the same motion ({which}): {}",
            family.dimension,
            first_of(forces, MOST_NAMED, "; ")
        )
    };
    families(problem, census).iter().map(words).collect()
}

fn end(value: f64) -> String {
    match value.is_infinite() {
        true if value < 0.0 => "−∞".into(),
        true => "∞".into(),
        false => sig4(value),
    }
}

/// Message that there are too many nodes for a search.
pub fn too_many(nodes: usize) -> String {
    format!(
        "Consistent states are counted for at most {MOST_SEARCHED} slave nodes; {nodes} can touch."
    )
}

/// The limit of T_max while the modes repeat, in words.
pub fn spiral_words(problem: &InterfaceProblem, spiral: &TMaxIteration) -> String {
    let TMaxIteration { period, radius, .. } = spiral;
    let round = match period {
        1 => "in each iteration".to_owned(),
        _ => format!("in each period of {period} iterations"),
    };
    let more = match spiral.iterations(problem.force) {
        Some(more) => format!(
            "after {} it repeats to 1e-12",
            counted(more, "more iteration")
        ),
        None => "it never repeats".to_owned(),
    };
    let (away, radius_text) = (sig4(spiral.distance), sig4(*radius));
    match spiral.fate {
        TMaxLimit::Cycles if *radius <= AT_ONCE => {
            format!("the modes repeat endlessly, with the same T_max {round}")
        }
        TMaxLimit::Cycles => format!(
            "T_max spirals into the cycle by a factor of {radius_text} {round} ({away} away \
             after {}); {more}, but the modes repeat endlessly",
            counted(spiral.start, "iteration")
        ),
        TMaxLimit::Settles => format!(
            "the modes have settled; T_max converges by a factor of {radius_text} {round} ({away} away after {}); {more}",
            counted(spiral.start, "iteration")
        ),
        TMaxLimit::Diverges => format!(
            "T_max diverges by a factor of {radius_text} {round}: it cannot settle with these modes"
        ),
        TMaxLimit::Passes => "the modes repeat for a while, but will change".to_owned(),
    }
}

/// The limit of T_max in a cycle, in words; empty if it converges at once.
pub fn cycle_words<'a>(
    problem: &InterfaceProblem,
    name: &impl Fn(usize) -> &'a str,
) -> Vec<String> {
    if problem.nodes.len() > MOST_OF_CYCLE {
        return Vec::new();
    }
    match spiral(problem, method(problem.settings.strategy), AHEAD) {
        Some(found) if found.fate != TMaxLimit::Passes && found.radius > AT_ONCE => {
            let mut lines = vec![spiral_words(problem, &found)];
            lines.extend(fixed_words(&found, name));
            lines
        }
        _ => Vec::new(),
    }
}

/// The fixed point of T_max at the first nodes.
fn fixed_words<'a>(found: &TMaxIteration, name: &impl Fn(usize) -> &'a str) -> Option<String> {
    let fixed = found.places.iter().zip(&found.fixed);
    let fixed = fixed.map(|(&place, &t_max)| format!("{} at {}", sig4(t_max), name(place)));
    let text = first_of(fixed, MOST_NAMED, ", ");
    (!text.is_empty()).then(|| format!("  its fixed point: T_max = {text}"))
}

/// The limit of T_max from a problem's states, and its cause, in words; empty if the minor iterations settle soon.
pub fn slow_words<'a>(problem: &InterfaceProblem, name: &impl Fn(usize) -> &'a str) -> Vec<String> {
    let Some(found) = spiral(problem, method(problem.settings.strategy), AHEAD) else {
        return Vec::new();
    };
    let mut lines = vec![spiral_words(problem, &found)];
    if found.radius <= AT_ONCE {
        return lines;
    }
    lines.extend(fixed_words(&found, name));
    let mut factors: Vec<(usize, f64)> = found
        .places
        .iter()
        .filter_map(|&place| Some((place, factor(problem, place)?)))
        .collect();
    factors.sort_by(|a, b| b.1.total_cmp(&a.1));
    lines.extend(factors.iter().take(MOST_NAMED).map(|&(place, factor)| {
        format!(
            "  tan φ |W_nt / W_nn| = {factor:.4} at {} alone",
            name(place)
        )
    }));
    if found.fate == TMaxLimit::Diverges {
        lines.push("  settings.t_max=consistent uses the T_max of the same iteration".into());
    }
    lines
}

/// tan φ |W_nt / W_nn| of a node that slides alone: the factor by which its lagged T_max converges per
/// iteration. W is the compliance of the node with all others frozen. `None` if unknown.
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
