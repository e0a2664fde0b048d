//! Each fault of a scene has one message with its place.

use crate::scenes::{BLOCK, ELASTIC, SOLID, changed, plate, small, solid};
use stickslip::scene::Scene;

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
            ":33:32: materials[0].EA: \"x\" is not valid; it must be a number",
        ),
        (
            "EA: 100.0",
            "EAA: 3",
            ":33:28: materials[0].EAA: unknown field \"EAA\"; did you mean \"EA\"?",
        ),
        (
            "EA: 100.0,",
            "",
            ":33:9: materials[0]: the field \"EA\" is missing",
        ),
        // Behind a trailing comma there is no value that could be wrong.
        (
            "increment: 0.01),",
            "),",
            ":41:14: history: the field \"increment\" is missing",
        ),
        (
            "loads: [Force(node: \"beam.end\", x: -1.0)],
    history: (path: [0.0, 0.25, 0.0], increment: 0.01),",
            "",
            ":17:1: the field \"history\" is missing",
        ),
        (
            "EA: 100.0",
            "EA: 1, EA: 2",
            "the field \"EA\" is given twice",
        ),
        (
            "Beam(",
            "Plate(",
            ":35:14: bodies[0]: \"Plate\" is not one of the choices (choices: Beam, Solid, Matrix, Truss, Springs)",
        ),
        (
            "sliding)",
            "slidng)",
            "slaves[0].start: \"slidng\" is not one of the choices; did you mean \"sliding\"?",
        ),
        (
            "per_element: 5",
            "per_element: -1",
            ":26:26: nodes[0].per_element: -1 is not valid; it must be a whole number",
        ),
        (
            "to: (-2.0, 0.0)",
            "to: (-2.0)",
            ":29:49: nodes[1].to: (-2.0) is not valid; it must be two numbers",
        ),
        (
            "to: (-2.0, 0.0)",
            "to: (-2.0, 0.0, 1.0)",
            ":29:61: nodes[1].to: expected a closing bracket, ); there are too many values",
        ),
        (
            "per_element: 5",
            "per_element: 5.0",
            ":26:26: nodes[0].per_element: 5.0 is not valid; it must be a whole number",
        ),
        (
            "per_element: 5",
            "per_element: 1e1",
            ":26:26: nodes[0].per_element: 1e1 is not valid; it must be a whole number",
        ),
        (
            "angle: 30.0",
            "angle: 30deg",
            ":38:23: friction.angle: 30deg is not valid; it must be a number",
        ),
        (
            "component: rotation",
            "component: \"rotation\"",
            ":45:74: monitors[2].of.component: \"rotation\" is not valid; it must be a name without quotes",
        ),
        (
            "fix: [x, y]",
            "fix: [x, 2]",
            ":39:46: supports[0].fix[1]: 2 is not valid; it must be a name without quotes",
        ),
        (
            "(angle: 30.0)",
            "(\"angle\": 30.0)",
            ":38:16: friction: expected the name of a field, without quotes",
        ),
        (
            "(angle: 30.0)",
            "(angle 30.0)",
            ":38:21: friction: expected a colon after the name of the field",
        ),
        (
            "start: sliding)]",
            "law: Tied())]",
            ": slaves[0]: Tied has no fields; write it without brackets",
        ),
        (
            "start: sliding)]",
            "law: Penalty)]",
            ": slaves[0].law: Penalty needs its fields in round brackets: Penalty(...)",
        ),
        (
            "start: sliding)]",
            "start: sliding)",
            ":38:5: slaves[1]: found \"friction\" where a value in round brackets, ( ), or a closing bracket was expected",
        ),
        (
            "angle: 30.0",
            "angle: 30,0",
            "decimals are written with a point, not a comma",
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
        ("[\"beam.end\"]", "[\"beam.9\"]", "is a chain of 5 nodes"),
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
            ":29:18: nodes[1].id: the id \"beam\" is already used by nodes[0]",
        ),
        (
            "(id: \"floor\", along",
            "(id: \"fl,or\", along",
            "an id consists of letters, digits, - and _",
        ),
        // Geometry.
        (
            "to: (-2.0, 0.0)",
            "to: (6, 0)",
            ":29:49: nodes[1].to: the line has zero length",
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
            "at most 50000000 are allowed",
        ),
        (
            "elements: 1",
            "elements: 18446744073709551615",
            "at most 50000000 are allowed",
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
            ":37:35: slaves[0].nodes[1]: node \"beam.5\" is already a slave node",
        ),
        (
            "[\"beam.end\"]",
            "[\"floor.3\"]",
            "a node cannot touch itself",
        ),
        (
            "[\"beam.end\"]",
            "[\"beam.start\"]",
            "their contact has no unknown",
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
            ":20:22: nodes[0].id: node \"a\" is not used by any body",
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
            "is not on a beam and has only x and y",
        ),
        (
            "Force(node: \"beam.end\"",
            "Force(node: \"floor.end\"",
            ":40:25: loads[0].node: node \"floor.5\" belongs to no body",
        ),
        (
            "Force(node: \"beam.end\"",
            "Force(node: \"beam.start\"",
            "x of node \"beam.1\" is restrained by supports[0]",
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
            "loads[0].scale[1][0]: the load factors of a scale must be ascending",
        ),
        (
            "loads: [",
            "loads: [Displacement(node: \"beam.start\", component: x, value: 1), ",
            "is already restrained by supports[0]",
        ),
        // History and settings.
        (
            "[0.0, 0.25, 0.0]",
            "[0.0]",
            ":41:21: history.path: the path has 1 corner;",
        ),
        (
            "0.25, 0.0]",
            "0.25, 0.25]",
            ":41:33: history.path[2]: the corner 0.25 is repeated",
        ),
        (
            "increment: 0.01",
            "increment: 0",
            "history.increment: the increment is 0.0; it must be positive",
        ),
        (
            "increment: 0.01",
            "increment: 1e-9",
            "at most a million are allowed",
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
            "monitors[1].name: the name \"u_y\" is already used by monitors[0]",
        ),
        (
            "\"u_x\"",
            "\"load\"",
            ":43:16: monitors[0].name: the name \"load\" is a reserved CSV column",
        ),
        (
            "\"u_x\"",
            "\"jumped\"",
            "monitors[0].name: the name \"jumped\" is a reserved CSV column",
        ),
        ("\"u_x\"", "\"a,b\"", "it must not contain commas"),
        ("\"u_x\"", "\"a\\nb\"", "it must not contain commas"),
        (
            "\"u_x\"",
            "\"a\\u{7}\"",
            "line breaks or control characters",
        ),
        (
            "Displacement(node: \"beam.end\", component: x",
            "Reaction(node: \"beam.end\", component: x",
            "is free and has no reaction",
        ),
        (
            "Contact(component: x)",
            "Contact(node: \"beam.2\", component: x)",
            "is not a slave node (slaves: \"beam.5\")",
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
            shaped("corners: [(4, 2), (0, 0)], elements: (1, 1)"),
            "nodes[0].corners: the first corner, (4.0, 2.0), is the upper right one; the lower left one comes first",
        ),
        (
            shaped("corners: [(0, 0), (0, 2), (4, 2), (4, 0)], elements: (1, 1)"),
            "list the corners anticlockwise",
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
            "at most 50000000 are allowed",
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
            "\"hooke\" is not one of the choices",
        ),
        (
            elastic("E: 1, nu: 0, law: neohookean, update: updated"),
            "materials[0].update: update: updated uses the moduli of svk",
        ),
        (
            made("Solid(id: \"k\", mesh: \"q\", material: \"e\")"),
            "bodies[0].mesh: no block called \"q\" (blocks: \"k\")",
        ),
        (
            made("Solid(id: \"k\", mesh: \"k.left\", material: \"e\")"),
            "is not a block; a solid needs",
        ),
        (
            made("Solid(id: \"k\", mesh: \"k\", material: \"s\")"),
            "material \"s\" is a beam section",
        ),
        (
            made("Beam(id: \"k\", along: \"k.left\", material: \"e\")"),
            "material \"e\" is a continuum material",
        ),
        (
            made("Beam(id: \"k\", along: \"k\", material: \"s\")"),
            "is a block; it must be a chain of nodes (chains: \"k.bottom\", ",
        ),
        (
            made("Beam(id: \"k\", along: \"k.left\", material: \"s\")"),
            "node \"k.2\" is not used by any body",
        ),
        (
            made(
                "Solid(id: \"k\", mesh: \"k\", material: \"e\", regions: [(from: (4, 2), to: (0, 0), material: \"e\")])",
            ),
            "bodies[0].regions[0]: the region from (4.0, 2.0) to (0.0, 0.0) contains no element's midpoint",
        ),
        (
            made(
                "Solid(id: \"k\", mesh: \"k\", material: \"e\", regions: [(from: (0, 0), to: (4, 2), material: \"f\")])",
            ),
            "bodies[0].regions[0].material: no material called \"f\"",
        ),
        (
            more("supports: [(node: \"k.left\", fix: [rotation])]"),
            "is not on a beam and has only x and y",
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
            more("supports: [(node: \"k\", fix: [x])]"),
            "name one of them, as \"k.left.start\" or \"k.2\", or all of them: \"k.all\"",
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
            "every node of \"k.left\" is restrained in the direction of this load",
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
            "not an edge of a block",
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
            "must connect the corners",
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
            "is repeated",
        ),
        (
            "Through(id: \"b\", points: [(0, 0), (1, 0), (2, 0), (3, 0)], per_element: 3)",
            "3 or 5 would",
        ),
        (
            "Through(id: \"b\", points: [], per_element: 3)",
            "0 nodes cannot form complete elements",
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
            "has zero length",
        ),
        (
            "Node(id: \"p\", at: (0, 0)), Chain(id: \"b\", of: [\"p\", \"p\"], per_element: 2)",
            "is repeated",
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
