//! Lessons: the built-in ones can be played through, right answers are the solver's, nothing is seen before it is
//! answered, and a lesson that is wrong is told where.

use crate::common;
use ratatui::layout::Rect;
use std::process::Command;
use std::sync::Arc;
use stickslip::action::{self, Action, Context, HiddenDecisions};
use stickslip::model::Mode;
use stickslip::session::Session;
use stickslip::teach::play::play;
use stickslip::teach::progress::Progress;
use stickslip::teach::question::AnswerKind;
use stickslip::teach::tutor::Paragraph;
use stickslip::teach::{self, Guess, Lesson, Tutor};
use stickslip::tui::Debugger;
use stickslip::tui::theme::Theme;

/// The debugger at the beginning of a built-in lesson.
fn taught(name: &str) -> Debugger {
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), None);
    debugger.teach(Lesson::open(name).unwrap(), None);
    debugger
}

fn tutor(debugger: &Debugger) -> &Tutor {
    debugger.app.learning.lesson.as_ref().unwrap()
}

/// A lesson on the oscillating scene with one step, in the file's second line.
fn lesson_of(step: &str) -> String {
    format!("(title: \"T\", scene: Name(\"osc-inclined-cantilever\"), steps: [\n    {step},\n])")
}

/// What is wrong with a lesson, when it is read or else when it is played.
fn fault(text: &str) -> String {
    match Lesson::from_text("test.ron", text) {
        Err(error) => error.to_string(),
        Ok(lesson) => play(&Arc::new(lesson)).unwrap_err().to_string(),
    }
}

#[test]
fn every_built_in_lesson_plays_through() {
    assert!(teach::list().len() >= 12);
    for builtin in teach::list() {
        let lesson = Lesson::open(builtin.name).unwrap_or_else(|e| panic!("{e}"));
        assert!(!lesson.about.is_empty());
        let answers = play(&Arc::new(lesson)).unwrap_or_else(|e| panic!("{e}"));
        assert!(answers.len() >= 3, "{}: {answers:?}", builtin.name);
    }
}

#[test]
fn what_the_lessons_teach_is_what_the_solver_does() {
    let answers = |name: &str| -> Vec<String> {
        let lesson = Lesson::open(name).unwrap();
        let answers = play(&Arc::new(lesson)).unwrap();
        answers
            .into_iter()
            .map(|answered| answered.answer)
            .collect()
    };
    assert_eq!(answers("modes"), ["free", "fixed", "sliding", "fixed"]);
    // By hand: 0.04 − 0.3/3; 0.3 − 3·0.04; 0.2·(1 − 0.4); 0.18 tan 30°.
    let by_hand = answers("by-hand");
    assert_eq!(by_hand[..4], ["-0.06", "fixed", "0.18", "0.12"]);
    assert_eq!(by_hand[5..], ["0.1039", "sliding"]);
    assert_eq!(answers("no-answer"), ["0", "free", "1"]);
    assert_eq!(
        answers("several-answers"),
        ["free", "fixed", "3", "sliding", "1"]
    );
    let slip = answers("slip");
    assert_eq!(slip[..3], ["sliding"; 3]);
    assert!(slip[3].starts_with("1 (Every law holds") && slip[4] == "fixed");
    assert!(slip[5].starts_with("2 (Slip"), "{slip:?}");
    let judge = answers("judge").join(" ");
    assert!(
        judge.contains("(Cone.)") && judge.contains("(Slip.)") && judge.contains("(Tension.)"),
        "{judge}"
    );
    let majors = answers("majors");
    assert_eq!([&majors[1], &majors[3]], ["23", "6"]);
}

#[test]
fn lessons_are_found_by_number_and_by_their_earlier_names() {
    assert_eq!(teach::find("4").unwrap().name, "by-hand");
    assert_eq!(teach::find("4-oscillation").unwrap().name, "oscillation");
    assert_eq!(teach::find("2-table-2.ron").unwrap().name, "table-2");
    for none in ["0", "99", "4-table", "oscillation-4"] {
        assert!(teach::find(none).is_none(), "{none}");
    }
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("lessons.ron");
    let done = "(steps: 12, of: 12, ended: 1, right: 4, asked: 5)";
    let text =
        format!("(format: 1, lessons: {{ \"4-oscillation\": {done}, \"my-4.ron\": {done} }})");
    std::fs::write(&file, text).unwrap();
    let progress = Progress::read(&file).unwrap();
    for name in ["oscillation", "my-4.ron"] {
        let reached = progress.of(name).unwrap();
        assert_eq!(reached.words(), "done, 4/5 right");
    }
}

