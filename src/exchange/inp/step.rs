//! The steps of a deck: increments, supports, loads.

use super::cards::{Card, CardCell, cells, number_or_zero, short};
use super::deck::{Direction, Element, Faces, Family, Pressure, Step, Time, Value, Volume, Weight};
use super::mesh::side_of;
use super::reader::{MeshKind, Reader};
use super::source::{DeckLocation, Done, plain};
use crate::bail;

/// Maximum number of nodes of a printed set that become monitors.
const PRINTED: usize = 20;

impl Reader {
    /// Rejects a deck without steps or with an unfinished step.
    pub(super) fn finish(&self, last: DeckLocation) -> Done {
        match &self.step {
            Some(step) => bail!(step.place, "the step has no end; *END STEP is missing"),
            None if self.deck.steps.is_empty() && !self.is_outline => bail!(
                last,
                "the deck has no step; it needs at least one, with *STEP, *STATIC and *END STEP"
            ),
            None => Ok(()),
        }
    }

    pub(super) fn begin(&mut self, card: &Card<'_>) -> Done {
        if self.step.is_some() {
            bail!(card, "the previous step has no end; *END STEP is missing");
        }
        if card.has("NLGEOM") {
            self.nlgeom = match card.parameter("NLGEOM").and_then(|p| p.value.as_deref()) {
                None => true,
                Some(_) => card.choice("NLGEOM", &["YES", "NO"])? == 0,
            };
        }
        let increments = card
            .value("INC")
            .ok()
            .flatten()
            .and_then(|count| count.parse().ok());
        if card.has("INC") {
            self.deck.add_note(
                card.place_of("INC"),
                "INC is ignored: the number of increments is not limited",
            );
        }
        self.has_time = false;
        self.operations.clear();
        self.step = Some(Step {
            place: card.place,
            static_place: card.place,
            nlgeom: self.nlgeom,
            increments,
            at_once: card.choice("AMPLITUDE", &["RAMP", "STEP"])? == 1,
            ..Step::default()
        });
        Ok(())
    }

    pub(super) fn end(&mut self, card: &Card<'_>) -> Done {
        card.no_lines()?;
        match self.step.take() {
            Some(_) if !self.has_time && !self.is_outline => {
                bail!(card, "the step has no procedure; *STATIC is missing")
            }
            Some(step) => self.deck.steps.push(step),
            None => bail!(card, "*END STEP without a *STEP"),
        }
        Ok(())
    }

    fn in_step(&mut self, card: &Card<'_>) -> Done<&mut Step> {
        let step = self.step.as_mut();
        step.ok_or_else(|| card.wrong("it belongs to a step; *STEP must come first"))
    }

    pub(super) fn time(&mut self, card: &Card<'_>) -> Done {
        for (name, why) in [
            (
                "STABILIZE",
                "STABILIZE adds damping that is not part of the model; leave it out",
            ),
            (
                "TIMERESET",
                "TIME RESET is not supported; time continues over the steps",
            ),
        ] {
            if card.has(name) {
                return Err(card.wrong_at(name, why));
            }
        }
        if card.has("SOLVER") {
            self.deck.add_note(
                card.place_of("SOLVER"),
                "SOLVER is ignored; see settings.solver",
            );
        }
        let words = match card.lines.as_slice() {
            [] => Vec::new(),
            [line] => cells(*line),
            [_, more, ..] => bail!(more, "unexpected line; *STATIC has one data line"),
        };
        let positive = |k: usize, what: &str| -> Done<Option<f64>> {
            let cell = words.get(k).filter(|cell| !cell.text.is_empty());
            let Some(cell) = cell else { return Ok(None) };
            match cell.number(what)? {
                0.0 => Ok(None),
                value if value > 0.0 => Ok(Some(value)),
                value => bail!(cell, "{what} is {value:?}; it must be positive"),
            }
        };
        if let Some(more) = words.get(4) {
            bail!(
                more,
                "unexpected value; *STATIC takes a first increment, a period, a minimum and a maximum increment"
            );
        }
        let period = positive(1, "the period of the step")?.unwrap_or(1.0);
        let initial = positive(0, "the first increment")?.unwrap_or(period);
        if initial > period {
            bail!(
                &words[0],
                "the first increment, {initial:?}, is longer than the step, {period:?}"
            );
        }
        let time = Time {
            initial,
            period,
            least: positive(2, "the minimum increment")?,
            most: positive(3, "the maximum increment")?,
            direct: card.has("DIRECT"),
        };
        if self.has_time {
            bail!(card, "the step already has a *STATIC");
        }
        let step = self.in_step(card)?;
        step.time = time;
        step.static_place = card.lines.first().map_or(card.place, |line| line.place(0));
        self.has_time = true;
        Ok(())
    }

