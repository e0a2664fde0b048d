//! The kinds of elements in whole scenes: patches, closed forms, rates of convergence, locking, loads that follow.

use crate::common::{Run, finished, last, order, read};
use crate::solids::{follows, moved};
use std::fmt::Write;
use stickslip::fem::recovery::{Configuration, nodal_stresses};
use stickslip::format::spec::LoadSpec;
use stickslip::model::{Component, ElementKind};
use stickslip::scene::Scene;

/// Stresses at the nodes of each body in the last accepted state.
fn stresses(run: &Run) -> Vec<Vec<Option<[f64; 4]>>> {
    let state = &run.accepted.last().unwrap().state;
    let at = Configuration {
        u: &state.u,
        before: &state.u,
        history: &state.start.history,
        load_factor: state.load_factor,
    };
    nodal_stresses(run.stepper.model(), at)
}

/// What two blocks side by side may be made of, with as many nodes a side.
fn pairs() -> Vec<(ElementKind, ElementKind)> {
    let mixed = [
        (ElementKind::Triangle3, ElementKind::Quad4),
        (ElementKind::Triangle6, ElementKind::Quad8),
        (ElementKind::Quad9, ElementKind::Quad8Reduced),
        (ElementKind::Quad8, ElementKind::Quad9),
    ];
    ElementKind::ALL
        .into_iter()
        .map(|kind| (kind, kind))
        .chain(mixed)
        .collect()
}