#[test]
fn right_answers_follow_the_scene_and_stand_in_no_file() {
    let text = teach::find("by-hand").unwrap().text.to_owned();
    let rough = text.replace("friction: (angle: 30.0)", "friction: (angle: 40.0)");
    assert_ne!(text, rough);
    let rule = |text: &str| {
        let lesson = Lesson::from_text("test.ron", text).unwrap();
        play(&Arc::new(lesson)).unwrap()[4].answer.clone()
    };
    assert!(rule(&text).ends_with("|F_t| > |T_max|: sliding)"));
    assert!(rule(&rough).ends_with("|F_t| < |T_max|: fixed)"));
}

#[test]
fn a_wrong_answer_is_told_with_the_numbers_of_the_decision() {
    let mut debugger = taught("oscillation");
    debugger.type_keys("Space s");
    assert_eq!(
        tutor(&debugger).question().unwrap().kind(),
        AnswerKind::Mode
    );
    let last = |debugger: &Debugger| tutor(debugger).page().last().cloned().unwrap();
    debugger.type_keys("a s");
    let hint = "No. Look at row free of Table 2: g = -0.0065 < 0. On a rough floor only one mode follows when g < 0.";
    assert_eq!(last(&debugger), Paragraph::Wrong(hint.into()));
    debugger.type_keys("a f");
    let told = "No. It is fixed. g = -0.0065 < 0. Free → fixed: the node penetrates the surface.";
    assert_eq!(last(&debugger), Paragraph::Wrong(told.into()));
    assert_eq!(tutor(&debugger).score(), (0, 1));
    debugger.type_keys("Space a f");
    let Paragraph::Right(told) = last(&debugger) else {
        panic!("free follows fixed")
    };
    assert!(
        told.contains("F_n = -") && told.contains("the surface would have to pull"),
        "{told}"
    );
    assert_eq!(tutor(&debugger).score(), (1, 2));
}

#[test]
fn a_decision_that_is_asked_about_is_nowhere_on_the_screen() {
    for (width, height) in [(80, 24), (120, 40), (200, 60)] {
        let mut debugger = taught("oscillation");
        debugger.type_keys("Space s");
        let asked = debugger.text(width, height);
        assert!(
            asked.contains("free → ?") || asked.contains("f→?"),
            "{asked}"
        );
        for telling in ["free → fixed", "◀", "Free → fixed", "margin", "f→x"] {
            assert!(!asked.contains(telling), "{telling}:\n{asked}");
        }
        debugger.type_keys("a x");
        let answered = debugger.text(width, height);
        assert!(
            answered.contains("free → fixed") && answered.contains("✓ Right: fixed"),
            "{answered}"
        );
    }
}

/// The debugger at a step (from 1) of a built-in lesson, with all steps before it done right.
fn at_step(name: &str, step: usize) -> Debugger {
    let mut debugger = taught(name);
    let line = |debugger: &mut Debugger, line: &str| {
        debugger.type_keys(":");
        debugger.type_text(line);
        debugger.type_keys("Enter");
    };
    while tutor(&debugger).at() + 1 < step {
        let todo = tutor(&debugger).todo();
        let typed = todo
            .strip_prefix("type :")
            .and_then(|todo| todo.split_once(" and Enter"));
        let pressed = todo
            .strip_prefix("press ")
            .and_then(|todo| todo.split_once(' '));
        match (typed, pressed, tutor(&debugger).solution()) {
            (Some((typed, _)), ..) => line(&mut debugger, typed),
            (_, Some((keys, _)), _) => {
                let keys: Vec<String> = keys.chars().map(String::from).collect();
                debugger.type_keys(&keys.join(" "));
            }
            (.., Some(word)) => line(&mut debugger, &format!("answer {word}")),
            (None, None, None) => debugger.type_keys("Space"),
        }
    }
    debugger
}

