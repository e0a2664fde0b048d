//! The record of a session: written as it happens, replayed to the same bits, told as a story.

use std::path::{Path, PathBuf};
use std::process::{Command as Process, Output, Stdio};
use stickslip::action::{Action, Context, parse};
use stickslip::record::command::{Command, Unit};
use stickslip::record::journal::{Journal, JournalError, JournalTarget, Record};
use stickslip::record::story::story;
use stickslip::scene::Scene;
use stickslip::session::Session;
use tempfile::TempDir;

const FLOOR: &str = "01-pinned-beam-rough-floor";
const OSCILLATES: &str = "osc-inclined-cantilever";

/// A session with a journal in a directory of its own.
struct Kept {
    session: Session,
    path: PathBuf,
    directory: TempDir,
}

fn kept(scene: &str) -> Kept {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("a.journal");
    let mut session = Session::new(Scene::open(scene, &[]).expect("a built-in scene"));
    JournalTarget::File(path.clone())
        .begin(&mut session)
        .expect("a journal");
    Kept {
        session,
        path,
        directory,
    }
}

/// Carries out lines as they are typed at the colon.
fn type_lines(session: &mut Session, lines: &[&str]) {
    for line in lines {
        let action = parse(
            line,
            &Context {
                model: Some(session.model()),
                ..Context::default()
            },
        );
        let Ok(Action::Session(command)) = action else {
            panic!("{line}: {action:?}");
        };
        session
            .submit(command)
            .unwrap_or_else(|e| panic!("{line}: {e}"));
        session.wait();
    }
}

/// All that can be seen of a session, bit for bit.
fn all(session: &Session) -> Vec<String> {
    let tree = session.timeline().tree();
    let mut seen = vec![format!("{} {}", tree.current(), session.cursor())];
    seen.push(format!(
        "{:?} {:?}",
        session.breakpoints(),
        session.watches()
    ));
    for (number, branch) in tree.branches().iter().enumerate() {
        seen.push(format!(
            "{} {:?} {}",
            branch.label, branch.parent, branch.from
        ));
        for at in 0..tree.len(number) {
            let (frame, _) = tree.point(number, at).expect("a point");
            seen.push(ron::to_string(&frame.state).expect("plain data"));
        }
    }
    seen
}

/// What an afternoon might look like.
const AFTERNOON: &[&str] = &[
    "continue",
    "reverse-step",
    "force beam.5 sliding",
    "finish 3",
    "rename the way out",
    "break mode beam.5",
    "watch gap beam.5 as tip",
    "reverse-finish 2",
    "friction 20",
    "finish 2",
    "branches",
    "increment 0.02",
    "next 2",
    "branch b1",
    "reverse-continue",
    "hold beam.5 free",
    "step 2",
    "release beam.5",
    "goto 1",
    "set settings.at_cycle damp",
    "finish",
    "disable 1",
    "branch-next",
    "compare b2",
    "goto 2",
];

#[test]
fn a_journal_replays_to_the_same_bits() {
    let mut kept = kept(OSCILLATES);
    type_lines(&mut kept.session, AFTERNOON);
    let record = Record::read(&kept.path).expect("a journal");
    // Neither the list nor the comparison changed anything.
    assert_eq!(record.entries.len(), AFTERNOON.len() - 2);
    assert_eq!((record.torn, &record.unfinished), (None, &None));
    let replayed = record.replay().unwrap_or_else(|e| panic!("{e}"));
    assert!(kept.session.timeline().tree().branches().len() > 3);
    assert_eq!(all(&replayed), all(&kept.session));
}

#[test]
fn an_interrupted_run_replays_as_far_as_it_came() {
    let mut kept = kept(FLOOR);
    kept.session
        .submit(Command::Forward {
            unit: Unit::Run,
            count: 1,
        })
        .expect("a start");
    kept.session.interrupt();
    kept.session.wait();
    type_lines(&mut kept.session, &["step 2"]);
    let record = Record::read(&kept.path).expect("a journal");
    let replayed = record.replay().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(all(&replayed), all(&kept.session));
}

