//! Scene files: the built-in ones are sound, damaged ones get one message with a place, and nothing panics.

use proptest::prelude::*;
use std::collections::HashSet;
use stickslip::contact::projection::{footing, project};
use stickslip::model::Model;
use stickslip::model::{BodyKind, Watched};
use stickslip::model::{BoundUpdate, Component};
use stickslip::scene::cost::Cost;
use stickslip::scene::{Scene, SceneError, Spec, builtin, paths, read};

const PINNED: &str = "01-pinned-beam-rough-floor";

fn pinned() -> &'static str {
    builtin::find(PINNED).map(|scene| scene.text).unwrap()
}

/// The pinned beam with a piece of its file replaced.
/// The pinned beam with a piece replaced; without its settings, so that they can be given.
fn changed(from: &str, to: &str) -> Result<Scene, SceneError> {
    let (start, rest) = pinned().split_once("    // The last increment").unwrap();
    let (_, end) = rest.split_once("settings: (at_cycle: damp),\n").unwrap();
    let text = format!("{start}{end}");
    assert!(text.contains(from), "the scene has no {from:?}");
    Scene::from_text("x.ron", &text.replacen(from, to, 1), &[])
}

fn with(path: &str, value: &str) -> Result<Scene, SceneError> {
    Scene::open(PINNED, &[(path.to_owned(), value.to_owned())])
}

/// A small scene: nodes, then whatever else; one cantilever unless `bodies` is among it.
fn small(nodes: &str, rest: &str) -> Result<Scene, SceneError> {
    let bodies = if rest.contains("bodies:") {
        ""
    } else {
        "bodies: [Beam(id: \"b\", along: \"b\", material: \"m\")],"
    };
    let text = format!(
        "(title: \"t\", nodes: [{nodes}], materials: [Section(id: \"m\", EA: 1, EI: 1)], {bodies} \
         history: (path: [0, 1], increment: 0.5), {rest})"
    );
    Scene::from_text("small", &text, &[])
}

const LINE: &str = "Line(id: \"b\", from: (0, 0), to: (4, 0), elements: 2, per_element: 3)";

#[test]
fn every_builtin_scene_is_sound_and_has_a_title() {
    for builtin in builtin::list() {
        let scene = Scene::open(builtin.name, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(!scene.model.title.is_empty());
        assert_eq!(builtin.title(), scene.model.title);
        assert!(
            scene.text.starts_with("// "),
            "{} opens with a drawing",
            builtin.name
        );
        let monitors: Vec<&str> = scene
            .model
            .monitors
            .iter()
            .map(|m| m.name.as_str())
            .collect();
        let all = ["u_x", "u_y", "rotation", "contact_x", "contact_y"];
        // Where a whole surface is moved, there is no loaded node to watch; nodes on springs and solids do not turn. A scene
        // may watch several nodes.
        let on_no_beam = scene.spec.materials.is_empty() || builtin.name.starts_with("osc-block");
        let wanted: Vec<&str> = match builtin.name {
            name if name.starts_with("hertz") => all[3..].to_vec(),
            _ if on_no_beam => [&all[..2], &all[3..]].concat(),
            _ => all.to_vec(),
        };
        assert!(
            wanted.iter().all(|name| monitors.contains(name)),
            "{}: {monitors:?}",
            builtin.name
        );
    }
}

#[test]
fn every_file_in_problems_is_built_in() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/problems");
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        if entry.path().is_dir() {
            continue;
        }
        let name = entry.file_name().into_string().unwrap();
        assert!(
            builtin::find(&name).is_some(),
            "{name} is not in the table of built-in scenes"
        );
    }
}

#[test]
fn a_file_is_found_by_its_path_and_wins_over_a_built_in_scene() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("x.ron");
    std::fs::write(&file, pinned().replacen("EA: 100.0", "EA: 7.0", 1)).unwrap();
    let scene = Scene::open(file.to_str().unwrap(), &[]).unwrap();
    let BodyKind::Beam(beam) = &scene.model.bodies[0].kind else {
        panic!("no beam")
    };
    assert_eq!(beam.ea, 7.0);
    assert_eq!(scene.name, file.to_str().unwrap());
}

#[test]
fn the_pinned_beam_is_numbered_node_by_node_with_shear_last() {
    let model = Scene::open(PINNED, &[]).unwrap().model;
    assert_eq!(model.nodes.len(), 10);
    assert_eq!(model.nodes[4].name, "beam.5");
    assert_eq!(&model.dofs.count[..], [3, 3, 3, 3, 3, 2, 2, 2, 2, 2]);
    // The pin holds x and y; then come its rotation, four nodes, the floor without unknowns, four shear forces.
    assert_eq!(&model.dofs.equation[..4], [None, None, Some(0), Some(1)]);
    assert_eq!(model.dofs.equation[14], Some(12));
    assert!(model.dofs.equation[15..25].iter().all(Option::is_none));
    assert_eq!(
        &model.dofs.equation[25..],
        [Some(13), Some(14), Some(15), Some(16)]
    );
    assert_eq!((model.dofs.equations, model.dofs.inner), (17, 4));
    let BodyKind::Beam(beam) = &model.bodies[0].kind else {
        panic!("no beam")
    };
    assert_eq!(beam.first_shear, Some(25));
    assert!(model.surfaces[0].rigid);
    assert!((model.length - 4.0).abs() < 1e-14);
    assert_eq!(model.loads.len(), 1);
    assert_eq!((model.loads[0].dof, model.loads[0].value), (12, -1.0));
}

#[test]
fn shear_stiffness_replaces_the_shear_unknowns() {
    let model = with("materials.rod.GA", "5").unwrap().model;
    let BodyKind::Beam(beam) = &model.bodies[0].kind else {
        panic!("no beam")
    };
    assert_eq!((beam.ga, beam.first_shear), (Some(5.0), None));
    assert_eq!(
        (model.dofs.equations, model.dofs.inner, model.dofs.len()),
        (13, 0, 25)
    );
}

