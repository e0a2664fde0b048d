//! Who imports whom: the `use` trees and the paths in the code of some packages, each resolved to the file that it lands in.
//!
//! A path is followed through re-exports, so that a file that only hands names on (`mod.rs`) ties nobody to all that it
//! hands on. Importing a module ties to nothing yet; what is then named in it does. Text between quotes and in comments is
//! no code. What a macro makes of its arguments is not seen.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// A module: the name of its package as code writes it, and the names down to it.
pub type Module = Vec<String>;

/// A package: its name as code writes it, its folder under the top, and the folders in that which are packages of their own.
pub struct Package {
    pub name: &'static str,
    pub folder: &'static str,
    pub others: &'static [&'static str],
}

/// The files of some packages, by their modules.
#[derive(Default)]
pub struct Sources {
    files: BTreeMap<Module, Source>,
}

/// What a file names.
struct Source {
    /// Its path from the top.
    path: String,
    lines: usize,
    /// Names of what it defines.
    defined: BTreeSet<String>,
    uses: Vec<Use>,
    paths: Vec<Mention>,
}

/// A name that `use` brings; none stands for `*`.
struct Use {
    from: Mention,
    name: Option<String>,
}

/// A path as it stands in the code, and the modules within the file around it.
struct Mention {
    inside: Vec<String>,
    path: Vec<String>,
}

/// Names that a file takes from another, by both their paths.
pub type Ties = BTreeMap<(String, String), BTreeSet<String>>;

impl Sources {
    /// Reads all Rust files of these packages.
    pub fn read(top: &Path, packages: &[Package]) -> Sources {
        let mut sources = Sources::default();
        for package in packages {
            let root = top.join(package.folder);
            for file in rust_files(&root, package.others) {
                let text = fs::read_to_string(root.join(&file)).unwrap();
                sources.add(package.name, package.folder, &file, &text);
            }
        }
        sources
    }

    /// Adds a file of a package; its path is from the package's folder.
    pub fn add(&mut self, package: &str, folder: &str, file: &str, text: &str) {
        let names = file.trim_end_matches(".rs").split('/');
        let mut module: Module = [package]
            .into_iter()
            .chain(names)
            .map(String::from)
            .collect();
        if matches!(module.last().map(String::as_str), Some("mod" | "lib")) {
            module.pop();
        }
        let tokens = tokens(text);
        let (uses, paths) = named(&tokens);
        let source = Source {
            path: format!("{folder}/{file}"),
            lines: text.lines().count(),
            defined: defined(&tokens),
            uses,
            paths,
        };
        self.files.insert(module, source);
    }

    /// Every file's path and number of lines.
    pub fn lines(&self) -> impl Iterator<Item = (&str, usize)> {
        self.files
            .values()
            .map(|file| (file.path.as_str(), file.lines))
    }

    /// Files whose code names this crate of others.
    pub fn that_name(&self, foreign: &str) -> BTreeSet<&str> {
        let names = |file: &&Source| {
            let uses = file.uses.iter().map(|one| &one.from);
            let mut all = uses.chain(&file.paths);
            all.any(|mention| mention.path[0] == foreign)
        };
        let found = self.files.values().filter(names);
        found.map(|file| file.path.as_str()).collect()
    }

    /// All that files take from each other.
    pub fn ties(&self) -> Ties {
        let mut ties = Ties::new();
        for (module, file) in &self.files {
            let uses = file.uses.iter().map(|one| (&one.from, one.name.is_none()));
            let paths = file.paths.iter().map(|mention| (mention, false));
            for (mention, all) in uses.chain(paths) {
                let Some((to, item)) = self.land(module, mention, all) else {
                    continue;
                };
                if to != *module {
                    let pair = (file.path.clone(), self.files[&to].path.clone());
                    ties.entry(pair).or_default().insert(item);
                }
            }
        }
        ties
    }

