//! Condenses the bodies to their interface (eqn 6) once per major iteration, with one sparse factorization.
//!
//! The interface's unknowns are the displacements of all slave nodes and of all nodes of the surfaces that they may touch. They
//! are not eliminated: what the factorization leaves is the condensed stiffness S ([`SymmetricFactors`]). With
//! springs of stiffness k between every slave node and its S*, and the gaps z imposed on the springs,
//!
//! ```text
//! A u_c = r̃ + k Gᵀ z,      A = S + k Gᵀ G + T,      v = G u_c,      ΔF = k (v − z),
//! ```
//!
//! where v is the relative motion of all slave nodes, normal and tangential, r̃ the condensed out-of-balance force, and T the
//! contribution of rotating interaction forces. The springs make bodies regular that only their contacts support, and they cancel
//! exactly when z is solved for. Masters that no slave node is over are then eliminated as well ([`FarMasters`]), so that all
//! matrices have the size of the contact. Each body's factors are used at most twice: for r̃, and to recover the interior
//! displacements. Bodies are coupled only through A, so they can be factored in parallel ([`Executor`]).
//!
//! If a bond has a compliance c ([`crate::interface::kinematics`]), its spring is softer, 1 / (1 / k + c), and v is the motion of
//! the touching point.
//!
//! If all bodies are solids, no bond has a compliance, and every slave node can move in both directions and belongs to no master,
//! no springs are needed ([`CondensationPath::Direct`]). With the frames F and the weights M of the master nodes in S*, v = F (M u_m − u_s),
//! so v can replace the slave nodes' displacements,
//!
//! ```text
//! u_s = M u_m − Fᵀ v,      K' = Bᵀ (S + T) B over (u_m, v),      ΔF = r'_v − K'_vm u_m − K'_vv v,
//! ```
//!
//! and only the masters' block K'_mm must be factored. This is the relation of `condensed` in the limit of stiff springs.

use crate::executor::{Executor, each};
use crate::groups::distinct;
use crate::linalg::{DenseFactors, Pattern, SolveError, SymmetricFactors, subtract_product};
use crate::linear::coupling::Interface;
use crate::linear::far_masters::FarMasters;
use crate::model::{Body, BodyKind, Contact};
use crate::{InterfaceResponse, Model};
use std::ops::Range;
use std::sync::Arc;

/// Bodies with fewer unknowns in total are factored as one.
const SMALL: usize = 1000;

/// Method for computing the interface response.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CondensationPath {
    /// With springs between slave nodes and masters.
    Springs,
    /// With relative motions instead of the slave nodes' displacements, which are the last unknowns.
    Direct,
}

/// The condensed bodies of a major iteration. Matrices are stored column by column.
pub struct Condensation {
    pattern: Arc<Pattern>,
    parts: Vec<BodyGroup>,
    executor: Arc<dyn Executor>,
    way: CondensationPath,
    /// Index among the interface's unknowns, by equation.
    number: Vec<Option<usize>>,
    /// Eliminates the unknowns of the interface that are far from all slave nodes.
    far: FarMasters,
    /// Whether each unknown is near: those of the slave nodes and of the elements under them.
    is_near: Vec<bool>,
    /// r̃ and u_c of all unknowns.
    load: Vec<f64>,
    known: Vec<f64>,
    /// T, and the places of its entries. All that follows is about the near unknowns.
    turning: Vec<f64>,
    turned: Vec<usize>,
    /// A; or S + T, then K'.
    matrix: Vec<f64>,
    dense: DenseFactors,
    /// The entries of M as (row of u_m, row of u_s, weight): pairs for x and y, of which the rows of x are listed, and others.
    pairs: Vec<(usize, usize, f64)>,
    singles: Vec<(usize, usize, f64)>,
    /// Out-of-balance force of all equations.
    residual: Vec<f64>,
    /// u_c at z = 0; with [`CondensationPath::Direct`], r', then u_m at v = 0.
    start: Vec<f64>,
    /// Derivative of u_c with respect to z; with [`CondensationPath::Direct`], of u_m with respect to −v.
    motions: Vec<f64>,
    /// u_c of the last solve.
    moved: Vec<f64>,
}

