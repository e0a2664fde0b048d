//! What a key or a typed line can mean: a command for the session, or something that concerns the terminal alone.

use crate::history::watches::WatchQuantity;
use crate::record::command::Command;
use stickslip_manual as manual;
use stickslip_study::Vary;

/// What a key or a typed line means.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// A command for the session.
    Session(Command),
    /// What concerns the terminal alone.
    Ui(Ui),
}

/// Which work-precision chart is wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ChartOf {
    /// That of this scene.
    Scene,
    /// This scene over the product of these settings.
    Settings(Vec<Vary>),
    /// A table that was written before.
    File(String),
}

/// What concerns the terminal alone.
#[derive(Debug, Clone, PartialEq)]
pub enum Ui {
    /// The last motion once more.
    Repeat,
    /// Stop a run; never the program.
    Interrupt,
    /// Move the selection, scroll or pan, whatever the pane with the focus does with it.
    Move(Step),
    /// Select a slave node, by slave number.
    Select(usize),
    /// Give the focus to the next pane.
    NextPane,
    /// Give the focus to the pane before.
    PreviousPane,
    /// Give the pane with the focus the whole screen, or take it back.
    Zoom,
    /// Zoom the decision.
    Explain,
    /// Show a page, or zoom it and back.
    Page(Page),
    /// Start from this consistent state of the census (from 0).
    StartFrom(usize),
    /// Take this remedy of the list (from 0).
    Apply(usize),
    /// Show a work-precision chart.
    Chart(ChartOf),
    /// The shape larger, smaller, and all of it.
    Enlarge,
    /// The shape smaller.
    Shrink,
    /// All of the shape.
    Fit,
    /// Sort the slave nodes: like this, or in the next way.
    Sort(Option<Sort>),
    /// Sort them the other way round.
    SortBackward,
    /// Which slave nodes the table shows: these, or the next kind.
    Filter(Option<Filter>),
    /// Which monitor the curve shows: this one, or the next.
    Monitor(Option<usize>),
    /// Begin a lesson, by file or built-in name.
    Lesson(String),
    /// On with the lesson.
    On,
    /// The lesson's words once more from their beginning.
    Reread,
    /// An answer to the lesson's question, or a prediction.
    Answer(String),
    /// Free mode: whose decisions hide until predicted; none switches it on or off.
    Predict(Option<Whose>),
    /// Show what an attached solver says besides.
    Log,
    /// Show what can be set in it.
    Parameters,
    /// Ask for what an action still needs.
    Ask(Question),
    /// Open the line for typed commands.
    CommandLine,
    /// Load another scene, by file or built-in name.
    Open(String),
    /// Show the list of all actions.
    Help,
    /// Show this page of the manual.
    Manual(&'static manual::Page),
    /// Copy something to the terminal's clipboard; none is what is selected.
    Copy(Option<Copied>),
    /// Show the present keys, as a file would have them.
    Keys,
    /// Other colours; none tells the present ones.
    Colours(Option<Colours>),
    /// Heed the mouse or not; none switches.
    Mouse(Option<bool>),
    /// Draw the whole screen again.
    Redraw,
    /// Give the terminal back to the shell until it resumes the program (Ctrl-Z).
    Suspend,
    /// Leave whatever is open: a count, a prompt, a zoomed pane.
    Cancel,
    /// Leave the program.
    Quit,
}

/// A step inside a pane.
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

/// A pane that has a key of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Page {
    /// All iterations so far.
    Timeline,
    /// Why the iterations cycle.
    Diagnosis,
    /// All branches, and how they ended.
    Branches,
    /// What gets past a failure.
    Remedies,
}

/// How the table sorts the slave nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sort {
    /// As the scene lists them.
    Scene,
    /// Closest to switching first.
    Margin,
    /// Deepest penetration first.
    Gap,
}

stickslip_core::words! {
    Sort, ALL, word:
    Scene "scene",
    Margin "margin",
    Gap "gap",
}

/// Which slave nodes the table shows; the selected one is always there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    /// All of them.
    All,
    /// Those that touch, or whose mode changes.
    Active,
    /// Those on the surface that the selected one is on.
    Surface,
}

stickslip_core::words! {
    Filter, ALL, word:
    All "all",
    Active "active",
    Surface "surface",
}

/// Whose decisions hide, in free mode, until they are predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whose {
    /// Any one node's, the selected one's say, for all.
    Selected,
    /// Those of every node whose mode changes.
    Changed,
    /// Nobody's.
    Off,
}

stickslip_core::words! {
    Whose, ALL, word:
    Selected "selected",
    Changed "changed",
    Off "off",
}

/// What an action can ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// The mode to force the selected node into.
    Mode,
    /// The increment's new size.
    Increment,
    /// Which node to select.
    Node,
    /// Which scene to open.
    Scene,
    /// Where to break.
    Break,
    /// Which lesson to begin.
    Lesson,
    /// The answer to the lesson's question, or the next mode of the selected node.
    Answer,
}

/// What can be copied, besides what is selected in the pane with the focus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Copied {
    /// All numbers of the selected slave node.
    Row,
    /// The line that was typed last.
    Command,
    /// The present keys, as a file would have them.
    Keys,
    /// A number of the selected slave node, or of the solve.
    Number(WatchQuantity),
}

impl Copied {
    /// All, in the order in which they are offered.
    pub fn all() -> impl Iterator<Item = Copied> {
        let numbers = WatchQuantity::ALL.into_iter().map(Copied::Number);
        [Copied::Row, Copied::Command, Copied::Keys]
            .into_iter()
            .chain(numbers)
    }

    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Copied::Row => "row",
            Copied::Command => "command",
            Copied::Keys => "keys",
            Copied::Number(quantity) => quantity.word(),
        }
    }
}

/// Which colours the screen has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Colours {
    /// The terminal's own, for dark grounds; they do on most light ones.
    #[default]
    Dark,
    /// The terminal's own, those that stand out on light grounds.
    Light,
    /// White and bright colours on black, nothing dim.
    HighContrast,
    /// Bold, dim, underlined and reversed only.
    None,
}

stickslip_core::words! {
    Colours, ALL, word:
    Dark "dark",
    Light "light",
    HighContrast "high contrast",
    None "none",
}
