//! Materials, sections, amplitudes and contact definitions of a deck.

use super::cards::{Card, CardCell, cells, number_or_zero, short};
use super::deck::{
    Adjust, Amplitude, Deck, Faces, Family, Form, Interaction, Material, Normal, Pair, Section, Tie,
};
use super::mesh::{MeshKind, Names, set_of, surface_of};
use super::source::{Fault, Place};
use crate::bail;

/// The card to which subsequent cards belong.
#[derive(Debug, Default)]
pub(super) struct Open {
    material: Option<usize>,
    interaction: Option<usize>,
}

/// Reads a card that defines a material, an amplitude or a contact law; returns whether it is one.
pub(super) fn define(card: &Card<'_>, deck: &mut Deck, open: &mut Open) -> Result<bool, Fault> {
    match card.key.as_str() {
        "MATERIAL" => material(card, deck, open)?,
        "ELASTIC" => elastic(card, deck, open)?,
        "DENSITY" => density(card, deck, open)?,
        "AMPLITUDE" => amplitude(card, deck)?,
        "SURFACEINTERACTION" => interaction(card, deck, open)?,
        "SURFACEBEHAVIOR" => behavior(card, deck, open)?,
        "FRICTION" => friction(card, deck, open)?,
        _ => return Ok(false),
    }
    Ok(true)
}

/// Reads a card that uses definitions; returns whether it is one.
pub(super) fn apply(card: &Card<'_>, deck: &mut Deck, names: &Names) -> Result<bool, Fault> {
    match card.key.as_str() {
        "SOLIDSECTION" => solid_section(card, deck, names)?,
        "BEAMSECTION" => beam_section(card, deck, names)?,
        "CONTACTPAIR" => pair(card, deck, names)?,
        "TIE" => tie(card, deck, names)?,
        _ => return Ok(false),
    }
    Ok(true)
}

fn named<T>(all: &[T], name: impl Fn(&T) -> &str, wanted: &str) -> Option<usize> {
    all.iter().position(|one| name(one) == wanted)
}

fn free<T>(card: &Card<'_>, all: &[T], name: impl Fn(&T) -> &str) -> Result<String, Fault> {
    let wanted = card.required("NAME")?;
    match named(all, name, wanted) {
        None => Ok(wanted.to_owned()),
        Some(_) => Err(Fault::new(
            card.place_of("NAME"),
            format!("*{}: {} is defined twice", card.shown, short(wanted)),
        )),
    }
}

fn material(card: &Card<'_>, deck: &mut Deck, open: &mut Open) -> Result<(), Fault> {
    card.only(&["NAME"])?;
    card.no_lines()?;
    let name = free(card, &deck.materials, |m| &m.name)?;
    open.material = Some(deck.materials.len());
    deck.materials.push(Material {
        name,
        elastic: None,
        density: None,
        place: card.place,
        elastic_place: card.place,
    });
    Ok(())
}

fn of_material<'a>(
    card: &Card<'_>,
    deck: &'a mut Deck,
    open: &Open,
) -> Result<&'a mut Material, Fault> {
    let found = open.material.and_then(|k| deck.materials.get_mut(k));
    found.ok_or_else(|| card.wrong("it belongs to a material; *MATERIAL must come first"))
}

fn elastic(card: &Card<'_>, deck: &mut Deck, open: &Open) -> Result<(), Fault> {
    card.only(&["TYPE"])?;
    card.choice("TYPE", &["ISO", "ISOTROPIC"])?;
    let material = of_material(card, deck, open)?;
    let words = card.one_line("Young's modulus and Poisson's ratio, at one temperature,")?;
    let [young, poisson, ..] = words.as_slice() else {
        return Err(card.wrong("Young's modulus and Poisson's ratio are missing"));
    };
    if let Some(more) = words.get(3) {
        return Err(more.wrong(
            "unexpected value; an isotropic material has a modulus, a ratio and a temperature",
        ));
    }
    material.elastic = Some((
        young.number("Young's modulus")?,
        poisson.number("Poisson's ratio")?,
    ));
    material.elastic_place = young.place();
    Ok(())
}

fn density(card: &Card<'_>, deck: &mut Deck, open: &Open) -> Result<(), Fault> {
    card.only(&[])?;
    let material = of_material(card, deck, open)?;
    let words = card.one_line("the density, at one temperature,")?;
    let first = words
        .first()
        .ok_or_else(|| card.wrong("the density is missing"))?;
    material.density = Some(first.number("the density")?);
    Ok(())
}

