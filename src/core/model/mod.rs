//! The model that the solver works on.
//!
//! Objects refer to each other by index, not by name; generated nodes are laid out and degrees of freedom numbered. Nodes of
//! rigid surfaces have no unknowns, and beams with a shear stiffness GA have no shear unknowns.
//!
//! Degrees of freedom are numbered node by node (x, y and, on beams, the rotation), followed by the internal ones of each body:
//! the shear forces of shear-rigid beams, one per Gauss point, and the forces on bodies given by a compliance, whose equations
//! all have the unit length. `equation[d]` is the number of the unknown for degree of freedom d, or `None` if d is restrained or
//! prescribed.

mod body;
mod contact;
mod control;
mod dofs;
mod friction;
mod load;
mod mesh;
mod settings;

use crate::plane::range;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

pub use crate::documented;
pub use crate::elements::kinds::ElementKind;
pub use body::{
    Beam, Body, BodyKind, Elastic, Form, Law, Linear, Plane, Solid, SolidElement, Truss, Update,
};
pub use contact::{Bond, Contact, Facing, Piece, PointGive, STENCIL, SlavePoints, Surface};
pub use control::{ArcLength, ArcMeasure, Bound, Control};
pub use dofs::{Axis, Component, Dofs};
pub use friction::{Friction, InitialState, Mode};
pub use load::{Factor, Jumps, Load, Prescribed, PressedFace, Pressure, least, on_leg};
pub use mesh::boundary;
pub use settings::{
    AtCycle, AtLimit, BoundUpdate, Geometry, InitialGaps, LinearSolver, PointForce, Refactor,
    ResidualMethod, SearchBudget, SearchMode, Settings, SlipCount, Sticking, Strategy, TieRule,
    Touch,
};

/// A checked scene.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Model {
    /// Title, one line.
    pub title: String,
    /// Description of the scene; may be empty.
    pub about: String,
    /// All nodes, in the reference configuration. Node indices refer to this list.
    pub nodes: Vec<Node>,
    /// The deformable bodies.
    pub bodies: Vec<Body>,
    /// Master surfaces. Surface indices refer to this list.
    pub surfaces: Vec<Surface>,
    /// The contacts, one per slave node. Slave numbers refer to this list.
    pub contacts: Vec<Contact>,
    /// Numbering of the degrees of freedom and of the unknowns.
    pub dofs: Dofs,
    /// Dead loads.
    pub loads: Vec<Load>,
    /// Following pressures and thermal expansions.
    pub pressures: Vec<Pressure>,
    /// Prescribed nonzero displacements.
    pub prescribed: Vec<Prescribed>,
    /// Corners of the load-factor path, at least two.
    pub path: Vec<f64>,
    /// Increment of the load factor (positive).
    pub increment: f64,
    /// Increment on each leg of the path (positive); empty if all legs use `increment`.
    pub increments: Vec<f64>,
    /// Size below which a failing increment is no longer cut. `None` means 1/64 of the leg's increment.
    pub least: Option<f64>,
    /// What to do with an increment that jumps to another equilibrium branch.
    pub jumps: Jumps,
    /// What controls the history.
    pub control: Control,
    /// Parameters of arc-length control, if `control` is [`Control::Arc`].
    pub arc: ArcLength,
    /// Options and limits of the method.
    pub settings: Settings,
    /// Quantities to report, in the order of the output columns.
    pub monitors: Vec<Monitor>,
    /// Memory available to the solver (bytes), unless `settings.memory` sets a limit.
    pub budget: f64,
    /// Diagonal of the bounding box of all bodies' nodes: the length scale for tolerances.
    pub length: f64,
    /// Data of a finished run of another program. `None` for everything that can be stepped.
    pub finished: Option<FinishedRun>,
    /// The third coordinates. `None` in the plane.
    pub space: Option<Space>,
}

/// A finished run of another program, with one level of iterations, whose files do not distinguish stick from slip: a
/// contact is closed ([`Mode::Fixed`]) or open.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FinishedRun {
    /// Names of the increments, by number from 1.
    pub increments: Vec<String>,
    /// First period of each cycle, as iteration numbers of the whole run, from 0.
    pub cycles: Vec<std::ops::Range<usize>>,
    /// Limit of the displacement correction (relative).
    pub correction_limit: f64,
    /// Whether its last attempt converged.
    pub converged: bool,
    /// Why it did not converge, most likely causes first.
    pub findings: Vec<RunFinding>,
    /// Its contact surfaces; empty without its input.
    pub shape: RunShape,
}

