//! The size and estimated cost of a scene and its unused features, for `stickslip check`.

use super::Scene;
use super::compile::increments;
use super::{gaps, limits};
use crate::format::error::some_of;
use crate::joined;
use crate::number::sig6;
use std::fmt;
use stickslip_core::groups::{distinct, marked};
use stickslip_core::model::{Beam, Form, Linear, LinearSolver};
use stickslip_core::words::is_default;
use stickslip_core::{
    Body, BodyKind, Elastic, ElementKind, Estimate, Model, Solid, Surface, Update, words,
};

/// Size and cost of a scene. Displayed as a table, so that users can check whether the scene is what they meant.
#[derive(Debug, Clone, PartialEq)]
pub struct Cost {
    /// Nodes, and how many of them are on bodies.
    pub nodes: (usize, usize),
    /// Unknown displacements in x and y.
    pub translations: usize,
    /// Unknown rotations.
    pub rotations: usize,
    /// Unknown shear forces of shear-rigid beams, one per Gauss point.
    pub shears: usize,
    /// Unknown forces on bodies given by a compliance.
    pub forces: usize,
    /// Unknown interface forces: a normal and a tangential one per slave node.
    pub interface: usize,
    /// Degrees of freedom restrained by supports or prescribed displacements.
    pub held: usize,
    /// One line per body.
    pub bodies: Vec<String>,
    /// One line per surface.
    pub surfaces: Vec<String>,
    /// Slave nodes, and how many of them start in each mode, as text.
    pub slaves: String,
    /// Summary of contact laws other than hard contact.
    pub laws: Vec<String>,
    /// Nodes on the axis of bodies of revolution that may leave it, as text.
    pub axis: Vec<String>,
    /// Range of the initial gaps, one line per surface.
    pub gaps: Vec<String>,
    /// Increments and their path.
    pub history: String,
    /// Estimated cost of each solver, the selected one first.
    pub solvers: Vec<String>,
    /// Features that the scene does not use and does not pay for.
    pub without: Vec<String>,
}

impl Cost {
    /// Computes the cost of a scene.
    pub fn from_scene(scene: &Scene) -> Cost {
        let model = &scene.model;
        let counted = |component: usize| {
            let dofs = &model.dofs;
            let of_node =
                |n: usize| (component < dofs.count[n] as usize).then(|| dofs.first[n] + component);
            (0..model.nodes.len())
                .filter_map(of_node)
                .filter(|&d| dofs.equation[d].is_some())
                .count()
        };
        let nodes = model.bodies.iter().flat_map(|body| &body.nodes);
        let on_body = marked(model.nodes.len(), nodes);
        let on_bodies = on_body.iter().filter(|on| **on).count();
        let of_bodies: usize = (0..model.nodes.len())
            .filter(|&n| on_body[n])
            .map(|n| usize::from(model.dofs.count[n]))
            .sum();
        let (translations, rotations) = (counted(0) + counted(1), counted(2));
        let forces = model.bodies.iter().map(own_forces).sum();
        Cost {
            nodes: (model.nodes.len(), on_bodies),
            translations,
            rotations,
            shears: model.dofs.inner - forces,
            forces,
            interface: 2 * model.contacts.len(),
            held: of_bodies - translations - rotations,
            bodies: model.bodies.iter().map(body_line).collect(),
            surfaces: model.surfaces.iter().map(surface_line).collect(),
            slaves: slaves_line(model),
            laws: super::bonds::words(scene),
            axis: axis_lines(model),
            gaps: gaps::words(model),
            history: history_line(model),
            solvers: solver_lines(model),
            without: without(model),
        }
    }

    /// All unknowns of a minor iteration, including interface forces.
    pub fn unknowns(&self) -> usize {
        self.translations + self.rotations + self.shears + self.forces + self.interface
    }
}

/// Unknown forces of a body given by a compliance.
fn own_forces(body: &Body) -> usize {
    match &body.kind {
        BodyKind::Linear(linear) if linear.form != Form::Stiffness => 2 * body.nodes.len(),
        _ => 0,
    }
}

fn body_line(body: &Body) -> String {
    match &body.kind {
        BodyKind::Beam(beam) => beam_line(&body.name, beam),
        BodyKind::Solid(solid) => solid_line(&body.name, solid),
        BodyKind::Truss(truss) => {
            let bars = words::counted(truss.bars.len(), "bar");
            let small = if truss.small {
                ", small displacements"
            } else {
                ""
            };
            format!("{}: truss, {bars}, EA {}{small}", body.name, sig6(truss.ea))
        }
        BodyKind::Linear(linear) => linear_line(body, linear),
    }
}

