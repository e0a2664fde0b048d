//! The manual: its pages show what the program shows, `help` and `:help` show its pages, and `show` what is built in.
//!
//! `README=write cargo test --test files` renews what is made by the program.

use crate::{pages, terminal};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Arc;
use stickslip::action::config::Config;
use stickslip::action::{self, Colours};
use stickslip::manual::render::{WIDTH, render};
use stickslip::manual::{self, PAGES};
use stickslip::scene::{Scene, builtin};
use stickslip::study::{benchmarks, builtin as studies, chart_file};
use stickslip::teach::lesson::LessonStep;
use stickslip::teach::play::play;
use stickslip::teach::{self, Lesson};
use stickslip::tui::{Debugger, theme::Theme};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src/manual/pages")
}

#[test]
fn every_page_shows_what_the_program_shows() {
    for page in PAGES {
        pages::check(&folder().join(format!("{}.md", page.topic)));
    }
}

#[test]
fn every_file_of_the_manual_is_a_page_and_has_one_title() {
    let files = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut names: Vec<_> = files
        .map(|file| file.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    let mut topics: Vec<_> = PAGES.iter().map(|page| page.topic.to_owned()).collect();
    names.sort();
    topics.sort();
    assert_eq!(names, topics);
    for page in PAGES {
        let titles = page
            .text()
            .lines()
            .filter(|line| line.starts_with("# "))
            .count();
        assert!(page.text().starts_with("# "), "{}", page.topic);
        // A comment in a block of code looks like a title.
        assert!(titles >= 1);
        assert!(page.about.len() <= 70, "{}: {}", page.topic, page.about);
    }
}

#[test]
fn every_page_fits_80_columns() {
    for page in PAGES {
        for line in render(page.text(), WIDTH) {
            let text = line.text();
            let wide = unicode_width::UnicodeWidthStr::width(text.trim_end());
            assert!(wide <= WIDTH, "{}: {wide} columns: {text}", page.topic);
        }
    }
}

/// rustdoc takes a block without a language for Rust, and would run it.
#[test]
fn every_block_of_code_names_its_language() {
    for page in PAGES {
        let text = page.text();
        let fences = text.lines().filter(|line| line.starts_with("```"));
        for fence in fences.step_by(2) {
            assert!(
                ["```text", "```sh", "```ron", "```json", "```python", "```c"].contains(&fence),
                "{}: {fence}",
                page.topic
            );
        }
    }
}

#[test]
fn every_command_in_the_manual_can_be_typed() {
    let mut commands = 0;
    for page in PAGES {
        for line in pages::typed(page.text()) {
            if let Some(words) = pages::arguments(&line) {
                commands += 1;
                pages::is_command_line(&words).unwrap_or_else(|error| panic!("{line}: {error}"));
            }
            if let Some(action) = line.strip_prefix(':').filter(|rest| !rest.is_empty()) {
                let name = action.split_whitespace().next().unwrap();
                action::by_name(name)
                    .unwrap_or_else(|error| panic!("{}: {line}: {error}", page.topic));
            }
        }
    }
    assert!(commands > 30, "{commands}");
}

#[test]
fn scenes_studies_and_benches_that_the_manual_names_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for page in PAGES {
        for line in pages::typed(page.text()) {
            let words: Vec<&str> = line.split_whitespace().collect();
            let path = line.split_whitespace().next().unwrap_or_default();
            if ["src/", "tests/", "problems/", "snapshots/"]
                .iter()
                .any(|start| path.starts_with(start))
            {
                assert!(root.join(path).exists(), "{}: {path}", page.topic);
            }
            if let Some(at) = words.iter().position(|word| *word == "--bench") {
                let file = format!("tests/benches/{}.rs", words[at + 1]);
                assert!(root.join(&file).exists(), "{}: {file}", page.topic);
            }
            if let ["stickslip", "study", name, ..] = words[..]
                && name.starts_with(|c: char| c.is_ascii_lowercase())
            {
                let builtin = studies::find(name).is_some() || name == benchmarks::BUILTIN;
                assert!(builtin || root.join(name).exists(), "{line}");
            }
        }
    }
}

