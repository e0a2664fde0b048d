//! Every file in `snapshots/` leads to the state that it holds, and snapshots survive whatever files go through.
//!
//! Where a change of the method is meant to change them, they are recorded again:
//! ```text
//! stickslip record 01-pinned-beam-rough-floor --at 26.1.1 -o snapshots/01-sticks-when-the-load-falls.ron
//! stickslip record 01-pinned-beam-rough-floor --at 44.1.1 -o snapshots/01-lets-go-and-slides-back.ron
//! stickslip record 02-two-cantilevers-rough --at 50 -o snapshots/02-rough-at-the-end.ron
//! stickslip record 02-two-cantilevers-smooth --at 10 -o snapshots/02-smooth-slid-down.ron
//! stickslip record osc-inclined-cantilever --at 1.1.2 -o snapshots/osc-free-and-fixed-take-turns.ron
//! stickslip osc-inclined-cantilever  (s s, force the tip to sliding, f, w): snapshots/osc-tip-forced-to-sliding.ron
//! ```

use crate::common::scene;
use proptest::prelude::*;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stickslip::action::{Action, Context, parse};
use stickslip::model::Mode;
use stickslip::record::command::Command;
use stickslip::record::differences::compare;
use stickslip::record::snapshot::{AppliedIntervention, Snapshot, SnapshotError};
use stickslip::session::Session;
use stickslip::step::event::Outcome;
use stickslip::step::intervene::Intervention;
use stickslip::step::stepper::Stepper;

fn recorded() -> Vec<PathBuf> {
    let directory = concat!(env!("CARGO_MANIFEST_DIR"), "/snapshots");
    let entries = std::fs::read_dir(directory).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "ron"));
    files.sort();
    files
}

#[test]
fn every_recorded_state_is_reached_again() {
    let files = recorded();
    assert!(!files.is_empty());
    for file in files {
        let snapshot = Snapshot::read(&file).unwrap_or_else(|e| panic!("{e}"));
        let again = snapshot.replay().unwrap_or_else(|e| panic!("{e}"));
        let differences = compare(&snapshot, &again);
        assert!(differences.is_empty(), "{}\n{differences}", file.display());
    }
}

#[test]
fn a_snapshot_reads_back_to_the_same_bits() {
    for file in recorded() {
        let snapshot = Snapshot::read(&file).unwrap();
        let text = snapshot.to_text().unwrap();
        let again = Snapshot::from_text("again", &text).unwrap();
        assert_eq!(again, snapshot);
        assert_eq!(again.to_text().unwrap(), text);
    }
}

#[test]
fn numbers_that_are_none_and_extreme_ones_survive() {
    let mut snapshot = Snapshot::read(&recorded()[0]).unwrap();
    let extremes = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -0.0,
        5e-324,
        f64::MAX,
        f64::MIN_POSITIVE,
        0.1 + 0.2,
        1e300,
        3.0,
    ];
    for value in extremes {
        let slave = &mut snapshot.state.slaves[0];
        (slave.gap, slave.f_n, slave.slip) = (Some(value), value, value);
        snapshot.state.shear = vec![value; 2];
        let read = Snapshot::from_text("a", &snapshot.to_text().unwrap()).unwrap();
        let bits = |s: &Snapshot| {
            let slave = &s.state.slaves[0];
            [slave.gap.unwrap(), slave.f_n, s.state.shear[1]].map(f64::to_bits)
        };
        assert_eq!(bits(&read), bits(&snapshot), "{value:?}");
        assert!(compare(&read, &snapshot).is_empty(), "{value:?}");
    }
}

#[test]
fn a_changed_force_scale_or_limit_and_a_repeated_row_are_differences() {
    let file = recorded().swap_remove(0);
    let snapshot = Snapshot::read(&file).unwrap();
    type Change = fn(&mut Snapshot);
    let changes: [(&str, Change); 3] = [
        ("residual before, force scale", |snapshot| {
            snapshot.state.before.as_mut().unwrap().scale = 1e9;
        }),
        ("residual before, limit", |snapshot| {
            snapshot.state.before.as_mut().unwrap().limit = 1e-3;
        }),
        ("number of slave nodes", |snapshot| {
            let row = snapshot.state.slaves[0].clone();
            snapshot.state.slaves.push(row);
        }),
    ];
    for (field, change) in changes {
        let mut changed = snapshot.clone();
        change(&mut changed);
        let found = compare(&changed, &snapshot);
        assert_eq!(found.rows.len(), 1, "{field}: {found}");
        assert_eq!(found.rows[0].field, field);
    }
}

