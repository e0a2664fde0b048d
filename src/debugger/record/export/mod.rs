//! Files made from a state, with the kind chosen by the extension. [`KINDS`] lists the kinds; each has a
//! module.
//!
//! - [`frozen`]: the core of a cycle or the whole frozen problem, as a scene or in Siconos format.
//! - [`picture`]: the deformed shape with modes, forces and gaps, and the timeline, as SVG and PNG.
//! - [`written`]: the scene itself, and the frozen problem in other programs' formats; [`skeleton`]: a scene
//!   around a mesh.
//! - [`grid`]: a state for ParaView.
//! - [`export_state`]: the input of all of them; [`run_history`]: what pictures show of a run besides its last state.
//!
//! The film of a session is made from a journal by the terminal front end; the list only contains its
//! extension.

pub mod export_state;
pub mod frozen;
pub mod grid;
pub mod picture;
pub mod run_history;
pub mod skeleton;
pub mod written;

mod chart;
mod conditions;
mod pressures;
mod timeline;
mod window;

use self::ExportSource::{Journal, Parts, State};
use crate::refusal::{Refusal, refusal};
use export_state::ExportState;
use std::path::{Path, PathBuf};
use stickslip_core::Stepper;
use stickslip_scene::joined;
use stickslip_scene::problems::market;

pub use frozen::{Origin, compared, core, whole, writable};

/// Function that returns the contents of several files made from a state.
type MakeParts = fn(&ExportState, &mut Stepper) -> Result<Vec<Vec<u8>>, Refusal>;

/// What a kind of file is made from.
#[derive(Clone, Copy)]
pub enum ExportSource {
    /// A state. The stepper belongs to the same model and may be in any state.
    State(fn(&ExportState, &mut Stepper) -> Result<Vec<u8>, Refusal>),
    /// A state, in several files: those of [`ExportKind::files`].
    Parts(MakeParts),
    /// A whole session.
    Journal,
}

/// A kind of file.
pub struct ExportKind {
    /// Extension without the dot.
    pub extension: &'static str,
    /// Contents, for messages and the manual.
    pub what: &'static str,
    /// Whether it can contain either the scene or its frozen problem. The latter must be requested.
    pub may_be_frozen: bool,
    /// What it is made from, and the function that makes it.
    pub made_of: ExportSource,
}

impl ExportKind {
    /// The names of the files for a requested file, that one first.
    ///
    /// # Errors
    /// If the name is not suitable.
    pub fn files(&self, file: &Path) -> Result<Vec<PathBuf>, String> {
        match self.made_of {
            Parts(_) => Ok(market::parts(file)?.into()),
            State(_) | Journal => Ok(vec![file.to_owned()]),
        }
    }

    /// The contents of these files; `None` if they are not made from a state.
    ///
    /// # Errors
    /// If they cannot be made.
    pub fn made(
        &self,
        shown: &ExportState,
        stepper: &mut Stepper,
    ) -> Option<Result<Vec<Vec<u8>>, Refusal>> {
        match self.made_of {
            State(make) => Some(make(shown, stepper).map(|bytes| vec![bytes])),
            Parts(make) => Some(make(shown, stepper)),
            Journal => None,
        }
    }
}

const fn kind_of(
    extension: &'static str,
    what: &'static str,
    may_be_frozen: bool,
    made_of: ExportSource,
) -> ExportKind {
    ExportKind {
        extension,
        what,
        may_be_frozen,
        made_of,
    }
}

/// All kinds of files.
pub const KINDS: &[ExportKind] = &[
    kind_of("svg", "a picture of the state", false, State(picture::svg)),
    kind_of("png", "the picture as a bitmap", false, State(picture::png)),
    kind_of(
        "ron",
        "the scene, or its frozen interface problem",
        true,
        State(written::ron),
    ),
    kind_of(
        "dat",
        "the frozen interface problem for Siconos",
        true,
        State(written::dat),
    ),
    kind_of(
        "mtx",
        "the frozen problem as three Matrix Market files",
        true,
        Parts(written::mtx),
    ),
    kind_of(
        "h5",
        "the frozen problem for fclib",
        true,
        State(written::h5),
    ),
    kind_of("vtu", "the state for ParaView", false, State(grid::vtu)),
    kind_of("cast", "a journal as a film for asciinema", false, Journal),
];

/// The kind of a file, by its extension.
///
/// # Errors
/// If the extension is unknown; the message lists all kinds.
pub fn kind(file: &Path) -> Result<&'static ExportKind, Refusal> {
    let own = file.extension().unwrap_or_default();
    let found = KINDS
        .iter()
        .find(|kind| own.eq_ignore_ascii_case(kind.extension));
    found.ok_or_else(|| {
        let known = joined(
            KINDS
                .iter()
                .map(|k| format!(".{} ({})", k.extension, k.what)),
            ", ",
        );
        let file = file.display();
        refusal!("{file}: unknown file kind; available: {known}")
    })
}

/// The kind of a file of the frozen problem.
///
/// # Errors
/// If the extension is unknown, or belongs to another kind.
pub fn frozen_kind(file: &Path) -> Result<&'static ExportKind, Refusal> {
    let kind = kind(file)?;
    if kind.may_be_frozen {
        return Ok(kind);
    }
    Err(refusal!(
        "--frozen cannot be used with .{}; use .ron, .dat, .mtx or .h5",
        kind.extension
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_is_chosen_by_its_extension_and_the_error_lists_all() {
        assert_eq!(kind(Path::new("a/b.SVG")).unwrap().extension, "svg");
        for wrong in ["a.bmp", "svg", "a.", "-"] {
            let why = kind(Path::new(wrong)).err().unwrap().to_string();
            for kind in KINDS {
                assert!(why.contains(&format!(".{} ", kind.extension)), "{why}");
            }
        }
    }
}
