//! Poses an interface problem of its own, without bodies, finds all of its consistent states, and steps it.
//!
//! Two slave nodes on a floor are held by springs and coupled by another one. With K the stiffness and w the displacements
//! in the components (n, t) of each node, λ the load factor, p the loads and F the forces of the floor, K w = λ p + F.
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
use stickslip::linear::constant::Constant;
use stickslip::model::{Friction, Settings};
use stickslip::step::Stepper;
use stickslip::step::drive::{RunEnd, Until};

/// Stiffness by rows: n and t of node 0, n and t of node 1.
const K: [[f64; 4]; 4] = [
    [100.0, 0.0, 0.0, 0.0],
    [0.0, 120.0, 0.0, -20.0],
    [0.0, 0.0, 100.0, 0.0],
    [0.0, -20.0, 0.0, 120.0],
];
/// Loads in the same components: both nodes are pressed down, and node 0 is pushed against t.
const P: [f64; 4] = [-30.0, -30.0, -30.0, 0.0];

fn main() -> Result<(), Box<dyn Error>> {
    run(&mut std::io::stdout())
}

/// Writes how far one assumption is from obeying Coulomb's law, all states that obey it, and the one that the stepper finds.
pub fn run(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let friction = Friction {
        angle: 20.0,
        cohesion: 0.0,
    };
    let columns = (0..4).flat_map(|j| K.map(|row| row[j]));
    let (gaps, length) = (vec![0.1; 2], 1.0);
    let interface = Constant::try_new(
        columns.collect(),
        P.to_vec(),
        gaps,
        vec![friction; 2],
        length,
    )?;
    let model = interface.model(vec![0.0, 1.0], 1.0, Settings::default());
    let mut stepper = Stepper::with_source(Arc::new(model), Box::new(interface.source()));

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
