//! The judge on states made wrong on purpose, one law at a time, and on the scenes in which wrong states were once accepted.

use std::sync::Arc;
use stickslip::contact::balance::{self, Forces};
use stickslip::contact::judge::{Judge, JudgedState};
use stickslip::contact::laws::{JudgedLaw, Scales, Verdict};
use stickslip::model::Friction;
use stickslip::model::{Bond, Contact, Surface};
use stickslip::scene::Scene;
use stickslip::step::event::{Failure, Outcome};
use stickslip::step::stepper::Stepper;

const TOLERANCE: f64 = 1e-8;

/// One slave node over a chain; node 0 is the slave.
struct Stage {
    chain: Vec<[f64; 2]>,
    elements: Vec<Vec<usize>>,
    friction: Friction,
    brought: f64,
    bond: Bond,
}

impl Stage {
    /// A floor of two straight elements from (2, 0) to (−2, 0): n is up and t points to −x.
    fn floor(angle: f64, cohesion: f64) -> Stage {
        Stage::chain(&[[2.0, 0.0], [0.0, 0.0], [-2.0, 0.0]], angle, cohesion)
    }

    /// Straight elements through these points.
    fn chain(points: &[[f64; 2]], angle: f64, cohesion: f64) -> Stage {
        Stage {
            chain: points.to_vec(),
            elements: (1..points.len()).map(|k| vec![k, k + 1]).collect(),
            friction: Friction { angle, cohesion },
            brought: 0.0,
            bond: Bond::Hard,
        }
    }

    fn judge(&self, from: [f64; 2], to: [f64; 2], force: [f64; 2]) -> Verdict {
        let surfaces = [surface(self.elements.clone())];
        let slave = slave(&surfaces, self.friction, self.bond);
        let (verdict, contact) = judged(
            &surfaces,
            slave,
            &self.chain,
            [from, to],
            force,
            self.brought,
        );
        for k in 0..2 {
            let sum: f64 = contact.iter().map(|f| f[k]).sum();
            assert!(sum.abs() < 1e-15, "action is reaction: {contact:?}");
        }
        verdict
    }

    /// The laws that are broken.
    fn broken(&self, from: [f64; 2], to: [f64; 2], force: [f64; 2]) -> Vec<JudgedLaw> {
        let verdict = self.judge(from, to, force);
        verdict.broken().map(|finding| finding.law).collect()
    }
}

/// tan 30°.
const MU: f64 = 0.577_350_269_189_625_7;

/// A node that may touch a floor, y = 0, and a wall of two pieces, x = 1, whose outward side is −x.
fn between_floor_and_wall(from: [f64; 2], to: [f64; 2]) -> Vec<JudgedLaw> {
    let chain = [[3.0, 0.0], [-3.0, 0.0], [1.0, 2.0], [1.0, 1.0], [1.0, -1.0]];
    let surfaces = [
        surface(vec![vec![1, 2]]),
        surface(vec![vec![3, 4], vec![4, 5]]),
    ];
    let slave = slave(&surfaces, Friction::default(), Bond::Hard);
    let (verdict, _) = judged(&surfaces, slave, &chain, [from, to], [0.0; 2], 0.0);
    verdict.broken().map(|finding| finding.law).collect()
}

fn surface(elements: Vec<Vec<usize>>) -> Surface {
    Surface::new("s", elements, true)
}

/// Node 0, which may touch all these surfaces.
fn slave(surfaces: &[Surface], friction: Friction, bond: Bond) -> Contact {
    Contact {
        bond,
        ..Contact::new(0, (0..surfaces.len()).collect(), friction)
    }
}

/// The judge's verdict on node 0 that went from a place to another over a chain that stays, and the forces that it distributes.
fn judged(
    surfaces: &[Surface],
    slave: Contact,
    chain: &[[f64; 2]],
    way: [[f64; 2]; 2],
    force: [f64; 2],
    brought: f64,
) -> (Verdict, Vec<[f64; 2]>) {
    judged_over(surfaces, slave, [chain; 2], way, force, brought, [0.0; 2])
}

