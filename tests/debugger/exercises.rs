//! Exercise sheets and hand-ins: the solver's answers are those found by hand, and a class table counts what was handed in.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use stickslip::teach::play::{AnsweredQuestion, play};
use stickslip::teach::{Lesson, lesson};

fn answered(name: &str) -> Vec<AnsweredQuestion> {
    let lesson = Lesson::open(name).unwrap_or_else(|e| panic!("{e}"));
    play(&Arc::new(lesson)).unwrap_or_else(|e| panic!("{e}"))
}

/// The answers of a sheet: numbers as such, others in words.
fn answers(name: &str) -> Vec<String> {
    let answered = answered(name).into_iter();
    answered.map(|answered| answered.answer).collect()
}

fn assert_numbers(answers: &[String], by_hand: &[(usize, f64)]) {
    for (question, expected) in by_hand {
        let found: f64 = answers[*question].replace('−', "-").parse().unwrap();
        assert!(
            (found - expected).abs() <= 6e-4 * expected.abs(),
            "question {}: {found}, by hand {expected}",
            question + 1
        );
    }
}

/// Springs of stiffness 2, loads (1.6, −2) and (0.2, −2), gap 0.5, μ = 0.5.
#[test]
fn sheet_1_is_solved_as_by_hand() {
    let answers = answers("sheet-1");
    let (k, gap, mu) = (2.0, 0.5, 0.5);
    let f_n = 2.0 - k * gap;
    let touched_at = 1.6 / k * (gap / (2.0 / k));
    let slip = (1.6 - mu * f_n) / k - touched_at;
    assert_numbers(
        &answers,
        &[
            (0, gap - 2.0 / k),
            (2, f_n),
            (3, 1.6 - k * touched_at),
            (6, slip),
        ],
    );
    assert_eq!([answers[1].as_str(), &answers[5]], ["fixed", "fixed"]);
    assert!(answers[4].contains("sliding"), "{answers:?}");
}

/// λ of contact, F_n, slip of one increment, F_t after reversal, λ of slip back.
#[test]
fn sheet_2_is_solved_as_by_hand() {
    let f_n = |load: f64| 2.0 * load - 1.0;
    let sliding = |load: f64| (1.6 * load - 0.5 * f_n(load)) / 2.0;
    let held = 2.0 * sliding(1.0);
    assert_numbers(
        &answers("sheet-2"),
        &[
            (0, 0.5),
            (1, f_n(1.0)),
            (2, sliding(1.0) - sliding(0.75)),
            (3, 1.6 * 0.75 - held),
            // 1.6 λ − held = −0.5 (2 λ − 1)
            (4, (held + 0.5) / 2.6),
        ],
    );
}

/// Compliance [2 1; 1 2]/3: a fixed point by direct iteration.
#[test]
fn sheet_3_is_solved_as_by_hand() {
    let next = |f_n: f64| (1.0 - 0.5 - 0.5 * f_n / 3.0) * 1.5;
    let converged = (0..60).fold(0.5, |f_n, _| next(f_n));
    let factor = (next(0.6 + 1e-3) - next(0.6)) / 1e-3;
    let answers = answers("sheet-3");
    assert_numbers(
        &answers,
        &[(0, 0.5), (1, next(0.5)), (2, factor), (3, converged)],
    );
    assert!(answers[4].starts_with("1 (It is accepted"), "{answers:?}");
}

/// The states of one node with u = W F + free motion, counted by trying each.
#[test]
fn sheet_4_counts_the_states_that_a_trial_of_each_mode_finds() {
    let (c_n, c_t) = (-0.1, -0.6);
    let count = |mu: f64| {
        let free = usize::from(c_n < 0.0);
        let (f_n, f_t) = (2.0 * c_n - c_t, 2.0 * c_t - c_n);
        let fixed = usize::from(f_n > 0.0 && f64::abs(f_t) < mu * f_n);
        let slides = |sign: f64| {
            let f_n = c_n / ((2.0 + sign * mu) / 3.0);
            let v_t = c_t - f_n / 3.0 - 2.0 / 3.0 * sign * mu * f_n;
            usize::from(f_n > 0.0 && v_t * sign > 0.0)
        };
        free + fixed + slides(1.0) + slides(-1.0)
    };
    let by_hand = [0.5, 2.7, 2.8].map(|mu| count(mu).to_string());
    assert_eq!(answers("sheet-4"), by_hand);
}

#[test]
fn sheet_5_names_the_law_that_each_state_breaks() {
    let found = answers("sheet-5");
    let laws = ["Every law holds.", "Cone.", "Slip.", "Tension."];
    assert_eq!(found.len(), laws.len());
    for (answer, law) in found.iter().zip(laws) {
        assert!(answer.contains(law), "{answer}: {law}");
    }
}

