//! Geometry of a deck for the rules: bodies, faces of surfaces, and the gap of each slave node of a pair.

pub use super::sorted_points::Vector;
use super::sorted_points::{SortedPoints, extent};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use stickslip_core::groups::{Connected, marked};
use stickslip_core::model::RunShape;
use stickslip_exchange::calculix::cel::Slave;
use stickslip_exchange::inp::Deck;
use stickslip_exchange::inp::deck::{
    Adjust, Faces, Family, Interaction, Normal, Section, Set, Step, Value,
};
use stickslip_scene::joined;

/// Position tolerance of a tie without one, in sizes of a master face (CalculiX: 2.5 %).
const TIE_TOLERANCE: f64 = 0.025;
/// Gaps below this count as closed, in sizes of a slave face.
const CLOSED: f64 = 1e-3;
/// Nodes up to this far beyond the edge of the master are in front of it, in sizes of a master face.
const EDGE: f64 = 0.1;

/// A face of an element on a surface.
#[derive(Debug, Clone)]
pub struct SurfaceFace {
    /// Index of the element.
    pub element: usize,
    /// Index of its side.
    pub side: usize,
    /// Indices of the corners.
    pub corners: Vec<usize>,
    /// Mean of the corners.
    pub centre: Vector,
    /// Outward unit normal.
    pub normal: Vector,
    /// Area; in plane decks the length.
    pub area: f64,
    /// Length of an edge, as the root of the area.
    pub size: f64,
    /// Largest distance of a corner from the centre.
    radius: f64,
    /// Offsets of the midside nodes from the middles of the edges, from corner k to k + 1; empty if there are none.
    bulges: Vec<Vector>,
}

impl SurfaceFace {
    /// Offset of the face from the flat one through its corners, at a point given by the weights of the corners.
    fn bulge(&self, of: [f64; 4]) -> Vector {
        let count = self.corners.len();
        let weight = |k: usize| of[k % count];
        let parts = self.bulges.iter().enumerate().map(|(k, bulge)| {
            let (a, b) = (weight(k), weight(k + 1));
            let part = match count {
                4 => (a + b) * (b + weight(k + 2)) * (a + weight(k + 3)),
                _ => a * b,
            };
            4.0 * part * bulge
        });
        parts.sum()
    }
}

/// A slave node and the nearest master face.
#[derive(Debug, Clone, Copy)]
pub struct SlaveGap {
    /// Index of the node.
    pub node: usize,
    /// Distance along the face's normal, negative inside.
    pub gap: f64,
    /// Distance beyond the face's edge; 0 in front of the face.
    pub beyond: f64,
    /// Index of the face in [`PairShape::masters`].
    pub face: usize,
}

/// A contact pair or a tie.
#[derive(Debug, Clone)]
pub struct PairShape {
    /// Index of its card in the deck.
    pub number: usize,
    /// `SLAVE on MASTER`.
    pub name: String,
    /// Indices of the slave and the master surface.
    pub surfaces: [usize; 2],
    /// Faces of the slave surface; empty for a surface of nodes.
    pub slaves: Vec<SurfaceFace>,
    /// Faces of the master surface.
    pub masters: Vec<SurfaceFace>,
    /// The centres of these faces.
    pub centres: SortedPoints,
    /// The slave nodes with their gaps, by node.
    pub nodes: Vec<SlaveGap>,
    /// Groups of the slave and of the master.
    pub groups: [usize; 2],
    /// Mean size of the slave's and of the master's faces; a slave of nodes has the master's.
    pub sizes: [f64; 2],
    /// Gaps up to this are moved onto the master at the start, or tied.
    pub closes: Option<f64>,
}

impl PairShape {
    /// Whether a slave node touches at the start.
    pub fn is_closed(&self, node: &SlaveGap) -> bool {
        let limit = self.closes.unwrap_or(0.0).max(CLOSED * self.sizes[0]);
        node.gap <= limit && node.beyond <= limit
    }

    /// The slave nodes that touch at the start.
    pub fn closed(&self) -> impl Iterator<Item = &SlaveGap> {
        self.nodes.iter().filter(|node| self.is_closed(node))
    }

    /// Normal of the master, averaged over the faces that slave nodes are nearest to.
    pub fn normal(&self) -> Vector {
        let sum: Vector = self.nodes.iter().map(|n| self.masters[n.face].normal).sum();
        sum.try_normalize(1e-12).unwrap_or_else(Vector::zeros)
    }