#[test]
fn a_verdict_that_is_asked_about_is_nowhere_on_the_screen() {
    let asked = [
        ("slip", 10, "1", "load 0.05 accepted"),
        ("slip", 17, "2", "but beam.5 slipped"),
        ("judge", 4, "1", "load 0.5 accepted"),
        ("judge", 7, "3", "exceeds the friction limit"),
        ("judge", 13, "1", "friction drives the slip"),
        ("judge", 17, "2", "exceeds the friction limit"),
    ];
    for (name, step, right, told) in asked {
        let mut debugger = at_step(name, step);
        assert_eq!(tutor(&debugger).solution().as_deref(), Some(right));
        for (width, height) in [(80, 24), (120, 40), (200, 60)] {
            let screen = debugger.text(width, height);
            for telling in ["accepted, but", "✓ ", "judge ✗", "judge ✓", told] {
                assert!(
                    !screen.contains(telling),
                    "{name} {step}: {telling}\n{screen}"
                );
            }
            assert!(screen.contains("Predict the judge's verdict"), "{screen}");
        }
        debugger.type_keys(&format!("a {right}"));
        let screen = debugger.text(200, 60);
        assert!(screen.contains(told), "{name} {step}: {told}\n{screen}");
    }
}

/// What the check of a built-in lesson prints of a step (from 1): the replies to the right answer and to a wrong one.
fn replies(name: &str, step: usize) -> (String, String) {
    let answers = play(&Arc::new(Lesson::open(name).unwrap())).unwrap();
    let found = answers.into_iter().find(|found| found.step + 1 == step);
    found.map(|found| (found.then, found.hint)).unwrap()
}

#[test]
fn hints_have_the_numbers_of_the_shown_iteration_and_not_the_answer() {
    // The residual that is shown, and not the next one.
    let (then, hint) = replies("majors", 7);
    assert_eq!(hint, "No. 7.57e-8 times 0.37.");
    assert!(then.starts_with("Right: 2.77e-8."), "{then}");
    // Of a decision that is still to come not even the numbers are shown.
    for (name, step) in [
        ("modes", 12),
        ("oscillation", 4),
        ("increment", 3),
        ("increment", 8),
        ("two-sides", 12),
    ] {
        let (then, hint) = replies(name, step);
        assert!(
            !hint.contains("Table 2") && hint.len() > 20,
            "{name} {step}: {hint}"
        );
        assert!(then.starts_with("Right: "), "{then}");
    }
    let (_, hint) = replies("t-max", 4);
    assert!(
        !hint.contains("0.2588") && !hint.contains("0.3312"),
        "{hint}"
    );
    let (_, hint) = replies("increment", 3);
    assert!(
        hint.ends_with("by as much as the load falls: by 0.05."),
        "{hint}"
    );
}

#[test]
fn the_force_of_a_stuck_foot_grows_as_the_hint_of_lesson_5_says() {
    let scene = common::scene(
        "01-pinned-beam-rough-floor",
        &[("history.increment", "0.05")],
    );
    let run = common::run(&scene);
    let stuck: Vec<_> = run.accepted[6..8]
        .iter()
        .map(|a| a.state.nodes[0])
        .collect();
    assert!(stuck.iter().all(|node| node.mode == Mode::Fixed));
    assert!((stuck[1].f_t - stuck[0].f_t - 0.05).abs() < 1e-9);
    assert!((stuck[1].t_max - stuck[0].t_max).abs() < 1e-9);
}

