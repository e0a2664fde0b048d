//! Work-precision charts: what they measure, against what, and that failures are drawn.

use crate::program::{code, err, program, refused, well, words};
use std::collections::HashMap;
use std::path::Path;
use std::process::Output;

fn ran(directory: &Path, arguments: &[&str]) -> Output {
    let chart = [&["chart"], arguments].concat();
    program(directory, &chart).output().unwrap()
}

/// A chart's output and its table.
fn charted(directory: &Path, line: &str) -> (Output, Vec<HashMap<String, String>>) {
    let output = ran(directory, &words(line));
    let table = rows(&output);
    (output, table)
}

fn rows(output: &Output) -> Vec<HashMap<String, String>> {
    crate::program::rows(&well(output))
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column]
        .parse()
        .unwrap_or_else(|_| panic!("{column}: {row:?}"))
}

const CIRCLE: &str = "04-cantilever-rigid-circle";
const BEAM: &str = "01-pinned-beam-rough-floor";

#[test]
fn the_elastica_is_the_reference_of_problem_04_and_the_cheapest_mesh_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = format!(
        "{CIRCLE} --over refine=1,2,4 --set history.increment=0.5 --target 2e-4 --cost minors --repeats 1 \
            --csv - --svg a.svg --png a.png"
    );
    let (output, table) = charted(directory.path(), &arguments);
    let errors: Vec<f64> = table.iter().map(|r| number(r, "error")).collect();
    // As in `tests/physics/references.rs`, but u_y, which is small, on its own scale.
    let limits = [1.1e-3, 4e-4, 1.1e-4];
    assert!(
        errors.iter().zip(limits).all(|(e, limit)| *e < limit),
        "{errors:?}"
    );
    assert!(errors.windows(2).all(|e| e[1] < e[0]));
    assert!(
        table
            .iter()
            .all(|r| number(r, "seconds") > 0.0 && r["increments"] == "15")
    );
    let told = err(&output);
    assert!(
        told.contains("04-cantilever-rigid-circle.csv Cantilever wrapping"),
        "{told}"
    );
    assert!(told.contains("at 15 fixed loads"), "{told}");
    let cheapest = told
        .lines()
        .find(|l| l.starts_with("The cheapest run with an error of at most 0.0002"));
    assert!(cheapest.unwrap().contains("refine=4"), "{told}");
    let svg = std::fs::read_to_string(directory.path().join("a.svg")).unwrap();
    for part in [
        "minor iterations",
        "on the Pareto front",
        "target 0.0002",
        "Scene: 04",
        "cores",
        "failed",
    ] {
        assert!(svg.contains(part), "{part}");
    }
    let png = std::fs::read(directory.path().join("a.png")).unwrap();
    assert_eq!(&png[1..4], b"PNG");
}

#[test]
fn without_a_table_the_finest_run_is_the_reference_and_says_so() {
    let directory = tempfile::tempdir().unwrap();
    let (output, table) = charted(
        directory.path(),
        "05-cantilever-elastic-block --over refine=1,2 --set history.path[1]=0.1 --set \
            history.increment=0.1 --repeats 1 --csv -",
    );
    assert_eq!(
        (table[0]["status"].as_str(), table[1]["status"].as_str()),
        ("whole", "reference")
    );
    assert!(
        number(&table[0], "error") > 1e-6 && table[1]["error"].is_empty(),
        "{table:?}"
    );
    assert!(
        err(&output).contains("the finest run of the set (refine, refine=2)"),
        "{}",
        err(&output)
    );
}

#[test]
fn a_run_that_fails_is_a_row_and_a_cross_on_the_rail() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = format!(
        "{BEAM} --set history.jumps=stop --over majors=60,1 --repeats 1 --csv - --svg a.svg"
    );
    let (_, table) = charted(directory.path(), &arguments);
    assert_eq!(table[0]["status"], "whole");
    assert!(number(&table[0], "error") < 1e-8, "{table:?}");
    // Of 0.01, the increment was cut six times, down to the least.
    assert_eq!(table[1]["status"], "major-limit at load 1.5625e-4");
    assert!(table[1]["error"].is_empty() && table[1]["front"] == "false");
    let svg = std::fs::read_to_string(directory.path().join("a.svg")).unwrap();
    assert!(
        svg.contains("✗ majors, majors=1: major-limit") && svg.contains("#C00000"),
        "{svg}"
    );
}

