//! Fuzzing: whatever a file or a typed line holds, the program takes it or refuses it with a message that can be read.
//!
//! A target for each kind of input changes files of this repository at random, in their structure rather than in their
//! bytes, and reads what comes of it. In `cargo test` each runs for a moment; for longer:
//!
//! ```text
//! STICKSLIP_FUZZ_SECONDS=300 STICKSLIP_FUZZ_SEED=7 cargo test --test fuzz -- --nocapture [TARGET]
//! ```
//!
//! An input that panics, hangs, or is refused with a message that cannot be read is left in the directory that the failure
//! names. `keys` types at random into the real program in a real pseudo-terminal, which is resized, stopped and hung up on.

#![cfg(unix)]

mod change;
mod keys;
#[path = "../common/terminal.rs"]
mod terminal;

use change::Change;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use stickslip::action::{self, Action, Context};
use stickslip::explain::attached;
use stickslip::explain::walk::ReportedIterations;
use stickslip::record::command::Command;
use stickslip::record::differences::compare;
use stickslip::record::journal::{JournalTarget, Record};
use stickslip::record::snapshot::Snapshot;
use stickslip::record::story::story;
use stickslip::recorded::exchange::{self, RecordedSolver};
use stickslip::recorded::interface_problem::read_problem;
use stickslip::scene::Scene;
use stickslip::scene::cost::Cost;
use stickslip::scene::shown;
use stickslip::session::Session;
use stickslip::step::solver::Solver as _;
use stickslip::step::stepper::Stepper;
use stickslip::study::chart_file::Chart;
use stickslip::study::precision;
use stickslip::study::precision_table;
use stickslip::study::random::Population;
use stickslip::study::reference::Reference;
use stickslip::study::run_error::RunError;
use stickslip::study::shard::Shard;
use stickslip::study::survey::{self, Survey};
use stickslip::study::sweep::{ResultStorage, Store};
use stickslip::study::trial::Variant;
use stickslip::study::{Plan, Study, Watch, precision_figure};
use stickslip::teach::Lesson;
use stickslip_exchange::attach::Answer;

/// Where nobody says how long a target is to run.
const SECONDS: f64 = 1.0;
/// No input may take longer; a refusal takes milliseconds.
const PATIENCE: Duration = Duration::from_secs(30);
/// Longest message that can be read.
const LONGEST: usize = 3000;

fn setting<T: std::str::FromStr>(name: &str, otherwise: T) -> T {
    let given = std::env::var(name).ok();
    given
        .and_then(|text| text.parse().ok())
        .unwrap_or(otherwise)
}

fn seconds() -> Duration {
    Duration::from_secs_f64(setting("STICKSLIP_FUZZ_SECONDS", SECONDS))
}

fn seed() -> u64 {
    setting("STICKSLIP_FUZZ_SEED", 1)
}

/// Files of the repository in a folder, with one of the endings.
fn files(folder: &str, ending: &str) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries =
        std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let wanted = paths
        .iter()
        .filter(|path| path.extension().is_some_and(|e| e == ending));
    wanted
        .map(|path| std::fs::read_to_string(path).unwrap())
        .collect()
}

/// What became of an input.
enum Took {
    Well,
    /// Refused, with this message.
    Refused(String),
}

impl<T, E: ToString> From<Result<T, E>> for Took {
    fn from(result: Result<T, E>) -> Took {
        match result {
            Ok(_) => Took::Well,
            Err(error) => Took::Refused(error.to_string()),
        }
    }
}

/// Whether an input is sound; an error where the program does wrong by it.
fn judged(read: &impl Fn(&str) -> Took, text: &str) -> Result<bool, String> {
    match catch_unwind(AssertUnwindSafe(|| read(text))) {
        Err(_) => Err("it panicked".into()),
        Ok(Took::Well) => Ok(true),
        Ok(Took::Refused(message)) => {
            let told = shown::text(&message);
            match told.len() > LONGEST || told.trim().is_empty() {
                true => Err(format!("its message has {} bytes: {told:.300}", told.len())),
                false => Ok(false),
            }
        }
    }
}

