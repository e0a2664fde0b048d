//! Supports, prescribed displacements, loads, increments and output requests of a deck.

use super::curves::{Clock, StepValues, curve, scaled};
use super::{DeckObjects, Fault, MESH};
use crate::format::error::at;
use crate::format::error::bail;
use crate::format::given::NodeSet;
use crate::format::spec::{LoadSpec, MonitorSpec, Nodes, Quantity, SupportSpec};
use std::collections::{BTreeMap, HashMap};
use stickslip_core::groups::{distinct, marked};
use stickslip_core::model::{Axis, Component};
use stickslip_exchange::inp::DeckLocation;
use stickslip_exchange::inp::deck::{Direction, Family, Step, Value, Volume, VolumeKind};

/// The values on a target, step by step, and their first location.
struct Course {
    place: DeckLocation,
    given: Vec<StepValues>,
}

/// A value given in a step: its target, value, amplitude and location.
type StepValue<T> = (T, f64, Option<usize>, DeckLocation);
/// An element and one of its sides.
type Side = (usize, usize);
/// Key of volume forces that form one load: body, axis, kind and the curve.
type VolumeLoadKey = (usize, usize, VolumeKind, Vec<u64>);

/// The axes on which a volume force acts, with its components.
fn parts(load: Volume) -> Vec<(usize, f64)> {
    match load {
        Volume::Force { axis, value } => vec![(axis, value)],
        Volume::Gravity { acceleration, .. } => vec![(0, acceleration[0]), (1, acceleration[1])],
    }
}

/// A value and its amplitude.
type TimedValue = (f64, Vec<(f64, f64)>);

/// Nodal values in the form that [`DeckObjects::courses`] takes.
fn listed(values: &[Value]) -> Vec<StepValue<(usize, Direction)>> {
    values
        .iter()
        .map(|value| (value.target(), value.value, value.amplitude, value.place))
        .collect()
}

/// Points of a curve as a comparison key.
fn bits(points: &[(f64, f64)]) -> Vec<u64> {
    points
        .iter()
        .flat_map(|(at, value)| [at.to_bits(), value.to_bits()])
        .collect()
}

