//! Runs a scene with several frictions side by side.
//!
//! `cargo run --example study`

use std::error::Error;
use std::io::Write;
use std::num::NonZeroUsize;
use stickslip::study::plan::Plan;
use stickslip::study::read::{Study, Vary};
use stickslip::study::{Watch, run as runs};

fn main() -> Result<(), Box<dyn Error>> {
    run(&mut std::io::stdout())
}

/// Writes how far the beam's end has slid at the largest load, by friction angle.
pub fn run(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let mut study = Study::from_scene("01-pinned-beam-rough-floor");
    study.vary(Vary::parse("friction.angle=20,30,40")?);
    study.vary(Vary::parse("history.increment=0.125")?);
    // The plan finds every case sound before anything runs.
    let plan = Plan::new(study)?;
    let watch = Watch {
        stop: &|| false,
        done: &|_| {},
    };
    let jobs = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    for (case, run) in plan.cases.iter().zip(runs(&plan, jobs, &watch)?) {
        let largest = run.rows.iter().max_by(|a, b| a.load.total_cmp(&b.load));
        let row = largest.ok_or("no increment was accepted")?;
        let angle = &case.values[0];
        writeln!(
            out,
            "{angle} degrees: u_x = {:.6} at P = {:.3}, {:?}",
            row.monitors[0], row.load, run.end
        )?;
    }
    Ok(())
}
