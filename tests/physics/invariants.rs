//! What must hold in every scene at every accepted increment, whatever its numbers.

use crate::common::{finished, force, go_on, read, run, scene};
use std::sync::Arc;
use stickslip::format::spec::{LoadSpec, Nodes, Point, Spec};
use stickslip::model::Mode;
use stickslip::model::{Friction, Model};
use stickslip::record::bits;
use stickslip::scene::Scene;
use stickslip::scene::builtin;
use stickslip::step::event::Outcome;
use stickslip::step::state::{State, Status};
use stickslip::step::stepper::Stepper;

/// All built-in scenes but those that are to fail, of which `tests/solver/oscillators.rs` speaks; the inclined cantilever with its
/// node forced to slide once where it stops.
fn accepted_everywhere(check: impl Fn(&Scene, &crate::common::Accepted)) {
    let fails = |name: &str| name.starts_with("osc-") && name != "osc-inclined-cantilever";
    for builtin in builtin::list().iter().filter(|b| !fails(b.name)) {
        let scene = scene(builtin.name, &[]);
        let mut run = run(&scene);
        for _ in 0..3 {
            if run.failure.is_some() {
                (0..scene.model.contacts.len())
                    .for_each(|s| force(&mut run, s, Mode::Sliding, false));
                run = go_on(run);
            }
        }
        assert!(!run.accepted.is_empty(), "{}", builtin.name);
        run.accepted.iter().for_each(|a| check(&scene, a));
    }
}

#[test]
fn accepted_increments_are_in_equilibrium_with_their_supports() {
    accepted_everywhere(|scene, a| {
        let Outcome::Increment {
            after, unsettled, ..
        } = &a.event.outcome
        else {
            unreachable!()
        };
        assert!(after.relative <= after.limit && *unsettled == 0);
        // A second way: interaction and loads against all reactions, summed over the whole scene.
        for axis in 0..2 {
            // Around an axis radial forces go all around, and add up to nothing whatever they are.
            if axis == 0 && scene.model.is_axisymmetric() {
                continue;
            }
            let mut stepper = Stepper::new(Arc::new(with_reactions(&scene.model, axis)));
            stepper.restore(&a.state);
            let mut reactions = Vec::new();
            stepper.monitors(&mut reactions);
            let reaction: f64 = reactions.iter().sum();
            let load: f64 = scene
                .model
                .loads
                .iter()
                .filter(|l| scene.model.dofs.first.iter().any(|f| f + axis == l.dof))
                .map(|l| l.value * l.scale.at(a.load))
                .sum();
            assert!(
                (reaction + load).abs() < 1e-8 * after.scale.max(1.0),
                "{}: {reaction} {load}",
                scene.name
            );
        }
    });
}

/// The model with the reaction of every restrained x (or y) as its monitors.
fn with_reactions(model: &Model, axis: usize) -> Model {
    use stickslip::model::{Monitor, MonitorQuantity};
    let mut model = model.clone();
    let dofs = model.dofs.first.iter().map(|first| first + axis);
    let held = dofs.filter(|&dof| model.dofs.equation[dof].is_none());
    model.monitors = held
        .map(|dof| Monitor {
            name: String::new(),
            of: MonitorQuantity::Reaction { dof },
        })
        .collect();
    model
}

/// What an accepted increment does against contact and Coulomb's law, where a slave node has this friction.
fn against_coulomb(
    scene: &Scene,
    a: &crate::common::Accepted,
    friction: impl Fn(usize) -> Friction,
) -> Vec<String> {
    let Outcome::Increment { after, .. } = &a.event.outcome else {
        unreachable!()
    };
    let (force, length) = (1e-8 * after.scale, 1e-8 * scene.model.length);
    let mut found = Vec::new();
    for (slave, (node, record)) in a.state.start.nodes.iter().zip(&a.event.nodes).enumerate() {
        let mut must = |holds: bool, what: &str| {
            if !holds {
                found.push(format!(
                    "{} load {} node {slave} {:?}: {what}",
                    scene.name, a.load, node.mode
                ));
            }
        };
        let friction = friction(slave);
        let limit = node.f_n.abs() * friction.coefficient() + friction.cohesion;
        if node.mode == Mode::Free {
            must(record.gap >= -length, "penetrates");
            must(node.f_n == 0.0 && node.f_t == 0.0, "has a force");
            continue;
        }
        must(record.gap.abs() <= length, "gap");
        must(node.f_n >= -force, "pulls");
        if node.mode == Mode::Fixed {
            must(record.slip.abs() <= length, "slips");
            must(node.f_t.abs() <= limit + force, "more than friction gives");
        } else {
            must((node.f_t.abs() - limit).abs() <= force, "not at its limit");
            must(
                node.t_max.signum() * record.slip >= -length,
                "friction goes with slip",
            );
        }
    }
    found
}

