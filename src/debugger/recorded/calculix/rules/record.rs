//! Rules on the record of a run: increments that ran out, contacts that chatter, corrections at their cap.

use super::super::run::{CalculixRun, Switching};
use super::numbers::{plain, rounded, rounded_up};
use super::pairs::pair_card;
use super::shape::{DeckShape, PairShape, nearest};
use super::supports::open_at_start;
use std::collections::BTreeSet;
use stickslip_core::RunFinding;
use stickslip_exchange::calculix::cvg::Norms;
use stickslip_exchange::calculix::files::End;
use stickslip_scene::{first_of, shortest, sig4};

/// Increments of a step without INC (CalculiX).
const INCREMENTS: u64 = 100;
/// Switches in one attempt above which a contact chatters.
const CHATTER: usize = 4;
/// Maximum number of contacts named.
const NAMED: usize = 3;
/// Correction in percent that counts as capped.
const CAPPED: f64 = 99.9;

/// A run that ended because the step had no increments left.
pub fn increments_used(run: &CalculixRun, shape: Option<&DeckShape>) -> Option<RunFinding> {
    let last = run.files.attempts.last()?;
    let step = (last.step as usize).checked_sub(1)?;
    let step = shape?.deck.steps.get(step)?;
    let most = step.increments.unwrap_or(INCREMENTS);
    let reached = last.row.map_or(f64::INFINITY, |row| row.step_time);
    let left = step.time.period - reached;
    if last.end != End::Converged || u64::from(last.increment) < most || left <= 1e-6 {
        return None;
    }
    let nlgeom = if step.nlgeom { ", NLGEOM" } else { "" };
    Some(RunFinding {
        rule: "increments used up",
        cause: format!(
            "step {} stopped at its time {} of {} because INC allows {most} increments; the last one converged",
            last.step,
            shortest(reached),
            plain(step.time.period)
        ),
        cure: format!("more increments (line {})", step.place.line),
        lines: format!("*STEP{nlgeom}, INC={}", 10 * most),
    })
}

/// A run without any contact element. If it reached its end, that is all there is to report.
pub fn never_closed(run: &CalculixRun, shape: Option<&DeckShape>) -> Vec<RunFinding> {
    let files = &run.files;
    let is_open = |norms: &Norms| norms.elements == 0;
    if files.iterations.is_empty()
        || !files
            .iterations
            .iter()
            .all(|at| at.norms.as_ref().is_some_and(is_open))
    {
        return Vec::new();
    }
    let known = shape.map(open_at_start).unwrap_or_default();
    if !known.is_empty() {
        // The rules on the deck have said it of a run that failed.
        let complete = shape.is_some_and(|shape| is_complete(run, shape));
        return if complete { known } else { Vec::new() };
    }
    let nearest = shape.and_then(|shape| nearest(shape.pairs.iter()));
    let cause = format!(
        "no contact element was active in any of {} iterations",
        files.iterations.len()
    );
    let Some((shape, (pair, node))) = shape.zip(nearest) else {
        return vec![RunFinding {
            rule: "contact never closed",
            cause,
            cure: "displacements or loads that close the gaps, if the parts should touch".into(),
            lines: String::new(),
        }];
    };
    if node.gap <= 0.0 {
        return Vec::new();
    }
    vec![RunFinding {
        rule: "contact never closed",
        cause: format!(
            "{cause}; the smallest gap at the start is {}, node {} of {}",
            sig4(node.gap),
            shape.deck.nodes[node.node].label,
            pair.name
        ),
        cure: format!(
            "if they should touch, move the slave nodes onto the master (*CONTACT PAIR before line {}), or displace a body \
             by more than the gap",
            shape.deck.pairs[pair.number].place.line
        ),
        lines: pair_card(
            shape,
            pair,
            &format!(", ADJUST={}", plain(rounded_up(node.gap))),
        ),
    }]
}

/// Whether a run reached the end of its last step.
pub fn is_complete(run: &CalculixRun, shape: &DeckShape) -> bool {
    let (last, steps) = (run.files.attempts.last(), &shape.deck.steps);
    last.zip(steps.last()).is_some_and(|(last, step)| {
        let reached = last
            .row
            .is_some_and(|row| row.step_time >= step.time.period * (1.0 - 1e-6));
        ended_converged(run) && last.step as usize == steps.len() && reached
    })
}

/// Did the last attempt converge? Then attempts that were cut on the way did not stop the run.
pub fn ended_converged(run: &CalculixRun) -> bool {
    run.files
        .attempts
        .last()
        .is_some_and(|last| last.end == End::Converged)
}

