//! What README and manual show of the program: the part between each marker and its end is made by the program.

mod scene_reference;

use std::fs;
use std::path::Path;
use stickslip::scene::joined;
use stickslip::teach::Lesson;
use stickslip::tui::{Debugger, theme::Theme};

/// Compares a file with what the program says now, or renews it where `README=write` asks for that.
pub fn check(file: &Path) {
    let text = fs::read_to_string(file).unwrap();
    let expected = renewed(&text);
    if std::env::var("README").as_deref() == Ok("write") {
        fs::write(file, &expected).unwrap();
        return;
    }
    let same = text == expected;
    assert!(
        same,
        "{}: renew it: README=write cargo test --test files",
        file.display()
    );
}

/// A text with what stands between each marker and its end made anew.
fn renewed(text: &str) -> String {
    let mut renewed = String::new();
    let mut skipping = false;
    for line in text.lines() {
        if line == "<!-- end -->" {
            assert!(skipping, "an end without a marker");
            skipping = false;
        }
        if !skipping {
            renewed += &counted(line);
            renewed.push('\n');
        }
        let marker = line
            .strip_prefix("<!-- ")
            .and_then(|rest| rest.strip_suffix(" -->"));
        if let Some(made) = marker.and_then(made) {
            assert!(!skipping, "a marker before the end of another: {line}");
            renewed += &made;
            skipping = true;
        }
    }
    assert!(!skipping, "a marker without an end");
    renewed
}

/// What a marker stands for.
fn made(marker: &str) -> Option<String> {
    let (kind, what) = marker.split_once(' ').unwrap_or((marker, ""));
    let list = |text: String| Some(format!("\n{}\n\n", text.trim_end()));
    match kind {
        "screen" => Some(screen(what)),
        "lesson" => Some(lesson(what)),
        "python" => Some(python(what)),
        "keys" => list(stickslip::action::markdown()),
        "commands" => list(commands(stickslip::cli::program())),
        "records" => list(stickslip::cli::json_records()),
        "reference" => list(scene_reference::types().unwrap()),
        "settings" => list(scene_reference::settings().unwrap()),
        "keywords" => list(keywords()),
        "causes" => list(causes()),
        "packages" => list(packages()),
        "modules" => list(modules(what)),
        "topics" => {
            let pages = stickslip::manual::PAGES.iter();
            let rows = pages.map(|page| {
                format!(
                    "- [{0}](src/manual/pages/{0}.md): {1}\n",
                    page.topic, page.about
                )
            });
            list(rows.collect())
        }
        _ => None,
    }
}

/// A line with its numbers made anew: each between `<!-- number of WHAT -->` and `<!-- end -->`.
fn counted(line: &str) -> String {
    const MARKER: &str = "<!-- number of ";
    let mut pieces = line.split(MARKER);
    let mut made = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (what, rest) = piece.split_once(" -->").unwrap();
        let (_, after) = rest.split_once("<!-- end -->").unwrap();
        made += &format!("{MARKER}{what} -->{}<!-- end -->{after}", count(what));
    }
    made
}

/// How many there are, of what the program has.
fn count(what: &str) -> usize {
    match what {
        "lessons" => stickslip::teach::list().len(),
        "strategies" => stickslip::model::Strategy::ALL.len(),
        "scenes" => stickslip::scene::builtin::list().len(),
        "pages" => stickslip::manual::PAGES.len(),
        "examples" => {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/examples");
            let files = fs::read_dir(folder)
                .unwrap()
                .map(|file| file.unwrap().path());
            files
                .filter(|file| file.extension().is_some_and(|end| end == "rs"))
                .count()
        }
        _ => panic!("a number of {what} is not counted"),
    }
}

