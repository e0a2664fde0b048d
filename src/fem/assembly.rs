//! Assembly of the bodies' internal forces and tangent stiffness (the K_s and K_m of eqn 5).
//!
//! Where every entry of every element goes is found once; assembling then only adds.

use crate::fem::beam::{Element, MAX_DOFS, Section};
use crate::linalg::Pattern;
use crate::scene::Model;
use crate::scene::model::{BodyKind, Dofs};

/// An entry of an element's matrix that has no place in the system, since it is restrained.
const NOWHERE: usize = usize::MAX;

/// An element and where it stands.
struct Placed {
    element: Element,
    /// Degrees of freedom of the scene, in the element's order.
    dofs: Vec<usize>,
    /// Place in the array of values of each entry of the element's matrix, row by row.
    slots: Vec<usize>,
}

/// All elements of all bodies.
pub struct Assembly {
    elements: Vec<Placed>,
    force: [f64; MAX_DOFS],
    tangent: Vec<f64>,
    u: [f64; MAX_DOFS],
}

/// What [`Assembly::assemble`] fills, all of it overwritten.
pub struct Assembled<'a> {
    /// Internal force at each degree of freedom, restrained ones included (there it is what the support carries).
    pub force: &'a mut [f64],
    /// Sum of the sizes of the element forces at each degree of freedom: the scale of `force`.
    pub size: &'a mut [f64],
    /// Values of the tangent stiffness in the bound pattern.
    pub values: &'a mut [f64],
    /// Force at each equation due to `step` of the degrees of freedom that have none.
    pub coupling: &'a mut [f64],
}

impl Assembly {
    /// Lays out the elements of a scene.
    pub fn new(model: &Model) -> Self {
        let mut elements = Vec::new();
        for body in &model.bodies {
            let BodyKind::Beam(beam) = &body.kind;
            let section = Section {
                ea: beam.ea,
                ei: beam.ei,
                ga: beam.ga,
            };
            for (e, nodes) in beam.elements.iter().enumerate() {
                let positions: Vec<[f64; 2]> = nodes.iter().map(|&n| model.nodes[n].at).collect();
                let element = Element::new(&positions, section);
                let mut dofs: Vec<usize> = nodes
                    .iter()
                    .flat_map(|&n| (0..3).map(move |k| model.dofs.first[n] + k))
                    .collect();
                if let Some(first) = beam.first_shear {
                    let points = element.gauss_points();
                    dofs.extend((0..points).map(|p| first + e * points + p));
                }
                elements.push(Placed {
                    element,
                    dofs,
                    slots: Vec::new(),
                });
            }
        }
        Assembly {
            elements,
            force: [0.0; MAX_DOFS],
            tangent: vec![0.0; MAX_DOFS * MAX_DOFS],
            u: [0.0; MAX_DOFS],
        }
    }

    /// Entries `(row, column)`, in equations, that the elements have; some repeat.
    pub fn entries(&self, dofs: &Dofs) -> Vec<(usize, usize)> {
        let mut entries = Vec::new();
        for placed in &self.elements {
            let equations = || placed.dofs.iter().filter_map(|&d| dofs.equation[d]);
            entries.extend(equations().flat_map(|i| equations().map(move |j| (i, j))));
        }
        entries
    }

    /// Finds the place of every entry in a pattern that has them all.
    pub fn bind(&mut self, dofs: &Dofs, pattern: &Pattern) {
        for placed in &mut self.elements {
            let equation = |d: &usize| dofs.equation[*d];
            placed.slots = placed
                .dofs
                .iter()
                .flat_map(|i| placed.dofs.iter().map(move |j| (equation(i), equation(j))))
                .map(|pair| match pair {
                    (Some(i), Some(j)) => pattern.slot(i, j).unwrap_or(NOWHERE),
                    _ => NOWHERE,
                })
                .collect();
        }
    }

    /// Internal forces and tangent at displacements `u`; `step` is the change that the degrees of freedom without
    /// an equation make in this major iteration.
    pub fn assemble(&mut self, dofs: &Dofs, u: &[f64], step: &[f64], out: Assembled<'_>) {
        out.force.fill(0.0);
        out.size.fill(0.0);
        out.values.fill(0.0);
        out.coupling.fill(0.0);
        for placed in &self.elements {
            let n = placed.dofs.len();
            let (local, force) = (&mut self.u[..n], &mut self.force[..n]);
            let tangent = &mut self.tangent[..n * n];
            for (local, &d) in local.iter_mut().zip(&placed.dofs) {
                *local = u[d];
            }
            force.fill(0.0);
            tangent.fill(0.0);
            placed.element.add(local, force, tangent);
            for (i, &d) in placed.dofs.iter().enumerate() {
                out.force[d] += force[i];
                out.size[d] += force[i].abs();
                let row = &tangent[i * n..(i + 1) * n];
                for (value, &slot) in row.iter().zip(&placed.slots[i * n..(i + 1) * n]) {
                    if slot != NOWHERE {
                        out.values[slot] += value;
                    }
                }
                let Some(equation) = dofs.equation[d] else {
                    continue;
                };
                for (value, &other) in row.iter().zip(&placed.dofs) {
                    if dofs.equation[other].is_none() {
                        out.coupling[equation] += value * step[other];
                    }
                }
            }
        }
    }
}
