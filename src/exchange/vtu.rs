//! Writes results for ParaView: VTK unstructured grids (.vtu), and collections of them over time (.pvd).
//!
//! Both are XML. Arrays are base64-encoded: their length in bytes (64 bits), then their little-endian numbers, so all values are
//! exact (VTK file formats, "XML file formats", uncompressed binary data).

use crate::mesh::{Cell, CellKind};
use CellKind::*;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use std::fmt::Write;

/// The numbers of an array.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// 64-bit floating-point numbers; NaN for missing values.
    Numbers(Vec<f64>),
    /// Integers.
    Wholes(Vec<i32>),
    /// A UTF-8 text as bytes, because readers other than VTK do not support arrays of texts.
    Text(String),
}

/// An array.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Name.
    pub name: String,
    /// Name of each component; empty for one component without a name. VTK's order for a symmetric tensor is XX, YY, ZZ, XY, YZ,
    /// XZ.
    pub components: &'static [&'static str],
    /// All components of the first point (or cell), then of the next.
    pub values: Values,
}

impl Array {
    /// An array with one component.
    pub fn new(name: &str, values: Values) -> Array {
        Array {
            name: name.to_owned(),
            components: &[],
            values,
        }
    }
}

/// A grid with data.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grid {
    /// Positions of the points.
    pub points: Vec<[f64; 3]>,
    /// Lines and elements between the points.
    pub cells: Vec<Cell>,
    /// Arrays with one entry per point.
    pub on_points: Vec<Array>,
    /// Arrays with one entry per cell.
    pub on_cells: Vec<Array>,
    /// Data of the whole grid. ParaView uses `TimeValue` as the time.
    pub fields: Vec<Array>,
}

/// VTK's number for a kind of cell.
pub fn cell_type(kind: CellKind) -> u8 {
    match kind {
        Point => 1,
        Line2 => 3,
        Line3 => 21,
        Triangle3 => 5,
        Triangle6 => 22,
        Quad4 => 9,
        Quad8 => 23,
        Quad9 => 28,
        Tetra4 => 10,
        Tetra10 => 24,
        Wedge6 => 13,
        Wedge15 => 26,
        Hexa8 => 12,
        Hexa20 => 25,
    }
}

/// The file of a grid.
pub fn write(grid: &Grid) -> String {
    let mut text = head("UnstructuredGrid", " header_type=\"UInt64\"");
    text.push_str("  <UnstructuredGrid>\n");
    section(&mut text, "FieldData", &grid.fields, true);
    let (points, cells) = (grid.points.len(), grid.cells.len());
    let _ = writeln!(
        text,
        "    <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">"
    );
    text.push_str("      <Points>\n");
    data(
        &mut text,
        "type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"",
        floats(grid.points.iter().flatten().copied()),
    );
    text.push_str("      </Points>\n      <Cells>\n");
    let corners = grid.cells.iter().flat_map(|cell| &cell.nodes);
    data(
        &mut text,
        "type=\"Int64\" Name=\"connectivity\"",
        longs(corners.copied()),
    );
    let mut end = 0;
    let ends = grid.cells.iter().map(|cell| {
        end += cell.nodes.len();
        end
    });
    data(&mut text, "type=\"Int64\" Name=\"offsets\"", longs(ends));
    let kinds = grid.cells.iter().map(|cell| cell_type(cell.kind));
    data(&mut text, "type=\"UInt8\" Name=\"types\"", kinds.collect());
    text.push_str("      </Cells>\n");
    section(&mut text, "PointData", &grid.on_points, false);
    section(&mut text, "CellData", &grid.on_cells, false);
    text.push_str("    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n");
    text
}

/// The file of a collection: the time and the path of each grid's file, relative to the collection.
pub fn collection(files: &[(f64, String)]) -> String {
    let mut text = head("Collection", "");
    text.push_str("  <Collection>\n");
    for (time, file) in files {
        let file = escaped(file);
        let _ = writeln!(
            text,
            "    <DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>"
        );
    }
    text.push_str("  </Collection>\n</VTKFile>\n");
    text
}

fn head(kind: &str, more: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\"{more}>\n"
    )
}

/// Arrays of one section; field arrays also declare their length.
fn section(text: &mut String, name: &str, arrays: &[Array], whole: bool) {
    let _ = writeln!(text, "    <{name}>");
    for array in arrays {
        let (kind, bytes, length) = match &array.values {
            Values::Numbers(values) => ("Float64", floats(values.iter().copied()), values.len()),
            Values::Wholes(values) => (
                "Int32",
                values.iter().flat_map(|v| v.to_le_bytes()).collect(),
                values.len(),
            ),
            Values::Text(text) => ("UInt8", text.as_bytes().to_vec(), text.len()),
        };
        let mut about = format!("type=\"{kind}\" Name=\"{}\"", escaped(&array.name));
        let count = array.components.len();
        if count > 0 {
            let _ = write!(about, " NumberOfComponents=\"{count}\"");
        }
        for (k, component) in array.components.iter().enumerate() {
            let _ = write!(about, " ComponentName{k}=\"{component}\"");
        }
        if whole {
            let _ = write!(about, " NumberOfTuples=\"{}\"", length / count.max(1));
        }
        data(text, &about, bytes);
    }
    let _ = writeln!(text, "    </{name}>");
}

