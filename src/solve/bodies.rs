//! The bodies condensed to their interface (eqn 6), once a major iteration, from one sparse factorization.
//!
//! The interface's unknowns are the displacements of all slave nodes and of all nodes of the surfaces that they may
//! touch; they are eliminated last, so that the condensed stiffness S falls out of the factors
//! ([`SymmetricFactors`]). With springs of stiffness k between every slave node and its S*, and z the gaps that the
//! springs are given,
//!
//! ```text
//! A u_c = r̃ + k Gᵀ z,      A = S + k Gᵀ G + T,      v = G u_c,      ΔF = k (v − z),
//! ```
//!
//! where v is the relative motion of all slave nodes, normal and tangential, r̃ the condensed out-of-balance force and
//! T what turning interaction forces add. The springs make a body regular that only its contacts hold, and drop out
//! again exactly when z is solved for. All of it is of the interface's size, and no sparse solve is needed but one for
//! r̃ and one to recover the displacements inside.

use crate::linalg::{DenseFactors, Pattern, SolveError, SymmetricFactors};
use crate::scene::model::{BodyKind, Form, Model};
use crate::solve::condensed::Relation;
use crate::solve::interface::Interface;
use std::sync::Arc;

/// The condensed bodies of a major iteration. Matrices are stored column by column.
pub struct Bodies {
    pattern: Arc<Pattern>,
    factors: SymmetricFactors,
    /// Number among the interface's unknowns, by equation.
    number: Vec<Option<usize>>,
    /// The equations of the interface's unknowns, ascending.
    equations: Vec<usize>,
    /// Added to S's diagonal where it is factored.
    shift: f64,
    /// S with the shift.
    schur: Vec<f64>,
    /// T.
    pub turning: Vec<f64>,
    /// A.
    matrix: Vec<f64>,
    dense: DenseFactors,
    /// Out-of-balance force of all equations, and their displacements under it with the interface on the shift's springs.
    residual: Vec<f64>,
    free: Vec<f64>,
    /// u_c at z = 0.
    start: Vec<f64>,
    /// Change of u_c by z.
    motions: Vec<f64>,
    /// u_c of the last solve, less that of `free`.
    offset: Vec<f64>,
}

/// Whether all bodies of a scene have a stiffness that can be factored without pivoting. Shear-rigid beams have not:
/// their shear forces are unknowns of a saddle point. So are the forces on a body that is given by its compliance, and a
/// given stiffness may be unsymmetric.
pub fn condensable(model: &Model) -> bool {
    model.bodies.iter().all(|body| match &body.kind {
        BodyKind::Beam(beam) => beam.first_shear.is_none(),
        BodyKind::Solid(_) => true,
        BodyKind::Linear(linear) => linear.form == Form::Stiffness && linear.is_symmetric(),
    })
}

impl Bodies {
    /// Lays out the bodies' stiffness; `entries` are its places `(row, column)`, in equations.
    ///
    /// # Errors
    /// [`SolveError`] if it cannot be analysed.
    pub fn new(model: &Model, entries: Vec<(usize, usize)>) -> Result<Self, SolveError> {
        let n = model.dofs.equations;
        let pattern = Arc::new(Pattern::new(n, entries));
        let equations = interface_equations(model);
        let mut number = vec![None; n];
        for (k, &equation) in equations.iter().enumerate() {
            number[equation] = Some(k);
        }
        let (c, z) = (equations.len(), 2 * model.slaves.len());
        Ok(Bodies {
            factors: SymmetricFactors::new(pattern.clone(), &equations)?,
            pattern,
            number,
            shift: 0.0,
            schur: vec![0.0; c * c],
            turning: vec![0.0; c * c],
            matrix: vec![0.0; c * c],
            dense: DenseFactors::new(c, z)?,
            residual: vec![0.0; n],
            free: vec![0.0; n],
            start: vec![0.0; c],
            motions: vec![0.0; c * z],
            offset: vec![0.0; c],
            equations,
        })
    }

    /// The pattern of the bodies' stiffness.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Number of an equation among the interface's unknowns, if it is one.
    pub fn number(&self, equation: usize) -> Option<usize> {
        self.number[equation]
    }

    /// Place of an entry in the matrices of the interface.
    pub fn place(&self, row: usize, column: usize) -> Option<usize> {
        Some(column * self.equations.len() + row)
    }

    /// Factors the stiffness with these values and finds how the interface answers: fills `start` and `response` of
    /// `out`, whose springs it takes. Returns an estimate of the norm of A's scaled inverse.
    ///
    /// # Errors
    /// [`SolveError::Singular`] where the stiffness cannot be factored without pivoting.
    pub fn condense(
        &mut self,
        stiffness: &[f64],
        residual: &[f64],
        interfaces: &[Interface],
        frames: &[[[f64; 2]; 2]],
        out: &mut Relation,
    ) -> Result<f64, SolveError> {
        let k = out.stiffness;
        self.shift = k;
        self.factors.factor(stiffness, k)?;
        self.residual.copy_from_slice(residual);
        self.factors.solve(&self.residual, &mut self.free)?;
        self.factors.condensed(&mut self.schur);
        self.assemble(interfaces, k);
        self.dense.factor(&self.matrix);
        self.load(interfaces, frames, k);
        self.dense.solve(&mut self.start)?;
        self.dense.solve(&mut self.motions)?;
        self.respond(interfaces, frames, out);
        Ok(self.dense.inverse_norm())
    }

