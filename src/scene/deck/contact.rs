//! Contact pairs and ties of a deck.

use super::super::corners::{self, CORNER};
use super::{DeckObjects, Fault, MESH};
use crate::format::contact_law::{ContactLaw, FrictionSpec};
use crate::format::error::at;
use crate::format::error::bail;
use crate::format::given::SideSet;
use crate::format::spec::{Nodes, SlaveSpec, SurfaceSpec};
use crate::number::sig4;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use stickslip_core::groups::Connected;
use stickslip_core::model::{InitialGaps, SlavePoints};
use stickslip_core::plane::{distance, distance_to_segment, range};
use stickslip_exchange::inp::DeckLocation;
use stickslip_exchange::inp::deck::{Adjust, Faces, Family, Normal, Pair, Tie};

/// Without a POSITION TOLERANCE, nodes within this fraction of a side's length are tied, as in CalculiX.
const TOLERANCE: f64 = 0.025;

/// The contact law between a slave node and the surfaces that it may touch.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Laws {
    law: ContactLaw,
    friction: f64,
    stick: Option<f64>,
    by: SlavePoints,
}

/// A contact pair or a tie.
struct DeckContact {
    /// The slave surface.
    name: String,
    slaves: Vec<usize>,
    /// The sides of a pair's slave surface; empty if it has nodes, is on beams, or belongs to a tie.
    sides: Vec<(usize, usize)>,
    master: usize,
    laws: Laws,
    place: DeckLocation,
    /// Locations of the law and the friction; a tie has neither.
    of_laws: Option<[DeckLocation; 2]>,
}

