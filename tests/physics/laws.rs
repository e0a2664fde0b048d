//! The laws of pairs against closed forms: penalty floors, elastic slip, ties, cohesion by area; and every way of solving them.

use crate::common::{self, finished, read, run, stepped};
use std::sync::Arc;
use stickslip::contact::table2::Rule;
use stickslip::model::{Bond, Mode};
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;
use stickslip::step::intervene::Intervention;
use stickslip::step::stepper::Stepper;

/// A block of 2 by 1 on a floor; its top is moved by (x, y).
struct Block {
    elements: (usize, usize),
    nu: f64,
    pair: &'static str,
    friction: &'static str,
    moved: (f64, f64),
    supports: &'static str,
    settings: String,
}

impl Default for Block {
    fn default() -> Self {
        Block {
            elements: (4, 2),
            nu: 0.0,
            pair: "",
            friction: "()",
            moved: (0.0, -1e-6),
            supports: "(node: \"block.left\", fix: [x])",
            settings: String::new(),
        }
    }
}

/// Young's modulus of the block.
const E: f64 = 1000.0;

impl Block {
    fn scene(&self) -> Result<Scene, String> {
        let Block {
            elements,
            nu,
            pair,
            friction,
            moved: (x, y),
            supports,
            settings,
        } = self;
        let text = format!(
            r#"(
    title: "A block on a floor",
    nodes: [
        Block(id: "block", corners: [(0.0, 0.0), (2.0, 1.0)], elements: {elements:?}),
        Line(id: "floor", from: (9.0, 0.0), to: (-7.0, 0.0), elements: 1, per_element: 2),
    ],
    materials: [Elastic(id: "soft", E: {E:?}, nu: {nu:?})],
    bodies: [Solid(id: "block", mesh: "block", material: "soft")],
    surfaces: [(id: "floor", along: "floor")],
    slaves: [(nodes: ["block.bottom"], on: ["floor"] {pair})],
    friction: {friction},
    supports: [{supports}],
    loads: [
        Displacement(node: "block.top", component: y, value: {y:?}, scale: [(0.0, 0.0), (1.0, 1.0), (2.0, 1.0)]),
        {along}
    ],
    history: (path: [0.0, {end:?}], increment: 0.5),
    settings: ({settings}),
    monitors: [
        (name: "x", of: Contact(component: x)),
        (name: "y", of: Contact(component: y)),
        (name: "pressure", of: Pressure()),
        (name: "shear", of: Shear()),
        (name: "bottom", of: Displacement(node: "block.bottom.3", component: y)),
    ],
)"#,
            along = match *x {
                0.0 => String::new(),
                x => format!(
                    r#"Displacement(node: "block.top", component: x, value: {x:?}, scale: [(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)])"#
                ),
            },
            end = if *x == 0.0 { 1.0 } else { 2.0 },
        );
        Scene::from_text("block.ron", &text, &[]).map_err(|error| error.to_string())
    }

    /// The monitors x, y, pressure, shear and bottom at the end.
    fn end(&self) -> [f64; 5] {
        let scene = self.scene().unwrap_or_else(|error| panic!("{error}"));
        last(&scene)
    }
}

fn last(scene: &Scene) -> [f64; 5] {
    let run = run(scene);
    assert!(run.failure.is_none(), "{:?}", run.failure);
    let last = run.accepted.last().unwrap();
    ["x", "y", "pressure", "shear", "bottom"].map(|name| last.monitors[name])
}

fn close(found: f64, exact: f64, relative: f64) {
    assert!(
        (found - exact).abs() <= relative * exact.abs(),
        "{found} is not {exact}"
    );
}

#[test]
fn a_block_on_a_penalty_floor_gives_way_by_p_times_h_over_e_and_one_over_k() {
    let block = Block {
        pair: ", law: Penalty(stiffness: 500.0)",
        ..Block::default()
    };
    // u = p (h / E + 1 / K).
    let pressure = 1e-6 / (1.0 / E + 1.0 / 500.0);
    let [_, y, found, shear, bottom] = block.end();
    close(y, 2.0 * pressure, 1e-5);
    close(found, pressure, 1e-5);
    close(bottom, -pressure / 500.0, 1e-5);
    assert!(shear.abs() < 1e-9 * pressure);
}

