//! Completion of paths.

use std::path::Path;
use stickslip_platform::disk;
use stickslip_scene::shown;

/// Maximum number of completions, and of folder entries read.
const MOST: usize = 200;
const LOOKED_AT: usize = 5000;

/// Completions of a path, as they would be typed, sorted: files with one of these extensions (any, if the list
/// is empty), and folders with a trailing `/`. Hidden names only if the dot was typed.
pub(super) fn beginning_with(word: &str, endings: &[&str]) -> Vec<String> {
    let (folder, begun) = match word.rfind('/') {
        Some(slash) => word.split_at(slash + 1),
        None => ("", word),
    };
    let place = if folder.is_empty() { "." } else { folder };
    let Ok(entries) = disk::read_dir(Path::new(place)) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for entry in entries.take(LOOKED_AT).filter_map(Result::ok) {
        let Ok(name) = entry.file_name().into_string() else {
            continue;
        };
        let hidden = name.starts_with('.') && !begun.starts_with('.');
        // Names with control characters cannot be typed.
        if !name.starts_with(begun) || hidden || name.contains(shown::is_order) {
            continue;
        }
        match disk::metadata(entry.path()) {
            Ok(entry) if entry.is_dir() => found.push(format!("{folder}{name}/")),
            Ok(entry) if entry.is_file() && ends_with(&name, endings) => {
                found.push(format!("{folder}{name}"));
            }
            _ => {}
        }
    }
    found.sort();
    found.truncate(MOST);
    found
}

fn ends_with(name: &str, endings: &[&str]) -> bool {
    let own = Path::new(name).extension().and_then(|own| own.to_str());
    endings.is_empty() || own.is_some_and(|own| endings.contains(&own))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_files_with_spaces_complete() {
        let place = tempfile::tempdir().unwrap();
        std::fs::create_dir(place.path().join("my scenes")).unwrap();
        for file in [
            "my scene.ron",
            "my.dat",
            "my.txt",
            ".hidden.ron",
            "my scenes/a.ron",
        ] {
            std::fs::write(place.path().join(file), "").unwrap();
        }
        let at = |rest: &str| format!("{}/{rest}", place.path().display());
        let found = |rest: &str, endings: &[&str]| beginning_with(&at(rest), endings);
        assert_eq!(
            found("my", &["ron", "dat"]),
            [at("my scene.ron"), at("my scenes/"), at("my.dat")]
        );
        assert_eq!(found("my scenes/", &["ron"]), [at("my scenes/a.ron")]);
        assert_eq!(found("", &["ron"]), [at("my scene.ron"), at("my scenes/")]);
        assert_eq!(found(".h", &["ron"]), [at(".hidden.ron")]);
        assert_eq!(found("my.t", &[]), [at("my.txt")]);
        assert!(found("none/", &[]).is_empty());
    }
}
