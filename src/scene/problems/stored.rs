//! Condenses a stiffness stored by CalculiX to the nodes that may touch ([`crate::format::stored`]).
//!
//! Let u be the free unknowns, p the prescribed ones, and H the normals and tangents of the contacts:
//!
//! ```text
//! K_uu u = f − K_up p + H r,    and so    W = Hᵀ K_uu⁻¹ H,    free = Hᵀ (K_uu⁻¹ (f − K_up p) + p)
//! ```
//!
//! If K_uu is singular, because only the contacts support the body, its stiffness at the contacts is used instead of W. That
//! requires both components of each contact to be free.

use super::condense::{NotEliminated, condensed, reduced};
use super::fits;
use crate::SceneError;
use crate::format::condensed::{Contact, Matrix, Problem};
use crate::format::error::{AtPath, Fault, Path, at, bail, fault, quoted};
use crate::format::read;
use crate::format::stored::{RigidContact, Stored};
use crate::scene::placed;
use std::collections::HashMap;
use stickslip_core::plane::max_abs;
use stickslip_exchange::calculix::stiffness::{self, MatrixUnknown};
use stickslip_exchange::problem;
use stickslip_platform::input;

/// Reads such a file and the files it names, and condenses the stiffness.
///
/// # Errors
/// If any of the files has errors.
pub fn read(file: &str, text: &str, memory: Option<f64>) -> Result<Problem, SceneError> {
    let spec: Stored = read::value(file, text, "stored stiffness")?;
    let place = |fault: Fault| placed(file, text, &[], fault);
    let named = |key: &str, name: &str| {
        input::path_in_folder(std::path::Path::new(file), name).map_err(|why| {
            let message = format!("{}: {why}", quoted(name));
            place(Fault::new(at![key], message))
        })
    };
    let unknowns = match &spec.unknowns {
        Some(name) => named("unknowns", name)?,
        None => {
            let name = std::path::Path::new(&spec.stiffness).with_extension("dof");
            named("stiffness", &name.to_string_lossy())?
        }
    };
    let matrix = named("stiffness", &spec.stiffness)?;
    let of = |path: &std::path::Path, broken| read::of_file(&path.display().to_string(), broken);
    let list = stiffness::unknowns(&super::text(&unknowns)?).map_err(|b| of(&unknowns, b))?;
    let stored = super::text(&matrix)?;
    let k = stiffness::matrix(&stored, list.len()).map_err(|b| of(&matrix, b))?;
    drop(stored);
    StoredParts::new(&spec, &list, memory)
        .and_then(|posed| posed.condensed(&k))
        .map_err(place)
}

/// State of an unknown: free, with its number among the free ones, or prescribed, with its value.
#[derive(Clone, Copy)]
enum UnknownState {
    Free(usize),
    Moved(f64),
}

/// The problem without its stiffness.
struct StoredParts<'s> {
    spec: &'s Stored,
    /// State of each unknown.
    known: Vec<UnknownState>,
    /// Number of free unknowns.
    free: usize,
    /// Loads on the free unknowns.
    load: Vec<f64>,
    contacts: Vec<Point<'s>>,
}

/// A contact: its node, the unknowns along x and y, and its surface.
struct Point<'s> {
    node: u64,
    /// Path in the file.
    at: Path,
    unknowns: [Option<usize>; 2],
    /// Unit normal.
    normal: [f64; 2],
    touching: &'s RigidContact,
}

impl<'s> StoredParts<'s> {
    fn new(spec: &'s Stored, list: &[MatrixUnknown], memory: Option<f64>) -> Result<Self, Fault> {
        let numbers = Numbers::new(list)?;
        let mut known: Vec<Option<f64>> = vec![None; list.len()];
        for (k, moved) in spec.moved.iter().enumerate() {
            for (i, &node) in moved.nodes.iter().enumerate() {
                let here = at!["moved", k, "nodes", i];
                let unknowns = numbers.of(node, &here)?;
                for (direction, value) in [moved.x, moved.y].into_iter().enumerate() {
                    let Some(value) = value else { continue };
                    finite(&at!["moved", k, ["x", "y"][direction]], value)?;
                    let unknown = unknowns[direction].ok_or_else(|| {
                        let axis = ["x", "y"][direction];
                        fault!(
                            &here,
                            "node {node} is restrained along {axis} and cannot be moved"
                        )
                    })?;
                    if known[unknown].replace(value).is_some() {
                        bail!(here, "node {node} is moved twice");
                    }
                }
            }
        }
        let mut free = 0;
        let known: Vec<UnknownState> = known
            .into_iter()
            .map(|value| match value {
                Some(value) => UnknownState::Moved(value),
                None => {
                    free += 1;
                    UnknownState::Free(free - 1)
                }
            })
            .collect();
        let mut load = vec![0.0; free];
        for (k, pulled) in spec.loads.iter().enumerate() {
            for (i, &node) in pulled.nodes.iter().enumerate() {
                let unknowns = numbers.of(node, &at!["loads", k, "nodes", i])?;
                for (direction, value) in [pulled.x, pulled.y].into_iter().enumerate() {
                    finite(&at!["loads", k, ["x", "y"][direction]], value)?;
                    // Loads on restrained components go into the support.
                    if let Some(UnknownState::Free(place)) = unknowns[direction].map(|u| known[u]) {
                        load[place] += value;
                    }
                }
            }
        }
        let contacts = points(spec, &numbers)?;
        fits(contacts.len(), memory.or(spec.settings.memory)).at(at!["contacts"])?;
        Ok(StoredParts {
            spec,
            known,
            free,
            load,
            contacts,
        })
    }

