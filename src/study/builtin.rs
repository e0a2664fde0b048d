//! The built-in studies.

use stickslip_scene::EmbeddedFile;
use stickslip_scene::embedded;
use stickslip_scene::embedded_all;

/// In the order in which they are listed.
static STUDIES: &[EmbeddedFile] = embedded_all![
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

/// All built-in studies, in the order in which they are listed.
pub fn list() -> &'static [EmbeddedFile] {
    STUDIES
}

/// The built-in study with this name, with or without `.ron`.
pub fn find(name: &str) -> Option<&'static EmbeddedFile> {
    embedded::find(STUDIES, name)
}
