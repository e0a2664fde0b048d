//! Sweeps in pieces: shards put together are the whole, byte for byte, whatever became of their logs on the way.

use crate::program::{code, err, program, refused, well, words};
use proptest::prelude::*;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;
use stickslip_exchange::seal::sealed;

fn command(directory: &Path, words: &str, more: &[&str]) -> Command {
    let words: Vec<&str> = words
        .split_whitespace()
        .chain(more.iter().copied())
        .collect();
    program(directory, &words)
}

fn ran(directory: &Path, words: &str, more: &[&str]) -> Output {
    command(directory, words, more).output().unwrap()
}

fn bytes(directory: &Path, name: &str) -> Vec<u8> {
    std::fs::read(directory.join(name)).unwrap()
}

const MAP: &str = "map osc-two3 --over friction=5..45/6 --over increment=0.5,0.25,0.2";
const FAILING: &str =
    "map osc-two3 osc-two6 --over settings.minors=40,50 --over increment=0.5,0.25";
const RANDOM: &str = "map --random 60 --seed 3 --set strategy=table2 --set touch=ratio --over t_max=lagged,consistent";
const STUDY: &str =
    "study 02-two-cantilevers-rough --vary increment=0.5,0.25 --vary friction=5,10,30";
const CHART: &str = "chart 04-cantilever-rigid-circle --over refine=1,2 --set history.increment=0.5 --cost minors --repeats 1";

/// Runs shards 1 to N, each with a log of its own.
fn shards(directory: &Path, words: &str, of: usize) -> Vec<String> {
    let name = |k: usize| format!("{k}-of-{of}.log");
    for k in 1..=of {
        let shard = format!("{k}/{of}");
        well(&ran(
            directory,
            words,
            &["--shard", &shard, "--log", &name(k)],
        ));
    }
    (1..=of).map(name).collect()
}

fn merged(directory: &Path, words: &str, logs: &[String], more: &[&str]) -> Output {
    let logs: Vec<&str> = logs.iter().map(String::as_str).collect();
    ran(directory, words, &[&["--merge"], &logs[..], more].concat())
}

const ALL: [&str; 6] = ["--csv", "a.csv", "--svg", "a.svg", "--png", "a.png"];
const AGAIN: [&str; 6] = ["--csv", "b.csv", "--svg", "b.svg", "--png", "b.png"];

#[test]
fn shards_put_together_are_the_whole_byte_for_byte_in_any_order_and_with_overlaps() {
    for words in [MAP, FAILING, RANDOM, STUDY] {
        let directory = tempfile::tempdir().unwrap();
        let here = directory.path();
        let whole = ran(here, words, &ALL);
        well(&whole);
        let mut logs = shards(here, words, 3);
        logs.extend(shards(here, words, 2));
        logs.push(logs[1].clone());
        logs.reverse();
        let output = merged(here, words, &logs, &AGAIN);
        well(&output);
        for kind in ["csv", "svg", "png"] {
            let [one, other] = ["a", "b"].map(|name| bytes(here, &format!("{name}.{kind}")));
            assert!(one == other, "{words}: the {kind} differs");
        }
        assert_eq!(err(&output), err(&whole), "{words}");
    }
}

/// Times are measured, and differ; costs that are counted do not.
#[test]
fn a_chart_by_what_is_counted_is_the_same_from_shards_but_for_its_times() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    well(&ran(here, CHART, &ALL));
    let mut logs = shards(here, CHART, 2);
    logs.extend(shards(here, CHART, 1));
    well(&merged(here, CHART, &logs, &AGAIN));
    assert!(bytes(here, "a.svg") == bytes(here, "b.svg"));
    assert!(bytes(here, "a.png") == bytes(here, "b.png"));
    let untimed = |name: &str| {
        let text = String::from_utf8(bytes(here, name)).unwrap();
        let rows = crate::program::rows(&text);
        let untimed = rows.into_iter().map(|mut row| {
            assert!(row.remove("seconds").unwrap().parse::<f64>().unwrap() > 0.0);
            let mut row: Vec<_> = row.into_iter().collect();
            row.sort();
            row
        });
        untimed.collect::<Vec<_>>()
    };
    assert_eq!(untimed("a.csv"), untimed("b.csv"));
    // Of the logs alone everything is the same, times too.
    logs.reverse();
    well(&merged(here, CHART, &logs, &["--csv", "c.csv"]));
    assert!(bytes(here, "b.csv") == bytes(here, "c.csv"));
}

/// The rows of a table without its comments, sorted.
fn sorted(csv: &str) -> Vec<&str> {
    let mut rows: Vec<&str> = csv.lines().filter(|line| !line.starts_with('#')).collect();
    rows.sort_unstable();
    rows
}

