//! Tests with the four formats of one mesh, and with damaged files. `tests/peers/mesh.py --size 0.5` generates the files.

use super::*;
use crate::mesh::{Cell, CellKind, Group};
use proptest::prelude::*;

const FILES: [&[u8]; 4] = [
    include_bytes!("../../../tests/meshes/text22.msh"),
    include_bytes!("../../../tests/meshes/binary22.msh"),
    include_bytes!("../../../tests/meshes/text41.msh"),
    include_bytes!("../../../tests/meshes/binary41.msh"),
];

fn group<'m>(mesh: &'m Mesh, name: &str) -> Vec<&'m Cell> {
    let group = mesh.groups.iter().find(|group| group.name == name);
    group
        .unwrap()
        .cells
        .iter()
        .map(|&k| &mesh.cells[k])
        .collect()
}

#[test]
fn all_four_formats_give_the_same_mesh() {
    let [first, rest @ ..] = FILES.map(|file| read(file).unwrap());
    let names: Vec<&str> = first.groups.iter().map(|g| g.name.as_str()).collect();
    assert_eq!(names, ["bottom", "top", "arc", "flat", "block", "disc"]);
    let count = |name, kind| {
        let cells = group(&first, name);
        assert!(cells.iter().all(|cell| cell.kind == kind), "{name}");
        cells.len()
    };
    assert_eq!(count("block", CellKind::Quad8), 16);
    assert_eq!(
        (
            count("bottom", CellKind::Line3),
            count("top", CellKind::Line3)
        ),
        (8, 8)
    );
    assert!(count("disc", CellKind::Triangle6) > 10);
    let at = |n: usize| first.nodes[n];
    for cell in group(&first, "arc") {
        let [start, end, middle] = cell.nodes[..] else {
            panic!("{cell:?}")
        };
        for n in [start, end, middle] {
            assert!(((at(n)[0] - 2.0).hypot(at(n)[1] - 2.0) - 1.0).abs() < 1e-9);
        }
    }
    for mesh in rest {
        assert_eq!(mesh.labels, first.labels);
        let groups = |mesh: &Mesh| {
            let of = |g: &Group| {
                (
                    g.name.clone(),
                    group(mesh, &g.name)
                        .into_iter()
                        .cloned()
                        .collect::<Vec<_>>(),
                )
            };
            mesh.groups.iter().map(of).collect::<Vec<_>>()
        };
        assert_eq!(groups(&mesh), groups(&first));
        // Text files have 16 digits.
        for (a, b) in mesh.nodes.iter().zip(&first.nodes) {
            assert!((a[0] - b[0]).abs() <= 1e-15 * 4.0 && (a[1] - b[1]).abs() <= 1e-15 * 4.0);
        }
    }
}

/// A mesh of one triangle in version 2.2, with additional elements.
fn small(more: &str) -> String {
    let count = 1 + more.lines().count();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n10 0 0 0\n7 1 0 0\n30 0 1 0\n5 1 1 0\n$EndNodes\n\
         $Elements\n{count}\n1 2 2 0 6 10 7 30\n{more}\n$EndElements\n"
    )
}

fn broken(text: &str) -> (Option<(usize, usize)>, String) {
    let broken = read(text.as_bytes()).unwrap_err();
    (broken.at, broken.message)
}

#[test]
fn tags_may_have_gaps_and_any_order() {
    let mesh = read(small("").as_bytes()).unwrap();
    assert_eq!(mesh.labels, [10, 7, 30, 5]);
    assert_eq!(mesh.cells[0].nodes, [0, 1, 2]);
    // Without groups, each entity is one.
    assert_eq!(
        mesh.groups,
        [Group {
            name: "surface6".into(),
            cells: vec![0]
        }]
    );
}

#[test]
fn a_group_without_a_name_has_its_number_and_a_cell_in_two_groups_is_one_cell() {
    let mesh =
        read(small("2 2 2 3 1 5 30 7\n3 2 2 4 1 5 30 7\n4 1 2 9 2 10 7").as_bytes()).unwrap();
    assert_eq!(mesh.cells.len(), 3);
    let group = |name: &str, cells: &[usize]| Group {
        name: name.into(),
        cells: cells.to_vec(),
    };
    assert_eq!(
        mesh.groups,
        [
            group("surface3", &[1]),
            group("surface4", &[1]),
            group("line9", &[2])
        ]
    );
}

#[test]
fn the_other_byte_order_is_read_too() {
    let mut bytes = b"$MeshFormat\n2.2 1 8\n".to_vec();
    bytes.extend(1_i32.to_be_bytes());
    bytes.extend(b"\n$EndMeshFormat\n$Nodes\n3\n");
    for (tag, x, y) in [(1_i32, 0.0_f64, 0.0_f64), (2, 2.0, 0.0), (3, 0.0, 2.0)] {
        bytes.extend(tag.to_be_bytes());
        [x, y, 0.0]
            .iter()
            .for_each(|x| bytes.extend(x.to_be_bytes()));
    }
    bytes.extend(b"\n$EndNodes\n$Elements\n1\n");
    [2_i32, 1, 2, 1, 0, 5, 1, 2, 3]
        .iter()
        .for_each(|n| bytes.extend(n.to_be_bytes()));
    bytes.extend(b"\n$EndElements\n");
    let mesh = read(&bytes).unwrap();
    assert_eq!(mesh.nodes, [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]);
    assert_eq!(mesh.cells[0].nodes, [0, 1, 2]);
}

