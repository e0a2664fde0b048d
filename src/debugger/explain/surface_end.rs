//! A node that gets behind its surface around one of the surface's ends, or slides off it: contact acts only alongside a surface, so
//! the node is inside as soon as it is over the surface again, however small the increment, and off the end nothing carries its force.
//!
//! The last equilibrium shows which nodes are past an end and behind it, or slide outwards at it. The increment is then repeated with
//! such a node held free: if forces balance while the node is inside, or nowhere, the end of the surface ends the path.
//!
//! In accepted states, a node that touched or starts flush with an end may be a little past it: two flush ends move apart as their
//! bodies expand. Nothing presses it there although it would be inside if the surface continued.

use super::majors::slope;
use super::names;
use std::ops::ControlFlow;
use stickslip_core::groups::distinct;
use stickslip_core::plane::{cross, distance, dot, minus, unit};
use stickslip_core::{
    IncrementStart, Intervention, Mode, Model, NodeKinematics, Outcome, RunEnd, SearchBudget,
    SearchMode, Settings, State, Stepper, SurfaceElement, Until,
};
use stickslip_scene::{sig4, sig6};

/// Maximum distance from the end in the last equilibrium, minimum depth behind it, and distance from the end of a node that is at
/// it, relative to the scene's length.
const NEAR: f64 = 0.02;
const DEEP: f64 = 1e-4;
/// Maximum number of nodes tried, and of minor iterations of each trial.
const MOST_NODES: usize = 4;
const MOST_MINORS: u64 = 400;

/// Largest distance past an end and behind it of a node that has slipped off, relative to the last element of the surface.
const SLIPPED: f64 = 0.05;
/// Largest distance along the surface of a node that is flush with its end, relative to the last element.
const FLUSH: f64 = 2e-3;
/// Depths below this part of the scene's length are none.
const NO_DEPTH: f64 = 1e-9;

/// A node that an accepted increment leaves a little past the end of its surface, where it would be inside if the surface continued.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlippedNode {
    /// Number of the contact.
    pub slave: usize,
    /// Number of the surface.
    pub surface: usize,
    /// Distance past the end, along the surface (length).
    pub past: f64,
    /// Whether it is flush with that end before deformation.
    pub is_flush: bool,
}

/// A node near the end of a surface.
struct NearEnd {
    slave: usize,
    surface: usize,
    /// Position of the end.
    at: [f64; 2],
    /// Distance past the end along the surface, and behind it (length).
    past: f64,
    depth: f64,
    /// Whether the node is free, past the end and behind it. Otherwise it slides at the end, or has left the surface in the failed
    /// iterate.
    is_behind: bool,
    /// Whether it slides outwards, so close to the end that a smaller increment does not help.
    slides_off: bool,
}

/// The surfaces behind whose end a slave node is in the last equilibrium, or at whose end it slides there.
pub fn ending(model: &Model, state: &State) -> Vec<usize> {
    let found = near_ends(model, state);
    distinct(found.iter().map(|found| found.surface))
}

/// Describes the node whose way around or off the end of its surface ends the path, and whether it then is inside the body. `None`
/// if there is none, or if interrupted. The stepper's final state is unspecified.
pub fn passed_end(
    stepper: &mut Stepper,
    state: &State,
    is_behind: bool,
    stop: &dyn Fn() -> bool,
) -> Option<(String, bool)> {
    let model = stepper.model().clone();
    let mut near = near_ends(&model, state);
    near.retain(|found| match is_behind {
        true => found.is_behind,
        false => found.slides_off,
    });
    near.sort_by(|a, b| a.past.total_cmp(&b.past));
    near.truncate(MOST_NODES);
    let mut lost = None;
    for found in near {
        match enters(stepper, state, &found, stop) {
            Some(true) => return Some((found.words(&model, state, true), true)),
            Some(false) if !is_behind => {
                lost.get_or_insert((found.words(&model, state, false), false));
            }
            // Another state exists: this end is not what ends the path.
            None if !is_behind => return None,
            _ => {}
        }
    }
    lost
}

