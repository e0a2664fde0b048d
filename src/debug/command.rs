//! Every action by name: the one table behind keys, footer, help, completion and the README's list.
//!
//! An action is either a [`Command`] for the solver's session or a [`Ui`] action of the terminal around it. A key
//! press and a typed line both end in [`Entry::act`], so whatever has a key has a name and the other way round. An
//! action that lacks an argument it needs asks for it ([`Ui::Ask`]). Keys are plain strings here (`"s"`, `"F10"`,
//! `"Ctrl-c"`); no terminal library is known to this file.

use crate::history::breakpoints::Condition;
use crate::history::tree::Tree;
use crate::history::watches::{Watch, WatchQuantity};
use crate::interface::census::MOST;
use crate::manual;
use crate::model::{Mode, Model};
use crate::scene::{Scene, paths};
use crate::step::intervene::{Intervention, Start};
use crate::study::Vary;
use crate::teach;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What the debugger can be told to do to the solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Forward by `count` of `unit`.
    Forward { unit: Unit, count: u32 },
    /// Back by `count` of `unit`; exact.
    Back { unit: Unit, count: u32 },
    /// Force a slave node (by slave number) into a mode: for the next minor iteration, or until released.
    Force {
        slave: usize,
        mode: Mode,
        hold: bool,
    },
    /// Give a slave node back to Table 2.
    Release { slave: usize },
    /// Change the increment size and start the present increment again.
    Increment(f64),
    /// Change a scalar that may change during a run: `friction.angle`, `friction.cohesion`, `settings.*`.
    Set { path: String, value: String },
    /// Start several slave nodes at once from a state that is known.
    Assume(Vec<Start>),
    /// Take these steps in a new branch of this name: minor iterations (none) and interventions.
    Follow {
        label: String,
        steps: Vec<Option<Intervention>>,
    },
    /// Find out why the minor iterations cycle from the shown state, or which states are consistent; of these slave
    /// nodes (by slave number), where there are any, all others going on with what they do.
    Census(Vec<usize>),
    /// Try every remedy from the shown state.
    Remedies,
    /// Go to a point of the current branch's line, by its place; the start is 0.
    Goto { step: usize },
    /// Go to the tip of another branch.
    Branch(To),
    /// Call the current branch so.
    Rename(String),
    /// List the branches.
    Branches,
    /// Compare the current branch with another: this one, or the one that it left.
    Compare(Option<String>),
    /// Set a breakpoint.
    Break(Condition),
    /// List the breakpoints.
    Breakpoints,
    /// Delete a breakpoint by its number, or all.
    Delete(Option<u32>),
    /// Switch a breakpoint by its number, or all, on or off.
    Enable { id: Option<u32>, on: bool },
    /// Watch a number.
    Watch(Watch),
    /// End a watch, by its name.
    Unwatch(String),
    /// Write the core of the cycle that the shown state runs into, or its whole frozen interface problem, as a scene of
    /// its own. `overwrite` only when asked.
    Export {
        what: Exported,
        file: PathBuf,
        overwrite: bool,
    },
    /// Write a snapshot of the shown state. `overwrite` only when asked.
    Snapshot {
        file: Option<PathBuf>,
        overwrite: bool,
    },
    /// Begin a journal in a new file, with all that was done; none tells where it is.
    Journal(Option<PathBuf>),
}

/// What can be written as a scene of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Exported {
    Core,
    Whole,
}

/// Which branch.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum To {
    Next,
    Previous,
    Named(String),
}

/// How far a motion goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    Minor,
    /// To the end of the present major iteration.
    Major,
    /// To the end of the present increment.
    Increment,
    /// To the end of the history, a failure, or (back) the start.
    Run,
}

/// What a key or a typed line means.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    Session(Command),
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
    NextPane,
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
    Shrink,
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
    /// An answer to the lesson's question, or a prediction.
    Answer(String),
    /// Free mode: whose decisions hide until predicted; none switches it on or off.
    Predict(Option<Whose>),
    /// Ask for what an action still needs.
    Ask(Question),
    CommandLine,
    /// Load another scene, by file or built-in name.
    Open(String),
    Help,
    /// Show this page of the manual.
    Manual(&'static manual::Page),
    Redraw,
    Suspend,
    /// Leave whatever is open: a count, a prompt, a zoomed pane.
    Cancel,
    Quit,
}

/// A step inside a pane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    Up,
    Down,
    Left,
    Right,
    PageUp,
    PageDown,
    First,
    Last,
}

/// A pane that has a key of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Page {
    Timeline,
    Diagnosis,
    Branches,
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

impl Sort {
    pub const ALL: [Sort; 3] = [Sort::Scene, Sort::Margin, Sort::Gap];

    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Sort::Scene => "scene",
            Sort::Margin => "margin",
            Sort::Gap => "gap",
        }
    }
}

/// Which slave nodes the table shows; the selected one is always there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    All,
    /// Those that touch, or whose mode changes.
    Active,
    /// Those on the surface that the selected one is on.
    Surface,
}

impl Filter {
    pub const ALL: [Filter; 3] = [Filter::All, Filter::Active, Filter::Surface];

    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Filter::All => "all",
            Filter::Active => "active",
            Filter::Surface => "surface",
        }
    }
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

impl Whose {
    pub const ALL: [Whose; 3] = [Whose::Selected, Whose::Changed, Whose::Off];

    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Whose::Selected => "selected",
            Whose::Changed => "changed",
            Whose::Off => "off",
        }
    }
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

/// What an action needs to know to understand its arguments.
#[derive(Debug, Clone, Copy, Default)]
pub struct Context<'a> {
    /// The model, if a scene is open.
    pub model: Option<&'a Model>,
    /// The scene itself, which knows more names of its nodes than the model does (`beam.end` for `beam.5`).
    pub scene: Option<&'a Scene>,
    /// The history, whose branches have names.
    pub tree: Option<&'a Tree>,
    /// The selected slave node, by slave number.
    pub selected: usize,
    /// Names of the built-in scenes.
    pub scenes: &'a [String],
}

/// Heading under which help lists an action.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    Go,
    Change,
    Branches,
    Breakpoints,
    Look,
    Learn,
    Program,
}

impl Group {
    /// All, in the order of the help page.
    pub const ALL: [Group; 7] = [
        Group::Go,
        Group::Change,
        Group::Branches,
        Group::Breakpoints,
        Group::Look,
        Group::Learn,
        Group::Program,
    ];

    /// The heading.
    pub fn title(self) -> &'static str {
        match self {
            Group::Go => "Go through the iterations",
            Group::Change => "Interfere",
            Group::Branches => "Branches: what if",
            Group::Breakpoints => "Breakpoints and watches",
            Group::Look => "Look around",
            Group::Learn => "Learn",
            Group::Program => "The program",
        }
    }
}

/// One action: how it is called, which keys do it, what it does.
#[derive(Debug)]
pub struct Entry {
    pub name: &'static str,
    /// Arguments as help shows them; those in brackets may be left out.
    pub arguments: &'static str,
    pub keys: &'static [&'static str],
    pub group: Group,
    /// Word in the footer; empty where the footer leaves it out.
    pub label: &'static str,
    pub help: &'static str,
    verb: Verb,
}

