//! The law at a border between two sides: what a node bears there that slid onto it. Kinks go to zero, increments too; the solver,
//! its judge and the judge from outside agree.

use crate::common::{Accepted, finished, read, scene};
use crate::outside::judge::Corner;
use crate::outside::trial::{End, attempt};
use proptest::prelude::*;
use std::sync::Arc;
use stickslip::contact::corner::{Side, beyond_corner, beyond_slid, least_friction, widened};
use stickslip::contact::projection::SurfacePoint;
use stickslip::contact::state::ContactState;
use stickslip::contact::table2::Rule;
use stickslip::contact::tracking::Ground;
use stickslip::model::{Contact, Friction, InitialState, Mode, Surface};
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;
use stickslip::step::stepper::Stepper;

/// Walked towards −x, so that the outside is up.
const T: [f64; 2] = [-1.0, 0.0];

/// A force on a node that slid along t: F_n, and the friction s F_t against that slip.
fn force(f_n: f64, against: f64) -> [f64; 2] {
    [against, f_n]
}

/// Amounts against the law after a slip along t, and without one, from the core and from outside.
fn beyond(friction: &Friction, half: f64, force: [f64; 2]) -> [[f64; 2]; 2] {
    let [before, behind] = Side::pair([0.0, 1.0], half, friction);
    let outside = Corner::with(T, half, friction);
    [
        [
            beyond_slid(force, [&before, &behind], -1.0),
            outside.beyond_slid(force, -1.0),
        ],
        [
            beyond_corner(force, [&before, &behind]),
            outside.beyond_held(force),
        ],
    ]
}

prop_compose! {
    fn a_friction()(angle in 0.0..60.0_f64, cohesion in prop_oneof![Just(0.0), 0.0..2.0_f64]) -> Friction {
        Friction { angle, cohesion }
    }
}

/// Kinks from 1e-9 to 0.1, evenly by their logarithm.
fn a_kink() -> impl Strategy<Value = f64> {
    (-9.0..-1.0_f64).prop_map(|exponent| 10.0_f64.powf(exponent))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// What the law allows lies within the kink of Coulomb's law on a straight side, and what that allows is within the kink of
    /// what the law allows.
    #[test]
    fn allowed_forces_are_within_the_kink_of_coulombs(
        friction in a_friction(),
        kink in a_kink(),
        along in 1e-3..10.0_f64,
        times in prop_oneof![-3.0..3.0_f64, -1e9..1e9_f64],
    ) {
        let phi = friction.angle.to_radians();
        let (sin, cos) = phi.sin_cos();
        // On the line of sliding, and off it by a number of kinks.
        let size = along + friction.cohesion;
        let off = times * kink * size;
        let line = [along * cos, along * sin + friction.cohesion];
        let whole = force(line[0] - off * sin, line[1] + off * cos);
        let [slid, held] = beyond(&friction, 0.5 * kink, whole);
        let tiny = 1e-13 * size.max(off.abs());
        for amount in slid {
            if off.abs() > kink * (size + off.abs()) + tiny {
                prop_assert!(amount > 0.0, "allowed, {times} kinks off: {slid:?}");
            }
            if times.abs() < 1e-3 {
                prop_assert!(amount <= kink * size, "{slid:?}");
            }
        }
        for amount in held {
            if off > kink * (size + off) + tiny {
                prop_assert!(amount > 0.0, "allowed, {times} kinks beyond the cone: {held:?}");
            }
            if times.abs() < 1e-3 {
                prop_assert!(amount <= tiny, "{held:?}");
            }
        }
        let pull = force(-line[0] - kink * size, line[1] - 2.0 * friction.cohesion);
        let [slid, held] = beyond(&friction, 0.5 * kink, pull);
        prop_assert!(slid.into_iter().chain(held).all(|amount| amount > 0.0), "{slid:?} {held:?}");
    }

    /// Both judges allow the same, and what the solver holds, they allow.
    #[test]
    fn solver_and_judges_draw_the_same_line(
        friction in a_friction(),
        half in prop_oneof![1e-9..0.05_f64, 0.0..1.5_f64],
        f_n in 0.0..3.0_f64,
        against in -6.0..6.0_f64,
        near in proptest::option::of(-1e-3..1e-3_f64),
    ) {
        let least = least_friction(&friction, half, f_n);
        let against = near.map_or(against, |near| least + near);
        let [slid, held] = beyond(&friction, half, force(f_n, against));
        let tiny = 1e-9;
        for [core, outside] in [slid, held] {
            prop_assert!(core <= tiny || outside > 0.0, "{core} {outside}");
            prop_assert!(outside <= tiny || core > 0.0, "{core} {outside}");
        }
        let wide = widened(&friction, half);
        let most = wide.coefficient() * f_n + wide.cohesion;
        // Beyond what is jammed, T_max is only large.
        if friction.angle + half.to_degrees() < 89.9 {
            prop_assert_eq!(held[0] <= tiny, against.abs() <= most + tiny, "{:?} {}", held, most);
            let holds = least <= against && against <= most;
            prop_assert!(!holds || slid[0] <= tiny, "{slid:?}: {least} {most}");
            let breaks = against < least - 1e-6 || against > most + 1e-6;
            prop_assert!(!breaks || slid[0] > 0.0, "{slid:?}: {least} {most}");
        }
    }
}

