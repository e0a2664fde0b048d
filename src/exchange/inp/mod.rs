//! Plane CalculiX and Abaqus decks (`.inp`): a list of keywords with data.
//!
//! - `source`: lines, including those of included files, and locations; `cards`: keywords with their parameters and data.
//! - [`keywords`]: treatment of each keyword.
//! - [`deck`]: the contents of a deck, read keyword by keyword into the state of `reader` in `mesh`, `property` and `step`.
//!
//! Keywords have the meaning of CalculiX ("CalculiX CrunchiX user's manual", G. Dhondt), which follows Abaqus. Nodes, elements,
//! sets and surfaces are read first, then materials and laws, then the cards that use them; the order of cards only matters
//! within these groups.

pub mod deck;
pub mod keywords;

mod assembly;
mod cards;
mod mesh;
mod property;
mod reader;
mod source;
mod step;
#[cfg(test)]
mod tests;

use crate::bail;
use cards::Card;
pub use deck::Deck;
use deck::{Faces, Remark, Value};
use keywords::{Pass, Reading, Treatment, nearest, treatment};
use reader::Reader;
pub use source::{DECK_BYTES, DeckError, DeckLocation, Fault, Include};
use source::{Done, Sources};
use std::collections::{BTreeSet, HashMap};

/// Whether a text could be a deck: its first line that is neither blank nor a comment begins with a star.
pub fn is_one(text: &str) -> bool {
    let lines = text.lines().enumerate();
    let mut lines = lines.map(|(k, text)| source::SourceLine {
        text,
        file: 0,
        number: k + 1,
    });
    let comments = text.trim_start().starts_with("**");
    match lines.find(|line| !line.is_nothing()) {
        Some(line) => line.is_keyword(),
        None => comments,
    }
}

/// Reads a deck. `include` returns the text of an include file by name, or the reason for a failure.
///
/// # Errors
/// The first error or unsupported input, with what is expected.
pub fn read(name: &str, text: &str, include: &mut Include<'_>) -> Result<Deck, DeckError> {
    deck(name, text, include, false)
}

/// Outlines a deck for the rules that explain why it fails: reads three-dimensional elements too, and skips what it cannot read.
///
/// # Errors
/// If the text is not a list of keywords, its nodes or elements have errors, or an include file is missing.
pub fn outline(name: &str, text: &str, include: &mut Include<'_>) -> Result<Deck, DeckError> {
    deck(name, text, include, true)
}

fn deck(
    name: &str,
    text: &str,
    include: &mut Include<'_>,
    is_outline: bool,
) -> Result<Deck, DeckError> {
    let (sources, gathered) = Sources::gather(name, text, include);
    let deck = gathered.and_then(|()| whole(&sources, is_outline));
    deck.map_err(|fault| DeckError {
        file: sources
            .names
            .get(fault.place.file)
            .cloned()
            .unwrap_or_default(),
        place: fault.place,
        message: fault.message,
    })
}

fn whole(sources: &Sources, is_outline: bool) -> Done<Deck> {
    let cards = cards::cards(sources.lines())?;
    let assembly::Assembled { cards, instances } = assembly::assemble(&cards)?;
    let mut reader = Reader {
        is_outline,
        ..Reader::default()
    };
    reader.deck.files = sources.names.clone();
    reader.names.instances.clone_from(&instances);
    let mut readings = Vec::with_capacity(cards.len());
    for (card, _) in &cards {
        readings.push(reader.check_keyword(card)?);
    }
    for passes in [&[Pass::Mesh][..], &[Pass::Laws], &[Pass::Model, Pass::Step]] {
        for (&(card, instance), reading) in cards.iter().zip(&readings) {
            let Some(reading) = reading.filter(|own| passes.contains(&own.pass)) else {
                continue;
            };
            reader.names.within.clone_from(&instances[instance]);
            if is_outline {
                match (reading.read)(&mut reader, card) {
                    Ok(()) => {}
                    Err(fault) if is_mesh(card) => return Err(fault),
                    Err(fault) => {
                        reader.deck.has_faults = true;
                        reader.skip(card, &fault.message);
                    }
                }
                continue;
            }
            card.only(reading.parameters)?;
            (reading.read)(&mut reader, card)?;
            let in_steps = reader.step.is_some() || !reader.deck.steps.is_empty();
            if reading.pass == Pass::Model && in_steps {
                bail!(
                    card,
                    "it belongs to the model and must come before the first *STEP"
                );
            }
        }
    }
    let start = DeckLocation {
        file: 0,
        line: 1,
        column: 1,
    };
    reader.finish(cards.last().map_or(start, |(card, _)| card.place))?;
    let mut deck = reader.deck;
    if is_outline {
        // Notes on how the plane solver reads the deck do not apply.
        deck.remarks = reader.skipped;
    }
    deck.remarks
        .sort_by_key(|remark| (remark.place.file, remark.place.line));
    Ok(deck)
}

