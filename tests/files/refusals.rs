//! What is no file, too large, too deep, too long or does not fit is refused at once, in one line that one can read.

#![cfg(unix)]

use crate::hostile::{
    CHART, CONTACTS, CYCLES, LESSON, READERS, REFERENCE, STUDY, pipe, put, reader, refusal, run,
    scene,
};
use crate::program::{code, err, well};
use std::fs;
use std::os::unix::fs::symlink;
use stickslip::record::journal::JournalTarget;
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip_exchange::seal::sealed;

#[test]
fn what_is_no_file_is_refused_at_once_by_every_command() {
    let directory = tempfile::tempdir().unwrap();
    pipe(&directory, "pipe");
    fs::create_dir(directory.path().join("folder")).unwrap();
    symlink("pipe", directory.path().join("link")).unwrap();
    for (file, kind) in [
        ("pipe", "the file is a pipe"),
        ("link", "the file is a pipe"),
        ("folder", "the file is a directory"),
        ("/dev/zero", "the file is a device"),
    ] {
        for line in READERS {
            let told = refusal(&directory, &reader(line, file));
            assert!(told.contains(file) && told.contains(kind), "{line}: {told}");
        }
    }
    for line in [
        "run osc-two6 --csv FILE",
        "run osc-two6 --trace FILE",
        "run osc-two6 --snapshot FILE",
        "record osc-two6 --at 1.1.1 -o FILE",
        "core osc-two6 -o FILE",
        "study osc-two6 --svg FILE",
        "map osc-two6 --png FILE",
        "map --random 1 --write 0 -o FILE",
    ] {
        let told = refusal(&directory, &reader(line, "pipe"));
        assert!(told.contains("without a reader"), "{line}: {told}");
        let forced = [&reader(line, "folder")[..], &["--force"]].concat();
        let told = refusal(&directory, &forced);
        assert!(told.contains("is a directory"), "{line}: {told}");
    }
}

#[test]
fn a_file_that_is_larger_than_any_sound_one_is_refused_and_not_read() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("huge");
    // It takes no room on the disk.
    fs::File::create(&path).unwrap().set_len(3 << 40).unwrap();
    for line in READERS {
        let told = refusal(&directory, &reader(line, "huge"));
        assert!(told.contains("MiB"), "{line}: {told}");
    }
}

#[test]
fn brackets_that_are_nested_too_deep_are_refused_at_once_with_their_place() {
    let directory = tempfile::tempdir().unwrap();
    for (text, column) in [
        (format!("(title{}", "Scene((".repeat(20_000)), 230),
        ("(".repeat(100_000), 65),
        ("[".repeat(1 << 20), 65),
        (format!("(scene: {}", "Some(".repeat(100_000)), 0),
        (format!("Contacts({}", "(".repeat(100_000)), 73),
    ] {
        put(&directory, "deep.ron", &text);
        for line in [
            "check FILE",
            "study FILE",
            "lesson --check FILE",
            "replay FILE",
        ] {
            let told = refusal(&directory, &reader(line, "deep.ron"));
            let place = format!("deep.ron:1:{column}: brackets are nested too deeply");
            assert!(column == 0 || told.starts_with(&place), "{line}: {told}");
            assert!(told.contains("nested too deeply"), "{line}: {told}");
        }
    }
    put(&directory, "deep", &format!("{}\n", "(".repeat(100_000)));
    for line in ["story FILE", "resume --check FILE", "chart --from FILE"] {
        let told = refusal(&directory, &reader(line, "deep"));
        assert!(told.contains("deep:1:"), "{line}: {told}");
    }
}

