//! What the debugger costs: `cargo bench --bench debugger`.
//!
//! - recording: a session keeps the whole history of problem 04, against a run that keeps nothing.
//! - `frame`: all panes at 200 by 60, with 1,000 slave nodes; and the page of the timeline.
//! - `key_while_solving`: from a key to the frame that shows what it did, while 100,000 unknowns are being solved.

use divan::Bencher;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stickslip::model::Model;
use stickslip::record::command::{Command, Unit};
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::step::event::Outcome;
use stickslip::step::stepper::Stepper;
use stickslip::tui::Debugger;
use stickslip::tui::theme::Theme;
use stickslip::tui::{keys, screen};

const BLOCKS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/benches/two-blocks-pressed-sheared.ron"
);
const CIRCLE: &str = "04-cantilever-rigid-circle";
/// Pairs of runs that are compared.
const PAIRS: usize = 200;
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
    recording();
    divan::main();
}

fn scene(name: &str, set: &[(&str, &str)]) -> Scene {
    let set: Vec<(String, String)> = set
        .iter()
        .map(|(p, v)| (p.to_string(), v.to_string()))
        .collect();
    Scene::open(name, &set).unwrap_or_else(|e| panic!("{e}"))
}

/// What keeping the whole history costs: runs alone and recorded in turn, so that both meet the same machine.
fn recording() {
    // Short runs, since the machine's speed changes by the second.
    let scene = scene(CIRCLE, &[("history.increment", "0.05")]);
    let model = Arc::new(scene.model.clone());
    let mut pairs: Vec<[f64; 2]> = (0..PAIRS)
        .map(|_| [alone(&model), recorded(&scene)])
        .collect();
    let least = [0, 1].map(|k| pairs.iter().fold(f64::INFINITY, |m, pair| m.min(pair[k])));
    pairs.sort_by(|a, b| (a[1] / a[0]).total_cmp(&(b[1] / b[0])));
    let more = |place: usize| 100.0 * (pairs[place][1] / pairs[place][0] - 1.0);
    println!(
        "recording the whole history, {PAIRS} pairs: {:+.1} % (median; quartiles {:+.1} and {:+.1}); least {:.1} and {:.1} ms, {:+.1} %",
        more(PAIRS / 2),
        more(PAIRS / 4),
        more(3 * PAIRS / 4),
        1e3 * least[0],
        1e3 * least[1],
        100.0 * (least[1] / least[0] - 1.0)
    );
}

/// Seconds of a run that keeps nothing.
fn alone(model: &Arc<Model>) -> f64 {
    let mut stepper = Stepper::new(model.clone());
    let began = Instant::now();
    while let Some(event) = stepper.step() {
        assert!(!matches!(event.outcome, Outcome::Failed(_)));
    }
    began.elapsed().as_secs_f64()
}

/// Seconds of the same in a session.
fn recorded(scene: &Scene) -> f64 {
    let mut session = Session::new(scene.clone());
    let began = Instant::now();
    session.submit(RUN).unwrap_or_else(|e| panic!("{e}"));
    session.wait();
    began.elapsed().as_secs_f64()
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
        screen::draw(&mut buffer, area, &debugger.app, debugger.view().as_ref());
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
        screen::draw(&mut buffer, area, &debugger.app, debugger.view().as_ref());
        worst = worst.max(began.elapsed());
    });
    println!("worst {worst:?}; still solving: {}", debugger.is_busy());
}