#[test]
fn a_chart_is_measured_by_any_monitor_contact_forces_included() {
    let directory = tempfile::tempdir().unwrap();
    let common = words("--over increment=0.05,0.025 --repeats 1 --csv -");
    let by = |names: &[&str]| {
        let by: Vec<&str> = names.iter().flat_map(|name| ["--by", *name]).collect();
        let more = ["--svg", "a.svg", "--force"];
        ran(
            directory.path(),
            &[&[BEAM], &common[..], &by[..], &more[..]].concat(),
        )
    };
    let force = by(&["contact_x"]);
    let errors: Vec<f64> = rows(&force).iter().map(|r| number(r, "error")).collect();
    assert!(errors.iter().all(|e| *e < 1e-8), "{errors:?}");
    assert!(
        err(&force).contains("difference of contact_x, each relative to"),
        "{}",
        err(&force)
    );
    let svg = std::fs::read_to_string(directory.path().join("a.svg")).unwrap();
    assert!(
        svg.contains("error of contact_x (relative to the largest)"),
        "{svg}"
    );
    let displacement: Vec<f64> = rows(&by(&["u_x"]))
        .iter()
        .map(|r| number(r, "error"))
        .collect();
    assert_ne!(errors, displacement);
    let none = by(&["no_such"]);
    assert_eq!(code(&none), 2);
    assert!(
        err(&none).contains("no monitor no_such") && err(&none).contains("u_x"),
        "{}",
        err(&none)
    );
}

#[test]
fn a_table_of_ones_own_is_a_reference_with_its_legs() {
    let directory = tempfile::tempdir().unwrap();
    let fine = program(
        directory.path(),
        &words(&format!(
            "run {BEAM} --set history.increment=0.05 --csv own.csv"
        )),
    )
    .output()
    .unwrap();
    assert!(fine.status.success());
    let arguments =
        format!("{BEAM} --over increment=0.05,0.025 --reference own.csv --repeats 1 --csv -");
    let (output, table) = charted(directory.path(), &arguments);
    // The same run as its own reference, over both legs: on the way back each load has another displacement.
    assert_eq!(number(&table[0], "error"), 0.0);
    assert!(number(&table[1], "error") < 1e-6, "{table:?}");
    assert!(
        err(&output).contains("at 10 fixed loads"),
        "{}",
        err(&output)
    );
}

#[test]
fn the_middle_of_the_times_is_taken_and_the_counts_are_those_of_a_run() {
    let directory = tempfile::tempdir().unwrap();
    // With only the end of the load path as fixed load, the runs are those of the scene.
    let own = "load,u_x,u_y\n3.5,0.44235571,-0.13909487\n";
    std::fs::write(directory.path().join("end.csv"), own).unwrap();
    let arguments =
        format!("{CIRCLE} --over increment=0.5,1.75 --reference end.csv --repeats 3 --csv -");
    let (_, table) = charted(directory.path(), &arguments);
    for row in &table {
        assert_eq!(row["repeats"], "3");
        let [least, middle, most] = ["fastest", "seconds", "slowest"].map(|head| number(row, head));
        assert!(0.0 < least && least <= middle && middle <= most, "{row:?}");
    }
    let run = program(
        directory.path(),
        &words(&format!("run {CIRCLE} --set history.increment=0.5 --csv -")),
    )
    .output()
    .unwrap();
    let text = String::from_utf8(run.stdout).unwrap();
    let counted: u64 = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(2).unwrap().parse::<u64>().unwrap())
        .sum();
    assert_eq!(table[0]["majors"], counted.to_string());
}