/// The same over a chain that moves. `elastic` are the tangential force in the first place, and the elastic slip when the node was
/// anchored.
fn judged_over(
    surfaces: &[Surface],
    slave: Contact,
    chains: [&[[f64; 2]]; 2],
    way: [[f64; 2]; 2],
    force: [f64; 2],
    brought: f64,
    elastic: [f64; 2],
) -> (Verdict, Vec<[f64; 2]>) {
    let [before, now] = [0, 1].map(|k| [&[way[k]], chains[k]].concat());
    let friction = slave.friction;
    let seen = JudgedState {
        surfaces,
        contacts: &[slave],
        friction: &[friction],
        before: &before,
        now: &now,
        out: [&[], &[]],
        forces: &[force],
        brought: &[brought],
        earlier: &elastic[..1],
        anchored: &elastic[1..],
        ties: &[None],
        scales: Scales {
            length: 1.0,
            force: 1.0,
            lengths: TOLERANCE,
            forces: TOLERANCE,
        },
    };
    let mut contact = vec![[0.0; 2]; now.len()];
    let verdict = Judge::with_capacity(now.len(), 1).interface(&seen, &mut contact);
    (verdict, contact)
}

#[test]
fn a_node_that_went_through_a_surface_which_is_not_its_nearest_is_refused() {
    let through = [JudgedLaw::Penetration];
    assert_eq!(between_floor_and_wall([0.9, 0.1], [1.1, 0.01]), through);
    // Where two pieces of the wall meet, too.
    assert_eq!(between_floor_and_wall([0.9, 1.0], [2.5, 1.0]), through);
    // It stays before the wall, was behind it already, or went over the wall's end.
    assert_eq!(between_floor_and_wall([0.9, 0.1], [0.95, 0.01]), []);
    assert_eq!(between_floor_and_wall([1.2, 0.1], [1.1, 0.01]), []);
    assert_eq!(between_floor_and_wall([0.9, 2.5], [1.1, 2.5]), []);
}

#[test]
fn a_node_inside_the_surface_or_pressed_over_a_gap_is_refused() {
    let stage = Stage::floor(30.0, 0.0);
    assert_eq!(
        stage.broken([1.0, 0.5], [1.0, -1e-6], [0.0, 0.0]),
        [JudgedLaw::Penetration]
    );
    assert_eq!(
        stage.broken([1.0, 0.5], [1.0, 1e-6], [0.0, 0.1]),
        [JudgedLaw::Gap]
    );
    assert_eq!(
        stage.broken([1.0, 0.5], [1.0, -1e-6], [0.0, 0.1]),
        [JudgedLaw::Gap]
    );
    assert_eq!(
        stage.broken([1.0, 0.5], [2.5, 0.1], [0.0, 0.1]),
        [JudgedLaw::Gap]
    );
    assert_eq!(stage.broken([1.0, 0.5], [1.0, -1e-9], [0.0, 0.1]), []);
    assert_eq!(stage.broken([1.0, 0.5], [2.5, -0.1], [0.0, 0.0]), []);
}

#[test]
fn a_surface_that_pulls_or_gives_more_friction_than_it_has_is_refused() {
    let at = [1.0, 0.0];
    let stage = Stage::floor(30.0, 0.0);
    assert!(
        stage
            .broken(at, at, [0.0, -0.1])
            .contains(&JudgedLaw::Tension)
    );
    assert_eq!(stage.broken(at, at, [MU + 1e-6, 1.0]), [JudgedLaw::Cone]);
    assert_eq!(stage.broken(at, at, [MU - 1e-9, 1.0]), []);
    assert_eq!(Stage::floor(30.0, 0.2).broken(at, at, [MU + 0.19, 1.0]), []);
    // A smooth surface gives none.
    assert_eq!(
        Stage::floor(0.0, 0.0).broken(at, at, [1e-6, 1.0]),
        [JudgedLaw::Cone]
    );
}

