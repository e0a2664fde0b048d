//! What all subcommands need: exit codes, errors, the scene that is named, and how the user is told.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use stickslip_debugger::record::journal::JournalError;
use stickslip_debugger::record::snapshot::SnapshotError;
use stickslip_platform::files::{self, FileError};
use stickslip_scene::format::SceneError;
use stickslip_scene::shown;
use stickslip_scene::{Scene, builtin};

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Converged, equal, or sound.
    Good = 0,
    /// Snapshots differ, or benchmarks do not hold.
    Differ = 1,
    /// Bad input or usage.
    Bad = 2,
    /// The solve did not converge, or nothing that was tried helps.
    Unconverged = 3,
    /// Cells of a sweep are missing: what was printed does them.
    Incomplete = 4,
    /// The machine failed, and not the input: another try may go well.
    Again = 75,
    /// Stopped from outside by Ctrl-C; a reader that closes the pipe stops nothing that he wants.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}

/// Why a subcommand could not do its work; all of these but one are bad input or usage.
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
    /// A file that another run has, or that the system did not let be written.
    #[error("{0}")]
    Again(String),
    #[error("standard output: {0}")]
    Output(io::Error),
}

fn how_to_overwrite(error: &FileError) -> &'static str {
    match error {
        FileError::Exists(_) => " (--force does it)",
        FileError::Failed { .. } => "",
    }
}

/// A scene, and what is changed in it.
#[derive(Debug, clap::Args)]
pub struct SceneArgs {
    /// A scene file, or the name of a built-in scene
    pub scene: String,
    #[command(flatten)]
    pub set: SetArgs,
}

impl SceneArgs {
    /// Opens it.
    pub fn open(&self) -> Result<Scene, SceneError> {
        Scene::open(&self.scene, &self.set.set)
    }
}

/// Changes to a scene.
#[derive(Debug, clap::Args)]
pub struct SetArgs {
    /// Changes a value of the scene, by a path as `check --paths` lists it; may be repeated
    #[arg(long, value_name = "PATH=VALUE", value_parser = assignment)]
    pub set: Vec<(String, String)>,
}

/// A value on the command line that will not do: what it must be.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct NoValue(String);

impl NoValue {
    /// With what it must be.
    pub fn new(must_be: impl Into<String>) -> NoValue {
        NoValue(must_be.into())
    }
}

fn assignment(text: &str) -> Result<(String, String), NoValue> {
    match text.split_once('=') {
        Some((path, value)) => Ok((path.to_owned(), value.to_owned())),
        None => Err(NoValue::new("it must be PATH=VALUE, as friction.angle=20")),
    }
}

/// Quotes a word for a shell.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=,:+@%".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

/// A message to the user. Unlike `eprintln`, it survives a standard error that nobody reads.
pub fn tell(message: &str) {
    let _ = writeln!(io::stderr(), "{}", shown::text(message));
}

/// What became of data for standard output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sent {
    Well,
    /// Nobody reads on, which is no fault.
    Closed,
}

/// Data to standard output, harmless to a terminal.
pub fn say(text: &str) -> Result<Sent, Error> {
    print(&shown::text(text))
}

/// Data to standard output as it is.
pub fn print(text: &str) -> Result<Sent, Error> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(Sent::Well),
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(Sent::Closed),
        Err(e) => Err(Error::Output(e)),
    }
}

/// Writes a text to a file, and says so; to standard output without one, and for `-`.
pub fn put(output: Option<&Path>, text: &str, force: bool) -> Result<Exit, Error> {
    match output.filter(|path| path.as_os_str() != "-") {
        Some(path) => {
            files::write(path, text, force)?;
            tell(&format!("wrote {}", path.display()));
        }
        None => drop(say(text)?),
    }
    Ok(Exit::Good)
}

/// Refuses files that two options name.
pub fn distinct(named: &[(&str, Option<&str>)]) -> Result<(), Error> {
    let given = || named.iter().filter_map(|(_, name)| *name);
    let twice = given().find(|name| given().filter(|other| other == name).count() > 1);
    let Some(name) = twice else { return Ok(()) };
    let options: Vec<&str> = named.iter().map(|(option, _)| *option).collect();
    let (last, first) = options.split_last().unwrap_or((&"", &[]));
    Err(Error::Usage(format!(
        "{name}: only one of {} and {last} can go there",
        first.join(", ")
    )))
}

/// What to say of a file that is missing, where a built-in scene has its name. `None` where none has.
pub fn scene_instead(file: &Path) -> Option<String> {
    let name = file.to_str().filter(|_| !file.exists())?;
    builtin::find(name)?;
    Some(format!(
        "{name}: this is a built-in scene, and no file; `stickslip {name}` opens it, `stickslip run {name}` solves it"
    ))
}
