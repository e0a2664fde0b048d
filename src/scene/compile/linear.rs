//! Linear bodies: matrices from the file, and springs assembled into a matrix.

use super::super::limits;
use super::super::nodes::Names;
use crate::Spec;
use crate::format::error::{AtPath, Fault, Path, bail, fault};
use crate::format::spec::{Bar, BodySpec};
use std::collections::{BTreeMap, HashMap, HashSet};
use stickslip_core::model::{Factor, Form, Linear, Load, Truss};
use stickslip_core::plane::minus;
use stickslip_core::{Body, BodyKind, Dofs, counted};
use stickslip_exchange::problem::Matrix;

/// A body given by a stiffness or a compliance. The degrees of freedom of a compliance's forces are numbered later, with all
/// others.
pub(super) fn matrix(here: &Path, body: &BodySpec, names: &Names) -> Result<Body, Fault> {
    let BodySpec::Matrix {
        id,
        nodes: list,
        stiffness,
        compliance,
        entries,
        free,
    } = body
    else {
        bail!(here, "the body is not a Matrix");
    };
    let nodes = distinct(&here.then("nodes"), list, names)?;
    let size = 2 * nodes.len();
    if !free.is_empty() {
        sized(&here.then("free"), free, size)?;
    }
    if !entries.is_empty() {
        if !stiffness.is_empty() || !compliance.is_empty() {
            bail!(
                here,
                "the body has a matrix and entries of a compliance; give exactly one"
            );
        }
        return Ok(Body {
            name: id.clone(),
            kind: BodyKind::Linear(sparse(&here.then("entries"), entries, size)?),
            nodes,
        });
    }
    let (key, rows, form) = match (stiffness.is_empty(), compliance.is_empty()) {
        (false, true) => ("stiffness", stiffness, Form::Stiffness),
        (true, false) => (
            "compliance",
            compliance,
            Form::Compliance { first_force: 0 },
        ),
        (given_none, _) => {
            let what = if given_none {
                "neither stiffness nor"
            } else {
                "both stiffness and"
            };
            bail!(here, "the body has {what} compliance; give exactly one");
        }
    };
    square(&here.then(key), rows, size)?;
    let entries = rows.iter().enumerate().flat_map(|(i, row)| {
        let kept = move |(j, _): &(usize, f64)| *j == i;
        row.iter()
            .copied()
            .enumerate()
            .filter(move |entry| kept(entry) || entry.1 != 0.0)
            .map(move |(j, value)| (i, j, value))
    });
    Ok(Body {
        name: id.clone(),
        kind: BodyKind::Linear(Linear {
            form,
            entries: entries.collect(),
            bars: Vec::new(),
        }),
        nodes,
    })
}

/// A compliance from its entries.
fn sparse(here: &Path, entries: &[(usize, usize, f64)], size: usize) -> Result<Linear, Fault> {
    for (k, &(i, j, value)) in entries.iter().enumerate() {
        if i >= size || j >= size {
            bail!(
                here.then(k),
                "the entry is in row {i}, column {j}; they must be 0 to {}",
                size - 1
            );
        }
        number_of_matrix(&here.then(k), value)?;
    }
    let mut whole = Matrix {
        rows: size,
        columns: size,
        entries: entries.to_vec(),
    };
    // The diagonal is stored whole.
    whole.entries.extend((0..size).map(|i| (i, i, 0.0)));
    let mut entries = whole.merged().entries;
    entries.retain(|&(i, j, value)| i == j || value != 0.0);
    Ok(Linear {
        form: Form::Compliance { first_force: 0 },
        entries,
        bars: Vec::new(),
    })
}

/// The nodes of a matrix, each once.
fn distinct(here: &Path, list: &[String], names: &Names) -> Result<Vec<usize>, Fault> {
    let (mut nodes, mut known) = (Vec::new(), HashSet::new());
    for (k, name) in list.iter().enumerate() {
        let fault = |message| Fault::new(here.then(k), message);
        for node in names.nodes(name).map_err(fault)? {
            if !known.insert(node) {
                let name = &names.nodes[node].name;
                return Err(fault(format!("node {name:?} is already in the matrix")));
            }
            nodes.push(node);
        }
    }
    if nodes.is_empty() {
        bail!(here, "the list is empty; name at least one node");
    }
    Ok(nodes)
}

/// Rejects anything but a square matrix of this size.
fn square(here: &Path, rows: &[Vec<f64>], size: usize) -> Result<(), Fault> {
    if rows.len() != size {
        bail!(
            here,
            "the matrix has {}; it must have {size}, one for x and one for y of each node",
            counted(rows.len(), "row")
        );
    }
    rows.iter()
        .enumerate()
        .try_for_each(|(k, row)| sized(&here.then(k), row, size))
}

fn sized(here: &Path, row: &[f64], size: usize) -> Result<(), Fault> {
    if row.len() != size {
        bail!(
            here,
            "the row has {}; it must have {size}",
            counted(row.len(), "number")
        );
    }
    for (k, value) in row.iter().enumerate() {
        number_of_matrix(&here.then(k), *value)?;
    }
    Ok(())
}

fn number_of_matrix(here: &Path, value: f64) -> Result<(), Fault> {
    if value.is_finite() && value.abs() <= limits::STIFFNESS.1 {
        return Ok(());
    }
    Err(fault!(
        here,
        "the entry is {value:?}; it must be a finite number below 1e30"
    ))
}

