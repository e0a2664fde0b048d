//! Shared by all subcommands: exit codes, errors, scene arguments and output.

use std::convert::Infallible;
use std::fmt::Display;
use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;
use stickslip_core::{Failure, RunEnd, Stepper, Until};
use stickslip_debugger::SnapshotError;
use stickslip_debugger::record::journal::JournalError;
use stickslip_platform::files::{self, FileError};
use stickslip_scene::builtin;
use stickslip_scene::shown;
use stickslip_scene::{Scene, SceneError};
use stickslip_study::run_error::RunError;

/// Exit codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Converged, equal, or sound.
    Good = 0,
    /// Snapshots differ, or benchmarks fail.
    Differ = 1,
    /// Bad input or usage.
    Bad = 2,
    /// The solve did not converge, or no remedy helps.
    Unconverged = 3,
    /// Cells of a sweep are missing; a command that computes them was printed.
    Incomplete = 4,
    /// A system error; another attempt may succeed.
    Again = 75,
    /// Interrupted by Ctrl-C. (A reader that closes the pipe is no interruption.)
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}

/// Why a subcommand failed; all variants except `Again` and `Ended` are bad input or usage.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Snapshot(#[from] SnapshotError),
    #[error("{}{}", .0, how_to_overwrite(.0))]
    File(#[from] FileError),
    #[error(transparent)]
    Journal(#[from] JournalError),
    #[error("{0}")]
    Usage(String),
    /// A file is in use by another run, or a system error prevented writing it.
    #[error("{0}")]
    Again(String),
    #[error("standard output: {0}")]
    Output(io::Error),
    /// There is no result, for the reason in the text.
    #[error("{1}")]
    Ended(Exit, String),
}

/// A usage error with a formatted message.
macro_rules! usage {
    ($($message:tt)+) => {
        $crate::cli::base::Error::Usage(format!($($message)+))
    };
}
pub(crate) use usage;

impl From<RunError> for Error {
    fn from(error: RunError) -> Error {
        match error {
            RunError::Again(why) => Error::Again(why),
            other => Error::usage(other),
        }
    }
}

impl Error {
    /// Why a subcommand has no result for this scene.
    pub fn ended(exit: Exit, name: &str, why: impl Display) -> Error {
        Error::Ended(exit, format!("{name}: {why}"))
    }

    /// Another error as one of usage.
    pub fn usage(error: impl ToString) -> Error {
        Error::Usage(error.to_string())
    }
}

fn how_to_overwrite(error: &FileError) -> &'static str {
    match error {
        FileError::Exists(_) => " (use --force)",
        FileError::Failed { .. } | FileError::Folder { .. } => "",
    }
}

/// A scene, and changes to it.
#[derive(Debug, clap::Args)]
pub struct SceneArgs {
    /// A scene file, or the name of a built-in scene
    pub scene: String,
    #[command(flatten)]
    pub set: SetArgs,
}

impl SceneArgs {
    /// Opens the scene.
    pub fn open(&self) -> Result<Scene, SceneError> {
        Scene::open(&self.scene, &self.set.set)
    }
}

/// Changes to a scene.
#[derive(Debug, clap::Args)]
pub struct SetArgs {
    /// Changes a value of the scene, by a path that `check --paths` lists; may be repeated
    #[arg(long, value_name = "PATH=VALUE", value_parser = assignment)]
    pub set: Vec<(String, String)>,
}

fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((path, value)) => Ok((path.to_owned(), value.to_owned())),
        None => Err("expected PATH=VALUE, such as friction.angle=20".to_owned()),
    }
}

/// Parses a tolerance. A comparison with NaN would find no difference.
pub fn tolerance(text: &str) -> Result<f64, String> {
    text.parse::<f64>()
        .ok()
        .filter(|part| *part >= 0.0 && part.is_finite())
        .ok_or_else(|| "expected a number that is at least 0, such as 1e-9".to_owned())
}

/// Quotes a word for a shell.
pub fn quoted(word: &str) -> String {
    if !word.is_empty()
        && word
            .chars()
            .all(|c| c.is_alphanumeric() || "-_./=,:+@%".contains(c))
    {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// Prints a message to standard error. Unlike `eprintln`, it does not panic if standard error is closed.
pub fn notify(message: &str) {
    let _ = writeln!(io::stderr(), "{}", shown::text(message));
}

/// Runs a solver to the end of its history, and returns the failure that ends it early.
pub fn run_to_end(stepper: &mut Stepper) -> Option<Failure> {
    let go = |_: &mut Stepper| ControlFlow::<Infallible>::Continue(());
    match stepper.drive(Until::end(), go) {
        RunEnd::Failed(failure) => Some(failure),
        _ => None,
    }
}

/// Result of writing to standard output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputState {
    Well,
    /// The reader has closed the pipe, which is no error.
    Closed,
}

/// Writes data to standard output, with control characters replaced.
pub fn say(text: &str) -> Result<OutputState, Error> {
    print(&shown::text(text))
}

/// Prints the whole answer of a subcommand.
pub fn answer(text: &str) -> Result<Exit, Error> {
    say(text)?;
    Ok(Exit::Good)
}

/// Writes data to standard output unchanged.
pub fn print(text: &str) -> Result<OutputState, Error> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(OutputState::Well),
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(OutputState::Closed),
        Err(e) => Err(Error::Output(e)),
    }
}

/// Writes a text to a file and reports that; without a file, or for `-`, writes to standard output.
pub fn put(output: Option<&Path>, text: &str, force: bool) -> Result<Exit, Error> {
    match output.filter(|path| path.as_os_str() != "-") {
        Some(path) => {
            files::write(path, text, force)?;
            notify(&format!("wrote {}", path.display()));
        }
        None => drop(say(text)?),
    }
    Ok(Exit::Good)
}

/// Reads a whole number.
pub fn whole<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    let number = text.parse().ok();
    number.ok_or_else(|| "expected a whole number, not negative".to_owned())
}

/// Refuses to replace the input, even with `--force`.
pub fn spare_input(input: &str, output: &Path) -> Result<(), Error> {
    let place = |path: &Path| path.canonicalize().ok();
    if place(output).is_some_and(|output| place(Path::new(input)) == Some(output)) {
        let output = output.display();
        return Err(usage!(
            "{output} is the input; the output needs another file"
        ));
    }
    Ok(())
}

/// Rejects options that name the same file.
pub fn distinct(named: &[(&str, Option<&str>)]) -> Result<(), Error> {
    let given = || named.iter().filter_map(|(_, name)| *name);
    let twice = given().find(|name| given().filter(|other| other == name).count() > 1);
    let Some(name) = twice else { return Ok(()) };
    let options: Vec<&str> = named.iter().map(|(option, _)| *option).collect();
    let (last, first) = options.split_last().unwrap_or((&"", &[]));
    let target = match name {
        "-" => "standard output".to_owned(),
        _ => format!("the file {name}"),
    };
    Err(usage!(
        "only one of {} and {last} can write to {target}",
        first.join(", ")
    ))
}

/// The message for a missing file that has the name of a built-in scene; `None` for other names.
pub fn scene_instead(file: &Path) -> Option<String> {
    let name = file.to_str().filter(|_| !file.exists())?;
    builtin::find(name)?;
    Some(format!(
        "{name}: a built-in scene, not a file; `stickslip {name}` opens it, `stickslip run {name}` solves it"
    ))
}
