//! A solver between the debugger and another: what that offers in `hello` is changed on the way.
//!
//! Its first argument is what `restore` becomes, the second names parts of the others, by commas: `blind` leaves out forces,
//! `upside-down` turns their sign in the states, `flat` halves the matrix of its problem, `flat-first` only in its second answer, `partial` leaves out
//! contacts that did not change, `deaf` answers `set` without handing it on.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::process::{Command, ExitCode, Stdio};
use std::sync::mpsc::channel;

/// The first argument that starts it.
pub const NAME: &str = "--filter";

pub fn main(arguments: &[String]) -> ExitCode {
    let (restore, how, command) = (&arguments[0], &arguments[1], &arguments[2..]);
    let mut child = Command::new(&command[0])
        .args(&command[1..])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut to = child.stdin.take().unwrap();
    let (asked, asks) = channel::<bool>();
    let deaf = how == "deaf";
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines() {
            let line = line.unwrap();
            let handed_on = !(deaf && line.contains("\"set\"") && !line.contains("no such"));
            // `scene` is answered in the place of what is not handed on, and thrown away.
            let sent = if handed_on {
                line
            } else {
                "{\"type\":\"scene\"}".into()
            };
            asked.send(handed_on).unwrap();
            if writeln!(to, "{sent}").is_err() {
                return;
            }
        }
    });
    let mut problems = 0;
    let mut before = None;
    let mut out = std::io::stdout().lock();
    for line in BufReader::new(child.stdout.take().unwrap()).lines() {
        let line = line.unwrap();
        let handed_on = asks.recv().unwrap_or(true);
        let line = match handed_on {
            false => "{\"type\":\"ok\"}".into(),
            true if line.starts_with("{\"type\":\"hello\"") => changed(&line, |hello| {
                hello["abilities"]["restore"] = json!(restore);
                if how == "partial" {
                    hello["abilities"]["partial"] = json!(true);
                }
            }),
            true if line.starts_with("{\"type\":\"state\"") && how == "partial" => {
                partial(&line, &mut before)
            }
            true if line.starts_with("{\"type\":\"state\"") && how == "upside-down" => {
                changed(&line, upside_down)
            }
            true if line.starts_with("{\"type\":\"problem\"") && how.starts_with("flat") => {
                problems += 1;
                match how == "flat" || problems == 2 {
                    true => changed(&line, flat),
                    false => line,
                }
            }
            true => line,
        };
        if writeln!(out, "{line}").and_then(|()| out.flush()).is_err() {
            break;
        }
    }
    let _ = child.wait();
    ExitCode::SUCCESS
}

/// A state without the contacts that are the same as before it.
fn partial(line: &str, before: &mut Option<Vec<Value>>) -> String {
    let mut state: Value = serde_json::from_str(line).unwrap();
    let all = state["contacts"].as_array().unwrap().clone();
    if all.is_empty() {
        return line.into();
    }
    if let Some(before) = before.replace(all.clone()) {
        let unchanged = |(old, new): &(Value, &Value)| {
            let mut old = old.clone();
            old["mode"] = old["next"].clone();
            let contact = old.as_object_mut().unwrap();
            contact.remove("wanted");
            if contact.get("forced") == Some(&json!("once")) {
                contact.remove("forced");
            }
            old == **new
        };
        let rest = before.into_iter().zip(&all).filter(|pair| !unchanged(pair));
        let mut rest: Vec<Value> = rest.map(|(_, new)| new.clone()).collect();
        if rest.is_empty() {
            // An attempt without contacts could not be solved.
            rest.push(all[0].clone());
        }
        state["contacts"] = json!(rest);
    }
    state.to_string()
}

fn changed(line: &str, change: impl Fn(&mut Value)) -> String {
    let mut message: Value = serde_json::from_str(line).unwrap();
    change(&mut message);
    message.to_string()
}

fn upside_down(state: &mut Value) {
    for contact in state["contacts"].as_array_mut().unwrap() {
        contact["f_n"] = json!(contact["f_n"].as_f64().map(|f| -f));
    }
}

fn flat(problem: &mut Value) {
    for number in problem["matrix"]
        .as_array_mut()
        .unwrap()
        .iter_mut()
        .flat_map(|row| row.as_array_mut().unwrap())
    {
        *number = json!(number.as_f64().map(|x| 0.5 * x));
    }
}
