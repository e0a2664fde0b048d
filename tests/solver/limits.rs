//! Limit loads, lost stability and jumps against closed forms and against scenes that were once passed without a word.

use crate::common::{Accepted, Run, finished, read, run, scene};
use crate::program::{code, err, out, program, rows};
use std::path::Path;
use stickslip::linear::stability::Stability;
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;

fn found(file: &str, set: &[(&str, &str)]) -> Scene {
    scene(
        &format!("{}/tests/findings/{file}", env!("CARGO_MANIFEST_DIR")),
        set,
    )
}

fn jumped(accepted: &Accepted) -> bool {
    matches!(
        accepted.event.outcome,
        Outcome::Increment { jumped: true, .. }
    )
}

/// Load of the first increment that is marked.
fn first_mark(run: &Run) -> Option<f64> {
    run.accepted.iter().find(|a| jumped(a)).map(|a| a.load)
}

/// What `run` prints, its exit code and its table.
fn told(arguments: &[&str]) -> (i32, String, String) {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let all = [&["run"], arguments, &["--csv", "-"]].concat();
    let output = program(here, &all).output().unwrap();
    (code(&output), err(&output), out(&output))
}

fn last_line(text: &str) -> &str {
    text.lines().last().unwrap_or_default()
}

/// A block of weight 3400 on a slope of 11.3099 degrees is pushed down it by a horizontal force of 2550 (load − 1). It slides where
/// the force's angle to the vertical comes to φ less the slope: load = 1 + 3400 tan(φ − α) / 2550.
#[test]
fn a_block_on_a_slope_is_refused_where_friction_is_used_up_and_the_load_is_named() {
    for angle in [25.0, 30.9638, 35.0_f64] {
        let limit = 1.0 + 3400.0 / 2550.0 * (angle - 11.3099).to_radians().tan();
        let set = format!("friction.angle={angle}");
        let file = "tests/findings/block-on-a-slope.ron";
        let (code, told, table) = told(&[file, "--set", &set]);
        assert_eq!(code, 3, "{angle}");
        let reached = rows(&table).last().unwrap()["load"].parse::<f64>().unwrap();
        assert!(
            reached < limit && limit - reached < 0.1 / 32.0,
            "{angle}: {reached} {limit}"
        );
        let named = format!("why: limit load: friction is used up at load {limit:.3}");
        assert!(
            told.lines().any(|line| line.trim().starts_with(&named)),
            "{angle}: {named}\n{told}"
        );
    }
}

/// With less friction than the slope no load is held. The weight needs an angle of at least that of the slope, whatever the load.
#[test]
fn a_block_on_a_slope_with_too_little_friction_is_explained_by_it() {
    let file = "tests/findings/block-on-a-slope.ron";
    let (code, told, _) = told(&[
        file,
        "--set",
        "friction.angle=10",
        "--set",
        "settings.initial_gaps=adjust",
    ]);
    assert_eq!(code, 3);
    let why = told
        .lines()
        .find_map(|line| {
            line.trim()
                .strip_prefix("why: friction is too small to hold body b: ")
        })
        .unwrap_or_else(|| panic!("{told}"));
    let (_, numbers) = why.split_once("along the surface with ").unwrap();
    let (push, numbers) = numbers
        .split_once(", and its contacts resist with at most ")
        .unwrap();
    let (most, angle) = numbers
        .split_once(" (tan φ F_n + cohesion); it takes a friction angle of at least ")
        .unwrap();
    let [push, most] = [push, most].map(|number| number.parse::<f64>().unwrap());
    let ratio = 10_f64.to_radians().tan() / 11.3099_f64.to_radians().tan();
    assert!((most / push - ratio).abs() < 1e-3, "{push} {most} {ratio}");
    assert_eq!(angle, "11.31 degrees");
    // The modes in which the last attempt stopped would hold the block.
    assert!(
        told.contains("17 sticking; these modes would hold it, those that were solved do not"),
        "{told}"
    );
}

