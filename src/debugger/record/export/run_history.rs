//! What pictures show of a run besides its last state.

use super::export_state::{COLUMNS, ExportState, PicturePart, PictureRequest};
use super::frozen::Origin;
use crate::Strip;
use crate::explain::trail;
use std::sync::Arc;
use stickslip_core::{Event, State, Status, Stepper};
use stickslip_scene::Scene;

/// Records of a run so far.
pub struct RunHistory<'a> {
    strips: Vec<Strip>,
    last_major: State,
    /// The last minor iterations, oldest first, if a picture shows them.
    events: Vec<Arc<Event>>,
    /// Load factor and monitors at the start and the accepted increments, if a picture shows them.
    accepted: Vec<(f64, Vec<f64>)>,
    parts: &'a [PicturePart],
}

impl<'a> RunHistory<'a> {
    /// The history of a run that starts now; `parts` are the parts of pictures that it must provide.
    pub fn at_start(stepper: &mut Stepper, parts: &'a [PicturePart]) -> RunHistory<'a> {
        let mut accepted = Vec::new();
        if parts.contains(&PicturePart::Chart) {
            let mut monitors = Vec::new();
            stepper.monitors(&mut monitors);
            accepted.push((stepper.state().start.load_factor, monitors));
        }
        let state = stepper.state();
        RunHistory {
            strips: vec![Strip::new(stepper.model(), state, None, None, 0.0)],
            last_major: state.clone(),
            events: Vec::new(),
            accepted,
            parts,
        }
    }

    /// Adds the last minor iteration.
    pub fn add(&mut self, stepper: &mut Stepper) {
        if self.parts.contains(&PicturePart::Cone) {
            self.events.push(Arc::new(stepper.event().clone()));
            let more = self.events.len().saturating_sub(trail::LONGEST);
            self.events.drain(..more);
        }
        let accepts = stepper.event().outcome.is_accepted();
        if self.parts.contains(&PicturePart::Chart) && accepts {
            let mut monitors = Vec::new();
            stepper.monitors(&mut monitors);
            self.accepted.push((stepper.event().load_factor, monitors));
        }
        let (state, event) = (stepper.state(), stepper.event());
        let strip = Strip::new(stepper.model(), state, Some(event), self.strips.last(), 0.0);
        self.strips.push(strip);
        // A timeline shows only the last steps; their total is needed only if it is small.
        if self.strips.len() > 64 * COLUMNS {
            self.strips.drain(..32 * COLUMNS);
        }
        if state.next.minor == 1 && state.status == Status::Running {
            self.last_major = state.clone();
        }
    }

    /// Whether the run has a minor iteration.
    pub fn has_started(&self) -> bool {
        self.strips.len() > 1
    }

    /// A state of the run with this history, to be exported.
    pub fn shown<'s>(
        &'s self,
        scene: &'s Scene,
        origin: &'s Origin,
        (state, event): (&'s State, Option<&'s Event>),
        picture: &'s PictureRequest,
    ) -> ExportState<'s> {
        ExportState {
            scene,
            origin,
            state,
            event,
            strips: &self.strips,
            last_major: Some(&self.last_major),
            frozen: false,
            picture,
            events: &self.events,
            accepted: &self.accepted,
        }
    }
}
