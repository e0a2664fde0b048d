//! What the two solvers take of time and memory, estimated from a scene's sizes before anything is built.
//!
//! An estimate is good to a factor of two or three, which is enough to choose by and to refuse what cannot fit. It counts,
//! for each body, the entries of the factors and the operations that make them:
//!
//! - a chain of beam elements with f unknowns each: f² entries an element, f³ / 3 operations;
//! - n unknowns of a plane mesh of 8-node quadrilaterals, in a good order: entries as n log n, operations as n^1.5;
//! - a dense matrix over d unknowns: d² entries, d³ / 3 operations.
//!
//! The whole system is unsymmetric and is pivoted: twice the operations, and several times the entries; a further minor
//! iteration repeats the part that its changes reach. Condensing adds dense matrices over the interface: over the c
//! displacements of the slave nodes and of all nodes of the surfaces that they may touch, and over the z forces of the slave
//! nodes. With m = c − z, c³ / 3 operations make the condensed stiffness, m³ / 3 + m² z the compliance, z³ / 3 each minor
//! iteration. All constants are measured (README).

use crate::model::{Body, BodyKind, Form, Linear, Model, Solver};
use std::fmt;

/// Bytes of a gigabyte, as settings and messages count them.
pub const GIGABYTE: f64 = 1e9;
/// How many times more unknowns than the interface the bodies must have for condensing to pay (measured: README).
const MANY_TIMES: usize = 8;
/// Part of the whole system that a minor iteration factors again, with its solves.
const REPEATED: f64 = 0.15;
/// Minor iterations of a typical major one.
const MINORS: f64 = 3.0;
/// Operations a second: of a sparse LDLᵀ, of a sparse LU of a mesh and of a chain, and of dense matrices.
const SYMMETRIC: f64 = 1.6e9;
const MESH: f64 = 1.6e9;
const CHAIN: f64 = 0.7e9;
const DENSE: f64 = 12e9;
/// Entries of the factors of a mesh over n log2 n, and operations over n^1.5, both for LDLᵀ; entries of an LU over those.
const MESH_ENTRIES: f64 = 10.0;
const MESH_OPERATIONS: f64 = 21.0;
const LU_ENTRIES: f64 = 6.0;
/// Operations of a stability check divided by c³, for c remaining unknowns: products of conditions and stiffness, and a factorization.
const LOOK: f64 = 4.0;
/// Bytes of an unknown, with its share of elements, pattern and stiffness, and of an entry of a given matrix.
const UNKNOWN: f64 = 2500.0;
const GIVEN: f64 = 180.0;
/// Matrices over the interface's displacements, and over its forces, that condensing keeps.
const OVER_DISPLACEMENTS: f64 = 7.0;
const OVER_FORCES: f64 = 4.0;
/// Bytes of the program itself.
const PROGRAM: f64 = 10e6;

/// Seconds of a major iteration with its minor ones, and bytes in all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Time of a major iteration with its minor ones (seconds).
    pub seconds: f64,
    /// Memory in all (bytes).
    pub bytes: f64,
}

/// What a scene takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// With the augmented system (eqn 9).
    pub augmented: Effort,
    /// With the bodies condensed (eqn 6).
    pub condensed: Effort,
    /// Whether `auto` stands for condensed.
    pub condenses: bool,
    /// Cost of a stability check ([`crate::linear::stability`]) in major iterations.
    pub stability: f64,
    /// Bytes that the scene may take.
    pub budget: f64,
}

/// Seconds and entries of a factorization.
#[derive(Debug, Clone, Copy, Default)]
struct Factoring {
    seconds: f64,
    entries: f64,
}

impl Estimate {
    /// What a scene with these settings takes.
    pub fn of(model: &Model) -> Estimate {
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
        let (c, z) = (displacements(model), 2.0 * model.contacts.len() as f64);
        let forces = MINORS / 3.0 * z.powi(3) / DENSE;
        let over_forces = 8.0 * OVER_FORCES * z * z;
        let condensed = if condensable(model) {
            let m = (c - z).max(0.0);
            let dense = (c.powi(3) + m.powi(3)) / 3.0 + m * m * z;
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
            condenses: if fits(augmented) {
                pays && fits(condensed)
            } else {
                fits(condensed)
            },
            stability: 0.0,
            budget,
        };
        let (major, _) = estimate.with(model.settings.solver);
        let look = symmetric.seconds + LOOK * kept(model, c).powi(3) / SYMMETRIC;
        estimate.stability = look / major.seconds.max(f64::MIN_POSITIVE);
        estimate
    }

