//! What a sound scene means: loads, supports, regions, monitors, and settings from outside.

use crate::scenes::{
    BLOCK, ELASTIC, EVERYTHING, LINE, PINNED, SOLID, assert_usable, changed, pinned, small, solid,
    with,
};
use stickslip::format::{Spec, notation, paths};
use stickslip::model::BoundUpdate;
use stickslip::model::Model;
use stickslip::model::{BodyKind, MonitorQuantity};
use stickslip::scene::cost::Cost;
use stickslip::scene::{Scene, builtin};

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
    let materials: Vec<usize> = made.elements.iter().map(|e| e.material).collect();
    assert_eq!(materials, [0, 0, 1, 1, 0, 0, 1, 1]);
    let text = Cost::from_scene(&scene).to_string();
    for line in [
        "k: solid, 8 elements of 8 nodes, E 100, nu 0.3, St Venant-Kirchhoff, plane strain, thickness 1",
        "memory of earlier increments in k: update is total",
    ] {
        assert!(text.contains(line), "{text}");
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
    assert_eq!(model.monitors[0].of, MonitorQuantity::Reaction { dof: 2 });
    assert_eq!(
        model.monitors[1].of,
        MonitorQuantity::Displacement { dof: 7 }
    );
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
    let cases = "\
        friction.angle=95 | --set friction.angle=95: the friction angle is 95.0
        friction.angel=20 | did you mean friction.angle?
        friction=3 | it has friction.angle, friction.cohesion
        settings.t_max=foo | it must be one of lagged, consistent
        settings.foo=1 | settings has settings.strategy
        refine=-1 | \"-1\" is not valid; it must be a whole number that is neither negative nor huge
        settings.majors=4294967296 | it must be a whole number that is neither negative nor huge
        refine=1.5 | it must be a whole number
        refine=0 | --set refine=0: refine is 0
        nodes.beam.elments=2 | did you mean nodes.beam.elements?
        history.increment=nan | it must be a number
        surfaces.floor.reverse=yes | it must be true or false
        bodies.beam.material=x | --set bodies.beam.material=x: no material called
        =x | the scene has no value";
    for case in cases.lines() {
        let (change, expected) = case.trim().split_once(" | ").unwrap();
        let (path, value) = change.split_once('=').unwrap();
        let error = with(path, value).expect_err(path).to_string();
        assert!(
            error.contains(expected),
            "{path}={value}\n got: {error}\nwant: {expected}"
        );
    }
}

#[test]
fn none_is_an_absent_value_in_the_file_and_from_outside() {
    let given = |value: &str| {
        let (rest, history) = (
            format!("GA: {value}, EI"),
            format!("increment: 0.01, least: {value}"),
        );
        let text = pinned()
            .replace("EI", &rest)
            .replace("increment: 0.01", &history);
        Scene::from_text("x.ron", &text, &[])
    };
    let scene = given("none").unwrap();
    assert_eq!(scene.spec, Scene::open(PINNED, &[]).unwrap().spec);
    let scene = given("0.001").unwrap();
    assert_eq!(scene.spec.history.least, Some(0.001));
    assert_eq!(
        scene
            .with("history.least", "none")
            .unwrap()
            .spec
            .history
            .least,
        None
    );
    let error = changed("angle: 30.0", "angle: none")
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("friction.angle: none is not valid; it must be a number"),
        "{error}"
    );
}

#[test]
fn values_without_effect_are_noted() {
    let notes = |from: &str, to: &str| changed(from, to).unwrap().spec.notes();
    assert_eq!(notes("", ""), [""; 0]);
    assert_eq!(
        notes("x: -1.0)", "x: -1.0, scale: [(0, 0)])"),
        ["loads[0] is 0 at every load factor (scale)"]
    );
    assert_eq!(
        notes("start: sliding)]", "start: free, state: (f_n: -1))]"),
        ["slaves[0].state: f_n and f_t have no effect on nodes that start free"]
    );
}

#[test]
fn friction_of_a_group_is_the_scenes_until_it_is_set() {
    let own = with("slaves[0].friction.cohesion", "0.5").unwrap();
    let error = own.with("friction.angle", "20").unwrap_err().to_string();
    assert!(
        error.contains(
            "no effect where every pair has its own friction; set slaves[0].friction.angle"
        ),
        "{error}"
    );
    assert_eq!(own.model.contacts[0].friction.cohesion, 0.5);
    assert_eq!(own.model.contacts[0].friction.angle, 30.0);
    assert_eq!(own.spec.friction.cohesion, 0.0);
}

#[test]
fn a_scene_survives_being_written_and_read() {
    for builtin in builtin::list() {
        let scene = Scene::open(builtin.name, &[]).unwrap();
        let pretty = ron::ser::PrettyConfig::default();
        let text = notation::options()
            .to_string_pretty(&scene.spec, pretty)
            .unwrap();
        let again: Spec = notation::options().from_str(&text).unwrap();
        assert_eq!(again, scene.spec);
        let model: Model = Scene::from_spec("again", again).unwrap().model;
        assert_eq!(model, scene.model);
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
