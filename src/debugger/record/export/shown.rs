//! What files are made of: a state, and what there is to tell of it.

use super::frozen::{NoExport, Origin};
use crate::explain::examination::Untold;
use crate::history::strip::Strip;
use stickslip_core::interface::problem::InterfaceProblem;
use stickslip_core::step::event::Event;
use stickslip_core::step::solver::Lost;
use stickslip_core::step::state::{State, Status};
use stickslip_core::step::stepper::Stepper;
use stickslip_platform::files::FileError;
use stickslip_scene::Scene;
use stickslip_scene::format::SceneError;
use stickslip_study::drawn::PlotError;

/// Minor iterations that a picture's timeline shows.
pub const COLUMNS: usize = 60;

/// A state, and what there is to tell of it.
pub struct Shown<'a> {
    /// The scene that led there.
    pub scene: &'a Scene,
    /// Where it is, and what was changed before.
    pub origin: &'a Origin,
    /// The state.
    pub state: &'a State,
    /// The last minor iteration; `None` at the start.
    pub event: Option<&'a Event>,
    /// The minor iterations before and with it, the last ones at least ([`COLUMNS`]).
    pub strips: &'a [Strip],
    /// The state in which the last major iteration began; where the history is done, its problem is the one to be frozen.
    pub last_major: Option<&'a State>,
    /// How it ended, in words, where it did not go well; else empty.
    pub ended: String,
    /// Whether the frozen problem is wanted, where the kind leaves a choice.
    pub frozen: bool,
}

/// Why a file was not made.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// It cannot be drawn.
    #[error(transparent)]
    Drawn(#[from] PlotError),
    /// The history is done, and nothing is known of its last problem.
    #[error("the history is done; nothing is solved next from here")]
    Finished,
    /// The minor iterations do not cycle here.
    #[error("the minor iterations do not cycle from here, so there is no core")]
    NoCycle,
    /// There is no interface problem, or too many nodes take part.
    #[error(transparent)]
    Untold(#[from] Untold),
    /// No file can say what the problem says.
    #[error(transparent)]
    NoExport(#[from] NoExport),
    /// No kind of file has this extension, or room for it.
    #[error("{0}")]
    NoFile(String),
    /// The interface problem that an attached solver tells is unsound.
    #[error(transparent)]
    Unsound(#[from] Box<SceneError>),
    /// An attached solver does not tell what is to be written.
    #[error(transparent)]
    Lost(#[from] Lost),
    /// The kind is made of a journal.
    #[error(
        "a .cast is made of a journal; `stickslip export JOURNAL -o FILE` does it, and :journal tells where it is"
    )]
    OfJournal,
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}

/// The interface problem that is frozen at a state: the one that is solved next, or, where nothing is, the one that was
/// solved last; with the state that it is of.
pub(super) fn problem<'a>(
    shown: &Shown<'a>,
    stepper: &mut Stepper,
) -> Result<(InterfaceProblem, &'a State), ExportError> {
    let state = match (&shown.state.status, shown.last_major) {
        (Status::Finished, None) => return Err(ExportError::Finished),
        (Status::Finished, Some(last)) => last,
        _ => shown.state,
    };
    stepper.restore(state);
    let problem = stepper.interface_problem().ok_or(Untold::NotCondensed)?;
    Ok((problem, state))
}
