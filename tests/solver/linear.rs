//! Bodies given by a matrix, endless floors, and what slave nodes bring along.

use crate::common::{finished, read, run};
use stickslip::format::condensed::{Contact, Matrix, Problem};
use stickslip::format::spec::History;
use stickslip::format::{Spec, notation};
use stickslip::model::InitialState;
use stickslip::model::{Friction, Mode, Settings};
use stickslip::scene::Scene;
use stickslip::step::stepper::Stepper;

fn contact(id: &str, gap: f64, load: [f64; 2]) -> Contact {
    Contact {
        id: id.to_owned(),
        gap,
        friction: Friction {
            angle: 20.0,
            cohesion: 0.0,
        },
        load,
        start: Mode::Free,
        state: InitialState::default(),
    }
}

fn problem(contacts: Vec<Contact>, matrix: Matrix, free: Vec<f64>) -> Problem {
    Problem {
        tangents: 1,
        title: "t".to_owned(),
        about: String::new(),
        contacts,
        matrix,
        free,
        spacing: None,
        history: History {
            increment: 0.25,
            ..History::default()
        },
        settings: Settings::default(),
    }
}

fn scene(problem: &Problem, set: &[(&str, &str)]) -> Scene {
    let scene = Scene::from_spec("t", problem.spec()).unwrap_or_else(|e| panic!("{e}"));
    set.iter().fold(scene, |scene, (path, value)| {
        scene.with(path, value).unwrap()
    })
}

fn inverse(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = rows.len();
    let matrix = nalgebra::DMatrix::from_fn(n, n, |i, j| rows[i][j]);
    let inverse = matrix.try_inverse().unwrap();
    (0..n)
        .map(|i| (0..n).map(|j| inverse[(i, j)]).collect())
        .collect()
}

const SYMMETRIC: [[f64; 4]; 4] = [
    [3.0, 0.4, -1.0, 0.2],
    [0.4, 2.0, 0.1, -0.5],
    [-1.0, 0.1, 4.0, 0.3],
    [0.2, -0.5, 0.3, 2.0],
];

fn rows(unsymmetric: f64) -> Vec<Vec<f64>> {
    let mut rows: Vec<Vec<f64>> = SYMMETRIC.iter().map(|row| row.to_vec()).collect();
    rows[0][1] += unsymmetric;
    rows[2][3] -= unsymmetric;
    rows
}

/// What a run of two contacts comes to: modes, forces, displacements.
fn end(scene: &Scene) -> (Vec<Mode>, Vec<f64>) {
    let run = run(scene);
    assert!(run.failure.is_none(), "{:?}", run.failure);
    let nodes = &run.accepted.last().unwrap().event.nodes;
    let modes = nodes.iter().map(|n| n.decision.next).collect();
    let mut numbers: Vec<f64> = nodes.iter().flat_map(|n| [n.f_n, n.f_t]).collect();
    for slave in &run.stepper.model().contacts {
        let first = run.stepper.model().dofs.first[slave.node];
        numbers.extend(&run.stepper.state().u[first..first + 2]);
    }
    (modes, numbers)
}

#[test]
fn a_stiffness_its_inverse_and_both_solvers_give_the_same() {
    for unsymmetric in [0.0, 0.3] {
        let contacts = || {
            vec![
                contact("a", 0.05, [-0.5, 0.3]),
                contact("b", 0.0, [-0.2, -0.1]),
            ]
        };
        let free = vec![0.0, 0.02, -0.1, 0.03];
        let stiffness = rows(unsymmetric);
        let compliance = Matrix::Compliance(inverse(&stiffness));
        let given = [Matrix::Stiffness(stiffness), compliance];
        let ends: Vec<_> = given
            .into_iter()
            .flat_map(|matrix| {
                let problem = problem(contacts(), matrix, free.clone());
                ["augmented", "condensed"].map(|s| end(&scene(&problem, &[("settings.solver", s)])))
            })
            .collect();
        assert!(ends[0].0.iter().any(|mode| *mode != Mode::Free), "{ends:?}");
        for (modes, numbers) in &ends[1..] {
            assert_eq!(modes, &ends[0].0);
            for (a, b) in numbers.iter().zip(&ends[0].1) {
                assert!((a - b).abs() < 1e-11, "{ends:?}");
            }
        }
        // By hand: K (u − free) = load + f, in the contacts' own frames.
        let n = &ends[0].1;
        let u = [n[5], -n[4], n[7], -n[6]];
        let load = [-0.5, 0.3, -0.2, -0.1];
        for (i, row) in rows(unsymmetric).iter().enumerate() {
            let force: f64 = row
                .iter()
                .zip(u.iter().zip(&free))
                .map(|(k, (u, f))| k * (u - f))
                .sum();
            assert!((force - load[i] - n[i]).abs() < 1e-11, "row {i}: {ends:?}");
        }
    }
}

