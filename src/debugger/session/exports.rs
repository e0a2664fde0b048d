//! Files made from a state in the background: pictures, the frozen problem, the core of its cycle ([`export`]).

use crate::explain::core::core;
use crate::explain::diagnosis::too_many;
use crate::explain::examination::{NOT_CONDENSED, going_round};
use crate::explain::interface_scene;
use crate::record::export::export_state::FINISHED;
use crate::record::export::export_state::IN_SPACE;
use crate::record::export::export_state::OF_JOURNAL;
use crate::record::export::export_state::{ExportState, PictureRequest};
use crate::record::export::{self, ExportKind, Origin};
use crate::refusal::{Refusal, refusal};
use crate::{ExportScope, Strip};
use std::path::PathBuf;
use std::sync::Arc;
use stickslip_core::{Event, Model, ReportedProblem, State, Status, Stepper};
use stickslip_platform::files;
use stickslip_scene::Scene;

/// Request for a file made from a state.
pub struct Export {
    /// What to write.
    pub what: ExportScope,
    /// Destination.
    pub file: PathBuf,
    /// Whether an existing file may be overwritten.
    pub overwrite: bool,
    /// Where the problem comes from, as noted in the file.
    pub origin: Origin,
    /// The shown state.
    pub state: Box<State>,
    /// Further contents of a picture.
    pub shown: Option<Box<PictureContext>>,
}

/// The context of a state that a picture shows.
pub struct PictureContext {
    /// The scene of the run.
    pub scene: Scene,
    /// The last minor iteration.
    pub event: Option<Arc<Event>>,
    /// The latest strips, oldest first.
    pub strips: Vec<Strip>,
    /// The state at the start of the last major iteration, if known.
    pub last_major: Option<State>,
}

/// Writes the requested file.
pub(super) fn write(stepper: &mut Stepper, ask: &Export) -> Result<(), Refusal> {
    let bytes = match ask.what {
        ExportScope::Core => {
            let text = core_of(stepper, &ask.state, &ask.origin)?;
            return Ok(files::write(&ask.file, text, ask.overwrite)?);
        }
        ExportScope::Whole => shown(stepper, ask, export::frozen_kind(&ask.file)?)?,
        ExportScope::Shown => shown(stepper, ask, export::kind(&ask.file)?)?,
    };
    let kind = export::kind(&ask.file).ok();
    let names = match kind.filter(|_| bytes.len() > 1) {
        Some(kind) => kind.files(&ask.file).map_err(Refusal::new)?,
        None => vec![ask.file.clone()],
    };
    let whole: Vec<_> = names.into_iter().zip(bytes).collect();
    Ok(files::write_all(&whole, ask.overwrite)?)
}

/// The scene with the core of the cycle that a state runs into.
fn core_of(stepper: &mut Stepper, state: &State, origin: &Origin) -> Result<String, Refusal> {
    if state.status == Status::Finished {
        return Err(Refusal::new(FINISHED));
    }
    stepper.restore(state);
    let problem = stepper
        .interface_problem()
        .ok_or_else(|| Refusal::new(NOT_CONDENSED))?;
    let (problem, cycle) = going_round(stepper, state, &problem)?.ok_or_else(|| {
        refusal!("the minor iterations do not cycle from here, so there is no core")
    })?;
    let core = core(&problem).ok_or_else(|| Refusal::new(too_many(&cycle)))?;
    export::core(stepper.model(), origin, &cycle, &core)
}

/// The contents of a file of this kind.
fn shown(stepper: &mut Stepper, ask: &Export, kind: &ExportKind) -> Result<Vec<Vec<u8>>, Refusal> {
    let Some(seen) = &ask.shown else {
        return Err(Refusal::new(FINISHED));
    };
    let shown = ExportState {
        scene: &seen.scene,
        origin: &ask.origin,
        state: &ask.state,
        event: seen.event.as_deref(),
        strips: &seen.strips,
        last_major: seen.last_major.as_ref(),
        frozen: ask.what == ExportScope::Whole,
        picture: &PictureRequest::default(),
        events: &[],
        accepted: &[],
    };
    kind.made(&shown, stepper)
        .ok_or_else(|| Refusal::new(OF_JOURNAL))?
}

/// The scene with the core of the cycle of an interface problem that an attached solver reports.
///
/// # Errors
/// If there is no core, or it cannot be written.
pub fn core_of_reported(
    model: &Model,
    state: &State,
    posed: &ReportedProblem,
    origin: &Origin,
) -> Result<String, Refusal> {
    if posed.tangents == 2 {
        return Err(Refusal::new(IN_SPACE));
    }
    let problem = interface_scene::problem(model, state, posed);
    let (_, mut stepper) = interface_scene::stepper(problem)?;
    let start = stepper.state().clone();
    core_of(&mut stepper, &start, origin)
}

/// Writes the interface problem that an attached solver reports, or its core, possibly in another program's
/// format.
///
/// # Errors
/// If it cannot be written.
pub fn write_posed(model: &Model, posed: &ReportedProblem, ask: &Export) -> Result<(), Refusal> {
    if posed.tangents == 2 {
        return Err(Refusal::new(IN_SPACE));
    }
    let text = match ask.what {
        ExportScope::Core => core_of_reported(model, &ask.state, posed, &ask.origin)?,
        _ if export::frozen_kind(&ask.file)?.extension != "ron" => {
            let problem = interface_scene::problem(model, &ask.state, posed);
            let (scene, mut stepper) = interface_scene::stepper(problem)?;
            let shown = PictureContext {
                scene,
                event: None,
                strips: Vec::new(),
                last_major: None,
            };
            let of_problem = Export {
                shown: Some(Box::new(shown)),
                state: Box::new(stepper.state().clone()),
                origin: ask.origin.clone(),
                file: ask.file.clone(),
                ..*ask
            };
            return write(&mut stepper, &of_problem);
        }
        _ => interface_scene::problem(model, &ask.state, posed).text(&[ask.origin.words()]),
    };
    Ok(files::write(&ask.file, text, ask.overwrite)?)
}

/// Whether the file is made from the frozen interface problem.
pub(super) fn is_of_problem(ask: &Export) -> bool {
    let kind = export::kind(&ask.file);
    ask.what != ExportScope::Shown
        || kind.is_ok_and(|kind| kind.may_be_frozen && kind.extension != "ron")
}
