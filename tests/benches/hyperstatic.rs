//! Friction problems of hyperstatic structures with 30 to 200 contacts: which strategies solve them, and how fast.
//!
//! ```text
//! cargo bench --bench hyperstatic                       all 276 with the strategies below
//! cargo bench --bench hyperstatic -- copositive ladder  with these
//! cargo bench --bench hyperstatic -- 60 copositive      the first 60
//! ```
//!
//! What a run ends in is judged from the problem and the forces alone.

#[path = "../outside/hyperstatic.rs"]
mod hyperstatic;

use hyperstatic::{broken, forces, problem};
use std::sync::Arc;
use std::time::Instant;
use stickslip::scene::Scene;
use stickslip::scene::siconos::Storage;
use stickslip::step::event::Outcome;
use stickslip::step::stepper::Stepper;

/// How many problems there are.
const COUNT: usize = 276;
/// What forces may break at most (relative).
const TOLERANCE: f64 = 1e-9;

fn main() {
    let asked: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let count = asked.iter().find_map(|a| a.parse().ok()).unwrap_or(COUNT);
    let names: Vec<&String> = asked
        .iter()
        .filter(|a| a.parse::<usize>().is_err())
        .collect();
    let strategies: Vec<&str> = match names.as_slice() {
        [] => vec![
            "sliding",
            "newton",
            "block",
            "lemke",
            "copositive",
            "gauss_seidel",
            "ladder",
        ],
        some => some.iter().map(|name| name.as_str()).collect(),
    };
    println!("strategy      solved  wrong  seconds  longest  iterations  worst");
    for strategy in strategies {
        let (mut solved, mut wrong, mut longest, mut steps, mut worst) =
            (0, 0, 0.0_f64, 0, 0.0_f64);
        let mut failed = Vec::new();
        let begin = Instant::now();
        for k in 0..count {
            let problem = problem(k);
            let set = [("settings.strategy".to_owned(), strategy.to_owned())];
            let text = problem.write(Storage::Dense);
            let scene = Scene::from_text("hyperstatic.dat", &text, &set).expect("a scene");
            let mut stepper = Stepper::new(Arc::new(scene.model));
            let from = Instant::now();
            let mut end = false;
            while let Some(event) = stepper.step() {
                steps += 1;
                match event.outcome {
                    Outcome::Failed(_) => break,
                    Outcome::Increment { last, .. } => end = last,
                    _ => {}
                }
            }
            longest = longest.max(from.elapsed().as_secs_f64());
            match broken(&problem, &forces(&stepper)) {
                _ if !end => failed.push(k),
                broken if broken <= TOLERANCE => {
                    solved += 1;
                    worst = worst.max(broken);
                }
                _ => wrong += 1,
            }
        }
        let seconds = begin.elapsed().as_secs_f64();
        println!(
            "{strategy:13} {solved:6} {wrong:6} {seconds:8.1} {longest:8.2} {steps:11} {worst:6.0e}  failed: {failed:?}"
        );
    }
}