/// Bodies without stiffness coupling to other bodies.
struct BodyGroup {
    factors: SymmetricFactors,
    /// Their equations, and their range of the stiffness values.
    equations: Range<usize>,
    values: Range<usize>,
    /// Their unknowns, as indices into those of the interface.
    unknowns: Vec<usize>,
    /// S, column by column, and r̃.
    schur: Vec<f64>,
    load: Vec<f64>,
    /// u_c, and all displacements.
    known: Vec<f64>,
    moved: Vec<f64>,
    done: Result<(), SolveError>,
}

impl Condensation {
    /// Prepares the bodies' stiffness, given the pattern of its upper half and its [`uncoupled_parts`].
    ///
    /// # Errors
    /// [`SolveError`] if it cannot be analysed.
    pub fn new(
        model: &Model,
        pattern: Arc<Pattern>,
        ranges: &[Range<usize>],
        executor: Arc<dyn Executor>,
    ) -> Result<Self, SolveError> {
        let n = model.dofs.equations;
        let (way, interface) = match direct_equations(model) {
            Some(equations) => (CondensationPath::Direct, equations),
            None => (CondensationPath::Springs, interface_equations(model)),
        };
        let mut number = vec![None; n];
        for (k, &equation) in interface.iter().enumerate() {
            number[equation] = Some(k);
        }
        let (c, z) = (interface.len(), 2 * model.contacts.len());
        let positions = model.positions_of_equations();
        let mut condensation = Condensation {
            way,
            parts: analyse(&pattern, ranges, &interface, &positions, &*executor)?,
            executor,
            pattern,
            far: FarMasters::new(c)?,
            is_near: vec![true; c],
            load: vec![0.0; c],
            known: vec![0.0; c],
            number,
            turning: vec![0.0; c * c],
            turned: Vec::new(),
            matrix: vec![0.0; c * c],
            dense: DenseFactors::new(c, z)?,
            pairs: Vec::new(),
            singles: Vec::new(),
            residual: vec![0.0; n],
            start: vec![0.0; c],
            motions: vec![0.0; c * z],
            moved: vec![0.0; c],
        };
        condensation.resize(z);
        Ok(condensation)
    }

    /// Leaves out the masters that no slave node is over; returns whether they are others than before. Sets T to zero.
    pub fn choose(&mut self, model: &Model, interfaces: &[Interface]) -> bool {
        for place in self.turned.drain(..) {
            self.turning[place] = 0.0;
        }
        self.is_near.fill(false);
        let links = interfaces.iter().flat_map(|interface| &interface.links);
        let equations = links.filter_map(|link| model.dofs.equation[link.dof]);
        for unknown in equations.filter_map(|equation| self.number[equation]) {
            self.is_near[unknown] = true;
        }
        let changed = self.far.choose(&self.is_near);
        self.resize(2 * interfaces.len());
        changed
    }

    /// Resizes all that belongs to the near unknowns, with `z` relative motions.
    fn resize(&mut self, z: usize) {
        let n = self.size();
        let solved = match self.way {
            CondensationPath::Springs => n,
            CondensationPath::Direct => n - z,
        };
        self.dense.resize(solved);
        self.turning.resize(n * n, 0.0);
        self.matrix.resize(n * n, 0.0);
        self.motions.resize(n * z, 0.0);
        self.start.resize(n, 0.0);
        self.moved.resize(n, 0.0);
    }

    /// The pattern of the upper half of the bodies' stiffness.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Number of near unknowns.
    fn size(&self) -> usize {
        self.far.size()
    }

    /// Index of an equation among the near unknowns of the interface, if it is one.
    pub fn number(&self, equation: usize) -> Option<usize> {
        self.far.rank(self.number[equation]?)
    }

    /// Index of an entry in the matrices of the interface.
    pub fn place(&self, row: usize, column: usize) -> Option<usize> {
        Some(column * self.size() + row)
    }

