//! Nodes, elements, sets and surfaces of a deck.

use super::cards::{Card, CardCell, cells, short};
use super::deck::{Deck, Element, ElementType, Faces, Family, Node, Set, Surface};
use super::source::{Fault, Place, plain};
use crate::bail;
use crate::mesh::CellKind;
use std::collections::{BTreeMap, HashMap};

/// Maximum number of members of all sets and surfaces together, and of loads on members of sets: more than a plane mesh needs,
/// and few enough to fit in memory.
const MEMBERS: usize = 20_000_000;

/// Lookup tables for labels and names of a deck.
#[derive(Debug, Default)]
pub(super) struct Names {
    nodes: BTreeMap<u64, usize>,
    elements: BTreeMap<u64, usize>,
    node_sets: HashMap<String, usize>,
    element_sets: HashMap<String, usize>,
    surfaces: HashMap<String, usize>,
    members: usize,
}

impl Names {
    /// Counts members of sets against the limit.
    pub fn count(&mut self, more: usize, place: Place) -> Result<(), Fault> {
        self.members += more;
        match self.members <= MEMBERS {
            true => Ok(()),
            false => Err(Fault::new(
                place,
                format!("sets, surfaces and loads have more than {MEMBERS} members in total"),
            )),
        }
    }
}

/// Reads a card of the mesh; returns whether it is one.
pub(super) fn read(card: &Card<'_>, deck: &mut Deck, names: &mut Names) -> Result<bool, Fault> {
    match card.key.as_str() {
        "NODE" => nodes(card, deck, names)?,
        "ELEMENT" => elements(card, deck, names)?,
        "NSET" => set(card, deck, names, MeshKind::Nodes)?,
        "ELSET" => set(card, deck, names, MeshKind::Elements)?,
        "SURFACE" => surface(card, deck, names)?,
        _ => return Ok(false),
    }
    Ok(true)
}

fn nodes(card: &Card<'_>, deck: &mut Deck, names: &mut Names) -> Result<(), Fault> {
    card.only(&["NSET"])?;
    let first = deck.nodes.len();
    for line in &card.lines {
        let cells = cells(*line);
        let Some(label) = cells.first() else {
            continue;
        };
        let number = label.whole("a node number")?;
        let coordinate = |k: usize| super::cards::number_or_zero(&cells, k, "a coordinate");
        let (x, y, z) = (coordinate(1)?, coordinate(2)?, coordinate(3)?);
        if let Some(more) = cells.get(4) {
            deck.remark(
                more.place(),
                "the text after a node's three coordinates is ignored",
            );
        }
        if z != 0.0 {
            let at = cells.get(3).map_or(label.place(), CardCell::place);
            bail!(at, "node {number} is at z = {z:?}; only z = 0 is supported");
        }
        let place = label.place();
        if names.nodes.insert(number, deck.nodes.len()).is_some() {
            bail!(place, "node {number} is defined twice");
        }
        deck.nodes.push(Node {
            label: number,
            at: [x, y],
            place,
        });
    }
    add(
        card,
        deck,
        names,
        MeshKind::Nodes,
        "NSET",
        (first..deck.nodes.len()).collect(),
    )
}

fn elements(card: &Card<'_>, deck: &mut Deck, names: &mut Names) -> Result<(), Fault> {
    card.only(&["TYPE", "ELSET"])?;
    let name = card.required("TYPE")?;
    let kind = element_type(name).map_err(|why| Fault::new(card.place_of("TYPE"), why))?;
    let count = kind.cell.nodes();
    if matches!(kind.cell, CellKind::Triangle3 | CellKind::Quad4) {
        deck.remark(
            card.place_of("TYPE"),
            "elements with 3 and 4 nodes are fully integrated plane elements; CalculiX expands them to \
             three-dimensional elements, whose results differ by some percent on coarse meshes",
        );
    }
    let first = deck.elements.len();
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
        let number = label.whole("an element number")?;
        if words.len() != count + 1 {
            return Err(label.wrong(format!(
                "element {number} has {} nodes; type {} needs {count}",
                words.len() - 1,
                short(name)
            )));
        }
        let mut of = Vec::with_capacity(count);
        for word in &words[1..] {
            let node = word.whole("a node number")?;
            let known = names.nodes.get(&node).copied();
            of.push(known.ok_or_else(|| {
                word.wrong(format!("there is no node {node}; *NODE must come first"))
            })?);
        }
        let mut sorted = of.clone();
        sorted.sort_unstable();
        if sorted.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(label.wrong(format!(
                "element {number} has a repeated node; use a type with fewer nodes"
            )));
        }
        let place = label.place();
        if names.elements.insert(number, deck.elements.len()).is_some() {
            bail!(place, "element {number} is defined twice");
        }
        deck.elements.push(Element {
            label: number,
            kind,
            nodes: of,
            place,
        });
    }
    add(
        card,
        deck,
        names,
        MeshKind::Elements,
        "ELSET",
        (first..deck.elements.len()).collect(),
    )
}

