//! Strategies of the minor iterations: none accepts what is no Coulomb state, the ladder finds an answer wherever there
//! is one, says so where there is none, and cuts the increment.

use crate::common::{force_in, read, run, scene, stepped};
use crate::hyperstatic::Numbers;
use std::sync::Arc;
use stickslip::contact::table2::Rule;
use stickslip::format::condensed::{Contact, Matrix, Problem};
use stickslip::format::spec::History;
use stickslip::interface::census::{Census, census};
use stickslip::interface::method::NotFound;
use stickslip::interface::trials::Trials;
use stickslip::linear::singular::Singular;
use stickslip::model::{Friction, Mode, Model, Settings};
use stickslip::model::{InitialState, Strategy};
use stickslip::scene::Scene;
use stickslip::step::event::{Failure, Outcome};
use stickslip::step::state::Status;
use stickslip::step::stepper::Stepper;

/// A random interface problem with a positive definite stiffness; some have cohesion, and perhaps no answer.
pub fn problem(seed: u64) -> Problem {
    let mut numbers = Numbers(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5DEE_CE66);
    for _ in 0..4 {
        numbers.next();
    }
    let count = 1 + (numbers.next() * 4.0) as usize;
    let size = 2 * count;
    let root: Vec<Vec<f64>> = (0..size)
        .map(|_| (0..size).map(|_| numbers.between(-1.0, 1.0)).collect())
        .collect();
    let entry = |i: usize, j: usize| {
        let product: f64 = (0..size).map(|k| root[k][i] * root[k][j]).sum();
        product + if i == j { 0.1 } else { 0.0 }
    };
    let rows = (0..size)
        .map(|i| (0..size).map(|j| entry(i, j)).collect())
        .collect();
    let contacts = (0..count)
        .map(|k| Contact {
            id: format!("n{k}"),
            gap: if numbers.next() < 0.4 {
                0.0
            } else {
                numbers.between(-0.1, 0.3)
            },
            friction: Friction {
                angle: numbers.between(0.2, 1.2_f64).atan().to_degrees(),
                cohesion: if numbers.next() < 0.3 {
                    numbers.between(0.1, 1.0)
                } else {
                    0.0
                },
            },
            load: [numbers.between(-1.0, 1.0), numbers.between(-1.0, 1.0)],
            start: Mode::Free,
            state: InitialState::default(),
        })
        .collect();
    Problem {
        tangents: 1,
        title: format!("problem {seed}"),
        about: String::new(),
        contacts,
        matrix: Matrix::Stiffness(rows),
        free: Vec::new(),
        spacing: None,
        history: History {
            least: Some(1.0),
            ..History::default()
        },
        settings: Settings::default(),
    }
}

fn model(problem: &Problem, strategy: &str) -> Arc<Model> {
    let scene = Scene::from_spec("random", problem.spec()).unwrap_or_else(|e| panic!("{e}"));
    let scene = scene.with("settings.strategy", strategy).unwrap();
    Arc::new(scene.model)
}

fn truth(problem: &Problem) -> Census {
    let mut stepper = Stepper::new(model(problem, "table2"));
    census(&stepper.interface_problem().unwrap()).unwrap()
}

/// Steps to the first accepted increment or the failure.
pub fn end(stepper: &mut Stepper) -> Result<(), Failure> {
    loop {
        match stepper.step().map(|event| event.outcome.clone()) {
            Some(Outcome::Failed(failure)) => return Err(failure),
            Some(Outcome::Increment { .. }) => return Ok(()),
            Some(_) => {}
            None => panic!("the history ended without an increment"),
        }
    }
}

/// Whether the accepted forces and gaps are those of one of the answers.
fn is_answer(stepper: &Stepper, truth: &Census) -> bool {
    let nodes = &stepper.event().nodes;
    truth.answers.iter().any(|found| {
        let mut pairs = nodes.iter().zip(&found.answer.nodes);
        pairs.all(|(record, node)| {
            (record.f_n - node.f_n).abs() < 1e-7
                && (record.f_t - node.f_t).abs() < 1e-7
                && (record.gap - node.gap).abs() < 1e-7
        })
    })
}

