//! Why the major iterations do not converge: a node that alternates across a kink of its surface, modes that
//! the geometry of the next iteration rejects, or slow convergence.

use super::attempt::{Attempt, Major};
use super::cycles::place;
use super::facts::{Fact, Part};
use super::moves_away::furthest;
use super::names::{mode, slave};
use stickslip_core::model::{Geometry, ResidualMethod};
use stickslip_core::plane::{cross, distance, dot};
use stickslip_core::step::major_history::Stop;
use stickslip_core::{
    MajorCycle, Mode, Model, Settings, State, SurfaceElement, SurfacePoint, counted,
};
use stickslip_scene::{first_of, joined, sig2, sig4};

/// Maximum number of cycle members described.
const MOST_NODES: usize = 2;
/// Maximum number of residuals shown.
const MOST_RESIDUALS: usize = 8;
/// Number of major iterations from which a rate is computed.
const OVER: usize = 6;
/// An error that falls by less than this factor in a major iteration does not fall.
const FALLS: f64 = 0.98;
/// Maximum number of major iterations whose changes are listed, and of nodes in each.
const MOST_MAJORS: usize = 8;
const MOST_CHANGES: usize = 3;

/// The kink between two neighbouring elements of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kink {
    /// Turning angle of the surface (degrees), positive if convex, negative if concave.
    pub degrees: f64,
    /// Position of the kink.
    pub at: [f64; 2],
}

impl Kink {
    /// The kink between two elements, each given by surface and element; `None` if they do not meet, or on a
    /// smooth surface.
    pub fn between(
        model: &Model,
        places: &[[f64; 2]],
        a: (usize, usize),
        b: (usize, usize),
    ) -> Option<Kink> {
        let curve = |(surface, element): (usize, usize)| {
            let surface = model.surfaces.get(surface)?;
            let kinked = surface.smooth.is_empty() && element < surface.elements.len();
            kinked.then(|| SurfaceElement::from_surface(surface, element))
        };
        let (one, other) = (curve(a)?, curve(b)?);
        let (before, after) = match () {
            _ if one.last() == other.first() => (one, other),
            _ if other.last() == one.first() => (other, one),
            _ => return None,
        };
        let (u, v) = (slope(before, places, 1.0), slope(after, places, -1.0));
        let turn = cross(u, v).atan2(dot(u, v));
        Some(Kink {
            degrees: turn.to_degrees(),
            at: places[*after.first()?],
        })
    }

    /// Describes the kink.
    fn words(&self) -> String {
        let kind = if self.degrees >= 0.0 {
            "convex"
        } else {
            "concave"
        };
        format!(
            "which meet at ({}, {}) in a {kind} kink of {} degrees",
            sig4(self.at[0]),
            sig4(self.at[1]),
            sig4(self.degrees.abs())
        )
    }
}

/// dx/dξ of an element at ξ.
pub(super) fn slope(element: SurfaceElement<'_>, places: &[[f64; 2]], xi: f64) -> [f64; 2] {
    let shape = element.shape(xi);
    let mut slope = [0.0; 2];
    for (&node, d) in element.nodes.iter().zip(shape.d) {
        slope[0] += d * places[node][0];
        slope[1] += d * places[node][1];
    }
    slope
}