#[test]
fn accepted_increments_obey_contact_and_coulomb() {
    accepted_everywhere(|scene, a| {
        let own = |slave: usize| scene.model.contacts[slave].friction;
        assert_eq!(against_coulomb(scene, a, own), [""; 0]);
    });
}

/// A block that is pressed on a floor and pulled along it, smooth in front, rough behind, and cohesive between.
const FRICTIONS: &str = r#"(title: "t",
    nodes: [Block(id: "k", corners: [(0, 0), (4, 1)], elements: (4, 1)),
        Line(id: "floor", from: (9, 0), to: (-9, 0), elements: 1, per_element: 2)],
    materials: [Elastic(id: "m", E: 100, nu: 0.3)], bodies: [Solid(id: "k", mesh: "k", material: "m")],
    surfaces: [(id: "floor", along: "floor")],
    slaves: [
        (nodes: ["k.bottom.1", "k.bottom.2", "k.bottom.3"], on: ["floor"], friction: (angle: 35)),
        (nodes: ["k.bottom.4", "k.bottom.5", "k.bottom.6"], on: ["floor"], friction: (angle: 5, cohesion: 0.05)),
        (nodes: ["k.bottom.7", "k.bottom.8", "k.bottom.9"], on: ["floor"]),
    ],
    loads: [Displacement(node: "k.top.all", component: y, value: -0.02, scale: [(0, 0), (1, 1)]),
        Displacement(node: "k.top.all", component: x, value: 0.05, scale: [(1, 0), (2, 1)])],
    history: (path: [0, 2], increment: 0.1))"#;

#[test]
fn each_node_obeys_coulomb_with_its_own_friction_and_cohesion() {
    let scene = read(FRICTIONS);
    let run = finished(&scene);
    let slaves = &scene.model.contacts;
    let all = |friction: &dyn Fn(usize) -> Friction| -> Vec<String> {
        let one = |a| against_coulomb(&scene, a, friction);
        run.accepted.iter().flat_map(one).collect()
    };
    assert_eq!(all(&|slave| slaves[slave].friction), [""; 0]);
    // Nodes of each kind stick and slide, so that the law of any other is broken.
    for k in 0..3 {
        let mine = 3 * k..3 * k + 3;
        let with = |mode: Mode| {
            let has = |a: &crate::common::Accepted| {
                mine.clone().any(|s| a.state.start.nodes[s].mode == mode)
            };
            run.accepted.iter().any(has)
        };
        assert!(with(Mode::Sliding), "nothing of group {k} slides");
        assert!(k == 2 || with(Mode::Fixed), "nothing of group {k} sticks");
    }
    assert_ne!(all(&|_| slaves[0].friction), [""; 0]);
    let without_cohesion = |slave: usize| Friction {
        cohesion: 0.0,
        ..slaves[slave].friction
    };
    assert_ne!(all(&without_cohesion), [""; 0]);
}

#[test]
fn a_scene_that_is_turned_and_moved_gives_turned_results() {
    for name in [
        "01-pinned-beam-rough-floor",
        "02-two-cantilevers-smooth",
        "02-two-cantilevers-rough",
    ] {
        let original = scene(name, &[]);
        let plain = run(&original);
        for angle in [0.7_f64, 2.9, -1.3] {
            let turned = Scene::from_spec(name, turned(&original.spec, angle)).unwrap();
            let run = run(&turned);
            assert_eq!(
                run.accepted.len(),
                plain.accepted.len(),
                "{name} {angle} {:?}",
                run.failure
            );
            let (s, c) = angle.sin_cos();
            for (a, b) in plain.accepted.iter().zip(&run.accepted) {
                for (x, y) in [("u_x", "u_y"), ("contact_x", "contact_y")] {
                    let (px, py) = (a.monitors[x], a.monitors[y]);
                    let expected = [c * px - s * py, s * px + c * py];
                    for (value, expected) in [b.monitors[x], b.monitors[y]].iter().zip(expected) {
                        assert!(
                            (value - expected).abs() < 1e-8,
                            "{name} {angle} load {}: {value} {expected}",
                            a.load
                        );
                    }
                }
                assert_eq!(
                    a.event.nodes[0].decision.next,
                    b.event.nodes[0].decision.next
                );
            }
        }
    }
}