/// Rejects unsupported element types.
pub(super) fn known_type(card: &Card<'_>) -> Result<(), Fault> {
    let kind = element_type(card.required("TYPE")?);
    kind.map(|_| ())
        .map_err(|why| Fault::new(card.place_of("TYPE"), why))
}

/// An element type by name, or why it is not supported.
fn element_type(name: &str) -> Result<ElementType, String> {
    const RIGHT: &str =
        "supported are CPE, CPS and CAX with 3, 4, 6, 8 and 8R, and B21, B22, B31, B31R, B32, B32R";
    let plane = |family: Family, rest: &str| {
        let (cell, reduced) = match rest {
            "3" => (CellKind::Triangle3, false),
            "4" => (CellKind::Quad4, false),
            "6" => (CellKind::Triangle6, false),
            "8" => (CellKind::Quad8, false),
            "8R" => (CellKind::Quad8, true),
            "4R" => {
                let full = name.trim_end_matches('R');
                return Err(format!(
                    "{name} has one integration point and needs hourglass stabilisation, which codes choose \
                     differently; use {full} or, better, {}8R",
                    full.trim_end_matches('4')
                ));
            }
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
        "B21" | "B31" | "B31R" => return beam(CellKind::Line2),
        "B22" | "B32" | "B32R" => return beam(CellKind::Line3),
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
        _ if name.starts_with("C3D") => "is a three-dimensional element",
        _ if name.starts_with('S') && name[1..].starts_with(|c: char| c.is_ascii_digit()) => {
            "is a shell element"
        }
        _ => "is not supported",
    };
    Err(format!("{} {why}; {RIGHT}", short(name)))
}

/// Kind of a set's members.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MeshKind {
    Nodes,
    Elements,
}

impl MeshKind {
    fn word(self) -> &'static str {
        match self {
            MeshKind::Nodes => "node",
            MeshKind::Elements => "element",
        }
    }
}

fn set(card: &Card<'_>, deck: &mut Deck, names: &mut Names, kind: MeshKind) -> Result<(), Fault> {
    let parameter = match kind {
        MeshKind::Nodes => "NSET",
        MeshKind::Elements => "ELSET",
    };
    card.only(&[parameter, "GENERATE", "UNSORTED", "INTERNAL"])?;
    card.required(parameter)?;
    let mut members = Vec::new();
    match card.has("GENERATE") {
        true => {
            for line in &card.lines {
                generated(&cells(*line), names, kind, &mut members)?;
            }
        }
        false => {
            for cell in card.cells().filter(|cell| !cell.text.is_empty()) {
                members.extend(members_of(&cell, deck, names, kind)?);
                names.count(0, cell.place())?;
                if members.len() > MEMBERS {
                    return Err(cell.wrong(format!("a set has more than {MEMBERS} members")));
                }
            }
        }
    }
    add(card, deck, names, kind, parameter, members)
}

