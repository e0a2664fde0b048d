//! Whole runs of scenes, without the command line: `cargo bench --bench scenes`.

use divan::Bencher;
use std::sync::Arc;
use stickslip::model::Model;
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;
use stickslip::step::stepper::Stepper;

const BLOCKS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/benches/two-blocks-pressed-sheared.ron"
);

fn main() {
    divan::main();
}

fn model(name: &str, set: &[(&str, &str)]) -> Arc<Model> {
    let set: Vec<(String, String)> = set
        .iter()
        .map(|(p, v)| (p.to_string(), v.to_string()))
        .collect();
    Arc::new(
        Scene::open(name, &set)
            .unwrap_or_else(|e| panic!("{e}"))
            .model,
    )
}

/// Runs to the end.
fn run(model: &Arc<Model>) {
    let mut stepper = Stepper::new(model.clone());
    while let Some(event) = stepper.step() {
        assert!(!matches!(event.outcome, Outcome::Failed(_)));
    }
}

/// Problem 04 in 700 increments of 0.005.
#[divan::bench(sample_count = 10)]
fn problem_04(bencher: Bencher) {
    let model = model("04-cantilever-rigid-circle", &[]);
    bencher.bench(|| run(&model));
}

/// Problem 04 in 7 increments, on meshes of 5, 10, 20 and 40 elements.
#[divan::bench(args = ["1", "2", "4", "8"], sample_count = 10)]
fn problem_04_in_large_increments(bencher: Bencher, refine: &str) {
    let set = [("refine", refine), ("history.increment", "0.5")];
    let model = model("04-cantilever-rigid-circle", &set);
    bencher.bench(|| run(&model));
}

/// The bouncing block of MOOSE's contact module, in 40 increments, without friction and with.
#[divan::bench(args = ["smooth", "rough"], sample_count = 3)]
fn bouncing_block(bencher: Bencher, which: &str) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/");
    let model = model(&format!("{folder}bouncing-block-{which}.ron"), &[]);
    bencher.bench(|| run(&model));
}

/// Two blocks pressed and sheared, 1.4k and 11k unknowns.
#[divan::bench(args = ["2", "6"], sample_count = 3)]
fn two_blocks(bencher: Bencher, refine: &str) {
    let model = model(BLOCKS, &[("refine", refine)]);
    bencher.bench(|| run(&model));
}
