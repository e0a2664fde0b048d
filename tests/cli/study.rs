//! Studies: what is run, in which order, and what becomes of it.

use crate::program::{code, err, interrupted, names, out, program, refused};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use stickslip::scene::Scene;
use stickslip::step::event::Outcome;
use stickslip::step::stepper::Stepper;
use stickslip::study::{
    self, AxisQuantity, Plan, Reason, Run, Study, Vary, Watch, csv, curves, figure,
};

const BEAM: &str = "01-pinned-beam-rough-floor";
const ROUGH: &str = "02-two-cantilevers-rough";
const OSC: &str = "osc-inclined-cantilever";

fn ran_in(directory: &Path, arguments: &[&str]) -> Output {
    command(directory, arguments).output().unwrap()
}

fn command(directory: &Path, arguments: &[&str]) -> Command {
    program(directory, &[&["study"], arguments].concat())
}

fn ran(arguments: &[&str]) -> Output {
    ran_in(&std::env::temp_dir(), arguments)
}

/// The rows of a table as fields; each must have as many as the header.
fn rows(table: &str) -> Vec<Vec<String>> {
    assert!(table.ends_with('\n'), "cut off: {table:?}");
    let all: Vec<Vec<String>> = table
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect();
    assert!(all.iter().all(|row| row.len() == all[0].len()), "{table}");
    all
}

fn study(scene: &str, vary: &[(&str, &[&str])]) -> Study {
    let mut study = Study::from_scene(scene);
    for (path, values) in vary {
        study.vary(Vary {
            path: path.to_string(),
            values: values.iter().map(|v| v.to_string()).collect(),
        });
    }
    study
}

fn all_of(plan: &Plan, jobs: usize) -> Vec<Run> {
    let watch = Watch {
        stop: &|| false,
        done: &|_| {},
    };
    study::run(plan, NonZeroUsize::new(jobs).unwrap(), &watch).unwrap()
}

#[test]
fn results_are_in_the_order_of_the_product_whatever_finishes_first() {
    let vary: &[(&str, &[&str])] = &[
        ("history.increment", &["0.05", "0.5"]),
        ("friction.angle", &["30", "35", "40"]),
    ];
    let plan = Plan::new(study(ROUGH, vary)).unwrap();
    let values: Vec<String> = plan.cases.iter().map(|c| c.values.join(" ")).collect();
    let expected = [
        "0.05 30", "0.05 35", "0.05 40", "0.5 30", "0.5 35", "0.5 40",
    ];
    assert_eq!(values, expected);
    let increments = plan.cases.iter().map(|case| case.increments);
    assert_eq!(increments.sum::<u64>(), 3 * (50 + 5));
    let runs = all_of(&plan, 4);
    let accepted: Vec<usize> = runs.iter().map(|run| run.rows.len()).collect();
    assert_eq!(accepted, [50, 50, 50, 5, 5, 5]);
}

#[test]
fn bits_do_not_depend_on_the_number_of_jobs_and_are_those_of_a_run_alone() {
    let vary: &[(&str, &[&str])] = &[
        ("history.increment", &["0.05", "0.1"]),
        ("settings.geometry", &["frozen", "consistent"]),
    ];
    let plan = Plan::new(study(BEAM, vary)).unwrap();
    let alone = csv::table(&plan, &all_of(&plan, 1));
    for jobs in [2, 7] {
        assert_eq!(
            csv::table(&plan, &all_of(&plan, jobs)),
            alone,
            "{jobs} jobs"
        );
    }
    let (path, value) = ("settings.geometry".to_owned(), "frozen".to_owned());
    let increment = ("history.increment".to_owned(), "0.1".to_owned());
    let scene = Scene::open(BEAM, &[increment, (path, value)]).unwrap();
    let mut stepper = Stepper::new(scene.model.into());
    let run = &all_of(&plan, 2)[2];
    let mut rows = run.rows.iter();
    while let Some(event) = stepper.step().cloned() {
        if matches!(event.outcome, Outcome::Increment { .. }) {
            let mut monitors = Vec::new();
            stepper.monitors(&mut monitors);
            let row = rows.next().unwrap();
            assert_eq!(
                (&row.monitors, row.majors),
                (&monitors, event.position.major)
            );
        }
    }
    assert!(rows.next().is_none() && !run.rows.is_empty());
}

