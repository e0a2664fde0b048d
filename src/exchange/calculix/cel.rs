//! `job.cel`: the contact elements of every iteration, written by `*CONTACT FILE` with CONTACT ELEMENTS.
//!
//! An element takes two lines: `*ELEMENT,TYPE=T,ELSET=contactelements_stS_inI_atA_itK`, and its number with its nodes. The set
//! contains step, increment, attempt and iteration. Types (CalculiX sources, gencontelem_n2f.f and gencontelem_f2f.f):
//!
//! - `C3D6`, nodes m2 s m3 m1 s m4: node to surface; the slave node s occurs twice, the m are a four-sided master face;
//! - `C3D4`, nodes m1 m2 m3 s: node to surface with a triangle;
//! - `C3D8`, nodes m1 m2 m3 m4 s2 s1 s4 s3: surface to surface, one element per integration point of the slave face in contact; a
//!   triangle repeats its last corner;
//! - `C3D6`, nodes m1 m2 m3 s2 s1 s3: surface to surface with two triangles.
//!
//! Iterations without contact elements are not in the file. Memory use is 12 bytes per slave node or face in contact and
//! iteration, independent of the number of integration points.

use super::Stop;
use super::lines::{Field, Lines, ResultLine};
use crate::FormatError;
use std::collections::HashMap;
use std::io::BufRead;
use std::ops::Range;

/// Position in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RunPosition {
    /// Step, from 1.
    pub step: u32,
    /// Increment of the step, from 1.
    pub increment: u32,
    /// Attempt at the increment, from 1; one more than the number of cuts.
    pub attempt: u32,
    /// Iteration of the attempt, from 1.
    pub iteration: u32,
}

/// A slave node, or a slave face given by its corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Slave {
    /// Node-to-surface contact.
    Node(u32),
    /// Surface-to-surface contact: the corners of the slave face, ascending; a triangle repeats its last corner.
    Face([u32; 4]),
}

impl Slave {
    /// The node, or the corners.
    pub fn nodes(&self) -> &[u32] {
        match self {
            Slave::Node(node) => std::slice::from_ref(node),
            Slave::Face(corners) => corners,
        }
    }
}

/// A slave in contact with a master face in an iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ClosedContact {
    /// Index into [`ContactElements::slaves`].
    pub slave: u32,
    /// Index into [`ContactElements::masters`].
    pub master: u32,
    /// Number of contact elements between the two: 1, or the number of integration points in contact.
    pub elements: u32,
}

/// Contents of a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ContactElements {
    /// Every slave node and face that was ever in contact, in file order.
    pub slaves: Vec<Slave>,
    /// Every master face that was ever touched: its corners, ascending; a triangle repeats its last corner.
    pub masters: Vec<[u32; 4]>,
    /// The iterations with contact elements, ascending, each with its range of `closed`.
    pub iterations: Vec<(RunPosition, Range<usize>)>,
    /// The closed contacts, iteration by iteration, each sorted by slave and master.
    pub closed: Vec<ClosedContact>,
    /// Where the file is truncated, if it is.
    pub stop: Option<Stop>,
}

/// Reads a file.
///
/// # Errors
/// If it cannot be read, a line is invalid, or its iterations are not in order.
pub fn read(from: impl BufRead) -> Result<ContactElements, FormatError> {
    let mut lines = Lines::new(from);
    let mut reader = CelReader::default();
    while let Some(line) = lines.next()? {
        if !line.whole {
            reader.found.stop = Some(Stop::Cut(line.number));
            break;
        }
        match line.bytes.first() {
            Some(b'*') if line.bytes.starts_with(b"**") => {}
            Some(b'*') => reader.header(line)?,
            _ => reader.data(line)?,
        }
    }
    Ok(reader.end())
}

/// The types of contact elements, and their numbers of nodes.
const TYPES: [(&str, usize); 3] = [("C3D4", 4), ("C3D6", 6), ("C3D8", 8)];
/// Maximum number of nodes.
const MOST: usize = 8;

/// State of the reader.
#[derive(Default)]
struct CelReader {
    found: ContactElements,
    slaves: HashMap<Slave, u32>,
    masters: HashMap<[u32; 4], u32>,
    /// The current iteration, and the number of nodes of its next element.
    now: Option<(RunPosition, usize)>,
    /// Number and nodes of the current element, and how many of them have been read.
    element: [u32; MOST + 1],
    read: usize,
    /// Line of the header of an incomplete element.
    open: Option<usize>,
}