/// Describes where and why the major iterations cycle.
pub fn cycle_words(model: &Model, attempt: &Attempt, round: &MajorCycle) -> Vec<Fact> {
    let from = attempt.majors.len().saturating_sub(round.period as usize);
    let around = &attempt.majors[from..];
    let Some(last) = around.last() else {
        return Vec::new();
    };
    let places = model.places(&last.u);
    let mut lines = Vec::new();
    let mut members: Vec<&(usize, Vec<Stop>)> = round.changing().collect();
    if members.is_empty() {
        members.extend(&round.members);
    }
    for (s, stops) in members.iter().take(MOST_NODES) {
        let Some(contact) = model.contacts.get(*s) else {
            continue;
        };
        let at = places[contact.node];
        let way = moved(model, around, contact.node);
        let name = slave(model, *s);
        let here = format!("({}, {})", sig4(at[0]), sig4(at[1]));
        let of_length = sig4(100.0 * way / model.length);
        let moves = format!(
            "it moves by {}, {of_length} % of the scene's length",
            sig4(way)
        );
        match (hops(stops), switches(stops)) {
            (Some([a, b]), _) => {
                let (one, other) = (place(model, Some(a)), place(model, Some(b)));
                let kink = Kink::between(model, &places, a, b);
                let is_smooth = |surface: usize| {
                    let surface = model.surfaces.get(surface);
                    surface.is_some_and(|surface| !surface.smooth.is_empty())
                };
                let meet = kink
                    .map(|kink| format!(", {}", kink.words()))
                    .unwrap_or_default();
                lines.push(Fact::why(format!(
                    "{name}, now at {here}, alternates between {one} and {other}{meet}; {moves}"
                )));
                lines.push(Fact::why(match kink {
                    Some(kink) if kink.degrees >= 0.0 => format!(
                        "between the elements its normal turns by {} degrees, and its forces with it: on each element they push it across the edge onto the other",
                        sig4(kink.degrees)
                    ),
                    Some(_) => "in a concave corner both sides press on the node, but only one can hold it; it then penetrates the other".to_owned(),
                    None if is_smooth(a.0) && is_smooth(b.0) => "the surface is smooth, but its curvature differs between the elements: the steps from each of them are too long".to_owned(),
                    None => "the two elements do not meet, and from each of them the other one is closer".to_owned(),
                }));
            }
            (None, Some([a, b])) => {
                lines.push(Fact::why(format!(
                    "{name}, now at {here}, alternates between {} and {}; {moves}",
                    mode(a),
                    mode(b)
                )));
                lines.push(Fact::why(format!(
                    "with the geometry and forces that result from {}, Table 2 decides {} in the next major iteration, and vice versa",
                    mode(a),
                    mode(b)
                )));
            }
            (None, None) => {
                lines.push(Fact::why(format!(
                    "{name}, now at {here}, follows the others; {moves}"
                )));
            }
        }
    }
    let shown = members.len().min(MOST_NODES);
    if round.members.len() > shown {
        lines.push(Fact::new(
            Part::Details,
            format!(
                "not shown: {}",
                counted(round.members.len() - shown, "other node")
            ),
        ));
    }
    lines.extend(residuals(attempt));
    lines
}

/// The two elements between which a node alternates, if it does.
fn hops(stops: &[Stop]) -> Option<[(usize, usize); 2]> {
    let mut elements = stops.iter().filter_map(|stop| stop.element);
    let first = elements.next()?;
    let other = elements.find(|element| *element != first)?;
    Some([first, other])
}

/// The two modes between which a node alternates, if it does.
fn switches(stops: &[Stop]) -> Option<[Mode; 2]> {
    let first = stops.first()?.mode;
    let other = stops.iter().find(|stop| stop.mode != first)?.mode;
    Some([first, other])
}

/// The largest distance between two positions of a node in these major iterations.
fn moved(model: &Model, around: &[Major], node: usize) -> f64 {
    let places: Vec<[f64; 2]> = around.iter().map(|m| model.place(&m.u, node)).collect();
    places
        .iter()
        .flat_map(|a| places.iter().map(move |b| (a, b)))
        .map(|(a, b)| distance(*a, *b))
        .fold(0.0, f64::max)
}

/// The last residuals, in one line.
fn residuals(attempt: &Attempt) -> Option<Fact> {
    let errors = attempt.errors();
    let from = errors.len().saturating_sub(MOST_RESIDUALS);
    let shown = joined(errors[from..].iter().map(|&e| sig2(e)), ", ");
    (!shown.is_empty()).then(|| {
        let text = format!(
            "residual after major {} to {}: {}",
            from + 1,
            errors.len(),
            shown
        );
        Fact::new(Part::Rates, text)
    })
}

/// Describes an increment that reached the limit of major iterations: the convergence rate and how many more it
/// would take if the residuals fall one after another, otherwise which nodes change; and what the rate depends on.
pub fn limit_words(model: &Model, settings: &Settings, attempt: &Attempt) -> Vec<Fact> {
    let errors = attempt.errors();
    let mut lines = Vec::new();
    let limit = attempt
        .majors
        .last()
        .map_or(0.0, |m| m.after.limit.max(settings.tolerance));
    match (rate(&errors), errors.last()) {
        (Some(rate), Some(&last)) => lines.push(Fact::why(format!(
            "the residual falls by a factor of {} per major iteration; about {:.0} more would reach {}",
            sig4(rate),
            ((limit / last).ln() / rate.ln()).ceil().max(1.0),
            sig2(limit)
        ))),
        _ => lines.extend(not_falling(model, attempt)),
    }
    lines.extend(residuals(attempt));
    if settings.geometry == Geometry::Frozen {
        lines.push(Fact::new(Part::Rates, "settings.geometry is frozen, so the tangent neglects that normals and projections turn with the motion; with sliding nodes, convergence is linear at best"));
    }
    if settings.residual == ResidualMethod::Accumulate {
        lines.push(Fact::new(Part::Rates, "settings.residual is accumulate, so each linearisation error stays in the contact forces until it is corrected"));
    }
    lines
}