fn data(text: &mut String, about: &str, bytes: Vec<u8>) {
    let mut whole = (bytes.len() as u64).to_le_bytes().to_vec();
    whole.extend(bytes);
    let _ = write!(text, "        <DataArray {about} format=\"binary\">");
    BASE64_STANDARD.encode_string(&whole, text);
    text.push_str("</DataArray>\n");
}

fn floats(values: impl Iterator<Item = f64>) -> Vec<u8> {
    values.flat_map(f64::to_le_bytes).collect()
}

fn longs(values: impl Iterator<Item = usize>) -> Vec<u8> {
    values
        .flat_map(|value| (value as i64).to_le_bytes())
        .collect()
}

/// Escapes a text for a quoted value; characters that XML does not allow become spaces.
fn escaped(text: &str) -> String {
    let mut shown = String::new();
    for c in text.chars() {
        match c {
            '&' => shown.push_str("&amp;"),
            '<' => shown.push_str("&lt;"),
            '>' => shown.push_str("&gt;"),
            '"' => shown.push_str("&quot;"),
            c if c.is_control() => shown.push(' '),
            c => shown.push(c),
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Finds the bytes of an array by name, as a reader would.
    fn array(text: &str, name: &str) -> Vec<u8> {
        let (_, rest) = text.split_once(&format!("Name=\"{name}\"")).unwrap();
        let (_, rest) = rest.split_once('>').unwrap();
        let (coded, _) = rest.split_once('<').unwrap();
        let bytes = BASE64_STANDARD.decode(coded).unwrap();
        let (length, data) = bytes.split_at(8);
        assert_eq!(
            u64::from_le_bytes(length.try_into().unwrap()),
            data.len() as u64
        );
        data.to_vec()
    }

    fn numbers(bytes: &[u8]) -> Vec<f64> {
        let words = bytes.chunks_exact(8);
        words
            .map(|word| f64::from_le_bytes(word.try_into().unwrap()))
            .collect()
    }

    #[test]
    fn a_grid_of_every_kind_of_cell_has_their_nodes_and_numbers() {
        let kinds = [
            (CellKind::Point, 1),
            (CellKind::Line2, 3),
            (CellKind::Line3, 21),
            (CellKind::Triangle3, 5),
            (CellKind::Triangle6, 22),
            (CellKind::Quad4, 9),
            (CellKind::Quad8, 23),
            (CellKind::Quad9, 28),
        ];
        let grid = Grid {
            points: vec![[0.5, -1.0, 0.0]; 9],
            cells: kinds
                .map(|(kind, _)| Cell {
                    kind,
                    nodes: (0..kind.nodes()).collect(),
                })
                .to_vec(),
            ..Grid::default()
        };
        let text = write(&grid);
        assert!(text.contains("NumberOfPoints=\"9\" NumberOfCells=\"8\""));
        assert_eq!(array(&text, "types"), kinds.map(|(_, number)| number));
        assert_eq!(numbers(&array(&text, "Points"))[..3], [0.5, -1.0, 0.0]);
        let ends = array(&text, "offsets");
        assert_eq!(
            ends.chunks_exact(8).map(|w| w[0]).collect::<Vec<_>>(),
            [1, 3, 6, 9, 15, 19, 27, 36]
        );
        assert_eq!(array(&text, "connectivity").len(), 36 * 8);
    }

    #[test]
    fn names_are_escaped() {
        let array = Array {
            name: "a<\"&\u{1b}>".to_owned(),
            components: &["X", "Y"],
            values: Values::Wholes(vec![1, -2]),
        };
        let text = write(&Grid {
            fields: vec![array],
            ..Grid::default()
        });
        assert!(text.contains(
            "Name=\"a&lt;&quot;&amp; &gt;\" NumberOfComponents=\"2\" ComponentName0=\"X\""
        ));
        assert!(text.contains("NumberOfTuples=\"1\""));
        let text = collection(&[(0.25, "a\"b.vtu".to_owned())]);
        assert!(text.contains("timestep=\"0.25\" part=\"0\" file=\"a&quot;b.vtu\""));
    }

    proptest! {
        #[test]
        fn every_number_is_exact(values in prop::collection::vec(any::<f64>(), 0..20), said in "\\PC{0,20}") {
            let grid = Grid {
                on_points: vec![Array::new("numbers", Values::Numbers(values.clone()))],
                fields: vec![Array::new("said", Values::Text(said.clone()))],
                ..Grid::default()
            };
            let text = write(&grid);
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&numbers(&array(&text, "numbers"))), bits(&values));
            prop_assert_eq!(String::from_utf8(array(&text, "said")).unwrap(), said);
        }
    }
}
