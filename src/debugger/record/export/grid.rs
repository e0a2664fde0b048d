//! A state for ParaView (`.vtu`): the undeformed mesh with displacements, stresses and contact quantities at
//! its nodes.
//!
//! | on nodes | |
//! | --- | --- |
//! | `node` | number of the node, from 1; its name is in that line of `node_names` |
//! | `displacement` | x, y and 0; "Warp By Vector" shows the deformed shape |
//! | `rotation` | of beams, anticlockwise (radians) |
//! | `stress` | Cauchy stress of solids as VTK orders it: XX, YY, ZZ, XY, YZ, XZ ([`recovery`]) |
//! | `contact_mode` | −1 no slave node, 0 free, 1 sliding, 2 fixed |
//! | `contact_force` | force on the slave node, x, y and 0; zero elsewhere |
//! | `F_n`, `F_t`, `T_max`, `gap`, `slip` | of slave nodes, as in the trace |
//! | `pressure`, `shear` | F_n and F_t by the area of the slave node; NaN where it has none |
//!
//! | on cells | |
//! | --- | --- |
//! | `body` | number of the body, from 1; 0 for the lines of surfaces |
//! | `surface` | number of the master surface, from 1; 0 for what is none |
//! | `rigid` | 1 for the lines of rigid surfaces |
//! | `stretch` | of solids: smallest principal stretch at the element's integration points |
//! | `det_F` | of solids: smallest det F at its integration points and nodes |
//!
//! Numbers that are not defined are NaN. The names are in `node_names`, `body_names` and `surface_names`: lines
//! of text stored as bytes, because only VTK's own reader supports arrays of text. Beam elements with more than
//! three nodes are written as lines from node to node, and so are surfaces.

use super::export_state::ExportState;
use crate::refusal::{Refusal, refusal};
use stickslip_core::fem::deformation;
use stickslip_core::fem::recovery::{self, Configuration};
use stickslip_core::{
    BodyKind, Component, ElementKind, Event, Mode, Model, Position, State, Stepper,
};
use stickslip_exchange::mesh::{Cell, CellKind};
use stickslip_exchange::vtu::{self, Array, Grid, Values};

const VECTOR: &[&str] = &["X", "Y", "Z"];
const TENSOR: &[&str] = &["XX", "YY", "ZZ", "XY", "YZ", "XZ"];

/// The contents of the file.
pub(super) fn vtu(shown: &ExportState, _: &mut Stepper) -> Result<Vec<u8>, Refusal> {
    let (at, load) = match shown.event {
        Some(event) => (event.position, event.load_factor),
        None => (shown.origin.at, shown.state.start.load_factor),
    };
    let grid = grid(&shown.scene.model, shown.state, shown.event, at, load)?;
    Ok(vtu::write(&grid).into_bytes())
}

/// The grid of a state; gaps come from the last minor iteration, if there is one.
///
/// # Errors
/// If VTK has no cell for a kind of element.
pub fn grid(
    model: &Model,
    state: &State,
    event: Option<&Event>,
    at: Position,
    load: f64,
) -> Result<Grid, Refusal> {
    let mut grid = Grid {
        points: (0..model.nodes.len())
            .map(|node| model.at_in_space(node))
            .collect(),
        ..Grid::default()
    };
    cells(model, &mut grid)?;
    deformations(model, state, &mut grid);
    motion(model, state, &mut grid);
    stresses(model, state, &mut grid);
    contacts(model, state, event, &mut grid);
    let whole = |name: &str, value: u32| {
        let value = i32::try_from(value).unwrap_or(i32::MAX);
        Array::new(name, Values::Wholes(vec![value]))
    };
    let lines = |name: &str, names: &mut dyn Iterator<Item = &String>| {
        let text = names.flat_map(|name| [name, "\n"]).collect();
        Array::new(name, Values::Text(text))
    };
    grid.fields = vec![
        Array::new("TimeValue", Values::Numbers(vec![load])),
        whole("increment", at.increment),
        whole("major", at.major),
        whole("minor", at.minor),
        lines("node_names", &mut model.nodes.iter().map(|n| &n.name)),
        lines("body_names", &mut model.bodies.iter().map(|b| &b.name)),
        lines("surface_names", &mut model.surfaces.iter().map(|s| &s.name)),
    ];
    Ok(grid)
}

/// Numbers on the nodes.
fn on_points(grid: &mut Grid, name: &str, components: &'static [&'static str], all: Vec<f64>) {
    grid.on_points.push(Array {
        components,
        ..Array::new(name, Values::Numbers(all))
    });
}