    /// Factors the stiffness with these values (unless the previous one `stands`) and computes the interface response: fills
    /// `start` and `response` of `out`, using its springs. Returns an estimate of the norm of the scaled inverse of A, or of S_ff
    /// ([`FarMasters`]) if that is larger.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if the stiffness cannot be factored without pivoting, or if a diagonal entry of S is round-off: it
    /// would act as a stiffness.
    pub fn condense(
        &mut self,
        stands: bool,
        stiffness: &[f64],
        residual: &[f64],
        interfaces: &[Interface],
        frames: &[[[f64; 2]; 2]],
        out: &mut InterfaceResponse,
    ) -> Result<f64, SolveError> {
        let k = out.stiffness;
        self.residual.copy_from_slice(residual);
        let executor = &*self.executor;
        if !stands {
            self.far.renew();
        }
        each(executor, &mut self.parts, &|part| {
            part.done = part.condense(stands, stiffness, residual, executor);
        });
        for part in &self.parts {
            part.done?;
            for (&i, load) in part.unknowns.iter().zip(&part.load) {
                self.load[i] = *load;
            }
        }
        let parts = self.parts.iter();
        let parts = parts.map(|part| (&part.unknowns[..], &part.schur[..]));
        let norm = self.far.eliminate(parts, executor)?;
        self.far.condense(&self.load, &mut self.start)?;
        if self.way == CondensationPath::Direct {
            return Ok(self.relate(interfaces, frames, out)?.max(norm));
        }
        self.assemble(interfaces, frames, k);
        self.dense.factor(&self.matrix);
        self.push(interfaces, frames, k);
        self.dense.solve(&mut self.start)?;
        self.dense.solve_with(&*self.executor, &mut self.motions)?;
        self.respond(interfaces, frames, out);
        Ok(self.dense.inverse_norm().max(norm))
    }

    /// The relation without springs; returns an estimate of the norm of the scaled inverse of K'_mm.
    fn relate(
        &mut self,
        interfaces: &[Interface],
        frames: &[[[f64; 2]; 2]],
        out: &mut InterfaceResponse,
    ) -> Result<f64, SolveError> {
        let (c, z) = (self.size(), out.start.len());
        let m = c - z;
        out.stiffness = f64::INFINITY;
        self.add_turning();
        self.transform(interfaces, frames);
        let slaves = self.matrix[m * c..].chunks_exact(c.max(1));
        for (k, column) in slaves.enumerate() {
            self.motions[k * m..(k + 1) * m].copy_from_slice(&column[..m]);
            out.response[k * z..(k + 1) * z].copy_from_slice(&column[m..]);
        }
        let motions = &mut self.motions[..m * z];
        let (at_rest, given) = self.start.split_at_mut(m);
        self.dense.factor_part(&self.matrix, c);
        self.dense.solve(at_rest)?;
        self.dense.solve_with(&*self.executor, motions)?;
        out.start.copy_from_slice(given);
        if m > 0 {
            let mixed = (&self.matrix[m..], c);
            let (executor, response) = (&*self.executor, &mut out.response);
            subtract_product(executor, (response, z), mixed, (&*motions, m), [z, m, z]);
            let start = (&mut out.start[..], z);
            subtract_product(executor, start, mixed, (&*at_rest, m), [z, m, 1]);
        }
        out.response.iter_mut().for_each(|k| *k = -*k);
        Ok(self.dense.inverse_norm())
    }

    /// Writes Bᵀ (S + T) B to `matrix`, and Bᵀ r̃ to `start`.
    fn transform(&mut self, interfaces: &[Interface], frames: &[[[f64; 2]; 2]]) {
        let c = self.size();
        let m = c - 2 * interfaces.len();
        self.list_shares(interfaces);
        let (masters, slaves) = self.matrix.split_at_mut(m * c);
        let of_pairs = self
            .pairs
            .iter()
            .flat_map(|&(j, own, w)| [(j, own, w), (j + 1, own + 1, w)]);
        for (j, own, weight) in of_pairs.chain(self.singles.iter().copied()) {
            let from = &slaves[own * c..(own + 1) * c];
            for (to, from) in masters[j * c..(j + 1) * c].iter_mut().zip(from) {
                *to += weight * from;
            }
        }
        for (own, frame) in slaves.chunks_exact_mut(2 * c.max(1)).zip(frames) {
            let (x, y) = own.split_at_mut(c);
            for (x, y) in x.iter_mut().zip(y) {
                (*x, *y) = (-along(frame[0], *x, *y), -along(frame[1], *x, *y));
            }
        }
        let columns = self.matrix.chunks_exact_mut(c.max(1));
        for column in columns.chain(std::iter::once(&mut self.start[..])) {
            let (masters, slaves) = column.split_at_mut(m);
            for &(j, own, weight) in &self.pairs {
                let (to, from) = (&mut masters[j..j + 2], &slaves[own..own + 2]);
                to[0] += weight * from[0];
                to[1] += weight * from[1];
            }
            for &(j, own, weight) in &self.singles {
                masters[j] += weight * slaves[own];
            }
            for (own, frame) in slaves.chunks_exact_mut(2).zip(frames) {
                let [x, y] = [own[0], own[1]];
                (own[0], own[1]) = (-along(frame[0], x, y), -along(frame[1], x, y));
            }
        }
    }