#[test]
fn refinement_keeps_the_names_of_places() {
    let coarse = Scene::open(PINNED, &[]).unwrap();
    let fine = with("refine", "3").unwrap();
    assert_eq!(fine.model.bodies[0].nodes.len(), 13);
    for name in [
        "beam.start",
        "beam.end",
        "beam@0.25",
        "beam@0.5",
        "floor.end",
    ] {
        let (a, b) = (coarse.node(name).unwrap(), fine.node(name).unwrap());
        let (a, b) = (coarse.model.nodes[a].at, fine.model.nodes[b].at);
        assert!(
            (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-15,
            "{name}: {a:?} {b:?}"
        );
    }
}

#[test]
fn nodes_have_the_names_that_the_format_promises() {
    let scene = small(&format!("{LINE}, Node(id: \"p\", at: (4, 1))"), SLAVE_P).unwrap();
    let node = |name: &str| scene.node(name);
    assert_eq!(node("b.1"), Ok(0));
    assert_eq!(node("b.start"), Ok(0));
    assert_eq!(node("b.end"), Ok(4));
    assert_eq!(node("b@0.75"), Ok(3));
    assert_eq!(node("p"), Ok(5));
    assert_eq!(scene.names().nodes("b.all"), Ok(vec![0, 1, 2, 3, 4]));
    for wrong in [
        "b", "b.all", "b.0", "b.6", "b.", "b@", "b@0.3", "b@2", "b@NaN", "p.1", "p@0", "q", "",
        ".", "@",
    ] {
        assert!(node(wrong).is_err(), "{wrong:?} names a node");
    }
}

const SLAVE_P: &str =
    "surfaces: [(id: \"s\", along: \"b\")], slaves: [(nodes: [\"p\"], on: [\"s\"])]";

/// A block of two by one elements, made a solid, and what else the scene has.
fn solid(block: &str, material: &str, body: &str, rest: &str) -> Result<Scene, SceneError> {
    let text = format!(
        "(title: \"t\", nodes: [Block(id: \"k\", {block})], materials: [Elastic(id: \"e\", {material}), \
         Section(id: \"s\", EA: 1, EI: 1)], bodies: [{body}], history: (path: [0, 1], increment: 0.5), {rest})"
    );
    Scene::from_text("solid", &text, &[])
}

const BLOCK: &str = "corners: [(0, 0), (4, 2)], elements: (2, 1)";
const ELASTIC: &str = "E: 100, nu: 0.3";
const SOLID: &str = "Solid(id: \"k\", mesh: \"k\", material: \"e\")";

#[test]
fn a_block_and_its_edges_have_the_names_that_the_format_promises() {
    let scene = solid(BLOCK, ELASTIC, SOLID, "").unwrap();
    let node = |name: &str| scene.node(name);
    let at = |name: &str| scene.model.nodes[scene.node(name).unwrap()].at;
    assert_eq!(scene.model.nodes.len(), 13);
    assert_eq!(scene.model.nodes[12].name, "k.13");
    assert_eq!(
        (at("k.1"), at("k.6"), at("k.13")),
        ([0.0, 0.0], [0.0, 1.0], [4.0, 2.0])
    );
    assert_eq!(
        (at("k.bottom.start"), at("k.bottom.end")),
        ([0.0, 0.0], [4.0, 0.0])
    );
    assert_eq!(
        (at("k.left.start"), at("k.left.end")),
        ([0.0, 2.0], [0.0, 0.0])
    );
    assert_eq!((at("k.top.2"), at("k.right@0.5")), ([3.0, 2.0], [4.0, 1.0]));
    let names = scene.names();
    assert_eq!(names.nodes("k.left"), Ok(vec![8, 5, 0]));
    assert_eq!(names.nodes("k.left.all"), names.nodes("k.left"));
    assert_eq!(names.nodes("k.all"), Ok((0..13).collect()));
    for wrong in [
        "k",
        "k.all",
        "k.left",
        "k.left.all",
        "k.start",
        "k@0.5",
        "k.14",
        "k.0",
        "k.left.4",
        "k.left.",
        "k.middle",
        "k.left.left",
        "k.1.left",
        "k.left@0.3",
        "k..left",
    ] {
        assert!(node(wrong).is_err(), "{wrong:?} names a node");
    }
    assert!(scene.model.dofs.count.iter().all(|&count| count == 2));
    let fine = scene.with("refine", "3").unwrap();
    assert_eq!(
        fine.model.nodes[fine.node("k.top@0.5").unwrap()].at,
        [2.0, 2.0]
    );
    let BodyKind::Solid(body) = &fine.model.bodies[0].kind else {
        panic!("no solid")
    };
    assert_eq!((body.elements.len(), body.edges.len()), (18, 18));
    assert_eq!(
        fine.with("nodes.k.elements.x", "1").unwrap().model.bodies[0]
            .nodes
            .len(),
        40
    );
}

#[test]
fn each_fault_of_a_solid_has_one_message_with_its_place() {
    let elastic = |material: &str| solid(BLOCK, material, SOLID, "");
    let shaped = |block: &str| solid(block, ELASTIC, SOLID, "");
    let made = |body: &str| solid(BLOCK, ELASTIC, body, "");
    let more = |rest: &str| solid(BLOCK, ELASTIC, SOLID, rest);
    let cases = [
        (
            shaped("corners: [(0, 0)], elements: (1, 1)"),
            "nodes[0].corners: the list has 1 corners",
        ),
        (
            shaped("corners: [(4, 2), (0, 3)], elements: (1, 1)"),
            "folded or flat at its corner",
        ),
        (
            shaped("corners: [(0, 0), (0, 2), (4, 2), (4, 0)], elements: (1, 1)"),
            "corners run anticlockwise",
        ),
        (
            shaped("corners: [(0, 0), (4, NaN)], elements: (1, 1)"),
            "nodes[0].corners[1][1]: y is NaN",
        ),
        (
            shaped("corners: [(0, 0), (4, 2)], elements: (0, 1)"),
            "nodes[0].elements[0]: the number of elements is 0",
        ),
        (
            shaped("corners: [(0, 0), (4, 2)], elements: (9000, 9000)"),
            "at most 50000000 can be had",
        ),
        (
            shaped("corners: [(0, 0), (4, 2)], elements: 3"),
            "nodes[0].elements",
        ),
        (
            elastic("E: 0, nu: 0.3"),
            "solid:1:116: materials[0].E: E is 0.0",
        ),
        (
            elastic("E: 1, nu: 0.5"),
            "materials[0].nu: nu is 0.5; it must be at least 0 and below 0.5",
        ),
        (elastic("E: 1, nu: -0.1"), "materials[0].nu: nu is -0.1"),
        (elastic("E: 1, nu: NaN"), "materials[0].nu: nu is NaN"),
        (
            elastic("E: 1, nu: 0, thickness: 0"),
            "materials[0].thickness: the thickness is 0.0",
        ),
        (
            elastic("E: 1, nu: 0, law: hooke"),
            "\"hooke\" is none of the choices",
        ),
        (
            elastic("E: 1, nu: 0, law: neohookean, update: updated"),
            "materials[0].update: the updated update has a law",
        ),
        (
            made("Solid(id: \"k\", mesh: \"q\", material: \"e\")"),
            "bodies[0].mesh: no block called \"q\" (blocks: \"k\")",
        ),
        (
            made("Solid(id: \"k\", mesh: \"k.left\", material: \"e\")"),
            "is no block; a solid needs",
        ),
        (
            made("Solid(id: \"k\", mesh: \"k\", material: \"s\")"),
            "material \"s\" is a beam's section",
        ),
        (
            made("Beam(id: \"k\", along: \"k.left\", material: \"e\")"),
            "material \"e\" is a continuum's",
        ),
        (
            made("Beam(id: \"k\", along: \"k\", material: \"s\")"),
            "is a block; name one of its edges, \"k.bottom\"",
        ),
        (
            made("Beam(id: \"k\", along: \"k.left\", material: \"s\")"),
            "node \"k.2\" is used by no body",
        ),
        (
            made(
                "Solid(id: \"k\", mesh: \"k\", material: \"e\", regions: [(from: (4, 2), to: (0, 0), material: \"e\")])",
            ),
            "bodies[0].regions[0]: no element has its middle in the region",
        ),
        (
            made(
                "Solid(id: \"k\", mesh: \"k\", material: \"e\", regions: [(from: (0, 0), to: (4, 2), material: \"f\")])",
            ),
            "bodies[0].regions[0].material: no material called \"f\"",
        ),
        (
            more("supports: [(node: \"k.left\", fix: [rotation])]"),
            "is on no beam and has no rotation",
        ),
        (
            more("loads: [Force(node: \"k.left\", x: 1)]"),
            "\"k.left\" is an edge of 3 nodes; name one of them",
        ),
        (
            more("loads: [Force(node: \"k\", x: 1)]"),
            "\"k\" is a block of 13 nodes; name one of them",
        ),
        (
            more("loads: [Traction(along: \"k.lft\", x: 1)]"),
            "loads[0].along: no chain of nodes called \"k.lft\"; did you mean \"k.left\"?",
        ),
        (
            more("loads: [Traction(along: \"k.left\", normal: inf)]"),
            "loads[0].normal: the load is inf",
        ),
        (
            more(
                "supports: [(node: \"k.left\", fix: [x])], loads: [Traction(along: \"k.left\", normal: 1)]",
            ),
            "every node of \"k.left\" is held where this load acts",
        ),
        (
            more(
                "surfaces: [(id: \"s\", along: \"k.left\")], slaves: [(nodes: [\"k.bottom\"], on: [\"s\"])]",
            ),
            "a node cannot touch itself",
        ),
    ];
    for (k, (result, expected)) in cases.into_iter().enumerate() {
        let error = match result {
            Ok(_) => panic!("case {k} is accepted: {expected}"),
            Err(error) => error.to_string(),
        };
        assert!(
            error.contains(expected),
            "case {k}\n got: {error}\nwant: {expected}"
        );
    }
}

#[test]
fn tractions_add_up_to_load_times_length() {
    let line = "nodes: [Line(id: \"b\", from: (0, 0), to: (3, 4), elements: 2, per_element: 4)],";
    let beam = format!(
        "(title: \"t\", {line} materials: [Section(id: \"m\", EA: 1, EI: 1)], \
         bodies: [Beam(id: \"b\", along: \"b\", material: \"m\")], history: (path: [0, 1], increment: 1), \
         loads: [Traction(along: \"b\", normal: 2, y: 1)])"
    );
    let model = Scene::from_text("beam", &beam, &[]).unwrap().model;
    let sum = |axis: usize| -> f64 {
        let of_axis = model.loads.iter().filter(|l| l.dof % 3 == axis);
        of_axis.map(|l| l.value).sum()
    };
    // The outward normal, to the right of the walk, is (4, -3)/5.
    assert!((sum(0) - 8.0).abs() < 1e-13 && (sum(1) - (-6.0 + 5.0)).abs() < 1e-13);
    let rest = "loads: [Traction(along: \"k.top\", normal: -3)]";
    let model = solid(BLOCK, ELASTIC, SOLID, rest).unwrap().model;
    let forces: Vec<f64> = model.loads.iter().map(|l| l.value).collect();
    // Simpson's rule over two elements of length 2.
    for (force, expected) in forces.iter().zip([-1.0, -4.0, -2.0, -4.0, -1.0]) {
        assert!((force - expected).abs() < 1e-13, "{forces:?}");
    }
}

#[test]
fn a_region_gives_its_elements_another_material() {
    let body = "Solid(id: \"k\", mesh: \"k\", material: \"e\", regions: [(from: (2, 0), to: (4, 2), material: \"e\")])";
    let scene = solid(BLOCK, ELASTIC, body, "refine: 2").unwrap();
    let BodyKind::Solid(made) = &scene.model.bodies[0].kind else {
        panic!("no solid")
    };
    assert_eq!(made.material_of, [0, 0, 1, 1, 0, 0, 1, 1]);
    let text = Cost::of(&scene).to_string();
    for line in [
        "k: solid, 8 elements of 8 nodes, E 100, nu 0.3, St Venant-Kirchhoff, plane strain, thickness 1",
        "no memory of earlier increments in k: update is total",
    ] {
        assert!(text.contains(line), "{text}");
    }
}

#[test]
fn an_arc_is_exact_at_right_angles() {
    let arc =
        "Arc(id: \"b\", center: (1, 2), radius: 2, from: 180, to: 0, elements: 2, per_element: 3)";
    let model = small(arc, "").unwrap().model;
    let at: Vec<[f64; 2]> = model.nodes.iter().map(|node| node.at).collect();
    assert_eq!((at[0], at[2], at[4]), ([-1.0, 2.0], [1.0, 4.0], [3.0, 2.0]));
    for [x, y] in at {
        assert!(((x - 1.0).hypot(y - 2.0) - 2.0).abs() < 1e-15);
    }
}

#[test]
fn refined_curves_lie_on_the_curve_through_their_points() {
    let through = "Through(id: \"b\", points: [(0, 0), (1, 1), (2, 4)], per_element: 3)";
    let text = format!("refine: 4, {}", "supports: []");
    let model = small(through, &text).unwrap().model;
    assert_eq!(model.nodes.len(), 9);
    for node in &model.nodes {
        assert!(
            (node.at[1] - node.at[0] * node.at[0]).abs() < 1e-15,
            "{:?}",
            node.at
        );
    }
    assert_eq!(model.nodes[4].at, [1.0, 1.0]);
}

#[test]
fn a_chain_shares_the_nodes_that_it_runs_over() {
    let nodes = format!(
        "{LINE}, Line(id: \"up\", from: (4, 1), to: (4, 2), elements: 1, per_element: 2), \
         Chain(id: \"frame\", of: [\"b.end\", \"up.all\"], per_element: 2)"
    );
    let bodies = "bodies: [Beam(id: \"b\", along: \"b\", material: \"m\"), \
                  Beam(id: \"post\", along: \"frame\", material: \"m\")]";
    let scene = small(&nodes, bodies).unwrap();
    assert_eq!(scene.model.bodies[1].nodes, [4, 5, 6]);
    assert_eq!(scene.node("frame.start"), scene.node("b.end"));
    assert_eq!(scene.model.nodes[4].name, "b.5");
}

#[test]
fn a_reversed_surface_is_walked_the_other_way() {
    let forward = Scene::open(PINNED, &[("nodes.floor.elements".into(), "2".into())])
        .unwrap()
        .model;
    let set = [
        ("nodes.floor.elements", "2"),
        ("surfaces.floor.reverse", "true"),
    ];
    let set = set.map(|(path, value)| (path.to_owned(), value.to_owned()));
    let backward = Scene::open(PINNED, &set).unwrap().model;
    let mut walk: Vec<Vec<usize>> = forward.surfaces[0].elements.clone();
    walk.reverse();
    walk.iter_mut().for_each(|element| element.reverse());
    assert_eq!(backward.surfaces[0].elements, walk);
}

#[test]
fn built_in_slaves_start_on_the_outward_side() {
    for builtin in builtin::list() {
        let model = Scene::open(builtin.name, &[]).unwrap().model;
        let positions: Vec<[f64; 2]> = model.nodes.iter().map(|n| n.at).collect();
        let mut over = 0;
        for slave in &model.contacts {
            let at = positions[slave.node];
            // A node that stands past the ends of its surfaces has no side yet.
            let Some(spot) = project(at, &model.surfaces, &slave.surfaces, &positions, None) else {
                continue;
            };
            over += 1;
            let gap = footing(&model.surfaces, spot, &positions, at).gap;
            assert!(gap > -1e-12 * model.length, "{}: {gap}", builtin.name);
        }
        assert!(over > 0, "{}", builtin.name);
    }
}

#[test]
fn prescribed_zero_is_a_support_and_other_values_are_kept() {
    let loads = "loads: [Displacement(node: \"b.start\", component: x, value: 0), \
                 Displacement(node: \"b.end\", component: rotation, value: 2, scale: [(0, 1), (1, 3)])]";
    let model = small(LINE, loads).unwrap().model;
    assert_eq!(model.dofs.equation[0], None);
    assert_eq!(model.dofs.equation[14], None);
    assert_eq!(model.prescribed.len(), 1);
    assert_eq!(
        (model.prescribed[0].dof, model.prescribed[0].scale.at(0.5)),
        (14, 2.0)
    );
}

#[test]
fn a_rigid_surface_can_be_moved_and_stays_rigid() {
    let nodes = format!(
        "{LINE}, Line(id: \"f\", from: (5, -1), to: (-1, -1), elements: 1, per_element: 2)"
    );
    let rest = "surfaces: [(id: \"f\", along: \"f\")], slaves: [(nodes: [\"b.end\"], on: [\"f\"])], \
                loads: [Displacement(node: \"f.all\", component: y, value: 1)]";
    let model = small(&nodes, rest).unwrap().model;
    assert!(model.surfaces[0].rigid);
    assert_eq!(model.prescribed.len(), 2);
}

#[test]
fn monitors_watch_what_they_say() {
    let rest = "supports: [(node: \"b.start\", fix: [x, y, rotation])], monitors: [\
                (name: \"r\", of: Reaction(node: \"b.start\", component: rotation)), \
                (name: \"u\", of: Displacement(node: \"b@0.5\", component: y))]";
    let model = small(LINE, rest).unwrap().model;
    assert_eq!(model.monitors[0].of, Watched::Reaction { dof: 2 });
    assert_eq!(model.monitors[1].of, Watched::Displacement { dof: 7 });
}

/// What is wrong with the pinned beam's file when a piece is replaced: place and a part of the message.
#[test]
fn each_fault_has_one_message_with_its_place() {
    let cases: &[(&str, &str, &str)] = &[
        // Syntax and types.
        (
            "increment: 0.01),",
            "increment: 0.01",
            ":42:5: history: expected comma",
        ),
        (
            "EA: 100.0",
            "EA: \"x\"",
            ":33:32: materials[0].EA: \"x\" will not do; it must be a number",
        ),
        (
            "EA: 100.0",
            "EAA: 3",
            ":33:28: materials[0].EAA: there is no field \"EAA\" here; did you mean \"EA\"?",
        ),
        (
            "EA: 100.0,",
            "",
            ":33:9: materials[0]: the field \"EA\" is missing",
        ),
        (
            "EA: 100.0",
            "EA: 1, EA: 2",
            "the field \"EA\" stands here twice",
        ),
        (
            "Beam(",
            "Plate(",
            ":35:14: bodies[0]: \"Plate\" is none of the choices (choices: Beam, Solid, Matrix, Springs)",
        ),
        (
            "sliding)",
            "slidng)",
            "slaves[0].start: \"slidng\" is none of the choices; did you mean \"sliding\"?",
        ),
        (
            "per_element: 5",
            "per_element: -1",
            ":26:26: nodes[0].per_element: -1 will not do; it must be a whole number",
        ),
        (
            "to: (-2.0, 0.0)",
            "to: (-2.0)",
            ":29:49: nodes[1].to: (-2.0) will not do; it must be two numbers",
        ),
        (
            "angle: 30.0",
            "angle: 30,0",
            "decimals have a point, not a comma",
        ),
        (
            "title: \"P",
            "title: \"\\n",
            ":18:12: title: the title must be one line",
        ),
        // Names.
        (
            "[\"beam.end\"]",
            "[\"beam.edn\"]",
            ":37:23: slaves[0].nodes[0]: no node called \"beam.edn\"; did you mean \"beam.end\"?",
        ),
        ("[\"beam.end\"]", "[\"beam.9\"]", "the chain has 5 nodes"),
        (
            "[\"beam.end\"]",
            "[\"beam@0.3\"]",
            "the nearest are at @0.25 and @0.5",
        ),
        (
            "material: \"rod\"",
            "material: \"rud\"",
            ":35:56: bodies[0].material: no material called \"rud\"; did you mean \"rod\"?",
        ),
        (
            "along: \"beam\"",
            "along: \"beem\"",
            ":35:38: bodies[0].along: no chain of nodes called \"beem\"; did you mean \"beam\"?",
        ),
        (
            "on: [\"floor\"]",
            "on: [\"flor\"]",
            "slaves[0].on[0]: no surface called \"flor\"; did you mean \"floor\"?",
        ),
        (
            "on: [\"floor\"]",
            "on: [\"floor\", \"floor\"]",
            "slaves[0].on[1]: surface \"floor\" is named twice",
        ),
        (
            "id: \"floor\", from",
            "id: \"beam\", from",
            ":29:18: nodes[1].id: the id \"beam\" is taken already by nodes[0]",
        ),
        (
            "(id: \"floor\", along",
            "(id: \"fl,or\", along",
            "an id is made of letters, digits, - and _",
        ),
        // Geometry.
        (
            "to: (-2.0, 0.0)",
            "to: (6, 0)",
            ":29:49: nodes[1].to: the line has no length",
        ),
        (
            "to: (-2.0, 0.0)",
            "to: (6, 1e308)",
            "nodes[1].to[1]: y is 1e308",
        ),
        (
            "to: (-2.0, 0.0)",
            "to: (6, NaN)",
            "nodes[1].to[1]: y is NaN",
        ),
        (
            "(6.0, 0.0), to: (-2.0, 0.0)",
            "(6, -50), to: (-2, -50)",
            "is 50.0000 away from floor",
        ),
        ("per_element: 5", "per_element: 12", "it must be 2 to 9"),
        (
            "elements: 1",
            "elements: 20000000",
            "at most 50000000 can be had",
        ),
        (
            "elements: 1",
            "elements: 18446744073709551615",
            "at most 50000000 can be had",
        ),
        // Bodies, slaves, friction.
        (
            "EA: 100.0",
            "EA: -3",
            ":33:32: materials[0].EA: EA is -3.0; a stiffness must be positive",
        ),
        ("EA: 100.0", "EA: NaN", "EA is NaN"),
        ("EI: 8.3", "GA: 0, EI: 8.3", "materials[0].GA: GA is 0.0"),
        ("[\"beam.end\"]", "[]", "slaves[0].nodes: the list is empty"),
        (
            "[\"beam.end\"]",
            "[\"beam.end\", \"beam.5\"]",
            ":37:35: slaves[0].nodes[1]: node \"beam.5\" is a slave node already",
        ),
        (
            "[\"beam.end\"]",
            "[\"floor.3\"]",
            "a node cannot touch itself",
        ),
        (
            "[\"beam.end\"]",
            "[\"beam.start\"]",
            "its contact would have no unknown",
        ),
        (
            "angle: 30.0",
            "angle: 90",
            ":38:23: friction.angle: the friction angle is 90.0",
        ),
        (
            "angle: 30.0",
            "cohesion: -1",
            "friction.cohesion: the cohesion is -1.0",
        ),
        (
            "nodes: [\n",
            "nodes: [Node(id: \"a\", at: (0, 0)),\n",
            ":20:22: nodes[0].id: node \"a\" is used by no body",
        ),
        // Supports and loads.
        (
            "fix: [x, y]",
            "fix: [x, x]",
            ":39:46: supports[0].fix[1]: x is named twice",
        ),
        (
            "\"beam.start\", fix: [x, y]",
            "\"floor.1\", fix: [rotation]",
            "is on no beam and has no rotation",
        ),
        (
            "Force(node: \"beam.end\"",
            "Force(node: \"floor.end\"",
            ":40:25: loads[0].node: node \"floor.5\" is on no body",
        ),
        (
            "Force(node: \"beam.end\"",
            "Force(node: \"beam.start\"",
            "x of node \"beam.1\" is held by supports[0]",
        ),
        (
            "Force(node: \"beam.end\"",
            "Force(node: \"beam.all\"",
            "is a chain of 5 nodes",
        ),
        ("x: -1.0", "x: inf", "loads[0].x: the load is inf"),
        (
            "x: -1.0",
            "x: -1, scale: [(0, 0), (0, 1)]",
            "loads[0].scale[1][0]: the load factors of a scale must rise",
        ),
        (
            "loads: [",
            "loads: [Displacement(node: \"beam.start\", component: x, value: 1), ",
            "is held by supports[0] already",
        ),
        // History and settings.
        (
            "[0.0, 0.25, 0.0]",
            "[0.0]",
            ":41:21: history.path: the path has 1 corners",
        ),
        (
            "0.25, 0.0]",
            "0.25, 0.25]",
            ":41:33: history.path[2]: the corner 0.25 stands twice in a row",
        ),
        (
            "increment: 0.01",
            "increment: 0",
            "history.increment: the increment is 0.0; it must be positive",
        ),
        (
            "increment: 0.01",
            "increment: 1e-9",
            "at most a million can be had",
        ),
        (
            "monitors: [",
            "settings: (tolerance: 0), monitors: [",
            ":42:27: settings.tolerance: the tolerance is 0.0",
        ),
        (
            "monitors: [",
            "settings: (minors: 0), monitors: [",
            "the limit of minors is 0; it must be 1 to 1000000",
        ),
        // Monitors.
        (
            "\"u_x\"",
            "\"u_y\"",
            "monitors[1].name: the name \"u_y\" is taken already by monitors[0]",
        ),
        (
            "\"u_x\"",
            "\"load\"",
            ":43:16: monitors[0].name: the name \"load\" is a CSV column already",
        ),
        ("\"u_x\"", "\"a,b\"", "it must be without commas"),
        ("\"u_x\"", "\"a\\nb\"", "it must be without commas"),
        (
            "Displacement(node: \"beam.end\", component: x",
            "Reaction(node: \"beam.end\", component: x",
            "is free and has no reaction",
        ),
        (
            "Contact(component: x)",
            "Contact(node: \"beam.2\", component: x)",
            "is no slave node (slaves: \"beam.5\")",
        ),
    ];
    for (from, to, expected) in cases {
        let error = match changed(from, to) {
            Ok(_) => panic!("{to:?} is accepted"),
            Err(error) => error.to_string(),
        };
        assert!(error.starts_with("x.ron:"), "{error}");
        assert!(
            error.contains(expected),
            "{to:?}\n got: {error}\nwant: {expected}"
        );
        assert!(!error.contains('\n'), "{error}");
    }
}

#[test]
fn curves_that_cannot_be_elements_are_refused() {
    let cases = [
        (
            "Through(id: \"b\", points: [(0, 0), (0.2, 0), (1, 0)], per_element: 3)",
            "is folded",
        ),
        (
            "Through(id: \"b\", points: [(0, 0), (1, 0), (0, 0)], per_element: 3)",
            "is folded",
        ),
        (
            "Through(id: \"b\", points: [(0, 0), (0, 0), (1, 0)], per_element: 3)",
            "stands twice in a row",
        ),
        (
            "Through(id: \"b\", points: [(0, 0), (1, 0), (2, 0), (3, 0)], per_element: 3)",
            "3 or 5 would",
        ),
        (
            "Through(id: \"b\", points: [], per_element: 3)",
            "0 nodes do not make whole elements",
        ),
        (
            "Arc(id: \"b\", center: (0, 0), radius: -1, from: 0, to: 90, elements: 1, per_element: 3)",
            "the radius is -1.0",
        ),
        (
            "Arc(id: \"b\", center: (0, 0), radius: 1, from: 0, to: 361, elements: 9, per_element: 3)",
            "at most 360",
        ),
        (
            "Node(id: \"p\", at: (0, 0)), Node(id: \"q\", at: (0, 0)), Chain(id: \"b\", of: [\"p\", \"q\"], per_element: 2)",
            "has no length",
        ),
        (
            "Node(id: \"p\", at: (0, 0)), Chain(id: \"b\", of: [\"p\", \"p\"], per_element: 2)",
            "stands twice in a row",
        ),
    ];
    for (nodes, expected) in cases {
        let error = small(nodes, "").expect_err(nodes).to_string();
        assert!(
            error.contains(expected),
            "{nodes}\n got: {error}\nwant: {expected}"
        );
    }
}

#[test]
fn a_scene_that_is_no_ron_or_no_text_is_refused_with_a_place() {
    let deep = |open: &str| {
        Scene::from_text("x", &open.repeat(100_000), &[])
            .unwrap_err()
            .to_string()
    };
    for open in [
        "[",
        "(",
        "{",
        "Some(",
        "(nodes:[",
        "(nodes:[Line(from:(",
        "/*",
        "\"",
        "r#\"",
    ] {
        assert!(deep(open).starts_with("x:1:"), "{open}: {}", deep(open));
    }
    assert!(
        Scene::from_text("x", "", &[])
            .unwrap_err()
            .to_string()
            .starts_with("x:1:1: a scene is")
    );
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("x.ron");
    std::fs::write(&file, b"(title:\n \"\xff\")").unwrap();
    let error = Scene::open(file.to_str().unwrap(), &[]).unwrap_err();
    assert_eq!(error.at, Some((2, 3)));
    assert!(error.message.contains("UTF-8"));
    assert!(Scene::open(folder.path().to_str().unwrap(), &[]).is_err());
}

#[test]
fn an_unknown_scene_is_answered_with_those_that_there_are() {
    let error = Scene::open("01-pinned-beam-rough-flor", &[])
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("did you mean \"01-pinned-beam-rough-floor\"?"),
        "{error}"
    );
    assert!(error.contains("osc-inclined-cantilever"), "{error}");
}

