//! `stickslip serve`: makes stickslip's own solver attachable, over standard input and output.

use super::base::{Error, Exit, SceneArgs, usage};
use std::io;
use stickslip_attach::serve::serve;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let scene = args.scene.open()?;
    match serve(&scene, io::stdin().lock(), io::stdout().lock()) {
        Err(error) if error.kind() == io::ErrorKind::InvalidData => {
            Err(usage!("standard input: {error}"))
        }
        // The debugger may close the connection.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Error::Output(error)),
        _ => Ok(Exit::Good),
    }
}