impl CelReader {
    fn header(&mut self, line: ResultLine) -> Result<(), FormatError> {
        if self.open.is_some() {
            let message = format!(
                "a new element begins, but the previous one has only {} numbers",
                self.read
            );
            return Err(line.wrong(0, message));
        }
        let (at, nodes) = header(line)?;
        match self.now {
            Some((before, _)) if at < before => {
                let message =
                    "iterations must be in order in the .cel of one run; this one goes back";
                return Err(line.wrong(0, message));
            }
            Some((before, _)) if at == before => {}
            _ => {
                self.close();
                let end = self.found.closed.len();
                self.found.iterations.push((at, end..end));
            }
        }
        self.now = Some((at, nodes));
        (self.open, self.read) = (Some(line.number), 0);
        Ok(())
    }

    fn data(&mut self, line: ResultLine) -> Result<(), FormatError> {
        for field in line.fields() {
            let nodes = match (self.open, self.now) {
                (Some(_), Some((_, nodes))) => nodes,
                (None, Some(_)) => {
                    let message = "the element already has all its nodes; *ELEMENT should follow";
                    return Err(field.wrong(message));
                }
                _ => return Err(field.wrong(NO_CEL)),
            };
            self.element[self.read] = field.whole_number("node number")?;
            self.read += 1;
            if self.read == nodes + 1 {
                self.take(field)?;
            }
        }
        Ok(())
    }

    /// Adds the element that this field completes.
    fn take(&mut self, field: Field) -> Result<(), FormatError> {
        let nodes = &self.element[1..self.read];
        let (slave, master) = match *nodes {
            [a, b, c, s] => (Slave::Node(s), [a, b, c, c]),
            [b, s, c, a, t, d] if s == t => (Slave::Node(s), [a, b, c, d]),
            [a, b, c, s, t, u] => (Slave::Face(corners([s, t, u, u])), [a, b, c, c]),
            [a, b, c, d, s, t, u, v] => (Slave::Face(corners([s, t, u, v])), [a, b, c, d]),
            _ => return Err(field.wrong("no contact element has this number of nodes")),
        };
        let slave = number(&mut self.slaves, &mut self.found.slaves, slave);
        let master = number(&mut self.masters, &mut self.found.masters, corners(master));
        let begun = self
            .found
            .iterations
            .last()
            .map_or(0, |(_, range)| range.start);
        // Elements of one slave and one master are consecutive.
        let last = self.found.closed[begun..].last_mut();
        match last.filter(|closed| (closed.slave, closed.master) == (slave, master)) {
            Some(closed) => closed.elements = closed.elements.saturating_add(1),
            None => self.found.closed.push(ClosedContact {
                slave,
                master,
                elements: 1,
            }),
        }
        self.open = None;
        Ok(())
    }

    /// Finishes the current iteration: sorts its slaves, each master once.
    fn close(&mut self) {
        let closed = &mut self.found.closed;
        let Some((_, range)) = self.found.iterations.last_mut() else {
            return;
        };
        closed[range.start..].sort_unstable();
        let mut kept = range.start;
        for k in range.start..closed.len() {
            let next = closed[k];
            let same = kept > range.start
                && (closed[kept - 1].slave, closed[kept - 1].master) == (next.slave, next.master);
            if same {
                let elements = &mut closed[kept - 1].elements;
                *elements = elements.saturating_add(next.elements);
            } else {
                closed[kept] = next;
                kept += 1;
            }
        }
        closed.truncate(kept);
        range.end = kept;
    }

    fn end(mut self) -> ContactElements {
        self.close();
        self.found.stop = self.found.stop.or(self.open.map(Stop::Cut));
        self.found
    }
}

const NO_CEL: &str = "this is not a CalculiX .cel: it needs pairs of lines, \
    *ELEMENT,TYPE=C3D6,ELSET=contactelements_st1_in1_at1_it1 and the number of an element with \
    its nodes";

/// Index of a value in a list of distinct values; a new value is appended.
fn number<T: Copy + Eq + std::hash::Hash>(
    known: &mut HashMap<T, u32>,
    all: &mut Vec<T>,
    value: T,
) -> u32 {
    *known.entry(value).or_insert_with(|| {
        all.push(value);
        (all.len() - 1) as u32
    })
}