#[test]
fn every_listed_value_can_be_set_and_set_to_itself_changes_nothing() {
    for builtin in builtin::list() {
        let scene = Scene::open(builtin.name, &[]).unwrap();
        let mut spec = scene.spec.clone();
        for listed in paths::list(&scene.spec) {
            paths::set(&mut spec, &listed.path, &listed.value)
                .unwrap_or_else(|error| panic!("{}: {error}", listed.path));
        }
        assert_eq!(spec, scene.spec);
    }
}

#[test]
fn settings_from_outside_reach_the_model_and_are_named_in_messages() {
    let scene = with("friction.angle", "20").unwrap();
    assert_eq!(scene.model.contacts[0].friction.angle, 20.0);
    assert_eq!(
        scene.overrides().collect::<Vec<_>>(),
        [("friction.angle", "20")]
    );
    let scene = scene.with("settings.t_max", "consistent").unwrap();
    assert_eq!(scene.model.settings.t_max, BoundUpdate::Consistent);
    assert_eq!(scene.model.contacts[0].friction.angle, 20.0);
    let cases = [
        (
            "friction.angle",
            "95",
            "--set friction.angle=95: the friction angle is 95.0",
        ),
        ("friction.angel", "20", "did you mean friction.angle?"),
        ("friction", "3", "it has friction.angle, friction.cohesion"),
        (
            "settings.t_max",
            "foo",
            "it must be one of lagged, consistent",
        ),
        ("settings.foo", "1", "settings has settings.strategy"),
        ("refine", "-1", "it must be a whole number"),
        ("refine", "0", "--set refine=0: refine is 0"),
        (
            "nodes.beam.elments",
            "2",
            "did you mean nodes.beam.elements?",
        ),
        ("history.increment", "nan", "it must be a number"),
        ("surfaces.floor.reverse", "yes", "it must be true or false"),
        (
            "bodies.beam.material",
            "x",
            "--set bodies.beam.material=x: no material called",
        ),
        ("", "x", "the scene has no value"),
    ];
    for (path, value, expected) in cases {
        let error = with(path, value).expect_err(path).to_string();
        assert!(
            error.contains(expected),
            "{path}={value}\n got: {error}\nwant: {expected}"
        );
    }
}

