//! `stickslip completions SHELL`: the completion script for a shell.
//!
//! The script runs the program with the current line and the variable [`ASKED`] in the environment. It can therefore complete
//! scenes, studies, lessons, manual pages, and the paths and values of the scene in the line.

use super::base::{Error, Exit, put};
use clap::{ValueEnum, ValueHint};
use clap_complete::CompleteEnv;
use clap_complete::engine::{
    ArgValueCompleter, CompletionCandidate, PathCompleter, ValueCompleter,
};
use clap_complete::env::Shells;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use stickslip_core::Strategy;
use stickslip_debugger::teach;
use stickslip_manual as manual;
use stickslip_scene::builtin;
use stickslip_scene::format::paths::{self, ListedScalar};
use stickslip_scene::format::read;
use stickslip_study::precision::Cost;
use stickslip_study::{benchmarks, builtin as studies};

/// The environment variable that requests completions; its value names the shell.
const ASKED: &str = "STICKSLIP_COMPLETE";

/// The script for bash. Clap's own script splits `PATH=VALUE` into three words.
const BASH: &str = include_str!("completions.bash");

/// A shell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Shell {
    Bash,
    Zsh,
    Fish,
    Elvish,
    Powershell,
}

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Save the script where the shell looks for completions, or load it at start-up (`stickslip help install`):

  stickslip completions bash > ~/.local/share/bash-completion/completions/stickslip
  source <(stickslip completions bash)")]
pub struct Args {
    /// The shell: bash, zsh, fish, elvish or powershell
    #[arg(hide_possible_values = true)]
    shell: Shell,
    /// Writes the script to this file instead of to standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrites an existing file
    #[arg(long, requires = "output")]
    force: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let script = script(args.shell)?;
    put(args.output.as_deref(), &script, args.force)
}

fn script(shell: Shell) -> Result<String, Error> {
    if shell == Shell::Bash {
        return Ok(BASH.to_owned());
    }
    let mut script = Vec::new();
    let name = "stickslip";
    let shells = Shells::builtins();
    let value = shell.to_possible_value();
    if let Some(of) = value.and_then(|value| shells.completer(value.get_name())) {
        of.write_registration(ASKED, name, name, name, &mut script)
            .map_err(Error::Output)?;
    }
    Ok(String::from_utf8_lossy(&script).into_owned())
}

/// If a shell requests completions, prints them and exits; otherwise returns.
pub fn answer(program: fn() -> clap::Command) {
    CompleteEnv::with_factory(|| completed(program()))
        .var(ASKED)
        .complete();
}

/// Whether the completions of an argument are defined.
#[cfg(test)]
pub fn knows(arg: &clap::Arg) -> bool {
    kind(arg).is_some()
}

/// The command line with a completer for each value.
fn completed(program: clap::Command) -> clap::Command {
    let with = |arg: clap::Arg| match kind(&arg) {
        Some(Kind::Words(words)) => arg.add(ArgValueCompleter::new(words)),
        Some(Kind::Files) => arg.value_hint(ValueHint::FilePath),
        Some(Kind::Folders) => arg.value_hint(ValueHint::DirPath),
        Some(Kind::Free) | None => arg,
    };
    program
        .mut_args(with)
        .mut_subcommands(|own| own.mut_args(with))
}

/// The completions of a partial word.
type Words = fn(&OsStr) -> Vec<CompletionCandidate>;

/// Kinds of argument values.
#[derive(Clone, Copy)]
enum Kind {
    Words(Words),
    Files,
    Folders,
    /// Numbers, names that only the user knows, and values that clap itself lists.
    Free,
}

/// The kind of an argument's value, from its name in the help.
fn kind(arg: &clap::Arg) -> Option<Kind> {
    let id = arg.get_id().as_str();
    let name = match arg.get_value_names() {
        Some([name, ..]) => name.as_str(),
        _ => id,
    };
    Some(match (name, id) {
        (_, "cost") => Kind::Words(|begun| plain(begun, Cost::NAMES)),
        (_, "lesson") => Kind::Words(|begun| with_files(begun, lessons())),
        (_, "topic") => Kind::Words(|begun| of(begun, topics())),
        (_, "name") => Kind::Words(|begun| of(begun, shown())),
        ("SCENE|STUDY", _) => Kind::Words(|begun| with_files(begun, with_studies())),
        ("SCREEN|SCENE", _) => Kind::Words(|begun| with_files(begun, screens())),
        ("SCENE" | "SCENE|SNAPSHOT" | "SCENE|SNAPSHOT|JOURNAL|MESH|CEL", _) => {
            Kind::Words(|begun| with_files(begun, scenes()))
        }
        ("PATH=VALUE" | "PATH=A,B,C", _) => Kind::Words(settings),
        ("A,B,C", _) => Kind::Words(|begun| plain(begun, Strategy::NAMES)),
        (
            "FILE"
            | "FILE|-"
            | "FILE|finest|richardson"
            | "SNAPSHOT"
            | "JOURNAL"
            | "LOG"
            | "COMMAND"
            | "A"
            | "B",
            _,
        ) => Kind::Files,
        ("DIR", _) => Kind::Folders,
        _ if FREE.contains(&name) => Kind::Free,
        _ => return None,
    })
}

