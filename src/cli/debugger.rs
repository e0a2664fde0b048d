//! `stickslip [SCENE]`: the debugger.

use super::{Error, Exit, SetArgs};
use crate::tui;
use std::io::IsTerminal;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A scene file, or the name of a built-in scene; without one, the debugger offers the built-in ones
    scene: Option<String>,
    #[command(flatten)]
    set: SetArgs,
}

pub fn main(args: Args) -> Result<Exit, Error> {
    if args.scene.is_none() && !args.set.set.is_empty() {
        return Err(Error::Usage("--set needs a scene to change".into()));
    }
    if !std::io::stdin().is_terminal() || !std::io::stdout().is_terminal() {
        let scene = args.scene.as_deref().unwrap_or("SCENE");
        return Err(Error::Usage(format!(
            "the debugger needs a terminal, and standard input or output is none; `stickslip run {scene} --csv -` solves without one"
        )));
    }
    tui::run(args.scene, &args.set.set).map_err(|error| Error::Usage(error.to_string()))?;
    Ok(Exit::Good)
}
