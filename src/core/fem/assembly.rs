//! Assembles the bodies' internal forces and tangent stiffness (the K_s and K_m of eqn 5).
//!
//! The position of every entry of every element matrix is found once; assembly then only adds. Many elements are split at a degree
//! of freedom into those before it and those after it, which share no entries and are assembled in parallel ([`Executor`]), and
//! those across it, which follow. Each entry is added to in the same order with any executor.

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
use crate::linalg::{Pattern, SolveError};
use crate::model::{Beam, Body, BodyKind, Dofs, Solid, SolidElement, Truss};
use crate::{ElementOutput, Material, Model};
use std::ops::Range;
use std::sync::Arc;

/// A group of at least `MANY` elements is split if this saves at least the fraction `SAVED` of the time on two threads. Many that
/// are not split are computed in batches of `BATCH` elements, of which `TOGETHER` are computed by one thread.
const MANY: usize = 1000;
const SAVED: f64 = 0.25;
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
    /// All elements.
    group: Group,
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

/// Elements that are assembled together.
#[derive(Default)]
struct Group {
    /// Two groups without common degrees of freedom, assembled first.
    halves: Option<Box<[Group; 2]>>,
    /// Numbers of the elements that follow.
    elements: Vec<u32>,
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
            group: Group::default(),
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

    /// The pattern of the upper half, in equations, with the whole diagonal.
    ///
    /// # Errors
    /// [`SolveError::OutOfMemory`].
    pub fn upper_pattern(&self, dofs: &Dofs) -> Result<Pattern, SolveError> {
        let (mut starts, mut coupled) = (vec![0], Vec::new());
        let mut list = |equations: &mut dyn Iterator<Item = usize>| {
            let start = coupled.len();
            coupled.extend(equations.map(|equation| equation as u32));
            coupled[start..].sort_unstable();
            starts.push(coupled.len());
        };
        for placed in &self.elements {
            list(&mut placed.dofs.iter().filter_map(|&d| dofs.equation[d]));
        }
        for (row, column) in self.matrices.iter().flat_map(|m| m.entries(dofs)) {
            if row <= column {
                list(&mut [row, column].into_iter());
            }
        }
        Pattern::upper_from_lists(dofs.equations, (&starts, &coupled), &*self.executor)
    }

