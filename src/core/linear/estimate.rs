//! Estimates time and memory of both solvers from the size of a scene, before anything is built.
//!
//! Estimates are accurate to a factor of two or three, which is enough to select a solver and to reject scenes that do not fit.
//! They count the entries of the factors and the operations for each body:
//!
//! - a chain of beam elements with f unknowns each: f² entries per element, f³ / 3 operations;
//! - n unknowns of a plane mesh of 8-node quadrilaterals in a good order: entries proportional to n log n, operations to n^1.5;
//! - a dense matrix over d unknowns: d² entries, d³ / 3 operations.
//!
//! The full system is unsymmetric and pivoted: twice the operations and several times the entries; later minor iterations repeat
//! only the part affected by the changes. Condensation adds dense matrices over the interface: over the c displacements of the
//! slave nodes and of all nodes of the surfaces that they may touch, and over the z forces of the slave nodes. With m = c − z,
//! the compliance needs m³ / 3 + m² z operations, and each minor iteration z³ / 3. All constants are measured (README).
//!
//! Contacts with a sparse compliance need memory proportional to its entries, and time proportional to the sweeps over them.

use crate::Model;
use crate::linear::condensation::interface_equations;
use crate::linear::sparse_contacts::sparse_contacts;
use crate::model::{Body, BodyKind, Form, Linear, LinearSolver};
use std::fmt;

/// Bytes per gigabyte in settings and messages.
pub const GIGABYTE: f64 = 1e9;
/// Minimum ratio of the bodies' unknowns to the interface's for condensation to pay off (measured: README).
const MANY_TIMES: usize = 8;
/// Fraction of the full system that a minor iteration factors again, including its solves.
const REPEATED: f64 = 0.15;
/// Minor iterations of a typical major iteration.
const MINORS: f64 = 3.0;
/// Operations per second: of a sparse LDLᵀ, of a sparse LU of a mesh and of a chain, and of dense matrices.
const SYMMETRIC: f64 = 1.6e9;
const MESH: f64 = 1.6e9;
const CHAIN: f64 = 0.7e9;
const DENSE: f64 = 12e9;
/// Entries of a mesh's factors divided by n log2 n, and operations divided by n^1.5, both for LDLᵀ; ratio of LU entries to LDLᵀ
/// entries.
const MESH_ENTRIES: f64 = 10.0;
const MESH_OPERATIONS: f64 = 21.0;
const LU_ENTRIES: f64 = 6.0;
/// Operations of a stability check divided by c³, for c remaining unknowns: products of conditions and stiffness, and a
/// factorization.
const LOOK: f64 = 4.0;
/// Bytes per unknown, including its share of elements, pattern and stiffness, and per entry of a given matrix.
const UNKNOWN: f64 = 2500.0;
const GIVEN: f64 = 180.0;
/// Bytes per contact and per entry of a sparse compliance, from the reader on, and seconds per entry and sweep; a packing needs
/// about as many sweeps as it has contacts.
const SPARSE_CONTACT: f64 = 2800.0;
const SPARSE_ENTRY: f64 = 150.0;
const SPARSE_SWEEP: f64 = 1.2e-9;
/// Number of stored matrices over the interface's displacements, and over its forces, for condensation.
const OVER_DISPLACEMENTS: f64 = 6.0;
const OVER_FORCES: f64 = 4.0;
/// Bytes of the program itself.
const PROGRAM: f64 = 10e6;

/// Time of a major iteration including its minor iterations, and total memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Time of a major iteration including its minor iterations (seconds).
    pub seconds: f64,
    /// Total memory (bytes).
    pub bytes: f64,
}

/// Estimated cost of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// With the augmented system (eqn 9).
    pub augmented: Effort,
    /// With the bodies condensed (eqn 6).
    pub condensed: Effort,
    /// On the entries of a compliance ([`sparse_contacts`]), if the scene is solved so.
    pub sparse: Option<Effort>,
    /// Whether `auto` selects condensation.
    pub condenses: bool,
    /// Cost of a stability check ([`crate::linear::stability`]) in major iterations.
    pub stability: f64,
    /// Memory limit (bytes).
    pub budget: f64,
}

/// Time and entries of a factorization.
#[derive(Debug, Clone, Copy, Default)]
struct Factoring {
    seconds: f64,
    entries: f64,
}