/// Leaves an input where it can be looked at.
fn leave(target: &str, text: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join(format!("{target}-{}", seed()));
    std::fs::write(&file, text).unwrap();
    file
}

/// Reads changed files until the time is over.
#[track_caller]
fn fuzz(target: &str, corpus: &[String], read: impl Fn(&str) -> Took) {
    assert!(!corpus.is_empty());
    for text in corpus {
        assert!(
            judged(&read, text).is_ok(),
            "{target}: unchanged\n{text:.500}"
        );
    }
    let mut change = Change::new(seed(), corpus);
    let (begun, over) = (Instant::now(), Arc::new(AtomicBool::new(false)));
    let present = Arc::new(Mutex::new(String::new()));
    let done = Arc::new(AtomicU64::new(0));
    let watch = {
        let (over, present, done) = (over.clone(), present.clone(), done.clone());
        let target = target.to_owned();
        std::thread::spawn(move || watch_over(&target, &over, &present, &done))
    };
    let (mut count, mut taken) = (0u64, 0u64);
    while begun.elapsed() < seconds() {
        let text = change.next();
        text.clone_into(&mut present.lock().unwrap());
        match judged(&read, &text) {
            Ok(sound) => taken += u64::from(sound),
            Err(fault) => {
                over.store(true, Ordering::SeqCst);
                let file = leave(target, &text);
                let (seed, file) = (seed(), file.display());
                panic!("{target}: input {count} of seed {seed}: {fault}; it is in {file}");
            }
        }
        count += 1;
        done.store(count, Ordering::SeqCst);
    }
    over.store(true, Ordering::SeqCst);
    watch.join().unwrap();
    eprintln!(
        "{target}: {count} inputs of seed {}, {taken} of them sound",
        seed()
    );
}

/// Ends everything where one input takes forever.
fn watch_over(target: &str, over: &AtomicBool, present: &Mutex<String>, done: &AtomicU64) {
    let (mut last, mut since) = (0, Instant::now());
    while !over.load(Ordering::SeqCst) {
        std::thread::sleep(Duration::from_millis(50));
        let now = done.load(Ordering::SeqCst);
        if now != last {
            (last, since) = (now, Instant::now());
        } else if since.elapsed() > PATIENCE {
            let file = leave(target, &present.lock().unwrap());
            eprintln!(
                "{target}: input {now} takes forever; it is in {}",
                file.display()
            );
            std::process::abort();
        }
    }
}

/// A scene that is solved as quickly as it is read.
fn is_small(scene: &Scene) -> bool {
    scene.model.dofs.len() < 400 && scene.model.contacts.len() < 40
}

/// Reads a scene; a sound one of a handful of unknowns takes some steps, too.
fn scene(text: &str) -> Took {
    let scene = match Scene::from_text("x.ron", text, &[]) {
        Ok(scene) => scene,
        Err(error) => return Took::Refused(error.to_string()),
    };
    let _ = Cost::from_scene(&scene).to_string();
    if is_small(&scene) {
        let mut stepper = Stepper::new(Arc::new(scene.model));
        for _ in 0..4 {
            let _ = stepper.step();
        }
    }
    Took::Well
}

#[test]
fn scenes() {
    fuzz("scenes", &files("problems", "ron"), scene);
}

#[test]
fn interface_problems() {
    let population = Population {
        seed: 3,
        count: 8,
        nodes: 1..=3,
    };
    let text = |k| population.draw(k).problem.text(&["random".into()]);
    let corpus: Vec<String> = (0..population.count).map(text).collect();
    fuzz("interface_problems", &corpus, scene);
}

#[test]
fn siconos() {
    fuzz("siconos", &files("tests/siconos", "dat"), scene);
}

