//! Nodes, elements, sets and surfaces of a deck.

use super::cards::{Card, CardCell, cells, short};
use super::deck::{Element, ElementType, Faces, Family, Node, Set, Surface};
use super::reader::{MeshKind, Names, Reader};
use super::source::{DeckLocation, Done, Fault, plain};
use crate::bail;
use crate::mesh::CellKind;
use CellKind::*;
use MeshKind::*;

/// Maximum number of members of all sets and surfaces together, and of loads on members of sets: more than a plane mesh needs,
/// and few enough to fit in memory.
const MEMBERS: usize = 20_000_000;

impl Names {
    /// Counts members of sets against the limit.
    pub fn count(&mut self, more: usize, place: DeckLocation) -> Done {
        self.members += more;
        if self.members <= MEMBERS {
            Ok(())
        } else {
            bail!(
                place,
                "sets, surfaces and loads have more than {MEMBERS} members in total"
            )
        }
    }

    /// Members generated from a first to a last number.
    fn generated(&self, words: &[CardCell<'_>], kind: MeshKind, members: &mut Vec<usize>) -> Done {
        let Some(first) = words.first() else {
            return Ok(());
        };
        let Some(last) = words.get(1) else {
            bail!(
                first,
                "GENERATE needs a first and a last number, and optionally a step"
            );
        };
        let from = first.whole("the first number")?;
        let to = last.whole("the last number")?;
        let by = match words.get(2) {
            Some(step) => step.whole("the step")?,
            None => 1,
        };
        if by == 0 || to < from {
            bail!(
                first,
                "the last number must not be below the first one, and the step must be at least 1"
            );
        }
        if let Some(more) = words.get(3) {
            bail!(
                more,
                "unexpected value; GENERATE takes a first number, a last number and a step"
            );
        }
        let labels = match kind {
            Nodes => &self.nodes,
            Elements => &self.elements,
        };
        let within = labels
            .range(self.number(from)..=self.number(to))
            .filter(|(label, _)| (*label - self.number(from)).is_multiple_of(by));
        members.extend(within.map(|(_, &position)| position));
        fits(members, first, "set")
    }
}

impl Reader {
    pub(super) fn nodes(&mut self, card: &Card<'_>) -> Done {
        let first = self.deck.nodes.len();
        for line in &card.lines {
            let cells = cells(*line);
            let Some(label) = cells.first() else {
                continue;
            };
            let number = self.names.number(label.whole("a node number")?);
            let coordinate = |k: usize| super::cards::number_or_zero(&cells, k, "a coordinate");
            let (x, y, z) = (coordinate(1)?, coordinate(2)?, coordinate(3)?);
            if let Some(more) = cells.get(4) {
                self.deck.add_note(
                    more.place(),
                    "the text after a node's three coordinates is ignored",
                );
            }
            let [x, y, z] = self.names.within.place([x, y, z]);
            if z != 0.0 && !self.is_outline {
                let at = cells.get(3).map_or(label.place(), CardCell::place);
                bail!(at, "node {number} is at z = {z:?}; only z = 0 is supported");
            }
            let place = label.place();
            if self.names.nodes.contains_key(&number) {
                bail!(place, "node {number} is defined twice");
            }
            self.names.nodes.insert(number, self.deck.nodes.len());
            self.deck.nodes.push(Node {
                label: number,
                at: [x, y, z],
                place,
            });
        }
        self.add(
            card,
            Nodes,
            "NSET",
            (first..self.deck.nodes.len()).collect(),
        )
    }