impl DeckObjects<'_> {
    pub(super) fn contacts(&mut self) -> Result<(), Fault> {
        let mut all = Vec::new();
        for pair in &self.deck.pairs {
            let interaction = &self.deck.interactions[pair.interaction];
            let law = match interaction.normal {
                Normal::Hard => ContactLaw::Hard,
                Normal::Linear { stiffness } => ContactLaw::Penalty { stiffness },
                Normal::Tied { stiffness } if pair.faces => ContactLaw::Bonded { stiffness },
                Normal::Tied { .. } => ContactLaw::Tied,
            };
            let tied = law.is_tied();
            let by = if pair.faces && law.stiffness().is_some() && self.is_of_solids(pair) {
                SlavePoints::Surface
            } else {
                SlavePoints::Node
            };
            let of_nodes = matches!(self.deck.surfaces[pair.slave].of, Faces::Nodes(_));
            if pair.faces && by.is_node() {
                let why = match law.stiffness() {
                    None => {
                        "SURFACE TO SURFACE is solved as node to surface: hard contact holds at each slave node, not at points \
                         of the sides, so forces differ from CalculiX's, by up to 58 % with one element per side and less on \
                         finer meshes; PRESSURE-OVERCLOSURE=LINEAR or TIED is solved as written"
                    }
                    Some(_) if of_nodes => {
                        "SURFACE TO SURFACE is solved as node to surface, because the slave is a surface of nodes and has no \
                         sides; give it sides with *SURFACE, TYPE=ELEMENT"
                    }
                    Some(_) => {
                        "SURFACE TO SURFACE is solved as node to surface, because beams have no sides with points"
                    }
                };
                self.add_note(pair.place, why);
            }
            let stick = interaction.stick.filter(|_| law != ContactLaw::Tied);
            if of_nodes && (law.stiffness().is_some() || stick.is_some()) {
                self.add_note(
                    pair.place,
                    "the slave is a surface of nodes: the areas for the stiffness and the stick slope are those of the sides \
                     between its nodes, and differ from CalculiX's; with *SURFACE, TYPE=ELEMENT they are those of its sides",
                );
            }
            if law == ContactLaw::Tied {
                self.add_note(
                    interaction.normal_place,
                    "TIED is rigid: stiffness and stick slope are ignored",
                );
            }
            if pair.small_sliding {
                self.add_note(
                    pair.place,
                    "SMALL SLIDING is ignored: the projection of a slave node on its master is computed in each iteration",
                );
            }
            all.push(DeckContact {
                name: self.deck.surfaces[pair.slave].name.clone(),
                slaves: self.slaves_of(pair.slave),
                sides: self.sides_of_solids(pair.slave),
                master: pair.master,
                laws: Laws {
                    law,
                    friction: if tied { 0.0 } else { interaction.friction },
                    stick,
                    by,
                },
                place: pair.place,
                of_laws: Some([interaction.normal_place, interaction.friction_place]),
            });
        }
        for tie in &self.deck.ties {
            let slaves = self.near(tie)?;
            all.push(DeckContact {
                name: self.deck.surfaces[tie.slave].name.clone(),
                slaves,
                sides: Vec::new(),
                master: tie.master,
                laws: Laws {
                    law: ContactLaw::Tied,
                    friction: 0.0,
                    stick: None,
                    by: SlavePoints::Node,
                },
                place: tie.place,
                of_laws: None,
            });
        }
        if let Some(pair) = self
            .deck
            .pairs
            .first()
            .filter(|_| self.deck.steps.iter().all(|step| !step.nlgeom))
        {
            self.add_note(
                pair.place,
                "without NLGEOM strains are small, but contact is detected at the displaced positions",
            );
        }
        self.adjusted()?;
        let surfaces = self.masters(&all);
        self.groups(&all, &surfaces)
    }

    /// Whether both surfaces of a pair consist of sides of continua.
    fn is_of_solids(&self, pair: &Pair) -> bool {
        let surfaces = [pair.slave, pair.master];
        surfaces
            .iter()
            .all(|&surface| !self.sides_of_solids(surface).is_empty())
    }

    /// The sides of a surface of continua; empty if it has nodes, or sides of beams.
    fn sides_of_solids(&self, surface: usize) -> Vec<(usize, usize)> {
        let is_solid = |&(element, _): &(usize, usize)| {
            self.deck.elements[element].kind.family != Family::Beam
        };
        match &self.deck.surfaces[surface].of {
            Faces::Elements(sides) if sides.iter().all(is_solid) => sides.clone(),
            _ => Vec::new(),
        }
    }

    /// The names of the sides of a group of slave nodes, whose pairs are `touched`. None if the sides follow from the nodes: all
    /// of their nodes are in the group, and those of no other side are.
    fn named_sides(
        &mut self,
        all: &[DeckContact],
        touched: &[usize],
        nodes: &[usize],
        wanted: &str,
    ) -> Vec<String> {
        let deck = self.deck;
        if touched.iter().any(|&k| all[k].sides.is_empty()) {
            return Vec::new();
        }
        let members: HashSet<usize> = nodes.iter().copied().collect();
        // The nodes of a side may all be fixed, or belong to other groups.
        let is_near = |&(element, side): &(usize, usize)| {
            let nodes = deck.side(element, side);
            nodes.iter().any(|node| members.contains(node))
        };
        let sides = touched.iter().flat_map(|&k| all[k].sides.iter().copied());
        let sides: BTreeSet<(usize, usize)> = sides.filter(is_near).collect();
        let is_whole = |&(element, side): &(usize, usize)| {
            let nodes = deck.side(element, side);
            nodes.iter().all(|node| members.contains(node))
        };
        let solids = deck.elements.iter().enumerate();
        let solids = solids.filter(|(_, element)| {
            let own = element.nodes.iter().filter(|node| members.contains(node));
            element.kind.family != Family::Beam && own.count() > 1
        });
        let mut others = solids
            .flat_map(|(k, element)| (0..element.kind.cell.corners()).map(move |side| (k, side)))
            .filter(|side| !sides.contains(side));
        if sides.iter().all(is_whole) && !others.any(|side| is_whole(&side)) {
            return Vec::new();
        }
        let sides: Vec<(usize, usize)> = sides.into_iter().collect();
        let place = all[touched[0]].place;
        let names = self.lines(&sides, &format!("{wanted}-SIDES"), place);
        names
            .into_iter()
            .map(|name| format!("{MESH}.{name}"))
            .collect()
    }

    fn slaves_of(&self, surface: usize) -> Vec<usize> {
        self.deck
            .surface_nodes(surface)
            .into_iter()
            .filter(|node| self.used[*node])
            .collect()
    }

    /// The master surfaces as lines of sides, with the ids of their connected parts.
    fn masters(&mut self, all: &[DeckContact]) -> BTreeMap<usize, Vec<String>> {
        let deck = self.deck;
        let mut made = BTreeMap::new();
        for touching in all {
            if made.contains_key(&touching.master) {
                continue;
            }
            let surface = &deck.surfaces[touching.master];
            let Faces::Elements(sides) = &surface.of else {
                continue;
            };
            let ids: Vec<String> = self.lines(sides, &surface.name, surface.place);
            let [convex, concave] = self.corners(sides);
            let cut = convex && self.have_outsides(touching.master, all);
            let smooth =
                (cut || !convex) && !concave && self.is_made_smooth(touching.master, sides, all);
            if cut {
                self.add_note(
                    surface.place,
                    "the surface is cut at its convex corners; a slave node touches the pieces that its own side faces",
                );
            }
            if smooth {
                self.add_note(
                    surface.place,
                    "the surface is smoothed into one curve through its nodes, because its contact has a \
                     stiffness: a node inside would hop between two sides where the normal jumps",
                );
            }
            let by_nodes = all
                .iter()
                .filter(|other| other.master == touching.master)
                .all(|other| other.laws.by.is_node());
            for id in &ids {
                self.origin
                    .note(at!["surfaces", self.spec.surfaces.len()], surface.place);
                self.spec.surfaces.push(SurfaceSpec {
                    id: id.clone(),
                    along: format!("{MESH}.{id}"),
                    past_ends: (!by_nodes).then_some(0.0),
                    smooth,
                    cut,
                    ..SurfaceSpec::default()
                });
            }
            made.insert(touching.master, ids);
        }
        made
    }

    /// The nodes of sides of elements.
    fn node_lists(&self, sides: &[(usize, usize)]) -> Vec<Vec<usize>> {
        sides
            .iter()
            .map(|&(element, side)| self.deck.side(element, side))
            .collect()
    }

    /// Whether to smooth a master surface without real corners: its slave nodes have a compliant law, and it can deform.
    fn is_made_smooth(&self, master: usize, sides: &[(usize, usize)], all: &[DeckContact]) -> bool {
        let gives = |touching: &DeckContact| {
            let penalty = matches!(touching.laws.law, ContactLaw::Penalty { .. });
            let gives = penalty || touching.laws.stick.is_some();
            // Points of faces integrate over the sides themselves.
            touching.master == master && touching.laws.by.is_node() && gives
        };
        let sides = self.node_lists(sides);
        all.iter().any(gives)
            && sides.len() > 1
            && sides
                .iter()
                .flatten()
                .any(|node| self.still[*node] != [true; 2])
    }

    /// Whether these sides have a real convex corner, and a real concave one.
    fn corners(&self, sides: &[(usize, usize)]) -> [bool; 2] {
        let sides = self.node_lists(sides);
        let starts: HashMap<usize, &Vec<usize>> =
            sides.iter().map(|side| (side[0], side)).collect();
        let turns = || {
            sides.iter().filter_map(|side| {
                let next = starts.get(side.last()?)?;
                Some(corners::turn(side, next, |node| {
                    self.deck.nodes[node].plane()
                }))
            })
        };
        let (mut left, mut right) = (turns(), turns());
        [
            left.any(|turn| turn > CORNER),
            right.any(|turn| turn < -CORNER),
        ]
    }

    /// Whether all slave nodes of a master are on continua, which have an outward side.
    fn have_outsides(&self, master: usize, all: &[DeckContact]) -> bool {
        let on: HashSet<usize> = self
            .deck
            .elements
            .iter()
            .filter(|element| element.kind.family != Family::Beam)
            .flat_map(|e| e.nodes.iter().copied())
            .collect();
        let mut touching = all.iter().filter(|touching| touching.master == master);
        touching.all(|touching| touching.slaves.iter().all(|node| on.contains(node)))
    }

    /// Adds sides of elements as lines of the mesh, one per connected part; returns their names.
    pub(super) fn lines(
        &mut self,
        sides: &[(usize, usize)],
        name: &str,
        place: DeckLocation,
    ) -> Vec<String> {
        let sides = self.node_lists(sides);
        let mut groups = Connected::new(self.deck.nodes.len());
        sides.iter().for_each(|side| groups.join_all(side));
        // By the first of their sides.
        let mut pieces: Vec<(usize, Vec<Vec<usize>>)> = Vec::new();
        for side in sides {
            let root = groups.root(side[0]);
            let labels = side
                .iter()
                .map(|&node| self.deck.nodes[node].label as usize);
            let labels = labels.collect();
            match pieces.iter_mut().find(|(of, _)| *of == root) {
                Some((_, piece)) => piece.push(labels),
                None => pieces.push((root, vec![labels])),
            }
        }
        let enter = |(_, sides): (usize, Vec<Vec<usize>>)| {
            let name = self.free.take(name);
            if let Some(Nodes::Given { sides: sets, .. }) = self.spec.nodes.first_mut() {
                self.origin
                    .note(at!["nodes", 0, "sides", sets.len()], place);
                sets.push(SideSet {
                    name: name.clone(),
                    sides,
                });
            }
            name
        };
        pieces.into_iter().map(enter).collect()
    }

    /// Slave nodes grouped by candidate surfaces and law.
    fn groups(
        &mut self,
        all: &[DeckContact],
        surfaces: &BTreeMap<usize, Vec<String>>,
    ) -> Result<(), Fault> {
        let mut of_node: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        let mut groups: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
        for (k, touching) in all.iter().enumerate() {
            let rigid = self
                .deck
                .surface_nodes(touching.master)
                .iter()
                .all(|&n| self.still[n] == [true; 2]);
            // A fixed node over a fixed surface has no unknown force.
            let moves = |node: &&usize| !(rigid && self.still[**node] == [true; 2]);
            if !touching.laws.by.is_node() {
                // Points need whole sides, with fixed nodes and those of other pairs.
                let is_same = |(of, _): &&mut (Vec<usize>, Vec<usize>)| {
                    let first = &all[of[0]];
                    first.slaves == touching.slaves && first.laws == touching.laws
                };
                match groups.iter_mut().find(is_same) {
                    Some((of, _)) => of.push(k),
                    None if touching.slaves.iter().any(|node| moves(&node)) => {
                        groups.push((vec![k], touching.slaves.clone()));
                    }
                    None => {}
                }
                continue;
            }
            for &node in touching.slaves.iter().filter(moves) {
                of_node.entry(node).or_default().push(k);
            }
        }
        let mut known: HashMap<Vec<usize>, usize> = HashMap::new();
        for (node, touched) in of_node {
            let group = *known.entry(touched.clone()).or_insert(groups.len());
            if group == groups.len() {
                groups.push((touched, Vec::new()));
            }
            groups[group].1.push(node);
        }
        groups.sort_by_key(|(_, nodes)| nodes.first().copied());
        for (touched, nodes) in groups {
            self.group_of(all, surfaces, &touched, &nodes)?;
        }
        self.common_friction();
        Ok(())
    }

    /// Friction common to all pairs becomes the scene's, so that it can be set in one place.
    fn common_friction(&mut self) {
        let mut own = self.spec.slaves.iter().filter_map(|slaves| slaves.friction);
        let Some(first) = own.next().filter(|first| own.all(|other| other == *first)) else {
            return;
        };
        self.spec.friction = first;
        self.spec
            .slaves
            .iter_mut()
            .for_each(|slaves| slaves.friction = None);
    }

    fn group_of(
        &mut self,
        all: &[DeckContact],
        surfaces: &BTreeMap<usize, Vec<String>>,
        touched: &[usize],
        nodes: &[usize],
    ) -> Result<(), Fault> {
        let Some(first) = touched.first().map(|&k| &all[k]) else {
            return Ok(());
        };
        if let Some(other) = touched
            .iter()
            .map(|&k| &all[k])
            .find(|other| other.laws != first.laws)
        {
            let label = self.deck.nodes[nodes[0]].label;
            bail!(
                other.place,
                "node {label} is a slave of another pair with a different law; a node can have only one law"
            );
        }
        let masters: BTreeSet<usize> = touched.iter().map(|&k| all[k].master).collect();
        let on: Vec<String> = masters
            .iter()
            .filter_map(|master| surfaces.get(master))
            .flatten()
            .cloned()
            .collect();
        let laws = first.laws;
        let wanted = match all.iter().find(|other| other.slaves == nodes) {
            Some(whole) => whole.name.as_str(),
            None => "SLAVES",
        };
        let sides = self.named_sides(all, touched, nodes, wanted);
        let nodes = vec![self.group(nodes, wanted)];
        let here = at!["slaves", self.spec.slaves.len()];
        if let Some([law, friction]) = first.of_laws {
            self.origin.note(here.then("law"), law);
            self.origin.note(here.then("friction"), friction);
            self.origin.note(here.then("stick"), friction);
            self.origin.note(at!["friction"], friction);
        }
        self.origin.note(here, first.place);
        self.spec.slaves.push(SlaveSpec {
            nodes,
            on,
            friction: (!laws.law.is_tied()).then(|| rough(laws.friction)),
            law: laws.law,
            stick: laws.stick,
            by: laws.by,
            sides,
            ..SlaveSpec::default()
        });
        Ok(())
    }

    /// Initial gap adjustment: one choice for the whole scene.
    fn adjusted(&mut self) -> Result<(), Fault> {
        let pairs = &self.deck.pairs;
        let Some(first) = pairs.first() else {
            return Ok(());
        };
        if let Some(other) = pairs.iter().find(|pair| pair.adjust != first.adjust) {
            bail!(
                other.place,
                "ADJUST must be the same for all pairs: initial gaps are adjusted in the whole scene or not at all"
            );
        }
        let gap = match &first.adjust {
            None => return Ok(()),
            Some(Adjust::Within(gap)) => *gap,
            Some(Adjust::Set(set)) => {
                let members = &self.deck.node_sets[*set].members;
                let slaves = pairs
                    .iter()
                    .flat_map(|pair| self.slaves_of(pair.slave))
                    .find(|node| members.binary_search(node).is_err());
                if let Some(node) = slaves {
                    bail!(
                        first.place,
                        "ADJUST names a set without the slave node {}; move either all slave nodes, or those within a distance",
                        self.deck.nodes[node].label
                    );
                }
                self.size()
            }
        };
        self.spec.settings.initial_gaps = InitialGaps::Adjust;
        self.spec.settings.adjust_gap = gap;
        self.origin.note(at!["settings"], first.place);
        Ok(())
    }

    /// Diagonal of the bounding box of all nodes.
    fn size(&self) -> f64 {
        let extent = |axis: usize| {
            let [least, most] = range(self.deck.nodes.iter().map(|node| node.at[axis]));
            most - least
        };
        extent(0).hypot(extent(1))
    }

    /// The nodes of a tie that are close enough to the master.
    fn near(&mut self, tie: &Tie) -> Result<Vec<usize>, Fault> {
        let at = |node: &usize| self.deck.nodes[*node].plane();
        let Faces::Elements(sides) = &self.deck.surfaces[tie.master].of else {
            return Ok(Vec::new());
        };
        let sides: Vec<Vec<usize>> = sides
            .iter()
            .map(|&(e, side)| self.deck.side(e, side))
            .collect();
        let lines: Vec<([f64; 2], [f64; 2])> = sides
            .iter()
            .flat_map(|side| side.windows(2).map(|pair| (at(&pair[0]), at(&pair[1]))))
            .collect();
        let whole: f64 = lines.iter().map(|(a, b)| distance(*b, *a)).sum();
        let tolerance = tie
            .tolerance
            .unwrap_or(TOLERANCE * whole / sides.len().max(1) as f64);
        let slaves = self.slaves_of(tie.slave);
        let near: Vec<usize> = slaves
            .iter()
            .copied()
            .filter(|node| {
                lines
                    .iter()
                    .any(|(a, b)| distance_to_segment(at(node), *a, *b) <= tolerance)
            })
            .collect();
        if near.is_empty() {
            bail!(
                tie.place,
                "no node of the first surface is within {} of the second; see POSITION TOLERANCE",
                sig4(tolerance)
            );
        }
        if near.len() < slaves.len() {
            let text = format!(
                "{} of {} nodes are further than {} away and are not tied",
                slaves.len() - near.len(),
                slaves.len(),
                sig4(tolerance)
            );
            self.add_note(tie.place, &text);
        }
        if !tie.adjust {
            self.add_note(
                tie.place,
                "ADJUST=NO is ignored: tied nodes are moved onto their master",
            );
        }
        Ok(near)
    }
}

/// Coulomb friction with a coefficient.
fn rough(coefficient: f64) -> FrictionSpec {
    FrictionSpec {
        angle: coefficient.atan().to_degrees(),
        ..FrictionSpec::default()
    }
}