    /// The part of a motion along the master.
    pub fn along(&self, motion: Vector) -> Vector {
        let normal = self.normal();
        motion - motion.dot(&normal) * normal
    }

    /// The slave nodes in front of the master.
    pub fn in_front(&self) -> impl Iterator<Item = &SlaveGap> {
        let edge = EDGE * self.sizes[1];
        self.nodes.iter().filter(move |n| n.beyond <= edge)
    }

    /// The slave node with the smallest gap in front of the master.
    pub fn nearest(&self) -> Option<&SlaveGap> {
        self.in_front().min_by(|a, b| a.gap.total_cmp(&b.gap))
    }
}

/// A deck with its geometry.
pub struct DeckShape<'d> {
    /// The deck.
    pub deck: &'d Deck,
    /// Body of each node; `None` if no element has it.
    pub body_of: Vec<Option<usize>>,
    /// Name of each body: the set of its section.
    pub bodies: Vec<String>,
    /// Group of each body: bodies that ties hold together.
    pub group_of: Vec<usize>,
    /// The contact pairs in deck order.
    pub pairs: Vec<PairShape>,
    /// The ties in deck order.
    pub ties: Vec<PairShape>,
    /// The step that a run failed in; `None` before a run.
    pub failed: Option<usize>,
    /// How many elements have each face, by its sorted corners.
    faces: HashMap<Vec<usize>, u32>,
}

impl<'d> DeckShape<'d> {
    /// Computes the geometry of a deck.
    pub fn new(deck: &'d Deck) -> DeckShape<'d> {
        let (body_of, bodies) = bodies(deck);
        let mut shape = DeckShape {
            deck,
            group_of: (0..bodies.len()).collect(),
            body_of,
            bodies,
            pairs: Vec::new(),
            ties: Vec::new(),
            failed: None,
            faces: HashMap::new(),
        };
        shape.count_faces();
        let ties = deck.ties.iter().enumerate();
        shape.ties = ties
            .map(|(k, tie)| shape.pair(k, [tie.slave, tie.master], tie.tolerance))
            .collect();
        for tie in &mut shape.ties {
            tie.closes.get_or_insert(TIE_TOLERANCE * tie.sizes[1]);
            if tie.closed().next().is_some() {
                let [one, other] = tie.groups.map(|group| shape.group_of[group]);
                let groups = shape.group_of.iter_mut();
                groups
                    .filter(|group| **group == one)
                    .for_each(|group| *group = other);
            }
        }
        let pairs = deck.pairs.iter().enumerate();
        shape.pairs = pairs
            .map(|(k, pair)| {
                let closes = pair.adjust.as_ref().map(|adjust| match adjust {
                    Adjust::Within(length) => *length,
                    Adjust::Set(_) => f64::INFINITY,
                });
                shape.pair(k, [pair.slave, pair.master], closes)
            })
            .collect();
        shape
    }

    /// The steps that were reached, or all before a run.
    pub fn reached(&self) -> impl Iterator<Item = (usize, &Step)> {
        let steps = self.deck.steps.iter().enumerate();
        steps.take_while(|(k, _)| self.failed.is_none_or(|failed| *k <= failed))
    }

    /// The step that failed, or all before a run.
    pub fn suspects(&self) -> impl Iterator<Item = (usize, &Step)> {
        self.reached().skip(self.failed.unwrap_or(0))
    }

    /// The supports, then the displacements of all steps.
    pub fn all_supports(&self) -> impl Iterator<Item = &Value> + Clone {
        let motions = self.deck.steps.iter().flat_map(|step| &step.motions);
        self.deck.supports.iter().chain(motions)
    }

    /// The faces of all pairs and ties, and the positions of slaves.
    pub fn drawn(&self, slaves: &[Slave]) -> RunShape {
        let labels = self.deck.labels();
        let find = |label: &u32| labels.get(&u64::from(*label)).map(|&node| self.at(node));
        let place = |slave: &Slave| {
            let corners: Option<Vec<Vector>> = slave.nodes().iter().map(find).collect();
            corners.and_then(|corners| mean(&corners)).map(Into::into)
        };
        let corners =
            |face: &SurfaceFace| face.corners.iter().map(|&n| self.at(n).into()).collect();
        let drawn = |faces: fn(&PairShape) -> &Vec<SurfaceFace>| {
            let pairs = self.pairs.iter().chain(&self.ties);
            pairs.flat_map(faces).map(corners).collect()
        };
        RunShape {
            faces: [drawn(|pair| &pair.masters), drawn(|pair| &pair.slaves)],
            slaves: slaves.iter().map(place).collect(),
        }
    }

    /// Position of a node.
    pub fn at(&self, node: usize) -> Vector {
        Vector::from(self.deck.nodes[node].at)
    }

    fn all_at(&self, nodes: &[usize]) -> Vec<Vector> {
        nodes.iter().map(|&node| self.at(node)).collect()
    }

    /// Mean of an element's nodes.
    pub fn element_centre(&self, element: usize) -> Option<Vector> {
        mean(&self.all_at(&self.deck.elements[element].nodes))
    }

    /// Group of a node, if it belongs to an element.
    pub fn group(&self, node: usize) -> Option<usize> {
        self.body_of[node].map(|body| self.group_of[body])
    }

    /// The groups of bodies; none if skipped cards may hold them.
    pub fn groups(&self) -> BTreeSet<usize> {
        let groups = self.group_of.iter().filter(|_| !self.deck.is_incomplete);
        groups.copied().collect()
    }

    /// The nodes of a group.
    pub fn group_nodes(&self, group: usize) -> impl Iterator<Item = usize> + Clone {
        let nodes = 0..self.body_of.len();
        nodes.filter(move |node| self.group(*node) == Some(group))
    }

    /// The elements of a body, by index.
    pub fn elements(&self, body: usize) -> impl Iterator<Item = usize> {
        let of = |element: usize| self.body_of[self.deck.elements[element].nodes[0]];
        (0..self.deck.elements.len()).filter(move |element| of(*element) == Some(body))
    }

    /// The elements of a group, by index.
    pub fn group_elements(&self, group: usize) -> impl Iterator<Item = usize> {
        let of = |element: usize| self.group(self.deck.elements[element].nodes[0]);
        (0..self.deck.elements.len()).filter(move |element| of(*element) == Some(group))
    }

    /// Extent of a group along a direction.
    pub fn height(&self, group: usize, along: Vector) -> f64 {
        extent(
            self.group_nodes(group)
                .map(|node| self.at(node).dot(&along)),
        )
    }

    /// Name of a group: its bodies.
    pub fn group_name(&self, group: usize) -> String {
        let own = (0..self.bodies.len()).filter(|body| self.group_of[*body] == group);

        joined(own.map(|body| &self.bodies[body]), " with ")
    }

    /// The pairs that touch a group.
    pub fn pairs_of(&self, group: usize) -> impl Iterator<Item = &PairShape> {
        let pairs = self.pairs.iter();
        pairs.filter(move |pair| pair.groups.contains(&group))
    }

    /// The law of a contact pair.
    pub fn law(&self, pair: &PairShape) -> &'d Interaction {
        &self.deck.interactions[self.deck.pairs[pair.number].interaction]
    }