#[test]
fn a_journal_deleted_under_the_session_is_written_again_whole_and_the_user_is_told() {
    let mut kept = kept(OSCILLATES);
    type_lines(&mut kept.session, &["step 3"]);
    std::fs::remove_file(&kept.path).expect("deleted");
    let force = Command::Force {
        slave: 0,
        mode: stickslip::model::Mode::Fixed,
        hold: false,
    };
    let reply = kept.session.submit(force).expect("forced").0;
    let told = format!("{} was deleted and has been rewritten", kept.path.display());
    assert!(reply.contains(&told), "{reply}");
    type_lines(&mut kept.session, &["step 2"]);
    let record = Record::read(&kept.path).expect("a journal");
    assert_eq!(record.entries.len(), 3);
    let replayed = record.replay().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(all(&replayed), all(&kept.session));

    // Another file in its place is not ours to write to.
    std::fs::write(kept.directory.path().join("b"), "mine").expect("a file");
    std::fs::rename(kept.directory.path().join("b"), &kept.path).expect("renamed");
    let reply = kept
        .session
        .submit(Command::Goto { step: 1 })
        .expect("gone")
        .0;
    assert!(
        reply.contains("another file has replaced it") && reply.contains(":journal FILE"),
        "{reply}"
    );
    assert!(kept.session.journal().lost().is_some());
    assert_eq!(std::fs::read_to_string(&kept.path).expect("there"), "mine");
    let other = kept.directory.path().join("c.journal");
    type_lines(
        &mut kept.session,
        &[&format!("journal {}", other.display())],
    );
    let replayed = Record::read(&other).expect("a journal").replay();
    assert_eq!(
        all(&replayed.unwrap_or_else(|e| panic!("{e}"))),
        all(&kept.session)
    );
}

#[test]
fn a_journal_that_goes_on_replays_as_a_whole() {
    let Kept {
        mut session,
        path,
        directory,
    } = kept(OSCILLATES);
    type_lines(&mut session, &["continue", "force beam.5 sliding"]);
    assert!(matches!(Journal::open(&path), Err(JournalError::Busy(_))));
    assert!(matches!(
        Journal::create(&path, session.scene(), &[]),
        Err(JournalError::Exists(_))
    ));
    drop(session);
    // What a kill leaves.
    let mut bytes = std::fs::read(&path).expect("a file");
    bytes.extend_from_slice(b"Done((at:17");
    std::fs::write(&path, &bytes).expect("written");
    let record = Record::read(&path).expect("a journal");
    assert_eq!((record.entries.len(), record.torn), (2, Some(5)));
    let mut session = record.replay().unwrap_or_else(|e| panic!("{e}"));
    let mut journal = Journal::open(&path).expect("free again");
    journal.cut(record.whole_bytes).expect("cut");
    session.journal_mut().write_to(journal);
    type_lines(&mut session, &["finish 2"]);
    let record = Record::read(&path).expect("a journal");
    assert_eq!((record.entries.len(), record.torn), (3, None));
    assert_eq!(
        all(&record.replay().unwrap_or_else(|e| panic!("{e}"))),
        all(&session)
    );
    drop(directory);
}

#[test]
fn a_journal_that_cannot_be_written_any_more_is_told_once_and_stops_nothing() {
    let mut session = Session::new(Scene::open(FLOOR, &[]).expect("a scene"));
    let full = Path::new("/dev/full");
    if !full.exists() {
        return;
    }
    session
        .journal_mut()
        .write_to(Journal::open(full).expect("it opens"));
    let say = |session: &mut Session| {
        let reply = session.submit(Command::Rename(format!("n{}", session.cursor())));
        reply.expect("a rename").0
    };
    let told = say(&mut session);
    assert!(told.contains("the journal ends here: /dev/full"), "{told}");
    session
        .submit(Command::Forward {
            unit: Unit::Minor,
            count: 1,
        })
        .expect("a step");
    session.wait();
    assert!(!say(&mut session).contains("journal"));
}

