//! A scene run to its end, or to its failure, with every accepted increment judged from outside.

use super::chain::{Point, norm};
use super::judge::{Breach, Pull, Scales, Seen, judge};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use stickslip::model::Model;
use stickslip::model::{AtLimit, Component, SlipCount, Sticking, TieRule};
use stickslip::model::{BodyKind, Form, Monitor, MonitorQuantity};
use stickslip::scene::Scene;
use stickslip::step::event::{Failure, MotionEvent, Outcome};
use stickslip::step::recovery::fallback::Fallback;
use stickslip::step::state::IncrementStart;
use stickslip::step::stepper::Stepper;

/// Minor iterations after which a run is given up, so that one that goes on forever ends the same way everywhere.
const PATIENCE: usize = 100_000;
/// Forces that are this part of what the stiffest section bears before it is strained by 1 are as exact as can be had.
const ROUNDING: f64 = 1e-7;
/// Passages from one element to another within an attempt that make hopping.
const HOPS: usize = 4;

/// What became of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum End {
    Finished,
    Failed {
        /// The name of the failure.
        kind: String,
        /// Its major iterations do not end, and a node hops between elements.
        at_vertex: bool,
    },
    /// It was given up.
    Endless,
    Panicked,
    /// The program refuses to read it: the draw made a scene that makes no sense.
    Refused,
}

/// A law that was broken, and in which accepted increment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrong {
    /// From 1.
    pub increment: usize,
    pub load_factor: f64,
    pub breach: Breach,
}

/// What came out of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    pub end: End,
    /// Accepted increments.
    pub increments: usize,
    /// In order; an increment may break several laws.
    pub wrong: Vec<Wrong>,
    /// Accepted states of a node that a vertex is needed for.
    pub vertices: usize,
    /// Accepted states of a node that touched, and whose friction no touch point on its way explains.
    pub unexplained: usize,
    /// The ways round on which increments were accepted whose halves had failed.
    pub fallbacks: Vec<Fallback>,
}

impl Trial {
    /// Nothing was accepted yet, and this would be the end.
    pub fn before(end: End) -> Self {
        Trial {
            end,
            increments: 0,
            wrong: Vec::new(),
            vertices: 0,
            unexplained: 0,
            fallbacks: Vec::new(),
        }
    }

    /// Accepted increments that are wrong.
    pub fn wrong_increments(&self) -> usize {
        let mut numbers: Vec<usize> = self.wrong.iter().map(|w| w.increment).collect();
        numbers.dedup();
        numbers.len()
    }
}

/// Whether a scene's settings ask for states that need not be Coulomb's: such runs may accept them.
pub fn forgives(scene: &Scene) -> bool {
    let s = &scene.spec.settings;
    s.sticking == Sticking::Increments
        || s.slip == SlipCount::Major
        || s.ties == TieRule::Printed
        || s.at_minor_limit == AtLimit::Accept
        || s.at_major_limit == AtLimit::Accept
}

/// Runs a scene and judges it.
pub fn attempt(scene: &Scene) -> Trial {
    let mut trial = Trial::before(End::Panicked);
    // The trial is whole at every increment, whatever the solver does.
    let _ = catch_unwind(AssertUnwindSafe(|| trial.run(scene)));
    trial
}