fn amplitude(card: &Card<'_>, deck: &mut Deck) -> Result<(), Fault> {
    card.only(&["NAME", "TIME", "DEFINITION", "VALUE"])?;
    let name = free(card, &deck.amplitudes, |a| &a.name)?;
    let total = card.choice("TIME", &["STEP TIME", "TOTAL TIME"])? == 1;
    card.choice("DEFINITION", &["TABULAR"])?;
    card.choice("VALUE", &["RELATIVE"])?;
    let mut points: Vec<(f64, f64)> = Vec::new();
    for line in &card.lines {
        for pair in cells(*line).chunks(2) {
            let [time, factor] = pair else {
                return Err(pair[0].wrong("a time without a factor; they must come in pairs"));
            };
            let point = (time.number("a time")?, factor.number("a factor")?);
            if points.last().is_some_and(|last| last.0 >= point.0) {
                return Err(time.wrong(format!(
                    "time {:?} does not follow the previous one; times must be ascending",
                    point.0
                )));
            }
            points.push(point);
        }
    }
    if points.is_empty() {
        return Err(card.wrong("times and factors, in pairs, are missing"));
    }
    deck.amplitudes.push(Amplitude {
        name,
        total,
        points,
        place: card.place,
    });
    Ok(())
}

fn interaction(card: &Card<'_>, deck: &mut Deck, open: &mut Open) -> Result<(), Fault> {
    card.only(&["NAME"])?;
    let name = free(card, &deck.interactions, |i| &i.name)?;
    if !card.lines.is_empty() {
        deck.remark(
            card.lines[0].place(0),
            "the thickness of the surface is ignored: contact forces are those of the mesh",
        );
    }
    open.interaction = Some(deck.interactions.len());
    deck.interactions.push(Interaction {
        name,
        normal: Normal::Hard,
        friction: 0.0,
        stick: None,
        place: card.place,
        normal_place: card.place,
        friction_place: card.place,
    });
    Ok(())
}

fn of_interaction<'a>(
    card: &Card<'_>,
    deck: &'a mut Deck,
    open: &Open,
) -> Result<&'a mut Interaction, Fault> {
    let found = open.interaction.and_then(|k| deck.interactions.get_mut(k));
    found.ok_or_else(|| {
        card.wrong("it belongs to a contact law; *SURFACE INTERACTION must come first")
    })
}

fn behavior(card: &Card<'_>, deck: &mut Deck, open: &Open) -> Result<(), Fault> {
    card.only(&["PRESSUREOVERCLOSURE", "PRESSURE-OVERCLOSURE"])?;
    const NAME: &str = "PRESSURE-OVERCLOSURE";
    let place = card.place;
    let law = card.value(NAME)?.unwrap_or("HARD");
    match law {
        "HARD" => {
            of_interaction(card, deck, open)?;
            if let Some(line) = card.lines.first() {
                deck.remark(
                    line.place(0),
                    "PRESSURE-OVERCLOSURE=HARD takes no numbers, because there is no penetration",
                );
            }
        }
        "LINEAR" | "TIED" => {
            let words = card.one_line("the stiffness (pressure per length)")?;
            let first = words
                .first()
                .ok_or_else(|| card.wrong("the stiffness (pressure per length) is missing"))?;
            let stiffness = positive(first, "the stiffness of the surface")?;
            let normal = match law {
                "LINEAR" => Normal::Linear { stiffness },
                _ => Normal::Tied { stiffness },
            };
            let at = first.place();
            let interaction = of_interaction(card, deck, open)?;
            interaction.normal = normal;
            interaction.normal_place = at;
            if let Some(more) = words.get(1) {
                deck.remark(
                    more.place(),
                    "the tension at large gaps and the clearance c0 are ignored: the pressure is K times the \
                     overclosure, and 0 with a gap",
                );
            }
            return Ok(());
        }
        _ => {
            bail!(
                card.place_of(NAME),
                "*{}: {NAME}={} is not supported: nonlinear pressure laws do not give a complementarity \
                     problem; it must be HARD, LINEAR or TIED",
                card.shown,
                short(law)
            );
        }
    }
    let interaction = of_interaction(card, deck, open)?;
    interaction.normal = Normal::Hard;
    interaction.normal_place = place;
    Ok(())
}

fn positive(cell: &CardCell<'_>, what: &str) -> Result<f64, Fault> {
    let value = cell.number(what)?;
    match value > 0.0 {
        true => Ok(value),
        false => Err(cell.wrong(format!("{what} is {value:?}; it must be positive"))),
    }
}

