//! Where increments end: bodies that come loose, the least increment, and advice that holds.

use crate::common::{Run, run, scene};
use crate::program::{code, err, program};
use stickslip::explain::step_size_probe::smaller;
use stickslip::linear::singular::Singular;
use stickslip::model::Mode;
use stickslip::scene::Scene;
use stickslip::step::event::Failure;
use stickslip::step::intervene::Intervention;
use stickslip::step::stepper::Stepper;

const PUSHED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/scales/pushed-block.ron");

fn rigid(run: &Run) -> bool {
    let failed = run.failure.as_ref().map(|(_, failure)| failure);
    matches!(failed, Some(Failure::Singular(Singular::Rigid { .. })))
}

fn last(run: &Run) -> f64 {
    run.accepted.last().expect("an increment").load
}

#[test]
fn the_load_at_which_a_body_comes_loose_is_found_to_the_least_increment() {
    for (increment, least) in [
        ("0.2", None),
        ("1", None),
        ("0.5", Some("0.001")),
        ("0.07", None),
    ] {
        for angle in [10.0_f64, 16.69924423399362, 30.0] {
            let text = angle.to_string();
            let mut set = vec![("history.increment", increment), ("friction.angle", &text)];
            set.extend(least.map(|least| ("history.least", least)));
            let run = run(&scene(PUSHED, &set));
            assert!(rigid(&run), "{set:?}: {:?}", run.failure);
            let size: f64 = increment.parse().unwrap();
            let least = least.map_or(size / 64.0, |least| least.parse().unwrap());
            // Halves of the increment are as small as they get above the least one.
            let (exact, found) = (angle.to_radians().tan(), last(&run));
            assert!(
                found <= exact * (1.0 + 1e-6) && exact < found + 2.0 * least,
                "{set:?}: {found} {exact}"
            );
        }
    }
}

const LOOSE: &str = r#"(title: "t", nodes: [Line(id: "b", from: (0, 1), to: (1, 1), elements: 1, per_element: 3)],
    materials: [Section(id: "m", EA: 100, EI: 1)], bodies: [Beam(id: "b", along: "b", material: "m")],
    supports: [(node: "b.start", fix: [x, y])],
    loads: [Force(node: "b.end", y: 1)], history: (path: [0, 1], increment: 0.5))"#;

#[test]
fn a_body_that_is_loose_from_the_start_is_told_at_once() {
    let run = run(&Scene::from_text("loose.ron", LOOSE, &[]).unwrap());
    let (event, _) = run.failure.as_ref().expect("it must fail");
    assert!(rigid(&run), "{:?}", run.failure);
    assert_eq!((event.position.increment, event.position.attempt), (1, 1));
}

#[test]
fn a_least_increment_that_is_not_given_is_a_64th_of_the_increment_in_force() {
    let change = |set: &[(&str, &str)], increment: f64| {
        let scene = scene("02-two-cantilevers-rough", set);
        let mut stepper = Stepper::new(std::sync::Arc::new(scene.model));
        stepper
            .intervene(&Intervention::Increment(increment))
            .unwrap();
        stepper.state().controls.least
    };
    assert_eq!(change(&[], 0.4), 0.4 / 64.0);
    assert_eq!(change(&[], 0.0001), 0.0001 / 64.0);
    let given = [("history.least", "0.01")];
    assert_eq!(change(&given, 0.4), 0.01);
    assert_eq!(change(&given, 0.001), 0.001);
    let set = scene("02-two-cantilevers-rough", &[("history.increment", "0.4")]);
    assert_eq!(
        Stepper::new(std::sync::Arc::new(set.model))
            .state()
            .controls
            .least,
        0.4 / 64.0
    );
}

/// A node that has no consistent state as soon as it touches; while it is still above the floor it has one.
#[test]
fn a_smaller_increment_is_advised_only_where_one_has_a_consistent_state() {
    for (above, found) in [("0", false), ("0.5", true), ("1.2", false)] {
        let set = [("nodes.a.at.y", above), ("settings.strategy", "census")];
        let run = run(&scene("osc-coh-none", &set));
        if above == "1.2" {
            // It does not come down so far.
            assert!(run.failure.is_none());
            continue;
        }
        assert!(
            matches!(run.failure, Some((_, Failure::NoAnswer { .. }))),
            "{:?}",
            run.failure
        );
        let mut scratch = Stepper::new(run.stepper.model().clone());
        let wanted = match found {
            true => "a smaller increment of 0.25 has a consistent state",
            false => "smaller increments have no consistent state either (halved down to 0.015625)",
        };
        let text = smaller(&mut scratch, run.stepper.state());
        assert_eq!(text.as_deref(), Some(wanted), "{above}");
    }
}

