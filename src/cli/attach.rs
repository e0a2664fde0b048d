//! `stickslip attach`: a solver that another program is, stepped in the debugger; tried; or what an author needs to write one.

use super::base::{Error, Exit, say, tell};
use super::debugger::{DEBUGGER, needs_terminal};
use super::front;
use super::solver::SolverArgs;
use std::path::PathBuf;
use stickslip_attach::{PYTHON, check};
use stickslip_debugger::record::journal::Keep;
use stickslip_debugger::session::Session;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    solver: SolverArgs,
    /// Tries whether the solver does what it says it does, and says what to mend
    #[arg(long, requires = "command")]
    check: bool,
    /// Prints the Python side of the protocol, a module of one file
    #[arg(long, conflicts_with = "command")]
    python: bool,
    /// Keeps the journal of the session in a new file [default: in the user's directory for states]
    #[arg(long, value_name = "FILE", conflicts_with = "no_journal")]
    journal: Option<PathBuf>,
    /// Keeps no journal; what is done cannot be resumed then
    #[arg(long)]
    no_journal: bool,
    /// Overwrites a kept exchange that exists
    #[arg(long)]
    force: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    if args.python {
        say(PYTHON)?;
        return Ok(Exit::Good);
    }
    if !args.solver.is_named() {
        return Err(Error::Usage(
            "no solver is named: stickslip attach -- COMMAND…; `stickslip help protocol` tells what it must speak".into(),
        ));
    }
    if args.check {
        return checked(args);
    }
    front::ready()?;
    needs_terminal(
        DEBUGGER,
        "run --trace - -- COMMAND` steps a solver without one",
    )?;
    let keep = match args.journal {
        _ if args.no_journal => Keep::Nowhere,
        Some(ref file) => Keep::File(file.clone()),
        None => Keep::Default,
    };
    let (scene, attached, log) = args.solver.attach(args.force)?;
    let told = format!(
        "attached to {} {}",
        attached.hello().name,
        attached.hello().version
    );
    let mut session = Session::attached(scene, Box::new(attached), log);
    keep.begin(&mut session)?;
    front::resume(session, told.trim_end())?;
    Ok(Exit::Good)
}

/// Tries a solver, and prints what was found.
fn checked(args: &Args) -> Result<Exit, Error> {
    let log = args.solver.log(args.force)?;
    let report = check::check(&args.solver.start(), &log);
    say(&report.text())?;
    if let Some(lost) = log.lost() {
        tell(&format!("warning: {lost}"));
    }
    let failed = report.failed();
    if failed > 0 {
        let s = if failed == 1 { "" } else { "s" };
        tell(&format!("{failed} check{s} failed"));
        return Ok(Exit::Differ);
    }
    Ok(Exit::Good)
}