impl NearEnd {
    fn words(&self, model: &Model, state: &State, is_inside: bool) -> String {
        let (name, on) = (
            names::slave(model, self.slave),
            &model.surfaces[self.surface].name,
        );
        let ([x, y], load) = (self.at.map(sig4), sig6(state.start.load_factor));
        let does = if self.is_behind {
            format!(
                "gets behind surface {on} around its end at ({x}, {y}), by {}",
                sig4(self.depth)
            )
        } else {
            format!(
                "slides off the end of surface {on} at ({x}, {y}), where it transmits F_n = {}",
                sig4(state.start.nodes[self.slave].f_n)
            )
        };
        let held = match is_inside {
            true => "it is inside the body when forces balance",
            false => "no equilibrium was found",
        };
        format!(
            "limit load: beyond load {load}, {name} {does} (held free, {held}): extend the surface around this end"
        )
    }
}

/// The nodes that are behind an end of a surface that they can touch in the last equilibrium, or slide at that end.
fn near_ends(model: &Model, state: &State) -> Vec<NearEnd> {
    let places = model.places(&state.start.u);
    let mut found = Vec::new();
    for (slave, (contact, node)) in model.contacts.iter().zip(&state.start.nodes).enumerate() {
        for &surface in &contact.surfaces {
            for end in ends(model, surface, &places).into_iter().flatten() {
                let [past, depth] = end.beyond(&places, contact.node);
                let is_free = node.mode == Mode::Free && node.spot.is_none();
                let slides = node.mode == Mode::Sliding
                    && node.spot.is_some_and(|spot| spot.surface == surface);
                let is_behind = is_free && past >= 0.0 && depth > DEEP * model.length;
                let is_at_end = past > -DEEP * model.length;
                let leaves = slides && (is_at_end || state.nodes[slave].spot.is_none());
                if past.abs() < NEAR * model.length && (is_behind || leaves) {
                    found.push(NearEnd {
                        slave,
                        surface,
                        at: places[end.node],
                        past,
                        depth,
                        is_behind,
                        // A slip is positive against the walk.
                        slides_off: slides && is_at_end && node.sign * end.sign < 0.0,
                    });
                }
            }
        }
    }
    found
}

/// The nodes that have slipped off the end of a surface at the end of an accepted increment: free and past the end by a small part
/// of an element, and inside the continued surface. Before that they touched it (`touched`, by slave and surface), or they are flush
/// with that end before deformation.
pub fn slipped_off(
    model: &Model,
    touched: &dyn Fn(usize, usize) -> bool,
    last: &IncrementStart,
) -> Vec<SlippedNode> {
    if model.space.is_some() {
        return Vec::new();
    }
    let is_off = |slave: &usize| {
        let (contact, node) = (&model.contacts[*slave], &last.nodes[*slave]);
        let is_point = !contact.weights.is_empty();
        node.mode == Mode::Free && node.spot.is_none() && !is_point && !contact.bond.is_tied()
    };
    let off: Vec<usize> = (0..model.contacts.len()).filter(is_off).collect();
    if off.is_empty() {
        return Vec::new();
    }
    let start: Vec<[f64; 2]> = model.nodes.iter().map(|node| node.at).collect();
    let (places, unclosed) = (
        model.places(&last.u),
        model.unclosed(last.leg, last.load_factor),
    );
    let mut found = Vec::new();
    for slave in off {
        let contact = &model.contacts[slave];
        let remains = contact.overlap * unclosed + NO_DEPTH * model.length;
        for &surface in &contact.surfaces {
            let [now, was] = [&places, &start].map(|at| ends(model, surface, at));
            let both = now.into_iter().flatten().zip(was.into_iter().flatten());
            found.extend(both.filter_map(|(now, was)| {
                let near = SLIPPED * now.length;
                let [past, depth] = now.beyond(&places, contact.node);
                let [past_at_start, depth_at_start] = was.beyond(&start, contact.node);
                let is_flush =
                    past_at_start.abs() < FLUSH * was.length && depth_at_start.abs() < near;
                let touched = touched(slave, surface);
                let is_off = (0.0..near).contains(&past) && (remains..near).contains(&depth);
                (is_off && (touched || is_flush)).then_some(SlippedNode {
                    slave,
                    surface,
                    past,
                    is_flush,
                })
            }));
        }
    }
    found
}

