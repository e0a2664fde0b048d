//! What the debugger costs: `cargo bench --bench debugger`.
//!
//! - `run_alone` against `run_recorded`: a session keeps the whole history of the same run.
//! - `frame`: all panes at 200 by 60, with 1,000 slave nodes; and the page of the timeline.
//! - `key_while_solving`: from a key to the frame that shows what it did, while 100,000 unknowns are being solved.

use divan::Bencher;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stickslip::debug::command::{Command, Unit};
use stickslip::debug::session::Session;
use stickslip::scene::Scene;
use stickslip::solve::{Outcome, Stepper};
use stickslip::tui::run::Debugger;
use stickslip::tui::theme::Theme;
use stickslip::tui::{draw, keys};

const BLOCKS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/benches/two-blocks-pressed-sheared.ron"
);
const CIRCLE: &str = "04-cantilever-rigid-circle";
const RUN: Command = Command::Forward {
    unit: Unit::Run,
    count: 1,
};

/// A beam of 1,000 nodes pressed on a rough floor.
const LONG: &str = "(title: \"long\", nodes: [
        Line(id: \"beam\", from: (0, 0.001), to: (100, 0.001), elements: 333, per_element: 4),
        Line(id: \"floor\", from: (101, 0), to: (-1, 0), elements: 1, per_element: 2)],
    materials: [Section(id: \"rod\", EA: 100, EI: 1)], bodies: [Beam(id: \"beam\", along: \"beam\", material: \"rod\")],
    surfaces: [(id: \"floor\", along: \"floor\")], slaves: [(nodes: [\"beam.all\"], on: [\"floor\"])], friction: (angle: 20),
    supports: [(node: \"beam.start\", fix: [x, y, rotation])], loads: [Traction(along: \"beam\", x: 0.1, y: -0.1)],
    history: (path: [0, 1], increment: 0.5))";

fn main() {
    divan::main();
}

fn scene(name: &str, set: &[(&str, &str)]) -> Scene {
    let set: Vec<(String, String)> = set
        .iter()
        .map(|(p, v)| (p.to_string(), v.to_string()))
        .collect();
    Scene::open(name, &set).unwrap_or_else(|e| panic!("{e}"))
}

#[divan::bench(sample_count = 10)]
fn run_alone(bencher: Bencher) {
    let model = Arc::new(scene(CIRCLE, &[]).model);
    bencher.bench(|| {
        let mut stepper = Stepper::new(model.clone());
        while let Some(event) = stepper.step() {
            assert!(!matches!(event.outcome, Outcome::Failed(_)));
        }
    });
}

#[divan::bench(sample_count = 10)]
fn run_recorded(bencher: Bencher) {
    let scene = scene(CIRCLE, &[]);
    bencher
        .with_inputs(|| Session::new(scene.clone()))
        .bench_values(|mut session| {
            session.submit(RUN).unwrap_or_else(|e| panic!("{e}"));
            session.wait();
            session
        });
}

/// A debugger of 1,000 slave nodes, some minor iterations on its way.
fn long() -> Debugger {
    let scene = Scene::from_text("long", LONG, &[]).unwrap_or_else(|e| panic!("{e}"));
    let mut session = Session::new(scene);
    let six = Command::Forward {
        unit: Unit::Minor,
        count: 6,
    };
    session.submit(six).unwrap_or_else(|e| panic!("{e}"));
    session.wait();
    Debugger::new(Theme::mono(), Vec::new(), Some(session))
}

fn draws(bencher: Bencher, debugger: &Debugger) {
    let area = Rect::new(0, 0, 200, 60);
    let mut buffer = Buffer::empty(area);
    bencher.bench_local(|| {
        buffer.reset();
        draw::draw(&mut buffer, area, &debugger.app, debugger.view().as_ref());
    });
}

#[divan::bench]
fn frame(bencher: Bencher) {
    draws(bencher, &long());
}

#[divan::bench]
fn frame_of_the_timeline(bencher: Bencher) {
    let mut debugger = long();
    if let Some(press) = keys::press("t") {
        debugger.key(&press);
    }
    draws(bencher, &debugger);
}

/// The worker is at work all the time; each sample is one key, one look for what it brought, and one frame.
#[divan::bench(sample_count = 20, sample_size = 1)]
fn key_while_solving(bencher: Bencher) {
    let scene = scene(BLOCKS, &[("refine", "18")]);
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), Some(Session::new(scene)));
    let area = Rect::new(0, 0, 200, 60);
    let mut buffer = Buffer::empty(area);
    if let Some(session) = &mut debugger.session {
        session.submit(RUN).unwrap_or_else(|e| panic!("{e}"));
    }
    let keys = ["Down", "Tab", "Up", "t", "Tab", "z", "z"];
    let mut key = keys.iter().cycle();
    let mut worst = Duration::ZERO;
    bencher.bench_local(|| {
        let began = Instant::now();
        if let Some(press) = key.next().and_then(|name| keys::press(name)) {
            debugger.key(&press);
        }
        debugger.advance();
        draw::draw(&mut buffer, area, &debugger.app, debugger.view().as_ref());
        worst = worst.max(began.elapsed());
    });
    println!("worst {worst:?}; still solving: {}", debugger.is_busy());
}
