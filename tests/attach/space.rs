//! A solver in space, in Python where the system has it: its cycle, its states and its interface problem.

use super::common::examined;
use super::program::{code, err, out, program};
use super::served::{seen, session};
use super::side::{PATIENT, does, minor};
use libtest_mimic::Trial;
use std::io::{Read, Write};
use std::path::Path;
use std::process::Command as Process;
use stickslip::attach::check::{Verdict, check};
use stickslip::attach::{Attached, Channel, PYTHON, Start};
use stickslip::contact::record::ContactRecord;
use stickslip::history::frame::Frame;
use stickslip::model::Mode;
use stickslip::record::command::{Command, Unit};
use stickslip::record::export::grid::grid;
use stickslip::recorded::{exchange, fault::Fault, log::Log};
use stickslip::session::Session;
use stickslip::step::event::Outcome;
use stickslip_exchange::vtu::Values;

pub fn tests() -> Vec<Trial> {
    match Process::new("python3").arg("--version").output() {
        Ok(_) => crate::tests![
            the_swing_of_the_direction_of_friction_is_found_and_is_the_cause,
            a_state_with_friction_across_its_slip_is_marked,
            a_solver_in_space_passes_every_check,
            a_check_and_a_run_find_friction_off_the_slip,
            a_stored_exchange_in_space_has_the_same_states,
            the_mesh_of_a_scene_may_be_a_file,
            remedies_are_tried_on_the_solver_itself,
            a_vtu_has_three_coordinates,
            a_solver_connects_to_a_socket_and_starts_again_to_go_back,
            a_connection_without_the_token_is_refused,
        ],
        Err(_) => Vec::new(),
    }
}

/// The block, in a folder with the module.
fn start(folder: &Path, arguments: &[&str]) -> Start {
    std::fs::write(folder.join("block3d.py"), include_str!("block3d.py")).unwrap();
    std::fs::write(folder.join("stickslip_attach.py"), PYTHON).unwrap();
    let script = folder.join("block3d.py").display().to_string();
    let words = ["python3", &script]
        .into_iter()
        .chain(arguments.iter().copied());
    Start {
        start: PATIENT,
        answer: PATIENT,
        ..Start::new(words.map(str::to_owned).collect())
    }
}

fn run() -> Command {
    Command::Forward {
        unit: Unit::Run,
        count: 1,
    }
}

fn last(session: &Session) -> &[ContactRecord] {
    &session.frame().event.as_ref().unwrap().nodes
}

fn the_swing_of_the_direction_of_friction_is_found_and_is_the_cause() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = session(start(folder.path(), &["30"]), &Log::default());
    // It stops where the cycle is detected, and fails later.
    let said = does(&mut session, run());
    assert!(
        said.contains("cycle of period 2: the direction of friction at"),
        "{said}"
    );
    assert!(
        last(&session)
            .iter()
            .all(|node| node.decision.before == Mode::Sliding)
    );
    let [now, before] = [0, 1].map(|back| {
        let strip = &session.timeline().strips()[session.cursor() - back];
        f64::from(strip.direction(0).unwrap())
    });
    let swing = (now - before).abs();
    assert!((100.0..180.0).contains(&swing), "{before} to {now}");
    assert!(
        said.contains(&format!("{swing:.0} degrees per iteration")),
        "{said}"
    );
    does(&mut session, run());
    let page = examined(&mut session, Vec::new()).lines().join("\n");
    assert!(page.contains("Why: cycle of period 2"), "{page}");
    // The state that the solver reaches with r = 1 in this increment.
    let head = "A consistent state of the interface problem was found (others may exist): 0 free, 2 sliding, 4 fixed.";
    assert!(page.contains(head), "{page}");
    for _ in 0..2 {
        session.look(0);
        session.background_mut().wait();
    }
    let pushes = session.background().pushes(session.timeline().place(), 0);
    let pushes = pushes.flatten().unwrap();
    assert_eq!(pushes.len(), 5, "{pushes:?}");
    assert!(pushes.iter().all(|push| push.influence.gap != 0.0));
}