fn friction(card: &Card<'_>, deck: &mut Deck, open: &Open) -> Result<(), Fault> {
    card.only(&["SLIPTOLERANCE"])?;
    let words = card.one_line("the coefficient of friction, and optionally the stick slope,")?;
    let first = words
        .first()
        .ok_or_else(|| card.wrong("the coefficient of friction is missing"))?;
    let coefficient = first.number("the coefficient of friction")?;
    if coefficient < 0.0 {
        return Err(first.wrong(format!(
            "the coefficient of friction is {coefficient:?}; it must not be negative"
        )));
    }
    let stick = words.get(1).filter(|cell| !cell.text.is_empty());
    let stick = stick
        .map(|cell| positive(cell, "the stick slope"))
        .transpose()?;
    if let Some(more) = words.get(2) {
        return Err(more.wrong("unexpected value; friction has a coefficient and a stick slope"));
    }
    if card.has("SLIPTOLERANCE") {
        deck.remark(
            card.place_of("SLIPTOLERANCE"),
            "SLIP TOLERANCE is ignored: a stuck node does not slip at all",
        );
    }
    let interaction = of_interaction(card, deck, open)?;
    interaction.friction = coefficient;
    interaction.stick = stick;
    interaction.friction_place = first.place();
    Ok(())
}

/// Index of the material named by a section.
fn section_material(card: &Card<'_>, deck: &Deck) -> Result<usize, Fault> {
    let name = card.required("MATERIAL")?;
    named(&deck.materials, |m| &m.name, name).ok_or_else(|| {
        Fault::new(
            card.place_of("MATERIAL"),
            format!("there is no material {}", short(name)),
        )
    })
}

fn section_set(card: &Card<'_>, names: &Names) -> Result<usize, Fault> {
    set_of(
        card.required("ELSET")?,
        card.place_of("ELSET"),
        names,
        MeshKind::Elements,
    )
}

/// Rejects a section whose elements are of the wrong family.
fn suits(card: &Card<'_>, deck: &Deck, set: usize, beams: bool) -> Result<(), Fault> {
    let elements = deck.element_sets[set]
        .members
        .iter()
        .map(|&k| &deck.elements[k]);
    let mut other = elements.filter(|element| (element.kind.family == Family::Beam) != beams);
    match other.next() {
        None => Ok(()),
        Some(element) => Err(card.wrong(format!(
            "element {} of its set is {}; its section must be {}",
            element.label,
            if beams { "not a beam" } else { "a beam" },
            if beams {
                "*SOLID SECTION"
            } else {
                "*BEAM SECTION"
            },
        ))),
    }
}

fn solid_section(card: &Card<'_>, deck: &mut Deck, names: &Names) -> Result<(), Fault> {
    card.only(&["ELSET", "MATERIAL"])?;
    let (set, material) = (section_set(card, names)?, section_material(card, deck)?);
    suits(card, deck, set, false)?;
    let thickness = match card.cells().next().filter(|cell| !cell.text.is_empty()) {
        Some(cell) => positive(&cell, "the thickness")?,
        None => 1.0,
    };
    deck.sections.push(Section {
        set,
        material,
        form: Form::Solid { thickness },
        place: card.place,
    });
    Ok(())
}

fn beam_section(card: &Card<'_>, deck: &mut Deck, names: &Names) -> Result<(), Fault> {
    card.only(&["ELSET", "MATERIAL", "SECTION"])?;
    if card.required("SECTION")? != "RECT" {
        bail!(
            card.place_of("SECTION"),
            "*{}: only SECTION=RECT is supported",
            card.shown
        );
    }
    let (set, material) = (section_set(card, names)?, section_material(card, deck)?);
    suits(card, deck, set, true)?;
    let [sides, rest @ ..] = card.lines.as_slice() else {
        return Err(card.wrong("the thicknesses across the plane and in the plane are missing"));
    };
    let words = cells(*sides);
    let [width, height] = words.as_slice() else {
        bail!(
            sides.place(0),
            "unexpected value; a rectangle has two thicknesses, across the plane and in the plane"
        );
    };
    if let Some(axis) = rest.first() {
        let words = cells(*axis);
        let part = |k: usize| number_or_zero(&words, k, "a component of the section's first axis");
        let (x, y, z) = (part(0)?, part(1)?, part(2)?);
        if x != 0.0 || y != 0.0 || z == 0.0 {
            bail!(
                axis.place(0),
                "the section's first axis must be perpendicular to the plane, as 0, 0, -1; the first thickness is measured along it"
            );
        }
    }
    if let Some(more) = rest.get(1) {
        bail!(
            more.place(0),
            "unexpected line; a beam section has two data lines"
        );
    }
    let form = Form::Rectangle {
        width: positive(width, "the thickness across the plane")?,
        height: positive(height, "the thickness in the plane")?,
    };
    deck.sections.push(Section {
        set,
        material,
        form,
        place: card.place,
    });
    Ok(())
}

