//! Keys typed ahead: what README and manual walk through leads, typed at once, where it leads with pauses.

use crate::terminal::{Start, trimmed};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;
use std::fs;
use std::path::Path;
use stickslip::history::verdicts::summaries;
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::tui::Debugger;
use stickslip::tui::keys;
use stickslip::tui::theme::Theme;

const FLOOR: &str = "01-pinned-beam-rough-floor";
const OSCILLATES: &str = "osc-inclined-cantilever";

/// The walks that stand in sentences: scene and keys, by the page that has them.
const WALKS: [(&str, &str, &str); 4] = [
    (
        "src/manual/pages/tour.md",
        FLOOR,
        "s f 2 4 f s s 1 7 f f S N F F i 0 . 0 0 1 Enter f c",
    ),
    ("README.md", OSCILLATES, "c m s c d Esc r v t"),
    (
        "src/manual/pages/tour.md",
        OSCILLATES,
        "c s s s m s c C S d Enter s",
    ),
    (
        "src/manual/pages/diagnosing.md",
        "osc-two6",
        "c t Left Left e Esc c d Down Enter s v [ r Down Down Enter v Up Enter t",
    ),
];

fn debugger(scene: &str) -> Debugger {
    let session = Session::open(scene).unwrap();
    Debugger::new(Theme::mono(), Vec::new(), Some(session))
}

/// What is on the screen and where the session is.
fn state(debugger: &Debugger) -> (String, Vec<String>) {
    let session = debugger.session.as_ref().unwrap();
    let branches = summaries(session.timeline().tree());
    let told = branches.iter().map(|branch| format!("{branch:?}"));
    // Seconds are no state.
    let told = told.map(|text| text.split("seconds").next().unwrap_or_default().to_owned());
    let mut place = vec![format!(
        "{:?} {:?}",
        session.timeline().place(),
        session.frame().state.next
    )];
    place.extend(told);
    // Nor is how long the remedies took, which a narrow screen leaves out.
    (debugger.text(80, 50), place)
}

/// Types keys without waiting for anything until the last is typed.
fn at_once(scene: &str, names: &str) -> Debugger {
    let mut debugger = debugger(scene);
    for key in keys::presses(names).unwrap() {
        debugger.key(&key);
    }
    debugger.settle();
    debugger
}

#[track_caller]
fn same(scene: &str, names: &str) {
    let mut paused = debugger(scene);
    paused.settle();
    paused.type_keys(names);
    let (at_once, paused) = (state(&at_once(scene, names)), state(&paused));
    assert_eq!(at_once.1, paused.1, "{scene}: {names}");
    assert!(
        at_once.0 == paused.0,
        "{scene}: {names}\nat once\n{}\nwith pauses\n{}",
        at_once.0,
        paused.0
    );
}

/// The pictures of README and manual: scene and keys of each.
fn pictures() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let pages = fs::read_dir(root.join("src/manual/pages")).unwrap();
    let mut files: Vec<_> = pages.map(|entry| entry.unwrap().path()).collect();
    files.push(root.join("README.md"));
    files.sort();
    let mut found = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        for line in text.lines() {
            let marker = line
                .strip_prefix("<!-- screen ")
                .and_then(|rest| rest.strip_suffix(" -->"));
            let parts = marker.and_then(|rest| rest.split_once(' ')?.1.split_once(": "));
            found.extend(parts.map(|(scene, keys)| (scene.to_owned(), keys.to_owned())));
        }
    }
    found
}

#[test]
fn the_keys_of_every_walk_typed_at_once_lead_where_they_lead_with_pauses() {
    let pictures = pictures();
    assert!(pictures.len() > 5, "{}", pictures.len());
    for (scene, keys) in &pictures {
        same(scene, keys);
    }
    for (_, scene, keys) in WALKS {
        same(scene, keys);
    }
}

