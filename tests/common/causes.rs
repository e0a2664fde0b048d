//! The decks of `tests/calculix/causes`, which `.ci/decks` makes: each fails in CalculiX for one cause.
#![allow(dead_code)]

use std::path::Path;
use stickslip::recorded::calculix::run::CalculixRun;
use stickslip::recorded::calculix::{OpenedRun, file};

/// A row of causes.csv.
pub struct Row {
    pub deck: String,
    pub rule: String,
    /// What came of the deck in CalculiX.
    pub outcome: String,
    /// Lines of the deck.
    pub cure: String,
    /// What came of the deck with the cure.
    pub cured: String,
}

/// The rows of causes.csv.
pub fn rows() -> Vec<Row> {
    let text = include_str!("../calculix/causes/causes.csv");
    let mut cells = vec![vec![String::new()]];
    let mut quoted = false;
    for letter in text.chars() {
        let row = cells.last_mut().unwrap();
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => row.push(String::new()),
            '\n' if !quoted => cells.push(vec![String::new()]),
            _ => row.last_mut().unwrap().push(letter),
        }
    }
    let rows = cells.into_iter().skip(1).filter(|row| row.len() > 1);
    rows.map(|row| {
        let [deck, rule, outcome, cure, cured] = row.try_into().unwrap();
        Row {
            deck,
            rule,
            outcome,
            cure,
            cured,
        }
    })
    .collect()
}

/// The run of a deck; `root` is `tests/calculix`.
pub fn opened(root: &Path, deck: &str) -> OpenedRun {
    let own = root.join(format!("causes/{deck}.cel"));
    let path = match own.is_file() {
        true => own,
        false => root.join(format!("{deck}.cel")),
    };
    file(path.to_str().unwrap()).unwrap().unwrap()
}

/// The same, without the scene.
pub fn run(root: &Path, deck: &str) -> std::sync::Arc<CalculixRun> {
    opened(root, deck).run
}
