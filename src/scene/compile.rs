//! From what the author wrote to what the solver uses: every reference resolved, every number checked.
//!
//! One function per section of the file, in the file's order; each refuses what makes no sense with a [`Fault`] that
//! has the path of the offending value.

use super::error::{Fault, Path, at, did_you_mean, quoted, some_of};
use super::geometry;
use super::limits;
use super::model::{
    Beam, Body, BodyKind, Dofs, Factor, Load, Model, Monitor, Prescribed, Slave, Surface, Watched,
};
use super::nodes::{Names, unique};
use super::spec::{
    BodySpec, Component, Friction, History, LoadSpec, Material, Nodes, Point, Quantity, Settings,
    SlaveSpec, Spec,
};
use std::collections::{HashMap, HashSet};

/// Checks a scene.
pub(crate) fn compile(spec: &Spec) -> Result<(Model, Names), Fault> {
    let names = Names::of(spec)?;
    materials(spec)?;
    let bodies = bodies(spec, &names)?;
    let mut on_body = vec![false; names.nodes.len()];
    bodies
        .iter()
        .flat_map(|body| &body.nodes)
        .for_each(|&n| on_body[n] = true);
    let length = geometry::diagonal(
        names
            .nodes
            .iter()
            .zip(&on_body)
            .filter(|(_, on)| **on)
            .map(|(node, _)| node),
    );
    check_bodies(spec, &names, &bodies, length)?;
    let mut surfaces = surfaces(spec, &names, length)?;
    let mut slaves = slaves(spec, &names, &surfaces, length)?;
    check_use(spec, &names, &on_body, &surfaces, &slaves)?;
    let mut layout = Layout::new(&on_body);
    layout.supports(spec, &names)?;
    let (loads, prescribed) = layout.loads(spec, &names)?;
    let mut bodies = bodies;
    let dofs = layout.number(&mut bodies);
    for surface in &mut surfaces {
        surface.rigid = surface
            .elements
            .iter()
            .flatten()
            .all(|&n| !can_move(&dofs, n));
    }
    check_held_slaves(spec, &names, &dofs, &surfaces, &slaves)?;
    history(&spec.history)?;
    settings(&spec.settings)?;
    let monitors = monitors(spec, &names, &on_body, &dofs, &slaves)?;
    slaves.shrink_to_fit();
    let model = Model {
        title: spec.title.clone(),
        about: spec.about.clone(),
        nodes: names.nodes.clone(),
        bodies,
        surfaces,
        slaves,
        dofs,
        loads,
        prescribed,
        path: spec.history.path.clone(),
        increment: spec.history.increment,
        settings: spec.settings,
        monitors,
        length,
    };
    Ok((model, names))
}

fn materials(spec: &Spec) -> Result<(), Fault> {
    unique("materials", spec.materials.iter().map(Material::id))?;
    for (k, material) in spec.materials.iter().enumerate() {
        let here = at!["materials", k];
        let Material::Section { EA, EI, GA, .. } = material;
        limits::stiffness(&here.then("EA"), *EA, "EA")?;
        limits::stiffness(&here.then("EI"), *EI, "EI")?;
        if let Some(ga) = GA {
            limits::stiffness(&here.then("GA"), *ga, "GA")?;
        }
    }
    Ok(())
}

fn bodies(spec: &Spec, names: &Names) -> Result<Vec<Body>, Fault> {
    if spec.bodies.is_empty() {
        return Err(Fault::new(
            at!["bodies"],
            "the scene has no body; nothing could deform",
        ));
    }
    unique("bodies", spec.bodies.iter().map(BodySpec::id))?;
    spec.bodies
        .iter()
        .enumerate()
        .map(|(k, body)| beam(k, body, spec, names))
        .collect()
}

fn beam(k: usize, body: &BodySpec, spec: &Spec, names: &Names) -> Result<Body, Fault> {
    let BodySpec::Beam {
        id,
        along,
        material,
    } = body;
    let here = at!["bodies", k];
    let chain = names
        .chain(along)
        .map_err(|message| Fault::new(here.then("along"), message))?;
    let ids = || spec.materials.iter().map(Material::id);
    let Some(section) = spec.materials.iter().find(|m| m.id() == material) else {
        let message = format!(
            "no material called {}{} (materials: {})",
            quoted(material),
            did_you_mean(material, ids()),
            some_of(ids())
        );
        return Err(Fault::new(here.then("material"), message));
    };
    let Material::Section { EA, EI, GA, .. } = section;
    let mut seen = HashSet::new();
    Ok(Body {
        name: id.clone(),
        nodes: chain
            .nodes
            .iter()
            .copied()
            .filter(|n| seen.insert(*n))
            .collect(),
        kind: BodyKind::Beam(Beam {
            elements: chain.elements(),
            ea: *EA,
            ei: *EI,
            ga: *GA,
            first_shear: None,
        }),
    })
}

