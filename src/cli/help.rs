//! `stickslip help [TOPIC]`: shows and searches the manual's pages, and shows the help of subcommands.

use super::base::{Error, Exit, answer, print, say, usage};
use std::ffi::OsString;
use std::io::{IsTerminal, Write};
use std::process::Stdio;
use std::sync::Arc;
use stickslip_manual::{self as manual, Page, render};
use stickslip_platform::{system, terminal};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// A page of the manual, or a subcommand; without one, lists the pages
    topic: Option<String>,
    /// Lists the lines of the manual that contain this text, with their topics and headings
    #[arg(long, value_name = "WORD", conflicts_with = "topic")]
    search: Option<String>,
}

/// Shows the requested page; `program` is the whole command line.
pub fn main(args: &Args, program: clap::Command) -> Result<Exit, Error> {
    match (&args.topic, &args.search) {
        (None, Some(word)) => search(word),
        (None, None) => contents(),
        (Some(topic), _) if program.find_subcommand(topic).is_some() => subcommand(topic, program),
        (Some(topic), _) => show(manual::page(topic).map_err(Error::usage)?),
    }
}

fn contents() -> Result<Exit, Error> {
    let pages = manual::contents();
    say(&format!(
        "Pages of the manual (`stickslip help TOPIC`; `stickslip help --search WORD`):\n\n{pages}\n\
         `stickslip --help` lists the subcommands, `stickslip help SUBCOMMAND` explains one.\n"
    ))?;
    Ok(Exit::Good)
}

/// The text of `SUBCOMMAND --help`.
fn subcommand(name: &str, program: clap::Command) -> Result<Exit, Error> {
    if let Err(help) = program.try_get_matches_from(["stickslip", name, "--help"]) {
        say(&help.render().to_string())?;
    }
    Ok(Exit::Good)
}

fn search(word: &str) -> Result<Exit, Error> {
    let hits = manual::search(word);
    if hits.is_empty() {
        let word = stickslip_scene::shown::cut(word, 40);
        return Err(usage!("no page of the manual contains '{word}'"));
    }
    let mut text = String::new();
    let mut above = ("", String::new());
    for hit in hits {
        let here = (hit.topic, hit.heading);
        if here != above {
            text += &format!("{}: {}\n", here.0, here.1);
        }
        text += &format!("    {}\n", hit.line);
        above = here;
    }
    answer(&text)
}

/// Shows a page, through a pager on a terminal, otherwise as plain text.
fn show(page: &Page) -> Result<Exit, Error> {
    let terminal = std::io::stdout().is_terminal();
    let width = if terminal {
        terminal::size().map_or(render::WIDTH, |(columns, _)| {
            usize::from(columns).clamp(40, 100)
        })
    } else {
        render::WIDTH
    };
    let styled = terminal && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    let lines = render::render(page.text(), width);
    let text: String = lines
        .iter()
        .map(|line| {
            if styled {
                line.ansi() + "\n"
            } else {
                line.plain() + "\n"
            }
        })
        .collect();
    if terminal && paged(&text) {
        return Ok(Exit::Good);
    }
    // Not through `say`, which would replace the styles; the pages are trusted.
    print(&text)?;
    Ok(Exit::Good)
}

/// Shows a text with the user's pager; returns false if none could be started.
fn paged(text: &str) -> bool {
    // The pager handles Ctrl-C while it runs.
    let kept = signal_hook::flag::register(signal_hook::consts::SIGINT, Arc::default());
    let mut command = system::shell();
    let pager = std::env::var_os("PAGER").filter(|pager| !pager.is_empty());
    command
        .arg(pager.unwrap_or_else(|| OsString::from(system::PAGER)))
        .stdin(Stdio::piped());
    if std::env::var_os("LESS").is_none() {
        // So that `PAGER=less` shows bold text, too.
        command.env("LESS", "R");
    }
    let shown = command.spawn().and_then(|mut child| {
        if let Some(mut pipe) = child.stdin.take() {
            // A pager that is left early closes the pipe.
            let _ = pipe.write_all(text.as_bytes());
        }
        child.wait()
    });
    if let Ok(kept) = kept {
        signal_hook::low_level::unregister(kept);
    }
    // The shell's exit codes 126 and 127 mean that the pager cannot be run.
    shown.is_ok_and(|status| !matches!(status.code(), Some(126 | 127)))
}
