//! Plain language: few of the phrases that the style avoids in comments, strings and the manual, type names that are unique within
//! a package, and types with few methods.

use super::{imports::rust_files, top};
use std::collections::BTreeMap;
use std::fs;

/// Phrases to avoid, lowercase.
const AVOIDED: &str = "tell|tells|told|of its own|of their own|anew|goes on|go on|went on|gone on|for ever|hang on|hangs on|at hand|\
    no more than it|stand in|stand at|stand for|stand under|stand there|stands in|stands at|stands for|stands under|stands below|stands there|\
    come to|comes to|came to|is said|are said|say so|says so|whoever|who asks|who wants|who has|who cannot|who is|what comes|what stands|\
    what there|beside|so many|one a line|one a major|one a head|one a node|one a file|one a key|parted|there are not yet|led to|\
    looked at|as far as|in vain|twice over|beaten";
/// Largest number of them per 1,000 words.
const MOST_PER_THOUSAND: f64 = 0.5;
/// Maximum number of methods of a type.
const MOST_METHODS: usize = 60;
/// Largest number of type names that a package, or several, define more than once.
const MOST_DUPLICATES: usize = 2;

/// The words of the comments and strings of a Rust file, without its inline tests.
fn text_of(source: &str) -> String {
    let mut text = String::new();
    let mut lines = source.lines().map(str::trim).peekable();
    while let Some(line) = lines.next() {
        if line == "#[cfg(test)]" && lines.peek().is_some_and(|next| next.starts_with("mod ")) {
            break;
        }
        if let Some(comment) = line.strip_prefix("//") {
            text += comment.trim_start_matches(['/', '!', ' ']);
        } else {
            let strings = line.split('"').skip(1).step_by(2);
            for string in strings.filter(|string| string.contains(' ')) {
                text += string;
                text.push(' ');
            }
        }
        text.push(' ');
    }
    text
}

/// The number of words of a text, and of avoided phrases in it.
fn count(text: &str) -> (usize, usize) {
    let plain: String = text
        .to_lowercase()
        .chars()
        .map(|c| if c.is_alphanumeric() { c } else { ' ' })
        .collect();
    let plain: Vec<&str> = plain.split_whitespace().collect();
    let plain = format!(" {} ", plain.join(" "));
    let phrases = AVOIDED.split('|').map(|phrase| format!(" {phrase} "));
    let hits = phrases.map(|phrase| plain.matches(&phrase).count()).sum();
    (text.split_whitespace().count(), hits)
}

/// `src/PACKAGE`, or `src/core/FOLDER`.
fn folder_of(file: &str) -> String {
    let parts: Vec<&str> = file.split('/').collect();
    let depth = if parts[0] == "core" && parts.len() > 2 {
        2
    } else {
        1
    };
    parts[..depth.min(parts.len() - 1).max(1)].join("/")
}

#[test]
fn comments_and_strings_are_in_plain_english() {
    let mut folders: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    let src = top().join("src");
    for file in rust_files(&src, &[]) {
        if file.ends_with("tests.rs") {
            continue;
        }
        let (words, hits) = count(&text_of(&fs::read_to_string(src.join(&file)).unwrap()));
        let entry = folders.entry(folder_of(&file)).or_default();
        *entry = (entry.0 + words, entry.1 + hits);
    }
    let pages = fs::read_dir(src.join("manual/pages")).unwrap();
    let pages = pages.map(|page| fs::read_to_string(page.unwrap().path()).unwrap());
    folders.insert("manual/pages".into(), count(&pages.collect::<String>()));
    let readme = fs::read_to_string(top().join("README.md")).unwrap();
    folders.insert("README.md".into(), count(&readme));
    let rate = |(words, hits): (usize, usize)| 1000.0 * hits as f64 / words.max(1) as f64;
    // A file or two of few words may have one.
    let wrong = |counts: &(usize, usize)| counts.1 > 1 && rate(*counts) > MOST_PER_THOUSAND;
    let stilted: Vec<_> = folders.iter().filter(|(_, counts)| wrong(counts)).collect();
    assert!(stilted.is_empty(), "{stilted:?}");
}

/// The files of all packages: package, file, and its code without inline tests.
fn code() -> Vec<(String, String, String)> {
    let src = top().join("src");
    let read = |file: String| {
        let package = file.split('/').next().unwrap().to_owned();
        let source = fs::read_to_string(src.join(&file)).unwrap();
        let code = source.split("#[cfg(test)]\nmod ").next().unwrap();
        (package, file, code.to_owned())
    };
    rust_files(&src, &[]).into_iter().map(read).collect()
}

/// The identifier at the start of a text.
fn identifier(text: &str) -> &str {
    let end = |c: char| !c.is_alphanumeric() && c != '_';
    text.split(end).next().unwrap_or_default()
}

#[test]
fn type_names_are_unique_within_their_package() {
    let mut found: BTreeMap<(String, String), Vec<String>> = BTreeMap::new();
    for (package, file, code) in code() {
        for line in code.lines().map(str::trim) {
            let line = line
                .trim_start_matches("pub ")
                .trim_start_matches("pub(crate) ");
            let line = line.trim_start_matches("pub(super) ");
            let kinds = ["struct ", "enum ", "trait "];
            let name = kinds.iter().find_map(|kind| line.strip_prefix(kind));
            if let Some(name) = name.map(identifier) {
                let key = (package.clone(), name.to_owned());
                found.entry(key).or_default().push(file.clone());
            }
        }
    }
    // The platform defines a type once per system.
    found.retain(|(package, name), files| {
        files.len() > 1 && name != "Args" && package != "platform"
    });
    assert!(found.len() < MOST_DUPLICATES, "{found:#?}");
}

#[test]
fn no_type_has_more_methods_than_a_reader_can_hold() {
    let mut methods: BTreeMap<(String, String), usize> = BTreeMap::new();
    for (package, _, code) in code() {
        let mut of = None;
        for line in code.lines() {
            if line.starts_with("impl") {
                let head = line.trim_end_matches(" {");
                let head = head.rsplit(" for ").next().unwrap();
                let head = head.strip_prefix("impl").unwrap_or(head);
                let head = match head.strip_prefix('<') {
                    Some(generics) => generics.split_once("> ").map_or("", |(_, rest)| rest),
                    None => head.trim_start(),
                };
                of = Some(identifier(head).to_owned());
            } else if line.starts_with('}') {
                of = None;
            }
            let is_method = line.starts_with("    ")
                && !line.starts_with("     ")
                && !line.trim_start().starts_with("//")
                && line.contains("fn ");
            if let Some(name) = of.as_ref().filter(|_| is_method) {
                *methods.entry((package.clone(), name.clone())).or_default() += 1;
            }
        }
    }
    assert!(methods[&("core".to_owned(), "Stepper".to_owned())] > 40);
    methods.retain(|_, count| *count > MOST_METHODS);
    assert!(methods.is_empty(), "{methods:?}");
}
