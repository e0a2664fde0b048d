//! Exchanges that were recorded with version 1 of the protocol, byte for byte: their requests to the present solver, and their
//! answers to the present debugger. Only `hello` has new keys.

use super::served::{session, stickslip};
use super::side::{PATIENT, does, own};
use libtest_mimic::Trial;
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::process::{Command as Process, ExitCode, Stdio};
use stickslip::attach::Start;
use stickslip::model::Mode;
use stickslip::record::command::{Command, Unit};
use stickslip::recorded::log::Log;
use stickslip_exchange::attach::{Side, TranscriptLine};

/// The first argument that starts the solver that answers as it was recorded.
pub const NAME: &str = "--replay";
/// `stickslip attach -- stickslip serve osc-lag4` of revision b08cc42: steps, saved states, problems, forces, parameters.
const SERVED: &str = include_str!("version-1.exchange");
/// A walk with Kratos, which was started twice.
const WALK: &str = include_str!("../../problems/lessons/kratos-walk.exchange");

pub fn tests() -> Vec<Trial> {
    crate::tests![
        recorded_requests_have_the_recorded_answers,
        a_recorded_solver_is_sent_the_recorded_requests,
    ]
}

/// The messages of an exchange, from each start.
fn starts(text: &str) -> Vec<Vec<TranscriptLine>> {
    let mut starts = Vec::new();
    for line in TranscriptLine::read(text).unwrap() {
        match line.side {
            Side::Noted if line.text.starts_with("started") => starts.push(Vec::new()),
            Side::Asked | Side::Answered => starts.last_mut().unwrap().push(line),
            _ => {}
        }
    }
    starts
}

fn json(line: &str) -> Value {
    serde_json::from_str(line).unwrap()
}

fn is_hello(line: &str) -> bool {
    json(line)["type"] == "hello"
}

/// Fails unless the keys of a hello are those of then, and the versions.
fn only_versions_were_added(now: &str, then: &str) {
    let (mut now, then) = (json(now), json(then));
    for key in ["protocols", "reads"] {
        now.as_object_mut().unwrap().remove(key);
    }
    let is_added = |key: &&String| then.get(key).is_none();
    let added: Vec<&String> = now.as_object().unwrap().keys().filter(is_added).collect();
    assert!(added.is_empty(), "{added:?}");
    for key in ["protocol", "name", "version", "abilities"] {
        assert_eq!(now[key], then[key]);
    }
}

fn recorded_requests_have_the_recorded_answers() {
    let served = Process::new(stickslip())
        .args(["serve", "osc-lag4"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn();
    let mut served = served.unwrap();
    let mut input = served.stdin.take().unwrap();
    let mut output = BufReader::new(served.stdout.take().unwrap()).lines();
    let [lines] = &starts(SERVED)[..] else {
        panic!("one start");
    };
    let mut count = 0;
    for line in lines {
        match line.side {
            Side::Asked => writeln!(input, "{}", line.text).unwrap(),
            _ => {
                let answer = output.next().unwrap().unwrap();
                match is_hello(&answer) {
                    true => only_versions_were_added(&answer, &line.text),
                    false => assert_eq!(answer, line.text),
                }
                count += 1;
            }
        }
    }
    assert!(count > 50, "{count}");
    assert!(output.next().is_none());
    assert!(served.wait().unwrap().success());
}

/// Answers as it was recorded, and ends at the first request that is another one. The argument is a file with a letter per start.
pub fn main(arguments: &[String]) -> ExitCode {
    let started = std::fs::read_to_string(&arguments[0]).unwrap_or_default();
    std::fs::write(&arguments[0], format!("{started}x")).unwrap();
    let mut requests = std::io::stdin().lines();
    for line in &starts(WALK)[started.len()] {
        if line.side == Side::Answered {
            println!("{}", line.text);
            continue;
        }
        let Some(Ok(request)) = requests.next() else {
            return ExitCode::FAILURE;
        };
        if request != line.text && !is_hello(&request) {
            eprintln!("{request} instead of {}", line.text);
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

fn a_recorded_solver_is_sent_the_recorded_requests() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let log = Log::default();
    log.keep(at("again.exchange").as_ref(), false).unwrap();
    let solver = Start {
        start: PATIENT,
        answer: PATIENT,
        ..Start::new(vec![own(), NAME.into(), at("starts")])
    };
    let mut session = session(solver, &log);
    let run = Command::Forward {
        unit: Unit::Run,
        count: 1,
    };
    let force = |slave, mode, hold| Command::Force { slave, mode, hold };
    for command in [
        run.clone(),
        force(0, Mode::Fixed, false),
        force(1, Mode::Fixed, false),
        run.clone(),
        Command::Goto { step: 16 },
        force(0, Mode::Sliding, true),
        force(1, Mode::Sliding, true),
        run,
    ] {
        does(&mut session, command);
    }
    drop(session);
    let text = std::fs::read_to_string(at("again.exchange")).unwrap();
    let (now, then) = (starts(&text), starts(WALK));
    assert_eq!(now.len(), then.len());
    for (now, then) in now.iter().flatten().zip(then.iter().flatten()) {
        assert_eq!(now.side, then.side, "{}", now.text);
        match now.side == Side::Asked && is_hello(&now.text) {
            true => only_versions_were_added(&now.text, &then.text),
            false => assert_eq!(now.text, then.text),
        }
    }
    assert_eq!(
        now.iter().map(Vec::len).sum::<usize>(),
        then.iter().map(Vec::len).sum::<usize>()
    );
}