    /// The file that a mention lands in, and the name that it takes there; `all` where it ends in `*`.
    fn land(&self, module: &Module, mention: &Mention, all: bool) -> Option<(Module, String)> {
        let path = self.absolute(module, mention, &mut BTreeSet::new())?;
        match (self.follow(&path, &mut BTreeSet::new())?, all) {
            ((to, Some(item)), _) => Some((to, item)),
            ((to, None), true) => Some((to, "*".into())),
            ((_, None), false) => None,
        }
    }

    /// A mention from the package down; none where it is of another crate.
    fn absolute(
        &self,
        module: &Module,
        mention: &Mention,
        seen: &mut BTreeSet<String>,
    ) -> Option<Module> {
        let here: Module = module.iter().chain(&mention.inside).cloned().collect();
        let (first, rest) = mention.path.split_first()?;
        match first.as_str() {
            "crate" => return Some([&module[..1], rest].concat()),
            "self" => return Some([&here[..], rest].concat()),
            "super" => {
                let ups = mention
                    .path
                    .iter()
                    .take_while(|name| *name == "super")
                    .count();
                let kept = here.len().checked_sub(ups).filter(|kept| *kept > 0)?;
                return Some([&here[..kept], &mention.path[ups..]].concat());
            }
            _ => {}
        }
        if self.files.contains_key(&vec![first.clone()]) {
            return Some(mention.path.clone());
        }
        let child = [&here[..], std::slice::from_ref(first)].concat();
        if self.files.contains_key(&child) {
            return Some([&here[..], &mention.path].concat());
        }
        // A name that was brought by `use` stands for its path.
        let brought =
            |one: &&Use| one.from.inside == mention.inside && one.name.as_ref() == Some(first);
        let one = self.files[module].uses.iter().find(brought)?;
        if !seen.insert(first.clone()) {
            return None;
        }
        let path = self.absolute(module, &one.from, seen)?;
        Some([&path[..], rest].concat())
    }

    /// Goes down a path, through re-exports: the module that it ends in, and the item there that it names, if any.
    fn follow(
        &self,
        path: &[String],
        seen: &mut BTreeSet<Module>,
    ) -> Option<(Module, Option<String>)> {
        let mut module: Module = path[..1].to_vec();
        self.files.get(&module)?;
        for (k, name) in path.iter().enumerate().skip(1) {
            let below = [&module[..], std::slice::from_ref(name)].concat();
            if self.files.contains_key(&below) {
                module = below;
                continue;
            }
            if seen.insert(path[..=k].to_vec()) {
                let rest = &path[k..];
                if let Some(found) = self.handed_on(&module, rest, seen) {
                    return Some(found);
                }
            }
            return Some((module, Some(name.clone())));
        }
        Some((module, None))
    }

    /// Where a name goes that a module does not hold itself.
    fn handed_on(
        &self,
        module: &Module,
        rest: &[String],
        seen: &mut BTreeSet<Module>,
    ) -> Option<(Module, Option<String>)> {
        let outer = |one: &&Use| one.from.inside.is_empty();
        let uses = || self.files[module].uses.iter().filter(outer);
        let by_name = |one: &&Use| one.name.as_ref() == Some(&rest[0]);
        if let Some(one) = uses().find(by_name) {
            let path = self.absolute(module, &one.from, &mut BTreeSet::new())?;
            return self.follow(&[&path[..], &rest[1..]].concat(), seen);
        }
        uses().filter(|one| one.name.is_none()).find_map(|one| {
            let path = self.absolute(module, &one.from, &mut BTreeSet::new())?;
            let found = self.follow(&[&path[..], rest].concat(), seen)?;
            let is_there = |item: &String| self.files[&found.0].defined.contains(item);
            found.1.as_ref().is_none_or(is_there).then_some(found)
        })
    }
}