/// A solver in space, in version 2 of the protocol.
const SPACE: &str = r#"# stickslip exchange 1
# started: block
> {"type":"hello","protocol":1,"protocols":[1,2],"reads":["progress","space","partial"],"name":"stickslip","version":"0.1.0"}
< {"type":"hello","protocol":2,"name":"block","version":"1","abilities":{"force":true,"restore":"any","partial":true}}
> {"type":"scene"}
< {"type":"scene","title":"","dimension":3,"nodes":[{"at":[0,0,0]},{"at":[1,0,0]},{"at":[-1,-1,0]},{"at":[2,-1,0]},{"at":[2,2,0]}],"faces":[[0,1,2]],"surfaces":[{"name":"plane","faces":[[2,3,4]],"rigid":true}],"contacts":[{"id":0,"node":0,"surface":"plane","friction":{"mu":0.3}},{"id":1,"node":1,"surface":"plane"}]}
> {"type":"step"}
< {"type":"progress","done":1,"of":2}
< {"type":"state","at":{"increment":1},"load":0.5,"ended":"iteration","contacts":[{"id":0,"mode":"free","next":"sliding","gap":-1e-3,"f_n":0,"f_t":[0,0],"limit":0,"slip":[0,1e-3]},{"id":1,"mode":"free","next":"free","gap":1,"f_n":0,"f_t":[0,0],"limit":0,"slip":[0,0]}],"displacements":[[0,0,0],[0,0,0],[0,0,0],[0,0,0],[0,0,0]]}
> {"type":"problem"}
< {"type":"problem","contacts":[0,1],"tangents":2,"kind":"stiffness","matrix":{"size":6,"triplets":[[0,0,9],[1,1,9],[2,2,9],[3,3,9],[4,4,9],[5,5,9],[0,4,3],[4,0,3]]},"q":[-1e-2,2e-3,0,-1e-2,0,2e-3],"mu":[0.3,0.5]}
> {"type":"step"}
< {"type":"state","load":0.5,"ended":"done","contacts":[{"id":0,"mode":"sliding","next":"sliding","gap":0,"f_n":10,"f_t":[2.4,1.8],"limit":3,"slip":[4e-3,3e-3],"normal":[0,0,1],"tangent":[1,0,0]}]}
"#;

/// Reads and examines the interface problems of an exchange.
fn problems(text: &str, past: &RecordedSolver) -> Took {
    let lines = text.lines().filter_map(|line| line.strip_prefix("< "));
    let (begun, mut ids) = (Instant::now(), Vec::new());
    for answer in lines.filter_map(|line| Answer::read(line).ok()) {
        match answer {
            Answer::Scene(scene) => ids = scene.contacts.into_iter().map(|c| c.id).collect(),
            Answer::Problem(problem) => match read_problem(&problem, &ids) {
                Ok(posed) => {
                    let iterations = ReportedIterations::default();
                    let late = || begun.elapsed() > Duration::from_millis(50);
                    let (model, state) = (past.model(), past.state());
                    attached::examine(model, state, &posed, &iterations, &[], &late);
                }
                Err(fault) => return Took::Refused(fault.to_string()),
            },
            _ => {}
        }
    }
    Took::Well
}

#[test]
fn exchanges() {
    let mut corpus = files("problems/lessons", "exchange");
    corpus.push(SPACE.into());
    corpus.extend(files("tests/attach", "exchange"));
    for text in &corpus {
        assert!(exchange::open("x.exchange", text).is_ok());
    }
    fuzz("exchanges", &corpus, |text| {
        let mut past = match exchange::open("x.exchange", text) {
            Ok(opened) => opened.past,
            Err(error) => return Took::Refused(error.to_string()),
        };
        for _ in 0..4 {
            let _ = past.step();
        }
        problems(text, &past)
    });
}

#[test]
fn studies() {
    let corpus = [
        files("problems/studies", "ron"),
        files("problems/charts", "ron"),
    ]
    .concat();
    fuzz("studies", &corpus, |text| {
        let _ = Chart::from_text("x.ron", text);
        match Study::from_text("x.ron", text) {
            Ok(study) => Plan::new(study).into(),
            Err(error) => Took::Refused(error.to_string()),
        }
    });
}