/// A session of random lines on a scene; the lines, and the snapshot after each that changed anything.
fn random_session(scene_name: &str, seed: u64, file: &std::path::Path) -> Vec<(String, Snapshot)> {
    const MODES: [&str; 3] = ["free", "sliding", "fixed"];
    const STRATEGIES: [&str; 6] = ["table2", "ladder", "newton", "lemke", "least", "block"];
    let mut random = Pcg64::new(u128::from(seed), 1);
    let mut pick = |count: usize| (random.next_u64() % count as u64) as usize;
    let mut session = Session::new(scene(scene_name, &[]));
    let slaves = session.model().contacts.len();
    let (mut lines, mut taken) = (Vec::new(), Vec::new());
    for _ in 0..24 {
        let slave = session.model().contacts[pick(slaves)].node;
        let node = session.model().nodes[slave].name.clone();
        let mode = MODES[pick(3)];
        let line = match pick(16) {
            0..=2 => format!("step {}", 1 + pick(3)),
            3 => "next".into(),
            4..=5 => "finish".into(),
            6 => "continue".into(),
            7 => format!("reverse-step {}", 1 + pick(3)),
            8 => format!("goto {}", pick(session.frames().len())),
            9 => format!("force {node} {mode}"),
            10 => format!("hold {node} {mode}"),
            11 => format!("release {node}"),
            12 => format!("increment {}", [0.01, 0.1, 0.3][pick(3)]),
            13 => format!("friction {}", 5 + pick(40)),
            14 => format!("set settings.strategy {}", STRATEGIES[pick(6)]),
            _ => "branch-next".into(),
        };
        let context = Context {
            model: Some(session.model()),
            ..Context::default()
        };
        let Ok(Action::Session(command)) = parse(&line, &context) else {
            panic!("{line}")
        };
        // A history that is done takes no change: that is a line without effect.
        let done = session.submit(command).is_ok();
        session.wait();
        lines.push(line);
        if done {
            let write = Command::Snapshot {
                file: Some(file.to_owned()),
                overwrite: true,
            };
            session.submit(write).unwrap();
            taken.push((lines.join(", "), Snapshot::read(file).unwrap()));
        }
    }
    taken
}

/// A session once wrote it after it had gone back and on in the midst of a major iteration, and it did not replay.
#[test]
fn a_snapshot_from_the_midst_of_a_major_iteration_replays() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/findings/replay-differs.ron");
    let recorded = Snapshot::read(&file).unwrap();
    let differences = compare(&recorded, &recorded.replay().unwrap());
    assert!(differences.is_empty(), "{differences}");
}

