//! The faults of the mutation bench fit the sources, and its table has each of them with a test that exists.

use super::{imports::rust_files, top};
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

/// The rows of the table: fault, program, test.
fn table() -> Vec<[String; 3]> {
    let text = fs::read_to_string(top().join("tests/mutants/faults.csv")).unwrap();
    let row = |line: &str| {
        let fields: Vec<String> = line.split(',').map(String::from).collect();
        fields.try_into().unwrap_or_else(|_| panic!("{line}"))
    };
    text.lines().skip(1).map(row).collect()
}

/// The hunks of the patch: file, the lines before, the lines after.
fn hunks() -> Vec<(String, [String; 2])> {
    let text = fs::read_to_string(top().join("tests/mutants/faults.patch")).unwrap();
    let (mut hunks, mut file) = (Vec::<(String, [String; 2])>::new(), "");
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("+++ b/") {
            file = name;
        } else if line.starts_with("@@") {
            hunks.push((file.into(), Default::default()));
        } else if let Some((_, sides)) = hunks.last_mut()
            && !["diff", "index", "new file", "--- "]
                .iter()
                .any(|head| line.starts_with(head))
        {
            for (side, without) in sides.iter_mut().zip(['+', '-']) {
                if !line.starts_with(without) {
                    *side += &format!("{}\n", line.get(1..).unwrap_or_default());
                }
            }
        }
    }
    hunks
}

/// The faults that the patch names.
fn planted() -> Vec<String> {
    let added: String = hunks().into_iter().map(|(_, [_, after])| after).collect();
    let calls = ["mutants::is_active(", "mutants::pick("];
    let named = calls.iter().flat_map(|call| added.split(call).skip(1));
    let mut names: Vec<_> = named
        .map(|rest| rest.split('"').nth(1).unwrap().into())
        .collect();
    names.sort();
    names
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
    let mut listed: Vec<_> = table().into_iter().map(|[fault, ..]| fault).collect();
    listed.sort();
    assert_eq!(planted(), listed);
    listed.dedup();
    assert_eq!(planted().len(), listed.len());
}

#[test]
fn every_fault_of_the_mutation_bench_fits_one_place_of_its_file() {
    for (file, [before, after]) in hunks() {
        let text = fs::read_to_string(top().join(&file)).unwrap_or_default();
        let places = text.matches(&before).count();
        assert!(
            before.is_empty() || places == 1,
            "tests/mutants/faults.patch: {places} places of {file} fit this fault; renew it (page contributing):\n{after}"
        );
    }
}

#[test]
fn every_test_that_must_catch_a_fault_exists() {
    let mut sources: BTreeMap<String, String> = BTreeMap::new();
    for [fault, program, test] in table() {
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