#[test]
fn lessons() {
    fuzz("lessons", &files("problems/lessons", "ron"), |text| {
        let lesson = Lesson::from_text("x.ron", text);
        lesson
            .map(|lesson| (lesson.title, lesson.steps.len()))
            .into()
    });
}

#[test]
fn snapshots() {
    let small = |text: &String| text.len() < 40_000;
    let corpus: Vec<String> = files("snapshots", "ron")
        .into_iter()
        .filter(small)
        .collect();
    fuzz("snapshots", &corpus, |text| {
        let snapshot = match Snapshot::from_text("x.ron", text) {
            Ok(snapshot) => snapshot,
            Err(error) => return Took::Refused(error.to_string()),
        };
        let scene = Scene::from_spec("x", snapshot.scene.clone());
        if snapshot.steps > 60 || !scene.as_ref().is_ok_and(is_small) {
            return scene.into();
        }
        let again = snapshot.replay();
        again
            .map(|again| compare(&snapshot, &again).to_string())
            .into()
    });
}

/// A session on a scene with every kind of command in its journal.
fn journal() -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("j");
    let mut session = Session::new(Scene::open("osc-two6", &[]).unwrap());
    JournalTarget::File(path.clone())
        .begin(&mut session)
        .unwrap();
    for line in [
        "step 2",
        "force a sliding",
        "step",
        "hold b fixed",
        "next",
        "release b",
        "break mode a",
        "watch gap a as x",
        "rename first",
        "continue",
        "goto 1",
        "friction 20",
        "finish",
        "set settings.strategy ladder",
        "finish",
        "branch b1",
        "increment 0.5",
        "step",
        "disable 1",
        "unwatch x",
        "delete all",
    ] {
        if let Ok(Action::Session(command)) = typed(&session, line) {
            let _ = session.submit(command);
            session.wait();
        }
    }
    std::fs::read_to_string(path).unwrap()
}

fn typed(session: &Session, line: &str) -> Result<Action, String> {
    let context = Context {
        model: Some(session.model()),
        scene: Some(session.scene()),
        tree: Some(session.timeline().tree()),
        ..Context::default()
    };
    action::parse(line, &context).map_err(|e| e.to_string())
}

#[test]
fn journals() {
    fuzz("journals", &[journal()], |text| {
        let record = match Record::from_bytes("x", text.as_bytes()) {
            Ok(record) => record,
            Err(error) => return Took::Refused(error.to_string()),
        };
        let solved = record.entries.iter().map(|(_, entry)| entry.solved).max();
        if solved.unwrap_or(0) > 100 || !record.scene().is_ok_and(|scene| is_small(&scene)) {
            return Took::Well;
        }
        let _ = story(&record);
        record.replay().map(|_| ()).into()
    });
}

#[test]
fn chart_tables() {
    let corpus = [
        "# Scene: x\n# Time: y\nscene,series,run,settings,status,error,seconds,repeats,factorizations,majors,minors,\
         increments,unknowns,unsettled,front\nA,\"one, two\",refine=1,refine=1,whole,1e-3,0.001,3,10,10,20,5,40,0,true\n\
         A,\"one, two\",refine=2,refine=2,whole,1e-4,0.01,3,10,10,20,5,80,0,true\nA,b,x,x,2-cycle,,0.5,1,1,1,2,0,16,0,false\n\
         A,b,y,y,reference,,0.5,1,1,1,2,0,16,0,false\n"
            .to_owned(),
        "scene,series,run,status,error,seconds\nA,a,1,whole,0.1,1\nB,a,2,whole,,2\nB,b,3,failed,,3\n".to_owned(),
    ];
    fuzz("chart_tables", &corpus, |text| {
        let charts = match precision_table::read("x.csv", text, precision::Cost::Time, Some(1e-2)) {
            Ok(charts) => charts,
            Err(error) => return Took::Refused(error.to_string()),
        };
        let again = precision_table::csv(&charts);
        let same = precision_table::read("y.csv", &again, precision::Cost::Minors, None);
        assert_eq!(same.ok().map(|c| c.len()), Some(charts.len()), "{again}");
        if charts.iter().map(|chart| chart.points.len()).sum::<usize>() < 12 {
            let svg = precision_figure::sheet(&charts, false).and_then(|sheet| sheet.svg());
            assert!(
                svg.is_ok_and(|svg| !svg.contains(|c| shown::is_order(c) && !"\n\r\t".contains(c)))
            );
        }
        Took::Well
    });
}