/// Values without completions.
const FREE: &[&str] = &[
    "A..B",
    "ADDRESS",
    "CELLS",
    "ERROR",
    "COLOURS",
    "INC[.MAJOR[.MINOR]]",
    "ITERATIONS",
    "K",
    "KEYS",
    "K/N",
    "MONITOR",
    "N",
    "NODE",
    "PART",
    "PIXELS",
    "QUANTITY",
    "SECONDS",
    "SEED",
    "SHELL",
    "WHAT",
    "WORD",
    "WxH",
];

/// A name, and its description.
type Named = (&'static str, String);

fn scenes() -> Vec<Named> {
    builtin::list()
        .iter()
        .map(|scene| (scene.name, builtin::title(scene)))
        .collect()
}

/// The main screens of the debugger, and scenes.
fn screens() -> Vec<Named> {
    super::front::MAIN_SCREENS
        .iter()
        .map(|screen| (screen.name, screen.keys.to_owned()))
        .chain(scenes())
        .collect()
}

fn with_studies() -> Vec<Named> {
    let studies = studies::list().iter().map(|study| study.name);
    let mut all = scenes();
    all.extend(
        studies
            .chain([benchmarks::BUILTIN])
            .map(|name| (name, String::new())),
    );
    all
}

fn lessons() -> Vec<Named> {
    teach::list()
        .iter()
        .chain(teach::lesson::sheets())
        .map(|lesson| (lesson.name, teach::lesson::title(lesson)))
        .collect()
}

/// Arguments of `show`.
fn shown() -> Vec<Named> {
    [with_studies(), lessons()].concat()
}

/// Arguments of `help`.
fn topics() -> Vec<Named> {
    let pages = manual::PAGES
        .iter()
        .map(|page| (page.topic, page.about.to_owned()));
    let names = super::groups::names().map(|name| (name, String::new()));
    pages.chain(names).collect()
}

/// The names that start with the typed text.
fn of(begun: &OsStr, all: Vec<Named>) -> Vec<CompletionCandidate> {
    let begun = begun.to_string_lossy();
    let found = all
        .into_iter()
        .filter(|(name, _)| name.starts_with(&*begun));
    found
        .map(|(name, about)| {
            let about = (!about.is_empty()).then(|| about.into());
            CompletionCandidate::new(name).help(about)
        })
        .collect()
}

fn plain(begun: &OsStr, words: impl IntoIterator<Item = &'static str>) -> Vec<CompletionCandidate> {
    let named = words.into_iter().map(|word| (word, String::new()));
    of(begun, named.collect())
}

/// The names that start with the typed text, and files.
fn with_files(begun: &OsStr, all: Vec<Named>) -> Vec<CompletionCandidate> {
    let mut found = of(begun, all);
    found.extend(PathCompleter::file().complete(begun));
    found
}

/// Completes `PATH=`, then `PATH=VALUE`; in a comma-separated list, the last value.
fn settings(begun: &OsStr) -> Vec<CompletionCandidate> {
    let words: Vec<OsString> = std::env::args_os().collect();
    let listed = of_scene(&words).unwrap_or_else(|| paths::of_settings().collect());
    let begun = begun.to_string_lossy();
    let found: Vec<String> = match begun.split_once('=') {
        None => listed
            .iter()
            .map(|own| format!("{}=", own.path))
            .filter(|path| path.starts_with(&*begun))
            .collect(),
        Some((path, value)) => {
            let before = value.rfind(',').map_or("", |at| &value[..=at]);
            let own = listed.iter().find(|own| own.path == path);
            own.map_or(&[][..], |own| own.words)
                .iter()
                .map(|word| format!("{path}={before}{word}"))
                .filter(|value| value.starts_with(&*begun))
                .collect()
        }
    };
    found.into_iter().map(CompletionCandidate::new).collect()
}

/// The paths of the scene among these words; `None` if there is no scene, or it is not readable.
fn of_scene(words: &[OsString]) -> Option<Vec<ListedScalar>> {
    words.iter().skip(1).find_map(|word| {
        let name = word.to_str()?;
        let text = match builtin::find(name) {
            Some(scene) => scene.text.to_owned(),
            None if Path::new(name).is_file() => read::text(name, read::SCENE).ok()?,
            None => return None,
        };
        Some(paths::list(&read::spec(name, &text).ok()?))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_come_from_the_scene_in_the_line() {
        let line = |words: &[&str]| words.iter().map(OsString::from).collect::<Vec<_>>();
        let own = of_scene(&line(&["stickslip", "--", "run", "osc-snap", "--set"])).unwrap();
        assert!(own.iter().any(|own| own.path == "friction.angle"));
        assert!(of_scene(&line(&["stickslip", "--", "map", "--random"])).is_none());
        assert!(of_scene(&line(&["stickslip", "run", "Cargo.toml"])).is_none());
    }
}