#[test]
fn an_error_does_not_depend_on_the_other_runs_and_a_target_names_no_run_that_misses_it() {
    let directory = tempfile::tempdir().unwrap();
    let chart = |increments: &str| {
        let line = format!(
            "{CIRCLE} --over refine=2 --over increment={increments} --target 1e-4 --repeats 1 --csv -"
        );
        ran(directory.path(), &words(&line))
    };
    // The error of the run itself, over all loads of the elastica.
    let run = format!("run {CIRCLE} --set refine=2 --set history.increment=0.25 --csv -");
    let run = program(directory.path(), &words(&run)).output().unwrap();
    let text = include_str!("../../problems/references/04-cantilever-rigid-circle.csv");
    let exact: Vec<Vec<f64>> = text
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
        .map(|line| line.split(',').map(|word| word.parse().unwrap()).collect())
        .collect();
    let mut worst = 0.0_f64;
    for row in crate::program::rows(&well(&run)) {
        let at = |exact: &&Vec<f64>| (exact[0] - number(&row, "load")).abs() < 1e-9;
        let exact_row = exact.iter().find(at).unwrap();
        for (k, name) in [(1, "u_x"), (2, "u_y")] {
            let scale = exact.iter().map(|row| row[k].abs()).fold(0.0, f64::max);
            worst = worst.max((number(&row, name) - exact_row[k]).abs() / scale);
        }
    }
    assert!(worst > 1e-4, "{worst}");
    for increments in ["0.25", "0.25,1.75"] {
        let output = chart(increments);
        let error = number(&rows(&output)[0], "error");
        assert!(
            error >= worst * (1.0 - 1e-6),
            "{increments}: {error}, {worst}"
        );
        assert!(
            err(&output).contains("No run has an error of at most 0.0001"),
            "{}",
            err(&output)
        );
    }
}

#[test]
fn contact_forces_have_a_panel_and_a_richardson_reference_has_an_error_bar() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = "05-cantilever-elastic-block --over refine=1,2,4 --set history.path[1]=0.1 --set \
                     history.increment=0.1 --reference richardson --repeats 1 --csv a.csv --svg a.svg";
    let output = ran(directory.path(), &words(arguments));
    assert!(output.status.success(), "{}", err(&output));
    let table = std::fs::read_to_string(directory.path().join("a.csv")).unwrap();
    assert!(table.contains("Richardson extrapolation of refine (refine=1; refine=2; refine=4)"));
    let svg = std::fs::read_to_string(directory.path().join("a.svg")).unwrap();
    for part in [
        "error of u_x (relative",
        "error of contact_x, contact_y (relative",
        "error bar of the reference",
        "Triangle: the error of",
    ] {
        assert!(svg.contains(part), "{part}");
    }
    // Drawn again, with cost and error exchanged.
    let again = "--from a.csv --error-on-x --csv - --svg b.svg";
    let table = rows(&ran(directory.path(), &words(again)));
    let bars = ["uncertainty", "force_uncertainty"].map(|head| number(&table[2], head));
    for (column, bar) in ["error", "force_error"].into_iter().zip(bars) {
        let errors: Vec<f64> = table.iter().map(|row| number(row, column)).collect();
        assert!(errors[0] > errors[1] && errors[1] > errors[2], "{errors:?}");
        // The bar is the finest run's distance from the limit, with a factor of safety.
        assert!(bar >= errors[2] && errors[2] > 0.0, "{bar} {errors:?}");
    }
    let two = "05-cantilever-elastic-block --over refine=1,2 --set history.path[1]=0.1 --set \
               history.increment=0.1 --reference richardson --repeats 1";
    let output = ran(directory.path(), &words(two));
    refused(&output, "needs three finished runs");
    let failing =
        "osc-p5-slow --over history.increment=0.4,0.2,0.1 --reference richardson --repeats 1";
    let output = ran(directory.path(), &words(failing));
    refused(&output, "; increment=0.1: major-limit at load");
}