    /// Records the nodes whose displacements are printed; other output is ignored.
    pub(super) fn print(&mut self, card: &Card<'_>) -> Done {
        let Some(name) = card.value("NSET")? else {
            return Ok(());
        };
        let set = self.set_of(name, card.place_of("NSET"), MeshKind::Nodes)?;
        let wanted = card.cells().any(|cell| plain(cell.text) == "U");
        let is_large = self.deck.node_sets[set].members.len() > PRINTED;
        if wanted && is_large {
            self.deck.add_note(
                card.place_of("NSET"),
                "U of a set of more than 20 nodes does not become monitors; name fewer nodes",
            );
        } else if wanted && !self.deck.printed.contains(&set) {
            self.deck.printed.push(set);
        }
        Ok(())
    }

    /// The amplitude named by a card, and whether the card removes earlier values.
    fn course(&mut self, card: &Card<'_>) -> Done<(Option<usize>, bool)> {
        let amplitude = card.value("AMPLITUDE")?.map(|name| {
            let known = self.deck.amplitudes.iter().position(|a| a.name == name);
            known.ok_or_else(|| {
                let what = format!("there is no *AMPLITUDE, NAME={}", short(name));
                card.wrong_at("AMPLITUDE", what)
            })
        });
        let amplitude = amplitude.transpose()?;
        let is_new = card.choice("OP", &["MOD", "NEW"])? == 1;
        if self.step.is_none() {
            return Ok((amplitude, is_new));
        }
        let first = *self.operations.entry(card.key.clone()).or_insert(is_new);
        if first != is_new && !self.is_outline {
            let why = format!(
                "OP must be the same on all *{} cards of a step: CalculiX only reads that of the first one",
                card.shown
            );
            return Err(card.wrong_at("OP", why));
        }
        Ok((amplitude, first))
    }

    pub(super) fn boundary(&mut self, card: &Card<'_>) -> Done {
        card.choice("TYPE", &["DISPLACEMENT"])?;
        if self.step.is_none() && !self.deck.steps.is_empty() && !self.is_outline {
            bail!(
                card,
                "it is outside the steps; it must be in a step, or before the first *STEP"
            );
        }
        let (amplitude, new) = self.course(card)?;
        if let Some(step) = &mut self.step {
            step.new_motions |= new;
        }
        for line in &card.lines {
            let words = cells(*line);
            let Some(first) = words.first() else {
                continue;
            };
            let place = first.place();
            let (numbers, value) = directions(first, &words)?;
            let nodes = self.members_of(first, MeshKind::Nodes)?;
            let last = words.last().unwrap_or(first);
            let mut read = Vec::new();
            for number in numbers {
                match number {
                    _ if self.is_outline => read.push(Direction::from_number(number)),
                    3..=5 if value == 0.0 => self.deck.add_note(
                        place,
                        "directions 3, 4 and 5 are always fixed in plane problems",
                    ),
                    11 => self.deck.add_note(
                        place,
                        "direction 11, the temperature, is ignored: heat flow is not computed",
                    ),
                    3..=5 => bail!(
                        last,
                        "a displacement of {value:?} along direction {number} leaves the plane"
                    ),
                    _ => read.push(Some(direction(words.get(1).unwrap_or(first), number)?)),
                }
            }
            self.names.count(nodes.len() * read.len(), place)?;
            for direction in read.into_iter().flatten() {
                let values = nodes.iter().map(|&node| Value {
                    node,
                    direction,
                    value,
                    amplitude,
                    place,
                });
                match &mut self.step {
                    Some(step) => step.motions.extend(values),
                    None if value != 0.0 => bail!(
                        last,
                        "nonzero values are not allowed before the first step; write this one inside a step"
                    ),
                    None => self.deck.supports.extend(values),
                }
            }
        }
        Ok(())
    }

