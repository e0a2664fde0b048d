//! Tests of the conversion of decks and of error locations.

use crate::Scene;
use crate::format::spec::LoadSpec;
use proptest::prelude::*;
use stickslip_core::{Bond, Plane, Update};

const BLOCK: &str = include_str!("../../../tests/decks/press-and-push.inp");
const PLATES: &str = include_str!("../../../tests/decks/pressed-plates.inp");
const RINGS: &str = include_str!("../../../tests/decks/shrunk-ring.inp");

fn but(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from:?} is not in the deck");
    text.replacen(from, to, 1)
}

fn scene(text: &str) -> Scene {
    Scene::from_text("job.inp", text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(text: &str) -> String {
    match Scene::from_text("job.inp", text, &[]) {
        Ok(_) => panic!("it was read:\n{text}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn connected_elements_form_bodies_and_nodes_keep_their_numbers() {
    let scene = scene(BLOCK);
    let bodies: Vec<&str> = scene
        .model
        .bodies
        .iter()
        .map(|body| body.name.as_str())
        .collect();
    assert_eq!(bodies, ["EVERYTHING", "EVERYTHING-2"]);
    let at = |name: &str| scene.model.nodes[scene.node(name).expect("a node")].at;
    assert_eq!((at("n.6"), at("n.104")), ([2.0, 1.0], [-2.0, 0.0]));
    assert_eq!(scene.names().nodes("n.TOP").expect("a set").len(), 3);
    let angle = scene.spec.friction.angle;
    assert!((angle.to_radians().tan() - 0.4).abs() < 1e-15);
    let history = scene.spec.history;
    assert_eq!(history.path, [0.0, 1.0, 2.0]);
    assert_eq!(history.increments, [0.5, 0.125]);
}

#[test]
fn the_penalty_is_by_area_and_nlgeom_chooses_the_strains() {
    let materials = |text: &str| -> Vec<(Plane, Update, f64)> {
        let scene = scene(text);
        let solids = scene
            .spec
            .materials
            .iter()
            .filter_map(|material| match material {
                crate::format::spec::Material::Elastic {
                    plane,
                    update,
                    thickness,
                    ..
                } => Some((*plane, *update, *thickness)),
                _ => None,
            });
        solids.collect()
    };
    assert_eq!(materials(PLATES), [(Plane::Stress, Update::Total, 2.0)]);
    assert_eq!(materials(BLOCK), [(Plane::Strain, Update::Small, 1.0)]);
    assert_eq!(
        materials(RINGS),
        [(Plane::Axisymmetric, Update::Total, 1.0)]
    );
    // A side of 3 by 2 has areas of 1, 4 and 1; a ring of radius 4.999 and length 1 has 2 pi r.
    let compliances = |text: &str| -> Vec<f64> {
        let contacts = scene(text).model.contacts;
        contacts
            .iter()
            .map(|contact| match contact.bond {
                Bond::Giving([normal, _]) => normal,
                _ => 0.0,
            })
            .collect()
    };
    for (given, area) in compliances(PLATES).iter().zip([1.0, 1.0, 4.0]) {
        assert!((given * 1e6 * area - 1.0).abs() < 1e-12);
    }
    // Surface to surface: points of the side share its area.
    let ring = std::f64::consts::TAU * 4.999;
    let gives = compliances(RINGS);
    let area: f64 = gives.iter().map(|given| 1.0 / (given * 1e7)).sum();
    assert!((area / ring - 1.0).abs() < 1e-12);
}

#[test]
fn loads_follow_their_amplitudes_over_the_steps() {
    let text = but(
        BLOCK,
        "*AMPLITUDE, NAME=FORTH",
        "*AMPLITUDE, NAME=ALONG, TIME=TOTAL TIME\n0., 0., 1.5, 3.\n*AMPLITUDE, NAME=FORTH",
    );
    let text = but(
        &text,
        "*END STEP",
        "*CLOAD, AMPLITUDE=ALONG\n2, 2, -2.\n*CLOAD\n1, 2, -1.\n1, 2, -0.5\n4, 2, -9.\n*DLOAD\n1, P1, 7.\n1, P3, 7.\n*END STEP",
    );
    let text = text.replacen(
        "*BOUNDARY, AMPLITUDE",
        "*CLOAD, OP=NEW\n2, 1, 4.\n*BOUNDARY, AMPLITUDE",
        1,
    );
    let loads = scene(&text).spec.loads;
    let forces: Vec<_> = loads
        .iter()
        .filter_map(|load| match load {
            LoadSpec::Force { node, x, y, scale } => {
                Some((node.as_str(), *x, *y, scale.as_slice()))
            }
            _ => None,
        })
        .collect();
    let down = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)];
    assert_eq!(forces[0], ("n.1", 0.0, -1.5, &down[..]));
    assert_eq!(
        forces[1],
        ("n.2", 4.0, 0.0, &[(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)][..])
    );
    assert_eq!(forces[2], ("n.2", 0.0, -4.0, &down[..]));
    let pressure = loads.iter().find_map(|load| match load {
        LoadSpec::Pressure { value, scale, .. } => Some((*value, scale.clone())),
        _ => None,
    });
    assert_eq!(
        pressure,
        Some((7.0, vec![(0.0, 0.0), (1.0, 1.0), (2.0, 1.0)]))
    );
}

#[test]
fn weight_is_density_times_acceleration_on_a_whole_body() {
    let dense = but(BLOCK, "*ELASTIC", "*DENSITY\n3.\n*ELASTIC");
    let heavy = but(
        &dense,
        "*END STEP",
        "*DLOAD\nBLOCK, GRAV, 10., 0., -2.\n*END STEP",
    );
    let loads = scene(&heavy).spec.loads;
    let volume = loads.iter().find_map(|load| match load {
        LoadSpec::Volume { on, x, y, .. } => Some((on.clone(), *x, *y)),
        _ => None,
    });
    assert_eq!(volume, Some(("EVERYTHING".to_owned(), 0.0, -30.0)));
    let half = heavy.replace("BLOCK, GRAV", "1, GRAV");
    assert!(
        refusal(&half).starts_with(
            "job.inp:53:1: the load acts on 1 of the 2 connected elements of EVERYTHING"
        ),
        "{}",
        refusal(&half)
    );
    let light = heavy.replace("*DENSITY\n3.\n", "");
    assert!(refusal(&light).contains("no *DENSITY"));
}

#[test]
fn errors_in_the_scene_have_the_line_of_the_deck() {
    let cases = [
        (
            "1000., 0.3",
            "1000., 0.5",
            "job.inp:31:1: materials[0].nu: ",
        ),
        (
            " 6, 2., 1.",
            " 6, 2., -1.",
            "job.inp:16:1: nodes[0].elements[0].nodes[1]: ",
        ),
        (
            "TOP, 2, 2, -0.02",
            "TOP, 2, 2, -2e15",
            "job.inp:49:1: loads[1].value: ",
        ),
        (
            "*SOLID SECTION, ELSET=EVERYTHING",
            "*SOLID SECTION, ELSET=BLOCK",
            "job.inp:18:1: element 9 has no section",
        ),
        (
            "TOP, 1, 1, 0.\n",
            "",
            "job.inp:54:1: the x of node 4 is free in earlier steps",
        ),
        (
            "*STEP\n*STATIC, DIRECT\n0.125",
            "*STEP, NLGEOM\n*STATIC, DIRECT\n0.125",
            "job.inp:51:1: NLGEOM must be set in all steps",
        ),
        (
            "*BOUNDARY, AMPLITUDE=FORTH",
            "*BOUNDARY, OP=NEW, AMPLITUDE=FORTH",
            "job.inp:51:1: OP=NEW frees the ",
        ),
        (
            "BELOW, ABOVE",
            "ABOVE, BELOW\n*CONTACT PAIR, INTERACTION=ROUGH, TYPE=NODE TO SURFACE, ADJUST=0.\nBELOW, ABOVE",
            "job.inp:41:1: ADJUST must be the same",
        ),
        (
            "TOP, 2, 2, -0.02\n",
            "TOP, 2, 2, -0.02\n4, 6, 6, 0.1\n",
            "job.inp:50:1: node 4 is not on a beam, so it has no rotation to prescribe",
        ),
        (
            "*END STEP",
            "*CLOAD\n1, 2, -1.\n*CLOAD, AMPLITUDE=FORTH\n1, 2, -1.\n*END STEP",
            "job.inp:53:1: the load is given again in this step, with another amplitude",
        ),
    ];
    for (from, to, begin) in cases {
        let found = refusal(&but(BLOCK, from, to));
        assert!(found.starts_with(begin), "{found}\nis not\n{begin}");
    }
}

/// OP=NEW removes the prescribed values of earlier steps: a value that is not repeated would become free, which is rejected.
#[test]
fn op_new_may_repeat_all_values_but_not_free_a_node() {
    let all = "GROUND, 1, 2\nTOP, 2, 2, -0.02\n";
    let card = |op: &str, lines: &str| {
        but(
            BLOCK,
            "*BOUNDARY, AMPLITUDE=FORTH\n",
            &format!("*BOUNDARY{op}\n{lines}*BOUNDARY{op}, AMPLITUDE=FORTH\n"),
        )
    };
    let spec = |text: &str| {
        format!(
            "{:?} {:?}",
            scene(text).spec.loads,
            scene(text).spec.supports
        )
    };
    assert_eq!(spec(&card(", OP=NEW", all)), spec(&card("", all)));
    for (missing, freed) in [
        ("GROUND, 1, 2\n", "node 101"),
        ("TOP, 2, 2, -0.02\n", "y of node 4"),
    ] {
        let told = refusal(&card(", OP=NEW", &but(all, missing, "")));
        assert!(
            told.contains("OP=NEW frees the ") && told.contains(freed),
            "{told}"
        );
    }
}

#[test]
fn op_new_removes_the_pressures_of_earlier_steps() {
    let first = but(
        BLOCK,
        "TOP, 2, 2, -0.02\n",
        "TOP, 2, 2, -0.02\n*DLOAD\n1, P4, 7.\n",
    );
    let second = |op: &str| {
        let text = but(
            &first,
            "*BOUNDARY, AMPLITUDE",
            &format!("*DLOAD{op}\n2, P2, 5.\n*BOUNDARY, AMPLITUDE"),
        );
        let loads = scene(&text).spec.loads;
        let scales = loads.iter().filter_map(|load| match load {
            LoadSpec::Pressure { value, scale, .. } => {
                Some((*value, scale.last().map(|last| last.1)))
            }
            _ => None,
        });
        scales.collect::<Vec<_>>()
    };
    assert_eq!(second(""), [(7.0, Some(1.0)), (5.0, Some(1.0))]);
    assert_eq!(second(", OP=NEW"), [(7.0, Some(0.0)), (5.0, Some(1.0))]);
}

#[test]
fn slave_surfaces_of_nodes_are_noted_with_their_reason() {
    let of_nodes = but(
        BLOCK,
        "*SURFACE, NAME=BELOW\nBLOCK, S1\n",
        "*SURFACE, NAME=BELOW, TYPE=NODE\n1\n2\n3\n",
    );
    let linear = but(&of_nodes, "=HARD", "=LINEAR\n1000., 1e-9");
    let (areas, sides) = (
        "job.inp:42: the slave is a surface of nodes: the areas for the stiffness",
        "job.inp:42: SURFACE TO SURFACE is solved as node to surface, because the slave is a surface of nodes",
    );
    let has = |text: &str, begin: &str| {
        let remarks = scene(text).remarks;
        remarks.iter().any(|remark| remark.starts_with(begin))
    };
    let [hard_areas, hard_sides] = [areas, sides].map(|note| note.replace(":42:", ":41:"));
    assert!(has(&linear, areas) && !has(&linear, sides));
    assert!(!has(&of_nodes, &hard_areas) && !has(&of_nodes, &hard_sides));
    assert!(has(&but(&of_nodes, "0.4\n", "0.4, 1e5\n"), &hard_areas));
    let faces = but(&linear, "TYPE=NODE TO", "TYPE=SURFACE TO");
    assert!(has(&faces, areas) && has(&faces, sides));
}

#[test]
fn a_pair_may_name_sides_of_bodies_only_and_none_that_it_touches() {
    let text = r#"(
        title: "a block over a line",
        nodes: [
            Given(id: "n", nodes: [(1, 0.0, 0.0), (2, 1.0, 0.0), (3, 1.0, 1.0), (4, 0.0, 1.0)],
                elements: [(part: "p", kind: quad4, nodes: [[1, 2, 3, 4]])],
                sides: [(name: "bottom", sides: [[1, 2]]), (name: "top", sides: [[3, 4]])]),
            Line(id: "f", from: (2.0, -0.5), to: (-1.0, -0.5), elements: 1, per_element: 2),
        ],
        materials: [Elastic(id: "m", E: 1.0, nu: 0.3)],
        bodies: [Solid(id: "b", mesh: "n", material: "m")],
        surfaces: [(id: "f", along: "f"), (id: "t", along: "n.top")],
        slaves: [(nodes: ["n.bottom"], on: ["f", "t"], sides: ["SIDE"])],
        friction: (angle: 10.0),
        supports: [(node: "n.3", fix: [x, y]), (node: "n.4", fix: [x, y])],
        loads: [Force(node: "n.1", y: -1.0)],
        history: (path: [0.0, 1.0], increment: 1.0),
    )"#;
    let read = |side: &str| Scene::from_text("scene.ron", &text.replace("SIDE", side), &[]);
    assert!(read("n.bottom").is_ok(), "{:?}", read("n.bottom").err());
    for (side, why) in [
        ("f", "not sides of the elements"),
        ("n.top", "that the nodes touch"),
    ] {
        let message = read(side).map(drop).unwrap_err().to_string();
        assert!(message.contains(why), "{side}: {message}");
    }
    let apart = text
        .replace("\"f\", \"t\"]", "\"f\"]")
        .replace("SIDE", "n.top");
    let message = Scene::from_text("scene.ron", &apart, &[])
        .map(drop)
        .unwrap_err();
    assert!(
        message.to_string().contains("among the pair's nodes"),
        "{message}"
    );
}

/// A pair names its sides only where they do not follow from the nodes; a name must be that of a chain.
#[test]
fn a_pair_names_its_sides_where_they_do_not_follow_from_the_nodes() {
    assert!(
        scene(BLOCK)
            .spec
            .slaves
            .iter()
            .all(|own| own.sides.is_empty())
    );
    // The ends of the block have all their nodes in this surface, too.
    let both = but(BLOCK, "BLOCK, S1\n", "BLOCK, S1\nBLOCK, S3\n");
    let mut spec = scene(&both).spec;
    assert_eq!(spec.slaves[0].sides, ["n.BELOW-SIDES", "n.BELOW-SIDES-2"]);
    spec.slaves[0].sides[0] = "n.BESIDE".to_owned();
    let error = Scene::from_spec("scene.ron", spec).map(drop).unwrap_err();
    let message = error.to_string();
    assert!(
        message.contains("slaves[0].sides[0]: ") && message.contains("n.BESIDE"),
        "{message}"
    );
}

#[test]
fn nodes_of_beams_are_not_reported_as_idle() {
    let beam = include_str!("../../../tests/decks/beam-on-a-post.inp");
    assert_eq!(scene(beam).names().notes(1), [""; 0]);
}

#[test]
fn include_files_must_be_in_the_folder_of_the_deck() {
    for outside in ["../mesh.inp", "/etc/passwd", "a/../../b"] {
        let found = refusal(&format!("*INCLUDE, INPUT={outside}\n"));
        assert!(
            found.starts_with("job.inp:1:1: ") && found.contains("must be in the same folder"),
            "{found}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_damaged_deck_makes_compilation_panic(
        deck in prop::sample::select(vec![BLOCK, PLATES, RINGS]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..4usize), 1..5),
    ) {
        let mut lines: Vec<String> = deck.lines().map(str::to_owned).collect();
        for (at, other, kind) in changes {
            let (at, other) = (at.index(lines.len()), other.index(lines.len()));
            match kind {
                0 => lines.swap(at, other),
                1 => lines[at] = lines[other].clone(),
                2 => lines[at] = lines[at].replace('1', "-1"),
                _ => { lines.remove(at); if lines.is_empty() { lines.push(String::new()); } }
            }
        }
        if let Err(error) = Scene::from_text("job.inp", &lines.join("\n"), &[]) {
            prop_assert!(!error.message.is_empty());
        }
    }
}
