//! Describes unrestrained bodies: their motion, its direction under the loads, what would stop it, and since
//! when they are loose.

use super::facts::{Fact, Part};
use super::failures::pair;
use super::names::{arrow, slave};
use super::round_off::reach;
use std::collections::HashSet;
use stickslip_core::contact::projection::{Projection, projection_at, tangent};
use stickslip_core::fem::pressure::Pressures;
use stickslip_core::linear::singular::LooseMotion;
use stickslip_core::model::Load;
use stickslip_core::plane::dot;
use stickslip_core::{Mode, Model, RigidMotion, Singular, State, Stepper};
use stickslip_scene::{first_of, shortest, sig4};

/// Maximum number of motions described.
const MOST: usize = 3;
/// Maximum number of nodes named.
const MOST_NODES: usize = 4;
/// Arrows that show the motion of a body.
const ARROWS: usize = 8;
/// Rates below this fraction of the largest are zero.
const NONE: f64 = 1e-9;

/// Description of loose bodies, with arrows for the shape.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LooseBodies {
    /// The facts.
    pub facts: Vec<Fact>,
    /// Points on a moving body, with directions of length one at most.
    pub arrows: Vec<[[f64; 2]; 2]>,
}

/// A rigid motion of a body, in the direction of the loads.
pub(super) struct BodyMotion<'a> {
    model: &'a Model,
    places: &'a [[f64; 2]],
    body: usize,
    /// Numbers of its nodes.
    nodes: HashSet<usize>,
    motion: LooseMotion,
    sign: f64,
}

/// Describes rigid motions that nothing resists in a state. The stepper is left at the state.
pub fn loose(stepper: &mut Stepper, state: &State, motions: &[RigidMotion]) -> LooseBodies {
    stepper.restore(state);
    // This locates the contacts; the matrix is not needed and may be singular.
    stepper.norms();
    let at_start = stepper.loose(&state.start.nodes);
    let still = matches!(stepper.loose(&state.nodes), Singular::Rigid { .. });
    let model = stepper.model();
    let places = model.places(&state.u);
    let mut found = LooseBodies::default();
    for motion in motions.iter().take(MOST) {
        let Some(moving) = BodyMotion::new(model, &places, state, motion) else {
            continue;
        };
        found.facts.push(Fact::why(moving.pushed(state)));
        found.facts.push(Fact::why(moving.contacts(state, still)));
        let stopped = moving.stopped(state);
        found.facts.push(Fact::new(Part::Details, stopped));
        found.arrows.extend(moving.arrows());
    }
    let since = since(model, state, &at_start);
    found.facts.push(Fact::new(Part::Details, since));
    found
}

impl<'a> BodyMotion<'a> {
    pub(super) fn new(
        model: &'a Model,
        places: &'a [[f64; 2]],
        state: &State,
        motion: &RigidMotion,
    ) -> Option<Self> {
        let body = model
            .bodies
            .iter()
            .position(|body| body.name == motion.body)?;
        let mut moving = BodyMotion {
            model,
            places,
            body,
            nodes: model.bodies[body].nodes.iter().copied().collect(),
            motion: motion.motion,
            sign: 1.0,
        };
        if moving.power(state) < 0.0 {
            moving.sign = -1.0;
        }
        Some(moving)
    }

    pub(super) fn name(&self) -> &str {
        &self.model.bodies[self.body].name
    }

    /// Velocity of a point of the body: for a translation by a unit vector, or a rotation at rate one.
    fn velocity(&self, at: [f64; 2]) -> [f64; 2] {
        let v = match self.motion {
            LooseMotion::Translation(along) => along,
            LooseMotion::Rotation(about) => [about[1] - at[1], at[0] - about[0]],
        };
        v.map(|x| self.sign * x)
    }

    /// Power of the loads on the body in this motion: a force or a moment.
    fn power(&self, state: &State) -> f64 {
        let model = self.model;
        let rate = |dof: usize| {
            let (node, component) = model.dofs.node_of(dof)?;
            let v = self.velocity(self.places[node]);
            self.has(node).then_some(match (component, self.motion) {
                (axis @ 0..=1, _) => v[axis],
                (_, LooseMotion::Rotation(_)) => self.sign,
                _ => 0.0,
            })
        };
        let at = state.load_factor;
        let of = |load: &Load| Some(load.value * load.scale.at(at) * rate(load.dof)?);
        let dead: f64 = model.loads.iter().filter_map(of).sum();
        let mut following = 0.0;
        let size = |k: usize| model.pressure(k, at);
        Pressures::new(model).each(&state.u, size, |dof, force| {
            following += rate(dof).map_or(0.0, |rate| force * rate);
        });
        dead + following
    }

