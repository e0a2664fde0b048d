//! All actions by name: the table behind keys, footer, help, completion and the README's list.
//!
//! Keys are plain strings here (`"s"`, `"F10"`, `"Ctrl-c"`), independent of any terminal library.

use super::meaning::{Page, Step, Ui};
use super::parse_error::ParseError;
use crate::{BranchTarget, Command, ExportScope, Unit};

stickslip_core::words! {
    /// Heading under which help lists an action.
    pub enum Group, ALL, title {
        /// Moving through the iterations.
        Go "Move through the iterations",
        /// Changing the solve.
        Change "Interfere",
        /// Branches of the history.
        Branches "Branches",
        /// Breakpoints and watches.
        Breakpoints "Breakpoints and watches",
        /// Views and analyses.
        Look "Views and analyses",
        /// Lessons and predictions.
        Learn "Learn",
        /// The program itself.
        Program "Program",
    }
}

/// An action: its name, its keys and its help.
#[derive(Debug)]
pub struct ActionEntry {
    /// Name, as typed.
    pub name: &'static str,
    /// Arguments as shown in help; those in brackets are optional.
    pub arguments: &'static str,
    /// Default keys.
    pub keys: &'static [&'static str],
    /// Heading in help.
    pub group: Group,
    /// Word in the footer; empty if the footer omits the action.
    pub label: &'static str,
    /// Help text.
    pub help: &'static str,
    pub(super) verb: Verb,
}

/// How the arguments of an action are read.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Verb {
    Forward(Unit),
    Back(Unit),
    Force {
        hold: bool,
    },
    Release,
    Increment,
    Set,
    /// A short name for a path of `set`.
    SetPath(&'static str),
    Goto,
    /// Go to the named branch, or to this one.
    Branch(Option<BranchTarget>),
    Rename,
    Compare,
    Break,
    Delete,
    Enable {
        on: bool,
    },
    Watch,
    Unwatch,
    /// Apply a consistent state or a remedy, numbered from 1.
    StartFrom,
    Apply,
    /// A command without arguments.
    Plain(Command),
    Census,
    Journal,
    Export {
        what: ExportScope,
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
    Copy,
    Colours,
    Mouse,
    Magnify,
    Help,
    Do(Ui),
}

/// Shorthand that keeps the table at one line per action.
const fn entry(
    group: Group,
    name: &'static str,
    arguments: &'static str,
    keys: &'static [&'static str],
    label: &'static str,
    help: &'static str,
    verb: Verb,
) -> ActionEntry {
    ActionEntry {
        name,
        arguments,
        keys,
        group,
        label,
        help,
        verb,
    }
}