#[test]
fn hints_that_look_ahead_or_contain_the_answer_are_refused() {
    let hint = |answer: &str, hint: &str| {
        let ask = format!(r#"Ask(text: "x", answer: {answer}, hint: "{hint}")"#);
        Lesson::from_text("test.ron", &lesson_of(&ask)).map_err(|error| error.to_string())
    };
    let mode = r#"Mode(node: "beam.end")"#;
    for looks in [
        "right",
        "next beam.end",
        "reason beam.end",
        "lag beam.end",
        "minors",
        "majors",
        "period",
        "answers",
        "verdict",
    ] {
        let told = hint(mode, &format!("{{{looks}}}")).unwrap_err();
        assert!(
            told.contains("steps[0].hint: the hint contains the answer or looks ahead"),
            "{told}"
        );
    }
    let number = r#"Number(of: "gap beam.end", tolerance: 0.1)"#;
    assert!(hint(number, "{gap beam.end}").is_err());
    assert!(hint(number, "{F_n beam.end} {mode beam.end} {increment}").is_ok());
    // A number of the shown iteration is no answer about a later one.
    let later = r#"Number(of: "gap beam.end", tolerance: 0.1), ahead: 1"#;
    assert!(hint(later, "{gap beam.end}").is_ok());
}

#[test]
fn predictions_end_with_the_history_however_few_were_right() {
    let mut debugger = at_step("table-2", 14);
    let last = |debugger: &Debugger| tutor(debugger).page().last().cloned().unwrap();
    for _ in 0..200 {
        debugger.type_keys("f");
        // Never what happens: there is no third mode that a decision of this lesson could lead to.
        let frame = debugger.session.as_ref().unwrap().frame();
        let next = frame.event.as_ref().unwrap().nodes[0].decision.next;
        debugger.type_keys(if next == Mode::Free { "a x" } else { "a f" });
        if tutor(&debugger).is_read() {
            break;
        }
    }
    let Paragraph::Wrong(told) = last(&debugger) else {
        panic!("{:?}", last(&debugger))
    };
    assert!(
        told.ends_with("(0 of 3) The history ends here, so there are no more predictions."),
        "{told}"
    );
    debugger.type_keys("Space");
    assert!(tutor(&debugger).step().is_none());
}

#[test]
fn a_lesson_waits_for_what_it_wants_and_lets_one_look_around() {
    let mut debugger = taught("oscillation");
    debugger.type_keys("s");
    assert!(
        debugger
            .text(120, 40)
            .contains("the lesson waits: Space continues")
    );
    debugger.type_keys("Space c");
    assert!(
        debugger
            .text(120, 40)
            .contains("the lesson waits: press s (step)")
    );
    assert_eq!(debugger.session.as_ref().unwrap().frames().len(), 1);
    debugger.type_keys("Space");
    assert_eq!(tutor(&debugger).at(), 1);
    debugger.type_keys("Tab z z + 0 t e e s");
    assert_eq!(tutor(&debugger).at(), 2);
    // A repeated motion is a motion, too.
    debugger.type_keys("Enter");
    assert_eq!(debugger.session.as_ref().unwrap().frames().len(), 2);
}

#[test]
fn keys_and_typed_lines_are_the_same_to_a_lesson() {
    for keys in ["m s", ": f o r c e Space s l i d Enter"] {
        let mut debugger = taught("oscillation");
        debugger.type_keys("Space s a x Space a f Space a 2 Space c a 1 Enter Space");
        assert_eq!(tutor(&debugger).at(), 7);
        debugger.type_keys(keys);
        assert_eq!(tutor(&debugger).at(), 8, "{keys}");
        debugger.type_keys("s a s Space c Space");
        let end = debugger.text(120, 40);
        assert!(end.contains("done  score 5/5"), "{end}");
        // From here on nothing is forbidden.
        debugger.type_keys("S S");
        assert!(debugger.text(120, 40).contains("steps"));
    }
}

#[test]
fn a_wrong_sign_is_recognised_and_a_hint_costs_the_point() {
    let mut debugger = taught("by-hand");
    let last = |debugger: &Debugger| tutor(debugger).page().last().cloned().unwrap();
    debugger.type_keys("Space a 0 . 0 6 Enter");
    let Paragraph::Wrong(told) = last(&debugger) else {
        panic!("0.06 is wrong")
    };
    assert!(
        told.starts_with("No: the amount is right, but the sign is wrong."),
        "{told}"
    );
    debugger.type_keys("a - 0 . 0 6 Enter Space s H");
    let Paragraph::Hint(told) = last(&debugger) else {
        panic!("a hint is no answer")
    };
    assert!(told.starts_with("Look at row free"), "{told}");
    debugger.type_keys("a x");
    assert_eq!(tutor(&debugger).score(), (0, 2));
}

#[test]
fn the_state_decides_a_task_and_space_opens_the_next_lesson() {
    let task = r#"Reach(text: "x", load: 1.0, without: [ladder], hint: "h", then: "{load}", solution: ["set settings.strategy lemke", "c"])"#;
    let lesson = Lesson::from_text("test.ron", &lesson_of(task)).unwrap();
    assert_eq!(play(&Arc::new(lesson.clone())).unwrap()[0].then, "Done. 1");
    let far = lesson_of(&task.replace("load: 1.0", "load: 9.0"));
    let end = "the solution does not reach the goal; it ends at load 1, increment";
    assert!(fault(&far).contains(end), "{}", fault(&far));
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), None);
    debugger.teach(lesson, None);
    let line = |debugger: &mut Debugger, line: &str| {
        debugger.type_keys(":");
        debugger.type_text(line);
        debugger.type_keys("Enter");
    };
    let last = |debugger: &Debugger| tutor(debugger).page().last().cloned().unwrap();
    debugger.type_keys("c");
    assert!(!tutor(&debugger).is_read());
    line(&mut debugger, "set settings.strategy ladder");
    debugger.type_keys("c");
    let told =
        "You are there, but with the strategy ladder. Go back to before that and try without it.";
    assert_eq!(last(&debugger), Paragraph::Wrong(told.into()));
    line(&mut debugger, "goto 0");
    line(&mut debugger, "set settings.strategy lemke");
    debugger.type_keys("c");
    assert_eq!(last(&debugger), Paragraph::Right("Done. 1".into()));
    assert_eq!(tutor(&debugger).score(), (1, 1));
    let after = "Ask(text: \"x\", answer: Number(of: \"load\", tolerance: 0.1))";
    let told = fault(&lesson_of(&format!("{task}, {after}")));
    assert!(
        told.contains("only texts and tasks can follow a task"),
        "{told}"
    );
    let mut debugger = at_step("oscillation", 13);
    while tutor(&debugger).step().is_some() {
        debugger.type_keys("Space");
    }
    debugger.type_keys("Space");
    debugger.settle();
    assert_eq!(tutor(&debugger).lesson().name, "two-nodes");
}

