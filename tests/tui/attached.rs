//! Solvers of others in the terminal: who they are, what they offer, what they say, how they are lost; and exchanges that were kept.
//!
//! Those in process go along a kept exchange that a test writes; one test attaches the built program to itself.

use crate::terminal::*;
use ratatui::layout::Rect;
use serde_json::{Value as Json, json};
use stickslip::recorded::exchange::{self, RecordedSolver};
use stickslip::recorded::recording::Recording;
use stickslip::recorded::story::story;
use stickslip::session::Session as Debugged;
use stickslip::step::intervene::{Intervention, Value};
use stickslip::step::solver::{
    Capabilities, Now, Parameter, Range, RewindSupport, Solver, SolverLost,
};
use stickslip::step::state::State;
use stickslip::tui::Debugger;
use stickslip::tui::theme::Theme;

const SIZES: [(u16, u16); 3] = [(80, 24), (120, 40), (200, 60)];

/// A solver in process: what it does is written in an exchange, and what it offers is the test's to say.
struct Toy {
    past: RecordedSolver,
    offers: Capabilities,
}

impl Solver for Toy {
    fn now(&self) -> Now<'_> {
        self.past.now()
    }

    fn state_mut(&mut self) -> &mut State {
        self.past.state_mut()
    }

    fn advance(&mut self) -> Result<(), SolverLost> {
        self.past
            .advance()
            .map_err(|_| SolverLost::new("the solver ended: it fell off its chair"))
    }

    fn monitors(&mut self, out: &mut Vec<f64>) {
        self.past.monitors(out);
    }

    fn capabilities(&self) -> Capabilities {
        self.offers.clone()
    }
}

fn hello() -> Json {
    json!({"type": "hello", "protocol": 1, "name": "Toy", "version": "0.7", "abilities": {}, "decides": "table2"})
}

/// Two contacts of a bar, one over a floor and one over nothing.
fn scene() -> Json {
    json!({"type": "scene", "title": "A bar", "monitors": ["reaction"],
        "nodes": [{"name": "bar.1", "at": [0, 0.1]}, {"name": "bar.2", "at": [1, 0.1]},
                  {"name": "floor.1", "at": [2, 0]}, {"name": "floor.2", "at": [-1, 0]}],
        "lines": [[0, 1]], "surfaces": [{"name": "floor", "nodes": [2, 3], "rigid": true}],
        "contacts": [{"id": 7, "name": "bar.1", "node": 0, "surface": "floor", "friction": {"mu": 0.3}},
                     {"id": "b", "node": 1}]})
}

/// A state in which the first contact is fixed with room to stick, and the solver frees it all the same; the second tells nothing.
fn state(major: u32, next: &str) -> Json {
    json!({"type": "state", "at": {"increment": 1, "attempt": 1, "major": major, "minor": 1}, "ended": "iteration",
        "contacts": [
            {"id": 7, "mode": "fixed", "next": next, "gap": 0, "f_n": 2.5, "f_t": 0.25, "limit": 0.75, "slip": 0,
             "rule": "the augmented pressure is negative"},
            {"id": "b", "mode": "free", "next": "free", "gap": null, "f_n": null, "f_t": null, "limit": null, "slip": null}],
        "residual": {"relative": 1e-3}, "monitors": [null]})
}

/// An exchange of these lines, each with its sign, after the greeting.
fn exchange(scene: &Json, lines: &[(char, Json)]) -> String {
    let mut text = format!(
        "# stickslip exchange 1\n# started: toy\n< {}\n< {scene}\n",
        hello()
    );
    for (sign, line) in lines {
        match line {
            Json::String(plain) => text += &format!("{sign} {plain}\n"),
            line => text += &format!("{sign} {line}\n"),
        }
    }
    text
}

fn steps(states: impl IntoIterator<Item = Json>) -> Vec<(char, Json)> {
    let step = |state: Json| [('>', json!({"type": "step"})), ('<', state)];
    states.into_iter().flat_map(step).collect()
}

/// A debugger on a solver in process.
fn attached(text: &str, offers: Capabilities) -> Debugger {
    let opened = exchange::open("toy", text).unwrap();
    let offers = Capabilities {
        name: "Toy".into(),
        version: "0.7".into(),
        ..offers
    };
    let toy = Toy {
        past: opened.past,
        offers,
    };
    let session = Debugged::attached(opened.scene, Box::new(toy), opened.log);
    Debugger::new(Theme::mono(), Vec::new(), Some(session))
}

