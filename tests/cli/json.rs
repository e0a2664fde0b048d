//! `--json` and `--junit`: the records have the fields of the page, and agree with tables, text and exit codes.

use crate::program::{code, err, interrupted, out, program, refused, rows, well, words};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Output, Stdio};
use stickslip::manual;
use stickslip::scene::number::{shortest, sig2};

const SNAPSHOT: &str = "snapshots/01-lets-go-and-slides-back.ron";
const BRANCHES: &str = "tests/findings/moves-to-another-equilibrium.ron";
const SQUEEZED: &str = "tests/findings/block-squeezed-to-half.ron";
const OVERLAPPING: &str = "tests/findings/7-slid-onto-border-302-178.ron";
const BEAM: &str = "01-pinned-beam-rough-floor";

fn top() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Runs at the top of the repository.
fn ran(arguments: &[&str]) -> Output {
    program(top(), arguments).output().unwrap()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// The record on standard output, whose exit code is that of the program.
fn record(arguments: &[&str]) -> Value {
    let output = ran(arguments);
    let record = json(&out(&output));
    assert_eq!(record["exit_code"], code(&output), "{}", err(&output));
    record
}

/// The elements of a list.
fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

/// Numbers with the same bits.
fn same(value: &Value, text: &str) -> bool {
    value.as_f64().unwrap().to_bits() == text.parse::<f64>().unwrap().to_bits()
}

/// The tables of the page `json`: title, then field and type of each row.
struct Schema(BTreeMap<String, Vec<(String, String)>>);

impl Schema {
    fn of_page() -> Schema {
        let mut tables: BTreeMap<String, Vec<_>> = BTreeMap::new();
        let mut title = String::new();
        for line in manual::page("json").unwrap().text().lines() {
            if let Some(heading) = line.strip_prefix("## ") {
                title = heading.to_owned();
            }
            if let Some((field, rest)) = line.strip_prefix("| `").and_then(|r| r.split_once("` | "))
            {
                let kind = rest.split(" | ").next().unwrap().to_owned();
                tables
                    .entry(title.clone())
                    .or_default()
                    .push((field.to_owned(), kind));
            }
        }
        Schema(tables)
    }

    /// Whether a value has a type; a record must have exactly the fields of its table. Adds the titles of records to `seen`.
    fn fits(&self, value: &Value, kind: &str, seen: &mut BTreeSet<String>) -> bool {
        if let Some(kind) = kind.strip_suffix(" or null") {
            return value.is_null() || self.fits(value, kind, seen);
        }
        if let Some(kind) = kind.strip_prefix("list of ") {
            let all = value.as_array();
            return all.is_some_and(|all| all.iter().all(|one| self.fits(one, kind, seen)));
        }
        match kind {
            "boolean" => value.is_boolean(),
            "integer" => value.is_u64(),
            // Numbers that are not finite are null.
            "number" => value.is_f64() || value.is_null(),
            "string" => value.is_string(),
            title => {
                let title = title.trim_matches('`');
                seen.insert(title.to_owned());
                self.is_record(value, title, seen)
            }
        }
    }

    fn is_record(&self, value: &Value, title: &str, seen: &mut BTreeSet<String>) -> bool {
        let (fields, record) = (&self.0[title], value.as_object().unwrap());
        let written: BTreeSet<&str> = record.keys().map(String::as_str).collect();
        let listed: BTreeSet<&str> = fields.iter().map(|(field, _)| field.as_str()).collect();
        assert_eq!(written, listed, "{title}");
        if title == "failure" {
            let kind = record["kind"].as_str().unwrap();
            assert!(self.kinds().contains(&kind), "{kind}");
        }
        for (field, kind) in fields {
            let fits = self.fits(&record[field], kind, seen);
            assert!(fits, "{title}.{field}: {kind}: {}", record[field]);
        }
        true
    }

    fn kinds(&self) -> Vec<&str> {
        let kinds = self.0["Kinds of failure"].iter();
        kinds.map(|(kind, _)| kind.as_str()).collect()
    }
}

#[test]
fn records_have_exactly_the_fields_of_the_page_and_every_table_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let changed = changed(folder.path());
    let schema = Schema::of_page();
    let mut seen = BTreeSet::new();
    for words in [
        &["run", BRANCHES, "--stability"][..],
        &["run", SQUEEZED],
        &["run", "osc-two3"],
        &["remedies", "osc-two3"],
        &["remedies", "osc-sgn0"],
        &["check", BEAM],
        &["audit", SQUEEZED, OVERLAPPING, SNAPSHOT, "osc-block-slide"],
        &["replay", SNAPSHOT, &changed, "none.ron"],
    ] {
        let record = record(&[words, &["--json"]].concat());
        let title = words[0];
        assert_eq!(record["schema"], format!("stickslip-{title}-1"));
        assert!(schema.fits(&record, title, &mut seen));
    }
    let deck = record(&["check", "tests/calculix/causes/cuts.inp", "--json"]);
    assert_eq!(deck["schema"], "stickslip-check-deck-1");
    assert!(schema.fits(&deck, "check of a deck in space", &mut seen));
    let titles = schema.0.keys().filter(|title| *title != "Kinds of failure");
    assert_eq!(seen.iter().collect::<Vec<_>>(), titles.collect::<Vec<_>>());
    assert!(schema.kinds().len() > 15);
}