/// The same on an elastic wedge, whose slope gives: all contacts slide before the limit load of the rigid slope. The block tips
/// over the lower corner soon after, and that is marked.
#[test]
fn a_block_on_a_wedge_is_not_tipped_without_a_word() {
    let (code, told, table) = told(&["tests/findings/block-on-a-wedge.inp"]);
    assert_eq!(code, 3, "nothing holds it");
    let rows = rows(&table);
    let marked = rows.iter().find(|row| row["jumped"] == "1");
    let mark: f64 = marked.expect("it tips, and that is marked")["load"]
        .parse()
        .unwrap();
    assert!(mark > 1.4762 * 0.998 && mark < 1.48, "{mark}");
    let (_, rest) = told
        .split_once("limit load: friction is used up at load ")
        .unwrap_or_else(|| panic!("{told}"));
    let (load, rest) = rest.split_once(": ").unwrap();
    let load: f64 = load.parse().unwrap();
    assert!(load < mark && (load / 1.4762 - 1.0).abs() < 2e-3, "{load}");
    assert!(
        rest.starts_with("all contacts of body BLOCK slide"),
        "{rest}"
    );
}

/// Below its shallow limit point the arch's top is above −0.3; beyond it the arch hangs. Arc length puts the limit at 1.9959.
#[test]
fn an_arch_that_snaps_through_under_load_control_is_marked_at_its_limit_load() {
    let run = finished(&found("arch-snaps-through.ron", &[]));
    for pair in run.accepted.windows(2) {
        let moved = (pair[1].monitors["u_y"] - pair[0].monitors["u_y"]).abs();
        assert_eq!(
            moved > 0.1,
            jumped(&pair[1]),
            "load {}: {moved}",
            pair[1].load
        );
    }
    let mark = first_mark(&run).unwrap();
    assert!(mark > 1.995937 && mark < 1.995937 + 0.15, "{mark}");
    let path = found(
        "arch-snaps-through.ron",
        &[
            ("history.control", "arc"),
            ("settings.t_max", "consistent"),
            ("history.arc.length", "0.5"),
        ],
    );
    let path = crate::common::run(&path);
    let highest = path.accepted.iter().map(|a| a.load).fold(0.0, f64::max);
    assert!(
        (highest / 1.995937 - 1.0).abs() < 2e-3 && highest < mark,
        "{highest}"
    );
}

/// A block of width 1 and height 2 under its own load of 1 and a fifth of that across, on its top: it tips where the resultant
/// leaves its base, once it leans by its own shear. It does so at the end of the path, and was found upside down.
#[test]
fn a_block_that_tips_over_is_marked_though_a_law_of_slip_is_marked_too() {
    let set = [("settings.strategy", "ladder")];
    let run = run(&found("block-tips.ron", &set));
    let mut over = 0;
    for pair in run.accepted.windows(2) {
        let moved = (pair[1].monitors["tl_y"] - pair[0].monitors["tl_y"]).abs();
        if moved > 1.0 {
            assert!(jumped(&pair[1]), "load {}: {moved}", pair[1].load);
            over += 1;
        }
    }
    let ended = run.accepted.last().unwrap().monitors["tl_y"];
    assert!(over > 0 || run.failure.is_some() || ended > -1.0, "{ended}");
}

#[test]
fn a_column_that_passes_through_unstable_states_between_its_walls_says_so() {
    let (code, told, table) = told(&["tests/findings/column-between-walls.ron", "--stability"]);
    assert_eq!(code, 3);
    assert!(
        told.contains("equilibrium becomes unstable at load 1.1"),
        "{told}"
    );
    let rows = rows(&table);
    let unstable = |row: &&_| {
        let row: &std::collections::HashMap<String, String> = row;
        row["stability"].starts_with("unstable") || row["stability"] == "divergence"
    };
    let first = rows.iter().find(unstable).expect("some are");
    assert_eq!(first["jumped"], "1", "{first:?}");
}

