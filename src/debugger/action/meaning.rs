//! The meaning of a key or a typed line: a command for the session, or an action of the terminal.

use crate::{Command, WatchQuantity};
use stickslip_manual as manual;
use stickslip_study::Vary;

/// What a key or a typed line does.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// A command for the session.
    Session(Command),
    /// An action of the terminal.
    Ui(Ui),
}

/// Which work-precision chart to show.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ChartOf {
    /// The scene's own chart.
    Scene,
    /// The scene, for all combinations of these settings.
    Settings(Vec<Vary>),
    /// A table written before.
    File(String),
}

/// An action of the terminal.
#[derive(Debug, Clone, PartialEq)]
pub enum Ui {
    /// Repeat the last motion.
    Repeat,
    /// Interrupt a run, without ending the program.
    Interrupt,
    /// Move in the focused pane: select, scroll or pan.
    Move(Step),
    /// Select a slave node, by slave number.
    Select(usize),
    /// Focus the next pane.
    NextPane,
    /// Focus the previous pane.
    PreviousPane,
    /// Show the focused pane alone, or all panes again.
    Zoom,
    /// Show the decision alone.
    Explain,
    /// Show a page; if it is shown, show it alone or with the others.
    Page(Page),
    /// Start from this consistent state of the census (from 0).
    StartFrom(usize),
    /// Apply this remedy of the list (from 0).
    Apply(usize),
    /// Show a work-precision chart.
    Chart(ChartOf),
    /// Enlarge the shape.
    Enlarge,
    /// Shrink the shape.
    Shrink,
    /// Show the whole shape.
    Fit,
    /// Draw a scene in space from the next side.
    View,
    /// Magnify the displacements by a factor, or choose the next magnification.
    Magnify(Option<f64>),
    /// Sort the slave nodes in this order, or in the next one.
    Sort(Option<Sort>),
    /// Reverse the sort order.
    SortBackward,
    /// Show these slave nodes in the table, or the next kind.
    Filter(Option<Filter>),
    /// Show this monitor, or the next.
    Monitor(Option<usize>),
    /// Start a lesson, by file or built-in name, optionally at a step: `NAME@STEP`.
    Lesson(String),
    /// Continue the lesson.
    On,
    /// Show the lesson text again from the top.
    Reread,
    /// Show the hint of the lesson's question or task.
    Hint,
    /// Answer the lesson's question, or predict a mode.
    Answer(String),
    /// Free mode: choose whose decisions are hidden until predicted; `None` switches it on or off.
    Predict(Option<HiddenDecisions>),
    /// Show the log of an attached solver.
    Log,
    /// Show the parameters of an attached solver.
    Parameters,
    /// Ask for a missing argument.
    Ask(Question),
    /// Open the command line.
    CommandLine,
    /// Open another scene, by file or built-in name.
    Open(String),
    /// Show the list of all actions.
    Help,
    /// Show a page of the manual.
    Manual(&'static manual::Page),
    /// Copy to the terminal's clipboard; `None` is the selection.
    Copy(Option<CopyTarget>),
    /// Show the current keys in the format of the file.
    Keys,
    /// Change the colours; `None` shows the current choice.
    Colours(Option<Colours>),
    /// Turn mouse support on or off; `None` toggles it.
    Mouse(Option<bool>),
    /// Redraw the screen.
    Redraw,
    /// Suspend the program (Ctrl-Z).
    Suspend,
    /// Close what is open: a count, a prompt, a zoomed pane.
    Cancel,
    /// Quit the program.
    Quit,
}

/// A movement within a pane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// One row up.
    Up,
    /// One row down.
    Down,
    /// To the left.
    Left,
    /// To the right.
    Right,
    /// One page up.
    PageUp,
    /// One page down.
    PageDown,
    /// To the beginning.
    First,
    /// To the end.
    Last,
}

/// A pane with a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Page {
    /// All iterations so far.
    Timeline,
    /// The cause of a cycle.
    Diagnosis,
    /// All branches, and how they ended.
    Branches,
    /// Ways to get past a failure.
    Remedies,
    /// The contact of the selected node.
    Contact,
}

stickslip_core::words! {
    /// Sort order of the slave nodes.
    pub enum Sort, ALL, word {
        /// The order of the scene.
        Scene "scene",
        /// Closest to switching first.
        Margin "margin",
        /// Deepest penetration first.
        Gap "gap",
        /// Nodes that change first: their mode, then T_max.
        Change "change",
        /// Closest to the friction limit first.
        Ratio "ratio",
        /// Largest contact force first.
        Force "force",
    }
}

stickslip_core::words! {
    /// Which slave nodes the table shows, in addition to the selected one.
    pub enum Filter, ALL, word {
        /// All.
        All "all",
        /// Those in contact, and those whose mode changes.
        Active "active",
        /// Those on the same surface as the selected one.
        Surface "surface",
        /// Those whose mode changes.
        Changing "changing",
        /// The free ones.
        Free "free",
        /// The sliding ones.
        Sliding "sliding",
        /// The fixed ones.
        Fixed "fixed",
    }
}

stickslip_core::words! {
    /// Whose decisions are hidden, in free mode, until they are predicted.
    pub enum HiddenDecisions, ALL, word {
        /// All, until any one node is predicted, such as the selected one.
        Selected "selected",
        /// Those of all nodes whose mode changes.
        Changed "changed",
        /// None.
        Off "off",
    }
}

/// A missing argument that an action asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// Mode to force the selected node into.
    Mode,
    /// New size of the increment.
    Increment,
    /// Node to select.
    Node,
    /// Scene to open.
    Scene,
    /// Condition of a breakpoint.
    Break,
    /// Lesson to start.
    Lesson,
    /// The answer to the lesson's question, or the next mode of the selected node.
    Answer,
}

/// What can be copied in addition to the selection of the focused pane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CopyTarget {
    /// All numbers of the selected slave node.
    Row,
    /// The last line typed.
    Command,
    /// The current keys in the format of the file.
    Keys,
    /// A quantity of the selected slave node, or of the solve.
    Number(WatchQuantity),
}

impl CopyTarget {
    /// All variants, in the order in which they are offered.
    pub fn all() -> impl Iterator<Item = CopyTarget> {
        let numbers = WatchQuantity::ALL.into_iter().map(CopyTarget::Number);
        [CopyTarget::Row, CopyTarget::Command, CopyTarget::Keys]
            .into_iter()
            .chain(numbers)
    }

    /// The word typed for it.
    pub fn word(self) -> &'static str {
        match self {
            CopyTarget::Row => "row",
            CopyTarget::Command => "command",
            CopyTarget::Keys => "keys",
            CopyTarget::Number(quantity) => quantity.word(),
        }
    }
}

stickslip_core::words! {
    /// The colours of the screen.
    #[derive(Default)]
    pub enum Colours, ALL, word {
        /// The terminal's own colours, for dark backgrounds and most light ones.
        #[default]
        Dark "dark",
        /// The terminal's own colours that stand out on light backgrounds.
        Light "light",
        /// White and bright colours on black; nothing dim.
        HighContrast "high contrast",
        /// Only bold, dim, underlined and reversed.
        None "none",
    }
}

impl Colours {
    /// The colours for a light or dark background.
    pub fn for_background(light: bool) -> Colours {
        if light { Colours::Light } else { Colours::Dark }
    }
}
