//! The steps of a deck: increments, supports, loads.

use super::cards::{Card, CardCell, cells, number_or_zero, short};
use super::deck::{
    Deck, Direction, Element, Faces, Family, Pressure, Step, Time, Value, Volume, Weight,
};
use super::mesh::{MeshKind, Names, members_of, set_of, side_of, surface_of};
use super::source::{Fault, Place, SourceLine, plain};
use crate::bail;

/// State of reading the steps.
#[derive(Debug, Default)]
pub(super) struct OpenStep {
    step: Option<Step>,
    has_time: bool,
    /// NLGEOM stays on in later steps until it is switched off.
    nlgeom: bool,
}

/// Reads a card of a step, or a support of the model; returns whether it is one.
pub(super) fn read(
    card: &Card<'_>,
    deck: &mut Deck,
    names: &mut Names,
    open: &mut OpenStep,
) -> Result<bool, Fault> {
    match card.key.as_str() {
        "STEP" => begin(card, deck, open)?,
        "ENDSTEP" => end(card, deck, open)?,
        "STATIC" => time(card, deck, open)?,
        "BOUNDARY" => boundary(card, deck, names, open)?,
        "CLOAD" => force(card, deck, names, open)?,
        "DLOAD" => load(card, deck, names, open)?,
        "NODEPRINT" => print(card, deck, names)?,
        "DSLOAD" => surface_load(card, deck, names, open)?,
        _ => return Ok(false),
    }
    Ok(true)
}

/// Rejects a deck without steps or with an unfinished step.
pub(super) fn finish(deck: &Deck, open: &OpenStep, last: Place) -> Result<(), Fault> {
    match &open.step {
        Some(step) => Err(Fault::new(
            step.place,
            "the step has no end; *END STEP is missing",
        )),
        None if deck.steps.is_empty() => Err(Fault::new(
            last,
            "the deck has no step; it needs at least one, with *STEP, *STATIC and *END STEP",
        )),
        None => Ok(()),
    }
}

/// Rejects model definitions after the first step.
pub(super) fn before(card: &Card<'_>, open: &OpenStep) -> Result<(), Fault> {
    match open.step {
        None => Ok(()),
        Some(_) => Err(card.wrong("it belongs to the model and must come before the first *STEP")),
    }
}

fn begin(card: &Card<'_>, deck: &mut Deck, open: &mut OpenStep) -> Result<(), Fault> {
    card.only(&[
        "NLGEOM",
        "INC",
        "AMPLITUDE",
        "NAME",
        "UNSYMM",
        "INCF",
        "INCF1",
    ])?;
    if open.step.is_some() {
        return Err(card.wrong("the previous step has no end; *END STEP is missing"));
    }
    if card.has("NLGEOM") {
        open.nlgeom = match card.parameter("NLGEOM").and_then(|p| p.value.as_deref()) {
            None => true,
            Some(_) => card.choice("NLGEOM", &["YES", "NO"])? == 0,
        };
    }
    if card.has("INC") {
        deck.remark(
            card.place_of("INC"),
            "INC is ignored: the number of increments is not limited",
        );
    }
    open.has_time = false;
    open.step = Some(Step {
        place: card.place,
        static_place: card.place,
        nlgeom: open.nlgeom,
        at_once: card.choice("AMPLITUDE", &["RAMP", "STEP"])? == 1,
        time: Time {
            initial: 1.0,
            period: 1.0,
            least: None,
            most: None,
            direct: false,
        },
        ..Step::default()
    });
    Ok(())
}

fn end(card: &Card<'_>, deck: &mut Deck, open: &mut OpenStep) -> Result<(), Fault> {
    card.only(&[])?;
    card.no_lines()?;
    match open.step.take() {
        Some(_) if !open.has_time => {
            Err(card.wrong("the step has no procedure; *STATIC is missing"))
        }
        Some(step) => {
            deck.steps.push(step);
            Ok(())
        }
        None => Err(card.wrong("*END STEP without a *STEP")),
    }
}

fn in_step<'a>(card: &Card<'_>, open: &'a mut OpenStep) -> Result<&'a mut Step, Fault> {
    open.step
        .as_mut()
        .ok_or_else(|| card.wrong("it belongs to a step; *STEP must come first"))
}