#[test]
fn net_slip_needs_friction_at_its_limit_against_it_also_across_a_border() {
    let stage = Stage::floor(30.0, 0.0);
    // To the left, that is along t: friction points to the right.
    for (from, to) in [(1.0, 0.9), (0.3, -0.4)] {
        let (from, to) = ([from, 0.0], [to, 0.0]);
        assert_eq!(stage.broken(from, to, [MU, 1.0]), [], "opposed");
        assert_eq!(
            stage.broken(from, to, [-MU, 1.0]),
            [JudgedLaw::Slip],
            "driven"
        );
        assert_eq!(
            stage.broken(from, to, [0.5 * MU, 1.0]),
            [JudgedLaw::Slip],
            "not mobilised"
        );
        assert_eq!(stage.broken(from, from, [0.5 * MU, 1.0]), [], "stuck");
    }
    let slip = stage
        .judge([0.3, 0.0], [-0.4, 0.0], [-MU, 1.0])
        .largest()
        .unwrap();
    assert!(
        (slip.numbers.slip - 0.7).abs() < 1e-12 && slip.numbers.f_t > 0.0,
        "{slip:?}"
    );
    // What creeps by three millionths is not stuck.
    assert_eq!(
        stage.broken([1.0, 0.0], [1.000003, 0.0], [0.0, 1.0]),
        [JudgedLaw::Slip]
    );
}

#[test]
fn slip_that_a_scene_brings_counts_from_where_it_began() {
    // u_tS* − u_tS = 0.2: the node has gone 0.2 to the right (−t) already, so that friction at its limit to the left is right
    // though it stands still.
    let stage = Stage {
        brought: 0.2,
        ..Stage::floor(30.0, 0.0)
    };
    let at = [1.0, 0.0];
    assert_eq!(stage.broken(at, at, [-MU, 1.0]), []);
    assert_eq!(stage.broken(at, at, [MU, 1.0]), [JudgedLaw::Slip]);
    assert_eq!(
        stage.broken(at, [0.8, 0.0], [0.1, 1.0]),
        [],
        "it is back where it stuck"
    );
}

#[test]
fn a_node_that_was_open_may_have_touched_anywhere_on_its_way_but_not_before_it() {
    let stage = Stage::floor(30.0, 0.0);
    let from = [1.0, 0.3];
    // It came from the right.
    assert_eq!(stage.broken(from, [0.5, 0.0], [MU, 1.0]), []);
    assert_eq!(
        stage.broken(from, [0.5, 0.0], [0.2, 1.0]),
        [],
        "it stuck where it is"
    );
    assert_eq!(
        stage.broken(from, [0.5, 0.0], [-0.2, 1.0]),
        [],
        "and may be pulled back there"
    );
    assert_eq!(
        stage.broken(from, [0.5, 0.0], [-MU, 1.0]),
        [JudgedLaw::Touch]
    );
    // From past the end nothing can be told.
    assert_eq!(stage.broken([2.5, 0.0], [0.5, 0.0], [-MU, 1.0]), []);
}

#[test]
fn in_a_concave_corner_both_sides_give_a_force_and_only_there() {
    // Slopes of 45 degrees.
    let valley = [[1.0, 1.0], [0.0, 0.0], [-1.0, 1.0]];
    let smooth = Stage::chain(&valley, 0.0, 0.0);
    let bottom = [0.0, 0.0];
    assert_eq!(smooth.broken(bottom, bottom, [0.3, 1.0]), []);
    assert_eq!(smooth.broken(bottom, bottom, [1.1, 1.0]), [JudgedLaw::Cone]);
    assert!(
        smooth
            .broken(bottom, [0.1, 0.1], [0.0, 1.0])
            .contains(&JudgedLaw::Cone)
    );
    assert_eq!(
        smooth.broken([0.5, 0.5], bottom, [0.3, 1.0]),
        [],
        "it slid in, without friction"
    );
    let rough = Stage::chain(&valley, 20.0, 0.0);
    let edge = 25_f64.to_radians();
    let force = |angle: f64| [angle.cos(), angle.sin()];
    assert_eq!(rough.broken(bottom, bottom, force(edge + 1e-6)), []);
    assert_eq!(
        rough.broken(bottom, bottom, force(edge - 1e-6)),
        [JudgedLaw::Cone]
    );
    // It slid down the right wall, whose normal is at 135 degrees: friction there points up the wall, which gives 115.
    let slid = |angle: f64| rough.broken([0.5, 0.5], bottom, force(angle.to_radians()));
    assert_eq!(slid(114.0), []);
    assert_eq!(slid(120.0), [JudgedLaw::Slip]);
}

