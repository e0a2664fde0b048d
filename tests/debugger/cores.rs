//! The core of a cycle, and whole frozen problems, written out as scenes of their own: these take the same way.

use crate::common::{run, scene, two_blocks};
use std::path::Path;
use std::process::{Command as Process, Output};
use std::sync::Arc;
use stickslip::contact::record::Forced;
use stickslip::explain::core::{Core, core};
use stickslip::explain::cycles;
use stickslip::interface::minor_history::Cycle;
use stickslip::interface::problem::InterfaceProblem;
use stickslip::interface::trials::Trials;
use stickslip::model::Mode;
use stickslip::record::command::{Command, ExportScope, Unit};
use stickslip::record::export::{self, Origin, compared};
use stickslip::scene::{Scene, builtin};
use stickslip::session::Session;
use stickslip::step::event::{Failure, Outcome};
use stickslip::step::stepper::Stepper;

/// A run that ended in a cycle of minors: its stepper there, the cycle, and where.
struct Stuck {
    scene: Scene,
    stepper: Stepper,
    cycle: Cycle,
    origin: Origin,
}

fn stuck(scene: Scene) -> Option<Stuck> {
    let run = run(&scene);
    let (event, failure) = run.failure?;
    let Failure::Cycle(cycle) = failure else {
        return None;
    };
    let origin = Origin::new(&scene, event.position, event.load_factor);
    Some(Stuck {
        scene,
        stepper: run.stepper,
        cycle,
        origin,
    })
}

impl Stuck {
    fn core(&mut self) -> (InterfaceProblem, Core, String) {
        let problem = self.stepper.interface_problem().unwrap();
        let core = core(&problem).unwrap();
        let model = &self.scene.model;
        let text = export::core(model, &self.origin, &self.cycle, &core)
            .unwrap_or_else(|why| panic!("{}: {why}", self.scene.name));
        (problem, core, text)
    }
}