#[test]
fn rows_of_all_shards_are_those_of_the_whole() {
    for words in [MAP, FAILING, RANDOM, STUDY] {
        let directory = tempfile::tempdir().unwrap();
        let here = directory.path();
        let whole = well(&ran(here, words, &["--csv", "-"]));
        let parts = ["1/3", "2/3", "3/3"].map(|shard| {
            let csv = well(&ran(here, words, &["--shard", shard, "--csv", "-"]));
            let rows: Vec<String> = sorted(&csv).iter().map(|row| row.to_string()).collect();
            rows
        });
        let mut all = parts.concat();
        all.sort_unstable();
        // The header stands once in each.
        all.dedup();
        assert_eq!(all, sorted(&whole), "{words}");
    }
}

#[test]
fn options_and_logs_of_sums_are_refused_with_what_replaces_them() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    for option in [["--aggregate", "5"], ["--failing", "a.csv"]] {
        let output = ran(here, MAP, &option);
        assert_eq!(code(&output), 2);
        let told = err(&output);
        assert!(told.starts_with(option[0]), "{told}");
        assert!(told.contains("--shard K/N --csv FILE"), "{told}");
    }
    well(&ran(here, MAP, &["--log", "a.log"]));
    let text = String::from_utf8(bytes(here, "a.log")).unwrap();
    let lines = text.lines().map(|line| {
        let of_sums = line.replace("what:\"map\"", "what:\"map, as sums\"");
        let unsealed = of_sums.rsplit_once('\t').map(|(line, _)| sealed(line));
        unsealed.unwrap_or(of_sums) + "\n"
    });
    std::fs::write(here.join("b.log"), lines.collect::<String>()).unwrap();
    for option in ["--log", "--merge", "--resume"] {
        let output = ran(here, MAP, &[option, "b.log"]);
        assert_eq!(code(&output), 2);
        let told = err(&output);
        assert!(
            told.starts_with("b.log: it contains sums of `--aggregate`"),
            "{told}"
        );
    }
}

#[test]
fn missing_cells_are_named_with_the_command_that_does_them() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    for words in [MAP, RANDOM, STUDY] {
        let whole = well(&ran(here, words, &["--csv", "-"]));
        let logs = shards(here, words, 3);
        std::fs::remove_file(here.join(&logs[1])).unwrap();
        let some = [logs[0].clone(), logs[2].clone()];
        let output = merged(here, words, &some, &["--csv", "b.csv"]);
        assert_eq!(code(&output), 4, "{}", err(&output));
        assert!(!here.join("b.csv").exists());
        let told = err(&output);
        assert!(told.contains(" are missing (numbers from 0"), "{told}");
        let command = told.lines().find(|line| line.starts_with("  stickslip "));
        let command = command.unwrap().trim().strip_prefix("stickslip ").unwrap();
        assert!(
            command.contains("--shard 2/3 --log shard-2-of-3.log"),
            "{told}"
        );
        well(&ran(here, command, &[]));
        let logs = [&some[..], &["shard-2-of-3.log".to_owned()]].concat();
        assert_eq!(well(&merged(here, words, &logs, &["--csv", "-"])), whole);
        for log in std::fs::read_dir(here).unwrap() {
            std::fs::remove_file(log.unwrap().path()).unwrap();
        }
    }
}

#[test]
fn logs_of_something_else_are_refused_with_the_reason() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    well(&ran(here, MAP, &["--log", "a.log"]));
    let others = [
        (
            "map osc-two3 --over friction=5..45/6 --over increment=0.5,0.25",
            "increment over",
        ),
        (
            "map osc-two6 --over friction=5..45/6 --over increment=0.5,0.25,0.2",
            "a different scene",
        ),
        (STUDY, "belong to map, not to study"),
        (RANDOM, "belong to map, not to map --random"),
    ];
    for (words, why) in others {
        for part in [["--merge", "a.log"], ["--log", "a.log"]] {
            let output = ran(here, words, &part);
            assert_eq!(code(&output), 2, "{words}");
            let told = err(&output);
            assert!(
                told.starts_with("a.log: its results") && told.contains(why),
                "{told}"
            );
        }
    }
    let text = String::from_utf8(bytes(here, "a.log")).unwrap();
    let (first, rest) = text.split_once('\n').unwrap();
    std::fs::write(
        here.join("b.log"),
        format!("stickslip 0.0.1 results, abc\n{rest}"),
    )
    .unwrap();
    let told = err(&merged(here, MAP, &["b.log".to_owned()], &[]));
    assert!(
        told.starts_with("b.log:1:1: written by another revision"),
        "{told}"
    );
    // Another value of a cell.
    let last = rest.trim_end().rsplit('\n').next().unwrap();
    let (last, _) = last.rsplit_once('\t').unwrap();
    let changed = sealed(&last.replacen("minors:", "minors:9", 1));
    std::fs::write(here.join("c.log"), format!("{first}\n{changed}\n")).unwrap();
    for order in [["a.log", "c.log"], ["c.log", "a.log"]] {
        let output = merged(here, MAP, &order.map(str::to_owned), &[]);
        assert_eq!(code(&output), 2);
        let told = err(&output);
        let named = [
            "angle=",
            "increment=",
            "two results that differ",
            "a.log:",
            "c.log:2",
        ];
        assert!(named.iter().all(|part| told.contains(part)), "{told}");
    }
    // A cell of no such map.
    let key = "0".repeat(32);
    let value = last.split_once('\t').unwrap().1;
    let line = sealed(&format!("{key}\t{value}"));
    std::fs::write(here.join("d.log"), format!("{text}{line}\n")).unwrap();
    let told = err(&merged(here, MAP, &["d.log".to_owned()], &[]));
    let line = text.lines().count() + 1;
    assert!(told.starts_with(&format!("d.log:{line}:1: ")), "{told}");
}