/// Canonical corners of a face: ascending, and a triangle repeats its last one.
fn corners(mut face: [u32; 4]) -> [u32; 4] {
    face.sort_unstable();
    if let Some(twice) = (0..3).find(|k| face[*k] == face[k + 1]) {
        face.copy_within(twice + 1.., twice);
        face[3] = face[2];
    }
    face
}

/// Parses a header: position in the run, and number of nodes of the element.
fn header(line: ResultLine) -> Result<(RunPosition, usize), FormatError> {
    let mut fields = line.fields();
    let first = fields.next().ok_or_else(|| line.ends_early(NO_CEL))?;
    if !first.bytes.eq_ignore_ascii_case(b"*ELEMENT") {
        return Err(first.wrong(NO_CEL));
    }
    let (mut nodes, mut at) = (None, None);
    for field in fields {
        let text = std::str::from_utf8(field.bytes).unwrap_or_default();
        let (name, value) = text.split_once('=').unwrap_or((text, ""));
        if name.eq_ignore_ascii_case("TYPE") {
            let kind = TYPES
                .iter()
                .find(|(kind, _)| kind.eq_ignore_ascii_case(value));
            let (_, count) = kind.ok_or_else(|| {
                field.wrong("contact elements must be of type C3D4, C3D6 or C3D8")
            })?;
            nodes = Some(*count);
        }
        if name.eq_ignore_ascii_case("ELSET") {
            let found = place(value).ok_or_else(|| {
                field.wrong(
                    "the set must be contactelements_stS_inI_atA_itK with four whole numbers",
                )
            })?;
            at = Some(found);
        }
    }
    let nodes = nodes.ok_or_else(|| line.ends_early("TYPE= is missing"))?;
    let at = at.ok_or_else(|| line.ends_early("ELSET= is missing"))?;
    Ok((at, nodes))
}