fn at_the_top(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

/// The packages under `src`, those that use others first: folder, description, packages used.
fn packages() -> String {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let folders = fs::read_dir(top).unwrap().map(|entry| entry.unwrap());
    let mut packages: Vec<(String, String, Vec<String>)> = folders
        .filter(|entry| entry.path().join("Cargo.toml").exists())
        .map(|entry| {
            let folder = entry.file_name().into_string().unwrap();
            let text = at_the_top(&format!("src/{folder}/Cargo.toml"));
            let about = text
                .lines()
                .find_map(|line| line.strip_prefix("description = "));
            let (_, dependencies) = text.split_once("[dependencies]").unwrap();
            let used = dependencies.lines().filter_map(|line| {
                let name = line.strip_prefix("stickslip-")?;
                name.split(['.', ' ']).next().map(String::from)
            });
            (
                folder,
                about.unwrap().trim_matches('"').to_owned(),
                used.collect(),
            )
        })
        .collect();
    packages.sort();
    let mut ordered: Vec<(String, String, Vec<String>)> = Vec::new();
    while !packages.is_empty() {
        let is_used = |name: &String| packages.iter().any(|(_, _, used)| used.contains(name));
        let free = packages
            .iter()
            .position(|(name, ..)| !is_used(name))
            .unwrap();
        ordered.push(packages.remove(free));
    }
    let row = |(folder, about, used): &(String, String, Vec<String>)| {
        let used: Vec<String> = used.iter().map(|name| format!("`{name}`")).collect();
        let uses = match used.is_empty() {
            true => String::new(),
            false => format!(" Uses {}.", used.join(", ")),
        };
        format!("- `{folder}`: {about}.{uses}\n")
    };
    ordered.iter().map(row).collect()
}

/// The list of modules at the head of a package's `lib.rs`, from the top down.
fn modules(package: &str) -> String {
    let text = at_the_top(&format!("src/{package}/lib.rs"));
    let docs = text.lines().map_while(|line| line.strip_prefix("//!"));
    let mut items: Vec<String> = Vec::new();
    for line in docs {
        match line.strip_prefix(" - [`") {
            Some(item) => {
                let (name, rest) = item.split_once("`]").unwrap();
                let rest = rest.trim_start_matches(|c| c != ':');
                items.push(format!(
                    "- `{name}`{}",
                    rest.replace("[`", "`").replace("`]", "`")
                ));
            }
            None if line.starts_with("   ") && !items.is_empty() => {
                let text = line.trim().replace("[`", "`").replace("`]", "`");
                items.last_mut().unwrap().push_str(&format!("\n  {text}"));
            }
            None => {}
        }
    }
    items.join("\n")
}

/// The keywords of decks, by what becomes of them.
fn keywords() -> String {
    use stickslip_exchange::inp::keywords::{KEYWORDS, Treatment};
    let line = |(name, treatment): &(&str, Treatment)| match treatment {
        Treatment::Read("", _) => format!("- `{name}`: read\n"),
        Treatment::Read(how, _) => format!("- `{name}`: read: {how}\n"),
        Treatment::Ignored(why) => format!("- `{name}`: passed over: {why}\n"),
        Treatment::Refused(why) => format!("- `{name}`: refused: {why}\n"),
    };
    KEYWORDS.iter().map(line).collect()
}

/// All subcommands with their arguments and options, for the manual.
fn commands(mut program: clap::Command) -> String {
    program.build();
    let mut text = String::new();
    for command in std::iter::once(&program).chain(program.get_subcommands()) {
        let name = match command.get_name() {
            "stickslip" => "stickslip [SCENE]".to_owned(),
            name => format!("stickslip {name}"),
        };
        let about = command
            .get_about()
            .map(ToString::to_string)
            .unwrap_or_default();
        text += &format!("## {name}\n\n{}.\n\n", about.trim_end_matches('.'));
        for argument in command
            .get_arguments()
            .filter(|argument| argument.get_id() != "help")
        {
            let help = argument
                .get_help()
                .map(ToString::to_string)
                .unwrap_or_default();
            text += format!("- `{}`: {help}", written(argument)).trim_end_matches([':', ' ']);
            text.push('\n');
        }
        text = text.trim_end().to_owned() + "\n\n";
    }
    text.trim_end().to_owned() + "\n"
}

/// An argument as it is typed.
fn written(argument: &clap::Arg) -> String {
    let takes = argument.get_action().takes_values();
    let values = joined(
        argument
            .get_value_names()
            .unwrap_or_default()
            .iter()
            .filter(|_| takes)
            .map(clap::builder::Str::as_str),
        " ",
    );
    let short = argument.get_short().map(|short| format!("-{short}"));
    let long = argument.get_long().map(|long| format!("--{long}"));
    let flags = joined(short.into_iter().chain(long), ", ");
    format!("{flags} {values}").trim().to_owned()
}

/// The decks that fail in CalculiX: what happened, the diagnosis, the cure, and what happens with it.
fn causes() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/calculix");
    let rows = super::causes::rows().into_iter().map(|row| {
        let run = super::causes::run(&root, &row.deck);
        let found = &run.findings[0];
        let ccx = format!("{} → {}", row.outcome, row.cured);
        format!(
            "- `{}` ({ccx}). {}: {}. Cure: {}\n",
            row.deck,
            found.rule,
            found.cause,
            found.advice()
        )
    });
    rows.collect()
}