fn read(text: &str) -> Scene {
    Scene::from_text("core", text, &[]).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Modes and forces of nodes over a round.
type MajorCycle = Vec<Vec<(Mode, f64, f64)>>;

/// A round of some slave nodes, from a stepper that stands on a cycle.
fn round(stepper: &mut Stepper, slaves: &[usize], period: u32) -> MajorCycle {
    let of = |stepper: &mut Stepper| {
        let event = stepper.step().unwrap();
        let one = |&s: &usize| {
            let node = &event.nodes[s];
            (node.decision.before, node.f_n, node.f_t)
        };
        slaves.iter().map(one).collect()
    };
    (0..period).map(|_| of(stepper)).collect()
}

/// Whether two rounds are the same, wherever each begins.
fn same(a: &MajorCycle, b: &MajorCycle, size: f64) -> bool {
    let close = |x: f64, y: f64| (x - y).abs() <= 1e-9 * size;
    let equal = |a: &[(Mode, f64, f64)], b: &[(Mode, f64, f64)]| {
        let mut pairs = a.iter().zip(b);
        pairs.all(|(a, b)| a.0 == b.0 && close(a.1, b.1) && close(a.2, b.2))
    };
    (0..a.len()).any(|by| (0..a.len()).all(|k| equal(&a[(k + by) % a.len()], &b[k])))
}

/// The modes of a cycle's members, and how each goes on from where the first member's pattern is least.
fn patterns(cycle: &Cycle) -> Vec<String> {
    let letter = |mode: Mode| match mode {
        Mode::Free => 'F',
        Mode::Sliding => 'S',
        Mode::Fixed => 'X',
    };
    let turned = |by: usize| -> Vec<String> {
        let of = |modes: &Vec<Mode>| {
            (0..modes.len())
                .map(|k| letter(modes[(k + by) % modes.len()]))
                .collect()
        };
        cycle.members.iter().map(|(_, modes)| of(modes)).collect()
    };
    (0..cycle.period as usize)
        .map(turned)
        .min()
        .unwrap_or_default()
}

#[test]
fn every_oscillator_has_a_core_whose_file_cycles_as_it_does() {
    let mut found = Vec::new();
    for builtin in builtin::list()
        .iter()
        .filter(|b| b.name.starts_with("osc-"))
    {
        let name = builtin.name;
        let Some(mut stuck) = stuck(scene(name, &[])) else {
            continue;
        };
        let (problem, core, text) = stuck.core();
        let off = compared(&core.on_cycle(), &text).unwrap();
        assert!(off < 1e-11, "{name}: {off}");
        let mut alone = run(&read(&text));
        let Some((_, Failure::Cycle(cycle))) = &alone.failure else {
            panic!("{name}: {:?}\n{text}", alone.failure);
        };
        assert_eq!(cycle.period, core.cycle.period, "{name}");
        assert_eq!(patterns(cycle), patterns(&core.cycle), "{name}");
        let members = |cycle: &Cycle| cycle.members.iter().map(|m| m.0).collect::<Vec<_>>();
        assert_eq!(members(cycle), members(&core.cycle), "{name}");
        // What it does in the whole scene, if it is the whole cycle; else beside nodes that go on with what they do.
        let slaves: Vec<usize> = core
            .places
            .iter()
            .map(|&p| problem.nodes[p].slave)
            .collect();
        let all: Vec<usize> = (0..slaves.len()).collect();
        let ours = round(&mut alone.stepper, &all, core.cycle.period);
        let theirs = if slaves.len() == stuck.cycle.members.len() {
            assert_eq!(patterns(&stuck.cycle), patterns(&core.cycle), "{name}");
            round(&mut stuck.stepper, &slaves, core.cycle.period)
        } else {
            let frozen = core.on_cycle();
            let (mut trials, mut nodes) = (Trials::new(&frozen).unwrap(), frozen.states());
            let mut minor = || {
                let (records, _) = trials
                    .minor(
                        &mut nodes,
                        stickslip::strategy::method(problem.settings.strategy),
                    )
                    .unwrap();
                let one = |r: &stickslip::contact::record::ContactRecord| {
                    (r.decision.before, r.f_n, r.f_t)
                };
                records.iter().map(one).collect()
            };
            (0..core.cycle.period).map(|_| minor()).collect()
        };
        assert!(
            same(&ours, &theirs, problem.force),
            "{name}: {ours:?} {theirs:?}"
        );
        found.push(name);
    }
    assert!(found.len() >= 13, "{found:?}");
}

/// A frozen problem of the nodes that a file can have, none of them held by the user.
fn plain(problem: &InterfaceProblem) -> InterfaceProblem {
    let mut plain = problem.reduced(&export::writable(problem)).unwrap();
    plain
        .nodes
        .iter_mut()
        .for_each(|node| node.state.forced = Forced::No);
    plain
}

/// Several bodies, prescribed motion, forces already acting, slip to take back, ratios, lagged and consistent T_max.
#[test]
fn whole_frozen_problems_step_alone_as_in_their_scenes() {
    let consistent = [("settings.t_max", "consistent")];
    let scenes = [
        ("a", scene("01-pinned-beam-rough-floor", &[])),
        ("b", scene("02-two-cantilevers-rough", &[])),
        ("c", scene("02-two-cantilevers-rough", &consistent)),
        ("d", scene("05-cantilever-elastic-block", &[])),
        ("e", scene("osc-block-slide", &[])),
        ("f", scene("osc-three10", &[])),
        ("two blocks", two_blocks(1)),
    ];
    for (name, scene) in scenes {
        let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
        let (mut seen, mut worst) = (0, 0.0_f64);
        for step in 0..60 {
            if step % 6 == 1 {
                let problem = stepper.interface_problem().unwrap();
                let origin =
                    Origin::new(&scene, stepper.state().next, stepper.state().major.target);
                let text = export::whole(&scene.model, &origin, &problem)
                    .unwrap_or_else(|why| panic!("{name}, step {step}: {why}"));
                let off = compared(&plain(&problem), &text).unwrap();
                (seen, worst) = (seen + 1, worst.max(off));
            }
            if stepper
                .step()
                .is_none_or(|event| matches!(event.outcome, Outcome::Failed(_)))
            {
                break;
            }
        }
        println!("{name}: {seen} problems, off by at most {worst:.1e}");
        assert!(seen >= 1 && worst < 1e-8, "{name}: {seen}, {worst}");
    }
}

const COHESIVE: &str = "Contacts(
    title: \"stuck with slip to take back, and pulled off\",
    settings: (strategy: table2, touch: ratio),
    contacts: [(id: \"a\", friction: (angle: 16.7, cohesion: 1.0), load: (1.2, -2.0), start: fixed, state: (slip: 0.1))],
    matrix: Stiffness([[1.0, -0.8], [-0.8, 1.0]]),
)";

#[test]
fn slip_to_take_back_is_kept_while_the_node_is_free() {
    for slip in ["increment", "major"] {
        let set = [("settings.slip".to_owned(), slip.to_owned())];
        let scene = Scene::from_text("cohesive", COHESIVE, &set).unwrap();
        let mut stuck = stuck(scene).expect("a cycle");
        assert_eq!(patterns(&stuck.cycle), ["FX"]);
        let (_, core, text) = stuck.core();
        assert_eq!(core.on_cycle().nodes[0].state.mode, Mode::Free);
        assert!(
            text.contains("slip: 0.1") || text.contains("slip: 0.0999"),
            "{text}"
        );
        let mut alone = run(&read(&text));
        let ours = round(&mut alone.stepper, &[0], 2);
        let theirs = round(&mut stuck.stepper, &[0], 2);
        assert!(same(&ours, &theirs, 1.0), "{ours:?} {theirs:?}");
        let stuck_at = theirs
            .iter()
            .flatten()
            .find(|node| node.0 == Mode::Fixed)
            .unwrap();
        // u_t = 0.1 takes the slip back: F_n = -0.8 u_t - 1.2.
        assert!((stuck_at.1 + 1.28).abs() < 1e-12, "{stuck_at:?}");
    }
}

fn contacts(matrix: &str) -> Scene {
    let text = format!(
        "Contacts(title: \"t\", contacts: [(id: \"a\", load: (-1.0, 0.0), start: sliding), (id: \"b\", gap: 0.1, \
         load: (-0.5, 0.0))], matrix: {matrix})"
    );
    read(&text)
}

fn exported(scene: &Scene) -> Result<String, String> {
    let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
    let problem = stepper.interface_problem().unwrap();
    let origin = Origin::new(scene, stepper.state().next, 1.0);
    export::whole(&scene.model, &origin, &problem).map_err(|e| e.to_string())
}

#[test]
fn what_is_rigid_is_written_as_a_compliance_and_what_is_loose_as_a_stiffness() {
    // Both tangential motions are held.
    let rigid = contacts(
        "Compliance([[1.0, 0.0, 0.5, 0.0], [0.0, 0.0, 0.0, 0.0], [0.5, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 0.0]])",
    );
    let text = exported(&rigid).unwrap();
    assert!(text.contains("matrix: Compliance("), "{text}");
    // Both may turn about a's side: what holds b is a alone.
    let loose = contacts(
        "Stiffness([[1.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])",
    );
    let text = exported(&loose).unwrap();
    assert!(text.contains("matrix: Stiffness("), "{text}");
}

#[test]
fn what_is_rigid_and_loose_at_once_is_refused_with_both_reasons() {
    let text = "(
        title: \"rigid and loose\",
        nodes: [Node(id: \"a\", at: (0, 0)), Node(id: \"b\", at: (1, 0.1)), Node(id: \"c\", at: (2, 0)),
            Line(id: \"floor\", from: (4, 0), to: (-1, 0), elements: 1, per_element: 2)],
        materials: [],
        bodies: [
            Matrix(id: \"loose\", nodes: [\"a\", \"b\"], stiffness: [[1, 0, 0, 0], [0, 1, 0, -1], [0, 0, 1, 0], [0, -1, 0, 1]]),
            Matrix(id: \"rigid\", nodes: [\"c\"], compliance: [[0, 0], [0, 1]]),
        ],
        surfaces: [(id: \"floor\", along: \"floor\", endless: true)],
        slaves: [(nodes: [\"a\", \"b\", \"c\"], on: [\"floor\"], start: sliding)],
        loads: [Force(node: \"a\", y: -1)],
        history: (path: [0, 1], increment: 1),
    )";
    let why = exported(&read(text)).unwrap_err();
    assert!(
        why.contains("no stiffness: some motion is rigidly fixed"),
        "{why}"
    );
    assert!(
        why.contains("no compliance: some motion is unrestrained"),
        "{why}"
    );
}

#[test]
fn a_spacing_that_is_no_length_is_refused_with_its_line() {
    for spacing in ["0.0", "-1.0", "inf", "NaN"] {
        let text = COHESIVE.replace(
            "    matrix",
            &format!("    spacing: {spacing},\n    matrix"),
        );
        let error = Scene::from_text("t", &text, &[]).unwrap_err().to_string();
        assert!(error.starts_with("t:5:"), "{error}");
        assert!(error.contains("positive length"), "{error}");
    }
}

fn program(directory: &Path, arguments: &[&str]) -> Output {
    Process::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap()
}

#[test]
fn the_command_writes_a_core_whole_once_and_says_where_there_is_none() {
    let directory = tempfile::tempdir().unwrap();
    let ran = |arguments: &[&str]| {
        let output = program(directory.path(), arguments);
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
        (
            output.status.code().unwrap(),
            text(&output.stdout),
            text(&output.stderr),
        )
    };
    let (code, out, err) = ran(&["core", "osc-drag65"]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(
        out.starts_with("// The core of a cycle")
            && out.contains("(id: \"beam.5\"")
            && !out.contains("beam-5"),
        "{out}"
    );
    assert!(
        out.contains("increment 1, major 1, minor 4, load 0.1"),
        "{out}"
    );
    let (code, nothing, err) = ran(&["core", "osc-drag65", "-o", "core.ron"]);
    assert_eq!(
        (code, nothing.as_str(), err.trim()),
        (0, "", "wrote core.ron")
    );
    assert_eq!(
        std::fs::read_to_string(directory.path().join("core.ron")).unwrap(),
        out
    );
    let (code, _, err) = ran(&["run", "core.ron"]);
    assert!(code == 3 && err.contains("cycle of period 4"), "{err}");
    let (code, _, err) = ran(&["core", "osc-touch2", "-o", "core.ron"]);
    assert!(code == 2 && err.contains("--force"), "{err}");
    assert_eq!(
        std::fs::read_to_string(directory.path().join("core.ron")).unwrap(),
        out
    );
    let (code, ..) = ran(&["core", "osc-touch2", "-o", "core.ron", "--force"]);
    assert_eq!(code, 0);
    assert_ne!(
        std::fs::read_to_string(directory.path().join("core.ron")).unwrap(),
        out
    );
    // Nothing is written where there is no cycle of minors.
    for (scene, told) in [
        ("02-two-cantilevers-smooth", "the scene converges"),
        ("osc-p5-slow", "not in a cycle of minor iterations"),
    ] {
        let (code, out, err) = ran(&["core", scene, "-o", "none.ron"]);
        assert_eq!((code, out.as_str()), (3, ""), "{err}");
        assert!(err.contains(told), "{err}");
    }
    let names: Vec<_> = std::fs::read_dir(directory.path()).unwrap().collect();
    assert_eq!(names.len(), 1, "{names:?}");
}

#[test]
fn the_debugger_writes_cores_whole_problems_and_what_an_extension_says() {
    let directory = tempfile::tempdir().unwrap();
    let mut session = Session::new(scene("osc-two6", &[]));
    let write = |session: &mut Session, what: ExportScope, name: &str| {
        let file = directory.path().join(name);
        let command = Command::Export {
            what,
            file: file.clone(),
            overwrite: false,
        };
        session.submit(command).map_err(|e| e.to_string())?;
        session.background_mut().wait();
        session
            .background_mut()
            .exported()
            .unwrap()
            .map_err(|e| e.to_string())?;
        Ok::<String, String>(std::fs::read_to_string(file).unwrap())
    };
    // From the start, too, since the minor iterations run into the cycle.
    let core = write(&mut session, ExportScope::Core, "early.ron").unwrap();
    let (_, of_file) = core.split_once("// In this file: ").unwrap();
    let file = Scene::from_text("core", &core, &[]).unwrap();
    let cycle = stuck(file).map(|own| cycles::cycle(&own.scene.model, &own.cycle));
    let words = cycle.unwrap();
    assert!(
        of_file.starts_with(&format!("{words}.\n")),
        "{words}\n{core}"
    );
    let again = write(&mut session, ExportScope::Core, "early.ron").unwrap_err();
    assert!(again.contains("exists already"), "{again}");
    let run = Command::Forward {
        unit: Unit::Run,
        count: 1,
    };
    session.submit(run).unwrap();
    session.wait();
    let whole = write(&mut session, ExportScope::Whole, "whole.ron").unwrap();
    let cycle = stuck(read(&whole)).expect("a cycle").cycle;
    assert_eq!((cycle.period, cycle.members.len()), (6, 2));
    // By the extension: a picture of the state, the scene, and the problem for another program.
    let bytes = write(&mut session, ExportScope::Shown, "shown.svg").unwrap();
    assert!(
        bytes.contains("the increment failed: cycle of period 6"),
        "{bytes}"
    );
    let scene_file = write(&mut session, ExportScope::Shown, "scene.ron").unwrap();
    assert_eq!(scene_file, session.scene().text);
    let siconos = write(&mut session, ExportScope::Whole, "whole.dat").unwrap();
    assert!(siconos.starts_with("2\n2\n"), "{siconos}");
    let unknown = write(&mut session, ExportScope::Shown, "a.bmp").unwrap_err();
    assert!(
        unknown.contains(".svg (") && unknown.contains(".dat ("),
        "{unknown}"
    );
    let film = write(&mut session, ExportScope::Shown, "a.cast").unwrap_err();
    assert!(film.contains("stickslip export JOURNAL"), "{film}");
    let mut session = Session::new(scene("02-two-cantilevers-smooth", &[]));
    let none = write(&mut session, ExportScope::Core, "none.ron").unwrap_err();
    assert!(none.contains("do not cycle"), "{none}");
    assert!(!directory.path().join("none.ron").exists());
}
