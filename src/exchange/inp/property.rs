//! Materials, sections, amplitudes and contact definitions of a deck.

use super::cards::{Card, CardCell, cells, number_or_zero, short};
use super::deck::{
    Adjust, Amplitude, Faces, Family, Form, Interaction, Material, Normal, Pair, Section, Tie,
};
use super::reader::{MeshKind, Reader};
use super::source::{Done, SourceLine};
use crate::bail;

/// Rejects a name that is already in use.
fn free<T>(card: &Card<'_>, all: &[T], name: impl Fn(&T) -> &str) -> Done<String> {
    let wanted = card.required("NAME")?;
    if all.iter().any(|one| name(one) == wanted) {
        Err(card.wrong_at("NAME", format!("{} is defined twice", short(wanted))))
    } else {
        Ok(wanted.to_owned())
    }
}

/// The index of an item by its name, which a parameter gives; `what` names the missing item in a message.
fn index_of<T>(
    card: &Card<'_>,
    parameter: &str,
    what: &str,
    all: &[T],
    name: impl Fn(&T) -> &str,
) -> Done<usize> {
    let wanted = card.required(parameter)?;
    let found = all.iter().position(|one| name(one) == wanted);
    found.ok_or_else(|| card.wrong_at(parameter, format!("there is no {what}{}", short(wanted))))
}

/// The first word of the only data line, and all words; `what` describes the line in messages, `first` the word.
fn first_of<'t>(
    card: &Card<'t>,
    what: &str,
    first: &str,
) -> Done<(CardCell<'t>, Vec<CardCell<'t>>)> {
    let words = card.one_line(what)?;
    match words.first() {
        Some(word) => Ok((*word, words)),
        None => bail!(card, "{first} is missing"),
    }
}

fn positive(cell: &CardCell<'_>, what: &str) -> Done<f64> {
    let value = cell.number(what)?;
    if value > 0.0 {
        Ok(value)
    } else {
        bail!(cell, "{what} is {value:?}; it must be positive")
    }
}

impl Reader {
    pub(super) fn material(&mut self, card: &Card<'_>) -> Done {
        card.no_lines()?;
        self.deck.materials.push(Material {
            name: free(card, &self.deck.materials, |m| &m.name)?,
            elastic: None,
            density: None,
            yields: None,
            expansion: None,
            place: card.place,
            elastic_place: card.place,
        });
        Ok(())
    }

    /// The last material, to which the card belongs.
    fn last_material(&mut self, card: &Card<'_>) -> Done<&mut Material> {
        let last = self.deck.materials.last_mut();
        last.ok_or_else(|| card.wrong("it belongs to a material; *MATERIAL must come first"))
    }

    pub(super) fn elastic(&mut self, card: &Card<'_>) -> Done {
        card.choice("TYPE", &["ISO", "ISOTROPIC"])?;
        let words = match card.lines.first().filter(|_| self.is_outline) {
            Some(line) => cells(*line),
            None => card.one_line("Young's modulus and Poisson's ratio, at one temperature,")?,
        };
        let [young, poisson, ..] = words.as_slice() else {
            bail!(card, "Young's modulus and Poisson's ratio are missing");
        };
        if let Some(more) = words.get(3) {
            bail!(
                more,
                "unexpected value; an isotropic material has a modulus, a ratio and a temperature"
            );
        }
        let elastic = (
            young.number("Young's modulus")?,
            poisson.number("Poisson's ratio")?,
        );
        let material = self.last_material(card)?;
        material.elastic = Some(elastic);
        material.elastic_place = young.place();
        Ok(())
    }

    pub(super) fn density(&mut self, card: &Card<'_>) -> Done {
        let material = self.last_material(card)?;
        let (first, _) = first_of(card, "the density, at one temperature,", "the density")?;
        material.density = Some(first.number("the density")?);
        Ok(())
    }

    /// The largest stress of the table.
    pub(super) fn plastic(&mut self, card: &Card<'_>) -> Done {
        let stresses = card.lines.iter().map(|line| cells(*line));
        let stresses =
            stresses.filter_map(|cells| cells.first().map(|cell| cell.number("a yield stress")));
        let stresses = stresses.collect::<Done<Vec<f64>>>()?;
        self.last_material(card)?.yields = stresses.into_iter().reduce(f64::max);
        Ok(())
    }