#[test]
fn every_node_of_the_penalty_floor_has_the_same_pressure_and_shows_its_penetration() {
    let scene = Block {
        pair: ", law: Penalty(stiffness: 500.0)",
        ..Block::default()
    }
    .scene()
    .unwrap();
    let run = run(&scene);
    let event = &run.accepted.last().unwrap().event;
    let areas: f64 = scene
        .model
        .contacts
        .iter()
        .filter_map(|contact| contact.area)
        .sum();
    close(areas, 2.0, 1e-14);
    for (contact, found) in scene.model.contacts.iter().zip(&event.nodes) {
        let [pressure, _] = contact.pressure(found.f_n, found.f_t).unwrap();
        close(pressure, 1e-6 / (1.0 / E + 1.0 / 500.0), 1e-5);
        close(found.gap, -pressure / 500.0, 1e-9);
    }
}

#[test]
fn a_penalty_tends_to_hard_contact_with_its_inverse() {
    let at = |pair| {
        Block {
            nu: 0.3,
            pair,
            ..Block::default()
        }
        .end()[1]
    };
    let hard = at("");
    let errors = [
        at(", law: Penalty(stiffness: 1e5)"),
        at(", law: Penalty(stiffness: 1e6)"),
        at(", law: Penalty(stiffness: 1e7)"),
    ]
    .map(|force| (hard - force) / hard);
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((9.5..10.5).contains(&ratio), "{errors:?}");
    }
}

#[test]
fn a_block_that_sticks_elastically_is_a_spring_in_series() {
    // Shear by prescribed top, with all y held: the shear modulus is E / 2 where nu is 0.
    let block = Block {
        pair: ", start: fixed, law: Penalty(stiffness: 500.0), stick: 300.0",
        friction: "(angle: 60.0)",
        moved: (1e-8, -1e-6),
        supports: "",
        ..Block::default()
    };
    let scene = block.scene().unwrap();
    let run = finished(&scene);
    let last = run.accepted.last().unwrap();
    for (contact, (state, found)) in scene
        .model
        .contacts
        .iter()
        .zip(last.state.nodes.iter().zip(&last.event.nodes))
    {
        assert_eq!(state.mode, Mode::Fixed);
        let moved = run.stepper.model().place(&last.state.u, contact.node)[0]
            - scene.model.nodes[contact.node].at[0];
        // t points to −x on this floor.
        close(-moved, -found.f_t / (300.0 * contact.area.unwrap()), 1e-6);
    }
}

#[test]
fn cohesion_by_area_does_not_hang_on_the_mesh() {
    let slid = |elements| {
        Block {
            elements,
            friction: "(adhesion: 0.25)",
            moved: (0.4, -0.05),
            supports: "",
            ..Block::default()
        }
        .end()
    };
    for elements in [(1, 1), (3, 1), (5, 2)] {
        let [x, _, _, shear, _] = slid(elements);
        close(x, -0.25 * 2.0, 1e-9);
        close(shear, 0.25, 1e-9);
    }
}

/// A tall block of two that are tied, or of one piece.
fn tall(tied: bool, settings: &str) -> Scene {
    let nodes = match tied {
        true => {
            r#"Block(id: "low", corners: [(0.0, 0.0), (2.0, 1.0)], elements: (3, 2)),
               Block(id: "up", corners: [(0.0, 1.0), (2.0, 2.0)], elements: (3, 2))"#
        }
        false => r#"Block(id: "up", corners: [(0.0, 0.0), (2.0, 2.0)], elements: (3, 4))"#,
    };
    let (bodies, rest, bottom) = match tied {
        true => (
            r#"Solid(id: "low", mesh: "low", material: "soft"), Solid(id: "up", mesh: "up", material: "soft")"#,
            r#"surfaces: [(id: "face", along: "low.top")],
               slaves: [(nodes: ["up.bottom"], on: ["face"], law: Tied)],"#,
            "low.bottom",
        ),
        false => (
            r#"Solid(id: "up", mesh: "up", material: "soft")"#,
            "",
            "up.bottom",
        ),
    };
    let text = format!(
        r#"(
    title: "Tied or of one piece",
    nodes: [{nodes}],
    materials: [Elastic(id: "soft", E: 100.0, nu: 0.3)],
    bodies: [{bodies}],
    {rest}
    supports: [(node: "{bottom}", fix: [x, y])],
    loads: [
        Displacement(node: "up.top", component: y, value: 0.2),
        Displacement(node: "up.top", component: x, value: 0.5),
    ],
    history: (path: [0.0, 1.0], increment: 0.25),
    settings: ({settings}),
    monitors: [
        (name: "right", of: Displacement(node: "up.right.{right}", component: x)),
        (name: "up", of: Displacement(node: "up.right.{right}", component: y)),
    ],
)"#,
        // The middle of the right side of the upper element, from below.
        right = if tied { 2 } else { 6 },
    );
    read(&text)
}

