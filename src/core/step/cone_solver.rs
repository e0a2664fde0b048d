//! Solves an interface problem in space, one sweep of block Gauss-Seidel per minor iteration ([`Sweep`]).
//!
//! The forces are total forces of the only increment. It is accepted once the natural map, relative to the forces, is at most
//! [`SETTLED`] and no mode changes.

use crate::interface::blocks::Blocks;
use crate::model::SpaceProblem;
use crate::step::judged::{self, ReferenceSizes};
use crate::strategy::gauss_seidel::SETTLED;
use crate::{
    Capabilities, ContactRecord, Event, Failure, Friction, Mode, Model, Norms, Now, Outcome,
    ReportedForm, ReportedProblem, RewindSupport, Rule, Solver, SolverLost, State, StoredStates,
    Sweep, Test, TestedQuantity,
};
use std::sync::Arc;

/// Maximum number of sweeps.
const MOST: u32 = 20_000;
/// Maximum number of contacts of a reported problem, whose matrix is dense.
const MOST_DENSE: usize = 500;

/// The solver of a model whose [`Space`](crate::model::Space) has an interface problem.
pub struct ConeSolver {
    model: Arc<Model>,
    problem: Arc<SpaceProblem>,
    sweep: Sweep<3>,
    state: State,
    event: Event,
    /// The forces of each state.
    forces: StoredStates<Vec<f64>>,
    /// The state that the sweeps are at, without interventions since.
    at: Option<u64>,
    /// Natural map of the current forces.
    error: f64,
}

impl ConeSolver {
    /// The solver at the start, without forces; `None` for a model without an interface problem in space.
    pub fn new(model: Arc<Model>) -> Option<ConeSolver> {
        let problem = model.space.as_ref()?.problem.clone()?;
        let entries = problem.entries.iter().copied();
        let blocks = Blocks::from_entries(model.contacts.len(), entries);
        let state = State::outside_start(&model);
        let friction = &state.controls.friction;
        let sweep = Sweep::in_space(Arc::new(blocks), problem.free.clone(), friction);
        Some(ConeSolver {
            forces: StoredStates::new(vec![0.0; problem.free.len()]),
            event: Event::nothing_yet(&model),
            at: Some(0),
            error: 1.0,
            model,
            problem,
            sweep,
            state,
        })
    }

    /// Natural map at which the forces are accepted: after the last sweep, the accuracy of W.
    fn bound(&self) -> f64 {
        match self.state.next.minor >= MOST {
            true => SETTLED.max(self.state.controls.settings.matrix_accuracy),
            false => SETTLED,
        }
    }

    /// Record of a contact after a sweep.
    fn record(&self, slave: usize, error: f64) -> ContactRecord {
        let bound = self.bound();
        let node = &self.state.nodes[slave];
        let place = 3 * slave;
        let [f_n, f_1, f_2] = [0, 1, 2].map(|k| self.sweep.forces()[place + k]);
        let [gap, u_1, u_2] = [0, 1, 2].map(|k| self.sweep.motions()[place + k]);
        let friction = &self.state.controls.friction[slave];
        let next = self.sweep.assumed(slave).mode();
        let limit = match next {
            Mode::Free => 0.0,
            _ => friction.limit(f_n),
        };
        let slip = u_1.hypot(u_2);
        let mut record = ContactRecord {
            gap,
            f_n,
            f_t: f_1.hypot(f_2),
            t_max: limit,
            t_max_used: limit,
            slip,
            drift: slip,
            // Slip is the motion of the surface relative to the node.
            directions: Some([f_2.atan2(f_1), (-u_2).atan2(-u_1)]),
            foot: self.model.nodes[self.model.contacts[slave].node].at,
            ..ContactRecord::from_modes(node.mode, next, node)
        };
        record.decision.rule = if error <= bound {
            Rule::Settled
        } else {
            Rule::Sweeps
        };
        record.decision.tests[0] = Some(Test {
            tested: TestedQuantity::Error,
            value: error,
            bound,
            margin: bound - error,
            tie: false,
        });
        record
    }

    /// Goes to the forces of the current state.
    fn go(&mut self) -> Result<u64, SolverLost> {
        let place = self.state.place().unwrap_or(0);
        if self.at != Some(place) || !self.state.changes().is_empty() {
            let forces = self.forces.get(place);
            let forces =
                forces.ok_or_else(|| SolverLost::new("the state is not one of this solver"))?;
            let friction = &self.state.controls.friction;
            let sweeps = self.forces.depth(place);
            self.error = self.sweep.continue_from(forces, friction, sweeps, SETTLED);
        }
        self.at = None;
        Ok(place)
    }
}