/// Refuses bodies whose elements are no sound curves.
fn check_bodies(spec: &Spec, names: &Names, bodies: &[Body], length: f64) -> Result<(), Fault> {
    for (body, BodySpec::Beam { along, .. }) in bodies.iter().zip(&spec.bodies) {
        let BodyKind::Beam(beam) = &body.kind;
        check_chain(names, along, &beam.elements, length)?;
    }
    Ok(())
}

fn check_chain(
    names: &Names,
    along: &str,
    elements: &[Vec<usize>],
    length: f64,
) -> Result<(), Fault> {
    // The chain was found when the elements were made.
    let at = names
        .chain(along)
        .map_or_else(|_| at!["nodes"], |chain| at!["nodes", chain.at]);
    geometry::check_elements(&at, &names.nodes, elements, length)
}

fn surfaces(spec: &Spec, names: &Names, length: f64) -> Result<Vec<Surface>, Fault> {
    unique("surfaces", spec.surfaces.iter().map(|s| s.id.as_str()))?;
    let mut made = Vec::with_capacity(spec.surfaces.len());
    for (k, surface) in spec.surfaces.iter().enumerate() {
        let fault = |message| Fault::new(at!["surfaces", k, "along"], message);
        let mut elements = names.chain(&surface.along).map_err(fault)?.elements();
        check_chain(names, &surface.along, &elements, length)?;
        if surface.reverse {
            elements.reverse();
            elements.iter_mut().for_each(|element| element.reverse());
        }
        made.push(Surface {
            name: surface.id.clone(),
            elements,
            rigid: false,
        });
    }
    Ok(made)
}

fn slaves(
    spec: &Spec,
    names: &Names,
    surfaces: &[Surface],
    length: f64,
) -> Result<Vec<Slave>, Fault> {
    friction(&at!["friction"], &spec.friction)?;
    let members: Vec<HashSet<usize>> = surfaces
        .iter()
        .map(|surface| surface.elements.iter().flatten().copied().collect())
        .collect();
    let mut made = Vec::new();
    let mut taken = HashSet::new();
    for (k, group) in spec.slaves.iter().enumerate() {
        let here = at!["slaves", k];
        if let Some(own) = &group.friction {
            friction(&here.then("friction"), own)?;
        }
        let on = candidates(&here, group, surfaces)?;
        if group.nodes.is_empty() {
            return Err(Fault::new(
                here.then("nodes"),
                "the list is empty; name at least one slave node",
            ));
        }
        for (j, name) in group.nodes.iter().enumerate() {
            let fault = |message: String| Fault::new(here.then("nodes").then(j), message);
            for node in names.nodes(name).map_err(fault)? {
                let slave = Slave {
                    node,
                    surfaces: on.clone(),
                    friction: group.friction.unwrap_or(spec.friction),
                    start: group.start,
                };
                let fresh = taken.insert(node);
                check_slave(&slave, fresh, names, surfaces, &members, length).map_err(fault)?;
                made.push(slave);
                if made.len() > limits::SLAVES {
                    return Err(fault(format!("more than {} slave nodes", limits::SLAVES)));
                }
            }
        }
    }
    Ok(made)
}

/// Numbers of the surfaces that a group of slaves may touch.
fn candidates(here: &Path, group: &SlaveSpec, surfaces: &[Surface]) -> Result<Vec<usize>, Fault> {
    if group.on.is_empty() {
        return Err(Fault::new(
            here.then("on"),
            "the list is empty; name at least one surface",
        ));
    }
    let ids = || surfaces.iter().map(|s| s.name.as_str());
    let mut on = Vec::with_capacity(group.on.len());
    for (k, name) in group.on.iter().enumerate() {
        let fault = |message| Err(Fault::new(here.then("on").then(k), message));
        match surfaces.iter().position(|surface| surface.name == *name) {
            Some(surface) if on.contains(&surface) => {
                return fault(format!("surface {name:?} is named twice"));
            }
            Some(surface) => on.push(surface),
            None => {
                return fault(format!(
                    "no surface called {}{} (surfaces: {})",
                    quoted(name),
                    did_you_mean(name, ids()),
                    some_of(ids())
                ));
            }
        }
    }
    Ok(on)
}