    pub(super) fn elements(&mut self, card: &Card<'_>) -> Done {
        let kind = element_type(card, self.is_outline)?;
        let count = kind.cell.nodes();
        if kind.cell == Quad4 && kind.reduced {
            self.deck.add_note(
                card.place_of("TYPE"),
                "CPE4R, CPS4R and CAX4R have one integration point; 5 % of full integration controls hourglass modes, which each \
                 code does differently, so bending of coarse meshes differs",
            );
        } else if matches!(kind.cell, Triangle3 | Quad4) {
            self.deck.add_note(
            card.place_of("TYPE"),
            "elements with 3 and 4 nodes are fully integrated plane elements; CalculiX expands them to \
             three-dimensional elements, whose results differ by some percent on coarse meshes",
        );
        }
        let first = self.deck.elements.len();
        let mut lines = card.lines.iter();
        while let Some(line) = lines.next() {
            let mut words = cells(*line);
            let mut last = line;
            while words.len() <= count
                && last.text.trim_end().ends_with(',')
                && let Some(more) = lines.next()
            {
                words.extend(cells(*more));
                last = more;
            }
            let Some(label) = words.first() else {
                continue;
            };
            let number = self.names.number(label.whole("an element number")?);
            if words.len() != count + 1 {
                bail!(
                    label,
                    "element {number} has {} nodes; type {} needs {count}",
                    words.len() - 1,
                    short(card.required("TYPE")?)
                );
            }
            let mut of = Vec::with_capacity(count);
            for word in &words[1..] {
                let node = self.names.number(word.whole("a node number")?);
                let known = self.names.nodes.get(&node).copied();
                of.push(known.ok_or_else(|| {
                    word.wrong(format!("there is no node {node}; *NODE must come first"))
                })?);
            }
            let mut sorted = of.clone();
            sorted.sort_unstable();
            if sorted.windows(2).any(|pair| pair[0] == pair[1]) && !self.is_outline {
                bail!(
                    label,
                    "element {number} has a repeated node; use a type with fewer nodes"
                );
            }
            let place = label.place();
            if self.names.elements.contains_key(&number) {
                bail!(place, "element {number} is defined twice");
            }
            self.names.elements.insert(number, self.deck.elements.len());
            self.deck.elements.push(Element {
                label: number,
                kind,
                nodes: of,
                place,
            });
        }
        self.add(
            card,
            Elements,
            "ELSET",
            (first..self.deck.elements.len()).collect(),
        )
    }

    pub(super) fn node_set(&mut self, card: &Card<'_>) -> Done {
        self.set(card, Nodes, "NSET")
    }

    pub(super) fn element_set(&mut self, card: &Card<'_>) -> Done {
        self.set(card, Elements, "ELSET")
    }

    fn set(&mut self, card: &Card<'_>, kind: MeshKind, parameter: &str) -> Done {
        card.required(parameter)?;
        let mut members = Vec::new();
        let own = self.names.within.clone();
        if let Some(name) = card.value("INSTANCE")? {
            let Some(instance) = self.names.instance(name) else {
                let why = format!("there is no instance {}", short(name));
                return Err(card.wrong_at("INSTANCE", why));
            };
            self.names.within = instance.clone();
        }
        if card.has("GENERATE") {
            for line in &card.lines {
                self.names.generated(&cells(*line), kind, &mut members)?;
            }
        } else {
            for cell in card.cells().filter(|cell| !cell.text.is_empty()) {
                members.extend(self.members_of(&cell, kind)?);
                self.names.count(0, cell.place())?;
                fits(&members, &cell, "set")?;
            }
        }
        self.names.within = own;
        self.add(card, kind, parameter, members)
    }

    /// Members that a word of a list refers to: one node or element by number, or a set by name.
    pub(super) fn members_of(&self, cell: &CardCell<'_>, kind: MeshKind) -> Done<Vec<usize>> {
        let word = kind.word();
        let (sets, all) = match kind {
            Nodes => (&self.names.node_sets, &self.deck.node_sets),
            Elements => (&self.names.element_sets, &self.deck.element_sets),
        };
        let name = plain(cell.text);
        match self.names.labelled(&name, kind) {
            Some(Ok(position)) => return Ok(vec![position]),
            Some(Err(label)) => bail!(cell, "there is no {word} {label}"),
            None => {}
        }
        match sets.get(&self.names.name(&name)) {
            Some(&set) => Ok(all[set].members.clone()),
            None => bail!(
                cell,
                "there is no {word} set {}; it must be defined first",
                short(&name)
            ),
        }
    }

    /// Index of a set by name.
    pub(super) fn set_of(&self, name: &str, place: DeckLocation, kind: MeshKind) -> Done<usize> {
        let sets = match kind {
            Nodes => &self.names.node_sets,
            Elements => &self.names.element_sets,
        };
        match sets.get(&self.names.name(name)) {
            Some(set) => Ok(*set),
            None => bail!(place, "there is no {} set {}", kind.word(), short(name)),
        }
    }