/// Bars with fixed directions: each adds stiffness · e eᵀ to its nodes, and the negative between them.
pub(super) fn springs(here: &Path, id: &str, bars: &[Bar], names: &Names) -> Result<Body, Fault> {
    if bars.is_empty() {
        bail!(
            here.then("bars"),
            "the list is empty; name at least one bar"
        );
    }
    let (mut nodes, mut known) = (Vec::new(), HashMap::new());
    let mut sums: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    let mut joined = Vec::new();
    for (k, bar) in bars.iter().enumerate() {
        let here = here.then("bars").then(k);
        limits::stiffness(&here.then("stiffness"), bar.stiffness, "the stiffness")?;
        let ends = ends(&here.then("nodes"), bar, names)?;
        let direction = direction(&here, bar, &ends, names)?;
        let numbers: Vec<usize> = ends
            .iter()
            .map(|&n| number(&mut nodes, &mut known, n))
            .collect();
        for (i, &row) in numbers.iter().enumerate() {
            for (j, &column) in numbers.iter().enumerate() {
                let sign = if i == j { 1.0 } else { -1.0 };
                for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let value = sign * bar.stiffness * direction[a] * direction[b];
                    *sums.entry((2 * row + a, 2 * column + b)).or_default() += value;
                }
            }
        }
        if ends.len() == 2 {
            joined.push(ends);
        }
    }
    Ok(Body {
        name: id.to_owned(),
        kind: BodyKind::Linear(Linear {
            form: Form::Stiffness,
            entries: sums.into_iter().map(|((i, j), v)| (i, j, v)).collect(),
            bars: joined,
        }),
        nodes,
    })
}

/// The direction of a bar: its angle, or along the line between its nodes.
fn direction(here: &Path, bar: &Bar, ends: &[usize], names: &Names) -> Result<[f64; 2], Fault> {
    if let Some(angle) = bar.angle {
        limits::finite(&here.then("angle"), angle, "the angle")?;
        let angle = angle.to_radians();
        return Ok([angle.cos(), angle.sin()]);
    }
    let &[a, b] = ends else {
        bail!(here, "a bar from one node to the ground needs an angle");
    };
    along(here, names, a, b)
}

/// The direction from one node to another.
fn along(here: &Path, names: &Names, a: usize, b: usize) -> Result<[f64; 2], Fault> {
    let (a, b) = (&names.nodes[a], &names.nodes[b]);
    let line = minus(b.at, a.at);
    let length = line[0].hypot(line[1]);
    if length == 0.0 {
        bail!(
            here,
            "nodes {:?} and {:?} are at the same position, so the bar has no direction",
            a.name,
            b.name
        );
    }
    Ok(line.map(|x| x / length))
}

/// Bars that rotate with their nodes.
pub(super) fn truss(here: &Path, body: &BodySpec, names: &Names) -> Result<Body, Fault> {
    let BodySpec::Truss {
        id,
        bars,
        EA,
        small,
    } = body
    else {
        bail!(here, "the body is not a Truss");
    };
    limits::stiffness(&here.then("EA"), *EA, "EA")?;
    if bars.is_empty() {
        bail!(
            here.then("bars"),
            "the list is empty; name at least one bar"
        );
    }
    let (mut nodes, mut known, mut joined) = (Vec::new(), HashMap::new(), Vec::new());
    for (k, (a, b)) in bars.iter().enumerate() {
        let here = here.then("bars").then(k);
        let find = |k: usize, name: &str| names.node(name).at(here.then(k));
        let ends = [find(0, a)?, find(1, b)?];
        along(&here, names, ends[0], ends[1])?;
        for end in ends {
            number(&mut nodes, &mut known, end);
        }
        joined.push(ends.to_vec());
    }
    Ok(Body {
        name: id.clone(),
        nodes,
        kind: BodyKind::Truss(Truss {
            bars: joined,
            ea: *EA,
            small: *small,
        }),
    })
}

/// The one or two nodes of a bar.
fn ends(here: &Path, bar: &Bar, names: &Names) -> Result<Vec<usize>, Fault> {
    limits::count(here, bar.nodes.len(), 1..=2, "the number of nodes of a bar")?;
    let mut ends = Vec::with_capacity(2);
    for (k, name) in bar.nodes.iter().enumerate() {
        let fault = |message| Fault::new(here.then(k), message);
        let node = names.node(name).map_err(fault)?;
        if ends.contains(&node) {
            return Err(fault("a bar connects two different nodes".to_owned()));
        }
        ends.push(node);
    }
    Ok(ends)
}

/// The index of a node in a list; a new node is appended.
fn number(nodes: &mut Vec<usize>, known: &mut HashMap<usize, usize>, node: usize) -> usize {
    *known.entry(node).or_insert_with(|| {
        nodes.push(node);
        nodes.len() - 1
    })
}

/// Equivalent loads of the free displacements of matrix bodies: K · free on the nodes, or `free` itself in the equations of a
/// compliance.
pub(super) fn free_motions(spec: &Spec, bodies: &[Body], dofs: &Dofs) -> Vec<Load> {
    let mut loads = Vec::new();
    for (named, body) in spec.bodies.iter().zip(bodies) {
        let (BodySpec::Matrix { free, .. }, BodyKind::Linear(linear)) = (named, &body.kind) else {
            continue;
        };
        if free.is_empty() {
            continue;
        }
        let mut values = vec![0.0; free.len()];
        let first = match linear.form {
            Form::Stiffness => {
                for &(i, j, value) in &linear.entries {
                    values[i] += value * free[j];
                }
                None
            }
            Form::Compliance { first_force } => {
                values.copy_from_slice(free);
                Some(first_force)
            }
        };
        let place = |k: usize| match first {
            Some(first) => first + k,
            None => dofs.first[body.nodes[k / 2]] + k % 2,
        };
        let acting = values.into_iter().enumerate().filter(|(_, v)| *v != 0.0);
        loads.extend(acting.map(|(k, value)| Load {
            dof: place(k),
            value,
            scale: Factor::default(),
            volume: None,
        }));
    }
    loads
}