/// How an entry reads its arguments.
#[derive(Debug, Clone, PartialEq)]
enum Verb {
    Forward(Unit),
    Back(Unit),
    Force {
        hold: bool,
    },
    Release,
    Increment,
    Set,
    /// A short name for one path of `set`.
    SetPath(&'static str),
    Goto,
    /// Go to the branch that is named, or to this one.
    Branch(Option<To>),
    Rename,
    Compare,
    Break,
    Delete,
    Enable {
        on: bool,
    },
    Watch,
    Unwatch,
    /// Take a consistent state, or a remedy, by its number from 1.
    StartFrom,
    Apply,
    /// A command without arguments.
    Plain(Command),
    Census,
    Journal,
    Export {
        what: Exported,
        overwrite: bool,
    },
    Snapshot {
        overwrite: bool,
    },
    Node,
    Open,
    Sort,
    Filter,
    Monitor,
    Lesson,
    Chart,
    Answer,
    Predict,
    Help,
    Do(Ui),
}

/// Shorthand that keeps the table one line an action.
const fn entry(
    group: Group,
    name: &'static str,
    arguments: &'static str,
    keys: &'static [&'static str],
    label: &'static str,
    help: &'static str,
    verb: Verb,
) -> Entry {
    Entry {
        name,
        arguments,
        keys,
        group,
        label,
        help,
        verb,
    }
}

/// The one table.
#[rustfmt::skip]
pub const ACTIONS: &[Entry] = &[
    entry(Group::Go, "step", "[COUNT]", &["s", "F11"], "step", "One minor iteration forward", Verb::Forward(Unit::Minor)),
    entry(Group::Go, "next", "[COUNT]", &["n", "F10"], "next", "To the end of this major iteration", Verb::Forward(Unit::Major)),
    entry(Group::Go, "finish", "[COUNT]", &["f", "Shift-F11"], "finish", "To the end of this increment", Verb::Forward(Unit::Increment)),
    entry(Group::Go, "continue", "", &["c", "F5"], "continue", "On to a breakpoint, a failure, or the end of the history", Verb::Forward(Unit::Run)),
    entry(Group::Go, "reverse-step", "[COUNT]", &["S"], "", "One minor iteration back", Verb::Back(Unit::Minor)),
    entry(Group::Go, "reverse-next", "[COUNT]", &["N"], "", "Back by a major iteration", Verb::Back(Unit::Major)),
    entry(Group::Go, "reverse-finish", "[COUNT]", &["F"], "", "Back by an increment", Verb::Back(Unit::Increment)),
    entry(Group::Go, "reverse-continue", "", &["C"], "", "Back to the last breakpoint that held, the last failure, or the start", Verb::Back(Unit::Run)),
    entry(Group::Go, "goto", "STEP", &[], "", "To a step of this branch by its number; 0 is the start", Verb::Goto),
    entry(Group::Go, "repeat", "", &["Enter"], "", "The last motion again (digits before a motion are its count); in a list, take the selected entry", Verb::Do(Ui::Repeat)),
    entry(Group::Go, "interrupt", "", &["Ctrl-c"], "", "Stop a run after the present minor iteration", Verb::Do(Ui::Interrupt)),

    entry(Group::Change, "force", "[NODE] MODE", &["m"], "mode", "Force a mode for one minor iteration (then f, s, x; capital: hold)", Verb::Force { hold: false }),
    entry(Group::Change, "hold", "[NODE] MODE", &[], "", "Force a mode until released", Verb::Force { hold: true }),
    entry(Group::Change, "release", "[NODE]", &["M"], "", "Give the node back to Table 2", Verb::Release),
    entry(Group::Change, "increment", "SIZE", &["i"], "increment", "Start this increment again with another size", Verb::Increment),
    entry(Group::Change, "friction", "DEGREES", &[], "", "Change the friction angle of every slave node", Verb::SetPath("friction.angle")),
    entry(Group::Change, "cohesion", "FORCE", &[], "", "Change the cohesion of every slave node", Verb::SetPath("friction.cohesion")),
    entry(Group::Change, "minors", "LIMIT", &[], "", "Change the limit of minor iterations", Verb::SetPath("settings.minors")),
    entry(Group::Change, "majors", "LIMIT", &[], "", "Change the limit of major iterations", Verb::SetPath("settings.majors")),
    entry(Group::Change, "start-from", "NUMBER", &[], "", "Start from a consistent state of the census: its modes and T_max", Verb::StartFrom),
    entry(Group::Change, "apply", "NUMBER", &[], "", "Take a remedy of the list, in a new branch", Verb::Apply),
    entry(Group::Change, "set", "PATH VALUE", &[], "", "Change friction.* or settings.*", Verb::Set),

    entry(Group::Branches, "branch", "NAME", &[], "", "To the tip of another branch: b2, its name, or the beginning of it", Verb::Branch(None)),
    entry(Group::Branches, "branch-next", "", &["]"], "", "To the tip of the next branch", Verb::Branch(Some(To::Next))),
    entry(Group::Branches, "branch-previous", "", &["["], "", "To the tip of the branch before", Verb::Branch(Some(To::Previous))),
    entry(Group::Branches, "tree", "", &["v"], "", "The branches as a tree, beside each other; Enter goes to the selected one", Verb::Do(Ui::Page(Page::Branches))),
    entry(Group::Branches, "branches", "", &[], "", "All branches, and how each ended", Verb::Plain(Command::Branches)),
    entry(Group::Branches, "rename", "NAME", &[], "", "Call this branch so", Verb::Rename),
    entry(Group::Branches, "compare", "[BRANCH]", &[], "", "This branch beside another, or beside the one that it left", Verb::Compare),

    entry(Group::Breakpoints, "break", "CONDITION", &["b"], "", "Stop when: mode|leaves [NODE] [MODE], margin [NODE] VALUE, element [NODE], cycle, residual, failure, at INC[.MAJOR[.MINOR]]", Verb::Break),
    entry(Group::Breakpoints, "breakpoints", "", &[], "", "All breakpoints", Verb::Plain(Command::Breakpoints)),
    entry(Group::Breakpoints, "delete", "NUMBER|all", &[], "", "Delete a breakpoint", Verb::Delete),
    entry(Group::Breakpoints, "disable", "NUMBER|all", &[], "", "Pass a breakpoint without stopping", Verb::Enable { on: false }),
    entry(Group::Breakpoints, "enable", "NUMBER|all", &[], "", "Stop at it again", Verb::Enable { on: true }),
    entry(Group::Breakpoints, "watch", "WHAT [NODE]", &[], "", "Watch gap, f_n, f_t, t_max, slip or margin of a node, or residual or interface; `as NAME` names it", Verb::Watch),
    entry(Group::Breakpoints, "unwatch", "NAME", &[], "", "End a watch", Verb::Unwatch),

    entry(Group::Look, "up", "", &["Up", "k"], "", "Node above; scroll or pan in other panes", Verb::Do(Ui::Move(Step::Up))),
    entry(Group::Look, "down", "", &["Down", "j"], "", "Node below", Verb::Do(Ui::Move(Step::Down))),
    entry(Group::Look, "left", "", &["Left", "h"], "", "Pan the shape", Verb::Do(Ui::Move(Step::Left))),
    entry(Group::Look, "right", "", &["Right", "l"], "", "Pan the shape", Verb::Do(Ui::Move(Step::Right))),
    entry(Group::Look, "page-up", "", &["PageUp"], "", "A page of nodes up", Verb::Do(Ui::Move(Step::PageUp))),
    entry(Group::Look, "page-down", "", &["PageDown"], "", "A page of nodes down", Verb::Do(Ui::Move(Step::PageDown))),
    entry(Group::Look, "first", "", &["Home", "g"], "", "First node", Verb::Do(Ui::Move(Step::First))),
    entry(Group::Look, "last", "", &["End", "G"], "", "Last node", Verb::Do(Ui::Move(Step::Last))),
    entry(Group::Look, "node", "NAME", &["/"], "", "Select a slave node by its name or a part of it", Verb::Node),
    entry(Group::Look, "sort", "[ORDER]", &[">"], "", "Sort the nodes: as in the scene, by margin (closest to switching first), by gap", Verb::Sort),
    entry(Group::Look, "sort-backward", "", &["<"], "", "Sort the other way round, and back", Verb::Do(Ui::SortBackward)),
    entry(Group::Look, "filter", "[WHICH]", &["A"], "", "Show all nodes, active ones (touching or changing), those on the selected one's surface", Verb::Filter),
    entry(Group::Look, "monitor", "[NAME]", &["y"], "", "The load over the next monitor, or the one of that name", Verb::Monitor),
    entry(Group::Look, "explain", "", &["e"], "explain", "The decision on the selected node in full, and who pushed it", Verb::Do(Ui::Explain)),
    entry(Group::Look, "diagnosis", "", &["d"], "diagnosis", "Why the minor iterations cycle, and which states are consistent; Enter starts from the selected one", Verb::Do(Ui::Page(Page::Diagnosis))),
    entry(Group::Look, "remedies", "", &["r"], "remedies", "Try every remedy from here; Enter takes the selected one", Verb::Do(Ui::Page(Page::Remedies))),
    entry(Group::Look, "timeline", "", &["t"], "timeline", "All modes by iteration; Left and Right go through them with the whole screen", Verb::Do(Ui::Page(Page::Timeline))),
    entry(Group::Look, "census", "[NODES]", &[], "", "Try every assignment of modes on the problem that is solved next: of these nodes (at most 8), or of all that can touch", Verb::Census),
    entry(Group::Look, "chart", "[FILE|PATH=A,B,C]", &[], "", "Error over cost: of this scene, measured now (its own chart, or over settings), or a table that `stickslip chart --csv` made", Verb::Chart),
    entry(Group::Look, "pane", "", &["Tab"], "pane", "To the next pane; a small screen turns the page", Verb::Do(Ui::NextPane)),
    entry(Group::Look, "previous-pane", "", &["Shift-Tab"], "", "To the pane before", Verb::Do(Ui::PreviousPane)),
    entry(Group::Look, "zoom", "", &["z"], "zoom", "This pane alone, and back", Verb::Do(Ui::Zoom)),
    entry(Group::Look, "enlarge", "", &["+", "="], "", "The shape larger", Verb::Do(Ui::Enlarge)),
    entry(Group::Look, "shrink", "", &["-"], "", "The shape smaller", Verb::Do(Ui::Shrink)),
    entry(Group::Look, "fit", "", &["0"], "", "The whole shape", Verb::Do(Ui::Fit)),

    entry(Group::Learn, "lesson", "[NAME]", &["L"], "", "A guided lesson: a file, or a built-in one", Verb::Lesson),
    entry(Group::Learn, "on", "", &["Space"], "go on", "On with the lesson", Verb::Do(Ui::On)),
    entry(Group::Learn, "answer", "[WORD]", &["a"], "answer", "Answer the lesson's question, or predict the selected node's next mode", Verb::Answer),
    entry(Group::Learn, "predict", "[WHOSE]", &["p"], "", "Decisions hide until predicted: any one (selected), every changed one, or off", Verb::Predict),

    entry(Group::Program, "command", "", &[":"], "command", "Any action by its name; Tab completes, Up and Down recall", Verb::Do(Ui::CommandLine)),
    entry(Group::Program, "snapshot", "[FILE]", &["w"], "", "Write a snapshot of the shown state", Verb::Snapshot { overwrite: false }),
    entry(Group::Program, "snapshot!", "FILE", &[], "", "The same, over a file that is there already", Verb::Snapshot { overwrite: true }),
    entry(Group::Program, "core", "FILE", &[], "", "Write the fewest nodes that still cycle as a scene of their own", Verb::Export { what: Exported::Core, overwrite: false }),
    entry(Group::Program, "core!", "FILE", &[], "", "The same, over a file that is there already", Verb::Export { what: Exported::Core, overwrite: true }),
    entry(Group::Program, "export", "FILE", &[], "", "Write the frozen interface problem of all nodes as a scene of its own", Verb::Export { what: Exported::Whole, overwrite: false }),
    entry(Group::Program, "export!", "FILE", &[], "", "The same, over a file that is there already", Verb::Export { what: Exported::Whole, overwrite: true }),
    entry(Group::Program, "journal", "[FILE]", &[], "", "Keep the journal in this new file, with all that was done; or tell where it is", Verb::Journal),
    entry(Group::Program, "open", "[SCENE]", &["o"], "", "Another scene: a file, or a built-in one", Verb::Open),
    entry(Group::Program, "redraw", "", &["Ctrl-l"], "", "Draw the screen anew", Verb::Do(Ui::Redraw)),
    entry(Group::Program, "suspend", "", &["Ctrl-z"], "", "Back to the shell for a while (fg returns)", Verb::Do(Ui::Suspend)),
    entry(Group::Program, "cancel", "", &["Esc"], "", "Drop a count, close a prompt, unzoom", Verb::Do(Ui::Cancel)),
    entry(Group::Program, "help", "[TOPIC]", &["?", "F1"], "help", "This list, or a page of the manual", Verb::Help),
    entry(Group::Program, "quit", "", &["q"], "quit", "Leave", Verb::Do(Ui::Quit)),
];

