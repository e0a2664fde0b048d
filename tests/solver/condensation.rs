//! Minor iterations on the condensed interface (eqn 6) are those on the whole system (eqn 9), whatever the bodies.

use crate::common::{Run, run};
use stickslip::linear::singular::Singular;
use stickslip::scene::Scene;
use stickslip::step::event::Failure;
use stickslip::step::state::Status;

/// A block on a longer one that is held below, with what else a slave and the scene have.
fn blocks(slave: &str, rest: &str) -> String {
    format!(
        "(title: \"t\", nodes: [Block(id: \"low\", corners: [(0, 0), (3, 1)], elements: (6, 2)),
            Block(id: \"up\", corners: [(0.75, 1), (2.25, 1.6)], elements: (3, 2))],
        materials: [Elastic(id: \"m\", E: 100, nu: 0.3)],
        bodies: [Solid(id: \"low\", mesh: \"low\", material: \"m\"), Solid(id: \"up\", mesh: \"up\", material: \"m\")],
        surfaces: [(id: \"top\", along: \"low.top\")], slaves: [(nodes: [\"up.bottom\"], on: [\"top\"]{slave})],
        supports: [(node: \"low.bottom\", fix: [x, y])], history: (path: [0, 1], increment: 0.2), {rest})"
    )
}

/// The upper block is held by its contact alone, and pushed down and aside.
const FLOATING: &str = "friction: (angle: 25),
    loads: [Traction(along: \"up.top\", y: -3), Traction(along: \"up.top\", x: 0.6)],
    monitors: [(name: \"x\", of: Displacement(node: \"up.1\", component: x)), (name: \"f\", of: Contact(component: x))]";

/// It is moved by its upper side.
const MOVED: &str = "friction: (angle: 15),
    loads: [Displacement(node: \"up.top\", component: y, value: -0.05), Displacement(node: \"up.top\", component: x, value: 0.1)],
    monitors: [(name: \"f\", of: Contact(component: x)), (name: \"n\", of: Contact(component: y))]";

/// A beam pressed on a solid, the beam with the shear stiffness GA, or shear-rigid.
const ON_SOLID: &str = "(title: \"t\", nodes: [Line(id: \"b\", from: (0, 1.05), to: (3, 1.05), elements: 6, per_element: 3),
        Block(id: \"low\", corners: [(0, 0), (3, 1)], elements: (6, 2))],
    materials: [Elastic(id: \"m\", E: 100, nu: 0.3), Section(id: \"s\", EA: 1000, EI: 2GA)],
    bodies: [Solid(id: \"low\", mesh: \"low\", material: \"m\"), Beam(id: \"b\", along: \"b\", material: \"s\")],
    surfaces: [(id: \"top\", along: \"low.top\")], slaves: [(nodes: [\"b.all\"], on: [\"top\"])],
    friction: (angle: 15), supports: [(node: \"low.bottom\", fix: [x, y]), (node: \"b.start\", fix: [x, y, rotation])],
    loads: [Traction(along: \"b\", y: -1)], history: (path: [0, 1], increment: 0.25),
    monitors: [(name: \"y\", of: Displacement(node: \"b.end\", component: y)), (name: \"n\", of: Contact(component: y))])";

fn solve(text: &str, solver: &str) -> Run {
    let set = [("settings.solver", solver), ("settings.factor", "each")];
    let set = set.map(|(path, value)| (path.to_string(), value.to_string()));
    run(&Scene::from_text("scene", text, &set).unwrap_or_else(|e| panic!("{e}")))
}

#[test]
fn solids_and_beams_take_the_same_steps_condensed_and_whole() {
    for text in [
        blocks(", start: fixed", FLOATING),
        blocks("", MOVED),
        ON_SOLID.replace("GA", ", GA: 500"),
        ON_SOLID.replace("GA", ""),
    ] {
        let (whole, condensed) = (solve(&text, "augmented"), solve(&text, "condensed"));
        for run in [&whole, &condensed] {
            let status = &run.stepper.state().status;
            assert_eq!(*status, Status::Finished, "{:?}\n{text}", run.failure);
        }
        assert_eq!(whole.accepted.len(), condensed.accepted.len());
        for (a, b) in whole.accepted.iter().zip(&condensed.accepted) {
            assert!(a.majors.abs_diff(b.majors) <= 1, "load {}\n{text}", a.load);
            for (name, value) in &a.monitors {
                let apart = (value - b.monitors[name]).abs();
                assert!(
                    apart < 1e-9 * (1e-3 + value.abs()),
                    "{name} load {}: {apart:e}\n{text}",
                    a.load
                );
            }
        }
    }
}

#[test]
fn a_solid_that_nothing_holds_is_named_condensed_too() {
    for solver in ["augmented", "condensed"] {
        let loose = ON_SOLID
            .replace("GA", ", GA: 500")
            .replace("fix: [x, y, r", "fix: [x, r");
        let by_table_2 =
            |text: &str| text.replace("history:", "settings: (strategy: table2), history:");
        let loose = by_table_2(&loose);
        let run = solve(&loose, solver);
        let failure = run.failure.as_ref().map(|(_, failure)| failure);
        assert!(
            matches!(failure, Some(Failure::Singular(Singular::Rigid { .. }))),
            "{solver}: {failure:?}"
        );
        let text = blocks(", start: fixed", FLOATING).replace("1), (2.25, 1.6)", "2), (2.25, 2.6)");
        let text = text.replace("start: fixed", "start: free");
        let run = solve(&by_table_2(&text), solver);
        let Some((_, Failure::Singular(Singular::Rigid { motions }))) = &run.failure else {
            panic!("{solver}: {:?}", run.failure)
        };
        assert_eq!(motions.len(), 3, "{solver}: {motions:?}");
        assert!(motions.iter().all(|m| m.body == "up"), "{solver}");
    }
}