    fn condensed(mut self, k: &problem::Matrix) -> Result<Problem, Fault> {
        let mut inner = problem::Matrix {
            rows: self.free,
            columns: self.free,
            entries: Vec::with_capacity(k.entries.len()),
        };
        for &(i, j, value) in &k.entries {
            match (self.known[i], self.known[j]) {
                (UnknownState::Free(i), UnknownState::Free(j)) => inner.entries.push((i, j, value)),
                (UnknownState::Free(i), UnknownState::Moved(by)) => self.load[i] -= value * by,
                (UnknownState::Moved(_), _) => {}
            }
        }
        if inner.entries.is_empty() {
            bail!(Path::default(), "no unknown is free");
        }
        match condensed(&inner, &self.frames(), &self.load, f64::INFINITY) {
            Ok((w, free)) => {
                let moved = self.moved();
                let free = free.iter().zip(moved).map(|(u, p)| u + p).collect();
                Ok(self.problem(Matrix::Compliance(w.dense()), free, &[]))
            }
            Err(NotEliminated::Singular) => self.floating(&inner),
            Err(why) => Err(fault!(at!["stiffness"], "the stiffness {why}")),
        }
    }

    /// The stiffness at the contacts, in their frames, of a body without other supports.
    fn floating(&self, inner: &problem::Matrix) -> Result<Problem, Fault> {
        let mut kept = Vec::with_capacity(2 * self.contacts.len());
        for point in &self.contacts {
            for unknown in point.unknowns {
                let Some(UnknownState::Free(place)) = unknown.map(|u| self.known[u]) else {
                    bail!(
                        &point.at,
                        "the stiffness is singular: only the contacts support the body, but a component of this \
                               node is restrained or moved, so the problem cannot be written as a stiffness at the \
                               contacts"
                    );
                };
                kept.push(place);
            }
        }
        let (s, load) = reduced(inner, &self.load, &kept).map_err(|why| {
            fault!(
                at!["stiffness"],
                "the stiffness without that of the contact nodes {why}"
            )
        })?;
        // Rows and columns from (x, y) to (n, t): n = (c, s), t = (−s, c).
        let onto = |pair: [f64; 2], point: &Point<'_>| {
            let [c, s] = point.normal;
            [c * pair[0] + s * pair[1], c * pair[1] - s * pair[0]]
        };
        let mut rows = s;
        for row in &mut rows {
            for (pair, point) in row.chunks_exact_mut(2).zip(&self.contacts) {
                pair.copy_from_slice(&onto([pair[0], pair[1]], point));
            }
        }
        for (pair, point) in rows.chunks_exact_mut(2).zip(&self.contacts) {
            let [x, y] = pair else { continue };
            for (x, y) in x.iter_mut().zip(y) {
                [*x, *y] = onto([*x, *y], point);
            }
        }
        for i in 0..rows.len() {
            let (above, below) = rows.split_at_mut(i);
            for (j, row) in above.iter_mut().enumerate() {
                let mean = 0.5 * (row[i] + below[0][j]);
                (row[i], below[0][j]) = (mean, mean);
            }
        }
        let load = load.chunks_exact(2).zip(&self.contacts);
        let load: Vec<[f64; 2]> = load.map(|(pair, p)| onto([pair[0], pair[1]], p)).collect();
        Ok(self.problem(Matrix::Stiffness(rows), Vec::new(), &load))
    }

    /// H: a column for the normal and one for the tangent of each contact, over the free unknowns.
    fn frames(&self) -> problem::Matrix {
        let mut entries = Vec::new();
        for (k, point) in self.contacts.iter().enumerate() {
            for (direction, unknown) in point.unknowns.into_iter().enumerate() {
                if let Some(UnknownState::Free(place)) = unknown.map(|u| self.known[u]) {
                    let [n, t] = point.components(direction);
                    entries.extend([(place, 2 * k, n), (place, 2 * k + 1, t)]);
                }
            }
        }
        problem::Matrix {
            rows: self.free,
            columns: 2 * self.contacts.len(),
            entries,
        }
    }

    /// Prescribed displacements of the contacts.
    fn moved(&self) -> Vec<f64> {
        let of = |point: &Point<'_>| {
            let mut pair = [0.0; 2];
            for (direction, unknown) in point.unknowns.into_iter().enumerate() {
                if let Some(UnknownState::Moved(by)) = unknown.map(|u| self.known[u]) {
                    let [n, t] = point.components(direction);
                    pair[0] += n * by;
                    pair[1] += t * by;
                }
            }
            pair
        };
        self.contacts.iter().flat_map(of).collect()
    }

    fn problem(&self, matrix: Matrix, free: Vec<f64>, loads: &[[f64; 2]]) -> Problem {
        let contact = |(k, point): (usize, &Point<'_>)| Contact {
            id: format!("n{}", point.node),
            gap: point.touching.gap,
            friction: point.touching.friction,
            load: loads.get(k).copied().unwrap_or_default(),
            start: point.touching.start,
            ..Contact::default()
        };
        let spec = self.spec;
        let contacts = self.contacts.iter().enumerate().map(contact);
        let moved = spec.moved.iter().flat_map(|moved| [moved.x, moved.y]);
        let gaps = spec.contacts.iter().map(|c| c.gap);
        let largest = max_abs(moved.flatten().chain(gaps));
        Problem {
            about: spec.about.clone(),
            spacing: spec.spacing.or((largest > 0.0).then_some(largest)),
            history: spec.history.clone(),
            settings: spec.settings,
            ..Problem::new(&spec.title, contacts.collect(), matrix, free)
        }
    }
}