/// A copy of the snapshot with another force, whose name XML must escape.
fn changed(folder: &Path) -> String {
    let text = fs::read_to_string(top().join(SNAPSHOT)).unwrap();
    let at = text.find("f_n: ").unwrap() + "f_n: ".len();
    let end = at + text[at..].find(',').unwrap();
    let file = folder.join("changed <&>.ron");
    fs::write(&file, format!("{}99.0{}", &text[..at], &text[end..])).unwrap();
    file.to_str().unwrap().to_owned()
}

#[test]
fn a_run_agrees_with_its_csv() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.json");
    let output = ran(&[
        "run",
        BRANCHES,
        "--csv",
        "-",
        "--json",
        file.to_str().unwrap(),
    ]);
    let record = json(&fs::read_to_string(file).unwrap());
    let table = rows(&well(&output));
    assert_eq!(
        (&record["outcome"], &record["exit_code"]),
        (&"finished".into(), &0.into())
    );
    assert_eq!(record["increments"], table.len());
    for (field, column) in [("majors", "majors"), ("minors", "minors")] {
        let sum: u64 = table
            .iter()
            .map(|row| row[column].parse::<u64>().unwrap())
            .sum();
        assert_eq!(record[field], sum, "{field}");
    }
    let last = table.last().unwrap();
    assert!(same(&record["load"], &last["load"]));
    assert!(!list(&record["monitors"]).is_empty());
    for monitor in list(&record["monitors"]) {
        assert!(
            same(&monitor["value"], &last[monitor["name"].as_str().unwrap()]),
            "{monitor}"
        );
    }
    let jumped: Vec<_> = table.iter().filter(|row| row["jumped"] == "1").collect();
    let jumps = list(&record["jumps"]);
    assert_eq!((jumps.len(), jumped.is_empty()), (jumped.len(), false));
    assert!(
        jumps
            .iter()
            .zip(jumped)
            .all(|(load, row)| same(load, &row["load"]))
    );
    let told = err(&output);
    let fallback = list(&record["fallbacks"])[0]["fallback"].as_str().unwrap();
    assert!(told.contains(&format!("found with {fallback}")), "{told}");
    for warning in list(&record["warnings"]) {
        assert!(
            told.contains(&format!("warning: {}\n", warning.as_str().unwrap())),
            "{told}"
        );
    }
}

#[test]
fn a_run_lists_the_increments_that_damped_motions_led_to() {
    let run = [
        "run",
        "02-two-cantilevers-rough",
        "--set",
        "history.jumps=dynamic",
        "--set",
        "friction.angle=8",
        "--set",
        "history.increment=0.5",
    ];
    let record = json(&well(&ran(&[&run[..], &["--json"]].concat())));
    let table = rows(&well(&ran(&[&run[..], &["--csv", "-"]].concat())));
    let moved = table.iter().filter(|row| row["steps"] != "0");
    let motions = list(&record["motions"]);
    assert!(!motions.is_empty());
    assert_eq!(motions.len(), moved.clone().count());
    for (motion, row) in motions.iter().zip(moved) {
        assert_eq!(motion["increment"].to_string(), row["increment"]);
        assert_eq!(motion["steps"].to_string(), row["steps"]);
        for (field, column) in [
            ("load", "load"),
            ("from", "let_go"),
            ("dissipated", "dissipated"),
        ] {
            assert!(same(&motion[field], &row[column]), "{motion}");
        }
    }
}