#[test]
fn results_that_do_not_fit_their_problem_are_refused_with_their_line() {
    let directory = tempfile::tempdir().unwrap();
    let map = ["map", "--random", "4", "--jobs", "1", "--resume", "log"];
    well(&run(&directory, &map));
    let whole = fs::read_to_string(directory.path().join("log")).unwrap();
    let changed = |line: usize, change: &dyn Fn(&str) -> String| {
        let lines = whole.lines().enumerate();
        let lines = lines.map(|(k, old)| {
            if k + 1 == line {
                // Results carry a digest, which the first line does not.
                old.rsplit_once('\t')
                    .map_or_else(|| change(old), |(text, _)| sealed(&change(text)))
            } else {
                old.to_owned()
            }
        });
        put(
            &directory,
            "log",
            &(lines.collect::<Vec<_>>().join("\n") + "\n"),
        );
        refusal(&directory, &map)
    };
    let trials = |line: &str| line.find("trials:[").unwrap() + "trials:[".len();
    let none = changed(4, &|line| format!("{}])", &line[..trials(line)]));
    assert!(
        none.starts_with("log:4:1: ") && none.contains("has 0 trials"),
        "{none}"
    );
    let one = changed(5, &|line| {
        line[..=line.find("),(").unwrap()].to_owned() + "])"
    });
    assert!(
        one.starts_with("log:5:1: ") && one.contains("has 1 trials"),
        "{one}"
    );
    let wrong = changed(3, &|line| {
        line.replacen("Right", "Rihgt", 1)
            .replacen("Wrong", "Wrogn", 1)
    });
    assert!(
        wrong.starts_with("log:3:") && !wrong.starts_with("log:3:1:"),
        "{wrong}"
    );
    assert!(changed(6, &|line| line.replace('\t', " ")).starts_with("log:6:1: "));
    assert!(changed(1, &|_| "stickslip 0.0.0 results, another".into()).starts_with("log:1:1: "));
    let long = changed(3, &|line| line.replace("stiffness", &"x".repeat(2 << 20)));
    assert!(long.starts_with("log:3:1: "), "{long}");
    // As it was, and with an editor's mark, it is taken up.
    put(&directory, "log", &format!("\u{feff}{whole}"));
    well(&run(&directory, &map));
    assert_eq!(
        fs::read_to_string(directory.path().join("log")).unwrap(),
        format!("\u{feff}{whole}")
    );
}

#[test]
fn a_table_of_a_chart_is_refused_where_its_names_are_too_long_and_drawn_within_bounds() {
    let directory = tempfile::tempdir().unwrap();
    let head = "scene,series,run,status,error,seconds\n";
    let wide = "T".repeat(100_000);
    for (k, column) in [(0, 1), (1, 3), (2, 5), (3, 7)] {
        let mut row = ["s", "t", "r", "whole", "1", "1"];
        row[k] = &wide;
        put(&directory, "a.csv", &format!("{head}{}\n", row.join(",")));
        let told = refusal(&directory, &["chart", "--from", "a.csv", "--png", "a.png"]);
        assert!(told.starts_with(&format!("a.csv:2:{column}: ")), "{told}");
        assert!(told.contains("100000 characters"), "{told}");
    }
    let name = "W".repeat(200);
    put(
        &directory,
        "a.csv",
        &format!("# {wide}\n{head}{name},{name},{name},{name},1e-300,1e300\n"),
    );
    well(&run(
        &directory,
        &["chart", "--from", "a.csv", "--svg", "a.svg", "--csv", "-"],
    ));
    let text = fs::read_to_string(directory.path().join("a.svg")).unwrap();
    assert!(text.len() < 200_000 && text.contains('…'));
    let many: String = (0..200)
        .map(|k| format!("scene{k},a,b,whole,1,1\n"))
        .collect();
    put(&directory, "b.csv", &format!("{head}{many}"));
    let told = run(
        &directory,
        &["chart", "--from", "b.csv", "--png", "b.png", "--quiet"],
    );
    assert_eq!(code(&told), 2);
    assert!(
        err(&told).contains("the limit is 64 million"),
        "{}",
        err(&told)
    );
    let runs: String = (0..20_001)
        .map(|k| format!("s,a,{k},whole,1,1\n"))
        .collect();
    put(&directory, "c.csv", &format!("{head}{runs}"));
    let told = refusal(&directory, &["chart", "--from", "c.csv"]);
    assert!(told.starts_with("c.csv:20002:1: "), "{told}");
}

