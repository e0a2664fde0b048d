//! The report of a finished run: cuts and their causes, jumps, loss of stability, bodies that moved without a force or overlap, the
//! worst element, and the increments with the most iterations and the longest time.

use super::frame::Frame;
use super::strip::{PointKind, Strip};
use crate::explain::facts::{Fact, Part};
use crate::explain::headline::brief;
use crate::explain::judged;
use crate::explain::strain;
use crate::explain::unforced::PlaceLog;
use stickslip_core::fem::deformation::deformation;
use stickslip_core::words::noun_for;
use stickslip_core::{Model, Outcome, counted};
use stickslip_scene::{first_of, joined, shortest, sig4};

/// Maximum number of cuts, loads and increments listed.
const MOST: usize = 4;
/// Shortest time of an increment that is listed (s).
const SLOW: f32 = 1.0;

/// Cost of an accepted increment, with its failed attempts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct IncrementCost {
    increment: u32,
    load: f64,
    minors: u32,
    seconds: f32,
}

/// One line on the whole run, and the report.
pub fn run_report(model: &Model, strips: &[Strip], frames: &[Frame]) -> (String, Vec<Fact>) {
    let costs = costs(strips);
    let minors: u32 = costs.iter().map(|cost| cost.minors).sum();
    let load = costs.last().map_or(0.0, |cost| cost.load);
    let head = format!(
        "The history is complete: {} to load {}, {}.",
        counted(costs.len(), "increment"),
        shortest(load),
        counted(minors, "minor iteration")
    );
    let mut lines = cuts(model, strips, frames);
    let loads = |is: &dyn Fn(&Strip, &Frame) -> bool| {
        let loads: Vec<String> = strips
            .iter()
            .zip(frames)
            .filter(|(strip, frame)| is(strip, frame))
            .map(|(strip, _)| shortest(strip.load_factor))
            .collect();
        (!loads.is_empty()).then(|| first_of(loads, MOST, ", "))
    };
    let jumped =
        |strip: &Strip, _: &Frame| matches!(strip.kind, PointKind::Jumped | PointKind::LastJumped);
    let unstable = |_: &Strip, frame: &Frame| {
        let outcome = frame.event.as_ref().map(|event| &event.outcome);
        matches!(
            outcome,
            Some(Outcome::Increment {
                unstable: Some(_),
                ..
            })
        )
    };
    lines.extend(against_a_law(model, strips, frames));
    lines.extend(loads(&jumped).map(|loads| format!("jumps to another branch at load {loads}")));
    lines.extend(loads(&unstable).map(|loads| format!("becomes unstable at load {loads}")));
    if let Some(last) = frames.last() {
        lines.extend(unforced(strips).warnings(model, &last.state.start));
    }
    lines.extend(worst_element(model, frames));
    lines.extend(most("most iterations", &costs, |cost| {
        (cost.minors as f32, format!("{} minor", cost.minors))
    }));
    let slow: Vec<IncrementCost> = costs.into_iter().filter(|c| c.seconds >= SLOW).collect();
    lines.extend(most("slowest", &slow, |cost| {
        (cost.seconds, format!("{:.1} s", cost.seconds))
    }));
    (head, Fact::all(Part::Report, lines))
}

/// The accepted increments whose states break a law, as far as their events are still in memory, with the first finding.
fn against_a_law(model: &Model, strips: &[Strip], frames: &[Frame]) -> Option<String> {
    let found = strips.iter().zip(frames).filter_map(|(strip, frame)| {
        match &frame.event.as_ref()?.outcome {
            Outcome::Increment {
                marked: Some(found),
                ..
            } => Some((strip.load_factor, found)),
            _ => None,
        }
    });
    let (_, first) = found.clone().next()?;
    let loads = first_of(found.map(|(load, _)| shortest(load)), MOST, ", ");
    let finding = judged::finding(model, first);
    Some(format!(
        "states that break a law at load {loads}; first: {finding}"
    ))
}

/// The motions without a force on a line.
pub fn unforced(strips: &[Strip]) -> PlaceLog {
    let mut log = PlaceLog::default();
    for strip in strips {
        log.add(strip.position.increment, strip.load_factor, &strip.unforced);
    }
    log
}

/// The cost of each accepted increment.
fn costs(strips: &[Strip]) -> Vec<IncrementCost> {
    let mut all = Vec::new();
    let mut cost = IncrementCost::default();
    for strip in strips.iter().filter(|strip| strip.kind.is_solved()) {
        cost.minors += 1;
        cost.seconds += strip.seconds;
        if strip.kind.is_accepted() {
            (cost.increment, cost.load) = (strip.position.increment, strip.load_factor);
            all.push(std::mem::take(&mut cost));
        }
    }
    all
}

/// The cuts, with their causes where they are still in memory.
fn cuts(model: &Model, strips: &[Strip], frames: &[Frame]) -> Vec<String> {
    let is_cut = |strip: &Strip| strip.kind == PointKind::Cut;
    let count = strips.iter().filter(|strip| is_cut(strip)).count();
    if count == 0 {
        return vec!["no increment was cut".into()];
    }
    let mut lines = vec![format!(
        "{} or other {} of an increment",
        counted(count, "cut"),
        noun_for(&count, "restart")
    )];
    let causes = strips
        .iter()
        .zip(frames)
        .filter(|(strip, _)| is_cut(strip))
        .filter_map(|(strip, frame)| {
            let why = match &frame.event.as_ref()?.outcome {
                Outcome::Cut { why, .. } | Outcome::WholeIncrement { why, .. } => why,
                Outcome::PathCorner { why, .. } | Outcome::Fallback { why, .. } => why,
                _ => return None,
            };
            let increment = strip.position.increment;
            let load = shortest(strip.load_factor);
            Some(format!(
                "  increment {increment}, load {load}: {}",
                brief(model, why)
            ))
        });
    lines.extend(causes.take(MOST));
    lines
}

/// The element with the worst deformation at the end.
fn worst_element(model: &Model, frames: &[Frame]) -> Option<String> {
    let frame = frames.last().filter(|frame| frame.is_whole())?;
    let found = deformation(model, &frame.state.u)?;
    if let Some(point) = found.outside {
        return Some(strain::outside(model, &point));
    }
    let point = found.smallest;
    let element = strain::element(model, &point);
    Some(format!(
        "worst element: {element}, smallest principal stretch {}",
        sig4(point.stretch)
    ))
}

/// The increments with the largest values.
fn most(
    what: &str,
    costs: &[IncrementCost],
    of: impl Fn(&IncrementCost) -> (f32, String),
) -> Option<String> {
    let mut costs = costs.to_vec();
    costs.sort_by(|a, b| of(b).0.total_cmp(&of(a).0));
    let words = |cost: &IncrementCost| {
        let (increment, load) = (cost.increment, shortest(cost.load));
        format!("increment {increment} at load {load} ({})", of(cost).1)
    };
    let words = joined(costs.iter().take(MOST).map(words), ", ");
    (!words.is_empty()).then(|| format!("{what}: {words}"))
}
