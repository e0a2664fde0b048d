//! How the files of this program are written: RON in which `Some` may be left out.

use ron::extensions::Extensions;

/// How scene files are read and written: `Some` may be left out.
pub fn options() -> ron::Options {
    // The recursion limit is ron's own (128), spelled out because the stack depends on it.
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_recursion_limit(128)
}