#[test]
fn what_is_wrong_with_an_interface_problem_is_said_with_its_place() {
    let directory = tempfile::tempdir().unwrap();
    let place = |from: &str, to: &str| {
        assert!(CONTACTS.contains(from), "{from}");
        put(&directory, "c.ron", &CONTACTS.replacen(from, to, 1));
        refusal(&directory, &["check", "c.ron"])
    };
    for (from, to, at) in [
        ("id: \"a\"", "id: \"a b\"", "4:14: contacts[0].id: "),
        ("id: \"b\"", "id: \"a\"", "5:14: contacts[1].id: "),
        ("gap: 0.5", "gap: 1e30", "4:24: contacts[0].gap"),
        (
            "angle: 9.0",
            "angle: 95",
            "5:37: contacts[1].friction.angle: ",
        ),
        ("(0.0, 1.0)", "(0.0, 1e300)", "5:49: contacts[1].load: "),
        (
            "[0.0, 3.0, 0.0, 0.0]",
            "[0.0, 3.0, 0.0]",
            "9:9: matrix[1]: ",
        ),
        ("        [0.0, 0.0, 0.0, 1.0],\n", "", "7:13: matrix: "),
        (
            "[0.0, 0.0, 2.0, 0.0]",
            "[0.0, 0.0, 2.0, inf]",
            "10:25: matrix[2][3]: ",
        ),
        (
            "[0.0, 0.0, 2.0, 0.0]",
            "[0.0, 0.0, x, 0.0]",
            "10:20: matrix[2][2]",
        ),
        (
            "increment: 0.5",
            "increment: -1",
            "13:40: history.increment: ",
        ),
        ("title: \"t\"", "title: \"\"", "2:12: title: "),
        (
            "path: [0, 1]",
            "path: [0]",
            "13:21: history.path: the path has 1 corner; ",
        ),
    ] {
        let told = place(from, to);
        assert!(told.starts_with(&format!("c.ron:{at}")), "{to}: {told}");
    }
    put(&directory, "c.ron", CONTACTS);
    well(&run(&directory, &["check", "c.ron"]));
    let told = refusal(
        &directory,
        &["check", "c.ron", "--set", "history.increment=0"],
    );
    assert!(told.contains("--set history.increment=0"), "{told}");
}

#[test]
fn an_editor_s_mark_at_the_beginning_is_no_fault_of_any_file() {
    let directory = tempfile::tempdir().unwrap();
    let marked = |name: &str, text: &str| put(&directory, name, &format!("\u{feff}{text}"));
    marked("scene.ron", &scene(CYCLES));
    marked("contacts.ron", CONTACTS);
    marked("study.ron", &STUDY.replace("ORDERS", ""));
    marked("lesson.ron", &LESSON.replace("ORDERS", ""));
    marked("chart.csv", &CHART.replace("ORDERS", ""));
    marked(
        "plain.csv",
        CHART.replace("ORDERS", "").split_once('\n').unwrap().1,
    );
    marked("reference.csv", REFERENCE.split_once('\n').unwrap().1);
    marked("siconos.dat", "2\n1\n0\n2\n2\n2 2\n1 0 0 1\n-1 0.5\n0.3\n");
    well(&run(
        &directory,
        &["record", CYCLES, "--at", "1.1.1", "-o", "snapshot.ron"],
    ));
    let snapshot = fs::read_to_string(directory.path().join("snapshot.ron")).unwrap();
    marked("snapshot.ron", &snapshot);
    let path = directory.path().join("journal");
    let mut session = Session::new(Scene::open(CYCLES, &[]).unwrap());
    JournalTarget::File(path.clone())
        .begin(&mut session)
        .unwrap();
    drop(session);
    marked("journal", &fs::read_to_string(&path).unwrap());
    for line in [
        "check scene.ron",
        "check contacts.ron",
        "check siconos.dat",
        "study study.ron",
        "lesson --check lesson.ron",
        "chart --from chart.csv",
        "chart --from plain.csv",
        "chart osc-two6 --over settings.strategy=ladder,lemke --repeats 1 --reference reference.csv",
        "replay snapshot.ron",
        "story journal",
        "resume --check journal",
    ] {
        let arguments: Vec<&str> = line.split(' ').collect();
        let output = run(&directory, &arguments);
        assert_eq!(code(&output), 0, "{line}: {}", err(&output));
    }
}

