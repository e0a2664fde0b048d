//! Parts and instances, as Abaqus/CAE writes them: an instance repeats the cards of its part with its own numbers, names and
//! position.
//!
//! Names get the instance's name and a dot in front, as other cards refer to them (`PART-1-1.TOP`). A single instance keeps the
//! numbers of its part, unless the assembly has one of them, too; of several, the k-th adds k B to them, where B is the smallest
//! power of ten above all numbers.

use super::cards::{Card, cells, number_or_zero, short};
use super::source::{Done, SourceLine};
use crate::bail;
use std::collections::{BTreeMap, BTreeSet};

/// The instance that a card belongs to; the default belongs to none.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Instance {
    /// Its name with a dot.
    pub prefix: String,
    /// Offset of the numbers of its nodes and elements.
    pub first: u64,
    shift: [f64; 3],
    /// A point of the axis of rotation, and the angle (radians).
    about: [f64; 2],
    angle: f64,
}

impl Instance {
    /// The position of a node of its part.
    pub fn place(&self, at: [f64; 3]) -> [f64; 3] {
        if *self == Instance::default() {
            return at;
        }
        let [x, y, z] = [0, 1, 2].map(|k| at[k] + self.shift[k]);
        let (sin, cos) = self.angle.sin_cos();
        let [a, b] = [x - self.about[0], y - self.about[1]];
        match self.angle {
            0.0 => [x, y, z],
            _ => [
                self.about[0] + cos * a - sin * b,
                self.about[1] + sin * a + cos * b,
                z,
            ],
        }
    }
}

/// The cards of a deck in reading order, each with the number of its instance; and the instances, of which number 0 is none.
pub(super) struct Assembled<'c, 't> {
    pub cards: Vec<(&'c Card<'t>, usize)>,
    pub instances: Vec<Instance>,
}

/// Replaces parts by their instances.
pub(super) fn assemble<'c, 't>(cards: &'c [Card<'t>]) -> Done<Assembled<'c, 't>> {
    let mut found = Assembled {
        cards: Vec::with_capacity(cards.len()),
        instances: vec![Instance::default()],
    };
    let mut parts: BTreeMap<&str, &[Card<'t>]> = BTreeMap::new();
    let count = cards.iter().filter(|card| card.key == "INSTANCE").count();
    let is_offset = count > 1 || (count == 1 && has_common_numbers(cards));
    let mut rest = cards;
    while let Some((card, after)) = rest.split_first() {
        rest = after;
        match card.key.as_str() {
            "PART" => {
                card.only(&["NAME"])?;
                let body;
                (body, rest) = until("ENDPART", card, after)?;
                if parts.insert(card.required("NAME")?, body).is_some() {
                    return Err(card.wrong("the part is defined twice"));
                }
            }
            "INSTANCE" => {
                let own;
                (own, rest) = until("ENDINSTANCE", card, after)?;
                card.only(&["NAME", "PART"])?;
                let (name, part) = (card.required("NAME")?, card.required("PART")?);
                let Some(body) = parts.get(part) else {
                    let why = format!("there is no *PART, NAME={} before it", short(part));
                    return Err(card.wrong_at("PART", why));
                };
                let known = &found.instances;
                if known
                    .iter()
                    .any(|own| own.prefix.strip_suffix('.') == Some(name))
                {
                    return Err(card.wrong("the instance is defined twice"));
                }
                let number = found.instances.len();
                let mut instance = instance(name, &card.lines)?;
                instance.first = if is_offset {
                    number as u64 * above(cards)
                } else {
                    0
                };
                found.instances.push(instance);
                found
                    .cards
                    .extend(body.iter().chain(own).map(|card| (card, number)));
            }
            "ASSEMBLY" | "ENDASSEMBLY" => {}
            _ => found.cards.push((card, 0)),
        }
    }
    Ok(found)
}

/// The cards before the one that ends a part or an instance, and those after it.
fn until<'c, 't>(
    end: &str,
    begin: &Card<'t>,
    cards: &'c [Card<'t>],
) -> Done<(&'c [Card<'t>], &'c [Card<'t>])> {
    let Some(place) = cards.iter().position(|card| card.key == end) else {
        return Err(begin.wrong("its end is missing"));
    };
    let (body, rest) = cards.split_at(place);
    Ok((body, rest.get(1..).unwrap_or_default()))
}

/// Whether a node or an element outside parts and instances has the number of one inside.
fn has_common_numbers(cards: &[Card<'_>]) -> bool {
    let mut numbers = [BTreeSet::new(), BTreeSet::new()];
    let mut is_inside = false;
    for card in cards {
        match card.key.as_str() {
            "PART" | "INSTANCE" => is_inside = true,
            "ENDPART" | "ENDINSTANCE" => is_inside = false,
            "NODE" | "ELEMENT" => {
                let first = card.lines.iter().filter_map(|line| number(*line));
                numbers[usize::from(is_inside)].extend(first.map(|number| (&card.key, number)));
            }
            _ => {}
        }
    }
    let [outside, inside] = numbers;
    !outside.is_disjoint(&inside)
}

/// The number at the beginning of a line.
fn number(line: SourceLine<'_>) -> Option<u64> {
    cells(line).first()?.text.parse().ok()
}

/// The smallest power of ten above the numbers of all nodes and elements.
fn above(cards: &[Card<'_>]) -> u64 {
    let numbers = cards
        .iter()
        .filter(|card| card.key == "NODE" || card.key == "ELEMENT")
        .flat_map(|card| &card.lines)
        .filter_map(|line| number(*line));
    let digits = numbers.max().unwrap_or(0).max(1).ilog10() + 1;
    10_u64.checked_pow(digits).unwrap_or(u64::MAX)
}

/// An instance with the translation and the rotation of its data lines.
fn instance(name: &str, lines: &[SourceLine<'_>]) -> Done<Instance> {
    let mut made = Instance {
        prefix: format!("{name}."),
        ..Instance::default()
    };
    let numbers = |line: &SourceLine<'_>, count: usize| -> Done<Vec<f64>> {
        let words = cells(*line);
        (0..count)
            .map(|k| number_or_zero(&words, k, "a coordinate or an angle"))
            .collect()
    };
    if let Some(line) = lines.first() {
        let shift = numbers(line, 3)?;
        made.shift.copy_from_slice(&shift);
    }
    if let Some(line) = lines.get(1) {
        let [ax, ay, az, bx, by, bz, degrees] = numbers(line, 7)?[..] else {
            bail!(line, "two points of an axis and an angle were expected");
        };
        if (ax, ay) != (bx, by) || az == bz {
            bail!(
                line,
                "the axis of rotation must be perpendicular to the plane"
            );
        }
        made.about = [ax, ay];
        made.angle = (bz - az).signum() * degrees.to_radians();
    }
    match lines.get(2) {
        Some(more) => bail!(
            more,
            "unexpected line; an instance has a translation and a rotation"
        ),
        None => Ok(made),
    }
}
