//! Files embedded in the program: scenes, studies, lessons, tables, manual pages.

/// A file of the source tree that is compiled into the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EmbeddedFile {
    /// The name users give on the command line: the file name without its extension.
    pub name: &'static str,
    /// The contents.
    pub text: &'static str,
}

/// The file with a name, with or without the extension `.ron`.
pub fn find(files: &'static [EmbeddedFile], name: &str) -> Option<&'static EmbeddedFile> {
    let name = name.strip_suffix(".ron").unwrap_or(name);
    files.iter().find(|file| file.name == name)
}

/// An [`EmbeddedFile`](crate::embedded::EmbeddedFile): its name, then its path, relative to the folder of the package, in parts.
#[macro_export]
macro_rules! embedded {
    ($name:expr, $($part:expr),+) => {
        $crate::embedded::EmbeddedFile {
            name: $name,
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/", $($part),+)),
        }
    };
}

/// Files of one folder with the same extension: folder, extension, names.
#[macro_export]
macro_rules! embedded_all {
    ($folder:literal, $extension:literal, $($name:literal),+ $(,)?) => {
        &[$($crate::embedded!($name, $folder, $name, $extension)),+]
    };
}
