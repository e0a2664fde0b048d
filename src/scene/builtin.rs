//! The scenes that the program carries inside itself.

/// A built-in scene: its name, and the text of its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Builtin {
    /// What the command line calls it: the file's name without its ending.
    pub name: &'static str,
    /// The file.
    pub text: &'static str,
}

/// A scene by its name, and its folder below `problems`.
macro_rules! scenes {
    ($($folder:literal: $($name:literal),+;)+) => {
        &[$($(Builtin {
            name: $name,
            text: include_str!(concat!("../../problems/", $folder, $name, ".ron")),
        }),+),+]
    };
}

/// In the order in which they are offered.
const SCENES: &[Builtin] = scenes![
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

/// All built-in scenes, in the order in which they are offered.
pub fn list() -> &'static [Builtin] {
    SCENES
}

/// The built-in scene with a name, with or without the ending `.ron`.
pub fn find(name: &str) -> Option<&'static Builtin> {
    let name = name.strip_suffix(".ron").unwrap_or(name);
    SCENES.iter().find(|scene| scene.name == name)
}

impl Builtin {
    /// One line that says what the scene is: its title.
    ///
    /// A built-in scene that cannot be read is a bug that the tests find; its description is empty then.
    pub fn title(&self) -> String {
        crate::format::read::spec(self.name, self.text)
            .map(|spec| spec.title)
            .unwrap_or_default()
    }
}
