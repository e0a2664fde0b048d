//! The parts of a scene file while it is drawn, and what all families draw alike.

use crate::outside::chain::{Chain, Place, Point};
use crate::outside::draw::{Draw, round};

/// A scene file in the making; each string is an entry of its list.
#[derive(Debug, Clone, Default)]
pub struct Draft {
    pub title: String,
    pub refine: usize,
    pub nodes: Vec<String>,
    pub materials: Vec<String>,
    pub bodies: Vec<String>,
    pub surfaces: Vec<String>,
    pub slaves: Vec<String>,
    pub supports: Vec<String>,
    pub loads: Vec<String>,
    pub history: String,
    pub settings: String,
}

impl Draft {
    /// A scene with nothing in it but its increments and settings.
    pub fn new(d: &mut Draw, title: String) -> Self {
        Draft {
            title,
            refine: 1,
            history: history(d),
            settings: settings(d),
            ..Draft::default()
        }
    }

    /// The scene file.
    pub fn text(&self) -> String {
        let list = |name: &str, entries: &[String]| {
            let lines: String = entries.iter().map(|e| format!("        {e},\n")).collect();
            format!("    {name}: [\n{lines}    ],\n")
        };
        let mut text = format!(
            "(\n    title: {:?},\n    refine: {},\n",
            self.title, self.refine
        );
        text += &list("nodes", &self.nodes);
        text += &list("materials", &self.materials);
        text += &list("bodies", &self.bodies);
        text += &list("surfaces", &self.surfaces);
        text += &list("slaves", &self.slaves);
        text += &list("supports", &self.supports);
        text += &list("loads", &self.loads);
        text += &format!("    history: {},\n", self.history);
        text + &format!("    settings: ({}),\n)\n", self.settings)
    }

    /// A beam with a section of its own along chain `id`; bending stiffness.
    pub fn beam(&mut self, d: &mut Draw, id: &str) -> f64 {
        let (ea, ei) = (d.scale(15.0, 9000.0), d.scale(0.1, 6.0));
        let shear = if d.chance(0.5) {
            format!(", GA: {:?}", round(ea * d.uniform(0.3, 0.45)))
        } else {
            String::new()
        };
        self.materials.push(format!(
            "Section(id: \"m{id}\", EA: {ea:?}, EI: {ei:?}{shear})"
        ));
        self.bodies.push(format!(
            "Beam(id: \"{id}\", along: \"{id}\", material: \"m{id}\")"
        ));
        ei
    }

    /// A solid on block `id`, of this Young's modulus; `law` and `plane` are those of its material.
    pub fn solid(&mut self, id: &str, young: f64, kind: &str) {
        self.materials.push(format!(
            "Elastic(id: \"m{id}\", E: {:?}, {kind})",
            round(young)
        ));
        self.bodies.push(format!(
            "Solid(id: \"{id}\", mesh: \"{id}\", material: \"m{id}\")"
        ));
    }

    /// Soft springs from a node to the ground.
    pub fn springs(&mut self, id: &str, node: &str, stiffness: [f64; 2]) {
        let bar = |k: usize| {
            let (angle, stiffness) = ([0.0, 90.0][k], round(stiffness[k]));
            format!("(nodes: [\"{node}\"], angle: {angle:?}, stiffness: {stiffness:?})")
        };
        let bars = [bar(0), bar(1)].join(", ");
        self.bodies
            .push(format!("Springs(id: \"{id}\", bars: [{bars}])"));
    }

    /// The master surface `id` along a chain.
    pub fn surface(&mut self, id: &str, along: &str) {
        self.surfaces
            .push(format!("(id: \"{id}\", along: \"{along}\")"));
    }

    /// Slave nodes on surface `on`; `force` is what a cohesion is measured by.
    pub fn touch(&mut self, d: &mut Draw, nodes: &[String], on: &str, force: f64) {
        let nodes = nodes
            .iter()
            .map(|n| format!("{n:?}"))
            .collect::<Vec<_>>()
            .join(", ");
        let angle = match d.uniform(0.0, 1.0) {
            p if p < 0.15 => 0.0,
            p if p < 0.8 => d.number(1.0, 30.0),
            _ => d.number(30.0, 60.0),
        };
        let cohesion = if d.chance(0.12) {
            round(force * d.uniform(0.005, 0.2))
        } else {
            0.0
        };
        self.slaves.push(format!(
            "(nodes: [{nodes}], on: [\"{on}\"], friction: (angle: {angle:?}, cohesion: {cohesion:?}))"
        ));
    }

