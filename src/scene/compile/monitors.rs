//! Compiles the monitors.

use super::super::limits;
use super::super::nodes::Names;
use super::layout::no_rotation;
use crate::Spec;
use crate::format::error::{AtPath, Fault, Path, at, bail, fault, quoted, some_of};
use crate::format::spec::Quantity;
use std::collections::HashMap;
use stickslip_core::{Contact, Control, Dofs, Monitor, MonitorQuantity};

/// Name of the last monitor of an arc-length history.
const ARC: &str = "arc";

/// Columns that a CSV may have besides the monitors.
const RESERVED: [&str; 9] = [
    "increment",
    "load",
    "majors",
    "minors",
    "jumped",
    "stability",
    "worst_stretch",
    "status",
    "unsettled",
];

/// The monitors with their degrees of freedom and slaves.
pub(super) fn monitors(
    spec: &Spec,
    names: &Names,
    on_body: &[bool],
    dofs: &Dofs,
    slaves: &[Contact],
) -> Result<Vec<Monitor>, Fault> {
    let mut seen = HashMap::new();
    let mut made = Vec::with_capacity(spec.monitors.len());
    for (k, monitor) in spec.monitors.iter().enumerate() {
        let here = at!["monitors", k];
        let name = &monitor.name;
        monitor_name(name).at(here.then("name"))?;
        if let Some(first) = seen.insert(name.as_str(), k) {
            bail!(
                here.then("name"),
                "the name {name:?} is already used by monitors[{first}]"
            );
        }
        let of = watched(&here.then("of"), &monitor.of, names, on_body, dofs, slaves)?;
        made.push(Monitor {
            name: name.clone(),
            of,
        });
    }
    if spec.history.control == Control::Arc {
        if let Some(k) = seen.get(ARC) {
            bail!(
                at!["monitors", *k, "name"],
                "the name {ARC:?} is reserved for the arc length (control: arc); use another name"
            );
        }
        made.push(Monitor {
            name: ARC.to_owned(),
            of: MonitorQuantity::Arc,
        });
    }
    Ok(made)
}

fn monitor_name(name: &str) -> Result<(), String> {
    let shown = quoted(name);
    if name.is_empty() || name.chars().count() > limits::NAME {
        Err(format!(
            "the name {shown} must have 1 to {} characters",
            limits::NAME
        ))
    } else if name.contains([',', '"', '\''])
        || name.chars().any(char::is_control)
        || name.trim() != name
    {
        Err(format!(
            "the name {shown} is the header of a CSV column; it must not contain commas, quotes, line breaks or control characters, or start or end with a space"
        ))
    } else if RESERVED.contains(&name) {
        Err(format!(
            "the name {shown} is a reserved CSV column ({}); use another name",
            RESERVED.join(", ")
        ))
    } else {
        Ok(())
    }
}

fn watched(
    here: &Path,
    quantity: &Quantity,
    names: &Names,
    on_body: &[bool],
    dofs: &Dofs,
    slaves: &[Contact],
) -> Result<MonitorQuantity, Fault> {
    let node_of = |name: &str| names.node(name).at(here.then("node"));
    let dof_of = |node, component| {
        dofs.dof(node, component)
            .ok_or_else(|| Fault::new(here.then("component"), no_rotation(names, node)))
    };
    match quantity {
        Quantity::Displacement { node, component } => Ok(MonitorQuantity::Displacement {
            dof: dof_of(node_of(node)?, *component)?,
        }),
        Quantity::Reaction { node, component } => {
            let node = node_of(node)?;
            let dof = dof_of(node, *component)?;
            let name = &names.nodes[node].name;
            if !on_body[node] {
                bail!(
                    here.then("node"),
                    "node {name:?} belongs to no body and has no support force; use a Contact monitor for forces on slaves"
                );
            }
            if dofs.equation[dof].is_some() {
                bail!(
                    here.then("component"),
                    "{component} of node {name:?} is free and has no reaction; fix it in supports, or use a Displacement monitor"
                );
            }
            Ok(MonitorQuantity::Reaction { dof })
        }
        Quantity::Contact { node, component } => Ok(MonitorQuantity::Contact {
            slaves: slave_numbers(here, node.as_deref(), "contact force", names, slaves)?,
            axis: *component,
        }),
        Quantity::Modes { mode } => Ok(MonitorQuantity::Modes {
            slaves: slave_numbers(here, None, "mode", names, slaves)?,
            mode: *mode,
        }),
        Quantity::Pressure { node } => pressure(here, node.as_deref(), false, names, slaves),
        Quantity::Shear { node } => pressure(here, node.as_deref(), true, names, slaves),
        Quantity::Drift { node } => Ok(MonitorQuantity::Drift {
            slaves: slave_numbers(here, node.as_deref(), "drift", names, slaves)?,
        }),
    }
}

/// Pressure or shear at a slave, or at the one where it is largest.
fn pressure(
    here: &Path,
    name: Option<&str>,
    shear: bool,
    names: &Names,
    slaves: &[Contact],
) -> Result<MonitorQuantity, Fault> {
    let mut found = slave_numbers(here, name, "contact pressure", names, slaves)?;
    found.retain(|&slave| slaves[slave].area.is_some_and(|area| area > 0.0));
    if found.is_empty() {
        bail!(
            here.then("node"),
            "none of these slave nodes has a tributary area, which a pressure needs; give the pair an `area`"
        );
    }
    Ok(MonitorQuantity::Pressure {
        slaves: found,
        shear,
    })
}

/// The slave with that name, or all slaves; `what` names the quantity in errors.
fn slave_numbers(
    here: &Path,
    name: Option<&str>,
    what: &str,
    names: &Names,
    slaves: &[Contact],
) -> Result<Vec<usize>, Fault> {
    match name {
        Some(name) => {
            let here = here.then("node");
            Ok(vec![slave_number(&here, name, names, slaves)?])
        }
        None if slaves.is_empty() => Err(fault!(
            here,
            "the scene has no slave nodes, so there is no {what}"
        )),
        None => Ok((0..slaves.len()).collect()),
    }
}

/// The slave with that name.
pub(super) fn slave_number(
    here: &Path,
    name: &str,
    names: &Names,
    slaves: &[Contact],
) -> Result<usize, Fault> {
    let node = names.node(name).at(here)?;
    slaves
        .iter()
        .position(|slave| slave.node == node)
        .ok_or_else(|| {
            let all = slaves
                .iter()
                .map(|slave| names.nodes[slave.node].name.as_str());
            fault!(
                here,
                "node {name:?} is not a slave node (slaves: {})",
                some_of(all)
            )
        })
}
