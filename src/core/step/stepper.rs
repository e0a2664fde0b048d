//! The two-level iteration (increments > major > minor) as a state machine: one call, one minor iteration.
//!
//! ```text
//! increment   the load factor advances
//!   major     geometry, stiffness and residual are renewed and frozen          Source::linearise
//!     minor   solve for the assumed modes, check them by Table 2, update them    Stepper::step
//!   until modes and T_max have converged; then displacements and forces are updated
//! until residual and interface conditions are within the tolerance; then the increment is accepted
//! ```
//!
//! The modules around this box: `minor` solves and checks, `search` handles modes that do not converge, `major` updates the
//! forces, `verdict` and `jump` decide whether a converged state is accepted, `increment` accepts it or cuts.

use crate::executor::{Executor, SequentialExecutor};
use crate::linear::bodies::Bodies;
use crate::linear::sparse::SparseInterface;
use crate::step::iterate::Iterate;
use crate::step::recovery::left_out::OmittedStep;
use crate::strategy::{self, AnyMethod};
use crate::{
    ContactState, Cycle, Event, Failure, InterfaceProblem, Intervention, Method, Model,
    NodeIncrement, NodeKinematics, Norms, Outcome, Refusal, Singular, SolveResult, Source,
    Stability, State, Status, Strategy, Work,
};
use std::sync::Arc;

/// The solver: a state with its workspace, the strategy in force, and the event of the last minor iteration.
pub struct Stepper {
    pub(super) now: Iterate,
    /// Frozen problem borrowed from another stepper of the same scene.
    borrowed: Option<Box<FrozenProblem>>,
    /// Contacts at the start of the current minor iteration, if only one of them may change.
    pub(super) before: Vec<ContactState>,
    pub(super) event: Event,
    /// The recovery or strategy that is disabled.
    pub(super) left_out: Option<OmittedStep>,
    /// The strategy used instead of Table 2.
    custom: Option<Arc<dyn Method>>,
}

/// Frozen problem that one stepper lends to another of the same scene.
pub struct FrozenProblem {
    state: State,
    problem: InterfaceProblem,
    /// The cycle that the minor iterations from this state run into.
    cycle: Option<Cycle>,
}

impl Stepper {
    /// A stepper of built-in bodies at the start of a scene's history.
    pub fn new(model: Arc<Model>) -> Self {
        Stepper::with_executor(model, Arc::new(SequentialExecutor))
    }

    /// The same, with an executor that works on the bodies in parallel.
    pub fn with_executor(model: Arc<Model>, executor: Arc<dyn Executor>) -> Self {
        if let Some(contacts) = SparseInterface::new(&model) {
            return Stepper::with_source(model, Box::new(contacts));
        }
        let bodies = Bodies::with_executor(model.clone(), executor);
        Stepper::with_source(model, Box::new(bodies))
    }

    /// A stepper at the start of a history, for any source of deformation under the model's contacts.
    pub fn with_source(model: Arc<Model>, source: Box<dyn Source>) -> Self {
        let event = Event::nothing_yet(&model);
        Stepper {
            now: Iterate::new(model, source),
            event,
            borrowed: None,
            before: Vec::new(),
            left_out: None,
            custom: None,
        }
    }

    /// Selects a strategy from outside this package instead of Table 2. If it fails, no other strategy follows.
    pub fn with_strategy(mut self, strategy: Arc<dyn Method>) -> Self {
        let settings = &mut Arc::make_mut(&mut self.now.state.controls).settings;
        settings.strategy = Strategy::Table2;
        settings.t_max = strategy.bound(settings.t_max);
        self.custom = Some(strategy);
        self
    }

    /// The strategy in force.
    pub(super) fn method(&self) -> AnyMethod {
        match (self.now.state.settings().strategy, &self.custom) {
            (Strategy::Table2, Some(custom)) => AnyMethod::Custom(custom.clone()),
            (strategy, _) => AnyMethod::Builtin(strategy::method(strategy)),
        }
    }

    /// Restarts at the beginning of the history of a model that differs only in friction, loads, history and settings, and reuses
    /// the workspace; the results are bit-identical to those of a new stepper. Returns false and changes nothing for any other
    /// model, or if the source does not support this ([`Source::renew`]).
    pub fn renew(&mut self, model: &Arc<Model>) -> bool {
        if !self.now.source.renew(model) {
            return false;
        }
        self.now.renew(model);
        self.event = Event::nothing_yet(model);
        self.before.clear();
        self.borrowed = None;
        true
    }

