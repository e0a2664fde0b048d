//! Nodes of lines, curves, chains, blocks and joined blocks: where they lie, and what they are called.

use crate::scenes::{BLOCK, ELASTIC, LINE, PINNED, SLAVE_P, SOLID, plate, small, solid, with};
use stickslip::model::BodyKind;
use stickslip::scene::Scene;

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

/// ExportScope interface problems have the nodes of chains as single nodes, which keep their names.
#[test]
fn a_single_node_may_be_called_as_a_node_of_a_chain_is_and_dashes_for_dots_are_read() {
    let nodes = |id: &str| format!("{LINE}, Node(id: {id:?}, at: (4, 1))");
    let scene = small(
        &nodes("p.12"),
        SLAVE_P.replace("\"p\"", "\"p.12\"").as_str(),
    )
    .unwrap();
    assert_eq!(scene.model.nodes[5].name, "p.12");
    for name in ["p.12", "p-12"] {
        assert_eq!(scene.node(name), Ok(5), "{name}");
    }
    assert_eq!(scene.node("b-2"), scene.node("b.2"));
    assert!(scene.with("nodes.p.12.at.y", "2").is_ok());
    let dashed = small(
        &nodes("p-12"),
        SLAVE_P.replace("\"p\"", "\"p.12\"").as_str(),
    )
    .unwrap();
    assert_eq!(dashed.node("p.12"), Ok(5));
    assert_eq!(dashed.model.nodes[5].name, "p-12");
    for (id, told) in [
        ("b.7", "would also be the name of a node of"),
        (".p", "consists of letters"),
        ("p.", "consists of letters"),
        ("p..1", "consists of letters"),
    ] {
        let refused = small(&nodes(id), "").unwrap_err().to_string();
        assert!(refused.contains(told), "{id}: {refused}");
    }
}

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

/// Area of a solid, and the least Jacobian over its mean, by 3 by 3 Gauss points.
fn area(scene: &Scene) -> (f64, f64) {
    let BodyKind::Solid(solid) = &scene.model.bodies[0].kind else {
        panic!("no solid")
    };
    let (mut sum, mut least) = (0.0, f64::INFINITY);
    for element in &solid.elements {
        let at: [[f64; 2]; 8] = std::array::from_fn(|k| scene.model.nodes[element.nodes[k]].at);
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
