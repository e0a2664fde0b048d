//! Groups the subcommands in `stickslip --help`, and suggests corrections for mistyped ones.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::ffi::OsString;
use std::path::Path;
use stickslip_scene::builtin;
use stickslip_scene::format::error::{did_you_mean, did_you_mean_file};
use stickslip_scene::shown::wrap;

/// The groups in the order of a typical workflow.
const GROUPS: [(&str, &[&str]); 8] = [
    ("Solve", &["run", "check", "audit"]),
    ("Debug", &["remedies", "core", "resume", "story"]),
    ("Attach", &["attach", "serve"]),
    ("Record", &["record", "replay", "diff"]),
    ("Sweep", &["study", "map", "chart"]),
    ("Learn", &["lesson", "help"]),
    ("Files", &["list", "show", "export", "screens"]),
    ("Install", &["completions", "man"]),
];

/// All subcommands.
pub fn names() -> impl Iterator<Item = &'static str> {
    GROUPS.iter().flat_map(|(_, names)| names.iter().copied())
}

/// Width of the text of `--help`.
const WIDTH: usize = 100;

/// The command line with subcommands grouped in the help.
pub fn grouped(command: clap::Command) -> clap::Command {
    let width = command
        .get_subcommands()
        .map(|own| own.get_name().len())
        .max()
        .unwrap_or(0);
    let mut text = String::new();
    for (group, names) in GROUPS {
        text += &format!("{group}:\n");
        for name in names {
            let about = command
                .find_subcommand(name)
                .and_then(|own| own.get_about())
                .map(ToString::to_string)
                .unwrap_or_default();
            let mut lines = wrap(&about, WIDTH - width - 4).into_iter();
            let first = lines.next().unwrap_or_default();
            text += &format!("  {name:<width$}  {first}\n");
            for line in lines {
                text += &format!("  {:<width$}  {line}\n", "");
            }
        }
        text.push('\n');
    }
    command.help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{text}Arguments:\n{{positionals}}\n\nOptions:\n{{options}}{{after-help}}"
    ))
}

/// Removed options, and their replacements.
const REMOVED: [(&str, &str); 2] = [("--aggregate", ROWS), ("--failing", ROWS)];
const ROWS: &str = "no longer exists; write all rows with --shard K/N --csv FILE, and aggregate them with DuckDB or Polars (`help cluster`)";

/// A better message if the first word is neither a subcommand nor a scene, so that clap misread the rest of the line.
pub fn mistyped(error: &clap::Error, first: Option<OsString>) -> Option<String> {
    let kinds = [
        ErrorKind::UnknownArgument,
        ErrorKind::ArgumentConflict,
        ErrorKind::InvalidSubcommand,
    ];
    if !kinds.contains(&error.kind()) {
        return None;
    }
    if let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg)
        && let Some((_, why)) = REMOVED
            .iter()
            .find(|(removed, _)| option.starts_with(removed))
    {
        return Some(format!("{option} {why}"));
    }
    unknown(first?.to_str()?)
}

/// The message for a word that is neither a subcommand nor a scene; `None` if it is one.
pub fn unknown(word: &str) -> Option<String> {
    let is_known = word.starts_with('-')
        || names().any(|name| name == word)
        || builtin::find(word).is_some()
        || Path::new(word).exists();
    if is_known {
        return None;
    }
    let scenes = builtin::list().iter().map(|own| own.name);
    let near = [
        did_you_mean_file(word),
        did_you_mean(word, names()),
        did_you_mean(word, scenes),
    ];
    let near = near
        .into_iter()
        .find(|near| !near.is_empty())
        .unwrap_or_default();
    let word = stickslip_scene::format::error::quoted(word);
    Some(format!(
        "{word} is not a subcommand, a file or a built-in scene{near} (see `stickslip --help`, `stickslip list`)"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistyped_subcommands_and_scenes_get_a_suggestion() {
        assert!(unknown("rnu").unwrap().contains("did you mean \"run\"?"));
        assert!(
            unknown("osc-snpa")
                .unwrap()
                .contains("did you mean \"osc-snap\"?")
        );
        assert!(!unknown("zzzzzz").unwrap().contains("did you mean"));
        for known in ["run", "osc-snap", "Cargo.toml", "--set"] {
            assert_eq!(unknown(known), None, "{known}");
        }
    }
}