#[test]
fn a_failed_run_agrees_with_its_trace_and_text_quiet_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let trace = folder.path().join("trace.csv");
    let arguments = [
        "run",
        "osc-border",
        "--json",
        "-",
        "--trace",
        trace.to_str().unwrap(),
    ];
    let output = ran(&arguments);
    let record = json(&out(&output));
    assert_eq!((code(&output), &record["outcome"]), (3, &"failed".into()));
    let failure = &record["failure"];
    assert_eq!(failure["kind"], "cycle");
    let table = rows(&fs::read_to_string(&trace).unwrap());
    let last = table.last().unwrap();
    for field in ["increment", "attempt", "major", "minor"] {
        assert_eq!(failure[field].to_string(), last[field], "{field}");
    }
    let last = record["increments"].to_string();
    let end: Vec<_> = table
        .iter()
        .filter(|row| row["increment"] == last)
        .collect();
    let slaves = list(&record["slaves"]);
    assert!(!slaves.is_empty());
    for (slave, row) in slaves.iter().zip(&end[end.len() - slaves.len()..]) {
        assert_eq!(
            (&slave["node"], &slave["mode"]),
            (&row["node"].as_str().into(), &row["mode"].as_str().into())
        );
        for field in ["gap", "f_n", "f_t"] {
            assert!(same(&slave[field], &row[field]), "{slave}");
        }
    }
    let told = err(&output);
    for line in list(&record["why"])
        .iter()
        .chain([&record["message"], &failure["words"]])
    {
        assert!(told.contains(line.as_str().unwrap()), "{line}: {told}");
    }
    let quiet = ran(&["run", "osc-border", "--json", "--quiet"]);
    assert_eq!(out(&quiet), out(&output));
}

/// A reader that closes the pipe does not end a run that writes a record.
#[test]
fn an_interrupted_run_writes_its_record() {
    let folder = tempfile::tempdir().unwrap();
    let long = format!("run {BEAM} --set history.increment=5e-6 --csv -");
    let long = words(&long);
    let mut run = program(folder.path(), &[&long[..], &["--json", "a.json"]].concat());
    let child = run.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.unwrap();
    let table = BufReader::new(child.stdout.take().unwrap());
    assert_eq!(table.lines().take(3).count(), 3);
    interrupted(child);
    let record = json(&fs::read_to_string(folder.path().join("a.json")).unwrap());
    assert_eq!(record["outcome"], "interrupted");
    assert_eq!(record["exit_code"], 130);
    assert!(record["increments"].as_u64().unwrap() > 1 && record["failure"].is_null());
}

#[test]
fn a_file_is_never_overwritten_unasked_and_leaves_the_text_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let check = |more: &[&str]| {
        let words = [&["check", BEAM][..], more].concat();
        program(folder.path(), &words).output().unwrap()
    };
    let text = well(&check(&[]));
    assert_eq!(well(&check(&["--json", "a.json"])), text);
    let file = folder.path().join("a.json");
    let written = fs::read_to_string(&file).unwrap();
    assert_eq!(well(&check(&["--json"])), written);
    let unknowns = text
        .lines()
        .find(|line| line.starts_with("unknowns"))
        .unwrap();
    let unknowns = unknowns.split_whitespace().nth(1).unwrap();
    assert_eq!(json(&written)["unknowns"].to_string(), unknowns);
    fs::write(&file, "mine").unwrap();
    let again = check(&["--json", "a.json"]);
    refused(&again, "use --force");
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
    well(&check(&["--json", "a.json", "--force"]));
    assert_eq!(fs::read_to_string(&file).unwrap(), written);
    let both = ran(&words(&format!("run {BEAM} --csv - --json -")));
    assert_eq!((code(&both), out(&both)), (2, String::new()));
    let bad = ran(&["run", "no-such-scene", "--json"]);
    assert_eq!((code(&bad), out(&bad)), (2, String::new()));
}