impl Trial {
    fn run(&mut self, scene: &Scene) {
        let model = Arc::new(with_reactions(scene));
        let mut stepper = Stepper::new(model.clone());
        // The last accepted state, and the end of the last step of a damped motion from there.
        let mut accepted = seen(&model, &stepper.state().start, &[]);
        let mut before = accepted.clone();
        let mut in_motion = Vec::new();
        let mut scales = Scales {
            length: model.length,
            force: ROUNDING * stiffness(&model),
        };
        let mut passages = Passages::default();
        let mut fallback = None;
        for _ in 0..PATIENCE {
            let motion = stepper.state().recovery.motion;
            if stepper.step().is_none() {
                self.end = End::Finished;
                return;
            }
            let drag = match &stepper.event().outcome {
                Outcome::Increment { jumped, .. } => {
                    self.fallbacks.extend(fallback.take());
                    if !jumped {
                        before.clone_from(&accepted);
                    }
                    None
                }
                Outcome::Motion(MotionEvent::Step { .. }) => motion.map(|motion| motion.drag),
                Outcome::Fallback { by, .. } => {
                    (fallback, passages) = (Some(*by), Passages::default());
                    before.clone_from(&accepted);
                    in_motion.clear();
                    continue;
                }
                Outcome::Failed(failure) => {
                    self.end = failed(failure, &passages);
                    return;
                }
                Outcome::Major { .. } => {
                    passages.count(&stepper);
                    continue;
                }
                Outcome::Cut { .. } => {
                    passages = Passages::default();
                    continue;
                }
                _ => continue,
            };
            passages = Passages::default();
            let mut reactions = Vec::new();
            stepper.monitors(&mut reactions);
            let state = stepper.state();
            let mut now = seen(&model, &state.start, &reactions);
            if let Some(drag) = drag {
                now.brake(&model, &before, drag);
            }
            let pulls = now.pulls.iter().map(|pull| norm(pull.force));
            let forces = now.forces.iter().map(|f| norm(*f));
            // A node that floats balances its load to round-off.
            let load = state.start.load_factor;
            let loads = model
                .loads
                .iter()
                .map(|l| (l.value * l.scale.at(load)).abs());
            scales.force = pulls
                .chain(forces)
                .chain(loads)
                .fold(scales.force, f64::max);
            let brought: Vec<f64> = match self.increments {
                0 => model.contacts.iter().map(|s| -s.state.slip).collect(),
                _ => vec![0.0; model.contacts.len()],
            };
            let friction = &state.controls.friction;
            let verdict = judge(&model, [&before, &now], friction, &brought, scales);
            let wrong = |breach| Wrong {
                increment: self.increments + 1,
                load_factor: state.start.load_factor,
                breach,
            };
            in_motion.extend(verdict.breaches.into_iter().map(wrong));
            if drag.is_none() {
                self.increments += 1;
                self.vertices += verdict.vertices;
                self.unexplained += verdict.unexplained;
                self.wrong.append(&mut in_motion);
                accepted.clone_from(&now);
            }
            before = now;
        }
        self.end = End::Endless;
    }
}

/// The scene with nothing monitored but the reaction at every degree of freedom of a node that is held or moved.
fn with_reactions(scene: &Scene) -> Model {
    let mut model = scene.model.clone();
    let held = |dof: &usize| model.dofs.equation[*dof].is_none();
    let all = 0..model.dofs.len() - model.dofs.inner;
    model.monitors = all
        .filter(held)
        .map(|dof| Monitor {
            name: format!("r{dof}"),
            of: MonitorQuantity::Reaction { dof },
        })
        .collect();
    model
}

/// The largest axial stiffness of a beam, or that of a solid across the scene (force).
fn stiffness(model: &Model) -> f64 {
    let of = |kind: &BodyKind| match kind {
        BodyKind::Beam(beam) => beam.ea,
        BodyKind::Solid(solid) => {
            let each = solid.materials.iter().map(|m| m.young * m.thickness);
            each.fold(0.0, f64::max) * model.length
        }
        BodyKind::Linear(_) | BodyKind::Truss(_) => 0.0,
    };
    let all = model.bodies.iter().map(|body| of(&body.kind));
    all.fold(f64::MIN_POSITIVE, f64::max)
}

