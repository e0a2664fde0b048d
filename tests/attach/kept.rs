//! A kept exchange tells without the solver what was seen with it.

use super::served::{script, seen, session, start};
use super::side::{Rude, does, minor};
use libtest_mimic::Trial;
use std::path::Path;
use stickslip::attach::Attached;
use stickslip::history::verdicts::summaries;
use stickslip::record::command::{BranchTarget, Command};
use stickslip::recorded::{exchange, log::Log};
use stickslip::session::Session;

pub fn tests() -> Vec<Trial> {
    crate::tests![
        a_kept_exchange_has_every_branch_with_the_same_states,
        an_exchange_that_ended_in_a_fault_is_read_up_to_it,
    ]
}

/// Attaches, keeps the exchange, does all commands, and opens what was kept.
fn kept(restore: &str, how: &str, file: &Path) -> (Session, exchange::OpenedExchange) {
    let log = Log::default();
    log.keep(file, false).unwrap();
    let mut session = session(start("osc-lag4", restore, how), &log);
    for command in script() {
        does(&mut session, command);
    }
    let opened = open(file);
    (session, opened)
}

fn open(file: &Path) -> exchange::OpenedExchange {
    let text = std::fs::read_to_string(file).unwrap();
    exchange::open("kept", &text).unwrap_or_else(|why| panic!("{why}"))
}

fn a_kept_exchange_has_every_branch_with_the_same_states() {
    for (restore, how) in [("any", ""), ("none", ""), ("none", "partial")] {
        let folder = tempfile::tempdir().unwrap();
        let (mut session, opened) = kept(restore, how, &folder.path().join("all.exchange"));
        let lines = opened.lines.clone();
        assert!(
            lines.len() >= summaries(session.timeline().tree()).len() - 1,
            "{restore}: {} ways",
            lines.len()
        );
        let mut read = Session::attached(opened.scene, Box::new(opened.past), opened.log);
        let load = |session: &Session| session.frames()[0].state.load_factor;
        assert_eq!(load(&read), load(&session), "before the first step");
        let mut ways = Vec::new();
        for (steps, number) in lines.into_iter().zip(1..) {
            does(&mut read, Command::Goto { step: 0 });
            let label = format!("way {number}");
            let said = does(&mut read, Command::Follow { label, steps });
            assert!(!said.contains("kept"), "{said}");
            ways.push(read.frames().iter().map(seen).collect::<Vec<_>>());
        }
        for branch in 1..=summaries(session.timeline().tree()).len() {
            does(&mut session, Command::Branch(BranchTarget::Next));
            let frames = session.frames();
            let own: Vec<String> = frames.iter().map(seen).collect();
            // Changes at its end were not told to the solver.
            let solved = frames
                .iter()
                .rposition(|frame| frame.intervention.is_none())
                .unwrap_or(0);
            let found = ways.iter().any(|way| way.starts_with(&own[..=solved]));
            assert!(found, "{restore}, branch {branch}: {}", own[solved]);
        }
    }
}

fn an_exchange_that_ended_in_a_fault_is_read_up_to_it() {
    for how in [
        "ansi",
        "binary",
        "text-then-answer",
        "half",
        "exit",
        "nan",
        "escapes",
        "twice",
    ] {
        let rude = Rude::hurried(how);
        let file = rude.folder().join("kept.exchange");
        let log = Log::default();
        log.keep(&file, false).unwrap();
        let (scene, attached) = Attached::attach(rude.start.clone(), log.clone()).unwrap();
        let mut session = Session::attached(scene, Box::new(attached), log);
        for _ in 0..4 {
            does(&mut session, minor());
        }
        drop(session);
        let opened = open(&file);
        assert!(
            opened.lines.iter().any(|line| line.len() >= 2),
            "{how}: {:?}",
            opened.lines
        );
        let said = opened.log.lines().1;
        said.iter()
            .for_each(|said| super::side::is_harmless(&said.text));
        // What it wrote after the head may be lost, and the rest be cut off anywhere.
        let text = std::fs::read_to_string(&file).unwrap();
        for cut in (0..text.len())
            .step_by(97)
            .filter(|&cut| text.is_char_boundary(cut))
        {
            let _ = exchange::open("cut", &text[..cut]);
        }
        rude.is_gone();
    }
}