/// All actions.
#[rustfmt::skip]
pub const ACTIONS: &[ActionEntry] = &[
    entry(Group::Go, "step", "[COUNT]", &["s", "F11"], "step", "Go forward by one minor iteration", Verb::Forward(Unit::Minor)),
    entry(Group::Go, "next", "[COUNT]", &["n", "F10"], "next", "Go to the end of this major iteration", Verb::Forward(Unit::Major)),
    entry(Group::Go, "finish", "[COUNT]", &["f", "Shift-F11"], "finish", "Go to the end of this increment", Verb::Forward(Unit::Increment)),
    entry(Group::Go, "continue", "", &["c", "F5"], "continue", "Continue to a breakpoint, a failure or the end", Verb::Forward(Unit::Run)),
    entry(Group::Go, "reverse-step", "[COUNT]", &["S"], "", "Go back by one minor iteration", Verb::Back(Unit::Minor)),
    entry(Group::Go, "reverse-next", "[COUNT]", &["N"], "", "Go back by one major iteration", Verb::Back(Unit::Major)),
    entry(Group::Go, "reverse-finish", "[COUNT]", &["F"], "", "Go back by one increment", Verb::Back(Unit::Increment)),
    entry(Group::Go, "reverse-continue", "", &["C"], "", "Go back to the last breakpoint hit, the last failure or the start", Verb::Back(Unit::Run)),
    entry(Group::Go, "goto", "STEP", &[], "", "Go to a step of this branch, by number; 0 is the start", Verb::Goto),
    entry(Group::Go, "repeat", "", &["Enter"], "", "Repeat the last motion (digits before a motion are its count); in a list, choose the selected entry", Verb::Do(Ui::Repeat)),
    entry(Group::Go, "interrupt", "", &["Ctrl-c"], "", "Interrupt a run after the current minor iteration", Verb::Do(Ui::Interrupt)),

    entry(Group::Change, "force", "[NODE] MODE", &["m"], "mode", "Force a mode for one minor iteration (then f, s, x; capital: hold)", Verb::Force { hold: false }),
    entry(Group::Change, "hold", "[NODE] MODE", &[], "", "Force a mode until released", Verb::Force { hold: true }),
    entry(Group::Change, "release", "[NODE]", &["M"], "", "Release the node, so that Table 2 decides again", Verb::Release),
    entry(Group::Change, "increment", "SIZE", &["i"], "increment", "Restart this increment with another size", Verb::Increment),
    entry(Group::Change, "friction", "DEGREES", &[], "", "Change the friction angle of all slave nodes", Verb::SetPath("friction.angle")),
    entry(Group::Change, "cohesion", "FORCE", &[], "", "Change the cohesion of all slave nodes", Verb::SetPath("friction.cohesion")),
    entry(Group::Change, "minors", "LIMIT", &[], "", "Change the limit on minor iterations", Verb::SetPath("settings.minors")),
    entry(Group::Change, "majors", "LIMIT", &[], "", "Change the limit on major iterations", Verb::SetPath("settings.majors")),
    entry(Group::Change, "start-from", "NUMBER", &[], "", "Start with the modes and T_max of a consistent state of the census", Verb::StartFrom),
    entry(Group::Change, "apply", "NUMBER", &[], "", "Apply remedy NUMBER in a new branch", Verb::Apply),
    entry(Group::Change, "set", "PATH VALUE", &[], "", "Change friction.* or settings.*, or a parameter of an attached solver", Verb::Set),

    entry(Group::Branches, "branch", "NAME", &[], "", "Go to the tip of another branch: b2, its name, or a prefix", Verb::Branch(None)),
    entry(Group::Branches, "branch-next", "", &["]"], "", "Go to the next branch", Verb::Branch(Some(BranchTarget::Next))),
    entry(Group::Branches, "branch-previous", "", &["["], "", "Go to the previous branch", Verb::Branch(Some(BranchTarget::Previous))),
    entry(Group::Branches, "tree", "", &["v"], "", "Show the branches as a tree, and compare two; Enter goes to the selected one", Verb::Do(Ui::Page(Page::Branches))),
    entry(Group::Branches, "branches", "", &[], "", "List all branches, and how each one ended", Verb::Plain(Command::Branches)),
    entry(Group::Branches, "rename", "NAME", &[], "", "Rename this branch", Verb::Rename),
    entry(Group::Branches, "compare", "[BRANCH]", &[], "", "Compare this branch with another, by default with its parent", Verb::Compare),

    entry(Group::Breakpoints, "break", "CONDITION", &["b"], "", "Stop when: mode|leaves [NODE] [MODE], margin [NODE] VALUE, element [NODE], cycle, residual, failure, at INC[.MAJOR[.MINOR]]", Verb::Break),
    entry(Group::Breakpoints, "breakpoints", "", &[], "", "List all breakpoints", Verb::Plain(Command::Breakpoints)),
    entry(Group::Breakpoints, "delete", "NUMBER|all", &[], "", "Delete a breakpoint", Verb::Delete),
    entry(Group::Breakpoints, "disable", "NUMBER|all", &[], "", "Disable a breakpoint", Verb::Enable { on: false }),
    entry(Group::Breakpoints, "enable", "NUMBER|all", &[], "", "Enable a breakpoint", Verb::Enable { on: true }),
    entry(Group::Breakpoints, "watch", "WHAT [NODE]", &[], "", "Watch gap, f_n, f_t, t_max, slip or margin of a node, or residual or interface; add `as NAME` to name it", Verb::Watch),
    entry(Group::Breakpoints, "unwatch", "NAME", &[], "", "Remove a watch", Verb::Unwatch),

    entry(Group::Look, "up", "", &["Up", "k"], "", "Select the node above; scroll or pan in other panes", Verb::Do(Ui::Move(Step::Up))),
    entry(Group::Look, "down", "", &["Down", "j"], "", "Select the node below", Verb::Do(Ui::Move(Step::Down))),
    entry(Group::Look, "left", "", &["Left", "h"], "", "Pan the shape", Verb::Do(Ui::Move(Step::Left))),
    entry(Group::Look, "right", "", &["Right", "l"], "", "Pan the shape", Verb::Do(Ui::Move(Step::Right))),
    entry(Group::Look, "page-up", "", &["PageUp"], "", "Move up by a page of nodes", Verb::Do(Ui::Move(Step::PageUp))),
    entry(Group::Look, "page-down", "", &["PageDown"], "", "Move down by a page of nodes", Verb::Do(Ui::Move(Step::PageDown))),
    entry(Group::Look, "first", "", &["Home", "g"], "", "Select the first node", Verb::Do(Ui::Move(Step::First))),
    entry(Group::Look, "last", "", &["End", "G"], "", "Select the last node", Verb::Do(Ui::Move(Step::Last))),
    entry(Group::Look, "node", "NAME", &["/"], "", "Find a slave node, branch or remedy by part of its name; `/` and Enter find the next", Verb::Node),
    entry(Group::Look, "sort", "[ORDER]", &[">"], "", "Sort the nodes: as in the scene, by margin (closest to switching first), gap, change, ratio |F_t|/T_max or force", Verb::Sort),
    entry(Group::Look, "sort-backward", "", &["<"], "", "Reverse the sort order", Verb::Do(Ui::SortBackward)),
    entry(Group::Look, "filter", "[WHICH]", &["A"], "", "Show all nodes, active ones (in contact or changing), those on the same surface, the changing ones, or those of one mode", Verb::Filter),
    entry(Group::Look, "monitor", "[NAME]", &["y"], "", "Plot the load against the next monitor, or the named one", Verb::Monitor),
    entry(Group::Look, "explain", "", &["e"], "explain", "Show the selected node's decision in full", Verb::Do(Ui::Explain)),
    entry(Group::Look, "diagnosis", "", &["d"], "diagnosis", "Show why it fails; Enter tries the selected remedy", Verb::Do(Ui::Page(Page::Diagnosis))),
    entry(Group::Look, "remedies", "", &["r"], "remedies", "Try all remedies from here; Enter applies the selected one", Verb::Do(Ui::Page(Page::Remedies))),
    entry(Group::Look, "timeline", "", &["t"], "timeline", "Show all modes by iteration; Left and Right move through the iterations", Verb::Do(Ui::Page(Page::Timeline))),
    entry(Group::Look, "cone", "", &["E"], "cone", "Show the selected contact: its force in the friction cone, T_max by iteration, and who pushed it; Left and Right turn the pictures", Verb::Do(Ui::Page(Page::Contact))),
    entry(Group::Look, "census", "[NODES]", &[], "", "Try all assignments of modes in the next frozen problem, for these nodes or for all that can touch (up to 8 one by one, up to 64 by branch and bound)", Verb::Census),
    entry(Group::Look, "chart", "[FILE|PATH=A,B,C]", &[], "", "Show a work-precision chart: measure this scene (its own chart, or over settings), or read a table of `stickslip chart --csv`", Verb::Chart),
    entry(Group::Look, "log", "", &["O"], "", "Show the log of an attached solver: its messages and its standard error", Verb::Do(Ui::Log)),
    entry(Group::Look, "parameters", "", &[], "", "Show the parameters of an attached solver, with their values", Verb::Do(Ui::Parameters)),
    entry(Group::Look, "pane", "", &["Tab"], "pane", "Go to the next pane; on small screens, to the next page", Verb::Do(Ui::NextPane)),
    entry(Group::Look, "previous-pane", "", &["Shift-Tab"], "", "Go to the previous pane", Verb::Do(Ui::PreviousPane)),
    entry(Group::Look, "zoom", "", &["z"], "zoom", "Show this pane alone, or all panes again", Verb::Do(Ui::Zoom)),
    entry(Group::Look, "enlarge", "", &["+", "="], "", "Enlarge the shape", Verb::Do(Ui::Enlarge)),
    entry(Group::Look, "shrink", "", &["-"], "", "Shrink the shape", Verb::Do(Ui::Shrink)),
    entry(Group::Look, "fit", "", &["0"], "", "Show the whole shape", Verb::Do(Ui::Fit)),
    entry(Group::Look, "magnify", "[FACTOR]", &["*"], "", "Magnify the displacements in the shape: automatically, to scale, ×10, ×100, or by a factor", Verb::Magnify),
    entry(Group::Look, "view", "", &["V"], "", "Draw a scene in space in the next projection: oblique, from the top, from the side", Verb::Do(Ui::View)),
    entry(Group::Look, "copy", "[WHAT]", &["Y"], "", "Copy the selection to the clipboard: a row, a value, a command; or name it: row, command, keys, gap, f_n, …", Verb::Copy),

    entry(Group::Learn, "lesson", "[NAME]", &["L"], "", "Start a guided lesson, or continue it: a file, or a built-in one; `NAME@STEP` starts at a step", Verb::Lesson),
    entry(Group::Learn, "on", "", &["Space"], "more", "Continue the lesson: more of its text, then the next step; at the end, the next lesson", Verb::Do(Ui::On)),
    entry(Group::Learn, "reread", "", &["Backspace"], "", "Show the lesson text again from the top", Verb::Do(Ui::Reread)),
    entry(Group::Learn, "hint", "", &["H"], "", "Show the hint of the lesson's question or task; it counts as a wrong answer", Verb::Do(Ui::Hint)),
    entry(Group::Learn, "answer", "[WORD]", &["a"], "answer", "Answer the lesson's question, or predict the selected node's next mode", Verb::Answer),
    entry(Group::Learn, "predict", "[WHOSE]", &["p"], "", "Hide decisions until predicted: any one (selected), every changed one, or off", Verb::Predict),

    entry(Group::Program, "command", "", &[":"], "command", "Run any action by name; Tab completes, Up and Down recall", Verb::Do(Ui::CommandLine)),
    entry(Group::Program, "snapshot", "[FILE]", &["w"], "", "Write a snapshot of the shown state", Verb::Snapshot { overwrite: false }),
    entry(Group::Program, "snapshot!", "FILE", &[], "", "Write a snapshot over an existing file", Verb::Snapshot { overwrite: true }),
    entry(Group::Program, "core", "FILE", &[], "", "Write the fewest nodes that still cycle as a separate scene", Verb::Export { what: ExportScope::Core, overwrite: false }),
    entry(Group::Program, "core!", "FILE", &[], "", "Write the core over an existing file", Verb::Export { what: ExportScope::Core, overwrite: true }),
    entry(Group::Program, "export", "[--frozen] FILE", &[], "", "Write the shown state to a file, by its extension: .svg, .png a picture; .ron the scene, with --frozen its interface problem; .dat, .mtx, .h5 the interface problem for other solvers; .vtu the state for ParaView", Verb::Export { what: ExportScope::Shown, overwrite: false }),
    entry(Group::Program, "export!", "[--frozen] FILE", &[], "", "Export over an existing file", Verb::Export { what: ExportScope::Shown, overwrite: true }),
    entry(Group::Program, "journal", "[FILE]", &[], "", "Write the journal to this new file, with all entries so far; or show its path", Verb::Journal),
    entry(Group::Program, "open", "[SCENE]", &["o"], "", "Open another scene: a file, or a built-in one; a journal continues where it ended", Verb::Open),
    entry(Group::Program, "keys", "", &[], "", "Show the current keys, in the format of the file that changes them", Verb::Do(Ui::Keys)),
    entry(Group::Program, "colours", "[NAME]", &[], "", "Change the colours: dark, light, high contrast, none", Verb::Colours),
    entry(Group::Program, "mouse", "[on|off]", &[], "", "Turn mouse support on or off", Verb::Mouse),
    entry(Group::Program, "redraw", "", &["Ctrl-l"], "", "Redraw the screen", Verb::Do(Ui::Redraw)),
    entry(Group::Program, "suspend", "", &["Ctrl-z"], "", "Suspend the program (fg returns)", Verb::Do(Ui::Suspend)),
    entry(Group::Program, "cancel", "", &["Esc"], "", "Drop a count, close a prompt or unzoom", Verb::Do(Ui::Cancel)),
    entry(Group::Program, "help", "[TOPIC]", &["?", "F1"], "help", "Show this list, or a page of the manual", Verb::Help),
    entry(Group::Program, "quit", "", &["q"], "quit", "Leave", Verb::Do(Ui::Quit)),
];