    fn pushed(&self, state: &State) -> String {
        let power = self.power(state);
        let moves = match self.motion {
            LooseMotion::Translation(along) => {
                let along = along.map(|x| self.sign * x);
                format!("moves along {}", pair(along, 1.0))
            }
            LooseMotion::Rotation(about) => {
                let way = if self.sign > 0.0 {
                    "anticlockwise"
                } else {
                    "clockwise"
                };
                format!("turns {way} about {}", pair(about, reach(self.model)))
            }
        };
        let loads = match (power > 0.0, self.motion) {
            (false, _) => "no load acts in this direction, and none could be carried".to_owned(),
            (true, LooseMotion::Translation(_)) => format!("the loads push with {}", sig4(power)),
            (true, LooseMotion::Rotation(_)) => {
                format!("the loads turn it with moment {}", sig4(power))
            }
        };
        format!(
            "body {} {moves} ({} in the shape); {loads}",
            self.name(),
            self.head()
        )
    }

    /// The arrow of the motion in the shape.
    fn head(&self) -> &'static str {
        match self.motion {
            LooseMotion::Translation([x, y]) => arrow((self.sign * y).atan2(self.sign * x)),
            LooseMotion::Rotation(_) => "arrow",
        }
    }

    /// How many contacts of the body are open, slide or stick; `still` if it is loose with these modes.
    fn contacts(&self, state: &State, still: bool) -> String {
        let own: Vec<usize> = self.own().collect();
        let count = |mode: Mode| own.iter().filter(|s| state.nodes[**s].mode == mode).count();
        let (free, sliding, fixed) = (count(Mode::Free), count(Mode::Sliding), count(Mode::Fixed));
        if own.is_empty() {
            return "the body has no contact, and its supports do not prevent this motion".into();
        }
        let why = match (free, sliding, fixed) {
            (_, 0, 0) if still => "an open node has no resistance",
            (_, _, 0) if still => {
                "a sliding node resists only along its normal: its friction force T_max does not grow with the motion"
            }
            _ if !still => "these modes would hold it, those that were solved do not",
            _ => "the sticking nodes do not prevent this motion",
        };
        format!(
            "of the body's {} contacts, {free} open, {sliding} sliding, {fixed} sticking; {why}",
            own.len()
        )
    }

    /// The contacts of the body, as slave or master.
    fn own(&self) -> impl Iterator<Item = usize> {
        let model = self.model;
        let masters: Vec<bool> = model
            .surfaces
            .iter()
            .map(|surface| surface.nodes().any(|&n| self.has(n)))
            .collect();
        (0..model.contacts.len()).filter(move |&s| {
            let contact = &model.contacts[s];
            let mut carriers = contact.carriers();
            carriers.any(|(node, _)| self.has(node)) || contact.surfaces.iter().any(|&k| masters[k])
        })
    }

    /// Whether a node belongs to the body.
    fn has(&self, node: usize) -> bool {
        self.nodes.contains(&node)
    }

    /// Projection of a contact onto its surface.
    fn over(&self, state: &State, s: usize) -> Option<Projection> {
        let at = self.places[self.model.contacts[s].node];
        let spot = state.nodes[s].spot?;
        Some(projection_at(&self.model.surfaces, spot, self.places, at))
    }

    fn gap(&self, state: &State, s: usize) -> f64 {
        self.over(state, s).map_or(0.0, |over| over.gap)
    }

    /// The contacts of the body that face a surface, with their velocities relative to the surface along n and
    /// t.
    pub(super) fn rates(&self, state: &State) -> Vec<(usize, [f64; 2])> {
        self.own()
            .filter_map(|s| {
                let (node, over) = (self.model.contacts[s].node, self.over(state, s)?);
                let (v, side) = if self.has(node) {
                    (self.velocity(self.places[node]), 1.0)
                } else {
                    (self.velocity(over.foot), -1.0)
                };
                let [n, t] = [over.normal, tangent(over.normal)];
                let along = |d: [f64; 2]| side * dot(v, d);
                Some((s, [along(n), along(t)]))
            })
            .collect()
    }

    /// Why friction cannot hold the body in this translation, if equilibrium alone shows it: all contacts face across the
    /// translation to one side, so that the loads determine the sum of F_n, and neither supports nor other bodies act.
    pub(super) fn exceeds_friction(&self, state: &State) -> Option<String> {
        let LooseMotion::Translation(_) = self.motion else {
            return None;
        };
        let rates = self.rates(state);
        let mut inwards: Option<[f64; 2]> = None;
        let (mut tangent, mut cohesion) = (0.0_f64, 0.0);
        for &(s, [v_n, v_t]) in &rates {
            let contact = &self.model.contacts[s];
            let side = if self.has(contact.node) { -1.0 } else { 1.0 };
            let inward = self.over(state, s)?.normal.map(|x| side * x);
            let first = *inwards.get_or_insert(inward);
            if v_n.abs() > NONE * v_t.abs() || dot(first, inward) < 1.0 - NONE {
                return None;
            }
            let friction = state.nodes[s].friction(&state.controls.friction[s]);
            tangent = tangent.max(friction.coefficient());
            cohesion += friction.cohesion;
        }
        if !is_held_by_contacts_only(self.model, self.body) {
            return None;
        }
        let pressed = BodyMotion {
            motion: LooseMotion::Translation(inwards?),
            sign: 1.0,
            nodes: self.nodes.clone(),
            ..*self
        };
        let (push, pressed) = (self.power(state), pressed.power(state).max(0.0));
        let most = tangent * pressed + cohesion;
        if pressed == 0.0 || most >= push * (1.0 - NONE) {
            return None;
        }
        let enough = ((push - cohesion) / pressed).atan().to_degrees();
        Some(format!(
            "friction is too small to hold body {}: the loads push it along the surface with {}, and its contacts resist with at most {} (tan φ F_n + cohesion); it takes a friction angle of at least {} degrees",
            self.name(),
            sig4(push),
            sig4(most),
            sig4(enough)
        ))
    }

    /// The contact or support that would stop the motion.
    fn stopped(&self, state: &State) -> String {
        let motion = match self.motion {
            LooseMotion::Translation(along) => {
                let along = along.map(|x| self.sign * x);
                format!("the motion along {}", pair(along, 1.0))
            }
            LooseMotion::Rotation(about) => {
                format!("the rotation about {}", pair(about, reach(self.model)))
            }
        };
        let mut closing: Vec<(f64, usize)> = Vec::new();
        let mut sliding = Vec::new();
        for (s, [rate, along]) in self.rates(state) {
            let (node, size) = (&state.nodes[s], rate.hypot(along));
            if node.mode == Mode::Free && rate < -NONE * size {
                let gap = self.gap(state, s).max(0.0);
                closing.push((gap / -rate * size, s));
            }
            if node.mode == Mode::Sliding && size > 0.0 {
                sliding.push(s);
            }
        }
        closing.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let Some(&(way, s)) = closing.first() {
            return format!(
                "{motion} by {} closes contact at {}, which would stop it; a prescribed displacement can move the body there in equilibrium, a load cannot",
                sig4(way),
                slave(self.model, s)
            );
        }
        let support = match self.motion {
            LooseMotion::Translation([x, y]) => {
                let axis = if x.abs() >= y.abs() { "x" } else { "y" };
                format!("a support of one of the body's nodes in {axis}")
            }
            LooseMotion::Rotation(_) => {
                "a support of one of the body's nodes away from that point".into()
            }
        };
        if sliding.is_empty() {
            return format!("{motion} closes no contact; {support} would stop it");
        }
        let nodes = sliding.iter().map(|&s| slave(self.model, s));
        format!(
            "{motion} closes no contact; sticking of {} would stop it up to the friction limit (start: fixed), and so would {support}",
            first_of(nodes, MOST_NODES, ", ")
        )
    }

    /// Arrows at nodes distributed over the body.
    fn arrows(&self) -> Vec<[[f64; 2]; 2]> {
        let nodes: Vec<usize> = match self.model.bodies[self.body].kind.lines() {
            [] => self.model.bodies[self.body].nodes.clone(),
            lines => lines.iter().flatten().copied().collect(),
        };
        let every = nodes.len().div_ceil(ARROWS).max(1);
        let chosen = nodes.iter().step_by(every);
        let all: Vec<([f64; 2], [f64; 2])> = chosen
            .map(|&node| (self.places[node], self.velocity(self.places[node])))
            .collect();
        let largest = all
            .iter()
            .map(|(_, v)| v[0].hypot(v[1]))
            .fold(0.0, f64::max);
        all.into_iter()
            .filter(|_| largest > 0.0)
            .map(|(at, v)| [at, v.map(|x| x / largest)])
            .collect()
    }
}

