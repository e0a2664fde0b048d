//! Planted cycles: interface problems whose minor iterations are known beforehand, or are told by the iterations
//! themselves; what finder, diagnosis and census say of them.

use crate::common::{examined, read, run};
use std::sync::Arc;
use std::time::Instant;
use stickslip::contact::record::ContactRecord;
use stickslip::explain::diagnosis::{Cause, Diagnosis, cycling, words};
use stickslip::format::condensed::{Contact, Matrix, Problem};
use stickslip::format::spec::History;
use stickslip::interface::census::census;
use stickslip::interface::minor_history::Cycle;
use stickslip::interface::problem::{Answer, AssumedMode, InterfaceProblem};
use stickslip::interface::trials::Trials;
use stickslip::model::Mode;
use stickslip::model::{Friction, InitialState, Settings, Strategy, Touch};

use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::step::event::{Failure, Outcome};
use stickslip::step::stepper::Stepper;

/// Smooth contacts with u_n = M f_n, u_t = f_t, and these gaps; those of `touching` start in touch.
fn smooth(m: &[Vec<f64>], gaps: &[f64], touching: &[usize]) -> Scene {
    let n = gaps.len();
    let entry = |i: usize, j: usize| match (i % 2, j % 2) {
        (0, 0) => m[i / 2][j / 2],
        _ => f64::from(u8::from(i == j)),
    };
    let rows = (0..2 * n).map(|i| (0..2 * n).map(|j| entry(i, j)).collect());
    let contact = |k: usize| Contact {
        id: format!("c{}", k + 1),
        gap: gaps[k],
        friction: Friction::default(),
        load: [0.0; 2],
        start: if touching.contains(&k) {
            Mode::Sliding
        } else {
            Mode::Free
        },
        state: InitialState::default(),
    };
    let problem = Problem {
        tangents: 1,
        title: "planted".into(),
        about: String::new(),
        contacts: (0..n).map(contact).collect(),
        matrix: Matrix::Compliance(rows.collect()),
        free: Vec::new(),
        spacing: Some(1.0),
        history: History::default(),
        settings: by_table_2(),
    };
    read(&problem.text(&[]))
}

/// Each contact pushes the next one twice as far as itself: alone in touch, at a gap of 1, contact k would have to pull with
/// 1, and lets the next one in by 1. So touch goes round, a contact a minor iteration.
fn ring(contacts: usize) -> Vec<Vec<f64>> {
    let push = |i: usize, j: usize| {
        f64::from(u8::from(i == j)) + if i == (j + 1) % contacts { 2.0 } else { 0.0 }
    };
    (0..contacts)
        .map(|i| (0..contacts).map(|j| push(i, j)).collect())
        .collect()
}

/// What cycles: the default strategy would get out.
fn by_table_2() -> Settings {
    Settings {
        strategy: Strategy::Table2,
        touch: Touch::Ratio,
        ..Settings::default()
    }
}

