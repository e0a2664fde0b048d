//! The command line, with one file per subcommand; `base` is shared by all.
//!
//! Standard output carries only data; messages go to standard error, and progress too if it is a terminal. Exit codes are those of
//! `base::Exit`.

mod about;
mod attach;
mod audit;
mod base;
mod benchmarks;
mod chart;
mod check;
mod completions;
mod core;
mod course;
mod debugger;
mod diff;
mod export;
#[cfg(feature = "tui")]
mod front;
#[cfg(not(feature = "tui"))]
#[path = "front/disabled.rs"]
mod front;
mod grids;
mod groups;
mod help;
mod interrupt;
mod json;
mod junit;
mod lesson;
mod list;
mod man;
mod map;
mod outputs;
mod place;
mod progress;
mod record;
mod records;
mod remedies;
mod replay;
mod resume;
mod run;
mod run_outputs;
mod screens;
mod serve;
mod show;
mod sink;
mod solver;
mod story;
mod study;
mod sweep;
mod tally;

use base::{Exit, notify, say};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::process::ExitCode;
use stickslip_study::origin;

/// Steps through contact iterations of the finite element method, in a terminal.
#[derive(Debug, Parser)]
#[command(styles = clap::builder::Styles::plain())]
#[command(name = "stickslip", version = origin::VERSION, args_conflicts_with_subcommands = true)]
#[command(
    max_term_width = 100,
    disable_help_subcommand = true,
    disable_version_flag = true
)]
#[command(after_help = "\
SCENE is a file or the name of a built-in scene (`stickslip list`).
The manual: `stickslip help TOPIC`; `stickslip help` lists the topics.

Exit codes: 0 converged, equal or sound; 1 snapshots differ; 2 bad input or usage;
3 the solve did not converge, or no remedy helps; 4 cells of a sweep are missing;
75 a system error, another attempt may succeed; 130 interrupted.")]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    debugger: debugger::Args,
    /// Prints the version
    #[arg(short = 'V', long)]
    version: bool,
    /// With --version: describes build, machine, terminal and folders, for bug reports
    #[arg(long, requires = "version")]
    verbose: bool,
}

/// Defines the subcommands: the help, the name and the module of each, and what its `main` needs besides its arguments.
macro_rules! subcommands {
    ($($(#[$help:meta])* $name:ident $module:ident $(($more:expr))?,)*) => {
        #[derive(Debug, Subcommand)]
        enum Command {
            $($(#[$help])* $name($module::Args),)*
        }

        impl Command {
            fn run(&self) -> Result<Exit, base::Error> {
                match self {
                    $(Command::$name(args) => $module::main(args $(, $more)?),)*
                }
            }
        }
    };
}

subcommands! {
    /// Solves a scene without stopping
    Run run,
    /// Validates a scene and estimates its cost
    Check check,
    /// Lists the built-in scenes
    List list,
    /// Solves up to a position and writes a snapshot of it
    Record record,
    /// Recomputes snapshots and compares
    Replay replay,
    /// Compares two snapshots, node by node
    Diff diff,
    /// Continues a session of the debugger from its journal
    Resume resume,
    /// Prints a journal or a finished CalculiX run as text
    Story story,
    /// Checks every accepted increment from positions and forces alone, and prints the largest violation of each law
    Audit audit,
    /// Tries every remedy at a scene's first failure, and compares them
    Remedies remedies,
    /// Writes the fewest nodes that still cycle as a separate scene
    Core core,
    /// Converts a scene, a snapshot or a journal to a picture or another file, by extension
    Export export,
    /// Solves a scene with many settings and compares
    Study study,
    /// Shows where the iterations converge
    Map map,
    /// Charts error over cost for different settings
    Chart chart,
    /// Steps an external solver
    Attach attach,
    /// Serves stickslip's own solver to a debugger that attaches to it
    Serve serve,
    /// Lists guided lessons, starts one, or checks one
    Lesson lesson,
    /// Prints the file of a built-in scene, study or lesson, or a finished CalculiX run as text
    Show show,
    /// Draws screens of the debugger as pictures
    Screens screens,
    /// Prints a shell's completion script
    Completions completions,
    /// Writes pages for man
    Man man (program()),
    /// Shows a page of the manual, or the help of a subcommand
    Help help (program()),
}

/// Runs the program.
pub fn main() -> ExitCode {
    completions::answer(program);
    let cli = match parsed() {
        Ok(cli) => cli,
        Err(error) => {
            if let Some(text) = groups::mistyped(&error, std::env::args_os().nth(1)) {
                notify(&text);
                return Exit::Bad.into();
            }
            // Clap reports help as an error, too; a failure to print it is ignored.
            // The typed text is shown unchanged; the message has no colours.
            let text = error.render().ansi().to_string();
            if error.use_stderr() {
                notify(text.trim_end_matches('\n'))
            } else {
                drop(say(&text))
            }
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    stickslip_platform::signals::let_large_writes_fail();
    if !matches!(
        cli.command,
        None | Some(
            Command::Run(_)
                | Command::Attach(_)
                | Command::Record(_)
                | Command::Study(_)
                | Command::Map(_)
                | Command::Chart(_)
                | Command::Resume(_)
                | Command::Lesson(_)
                | Command::Audit(_)
                | Command::Export(_)
                | Command::Help(_)
        )
    ) {
        // These have nothing to finish; a file that they replace gets its new content in one step.
        interrupt::end_at_once();
    }
    let ended = match &cli.command {
        None if cli.version => about::main(cli.verbose),
        None => debugger::main(cli.debugger),
        Some(command) => command.run(),
    };
    ended
        .unwrap_or_else(|error| {
            notify(&error.to_string());
            match error {
                base::Error::Ended(exit, _) => exit,
                base::Error::Again(_) => Exit::Again,
                _ => Exit::Bad,
            }
        })
        .into()
}

/// The command line, with the subcommands in groups. A negative number is a value, which its option then refuses, and never a
/// misspelt option.
pub fn program() -> clap::Command {
    let negative = |arg: clap::Arg| {
        let takes_values = arg.get_action().takes_values();
        arg.allow_negative_numbers(takes_values)
    };
    groups::grouped(Cli::command())
        .mut_args(negative)
        .mut_subcommands(|own| own.mut_args(negative))
}

fn parsed() -> Result<Cli, clap::Error> {
    Cli::from_arg_matches(&program().try_get_matches()?)
}

/// The records that `--json` writes with their fields, for the manual.
pub fn json_records() -> String {
    records::markdown()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_subcommand_is_in_one_group() {
        let command = Cli::command();
        let mut own: Vec<_> = command.get_subcommands().map(|c| c.get_name()).collect();
        let mut grouped: Vec<_> = groups::names().collect();
        own.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(own, grouped);
    }

    #[test]
    fn every_argument_has_completions_or_is_free() {
        let program = program();
        for command in std::iter::once(&program).chain(program.get_subcommands()) {
            for arg in command.get_arguments() {
                let takes = arg.get_action().takes_values();
                let (command, id) = (command.get_name(), arg.get_id());
                assert!(!takes || completions::knows(arg), "{command} {id}");
            }
        }
    }
}
