//! Solvers that keep their loops: the clients that `stickslip attach --c`, `--fortran` and `--python` print, in the smallest solver.

use super::common::examined;
use super::program::program;
use super::served::session;
use super::side::{PATIENT, does, minor};
use libtest_mimic::Trial;
use std::path::Path;
use std::process::{Command as Process, Stdio};
use std::time::{Duration, Instant};
use stickslip::attach::check::{Verdict, check};
use stickslip::attach::{C, FORTRAN, PYTHON, Start};
use stickslip::model::Mode;
use stickslip::record::command::{Command, Unit};
use stickslip::recorded::log::Log;

pub fn tests() -> Vec<Trial> {
    crate::tests![
        a_solver_in_c_fortran_or_python_keeps_its_loops_and_passes_every_check,
        the_examples_are_short,
        a_branch_of_a_forked_state_leaves_the_other_one_as_it_was,
        the_copies_of_a_process_end_with_each_other_and_with_the_program,
        values_that_repeat_and_long_periods_are_found,
        a_solver_in_c_in_space_has_its_swing_found,
    ]
}

const SOURCES: [(&str, &str); 5] = [
    ("loops.c", include_str!("loops.c")),
    ("loops.f90", include_str!("loops.f90")),
    ("loops.py", include_str!("loops.py")),
    ("loops_3d.c", include_str!("loops_3d.c")),
    ("repeats.py", include_str!("repeats.py")),
];
const HEADER: [&str; 11] = [
    "cc",
    "-std=c99",
    "-pedantic",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-x",
    "c",
    "-DSS_IMPLEMENTATION",
    "-c",
    "stickslip_attach.h",
];

fn built(folder: &Path, commands: &[&[&str]]) {
    let clients = [
        ("stickslip_attach.h", C),
        ("stickslip_attach.f90", FORTRAN),
        ("stickslip_attach.py", PYTHON),
    ];
    for (name, text) in clients.iter().chain(&SOURCES) {
        std::fs::write(folder.join(name), text).unwrap();
    }
    for command in commands {
        let done = Process::new(command[0])
            .args(&command[1..])
            .current_dir(folder)
            .output();
        let done = done.unwrap();
        assert!(
            done.status.success(),
            "{}",
            String::from_utf8_lossy(&done.stderr)
        );
    }
}

/// The path of a C program that was built with the header.
fn built_in_c(folder: &Path, name: &str) -> String {
    let header = [&HEADER[..], &["-o", "stickslip_c.o"]].concat();
    let source = format!("{name}.c");
    built(
        folder,
        &[
            &header,
            &["cc", &source, "stickslip_c.o", "-lm", "-o", name],
        ],
    );
    folder.join(name).display().to_string()
}

fn start(command: &[&str]) -> Start {
    Start {
        start: PATIENT,
        answer: PATIENT,
        ..Start::new(command.iter().map(|word| (*word).to_owned()).collect())
    }
}

/// C everywhere; the other two where the system has them.
fn a_solver_in_c_fortran_or_python_keeps_its_loops_and_passes_every_check() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let c = built_in_c(folder.path(), "loops");
    let has = |program: &str| Process::new(program).arg("--version").output().is_ok();
    let mut commands = vec![vec![c]];
    if has("gfortran") {
        let fortran = [
            "gfortran",
            "stickslip_attach.f90",
            "loops.f90",
            "stickslip_c.o",
            "-o",
            "loops_f",
        ];
        built(folder.path(), &[&fortran]);
        commands.push(vec![at("loops_f")]);
    }
    if has("python3") {
        commands.push(vec!["python3".to_owned(), at("loops.py")]);
    }
    for command in commands {
        let words: Vec<&str> = command.iter().map(String::as_str).collect();
        let report = check(&start(&words), &Log::default());
        assert_eq!(report.failed(), 0, "{}", report.text());
        let restored = report
            .checks
            .iter()
            .find(|check| check.what == "restore")
            .unwrap();
        assert_eq!(restored.verdict, Verdict::Good);
        assert!(
            restored.found.starts_with("40 states restored"),
            "{}",
            restored.found
        );
    }
}

/// Code lines, one statement each: neither blank nor comments.
fn the_examples_are_short() {
    for (name, text) in &SOURCES[..3] {
        let (most, comment) = match name.rsplit('.').next() {
            Some("c") => (20, "/*"),
            Some("f90") => (40, "!"),
            _ => (30, "\"\"\""),
        };
        let lines = text.lines().map(str::trim);
        let code: Vec<&str> = lines
            .filter(|line| !line.is_empty() && !line.starts_with(comment))
            .collect();
        assert!(code.len() <= most, "{name}: {} lines", code.len());
        for line in code {
            let ends = line.trim_end_matches(';').matches(';').count();
            let allowed = if line.starts_with("for (") { 2 } else { 0 };
            assert!(ends <= allowed && line.len() <= 120, "{name}: {line}");
        }
    }
}

/// The processes of a solver in this folder, oldest first.
fn processes(folder: &Path) -> Vec<i32> {
    let name = folder.display().to_string();
    let all = std::fs::read_dir("/proc").unwrap();
    let numbers = all.filter_map(|entry| entry.unwrap().file_name().to_str()?.parse().ok());
    let is_solver = |number: &i32| {
        let command = std::fs::read_to_string(format!("/proc/{number}/cmdline"));
        let command = command.unwrap_or_default();
        let mut words = command.split('\0').take(2);
        words.any(|word| word.starts_with(&name))
    };
    let mut found: Vec<i32> = numbers.filter(is_solver).collect();
    found.sort_unstable();
    found
}