    /// Whether a face lies between two elements.
    pub fn is_inner(&self, face: &SurfaceFace) -> bool {
        self.faces
            .get(&sorted(&face.corners))
            .is_some_and(|n| *n > 1)
    }

    /// The set of exactly these nodes; or the largest among them without slave nodes; or the first node.
    pub fn set_name(&self, nodes: &BTreeSet<usize>) -> String {
        let is_slave = |node: &usize| {
            let mut pairs = self.pairs.iter();
            pairs.any(|pair| pair.nodes.binary_search_by_key(node, |n| n.node).is_ok())
        };
        let is_part = |set: &&Set| {
            let mut members = set.members.iter();
            members.clone().eq(nodes) || members.all(|n| nodes.contains(n) && !is_slave(n))
        };
        let sets = self.deck.node_sets.iter().filter(is_part);
        let set = sets.rev().max_by_key(|set| set.members.len());
        match set.filter(|set| !set.members.is_empty()) {
            Some(set) => set.name.clone(),
            None => {
                let first = nodes.first().map(|&node| self.deck.nodes[node].label);
                first.map(|label| label.to_string()).unwrap_or_default()
            }
        }
    }

    /// The material of an element, by index.
    pub fn material(&self, element: usize) -> Option<usize> {
        let mut sections = self.deck.sections.iter().rev();
        let section = sections.find(|section| is_member(self.deck, section, element));
        section.map(|section| section.material)
    }

