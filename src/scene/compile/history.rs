//! The load-factor path and the settings.

use super::super::limits;
use crate::Spec;
use crate::format::error::{Fault, at, bail, fault};
use crate::format::spec::{History, LoadSpec};
use crate::sig4;
use stickslip_core::model::Factor;
use stickslip_core::plane::range;
use stickslip_core::{Body, Control, Settings, Touch, counted};

/// Relative difference of two slopes, up to which they are equal.
const SAME: f64 = 1e-9;

/// Rejects an empty or endless path.
pub(super) fn history(history: &History) -> Result<(), Fault> {
    let History {
        path, increment, ..
    } = history;
    let here = at!["history", "path"];
    if path.len() < 2 {
        bail!(
            here,
            "the path has {}; it needs at least two, e.g. [0, 1]",
            counted(path.len(), "corner")
        );
    }
    for (k, corner) in path.iter().enumerate() {
        limits::finite(&here.then(k), *corner, "the load factor")?;
        if k > 0 && path[k - 1] == *corner {
            bail!(here.then(k), "the corner {corner:?} is repeated");
        }
    }
    let size = at!["history", "increment"];
    limits::finite(&size, *increment, "the increment")?;
    if *increment <= 0.0 {
        bail!(
            size,
            "the increment is {increment:?}; it must be positive, even where the path falls"
        );
    }
    of_legs(history)?;
    let (least, legs) = (history.least(), path.len() - 1);
    let smallest = (0..legs)
        .map(|leg| history.on_leg(leg))
        .fold(f64::INFINITY, f64::min);
    if !(least > 0.0 && least <= smallest) {
        bail!(
            at!["history", "least"],
            "the least increment is {least:?}; it must be positive and at most the increment, {smallest:?}"
        );
    }
    let count = increments(path, |leg| history.on_leg(leg));
    if count > limits::INCREMENTS {
        let message = if history.increments.is_empty() {
            format!(
                "the history would have {} increments of {increment:?}; at most a million are allowed",
                sig4(count)
            )
        } else {
            format!(
                "the history would have {} increments; at most a million are allowed",
                sig4(count)
            )
        };
        return Err(Fault::new(size, message));
    }
    Ok(())
}

/// Rejects increments of legs with the wrong count or an invalid size.
fn of_legs(history: &History) -> Result<(), Fault> {
    let (sizes, legs) = (&history.increments, history.path.len() - 1);
    if sizes.is_empty() {
        return Ok(());
    }
    let here = at!["history", "increments"];
    if sizes.len() != legs {
        bail!(
            here,
            "the list has {}, and the path {}; list one per leg, or leave them out",
            counted(sizes.len(), "increment"),
            counted(legs, "leg")
        );
    }
    if history.control == Control::Arc {
        bail!(
            here,
            "control: arc takes its step sizes from history.arc; leave increments out"
        );
    }
    for (k, size) in sizes.iter().enumerate() {
        limits::finite(&here.then(k), *size, "the increment")?;
        if *size <= 0.0 {
            bail!(
                here.then(k),
                "the increment is {size:?}; it must be positive, even where the path falls"
            );
        }
    }
    Ok(())
}

/// Rejects an amplitude of a prescribed displacement with a bend within the path of an arc, which follows these displacements in
/// proportion to the load factor.
pub(super) fn check_bends(spec: &Spec) -> Result<(), Fault> {
    let History { path, control, .. } = &spec.history;
    if *control != Control::Arc {
        return Ok(());
    }
    let [low, high] = range(path.iter().copied());
    for (k, load) in spec.loads.iter().enumerate() {
        let LoadSpec::Displacement { scale, .. } = load else {
            continue;
        };
        let scale = Factor(scale.clone());
        let slope = |from: f64, to: f64| (scale.at(to) - scale.at(from)) / (to - from);
        let mut points = vec![low];
        points.extend(
            scale
                .0
                .iter()
                .map(|(at, _)| *at)
                .filter(|at| (low..high).contains(at)),
        );
        points.push(high);
        points.dedup();
        let whole = slope(low, high).abs();
        let bend = points.windows(3).find(|at| {
            let [before, after] = [slope(at[0], at[1]), slope(at[1], at[2])];
            (before - after).abs() > SAME * whole.max(before.abs()).max(after.abs())
        });
        if let Some(at) = bend {
            bail!(
                at!["loads", k, "scale"],
                "the amplitude bends at the load factor {}, and control: arc needs displacements in proportion to it; use control: load",
                sig4(at[1])
            );
        }
    }
    Ok(())
}

/// Number of increments along a path: each leg is divided into increments of its size, plus a shorter last one if needed.
pub fn increments(path: &[f64], size: impl Fn(usize) -> f64) -> f64 {
    // A leg of length 1 has exactly ten increments of 0.1, despite round-off.
    const ROUNDING: f64 = 1e-9;
    path.windows(2)
        .enumerate()
        .map(|(leg, pair)| {
            ((pair[1] - pair[0]).abs() / size(leg) * (1.0 - ROUNDING))
                .ceil()
                .max(1.0)
        })
        .sum()
}

/// Rejects invalid memory sizes.
pub(super) fn memory(settings: &Settings) -> Result<(), Fault> {
    match settings.memory {
        Some(memory) if !(memory > 0.0 && memory.is_finite()) => Err(fault!(
            at!["settings", "memory"],
            "the memory is {memory:?}; it must be a positive number of gigabytes"
        )),
        _ => Ok(()),
    }
}

/// Rejects settings that make every solve fail.
pub(super) fn settings(settings: &Settings) -> Result<(), Fault> {
    let here = at!["settings"];
    for (field, value) in [("minors", settings.minors), ("majors", settings.majors)] {
        let what = format!("the limit of {field}");
        limits::count(
            &here.then(field),
            value as usize,
            1..=limits::ITERATIONS as usize,
            &what,
        )?;
    }
    let gap = settings.adjust_gap;
    if !(gap.is_finite() && gap >= 0.0) {
        bail!(
            here.then("adjust_gap"),
            "the gap is {gap:?}; it must not be negative"
        );
    }
    let limit_load = settings.limit_load;
    if !(limit_load > 0.0 && limit_load < 1.0) {
        bail!(
            here.then("limit_load"),
            "limit_load is {limit_load:?}; it must be above 0 and below 1"
        );
    }
    let accuracy = settings.matrix_accuracy;
    if !(0.0..1.0).contains(&accuracy) {
        bail!(
            here.then("matrix_accuracy"),
            "matrix_accuracy is {accuracy:?}; it must be at least 0 and below 1"
        );
    }
    let tolerance = settings.tolerance;
    if tolerance > 0.0 && tolerance <= 1e-2 {
        return Ok(());
    }
    Err(fault!(
        here.then("tolerance"),
        "the tolerance is {tolerance:?}; it must be above 0 and at most 0.01"
    ))
}

/// The settings for the solver, with `touch: auto` resolved for these bodies.
pub(super) fn resolved(settings: &Settings, bodies: &[Body]) -> Settings {
    let touch = match settings.touch {
        Touch::Auto if !bodies.iter().all(Body::is_linear) => Touch::Ratio,
        Touch::Auto => Touch::Start,
        wanted => wanted,
    };
    Settings { touch, ..*settings }
}
