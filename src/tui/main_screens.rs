//! The main screens of the debugger, each as a scene and the keys that lead to it. Tests compare them with stored ones, and
//! `stickslip screens` draws them as pictures.

/// A screen of the debugger.
#[derive(Debug, Clone, Copy)]
pub struct MainScreen<'a> {
    /// Its name.
    pub name: &'a str,
    /// The scene; `None` for the chooser.
    pub scene: Option<&'a str>,
    /// The keys to press ([`crate::keys::presses`]).
    pub keys: &'a str,
}

/// Widths and heights of the terminals that the screens are made for.
pub const SIZES: [(u16, u16); 3] = [(80, 24), (120, 40), (200, 60)];

const BEAM: Option<&str> = Some("01-pinned-beam-rough-floor");
const COLUMN: Option<&str> = Some("02-two-cantilevers-rough");
const CIRCLE: Option<&str> = Some("04-cantilever-rigid-circle");
const BLOCK: Option<&str> = Some("05-cantilever-elastic-block");
const CYCLE: Option<&str> = Some("osc-two6");

/// The screens, in the order of a first session.
#[rustfmt::skip]
pub const MAIN_SCREENS: [MainScreen<'static>; 30] = [
    screen("chooser", None, ""),
    screen("chooser-search", None, "c y l i n d e r"),
    screen("lesson-first", None, "Enter"),
    screen("lesson-question", BEAM, ":lesson oscillation@3 Enter"),
    screen("lesson-task", BEAM, ":lesson cure@2 Enter"),
    screen("start", BEAM, ""),
    screen("step", BEAM, "s"),
    screen("increment", BEAM, "f"),
    screen("explain", BEAM, "2 f s e"),
    screen("predict", BEAM, "p s"),
    screen("force-mode", BEAM, "s m"),
    screen("many-nodes", CIRCLE, "300 f"),
    screen("filter-active", CIRCLE, "300 f A"),
    screen("find-node", CIRCLE, "f /beam.14 Enter"),
    screen("shape", COLUMN, "20 f Tab Tab Tab z"),
    screen("shape-enlarged", BLOCK, "15 f Tab Tab Tab z + +"),
    screen("residual", BLOCK, "3 f Tab Tab z"),
    screen("load-curve", COLUMN, "30 f Tab Tab Tab Tab z"),
    screen("solid", Some("bench-ssnv128"), "f"),
    screen("timeline", CYCLE, "c t"),
    screen("contact", CYCLE, "c E"),
    screen("cycle", CYCLE, "c"),
    screen("diagnosis", CYCLE, "c d"),
    screen("remedies", CYCLE, "c r"),
    screen("branches", CYCLE, "c r Enter v v Up"),
    screen("free-body", Some("osc-block-free"), "c d"),
    screen("breakpoints", BEAM, ":break cycle Enter :break at 3 Enter :breakpoints Enter"),
    screen("command-line", BEAM, ":so Tab"),
    screen("help", BEAM, "?"),
    screen("manual", BEAM, ":help theory Enter"),
];

const fn screen(
    name: &'static str,
    scene: Option<&'static str>,
    keys: &'static str,
) -> MainScreen<'static> {
    MainScreen { name, scene, keys }
}
