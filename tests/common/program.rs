//! What the tests of the built program share: running it, and reading what it says.
#![allow(dead_code)]

use std::collections::HashMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

/// The program with these arguments, in a directory, without input. What the user of this machine keeps is nothing to it: it has a
/// home in which nothing can be made.
pub fn program(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    command.env("HOME", "/dev/null");
    for place in [
        "XDG_STATE_HOME",
        "XDG_CONFIG_HOME",
        "XDG_DATA_HOME",
        "XDG_CACHE_HOME",
    ] {
        command.env_remove(place);
    }
    command.args(arguments).stdin(Stdio::null());
    command.current_dir(directory);
    command
}

/// The output of the program in a directory.
pub fn ran(directory: &Path, arguments: &[&str]) -> Output {
    program(directory, arguments).output().unwrap()
}

/// The words of a command line without quotes.
pub fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

pub fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

/// What it wrote to standard output, having ended well.
pub fn well(output: &Output) -> String {
    assert_eq!(code(output), 0, "{}", err(output));
    out(output)
}

/// It ended with exit code 2 and said this to standard error.
#[track_caller]
pub fn refused(output: &Output, part: &str) {
    let told = err(output);
    assert_eq!(code(output), 2, "{told}");
    assert!(told.contains(part), "{part:?} in {told}");
}

pub fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub fn err(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Reads the header of a CSV file or a trace from standard output, closes the pipe, and waits for the program to end well.
pub fn read_first_line(mut program: Command) -> Output {
    let mut child = program
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(lines.next().unwrap().unwrap().starts_with("increment,"));
    drop(lines);
    let output = child.wait_with_output().unwrap();
    assert_eq!(code(&output), 0, "{}", err(&output));
    output
}

/// Ends it as Ctrl-C does; the output is that of a program that was interrupted.
pub fn interrupted(child: Child) -> Output {
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(killed.unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(code(&output), 130, "{}", err(&output));
    output
}

/// Names of what is in a directory, sorted.
pub fn names(directory: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(directory).unwrap();
    let mut names: Vec<String> = entries
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// The rows of a whole table without its comments, by column.
pub fn rows(table: &str) -> Vec<HashMap<String, String>> {
    assert!(table.ends_with('\n'), "cut off: {table:?}");
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let heads = fields(lines.next().unwrap());
    let row = |line: &str| {
        let fields = fields(line);
        assert_eq!(fields.len(), heads.len(), "{line}");
        heads.iter().cloned().zip(fields).collect()
    };
    lines.map(row).collect()
}

/// The fields of a line; a comma between quotation marks separates none.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            other => fields.last_mut().unwrap().push(other),
        }
    }
    fields
}
