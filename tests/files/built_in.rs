//! Built-in scenes are sound, found, and numbered as the solver wants.

use crate::scenes::{PINNED, pinned, with};
use stickslip::contact::projection::{project, projection_at};
use stickslip::model::BodyKind;
use stickslip::scene::cost::Cost;
use stickslip::scene::{Scene, builtin};

#[test]
fn every_builtin_scene_is_sound_and_has_a_title() {
    for builtin in builtin::list() {
        let scene = Scene::open(builtin.name, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(!scene.model.title.is_empty());
        assert_eq!(builtin::title(builtin), scene.model.title);
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
            // What the source reports.
            name if name.starts_with("bench-") => Vec::new(),
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
    for folder in ["problems", "problems/benchmarks"] {
        let folder = format!("{}/{folder}", env!("CARGO_MANIFEST_DIR"));
        for entry in std::fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap();
            let name = entry.file_name().into_string().unwrap();
            if entry.path().is_dir() || name == "table.ron" {
                continue;
            }
            assert!(
                builtin::find(&name).is_some(),
                "{name} is not in the table of built-in scenes"
            );
        }
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
fn an_unknown_scene_is_answered_with_those_that_there_are() {
    let error = Scene::open("01-pinned-beam-rough-flor", &[])
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("did you mean \"01-pinned-beam-rough-floor\"?"),
        "{error}"
    );
    assert!(error.contains("stickslip list"), "{error}");
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
            // What is pressed together over the first leg starts inside.
            let gap = projection_at(&model.surfaces, spot, &positions, at).gap + slave.overlap;
            assert!(gap > -1e-12 * model.length, "{}: {gap}", builtin.name);
        }
        assert!(over > 0, "{}", builtin.name);
    }
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
fn cost_counts_what_the_model_has() {
    for builtin in builtin::list() {
        let scene = Scene::open(builtin.name, &[("refine".into(), "2".into())]).unwrap();
        let cost = Cost::from_scene(&scene);
        let bodies = cost.translations + cost.rotations + cost.shears + cost.forces;
        assert_eq!(bodies, scene.model.dofs.equations, "{}", builtin.name);
        assert_eq!(cost.unknowns(), bodies + 2 * scene.model.contacts.len());
    }
    let text = Cost::from_scene(&Scene::open(PINNED, &[]).unwrap()).to_string();
    for line in [
        "shear forces            4",
        "          unknowns on surface floor: rigid",
        "without   shear deformation of beam: GA is not given",
    ] {
        assert!(text.contains(line), "{text}");
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
        assert!(error.contains("settings.memory sets the limit"), "{error}");
        let is_early = refine == "40000";
        assert_eq!(
            error.contains("sets the limit to 0.5 GB"),
            is_early,
            "{error}"
        );
    }
    let error = large("1", "0").unwrap_err();
    assert!(
        error.contains("must be a positive number of gigabytes"),
        "{error}"
    );
}
