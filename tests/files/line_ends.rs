//! Text files with CRLF, as editors and git write them on Windows, are read like those with LF.

#![cfg(unix)]

use crate::hostile::{CHART, CONTACTS, LESSON, STUDY, put, reader, run, scene};
use crate::program::{code, err, out};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Files of the repository.
const FILES: &[&str] = &[
    "problems/lessons/kratos-walk.exchange",
    "tests/calculix/causes/coarse.cel",
    "tests/calculix/causes/coarse.cvg",
    "tests/calculix/causes/coarse.sta",
    "tests/decks/glued.inp",
    "tests/decks/parts/glued-mesh.inp",
    "tests/journals/up-the-ladder.journal",
    "tests/meshes/text22.msh",
    "tests/meshes/text41.msh",
    "tests/siconos/two-blocks.dat",
];

/// Commands that write files of other kinds.
const WRITERS: &[&str] = &[
    "record osc-p5-slow --at 1 -o a.snapshot",
    "study study.ron --log study.log",
    "map --random 1 --log map.log",
    "export contacts.ron -o problem_W.mtx",
    "export text22.msh -o mesh22.ron",
    "export text41.msh -o mesh41.ron",
];

/// Commands that read a file, and print the same at each run.
const READERS: &[&str] = &[
    "run scene.ron --csv -",
    "run contacts.ron --csv -",
    "lesson --check lesson.ron",
    "study study.ron --merge study.log",
    "map --random 1 --merge map.log",
    "chart --from chart.csv",
    "replay a.snapshot",
    "resume --check up-the-ladder.journal",
    "show kratos-walk.exchange",
    "show coarse.cel",
    "run glued.inp --csv -",
    "run mesh22.ron --csv -",
    "run mesh41.ron --csv -",
    "run two-blocks.dat --csv -",
    "run problem_W.mtx --csv -",
];

fn end_lines_with_crlf(folder: &Path) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            end_lines_with_crlf(&path);
        } else {
            let text = fs::read_to_string(&path).unwrap();
            fs::write(&path, text.replace('\n', "\r\n")).unwrap();
        }
    }
}

#[test]
fn every_reader_takes_crlf() {
    let folder = TempDir::new().unwrap();
    let top = Path::new(env!("CARGO_MANIFEST_DIR"));
    for file in FILES {
        let name = Path::new(file).file_name().unwrap();
        // A deck names its mesh in a folder.
        let part = if file.contains("/parts/") {
            "parts"
        } else {
            ""
        };
        fs::create_dir_all(folder.path().join(part)).unwrap();
        fs::copy(top.join(file), folder.path().join(part).join(name)).unwrap();
    }
    put(&folder, "scene.ron", &scene("osc-p5-slow"));
    put(&folder, "contacts.ron", CONTACTS);
    put(&folder, "lesson.ron", LESSON);
    put(&folder, "study.ron", STUDY);
    put(&folder, "chart.csv", CHART);
    for writer in WRITERS {
        let written = run(&folder, &reader(writer, ""));
        assert_eq!(code(&written), 0, "{writer}: {}", err(&written));
    }
    let read = |line: &&str| {
        let output = run(&folder, &reader(line, ""));
        (code(&output), out(&output), err(&output))
    };
    let before: Vec<_> = READERS.iter().map(read).collect();
    end_lines_with_crlf(folder.path());
    for (line, before) in READERS.iter().zip(before) {
        assert_eq!(read(line), before, "{line}");
        assert_ne!(before.0, 2, "{line}: {}", before.2);
    }
}