#[test]
fn the_program_gives_no_advice_that_does_not_help() {
    let here = std::env::current_dir().unwrap();
    let ran = |set: &[&str]| {
        let mut arguments = vec!["run", "osc-coh-none"];
        arguments.extend(set.iter().flat_map(|set| ["--set", set]));
        let output = program(&here, &arguments).output().unwrap();
        assert_eq!(code(&output), 3);
        err(&output)
    };
    let none = "smaller increments have no consistent state either";
    for strategy in ["table2", "ladder", "census"] {
        let told = ran(&[&format!("settings.strategy={strategy}")]);
        assert!(told.contains(none), "{strategy}: {told}");
        assert!(
            !told.contains("ends before") && !told.contains("smaller history"),
            "{strategy}: {told}"
        );
    }
    let told = ran(&["nodes.a.at.y=0.5", "settings.strategy=table2"]);
    assert!(
        told.contains("a smaller increment of 0.25 has a consistent state"),
        "{told}"
    );
    assert!(!told.contains(none), "{told}");
}

/// Eigenvalues of the stiffness: two of order 1e-3, and two zeros that round-off made 1e-20. Only a contact holds the body.
#[test]
fn a_body_that_is_loose_up_to_round_off_is_held_by_its_contact() {
    let text = r#"Contacts(title: "loose",
        contacts: [
            (id: "a", friction: (angle: 45.0), load: (-1.0979784550410603e-6, 2.949249577826172e-7)),
            (id: "b", gap: 8.212084405930568e-4, load: (-7.872461020555568e-7, 1.3095376610763624e-6)),
        ],
        matrix: Stiffness([
            [0.0015739924332054563, -0.0010002319980788033, -6.249963515199476e-05, -0.00012571326923745179],
            [-0.0010002319980788033, 0.0007374775179655286, -1.986954802157398e-05, 0.0005561444522625353],
            [-6.249963515199476e-05, -1.986954802157398e-05, 3.7340346259746724e-05, -0.0002736228352150675],
            [-0.00012571326923745179, 0.0005561444522625353, -0.0002736228352150675, 0.00223692414777961],
        ]))"#;
    let run = run(&Scene::from_text("loose.ron", text, &[]).unwrap());
    assert!(run.failure.is_none(), "{:?}", run.failure);
    let end = run.accepted.last().expect("an increment");
    let modes = end.event.nodes.iter().map(|r| r.decision.before);
    assert_eq!(modes.collect::<Vec<_>>(), [Mode::Fixed, Mode::Sliding]);
    let b = &end.event.nodes[1];
    assert!(end.load == 1.0 && b.gap.abs() < 1e-12 && b.f_n > 1e-7 && b.f_t == 0.0);
}

/// The second contact grazes the floor without force, and W has no unique answer there; a compliance needs no support.
#[test]
fn a_body_given_by_its_compliance_may_be_without_contact_pressure() {
    let text = r#"Contacts(title: "grazing",
        contacts: [
            (id: "a", friction: (angle: 5.710593137499643), load: (-1.0, 1.0)),
            (id: "b", friction: (angle: 5.710593137499643), load: (0.0, -1.0)),
        ],
        matrix: Compliance([
            [3.0, 0.0, 1.0, -1.0],
            [0.0, 2.0, -1.0, 1.0],
            [1.0, -1.0, 2.0, -2.0],
            [-1.0, 1.0, -2.0, 2.0],
        ]),
        history: (path: [0.0, 1.0, -0.5], increment: 1.0))"#;
    let run = run(&Scene::from_text("grazing.ron", text, &[]).unwrap());
    assert!(run.failure.is_none(), "{:?}", run.failure);
    let end = &run.accepted.last().expect("an increment").event.nodes;
    assert!(
        end.iter()
            .all(|record| record.f_n == 0.0 && record.gap >= 0.0)
    );
    assert!((end[0].gap - 1.0).abs() < 1e-12);
}
