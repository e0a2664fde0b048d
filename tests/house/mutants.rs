//! The faults in the sources, those in the table of the mutation bench and the tests that it names agree.

use super::{imports::rust_files, top};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;

/// The rows of the table: fault, file, program, test.
fn table() -> Vec<[String; 4]> {
    let text = fs::read_to_string(top().join("tests/mutants/faults.csv")).unwrap();
    let row = |line: &str| {
        let fields: Vec<String> = line.split(',').map(String::from).collect();
        fields.try_into().unwrap_or_else(|_| panic!("{line}"))
    };
    text.lines().skip(1).map(row).collect()
}

/// The faults that are named in the sources, each with its file.
fn planted() -> Vec<(String, String)> {
    let mut found = Vec::new();
    for file in rust_files(&top().join("src"), &[]) {
        let text = fs::read_to_string(top().join("src").join(&file)).unwrap();
        for call in ["mutants::is_active(", "mutants::pick("] {
            let names = text.split(call).skip(1).map(|rest| rest.split('"').nth(1));
            found.extend(names.map(|name| (name.unwrap().to_owned(), format!("src/{file}"))));
        }
    }
    found.sort();
    found
}

/// Where the tests of a program are.
fn folder(program: &str) -> PathBuf {
    let source = match program {
        "stickslip" => "src".into(),
        library => match library.strip_prefix("stickslip_") {
            Some(package) => format!("src/{package}"),
            None => format!("tests/{program}"),
        },
    };
    top().join(source)
}

#[test]
fn every_fault_of_the_mutation_bench_is_in_its_table_once() {
    let mut listed: Vec<_> = table()
        .into_iter()
        .map(|[fault, file, ..]| (fault, file))
        .collect();
    listed.sort();
    assert_eq!(planted(), listed);
    let names: BTreeSet<_> = listed.iter().map(|(fault, _)| fault).collect();
    assert_eq!(names.len(), listed.len());
}

#[test]
fn every_test_that_must_catch_a_fault_exists() {
    let mut sources: BTreeMap<String, String> = BTreeMap::new();
    for [fault, _, program, test] in table() {
        let text = sources.entry(program.clone()).or_insert_with(|| {
            let folder = folder(&program);
            let files = rust_files(&folder, &[]).into_iter();
            files
                .map(|file| fs::read_to_string(folder.join(file)).unwrap())
                .collect()
        });
        let name = test.rsplit("::").next().unwrap();
        assert!(
            text.contains(&format!("fn {name}(")),
            "{fault}: {program} {test}"
        );
    }
}