/// Groups of files of which each reaches each other one by imports.
pub fn circles(ties: &Ties) -> Vec<BTreeSet<String>> {
    let mut next: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (from, to) in ties.keys() {
        next.entry(from).or_default().push(to);
    }
    let reached = |from: &str| {
        let mut seen = BTreeSet::new();
        let mut left: Vec<&str> = next.get(from).into_iter().flatten().copied().collect();
        while let Some(file) = left.pop() {
            if seen.insert(file) {
                left.extend(next.get(file).into_iter().flatten());
            }
        }
        seen
    };
    let all: BTreeMap<&str, BTreeSet<&str>> =
        next.keys().map(|from| (*from, reached(from))).collect();
    let of = |file: &str| {
        let back = |other: &&str| all.get(other).is_some_and(|seen| seen.contains(file));
        let circle: BTreeSet<String> = all[file]
            .iter()
            .copied()
            .filter(back)
            .map(String::from)
            .collect();
        circle
    };
    let found: BTreeSet<BTreeSet<String>> = all.keys().map(|file| of(file)).collect();
    found
        .into_iter()
        .filter(|circle| !circle.is_empty())
        .collect()
}

pub fn rust_files(root: &Path, others: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    let mut left = vec![String::new()];
    while let Some(folder) = left.pop() {
        for entry in fs::read_dir(root.join(&folder)).unwrap() {
            let entry = entry.unwrap();
            let name = format!("{folder}{}", entry.file_name().to_string_lossy());
            if entry.file_type().unwrap().is_dir() {
                if !others.contains(&name.as_str()) {
                    left.push(name + "/");
                }
            } else if name.ends_with(".rs") {
                found.push(name);
            }
        }
    }
    found.sort();
    found
}

/// Words, `::` and single signs of a text, without comments and what stands between quotes.
fn tokens(text: &str) -> Vec<String> {
    let letters: Vec<char> = text.chars().collect();
    let at = |k: usize| letters.get(k).copied().unwrap_or('\0');
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let (mut found, mut k) = (Vec::new(), 0);
    while k < letters.len() {
        match (at(k), at(k + 1)) {
            ('/', '/') => {
                k = (k..letters.len())
                    .find(|&k| at(k) == '\n')
                    .unwrap_or(letters.len())
            }
            ('/', '*') => k = past_comment(&letters, k),
            ('"', _) => k = past_string(&letters, k),
            ('\'', '\\') => {
                k = (k + 3..letters.len())
                    .find(|&k| at(k) == '\'')
                    .map_or(letters.len(), |k| k + 1)
            }
            ('\'', _) if at(k + 2) == '\'' => k += 3,
            (':', ':') => {
                found.push("::".into());
                k += 2;
            }
            (c, _) if is_word(c) => {
                let end = (k..letters.len())
                    .find(|&k| !is_word(at(k)))
                    .unwrap_or(letters.len());
                let word: String = letters[k..end].iter().collect();
                let hashes = letters[end..].iter().take_while(|c| **c == '#').count();
                let raw = ["r", "br"].contains(&word.as_str()) && at(end + hashes) == '"';
                k = match raw {
                    true => past_raw(&letters, end + hashes, hashes),
                    false => end,
                };
                if !raw {
                    found.push(word);
                }
            }
            (c, _) => {
                if !c.is_whitespace() {
                    found.push(c.into());
                }
                k += 1;
            }
        }
    }
    found
}

fn past_comment(letters: &[char], start: usize) -> usize {
    let (mut depth, mut k) = (0, start);
    while k + 1 < letters.len() {
        match (letters[k], letters[k + 1]) {
            ('/', '*') => (depth, k) = (depth + 1, k + 2),
            ('*', '/') => (depth, k) = (depth - 1, k + 2),
            _ => k += 1,
        }
        if depth == 0 {
            return k;
        }
    }
    letters.len()
}

