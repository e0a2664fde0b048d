//! What a major and a minor iteration cost beside one sparse factorization, by size: `cargo bench --bench scaling`.
//!
//! The scene is `two-blocks-pressed-sheared`. Of factorizations, assemblies and major iterations (those of one minor
//! iteration) the least of one run counts, so that what else the machine does counts little; of minor iterations beyond the
//! first the median, since they differ in size. All of a row are measured in the same process. A second table has a single body on
//! one thread and on all. Tables, not statistics: hence no harness.

#[path = "../common/peak.rs"]
mod peak;

use peak::peak;
use std::sync::Arc;
use std::time::Instant;
use stickslip::executor::{Executor, SequentialExecutor};
use stickslip::fem::assembly::{Assembly, AssemblyMotion};
use stickslip::fem::element::ElementOutput;
use stickslip::linalg::SymmetricFactors;
use stickslip::model::Model;
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;
use stickslip::step::stepper::Stepper;

const BLOCKS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/benches/two-blocks-pressed-sheared.ron"
);

fn main() {
    println!(
        "| unknowns | slaves | factorization ms | assembly ms | major ms | (major − assembly) / factorization | minor / major | run s | peak MB |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    // The last but one has 201 slave nodes on 50,000 unknowns.
    let sizes: [&[(&str, &str)]; 5] = [
        &[("refine", "2")],
        &[("refine", "6")],
        &[("refine", "13")],
        &[
            ("refine", "10"),
            ("nodes.up.elements.x", "10"),
            ("nodes.up.elements.y", "5"),
        ],
        &[("refine", "18")],
    ];
    for set in sizes {
        let set: Vec<_> = set
            .iter()
            .map(|(path, value)| (path.to_string(), value.to_string()))
            .collect();
        let scene = Scene::open(BLOCKS, &set).unwrap_or_else(|e| panic!("{e}"));
        row(&Arc::new(scene.model));
    }
    println!();
    println!(
        "| one body: unknowns | threads | factorization ms, on one and all | assembly ms, on one and all | ratio |"
    );
    println!("|---|---|---|---|---|");
    for refine in ["3", "6", "10"] {
        let set = [("refine".to_owned(), refine.to_owned())];
        let scene = Scene::open("hertz-cylinder-on-block", &set).unwrap_or_else(|e| panic!("{e}"));
        let (a, f) = parts(&scene.model, Arc::new(SequentialExecutor));
        let (b, g) = parts(&scene.model, Arc::new(Threads));
        println!(
            "| {} | {} | {:.1} {:.1} | {:.1} {:.1} | {:.2} |",
            scene.model.dofs.equations,
            rayon::current_num_threads(),
            1e3 * f,
            1e3 * g,
            1e3 * a,
            1e3 * b,
            (a + f) / (b + g),
        );
    }
}

/// All threads of rayon's pool.
struct Threads;

impl Executor for Threads {
    fn join(&self, first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
        rayon::join(first, second);
    }
}

fn row(model: &Arc<Model>) {
    let (assembly, factorization) = parts(model, Arc::new(SequentialExecutor));
    let mut stepper = Stepper::new(model.clone());
    let began = Instant::now();
    let (mut major, mut minors) = (f64::INFINITY, Vec::new());
    // Since the last major iteration ended; and whether minor iterations beyond the first were in it.
    let (mut spent, mut count) = (0.0, 0);
    loop {
        let step = Instant::now();
        let Some(event) = stepper.step() else { break };
        let seconds = step.elapsed().as_secs_f64();
        (spent, count) = (spent + seconds, count + 1);
        match event.outcome {
            Outcome::Failed(_) => panic!("{:?}", event.outcome),
            Outcome::Minor if count > 1 => minors.push(seconds),
            Outcome::Major { .. } => {
                if count == 1 {
                    major = major.min(spent);
                }
                (spent, count) = (0.0, 0);
            }
            Outcome::Increment { .. } => (spent, count) = (0.0, 0),
            _ => {}
        }
    }
    minors.sort_unstable_by(f64::total_cmp);
    let minor = minors.get(minors.len() / 2).map_or(f64::NAN, |m| *m);
    println!(
        "| {} | {} | {:.1} | {:.1} | {:.1} | {:.2} | {:.3} | {:.2} | {} |",
        model.dofs.equations,
        model.contacts.len(),
        1e3 * factorization,
        1e3 * assembly,
        1e3 * major,
        (major - assembly) / factorization,
        minor / major,
        began.elapsed().as_secs_f64(),
        peak(),
    );
}

/// Seconds of one assembly and of one factorization of the bodies, the interface last, as the solver does it.
fn parts(model: &Model, executor: Arc<dyn Executor>) -> (f64, f64) {
    let (dofs, equations) = (&model.dofs, model.dofs.equations);
    let mut assembly = Assembly::with_executor(model, executor.clone());
    let pattern = assembly.upper_pattern(dofs).expect("a pattern that fits");
    let pattern = Arc::new(pattern);
    assembly.bind(dofs, &pattern, true);
    let masters = model
        .surfaces
        .iter()
        .flat_map(|s| s.elements.iter().flatten().copied());
    let mut last: Vec<usize> = masters
        .chain(model.contacts.iter().map(|s| s.node))
        .flat_map(|node| [0, 1].map(|k| dofs.equation[dofs.first[node] + k]))
        .flatten()
        .collect();
    last.sort_unstable();
    last.dedup();
    let mut factors =
        SymmetricFactors::new(pattern.clone(), &last, &model.positions_of_equations())
            .expect("a pattern to factor");
    let zeros = vec![0.0; dofs.len()];
    let (mut force, mut size) = (zeros.clone(), zeros.clone());
    let (mut values, mut coupling) = (vec![0.0; pattern.entries()], vec![0.0; equations]);
    let (mut assembled, mut factored) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..7 {
        let began = Instant::now();
        let moved = AssemblyMotion {
            u: &zeros,
            step: &zeros,
            before: &zeros,
            history: &[],
        };
        let out = ElementOutput {
            force: &mut force,
            size: &mut size,
            values: &mut values,
            coupling: &mut coupling,
        };
        assembly.assemble(dofs, moved, out);
        assembled = assembled.min(began.elapsed().as_secs_f64());
        let began = Instant::now();
        factors.factor(&values, &*executor).expect("a stiffness");
        factored = factored.min(began.elapsed().as_secs_f64());
    }
    (assembled, factored)
}
