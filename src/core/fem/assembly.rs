//! Assembly of the bodies' internal forces and tangent stiffness (the K_s and K_m of eqn 5).
//!
//! Where every entry of every element goes is found once; assembling then only adds.

use crate::fem::beam::{self, Section};
use crate::fem::continuum;
use crate::fem::element::{Assembled, Element, Past};
use crate::fem::material::Material;
use crate::fem::matrix;
use crate::linalg::Pattern;
use crate::model::Model;
use crate::model::{Beam, Body, BodyKind, Dofs, Solid};
use std::ops::Range;

/// An element and where it stands.
struct Placed {
    element: Box<dyn Element>,
    /// Degrees of freedom of the scene, in the element's order.
    dofs: Vec<usize>,
    /// Entries of the element's matrix that have a place, by number (row by row), and their places in the array of
    /// values.
    slots: Vec<(u32, u32)>,
    /// Whether any of its degrees of freedom has no equation.
    held: bool,
    /// What it remembers, in the scene's history.
    history: Range<usize>,
}

/// All elements of all bodies.
pub struct Assembly {
    elements: Vec<Placed>,
    /// Bodies that are given by a matrix.
    matrices: Vec<matrix::Element>,
    /// Whether only the upper half of the stiffness is wanted.
    half: bool,
    /// Numbers that the elements placed so far remember.
    history_len: usize,
    /// Room for the largest element.
    force: Vec<f64>,
    tangent: Vec<f64>,
    u: Vec<f64>,
    before: Vec<f64>,
    memory: Vec<f64>,
}

/// How the degrees of freedom have moved.
#[derive(Debug, Clone, Copy)]
pub struct Moved<'a> {
    /// Displacements.
    pub u: &'a [f64],
    /// Change that the degrees of freedom without an equation make in this major iteration.
    pub step: &'a [f64],
    /// Displacements at the last accepted increment.
    pub before: &'a [f64],
    /// What the elements remember of that increment: [`history_len`] numbers, all zero before the first.
    pub history: &'a [f64],
}