fn past_string(letters: &[char], start: usize) -> usize {
    let mut k = start + 1;
    while k < letters.len() {
        match letters[k] {
            '\\' => k += 2,
            '"' => return k + 1,
            _ => k += 1,
        }
    }
    k
}

fn past_raw(letters: &[char], quote: usize, hashes: usize) -> usize {
    let ends =
        |k: &usize| letters[*k] == '"' && (1..=hashes).all(|h| letters.get(k + h) == Some(&'#'));
    let end = (quote + 1..letters.len()).find(ends);
    end.map_or(letters.len(), |k| k + 1 + hashes)
}

/// Names that the tokens of a file define.
fn defined(tokens: &[String]) -> BTreeSet<String> {
    let words = [
        "struct", "enum", "union", "trait", "type", "fn", "const", "static",
    ];
    let pairs = tokens
        .windows(2)
        .filter(|pair| words.contains(&pair[0].as_str()));
    pairs.map(|pair| pair[1].clone()).collect()
}

/// What the tokens of a file bring by `use`, and the paths that they name.
fn named(tokens: &[String]) -> (Vec<Use>, Vec<Mention>) {
    let word = |k: usize| tokens.get(k).map_or("", String::as_str);
    let is_name = |k: usize| word(k).starts_with(|c: char| c.is_alphabetic() || c == '_');
    let (mut uses, mut paths) = (Vec::new(), Vec::new());
    // Modules within the file, with the depth of braces that they stand at.
    let mut inside: Vec<(String, usize)> = Vec::new();
    let (mut depth, mut k) = (0, 0);
    while k < tokens.len() {
        let names = || {
            inside
                .iter()
                .map(|(name, _)| name.clone())
                .collect::<Vec<_>>()
        };
        match word(k) {
            "{" => depth += 1,
            "}" => {
                depth -= 1;
                inside.retain(|(_, at)| *at < depth + 1);
            }
            "mod" if is_name(k + 1) && word(k + 2) == "{" => {
                inside.push((word(k + 1).into(), depth + 1));
            }
            "use" if is_name(k + 1) || word(k + 1) == "::" => {
                let mut trees = Vec::new();
                k = tree(tokens, k + 1, &[], &mut trees);
                uses.extend(trees.into_iter().map(|(path, name)| {
                    let inside = names();
                    let from = Mention { inside, path };
                    Use { from, name }
                }));
                continue;
            }
            _ if is_name(k) && word(k + 1) == "::" && (k == 0 || word(k - 1) != "::") => {
                let mut path = vec![tokens[k].clone()];
                while word(k + 1) == "::" && is_name(k + 2) {
                    path.push(tokens[k + 2].clone());
                    k += 2;
                }
                let inside = names();
                paths.push(Mention { inside, path });
            }
            _ => {}
        }
        k += 1;
    }
    (uses, paths)
}

type Brought = (Vec<String>, Option<String>);

/// Reads a tree of `use` from a place on, below a path; the place after it.
fn tree(tokens: &[String], mut k: usize, above: &[String], found: &mut Vec<Brought>) -> usize {
    let word = |k: usize| tokens.get(k).map_or("", String::as_str);
    let mut path = above.to_vec();
    loop {
        match word(k) {
            "::" => k += 1,
            "*" => {
                found.push((path, None));
                return k + 1;
            }
            "{" => {
                k += 1;
                while !["}", ""].contains(&word(k)) {
                    k = match word(k) {
                        "," => k + 1,
                        _ => tree(tokens, k, &path, found),
                    };
                }
                return k + 1;
            }
            name => {
                if name != "self" || path.is_empty() {
                    path.push(name.into());
                }
                k += 1;
                if word(k) == "::" {
                    continue;
                }
                let (called, end) = match word(k) {
                    "as" => (word(k + 1).to_owned(), k + 2),
                    _ => (path.last().cloned().unwrap_or_default(), k),
                };
                found.push((path, Some(called)));
                return end;
            }
        }
    }
}