    /// Holds components of a node.
    pub fn hold(&mut self, node: &str, fix: &str) {
        self.supports
            .push(format!("(node: \"{node}\", fix: [{fix}])"));
    }

    /// A dead force on a node; `scale` is one of a [`Phases`]' two.
    pub fn force(&mut self, node: &str, [x, y]: Point, scale: &str) {
        let (x, y) = (round(x), round(y));
        self.loads.push(format!(
            "Force(node: \"{node}\", x: {x:?}, y: {y:?}{scale})"
        ));
    }

    /// A prescribed motion of a node: first this way, then that.
    pub fn motion(&mut self, node: &str, press: Point, drag: Point, phases: &Phases) {
        for (k, component) in ["x", "y"].into_iter().enumerate() {
            let what = match phases.0 {
                None => format!("value: {:?}", round(press[k] + drag[k])),
                Some((part, end)) => format!(
                    "value: 1.0, scale: [(0.0, 0.0), ({part:?}, {:?}), (1.0, {:?})]",
                    round(press[k]),
                    round(press[k] + end * drag[k])
                ),
            };
            self.loads.push(format!(
                "Displacement(node: \"{node}\", component: {component}, {what})"
            ));
        }
    }

    /// A dead traction along an edge.
    pub fn traction(&mut self, along: &str, [x, y]: Point, scale: &str) {
        let (x, y) = (round(x), round(y));
        self.loads.push(format!(
            "Traction(along: \"{along}\", x: {x:?}, y: {y:?}{scale})"
        ));
    }
}

/// How what presses and what drags follow the load factor: both with it, or one after the other, with the load factor at
/// which pressing ends and the part of the whole to which dragging comes in the end.
pub struct Phases(Option<(f64, f64)>);

impl Phases {
    pub fn draw(d: &mut Draw) -> Self {
        if d.chance(0.3) {
            return Phases(None);
        }
        let part = d.number(0.2, 0.7);
        Phases(Some((part, d.pick(&[1.0, 1.0, 1.0, 1.0, 0.3, -1.0]))))
    }

    /// The end of a load that presses.
    pub fn press(&self) -> String {
        self.0.map_or(String::new(), |(part, _)| {
            format!(", scale: [(0.0, 0.0), ({part:?}, 1.0), (1.0, 1.0)]")
        })
    }

    /// The end of a load that drags.
    pub fn drag(&self) -> String {
        self.0.map_or(String::new(), |(part, end)| {
            format!(", scale: [(0.0, 0.0), ({part:?}, 0.0), (1.0, {end:?})]")
        })
    }
}

/// A path and its increments, from tiny to whole.
fn history(d: &mut Draw) -> String {
    let path = match d.uniform(0.0, 1.0) {
        p if p < 0.5 => "[0.0, 1.0]",
        p if p < 0.67 => "[0.0, 1.0, 0.0]",
        p if p < 0.8 => "[0.0, 1.0, 0.3]",
        p if p < 0.9 => "[0.0, 0.6, 0.1, 1.0]",
        _ => "[0.0, 1.0, -0.6]",
    };
    let count = match d.uniform(0.0, 1.0) {
        p if p < 0.08 => 1.0,
        p if p < 0.33 => d.pick(&[2.0, 2.5, 3.0, 4.0, 5.0]),
        p if p < 0.65 => d.pick(&[6.0, 8.0, 10.0, 12.0]),
        p if p < 0.95 => d.pick(&[14.0, 17.0, 20.0, 28.0]),
        _ => d.pick(&[60.0, 100.0]),
    };
    format!("(path: {path}, increment: {:?})", round(1.0 / count))
}

/// Mostly what a scene has that says nothing.
fn settings(d: &mut Draw) -> String {
    const OTHERS: [&str; 8] = [
        "strategy: newton",
        "strategy: lemke",
        "strategy: census",
        "strategy: table2",
        "strategy: sliding",
        "t_max: consistent",
        "geometry: frozen",
        "sticking: increments",
    ];
    if d.chance(0.7) {
        return String::new();
    }
    let one = d.whole(0, OTHERS.len() - 1);
    let other = d.whole(0, OTHERS.len() - 1);
    let both = one < 5 && other >= 5 && d.chance(0.5);
    if both {
        format!("{}, {}", OTHERS[one], OTHERS[other])
    } else {
        OTHERS[one].to_owned()
    }
}