#[test]
fn a_message_repeats_only_the_beginning_of_what_is_long() {
    let directory = tempfile::tempdir().unwrap();
    let long = "x".repeat(50_000);
    let scene = scene(CYCLES);
    let cases = [
        ("check", scene.replacen("title:", &format!("{long}:"), 1)),
        ("check", scene.replacen("Node(", &format!("{long}("), 1)),
        ("check", scene.replacen("\"a\"", &format!("\"{long}\""), 1)),
        (
            "check",
            scene.replacen("title:", &format!("{long}: 1, title:"), 1),
        ),
        (
            "check",
            scene.replacen("title:", &format!("title: {long}, title:"), 1),
        ),
        ("check", format!("2\n{long}\n")),
        ("check", format!("({long}")),
        ("check", long.clone()),
        ("check", CONTACTS.replace("id:", &format!("{long}:"))),
        ("study", STUDY.replace("title", &long)),
        ("study", STUDY.replace("osc-two6", &long)),
        ("study", STUDY.replace("history.increment", &long)),
        ("study", STUDY.replace("0.5", &format!("\"{long}\""))),
        ("lesson", LESSON.replace("steps", &long)),
        ("lesson", LESSON.replace("osc-two6", &long)),
        (
            "lesson",
            LESSON.replace("press: \"s\"", &format!("press: \"{long}\"")),
        ),
        (
            "lesson",
            LESSON.replace("node: \"a\"", &format!("node: \"{long}\"")),
        ),
        ("replay", format!("(format: 1, {long}: 2)")),
        ("story", format!("(format:1,{long}:2)\n")),
        ("story", format!("{long}\n")),
        ("chart", format!("{long},b\n1,2\n")),
        (
            "chart",
            format!("scene,series,run,status,error,seconds\na,b,c,whole,{long},1\n"),
        ),
        ("reference", format!("{long},b\n1,2\n")),
        ("reference", format!("load,{long}\n1,{long}\n")),
        ("map", format!("{long}\n")),
    ];
    for (k, (command, text)) in cases.iter().enumerate() {
        put(&directory, "file", text);
        let arguments: &[&str] = match *command {
            "lesson" => &["lesson", "--check", "file"],
            "chart" => &["chart", "--from", "file"],
            "reference" => &["chart", CYCLES, "--reference", "file"],
            "map" => &["map", CYCLES, "--resume", "file"],
            command => &[command, "file"],
        };
        let told = refusal(&directory, arguments);
        assert!(
            told.starts_with("file") || told.contains("--set") || told.starts_with('x'),
            "{k}: {told}"
        );
    }
    for arguments in [
        &["run", CYCLES, "--set", &format!("{long}=1")][..],
        &["run", CYCLES, "--set", &format!("refine={long}")],
        &["run", CYCLES, "--set", &format!("settings.strategy={long}")],
        &["chart", CYCLES, "--over", &format!("refine={long}")],
        &["map", CYCLES, "--strategies", &long],
    ] {
        let output = run(&directory, arguments);
        assert_eq!(code(&output), 2);
        assert!(
            err(&output).len() < 3000,
            "{}: {}",
            arguments[0],
            err(&output).len()
        );
    }
}

#[test]
fn a_file_that_ends_where_a_value_is_expected_is_said_to_end_too_early() {
    let directory = tempfile::tempdir().unwrap();
    for end in ["slaves: ", "friction: (", "surfaces: [\n", "about: \"b"] {
        put(&directory, "c.ron", &format!("(title: \"a\", {end}"));
        let told = refusal(&directory, &["check", "c.ron"]);
        assert!(
            told.contains("the file ends too early; a bracket or a quote is not closed"),
            "{end}: {told}"
        );
    }
}

/// A coefficient of friction that rounds to an angle of 90 degrees.
#[test]
fn a_coefficient_of_friction_that_is_too_large_is_named_as_it_is_written() {
    let directory = tempfile::tempdir().unwrap();
    let array = "%%MatrixMarket matrix array real general\n";
    put(&directory, "a_W.mtx", &format!("{array}2 2\n1\n0\n0\n1\n"));
    put(&directory, "a_q.mtx", &format!("{array}2 1\n-1\n0.5\n"));
    put(&directory, "a_mu.mtx", &format!("{array}1 1\n1e16\n"));
    let told = refusal(&directory, &["check", "a_W.mtx"]);
    assert!(
        told.starts_with(
            "a_mu.mtx: the friction coefficient is 1e16; it must be at least 0 and below 1e15"
        ),
        "{told}"
    );
}