#[test]
fn any_keys_typed_at_once_lead_where_they_lead_with_pauses() {
    const KEYS: [&str; 46] = [
        "s",
        "s",
        "n",
        "f",
        "c",
        "c",
        "S",
        "N",
        "F",
        "C",
        "m s",
        "m X",
        "m Esc",
        "M",
        "i 0 . 5 Enter",
        "d",
        "d",
        "r",
        "t",
        "v",
        "e",
        "Enter",
        "Enter",
        "Up",
        "Down",
        "Down",
        "Left",
        "Right",
        "Tab",
        "Shift-Tab",
        "z",
        "? j Esc",
        "Esc",
        "2 s",
        "3 f",
        "]",
        "[",
        "> Enter",
        "G",
        "g",
        ": c e n Enter",
        ": s t a r t - f r o m Space 1 Enter",
        ": a p p l y Space 2 Enter",
        "/ b Enter",
        "p",
        "a s",
    ];
    for seed in 0..24 {
        let mut random = Pcg64::new(7, seed);
        let scene = ["osc-two6", "osc-zig3", OSCILLATES][seed as usize % 3];
        let typed: Vec<&str> = (0..14)
            .map(|_| KEYS[(random.next_u64() % KEYS.len() as u64) as usize])
            .collect();
        same(scene, &typed.join(" "));
    }
}

/// A run that does not end by itself in the time of a test.
fn endless() -> Debugger {
    let long = [("history.increment".to_owned(), "1e-6".to_owned())];
    let session = Session::new(Scene::open(FLOOR, &long).unwrap());
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), Some(session));
    press(&mut debugger, "c");
    debugger
}

fn press(debugger: &mut Debugger, names: &str) {
    for key in names.split_whitespace().filter_map(keys::press) {
        debugger.key(&key);
    }
}

#[test]
fn what_asks_something_of_a_run_waits_and_says_so_and_what_looks_around_does_not() {
    for (keys, named) in [
        ("r", "r"),
        ("d", "d"),
        ("s", "s"),
        ("w", "w"),
        ("m", "m"),
        (": c e n s u s Enter", ":census"),
        (": c h a r t Enter", ":chart"),
        (": b r a n c h e s Enter", ":branches"),
        (": w a t c h Space g a p Enter", ":watch gap"),
        (": o p e n Space x Enter", ":open x"),
    ] {
        let mut debugger = endless();
        press(&mut debugger, keys);
        let note = format!("{named} waits until the run stops; Ctrl-C interrupts it");
        let text = debugger.text(120, 40);
        assert!(text.contains(&note), "{keys}\n{text}");
        press(&mut debugger, "Ctrl-c");
        debugger.settle();
        let text = debugger.text(120, 40);
        assert!(text.contains("interrupted; "), "{keys}\n{text}");
        assert!(!debugger.app.ahead.is_any());
    }
    for keys in ["Tab", "z", "?", "t", "v", "e", "+", "> ", "/ b Enter", "5"] {
        let mut debugger = endless();
        press(&mut debugger, keys);
        assert!(!debugger.app.ahead.is_any(), "{keys}");
        assert!(debugger.is_busy(), "{keys}");
        press(&mut debugger, "Ctrl-c");
        debugger.settle();
    }
}

#[test]
fn what_is_typed_behind_something_that_waits_keeps_its_place_in_the_line() {
    let mut debugger = endless();
    press(&mut debugger, "d Tab 3 s : c e n");
    let text = debugger.text(120, 40);
    assert!(
        text.contains("d, Tab, 3 and 5 more wait until the run stops"),
        "{text}"
    );
    press(&mut debugger, "Ctrl-c");
    debugger.settle();
    assert_eq!(debugger.app.count, None);
}

#[test]
fn the_key_of_an_empty_page_computes_and_a_second_press_leaves_it_open() {
    for (key, shown) in [("d", "of a and b: 1 of 16"), ("r", "converge; Enter")] {
        let mut debugger = debugger("osc-two6");
        debugger.type_keys("s");
        // The page is in sight, and has nothing to tell.
        let turns = if key == "d" { 6 } else { 8 };
        debugger.type_keys(&"Tab ".repeat(turns));
        assert!(!debugger.text(120, 50).contains(shown));
        press(&mut debugger, &format!("{key} {key} {key}"));
        let text = debugger.text(120, 50);
        assert!(text.contains("Esc closes this page"), "{text}");
        debugger.settle();
        assert!(
            debugger.text(120, 50).contains(shown),
            "{}",
            debugger.text(120, 50)
        );
        // From another place it is found out anew, and not closed.
        debugger.type_keys(&format!("s {key}"));
        assert!(debugger.app.panes.zoomed);
        assert!(debugger.text(120, 50).contains(shown));
        debugger.type_keys("Esc");
        assert!(!debugger.app.panes.zoomed);
    }
}

