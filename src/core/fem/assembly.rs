//! Assembles the bodies' internal forces and tangent stiffness (the K_s and K_m of eqn 5).
//!
//! The position of every entry of every element matrix is found once; assembly then only adds. Bodies with separate ranges of
//! entries are assembled in parallel ([`Executor`]), and so are the responses of many elements of one body. Each element adds to the
//! same entries in the same order, independent of the executor.

use crate::executor::{Executor, SequentialExecutor, each};
pub use crate::fem::assembled::AssemblyMotion;
use crate::fem::assembled::{AssembledElement, AssemblySums, ScatterMap};
use crate::fem::beam::{self, Section};
use crate::fem::continuum;
use crate::fem::element::{Element, Previous};
use crate::fem::isoparametric;
use crate::fem::matrix;
use crate::fem::small;
use crate::fem::truss;
use crate::linalg::Pattern;
use crate::model::{Beam, Body, BodyKind, Dofs, Solid, SolidElement, Truss};
use crate::{ElementOutput, Material, Model};
use std::ops::Range;
use std::sync::Arc;

/// A group of at least `MANY` elements is computed in batches of `BATCH` elements, of which `TOGETHER` are computed by one thread.
const MANY: usize = 1000;
const BATCH: usize = 128;
const TOGETHER: usize = 16;

/// All elements of all bodies.
pub struct Assembly {
    elements: Vec<AssembledElement>,
    /// Those with degrees of freedom without an equation, by number, with their tangents row by row; empty if not computed since
    /// the last assembly.
    held: Vec<(usize, Vec<f64>)>,
    /// Bodies given by a matrix.
    matrices: Vec<matrix::MatrixElement>,
    /// Whether only the upper half of the stiffness is assembled.
    half: bool,
    /// Number of history variables of the elements added so far.
    history_len: usize,
    /// Consecutive elements with separate ranges of entries; together all elements.
    groups: Vec<Group>,
    /// Runs the assembly.
    executor: Arc<dyn Executor>,
    room: Workspace,
    memory: Vec<f64>,
}

/// Workspace for the largest element, and the response of the last one.
#[derive(Clone, Default)]
struct Workspace {
    force: Vec<f64>,
    tangent: Vec<f64>,
    u: Vec<f64>,
    before: Vec<f64>,
    /// Whether the element has a response.
    answers: bool,
}

/// Elements that are assembled independently.
struct Group {
    elements: Range<usize>,
    /// First degree of freedom, entry and equation of the group.
    first: ScatterMap,
    /// One for each element of a batch.
    rooms: Vec<Workspace>,
}

impl Assembly {
    /// Creates the elements of a scene, for sequential assembly.
    pub fn new(model: &Model) -> Self {
        Assembly::with_executor(model, Arc::new(SequentialExecutor))
    }

    /// No elements.
    pub fn empty(executor: Arc<dyn Executor>) -> Self {
        Assembly {
            elements: Vec::new(),
            held: Vec::new(),
            matrices: Vec::new(),
            half: false,
            history_len: 0,
            groups: Vec::new(),
            executor,
            room: Workspace::default(),
            memory: Vec::new(),
        }
    }

    /// The same with an executor for parallel assembly.
    pub fn with_executor(model: &Model, executor: Arc<dyn Executor>) -> Self {
        let mut assembly = Assembly::empty(executor);
        for body in &model.bodies {
            match &body.kind {
                BodyKind::Beam(beam) => assembly.add_beam(model, beam),
                BodyKind::Solid(solid) => assembly.add_solid(model, solid),
                BodyKind::Truss(truss) => assembly.add_truss(model, truss),
                BodyKind::Linear(linear) => {
                    let element = matrix::MatrixElement::new(&model.dofs, body, linear);
                    assembly.matrices.push(element);
                }
            }
        }
        assembly
    }

