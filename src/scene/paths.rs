//! Every scalar of a scene by a path that a person can type: `friction.angle`, `nodes.beam.elements`.
//!
//! Paths name things by their ids where they have any, and by their position where not; a point's parts are `x` and
//! `y`. One walk over the scene serves listing and setting, so that neither can know more than the other.

use super::error::{Path, at, nearest, quoted};
use super::spec::{
    Bar, BodySpec, LoadSpec, Material, MonitorSpec, Nodes, Point, Quantity, Region, Scale, Side,
    Sides, Spec,
};
use crate::model::{
    AtCycle, AtLimit, Axis, BoundUpdate, Component, Friction, Geometry, InitialState, Jumps, Law,
    Mode, Plane, ResidualMethod, Settings, SlipCount, Solver, Sticking, Strategy, Ties, Touch,
    Update,
};

/// A value set from outside.
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    /// The path as it was typed.
    pub path: String,
    /// The value as it was typed.
    pub value: String,
    /// Where the value stands in the scene.
    pub(crate) at: Path,
}

/// A scalar of a scene, its value, and what it may be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    pub path: String,
    pub value: String,
    /// What can be set: "a number", "one of lagged, consistent".
    pub kind: String,
}

/// All scalars of a scene, in the order of the file.
pub fn list(spec: &Spec) -> Vec<Listed> {
    let mut all = Vec::new();
    // The walk is for setting too and needs a scene that it may change.
    walk(&mut spec.clone(), &mut |place, scalar| {
        all.push(Listed {
            path: place.name.clone(),
            value: scalar.value(),
            kind: scalar.kind(),
        });
    });
    all
}

/// The settings by their paths, and the words that each can be; none where it is a number.
pub fn of_settings() -> Vec<(String, &'static [&'static str])> {
    let mut all = Vec::new();
    let place = Place {
        name: "settings".to_owned(),
        at: at!["settings"],
    };
    settings(&place, &mut Settings::default(), &mut |place, scalar| {
        let words: &[&str] = match scalar {
            Scalar::Choice(choice) => choice.names(),
            _ => &[],
        };
        all.push((place.name.clone(), words));
    });
    all
}

/// Sets one scalar. Whether the scene is sound with it shows when it is compiled.
///
/// # Errors
/// A message, if there is no such path or the value is not of its kind.
pub fn set(spec: &mut Spec, path: &str, value: &str) -> Result<Override, String> {
    let path = path.trim();
    let mut done = None;
    walk(spec, &mut |place, scalar| {
        if place.name == path && done.is_none() {
            done = Some(scalar.set(value.trim()).map(|()| place.at.clone()));
        }
    });
    match done {
        Some(result) => Ok(Override {
            path: path.to_owned(),
            value: value.trim().to_owned(),
            at: result?,
        }),
        None => Err(unknown(spec, path)),
    }
}

/// The whole path for one without its first or last step, where a person may leave it out: `increment` for
/// `history.increment`, `t_max` for `settings.t_max`, `friction` for `friction.angle`. What is none of these stays.
pub fn whole(spec: &Spec, path: &str) -> String {
    let all = list(spec);
    let path = path.trim();
    let wholes = [
        path.to_owned(),
        format!("history.{path}"),
        format!("settings.{path}"),
        format!("{path}.angle"),
    ];
    let known = |whole: &String| all.iter().any(|listed| listed.path == *whole);
    wholes
        .into_iter()
        .find(known)
        .unwrap_or_else(|| path.to_owned())
}

fn unknown(spec: &Spec, path: &str) -> String {
    let all = list(spec);
    let names = || all.iter().map(|listed| listed.path.as_str());
    let inside: Vec<&str> = names()
        .filter(|name| {
            !path.is_empty()
                && name
                    .strip_prefix(path)
                    .is_some_and(|r| r.starts_with(['.', '[']))
        })
        .collect();
    if !inside.is_empty() {
        return format!(
            "{} is no single value; it has {}",
            quoted(path),
            first_of(&inside)
        );
    }
    if let Some(near) = nearest(path, names()) {
        return format!(
            "the scene has no value {}; did you mean {near}?",
            quoted(path)
        );
    }
    // Not near to any: what the longest beginning that does exist goes on with.
    let mut head = path;
    while let Some(cut) = head.rfind(['.', '[']) {
        head = &head[..cut];
        let siblings: Vec<&str> = names()
            .filter(|n| {
                n.strip_prefix(head)
                    .is_some_and(|r| r.starts_with(['.', '[']))
            })
            .collect();
        if !siblings.is_empty() {
            return format!(
                "the scene has no value {}; {head} has {}",
                quoted(path),
                first_of(&siblings)
            );
        }
    }
    format!(
        "the scene has no value {}; `check --paths` lists them all",
        quoted(path)
    )
}

