//! Jumps to another branch of equilibrium are found, said and decided on; other sudden motions are none.

use crate::common::{self, Accepted, Run, finished, run, scene};
use crate::program::{code, err, out, program};
use stickslip::format::spec::LoadSpec;
use stickslip::scene::Scene;
use stickslip::step::event::{Failure, Outcome};

const EDGE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/scales/block-over-its-edge.ron"
);

fn jumped(accepted: &Accepted) -> bool {
    matches!(
        accepted.event.outcome,
        Outcome::Increment { jumped: true, .. }
    )
}

fn loads(run: &Run) -> Vec<f64> {
    run.accepted.iter().map(|a| a.load).collect()
}

#[test]
fn a_block_that_is_thrown_over_its_edge_jumps_in_the_least_increment_and_is_marked() {
    let edge = |increment: &str| {
        let run = finished(&scene(EDGE, &[("history.increment", increment)]));
        let at: Vec<usize> = (0..run.accepted.len())
            .filter(|&k| jumped(&run.accepted[k]))
            .collect();
        let [at] = at[..] else {
            panic!("{increment}: {at:?}")
        };
        let [before, after] = [&run.accepted[at - 1], &run.accepted[at]];
        let size: f64 = increment.parse().unwrap();
        assert!(
            ((after.load - before.load) / (size / 64.0) - 1.0).abs() < 1e-6,
            "{increment}"
        );
        let moved = |a: &Accepted, b: &Accepted| (a.monitors["u_x"] - b.monitors["u_x"]).abs();
        assert!(moved(before, after) > 0.5, "{increment}");
        // All the way there it moved by little, and the loads of the whole increments are met.
        for pair in run.accepted[..at].windows(2) {
            assert!(moved(&pair[0], &pair[1]) < 0.05, "{increment}");
        }
        for k in 1..=(1.2 / size).round() as usize {
            let met = |load: &f64| (load - k as f64 * size).abs() < 1e-9;
            assert!(loads(&run).iter().any(met), "{increment}: {k}");
        }
        after.load
    };
    let found = [edge("0.1"), edge("0.05")];
    assert!((found[0] - found[1]).abs() < 0.1 / 64.0, "{found:?}");
    assert!(found[1] > 0.43 && found[1] < 0.46, "{found:?}");
}

#[test]
fn the_scene_decides_what_becomes_of_a_jump() {
    let stopped = run(&scene(EDGE, &[("history.jumps", "stop")]));
    let failed = stopped.failure.as_ref().map(|(_, failure)| failure);
    assert!(
        matches!(failed, Some(Failure::BranchJump { motion, .. }) if *motion > 0.5),
        "{failed:?}"
    );
    assert!(!stopped.accepted.iter().any(jumped));
    assert!((stopped.accepted.last().unwrap().load - 0.442).abs() < 0.002);
    let whole = run(&scene(EDGE, &[("history.jumps", "accept")]));
    assert!(whole.failure.is_none());
    assert_eq!(whole.accepted.len(), 12);
    let marked: Vec<usize> = (1..=12)
        .filter(|&k| jumped(&whole.accepted[k - 1]))
        .collect();
    assert_eq!(marked, [5]);
}

#[test]
fn reversals_prescribed_motions_first_touches_and_sliding_off_are_no_jumps() {
    for (name, set) in [
        // It turns round, sticks, and slides back.
        ("01-pinned-beam-rough-floor", vec![]),
        (
            "01-pinned-beam-rough-floor",
            vec![("history.increment", "0.05")],
        ),
        // It touches, and touches elsewhere.
        (
            "03-distant-cantilevers",
            vec![("history.increment", "0.25")],
        ),
        (
            "04-cantilever-rigid-circle",
            vec![("history.increment", "0.1")],
        ),
        ("05-cantilever-elastic-block", vec![]),
        ("02-two-cantilevers-smooth", vec![]),
        ("02-two-cantilevers-rough", vec![]),
        // It is moved from the start.
        ("hertz-cylinder-on-block", vec![]),
        ("osc-block-slide", vec![]),
        ("osc-off-end", vec![]),
    ] {
        let with = |jumps: &'static str| {
            let mut set = set.clone();
            set.push(("history.jumps", jumps));
            run(&scene(name, &set))
        };
        let (cut, whole) = (with("cut"), with("accept"));
        assert!(cut.failure.is_none(), "{name}: {:?}", cut.failure);
        assert!(!cut.accepted.iter().any(jumped), "{name}");
        assert_eq!(
            loads(&cut),
            loads(&whole),
            "{name}: nothing is even suspected"
        );
    }
    let moved = run(&common::two_blocks(1));
    assert!(moved.failure.is_none() && !moved.accepted.iter().any(jumped));
}

