//! The house keeps its floors: who may know whom, as each `lib.rs` has it, and how much may stand in one place.
//!
//! Imports are read from the code itself ([`imports`]). What is not reached yet is listed by name, and a list that says
//! too much fails as one that says too little.

mod imports;
mod mutants;
mod words;

use imports::{Package, Sources, Ties, circles};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The packages, each with its folder.
const PACKAGES: &[Package] = &[
    Package {
        name: "stickslip",
        folder: "src",
        others: &[
            "attach", "core", "debugger", "exchange", "linalg", "manual", "platform", "scene",
            "study", "tui",
        ],
    },
    Package {
        name: "stickslip_linalg",
        folder: "src/linalg",
        others: &[],
    },
    Package {
        name: "stickslip_core",
        folder: "src/core",
        others: &[],
    },
    Package {
        name: "stickslip_exchange",
        folder: "src/exchange",
        others: &[],
    },
    Package {
        name: "stickslip_platform",
        folder: "src/platform",
        others: &[],
    },
    Package {
        name: "stickslip_scene",
        folder: "src/scene",
        others: &[],
    },
    Package {
        name: "stickslip_study",
        folder: "src/study",
        others: &[],
    },
    Package {
        name: "stickslip_manual",
        folder: "src/manual",
        others: &[],
    },
    Package {
        name: "stickslip_debugger",
        folder: "src/debugger",
        others: &[],
    },
    Package {
        name: "stickslip_attach",
        folder: "src/attach",
        others: &[],
    },
    Package {
        name: "stickslip_tui",
        folder: "src/tui",
        others: &[],
    },
];

/// The sentence before a list of floors in a `lib.rs`.
const FLOORS: &str = "ach takes only from those above it";
/// Most lines of a file.
const MOST_LINES: usize = 700;
/// Largest part of all lines that a folder below a package may have.
const MOST_PART: f64 = 0.15;

/// Folders in which files still import each other in a circle.
const CIRCULAR_YET: &[&str] = &[];
/// Files that are still longer than they may be.
const LONG_YET: &[&str] = &[];
/// Folders that still have more than their part of all lines.
const LARGE_YET: &[&str] = &[];

fn top() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn house() -> Sources {
    Sources::read(top(), PACKAGES)
}

/// The package that a file belongs to, and the folder in it, or the module beside its folders: `src` and `tui` of
/// `src/tui/app.rs`. None for the file that opens a package, and the one that only starts the program.
fn place(file: &str) -> Option<(&'static str, &str)> {
    let package = |package: &&Package| file.starts_with(&format!("{}/", package.folder));
    let packages = PACKAGES.iter().filter(package);
    let folder = packages
        .map(|package| package.folder)
        .max_by_key(|folder| folder.len())?;
    let rest = file[folder.len() + 1..].trim_end_matches(".rs");
    let name = rest.split('/').next().unwrap_or(rest);
    let opens = ["lib", "main", "mod", "build"].contains(&name);
    (!opens).then_some((folder, name))
}

/// The same as one path: `src/tui`.
fn folder_of(file: &str) -> Option<String> {
    place(file).map(|(package, name)| format!("{package}/{name}"))
}

/// The floors that the text of a `lib.rs` lists, from the ground up: its lines that begin with a link to a module.
fn floors(text: &str) -> Vec<String> {
    let name = |line: &str| {
        let (name, _) = line.strip_prefix("//! - [`")?.split_once("`]")?;
        Some(name.to_owned())
    };
    text.lines().filter_map(name).collect()
}

/// Ties within a package that go up from a folder to one above it, or from or to one that is not on the list.
fn upward(ties: &Ties, package: &str, floors: &[String]) -> Vec<String> {
    let floor = |file: &str| {
        let (_, name) = place(file).filter(|(own, _)| *own == package)?;
        Some(floors.iter().position(|floor| floor == name))
    };
    let goes_up = |(from, to): &(String, String)| match (floor(from), floor(to)) {
        (Some(from), Some(to)) => from.is_none() || to.is_none() || from < to,
        _ => false,
    };
    let up = ties.iter().filter(|(pair, _)| goes_up(pair));
    up.map(|((from, to), names)| format!("{from} takes {names:?} from {to}"))
        .collect()
}

fn folders(files: &[&str]) -> BTreeSet<String> {
    files.iter().filter_map(|file| folder_of(file)).collect()
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let found = circles(&house().ties());
    let mut yet = BTreeSet::new();
    for circle in &found {
        let files: Vec<&str> = circle.iter().map(String::as_str).collect();
        let folders = folders(&files);
        let known = folders
            .iter()
            .all(|folder| CIRCULAR_YET.contains(&folder.as_str()));
        assert!(known, "{circle:#?}");
        yet.extend(folders);
    }
    assert_eq!(
        yet.iter().collect::<Vec<_>>(),
        CIRCULAR_YET,
        "too much is listed"
    );
}