    /// Young's modulus of the softer of the materials on both sides of a pair, with the material's name.
    pub fn young(&self, pair: &PairShape) -> Option<(f64, &str)> {
        let faces = pair.slaves.first().into_iter().chain(pair.masters.first());
        let materials = faces.filter_map(|face| self.material(face.element));
        let moduli = materials.filter_map(|k| {
            let material = &self.deck.materials[k];
            Some((material.elastic?.0, material.name.as_str()))
        });
        moduli.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Stiffness of a pair's law: pressure per length.
    pub fn stiffness(&self, pair: &PairShape) -> Option<f64> {
        match self.law(pair).normal {
            Normal::Linear { stiffness } | Normal::Tied { stiffness } => Some(stiffness),
            Normal::Hard => None,
        }
    }

    /// Whether a pair holds in tension and shear, too.
    pub fn is_tied(&self, pair: &PairShape) -> bool {
        matches!(self.law(pair).normal, Normal::Tied { .. })
    }

    /// Whether each node is on a beam.
    pub fn is_beam_node(&self) -> Vec<bool> {
        let elements = self.deck.elements.iter();
        let beams = elements.filter(|element| element.kind.family == Family::Beam);
        let nodes = beams.flat_map(|element| &element.nodes);
        marked(self.deck.nodes.len(), nodes)
    }

    /// Directions in which a group can move: translations, then rotations. None for beams in 3-D, whose rotations the rules do
    /// not consider.
    pub fn modes(&self, group: usize) -> [bool; 6] {
        let family = |element: usize| self.deck.elements[element].kind.family;
        let families: BTreeSet<Family> = self.group_elements(group).map(family).collect();
        let has = |family: Family| families.contains(&family);
        let is_plane = has(Family::PlaneStrain) || has(Family::PlaneStress);
        if has(Family::Solid) {
            [true; 6]
        } else if has(Family::Axisymmetric) {
            [false, true, false, false, false, false]
        } else if self.deck.is_solid() && !is_plane {
            [false; 6]
        } else {
            [true, true, false, false, false, true]
        }
    }

    /// The faces of a surface.
    fn faces(&self, surface: usize) -> Vec<SurfaceFace> {
        let sides = match &self.deck.surfaces[surface].of {
            Faces::Nodes(_) => &[][..],
            Faces::Elements(sides) => sides,
        };
        let faces = sides.iter();
        faces.filter_map(|&(e, side)| self.face(e, side)).collect()
    }

    /// The faces of an element.
    pub fn element_faces(&self, element: usize) -> impl Iterator<Item = SurfaceFace> {
        let sides = 0..self.deck.elements[element].kind.cell.sides().len();
        sides.filter_map(move |side| self.face(element, side))
    }

    /// The faces of an element that it does not share with another.
    pub fn outer_faces(&self, element: usize) -> impl Iterator<Item = SurfaceFace> {
        let faces = self.element_faces(element);
        faces.filter(|face| !self.is_inner(face))
    }

    /// A side of an element as a line of `*SURFACE`.
    pub fn surface_line(&self, element: usize, side: usize) -> String {
        format!("{}, S{}", self.deck.elements[element].label, side + 1)
    }

    /// A side of an element; `None` if it has no area.
    pub fn face(&self, element: usize, side: usize) -> Option<SurfaceFace> {
        let (corners, _) = self.deck.face(element, side);
        let at = self.all_at(&corners);
        let centre = mean(&at)?;
        let across = match at[..] {
            [a, b] => (b - a).cross(&Vector::z()),
            [a, b, c] => (b - a).cross(&(c - a)) / 2.0,
            [a, b, c, d] => (c - a).cross(&(d - b)) / 2.0,
            _ => return None,
        };
        let own = &self.deck.elements[element].nodes;
        let body = self.element_centre(element)?;
        let normal = across.try_normalize(0.0)?;
        let outward = normal * (centre - body).dot(&normal).signum();
        let area = across.norm();
        let radius = at.iter().map(|corner| (corner - centre).norm());
        let cell = self.deck.elements[element].kind.cell;
        let edges = 0..if at.len() == 2 { 1 } else { at.len() };
        let bulges = edges.map_while(|k| {
            let next = (k + 1) % at.len();
            let ends = [corners[k], corners[next]];
            let mut edges = cell.edges().iter();
            let edge = edges.position(|edge| edge.iter().all(|&end| ends.contains(&own[end])))?;
            let middle = *own.get(cell.corners() + edge)?;
            Some(self.at(middle) - (at[k] + at[next]) / 2.0)
        });
        Some(SurfaceFace {
            element,
            side,
            centre,
            normal: outward,
            area,
            size: if at.len() == 2 { area } else { area.sqrt() },
            radius: radius.fold(0.0, f64::max),
            bulges: bulges.collect(),
            corners,
        })
    }

    fn count_faces(&mut self) {
        for (k, element) in self.deck.elements.iter().enumerate() {
            for side in 0..element.kind.cell.sides().len() {
                let (corners, _) = self.deck.face(k, side);
                *self.faces.entry(sorted(&corners)).or_default() += 1;
            }
        }
    }

    fn pair(&self, number: usize, surfaces: [usize; 2], closes: Option<f64>) -> PairShape {
        let [slaves, masters] = surfaces.map(|surface| self.faces(surface));
        let nodes = self.deck.surface_nodes(surfaces[0]);
        let group = |node: Option<&usize>| node.and_then(|n| self.group(*n)).unwrap_or(usize::MAX);
        let master = masters.first().map(|face| &face.corners[0]);
        let groups = [group(nodes.first()), group(master)];
        let size = |faces: &[SurfaceFace]| {
            let sum: f64 = faces.iter().map(|face| face.size).sum();
            (!faces.is_empty()).then(|| sum / faces.len() as f64)
        };
        let master = size(&masters).unwrap_or(0.0);
        let mut pair = PairShape {
            number,
            name: surfaces.map(|k| &*self.deck.surfaces[k].name).join(" on "),
            nodes: Vec::new(),
            centres: SortedPoints::new(masters.iter().map(|face| face.centre).collect()),
            sizes: [size(&slaves).unwrap_or(master), master],
            surfaces,
            slaves,
            masters,
            groups,
            closes,
        };
        let gap = |node: usize| {
            let (face, gap, beyond) = self.nearest(self.at(node), &pair)?;
            Some(SlaveGap {
                node,
                gap,
                beyond,
                face,
            })
        };
        pair.nodes = nodes.into_iter().filter_map(gap).collect();
        pair
    }

    /// The master face nearest to a point, the distance along its normal, and the distance beyond its edge. Midside nodes count for
    /// the distance along the normal only.
    pub fn nearest(&self, point: Vector, pair: &PairShape) -> Option<(usize, f64, f64)> {
        let faces = &pair.masters;
        let largest = faces.iter().map(|face| face.radius).fold(0.0, f64::max);
        let tie = 1e-9 * largest;
        let mut best: Option<(f64, usize, Vector, [f64; 4])> = None;
        // Faces with the same closest point: the point is on an edge between them, and they share the normal.
        let mut normal = Vector::zeros();
        for (along, k) in pair.centres.from(point) {
            let is_farther = |least: f64| best.is_some_and(|(distance, ..)| least > distance + tie);
            if is_farther(along - largest) {
                break;
            }
            let face = &faces[k];
            if is_farther((point - face.centre).norm() - face.radius) {
                continue;
            }
            let (closest, weights) = closest(point, &self.all_at(&face.corners));
            let distance = (point - closest).norm();
            match best {
                Some((known, ..)) if (distance - known).abs() <= tie => normal += face.normal,
                Some((known, ..)) if distance > known => {}
                _ => (best, normal) = (Some((distance, k, closest, weights)), face.normal),
            }
        }
        let (_, k, closest, weights) = best?;
        let off = point - closest;
        let normal = normal.try_normalize(1e-12).unwrap_or(faces[k].normal);
        let flat = off.dot(&normal);
        let gap = flat - faces[k].bulge(weights).dot(&normal);
        Some((k, gap, (off - flat * normal).norm()))
    }

    /// Factor of a value at the end of a step.
    pub fn last_factor(&self, step: &Step, amplitude: Option<usize>) -> f64 {
        amplitude.map_or(1.0, |_| self.factor(step, amplitude, step.time.period))
    }

    /// Factor of a load or displacement of a step at a time of the step.
    pub fn factor(&self, step: &Step, amplitude: Option<usize>, time: f64) -> f64 {
        let Some(amplitude) = amplitude else {
            let ramp = time / step.time.period.max(f64::MIN_POSITIVE);
            return if step.at_once {
                f64::from(time > 0.0)
            } else {
                ramp.min(1.0)
            };
        };
        let points = &self.deck.amplitudes[amplitude].points;
        let after = points.partition_point(|(at, _)| *at <= time);
        match (
            after.checked_sub(1).and_then(|k| points.get(k)),
            points.get(after),
        ) {
            (Some((a, x)), Some((b, y))) => x + (y - x) * (time - a) / (b - a),
            (Some((_, x)), None) | (None, Some((_, x))) => *x,
            (None, None) => 1.0,
        }
    }
}

/// The slave node with the smallest gap in front of its master, with its pair.
pub fn nearest<'s>(
    pairs: impl Iterator<Item = &'s PairShape>,
) -> Option<(&'s PairShape, &'s SlaveGap)> {
    let nearest = pairs.filter_map(|pair| Some((pair, pair.nearest()?)));
    nearest.min_by(|a, b| a.1.gap.total_cmp(&b.1.gap))
}