/// A node slides onto a kink of 2e-4, of one surface, or of two that cross or end and begin there: friction is at its limit against
/// the slip, within that kink.
#[test]
fn a_slight_kink_takes_no_friction_from_a_node_that_slid_onto_it() {
    let h = 1e-4_f64;
    let phi = 30_f64.to_radians();
    let friction = Friction {
        angle: 30.0,
        cohesion: 0.0,
    };
    let bent = |h: f64| [[1.0, h], [0.0, 0.0], [0.0, 0.0], [-1.0, h]];
    let crossed = [[1.0, h], [-1.0, -h], [1.0, -h], [-1.0, h]];
    let one = vec![surface(vec![vec![1, 2], vec![2, 4]])];
    let two = vec![surface(vec![vec![1, 2]]), surface(vec![vec![3, 4]])];
    let turned = vec![two[1].clone(), two[0].clone()];
    for (name, surfaces, chain) in [
        ("valley", &one, bent(h)),
        ("valley of two", &two, bent(h)),
        ("valley of two, turned", &turned, bent(h)),
        ("crossing", &two, crossed),
        ("crossing, turned", &turned, crossed),
        ("ridge", &one, bent(-h)),
        ("ridge of two", &two, bent(-h)),
        ("ridge of two, turned", &turned, bent(-h)),
    ] {
        let is_ridge = name.starts_with("ridge");
        // From the right, friction points to the right; and the other way round.
        for side in [1.0, -1.0] {
            let broken = |from: f64, against: f64| {
                let rise = if is_ridge { -h } else { h };
                let way = [[side * from, from * rise], [0.0, 0.0]];
                let slave = slave(surfaces, friction, Bond::Hard);
                let force = [side * against, 1.0];
                let (verdict, _) = judged(surfaces, slave, &chain, way, force, 0.0);
                verdict.broken().map(|f| f.law).collect::<Vec<_>>()
            };
            let [least, most] = [(phi - h).tan(), (phi + h).tan()];
            for against in [least, most] {
                assert_eq!(broken(0.5, against), [], "{name} {side}");
            }
            let between = broken(0.5, phi.tan());
            assert_eq!(between.is_empty(), !is_ridge, "{name} {side}: {between:?}");
            for against in [least - 1e-6, 0.3, 0.0, -0.3, -least] {
                let found = broken(0.5, against);
                assert!(
                    found.contains(&JudgedLaw::Slip),
                    "{name} {side} {against}: {found:?}"
                );
            }
            assert!(
                broken(0.5, most + 1e-6).contains(&JudgedLaw::Cone),
                "{name} {side}"
            );
            // What stood there before may bear any force of the cone.
            for against in [least, 0.3, 0.0, -0.3, -least] {
                assert_eq!(broken(0.0, against), [], "{name} {side} {against}");
            }
        }
    }
}

#[test]
fn on_a_convex_vertex_a_node_stays_that_slides_down_neither_side() {
    // Slopes of 15 degrees.
    let rise = 15_f64.to_radians().tan();
    let ridge = [[1.0, -rise], [0.0, 0.0], [-1.0, -rise]];
    let top = [0.0, 0.0];
    let up = [0.0, 1.0];
    assert_eq!(Stage::chain(&ridge, 20.0, 0.0).broken(top, top, up), []);
    assert_eq!(
        Stage::chain(&ridge, 10.0, 0.0).broken(top, top, up),
        [JudgedLaw::Cone]
    );
    assert_eq!(
        Stage::chain(&ridge, 0.0, 0.0).broken(top, top, up),
        [JudgedLaw::Cone]
    );
}