    /// Lists the entries of M.
    fn list_shares(&mut self, interfaces: &[Interface]) {
        self.pairs.clear();
        self.singles.clear();
        for (s, interface) in interfaces.iter().enumerate() {
            for pair in interface.links[2..].chunks_exact(2) {
                let weight = pair[0].weight;
                match [pair[0].unknown, pair[1].unknown] {
                    [Some(x), Some(y)] if y == x + 1 => self.pairs.push((x, 2 * s, weight)),
                    both => {
                        let axes = both.into_iter().zip(2 * s..);
                        let known = axes.filter_map(|(j, own)| Some((j?, own, weight)));
                        self.singles.extend(known);
                    }
                }
            }
        }
    }

    /// Adds to an entry of T.
    pub fn turn(&mut self, place: usize, value: f64) {
        self.turning[place] += value;
        self.turned.push(place);
    }

    /// Writes S' + T to `matrix`.
    fn add_turning(&mut self) {
        let stiffness = self.far.stiffness();
        self.matrix.copy_from_slice(stiffness);
        for &place in &self.turned {
            self.matrix[place] = self.turning[place] + stiffness[place];
        }
    }

    /// Assembles A.
    fn assemble(&mut self, interfaces: &[Interface], frames: &[[[f64; 2]; 2]], k: f64) {
        let c = self.size();
        self.add_turning();
        for (interface, frame) in interfaces.iter().zip(frames) {
            if interface.bond.give() != [0.0; 2] {
                self.add_springs(interface, frame, springs(interface, k));
                continue;
            }
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

    /// Adds springs along n and t with separate stiffnesses to A.
    fn add_springs(&mut self, interface: &Interface, frame: &[[f64; 2]; 2], springs: [f64; 2]) {
        let c = self.size();
        for col in &interface.links {
            let Some(j) = col.unknown else { continue };
            for row in &interface.links {
                if let Some(i) = row.unknown {
                    let both = frame.iter().zip(springs);
                    let sum: f64 = both.map(|(d, k)| k * d[row.axis] * d[col.axis]).sum();
                    self.matrix[j * c + i] += sum * row.weight * col.weight;
                }
            }
        }
    }

    /// Writes k Gᵀ to `motions`.
    fn push(&mut self, interfaces: &[Interface], frames: &[[[f64; 2]; 2]], k: f64) {
        let c = self.size();
        self.motions.fill(0.0);
        let columns = self.motions.chunks_exact_mut(c.max(1));
        let directions = interfaces
            .iter()
            .zip(frames)
            .flat_map(|(interface, frame)| {
                frame
                    .iter()
                    .zip(springs(interface, k))
                    .map(move |(d, k)| (interface, d, k))
            });
        for (column, (interface, direction, k)) in columns.zip(directions) {
            for link in &interface.links {
                if let Some(i) = link.unknown {
                    column[i] += k * link.weight * direction[link.axis];
                }
            }
        }
    }

    /// ΔF at z = 0, and its derivative with respect to z.
    fn respond(
        &self,
        interfaces: &[Interface],
        frames: &[[[f64; 2]; 2]],
        out: &mut InterfaceResponse,
    ) {
        let (c, k) = (self.size(), out.stiffness);
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
            let springs = springs(interface, k);
            for (component, direction) in frame.iter().enumerate() {
                out.start[2 * s + component] =
                    springs[component] * motion(interface, direction, &self.start);
            }
        }
        for (j, column) in out.response.chunks_exact_mut(count.max(1)).enumerate() {
            let u = &self.motions[j * c..(j + 1) * c];
            for (s, (interface, frame)) in rows().enumerate() {
                let springs = springs(interface, k);
                for (component, direction) in frame.iter().enumerate() {
                    column[2 * s + component] =
                        springs[component] * motion(interface, direction, u);
                }
            }
            column[j] -= springs(&interfaces[j / 2], k)[j % 2];
        }
    }

    /// Displacement increments of all equations for these z, one per direction in `frames`.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if they cannot be computed.
    pub fn recover(
        &mut self,
        gaps: &[f64],
        interfaces: &[Interface],
        frames: &[[[f64; 2]; 2]],
        x: &mut [f64],
    ) -> Result<(), SolveError> {
        match self.way {
            CondensationPath::Springs => self.moved.copy_from_slice(&self.start),
            CondensationPath::Direct => self.move_masters(gaps),
        }
        let sign = if self.way == CondensationPath::Direct {
            -1.0
        } else {
            1.0
        };
        let count = match self.way {
            CondensationPath::Springs => self.size(),
            CondensationPath::Direct => self.size() - gaps.len(),
        };
        for (column, gap) in self.motions.chunks_exact(count.max(1)).zip(gaps) {
            for (moved, motion) in self.moved.iter_mut().zip(column) {
                *moved += sign * motion * gap;
            }
        }
        if self.way == CondensationPath::Direct {
            self.move_slaves(gaps, interfaces, frames);
        }
        self.far.recover(&self.moved, &mut self.known);
        let (residual, known) = (&self.residual, &self.known);
        let executor = &*self.executor;
        each(executor, &mut self.parts, &|part| {
            part.done = part.recover(residual, known, executor);
        });
        for part in &self.parts {
            part.done?;
            x[part.equations.clone()].copy_from_slice(&part.moved);
        }
        Ok(())
    }

    /// Writes u_m at v = 0 to `moved`.
    fn move_masters(&mut self, gaps: &[f64]) {
        let m = self.size() - gaps.len();
        self.moved[..m].copy_from_slice(&self.start[..m]);
    }

    /// Writes u_s to `moved`, which already contains u_m.
    fn move_slaves(&mut self, gaps: &[f64], interfaces: &[Interface], frames: &[[[f64; 2]; 2]]) {
        let m = self.size() - gaps.len();
        let (masters, slaves) = self.moved.split_at_mut(m);
        let nodes = interfaces.iter().zip(frames).zip(gaps.chunks_exact(2));
        for (((interface, frame), v), own) in nodes.zip(slaves.chunks_exact_mut(2)) {
            for (axis, own) in own.iter_mut().enumerate() {
                *own = -(frame[0][axis] * v[0] + frame[1][axis] * v[1]);
            }
            for link in &interface.links[2..] {
                if let Some(j) = link.unknown {
                    own[link.axis] += link.weight * masters[j];
                }
            }
        }
    }
}

impl BodyGroup {
    fn new(
        pattern: &Pattern,
        equations: Range<usize>,
        interface: &[usize],
        positions: &[[f64; 2]],
    ) -> Result<Self, SolveError> {
        let own = interface.iter().enumerate();
        let own = own.filter(|(_, equation)| equations.contains(equation));
        let (unknowns, last): (Vec<usize>, Vec<usize>) = own
            .map(|(k, equation)| (k, equation - equations.start))
            .unzip();
        let (pattern, values) = pattern.block(equations.clone());
        let c = unknowns.len();
        Ok(BodyGroup {
            factors: SymmetricFactors::new(
                Arc::new(pattern),
                &last,
                &positions[equations.clone()],
            )?,
            values,
            unknowns,
            schur: vec![0.0; c * c],
            load: vec![0.0; c],
            known: vec![0.0; c],
            moved: vec![0.0; equations.len()],
            equations,
            done: Ok(()),
        })
    }

