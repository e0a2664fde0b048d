//! Scenes as text, for tests of the format: the pinned beam changed, small ones, a block, a plate, and one with everything.

use std::collections::HashSet;
use stickslip::format::SceneError;
use stickslip::model::{BodyKind, Component, Model, SolidElement};
use stickslip::scene::{Scene, builtin};

pub const PINNED: &str = "01-pinned-beam-rough-floor";

pub fn pinned() -> String {
    builtin::find(PINNED)
        .map(|scene| scene.text.to_owned())
        .unwrap()
}

/// The pinned beam with a piece replaced; without its settings, so that they can be given.
pub fn changed(from: &str, to: &str) -> Result<Scene, SceneError> {
    let text = pinned();
    let (start, rest) = text.split_once("    // The last increment").unwrap();
    let (_, end) = rest.split_once("settings: (at_cycle: damp),\n").unwrap();
    let text = format!("{start}{end}");
    assert!(text.contains(from), "the scene has no {from:?}");
    Scene::from_text("x.ron", &text.replacen(from, to, 1), &[])
}

pub fn with(path: &str, value: &str) -> Result<Scene, SceneError> {
    Scene::open(PINNED, &[(path.to_owned(), value.to_owned())])
}

/// A small scene: nodes, then whatever else; one cantilever unless `bodies` is among it.
pub fn small(nodes: &str, rest: &str) -> Result<Scene, SceneError> {
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

pub const LINE: &str = "Line(id: \"b\", from: (0, 0), to: (4, 0), elements: 2, per_element: 3)";

pub const SLAVE_P: &str =
    "surfaces: [(id: \"s\", along: \"b\")], slaves: [(nodes: [\"p\"], on: [\"s\"])]";

/// A block of two by one elements, made a solid, and what else the scene has.
pub fn solid(block: &str, material: &str, body: &str, rest: &str) -> Result<Scene, SceneError> {
    let text = format!(
        "(title: \"t\", nodes: [Block(id: \"k\", {block})], materials: [Elastic(id: \"e\", {material}), \
         Section(id: \"s\", EA: 1, EI: 1)], bodies: [{body}], history: (path: [0, 1], increment: 0.5), {rest})"
    );
    Scene::from_text("solid", &text, &[])
}

pub const BLOCK: &str = "corners: [(0, 0), (4, 2)], elements: (2, 1)";

pub const ELASTIC: &str = "E: 100, nu: 0.3";

pub const SOLID: &str = "Solid(id: \"k\", mesh: \"k\", material: \"e\")";

/// A quarter of a plate with a round hole, of two blocks, and what its bodies and loads are.
pub fn plate(changes: &[(&str, &str)]) -> Result<Scene, SceneError> {
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

/// A scene with every construct of the format, as a target for damage.
pub const EVERYTHING: &str = r#"(
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

/// What must hold for every scene that is accepted, however it came about.
pub fn assert_usable(model: &Model) {
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
                let sound = |e: &SolidElement| {
                    e.material < solid.materials.len() && e.nodes.len() == e.kind.nodes()
                };
                assert!(solid.elements.iter().all(sound));
                let nodes = solid.elements.iter().flat_map(|e| &e.nodes);
                let nodes: HashSet<usize> = nodes.copied().collect();
                assert_eq!(nodes, body.nodes.iter().copied().collect());
            }
            BodyKind::Truss(truss) => {
                let nodes: HashSet<usize> = truss.bars.iter().flatten().copied().collect();
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