#[test]
fn forces_out_of_balance_at_a_node_and_on_the_bodies_as_a_whole_are_refused() {
    let model = Scene::open("01-pinned-beam-rough-floor", &[])
        .unwrap()
        .model;
    let now: Vec<[f64; 2]> = model.nodes.iter().map(|node| node.at).collect();
    let (dofs, nodes) = (model.dofs.len(), now.len());
    let scales = Scales {
        length: model.length,
        force: 1.0,
        lengths: TOLERANCE,
        forces: TOLERANCE,
    };
    // A node that is free along x, and the pin, which is held there.
    let x_of = |free: bool| {
        let held = |node: &usize| model.dofs.equation[model.dofs.first[*node]].is_some() == free;
        let node = (0..nodes).filter(|&n| model.dofs.count[n] == 3).find(held);
        model.dofs.first[node.unwrap()]
    };
    let (free, pin) = (x_of(true), x_of(false));
    let broken = |inside: &[(usize, f64)], loads: &[(usize, f64)]| {
        let (mut internal, mut load) = (vec![0.0; dofs], vec![0.0; dofs]);
        inside
            .iter()
            .for_each(|&(dof, force)| internal[dof] = force);
        loads.iter().for_each(|&(dof, force)| load[dof] = force);
        let contact = vec![[0.0; 2]; nodes];
        let forces = Forces {
            internal: &internal,
            load: &load,
            contact: &contact,
        };
        let mut verdict = Verdict::default();
        balance::check(&model, &forces, &now, &scales, &mut verdict);
        let laws: Vec<JudgedLaw> = verdict.broken().map(|finding| finding.law).collect();
        laws
    };
    assert_eq!(broken(&[], &[]), []);
    assert_eq!(broken(&[], &[(free, 1e-6)]), [JudgedLaw::Balance]);
    assert_eq!(broken(&[], &[(pin, 1.0)]), [], "the pin bears it");
    assert_eq!(
        broken(&[(free, 1e-6)], &[(free, 1e-6)]),
        [JudgedLaw::Moments]
    );
    // A couple: the forces add up to nothing, and turn the beam.
    let couple = [(free, 1e-6), (pin, -1e-6)];
    assert_eq!(broken(&couple, &[(free, 1e-6)]), [JudgedLaw::Moments]);
}

/// Runs a scene to its end, and gives back what it was refused for on the way.
fn run(file: &str, set: &[(&str, &str)]) -> (Stepper, Vec<JudgedLaw>, Option<Failure>) {
    let path = format!("{}/tests/findings/{file}", env!("CARGO_MANIFEST_DIR"));
    open(Scene::open(&path, &owned(set)).unwrap())
}

fn owned(set: &[(&str, &str)]) -> Vec<(String, String)> {
    let pair = |(path, value): &(&str, &str)| ((*path).to_owned(), (*value).to_owned());
    set.iter().map(pair).collect()
}

fn open(scene: Scene) -> (Stepper, Vec<JudgedLaw>, Option<Failure>) {
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let (mut refused, mut failure) = (Vec::new(), None);
    while let Some(event) = stepper.step() {
        match &event.outcome {
            Outcome::Refused { why, .. } => refused.push(why.law),
            Outcome::Cut {
                why: Failure::Refused(why),
                ..
            } => refused.push(why.law),
            Outcome::Failed(why) => {
                failure = Some(why.clone());
                break;
            }
            Outcome::Increment { marked, .. } => assert_eq!(*marked, None),
            _ => {}
        }
    }
    (stepper, refused, failure)
}

/// F_n and F_t of a slave node, by name.
fn forces(stepper: &Stepper, name: &str) -> [f64; 2] {
    let model = stepper.model();
    let of = |slave: &Contact| model.nodes[slave.node].name == name;
    let slave = model.contacts.iter().position(of).unwrap();
    let node = &stepper.state().start.nodes[slave];
    [node.f_n, node.f_t]
}

/// The same after the last increment that ends at a load factor.
fn forces_at(file: &str, name: &str, load: f64, set: &[(&str, &str)]) -> [f64; 2] {
    let path = format!("{}/tests/findings/{file}", env!("CARGO_MANIFEST_DIR"));
    let scene = Scene::open(&path, &owned(set)).unwrap();
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let mut found = None;
    while let Some(event) = stepper.step() {
        let there = (event.load_factor - load).abs() < 1e-9;
        match event.outcome {
            Outcome::Increment { .. } if there => found = Some(forces(&stepper, name)),
            Outcome::Failed(_) => break,
            _ => {}
        }
    }
    found.unwrap_or_else(|| panic!("{file} does not come to load {load}"))
}