/// The cells of all bodies and surfaces, with their owners.
fn cells(model: &Model, grid: &mut Grid) -> Result<(), Refusal> {
    let (mut body, mut surface, mut rigid) = (Vec::new(), Vec::new(), Vec::new());
    let mut add = |grid: &mut Grid, cell: Cell, of: [i32; 3]| {
        grid.cells.push(cell);
        body.push(of[0]);
        surface.push(of[1]);
        rigid.push(of[2]);
    };
    for (number, one) in (1..).zip(&model.bodies) {
        match &one.kind {
            BodyKind::Solid(solid) => {
                for element in &solid.elements {
                    let kind = cell_kind(element.kind)?;
                    let nodes = element.nodes.clone();
                    add(grid, Cell { kind, nodes }, [number, 0, 0]);
                }
            }
            kind => {
                let mut lone: Vec<usize> = one.nodes.clone();
                for line in kind.lines() {
                    lone.retain(|node| !line.contains(node));
                    for cell in lines(line) {
                        add(grid, cell, [number, 0, 0]);
                    }
                }
                for node in lone {
                    let cell = Cell {
                        kind: CellKind::Point,
                        nodes: vec![node],
                    };
                    add(grid, cell, [number, 0, 0]);
                }
            }
        }
    }
    for (number, one) in (1..).zip(&model.surfaces) {
        for (place, element) in one.elements.iter().enumerate() {
            let nodes = match one.smooth.get(place) {
                Some(piece) => &element[piece.first..piece.first + 2],
                None => element,
            };
            for cell in lines(nodes) {
                add(grid, cell, [0, number, i32::from(one.rigid)]);
            }
        }
    }
    grid.on_cells = vec![
        Array::new("body", Values::Wholes(body)),
        Array::new("surface", Values::Wholes(surface)),
        Array::new("rigid", Values::Wholes(rigid)),
    ];
    Ok(())
}

/// Deformation of solid elements, one value per cell; the cells of bodies come first, in order.
fn deformations(model: &Model, state: &State, grid: &mut Grid) {
    if !model.has_solids() {
        return;
    }
    let mut numbers = [0, 1].map(|_| vec![f64::NAN; grid.cells.len()]);
    let found = deformation::by_element(model, &state.u);
    let found = found.iter().flatten();
    let of_line = |cell: &Cell| {
        matches!(
            cell.kind,
            CellKind::Line2 | CellKind::Line3 | CellKind::Point
        )
    };
    let places = (0..grid.cells.len()).filter(|&place| !of_line(&grid.cells[place]));
    for (place, measures) in places.zip(found) {
        for (list, value) in numbers.iter_mut().zip(measures) {
            list[place] = *value;
        }
    }
    for (name, values) in ["stretch", "det_F"].into_iter().zip(numbers) {
        grid.on_cells
            .push(Array::new(name, Values::Numbers(values)));
    }
}

/// The cell with the VTK type of a kind of element.
fn cell_kind(kind: ElementKind) -> Result<CellKind, Refusal> {
    use CellKind::*;
    [Triangle3, Triangle6, Quad4, Quad8, Quad9]
        .into_iter()
        .find(|&cell| vtu::cell_type(cell) == kind.vtk())
        .ok_or_else(|| refusal!(".vtu files have no cell for a {}", kind.word()))
}

/// The cells of a line through nodes in order.
fn lines(nodes: &[usize]) -> Vec<Cell> {
    if let &[one, middle, other] = nodes {
        return vec![Cell {
            kind: CellKind::Line3,
            nodes: vec![one, other, middle],
        }];
    }
    let pairs = nodes.windows(2).map(|pair| Cell {
        kind: CellKind::Line2,
        nodes: pair.to_vec(),
    });
    pairs.collect()
}

