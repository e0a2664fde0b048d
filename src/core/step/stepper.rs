//! The two-level iteration (increments > major > minor) as a state machine: one call, one minor iteration.
//!
//! ```text
//! increment   the load factor moves on
//!   major     geometry, stiffness and residual are renewed and frozen          Source::linearise
//!     minor   solve for the assumed modes, check them by Table 2, assume anew   Stepper::step
//!   until modes and T_max have settled; then displacements and forces are updated
//! until residual and interface conditions are within the tolerance; then the increment is accepted
//! ```
//!
//! The rooms around this box: `minor` solves and checks, `search` is what happens where the modes do not settle, `major`
//! takes the forces back, `verdict` and `jump` say whether a converged state is accepted, `increment` accepts it or cuts.

use crate::contact::record::ContactRecord;
use crate::contact::state::ContactState;
use crate::executor::Executor;
use crate::interface::kinematics::NodeKinematics;
use crate::interface::method::Method;
use crate::interface::minor_history::Cycle;
use crate::interface::problem::InterfaceProblem;
use crate::linear::bodies::Bodies;
use crate::linear::norms::Norms;
use crate::linear::singular::Singular;
use crate::linear::source::{Solved, Source, Work};
use crate::linear::stability::Stability;
use crate::model::{Model, Strategy};
use crate::step::event::{Event, Failure, Outcome};
use crate::step::intervene::{Intervention, Refusal};
use crate::step::recovery::left_out::LeftOut;
use crate::step::state::{IncrementStart, State, Status};
use crate::strategy::{self, AnyMethod};
use std::any::Any;
use std::sync::Arc;

/// The solver: a state, and the workspace that is made from it.
pub struct Stepper {
    pub(super) model: Arc<Model>,
    pub(super) state: State,
    pub(super) source: Box<dyn Source>,
    /// Whether `source` is linearised about `state`.
    pub(super) linearised: bool,
    /// Whether the last linearisation is about the displacements of `state`, so that what is watched can be read off it.
    pub(super) measured: bool,
    /// Norms of the last linearisation.
    pub(super) norms: Norms,
    /// What a search over all nodes keeps from one proposal to the next.
    pub(super) kept: Option<Box<dyn Any + Send>>,
    /// Room for the displacements about which a stiffness is taken.
    pub(super) room: Option<Arc<Vec<f64>>>,
    /// What another solver had at hand.
    borrowed: Option<Box<Lent>>,
    /// What the contacts came with into the present minor iteration, where only one of them may change.
    pub(super) before: Vec<ContactState>,
    pub(super) event: Event,
    /// What it does without.
    pub(super) left_out: Option<LeftOut>,
    /// The strategy in place of Table 2.
    custom: Option<Arc<dyn Method>>,
}

/// What one solver lends another of the same scene.
pub struct Lent {
    state: State,
    problem: InterfaceProblem,
    /// The cycle that the minor iterations run into from the state.
    cycle: Option<Cycle>,
}

impl Stepper {
    /// A solver of our own bodies at the start of a scene's history.
    pub fn new(model: Arc<Model>) -> Self {
        let bodies = Bodies::new(model.clone());
        Stepper::with_source(model, Box::new(bodies))
    }

    /// The same, whose bodies this executor works on side by side.
    pub fn with_executor(model: Arc<Model>, executor: Arc<dyn Executor>) -> Self {
        let bodies = Bodies::with_executor(model.clone(), executor);
        Stepper::with_source(model, Box::new(bodies))
    }

    /// A solver at the start of a history, of whatever deforms under the model's contacts.
    pub fn with_source(model: Arc<Model>, source: Box<dyn Source>) -> Self {
        let mut stepper = Stepper {
            state: State::at_start(&model, source.start(), source.history()),
            source,
            event: Event::nothing_yet(&model),
            linearised: false,
            measured: false,
            norms: Norms::default(),
            kept: None,
            room: None,
            borrowed: None,
            before: Vec::new(),
            left_out: None,
            custom: None,
            model,
        };
        stepper.begin();
        stepper
    }

    /// Uses a strategy from outside this package in place of Table 2, and chooses it. No other strategy follows where it fails.
    pub fn with_strategy(mut self, strategy: Arc<dyn Method>) -> Self {
        let settings = &mut Arc::make_mut(&mut self.state.controls).settings;
        settings.strategy = Strategy::Table2;
        settings.t_max = strategy.bound(settings.t_max);
        self.custom = Some(strategy);
        self
    }

