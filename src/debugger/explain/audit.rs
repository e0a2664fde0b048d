//! Audits a whole history: the judge's worst findings, and checks that no single increment shows.
//!
//! Every accepted increment includes the judge's findings. An audit keeps the worst finding for each law
//! (separately for increments that were accepted with a mark), and adds what the contact of slave nodes with
//! master surfaces cannot show: nodes of a master inside a slave's body, and increments in which friction
//! produced work.

use stickslip_core::contact::closest_points::place;
use stickslip_core::fem::deformation::deformation;
use stickslip_core::groups::distinct;
use stickslip_core::plane::depth_inside;
use stickslip_core::step::judged::{self, ReferenceSizes};
use stickslip_core::{
    Event, Finding, JudgedLaw, Model, Outcome, PointDeformation, Solid, Solver, Stepper,
    SurfaceElement, Verdict,
};

/// Number of points per edge of an outline, for the search for nodes inside it.
const POINTS: usize = 8;

/// A finding, by default the worst violation of a contact law, and its increment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstFinding<T = Finding> {
    /// Increment number, from 1.
    pub increment: u32,
    /// Load factor λ at the end of the increment.
    pub load_factor: f64,
    /// What was found in it.
    pub finding: T,
}

impl<T> WorstFinding<T> {
    fn new(event: &Event, finding: T) -> WorstFinding<T> {
        WorstFinding {
            increment: event.position.increment,
            load_factor: event.load_factor,
            finding,
        }
    }
}

/// A master node inside a slave's body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PenetratingMaster {
    /// Number of the node in the scene.
    pub node: usize,
    /// Number of the body in the model, from 0.
    pub body: usize,
    /// Distance from the outline (length).
    pub depth: f64,
}

/// The audit of a history.
#[derive(Debug, Clone, Default)]
pub struct Audit {
    /// Number of accepted increments.
    pub increments: u32,
    /// Number of increments accepted with a mark.
    pub marked: u32,
    /// The worst finding for each law over all unmarked increments, in the order of [`JudgedLaw::ALL`] and then
    /// [`JudgedLaw::OF_BONDS`].
    pub worst: [Option<WorstFinding>; 11],
    /// The same for marked increments.
    pub worst_marked: [Option<WorstFinding>; 11],
    /// The increment in which friction produced the most work.
    pub work: Option<WorstFinding>,
    /// The master node deepest inside a slave's body.
    pub inside: Option<WorstFinding<PenetratingMaster>>,
    /// The smallest principal stretch of the solids.
    pub stretch: Option<WorstFinding<PointDeformation>>,
    /// The first point outside the range of its material law.
    pub outside: Option<WorstFinding<PointDeformation>>,
}

impl Audit {
    /// Adds the last minor iteration, if it ended in an accepted increment.
    pub fn take(&mut self, stepper: &Stepper) {
        let (event, state) = (stepper.event(), stepper.state());
        let (Outcome::Increment { marked, .. }, Some(verdict)) =
            (&event.outcome, &state.start.verdict)
        else {
            return;
        };
        self.add(event, verdict, marked.is_some());
        let work = verdict.work.map(|work| WorstFinding::new(event, work));
        keep_worse(&mut self.work, work);
        if let Some(found) = deformation(stepper.model(), &state.start.u) {
            let stretched = |point: PointDeformation| WorstFinding::new(event, point);
            let least = self
                .stretch
                .map_or(f64::INFINITY, |known| known.finding.stretch);
            if found.smallest.stretch < least {
                self.stretch = Some(stretched(found.smallest));
            }
            self.outside = self.outside.or(found.outside.map(stretched));
        }
        let most = self.inside.map_or(0.0, |inside| inside.finding.depth);
        let deepest = deepest(stepper.model(), &state.start.u);
        if let Some(deepest) = deepest.filter(|deepest| deepest.depth > most) {
            self.inside = Some(WorstFinding::new(event, deepest));
        }
    }

    /// Adds the last iteration of an attached solver, if it ended in an accepted increment; what the solver does not report is not
    /// checked.
    pub fn take_reported(&mut self, solver: &dyn Solver) {
        let (event, state) = (solver.event(), solver.state());
        if event.outcome.is_accepted() {
            let sizes = ReferenceSizes::from_state(state, event);
            let verdict = judged::verdict(solver.model(), &event.nodes, &sizes);
            self.add(event, &verdict, false);
        }
    }

    /// Adds the verdict on an accepted increment.
    fn add(&mut self, event: &Event, verdict: &Verdict, is_marked: bool) {
        self.increments += 1;
        self.marked += u32::from(is_marked);
        let worst = if is_marked {
            &mut self.worst_marked
        } else {
            &mut self.worst
        };
        let all = verdict.worst.iter().chain(&verdict.bonds);
        for (worst, finding) in worst.iter_mut().zip(all) {
            let found = finding.map(|finding| WorstFinding::new(event, finding));
            keep_worse(worst, found);
        }
    }

    /// The laws violated by unmarked increments.
    pub fn broken(&self) -> impl Iterator<Item = &WorstFinding> {
        self.worst
            .iter()
            .flatten()
            .filter(|found| found.finding.is_broken())
    }

    /// The worst finding for a law in unmarked increments.
    pub fn of(&self, law: JudgedLaw) -> Option<&WorstFinding> {
        self.worst
            .iter()
            .flatten()
            .find(|found| found.finding.law == law)
    }
}

fn keep_worse(worst: &mut Option<WorstFinding>, found: Option<WorstFinding>) {
    let Some(found) = found else { return };
    let times = found.finding.times();
    if worst
        .as_ref()
        .is_none_or(|worst| times > worst.finding.times() || times.is_nan())
    {
        *worst = Some(found);
    }
}

/// The node of a master surface deepest inside a solid with slave nodes.
fn deepest(model: &Model, u: &[f64]) -> Option<PenetratingMaster> {
    let now = model.places(u);
    let mut deepest: Option<PenetratingMaster> = None;
    for (number, body) in model.bodies.iter().enumerate() {
        let Some(solid) = body.solid() else {
            continue;
        };
        let slaves: Vec<_> = model
            .contacts
            .iter()
            .filter(|s| body.nodes.contains(&s.node))
            .collect();
        let masters = slaves
            .iter()
            .flat_map(|slave| &slave.surfaces)
            .flat_map(|&surface| model.surfaces[surface].nodes().copied())
            .filter(|node| !body.nodes.contains(node));
        let masters = distinct(masters);
        if masters.is_empty() {
            continue;
        }
        let outline = outline(solid, &now);
        for node in masters {
            let depth = depth_inside(&outline, now[node]);
            if depth > deepest.map_or(0.0, |deepest| deepest.depth) {
                deepest = Some(PenetratingMaster {
                    node,
                    body: number,
                    depth,
                });
            }
        }
    }
    deepest
}

/// The outline of a solid as a chain of short segments, with the body on their left.
fn outline(solid: &Solid, now: &[[f64; 2]]) -> Vec<[[f64; 2]; 2]> {
    let at = |k: usize| -1.0 + 2.0 * k as f64 / POINTS as f64;
    solid
        .edges
        .iter()
        .flat_map(|nodes| {
            let edge = SurfaceElement::lagrange(nodes);
            (0..POINTS).map(move |k| [at(k), at(k + 1)].map(|xi| place(edge, now, xi)))
        })
        .collect()
}