#[test]
fn notes_go_with_the_next_key_and_errors_with_the_next_success() {
    let mut debugger = debugger(FLOOR);
    debugger.type_keys("m s");
    assert!(debugger.text(120, 40).contains("is sliding in the next"));
    debugger.type_keys("Tab");
    assert_eq!(debugger.app.message.text, "");
    debugger.type_keys("x");
    assert!(debugger.text(120, 40).contains("x is not bound here"));
    for key in ["Tab", "z", "s", "+", "?", ":", "5"] {
        debugger.type_keys("Esc x");
        assert!(
            debugger.text(120, 40).contains("is not bound here"),
            "{key}"
        );
        debugger.type_keys(key);
        assert!(
            !debugger.text(120, 40).contains("is not bound here"),
            "{key}"
        );
        debugger.type_keys("Esc");
    }
}

#[test]
fn a_watch_stands_there_once_whatever_is_looked_at_then() {
    let mut debugger = debugger(FLOOR);
    debugger.type_keys("s s : w a t c h Space f _ n Enter");
    let value = "f_n beam.5 = 0.004226497308";
    let count = |debugger: &Debugger| debugger.text(120, 40).matches(value).count();
    assert!(
        debugger.text(120, 40).contains(value),
        "{}",
        debugger.text(120, 40)
    );
    assert_eq!(count(&debugger), 1);
    debugger.type_keys("Tab");
    assert_eq!(count(&debugger), 1, "{}", debugger.text(120, 40));
    debugger.type_keys("x");
    assert!(debugger.text(120, 40).contains(value));
}

#[test]
fn set_says_what_changed_from_what_to_what() {
    let mut debugger = debugger(FLOOR);
    for (line, told) in [
        (
            "set settings.strategy table2",
            "settings.strategy changed from ladder to table2",
        ),
        (
            "set settings.strategy table2",
            "settings.strategy stays table2",
        ),
        ("friction 20", "friction.angle changed from 30 to 20"),
        (
            "set history.increment 0.02",
            "history.increment changed from 0.01 to 0.02",
        ),
        ("minors 40", "settings.minors changed from "),
    ] {
        debugger.type_text(&format!(":{line}"));
        debugger.type_keys("Enter");
        let text = debugger.text(200, 60);
        assert!(text.contains(told), "{told}\n{text}");
    }
}

#[test]
#[cfg(unix)]
fn in_a_real_terminal_nothing_of_a_walk_typed_at_once_is_lost() {
    for (_, scene, names) in WALKS {
        let mut paused = debugger(scene);
        paused.type_keys(names);
        let wanted = paused.text(120, 40);
        let lines = |text: &str| text.trim_end().lines().map(trimmed).collect::<Vec<_>>();
        let mut session = Start::debugger(&[scene]).go();
        session.see("nothing is solved yet");
        let bytes: String = names
            .split_whitespace()
            .map(|name| match name {
                "Enter" => "\r",
                "Esc" => "\x1b",
                "Up" => "\x1b[A",
                "Down" => "\x1b[B",
                "Left" => "\x1b[D",
                letter => letter,
            })
            .collect();
        session.keys(&bytes);
        session.wait(&format!("{scene}: {names}\n{wanted}"), |screen| {
            lines(&screen.contents()) == lines(&wanted)
        });
        session.quit();
    }
}

#[test]
fn a_node_that_is_not_forced_cannot_be_released() {
    let mut debugger = debugger(FLOOR);
    debugger.type_keys("s s S M");
    assert_eq!(debugger.app.message.text, "beam.5 is not forced");
    let branches = |debugger: &Debugger| {
        let session = debugger.session.as_ref().unwrap();
        session.timeline().tree().branches().len()
    };
    assert_eq!(branches(&debugger), 1);
    debugger.type_keys("m S M");
    assert!(
        debugger
            .app
            .message
            .text
            .contains("beam.5 follows Table 2 again")
    );
    assert_eq!(branches(&debugger), 2);
    // Before the forced mode, a release goes on without it.
    debugger.type_keys("m S s S S M");
    assert_eq!(branches(&debugger), 3, "{}", debugger.app.message.text);
}