/// A journal's bytes with one line changed.
fn changed(path: &Path, line: usize, change: impl Fn(&str) -> String) -> Vec<u8> {
    let text = std::fs::read_to_string(path).expect("text");
    let lines = text.lines().enumerate();
    let lines: Vec<String> = lines
        .map(|(k, old)| {
            if k + 1 == line {
                change(old)
            } else {
                old.to_owned()
            }
        })
        .collect();
    (lines.join("\n") + "\n").into_bytes()
}

#[test]
fn damage_is_told_with_its_line() {
    let mut kept = kept(OSCILLATES);
    type_lines(
        &mut kept.session,
        &["step", "step", "force beam.5 sliding", "step"],
    );
    let bytes = std::fs::read(&kept.path).expect("a journal");
    let text = String::from_utf8(bytes).expect("text");
    let forced = 1 + text
        .lines()
        .position(|line| line.contains("command:Force("))
        .expect("an entry");
    let message = |bytes: &[u8]| match Record::from_bytes("j", bytes) {
        Ok(record) => record
            .replay()
            .map(|_| ())
            .expect_err("a fault")
            .to_string(),
        Err(error) => error.to_string(),
    };
    let cut = changed(&kept.path, forced, |line| line[..line.len() / 2].to_owned());
    let told = message(&cut);
    assert!(
        told.starts_with(&format!("j:{forced}:")) && told.contains("not a journal entry"),
        "{told}"
    );
    let other = changed(&kept.path, forced, |line| {
        line.replace("Sliding", "Fixed").replace("sliding", "fixed")
    });
    let told = message(&other);
    assert!(
        told.starts_with(&format!(
            "j:{forced}: the replay differs from the journal: the state is"
        )),
        "{told}"
    );
    let format = changed(&kept.path, 1, |line| line.replace("format:1", "format:9"));
    assert_eq!(
        message(&format),
        "j: the journal has format 9, but this program reads only format 1"
    );
    let scene = changed(&kept.path, 1, |line| {
        line.replace("increment:0.05", "increment:-1.0")
    });
    assert!(
        message(&scene).starts_with("j:1: the journal's scene is invalid"),
        "{}",
        message(&scene)
    );
    assert!(message(b"").starts_with("j:1:1: no complete line found"));
    assert!(message(b"(format:1").starts_with("j:1:1: no complete line found"));
    assert!(message(b"hello\n").starts_with("j:1:"));
    assert!(message(b"\xff\xfe\n").contains("UTF-8"));
}

#[test]
fn the_story_of_a_session_on_the_oscillating_cantilever() {
    let mut kept = kept(OSCILLATES);
    type_lines(
        &mut kept.session,
        &[
            "watch f_n beam.5",
            "continue",
            "step 2",
            "goto 1",
            "reverse-step",
            "step",
            "force beam.5 sliding",
            "rename slide once",
            "break at 3",
            "continue",
            "continue",
            "compare",
            "branch b1",
            "set settings.minors 50",
            "continue",
            "branch slide",
        ],
    );
    let record = Record::read(&kept.path).expect("a journal");
    let text = story(&record).unwrap_or_else(|e| panic!("{e}"));
    // The date is another every time, and the last bits of a state may be another's on another machine.
    let masked: Vec<String> = text
        .lines()
        .map(
            |line| match (line.starts_with("Session of"), line.rfind(", state ")) {
                (true, _) => "Session of DATE".into(),
                (_, Some(at)) => format!("{}, state DIGEST", &line[..at]),
                _ => line.to_owned(),
            },
        )
        .collect();
    insta::assert_snapshot!("story", masked.join("\n"));
}