/// The contact surfaces of a finished run, undeformed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunShape {
    /// Corners of the faces of the masters and of the slaves.
    pub faces: [Vec<Vec<[f64; 3]>>; 2],
    /// Positions of the slaves; `None` if they are not in the input.
    pub slaves: Vec<Option<[f64; 3]>>,
}

/// A cause of a failed run, found by a rule.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunFinding {
    /// Name of the rule.
    pub rule: &'static str,
    /// The cause with its numbers.
    pub cause: String,
    /// What to change, and in which line of the input; empty if the cause of another finding must be removed first.
    pub cure: String,
    /// The new lines of the input; empty if there are none.
    pub lines: String,
}

impl RunFinding {
    /// The new lines of the input in one line, shortened.
    pub fn shown_lines(&self) -> String {
        const MOST: usize = 4;
        let lines: Vec<&str> = self.lines.lines().collect();
        let shown = lines[..lines.len().min(MOST)].join(" ↵ ");
        match lines.len().saturating_sub(MOST) {
            0 => shown,
            more => format!("{shown} ↵ ... ({more} more)"),
        }
    }

    /// The cure with its lines.
    pub fn advice(&self) -> String {
        if self.lines.is_empty() {
            self.cure.clone()
        } else {
            format!("{}: {}", self.cure, self.shown_lines())
        }
    }
}

/// What a scene in space has beyond the plane: nodes have three coordinates and three degrees of freedom.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Space {
    /// z of each node (length).
    pub heights: Vec<f64>,
    /// The interface problem, if the model has nothing else.
    pub problem: Option<Arc<SpaceProblem>>,
}

/// An interface problem in space: (gap, u) = W f + free in the total forces, with three components per contact.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpaceProblem {
    /// Entries of W: row, column and value (length per force); repeated ones are added.
    pub entries: Vec<(usize, usize, f64)>,
    /// Gap and motion of each node without contact forces (length).
    pub free: Vec<f64>,
}

/// A node in the reference configuration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// `ID.k` for the k-th node of a chain or block (from 1), or the id of a single node.
    #[serde(default)]
    pub name: String,
    /// Position (length).
    pub at: [f64; 2],
}

/// A quantity to report.
#[derive(Debug, Clone, PartialEq)]
pub struct Monitor {
    /// Name of the column in outputs.
    pub name: String,
    /// The reported quantity.
    pub of: MonitorQuantity,
}

/// The quantity that a monitor reports.
#[derive(Debug, Clone, PartialEq)]
pub enum MonitorQuantity {
    /// Value of a degree of freedom.
    Displacement {
        /// Number of the degree of freedom.
        dof: usize,
    },
    /// Component of the contact force, summed over slaves.
    Contact {
        /// Slave numbers.
        slaves: Vec<usize>,
        /// The component.
        axis: Axis,
    },
    /// Support force at a restrained degree of freedom.
    Reaction {
        /// Number of the degree of freedom.
        dof: usize,
    },
    /// Number of slaves in a mode.
    Modes {
        /// Slave numbers.
        slaves: Vec<usize>,
        /// The mode.
        mode: Mode,
    },
    /// Largest drift among slaves.
    Drift {
        /// Slave numbers.
        slaves: Vec<usize>,
    },
    /// Contact pressure F_n / A or shear F_t / A (force per undeformed area), taken from the slave where its magnitude is
    /// largest.
    Pressure {
        /// Slave numbers; each contact must have an area.
        slaves: Vec<usize>,
        /// Whether to report the shear.
        shear: bool,
    },
    /// A number reported by an attached solver.
    Reported {
        /// Index among the numbers that it reports.
        number: usize,
        /// Kind of number.
        kind: ReportedKind,
    },
    /// Arc along the equilibrium path from the start of the history, in the quantity that [`ArcLength::along`] measures.
    Arc,
}

/// Kind of a number reported by an attached solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ReportedKind {
    /// A length.
    Length,
    /// A force.
    Force,
    /// A force per area.
    Pressure,
    /// A count.
    Count,
    /// Not specified.
    #[default]
    Other,
}