/// What `set` can change during a run.
fn set_paths() -> Vec<String> {
    let others = ["history.increment", "friction.angle", "friction.cohesion"];
    let settings = paths::of_settings().into_iter().map(|(path, _)| path);
    others
        .map(String::from)
        .into_iter()
        .chain(settings)
        .collect()
}

/// The entry that a key does.
pub fn by_key(key: &str) -> Option<&'static Entry> {
    ACTIONS.iter().find(|entry| entry.keys.contains(&key))
}

/// Most characters of an action's name, and of what follows it.
const LONGEST_NAME: usize = 40;
const LONGEST_REST: usize = 1000;

/// The entry that a word names: its name, its one-letter key, or the beginning of one name only.
pub fn by_name(word: &str) -> Result<&'static Entry, String> {
    if word.chars().count() > LONGEST_NAME {
        return Err("no action's name is so long; ? lists them all".into());
    }
    if let Some(entry) = ACTIONS.iter().find(|entry| entry.name == word) {
        return Ok(entry);
    }
    if word.chars().count() == 1
        && let Some(entry) = by_key(word)
    {
        return Ok(entry);
    }
    let found: Vec<_> = ACTIONS
        .iter()
        .filter(|entry| begins(entry.name, word))
        .collect();
    match found[..] {
        [entry] => Ok(entry),
        [] => Err(format!("no action is called '{word}'; ? lists them all")),
        _ => {
            let names: Vec<_> = found.iter().map(|entry| entry.name).collect();
            Err(format!("'{word}' could be {}", names.join(", ")))
        }
    }
}

/// Whether a word is the beginning of a name; a `!` at the end stands for itself, so that `snap!` is `snapshot!`.
fn begins(name: &str, word: &str) -> bool {
    match (name.strip_suffix('!'), word.strip_suffix('!')) {
        (Some(name), Some(word)) => name.starts_with(word),
        (None, None) => name.starts_with(word),
        _ => false,
    }
}