/// Parses the name of a set.
fn place(name: &str) -> Option<RunPosition> {
    let name = name.to_ascii_lowercase();
    let mut rest = name.strip_prefix("contactelements")?;
    let mut next = |tag: &str, last: bool| {
        rest = rest.strip_prefix(tag)?;
        let end = rest
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(rest.len());
        let (number, after) = rest.split_at(end);
        rest = after;
        (!last || after.is_empty()).then(|| number.parse().ok())?
    };
    Some(RunPosition {
        step: next("_st", false)?,
        increment: next("_in", false)?,
        attempt: next("_at", false)?,
        iteration: next("_it", true)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODES: &str = "*ELEMENT,TYPE=C3D6,ELSET=contactelements_st1_in1_at1_it1
        1001 ,        1008 ,           9 ,        1007 ,        1005 ,           9 ,        1006
*ELEMENT,TYPE=C3D6,ELSET=contactelements_st1_in1_at1_it1
        1002 ,        1008 ,           7 ,        1007 ,        1005 ,           7 ,        1006
*ELEMENT,TYPE=C3D4,ELSET=contactelements_st1_in1_at1_it2
        1003 , 3, 1, 2, 9
";

    /// Surface to surface: two faces and a triangle; the elements of one face are not consecutive.
    const FACES: &str = "*ELEMENT,TYPE=C3D8,ELSET=contactelements_st2_in3_at1_it1
27 , 1, 2, 3, 4, 12, 11, 14, 13
*ELEMENT,TYPE=C3D8,ELSET=contactelements_st2_in3_at1_it1
28 , 1, 2, 3, 3, 22, 21, 24, 23
*ELEMENT,TYPE=C3D8,ELSET=contactelements_st2_in3_at1_it1
29 , 4, 3, 2, 1, 12, 11, 14, 13
*ELEMENT,TYPE=C3D6,ELSET=contactelements_st2_in3_at1_it1
30 , 1, 2, 3, 32, 31, 33
*ELEMENT,TYPE=C3D8,ELSET=contactelements_st2_in3_at1_it1
31 , 1, 2, 3, 4, 32, 31, 33, 33
";

    fn refused(text: &str) -> String {
        let broken = read(text.as_bytes()).unwrap_err();
        let (line, column) = broken.at.unwrap();
        format!("{line}:{column}: {broken}")
    }

    #[test]
    fn slave_nodes_and_the_master_faces_that_they_touch() {
        let found = read(NODES.as_bytes()).unwrap();
        assert_eq!(found.slaves, [Slave::Node(9), Slave::Node(7)]);
        assert_eq!(found.masters, [[1005, 1006, 1007, 1008], [1, 2, 3, 3]]);
        let at = |iteration| RunPosition {
            step: 1,
            increment: 1,
            attempt: 1,
            iteration,
        };
        assert_eq!(found.iterations, [(at(1), 0..2), (at(2), 2..3)]);
        let of = |slave, master| ClosedContact {
            slave,
            master,
            elements: 1,
        };
        assert_eq!(found.closed, [of(0, 0), of(1, 0), of(0, 1)]);
        assert_eq!(found.stop, None);
    }

    #[test]
    fn integration_points_are_counted_by_slave_face_and_master_face() {
        let found = read(FACES.as_bytes()).unwrap();
        let faces = [[11, 12, 13, 14], [21, 22, 23, 24], [31, 32, 33, 33]];
        assert_eq!(found.slaves, faces.map(Slave::Face));
        assert_eq!(found.masters, [[1, 2, 3, 4], [1, 2, 3, 3]]);
        let told: Vec<_> = found
            .closed
            .iter()
            .map(|c| (c.slave, c.master, c.elements))
            .collect();
        assert_eq!(told, [(0, 0, 2), (1, 1, 1), (2, 0, 1), (2, 1, 1)]);
    }

    #[test]
    fn an_element_may_span_several_lines() {
        let text = NODES.replace("1005 ,", "1005 ,\n");
        assert_eq!(read(text.as_bytes()), read(NODES.as_bytes()));
    }

    #[test]
    fn a_truncated_file_is_read_up_to_its_end() {
        let lines = |count: usize| NODES.split_inclusive('\n').take(count).collect::<String>();
        for (text, closed, stop) in [
            (lines(4) + "*ELEM", 2, Some(Stop::Cut(5))),
            (lines(5), 2, Some(Stop::Cut(5))),
            (lines(3) + "1002 , 10", 1, Some(Stop::Cut(4))),
            (lines(4), 2, None),
            (String::new(), 0, None),
        ] {
            let found = read(text.as_bytes()).unwrap();
            assert_eq!((found.closed.len(), found.stop), (closed, stop), "{text}");
        }
    }

    #[test]
    fn errors_have_a_line_and_column() {
        let after = |text: &str| refused(&format!("{NODES}{text}\n"));
        for (told, wanted) in [
            (refused("hello\n"), "1:1: this is not a CalculiX .cel"),
            (after("*NODE"), "7:1: this is not a CalculiX .cel"),
            (after("1, 2"), "7:1: the element already has all its nodes"),
            (
                after("*ELEMENT,TYPE=C3D10,ELSET=contactelements_st1_in1_at1_it2"),
                "7:10: contact elements must be of type C3D4, C3D6 or C3D8",
            ),
            (
                after("*ELEMENT,TYPE=C3D4,ELSET=EALL"),
                "7:20: the set must be contactelements_stS_inI_atA_itK",
            ),
            (after("*ELEMENT,TYPE=C3D4"), "7:19: ELSET= is missing"),
            (
                after("*ELEMENT,TYPE=C3D4,ELSET=contactelements_st1_in1_at1_it1"),
                "7:1: iterations must be in order in the .cel of one run",
            ),
            (
                after("*ELEMENT,TYPE=C3D4,ELSET=contactelements_st1_in1_at1_it3\n1, 2, x, 4, 5"),
                "8:7: found 'x' where the node number, a whole number, was expected",
            ),
            (
                after(
                    "*ELEMENT,TYPE=C3D4,ELSET=contactelements_st1_in1_at1_it3\n1, 2, 99999999999",
                ),
                "8:7: found '99999999999' where",
            ),
            (
                after(
                    "*ELEMENT,TYPE=C3D4,ELSET=contactelements_st1_in1_at1_it3\n1, 2\n*ELEMENT,TYPE=C3D4",
                ),
                "9:1: a new element begins, but the previous one has only 2 numbers",
            ),
        ] {
            assert!(told.starts_with(wanted), "{told}\n{wanted}");
        }
    }
}
