//! A solver with two contacts and four increments of three iterations, that does one thing wrong: what its first argument says.
//! Its second one is a file to which it adds the number of its process, a line at every start.

use rustix::process::{Signal, getpid, kill_process};
use serde_json::{Value, json};
use std::fs::{File, OpenOptions};
use std::io::{BufRead, Write};
use std::process::{Command, ExitCode, Stdio};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::sleep;
use std::time::Duration;

/// The first argument that starts it.
pub const NAME: &str = "--be-rude";
/// Iterations of an increment, and of all.
const EACH: u64 = 3;
const ALL: u64 = 12;
/// The iteration, from 0, in which it does wrong.
const WRONG: u64 = 2;

struct Rude {
    how: String,
    /// How often it was started, this time included.
    starts: usize,
    /// Iterations done.
    done: u64,
    /// Modes that are forced, and held.
    forced: [Option<String>; 2],
    held: [Option<String>; 2],
    /// The parameter that it has.
    gain: f64,
}

pub fn main(arguments: &[String]) -> ExitCode {
    let (how, file) = (arguments[0].clone(), &arguments[1]);
    let mut pids = OpenOptions::new()
        .append(true)
        .create(true)
        .open(file)
        .unwrap();
    writeln!(pids, "{}", std::process::id()).unwrap();
    let starts = std::fs::read_to_string(file).unwrap().lines().count();
    let mut rude = Rude {
        how,
        starts,
        done: 0,
        forced: [None, None],
        held: [None, None],
        gain: 1.0,
    };
    if rude.is("hang-at-start") {
        forever();
    }
    if rude.is("hello-without-question") {
        say(&rude.hello());
    }
    // Locked for a line only, since a step may read too.
    while let Some(line) = heard() {
        let request: Value = serde_json::from_str(&line).unwrap();
        let asked = request["type"].as_str().unwrap().to_owned();
        if asked == "bye" {
            break;
        }
        if asked == "interrupt" {
            continue;
        }
        if asked == "step" && rude.done == WRONG && rude.does_wrong(&mut pids) {
            continue;
        }
        let answer = rude.answer(&asked, &request);
        say(&answer);
        if asked == "save" && rude.done == WRONG && rude.is("big-token") {
            forever();
        }
        if asked == "step" && rude.done > WRONG {
            rude.goes_on_wrong(&answer);
        }
    }
    if rude.is("deaf-to-bye") {
        deaf();
        forever();
    }
    ExitCode::SUCCESS
}

/// The next line of its input.
fn heard() -> Option<String> {
    let mut line = String::new();
    let count = std::io::stdin().lock().read_line(&mut line).unwrap();
    (count > 0).then_some(line)
}

fn say(answer: &Value) {
    raw(format!("{answer}\n").as_bytes());
}

fn raw(bytes: &[u8]) {
    let mut out = std::io::stdout().lock();
    // Who asked may have gone.
    let _ = out.write_all(bytes).and_then(|()| out.flush());
}

fn forever() -> ! {
    loop {
        sleep(Duration::from_secs(60));
    }
}

/// Hears no Ctrl-C.
fn deaf() {
    let heard = Arc::new(AtomicBool::new(false));
    signal_hook::flag::register(signal_hook::consts::SIGINT, heard).unwrap();
}

fn refused(reason: &str) -> Value {
    json!({"type": "refused", "reason": reason})
}

impl Rude {
    fn is(&self, how: &str) -> bool {
        self.how == how
    }

