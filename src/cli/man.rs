//! `stickslip man`: pages for man, one for the program and one for each subcommand.

use super::base::{Error, Exit, answer, notify};
use clap_mangen::Man;
use std::path::PathBuf;
use stickslip_platform::files;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Writes all pages to this folder, which is created if necessary: stickslip.1, stickslip-run.1, ... [default: the program's
    /// page, to standard output]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Overwrites existing files
    #[arg(long, requires = "output")]
    force: bool,
}

/// Writes the pages.
pub fn main(args: &Args, mut program: clap::Command) -> Result<Exit, Error> {
    program.build();
    let Some(folder) = &args.output else {
        return answer(&page(&program)?);
    };
    files::create_folder(folder)?;
    let mut pages = Vec::new();
    for command in std::iter::once(&program).chain(program.get_subcommands()) {
        let name = command.get_display_name().unwrap_or(command.get_name());
        pages.push((folder.join(format!("{name}.1")), page(command)?));
    }
    files::write_all(&pages, args.force)?;
    notify(&format!(
        "wrote {} pages to {}; `man -M` reads them if the folder is named man1",
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