fn three() -> String {
    exchange(
        &scene(),
        &steps([state(1, "free"), state(2, "fixed"), state(3, "free")]),
    )
}

fn kept(text: &str) -> Debugger {
    let session = Debugged::recorded(Recording::Exchange(Box::new(
        exchange::open("kept", text).unwrap(),
    )));
    Debugger::new(Theme::mono(), Vec::new(), Some(session))
}

#[track_caller]
fn holds(debugger: &Debugger, text: &str) {
    let shown = debugger.text(120, 40);
    assert!(shown.contains(text), "{text} is not on\n{shown}");
}

#[test]
fn whole_screens_of_an_attached_solver() {
    let mut debugger = attached(&three(), Capabilities::default());
    debugger.type_keys("s");
    for (width, height) in SIZES {
        insta::assert_snapshot!(
            format!("toy-{width}x{height}"),
            debugger.text(width, height)
        );
    }
}

/// An accepted state in which a fixed contact pulls.
fn pulls() -> Json {
    let mut last = state(1, "fixed");
    last["ended"] = json!("done");
    last["load"] = json!(1);
    last["contacts"][0]["f_n"] = json!(-2.5);
    last
}

#[test]
fn an_end_that_is_judged_wrong_is_no_other_valid_state() {
    let mut debugger = attached(
        &exchange(&scene(), &steps([pulls()])),
        Capabilities::default(),
    );
    debugger.type_keys("s");
    debugger.type_keys(": b r a n c h e s Enter");
    holds(&debugger, "accepted, but fails the check");
}

#[test]
fn who_is_attached_and_how_it_goes_back_stand_at_the_top() {
    for (goes_back, words) in [
        (RewindSupport::Again, "attached, goes back by restart"),
        (
            RewindSupport::ToIncrements,
            "attached, goes back to increments, then replays",
        ),
        (RewindSupport::ToAny, "attached, can go back to any state"),
    ] {
        let debugger = attached(
            &three(),
            Capabilities {
                goes_back,
                ..Capabilities::default()
            },
        );
        holds(&debugger, &format!(" stickslip Toy 0.7   {words}"));
    }
}

#[test]
fn what_is_not_offered_is_grey_everywhere_and_its_key_gives_the_reason_and_does_nothing() {
    let mut debugger = attached(&three(), Capabilities::default());
    debugger.type_keys("s");
    for label in ["m (mode)", "i (increment)"] {
        holds(&debugger, label);
    }
    let before = debugger.session.as_ref().unwrap().frames().len();
    for (keys, reason) in [
        ("m", "the solver Toy does not offer forced modes"),
        ("M", "the solver Toy does not offer forced modes"),
        ("i", "the solver Toy does not offer another increment"),
        ("r", "the solver Toy does not offer its interface problem"),
    ] {
        debugger.type_keys(keys);
        assert_eq!(debugger.app.message.text, reason, "{keys}");
    }
    for (line, reason) in [
        ("hold free", "does not offer modes that are held"),
        ("friction 20", "does not offer a friction change"),
        ("cohesion 2", "does not offer a cohesion change"),
        (
            "minors 9",
            "does not offer settings of the two-level method",
        ),
        ("census", "does not offer its interface problem"),
        ("start-from 1", "does not offer its interface problem"),
        ("core a.ron", "does not offer its interface problem"),
        (
            "export --frozen a.ron",
            "does not offer its interface problem",
        ),
        ("export a.ron", "the scene is known only to the solver"),
        ("chart", "scenes that stickslip solves itself"),
        ("set settings.minors 3", "does not offer settings"),
        (
            "set gamma 3",
            "the solver has no parameter 'gamma'; it has none",
        ),
    ] {
        debugger.type_keys(":");
        debugger.type_text(line);
        debugger.type_keys("Enter");
        let said = &debugger.app.message.text;
        assert!(said.contains(reason), "{line}: {said}");
    }
    assert_eq!(debugger.session.as_ref().unwrap().frames().len(), before);
    debugger.app.area = Rect::new(0, 0, 120, 40);
    debugger.type_keys("? PageDown PageDown");
    // The table of the help breaks its lines.
    let help = debugger.text(120, 40).replace('┃', " ");
    let help: String = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        help.contains("Not available: the solver Toy does not offer another increment."),
        "{help}"
    );
    debugger.type_keys("Esc :");
    debugger.type_text("fo");
    holds(
        &debugger,
        "not available: the solver Toy does not offer forced modes",
    );
    debugger.type_keys("Esc :");
    debugger.type_text("mi");
    debugger.type_keys("Backspace Tab");
    holds(&debugger, "(minors)");
}