    /// A.
    fn assemble(&mut self, interfaces: &[Interface], k: f64) {
        let c = self.equations.len();
        let parts = self.schur.iter().zip(&self.turning);
        for (to, (schur, turning)) in self.matrix.iter_mut().zip(parts) {
            *to = schur + turning;
        }
        for i in 0..c {
            self.matrix[i * c + i] -= self.shift;
        }
        for interface in interfaces {
            for col in &interface.links {
                let Some(j) = col.unknown else { continue };
                for row in interface.links.iter().filter(|row| row.axis == col.axis) {
                    if let Some(i) = row.unknown {
                        self.matrix[j * c + i] += k * row.weight * col.weight;
                    }
                }
            }
        }
    }

    /// r̃ into `start`, k Gᵀ into `motions`.
    fn load(&mut self, interfaces: &[Interface], frames: &[[[f64; 2]; 2]], k: f64) {
        let c = self.equations.len();
        for (offset, &equation) in self.offset.iter_mut().zip(&self.equations) {
            *offset = self.free[equation];
        }
        multiply(&self.schur, &self.offset, &mut self.start);
        self.motions.fill(0.0);
        let columns = self.motions.chunks_exact_mut(c.max(1));
        let directions = interfaces
            .iter()
            .zip(frames)
            .flat_map(|(interface, frame)| frame.iter().map(move |d| (interface, d)));
        for (column, (interface, direction)) in columns.zip(directions) {
            for link in &interface.links {
                if let Some(i) = link.unknown {
                    column[i] += k * link.weight * direction[link.axis];
                }
            }
        }
    }

    /// ΔF at z = 0, and its change by z.
    fn respond(&self, interfaces: &[Interface], frames: &[[[f64; 2]; 2]], out: &mut Relation) {
        let (c, k) = (self.equations.len(), out.stiffness);
        let motion = |interface: &Interface, direction: &[f64; 2], u: &[f64]| {
            let share = interface.links.iter().map(|link| {
                link.unknown
                    .map_or(0.0, |i| link.weight * direction[link.axis] * u[i])
            });
            share.sum::<f64>()
        };
        let rows = || interfaces.iter().zip(frames);
        let count = out.start.len();
        for (s, (interface, frame)) in rows().enumerate() {
            for (component, direction) in frame.iter().enumerate() {
                out.start[2 * s + component] = k * motion(interface, direction, &self.start);
            }
        }
        for (j, column) in out.response.chunks_exact_mut(count.max(1)).enumerate() {
            let u = &self.motions[j * c..(j + 1) * c];
            for (s, (interface, frame)) in rows().enumerate() {
                for (component, direction) in frame.iter().enumerate() {
                    column[2 * s + component] = k * motion(interface, direction, u);
                }
            }
            column[j] -= k;
        }
    }

    /// Displacement increments of all equations for these z.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if they cannot be found.
    pub fn recover(&mut self, gaps: &[f64], x: &mut [f64]) -> Result<(), SolveError> {
        let c = self.equations.len();
        for (k, (offset, &equation)) in self.offset.iter_mut().zip(&self.equations).enumerate() {
            *offset = self.start[k] - self.free[equation];
        }
        for (column, gap) in self.motions.chunks_exact(c.max(1)).zip(gaps) {
            for (offset, motion) in self.offset.iter_mut().zip(column) {
                *offset += motion * gap;
            }
        }
        // Forces on the interface that bring its unknowns from `free` to where they must be.
        for (i, &equation) in self.equations.iter().enumerate() {
            let row = self.schur.iter().skip(i).step_by(c);
            let force: f64 = row.zip(&self.offset).map(|(s, u)| s * u).sum();
            self.residual[equation] += force;
        }
        self.factors.solve(&self.residual, x)
    }
}

/// y = A x, A stored column by column.
fn multiply(a: &[f64], x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    for (column, x) in a.chunks_exact(y.len().max(1)).zip(x) {
        for (y, a) in y.iter_mut().zip(column) {
            *y += a * x;
        }
    }
}

/// The equations of all slave nodes' displacements and of those of the surfaces that they may touch, ascending.
fn interface_equations(model: &Model) -> Vec<usize> {
    let masters = model
        .slaves
        .iter()
        .flat_map(|slave| &slave.surfaces)
        .filter(|&&surface| !model.surfaces[surface].rigid)
        .flat_map(|&surface| model.surfaces[surface].elements.iter().flatten());
    let nodes = model.slaves.iter().map(|slave| &slave.node).chain(masters);
    let mut equations: Vec<usize> = nodes
        .flat_map(|&node| {
            let first = model.dofs.first[node];
            (first..first + 2).filter_map(|dof| model.dofs.equation[dof])
        })
        .collect();
    equations.sort_unstable();
    equations.dedup();
    equations
}