impl Estimate {
    /// Estimates the cost of a scene with these settings.
    pub fn from_model(model: &Model) -> Estimate {
        let budget = model
            .settings
            .memory
            .map_or(model.budget, |size| size * GIGABYTE);
        let mut symmetric = Factoring::default();
        let mut whole = Factoring::default();
        let mut given = 0.0;
        for body in &model.bodies {
            let (one, other) = factoring(body);
            symmetric.add(one);
            whole.add(other);
            if let BodyKind::Linear(linear) = &body.kind {
                given += linear.entries.len() as f64;
            }
        }
        let base = PROGRAM + UNKNOWN * model.dofs.len() as f64 + GIVEN * given;
        let c = interface_equations(model).len() as f64;
        let z = 2.0 * model.contacts.len() as f64;
        let forces = MINORS / 3.0 * z.powi(3) / DENSE;
        let over_forces = 8.0 * OVER_FORCES * z * z;
        let condensed = if condensable(model) {
            let m = (c - z).max(0.0);
            let dense = m.powi(3) / 3.0 + m * m * z;
            Effort {
                seconds: symmetric.seconds + dense / DENSE + forces,
                bytes: 8.0 * (symmetric.entries + OVER_DISPLACEMENTS * c * c + c * z) + over_forces,
            }
        } else {
            let columns = z * 4.0 * whole.entries / DENSE;
            Effort {
                seconds: whole.seconds + columns + forces,
                bytes: 8.0 * whole.entries + over_forces,
            }
        };
        let condensed = Effort {
            bytes: base + condensed.bytes,
            ..condensed
        };
        let augmented = Effort {
            seconds: (1.0 + MINORS * REPEATED) * whole.seconds,
            bytes: base + 8.0 * whole.entries,
        };
        let small = 2 * model.contacts.len() * MANY_TIMES <= model.dofs.equations;
        let pays = small && condensed.seconds <= augmented.seconds;
        let fits = |effort: Effort| effort.bytes <= budget;
        let mut estimate = Estimate {
            augmented,
            condensed,
            sparse: sparse(model),
            condenses: if fits(augmented) {
                pays && fits(condensed)
            } else {
                fits(condensed)
            },
            stability: 0.0,
            budget,
        };
        let (major, _) = estimate.with(model.settings.solver);
        let look = symmetric.seconds + LOOK * dense_unknowns(model, c).powi(3) / SYMMETRIC;
        estimate.stability = look / major.seconds.max(f64::MIN_POSITIVE);
        estimate
    }

    /// Cost and name of a solver.
    pub fn with(&self, solver: LinearSolver) -> (Effort, &'static str) {
        match self.sparse {
            Some(sparse) => (sparse, "sparse"),
            None if self.is_condensed(solver) => (self.condensed, "condensed"),
            None => (self.augmented, "augmented"),
        }
    }

    /// Whether a solver uses condensation.
    pub fn is_condensed(&self, solver: LinearSolver) -> bool {
        match solver {
            _ if self.sparse.is_some() => false,
            LinearSolver::Auto => self.condenses,
            LinearSolver::Augmented => false,
            LinearSolver::Condensed => true,
        }
    }

    /// Why a scene does not fit into memory with a solver; `None` if it does.
    pub fn too_large(&self, solver: LinearSolver) -> Option<TooLarge> {
        let (effort, name) = self.with(solver);
        let other = match solver {
            _ if self.sparse.is_some() => None,
            LinearSolver::Condensed => Some(("augmented", self.augmented.bytes)),
            LinearSolver::Augmented => Some(("condensed", self.condensed.bytes)),
            LinearSolver::Auto => None,
        };
        (effort.bytes > self.budget).then_some(TooLarge {
            bytes: effort.bytes,
            name,
            budget: self.budget,
            other,
        })
    }
}

/// A scene needs more memory than the limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TooLarge {
    /// Required bytes.
    pub bytes: f64,
    /// The solver.
    pub name: &'static str,
    /// Memory limit in bytes.
    pub budget: f64,
    /// The other solver and its required bytes, if that fits.
    pub other: Option<(&'static str, f64)>,
}

impl std::error::Error for TooLarge {}

impl fmt::Display for TooLarge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (takes, may) = (bytes(self.bytes), bytes(self.budget));
        write!(
            f,
            "the scene needs about {takes} of memory ({}); the limit is {may}",
            self.name
        )?;
        if let Some((other, takes)) = self.other {
            write!(f, "; settings.solver={other} needs about {}", bytes(takes))?;
        }
        f.write_str("; a coarser mesh needs less, and settings.memory sets the limit (GB)")
    }
}

impl fmt::Display for Effort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = match self.seconds {
            s if s >= 100.0 => format!("{s:.0} s"),
            s if s >= 1.0 => format!("{s:.1} s"),
            s if s >= 1e-3 => format!("{:.0} ms", s * 1e3),
            _ => "less than 1 ms".to_owned(),
        };
        write!(f, "{seconds} per major iteration, {}", bytes(self.bytes))
    }
}

impl Factoring {
    fn add(&mut self, other: Factoring) {
        self.seconds += other.seconds;
        self.entries += other.entries;
    }
}