/// What the session writes does not depend on how it came there: every snapshot replays.
#[test]
fn every_snapshot_that_a_session_of_random_lines_writes_replays() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("snapshot.ron");
    let scenes = [
        "osc-three10",
        "osc-two6",
        "osc-inclined-cantilever",
        "osc-zig3",
        "osc-touch2",
        "osc-block-slide",
        "04-cantilever-rigid-circle",
    ];
    let (mut wrong, mut all) = (Vec::new(), 0);
    for (k, name) in scenes.iter().enumerate() {
        for seed in 0..6 {
            for (lines, snapshot) in random_session(name, 100 * k as u64 + seed, &file) {
                all += 1;
                let again = snapshot
                    .replay()
                    .unwrap_or_else(|e| panic!("{name}: {lines}: {e}"));
                let differences = compare(&snapshot, &again);
                if !differences.is_empty() {
                    wrong.push(format!("{name}: {lines}\n{differences}"));
                    // What comes after it is wrong for the same reason.
                    break;
                }
            }
        }
    }
    assert!(all > 500, "{all}");
    assert!(
        wrong.is_empty(),
        "{} of {all}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

/// The tip forced to sliding once, then the increment halved: what the debugger's user does on this scene.
fn with_interventions() -> Snapshot {
    let scene = scene("osc-inclined-cantilever", &[]);
    let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
    let force = Intervention::Force {
        slave: 0,
        mode: Mode::Sliding,
        hold: false,
    };
    let mut applied = Vec::new();
    let mut steps = 0;
    let mut act = |stepper: &mut Stepper, steps: u64, intervention: Intervention| {
        stepper.intervene(&intervention).unwrap();
        applied.push(AppliedIntervention {
            step: steps,
            intervention,
        });
    };
    for _ in 0..2 {
        stepper.step().unwrap();
        steps += 1;
    }
    act(&mut stepper, steps, Intervention::Increment(0.025));
    while let Some(event) = stepper.step() {
        steps += 1;
        match event.outcome {
            Outcome::Failed(_) => act(&mut stepper, steps, force.clone()),
            Outcome::Increment { .. } if event.load_factor > 0.045 => break,
            _ => assert!(steps < 1000),
        }
    }
    Snapshot::take(
        &scene,
        &applied,
        steps,
        stepper.state(),
        Some(stepper.event()),
    )
}

/// Of many rows, the text of `replay` has the first few.
#[test]
fn what_differs_most_comes_first_and_the_rest_is_counted() {
    let left = Snapshot::read(&recorded()[0]).unwrap();
    let mut right = left.clone();
    right.state.slaves[0].f_n += 1e6;
    for (k, own) in right.state.displacements.iter_mut().enumerate() {
        own.y += 1e-3 * (k + 1) as f64;
    }
    let count = right.state.displacements.len();
    assert!(count > 4);
    let differences = compare(&left, &right);
    assert_eq!(differences.rows.len(), count + 1);
    let text = differences.largest(3);
    let lines: Vec<&str> = text.lines().collect();
    let name = |k: usize| format!("{} y", right.state.displacements[count - k].node);
    assert_eq!(lines.len(), 5, "{text}");
    let first = format!("{} f_n", right.state.slaves[0].node);
    for (line, what) in lines[1..].iter().zip([first, name(1), name(2)]) {
        assert!(line.starts_with(&what), "{what}: {text}");
    }
    assert_eq!(lines[4], format!("and {} more", count - 2), "{text}");
    // The table of all of them stays as it is.
    assert_eq!(differences.to_string().lines().count(), count + 2);
    right.position.increment += 1;
    let text = compare(&left, &right).largest(3);
    assert!(text.starts_with("the states are of increments "), "{text}");
    assert!(
        text.lines().nth(2).unwrap().starts_with("increment "),
        "{text}"
    );
}

#[test]
fn interventions_are_replayed() {
    let snapshot = with_interventions();
    assert!(snapshot.interventions.len() > 1);
    let text = snapshot.to_text().unwrap();
    let read = Snapshot::from_text("a", &text).unwrap();
    assert_eq!(read, snapshot);
    assert_eq!(read.replay().unwrap(), snapshot, "to the last bit");
    let mut without = read.clone();
    without.interventions.pop();
    let differences = compare(&snapshot, &without.replay().unwrap());
    assert!(!differences.is_empty());
    let text = differences.to_string();
    assert!(text.contains("number of interventions "), "{text}");
    let last = text.lines().find(|line| line.starts_with("intervention "));
    assert!(
        last.unwrap()
            .contains(" is sliding in the next minor iteration"),
        "{text}"
    );
}

#[test]
fn steps_beyond_the_end_and_interventions_out_of_order_are_told() {
    let mut snapshot = Snapshot::read(&recorded()[0]).unwrap();
    snapshot.steps = u64::MAX;
    let error = snapshot.replay().unwrap_err();
    assert!(matches!(error, SnapshotError::Replay(_)), "{error}");
    snapshot.steps = 2;
    snapshot.interventions = vec![AppliedIntervention {
        step: 3,
        intervention: Intervention::Increment(0.1),
    }];
    let error = snapshot.replay().unwrap_err();
    assert!(matches!(error, SnapshotError::Replay(_)), "{error}");
}

#[test]
fn only_the_known_format_is_read_whatever_else_is_in_the_file() {
    for text in [
        "(format: 2)",
        "(format: 9, whatever: [(1, 2)], steps: \"x\")",
    ] {
        let error = Snapshot::from_text("a.ron", text).unwrap_err();
        assert!(error.to_string().contains("reads only format 1"), "{error}");
    }
    let error = Snapshot::from_text("a.ron", "(\n  format: 1,\n  steps: -1,\n)").unwrap_err();
    assert!(error.to_string().starts_with("a.ron:"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Neither reading a damaged file nor computing what can still be read panics.
    #[test]
    fn damaged_snapshots_do_not_panic(at in 0.0..1.0_f64, length in 0usize..40, junk in "[ -~]{0,8}") {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/snapshots/osc-free-and-fixed-take-turns.ron");
        let text = std::fs::read_to_string(file).unwrap();
        let start = (at * text.len() as f64) as usize;
        let end = (start + length).min(text.len());
        let damaged = format!("{}{junk}{}", &text[..start], &text[end..]);
        match Snapshot::from_text("damaged.ron", &damaged) {
            Err(error) => {
                let message = error.to_string();
                prop_assert!(message.starts_with("damaged.ron"), "{}", message);
            }
            Ok(snapshot) if snapshot.steps < 1000 => {
                if let Ok(again) = snapshot.replay() {
                    let _ = compare(&snapshot, &again).to_string();
                }
            }
            Ok(_) => {}
        }
    }
}