fn are_gone(folder: &Path) {
    let began = Instant::now();
    while !processes(folder).is_empty() {
        let left = processes(folder);
        assert!(began.elapsed() < Duration::from_secs(5), "left: {left:?}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn kill(process: u32) {
    let number = process.to_string();
    let sent = Process::new("kill").args(["-KILL", &number]).status();
    assert!(sent.unwrap().success());
}

fn the_copies_of_a_process_end_with_each_other_and_with_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let c = built_in_c(folder.path(), "loops");
    let at = |name: &str| folder.path().join(name).display().to_string();
    let python = at("loops.py");
    for command in [vec![&*c], vec!["python3", &python]] {
        let mut session = session(start(&command), &Log::default());
        for _ in 0..4 {
            does(&mut session, minor());
        }
        let copies = processes(folder.path());
        assert_eq!(copies.len(), 6, "{copies:?}");
        // The copy that steps is the last one.
        kill(copies[5] as u32);
        let began = Instant::now();
        let said = does(&mut session, minor());
        assert!(said.contains("its process ended: signal 9"), "{said}");
        assert!(began.elapsed() < Duration::from_secs(3));
        drop(session);
        are_gone(folder.path());
        // A socket is not closed with the process group of a command.
        let unix = format!("unix:{}", at("socket"));
        for listen in [&[][..], &["--listen", &unix]] {
            if listen.len() == 2 && command.len() == 1 {
                continue; // The C header knows no addresses.
            }
            let arguments = [&["attach", "--check"], listen, &["--"], &command].concat();
            let mut check = program(folder.path(), &arguments);
            let mut check = check.stdout(Stdio::null()).spawn().unwrap();
            let began = Instant::now();
            while processes(folder.path()).len() < 3 {
                assert!(began.elapsed() < PATIENT);
                std::thread::sleep(Duration::from_millis(2));
            }
            kill(check.id());
            check.wait().unwrap();
            are_gone(folder.path());
        }
    }
}

fn a_branch_of_a_forked_state_leaves_the_other_one_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let command = built_in_c(folder.path(), "loops");
    let mut session = session(start(&[&command]), &Log::default());
    let forward = |count| Command::Forward {
        unit: Unit::Minor,
        count,
    };
    does(&mut session, forward(4));
    let modes = |session: &stickslip::session::Session| -> Vec<Mode> {
        let frames = session.frames().iter().skip(1);
        frames
            .map(|frame| frame.event.as_ref().unwrap().nodes[0].decision.before)
            .collect()
    };
    let period = [Mode::Free, Mode::Fixed];
    assert_eq!(modes(&session), [period, period].concat());
    let page = examined(&mut session, Vec::new()).lines().join("\n");
    assert!(page.contains("cycle of period 2"), "{page}");
    // Another branch from the third iteration, and back to the end of the first one.
    does(&mut session, Command::Goto { step: 3 });
    does(
        &mut session,
        Command::Force {
            slave: 0,
            mode: Mode::Fixed,
            hold: true,
        },
    );
    does(&mut session, forward(2));
    let last = session.frames().last().unwrap().event.clone().unwrap();
    assert_eq!(last.nodes[0].decision.before, Mode::Fixed);
    does(&mut session, Command::Goto { step: 0 });
    does(&mut session, forward(1));
    assert_eq!(session.cursor(), 1);
}

fn values_that_repeat_and_long_periods_are_found() {
    let folder = tempfile::tempdir().unwrap();
    built(folder.path(), &[]);
    let script = folder.path().join("repeats.py").display().to_string();
    for (period, repeats, told) in [
        ("3", "values", "stays sliding while its margin repeats"),
        ("81", "modes", " times) → fixed"),
    ] {
        let command = ["python3", &script, period, repeats];
        let mut session = session(start(&command), &Log::default());
        let run = Command::Forward {
            unit: Unit::Run,
            count: 1,
        };
        let said = does(&mut session, run);
        let cycle = format!("cycle of period {period}: ");
        assert!(said.contains(&cycle) && said.contains(told), "{said}");
    }
}

fn a_solver_in_c_in_space_has_its_swing_found() {
    let folder = tempfile::tempdir().unwrap();
    let command = built_in_c(folder.path(), "loops_3d");
    let report = check(&start(&[&command]), &Log::default());
    assert_eq!(report.failed(), 0, "{}", report.text());
    let mut session = session(start(&[&command]), &Log::default());
    let run = Command::Forward {
        unit: Unit::Run,
        count: 1,
    };
    let said = does(&mut session, run);
    assert!(said.contains("cycle of period 2: "), "{said}");
    let frames = session.frames().iter().skip(1);
    for (k, frame) in frames.enumerate() {
        let node = &frame.event.as_ref().unwrap().nodes[0];
        assert_eq!(node.deviation().map(f64::to_degrees), Some(0.0));
        // t is y and n x t is -x; the node moves along x, then along y.
        let (degrees, moved) = [(90.0, [3.0, 0.0]), (180.0, [0.0, 3.0])][k % 2];
        let [force, slip] = node.directions.unwrap().map(f64::to_degrees);
        assert!((force - degrees).abs() + (slip - degrees).abs() < 1e-9);
        assert_eq!(frame.state.u[..2], moved, "{k}");
    }
}