/// Reads a line: an action's name and its arguments.
pub fn parse(line: &str, context: &Context) -> Result<Action, String> {
    let line = line.trim();
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    if word.is_empty() {
        return Err("type an action's name; ? lists them all".into());
    }
    by_name(word)?.act(rest.trim(), context)
}

impl Entry {
    /// The action that this entry is with these arguments.
    pub fn act(&self, rest: &str, context: &Context) -> Result<Action, String> {
        if rest.chars().count() > LONGEST_REST {
            return Err(format!(
                "what follows {} is longer than {LONGEST_REST} characters",
                self.name
            ));
        }
        let words: Vec<&str> = rest.split_whitespace().collect();
        if words.len() > self.most_words() {
            return Err(self.usage());
        }
        let command = match &self.verb {
            Verb::Forward(unit) => Command::Forward {
                unit: *unit,
                count: self.count(&words)?,
            },
            Verb::Back(unit) => Command::Back {
                unit: *unit,
                count: self.count(&words)?,
            },
            Verb::Force { hold } => return self.force(&words, *hold, context),
            Verb::Release => Command::Release {
                slave: chosen(words.first().copied(), context)?,
            },
            Verb::Increment if words.is_empty() => {
                return Ok(Action::Ui(Ui::Ask(Question::Increment)));
            }
            Verb::Increment => Command::Increment(increment(rest)?),
            Verb::Set => self.set(&words)?,
            Verb::SetPath(path) => match words[..] {
                [value] => Command::Set {
                    path: path.to_string(),
                    value: value.into(),
                },
                _ => return Err(self.usage()),
            },
            Verb::Goto => match words[..] {
                [word] => Command::Goto {
                    step: word
                        .parse()
                        .map_err(|_| format!("'{word}' is no step's number; {}", self.usage()))?,
                },
                _ => return Err(self.usage()),
            },
            Verb::Branch(Some(to)) => Command::Branch(to.clone()),
            Verb::Branch(None) | Verb::Rename | Verb::Unwatch if rest.is_empty() => {
                return Err(self.usage());
            }
            Verb::Branch(None) => Command::Branch(To::Named(rest.into())),
            Verb::Rename => Command::Rename(rest.into()),
            Verb::Unwatch => Command::Unwatch(rest.into()),
            Verb::Compare => Command::Compare((!rest.is_empty()).then(|| rest.into())),
            Verb::Break if words.is_empty() => return Ok(Action::Ui(Ui::Ask(Question::Break))),
            Verb::Break => Command::Break(condition(&words, context)?),
            Verb::Delete => Command::Delete(self.number_or_all(&words)?),
            Verb::Enable { on } => Command::Enable {
                id: self.number_or_all(&words)?,
                on: *on,
            },
            Verb::Watch => Command::Watch(self.watch(&words, context)?),
            Verb::Plain(command) => command.clone(),
            Verb::Census => Command::Census(several(&words, context)?),
            Verb::Export { .. } if rest.is_empty() => return Err(self.usage()),
            Verb::Export { what, overwrite } => Command::Export {
                what: *what,
                file: PathBuf::from(rest),
                overwrite: *overwrite,
            },
            Verb::Snapshot { overwrite: true } if rest.is_empty() => return Err(self.usage()),
            Verb::Snapshot { overwrite } => {
                let file = (!rest.is_empty()).then(|| PathBuf::from(rest));
                Command::Snapshot {
                    file,
                    overwrite: *overwrite,
                }
            }
            Verb::Journal => Command::Journal((!rest.is_empty()).then(|| PathBuf::from(rest))),
            Verb::Node if rest.is_empty() => return Ok(Action::Ui(Ui::Ask(Question::Node))),
            Verb::Node => return Ok(Action::Ui(Ui::Select(find(rest, context)?))),
            Verb::Open if rest.is_empty() => return Ok(Action::Ui(Ui::Ask(Question::Scene))),
            Verb::Open => return Ok(Action::Ui(Ui::Open(rest.into()))),
            Verb::Sort => {
                let sort = one_of(&words, Sort::ALL, Sort::word)?;
                return Ok(Action::Ui(Ui::Sort(sort)));
            }
            Verb::Filter => {
                let filter = one_of(&words, Filter::ALL, Filter::word)?;
                return Ok(Action::Ui(Ui::Filter(filter)));
            }
            Verb::Chart => return Ok(Action::Ui(Ui::Chart(chart_of(rest, &words)?))),
            Verb::Lesson if rest.is_empty() => return Ok(Action::Ui(Ui::Ask(Question::Lesson))),
            Verb::Lesson => return Ok(Action::Ui(Ui::Lesson(rest.into()))),
            Verb::Answer if rest.is_empty() => return Ok(Action::Ui(Ui::Ask(Question::Answer))),
            Verb::Answer => return Ok(Action::Ui(Ui::Answer(rest.into()))),
            Verb::Predict => {
                let whose = one_of(&words, Whose::ALL, Whose::word)?;
                return Ok(Action::Ui(Ui::Predict(whose)));
            }
            Verb::Monitor if rest.is_empty() => return Ok(Action::Ui(Ui::Monitor(None))),
            Verb::Monitor => return Ok(Action::Ui(Ui::Monitor(Some(monitor(rest, context)?)))),
            Verb::Help if rest.is_empty() => return Ok(Action::Ui(Ui::Help)),
            Verb::Help => return Ok(Action::Ui(Ui::Manual(manual::page(rest)?))),
            Verb::StartFrom => return Ok(Action::Ui(Ui::StartFrom(self.number(&words)?))),
            Verb::Apply => return Ok(Action::Ui(Ui::Apply(self.number(&words)?))),
            Verb::Do(ui) => return Ok(Action::Ui(ui.clone())),
        };
        Ok(Action::Session(command))
    }

    /// Whether digits typed before its key are its count.
    pub fn takes_count(&self) -> bool {
        self.arguments == "[COUNT]"
    }

    /// How it is written.
    pub fn usage(&self) -> String {
        format!("usage: {} {}", self.name, self.arguments)
            .trim_end()
            .to_string()
    }

    /// File and scene names may hold blanks; elsewhere a word too many is a mistake.
    fn most_words(&self) -> usize {
        match self.verb {
            Verb::Snapshot { .. } | Verb::Open | Verb::Monitor => usize::MAX,
            Verb::Lesson | Verb::Chart | Verb::Journal => usize::MAX,
            Verb::Export { .. } | Verb::Census => usize::MAX,
            Verb::Branch(None) | Verb::Rename | Verb::Compare => usize::MAX,
            Verb::Break | Verb::Watch | Verb::Unwatch => usize::MAX,
            _ => self.arguments.split_whitespace().count(),
        }
    }

    fn count(&self, words: &[&str]) -> Result<u32, String> {
        let Some(word) = words.first() else {
            return Ok(1);
        };
        match word.parse() {
            Ok(count) if count > 0 => Ok(count),
            _ => Err(format!("'{word}' is no count; {}", self.usage())),
        }
    }

    /// A number of a list, from 0.
    fn number(&self, words: &[&str]) -> Result<usize, String> {
        let [word] = words[..] else {
            return Err(self.usage());
        };
        match word.parse::<usize>() {
            Ok(number) if number > 0 => Ok(number - 1),
            _ => Err(format!(
                "'{word}' is no number of the list; {}",
                self.usage()
            )),
        }
    }

