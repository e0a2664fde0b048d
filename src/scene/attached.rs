//! Scenes sent by attached solvers: the scene is stored as a message of the protocol ([`stickslip_exchange::attach`]), and only
//! the solver knows the bodies behind the contacts.
//!
//! The model has the nodes, masters and contacts of the message, and one body without stiffness for drawing. The program's own
//! solver cannot solve it.

use super::limits;
use super::nodes::Names;
use crate::Spec;
use crate::format::contact_law::FrictionSpec;
use crate::format::error::{Fault, at, fault};
use crate::format::spec::History;
use crate::shown;
use std::collections::{HashMap, HashSet};
use stickslip_core::groups::distinct;
use stickslip_core::model::{Form, Linear, ReportedKind};
use stickslip_core::{
    Body, BodyKind, Bond, Contact, Control, Friction, Jumps, Model, Monitor, MonitorQuantity, Node,
    Surface,
};
use stickslip_exchange::attach::Answer;
use stickslip_exchange::attach::message::{self, Components, Scene};

/// Maximum number of nodes, and of contacts, in a solver's scene.
const MOST: usize = 1_000_000;
/// Name of the drawn body.
const SHAPE: &str = "shape";

/// The scene file for a solver's scene; `increment` is the first increment, if the solver sends one.
pub(super) fn spec(scene: &Scene, increment: Option<f64>) -> Spec {
    let [from, to] = scene.load.unwrap_or([0.0, 1.0]);
    let whole = (to - from).abs();
    let friction = scene
        .contacts
        .first()
        .map(|first| friction(&first.friction))
        .unwrap_or_default();
    let message = Answer::Scene(Box::new(scene.clone())).line();
    Spec {
        title: scene.title.clone(),
        about: scene.about.clone(),
        friction: FrictionSpec {
            angle: friction.angle,
            cohesion: friction.cohesion,
            adhesion: 0.0,
        },
        history: History {
            path: vec![from, to],
            increment: increment.unwrap_or(whole),
            ..History::default()
        },
        attached: Some(message.trim_end().to_owned()),
        ..Spec::default()
    }
}

/// Friction in the core's format.
pub fn friction(message: &message::Friction) -> Friction {
    let cohesion = message.cohesion;
    match (message.angle, message.mu) {
        (Some(angle), _) => Friction { angle, cohesion },
        (None, mu) => Friction::from_coefficient(mu.unwrap_or(0.0), cohesion),
    }
}

/// Reads the scene message in a scene file.
fn read_scene(text: &str) -> Result<Scene, Fault> {
    let here = at!["attached"];
    match Answer::read(text) {
        Ok(Answer::Scene(scene)) => Ok(*scene),
        Ok(other) => Err(fault!(
            here,
            "this is a {} message, not a scene",
            other.kind()
        )),
        Err(broken) => Err(Fault::new(here, broken.message)),
    }
}

/// Checks a scene sent by a solver.
pub(super) fn compile(spec: &Spec, text: &str) -> Result<(Model, Names), Fault> {
    let scene = read_scene(text)?;
    if !(2..=3).contains(&scene.dimension) {
        return refused("dimension: must be 2 or 3");
    }
    if scene.mesh.is_some() {
        return refused("mesh: only a running solver can name a file");
    }
    let nodes = nodes(&scene)?;
    let (surfaces, numbers) = surfaces(&scene)?;
    let contacts = contacts(&scene, &numbers)?;
    let bars = lines(&scene)?;
    let [from, to] = scene.load.unwrap_or([0.0, 1.0]);
    if !(from.is_finite() && to.is_finite() && from != to) {
        return refused("load: must be two different load factors, for example [0, 1]");
    }
    let touching = contacts.iter().map(|contact| contact.node);
    let of_body = distinct(bars.iter().flatten().copied().chain(touching));
    let named = |(number, monitor): (usize, &message::Monitor)| {
        let (name, kind) = match monitor {
            message::Monitor::Name(name) => (name, ReportedKind::Other),
            message::Monitor::Kind { name, kind } => (name, *kind),
        };
        Monitor {
            name: shown::line(name).into_owned(),
            of: MonitorQuantity::Reported { number, kind },
        }
    };
    let mut model = Model {
        about: shown::text(&scene.about).into_owned(),
        bodies: vec![Body {
            name: SHAPE.into(),
            nodes: of_body,
            kind: BodyKind::Linear(Linear {
                form: Form::Stiffness,
                entries: Vec::new(),
                bars,
            }),
        }],
        path: vec![from, to],
        increment: spec.history.increment,
        jumps: if scene.drag {
            Jumps::Dynamic
        } else {
            Jumps::default()
        },
        control: if scene.arc {
            Control::Arc
        } else {
            Control::Load
        },
        settings: spec.settings,
        monitors: scene.monitors.iter().enumerate().map(named).collect(),
        ..Model::from_contacts(&shown::line(&scene.title), nodes, surfaces, contacts)
    };
    if scene.dimension == 3 {
        model.raise(
            scene
                .nodes
                .iter()
                .map(|node| node.at.map_or(0.0, |at| at.in_space()[2]))
                .collect(),
        );
    }
    if !model.length.is_finite() {
        return refused("nodes: they are too far apart");
    }
    if !(model.increment.is_finite() && model.increment > 0.0) {
        return refused("the parameter increment: must be positive");
    }
    let names = Names::single(&model.nodes);
    Ok((model, names))
}

