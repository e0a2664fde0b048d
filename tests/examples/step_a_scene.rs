//! Loads a scene and steps it to its end: one call, one minor iteration.
//!
//! `cargo run --example step_a_scene`

use std::error::Error;
use std::io::Write;
use std::sync::Arc;
use stickslip::scene::Scene;
use stickslip::step::{Outcome, Stepper};

fn main() -> Result<(), Box<dyn Error>> {
    run(&mut std::io::stdout())
}

/// Writes a line for every accepted increment.
pub fn run(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    // A built-in scene or the path of a file, with settings as `--set` takes them.
    let set = [
        ("history.increment", "0.0625"),
        ("settings.t_max", "consistent"),
    ];
    let set = set.map(|(path, value)| (path.to_owned(), value.to_owned()));
    let scene = Scene::open("01-pinned-beam-rough-floor", &set)?;
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let mut minors = 0;
    while let Some(event) = stepper.step() {
        minors += 1;
        // The event holds every number that was compared in this minor iteration. Here only the ends of increments count.
        match &event.outcome {
            Outcome::Increment { .. } => {
                let (load, node) = (event.load_factor, event.nodes[0]);
                let mut monitors = Vec::new();
                stepper.monitors(&mut monitors);
                writeln!(
                    out,
                    "P = {load:.4}: {:?}, F_n = {:.5}, F_t = {:.5}, u_x = {:.6}, after {minors} minor iterations",
                    node.decision.next, node.f_n, node.f_t, monitors[0],
                )?;
                minors = 0;
            }
            Outcome::Failed(why) => return Err(format!("{why:?}").into()),
            _ => {}
        }
    }
    Ok(())
}