#[test]
fn friction_of_a_group_is_the_scenes_until_it_is_set() {
    let own = with("slaves[0].friction.cohesion", "0.5").unwrap();
    assert_eq!(own.model.contacts[0].friction.cohesion, 0.5);
    assert_eq!(own.model.contacts[0].friction.angle, 30.0);
    assert_eq!(own.spec.friction.cohesion, 0.0);
}

#[test]
fn a_scene_survives_being_written_and_read() {
    for builtin in builtin::list() {
        let scene = Scene::open(builtin.name, &[]).unwrap();
        let pretty = ron::ser::PrettyConfig::default();
        let text = read::options()
            .to_string_pretty(&scene.spec, pretty)
            .unwrap();
        let again: Spec = read::options().from_str(&text).unwrap();
        assert_eq!(again, scene.spec);
        let model: Model = Scene::from_spec("again", again).unwrap().model;
        assert_eq!(model, scene.model);
    }
}

#[test]
fn cost_counts_what_the_model_has() {
    for builtin in builtin::list() {
        let scene = Scene::open(builtin.name, &[("refine".into(), "2".into())]).unwrap();
        let cost = Cost::of(&scene);
        let bodies = cost.translations + cost.rotations + cost.shears + cost.forces;
        assert_eq!(bodies, scene.model.dofs.equations, "{}", builtin.name);
        assert_eq!(cost.unknowns(), bodies + 2 * scene.model.contacts.len());
    }
    let text = Cost::of(&Scene::open(PINNED, &[]).unwrap()).to_string();
    for line in [
        "shear forces            4",
        "no unknowns on surface floor: rigid",
        "no shear deformation of beam: GA is not named",
    ] {
        assert!(text.contains(line), "{text}");
    }
}

