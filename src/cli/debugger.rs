//! `stickslip [SCENE]`: the debugger.

use super::base::{Error, Exit, SetArgs};
use super::front;
use super::groups;
use super::past;
use crate::attach::past::Opened;
use crate::record::journal::Keep;
use crate::session::Session;
use std::io::IsTerminal;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A scene file, or the name of a built-in scene; without one, the debugger offers the built-in ones. The .cel of a
    /// CalculiX run that is over opens that run, to be looked at, and so does the exchange that `attach --exchange` kept
    scene: Option<String>,
    #[command(flatten)]
    set: SetArgs,
    /// Keeps the journal of the session in a new file [default: in the user's directory for states]
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with = "no_journal",
        requires = "scene"
    )]
    journal: Option<PathBuf>,
    /// Keeps no journal; what is done cannot be resumed then
    #[arg(long)]
    no_journal: bool,
}

pub fn main(args: Args) -> Result<Exit, Error> {
    if args.scene.is_none() && !args.set.set.is_empty() {
        return Err(Error::Usage("--set needs a scene to change".into()));
    }
    if let Some(told) = args.scene.as_deref().and_then(groups::unknown) {
        return Err(Error::Usage(told));
    }
    front::ready()?;
    if let Some(past) = args
        .scene
        .as_deref()
        .map(past::named)
        .transpose()?
        .flatten()
    {
        let asked = [
            (!args.set.set.is_empty(), "--set"),
            (args.journal.is_some(), "--journal"),
        ];
        if let Some((_, asked)) = asked.into_iter().find(|(is, _)| *is) {
            return Err(Error::Usage(past::read_only(asked)));
        }
        if !has_terminal() {
            let name = past.name;
            return Err(Error::Usage(format!(
                "to look at a run needs a terminal, and standard input or output is none; `stickslip show {name}` prints it as text"
            )));
        }
        front::look(past)?;
        return Ok(Exit::Good);
    }
    if let Some(opened) = args.scene.as_deref().map(past::kept).transpose()?.flatten() {
        return look_at(opened, &args);
    }
    if !has_terminal() {
        let scene = args.scene.as_deref().unwrap_or("SCENE");
        return Err(Error::Usage(format!(
            "the debugger needs a terminal, and standard input or output is none; `stickslip run {scene} --csv -` solves without one"
        )));
    }
    let keep = match args.journal {
        _ if args.no_journal => Keep::Nowhere,
        Some(file) => Keep::File(file),
        None => Keep::Default,
    };
    front::debug(args.scene, &args.set.set, &keep)?;
    Ok(Exit::Good)
}

/// Looks at an exchange that was kept.
fn look_at(opened: Opened, args: &Args) -> Result<Exit, Error> {
    let asked = [
        (!args.set.set.is_empty(), "--set"),
        (args.journal.is_some(), "--journal"),
    ];
    if let Some((_, asked)) = asked.into_iter().find(|(is, _)| *is) {
        return Err(Error::Usage(format!(
            "{asked} does not go with it; a kept exchange is read-only"
        )));
    }
    if !has_terminal() {
        let name = args.scene.as_deref().unwrap_or("FILE");
        return Err(Error::Usage(format!(
            "to look at a kept exchange needs a terminal, and standard input or output is none; `stickslip story {name}` prints it as text"
        )));
    }
    let told =
        "a kept exchange: all that the solver did, to be gone through; nothing can follow on it";
    front::resume(Session::kept(opened), told)?;
    Ok(Exit::Good)
}

/// Whether there is a terminal to debug in.
pub fn has_terminal() -> bool {
    std::io::stdin().is_terminal() && std::io::stdout().is_terminal()
}
