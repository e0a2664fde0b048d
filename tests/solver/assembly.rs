//! Large meshes are assembled in parts: forces and tangent are complete, fresh, and the same on several threads.

use std::sync::Arc;
use stickslip::executor::{Executor, SequentialExecutor};
use stickslip::fem::assembly::{Assembly, AssemblyMotion};
use stickslip::fem::element::ElementOutput;
use stickslip::linalg::Pattern;
use stickslip::model::Model;
use stickslip::scene::Scene;

/// Runs the first task on a new thread.
struct Threads;

impl Executor for Threads {
    fn join(&self, first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
        std::thread::scope(|scope| {
            scope.spawn(first);
            second();
        });
    }
}

/// Two blocks of 2,000 elements and more.
fn blocks() -> Model {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/benches/two-blocks-pressed-sheared.ron"
    );
    let set = [("refine".to_owned(), "8".to_owned())];
    Scene::open(file, &set).unwrap().model
}

/// Displacements that are the same in every run.
fn displaced(model: &Model, size: f64) -> Vec<f64> {
    let of = |dof: usize| size * (12.9898 * dof as f64).sin();
    (0..model.dofs.len()).map(of).collect()
}

/// Forces, magnitudes, entries, coupling.
type Sums = [Vec<f64>; 4];

/// An assembly into arrays that contain something else before.
fn assembled(model: &Model, pattern: &Pattern, half: bool, executor: Arc<dyn Executor>) -> Sums {
    let mut assembly = Assembly::with_executor(model, executor);
    assembly.bind(&model.dofs, pattern, half);
    let stale = |count: usize| vec![f64::NAN; count];
    let (dofs, equations) = (model.dofs.len(), model.dofs.equations);
    let mut sums = [dofs, dofs, pattern.entries(), equations].map(stale);
    let [force, size, values, coupling] = &mut sums;
    let (u, step) = (displaced(model, 1e-4), displaced(model, 1e-3));
    let moved = AssemblyMotion {
        u: &u,
        step: &step,
        before: &u,
        history: &[],
    };
    let out = ElementOutput {
        force,
        size,
        values,
        coupling,
    };
    assembly.assemble(&model.dofs, moved, out);
    let (mut force, mut size) = (stale(dofs), stale(dofs));
    assembly.resist(moved, &mut force, &mut size);
    assert!([&force, &size] == [&sums[0], &sums[1]], "forces alone");
    sums
}

/// The forces of displacements alone.
fn forces(model: &Model, pattern: &Pattern, u: &[f64]) -> Vec<f64> {
    let mut assembly = Assembly::new(model);
    assembly.bind(&model.dofs, pattern, true);
    let moved = AssemblyMotion {
        u,
        step: u,
        before: u,
        history: &[],
    };
    let (mut force, mut size) = (vec![0.0; u.len()], vec![0.0; u.len()]);
    assembly.resist(moved, &mut force, &mut size);
    force
}

#[test]
fn the_tangent_of_a_large_mesh_is_the_derivative_of_its_forces() {
    let model = blocks();
    let pattern = Assembly::new(&model).upper_pattern(&model.dofs).unwrap();
    let [force, _, values, coupling] =
        assembled(&model, &pattern, true, Arc::new(SequentialExecutor));
    let (u, step) = (displaced(&model, 1e-4), displaced(&model, 1e-3));
    // All degrees of freedom move along `step`: the free ones by the tangent, the others by the coupling.
    let mut product = vec![0.0; model.dofs.equations];
    let along: Vec<f64> = (0..model.dofs.len())
        .filter(|&dof| model.dofs.equation[dof].is_some())
        .map(|dof| step[dof])
        .collect();
    for ((row, column), value) in pattern.iter().zip(&values) {
        product[row] += value * along[column];
        product[column] += if row == column {
            0.0
        } else {
            value * along[row]
        };
    }
    let ends = [1.0, -1.0].map(|side| {
        let moved = u.iter().zip(&step).map(|(u, step)| u + side * 1e-3 * step);
        forces(&model, &pattern, &moved.collect::<Vec<f64>>())
    });
    let largest = force.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
    for (dof, equation) in model.dofs.equation.iter().enumerate() {
        let Some(e) = *equation else { continue };
        let slope = (ends[0][dof] - ends[1][dof]) / 2e-3;
        let error = (product[e] + coupling[e] - slope).abs();
        assert!(error < 1e-6 * largest, "equation {e}: {error} of {largest}");
    }
}

#[test]
fn a_large_mesh_is_assembled_with_the_same_bits_on_several_threads() {
    let model = blocks();
    let assembly = Assembly::new(&model);
    let upper = assembly.upper_pattern(&model.dofs).unwrap();
    let whole = Pattern::new(model.dofs.equations, assembly.entries(&model.dofs)).unwrap();
    for (pattern, half) in [(&upper, true), (&whole, false)] {
        let [one, several] = [
            Arc::new(SequentialExecutor) as Arc<dyn Executor>,
            Arc::new(Threads),
        ]
        .map(|executor| assembled(&model, pattern, half, executor));
        assert!(one == several, "half: {half}");
        assert!(one.iter().flatten().all(|sum| sum.is_finite()));
    }
}