#[test]
fn a_problem_survives_being_written_as_a_scene_and_read() {
    let problem = problem(
        vec![
            contact("a", 0.05, [-0.5, 0.3]),
            contact("b", 0.0, [0.0, -0.1]),
        ],
        Matrix::Compliance(rows(0.1)),
        vec![0.1; 4],
    );
    let spec = problem.spec();
    let text = notation::options()
        .to_string_pretty(&spec, ron::ser::PrettyConfig::default())
        .unwrap();
    let again: Spec = notation::options().from_str(&text).unwrap();
    assert_eq!(again, spec);
    assert_eq!(
        Scene::from_text("t", &text, &[]).unwrap().model,
        Scene::from_spec("t", spec).unwrap().model
    );
}

#[test]
fn contacts_and_a_matrix_are_a_scene_by_themselves() {
    let text = "// A comment.\nContacts(title: \"t\", contacts: [(id: \"a\", gap: 0.05, friction: (angle: 20.0), \
                load: (-0.5, 0.3)), (id: \"b\", friction: (angle: 20.0), load: (0.0, -0.1))],\n\
                matrix: Stiffness([[3.0, 0.4, -1.0, 0.2], [0.4, 2.0, 0.1, -0.5], [-1.0, 0.1, 4.0, 0.3], \
                [0.2, -0.5, 0.3, 2.0]]), history: (path: [0.0, 1.0], increment: 0.25))";
    let same = problem(
        vec![
            contact("a", 0.05, [-0.5, 0.3]),
            contact("b", 0.0, [0.0, -0.1]),
        ],
        Matrix::Stiffness(rows(0.0)),
        vec![],
    );
    let read = read(text);
    assert_eq!(read.spec, same.spec());
    let broken = text.replace("gap: 0.05", "gab: 0.05");
    let error = Scene::from_text("t", &broken, &[]).unwrap_err().to_string();
    assert!(
        error.starts_with("t:2:") && error.contains("did you mean \"gap\""),
        "{error}"
    );
    let lacking = text.replace("[0.2, -0.5, 0.3, 2.0]", "");
    let error = Scene::from_text("t", &lacking, &[])
        .unwrap_err()
        .to_string();
    assert!(error.contains("it must have 4, one for x"), "{error}");
}

fn single(k: f64) -> Matrix {
    Matrix::Stiffness(vec![vec![k, 0.0], vec![0.0, k]])
}

#[test]
fn an_endless_floor_is_never_left() {
    let problem = problem(vec![contact("a", 0.0, [-1.0, 4e3])], single(1.0), vec![]);
    let run = finished(&scene(&problem, &[("slaves[0].start", "sliding")]));
    let last = &run.accepted.last().unwrap().event.nodes[0];
    assert_eq!(last.decision.next, Mode::Sliding);
    assert!((last.f_n - 1.0).abs() < 1e-9 && last.spot.unwrap().xi.abs() > 1e3);
}

/// F_n balances a load that is there from the start; so the first minor iteration has nothing to do.
#[test]
fn forces_that_a_node_brings_hold_what_loads_it() {
    for residual in ["accumulate", "stress"] {
        let mut it = contact("a", 0.0, [0.0, 0.0]);
        (it.start, it.state.f_n, it.state.f_t) = (Mode::Fixed, 2.0, 0.5);
        let mut spec = problem(vec![it], single(1.0), vec![]).spec();
        spec.loads.push(stickslip::format::spec::LoadSpec::Force {
            node: "a".to_owned(),
            x: 0.5,
            y: -2.0,
            scale: vec![(0.0, 1.0)],
        });
        let scene = Scene::from_spec("t", spec)
            .unwrap()
            .with("settings.residual", residual)
            .unwrap();
        let mut stepper = Stepper::new(std::sync::Arc::new(scene.model));
        let event = stepper.step().unwrap();
        assert!(event.before.force < 1e-15, "{:?}", event.before);
        let node = &event.nodes[0];
        assert_eq!(
            (node.decision.before, node.decision.next),
            (Mode::Fixed, Mode::Fixed)
        );
        assert!((node.f_n - 2.0).abs() < 1e-14 && (node.f_t - 0.5).abs() < 1e-14);
    }
}

#[test]
fn t_max_slip_and_ratio_that_a_node_brings_stand_in_its_first_equations() {
    let with = |start: Mode, state: InitialState, gap: f64, settings: Settings| {
        let mut it = contact("a", gap, [-1.0, 0.2]);
        (it.start, it.state) = (start, state);
        let problem = Problem {
            settings,
            ..problem(vec![it], single(1.0), vec![])
        };
        let mut stepper = Stepper::new(std::sync::Arc::new(scene(&problem, &[]).model));
        stepper.step().unwrap().nodes[0]
    };
    let none = InitialState::default();
    let settings = Settings::default();
    let sliding = with(
        Mode::Sliding,
        InitialState {
            t_max: -0.02,
            ..none
        },
        0.0,
        settings,
    );
    assert!((sliding.f_t + 0.02).abs() < 1e-15 && sliding.t_max_used == -0.02);
    // Slip is u_tS* − u_tS, of which the node brings a part: it has to come back that far to stick.
    let slid = with(
        Mode::Sliding,
        InitialState {
            t_max: -0.02,
            slip: -0.3,
            ..none
        },
        0.0,
        settings,
    );
    assert!((slid.slip - (sliding.slip - 0.3)).abs() < 1e-14);
    let stuck = with(
        Mode::Fixed,
        InitialState { slip: -0.3, ..none },
        0.0,
        settings,
    );
    assert!((stuck.f_t - (-0.05 - 0.3)).abs() < 1e-14, "{}", stuck.f_t);
    // It touches at a gap of 0.1, having travelled 0.5 along for 1 down: 0.05 along.
    let touched = with(
        Mode::Fixed,
        InitialState { ratio: 0.5, ..none },
        0.1,
        settings,
    );
    assert!(
        (touched.f_t - (-0.05 - 0.05)).abs() < 1e-14,
        "{}",
        touched.f_t
    );
}