/// Euler's column, straight: it stays in equilibrium beyond its buckling load, and is unstable there.
#[test]
fn a_column_is_marked_where_its_load_passes_euler_s() {
    let euler = std::f64::consts::PI.powi(2) / 4.0;
    let text = "(title: \"t\", nodes: [Line(id: \"b\", from: (0, 0), to: (1, 0), elements: 10, per_element: 5)],
          materials: [Section(id: \"m\", EA: 1e6, EI: 1, GA: 1e6)], bodies: [Beam(id: \"b\", along: \"b\", material: \"m\")],
          supports: [(node: \"b.start\", fix: [x, y, rotation])], loads: [Force(node: \"b.end\", x: -1)],
          history: (path: [0, 3], increment: 0.01))";
    let scene = read(text);
    let run = finished(&scene);
    let mark = first_mark(&run).expect("it is marked");
    // Looks are as far apart as their cost allows; where one finds it unstable, it is told since when it may be.
    let marked = run.accepted.iter().find(|a| jumped(a)).unwrap();
    let Outcome::Increment {
        unstable: Some(loss),
        ..
    } = marked.event.outcome
    else {
        panic!("{:?}", marked.event.outcome)
    };
    assert_eq!(loss.stability, Stability::Unstable { modes: 1 });
    let stable = loss.stable_at.expect("it was stable before");
    assert!(
        stable < euler * (1.0 + 1e-5) && euler < mark,
        "{stable} {euler} {mark}"
    );
    assert!(mark - stable < 0.4, "{stable} {mark}");
    assert_eq!(run.accepted.iter().filter(|a| jumped(a)).count(), 1, "once");
}

#[test]
fn a_second_step_that_begins_to_move_is_no_jump_and_is_not_cut() {
    for (file, increments) in [("pad-on-a-moved-disc.ron", 20), ("linear-history.ron", 4)] {
        let run = run(&found(file, &[("friction.angle", "0")]));
        assert!(run.failure.is_none(), "{file}: {:?}", run.failure);
        assert_eq!(run.accepted.len(), increments, "{file}");
        assert!(!run.accepted.iter().any(jumped), "{file}");
    }
}

#[test]
fn a_path_that_ends_at_the_bound_on_its_length_is_not_completed_and_the_exit_code_says_so() {
    let file = "tests/findings/path-of-unloading.ron";
    let (code, told, _) = told(&[file, "--set", "history.control=arc"]);
    assert_eq!(code, 3);
    assert!(last_line(&told).contains("path incomplete"), "{told}");
}

/// Accepted loads go towards the next corner of the path, however an increment was cut, taken whole or led round.
#[test]
fn accepted_loads_never_go_back_under_load_control() {
    for file in [
        "block-squeezed-to-half.ron",
        "column-between-walls.ron",
        "block-on-a-wedge.inp",
    ] {
        let run = run(&found(file, &[]));
        let path = &run.stepper.model().path;
        let (mut leg, mut load) = (0, path[0]);
        for accepted in &run.accepted {
            let ahead = (path[leg + 1] - load).signum();
            assert!(
                (accepted.load - load) * ahead > 0.0,
                "{file}: {load}, then {}",
                accepted.load
            );
            load = accepted.load;
            leg += usize::from(load == path[leg + 1]);
        }
    }
}

/// Where the load falls beyond its maximum, no smaller increment helps; the load is that of arc length from the start.
#[test]
fn the_largest_load_on_the_path_is_named_where_the_search_ends() {
    let file = "tests/findings/load-falls-beyond-its-maximum.ron";
    let (code, reason, _) = told(&[file]);
    assert_eq!(code, 3, "{reason}");
    let named = "why: limit load: equilibrium exists on this path up to load ";
    let mut lines = reason.lines().map(str::trim);
    let found = lines.find_map(|line| line.strip_prefix(named));
    let (load, beyond) = found.and_then(|line| line.split_once("; ")).unwrap();
    assert_eq!(beyond, "beyond it the load falls along the path");
    let (_, _, table) = told(&[file, "--set", "history.control=arc"]);
    let loads = rows(&table)
        .into_iter()
        .map(|row| row["load"].parse().unwrap());
    let highest = loads.fold(0.0, f64::max);
    let load: f64 = load.parse().unwrap();
    assert!((load - highest).abs() < 1e-5, "{load} {highest}");
}

/// The path may also end where contacts change, where a node gets around or slides off the end of its surface, or in an element that
/// turns inside out: the load lies between the last increment and the one that failed.
#[test]
fn the_end_of_the_path_is_named_where_contacts_change_or_an_element_is_inverted() {
    for (arguments, up_to, beyond) in [
        (
            "tests/findings/path-ends-behind-the-end-of-a-surface.ron --set settings.search=2000",
            "beyond load ",
            "q.3 gets behind surface f around its end at (1.045, 0.6585), by 0.1658 ",
        ),
        (
            "tests/findings/path-ends-where-modes-change.ron",
            "the equilibrium path ends at load ",
            "where modes change (q.2 fixed → free, q.3 sliding → free); no state was found beyond it",
        ),
        (
            "tests/findings/equilibrium-is-lost.ron",
            "equilibrium is lost at load ",
            "with the loads just beyond held, a damped motion leaves it; node q.23 has moved by ",
        ),
        (
            "tests/findings/slides-off-the-end-of-its-surface.ron",
            "beyond load ",
            "q.1 slides off the end of surface fp at (-0.1009, 0.4627), where it transmits F_n = 0.9644 (held free, it is inside",
        ),
        (
            "tests/findings/slides-off-the-end-and-snaps.ron --set settings.search=2000",
            "beyond load ",
            "s.5 slides off the end of surface f at (1.737, 0.01805), where it transmits F_n = 2.716 (held free, no equilibrium",
        ),
        (
            "tests/findings/load-falls-where-a-contact-opens.ron",
            "equilibrium exists on this path up to load ",
            "beyond it the load falls along the path",
        ),
        (
            "tests/findings/path-ends-in-an-inverted-element.ron",
            "equilibrium exists on this path up to load ",
            "beyond it every step tried inverts element 1 of q at ",
        ),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let (code, reason, table) = told(&arguments);
        assert_eq!(code, 3, "{reason}");
        let named = format!("why: limit load: {up_to}");
        let mut lines = reason.lines().map(str::trim);
        let found = lines.find_map(|line| line.strip_prefix(&*named));
        let (load, rest) = found
            .unwrap_or_else(|| panic!("{reason}"))
            .split_once([',', ';', ':'])
            .unwrap();
        assert!(rest.trim().starts_with(beyond), "{rest}");
        let load: f64 = load.parse().unwrap();
        let last: f64 = rows(&table).last().unwrap()["load"].parse().unwrap();
        let failed = reason.lines().find(|line| line.contains("in attempt"));
        let failed = failed.unwrap().split_once("(load ").unwrap().1;
        let failed: f64 = failed.split_once(')').unwrap().0.parse().unwrap();
        assert!(
            last - 1e-6 < load && load < failed,
            "{last} {load} {failed}"
        );
    }
}

/// Where a node slides off the end of its surface, or has got behind it, the surface continued past its ends is tried; where the
/// major iterations do not converge, a finer mesh, but not of a scene that names single nodes.
#[test]
fn changes_of_the_scene_are_tried_from_its_start() {
    for (file, change) in [
        (
            "path-ends-behind-the-end-of-a-surface.ron",
            "surfaces.f.past_ends=0.5",
        ),
        (
            "slides-off-the-end-of-its-surface.ron",
            "surfaces.fp.past_ends=0.5",
        ),
        (
            "slides-to-the-end-of-its-surface.ron",
            "surfaces.f.past_ends=0.5",
        ),
        ("coarse-mesh-with-frozen-geometry.ron", "refine=2"),
    ] {
        let file = format!("tests/findings/{file}");
        // Without a limit, longer increments get past some of these ends.
        let (code, reason, _) = told(&[&file, "--set", "settings.search=2000"]);
        assert_eq!(code, 3, "{reason}");
        let tried = format!("try: --set {change} (tried from the start: passes, ");
        assert!(reason.contains(&tried), "{reason}");
        let (code, reason, _) = told(&[&file, "--set", change]);
        assert_eq!(code, 0, "{reason}");
    }
}