/// Contact law of a contact.
fn bond(contact: &message::Contact) -> Bond {
    match (contact.tied, contact.gives) {
        (true, _) => Bond::tied(),
        (false, Some(give)) => Bond::giving(give),
        (false, None) => Bond::Hard,
    }
}

fn refused<T>(message: impl Into<String>) -> Result<T, Fault> {
    Err(Fault::new(at!["attached"], message.into()))
}

fn nodes(scene: &Scene) -> Result<Vec<Node>, Fault> {
    if scene.nodes.len() > MOST || scene.contacts.len() > MOST {
        return refused(format!(
            "at most {MOST} nodes and {MOST} contacts are allowed"
        ));
    }
    let mut nodes: Vec<Node> = Vec::with_capacity(scene.nodes.len());
    // Nodes without a position are drawn in a row to the right of the others.
    let [low, high] = scene
        .nodes
        .iter()
        .filter_map(|node| Some(node.at?.in_space()[0]))
        .fold([0.0, 0.0_f64], |[low, high], x| [x.min(low), x.max(high)]);
    let step = if high > low { 0.1 * (high - low) } else { 1.0 };
    let mut last = high;
    for (k, node) in scene.nodes.iter().enumerate() {
        let at = node.at.unwrap_or_else(|| {
            last += step;
            match scene.dimension {
                3 => Components::Three([last, 0.0, 0.0]),
                _ => Components::Two([last, 0.0]),
            }
        });
        let all = at.as_slice();
        if all.len() != scene.dimension || !all.iter().all(|x| x.is_finite()) {
            let numbers = match scene.dimension {
                3 => "three finite numbers",
                _ => "two finite numbers, or three with \"dimension\":3",
            };
            return refused(format!("nodes[{k}].at: a position must be {numbers}"));
        }
        let name = match node.name.as_str() {
            "" => format!("node.{}", k + 1),
            name => shown::cut(name, limits::NAME),
        };
        let [x, y, _] = at.in_space();
        nodes.push(Node { name, at: [x, y] });
    }
    // A contact may have a different name than its node.
    for contact in scene
        .contacts
        .iter()
        .filter(|contact| !contact.name.is_empty())
    {
        if let Some(node) = nodes.get_mut(contact.node) {
            node.name = shown::cut(&contact.name, limits::NAME);
        }
    }
    let mut names = HashSet::new();
    for (k, node) in nodes.iter().enumerate() {
        if !names.insert(node.name.as_str()) {
            return refused(format!(
                "nodes[{k}].name: {:?} is already used; node names must be unique",
                node.name
            ));
        }
    }
    Ok(nodes)
}

/// Checks that all these nodes exist.
fn check_nodes(scene: &Scene, of: &[usize], place: impl Fn() -> String) -> Result<(), Fault> {
    match of.iter().find(|&&node| node >= scene.nodes.len()) {
        None => Ok(()),
        Some(node) => refused(format!(
            "{}: there is no node {node}; nodes are numbered from 0 to {}",
            place(),
            scene.nodes.len().saturating_sub(1)
        )),
    }
}