#[test]
fn what_is_offered_in_part_says_which_part() {
    let mut debugger = attached(
        &three(),
        Capabilities {
            force: true,
            ..Capabilities::default()
        },
    );
    debugger.type_keys("m");
    holds(&debugger, "this solver cannot hold it");
    holds(&debugger, "F S X (hold)");
    debugger.type_keys("X");
    assert!(
        debugger
            .app
            .message
            .text
            .contains("does not offer modes that are held")
    );
    debugger.type_keys("m x");
    let frame = debugger.session.as_ref().unwrap().frame();
    assert!(matches!(
        frame.intervention,
        Some(Intervention::Force { hold: false, .. })
    ));
}

#[test]
fn a_solver_of_our_own_has_no_log_and_no_parameters() {
    let scene = stickslip::scene::Scene::open("osc-lag4", &[]).unwrap();
    let session = Debugged::new(scene);
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), Some(session));
    for keys in ["O", ": l o g Enter", ": p a r a m Enter"] {
        debugger.type_keys(keys);
        holds(&debugger, "only attached solvers");
    }
    debugger.type_keys("V");
    holds(&debugger, "this scene is plane");
    debugger.type_keys("m");
    holds(&debugger, "(capital letter: hold)");
}

#[test]
fn the_decision_shows_the_solver_s_words_and_where_table_2_differs() {
    let mut debugger = attached(&three(), Capabilities::default());
    debugger.type_keys("s e");
    let shown = debugger.text(120, 40);
    let joined: String = shown.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        joined.contains("The solver chooses free: “the augmented pressure is negative”."),
        "{shown}"
    );
    assert!(
        joined.contains("≠ Table 2 (◁), which gives fixed for the same values."),
        "{shown}"
    );
    assert!(
        shown.contains("F_n > 0") && shown.contains("◁") && shown.contains("◀"),
        "{shown}"
    );
    debugger.type_keys("e");
    holds(&debugger, "▸≠ bar.1");
    debugger.type_keys("t");
    // Under the columns of the first iteration only: at the start nothing is decided.
    let row = debugger
        .text(120, 40)
        .lines()
        .filter(|line| line.contains('≠'))
        .count();
    assert_eq!(row, 1);
    debugger.type_keys("t s s");
    let session = debugger.session.as_ref().unwrap();
    let differ: Vec<bool> = session
        .timeline()
        .strips()
        .iter()
        .map(|strip| strip.differs(0))
        .collect();
    assert_eq!(differ, [false, true, false, true]);
}

#[test]
fn what_is_not_told_is_a_dash_and_never_nan() {
    let mut debugger = attached(&three(), Capabilities::default());
    debugger.type_keys("s j");
    for keys in ["", "e", "e Tab Tab", "Tab Tab Tab z"] {
        debugger.type_keys(keys);
        for (width, height) in SIZES {
            let shown = debugger.text(width, height);
            assert!(!shown.contains("NaN") && !shown.contains(" inf"), "{shown}");
        }
    }
}

#[test]
fn going_back_says_what_has_to_be_done_again() {
    let mut debugger = attached(
        &three(),
        Capabilities {
            force: true,
            ..Capabilities::default()
        },
    );
    debugger.type_keys("s s S");
    let again = "the solver restarts and repeats 1 iteration";
    assert!(
        debugger.app.message.text.contains(again),
        "{}",
        debugger.app.message.text
    );
    debugger.type_keys("s");
    assert!(
        !debugger.app.message.text.contains("restarts"),
        "{}",
        debugger.app.message.text
    );
    let any = Capabilities {
        goes_back: RewindSupport::ToAny,
        ..Capabilities::default()
    };
    let mut debugger = attached(&three(), any);
    debugger.type_keys("s s S");
    assert!(
        !debugger.app.message.text.contains("again"),
        "{}",
        debugger.app.message.text
    );
}

