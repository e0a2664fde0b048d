//! What the matrix of a frozen problem proves, in words: that there is one state at most, and where T_max goes while the
//! modes repeat.

use stickslip_core::interface::census::{Census, MOST_SEARCHED};
use stickslip_core::interface::family::{Family, families};
use stickslip_core::interface::problem::InterfaceProblem;
use stickslip_core::interface::spiral::{Fate, Spiral, spiral};
use stickslip_core::interface::uniqueness::{Inapplicable, Uniqueness};
use stickslip_core::strategy::method;
use stickslip_scene::number::four;

/// Minor iterations that are run to see where T_max goes.
const AHEAD: usize = 200;
/// Most nodes of a cycle of which it is told where T_max goes.
const MOST_OF_CYCLE: usize = 64;
/// Factors below this are round-off: T_max is at its fixed point after one round.
const AT_ONCE: f64 = 1e-9;
/// Most nodes whose factors, or whose T_max, are told.
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
        Inapplicable::Semidefinite(zero) => {
            let are = if zero == 1 { "is" } else { "are" };
            format!(
                "it is singular, {zero} of its eigenvalues {are} 0, so that forces need not be unique"
            )
        }
        Inapplicable::Indefinite => "it is not positive definite".into(),
    };
    format!("the matrix alone says nothing of how many states there are: {why}")
}

/// The families of states that differ in their forces alone, a line each.
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
        let forces = family
            .ranges
            .iter()
            .take(MOST_NAMED)
            .map(|&(place, ranges)| {
                let component = |(word, [low, high]): (&str, [f64; 2])| {
                    (low < high).then(|| format!("{word} {} to {}", end(low), end(high)))
                };
                let both = ["F_n", "F_t"].into_iter().zip(ranges);
                let told: Vec<String> = both.filter_map(component).collect();
                format!("{} {}", name(place), told.join(", "))
            });
        let forces: Vec<String> = forces.collect();
        let more = match family.ranges.len().saturating_sub(MOST_NAMED) {
            0 => String::new(),
            more => format!("; and so on at {more} more"),
        };
        format!(
            "forces are a family of dimension {}: the motions are the same, the forces are not unique ({which}): {}{more}",
            family.dimension,
            forces.join("; ")
        )
    };
    families(problem, census).iter().map(words).collect()
}

fn end(value: f64) -> String {
    match value.is_infinite() {
        true if value < 0.0 => "−∞".into(),
        true => "∞".into(),
        false => four(value),
    }
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
        Fate::Cycles if *radius <= AT_ONCE => {
            format!("the modes go round for ever, {round}, and T_max is the same in each")
        }
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

/// Where T_max goes in a cycle that was found: nothing where it comes to rest at once.
pub fn cycle_words<'a>(
    problem: &InterfaceProblem,
    name: &impl Fn(usize) -> &'a str,
) -> Vec<String> {
    if problem.nodes.len() > MOST_OF_CYCLE {
        return Vec::new();
    }
    match spiral(problem, method(problem.settings.strategy), AHEAD) {
        Some(found) if found.fate != Fate::Passes && found.radius > AT_ONCE => {
            let mut lines = vec![spiral_words(problem, &found)];
            lines.extend(fixed_words(&found, name));
            lines
        }
        _ => Vec::new(),
    }
}

/// T_max at the fixed point, of the first nodes.
fn fixed_words<'a>(found: &Spiral, name: &impl Fn(usize) -> &'a str) -> Option<String> {
    let all = found.places.iter().zip(&found.fixed);
    let told = all
        .take(MOST_NAMED)
        .map(|(&place, t_max)| format!("{t_max:.4e} at {}", name(place)));
    let told = told.collect::<Vec<_>>().join(", ");
    let more = match found.places.len().saturating_sub(MOST_NAMED) {
        0 => String::new(),
        more => format!(", and so on at {more} more"),
    };
    (!told.is_empty()).then(|| format!("  its fixed point: T_max = {told}{more}"))
}

/// Where T_max goes from a problem's states, and on what that depends: nothing where the minor iterations soon settle.
pub fn slow_words<'a>(problem: &InterfaceProblem, name: &impl Fn(usize) -> &'a str) -> Vec<String> {
    let Some(found) = spiral(problem, method(problem.settings.strategy), AHEAD) else {
        return Vec::new();
    };
    let mut lines = vec![spiral_words(problem, &found)];
    if found.radius <= AT_ONCE {
        return lines;
    }
    lines.extend(fixed_words(&found, name));
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
