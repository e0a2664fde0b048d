//! Pushes in an attached solver, computed from the numbers that it reported for two iterations and the
//! interface problem between them.
//!
//! With total forces f, (gap, u) = W f + q is linear, and each contact's mode determines which two numbers its
//! equations fix. The differences of these numbers between the two iterations are the contact's change
//! ([`influence`](super::influence)). The position where a fixed contact sticks and the friction bound of a
//! sliding one are implied by the reported numbers.
//!
//! The pushes are available only if W f + q matches the gaps of both iterations, and only modes and friction
//! bounds have changed between them.

use super::cone_problem;
use super::influence::{NodePush, left_side, spread};
use super::interface_scene;
use nalgebra::DVector;
use std::sync::Arc;
use stickslip_core::{
    BoundUpdate, Capabilities, ContactRecord, Equation, Event, Mode, Model, NodeIncrement,
    RelativeMotion, ReportedProblem, RewindSupport, State, Trials,
};

/// Maximum number of contacts for which the problem is requested in every iteration, because it is sent as text
/// through a pipe.
const MOST: usize = 100;
/// Relative tolerance for values that should agree.
const SAME: f64 = 1e-6;

/// Two consecutive minor iterations in the same frozen problem.
pub struct Iterations {
    /// The state before the later one.
    pub start: Box<State>,
    /// The events of both.
    pub found: [Arc<Event>; 2],
}

/// Whether a solver is asked for its problem in every iteration: it reports the problem, can return to any
/// state, and has few enough contacts.
pub fn are_available(model: &Model, offers: &Capabilities) -> bool {
    let few = model.contacts.len() <= MOST;
    offers.problem && offers.goes_back == RewindSupport::ToAny && few
}

/// The pushes on a contact between the iterations; `posed` is the problem at the start of the later one. `None`
/// if the problem does not match the solver's numbers.
pub fn pushes(
    model: &Model,
    iterations: &Iterations,
    posed: &ReportedProblem,
    slave: usize,
) -> Option<Vec<NodePush>> {
    if posed.tangents == 2 {
        return cone_problem::pushes(&iterations.found, posed, slave);
    }
    let Some(target) = posed.contacts.iter().position(|&known| known == slave) else {
        // Contacts outside the problem are not affected by those in it.
        return Some(Vec::new());
    };
    let [before, after] = &iterations.found;
    let earlier = ReportedPushes::new(posed, &before.nodes)?;
    let later = ReportedPushes::new(posed, &after.nodes)?;
    let (_, mut stepper) =
        interface_scene::stepper(interface_scene::problem(model, &iterations.start, posed)).ok()?;
    let mut problem = stepper.interface_problem()?;
    if earlier.follows_law(posed) && later.follows_law(posed) {
        problem.settings.t_max = BoundUpdate::Consistent;
    }
    problem.length = earlier.motion.amax().max(later.motion.amax());
    problem.force = earlier.forces.amax().max(later.forces.amax());
    let mut states = problem.states();
    for (place, state) in states.iter_mut().enumerate() {
        state.mode = later.modes[place];
        state.sign = 1_f64.copysign(later.forces[2 * place + 1]);
    }
    let modes = |place: usize| [earlier.modes[place], later.modes[place]];
    let mut is_explained = true;
    let change = |place: usize, row: &Equation| {
        let change =
            left_side(row, &later.increment(place)) - left_side(row, &earlier.increment(place));
        let scale = match row.motion {
            RelativeMotion::None => problem.force,
            RelativeMotion::Normal | RelativeMotion::Tangential => problem.length,
        };
        let [then, now] = modes(place);
        if then != now {
            return change;
        }
        if change.abs() <= SAME * scale {
            return 0.0;
        }
        // With the same mode, only the bound can have changed.
        is_explained &= then == Mode::Sliding && row.motion == RelativeMotion::None;
        change
    };
    let mut trials = Trials::new(&problem)?;
    trials.solve_states(&states)?;
    let found = spread(&mut trials, &states, &[target], change)?;
    is_explained.then(|| {
        found
            .into_iter()
            .flatten()
            .map(|influence| NodePush {
                slave: posed.contacts[influence.from],
                modes: modes(influence.from),
                influence,
            })
            .collect()
    })
}

/// The reported numbers of an iteration for the problem's contacts.
struct ReportedPushes {
    modes: Vec<Mode>,
    /// f_n and f_t of each.
    forces: DVector<f64>,
    /// gap and u of each, computed from the problem.
    motion: DVector<f64>,
}

impl ReportedPushes {
    /// `None` if forces were not reported, or the problem gives other gaps.
    fn new(posed: &ReportedProblem, nodes: &[ContactRecord]) -> Option<ReportedPushes> {
        let records: Vec<&ContactRecord> = posed
            .contacts
            .iter()
            .map(|&slave| nodes.get(slave))
            .collect::<Option<_>>()?;
        let forces = records.iter().flat_map(|record| [record.f_n, record.f_t]);
        let forces = DVector::from_iterator(2 * records.len(), forces);
        let motion = posed.motion(&forces)?;
        let q = DVector::from_column_slice(&posed.q);
        let scale = (&motion - &q).amax().max(q.amax());
        let sound = forces.iter().all(|force| force.is_finite());
        (sound
            && !records
                .iter()
                .enumerate()
                .any(|(place, record)| (record.gap - motion[2 * place]).abs() > SAME * scale))
        .then(|| ReportedPushes {
            modes: records
                .iter()
                .map(|record| record.decision.before)
                .collect(),
            forces,
            motion,
        })
    }

    /// Forces and motions of a contact, in the convention of its equations.
    fn increment(&self, place: usize) -> NodeIncrement {
        let of = |numbers: &DVector<f64>| [numbers[2 * place], numbers[2 * place + 1]];
        NodeIncrement {
            force: of(&self.forces),
            // Motion of the surface relative to the node.
            motion: of(&self.motion).map(|x| -x),
        }
    }

    /// Whether all sliding contacts satisfy f_t = ± (μ f_n + c) with the current normal force.
    fn follows_law(&self, posed: &ReportedProblem) -> bool {
        let most = SAME * self.forces.amax();
        (0..self.modes.len()).all(|place| {
            let (friction, force) = (posed.friction[place], self.increment(place).force);
            let bound = friction.limit(force[0]);
            self.modes[place] != Mode::Sliding || (force[1].abs() - bound).abs() <= most
        })
    }
}