/// Diagonal of the bounding box of nodes; 0 for none.
pub fn diagonal<'a>(nodes: impl Iterator<Item = &'a Node> + Clone) -> f64 {
    let extent = |axis: usize| {
        let [low, high] = range(nodes.clone().map(|node| node.at[axis]));
        high - low
    };
    let width = extent(0);
    if width >= 0.0 {
        width.hypot(extent(1))
    } else {
        0.0
    }
}

impl Model {
    /// A model whose bodies are known to another solver only: nodes, masters and contacts, a load factor from 0 to 1 in one
    /// increment, and no unknowns. Callers fill in what else is known.
    pub fn from_contacts(
        title: &str,
        nodes: Vec<Node>,
        surfaces: Vec<Surface>,
        contacts: Vec<Contact>,
    ) -> Model {
        let count = nodes.len();
        let length = match diagonal(nodes.iter()) {
            length if length > 0.0 => length,
            // A single node has no extent, but its motion still needs a length scale.
            _ => 1.0,
        };
        Model {
            title: title.to_owned(),
            nodes,
            surfaces,
            contacts,
            dofs: Dofs {
                first: (0..count).map(|node| 2 * node).collect(),
                count: vec![2; count],
                equation: vec![None; 2 * count],
                equations: 0,
                inner: 0,
            },
            path: vec![0.0, 1.0],
            increment: 1.0,
            budget: f64::INFINITY,
            length,
            ..Model::default()
        }
    }

    /// Name of an increment: its number, or its name in a finished run.
    pub fn increment_name(&self, number: u32) -> String {
        let names = self
            .finished
            .as_ref()
            .map_or(&[][..], |run| &run.increments);
        let named = names.get((number as usize).wrapping_sub(1));
        named.map_or_else(|| number.to_string(), String::clone)
    }

    /// Increment size on a leg of the path, as the scene defines it.
    pub fn on_leg(&self, leg: usize) -> f64 {
        on_leg(&self.increments, self.increment, leg)
    }

    /// Whether any body is a solid.
    pub fn has_solids(&self) -> bool {
        self.bodies.iter().any(|body| body.solid().is_some())
    }

    /// Whether any body is a beam.
    pub fn has_beams(&self) -> bool {
        let beam = |body: &Body| matches!(body.kind, BodyKind::Beam(_));
        self.bodies.iter().any(beam)
    }

    /// Whether no body's stiffness depends on its displacements.
    pub fn has_constant_stiffness(&self) -> bool {
        let constant = |body: &Body| body.is_small() || body.is_linear();
        self.bodies.iter().all(constant)
    }

    /// Whether old factors are kept where they help, with this choice of when to factor. The stiffness of a beam rotates with it,
    /// and in the augmented system most of the work belongs to the interface and is done again in any case.
    pub fn keeps_factors(&self, chosen: Refactor, condensed: bool) -> bool {
        match chosen {
            Refactor::Auto => condensed && self.has_solids() && !self.has_beams(),
            Refactor::Each => false,
            Refactor::Needed => true,
        }
    }

    /// Whether x is a radius and y the axis; forces then refer to the whole circumference.
    pub fn is_axisymmetric(&self) -> bool {
        self.bodies.iter().any(Body::is_axisymmetric)
    }

    /// Current position of a node for these degrees of freedom: reference position plus displacement.
    pub fn place(&self, u: &[f64], node: usize) -> [f64; 2] {
        let at = self.nodes[node].at;
        let Some(&first) = self.dofs.first.get(node) else {
            return at;
        };
        let moved = |axis: usize| u.get(first + axis).copied().unwrap_or(0.0);
        match self.dofs.count.get(node) {
            Some(2..) => [at[0] + moved(0), at[1] + moved(1)],
            _ => at,
        }
    }

    /// Fraction of the initial overlaps ([`Contact::overlap`]), closed over the first leg of the path, that remains at a load
    /// factor on a leg.
    pub fn unclosed(&self, leg: usize, load_factor: f64) -> f64 {
        match self.path.as_slice() {
            [from, to, ..] if leg == 0 => ((to - load_factor) / (to - from)).clamp(0.0, 1.0),
            _ => 0.0,
        }
    }

