//! Convergence maps: what they count, how they are judged, and that a kill loses nothing.

use crate::program::{code, err, interrupted, program, refused, rows, well, words};
use std::collections::HashMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use stickslip::study::map::{FinalMonitor, Map, MapRun, TOLERANCE};
use stickslip::study::monitor_kind::MonitorKind;
use stickslip::study::verdict::RunVerdict;
use stickslip::study::{Plan, Study, Vary};

fn command(directory: &Path, arguments: &[&str]) -> Command {
    program(directory, &[&["map"], arguments].concat())
}

fn ran(directory: &Path, arguments: &[&str]) -> Output {
    command(directory, arguments).output().unwrap()
}

fn read(directory: &Path, name: &str) -> String {
    std::fs::read_to_string(directory.join(name)).unwrap()
}

const T_MAX: &str = "t_max=lagged,consistent";

#[test]
fn random_problems_are_the_same_every_time_and_however_many_run_at_once() {
    let directory = tempfile::tempdir().unwrap();
    let run = |jobs: &str, count: &str| {
        let arguments = [
            "--random", count, "--seed", "3", "--over", T_MAX, "--csv", "-", "--jobs", jobs,
        ];
        well(&ran(directory.path(), &arguments))
    };
    let one = run("1", "60");
    assert_eq!(one, run("2", "60"));
    let table = rows(&one);
    assert_eq!(table.len(), 120);
    // Fewer are the first of more.
    assert_eq!(rows(&run("2", "20"))[..], table[..40]);
}

/// The rows of one run, counted here, are the rows of the other.
#[test]
fn totals_count_what_the_rows_say() {
    let directory = tempfile::tempdir().unwrap();
    let run = |more: &[&str]| {
        let same = format!("--random 80 --over {T_MAX} --csv -");
        let same = words(&same);
        well(&ran(directory.path(), &[&same[..], more].concat()))
    };
    let mut counted: HashMap<String, (u64, u64)> = HashMap::new();
    for row in rows(&run(&[])) {
        let kind = words("nodes form cohesion answers strategy verdict");
        let kind: Vec<&str> = kind.iter().map(|&name| row[name].as_str()).collect();
        let sums = counted.entry(kind.join(" ")).or_default();
        sums.0 += 1;
        sums.1 += row["minors"].parse::<u64>().unwrap();
    }
    let totals = run(&["--totals"]);
    assert_eq!(totals, run(&["--totals", "--jobs", "1"]));
    let totals = rows(&totals);
    assert_eq!(totals.len(), counted.len());
    for row in totals {
        let kind = words("nodes form cohesion answers strategy verdict");
        let kind: Vec<&str> = kind.iter().map(|&name| row[name].as_str()).collect();
        let sums = counted[&kind.join(" ")];
        let number = |name: &str| row[name].parse::<u64>().unwrap();
        assert_eq!((number("problems"), number("minors")), sums, "{row:?}");
    }
}

#[test]
fn what_table_2_makes_of_random_problems_is_counted_honestly() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = format!(
        "--random 300 --over {T_MAX} --set settings.strategy=table2 --set settings.touch=ratio --csv - --svg a.svg"
    );
    let arguments = words(&arguments);
    let output = ran(directory.path(), &arguments);
    let table = rows(&well(&output));
    let count = |verdict: &str| table.iter().filter(|r| r["verdict"] == verdict).count();
    // All of them occur, and nothing is left out.
    let words = ["converged", "wrong", "cycle", "failed"];
    assert!(words.iter().all(|word| count(word) > 0), "{table:?}");
    assert_eq!(
        words.iter().map(|word| count(word)).sum::<usize>(),
        table.len()
    );
    for row in &table {
        let violation: f64 = row["violation"].parse().unwrap();
        match row["verdict"].as_str() {
            "converged" => assert!(violation <= 1e-6),
            "wrong" => assert!(violation > 1e-6 && violation.is_finite()),
            _ => assert!(violation.is_infinite()),
        }
    }
    // A census that misses answers would be found out by those who find them; with a regular matrix it sees all.
    let missed = |r: &&HashMap<String, String>| {
        r["verdict"] == "converged" && r["answers"] == "0" && r["form"] != "singular"
    };
    assert_eq!(table.iter().filter(missed).count(), 0);
    let told = err(&output);
    assert!(told.contains("solutions by census: one in"), "{told}");
    let svg = read(directory.path(), "a.svg");
    assert!(svg.trim_end().ends_with("</svg>") && svg.contains("lagged") && svg.contains("seed 1"));
}

#[test]
fn a_random_problem_written_out_ends_as_it_did_on_the_map() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = words("--random 40 --over t_max=lagged --csv a.csv --quiet");
    well(&ran(directory.path(), &arguments));
    for row in rows(&read(directory.path(), "a.csv")) {
        let file = format!("{}.ron", row["problem"]);
        let write = ["--write", &row["problem"], "-o", &file];
        well(&ran(directory.path(), &write));
        let run = program(
            directory.path(),
            &["run", &file, "--set", "settings.t_max=lagged", "--csv", "-"],
        )
        .output()
        .unwrap();
        let ends = ["converged", "wrong"].contains(&row["verdict"].as_str());
        assert_eq!(
            code(&run),
            if ends { 0 } else { 3 },
            "{row:?} {}",
            err(&run)
        );
    }
}