/// An end of a surface.
struct SurfaceEnd {
    node: usize,
    /// Direction of the walk along the surface there (unit).
    walk: [f64; 2],
    /// Whether the walk ends there: 1, otherwise −1.
    sign: f64,
    /// Length of the element there.
    length: f64,
}

impl SurfaceEnd {
    /// How far a node is past the end along the surface, and behind it (length).
    fn beyond(&self, places: &[[f64; 2]], node: usize) -> [f64; 2] {
        let to = minus(places[node], places[self.node]);
        // The outward normal is on the right of the walk.
        [self.sign * dot(self.walk, to), cross(self.walk, to)]
    }
}

/// The ends of a surface; none of a closed or endless one.
fn ends(model: &Model, surface: usize, places: &[[f64; 2]]) -> Option<[SurfaceEnd; 2]> {
    let chain = &model.surfaces[surface];
    let last = chain.elements.len().checked_sub(1)?;
    let [one, other] = [0, last].map(|element| SurfaceElement::from_surface(chain, element));
    let (start, end) = (*one.first()?, *other.last()?);
    let walk = [slope(one, places, -1.0), slope(other, places, 1.0)];
    let [first, second] = [unit(walk[0])?, unit(walk[1])?];
    let size = |[from, to]: [usize; 2]| distance(places[from], places[to]);
    let sizes = [[start, *one.last()?], [*other.first()?, end]].map(size);
    let end_at = |node, walk, sign, length| SurfaceEnd {
        node,
        walk,
        sign,
        length,
    };
    let ends = [
        end_at(start, first, -1.0, sizes[0]),
        end_at(end, second, 1.0, sizes[1]),
    ];
    (start != end && !chain.endless).then_some(ends)
}

/// Whether forces balance during the increment, with the node held free, while the node is behind the surface. `None` if interrupted,
/// if another state is found, or if the budget ends.
fn enters(
    stepper: &mut Stepper,
    state: &State,
    found: &NearEnd,
    stop: &dyn Fn() -> bool,
) -> Option<bool> {
    let (slave, mode) = (found.slave, Mode::Free);
    let settings = Settings {
        search: SearchBudget::Mode(SearchMode::Off),
        ..state.controls.settings
    };
    let held = Intervention::Force {
        slave,
        mode,
        hold: true,
    };
    stepper.restore(&state.attempt_again());
    let changes = [Intervention::Settings(settings), held];
    if changes
        .iter()
        .any(|change| stepper.intervene(change).is_err())
    {
        return None;
    }
    let until = Until::end().minors(MOST_MINORS).interrupted_by(stop);
    let end = stepper.drive(until, |stepper| {
        if let Outcome::Increment { jumped: true, .. } = stepper.event().outcome {
            return ControlFlow::Break(false);
        }
        let balanced = match &stepper.event().outcome {
            Outcome::Major { after, .. } | Outcome::Increment { after, .. } => {
                after.relative <= after.limit
            }
            _ => false,
        };
        let spot = stepper.state().nodes[slave].spot;
        let over = spot.is_some_and(|spot| spot.surface == found.surface);
        let is_inside = |over: NodeKinematics| over.gap < 0.0;
        if balanced && over && stepper.kinematics(slave).is_some_and(is_inside) {
            ControlFlow::Break(true)
        } else {
            ControlFlow::Continue(())
        }
    });
    match end {
        RunEnd::Stopped(is_inside) => is_inside.then_some(true),
        RunEnd::Failed(_) => Some(false),
        RunEnd::Finished | RunEnd::Spent | RunEnd::Interrupted => None,
    }
}
