//! The studies that the program carries inside itself.

/// A built-in study: its name, and the text of its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Builtin {
    /// What the command line calls it: the file's name without its ending.
    pub name: &'static str,
    /// The file.
    pub text: &'static str,
}

macro_rules! studies {
    ($($name:literal),* $(,)?) => {
        &[$(Builtin {
            name: $name,
            text: include_str!(concat!("../../problems/studies/", $name, ".ron")),
        }),*]
    };
}

/// In the order in which they are offered.
const STUDIES: &[Builtin] = studies![
    "fig-08-increment",
    "fig-09-majors",
    "fig-10-minors",
    "fig-11-roles",
    "geometry-01",
    "geometry-02",
    "limit-point-02",
    "residual-methods",
    "t-max-friction",
    "t-max-osc",
];

/// All built-in studies, in the order in which they are offered.
pub fn list() -> &'static [Builtin] {
    STUDIES
}

/// The built-in study with a name, with or without the ending `.ron`.
pub fn find(name: &str) -> Option<&'static Builtin> {
    let name = name.strip_suffix(".ron").unwrap_or(name);
    STUDIES.iter().find(|study| study.name == name)
}