/// Scenes in which a node slid onto a border of elements and was held there by what no slip law allows.
const FINDINGS: [&str; 4] = ["302-178", "301-43", "301-99", "303-243"];

fn finding(name: &str, set: &[(&str, &str)]) -> Scene {
    let root = env!("CARGO_MANIFEST_DIR");
    scene(
        &format!("{root}/tests/findings/7-slid-onto-border-{name}.ron"),
        set,
    )
}

#[test]
fn no_node_that_slid_onto_a_border_is_held_there_against_the_law_of_slip() {
    for name in FINDINGS {
        let scene = finding(name, &[]);
        let trial = attempt(&scene);
        assert_eq!(trial.end, End::Finished, "{name}");
        assert!(trial.wrong.is_empty(), "{name}: {:?}", trial.wrong);
        assert!(end(&scene).1 > 0, "{name}: nothing is released");
    }
}

/// The node, the load, and its place and the ratio of the force's components that finer increments come to.
#[test]
fn what_slid_onto_a_border_has_the_place_and_the_friction_of_finer_increments() {
    for (name, increment, node, load, place, ratio) in [
        ("302-178", 0.2222, "u.2", 0.8889, -0.629386, -0.58861),
        ("301-43", 0.03448, "u.9", 0.96544, 0.401815, -0.12082),
        ("301-99", 0.02703, "r.21", 0.91902, 1.78234, -0.05825),
        ("303-243", 0.1625, "l.38", 0.8125, 0.570966, -0.51921),
    ] {
        for parts in [1.0, 4.0] {
            let increment = format!("{:?}", increment / parts);
            let run = finished(&finding(name, &[("history.increment", &increment)]));
            let model = run.stepper.model();
            let is = |contact: &Contact| model.nodes[contact.node].name == node;
            let slave = model.contacts.iter().position(is).unwrap();
            let at = |accepted: &&Accepted| (accepted.load - load).abs() < 1e-6;
            let state = &run.accepted.iter().find(at).unwrap().state;
            let x = model.place(&state.u, model.contacts[slave].node)[0];
            let [f_x, f_y] = state.nodes[slave].force();
            assert!((x - place).abs() < 1.5e-5, "{name}, {increment}: {x}");
            assert!(
                (f_x / f_y - ratio).abs() < 3e-5,
                "{name}, {increment}: {}",
                f_x / f_y
            );
        }
    }
}

