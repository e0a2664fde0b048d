//! What the debugger costs beside an attached solver: `cargo bench --bench attach`.
//!
//! The solver on the other side is this program itself: it answers with states that it has made beforehand, in alternating modes, and
//! counts the time from when it has read a request to when its answer is out. What a step takes longer than that is the
//! debugger's: asking, the way there and back, reading, and keeping. Each state can be gone back to, so that a step is two
//! requests, `step` and `save`. Medians; of a session with its strip and frames, whose worker is looked at once a millisecond.

use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;
use stickslip::attach::{Attached, Start};
use stickslip::model::Mode;
use stickslip::record::command::{Command, Unit};
use stickslip::recorded::log::Log;
use stickslip::session::Session;
use stickslip::step::Solver;
use stickslip_exchange::attach::message::{
    Abilities, Components, Contact, ContactResult, EndedLevel, Friction, Hello, Id, NodeMessage,
    NormsMessage, Position, Restore, Scene, State, SurfaceMessage,
};
use stickslip_exchange::attach::{Answer, PROTOCOLS, Request};

/// The first argument of the solver; the others are the number of contacts, and where the time is written.
const SOLVE: &str = "--solve";
/// Steps of a median.
const STEPS: usize = 40;
/// States that are made beforehand.
const STATES: usize = 8;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.first().is_some_and(|first| first == SOLVE) {
        return solve(
            arguments[1].parse().expect("a count"),
            Path::new(&arguments[2]),
        );
    }
    println!(
        "| contacts | kB a state | solver's own ms | a step beside it ms | with --exchange ms | `s` in a session ms | force and `s` ms | back, force and `s` ms |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for contacts in [100, 1_000, 10_000] {
        row(contacts);
    }
}

fn row(contacts: usize) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("times");
    let start = start(contacts, &file);
    let size = states(contacts)[0].line().len() as f64 / 1e3;
    let (plain, own) = stepped(&start, &Log::default(), &file);
    let log = Log::default();
    log.keep(&folder.path().join("exchange"), true)
        .expect("a file");
    let (kept, own_kept) = stepped(&start, &log, &file);
    let log = Log::default();
    let (scene, attached) =
        Attached::attach(start, log.clone()).unwrap_or_else(|fault| panic!("{fault}"));
    let mut session = Session::attached(scene, Box::new(attached), log);
    let force = Command::Force {
        slave: 0,
        mode: Mode::Sliding,
        hold: false,
    };
    let back = Command::Back {
        unit: Unit::Minor,
        count: 1,
    };
    let on = median((0..STEPS).map(|_| does(&mut session, &[forward()])));
    let forced = median((0..STEPS).map(|_| does(&mut session, &[force.clone(), forward()])));
    let again = median((0..STEPS).map(|_| {
        does(
            &mut session,
            &[back.clone(), back.clone(), force.clone(), forward()],
        )
    }));
    println!(
        "| {contacts} | {size:.0} | {own:.2} | {:.2} | {:.2} | {on:.1} | {forced:.1} | {again:.1} |",
        plain - own,
        kept - own_kept
    );
}

fn start(contacts: usize, file: &Path) -> Start {
    let own = std::env::current_exe()
        .expect("its own name")
        .display()
        .to_string();
    let file = file.display().to_string();
    Start::new(vec![own, SOLVE.into(), contacts.to_string(), file])
}

/// Median time of a step, and the solver's own part of a step (ms).
fn stepped(start: &Start, log: &Log, file: &Path) -> (f64, f64) {
    let (_, mut attached) =
        Attached::attach(start.clone(), log.clone()).unwrap_or_else(|fault| panic!("{fault}"));
    let times: Vec<f64> = (0..STEPS)
        .map(|_| {
            let began = Instant::now();
            attached.step().unwrap_or_else(|lost| panic!("{lost}"));
            1e3 * began.elapsed().as_secs_f64()
        })
        .collect();
    drop(attached);
    let text = std::fs::read_to_string(file).expect("its times");
    let own = text.lines().map(|line| line.parse().expect("a time"));
    (median(times.into_iter()), median(own))
}

fn forward() -> Command {
    Command::Forward {
        unit: Unit::Minor,
        count: 1,
    }
}

/// Milliseconds that some commands take, one after the other.
fn does(session: &mut Session, commands: &[Command]) -> f64 {
    let began = Instant::now();
    for command in commands {
        session
            .submit(command.clone())
            .unwrap_or_else(|refusal| panic!("{refusal}"));
        session.wait();
    }
    1e3 * began.elapsed().as_secs_f64()
}