/// Refuses a slave node that is named twice, lies on its own master, or is out of reach of it.
fn check_slave(
    slave: &Slave,
    fresh: bool,
    names: &Names,
    surfaces: &[Surface],
    members: &[HashSet<usize>],
    length: f64,
) -> Result<(), String> {
    let node = &names.nodes[slave.node];
    if !fresh {
        return Err(format!("node {:?} is a slave node already", node.name));
    }
    let mut least = f64::INFINITY;
    for &s in &slave.surfaces {
        if members[s].contains(&slave.node) {
            return Err(format!(
                "node {:?} is a node of the surface {:?} that it is to touch; a node cannot touch itself",
                node.name, surfaces[s].name
            ));
        }
        least = least.min(geometry::distance_up_to(
            length,
            node.at,
            &names.nodes,
            &surfaces[s].elements,
        ));
    }
    if least <= length {
        return Ok(());
    }
    let on: Vec<&str> = slave
        .surfaces
        .iter()
        .map(|&s| surfaces[s].name.as_str())
        .collect();
    Err(format!(
        "node {:?} at ({:?}, {:?}) is {least:.4} away from {}, farther than all bodies measure together ({length:.4}); \
         is it the right node, or the right surface?",
        node.name,
        node.at[0],
        node.at[1],
        on.join(" and ")
    ))
}

fn friction(here: &Path, friction: &Friction) -> Result<(), Fault> {
    let Friction { angle, cohesion } = *friction;
    if !(0.0..90.0).contains(&angle) {
        return Err(Fault::new(
            here.then("angle"),
            format!("the friction angle is {angle:?}; it must be at least 0 and below 90 degrees"),
        ));
    }
    limits::finite(&here.then("cohesion"), cohesion, "the cohesion")?;
    if cohesion < 0.0 {
        return Err(Fault::new(
            here.then("cohesion"),
            format!(
                "the cohesion is {cohesion:?}; it is a force per slave node and must not be negative"
            ),
        ));
    }
    Ok(())
}

/// Refuses nodes that nothing uses.
fn check_use(
    spec: &Spec,
    names: &Names,
    on_body: &[bool],
    surfaces: &[Surface],
    slaves: &[Slave],
) -> Result<(), Fault> {
    let mut used = on_body.to_vec();
    surfaces
        .iter()
        .flat_map(|s| s.elements.iter().flatten())
        .for_each(|&n| used[n] = true);
    slaves.iter().for_each(|s| used[s.node] = true);
    for entry in names.entries() {
        let shares = matches!(spec.nodes[entry.at], Nodes::Chain { .. });
        let idle = entry.nodes.iter().find(|&&n| !used[n]);
        if let (Some(&node), false) = (idle, shares) {
            let message = format!(
                "node {:?} is used by no body, no surface and no slaves; remove it or use it",
                names.nodes[node].name
            );
            return Err(Fault::new(at!["nodes", entry.at, "id"], message));
        }
    }
    Ok(())
}

fn can_move(dofs: &Dofs, node: usize) -> bool {
    [Component::X, Component::Y].iter().any(|c| {
        dofs.dof(node, *c)
            .is_some_and(|d| dofs.equation[d].is_some())
    })
}

/// Refuses slave nodes whose constraint would have no unknown at all.
fn check_held_slaves(
    spec: &Spec,
    names: &Names,
    dofs: &Dofs,
    surfaces: &[Surface],
    slaves: &[Slave],
) -> Result<(), Fault> {
    for slave in slaves.iter().filter(|slave| !can_move(dofs, slave.node)) {
        let Some(&rigid) = slave.surfaces.iter().find(|&&s| surfaces[s].rigid) else {
            continue;
        };
        let message = format!(
            "node {:?} cannot move, nor can the surface {:?}: its contact would have no unknown; \
             free one of them, or take the node off the list",
            names.nodes[slave.node].name, surfaces[rigid].name
        );
        return Err(Fault::new(slave_path(spec, names, slave.node), message));
    }
    Ok(())
}

/// The name in the file that made a node a slave.
fn slave_path(spec: &Spec, names: &Names, node: usize) -> Path {
    for (k, group) in spec.slaves.iter().enumerate() {
        for (j, name) in group.nodes.iter().enumerate() {
            if names.nodes(name).is_ok_and(|nodes| nodes.contains(&node)) {
                return at!["slaves", k, "nodes", j];
            }
        }
    }
    at!["slaves"]
}