    /// The number of a breakpoint; none for all.
    fn number_or_all(&self, words: &[&str]) -> Result<Option<u32>, String> {
        match words[..] {
            ["all"] => Ok(None),
            [word] => match word.parse() {
                Ok(number) => Ok(Some(number)),
                Err(_) => Err(format!(
                    "'{word}' is no breakpoint's number; {}",
                    self.usage()
                )),
            },
            _ => Err(self.usage()),
        }
    }

    fn watch(&self, words: &[&str], context: &Context) -> Result<Watch, String> {
        let (what, name) = match words.iter().position(|word| *word == "as") {
            Some(at) if at + 1 == words.len() => return Err(self.usage()),
            Some(at) => (&words[..at], Some(words[at + 1..].join(" "))),
            None => (words, None),
        };
        let Some((word, rest)) = what.split_first() else {
            return Err(self.usage());
        };
        let model = slaves(context)?;
        let quantity = Quantity::ALL.into_iter().find(|q| q.word() == *word);
        let quantity = quantity.ok_or_else(|| {
            let all = Quantity::ALL.map(Quantity::word).join(", ");
            format!("'{word}' cannot be watched; {all} can")
        })?;
        let slave = match (quantity.is_nodal(), rest) {
            (true, []) => chosen(None, context)?,
            (true, [node]) => exact(node, context)?,
            (false, []) => 0,
            _ => return Err(self.usage()),
        };
        let watch = Watch::new(model, quantity, slave);
        Ok(match name {
            Some(name) => Watch { name, ..watch },
            None => watch,
        })
    }

    fn force(&self, words: &[&str], hold: bool, context: &Context) -> Result<Action, String> {
        let (node, word) = match words[..] {
            [] if !hold => return Ok(Action::Ui(Ui::Ask(Question::Mode))),
            [word] => (None, word),
            [node, word] => (Some(node), word),
            _ => return Err(self.usage()),
        };
        let mode = mode(word)
            .ok_or_else(|| format!("'{word}' is no mode; free, sliding or fixed would be"))?;
        Ok(Action::Session(Command::Force {
            slave: chosen(node, context)?,
            mode,
            hold,
        }))
    }

    fn set(&self, words: &[&str]) -> Result<Command, String> {
        let [path, value] = words[..] else {
            return Err(format!(
                "{}; paths: {}",
                self.usage(),
                set_paths().join(", ")
            ));
        };
        Ok(Command::Set {
            path: path.into(),
            value: value.into(),
        })
    }
}

/// What a breakpoint can wait for.
const CONDITIONS: [&str; 8] = [
    "mode", "leaves", "margin", "element", "cycle", "residual", "failure", "at",
];

/// A breakpoint's condition. A node may be left out, or be `any`, for any node.
fn condition(words: &[&str], context: &Context) -> Result<Condition, String> {
    let (word, rest) = words
        .split_first()
        .map_or(("", words), |(w, rest)| (*w, rest));
    let usage = |how: &str| format!("usage: break {word} {how}");
    match (word, rest) {
        ("mode" | "leaves", _) if rest.len() <= 2 => {
            let (node, mode) = node_and_mode(rest, context)?;
            let (from, to) = match word {
                "mode" => (None, mode),
                _ if mode.is_none() => return Err(usage("[NODE] MODE")),
                _ => (mode, None),
            };
            Ok(Condition::Mode { node, from, to })
        }
        ("mode" | "leaves", _) => Err(usage("[NODE] [MODE]")),
        ("margin", [.., value]) if rest.len() <= 2 => {
            let below = value.parse::<f64>().ok().filter(|below| below.is_finite());
            let below =
                below.ok_or_else(|| format!("'{value}' is no margin; a number would be"))?;
            let node = any_or_exact(rest.get(rest.len().wrapping_sub(2)), context)?;
            Ok(Condition::Margin { node, below })
        }
        ("margin", _) => Err(usage("[NODE] VALUE")),
        ("element", [] | [_]) => Ok(Condition::Element {
            node: any_or_exact(rest.first(), context)?,
        }),
        ("element", _) => Err(usage("[NODE]")),
        ("cycle", []) => Ok(Condition::Cycle),
        ("residual", []) => Ok(Condition::Residual),
        ("failure", []) => Ok(Condition::Failure),
        ("cycle" | "residual" | "failure", _) => Err(usage("")),
        ("at", [place]) => Ok(Condition::At(place.parse()?)),
        ("at", _) => Err(usage("INC[.MAJOR[.MINOR]]")),
        _ => Err(format!(
            "'{word}' is nothing to break at; {} are",
            CONDITIONS.join(", ")
        )),
    }
}

/// `[NODE] [MODE]`: a single word that is a mode is one, anything else is a node.
fn node_and_mode(
    words: &[&str],
    context: &Context,
) -> Result<(Option<usize>, Option<Mode>), String> {
    match words {
        [] => Ok((None, None)),
        [word] => match mode(word) {
            Some(mode) => Ok((None, Some(mode))),
            None => Ok((any_or_exact(Some(word), context)?, None)),
        },
        [node, word, ..] => {
            let mode = mode(word)
                .ok_or_else(|| format!("'{word}' is no mode; free, sliding or fixed would be"))?;
            Ok((any_or_exact(Some(node), context)?, Some(mode)))
        }
    }
}

fn any_or_exact(word: Option<&&str>, context: &Context) -> Result<Option<usize>, String> {
    match word {
        None | Some(&"any") => Ok(None),
        Some(word) => exact(word, context).map(Some),
    }
}

/// A mode by its letter (f, s, x) or the beginning of its name.
pub fn mode(word: &str) -> Option<Mode> {
    let word = word.to_lowercase();
    match word.as_str() {
        "f" => Some(Mode::Free),
        "s" => Some(Mode::Sliding),
        "x" => Some(Mode::Fixed),
        _ if word.len() < 2 => None,
        _ if "free".starts_with(&word) => Some(Mode::Free),
        _ if "sliding".starts_with(&word) => Some(Mode::Sliding),
        _ if "fixed".starts_with(&word) => Some(Mode::Fixed),
        _ => None,
    }
}

/// An increment's size.
pub fn increment(word: &str) -> Result<f64, String> {
    match word.trim().parse::<f64>() {
        Ok(size) if size.is_finite() && size > 0.0 => Ok(size),
        _ => Err(format!(
            "'{}' is no increment; a positive number such as 0.005 would be",
            word.trim()
        )),
    }
}

/// The slave node that a word names, or the selected one where there is no word.
fn chosen(word: Option<&str>, context: &Context) -> Result<usize, String> {
    match word {
        Some(word) => exact(word, context),
        None if context.selected < slaves(context)?.slaves.len() => Ok(context.selected),
        None => Err("this scene has no slave nodes".into()),
    }
}

/// A file, or settings with their values; nothing is the scene's own chart.
fn chart_of(rest: &str, words: &[&str]) -> Result<ChartOf, String> {
    if rest.is_empty() {
        return Ok(ChartOf::Scene);
    }
    if !words.iter().all(|word| word.contains('=')) {
        return Ok(ChartOf::File(rest.into()));
    }
    let over: Result<_, _> = words.iter().map(|word| Vary::parse(word)).collect();
    over.map(ChartOf::Settings)
}

