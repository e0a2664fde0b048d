//! Completion of typed lines.

use super::arguments::CONDITIONS;
use super::context::{Context, names};
use super::meaning::{Colours, CopyTarget, Filter, HiddenDecisions, Sort};
use super::parameters::{parameter_lines, set_paths};
use super::paths::beginning_with;
use super::table::{ACTIONS, ActionEntry, Verb, by_name};
use crate::{Tree, WatchQuantity};
use stickslip_core::Mode;
use stickslip_manual as manual;
use stickslip_scene::format::paths;

/// Completions of a line: whole lines, the most likely first.
pub fn complete(line: &str, context: &Context) -> Vec<String> {
    let first = line.split_whitespace().next();
    let entry = first.and_then(|name| context.entry(name).ok());
    let sets = entry.is_some_and(|entry| entry.verb == Verb::Set) && context.offers.is_some();
    let start = match entry.filter(|entry| entry.takes_rest() || sets) {
        // A path is one argument, including its spaces.
        Some(_) => line.find(char::is_whitespace),
        None => line.rfind(|c: char| c.is_whitespace() || (c == ',' && is_list(entry))),
    };
    let (before, word) = line.split_at(start.map_or(0, |at| at + 1));
    let candidates: Vec<String> = match before.split_whitespace().next() {
        None => ACTIONS.iter().map(|entry| entry.name.to_string()).collect(),
        Some(name) => context
            .entry(name)
            .map(|entry| {
                let mut all = entry.candidates(before, context);
                all.extend(entry.paths(word));
                if sets {
                    all.extend(parameter_lines(word, context));
                }
                all
            })
            .unwrap_or_default(),
    };
    candidates
        .iter()
        .filter(|c| c.starts_with(word))
        .map(|c| format!("{before}{c}"))
        .collect()
}

/// Whether the action's argument is a path, which may contain spaces.
pub fn takes_path(name: &str) -> bool {
    by_name(name).is_ok_and(|entry| entry.endings().is_some())
}

/// Whether the action takes nodes separated by commas.
fn is_list(entry: Option<&ActionEntry>) -> bool {
    entry.is_some_and(|entry| entry.verb == Verb::Census)
}

impl ActionEntry {
    /// Whether everything after the name is one argument that can be completed.
    fn takes_rest(&self) -> bool {
        matches!(
            self.verb,
            Verb::Branch(None) | Verb::Compare | Verb::Colours
        ) || self.endings().is_some()
    }

    /// File extensions that the action accepts, empty for any; `None` if it does not take a path.
    fn endings(&self) -> Option<&'static [&'static str]> {
        match self.verb {
            Verb::Open => Some(&["ron", "dat", "journal"]),
            Verb::Lesson => Some(&["ron"]),
            Verb::Chart => Some(&["csv"]),
            Verb::Journal | Verb::Export { .. } | Verb::Snapshot { .. } => Some(&[]),
            _ => None,
        }
    }

    /// Files and folders that complete a path.
    fn paths(&self, word: &str) -> Vec<String> {
        self.endings()
            .map(|endings| beginning_with(word, endings))
            .unwrap_or_default()
    }

    /// The possible next arguments after the text before.
    fn candidates(&self, before: &str, context: &Context) -> Vec<String> {
        let given = before.split_whitespace().count() - 1;
        let nodes = || context.model.into_iter().flat_map(names).map(String::from);
        let all =
            |words: &[&str]| -> Vec<String> { words.iter().map(|word| word.to_string()).collect() };
        let modes = all(&Mode::NAMES);
        match (&self.verb, given) {
            (Verb::Force { .. }, 0) => modes.into_iter().chain(nodes()).collect(),
            (Verb::Force { .. }, 1) => modes,
            (Verb::Release | Verb::Node, 0) => nodes().collect(),
            (Verb::Census, _) => nodes().collect(),
            (Verb::Branch(None) | Verb::Compare, 0) => {
                let branches = context.tree.map_or(&[][..], Tree::branches);
                let numbers = (1..=branches.len()).map(|number| format!("b{number}"));
                let labels = branches.iter().map(|branch| branch.label.clone());
                numbers.chain(labels).collect()
            }
            (Verb::Break, 0) => all(&CONDITIONS),
            (Verb::Break, _) => {
                let any = || std::iter::once("any".into()).chain(nodes());
                match (before.split_whitespace().nth(1), given) {
                    (Some("mode" | "leaves"), 1) => modes.into_iter().chain(any()).collect(),
                    (Some("mode" | "leaves"), 2) => modes,
                    (Some("margin" | "element"), 1) => any().collect(),
                    _ => Vec::new(),
                }
            }
            (Verb::Delete | Verb::Enable { .. }, 0) => vec!["all".into()],
            (Verb::Watch, 0) => all(&WatchQuantity::NAMES),
            (Verb::Watch, 1) => nodes().chain(std::iter::once("as".into())).collect(),
            (Verb::Set, 0) if context.offers.is_none() => set_paths(context),
            (Verb::Set, 1) => all(values(before)),
            (Verb::Open, 0) => context.scenes.to_vec(),
            (Verb::Help, 0) => manual::PAGES.iter().map(|page| page.topic.into()).collect(),
            (Verb::Lesson, 0) => context
                .lessons
                .iter()
                .map(|lesson| lesson.name.into())
                .collect(),
            (Verb::Predict, 0) => all(&HiddenDecisions::NAMES),
            (Verb::Copy, 0) => CopyTarget::all().map(|what| what.word().into()).collect(),
            (Verb::Colours, 0) => all(&Colours::NAMES),
            (Verb::Mouse, 0) => all(&["on", "off"]),
            (Verb::Sort, 0) => all(&Sort::NAMES),
            (Verb::Filter, 0) => all(&Filter::NAMES),
            (Verb::Monitor, 0) => context
                .model
                .into_iter()
                .flat_map(|model| &model.monitors)
                .map(|monitor| monitor.name.clone())
                .collect(),
            _ => Vec::new(),
        }
    }
}

/// The possible values of a setting, if they are words.
fn values(before: &str) -> &'static [&'static str] {
    let path = before.split_whitespace().nth(1).unwrap_or_default();
    let found = paths::of_settings().find(|own| own.path == path);
    found.map_or(&[], |own| own.words)
}