const TEXT: &str = "(title: \"t\",
nodes: [Node(id: \"a\", at: (0.0, 0.1)), Node(id: \"b\", at: (1.0, 0.1)),
Line(id: \"f\", from: (1.0, 0.0), to: (-1.0, 0.0), elements: 1, per_element: 2)], materials: [],
bodies: [
BODY
],
surfaces: [(id: \"f\", along: \"f\", endless: true)],
slaves: [(nodes: [\"a\"], on: [\"f\"], state: (f_n: 0.0))],
loads: [Force(node: \"b\", y: -1.0)], history: (path: [0.0, 1.0], increment: 1.0))";
const GOOD: &str = "Matrix(id: \"m\", nodes: [\"a\"], stiffness: [[1.0, 0.0], [0.0, 1.0]]), \
                    Springs(id: \"s\", bars: [(nodes: [\"a\", \"b\"], angle: 0.0, stiffness: 1.0)])";

#[test]
fn each_fault_has_one_message_with_its_place() {
    let good = TEXT.replace("BODY", GOOD);
    read(&good);
    let cases = [
        (
            "[[1.0, 0.0], [0.0, 1.0]]",
            "[[1.0, 0.0]]",
            5,
            "the matrix has 1 row;",
        ),
        ("[[1.0, 0.0],", "[[1.0],", 5, "the row has 1 number;"),
        (
            "[[1.0, 0.0],",
            "[[1.0, inf],",
            5,
            "it must be a finite number",
        ),
        (
            "stiffness: [[1.0, 0.0], [0.0, 1.0]]",
            "free: [0.0, 0.0]",
            5,
            "neither stiffness nor compliance",
        ),
        (
            "stiffness: [[",
            "compliance: [[1.0]], stiffness: [[",
            5,
            "both stiffness and compliance",
        ),
        (
            "stiffness: [[",
            "free: [1.0], stiffness: [[",
            5,
            "the row has 1 number; it must have 2",
        ),
        (
            "nodes: [\"a\"], stiff",
            "nodes: [\"a\", \"a\"], stiff",
            5,
            "is already in the matrix",
        ),
        ("nodes: [\"a\"], stiff", "nodes: [\"c\"], stiff", 5, "\"c\""),
        (
            "nodes: [\"a\"], stiff",
            "nodes: [], stiff",
            5,
            "the list is empty",
        ),
        (
            "nodes: [\"a\", \"b\"], angle",
            "nodes: [\"a\", \"a\"], angle",
            5,
            "two different nodes",
        ),
        (
            "nodes: [\"a\", \"b\"], angle",
            "nodes: [], angle",
            5,
            "must be 1 to 2",
        ),
        (
            "angle: 0.0, stiffness: 1.0",
            "angle: 0.0, stiffness: 0.0",
            5,
            "must be positive",
        ),
        ("angle: 0.0", "angle: inf", 5, "the angle"),
        (
            "(nodes: [\"a\", \"b\"], angle: 0.0, stiffness: 1.0)",
            "",
            5,
            "name at least one bar",
        ),
        (
            "Line(id: \"f\", from: (1.0, 0.0), to: (-1.0, 0.0), elements: 1, per_element: 2)",
            "Through(id: \"f\", points: [(1.0, 0.0), (0.0, 0.1), (-1.0, 0.0)], per_element: 2)",
            7,
            "an endless surface must be straight",
        ),
        (
            "endless: true",
            "endless: true, smooth: true",
            7,
            "an endless surface is already smooth",
        ),
        (
            "endless: true",
            "endless: true, past_ends: 0.1",
            7,
            "an endless surface has no ends",
        ),
        ("endless: true", "past_ends: 1.5", 7, "between 0 and 1"),
        ("f_n: 0.0", "f_n: inf", 8, "must be a finite number"),
        (
            "surfaces: [(id: \"f\", along: \"f\"",
            "surfaces: [(id: \"f\", along: \"f\", reverze: true",
            7,
            "reverze",
        ),
    ];
    for (from, to, line, part) in cases {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let error = Scene::from_text("t.ron", &text, &[])
            .expect_err(part)
            .to_string();
        assert!(
            error.starts_with(&format!("t.ron:{line}:")),
            "{part}: {error}"
        );
        assert!(error.contains(part), "{part}: {error}");
    }
}
