//! `attach --check` passes a solver that does what it says, and names what is wrong of one that does not.

use super::program::{code, err, out, program};
use super::served::{start, stickslip};
use super::side::Rude;
use libtest_mimic::Trial;
use stickslip::attach::check::{Report, Verdict, check};
use stickslip::recorded::log::Log;

pub fn tests() -> Vec<Trial> {
    crate::tests![
        our_own_solver_passes_every_check,
        a_solver_can_be_interrupted_if_this_program_ignores_signals,
        each_wrong_is_found_by_its_check,
        an_increment_that_was_given_up_is_counted_and_the_next_one_checked,
        the_command_line_tells_it_and_ends_with_1,
        a_check_keeps_the_exchange_of_every_start_in_the_file_that_is_named,
    ]
}

fn verdict(report: &Report, what: &str) -> Verdict {
    let found = report.checks.iter().find(|check| check.what == what);
    found
        .unwrap_or_else(|| panic!("{what}: {}", report.text()))
        .verdict
        .clone()
}

fn our_own_solver_passes_every_check() {
    std::thread::scope(|scope| {
        for (name, restore, how) in [
            ("osc-lag4", "any", ""),
            ("02-two-cantilevers-rough", "increment", ""),
            ("osc-three10", "none", ""),
            ("osc-two6", "none", "partial"),
        ] {
            scope.spawn(move || {
                let report = check(&start(name, restore, how), &Log::default());
                assert_eq!(report.failed(), 0, "{name}: {}", report.text());
                for what in [
                    "step",
                    "answers",
                    "states",
                    "order",
                    "determinism",
                    "force",
                    "hold",
                    "parameters",
                    "increment",
                    "friction",
                    "problem",
                    "wrong requests",
                    "bye",
                    "end of input",
                ] {
                    assert_eq!(
                        verdict(&report, what),
                        Verdict::Good,
                        "{name}, {what}: {}",
                        report.text()
                    );
                }
                let back = if restore == "none" {
                    Verdict::NotOffered
                } else {
                    Verdict::Good
                };
                assert_eq!(
                    verdict(&report, "restore"),
                    back,
                    "{name}: {}",
                    report.text()
                );
            });
        }
    });
}

/// What a solver does wrong, the check that finds it, and what it says.
const WRONGS: &[(&str, &str, &str)] = &[
    ("version", "start", "uses version 3"),
    ("same-id", "scene", "a is already used"),
    ("text-then-answer", "output", "is not a message"),
    ("nan", "step", "write null instead"),
    ("wrong-id", "states", "it must be 7, as in the scene"),
    (
        "displacements",
        "states",
        "it has 1 displacement; the scene has 4 nodes",
    ),
    ("random", "determinism", "after a restart, iteration"),
    ("restores-another", "restore", "after restoring iteration"),
    (
        "refuses-restore",
        "restore",
        "was refused: I would rather not",
    ),
    (
        "refuses-save",
        "restore",
        "save after iteration 0 was refused",
    ),
    ("dies-in-restore", "restore", "exit status 9"),
    ("deaf-to-force", "force", "is forced"),
    ("second-not-forced", "force", "contact 7 is forced"),
    ("refuses-force", "force", "I would rather not"),
    ("holds-once", "hold", "is held"),
    (
        "refuses-release",
        "hold",
        "release of contact a was refused",
    ),
    (
        "refuses-set",
        "parameters",
        "gain refuses its current value",
    ),
    (
        "takes-all",
        "parameters",
        "gain accepts the invalid value -1.0",
    ),
    ("problem-short", "problem", "4 rows of 4 numbers"),
    (
        "problem-negative",
        "problem",
        "the diagonal is negative at contact a along n",
    ),
    ("problem-null", "problem", "matrix[0][1]: null is not valid"),
    ("load-drifts", "order", "in the same attempt"),
    ("deaf-to-bye", "bye", "does not end"),
];

