//! Reads CalculiX and Abaqus decks as scenes.
//!
//! How a deck is interpreted, file by file:
//!
//! - `bodies`: one given mesh `n` whose nodes keep the deck's numbers (`n.12`). Connected elements with the same section form a
//!   body, named after the section's set. Steps with NLGEOM use large strains with St Venant-Kirchhoff's law in total Lagrangian
//!   form, like CalculiX's linear elastic material; steps without it use small strains.
//! - `contact`: pairs and ties; the nodes of the first surface are slaves on the sides of the second.
//! - `curves`: loads as functions of time over all steps; `loads`: supports, prescribed displacements and loads that use them.
//!
//! [`Origin`] records where each value of the scene comes from, so that errors found later are reported with the deck's line.

mod bodies;
mod contact;
mod curves;
mod loads;
#[cfg(test)]
mod tests;

use crate::format::error::{self, Path, Step, at};
use crate::{SceneError, Spec};
use stickslip_core::groups::marked;

use crate::shown::cut;
use std::collections::HashSet;
use std::path::Path as FilePath;
use stickslip_platform::input::{self, Unreadable};

use stickslip_exchange::inp::deck::Direction;
use stickslip_exchange::inp::{self, DECK_BYTES, Deck, DeckError, DeckLocation, Fault};

pub(super) use stickslip_exchange::inp::is_one;

/// Id of the mesh with all nodes and elements.
const MESH: &str = "n";

/// A deck as a scene.
pub(super) struct DeckScene {
    /// The scene.
    pub spec: Spec,
    /// Where its values come from.
    pub origin: Origin,
    /// Warnings about input that was ignored or reinterpreted, with file and line.
    pub remarks: Vec<String>,
}

/// Locations in the deck of the values of a scene.
#[derive(Debug, Clone, Default)]
pub(super) struct Origin {
    /// Names of the deck and of its include files.
    files: Vec<String>,
    /// Location of each node of the mesh.
    nodes: Vec<DeckLocation>,
    /// Location of each element of each list of cells.
    cells: Vec<Vec<DeckLocation>>,
    /// Locations of all other values.
    others: Vec<(Path, DeckLocation)>,
}

impl Origin {
    /// File, line and column of a value, or of the nearest enclosing one with a known location.
    pub fn of(&self, path: &Path) -> Option<(&str, (usize, usize))> {
        let place = self.place(path)?;
        Some((self.files.get(place.file)?, (place.line, place.column)))
    }

    fn place(&self, path: &Path) -> Option<DeckLocation> {
        let key = |k: usize| match path.0.get(k) {
            Some(Step::Key(key)) => key.as_str(),
            _ => "",
        };
        let number = |k: usize| match path.0.get(k) {
            Some(Step::Index(number)) => Some(*number),
            _ => None,
        };
        let of_mesh = key(0) == "nodes" && number(1) == Some(0);
        let exact = match key(2) {
            "nodes" if of_mesh => number(3).and_then(|k| self.nodes.get(k)),
            "elements" if of_mesh => number(3)
                .zip(number(5))
                .and_then(|(list, k)| self.cells.get(list)?.get(k)),
            _ => None,
        };
        let around = || {
            let found = self.others.iter().filter(|(whole, _)| whole.contains(path));
            found
                .max_by_key(|(whole, _)| whole.0.len())
                .map(|(_, place)| place)
        };
        exact.or_else(around).copied()
    }

    fn note(&mut self, path: Path, place: DeckLocation) {
        self.others.push((path, place));
    }
}

/// Names in use: sets, parts, surfaces and bodies of a deck share the names of one mesh.
#[derive(Debug, Default)]
struct UsedNames(HashSet<String>);

impl UsedNames {
    /// A valid, unused name similar to the wanted one; marks it as used.
    fn take(&mut self, wanted: &str) -> String {
        const MOST: usize = 50;
        let plain = |c: char| {
            if c.is_alphanumeric() || c == '-' || c == '_' {
                c
            } else {
                '_'
            }
        };
        let mut base: String = wanted.chars().take(MOST).map(plain).collect();
        if base.chars().all(|c| c.is_ascii_digit()) {
            base.insert_str(0, "set");
        }
        let mut name = base.clone();
        let mut number = 2;
        while !self.0.insert(name.clone()) {
            name = format!("{base}-{number}");
            number += 1;
        }
        name
    }
}

/// Outlines a deck and its include files for the rules that explain failures; solids are read, too.
///
/// # Errors
/// If a file cannot be read, or the deck is not a list of keywords.
pub fn outline(name: &str) -> Result<Deck, SceneError> {
    let path = FilePath::new(name);
    let text = text(path).map_err(|why| SceneError::whole(name, why.to_string()))?;
    let mut include = |wanted: &str| included(path, wanted);
    inp::outline(name, &text, &mut include).map_err(|wrong| unread(name, wrong))
}

/// Reads a deck and its include files, which must be in its folder.
pub(super) fn read(name: &str, text: &str) -> Result<DeckScene, SceneError> {
    let mut include = |wanted: &str| included(FilePath::new(name), wanted);
    let deck = inp::read(name, text, &mut include).map_err(|wrong| unread(name, wrong))?;
    scene(name, &deck).map_err(|fault| SceneError {
        at: Some((fault.place.line, fault.place.column)),
        ..SceneError::whole(&shown(name, deck.file(fault.place)), fault.message)
    })
}

fn unread(name: &str, wrong: DeckError) -> SceneError {
    SceneError {
        at: Some((wrong.place.line, wrong.place.column)),
        ..SceneError::whole(&shown(name, &wrong.file), wrong.message)
    }
}