fn a_state_with_friction_across_its_slip_is_marked() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, marked) in [
        (&["1"][..], [false; 3]),
        (&["1", "wrong"], [false, true, true]),
    ] {
        let mut session = session(start(folder.path(), arguments), &Log::default());
        for (increment, marked) in marked.into_iter().enumerate() {
            let forward = Command::Forward {
                unit: Unit::Increment,
                count: 1,
            };
            let said = does(&mut session, forward);
            let event = session.frame().event.clone().unwrap();
            let Outcome::Increment { marked: found, .. } = &event.outcome else {
                panic!("{increment}: {said}");
            };
            assert_eq!(found.is_some(), marked, "{increment}: {found:?}");
            let angles = event.nodes.iter().filter_map(ContactRecord::deviation);
            let largest = angles.fold(0.0, f64::max).to_degrees();
            assert_eq!(largest > 60.0, marked, "{increment}: {largest}");
            let page = examined(&mut session, Vec::new()).lines().join("\n");
            assert_eq!(page.contains("degrees off"), marked, "{page}");
            // Changes before an increment was accepted are over.
            assert!(!page.contains("changed in the last") || marked, "{page}");
        }
    }
}

fn a_solver_in_space_passes_every_check() {
    let folder = tempfile::tempdir().unwrap();
    let report = check(&start(folder.path(), &[]), &Log::default());
    assert_eq!(report.failed(), 0, "{}", report.text());
    let text = report.text();
    assert!(
        text.contains("every iteration satisfies it within"),
        "{text}"
    );
}

fn a_check_and_a_run_find_friction_off_the_slip() {
    let folder = tempfile::tempdir().unwrap();
    let start = start(folder.path(), &["1", "wrong"]);
    let mut arguments = vec!["run", "-q", "--"];
    arguments.extend(start.command.iter().map(String::as_str));
    let output = program(folder.path(), &arguments).output().unwrap();
    assert_eq!(code(&output), 3);
    let last = "2 of 3 accepted increments violate a law of contact";
    assert!(err(&output).contains(last), "{}", err(&output));
    let report = check(&start, &Log::default());
    let laws = report.checks.iter().find(|check| check.what == "laws");
    let text = report.text();
    let failed = matches!(laws.unwrap().verdict, Verdict::Fails(_));
    assert!(failed, "{text}");
    assert!(text.contains("degrees off its slip"), "{text}");
}

fn a_stored_exchange_in_space_has_the_same_states() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("space.exchange");
    let log = Log::default();
    log.keep(&file, false).unwrap();
    let mut original = session(start(folder.path(), &[]), &log);
    does(&mut original, run());
    let text = std::fs::read_to_string(&file).unwrap();
    let opened = exchange::open("space", &text).unwrap();
    let steps = opened.lines.first().unwrap().len();
    let mut replayed = Session::attached(opened.scene, Box::new(opened.past), opened.log);
    does(&mut replayed, run());
    assert_eq!(steps + 1, original.frames().len());
    assert_eq!(original.frames().len(), replayed.frames().len());
    for (a, b) in original.frames().iter().zip(replayed.frames()) {
        assert_eq!(seen(a), seen(b));
        assert_eq!(a.state.u, b.state.u);
        let directions = |frame: &Frame| -> Vec<_> {
            let nodes = frame.event.iter().flat_map(|event| &event.nodes);
            nodes.map(|node| node.directions).collect()
        };
        assert_eq!(directions(a), directions(b));
    }
}

fn remedies_are_tried_on_the_solver_itself() {
    let folder = tempfile::tempdir().unwrap();
    let start = start(folder.path(), &["30"]);
    let mut arguments = vec!["remedies", "--"];
    arguments.extend(start.command.iter().map(String::as_str));
    let output = program(folder.path(), &arguments).output().unwrap();
    assert_eq!(code(&output), 0, "{}", err(&output));
    assert!(
        out(&output).contains("start contacts fixed  converged"),
        "{}",
        out(&output)
    );
    assert!(
        out(&output).contains("r 0.3                 converged"),
        "{}",
        out(&output)
    );
    let cause = "why: cycle of period 2: the direction of friction at node.1";
    assert!(err(&output).contains(cause), "{}", err(&output));
    let mut arguments = vec!["run", "--"];
    arguments.extend(start.command.iter().map(String::as_str));
    let output = program(folder.path(), &arguments).output().unwrap();
    assert_eq!(code(&output), 3);
    assert!(err(&output).contains(cause), "{}", err(&output));
}

