//! Texts that the program carries inside itself, compressed by `build.rs`: scenes, studies, lessons, tables, the manual.

use std::fmt;

/// A file of the source tree, by its path there without its ending: `carried!(name, "problems/", "osc-snap", ".ron")`.
macro_rules! carried {
    ($name:expr, $($part:expr),+) => {
        $crate::outside::carried::Carried::new(
            $name,
            include_bytes!(concat!(env!("OUT_DIR"), "/carried/", $($part),+)),
        )
    };
}
pub(crate) use carried;

/// Files of a folder, by their names without the ending.
macro_rules! carried_all {
    ($folder:literal, $ending:literal, $($name:literal),+ $(,)?) => {
        &[$($crate::outside::carried::carried!($name, $folder, $name, $ending)),+]
    };
}
pub(crate) use carried_all;

/// A file that the program carries.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Carried {
    /// What the command line calls it: the file's name without its ending.
    pub name: &'static str,
    packed: &'static [u8],
}

impl Carried {
    /// With its name, and its text as UTF-8, deflated.
    pub const fn new(name: &'static str, packed: &'static [u8]) -> Carried {
        Carried { name, packed }
    }

    /// The file. What cannot be unpacked would be a bug that the tests find; it is empty then.
    pub fn text(&self) -> String {
        let bytes = miniz_oxide::inflate::decompress_to_vec(self.packed);
        let text = bytes.ok().and_then(|bytes| String::from_utf8(bytes).ok());
        text.unwrap_or_default()
    }
}

impl fmt::Debug for Carried {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Carried").field(&self.name).finish()
    }
}
