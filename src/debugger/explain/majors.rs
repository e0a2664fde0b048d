//! Why the major iterations do not come to an end: a node that hops to and fro over a kink of its surface, modes that the
//! geometry of each of them rejects, or convergence that is slow.

use super::attempt::{Attempt, Major};
use super::names::{mode, slave};
use super::report::place;
use stickslip_core::contact::element::Element;
use stickslip_core::model::{Geometry, Mode, Model, ResidualMethod, Settings};
use stickslip_core::step::major_history::{MajorCycle, Stop};
use stickslip_core::step::state::State;
use stickslip_scene::number::four;

/// Most nodes of a cycle that are told one by one.
const MOST_NODES: usize = 2;
/// Most residuals that are shown.
const MOST_RESIDUALS: usize = 8;
/// Major iterations over which a rate is taken.
const OVER: usize = 6;
/// An error that falls by less than this factor in a major iteration does not fall.
const FALLS: f64 = 0.98;

/// The corner in which two neighbouring elements of a surface meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kink {
    /// By how much the surface turns there (degrees): positive where it is convex, negative where it is concave.
    pub degrees: f64,
    /// Where they meet.
    pub at: [f64; 2],
}

impl Kink {
    /// Between two elements, each by surface and element; `None` where they do not meet, and on a smooth surface.
    pub fn between(
        model: &Model,
        places: &[[f64; 2]],
        a: (usize, usize),
        b: (usize, usize),
    ) -> Option<Kink> {
        let curve = |(surface, element): (usize, usize)| {
            let surface = model.surfaces.get(surface)?;
            let kinked = surface.smooth.is_empty() && element < surface.elements.len();
            kinked.then(|| Element::of(surface, element))
        };
        let (one, other) = (curve(a)?, curve(b)?);
        let (before, after) = match () {
            _ if one.last() == other.first() => (one, other),
            _ if other.last() == one.first() => (other, one),
            _ => return None,
        };
        let (u, v) = (slope(before, places, 1.0), slope(after, places, -1.0));
        let turn = (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]);
        Some(Kink {
            degrees: turn.to_degrees(),
            at: places[*after.first()?],
        })
    }

    /// In words.
    fn words(&self) -> String {
        let kind = if self.degrees >= 0.0 {
            "convex"
        } else {
            "concave"
        };
        format!(
            "which meet at ({}, {}) in a {kind} kink of {} degrees",
            four(self.at[0]),
            four(self.at[1]),
            four(self.degrees.abs())
        )
    }
}

/// dx/dξ of an element at ξ.
fn slope(element: Element<'_>, places: &[[f64; 2]], xi: f64) -> [f64; 2] {
    let shape = element.shape(xi);
    let mut slope = [0.0; 2];
    for (&node, d) in element.nodes.iter().zip(shape.d) {
        slope[0] += d * places[node][0];
        slope[1] += d * places[node][1];
    }
    slope
}

/// What can be told of a cycle of major iterations: where, and why.
pub fn cycle_words(model: &Model, attempt: &Attempt, round: &MajorCycle) -> Vec<String> {
    let from = attempt.majors.len().saturating_sub(round.period as usize);
    let around = &attempt.majors[from..];
    let Some(last) = around.last() else {
        return Vec::new();
    };
    let places = model.places(&last.u);
    let mut lines = Vec::new();
    // Those that change come first; where there are any, the others are only carried along by them.
    let changes = |stops: &[Stop]| hops(stops).is_some() || switches(stops).is_some();
    let mut members: Vec<&(usize, Vec<Stop>)> = round.members.iter().collect();
    if members.iter().any(|(_, stops)| changes(stops)) {
        members.retain(|(_, stops)| changes(stops));
    }
    for (s, stops) in members.iter().take(MOST_NODES) {
        let Some(contact) = model.contacts.get(*s) else {
            continue;
        };
        let at = places[contact.node];
        let way = moved(model, around, contact.node);
        let name = slave(model, *s);
        let here = format!("({}, {})", four(at[0]), four(at[1]));
        let of_length = four(100.0 * way / model.length);
        let moves = format!(
            "it moves by {}, {of_length} % of the scene's length",
            four(way)
        );
        match (hops(stops), switches(stops)) {
            (Some([a, b]), _) => {
                let (one, other) = (place(model, Some(a)), place(model, Some(b)));
                let kink = Kink::between(model, &places, a, b);
                let is_smooth = |surface: usize| {
                    let surface = model.surfaces.get(surface);
                    surface.is_some_and(|surface| !surface.smooth.is_empty())
                };
                let meet = kink.map_or(String::new(), |kink| format!(", {}", kink.words()));
                lines.push(format!(
                    "where: {name}, now at {here}, hops between {one} and {other}{meet}; {moves}"
                ));
                lines.push(match kink {
                    Some(kink) if kink.degrees >= 0.0 => format!(
                        "why: from one to the other its normal turns by {} degrees, and its forces with it: on each element they carry it over the edge to the other",
                        four(kink.degrees)
                    ),
                    Some(_) => "why: in a concave corner both sides press on it, and it can be held by one of them only: the other then lets it in".to_owned(),
                    None if is_smooth(a.0) && is_smooth(b.0) => "why: the surface is smooth and its normal the same on both, but its curvature is not: the steps from each of them are too long".to_owned(),
                    None => "why: the two elements do not meet, and from each of them the other one is nearer".to_owned(),
                });
            }
            (None, Some([a, b])) => {
                lines.push(format!(
                    "where: {name}, now at {here}, goes to and fro between {} and {}; {moves}",
                    mode(a),
                    mode(b)
                ));
                lines.push(format!(
                    "why: the geometry and forces to which {} leads make Table 2 want {} in the next major iteration, and the other way round",
                    mode(a),
                    mode(b)
                ));
            }
            (None, None) => {
                lines.push(format!(
                    "where: {name}, now at {here}, is carried along; {moves}"
                ));
            }
        }
    }
    let told = members.len().min(MOST_NODES);
    if round.members.len() > told {
        lines.push(format!(
            "and {} more nodes change, or are carried along",
            round.members.len() - told
        ));
    }
    lines.extend(residuals(attempt));
    lines
}