#[test]
fn a_lost_solver_is_told_until_a_key_and_the_header_says_so_until_it_steps() {
    let mut debugger = attached(&three(), Capabilities::default());
    debugger.type_keys("s s s");
    assert!(!debugger.text(120, 40).contains("lost"));
    debugger.type_keys("s");
    let why = "the solver ended: it fell off its chair; all steps so far are kept";
    for _ in 0..3 {
        debugger.advance();
        holds(&debugger, why);
        holds(&debugger, "✗ lost; the next step restarts it");
    }
    assert_eq!(debugger.session.as_ref().unwrap().frames().len(), 4);
    debugger.type_keys("j");
    let shown = debugger.text(120, 40);
    assert!(!shown.contains(why) && shown.contains("✗ lost"), "{shown}");
    for (width, height) in [(40, 8), (80, 24), (200, 60)] {
        assert!(debugger.text(width, height).contains("lost"));
    }
    debugger.type_keys("S");
    let again = "the solver, whose connection was lost, restarts and repeats 2 iterations";
    assert!(
        debugger.app.message.text.contains(again),
        "{}",
        debugger.app.message.text
    );
}

#[test]
fn what_a_solver_says_has_a_page_that_follows_its_end() {
    let mut lines = vec![(
        '<',
        json!({"type": "message", "level": "warning", "text": "ill-conditioned\u{1b}]0;x"}),
    )];
    lines.extend((0..60).map(|k| ('!', Json::String(format!("line {k} of its standard error")))));
    lines.push((
        '<',
        json!({"type": "message", "level": "error", "text": "no convergence"}),
    ));
    let mut debugger = attached(&exchange(&scene(), &lines), Capabilities::default());
    debugger.advance();
    holds(&debugger, "solver error: no convergence");
    holds(&debugger, "1 error, 1 warning (O)");
    debugger.type_keys("j");
    assert!(
        !debugger.text(120, 40).contains("no convergence"),
        "shown once"
    );
    debugger.app.area = Rect::new(0, 0, 80, 24);
    debugger.type_keys("O");
    insta::assert_snapshot!("toy-log-80x24", debugger.text(80, 24));
    debugger.type_keys("Home");
    let shown = debugger.text(80, 24);
    assert!(
        shown.contains("warning  ill-conditioned\\u{1b}]0;x") && !shown.contains("no convergence"),
        "{shown}"
    );
    debugger.type_keys("/ l i n e Space 3 5 Enter");
    assert!(debugger.text(80, 24).contains("line 35 of"));
    debugger.type_keys("End");
    assert!(debugger.text(80, 24).contains("error    no convergence"));
    debugger.type_keys("Esc");
    assert!(!debugger.text(80, 24).contains("What Toy says"));
}

fn parameters() -> Capabilities {
    let one = |name: &str, value: Value, range: Range, about: &str| Parameter {
        name: name.into(),
        value,
        range,
        about: about.into(),
        tunes: false,
    };
    let positive = Range::Numbers {
        least: 0.0,
        most: f64::INFINITY,
        whole: false,
    };
    let laws = Range::Choice(vec!["alm".into(), "penalty".into()]);
    Capabilities {
        parameters: vec![
            one(
                "penalty factor",
                Value::Number(10.0),
                positive,
                "Stiffness of the penalty",
            ),
            one(
                "law",
                Value::Text("alm".into()),
                laws,
                "Which law the contacts obey",
            ),
            one("damped", Value::Flag(false), Range::Flag, ""),
        ],
        ..Capabilities::default()
    }
}

#[test]
fn parameters_are_completed_set_and_listed_with_what_they_are_now() {
    let mut debugger = attached(&three(), parameters());
    debugger.type_keys(":");
    debugger.type_text("set p");
    debugger.type_keys("Tab");
    holds(&debugger, ":set penalty factor");
    holds(
        &debugger,
        "a number from 0 on, now 10: Stiffness of the penalty",
    );
    debugger.type_text("12.5");
    debugger.type_keys("Enter");
    assert_eq!(debugger.app.message.text, "penalty factor set to 12.5");
    debugger.type_keys(":");
    debugger.type_text("set law p");
    debugger.type_keys("Tab Enter");
    assert_eq!(debugger.app.message.text, "law set to penalty");
    debugger.type_keys(":");
    debugger.type_text("set law newton");
    debugger.type_keys("Enter");
    assert!(
        debugger.app.message.text.contains("one of alm, penalty"),
        "{}",
        debugger.app.message.text
    );
    debugger.type_keys(": p a r a m Enter");
    for line in [
        "penalty factor = 12.5   (a number from 0 on, initially 10)",
        "Stiffness of the penalty",
        "law = penalty   (one of alm, penalty, initially alm)",
        "damped = false   (true or false)",
    ] {
        holds(&debugger, line);
    }
}