/// The point of a segment, triangle or quadrilateral that is closest to a point, and the weights of the corners there.
fn closest(point: Vector, corners: &[Vector]) -> (Vector, [f64; 4]) {
    let triangles: &[[usize; 3]] = match corners.len() {
        4 => &[[0, 1, 2], [0, 2, 3]],
        3 => &[[0, 1, 2]],
        _ => &[],
    };
    let weigh = |parts: &[(usize, f64)]| {
        let mut weights = [0.0; 4];
        parts.iter().for_each(|&(k, part)| weights[k] = part);
        weights
    };
    let inside = triangles.iter().filter_map(|of| {
        let (foot, [a, b, c]) = in_triangle(point, of.map(|k| corners[k]))?;
        Some((foot, weigh(&[(of[0], a), (of[1], b), (of[2], c)])))
    });
    let ends = (0..corners.len()).map(|k| {
        let next = (k + 1) % corners.len();
        let (a, b) = (corners[k], corners[next]);
        let along = b - a;
        let part = (point - a).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
        let part = part.clamp(0.0, 1.0);
        (a + along * part, weigh(&[(k, 1.0 - part), (next, part)]))
    });
    let all = inside.chain(ends);
    let nearest = all.min_by(|a, b| (a.0 - point).norm().total_cmp(&(b.0 - point).norm()));
    nearest.unwrap_or((point, [0.0; 4]))
}

