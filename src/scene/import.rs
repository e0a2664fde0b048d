//! Imports meshes of other programs: converts them to given meshes of the scene.
//!
//! The file must be in the folder of the scene or below, so that a scene received from somebody else cannot read other files.
//! Groups keep their names where possible: points, @, quotes and backslashes become _, and a name that is a number or a reserved
//! word after an id (`all`, `start`, `end`) gets the prefix `surface`, `line` or `point`. Elements in no group form the part
//! `rest`; nodes without a cell are left out.

use super::limits;
use crate::format::error::{Fault, at, quoted, some_of};
use crate::format::given::{Cells, NodeSet, SideSet};
use crate::format::read;
use crate::format::spec::Nodes;
use crate::{SceneError, Spec};
use std::collections::HashMap;
use std::path::Path;
use stickslip_core::ElementKind;
use stickslip_core::groups::marked;
use stickslip_exchange::gmsh;
use stickslip_exchange::mesh::{Cell, CellKind, Mesh};
use stickslip_exchange::vtu::cell_type;
use stickslip_platform::input::{self, Unreadable};

/// Maximum size of a mesh file in bytes.
pub const MESH_BYTES: u64 = 512 << 20;
/// Name of the part with elements in no group.
const REST: &str = "rest";

/// Reads every mesh that a scene imports and adds it to the scene, whose file is `scene`; returns whether there are any. `place`
/// locates errors in the scene.
pub(super) fn resolve(
    spec: &mut Spec,
    scene: &str,
    place: impl Fn(Fault) -> SceneError,
) -> Result<bool, SceneError> {
    let mut any = false;
    for (k, nodes) in spec.nodes.iter_mut().enumerate() {
        if let Nodes::Import {
            id,
            file,
            reduced,
            scale,
        } = nodes
        {
            let wrong =
                |field: &str, message: String| place(Fault::new(at!["nodes", k, field], message));
            if !(scale.is_finite() && *scale > 0.0) {
                let message = format!("the scale is {scale:?}; it must be positive");
                return Err(wrong("scale", message));
            }
            let unread = |why: String| wrong("file", format!("{}: {why}", quoted(file)));
            let path = input::path_in_folder(Path::new(scene), file).map_err(unread)?;
            let bytes = bytes(&path).map_err(|why| unread(why.to_string()))?;
            let mesh = mesh(&path.to_string_lossy(), &bytes)?;
            let given = mesh_nodes(id, &mesh, *reduced, *scale);
            *nodes = given.map_err(|(field, message)| wrong(field, message))?;
            any = true;
        }
    }
    Ok(any)
}

fn bytes(file: &Path) -> Result<Vec<u8>, Unreadable> {
    input::bytes(file, MESH_BYTES, "meshes are limited to that size")
}

/// The mesh in the bytes of a file.
fn mesh(file: &str, bytes: &[u8]) -> Result<Mesh, SceneError> {
    gmsh::read(bytes).map_err(|broken| read::of_file(file, broken))
}

/// Parts of a mesh that share no elements and together form the bodies; earlier names take precedence.
///
/// # Errors
/// If the file contains no usable mesh.
pub fn bodies(file: &str) -> Result<Vec<String>, SceneError> {
    let bytes = bytes(Path::new(file)).map_err(|why| SceneError::whole(file, why.to_string()))?;
    let mesh = mesh(file, &bytes)?;
    let lists = elements(&mesh).map_err(|(_, message)| SceneError::whole(file, message))?;
    let names = |cells: &Cells| [std::slice::from_ref(&cells.part), &cells.also].concat();
    let mut chosen: Vec<String> = Vec::new();
    for cells in &lists {
        let part = &cells.part;
        let shares = |cells: &&Cells| {
            names(cells).contains(part) && names(cells).iter().any(|n| chosen.contains(n))
        };
        if !lists.iter().any(|cells| shares(&cells)) {
            chosen.push(part.clone());
        }
    }
    Ok(chosen)
}

/// Whether a file identifies itself as a mesh.
pub fn is_mesh(file: &str) -> bool {
    let start = input::start(Path::new(file), 64);
    start.is_ok_and(|start| gmsh::is_one(&start))
}