/// Describes major iterations whose residuals do not fall one after another: where the largest one is, and which nodes
/// change in each iteration.
pub fn not_falling(model: &Model, attempt: &Attempt) -> Vec<Fact> {
    let mut facts = Vec::new();
    let (errors, from) = (attempt.errors(), attempt.majors.len().saturating_sub(OVER));
    let last = &errors[from..];
    if last.len() > 1 {
        let least = last.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = last.iter().copied().fold(0.0, f64::max);
        facts.push(Fact::why(format!(
            "the residuals of the last {} major iterations lie between {} and {} and do not fall one after another",
            last.len(),
            sig2(least),
            sig2(largest)
        )));
    }
    if let Some(text) = attempt
        .majors
        .last()
        .and_then(|major| largest(model, major))
    {
        facts.push(Fact::why(text));
    }
    let changes = changes(model, &attempt.majors);
    let shown = &changes[changes.len().saturating_sub(MOST_MAJORS)..];
    if let Some(text) = shown.last() {
        facts.push(Fact::why(format!(
            "last change of modes or elements: {text}"
        )));
    }
    facts.extend(Fact::all(Part::Rates, shown.iter().cloned()));
    facts
}

/// The node and body of the largest residual after a major iteration.
fn largest(model: &Model, major: &Major) -> Option<String> {
    let (node, force) = major.largest?;
    let body = model
        .bodies
        .iter()
        .find(|body| body.nodes.contains(&node))?;
    let [x, y] = model.place(&major.u, node).map(sig4);
    Some(format!(
        "the largest residual is {} at node {} of {} at ({x}, {y})",
        sig4(force),
        model.nodes[node].name,
        body.name
    ))
}

/// The slave nodes that change, one line for each major iteration with changes.
fn changes(model: &Model, majors: &[Major]) -> Vec<String> {
    let pairs = majors.windows(2).enumerate();
    let line = |(k, pair): (usize, &[Major])| {
        let [before, now] = pair else {
            return None;
        };
        let changed = before
            .contacts
            .iter()
            .zip(&now.contacts)
            .enumerate()
            .filter_map(|(s, ((mode_a, on_a), (mode_b, on_b)))| {
                let name = slave(model, s);
                if mode_a != mode_b {
                    return Some(format!("{name} {} → {}", mode(*mode_a), mode(*mode_b)));
                }
                let on = |on: &Option<SurfacePoint>| on.map(|on| (on.surface, on.element));
                (*mode_b != Mode::Free && on(on_a) != on(on_b))
                    .then(|| format!("{name} onto {}", place(model, on(on_b))))
            });
        let changed: Vec<String> = changed.collect();
        let text = first_of(changed, MOST_CHANGES, ", ");
        (!text.is_empty()).then(|| format!("major {}: {text}", k + 2))
    };
    pairs.filter_map(line).collect()
}

/// Describes divergence: the node that moved furthest, and the errors.
pub fn flight_words(model: &Model, state: &State, attempt: &Attempt) -> Vec<Fact> {
    let place = furthest(model, &state.start.u, &state.u).map(|(node, way)| {
        Fact::why(format!(
            "{} moved furthest from the last equilibrium, by {} (scene length {})",
            model.nodes[node].name,
            sig4(way),
            sig4(model.length)
        ))
    });
    let mut lines: Vec<Fact> = place.into_iter().collect();
    lines.push(Fact::why("the tangent at the last equilibrium points far away from the next one: the load is close to the limit load, or the increment is too large for the curvature of the path"));
    lines.extend(residuals(attempt));
    lines
}

/// Convergence factor over the last few errors; `None` if there are too few, or if they do not fall one after another.
pub fn rate(errors: &[f64]) -> Option<f64> {
    let last = errors.len().checked_sub(1)?;
    let from = last.saturating_sub(OVER);
    let steps = last - from;
    let falls = errors[from..]
        .windows(2)
        .all(|pair| pair[1] < FALLS * pair[0]);
    let fallen = errors[last] / errors[from];
    (steps >= 2 && falls && fallen > 0.0).then(|| fallen.powf(1.0 / steps as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_matches_a_geometric_sequence_and_needs_three_numbers_that_fall() {
        let errors: Vec<f64> = (0..12).map(|k| 3.0 * 0.83_f64.powi(k)).collect();
        let found = rate(&errors).expect("there are enough");
        assert!((found - 0.83).abs() < 1e-12, "{found}");
        assert_eq!(rate(&errors[..2]), None);
        assert_eq!(rate(&[1.0, f64::NAN, f64::NAN]), None);
        // Residuals that hop have no rate, even if the last one is the smallest.
        assert_eq!(rate(&[1e-2, 1e-4, 8e-3, 2e-4, 5e-3, 1e-5]), None);
    }
}