fn first_of(names: &[&str]) -> String {
    const MOST: usize = 8;
    let more = if names.len() > MOST { ", …" } else { "" };
    names
        .iter()
        .take(MOST)
        .copied()
        .collect::<Vec<_>>()
        .join(", ")
        + more
}

/// A place that the walk has come to, by both its names.
#[derive(Clone)]
struct Place {
    /// As a person types it.
    name: String,
    /// As the file has it.
    at: Path,
}

impl Place {
    fn field(&self, key: &str) -> Place {
        let name = if self.name.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.name)
        };
        Place {
            name,
            at: self.at.then(key),
        }
    }

    fn index(&self, index: usize) -> Place {
        Place {
            name: format!("{}[{index}]", self.name),
            at: self.at.then(index),
        }
    }

    /// A part of a tuple, which has a name only here.
    fn part(&self, name: &str, index: usize) -> Place {
        Place {
            name: format!("{}.{name}", self.name),
            at: self.at.then(index),
        }
    }

    /// An element of a list that is called by its id.
    fn called(&self, id: &str, index: usize) -> Place {
        Place {
            name: format!("{}.{id}", self.name),
            at: self.at.then(index),
        }
    }
}

/// A scalar that can be read and set.
enum Scalar<'a> {
    Number(&'a mut f64),
    Optional(&'a mut Option<f64>),
    Count(&'a mut usize),
    Limit(&'a mut u32),
    Flag(&'a mut bool),
    Text(&'a mut String),
    Choice(&'a mut dyn Choice),
}

impl Scalar<'_> {
    fn value(&self) -> String {
        match self {
            Scalar::Number(x) => format!("{x:?}"),
            Scalar::Optional(Some(x)) => format!("{x:?}"),
            Scalar::Optional(None) => "none".to_owned(),
            Scalar::Count(n) => n.to_string(),
            Scalar::Limit(n) => n.to_string(),
            Scalar::Flag(flag) => flag.to_string(),
            Scalar::Text(text) => (*text).clone(),
            Scalar::Choice(choice) => choice.name().to_owned(),
        }
    }

    fn kind(&self) -> String {
        match self {
            Scalar::Number(_) => "a number".to_owned(),
            Scalar::Optional(_) => "a number, or none".to_owned(),
            Scalar::Count(_) | Scalar::Limit(_) => "a whole number".to_owned(),
            Scalar::Flag(_) => "true or false".to_owned(),
            Scalar::Text(_) => "a text".to_owned(),
            Scalar::Choice(choice) => format!("one of {}", choice.names().join(", ")),
        }
    }

    fn set(self, text: &str) -> Result<(), String> {
        let kind = self.kind();
        let wrong = || format!("{} will not do; it must be {kind}", quoted(text));
        let number = || {
            text.parse::<f64>()
                .ok()
                .filter(|x| x.is_finite())
                .ok_or_else(wrong)
        };
        match self {
            Scalar::Number(x) => *x = number()?,
            Scalar::Optional(x) => {
                *x = if text == "none" {
                    None
                } else {
                    Some(number()?)
                }
            }
            Scalar::Count(n) => *n = text.parse().map_err(|_| wrong())?,
            Scalar::Limit(n) => *n = text.parse().map_err(|_| wrong())?,
            Scalar::Flag(flag) => *flag = text.parse().map_err(|_| wrong())?,
            Scalar::Text(old) => text.clone_into(old),
            Scalar::Choice(choice) => {
                if !choice.choose(text) {
                    return Err(wrong());
                }
            }
        }
        Ok(())
    }
}

/// One of a few words.
trait Choice {
    fn names(&self) -> &'static [&'static str];
    fn name(&self) -> &'static str;
    /// Takes the choice of that name, if there is one.
    fn choose(&mut self, name: &str) -> bool;
}

macro_rules! choices {
    ($($type:ty { $($name:literal => $value:path),* $(,)? })*) => {
        $(impl Choice for $type {
            fn names(&self) -> &'static [&'static str] {
                &[$($name),*]
            }
            fn name(&self) -> &'static str {
                match self { $($value => $name),* }
            }
            fn choose(&mut self, name: &str) -> bool {
                match name {
                    $($name => *self = $value,)*
                    _ => return false,
                }
                true
            }
        })*
    };
}

choices! {
    Mode { "free" => Mode::Free, "sliding" => Mode::Sliding, "fixed" => Mode::Fixed }
    Component { "x" => Component::X, "y" => Component::Y, "rotation" => Component::Rotation }
    Axis { "x" => Axis::X, "y" => Axis::Y }
    Jumps { "accept" => Jumps::Accept, "cut" => Jumps::Cut, "stop" => Jumps::Stop }
    ResidualMethod { "accumulate" => ResidualMethod::Accumulate, "stress" => ResidualMethod::Stress }
    Solver { "auto" => Solver::Auto, "augmented" => Solver::Augmented, "condensed" => Solver::Condensed }
    Geometry { "consistent" => Geometry::Consistent, "frozen" => Geometry::Frozen }
    BoundUpdate { "lagged" => BoundUpdate::Lagged, "consistent" => BoundUpdate::Consistent }
    SlipCount { "increment" => SlipCount::Increment, "major" => SlipCount::Major }
    Sticking { "anchored" => Sticking::Anchored, "increments" => Sticking::Increments }
    Law { "svk" => Law::Svk, "neohookean" => Law::NeoHookean }
    Plane { "strain" => Plane::Strain, "stress" => Plane::Stress }
    Update { "total" => Update::Total, "updated" => Update::Updated }
    Touch { "auto" => Touch::Auto, "ratio" => Touch::Ratio, "start" => Touch::Start }
    Ties { "keep" => Ties::Keep, "printed" => Ties::Printed }
    AtCycle { "stop" => AtCycle::Stop, "damp" => AtCycle::Damp }
    AtLimit { "stop" => AtLimit::Stop, "accept" => AtLimit::Accept }
}

impl Choice for Strategy {
    fn names(&self) -> &'static [&'static str] {
        &Strategy::NAMES
    }
    fn name(&self) -> &'static str {
        Strategy::name(*self)
    }
    fn choose(&mut self, name: &str) -> bool {
        let found = Strategy::ALL.into_iter().find(|s| s.name() == name);
        found.inspect(|&found| *self = found).is_some()
    }
}