impl Solver for ConeSolver {
    fn now(&self) -> Now<'_> {
        Now::new(&self.model, &self.state, &self.event)
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }

    fn advance(&mut self) -> Result<(), SolverLost> {
        let place = self.go()?;
        let asked = self.state.changes().to_vec();
        let limit = self.bound();
        let last = self.state.next.minor >= MOST;
        let norms = |relative: f64| Norms {
            relative,
            limit,
            ..Norms::default()
        };
        let before = norms(self.error);
        self.sweep.sweep();
        self.error = self.sweep.settle(SETTLED);
        let error = self.error;
        let count = self.model.contacts.len();
        let nodes: Vec<_> = (0..count).map(|slave| self.record(slave, error)).collect();
        let changes = |record: &ContactRecord| record.decision.next != record.decision.before;
        let outcome = match error <= limit && (limit > SETTLED || !nodes.iter().any(changes)) {
            true => Outcome::accepted(norms(error), true),
            false if last => Outcome::Failed(Failure::Reported {
                reason: format!(
                    "{MOST} sweeps do not converge; the natural map of the forces is {error:.1e}"
                ),
                relative: Some(error),
            }),
            false => Outcome::Minor,
        };
        self.event = Event {
            position: self.state.next,
            load_factor: 1.0,
            nodes,
            before,
            frames: Arc::new(vec![[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]; count]),
            outcome,
            ..Event::nothing_yet(&self.model)
        };
        let moved = self
            .sweep
            .motions()
            .chunks_exact(3)
            .flat_map(|motion| [motion[1], motion[2], motion[0]]);
        // The floor does not move.
        let all = moved.chain(std::iter::repeat(0.0));
        self.state.u = Arc::new(all.take(self.model.dofs.len()).collect());
        let largest = judged::largest_force(&self.event.nodes);
        if let Some(outside) = &mut self.state.outside {
            outside.largest_force = largest;
        }
        let sizes = ReferenceSizes::from_state(&self.state, &self.event);
        let broken = judged::broken(&self.model, &self.event.nodes, &sizes);
        if let Outcome::Increment { marked, .. } = &mut self.event.outcome {
            *marked = broken;
        }
        let forces = self.sweep.forces().to_vec();
        let next = match self.forces.follows(place, &asked) {
            Some(next) => next,
            None => self.forces.add(place, asked, forces),
        };
        self.state.follow(&self.event, next);
        self.at = Some(next);
        Ok(())
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities {
            name: "Gauss-Seidel in space".into(),
            friction: true,
            cohesion: true,
            problem: true,
            goes_back: RewindSupport::ToAny,
            ..Capabilities::default()
        }
    }

    fn interface_problem(&mut self, state: &State) -> Result<ReportedProblem, SolverLost> {
        let count = self.model.contacts.len();
        if count > MOST_DENSE {
            return Err(SolverLost::new(format!(
                "the problem has {count} contacts; its matrix is only given up to {MOST_DENSE}"
            )));
        }
        let friction: &[Friction] = &state.controls.friction;
        let mut matrix = vec![vec![0.0; 3 * count]; 3 * count];
        for &(i, j, value) in &self.problem.entries {
            matrix[i][j] += value;
        }
        Ok(ReportedProblem {
            contacts: (0..count).collect(),
            tangents: 2,
            form: ReportedForm::Compliance,
            matrix,
            q: self.problem.free.clone(),
            load: Vec::new(),
            friction: friction.to_vec(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Contact, Node, Surface};
    use crate::plane::max_abs;
    use crate::step::Status;

    /// Contacts on a floor with the compliance W = diagonal + coupling, pushed down and along different directions.
    fn solver(count: usize, mu: f64) -> ConeSolver {
        let mut nodes: Vec<Node> = (0..count)
            .map(|k| Node {
                name: format!("c{}", k + 1),
                at: [k as f64, 0.0],
            })
            .collect();
        let corner = |name: &str, x: f64| Node {
            name: name.into(),
            at: [x, 0.0],
        };
        nodes.extend([corner("floor.1", -1.0), corner("floor.2", count as f64)]);
        let floor = Surface::new("floor", vec![vec![count + 1, count]], true);
        let friction = Friction::from_coefficient(mu, 0.0);
        let contacts = (0..count).map(|k| Contact::new(k, vec![0], friction));
        let mut model = Model::from_contacts("A block", nodes, vec![floor], contacts.collect());
        let size = 3 * count;
        // Symmetric and diagonally dominant.
        let entry = |i: usize, j: usize| {
            if i == j {
                2.0 + 0.1 * (i % 3) as f64
            } else {
                0.8 * ((i * j + i + j) as f64).sin() / size as f64
            }
        };
        let all = (0..size).flat_map(|i| (0..size).map(move |j| (i, j)));
        let free = (0..size).map(|i| match i % 3 {
            0 => {
                if i % 4 == 3 {
                    0.4
                } else {
                    -1.0 - 0.1 * i as f64
                }
            }
            _ => (1.7 * i as f64).cos(),
        });
        model.raise(vec![0.0; count + 2]);
        if let Some(space) = &mut model.space {
            space.problem = Some(Arc::new(SpaceProblem {
                entries: all.map(|(i, j)| (i, j, entry(i, j))).collect(),
                free: free.collect(),
            }));
        }
        ConeSolver::new(Arc::new(model)).expect("it has a problem")
    }

    /// An independent solution: the fixed point r = P_K(r - rho (u + mu |u_t| n)) of De Saxce and Feng (1998).
    fn fixed_point(problem: &SpaceProblem, mu: f64) -> Vec<f64> {
        let size = problem.free.len();
        let mut r = vec![0.0; size];
        for _ in 0..20_000 {
            let mut u = problem.free.clone();
            problem
                .entries
                .iter()
                .for_each(|&(i, j, w)| u[i] += w * r[j]);
            for k in (0..size).step_by(3) {
                let slip = u[k + 1].hypot(u[k + 2]);
                let [n, a, b] = [u[k] + mu * slip, u[k + 1], u[k + 2]];
                let [n, a, b] = [r[k] - 0.2 * n, r[k + 1] - 0.2 * a, r[k + 2] - 0.2 * b];
                let t = a.hypot(b);
                let onto = match (t <= mu * n, mu * t <= -n) {
                    (true, _) => [n, a, b],
                    (_, true) => [0.0; 3],
                    _ => {
                        let n = (n + mu * t) / (1.0 + mu * mu);
                        [n, mu * n * a / t, mu * n * b / t]
                    }
                };
                r[k..k + 3].copy_from_slice(&onto);
            }
        }
        r
    }

    #[test]
    fn sweeps_find_the_forces_of_another_method() {
        let mut modes = [0; 3];
        for mu in [0.1, 0.3, 0.6] {
            let mut solver = solver(9, mu);
            while solver.step().expect("it steps") {}
            assert_eq!(solver.state().status, Status::Finished);
            let expected = fixed_point(&solver.problem, mu);
            let largest = max_abs(&expected);
            for (found, expected) in solver.sweep.forces().iter().zip(&expected) {
                assert!(
                    (found - expected).abs() < 1e-7 * largest,
                    "{found} {expected}"
                );
            }
            let Outcome::Increment { marked, .. } = solver.event().outcome else {
                panic!("it is accepted");
            };
            assert_eq!(marked, None);
            for node in &solver.event().nodes {
                modes[node.decision.next as usize] += 1;
                assert!(node.deviation().is_none_or(|angle| angle < 1e-6));
            }
        }
        assert!(modes.iter().all(|count| *count > 0), "{modes:?}");
    }

    #[test]
    fn going_back_repeats_the_same_bits() {
        let mut solver = solver(5, 0.4);
        let mut states = vec![solver.state().clone()];
        let mut events = Vec::new();
        while solver.step().expect("it steps") {
            states.push(solver.state().clone());
            events.push(solver.event().clone());
        }
        for k in (0..events.len()).rev() {
            solver.restore(&states[k]).expect("its own state");
            assert!(solver.step().expect("it steps"));
            assert_eq!(solver.event(), &events[k]);
            assert_eq!(solver.state(), &states[k + 1]);
            assert_eq!(solver.state().u.len(), solver.model().dofs.len());
        }
    }

    /// The first contact is coupled with no other, sticks at once, and is not swept again.
    #[test]
    fn a_contact_that_has_settled_keeps_its_mode_with_another_friction() {
        let mut solver = solver(3, 0.6);
        let coupled = [
            [2.0, 0.3, 0.1, 1.7, 0.2, 0.1],
            [0.3, 2.0, 0.2, 0.1, 1.1, 0.3],
            [0.1, 0.2, 2.0, 0.2, 0.1, 1.0],
            [1.7, 0.1, 0.2, 2.0, 0.1, 0.2],
            [0.2, 1.1, 0.1, 0.1, 2.0, 0.1],
            [0.1, 0.3, 1.0, 0.2, 0.1, 2.0],
        ];
        let others = (0..6).flat_map(|i| (0..6).map(move |j| (3 + i, 3 + j, coupled[i][j])));
        let entries = (0..3).map(|i| (i, i, 1.0)).chain(others).collect();
        let free = vec![-1.0, 0.1, 0.05, -1.0, 1.0, -2.0, -1.4, -1.0, 1.5];
        let mut model = (*solver.model).clone();
        if let Some(space) = &mut model.space {
            space.problem = Some(Arc::new(SpaceProblem { entries, free }));
        }
        solver = ConeSolver::new(Arc::new(model)).expect("it has a problem");
        for _ in 0..2 {
            assert!(solver.step().expect("it steps"));
        }
        let controls = Arc::make_mut(&mut solver.state_mut().controls);
        let friction = Friction::from_coefficient(0.61, 0.0);
        controls.friction.fill(friction);
        solver.at = None;
        assert!(solver.step().expect("it steps"));
        let record = &solver.event().nodes[0];
        assert_eq!(record.decision.next, Mode::Fixed);
        assert!(record.t_max > record.f_t, "{record:?}");
    }
}