    /// Does one minor iteration. `None` if the history is finished.
    ///
    /// After a failure the next call continues from the failed state, for instance after a change by the user.
    pub fn step(&mut self) -> Option<&Event> {
        if self.now.state.status == Status::Finished {
            return None;
        }
        self.now.state.status = Status::Running;
        self.event.position = self.now.state.next;
        self.event.load_factor = self.now.state.load_factor;
        self.event.drag = self.now.state.at().drag.unwrap_or(0.0);
        self.event.nodes.clear();
        self.now.state.count_cost(1);
        self.event.outcome = self.iterate();
        self.event.arc = self.now.state.arc();
        if self.now.state.way.is_some() && self.event.outcome.ends_major() {
            self.event.load_factor = self.now.state.major.last_target;
        }
        if let Outcome::Failed(failure) = &self.event.outcome {
            self.now.state.status = Status::Failed(failure.clone());
        }
        Some(&self.event)
    }

    /// The algorithm box: one minor iteration, and its outcome.
    fn iterate(&mut self) -> Outcome {
        match self.iterate_minor() {
            Some(outcome) => outcome,
            None => self.end_major(true),
        }
    }

    /// One minor iteration; `None` if modes and T_max have converged, which ends the major iteration.
    fn iterate_minor(&mut self) -> Option<Outcome> {
        if !self.now.linearise() {
            return Some(self.fail(Failure::Singular(Singular::Unexplained)));
        }
        if let Err(why) = self.now.find_tangent() {
            return Some(self.fail(why));
        }
        self.now.norms = self.now.source.norms(&self.now.state.at());
        self.event.before = self.now.norms;
        if let Some((start, step)) = self.searching() {
            return Some(self.propose(start, step));
        }
        self.now.state.remember();
        let solved = self.now.source.solve(&self.now.state.at());
        if let Some(why) = self.now.unsolvable(solved) {
            return Some(self.escalate(why));
        }
        self.now.state.attempt.minors += 1;
        let settled = self.check();
        self.now.state.note_changes(&self.event.nodes);
        if !settled {
            return Some(self.go_on());
        }
        if solved == SolveResult::NearlySingular && self.now.is_unbounded() {
            return Some(self.escalate(Failure::Singular(Singular::Unexplained)));
        }
        self.now
            .unsupported(&self.event.nodes)
            .map(|first| self.fail(first))
    }

    /// Looks ahead for a cycle of the minor iterations of the current major iteration; `None` if they converge or end in another
    /// way. The state is restored.
    pub fn cycle_ahead(&mut self) -> Option<Cycle> {
        if let Some(lent) = self
            .borrowed
            .as_ref()
            .filter(|lent| lent.state == self.now.state)
        {
            return lent.cycle.clone();
        }
        let began = self.now.state.clone();
        let found = loop {
            self.event.position = self.now.state.next;
            self.event.nodes.clear();
            match self.iterate_minor() {
                Some(Outcome::Minor) => {}
                Some(Outcome::Failed(Failure::Cycle(cycle))) => break Some(cycle),
                _ => break None,
            }
        };
        self.restore(&began);
        found
    }

    /// The event of the last minor iteration.
    pub fn event(&self) -> &Event {
        &self.event
    }

    /// The scene.
    pub fn model(&self) -> &Arc<Model> {
        &self.now.model
    }

    /// Current state of the solver.
    pub fn state(&self) -> &State {
        &self.now.state
    }

    /// Restores a state of the same scene; the iterations from there are bit-identical to the first time.
    ///
    /// Within a major iteration this is free: the linearisation and its factors remain valid.
    pub fn restore(&mut self, state: &State) {
        let stands = self.stands_for(state);
        self.now.state.clone_from(state);
        let kept = self.now.source.restore(&self.now.state.at());
        self.now.forget_workspace();
        (self.now.linearised, self.now.measured) = (stands && kept, stands && kept);
    }

    /// Applies a change made by the user.
    ///
    /// # Errors
    /// Those of [`State::intervene`].
    pub fn intervene(&mut self, intervention: &Intervention) -> Result<(), Refusal> {
        let before = self.now.state.clone();
        let done = self.now.state.intervene(&self.now.model, intervention);
        let stands = self.stands_for(&before);
        self.now.forget_workspace();
        (self.now.linearised, self.now.measured) = (stands, stands);
        done
    }

