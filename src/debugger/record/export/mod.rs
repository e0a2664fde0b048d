//! Files made of a state, the kind by the extension: one list, [`KINDS`], and one file a kind.
//!
//! - [`frozen`]: the core of a cycle, or the whole frozen problem, as a scene, or in the form of Siconos.
//! - [`picture`]: the deformed shape with modes, forces and gaps, and the timeline, as SVG and PNG.
//! - [`written`]: the scene itself, and the frozen problem in the forms of other programs; [`skeleton`]: a scene around a mesh.
//! - [`grid`]: a state as ParaView shows it.
//! - [`shown`]: what all of them are made of.
//!
//! A session as a film is made of a journal by who draws screens; the list has its name.

pub mod frozen;
pub mod grid;
pub mod picture;
pub mod shown;
pub mod skeleton;
pub mod written;

mod pressures;
mod timeline;
mod window;

use shown::{ExportError, Shown};
use std::path::{Path, PathBuf};
use stickslip_core::step::stepper::Stepper;
use stickslip_scene::problems::market;

pub use frozen::{NoExport, Origin, Parted, compared, core, whole, writable};

/// The bytes of several files of a state.
type MakeParts = fn(&Shown, &mut Stepper) -> Result<Vec<Vec<u8>>, ExportError>;

/// What a kind of file is made of.
#[derive(Clone, Copy)]
pub enum MadeOf {
    /// A state; the stepper is of the same model, and may be left anywhere.
    State(fn(&Shown, &mut Stepper) -> Result<Vec<u8>, ExportError>),
    /// A state too, in several files: those that [`Kind::files`] names.
    Parts(MakeParts),
    /// A whole session.
    Journal,
}

/// A kind of file.
pub struct Kind {
    /// How names of such files end, without the dot.
    pub extension: &'static str,
    /// What is in it, for messages and the manual.
    pub what: &'static str,
    /// Whether it can hold the scene and the frozen problem, and who wants the latter must say so.
    pub may_be_frozen: bool,
    /// What it is made of, and by whom.
    pub made_of: MadeOf,
}

impl Kind {
    /// The files that are made where one of this kind is asked for, that one first.
    ///
    /// # Errors
    /// If the name will not do.
    pub fn files(&self, file: &Path) -> Result<Vec<PathBuf>, String> {
        match self.made_of {
            MadeOf::Parts(_) => Ok(market::parts(file)?.into()),
            MadeOf::State(_) | MadeOf::Journal => Ok(vec![file.to_owned()]),
        }
    }

    /// What is in these files, of a state; `None` where they are made of something else.
    ///
    /// # Errors
    /// Why they cannot be made.
    pub fn made(
        &self,
        shown: &Shown,
        stepper: &mut Stepper,
    ) -> Option<Result<Vec<Vec<u8>>, ExportError>> {
        match self.made_of {
            MadeOf::State(make) => Some(make(shown, stepper).map(|bytes| vec![bytes])),
            MadeOf::Parts(make) => Some(make(shown, stepper)),
            MadeOf::Journal => None,
        }
    }
}

/// Every kind that there is.
pub const KINDS: &[Kind] = &[
    Kind {
        extension: "svg",
        what: "the picture of a state",
        may_be_frozen: false,
        made_of: MadeOf::State(picture::svg),
    },
    Kind {
        extension: "png",
        what: "the same as a bitmap",
        may_be_frozen: false,
        made_of: MadeOf::State(picture::png),
    },
    Kind {
        extension: "ron",
        what: "the scene, or its frozen interface problem",
        may_be_frozen: true,
        made_of: MadeOf::State(written::ron),
    },
    Kind {
        extension: "dat",
        what: "the frozen interface problem for Siconos",
        may_be_frozen: true,
        made_of: MadeOf::State(written::dat),
    },
    Kind {
        extension: "mtx",
        what: "the same as matrices of the Matrix Market, in three files",
        may_be_frozen: true,
        made_of: MadeOf::Parts(written::mtx),
    },
    Kind {
        extension: "h5",
        what: "the same for fclib",
        may_be_frozen: true,
        made_of: MadeOf::State(written::h5),
    },
    Kind {
        extension: "vtu",
        what: "the state for ParaView",
        may_be_frozen: false,
        made_of: MadeOf::State(grid::vtu),
    },
    Kind {
        extension: "cast",
        what: "a journal as a film for asciinema",
        may_be_frozen: false,
        made_of: MadeOf::Journal,
    },
];

/// The kind that the name of a file asks for.
///
/// # Errors
/// If it ends as none of them does; the message lists them all.
pub fn kind(file: &Path) -> Result<&'static Kind, ExportError> {
    let own = file.extension().unwrap_or_default();
    let found = KINDS
        .iter()
        .find(|kind| own.eq_ignore_ascii_case(kind.extension));
    found.ok_or_else(|| {
        let known = KINDS
            .iter()
            .map(|k| format!(".{} ({})", k.extension, k.what));
        let known = known.collect::<Vec<_>>().join(", ");
        let file = file.display();
        ExportError::NoFile(format!(
            "{file}: no file of that kind is made; these are: {known}"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_is_known_by_its_extension_and_the_message_lists_all() {
        assert_eq!(kind(Path::new("a/b.SVG")).unwrap().extension, "svg");
        for wrong in ["a.bmp", "svg", "a.", "-"] {
            let why = kind(Path::new(wrong)).err().unwrap().to_string();
            for kind in KINDS {
                assert!(why.contains(&format!(".{} ", kind.extension)), "{why}");
            }
        }
    }
}