#[test]
fn arrows_of_use_only_point_down_the_list_in_lib_rs() {
    let house = house();
    let ties = house.ties();
    for package in PACKAGES {
        let lib = top().join(package.folder).join("lib.rs");
        let Ok(text) = fs::read_to_string(lib) else {
            continue;
        };
        if !text.contains(FLOORS) {
            continue;
        }
        let floors = floors(&text);
        assert!(floors.len() > 2, "{floors:?}");
        assert_eq!(upward(&ties, package.folder, &floors), [""; 0]);
        let places = house.lines().filter_map(|(file, _)| place(file));
        let own: BTreeSet<&str> = places
            .filter(|(own, _)| *own == package.folder)
            .map(|(_, name)| name)
            .collect();
        let homeless = own
            .iter()
            .filter(|name| !floors.iter().any(|floor| floor == *name));
        assert_eq!(homeless.collect::<Vec<_>>(), [&""; 0], "on no floor");
    }
}

#[test]
fn only_the_terminal_front_end_knows_a_terminal() {
    // The page draws the same screens, and Windows has a console instead of a terminal.
    let others = [
        ("ratatui", "src/web/"),
        ("crossterm", "src/platform/windows_terminal.rs"),
        ("tui_input", "src/tui/"),
    ];
    for (terminal, other) in others {
        let house = house();
        let files = house.that_name(terminal);
        assert!(!files.is_empty(), "{terminal}");
        let others: Vec<_> = files
            .iter()
            .filter(|file| !file.starts_with("src/tui/") && !file.starts_with(other))
            .collect();
        assert_eq!(others, [&""; 0], "{terminal}");
    }
}

#[test]
fn only_linalg_knows_faer() {
    let house = house();
    let files = house.that_name("faer");
    assert!(!files.is_empty());
    let others: Vec<_> = files
        .iter()
        .filter(|file| !file.starts_with("src/linalg/"))
        .collect();
    assert_eq!(others, [&""; 0]);
}

#[test]
fn panes_know_the_brush_and_not_each_other() {
    let ties = house().ties();
    let pane = |file: &str| file.starts_with("src/tui/panes/") && !file.ends_with("mod.rs");
    let wrong =
        |(from, to): &&(String, String)| pane(from) && (pane(to) || to == "src/tui/screen.rs");
    assert_eq!(ties.keys().find(wrong), None);
}

#[test]
fn no_file_is_longer_than_a_reader_can_hold() {
    let house = house();
    let long = house.lines().filter(|(_, lines)| *lines > MOST_LINES);
    let mut long: Vec<&str> = long.map(|(file, _)| file).collect();
    long.sort_unstable();
    assert_eq!(long, LONG_YET);
}

#[test]
fn no_folder_below_a_package_has_more_than_its_part_of_all_lines() {
    let house = house();
    assert_eq!(large(house.lines()), LARGE_YET);
}

fn large<'a>(lines: impl Iterator<Item = (&'a str, usize)>) -> Vec<String> {
    let mut folders: BTreeMap<String, usize> = BTreeMap::new();
    let mut all = 0;
    for (file, lines) in lines {
        all += lines;
        if let Some(folder) = folder_of(file) {
            *folders.entry(folder).or_default() += lines;
        }
    }
    let most = MOST_PART * all as f64;
    let large = folders
        .into_iter()
        .filter(|(_, lines)| *lines as f64 > most);
    large.map(|(folder, _)| folder).collect()
}

/// A house of made-up files under `src`.
fn made(files: &[(&str, &str)]) -> Sources {
    let mut sources = Sources::default();
    for (file, text) in files {
        sources.add("stickslip", "src", file, text);
    }
    sources
}

fn tied(files: &[(&str, &str)]) -> Vec<String> {
    let ties = made(files).ties();
    let told = ties.iter().map(|((from, to), names)| {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        format!("{from} {to} {}", names.join(","))
    });
    told.collect()
}

#[test]
fn a_tie_is_seen_however_it_is_written() {
    let below = ("b.rs", "pub struct One; pub fn two() {}");
    let lib = ("lib.rs", "pub mod a; pub mod b;");
    for text in [
        "use crate::b::{One, two};",
        "use crate::{b::{self as c, One}}; fn f() { c::two() }",
        "use super::b; fn f() -> b::One { b::two() }",
        "fn f() -> crate::b::One { crate::b::two() }",
        "mod tests { use super::super::b::{One, two}; }",
        "mod tests { use super::*; fn f() -> crate::b::One { crate::b::two() } }",
    ] {
        assert_eq!(
            tied(&[lib, below, ("a.rs", text)]),
            ["src/a.rs src/b.rs One,two"],
            "{text}"
        );
    }
    assert_eq!(
        tied(&[lib, below, ("a.rs", "use crate::b::*;")]),
        ["src/a.rs src/b.rs *"]
    );
}