#[test]
fn no_strategy_accepts_what_is_no_coulomb_state_and_the_ladder_solves_all_that_have_one() {
    let mut solved = [0; Strategy::ALL.len()];
    let (mut with_answer, mut without) = (0, 0);
    for seed in 0..250 {
        let problem = problem(seed);
        let truth = truth(&problem);
        match truth.answers.len() {
            0 => without += 1,
            _ => with_answer += 1,
        }
        for (k, strategy) in Strategy::NAMES.into_iter().enumerate() {
            let mut stepper = Stepper::new(model(&problem, strategy));
            match end(&mut stepper) {
                Ok(()) => {
                    assert!(is_answer(&stepper, &truth), "{strategy}, problem {seed}");
                    solved[k] += 1;
                }
                Err(failure) if strategy == "ladder" => {
                    assert!(truth.answers.is_empty(), "problem {seed}: {failure:?}");
                    let Failure::NoAnswer { tried, .. } = failure else {
                        panic!("problem {seed}: {failure:?}");
                    };
                    assert_eq!(tried, truth.tried);
                }
                Err(_) => {}
            }
        }
    }
    assert!(with_answer > 200 && without > 5, "{with_answer} {without}");
    let of = |name: &str| solved[Strategy::NAMES.iter().position(|s| *s == name).unwrap()];
    println!("{:?} {solved:?} of {with_answer}", Strategy::NAMES);
    assert_eq!(of("ladder"), with_answer);
    assert_eq!(of("census"), with_answer);
    assert!(of("table2") < of("sliding") && of("sliding") <= of("lemke"));
}

#[test]
fn pivoting_goes_on_with_the_same_bits_after_a_restore_at_any_pivot() {
    let mut problems = (17..).map(problem);
    let problem = problems.find(|p| p.contacts.len() == 4).unwrap();
    let model = model(&problem, "lemke");
    let (states, events) = stepped(&model);
    let pivots = events.iter().flat_map(|e| &e.nodes);
    assert!(pivots.filter(|n| n.decision.rule == Rule::Pivots).count() > 4);
    for (state, event) in states.iter().zip(&events) {
        let mut other = Stepper::new(model.clone());
        other.restore(state);
        assert_eq!(other.step().unwrap(), event);
    }
}

#[test]
fn newtons_verdicts_on_the_frozen_problem_are_the_steppers_where_the_bodies_are_all_solids() {
    let set = [
        ("settings.strategy", "newton"),
        ("settings.solver", "condensed"),
    ];
    let blocks = include_str!("../benches/two-blocks-pressed-sheared.ron");
    let blocks = read(blocks);
    let blocks = set.iter().fold(blocks, |scene, (path, value)| {
        scene.with(path, value).unwrap()
    });
    let mut stepper = Stepper::new(Arc::new(blocks.model));
    for _ in 0..6 {
        let problem = stepper.interface_problem().unwrap();
        assert!(problem.relation.stiffness.is_infinite());
        let mut trials = Trials::new(&problem).unwrap();
        let (records, _) = trials
            .minor(
                &mut problem.states(),
                stickslip::strategy::method(problem.settings.strategy),
            )
            .unwrap();
        let event = stepper.step().unwrap();
        for (own, other) in records.iter().zip(&event.nodes) {
            assert_eq!(own.decision.next, other.decision.next);
            let [a, b] = [own, other].map(|r| r.decision.tests[0].map_or(0.0, |t| t.value));
            assert!((a - b).abs() <= 1e-9 * problem.force, "{a} {b}");
        }
    }
}

#[test]
fn the_ladder_gets_out_of_the_oscillators_that_have_an_answer() {
    for name in [
        "osc-block-free",
        "osc-drag65",
        "osc-inclined-cantilever",
        "osc-lag4",
        "osc-slowlag",
        "osc-snap",
        "osc-three10",
        "osc-touch2",
        "osc-two3",
        "osc-two6",
        "osc-zig3",
    ] {
        let run = run(&scene(name, &[("settings.strategy", "ladder")]));
        assert!(run.failure.is_none(), "{name}: {:?}", run.failure);
    }
}

#[test]
fn the_ladder_goes_on_with_friction_where_table_2_cycles() {
    for (name, angle, increment) in [
        ("02-two-cantilevers-rough", "10", "0.05"),
        ("04-cantilever-rigid-circle", "10", "0.02"),
        ("04-cantilever-rigid-circle", "30", "0.02"),
    ] {
        let with = |strategy| {
            let set = [
                ("friction.angle", angle),
                ("history.increment", increment),
                ("settings.strategy", strategy),
            ];
            run(&scene(name, &set)).failure
        };
        assert!(with("table2").is_some(), "{name} at {angle} degrees");
        assert_eq!(with("ladder"), None, "{name} at {angle} degrees");
    }
}

/// Along a belt the border between sticking and sliding nodes moves by about one node per minor iteration.
#[test]
fn the_minor_iterations_of_a_long_belt_grow_no_faster_than_its_nodes() {
    let minors = |refine| {
        let run = run(&scene("bench-belt", &[("refine", refine)]));
        assert_eq!(run.failure, None, "{refine}");
        run.steps
    };
    let (short, long) = (minors("1"), minors("4"));
    assert!(long <= 4 * short, "{short} {long}");
}