#[test]
fn tied_blocks_are_one_body_also_where_they_are_pulled_and_turned() {
    let of = |scene: &Scene| {
        let run = run(scene);
        assert!(run.failure.is_none(), "{:?}", run.failure);
        let last = run.accepted.last().unwrap();
        let tied = last
            .event
            .nodes
            .iter()
            .all(|found| found.decision.rule == Rule::Tied);
        assert!(tied, "no other rule decides");
        ["right", "up"].map(|name| last.monitors[name])
    };
    let whole = of(&tall(false, ""));
    for solver in ["condensed", "augmented"] {
        for residual in ["accumulate", "stress"] {
            let settings = format!("solver: {solver}, residual: {residual}");
            let tied = of(&tall(true, &settings));
            for (tied, whole) in tied.iter().zip(whole) {
                close(*tied, whole, 1e-7);
            }
        }
    }
}

#[test]
fn a_tied_node_cannot_be_let_go_by_hand() {
    let scene = tall(true, "");
    let mut stepper = Stepper::new(Arc::new(scene.model));
    let open = |mode| Intervention::Force {
        slave: 0,
        mode,
        hold: true,
    };
    assert!(stepper.intervene(&open(Mode::Free)).is_err());
    assert!(stepper.intervene(&open(Mode::Fixed)).is_ok());
}

/// Every law beside the others: penalty with elastic slip at the bottom, pressed and dragged over its floor.
fn mixed(settings: &str) -> Block {
    Block {
        elements: (1, 1),
        nu: 0.3,
        pair: ", law: Penalty(stiffness: 800.0), stick: 600.0",
        friction: "(angle: 20.0, adhesion: 0.1)",
        moved: (0.01, -0.01),
        supports: "",
        settings: settings.into(),
    }
}

#[test]
fn all_strategies_and_both_solvers_agree_where_bonds_give_way() {
    let wanted = mixed("").end();
    for strategy in [
        "table2",
        "newton",
        "sliding",
        "lemke",
        "census",
        "gauss_seidel",
        "copositive",
        "ladder",
    ] {
        for solver in ["condensed", "augmented"] {
            let settings = format!("strategy: {strategy}, solver: {solver}");
            for (found, wanted) in mixed(&settings).end().iter().zip(wanted) {
                assert!(
                    (found - wanted).abs() < 1e-6 * wanted.abs().max(1e-3),
                    "{settings}: {found} {wanted}"
                );
            }
        }
    }
}

#[test]
fn readings_of_the_method_agree_where_bonds_give_way() {
    let wanted = mixed("").end();
    for settings in [
        "t_max: consistent",
        "residual: stress",
        "residual: accumulate",
        "geometry: frozen",
    ] {
        for (found, wanted) in mixed(settings).end().iter().zip(wanted) {
            assert!(
                (found - wanted).abs() < 1e-6 * wanted.abs().max(1e-3),
                "{settings}: {found} {wanted}"
            );
        }
    }
}

#[test]
fn a_state_that_is_gone_back_to_goes_on_with_the_same_bits() {
    for scene in [mixed("").scene().unwrap(), tall(true, "")] {
        let model = Arc::new(scene.model);
        let (states, events) = stepped(&model);
        for at in [1, states.len() / 2] {
            let mut again = Stepper::new(model.clone());
            again.restore(&states[at]);
            let event = again.step().cloned();
            assert_eq!(event.as_ref(), events.get(at), "from {at}");
        }
    }
}