#[test]
fn the_default_strategy_solves_every_random_problem_that_has_an_answer_and_invents_none() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = words("--random 200 --seed 11 --csv -");
    let table = rows(&well(&ran(directory.path(), &arguments)));
    let mut names: Vec<&str> = table.iter().map(|r| r["strategy"].as_str()).collect();
    names.dedup();
    assert_eq!(names.len(), 200 * 17);
    let by = |name: &str| {
        table
            .iter()
            .filter(|r| r["strategy"] == name)
            .collect::<Vec<_>>()
    };
    let count =
        |name: &str, verdict: &str| by(name).iter().filter(|r| r["verdict"] == verdict).count();
    let wanted = |row: &HashMap<String, String>| match row["answers"].as_str() {
        "0" => "no-answer",
        _ => "converged",
    };
    for row in by("census") {
        assert_eq!(row["verdict"], wanted(row), "{row:?}");
    }
    for row in by("ladder") {
        assert_eq!(row["verdict"], wanted(row), "{row:?}");
    }
    // Held where it touches on a straight way, a node ends in another state than a step of Coulomb's law does.
    assert!(count("table2 lagged as printed", "wrong") > 0);
    assert_eq!(count("table2 lagged", "wrong"), 0);
    assert!(count("table2 lagged", "cycle") > 0);
}

const SLOW: &str = "02-two-cantilevers-rough";

/// Two cells that take milliseconds, and two that take long.
const CELLS: [&str; 4] = [SLOW, "--over", "increment=0.5,0.25,1e-4,1.1e-4", "--jobs"];

#[cfg(unix)]
#[test]
fn a_map_that_was_killed_goes_on_where_it_was() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let cells = |increments: &str, more: &[&str]| {
        let over = format!("increment={increments}");
        let mut all = vec![SLOW, "--over", &over, "--resume", "a.log", "--jobs", "1"];
        all.extend(more);
        command(path, &all)
    };
    let mut child = cells("0.5,0.25,1e-4", &[])
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let kept = || std::fs::read_to_string(path.join("a.log")).unwrap_or_default();
    while kept().lines().count() < 4 {
        assert!(
            child.try_wait().unwrap().is_none(),
            "it should be running: {}",
            kept()
        );
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    // SIGKILL.
    child.kill().unwrap();
    child.wait().unwrap();
    let before = kept();
    assert_eq!(before.lines().count(), 4, "{before}");
    // Without the line that says what a log is of, other cells than before take up those that are kept.
    let (head, rest) = before.split_once('\n').unwrap();
    let before = format!("{head}\n{}", rest.split_once('\n').unwrap().1);
    // As if the kill had come in the middle of a line.
    std::fs::write(path.join("a.log"), before.clone() + "0123456\t(failed:No").unwrap();
    let again = cells("0.25,0.125,0.5", &["--csv", "b.csv"])
        .output()
        .unwrap();
    assert_eq!(code(&again), 0, "{}", err(&again));
    let after = kept();
    assert!(
        after.starts_with(&before) && after.lines().count() == 5,
        "{after}"
    );
    let fresh = ran(
        path,
        &[SLOW, "--over", "increment=0.25,0.125,0.5", "--csv", "c.csv"],
    );
    assert_eq!(code(&fresh), 0);
    assert_eq!(read(path, "b.csv"), read(path, "c.csv"));
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_map_with_130_and_a_whole_table_of_what_is_done() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let mut arguments = CELLS.to_vec();
    arguments.extend(["1", "--csv", "a.csv", "--svg", "a.svg", "--resume", "a.log"]);
    let child = command(path, &arguments)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let kept = || std::fs::read_to_string(path.join("a.log")).unwrap_or_default();
    while kept().lines().count() < 4 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let output = interrupted(child);
    assert!(
        err(&output).contains("interrupted after 2 of 4 cells"),
        "{}",
        err(&output)
    );
    assert_eq!(rows(&read(path, "a.csv")).len(), 2);
    assert!(read(path, "a.svg").trim_end().ends_with("</svg>"));
}

/// A map of one scene over increments and friction, with ends made up.
fn judged(ended: Vec<Option<MapRun>>) -> Map {
    let vary = |path: &str, values: &[&str]| Vary {
        path: path.to_owned(),
        values: values.iter().map(|v| v.to_string()).collect(),
    };
    let study = Study {
        vary: vec![
            vary("increment", &["0.5", "0.1", "0.25"]),
            vary("friction", &["10", "20"]),
        ],
        ..Study::from_scene(SLOW)
    };
    Map::judged(Plan::new(study).unwrap(), TOLERANCE, ended)
}

