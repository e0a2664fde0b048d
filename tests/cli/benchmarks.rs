//! Values that are known from elsewhere: all of them hold, and one that does not is told.

use crate::program::{code, err, out, program};
use std::fs;
use std::path::Path;
use std::process::Output;

fn ran(directory: &Path, arguments: &[&str]) -> Output {
    let all = [&["study"], arguments].concat();
    program(directory, &all).output().unwrap()
}

/// A list with one benchmark, of which this is the value and the monitor.
fn list(value: &str, of: &str) -> String {
    format!(
        "(title: \"t\", benchmarks: [(scene: \"bench-pad\", what: \"w\", of: \"{of}\", over: \"across\", source: \"s\", \
         value: {value}, within: 1e-6, own: -0.3)])"
    )
}

#[test]
fn every_benchmark_holds_and_is_where_it_was() {
    let directory = tempfile::tempdir().unwrap();
    let output = ran(directory.path(), &["benchmarks", "--csv", "-"]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let table = out(&output);
    assert!(
        table.starts_with("case,what,source,value,ours,error,within,own,drift,allowed,standing\n")
    );
    assert!(table.lines().count() > 10);
    for row in table.lines().skip(1) {
        assert!(row.ends_with(",good"), "{row}");
        assert!(!row.contains(",,"), "each has a value of its own: {row}");
    }
}

#[test]
fn a_benchmark_that_does_not_hold_is_told_and_the_exit_code_says_so() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("good.ron"), list("-0.3", "along")).unwrap();
    fs::write(directory.path().join("off.ron"), list("-0.31", "along")).unwrap();
    let good = ran(directory.path(), &["good.ron"]);
    assert_eq!(code(&good), 0, "{}", err(&good));
    assert!(err(&good).contains("good.ron: 1 of 1 pass"));
    let off = ran(directory.path(), &["off.ron"]);
    assert_eq!(code(&off), 1);
    assert!(err(&off).contains("  off\n"), "{}", err(&off));
    assert!(err(&off).contains("off.ron: 0 of 1 pass"));
}

#[test]
fn what_a_list_asks_for_and_no_scene_has_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("a.ron"), list("-0.3", "allong")).unwrap();
    let wrong = ran(directory.path(), &["a.ron"]);
    assert_eq!(code(&wrong), 2);
    let told = err(&wrong);
    assert!(
        told.contains(
            ": benchmarks[0].of: scene bench-pad has no monitor \"allong\"; did you mean \"along\"?"
        ),
        "{told}"
    );
    fs::write(directory.path().join("a.ron"), list("inf", "along")).unwrap();
    let wrong = ran(directory.path(), &["a.ron"]);
    assert_eq!(code(&wrong), 2);
    assert!(
        err(&wrong)
            .starts_with("a.ron:1:108: benchmarks[0].value: value is inf; it must be finite"),
        "{}",
        err(&wrong)
    );
    for more in [
        &["--vary", "friction.angle=1,2"][..],
        &["--set", "refine=2"],
        &["--svg", "a.svg"],
    ] {
        let refused = ran(directory.path(), &[&["benchmarks"], more].concat());
        assert_eq!(code(&refused), 2, "{}", err(&refused));
    }
    assert!(!directory.path().join("a.svg").exists());
}
