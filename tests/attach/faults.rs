//! Each fault of a solver has its name; what was done before stands; and nothing of it is left.

use super::program::{code, err, out, program};
use super::served::seen;
use super::side::{PATIENT, Rude, back, does, force, is_harmless, minor};
use libtest_mimic::Trial;
use std::time::{Duration, Instant};
use stickslip::model::Mode;
use stickslip::record::command::{Command, Unit};

pub fn tests() -> Vec<Trial> {
    crate::tests![
        each_fault_of_a_step_has_a_name_and_leaves_what_was_done,
        each_fault_at_the_start_has_a_name,
        the_progress_of_a_step_is_known_while_it_lasts,
        a_stray_line_on_standard_output_is_a_warning_and_the_answer_counts,
        the_command_line_ends_with_3_after_a_fault_and_with_2_before_the_first_step,
        a_solver_that_died_once_is_started_anew_and_comes_to_the_same,
        one_that_is_another_when_started_again_is_not_believed,
        what_is_refused_is_told_and_the_solver_goes_on,
        a_restore_that_is_refused_is_done_again_from_before,
        an_interrupt_is_a_message_then_a_signal_then_the_end,
        a_hostile_scene_does_nothing_to_the_terminal,
    ]
}

/// What a solver does in its third step, whether it hangs, and what is said of it.
const FAULTS: &[(&str, bool, &str)] = &[
    (
        "exit",
        false,
        "the solver ended (exit status 7; panicked at the worst time",
    ),
    (
        "signal",
        false,
        "the solver ended (killed by signal 9) without answering step",
    ),
    (
        "bye",
        false,
        r"the solver answered step with bye: no licence\u{1b}[2J left",
    ),
    (
        "bye-silently",
        false,
        "the solver answered step with bye; all steps so far",
    ),
    (
        "hang",
        true,
        "the solver did not answer step within 0.5 s and was stopped; allow more time with --timeout",
    ),
    (
        "hang-deaf",
        true,
        "the solver did not answer step within 0.5 s",
    ),
    (
        "text",
        true,
        r#"that is not a message (not a JSON object): "Iteration 3: residual 1.0e-3"; it must print to standard error"#,
    ),
    ("binary", true, "that is not a message (not UTF-8)"),
    (
        "ansi",
        true,
        r#"(not a JSON object): "\u{1b}[2J\u{1b}]0;owned\u{7}\u{9b}31m""#,
    ),
    ("blank", true, "that is not a message (an empty line)"),
    ("number", true, r#"(not a JSON object): "42""#),
    ("array", true, "(not a JSON object)"),
    (
        "nan",
        false,
        "the solver's answer to step cannot be read (column ",
    ),
    (
        "infinity",
        false,
        "JSON has no NaN and infinity; write null instead",
    ),
    (
        "null",
        false,
        "at.increment: null is not valid; expected a whole number from 0",
    ),
    (
        "word",
        false,
        r#"contacts[1].f_n: "much" is not valid; expected a number"#,
    ),
    (
        "mode",
        false,
        r"contacts[1].mode: unknown variant `open\u{1b}[2J`, expected one of `free`, `sliding`, `fixed`",
    ),
    (
        "zero",
        false,
        "the solver's state is invalid: at: counters must be from 1 to",
    ),
    (
        "huge",
        false,
        "the solver's state is invalid: at: counters must be from 1 to",
    ),
    (
        "wrong-id",
        false,
        r"the solver's state is invalid: contacts[1].id is \u{1b}[2Jb; it must be 7, as in the scene",
    ),
    (
        "other-order",
        false,
        "contacts[0].id is 7; it must be a, as in the scene",
    ),
    (
        "partial-stranger",
        false,
        "contact \"8\" is not in the scene, or not in its order",
    ),
    (
        "partial-nameless",
        false,
        "a state without all contacts needs their ids",
    ),
    ("too-few", false, "it has 1 contact; the scene has 2"),
    ("too-many", false, "it has 3 contacts; the scene has 2"),
    (
        "displacements",
        false,
        "it has 1 displacement; the scene has 4 nodes",
    ),
    ("normal", false, "contacts[0].normal: must have length 1"),
    ("cut-to-nothing", false, "size: must be positive"),
    (
        "half",
        false,
        r#"the solver ended in the middle of a line: "{\"type\":\"state\",\"at\":{\"incr""#,
    ),
    (
        "half-and-hang",
        true,
        "the solver did not answer step within 0.5 s",
    ),
    ("deep", false, "recursion limit exceeded"),
    ("key-twice", false, "at: duplicate field `minor`"),
    ("type-twice", false, "duplicate field `type`"),
    (
        "level",
        false,
        "cannot be read (unknown variant `panic`, expected one of `info`, `warning`, `error`)",
    ),
    (
        "unknown-type",
        false,
        r"unknown variant `stat\u{1b}[2J`, expected one of `hello`, `scene`, `state`",
    ),
    ("no-type", false, "missing field `type`"),
    (
        "ok",
        false,
        "the solver answered step with ok; expected state",
    ),
    (
        "saved",
        false,
        "the solver answered step with saved; expected state",
    ),
    (
        "refuses-step",
        false,
        "the solver refuses step: I would rather not",
    ),
    (
        "closes",
        false,
        "the solver ended (standard output closed) without answering step",
    ),
    (
        "leaves-a-child",
        false,
        "the solver ended (exit status 5; a child process keeps its output open) without answering step",
    ),
];

/// What it does after its third step, and what is said of it: before the next request, or in the place of its answer, as it
/// comes.
const AFTER: &[(&str, [&str; 2])] = &[
    (
        "twice",
        [
            "the solver sent state before ",
            "the solver answered save with state; expected saved",
        ],
    ),
    (
        "unasked",
        [
            "the solver sent ok before ",
            "the solver answered save with ok; expected saved",
        ],
    ),
    (
        "exits-between",
        [
            "the solver ended (exit status 4",
            "the solver ended (exit status 4",
        ],
    ),
    (
        "junk-between",
        [
            r#"(not a JSON object): "done.""#,
            "what it prints belongs on standard error",
        ],
    ),
];

#[track_caller]
fn says(how: &str, said: &str, told: &str) {
    assert!(said.contains(told), "{how}: {said}");
    assert!(
        said.ends_with("; all steps so far are kept"),
        "{how}: {said}"
    );
    is_harmless(said);
    assert!(!said.contains('\n'), "{how}: {said}");
}

fn each_fault_of_a_step_has_a_name_and_leaves_what_was_done() {
    std::thread::scope(|scope| {
        for &(how, hangs, told) in FAULTS {
            scope.spawn(move || {
                let rude = if hangs {
                    Rude::hurried(how)
                } else {
                    Rude::new(how)
                };
                let mut session = rude
                    .attach()
                    .unwrap_or_else(|fault| panic!("{how}: {fault}"));
                for _ in 0..2 {
                    does(&mut session, minor());
                }
                assert_eq!(session.frames().len(), 3, "{how}");
                let before = session.frames()[2].clone();
                let began = Instant::now();
                says(how, &does(&mut session, minor()), told);
                assert!(
                    began.elapsed() < Duration::from_secs(20),
                    "{how} takes {:?}",
                    began.elapsed()
                );
                assert_eq!((session.frames().len(), session.cursor()), (3, 2), "{how}");
                assert_eq!(session.frames()[2].state, before.state, "{how}");
                assert_eq!(seen(&session.frames()[2]), seen(&before), "{how}");
                // It is tried again, from a solver that is started again or taken back, and does the same wrong.
                if !hangs {
                    says(how, &does(&mut session, minor()), told);
                }
                let lines = session.connection().log().unwrap().lines().1;
                lines.iter().for_each(|said| is_harmless(&said.text));
                drop(session);
                rude.is_gone();
            });
        }
        for &(how, told) in AFTER {
            scope.spawn(move || {
                let rude = Rude::new(how);
                let mut session = rude
                    .attach()
                    .unwrap_or_else(|fault| panic!("{how}: {fault}"));
                let mut said = String::new();
                // What comes after the answer may come after the next request.
                for _ in 0..5 {
                    said = does(&mut session, minor());
                    if said.ends_with("kept") {
                        break;
                    }
                }
                let log = session.connection().log().unwrap().lines().1;
                let is_told = |text: &str| told.iter().any(|told| text.contains(told));
                let noted = log.iter().any(|line| is_told(&line.text));
                assert!(is_told(&said) || noted, "{how}: {said}\n{log:#?}");
                assert!(
                    session.frames().len() >= 4,
                    "{how}: {}",
                    session.frames().len()
                );
                drop(session);
                rude.is_gone();
            });
        }
    });
}

fn the_progress_of_a_step_is_known_while_it_lasts() {
    let mut rude = Rude::new("progress-and-hang");
    rude.start.answer = Duration::from_secs(3);
    let mut session = rude.attach().unwrap();
    for _ in 0..2 {
        does(&mut session, minor());
    }
    let log = session.connection().log().unwrap().clone();
    assert_eq!(log.progress(), None);
    let seen = std::thread::spawn({
        let log = log.clone();
        move || {
            let until = Instant::now() + PATIENT;
            while Instant::now() < until && log.progress().is_none() {
                std::thread::sleep(Duration::from_millis(10));
            }
            log.progress()
        }
    });
    does(&mut session, minor());
    let seen = seen.join().unwrap().expect("the solver reported it");
    assert!(seen.ends_with("CG 30 of 200"), "{seen}");
    is_harmless(&seen);
    assert_eq!(log.progress(), None, "the request has ended");
    drop(session);
    rude.is_gone();
}

fn a_stray_line_on_standard_output_is_a_warning_and_the_answer_counts() {
    let rude = Rude::new("text-then-answer");
    let mut session = rude.attach().unwrap();
    for _ in 0..4 {
        does(&mut session, minor());
    }
    assert_eq!(session.frames().len(), 5);
    let log = session.connection().log().unwrap().lines().1;
    let warning = "is not a message (not a JSON object): \"Iteration 3: residual 1.0e-3\"";
    assert!(
        log.iter().any(|line| line.text.contains(warning)),
        "{log:#?}"
    );
    drop(session);
    rude.is_gone();
}

/// What a solver does at its start, and what is said of it.
const BAD_STARTS: &[(&str, &str)] = &[
    (
        "hang-at-start",
        "did not answer hello within 4 s and was stopped; allow more time with --start-timeout",
    ),
    ("hang-in-scene", "did not answer scene within 4 s"),
    (
        "dies-in-scene",
        "the solver ended (exit status 3) without answering scene",
    ),
    (
        "version",
        "the solver uses version 3 of the protocol; this program supports versions 1 and 2",
    ),
    ("refuses-to-talk", "the solver refuses hello: not with you"),
    (
        "scene-for-hello",
        "the solver answered hello with scene; expected hello",
    ),
    ("hello-without-question", "hello"),
    (
        "parameter-twice",
        r#"the solver's hello is invalid: parameter "gain": duplicate name"#,
    ),
    (
        "parameter-unsound",
        "its current value is invalid: gain takes a number from 0 on, and -1 is none",
    ),
    (
        "parameter-null",
        "the value must be a number, a flag or a text",
    ),
    (
        "same-id",
        "the solver's scene is invalid: contacts[1].id: a is already used",
    ),
    (
        "no-such-node",
        "contacts[1].node: there is no node 4; nodes are numbered from 0 to 3",
    ),
    (
        "no-contacts",
        "contacts: the list is empty, so there is nothing to step",
    ),
    ("far-apart", "nodes: they are too far apart"),
];

fn each_fault_at_the_start_has_a_name() {
    std::thread::scope(|scope| {
        for &(how, told) in BAD_STARTS {
            scope.spawn(move || {
                let mut rude = Rude::new(how);
                if how.starts_with("hang") {
                    // Hello comes in time on a busy machine, too.
                    rude.start.start = Duration::from_secs(4);
                }
                let fault = rude
                    .attach()
                    .err()
                    .unwrap_or_else(|| panic!("{how} goes well"));
                assert!(fault.to_string().contains(told), "{how}: {fault}");
                is_harmless(&fault.to_string());
                rude.is_gone();
            });
        }
    });
    let mut nobody = Rude::new("");
    nobody.start.command = vec!["/no/such/solver".into()];
    let fault = nobody.attach().err().expect("there is none").to_string();
    assert!(
        fault.starts_with("/no/such/solver cannot be started: No such file"),
        "{fault}"
    );
}

fn the_command_line_ends_with_3_after_a_fault_and_with_2_before_the_first_step() {
    let runs = |how: &str| {
        let rude = Rude::new(how);
        let folder = rude.folder();
        let mut arguments = vec![
            "run",
            "--trace",
            "-",
            "--timeout",
            "1",
            "--start-timeout",
            "20",
            "--",
        ];
        arguments.extend(rude.start.command.iter().map(String::as_str));
        let output = program(&folder, &arguments).output().unwrap();
        let (out, err) = (out(&output), err(&output));
        is_harmless(&out);
        is_harmless(&err);
        rude.is_gone();
        (code(&output), out, err)
    };
    std::thread::scope(|scope| {
        for how in [
            "exit",
            "signal",
            "bye",
            "hang-deaf",
            "ansi",
            "nan",
            "half",
            "leaves-a-child",
            "refuses-step",
            "unknown-type",
        ] {
            scope.spawn(move || {
                let (code, out, err) = runs(how);
                assert_eq!(code, 3, "{how}: {err}");
                // Heads, and two iterations of two contacts.
                let rows = out.lines().filter(|line| !line.starts_with('#')).count();
                assert_eq!(rows, 5, "{how}: {out}");
                assert!(err.contains("the solver"), "{how}: {err}");
            });
        }
        for how in ["version", "dies-in-scene", "same-id"] {
            scope.spawn(move || {
                let (code, out, err) = runs(how);
                assert_eq!((code, out.as_str()), (2, ""), "{how}: {err}");
                assert!(err.contains("the solver"), "{how}: {err}");
            });
        }
        scope.spawn(move || {
            let (code, _, err) = runs("failure");
            assert_eq!(code, 3, "{err}");
            assert!(
                err.contains(r"it \u{1b}[31mdiverges\u{1b}[0m\u{a}at once"),
                "{err}"
            );
        });
    });
}

fn a_solver_that_died_once_is_started_anew_and_comes_to_the_same() {
    let rude = Rude::new("dies-once");
    let mut session = rude.attach().unwrap();
    does(&mut session, minor());
    does(&mut session, minor());
    let said = does(&mut session, minor());
    assert!(said.contains("the solver ended (exit status 1)"), "{said}");
    let said = does(&mut session, minor());
    assert!(
        said.starts_with("the solver was restarted and repeated 2 iterations; "),
        "{said}"
    );
    assert_eq!(session.frames().len(), 4);
    let whole = Rude::new("none");
    let mut other = whole.attach().unwrap();
    (0..3).for_each(|_| {
        does(&mut other, minor());
    });
    assert_eq!(seen(session.frame()), seen(other.frame()));
    assert_eq!(session.frame().state, other.frame().state);
    drop((session, other));
    rude.is_gone();
    whole.is_gone();
    assert_eq!(rude.pids().len(), 2);
}

fn one_that_is_another_when_started_again_is_not_believed() {
    for (how, told) in [
        (
            "random",
            "when repeated, iteration 2 of the solver differed (",
        ),
        (
            "other-scene",
            "after a restart, the solver reports a different list of contacts",
        ),
        ("other-parameters", "after a restart, the solver reports"),
    ] {
        let rude = Rude::new(how);
        let mut session = rude.attach().unwrap();
        for _ in 0..5 {
            does(&mut session, minor());
        }
        does(&mut session, back(Unit::Minor, 3));
        does(&mut session, force(Mode::Fixed, false));
        says(how, &does(&mut session, minor()), told);
        drop(session);
        rude.is_gone();
    }
}

fn what_is_refused_is_told_and_the_solver_goes_on() {
    for how in ["refuses-force", "refuses-save"] {
        let rude = Rude::new(how);
        let mut session = rude.attach().unwrap();
        does(&mut session, minor());
        let force = Command::Force {
            slave: 1,
            mode: Mode::Fixed,
            hold: false,
        };
        does(&mut session, force);
        let said = does(&mut session, minor());
        let log = session.connection().log().unwrap().lines().1;
        match how {
            "refuses-force" => says(
                how,
                &said,
                "the solver refuses force of contact 7: I would rather not",
            ),
            _ => {
                assert_eq!(
                    session.frame().event.as_ref().unwrap().nodes[1]
                        .decision
                        .before,
                    Mode::Fixed
                );
                assert!(
                    log.iter()
                        .any(|said| said.text == "save was refused: I would rather not")
                );
            }
        }
        // The way without it is open.
        does(&mut session, back(Unit::Minor, 9));
        assert_eq!(session.cursor(), 0);
        drop(session);
        rude.is_gone();
    }
}

fn a_restore_that_is_refused_is_done_again_from_before() {
    let rude = Rude::new("refuses-restore");
    let mut session = rude.attach().unwrap();
    for _ in 0..4 {
        does(&mut session, minor());
    }
    does(&mut session, back(Unit::Minor, 2));
    does(&mut session, force(Mode::Sliding, false));
    let said = does(&mut session, minor());
    assert!(said.contains("repeated 2 iterations"), "{said}");
    assert_eq!(
        session.frame().event.as_ref().unwrap().nodes[0]
            .decision
            .before,
        Mode::Sliding
    );
    drop(session);
    rude.is_gone();
}

fn an_interrupt_is_a_message_then_a_signal_then_the_end() {
    // It listens: it ends its iteration, which counts.
    let interrupted = |how: &str| {
        let rude = Rude::new(how);
        let mut session = rude.attach().unwrap();
        does(&mut session, minor());
        does(&mut session, minor());
        session.submit(minor()).unwrap();
        // On a busy machine the step may arrive after the first interrupt, which is then lost, and a solver takes a while to end.
        let mut said = None;
        while said.is_none() {
            let until = Instant::now() + Duration::from_millis(2500);
            while said.is_none() && Instant::now() < until {
                std::thread::sleep(Duration::from_millis(10));
                said = session.poll();
            }
            session.interrupt();
        }
        let said = said.unwrap().0;
        let frames = session.frames().len();
        drop(session);
        rude.is_gone();
        (said, frames)
    };
    let (said, frames) = interrupted("interrupt");
    assert_eq!(frames, 4, "{said}");
    let (said, frames) = interrupted("hang");
    assert!(
        said.contains("the solver ended (killed by signal 2)"),
        "{said}"
    );
    assert_eq!(frames, 3);
    for deaf in ["hang-deaf", "interrupt-ignored"] {
        let (said, frames) = interrupted(deaf);
        assert!(
            said.contains("interrupted: the solver did not stop during step and was ended"),
            "{said}"
        );
        assert_eq!(frames, 3);
    }
}

fn a_hostile_scene_does_nothing_to_the_terminal() {
    let rude = Rude::new("escapes");
    let folder = rude.folder();
    for arguments in [
        &["run", "--trace", "-", "--"][..],
        &["run", "--csv", "-", "--"],
        &["run", "--"],
        &["record", "--at", "1", "-o", "-", "--"],
        &["attach", "--check", "--"],
    ] {
        let mut arguments = arguments.to_vec();
        arguments.extend(rude.start.command.iter().map(String::as_str));
        let output = program(&folder, &arguments).output().unwrap();
        // Its contact carries a force across a gap.
        match arguments[0] {
            "run" => assert_eq!(code(&output), 3, "{}", err(&output)),
            _ => assert!(code(&output) < 2, "{}", err(&output)),
        }
        is_harmless(&out(&output));
        is_harmless(&err(&output));
        if arguments[1] == "--trace" {
            assert_eq!(super::program::rows(&out(&output)).len(), 24);
        }
    }
    rude.is_gone();
}