/// The slave and the master named on a line.
fn two_surfaces(
    line: super::source::SourceLine<'_>,
    deck: &Deck,
    names: &Names,
) -> Result<(usize, usize), Fault> {
    let words = cells(line);
    let [slave, master] = words.as_slice() else {
        bail!(
            line.place(0),
            "two surfaces were expected, the slave and the master"
        );
    };
    let pair = (surface_of(slave, names)?, surface_of(master, names)?);
    if pair.0 == pair.1 {
        return Err(slave.wrong("self-contact is not supported; name two surfaces"));
    }
    if matches!(deck.surfaces[pair.1].of, Faces::Nodes(_)) {
        return Err(master
            .wrong("a master must be a surface of element sides (TYPE=ELEMENT), not of nodes"));
    }
    Ok(pair)
}

fn pair(card: &Card<'_>, deck: &mut Deck, names: &Names) -> Result<(), Fault> {
    card.only(&["INTERACTION", "TYPE", "SMALLSLIDING", "ADJUST"])?;
    let name = card.required("INTERACTION")?;
    let place = card.place_of("INTERACTION");
    let interaction = named(&deck.interactions, |i| &i.name, name).ok_or_else(|| {
        Fault::new(
            place,
            format!("there is no *SURFACE INTERACTION, NAME={}", short(name)),
        )
    })?;
    let faces = card.choice("TYPE", &["NODE TO SURFACE", "SURFACE TO SURFACE"])? == 1;
    if faces {
        deck.remark(
            card.place_of("TYPE"),
            "SURFACE TO SURFACE is treated as node to surface: the law holds at each slave node with \
             its tributary area, not at points of the sides",
        );
    }
    let adjust = card
        .value("ADJUST")?
        .map(|value| adjusted(value, card.place_of("ADJUST"), names));
    let adjust = adjust.transpose()?;
    if card.lines.is_empty() {
        return Err(card.wrong("two surfaces are missing, the slave and the master"));
    }
    for line in &card.lines {
        let (slave, master) = two_surfaces(*line, deck, names)?;
        deck.pairs.push(Pair {
            slave,
            master,
            interaction,
            faces,
            small_sliding: card.has("SMALLSLIDING"),
            adjust: adjust.clone(),
            place: line.place(0),
        });
    }
    Ok(())
}

fn adjusted(value: &str, place: Place, names: &Names) -> Result<Adjust, Fault> {
    match value.parse::<f64>() {
        Ok(within) if within.is_finite() && within >= 0.0 => Ok(Adjust::Within(within)),
        Ok(within) => Err(Fault::new(
            place,
            format!("ADJUST={within:?}; it must be a nonnegative distance, or a set"),
        )),
        Err(_) => Ok(Adjust::Set(set_of(value, place, names, MeshKind::Nodes)?)),
    }
}

fn tie(card: &Card<'_>, deck: &mut Deck, names: &Names) -> Result<(), Fault> {
    card.only(&["NAME", "POSITIONTOLERANCE", "ADJUST", "TYPE"])?;
    card.choice("TYPE", &["SURFACE TO SURFACE", "NODE TO SURFACE"])?;
    let place = card.place_of("POSITIONTOLERANCE");
    let tolerance = card.value("POSITIONTOLERANCE")?;
    let tolerance = tolerance.map(|value| match value.parse::<f64>() {
        Ok(length) if length.is_finite() && length >= 0.0 => Ok(length),
        _ => Err(Fault::new(
            place,
            format!("POSITION TOLERANCE={} is not a length", short(value)),
        )),
    });
    let tolerance = tolerance.transpose()?;
    let adjust = card.choice("ADJUST", &["YES", "NO"])? == 0;
    if card.lines.is_empty() {
        return Err(card.wrong("two surfaces are missing, the slave and the master"));
    }
    for line in &card.lines {
        let (slave, master) = two_surfaces(*line, deck, names)?;
        deck.ties.push(Tie {
            slave,
            master,
            tolerance,
            adjust,
            place: line.place(0),
        });
    }
    Ok(())
}
