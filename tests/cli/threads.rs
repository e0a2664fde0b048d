//! The same input gives the same bits on one thread and on two: every table, trace and state that is written.
//!
//! `RAYON_NUM_THREADS` is what a library that takes threads by itself would follow; `--jobs` is how many runs go side by
//! side.

use crate::program::{code, err, out, program, words};
use std::path::Path;

const BLOCKS: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/benches/two-blocks-pressed-sheared.ron"
);
const THREADS: [&str; 2] = ["1", "2"];

fn read(directory: &Path, name: &str) -> String {
    std::fs::read_to_string(directory.join(name)).unwrap()
}

#[test]
fn a_run_has_the_same_bits_on_one_thread_and_on_two() {
    for (scene, set, ends) in [
        ("01-pinned-beam-rough-floor", "history.increment=0.02", 0),
        ("02-two-cantilevers-rough", "history.increment=0.1", 0),
        ("05-cantilever-elastic-block", "history.increment=0.11", 0),
        (BLOCKS, "settings.solver=augmented", 0),
        (BLOCKS, "settings.solver=condensed", 0),
        // Large enough for the bodies to be worked on side by side.
        (BLOCKS, "refine=5", 0),
        // One body, whose elements and subtrees are worked on side by side.
        ("hertz-cylinder-on-block", "refine=3", 0),
        ("osc-inclined-cantilever", "settings.minors=30", 3),
    ] {
        let written = THREADS.map(|threads| {
            let directory = tempfile::tempdir().unwrap();
            let here = directory.path();
            let arguments = [
                "run",
                scene,
                "--quiet",
                "--csv",
                "a.csv",
                "--trace",
                "a.trace",
                "--snapshot",
                "a.ron",
                "--set",
                set,
            ];
            let mut command = program(here, &arguments);
            command.env("RAYON_NUM_THREADS", threads);
            let output = command.output().unwrap();
            assert_eq!(code(&output), ends, "{scene} {set}: {}", err(&output));
            ["a.csv", "a.trace", "a.ron"].map(|name| read(here, name))
        });
        let [one, two] = &written;
        assert!(one[1].lines().count() > 2, "{scene} {set}: no trace");
        for (name, (one, two)) in ["csv", "trace", "snapshot"].iter().zip(one.iter().zip(two)) {
            assert!(one == two, "{scene} {set}: the {name} differs");
        }
    }
}

#[test]
fn studies_and_maps_have_the_same_bits_with_one_job_and_with_two() {
    let directory = tempfile::tempdir().unwrap();
    for arguments in [
        // The first of its runs takes longest, so that with two jobs the others are done before it.
        &[
            "study",
            "05-cantilever-elastic-block",
            "--vary",
            "history.increment=0.055,0.11,0.22,0.55",
        ][..],
        &[
            "study",
            "osc-inclined-cantilever",
            "--vary",
            "friction.angle=5,20,35",
        ],
        &words("map --random 40 --seed 11 --over t_max=lagged,consistent"),
        &words("map osc-two3 osc-two6 osc-inclined-cantilever --over settings.minors=40,50"),
    ] {
        let tables = THREADS.map(|threads| {
            let more = ["--csv", "-", "--jobs", threads];
            let mut command = program(directory.path(), &[arguments, &more].concat());
            let output = command.env("RAYON_NUM_THREADS", threads).output().unwrap();
            assert!(
                [0, 3].contains(&code(&output)),
                "{arguments:?}: {}",
                err(&output)
            );
            out(&output)
        });
        let [one, two] = &tables;
        assert!(one.lines().count() > 3, "{arguments:?}: {one}");
        assert!(one == two, "{arguments:?}:\n{one}\n{two}");
    }
}