/// Law, Poisson's ratio and what happens across the plane, of a material.
pub fn kind(d: &mut Draw) -> String {
    let nu = d.pick(&[0.0, 0.2, 0.3, 0.33, 0.44]);
    let law = d.pick(&["svk", "svk", "neohookean"]);
    let (plane, thickness) = if d.chance(0.5) {
        ("strain", 1.0)
    } else {
        ("stress", d.number(0.5, 2.0))
    };
    format!("nu: {nu:?}, law: {law}, plane: {plane}, thickness: {thickness:?}")
}

/// Elements and nodes per element of a chain.
pub fn mesh(d: &mut Draw) -> (usize, usize) {
    match d.pick(&[2, 3, 3, 3, 3, 5, 5, 4, 7, 9]) {
        2 => (d.whole(3, 8), 2),
        m @ (3 | 4) => (d.whole(1, 5), m),
        5 => (d.whole(1, 4), 5),
        m => (d.whole(1, 2), m),
    }
}

/// A chain as the scene file has it, and as the curve that it is.
pub struct Curve {
    pub text: String,
    pub chain: Chain,
    /// Number of its nodes.
    pub nodes: usize,
}

impl Curve {
    fn new(text: String, points: &[Point], per_element: usize) -> Self {
        let step = per_element - 1;
        let element = |k: usize| points[k * step..=(k + 1) * step].to_vec();
        let elements = (0..(points.len() - 1) / step).map(element).collect();
        Curve {
            text,
            chain: Chain::through(elements),
            nodes: points.len(),
        }
    }

    /// The names of its nodes but for the first so many.
    pub fn names(&self, id: &str, skip: usize) -> Vec<String> {
        (skip + 1..=self.nodes)
            .map(|k| format!("{id}.{k}"))
            .collect()
    }

    /// Somewhere on it, mostly inside an element and not close to its ends.
    pub fn place(&self, d: &mut Draw) -> Place {
        let count = self.chain.count();
        let border = count > 1 && d.chance(0.08);
        if border {
            let element = d.whole(1, count - 1);
            return Place { element, xi: -1.0 };
        }
        let part = d.uniform(0.12, 0.88) * count as f64;
        let element = (part as usize).min(count - 1);
        let xi = round(2.0 * (part - element as f64) - 1.0);
        Place { element, xi }
    }
}

/// Elements, nodes per element, and by how much the scene refines.
pub type Mesh = (usize, usize, usize);

/// A straight chain.
pub fn line(id: &str, from: Point, to: Point, (elements, per_element, refine): Mesh) -> Curve {
    let count = elements * refine * (per_element - 1);
    let part = |k: usize| k as f64 / count as f64;
    let at = |s: f64| [0, 1].map(|k| from[k] + s * (to[k] - from[k]));
    let points: Vec<Point> = (0..=count).map(|k| at(part(k))).collect();
    let text = format!(
        "Line(id: \"{id}\", from: {}, to: {}, elements: {elements}, per_element: {per_element})",
        point(from),
        point(to)
    );
    Curve::new(text, &points, per_element)
}

/// An arc; angles in degrees.
pub fn arc(
    id: &str,
    center: Point,
    radius: f64,
    [from, to]: [f64; 2],
    (elements, per_element, refine): Mesh,
) -> Curve {
    let count = elements * refine * (per_element - 1);
    let angle = |k: usize| (from + (to - from) * k as f64 / count as f64).to_radians();
    let at = |a: f64| [center[0] + radius * a.cos(), center[1] + radius * a.sin()];
    let points: Vec<Point> = (0..=count).map(|k| at(angle(k))).collect();
    let text = format!(
        "Arc(id: \"{id}\", center: {}, radius: {radius:?}, from: {from:?}, to: {to:?}, elements: {elements}, per_element: {per_element})",
        point(center)
    );
    Curve::new(text, &points, per_element)
}

/// A chain through points.
pub fn through(id: &str, points: &[Point], per_element: usize) -> Curve {
    let all: Vec<String> = points.iter().map(|p| point(*p)).collect();
    let text = format!(
        "Through(id: \"{id}\", points: [{}], per_element: {per_element})",
        all.join(", ")
    );
    Curve::new(text, points, per_element)
}

pub fn point([x, y]: Point) -> String {
    format!("({x:?}, {y:?})")
}