#[test]
fn remedies_are_those_of_the_table_in_its_order() {
    let table = well(&ran(&["remedies", "osc-two3"]));
    let record = record(&["remedies", "osc-two3", "--json"]);
    let tried = |remedy: &&Value| remedy["tried"] == true;
    let remedies: Vec<_> = list(&record["remedies"]).iter().filter(tried).collect();
    assert_eq!(remedies.len(), table.lines().count() - 1);
    for (remedy, line) in remedies.iter().zip(table.lines().skip(1)) {
        let text = |field: &str| remedy[field].as_str().unwrap().to_owned();
        assert!(
            line.starts_with(&text("remedy")) && line.ends_with(&text("command")),
            "{line}"
        );
        let converged = line.contains("  converged  ");
        assert_eq!(remedy["outcome"] == "converged", converged, "{line}");
        assert_eq!(remedy["failure"].is_string(), remedy["outcome"] == "failed");
    }
    assert_eq!(remedies[0]["outcome"], "converged");
}

#[test]
fn an_audit_agrees_with_its_table_and_marked_increments_do_not_count() {
    let major = ["audit", BEAM, "--json", "--set", "settings.slip=major"];
    let history = &record(&major)["histories"][0];
    assert_eq!(
        (&history["violated"], &history["marked"]),
        (&false.into(), &6.into())
    );
    // More than the ten whose warnings are printed.
    let many = ["settings.slip=major", "history.increment=0.002"].map(|set| ["--set", set]);
    let of = |command: &str| record(&[&[command, BEAM, "--json"], many.as_flattened()].concat());
    let (run, audit) = (of("run"), of("audit"));
    let marked = list(&run["doubtful"]);
    assert!(
        marked.len() > 10 && marked.contains(&226.into()),
        "{marked:?}"
    );
    assert_eq!(audit["histories"][0]["marked"], marked.len());
    let violated = |field: &str| -> Vec<&Value> {
        let violated = list(&history[field])
            .iter()
            .filter(|finding| finding["violated"] == true);
        violated.map(|finding| &finding["law"]).collect()
    };
    assert!(violated("findings").is_empty());
    assert_eq!(violated("marked_findings"), ["slip"]);
    let text = out(&ran(&["audit", SQUEEZED]));
    let history = &record(&["audit", SQUEEZED, "--json"])["histories"][0];
    assert_eq!(
        (&history["outcome"], &history["failure"]["kind"]),
        (&"failed".into(), &"inverted-element".into())
    );
    let line = format!(": {} increments accepted", history["increments"]);
    assert!(text.contains(&line), "{text}");
    let findings = list(&history["findings"]);
    for finding in findings {
        let law = finding["law"].as_str().unwrap();
        let row = text
            .lines()
            .find(|line| line.trim_start().starts_with(law))
            .unwrap();
        let place = format!(
            "increment {} (load {})",
            finding["increment"],
            shortest(finding["load"].as_f64().unwrap())
        );
        let amount = sig2(finding["amount"].as_f64().unwrap());
        assert!(
            row.contains(&place) && row.contains(&amount),
            "{row} {finding}"
        );
        assert_eq!(row.contains("BROKEN"), finding["violated"] == true, "{row}");
    }
    assert!(findings.len() > 4);
}

#[test]
fn a_replay_writes_its_result_over_no_snapshot_even_by_force() {
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("a.ron");
    fs::copy(top().join(SNAPSHOT), &copy).unwrap();
    let file = copy.to_str().unwrap();
    for (line, says) in [
        (
            ["replay", "--force", "--json", file, SNAPSHOT],
            "put --json at the end of the line",
        ),
        (
            ["replay", "--force", file, "--junit", file],
            "needs another file",
        ),
    ] {
        let refused = ran(&line);
        assert_eq!(code(&refused), 2, "{line:?}");
        assert!(err(&refused).contains(says), "{}", err(&refused));
        assert_eq!(
            fs::read(&copy).unwrap(),
            fs::read(top().join(SNAPSHOT)).unwrap()
        );
    }
}