/// The degrees of freedom while it is found out which are held, and by what.
struct Layout {
    dofs: Dofs,
    /// Node and component of each degree of freedom.
    of: Vec<(usize, Component)>,
    on_body: Vec<bool>,
    held: HashMap<usize, Path>,
}

const COMPONENTS: [Component; 3] = [Component::X, Component::Y, Component::Rotation];

impl Layout {
    fn new(on_body: &[bool]) -> Self {
        let mut dofs = Dofs::default();
        let mut of = Vec::new();
        for (node, &on) in on_body.iter().enumerate() {
            let count = if on { 3 } else { 2 };
            dofs.first.push(of.len());
            dofs.count.push(count);
            of.extend(COMPONENTS.iter().take(count.into()).map(|c| (node, *c)));
        }
        Layout {
            dofs,
            of,
            on_body: on_body.to_vec(),
            held: HashMap::new(),
        }
    }

    fn dof(&self, names: &Names, node: usize, component: Component) -> Result<usize, String> {
        self.dofs
            .dof(node, component)
            .ok_or_else(|| no_rotation(names, node))
    }

    fn supports(&mut self, spec: &Spec, names: &Names) -> Result<(), Fault> {
        for (k, support) in spec.supports.iter().enumerate() {
            let here = at!["supports", k];
            let nodes = names
                .nodes(&support.node)
                .map_err(|m| Fault::new(here.then("node"), m))?;
            if support.fix.is_empty() {
                let message = "the list is empty; it must hold some of x, y, rotation";
                return Err(Fault::new(here.then("fix"), message));
            }
            for (j, component) in support.fix.iter().enumerate() {
                let fault = |message| Fault::new(here.then("fix").then(j), message);
                if support.fix[..j].contains(component) {
                    return Err(fault(format!("{component} is named twice")));
                }
                for &node in &nodes {
                    let dof = self.dof(names, node, *component).map_err(fault)?;
                    self.held.insert(dof, here.clone());
                }
            }
        }
        Ok(())
    }

    /// Loads and prescribed displacements.
    fn loads(&mut self, spec: &Spec, names: &Names) -> Result<(Vec<Load>, Vec<Prescribed>), Fault> {
        let mut prescribed = Vec::new();
        // Prescribed displacements first: a force on one of them acts on nothing.
        for (k, load) in spec.loads.iter().enumerate() {
            if let LoadSpec::Displacement {
                node,
                component,
                value,
                scale,
            } = load
            {
                let here = at!["loads", k];
                let factor = factor(&here.then("scale"), scale)?;
                limits::finite(&here.then("value"), *value, "the prescribed value")?;
                for node in names
                    .nodes(node)
                    .map_err(|m| Fault::new(here.then("node"), m))?
                {
                    let dof = self.prescribe(&here, names, node, *component)?;
                    let scale = factor.clone();
                    prescribed.push(Prescribed {
                        dof,
                        value: *value,
                        scale,
                    });
                }
            }
        }
        prescribed.retain(|p| p.value != 0.0);
        let mut loads = Vec::new();
        for (k, load) in spec.loads.iter().enumerate() {
            let here = at!["loads", k];
            let (node, values, scale) = match load {
                LoadSpec::Force { node, x, y, scale } => (
                    node,
                    vec![(Component::X, "x", *x), (Component::Y, "y", *y)],
                    scale,
                ),
                LoadSpec::Moment { node, value, scale } => {
                    (node, vec![(Component::Rotation, "value", *value)], scale)
                }
                LoadSpec::Displacement { .. } => continue,
            };
            let node = names
                .node(node)
                .map_err(|m| Fault::new(here.then("node"), m))?;
            let scale = factor(&here.then("scale"), scale)?;
            for (component, field, value) in values {
                limits::finite(&here.then(field), value, "the load")?;
                let dof = self.loaded(&here, names, (node, component), (field, value))?;
                if value != 0.0 {
                    let scale = scale.clone();
                    loads.push(Load { dof, value, scale });
                }
            }
        }
        Ok((loads, prescribed))
    }

    fn prescribe(
        &mut self,
        here: &Path,
        names: &Names,
        node: usize,
        component: Component,
    ) -> Result<usize, Fault> {
        let fault = |message| Fault::new(here.then("component"), message);
        let dof = self.dof(names, node, component).map_err(fault)?;
        if let Some(other) = self.held.insert(dof, here.clone()) {
            let name = &names.nodes[node].name;
            return Err(fault(format!(
                "{component} of node {name:?} is held by {other} already"
            )));
        }
        Ok(dof)
    }