fn lines(scene: &Scene) -> Result<Vec<Vec<usize>>, Fault> {
    for (k, line) in scene.lines.iter().enumerate() {
        check_nodes(scene, line, || format!("lines[{k}]"))?;
        if line.len() < 2 {
            return refused(format!("lines[{k}]: a line needs at least two nodes"));
        }
    }
    let mut all = scene.lines.clone();
    // Neighbouring faces share edges.
    let mut drawn = HashSet::new();
    for (k, face) in scene.faces.iter().enumerate() {
        for edge in outline(scene, face, || format!("faces[{k}]"))?.windows(2) {
            let mut ends = edge.to_vec();
            ends.sort_unstable();
            if drawn.insert(ends.clone()) {
                all.push(ends);
            }
        }
    }
    Ok(all)
}

/// The closed curve around a face.
fn outline(scene: &Scene, face: &[usize], place: impl Fn() -> String) -> Result<Vec<usize>, Fault> {
    check_nodes(scene, face, &place)?;
    match face {
        [first, _, _, ..] => Ok(face.iter().chain([first]).copied().collect()),
        _ => refused(format!("{}: a face needs at least three nodes", place())),
    }
}

type Surfaces<'a> = (Vec<Surface>, HashMap<&'a str, usize>);

fn surfaces(scene: &Scene) -> Result<Surfaces<'_>, Fault> {
    let mut numbers = HashMap::new();
    let mut surfaces = Vec::new();
    for (k, surface) in scene.surfaces.iter().enumerate() {
        let elements = segments(scene, surface, k)?;
        if numbers.insert(surface.name.as_str(), k).is_some() {
            return refused(format!(
                "surfaces[{k}].name: {:?} is already used",
                surface.name
            ));
        }
        surfaces.push(Surface::new(
            &shown::cut(&surface.name, limits::NAME),
            elements,
            surface.rigid,
        ));
    }
    Ok((surfaces, numbers))
}

/// The segments of a surface: of its chain, or of the outlines of its faces in space.
fn segments(
    scene: &Scene,
    surface: &message::SurfaceMessage,
    k: usize,
) -> Result<Vec<Vec<usize>>, Fault> {
    let windows = |chain: &[usize]| chain.windows(2).map(<[usize]>::to_vec).collect::<Vec<_>>();
    check_nodes(scene, &surface.nodes, || format!("surfaces[{k}].nodes"))?;
    if scene.dimension == 2 {
        return match surface.nodes.len() {
            2.. => Ok(windows(&surface.nodes)),
            _ => refused(format!(
                "surfaces[{k}].nodes: a surface needs at least two nodes"
            )),
        };
    }
    if surface.faces.is_empty() {
        return refused(format!(
            "surfaces[{k}].faces: a surface in space needs at least one face"
        ));
    }
    let mut all = Vec::new();
    for (number, face) in surface.faces.iter().enumerate() {
        let place = || format!("surfaces[{k}].faces[{number}]");
        all.extend(windows(&outline(scene, face, place)?));
    }
    Ok(all)
}

fn contacts(scene: &Scene, surfaces: &HashMap<&str, usize>) -> Result<Vec<Contact>, Fault> {
    if scene.contacts.is_empty() {
        return refused("contacts: the list is empty, so there is nothing to step");
    }
    let (mut ids, mut taken) = (HashSet::new(), HashSet::new());
    let mut contacts = Vec::with_capacity(scene.contacts.len());
    for (k, contact) in scene.contacts.iter().enumerate() {
        check_nodes(scene, &[contact.node], || format!("contacts[{k}].node"))?;
        if !ids.insert(&contact.id) {
            return refused(format!("contacts[{k}].id: {} is already used", contact.id));
        }
        if !taken.insert(contact.node) {
            return refused(format!(
                "contacts[{k}].node: this node already has a contact"
            ));
        }
        let surface = match &contact.surface {
            None => Vec::new(),
            Some(name) => match surfaces.get(name.as_str()) {
                Some(&number) => vec![number],
                None => {
                    return refused(format!(
                        "contacts[{k}].surface: no surface is called {name:?}"
                    ));
                }
            },
        };
        let friction = friction(&contact.friction);
        let sound = (0.0..90.0).contains(&friction.angle)
            && (0.0..f64::INFINITY).contains(&friction.cohesion);
        if !sound {
            return refused(format!(
                "contacts[{k}].friction: mu and cohesion must be finite and not negative"
            ));
        }
        contacts.push(Contact {
            start: contact.mode,
            bond: bond(contact),
            area: contact.area,
            ..Contact::new(contact.node, surface, friction)
        });
    }
    Ok(contacts)
}