#[test]
fn a_replay_names_what_differs_as_json_and_as_junit() {
    let folder = tempfile::tempdir().unwrap();
    let changed = changed(folder.path());
    let junit = folder.path().join("replay.xml");
    let replay = ["replay", SNAPSHOT, &changed, "none.ron"];
    let more = ["--junit", junit.to_str().unwrap(), "--json"];
    let record = record(&[&replay[..], &more].concat());
    assert_eq!(record["exit_code"], 2);
    let outcomes = list(&record["snapshots"])
        .iter()
        .map(|one| one["outcome"].as_str().unwrap());
    assert_eq!(
        outcomes.collect::<Vec<_>>(),
        ["equal", "differs", "unreadable"]
    );
    let differs = &record["snapshots"][1];
    assert_eq!(
        (&differs["differences"], list(&differs["first"]).len()),
        (&1.into(), 1)
    );
    let first = &differs["first"][0];
    assert_eq!(
        (&first["node"], &first["field"]),
        (&"beam.5".into(), &"f_n".into())
    );
    assert_eq!(first["expected"], "99.0");
    let (found, apart) = (
        first["found"].as_str().unwrap(),
        first["apart"].as_f64().unwrap(),
    );
    assert_eq!(99.0 - found.parse::<f64>().unwrap(), apart);
    for (part, equal) in [("1", true), ("1e-3", false)] {
        let replayed = ran(&["replay", "--tolerance", part, &changed]);
        assert_eq!(replayed.status.success(), equal, "{}", out(&replayed));
    }
    let text = out(&ran(&replay));
    let minors = &record["snapshots"][0]["minors"];
    assert!(
        text.contains(&format!("equal, after {minors} minor iterations")),
        "{text}"
    );
    let xml = fs::read_to_string(&junit).unwrap();
    let count = "tests=\"3\" failures=\"1\" errors=\"1\"";
    assert!(xml.starts_with("<?xml") && xml.contains(count), "{xml}");
    assert!(
        xml.contains("changed &lt;&amp;&gt;.ron\"") && xml.contains(found),
        "{xml}"
    );
    assert_eq!(xml.matches("<testcase ").count(), 3);
    let printed = ran(&["replay", SNAPSHOT, "--junit", "-"]);
    let untimed = |text: &str| -> Vec<String> {
        let pieces = text.split(" time=\"").map(str::to_owned);
        pieces
            .map(|piece| {
                piece
                    .trim_start_matches(|c: char| c.is_ascii_digit() || c == '.')
                    .to_owned()
            })
            .collect()
    };
    let expected = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"stickslip replay\" tests=\"1\" failures=\"0\" errors=\"0\" skipped=\"0\" time=\"0\">\n  <testcase classname=\"stickslip replay\" name=\"{SNAPSHOT}\" time=\"0\"/>\n</testsuite>\n"
    );
    assert_eq!(untimed(&well(&printed)), untimed(&expected));
}

/// Two values, with numbers equal to 1e-9: another processor may sum in another order.
fn agree(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| agree(a, b))
        }
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len()
                && a.iter()
                    .all(|(key, a)| b.get(key).is_some_and(|b| agree(a, b)))
        }
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0)
        }
        _ => a == b,
    }
}

#[test]
fn the_example_of_the_page_is_what_its_command_writes() {
    let text = manual::page("json").unwrap().text();
    let block = |language: &str| {
        let (_, rest) = text.split_once(&format!("```{language}\n")).unwrap();
        rest.split_once("```").unwrap().0
    };
    let command: Vec<&str> = block("sh").split_whitespace().skip(1).collect();
    let written = record(&command);
    assert!(agree(&written, &json(block("json"))), "{written:#}");
    let mut other = written.clone();
    other["load"] = 0.5.into();
    assert!(!agree(&written, &other));
}

#[test]
fn a_deck_in_space_is_checked_by_the_rules_into_a_record() {
    let deck = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/calculix/causes/stiff.inp"
    );
    let record = json(&well(&ran(&["check", deck, "--json"])));
    assert_eq!(record["schema"], "stickslip-check-deck-1");
    assert_eq!(
        (&record["pairs"], &record["exit_code"]),
        (&1.into(), &0.into())
    );
    let warnings = list(&record["warnings"]);
    let cured =
        |warning: &&serde_json::Value| warning.as_str().is_some_and(|w| w.contains("Cure: "));
    assert!(warnings.iter().filter(cured).count() > 0, "{record}");
}
