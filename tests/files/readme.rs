//! The README shows what the program shows: its screens and key list are generated, its scene is sound.
//!
//! `README=write cargo test --test readme` renews them.

use std::fs;
use std::sync::Arc;
use stickslip::scene::Scene;
use stickslip::teach::{Lesson, play::play};
use stickslip::tui::{Debugger, theme::Theme};

const README: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/README.md");

/// The README with the part between each marker and its end made anew.
fn renewed(readme: &str) -> String {
    let mut text = String::new();
    let mut skipping = false;
    for line in readme.lines() {
        if line == "<!-- end -->" {
            skipping = false;
        }
        if !skipping {
            text += line;
            text.push('\n');
        }
        if let Some(what) = line.strip_prefix("<!-- screen ") {
            text += &screen(what.trim_end_matches(" -->"));
            skipping = true;
        } else if let Some(what) = line.strip_prefix("<!-- lesson ") {
            text += &lesson_screen(what.trim_end_matches(" -->"));
            skipping = true;
        } else if line == "<!-- keys -->" {
            text += &format!("\n{}\n", stickslip::action::markdown().trim_end());
            skipping = true;
        }
    }
    text
}

/// `WIDTHxHEIGHT SCENE: KEYS` as a fenced picture of the program's own buffer.
fn screen(what: &str) -> String {
    let (size, rest) = what.split_once(' ').unwrap();
    let (scene, keys) = rest.split_once(": ").unwrap();
    let (width, height) = size.split_once('x').unwrap();
    let picture =
        stickslip::tui::screen(scene, keys, width.parse().unwrap(), height.parse().unwrap())
            .unwrap();
    fenced(&picture)
}

/// `WIDTHxHEIGHT LESSON: KEYS`, likewise.
fn lesson_screen(what: &str) -> String {
    let (size, rest) = what.split_once(' ').unwrap();
    let (name, keys) = rest.split_once(": ").unwrap();
    let (width, height) = size.split_once('x').unwrap();
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), None);
    debugger.teach(Lesson::open(name).unwrap());
    debugger.type_keys(keys);
    fenced(&debugger.text(width.parse().unwrap(), height.parse().unwrap()))
}

fn fenced(picture: &str) -> String {
    let lines: Vec<&str> = picture.lines().map(str::trim_end).collect();
    format!("```text\n{}\n```\n", lines.join("\n").trim_end())
}

#[test]
fn screens_and_keys_in_the_readme_are_those_of_the_program() {
    let readme = fs::read_to_string(README).unwrap();
    let expected = renewed(&readme);
    if std::env::var("README").as_deref() == Ok("write") {
        fs::write(README, &expected).unwrap();
    }
    assert!(
        readme == expected,
        "renew it: README=write cargo test --test readme"
    );
}

/// The RON example that has these words in it.
fn example<'a>(readme: &'a str, words: &str) -> &'a str {
    let examples = readme.split("```ron\n").skip(1);
    let mut texts = examples.map(|after| after.split("```").next().unwrap());
    texts.find(|text| text.contains(words)).unwrap()
}

#[test]
fn the_lesson_in_the_readme_plays_through() {
    let readme = fs::read_to_string(README).unwrap();
    let text = example(&readme, "Pulled, not pushed");
    let lesson = Lesson::from_text("README.md", text).unwrap_or_else(|e| panic!("{e}"));
    let answers = play(&Arc::new(lesson)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(answers.len(), 3);
}

#[test]
fn the_scenes_in_the_readme_are_sound_and_converge() {
    let readme = fs::read_to_string(README).unwrap();
    // Others are parts of scenes, or lessons.
    let whole =
        |block: &&str| block.starts_with("(\n    title:") && !block.contains("\n    steps: [");
    let blocks: Vec<&str> = readme.split("```ron\n").skip(1).filter(whole).collect();
    assert_eq!(blocks.len(), 2);
    for block in blocks {
        let text = block.split("```").next().unwrap();
        let scene = Scene::from_text("README.md", text, &[]).unwrap_or_else(|e| panic!("{e}"));
        let mut stepper = stickslip::step::stepper::Stepper::new(std::sync::Arc::new(scene.model));
        while let Some(event) = stepper.step() {
            if let stickslip::step::event::Outcome::Failed(failure) = &event.outcome {
                panic!("{failure:?}");
            }
        }
    }
}
