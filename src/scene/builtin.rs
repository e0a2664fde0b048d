//! The built-in scenes.

use crate::EmbeddedFile;
use crate::embedded;

/// A scene by its name and its folder below `problems`.
macro_rules! scenes {
    ($($folder:literal: $($name:literal),+;)+) => {
        &[$($(embedded!($name, "../../problems/", $folder, $name, ".ron")),+),+]
    };
}

/// In display order.
static SCENES: &[EmbeddedFile] = scenes![
    "":
    "01-pinned-beam-rough-floor",
    "02-two-cantilevers-smooth",
    "02-two-cantilevers-rough",
    "03-distant-cantilevers",
    "04-cantilever-rigid-circle",
    "05-cantilever-elastic-block",
    "05-cantilever-elastic-block-swapped",
    "hertz-cylinder-on-block",
    "osc-inclined-cantilever",
    "osc-touch2",
    "osc-lag4",
    "osc-zig3",
    "osc-slowlag",
    "osc-two3",
    "osc-two6",
    "osc-two-many",
    "osc-three10",
    "osc-coh-none",
    "osc-sgn0",
    "osc-drag65",
    "osc-valley",
    "osc-border",
    "osc-big-step",
    "osc-off-end",
    "osc-snap",
    "osc-block-free",
    "osc-block-slide",
    "osc-p5-slow";
    "benchmarks/":
    "bench-wedge",
    "bench-pad",
    "bench-belt",
    "bench-ssnv128",
    "bench-patch",
    "bench-punch",
    "bench-hertz-plane",
    "bench-hertz-ball",
    "bench-mindlin",
    "bench-press-fit";
];

/// All built-in scenes, in display order.
pub fn list() -> &'static [EmbeddedFile] {
    SCENES
}

/// The built-in scene with a name, with or without the extension `.ron`.
pub fn find(name: &str) -> Option<&'static EmbeddedFile> {
    embedded::find(SCENES, name)
}

/// One-line description of a built-in scene: its title.
///
/// Empty for a scene that cannot be read; the tests detect that bug.
pub fn title(scene: &EmbeddedFile) -> String {
    crate::format::read::spec(scene.name, scene.text)
        .map(|spec| spec.title)
        .unwrap_or_default()
}
