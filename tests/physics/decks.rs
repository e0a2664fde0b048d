//! Decks of CalculiX: what they mean is what a scene written by hand means, or what a closed form says.

use crate::common::{Run, last, run, scene};
use crate::outside::trial::{End, attempt};
use stickslip::scene::Scene;

fn solved(name: &str) -> Run {
    let run = run(&scene(name, &[]));
    assert!(run.failure.is_none(), "{name}: {:?}", run.failure);
    run
}

/// A deck with another text in a place, solved to its end.
fn changed(name: &str, changes: &[(&str, &str)]) -> Run {
    let mut text = std::fs::read_to_string(name).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from:?}");
        text = text.replace(from, to);
    }
    let scene = Scene::from_text(name, &text, &[]).unwrap_or_else(|e| panic!("{e}"));
    let run = run(&scene);
    assert!(run.failure.is_none(), "{name}: {:?}", run.failure);
    run
}

fn near(a: f64, b: f64, part: f64) {
    assert!((a - b).abs() <= part * b.abs(), "{a:e} and {b:e}");
}

#[test]
fn a_deck_and_a_scene_written_by_hand_have_the_same_answers() {
    for name in ["press-and-push", "pressed-plates"] {
        let [deck, own] = ["inp", "ron"].map(|end| solved(&format!("tests/decks/{name}.{end}")));
        assert_eq!(deck.accepted.len(), own.accepted.len());
        for (ours, theirs) in deck.accepted.iter().zip(&own.accepted) {
            assert_eq!(ours.load, theirs.load);
            for (monitor, value) in &theirs.monitors {
                let size = theirs
                    .monitors
                    .values()
                    .fold(0.0, |most: f64, v| most.max(v.abs()));
                let apart = (ours.monitors[monitor] - value).abs();
                assert!(
                    apart <= 1e-9 * size,
                    "{name}, load {}: {monitor}",
                    ours.load
                );
            }
        }
    }
}

/// Forces 100, 400, 100 at the ends and the middle are a uniform pressure of 100 by area: p = 600 / (3 * 2), to first order in
/// p / E = 0.0014 the top goes down by 4 p / E + p / K.
#[test]
fn the_pressed_plates_give_way_by_their_stiffness_and_the_penalty() {
    let run = changed(
        "tests/decks/pressed-plates.inp",
        &[("-100.", "-1."), ("-400.", "-4.")],
    );
    near(last(&run, "contact y"), 6.0, 1e-9);
    near(last(&run, "u_y 17"), -(4.0 / 70000.0 + 1.0 / 1e6), 1e-4);
}

/// Lamé: two rings of one material with radii a, b, c and an overlap d at b, free along their axis, press by
/// p = E d / (2 b^3) (b^2 - a^2) (c^2 - b^2) / (c^2 - a^2); over a penalty K the overlap has p / K to give as well.
#[test]
fn the_shrunk_ring_presses_as_lame_says() {
    let run = solved("tests/decks/shrunk-ring.inp");
    let (a, b, c): (f64, f64, f64) = (4.0, 5.0, 6.0);
    let area = std::f64::consts::TAU * b;
    let soft = 2.0 * b.powi(3) * (c * c - a * a) / (210000.0 * (b * b - a * a) * (c * c - b * b))
        + 1.0 / 1e7;
    // One element across each wall: the interface bends a little with its free end.
    near(last(&run, "contact x") / area, 0.001 / soft, 0.01);
}

#[test]
fn a_press_fit_does_not_hang_on_its_increments() {
    let [one, many] = ["1., 1.", "0.125, 1."]
        .map(|size| changed("tests/decks/shrunk-ring.inp", &[("0.5, 1.", size)]));
    assert!(many.accepted.len() > one.accepted.len());
    for (monitor, value) in &one.accepted.last().unwrap().monitors {
        assert!((last(&many, monitor) - value).abs() < 1e-7, "{monitor}");
    }
}

/// Tension 3 on a square of side 1 of two blocks, E = 100: the top goes up by 2 * 3 / 100.
#[test]
fn a_tie_holds_in_tension_as_if_it_were_one_body() {
    let run = changed(
        "tests/decks/glued.inp",
        &[
            ("*END STEP", "*NODE PRINT, NSET=TOP\nU\n*END STEP"),
            ("*MATERIAL", "*NSET, NSET=TOP\n13, 14\n*MATERIAL"),
        ],
    );
    near(last(&run, "u_y 13"), 0.06, 1e-9);
    near(last(&run, "contact y"), -3.0, 1e-9);
}

/// The nodes at the edges start at the ends of the master and move past them. CalculiX 2.20 has 4.949201 and 117.2592.
#[test]
fn blocks_that_end_at_the_same_edges_stay_in_contact_there() {
    let name = "tests/decks/flush-blocks.inp";
    let run = solved(name);
    near(last(&run, "contact x"), -4.949201, 1e-3);
    near(last(&run, "contact y"), 117.2592, 1e-3);
}