/// Two elements between which a node goes, if it does.
fn hops(stops: &[Stop]) -> Option<[(usize, usize); 2]> {
    let mut elements = stops.iter().filter_map(|stop| stop.element);
    let first = elements.next()?;
    let other = elements.find(|element| *element != first)?;
    Some([first, other])
}

/// Two modes between which a node goes, if it does.
fn switches(stops: &[Stop]) -> Option<[Mode; 2]> {
    let first = stops.first()?.mode;
    let other = stops.iter().find(|stop| stop.mode != first)?.mode;
    Some([first, other])
}

/// The largest distance between two places that a node has in these major iterations.
fn moved(model: &Model, around: &[Major], node: usize) -> f64 {
    let places: Vec<[f64; 2]> = around.iter().map(|m| model.place(&m.u, node)).collect();
    let pairs = places
        .iter()
        .flat_map(|a| places.iter().map(move |b| (a, b)));
    pairs
        .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))
        .fold(0.0, f64::max)
}

/// The last residuals, a line.
fn residuals(attempt: &Attempt) -> Option<String> {
    let errors = attempt.errors();
    let from = errors.len().saturating_sub(MOST_RESIDUALS);
    let shown: Vec<String> = errors[from..].iter().map(|e| format!("{e:.1e}")).collect();
    (!shown.is_empty()).then(|| {
        format!(
            "residual after major {} to {}: {}",
            from + 1,
            errors.len(),
            shown.join(", ")
        )
    })
}

/// What can be told where the limit of major iterations ended the increment: the rate, how many more it would take, and
/// on what the rate depends.
pub fn limit_words(settings: &Settings, attempt: &Attempt) -> Vec<String> {
    let errors = attempt.errors();
    let mut lines = Vec::new();
    let limit = attempt
        .majors
        .last()
        .map_or(0.0, |m| m.after.limit.max(settings.tolerance));
    if let Some(rate) = rate(&errors)
        && let Some(&last) = errors.last()
    {
        lines.push(match rate < FALLS {
            true => format!(
                "why: an iteration leaves {} of the error of the one before; at this rate about {:.0} more would come to {limit:.1e}",
                four(rate),
                ((limit / last).ln() / rate.ln()).ceil().max(1.0)
            ),
            false => format!(
                "why: the error does not fall (a factor of {} an iteration), so more iterations do not help",
                four(rate)
            ),
        });
    }
    lines.extend(residuals(attempt));
    if settings.geometry == Geometry::Frozen {
        lines.push("what the rate depends on: settings.geometry is frozen, so the tangent does not know that normals and projections turn with the motion, and where nodes slide the iterations converge linearly at best".into());
    }
    if settings.residual == ResidualMethod::Accumulate {
        lines.push("what the rate depends on: settings.residual is accumulate, so the error of every linearisation stays in the contact forces until it is taken back".into());
    }
    lines
}

/// What can be told where the displacements grew out of all bounds: the node that went furthest, and the errors.
pub fn flight_words(model: &Model, state: &State, attempt: &Attempt) -> Vec<String> {
    let way = |node: usize| {
        let (now, then) = (
            model.place(&state.u, node),
            model.place(&state.start.u, node),
        );
        (now[0] - then[0]).hypot(now[1] - then[1])
    };
    let nodes = model.bodies.iter().flat_map(|body| &body.nodes).copied();
    let furthest = nodes.max_by(|a, b| way(*a).total_cmp(&way(*b)));
    let place = furthest.map(|node| {
        format!(
            "where: {} went furthest from the last equilibrium, by {}; the scene is {} long",
            model.nodes[node].name,
            four(way(node)),
            four(model.length)
        )
    });
    let mut lines: Vec<String> = place.into_iter().collect();
    lines.push("why: the tangent at the last equilibrium leads far away from the next one, if there is one near: the load is close to what the structure can bear, or the increment is too large for its curvature".into());
    lines.extend(residuals(attempt));
    lines
}

/// The factor by which errors fall from one to the next, over the last few of them; `None` where there are too few.
pub fn rate(errors: &[f64]) -> Option<f64> {
    let last = errors.len().checked_sub(1)?;
    let from = last.saturating_sub(OVER);
    let steps = last - from;
    let fallen = errors[last] / errors[from];
    (steps >= 2 && fallen.is_finite() && fallen > 0.0).then(|| fallen.powf(1.0 / steps as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_that_of_a_geometric_sequence_and_is_not_told_of_two_numbers() {
        let errors: Vec<f64> = (0..12).map(|k| 3.0 * 0.83_f64.powi(k)).collect();
        let found = rate(&errors).expect("there are enough");
        assert!((found - 0.83).abs() < 1e-12, "{found}");
        assert_eq!(rate(&errors[..2]), None);
        assert_eq!(rate(&[1.0, f64::NAN, f64::NAN]), None);
    }
}