type Visit<'v> = dyn FnMut(&Place, Scalar<'_>) + 'v;

/// Visits every scalar, in the order of the file.
fn walk(spec: &mut Spec, visit: &mut Visit<'_>) {
    let root = |key: &str| Place {
        name: key.to_owned(),
        at: at![key],
    };
    let scene_friction = spec.friction;
    visit(&root("title"), Scalar::Text(&mut spec.title));
    visit(&root("refine"), Scalar::Count(&mut spec.refine));
    for (k, entry) in spec.nodes.iter_mut().enumerate() {
        let place = root("nodes").called(entry.id(), k);
        nodes(&place, entry, visit);
    }
    for (k, entry) in spec.materials.iter_mut().enumerate() {
        let place = root("materials").called(entry.id(), k);
        material(&place, entry, visit);
    }
    for (k, entry) in spec.bodies.iter_mut().enumerate() {
        let place = root("bodies").called(entry.id(), k);
        body(&place, entry, visit);
    }
    for (k, entry) in spec.surfaces.iter_mut().enumerate() {
        let place = root("surfaces").called(&entry.id, k);
        visit(&place.field("along"), Scalar::Text(&mut entry.along));
        visit(&place.field("reverse"), Scalar::Flag(&mut entry.reverse));
        visit(&place.field("endless"), Scalar::Flag(&mut entry.endless));
    }
    for (k, entry) in spec.slaves.iter_mut().enumerate() {
        let place = root("slaves").index(k);
        texts(&place.field("nodes"), &mut entry.nodes, visit);
        texts(&place.field("on"), &mut entry.on, visit);
        visit(&place.field("start"), Scalar::Choice(&mut entry.start));
        own_friction(
            &place.field("friction"),
            &mut entry.friction,
            scene_friction,
            visit,
        );
        state(&place.field("state"), &mut entry.state, visit);
    }
    friction(&root("friction"), &mut spec.friction, visit);
    for (k, entry) in spec.supports.iter_mut().enumerate() {
        let place = root("supports").index(k);
        visit(&place.field("node"), Scalar::Text(&mut entry.node));
        for (j, component) in entry.fix.iter_mut().enumerate() {
            visit(&place.field("fix").index(j), Scalar::Choice(component));
        }
    }
    for (k, entry) in spec.loads.iter_mut().enumerate() {
        load(&root("loads").index(k), entry, visit);
    }
    for (k, corner) in spec.history.path.iter_mut().enumerate() {
        visit(
            &root("history").field("path").index(k),
            Scalar::Number(corner),
        );
    }
    visit(
        &root("history").field("increment"),
        Scalar::Number(&mut spec.history.increment),
    );
    let before = spec.history.least();
    let mut after = before;
    visit(&root("history").field("least"), Scalar::Number(&mut after));
    if after != before {
        spec.history.least = Some(after);
    }
    visit(
        &root("history").field("jumps"),
        Scalar::Choice(&mut spec.history.jumps),
    );
    settings(&root("settings"), &mut spec.settings, visit);
    for (k, entry) in spec.monitors.iter_mut().enumerate() {
        monitor(&root("monitors").called(&entry.name, k), entry, visit);
    }
}