    /// The moduli at small strains of the two laws with polynomials of first order.
    pub(super) fn hyperelastic(&mut self, card: &Card<'_>) -> Done {
        let count = match card {
            _ if card.has("NEOHOOKE") => 1,
            _ if card.has("MOONEY-RIVLIN") => 2,
            _ => bail!(card, "only NEO HOOKE and MOONEY-RIVLIN are considered"),
        };
        let cells: Vec<_> = card.cells().collect();
        let Some((shear, compliance)) = cells.get(..count).zip(cells.get(count)) else {
            bail!(card, "coefficients are missing");
        };
        let shear: Vec<f64> = shear
            .iter()
            .map(|cell| cell.number("a coefficient"))
            .collect::<Done<_>>()?;
        let (shear, compliance) = (2.0 * shear.iter().sum::<f64>(), compliance.number("D1")?);
        // E = 9 K G / (3 K + G) with K = 2 / D1.
        let young = 18.0 * shear / (6.0 + shear * compliance);
        let material = self.last_material(card)?;
        material.elastic = Some((young, young / (2.0 * shear) - 1.0));
        material.elastic_place = card.place;
        Ok(())
    }

    /// Only temperatures in the steps need a coefficient that does not depend on them.
    pub(super) fn expansion(&mut self, card: &Card<'_>) -> Done {
        let is_isotropic = card
            .value("TYPE")?
            .is_none_or(|kind| kind.starts_with("ISO"));
        for line in card.lines.iter().filter(|_| is_isotropic) {
            if let Some(more) = cells(*line).get(2) {
                bail!(
                    more,
                    "unexpected value; isotropic expansion has a coefficient and a temperature"
                );
            }
        }
        let single = is_isotropic && card.lines.len() == 1;
        let coefficient = card.cells().next().filter(|_| single);
        let coefficient = coefficient.map(|cell| cell.number("the coefficient of expansion"));
        self.last_material(card)?.expansion = coefficient.transpose()?;
        Ok(())
    }

    pub(super) fn amplitude(&mut self, card: &Card<'_>) -> Done {
        let name = free(card, &self.deck.amplitudes, |a| &a.name)?;
        let total = card.choice("TIME", &["STEP TIME", "TOTAL TIME"])? == 1;
        card.choice("DEFINITION", &["TABULAR"])?;
        card.choice("VALUE", &["RELATIVE"])?;
        let mut points: Vec<(f64, f64)> = Vec::new();
        for line in &card.lines {
            for pair in cells(*line).chunks(2) {
                let [time, factor] = pair else {
                    bail!(&pair[0], "a time without a factor; they must come in pairs");
                };
                let point = (time.number("a time")?, factor.number("a factor")?);
                if points.last().is_some_and(|last| last.0 >= point.0) {
                    bail!(
                        time,
                        "time {:?} does not follow the previous one; times must be ascending",
                        point.0
                    );
                }
                points.push(point);
            }
        }
        if points.is_empty() {
            bail!(card, "times and factors, in pairs, are missing");
        }
        self.deck.amplitudes.push(Amplitude {
            name,
            total,
            points,
            place: card.place,
        });
        Ok(())
    }