fn each_wrong_is_found_by_its_check() {
    std::thread::scope(|scope| {
        for &(how, what, told) in WRONGS {
            scope.spawn(move || {
                let rude = Rude::new(how);
                let report = check(&rude.start, &Log::default());
                let Verdict::Fails(mend) = verdict(&report, what) else {
                    panic!("{how}: {}", report.text());
                };
                assert!(!mend.is_empty(), "{how}");
                let failed = report
                    .checks
                    .iter()
                    .find(|check| check.what == what && matches!(check.verdict, Verdict::Fails(_)));
                let found = &failed.unwrap().found;
                assert!(found.contains(told), "{how}: {found}");
                super::side::is_harmless(&report.text().replace("rude", ""));
                rude.is_gone();
            });
        }
        for (how, what, told) in [
            ("upside-down", "laws", "compression is positive"),
            ("flat", "problem", "gap = W f + q"),
            ("flat-first", "problem", "gap = W f + q"),
            ("deaf", "increment", "`load` must be the load factor"),
        ] {
            scope.spawn(move || {
                let report = check(
                    &start("02-two-cantilevers-rough", "any", how),
                    &Log::default(),
                );
                let Verdict::Fails(mend) = verdict(&report, what) else {
                    panic!("{how}: {}", report.text());
                };
                assert!(mend.contains(told), "{how}: {mend}");
            });
        }
    });
}

fn an_increment_that_was_given_up_is_counted_and_the_next_one_checked() {
    for (how, told) in [
        ("gives-up", "; 3 increments accepted, 1 given up"),
        ("nothing", "; 4 increments accepted, 0 given up"),
    ] {
        let report = check(&Rude::new(how).start, &Log::default());
        let text = report.text();
        let step = report.checks.iter().find(|check| check.what == "step");
        let found = &step.unwrap().found;
        assert!(
            found.starts_with("12 iterations, ") && found.ends_with(told),
            "{text}"
        );
        for what in ["order", "determinism", "restore"] {
            assert_eq!(verdict(&report, what), Verdict::Good, "{text}");
        }
    }
}

fn the_command_line_tells_it_and_ends_with_1() {
    let folder = tempfile::tempdir().unwrap();
    let rude = Rude::new("holds-once");
    let mut arguments = vec!["attach", "--check", "--"];
    arguments.extend(rude.start.command.iter().map(String::as_str));
    let output = program(folder.path(), &arguments).output().unwrap();
    assert_eq!(code(&output), 1, "{}", err(&output));
    assert!(
        out(&output).contains("  FAILS        hold"),
        "{}",
        out(&output)
    );
    assert_eq!(err(&output), "1 check failed\n");
    let output = program(
        folder.path(),
        &["attach", "--check", "--", stickslip(), "serve", "osc-lag4"],
    )
    .output()
    .unwrap();
    assert_eq!(
        (code(&output), err(&output).as_str()),
        (0, ""),
        "{}",
        out(&output)
    );
}

fn a_check_keeps_the_exchange_of_every_start_in_the_file_that_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let run = |options: &[&str]| {
        let solver = ["--", stickslip(), "serve", "osc-lag4"];
        let arguments = [
            &["attach", "--check", "--exchange", "kept.exchange"],
            options,
            &solver,
        ]
        .concat();
        program(folder.path(), &arguments).output().unwrap()
    };
    let output = run(&[]);
    // On a busy machine answers are slow, which is a finding.
    assert!(code(&output) < 2, "{}", err(&output));
    let text = std::fs::read_to_string(folder.path().join("kept.exchange")).unwrap();
    let lines = stickslip_exchange::attach::TranscriptLine::read(&text).unwrap();
    let started = lines
        .iter()
        .filter(|kept| kept.text.starts_with("started: "));
    assert!(started.count() > 10, "{} lines", lines.len());
    let last = lines.iter().rfind(|kept| kept.text.contains("\"type\""));
    assert!(last.is_some());
    let again = run(&[]);
    assert_eq!(code(&again), 2);
    assert!(err(&again).contains("--force"), "{}", err(&again));
    assert!(code(&run(&["--force"])) < 2);
}

/// Shells start background jobs with SIGINT ignored, which processes inherit.
fn a_solver_can_be_interrupted_if_this_program_ignores_signals() {
    if !cfg!(target_os = "linux") {
        return;
    }
    for (signal, number) in [("INT", 2), ("QUIT", 3), ("TERM", 15)] {
        let script = format!(
            "trap '' INT QUIT TERM; exec \"$0\" attach --check -- sh -c 'kill -{signal} $$; exit 7'"
        );
        let mut shell = std::process::Command::new("sh");
        let output = shell.args(["-c", &script, env!("CARGO_BIN_EXE_stickslip")]);
        let text = out(&output.output().unwrap());
        let wanted = format!("killed by signal {number}");
        assert!(text.contains(&wanted), "{signal}: {text}");
    }
}