fn texts(place: &Place, list: &mut [String], visit: &mut Visit<'_>) {
    for (k, text) in list.iter_mut().enumerate() {
        visit(&place.index(k), Scalar::Text(text));
    }
}

/// A point, whose parts are tuple elements in the file and `x` and `y` on the command line.
fn point(place: &Place, point: &mut Point, visit: &mut Visit<'_>) {
    for (k, (name, value)) in [("x", &mut point.0), ("y", &mut point.1)]
        .into_iter()
        .enumerate()
    {
        visit(&place.part(name, k), Scalar::Number(value));
    }
}

/// Two counts, called like the parts of a point.
fn pair(place: &Place, pair: &mut (usize, usize), visit: &mut Visit<'_>) {
    for (k, (name, value)) in [("x", &mut pair.0), ("y", &mut pair.1)]
        .into_iter()
        .enumerate()
    {
        visit(&place.part(name, k), Scalar::Count(value));
    }
}

fn points(place: &Place, list: &mut [Point], visit: &mut Visit<'_>) {
    for (k, entry) in list.iter_mut().enumerate() {
        point(&place.index(k), entry, visit);
    }
}

fn nodes(place: &Place, entry: &mut Nodes, visit: &mut Visit<'_>) {
    let per = match entry {
        Nodes::Node { at, .. } => return point(&place.field("at"), at, visit),
        Nodes::Line {
            from,
            to,
            elements,
            per_element,
            ..
        } => {
            point(&place.field("from"), from, visit);
            point(&place.field("to"), to, visit);
            visit(&place.field("elements"), Scalar::Count(elements));
            per_element
        }
        Nodes::Arc {
            center,
            radius,
            from,
            to,
            elements,
            per_element,
            ..
        } => {
            point(&place.field("center"), center, visit);
            visit(&place.field("radius"), Scalar::Number(radius));
            visit(&place.field("from"), Scalar::Number(from));
            visit(&place.field("to"), Scalar::Number(to));
            visit(&place.field("elements"), Scalar::Count(elements));
            per_element
        }
        Nodes::Through {
            points: list,
            per_element,
            ..
        } => {
            points(&place.field("points"), list, visit);
            per_element
        }
        Nodes::Block {
            corners,
            elements,
            grading,
            sides,
            place: put,
            ..
        } => {
            points(&place.field("corners"), corners, visit);
            pair(&place.field("elements"), elements, visit);
            point(&place.field("grading"), grading, visit);
            block_sides(&place.field("sides"), sides, visit);
            let put_at = place.field("place");
            visit(&put_at.field("turn"), Scalar::Number(&mut put.turn));
            point(&put_at.field("about"), &mut put.about, visit);
            return point(&put_at.field("shift"), &mut put.shift, visit);
        }
        Nodes::Mesh {
            of,
            joints,
            tolerance,
            ..
        } => {
            texts(&place.field("of"), of, visit);
            for (k, (a, b)) in joints.iter_mut().enumerate() {
                let joint = place.field("joints").index(k);
                visit(&joint.part("a", 0), Scalar::Text(a));
                visit(&joint.part("b", 1), Scalar::Text(b));
            }
            return visit(&place.field("tolerance"), Scalar::Number(tolerance));
        }
        Nodes::Chain {
            of, per_element, ..
        } => {
            texts(&place.field("of"), of, visit);
            per_element
        }
    };
    visit(&place.field("per_element"), Scalar::Count(per));
}