#[test]
fn accepted_states_obey_the_laws_of_their_bonds() {
    for scene in [mixed("").scene().unwrap(), tall(true, "")] {
        let run = run(&scene);
        for accepted in &run.accepted {
            let verdict = accepted.state.start.verdict.as_ref().unwrap();
            assert_eq!(verdict.broken().count(), 0, "{:?}", verdict.largest());
            let of_bonds = verdict.bonds.iter().flatten().count();
            assert!(of_bonds > 0, "no law of bonds was judged");
        }
        assert!(matches!(
            run.stepper.event().outcome,
            Outcome::Increment { .. }
        ));
    }
}

/// The 4 x 2 block of con.inp (E 1000, nu 0.3, mu 0.3, moved by 0.004 and −0.01), linear: the same moved by a part of it. Sums of
/// forces by CalculiX's own matrix, condensed, and three solvers of Siconos.
#[test]
fn a_hard_block_meets_the_forces_that_other_codes_find() {
    let part = 1e-5;
    let block = |pair| Block {
        nu: 0.3,
        pair,
        friction: "(angle: 16.699244233993622)",
        moved: (0.004 * part, -0.01 * part),
        supports: "",
        ..Block::default()
    };
    let mut spec = block("").scene().unwrap().spec;
    // Both at once, as there.
    spec.loads.iter_mut().for_each(common_scale);
    spec.history.path = vec![0.0, 1.0];
    spec.history.increment = 1.0;
    let scene = Scene::from_spec("con", spec).unwrap();
    let [x, y, ..] = last(&scene);
    close(y / part, 24.43055, 1e-4);
    close(-x / part, 2.60120, 1e-4);
}

fn common_scale(load: &mut stickslip::format::spec::LoadSpec) {
    if let stickslip::format::spec::LoadSpec::Displacement { scale, .. } = load {
        scale.clear();
    }
}

#[test]
fn laws_that_make_no_sense_are_refused_with_what_would() {
    let refused = |pair, friction| {
        let block = Block {
            pair,
            friction,
            ..Block::default()
        };
        block.scene().map(|_| ()).unwrap_err()
    };
    let cases = "\
        , law: Penalty(stiffness: 0.0) | () | a stiffness must be positive
        , law: Penalty(stiffness: -1.0) | () | a stiffness must be positive
        , law: Penalty(stiffness: 1e31) | () | a stiffness must be positive and finite
        , stick: 0.0 | () | a stiffness must be positive
        , area: -2.0 | () | it must be positive
        , law: Tied, stick: 3.0 | () | leave stick out
        , law: Tied, friction: Some((angle: 2.0)) | () | leave friction out
        , law: Tied, start: sliding | () | leave start out
         | (adhesion: -1.0) | must not be negative";
    for case in cases.lines() {
        let parts: Vec<&str> = case.split(" | ").map(str::trim).collect();
        let [pair, friction, wanted] = parts[..] else {
            panic!("{case}");
        };
        let message = refused(pair, friction);
        assert!(message.contains(wanted), "{pair} {friction}: {message}");
    }
}

/// In N and m, the contact stiffness of steel is beyond 1e12.
#[test]
fn a_law_in_newtons_and_metres_gives_the_same_state() {
    let pressed = Block {
        pair: ", law: Penalty(stiffness: 5e5), stick: 5e4",
        friction: "(angle: 20.0)",
        moved: (1e-4, -1e-4),
        supports: "",
        ..Block::default()
    };
    let soft = pressed.scene().unwrap();
    let mut text = soft.text.clone();
    for (soft, stiff) in [("E: 1000.0", "E: 2e11"), ("5e5", "1e14"), ("5e4", "1e13")] {
        assert!(text.contains(soft));
        text = text.replace(soft, stiff);
    }
    let stiff = Scene::from_text("block.ron", &text, &[]).unwrap();
    let [x, y, pressure, shear, bottom] = last(&stiff);
    let [soft_x, soft_y, soft_pressure, soft_shear, soft_bottom] = last(&soft);
    for (stiff, soft) in [
        (x, soft_x),
        (y, soft_y),
        (pressure, soft_pressure),
        (shear, soft_shear),
    ] {
        close(stiff / 2e8, soft, 1e-9);
    }
    close(bottom, soft_bottom, 1e-9);
}