#[test]
fn a_lesson_resumes_at_its_step_in_the_same_state() {
    let home = tempfile::tempdir().unwrap();
    let begin = |step| {
        let mut debugger = Debugger::new(Theme::mono(), Vec::new(), None);
        debugger.keep_progress_in(home.path().join("lessons.ron"));
        debugger.teach(Lesson::open("oscillation").unwrap(), step);
        debugger
    };
    let state = |debugger: &Debugger| debugger.session.as_ref().unwrap().frame().state.clone();
    let mut before = begin(None);
    before.type_keys("Space s a s a x Space a f Space a 2 Space c");
    let after = begin(None);
    assert_eq!(tutor(&after).at(), tutor(&before).at());
    assert_eq!(tutor(&after).score(), (2, 3));
    assert_eq!(state(&after), state(&before));
    assert_eq!(tutor(&begin(Some(0))).at(), 0);
    assert_eq!(teach::lesson::split_step("modes@3"), ("modes", Some(2)));
    assert_eq!(teach::lesson::split_step("a@b"), ("a@b", None));
}

#[test]
fn lesson_screens() {
    for (width, height) in [(80, 24), (120, 40), (200, 60)] {
        let mut debugger = taught("table-2");
        debugger.type_keys("Space e e f s");
        insta::assert_snapshot!(
            format!("lesson-asks-{width}x{height}"),
            debugger.text(width, height)
        );
        debugger.type_keys("a 3");
        insta::assert_snapshot!(
            format!("lesson-tells-{width}x{height}"),
            debugger.text(width, height)
        );
    }
    let mut debugger = taught("table-2");
    debugger.type_keys("Space e");
    insta::assert_snapshot!("lesson-zoomed-80x24", debugger.text(80, 24));
}

#[test]
fn any_size_shows_what_to_do() {
    for (width, height) in [(40, 10), (60, 20), (80, 24), (100, 30), (130, 36)] {
        let mut debugger = taught("by-hand");
        debugger.app.area = Rect::new(0, 0, width, height);
        // As often as its pages must be turned.
        let mut turns = 0;
        while tutor(&debugger).at() == 0 || debugger.text(width, height).contains("▼ Space") {
            debugger.type_keys("Space");
            turns += 1;
            assert!(turns < 30);
        }
        let screen = debugger.text(width, height);
        assert!(screen.contains("▶ answer: a, then a number"), "{screen}");
    }
}

