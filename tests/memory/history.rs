//! A long history stays within its stated memory.

use crate::counting::{alone, live};
use std::collections::HashMap;
use stickslip::history::frame::Frame;
use stickslip::history::strip::Strip;
use stickslip::history::tree::Budget;
use stickslip::record::command::{Command, Unit};
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::step::state::State;

/// A strip pressed on a floor, among slave nodes that only hover: 200 of them, and cheap to solve.
const SCENE: &str = r#"(title: "t", nodes: [
        Line(id: "row", from: (4.0, 0.05), to: (20.0, 0.05), elements: 66, per_element: 4),
        Line(id: "strip", from: (0.0, 0.1), to: (2.0, 0.1), elements: 4, per_element: 3),
        Line(id: "floor", from: (30.0, 0.0), to: (-10.0, 0.0), elements: 1, per_element: 2)],
    materials: [Section(id: "steel", EA: 1000.0, EI: 1.0, GA: 1000.0)],
    bodies: [Beam(id: "row", along: "row", material: "steel"), Beam(id: "strip", along: "strip", material: "steel")],
    surfaces: [(id: "floor", along: "floor")],
    slaves: [(nodes: ["row.all", "strip.end", "strip.8"], on: ["floor"])],
    friction: (angle: 10.0),
    supports: [(node: "strip.start", fix: [x, y, rotation]), (node: "row.all", fix: [y, rotation]), (node: "row.start", fix: [x])],
    loads: [Force(node: "strip.end", y: -0.5)],
    settings: (solver: augmented),
    history: (path: [0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0], increment: 0.001))"#;
const ITERATIONS: usize = 5_000;
const NODES: usize = 200;

fn submit(session: &mut Session, command: Command) {
    session.submit(command).unwrap_or_else(|e| panic!("{e}"));
    session.wait();
}

/// The state, bit for bit.
fn text(state: &State) -> String {
    ron::to_string(state).expect("a state is plain data")
}

#[test]
fn five_thousand_iterations_of_200_nodes_keep_within_the_budget_and_come_back_bit_for_bit() {
    let _alone = alone();
    let scene = Scene::from_text("many", SCENE, &[]).unwrap_or_else(|e| panic!("{e}"));
    let looked_at = [4_999, 17, 18, 16, 1_234, 3_000, 2_999, 2_998, 2_001];
    let mut session = Session::new(scene);
    let before = live();
    // The tip is always whole: what each of them is at first.
    let mut wanted = HashMap::new();
    let mut steps = looked_at.to_vec();
    steps.push(ITERATIONS);
    steps.sort_unstable();
    for step in steps {
        let count = (step - session.cursor()) as u32;
        submit(
            &mut session,
            Command::Forward {
                unit: Unit::Minor,
                count,
            },
        );
        wanted.insert(step, text(&session.frame().state));
    }
    assert_eq!(session.frames().len(), ITERATIONS + 1);
    assert_eq!(session.timeline().strips()[1].slaves(), NODES);

    let held = || live().saturating_sub(before);
    // Lists grow by doubling; 512 bytes are for norms, monitors and what the allocator's users round up.
    let each =
        2 * (size_of::<Frame>() + Strip::BYTES_PER_ITERATION) + NODES * Strip::BYTES_PER_NODE + 512;
    let bounded = |session: &Session| {
        assert!(
            session.timeline().tree().bytes() <= Budget::default().frames,
            "{}",
            session.timeline().tree().bytes()
        );
        // The workspace of the solver is none of the history's, and small here.
        let most = session.timeline().tree().bytes() + session.frames().len() * each + (8 << 20);
        assert!(held() <= most, "{} held, {most} stated", held());
    };
    bounded(&session);
    let whole = session
        .frames()
        .iter()
        .filter(|frame| frame.is_whole())
        .count();
    println!(
        "{whole} of {} frames whole, {} MB in them, {} MB in all; {} bytes a frame and strip, {} a node",
        ITERATIONS + 1,
        session.timeline().tree().bytes() >> 20,
        held() >> 20,
        size_of::<Frame>() + Strip::BYTES_PER_ITERATION,
        Strip::BYTES_PER_NODE,
    );
    assert!(whole > 1_000 && whole < ITERATIONS, "{whole} frames whole");

    let mut thinned = 0;
    for step in looked_at {
        thinned += usize::from(!session.frames()[step].is_whole());
        let began = std::time::Instant::now();
        submit(&mut session, Command::Goto { step });
        println!("to step {step}: {:?}", began.elapsed());
        assert_eq!(session.cursor(), step);
        assert!(
            text(&session.frame().state) == wanted[&step],
            "step {step} differs"
        );
        bounded(&session);
    }
    assert!(thinned >= 3, "only {thinned} of them had been thinned");
}