/// The choice that a word, or its beginning, stands for; none without a word.
fn one_of<T: Copy>(
    words: &[&str],
    all: [T; 3],
    spell: fn(T) -> &'static str,
) -> Result<Option<T>, String> {
    let Some(word) = words.first() else {
        return Ok(None);
    };
    let found = all.into_iter().find(|&one| spell(one).starts_with(word));
    found.map(Some).ok_or_else(|| {
        let [a, b, c] = all.map(spell);
        format!("'{word}' is none of {a}, {b}, {c}")
    })
}

/// The number of the monitor of this name.
fn monitor(name: &str, context: &Context) -> Result<usize, String> {
    let monitors = &slaves(context)?.monitors;
    let found = monitors.iter().position(|monitor| monitor.name == name);
    found.ok_or_else(|| match monitors.is_empty() {
        true => "this scene has no monitors".into(),
        false => {
            let names: Vec<_> = monitors.iter().map(|m| m.name.as_str()).collect();
            format!(
                "no monitor is called '{name}'; there are {}",
                names.join(", ")
            )
        }
    })
}

fn slaves<'a>(context: &Context<'a>) -> Result<&'a Model, String> {
    context.model.ok_or_else(|| "open a scene first".into())
}

/// The slave node of exactly this name. No guesses here: what follows changes the solve.
pub fn exact(word: &str, context: &Context) -> Result<usize, String> {
    let model = slaves(context)?;
    let alias = context.scene.and_then(|scene| scene.node(word).ok());
    let node = model
        .nodes
        .iter()
        .position(|node| node.name == word)
        .or(alias);
    if let Some(slave) = model
        .slaves
        .iter()
        .position(|slave| Some(slave.node) == node)
    {
        return Ok(slave);
    }
    let known = some_names(model);
    match node.is_some() {
        true => Err(format!("{word} is not a slave node; those are {known}")),
        false => Err(format!(
            "no node is called '{word}'; slave nodes are {known}"
        )),
    }
}

/// Slave nodes apart by blanks or commas, ascending and each once: by name, or, where no node is called so, by the place in
/// the scene's list, from 1.
fn several(words: &[&str], context: &Context) -> Result<Vec<usize>, String> {
    let words = words.iter().flat_map(|word| word.split(','));
    let mut nodes = Vec::new();
    for word in words.filter(|word| !word.is_empty()) {
        let counted = word.parse::<usize>().ok().and_then(|n| n.checked_sub(1));
        let count = slaves(context)?.slaves.len();
        let slave = match (exact(word, context), counted) {
            (Ok(slave), _) => slave,
            (Err(_), Some(place)) if place < count => place,
            (Err(why), _) => return Err(why),
        };
        if !nodes.contains(&slave) {
            nodes.push(slave);
        }
    }
    nodes.sort_unstable();
    match nodes.len() {
        0..=MOST => Ok(nodes),
        n => Err(format!(
            "a census is held over at most {MOST} nodes, and these are {n}"
        )),
    }
}

/// The next slave node after the selected one whose name is, or else contains, the word.
fn find(word: &str, context: &Context) -> Result<usize, String> {
    if let Ok(slave) = exact(word, context) {
        return Ok(slave);
    }
    let model = slaves(context)?;
    let count = model.contacts.len();
    let hit = |slave: &usize| model.nodes[model.contacts[*slave].node].name.contains(word);
    (1..=count)
        .map(|step| (context.selected + step) % count)
        .find(hit)
        .ok_or_else(|| {
            format!(
                "no slave node's name contains '{word}'; there are {}",
                some_names(model)
            )
        })
}

/// Names of the slave nodes, by slave number.
fn names(model: &Model) -> impl Iterator<Item = &str> {
    model
        .slaves
        .iter()
        .map(|slave| model.nodes[slave.node].name.as_str())
}

/// The first few slave nodes' names, for messages.
fn some_names(model: &Model) -> String {
    const SHOWN: usize = 4;
    let mut list = names(model).take(SHOWN).collect::<Vec<_>>().join(", ");
    if model.contacts.len() > SHOWN {
        list += ", …";
    }
    list
}

/// What a line could go on as: whole lines, of which the first is the likeliest.
pub fn complete(line: &str, context: &Context) -> Vec<String> {
    let first = line.split_whitespace().next();
    let entry = first.and_then(|name| by_name(name).ok());
    let start = match entry.filter(|entry| entry.takes_rest()) {
        // What is one argument, blanks and all, goes on as a whole.
        Some(_) => line.find(char::is_whitespace),
        None => line.rfind(|c: char| c.is_whitespace() || (c == ',' && is_list(entry))),
    };
    let (before, word) = line.split_at(start.map_or(0, |at| at + 1));
    let candidates: Vec<String> = match before.split_whitespace().next() {
        None => ACTIONS.iter().map(|entry| entry.name.to_string()).collect(),
        Some(name) => by_name(name).map_or(Vec::new(), |entry| entry.candidates(before, context)),
    };
    candidates
        .iter()
        .filter(|c| c.starts_with(word))
        .map(|c| format!("{before}{c}"))
        .collect()
}

/// Whether an action takes nodes apart by commas.
fn is_list(entry: Option<&Entry>) -> bool {
    entry.is_some_and(|entry| entry.verb == Verb::Census)
}

impl Entry {
    /// Whether all that stands after its name is one argument that can be completed.
    fn takes_rest(&self) -> bool {
        matches!(self.verb, Verb::Branch(None) | Verb::Compare)
    }

    /// What can stand as the next argument after the text before it.
    fn candidates(&self, before: &str, context: &Context) -> Vec<String> {
        let given = before.split_whitespace().count() - 1;
        let nodes = || context.model.into_iter().flat_map(names).map(String::from);
        let modes = ["free", "sliding", "fixed"].map(String::from);
        match (&self.verb, given) {
            (Verb::Force { .. }, 0) => modes.into_iter().chain(nodes()).collect(),
            (Verb::Force { .. }, 1) => modes.into(),
            (Verb::Release | Verb::Node, 0) => nodes().collect(),
            (Verb::Census, _) => nodes().collect(),
            (Verb::Branch(None) | Verb::Compare, 0) => {
                let branches = context.tree.map_or(&[][..], Tree::branches);
                let numbers = (1..=branches.len()).map(|number| format!("b{number}"));
                let labels = branches.iter().map(|branch| branch.label.clone());
                numbers.chain(labels).collect()
            }
            (Verb::Break, 0) => CONDITIONS.map(String::from).into(),
            (Verb::Break, _) => {
                let any = || std::iter::once("any".into()).chain(nodes());
                match (before.split_whitespace().nth(1), given) {
                    (Some("mode" | "leaves"), 1) => modes.into_iter().chain(any()).collect(),
                    (Some("mode" | "leaves"), 2) => modes.into(),
                    (Some("margin" | "element"), 1) => any().collect(),
                    _ => Vec::new(),
                }
            }
            (Verb::Delete | Verb::Enable { .. }, 0) => vec!["all".into()],
            (Verb::Watch, 0) => Quantity::ALL.map(|quantity| quantity.word().into()).into(),
            (Verb::Watch, 1) => nodes().chain(std::iter::once("as".into())).collect(),
            (Verb::Set, 0) => set_paths(),
            (Verb::Set, 1) => values(before)
                .iter()
                .map(|value| value.to_string())
                .collect(),
            (Verb::Open, 0) => context.scenes.to_vec(),
            (Verb::Help, 0) => manual::PAGES.iter().map(|page| page.topic.into()).collect(),
            (Verb::Lesson, 0) => {
                let names = lesson::list().iter().map(|lesson| lesson.name.into());
                names.collect()
            }
            (Verb::Predict, 0) => Whose::ALL.map(|whose| whose.word().into()).into(),
            (Verb::Sort, 0) => Sort::ALL.map(|sort| sort.word().into()).into(),
            (Verb::Filter, 0) => Filter::ALL.map(|filter| filter.word().into()).into(),
            (Verb::Monitor, 0) => {
                let monitors = context.model.into_iter().flat_map(|model| &model.monitors);
                monitors.map(|monitor| monitor.name.clone()).collect()
            }
            _ => Vec::new(),
        }
    }
}