/// The names of the source in the theory page's table of symbols.
#[test]
fn every_symbol_leads_to_a_name_in_the_source() {
    let mut sources = String::new();
    read(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("src"),
        &mut sources,
    );
    let text = manual::page("theory").unwrap().text();
    let rows = text
        .lines()
        .skip_while(|line| !line.starts_with("| paper |"))
        .skip(2);
    let rows: Vec<&str> = rows.take_while(|line| line.starts_with('|')).collect();
    assert!(rows.len() > 15);
    for row in rows {
        let name = row.trim_end_matches([' ', '|']).rsplit('`').nth(1).unwrap();
        let (of, field) = name.split_once("::").unwrap_or(("", name));
        let defined = |name: &str| {
            let ways = ["struct ", "enum ", "pub fn "].map(|way| format!("{way}{name}"));
            ways.iter().any(|way| sources.contains(way))
        };
        let there = match of {
            "" => defined(field),
            of => defined(of) && sources.contains(&format!("pub {field}:")),
        };
        assert!(there, "{row}");
    }
}

fn read(folder: &Path, into: &mut String) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            read(&path, into);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            *into += &fs::read_to_string(path).unwrap();
        }
    }
}

/// The RON examples of a page.
fn examples(topic: &str) -> Vec<&'static str> {
    let text: &str = manual::page(topic).unwrap().text();
    let blocks = text.split("```ron\n").skip(1);
    blocks
        .map(|after| after.split("```").next().unwrap())
        .collect()
}

#[test]
fn the_lesson_in_the_manual_plays_through() {
    let examples = examples("lessons");
    let lesson = Lesson::from_text("lessons.md", examples[0]).unwrap_or_else(|e| panic!("{e}"));
    let answers = play(&Arc::new(lesson)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(answers.len(), 4);
}

#[test]
fn the_keys_and_colours_in_the_manual_can_be_read() {
    let examples = examples("keys");
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("keys.ron", examples[0]), ("debugger.ron", examples[1])] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let config = Config::from(folder.path()).unwrap_or_else(|e| panic!("{e}"));
    let name = |key| config.keymap.by_key(key).map(|entry| entry.name);
    assert_eq!((name("j"), name(">")), (Some("step"), None));
    assert_eq!(
        (config.colours, config.mouse),
        (Some(Colours::Light), false)
    );
}

#[test]
fn the_scenes_in_the_manual_are_sound_and_converge() {
    // The others are parts of scenes.
    let whole = |text: &&&str| text.starts_with("(\n    title:");
    let examples = examples("scenes");
    let scenes: Vec<_> = examples.iter().filter(whole).collect();
    assert_eq!(scenes.len(), 2);
    for text in scenes {
        let scene = Scene::from_text("scenes.md", text, &[]).unwrap_or_else(|e| panic!("{e}"));
        let mut stepper = stickslip::step::stepper::Stepper::new(Arc::new(scene.model));
        while let Some(event) = stepper.step() {
            if let stickslip::step::event::Outcome::Failed(failure) = &event.outcome {
                panic!("{failure:?}");
            }
        }
    }
}