fn time(card: &Card<'_>, deck: &mut Deck, open: &mut OpenStep) -> Result<(), Fault> {
    card.only(&["DIRECT", "SOLVER", "TIMERESET", "STABILIZE"])?;
    if card.has("STABILIZE") {
        bail!(
            card.place_of("STABILIZE"),
            "*STATIC: STABILIZE adds damping that is not part of the model; leave it out"
        );
    }
    if card.has("TIMERESET") {
        bail!(
            card.place_of("TIMERESET"),
            "*STATIC: TIME RESET is not supported; time continues over the steps"
        );
    }
    if card.has("SOLVER") {
        deck.remark(
            card.place_of("SOLVER"),
            "SOLVER is ignored; see settings.solver",
        );
    }
    let words = match card.lines.as_slice() {
        [] => Vec::new(),
        [line] => cells(*line),
        [_, more, ..] => {
            bail!(more.place(0), "unexpected line; *STATIC has one data line");
        }
    };
    let positive = |k: usize, what: &str| match words.get(k).filter(|cell| !cell.text.is_empty()) {
        None => Ok(None),
        Some(cell) => match cell.number(what)? {
            0.0 => Ok(None),
            value if value > 0.0 => Ok(Some(value)),
            value => Err(cell.wrong(format!("{what} is {value:?}; it must be positive"))),
        },
    };
    if let Some(more) = words.get(4) {
        return Err(more.wrong("unexpected value; *STATIC takes a first increment, a period, a minimum and a maximum increment"));
    }
    let period = positive(1, "the period of the step")?.unwrap_or(1.0);
    let initial = positive(0, "the first increment")?.unwrap_or(period);
    if initial > period {
        return Err(words[0].wrong(format!(
            "the first increment, {initial:?}, is longer than the step, {period:?}"
        )));
    }
    let time = Time {
        initial,
        period,
        least: positive(2, "the minimum increment")?,
        most: positive(3, "the maximum increment")?,
        direct: card.has("DIRECT"),
    };
    let place = card.lines.first().map_or(card.place, |line| line.place(0));
    if open.has_time {
        return Err(card.wrong("the step already has a *STATIC"));
    }
    let step = in_step(card, open)?;
    step.time = time;
    step.static_place = place;
    open.has_time = true;
    Ok(())
}

/// Records the nodes whose displacements are printed; other output is ignored.
fn print(card: &Card<'_>, deck: &mut Deck, names: &Names) -> Result<(), Fault> {
    let Some(name) = card.value("NSET")? else {
        return Ok(());
    };
    let set = set_of(name, card.place_of("NSET"), names, MeshKind::Nodes)?;
    let wanted = card.cells().any(|cell| plain(cell.text) == "U");
    if wanted && !deck.printed.contains(&set) {
        deck.printed.push(set);
    }
    Ok(())
}

/// The amplitude named by a card.
fn amplitude(card: &Card<'_>, deck: &Deck) -> Result<Option<usize>, Fault> {
    let Some(name) = card.value("AMPLITUDE")? else {
        return Ok(None);
    };
    let known = deck.amplitudes.iter().position(|a| a.name == name);
    known.map(Some).ok_or_else(|| {
        Fault::new(
            card.place_of("AMPLITUDE"),
            format!("there is no *AMPLITUDE, NAME={}", short(name)),
        )
    })
}

/// Whether a card removes earlier values.
fn is_new(card: &Card<'_>) -> Result<bool, Fault> {
    Ok(card.choice("OP", &["MOD", "NEW"])? == 1)
}