/// `WIDTHxHEIGHT NAME: KEYS`.
fn parts(what: &str) -> (u16, u16, &str, &str) {
    let (size, rest) = what.split_once(' ').unwrap();
    let (name, keys) = rest.split_once(": ").unwrap();
    let (width, height) = size.split_once('x').unwrap();
    (width.parse().unwrap(), height.parse().unwrap(), name, keys)
}

/// A fenced picture of the program's own buffer.
fn screen(what: &str) -> String {
    let (width, height, scene, keys) = parts(what);
    fenced(&stickslip::tui::screen(scene, keys, width, height).unwrap())
}

/// The same of a lesson.
fn lesson(what: &str) -> String {
    let (width, height, name, keys) = parts(what);
    let mut debugger = Debugger::new(Theme::mono(), Vec::new(), None);
    debugger.teach(Lesson::open(name).unwrap(), None);
    debugger.type_keys(keys);
    fenced(&debugger.text(width, height))
}

/// A program of this repository as it stands.
fn python(file: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    format!(
        "```python\n{}```\n",
        fs::read_to_string(root.join(file)).unwrap()
    )
}

fn fenced(picture: &str) -> String {
    let lines: Vec<&str> = picture.lines().map(str::trim_end).collect();
    format!("```text\n{}\n```\n", lines.join("\n").trim_end())
}

/// What a reader may type: lines of `sh` blocks, and code within lines.
pub fn typed(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut fence: Option<&str> = None;
    for line in text.lines() {
        match (fence, line.strip_prefix("```")) {
            (None, Some(language)) => fence = Some(language),
            (Some(_), Some(_)) => fence = None,
            (Some("sh"), None) => match found.last_mut() {
                Some(last) if last.ends_with('\\') => {
                    last.pop();
                    *last += line.trim();
                }
                _ => found.push(
                    line.split(" #")
                        .next()
                        .unwrap_or_default()
                        .trim()
                        .to_owned(),
                ),
            },
            (Some(_), None) => {}
            (None, None) => found.extend(line.split('`').skip(1).step_by(2).map(str::to_owned)),
        }
    }
    found
}

/// The arguments, where a line calls the program.
pub fn arguments(line: &str) -> Option<Vec<&str>> {
    let rest = line.strip_prefix("cargo run --release --").or_else(|| {
        let rest = line.strip_prefix("stickslip")?;
        (rest.is_empty() || rest.starts_with(' ')).then_some(rest)
    })?;
    let words = rest.split_whitespace();
    // What stands behind is the shell's.
    let mut words: Vec<&str> = words.take_while(|word| *word != ">").collect();
    // A subcommand that is only named need not have what it takes.
    if let [_] | [_, "--csv" | "--json" | "--junit"] = words[..] {
        words.truncate(1);
        words.push("--help");
    }
    Some(words)
}

/// Checks a command line without running it; `words` follow the program's name.
pub fn is_command_line(words: &[&str]) -> Result<(), String> {
    let words = std::iter::once("stickslip").chain(words.iter().copied());
    match stickslip::cli::program().try_get_matches_from(words) {
        Err(error) if error.use_stderr() => Err(error.to_string()),
        _ => Ok(()),
    }
}