fn block_sides(place: &Place, sides: &mut Sides, visit: &mut Visit<'_>) {
    let around = [
        ("bottom", &mut sides.bottom),
        ("right", &mut sides.right),
        ("top", &mut sides.top),
        ("left", &mut sides.left),
    ];
    for (name, side) in around {
        match side {
            Some(Side::Arc { center }) => {
                point(&place.field(name).field("center"), center, visit);
            }
            Some(Side::Along { chain }) => {
                visit(&place.field(name).field("chain"), Scalar::Text(chain));
            }
            None => {}
        }
    }
}

#[allow(non_snake_case)]
fn material(place: &Place, entry: &mut Material, visit: &mut Visit<'_>) {
    match entry {
        Material::Section { EA, EI, GA, .. } => {
            visit(&place.field("EA"), Scalar::Number(EA));
            visit(&place.field("EI"), Scalar::Number(EI));
            visit(&place.field("GA"), Scalar::Optional(GA));
        }
        Material::Elastic {
            E,
            nu,
            law,
            plane,
            thickness,
            update,
            ..
        } => {
            visit(&place.field("E"), Scalar::Number(E));
            visit(&place.field("nu"), Scalar::Number(nu));
            visit(&place.field("law"), Scalar::Choice(law));
            visit(&place.field("plane"), Scalar::Choice(plane));
            visit(&place.field("thickness"), Scalar::Number(thickness));
            visit(&place.field("update"), Scalar::Choice(update));
        }
    }
}

fn body(place: &Place, entry: &mut BodySpec, visit: &mut Visit<'_>) {
    match entry {
        BodySpec::Beam {
            along, material, ..
        } => {
            visit(&place.field("along"), Scalar::Text(along));
            visit(&place.field("material"), Scalar::Text(material));
        }
        BodySpec::Solid {
            mesh,
            material,
            regions,
            ..
        } => {
            visit(&place.field("mesh"), Scalar::Text(mesh));
            visit(&place.field("material"), Scalar::Text(material));
            for (k, Region { from, to, material }) in regions.iter_mut().enumerate() {
                let place = place.field("regions").index(k);
                point(&place.field("from"), from, visit);
                point(&place.field("to"), to, visit);
                visit(&place.field("material"), Scalar::Text(material));
            }
        }
        BodySpec::Matrix {
            nodes,
            stiffness,
            compliance,
            free,
            ..
        } => {
            texts(&place.field("nodes"), nodes, visit);
            for (key, rows) in [("stiffness", stiffness), ("compliance", compliance)] {
                for (k, row) in rows.iter_mut().enumerate() {
                    numbers(&place.field(key).index(k), row, visit);
                }
            }
            numbers(&place.field("free"), free, visit);
        }
        BodySpec::Springs { bars, .. } => {
            for (k, bar) in bars.iter_mut().enumerate() {
                let place = place.field("bars").index(k);
                let Bar {
                    nodes,
                    angle,
                    stiffness,
                } = bar;
                texts(&place.field("nodes"), nodes, visit);
                visit(&place.field("angle"), Scalar::Number(angle));
                visit(&place.field("stiffness"), Scalar::Number(stiffness));
            }
        }
    }
}

fn numbers(place: &Place, list: &mut [f64], visit: &mut Visit<'_>) {
    for (k, number) in list.iter_mut().enumerate() {
        visit(&place.index(k), Scalar::Number(number));
    }
}

fn state(place: &Place, state: &mut InitialState, visit: &mut Visit<'_>) {
    let InitialState {
        f_n,
        f_t,
        t_max,
        slip,
        ratio,
    } = state;
    let fields = [
        ("f_n", f_n),
        ("f_t", f_t),
        ("t_max", t_max),
        ("slip", slip),
        ("ratio", ratio),
    ];
    for (key, value) in fields {
        visit(&place.field(key), Scalar::Number(value));
    }
}

