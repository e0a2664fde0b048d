//! `stickslip --help`: the subcommands in groups, and which one was meant by a word that is none.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::ffi::OsString;
use std::path::Path;
use stickslip_scene::builtin;
use stickslip_scene::format::error::did_you_mean;
use stickslip_scene::shown::wrap;

/// What the subcommands are for, in the order of the work.
const GROUPS: [(&str, &[&str]); 8] = [
    ("Solve", &["run", "check", "audit"]),
    ("Debug", &["remedies", "core", "resume", "story"]),
    ("Attach", &["attach", "serve"]),
    ("Record", &["record", "replay", "diff"]),
    ("Sweep", &["study", "map", "chart"]),
    ("Learn", &["lesson", "help"]),
    ("Files", &["list", "show", "export"]),
    ("Install", &["completions", "man"]),
];

/// The subcommands of all groups.
pub fn names() -> impl Iterator<Item = &'static str> {
    GROUPS.iter().flat_map(|(_, names)| names.iter().copied())
}

/// Width of the text of `--help`.
const WIDTH: usize = 100;

/// The command line with a help that lists its subcommands in groups.
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
                .and_then(|own| own.get_about());
            let about = about.map(ToString::to_string).unwrap_or_default();
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

/// Options of earlier revisions, and what replaces them.
const REMOVED: [(&str, &str); 2] = [("--aggregate", ROWS), ("--failing", ROWS)];
const ROWS: &str = "no longer exists; --shard K/N --csv FILE writes all rows of a shard, and DuckDB or Polars sums them up (`help cluster`)";

/// What to say where the first word of a command line is no subcommand, and what follows makes sense for no scene.
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

/// The message about a word that should be a subcommand or a scene, and is neither; none where it is one.
pub fn unknown(word: &str) -> Option<String> {
    let is_known = word.starts_with('-')
        || names().any(|name| name == word)
        || builtin::find(word).is_some()
        || Path::new(word).exists();
    if is_known {
        return None;
    }
    let near = match did_you_mean(word, names()) {
        none if none.is_empty() => did_you_mean(word, builtin::list().iter().map(|own| own.name)),
        near => near,
    };
    let word = stickslip_scene::format::error::quoted(word);
    Some(format!(
        "{word} is no subcommand, no file and no built-in scene{near} (`stickslip --help`, `stickslip list`)"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_told_from_a_scene() {
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