#[test]
fn unneeded_sections_are_skipped_and_parametric_nodes_are_read() {
    let text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Comments\n$Nodes are not here\n$EndComments\n\
                $Nodes\n1 3 1 3\n2 1 1 3\n1\n2\n3\n0 0 0 0.5 0.5\n1 0 0 1 0\n0 1 0 0 1\n$EndNodes\n\
                $Periodic\n1\n1 1 2\n$EndPeriodic\n$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n";
    let mesh = read(text.as_bytes()).unwrap();
    assert_eq!(mesh.nodes, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
}

#[test]
fn errors_have_a_position() {
    let cases = [
        ("$Mesh", "$MeshX", "1:1", "must begin with $MeshFormat"),
        ("2.2 0", "4.0 0", "2:1", "version 4"),
        (
            "$Nodes\n4",
            "$Nodes\n4000000000",
            "5:1",
            "4000000000 nodes are declared",
        ),
        ("7 1 0 0", "7 1 nan 0", "7:5", "finite"),
        (
            "7 1 0 0",
            "7 1 1,5 0",
            "7:5",
            "found \"1,5\" where y of a node was expected",
        ),
        ("7 1 0 0", "7 1 0 0.5", "7:1", "node 7 is at z = 0.5"),
        (
            "30 0 1 0",
            "7 0 1 0",
            "8:1",
            "node 7 occurs twice in the file",
        ),
        ("10 7 30", "10 7 31", "13:1", "refers to node 31"),
        (
            "1 2 2 0 6 10 7 30",
            "1 4 2 0 6 10 7 30 5",
            "13:3",
            "type 4 are solids; only plane",
        ),
        (
            "1 2 2 0 6 10 7 30",
            "1 21 2 0 6 10 7 30 5",
            "13:3",
            "type 21 are not supported, only those of first",
        ),
        (
            "1 2 2 0 6 10 7 30",
            "1 99 2 0 6 10 7 30 5",
            "13:3",
            "type 99",
        ),
        (
            "$EndElements\n",
            "",
            "",
            "the file ends before $EndElements",
        ),
        (
            "$EndNodes",
            "$Nodes",
            "10:1",
            "found \"$Nodes\" where $EndNodes was expected",
        ),
    ];
    for (old, new, place, told) in cases {
        let text = small("").replace("\n\n", "\n");
        assert!(text.contains(old), "{old}");
        let (at, message) = broken(&text.replacen(old, new, 1));
        assert!(message.contains(told), "{new}: {message}");
        if !place.is_empty() {
            let at = at.map(|(line, column)| format!("{line}:{column}"));
            assert_eq!(at.as_deref(), Some(place), "{new}: {message}");
        }
    }
}

#[test]
fn errors_in_binary_files_have_a_byte_offset() {
    let whole = FILES[1];
    let start = whole.windows(7).position(|w| w == b"$Nodes\n").unwrap();
    let cut = read(&whole[..start + 40]).unwrap_err();
    assert_eq!(cut.at, None);
    assert!(cut.message.starts_with("byte "), "{}", cut.message);
}

proptest! {
    #[test]
    fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), binary in any::<bool>(), four in any::<bool>()) {
        let _ = read(&bytes);
        let mut file = format!("$MeshFormat\n{} {} 8\n", if four { "4.1" } else { "2.2" }, u8::from(binary)).into_bytes();
        if binary {
            file.extend(1_i32.to_le_bytes());
        }
        file.extend(b"\n$EndMeshFormat\n");
        for section in ["$Entities\n", "$Nodes\n", "$Elements\n", ""] {
            let with = [file.as_slice(), section.as_bytes(), &bytes].concat();
            let _ = read(&with);
        }
    }

    #[test]
    fn truncated_and_changed_files_are_read_or_rejected(
        which in 0..4_usize,
        cut in 0.0..1.0_f64,
        changes in prop::collection::vec((0.0..1.0_f64, any::<u8>()), 0..8),
    ) {
        let mut bytes = FILES[which].to_vec();
        let place = |part: f64, length: usize| (part * length as f64) as usize;
        for (part, byte) in changes {
            let at = place(part, bytes.len());
            bytes[at] = byte;
        }
        let _ = read(&bytes);
        // A truncated file is always an error, unless only its last line feed is missing.
        bytes.truncate(place(cut, bytes.trim_ascii_end().len()));
        prop_assert!(read(&bytes).is_err());
    }
}
