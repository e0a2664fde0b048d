//! The mesh of an attached solver's scene, from the file that it names: its nodes, before those of the message, and what is drawn of
//! it. In space these are the outer faces of its solids and its areas; in the plane the edges of its elements.

use crate::deck::{self, outline};
use std::collections::HashMap;
use std::path::Path;
use stickslip_exchange::attach::message::{Components, NodeMessage, Scene};
use stickslip_exchange::inp::deck::Faces;
use stickslip_exchange::mesh::Cell;
use stickslip_exchange::vtu_reader;
use stickslip_platform::input;

/// Maximum size of a .vtu.
const BYTES: u64 = 256 << 20;

/// A mesh, with the faces of its named surfaces.
struct MeshFile {
    points: Vec<[f64; 3]>,
    /// Node numbers, if the file has them.
    labels: Vec<u64>,
    cells: Vec<Cell>,
    surfaces: Vec<(String, Vec<Vec<usize>>)>,
}

/// Replaces the name of a mesh file by its nodes and faces. A surface of the scene without nodes and faces gets those of the deck's
/// surface with this name. The working directory is that of the solver.
///
/// # Errors
/// Why the file cannot be used.
pub fn insert(scene: &mut Scene) -> Result<(), String> {
    let Some(name) = scene.mesh.take() else {
        return Ok(());
    };
    let mesh = read(&name).map_err(|why| format!("mesh: {why}"))?;
    let nodes = mesh.points.iter().enumerate().map(|(k, at)| NodeMessage {
        name: mesh.labels.get(k).map(u64::to_string).unwrap_or_default(),
        at: Some(match scene.dimension {
            3 => Components::Three(*at),
            _ => Components::Two([at[0], at[1]]),
        }),
    });
    scene.nodes = nodes.chain(scene.nodes.drain(..)).collect();
    let drawn = match scene.dimension {
        3 => &mut scene.faces,
        _ => &mut scene.lines,
    };
    drawn.extend(sides(&mesh.cells, scene.dimension == 3));
    for surface in &mut scene.surfaces {
        if surface.nodes.is_empty()
            && surface.faces.is_empty()
            && let Some((_, faces)) = mesh
                .surfaces
                .iter()
                .find(|(name, _)| name.eq_ignore_ascii_case(&surface.name))
        {
            surface.faces.clone_from(faces);
        }
    }
    Ok(())
}

fn read(name: &str) -> Result<MeshFile, String> {
    if deck::is_called_so(name) {
        let deck = outline(name).map_err(|error| error.to_string())?;
        let faces = |of: &Faces| match of {
            Faces::Elements(sides) => sides
                .iter()
                .map(|&(k, side)| deck.face(k, side).0)
                .collect(),
            Faces::Nodes(_) => Vec::new(),
        };
        let surfaces = deck.surfaces.iter();
        return Ok(MeshFile {
            surfaces: surfaces.map(|s| (s.name.clone(), faces(&s.of))).collect(),
            points: deck.nodes.iter().map(|node| node.at).collect(),
            labels: deck.nodes.iter().map(|node| node.label).collect(),
            cells: deck
                .elements
                .iter()
                .map(|e| Cell {
                    kind: e.kind.cell,
                    nodes: e.nodes.clone(),
                })
                .collect(),
        });
    }
    let path = Path::new(name);
    if !path
        .extension()
        .is_some_and(|it| it.eq_ignore_ascii_case("vtu"))
    {
        return Err(format!("{name}: expected a file .inp or .vtu"));
    }
    let text = input::text(path, BYTES, "a mesh is smaller").map_err(|error| error.of(name))?;
    let (points, cells) = vtu_reader::read(&text).map_err(|why| format!("{name}: {why}"))?;
    Ok(MeshFile {
        points,
        labels: Vec::new(),
        cells,
        surfaces: Vec::new(),
    })
}

/// The sides that only one cell has, by their corners, and areas themselves in space; every side once in the plane.
fn sides(cells: &[Cell], in_space: bool) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = Vec::new();
    let mut count: HashMap<Vec<usize>, usize> = HashMap::new();
    for cell in cells {
        let of = |side: &[usize]| side.iter().map(|&k| cell.nodes[k]).collect();
        let sides: Vec<Vec<usize>> = match (cell.kind.dimension(), in_space) {
            (3, true) | (2, false) => cell.kind.sides().into_iter().map(of).collect(),
            (2, true) => vec![cell.nodes[..cell.kind.corners()].to_vec()],
            _ => Vec::new(),
        };
        for side in sides {
            let times = count.entry(sorted(&side)).or_insert(0);
            *times += 1;
            if *times == 1 {
                all.push(side);
            }
        }
    }
    all.retain(|side| !in_space || count.get(&sorted(side)) == Some(&1));
    all
}

fn sorted(side: &[usize]) -> Vec<usize> {
    let mut side = side.to_vec();
    side.sort_unstable();
    side
}
