//! Friction problems of hyperstatic structures with 30 to 200 contacts: which strategies solve them, and how fast.
//!
//! ```text
//! cargo bench --bench hyperstatic                       all 276 with the strategies below
//! cargo bench --bench hyperstatic -- copositive ladder  with these
//! cargo bench --bench hyperstatic -- 60 copositive      the first 60
//! cargo bench --bench hyperstatic -- 27,29,51 ladder    these
//! cargo bench --bench hyperstatic -- limit=20 ladder    each given up after 20 s
//! ```
//!
//! What a run ends in is judged from the problem and the forces alone. A problem that has not come to its end, or has taken
//! more than a second, is a line of its own on stderr.

#[path = "../outside/hyperstatic.rs"]
mod hyperstatic;

use hyperstatic::{broken, forces, problem};
use std::sync::Arc;
use std::time::Instant;
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;
use stickslip::step::stepper::Stepper;

/// How many problems there are.
const COUNT: usize = 276;
/// The strategies that are run where none is named.
const ALL: [&str; 7] = [
    "sliding",
    "newton",
    "block",
    "lemke",
    "copositive",
    "gauss_seidel",
    "ladder",
];
/// What forces may break at most (relative).
const TOLERANCE: f64 = 1e-9;

fn main() {
    let asked: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let (mut which, mut names) = ((0..COUNT).collect::<Vec<usize>>(), Vec::new());
    let mut limit = f64::INFINITY;
    for word in &asked {
        let list: Result<Vec<usize>, _> = word.split(',').map(str::parse).collect();
        match (list, word.strip_prefix("limit=")) {
            (Ok(list), _) if list.len() == 1 => which.truncate(list[0]),
            (Ok(list), _) => which = list,
            (_, Some(seconds)) => limit = seconds.parse().expect("seconds"),
            _ => names.push(word.as_str()),
        }
    }
    if names.is_empty() {
        names = ALL.to_vec();
    }
    println!("strategy      solved  wrong  seconds  longest  iterations  worst");
    for strategy in names {
        bench(strategy, &which, limit);
    }
}

/// Solves the problems with a strategy, each for no longer than `limit` (seconds), and prints a line.
fn bench(strategy: &str, which: &[usize], limit: f64) {
    let (mut solved, mut wrong, mut longest, mut steps, mut worst) = (0, 0, 0.0_f64, 0, 0.0_f64);
    let mut failed = Vec::new();
    let begin = Instant::now();
    for &k in which {
        let problem = problem(k);
        let set = [("settings.strategy".to_owned(), strategy.to_owned())];
        let text = stickslip_exchange::siconos::write(&problem);
        let scene = Scene::from_text("hyperstatic.dat", &text, &set).expect("a scene");
        let mut stepper = Stepper::new(Arc::new(scene.model));
        let from = Instant::now();
        let (mut end, mut climbed) = (false, Vec::new());
        while let Some(event) = stepper.step() {
            steps += 1;
            match event.outcome {
                Outcome::Failed(ref why) => {
                    climbed.push(format!("{why:?}"));
                    break;
                }
                Outcome::Increment { last, .. } => end = last,
                Outcome::StrategyChange { to, .. } => climbed.push(format!(
                    "{} at {:.1} s",
                    to.name(),
                    from.elapsed().as_secs_f64()
                )),
                _ if from.elapsed().as_secs_f64() > limit => break,
                _ => {}
            }
        }
        let seconds = from.elapsed().as_secs_f64();
        longest = longest.max(seconds);
        if !end || seconds > 1.0 {
            let contacts = problem.mu.len();
            let climbed = climbed.join(", ");
            eprintln!("{k}: {contacts} contacts, {seconds:.1} s, solved: {end}; {climbed}");
        }
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
