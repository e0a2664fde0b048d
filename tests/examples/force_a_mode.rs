//! Forces a mode where the solver cannot go on by itself.
//!
//! The beam of this scene turns freely about its pin while its end does not touch. If the scene starts with that end free,
//! Table 2 has a singular system to solve. Told that the end slides, it goes on.
//!
//! `cargo run --example force_a_mode`

use std::convert::Infallible;
use std::error::Error;
use std::io::Write;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip::model::Mode;
use stickslip::scene::Scene;
use stickslip::step::drive::{RunEnd, Until};
use stickslip::step::intervene::Intervention;
use stickslip::step::{Outcome, Stepper};

fn main() -> Result<(), Box<dyn Error>> {
    run(&mut std::io::stdout())
}

/// Writes how the run ends without and with the forced mode.
pub fn run(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let set = [("slaves[0].start", "free"), ("settings.strategy", "table2")];
    let set = set.map(|(path, value)| (path.to_owned(), value.to_owned()));
    let scene = Scene::open("01-pinned-beam-rough-floor", &set)?;
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let RunEnd::Failed(why) = to_the_end(&mut stepper).1 else {
        return Err("the scene was to fail".into());
    };
    writeln!(out, "free: {why:?}")?;
    // For the next minor iteration only; with `hold` until it is released.
    stepper.intervene(&Intervention::Force {
        slave: 0,
        mode: Mode::Sliding,
        hold: false,
    })?;
    let (increments, end) = to_the_end(&mut stepper);
    writeln!(out, "sliding: {end:?} after {increments} increments")?;
    Ok(())
}

/// Steps to the end of the history or to the next failure, and counts the accepted increments.
fn to_the_end(stepper: &mut Stepper) -> (u32, RunEnd<Infallible>) {
    let mut increments = 0;
    let end = stepper.drive(Until::end(), |stepper| {
        if matches!(stepper.event().outcome, Outcome::Increment { .. }) {
            increments += 1;
        }
        ControlFlow::Continue(())
    });
    (increments, end)
}