#[test]
fn a_snapshot_whose_scene_is_invalid_is_refused_with_the_place_in_its_file() {
    let directory = tempfile::tempdir().unwrap();
    let sound = include_str!("../../snapshots/osc-tip-forced-to-sliding.ron");
    let damaged = sound.replacen("along: \"beam\"", "along: \"beem\"", 1);
    let line = 1 + damaged
        .lines()
        .position(|line| line.contains("beem"))
        .unwrap();
    put(&directory, "s.ron", &damaged);
    for command in [
        "replay s.ron",
        "audit s.ron",
        "diff s.ron s.ron",
        "export s.ron -o s.svg",
    ] {
        let words: Vec<&str> = command.split(' ').collect();
        let told = err(&run(&directory, &words));
        assert!(
            told.contains(&format!("s.ron:{line}:"))
                && told.contains("no chain of nodes called \"beem\""),
            "{command}: {told}"
        );
    }
}

#[test]
fn damaged_snapshots_and_lessons_are_refused_without_types_of_the_program() {
    let directory = tempfile::tempdir().unwrap();
    let sound = include_str!("../../snapshots/osc-tip-forced-to-sliding.ron");
    for (that, this, told) in [
        (
            "Beam(",
            "Beem(",
            "\"Beem\" is not one of the choices; did you mean \"Beam\"? (choices: Beam",
        ),
        (
            "along:",
            "along_:",
            "unknown field \"along_\"; did you mean \"along\"? (fields: ",
        ),
        ("from: (", "from: ((", "expected a number"),
    ] {
        let damaged = sound.replacen(that, this, 1);
        assert_ne!(damaged, sound, "{that}");
        put(&directory, "s.ron", &damaged);
        for command in ["replay", "audit"] {
            let found = refusal(&directory, &[command, "s.ron"]);
            assert!(found.contains(told), "{told}: {found}");
            assert!(found.starts_with("s.ron:"), "{found}");
        }
    }
    let press = |field: &str| {
        let lesson = format!(
            "(\n title: \"T\",\n scene: Name(\"osc-two6\"),\n steps: [\n  Press({field}: \"A\", press: \"s\"),\n ],\n)\n"
        );
        put(&directory, "l.ron", &lesson);
        refusal(&directory, &["lesson", "--check", "l.ron"])
    };
    for field in ["", "3"] {
        let found = press(field);
        assert!(found.starts_with("l.ron:5:9: "), "{found}");
        assert!(
            found.contains("field") && !found.contains("Press"),
            "{found}"
        );
    }
}

#[test]
fn a_mesh_that_no_scene_can_have_is_refused_under_its_own_name() {
    let directory = tempfile::tempdir().unwrap();
    let sound = include_str!("../meshes/text22.msh");
    let (before, nodes) = sound.split_once("$Nodes\n").unwrap();
    let (count, nodes) = nodes.split_once('\n').unwrap();
    let (first, rest) = nodes.split_once('\n').unwrap();
    let label = first.split(' ').next().unwrap();
    let far = format!("{before}$Nodes\n{count}\n{label} 1e300 0 0\n{rest}");
    put(&directory, "m.msh", &far);
    let told = refusal(&directory, &["export", "m.msh", "-o", "o.ron"]);
    assert!(told.starts_with("m.msh: nodes[0]"), "{told}");
    assert!(!directory.path().join("o.ron").exists());
}

#[test]
fn a_deck_gets_one_message_where_its_text_is_damaged() {
    let directory = tempfile::tempdir().unwrap();
    let check = |deck: &str, from: &str, to: &str| {
        assert!(deck.contains(from), "{from}");
        put(&directory, "d.inp", &deck.replacen(from, to, 1));
        refusal(&directory, &["check", "d.inp"])
    };
    // Three-dimensional: without its nodes and elements nothing can be checked.
    let solid = include_str!("../calculix/causes/stick.inp");
    let node = solid.lines().nth(1).unwrap();
    let coordinate = node.rsplit(',').next().unwrap().trim();
    let told = check(solid, node, &node.replace(coordinate, "NaN"));
    assert!(
        told.starts_with("d.inp:2:")
            && told.contains("found \"NaN\" where a coordinate, a number, was expected"),
        "{told}"
    );
    // Plane: the rules do not warn of what is missing because it cannot be read.
    let plane = include_str!("../decks/beam-on-a-post.inp");
    let told = check(plane, "ELSET=POST", "ELSET=PIST");
    assert!(told.starts_with("d.inp:"), "{told}");
    // The first keyword is damaged.
    let told = check(plane, "*HEADING", "HEADING");
    assert!(
        told.starts_with("d.inp:1:1: data before the first keyword"),
        "{told}"
    );
}

