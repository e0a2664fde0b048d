//! Reads the mesh of a VTK unstructured grid (.vtu): points and cells, as text or as uncompressed base64 in place.

use crate::mesh::{Cell, CellKind};
use crate::vtu::cell_type;
use CellKind::*;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

/// The kinds of cells that are read.
const KINDS: [CellKind; 14] = [
    Point, Line2, Line3, Triangle3, Triangle6, Quad4, Quad8, Quad9, Tetra4, Tetra10, Wedge6,
    Wedge15, Hexa8, Hexa20,
];

/// Reads the points and cells of a grid.
///
/// # Errors
/// What is wrong or unsupported.
pub fn read(text: &str) -> Result<(Vec<[f64; 3]>, Vec<Cell>), String> {
    if !text.contains("type=\"UnstructuredGrid\"") {
        return Err("it is no VTK unstructured grid in XML".into());
    }
    if text.contains("compressor=\"") || text.contains("byte_order=\"BigEndian\"") {
        return Err("its arrays are compressed or big-endian; write it uncompressed".into());
    }
    let wide = text.contains("header_type=\"UInt64\"");
    let numbers = |part: &str, name: &str| {
        array(text, part, name, wide).map_err(|why| format!("array {name} of {part}: {why}"))
    };
    let points = numbers("Points", "")?;
    let points: Vec<[f64; 3]> = points.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    let corners = numbers("Cells", "connectivity")?;
    let (ends, types) = (numbers("Cells", "offsets")?, numbers("Cells", "types")?);
    let mut cells = Vec::with_capacity(types.len().min(ends.len()));
    let mut start = 0;
    for (end, number) in ends.iter().zip(&types) {
        let kind = KINDS
            .into_iter()
            .find(|&kind| f64::from(cell_type(kind)) == *number);
        let kind = kind.ok_or_else(|| format!("cells of VTK's type {number} are not read"))?;
        let nodes = corners.get(start..*end as usize).unwrap_or_default();
        let nodes: Vec<usize> = nodes.iter().map(|&node| node as usize).collect();
        if nodes.len() != kind.nodes() || nodes.iter().any(|&node| node >= points.len()) {
            return Err(format!(
                "cell {} has other nodes than its type",
                cells.len()
            ));
        }
        start = *end as usize;
        cells.push(Cell { kind, nodes });
    }
    Ok((points, cells))
}

/// The numbers of an array in a part of the file; the only one if it has no name.
fn array(text: &str, part: &str, name: &str, wide: bool) -> Result<Vec<f64>, String> {
    let within = |text: &str, from: &str, to: &str| {
        let rest = text.split_once(from)?.1;
        Some(rest.split_once(to)?.0.to_owned())
    };
    let part = within(text, &format!("<{part}>"), &format!("</{part}>"));
    let part = part.ok_or("it is missing")?;
    let wanted = format!("Name=\"{name}\"");
    let mut arrays = part
        .split("<DataArray")
        .skip(1)
        .filter_map(|array| array.split_once('>'));
    let found = arrays.find(|(about, _)| name.is_empty() || about.contains(&wanted));
    let (about, content) = found.ok_or("it is missing")?;
    let content = content.split('<').next().unwrap_or_default();
    let of = |key: &str| within(about, &format!("{key}=\""), "\"").unwrap_or_default();
    if of("format") == "ascii" {
        let words = content.split_ascii_whitespace();
        let numbers = words.map(|word| word.parse().map_err(|_| format!("{word:?} is no number")));
        return numbers.collect();
    }
    if of("format") != "binary" {
        return Err("only the formats ascii and binary are read".into());
    }
    let bytes = BASE64_STANDARD.decode(content.trim());
    let bytes = bytes.map_err(|error| error.to_string())?;
    let bytes = bytes.get(if wide { 8 } else { 4 }..).unwrap_or_default();
    /// The numbers of one type.
    macro_rules! numbers {
        ($type:ty) => {
            bytes
                .chunks_exact(size_of::<$type>())
                .filter_map(|each| Some(<$type>::from_le_bytes(each.try_into().ok()?) as f64))
                .collect()
        };
    }
    Ok(match of("type").as_str() {
        "Float32" => numbers!(f32),
        "Float64" => numbers!(f64),
        "Int8" => numbers!(i8),
        "UInt8" => numbers!(u8),
        "Int32" => numbers!(i32),
        "UInt32" => numbers!(u32),
        "Int64" => numbers!(i64),
        "UInt64" => numbers!(u64),
        other => return Err(format!("numbers of type {other:?} are not read")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vtu::{Grid, write};

    #[test]
    fn a_written_grid_is_read_again() {
        let points = vec![
            [0.0, 0.1, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1e-300],
        ];
        let cells = vec![
            Cell {
                kind: CellKind::Tetra4,
                nodes: vec![0, 1, 2, 3],
            },
            Cell {
                kind: CellKind::Line2,
                nodes: vec![3, 0],
            },
        ];
        let grid = Grid {
            points,
            cells,
            ..Grid::default()
        };
        let text = write(&grid);
        assert_eq!(read(&text), Ok((grid.points, grid.cells)));
        for (from, to, why) in [
            ("UnstructuredGrid", "PolyData", "no VTK unstructured grid"),
            (
                "version=",
                "compressor=\"vtkZLibDataCompressor\" version=",
                "compressed",
            ),
            (
                "Name=\"offsets\"",
                "Name=\"ends\"",
                "array offsets of Cells: it is missing",
            ),
            ("\"binary\"", "\"appended\"", "only the formats"),
        ] {
            let error = read(&text.replace(from, to)).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
        // No change makes it panic.
        for at in (0..text.len()).step_by(3) {
            let _ = read(&text[..at]);
            let _ = read(&[&text[..at], "9", &text[at + 1..]].concat());
        }
    }

    #[test]
    fn numbers_may_be_text() {
        let text = r#"<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece>
            <Points><DataArray type="Float32" NumberOfComponents="3" format="ascii"> 0 0 0  1 0 0
            </DataArray></Points>
            <Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1</DataArray>
            <DataArray type="Int64" Name="offsets" format="ascii">2</DataArray>
            <DataArray type="UInt8" Name="types" format="ascii">3</DataArray></Cells>"#;
        let line = Cell {
            kind: CellKind::Line2,
            nodes: vec![0, 1],
        };
        assert_eq!(
            read(text),
            Ok((vec![[0.0; 3], [1.0, 0.0, 0.0]], vec![line]))
        );
        let wrong = text.replace(">0 1<", ">0 7<");
        assert_eq!(
            read(&wrong),
            Err("cell 0 has other nodes than its type".into())
        );
    }
}