fn near(found: [f64; 2], right: [f64; 2], tolerance: f64) {
    let size = right[0].abs().max(right[1].abs());
    let off = (0..2)
        .map(|k| (found[k] - right[k]).abs())
        .fold(0.0, f64::max);
    assert!(off <= tolerance * size, "{found:?}, right is {right:?}");
}

#[test]
fn a_node_that_opened_and_touched_again_within_an_increment_has_its_net_slip_counted() {
    // Values from increments of a quarter to a 256th.
    near(
        forces_at("1-sign-after-retouch.ron", "s.3", 0.5001, &[]),
        [0.0942681, -0.0337529],
        1e-3,
    );
    let [_, f_t] = forces_at("2-stuck-after-retouch.ron", "s.9", 0.8, &[]);
    assert!(
        (f_t / 9.74762e-4 - 1.0).abs() < 1e-4,
        "on the limit, while it unloads: {f_t}"
    );
    let (_, refused, failure) = run("2-stuck-after-retouch.ron", &[]);
    assert!(
        refused.contains(&JudgedLaw::Slip) && failure.is_none(),
        "{refused:?} {failure:?}"
    );
}

#[test]
fn the_first_increment_counts_the_slip_of_a_node_that_touches_at_the_start() {
    // Sliding all along, it comes to the same forces with any increment.
    for increment in ["0.1", "0.05", "0.0125"] {
        let set = [("history.increment", increment)];
        let found = forces_at("5-first-increment.ron", "s.13", 0.1, &set);
        near(found, [0.98334013, -0.33475629], 1e-7);
    }
}

#[test]
fn no_state_rests_on_an_element_beyond_its_end() {
    for file in ["3-overhang-smooth.ron", "4-creep-after-overhang.ron"] {
        let (stepper, _, failure) = run(file, &[]);
        // The first one has no state at load 0.7875 on the branch that it is on.
        let load = stepper.state().start.load_factor;
        assert!(
            failure.is_none() || load > 0.78,
            "{file}: {load} {failure:?}"
        );
        let spots = stepper.state().start.nodes.iter().filter_map(|n| n.spot);
        assert!(spots.into_iter().all(|spot| spot.xi.abs() <= 1.0));
    }
}

#[test]
fn reactions_are_those_of_the_load_at_hand() {
    let path = format!(
        "{}/tests/findings/6-reaction-next-load.ron",
        env!("CARGO_MANIFEST_DIR")
    );
    let mut stepper = Stepper::new(Arc::new(Scene::open(&path, &[]).unwrap().model));
    let mut found = Vec::new();
    while let Some(event) = stepper.step() {
        if matches!(event.outcome, Outcome::Increment { .. }) {
            let mut monitors = Vec::new();
            stepper.monitors(&mut monitors);
            found.push(monitors[0]);
        }
    }
    let right = [-1.5, -3.0, -4.5, -6.0];
    for (found, right) in found.iter().zip(right) {
        assert!((found - right).abs() < 1e-9, "{found} {right}");
    }
    assert_eq!(found.len(), right.len());
}