    /// Index of a surface by name.
    pub(super) fn surface_of(&self, cell: &CardCell<'_>) -> Done<usize> {
        let name = plain(cell.text);
        self.names
            .surfaces
            .get(&self.names.name(&name))
            .copied()
            .ok_or_else(|| {
                cell.wrong(format!(
                    "there is no surface {}; *SURFACE, NAME=... defines one",
                    short(&name)
                ))
            })
    }

    /// Adds members to the set named by a parameter, if the card has it.
    fn add(
        &mut self,
        card: &Card<'_>,
        kind: MeshKind,
        parameter: &str,
        members: Vec<usize>,
    ) -> Done {
        let Some(name) = card.value(parameter)? else {
            return Ok(());
        };
        let place = card.place_of(parameter);
        let name = &self.names.name(name);
        if name.chars().all(|c| c.is_ascii_digit()) {
            bail!(
                place,
                "the set name {} looks like a number; start it with a letter",
                short(name)
            );
        }
        let (sets, all) = match kind {
            Nodes => (&mut self.names.node_sets, &mut self.deck.node_sets),
            Elements => (&mut self.names.element_sets, &mut self.deck.element_sets),
        };
        let set = *sets.entry(name.to_owned()).or_insert_with(|| {
            all.push(Set {
                name: name.to_owned(),
                members: Vec::new(),
            });
            all.len() - 1
        });
        let own = &mut all[set].members;
        let before = own.len();
        own.extend(members);
        own.sort_unstable();
        own.dedup();
        let more = own.len() - before.min(own.len());
        self.names.count(more, place)
    }

    pub(super) fn surface(&mut self, card: &Card<'_>) -> Done {
        let name = self.names.name(card.required("NAME")?);
        let of = match card.choice("TYPE", &["ELEMENT", "NODE"])? {
            0 => Faces::Elements(self.sides(card)?),
            _ => {
                let mut members = Vec::new();
                for line in &card.lines {
                    let words = cells(*line);
                    // Abaqus writes an area behind the node, always with a decimal point; contact here needs none.
                    let is_area = |cell: &CardCell<'_>| {
                        cell.text.parse::<f64>().is_ok() && cell.text.parse::<u64>().is_err()
                    };
                    let unread = words.iter().skip(1).find(|cell| !is_area(cell));
                    if let Some(more) = unread.or(words.get(2)).filter(|_| !self.is_outline) {
                        bail!(
                            more,
                            "unexpected value; a line of a surface of nodes has one node or set, and behind it only an area such as 1."
                        );
                    }
                    if let Some(cell) = words.first() {
                        members.extend(self.members_of(cell, Nodes)?);
                        fits(&members, cell, "surface")?;
                    }
                }
                Faces::Nodes(once(members))
            }
        };
        let (count, empty) = match &of {
            Faces::Elements(sides) => (sides.len(), sides.is_empty()),
            Faces::Nodes(nodes) => (nodes.len(), nodes.is_empty()),
        };
        if empty {
            bail!(card, "the surface {} is empty", short(&name));
        }
        self.names.count(count, card.place)?;
        match self.names.surfaces.get(&name) {
            None => {}
            // CalculiX has surfaces of nodes and of faces with the same name; the faces also serve as slaves.
            Some(&known) if self.is_outline && !matches!(of, Faces::Nodes(_)) => {
                self.deck.surfaces[known].of = of;
                return Ok(());
            }
            Some(_) if self.is_outline => return Ok(()),
            Some(_) => bail!(card, "the surface {} is defined twice", short(&name)),
        }
        self.names
            .surfaces
            .insert(name.clone(), self.deck.surfaces.len());
        self.deck.surfaces.push(Surface {
            name,
            of,
            place: card.place,
        });
        Ok(())
    }

    fn sides(&self, card: &Card<'_>) -> Done<Vec<(usize, usize)>> {
        let mut sides = Vec::new();
        for line in &card.lines {
            let words = cells(*line);
            let Some(first) = words.first() else {
                continue;
            };
            let Some(label) = words.get(1) else {
                bail!(
                    first,
                    "the side is missing; write the element and the side, e.g. \"12, S2\""
                );
            };
            for element in self.members_of(first, Elements)? {
                sides.push((element, side_of(label, 'S', &self.deck.elements[element])?));
            }
            fits(&sides, first, "surface")?;
        }
        Ok(once(sides))
    }
}