/// Scenes that nobody would make, with a state each.
fn odd() -> Vec<String> {
    let found = |id: usize, number: Json| {
        json!({"id": id, "mode": "sliding", "next": "fixed", "gap": number, "f_n": number, "f_t": number, "limit": number,
               "slip": number, "corner": 0.3, "normal": [0, 1], "margin": number})
    };
    let told = |contacts: Vec<Json>| {
        json!({"type": "state", "at": {"increment": 1, "attempt": 1, "major": 1, "minor": 1}, "ended": "equilibrium",
               "contacts": contacts, "residual": {}})
    };
    let alone = json!({"type": "scene", "title": "", "nodes": [{"at": [0, 0]}], "contacts": [{"id": 0, "node": 0}]});
    let many: Vec<Json> = (0..1000)
        .map(|k| json!({"at": [k, 0], "name": format!("n\u{1b}[3{k}m 接触 {k}")}))
        .collect();
    let contacts: Vec<Json> = (0..1000).map(|k| json!({"id": k, "node": k})).collect();
    let many =
        json!({"type": "scene", "title": "\u{202e}many\n", "nodes": many, "contacts": contacts});
    let line = json!({"type": "scene", "title": "x", "nodes": [{"at": [1e300, -1e300]}, {"at": [1e300, -1e300]}],
                      "lines": [[0, 1, 0]], "surfaces": [{"name": "s\u{7}", "nodes": [0, 1], "rigid": false}],
                      "contacts": [{"id": 0, "node": 0, "surface": "s\u{7}"}]});
    let of = |scene: &Json, count: usize, number: Json| {
        let all = (0..count).map(|id| found(id, number.clone())).collect();
        exchange(scene, &steps([told(all)]))
    };
    vec![
        of(&alone, 1, Json::Null),
        of(&alone, 1, json!(-1e308)),
        of(&many, 1000, Json::Null),
        of(&many, 1000, json!(1e-320)),
        of(&line, 1, json!(1e308)),
    ]
}

#[test]
fn nothing_that_a_solver_tells_breaks_a_screen() {
    let pages = [
        "",
        "e",
        "Esc z",
        "Esc Tab Tab z",
        "Esc Tab z + Left",
        "Esc Tab z",
        "Esc t",
        "Esc v",
        "Esc >",
        "A",
        "A",
        "?",
        "Esc O",
        "Esc : p a r a m Enter",
        "Esc G",
        "p",
        "d",
    ];
    for text in odd() {
        for offers in [Capabilities::default(), parameters()] {
            let mut debugger = attached(&text, offers);
            debugger.type_keys("s");
            for keys in pages {
                debugger.type_keys(keys);
                for (width, height) in [(1, 1), (20, 5), (45, 12), (80, 24), (120, 40), (200, 60)] {
                    let shown = debugger.text(width, height);
                    assert!(!shown.contains('\u{1b}') && !shown.contains('\u{202e}'));
                }
            }
            // RecordedSolver the end of what is told it is lost.
            debugger.type_keys("Esc s c S");
            debugger.text(120, 40);
        }
    }
}

/// Three iterations; and from the first of them another way, after the contact was forced.
fn two_ways() -> String {
    let mut lines = steps([state(1, "free"), state(2, "fixed"), state(3, "free")]);
    lines.push(('#', Json::String("started: toy".into())));
    lines.extend(steps([state(1, "free")]));
    lines.push((
        '>',
        json!({"type": "force", "contact": 7, "mode": "sliding", "hold": false}),
    ));
    lines.push(('<', json!({"type": "ok"})));
    lines.extend(steps([state(2, "sliding")]));
    exchange(&scene(), &lines)
}