/// Contacts that open and close in turn, in the last attempt or else in an earlier one: who, where, how often, and against whom.
pub fn chatter(run: &CalculixRun, shape: Option<&DeckShape>) -> Option<RunFinding> {
    if ended_converged(run) {
        return None;
    }
    let attempts = run.files.attempts.len();
    let in_last = |found: &Switching| match found.attempts.last() {
        Some(&(attempt, count)) if attempt + 1 == attempts => (attempt, count),
        _ => (attempts, 0),
    };
    let often = |counted: &dyn Fn(&Switching) -> (usize, usize)| -> Vec<_> {
        run.switching
            .iter()
            .map(|found| (found.slave, counted(found)))
            .filter(|(_, (_, count))| *count >= CHATTER)
            .collect()
    };
    let (mut counted, mut when) = (often(&in_last), "the last attempt".to_owned());
    if counted.is_empty() {
        (counted, when) = (
            often(&Switching::most),
            format!("one of {attempts} attempts"),
        );
    }
    let counts = counted.iter().map(|(_, counts)| *counts);
    let (attempt, count) = counts.max_by_key(|(_, count)| *count)?;
    let slaves = || counted.iter().map(|(slave, _)| *slave);
    let name = |slave: usize| match shape.and_then(|shape| place(run, shape, slave)) {
        Some(at) => format!("{} {at}", run.slave_with_corners(slave)),
        None => run.slave_with_corners(slave),
    };
    let masters = masters(run, attempt, &slaves().collect());
    let softer = shape.and_then(|shape| {
        let pair = slaves()
            .filter_map(|slave| Some(pair_of(run, shape, slave)?.1))
            .next()
            .or(shape.pairs.first())?;
        let line = shape.law(pair).normal_place.line;
        match (shape.stiffness(pair), shape.young(pair)) {
            (Some(stiffness), _) => Some((
                format!("a contact stiffness 10 times smaller (line {line})"),
                plain(rounded(stiffness / 10.0)),
            )),
            (None, Some((young, _))) => Some((
                format!("a stiffness instead of hard contact (line {line})"),
                format!(
                    "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{}",
                    plain(rounded(10.0 * young / pair.sizes[0]))
                ),
            )),
            (None, None) => None,
        }
    });
    let (cure, lines) = softer.unwrap_or((
        "a smaller contact stiffness; its line is in the deck, which is not next to the record"
            .into(),
        String::new(),
    ));
    Some(RunFinding {
        rule: "chattering",
        cause: format!(
            "{} of {} contacts switch {CHATTER} times or more in {when}, up to {count} times in {}: {}; against {masters}",
            counted.len(),
            run.files.slaves.len(),
            run.attempt_name(attempt),
            first_of(slaves().map(name), NAMED, ", ")
        ),
        cure,
        lines,
    })
}

/// The node of a slave, and its pair; a face has its first corner.
fn pair_of<'s>(
    run: &CalculixRun,
    shape: &'s DeckShape,
    slave: usize,
) -> Option<(usize, &'s PairShape)> {
    let label = run.files.slaves[slave].nodes()[0];
    let node = shape
        .deck
        .nodes
        .iter()
        .position(|node| node.label == u64::from(label))?;
    Some((
        node,
        shape
            .pairs
            .iter()
            .find(|pair| pair.nodes.iter().any(|own| own.node == node))?,
    ))
}

/// Where a slave is: its coordinates and its surface.
fn place(run: &CalculixRun, shape: &DeckShape, slave: usize) -> Option<String> {
    let (node, pair) = pair_of(run, shape, slave)?;
    let at = shape.at(node);
    Some(format!(
        "at ({}, {}, {}) of {}",
        sig4(at.x),
        sig4(at.y),
        sig4(at.z),
        pair.name
    ))
}

/// The master faces that some slaves touch in an attempt.
fn masters(run: &CalculixRun, attempt: usize, slaves: &BTreeSet<usize>) -> String {
    let iterations = run.files.attempts[attempt].iterations.clone();
    let closed = iterations.filter_map(|k| run.files.closed(k)).flatten();
    let faces: BTreeSet<u32> = closed
        .filter(|closed| slaves.contains(&(closed.slave as usize)))
        .map(|closed| closed.master)
        .collect();
    let names = faces
        .iter()
        .map(|face| super::super::run::face(&run.files.masters[*face as usize]));
    match faces.len() {
        1 => format!("the master face {}", first_of(names, NAMED, "; ")),
        count => format!("{count} master faces ({})", first_of(names, NAMED, "; ")),
    }
}

/// Attempts whose correction stays at its cap of 100 % while the residual grows.
pub fn capped_correction(run: &CalculixRun, shape: Option<&DeckShape>) -> Option<RunFinding> {
    if ended_converged(run) {
        return None;
    }
    let capped = run
        .files
        .attempts
        .iter()
        .enumerate()
        .filter_map(|(k, attempt)| {
            let norms = attempt
                .iterations
                .clone()
                .skip(1)
                .filter_map(|k| run.norms(k));
            let norms: Vec<_> = norms
                .take_while(|norms| norms.correction >= CAPPED)
                .collect();
            let (from, to) = (norms.first()?.residual, norms.last()?.residual);
            let grows = attempt.end == End::NotConverged && to > from;
            grows.then_some((k, norms.len(), from, to))
        });
    let (attempt, count, from, to) = capped.max_by_key(|capped| capped.1)?;
    let number = run.files.attempts[attempt].step as usize;
    let step = shape.zip(number.checked_sub(1));
    let (cure, lines) = match step.and_then(|(shape, k)| shape.deck.steps.get(k)) {
        Some(step) => {
            let time = step.time;
            let [initial, least] = [10.0, 1e4].map(|part| rounded(time.initial / part));
            (
                format!(
                    "increments 10 times smaller (line {})",
                    step.static_place.line
                ),
                [initial, time.period, least, initial].map(plain).join(", "),
            )
        }
        None => (
            "smaller increments; they are in the deck, which is not next to the record".into(),
            String::new(),
        ),
    };
    Some(RunFinding {
        rule: "capped correction",
        cause: format!(
            "the correction of attempt {} stays at 100 % for {count} iterations while the residual grows from {} % to {} %: \
             it is relative to the increment, which consists of the correction alone, so 100 % means divergence",
            run.attempt_name(attempt),
            sig4(from),
            sig4(to)
        ),
        cure,
        lines,
    })
}