/// What must hold for every scene that is accepted, however it came about.
fn assert_usable(model: &Model) {
    assert!(
        model
            .nodes
            .iter()
            .all(|node| node.at.iter().all(|x| x.is_finite()))
    );
    assert!(model.length > 0.0 && model.length.is_finite());
    assert_eq!(model.dofs.first.len(), model.nodes.len());
    assert_eq!(
        model.dofs.equation.iter().flatten().count(),
        model.dofs.equations
    );
    let numbers: Vec<usize> = model.dofs.equation.iter().flatten().copied().collect();
    assert!(numbers.iter().enumerate().all(|(k, number)| k == *number));
    for body in &model.bodies {
        match &body.kind {
            BodyKind::Beam(_) => {
                for node in &body.nodes {
                    assert!(model.dofs.dof(*node, Component::Rotation).is_some());
                }
            }
            BodyKind::Solid(solid) => {
                assert_eq!(solid.elements.len(), solid.material_of.len());
                assert!(solid.material_of.iter().all(|&k| k < solid.materials.len()));
                let nodes: HashSet<usize> = solid.elements.iter().flatten().copied().collect();
                assert_eq!(nodes, body.nodes.iter().copied().collect());
            }
            BodyKind::Linear(linear) => {
                let size = 2 * body.nodes.len();
                let fits = |&(i, j, v): &(usize, usize, f64)| i < size && j < size && v.is_finite();
                assert!(linear.entries.iter().all(fits));
            }
        }
    }
    assert!(model.loads.iter().all(|load| load.value.is_finite()));
    assert!(
        model
            .prescribed
            .iter()
            .all(|p| model.dofs.equation[p.dof].is_none())
    );
    assert!(model.path.len() >= 2 && model.increment > 0.0);
    assert!(
        model
            .contacts
            .iter()
            .all(|slave| !slave.surfaces.is_empty())
    );
}