/// Cost of a scene that is solved on the entries of a compliance.
fn sparse(model: &Model) -> Option<Effort> {
    let entries = sparse_contacts(model)?.linear.entries.len() as f64;
    let contacts = model.contacts.len() as f64;
    Some(Effort {
        seconds: SPARSE_SWEEP * entries * contacts,
        bytes: sparse_bytes(contacts, entries),
    })
}

/// Memory of a scene that is solved on the entries of a compliance (bytes).
pub fn sparse_bytes(contacts: f64, entries: f64) -> f64 {
    PROGRAM + SPARSE_CONTACT * contacts + SPARSE_ENTRY * entries
}

/// Cost of factoring a body's stiffness by LDLᵀ, and its part of the full system by LU.
fn factoring(body: &Body) -> (Factoring, Factoring) {
    let pair = |operations: f64, rates: [f64; 2], entries: f64, more: f64| {
        let symmetric = Factoring {
            seconds: operations / rates[0],
            entries,
        };
        let whole = Factoring {
            seconds: 2.0 * operations / rates[1],
            entries: more * entries,
        };
        (symmetric, whole)
    };
    match &body.kind {
        BodyKind::Beam(beam) => {
            let elements = beam.elements.len() as f64;
            let nodes = beam.elements.first().map_or(0, Vec::len) as f64;
            let shears = if beam.first_shear.is_some() {
                nodes - 1.0
            } else {
                0.0
            };
            let front = 3.0 * nodes + shears;
            let operations = elements * front.powi(3) / 3.0;
            pair(
                operations,
                [SYMMETRIC, CHAIN],
                elements * front * front,
                2.0,
            )
        }
        BodyKind::Solid(_) | BodyKind::Truss(_) => {
            let unknowns = 2.0 * body.nodes.len() as f64;
            let entries = MESH_ENTRIES * unknowns * unknowns.max(2.0).log2();
            let operations = MESH_OPERATIONS * unknowns.powf(1.5);
            pair(operations, [SYMMETRIC, MESH], entries, LU_ENTRIES)
        }
        BodyKind::Linear(linear) => {
            let twice = if linear.form == Form::Stiffness {
                1.0
            } else {
                2.0
            };
            let unknowns = twice * 2.0 * body.nodes.len() as f64;
            if is_dense(linear, body.nodes.len()) {
                pair(
                    unknowns.powi(3) / 3.0,
                    [DENSE, DENSE],
                    unknowns * unknowns / 2.0,
                    2.0,
                )
            } else {
                let entries = 4.0 * linear.entries.len() as f64;
                pair(16.0 * entries, [SYMMETRIC, CHAIN], entries, 2.0)
            }
        }
    }
}

/// Whether a large fraction of a matrix is nonzero.
fn is_dense(linear: &Linear, nodes: usize) -> bool {
    linear.entries.len() as f64 > (nodes as f64).powi(2)
}

/// Number of unknowns in the dense part of a stability check: `c` of the interface, and all unknowns of bodies that need pivoting.
fn dense_unknowns(model: &Model, c: f64) -> f64 {
    let pivoted = model.bodies.iter().map(|body| match &body.kind {
        BodyKind::Beam(beam) if beam.first_shear.is_some() => {
            let front = beam.elements.first().map_or(0, Vec::len).saturating_sub(1);
            3 * body.nodes.len() + front * beam.elements.len()
        }
        BodyKind::Linear(linear) if linear.form != Form::Stiffness => 4 * body.nodes.len(),
        _ => 0,
    });
    c + pivoted.sum::<usize>() as f64
}

/// Whether all bodies of a scene have a stiffness that can be factored without pivoting. Shear-rigid beams do not, because their
/// shear forces are unknowns of a saddle point; nor do bodies given by a compliance. A given stiffness may be unsymmetric, and
/// that of a following pressure is.
pub fn condensable(model: &Model) -> bool {
    let symmetric = |body: &Body| match &body.kind {
        BodyKind::Beam(beam) => beam.first_shear.is_none(),
        BodyKind::Solid(_) | BodyKind::Truss(_) => true,
        BodyKind::Linear(linear) => linear.form == Form::Stiffness && linear.is_symmetric(),
    };
    // On elements with local flexibility, rows and columns of the interface differ.
    let plain = model
        .surfaces
        .iter()
        .all(|surface| surface.gives.is_empty());
    plain && model.has_dead_loads() && model.bodies.iter().all(symmetric)
}

/// Formats a number of bytes.
pub fn bytes(bytes: f64) -> String {
    match bytes {
        b if b >= 1e10 => format!("{:.0} GB", b / 1e9),
        b if b >= 1e9 => format!("{:.1} GB", b / 1e9),
        b => format!("{:.0} MB", (b / 1e6).max(1.0)),
    }
}