    /// Computes r̃, and S unless the previous one stands.
    fn condense(
        &mut self,
        stands: bool,
        stiffness: &[f64],
        residual: &[f64],
        executor: &dyn Executor,
    ) -> Result<(), SolveError> {
        if !stands {
            let stiffness = &stiffness[self.values.clone()];
            self.factors.factor(stiffness, executor)?;
            if self.factors.cancels() {
                return Err(SolveError::Singular);
            }
            self.factors.condensed(&mut self.schur);
        }
        let residual = &residual[self.equations.clone()];
        self.factors.condense(residual, &mut self.load, executor);
        Ok(())
    }

    /// All displacements, given u_c of the whole interface.
    fn recover(
        &mut self,
        residual: &[f64],
        interface: &[f64],
        executor: &dyn Executor,
    ) -> Result<(), SolveError> {
        for (known, &k) in self.known.iter_mut().zip(&self.unknowns) {
            *known = interface[k];
        }
        let residual = &residual[self.equations.clone()];
        let (known, moved) = (&self.known, &mut self.moved);
        self.factors.recover(residual, known, moved, executor)
    }
}

/// The equations of the parts that are factored separately: uncoupled bodies, of which consecutive small ones are merged.
pub fn uncoupled_parts(pattern: &Pattern) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for block in pattern.blocks() {
        match ranges.last_mut() {
            Some(last) if last.len().min(block.len()) < SMALL => last.end = block.end,
            _ => ranges.push(block),
        }
    }
    ranges
}