    fn add_beam(&mut self, model: &Model, beam: &Beam) {
        let section = Section {
            ea: beam.ea,
            ei: beam.ei,
            ga: beam.ga,
        };
        for (e, nodes) in beam.elements.iter().enumerate() {
            let positions: Vec<[f64; 2]> = nodes.iter().map(|&n| model.nodes[n].at).collect();
            let element = beam::BeamElement::new(&positions, section);
            let mut dofs = dofs_of(model, nodes, 3);
            if let Some(first) = beam.first_shear {
                let points = element.gauss_points();
                dofs.extend((0..points).map(|p| first + e * points + p));
            }
            self.place(Box::new(element), dofs);
        }
    }

    fn add_solid(&mut self, model: &Model, solid: &Solid) {
        for SolidElement {
            kind,
            nodes,
            material,
        } in &solid.elements
        {
            let elastic = &solid.materials[*material];
            let positions: Vec<[f64; 2]> = nodes.iter().map(|&n| model.nodes[n].at).collect();
            let material = Material::new(elastic);
            let element =
                continuum::formulation(*kind).element(&positions, material, elastic.update);
            self.place(element, dofs_of(model, nodes, 2));
        }
    }

    fn add_truss(&mut self, model: &Model, truss: &Truss) {
        for bar in truss.bars.iter().filter(|bar| bar.len() == 2) {
            let element =
                truss::TrussElement::new([0, 1].map(|k| model.nodes[bar[k]].at), truss.ea);
            let element: Box<dyn Element> = if truss.small {
                Box::new(small::SmallStrainElement::new(&element))
            } else {
                Box::new(element)
            };
            self.place(element, dofs_of(model, bar, 2));
        }
    }

    fn place(&mut self, element: Box<dyn Element>, dofs: Vec<usize>) {
        let first = self.history_len;
        let remembered = element.history_len();
        self.history_len += remembered;
        self.room.hold(dofs.len());
        let most = self.memory.len().max(remembered);
        self.memory.resize(most, 0.0);
        self.elements.push(AssembledElement {
            element,
            dofs,
            slots: Vec::new(),
            held: true,
            history: first..self.history_len,
        });
    }