fn try_text(text: &str) {
    match Scene::from_text("x", text, &[]) {
        Ok(scene) => {
            assert_usable(&scene.model);
            let _ = Cost::of(&scene).to_string();
            let _ = paths::list(&scene.spec);
        }
        Err(error) => {
            assert!(error.to_string().starts_with("x:"), "{error}");
            assert!(!error.to_string().contains('\n'), "{error}");
        }
    }
}

/// Numbers as damage.
const NUMBERS: [&str; 14] = [
    "NaN",
    "inf",
    "-inf",
    "-1",
    "0",
    "-0.0",
    "1e308",
    "-1e308",
    "1e-308",
    "99999999999999999999999999",
    "18446744073709551615",
    "4294967296",
    "0x7f",
    "\"1\"",
];

/// Byte ranges of the numbers in a text.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let bytes = text.as_bytes();
    let part = |k: usize| bytes[k].is_ascii_digit() || matches!(bytes[k], b'.' | b'-');
    let mut found = Vec::new();
    let mut k = 0;
    while k < bytes.len() {
        let start = k;
        while k < bytes.len() && part(k) {
            k += 1;
        }
        if bytes[start..k].iter().any(u8::is_ascii_digit) {
            found.push(start..k);
        }
        k = k.max(start + 1);
    }
    found
}

/// One way to damage a text.
#[derive(Debug, Clone)]
enum Damage {
    Delete(prop::sample::Index, usize),
    Repeat(prop::sample::Index, usize),
    Insert(prop::sample::Index, String),
    Number(prop::sample::Index, usize),
}

fn damage() -> impl Strategy<Value = Damage> {
    let index = any::<prop::sample::Index>;
    prop_oneof![
        (index(), 1usize..40).prop_map(|(at, length)| Damage::Delete(at, length)),
        (index(), 1usize..200).prop_map(|(at, length)| Damage::Repeat(at, length)),
        (index(), "[](){}\",:./*@ a-zA-Z0-9é-]{1,6}")
            .prop_map(|(at, text)| Damage::Insert(at, text)),
        (index(), 0..NUMBERS.len()).prop_map(|(at, which)| Damage::Number(at, which)),
        (index(), 0..NUMBERS.len()).prop_map(|(at, which)| Damage::Number(at, which)),
    ]
}

fn damaged(text: &str, damage: &Damage) -> String {
    let border = |mut k: usize| {
        while !text.is_char_boundary(k) {
            k += 1;
        }
        k
    };
    let slice = |at: &prop::sample::Index, length: usize| {
        let start = border(at.index(text.len() + 1));
        start..border((start + length).min(text.len()))
    };
    match damage {
        Damage::Delete(at, length) => {
            let cut = slice(at, *length);
            format!("{}{}", &text[..cut.start], &text[cut.end..])
        }
        Damage::Repeat(at, length) => {
            let cut = slice(at, *length);
            format!("{}{}", &text[..cut.end], &text[cut.start..])
        }
        Damage::Insert(at, what) => {
            let start = slice(at, 0).start;
            format!("{}{what}{}", &text[..start], &text[start..])
        }
        Damage::Number(at, which) => {
            let found = numbers(text);
            if found.is_empty() {
                return text.to_owned();
            }
            let cut = &found[at.index(found.len())];
            format!(
                "{}{}{}",
                &text[..cut.start],
                NUMBERS[*which],
                &text[cut.end..]
            )
        }
    }
}