fn boundary(
    card: &Card<'_>,
    deck: &mut Deck,
    names: &mut Names,
    open: &mut OpenStep,
) -> Result<(), Fault> {
    card.only(&["OP", "AMPLITUDE", "TYPE"])?;
    card.choice("TYPE", &["DISPLACEMENT"])?;
    let amplitude = amplitude(card, deck)?;
    let new = is_new(card)?;
    if let Some(step) = &mut open.step {
        step.new_motions |= new;
    }
    for line in &card.lines {
        let words = cells(*line);
        let Some(first) = words.first() else {
            continue;
        };
        let (from, to, value) = directions(first, &words)?;
        let nodes = members_of(first, deck, names, MeshKind::Nodes)?;
        let last = words.last().unwrap_or(first);
        let mut read = Vec::new();
        for direction in from..=to {
            let held = match direction {
                1 => Direction::X,
                2 => Direction::Y,
                6 => Direction::Rotation,
                3..=5 if value == 0.0 => {
                    deck.remark(
                        first.place(),
                        "directions 3, 4 and 5 are always fixed in plane problems",
                    );
                    continue;
                }
                3..=5 => {
                    return Err(last.wrong(format!(
                        "a displacement of {value:?} along direction {direction} leaves the plane"
                    )));
                }
                _ => {
                    return Err(words.get(1).unwrap_or(first).wrong(format!(
                        "direction {direction} is not supported; it must be 1 or 2, or 6 on beams"
                    )));
                }
            };
            read.push(held);
        }
        names.count(nodes.len() * read.len(), first.place())?;
        for direction in read {
            let values = nodes.iter().map(|&node| Value {
                node,
                direction,
                value,
                amplitude,
                place: first.place(),
            });
            match &mut open.step {
                Some(step) => step.motions.extend(values),
                None if value != 0.0 => {
                    return Err(last.wrong(
                        "nonzero values are not allowed before the first step; write this one inside a step",
                    ));
                }
                None => deck.supports.extend(values),
            }
        }
    }
    Ok(())
}

/// First and last direction of a line of `*BOUNDARY`, and its value.
fn directions(first: &CardCell<'_>, words: &[CardCell<'_>]) -> Result<(u64, u64, f64), Fault> {
    let Some(second) = words.get(1) else {
        return Err(first.wrong("the restrained directions are missing after the node or set"));
    };
    // Abaqus' names for supports; symmetry conditions fix the direction normal to the symmetry plane.
    match plain(second.text).as_str() {
        "XSYMM" => return Ok((1, 1, 0.0)),
        "YSYMM" => return Ok((2, 2, 0.0)),
        "ZSYMM" => return Ok((3, 3, 0.0)),
        "PINNED" => return Ok((1, 2, 0.0)),
        "ENCASTRE" => return Ok((1, 6, 0.0)),
        _ => {}
    }
    let from = second.whole("a direction")?;
    let to = match words.get(2).filter(|cell| !cell.text.is_empty()) {
        Some(cell) => cell.whole("the last direction")?,
        None => from,
    };
    if to < from || from == 0 || to > 11 {
        return Err(second.wrong(format!(
            "directions {from} to {to}; they must be ascending, from 1 to 6"
        )));
    }
    if let Some(more) = words.get(4) {
        return Err(more.wrong(
            "unexpected value; the line takes a node, the first and the last direction and a value",
        ));
    }
    Ok((from, to, number_or_zero(words, 3, "the value")?))
}

fn force(
    card: &Card<'_>,
    deck: &mut Deck,
    names: &mut Names,
    open: &mut OpenStep,
) -> Result<(), Fault> {
    card.only(&["OP", "AMPLITUDE"])?;
    let amplitude = amplitude(card, deck)?;
    let new = is_new(card)?;
    let step = in_step(card, open)?;
    step.new_forces |= new;
    for line in &card.lines {
        let words = cells(*line);
        let [first, second, third] = words.as_slice() else {
            bail!(
                line.place(0),
                "a node or a set, a direction and a force were expected"
            );
        };
        let value = third.number("a force")?;
        let direction = match second.whole("a direction")? {
            1 => Direction::X,
            2 => Direction::Y,
            6 => Direction::Rotation,
            3 if value == 0.0 => continue,
            other => {
                return Err(second.wrong(format!(
                    "direction {other} is not supported; it must be 1 or 2, or 6 on beams"
                )));
            }
        };
        let nodes = members_of(first, deck, names, MeshKind::Nodes)?;
        names.count(nodes.len(), first.place())?;
        step.forces.extend(nodes.into_iter().map(|node| Value {
            node,
            direction,
            value,
            amplitude,
            place: first.place(),
        }));
    }
    Ok(())
}

fn load(
    card: &Card<'_>,
    deck: &mut Deck,
    names: &mut Names,
    open: &mut OpenStep,
) -> Result<(), Fault> {
    card.only(&["OP", "AMPLITUDE"])?;
    let amplitude = amplitude(card, deck)?;
    let new = is_new(card)?;
    let step = in_step(card, open)?;
    step.new_pressures |= new;
    for line in &card.lines {
        let words = cells(*line);
        let [first, label, rest @ ..] = words.as_slice() else {
            bail!(
                line.place(0),
                "an element or a set, a load name and its size were expected"
            );
        };
        let elements = members_of(first, deck, names, MeshKind::Elements)?;
        names.count(elements.len(), first.place())?;
        let kind = plain(label.text);
        let volume = volume(&kind, label, rest)?;
        for element in elements {
            match volume {
                Some(load) => step.weights.push(Weight {
                    element,
                    load,
                    amplitude,
                    place: first.place(),
                }),
                None => step.pressures.push(Pressure {
                    element,
                    side: pressed(label, &kind, &deck.elements[element])?,
                    value: one(label, rest, "the pressure")?,
                    amplitude,
                    place: first.place(),
                }),
            }
        }
    }
    Ok(())
}

