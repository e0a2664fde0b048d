//! `stickslip --version --verbose`: build, machine, terminal and folders, for bug reports.

use super::base::{Error, Exit, answer};
use std::env;
use std::fmt::Write;
use std::io::{IsTerminal, stderr, stdin, stdout};
use std::path::PathBuf;
use stickslip_core::linear::estimate;
use stickslip_debugger::action::config;
use stickslip_debugger::record::journal;
use stickslip_platform::system;
use stickslip_platform::terminal::{self, Answers};
use stickslip_scene::{joined, memory};
use stickslip_study::origin;

pub fn main(verbose: bool) -> Result<Exit, Error> {
    let mut text = origin::program() + "\n";
    if verbose {
        let parts = [
            ("features", features()),
            ("target", target()),
            ("machine", origin::machine()),
            ("threads", threads()),
            ("memory", estimate::bytes(memory::free()) + " for scenes"),
            ("streams", streams()),
            ("terminal", terminal()),
            ("asked", terminal_answers()),
            ("locale", variables(&["LC_ALL", "LC_CTYPE", "LANG"])),
            ("folder", here()),
            ("journals", folder(journal::directory().ok())),
            ("state", folder(journal::home().ok())),
            ("settings", folder(config::folder())),
        ];
        for (name, words) in parts {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{name:<10}{words}");
        }
    }
    answer(&text)
}

fn features() -> String {
    let all = [
        ("tui", cfg!(feature = "tui")),
        ("plot", cfg!(feature = "plot")),
        ("fclib", cfg!(feature = "fclib")),
    ];
    let with = |wanted: bool| {
        joined(
            all.iter()
                .filter(|(_, has)| *has == wanted)
                .map(|(name, _)| *name),
            ", ",
        )
    };
    match (with(true), with(false)) {
        (all, none) if none.is_empty() => all,
        (none, without) if none.is_empty() => format!("none; without {without}"),
        (with, without) => format!("{with}; without {without}"),
    }
}

fn target() -> String {
    let libc = match (
        env::consts::OS,
        cfg!(target_env = "musl"),
        cfg!(target_env = "gnu"),
    ) {
        ("windows", _, true) => "MinGW",
        ("windows", ..) => "MSVC",
        (_, true, _) => "musl",
        (_, _, true) => "glibc",
        _ => "other libc",
    };
    let linked = if cfg!(target_feature = "crt-static") {
        ", statically linked"
    } else {
        ""
    };
    let kind = if cfg!(debug_assertions) {
        "; debug build"
    } else {
        ""
    };
    format!(
        "{}/{}, {libc}{linked}{kind}",
        env::consts::OS,
        env::consts::ARCH
    )
}

fn threads() -> String {
    match std::thread::available_parallelism() {
        Ok(threads) => format!("at most {threads}, unless --jobs sets another number"),
        Err(why) => format!("unknown ({why})"),
    }
}

/// Which of the standard streams are terminals.
fn streams() -> String {
    let all = [
        ("input", stdin().is_terminal()),
        ("output", stdout().is_terminal()),
        ("error", stderr().is_terminal()),
    ];
    let words = all.map(|(name, is)| {
        format!(
            "{name}: {}",
            if is { "a terminal" } else { "not a terminal" }
        )
    });
    words.join(", ")
}

/// The environment variables that describe the terminal.
fn terminal() -> String {
    let size = match terminal::size() {
        Some((columns, rows)) => format!("{columns}x{rows}, "),
        None => String::new(),
    };
    let words = variables(&[
        "TERM",
        "COLORTERM",
        "NO_COLOR",
        "TERM_PROGRAM",
        "TERM_PROGRAM_VERSION",
        "TMUX",
        "STY",
        "SSH_TTY",
    ]);
    size + &words
}

fn variables(names: &[&str]) -> String {
    let words: Vec<String> = names
        .iter()
        .filter_map(|name| {
            let value = env::var_os(name)?;
            Some(format!("{name}={}", value.to_string_lossy()))
        })
        .collect();
    if words.is_empty() {
        format!("none of these is set: {}", names.join(", "))
    } else {
        words.join(" ")
    }
}

/// The terminal's answers to queries.
fn terminal_answers() -> String {
    match terminal::ask() {
        Ok(None) => "not asked: standard input or output is not a terminal".into(),
        Ok(Some(answers)) if answers == Answers::default() => "the terminal does not answer".into(),
        Ok(Some(answers)) => words(&answers),
        Err(why) => format!("terminal query failed: {why}"),
    }
}

fn words(answers: &Answers) -> String {
    let known = |known: Option<bool>| match known {
        Some(true) => "yes",
        Some(false) => "no",
        None => "not reported",
    };
    let clipboard = if answers.clipboard() {
        "yes"
    } else {
        "not reported"
    };
    let widths = match answers.other_widths() {
        None => "not reported".into(),
        Some(other) if other.is_empty() => "as expected".into(),
        Some(other) => {
            let words =
                |(what, there, here)| format!("{what} take {there} columns instead of {here}");
            joined(other.into_iter().map(words), ", ")
        }
    };
    let kind = answers.kind.iter().map(u16::to_string);
    format!(
        "mouse (SGR): {}; clipboard (OSC 52): {clipboard}; synchronized updates: {}; widths: {widths}; type: {}",
        known(answers.mouse()),
        known(answers.in_one_go()),
        joined(kind, ";")
    )
}

fn here() -> String {
    match env::current_dir() {
        Ok(here) => folder(Some(here)),
        Err(why) => format!("none: {why}"),
    }
}

/// A folder, with its write permission and free space.
fn folder(folder: Option<PathBuf>) -> String {
    let Some(folder) = folder else {
        return "none: no home directory".into();
    };
    // A missing folder is created when needed, in the nearest existing ancestor.
    let there = folder.ancestors().find(|above| above.exists());
    let may = there.is_some_and(system::is_writable);
    let rights = match (folder.exists(), may) {
        (true, true) => "writable",
        (true, false) => "not writable",
        (false, true) => "does not exist yet, can be created",
        (false, false) => "does not exist, cannot be created",
    };
    let free = there.and_then(system::free_bytes);
    let free = free
        .map(|free| format!("; {} free", estimate::bytes(free)))
        .unwrap_or_default();
    format!("{} {rights}{free}", folder.display())
}