    /// The degree of freedom on which a load acts, if it can act there.
    fn loaded(
        &self,
        here: &Path,
        names: &Names,
        (node, component): (usize, Component),
        (field, value): (&str, f64),
    ) -> Result<usize, Fault> {
        let name = &names.nodes[node].name;
        if !self.on_body[node] {
            let message = format!("node {name:?} is on no body; a load there would act on nothing");
            return Err(Fault::new(here.then("node"), message));
        }
        let dof = self
            .dof(names, node, component)
            .map_err(|m| Fault::new(here.then("node"), m))?;
        match self.held.get(&dof) {
            Some(holder) if value != 0.0 => {
                let message = format!(
                    "{component} of node {name:?} is held by {holder}; a load there does nothing"
                );
                Err(Fault::new(here.then(field), message))
            }
            _ => Ok(dof),
        }
    }

    /// Numbers the equations node by node, then the shear forces of shear-rigid beams.
    fn number(mut self, bodies: &mut [Body]) -> Dofs {
        let dofs = &mut self.dofs;
        for (dof, (node, _)) in self.of.iter().enumerate() {
            let free = self.on_body[*node] && !self.held.contains_key(&dof);
            dofs.equation.push(free.then_some(dofs.equations));
            dofs.equations += usize::from(free);
        }
        for body in bodies {
            let BodyKind::Beam(beam) = &mut body.kind;
            if beam.ga.is_some() {
                continue;
            }
            beam.first_shear = Some(dofs.equation.len());
            let count: usize = beam.elements.iter().map(|element| element.len() - 1).sum();
            dofs.equation
                .extend((0..count).map(|k| Some(dofs.equations + k)));
            dofs.equations += count;
            dofs.shear += count;
        }
        self.dofs
    }
}

fn no_rotation(names: &Names, node: usize) -> String {
    format!(
        "node {:?} is on no beam and has no rotation, only x and y",
        names.nodes[node].name
    )
}

fn factor(here: &Path, scale: &[Point]) -> Result<Factor, Fault> {
    for (k, (x, y)) in scale.iter().enumerate() {
        let point = here.then(k);
        limits::finite(&point.then(0), *x, "the load factor")?;
        limits::finite(&point.then(1), *y, "the own factor")?;
        if k > 0 && *x <= scale[k - 1].0 {
            return Err(Fault::new(
                point.then(0),
                format!(
                    "the load factors of a scale must rise; {x:?} follows {:?}",
                    scale[k - 1].0
                ),
            ));
        }
    }
    Ok(Factor(scale.to_vec()))
}

fn history(history: &History) -> Result<(), Fault> {
    let History { path, increment } = history;
    let here = at!["history", "path"];
    if path.len() < 2 {
        let message = format!(
            "the path has {} corners; it needs two at least, as [0, 1]",
            path.len()
        );
        return Err(Fault::new(here, message));
    }
    for (k, corner) in path.iter().enumerate() {
        limits::finite(&here.then(k), *corner, "the load factor")?;
        if k > 0 && path[k - 1] == *corner {
            return Err(Fault::new(
                here.then(k),
                format!("the corner {corner:?} stands twice in a row"),
            ));
        }
    }
    let size = at!["history", "increment"];
    limits::finite(&size, *increment, "the increment")?;
    if *increment <= 0.0 {
        return Err(Fault::new(
            size,
            format!(
                "the increment is {increment:?}; it must be positive, also where the path falls"
            ),
        ));
    }
    let count = increments(path, *increment);
    if count > limits::INCREMENTS {
        return Err(Fault::new(
            size,
            format!(
                "the history would have {count:e} increments of {increment:?}; at most a million can be had"
            ),
        ));
    }
    Ok(())
}

/// Number of increments along a path: each leg is cut into whole ones, and what is left.
pub(crate) fn increments(path: &[f64], increment: f64) -> f64 {
    // A leg of ten tenths has ten increments, whatever the last bit of the sum says.
    const ROUNDING: f64 = 1e-9;
    let leg = |pair: &[f64]| {
        ((pair[1] - pair[0]).abs() / increment * (1.0 - ROUNDING))
            .ceil()
            .max(1.0)
    };
    path.windows(2).map(leg).sum()
}