/// The entry of a key.
pub fn by_key(key: &str) -> Option<&'static ActionEntry> {
    ACTIONS.iter().find(|entry| entry.keys.contains(&key))
}

/// Maximum length of an action's name.
const LONGEST_NAME: usize = 40;

/// Finds an entry by name, one-letter key, or unique prefix.
pub fn by_name(word: &str) -> Result<&'static ActionEntry, ParseError> {
    if word.chars().count() > LONGEST_NAME {
        return Err(ParseError::LongName);
    }
    if let Some(entry) = ACTIONS.iter().find(|entry| entry.name == word) {
        return Ok(entry);
    }
    if word.chars().count() == 1
        && let Some(entry) = by_key(word)
    {
        return Ok(entry);
    }
    begun(word)
}

/// The only entry whose name begins with a word.
pub(super) fn begun(word: &str) -> Result<&'static ActionEntry, ParseError> {
    let found: Vec<_> = ACTIONS
        .iter()
        .filter(|entry| begins(entry.name, word))
        .collect();
    match found[..] {
        [entry] => Ok(entry),
        [] => Err(ParseError::NoAction(word.into())),
        _ => {
            let names = found.iter().map(|entry| entry.name).collect();
            let word = word.into();
            Err(ParseError::Ambiguous { word, names })
        }
    }
}

