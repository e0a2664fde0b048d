//! `stickslip attach`: steps an external solver in the debugger, checks its protocol, or prints a client for writing one.

use super::base::{Error, Exit, answer, notify, say, usage};
use super::debugger::{DEBUGGER, JournalArgs, needs_terminal};
use super::front;
use super::solver::SolverArgs;
use stickslip_attach::{C, FORTRAN, PYTHON, SCHEMA, check};
use stickslip_core::counted;
use stickslip_debugger::Session;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    solver: SolverArgs,
    /// Checks that the solver does what it offers, and reports how to fix it
    #[arg(long, requires = "command")]
    check: bool,
    /// Prints the Python module of the protocol (a single file)
    #[arg(long, conflicts_with = "command")]
    python: bool,
    /// Prints the C and C++ header for solvers that keep their loops
    #[arg(long, conflicts_with_all = ["command", "python"])]
    c: bool,
    /// Prints the Fortran module on top of the C header
    #[arg(long, conflicts_with_all = ["command", "python", "c"])]
    fortran: bool,
    /// Prints the JSON schema of the messages that a solver sends
    #[arg(long, conflicts_with_all = ["command", "python", "c", "fortran"])]
    schema: bool,
    #[command(flatten)]
    keep: JournalArgs,
    /// Overwrites an existing --exchange file
    #[arg(long)]
    force: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    let clients = [
        (args.python, PYTHON),
        (args.c, C),
        (args.fortran, FORTRAN),
        (args.schema, SCHEMA),
    ];
    if let Some((_, text)) = clients.iter().find(|(asked, _)| *asked) {
        return answer(text);
    }
    if !args.solver.is_named() {
        return Err(usage!(
            "no solver given; use stickslip attach -- COMMAND… (`stickslip help protocol` describes the protocol)"
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
    let keep = args.keep.target();
    let (scene, attached, log) = args.solver.attach(args.force, None)?;
    let text = format!(
        "attached to {} {}",
        attached.hello().name,
        attached.hello().version
    );
    let mut session = Session::attached(scene, Box::new(attached), log);
    keep.begin(&mut session)?;
    front::resume(session, text.trim_end())?;
    Ok(Exit::Good)
}

/// Checks a solver, and prints the report.
fn checked(args: &Args) -> Result<Exit, Error> {
    let log = args.solver.log(args.force)?;
    let report = check::check(&args.solver.start(), &log);
    say(&report.text())?;
    if let Some(lost) = log.lost() {
        notify(&format!("warning: {lost}"));
    }
    let failed = report.failed();
    if failed > 0 {
        notify(&format!("{} failed", counted(failed, "check")));
        return Ok(Exit::Differ);
    }
    Ok(Exit::Good)
}