impl Point<'_> {
    /// Normal and tangential components of a unit vector along x (0) or y (1).
    fn components(&self, direction: usize) -> [f64; 2] {
        let [c, s] = self.normal;
        [[c, -s], [s, c]][direction]
    }
}

/// The contacts; each node may occur once.
fn points<'s>(spec: &'s Stored, numbers: &Numbers) -> Result<Vec<Point<'s>>, Fault> {
    let mut points: Vec<Point<'s>> = Vec::new();
    let mut known = HashMap::new();
    for (k, touching) in spec.contacts.iter().enumerate() {
        let (x, y) = touching.normal;
        let length = x.hypot(y);
        if !(length > 0.0 && length.is_finite()) {
            bail!(
                at!["contacts", k, "normal"],
                "the normal is ({x:?}, {y:?}); it must be finite and not zero"
            );
        }
        finite(&at!["contacts", k, "gap"], touching.gap)?;
        for (i, &node) in touching.nodes.iter().enumerate() {
            let here = at!["contacts", k, "nodes", i];
            let unknowns = numbers.of(node, &here)?;
            if known.insert(node, ()).is_some() {
                bail!(here, "node {node} is already a contact");
            }
            points.push(Point {
                node,
                at: here,
                unknowns,
                normal: [x / length, y / length],
                touching,
            });
        }
    }
    if points.is_empty() {
        Err(fault!(
            at!["contacts"],
            "no contacts; name at least one node that may touch"
        ))
    } else {
        Ok(points)
    }
}

fn finite(path: &Path, value: f64) -> Result<(), Fault> {
    crate::limits::finite(path, value, "the value")
}

/// Indices of each node's components among the unknowns.
struct Numbers(HashMap<u64, [Option<usize>; 2]>);

impl Numbers {
    fn new(list: &[MatrixUnknown]) -> Result<Self, Fault> {
        let mut numbers: HashMap<u64, [Option<usize>; 2]> = HashMap::new();
        for (place, unknown) in list.iter().enumerate() {
            let of_node = numbers.entry(unknown.node).or_default();
            if of_node[unknown.direction].replace(place).is_some() {
                let (node, direction) = (unknown.node, unknown.direction + 1);
                bail!(
                    at!["unknowns"],
                    "the .dof file lists {node}.{direction} twice"
                );
            }
        }
        Ok(Numbers(numbers))
    }

    fn of(&self, node: u64, here: &Path) -> Result<[Option<usize>; 2], Fault> {
        self.0.get(&node).copied().ok_or_else(|| {
            fault!(here, "node {node} is not in the .dof file: it does not exist in the deck, or both of its components are restrained")
        })
    }
}
