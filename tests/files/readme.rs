//! The README is a front page: short, and it shows what the program shows.
//!
//! `README=write cargo test --test files` renews its picture and its list of pages.

use crate::pages;
use std::fs;
use std::path::PathBuf;

fn readme() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("README.md")
}

#[test]
fn the_picture_and_the_list_of_pages_in_the_readme_are_those_of_the_program() {
    pages::check(&readme());
}

#[test]
fn the_readme_is_a_front_page() {
    let readme = fs::read_to_string(readme()).unwrap();
    let lines = readme.lines().count();
    assert!(lines <= 150, "{lines} lines");
    assert!(readme.contains("cargo test "), "it must say how to test");
}

#[test]
fn every_command_in_the_readme_can_be_typed() {
    let readme = fs::read_to_string(readme()).unwrap();
    let lines = pages::typed(&readme);
    let commands: Vec<_> = lines
        .iter()
        .filter_map(|line| pages::arguments(line))
        .collect();
    assert!(commands.len() > 5);
    for words in commands {
        pages::is_command_line(&words).unwrap_or_else(|error| panic!("{words:?}: {error}"));
    }
}

/// The rows of a README table are rows of the page that it sends the reader to for all of them.
#[test]
fn the_readme_and_the_page_on_speed_tell_the_same() {
    let readme = fs::read_to_string(readme()).unwrap();
    let speed = stickslip::manual::page("speed").unwrap().text();
    let cells = |row: &str| {
        row.split('|')
            .map(|cell| cell.trim().to_owned())
            .collect::<Vec<_>>()
    };
    let rows = readme
        .lines()
        .skip_while(|line| !line.starts_with("| unknowns "))
        .skip(2);
    let rows: Vec<_> = rows
        .take_while(|line| line.starts_with('|'))
        .map(cells)
        .collect();
    assert_eq!(rows.len(), 3);
    for row in rows {
        let of = |line: &&str| cells(line).get(1) == row.get(1) && line.contains(&row[3]);
        let whole = cells(speed.lines().find(of).unwrap());
        assert!(
            row.iter().all(|cell| whole.contains(cell)),
            "{row:?} is not in {whole:?}"
        );
    }
}

#[test]
fn errors_that_the_readme_names_stand_on_the_page_on_verification() {
    let readme = fs::read_to_string(readme()).unwrap();
    let page = stickslip::manual::page("verification").unwrap().text();
    let rows = readme
        .lines()
        .skip_while(|line| !line.starts_with("| problem "));
    let rows: Vec<_> = rows
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .collect();
    assert_eq!(rows.len(), 5);
    for row in rows {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        // The page's rows of the same problem, by its number or first word.
        let problem = cells[1].split([' ', ',']).next().unwrap();
        let mut inside = false;
        let of = |line: &&str| {
            // A row without a problem belongs to the one above.
            inside = match line.strip_prefix("| | ") {
                Some(_) => inside,
                None => line.starts_with(&format!("| {problem}")),
            };
            inside
        };
        let own: String = page.lines().filter(of).collect();
        for error in cells[3].split("; ") {
            assert!(own.contains(error), "{row}: {error} is not in {own}");
        }
    }
}