    /// The strategy in force.
    pub(super) fn method(&self) -> AnyMethod {
        match (self.state.settings().strategy, &self.custom) {
            (Strategy::Table2, Some(custom)) => AnyMethod::Custom(custom.clone()),
            (strategy, _) => AnyMethod::Builtin(strategy::method(strategy)),
        }
    }

    /// Goes to the start of the history of a model that differs from its own in friction, loads, history and settings alone,
    /// with the workspace that it has; what follows has the same bits as with a new solver. False, and nothing is changed,
    /// for any other model, and with a source that cannot ([`Source::renew`]).
    pub fn renew(&mut self, model: &Arc<Model>) -> bool {
        if !self.source.renew(model) {
            return false;
        }
        self.state = State::at_start(model, self.source.start(), self.source.history());
        self.event = Event::nothing_yet(model);
        self.norms = Norms::default();
        self.before.clear();
        self.borrowed = None;
        self.model = model.clone();
        self.forget_workspace();
        self.begin();
        true
    }

    /// Finds where the contacts stand at the start.
    fn begin(&mut self) {
        self.follow();
        self.source.place_stick_points(&mut self.state.nodes);
        let start = IncrementStart {
            nodes: self.state.nodes.clone(),
            ..(*self.state.start).clone()
        };
        self.state.start = Arc::new(start);
    }

    /// One minor iteration. `None` when the history is done.
    ///
    /// After a failure the next call goes on from the failed state, as a user does who has changed something.
    pub fn step(&mut self) -> Option<&Event> {
        if self.state.status == Status::Finished {
            return None;
        }
        self.state.status = Status::Running;
        self.event.position = self.state.next;
        self.event.load_factor = self.state.load_factor;
        self.event.drag = self.state.at().drag.unwrap_or(0.0);
        self.event.nodes.clear();
        self.event.outcome = self.iterate();
        self.event.arc = self.state.arc();
        if self.state.way.is_some() && self.event.outcome.ends_major() {
            self.event.load_factor = self.state.last_target;
        }
        if let Outcome::Failed(failure) = &self.event.outcome {
            self.state.status = Status::Failed(failure.clone());
        }
        Some(&self.event)
    }

    /// The algorithm box: one minor iteration, and what follows from it.
    fn iterate(&mut self) -> Outcome {
        match self.iterate_minor() {
            Some(outcome) => outcome,
            None => self.end_major(true),
        }
    }

    /// One minor iteration; `None` where modes and T_max have settled, which ends the major one.
    fn iterate_minor(&mut self) -> Option<Outcome> {
        if !self.linearise() {
            return Some(self.fail(Failure::Singular(Singular::Unexplained)));
        }
        if let Err(why) = self.find_tangent() {
            return Some(self.fail(why));
        }
        self.norms = self.source.norms(&self.state.at());
        self.event.before = self.norms;
        if let Some((start, step)) = self.searching() {
            return Some(self.propose(start, step));
        }
        self.remember();
        let solved = self.source.solve(&self.state.at());
        if let Some(why) = self.unsolvable(solved) {
            return Some(self.escalate(why));
        }
        self.state.minors += 1;
        let settled = self.check();
        self.note_changes();
        if !settled {
            return Some(self.go_on());
        }
        if solved == Solved::NearlySingular && self.is_unbounded() {
            return Some(self.escalate(Failure::Singular(Singular::Unexplained)));
        }
        self.unsupported().map(|first| self.fail(first))
    }