fn linear_line(body: &Body, linear: &Linear) -> String {
    let form = match linear.form {
        Form::Stiffness => "stiffness",
        Form::Compliance { .. } => "compliance",
    };
    let symmetric = if linear.is_symmetric() {
        "symmetric"
    } else {
        "unsymmetric"
    };
    format!(
        "{}: linear, {}, a {symmetric} {form} of {}",
        body.name,
        words::counted(body.nodes.len(), "node"),
        words::counted(linear.entries.len(), "entry")
    )
}

fn beam_line(name: &str, beam: &Beam) -> String {
    let per = beam.elements.first().map_or(0, Vec::len);
    let shear = match beam.ga {
        Some(ga) => format!("GA {}", sig6(ga)),
        None => "shear-rigid".to_owned(),
    };
    let elements = words::counted(beam.elements.len(), "element");
    format!(
        "{name}: beam, {elements} of {per} nodes, EA {}, EI {}, {shear}",
        sig6(beam.ea),
        sig6(beam.ei)
    )
}

fn solid_line(name: &str, solid: &Solid) -> String {
    use stickslip_core::model::{Law, Plane};
    let made_of = |m: &Elastic| {
        let law = match (m.law, m.update) {
            (Law::NeoHookean, _) => "neo-Hookean",
            (Law::Svk, Update::Total) => "St Venant-Kirchhoff",
            (Law::Svk, Update::Updated) => "updated Lagrangian",
            (Law::Svk, Update::Small) => "small strains",
        };
        let plane = match m.plane {
            Plane::Strain => format!("plane strain, thickness {}", m.thickness),
            Plane::Stress => format!("plane stress, thickness {}", m.thickness),
            Plane::Axisymmetric => "axisymmetric, forces of the whole circumference".to_owned(),
        };
        format!(
            "E {}, nu {}, {law}, {plane}",
            sig6(m.young),
            sig6(m.poisson)
        )
    };
    let materials = joined(solid.materials.iter().map(made_of), "; ");
    format!("{name}: solid, {}, {}", elements_of(solid), materials)
}

/// Number of elements of each kind.
fn elements_of(solid: &Solid) -> String {
    let of_kind = |kind: &ElementKind| {
        let count = solid.elements.iter().filter(|e| e.kind == *kind).count();
        (count > 0).then(|| {
            let elements = words::counted(count, "element");
            let word = if is_default(kind) {
                String::new()
            } else {
                format!(" ({})", kind.word())
            };
            format!("{elements} of {} nodes{word}", kind.nodes())
        })
    };
    let mut kinds = ElementKind::ALL.to_vec();
    for element in &solid.elements {
        if !kinds.contains(&element.kind) {
            kinds.push(element.kind);
        }
    }

    joined(kinds.iter().filter_map(of_kind), " and ")
}

fn surface_line(surface: &Surface) -> String {
    if !surface.smooth.is_empty() {
        let pieces = words::counted(surface.elements.len(), "piece");
        return format!(
            "{}: a smooth curve of {pieces}, {}",
            surface.name,
            kind(surface)
        );
    }
    let per = surface.elements.first().map_or(0, Vec::len);
    let elements = words::counted(surface.elements.len(), "interface element");
    format!(
        "{}: {elements} of {per} nodes, {}",
        surface.name,
        kind(surface)
    )
}

fn kind(surface: &Surface) -> &'static str {
    if surface.rigid {
        "rigid, no unknowns"
    } else {
        "deformable, moves with its body"
    }
}

fn slaves_line(model: &Model) -> String {
    use stickslip_core::model::Mode;
    let starts = |mode| {
        model
            .contacts
            .iter()
            .filter(|slave| slave.start == mode)
            .count()
    };
    let parts = joined(
        Mode::ALL
            .into_iter()
            .map(|mode| (starts(mode), mode.word()))
            .filter(|(n, _)| *n > 0)
            .map(|(n, w)| format!("{n} {w}")),
        ", ",
    );
    if parts.is_empty() {
        return words::counted(0, "node");
    }
    format!(
        "{}; start: {}",
        words::counted(model.contacts.len(), "node"),
        parts
    )
}

/// Nodes on the axis, x = 0, of bodies of revolution whose x is free. The equations bring x to 0 only in the limit of a fine
/// mesh.
fn axis_lines(model: &Model) -> Vec<String> {
    let round = model.bodies.iter().filter(|body| body.is_axisymmetric());
    let free = |node: &&usize| {
        let on_axis = model.nodes[**node].at[0].abs() <= limits::SHORTEST * model.length;
        on_axis && model.dofs.equation[model.dofs.first[**node]].is_some()
    };
    let nodes = distinct(round.flat_map(|body| body.nodes.iter().filter(free).copied()));
    if nodes.is_empty() {
        return Vec::new();
    }
    let names = some_of(nodes.iter().map(|&node| model.nodes[node].name.as_str()));
    vec![format!(
        "{} at x = 0 may move off the axis: {names}; to prevent it, support them with fix: [x]",
        words::counted(nodes.len(), "node")
    )]
}

