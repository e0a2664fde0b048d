//! `stickslip completions SHELL`: the script by which a shell completes command lines.
//!
//! The script asks the program itself, with the line so far and [`ASKED`] in the environment, so that it knows whatever the
//! program knows: scenes, studies, lessons, pages, and the paths and values of the scene that stands in the line.

use super::base::{Error, Exit, put};
use clap::{ValueEnum, ValueHint};
use clap_complete::CompleteEnv;
use clap_complete::engine::{
    ArgValueCompleter, CompletionCandidate, PathCompleter, ValueCompleter,
};
use clap_complete::env::Shells;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use stickslip_core::model::Strategy;
use stickslip_debugger::teach;
use stickslip_manual as manual;
use stickslip_scene::builtin;
use stickslip_scene::format::paths::{self, Listed};
use stickslip_scene::format::read;
use stickslip_study::precision::Cost;
use stickslip_study::{benchmarks, builtin as studies};

/// The variable of the environment by which a shell asks, and says which one it is.
const ASKED: &str = "STICKSLIP_COMPLETE";

/// The script of bash. The library's own takes `PATH=VALUE` for three words.
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
The script goes where the shell looks for it, or is read where the shell starts (`stickslip help install`):

  stickslip completions bash > ~/.local/share/bash-completion/completions/stickslip
  source <(stickslip completions bash)")]
pub struct Args {
    /// Which shell: bash, zsh, fish, elvish or powershell
    #[arg(hide_possible_values = true)]
    shell: Shell,
    /// Writes the script here, instead of to standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Overwrites a file that exists
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

/// Answers a shell that asks how a line could go on, and ends the program then; else returns.
pub fn answer(program: fn() -> clap::Command) {
    CompleteEnv::with_factory(|| completed(program()))
        .var(ASKED)
        .complete();
}

/// Whether it is said what the values of an argument can be.
#[cfg(test)]
pub fn knows(arg: &clap::Arg) -> bool {
    kind(arg).is_some()
}

/// The command line with what each of its values could be.
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

/// What a word that is being typed could go on as.
type Words = fn(&OsStr) -> Vec<CompletionCandidate>;

/// What the values of an argument can be.
#[derive(Clone, Copy)]
enum Kind {
    Words(Words),
    Files,
    Folders,
    /// Numbers, names that only the user knows, and what clap itself has a list of.
    Free,
}

/// What an argument can be, by the name of its value in the help.
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
        ("SCENE" | "SCENE|SNAPSHOT" | "SCENE|SNAPSHOT|JOURNAL|MESH", _) => {
            Kind::Words(|begun| with_files(begun, scenes()))
        }
        ("PATH=VALUE" | "PATH=A,B,C", _) => Kind::Words(settings),
        ("A,B,C", _) => Kind::Words(|begun| plain(begun, Strategy::NAMES)),
        (
            "FILE" | "FILE|-" | "FILE|finest" | "SNAPSHOT" | "JOURNAL" | "LOG" | "COMMAND" | "A"
            | "B",
            _,
        ) => Kind::Files,
        ("DIR", _) => Kind::Folders,
        _ if FREE.contains(&name) => Kind::Free,
        _ => return None,
    })
}

/// Values of which nothing is known beforehand.
const FREE: &[&str] = &[
    "A..B",
    "CELLS",
    "ERROR",
    "INC[.MAJOR[.MINOR]]",
    "ITERATIONS",
    "K",
    "K/N",
    "MONITOR",
    "N",
    "PART",
    "QUANTITY",
    "SECONDS",
    "SEED",
    "SHELL",
    "WHAT",
    "WORD",
];