/// Without friction a node that is past the end bulges out by 1e-5 while it touches, and would be freed and caught in turn.
#[test]
fn a_node_that_starts_at_an_end_stays_or_leaves_and_breaks_no_law() {
    let text = r#"(
        title: "Two blocks that end at the same edges",
        nodes: [
            Block(id: "low", corners: [(0.0, 0.0), (1.0, 1.0)], elements: (4, 4), element: quad4),
            Block(id: "up", corners: [(0.0, 1.0), (1.0, 2.0)], elements: (6, 6), element: quad4),
        ],
        materials: [Elastic(id: "m", E: 1000.0, nu: 0.3)],
        bodies: [Solid(id: "low", mesh: "low", material: "m"), Solid(id: "up", mesh: "up", material: "m")],
        surfaces: [(id: "low", along: "low.top", past_ends: 0.001)],
        slaves: [(nodes: ["up.bottom"], on: ["low"])],
        friction: (angle: 0.0),
        supports: [(node: "low.bottom", fix: [x, y])],
        loads: [
            Displacement(node: "up.top", component: y, value: -0.001),
            Displacement(node: "up.top", component: x, value: 0.0003),
        ],
        history: (path: [0.0, 1.0], increment: 0.25),
        monitors: [(name: "f_y", of: Contact(component: y))],
    )"#;
    // With the longer margin the node still touches in the end, so the force is larger.
    let [left, kept, _] =
        [("0.001", "false"), ("0.002", "false"), ("0.001", "true")].map(|(past_ends, smooth)| {
            let set = [
                ("surfaces.low.past_ends", past_ends),
                ("surfaces.low.smooth", smooth),
            ];
            let set = set.map(|(path, value)| (path.to_owned(), value.to_owned()));
            let scene = Scene::from_text("t.ron", text, &set).unwrap_or_else(|e| panic!("{e}"));
            let trial = attempt(&scene);
            assert_eq!(
                (trial.end, trial.wrong),
                (End::Finished, Vec::new()),
                "{past_ends} {smooth}"
            );
            last(&run(&scene), "f_y")
        });
    assert!(kept > 1.01 * left, "{kept} {left}");
}

/// Without the post the tip goes down by F l^3 / (3 E I) + P a^2 (3 l - a) / (6 E I) and, with shear, (F l + P a) / GA.
#[test]
fn a_beam_bends_by_its_section() {
    let run = changed(
        "tests/decks/beam-on-a-post.inp",
        &[
            ("-0.1\n5, 2, -0.05", "-1e-4\n5, 2, -5e-5"),
            ("*CLOAD", "*NODE PRINT, NSET=END\nU\n*CLOAD"),
            ("*MATERIAL", "*NSET, NSET=END\n5\n*MATERIAL"),
        ],
    );
    let (young, i, area) = (200000.0, 0.1 * 0.2_f64.powi(3) / 12.0, 0.1 * 0.2);
    let shear = 5.0 / 6.0 * area * young / 2.6;
    let (l, a, tip, middle) = (4.0_f64, 2.0_f64, 5e-5, 1e-4);
    let bent = tip * l.powi(3) / 3.0 + middle * a * a * (3.0 * l - a) / 6.0;
    // Elements of three nodes with two points are exact at nodes for point loads.
    near(
        last(&run, "u_y 5"),
        -(bent / (young * i) + (tip * l + middle * a) / shear),
        1e-6,
    );
}

#[test]
fn an_adjusted_gap_is_closed_before_the_first_step() {
    let text = std::fs::read_to_string("tests/decks/press-and-push.inp").unwrap();
    let lower = text
        .replace("103, 4., 0.", "103, 4., -0.01")
        .replace("104, -2., 0.", "104, -2., -0.01");
    let adjusted = lower.replace("TYPE=NODE TO SURFACE", "TYPE=NODE TO SURFACE, ADJUST=0.02");
    for (text, height) in [(lower, 0.0), (adjusted, -0.01)] {
        let scene = Scene::from_text("job.inp", &text, &[]).unwrap();
        for contact in &scene.model.contacts {
            assert!((scene.model.nodes[contact.node].at[1] - height).abs() < 1e-15);
        }
    }
}

/// CalculiX 2.20 prints 0.7214191 and -5.981414 at the end. It looks for the foot of a node on the element as it is, and here
/// surfaces that give way are smooth, so that some parts in a thousand are left.
#[test]
fn blocks_on_springs_are_sheared_as_calculix_does_it() {
    let name = "tests/decks/sheared-blocks.inp";
    let deck = scene(name, &[]);
    assert!(!deck.model.surfaces[0].smooth.is_empty());
    let run = solved(name);
    near(last(&run, "contact x"), -0.7214191, 5e-3);
    near(last(&run, "contact y"), 5.981414, 1e-3);
    // Its normal jumps at the corners of elements, and nodes inside hop there.
    let kinked = stickslip::record::export::written::scene(&deck).unwrap();
    let kinked = kinked.replace("smooth: true", "smooth: false");
    let kinked = Scene::from_text("kinked.ron", &kinked, &[]).unwrap();
    let told = stickslip::scene::cost::Cost::from_scene(&kinked).to_string();
    assert!(
        told.contains("M: may have kinks when they deform"),
        "{told}"
    );
}

#[test]
fn a_deck_is_written_as_a_scene_that_is_the_same() {
    for name in [
        "press-and-push",
        "pressed-plates",
        "shrunk-ring",
        "glued",
        "beam-on-a-post",
        "sheared-blocks",
    ] {
        let deck = scene(&format!("tests/decks/{name}.inp"), &[]);
        let written = stickslip::record::export::written::scene(&deck).unwrap();
        let read = Scene::from_text("scene.ron", &written, &[]).unwrap();
        assert_eq!(read.model, deck.model, "{name}");
    }
}