fn history_line(model: &Model) -> String {
    let corners = joined(&model.path, " -> ");
    let count = increments(&model.path, |leg| model.on_leg(leg));
    let sizes: Vec<String> = match model.increments.as_slice() {
        [] => vec![model.increment.to_string()],
        of_legs => of_legs.iter().map(f64::to_string).collect(),
    };
    format!(
        "{} of at most {}, load factor {}",
        words::counted(count, "increment"),
        sizes.join(", "),
        corners
    )
}

/// Estimated cost of each solver, the selected one first.
fn solver_lines(model: &Model) -> Vec<String> {
    let estimate = Estimate::from_model(model);
    let chosen = estimate.with(model.settings.solver);
    if estimate.sparse.is_some() {
        return vec![format!("sparse, estimated: {}", chosen.0)];
    }
    let other = if chosen.1 == "condensed" {
        (estimate.augmented, "augmented")
    } else {
        (estimate.condensed, "condensed")
    };
    let auto = match model.settings.solver {
        LinearSolver::Auto => " (auto)",
        _ => "",
    };
    vec![
        format!("{}{auto}, estimated: {}", chosen.1, chosen.0),
        format!("not {}: {}", other.1, other.0),
    ]
}

/// Unused features, each with the input that would enable it.
fn without(model: &Model) -> Vec<String> {
    let mut lines = Vec::new();
    for body in &model.bodies {
        match &body.kind {
            BodyKind::Beam(beam) if beam.ga.is_none() => lines.push(format!(
                "shear deformation of {}: GA is not given",
                body.name
            )),
            BodyKind::Solid(solid) if solid.materials.iter().all(|m| m.update == Update::Total) => {
                lines.push(format!(
                    "memory of earlier increments in {}: update is total",
                    body.name
                ));
            }
            _ => {}
        }
    }
    for surface in model.surfaces.iter().filter(|surface| surface.rigid) {
        lines.push(format!("unknowns on surface {}: rigid", surface.name));
    }
    for (k, surface) in model.surfaces.iter().enumerate() {
        if !model
            .contacts
            .iter()
            .any(|slave| slave.surfaces.contains(&k))
        {
            lines.push(format!(
                "slave nodes on surface {}: nothing can touch it",
                surface.name
            ));
        }
    }
    let scene_wide = [
        (
            model.contacts.is_empty(),
            "contact: there are no slave nodes",
        ),
        (
            !model.contacts.is_empty()
                && model
                    .contacts
                    .iter()
                    .all(|slave| slave.friction.is_smooth()),
            "friction: angle and cohesion are 0",
        ),
        (
            model.contacts.iter().all(|s| s.friction.cohesion == 0.0)
                && !model.contacts.iter().all(|s| s.friction.is_smooth()),
            "cohesion: it is 0",
        ),
        (
            model.loads.is_empty() && model.pressures.is_empty(),
            "loads: there are no forces and moments",
        ),
        (
            model.prescribed.is_empty(),
            "prescribed displacements other than 0: there are none",
        ),
        (
            model.monitors.is_empty(),
            "monitors: --csv has only increment, load, majors, minors and jumped",
        ),
    ];
    lines.extend(
        scene_wide
            .into_iter()
            .filter(|(lacks, _)| *lacks)
            .map(|(_, line)| line.to_owned()),
    );
    lines
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "nodes              {:>8}   {} on bodies",
            self.nodes.0, self.nodes.1
        )?;
        writeln!(
            f,
            "unknowns           {:>8}   {} degrees of freedom are restrained",
            self.unknowns(),
            self.held
        )?;
        writeln!(f, "  translations     {:>8}", self.translations)?;
        writeln!(f, "  rotations        {:>8}", self.rotations)?;
        writeln!(f, "  shear forces     {:>8}", self.shears)?;
        if self.forces > 0 {
            writeln!(f, "  forces on bodies {:>8}", self.forces)?;
        }
        writeln!(f, "  interface forces {:>8}", self.interface)?;
        section(f, "bodies", &self.bodies)?;
        section(f, "surfaces", &self.surfaces)?;
        section(f, "slaves", std::slice::from_ref(&self.slaves))?;
        section(f, "laws", &self.laws)?;
        section(f, "axis", &self.axis)?;
        section(f, "gaps", &self.gaps)?;
        section(f, "history", std::slice::from_ref(&self.history))?;
        section(f, "solver", &self.solvers)?;
        section(f, "without", &self.without)
    }
}

fn section(f: &mut fmt::Formatter<'_>, title: &str, lines: &[String]) -> fmt::Result {
    for (k, line) in lines.iter().enumerate() {
        writeln!(f, "{:<9} {line}", if k == 0 { title } else { "" })?;
    }
    Ok(())
}