/// A name that can be typed, and what it is.
type Named = (&'static str, String);

fn scenes() -> Vec<Named> {
    let list = builtin::list().iter();
    list.map(|scene| (scene.name, builtin::title(scene)))
        .collect()
}

fn with_studies() -> Vec<Named> {
    let named = |name| (name, String::new());
    let studies = studies::list().iter().map(|study| study.name);
    let mut all = scenes();
    all.extend(studies.chain([benchmarks::BUILTIN]).map(named));
    all
}

fn lessons() -> Vec<Named> {
    let list = teach::list().iter();
    list.map(|lesson| (lesson.name, teach::lesson::title(lesson)))
        .collect()
}

/// What `show` prints.
fn shown() -> Vec<Named> {
    [with_studies(), lessons()].concat()
}

/// What `help` explains.
fn topics() -> Vec<Named> {
    let pages = manual::PAGES.iter();
    let pages = pages.map(|page| (page.topic, page.about.to_owned()));
    let names = super::groups::names().map(|name| (name, String::new()));
    pages.chain(names).collect()
}

/// The names that begin so.
fn of(begun: &OsStr, all: Vec<Named>) -> Vec<CompletionCandidate> {
    let begun = begun.to_string_lossy();
    let found = all
        .into_iter()
        .filter(|(name, _)| name.starts_with(&*begun));
    let candidate = |(name, about): Named| {
        let about = (!about.is_empty()).then(|| about.into());
        CompletionCandidate::new(name).help(about)
    };
    found.map(candidate).collect()
}

fn plain(begun: &OsStr, words: impl IntoIterator<Item = &'static str>) -> Vec<CompletionCandidate> {
    let named = words.into_iter().map(|word| (word, String::new()));
    of(begun, named.collect())
}

/// The names that begin so, and the files.
fn with_files(begun: &OsStr, all: Vec<Named>) -> Vec<CompletionCandidate> {
    let mut found = of(begun, all);
    found.extend(PathCompleter::file().complete(begun));
    found
}

/// `PATH=` while the path is typed, `PATH=VALUE` then; of several values, separated by commas, the last.
fn settings(begun: &OsStr) -> Vec<CompletionCandidate> {
    let words: Vec<OsString> = std::env::args_os().collect();
    let listed = of_scene(&words).unwrap_or_else(of_any);
    let begun = begun.to_string_lossy();
    let found: Vec<String> = match begun.split_once('=') {
        None => {
            let paths = listed.iter().map(|own| format!("{}=", own.path));
            paths.filter(|path| path.starts_with(&*begun)).collect()
        }
        Some((path, value)) => {
            let before = value.rfind(',').map_or("", |at| &value[..=at]);
            let own = listed.iter().find(|own| own.path == path);
            let values = own.map_or(&[][..], |own| own.words).iter();
            let values = values.map(|word| format!("{path}={before}{word}"));
            values.filter(|value| value.starts_with(&*begun)).collect()
        }
    };
    found.into_iter().map(CompletionCandidate::new).collect()
}

/// A path that can be set, and the words that its value can be.
struct Settable {
    path: String,
    words: &'static [&'static str],
}

/// What can be set in the scene that is among these words; none if there is none, or it cannot be read.
fn of_scene(words: &[OsString]) -> Option<Vec<Settable>> {
    let listed = words.iter().skip(1).find_map(|word| {
        let name = word.to_str()?;
        let text = match builtin::find(name) {
            Some(scene) => scene.text.to_owned(),
            None if Path::new(name).is_file() => read::text(name).ok()?,
            None => return None,
        };
        Some(paths::list(&read::spec(name, &text).ok()?))
    })?;
    let settable = |own: Listed| Settable {
        path: own.path,
        words: own.words,
    };
    Some(listed.into_iter().map(settable).collect())
}

/// What can be set in any scene.
fn of_any() -> Vec<Settable> {
    let listed = paths::of_settings().into_iter();
    listed
        .map(|(path, words)| Settable { path, words })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scene_in_the_line_says_what_can_be_set() {
        let line = |words: &[&str]| words.iter().map(OsString::from).collect::<Vec<_>>();
        let own = of_scene(&line(&["stickslip", "--", "run", "osc-snap", "--set"])).unwrap();
        assert!(own.iter().any(|own| own.path == "friction.angle"));
        assert!(of_scene(&line(&["stickslip", "--", "map", "--random"])).is_none());
        assert!(of_scene(&line(&["stickslip", "run", "Cargo.toml"])).is_none());
    }
}
