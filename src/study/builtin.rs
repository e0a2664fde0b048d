//! The studies that the program carries inside itself.

use stickslip_scene::embedded::EmbeddedFile;
use stickslip_scene::embedded_all;

/// In the order in which they are offered.
const STUDIES: &[EmbeddedFile] = embedded_all![
    "../../problems/studies/",
    ".ron",
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
pub fn list() -> &'static [EmbeddedFile] {
    STUDIES
}

/// The built-in study with a name, with or without the ending `.ron`.
pub fn find(name: &str) -> Option<&'static EmbeddedFile> {
    let name = name.strip_suffix(".ron").unwrap_or(name);
    STUDIES.iter().find(|study| study.name == name)
}