impl Assembly {
    /// Lays out the elements of a scene.
    pub fn new(model: &Model) -> Self {
        let mut assembly = Assembly {
            elements: Vec::new(),
            matrices: Vec::new(),
            half: false,
            history_len: 0,
            force: Vec::new(),
            tangent: Vec::new(),
            u: Vec::new(),
            before: Vec::new(),
            memory: Vec::new(),
        };
        for body in &model.bodies {
            match &body.kind {
                BodyKind::Beam(beam) => assembly.add_beam(model, beam),
                BodyKind::Solid(solid) => assembly.add_solid(model, solid),
                BodyKind::Linear(linear) => {
                    let element = matrix::Element::new(&model.dofs, body, linear);
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
            let element = beam::Element::new(&positions, section);
            let mut dofs = dofs_of(model, nodes, 3);
            if let Some(first) = beam.first_shear {
                let points = element.gauss_points();
                dofs.extend((0..points).map(|p| first + e * points + p));
            }
            self.place(Box::new(element), dofs);
        }
    }

    fn add_solid(&mut self, model: &Model, solid: &Solid) {
        for (nodes, &material) in solid.elements.iter().zip(&solid.material_of) {
            let elastic = &solid.materials[material];
            let positions: Vec<[f64; 2]> = nodes.iter().map(|&n| model.nodes[n].at).collect();
            let material = Material::new(elastic);
            let element = continuum::element(solid.kind, &positions, material, elastic.update);
            self.place(element, dofs_of(model, nodes, 2));
        }
    }

    fn place(&mut self, element: Box<dyn Element>, dofs: Vec<usize>) {
        let first = self.history_len;
        let remembered = element.history_len();
        self.history_len += remembered;
        let size = self.force.len().max(dofs.len());
        for buffer in [&mut self.force, &mut self.u, &mut self.before] {
            buffer.resize(size, 0.0);
        }
        self.tangent.resize(size * size, 0.0);
        let most = self.memory.len().max(remembered);
        self.memory.resize(most, 0.0);
        self.elements.push(Placed {
            element,
            dofs,
            slots: Vec::new(),
            held: true,
            history: first..self.history_len,
        });
    }

    /// Entries `(row, column)`, in equations, that the elements have; some repeat.
    pub fn entries(&self, dofs: &Dofs) -> Vec<(usize, usize)> {
        let most = self.elements.iter().map(|p| p.dofs.len().pow(2)).sum();
        let mut entries = Vec::with_capacity(most);
        for placed in &self.elements {
            let equations = || placed.dofs.iter().filter_map(|&d| dofs.equation[d]);
            entries.extend(equations().flat_map(|i| equations().map(move |j| (i, j))));
        }
        for matrix in &self.matrices {
            entries.extend(matrix.entries(dofs));
        }
        entries
    }

    /// Finds the place of every entry in a pattern that has them all, or, of a symmetric stiffness, the upper `half`.
    pub fn bind(&mut self, dofs: &Dofs, pattern: &Pattern, half: bool) {
        self.half = half;
        for placed in &mut self.elements {
            placed.bind(dofs, pattern, half);
        }
        for matrix in &mut self.matrices {
            matrix.bind(dofs, pattern);
        }
    }

    /// Internal forces and tangent.
    pub fn assemble(&mut self, dofs: &Dofs, moved: Moved<'_>, mut out: Assembled<'_>) {
        out.force.fill(0.0);
        out.size.fill(0.0);
        out.values.fill(0.0);
        out.coupling.fill(0.0);
        for placed in &self.elements {
            let n = placed.dofs.len();
            let (u, before) = (&mut self.u[..n], &mut self.before[..n]);
            let (force, tangent) = (&mut self.force[..n], &mut self.tangent[..n * n]);
            placed.gather(moved.u, u);
            force.fill(0.0);
            tangent.fill(0.0);
            let history = &moved.history[placed.history.clone()];
            if !history.is_empty() {
                placed.gather(moved.before, before);
            }
            let past = Past { u: before, history };
            if !placed.element.add(&past, u, force, tangent) {
                placed.give_up(&mut out);
                continue;
            }
            if placed.held || !self.half {
                placed.element.mirror(tangent);
            }
            placed.scatter(force, tangent, &mut out);
            if placed.held {
                placed.couple(dofs, tangent, moved.step, out.coupling);
            }
        }
        for matrix in &self.matrices {
            matrix.add(dofs, moved.u, moved.step, &mut out);
        }
    }

    /// Renews what the elements remember, once displacements `u` are accepted; `before` are those accepted last.
    pub fn advance(&mut self, u: &[f64], before: &[f64], history: &mut [f64]) {
        for placed in self.elements.iter().filter(|p| !p.history.is_empty()) {
            let n = placed.dofs.len();
            placed.gather(u, &mut self.u[..n]);
            placed.gather(before, &mut self.before[..n]);
            let history = &mut history[placed.history.clone()];
            let old = &mut self.memory[..history.len()];
            old.copy_from_slice(history);
            let past = Past {
                u: &self.before[..n],
                history: old,
            };
            placed.element.advance(&past, &self.u[..n], history);
        }
    }
}

/// How many numbers the elements of a scene remember from increment to increment.
pub fn history_len(model: &Model) -> usize {
    let of = |body: &Body| match &body.kind {
        BodyKind::Beam(_) | BodyKind::Linear(_) => 0,
        BodyKind::Solid(solid) => {
            let of = |&m: &usize| continuum::history_len(solid.kind, solid.materials[m].update);
            solid.material_of.iter().map(of).sum()
        }
    };
    model.bodies.iter().map(of).sum()
}

/// The first `count` degrees of freedom of each node.
fn dofs_of(model: &Model, nodes: &[usize], count: usize) -> Vec<usize> {
    let of_node = |&n: &usize| (0..count).map(move |k| model.dofs.first[n] + k);
    nodes.iter().flat_map(of_node).collect()
}

impl Placed {
    fn bind(&mut self, dofs: &Dofs, pattern: &Pattern, half: bool) {
        let equation = |d: &usize| dofs.equation[*d];
        let n = self.dofs.len();
        self.held = self.dofs.iter().any(|d| equation(d).is_none());
        self.slots.clear();
        for (i, row) in self.dofs.iter().enumerate() {
            // Of the upper half, each pair once, wherever the pattern has it.
            let first = if half { i } else { 0 };
            for (j, column) in self.dofs.iter().enumerate().skip(first) {
                let (Some(row), Some(column)) = (equation(row), equation(column)) else {
                    continue;
                };
                let slot = if half {
                    pattern.slot(row.min(column), row.max(column))
                } else {
                    pattern.slot(row, column)
                };
                let pair = u32::try_from(i * n + j).ok();
                let slot = slot.and_then(|slot| u32::try_from(slot).ok());
                self.slots.extend(pair.zip(slot));
            }
        }
    }

    fn gather(&self, from: &[f64], to: &mut [f64]) {
        for (to, &d) in to.iter_mut().zip(&self.dofs) {
            *to = from[d];
        }
    }

    fn scatter(&self, force: &[f64], tangent: &[f64], out: &mut Assembled<'_>) {
        for (&d, force) in self.dofs.iter().zip(force) {
            out.force[d] += force;
            out.size[d] += force.abs();
        }
        for &(entry, slot) in &self.slots {
            out.values[slot as usize] += tangent[entry as usize];
        }
    }

    /// Forces due to the steps of degrees of freedom without an equation.
    fn couple(&self, dofs: &Dofs, tangent: &[f64], step: &[f64], coupling: &mut [f64]) {
        for (row, &d) in tangent.chunks_exact(self.dofs.len()).zip(&self.dofs) {
            let Some(equation) = dofs.equation[d] else {
                continue;
            };
            for (value, &other) in row.iter().zip(&self.dofs) {
                if dofs.equation[other].is_none() {
                    coupling[equation] += value * step[other];
                }
            }
        }
    }

    /// No finite force balances anything here. The scale of forces stays finite, so that the residual does not.
    fn give_up(&self, out: &mut Assembled<'_>) {
        self.dofs.iter().for_each(|&d| out.force[d] = f64::INFINITY);
    }
}
