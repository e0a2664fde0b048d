//! Increments of their own on each leg of the path.

use crate::common::{Run, run, scene, stepped};
use std::sync::Arc;
use stickslip::model::Control;
use stickslip::scene::Scene;
use stickslip::scene::base::Base;
use stickslip::step::event::Outcome;
use stickslip::step::intervene::Intervention;
use stickslip::step::stepper::Stepper;

const ROUGH: &str = "01-pinned-beam-rough-floor";

/// The pinned beam, pressed and let go, with increments of each leg.
fn listed(sizes: &[f64]) -> Scene {
    let mut spec = scene(ROUGH, &[]).spec;
    spec.history.increments = sizes.to_vec();
    Scene::from_spec(ROUGH, spec).unwrap_or_else(|e| panic!("{e}"))
}

fn loads(run: &Run) -> Vec<f64> {
    assert!(run.failure.is_none(), "{:?}", run.failure);
    run.accepted.iter().map(|a| a.load).collect()
}

#[test]
fn each_leg_is_walked_in_its_own_increments() {
    let path = run(&listed(&[0.1, 0.0625]));
    assert_eq!(
        loads(&path),
        [0.1, 0.2, 0.25, 0.1875, 0.125, 0.0625, 0.0],
        "0.25 is no multiple of 0.1"
    );
}

#[test]
fn one_size_on_all_legs_gives_every_bit_of_a_single_increment() {
    let alike = stepped(&Arc::new(listed(&[0.01, 0.01]).model));
    let single = stepped(&Arc::new(scene(ROUGH, &[]).model));
    assert_eq!(alike.0, single.0);
    // What is at a load does not hang on the size that the other leg has.
    let fine = run(&scene(ROUGH, &[("history.increment", "0.0125")]));
    let mixed = run(&listed(&[0.05, 0.0125]));
    let at_turn = |run: &Run| {
        run.accepted
            .iter()
            .find(|a| a.load == 0.25)
            .unwrap()
            .monitors
            .clone()
    };
    for (name, value) in at_turn(&fine) {
        let other = at_turn(&mixed)[&name];
        assert!(
            (value - other).abs() < 1e-6 * value.abs().max(1.0),
            "{name}: {value} {other}"
        );
    }
}

#[test]
fn a_size_set_by_hand_holds_to_the_end_of_the_leg() {
    let mut stepper = Stepper::new(Arc::new(listed(&[0.125, 0.0625]).model));
    stepper.intervene(&Intervention::Increment(0.05)).unwrap();
    let mut met = Vec::new();
    while let Some(event) = stepper.step().cloned() {
        if matches!(event.outcome, Outcome::Increment { .. }) {
            met.push(event.load_factor);
        }
    }
    assert_eq!(
        met,
        [0.05, 0.1, 0.15, 0.2, 0.25, 0.1875, 0.125, 0.0625, 0.0]
    );
}

#[test]
fn one_leg_is_set_by_its_number_and_all_by_the_increment_in_proportion() {
    let of = |scene: &Scene| {
        (
            scene.spec.history.increments.clone(),
            scene.model.increments.clone(),
        )
    };
    let base = listed(&[0.125, 0.0625]);
    let one = base.with("history.increments[1]", "0.025").unwrap();
    assert_eq!(of(&one), (vec![0.125, 0.025], vec![0.125, 0.025]));
    // It was 0.01.
    let all = base.with("history.increment", "0.005").unwrap();
    assert_eq!(of(&all), (vec![0.0625, 0.03125], vec![0.0625, 0.03125]));
    let quick = Base::new(base);
    for (path, value) in [
        ("history.increments[1]", "0.025"),
        ("history.increment", "0.005"),
    ] {
        let place = quick.find(path).unwrap();
        let slow = quick.scene().with(path, value).unwrap();
        let set = [(&place, value)];
        assert_eq!(quick.model(&set), Some(slow.model.clone()), "{path}");
        let count = run(&slow).accepted.len() as f64;
        assert_eq!(quick.increments(&set), Some(count), "{path}");
    }
}

#[test]
fn what_is_no_list_of_increments_is_refused_with_its_place() {
    let refused = |sizes: &[f64], control: Control, least: Option<f64>| {
        let mut spec = scene(ROUGH, &[]).spec;
        (spec.history.increments, spec.history.least) = (sizes.to_vec(), least);
        spec.history.control = control;
        Scene::from_spec("s", spec).unwrap_err().to_string()
    };
    let load = |sizes: &[f64]| refused(sizes, Control::Load, None);
    let cases = [
        (
            load(&[0.1]),
            "history.increments: the list has 1 increment, and the path 2 legs",
        ),
        (
            load(&[0.1, 0.0]),
            "history.increments[1]: the increment is 0.0",
        ),
        (
            load(&[f64::NAN, 0.1]),
            "history.increments[0]: the increment",
        ),
        (load(&[0.1, 1e-9]), "at most a million"),
        (
            refused(&[0.1, 0.05], Control::Arc, None),
            "control: arc takes its step sizes from history.arc",
        ),
        (
            refused(&[0.1, 0.05], Control::Load, Some(0.06)),
            "history.least: the least increment is 0.06; it must be positive and at most the increment, 0.05",
        ),
    ];
    for (told, wanted) in cases {
        assert!(told.contains(wanted), "{told}");
    }
}