fn median(times: impl Iterator<Item = f64>) -> f64 {
    let mut times: Vec<f64> = times.collect();
    times.sort_unstable_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The solver on the other side.
fn solve(contacts: usize, file: &Path) {
    let scene = Answer::Scene(Box::new(scene(contacts))).line();
    let hello = Answer::Hello(Box::new(hello())).line();
    let states = states(contacts);
    let made = |done: usize| line(&states[done % STATES], done);
    let mut lines: Vec<(usize, String)> = (0..STATES).map(|n| (n, made(n))).collect();
    let (mut done, mut steps) = (0, Vec::new());
    for asked in std::io::stdin().lock().lines() {
        let asked = asked.expect("a line");
        let began = Instant::now();
        let request = Request::read(&asked).expect("a request");
        let text = match &request {
            Request::Hello { .. } => hello.clone(),
            Request::Scene => scene.clone(),
            Request::Step => {
                done += 1;
                match std::mem::take(&mut lines[done % STATES]) {
                    (of, line) if of == done => line,
                    _ => made(done),
                }
            }
            Request::Save => format!("{{\"type\":\"saved\",\"token\":{done}}}\n"),
            Request::Restore { token } => {
                done = token.as_u64().expect("its own token") as usize;
                Answer::Ok.line()
            }
            Request::Bye => break,
            _ => Answer::Ok.line(),
        };
        let mut out = std::io::stdout().lock();
        let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
        if request == Request::Step {
            steps.push(1e3 * began.elapsed().as_secs_f64());
            // For the next time round, which is no part of a solver's work.
            lines[done % STATES] = (done + STATES, made(done + STATES));
        }
    }
    let text: String = steps.iter().map(|time| format!("{time}\n")).collect();
    std::fs::write(file, text).expect("its times");
}

/// The line of a state as that of an iteration.
fn line(state: &Answer, done: usize) -> String {
    let mut state = state.clone();
    if let Answer::State(state) = &mut state {
        state.at.minor = u32::try_from(done + 1).expect("few");
    }
    state.line()
}

fn hello() -> Hello {
    Hello {
        protocol: PROTOCOLS[0],
        protocols: Vec::new(),
        name: "canned".into(),
        version: String::new(),
        abilities: Abilities {
            force: true,
            hold: false,
            restore: Restore::Any,
            problem: false,
            interrupt: false,
            partial: false,
        },
        decides: None,
        parameters: Vec::new(),
    }
}

fn scene(contacts: usize) -> Scene {
    let node = |k: usize| NodeMessage {
        name: format!("node.{k}"),
        at: Some(Components::Two([k as f64, 0.1])),
    };
    let mut nodes: Vec<NodeMessage> = (0..contacts).map(node).collect();
    let end = |name: &str, x| NodeMessage {
        name: name.into(),
        at: Some(Components::Two([x, 0.0])),
    };
    nodes.push(end("right", contacts as f64));
    nodes.push(end("left", -1.0));
    let contact = |k: usize| Contact {
        id: Id::Number(k as i64),
        node: k,
        surface: Some("floor".into()),
        friction: Friction {
            mu: Some(0.3),
            ..Friction::default()
        },
        ..Contact::default()
    };
    Scene {
        title: format!("{contacts} contacts"),
        about: String::new(),
        dimension: 2,
        mesh: None,
        nodes,
        lines: vec![(0..contacts).collect()],
        faces: Vec::new(),
        surfaces: vec![SurfaceMessage {
            name: "floor".into(),
            nodes: vec![contacts, contacts + 1],
            faces: Vec::new(),
            rigid: true,
        }],
        contacts: (0..contacts).map(contact).collect(),
        load: None,
        monitors: Vec::new(),
        arc: false,
        drag: false,
    }
}

fn states(contacts: usize) -> Vec<Answer> {
    (0..STATES)
        .map(|n| Answer::State(Box::new(state(contacts, n))))
        .collect()
}

/// A state with numbers of 16 digits.
fn state(contacts: usize, n: usize) -> State {
    let mode = |k: usize, n: usize| [Mode::Free, Mode::Fixed, Mode::Sliding][(k + n) % 3];
    let number = |k: usize, of: f64| ((k * STATES + n) as f64 + of).sin() / 3.0;
    let found = |k: usize| ContactResult {
        id: Some(Id::Number(k as i64)),
        mode: mode(k, n),
        next: mode(k, n + 1),
        gap: Some(number(k, 0.1)),
        f_n: Some(number(k, 0.2)),
        f_t: Some(Components::One(number(k, 0.3))),
        limit: Some(number(k, 0.4)),
        slip: Some(Components::One(number(k, 0.5))),
        rule: "active set".into(),
        margin: Some(number(k, 0.6)),
        tests: Vec::new(),
        wanted: None,
        limit_used: None,
        drift: None,
        normal: None,
        tangent: None,
        foot: None,
        corner: None,
        carried: [false; 2],
        forced: None,
        over: true,
    };
    State {
        at: Position {
            increment: 1,
            attempt: 1,
            major: 1,
            minor: u32::try_from(n + 1).expect("few"),
        },
        load: Some(1.0),
        ended: EndedLevel::Iteration,
        reason: String::new(),
        size: None,
        contacts: (0..contacts).map(found).collect(),
        residual: NormsMessage {
            relative: Some(0.1),
            ..NormsMessage::default()
        },
        after: None,
        displacements: Some(
            (0..contacts + 2)
                .map(|k| Components::Two([number(k, 0.7), number(k, 0.8)]))
                .collect(),
        ),
        spring: None,
        monitors: Vec::new(),
        arc: None,
        drag: None,
    }
}