/// The slave node's own support carries it along a floor that does not move either: in fixed mode no friction could hold it, and
/// there would be none.
#[test]
fn a_node_that_its_support_drags_over_a_rigid_floor_has_friction_at_its_limit_both_ways() {
    let text = r#"(title: "dragged", nodes: [Line(id: "strip", from: (0, 0.1), to: (2, 0), elements: 4, per_element: 3),
            Line(id: "floor", from: (4, 0), to: (-2, 0), elements: 1, per_element: 2)],
        materials: [Section(id: "m", EA: 1e3, EI: 1)], bodies: [Beam(id: "strip", along: "strip", material: "m")],
        surfaces: [(id: "floor", along: "floor")], slaves: [(nodes: ["strip.end"], on: ["floor"])], friction: (angle: 20),
        supports: [(node: "strip.start", fix: [rotation])],
        loads: [Displacement(node: "strip.end", component: x, value: 0.3, scale: [(0, 0), (0.5, 0), (1, 1), (2, 0)]),
            Displacement(node: "strip.start", component: x, value: 0.3, scale: [(0, 0), (0.5, 0), (1, 1), (2, 0)]),
            Displacement(node: "strip.start", component: y, value: -0.1, scale: [(0, 0), (0.5, 1)])],
        history: (path: [0, 1, 2], increment: 0.1))"#;
    let mut stepper = Stepper::new(Arc::new(Scene::from_text("t", text, &[]).unwrap().model));
    let mut seen = [false; 2];
    while let Some(event) = stepper.step() {
        assert!(
            !matches!(event.outcome, Outcome::Failed(_)),
            "{:?}",
            event.outcome
        );
        let load = event.load_factor;
        if matches!(event.outcome, Outcome::Increment { .. }) && load > 0.55 {
            let [f_n, f_t] = forces(&stepper, "strip.9");
            // The floor is walked to −x, so that t points there: friction is along t while the node goes to +x.
            let back = stepper.state().start.leg > 0 && load > 1.05;
            let limit = f_n * 20_f64.to_radians().tan() * if back { -1.0 } else { 1.0 };
            assert!(
                f_n > 0.0 && (f_t - limit).abs() < 1e-9 * f_n,
                "{load}: {f_t} {limit}"
            );
            seen[usize::from(back)] = true;
        }
    }
    assert_eq!(seen, [true, true]);
}

#[test]
fn the_rough_cantilevers_at_two_degrees_come_to_the_same_state_with_any_increment() {
    // 0.949343 on this mesh, 0.94871 exactly; it was 1.00678 where friction drove the slip.
    let mut first = None;
    for (increment, more) in [
        ("0.5", None),
        ("0.25", None),
        ("0.5", Some(("settings.strategy", "newton"))),
        ("0.5", Some(("settings.strategy", "lemke"))),
        ("0.5", Some(("settings.strategy", "census"))),
        ("0.5", Some(("settings.t_max", "consistent"))),
        ("0.5", Some(("settings.geometry", "frozen"))),
    ] {
        // With `exact` some strategies that never cut find no state from 0 to 0.5 in one increment.
        let mut set = vec![
            ("settings.point_force", "plain"),
            ("friction.angle", "2"),
            ("refine", "2"),
            ("history.increment", increment),
        ];
        set.extend(more);
        let scene = Scene::open("02-two-cantilevers-rough", &owned(&set)).unwrap();
        let mut stepper = Stepper::new(Arc::new(scene.model));
        let found = loop {
            let event = stepper.step().unwrap();
            match &event.outcome {
                Outcome::Increment { .. } if event.load_factor == 0.5 => {
                    let mut monitors = Vec::new();
                    stepper.monitors(&mut monitors);
                    break monitors[0];
                }
                Outcome::Failed(why) => panic!("{set:?}: {why:?}"),
                _ => {}
            }
        };
        let first = *first.get_or_insert(found);
        assert!(
            (found - first).abs() < 1e-9,
            "{set:?}: {found}, first {first}"
        );
        assert!((found - 0.949343).abs() < 1e-6, "{set:?}: {found}");
    }
}

#[test]
fn a_penalty_node_is_inside_by_its_compliance_times_its_force_and_by_nothing_else() {
    let stage = Stage {
        bond: Bond::Giving([0.1, 0.0]),
        ..Stage::floor(30.0, 0.0)
    };
    let at = |y: f64, f_n: f64| stage.broken([1.0, 0.0], [1.0, y], [0.0, f_n]);
    assert_eq!(at(-0.2, 2.0), []);
    assert_eq!(at(-0.2, 1.9), [JudgedLaw::Penalty]);
    assert_eq!(at(0.0, 2.0), [JudgedLaw::Penalty]);
    assert_eq!(at(-0.2, 0.0), [JudgedLaw::Penetration]);
    assert_eq!(at(0.3, 0.0), []);
    // It has gone along the floor as well, and friction at its limit opposes that.
    let slid = |f_x: f64| stage.broken([1.0, 0.0], [1.5, -0.2], [f_x, 2.0]);
    assert_eq!(slid(-2.0 * MU), []);
    assert_eq!(slid(-1.9 * MU), [JudgedLaw::Slip]);
    assert_eq!(slid(-2.1 * MU), [JudgedLaw::Cone]);
}