#[test]
fn a_run_that_fails_is_a_row_that_says_where_and_why() {
    let output = ran(&[OSC, "--vary", "history.increment=0.02,0.05", "--csv", "-"]);
    assert_eq!(code(&output), 0, "failures are data: {}", err(&output));
    let table = rows(&out(&output));
    let header = "history.increment,status,increment,load,majors,minors,unsettled,u_x,u_y";
    assert!(table[0].join(",").starts_with(header), "{:?}", table[0]);
    assert_eq!(table[0].last().map(String::as_str), Some("jumped"));
    let status: Vec<String> = table[1..].iter().map(|r| r[..3].join(" ")).collect();
    let expected = [
        "0.02 converged 1",
        "0.02 converged 2",
        "0.02 minor-cycle 3",
        "0.05 minor-cycle 1",
    ];
    assert_eq!(status, expected);
    assert_eq!(table[3][3..8], ["0.06", "1", "2", "0", ""]);
    let told = err(&output);
    assert!(told.contains("2/50"), "{told}");
    assert!(told.contains("minor-cycle in increment 3, major 1, load 0.06"));
    assert!(told.contains("2 of 2 runs failed"), "{told}");
    let quiet = ran(&[OSC, "--vary", "history.increment=0.02", "--quiet"]);
    assert_eq!(
        err(&quiet).lines().count(),
        1,
        "still told: {}",
        err(&quiet)
    );
}

#[test]
fn what_is_accepted_unsettled_is_not_called_converged() {
    let limits = ["--set", "settings.at_major_limit=accept"];
    let mut arguments = vec![ROUGH, "--vary", "settings.majors=1,50", "--csv", "-"];
    arguments.extend(limits);
    let output = ran(&arguments);
    let table = rows(&out(&output));
    for row in &table[1..] {
        let (status, unsettled) = match row[0].as_str() {
            "1" => ("accepted", "1"),
            _ => ("converged", "0"),
        };
        assert_eq!((row[1].as_str(), row[6].as_str()), (status, unsettled));
    }
    assert_eq!(table.len(), 101);
    let told = err(&output);
    assert!(told.contains("1 of 2 runs have increments"), "{told}");
}

#[test]
fn bad_input_ends_with_2_and_one_line_before_anything_runs() {
    let directory = tempfile::tempdir().unwrap();
    let bad = "(title: \"a\",\n scene: \"01-pinned-beam-rough-floor\",\n  vari: [])";
    std::fs::write(directory.path().join("bad.ron"), bad).unwrap();
    // Any of these would take minutes if it ran.
    let long = "history.increment=5e-6";
    for (arguments, part) in [
        (
            &[ROUGH, "--vary", "friction.angel=1,2"][..],
            "did you mean friction.angle",
        ),
        (
            &[ROUGH, "--vary", "friction.angle=30,95"],
            "friction.angle=95",
        ),
        (
            &[ROUGH, "--vary", "friction.angle=30,x"],
            "must be a number",
        ),
        (&[ROUGH, "--vary", "friction.angle=30,30"], "twice"),
        (&[ROUGH, "--vary", "friction.angle="], "must be a number"),
        (&[ROUGH, "--vary", "history=1"], "not a single value"),
        (
            &[ROUGH, "--vary", "materials.*.update=a,b"],
            "materials.*.update",
        ),
        (&[ROUGH, "--x", "u_z"], "u_x"),
        (&[ROUGH, "--svg", "no/such/place.svg"], "place.svg"),
        (&[ROUGH, "--svg", "a", "--png", "a"], "only one"),
        (&["no-such-study"], "fig-08-increment"),
        (&["bad.ron"], "bad.ron:3:"),
    ] {
        let mut all = arguments.to_vec();
        if arguments[0] == ROUGH {
            all.extend(["--set", long, "--csv", "a.csv"]);
        }
        let output = ran_in(directory.path(), &all);
        assert_eq!(code(&output), 2, "{arguments:?}: {}", err(&output));
        assert_eq!(err(&output).lines().count(), 1, "{}", err(&output));
        assert!(err(&output).contains(part), "{part}: {}", err(&output));
        assert_eq!(out(&output), "");
    }
    assert_eq!(names(directory.path()), ["bad.ron"]);
    for arguments in [&[ROUGH, "--jobs", "0"][..], &[ROUGH, "--vary", "x"], &[]] {
        assert_eq!(code(&ran(arguments)), 2, "{arguments:?}");
    }
}

