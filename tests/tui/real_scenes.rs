//! The debugger on real scenes: what is done is seen.

use stickslip::history::frame::curve;
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::tui::Debugger;
use stickslip::tui::theme::Theme;

/// A debugger on a built-in scene.
fn debugger(scene: &str) -> Debugger {
    let scene = Scene::open(scene, &[]).expect("a built-in scene");
    Debugger::new(Theme::mono(), vec![], Some(Session::new(scene)))
}

/// A screen without the digits that another order of rounding could change: those after the fifth, and all of
/// numbers that are round-off themselves.
fn masked(screen: &str) -> String {
    let mut letters: Vec<char> = screen.chars().collect();
    let mut start = 0;
    while start < letters.len() {
        let number = |c: &char| c.is_ascii_digit() || matches!(c, '.' | 'e' | '-');
        let length = letters[start..].iter().take_while(|c| number(c)).count();
        let text: String = letters[start..start + length].iter().collect();
        let exponent = text
            .rsplit_once('e')
            .and_then(|(_, e)| e.parse::<i32>().ok());
        if let (Some(exponent), Some(point)) = (exponent, text.find('.')) {
            let kept = if exponent < -9 { 0 } else { point + 5 };
            let digits = text.find('e').unwrap_or(length);
            let masked = (start..start + digits)
                .skip(kept)
                .filter(|at| letters[*at].is_ascii_digit());
            masked
                .collect::<Vec<_>>()
                .into_iter()
                .for_each(|at| letters[at] = '#');
        }
        start += length.max(1);
    }
    letters.into_iter().collect()
}

#[test]
fn the_first_scene_at_three_sizes() {
    let mut debugger = debugger("01-pinned-beam-rough-floor");
    debugger.type_keys("5 f s s");
    for (width, height) in [(80, 24), (120, 40), (200, 60)] {
        insta::assert_snapshot!(
            format!("first-{width}x{height}"),
            masked(&debugger.text(width, height))
        );
    }
    debugger.type_keys("e");
    insta::assert_snapshot!("first-explain-120x40", masked(&debugger.text(120, 40)));
}

#[test]
fn the_curve_grows_by_accepted_increments_and_shrinks_on_the_way_back() {
    let mut debugger = debugger("01-pinned-beam-rough-floor");
    let points = |debugger: &Debugger| {
        let session = debugger.session.as_ref().expect("a session");
        curve(&session.frames()[..=session.cursor()], 0)
    };
    assert_eq!(points(&debugger), [[0.0; 2]; 0]);
    debugger.type_keys("3 f");
    let three = points(&debugger);
    assert_eq!(three.len(), 3);
    debugger.type_keys("s");
    assert_eq!(points(&debugger), three);
    debugger.type_keys("S F");
    assert_eq!(points(&debugger), three[..2]);
    debugger.type_keys("f");
    assert_eq!(points(&debugger), three);
}

#[test]
fn stepping_back_shows_the_same_screens() {
    let mut debugger = debugger("01-pinned-beam-rough-floor");
    let mut screens = vec![debugger.text(120, 40)];
    for _ in 0..6 {
        debugger.type_keys("s");
        screens.push(debugger.text(120, 40));
    }
    let panes = |screen: &str| {
        screen
            .lines()
            .skip(3)
            .take(35)
            .map(String::from)
            .collect::<Vec<_>>()
    };
    for screen in screens.iter().rev().skip(1) {
        debugger.type_keys("S");
        assert_eq!(panes(&debugger.text(120, 40)), panes(screen));
    }
    debugger.type_keys("S");
    assert!(debugger.text(120, 40).contains("already at the start"));
}

#[test]
fn a_person_ends_the_oscillation() {
    let mut debugger = debugger("osc-inclined-cantilever");
    debugger.type_keys("c");
    let cycle = debugger.text(120, 40);
    assert!(
        cycle.contains("✗ contact modes repeat with period 2 from minor 1 (beam.5)"),
        "{cycle}"
    );
    debugger.type_keys("m s");
    assert!(debugger.text(120, 40).contains("▸*◇beam.5 fixed → sliding"));
    debugger.type_keys("S m S c");
    let end = debugger.text(120, 40);
    assert!(
        end.contains("✓ load 1 accepted") && end.contains("◆ 1 held"),
        "{end}"
    );
    debugger.type_keys("S M");
    let released = debugger.text(120, 40);
    assert!(!released.contains("◆"), "{released}");
}

#[test]
fn another_increment_starts_the_increment_again() {
    let mut debugger = debugger("osc-inclined-cantilever");
    debugger.type_keys("s s i 0 . 0 1 Enter");
    let again = debugger.text(120, 40);
    assert!(
        again.contains("increment 1   attempt 2   major 1   minor 1   load 0.01"),
        "{again}"
    );
    assert!(again.contains("increment 0.01 (scene: 0.05)"), "{again}");
    debugger.type_keys("i - 1 Enter");
    assert!(debugger.text(120, 40).contains("invalid increment '-1'"));
}

#[test]
fn commands_by_name_reach_the_solver_and_its_refusals_the_screen() {
    let mut debugger = debugger("01-pinned-beam-rough-floor");
    // Among them an alias of beam.5, a value out of range, and a file that is not there.
    for (line, shown) in [
        ("force beam.end fixed", "◇beam.5 fixed"),
        ("friction 20", "friction changed"),
        ("friction 95", "90"),
        ("step 3", "minor 3"),
        ("reverse-step 3", "2 of 5 steps"),
        ("open nowhere.ron", "nowhere.ron"),
        ("open osc-inclined-cantilever", "Inclined cantilever"),
    ] {
        debugger.type_keys(":");
        debugger.type_text(line);
        debugger.type_keys("Enter");
        let screen = debugger.text(120, 40);
        assert!(screen.contains(shown), "after '{line}':\n{screen}");
    }
}

#[test]
fn branches_breakpoints_and_watches_are_told_in_the_message_line() {
    let mut debugger = debugger("osc-inclined-cantilever");
    debugger.type_keys("c");
    for (keys, line, shown) in [
        (
            "b",
            "mode any sliding",
            "breakpoint 1 (any node becomes sliding)",
        ),
        (":", "watch f_n", "f_n beam.5 = -5.75"),
        ("S m s", "", "(in the new branch b2: beam.5 sliding)"),
        ("s", "", "in b2: beam.5 sliding   f_n beam.5 = 0.005"),
        ("[", "", "b1: start (cycle)"),
        ("]", "", "in b2: beam.5 sliding"),
        (
            "b",
            "dance",
            "unknown condition 'dance'; conditions: mode, leaves",
        ),
    ] {
        debugger.type_keys(keys);
        if !line.is_empty() {
            debugger.type_text(line);
            debugger.type_keys("Enter");
        }
        let screen = debugger.text(120, 40);
        assert!(screen.contains(shown), "after '{keys} {line}':\n{screen}");
    }
}
