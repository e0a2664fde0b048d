//! Every way in which an increment can fail has its page: what happened, where, why, what was tried, what to do.

use std::sync::Arc;
use stickslip::contact::laws::{Finding, JudgedLaw, JudgedNumbers};
use stickslip::explain::page::{DiagnosisPage, page};
use stickslip::explain::try_list::{TryLine, TryOutcome};
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::step::event::Failure;
use stickslip::step::state::Status;
use stickslip::step::stepper::Stepper;
use stickslip::tui::Debugger;
use stickslip::tui::theme::Theme;

/// A scene of tests/failures, or a built-in one, that fails; what is set in it; and whether a failure is the one meant.
struct Case {
    name: &'static str,
    scene: &'static str,
    set: &'static [(&'static str, &'static str)],
    is_meant: fn(&Failure) -> bool,
}

const CASES: [Case; 14] = [
    Case {
        name: "cycle",
        scene: "osc-inclined-cantilever",
        set: &[],
        is_meant: |failure| matches!(failure, Failure::Cycle(_)),
    },
    Case {
        name: "minor-limit",
        scene: "osc-slowlag",
        set: &[("settings.minors", "20")],
        is_meant: |failure| matches!(failure, Failure::MinorLimit { .. }),
    },
    Case {
        name: "major-cycle",
        scene: "punch-sharp-edge",
        set: &[
            ("friction.angle", "5"),
            ("history.increment", "0.5"),
            ("settings.factor", "each"),
            ("settings.majors", "100"),
            ("settings.strategy", "table2"),
        ],
        is_meant: |failure| matches!(failure, Failure::MajorCycle(_)),
    },
    Case {
        name: "major-limit",
        scene: "osc-p5-slow",
        set: &[],
        is_meant: |failure| matches!(failure, Failure::MajorLimit { .. }),
    },
    Case {
        name: "loose",
        scene: "nothing-holds",
        set: &[],
        is_meant: |failure| matches!(failure, Failure::Singular(_)),
    },
    Case {
        name: "singular",
        scene: "singular",
        set: &[],
        is_meant: |failure| matches!(failure, Failure::Singular(_)),
    },
    Case {
        name: "diverged",
        scene: "osc-snap",
        // Whatever the round-off, the first solve leads beyond all bounds.
        set: &[("history.path[1]", "1e6"), ("history.increment", "1e6")],
        is_meant: |failure| matches!(failure, Failure::Diverged { .. }),
    },
    Case {
        name: "no-answer",
        scene: "osc-coh-none",
        set: &[("settings.strategy", "ladder")],
        is_meant: |failure| matches!(failure, Failure::NoAnswer { .. }),
    },
    Case {
        name: "ladder-ended",
        scene: "avoidable-848",
        set: &[("settings.search", "off")],
        is_meant: |failure| matches!(failure, Failure::LadderEnded { .. }),
    },
    Case {
        name: "not-found",
        scene: "singular",
        set: &[("settings.strategy", "lemke")],
        is_meant: |failure| matches!(failure, Failure::NotFound(_)),
    },
    Case {
        name: "leapt",
        scene: "block-over-its-edge",
        set: &[("history.jumps", "stop")],
        is_meant: |failure| matches!(failure, Failure::BranchJump { .. }),
    },
    Case {
        name: "round-off",
        scene: "wrong-EA1e16",
        set: &[],
        is_meant: |failure| matches!(failure, Failure::RoundOff { .. }),
    },
    Case {
        name: "inverted",
        scene: "minimal-collapse",
        set: &[],
        is_meant: |failure| matches!(failure, Failure::Inverted(_)),
    },
    Case {
        name: "over-constrained",
        scene: "held-inside",
        set: &[],
        is_meant: |failure| matches!(failure, Failure::OverConstrained { .. }),
    },
];

fn open(case: &Case) -> Session {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/failures/").to_owned();
    let file = format!("{file}{}.ron", case.scene);
    let set: Vec<(String, String)> = case
        .set
        .iter()
        .map(|(path, value)| ((*path).to_owned(), (*value).to_owned()))
        .collect();
    let name = match std::path::Path::new(&file).exists() {
        true => file.as_str(),
        false => case.scene,
    };
    let mut scene = Scene::open(name, &set).unwrap();
    scene.name = case.scene.to_owned();
    Session::new(scene)
}

/// The debugger at the failure, with its page open and made.
fn at_failure(case: &Case) -> Debugger {
    let mut debugger = Debugger::new(Theme::colour(), vec![], Some(open(case)));
    debugger.type_keys("c d");
    debugger
}

fn found(debugger: &Debugger) -> DiagnosisPage {
    let session = debugger.session.as_ref().unwrap();
    let found = session.background().examination(session.timeline().place());
    found.flatten().expect("the page is made").clone()
}

#[test]
fn every_way_to_fail_has_a_page_that_says_what_why_and_what_was_tried() {
    for case in &CASES {
        let debugger = at_failure(case);
        let session = debugger.session.as_ref().unwrap();
        let Status::Failed(failure) = session.frame().state.status.clone() else {
            panic!("{}: it does not fail", case.name);
        };
        assert!((case.is_meant)(&failure), "{}: {failure:?}", case.name);
        let found = found(&debugger);
        assert!(found.what.starts_with("increment "), "{}", case.name);
        assert!(!found.why.is_empty(), "{}: {:#?}", case.name, found.lines());
        assert!(
            !found.tries.is_empty(),
            "{}: {:#?}",
            case.name,
            found.lines()
        );
        for line in &found.tries {
            let is_tried = line.end.starts_with("tried");
            let outcome = line.outcome != TryOutcome::Untried;
            assert_eq!(is_tried, outcome, "{}: {}", case.name, line.words());
        }
        for (width, height) in [(80, 24), (120, 40), (200, 60)] {
            let name = format!("{}-{width}x{height}", case.name);
            insta::assert_snapshot!(name, debugger.text(width, height));
        }
    }
}