/// Members generated from a first to a last number.
fn generated(
    words: &[CardCell<'_>],
    names: &Names,
    kind: MeshKind,
    members: &mut Vec<usize>,
) -> Result<(), Fault> {
    let Some(first) = words.first() else {
        return Ok(());
    };
    let Some(last) = words.get(1) else {
        return Err(first.wrong("GENERATE needs a first and a last number, and optionally a step"));
    };
    let from = first.whole("the first number")?;
    let to = last.whole("the last number")?;
    let by = match words.get(2) {
        Some(step) => step.whole("the step")?,
        None => 1,
    };
    if by == 0 || to < from {
        return Err(first.wrong(
            "the last number must not be below the first one, and the step must be at least 1",
        ));
    }
    if let Some(more) = words.get(3) {
        return Err(
            more.wrong("unexpected value; GENERATE takes a first number, a last number and a step")
        );
    }
    let labels = match kind {
        MeshKind::Nodes => &names.nodes,
        MeshKind::Elements => &names.elements,
    };
    let within = labels
        .range(from..=to)
        .filter(|(label, _)| (*label - from) % by == 0);
    members.extend(within.map(|(_, &position)| position));
    match members.len() <= MEMBERS {
        true => Ok(()),
        false => Err(first.wrong(format!("a set has more than {MEMBERS} members"))),
    }
}

/// Members that a word of a list refers to: one node or element by number, or a set by name.
pub(super) fn members_of(
    cell: &CardCell<'_>,
    deck: &Deck,
    names: &Names,
    kind: MeshKind,
) -> Result<Vec<usize>, Fault> {
    let word = kind.word();
    let (labels, sets, all) = match kind {
        MeshKind::Nodes => (&names.nodes, &names.node_sets, &deck.node_sets),
        MeshKind::Elements => (&names.elements, &names.element_sets, &deck.element_sets),
    };
    if let Ok(label) = cell.text.parse::<u64>() {
        let position = labels.get(&label).copied();
        let position = position.ok_or_else(|| cell.wrong(format!("there is no {word} {label}")))?;
        return Ok(vec![position]);
    }
    let name = plain(cell.text);
    match sets.get(&name) {
        Some(&set) => Ok(all[set].members.clone()),
        None => Err(cell.wrong(format!(
            "there is no {word} set {}; it must be defined first",
            short(&name)
        ))),
    }
}

/// Index of a set by name.
pub(super) fn set_of(
    name: &str,
    place: Place,
    names: &Names,
    kind: MeshKind,
) -> Result<usize, Fault> {
    let sets = match kind {
        MeshKind::Nodes => &names.node_sets,
        MeshKind::Elements => &names.element_sets,
    };
    let known = sets.get(name).copied();
    known.ok_or_else(|| {
        Fault::new(
            place,
            format!("there is no {} set {}", kind.word(), short(name)),
        )
    })
}

/// Index of a surface by name.
pub(super) fn surface_of(cell: &CardCell<'_>, names: &Names) -> Result<usize, Fault> {
    let name = plain(cell.text);
    let known = names.surfaces.get(&name).copied();
    known.ok_or_else(|| {
        cell.wrong(format!(
            "there is no surface {}; *SURFACE, NAME=... defines one",
            short(&name)
        ))
    })
}

/// Adds members to the set named by a parameter, if the card has it.
fn add(
    card: &Card<'_>,
    deck: &mut Deck,
    names: &mut Names,
    kind: MeshKind,
    parameter: &str,
    members: Vec<usize>,
) -> Result<(), Fault> {
    let Some(name) = card.value(parameter)? else {
        return Ok(());
    };
    let place = card.place_of(parameter);
    if name.chars().all(|c| c.is_ascii_digit()) {
        bail!(
            place,
            "the set name {} looks like a number; start it with a letter",
            short(name)
        );
    }
    let (sets, all) = match kind {
        MeshKind::Nodes => (&mut names.node_sets, &mut deck.node_sets),
        MeshKind::Elements => (&mut names.element_sets, &mut deck.element_sets),
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
    names.count(more, place)
}

fn surface(card: &Card<'_>, deck: &mut Deck, names: &mut Names) -> Result<(), Fault> {
    card.only(&["NAME", "TYPE", "INTERNAL"])?;
    let name = card.required("NAME")?.to_owned();
    let of = match card.choice("TYPE", &["ELEMENT", "NODE"])? {
        0 => Faces::Elements(sides(card, deck, names)?),
        _ => {
            let mut members = Vec::new();
            for line in &card.lines {
                if let Some(cell) = cells(*line).first() {
                    members.extend(members_of(cell, deck, names, MeshKind::Nodes)?);
                    if members.len() > MEMBERS {
                        return Err(
                            cell.wrong(format!("a surface has more than {MEMBERS} members"))
                        );
                    }
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
        return Err(card.wrong(format!("the surface {} is empty", short(&name))));
    }
    names.count(count, card.place)?;
    if names
        .surfaces
        .insert(name.clone(), deck.surfaces.len())
        .is_some()
    {
        return Err(card.wrong(format!("the surface {} is defined twice", short(&name))));
    }
    deck.surfaces.push(Surface {
        name,
        of,
        place: card.place,
    });
    Ok(())
}

/// The distinct values, in the order of their first occurrence.
fn once<T: Copy + Eq + std::hash::Hash>(members: Vec<T>) -> Vec<T> {
    let mut seen = std::collections::HashSet::new();
    members
        .into_iter()
        .filter(|member| seen.insert(*member))
        .collect()
}

fn sides(card: &Card<'_>, deck: &Deck, names: &Names) -> Result<Vec<(usize, usize)>, Fault> {
    let mut sides = Vec::new();
    for line in &card.lines {
        let words = cells(*line);
        let Some(first) = words.first() else {
            continue;
        };
        let Some(label) = words.get(1) else {
            return Err(
                first.wrong("the side is missing; write the element and the side, e.g. \"12, S2\"")
            );
        };
        for element in members_of(first, deck, names, MeshKind::Elements)? {
            sides.push((element, side_of(label, 'S', &deck.elements[element])?));
        }
        if sides.len() > MEMBERS {
            return Err(first.wrong(format!("a surface has more than {MEMBERS} members")));
        }
    }
    Ok(once(sides))
}

/// Index of a side of an element, given by a letter and its number from 1.
pub(super) fn side_of(
    cell: &CardCell<'_>,
    letter: char,
    element: &Element,
) -> Result<usize, Fault> {
    let most = match element.kind.cell {
        CellKind::Triangle3 | CellKind::Triangle6 => 3,
        CellKind::Quad4 | CellKind::Quad8 => 4,
        _ => {
            return Err(cell.wrong(format!(
                "element {} is a beam and has no sides; use its nodes instead, with TYPE=NODE",
                element.label
            )));
        }
    };
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