/// A scene with every construct of the format, as a target for damage.
const EVERYTHING: &str = r#"(
    title: "all", about: "a", refine: 2,
    nodes: [
        Node(id: "p", at: (0.5, 1.0)),
        Line(id: "b", from: (0, 0), to: (4, 0), elements: 2, per_element: 3),
        Arc(id: "a", center: (2, -2), radius: 2, from: 135, to: 45, elements: 2, per_element: 3),
        Through(id: "t", points: [(0, 2), (1, 2.1), (2, 2)], per_element: 3),
        Chain(id: "c", of: ["b.1", "p"], per_element: 2),
        Block(id: "k", corners: [(5, 0), (6, 0), (6, 2), (5, 1.5)], elements: (2, 3)),
        Block(id: "r", corners: [(5, -3), (6, -2)], elements: (1, 2)),
        Block(id: "h", corners: [(9, -1), (11, -1), (11, 0), (9, 0)], elements: (2, 1), grading: (0.5, 1)),
        Block(id: "i", corners: [(9, 0), (11, 0), (11, 2), (9, 1)], elements: (2, 1), grading: (1, 2),
            sides: (bottom: Along(chain: "h.top"), right: Arc(center: (10, 1))), place: (turn: 0, about: (1, 1))),
        Mesh(id: "hi", of: ["h", "i"], joints: [("h.top", "i.bottom")], tolerance: 1e-7),
        Chain(id: "round", of: ["i.right", "i.top"], per_element: 3),
    ],
    materials: [
        Section(id: "m", EA: 10, EI: 1, GA: 3), Section(id: "n", EA: 10, EI: 1),
        Elastic(id: "e", E: 100, nu: 0.3),
        Elastic(id: "f", E: 50, nu: 0.2, law: neohookean, plane: stress, thickness: 0.1, update: total),
        Elastic(id: "g", E: 50, nu: 0, update: updated),
    ],
    bodies: [
        Beam(id: "b", along: "b", material: "m"), Beam(id: "c", along: "c", material: "n"),
        Beam(id: "t", along: "t", material: "n"), Beam(id: "skin", along: "r.top", material: "m"),
        Solid(id: "k", mesh: "k", material: "e", regions: [(from: (5, 1), to: (6, 2), material: "f")]),
        Solid(id: "r", mesh: "r", material: "g"), Solid(id: "hi", mesh: "hi", material: "e"),
    ],
    surfaces: [(id: "w", along: "round"), (id: "s", along: "a"), (id: "u", along: "t", reverse: true), (id: "v", along: "k.left")],
    slaves: [
        (nodes: ["b.all"], on: ["s"], start: fixed, friction: (angle: 10, cohesion: 0.1)),
        (nodes: ["p"], on: ["s", "u"]), (nodes: ["r.left", "r.bottom.2"], on: ["v"]),
    ],
    friction: (angle: 5),
    supports: [(node: "t.start", fix: [x, y, rotation]), (node: "k.right", fix: [x])],
    loads: [
        Traction(along: "k.top", normal: -1, x: 0.5, y: 1, scale: [(0, 1)]), Force(node: "r.3", x: 1),
        Force(node: "b.end", x: 1, y: 2, scale: [(0, 0), (1, 2)]), Moment(node: "t.end", value: 3),
        Displacement(node: "a.all", component: y, value: 0.1), Displacement(node: "t.end", component: x, value: 0.1),
    ],
    history: (path: [0, 1, -1], increment: 0.1),
    settings: (residual: accumulate, t_max: consistent, slip: major, ties: printed, minors: 3, majors: 4,
        at_minor_limit: accept, at_major_limit: accept, tolerance: 1e-8),
    monitors: [
        (name: "a", of: Displacement(node: "p", component: x)), (name: "b", of: Contact(node: "p", component: y)),
        (name: "c", of: Contact(component: x)), (name: "d", of: Reaction(node: "t.start", component: rotation)),
    ],
)"#;

/// A quarter of a plate with a round hole, of two blocks, and what its bodies and loads are.
fn plate(changes: &[(&str, &str)]) -> Result<Scene, SceneError> {
    let text = r#"(
    title: "plate",
    nodes: [
        Line(id: "edge", from: (3, 3), to: (3, 0), elements: 1, per_element: 2),
        Block(id: "a", corners: [(1, 0), (3, 0), (3, 3), (0.7071067811865476, 0.7071067811865476)],
            elements: (4, 3), grading: (3, 1), sides: (left: Arc(center: (0, 0)), right: Along(chain: "edge"))),
        Block(id: "b", corners: [(0.7071067811865476, 0.7071067811865476), (3, 3), (0, 3), (0, 1)],
            elements: (4, 2), grading: (3, 1), sides: (left: Arc(center: (0, 0)))),
        Mesh(id: "plate", of: ["a", "b"], joints: [("a.top", "b.bottom")]),
        Chain(id: "outside", of: ["a.right", "b.right"], per_element: 3),
        Chain(id: "hole", of: ["b.left", "a.left"], per_element: 3),
    ],
    materials: [Elastic(id: "e", E: 100, nu: 0.3)],
    bodies: [Solid(id: "plate", mesh: "plate", material: "e")],
    supports: [(node: "a.bottom", fix: [y]), (node: "b.top", fix: [x]), (node: "b.top.end", fix: [x])],
    history: (path: [0, 1], increment: 1),
)"#;
    let text = changes.iter().fold(text.to_owned(), |text, (from, to)| {
        text.replacen(from, to, 1)
    });
    Scene::from_text("plate", &text, &[])
}

/// Area of a solid, and the least Jacobian over its mean, by 3 by 3 Gauss points.
fn area(scene: &Scene) -> (f64, f64) {
    let BodyKind::Solid(solid) = &scene.model.bodies[0].kind else {
        panic!("no solid")
    };
    let (mut sum, mut least) = (0.0, f64::INFINITY);
    for element in &solid.elements {
        let at = element.map(|n| scene.model.nodes[n].at);
        let mut own = Vec::new();
        for (r, v) in GAUSS {
            for (s, w) in GAUSS {
                own.push((jacobian(&at, r, s), v * w));
            }
        }
        let part: f64 = own.iter().map(|(j, w)| j * w).sum();
        least = own
            .iter()
            .map(|(j, _)| 4.0 * j / part)
            .fold(least, f64::min);
        sum += part;
    }
    (sum, least)
}

const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

/// Jacobian of an 8-node quadrilateral by differences of its map, exact for its second degree in each direction.
fn jacobian(at: &[[f64; 2]; 8], r: f64, s: f64) -> f64 {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let map = |r: f64, s: f64| {
        let mut x = [0.0; 2];
        for k in 0..8 {
            let n = if k < 4 {
                let (a, b) = corners[k];
                0.25 * (1.0 + a * r) * (1.0 + b * s) * (a * r + b * s - 1.0)
            } else if k % 2 == 0 {
                0.5 * (1.0 - r * r) * (1.0 + if k == 4 { -s } else { s })
            } else {
                0.5 * (1.0 - s * s) * (1.0 + if k == 5 { r } else { -r })
            };
            x = [x[0] + n * at[k][0], x[1] + n * at[k][1]];
        }
        x
    };
    let h = 0.5;
    let by = |a: [f64; 2], b: [f64; 2]| [(a[0] - b[0]) / (2.0 * h), (a[1] - b[1]) / (2.0 * h)];
    let (dr, ds) = (
        by(map(r + h, s), map(r - h, s)),
        by(map(r, s + h), map(r, s - h)),
    );
    dr[0] * ds[1] - dr[1] * ds[0]
}

#[test]
fn joined_blocks_share_the_nodes_of_the_joint_and_no_others() {
    let scene = plate(&[]).unwrap_or_else(|e| panic!("{e}"));
    // Nodes of an 8-node mesh: 3 nx ny + 2 (nx + ny) + 1; the joint has 2 · 4 + 1; the side's line has 2 of its own.
    let (a, b) = (3 * 12 + 2 * 7 + 1, 3 * 8 + 2 * 6 + 1);
    assert_eq!(scene.model.nodes.len(), a + b - 9 + 2);
    assert_eq!(scene.model.bodies[0].nodes.len(), a + b - 9);
    let names = scene.names();
    let mut joint = names.nodes("b.bottom").unwrap();
    joint.reverse();
    assert_eq!(names.nodes("a.top").unwrap(), joint);
    assert_eq!(
        names.nodes("plate.all").unwrap(),
        scene.model.bodies[0].nodes
    );
    let BodyKind::Solid(solid) = &scene.model.bodies[0].kind else {
        panic!("no solid")
    };
    assert_eq!(
        solid.edges.len(),
        2 * (4 + 3) + 2 * (4 + 2) - 2 * 4,
        "the joint is no outline"
    );
    assert_eq!(
        names.nodes("outside.all").unwrap().len(),
        2 * (3 + 2) + 1,
        "the corner counts once"
    );
    for name in ["hole.start", "hole.end", "hole@0.4", "hole.2"] {
        let [x, y] = scene.model.nodes[scene.node(name).unwrap()].at;
        assert!((x.hypot(y) - 1.0).abs() < 1e-12, "{name} is on the hole");
    }
}