fn settings(settings: &Settings) -> Result<(), Fault> {
    let here = at!["settings"];
    for (field, value) in [("minors", settings.minors), ("majors", settings.majors)] {
        let what = format!("the limit of {field}");
        limits::count(
            &here.then(field),
            value as usize,
            1..=limits::ITERATIONS as usize,
            &what,
        )?;
    }
    let tolerance = settings.tolerance;
    if tolerance > 0.0 && tolerance <= 1e-2 {
        return Ok(());
    }
    Err(Fault::new(
        here.then("tolerance"),
        format!("the tolerance is {tolerance:?}; it must be above 0 and at most 0.01"),
    ))
}

/// Columns that every CSV has.
const RESERVED: [&str; 4] = ["increment", "load", "majors", "minors"];

fn monitors(
    spec: &Spec,
    names: &Names,
    on_body: &[bool],
    dofs: &Dofs,
    slaves: &[Slave],
) -> Result<Vec<Monitor>, Fault> {
    let mut seen = HashMap::new();
    let mut made = Vec::with_capacity(spec.monitors.len());
    for (k, monitor) in spec.monitors.iter().enumerate() {
        let here = at!["monitors", k];
        let name = &monitor.name;
        monitor_name(name).map_err(|message| Fault::new(here.then("name"), message))?;
        if let Some(first) = seen.insert(name.as_str(), k) {
            let message = format!("the name {name:?} is taken already by monitors[{first}]");
            return Err(Fault::new(here.then("name"), message));
        }
        let of = watched(&here.then("of"), &monitor.of, names, on_body, dofs, slaves)?;
        made.push(Monitor {
            name: name.clone(),
            of,
        });
    }
    Ok(made)
}

fn monitor_name(name: &str) -> Result<(), String> {
    let shown = quoted(name);
    if name.is_empty() || name.chars().count() > limits::NAME {
        Err(format!(
            "the name {shown} must have 1 to {} characters",
            limits::NAME
        ))
    } else if name.contains([',', '"', '\''])
        || name.chars().any(char::is_control)
        || name.trim() != name
    {
        Err(format!(
            "the name {shown} heads a CSV column; it must be without commas, quotes, line breaks and outer blanks"
        ))
    } else if RESERVED.contains(&name) {
        Err(format!(
            "the name {shown} is a CSV column already, as are {}; take another",
            RESERVED.join(", ")
        ))
    } else {
        Ok(())
    }
}

fn watched(
    here: &Path,
    quantity: &Quantity,
    names: &Names,
    on_body: &[bool],
    dofs: &Dofs,
    slaves: &[Slave],
) -> Result<Watched, Fault> {
    let node_of = |name: &str| {
        names
            .node(name)
            .map_err(|message| Fault::new(here.then("node"), message))
    };
    let dof_of = |node, component| {
        let fault = || Fault::new(here.then("component"), no_rotation(names, node));
        dofs.dof(node, component).ok_or_else(fault)
    };
    match quantity {
        Quantity::Displacement { node, component } => Ok(Watched::Displacement {
            dof: dof_of(node_of(node)?, *component)?,
        }),
        Quantity::Reaction { node, component } => {
            let node = node_of(node)?;
            let dof = dof_of(node, *component)?;
            let name = &names.nodes[node].name;
            if !on_body[node] {
                let message = format!(
                    "node {name:?} is on no body and has no support force; a Contact monitor tells what acts on slaves"
                );
                return Err(Fault::new(here.then("node"), message));
            }
            if dofs.equation[dof].is_some() {
                let message = format!(
                    "{component} of node {name:?} is free and has no reaction; fix it in supports, or watch a Displacement"
                );
                return Err(Fault::new(here.then("component"), message));
            }
            Ok(Watched::Reaction { dof })
        }
        Quantity::Contact { node, component } => {
            let slaves = match node {
                Some(name) => vec![slave_number(here, name, node_of(name)?, names, slaves)?],
                None if slaves.is_empty() => {
                    return Err(Fault::new(
                        here.clone(),
                        "the scene has no slave nodes, and so no contact force",
                    ));
                }
                None => (0..slaves.len()).collect(),
            };
            Ok(Watched::Contact {
                slaves,
                axis: *component,
            })
        }
    }
}

fn slave_number(
    here: &Path,
    name: &str,
    node: usize,
    names: &Names,
    slaves: &[Slave],
) -> Result<usize, Fault> {
    slaves
        .iter()
        .position(|slave| slave.node == node)
        .ok_or_else(|| {
            let all = slaves
                .iter()
                .map(|slave| names.nodes[slave.node].name.as_str());
            Fault::new(
                here.then("node"),
                format!("node {name:?} is no slave node (slaves: {})", some_of(all)),
            )
        })
}