/// The projection of a point onto the plane of a triangle, with the weights of the corners, if it is inside.
fn in_triangle(point: Vector, [a, b, c]: [Vector; 3]) -> Option<(Vector, [f64; 3])> {
    let across = (b - a).cross(&(c - a));
    let normal = across.try_normalize(0.0)?;
    let foot = point - normal * (point - a).dot(&normal);
    let part = |p: Vector, q: Vector| (q - p).cross(&(foot - p)).dot(&normal) / across.norm();
    let parts = [part(b, c), part(c, a), part(a, b)];
    parts
        .iter()
        .all(|part| *part >= 0.0)
        .then_some((foot, parts))
}

fn mean(points: &[Vector]) -> Option<Vector> {
    let sum: Vector = points.iter().sum();
    (!points.is_empty()).then(|| sum / points.len() as f64)
}

fn sorted(corners: &[usize]) -> Vec<usize> {
    let mut sorted = corners.to_vec();
    sorted.sort_unstable();
    sorted
}

/// Connected elements: the body of each node, and the names of the bodies.
fn bodies(deck: &Deck) -> (Vec<Option<usize>>, Vec<String>) {
    let mut groups = Connected::new(deck.nodes.len());
    deck.elements.iter().for_each(|e| groups.join_all(&e.nodes));
    let mut body_of = vec![None; deck.nodes.len()];
    let (mut known, mut names) = (BTreeMap::new(), Vec::new());
    for (k, element) in deck.elements.iter().enumerate() {
        for &node in &element.nodes {
            let at = groups.root(node);
            body_of[node] = Some(*known.entry(at).or_insert_with(|| {
                names.push(name(deck, k, &names));
                names.len() - 1
            }));
        }
    }
    (body_of, names)
}

/// Whether a section has an element.
fn is_member(deck: &Deck, section: &Section, element: usize) -> bool {
    let members = &deck.element_sets[section.set].members;
    members.binary_search(&element).is_ok()
}

/// Name of a body by one of its elements: the set of its section, with the element if the name is in use.
fn name(deck: &Deck, element: usize, used: &[String]) -> String {
    let label = deck.elements[element].label;
    let mut sections = deck.sections.iter();
    match sections.find(|section| is_member(deck, section, element)) {
        None => format!("the body of element {label}"),
        Some(section) => match deck.element_sets[section.set].name.clone() {
            name if used.contains(&name) => format!("{name} (element {label})"),
            name => name,
        },
    }
}