/// The path of one of a deck's files, relative to the working directory.
fn shown(deck: &str, file: &str) -> String {
    match FilePath::new(deck).parent() {
        Some(folder) if file != deck => folder.join(file).to_string_lossy().into_owned(),
        _ => file.to_owned(),
    }
}

/// The text of an include file.
fn included(deck: &FilePath, wanted: &str) -> Result<String, String> {
    let named = wanted.trim_start_matches("./");
    let quoted = |why: &dyn std::fmt::Display| format!("{}: {why}", error::quoted(wanted));
    let path = input::path_in_folder(deck, named).map_err(|why| quoted(&why))?;
    text(&path).map_err(|why| quoted(&why))
}

/// The text of a deck, decoded as Latin-1 if it is not UTF-8, because comments may be in any language.
///
/// # Errors
/// If it is not a file, too large, or cannot be read.
pub(super) fn text(path: &FilePath) -> Result<String, Unreadable> {
    let bytes = input::bytes(path, DECK_BYTES as u64, "a deck is a list of keywords")?;
    match std::str::from_utf8(&bytes) {
        Ok(_) => input::utf8(bytes),
        Err(_) => Ok(bytes.into_iter().map(char::from).collect()),
    }
}

/// Whether a file has the extension of a deck.
pub(super) fn is_called_so(name: &str) -> bool {
    let extension = FilePath::new(name).extension();
    extension.is_some_and(|extension| extension.eq_ignore_ascii_case("inp"))
}

/// Converts a deck to a scene.
fn scene(name: &str, deck: &Deck) -> Result<DeckScene, Fault> {
    let mut made = DeckObjects::new(name, deck);
    let nlgeom = one_geometry(deck)?;
    made.bodies(nlgeom)?;
    let clock = curves::Clock::from_deck(deck);
    made.loads(&clock)?;
    made.contacts()?;
    made.history(&clock);
    Ok(made.whole(name))
}

/// Whether strains are large; must be the same in all steps.
fn one_geometry(deck: &Deck) -> Result<bool, Fault> {
    let first = deck.steps.first().is_some_and(|step| step.nlgeom);
    match deck.steps.iter().find(|step| step.nlgeom != first) {
        None => Ok(first),
        Some(step) => Err(Fault::new(
            step.place,
            "NLGEOM must be set in all steps or in none: the strain measure cannot change between steps",
        )),
    }
}

/// A scene under construction.
struct DeckObjects<'d> {
    deck: &'d Deck,
    spec: Spec,
    origin: Origin,
    /// Warnings with their locations.
    remarks: Vec<(DeckLocation, String)>,
    free: UsedNames,
    /// The body of each continuum element.
    body_of: Vec<Option<usize>>,
    /// The deck's material of each element.
    material_of: Vec<usize>,
    /// Which nodes belong to an element.
    used: Vec<bool>,
    /// Components of nodes that are restrained or prescribed.
    held: HashSet<(usize, Direction)>,
    /// Which nodes never move in x and in y.
    still: Vec<[bool; 2]>,
}

impl<'d> DeckObjects<'d> {
    fn new(name: &str, deck: &'d Deck) -> Self {
        let file = FilePath::new(name)
            .file_name()
            .map_or_else(|| name.into(), |f| f.to_string_lossy());
        let title = if deck.heading.is_empty() {
            file.as_ref()
        } else {
            &deck.heading
        };
        let used = deck.elements.iter().flat_map(|e| &e.nodes);
        let used = marked(deck.nodes.len(), used);
        let remark = |remark: &inp::deck::Remark| {
            let times = if remark.times > 1 {
                format!(" ({} times)", remark.times)
            } else {
                String::new()
            };
            (remark.place, format!("{}{times}", remark.text))
        };
        DeckObjects {
            spec: Spec {
                title: cut(title, super::limits::TITLE - 3),
                about: format!("Read from the deck {}.", error::shortened(&file)),
                ..Spec::default()
            },
            origin: Origin {
                files: deck.files.iter().map(|file| shown(name, file)).collect(),
                ..Origin::default()
            },
            remarks: deck.remarks.iter().map(remark).collect(),
            free: UsedNames::default(),
            body_of: vec![None; deck.elements.len()],
            material_of: Vec::new(),
            held: HashSet::new(),
            still: vec![[false; 2]; deck.nodes.len()],
            used,
            deck,
        }
    }

    /// Adds a warning about a location.
    fn add_note(&mut self, place: DeckLocation, text: &str) {
        let remark = (place, text.to_owned());
        if self.remarks.last() != Some(&remark) {
            self.remarks.push(remark);
        }
    }

    /// The name of a node in the scene.
    fn node(&self, node: usize) -> String {
        format!("{MESH}.{}", self.deck.nodes[node].label)
    }

    fn whole(self, name: &str) -> DeckScene {
        let mut origin = self.origin;
        origin.note(
            at![],
            DeckLocation {
                file: 0,
                line: 1,
                column: 1,
            },
        );
        debug_assert_eq!(origin.files.first().map(String::as_str), Some(name));
        let mut remarks = self.remarks;
        remarks.sort_by_key(|(place, _)| (place.file, place.line));
        let located = |(place, text): (DeckLocation, String)| {
            let file = origin.files.get(place.file).map_or(name, String::as_str);
            format!("{file}:{}: {text}", place.line)
        };
        DeckScene {
            spec: self.spec,
            remarks: remarks.into_iter().map(located).collect(),
            origin,
        }
    }
}