/// A mesh in the form of the scene; or the wrong field of the import, with the reason.
pub(crate) fn mesh_nodes(
    id: &str,
    mesh: &Mesh,
    reduced: bool,
    scale: f64,
) -> Result<Nodes, (&'static str, String)> {
    let label = |&n: &usize| mesh.labels[n] as usize;
    let used = mesh.cells.iter().flat_map(|cell| &cell.nodes);
    let used = marked(mesh.nodes.len(), used);
    let nodes = (0..mesh.nodes.len()).filter(|&n| used[n]).map(|n| {
        (
            label(&n),
            scale * mesh.nodes[n][0],
            scale * mesh.nodes[n][1],
        )
    });
    let mut lists = elements(mesh)?;
    if reduced {
        let mut any = false;
        for cells in &mut lists {
            if cells.kind == ElementKind::Quad8 {
                (cells.kind, any) = (ElementKind::Quad8Reduced, true);
            }
        }
        if !any {
            let message =
                "the mesh has no 8-node quadrilaterals, the only elements with reduced integration";
            return Err(("reduced", message.to_owned()));
        }
    }
    let groups = |dimension: u8| {
        mesh.groups
            .iter()
            .filter(move |group| mesh.cells[group.cells[0]].kind.dimension() == dimension)
    };
    let sets = groups(0).map(|group| NodeSet {
        name: usable(&group.name, 0),
        nodes: group
            .cells
            .iter()
            .map(|&k| label(&mesh.cells[k].nodes[0]))
            .collect(),
    });
    let sides = groups(1).map(|group| SideSet {
        name: usable(&group.name, 1),
        sides: group
            .cells
            .iter()
            .map(|&k| side(&mesh.cells[k], label))
            .collect(),
    });
    Ok(Nodes::Given {
        id: id.to_owned(),
        nodes: nodes.collect(),
        elements: lists,
        sets: sets.collect(),
        sides: sides.collect(),
    })
}

/// A side from start to end with its midside node, if any, between them.
fn side(cell: &Cell, label: impl Fn(&usize) -> usize) -> Vec<usize> {
    match cell.nodes[..] {
        [start, end, middle] => [start, middle, end].iter().map(label).collect(),
        _ => cell.nodes.iter().map(label).collect(),
    }
}

/// The element lists of a mesh: one per kind and combination of groups, ordered by their first elements.
fn elements(mesh: &Mesh) -> Result<Vec<Cells>, (&'static str, String)> {
    let mut groups_of: Vec<Vec<usize>> = vec![Vec::new(); mesh.cells.len()];
    for (k, group) in mesh.groups.iter().enumerate() {
        for &cell in &group.cells {
            groups_of[cell].push(k);
        }
    }
    let mut lists: Vec<Cells> = Vec::new();
    let mut place_of = HashMap::new();
    let mut last: Option<(ElementKind, &[usize], usize)> = None;
    for (cell, groups) in mesh.cells.iter().zip(&groups_of) {
        let Some(kind) = element_kind(cell.kind) else {
            continue;
        };
        // Elements of a group are usually consecutive.
        let place = match last {
            Some((other, same, place)) if other == kind && same == groups => place,
            _ => *place_of.entry((kind, groups)).or_insert(lists.len()),
        };
        last = Some((kind, groups, place));
        if place == lists.len() {
            let mut names = groups.iter().map(|&k| usable(&mesh.groups[k].name, 2));
            lists.push(Cells {
                part: names.next().unwrap_or_else(|| REST.to_owned()),
                also: names.collect(),
                kind,
                nodes: Vec::new(),
            });
        }
        let labels = cell.nodes.iter().map(|&n| mesh.labels[n] as usize);
        lists[place].nodes.push(labels.collect());
    }
    let has_rest = place_of.keys().any(|(_, groups)| groups.is_empty());
    if has_rest && mesh.groups.iter().any(|group| group.name == REST) {
        let message = "the mesh has elements in no group, which would form the part \"rest\", but it also has a group with that name";
        return Err(("file", message.to_owned()));
    }
    Ok(lists)
}

/// The kind of element with full integration for a cell; `None` for points and lines.
pub(crate) fn element_kind(cell: CellKind) -> Option<ElementKind> {
    ElementKind::ALL
        .into_iter()
        .find(|kind| kind.vtk() == cell_type(cell))
}

/// The name of a group, changed so that a scene can use it.
fn usable(name: &str, dimension: usize) -> String {
    let bad = |c: char| matches!(c, '.' | '@' | '"' | '\\') || c.is_control();
    let name: String = name
        .trim()
        .chars()
        .map(|c| if bad(c) { '_' } else { c })
        .collect();
    let taken = limits::TAKEN.contains(&name.as_str()) || name.chars().all(|c| c.is_ascii_digit());
    if taken {
        format!("{}{name}", ["point", "line", "surface"][dimension])
    } else {
        name
    }
}

/// The error for a mesh that is given as a scene.
pub(super) fn no_scene(file: &str) -> String {
    let bytes = bytes(Path::new(file)).unwrap_or_default();
    let groups = mesh(file, &bytes).map_or_else(|_| Vec::new(), |mesh| mesh.groups);
    format!(
        "this is a Gmsh mesh, not a scene; `stickslip export {file} -o SCENE.ron` writes a scene around it (groups: {})",
        some_of(groups.iter().map(|group| group.name.as_str()))
    )
}