    pub(super) fn interaction(&mut self, card: &Card<'_>) -> Done {
        let name = free(card, &self.deck.interactions, |i| &i.name)?;
        if let Some(line) = card.lines.first() {
            self.deck.add_note(
                line.place(0),
                "the thickness of the surface is ignored: contact forces are those of the mesh",
            );
        }
        self.deck.interactions.push(Interaction {
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

    /// The last contact law, to which the card belongs.
    fn last_interaction(&mut self, card: &Card<'_>) -> Done<&mut Interaction> {
        let last = self.deck.interactions.last_mut();
        let why = "it belongs to a contact law; *SURFACE INTERACTION must come first";
        last.ok_or_else(|| card.wrong(why))
    }

    pub(super) fn behavior(&mut self, card: &Card<'_>) -> Done {
        const NAME: &str = "PRESSURE-OVERCLOSURE";
        let (mut normal, mut place) = (Normal::Hard, card.place);
        let ignored;
        match card.value(NAME)?.unwrap_or("HARD") {
            "HARD" => {
                let why =
                    "PRESSURE-OVERCLOSURE=HARD takes no numbers, because there is no penetration";
                ignored = card.lines.first().map(|line| (line.place(0), why));
            }
            law @ ("LINEAR" | "TIED") => {
                const WHAT: &str = "the stiffness (pressure per length)";
                let (first, words) = first_of(card, WHAT, WHAT)?;
                let stiffness = positive(&first, "the stiffness of the surface")?;
                place = first.place();
                normal = match law {
                    "LINEAR" => Normal::Linear { stiffness },
                    _ => Normal::Tied { stiffness },
                };
                let given = "the tension at large gaps and the clearance c0 are ignored: the pressure is K times the \
                             overclosure, and 0 with a gap";
                let default = "LINEAR has no second value, the tension: in NODE TO SURFACE pairs CalculiX then pulls open \
                               nodes with up to E / 70000, this program does not; the value 1e-9 removes it there";
                ignored = match words.get(1) {
                    Some(more) => Some((more.place(), given)),
                    None => (law == "LINEAR").then_some((place, default)),
                };
            }
            law => {
                let why = "nonlinear pressure laws do not give a complementarity problem; it must be HARD, LINEAR or TIED";
                let what = format!("{NAME}={} is not supported: {why}", short(law));
                return Err(card.wrong_at(NAME, what));
            }
        }
        let interaction = self.last_interaction(card)?;
        interaction.normal = normal;
        interaction.normal_place = place;
        if let Some((place, why)) = ignored {
            self.deck.add_note(place, why);
        }
        Ok(())
    }

    pub(super) fn friction(&mut self, card: &Card<'_>) -> Done {
        const WHAT: &str = "the coefficient of friction";
        let line = "the coefficient of friction, and optionally the stick slope,";
        let (first, words) = first_of(card, line, WHAT)?;
        let coefficient = first.number(WHAT)?;
        if coefficient < 0.0 {
            bail!(&first, "{WHAT} is {coefficient:?}; it must not be negative");
        }
        let stick = words.get(1).filter(|cell| !cell.text.is_empty());
        let stick = stick
            .map(|cell| positive(cell, "the stick slope"))
            .transpose()?;
        if let Some(more) = words.get(2) {
            bail!(
                more,
                "unexpected value; friction has a coefficient and a stick slope"
            );
        }
        if card.has("SLIPTOLERANCE") {
            self.deck.add_note(
                card.place_of("SLIPTOLERANCE"),
                "SLIP TOLERANCE is ignored: a stuck node does not slip at all",
            );
        }
        let interaction = self.last_interaction(card)?;
        interaction.friction = coefficient;
        interaction.stick = stick;
        interaction.friction_place = first.place();
        Ok(())
    }

    /// The set and the material of a section; rejects elements of the wrong family.
    fn section(&self, card: &Card<'_>, beams: bool) -> Done<(usize, usize)> {
        let set = card.required("ELSET")?;
        let set = self.set_of(set, card.place_of("ELSET"), MeshKind::Elements)?;
        let materials = &self.deck.materials;
        let material = index_of(card, "MATERIAL", "material ", materials, |m| &m.name)?;
        let mut elements = self.deck.element_sets[set]
            .members
            .iter()
            .map(|&k| &self.deck.elements[k]);
        let (is, must) = if beams {
            ("not a beam", "*SOLID SECTION")
        } else {
            ("a beam", "*BEAM SECTION")
        };
        match elements.find(|element| (element.kind.family == Family::Beam) != beams) {
            None => Ok((set, material)),
            Some(element) => bail!(
                card,
                "element {} of its set is {is}; its section must be {must}",
                element.label
            ),
        }
    }

    pub(super) fn solid_section(&mut self, card: &Card<'_>) -> Done {
        let (set, material) = self.section(card, false)?;
        let thickness = match card.cells().next().filter(|cell| !cell.text.is_empty()) {
            Some(cell) => positive(&cell, "the thickness")?,
            None => 1.0,
        };
        self.deck.sections.push(Section {
            set,
            material,
            form: Form::Solid { thickness },
            place: card.place,
        });
        Ok(())
    }

    pub(super) fn beam_section(&mut self, card: &Card<'_>) -> Done {
        if card.required("SECTION")? != "RECT" {
            return Err(card.wrong_at("SECTION", "only SECTION=RECT is supported"));
        }
        let (set, material) = self.section(card, true)?;
        let [sides, rest @ ..] = card.lines.as_slice() else {
            bail!(
                card,
                "the thicknesses across the plane and in the plane are missing"
            );
        };
        let words = cells(*sides);
        let [width, height] = words.as_slice() else {
            bail!(
                sides,
                "unexpected value; a rectangle has two thicknesses, across the plane and in the plane"
            );
        };
        if let Some(axis) = rest.first() {
            let words = cells(*axis);
            let part =
                |k: usize| number_or_zero(&words, k, "a component of the section's first axis");
            let (x, y, z) = (part(0)?, part(1)?, part(2)?);
            if x != 0.0 || y != 0.0 || z == 0.0 {
                bail!(
                    axis,
                    "the section's first axis must be perpendicular to the plane, as 0, 0, -1; the first thickness is measured along it"
                );
            }
        }
        if let Some(more) = rest.get(1) {
            bail!(more, "unexpected line; a beam section has two data lines");
        }
        let form = Form::Rectangle {
            width: positive(width, "the thickness across the plane")?,
            height: positive(height, "the thickness in the plane")?,
        };
        self.deck.sections.push(Section {
            set,
            material,
            form,
            place: card.place,
        });
        Ok(())
    }

    /// The slave and the master named on each line.
    fn two_surfaces(&self, card: &Card<'_>) -> Done<Vec<(usize, usize)>> {
        if card.lines.is_empty() {
            bail!(card, "two surfaces are missing, the slave and the master");
        }
        let two = |line: &SourceLine<'_>| {
            let words = cells(*line);
            let [slave, master] = words.as_slice() else {
                bail!(line, "two surfaces were expected, the slave and the master");
            };
            let pair = (self.surface_of(slave)?, self.surface_of(master)?);
            if pair.0 == pair.1 {
                bail!(slave, "self-contact is not supported; name two surfaces");
            }
            if matches!(self.deck.surfaces[pair.1].of, Faces::Nodes(_)) {
                bail!(
                    master,
                    "a master must be a surface of element sides (TYPE=ELEMENT), not of nodes"
                );
            }
            Ok(pair)
        };
        card.lines.iter().map(two).collect()
    }

    pub(super) fn pair(&mut self, card: &Card<'_>) -> Done {
        let (all, what) = (&self.deck.interactions, "*SURFACE INTERACTION, NAME=");
        let interaction = index_of(card, "INTERACTION", what, all, |i| &i.name)?;
        let faces = card.choice("TYPE", &["NODE TO SURFACE", "SURFACE TO SURFACE"])? == 1;
        let adjust = match card.value("ADJUST")? {
            Some(value) if value.parse::<f64>().is_err() => {
                let place = card.place_of("ADJUST");
                Some(Adjust::Set(self.set_of(value, place, MeshKind::Nodes)?))
            }
            _ => card
                .length("ADJUST", "a nonnegative distance, or a set")?
                .map(Adjust::Within),
        };
        for ((slave, master), line) in self.two_surfaces(card)?.into_iter().zip(&card.lines) {
            self.deck.pairs.push(Pair {
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

    pub(super) fn tie(&mut self, card: &Card<'_>) -> Done {
        card.choice("TYPE", &["SURFACE TO SURFACE", "NODE TO SURFACE"])?;
        let tolerance = card.length("POSITION TOLERANCE", "a nonnegative distance")?;
        let adjust = card.choice("ADJUST", &["YES", "NO"])? == 0;
        for ((slave, master), line) in self.two_surfaces(card)?.into_iter().zip(&card.lines) {
            self.deck.ties.push(Tie {
                slave,
                master,
                tolerance,
                adjust,
                place: line.place(0),
            });
        }
        Ok(())
    }
}