#[test]
fn distorted_patches_of_every_kind_and_of_two_reproduce_a_homogeneous_deformation() {
    let f = [[0.3, -0.2], [0.15, -0.25]];
    for (a, b) in pairs() {
        for material in [
            "law: neohookean",
            "plane: stress",
            "update: updated",
            "update: small",
        ] {
            let base = read(&format!(
                "(title: \"t\", nodes: [
                    Block(id: \"a\", corners: [(0, 0), (1.1, -0.2), (1.3, 1.4), (-0.3, 1.1)], elements: (2, 2), element: {}),
                    Block(id: \"b\", corners: [(1.1, -0.2), (2.4, 0.1), (2.2, 1.9), (1.3, 1.4)], elements: (2, 2), element: {}),
                    Mesh(id: \"k\", of: [\"a\", \"b\"], joints: [(\"a.right\", \"b.left\")])],
                  materials: [Elastic(id: \"m\", E: 100, nu: 0.3, {material})],
                  bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")],
                  history: (path: [0, 1], increment: 0.5))",
                a.word(),
                b.word()
            ));
            let at: Vec<[f64; 2]> = base.model.nodes.iter().map(|n| n.at).collect();
            let mut spec = base.spec.clone();
            let mut held = std::collections::HashSet::new();
            for n in base.model.bodies[0].kind.lines().concat() {
                for component in 0..2 {
                    if held.insert((n, component)) {
                        let name = base.model.nodes[n].name.clone();
                        spec.loads.push(moved(name, component, f, at[n]));
                    }
                }
            }
            let run = finished(&Scene::from_spec("patch", spec).unwrap());
            follows(&run, &at, f, 1e-11, &format!("{a:?} {b:?} {material}"));
            // And one stress everywhere.
            let all: Vec<[f64; 4]> = stresses(&run)[0].iter().map(|s| s.unwrap()).collect();
            for (s, k) in all.iter().flat_map(|s| (0..4).map(move |k| (s, k))) {
                assert!((s[k] - all[0][k]).abs() < 1e-9, "{a:?} {b:?} {material}");
            }
        }
    }
}

#[test]
fn an_axisymmetric_patch_stretched_along_and_around_its_axis_has_one_stress() {
    // u = (α x, β y): E11 = E33, and sums of forces are those on whole circles.
    let (alpha, beta) = (0.02, -0.01);
    for kind in ElementKind::ALL {
        for material in [
            "law: neohookean",
            "law: svk",
            "update: updated",
            "update: small",
        ] {
            let base = read(&format!(
                "(title: \"t\", nodes: [Block(id: \"k\", corners: [(0.5, 0), (2, -0.3), (2.4, 1.9), (0.3, 1.1)], elements: (3, 3), element: {})],
                  materials: [Elastic(id: \"m\", E: 100, nu: 0.3, plane: axisymmetric, {material})],
                  bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")], history: (path: [0, 1], increment: 1))",
                kind.word()
            ));
            let mut spec = base.spec.clone();
            let mut held = std::collections::HashSet::new();
            for n in base.model.bodies[0].kind.lines().concat() {
                let at = base.model.nodes[n].at;
                let parts = [(Component::X, alpha * at[0]), (Component::Y, beta * at[1])];
                for (k, (component, value)) in parts.into_iter().enumerate() {
                    if held.insert((n, k)) {
                        spec.loads.push(LoadSpec::Displacement {
                            node: base.model.nodes[n].name.clone(),
                            component,
                            value,
                            scale: Vec::new(),
                        });
                    }
                }
            }
            let run = finished(&Scene::from_spec("patch", spec).unwrap());
            let u = &run.stepper.state().u;
            for node in &base.model.bodies[0].nodes {
                let (at, first) = (base.model.nodes[*node].at, base.model.dofs.first[*node]);
                // The rules of reduced and of triangular elements are not exact over the radius, nor is what they balance.
                let exact = matches!(kind, ElementKind::Quad8 | ElementKind::Quad9);
                let near = if exact { 1e-9 } else { 2e-4 };
                assert!(
                    (u[first] - alpha * at[0]).abs() < near,
                    "{kind:?} {material}"
                );
                assert!(
                    (u[first + 1] - beta * at[1]).abs() < near,
                    "{kind:?} {material}"
                );
            }
            let all: Vec<[f64; 4]> = stresses(&run)[0].iter().map(|s| s.unwrap()).collect();
            assert!(
                all.iter().all(|s| (s[0] - s[2]).abs() < 0.02),
                "around as along the radius"
            );
        }
    }
}

/// A thick tube under pressure inside, its ends held along the axis: radial displacement and hoop stress inside.
fn tube(kind: ElementKind, cells: usize, rest: &str) -> Run {
    finished(&read(&format!(
        "(title: \"t\", nodes: [Block(id: \"k\", corners: [(1, 0), (2, 0.5)], elements: ({cells}, 2), element: {})],
          materials: [Elastic(id: \"m\", E: 1000, nu: 0.3, plane: axisymmetric, {rest})],
          bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")],
          supports: [(node: \"k.bottom\", fix: [y]), (node: \"k.top\", fix: [y])],
          loads: [Pressure(along: \"k.left\", value: 10)], history: (path: [0, 1], increment: 1),
          monitors: [(name: \"u\", of: Displacement(node: \"k.left.start\", component: x)),
                     (name: \"f\", of: Reaction(node: \"k.top.start\", component: y))])",
        kind.word()
    )))
}

#[test]
fn a_thick_tube_comes_to_lames_closed_form_at_the_rate_of_its_elements() {
    // u(a) = (1 + ν)/E p a²/(b² − a²) ((1 − 2ν) a + b²/a), σθ(a) = p (b² + a²)/(b² − a²).
    let (e, nu, p, a, b) = (1000.0, 0.3, 10.0, 1.0_f64, 2.0_f64);
    let share = p * a * a / (b * b - a * a);
    let expected = (1.0 + nu) / e * share * ((1.0 - 2.0 * nu) * a + b * b / a);
    let hoop = p * (b * b + a * a) / (b * b - a * a);
    for kind in ElementKind::ALL {
        let errors: Vec<(f64, f64)> = [4, 8, 16]
            .map(|cells| {
                let run = tube(kind, cells, "update: small");
                let inside = stresses(&run)[0][0].unwrap();
                (
                    (last(&run, "u") / expected - 1.0).abs(),
                    (inside[2] / hoop - 1.0).abs(),
                )
            })
            .to_vec();
        let rate = order(errors[1].0, errors[2].0, 2.0);
        let of_stress = order(errors[1].1, errors[2].1, 2.0);
        println!("{kind:?}: {errors:?}, orders {rate:.2} {of_stress:.2}");
        // Three points are exact for the stiffness of a triangle in the plane, and not with the radius in it.
        let wanted = match kind {
            ElementKind::Triangle3 | ElementKind::Quad4 | ElementKind::Quad4Reduced => 1.8,
            ElementKind::Triangle6 => 2.0,
            _ => 3.0,
        };
        // Two points give some kinds the nodes' displacements exactly.
        let exact = errors[2].0 < 1e-10;
        assert!(exact || rate > wanted, "{kind:?}: {rate} {errors:?}");
        assert!(of_stress > 0.8, "{kind:?}: {of_stress} {errors:?}");
    }
}

#[test]
fn a_ring_under_a_following_pressure_grows_as_far_in_the_plane_as_around_its_axis() {
    let material = "E: 100, nu: 0.3, law: neohookean";
    let round = finished(&read(&format!(
        "(title: \"t\", nodes: [Block(id: \"k\", corners: [(1, 0), (2, 0.5)], elements: (6, 1), element: quad9)],
          materials: [Elastic(id: \"m\", {material}, plane: axisymmetric)],
          bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")],
          supports: [(node: \"k.bottom\", fix: [y]), (node: \"k.top\", fix: [y])],
          loads: [Pressure(along: \"k.left\", value: 20)], history: (path: [0, 1], increment: 0.25),
          monitors: [(name: \"u\", of: Displacement(node: \"k.left.start\", component: x))])"
    )));
    let flat = finished(&read(&format!(
        "(title: \"t\", nodes: [Block(id: \"k\", corners: [(1, 0), (2, 0), (0, 2), (0, 1)], elements: (6, 8), element: quad9,
            sides: (right: Arc(center: (0, 0)), left: Arc(center: (0, 0))))],
          materials: [Elastic(id: \"m\", {material})], bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")],
          supports: [(node: \"k.bottom\", fix: [y]), (node: \"k.top\", fix: [x])],
          loads: [Pressure(along: \"k.left\", value: 20)], history: (path: [0, 1], increment: 0.25),
          monitors: [(name: \"u\", of: Displacement(node: \"k.bottom.start\", component: x))])"
    )));
    let (u, v) = (last(&round, "u"), last(&flat, "u"));
    assert!(u > 0.2, "a large growth, {u}");
    assert!((u / v - 1.0).abs() < 1e-5, "{u} {v}");
    // The tangent is exact: the iterations end quadratically.
    for run in [&round, &flat] {
        assert!(
            run.accepted.iter().all(|a| a.majors <= 6),
            "too many major iterations"
        );
    }
}

#[test]
fn a_following_pressure_on_a_turned_block_acts_across_the_turned_face() {
    // A block on a hinge, turned by a quarter: pressure p on its top of length 2 pulls now along x.
    let run = finished(&read(
        "(title: \"t\", nodes: [Block(id: \"k\", corners: [(0, 0), (2, 1)], elements: (2, 1))],
          materials: [Elastic(id: \"m\", E: 1e6, nu: 0, thickness: 0.5)], bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")],
          supports: [(node: \"k.bottom.start\", fix: [x, y])],
          loads: [Displacement(node: \"k.bottom.end\", component: x, value: -2, scale: [(0, 0), (0.25, 0.2928932188134524), (0.5, 1), (1, 1)]),
                  Displacement(node: \"k.bottom.end\", component: y, value: 2, scale: [(0, 0), (0.25, 0.7071067811865476), (0.5, 1), (1, 1)]),
                  Pressure(along: \"k.top\", value: 3, scale: [(0.5, 0), (1, 1)])],
          history: (path: [0, 0.25, 0.5, 1], increment: 0.25),
          monitors: [(name: \"a\", of: Reaction(node: \"k.bottom.start\", component: x)),
                     (name: \"b\", of: Reaction(node: \"k.bottom.end\", component: x))])",
    ));
    // The top looks along −x after the turn; pressure pushes along +x with 3 · 2 · 0.5.
    let total = last(&run, "a") + last(&run, "b");
    assert!((total + 3.0).abs() < 1e-4, "{total}");
}

#[test]
fn weight_stretches_a_hanging_bar_as_it_should_in_the_plane_and_around_an_axis() {
    // σ(y) = ρ g (L − y) from the top; the end goes ρ g L²/(2E); the support carries the weight.
    for kind in ElementKind::ALL {
        for (plane, width) in [
            ("stress, thickness: 0.7", 0.7),
            ("axisymmetric", std::f64::consts::PI),
        ] {
            let run = finished(&read(&format!(
                "(title: \"t\", nodes: [Block(id: \"k\", corners: [(0, 0), (1, 10)], elements: (2, 20), element: {})],
                  materials: [Elastic(id: \"m\", E: 1e6, nu: 0, plane: {plane}, update: small)],
                  bodies: [Solid(id: \"b\", mesh: \"k\", material: \"m\")],
                  supports: [(node: \"k.top\", fix: [y]), (node: \"k.left\", fix: [x])],
                  loads: [Volume(on: \"b\", y: -5)], history: (path: [0, 1], increment: 1),
                  monitors: [(name: \"u\", of: Displacement(node: \"k.bottom.start\", component: y))])",
                kind.word()
            )));
            let expected = -5.0 * 100.0 / 2e6;
            let u = last(&run, "u");
            assert!(
                (u / expected - 1.0).abs() < 3e-3,
                "{kind:?} {plane}: {u} {expected}"
            );
            let state = &run.accepted.last().unwrap().state;
            let loads: f64 = run.stepper.model().loads.iter().map(|l| l.value).sum();
            assert!(
                (loads + 5.0 * 10.0 * width).abs() < 1e-9,
                "{kind:?} {plane}: {loads}"
            );
            assert!(state.u.iter().all(|u| u.is_finite()));
        }
    }
}

#[test]
fn two_bars_snap_through_on_their_closed_form() {
    // Half span 1, height 0.5, EA = 10: P = 2 EA (l − L)/L (h − v)/l.
    let run = finished(&read(
        "(title: \"t\", nodes: [Node(id: \"a\", at: (-1, 0)), Node(id: \"b\", at: (1, 0)), Node(id: \"c\", at: (0, 0.5))],
          materials: [], bodies: [Truss(id: \"t\", bars: [(\"a\", \"c\"), (\"b\", \"c\")], EA: 10)],
          supports: [(node: \"a\", fix: [x, y]), (node: \"b\", fix: [x, y]), (node: \"c\", fix: [x])],
          loads: [Displacement(node: \"c\", component: y, value: -1.2)], history: (path: [0, 1], increment: 0.1),
          monitors: [(name: \"f\", of: Reaction(node: \"c\", component: y))])",
    ));
    let whole = 1.25_f64.sqrt();
    for accepted in &run.accepted {
        let h = 0.5 - 1.2 * accepted.load;
        let l = (1.0 + h * h).sqrt();
        let expected = 2.0 * 10.0 * (l - whole) / whole * h / l;
        let found = accepted.monitors["f"];
        assert!((found - expected).abs() < 1e-12, "{h}: {found} {expected}");
    }
}

#[test]
fn a_spring_without_an_angle_acts_along_its_line_and_a_small_truss_is_such_springs() {
    let with = |body: &str| {
        let run = finished(&read(&format!(
            "(title: \"t\", nodes: [Node(id: \"a\", at: (-3, 0)), Node(id: \"b\", at: (0, 4)), Node(id: \"c\", at: (0, 0))],
              materials: [], bodies: [{body}], supports: [(node: \"a\", fix: [x, y]), (node: \"b\", fix: [x, y])],
              loads: [Force(node: \"c\", x: 0.3, y: -0.2)], history: (path: [0, 1], increment: 1),
              monitors: [(name: \"x\", of: Displacement(node: \"c\", component: x)),
                         (name: \"y\", of: Displacement(node: \"c\", component: y))])"
        )));
        [last(&run, "x"), last(&run, "y")]
    };
    let free = with(
        "Springs(id: \"s\", bars: [(nodes: [\"a\", \"c\"], stiffness: 4), (nodes: [\"c\", \"b\"], stiffness: 3)])",
    );
    let fixed = with(
        "Springs(id: \"s\", bars: [(nodes: [\"a\", \"c\"], angle: 0, stiffness: 4), (nodes: [\"c\", \"b\"], angle: 90, stiffness: 3)])",
    );
    let bars = with(
        "Truss(id: \"s\", bars: [(\"a\", \"c\")], EA: 12, small: true), Truss(id: \"r\", bars: [(\"b\", \"c\")], EA: 12, small: true)",
    );
    for k in 0..2 {
        assert!((free[k] - fixed[k]).abs() < 1e-14 && (free[k] - bars[k]).abs() < 1e-14);
    }
    assert!((free[0] - 0.075).abs() < 1e-14);
}

#[test]
fn small_displacements_are_proportional_to_their_load_until_an_element_is_inverted() {
    let tip = |load: f64| {
        let run = finished(&read(&format!(
            "(title: \"t\", nodes: [Block(id: \"k\", corners: [(0, 0), (10, 1)], elements: (8, 1))],
              materials: [Elastic(id: \"m\", E: 1000, nu: 0.3, update: small)], bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")],
              supports: [(node: \"k.left\", fix: [x, y])], loads: [Pressure(along: \"k.top\", value: {load})],
              history: (path: [0, 1], increment: 0.5),
              monitors: [(name: \"y\", of: Displacement(node: \"k.right.end\", component: y))])"
        )));
        assert!(run.accepted.iter().all(|a| a.majors <= 2));
        last(&run, "y")
    };
    let (one, many) = (tip(1e-3), tip(4.0));
    assert!((many / one / 4e3 - 1.0).abs() < 1e-9, "{one} {many}");
}

/// Two blocks pressed on each other by a uniform pressure: how far the stress across is from uniform, as a part of it, in the
/// lower block and in the upper one.
fn pressed(low: (usize, ElementKind), up: (usize, ElementKind)) -> [f64; 2] {
    let run = finished(&read(&format!(
        "(title: \"t\", nodes: [
            Block(id: \"low\", corners: [(0, 0), (6, 2)], elements: ({}, 2), element: {}),
            Block(id: \"up\", corners: [(0, 2), (6, 4)], elements: ({}, 2), element: {})],
          materials: [Elastic(id: \"m\", E: 1000, nu: 0, update: small)],
          bodies: [Solid(id: \"low\", mesh: \"low\", material: \"m\"), Solid(id: \"up\", mesh: \"up\", material: \"m\")],
          surfaces: [(id: \"s\", along: \"low.top\")], slaves: [(nodes: [\"up.bottom\"], on: [\"s\"], start: sliding)],
          supports: [(node: \"low.bottom\", fix: [y]), (node: \"low.left\", fix: [x]), (node: \"low.right\", fix: [x]),
                     (node: \"up.left\", fix: [x]), (node: \"up.right\", fix: [x])],
          loads: [Pressure(along: \"up.top\", value: 1)], history: (path: [0, 1], increment: 1))",
        low.0,
        low.1.word(),
        up.0,
        up.1.word()
    )));
    let all = stresses(&run);
    let off = |body: usize| {
        let worst = |most: f64, s: &Option<[f64; 4]>| most.max((s.unwrap()[1] + 1.0).abs());
        all[body].iter().fold(0.0, worst)
    };
    [off(0), off(1)]
}

#[test]
fn a_uniform_pressure_goes_through_matching_meshes_exactly_and_through_others_with_a_known_error() {
    for kind in ElementKind::ALL {
        let [low, up] = pressed((6, kind), (6, kind));
        assert!(low < 1e-8 && up < 1e-8, "{kind:?}: {low:e} {up:e}");
    }
    for (name, [low, up]) in contact_rows() {
        // A quad8 slave's forces, 1/6, 4/6, 1/6 a side, are halves on the nodes of a quad4 master of the same side.
        let exact = name == "6 quad4 under 6 quad8";
        let off = low.max(up);
        assert!(
            if exact {
                off < 1e-8
            } else {
                (1e-3..0.25).contains(&off)
            },
            "{name}: {low} {up}"
        );
    }
}

/// The message that a scene is refused with.
fn refused(text: &str) -> String {
    Scene::from_text("test.ron", text, &[])
        .expect_err("it is refused")
        .to_string()
}

#[test]
fn what_cannot_be_axisymmetric_or_under_pressure_is_refused_where_it_stands() {
    let with = |material: &str, corner: &str, other: &str, more: &str| {
        format!(
            "(title: \"t\", nodes: [Block(id: \"k\", corners: [{corner}, (1, 1)], elements: (1, 1)),
                Block(id: \"j\", corners: [(5, 0), (6, 1)], elements: (1, 1)), Chain(id: \"d\", of: [\"k.1\", \"k.8\"], per_element: 2)],
              materials: [Elastic(id: \"m\", E: 1, nu: 0, {material}), Elastic(id: \"n\", E: 1, nu: 0)],
              bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\"), Solid(id: \"j\", mesh: \"j\", material: \"{other}\"),
                Springs(id: \"s\", bars: [(nodes: [\"k.1\", \"j.1\"], stiffness: 1)])],
              history: (path: [0, 1], increment: 1), loads: [{more}])"
        )
    };
    let (round, at) = ("plane: axisymmetric", "(0, 0)");
    let cases = [
        (with(round, at, "n", ""), "as a whole or not at all"),
        (with(round, "(-1, 0)", "m", ""), "x is the radius"),
        (
            with("plane: axisymmetric, thickness: 2", at, "n", ""),
            "has no thickness",
        ),
        (
            with("law: neohookean, update: small", at, "n", ""),
            "linear elasticity",
        ),
        (
            with(round, at, "m", "Pressure(along: \"d\", value: 1)"),
            "not an outer face of a solid",
        ),
        (
            with(round, at, "m", "Volume(on: \"l\", y: 1)"),
            "no solid called \"l\"",
        ),
        (
            with(round, at, "m", "Volume(on: \"s\", y: 1)"),
            "is not a solid",
        ),
    ];
    for (text, expected) in cases {
        let message = refused(&text);
        assert!(message.contains(expected), "{message}");
        assert!(message.contains("test.ron:"), "line and column: {message}");
    }
}

#[test]
fn check_lists_nodes_on_the_axis_that_may_leave_it() {
    let cost = |plane: &str, supports: &str| {
        let text = format!(
            "(title: \"t\", nodes: [Block(id: \"k\", corners: [(0, 0), (1, 1)], elements: (1, 1))],
              materials: [Elastic(id: \"m\", E: 1, nu: 0, plane: {plane})], bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")],
              supports: [{supports}], history: (path: [0, 1], increment: 1))"
        );
        let cost = stickslip::scene::cost::Cost::from_scene(&read(&text));
        cost.to_string()
            .lines()
            .filter(|line| line.starts_with("axis"))
            .collect::<String>()
    };
    let all = cost("axisymmetric", "");
    assert!(
        all.contains("3 nodes at x = 0") && all.contains("\"k.1\", \"k.4\", \"k.6\";"),
        "{all}"
    );
    let one = cost(
        "axisymmetric",
        "(node: \"k.left.start\", fix: [x]), (node: \"k.4\", fix: [x, y])",
    );
    assert!(
        one.contains("1 node at x = 0 may move off the axis: \"k.1\";"),
        "{one}"
    );
    assert_eq!(cost("axisymmetric", "(node: \"k.left.all\", fix: [x])"), "");
    assert_eq!(cost("strain", ""), "");
}

#[test]
fn whole_sets_of_nodes_of_every_kind_are_moved_as_is_prescribed() {
    // A block is sheared by its bottom and top, moved as a whole, and stretched by sets of a mesh that is given.
    let material = "materials: [Elastic(id: \"m\", E: 100, nu: 0.3, update: small)], bodies: [Solid(id: \"k\", mesh: \"MESH\", material: \"m\")]";
    for kind in ElementKind::ALL {
        let block = read(&format!(
            "(title: \"t\", nodes: [Block(id: \"k\", corners: [(0, 0), (2, 1)], elements: (2, 2), element: {})], {},
              history: (path: [0, 1], increment: 0.5))",
            kind.word(),
            material.replace("MESH", "k")
        ));
        let given = given(&block);
        let moved = |scene: &Scene, sets: [&str; 2], values: [f64; 2]| {
            let mut spec = scene.spec.clone();
            for (set, value) in sets.into_iter().zip(values) {
                for (component, value) in [(Component::X, value), (Component::Y, -0.5 * value)] {
                    spec.loads.push(LoadSpec::Displacement {
                        node: set.into(),
                        component,
                        value,
                        scale: Vec::new(),
                    });
                }
            }
            let scene = Scene::from_spec("moved", spec).unwrap_or_else(|e| panic!("{kind:?}: {e}"));
            let state = finished(&scene).stepper.state().clone();
            let first = &scene.model.dofs.first;
            for (set, value) in sets.into_iter().zip(values) {
                for node in scene.names().nodes(set).unwrap() {
                    let u = &state.u[first[node]..first[node] + 2];
                    assert_eq!(u, [value, -0.5 * value], "{kind:?} {set}");
                }
            }
            state.u.to_vec()
        };
        let by_edges = moved(&block, ["k.bottom.all", "k.top.all"], [0.0, 0.01]);
        let by_sets = moved(&given, ["g.low", "g.high"], [0.0, 0.01]);
        let far = by_edges.iter().zip(&by_sets).map(|(a, b)| (a - b).abs());
        assert!(far.fold(0.0, f64::max) < 1e-15, "{kind:?}");
        let mut whole = block.spec.clone();
        whole.loads.push(LoadSpec::Displacement {
            node: "k.all".into(),
            component: Component::X,
            value: 0.25,
            scale: Vec::new(),
        });
        whole.loads.push(LoadSpec::Displacement {
            node: "k.all".into(),
            component: Component::Y,
            value: -0.5,
            scale: Vec::new(),
        });
        let run = finished(&Scene::from_spec("whole", whole).unwrap());
        for u in run.stepper.state().u.chunks(2) {
            assert_eq!(u, [0.25, -0.5], "{kind:?}");
        }
    }
}

/// The same block as a mesh that is given, with its bottom and top as sets.
fn given(block: &Scene) -> Scene {
    let mut text = "(title: \"t\", nodes: [Given(id: \"g\", nodes: [".to_owned();
    for (k, node) in block.model.nodes.iter().enumerate() {
        write!(text, "({}, {:?}, {:?}), ", k + 1, node.at[0], node.at[1]).unwrap();
    }
    let stickslip::model::BodyKind::Solid(solid) = &block.model.bodies[0].kind else {
        panic!("no solid");
    };
    let labels = |nodes: &[usize]| nodes.iter().map(|n| n + 1).collect::<Vec<_>>();
    let elements: Vec<Vec<usize>> = solid.elements.iter().map(|e| labels(&e.nodes)).collect();
    let set = |name: &str| labels(&block.names().nodes(name).unwrap());
    write!(
        text,
        "], elements: [(part: \"part\", kind: {}, nodes: {elements:?})],
          sets: [(name: \"low\", nodes: {:?}), (name: \"high\", nodes: {:?})])],
          materials: [Elastic(id: \"m\", E: 100, nu: 0.3, update: small)], bodies: [Solid(id: \"k\", mesh: \"g.part\", material: \"m\")],
          history: (path: [0, 1], increment: 0.5))",
        solid.elements[0].kind.word(),
        set("k.bottom.all"),
        set("k.top.all")
    )
    .unwrap();
    read(&text)
}

/// Rows of the table of contact patches: kinds and elements of the lower block (master) and of the upper one (slave), and how far
/// the stress is from uniform.
fn contact_rows() -> Vec<(String, [f64; 2])> {
    use ElementKind::{Quad4, Quad8, Quad9, Triangle6};
    let cases = [
        ((6, Quad4), (5, Quad4)),
        ((6, Quad4), (13, Quad4)),
        ((6, Quad8), (5, Quad8)),
        ((6, Quad8), (13, Quad8)),
        ((6, Quad8), (6, Quad4)),
        ((6, Quad4), (6, Quad8)),
        ((6, Quad9), (5, Triangle6)),
    ];
    let row = |(low, up): ((usize, ElementKind), (usize, ElementKind))| {
        let name = format!("{} {} under {} {}", low.0, low.1.word(), up.0, up.1.word());
        (name, pressed(low, up))
    };
    cases.into_iter().map(row).collect()
}

/// Tip of a cantilever of length 10 and depth 1 under a shear force at its end, over that of 60 x 6 elements quad9.
fn cantilever(kind: ElementKind, elements: &str, nu: f64) -> f64 {
    let run = finished(&read(&format!(
        "(title: \"t\", nodes: [Block(id: \"k\", corners: [(0, 0), (10, 1)], elements: {elements}, element: {})],
          materials: [Elastic(id: \"m\", E: 1000, nu: {nu}, update: small)], bodies: [Solid(id: \"k\", mesh: \"k\", material: \"m\")],
          supports: [(node: \"k.left\", fix: [x, y])], loads: [Traction(along: \"k.right\", y: 0.01)],
          history: (path: [0, 1], increment: 1),
          monitors: [(name: \"y\", of: Displacement(node: \"k.right@0.5\", component: y))])",
        kind.word()
    )));
    last(&run, "y")
}

/// The tables of the manual's page `verification`, as it has them.
fn tables() -> String {
    let mut text = String::from(
        "| kind | tip, 10 x 2, nu 0.3 | 20 x 4 | tip, 10 x 2, nu 0.499 | 20 x 4 | tube, 4 cells | 8 | order | hoop stress, 8 |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    let fine = [0.3, 0.499].map(|nu| cantilever(ElementKind::Quad9, "(60, 6)", nu));
    for kind in ElementKind::ALL {
        write!(text, "| {} ", kind.word()).unwrap();
        for (nu, fine) in [0.3, 0.499].into_iter().zip(fine) {
            for elements in ["(10, 2)", "(20, 4)"] {
                let part = cantilever(kind, elements, nu) / fine;
                write!(text, "| {part:.3} ").unwrap();
            }
        }
        let (a, b, p) = (1.0_f64, 2.0_f64, 10.0);
        let share = p * a * a / (b * b - a * a);
        let expected = 1.3 / 1000.0 * share * (0.4 * a + b * b / a);
        let runs = [4, 8].map(|cells| tube(kind, cells, "update: small"));
        let [coarse, better] = [0, 1].map(|k| (last(&runs[k], "u") / expected - 1.0).abs());
        let hoop = stresses(&runs[1])[0][0].unwrap()[2] / (p * 5.0 / 3.0) - 1.0;
        if better < 1e-10 {
            write!(text, "| round-off | round-off | ").unwrap();
        } else {
            write!(
                text,
                "| {coarse:.0e} | {better:.0e} | {:.1} ",
                order(coarse, better, 2.0)
            )
            .unwrap();
        }
        writeln!(text, "| {:.1} % |", 100.0 * hoop.abs()).unwrap();
    }
    text += "\n| blocks | in the lower block | in the upper block |\n|---|---|---|\n";
    for (name, [low, up]) in contact_rows() {
        writeln!(
            text,
            "| {name} | {:.1} % | {:.1} % |",
            100.0 * low,
            100.0 * up
        )
        .unwrap();
    }
    text
}

#[test]
fn the_page_on_verification_has_the_tables_of_elements_as_they_are_measured() {
    let path = format!(
        "{}/src/manual/pages/verification.md",
        env!("CARGO_MANIFEST_DIR")
    );
    let page = std::fs::read_to_string(path).unwrap();
    let tables = tables();
    for line in tables.lines() {
        assert!(
            page.contains(line),
            "the page lacks {line:?}; its tables are\n{tables}"
        );
    }
}
