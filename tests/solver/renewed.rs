//! A solver that goes over to another model of the same bodies has every bit of a new one.

use crate::common::scene;
use std::sync::Arc;
use stickslip::model::Model;
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;
use stickslip::step::stepper::Stepper;
use stickslip::study::random::Population;

/// Most steps that are compared.
const STEPS: usize = 60;

/// All that a run says, to its end or its first failure, and where it ends.
fn told(stepper: &mut Stepper) -> Vec<String> {
    let mut told = Vec::new();
    let mut monitors = Vec::new();
    stepper.monitors(&mut monitors);
    while told.len() < STEPS
        && let Some(event) = stepper.step()
    {
        told.push(format!("{event:?}"));
        if matches!(event.outcome, Outcome::Failed(_)) {
            break;
        }
    }
    stepper.monitors(&mut monitors);
    told.push(format!("{:?} {monitors:?}", stepper.state()));
    told
}

/// Runs models one after the other on one solver, and each on a new one.
fn compare(name: &str, models: &[Arc<Model>]) {
    let mut kept = Stepper::new(models[0].clone());
    for (k, model) in models.iter().enumerate() {
        assert!(kept.renew(model), "{name} {k}");
        let expected = told(&mut Stepper::new(model.clone()));
        assert!(expected.len() > 1);
        assert_eq!(told(&mut kept), expected, "{name} {k}");
    }
}

/// Settings that change what is solved, and with what, from one run to the next.
const CHANGES: [&[(&str, &str)]; 7] = [
    &[],
    &[
        ("settings.solver", "condensed"),
        ("settings.strategy", "ladder"),
    ],
    &[("settings.solver", "augmented"), ("friction.angle", "35")],
    &[("settings.strategy", "lemke"), ("friction.angle", "5")],
    &[
        ("settings.geometry", "frozen"),
        ("settings.t_max", "consistent"),
    ],
    &[("settings.strategy", "ladder"), ("settings.touch", "start")],
    &[],
];

#[test]
fn a_solver_that_goes_over_to_another_model_has_every_bit_of_a_new_one() {
    for name in [
        "osc-two3",
        "osc-snap",
        "osc-block-slide",
        "osc-inclined-cantilever",
        "02-two-cantilevers-rough",
        "03-distant-cantilevers",
        "04-cantilever-rigid-circle",
    ] {
        let increment = scene(name, &[]).model.increment;
        let models: Vec<Arc<Model>> = CHANGES
            .iter()
            .enumerate()
            .map(|(k, changes)| {
                let increment = format!("{:?}", increment / (1 + k % 3) as f64);
                let increment = ("history.increment", increment.as_str());
                Arc::new(scene(name, &[changes, &[increment][..]].concat()).model)
            })
            .collect();
        compare(name, &models);
    }
}

#[test]
fn so_it_has_on_random_problems() {
    let population = Population {
        seed: 11,
        count: 40,
        nodes: 1..=4,
    };
    for k in 0..population.count {
        let scene = Scene::from_spec("drawn", population.draw(k).problem.spec()).unwrap();
        let with = |strategy: &str, solver: &str| {
            let scene = scene.with("settings.strategy", strategy).unwrap();
            Arc::new(scene.with("settings.solver", solver).unwrap().model)
        };
        let models = [
            with("table2", "auto"),
            with("lemke", "condensed"),
            with("ladder", "augmented"),
            with("census", "auto"),
            with("table2", "auto"),
        ];
        compare(&format!("problem {k}"), &models);
    }
}

#[test]
fn a_model_of_other_bodies_is_refused_and_nothing_is_changed() {
    let first = Arc::new(scene("osc-two3", &[]).model);
    for (path, value) in [
        ("bodies.bars.bars[0].stiffness", "2"),
        ("nodes.a.at.y", "0.3"),
        ("settings.memory", "1"),
        ("surfaces.floor.endless", "false"),
    ] {
        let mut stepper = Stepper::new(first.clone());
        stepper.step();
        let before = format!("{:?}", stepper.state());
        let other = Arc::new(scene("osc-two3", &[(path, value)]).model);
        assert!(!stepper.renew(&other), "{path}");
        assert!(Arc::ptr_eq(stepper.model(), &first));
        assert_eq!(format!("{:?}", stepper.state()), before);
    }
    let mut stepper = Stepper::new(first);
    assert!(!stepper.renew(&Arc::new(scene("osc-two6", &[]).model)));
}