fn cycle_of(scene: &Scene) -> Cycle {
    match run(scene).failure {
        Some((_, Failure::Cycle(cycle))) => cycle,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_touch_that_goes_round_is_a_cycle_of_as_many_iterations_as_there_are_contacts() {
    for contacts in 2..=12 {
        let cycle = cycle_of(&smooth(&ring(contacts), &vec![1.0; contacts], &[0]));
        assert_eq!((cycle.start, cycle.period as usize), (1, contacts));
        assert_eq!(cycle.members.len(), contacts);
        for (slave, modes) in &cycle.members {
            for (k, mode) in modes.iter().enumerate() {
                let touches = k == *slave;
                assert_eq!(
                    *mode == Mode::Sliding,
                    touches,
                    "{contacts}: {slave} at {k}"
                );
            }
        }
    }
}

#[test]
fn a_cycle_is_told_by_its_shortest_period_and_from_where_it_starts() {
    // Two touches at once, half a round apart: the round is half as long.
    for (contacts, period) in [(4, 2), (6, 3), (10, 5)] {
        let cycle = cycle_of(&smooth(
            &ring(contacts),
            &vec![1.0; contacts],
            &[0, contacts / 2],
        ));
        assert_eq!((cycle.start, cycle.period), (1, period));
        assert_eq!(cycle.members.len(), contacts);
    }
    // Neighbours in touch: the first presses the second off its gap, opens, and the second goes on alone.
    for contacts in 3..=7 {
        let cycle = cycle_of(&smooth(&ring(contacts), &vec![1.0; contacts], &[0, 1]));
        assert_eq!((cycle.start, cycle.period as usize), (2, contacts));
    }
    // Nobody in touch: that is the answer.
    let still = run(&smooth(&ring(5), &[1.0; 5], &[]));
    assert!(
        still.failure.is_none() && still.steps <= 2,
        "{:?}",
        still.failure
    );
}

#[test]
fn who_takes_no_part_is_no_member() {
    // A sixth contact is pressed in all the time, and a seventh never.
    let mut m = ring(5);
    m.iter_mut().for_each(|row| row.extend([0.0, 0.0]));
    for k in 5..7 {
        let mut row = vec![0.0; 7];
        row[k] = 1.0;
        m.push(row);
    }
    let cycle = cycle_of(&smooth(&m, &[1.0, 1.0, 1.0, 1.0, 1.0, -1.0, 1.0], &[0, 5]));
    let members: Vec<usize> = cycle.members.iter().map(|m| m.0).collect();
    assert_eq!((cycle.period, members), (5, vec![0, 1, 2, 3, 4]));
}

/// Random stiffnesses, among 10,000 of which some cycle for long: angle of friction, stiffness, gaps and loads, and the
/// cycle's start and period.
const ROUGH: [(&str, u32, u32); 3] = [
    (
        "Contacts(title: \"late\", settings: (strategy: table2, touch: ratio), spacing: 1.0, contacts: [
            (id: \"a\", gap: 0.23, friction: (angle: 38.7), load: (-0.59, -0.77)),
            (id: \"b\", gap: 0.19, friction: (angle: 38.7), load: (0.27, -0.95)),
        ], matrix: Stiffness([
            [2.72, -1.32, 0.38, 0.58], [-1.32, 1.56, -0.9, -1.26], [0.38, -0.9, 1.69, -0.26], [0.58, -1.26, -0.26, 2.64],
        ]))",
        6,
        12,
    ),
    (
        "Contacts(title: \"lagging\", settings: (strategy: table2, touch: ratio), spacing: 1.0, contacts: [
            (id: \"a\", gap: 0.08, friction: (angle: 26.6), load: (-0.69, 0.85)),
            (id: \"b\", gap: 0.09, friction: (angle: 26.6), load: (-0.5, -0.34)),
        ], matrix: Stiffness([
            [2.06, 0.34, 0.17, -0.06], [0.34, 1.6, -0.5, 0.69], [0.17, -0.5, 1.08, -0.34], [-0.06, 0.69, -0.34, 0.39],
        ]))",
        2,
        14,
    ),
    (
        "Contacts(title: \"to and fro\", settings: (strategy: table2, touch: ratio), spacing: 1.0, contacts: [
            (id: \"a\", gap: 0.22, friction: (angle: 26.6), load: (0.14, 0.28)),
            (id: \"b\", gap: 0.19, friction: (angle: 26.6), load: (0.76, -0.95)),
        ], matrix: Stiffness([
            [1.02, 0.66, 1.03, 0.38], [0.66, 1.1, 0.92, 0.98], [1.03, 0.92, 1.83, 0.2], [0.38, 0.98, 0.2, 1.83],
        ]))",
        1,
        22,
    ),
];

/// The finder against the iterations themselves, gone on with for four rounds: what is found is where they first repeat,
/// modes and T_max, and how soon.
#[test]
fn rough_contacts_cycle_from_where_and_as_long_as_their_iterations_say() {
    for (text, start, period) in ROUGH {
        let scene = Scene::from_text("rough", text, &[]).unwrap();
        let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
        let (mut inputs, mut found) = (Vec::new(), None);
        for _ in 0..start + 5 * period {
            let event = stepper.step().unwrap();
            let input = |node: &ContactRecord| match node.decision.before {
                Mode::Sliding => (Mode::Sliding, node.t_max_used),
                mode => (mode, 0.0),
            };
            inputs.push(event.nodes.iter().map(input).collect::<Vec<_>>());
            if let (Outcome::Failed(Failure::Cycle(cycle)), None) = (&event.outcome, &found) {
                found = Some(cycle.clone());
            }
        }
        let found = found.expect("a cycle");
        assert_eq!((found.start, found.period), (start, period), "{text}");
        let same = |a: usize, b: usize| {
            let mut pairs = inputs[a].iter().zip(&inputs[b]);
            pairs.all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-9)
        };
        let (start, period) = (start as usize - 1, period as usize);
        let repeats = |from: usize, by: usize| (from..inputs.len() - by).all(|k| same(k, k + by));
        assert!(repeats(start, period));
        assert!((1..period).all(|shorter| !repeats(start, shorter)));
        assert!(start == 0 || !repeats(start - 1, period));
        for (slave, modes) in &found.members {
            let seen: Vec<Mode> = (start..start + period)
                .map(|k| inputs[k][*slave].0)
                .collect();
            assert_eq!(*modes, seen);
        }
    }
}

/// Three contacts that press each other off: with the first one alone in touch both others sink in, with all in touch both
/// are pulled. Either of the others can carry alone, or both.
const THREE: &str = "Contacts(
    title: \"three answers\",
    settings: (strategy: table2, touch: ratio),
    contacts: [(id: \"c1\", gap: -1.0), (id: \"c2\", gap: -4.0), (id: \"c3\", gap: -4.0)],
    matrix: Compliance([
        [1.0, 0.0, 3.0, 0.0, 3.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        [3.0, 0.0, 1.0, 0.0, 3.0, 0.0],
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        [3.0, 0.0, 3.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    ]),
)";

#[test]
fn several_consistent_states_are_listed_with_how_they_differ() {
    let mut stuck = run(&Scene::from_text("three", THREE, &[]).unwrap());
    let Some((_, Failure::Cycle(cycle))) = &stuck.failure else {
        panic!("{:?}", stuck.failure)
    };
    assert_eq!((cycle.period, cycle.members.len()), (2, 2));
    let problem = stuck.stepper.interface_problem().unwrap();
    let diagnosis = Diagnosis::find(&problem, &|| false).unwrap();
    // With the first one in touch, as it stays in the cycle, nothing is consistent.
    assert_eq!(diagnosis.cause, Cause::Several);
    let census = diagnosis.census.as_ref().unwrap();
    let states: Vec<String> = census.answers.iter().map(|a| a.answer.letters()).collect();
    assert_eq!(states, ["F+F", "FF+", "F++"]);
    let lines = words(stuck.stepper.model(), &problem, &diagnosis);
    let has = |text: &str| {
        assert!(
            lines.iter().any(|l| l.text.contains(text)),
            "{text}: {lines:#?}"
        )
    };
    has("3 combinations of modes of c1, c2 and c3 are consistent");
    has("how they differ:");
    has("c2: sliding with F_t > 0 in 1, F_n 4, F_t 0, slip ");
    assert!(
        !lines
            .iter()
            .any(|l| l.text.trim_start().starts_with("c1: ")),
        "{lines:#?}"
    );
}

#[test]
fn the_debugger_shows_several_states_and_goes_to_any() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("three.ron");
    std::fs::write(&file, THREE).unwrap();
    let name = file.to_str().unwrap();
    for (width, height) in [(80, 24), (120, 40), (200, 60)] {
        let screen = stickslip::tui::screen(name, "c d", width, height).unwrap();
        let states = ["state 1: c1", "state 2: c1", "state 3: "];
        let shown = if height == 24 {
            &states[..0]
        } else {
            &states[..]
        };
        for text in [&["3 combinations of modes of", "▸1"], shown].concat() {
            assert!(
                screen.contains(text),
                "{text} at {width}x{height}:\n{screen}"
            );
        }
    }
    // Two remedies that change the scene come first.
    for (number, keys) in [
        (1, "c d Down Down Enter c"),
        (2, "c d Down Down Down Enter c"),
        (3, "c d Down Down Down Down Enter c"),
    ] {
        let screen = stickslip::tui::screen(name, keys, 100, 30).unwrap();
        assert!(screen.contains("load 1 accepted"), "{number}:\n{screen}");
    }
}

/// Random numbers in [0, 1) that are the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 31)
    }
}

/// A random rough interface problem.
fn random(n: usize, random: &mut Random) -> InterfaceProblem {
    let size = 2 * n;
    let l: Vec<f64> = (0..size * size)
        .map(|_| 2.0 * random.next() - 1.0)
        .collect();
    let entry = |i: usize, j: usize| {
        let sum: f64 = (0..size).map(|k| l[i * size + k] * l[j * size + k]).sum();
        sum + if i == j { 0.1 } else { 0.0 }
    };
    let contact = |k: usize, random: &mut Random| Contact {
        id: format!("c{k}"),
        gap: 0.3 * random.next(),
        friction: Friction {
            angle: 40.0 * random.next(),
            cohesion: if k == 1 { 0.1 } else { 0.0 },
        },
        load: [-random.next(), 2.0 * random.next() - 1.0],
        start: Mode::Free,
        state: InitialState::default(),
    };
    let problem = Problem {
        tangents: 1,
        title: "random".into(),
        about: String::new(),
        contacts: (0..n).map(|k| contact(k, random)).collect(),
        matrix: Matrix::Stiffness(
            (0..size)
                .map(|i| (0..size).map(|j| entry(i, j)).collect())
                .collect(),
        ),
        free: Vec::new(),
        spacing: None,
        history: History::default(),
        settings: by_table_2(),
    };
    let scene = Scene::from_spec("random", problem.spec()).unwrap();
    Stepper::new(Arc::new(scene.model))
        .interface_problem()
        .unwrap()
}

/// The consistent assumptions one by one, each solved by itself.
fn one_by_one(problem: &InterfaceProblem) -> (usize, Vec<Answer>) {
    const ALL: [AssumedMode; 4] = [
        AssumedMode::Free,
        AssumedMode::Fixed,
        AssumedMode::Plus,
        AssumedMode::Minus,
    ];
    let n = problem.nodes.len();
    let mut trials = Trials::new(problem).unwrap();
    let (mut singular, mut found) = (0, Vec::new());
    for number in 0..4_usize.pow(n as u32) {
        let assumed: Vec<AssumedMode> = (0..n)
            .map(|k| ALL[number / 4_usize.pow(k as u32) % 4])
            .collect();
        match trials.answer(&assumed) {
            None => singular += 1,
            Some(answer) if answer.obeys(1e-9) => found.push(answer),
            Some(_) => {}
        }
    }
    (singular, found)
}

#[test]
fn the_census_finds_what_solving_each_assumption_by_itself_finds() {
    let mut numbers = Random(7);
    let mut several = 0;
    for k in 0..60 {
        let problem = random(1 + k % 5, &mut numbers);
        let (singular, wanted) = one_by_one(&problem);
        let found = census(&problem).unwrap();
        assert_eq!(found.tried, 4_usize.pow(problem.nodes.len() as u32));
        assert_eq!(found.singular, singular);
        let letters: Vec<String> = found.answers.iter().map(|a| a.answer.letters()).collect();
        let ties: usize = found.answers.iter().map(|a| a.ties.len()).sum();
        assert_eq!(letters.len() + ties, wanted.len(), "{letters:?}");
        for answer in &found.answers {
            let same = wanted
                .iter()
                .find(|w| w.letters() == answer.answer.letters())
                .expect("the same");
            for (a, b) in answer.answer.nodes.iter().zip(&same.nodes) {
                assert!(
                    (a.f_n - b.f_n).abs() < 1e-9 * problem.force
                        && (a.gap - b.gap).abs() < 1e-9 * problem.length
                );
            }
        }
        assert_eq!(found.nearest.is_none(), !wanted.is_empty());
        several += usize::from(letters.len() > 1);
    }
    println!("{several} of 60 have several answers");
}

#[test]
fn a_census_of_eight_nodes_tries_65_536_assumptions() {
    let problem = random(8, &mut Random(3));
    let begin = Instant::now();
    let found = census(&problem).unwrap();
    let all = begin.elapsed();
    println!("{all:?}");
    assert_eq!(found.tried, 65_536);
    assert!(!found.answers.is_empty());
    for answer in &found.answers {
        assert!(answer.answer.obeys(1e-9));
    }
}

/// A ring of five among 300 contacts: the diagnosis looks at the five.
#[test]
fn a_cycle_among_hundreds_of_nodes_is_diagnosed_by_those_that_take_part() {
    let n = 300;
    let mut m = vec![vec![0.0; n]; n];
    let ring = ring(5);
    for (i, row) in m.iter_mut().enumerate() {
        row[i] = 1.0;
        if i < 5 {
            row[..5].copy_from_slice(&ring[i]);
        }
        // The ring feels those in touch beyond it.
        if i < 5 {
            row[10] = 0.25;
        }
    }
    let mut gaps = vec![1.0; n];
    gaps[10] = -1.0;
    let scene = smooth(&m, &gaps, &[0, 10]);
    let mut stuck = run(&scene);
    let Some((_, Failure::Cycle(cycle))) = &stuck.failure else {
        panic!("{:?}", stuck.failure)
    };
    assert_eq!((cycle.period, cycle.members.len()), (5, 5));
    let begin = Instant::now();
    let problem = cycling(stuck.stepper.interface_problem().unwrap(), cycle).unwrap();
    assert_eq!(problem.nodes.len(), 5);
    let diagnosis = Diagnosis::find(&problem, &|| false).unwrap();
    println!("diagnosed in {:?}", begin.elapsed());
    assert_eq!(
        (
            diagnosis.cycle.period,
            diagnosis.core.as_ref().unwrap().places.len()
        ),
        (5, 5)
    );
    let states: Vec<String> = diagnosis
        .census
        .as_ref()
        .unwrap()
        .answers
        .iter()
        .map(|a| a.answer.letters())
        .collect();
    assert_eq!(states, ["FFFFF"]);
    // The same in the debugger, from before the cycle, where nothing of it is known yet.
    let mut session = Session::new(scene);
    let finding = examined(&mut session, vec![]);
    assert!(finding.found.fails, "{:?}", finding.lines());
    assert!(
        finding.what.contains("c1, c2, c3, c4 and c5"),
        "{:?}",
        finding.lines()
    );
    // And of chosen nodes, none of which is in the ring.
    let finding = examined(&mut session, vec![10, 11]);
    let census = finding.found.census.as_ref().unwrap();
    assert_eq!((census.tried, census.answers.len()), (4, 1));
    assert_eq!(census.answers[0].answer.letters(), "+F");
    assert!(
        finding
            .what
            .starts_with("For c11, c12, with all other nodes"),
        "{:?}",
        finding.lines()
    );
    // Its start is taken for these nodes alone, and the minor iterations go on.
    let starts = finding.found.starts(0).unwrap();
    assert_eq!(starts.iter().map(|s| s.slave).collect::<Vec<_>>(), [10, 11]);
}
