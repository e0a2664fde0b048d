//! `stickslip [SCENE]`: the debugger.

use super::base::{Error, Exit, SetArgs, usage};
use super::front;
use super::groups;
use std::io::IsTerminal;
use std::path::PathBuf;
use stickslip_debugger::{JournalTarget, Recording, Session};
use stickslip_scene::Scene;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A scene file, or the name of a built-in scene; without one, the debugger lists the built-in ones. The .cel file of a
    /// finished CalculiX run, or an exchange written by `attach --exchange`, opens that run read-only
    scene: Option<String>,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    keep: JournalArgs,
}

/// The journal of a session.
#[derive(Debug, clap::Args)]
pub struct JournalArgs {
    /// Writes the session's journal to a new file [default: in the user's state directory]
    #[arg(long, value_name = "FILE", conflicts_with = "no_journal")]
    journal: Option<PathBuf>,
    /// Writes no journal; the session cannot be resumed
    #[arg(long)]
    no_journal: bool,
}

impl JournalArgs {
    /// Where it is written.
    pub fn target(&self) -> JournalTarget {
        match &self.journal {
            _ if self.no_journal => JournalTarget::Nowhere,
            Some(file) => JournalTarget::File(file.clone()),
            None => JournalTarget::Default,
        }
    }
}

impl Args {
    /// An option that only a scene that is to be solved can take.
    fn changed(&self) -> Option<&'static str> {
        match (self.set.set.is_empty(), &self.keep.journal) {
            (false, _) => Some("--set"),
            (true, Some(_)) => Some("--journal"),
            (true, None) => None,
        }
    }
}

pub fn main(args: Args) -> Result<Exit, Error> {
    if args.scene.is_none()
        && let Some(asked) = args.changed()
    {
        return Err(usage!("{asked} needs a scene"));
    }
    if let Some(text) = args.scene.as_deref().and_then(groups::unknown) {
        return Err(Error::Usage(text));
    }
    front::ready()?;
    if let Some(name) = args.scene.as_deref()
        && let Some(recording) = Recording::open(name).map_err(Error::Usage)?
    {
        return view(recording, name, &args);
    }
    let scene = args.scene.as_deref().unwrap_or("SCENE");
    let terminal = needs_terminal(
        DEBUGGER,
        &format!("run {scene} --csv -` solves without one"),
    );
    if let (Err(_), Some(scene)) = (&terminal, &args.scene) {
        // The command of the message must be able to read the file.
        Scene::open_any(scene, &args.set.set)?;
    }
    terminal?;
    front::debug(args.scene, &args.set.set, &args.keep.target())?;
    Ok(Exit::Good)
}

/// Shows a finished run.
fn view(recording: Recording, name: &str, args: &Args) -> Result<Exit, Error> {
    let kind = recording.kind();
    if let Some(asked) = args.changed() {
        return Err(usage!("{asked} cannot be used with this input: {kind}"));
    }
    needs_terminal(DEBUGGER, &format!("story {name}` prints it as text"))?;
    let words = recording.greeting();
    front::resume(Session::recorded(recording), words)?;
    Ok(Exit::Good)
}

/// The name of the debugger in messages.
pub const DEBUGGER: &str = "the debugger";

/// Fails if there is no terminal; `instead` names a subcommand that needs none.
pub fn needs_terminal(what: &str, instead: &str) -> Result<(), Error> {
    if std::io::stdin().is_terminal() && std::io::stdout().is_terminal() {
        Ok(())
    } else {
        Err(usage!(
            "{what} needs a terminal, but stdin or stdout is not one; `stickslip {instead}"
        ))
    }
}