/// Over one surface and over two that cross; from the right, which is along t, and from the left.
#[test]
fn a_node_goes_back_to_the_side_that_it_came_along_where_friction_is_below_the_least() {
    let (half, friction) = (
        0.1_f64,
        Friction {
            angle: 30.0,
            cohesion: 0.2,
        },
    );
    let rise = half.tan();
    let positions = [
        [0.0, 0.0],
        [1.0, rise],
        [0.0, 0.0],
        [-1.0, rise],
        [1.0, -rise],
        [-1.0, -rise],
    ];
    let surface = |elements: Vec<Vec<usize>>| Surface::new("s", elements, true);
    let on = |surface: usize, element: usize, xi: f64| SurfacePoint {
        surface,
        element,
        xi,
    };
    let bent = vec![surface(vec![vec![1, 2], vec![2, 3]])];
    let crossed = vec![surface(vec![vec![1, 5]]), surface(vec![vec![4, 3]])];
    for (surfaces, spot, second, came) in [
        (&bent, on(0, 0, 1.0), None, [on(0, 0, 0.0), on(0, 1, 0.0)]),
        (
            &crossed,
            on(0, 0, 0.0),
            Some(on(1, 0, 0.0)),
            [on(0, 0, -0.5), on(1, 0, 0.5)],
        ),
        (
            &crossed,
            on(1, 0, 0.0),
            Some(on(0, 0, 0.0)),
            [on(0, 0, -0.5), on(1, 0, 0.5)],
        ),
    ] {
        let slave = Contact::new(0, (0..surfaces.len()).collect(), friction);
        let ground = Ground {
            surfaces,
            positions: &positions,
            same_force: 1e-9,
            unclosed: 0.0,
        };
        let least = least_friction(&friction, half, 2.0);
        for (anchor, sign) in came.into_iter().zip([-1.0, 1.0]) {
            for (against, below) in [
                (least - 1e-3, true),
                (-0.5, true),
                (least, false),
                (least + 1e-3, false),
            ] {
                for anchor in [Some(anchor), Some(spot)] {
                    let slid = anchor != Some(spot);
                    let mut node = ContactState {
                        f_n: 2.0,
                        f_t: sign * against,
                        anchor,
                        spot: Some(spot),
                        second,
                        corner: Some(half),
                        ..ContactState::new(Mode::Fixed, &InitialState::default())
                    };
                    let force = node.force();
                    ground.stand(&mut node, &slave, &friction, false);
                    let [f_x, f_y] = node.force();
                    assert!((f_x - force[0]).hypot(f_y - force[1]) < 1e-12);
                    if !(slid && below) {
                        assert!(
                            node.mode == Mode::Fixed && node.corner.is_some(),
                            "{node:?}"
                        );
                        continue;
                    }
                    let (stands, anchor) = (node.spot.unwrap(), anchor.unwrap());
                    assert_eq!(
                        (node.mode, node.corner, node.second),
                        (Mode::Sliding, None, None)
                    );
                    let places = [stands, anchor].map(|at| (at.surface, at.element));
                    assert_eq!(places[0], places[1]);
                    let limit = friction.coefficient() * node.f_n + friction.cohesion;
                    assert!((node.t_max - sign * limit).abs() < 1e-12, "{node:?}");
                    assert!(sign * node.f_t < limit, "{node:?}");
                }
            }
        }
    }
}