    /// Entries `(row, column)`, in equations, of all elements; may contain duplicates.
    pub fn entries<'a>(
        &'a self,
        dofs: &'a Dofs,
    ) -> impl Iterator<Item = (usize, usize)> + Clone + 'a {
        let of_elements = self.elements.iter().flat_map(|placed| {
            let equations = || placed.dofs.iter().filter_map(|&d| dofs.equation[d]);
            equations().flat_map(move |i| equations().map(move |j| (i, j)))
        });
        let matrices = self.matrices.iter();
        of_elements.chain(matrices.flat_map(|matrix| matrix.entries(dofs)))
    }

    /// Those of [`Assembly::entries`] in the upper half.
    pub fn upper_entries<'a>(
        &'a self,
        dofs: &'a Dofs,
    ) -> impl Iterator<Item = (usize, usize)> + Clone + 'a {
        let of_elements = self.elements.iter().flat_map(|placed| {
            let equations = placed.dofs.iter().filter_map(|&d| dofs.equation[d]);
            let mut equations: Vec<usize> = equations.collect();
            equations.sort_unstable();
            let (mut row, mut column) = (0, 0);
            std::iter::from_fn(move || {
                let entry = (*equations.get(row)?, *equations.get(column)?);
                (row, column) = match row == column {
                    true => (0, column + 1),
                    false => (row + 1, column),
                };
                Some(entry)
            })
        });
        let matrices = self.matrices.iter();
        let entries = matrices.flat_map(|matrix| matrix.entries(dofs));
        of_elements.chain(entries.filter(|(row, column)| row <= column))
    }

    /// Looks up every entry in a pattern that contains them all, or, for a symmetric stiffness, those of the upper `half`.
    pub fn bind(&mut self, dofs: &Dofs, pattern: &Pattern, half: bool) {
        let whole = 0..pattern.size();
        self.bind_parts(dofs, pattern, half, std::slice::from_ref(&whole));
    }

    /// The same if no element has entries in more than one of these `parts` of the equations, which are assembled in parallel.
    pub fn bind_parts(
        &mut self,
        dofs: &Dofs,
        pattern: &Pattern,
        half: bool,
        parts: &[Range<usize>],
    ) {
        self.half = half;
        let groups = self.groups_of(dofs, pattern, parts);
        self.groups = groups.unwrap_or_else(|| vec![self.whole()]);
        for group in &mut self.groups {
            let many = group.elements.len() >= MANY;
            group.rooms = vec![self.room.clone(); if many { BATCH } else { 1 }];
        }
        let mut batches: Vec<_> = self.elements.chunks_mut(MANY).collect();
        each(&*self.executor, &mut batches, &|batch| {
            batch
                .iter_mut()
                .for_each(|placed| placed.bind(dofs, pattern, half));
        });
        for matrix in &mut self.matrices {
            matrix.bind(dofs, pattern);
        }
        let held = (0..self.elements.len()).filter(|&k| self.elements[k].held);
        self.held = held.map(|k| (k, Vec::new())).collect();
    }

    /// All elements.
    fn whole(&self) -> Group {
        Group {
            elements: 0..self.elements.len(),
            first: ScatterMap::default(),
            rooms: Vec::new(),
        }
    }

    /// One group of elements per part of the equations; `None` if their entries are not separate and in the same order.
    fn groups_of(
        &self,
        dofs: &Dofs,
        pattern: &Pattern,
        parts: &[Range<usize>],
    ) -> Option<Vec<Group>> {
        let mut groups: Vec<Group> = Vec::with_capacity(parts.len());
        // The part of the last element, and the degrees of freedom reached so far.
        let (mut at, mut reach) = (0, 0);
        for (k, placed) in self.elements.iter().enumerate() {
            let least = placed.dofs.iter().copied().min()?;
            let equation = placed.dofs.iter().find_map(|&d| dofs.equation[d]);
            let part = equation.map_or(Some(at), |e| parts.iter().position(|p| p.contains(&e)))?;
            if groups.is_empty() || part > at {
                // There are no parts if every degree of freedom is restrained.
                let start = parts.get(part)?.start;
                if least < reach {
                    return None;
                }
                groups.push(Group {
                    elements: k..k,
                    first: ScatterMap {
                        dof: if k == 0 { 0 } else { least },
                        slot: pattern.start(start),
                        equation: start,
                    },
                    rooms: Vec::new(),
                });
            }
            let group = groups.last_mut()?;
            if part < at || least < group.first.dof {
                return None;
            }
            group.elements.end = k + 1;
            (at, reach) = (part, reach.max(placed.dofs.iter().max()? + 1));
        }
        // Entries without an element belong to the first group.
        groups.first_mut()?.first = ScatterMap::default();
        Some(groups)
    }

    /// Internal forces and tangent.
    pub fn assemble(&mut self, dofs: &Dofs, moved: AssemblyMotion<'_>, mut out: ElementOutput<'_>) {
        out.force.fill(0.0);
        out.size.fill(0.0);
        out.values.fill(0.0);
        out.coupling.fill(0.0);
        self.held.iter_mut().for_each(|(_, known)| known.clear());
        let work = AssemblyWork {
            executor: &*self.executor,
            elements: &self.elements,
            half: self.half,
            dofs,
            moved,
        };
        let sums = AssemblySums {
            first: ScatterMap::default(),
            out: ElementOutput {
                force: &mut *out.force,
                size: &mut *out.size,
                values: &mut *out.values,
                coupling: &mut *out.coupling,
            },
        };
        work.all(&mut self.groups, sums);
        for matrix in &self.matrices {
            matrix.add(dofs, moved.u, moved.step, &mut out);
        }
    }

    /// Internal forces only, with the same bits as [`Assembly::assemble`].
    pub fn resist(&mut self, moved: AssemblyMotion<'_>, force: &mut [f64], size: &mut [f64]) {
        force.fill(0.0);
        size.fill(0.0);
        let compute = |placed: &AssembledElement, room: &mut Workspace| {
            room.compute(placed, &moved, |past, u, force, tangent| {
                placed.element.resist(past, u, force, tangent)
            });
        };
        let mut add = |placed: &AssembledElement, room: &Workspace| {
            for (&d, own) in placed.dofs.iter().zip(&room.force) {
                // No finite force is in balance if an element has no response.
                force[d] += if room.answers { *own } else { f64::INFINITY };
                size[d] += if room.answers { own.abs() } else { 0.0 };
            }
        };
        for group in &mut self.groups {
            let elements = &self.elements[group.elements.clone()];
            in_batches(
                &*self.executor,
                elements,
                &mut group.rooms,
                &compute,
                &mut add,
            );
        }
        for matrix in &self.matrices {
            matrix.resist(moved.u, force, size);
        }
    }

    /// Forces at the equations due to `step` of the degrees of freedom without an equation, as in [`Assembly::assemble`], which
    /// was called last with the same displacements.
    pub fn couple(&mut self, dofs: &Dofs, moved: AssemblyMotion<'_>, coupling: &mut [f64]) {
        coupling.fill(0.0);
        for (number, known) in &mut self.held {
            let placed = &self.elements[*number];
            if placed.dofs.iter().all(|&dof| moved.step[dof] == 0.0) {
                continue;
            }
            if known.is_empty() {
                let room = &mut self.room;
                room.compute(placed, &moved, |past, u, force, tangent| {
                    tangent.fill(0.0);
                    placed.element.add(past, u, force, tangent)
                });
                let tangent = &mut room.tangent[..placed.dofs.len().pow(2)];
                match room.answers {
                    true => placed.element.mirror(tangent),
                    false => tangent.fill(0.0),
                }
                known.extend_from_slice(tangent);
            }
            placed.couple(dofs, known, moved.step, coupling, 0);
        }
        for matrix in &self.matrices {
            matrix.couple(dofs, moved.step, coupling);
        }
    }

    /// Updates the history variables when displacements `u` are accepted; `before` are those accepted last.
    pub fn advance(&mut self, u: &[f64], before: &[f64], history: &mut [f64]) {
        for placed in self.elements.iter().filter(|p| !p.history.is_empty()) {
            let n = placed.dofs.len();
            placed.gather(u, &mut self.room.u[..n]);
            placed.gather(before, &mut self.room.before[..n]);
            let history = &mut history[placed.history.clone()];
            let old = &mut self.memory[..history.len()];
            old.copy_from_slice(history);
            let past = Previous {
                u: &self.room.before[..n],
                history: old,
            };
            placed.element.advance(&past, &self.room.u[..n], history);
        }
    }
}