#[test]
fn a_state_that_the_judge_refuses_has_a_page_with_the_law_the_node_and_what_is_allowed() {
    // No scene is known that ends so, so one that ends otherwise is said to.
    let case = &CASES[3];
    let debugger = at_failure(case);
    let session = debugger.session.as_ref().unwrap();
    let mut state = session.frame().state.clone();
    let why = Finding {
        law: JudgedLaw::Cone,
        slave: Some(0),
        amount: 1e-3,
        allowed: 1e-9,
        numbers: JudgedNumbers {
            deviation: None,
            gap: 0.0,
            f_n: 2.0,
            f_t: 0.7,
            limit: 0.5,
            slip: 0.01,
        },
    };
    state.status = Status::Failed(Failure::Refused(why));
    let mut stepper = Stepper::new(Arc::new(session.model().clone()));
    let spec = Some(&session.scene().spec);
    let found = page(
        &mut stepper,
        &state,
        spec,
        Vec::new(),
        &|| false,
        &mut |_| {},
    )
    .unwrap();
    let told = found.lines().join("\n");
    let name = &session.model().nodes[session.model().contacts[0].node].name;
    for part in [
        "cone",
        name.as_str(),
        "F_t 0.7 (limit 0.5)",
        "limit 1e-9",
        "Try 1: ✓ ",
        "a finer mesh: --set refine=2",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
    assert_eq!(found.found.nodes, [0]);
}

#[test]
fn an_inverted_element_is_named_first_and_marked_in_the_shape() {
    let case = CASES.iter().find(|case| case.name == "inverted").unwrap();
    let mut debugger = at_failure(case);
    let why = &found(&debugger).why[0];
    for part in ["element 14 of g", "stretch", "law: svk"] {
        assert!(why.contains(part), "{why}");
    }
    debugger.type_keys("Esc");
    let screen = debugger.text(120, 40);
    assert!(screen.matches('◆').count() == 2, "{screen}");
    assert!(screen.contains("element 14 of g"), "{screen}");
}

#[test]
fn the_two_scenes_of_a_stranger_are_cured_by_what_their_pages_say() {
    for name in ["loose", "major-cycle"] {
        let case = CASES.iter().find(|case| case.name == name).unwrap();
        let mut debugger = at_failure(case);
        let found = found(&debugger);
        let first = found.works().unwrap();
        // What the page says is typed, and nothing else.
        let command = first.typed.strip_prefix(':').unwrap();
        debugger.type_keys(":");
        debugger.type_text(command);
        debugger.type_keys("Enter c");
        // The strip comes loose once more where all of its load is gone again: then nothing can hold it.
        let frames = debugger.session.as_ref().unwrap().frames();
        let loads = frames.iter().map(|frame| frame.state.start.load_factor);
        assert_eq!(loads.fold(0.0, f64::max), 1.0, "{name}: {first:?}");
    }
}

/// Where friction is too small in every mode, the modes of the start make no difference.
#[test]
fn a_start_in_other_modes_is_no_advice_where_friction_is_too_small() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/findings/block-on-a-slope.ron"
    );
    let settings = [
        ("friction.angle", "10"),
        ("settings.initial_gaps", "adjust"),
    ];
    let settings = settings.map(|(path, value)| (path.to_owned(), value.to_owned()));
    let scene = Scene::open(file, &settings).unwrap();
    let mut debugger = Debugger::new(Theme::mono(), vec![], Some(Session::new(scene)));
    debugger.type_keys("c d");
    let found = found(&debugger);
    let why = &found.why[0];
    assert!(
        why.starts_with("friction is too small to hold body b"),
        "{why}"
    );
    let tries: Vec<String> = found.tries.iter().map(TryLine::words).collect();
    let has = |part: &str| tries.iter().any(|line| line.contains(part));
    assert!(has("a support against that motion"), "{tries:?}");
    assert!(!has("slave nodes that start"), "{tries:?}");
}

#[test]
fn a_ladder_that_reaches_the_load_beyond_the_budget_of_a_trial_is_no_failed_trial() {
    let settings = [("settings.strategy", "table2"), ("history.increment", "1")];
    let settings = settings.map(|(path, value)| (path.to_owned(), value.to_owned()));
    let scene = Scene::open("osc-border", &settings).unwrap();
    let mut debugger = Debugger::new(Theme::mono(), vec![], Some(Session::new(scene)));
    debugger.type_keys("c d");
    let found = found(&debugger);
    let is_ladder = |line: &&TryLine| line.typed == ":set settings.strategy ladder";
    let line = found.tries.iter().find(is_ladder).unwrap();
    assert_eq!(line.outcome, TryOutcome::Works, "{}", line.words());
    let trial = line.trial.as_ref().unwrap();
    assert!(
        trial.minors > 400 && trial.steps.len() > 400,
        "{}",
        line.words()
    );
    let why = &found.why[0];
    let minors = format!("settings.strategy=ladder, tried: {} minors)", trial.minors);
    assert!(
        why.contains("the ladder reaches it") && why.contains(&minors),
        "{why}"
    );
}