impl DeckObjects<'_> {
    pub(super) fn loads(&mut self, clock: &Clock) -> Result<(), Fault> {
        self.motions(clock)?;
        self.forces(clock)?;
        self.pressures(clock)?;
        self.weights(clock)?;
        self.expansions(clock)?;
        self.monitors();
        Ok(())
    }

    fn add_load(&mut self, place: DeckLocation, load: LoadSpec) {
        self.origin.note(at!["loads", self.spec.loads.len()], place);
        self.spec.loads.push(load);
    }

    /// The course of the value on each target: `values` lists target, value, amplitude and location. Unless `adds` is set, a
    /// later value of a step replaces an earlier one. Values that are added must have the same amplitude; CalculiX requires
    /// this too, except for GRAV.
    fn courses<T: Ord>(
        &self,
        values: impl Fn(&Step) -> Vec<StepValue<T>>,
        new: impl Fn(&Step) -> bool,
        adds: bool,
    ) -> Result<BTreeMap<T, Course>, Fault> {
        let steps = &self.deck.steps;
        let empty = || -> Vec<StepValues> {
            steps
                .iter()
                .map(|step| StepValues {
                    values: Vec::new(),
                    new: new(step),
                    at_once: step.at_once,
                })
                .collect()
        };
        let mut courses = BTreeMap::new();
        for (k, step) in steps.iter().enumerate() {
            for (target, value, amplitude, place) in values(step) {
                let course = courses.entry(target).or_insert_with(|| Course {
                    place,
                    given: empty(),
                });
                let here = &mut course.given[k].values;
                if !adds {
                    here.clear();
                }
                if here.first().is_some_and(|(_, other)| *other != amplitude) {
                    bail!(
                        place,
                        "the load is given again in this step, with another amplitude; give it one amplitude that contains both"
                    );
                }
                here.push((value, amplitude));
            }
        }
        Ok(courses)
    }

    fn is_beam_node(&self) -> Vec<bool> {
        let elements = self.deck.elements.iter();
        let beams = elements.filter(|e| e.kind.family == Family::Beam);
        marked(self.deck.nodes.len(), beams.flat_map(|e| &e.nodes))
    }

    fn motions(&mut self, clock: &Clock) -> Result<(), Fault> {
        let mut courses =
            self.courses(|step| listed(&step.motions), |step| step.new_motions, false)?;
        let mut from_model: BTreeMap<(usize, Direction), DeckLocation> = BTreeMap::new();
        for support in &self.deck.supports {
            from_model.entry(support.target()).or_insert(support.place);
        }
        let on_beam = self.is_beam_node();
        let moves = |&(node, direction): &(usize, Direction)| {
            self.used[node] && (direction != Direction::Rotation || on_beam[node])
        };
        for (&(node, direction), course) in &courses {
            let mut values = course.given.iter().flat_map(|given| &given.values);
            let is_turned = direction == Direction::Rotation && values.any(|(v, _)| *v != 0.0);
            if is_turned && self.used[node] && !on_beam[node] {
                bail!(
                    course.place,
                    "node {} is not on a beam, so it has no rotation to prescribe",
                    self.deck.nodes[node].label
                );
            }
        }
        courses.retain(|target, _| moves(target));
        from_model.retain(|target, _| moves(target));
        for target in from_model.keys().chain(courses.keys()) {
            self.stays(target, courses.get(target), from_model.contains_key(target))?;
        }
        self.held = from_model.keys().chain(courses.keys()).copied().collect();
        let mut held: BTreeMap<usize, (Vec<Component>, DeckLocation)> = BTreeMap::new();
        let mut hold = |(node, direction): (usize, Direction), place: DeckLocation| {
            held.entry(node)
                .or_insert((Vec::new(), place))
                .0
                .push(component(direction));
        };
        let mut moved: Vec<DeckMotion> = Vec::new();
        let mut known: HashMap<(Direction, Vec<u64>), usize> = HashMap::new();
        for (target, place) in from_model
            .iter()
            .filter(|(target, _)| !courses.contains_key(target))
        {
            hold(*target, *place);
        }
        for (&(node, direction), course) in &courses {
            let points = curve(clock, &self.deck.amplitudes, &course.given);
            let Some((value, scale)) = scaled(&points) else {
                hold((node, direction), course.place);
                continue;
            };
            let group = *known
                .entry((direction, bits(&points)))
                .or_insert(moved.len());
            if group == moved.len() {
                moved.push(DeckMotion {
                    nodes: Vec::new(),
                    direction,
                    value,
                    scale,
                    place: course.place,
                });
            }
            moved[group].nodes.push(node);
        }
        self.supports(held);
        for group in moved {
            let node = self.group(&group.nodes, "MOVED");
            self.add_load(
                group.place,
                LoadSpec::Displacement {
                    node,
                    component: component(group.direction),
                    value: group.value,
                    scale: group.scale,
                },
            );
        }
        Ok(())
    }

    /// Rejects degrees of freedom that are prescribed in some steps and free in others.
    fn stays(
        &self,
        target: &(usize, Direction),
        course: Option<&Course>,
        from_model: bool,
    ) -> Result<(), Fault> {
        let label = self.deck.nodes[target.0].label;
        let direction = component(target.1);
        let given = |k: usize| course.is_some_and(|course| !course.given[k].values.is_empty());
        for (k, step) in self.deck.steps.iter().enumerate() {
            if step.new_motions && !given(k) && (k > 0 || from_model) {
                bail!(
                    step.place,
                    "OP=NEW frees the {direction} of node {label} in this step; a prescribed direction must stay prescribed in all steps"
                );
            }
            if given(k) && k > 0 && !from_model && !(0..k).any(given) {
                let place = course.map_or(step.place, |course| course.place);
                bail!(
                    place,
                    "the {direction} of node {label} is free in earlier steps; a prescribed direction must be prescribed from the first step on"
                );
            }
        }
        Ok(())
    }

    fn supports(&mut self, held: BTreeMap<usize, (Vec<Component>, DeckLocation)>) {
        let mut alike: Vec<(Vec<Component>, DeckLocation, Vec<usize>)> = Vec::new();
        for (node, (components, place)) in held {
            for component in &components {
                match component {
                    Component::X => self.still[node][0] = true,
                    Component::Y => self.still[node][1] = true,
                    Component::Rotation => {}
                }
            }
            match alike.iter_mut().find(|(of, ..)| *of == components) {
                Some((.., nodes)) => nodes.push(node),
                None => alike.push((components, place, vec![node])),
            }
        }
        for (fix, place, nodes) in alike {
            let node = self.group(&nodes, "HELD");
            self.origin
                .note(at!["supports", self.spec.supports.len()], place);
            self.spec.supports.push(SupportSpec { node, fix });
        }
    }

    /// A name for a list of nodes: the number of a single node, else a set, if possible one of the deck.
    pub(super) fn group(&mut self, nodes: &[usize], wanted: &str) -> String {
        if let [only] = nodes {
            return self.node(*only);
        }
        let labels: Vec<usize> = nodes
            .iter()
            .map(|&n| self.deck.nodes[n].label as usize)
            .collect();
        let own = self.deck.node_sets.iter().find(|set| {
            set.members
                .iter()
                .filter(|&&node| self.used[node])
                .eq(nodes.iter())
        });
        let Some(Nodes::Given { id, sets, .. }) = self.spec.nodes.first_mut() else {
            return wanted.to_owned();
        };
        if let Some(known) = sets.iter().find(|set| set.nodes == labels) {
            return format!("{id}.{}", known.name);
        }
        let name = self.free.take(own.map_or(wanted, |set| &set.name));
        let whole = format!("{id}.{name}");
        sets.push(NodeSet {
            name,
            nodes: labels,
        });
        whole
    }

    fn forces(&mut self, clock: &Clock) -> Result<(), Fault> {
        let courses = self.courses(|step| listed(&step.forces), |step| step.new_forces, true)?;
        let on_beam = self.is_beam_node();
        for ((node, direction), course) in courses {
            let label = self.deck.nodes[node].label;
            if !self.used[node] {
                bail!(
                    course.place,
                    "node {label} belongs to no element, so a force there has no effect"
                );
            }
            if direction == Direction::Rotation && !on_beam[node] {
                bail!(
                    course.place,
                    "node {label} is not on a beam, so it cannot carry a moment"
                );
            }
            let points = curve(clock, &self.deck.amplitudes, &course.given);
            let Some((value, scale)) = scaled(&points) else {
                continue;
            };
            if self.held.contains(&(node, direction)) {
                self.add_note(
                    course.place,
                    "forces along restrained directions go into the support and are left out",
                );
                continue;
            }
            let name = self.node(node);
            self.add_load(
                course.place,
                match direction {
                    Direction::Rotation => LoadSpec::Moment {
                        node: name,
                        value,
                        scale,
                    },
                    _ => LoadSpec::Force {
                        node: name,
                        x: if direction == Direction::X {
                            value
                        } else {
                            0.0
                        },
                        y: if direction == Direction::Y {
                            value
                        } else {
                            0.0
                        },
                        scale,
                    },
                },
            );
        }
        Ok(())
    }

    /// Pressures: sides with the same pressure form one load.
    fn pressures(&mut self, clock: &Clock) -> Result<(), Fault> {
        let listed = |step: &Step| {
            step.pressures
                .iter()
                .map(|p| ((p.element, p.side), p.value, p.amplitude, p.place))
                .collect()
        };
        let courses = self.courses(listed, |step| step.new_pressures, true)?;
        let mut alike: Vec<(Vec<Side>, TimedValue, DeckLocation)> = Vec::new();
        let mut known: HashMap<Vec<u64>, usize> = HashMap::new();
        for (side, course) in courses {
            let points = curve(clock, &self.deck.amplitudes, &course.given);
            let Some(acts) = scaled(&points) else {
                continue;
            };
            if self.is_held(side) {
                self.add_note(
                    course.place,
                    "pressure on restrained sides goes into the supports and is left out",
                );
                continue;
            }
            let group = *known.entry(bits(&points)).or_insert(alike.len());
            if group == alike.len() {
                alike.push((Vec::new(), acts, course.place));
            }
            alike[group].0.push(side);
        }
        for (sides, (value, scale), place) in alike {
            for name in self.lines(&sides, "PRESSED", place) {
                self.add_load(
                    place,
                    LoadSpec::Pressure {
                        along: format!("{MESH}.{name}"),
                        value,
                        scale: scale.clone(),
                    },
                );
            }
        }
        Ok(())
    }

    /// Whether no node of a side can move freely.
    fn is_held(&self, (element, side): (usize, usize)) -> bool {
        let held = |node: usize, direction| self.held.contains(&(node, direction));
        let nodes = self.deck.side(element, side);
        nodes
            .into_iter()
            .all(|node| held(node, Direction::X) && held(node, Direction::Y))
    }

    /// Volume forces, one load per component and body.
    fn weights(&mut self, clock: &Clock) -> Result<(), Fault> {
        let deck = self.deck;
        let listed = |step: &Step| {
            let parts = step.weights.iter().flat_map(|weight| {
                parts(weight.load).into_iter().map(|(axis, value)| {
                    let target = (weight.element, axis, weight.load.kind());
                    (target, value, weight.amplitude, weight.place)
                })
            });
            parts.collect()
        };
        let courses = self.courses(listed, |step| step.new_weights, true)?;
        let mut alike: BTreeMap<VolumeLoadKey, (usize, TimedValue, DeckLocation)> = BTreeMap::new();
        for ((element, axis, kind), course) in courses {
            let points = curve(clock, &deck.amplitudes, &course.given);
            let (Some(acts), Some(body)) = (scaled(&points), self.body_of[element]) else {
                let label = deck.elements[element].label;
                match self.body_of[element] {
                    Some(_) => continue,
                    None => {
                        bail!(
                            course.place,
                            "element {label} is a beam; only continua have weight here"
                        );
                    }
                }
            };
            alike
                .entry((body, axis, kind, bits(&points)))
                .or_insert((0, acts, course.place))
                .0 += 1;
        }
        for ((body, axis, kind, _), (count, (value, scale), place)) in alike {
            let members = self.body_of.iter().filter(|of| **of == Some(body)).count();
            let on = self.spec.bodies[body].id().to_owned();
            if count < members {
                bail!(
                    place,
                    "the load acts on {count} of the {members} connected elements of {on}; it must act on all of them"
                );
            }
            let density = match kind {
                VolumeKind::Gravity(_) => self.density(body, place)?,
                VolumeKind::Force(_) => 1.0,
            };
            let part = |k: usize| if k == axis { value * density } else { 0.0 };
            self.add_load(
                place,
                LoadSpec::Volume {
                    on,
                    x: part(0),
                    y: part(1),
                    scale,
                },
            );
        }
        Ok(())
    }

    /// Thermal expansions, one per body whose temperature changes.
    fn expansions(&mut self, clock: &Clock) -> Result<(), Fault> {
        let deck = self.deck;
        let warmed = |step: &Step| {
            let values = step.temperatures.iter();
            values
                .map(|v| (v.node, v.value, v.amplitude, v.place))
                .collect()
        };
        let courses = self.courses(warmed, |step| step.new_temperatures, false)?;
        if courses.is_empty() {
            return Ok(());
        }
        let rise = |node: usize| {
            let course = courses.get(&node)?;
            let points = curve(clock, &deck.amplitudes, &course.given);
            Some((scaled(&points)?, course.place))
        };
        let mut of_body: BTreeMap<usize, (Option<(TimedValue, DeckLocation)>, usize)> =
            BTreeMap::new();
        for (k, element) in deck.elements.iter().enumerate() {
            for &node in &element.nodes {
                let own = rise(node);
                let Some(body) = self.body_of[k] else {
                    match own {
                        Some((_, place)) => bail!(
                            place,
                            "element {} is a beam; only continua expand here",
                            element.label
                        ),
                        None => continue,
                    }
                };
                let (first, _) = of_body.entry(body).or_insert_with(|| (own.clone(), k));
                let same =
                    own.as_ref().map(|(acts, _)| acts) == first.as_ref().map(|(acts, _)| acts);
                if let Some((_, place)) = own.or_else(|| first.clone()).filter(|_| !same) {
                    bail!(
                        place,
                        "the temperature of node {} differs from that of other nodes of {}; it must be uniform in a body",
                        deck.nodes[node].label,
                        self.spec.bodies[body].id()
                    );
                }
            }
        }
        for (body, (rise, element)) in of_body {
            let Some(((value, scale), place)) = rise else {
                continue;
            };
            let material = &deck.materials[self.material_of[element]];
            let Some(coefficient) = material.expansion else {
                bail!(
                    place,
                    "material {} has no *EXPANSION with a single isotropic coefficient",
                    material.name
                );
            };
            self.add_load(
                place,
                LoadSpec::Expansion {
                    on: self.spec.bodies[body].id().to_owned(),
                    strain: coefficient * value,
                    scale,
                },
            );
        }
        Ok(())
    }

    /// Density of the material of a body.
    fn density(&self, body: usize, place: DeckLocation) -> Result<f64, Fault> {
        let element = self.body_of.iter().position(|of| *of == Some(body));
        let material = element.map(|element| &self.deck.materials[self.material_of[element]]);
        material
            .and_then(|material| material.density)
            .ok_or_else(|| Fault::new(place, "the material has weight, but no *DENSITY"))
    }

    /// The increments, and the path of the load factor.
    pub(super) fn history(&mut self, clock: &Clock) {
        let deck = self.deck;
        let history = &mut self.spec.history;
        history.path = clock.path();
        let largest = clock.increments().reduce(f64::max);
        history.increment = largest.unwrap_or(history.increment);
        if clock.increments().any(|size| size != history.increment) {
            history.increments = clock.increments().collect();
        }
        let smallest = clock.increments().fold(f64::INFINITY, f64::min);
        let least = deck
            .steps
            .iter()
            .filter_map(|step| step.time.least)
            .min_by(f64::total_cmp);
        history.least = least.filter(|&least| least < smallest);
        for (k, step) in deck.steps.iter().enumerate() {
            for place in [
                at!["history", "path", k + 1],
                at!["history", "increments", k],
            ] {
                self.origin.note(place, step.static_place);
            }
        }
        if let Some(first) = deck.steps.first() {
            self.origin.note(at!["history"], first.static_place);
        }
        if let Some(step) = deck
            .steps
            .iter()
            .find(|step| !step.time.direct && step.time.initial < step.time.period)
        {
            self.add_note(
                step.static_place,
                "automatic increments: a step is divided into increments of the size of its first one, but \
                 into at most ten unless its maximum increment requires more; see history.increment",
            );
        }
    }

    /// Monitors for the displacements of printed nodes and for the contact force.
    fn monitors(&mut self) {
        let deck = self.deck;
        let sets = deck.printed.iter().map(|&set| &deck.node_sets[set]);
        let printed = sets.flat_map(|set| set.members.iter().copied());
        for node in distinct(printed.filter(|&node| self.used[node])) {
            for component in [Component::X, Component::Y] {
                self.spec.monitors.push(MonitorSpec {
                    name: format!("u_{component} {}", deck.nodes[node].label),
                    of: Quantity::Displacement {
                        node: self.node(node),
                        component,
                    },
                });
            }
        }
        if deck.pairs.is_empty() && deck.ties.is_empty() {
            return;
        }
        for (name, component) in [("contact x", Axis::X), ("contact y", Axis::Y)] {
            self.spec.monitors.push(MonitorSpec {
                name: name.to_owned(),
                of: Quantity::Contact {
                    node: None,
                    component,
                },
            });
        }
    }
}

/// Nodes with the same prescribed displacement.
struct DeckMotion {
    nodes: Vec<usize>,
    direction: Direction,
    value: f64,
    scale: Vec<(f64, f64)>,
    place: DeckLocation,
}

fn component(direction: Direction) -> Component {
    match direction {
        Direction::X => Component::X,
        Direction::Y => Component::Y,
        // Only outlines have z, and they do not become scenes.
        Direction::Z | Direction::Rotation => Component::Rotation,
    }
}
