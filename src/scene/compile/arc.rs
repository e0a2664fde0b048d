//! Compiles the arc-length settings.

use super::super::nodes::Names;
use super::monitors::slave_number;
use crate::Spec;
use crate::format::error::{Fault, Path, at, bail, fault, some_of};
use stickslip_core::model::{
    ArcLength, ArcMeasure, Bound, Contact, Control, InitialGaps, LinearSolver, Monitor,
    MonitorQuantity,
};

/// Resolves `history.arc`, and rejects invalid settings.
pub(super) fn arc(
    spec: &Spec,
    names: &Names,
    monitors: &[Monitor],
    slaves: &[Contact],
) -> Result<ArcLength, Fault> {
    let (given, here) = (&spec.history.arc, at!["history", "arc"]);
    let sizes = [
        ("step", given.step),
        ("largest", given.largest),
        ("least", given.least),
        ("length", given.length),
    ];
    for (name, size) in sizes {
        if let Some(size) = size
            && !(size > 0.0 && size.is_finite())
        {
            bail!(
                here.then(name),
                "{name} is {size:?}; it must be a positive number"
            );
        }
    }
    if given.iterations == 0 {
        bail!(
            here.then("iterations"),
            "iterations is 0; it must be at least 1"
        );
    }
    let along = match (given.monitor.as_str(), given.slip.as_str()) {
        ("", "") => ArcMeasure::Displacements,
        (name, "") => ArcMeasure::Dof(displacement(&here.then("monitor"), name, monitors)?),
        ("", name) => ArcMeasure::Slip(slave(&here.then("slip"), name, names, slaves)?),
        _ => {
            bail!(
                here.then("slip"),
                "monitor and slip are both given; the path can follow only one of them"
            );
        }
    };
    let mut bounds = Vec::with_capacity(given.ends.len());
    for (k, end) in given.ends.iter().enumerate() {
        let here = here.then("ends").then(k);
        let dof = displacement(&here.then("monitor"), &end.monitor, monitors)?;
        bounds.push(Bound { dof, at: end.at });
    }
    if spec.history.control != Control::Load {
        follows(spec)?;
    }
    Ok(ArcLength {
        along,
        step: given.step,
        largest: given.largest,
        least: given.least,
        iterations: given.iterations,
        length: given.length,
        bounds,
    })
}

/// Rejects settings that do not work with an unknown load factor.
fn follows(spec: &Spec) -> Result<(), Fault> {
    let settings = at!["settings"];
    if spec.settings.solver == LinearSolver::Augmented {
        bail!(
            settings.then("solver"),
            "control: arc needs the condensed interface: set solver to auto or condensed"
        );
    }
    if spec.settings.initial_gaps == InitialGaps::Ramp {
        bail!(
            settings.then("initial_gaps"),
            "control: arc cannot close gaps over the first leg: set initial_gaps to keep or adjust"
        );
    }
    Ok(())
}

/// The degree of freedom of a displacement monitor.
fn displacement(here: &Path, name: &str, monitors: &[Monitor]) -> Result<usize, Fault> {
    let is_displacement =
        |monitor: &&Monitor| matches!(monitor.of, MonitorQuantity::Displacement { .. });
    match monitors.iter().find(|monitor| monitor.name == name) {
        Some(Monitor {
            of: MonitorQuantity::Displacement { dof },
            ..
        }) => Ok(*dof),
        found => {
            let all = monitors.iter().filter(is_displacement);
            let all = some_of(all.map(|monitor| monitor.name.as_str()));
            let what = match found {
                Some(_) => "does not monitor a displacement",
                None => "is not a monitor",
            };
            Err(fault!(here, "{name:?} {what} (displacements: {all})"))
        }
    }
}

fn slave(here: &Path, name: &str, names: &Names, slaves: &[Contact]) -> Result<usize, Fault> {
    let found = slave_number(here, name, names, slaves)?;
    let bond = &slaves[found].bond;
    if bond.is_tied() || bond.give()[1] > 0.0 {
        bail!(
            here,
            "the slip of node {name:?} cannot be followed, because the node is tied or slips elastically before it slides; use a monitor"
        );
    }
    Ok(found)
}