#[test]
fn files_are_whole_and_overwritten_only_when_asked() {
    let directory = tempfile::tempdir().unwrap();
    for option in ["--csv", "--svg", "--png"] {
        let file = directory.path().join("precious");
        std::fs::write(&file, "precious").unwrap();
        let arguments = [ROUGH, option, "precious", "--set", "history.increment=5e-6"];
        let output = ran_in(directory.path(), &arguments);
        refused(&output, "--force");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "precious");
        let output = ran_in(directory.path(), &[ROUGH, option, "precious", "--force"]);
        assert_eq!(code(&output), 0, "{}", err(&output));
        assert_ne!(std::fs::read(&file).unwrap(), b"precious");
        assert_eq!(names(directory.path()), ["precious"]);
    }
    let bytes = std::fs::read(directory.path().join("precious")).unwrap();
    assert!(bytes.starts_with(b"\x89PNG") && bytes.ends_with(b"IEND\xaeB\x60\x82"));
}

#[test]
fn a_figure_names_its_runs_marks_failures_and_says_what_it_was_made_from() {
    let mut study = study(OSC, &[("history.increment", &["0.01", "0.05"])]);
    study.set.push(("settings.majors".into(), "70".into()));
    let plan = Plan::new(study).unwrap();
    let runs = all_of(&plan, 2);
    let failed: Vec<Reason> = runs
        .iter()
        .filter_map(|r| Some(r.failed()?.reason))
        .collect();
    assert_eq!(failed, [Reason::MinorCycle; 2]);
    let chart = figure::chart(&plan, &runs);
    assert_eq!(
        chart.curves[0].points[0],
        (0.0, 0.0),
        "from the start of the history"
    );
    assert_eq!(chart.curves[0].points.len(), 5);
    let svg = chart.sheet().unwrap().svg().unwrap();
    for part in [
        "increment=0.01",
        "increment=0.05",
        "minor-cycle in increment 5, load 0.05",
        "Scene: osc-inclined-cantilever; settings.majors=70",
        "2 runs, of which 2 failed",
        concat!("stickslip ", env!("CARGO_PKG_VERSION")),
        std::env::consts::ARCH,
        "load factor",
        "u_x",
    ] {
        assert!(svg.contains(part), "{part}");
    }
    // Two strokes for each cross: one at the end of the curve, one in the legend.
    assert_eq!(svg.matches("#C00000").count(), 2 * 2 * 2);
    assert_eq!(chart.sheet().unwrap().svg().unwrap(), svg);
    let whole = Plan::new(Study::from_scene(ROUGH)).unwrap();
    let svg = figure::chart(&whole, &all_of(&whole, 1))
        .sheet()
        .unwrap()
        .svg()
        .unwrap();
    assert_eq!(svg.matches("#C00000").count(), 0);
}

#[test]
fn charts_with_little_or_nothing_or_much_in_them_are_drawn() {
    let axis = |counts| curves::Axis {
        name: "a & <b>".into(),
        counts,
    };
    let curve = |label: String, points: &[(f64, f64)]| curves::Curve {
        label,
        points: points.to_vec(),
        end: curves::CurveEnd::Failed("why".into()),
    };
    let mut chart = curves::CurveChart {
        title: "A title that is too long for one line ".repeat(9),
        x: axis(true),
        y: axis(false),
        curves: Vec::new(),
        footer: vec![String::new()],
    };
    chart.sheet().unwrap().png(2.0).unwrap();
    chart.curves.push(curve(String::new(), &[]));
    chart.curves.push(curve("one".into(), &[(3.0, -1e300)]));
    chart.sheet().unwrap().png(2.0).unwrap();
    for k in 0..60 {
        chart
            .curves
            .push(curve(format!("run {k}"), &[(0.0, 0.0), (1e-12, 1.0)]));
    }
    let svg = chart.sheet().unwrap().svg().unwrap();
    assert!(svg.contains("and 14 more") && !svg.contains("a & <b>"));
    chart.sheet().unwrap().png(2.0).unwrap();
}