    /// Norms of the current state, where the next minor iteration is linearised; `None` if it cannot be linearised.
    pub fn norms(&mut self) -> Option<Norms> {
        if !self.now.linearise() {
            return None;
        }
        self.now.norms = self.now.source.norms(&self.now.state.at());
        Some(self.now.norms)
    }

    /// The degree of freedom with the largest out-of-balance force in the last linearisation, and that force; `None` if unknown.
    pub fn largest_residual(&self) -> Option<(usize, f64)> {
        self.now.source.largest_residual()
    }

    /// Increments of a contact's forces and motion in the last minor iteration.
    pub fn increment(&self, contact: usize) -> NodeIncrement {
        self.now.source.increment(contact)
    }

    /// Whether the minor iterations are solved on the condensed interface.
    pub fn condenses(&self) -> bool {
        self.now.source.condenses(&self.now.state.controls.settings)
    }

    /// The interface problem of the current major iteration; `None` if the bodies cannot be condensed.
    pub fn interface_problem(&mut self) -> Option<InterfaceProblem> {
        if let Some(problem) = self.borrowed() {
            return Some(problem);
        }
        if !self.now.linearise() {
            return None;
        }
        self.now.source.problem(&self.now.state.at()).ok()
    }

    /// Restores a state and lends its frozen problem, if it is available: if the bodies are condensed, and within the same major
    /// iteration.
    pub fn lend(&mut self, state: &State) -> Option<FrozenProblem> {
        let at_hand = self.condenses() && self.stands_for(state);
        at_hand.then(|| self.restore(state))?;
        Some(FrozenProblem {
            problem: self.interface_problem()?,
            cycle: self.cycle_ahead(),
            state: state.clone(),
        })
    }

    /// Borrows a frozen problem from another stepper of the same scene, so that it is not recomputed within its major iteration.
    pub fn borrow(&mut self, lent: FrozenProblem) {
        self.borrowed = Some(Box::new(lent));
    }

    /// The borrowed problem, if it belongs to the current state.
    fn borrowed(&self) -> Option<InterfaceProblem> {
        let lent = self.borrowed.as_ref()?;
        if !lent.state.is_linearised_as(&self.now.state) {
            return None;
        }
        let mut problem = lent.problem.clone();
        problem.settings = self.now.state.settings();
        for node in &mut problem.nodes {
            node.state = self.now.state.nodes[node.slave];
            let friction = &self.now.state.controls.friction[node.slave];
            node.friction = node.state.friction(friction);
        }
        Some(problem)
    }

    /// Whether linearisation and factors belong to a state.
    pub fn stands_for(&self, state: &State) -> bool {
        self.now.linearised && self.now.state.is_linearised_as(state)
    }

    /// Kinematics of a contact on its surface at the start of the current major iteration; `None` if it has no surface or the
    /// state cannot be linearised.
    pub fn kinematics(&mut self, contact: usize) -> Option<NodeKinematics> {
        if !self.now.linearise() {
            return None;
        }
        self.now.source.kinematics(contact)
    }

    /// Motions without any resistance for the modes of these contacts, at the current positions.
    pub fn loose(&self, contacts: &[ContactState]) -> Singular {
        self.now.source.explain(contacts)
    }

    /// Appends the values of the scene's monitors at the start of the current major iteration (after an accepted increment: at
    /// its end) to `out`.
    pub fn monitors(&mut self, out: &mut Vec<f64>) {
        if !self.now.measured {
            self.now.linearise();
        }
        let at = self.now.state.at();
        let monitors = self.now.model.monitors.iter();
        out.extend(monitors.map(|monitor| self.now.source.monitor(&monitor.of, &at)));
    }

    /// Stability of the state at the start of the current major iteration (after an accepted increment: at its end), with the
    /// current modes of its nodes. It costs a factorization and changes nothing.
    pub fn stability(&mut self) -> Stability {
        if !self.now.linearise() {
            return Stability::NotKnown;
        }
        self.now.source.stability(&self.now.state.at())
    }

    /// Counts of the assemblies and factorizations so far.
    pub fn work(&self) -> Work {
        self.now.source.work()
    }
}