fn ended(end: f64) -> Option<MapRun> {
    let seen = |name: &str, kind, end| FinalMonitor {
        name: name.to_owned(),
        kind,
        end,
        largest: 2.0,
    };
    Some(MapRun {
        failed: None,
        increments: 5,
        majors: 5,
        minors: 5,
        unsettled: 0,
        jumped: 0,
        // The drift is a measure of error and may differ.
        monitors: vec![
            seen("u_x", MonitorKind::Length, end),
            seen("d", MonitorKind::Drift, 100.0 * end),
        ],
    })
}

#[test]
fn ends_are_compared_with_the_finest_run_of_the_same_problem() {
    let mut cycled = ended(0.0);
    cycled.as_mut().unwrap().failed = Some((
        RunVerdict::Cycle {
            period: 3,
            majors: false,
        },
        2,
        0.5,
    ));
    // Rows: increments 0.5, 0.1, 0.25; columns: friction 10, 20.
    let map = judged(vec![
        ended(1.0),
        ended(1.0),
        ended(1.01),
        cycled,
        ended(1.04),
        ended(1.04),
    ]);
    let verdict = |k: usize| map.cells[k].as_ref().unwrap().verdict;
    let reference = |k: usize| map.cells[k].as_ref().unwrap().reference;
    // Off by 0.01 of 2: half a percent.
    assert_eq!(verdict(0), RunVerdict::Right);
    assert_eq!(reference(0).unwrap().0, 2);
    assert_eq!(verdict(2), RunVerdict::Right);
    assert_eq!(verdict(4), RunVerdict::Wrong);
    // At 20 degrees the finest run failed, and the next finest is the reference.
    assert_eq!(
        verdict(3),
        RunVerdict::Cycle {
            period: 3,
            majors: false
        }
    );
    assert_eq!((reference(1).unwrap().0, reference(3)), (5, None));
    assert_eq!(verdict(1), RunVerdict::Wrong);
    assert_eq!(map.cells[3].as_ref().unwrap().label(), "↺3");
    let csv = map.csv();
    assert!(csv.contains("increment=0.1, angle=10"), "{csv}");
    let panels = map.panels();
    assert_eq!(panels.len(), 1);
    assert_eq!((panels[0].rows.len(), panels[0].columns.len()), (3, 2));
}

#[test]
fn a_run_that_nothing_can_be_compared_with_says_so() {
    let study = Study {
        vary: vec![Vary::parse("friction=10,20").unwrap()],
        ..Study::from_scene(SLOW)
    };
    let map = Map::judged(
        Plan::new(study).unwrap(),
        TOLERANCE,
        vec![ended(1.0), ended(5.0)],
    );
    let cells: Vec<_> = map.cells.iter().flatten().collect();
    assert!(
        cells
            .iter()
            .all(|c| c.verdict == RunVerdict::Right && c.reference.is_none())
    );
    assert!(
        map.csv()
            .contains("# Nothing was compared: no two finished runs")
    );
}

#[test]
fn a_scene_that_cycles_is_a_cycle_on_the_map_and_in_the_picture() {
    let directory = tempfile::tempdir().unwrap();
    let arguments =
        words("osc-two3 osc-two6 --over settings.minors=40,50 --csv - --svg a.svg --png a.png");
    let output = ran(directory.path(), &arguments);
    let table = rows(&well(&output));
    let found: Vec<_> = table
        .iter()
        .map(|r| (r["verdict"].as_str(), r["detail"].as_str()))
        .collect();
    assert_eq!(
        found,
        [
            ("cycle", "3"),
            ("cycle", "3"),
            ("cycle", "6"),
            ("cycle", "6")
        ]
    );
    let told = err(&output);
    assert!(told.contains("↺3") && told.contains("↺6"), "{told}");
    assert!(read(directory.path(), "a.svg").contains("↺6"));
    let png = std::fs::read(directory.path().join("a.png")).unwrap();
    assert_eq!(&png[1..4], b"PNG");
}

#[test]
fn multiples_are_of_each_scenes_own_value() {
    let vary = Vary::parse("increment=0.5x,2x").unwrap();
    let study = Study {
        scenes: vec![SLOW.to_owned(), "01-pinned-beam-rough-floor".to_owned()],
        vary: vec![vary],
        ..Study::from_scene(SLOW)
    };
    let plan = Plan::new(study).unwrap();
    let increments: Vec<u64> = plan.cases.iter().map(|case| case.increments).collect();
    assert_eq!(increments, [100, 25, 100, 26]);
}

#[test]
fn wrong_usage_is_refused_with_2() {
    let directory = tempfile::tempdir().unwrap();
    for (arguments, part) in [
        (vec![], "required"),
        (vec!["--random", "0"], "whole number"),
        (vec!["--random", "5", "--nodes", "0..2"], "A..B"),
        (vec!["--random", "5", "--over", "nonsense=1"], "no value"),
        (
            vec!["osc-two3", "--over", "increment=0..1"],
            "expected a range",
        ),
        (vec!["osc-two3", "--over", "nonsense=1"], "no value"),
        (vec!["osc-two3", "--random", "5"], "cannot be used"),
    ] {
        let output = ran(directory.path(), &arguments);
        refused(&output, part);
    }
}
