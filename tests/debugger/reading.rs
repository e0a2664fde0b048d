//! Lessons on small screens and over several sessions: nothing that is said is missed, a zoomed pane leaves the lesson where
//! it is, and what was done is kept.

use crate::common;
use ratatui::layout::Rect;
use std::path::Path;
use std::process::Command;
use stickslip::action::{Action, Ui};
use stickslip::session::Session;
use stickslip::teach::lesson::LessonStep;
use stickslip::teach::progress::Progress;
use stickslip::teach::{self, Lesson, Tutor};
use stickslip::tui::Debugger;
use stickslip::tui::chooser_state;
use stickslip::tui::theme::Theme;

/// The debugger at the beginning of a built-in lesson, on a screen of this size.
fn taught(name: &str, width: u16, height: u16) -> Debugger {
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), None);
    debugger.app.area = Rect::new(0, 0, width, height);
    debugger.teach(Lesson::open(name).unwrap(), None);
    debugger
}

fn tutor(debugger: &Debugger) -> &Tutor {
    debugger.app.learning.lesson.as_ref().unwrap()
}

fn shown(debugger: &Debugger) -> String {
    let Rect { width, height, .. } = debugger.app.area;
    debugger.text(width, height)
}

/// Does what the present step of a lesson wants, as a person does it; wrong answers first, so that there is the most to read.
fn go_on(debugger: &mut Debugger) {
    let line = |debugger: &mut Debugger, line: &str| {
        debugger.type_keys(":");
        debugger.type_text(line);
        debugger.type_keys("Enter");
    };
    let step = tutor(debugger).step().cloned().unwrap();
    match (step, tutor(debugger).solution()) {
        (LessonStep::Press { action, how, .. }, _) => {
            match how.strip_prefix("type :") {
                Some(how) => line(debugger, how.split_once(" and Enter").unwrap().0),
                None => {
                    let how = how.strip_prefix("press ").unwrap();
                    let key = how.split_once(' ').unwrap().0;
                    let digits = key.len() - key.trim_start_matches(char::is_numeric).len();
                    let (count, key) = key.split_at(digits);
                    count
                        .chars()
                        .for_each(|digit| debugger.type_keys(&digit.to_string()));
                    debugger.type_keys(key);
                }
            }
            if matches!(action, Action::Ui(Ui::Chart(_))) {
                debugger.type_keys("Ctrl-c Esc");
            }
        }
        (LessonStep::Ask(_), Some(word)) => line(debugger, &format!("answer {word}")),
        (LessonStep::Predict { .. }, _) => line(debugger, "step"),
        _ => debugger.type_keys("Space"),
    }
}

#[test]
fn all_that_a_lesson_says_was_shown_before_it_goes_on() {
    for (width, height) in [(80, 24), (60, 18), (200, 60)] {
        for builtin in teach::list() {
            let mut debugger = taught(builtin.name, width, height);
            let mut missing: Vec<String> = Vec::new();
            let (mut at, mut keys) = (usize::MAX, 0);
            loop {
                let tutor = tutor(&debugger);
                // From a task on, the keys are the user's.
                if matches!(
                    tutor.step(),
                    None | Some(LessonStep::Predict { .. } | LessonStep::Reach(_))
                ) {
                    break;
                }
                if tutor.at() != at {
                    assert_eq!(missing, [""; 0], "{} step {at}", builtin.name);
                    at = tutor.at();
                    missing = tutor
                        .text()
                        .replace('$', "")
                        .split(' ')
                        .map(String::from)
                        .collect();
                }
                // Words that stand on the screen now are seen.
                let screen = shown(&debugger);
                missing.retain(|word| !screen.contains(word.as_str()));
                let turns = screen.contains("▼ Space: more");
                match turns {
                    true => debugger.type_keys("Space"),
                    false => go_on(&mut debugger),
                }
                keys += 1;
                assert!(keys < 300, "{} hangs in step {at}:\n{screen}", builtin.name);
            }
        }
    }
}