/// Whether no support acts on a body, and no other body has nodes of it.
pub(super) fn is_held_by_contacts_only(model: &Model, body: usize) -> bool {
    let nodes: HashSet<usize> = model.bodies[body].nodes.iter().copied().collect();
    let is_free = |&node: &usize| {
        let own = model.dofs.of_node(node);
        model.dofs.equation[own].iter().all(Option::is_some)
    };
    let others = model.bodies.iter().enumerate().filter(|(k, _)| *k != body);
    nodes.iter().all(is_free)
        && !others
            .flat_map(|(_, other)| &other.nodes)
            .any(|node| nodes.contains(node))
}

/// Since when the body is loose.
fn since(model: &Model, state: &State, at_start: &Singular) -> String {
    let load = shortest(state.start.load_factor);
    if matches!(at_start, Singular::Rigid { .. }) {
        return match state.next.increment {
            0 | 1 => {
                "nothing has held the body since the start, with the initial modes of its nodes"
                    .into()
            }
            _ => format!(
                "nothing has held the body since the last equilibrium, load {load}, or longer"
            ),
        };
    }
    let let_go: Vec<&str> = (0..model.contacts.len())
        .filter(|&s| (state.nodes[s].mode as u8) < state.start.nodes[s].mode as u8)
        .map(|s| slave(model, s))
        .collect();
    if let_go.is_empty() {
        format!("the body was held at load {load}")
    } else {
        format!(
            "the body was held at load {load}; on the way to {}, {} lost contact or stick",
            shortest(state.load_factor),
            first_of(let_go, MOST_NODES, ", ")
        )
    }
}
