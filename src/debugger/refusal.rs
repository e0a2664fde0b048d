//! The error of the debugger.

use std::fmt::Display;
use stickslip_core::SolverLost;
use stickslip_manual::NoPage;
use stickslip_platform::files::FileError;
use stickslip_scene::SceneError;
use stickslip_scene::format::error::SetError;
use stickslip_study::drawn::PlotError;

/// Why something is not done, for the user, with a hint at what would work.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct Refusal(String);

impl Refusal {
    /// With a text, or that of another error.
    pub fn new(why: impl Display) -> Refusal {
        Refusal(why.to_string())
    }

    /// A word that is not valid for its kind; `instead` says what is expected.
    pub(crate) fn no_value(word: &str, kind: &str, instead: impl Display) -> Refusal {
        refusal!("invalid {kind} '{word}'; {instead}")
    }

    /// An invalid mode.
    pub(crate) fn no_mode(word: &str) -> Refusal {
        Refusal::no_value(word, "mode", "expected free, sliding or fixed")
    }
}

/// A [`Refusal`] with a formatted text.
macro_rules! refusal {
    ($($text:tt)*) => {
        $crate::refusal::Refusal::new(format_args!($($text)*))
    };
}

/// Converts other errors by their texts.
macro_rules! refused_by {
    ($($error:ty),*) => {
        $(impl From<$error> for $crate::refusal::Refusal {
            fn from(error: $error) -> Self {
                Self::new(error)
            }
        })*
    };
}

pub(crate) use {refusal, refused_by};

refused_by!(
    FileError, NoPage, PlotError, SceneError, SetError, SolverLost
);