    fn hello(&self) -> Value {
        let protocol = if self.is("version") {
            json!(3)
        } else {
            json!(1)
        };
        let name = if self.is("escapes") {
            "\u{1b}[31mrude\u{7}"
        } else {
            "rude"
        };
        let restore = match self.how.as_str() {
            "random" | "other-scene" | "dies-once" | "other-parameters" => "none",
            "increment" => "increment",
            _ => "any",
        };
        let mut parameters = vec![
            json!({"name": "gain", "kind": "number", "value": if self.is("other-parameters") { self.starts as f64 } else { 1.0 }, "least": 0}),
        ];
        match self.how.as_str() {
            "parameter-twice" => parameters.push(parameters[0].clone()),
            "parameter-unsound" => parameters[0]["value"] = json!(-1),
            "parameter-null" => parameters[0]["value"] = Value::Null,
            _ => {}
        }
        json!({
            "type": "hello", "protocol": protocol, "name": name, "version": "1",
            "abilities": {
                "force": true, "hold": true, "restore": restore, "problem": self.how.contains("problem"),
                "interrupt": self.how.contains("interrupt"), "partial": self.how.starts_with("partial"),
            },
            "parameters": parameters,
        })
    }

    fn scene(&self) -> Value {
        let mut scene = json!({
            "type": "scene", "title": "Two contacts",
            "nodes": [{"name": "a", "at": [0, 1]}, {"name": "b", "at": [1, 1]}, {"name": "left", "at": [-1, 0]}, {"name": "right", "at": [2, 0]}],
            "lines": [[0, 1]],
            "surfaces": [{"name": "floor", "nodes": [3, 2], "rigid": true}],
            "contacts": [
                {"id": "a", "node": 0, "surface": "floor", "friction": {"mu": 0.3}},
                {"id": 7, "node": 1, "surface": "floor", "friction": {"mu": 0.3}},
            ],
            "monitors": ["sum"],
        });
        let contacts = &mut scene["contacts"];
        match self.how.as_str() {
            "other-scene" if self.starts > 1 => contacts[1]["id"] = json!(8),
            "same-id" => contacts[1]["id"] = json!("a"),
            "no-such-node" => contacts[1]["node"] = json!(4),
            "no-contacts" => *contacts = json!([]),
            "far-apart" => {
                scene["nodes"] = json!([{"at": [0, 1e308]}, {"at": [1, -1e308]}, {"at": [-1, 0]}, {"at": [2, 0]}])
            }
            "escapes" => {
                scene["title"] = json!("\u{1b}]0;owned\u{7}\r\nScene");
                scene["about"] = json!("\u{9b}2J");
                scene["nodes"][0]["name"] = json!("\u{1b}[2Ja,\"\n");
                scene["surfaces"][0]["name"] = json!("fl\u{202e}oor");
                contacts_on(&mut scene, "fl\u{202e}oor");
                scene["monitors"] = json!(["s\u{1b}um\n"]);
            }
            _ => {}
        }
        scene
    }

    fn answer(&mut self, asked: &str, request: &Value) -> Value {
        let refuses = self.how.strip_prefix("refuses-") == Some(asked);
        match asked {
            "hello" if self.is("refuses-to-talk") => refused("not with you"),
            "hello" if self.is("scene-for-hello") => self.scene(),
            "hello" => self.hello(),
            "scene" if self.is("hang-in-scene") => forever(),
            "scene" if self.is("dies-in-scene") => std::process::exit(3),
            "scene" => self.scene(),
            _ if refuses && (asked != "step" || self.done == WRONG) => {
                refused("I would rather not")
            }
            "step" => self.step(),
            "force" | "release" => {
                let place = usize::from(request["contact"] == json!(7));
                if place == 0 && request["contact"] != json!("a") {
                    return refused("no such contact");
                }
                let mode = request["mode"].as_str().map(str::to_owned);
                if self.is("deaf-to-force") || (self.is("second-not-forced") && place == 1) {
                    return json!({"type": "ok"});
                }
                let held = request["hold"] == json!(true) && !self.is("holds-once");
                self.held[place] = mode.clone().filter(|_| held);
                self.forced[place] = mode;
                json!({"type": "ok"})
            }
            "set" => match (request["name"].as_str(), request["value"].as_f64()) {
                (Some("gain"), Some(gain)) if gain >= 0.0 || self.is("takes-all") => {
                    self.gain = if self.is("deaf-to-set") {
                        self.gain
                    } else {
                        gain
                    };
                    json!({"type": "ok"})
                }
                _ => refused("there is no such parameter, or it takes no such value"),
            },
            "save" => {
                let filling = if self.is("big-token") {
                    "x".repeat(1 << 20)
                } else {
                    String::new()
                };
                json!({"type": "saved", "token": [self.done, self.gain, self.forced, self.held, filling]})
            }
            "restore" if self.is("dies-in-restore") => std::process::exit(9),
            "restore" => {
                let token = &request["token"];
                let Some(done) = token[0].as_u64() else {
                    return refused("no such token");
                };
                self.done = done + u64::from(self.is("restores-another"));
                self.gain = token[1].as_f64().unwrap();
                for place in 0..2 {
                    let text = |of: usize| token[of][place].as_str().map(str::to_owned);
                    (self.forced[place], self.held[place]) = (text(2), text(3));
                }
                json!({"type": "ok"})
            }
            "problem" => self.problem(),
            _ => refused("I do not know that"),
        }
    }