#[test]
fn areas_sum_up_to_the_whole_and_refinement_keeps_the_geometry() {
    let whole = 9.0 - std::f64::consts::PI / 4.0;
    let mut last = f64::INFINITY;
    for refine in ["1", "2", "4"] {
        let scene = plate(&[]).unwrap().with("refine", refine).unwrap();
        let (area, least) = area(&scene);
        let error = (area - whole).abs();
        assert!(least > 0.3, "refine {refine}: Jacobian {least} of the mean");
        assert!(
            error < last / 12.0 && error < 1e-4,
            "refine {refine}: {error}"
        );
        last = error;
    }
    let (coarse, fine) = (
        plate(&[]).unwrap(),
        plate(&[("title", "refine: 3, title")]).unwrap(),
    );
    for edge in [
        "a.bottom", "a.right", "a.top", "a.left", "b.left", "b.right",
    ] {
        let at =
            |scene: &Scene, k: usize| scene.model.nodes[scene.names().nodes(edge).unwrap()[k]].at;
        for k in 0..coarse.names().nodes(edge).unwrap().len() {
            // Middles of an element stay middles only of what they are on, which odd refinement keeps.
            let ([x, y], [v, w]) = (at(&coarse, k), at(&fine, 3 * k));
            assert!((x - v).hypot(y - w) < 1e-14, "{edge} {k}");
        }
    }
}

#[test]
fn a_placed_block_is_turned_and_shifted_whole() {
    let there = |place: &str| {
        let block = format!(
            "corners: [(1, 0), (3, 0), (2, 2), (0, 1)], elements: (2, 2), sides: (left: Arc(center: (0, 0))), {place}"
        );
        solid(&block, ELASTIC, SOLID, "").unwrap()
    };
    let (lies, put) = (
        there(""),
        there("place: (turn: 90, about: (1, 0), shift: (5, 7))"),
    );
    for (a, b) in lies.model.nodes.iter().zip(&put.model.nodes) {
        let [x, y] = [a.at[0] - 1.0, a.at[1]];
        assert!((b.at[0] - (6.0 - y)).abs() < 1e-14 && (b.at[1] - (7.0 + x)).abs() < 1e-14);
    }
}

#[test]
fn each_fault_of_a_mesh_has_one_message_with_its_place() {
    type Case<'a> = (&'a [(&'a str, &'a str)], &'a str, &'a str);
    let cases: &[Case] = &[
        (
            &[("elements: (4, 2)", "elements: (5, 2)")],
            "nodes[3].joints[0]",
            "\"a.top\" has 4 elements and \"b.bottom\" has 5",
        ),
        (
            &[(
                "grading: (3, 1), sides: (left: Arc(center: (0, 0)))),\n        Mesh",
                "grading: (2, 1), sides: (left: Arc(center: (0, 0)))),\n        Mesh",
            )],
            "nodes[3].joints[0]",
            "do not coincide",
        ),
        (
            &[("(\"a.top\", \"b.bottom\")", "(\"a.top\", \"b.bottm\")")],
            "nodes[3].joints[0][1]",
            "did you mean",
        ),
        (
            &[("(\"a.top\", \"b.bottom\")", "(\"edge\", \"b.bottom\")")],
            "nodes[3].joints[0][0]",
            "no edge of a block",
        ),
        (
            &[("of: [\"a\", \"b\"]", "of: [\"a\", \"a\"]")],
            "nodes[3].of[1]",
            "named twice",
        ),
        (
            &[("of: [\"a\", \"b\"]", "of: [\"a\", \"edge\"]")],
            "nodes[3].of[1]",
            "no block called \"edge\"",
        ),
        (
            &[
                ("[(\"a.top\"", "tolerance: 1, joints: [(\"a.top\""),
                ("joints: tolerance", "tolerance"),
            ],
            "nodes[3].tolerance",
            "0 to 0.1",
        ),
        (
            &[("center: (0, 0)", "center: (0.1, 0)")],
            "nodes[1].sides.left.center",
            "equal radii",
        ),
        (
            &[("from: (3, 3)", "from: (3, 2)")],
            "nodes[1].sides.right.chain",
            "must join the corners",
        ),
        (
            &[("Along(chain: \"edge\")", "Along(chain: \"b.left\")")],
            "nodes[1].sides.right.chain",
            "no chain of nodes called",
        ),
        (
            &[("grading: (3, 1)", "grading: (0, 1)")],
            "nodes[1].grading[0]",
            "must be between",
        ),
        (
            &[
                (
                    "corners: [(1, 0), (3, 0), (3, 3)",
                    "corners: [(1, 0), (3, 0), (0.2, 0.9)",
                ),
                (
                    "right: Along(chain: \"edge\")",
                    "right: Arc(center: (1.7, 0.55))",
                ),
            ],
            "nodes[1]",
            "",
        ),
    ];
    for (changes, path, says) in cases {
        let error = plate(changes).unwrap_err();
        assert!(
            error.path.starts_with(path) && error.message.contains(says),
            "{changes:?}: {error}"
        );
        assert!(error.at.is_some(), "{error}");
    }
}

#[test]
fn the_scene_with_everything_is_sound() {
    let scene = Scene::from_text("all", EVERYTHING, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_usable(&scene.model);
    let mut spec = scene.spec.clone();
    for listed in paths::list(&scene.spec) {
        paths::set(&mut spec, &listed.path, &listed.value)
            .unwrap_or_else(|e| panic!("{}: {e}", listed.path));
    }
    assert_eq!(spec, scene.spec);
}

fn a_good_scene() -> impl Strategy<Value = &'static str> {
    let mut texts: Vec<&'static str> = builtin::list().iter().map(|scene| scene.text).collect();
    texts.push(EVERYTHING);
    prop::sample::select(texts)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_answered(text in "\\PC{0,200}") {
        try_text(&text);
    }

    #[test]
    fn any_bytes_are_answered(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        try_text(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn any_damage_is_answered(text in a_good_scene(), damages in prop::collection::vec(damage(), 1..4)) {
        let text = damages.iter().fold(text.to_owned(), |text, one| damaged(&text, one));
        try_text(&text);
    }

    #[test]
    fn any_setting_is_answered(
        text in a_good_scene(),
        which in any::<prop::sample::Index>(),
        value in prop_oneof![prop::sample::select(NUMBERS.to_vec()).prop_map(str::to_owned), "\\PC{0,12}"],
    ) {
        let scene = Scene::from_text("x", text, &[]).unwrap();
        let listed = paths::list(&scene.spec);
        let path = &listed[which.index(listed.len())].path;
        match scene.with(path, &value) {
            Ok(scene) => assert_usable(&scene.model),
            Err(error) => prop_assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }

    #[test]
    fn any_name_of_a_node_is_answered(name in "[a-z]{0,3}[.@]?[-0-9a-z.]{0,6}") {
        let scene = Scene::from_text("x", EVERYTHING, &[]).unwrap();
        if let Ok(node) = scene.node(&name) {
            prop_assert!(node < scene.model.nodes.len());
        }
    }
}

#[test]
fn a_large_scene_is_accepted_up_to_the_memory_that_it_may_take() {
    let large = |refine: &str, memory: &str| {
        let set = [("refine", refine), ("settings.memory", memory)];
        let set = set.map(|(path, value)| (path.to_string(), value.to_string()));
        Scene::open(PINNED, &set).map_err(|error| error.to_string())
    };
    assert_eq!(large("20000", "2").unwrap().model.nodes.len(), 160_002);
    // Before a node is made, and once all is counted.
    for (refine, memory) in [("40000", "0.5"), ("20000", "0.7")] {
        let error = large(refine, memory).unwrap_err();
        assert!(
            error.contains("settings.memory sets what it may take"),
            "{error}"
        );
    }
    let error = large("1", "0").unwrap_err();
    assert!(
        error.contains("must be a positive number of gigabytes"),
        "{error}"
    );
}