fn turned(spec: &Spec, angle: f64) -> Spec {
    let (s, c) = angle.sin_cos();
    let turn = |(x, y): Point| (c * x - s * y, s * x + c * y);
    let place = |p: Point| (turn(p).0 + 3.0, turn(p).1 - 7.0);
    let mut spec = spec.clone();
    for nodes in &mut spec.nodes {
        match nodes {
            Nodes::Line { from, to, .. } => (*from, *to) = (place(*from), place(*to)),
            other => panic!("turn {other:?} too"),
        }
    }
    for load in &mut spec.loads {
        if let LoadSpec::Force { x, y, .. } = load {
            (*x, *y) = turn((*x, *y));
        }
    }
    spec
}

#[test]
fn a_restored_state_goes_on_with_the_same_bits() {
    for builtin in builtin::list() {
        let model = Arc::new(scene(builtin.name, &[]).model);
        let mut stepper = Stepper::new(model.clone());
        let mut line: Vec<State> = vec![stepper.state().clone()];
        for _ in 0..150 {
            if stepper.step().is_none() {
                break;
            }
            line.push(stepper.state().clone());
        }
        // Back to every state, in an order that jumps, with a solver that has done something else before.
        let count = line.len();
        for k in (0..count - 1).map(|k| (k * 37) % (count - 1)) {
            stepper.restore(&line[k]);
            stepper.step();
            assert!(
                same_bits(stepper.state(), &line[k + 1]),
                "{} at step {k}",
                builtin.name
            );
        }
        let mut fresh = Stepper::new(model);
        fresh.restore(&line[count / 2]);
        for expected in &line[count / 2 + 1..] {
            fresh.step();
            assert!(same_bits(fresh.state(), expected), "{}", builtin.name);
        }
    }
}

/// Equality that distinguishes -0 from 0.
fn same_bits(a: &State, b: &State) -> bool {
    a == b && bits::digest(a) == bits::digest(b)
}

#[test]
fn a_state_survives_being_written_and_read() {
    let mut stepper = Stepper::new(Arc::new(scene("02-two-cantilevers-smooth", &[]).model));
    for _ in 0..40 {
        stepper.step();
    }
    let text = ron::to_string(stepper.state()).unwrap();
    let read: State = ron::from_str(&text).unwrap();
    assert_eq!(&read, stepper.state());
}

#[test]
fn both_residual_methods_and_both_t_max_end_in_the_same_state() {
    for name in [
        "01-pinned-beam-rough-floor",
        "02-two-cantilevers-smooth",
        "02-two-cantilevers-rough",
    ] {
        let reference = run(&scene(name, &[]));
        for (path, value) in [
            ("settings.residual", "accumulate"),
            ("settings.t_max", "consistent"),
        ] {
            let other = run(&scene(name, &[(path, value)]));
            assert_eq!(
                other.stepper.state().status,
                Status::Finished,
                "{name} {value}: {:?}",
                other.failure
            );
            for (a, b) in reference.accepted.iter().zip(&other.accepted) {
                for (monitor, value) in &a.monitors {
                    assert!(
                        (value - b.monitors[monitor]).abs() < 1e-7,
                        "{name} {monitor} load {}",
                        a.load
                    );
                }
            }
        }
    }
}

#[test]
fn condensed_and_whole_system_take_the_same_steps() {
    for builtin in builtin::list() {
        let solved = |solver| {
            let set = [
                ("history.increment", "0.1"),
                ("settings.factor", "each"),
                ("settings.solver", solver),
            ];
            run(&scene(builtin.name, &set))
        };
        let [condensed, whole] = ["condensed", "augmented"].map(solved);
        let name = builtin.name;
        assert_eq!(whole.accepted.len(), condensed.accepted.len(), "{name}");
        assert_eq!(
            whole.failure.is_some(),
            condensed.failure.is_some(),
            "{name}"
        );
        for (a, b) in whole.accepted.iter().zip(&condensed.accepted) {
            // Where a residual ends at the tolerance itself, round-off may cost one more.
            assert!(a.majors.abs_diff(b.majors) <= 1, "{name} load {}", a.load);
            for (monitor, value) in &a.monitors {
                let apart = (value - b.monitors[monitor]).abs();
                assert!(
                    apart < 1e-8 * (1.0 + value.abs()),
                    "{name} {monitor} load {}: {apart:e}",
                    a.load
                );
            }
        }
    }
}