#[test]
fn elastic_slip_is_in_proportion_to_the_tangential_force() {
    let stage = Stage {
        bond: Bond::Giving([0.0, 0.25]),
        ..Stage::floor(30.0, 0.0)
    };
    let gone = |x: f64, f_x: f64| stage.broken([1.0, 0.0], [1.0 + x, 0.0], [f_x, 4.0]);
    assert_eq!(gone(0.25, -1.0), []);
    assert_eq!(gone(0.25, -0.9), [JudgedLaw::Stick]);
    assert_eq!(gone(0.0, 0.0), []);
    assert_eq!(gone(-0.5, 2.0), []);
    // Beyond the limit it slides.
    assert_eq!(gone(0.9, -4.0 * MU), []);
}

/// Anchored 0.25 (0.2 + 0.4) = 0.15 ahead, at x = 0.85, which the stretch moves to 0.8585.
#[test]
fn the_surface_between_a_node_and_its_anchor_may_stretch() {
    let surfaces = [surface(vec![vec![1, 2]])];
    let friction = Friction {
        angle: 30.0,
        cohesion: 0.0,
    };
    let gone = |x: f64| {
        let slave = slave(&surfaces, friction, Bond::Giving([0.0, 0.25]));
        let chains: [&[[f64; 2]]; 2] = [&[[2.0, 0.0], [0.0, 0.0]], &[[2.02, 0.0], [0.0, 0.0]]];
        let (way, force) = ([[1.0, 0.0], [x, 0.0]], [-0.2, 1.0]);
        let (verdict, _) = judged_over(&surfaces, slave, chains, way, force, 0.0, [0.2, -0.1]);
        let laws: Vec<JudgedLaw> = verdict.broken().map(|finding| finding.law).collect();
        laws
    };
    assert_eq!(gone(1.0085), []);
    assert_eq!(gone(1.008), [JudgedLaw::Stick]);
}

#[test]
fn a_tied_node_may_be_pulled_and_may_not_stray() {
    let stage = Stage {
        bond: Bond::tied(),
        ..Stage::floor(0.0, 0.0)
    };
    let to = |to: [f64; 2], force: [f64; 2]| stage.broken([1.0, 0.0], to, force);
    assert_eq!(to([1.0, 0.0], [3.0, -7.0]), []);
    assert_eq!(to([1.001, 0.0], [3.0, -7.0]), [JudgedLaw::Tied]);
    assert_eq!(to([1.0, 0.001], [0.0, 0.0]), [JudgedLaw::Tied]);
}

/// A strip whose lower half has small displacements: its forces balance on the undeformed shape, those of the upper half on the
/// deformed one, so that the moments of the whole balance on neither.
#[test]
fn moments_are_not_checked_on_a_body_of_small_and_large_displacements() {
    let scene = |lower: &str| {
        let text = format!(
            r#"(
                title: "A strip of two layers",
                nodes: [Block(id: "strip", corners: [(0.0, 0.0), (4.0, 1.0)], elements: (4, 2))],
                materials: [
                    Elastic(id: "lower", E: 100.0, nu: 0.3, update: {lower}),
                    Elastic(id: "upper", E: 100.0, nu: 0.3),
                ],
                bodies: [Solid(
                    id: "strip", mesh: "strip", material: "lower",
                    regions: [(from: (0.0, 0.5), to: (4.0, 1.0), material: "upper")],
                )],
                supports: [(node: "strip.left", fix: [x, y])],
                loads: [Force(node: "strip.right.5", y: -0.2)],
                history: (path: [0.0, 1.0], increment: 0.5),
            )"#
        );
        Scene::from_text("strip.ron", &text, &[]).unwrap()
    };
    for lower in ["small", "total"] {
        let (stepper, refused, failure) = open(scene(lower));
        assert_eq!((refused, failure), (vec![], None), "{lower}");
        assert_eq!(stepper.state().load_factor, 1.0);
    }
}
