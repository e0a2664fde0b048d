//! Damped motions past limit points: where a scene lets go and where it comes to rest, against closed forms, and whatever the
//! increment.

use crate::common::{Accepted, Run, finished, read, run, scene};
use std::sync::Arc;
use stickslip::scene::Scene;
use stickslip::step::event::{MotionEvent, Outcome};
use stickslip::step::recovery::motion::Motion;
use stickslip::step::stepper::Stepper;

/// The increments that end a damped motion that is a jump.
fn landings(run: &Run) -> Vec<(&Accepted, Motion)> {
    let landing = |accepted: &'_ Accepted| match accepted.event.outcome {
        Outcome::Increment {
            motion,
            jumped: true,
            ..
        } => motion,
        _ => None,
    };
    let all = run.accepted.iter();
    all.filter_map(|accepted| Some((accepted, landing(accepted)?)))
        .collect()
}

const HEIGHT: f64 = 0.3;

/// Two bars over a half span of 1, pressed down at their joint by the load factor; EA = 1.
fn truss(increment: f64, top: f64) -> Scene {
    let text = format!(
        "(title: \"t\", nodes: [Through(id: \"b\", points: [(-1, 0), (0, {HEIGHT}), (1, 0)], per_element: 2)],
          materials: [Section(id: \"m\", EA: 1, EI: 1e-8, GA: 10)], bodies: [Beam(id: \"b\", along: \"b\", material: \"m\")],
          supports: [(node: \"b.start\", fix: [x, y]), (node: \"b.end\", fix: [x, y])],
          loads: [Force(node: \"b.2\", y: -1)],
          history: (path: [0, {top}], increment: {increment}, jumps: dynamic),
          monitors: [(name: \"u_y\", of: Displacement(node: \"b.2\", component: y)),
                     (name: \"u_x\", of: Displacement(node: \"b.2\", component: x))])"
    );
    read(&text)
}

/// Load that holds the joint at height y: 2 EA (1 / l − 1 / L) y, l² = 1 + y².
fn held(y: f64) -> f64 {
    let length = (1.0 + HEIGHT * HEIGHT).sqrt();
    2.0 * (1.0 / (1.0 + y * y).sqrt() - 1.0 / length) * y
}

/// Strain energy of both bars with the joint at height y: EA (l − L)² / L.
fn energy(y: f64) -> f64 {
    let length = (1.0 + HEIGHT * HEIGHT).sqrt();
    ((1.0 + y * y).sqrt() - length).powi(2) / length
}

#[test]
fn a_truss_lets_go_at_its_limit_load_and_rests_where_its_bars_hold_that_load_again() {
    let length = (1.0 + HEIGHT * HEIGHT).sqrt();
    let crest = (length.powf(2.0 / 3.0) - 1.0).sqrt();
    let limit = held(crest);
    let top = 1.5 * limit;
    for increment in [0.02, 0.1, 0.35] {
        let run = finished(&truss(increment * limit, top));
        let landed = landings(&run);
        let [(rest, motion)] = landed[..] else {
            panic!("{increment}: {} landings", landed.len())
        };
        // Both ends of the last half enclose it; what is left is the bars' bending.
        let found = 1e-6 * top;
        assert!(
            (motion.from - limit).abs() < 2.0 * found,
            "{} {limit}",
            motion.from
        );
        assert!(rest.load > motion.from && rest.load - motion.from <= found);
        let (mut low, mut high) = (-2.0, -HEIGHT);
        while high - low > 1e-12 {
            let middle = (low + high) / 2.0;
            if held(middle) > rest.load {
                low = middle;
            } else {
                high = middle;
            }
        }
        let y = HEIGHT + rest.monitors["u_y"];
        assert!((y - low).abs() < 1e-6, "{y} {low}");
        assert!(rest.monitors["u_x"].abs() < 1e-9);
        // What the load gives and the bars do not keep is what viscosity takes, but for the size of the steps.
        let freed = rest.load * (crest - y) - (energy(y) - energy(crest));
        assert!(motion.dissipated > 0.0);
        assert!(
            (motion.dissipated / freed - 1.0).abs() < 0.1,
            "{} {freed}",
            motion.dissipated
        );
        // Elsewhere no increment is a motion, and the history goes to its end.
        let moved = |a: &&Accepted| {
            matches!(
                a.event.outcome,
                Outcome::Increment {
                    motion: Some(_),
                    ..
                }
            )
        };
        assert_eq!(run.accepted.iter().filter(moved).count(), 1);
        assert_eq!(run.accepted.last().unwrap().load, top);
    }
}

#[test]
fn a_scene_lets_go_and_rests_at_the_same_place_whatever_the_increment() {
    let cantilevers = ["8", "12", "20"].map(|angle| {
        let set = vec![("friction.angle", angle)];
        ("02-two-cantilevers-rough", set)
    });
    let ladder = [
        ("settings.strategy", "ladder"),
        ("settings.geometry", "consistent"),
        ("settings.slip", "increment"),
        ("settings.sticking", "anchored"),
    ];
    let others = ["osc-border", "osc-snap"].map(|name| (name, ladder.to_vec()));
    for (name, set) in cantilevers.into_iter().chain(others) {
        let mut found: Vec<(f64, f64, f64)> = Vec::new();
        for increment in ["0.05", "0.1", "0.25", "0.5"] {
            let mut set = set.clone();
            set.extend([
                ("history.increment", increment),
                ("history.jumps", "dynamic"),
            ]);
            let scene = scene(name, &set);
            let last = *scene.model.path.last().unwrap();
            let run = finished(&scene);
            let landed = landings(&run);
            let [(rest, motion)] = landed[..] else {
                panic!("{set:?}: {} landings", landed.len())
            };
            let verdict = rest.state.start.verdict.as_ref().unwrap();
            assert_eq!(verdict.broken().count(), 0, "{set:?}");
            assert!(motion.dissipated > 0.0, "{set:?}");
            assert_eq!(run.accepted.last().unwrap().load, last);
            found.push((
                motion.from / last,
                rest.monitors["u_x"],
                rest.monitors["u_y"],
            ));
        }
        let first = found[0];
        for (load, x, y) in found {
            // The limit is known to 1e-6 of the largest load, from both sides.
            assert!((load - first.0).abs() < 2e-6, "{name} {load} {}", first.0);
            assert!(
                (x - first.1).abs() < 1e-4 && (y - first.2).abs() < 1e-4,
                "{name} {x} {y} {first:?}"
            );
        }
    }
}

#[test]
fn a_motion_is_stepped_through_left_and_taken_up_again_with_the_same_bits() {
    let set = [("friction.angle", "20"), ("history.jumps", "dynamic")];
    let scene = scene("02-two-cantilevers-rough", &set);
    let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
    let mut kept = None;
    while let Some(event) = stepper.step() {
        if matches!(
            &event.outcome,
            Outcome::Motion(MotionEvent::Step { number: 20, .. })
        ) {
            kept = Some(stepper.state().clone());
        }
    }
    let kept = kept.expect("a motion of more than 20 steps");
    let text = ron::to_string(&kept).unwrap();
    let mut again = Stepper::new(Arc::new(scene.model.clone()));
    again.restore(&ron::from_str(&text).unwrap());
    while again.step().is_some() {}
    assert_eq!(again.state(), stepper.state());
}

#[test]
fn without_a_word_nothing_moves_on() {
    for jumps in ["cut", "stop", "accept"] {
        let set = [("friction.angle", "10"), ("history.jumps", jumps)];
        let run = run(&scene("02-two-cantilevers-rough", &set));
        let moved = |a: &&Accepted| {
            matches!(
                a.event.outcome,
                Outcome::Increment {
                    motion: Some(_),
                    ..
                }
            )
        };
        assert_eq!(run.accepted.iter().filter(moved).count(), 0, "{jumps}");
    }
}

/// Pressed beyond its friction, a block without support slides forever.
#[test]
fn what_nothing_stops_comes_to_no_rest_and_says_so() {
    let set = [
        ("friction.angle", "16"),
        ("history.jumps", "dynamic"),
        ("settings.strategy", "ladder"),
        ("settings.geometry", "consistent"),
    ];
    let run = run(&scene("osc-block-slide", &set));
    let (event, failure) = run.failure.expect("nothing holds it");
    assert!(
        matches!(failure, stickslip::step::event::Failure::NoRest { .. }),
        "{failure:?} at load {}",
        event.load_factor
    );
}