/// Values that a setting can take, where they are words.
fn values(before: &str) -> &'static [&'static str] {
    let path = before.split_whitespace().nth(1).unwrap_or_default();
    let found = paths::of_settings()
        .into_iter()
        .find(|(own, _)| own == path);
    found.map_or(&[], |(_, words)| words)
}

/// The table as the README shows it.
pub fn markdown() -> String {
    let mut text = String::new();
    for group in Group::ALL {
        text += &format!("| {} | by name | |\n|---|---|---|\n", group.title());
        for entry in ACTIONS.iter().filter(|entry| entry.group == group) {
            let keys: Vec<_> = entry.keys.iter().map(|key| format!("`{key}`")).collect();
            let name = format!("{} {}", entry.name, entry.arguments);
            // In a table of Markdown a bar parts columns even in code.
            let [name, help] = [name.trim_end(), entry.help].map(|text| text.replace('|', "\\|"));
            text += &format!("| {} | `{name}` | {help} |\n", keys.join(" "));
        }
        text.push('\n');
    }
    text.pop();
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Friction, Settings};
    use crate::model::{Node, Slave};

    fn model() -> Model {
        let names = ["beam.1", "beam.4", "beam.5"];
        let nodes = names
            .map(|name| Node {
                name: name.into(),
                at: [0.0; 2],
            })
            .into();
        let slave = |node| Slave {
            node,
            surfaces: vec![],
            friction: Friction::default(),
            start: Mode::Free,
            state: Default::default(),
        };
        Model {
            title: String::new(),
            about: String::new(),
            nodes,
            bodies: vec![],
            surfaces: vec![],
            slaves: vec![slave(1), slave(2)],
            dofs: Default::default(),
            loads: vec![],
            prescribed: vec![],
            path: vec![0.0, 1.0],
            increment: 0.1,
            least: None,
            jumps: Default::default(),
            settings: Settings::default(),
            monitors: vec![],
            length: 1.0,
        }
    }

    fn read(line: &str) -> Result<Action, String> {
        let model = model();
        parse(
            line,
            &Context {
                model: Some(&model),
                selected: 1,
                ..Context::default()
            },
        )
    }

    fn forward(unit: Unit, count: u32) -> Result<Action, String> {
        Ok(Action::Session(Command::Forward { unit, count }))
    }

    #[test]
    fn no_key_and_no_name_means_two_things() {
        let mut keys: Vec<_> = ACTIONS.iter().flat_map(|entry| entry.keys).collect();
        let mut names: Vec<_> = ACTIONS.iter().map(|entry| entry.name).collect();
        let (all_keys, all_names) = (keys.len(), names.len());
        keys.sort();
        keys.dedup();
        names.sort();
        names.dedup();
        assert_eq!((keys.len(), names.len()), (all_keys, all_names));
    }

    #[test]
    fn motions_take_counts_prefixes_and_key_letters() {
        assert_eq!(read("step 3"), forward(Unit::Minor, 3));
        assert_eq!(read("s 3"), forward(Unit::Minor, 3));
        assert_eq!(read("ne"), forward(Unit::Major, 1));
        assert_eq!(read("  fin  "), forward(Unit::Increment, 1));
        assert_eq!(
            read("F 2"),
            Ok(Action::Session(Command::Back {
                unit: Unit::Increment,
                count: 2
            }))
        );
        assert_eq!(
            read("step 0"),
            Err("'0' is no count; usage: step [COUNT]".into())
        );
        assert_eq!(read("step 1 2"), Err("usage: step [COUNT]".into()));
    }

    #[test]
    fn unknown_and_ambiguous_names_are_told() {
        assert_eq!(
            read("jump"),
            Err("no action is called 'jump'; ? lists them all".into())
        );
        assert_eq!(read("mi"), Err("usage: minors LIMIT".into()));
        assert_eq!(read("re"), Err(
            "'re' could be reverse-step, reverse-next, reverse-finish, reverse-continue, repeat, release, rename, remedies, redraw".into()
        ));
    }

    #[test]
    fn modes_are_forced_on_the_named_or_the_selected_node() {
        let force = |slave, mode, hold| Ok(Action::Session(Command::Force { slave, mode, hold }));
        assert_eq!(read("force beam.4 sliding"), force(0, Mode::Sliding, false));
        assert_eq!(read("force x"), force(1, Mode::Fixed, false));
        assert_eq!(read("hold fr"), force(1, Mode::Free, true));
        assert_eq!(read("force"), Ok(Action::Ui(Ui::Ask(Question::Mode))));
        assert_eq!(
            read("force beam.1 s"),
            Err("beam.1 is not a slave node; those are beam.4, beam.5".into())
        );
        assert_eq!(
            read("force tip s"),
            Err("no node is called 'tip'; slave nodes are beam.4, beam.5".into())
        );
        assert_eq!(
            read("force glued"),
            Err("'glued' is no mode; free, sliding or fixed would be".into())
        );
        assert_eq!(
            read("release"),
            Ok(Action::Session(Command::Release { slave: 1 }))
        );
    }

    #[test]
    fn numbers_and_paths() {
        assert_eq!(
            read("increment 0.005"),
            Ok(Action::Session(Command::Increment(0.005)))
        );
        assert!(read("increment -1").is_err_and(|e| e.contains("'-1' is no increment")));
        assert!(read("increment NaN").is_err());
        let set = |path: &str, value: &str| {
            Ok(Action::Session(Command::Set {
                path: path.into(),
                value: value.into(),
            }))
        };
        assert_eq!(read("set friction.angle 20"), set("friction.angle", "20"));
        assert_eq!(read("friction 20"), set("friction.angle", "20"));
        assert_eq!(read("minors 50"), set("settings.minors", "50"));
        let snapshot = |file: Option<&str>, overwrite| {
            Ok(Action::Session(Command::Snapshot {
                file: file.map(PathBuf::from),
                overwrite,
            }))
        };
        assert_eq!(read("w"), snapshot(None, false));
        assert_eq!(read("snap a b.ron"), snapshot(Some("a b.ron"), false));
        assert_eq!(read("snap! x.ron"), snapshot(Some("x.ron"), true));
        assert_eq!(read("snapshot!"), Err("usage: snapshot! FILE".into()));
    }

    #[test]
    fn breakpoints_name_a_condition_a_node_and_what_it_is_held_against() {
        let set = |condition| Ok(Action::Session(Command::Break(condition)));
        let mode = |node, from, to| set(Condition::Mode { node, from, to });
        assert_eq!(read("break mode"), mode(None, None, None));
        assert_eq!(
            read("break mode sliding"),
            mode(None, None, Some(Mode::Sliding))
        );
        assert_eq!(read("break mode beam.5"), mode(Some(1), None, None));
        assert_eq!(
            read("b leaves beam.4 s"),
            mode(Some(0), Some(Mode::Sliding), None)
        );
        assert_eq!(
            read("break leaves any free"),
            mode(None, Some(Mode::Free), None)
        );
        let margin = |node, below| set(Condition::Margin { node, below });
        assert_eq!(read("break margin 1e-3"), margin(None, 1e-3));
        assert_eq!(read("break margin beam.4 -2"), margin(Some(0), -2.0));
        assert_eq!(
            read("break element"),
            set(Condition::Element { node: None })
        );
        assert_eq!(read("break cycle"), set(Condition::Cycle));
        let place = "3.2".parse().unwrap();
        assert_eq!(read("break at 3.2"), set(Condition::At(place)));
        assert_eq!(read("b"), Ok(Action::Ui(Ui::Ask(Question::Break))));
        for (line, told) in [
            ("break leaves beam.4", "usage: break leaves [NODE] MODE"),
            (
                "break mode beam.4 glued",
                "'glued' is no mode; free, sliding or fixed would be",
            ),
            (
                "break mode tip",
                "no node is called 'tip'; slave nodes are beam.4, beam.5",
            ),
            ("break margin", "usage: break margin [NODE] VALUE"),
            (
                "break margin beam.4 NaN",
                "'NaN' is no margin; a number would be",
            ),
            ("break cycle 2", "usage: break cycle "),
            (
                "break at 0",
                "'0' is no place; INC, INC.MAJOR or INC.MAJOR.MINOR would be",
            ),
            (
                "break dance",
                "'dance' is nothing to break at; mode, leaves, margin, element, cycle, residual, failure, at are",
            ),
            (
                "delete x",
                "'x' is no breakpoint's number; usage: delete NUMBER|all",
            ),
        ] {
            assert_eq!(read(line), Err(told.into()), "{line}");
        }
        assert_eq!(
            read("disable all"),
            Ok(Action::Session(Command::Enable {
                id: None,
                on: false
            }))
        );
        assert_eq!(
            read("delete 2"),
            Ok(Action::Session(Command::Delete(Some(2))))
        );
    }

    #[test]
    fn watches_have_the_name_that_is_given_or_their_own() {
        let watch = |name: &str, quantity, slave| {
            let name = name.into();
            Ok(Action::Session(Command::Watch(Watch {
                name,
                quantity,
                slave,
            })))
        };
        assert_eq!(read("watch gap"), watch("gap beam.5", Quantity::Gap, 1));
        assert_eq!(
            read("watch f_n beam.4 as heel force"),
            watch("heel force", Quantity::NormalForce, 0)
        );
        assert_eq!(
            read("watch residual"),
            watch("residual", Quantity::Residual, 0)
        );
        assert_eq!(
            read("watch temperature"),
            Err("'temperature' cannot be watched; gap, f_n, f_t, t_max, slip, margin, residual, interface can".into())
        );
        assert!(read("watch gap as").is_err() && read("watch residual beam.4").is_err());
    }

    #[test]
    fn finding_goes_round_from_the_selected_node() {
        assert_eq!(read("node beam.5"), Ok(Action::Ui(Ui::Select(1))));
        assert_eq!(read("/ beam"), Ok(Action::Ui(Ui::Select(0))));
        assert!(read("node wall").is_err());
    }

    #[test]
    fn a_census_takes_nodes_by_name_or_by_their_place_in_the_list() {
        let census = |slaves: &[usize]| Ok(Action::Session(Command::Census(slaves.to_vec())));
        assert_eq!(read("census"), census(&[]));
        assert_eq!(read("census beam.5"), census(&[1]));
        assert_eq!(read("census beam.5,beam.4"), census(&[0, 1]));
        assert_eq!(read("census 2, 1 2"), census(&[0, 1]));
        assert!(read("census 3").is_err_and(|e| e.contains("no node is called '3'")));
        assert!(read("census 0").is_err() && read("census beam.1").is_err());
    }

    #[test]
    fn files_to_export_to_must_be_named() {
        let export = |what, file: &str, overwrite| {
            Ok(Action::Session(Command::Export {
                what,
                file: file.into(),
                overwrite,
            }))
        };
        assert_eq!(
            read("core a b.ron"),
            export(Exported::Core, "a b.ron", false)
        );
        assert_eq!(read("export! x"), export(Exported::Whole, "x", true));
        assert_eq!(read("core"), Err("usage: core FILE".into()));
        assert_eq!(read("export!"), Err("usage: export! FILE".into()));
    }

    #[test]
    fn branches_complete_by_number_and_by_label() {
        let model = std::sync::Arc::new(Scene::open("osc-two6", &[]).unwrap().model);
        let start = crate::step::stepper::Stepper::new(model.clone())
            .state()
            .clone();
        let tree = Tree::new(model, start, 1 << 20);
        let context = Context {
            tree: Some(&tree),
            ..Context::default()
        };
        let label = &tree.branches()[0].label;
        let all = complete("branch ", &context);
        assert_eq!(all, ["branch b1".to_owned(), format!("branch {label}")]);
        assert_eq!(complete("compare b", &context), ["compare b1"]);
        assert!(complete("branch x", &context).is_empty());
    }

    #[test]
    fn completion_knows_names_nodes_paths_and_values() {
        let model = model();
        let scenes = ["01-pinned".to_string()];
        let context = Context {
            model: Some(&model),
            scenes: &scenes,
            ..Context::default()
        };
        let ask = |line: &str| complete(line, &context);
        assert_eq!(ask("ste"), ["step"]);
        assert_eq!(
            ask("force beam.5 f"),
            ["force beam.5 free", "force beam.5 fixed"]
        );
        assert_eq!(ask("release b"), ["release beam.4", "release beam.5"]);
        let strategies = ["ladder", "least", "lemke"].map(|s| format!("set settings.strategy {s}"));
        assert_eq!(ask("set settings.strategy l"), strategies);
        assert_eq!(
            ask("set settings.to"),
            ["set settings.touch", "set settings.tolerance"]
        );
        let both = ["census beam.4,beam.4", "census beam.4,beam.5"];
        assert_eq!(ask("census beam.4,b"), both);
        assert_eq!(
            ask("set friction."),
            ["set friction.angle", "set friction.cohesion"]
        );
        assert_eq!(ask("set settings.ties p"), ["set settings.ties printed"]);
        assert_eq!(ask("break m"), ["break mode", "break margin"]);
        assert_eq!(ask("break margin beam.4"), ["break margin beam.4"]);
        assert_eq!(
            ask("break leaves beam.4 s"),
            ["break leaves beam.4 sliding"]
        );
        assert_eq!(ask("watch f_"), ["watch f_n", "watch f_t"]);
        assert_eq!(ask("open "), ["open 01-pinned"]);
        assert!(ask("nonsense ").is_empty());
    }

    #[test]
    fn markdown_names_every_action_once() {
        let text = markdown();
        for entry in ACTIONS {
            let name = format!("{} {}", entry.name, entry.arguments);
            let [name, help] = [name.trim_end(), entry.help].map(|t| t.replace('|', "\\|"));
            let end = format!("| `{name}` | {help} |");
            let rows = text.lines().filter(|row| row.ends_with(&end));
            // A bar that is not escaped would be one more column.
            let columns = |row: &str| row.replace("\\|", "").matches('|').count() - 1;
            assert_eq!(rows.map(columns).collect::<Vec<_>>(), [3], "{}", entry.name);
        }
    }
}