#[test]
fn bodies_without_any_stiffness_fail_and_are_not_tried_endlessly() {
    let directory = tempfile::tempdir().unwrap();
    let deck = include_str!("../decks/glued.inp").replace(
        "*SOLID SECTION, ELSET=BLOCKS, MATERIAL=STUFF\n",
        "*SOLID SECTION, ELSET=BLOCKS, MATERIAL=STUFF\n1e-300\n",
    );
    put(&directory, "d.inp", &deck);
    fs::create_dir(directory.path().join("parts")).unwrap();
    put(
        &directory,
        "parts/glued-mesh.inp",
        include_str!("../decks/parts/glued-mesh.inp"),
    );
    let output = run(&directory, &["run", "d.inp", "-q"]);
    assert_eq!(code(&output), 3, "{}", err(&output));
}

#[test]
fn an_empty_file_is_no_snapshot_and_no_type_of_the_program_is_named() {
    let directory = tempfile::tempdir().unwrap();
    for text in ["", "hello", "[]"] {
        put(&directory, "e.ron", text);
        let told = err(&run(&directory, &["replay", "e.ron"]));
        assert!(told.contains("e.ron:1:1: "), "{text}: {told}");
        assert!(
            told.contains("a value in round brackets, ( )"),
            "{text}: {told}"
        );
        assert!(!told.contains("Snapshot"), "{text}: {told}");
    }
}

/// The name of a file says its format: a damaged beginning is refused as one of that format.
#[test]
fn a_damaged_beginning_is_refused_as_the_format_of_the_name() {
    let directory = tempfile::tempdir().unwrap();
    let utf16 = |text: &str| -> Vec<u8> {
        let units = std::iter::once(0xfeff).chain(text.encode_utf16());
        units.flat_map(u16::to_le_bytes).collect()
    };
    let noise: Vec<u8> = (0..200u32).map(|k| (k * 97 % 251 + 5) as u8).collect();
    let marked = |text: &str| format!("\u{feff}{text}").into_bytes();
    let market = "%%MatrixMarket matrix array real general\n2 2\n1\n0\n0\n1\n";
    for (name, whole) in [
        ("w.mtx", market),
        ("w.dat", "2\n1\n1\n1 0\n"),
        ("w.inp", "*HEADING\n*NODE\n1, 0\n"),
        (
            "w.cel",
            "*ELEMENT,TYPE=C3D6,ELSET=contactelements_st1_in1_at1_it1\n",
        ),
        ("w.sta", "SUMMARY OF JOB INFORMATION\n"),
        ("w.msh", "$MeshFormat\n4.1 0 8\n"),
    ] {
        let cut = &whole[..whole.len().min(12)];
        for bytes in [
            Vec::new(),
            noise.clone(),
            b"hello\nyou\n".to_vec(),
            cut.as_bytes().to_vec(),
            cut.replace('\n', "\r\n").into_bytes(),
            marked(cut),
            utf16(whole),
        ] {
            let file = directory.path().join(name);
            std::fs::write(&file, &bytes).unwrap();
            let why = Scene::open(file.to_str().unwrap(), &[])
                .unwrap_err()
                .to_string();
            let found = format!("{name}, {:?}: {why}", String::from_utf8_lossy(&bytes));
            assert!(
                !why.contains("a scene is") && !why.contains("round brackets"),
                "{found}"
            );
            assert!(why.contains(&format!("{name}:")), "{found}");
            let no_text = std::str::from_utf8(&bytes).is_err() && name != "w.inp";
            assert_eq!(why.contains("is plain text"), no_text, "{found}");
        }
    }
    // A scene is read as one, whatever its name.
    let file = directory.path().join("scene.mtx");
    std::fs::write(&file, marked("(title: 3)")).unwrap();
    let why = Scene::open(file.to_str().unwrap(), &[])
        .unwrap_err()
        .to_string();
    assert!(!why.contains("MatrixMarket"), "{why}");
}