/// The third run has a third of the error of the second, as the first two suggest, and not a quarter, as theory does.
#[test]
fn sheet_6_has_the_order_that_the_third_run_shows() {
    let lesson = Lesson::open("sheet-6").unwrap();
    let answered = play(&Arc::new(lesson)).unwrap();
    let errors = |text: &str| -> Vec<f64> {
        let words = text.split_whitespace();
        let words = words.map(|word| word.trim_end_matches(['.', ',', ':']));
        let numbers = words.filter_map(|word| word.parse().ok());
        numbers.filter(|number| *number < 0.01).collect()
    };
    let [coarse, medium] = errors(&answered[0].before[0])[..] else {
        panic!("{:?}", answered[0].before)
    };
    let finest = errors(&answered[0].then)[0];
    for ratio in [coarse / medium, medium / finest] {
        assert!((ratio.log2() - 1.6).abs() < 0.15, "{ratio}");
    }
    assert!(answered[0].answer.starts_with('1'));
}

#[test]
fn every_sheet_is_printed_with_all_questions_and_no_answer() {
    for sheet in lesson::sheets() {
        let printed = stdout(&["lesson", sheet.name, "--sheet"], Path::new("."));
        assert!(
            printed.lines().all(|line| line.chars().count() <= 80),
            "{printed}"
        );
        for (number, asked) in (1..).zip(answered(sheet.name)) {
            assert!(printed.contains(&format!("\n{number}. ")), "{printed}");
            let first = asked.question.split_whitespace().next().unwrap();
            assert!(printed.contains(first));
            assert!(
                !printed.contains("Right:") && !printed.contains('✓'),
                "{printed}"
            );
        }
    }
}

/// Standard output of the program, with this folder as home.
fn stdout(arguments: &[&str], home: &Path) -> String {
    let output = run(arguments, home);
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn run(arguments: &[&str], home: &Path) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(arguments)
        .env("XDG_STATE_HOME", home)
        .env("HOME", home)
        .current_dir(home)
        .output()
        .unwrap()
}

#[test]
fn what_is_handed_in_is_counted_in_the_table_of_the_class() {
    let home = tempfile::tempdir().unwrap();
    let nothing = run(&["lesson", "--work", "ada.work"], home.path());
    assert_eq!(nothing.status.code(), Some(2), "{nothing:?}");
    let folder = home.path().join("stickslip");
    fs::create_dir(&folder).unwrap();
    let answer = |step: u32, right: bool| {
        format!("(step: {step}, word: \"x\", right: {right}, counts: true, seconds: 30)")
    };
    let write = |name: &str, second: bool, ended: u32| {
        let given = [answer(2, true), answer(4, second)].join(", ");
        let lesson = format!(
            "(steps: 8, of: 8, ended: {ended}, right: 1, asked: 2, given: [{given}], seconds: 610)"
        );
        let text =
            format!("(format: 1, lessons: {{ \"modes\": {lesson}, \"mine.ron\": {lesson} }})");
        fs::write(folder.join("lessons.ron"), text).unwrap();
        stdout(&["lesson", "--work", name], home.path());
    };
    write("ada.work", true, 1);
    write("ben.work", false, 0);
    let again = run(&["lesson", "--work", "ben.work"], home.path());
    assert_eq!(again.status.code(), Some(2), "{again:?}");
    assert!(String::from_utf8_lossy(&again.stderr).contains("--force"));
    let table = stdout(
        &["lesson", "--collect", "ada.work", "ben.work"],
        home.path(),
    );
    insta::assert_snapshot!(table, @r"
    student  finished  right  minutes
    ada             2    4/4  21
    ben             0    2/4  21

    lesson    finished  right  minutes  most missed
    modes       1 of 2    3/4       21  step 5, by 1 of 2
    mine.ron    1 of 2    3/4       21  step 5, by 1 of 2
    ");
    let none = run(&["lesson", "--collect", "eva.work"], home.path());
    assert_eq!(none.status.code(), Some(2), "{none:?}");
    // One file that is none does not cost the others their table.
    fs::write(home.path().join("foreign.work"), b"\xff{").unwrap();
    fs::copy(home.path().join("ada.work"), home.path().join("copy.work")).unwrap();
    fs::write(
        home.path().join("scene.ron"),
        "(title: \"t\", nodes: [], bodies: [])",
    )
    .unwrap();
    let files = [
        "lesson",
        "--collect",
        "foreign.work",
        "ada.work",
        "copy.work",
        "scene.ron",
    ];
    let mixed = run(&files, home.path());
    assert_eq!(mixed.status.code(), Some(2), "{mixed:?}");
    assert!(String::from_utf8_lossy(&mixed.stdout).contains("\nada "));
    let errors = String::from_utf8_lossy(&mixed.stderr).into_owned();
    assert!(
        errors.contains("foreign.work") && errors.contains("3 of 4 files"),
        "{errors}"
    );
    assert!(
        errors.contains("copy.work: the work of ada, which another file has"),
        "{errors}"
    );
    assert!(
        errors.contains("this is a scene; `stickslip lesson --work"),
        "{errors}"
    );
}

#[test]
fn a_lesson_is_taken_on_a_scene_of_the_students_own() {
    let lesson = Lesson::open_on("cure", "osc-lag4").unwrap();
    assert_eq!(lesson.name, "cure on osc-lag4");
    assert_eq!(lesson.scene.name, "osc-lag4");
    let other = Lesson::open_on("by-hand", "osc-two6")
        .unwrap_err()
        .to_string();
    assert!(other.contains("beam.end"), "{other}");
}
