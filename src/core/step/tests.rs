//! Tests of the stepper with bodies given by a matrix: contacts on a floor, and a slave node with two contacts.

use super::drive::{RunEnd, Until};
use super::stepper::Stepper;
use crate::interface::census::census;
use crate::model::{
    Body, BodyKind, Component, Contact, Dofs, Form, Linear, LinearSolver, Load, Node, Surface,
    Touch,
};
use crate::{Friction, JudgedLaw, Mode, Model, Settings, Strategy};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::Arc;

fn to_the_end(stepper: &mut Stepper) -> RunEnd<Infallible> {
    stepper.drive(Until::end().minors(10_000), |_| ControlFlow::Continue(()))
}

fn rough(angle: f64) -> Friction {
    Friction {
        angle,
        cohesion: 0.0,
    }
}

/// Slave nodes above a floor, with a symmetric stiffness and loads in the components (n, t) = (y, −x) of each.
fn on_floor(
    stiffness: &[f64],
    load: &[f64],
    nodes: &[(f64, Friction)],
    (increment, settings): (f64, Settings),
) -> Stepper {
    let mut model = Model::builder("A constant interface");
    let floor = [9.0, -9.0].map(|x| model.node("floor", [x, 0.0]));
    model.surface(Surface::endless("floor", floor));
    let size = load.len();
    let sign = |dof: usize| if dof.is_multiple_of(2) { -1.0 } else { 1.0 };
    let entry = |i: usize, j: usize| sign(i) * sign(j) * stiffness[(i ^ 1) * size + (j ^ 1)];
    let entries = (0..size * size).map(|k| (k / size, k % size, entry(k / size, k % size)));
    let springs = Linear {
        form: Form::Stiffness,
        entries: entries.collect(),
        bars: Vec::new(),
    };
    let own: Vec<usize> = (0..)
        .zip(nodes)
        .map(|(x, (gap, _))| model.node("slave", [f64::from(x), *gap]))
        .collect();
    for ((&node, (_, friction)), load) in own.iter().zip(nodes).zip(load.chunks_exact(2)) {
        model.contact(Contact::new(node, vec![0], *friction));
        model
            .load(node, Component::X, -load[1])
            .load(node, Component::Y, load[0]);
    }
    model.body("springs", own, BodyKind::Linear(springs));
    let touch = Touch::Start;
    model
        .history(vec![0.0, 1.0], increment)
        .settings(Settings { touch, ..settings });
    Stepper::new(Arc::new(model.build().unwrap()))
}

/// One contact with a normal load of 3 and a tangential load of `drag`.
fn one(drag: f64) -> Stepper {
    let (stiffness, load) = ([10.0, 0.0, 0.0, 5.0], [-3.0, drag]);
    on_floor(
        &stiffness,
        &load,
        &[(0.1, rough(20.0))],
        (0.25, Settings::default()),
    )
}

#[test]
fn a_constant_interface_of_one_contact_is_the_closed_form() {
    // It touches at λ = 1/3, where w_n = −0.1; from there F_n = 3 λ − 1, and it slides where the drag exceeds the bound.
    let mu = 20_f64.to_radians().tan();
    let mut slides = one(2.0);
    assert_eq!(to_the_end(&mut slides), RunEnd::Finished);
    let (contact, w) = (&slides.state().nodes[0], &slides.state().u);
    let own = w.len() - 2;
    assert!((contact.f_n - 2.0).abs() < 1e-10 && (w[own + 1] + 0.1).abs() < 1e-12);
    assert!((contact.f_t + mu * 2.0).abs() < 1e-10, "{contact:?}");
    assert!((w[own] + (2.0 - 2.0 * mu) / 5.0).abs() < 1e-10);
    // Half the increment's drag before it touches gives its slip; without slip it sticks where it touched.
    let mut sticks = one(0.0);
    assert_eq!(to_the_end(&mut sticks), RunEnd::Finished);
    let contact = &sticks.state().nodes[0];
    assert_eq!(contact.mode, Mode::Fixed);
    assert!((contact.f_n - 2.0).abs() < 1e-10 && contact.f_t.abs() < 1e-12);
}

/// Pseudo-random numbers between −1 and 1.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(1);
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 / (1_u64 << 53) as f64) * 2.0 - 1.0
    }
}

/// Three contacts on a body that couples them, with random loads.
fn coupled(seed: u64, history: (f64, Settings)) -> Stepper {
    let mut next = random(seed);
    let (contacts, size) = (3, 6);
    let factor: Vec<f64> = (0..size * size).map(|_| next()).collect();
    let mut stiffness = vec![0.0; size * size];
    for i in 0..size {
        for j in 0..size {
            let product = |k: usize| factor[i * size + k] * factor[j * size + k];
            stiffness[j * size + i] = (0..size).map(product).sum::<f64>();
        }
        stiffness[i * size + i] += 1.0;
    }
    let load: Vec<f64> = (0..size).map(|_| next()).collect();
    let nodes: Vec<_> = (0..contacts)
        .map(|k| (0.1 * next().abs(), rough(10.0 * k as f64)))
        .collect();
    on_floor(&stiffness, &load, &nodes, history)
}

