//! A stored exchange of a solver in space in the terminal: arrows, the angle, the friction circle and the views of the shape.

use serde_json::{Value as Json, json};
use stickslip::recorded::exchange;
use stickslip::recorded::recording::Recording;
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::tui::Debugger;
use stickslip::tui::theme::Theme;

/// A tetrahedron on a plane; node a slides, and its friction has this direction.
fn state(minor: u32, degrees: f64) -> Json {
    let (sin, cos) = degrees.to_radians().sin_cos();
    json!({"type": "state", "at": {"increment": 1, "minor": minor}, "ended": "iteration", "residual": {"relative": 0.5},
        "contacts": [{"mode": "sliding", "next": "sliding", "gap": 0, "f_n": 10, "f_t": [3.0 * cos, 3.0 * sin],
                      "limit": 3, "slip": [0.01, 0]}]})
}

fn debugger(degrees: &[f64]) -> Debugger {
    let scene = json!({"type": "scene", "title": "A tetrahedron", "dimension": 3,
        "nodes": [{"name": "a", "at": [0, 0, 0]}, {"name": "b", "at": [2, 0, 0.5]}, {"name": "c", "at": [0, 1, 0.5]},
                  {"name": "d", "at": [0, 0, 3]}, {"at": [-1, -1, 0]}, {"at": [3, -1, 0]}, {"at": [3, 2, 0]}, {"at": [-1, 2, 0]}],
        "faces": [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]],
        "surfaces": [{"name": "plane", "faces": [[4, 5, 6, 7]], "rigid": true}],
        "contacts": [{"id": 1, "node": 0, "surface": "plane", "friction": {"mu": 0.3}, "mode": "sliding"}]});
    let hello = json!({"type": "hello", "protocol": 2, "name": "Toy", "abilities": {}});
    let mut text = format!("# stickslip exchange 1\n# started: toy\n< {hello}\n< {scene}\n");
    for (degrees, minor) in degrees.iter().zip(1..) {
        text += &format!(
            "> {}\n< {}\n",
            json!({"type": "step"}),
            state(minor, *degrees)
        );
    }
    let opened = exchange::open("space", &text).unwrap();
    let session = Session::recorded(Recording::Exchange(Box::new(opened)));
    Debugger::new(Theme::mono(), Vec::new(), Some(session))
}

#[test]
fn whole_screens_of_a_solver_in_space() {
    let mut debugger = debugger(&[10.0, 60.0, 100.0, 150.0, 190.0, -120.0, -90.0, -30.0]);
    debugger.type_keys("8 s");
    for (width, height) in [(80, 24), (120, 40)] {
        insta::assert_snapshot!(
            format!("space-{width}x{height}"),
            debugger.text(width, height)
        );
    }
    for (keys, name) in [("t", "timeline"), ("E", "circle")] {
        debugger.type_keys(keys);
        insta::assert_snapshot!(format!("space-{name}"), debugger.text(80, 24));
    }
    let timeline = ["→", "↗", "↑", "↖", "←", "↙", "↓", "↘"];
    debugger.type_keys("t");
    let shown = debugger.text(80, 24);
    let row = shown
        .lines()
        .find(|line| line.contains("▸a"))
        .expect("node a");
    assert!(timeline.iter().all(|arrow| row.contains(arrow)), "{row}");
}

/// No table decides on one contact alone.
#[test]
fn the_card_of_a_sweep_has_no_table() {
    let text = "Contacts(title: \"t\", tangents: 2, contacts: [(id: \"a\", friction: (angle: 20))],
        matrix: Compliance([[1, 0, 0], [0, 1, 0], [0, 0, 1]]), free: [-1, 0.25, 0.5])";
    let scene = Scene::from_text("space", text, &[]).unwrap();
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), Some(Session::new(scene)));
    debugger.type_keys("s e");
    let shown = debugger.text(120, 40);
    assert!(
        shown.contains(" free → sliding ") && !shown.contains("→ fixed"),
        "{shown}"
    );
}

#[test]
fn the_shape_has_three_views() {
    let mut debugger = debugger(&[0.0]);
    debugger.type_keys("s");
    let views = ["oblique", "top", "side"].map(|word| {
        let shown = debugger.text(120, 40);
        assert!(
            shown.contains(&format!("{word} view (V)")),
            "{word}\n{shown}"
        );
        debugger.type_keys("V");
        shown
    });
    assert_ne!(views[0], views[1]);
    assert_ne!(views[1], views[2]);
}