fn a_solver_connects_to_a_socket_and_starts_again_to_go_back() {
    let folder = tempfile::tempdir().unwrap();
    let usual = start(folder.path(), &[]);
    let mut original = session(usual.clone(), &Log::default());
    does(&mut original, run());
    let free = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = free.local_addr().unwrap().port();
    drop(free);
    let socket = folder.path().join("socket");
    let unix = format!("unix:{}", socket.display());
    for address in ["fd:0", &unix, &format!("tcp:{port}")] {
        let start = Start {
            channel: Channel::parse(address).unwrap(),
            ..usual.clone()
        };
        let mut attached = session(start, &Log::default());
        does(&mut attached, run());
        assert_eq!(
            original.frames().len(),
            attached.frames().len(),
            "{address}"
        );
        does(&mut attached, Command::Goto { step: 1 });
        does(
            &mut attached,
            Command::Set {
                path: "r".into(),
                value: "2".into(),
            },
        );
        does(&mut attached, minor());
        for (a, b) in original.frames().iter().zip(attached.frames()).take(2) {
            assert_eq!(seen(a), seen(b), "{address}");
        }
        drop(attached);
        assert!(!socket.exists(), "{address}");
    }
}

fn a_connection_without_the_token_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let free = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = free.local_addr().unwrap();
    drop(free);
    let stranger = std::thread::spawn(move || {
        for _ in 0..500 {
            if let Ok(mut stream) = std::net::TcpStream::connect(address) {
                let _ = stream.write_all(b"0123456789abcdef0123456789abcdef\n");
                let mut rest = Vec::new();
                return stream.read_to_end(&mut rest).map_or(0, |_| rest.len());
            }
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        0
    });
    let log = Log::default();
    let waits = Start {
        command: Vec::new(),
        channel: Channel::parse(&format!("tcp:{}", address.port())).unwrap(),
        start: std::time::Duration::from_secs(6),
        ..start(folder.path(), &[])
    };
    let fault = Attached::attach(waits, log.clone()).err().unwrap();
    assert!(matches!(fault, Fault::Silent { .. }), "{fault}");
    assert_eq!(stranger.join().unwrap(), 0);
    let said = log.lines().1;
    assert!(
        said.iter()
            .any(|line| line.text.contains("a connection was refused"))
    );
}