fn motion(model: &Model, state: &State, grid: &mut Grid) {
    let component = |node: usize, component: Component| {
        let known = node < model.dofs.count.len();
        let dof = known.then(|| model.dofs.dof(node, component))??;
        state.u.get(dof).copied()
    };
    let nodes = 0..model.nodes.len();
    let moved = |node: usize| {
        let of = |axis| component(node, axis).unwrap_or(0.0);
        match model.space {
            // The third degree of freedom is a displacement.
            Some(_) => [of(Component::X), of(Component::Y), of(Component::Rotation)],
            None => [of(Component::X), of(Component::Y), 0.0],
        }
    };
    let moved = nodes.clone().flat_map(moved).collect();
    let turned: Vec<Option<f64>> = nodes
        .map(|node| component(node, Component::Rotation).filter(|_| model.space.is_none()))
        .collect();
    let number = (1..).take(model.nodes.len()).collect();
    grid.on_points
        .push(Array::new("node", Values::Wholes(number)));
    on_points(grid, "displacement", VECTOR, moved);
    if turned.iter().any(Option::is_some) {
        let turned = turned
            .iter()
            .map(|angle| angle.unwrap_or(f64::NAN))
            .collect();
        on_points(grid, "rotation", &[], turned);
    }
}

fn stresses(model: &Model, state: &State, grid: &mut Grid) {
    if !model.has_solids() {
        return;
    }
    let known = recovery::nodal_stresses(
        model,
        Configuration {
            u: &state.u,
            before: &state.start.u,
            history: &state.start.history,
            load_factor: state.load_factor,
        },
    );
    let mut all = vec![f64::NAN; TENSOR.len() * model.nodes.len()];
    for (body, stresses) in model.bodies.iter().zip(known) {
        for (&node, stress) in body.nodes.iter().zip(stresses) {
            if let Some([xx, yy, zz, xy]) = stress {
                let place = TENSOR.len() * node;
                all[place..place + TENSOR.len()].copy_from_slice(&[xx, yy, zz, xy, 0.0, 0.0]);
            }
        }
    }
    on_points(grid, "stress", TENSOR, all);
}

/// Contact record of a slave node: mode, force, and F_n, F_t, T_max, gap and slip.
type ContactValues = (Mode, [f64; 3], [f64; 5]);

fn contacts(model: &Model, state: &State, event: Option<&Event>, grid: &mut Grid) {
    if model.contacts.is_empty() {
        return;
    }
    let nodes = model.nodes.len();
    let mut modes = vec![-1; nodes];
    let mut force = vec![0.0; VECTOR.len() * nodes];
    let names = ["F_n", "F_t", "T_max", "gap", "slip"];
    let mut numbers = names.map(|_| vec![f64::NAN; nodes]);
    for (place, contact) in model.contacts.iter().enumerate() {
        let record = match event {
            Some(event) if place < event.nodes.len() => of_record(state, event, place),
            _ => at_start(state, place),
        };
        let Some((mode, vector, values)) = record else {
            continue;
        };
        let node = contact.node;
        modes[node] = mode as i32;
        force[VECTOR.len() * node..][..3].copy_from_slice(&vector);
        for (list, value) in numbers.iter_mut().zip(values) {
            list[node] = value;
        }
    }
    grid.on_points
        .push(Array::new("contact_mode", Values::Wholes(modes)));
    on_points(grid, "contact_force", VECTOR, force);
    let by_area = [&numbers[0], &numbers[1]].map(|forces| {
        let mut stresses = vec![f64::NAN; nodes];
        for contact in &model.contacts {
            if let Some(area) = contact.area.filter(|area| *area > 0.0) {
                stresses[contact.node] = forces[contact.node] / area;
            }
        }
        stresses
    });
    let names = names.into_iter().chain(["pressure", "shear"]);
    for (name, values) in names.zip(numbers.into_iter().chain(by_area)) {
        on_points(grid, name, &[], values);
    }
}

/// The forces of an accepted state are components along its own directions, not along those frozen in its last minor iteration.
fn of_record(state: &State, event: &Event, place: usize) -> Option<ContactValues> {
    let record = event.nodes.get(place)?;
    let accepted = event.outcome.is_accepted() && event.frames.is_empty();
    let force = match state.nodes.get(place).filter(|_| accepted) {
        Some(node) => {
            let ([c, s], f_n, f_t) = (node.normal, record.f_n, record.f_t);
            [c * f_n - s * f_t, s * f_n + c * f_t, 0.0]
        }
        None => event.force(place)?,
    };
    let values = [
        record.f_n,
        record.f_t,
        record.t_max,
        record.gap,
        record.slip,
    ];
    Some((record.decision.before, force, values))
}

/// Before the first minor iteration the gap is unknown.
fn at_start(state: &State, place: usize) -> Option<ContactValues> {
    let node = state.nodes.get(place)?;
    let values = [node.f_n, node.f_t, node.t_max, f64::NAN, node.slip];
    let [x, y] = node.force();
    Some((node.mode, [x, y, 0.0], values))
}
