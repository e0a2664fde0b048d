//! Pushes: how the changes at other nodes moved one node's gap and forces, from one minor iteration to the
//! next.
//!
//! On the frozen interface problem both iterations are linear systems that differ only in the equations of the
//! nodes that changed. Let M be the matrix of the later one, and δ_j the residual of the earlier solution in
//! its row j. Then the solutions differ by exactly `Σ_j M⁻¹ e_j δ_j`: each term is the effect of node j's
//! change.

use stickslip_core::interface::rows;
use stickslip_core::{
    ContactState, Equation, InterfaceProblem, Intervention, Mode, NodeIncrement, RelativeMotion,
    State, Stepper, Trials,
};

/// Effect of one node's change on another node.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Influence {
    /// Index of the node that changed.
    pub from: usize,
    /// Resulting change of the other node's gap, length.
    pub gap: f64,
    /// Change of its slip, length.
    pub slip: f64,
    /// Change of its normal force; compression is positive.
    pub f_n: f64,
    /// Change of its tangential force.
    pub f_t: f64,
}

/// The effects of all nodes' changes on each of the nodes `targets`, between the iteration with the solution `old` and the one that
/// starts from `after`; nodes without a change are left out. `None` if the later iteration has no solution.
pub fn influences(
    problem: &InterfaceProblem,
    old: &[NodeIncrement],
    after: &[ContactState],
    targets: &[usize],
) -> Option<Vec<Vec<Influence>>> {
    let mut trials = Trials::new(problem)?;
    trials.solve_states(after)?;
    spread(&mut trials, after, targets, |from, row| {
        row.value - left_side(row, &old[from])
    })
}

/// As [`influences`]; `missed` returns the residual of the earlier solution in a node's equation. `trials` has
/// solved for `after`.
pub(super) fn spread(
    trials: &mut Trials<'_>,
    after: &[ContactState],
    targets: &[usize],
    mut missed: impl FnMut(usize, &Equation) -> f64,
) -> Option<Vec<Vec<Influence>>> {
    let problem = trials.problem();
    let answers = targets.iter().map(|target| trials.answers_of(*target));
    let answers: Vec<[Vec<f64>; 4]> = answers.collect::<Option<_>>()?;
    let mut found = vec![Vec::new(); targets.len()];
    for (from, node) in problem.nodes.iter().enumerate() {
        let rows = rows::rows(
            &after[from],
            node.kinematics.as_ref(),
            &node.friction,
            &problem.settings,
            0.0,
        );
        let missed: Vec<f64> = rows.iter().map(|row| missed(from, row)).collect();
        for (all, answers) in found.iter_mut().zip(&answers) {
            let [f_n, f_t, gap, slip] = answers.each_ref().map(|of| {
                let of = &of[2 * from..];
                of.iter()
                    .zip(&missed)
                    .map(|(answer, missed)| answer * missed)
                    .sum::<f64>()
            });
            all.push(Influence {
                from,
                gap: -gap,
                slip,
                f_n,
                f_t,
            });
        }
    }
    let tiny = f64::EPSILON * 64.0;
    for all in &mut found {
        all.retain(|i| {
            i.gap.abs().max(i.slip.abs()) > tiny * problem.length
                || i.f_n.abs().max(i.f_t.abs()) > tiny * problem.force
        });
    }
    Some(found)
}

/// The left side of an equation, at a node with these values.
pub(super) fn left_side(row: &Equation, given: &NodeIncrement) -> f64 {
    let motion = match row.motion {
        RelativeMotion::None => 0.0,
        RelativeMotion::Normal => given.motion[0],
        RelativeMotion::Tangential => given.motion[1],
    };
    motion + row.d_n * given.force[0] + row.d_t * given.force[1]
}

/// Effect of one node's change on the selected node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodePush {
    /// Slave number of the node that changed.
    pub slave: usize,
    /// Its modes in the previous iteration and in this one.
    pub modes: [Mode; 2],
    /// The effect.
    pub influence: Influence,
}

/// How to reach the shown iteration: from a state, by recorded steps.
pub struct PushPath {
    /// The state after the steps.
    pub state: Box<State>,
    /// Minor iterations (`None`) and interventions, up to the state that the shown iteration started from.
    pub steps: Vec<Option<Intervention>>,
    /// Index of the minor iteration before the shown one.
    pub before: usize,
}

/// The frozen problem between two minor iterations, and the first of them: the modes of all slave nodes, and the solution.
pub struct FrozenStep {
    problem: InterfaceProblem,
    modes: Vec<Mode>,
    old: Vec<NodeIncrement>,
}

/// The pushes on a node in the iteration after the steps; `None` if unknown.
pub fn pushes(stepper: &mut Stepper, slave: usize, way: &PushPath) -> Option<Vec<NodePush>> {
    pushed(&between(stepper, way)?, slave)
}

/// Repeats the steps and the iteration after them.
pub fn between(stepper: &mut Stepper, way: &PushPath) -> Option<FrozenStep> {
    stepper.restore(&way.state);
    let (mut modes, mut old) = (Vec::new(), Vec::new());
    for (place, step) in way.steps.iter().enumerate() {
        let nodes = stepper.state().nodes.iter();
        let now: Vec<Mode> = nodes.map(|node| node.mode).collect();
        match step {
            Some(intervention) => stepper.intervene(intervention).ok()?,
            None => {
                stepper.step()?;
            }
        }
        if place == way.before {
            old = (0..now.len()).map(|s| stepper.increment(s)).collect();
            modes = now;
        }
    }
    let problem = stepper.interface_problem()?;
    let solutions = problem
        .nodes
        .iter()
        .map(|node| old.get(node.slave).copied());
    Some(FrozenStep {
        old: solutions.collect::<Option<_>>()?,
        modes,
        problem,
    })
}

/// The pushes on a node between two minor iterations.
pub fn pushed(step: &FrozenStep, slave: usize) -> Option<Vec<NodePush>> {
    let problem = &step.problem;
    let after = problem.states();
    let target = problem.nodes.iter().position(|node| node.slave == slave)?;
    let of = |node: usize| problem.nodes[node].slave;
    let found = influences(problem, &step.old, &after, &[target])?;
    Some(
        found
            .into_iter()
            .flatten()
            .map(|influence| NodePush {
                slave: of(influence.from),
                modes: [step.modes[of(influence.from)], after[influence.from].mode],
                influence,
            })
            .collect(),
    )
}