    /// Looks up every entry in a pattern that contains them all, or, for a symmetric stiffness, those of the upper `half`.
    pub fn bind(&mut self, dofs: &Dofs, pattern: &Pattern, half: bool) {
        self.half = half;
        let spans: Vec<Range<usize>> = self.elements.iter().map(AssembledElement::span).collect();
        let all = (0..self.elements.len() as u32).collect();
        // The next equation from each degree of freedom on.
        let mut next = vec![dofs.equations; dofs.len() + 1];
        for (dof, equation) in dofs.equation.iter().enumerate().rev() {
            next[dof] = equation.unwrap_or(next[dof + 1]);
        }
        let start = |dof: usize| ScatterMap {
            dof,
            slot: pattern.start(next[dof]),
            equation: next[dof],
        };
        self.group = Group::new(all, ScatterMap::default(), &spans, &start, &self.room);
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

    /// Internal forces and tangent.
    pub fn assemble(&mut self, dofs: &Dofs, moved: AssemblyMotion<'_>, mut out: ElementOutput<'_>) {
        self.held.iter_mut().for_each(|(_, known)| known.clear());
        self.add(Some(dofs), moved, &mut out);
        for matrix in &self.matrices {
            matrix.add(dofs, moved.u, moved.step, &mut out);
        }
    }

    /// Internal forces only, with the same bits as [`Assembly::assemble`].
    pub fn resist(&mut self, moved: AssemblyMotion<'_>, force: &mut [f64], size: &mut [f64]) {
        let mut out = ElementOutput {
            force,
            size,
            values: &mut [],
            coupling: &mut [],
        };
        self.add(None, moved, &mut out);
        for matrix in &self.matrices {
            matrix.resist(moved.u, out.force, out.size);
        }
    }

    /// Adds all elements; the tangents too with the equations of the degrees of freedom.
    fn add(&mut self, dofs: Option<&Dofs>, moved: AssemblyMotion<'_>, out: &mut ElementOutput<'_>) {
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
        work.all(&mut self.group, sums);
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
    /// `None` if only forces are assembled.
    dofs: Option<&'a Dofs>,
    moved: AssemblyMotion<'a>,
}

impl AssemblyWork<'_> {
    /// Assembles a group, its halves first.
    fn all(self, group: &mut Group, mut sums: AssemblySums<'_>) {
        if let Some([left, right]) = group.halves.as_deref_mut() {
            let (mut before, mut after) = sums.split_at(right.first);
            self.executor
                .join(&mut || self.all(left, before.reborrow()), &mut || {
                    self.all(right, after.reborrow())
                });
        } else {
            sums.clear();
        }
        self.own(group, &mut sums);
    }

    fn own(self, group: &mut Group, sums: &mut AssemblySums<'_>) {
        let compute = |placed: &AssembledElement, room: &mut Workspace| {
            room.compute(placed, &self.moved, |past, u, force, tangent| {
                if self.dofs.is_none() {
                    return placed.element.resist(past, u, force, tangent);
                }
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
            placed.add_forces(&room.force[..n], sums);
            let Some(dofs) = self.dofs else { return };
            let tangent = &room.tangent[..n * n];
            placed.scatter(tangent, sums);
            if placed.held {
                let (step, first) = (self.moved.step, sums.first.equation);
                placed.couple(dofs, tangent, step, sums.out.coupling, first);
            }
        };
        self.in_batches(&group.elements, &mut group.rooms, &compute, &mut add);
    }

    /// Computes elements, as many at the same time as there are rooms, and adds each in order.
    fn in_batches(
        self,
        numbers: &[u32],
        rooms: &mut [Workspace],
        compute: &(dyn Fn(&AssembledElement, &mut Workspace) + Sync),
        add: &mut (dyn FnMut(&AssembledElement, &Workspace) + Send),
    ) {
        let mut all = || {
            for batch in numbers.chunks(rooms.len().max(1)) {
                let rooms = &mut rooms[..batch.len()];
                self.side_by_side(batch, rooms, compute);
                for (&k, room) in batch.iter().zip(&*rooms) {
                    add(&self.elements[k as usize], room);
                }
            }
        };
        if numbers.len() >= MANY {
            // The batches are short, so the executor's threads are entered only once.
            self.executor.join(&mut all, &mut || {});
        } else {
            all();
        }
    }

    /// Computes elements, some on each thread.
    fn side_by_side(
        self,
        numbers: &[u32],
        rooms: &mut [Workspace],
        compute: &(dyn Fn(&AssembledElement, &mut Workspace) + Sync),
    ) {
        if numbers.len() <= TOGETHER {
            let all = numbers.iter().zip(rooms);
            return all.for_each(|(&k, room)| compute(&self.elements[k as usize], room));
        }
        let middle = numbers.len() / 2;
        let (left, right) = numbers.split_at(middle);
        let (before, after) = rooms.split_at_mut(middle);
        self.executor.join(
            &mut || self.side_by_side(left, before, compute),
            &mut || self.side_by_side(right, after, compute),
        );
    }
}

impl Group {
    /// The group of these elements, whose degrees of freedom are in `spans`. `start` gives the start indices from a degree of
    /// freedom on.
    fn new(
        elements: Vec<u32>,
        first: ScatterMap,
        spans: &[Range<usize>],
        start: &dyn Fn(usize) -> ScatterMap,
        room: &Workspace,
    ) -> Self {
        let rooms = |elements: &[u32]| {
            let many = elements.len() >= MANY;
            vec![room.clone(); if many { BATCH } else { 1 }]
        };
        let Some(dof) = best_cut(&elements, spans) else {
            return Group {
                halves: None,
                rooms: rooms(&elements),
                elements,
                first,
            };
        };
        let mut parts = [Vec::new(), Vec::new(), Vec::new()];
        for k in elements {
            let span = &spans[k as usize];
            let which = match (span.end <= dof, span.start >= dof) {
                (true, _) => 0,
                (_, true) => 1,
                _ => 2,
            };
            parts[which].push(k);
        }
        let [before, after, across] = parts;
        let halves = [(before, first), (after, start(dof))]
            .map(|(elements, first)| Group::new(elements, first, spans, start, room));
        Group {
            halves: Some(Box::new(halves)),
            rooms: rooms(&across),
            elements: across,
            first,
        }
    }
}

/// The degree of freedom at which many elements are split: the longer half and the elements across the cut, which follow, are as
/// few as possible. `None` if little is saved.
fn best_cut(elements: &[u32], spans: &[Range<usize>]) -> Option<usize> {
    if elements.len() < MANY {
        return None;
    }
    let sorted = |of: fn(&Range<usize>) -> usize| {
        let mut ends: Vec<usize> = elements.iter().map(|&k| of(&spans[k as usize])).collect();
        ends.sort_unstable();
        ends
    };
    let (starts, ends) = (sorted(|span| span.start), sorted(|span| span.end));
    let (mut best, mut before) = ((elements.len(), None), 0);
    for (k, &dof) in starts.iter().enumerate() {
        if k > 0 && starts[k - 1] == dof {
            continue;
        }
        while before < ends.len() && ends[before] <= dof {
            before += 1;
        }
        let (across, after) = (k - before, elements.len() - k);
        let time = before.max(after) + across;
        if time < best.0 {
            best = (time, Some(dof));
        }
    }
    let saves = best.0 as f64 <= (1.0 - SAVED) * elements.len() as f64;
    best.1.filter(|_| saves)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The elements of chains of bars between consecutive degrees of freedom, numbered from `first` on in steps.
    fn chain(first: usize, count: usize, step: usize) -> impl Iterator<Item = Range<usize>> {
        let place = move |k: usize| first + (k * step) % count;
        (0..count - 1).map(move |k| {
            let ends = [place(k), place(k + 1)];
            ends[0].min(ends[1])..ends[0].max(ends[1]) + 1
        })
    }

    #[test]
    fn elements_are_cut_where_few_or_none_are_across() {
        let numbers: Vec<u32> = (0..3000).collect();
        let in_order: Vec<_> = chain(0, 3001, 1).collect();
        let cut = best_cut(&numbers, &in_order).unwrap();
        assert!((1490..1510).contains(&cut), "{cut}");
        // Neighbours are far apart in number.
        let scattered: Vec<_> = chain(0, 3001, 1234).collect();
        assert_eq!(best_cut(&numbers, &scattered), None);
        // Between two bodies, although neither can be cut.
        let two: Vec<_> = chain(0, 2000, 739).chain(chain(2000, 1002, 379)).collect();
        assert_eq!(best_cut(&numbers, &two), Some(2000));
        assert_eq!(best_cut(&numbers[..MANY - 1], &in_order), None);
    }
}
