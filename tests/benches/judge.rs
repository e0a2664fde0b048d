//! What the judge, and looks at stability, cost beside the run that they judge: `cargo bench --bench judge`.
//!
//! `solids s` is what it costs to find the smallest stretch and det F of all solids, once an increment.
//!
//! Every increment is judged once more after it was accepted, from the same positions and forces, and its stability is looked at;
//! both are timed. The last columns compare the cost of a look with the counted one, in major iterations, and give the
//! part of the run that the looks cost which it takes by itself. A table, not a statistic: all of a row are measured in the same process.

use std::sync::Arc;
use std::time::Instant;
use stickslip::contact::judge::{Judge, JudgedState};
use stickslip::contact::laws::Scales;
use stickslip::fem::deformation::deformation;
use stickslip::linear::estimate::Estimate;
use stickslip::model::Model;
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;
use stickslip::step::state::State;
use stickslip::step::stepper::Stepper;

const BLOCKS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/benches/two-blocks-pressed-sheared.ron"
);

fn main() {
    println!(
        "| scene | unknowns | slaves | increments | run s | judge s | part | solids s | part | look, majors | counted | looks | part |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    row("04-cantilever-rigid-circle", &[]);
    row("05-cantilever-elastic-block", &[]);
    for refine in ["2", "6", "13"] {
        row(BLOCKS, &[("refine", refine)]);
    }
}

fn row(name: &str, set: &[(&str, &str)]) {
    let owned = |(path, value): &(&str, &str)| ((*path).to_owned(), (*value).to_owned());
    let set: Vec<_> = set.iter().map(owned).collect();
    let scene = Scene::open(name, &set).unwrap_or_else(|e| panic!("{e}"));
    let model = Arc::new(scene.model);
    let mut stepper = Stepper::new(model.clone());
    let nodes = model.nodes.len();
    let mut judge = Judge::with_capacity(nodes, model.contacts.len());
    let mut contact = vec![[0.0; 2]; nodes];
    let mut before = positions(&model, stepper.state());
    let (mut run, mut judged, mut strained, mut increments) = (0.0, 0.0, 0.0, 0);
    let (mut looked, mut looks, mut majors) = (0.0, 0, 0.0);
    loop {
        let began = Instant::now();
        let Some(event) = stepper.step() else { break };
        let accepted = matches!(event.outcome, Outcome::Increment { .. });
        assert!(!matches!(event.outcome, Outcome::Failed(_)));
        run += began.elapsed().as_secs_f64();
        if !accepted {
            continue;
        }
        increments += 1;
        let state = stepper.state();
        let now = positions(&model, state);
        let nodes = &state.start.nodes;
        let forces: Vec<_> = nodes.iter().map(|node| node.force()).collect();
        let nothing = vec![0.0; forces.len()];
        let ties = vec![None; forces.len()];
        let seen = JudgedState {
            surfaces: &model.surfaces,
            contacts: &model.contacts,
            friction: &state.controls.friction,
            before: &before,
            now: &now,
            out: [&[], &[]],
            forces: &forces,
            brought: &nothing,
            earlier: &nothing,
            anchored: &nothing,
            ties: &ties,
            scales: Scales {
                length: model.length,
                force: 1.0,
                lengths: 1e-8,
                forces: 1e-8,
            },
        };
        let began = Instant::now();
        std::hint::black_box(judge.interface(&seen, &mut contact));
        judged += began.elapsed().as_secs_f64();
        let began = Instant::now();
        std::hint::black_box(deformation(&model, &state.start.u));
        strained += began.elapsed().as_secs_f64();
        before = now;
        majors += f64::from(stepper.event().position.major);
        looks += u32::from(stepper.state().record.watch.majors == 0);
        // Linearised, which the next increment asks for all the same.
        let began = Instant::now();
        std::hint::black_box(stepper.norms());
        run += began.elapsed().as_secs_f64();
        let began = Instant::now();
        std::hint::black_box(stepper.stability());
        looked += began.elapsed().as_secs_f64();
    }
    let look = looked / f64::from(increments);
    println!(
        "| {} | {} | {} | {increments} | {run:.2} | {judged:.4} | {:.2} % | {strained:.4} | {:.2} % | {:.2} | {:.2} | {looks} | {:.2} % |",
        model.title,
        model.dofs.equations,
        model.contacts.len(),
        100.0 * judged / run,
        100.0 * strained / run,
        look * majors / run,
        Estimate::from_model(&model).stability,
        100.0 * f64::from(looks) * look / run
    );
}

fn positions(model: &Model, state: &State) -> Vec<[f64; 2]> {
    let nodes = model.nodes.iter().zip(&model.dofs.first);
    let at = |(node, &first): (&stickslip::model::Node, &usize)| {
        [
            node.at[0] + state.start.u[first],
            node.at[1] + state.start.u[first + 1],
        ]
    };
    nodes.map(at).collect()
}