/// A node with the weight 1 that a spring draws to the left, by `pull` from where it is at rest, down a slope at x = 0.5 and over a kink
/// of twice `half` degrees at x = 0, which is the meeting of one surface or a crossing of two.
fn dragged(half: f64, pull: f64, crossed: bool, increment: f64) -> Scene {
    let rise = half.to_radians().tan();
    let (low, high) = (-rise, rise);
    let (track, on) = if crossed {
        (
            format!(
                "Through(id: \"a\", points: [(1.0, {high:?}), (-1.0, {low:?})], per_element: 2),
                Through(id: \"b\", points: [(1.0, {low:?}), (-1.0, {high:?})], per_element: 2),"
            ),
            "\"a\", \"b\"",
        )
    } else {
        (
            format!(
                "Through(id: \"a\", points: [(1.0, {high:?}), (0.0, 0.0), (-1.0, {high:?})], per_element: 2),"
            ),
            "\"a\"",
        )
    };
    let surfaces = on.replace("\"a\"", "(id: \"a\", along: \"a\")");
    let surfaces = surfaces.replace(", \"b\"", ", (id: \"b\", along: \"b\")");
    let y = 0.5 * rise;
    let text = format!(
        "(title: \"drawn over a kink\", nodes: [{track} Node(id: \"n\", at: (0.5, {y:?})), Node(id: \"s\", at: (0.5, {y:?}))],
        materials: [], bodies: [Matrix(id: \"spring\", nodes: [\"n\", \"s\"], stiffness: [
            [4.0, 0.0, -4.0, 0.0], [0.0, 0.1, 0.0, -0.1], [-4.0, 0.0, 4.0, 0.0], [0.0, -0.1, 0.0, 0.1]])],
        surfaces: [{surfaces}],
        slaves: [(nodes: [\"n\"], on: [{on}], start: fixed, friction: (angle: 30))],
        supports: [(node: \"s\", fix: [y])],
        loads: [Force(node: \"n\", y: -1.0, scale: [(0.0, 1.0), (1.0, 1.0)]),
            Displacement(node: \"s\", component: x, value: -{pull:?})],
        history: (path: [0.0, 1.0], increment: {increment:?}),
        monitors: [(name: \"u_x\", of: Displacement(node: \"n\", component: x))])"
    );
    read(&text)
}

/// Steps to the end of the history; how often a node went back to the side along which it had come.
fn end(scene: &Scene) -> (Stepper, usize) {
    let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
    let mut releases = 0;
    while let Some(event) = stepper.step() {
        assert!(!matches!(event.outcome, Outcome::Failed(_)), "{event:?}");
        let decisions = event.nodes.iter().map(|node| &node.decision);
        for decision in decisions.filter(|decision| decision.rule == Rule::CornerReleases) {
            let modes = [decision.before, decision.next];
            assert_eq!(modes, [Mode::Fixed, Mode::Sliding]);
            assert!(decision.margin() < 0.0 && event.outcome.ends_major());
            releases += 1;
        }
    }
    (stepper, releases)
}

/// On the slopes friction is at its limit, in the kink it is between both limits; and the size of increments does not matter.
#[test]
fn a_node_that_is_drawn_over_a_kink_rests_where_friction_against_its_slip_holds_it() {
    let phi = 30_f64.to_radians();
    for crossed in [false, true] {
        let mut rests = 0;
        for half in [1e-5, 0.01, 1.0, 10.0] {
            for k in 0..15 {
                let pull = 0.5 + phi.tan() / 4.0 + 0.01 * f64::from(k - 7);
                let [one, many] = [1.0, 1.0 / 16.0].map(|increment| {
                    let scene = dragged(half, pull, crossed, increment);
                    let trial = attempt(&scene);
                    assert!(
                        trial.wrong.is_empty(),
                        "{half} {pull} {crossed}: {:?}",
                        trial.wrong
                    );
                    let (mut stepper, _) = end(&scene);
                    let mut values = Vec::new();
                    stepper.monitors(&mut values);
                    (0.5 + values[0], stepper.state().nodes[0].force())
                });
                let (x, [against, f_n]) = one;
                assert!(
                    (x - many.0).abs() < 1e-8,
                    "{half} {pull} {crossed}: {x} {}",
                    many.0
                );
                let angle = against.atan2(f_n) - phi;
                let h = half.to_radians();
                // Where the other slope is nearer than can be told, it stands on both.
                if x.abs() * (2.0 * h).sin() < 1e-9 {
                    rests += 1;
                    assert!(angle.abs() < h + 1e-8, "{half} {pull} {crossed}: {angle}");
                } else {
                    let edge = -h * x.signum();
                    assert!(
                        (angle - edge).abs() < 1e-8,
                        "{half} {pull} {crossed}: {angle}"
                    );
                }
            }
        }
        assert!(rests > 0, "{crossed}");
    }
}