fn stickslip(words: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    program.args(words).stdin(Stdio::null()).output().unwrap()
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn err(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn help_lists_the_pages_and_shows_one_as_plain_text_where_there_is_no_terminal() {
    let listed = stickslip(&["help"]);
    assert_eq!(listed.status.code(), Some(0));
    for page in PAGES {
        let line = |line: &str| line.trim().starts_with(page.topic) && line.ends_with(page.about);
        assert!(out(&listed).lines().any(line), "{}", page.topic);
        let shown = stickslip(&["help", page.topic]);
        assert_eq!(shown.status.code(), Some(0));
        let expected: Vec<String> = render(page.text(), WIDTH)
            .iter()
            .map(|line| line.plain())
            .collect();
        assert_eq!(out(&shown), expected.join("\n") + "\n", "{}", page.topic);
        assert!(!out(&shown).contains('\u{1b}'));
    }
}

#[test]
fn help_of_a_subcommand_is_still_that_subcommand_s() {
    for name in ["run", "map", "help", "show"] {
        let help = stickslip(&["help", name]);
        assert_eq!(help.status.code(), Some(0));
        assert_eq!(out(&help), out(&stickslip(&[name, "--help"])));
        assert!(out(&help).contains(&format!("Usage: stickslip {name}")));
    }
}

#[test]
fn a_topic_that_there_is_not_is_answered_with_the_nearest() {
    let help = stickslip(&["help", "stratgies"]);
    assert_eq!((help.status.code(), out(&help)), (Some(2), String::new()));
    assert!(
        err(&help).contains("did you mean \"strategies\"?"),
        "{}",
        err(&help)
    );
}

#[test]
fn a_search_names_topic_heading_and_line() {
    let found = stickslip(&["help", "--search", "sliding_least"]);
    assert_eq!(found.status.code(), Some(0));
    let text = out(&found);
    assert!(
        text.contains("strategies: Strategies\n    - sliding_least: both.\n"),
        "{text}"
    );
    assert!(text.contains("settings: Settings\n"), "{text}");
    let none = stickslip(&["help", "--search", "no page says so"]);
    assert_eq!((none.status.code(), out(&none)), (Some(2), String::new()));
}

#[test]
fn a_reader_that_has_seen_enough_of_a_page_is_no_error() {
    let mut program = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    let mut child = program
        .args(["help", "scenes"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let ended = child.wait_with_output().unwrap();
    assert_eq!((ended.status.code(), err(&ended)), (Some(0), String::new()));
}

#[test]
fn show_prints_what_is_built_in_byte_for_byte() {
    for scene in builtin::list() {
        let folder = match scene.name.starts_with("bench-") {
            true => "problems/benchmarks",
            false => "problems",
        };
        let file = format!("{}/{folder}/{}.ron", env!("CARGO_MANIFEST_DIR"), scene.name);
        assert_eq!(
            stickslip(&["show", scene.name]).stdout,
            fs::read(file).unwrap()
        );
    }
    assert_eq!(
        out(&stickslip(&["show", benchmarks::BUILTIN])),
        benchmarks::builtin_text()
    );
    let study = studies::list()[0];
    assert_eq!(out(&stickslip(&["show", study.name])), study.text);
    let lesson = teach::list()[0];
    assert_eq!(out(&stickslip(&["show", lesson.name])), lesson.text);
    let name = chart_file::names().next().unwrap();
    assert_eq!(
        out(&stickslip(&["show", "--chart", name])),
        chart_file::text(name).unwrap()
    );
}

#[test]
fn show_writes_a_file_but_never_over_another_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.ron");
    let path = file.to_str().unwrap();
    assert_eq!(
        stickslip(&["show", "osc-two6", "-o", path]).status.code(),
        Some(0)
    );
    assert_eq!(
        fs::read_to_string(&file).unwrap(),
        builtin::find("osc-two6").unwrap().text.to_owned()
    );
    let again = stickslip(&["show", "osc-two3", "-o", path]);
    assert_eq!(again.status.code(), Some(2));
    assert!(err(&again).contains("--force"), "{}", err(&again));
    assert_eq!(
        fs::read_to_string(&file).unwrap(),
        builtin::find("osc-two6").unwrap().text.to_owned()
    );
    assert_eq!(
        stickslip(&["show", "osc-two3", "-o", path, "--force"])
            .status
            .code(),
        Some(0)
    );
    assert_eq!(
        fs::read_to_string(&file).unwrap(),
        builtin::find("osc-two3").unwrap().text.to_owned()
    );
}

#[test]
fn what_show_does_not_know_is_answered_with_the_nearest() {
    let shown = stickslip(&["show", "osc-two7"]);
    assert_eq!((shown.status.code(), out(&shown)), (Some(2), String::new()));
    assert!(
        err(&shown).contains("did you mean \"osc-two"),
        "{}",
        err(&shown)
    );
    let chart = stickslip(&["show", "--chart", "osc-two6"]);
    assert_eq!(chart.status.code(), Some(2));
}

/// A debugger on a scene, with these lines typed at `:` and keys after them.
fn page(lines: &[&str], keys: &str) -> Debugger {
    let scene = Scene::open("osc-two6", &[]).unwrap();
    let mut debugger = Debugger::new(
        Theme::mono(),
        Vec::new(),
        Some(stickslip::session::Session::new(scene)),
    );
    for line in lines {
        debugger.type_keys(":");
        debugger.type_text(line);
        debugger.type_keys("Enter");
    }
    debugger.type_keys(keys);
    debugger
}

#[test]
fn a_page_in_the_debugger_looks_so() {
    for (width, height) in [(80, 24), (120, 40), (200, 60)] {
        let shown = page(&["help strategies"], "").text(width, height);
        insta::assert_snapshot!(format!("page-{width}x{height}"), shown);
    }
    insta::assert_snapshot!(
        "searched-80x24",
        page(&["help theory"], "/ ρ Enter").text(80, 24)
    );
}

#[test]
fn a_page_in_the_debugger_scrolls_searches_turns_and_is_left() {
    let first = |debugger: &Debugger| {
        debugger
            .text(80, 24)
            .lines()
            .nth(4)
            .unwrap_or_default()
            .trim_end()
            .to_owned()
    };
    let top = |debugger: &Debugger| {
        let text = debugger.text(80, 24);
        let title = text
            .lines()
            .find(|line| line.contains("Manual: "))
            .unwrap_or_default()
            .to_owned();
        title
            .split_whitespace()
            .find_map(|word| word.split_once('/')?.0.parse::<usize>().ok())
            .unwrap_or(0)
    };
    assert_eq!(
        top(&page(&["help theory"], "")),
        1,
        "{}",
        first(&page(&["help theory"], ""))
    );
    assert_eq!(top(&page(&["help theory"], "j j Down")), 4);
    assert_eq!(top(&page(&["help theory"], "j j k Up")), 1);
    assert_eq!(top(&page(&["help theory"], "PageDown")), 17);
    assert_eq!(top(&page(&["help theory"], "PageDown PageUp")), 1);
    assert_eq!(top(&page(&["help theory"], "End Home")), 1);
    assert!(
        page(&["help theory"], "Right")
            .text(80, 24)
            .contains("Manual: verification")
    );
    assert!(
        page(&["help tour"], "Left")
            .text(80, 24)
            .contains("Manual: changes")
    );
    let missed = page(&["help theory"], "/ z z z q Enter").text(80, 24);
    assert!(missed.contains("no match for 'zzzq'"), "{missed}");
    for key in ["Esc", "q"] {
        let left = page(&["help theory"], key).text(80, 24);
        assert!(
            left.contains("Slave nodes") && !left.contains("Manual:"),
            "{left}"
        );
    }
    let told = page(&["help teory"], "").text(80, 24);
    assert!(told.contains("did you mean \"theory\"?"), "{told}");
    assert!(
        page(&["help"], "")
            .text(80, 24)
            .contains("The first ten keys")
    );
}

#[test]
fn topics_complete() {
    let context = action::Context::default();
    assert_eq!(
        action::complete("help st", &context),
        ["help strategies", "help studies"]
    );
    assert_eq!(
        action::complete("help maps", &context),
        ["help maps-and-charts"]
    );
}

#[test]
fn pages_are_read_in_a_real_terminal() {
    let mut session = terminal::open("osc-two6");
    session.type_and_see(":help str\t\r", "Manual: strategies");
    session.type_and_see(" ", "17/");
    session.type_and_see("/least increment\r", "least increment");
    session.type_and_see("\x1b", "Slave nodes");
    session.type_and_see("?", "Move through the iterations");
    session.keys("?");
    session.see("Slave nodes");
    session.quit();
}

#[test]
fn on_a_terminal_the_pager_shows_a_page_and_without_one_it_is_printed() {
    let bold = |screen: &vt100::Screen| {
        screen
            .cell(0, 0)
            .is_some_and(|cell| cell.bold() && cell.underline())
    };
    let start = |pager| terminal::Start::debugger(&["help", "settings"]).variable("PAGER", pager);
    let mut paged = start("head -n 3; echo the pager ran").go();
    paged.see("the pager ran");
    assert!(paged.screen(bold));
    assert!(paged.end().success());
    let mut missing = start("no-such-pager").go();
    missing.see("Notes");
    assert!(missing.end().success());
    let mut plain = start("head -n 3").variable("NO_COLOR", "1").go();
    plain.see("Settings");
    assert!(!plain.screen(bold));
    assert!(plain.end().success());
}

#[test]
fn the_exercise_on_the_judge_finds_a_broken_law_that_shrinks_with_the_increment() {
    let page = stickslip::manual::page("teaching").unwrap().text();
    let typed = pages::typed(page);
    let audit = typed
        .iter()
        .find(|line| line.starts_with("stickslip audit 0"));
    let finer = typed
        .iter()
        .find(|line| line.starts_with("--set history.increment"));
    let amount = |more: &str| -> f64 {
        let words = format!("{} {more}", audit.unwrap());
        let audited = std::process::Command::new(env!("CARGO_BIN_EXE_stickslip"))
            .args(words.split_whitespace().skip(1))
            .output()
            .unwrap();
        let table = String::from_utf8(audited.stdout).unwrap();
        let broken: Vec<&str> = table.lines().filter(|row| row.contains("BROKEN")).collect();
        assert_eq!(broken.len(), 1, "{table}");
        let cells: Vec<&str> = broken[0].split_whitespace().collect();
        assert_eq!(cells[0], "slip", "{table}");
        cells[1].parse().unwrap()
    };
    let ratio = amount("") / amount(finer.unwrap());
    assert!((3.5..4.5).contains(&ratio), "{ratio}");
}

#[test]
fn each_topic_of_the_theory_has_a_lesson_and_each_lesson_a_session() {
    let text = |name: &str| stickslip::manual::page(name).unwrap().text();
    let (teaching, theory) = (text("teaching"), text("theory"));
    let (_, topics) = teaching.split_once("| topic | lesson |").unwrap();
    let rows: Vec<(&str, &str)> = topics
        .lines()
        .filter_map(|line| {
            line.strip_prefix("| ")?
                .strip_suffix("` |")?
                .split_once(" | `")
        })
        .collect();
    let headings = theory.lines().filter_map(|line| line.strip_prefix("## "));
    for heading in headings.filter(|heading| *heading != "Symbols") {
        let found = rows.iter().find(|(topic, _)| heading.starts_with(topic));
        let (_, lesson) = found.unwrap_or_else(|| panic!("no lesson for {heading}"));
        assert!(stickslip::teach::lesson::find(lesson).is_some(), "{lesson}");
    }
    let (sessions, _) = teaching.split_once("## Prepare").unwrap();
    for lesson in stickslip::teach::lesson::list() {
        let named = format!("`{}`", lesson.name);
        assert!(sessions.contains(&named), "{named}");
    }
}

/// The minutes of a lesson by the rule on page `teaching`.
fn minutes(lesson: &Lesson) -> f64 {
    let text = teach::find(&lesson.name).unwrap().text;
    let (_, steps) = text.split_once("steps:").unwrap();
    let quoted = steps.split('"').skip(1).step_by(2);
    let words: usize = quoted.map(|text| text.split_whitespace().count()).sum();
    let step = |step: &LessonStep| match step {
        LessonStep::Text(_) => 0.0,
        LessonStep::Press { .. } => 0.25,
        LessonStep::Ask(_) => 1.0,
        LessonStep::Predict { right, .. } => f64::from(*right),
        LessonStep::Reach(_) => 4.0,
    };
    words as f64 / 120.0 + lesson.steps.iter().map(step).sum::<f64>()
}

#[test]
fn sessions_of_the_course_have_90_minutes_and_lessons_for_their_share() {
    let teaching = manual::page("teaching").unwrap().text();
    let cells = |line: &str| -> Vec<String> {
        let cells = line.trim_matches('|').split('|');
        cells.map(|cell| cell.trim().to_owned()).collect()
    };
    let rows = |columns: usize| -> Vec<Vec<String>> {
        let rows = teaching
            .lines()
            .filter(|line| line.starts_with("| "))
            .map(cells);
        rows.filter(|row| row.len() == columns && row[0].parse::<u32>().is_ok())
            .collect()
    };
    let (sessions, plans) = (rows(5), rows(4));
    assert_eq!((sessions.len(), plans.len()), (6, 6));
    for (session, plan) in sessions.iter().zip(&plans) {
        let plan: Vec<f64> = plan[1..].iter().map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(plan.iter().sum::<f64>(), 90.0);
        let lessons = session[2]
            .split(", ")
            .map(|name| Lesson::open(name.trim_matches('`')));
        let needed: f64 = lessons.map(|lesson| minutes(&lesson.unwrap())).sum();
        assert!((needed - plan[1]).abs() <= 5.0, "{session:?}: {needed}");
        assert!(
            teach::find(session[3].trim_matches('`')).is_some(),
            "{session:?}"
        );
    }
}