    pub(super) fn force(&mut self, card: &Card<'_>) -> Done {
        let (amplitude, new) = self.course(card)?;
        self.in_step(card)?.new_forces |= new;
        for line in &card.lines {
            let words = cells(*line);
            let [first, second, third] = words.as_slice() else {
                bail!(
                    line,
                    "a node or a set, a direction and a force were expected"
                );
            };
            let place = first.place();
            let value = third.number("a force")?;
            let direction = match second.whole("a direction")? {
                3 if self.is_outline => Direction::Z,
                3 if value == 0.0 => continue,
                number => direction(second, number)?,
            };
            let nodes = self.members_of(first, MeshKind::Nodes)?;
            self.names.count(nodes.len(), place)?;
            let values = nodes.into_iter().map(|node| Value {
                node,
                direction,
                value,
                amplitude,
                place,
            });
            self.in_step(card)?.forces.extend(values);
        }
        Ok(())
    }

    /// Nodes and temperatures, line by line.
    fn temperatures_of(&mut self, card: &Card<'_>) -> Done<Vec<(usize, f64, DeckLocation)>> {
        let mut read = Vec::new();
        for line in &card.lines {
            let words = cells(*line);
            let [first, second, ..] = words.as_slice() else {
                bail!(line, "a node or a set and a temperature were expected");
            };
            let value = second.number("a temperature")?;
            let nodes = self.members_of(first, MeshKind::Nodes)?;
            self.names.count(nodes.len(), first.place())?;
            read.extend(nodes.into_iter().map(|node| (node, value, first.place())));
        }
        Ok(read)
    }

    pub(super) fn initial(&mut self, card: &Card<'_>) -> Done {
        card.required("TYPE")?;
        card.choice("TYPE", &["TEMPERATURE"])?;
        for (node, value, _) in self.temperatures_of(card)? {
            self.deck.temperatures.insert(node, value);
        }
        Ok(())
    }

    pub(super) fn temperature(&mut self, card: &Card<'_>) -> Done {
        let (amplitude, new) = self.course(card)?;
        let mut values = Vec::new();
        for (node, value, place) in self.temperatures_of(card)? {
            let Some(&initial) = self.deck.temperatures.get(&node) else {
                bail!(
                    card,
                    "node {} has no *INITIAL CONDITIONS, TYPE=TEMPERATURE to expand from",
                    self.deck.nodes[node].label
                );
            };
            if amplitude.is_some() && initial != 0.0 {
                let why = "an amplitude of temperatures needs initial temperatures of 0";
                return Err(card.wrong_at("AMPLITUDE", why));
            }
            values.push(Value {
                node,
                direction: Direction::X,
                value: value - initial,
                amplitude,
                place,
            });
        }
        let step = self.in_step(card)?;
        step.new_temperatures |= new;
        step.temperatures.extend(values);
        Ok(())
    }

    pub(super) fn load(&mut self, card: &Card<'_>) -> Done {
        let (amplitude, new) = self.course(card)?;
        let step = self.in_step(card)?;
        step.new_pressures |= new;
        step.new_weights |= new;
        for line in &card.lines {
            let words = cells(*line);
            let [first, label, rest @ ..] = words.as_slice() else {
                bail!(
                    line,
                    "an element or a set, a load name and its size were expected"
                );
            };
            let place = first.place();
            let elements = self.members_of(first, MeshKind::Elements)?;
            self.names.count(elements.len(), place)?;
            let kind = plain(label.text);
            if let Some(load) = volume(&kind, label, rest, self.is_outline)? {
                let weights = elements.into_iter().map(|element| Weight {
                    element,
                    load,
                    amplitude,
                    place,
                });
                self.in_step(card)?.weights.extend(weights);
                continue;
            }
            for element in elements {
                let pressure = Pressure {
                    element,
                    side: pressed(label, &kind, &self.deck.elements[element])?,
                    value: one(label, rest, "the pressure")?,
                    amplitude,
                    place,
                };
                self.in_step(card)?.pressures.push(pressure);
            }
        }
        Ok(())
    }

    pub(super) fn surface_load(&mut self, card: &Card<'_>) -> Done {
        let (amplitude, new) = self.course(card)?;
        self.in_step(card)?.new_pressures |= new;
        for line in &card.lines {
            let words = cells(*line);
            let [first, label, size] = words.as_slice() else {
                bail!(line, "a surface, P and a pressure were expected");
            };
            if plain(label.text) != "P" {
                bail!(
                    label,
                    "the load {:?} is not supported; it must be P, a pressure",
                    short(label.text)
                );
            }
            let (place, surface) = (first.place(), self.surface_of(first)?);
            let Faces::Elements(sides) = &self.deck.surfaces[surface].of else {
                bail!(
                    first,
                    "a surface of nodes has no area for a pressure; use one of sides (TYPE=ELEMENT)"
                );
            };
            let value = size.number("the pressure")?;
            self.names.count(sides.len(), place)?;
            let pressures = sides.clone().into_iter().map(|(element, side)| Pressure {
                element,
                side,
                value,
                amplitude,
                place,
            });
            self.in_step(card)?.pressures.extend(pressures);
        }
        Ok(())
    }
}