/// Prepares the parts in parallel.
fn analyse(
    pattern: &Pattern,
    ranges: &[Range<usize>],
    interface: &[usize],
    positions: &[[f64; 2]],
    executor: &dyn Executor,
) -> Result<Vec<BodyGroup>, SolveError> {
    let mut parts: Vec<_> = ranges.iter().map(|range| (range.clone(), None)).collect();
    each(executor, &mut parts, &|(range, part)| {
        *part = Some(BodyGroup::new(pattern, range.clone(), interface, positions));
    });
    parts.into_iter().filter_map(|(_, part)| part).collect()
}

/// Springs of a slave node along n and t: k in series with the compliance of its bond.
fn springs(interface: &Interface, k: f64) -> [f64; 2] {
    interface.bond.give().map(|give| match give {
        0.0 => k,
        give => k / (1.0 + k * give),
    })
}

/// Component of a vector along a direction.
fn along(direction: [f64; 2], x: f64, y: f64) -> f64 {
    direction[0] * x + direction[1] * y
}

/// The interface's equations for [`CondensationPath::Direct`]: the masters' first, then x and y of every slave node. `None` if some body is
/// not a solid, a bond has a compliance, or a slave node cannot move in both directions, belongs to a master, or is listed twice.
fn direct_equations(model: &Model) -> Option<Vec<usize>> {
    let solid = |body: &Body| matches!(body.kind, BodyKind::Solid(_));
    let gives = |slave: &Contact| slave.bond.give() != [0.0; 2];
    if !model.bodies.iter().all(solid) || model.contacts.iter().any(gives) {
        return None;
    }
    let mut slaves = Vec::with_capacity(2 * model.contacts.len());
    for slave in &model.contacts {
        let first = model.dofs.first[slave.node];
        slaves.extend([model.dofs.equation[first]?, model.dofs.equation[first + 1]?]);
    }
    let mut is_slave = vec![false; model.dofs.equations];
    for &equation in &slaves {
        if std::mem::replace(&mut is_slave[equation], true) {
            return None;
        }
    }
    let masters = master_equations(model);
    if masters.iter().any(|&equation| is_slave[equation]) {
        return None;
    }
    Some(masters.into_iter().chain(slaves).collect())
}

/// The equations of all slave nodes and of the surfaces that they may touch, ascending.
pub(super) fn interface_equations(model: &Model) -> Vec<usize> {
    let slaves = model.contacts.iter().flat_map(Contact::carriers);
    let slaves = slaves.map(|(node, _)| node);
    distinct(equations_of(model, slaves).chain(master_equations(model)))
}

/// The equations of the surfaces that slave nodes may touch, ascending.
fn master_equations(model: &Model) -> Vec<usize> {
    let masters = model
        .contacts
        .iter()
        .flat_map(|slave| &slave.surfaces)
        .filter(|&&surface| !model.surfaces[surface].rigid)
        .flat_map(|&surface| model.surfaces[surface].nodes());
    distinct(equations_of(model, masters.copied()))
}

fn equations_of(model: &Model, nodes: impl Iterator<Item = usize>) -> impl Iterator<Item = usize> {
    nodes.flat_map(|node| {
        let first = model.dofs.first[node];
        (first..first + 2).filter_map(|dof| model.dofs.equation[dof])
    })
}