#[test]
fn study_files_are_read_and_their_errors_have_a_place() {
    let text = "(title: \"T\", about: \"A\", scenes: [\"a\", \"b\"], x: \"u_x\", y: \"minors\",
        vary: [(\"p\", [0.10, 2, \"w\", v, true])], set: [(\"q\", -1e-9)])";
    let read = Study::from_text("s.ron", text).unwrap();
    assert_eq!(read.vary[0].values, ["0.1", "2", "w", "v", "true"]);
    assert_eq!(read.set, [("q".to_owned(), "-1e-9".to_owned())]);
    assert_eq!(read.x, Some(AxisQuantity::Monitor("u_x".into())));
    assert_eq!(read.y, Some(AxisQuantity::Minors));
    for (text, at, part) in [
        ("(title: \"T\",\n scens: \"a\")", (2, 2), "did you mean"),
        ("(title: \"T\",\n scene: 3)", (2, 9), "scene"),
        (
            "(title: \"T\",\n vary: [(\"p\", [1, (2)])])",
            (2, 19),
            "number",
        ),
        (
            "(title: \"T\",\n set: [(\"p\", [frozen])])",
            (2, 13),
            "quotes",
        ),
        ("(title: \"T\", scene: \"a\"", (1, 24), "bracket"),
    ] {
        let error = Study::from_text("s.ron", text).unwrap_err();
        assert_eq!(error.at.unwrap().0, at.0, "{error}");
        assert!(error.at.unwrap().1.abs_diff(at.1) <= 8, "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
    assert!(Study::from_text("s.ron", "(title: \"T\")").is_err());
}

/// A folder with a copy of a scene, and the scene's text.
fn folder_with_scene(directory: &Path) -> (PathBuf, &'static str) {
    let folder = directory.join("mine");
    let scene = stickslip::scene::builtin::find(ROUGH).unwrap().text;
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("scene.ron"), scene).unwrap();
    (folder, scene)
}

#[test]
fn a_study_file_and_the_scene_beside_it_are_found_and_arguments_go_over_it() {
    let directory = tempfile::tempdir().unwrap();
    let (folder, _) = folder_with_scene(directory.path());
    let text = "(title: \"T\", scene: \"scene.ron\", vary: [(\"history.increment\", [0.5, 1.25])])";
    std::fs::write(folder.join("study.ron"), text).unwrap();
    let rows_of = |arguments: &[&str]| {
        let output = ran_in(directory.path(), arguments);
        assert_eq!(code(&output), 0, "{}", err(&output));
        rows(&out(&output)).len() - 1
    };
    assert_eq!(rows_of(&["mine/study.ron", "--csv", "-"]), 5 + 2);
    let other = [
        "mine/study.ron",
        "--csv",
        "-",
        "--vary",
        "history.increment=0.25",
    ];
    assert_eq!(rows_of(&other), 10);
    let more = [
        "mine/study.ron",
        "--csv",
        "-",
        "--vary",
        "friction.angle=30,35",
    ];
    assert_eq!(rows_of(&more), 2 * (5 + 2));
    assert_eq!(rows_of(&["mine/scene.ron", "--csv", "-"]), 50);
}

#[test]
fn a_study_writes_all_of_its_files_or_none() {
    let directory = tempfile::tempdir().unwrap();
    let run = |svg: &str| {
        let arguments = [
            OSC,
            "--vary",
            "history.increment=0.05",
            "--csv",
            "a.csv",
            "--svg",
            svg,
            "--png",
            "a.png",
            "--force",
        ];
        ran_in(directory.path(), &arguments)
    };
    std::fs::write(directory.path().join("a.csv"), "old").unwrap();
    let output = run("/dev/full");
    refused(&output, "/dev/full");
    assert_eq!(names(directory.path()), ["a.csv"]);
    let text = || std::fs::read_to_string(directory.path().join("a.csv")).unwrap();
    assert_eq!(text(), "old");
    assert_eq!(code(&run("a.svg")), 0);
    assert_eq!(names(directory.path()), ["a.csv", "a.png", "a.svg"]);
    assert_ne!(text(), "old");
}

#[test]
fn what_a_study_names_lies_beside_it_or_below_or_is_built_in() {
    let directory = tempfile::tempdir().unwrap();
    let (folder, scene) = folder_with_scene(directory.path());
    // What lies where the program runs is not what the study means.
    std::fs::write(directory.path().join("other.ron"), scene).unwrap();
    let named = |scene: &str| {
        let text = format!("(title: \"T\", scene: {scene:?}, vary: [(\"increment\", [1.25])])");
        std::fs::write(folder.join("study.ron"), text).unwrap();
        let output = ran_in(directory.path(), &["mine/study.ron", "--csv", "-"]);
        (code(&output), err(&output))
    };
    for sound in ["scene.ron", "./scene.ron", ROUGH] {
        let (code, err) = named(sound);
        assert_eq!(code, 0, "{sound}: {err}");
    }
    let absolute = folder.join("scene.ron").display().to_string();
    for refused in ["other.ron", "../other.ron", "mine/scene.ron", &absolute] {
        let (code, err) = named(refused);
        assert_eq!(code, 2, "{refused}: {err}");
        assert!(
            err.starts_with("mine/study.ron")
                && err.contains("in the folder of this file or below"),
            "{refused}: {err}"
        );
    }
}

#[test]
fn a_star_sets_all_that_fit_and_several_scenes_have_a_column() {
    let mut both = study(ROUGH, &[("materials.*.EA", &["90", "110"])]);
    both.scenes.push("02-two-cantilevers-smooth".to_owned());
    both.set.push(("history.path[1]".into(), "0.05".into()));
    let plan = Plan::new(both).unwrap();
    assert_eq!(plan.columns, ["scene", "materials.*.EA"]);
    let stiffness: Vec<String> = plan
        .cases
        .iter()
        .map(|case| {
            let spec = case.open().unwrap().spec;
            let all = stickslip::format::paths::list(&spec);
            let found = all.into_iter().find(|l| l.path == "materials.rod.EA");
            found.unwrap().value
        })
        .collect();
    assert_eq!(stiffness, ["90.0", "110.0", "90.0", "110.0"]);
    let table = csv::table(&plan, &all_of(&plan, 2));
    assert!(table.contains("02-two-cantilevers-smooth,110,converged,1,0.05,"));
}

#[test]
fn built_in_studies_are_read_and_those_of_built_in_scenes_are_sound() {
    for builtin in study::builtin::list() {
        let study = Study::open(builtin.name).unwrap_or_else(|e| panic!("{e}"));
        assert!(!study.about.is_empty() && !study.title.is_empty());
        let known = |scene: &String| stickslip::scene::builtin::find(scene).is_some();
        if study.scenes.iter().all(known) {
            Plan::new(study).unwrap_or_else(|e| panic!("{e}"));
        }
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_study_with_130_and_whole_files_of_what_is_done() {
    let directory = tempfile::tempdir().unwrap();
    let vary = "history.increment=0.5,5e-6,5.5e-6";
    let arguments = [
        ROUGH, "--vary", vary, "--jobs", "1", "--csv", "a.csv", "--svg", "a.svg",
    ];
    let child = command(directory.path(), &arguments)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The files to be show that the program listens; the first run takes milliseconds, the second one minutes.
    while names(directory.path()).len() < 2 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    std::thread::sleep(std::time::Duration::from_secs(2));
    let output = interrupted(child);
    assert!(err(&output).contains("interrupted after 1 of 3 runs"));
    assert_eq!(names(directory.path()), ["a.csv", "a.svg"]);
    let table = rows(&std::fs::read_to_string(directory.path().join("a.csv")).unwrap());
    assert_eq!(table[5][..3], ["0.5", "converged", "5"]);
    assert_eq!(table.last().unwrap()[..2], ["5e-6", "interrupted"]);
    let svg = std::fs::read_to_string(directory.path().join("a.svg")).unwrap();
    assert!(svg.trim_end().ends_with("</svg>") && svg.contains("interrupted"));
}

#[test]
fn faults_of_a_study_have_their_place_in_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let sound = r#"(
    title: "Two nodes",
    scenes: ["osc-two6", "osc-two3"],
    set: [("settings.strategy", "table2")],
    vary: [
        ("friction.angle", [20.0, 30.0]),
        ("settings.slip", ["increment", "major"]),
    ],
    x: "load",
    y: "majors",
)"#;
    let fault = |that: &str, this: &str, more: &[&str]| {
        let text = sound.replacen(that, this, 1);
        assert_ne!(text, sound);
        std::fs::write(folder.path().join("s.ron"), text).unwrap();
        let output = ran_in(folder.path(), &[&["s.ron"], more].concat());
        assert_eq!(code(&output), 2);
        err(&output).trim().to_owned()
    };
    for (that, this, told) in [
        (
            "\"table2\"",
            "\"table3\"",
            "s.ron:4:11: set[0]: in osc-two6: \"table3\" is not valid",
        ),
        (
            "settings.strategy",
            "settings.strateg",
            "s.ron:4:11: set[0]: in osc-two6: the scene has no value",
        ),
        ("30.0", "95.0", "s.ron:6:9: vary[0]: in osc-two6: "),
        (
            "30.0",
            "20.0",
            "s.ron:6:35: vary[0][1][1]: friction.angle has the value 20.0 twice",
        ),
        (
            "settings.slip",
            "friction.angle",
            "s.ron:7:9: vary[1]: friction.angle is varied twice",
        ),
        (
            "[\"increment\", \"major\"]",
            "[]",
            "s.ron:7:9: vary[1]: settings.slip has no values",
        ),
        (
            "\"load\"",
            "\"lode\"",
            "s.ron:9:8: x: unknown quantity \"lode\"",
        ),
        ("\"majors\"", "\"major\"", "s.ron:10:8: y: unknown quantity"),
        (
            "\"osc-two3\"",
            "\"osc-two\"",
            "s.ron:3:26: scenes[1]: no scene \"osc-two\"",
        ),
        (
            "scenes: [\"osc-two6\", \"osc-two3\"]",
            "scene: \"osc\"",
            "s.ron:3:12: scene: no scene \"osc\"",
        ),
        (
            "scenes",
            "scene: \"osc-two6\", scenes",
            "s.ron:3:32: scenes: a study needs either",
        ),
        (
            "(\"settings.strategy\", \"table2\")",
            "(\"settings.strategy\",)",
            "s.ron:4:11: set[0]",
        ),
    ] {
        let found = fault(that, this, &[]);
        assert!(found.starts_with(told), "{told}: {found}");
        assert!(!found.contains("two numbers"), "{found}");
    }
    // A value of the command line has no place in the file.
    let found = fault("30.0", "35.0", &["--x", "lode"]);
    assert!(found.starts_with("s.ron: unknown quantity"), "{found}");
    let found = fault("30.0", "35.0", &["--set", "settings.slip=x"]);
    assert!(
        found.starts_with("osc-two6: --set settings.slip=x: "),
        "{found}"
    );
}

#[test]
fn paragraphs_below_the_options_fill_the_lines_of_the_terminal() {
    for command in ["study", "map", "chart"] {
        let output = program(&std::env::temp_dir(), &[command, "--help"])
            .output()
            .unwrap();
        let text = out(&output);
        let end = text.split("Options:").nth(1).unwrap();
        let paragraph = end.split("\n\n").last().unwrap();
        let lines: Vec<&str> = paragraph.trim_end().lines().collect();
        let (_, full) = lines.split_last().unwrap();
        assert!(full.iter().all(|line| line.len() > 80), "{paragraph}");
    }
}
