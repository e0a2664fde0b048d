//! What several test programs share: scenes run to their end, and reference tables.
#![allow(dead_code)]

use std::collections::HashMap;
use std::sync::Arc;
use stickslip::explain::page::DiagnosisPage;
use stickslip::model::Model;
use stickslip::record::command::Command;
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::step::event::{Event, Failure, Outcome};
use stickslip::step::intervene::Intervention;
use stickslip::step::state::State;
use stickslip::step::stepper::Stepper;

/// Settings as `Scene::open` takes them.
pub fn owned(set: &[(&str, &str)]) -> Vec<(String, String)> {
    let pair = |(path, value): &(&str, &str)| (path.to_string(), value.to_string());
    set.iter().map(pair).collect()
}

/// A scene with `--set` like overrides.
pub fn scene(name: &str, overrides: &[(&str, &str)]) -> Scene {
    Scene::open(name, &owned(overrides)).unwrap_or_else(|e| panic!("{e}"))
}

/// The scene of a text.
pub fn read(text: &str) -> Scene {
    Scene::from_text("scene.ron", text, &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// One accepted increment.
pub struct Accepted {
    pub load: f64,
    pub majors: u32,
    pub minors: u32,
    pub monitors: HashMap<String, f64>,
    pub event: Event,
    pub state: State,
}

/// A run, as far as it came.
pub struct Run {
    pub stepper: Stepper,
    pub accepted: Vec<Accepted>,
    pub failure: Option<(Event, Failure)>,
    pub steps: usize,
}

/// Steps to the end of the history or the first failure.
pub fn run(scene: &Scene) -> Run {
    let stepper = Stepper::new(Arc::new(scene.model.clone()));
    go_on(Run {
        stepper,
        accepted: Vec::new(),
        failure: None,
        steps: 0,
    })
}

/// A run that reaches the end of its history.
#[track_caller]
pub fn finished(scene: &Scene) -> Run {
    let run = run(scene);
    assert!(run.failure.is_none(), "{:?}", run.failure);
    run
}

/// A monitor in the last accepted increment.
pub fn last(run: &Run, monitor: &str) -> f64 {
    run.accepted.last().unwrap().monitors[monitor]
}

/// Goes on with a run, for example after an intervention.
pub fn go_on(mut run: Run) -> Run {
    run.failure = None;
    while let Some(event) = run.stepper.step().cloned() {
        run.steps += 1;
        match &event.outcome {
            Outcome::Increment { .. } => {
                let mut values = Vec::new();
                run.stepper.monitors(&mut values);
                let names = run.stepper.model().monitors.iter().map(|m| m.name.clone());
                run.accepted.push(Accepted {
                    load: event.load_factor,
                    majors: event.position.major,
                    minors: event.position.minor,
                    monitors: names.zip(values).collect(),
                    state: run.stepper.state().clone(),
                    event,
                });
            }
            Outcome::Failed(failure) => {
                run.failure = Some((event.clone(), failure.clone()));
                break;
            }
            _ => {}
        }
    }
    run
}

/// Forces a slave node in a run that failed.
pub fn force(run: &mut Run, slave: usize, mode: stickslip::model::Mode, hold: bool) {
    force_in(&mut run.stepper, slave, mode, hold);
}

/// Forces a slave node.
pub fn force_in(stepper: &mut Stepper, slave: usize, mode: stickslip::model::Mode, hold: bool) {
    stepper
        .intervene(&Intervention::Force { slave, mode, hold })
        .unwrap();
}

/// A reference table: rows of named text fields.
pub fn table(file: &str) -> Vec<HashMap<String, String>> {
    let path = format!("{}/tests/references/{file}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|l| !l.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|l| {
            header
                .iter()
                .map(|h| h.to_string())
                .zip(l.split(',').map(String::from))
                .collect()
        })
        .collect()
}

/// A number of a reference row.
pub fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column]
        .parse()
        .unwrap_or_else(|_| panic!("{column}: {:?}", row[column]))
}

/// The order of convergence from a coarse to a fine error, where the mesh or the increment was divided by `finer`.
pub fn order(coarse: f64, fine: f64, finer: f64) -> f64 {
    (coarse / fine).ln() / finer.ln()
}

/// Two strips pressed on each other, the lower one held below, `refine` times finer than 25 slave nodes: with 8, 193
/// slave nodes and about 10,000 unknowns.
pub fn two_blocks(refine: usize) -> Scene {
    let text = format!(
        r#"(
    title: "Two strips pressed on each other",
    refine: {refine},
    nodes: [
        Block(id: "low", corners: [(0, 0), (13, 1)], elements: (13, 1)),
        Block(id: "up", corners: [(0.5, 1), (12.5, 1), (12.5, 2), (0.5, 2)], elements: (12, 1), place: (shift: (0, 0.001))),
    ],
    materials: [Elastic(id: "e", E: 1000, nu: 0.3)],
    bodies: [Solid(id: "low", mesh: "low", material: "e"), Solid(id: "up", mesh: "up", material: "e")],
    surfaces: [(id: "low", along: "low.top")],
    slaves: [(nodes: ["up.bottom"], on: ["low"])],
    friction: (angle: 20),
    supports: [(node: "low.bottom", fix: [x, y])],
    loads: [
        Displacement(node: "up.top.all", component: y, value: -0.02),
        Displacement(node: "up.top.all", component: x, value: 0.01),
    ],
    history: (path: [0, 1], increment: 0.1),
    monitors: [(name: "contact_x", of: Contact(component: x)), (name: "contact_y", of: Contact(component: y))],
)"#
    );
    Scene::from_text("two-blocks", &text, &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// The states before each minor iteration of a scene's first increment, and what each did.
pub fn stepped(model: &Arc<Model>) -> (Vec<State>, Vec<Event>) {
    let mut stepper = Stepper::new(model.clone());
    let (mut states, mut events) = (vec![stepper.state().clone()], Vec::new());
    loop {
        let event = stepper.step().expect("an increment").clone();
        let ends = matches!(
            event.outcome,
            Outcome::Increment { .. } | Outcome::Failed(_)
        );
        events.push(event);
        if ends {
            return (states, events);
        }
        states.push(stepper.state().clone());
    }
}

/// The page of a diagnosis at the cursor, with a census of the given nodes or of those that the cycle suggests.
pub fn examined(session: &mut Session, nodes: Vec<usize>) -> DiagnosisPage {
    session.submit(Command::Census(nodes)).unwrap();
    session.wait();
    session.background_mut().wait();
    let page = session.background().examination(session.timeline().place());
    page.flatten().expect("a page").clone()
}