/// A pad is drawn along an arm that it bends: the side stretches more at the clamp than at the pad, and with it the elastic slip.
#[test]
fn elastic_slip_on_a_side_that_stretches_unevenly_is_no_slip() {
    let text = r#"(
    title: "A pad on an arm",
    nodes: [
        Block(id: "arm", corners: [(0.0, 0.0), (2.0, 0.5)], elements: (1, 1)),
        Node(id: "pad", at: (1.2, 0.5)),
        Node(id: "end", at: (1.2, 2.5)),
    ],
    materials: [Elastic(id: "soft", E: 100.0, nu: 0.0)],
    bodies: [
        Solid(id: "arm", mesh: "arm", material: "soft"),
        Springs(id: "hold", bars: [
            (nodes: ["pad", "end"], angle: 90.0, stiffness: 10.0),
            (nodes: ["pad", "end"], angle: 0.0, stiffness: 10.0),
        ]),
    ],
    surfaces: [(id: "top", along: "arm.top")],
    slaves: [(nodes: ["pad"], on: ["top"], stick: 2.0, area: 1.0)],
    friction: (angle: 70.0),
    supports: [(node: "arm.left", fix: [x, y])],
    loads: [
        Displacement(node: "end", component: y, value: -0.4, scale: [(0.0, 0.0), (1.0, 1.0)]),
        Displacement(node: "end", component: x, value: -0.3, scale: [(1.0, 0.0), (2.0, 1.0)]),
    ],
    history: (path: [0.0, 1.0, 2.0], increment: 0.25),
    monitors: [(name: "stuck", of: Modes(mode: fixed))],
)"#;
    let scene = Scene::from_text("pad.ron", text, &[]).unwrap();
    let run = finished(&scene);
    assert_eq!(run.accepted.len(), 8);
    assert!(
        run.accepted
            .iter()
            .all(|state| state.monitors["stuck"] == 1.0)
    );
}

/// A node on two springs over a floor.
fn node(pair: &str) -> Result<Scene, String> {
    let text = format!(
        r#"(
    title: "A node on springs",
    nodes: [
        Node(id: "a", at: (0.5, 0.01)),
        Line(id: "floor", from: (1.0, 0.0), to: (0.0, 0.0), elements: 1, per_element: 2),
    ],
    materials: [],
    bodies: [Matrix(id: "springs", nodes: ["a"], stiffness: [[10.0, 0.0], [0.0, 10.0]])],
    surfaces: [(id: "floor", along: "floor")],
    slaves: [(nodes: ["a"], on: ["floor"] {pair})],
    friction: (angle: 40.0),
    loads: [Force(node: "a", x: 1.0, y: -4.0)],
    history: (path: [0.0, 1.0], increment: 1.0),
)"#
    );
    Scene::from_text("node.ron", &text, &[]).map_err(|error| error.to_string())
}

#[test]
fn a_body_given_by_a_matrix_has_an_area_only_where_its_pair_says_so() {
    let message = node(", law: Penalty(stiffness: 50.0)").unwrap_err();
    assert!(message.contains("give the pair an `area`"), "{message}");
    let scene = node(", law: Penalty(stiffness: 50.0), stick: 20.0, area: 0.5").unwrap();
    assert_eq!(scene.model.contacts[0].bond, Bond::Giving([0.04, 0.1]));
    let found = run(&scene);
    let state = &found.accepted.last().unwrap().state.nodes[0];
    // Down: 4 = 10 (0.01 + c F) + F. Along: 1 = 10 c' F' + F'.
    close(state.f_n, (4.0 - 0.1) / 1.4, 1e-9);
    close(state.f_t, 1.0 / 2.0, 1e-9);
}