fn run(state: &Path, arguments: &[&str]) -> Output {
    Process::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(arguments)
        .env("XDG_STATE_HOME", state)
        .stdin(Stdio::null())
        .output()
        .expect("it runs")
}

#[track_caller]
fn ends(output: &Output, code: i32, told: &str) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(message.contains(told), "{message}");
}

#[test]
fn resume_and_story_on_the_command_line_end_as_they_should() {
    let Kept {
        mut session,
        path,
        directory,
    } = kept(OSCILLATES);
    type_lines(&mut session, AFTERNOON);
    let name = path.to_str().expect("a name");
    let state = directory.path();
    // A check does not disturb the session that writes.
    ends(
        &run(state, &["resume", "--check", name]),
        0,
        "replay is bit-identical",
    );
    let told = run(state, &["story", name]);
    ends(&told, 0, "");
    assert!(
        String::from_utf8_lossy(&told.stdout)
            .starts_with("osc-inclined-cantilever: Inclined cantilever")
    );
    ends(&run(state, &["resume", name]), 2, "resume --check");
    ends(
        &run(state, &["resume", "--check"]),
        2,
        "there is no journal in",
    );
    ends(
        &run(state, &["story", "nowhere"]),
        2,
        "nowhere: the file cannot be read",
    );
    let other = directory.path().join("other");
    std::fs::write(
        &other,
        changed(&path, 5, |line| line.replace("cursor:", "cursor:1")),
    )
    .expect("written");
    ends(
        &run(
            state,
            &["resume", "--check", other.to_str().expect("a name")],
        ),
        1,
        "other:5: the replay differs",
    );
    std::fs::write(&other, changed(&path, 5, |_| "(".into())).expect("written");
    ends(
        &run(state, &["story", other.to_str().expect("a name")]),
        2,
        "other:5:",
    );
}

#[test]
fn numbers_without_measure_keep_nobody_waiting() {
    let mut kept = kept(OSCILLATES);
    type_lines(
        &mut kept.session,
        &["step 2", "reverse-step 4294967295", "step 4294967295"],
    );
    // A year that nobody counts up to.
    let text = changed(&kept.path, 1, |line| {
        let (before, after) = line.split_once("began:").expect("a time");
        let (_, after) = after.split_once(',').expect("more");
        format!("{before}began:{},{after}", u64::MAX)
    });
    let record = Record::from_bytes("j", &text).expect("a journal");
    assert!(story(&record).expect("a story").contains("9999-12-31"));
}

#[test]
fn a_command_that_writes_files_is_not_done_on_the_word_of_a_journal() {
    let mut kept = kept(OSCILLATES);
    type_lines(&mut kept.session, &["step", "rename x"]);
    let file = kept.directory.path().join("written.ron");
    let text = changed(&kept.path, 4, |line| {
        let command = format!(
            "command:Snapshot(file:{:?},overwrite:true)",
            file.to_str().expect("a name")
        );
        line.replace("command:Rename(\"x\")", &command)
    });
    let text = String::from_utf8(text).expect("text");
    assert!(text.contains("Snapshot("), "{text}");
    let record = Record::from_bytes("j", text.as_bytes()).expect("a journal");
    let told = record.replay().map(|_| ()).expect_err("a refusal");
    assert!(
        told.to_string()
            .contains("a journal cannot contain this command")
    );
    assert!(!file.exists());
}

#[test]
fn places_that_no_session_has_are_told_and_no_panic() {
    let mut kept = kept(OSCILLATES);
    type_lines(&mut kept.session, &["step"]);
    for (from, to) in [
        ("branch:0", format!("branch:{}", usize::MAX)),
        ("cursor:1", format!("cursor:{}", usize::MAX)),
    ] {
        let text = changed(&kept.path, 3, |line| line.replacen(from, &to, 1));
        let record = Record::from_bytes("j", &text).expect("a journal");
        story(&record).expect("a story");
        assert!(record.replay().is_err());
    }
}
