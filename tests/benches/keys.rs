//! What the debugger's keys cost, by the size of the scene: `cargo bench --bench keys`; `-- 1000000` adds a million unknowns.
//!
//! The scene is `two-blocks-pressed-sheared`, in a session as the debugger has it, without a screen. After an increment and some
//! minor iterations of the next: a step on; a step back and on again; a node forced and a step; what pushed a node; the
//! diagnosis. Then `S` and `j` with a screen of 200 by 60 and a journal: processor time of all threads until all are idle, and a
//! frame. Of steps the median of some. All of a row are measured in one process. A table, not a statistic: hence no harness.

#[path = "../common/peak.rs"]
mod peak;

use peak::peak;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use rustix::time::{ClockId, clock_gettime};
use std::time::Instant;
use stickslip::model::Mode;
use stickslip::record::command::{Command, Unit};
use stickslip::record::journal::JournalTarget;
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::step::event::Outcome;
use stickslip::tui::theme::Theme;
use stickslip::tui::{Debugger, screen};

const BLOCKS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/benches/two-blocks-pressed-sheared.ron"
);
/// Steps of a median.
const SOME: usize = 5;
/// Refinement for a million unknowns.
const MILLION: &str = "58";

fn main() {
    println!(
        "| unknowns | slaves | open s | n s | first minor s | s ms | back and s ms | force and s ms | pushes ms | d ms | `S` ms | `j` ms | peak MB |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    let million = std::env::args().any(|argument| argument == "1000000");
    let sizes = ["2", "6", "8", "18"].into_iter();
    for refine in sizes.chain(million.then_some(MILLION)) {
        row(refine);
    }
}

fn row(refine: &str) {
    let began = Instant::now();
    // 5 increments of 1 have many changes of modes in each.
    let set = [("refine", refine), ("history.increment", "1.0")];
    let set = set.map(|(path, value)| (path.to_string(), value.to_string()));
    let scene = Scene::open(BLOCKS, &set).unwrap_or_else(|e| panic!("{e}"));
    let (unknowns, slaves) = (scene.model.dofs.equations, scene.model.contacts.len());
    let mut session = Session::new(scene);
    let opened = began.elapsed().as_secs_f64();
    let increment = does(&mut session, &[forward(Unit::Increment)]);
    let first = does(&mut session, &[forward(Unit::Minor)]);
    assert!(is_minor(&session), "the first minor iteration settles");
    let on = median((0..SOME).map(|_| {
        let step = does(&mut session, &[forward(Unit::Minor)]);
        if !is_minor(&session) {
            return f64::NAN;
        }
        step
    }));
    let back = Command::Back {
        unit: Unit::Minor,
        count: 1,
    };
    let to_and_fro = [back.clone(), forward(Unit::Minor)];
    does(&mut session, &[back.clone(), back.clone()]);
    let force = Command::Force {
        slave: 0,
        mode: Mode::Free,
        hold: false,
    };
    let forced = median((0..SOME).map(|_| {
        let spent = does(&mut session, &[force.clone(), forward(Unit::Minor)]);
        does(&mut session, &[back.clone(), back.clone()]);
        spent
    }));
    let again = median((0..SOME).map(|_| does(&mut session, &to_and_fro)));
    let began = Instant::now();
    session.demand_pushes();
    session.look(slaves / 2);
    session.background_mut().wait();
    let pushes = began.elapsed().as_secs_f64();
    let began = Instant::now();
    does(&mut session, &[Command::Census(Vec::new())]);
    session.background_mut().wait();
    let diagnosis = began.elapsed().as_secs_f64();
    let folder = tempfile::tempdir().unwrap_or_else(|e| panic!("{e}"));
    let journal = JournalTarget::File(folder.path().join("keys.journal"));
    journal
        .begin(&mut session)
        .unwrap_or_else(|e| panic!("{e}"));
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), Some(session));
    let mut key = |name| median((0..SOME).map(|_| processor_time_of_key(&mut debugger, name)));
    let (back, down) = (key("S"), key("j"));
    println!(
        "| {unknowns} | {slaves} | {opened:.2} | {increment:.2} | {first:.2} | {:.1} | {:.1} | {:.1} | {:.1} | {:.1} | {:.1} | {:.1} | {} |",
        1e3 * on,
        1e3 * again,
        1e3 * forced,
        1e3 * pushes,
        1e3 * diagnosis,
        1e3 * back,
        1e3 * down,
        peak()
    );
}

/// Seconds of processor time that a key takes in all threads, with all that it causes and a frame.
fn processor_time_of_key(debugger: &mut Debugger, name: &str) -> f64 {
    let now = || {
        let time = clock_gettime(ClockId::ProcessCPUTime);
        time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
    };
    let area = Rect::new(0, 0, 200, 60);
    let mut buffer = Buffer::empty(area);
    let began = now();
    debugger.type_keys(name);
    screen::draw(&mut buffer, area, &debugger.app, debugger.view().as_ref());
    now() - began
}

fn forward(unit: Unit) -> Command {
    Command::Forward { unit, count: 1 }
}

/// Whether the shown minor iteration ended nothing.
fn is_minor(session: &Session) -> bool {
    let event = session.frame().event.as_ref();
    event.is_some_and(|event| matches!(event.outcome, Outcome::Minor))
}

/// Seconds that some commands take, one after the other.
fn does(session: &mut Session, commands: &[Command]) -> f64 {
    let began = Instant::now();
    for command in commands {
        session
            .submit(command.clone())
            .unwrap_or_else(|e| panic!("{e}"));
        session.wait();
    }
    began.elapsed().as_secs_f64()
}

fn median(times: impl Iterator<Item = f64>) -> f64 {
    let mut times: Vec<f64> = times.filter(|time| !time.is_nan()).collect();
    times.sort_unstable_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}
