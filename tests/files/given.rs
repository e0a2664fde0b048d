//! Meshes that are given node by node, and meshes of Gmsh: names, walking order, and what is refused.

use stickslip::model::{BodyKind, ElementKind, Model};
use stickslip::record::export::skeleton::skeleton;
use stickslip::scene::Scene;
use stickslip::step::drive::{RunEnd, Until};
use stickslip::step::stepper::Stepper;

/// Two squares one over the other: two triangles below, one quadrilateral above, of their own nodes.
const TWO: &str = "Given(id: \"m\",
    nodes: [(7, 0, 0), (1, 1, 0), (3, 1, 1), (2, 0, 1), (14, 0, 1), (11, 1, 1), (12, 1, 2), (13, 0, 2), (99, 5, 5)],
    elements: [
        (part: \"low\", kind: triangle3, nodes: [[7, 1, 3], [7, 2, 3]]),
        (part: \"high\", also: [\"lid\"], kind: quad4, nodes: [[14, 11, 12, 13]]),
    ],
    sets: [(name: \"tip\", nodes: [13])],
    sides: [
        (name: \"floor\", sides: [[7, 1]]),
        (name: \"master\", sides: [[3, 2]]),
        (name: \"slave\", sides: [[14, 11]]),
        (name: \"both\", sides: [[13, 12], [1, 7]]),
        (name: \"around\", sides: [[1, 7], [2, 3], [3, 1], [7, 2]]),
        (name: \"inner\", sides: [[7, 3]]),
    ],
)";

fn scene(nodes: &str, more: &str) -> Result<Scene, String> {
    let text = format!(
        "(title: \"t\", nodes: [{nodes}], materials: [Elastic(id: \"e\", E: 100, nu: 0.3)],
        bodies: [Solid(id: \"low\", mesh: \"m.low\", material: \"e\"), Solid(id: \"high\", mesh: \"m.high\", material: \"e\")],
        history: (path: [0, 1], increment: 1), {more})"
    );
    Scene::from_text("t.ron", &text, &[]).map_err(|error| error.to_string())
}

fn two(more: &str) -> Result<Scene, String> {
    scene(TWO, more)
}

fn names(model: &Model, surface: usize) -> Vec<Vec<&str>> {
    let elements = model.surfaces[surface].elements.iter();
    let name = |n: &usize| model.nodes[*n].name.as_str();
    elements
        .map(|element| element.iter().map(name).collect())
        .collect()
}

#[test]
fn nodes_are_called_by_their_labels_and_parts_sets_and_sides_by_their_names() {
    let scene = two("").unwrap();
    let at = |name: &str| scene.model.nodes[scene.node(name).unwrap()].at;
    assert_eq!(
        (at("m.7"), at("m.12"), at("m.tip")),
        ([0.0, 0.0], [1.0, 2.0], [0.0, 2.0])
    );
    let places = |name: &str| {
        let nodes = scene.names().nodes(name).unwrap();
        nodes
            .iter()
            .map(|&n| scene.model.nodes[n].name.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(places("m.low"), ["m.1", "m.2", "m.3", "m.7"]);
    assert_eq!(places("m.lid"), places("m.high"));
    // In walking order, the body on the left.
    assert_eq!(places("m.master"), ["m.3", "m.2"]);
    assert_eq!(places("m.slave.start"), ["m.14"]);
    assert_eq!(places("m.all").len(), 9);
    for wrong in [
        "m",
        "m.8",
        "m.low.9",
        "m.nothing",
        "m.master",
        "m.both.start",
        "m.around.end",
        "m.start",
    ] {
        assert!(scene.node(wrong).is_err(), "{wrong} names a node");
    }
    let told = scene.node("m.8").unwrap_err();
    assert!(told.contains("m.7 and m.11"), "{told}");
}

#[test]
fn clockwise_elements_are_turned_and_a_node_of_no_element_is_on_no_body() {
    let scene = two("").unwrap();
    let BodyKind::Solid(low) = &scene.model.bodies[0].kind else {
        panic!("no solid")
    };
    let label = |n: &usize| scene.model.nodes[*n].name.as_str();
    let turned: Vec<&str> = low.elements[1].nodes.iter().map(label).collect();
    assert_eq!(turned, ["m.7", "m.3", "m.2"]);
    assert_eq!(low.edges.len(), 4);
    assert_eq!(
        scene
            .model
            .bodies
            .iter()
            .map(|b| b.nodes.len())
            .sum::<usize>(),
        8
    );
}

/// Corners and middles of sides of a quadrilateral and of a triangle, from node 1 anticlockwise, and the same clockwise. No two
/// sides are bent alike, so that a middle on a wrong side shows.
const WALKS: [(&str, [&str; 2], i32); 2] = [
    (
        "quad8",
        ["1, 2, 3, 4, 5, 6, 7, 8", "1, 4, 3, 2, 8, 7, 6, 5"],
        16,
    ),
    ("triangle6", ["1, 2, 4, 5, 9, 8", "1, 4, 2, 8, 9, 5"], 9),
];
const BENT: [[f64; 2]; 9] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [1.0, 1.0],
    [0.0, 1.0],
    [0.5, -0.02],
    [1.03, 0.5],
    [0.5, 1.04],
    [-0.01, 0.5],
    [0.49, 0.5],
];

/// The nodes of the one element of a scene, as the model has them.
fn walked(scene: &Scene) -> Vec<[f64; 2]> {
    let BodyKind::Solid(body) = &scene.model.bodies[0].kind else {
        panic!("no solid")
    };
    let nodes = body.elements[0].nodes.iter();
    nodes.map(|&n| scene.model.nodes[n].at).collect()
}

fn body(nodes: &str, part: &str) -> String {
    format!(
        "(title: \"t\", nodes: [{nodes}], materials: [Elastic(id: \"e\", E: 100, nu: 0.3)],
        bodies: [Solid(id: \"b\", mesh: \"{part}\", material: \"e\")],
        history: (path: [0, 1], increment: 1))"
    )
}

#[test]
fn clockwise_second_order_elements_of_scenes_turn_their_middle_nodes_as_well() {
    let listed = |k: usize| format!("({}, {:?}, {:?})", k + 1, BENT[k][0], BENT[k][1]);
    let all: Vec<String> = (0..BENT.len()).map(listed).collect();
    for (kind, walks, _) in WALKS {
        let [anticlockwise, clockwise] = walks.map(|nodes| {
            let given = format!(
                "Given(id: \"m\", nodes: [{}], elements: [(part: \"p\", kind: {kind}, nodes: [[{nodes}]])])",
                all.join(", ")
            );
            Scene::from_text("t.ron", &body(&given, "m.p"), &[]).unwrap_or_else(|e| panic!("{e}"))
        });
        let wanted = walks[0]
            .split(", ")
            .map(|n| BENT[n.parse::<usize>().unwrap() - 1]);
        assert_eq!(walked(&anticlockwise), wanted.collect::<Vec<_>>(), "{kind}");
        assert_eq!(walked(&clockwise), walked(&anticlockwise), "{kind}");
    }
}

#[test]
fn clockwise_second_order_elements_of_gmsh_turn_their_middle_nodes_as_well() {
    let folder = tempfile::tempdir().unwrap();
    let nodes: Vec<String> = BENT
        .iter()
        .zip(1..)
        .map(|([x, y], k)| format!("{k} {x:?} {y:?} 0"))
        .collect();
    for (kind, walks, number) in WALKS {
        let [anticlockwise, clockwise] = walks.map(|walk| {
            let mesh = format!(
                "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"p\"\n$EndPhysicalNames\n\
                 $Nodes\n9\n{}\n$EndNodes\n$Elements\n1\n1 {number} 2 1 1 {}\n$EndElements\n",
                nodes.join("\n"),
                walk.replace(',', "")
            );
            std::fs::write(folder.path().join("a.msh"), mesh).unwrap();
            let name = folder.path().join("a.ron").display().to_string();
            let text = body("Import(id: \"m\", file: \"a.msh\")", "m.p");
            Scene::from_text(&name, &text, &[]).unwrap_or_else(|e| panic!("{e}"))
        });
        assert_eq!(walked(&anticlockwise).len(), walks[0].split(", ").count());
        assert_eq!(walked(&clockwise), walked(&anticlockwise), "{kind}");
    }
}

/// The load is on the side between nodes 1 and 4, which is the last one anticlockwise and the first one clockwise.
#[test]
fn clockwise_second_order_elements_of_decks_turn_their_middle_nodes_and_keep_their_sides() {
    let nodes: Vec<String> = BENT
        .iter()
        .zip(1..)
        .map(|([x, y], k)| format!("{k}, {x:?}, {y:?}"))
        .collect();
    for ((kind, walks, _), (element, last)) in WALKS.iter().zip([("CPE8", 4), ("CPE6", 3)]) {
        let solved = |walk: &str, side: i32| {
            let deck = format!(
                "*NODE\n{}\n*ELEMENT, TYPE={element}, ELSET=P\n1, {walk}\n*MATERIAL, NAME=M\n*ELASTIC\n100., 0.3\n\
                 *SOLID SECTION, ELSET=P, MATERIAL=M\n1.\n*BOUNDARY\n1, 1, 2\n2, 2, 2\n*STEP\n*STATIC, DIRECT\n1., 1.\n\
                 *DLOAD\n1, P{side}, 2.\n*END STEP\n",
                nodes.join("\n")
            );
            let scene = Scene::from_text("job.inp", &deck, &[]).unwrap_or_else(|e| panic!("{e}"));
            let places = walked(&scene);
            let mut stepper = Stepper::new(scene.model.into());
            let end = stepper.drive(Until::end(), |_| std::ops::ControlFlow::<()>::Continue(()));
            assert!(matches!(end, RunEnd::Finished), "{kind}");
            (places, stepper.state().u.clone())
        };
        let anticlockwise = solved(walks[0], last);
        assert!(
            anticlockwise.1.iter().any(|u| u.abs() > 1e-3),
            "{kind}: nothing moved"
        );
        assert_eq!(solved(walks[1], 1), anticlockwise, "{kind}");
    }
}

#[test]
fn sides_are_walked_with_the_body_on_the_left_and_pieces_are_surfaces_of_their_own() {
    let scene = two("surfaces: [(id: \"s\", along: \"m.both\"), (id: \"r\", along: \"m.around\"), (id: \"b\", along: \"m.master\", reverse: true)]").unwrap();
    let model = &scene.model;
    let called: Vec<&str> = model.surfaces.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(called, ["s.1", "s.2", "r", "b"]);
    assert_eq!(names(model, 0), [["m.12", "m.13"]]);
    assert_eq!(names(model, 1), [["m.7", "m.1"]]);
    let loop_ = names(model, 2);
    assert_eq!(loop_.len(), 4);
    for (side, next) in loop_.iter().zip(loop_.iter().cycle().skip(1)) {
        assert_eq!(side[1], next[0]);
    }
    assert!(loop_.contains(&vec!["m.7", "m.1"]));
    assert_eq!(names(model, 3), [["m.2", "m.3"]]);
}

#[test]
fn slaves_touch_all_pieces_of_a_surface_by_its_one_name() {
    let split = TWO.replace(
        "(name: \"master\", sides: [[3, 2]])",
        "(name: \"master\", sides: [[3, 2], [7, 1]])",
    );
    let scene = scene(&split, "surfaces: [(id: \"s\", along: \"m.master\")], slaves: [(nodes: [\"m.slave\"], on: [\"s\"])]").unwrap();
    assert_eq!(scene.model.contacts.len(), 2);
    assert!(
        scene
            .model
            .contacts
            .iter()
            .all(|contact| contact.surfaces == [0, 1])
    );
}

#[test]
fn a_line_of_no_body_runs_as_its_first_side_does() {
    let rigid = TWO
        .replace("(99, 5, 5)", "(90, 0, -1), (91, 1, -1), (92, 2, -1)")
        .replace(
            "(name: \"inner\", sides: [[7, 3]])",
            "(name: \"rail\", sides: [[92, 91], [90, 91]])",
        );
    let scene = scene(
        &rigid,
        "surfaces: [(id: \"s\", along: \"m.rail\", endless: true)]",
    )
    .unwrap();
    assert_eq!(names(&scene.model, 0), [["m.92", "m.90"]]);
    assert!(scene.model.surfaces[0].rigid);
}

#[test]
fn what_makes_no_mesh_is_refused_with_its_place() {
    let cases = [
        (
            "(1, 1, 0)",
            "(7, 1, 0)",
            "nodes[0].nodes[1][0]",
            "label 7 is already used by another",
        ),
        (
            "[7, 1, 3]",
            "[7, 1, 33]",
            "nodes[0].elements[0].nodes[0][2]",
            "no node of the mesh has the label 33",
        ),
        (
            "[7, 1, 3]",
            "[7, 1]",
            "nodes[0].elements[0].nodes[0]",
            "has 2 nodes; a triangle3 has 3",
        ),
        (
            "[7, 1, 3]",
            "[7, 1, 7]",
            "nodes[0].elements[0].nodes[0][2]",
            "occurs twice",
        ),
        (
            "[7, 2, 3]",
            "[7, 14, 2]",
            "nodes[0].elements[0].nodes[1]",
            "folded or flat",
        ),
        (
            "[7, 2, 3]",
            "[3, 1, 7]",
            "nodes[0].elements",
            "two elements have the same corners",
        ),
        (
            "[14, 11, 12, 13]",
            "[14, 12, 11, 13]",
            "nodes[0].elements[1].nodes[0]",
            "folded",
        ),
        (
            "sides: [[3, 2]]",
            "sides: [[1, 2]]",
            "nodes[0].sides[1].sides[0]",
            "does not belong to an element",
        ),
        (
            "sides: [[3, 2]]",
            "sides: [[3, 7, 2]]",
            "nodes[0].sides[1].sides[0]",
            "has m.7 in the middle, but the element has no",
        ),
        (
            "sides: [[3, 2]]",
            "sides: [[3, 2], [2, 3]]",
            "nodes[0].sides[1].sides[1]",
            "is listed twice",
        ),
        (
            "\"tip\"",
            "\"low\"",
            "nodes[0].sets[0].name",
            "already has a part called \"low\"",
        ),
        ("\"tip\"", "\"12\"", "nodes[0].sets[0].name", "is a number"),
        ("\"tip\"", "\"a.b\"", "nodes[0].sets[0].name", "a point"),
        (
            "\"tip\"",
            "\"all\"",
            "nodes[0].sets[0].name",
            "is a reserved word",
        ),
    ];
    for (old, new, place, told) in cases {
        assert!(TWO.contains(old), "{old}");
        let error = scene(&TWO.replacen(old, new, 1), "").unwrap_err();
        assert!(
            error.contains(&format!(": {place}: ")) && error.contains(told),
            "{new}: {error}"
        );
    }
    let inner = two("surfaces: [(id: \"s\", along: \"m.inner\")]").unwrap_err();
    assert!(inner.contains("sides between two elements"), "{inner}");
}

#[test]
fn coordinates_and_elements_are_no_values_to_set() {
    let scene = two("").unwrap();
    let listed = stickslip::format::paths::list(&scene.spec);
    assert!(listed.iter().all(|l| !l.path.starts_with("nodes.")));
}

const FORMS: [&str; 4] = ["text22", "binary22", "text41", "binary41"];

/// A folder with one of the meshes in it, as `mesh.msh`.
fn folder(form: &str) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    let file = format!("{}/tests/meshes/{form}.msh", env!("CARGO_MANIFEST_DIR"));
    std::fs::copy(file, directory.path().join("mesh.msh")).unwrap();
    directory
}

fn imported(
    directory: &tempfile::TempDir,
    import: &str,
    set: &[(&str, &str)],
) -> Result<Scene, String> {
    let file = directory.path().join("scene.ron");
    let parts = ["block".to_owned(), "disc".to_owned()];
    let text = skeleton(file.to_str().unwrap(), "mesh.msh", &parts).map_err(|e| e.to_string())?;
    let text = text.replace("file: \"mesh.msh\"", import);
    std::fs::write(&file, text).unwrap();
    let set: Vec<_> = set
        .iter()
        .map(|(p, v)| ((*p).to_owned(), (*v).to_owned()))
        .collect();
    Scene::open(file.to_str().unwrap(), &set).map_err(|e| e.to_string())
}

/// The slave nodes, and what each may touch.
fn pairs(model: &Model) -> Vec<(usize, &[usize])> {
    let contacts = model.contacts.iter();
    contacts.map(|c| (c.node, c.surfaces.as_slice())).collect()
}

#[test]
fn all_four_forms_of_a_file_give_one_model_whose_scene_runs_to_its_end() {
    let scenes = FORMS.map(|form| imported(&folder(form), "file: \"mesh.msh\"", &[]).unwrap());
    let first = &scenes[0].model;
    let kinds = |k: usize| match &first.bodies[k].kind {
        BodyKind::Solid(solid) => solid.elements.iter().map(|e| e.kind).collect::<Vec<_>>(),
        _ => Vec::new(),
    };
    assert!(kinds(0).iter().all(|kind| *kind == ElementKind::Quad8) && kinds(0).len() == 16);
    assert!(kinds(1).iter().all(|kind| *kind == ElementKind::Triangle6));
    // The nearest lines of the two bodies: the round one, and the top below it.
    assert_eq!(
        first.contacts.len(),
        scenes[0].names().nodes("m.arc").unwrap().len()
    );
    assert_eq!(first.surfaces[0].elements.len(), 8);
    for scene in &scenes[1..] {
        let model = &scene.model;
        assert_eq!(
            (&model.bodies, &model.surfaces),
            (&first.bodies, &first.surfaces)
        );
        // Text has 16 digits, so that lengths differ in the last.
        assert_eq!(pairs(model), pairs(first));
        for (a, b) in model.nodes.iter().zip(&first.nodes) {
            assert_eq!(a.name, b.name);
            assert!((a.at[0] - b.at[0]).abs().max((a.at[1] - b.at[1]).abs()) < 1e-14);
        }
    }
    let mut stepper = Stepper::new(std::sync::Arc::new(first.clone()));
    let end = stepper.drive(Until::end(), |_| std::ops::ControlFlow::<()>::Continue(()));
    assert!(matches!(end, RunEnd::Finished));
    let force: f64 = stepper.state().nodes.iter().map(|node| node.f_n).sum();
    assert!(force > 0.0);
}

#[test]
fn the_options_of_an_import_are_obeyed_and_set() {
    let directory = folder("text41");
    let scene = imported(
        &directory,
        "file: \"mesh.msh\", reduced: true",
        &[("nodes.m.scale", "2")],
    )
    .unwrap();
    let BodyKind::Solid(block) = &scene.model.bodies[0].kind else {
        panic!("no solid")
    };
    assert!(
        block
            .elements
            .iter()
            .all(|e| e.kind == ElementKind::Quad8Reduced)
    );
    let far = scene
        .model
        .nodes
        .iter()
        .map(|n| n.at[0])
        .fold(0.0, f64::max);
    assert_eq!(far, 8.0);
    let wrong = imported(&directory, "file: \"mesh.msh\", scale: 0", &[]).unwrap_err();
    assert!(wrong.contains("nodes[0].scale: the scale is 0"), "{wrong}");
}

#[test]
fn a_scene_that_is_kept_has_its_mesh_inside() {
    let directory = folder("binary41");
    let scene = imported(&directory, "file: \"mesh.msh\"", &[]).unwrap();
    let text = stickslip::record::export::written::scene(&scene).unwrap();
    assert!(!text.contains("Import(") && text.contains("Given("));
    drop(directory);
    let again = Scene::from_text("elsewhere.ron", &text, &[]).unwrap();
    assert_eq!(again.model, scene.model);
    assert_eq!(
        Scene::from_spec("kept", scene.spec.clone()).unwrap().model,
        scene.model
    );
    // And it is changed without the file.
    assert!(scene.with("friction.angle", "20").is_ok());
}

#[test]
fn only_files_beside_the_scene_are_read_and_broken_ones_are_told_by_their_own_lines() {
    let directory = folder("text41");
    for (file, told) in [
        ("../mesh.msh", "in the same folder as this one or below it"),
        ("/etc/passwd", "in the same folder as this one or below it"),
        ("none.msh", "cannot be read"),
    ] {
        let error = imported(&directory, &format!("file: {file:?}"), &[]).unwrap_err();
        assert!(
            error.contains("scene.ron:3:")
                && error.contains("nodes[0].file: ")
                && error.contains(told),
            "{error}"
        );
    }
    let path = directory.path().join("mesh.msh");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(
        directory.path().join("broken.msh"),
        text.replacen("$Nodes\n", "$Nodes\nx", 1),
    )
    .unwrap();
    let error = imported(&directory, "file: \"broken.msh\"", &[]).unwrap_err();
    let line = 2 + text[..text.find("$Nodes").unwrap()].lines().count();
    assert!(error.contains(&format!("broken.msh:{line}:1: ")), "{error}");
    let own = Scene::open(path.to_str().unwrap(), &[])
        .unwrap_err()
        .to_string();
    assert!(
        own.contains("this is a Gmsh mesh") && own.contains("stickslip export"),
        "{own}"
    );
}

#[test]
fn a_side_of_a_linear_and_a_quadratic_element_is_refused_where_the_later_one_stands() {
    let mesh = |quad: &str, nodes: &str| {
        let text = format!(
            "(title: \"t\", nodes: [Given(id: \"m\",
    nodes: [(1, 0, 0), (2, 1, 0), (3, 1, 1), (4, 0, 1), (5, 2, 0), (6, 2, 1), (7, 1.5, 0), (8, 2, 0.5), (9, 1.5, 1), (10, 1, 0.5)],
    elements: [(part: \"a\", kind: quad4, nodes: [[1, 2, 3, 4]]),
        (part: \"a\", kind: {quad}, nodes: [{nodes}])])],
  materials: [Elastic(id: \"e\", E: 100, nu: 0.3)], bodies: [Solid(id: \"b\", mesh: \"m.a\", material: \"e\")],
  history: (path: [0, 1], increment: 1))"
        );
        Scene::from_text("t.ron", &text, &[]).map_err(|error| error.to_string())
    };
    let told = mesh("quad8", "[2, 5, 6, 3, 7, 8, 9, 10]").unwrap_err();
    assert!(
        told.contains("t.ron:4:42: ")
            && told.contains("the side between m.2, m.3 is shared by a quad8 and a quad4"),
        "{told}"
    );
    assert!(mesh("quad4", "[2, 5, 6, 3]").is_ok());
    // Elements of two orders that have one node in common, or none, are no neighbours.
    assert!(mesh("triangle6", "[2, 5, 6, 7, 8, 9]").is_ok());
}