/// Input of an assembly.
#[derive(Clone, Copy)]
struct AssemblyWork<'a> {
    executor: &'a dyn Executor,
    elements: &'a [AssembledElement],
    half: bool,
    dofs: &'a Dofs,
    moved: AssemblyMotion<'a>,
}

impl AssemblyWork<'_> {
    /// Assembles these groups.
    fn all(self, groups: &mut [Group], mut sums: AssemblySums<'_>) {
        match groups {
            [] => {}
            [group] => self.group(group, &mut sums),
            _ => {
                let (left, right) = groups.split_at_mut(groups.len() / 2);
                let (mut before, mut after) = sums.split_at(right[0].first);
                self.executor
                    .join(&mut || self.all(&mut *left, before.reborrow()), &mut || {
                        self.all(&mut *right, after.reborrow())
                    });
            }
        }
    }

    fn group(self, group: &mut Group, sums: &mut AssemblySums<'_>) {
        let compute = |placed: &AssembledElement, room: &mut Workspace| {
            room.compute(placed, &self.moved, |past, u, force, tangent| {
                tangent.fill(0.0);
                let answers = placed.element.add(past, u, force, tangent);
                if answers && (placed.held || !self.half) {
                    placed.element.mirror(tangent);
                }
                answers
            });
        };
        let mut add = |placed: &AssembledElement, room: &Workspace| {
            if !room.answers {
                return placed.give_up(sums);
            }
            let n = placed.dofs.len();
            let tangent = &room.tangent[..n * n];
            placed.scatter(&room.force[..n], tangent, sums);
            if placed.held {
                let (step, first) = (self.moved.step, sums.first.equation);
                placed.couple(self.dofs, tangent, step, sums.out.coupling, first);
            }
        };
        let elements = &self.elements[group.elements.clone()];
        in_batches(
            self.executor,
            elements,
            &mut group.rooms,
            &compute,
            &mut add,
        );
    }
}