#[test]
fn what_was_not_read_is_not_passed_over() {
    let mut debugger = taught("modes", 60, 12);
    assert!(
        shown(&debugger).contains("▼ Space: more"),
        "{}",
        shown(&debugger)
    );
    debugger.type_keys("Space");
    assert_eq!(tutor(&debugger).at(), 0);
    while tutor(&debugger).at() < 2 {
        debugger.type_keys("Space");
    }
    // At a size at which the question needs a second page, its answer waits for that.
    let mut debugger = taught("several-answers", 50, 12);
    while tutor(&debugger).at() < 2 {
        match shown(&debugger).contains("▼ Space") {
            true => debugger.type_keys("Space"),
            false => go_on(&mut debugger),
        }
    }
    let mut debugger = taught("by-hand", 40, 9);
    while tutor(&debugger).at() < 1 {
        debugger.type_keys("Space");
    }
    debugger.type_keys("a");
    assert!(
        shown(&debugger).contains("the lesson text continues"),
        "{}",
        shown(&debugger)
    );
    while shown(&debugger).contains("▼ Space") {
        debugger.type_keys("Space");
    }
    debugger.type_keys("Backspace");
    assert!(
        shown(&debugger).contains("lines 1 to "),
        "{}",
        shown(&debugger)
    );
    debugger.type_keys("a - 0 . 0 6 Enter");
    assert!(shown(&debugger).contains("✓ Right"), "{}", shown(&debugger));
}

#[test]
fn a_zoomed_pane_leaves_the_lesson_where_it_is() {
    for (width, height) in [(80, 24), (120, 40), (200, 60)] {
        let mut debugger = taught("table-2", width, height);
        debugger.type_keys("Space e");
        let zoomed = shown(&debugger);
        assert!(
            zoomed.contains("┏ Decision") && !zoomed.contains("Slave nodes"),
            "{zoomed}"
        );
        // The words may wrap.
        let words = zoomed.replace(['│', '┃'], " ");
        let words: Vec<&str> = words.split_whitespace().collect();
        assert!(words.join(" ").contains("The same key"), "{zoomed}");
        assert!(zoomed.contains("▶ press e (explain)"), "{zoomed}");
        debugger.type_keys("z e");
        // The other way out of the zoom, then the key that was wanted.
        assert_eq!(tutor(&debugger).at(), 3);
        assert!(shown(&debugger).contains("▶ press f (finish)"));
        for keys in ["t", "z", "d"] {
            debugger.type_keys(keys);
            assert!(shown(&debugger).contains("▶ press f (finish)"), "{keys}");
        }
    }
}

#[test]
fn what_was_done_of_the_lessons_is_kept_and_listed() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("deep/lessons.ron");
    let begin = |name: &str| {
        let mut debugger = taught(name, 120, 40);
        debugger.keep_progress_in(file.clone());
        debugger
    };
    let done = |name: &str| Progress::read(&file).unwrap().of(name).map(|of| of.words());
    let mut debugger = begin("oscillation");
    debugger.type_keys("Space s");
    assert_eq!(done("oscillation").as_deref(), Some("step 3 of 12"));
    assert_eq!(done("modes"), None);
    // To its end, with one wrong answer.
    debugger
        .type_keys("a s a x Space a f Space a 2 Space c a 1 Enter Space m s s a s Space c Space");
    assert_eq!(done("oscillation").as_deref(), Some("done, 4/5 right"));
    // A later, shorter visit takes nothing away; another lesson stands beside it.
    begin("oscillation").type_keys("Space");
    begin("modes").type_keys("Space Space");
    assert_eq!(done("oscillation").as_deref(), Some("done, 4/5 right"));
    assert_eq!(done("modes").as_deref(), Some("step 3 of 14"));
    let progress = Progress::read(&file).unwrap();
    let offers = chooser_state::offers(&progress);
    let offer = offers.iter().find(|offer| offer.name == "oscillation");
    let reached = offer.unwrap().reached.clone().unwrap();
    assert_eq!(reached.words(), "done, 4/5 right");
    // The chooser ticks what is finished, and nothing else.
    let mut chooser = Debugger::new(Theme::mono(), offers, None);
    chooser.type_text("lessons");
    chooser.settle();
    let screen = chooser.text(120, 40);
    let row = |name: &str| screen.lines().find(|row| row.contains(name)).unwrap();
    assert!(row("oscillation").contains("✓ done, 4/5 right"), "{screen}");
    assert!(row("modes").contains("step 3 of 14"), "{screen}");
    assert_eq!(screen.matches('✓').count(), 1, "{screen}");
    // Nothing is left beside it, and what is no such file is said and stays.
    assert_eq!(
        std::fs::read_dir(home.path().join("deep")).unwrap().count(),
        1
    );
    std::fs::write(&file, "no such thing").unwrap();
    let mut debugger = begin("modes");
    debugger.type_keys("Space");
    assert!(
        shown(&debugger).contains("lessons.ron:1"),
        "{}",
        shown(&debugger)
    );
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "no such thing");
}