    /// What a solver takes, and its name.
    pub fn with(&self, solver: Solver) -> (Effort, &'static str) {
        if self.is_condensed(solver) {
            (self.condensed, "condensed")
        } else {
            (self.augmented, "augmented")
        }
    }

    /// Whether a solver condenses.
    pub fn is_condensed(&self, solver: Solver) -> bool {
        match solver {
            Solver::Auto => self.condenses,
            Solver::Augmented => false,
            Solver::Condensed => true,
        }
    }

    /// Why a scene does not fit with a solver; `None` where it does.
    pub fn too_large(&self, solver: Solver) -> Option<TooLarge> {
        let (effort, name) = self.with(solver);
        let other = match solver {
            Solver::Condensed => Some(("augmented", self.augmented.bytes)),
            Solver::Augmented => Some(("condensed", self.condensed.bytes)),
            Solver::Auto => None,
        };
        (effort.bytes > self.budget).then_some(TooLarge {
            bytes: effort.bytes,
            name,
            budget: self.budget,
            other,
        })
    }
}

/// A scene takes more memory than it may.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TooLarge {
    /// Bytes that it takes.
    pub bytes: f64,
    /// The solver that takes them.
    pub name: &'static str,
    /// Bytes that it may take.
    pub budget: f64,
    /// Another solver, and the bytes that it takes.
    pub other: Option<(&'static str, f64)>,
}

impl std::error::Error for TooLarge {}

impl fmt::Display for TooLarge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (takes, may) = (bytes(self.bytes), bytes(self.budget));
        write!(
            f,
            "the scene takes about {takes} of memory ({}), and may take {may}",
            self.name
        )?;
        if let Some((other, takes)) = self.other {
            write!(f, "; settings.solver={other} takes about {}", bytes(takes))?;
        }
        f.write_str("; a coarser mesh takes less, and settings.memory sets what it may take (GB)")
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
        write!(f, "{seconds} a major iteration, {}", bytes(self.bytes))
    }
}

impl Factoring {
    fn add(&mut self, other: Factoring) {
        self.seconds += other.seconds;
        self.entries += other.entries;
    }
}

/// What it takes to factor a body's stiffness by LDLᵀ, and its part of the whole system by LU.
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

/// Whether a good part of a matrix is not zero.
fn is_dense(linear: &Linear, nodes: usize) -> bool {
    linear.entries.len() as f64 > (nodes as f64).powi(2)
}

/// Unknown displacements of the slave nodes and of all nodes of the surfaces that they may touch.
fn displacements(model: &Model) -> f64 {
    let mut wanted = vec![false; model.nodes.len()];
    let mut surfaces = vec![false; model.surfaces.len()];
    for slave in &model.contacts {
        wanted[slave.node] = true;
        slave.surfaces.iter().for_each(|&s| surfaces[s] = true);
    }
    for (surface, met) in model.surfaces.iter().zip(surfaces) {
        if met && !surface.rigid {
            surface
                .elements
                .iter()
                .flatten()
                .for_each(|&n| wanted[n] = true);
        }
    }
    let of = |node: usize| {
        let first = model.dofs.first[node];
        let moves = |dof: &usize| model.dofs.equation[*dof].is_some();
        (first..first + 2).filter(moves).count()
    };
    let nodes = wanted.iter().enumerate().filter(|(_, wanted)| **wanted);
    nodes.map(|(node, _)| of(node)).sum::<usize>() as f64
}

/// Number of unknowns in the dense part of a stability check: `c` of the interface, and all unknowns of bodies that need pivoting.
fn kept(model: &Model, c: f64) -> f64 {
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

/// Whether all bodies of a scene have a stiffness that can be factored without pivoting. Shear-rigid beams have not:
/// their shear forces are unknowns of a saddle point. So are the forces on a body that is given by its compliance, and a
/// given stiffness may be unsymmetric, and that of a pressure that follows its faces is.
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
    plain && model.pressures.is_empty() && model.bodies.iter().all(symmetric)
}

/// A number of bytes for a person.
pub fn bytes(bytes: f64) -> String {
    match bytes {
        b if b >= 1e10 => format!("{:.0} GB", b / 1e9),
        b if b >= 1e9 => format!("{:.1} GB", b / 1e9),
        b => format!("{:.0} MB", (b / 1e6).max(1.0)),
    }
}