/// The way up ends at a limit point, near P = 1.783 on this mesh. Each run lets go less than the least of its increments, a
/// 64th, below it.
#[test]
fn at_a_limit_point_the_ladder_ends_at_the_same_load_with_any_increment() {
    let ends = ["0.1", "0.05", "0.01"].map(|increment| {
        let set = [
            ("friction.angle", "20"),
            ("history.increment", increment),
            ("history.jumps", "stop"),
        ];
        let run = run(&scene("02-two-cantilevers-rough", &set));
        assert!(run.failure.is_some(), "{increment}");
        let last = run.stepper.state().start.load_factor;
        (last, last + increment.parse::<f64>().unwrap() / 64.0)
    });
    let above = ends.iter().fold(0.0_f64, |most, end| most.max(end.0));
    let below = ends
        .iter()
        .fold(f64::INFINITY, |least, end| least.min(end.1));
    assert!(above < below, "{ends:?}");
    assert!((above - 1.7828).abs() < 1e-4, "{ends:?}");
}

/// Beyond, the next state of equilibrium is far; sliding that is held back leads there from any increment.
#[test]
fn past_a_limit_point_the_ladder_comes_to_the_same_state_with_any_increment_and_marks_the_jump() {
    for angle in ["5", "10", "20"] {
        let ends = ["0.1", "0.05", "0.02"].map(|increment| {
            let set = [
                ("friction.angle", angle),
                ("history.increment", increment),
                ("refine", "4"),
                // Its limit points are what is wanted here: without them nothing jumps at 5 degrees.
                ("settings.point_force", "plain"),
            ];
            let run = run(&scene("02-two-cantilevers-rough", &set));
            assert!(run.failure.is_none(), "{set:?}: {:?}", run.failure);
            let jumps = |a: &&crate::common::Accepted| {
                matches!(a.event.outcome, Outcome::Increment { jumped: true, .. })
            };
            assert!(
                run.accepted.iter().any(|a| jumps(&a)),
                "{set:?}: a jump is marked"
            );
            run.accepted.last().unwrap().monitors["u_x"]
        });
        for end in ends {
            assert!((end - ends[0]).abs() < 1e-8, "{angle}: {ends:?}");
        }
    }
}

#[test]
fn where_there_is_no_answer_the_ladder_says_so_and_cuts_the_increment_down_to_the_least() {
    let set = [("settings.strategy", "ladder"), ("history.least", "0.2")];
    let mut stepper = Stepper::new(Arc::new(scene("osc-coh-none", &set).model));
    let mut sizes = Vec::new();
    let failure = loop {
        match &stepper.step().unwrap().outcome {
            Outcome::Cut { why, size } => {
                assert!(matches!(why, Failure::NoAnswer { tried: 4, .. }), "{why:?}");
                sizes.push(*size);
            }
            Outcome::Failed(failure) => break failure.clone(),
            _ => {}
        }
    };
    assert_eq!(sizes, [0.5, 0.25]);
    assert!(matches!(failure, Failure::NoAnswer { .. }));
    assert_eq!(stepper.state().next.attempt, 3);
}

#[test]
fn a_census_over_too_many_nodes_says_that_and_not_that_there_is_no_answer() {
    let set = [("settings.strategy", "census"), ("friction.angle", "30")];
    let run = run(&scene("hertz-cylinder-on-block", &set));
    let (_, failure) = run.failure.unwrap();
    assert!(
        matches!(failure, Failure::NotFound(NotFound::TooMany { nodes }) if nodes > 8),
        "{failure:?}"
    );
}

#[test]
fn a_cut_increment_grows_again_and_ends_where_the_whole_one_would_have() {
    let run = run(&scene("osc-snap", &[("settings.strategy", "ladder")]));
    assert!(run.failure.is_none());
    let loads: Vec<f64> = run.accepted.iter().map(|a| a.load).collect();
    let sizes: Vec<f64> = loads.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let smallest = sizes.iter().fold(f64::INFINITY, |m, s| m.min(*s));
    assert!(smallest < 0.3 && *sizes.last().unwrap() > 0.45, "{loads:?}");
    for k in 1..=12 {
        let whole = 0.5 * f64::from(k);
        assert!(loads.contains(&whole), "{whole} of {loads:?}");
    }
}