/// Whether a word is a prefix of a name; a final `!` must match, so that `snap!` is `snapshot!`.
fn begins(name: &str, word: &str) -> bool {
    match (name.strip_suffix('!'), word.strip_suffix('!')) {
        (Some(name), Some(word)) => name.starts_with(word),
        (None, None) => name.starts_with(word),
        _ => false,
    }
}

impl ActionEntry {
    /// Whether digits before the key are a count.
    pub fn takes_count(&self) -> bool {
        self.arguments == "[COUNT]"
    }

    /// The usage line.
    pub fn usage(&self) -> String {
        format!("usage: {} {}", self.name, self.arguments)
            .trim_end()
            .to_string()
    }

    /// File and scene names may contain spaces; elsewhere an extra word is an error.
    pub(super) fn most_words(&self) -> usize {
        match self.verb {
            Verb::Snapshot { .. } | Verb::Open | Verb::Monitor => usize::MAX,
            Verb::Lesson | Verb::Chart | Verb::Journal => usize::MAX,
            Verb::Export { .. } | Verb::Census => usize::MAX,
            Verb::Branch(None) | Verb::Rename | Verb::Compare => usize::MAX,
            Verb::Set => usize::MAX,
            Verb::Colours | Verb::Break | Verb::Watch | Verb::Unwatch => usize::MAX,
            _ => self.arguments.split_whitespace().count(),
        }
    }
}

/// The table in Markdown, as in the README.
pub fn markdown() -> String {
    let mut text = String::new();
    for group in Group::ALL {
        text += &format!("| {} | by name | |\n|---|---|---|\n", group.title());
        for entry in ACTIONS.iter().filter(|entry| entry.group == group) {
            let keys: Vec<_> = entry.keys.iter().map(|key| format!("`{key}`")).collect();
            let name = format!("{} {}", entry.name, entry.arguments);
            // In Markdown tables, a bar separates columns even in code.
            let [name, help] = [name.trim_end(), entry.help].map(|text| text.replace('|', "\\|"));
            text += &format!("| {} | `{name}` | {help} |\n", keys.join(" "));
        }
        text.push('\n');
    }
    text.pop();
    text
}