/// Whether a card has nodes, or elements of a known type, to which the other cards refer.
fn is_mesh(card: &Card<'_>) -> bool {
    match card.key.as_str() {
        "NODE" => true,
        "ELEMENT" => mesh::element_type(card, true).is_ok(),
        _ => false,
    }
}

impl Reader {
    /// Rejects unsupported keywords, and adds warnings about ignored ones.
    fn check_keyword(&mut self, card: &Card<'_>) -> Done<Option<Reading>> {
        match card.key.as_str() {
            _ if self.is_outline => {}
            "ELEMENT" => drop(mesh::element_type(card, false)?),
            _ => {}
        }
        match treatment(&card.key) {
            None | Some(Treatment::Refused(_)) if self.is_outline => {
                let reading = keywords::outlined(&card.key);
                if reading.is_none() {
                    self.skip(card, "it is not considered");
                }
                Ok(reading)
            }
            Some(Treatment::Refused(why)) => bail!(card, "{why}"),
            None => {
                let like = nearest(&card.key)
                    .map(|name| format!("; did you mean *{name}?"))
                    .unwrap_or_default();
                bail!(card, "it is not a supported keyword{like}")
            }
            Some(Treatment::Read(_, reading)) => Ok(reading),
            Some(Treatment::Ignored(why)) => {
                let what = format!("*{} is ignored: {why}", card.shown);
                self.deck.add_note(card.place, what);
                Ok(None)
            }
        }
    }

    /// Skips a card of an outline.
    fn skip(&mut self, card: &Card<'_>, why: &str) {
        self.deck.is_incomplete |= keywords::COUPLING.contains(&card.key.as_str());
        self.skipped.push(Remark {
            place: card.place,
            text: format!("*{} is skipped: {why}", card.shown),
            times: 1,
        });
    }

    fn heading(&mut self, card: &Card<'_>) -> Done {
        let lines: Vec<&str> = card.lines.iter().map(|line| line.text.trim()).collect();
        self.deck.heading = lines.join(" ");
        Ok(())
    }
}

impl Deck {
    fn add_note(&mut self, place: DeckLocation, text: impl Into<String>) {
        let text = text.into();
        match self.remarks.iter_mut().find(|remark| remark.text == text) {
            Some(remark) => remark.times += 1,
            None => self.remarks.push(Remark {
                place,
                text,
                times: 1,
            }),
        }
    }

    /// The name of the file of a location.
    pub fn file(&self, place: DeckLocation) -> &str {
        self.files.get(place.file).map_or("", String::as_str)
    }

    /// The index of each node, by its number.
    pub fn labels(&self) -> HashMap<u64, usize> {
        let labels = self.nodes.iter().map(|node| node.label);
        labels.zip(0..).collect()
    }

    /// The nodes of a side of a plane element, anticlockwise around it: start, end, and the midside node between them, if any.
    pub fn side(&self, element: usize, side: usize) -> Vec<usize> {
        let element = &self.elements[element];
        let corners = element.kind.cell.corners();
        let mut nodes = vec![element.nodes[side]];
        nodes.extend(element.nodes.get(corners + side));
        nodes.push(element.nodes[(side + 1) % corners]);
        nodes
    }

    /// The nodes of a side of a plane element or of a face of a solid: the corners in order, then the midside nodes. Empty if the
    /// element has no such side.
    pub fn face(&self, element: usize, side: usize) -> (Vec<usize>, Vec<usize>) {
        let element = &self.elements[element];
        let cell = element.kind.cell;
        let sides = cell.sides();
        let of = sides.get(side).copied().unwrap_or_default();
        let corners = of.iter().map(|&k| element.nodes[k]).collect();
        let edges = cell.edges().iter().enumerate();
        let on_it = edges.filter(|(_, edge)| edge.iter().all(|end| of.contains(end)));
        let middles = on_it.filter_map(|(k, _)| element.nodes.get(cell.corners() + k).copied());
        (corners, middles.collect())
    }

    /// The nodes of a surface, midside nodes included.
    pub fn surface_nodes(&self, surface: usize) -> BTreeSet<usize> {
        match &self.surfaces[surface].of {
            Faces::Nodes(nodes) => nodes.iter().copied().collect(),
            Faces::Elements(sides) => {
                let of = sides.iter().map(|&(e, side)| self.face(e, side));
                of.flat_map(|(corners, middles)| [corners, middles].concat())
                    .collect()
            }
        }
    }

    /// Whether the deck has three-dimensional elements.
    pub fn is_solid(&self) -> bool {
        let mut families = self.elements.iter().map(|element| element.kind.family);
        families.any(|family| family == deck::Family::Solid)
    }
}

impl Value {
    /// The component and node that it applies to.
    pub fn target(&self) -> (usize, deck::Direction) {
        (self.node, self.direction)
    }
}