#[test]
fn a_node_past_the_end_of_its_surface_cannot_be_tied() {
    let text = common::two_blocks(1);
    assert!(
        text.model
            .contacts
            .iter()
            .all(|contact| contact.bond.is_hard())
    );
    let mut spec = node("").unwrap().spec;
    spec.slaves[0].law = stickslip::format::contact_law::ContactLaw::Tied;
    assert!(Scene::from_spec("node", spec.clone()).is_ok());
    if let stickslip::format::spec::Nodes::Node { at, .. } = &mut spec.nodes[0] {
        *at = (1.5, 0.0);
    }
    let message = Scene::from_spec("node", spec).unwrap_err().to_string();
    assert!(
        message.contains("beyond the ends of its surface"),
        "{message}"
    );
}

#[test]
fn a_corner_of_two_rigid_surfaces_refuses_what_gives_way() {
    let mut spec = node(", law: Penalty(stiffness: 50.0), area: 0.5")
        .unwrap()
        .spec;
    let wall =
        r#"Line(id: "wall", from: (0.8, 1.0), to: (0.8, -1.0), elements: 1, per_element: 2)"#;
    spec.nodes.push(ron::from_str(wall).unwrap());
    let mut surface = spec.surfaces[0].clone();
    (surface.id, surface.along) = ("wall".into(), "wall".into());
    spec.surfaces.push(surface);
    spec.slaves[0].on.push("wall".into());
    let message = Scene::from_spec("node", spec.clone())
        .unwrap_err()
        .to_string();
    assert!(message.contains("cross"), "{message}");
    spec.slaves[0].law = stickslip::format::contact_law::ContactLaw::Hard;
    assert!(Scene::from_spec("node", spec).is_ok());
}

/// Nodes that stick between linear bodies balance in one major iteration, along whatever directions it was solved; the surface turns in it.
#[test]
fn the_forces_of_stuck_nodes_are_components_along_the_directions_of_the_accepted_state() {
    let scene = read(STUCK);
    let run = finished(&scene);
    for accepted in &run.accepted {
        let event = &accepted.event;
        let largest = event.nodes.iter().map(|record| record.f_n);
        let scale = largest.fold(0.0, f64::max);
        for (slave, record) in event.nodes.iter().enumerate() {
            let node = &accepted.state.nodes[slave];
            assert_eq!(record.decision.before, Mode::Fixed);
            let differs = (record.f_n - node.f_n).hypot(record.f_t - node.f_t);
            assert!(differs < 1e-8 * scale, "{slave}: {differs} of {scale}");
        }
    }
    let [x, y] = ["x", "y"].map(|monitor| common::last(&run, monitor));
    let slave = &run.accepted.last().unwrap().event.nodes[0];
    let normal = slave.f_n.hypot(slave.f_t);
    assert!((normal - x.hypot(y)).abs() < 1e-8 * normal);
    assert!(
        slave.f_t.abs() < 0.999 * x,
        "the surface has turned under the node: {} {x}",
        slave.f_t
    );
}

const STUCK: &str = r#"(
    title: "Two blocks of small strains, pressed and then sheared",
    nodes: [
        Block(id: "a", corners: [(0.0, 0.0), (1.0, 1.0)], elements: (2, 1), element: quad4),
        Block(id: "b", corners: [(-0.5, -1.0), (1.5, 0.0)], elements: (3, 1), element: quad4),
    ],
    materials: [Elastic(id: "soft", E: 100.0, nu: 0.3, update: small)],
    bodies: [Solid(id: "a", mesh: "a", material: "soft"), Solid(id: "b", mesh: "b", material: "soft")],
    surfaces: [(id: "top", along: "b.top")],
    slaves: [(nodes: ["a.bottom"], on: ["top"], start: fixed)],
    friction: (angle: 60.0),
    supports: [(node: "b.bottom", fix: [x, y])],
    loads: [
        Displacement(node: "a.top", component: y, value: -0.02, scale: [(0.0, 0.0), (1.0, 1.0)]),
        Displacement(node: "a.top", component: x, value: 0.01, scale: [(1.0, 0.0), (2.0, 1.0)]),
    ],
    history: (path: [0.0, 1.0, 2.0], increment: 1.0),
    monitors: [
        (name: "x", of: Contact(node: "a.1", component: x)),
        (name: "y", of: Contact(node: "a.1", component: y)),
    ],
)"#;
