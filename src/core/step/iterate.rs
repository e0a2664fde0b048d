//! The current state with its model and its linearisation: what a minor iteration solves. It knows neither the strategies nor the
//! events of the stepper.
//!
//! The modules of the three levels add its methods where they are used: `major` renews and compares, `increment` accepts and
//! restarts, `arc` follows the path, [`crate::step::recovery`] retries.

use crate::{Deformation, IncrementStart, Model, Norms, Source, State};
use std::any::Any;
use std::sync::Arc;

/// A state, and the workspace that belongs to it.
pub(super) struct Iterate {
    pub model: Arc<Model>,
    pub source: Box<dyn Source>,
    pub state: State,
    /// Whether `source` is linearised at `state`.
    pub linearised: bool,
    /// Whether the last linearisation is at the displacements of `state`, so that monitors can be read from it.
    pub measured: bool,
    /// The extreme deformations that [`Iterate::inverted`] last found.
    pub deformation: Option<Deformation>,
    /// Norms of the last linearisation.
    pub norms: Norms,
    /// Data that a search over all nodes keeps between proposals.
    pub kept: Option<Box<dyn Any + Send>>,
    /// Buffer for the displacements at which a stiffness is computed.
    pub room: Option<Arc<Vec<f64>>>,
}

impl Iterate {
    /// The start of a history.
    pub fn new(model: Arc<Model>, source: Box<dyn Source>) -> Self {
        let mut now = Iterate {
            state: State::at_start(&model, source.start(), source.history()),
            source,
            linearised: false,
            measured: false,
            deformation: None,
            norms: Norms::default(),
            kept: None,
            room: None,
            model,
        };
        now.begin();
        now
    }

    /// Returns to the start of the history of another model, with the same workspace.
    pub fn renew(&mut self, model: &Arc<Model>) {
        self.state = State::at_start(model, self.source.start(), self.source.history());
        self.norms = Norms::default();
        self.model = model.clone();
        self.forget_workspace();
        self.begin();
    }

    /// Finds the positions of the contacts on their surfaces at the start.
    fn begin(&mut self) {
        self.follow();
        self.source.place_stick_points(&mut self.state.nodes);
        let start = IncrementStart {
            nodes: self.state.nodes.clone(),
            ..(*self.state.start).clone()
        };
        self.state.start = Arc::new(start);
    }

    /// Linearises at the current state, unless that is done; false if it cannot be linearised.
    pub(super) fn linearise(&mut self) -> bool {
        if !self.linearised {
            let at = self.state.at();
            self.linearised = self.source.linearise(&at).is_ok();
            self.measured = self.linearised;
            self.source.turn(&at);
        }
        self.linearised
    }

    /// Discards data computed from another state.
    pub(super) fn forget_workspace(&mut self) {
        (self.linearised, self.measured) = (false, false);
        self.kept = None;
    }
}