/// A direction in the plane, by its number.
fn direction(cell: &CardCell<'_>, number: u64) -> Done<Direction> {
    match Direction::from_number(number) {
        Some(direction) if direction != Direction::Z => Ok(direction),
        _ => bail!(
            cell,
            "direction {number} is not supported; it must be 1 or 2, or 6 on beams"
        ),
    }
}

/// The directions of a line of `*BOUNDARY`, and its value.
fn directions(first: &CardCell<'_>, words: &[CardCell<'_>]) -> Done<(Vec<u64>, f64)> {
    let Some(second) = words.get(1) else {
        bail!(
            first,
            "the restrained directions are missing after the node or set"
        );
    };
    // Abaqus' names for supports; symmetry conditions fix the direction normal to the symmetry plane, and the rotations about the
    // other two, of which only the one about z is not fixed in plane problems anyway.
    let named: Option<&[u64]> = match plain(second.text).as_str() {
        "XSYMM" => Some(&[1, 6]),
        "YSYMM" => Some(&[2, 6]),
        "ZSYMM" => Some(&[3]),
        "PINNED" => Some(&[1, 2]),
        "ENCASTRE" => Some(&[1, 2, 3, 4, 5, 6]),
        _ => None,
    };
    if let Some(named) = named {
        return Ok((named.to_vec(), 0.0));
    }
    let from = second.whole("a direction")?;
    let to = match words.get(2).filter(|cell| !cell.text.is_empty()) {
        Some(cell) => cell.whole("the last direction")?,
        None => from,
    };
    if to < from || from == 0 || to > 11 {
        bail!(
            second,
            "directions {from} to {to}; they must be ascending, from 1 to 6"
        );
    }
    if let Some(more) = words.get(4) {
        bail!(
            more,
            "unexpected value; the line takes a node, the first and the last direction and a value"
        );
    }
    let value = number_or_zero(words, 3, "the value")?;
    Ok(((from..=to).collect(), value))
}

/// The side that a load of `*DLOAD` acts on.
fn pressed(label: &CardCell<'_>, kind: &str, element: &Element) -> Done<usize> {
    let digits = kind.strip_prefix('P').unwrap_or_default();
    let numbered = !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit());
    if numbered && element.kind.family != Family::Beam {
        side_of(label, 'P', element)
    } else {
        bail!(
            label,
            "the load {} is not supported on element {}; supported are P1 to P4 on sides, GRAV, BX and BY",
            short(kind),
            element.label
        )
    }
}

/// The only remaining number of a line.
fn one(before: &CardCell<'_>, rest: &[CardCell<'_>], what: &str) -> Done<f64> {
    match rest {
        [cell] => cell.number(what),
        [] => bail!(before, "{what} is missing"),
        [_, more, ..] => bail!(more, "unexpected value; {what} is one number"),
    }
}

fn volume(
    kind: &str,
    label: &CardCell<'_>,
    rest: &[CardCell<'_>],
    solids: bool,
) -> Done<Option<Volume>> {
    let force = || one(label, rest, "the force per volume");
    let along = |axis: usize, value: f64| Volume::Force { axis, value };
    Ok(Some(match kind {
        "BX" => along(0, force()?),
        "BY" => along(1, force()?),
        "BZ" if solids => along(2, force()?),
        "GRAV" => {
            let [size, x, y, z @ ..] = rest else {
                bail!(
                    label,
                    "an acceleration and the three components of its direction were expected"
                );
            };
            let size = size.number("the acceleration")?;
            let (x, y) = (x.number("a direction")?, y.number("a direction")?);
            let z = number_or_zero(z, 0, "a direction")?;
            let length = x.hypot(y).hypot(z);
            if (z != 0.0 && !solids) || length == 0.0 || !length.is_finite() {
                bail!(
                    label,
                    "the direction of the acceleration must lie in the plane and not be zero"
                );
            }
            Volume::Gravity {
                acceleration: [x, y, z].map(|part| size * part / length),
                direction: [x, y, z].map(|part| part / length),
            }
        }
        _ => return Ok(None),
    }))
}
