//! Files that the program writes: what a killed run leaves, links that dangle, a disk without room.

#![cfg(unix)]

use crate::hostile::{CYCLES, refusal, run};
use crate::program::{code, err, names, program, well};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

#[test]
fn what_a_killed_run_has_left_is_swept_up_by_the_next_in_that_folder() {
    let directory = tempfile::tempdir().unwrap();
    let long = ["--set", "history.increment=1e-6"];
    let record = [
        "record",
        "01-pinned-beam-rough-floor",
        "--at",
        "400000",
        "-o",
        "a.ron",
    ];
    let mut child = program(directory.path(), &[&record[..], &long].concat())
        .spawn()
        .unwrap();
    while names(directory.path()).is_empty() {
        std::thread::sleep(Duration::from_millis(5));
    }
    // The temporary file of a run that lives is left alone.
    let other = ["record", CYCLES, "--at", "1.1.1", "-o", "b.ron"];
    well(&run(&directory, &other));
    assert_eq!(names(directory.path()).len(), 2);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(names(directory.path()).len(), 2);
    well(&run(&directory, &[&other[..], &["--force"]].concat()));
    assert_eq!(names(directory.path()), ["b.ron"]);
}

#[test]
fn force_makes_what_a_dangling_link_points_to_and_leaves_the_link() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    fs::create_dir(at("folder")).unwrap();
    symlink("folder/there", at("link")).unwrap();
    for (arguments, option) in [
        (
            &[
                "run",
                "02-two-cantilevers-smooth",
                "--set",
                "history.increment=0.5",
            ][..],
            "--csv",
        ),
        (&["record", CYCLES, "--at", "1.1.1"], "-o"),
        (&["core", CYCLES], "-o"),
    ] {
        let plain = [arguments, &[option, "link"]].concat();
        assert!(refusal(&directory, &plain).contains("exists already"));
        for _ in 0..2 {
            well(&run(&directory, &[&plain[..], &["--force"]].concat()));
            assert!(at("link").is_symlink() && !at("folder/there").is_symlink());
            assert!(fs::read_to_string(at("folder/there")).unwrap().len() > 10);
        }
        fs::remove_file(at("folder/there")).unwrap();
    }
}

#[test]
fn a_disk_without_room_is_told_and_leaves_nothing_half_written() {
    let directory = tempfile::tempdir().unwrap();
    let program = env!("CARGO_BIN_EXE_stickslip");
    for arguments in [
        "run 02-two-cantilevers-rough --trace a",
        "record 02-two-cantilevers-rough --at 1 -o a",
        "map osc-two6 osc-two3 --strategies ladder,lemke --svg a",
    ] {
        let line = format!("ulimit -f 4; exec {program} {arguments}");
        let mut shell = Command::new("sh");
        let output = shell
            .args(["-c", &line])
            .current_dir(directory.path())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", err(&output));
        assert!(
            err(&output).contains("a: the file cannot be written"),
            "{}",
            err(&output)
        );
        assert!(names(directory.path()).is_empty());
    }
    if Path::new("/dev/full").exists() {
        let told = run(
            &directory,
            &["run", "02-two-cantilevers-rough", "--trace", "/dev/full"],
        );
        assert_eq!(code(&told), 2);
        assert!(
            err(&told).contains("/dev/full: the file cannot be written"),
            "{}",
            err(&told)
        );
    }
}

#[test]
fn a_folder_that_does_not_exist_is_named_and_not_a_temporary_file_in_it() {
    let directory = tempfile::tempdir().unwrap();
    for arguments in [
        ["run", CYCLES, "--csv", "none/a.csv"],
        ["run", CYCLES, "--trace", "none/a.csv"],
        ["show", CYCLES, "-o", "none/a.csv"],
    ] {
        let told = refusal(&directory, &arguments);
        assert_eq!(
            told,
            "none/a.csv: the file cannot be written: there is no folder none\n"
        );
    }
}

#[test]
fn a_file_in_the_place_of_a_folder_is_named() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("taken"), "").unwrap();
    let told = refusal(&directory, &["run", CYCLES, "--csv", "taken/a.csv"]);
    assert_eq!(
        told,
        "taken/a.csv: the file cannot be written: taken is not a folder\n"
    );
    for arguments in [
        &["run", CYCLES, "--vtu", "taken"][..],
        &["screens", "-o", "taken"],
        &["man", "-o", "taken"],
    ] {
        let told = refusal(&directory, arguments);
        assert_eq!(
            told,
            "taken: the folder cannot be created: a file has this name\n"
        );
    }
}

/// /proc exists, but refuses new files as if it did not.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_exists_is_not_said_to_be_missing() {
    let directory = tempfile::tempdir().unwrap();
    let told = refusal(&directory, &["show", CYCLES, "-o", "/proc/a.ron"]);
    assert_eq!(
        told,
        "/proc/a.ron: the file cannot be written: the folder /proc is not writable\n"
    );
}
