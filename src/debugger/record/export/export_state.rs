//! The input of an export: a state and its context.

use super::frozen::Origin;
use crate::Strip;
use crate::explain::examination::NOT_CONDENSED;
use crate::refusal::Refusal;
use std::sync::Arc;
use stickslip_core::{Event, InterfaceProblem, State, Status, Stepper};
use stickslip_scene::Scene;

/// Number of minor iterations in the timeline of a whole picture.
pub const COLUMNS: usize = 60;

/// Why nothing is exported after the end of the history.
pub const FINISHED: &str = "the history is complete, so there is no next problem to export";
/// Why a problem in space is not exported.
pub const IN_SPACE: &str = "interface problems in space cannot be exported";
/// Why no film is exported from a state.
pub const OF_JOURNAL: &str = ".cast files are made from a journal: stickslip export JOURNAL -o FILE. :journal shows its path";

/// A state and its context.
pub struct ExportState<'a> {
    /// The scene of the run.
    pub scene: &'a Scene,
    /// The position of the state, and earlier changes.
    pub origin: &'a Origin,
    /// The state.
    pub state: &'a State,
    /// The last minor iteration; `None` at the start.
    pub event: Option<&'a Event>,
    /// The strips up to this state, at least the last [`COLUMNS`].
    pub strips: &'a [Strip],
    /// The state at the start of the last major iteration; at the end of the history, its problem is exported.
    pub last_major: Option<&'a State>,
    /// Whether the frozen problem is requested, for kinds that offer a choice.
    pub frozen: bool,
    /// What a picture contains, and its size.
    pub picture: &'a PictureRequest,
    /// The last minor iterations, oldest first, for the cone.
    pub events: &'a [Arc<Event>],
    /// Load factor and monitors at the start and the accepted increments, for the chart.
    pub accepted: &'a [(f64, Vec<f64>)],
}

stickslip_core::words! {
    /// A part of a picture.
    pub enum PicturePart, ALL, word {
        /// The deformed shape.
        Shape "shape",
        /// The modes by minor iteration.
        Timeline "timeline",
        /// The load over a monitor.
        Chart "chart",
        /// The force of a contact in its friction cone, and T_max by iteration.
        Cone "cone",
    }
}

/// What a picture contains, and its size.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PictureRequest {
    /// The only part; `None` for shape, table and timeline.
    pub only: Option<PicturePart>,
    /// Width and height in pixels; `None` for the natural size.
    pub size: Option<(u32, u32)>,
    /// Height of the small text, in pixels.
    pub font: Option<f64>,
    /// The slave node of the cone; `None` for the one with the largest force.
    pub node: Option<usize>,
    /// The monitor of the chart; `None` for the first that moves.
    pub monitor: Option<usize>,
}

/// The frozen interface problem of a state, and the state it belongs to: the problem to be solved next or, at
/// the end of the history, the last one solved.
pub(super) fn problem<'a>(
    shown: &ExportState<'a>,
    stepper: &mut Stepper,
) -> Result<(InterfaceProblem, &'a State), Refusal> {
    let state = match (&shown.state.status, shown.last_major) {
        (Status::Finished, None) => {
            return Err(Refusal::new(FINISHED));
        }
        (Status::Finished, Some(last)) => last,
        _ => shown.state,
    };
    stepper.restore(state);
    let problem = stepper
        .interface_problem()
        .ok_or_else(|| Refusal::new(NOT_CONDENSED))?;
    Ok((problem, state))
}