#[test]
fn reference_tables() {
    fuzz(
        "reference_tables",
        &files("problems/references", "csv"),
        |text| {
            let read = Reference::read("x.csv", text, &[0.0, 1.0, 0.0]);
            read.map(|table| table.at(0, 0.5).map(|row| row.load))
                .into()
        },
    );
}

#[test]
fn map_logs() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("log");
    let settings = vec![("settings.strategy".to_owned(), "lemke".to_owned())];
    let survey = || {
        let population = Population {
            seed: 1,
            count: 3,
            nodes: 1..=2,
        };
        let variant = Variant {
            name: "lemke".into(),
            settings: settings.clone(),
        };
        let watch = Watch {
            stop: &|| false,
            done: &|_| {},
        };
        let one = std::num::NonZeroUsize::MIN;
        let variants = vec![variant.clone(), variant];
        let keeping = ResultStorage::Log(Some(file.clone()), Shard::WHOLE);
        let sweep = survey::sweep(&population, &variants);
        let judged = sweep.run_with(&Store::open(&keeping, &sweep)?, one, &watch)?;
        Ok::<_, RunError>(Survey {
            population: population.clone(),
            variants: variants.clone(),
            judged,
        })
    };
    survey().unwrap();
    let log = std::fs::read_to_string(&file).unwrap();
    fuzz("map_logs", &[log], |text| {
        std::fs::write(&file, text).unwrap();
        survey()
            .map(|survey| (survey.csv(), survey.tally(1, |_| true)))
            .into()
    });
}

#[test]
fn lines() {
    let corpus: Vec<String> = action::ACTIONS
        .iter()
        .flat_map(|entry| {
            [
                entry.name.to_owned(),
                format!("{} {}", entry.name, entry.arguments),
                format!("{} a sliding", entry.name),
                format!("{} 2", entry.name),
                format!("{} friction.angle 20", entry.name),
                format!("{} settings.strategy ladder", entry.name),
                format!("{} mode a sliding", entry.name),
                format!("{} gap a as x y", entry.name),
            ]
        })
        .collect();
    let session = Mutex::new(None::<(Session, u32)>);
    fuzz("lines", &corpus, |line| {
        let line = line.replace('\n', " ");
        let mut session = session.lock().unwrap_or_else(|e| e.into_inner());
        let (session, steps) = session.get_or_insert_with(|| {
            let scene = Scene::open("osc-two6", &[("history.increment".into(), "0.2".into())]);
            (Session::new(scene.unwrap()), 0)
        });
        let _ = action::complete(&line, &Context::default());
        let action = match typed(session, &line) {
            Ok(action) => action,
            Err(message) => return Took::Refused(message),
        };
        let writes = |command: &Command| {
            matches!(
                command,
                Command::Snapshot { .. }
                    | Command::Export { .. }
                    | Command::Journal(_)
                    | Command::Remedies
            )
        };
        let Action::Session(command) = action else {
            return Took::Well;
        };
        if writes(&command) {
            return Took::Well;
        }
        let told = session.submit(command);
        // A run may have been asked for that never ends.
        let begun = Instant::now();
        while session.poll().is_none() && session.is_running() {
            if begun.elapsed() > Duration::from_millis(200) {
                session.interrupt();
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        session.background_mut().wait();
        assert!(!session.frames().is_empty() && session.cursor() < session.frames().len());
        *steps += 1;
        let (old, long) = (*steps > 300, session.frames().len() > 2000);
        if old || long {
            let scene = Scene::open("osc-zig3", &[]).unwrap();
            (*session, *steps) = (Session::new(scene), 0);
        }
        told.map(|_| ()).into()
    });
}