#[test]
fn the_list_of_lessons_tells_what_was_done() {
    let home = tempfile::tempdir().unwrap();
    let list = |home: &Path| {
        let output = Command::new(env!("CARGO_BIN_EXE_stickslip"))
            .arg("lesson")
            .env("XDG_STATE_HOME", home)
            .env("HOME", home)
            .output()
            .unwrap();
        let told = [output.stdout, output.stderr].concat();
        (output.status.code(), String::from_utf8(told).unwrap())
    };
    let (code, fresh) = list(home.path());
    assert!(code == Some(0) && !fresh.contains("step "), "{fresh}");
    let folder = home.path().join("stickslip");
    let mut debugger = taught("modes", 80, 24);
    debugger.keep_progress_in(folder.join("lessons.ron"));
    debugger.type_keys("Space Space Space");
    let (code, told) = list(home.path());
    let first = told.lines().next().unwrap();
    assert!(
        code == Some(0) && first.contains("step 3 of 14") && first.contains("What a mode is"),
        "{told}"
    );
    std::fs::write(folder.join("lessons.ron"), "(").unwrap();
    let (code, told) = list(home.path());
    assert!(code == Some(2) && told.contains("lessons.ron"), "{told}");
}

#[test]
fn no_row_jumps_while_one_steps() {
    // Where the panes' borders stand, over steps with short and long outcomes and messages.
    for scene in [
        "osc-inclined-cantilever",
        "osc-two6",
        "01-pinned-beam-rough-floor",
    ] {
        for (width, height) in [(80, 24), (120, 40), (200, 60)] {
            let scene = common::scene(scene, &[]);
            let mut debugger = Debugger::new(Theme::mono(), Vec::new(), Some(Session::new(scene)));
            debugger.app.area = Rect::new(0, 0, width, height);
            let corners = |debugger: &Debugger| -> Vec<usize> {
                let screen = shown(debugger);
                let rows = screen.lines().enumerate();
                let below = |row: &str| row.starts_with('└') || row.starts_with('┗');
                rows.filter(|(_, row)| below(row))
                    .map(|(at, _)| at)
                    .collect()
            };
            let first = corners(&debugger);
            assert!(first.len() >= 2, "{}", shown(&debugger));
            for keys in [
                "s",
                "s",
                "s",
                "n",
                "c",
                "s",
                "F",
                "m s",
                "s",
                "c",
                ": f o o Enter",
            ] {
                debugger.type_keys(keys);
                // The last row may lie under a long message; what is above must not move.
                let now = corners(&debugger);
                let same = now.iter().zip(&first).take_while(|(a, b)| a == b).count();
                assert!(same + 1 >= first.len(), "{keys}: {}", shown(&debugger));
            }
        }
    }
}
