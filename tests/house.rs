//! The house keeps its floors: who may know whom (see `lib.rs`).

use std::fs;
use std::path::{Path, PathBuf};

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files
}

/// Files under src whose code (not comments) has one of the words, outside the places that may.
fn offenders(words: &[&str], allowed: &[&str]) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    for file in sources(&root) {
        let name = file
            .strip_prefix(&root)
            .unwrap()
            .to_string_lossy()
            .replace('\\', "/");
        if allowed.iter().any(|a| name.starts_with(a)) {
            continue;
        }
        for line in fs::read_to_string(&file).unwrap().lines() {
            let code = line.split("//").next().unwrap_or_default();
            if words.iter().any(|w| code.contains(w)) {
                found.push(format!("{name}: {}", line.trim()));
            }
        }
    }
    found
}

#[test]
fn only_the_terminal_front_end_knows_a_terminal() {
    assert_eq!(offenders(&["ratatui", "crossterm"], &["tui/"]), [""; 0]);
}

#[test]
fn only_linalg_knows_faer() {
    assert_eq!(offenders(&["faer::", "use faer"], &["linalg/"]), [""; 0]);
}

#[test]
fn arrows_point_down_only() {
    let floors = [
        (
            vec!["crate::tui", "crate::cli"],
            vec!["tui/", "cli/", "main.rs", "lib.rs"],
        ),
        (
            vec!["crate::session", "crate::action", "crate::teach"],
            vec![
                "session/", "action/", "teach/", "tui/", "cli/", "main.rs", "lib.rs",
            ],
        ),
        (
            vec!["crate::solve"],
            vec![
                "solve/", "explain/", "history/", "record/", "session/", "action/", "teach/",
                "tui/", "cli/", "study/", "main.rs", "lib.rs",
            ],
        ),
    ];
    for (words, allowed) in floors {
        assert_eq!(offenders(&words, &allowed), [""; 0], "{words:?}");
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/scene");
    for file in sources(&root) {
        let text = fs::read_to_string(&file).unwrap();
        for other in [
            "crate::fem",
            "crate::contact",
            "crate::linalg",
            "crate::solve",
        ] {
            assert!(!text.contains(other), "{} uses {other}", file.display());
        }
    }
}