    /// The cycle that the minor iterations of the present major one run into from here; `None` where they settle, or end some
    /// other way. It ends where it began.
    pub fn cycle_ahead(&mut self) -> Option<Cycle> {
        if let Some(lent) = self
            .borrowed
            .as_ref()
            .filter(|lent| lent.state == self.state)
        {
            return lent.cycle.clone();
        }
        let began = self.state.clone();
        let found = loop {
            self.event.position = self.state.next;
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
        &self.model
    }

    /// Where the solver is.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Goes to a state of the same scene; what follows has the same bits as the first time.
    ///
    /// Within a major iteration it costs nothing: the linearisation and its factors stand.
    pub fn restore(&mut self, state: &State) {
        let stands = self.stands_for(state);
        self.state.clone_from(state);
        #[cfg(mutants)]
        let stands = crate::mutants::pick("restore-keeps-the-factors", stands, true);
        let kept = self.source.restore(&self.state.at());
        self.forget_workspace();
        (self.linearised, self.measured) = (stands && kept, stands && kept);
    }

    /// Applies what the user wants changed.
    ///
    /// # Errors
    /// Those of [`State::intervene`].
    pub fn intervene(&mut self, intervention: &Intervention) -> Result<(), Refusal> {
        let before = self.state.clone();
        let done = self.state.intervene(&self.model, intervention);
        let stands = self.stands_for(&before);
        self.forget_workspace();
        (self.linearised, self.measured) = (stands, stands);
        done
    }

    /// Norms of the present state, about which the next minor iteration is linearised; `None` where it cannot be.
    pub fn norms(&mut self) -> Option<Norms> {
        if !self.linearise() {
            return None;
        }
        self.norms = self.source.norms(&self.state.at());
        Some(self.norms)
    }

    /// Whether the minor iterations are solved on the condensed interface.
    pub fn condenses(&self) -> bool {
        self.source.condenses(&self.state.controls.settings)
    }

    /// The interface problem of the present major iteration; `None` where the bodies cannot be condensed.
    pub fn interface_problem(&mut self) -> Option<InterfaceProblem> {
        if let Some(problem) = self.borrowed() {
            return Some(problem);
        }
        if !self.linearise() {
            return None;
        }
        self.source.problem(&self.state.at()).ok()
    }

    /// What there is to know of a state's frozen problem, where it is at hand: the bodies are condensed, and within the same
    /// major iteration. It goes to that state.
    pub fn lend(&mut self, state: &State) -> Option<Lent> {
        let at_hand = self.condenses() && self.stands_for(state);
        at_hand.then(|| self.restore(state))?;
        Some(Lent {
            problem: self.interface_problem()?,
            cycle: self.cycle_ahead(),
            state: state.clone(),
        })
    }

    /// Takes what another solver of the same scene has at hand, so that it need not be found again within its major iteration.
    pub fn borrow(&mut self, lent: Lent) {
        self.borrowed = Some(Box::new(lent));
    }

    /// What was borrowed, for the present state.
    fn borrowed(&self) -> Option<InterfaceProblem> {
        let lent = self.borrowed.as_ref()?;
        if !lent.state.is_linearised_as(&self.state) {
            return None;
        }
        let mut problem = lent.problem.clone();
        problem.settings = self.state.settings();
        for node in &mut problem.nodes {
            node.state = self.state.nodes[node.slave];
            let friction = &self.state.controls.friction[node.slave];
            node.friction = node.state.friction(friction);
        }
        Some(problem)
    }

    /// Whether linearisation and factors are those of a state.
    pub fn stands_for(&self, state: &State) -> bool {
        self.linearised && self.state.is_linearised_as(state)
    }

    /// How a contact stands over its surface at the start of the present major iteration; `None` where it has no surface,
    /// or where nothing can be linearised.
    pub fn kinematics(&mut self, contact: usize) -> Option<NodeKinematics> {
        if !self.linearise() {
            return None;
        }
        self.source.kinematics(contact)
    }

    /// Which motions nothing resists while the contacts, where they are now, have the modes of these.
    pub fn loose(&self, contacts: &[ContactState]) -> Singular {
        self.source.explain(contacts)
    }

    /// Values of the scene's monitors at the start of the present major iteration (after an accepted increment: at
    /// its end), appended to `out`.
    pub fn monitors(&mut self, out: &mut Vec<f64>) {
        if !self.measured {
            self.linearise();
        }
        let at = self.state.at();
        let monitors = self.model.monitors.iter();
        out.extend(monitors.map(|monitor| self.source.monitor(&monitor.of, &at)));
    }

    /// Stability of the state at the start of the present major iteration (after an accepted increment: at its end), with the
    /// modes that its nodes have. It costs a factorization, and changes nothing.
    pub fn stability(&mut self) -> Stability {
        if !self.linearise() {
            return Stability::NotKnown;
        }
        self.source.stability(&self.state.at())
    }

    /// What has been assembled and factored so far.
    pub fn work(&self) -> Work {
        self.source.work()
    }

    /// Linearises about the present state, unless that is done; false where it cannot be.
    pub(super) fn linearise(&mut self) -> bool {
        if !self.linearised {
            let at = self.state.at();
            self.linearised = self.source.linearise(&at).is_ok();
            self.measured = self.linearised;
            self.source.turn(&at);
        }
        self.linearised
    }

    /// What was made from another state is of no use any more.
    pub(super) fn forget_workspace(&mut self) {
        (self.linearised, self.measured) = (false, false);
        self.kept = None;
    }

    /// What the last minor iteration found at a contact.
    pub(super) fn record(&self, contact: usize) -> &ContactRecord {
        &self.event.nodes[contact]
    }
}
