//! Cells of convergence maps a second, on one thread and on two: `cargo bench --bench maps`.
//!
//! The last column is the time of the solver by itself, with every model made before and a new solver for each, over that of the
//! map on one thread. What is missing to 1 goes into making models, judging ends and random problems; it can be above 1, since
//! a map's solvers keep their workspace from cell to cell. A table, not a statistic; each time is the least of some, taken
//! in turn.

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;
use stickslip::model::Model;
use stickslip::scene::Scene;
use stickslip::scene::base::{Base, Method};
use stickslip::step::event::Outcome;
use stickslip::step::stepper::Stepper;
use stickslip::study::map::{self, Map};
use stickslip::study::random::{NODES, Population};
use stickslip::study::survey;
use stickslip::study::trial::Variant;
use stickslip::study::{Plan, Study, Vary, Watch};

/// How often each is timed.
const TIMES: usize = 5;
const STRATEGIES: [&str; 3] = ["table2", "lemke", "ladder"];

fn main() {
    println!("| map | cells | cells/s on one thread | on two | two over one | solver alone |");
    println!("|---|---|---|---|---|---|");
    let friction_increment = ["friction=5..45/50", "increment=0.1..0.5/20"];
    plain("osc-two3", &friction_increment);
    plain("osc-touch2", &friction_increment);
    plain(
        "osc-two3",
        &["loads[0].x=0.1..1/50", "increment=0.1..0.5/20"],
    );
    random(300);
}

fn threads(count: usize) -> NonZeroUsize {
    NonZeroUsize::new(count).unwrap_or(NonZeroUsize::MIN)
}

fn watch() -> Watch<'static> {
    Watch {
        stop: &|| false,
        done: &|_| {},
    }
}

/// A map of a scene over two paths.
fn plain(scene: &str, vary: &[&str]) {
    let study = Study {
        vary: vary
            .iter()
            .map(|text| Vary::parse(text).unwrap_or_else(|e| panic!("{e}")))
            .collect(),
        ..Study::from_scene(scene)
    };
    let plan = || Plan::new(study.clone()).unwrap_or_else(|e| panic!("{e}"));
    let cases = plan().cases;
    let models: Vec<Arc<Model>> = cases
        .iter()
        .map(|case| Arc::new(case.model().unwrap_or_else(|e| panic!("{e}"))))
        .collect();
    let whole = |jobs| {
        let plan = plan();
        let ended = map::sweep(&plan).run(threads(jobs), &watch());
        let map = ended.map(|ended| Map::judged(plan, map::TOLERANCE, ended));
        assert!(map.is_ok_and(|map| map.cells.iter().all(Option::is_some)));
    };
    let name = format!("{scene}: {}", vary.join(", "));
    row(&name, models.len(), &whole, &|| {
        models.iter().for_each(solve)
    });
}

/// Random problems with some strategies.
fn random(count: usize) {
    let population = Population {
        seed: 1,
        count,
        nodes: NODES,
    };
    let variant = |name: &&str| Variant {
        name: name.to_string(),
        settings: vec![("settings.strategy".to_owned(), name.to_string())],
    };
    let variants: Vec<Variant> = STRATEGIES.iter().map(variant).collect();
    let mut models = Vec::new();
    for k in 0..count {
        let spec = population.draw(k).problem.spec();
        let base = Base::new(Scene::from_spec("drawn", spec).unwrap_or_else(|e| panic!("{e}")));
        for Variant { settings, .. } in &variants {
            let least = ("history.least".to_owned(), "1".to_owned());
            let method = Method::from_spec(&base.scene().spec, &[&[least], &settings[..]].concat());
            let model = method.and_then(|method| base.solved_by(&method));
            models.extend(model.map(Arc::new));
        }
    }
    assert_eq!(models.len(), count * variants.len());
    let whole = |jobs| {
        let judged = survey::sweep(&population, &variants).run(threads(jobs), &watch());
        assert!(judged.is_ok_and(|judged| judged.iter().flatten().count() == count));
    };
    let name = format!("random problems, {}", STRATEGIES.join(", "));
    row(&name, models.len(), &whole, &|| {
        models.iter().for_each(solve)
    });
}

/// To the end of the history, or to the first failure.
fn solve(model: &Arc<Model>) {
    let mut stepper = Stepper::new(model.clone());
    while let Some(event) = stepper.step() {
        if matches!(event.outcome, Outcome::Failed(_)) {
            break;
        }
    }
}

/// Times a map on one thread and on two, and its solver alone.
fn row(name: &str, cells: usize, map: &dyn Fn(usize), solver: &dyn Fn()) {
    let mut least = [f64::INFINITY; 3];
    for _ in 0..TIMES {
        let runs: [&dyn Fn(); 3] = [&|| map(1), &|| map(2), solver];
        for (least, run) in least.iter_mut().zip(runs) {
            let began = Instant::now();
            run();
            *least = least.min(began.elapsed().as_secs_f64());
        }
    }
    let [one, two, alone] = least;
    let a_second = |time: f64| cells as f64 / time;
    println!(
        "| {name} | {cells} | {:.0} | {:.0} | {:.2} | {:.2} |",
        a_second(one),
        a_second(two),
        one / two,
        alone / one
    );
}