#[test]
fn broken_lessons_are_told_with_their_place() {
    let exact = fault(&lesson_of(r#"Press(text: "x", press: "jump")"#));
    assert_eq!(
        exact,
        "test.ron:2:29: steps[0].press: not a key, and unknown action 'jump'; ? lists all actions"
    );
    for (step, message) in [
        (r#"Press(text: "x", press: "3c")"#, "c takes no count"),
        (
            r#"Press(text: "x", press: "stpe")"#,
            "did you mean \"step\"?",
        ),
        (
            r#"Press(text: "x", press: "force tip s")"#,
            "unknown node 'tip'",
        ),
        (
            r#"Ask(text: "x", answer: Mode(node: "tip"))"#,
            "steps[0].answer.node: unknown node 'tip'",
        ),
        (
            r#"Ask(text: "x", answer: Rule(node: "beam.start"))"#,
            "is not a slave node",
        ),
        (
            r#"Text("{F_m beam.end}")"#,
            "unknown quantity \"F_m\"; did you mean \"F_n\"?",
        ),
        (r#"Text("{F_n}")"#, "F_n needs a node"),
        (r#"Text("{load")"#, "not closed"),
        (
            r#"Ask(text: "x", answer: Number(of: "mode beam.end", tolerance: 0.1))"#,
            "is not a number",
        ),
        (
            r#"Ask(text: "x", answer: Number(of: "load", tolerance: 2.0))"#,
            "the tolerance is relative",
        ),
        (
            r#"Ask(text: "x", answer: Choice([("a", Right)]))"#,
            "2 to 9 choices",
        ),
        (
            r#"Ask(text: "x", answr: Mode(node: "beam.end"))"#,
            "\"answr\"",
        ),
        (r#"Tell("x")"#, "\"Tell\" is not one of the choices"),
        (r#"Predict(text: "x", right: 0)"#, "one right prediction"),
        // These are only found when the lesson is played.
        (
            r#"Ask(text: "x", answer: Mode(node: "beam.end"))"#,
            "no iteration has been solved yet",
        ),
        (r#"Press(text: "x", press: "S")"#, "already at the start"),
        (
            r#"Ask(text: "x", answer: Choice([("a", Right), ("b", Cycles)]))"#,
            "more than one choice is right",
        ),
        (
            r#"Ask(text: "x", answer: Choice([("a", Wrong), ("b", Accepted)]))"#,
            "none of the choices is right",
        ),
    ] {
        let told = fault(&lesson_of(step));
        assert!(
            told.starts_with("test.ron:2:") && told.contains(message),
            "{step}\n{told}"
        );
        assert!(!told.contains('\n'), "{told}");
    }
}

#[test]
fn the_scene_of_a_lesson_is_checked_like_any_other() {
    let steps = "steps: [Text(\"x\")]";
    let told = fault(&format!("(title: \"T\",\n scene: Name(\"osc\"), {steps})"));
    assert!(
        told.starts_with("test.ron:2:9: scene: ") && told.contains("no built-in scene"),
        "{told}"
    );
    let text = format!(
        "(title: \"T\", scene: Name(\"osc-inclined-cantilever\"),\n set: [(\"friction.angle\", \"95\")], {steps})"
    );
    assert!(
        fault(&text).starts_with("test.ron:2:8: set[0]: "),
        "{}",
        fault(&text)
    );
    let by_hand = teach::find("by-hand").unwrap().text.to_owned();
    let broken = by_hand.replace(
        "(nodes: [\"beam.end\"], on: [\"floor\"]",
        "(nodes: [\"beam.end\"], on: [\"flor\"]",
    );
    let told = fault(&broken);
    let line = 1 + by_hand
        .lines()
        .position(|line| line.contains("slaves:"))
        .unwrap();
    assert!(told.starts_with(&format!("test.ron:{line}:")), "{told}");
    assert!(
        told.contains("scene.slaves[0].on[0]") && told.contains("did you mean \"floor\"?"),
        "{told}"
    );
    let broken = by_hand.replace("EI: 1.0", "EJ: 1.0");
    let told = fault(&broken);
    assert!(told.contains("\"EJ\""), "{told}");
}

#[test]
fn in_free_mode_a_decision_hides_until_it_is_predicted() {
    let scene = common::scene("osc-inclined-cantilever", &[]);
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), Some(Session::new(scene)));
    debugger.type_keys("p s");
    let hidden = debugger.text(120, 40);
    assert!(
        hidden.contains("free → ?") && !hidden.contains("free → fixed"),
        "{hidden}"
    );
    debugger.type_keys("s");
    let refused = debugger.text(120, 40);
    assert!(
        refused.contains("predict first") && refused.contains("minor 1 "),
        "{refused}"
    );
    debugger.type_keys("a x");
    let right = debugger.text(120, 40);
    assert!(
        right.contains("right: beam.5: Free → fixed") && right.contains("free → fixed"),
        "{right}"
    );
    debugger.type_keys("s a x");
    let wrong = debugger.text(120, 40);
    assert!(
        wrong.contains("no: beam.5: Fixed → free: the surface would have to pull."),
        "{wrong}"
    );
    debugger.type_keys("p");
    assert!(
        debugger
            .text(120, 40)
            .contains("predicted: 1 right, 1 wrong")
    );
}

#[test]
fn every_changed_node_can_be_asked_for() {
    let mut session = Session::new(common::two_blocks(1));
    let mut guess = Guess::new(HiddenDecisions::Changed, session.cursor());
    let step = action::parse("step", &Context::default()).unwrap();
    guess
        .permits(&step, session.cursor(), session.frame())
        .unwrap();
    let Action::Session(command) = step.clone() else {
        panic!("step moves the session")
    };
    session.submit(command).unwrap();
    session.wait();
    let (cursor, frame) = (session.cursor(), session.frame().clone());
    let nodes = &frame.event.as_ref().unwrap().nodes;
    let changed: Vec<usize> = (0..nodes.len())
        .filter(|s| nodes[*s].decision.changes())
        .collect();
    assert!(changed.len() > 2, "{changed:?}");
    for (count, &slave) in changed.iter().enumerate() {
        assert!(guess.hides(cursor, &frame, slave));
        assert!(guess.permits(&step, cursor, &frame).is_err());
        let (right, told) = guess
            .predict(session.model(), cursor, &frame, slave, "x")
            .unwrap();
        assert_eq!(right, nodes[slave].decision.next == Mode::Fixed);
        assert_eq!(
            told.contains("Other nodes change too"),
            count + 1 < changed.len()
        );
        assert!(!guess.hides(cursor, &frame, slave));
    }
    assert!(!guess.is_open(cursor, &frame));
    assert_eq!((guess.right + guess.wrong) as usize, changed.len());
}

#[test]
fn the_command_line_lists_and_checks_lessons() {
    let home = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_stickslip"))
            .args(arguments)
            .env("XDG_STATE_HOME", home.path())
            .env("HOME", home.path())
            .output()
            .unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (
            output.status.code(),
            text(&output.stdout),
            text(&output.stderr),
        )
    };
    let (code, out, _) = run(&["lesson"]);
    assert_eq!((code, out.lines().count()), (Some(0), teach::list().len()));
    let (code, out, _) = run(&["lesson", "--check", "by-hand"]);
    assert!(
        code == Some(0) && out.contains("by-hand: sound; 13 steps, 7 questions"),
        "{out}"
    );
    assert_eq!(out.matches("\n    ✓ Right: ").count(), 7, "{out}");
    assert_eq!(out.matches("\n    ✗ No. ").count(), 7, "{out}");
    assert!(
        out.contains("✗ No. Look at row fixed of Table 2: F_n = 0.18 > 0"),
        "{out}"
    );
    let (code, _, err) = run(&["lesson", "oscillation"]);
    assert!(code == Some(2) && err.contains("needs a terminal"), "{err}");
    let (code, _, err) = run(&["lesson", "4-osilation"]);
    assert!(
        code == Some(2) && err.contains("or built-in lesson"),
        "{err}"
    );
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wrong.ron");
    std::fs::write(&file, lesson_of(r#"Press(text: "x", press: "jump")"#)).unwrap();
    let (code, out, err) = run(&["lesson", "--check", file.to_str().unwrap()]);
    assert_eq!((code, out.as_str()), (Some(2), ""));
    assert!(err.contains("wrong.ron:2:29: steps[0].press"), "{err}");
}