#[test]
fn rows_of_peers_are_series_of_the_chart_of_their_scene() {
    let directory = tempfile::tempdir().unwrap();
    let peers = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/peers/04-cantilever-rigid-circle.csv"
    );
    let own = "load,u_x,u_y\n3.5,0.44235571,-0.13909487\n";
    std::fs::write(directory.path().join("end.csv"), own).unwrap();
    let arguments = format!(
        "{CIRCLE} --over refine=1 --set history.increment=0.5 --reference end.csv --repeats 1 --csv - --svg a.svg --peers"
    );
    let arguments = [words(&arguments), vec![peers]].concat();
    let output = ran(directory.path(), &arguments);
    let table = rows(&output);
    let peers: Vec<&str> = table.iter().map(|row| row["series"].as_str()).collect();
    assert_eq!((table.len(), peers[0]), (14, "refine"));
    assert!(peers[1].starts_with("CalculiX") && peers[13].starts_with("GetFEM"));
    let svg = std::fs::read_to_string(directory.path().join("a.svg")).unwrap();
    assert!(svg.contains("GetFEM 5.4.2, penalty") && svg.contains("Peers: errors of the tip"));
    let other = [
        &[
            "01-pinned-beam-rough-floor",
            "--over",
            "increment=0.05",
            "--peers",
        ],
        &arguments[arguments.len() - 1..],
    ];
    let output = ran(directory.path(), &other.concat());
    refused(&output, "no chart of the scene 04");
}

#[test]
fn wrong_usage_is_refused_with_2() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("bad.csv"), "load,u_x\n1,x\n").unwrap();
    for (arguments, part) in [
        (vec![], "required"),
        (vec![CIRCLE, "--target", "0"], "a positive number"),
        (vec![CIRCLE, "--cost", "money"], "one of time"),
        (vec![CIRCLE, "--over", "nonsense=1"], "no value"),
        (
            vec![BEAM, "--over", "increment=0.05", "--reference", "bad.csv"],
            "bad.csv:2:3: \"x\" under u_x",
        ),
        (
            vec![BEAM, "--over", "increment=0.05", "--reference", "none.csv"],
            "none.csv: ",
        ),
        (vec!["no-such-scene"], "no such file"),
    ] {
        let output = ran(directory.path(), &arguments);
        refused(&output, part);
    }
}

#[test]
fn a_table_is_drawn_again_as_it_was_and_tables_of_other_programs_too() {
    let directory = tempfile::tempdir().unwrap();
    let first =
        format!("{CIRCLE} --over refine=1,2 --set history.increment=0.5 --repeats 1 --csv a.csv");
    let first = words(&first);
    assert!(ran(directory.path(), &first).status.success());
    let output = ran(directory.path(), &words("--from a.csv --csv - --target 1"));
    let again = rows(&output);
    let table = std::fs::read_to_string(directory.path().join("a.csv")).unwrap();
    assert_eq!(again.len(), 2);
    for row in &again {
        assert!(table.contains(&row["error"]) && table.contains(&row["seconds"]));
    }
    assert!(
        err(&output).contains("The cheapest run with an error of at most 1.0"),
        "{}",
        err(&output)
    );
    let peers = "# two programs\nscene,series,run,status,error,seconds\nA,one,\"n=1, m=2\",whole,1e-3,0.5\nA,two,n=1,died,,9\n";
    std::fs::write(directory.path().join("peers.csv"), peers).unwrap();
    let output = ran(
        directory.path(),
        &words("--from peers.csv --svg b.svg --csv -"),
    );
    let table = rows(&output);
    assert_eq!(
        (table[0]["run"].as_str(), table[0]["front"].as_str()),
        ("n=1, m=2", "true")
    );
    let svg = std::fs::read_to_string(directory.path().join("b.svg")).unwrap();
    assert!(svg.contains("✗ two, n=1: died") && svg.contains("two programs"));
    for (text, part) in [
        ("", "no header"),
        ("a,b\n", "not the table of a chart"),
        ("scene,series,run,status,error,seconds\n", "no rows"),
        (
            "scene,series,run,status,error,seconds\nA,b,c,whole,x,1\n",
            "c.csv:2:13: \"x\" under error",
        ),
        (
            "scene,series,run,status,error,seconds\nA,b,c\n",
            "c.csv:2:1: the row has 3 fields",
        ),
    ] {
        std::fs::write(directory.path().join("c.csv"), text).unwrap();
        let output = ran(directory.path(), &["--from", "c.csv"]);
        refused(&output, part);
    }
}
