//! Poses an interface problem of its own, without bodies, finds all of its consistent states, and steps it.
//!
//! Two slave nodes on a floor are held by springs and coupled by another one. With K the stiffness and u the displacements
//! in the components (x, y) of each node, λ the load factor, p the loads and F the forces of the floor, K u = λ p + F.
//!
//! `cargo run --example interface_problem`

use std::convert::Infallible;
use std::error::Error;
use std::io::Write;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip::interface::census::census;
use stickslip::interface::problem::AssumedMode;
use stickslip::interface::trials::Trials;
use stickslip::model::{
    BodyKind, Component, Contact, Form, Friction, Linear, Model, Settings, Surface, Touch,
};
use stickslip::step::Stepper;
use stickslip::step::drive::{RunEnd, Until};

/// Stiffness: row, column and value; x and y of node 0, then of node 1.
const K: [(usize, usize, f64); 6] = [
    (0, 0, 120.0),
    (0, 2, -20.0),
    (1, 1, 100.0),
    (2, 0, -20.0),
    (2, 2, 120.0),
    (3, 3, 100.0),
];
/// Loads in the same components: both nodes are pressed down, and node 0 is pushed along x, against t.
const P: [[f64; 2]; 2] = [[30.0, -30.0], [0.0, -30.0]];
/// Height of both nodes above the floor.
const GAP: f64 = 0.1;

fn main() -> Result<(), Box<dyn Error>> {
    run(&mut std::io::stdout())
}

/// Writes how far one assumption is from obeying Coulomb's law, all states that obey it, and the one that the stepper finds.
pub fn run(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let friction = Friction {
        angle: 20.0,
        cohesion: 0.0,
    };
    let mut model = Model::builder("two nodes on springs");
    let floor = [5.0, -5.0].map(|x| model.node("floor", [x, 0.0]));
    model.surface(Surface::endless("floor", floor));
    let nodes = [0.0, 1.0].map(|x| model.node("node", [x, GAP]));
    let springs = Linear {
        form: Form::Stiffness,
        entries: K.to_vec(),
        bars: Vec::new(),
    };
    model.body("springs", nodes.to_vec(), BodyKind::Linear(springs));
    for (node, [x, y]) in nodes.into_iter().zip(P) {
        model.contact(Contact::new(node, vec![0], friction));
        model
            .load(node, Component::X, x)
            .load(node, Component::Y, y);
    }
    // One step of Coulomb's law.
    model.settings(Settings {
        touch: Touch::Start,
        ..Settings::default()
    });
    let mut stepper = Stepper::new(Arc::new(model.build()?));

    // The problem of the first major iteration, which aims at the whole load.
    let problem = stepper.interface_problem().ok_or("not condensed")?;
    let mut trials = Trials::new(&problem).ok_or("no memory")?;
    let stuck = trials.answer(&[AssumedMode::Fixed; 2]).ok_or("singular")?;
    let (node, margin) = stuck.worst().ok_or("no nodes")?;
    writeln!(
        out,
        "{}: node {node} breaks {:?} by {:.3}",
        stuck.letters(),
        margin.condition,
        -margin.value,
    )?;
    let all = census(&problem)?;
    writeln!(
        out,
        "{} assumptions tried, {} consistent",
        all.tried,
        all.answers.len()
    )?;
    for found in &all.answers {
        for answer in &found.answer.nodes {
            writeln!(
                out,
                "{:?}: F_n = {:.4}, F_t = {:.4}, slip = {:.5}",
                answer.assumed, answer.f_n, answer.f_t, answer.slip,
            )?;
        }
    }

    let end: RunEnd<Infallible> = stepper.drive(Until::end(), |_| ControlFlow::Continue(()));
    writeln!(out, "stepped: {end:?}")?;
    for node in &stepper.state().nodes {
        writeln!(
            out,
            "{:?}: F_n = {:.4}, F_t = {:.4}",
            node.mode, node.f_n, node.f_t
        )?;
    }
    Ok(())
}