#[test]
fn what_constant_interfaces_end_in_is_a_state_that_the_census_finds() {
    let mut found = 0;
    for seed in 0..200 {
        let mut stepper = coupled(seed, (1.0, Settings::default()));
        let problem = stepper.interface_problem().unwrap();
        let census = census(&problem).unwrap();
        if to_the_end(&mut stepper) != RunEnd::Finished {
            assert!(census.answers.is_empty(), "{seed}: it has {census:?}");
            continue;
        }
        let state = stepper.state();
        if state.next.attempt > 1 || state.sub_increment.cut > 0 {
            continue;
        }
        let close = |a: f64, b: f64| (a - b).abs() < 1e-8;
        let is = |answer: &crate::interface::problem::Answer| {
            let pairs = answer.nodes.iter().zip(&state.nodes);
            pairs.fold(true, |all, (answer, contact)| {
                all && close(answer.f_n, contact.f_n) && close(answer.f_t, contact.f_t)
            })
        };
        let known = census.answers.iter().any(|found| is(&found.answer));
        assert!(known, "{seed}: {:?}", state.nodes);
        found += 1;
    }
    assert!(found > 100, "{found} of 200 were compared");
}

/// A node on two springs in the corner of a floor and a wall: one contact with each.
fn cornered(solver: LinearSolver, pressed: [f64; 2]) -> Stepper {
    let at = [[1.0, 1.0], [2.0, 0.0], [0.0, 0.0], [0.0, 2.0]];
    let names = ["ball", "floor.1", "corner", "wall.2"];
    let nodes = names.iter().zip(at).map(|(name, at)| Node {
        name: (*name).into(),
        at,
    });
    let spring = |k: usize| (k, k, 10.0);
    let body = Body {
        name: "springs".into(),
        nodes: vec![0],
        kind: BodyKind::Linear(Linear {
            form: Form::Stiffness,
            entries: vec![spring(0), spring(1)],
            bars: Vec::new(),
        }),
    };
    // Outside is on the right of the walk: above the floor walked towards −x, and next to the wall walked upwards.
    let surface = |name: &str, nodes: [usize; 2]| Surface::new(name, vec![nodes.to_vec()], true);
    let contact = |surface: usize| Contact::new(0, vec![surface], Friction::default());
    let load = |(dof, value)| Load {
        dof,
        value,
        scale: Default::default(),
        volume: None,
    };
    let model = Model {
        bodies: vec![body],
        loads: [(0, -15.0 * pressed[0]), (1, -15.0 * pressed[1])]
            .map(load)
            .into(),
        increment: 0.25,
        settings: Settings {
            solver,
            ..Settings::default()
        },
        budget: 1e9,
        dofs: Dofs {
            first: vec![0, 2, 4, 6],
            count: vec![2; 4],
            equation: vec![Some(0), Some(1), None, None, None, None, None, None],
            equations: 2,
            inner: 0,
        },
        length: 1.0,
        ..Model::from_contacts(
            "In a corner",
            nodes.collect(),
            vec![surface("floor", [1, 2]), surface("wall", [2, 3])],
            vec![contact(0), contact(1)],
        )
    };
    Stepper::new(Arc::new(model))
}

#[test]
fn a_slave_node_can_have_two_contacts_at_once() {
    for solver in [LinearSolver::Augmented, LinearSolver::Condensed] {
        let mut stepper = cornered(solver, [1.0, 1.2]);
        assert_eq!(to_the_end(&mut stepper), RunEnd::Finished, "{solver:?}");
        let state = stepper.state();
        // Displacements of 1 down and 1 to the left take 10 of each load; the rest is contact pressure.
        let [floor, wall] = [&state.nodes[0], &state.nodes[1]];
        assert!((floor.f_n - 8.0).abs() < 1e-9, "{solver:?} {floor:?}");
        assert!((wall.f_n - 5.0).abs() < 1e-9, "{solver:?} {wall:?}");
        assert!((state.u[0] + 1.0).abs() < 1e-12 && (state.u[1] + 1.0).abs() < 1e-12);
        let verdict = state.start.verdict.unwrap();
        assert_eq!(verdict.broken().count(), 0, "{verdict:?}");
        assert!(verdict.worst[JudgedLaw::Balance as usize].is_some());
    }
}

#[test]
fn of_two_contacts_at_a_node_one_can_be_closed_and_the_other_open() {
    let mut stepper = cornered(LinearSolver::Auto, [0.5, 1.2]);
    assert_eq!(to_the_end(&mut stepper), RunEnd::Finished);
    let state = stepper.state();
    assert!((state.nodes[0].f_n - 8.0).abs() < 1e-9 && state.nodes[1].mode == Mode::Free);
    assert!((state.u[0] + 0.75).abs() < 1e-12);
}

#[test]
fn every_strategy_steps_a_constant_interface() {
    for strategy in Strategy::ALL {
        let settings = Settings {
            strategy,
            ..Settings::default()
        };
        let mut stepper = coupled(7, (0.5, settings));
        assert_eq!(to_the_end(&mut stepper), RunEnd::Finished, "{strategy:?}");
    }
}