    fn problem(&self) -> Value {
        let matrix = match self.how.as_str() {
            "problem-short" => json!([[1, 0], [0, 1]]),
            "problem-negative" => json!([[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
            "problem-null" => json!([[1, null]]),
            _ => json!([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
        };
        json!({
            "type": "problem", "contacts": ["a", 7], "kind": "compliance",
            "matrix": matrix, "q": [0.5, 0, 0.5, 0], "mu": [0.3, 0.3],
        })
    }

    /// The mode of a contact in an iteration, by turns.
    fn mode(&self, place: usize, iteration: u64) -> &'static str {
        let turn = iteration + u64::from(self.is("random") && self.starts > 1 && iteration > 1);
        match (place as u64 + turn / EACH) % 3 {
            0 => "free",
            1 => "fixed",
            _ => "sliding",
        }
    }

    fn step(&mut self) -> Value {
        if self.done >= ALL {
            return refused("it is all done");
        }
        self.done += 1;
        let (n, of) = (self.done, self.done % EACH);
        let ids = [json!("a"), json!(7)];
        let contacts = ids.iter().enumerate().map(|(place, id)| {
            let forced = self.forced[place].take();
            let mode = forced.unwrap_or_else(|| self.mode(place, n - 1).to_owned());
            let next = self.held[place].clone().unwrap_or_else(|| self.mode(place, n).to_owned());
            self.forced[place].clone_from(&self.held[place]);
            let size = self.gain / (n as f64 + place as f64 + 1.0);
            json!({
                "id": id, "mode": mode, "next": next, "gap": size, "f_n": 2.0 * size, "f_t": -size, "limit": 0.6 * size,
                "slip": 0, "rule": if self.is("escapes") { "\u{1b}[5mbecause\n" } else { "by turns" },
            })
        });
        let contacts: Vec<Value> = contacts.collect();
        json!({
            "type": "state",
            "at": {"increment": (n - 1) / EACH + 1, "minor": (n - 1) % EACH + 1},
            "load": match self.is("load-drifts") {
                true => n as f64 / ALL as f64,
                false => ((n - 1) / EACH + 1) as f64 * EACH as f64 / ALL as f64,
            },
            "ended": match of {
                0 if n == ALL => "done",
                0 if self.is("gives-up") && n == 2 * EACH => "failure",
                0 => "increment",
                _ => "iteration",
            },
            "contacts": contacts,
            "residual": {"relative": 0.1},
            "displacements": [[0, 0], [0, -0.1], [0, 0], [0, 0]],
            "monitors": [n],
        })
    }

    /// What it does in the place of an answer; whether that was instead of it.
    fn does_wrong(&mut self, pids: &mut File) -> bool {
        let instead = |line: &str| {
            raw(line.as_bytes());
            raw(b"\n");
            true
        };
        match self.how.clone().as_str() {
            "exit" => {
                eprintln!("\u{1b}[31mpanicked at the worst time\u{1b}[0m");
                std::process::exit(7)
            }
            "dies-once" if self.starts == 1 => std::process::exit(1),
            "signal" => {
                kill_process(getpid(), Signal::KILL).unwrap();
                forever()
            }
            "bye" => {
                say(&json!({"type": "bye", "reason": "no licence\u{1b}[2J left\n"}));
                std::process::exit(0)
            }
            "bye-silently" => {
                say(&json!({"type": "bye"}));
                std::process::exit(0)
            }
            "hang" | "hang-problem" => forever(),
            "hang-deaf" => {
                deaf();
                forever()
            }
            "interrupt-ignored" => {
                deaf();
                forever()
            }
            "interrupt" => {
                while heard().is_some_and(|line| !line.contains("interrupt")) {}
                false
            }
            "text" => instead("Iteration 3: residual 1.0e-3"),
            "progress-and-hang" => {
                say(&json!({"type": "progress", "text": "\u{1b}[2JCG", "done": 30, "of": 200}));
                forever()
            }
            "text-then-answer" => {
                raw(b"Iteration 3: residual 1.0e-3\n");
                false
            }
            "binary" => instead_of(b"\x00\xff\xfe\x80{}\n"),
            "ansi" => instead("\u{1b}[2J\u{1b}]0;owned\u{7}\u{9b}31m"),
            "blank" => instead(""),
            "number" => instead("42"),
            "array" => instead("[{\"type\":\"ok\"}]"),
            "nan" => self.replaced("\"gap\":0.25", "\"gap\":NaN"),
            "infinity" => self.replaced("\"gap\":0.25", "\"gap\":-Infinity"),
            "null" => self.changed(|state| state["at"]["increment"] = Value::Null),
            "word" => self.changed(|state| state["contacts"][1]["f_n"] = json!("much")),
            "mode" => self.changed(|state| state["contacts"][1]["mode"] = json!("open\u{1b}[2J")),
            "zero" => self.changed(|state| state["at"]["minor"] = json!(0)),
            "huge" => self.changed(|state| state["at"]["minor"] = json!(u32::MAX)),
            "wrong-id" => self.changed(|state| state["contacts"][1]["id"] = json!("\u{1b}[2Jb")),
            "other-order" => {
                self.changed(|state| state["contacts"].as_array_mut().unwrap().reverse())
            }
            "partial-stranger" => self.changed(|state| {
                state["contacts"] = json!([{"id": 8, "mode": "free", "next": "free"}]);
            }),
            "partial-nameless" => self.changed(|state| {
                state["contacts"] = json!([{"mode": "free", "next": "free"}]);
            }),
            "too-few" => self.changed(|state| {
                state["contacts"].as_array_mut().unwrap().pop();
            }),
            "too-many" => self.changed(|state| {
                let more = state["contacts"][0].clone();
                state["contacts"].as_array_mut().unwrap().push(more);
            }),
            "displacements" => self.changed(|state| state["displacements"] = json!([[0, 0]])),
            "normal" => self.changed(|state| state["contacts"][0]["normal"] = json!([0, 0])),
            "cut-to-nothing" => self.changed(|state| {
                state["ended"] = json!("cut");
                state["size"] = json!(0);
            }),
            "half" => {
                raw(b"{\"type\":\"state\",\"at\":{\"incr");
                std::process::exit(0)
            }
            "half-and-hang" => {
                raw(b"{\"type\":\"state\",\"at\":{\"incr");
                forever()
            }
            "long" => {
                let part = vec![b'x'; 1 << 20];
                raw(b"{\"type\":\"");
                (0..100).for_each(|_| raw(&part));
                true
            }
            "deep" => {
                let depth = 200_000;
                let (open, close) = ("[".repeat(depth), "]".repeat(depth));
                instead(&format!("{{\"type\":\"saved\",\"token\":{open}{close}}}"))
            }
            "deep-beside" => {
                let depth = 200_000;
                let (open, close) = ("[".repeat(depth), "]".repeat(depth));
                let state = self.step().to_string();
                instead(&format!(
                    "{},\"beside\":{open}{close}}}",
                    &state[..state.len() - 1]
                ))
            }
            "key-twice" => self.replaced("\"minor\":", "\"minor\":1,\"minor\":"),
            "type-twice" => {
                self.replaced("\"type\":\"state\"", "\"type\":\"state\",\"type\":\"ok\"")
            }
            "level" => instead(r#"{"type":"message","level":"panic","text":""}"#),
            "unknown-type" => instead("{\"type\":\"stat\\u001b[2J\"}"),
            "no-type" => instead("{\"kind\":\"state\"}"),
            "ok" => instead("{\"type\":\"ok\"}"),
            "saved" => instead("{\"type\":\"saved\",\"token\":1}"),
            "failure" => self.changed(|state| {
                state["ended"] = json!("failure");
                state["reason"] = json!("it \u{1b}[31mdiverges\u{1b}[0m\nat once");
            }),
            "flood-stderr" => {
                let part = vec![b'x'; 1 << 20];
                let mut error = std::io::stderr().lock();
                (0..100).for_each(|_| error.write_all(&part).unwrap());
                false
            }
            "flood-escapes" => {
                let mut error = std::io::stderr().lock();
                (0..50_000).for_each(|_| {
                    error
                        .write_all(b"\x1b[2J\x1b]0;owned\x07 \x9b\r\n")
                        .unwrap()
                });
                false
            }
            "flood-messages" => loop {
                say(&json!({"type": "message", "text": "\u{1b}[2Jstill here"}));
            },
            "many-messages" => {
                for n in 0..20_000 {
                    say(
                        &json!({"type": "message", "level": "warning", "text": format!("{n}\u{1b}[2J")}),
                    );
                }
                false
            }
            "closes" => {
                let nothing = OpenOptions::new().write(true).open("/dev/null").unwrap();
                rustix::stdio::dup2_stdout(nothing).unwrap();
                forever()
            }
            "leaves-a-child" => {
                writeln!(pids, "{}", child()).unwrap();
                std::process::exit(5)
            }
            "has-a-child" => {
                writeln!(pids, "{}", child()).unwrap();
                false
            }
            _ => false,
        }
    }

    /// What it adds to an answer.
    fn goes_on_wrong(&mut self, answer: &Value) {
        match self.how.as_str() {
            "twice" => say(answer),
            "unasked" => say(&json!({"type": "ok"})),
            "exits-between" => std::process::exit(4),
            "talks-between" => say(&json!({"type": "message", "text": "between"})),
            "junk-between" => raw(b"done.\n"),
            _ => {}
        }
    }

    /// The next state with something else in it.
    fn changed(&mut self, change: fn(&mut Value)) -> bool {
        let mut state = self.step();
        change(&mut state);
        say(&state);
        true
    }

    /// The next state with something else in its line.
    fn replaced(&mut self, this: &str, by: &str) -> bool {
        let line = self.step().to_string();
        assert!(line.contains(this), "{line}");
        raw((line.replacen(this, by, 1) + "\n").as_bytes());
        true
    }
}

fn contacts_on(scene: &mut Value, surface: &str) {
    for place in 0..2 {
        scene["contacts"][place]["surface"] = json!(surface);
    }
}

fn instead_of(bytes: &[u8]) -> bool {
    raw(bytes);
    true
}

/// A process that lives on with the pipes of this one.
fn child() -> u32 {
    let child = Command::new("sleep").arg("60").stdin(Stdio::null()).spawn();
    child.unwrap().id()
}
