//! How the path of equilibrium is followed.

use super::super::nodes::Names;
use crate::format::error::{Fault, Path, at, some_of};
use crate::format::spec::Spec;
use stickslip_core::model::{
    ArcLength, Bound, Contact, Control, InitialGaps, Measured, Monitor, Solver, Watched,
};

/// Resolves `history.arc`, and refuses what cannot be followed.
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
            let message = format!("{name} is {size:?}; it must be a positive number");
            return Err(Fault::new(here.then(name), message));
        }
    }
    if given.iterations == 0 {
        let message = "the iterations that keep the size are 0; they must be at least 1";
        return Err(Fault::new(here.then("iterations"), message));
    }
    let along = match (given.monitor.as_str(), given.slip.as_str()) {
        ("", "") => Measured::Displacements,
        (name, "") => Measured::Dof(displacement(&here.then("monitor"), name, monitors)?),
        ("", name) => Measured::Slip(slave(&here.then("slip"), name, names, slaves)?),
        _ => {
            let message = "the path is followed by a monitor or by the slip of a node, not by both";
            return Err(Fault::new(here.then("slip"), message));
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

/// Refuses settings that cannot go with a load factor that is an unknown.
fn follows(spec: &Spec) -> Result<(), Fault> {
    let settings = at!["settings"];
    if spec.settings.solver == Solver::Augmented {
        let message = "the path is followed on the condensed interface: solver is auto or condensed with control: arc";
        return Err(Fault::new(settings.then("solver"), message));
    }
    if spec.settings.initial_gaps == InitialGaps::Ramp {
        let message = "gaps that are closed over the first leg go with the load factor as it is given: initial_gaps is keep or adjust with control: arc";
        return Err(Fault::new(settings.then("initial_gaps"), message));
    }
    Ok(())
}

/// The degree of freedom of a displacement's monitor.
fn displacement(here: &Path, name: &str, monitors: &[Monitor]) -> Result<usize, Fault> {
    let is_displacement = |monitor: &&Monitor| matches!(monitor.of, Watched::Displacement { .. });
    match monitors.iter().find(|monitor| monitor.name == name) {
        Some(Monitor {
            of: Watched::Displacement { dof },
            ..
        }) => Ok(*dof),
        found => {
            let all = monitors.iter().filter(is_displacement);
            let all = some_of(all.map(|monitor| monitor.name.as_str()));
            let what = match found {
                Some(_) => "watches no displacement",
                None => "is no monitor",
            };
            let message = format!("{name:?} {what} (displacements: {all})");
            Err(Fault::new(here.clone(), message))
        }
    }
}

fn slave(here: &Path, name: &str, names: &Names, slaves: &[Contact]) -> Result<usize, Fault> {
    let node = names
        .node(name)
        .map_err(|message| Fault::new(here.clone(), message))?;
    let found = slaves.iter().position(|slave| slave.node == node);
    let is_elastic = |slave: &Contact| slave.bond.is_tied() || slave.bond.give()[1] > 0.0;
    if found.is_some_and(|found| is_elastic(&slaves[found])) {
        let message = format!(
            "the slip of node {name:?} cannot be followed, since it is tied, or slips elastically before it slides; take a monitor"
        );
        return Err(Fault::new(here.clone(), message));
    }
    found.ok_or_else(|| {
        let all = slaves.iter().map(|s| names.nodes[s.node].name.as_str());
        let message = format!("node {name:?} is no slave node (slaves: {})", some_of(all));
        Fault::new(here.clone(), message)
    })
}
