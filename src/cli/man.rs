//! `stickslip man`: manual pages for `man`, one of the program and one of each subcommand.

use super::base::{Error, Exit, say, tell};
use clap_mangen::Man;
use std::path::PathBuf;
use stickslip_platform::files;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Writes all pages into this folder, which is made where it is not there: stickslip.1, stickslip-run.1, ...
    /// [default: the page of the program itself, to standard output]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Overwrites files that exist
    #[arg(long, requires = "output")]
    force: bool,
}

/// Writes the pages of the whole command line.
pub fn main(args: &Args, mut program: clap::Command) -> Result<Exit, Error> {
    program.build();
    let Some(folder) = &args.output else {
        say(&page(&program)?)?;
        return Ok(Exit::Good);
    };
    std::fs::create_dir_all(folder)
        .map_err(|why| Error::Usage(format!("{}: {why}", folder.display())))?;
    let mut pages = Vec::new();
    for command in std::iter::once(&program).chain(program.get_subcommands()) {
        let name = command.get_display_name().unwrap_or(command.get_name());
        pages.push((folder.join(format!("{name}.1")), page(command)?));
    }
    files::write_all(&pages, args.force)?;
    tell(&format!(
        "wrote {} pages to {}; `man -M` reads them where the folder is called man1",
        pages.len(),
        folder.display()
    ));
    Ok(Exit::Good)
}

fn page(command: &clap::Command) -> Result<String, Error> {
    let mut page = Vec::new();
    Man::new(command.clone())
        .render(&mut page)
        .map_err(Error::Output)?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}