fn a_vtu_has_three_coordinates() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = session(start(folder.path(), &[]), &Log::default());
    does(&mut session, run());
    let scene = session.scene();
    let (state, event) = (&session.frame().state, session.frame().event.as_deref());
    let grid = grid(&scene.model, state, event, state.next, 3.0).unwrap();
    assert_eq!(grid.points[6], [0.0, 0.0, 2.0]);
    let numbers = |name: &str| {
        let array = grid.on_points.iter().find(|array| array.name == name);
        match &array.unwrap().values {
            Values::Numbers(all) => all.clone(),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(numbers("displacement")[18..21], [0.006, 0.008, -0.01]);
    // The forces of the sliding nodes 3 to 6 point back along x and y, and up.
    let force = numbers("contact_force");
    assert!(
        force[6] < 0.0 && force[7] < 0.0 && force[8] > 0.0,
        "{force:?}"
    );
    assert!(grid.on_points.iter().all(|array| array.name != "rotation"));
}

/// A brick over a plane: eight nodes and one of a second brick's faces as the master.
const BRICKS: &str = "*NODE, NSET=ALL
11, 0, 0, 0
12, 1, 0, 0
13, 1, 1, 0
14, 0, 1, 0
15, 0, 0, 1
16, 1, 0, 1
17, 1, 1, 1
18, 0, 1, 1
21, 0, 0, -1
22, 1, 0, -1
23, 1, 1, -1
24, 0, 1, -1
25, 0, 0, -0.1
26, 1, 0, -0.1
27, 1, 1, -0.1
28, 0, 1, -0.1
*ELEMENT, TYPE=C3D8, ELSET=TOP
1, 11, 12, 13, 14, 15, 16, 17, 18
*ELEMENT, TYPE=C3D8, ELSET=BOTTOM
2, 21, 22, 23, 24, 25, 26, 27, 28
*SURFACE, NAME=FLOOR
2, S2
*STEP
*STATIC
*END STEP
";

/// A state without displacements of the mesh and of one node after it.
const ON_BRICKS: &str = r#"import sys
from stickslip_attach import Loops
surface = {"name": "floor"}
if sys.argv[2:]:
    surface["faces"] = [[12, 15, 14, 13]]
loops = Loops({"title": "bricks", "dimension": 3, "mesh": sys.argv[1], "nodes": [{"name": "eye", "at": [5, 5, 5]}],
               "surfaces": [surface], "contacts": [{"id": 7, "node": 2, "surface": "floor"}]})
loops.pause(ended="done", load=1, displacements=[[0, 0, 0]] * 17,
            contacts=[{"mode": "free", "next": "free", "gap": 0.1, "f_n": 0, "f_t": [0, 0], "limit": 0, "slip": [0, 0]}])
loops.end()
"#;

fn the_mesh_of_a_scene_may_be_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(at("stickslip_attach.py"), PYTHON).unwrap();
    std::fs::write(at("bricks.py"), ON_BRICKS).unwrap();
    std::fs::write(at("job.inp"), BRICKS).unwrap();
    let solver = |arguments: &[&str]| Start {
        start: PATIENT,
        answer: PATIENT,
        ..Start::new(
            [&["python3", &at("bricks.py")], arguments]
                .concat()
                .iter()
                .map(|word| (*word).to_owned())
                .collect(),
        )
    };
    let log = Log::default();
    log.keep(Path::new(&at("kept")), false).unwrap();
    let mut of_deck = session(solver(&[&at("job.inp")]), &log);
    does(&mut of_deck, run());
    assert!(of_deck.frames().len() == 2, "{}", of_deck.frames().len());
    let model = of_deck.scene().model.clone();
    let names: Vec<&str> = model.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!((names.len(), names[2], names[16]), (17, "13", "eye"));
    // The top face of the lower brick, and the edges of both.
    assert_eq!(model.surfaces[0].elements.len(), 4);
    let bars = |model: &stickslip::model::Model| match &model.bodies[0].kind {
        stickslip::model::BodyKind::Linear(linear) => linear.bars.len(),
        other => panic!("{other:?}"),
    };
    assert_eq!(bars(&model), 24);
    // The same mesh as a .vtu, whose nodes have no names.
    let state = &of_deck.frame().state;
    let whole = grid(&model, state, None, state.next, 3.0).unwrap();
    let brick = |first: usize| stickslip_exchange::mesh::Cell {
        kind: stickslip_exchange::mesh::CellKind::Hexa8,
        nodes: (first..first + 8).collect(),
    };
    let written = stickslip_exchange::vtu::Grid {
        points: whole.points[..16].to_vec(),
        cells: vec![brick(0), brick(8)],
        ..Default::default()
    };
    std::fs::write(at("job.vtu"), stickslip_exchange::vtu::write(&written)).unwrap();
    let of_vtu = session(solver(&[&at("job.vtu"), "faces"]), &Log::default());
    let other = of_vtu.scene().model.clone();
    assert_eq!(bars(&other), 24);
    let places = |model: &stickslip::model::Model| -> Vec<[f64; 2]> {
        model.nodes.iter().map(|node| node.at).collect()
    };
    assert_eq!(places(&model), places(&other));
    // The exchange has the mesh, not the name of a file.
    std::fs::remove_file(at("job.inp")).unwrap();
    let text = std::fs::read_to_string(at("kept")).unwrap();
    let opened = exchange::open("bricks", &text).unwrap();
    assert_eq!(places(&opened.scene.model), places(&model));
    for (file, why) in [
        ("job.inp", "mesh: "),
        ("bricks.py", "expected a file .inp or .vtu"),
        ("stickslip.vtu", "mesh: "),
    ] {
        let fault = Attached::attach(solver(&[&at(file)]), Log::default()).err();
        let fault = fault.unwrap().to_string();
        assert!(fault.contains(why) && fault.contains(file), "{fault}");
    }
    let named = text.replace(
        r#""title":"bricks""#,
        r#""title":"bricks","mesh":"job.inp""#,
    );
    let lines = named
        .lines()
        .map(|line| line.rsplit_once('\t').map_or(line, |(line, _)| line));
    let unsealed = ["# stickslip exchange 1".to_owned()].into_iter();
    let unsealed: Vec<String> = unsealed.chain(lines.skip(1).map(String::from)).collect();
    let refused = exchange::open("named", &(unsealed.join("\n") + "\n"))
        .err()
        .unwrap();
    assert!(
        refused.to_string().contains("only a running solver"),
        "{refused}"
    );
}