/// Computes all elements, as many at the same time as there are rooms, and adds each in order.
fn in_batches(
    executor: &dyn Executor,
    elements: &[AssembledElement],
    rooms: &mut [Workspace],
    compute: &(dyn Fn(&AssembledElement, &mut Workspace) + Sync),
    add: &mut (dyn FnMut(&AssembledElement, &Workspace) + Send),
) {
    let mut all = || {
        for batch in elements.chunks(rooms.len()) {
            let rooms = &mut rooms[..batch.len()];
            side_by_side(executor, batch, rooms, compute);
            batch
                .iter()
                .zip(&*rooms)
                .for_each(|(placed, room)| add(placed, room));
        }
    };
    if elements.len() >= MANY {
        // The batches are short, so the executor's threads are entered only once.
        executor.join(&mut all, &mut || {});
    } else {
        all();
    }
}

/// Computes elements, some on each thread.
fn side_by_side(
    executor: &dyn Executor,
    elements: &[AssembledElement],
    rooms: &mut [Workspace],
    compute: &(dyn Fn(&AssembledElement, &mut Workspace) + Sync),
) {
    if elements.len() <= TOGETHER {
        return elements
            .iter()
            .zip(rooms)
            .for_each(|(placed, room)| compute(placed, room));
    }
    let middle = elements.len() / 2;
    let (left, right) = elements.split_at(middle);
    let (before, after) = rooms.split_at_mut(middle);
    executor.join(
        &mut || side_by_side(executor, left, before, compute),
        &mut || side_by_side(executor, right, after, compute),
    );
}

impl Workspace {
    /// Resizes for an element with `count` degrees of freedom.
    fn hold(&mut self, count: usize) {
        let size = self.force.len().max(count);
        for buffer in [&mut self.force, &mut self.u, &mut self.before] {
            buffer.resize(size, 0.0);
        }
        self.tangent.resize(size * size, 0.0);
    }

    /// The response of an element by its function of the past, the displacements, the force, and the tangent.
    fn compute(
        &mut self,
        placed: &AssembledElement,
        moved: &AssemblyMotion<'_>,
        respond: impl FnOnce(&Previous<'_>, &[f64], &mut [f64], &mut [f64]) -> bool,
    ) {
        let n = placed.dofs.len();
        let (u, before) = (&mut self.u[..n], &mut self.before[..n]);
        let (force, tangent) = (&mut self.force[..n], &mut self.tangent[..n * n]);
        let past = placed.gather_all(moved, u, before);
        force.fill(0.0);
        self.answers = respond(&past, u, force, tangent);
    }
}

/// Number of history variables of a scene's elements.
pub fn history_len(model: &Model) -> usize {
    let of = |body: &Body| match &body.kind {
        BodyKind::Beam(_) | BodyKind::Truss(_) | BodyKind::Linear(_) => 0,
        BodyKind::Solid(solid) => {
            let of = |element: &SolidElement| {
                let update = solid.materials[element.material].update;
                isoparametric::history_len(update, element.kind.points())
            };
            solid.elements.iter().map(of).sum()
        }
    };
    model.bodies.iter().map(of).sum()
}

/// The first `count` degrees of freedom of each node.
fn dofs_of(model: &Model, nodes: &[usize], count: usize) -> Vec<usize> {
    let of_node = |&n: &usize| (0..count).map(move |k| model.dofs.first[n] + k);
    nodes.iter().flat_map(of_node).collect()
}