/// The element type of a card, if it is supported.
pub(super) fn element_type(card: &Card<'_>, solids: bool) -> Done<ElementType> {
    let name = card.required("TYPE")?;
    if solids && let Some(cell) = solid(name) {
        return Ok(ElementType {
            family: Family::Solid,
            cell,
            reduced: name.ends_with('R'),
        });
    }
    kind_of(name).map_err(|why| Fault::new(card.place_of("TYPE"), why))
}

/// The cell of a three-dimensional element type.
fn solid(name: &str) -> Option<CellKind> {
    Some(match name {
        "C3D4" => Tetra4,
        "C3D6" => Wedge6,
        "C3D8" | "C3D8R" | "C3D8I" => Hexa8,
        "C3D10" | "C3D10T" | "C3D10M" => Tetra10,
        "C3D15" => Wedge15,
        "C3D20" | "C3D20R" => Hexa20,
        _ => return None,
    })
}

fn kind_of(name: &str) -> Result<ElementType, String> {
    const RIGHT: &str = "supported are CPE, CPS and CAX with 3, 4, 4R, 6, 8 and 8R, and B21, B22, B31, B31R, B32, B32R";
    let plane = |family: Family, rest: &str| {
        let (cell, reduced) = match rest {
            "3" => (Triangle3, false),
            "4" => (Quad4, false),
            "6" => (Triangle6, false),
            "8" => (Quad8, false),
            "8R" => (Quad8, true),
            "4R" => (Quad4, true),
            _ => {
                return Err(format!(
                    "elements of type {} are not supported; {RIGHT}",
                    short(name)
                ));
            }
        };
        Ok(ElementType {
            family,
            cell,
            reduced,
        })
    };
    let beam = |cell| {
        Ok(ElementType {
            family: Family::Beam,
            cell,
            reduced: false,
        })
    };
    match name {
        "B21" | "B31" | "B31R" => return beam(Line2),
        "B22" | "B32" | "B32R" => return beam(Line3),
        _ => {}
    }
    let families = [
        ("CPE", Family::PlaneStrain),
        ("CPS", Family::PlaneStress),
        ("CAX", Family::Axisymmetric),
    ];
    for (begin, family) in families {
        if let Some(rest) = name.strip_prefix(begin) {
            return plane(family, rest);
        }
    }
    let why = match name {
        _ if solid(name).is_some() => {
            return Err(format!(
                "{name} is a three-dimensional element, which only CalculiX solves: `stickslip check` applies the rules \
                 for decks, and `stickslip JOB.cel` shows the run and why it failed; {RIGHT}"
            ));
        }
        _ if name.starts_with('S') && name[1..].starts_with(|c: char| c.is_ascii_digit()) => {
            "is a shell element"
        }
        _ => "is not supported",
    };
    Err(format!(
        "{} {why}; {RIGHT}; `stickslip check` also reads C3D4, 6, 8, 10, 15, 20 and their variants",
        short(name)
    ))
}

/// Rejects a set or a surface that is too large.
fn fits<T>(members: &[T], cell: &CardCell<'_>, what: &str) -> Done {
    if members.len() <= MEMBERS {
        Ok(())
    } else {
        bail!(cell, "a {what} has more than {MEMBERS} members")
    }
}

/// The distinct values, in the order of their first occurrence.
fn once<T: Copy + Eq + std::hash::Hash>(members: Vec<T>) -> Vec<T> {
    let mut seen = std::collections::HashSet::new();
    members
        .into_iter()
        .filter(|member| seen.insert(*member))
        .collect()
}

/// Index of a side of an element, given by a letter and its number from 1.
pub(super) fn side_of(cell: &CardCell<'_>, letter: char, element: &Element) -> Done<usize> {
    let most = element.kind.cell.sides().len();
    if most == 0 {
        bail!(
            cell,
            "element {} is a beam and has no sides; use its nodes instead, with TYPE=NODE",
            element.label
        );
    }
    let number = plain(cell.text)
        .strip_prefix(letter)
        .and_then(|rest| rest.parse::<usize>().ok());
    match number {
        Some(side) if (1..=most).contains(&side) => Ok(side - 1),
        _ => Err(cell.wrong(format!(
            "element {} has no side {:?}; it must be {letter}1 to {letter}{most}",
            element.label,
            short(cell.text)
        ))),
    }
}