#[test]
fn a_part_is_no_table_and_a_shard_is_k_of_n() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    for (more, why) in [
        (&["--shard", "1/3"][..], "--log"),
        (&["--shard", "0/3", "--log", "a"], "K/N"),
        (&["--shard", "4/3", "--log", "a"], "K/N"),
        (&words("--shard 1/3 --log a --svg a.svg"), "with --merge"),
        (&["--log", "a", "--merge", "b"], "cannot be used"),
        (&["--resume", "a", "--merge", "b"], "cannot be used"),
        (
            &["--merge", "none.log"],
            "none.log: the file cannot be read",
        ),
    ] {
        let output = ran(here, MAP, more);
        refused(&output, why);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Whatever a kill leaves of a log, the same command goes on, and the whole is the same.
    #[test]
    fn a_log_that_was_cut_anywhere_goes_on_to_the_same_whole(cut in 0.0_f64..1.0, torn in 0_usize..2) {
        let directory = tempfile::tempdir().unwrap();
        let here = directory.path();
        let words = "map osc-two3 --over friction=5,10,20,40 --over increment=0.5,0.25";
        let whole = well(&ran(here, words, &["--csv", "-"]));
        let logs = shards(here, words, 2);
        let text = bytes(here, &logs[torn]);
        let length = (cut * text.len() as f64) as usize;
        std::fs::write(here.join(&logs[torn]), &text[..length]).unwrap();
        // As it is, the rest is missing, or it is whole already.
        let output = merged(here, words, &logs, &["--csv", "-"]);
        let lines = text[..length].iter().filter(|&&byte| byte == b'\n').count();
        let all = text.iter().filter(|&&byte| byte == b'\n').count();
        prop_assert_eq!(code(&output), if lines == all { 0 } else { 4 }, "{}", err(&output));
        let shard = format!("{}/2", torn + 1);
        well(&ran(here, words, &["--shard", &shard, "--log", &logs[torn]]));
        prop_assert_eq!(bytes(here, &logs[torn]).len(), text.len());
        prop_assert_eq!(well(&merged(here, words, &logs, &["--csv", "-"])), whole);
    }
}

fn signalled(child: std::process::Child, signal: &str) -> Output {
    let killed = Command::new("kill")
        .args([signal, &child.id().to_string()])
        .status();
    assert!(killed.unwrap().success());
    child.wait_with_output().unwrap()
}

#[test]
fn sigterm_stops_a_shard_with_130_and_the_same_command_goes_on() {
    for words in [
        "map 02-two-cantilevers-rough --over increment=0.5,0.4,0.3,0.25,0.2,0.1,1e-4,1.1e-4,1.2e-4,1.3e-4,1.4e-4,1.5e-4 --jobs 1",
        "study 02-two-cantilevers-rough --vary increment=0.5,0.4,0.3,0.25,0.2,0.1,1e-4,1.1e-4,1.2e-4,1.3e-4,1.4e-4,1.5e-4 --jobs 1",
        "map --random 100000 --strategies table2,ladder --jobs 1",
    ] {
        let directory = tempfile::tempdir().unwrap();
        let here = directory.path();
        let part = ["--shard", "1/2", "--log", "a.log"];
        let mut child = command(here, words, &part);
        let mut child = child.stderr(Stdio::piped()).spawn().unwrap();
        let lines = || {
            let text = std::fs::read_to_string(here.join("a.log")).unwrap_or_default();
            text.lines().count()
        };
        while lines() < 3 {
            assert!(
                child.try_wait().unwrap().is_none(),
                "{words}: it should be running"
            );
            std::thread::sleep(Duration::from_millis(5));
        }
        // Another one waits for nobody, and says that it may be tried again.
        let second = ran(here, words, &part);
        assert_eq!(code(&second), 75, "{}", err(&second));
        assert!(err(&second).contains("another run is writing to this file"));
        let output = signalled(child, "-TERM");
        assert_eq!(code(&output), 130, "{words}: {}", err(&output));
        let told = err(&output);
        assert!(
            told.contains("of shard 1/2; repeat the command to continue"),
            "{told}"
        );
        let before = bytes(here, "a.log");
        assert!(before.ends_with(b"\n"));
        let mut again = command(here, words, &part);
        let mut again = again.stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(300));
        // A short rest may be done by now.
        match again.try_wait().unwrap() {
            Some(status) => assert!(status.success()),
            None => assert_eq!(code(&signalled(again, "-TERM")), 130),
        }
        assert!(bytes(here, "a.log").starts_with(&before));
    }
}