#[test]
fn what_is_no_code_and_what_is_of_others_ties_nothing() {
    let lib = ("lib.rs", "pub mod a; pub mod b;");
    for text in [
        "// crate::b::One",
        "/* use /* crate::b::One */ crate::b::One; */",
        "const A: &str = \"crate::b::One\"; const B: char = '\"'; const C: &str = r#\" \" crate::b::One \"#;",
        "use std::b::One; fn f<'a>(x: &'a u8) -> One { b::one() }",
        "use crate::b;",
    ] {
        assert_eq!(
            tied(&[lib, ("b.rs", "pub struct One;"), ("a.rs", text)]),
            [""; 0],
            "{text}"
        );
    }
}

#[test]
fn a_name_that_is_handed_on_ties_to_where_it_comes_from() {
    let lib = ("lib.rs", "pub mod a; pub mod b;");
    let b = (
        "b/mod.rs",
        "pub mod c; mod d; pub use c::One; pub use d::*; pub struct Own;",
    );
    let (c, d) = (
        ("b/c.rs", "pub struct One;"),
        ("b/d.rs", "pub mod e; pub struct Handed;"),
    );
    let e = ("b/d/e.rs", "pub struct Deep;");
    let a = ("a.rs", "use crate::b::{Handed, One, Own, e::Deep};");
    assert_eq!(
        tied(&[lib, a, b, c, d, e]),
        [
            "src/a.rs src/b/c.rs One",
            "src/a.rs src/b/d.rs Handed",
            "src/a.rs src/b/d/e.rs Deep",
            "src/a.rs src/b/mod.rs Own",
            "src/b/mod.rs src/b/c.rs One",
            "src/b/mod.rs src/b/d.rs *",
        ]
    );
}

#[test]
fn a_circle_is_found_and_a_chain_is_none() {
    let lib = ("lib.rs", "pub mod a; pub mod b; pub mod c; pub mod d;");
    let (a, b) = (
        ("a.rs", "use crate::b::B; pub struct A;"),
        ("b.rs", "use crate::c::C; pub struct B;"),
    );
    let d = ("d.rs", "use crate::a::A;");
    let chain = made(&[lib, a, b, ("c.rs", "pub struct C;"), d]);
    assert!(circles(&chain.ties()).is_empty());
    let round = made(&[lib, a, b, ("c.rs", "use crate::a::A; pub struct C;"), d]);
    let found = circles(&round.ties());
    let wanted: BTreeSet<String> = ["src/a.rs", "src/b.rs", "src/c.rs"]
        .map(String::from)
        .into();
    assert_eq!(found, [wanted]);
}

#[test]
fn an_arrow_up_and_a_folder_on_no_floor_are_found() {
    let text = "//! Map:\n//!\n//! - [`ground`]: low.\n//! - [`roof`]: high.\n\npub mod ground;";
    let floors = floors(text);
    assert_eq!(floors, ["ground", "roof"]);
    let ground = ("ground/mod.rs", "pub struct Stone;");
    let roof = ("roof/mod.rs", "use crate::ground::Stone; pub struct Tile;");
    let lib = ("lib.rs", text);
    let up = |files: &[(&str, &str)]| upward(&made(files).ties(), "src", &floors);
    assert_eq!(up(&[lib, ground, roof]), [""; 0]);
    let wrong = ("ground/wall.rs", "use crate::roof::Tile;");
    assert_eq!(up(&[lib, ground, roof, wrong]).len(), 1);
    let unknown = ("shed/mod.rs", "use crate::ground::Stone;");
    assert_eq!(up(&[lib, ground, roof, unknown]).len(), 1);
}

#[test]
fn foreign_crates_and_large_folders_are_found() {
    let house = made(&[
        ("a/b.rs", "use ratatui::text::Line;"),
        ("c.rs", "fn f() { ratatui::init() }"),
        ("d.rs", "// ratatui::"),
    ]);
    assert_eq!(
        house.that_name("ratatui").into_iter().collect::<Vec<_>>(),
        ["src/a/b.rs", "src/c.rs"]
    );
    let files = [("src/a/b.rs", 86), ("src/c/d.rs", 14), ("src/lib.rs", 0)];
    assert_eq!(large(files.into_iter()), ["src/a"]);
}

/// "Stability" is that of equilibrium; a map shows where runs converge.
#[test]
fn the_word_stability_is_kept_for_equilibrium() {
    let mut folders = vec![
        top().join("src"),
        top().join("problems"),
        top().join("tests"),
    ];
    let mut misused = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let kind = path.extension().and_then(|kind| kind.to_str());
            match kind {
                None if path.is_dir() => folders.push(path),
                Some("rs" | "md" | "ron" | "txt" | "py") => {
                    let text = fs::read_to_string(&path).unwrap().to_lowercase();
                    let map = ["stability", "map"].join(" ");
                    if text.contains(&map) {
                        misused.push(path);
                    }
                }
                _ => {}
            }
        }
    }
    assert!(misused.is_empty(), "{misused:?}");
}