#[test]
fn a_loose_body_is_still_told_and_no_contact_without_force_holds_it() {
    let text = "(title: \"loose\", nodes: [Line(id: \"beam\", from: (0, 0), to: (1, 0), elements: 1, per_element: 2), \
        Line(id: \"floor\", from: (3, 0), to: (-3, 0), elements: 1, per_element: 2)], \
        materials: [Section(id: \"rod\", EA: 1, EI: 1)], bodies: [Beam(id: \"beam\", along: \"beam\", material: \"rod\")], \
        surfaces: [(id: \"floor\", along: \"floor\")], slaves: [(nodes: [\"beam.start\", \"beam.end\"], on: [\"floor\"], start: free)], \
        friction: (angle: 30), supports: [], loads: [Force(node: \"beam.end\", x: 1, y: 1)], \
        history: (path: [0, 1], increment: 1))";
    let scene = read(text);
    let run = run(&scene);
    let (_, failure) = run.failure.unwrap();
    assert!(
        matches!(failure, Failure::Singular(Singular::Rigid { .. })),
        "{failure:?}"
    );
}

#[test]
fn a_mode_that_the_user_holds_is_left_to_the_user() {
    let set = [("settings.strategy", "ladder")];
    let mut stepper = Stepper::new(Arc::new(scene("osc-touch2", &set).model));
    force_in(&mut stepper, 0, Mode::Fixed, true);
    while let Some(event) = stepper.step() {
        assert!(!matches!(event.outcome, Outcome::StrategyChange { .. }));
        assert_eq!(event.nodes[0].decision.before, Mode::Fixed);
    }
}

/// A run to its end; the displacements there.
fn finished(name: &str, strategy: &str) -> Option<Vec<f64>> {
    let run = run(&scene(name, &[("settings.strategy", strategy)]));
    let ends = run.stepper.state().status == Status::Finished;
    ends.then(|| run.stepper.state().u.to_vec())
}

#[test]
fn newtons_line_search_finishes_scenes_in_which_full_steps_cycle() {
    let found = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/findings/");
    for name in [
        format!("{found}4-creep-after-overhang.ron"),
        format!("{found}overlap-pushed-out.ron"),
    ] {
        let ladder = finished(&name, "ladder").unwrap_or_else(|| panic!("{name}: ladder"));
        let newton = finished(&name, "newton").unwrap_or_else(|| panic!("{name}: newton"));
        let largest = ladder.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
        for (a, b) in ladder.iter().zip(&newton) {
            assert!((a - b).abs() <= 1e-8 * largest, "{name}: {a} {b}");
        }
    }
}

#[test]
fn the_natural_map_vanishes_where_coulombs_law_holds_and_nowhere_else() {
    use stickslip::interface::line_search::natural_map;
    let friction = Friction {
        angle: 45.0,
        ..Friction::default()
    };
    // F_n, F_t, gap, slip.
    let holds = [
        [0.0, 0.0, 0.3, 0.1],
        [2.0, 1.5, 0.0, 0.0],
        [2.0, 2.0, 0.0, 0.4],
        [2.0, -2.0, 0.0, -0.4],
    ];
    let breaks = [
        [0.0, 0.0, -0.3, 0.0],
        [-1.0, 0.0, 0.0, 0.0],
        [2.0, 2.5, 0.0, 0.0],
        [2.0, 2.0, 0.0, -0.4],
        [2.0, 1.0, 0.0, 0.4],
        [1.0, 0.0, 0.2, 0.0],
    ];
    for spring in [0.1, 1.0, 30.0] {
        for at in holds {
            assert!(natural_map(at, &friction, spring) < 1e-20, "{at:?}");
        }
        for at in breaks {
            assert!(natural_map(at, &friction, spring) > 1e-4, "{at:?}");
        }
    }
}

#[test]
fn a_line_search_halves_a_step_until_the_error_falls() {
    use stickslip::interface::kinematics::NodeIncrement;
    use stickslip::interface::line_search::LineSearch;
    use stickslip::interface::minor_history::Cycle;
    let at = |f_n: f64| NodeIncrement {
        force: [f_n, 0.0],
        motion: [0.0, -f_n],
    };
    let error = |points: &[NodeIncrement]| {
        points
            .iter()
            .map(|p| (p.force[0] - 0.2).powi(2))
            .sum::<f64>()
    };
    let mut line = LineSearch::new(Cycle {
        start: 1,
        period: 2,
        members: Vec::new(),
    });
    assert_eq!(line.step(vec![at(0.0)], error), 1.0);
    assert_eq!(line.step(vec![at(1.0)], error), 0.25);
    assert_eq!(line.at(0), at(0.25));
    // No part of a step away from the solution reduces the error, so it is full.
    assert_eq!(line.step(vec![at(3.0)], error), 1.0);
    assert_eq!(line.at(0), at(3.0));
}
