//! Solvers that say too much, or do not listen: memory and time stay bounded.

use super::program::{err, out, program};
use super::side::{PATIENT, Rude, back, does, force, is_harmless, minor};
use libtest_mimic::Trial;
use std::process::{Command as Process, Stdio};
use std::time::{Duration, Instant};
use stickslip::model::Mode;
use stickslip::record::command::Unit;

pub fn tests() -> Vec<Trial> {
    crate::tests![
        a_line_without_end_is_cut_off_at_the_bound,
        floods_of_standard_error_and_of_messages_are_kept_within_bounds,
        who_talks_for_ever_is_stopped_in_time,
        a_solver_that_does_not_read_its_input_does_not_hold_the_debugger,
        one_that_does_not_hear_bye_is_ended_with_what_it_started,
        a_solver_that_computes_ends_with_the_program_however_that_ends,
    ]
}

/// Most memory that this process has had (kB).
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status
        .lines()
        .find(|line| line.starts_with("VmHWM"))
        .unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

fn a_line_without_end_is_cut_off_at_the_bound() {
    let rude = Rude::new("long");
    let mut session = rude.attach().unwrap();
    does(&mut session, minor());
    does(&mut session, minor());
    let said = does(&mut session, minor());
    assert!(
        said.contains(
            "the solver wrote a line longer than 67108864 bytes: \"{\\\"type\\\":\\\"xxx"
        ),
        "{said}"
    );
    assert!(said.len() < 400, "{said}");
    // The line, as it grows by doubling, and what other tests need.
    assert!(peak() < 700_000, "{} kB", peak());
    drop(session);
    rude.is_gone();
}

fn floods_of_standard_error_and_of_messages_are_kept_within_bounds() {
    for how in [
        "flood-stderr",
        "flood-escapes",
        "many-messages",
        "deep-beside",
        "talks-between",
        "has-a-child",
    ] {
        let rude = Rude::new(how);
        let mut session = rude.attach().unwrap();
        for _ in 0..4 {
            let said = does(&mut session, minor());
            is_harmless(&said);
            assert!(!said.contains("kept"), "{how}: {said}");
        }
        assert_eq!(session.frames().len(), 5, "{how}");
        let (_, lines) = session.connection().log().unwrap().lines();
        assert!(lines.len() <= 10_000, "{how}: {}", lines.len());
        for said in &lines {
            is_harmless(&said.text);
            assert!(said.text.chars().count() < 20_000, "{how}");
        }
        drop(session);
        rude.is_gone();
    }
}

fn who_talks_for_ever_is_stopped_in_time() {
    let rude = Rude::hurried("flood-messages");
    let mut session = rude.attach().unwrap();
    does(&mut session, minor());
    does(&mut session, minor());
    let began = Instant::now();
    let said = does(&mut session, minor());
    assert!(said.contains("did not answer step within 0.5 s"), "{said}");
    assert!(
        began.elapsed() < Duration::from_secs(10),
        "{:?}",
        began.elapsed()
    );
    drop(session);
    rude.is_gone();
}

fn a_solver_that_does_not_read_its_input_does_not_hold_the_debugger() {
    // A token that no pipe holds, sent back to one that sleeps.
    let rude = Rude::hurried("big-token");
    let mut session = rude.attach().unwrap();
    does(&mut session, minor());
    does(&mut session, minor());
    does(&mut session, back(Unit::Minor, 2));
    does(&mut session, force(Mode::Fixed, false));
    let said = does(&mut session, minor());
    assert!(
        said.contains("did not answer restore within 0.5 s"),
        "{said}"
    );
    drop(session);
    rude.is_gone();
}

fn one_that_does_not_hear_bye_is_ended_with_what_it_started() {
    let rude = Rude::new("deaf-to-bye");
    let mut session = rude.attach().unwrap();
    does(&mut session, minor());
    let began = Instant::now();
    drop(session);
    assert!(
        began.elapsed() < Duration::from_secs(5),
        "{:?}",
        began.elapsed()
    );
    rude.is_gone();
}

/// Two iterations are in the table when the third one is ended.
fn a_solver_that_computes_ends_with_the_program_however_that_ends() {
    for (signals, exit) in [
        (&["-TERM"][..], Some(130)),
        (&["-INT", "-INT"], Some(130)),
        (&["-KILL"], None),
    ] {
        let rude = Rude::new("hang-deaf");
        let mut arguments = vec!["run", "--trace", "-", "--exchange", "kept", "--"];
        arguments.extend(rude.start.command.iter().map(String::as_str));
        let mut run = program(&rude.folder(), &arguments);
        let run = run.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let run = run.unwrap();
        let began = Instant::now();
        let asked = || {
            let kept = std::fs::read_to_string(rude.folder().join("kept")).unwrap_or_default();
            kept.matches(r#"> {"type":"step"}"#).count()
        };
        while asked() < 3 {
            assert!(began.elapsed() < PATIENT);
            std::thread::sleep(Duration::from_millis(20));
        }
        let began = Instant::now();
        for signal in signals {
            let number = run.id().to_string();
            let sent = Process::new("kill").args([*signal, &number]).status();
            assert!(sent.unwrap().success());
            std::thread::sleep(Duration::from_millis(50));
        }
        let output = run.wait_with_output().unwrap();
        rude.is_gone();
        assert!(began.elapsed() < Duration::from_secs(4), "{signals:?}");
        assert_eq!(output.status.code(), exit, "{signals:?}: {}", err(&output));
        if signals == ["-TERM"] {
            assert_eq!(super::program::rows(&out(&output)).len(), 4);
            assert!(
                err(&output).contains("interrupted before"),
                "{}",
                err(&output)
            );
        }
    }
}