#[test]
fn a_kept_exchange_is_gone_through_with_all_its_ways_and_nothing_follows_on_it() {
    let mut debugger = kept(&two_ways());
    for (width, height) in SIZES {
        insta::assert_snapshot!(
            format!("kept-{width}x{height}"),
            debugger.text(width, height)
        );
    }
    let session = debugger.session.as_ref().unwrap();
    assert_eq!(
        (
            session.timeline().tree().branches().len(),
            session.frames().len()
        ),
        (2, 4)
    );
    debugger.type_keys("s s s");
    holds(&debugger, "major 3");
    debugger.type_keys("s");
    holds(
        &debugger,
        "the stored exchange ends here and cannot be continued",
    );
    assert!(!debugger.text(120, 40).contains("lost"));
    debugger.type_keys("]");
    let session = debugger.session.as_ref().unwrap();
    assert_eq!(
        session.frames().len(),
        4,
        "start, an iteration, the force, an iteration"
    );
    assert!(matches!(
        session.frames()[2].intervention,
        Some(Intervention::Force { slave: 0, .. })
    ));
    debugger.type_keys("S m");
    holds(
        &debugger,
        "stored exchange (read-only): forced modes would need the solver Toy itself",
    );
    debugger.type_keys(": j o u r n a l Space x Enter");
    holds(
        &debugger,
        "stored exchange (read-only): it does not need a journal",
    );
}

#[test]
fn a_kept_exchange_is_told_as_text() {
    let told = story("a.txt", &mut exchange::open("a.txt", &two_ways()).unwrap());
    insta::assert_snapshot!("kept-story", told);
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), two_ways() + "< {\"type\":\"sta").unwrap();
    let name = file.path().to_str().unwrap();
    for command in ["story", "show"] {
        let output = run(&[command, name], std::process::Stdio::null());
        assert!(output.status.success(), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("Branch b2, from b1 after step 1:"), "{text}");
    }
    let output = run(&[name], std::process::Stdio::null());
    assert_eq!(output.status.code(), Some(2));
    let why = String::from_utf8(output.stderr).unwrap();
    assert!(
        why.contains(&format!("`stickslip story {name}` prints it")),
        "{why}"
    );
    std::fs::write(file.path(), two_ways() + "> {\"type\":\"dance\"}\n").unwrap();
    let output = run(&["story", name], std::process::Stdio::null());
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let why = String::from_utf8(output.stderr).unwrap();
    let line = two_ways().lines().count() + 1;
    assert!(why.contains(&format!("{name}:{line}:")), "{why}");
}

#[test]
fn a_solver_is_attached_stepped_forced_gone_back_with_and_gone_with_the_program() {
    let mut session =
        Start::debugger(&["attach", "--no-journal", "--", PROGRAM, "serve", "osc-lag4"]).go();
    session.see_taken();
    session.see("attached, can go back to any state");
    session.keys("s");
    session.see("a free → fixed");
    session.keys("s");
    session.see("a fixed → sliding");
    session.keys("S");
    session.see("1 of 2 steps");
    session.keys("mx");
    session.see("a is fixed in the next minor iteration");
    session.keys("s");
    session.see("◇ 1 forced");
    session.keys(":log\r");
    session.see("Log of stickslip osc-lag4");
    session.keys("\x1b");
    let program = session.child.process_id().unwrap();
    // The thread that started it is its parent.
    let tasks = std::fs::read_dir(format!("/proc/{program}/task")).unwrap();
    let solvers: Vec<u32> = tasks
        .filter_map(|task| task.ok()?.file_name().to_str()?.parse().ok())
        .flat_map(|task: u32| {
            let listed = std::fs::read_to_string(format!("/proc/{program}/task/{task}/children"));
            let listed = listed.unwrap_or_default();
            listed
                .split_whitespace()
                .filter_map(|id| id.parse().ok())
                .collect::<Vec<u32>>()
        })
        .collect();
    assert_eq!(solvers.len(), 2, "the solver and its guard: {solvers:?}");
    session.quit();
    let runs = |id: &u32| std::path::Path::new(&format!("/proc/{id}")).exists();
    let gone = patiently(|| (!solvers.iter().any(runs)).then_some(()));
    assert!(
        gone.is_some(),
        "the solver or its guard outlives the debugger"
    );
}

#[test]
fn the_progress_of_a_long_step_and_its_time_fit_80_columns() {
    let progress = json!({"type": "progress", "text": "CG iteration", "done": 30, "of": 200});
    let [hello, scene, state] = [hello(), scene(), state(1, "free")];
    let script = format!(
        "read a; echo '{hello}'; read b; echo '{scene}'; read c; echo '{progress}'; sleep 4; echo '{state}'; read d"
    );
    let solver = ["attach", "--no-journal", "--", "sh", "-c", &script];
    let mut session = Start::debugger(&solver).size(80, 24).go();
    session.see("goes back by restart");
    session.type_and_see("s", "CG iteration 30 of 200, 2 s; Ctrl-C stops");
    session.see("major 1");
    session.quit();
}