    /// Current positions of all nodes ([`Model::place`]).
    pub fn places(&self, u: &[f64]) -> Vec<[f64; 2]> {
        (0..self.nodes.len())
            .map(|node| self.place(u, node))
            .collect()
    }
}

impl Model {
    /// Whether no load depends on the displacements. The expansion of a body with small displacements does not.
    pub fn has_dead_loads(&self) -> bool {
        let small = |body: usize| self.bodies[body].is_small();
        self.pressures.iter().all(|p| p.expands.is_some_and(small))
    }

    /// The strain, along a length, of all expansions of a body at a load factor, and its derivative. Zero for small displacements,
    /// whose law has no other strain.
    fn expansion(&self, body: Option<usize>, load_factor: f64) -> [f64; 2] {
        let large = |body: &usize| !self.bodies[*body].is_small();
        let mut sum = [0.0; 2];
        if let Some(body) = body.filter(large) {
            for p in self.pressures.iter().filter(|p| p.expands == Some(body)) {
                sum[0] += p.value * p.scale.at(load_factor);
                sum[1] += p.value * p.scale.slope(load_factor);
            }
        }
        sum
    }

    /// A pressure at a load factor. Of an expansion with large displacements the Green strain, of which the law is made: its part of
    /// E = e + e²/2, where e is the sum of the body's expansions.
    pub fn pressure(&self, pressure: usize, load_factor: f64) -> f64 {
        let p = &self.pressures[pressure];
        let [e, _] = self.expansion(p.expands, load_factor);
        p.value * p.scale.at(load_factor) * (1.0 + 0.5 * e)
    }

    /// Derivative of [`Model::pressure`] with respect to the load factor.
    pub fn pressure_rate(&self, pressure: usize, load_factor: f64) -> f64 {
        let p = &self.pressures[pressure];
        let [e, rate] = self.expansion(p.expands, load_factor);
        p.value
            * (p.scale.slope(load_factor) * (1.0 + 0.5 * e) + p.scale.at(load_factor) * 0.5 * rate)
    }

    /// Initial position of the node of each equation; the origin for internal unknowns of bodies.
    pub fn positions_of_equations(&self) -> Vec<[f64; 2]> {
        let mut positions = vec![[0.0; 2]; self.dofs.equations];
        let dofs = self.dofs.first.iter().zip(&self.dofs.count);
        for (node, (&first, &count)) in self.nodes.iter().zip(dofs) {
            let own = &self.dofs.equation[first..first + usize::from(count)];
            for &equation in own.iter().flatten() {
                positions[equation] = node.at;
            }
        }
        positions
    }

    /// Turns a scene of contacts ([`Model::from_contacts`]) into one in space; `heights` are the z of its nodes.
    pub fn raise(&mut self, heights: Vec<f64>) {
        let ends = |low: f64, high: f64| {
            heights
                .iter()
                .fold((low, high), |(l, h), z| (l.min(*z), h.max(*z)))
        };
        let (low, high) = ends(f64::INFINITY, f64::NEG_INFINITY);
        let flat = diagonal(self.nodes.iter());
        let length = flat.hypot(high - low);
        self.length = if length > 0.0 { length } else { 1.0 };
        let count = self.nodes.len();
        self.dofs.first = (0..count).map(|node| 3 * node).collect();
        self.dofs.count = vec![3; count];
        self.dofs.equation = vec![None; 3 * count];
        self.space = Some(Space {
            heights,
            problem: None,
        });
    }

    /// Reference position of a node; z is 0 in the plane.
    #[inline]
    pub fn at_in_space(&self, node: usize) -> [f64; 3] {
        let [x, y] = self.nodes[node].at;
        let heights = self.space.as_ref().map(|space| &space.heights);
        let z = heights.and_then(|heights| heights.get(node));
        [x, y, z.copied().unwrap_or(0.0)]
    }

    /// Current position of a node ([`Model::place`]); z is 0 in the plane.
    #[inline]
    pub fn place_in_space(&self, u: &[f64], node: usize) -> [f64; 3] {
        let [x, y] = self.place(u, node);
        let [_, _, z] = self.at_in_space(node);
        let risen = self
            .space
            .as_ref()
            .and_then(|_| u.get(self.dofs.first[node] + 2));
        [x, y, z + risen.copied().unwrap_or(0.0)]
    }
}