/// The side that a load of `*DLOAD` acts on.
fn pressed(label: &CardCell<'_>, kind: &str, element: &Element) -> Result<usize, Fault> {
    let digits = kind.strip_prefix('P').unwrap_or_default();
    let numbered = !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit());
    match numbered && element.kind.family != Family::Beam {
        true => side_of(label, 'P', element),
        false => Err(label.wrong(format!(
            "the load {} is not supported on element {}; supported are P1 to P4 on sides, GRAV, BX and BY",
            short(kind),
            element.label
        ))),
    }
}

/// The only remaining number of a line.
fn one(before: &CardCell<'_>, rest: &[CardCell<'_>], what: &str) -> Result<f64, Fault> {
    match rest {
        [cell] => cell.number(what),
        [] => Err(before.wrong(format!("{what} is missing"))),
        [_, more, ..] => Err(more.wrong(format!("unexpected value; {what} is one number"))),
    }
}

fn volume(
    kind: &str,
    label: &CardCell<'_>,
    rest: &[CardCell<'_>],
) -> Result<Option<Volume>, Fault> {
    match kind {
        "BX" => Ok(Some(Volume::Force([
            one(label, rest, "the force per volume")?,
            0.0,
        ]))),
        "BY" => Ok(Some(Volume::Force([
            0.0,
            one(label, rest, "the force per volume")?,
        ]))),
        "GRAV" => {
            let [size, x, y, z @ ..] = rest else {
                return Err(label.wrong(
                    "an acceleration and the three components of its direction were expected",
                ));
            };
            let size = size.number("the acceleration")?;
            let (x, y) = (x.number("a direction")?, y.number("a direction")?);
            let z = number_or_zero(z, 0, "a direction")?;
            let length = x.hypot(y);
            if z != 0.0 || length == 0.0 || !length.is_finite() {
                return Err(label.wrong(
                    "the direction of the acceleration must lie in the plane and not be zero",
                ));
            }
            Ok(Some(Volume::Gravity([
                size * x / length,
                size * y / length,
            ])))
        }
        _ => Ok(None),
    }
}

fn surface_load(
    card: &Card<'_>,
    deck: &mut Deck,
    names: &mut Names,
    open: &mut OpenStep,
) -> Result<(), Fault> {
    card.only(&["OP", "AMPLITUDE"])?;
    let amplitude = amplitude(card, deck)?;
    let new = is_new(card)?;
    let step = in_step(card, open)?;
    step.new_pressures |= new;
    for line in &card.lines {
        let Pressed {
            place,
            sides,
            value,
        } = pressed_surface(*line, deck, names)?;
        names.count(sides.len(), place)?;
        step.pressures
            .extend(sides.into_iter().map(|(element, side)| Pressure {
                element,
                side,
                value,
                amplitude,
                place,
            }));
    }
    Ok(())
}

/// A line of `*DSLOAD`.
struct Pressed {
    place: Place,
    sides: Vec<(usize, usize)>,
    value: f64,
}

fn pressed_surface(line: SourceLine<'_>, deck: &Deck, names: &Names) -> Result<Pressed, Fault> {
    let words = cells(line);
    let [first, label, size] = words.as_slice() else {
        bail!(line.place(0), "a surface, P and a pressure were expected");
    };
    if plain(label.text) != "P" {
        return Err(label.wrong(format!(
            "the load {:?} is not supported; it must be P, a pressure",
            short(label.text)
        )));
    }
    let surface = surface_of(first, names)?;
    match &deck.surfaces[surface].of {
        Faces::Elements(sides) => Ok(Pressed {
            place: first.place(),
            sides: sides.clone(),
            value: size.number("the pressure")?,
        }),
        Faces::Nodes(_) => Err(first.wrong(
            "a surface of nodes has no area for a pressure; use one of sides (TYPE=ELEMENT)",
        )),
    }
}