/// The load sets in after three increments, or twenty times as fast as before: whatever is suspected, nothing jumps.
#[test]
fn a_load_that_sets_in_late_or_grows_faster_makes_no_jump() {
    for scale in [
        vec![(0.0, 0.0), (0.3, 0.0), (1.0, 1.0)],
        vec![(0.0, 0.0), (0.5, 0.02), (1.0, 1.0)],
    ] {
        for name in [
            "02-two-cantilevers-rough",
            "04-cantilever-rigid-circle",
            "hertz-cylinder-on-block",
        ] {
            let mut spec = scene(name, &[]).spec;
            let peak = *spec.history.path.last().unwrap();
            (spec.history.path, spec.history.increment) = (vec![0.0, 1.0], 0.1);
            for load in &mut spec.loads {
                let (LoadSpec::Force { scale: of, .. } | LoadSpec::Displacement { scale: of, .. }) =
                    load
                else {
                    panic!("{load:?}")
                };
                *of = scale
                    .iter()
                    .map(|(at, factor)| (*at, factor * peak))
                    .collect();
            }
            let run = run(&Scene::from_spec(name, spec).unwrap());
            assert!(run.failure.is_none(), "{name}: {:?}", run.failure);
            assert!(!run.accepted.iter().any(jumped), "{name}");
        }
    }
}

/// Between 5 and 30 degrees the beam holds the column until it slides, and then nothing does.
#[test]
fn two_cantilevers_with_some_friction_are_never_thrown_over_without_a_word() {
    let mut thrown = 0;
    for angle in ["5", "10", "15", "20"] {
        for increment in ["0.05", "0.1", "0.25"] {
            let set = [("friction.angle", angle), ("history.increment", increment)];
            let run = run(&scene("02-two-cantilevers-rough", &set));
            let mut fastest: f64 = 0.0;
            for pair in run.accepted.windows(2) {
                let moved = (pair[1].monitors["u_x"] - pair[0].monitors["u_x"]).abs();
                let size = pair[1].load - pair[0].load;
                // Sliding down the column goes at up to a tenth of its length in an increment of 0.05.
                if moved / size > 20.0 && moved > 0.2 {
                    assert!(jumped(&pair[1]), "{set:?} load {}: {moved}", pair[1].load);
                    thrown += 1;
                }
                fastest = fastest.max(moved / size);
            }
            assert!(fastest > 0.5, "{set:?}");
        }
    }
    assert!(thrown > 0, "some are thrown over, and say so");
}

/// Near the limit point the halves do not converge any more; beyond it the column lies on the sliding beam.
#[test]
fn where_the_halves_fail_the_increment_is_taken_whole_and_marked() {
    for (name, set, limit, whole) in [
        (
            "02-two-cantilevers-rough",
            vec![("friction.angle", "10"), ("history.increment", "0.05")],
            (0.79, 0.80),
            2.5,
        ),
        (
            "osc-snap",
            vec![("settings.strategy", "ladder")],
            (1.75, 2.0),
            6.0,
        ),
    ] {
        let run = run(&scene(name, &set));
        assert!(run.failure.is_none(), "{name}: {:?}", run.failure);
        assert_eq!(loads(&run).last(), Some(&whole), "{name}");
        let jumps: Vec<f64> = run
            .accepted
            .iter()
            .filter(|a| jumped(a))
            .map(|a| a.load)
            .collect();
        let [load] = jumps[..] else {
            panic!("{name}: {jumps:?}")
        };
        assert!(load > limit.0 && load <= limit.1, "{name}: {load}");
    }
}

#[test]
fn the_program_says_where_a_run_jumped_and_its_table_has_a_column_for_it() {
    let here = std::env::current_dir().unwrap();
    let output = program(
        &here,
        &["run", "tests/scales/block-over-its-edge.ron", "--csv", "-"],
    )
    .output()
    .unwrap();
    assert_eq!(code(&output), 0);
    let told = err(&output);
    assert!(told.contains("after a jump to another branch"), "{told}");
    let table = out(&output);
    let mut lines = table.lines();
    assert!(lines.next().unwrap().ends_with(",c_y,jumped,worst_stretch"));
    let jumped = |line: &&str| line.rsplit(',').nth(1) == Some("1");
    assert_eq!(lines.filter(jumped).count(), 1);
}