/// An accepted state, as it looks from outside.
fn seen(model: &Model, state: &IncrementStart, reactions: &[f64]) -> Seen {
    let positions = positions(model, &state.u);
    let mut of_dof = vec![0.0; model.dofs.len()];
    for (monitor, value) in model.monitors.iter().zip(reactions) {
        if let MonitorQuantity::Reaction { dof } = monitor.of {
            of_dof[dof] += value;
        }
    }
    for load in &model.loads {
        of_dof[load.dof] += load.value * load.scale.at(state.load_factor);
    }
    for body in &model.bodies {
        if let BodyKind::Linear(linear) = &body.kind
            && linear.form == Form::Stiffness
        {
            let dof = |k: usize| model.dofs.first[body.nodes[k / 2]] + k % 2;
            for &(row, column, value) in &linear.entries {
                of_dof[dof(row)] -= value * state.u[dof(column)];
            }
        }
    }
    let pull = |n: usize| {
        let of = |c| model.dofs.dof(n, c).map_or(0.0, |d| of_dof[d]);
        Pull {
            at: positions[n],
            force: [of(Component::X), of(Component::Y)],
            moment: of(Component::Rotation),
        }
    };
    Seen {
        pulls: (0..model.nodes.len()).map(pull).collect(),
        forces: state.nodes.iter().map(|node| node.force()).collect(),
        positions,
    }
}

impl Seen {
    /// Adds the forces of a viscosity over the time step, `drag`, on the nodes that have moved since `before`.
    fn brake(&mut self, model: &Model, before: &Seen, drag: f64) {
        let moved = self.positions.iter().zip(&before.positions);
        for ((pull, (now, before)), first) in
            self.pulls.iter_mut().zip(moved).zip(&model.dofs.first)
        {
            for axis in 0..2 {
                if model.dofs.equation[first + axis].is_some() {
                    pull.force[axis] -= drag * (now[axis] - before[axis]);
                }
            }
        }
    }
}

fn positions(model: &Model, u: &[f64]) -> Vec<Point> {
    let place =
        |(node, &d): (&stickslip::model::Node, &usize)| [node.at[0] + u[d], node.at[1] + u[d + 1]];
    model
        .nodes
        .iter()
        .zip(&model.dofs.first)
        .map(place)
        .collect()
}

fn failed(failure: &Failure, passages: &Passages) -> End {
    let kind = kind(failure);
    // Only what no number of major iterations ends may be due to a vertex.
    let hop = kind.contains("Major") && passages.hop();
    End::Failed {
        at_vertex: hop || at_vertex(failure),
        kind,
    }
}

/// The name of a failure, and of what it is made of.
fn kind(failure: &Failure) -> String {
    match failure {
        Failure::LadderEnded { first, last, .. } => {
            format!("LadderEnded({}, {})", kind(first), kind(last))
        }
        Failure::Singular(of) => format!("Singular({})", head(&format!("{of:?}"))),
        Failure::NotFound(of) => format!("NotFound({})", head(&format!("{of:?}"))),
        other => head(&format!("{other:?}")).to_owned(),
    }
}

fn head(text: &str) -> &str {
    let end = text.find(|c: char| !c.is_alphanumeric());
    &text[..end.unwrap_or(text.len())]
}

/// Whether the major iterations cycle because a node hops from element to element, or the failure says itself that it is at a
/// vertex.
fn at_vertex(failure: &Failure) -> bool {
    match failure {
        Failure::MajorCycle(round) => round.members.iter().any(|(_, stops)| {
            let mut elements: Vec<_> = stops.iter().filter_map(|s| s.element).collect();
            elements.dedup();
            elements.len() > 1
        }),
        Failure::LadderEnded { first, last, .. } => at_vertex(first) || at_vertex(last),
        other => kind(other).contains("Vertex"),
    }
}

/// How often each slave node passes from element to element in the major iterations of an attempt at an increment. It tells
/// kinds of failures apart and judges nothing.
#[derive(Default)]
struct Passages(Vec<(Option<(usize, usize)>, usize)>);

impl Passages {
    fn count(&mut self, stepper: &Stepper) {
        let nodes = &stepper.state().nodes;
        self.0.resize(nodes.len(), (None, 0));
        for (node, (last, count)) in nodes.iter().zip(&mut self.0) {
            let here = node.spot.map(|spot| (spot.surface, spot.element));
            *count += usize::from(last.is_some() && here != *last);
            *last = here;
        }
    }

    fn hop(&self) -> bool {
        self.0.iter().any(|(_, count)| *count >= HOPS)
    }
}