fn friction(place: &Place, friction: &mut Friction, visit: &mut Visit<'_>) {
    visit(&place.field("angle"), Scalar::Number(&mut friction.angle));
    visit(
        &place.field("cohesion"),
        Scalar::Number(&mut friction.cohesion),
    );
}

/// Friction of a group of slaves, which is the scene's until it is set.
fn own_friction(place: &Place, own: &mut Option<Friction>, scene: Friction, visit: &mut Visit<'_>) {
    let before = own.unwrap_or(scene);
    let mut after = before;
    friction(place, &mut after, visit);
    if after != before {
        *own = Some(after);
    }
}

fn load(place: &Place, entry: &mut LoadSpec, visit: &mut Visit<'_>) {
    let scale: &mut Scale = match entry {
        LoadSpec::Force { node, x, y, scale } => {
            visit(&place.field("node"), Scalar::Text(node));
            visit(&place.field("x"), Scalar::Number(x));
            visit(&place.field("y"), Scalar::Number(y));
            scale
        }
        LoadSpec::Moment { node, value, scale } => {
            visit(&place.field("node"), Scalar::Text(node));
            visit(&place.field("value"), Scalar::Number(value));
            scale
        }
        LoadSpec::Traction {
            along,
            normal,
            x,
            y,
            scale,
        } => {
            visit(&place.field("along"), Scalar::Text(along));
            visit(&place.field("normal"), Scalar::Number(normal));
            visit(&place.field("x"), Scalar::Number(x));
            visit(&place.field("y"), Scalar::Number(y));
            scale
        }
        LoadSpec::Displacement {
            node,
            component,
            value,
            scale,
        } => {
            visit(&place.field("node"), Scalar::Text(node));
            visit(&place.field("component"), Scalar::Choice(component));
            visit(&place.field("value"), Scalar::Number(value));
            scale
        }
    };
    points(&place.field("scale"), scale, visit);
}

fn settings(place: &Place, settings: &mut Settings, visit: &mut Visit<'_>) {
    visit(
        &place.field("strategy"),
        Scalar::Choice(&mut settings.strategy),
    );
    visit(
        &place.field("residual"),
        Scalar::Choice(&mut settings.residual),
    );
    visit(&place.field("solver"), Scalar::Choice(&mut settings.solver));
    visit(
        &place.field("geometry"),
        Scalar::Choice(&mut settings.geometry),
    );
    visit(&place.field("t_max"), Scalar::Choice(&mut settings.t_max));
    visit(&place.field("slip"), Scalar::Choice(&mut settings.slip));
    visit(
        &place.field("sticking"),
        Scalar::Choice(&mut settings.sticking),
    );
    visit(&place.field("touch"), Scalar::Choice(&mut settings.touch));
    visit(&place.field("ties"), Scalar::Choice(&mut settings.ties));
    visit(&place.field("minors"), Scalar::Limit(&mut settings.minors));
    visit(&place.field("majors"), Scalar::Limit(&mut settings.majors));
    visit(
        &place.field("at_minor_limit"),
        Scalar::Choice(&mut settings.at_minor_limit),
    );
    visit(
        &place.field("at_cycle"),
        Scalar::Choice(&mut settings.at_cycle),
    );
    visit(
        &place.field("at_major_limit"),
        Scalar::Choice(&mut settings.at_major_limit),
    );
    visit(
        &place.field("tolerance"),
        Scalar::Number(&mut settings.tolerance),
    );
    visit(
        &place.field("memory"),
        Scalar::Optional(&mut settings.memory),
    );
}

fn monitor(place: &Place, monitor: &mut MonitorSpec, visit: &mut Visit<'_>) {
    let of = place.field("of");
    match &mut monitor.of {
        Quantity::Displacement { node, component } | Quantity::Reaction { node, component } => {
            visit(&of.field("node"), Scalar::Text(node));
            visit(&of.field("component"), Scalar::Choice(component));
        }
        Quantity::Contact { node, component } => {
            if let Some(node) = node {
                visit(&of.field("node"), Scalar::Text(node));
            }
            visit(&of.field("component"), Scalar::Choice(component));
        }
        Quantity::Drift { node } => {
            if let Some(node) = node {
                visit(&of.field("node"), Scalar::Text(node));
            }
        }
    }
}
