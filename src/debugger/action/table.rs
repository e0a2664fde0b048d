//! All actions by name: the table behind keys, footer, help, completion and the README's list.
//!
//! Keys are plain strings here (`"s"`, `"F10"`, `"Ctrl-c"`), independent of any terminal library.

use super::meaning::{Page, Step, Ui};
use crate::refusal::{Refusal, refusal};
use crate::{BranchTarget, Command, ExportScope, Unit};
use stickslip_scene::format::error::did_you_mean;
use stickslip_scene::joined;

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

use Group::*;

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

use Verb::*;

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
    entry(Go, "step", "[COUNT]", &["s", "F11"], "step", "Go forward by one minor iteration", Forward(Unit::Minor)),
    entry(Go, "next", "[COUNT]", &["n", "F10"], "next", "Go to the end of this major iteration", Forward(Unit::Major)),
    entry(Go, "finish", "[COUNT]", &["f", "Shift-F11"], "finish", "Go to the end of this increment", Forward(Unit::Increment)),
    entry(Go, "continue", "", &["c", "F5"], "continue", "Continue to a breakpoint, a failure or the end", Forward(Unit::Run)),
    entry(Go, "reverse-step", "[COUNT]", &["S"], "", "Go back one iteration or intervention", Back(Unit::Minor)),
    entry(Go, "reverse-next", "[COUNT]", &["N"], "", "Go back by one major iteration", Back(Unit::Major)),
    entry(Go, "reverse-finish", "[COUNT]", &["F"], "", "Go back by one increment", Back(Unit::Increment)),
    entry(Go, "reverse-continue", "", &["C"], "", "Go back to the last breakpoint hit, the last failure or the start", Back(Unit::Run)),
    entry(Go, "goto", "STEP", &[], "", "Go to a step of this branch, by number; 0 is the start", Goto),
    entry(Go, "repeat", "", &["Enter"], "", "Repeat the last motion (digits before a motion are its count); in a list, choose the selected entry", Do(Ui::Repeat)),
    entry(Go, "interrupt", "", &["Ctrl-c"], "", "Interrupt a run after the current minor iteration", Do(Ui::Interrupt)),

    entry(Change, "force", "[NODE] MODE", &["m"], "mode", "Force a mode for one minor iteration (then f, s, x; capital: hold)", Force { hold: false }),
    entry(Change, "hold", "[NODE] MODE", &[], "", "Force a mode until released", Force { hold: true }),
    entry(Change, "release", "[NODE]", &["M"], "", "Release the node, so that Table 2 decides again", Release),
    entry(Change, "increment", "SIZE", &["i"], "increment", "Restart this increment with another size", Increment),
    entry(Change, "friction", "DEGREES", &[], "", "Change the friction angle at all slave nodes", SetPath("friction.angle")),
    entry(Change, "cohesion", "FORCE", &[], "", "Change the cohesion at all slave nodes", SetPath("friction.cohesion")),
    entry(Change, "minors", "LIMIT", &[], "", "Change the limit on minor iterations", SetPath("settings.minors")),
    entry(Change, "majors", "LIMIT", &[], "", "Change the limit on major iterations", SetPath("settings.majors")),
    entry(Change, "start-from", "NUMBER", &[], "", "Start with the modes and T_max of a consistent state of the census", StartFrom),
    entry(Change, "apply", "NUMBER", &[], "", "Apply remedy NUMBER in a new branch", Apply),
    entry(Change, "set", "PATH VALUE", &[], "", "Change friction.* at all slave nodes, settings.*, or a parameter of an attached solver", Set),

    entry(Branches, "branch", "NAME", &[], "", "Go to the tip of another branch: b2, its name, or a prefix", Branch(None)),
    entry(Branches, "branch-next", "", &["]"], "", "Go to the next branch", Branch(Some(BranchTarget::Next))),
    entry(Branches, "branch-previous", "", &["["], "", "Go to the previous branch", Branch(Some(BranchTarget::Previous))),
    entry(Branches, "tree", "", &["v"], "", "Show the branches as a tree, and compare two; Enter goes to the selected one", Do(Ui::Page(Page::Branches))),
    entry(Branches, "branches", "", &[], "", "List all branches, and how each one ended", Plain(Command::Branches)),
    entry(Branches, "rename", "NAME", &[], "", "Rename this branch", Rename),
    entry(Branches, "compare", "[BRANCH]", &[], "", "Compare this branch with another, by default with its parent", Compare),

    entry(Breakpoints, "break", "CONDITION", &["b"], "", "Stop when: mode|leaves [NODE] [MODE], margin [NODE] VALUE, element [NODE], cycle, residual, failure, at INC[.MAJOR[.MINOR]]", Break),
    entry(Breakpoints, "breakpoints", "", &[], "", "List all breakpoints", Plain(Command::Breakpoints)),
    entry(Breakpoints, "delete", "NUMBER|all", &[], "", "Delete a breakpoint", Delete),
    entry(Breakpoints, "disable", "NUMBER|all", &[], "", "Disable a breakpoint", Enable { on: false }),
    entry(Breakpoints, "enable", "NUMBER|all", &[], "", "Enable a breakpoint", Enable { on: true }),
    entry(Breakpoints, "watch", "WHAT [NODE]", &[], "", "Watch gap, f_n, f_t, t_max, slip or margin of a node, or residual or interface; add `as NAME` to name it", Watch),
    entry(Breakpoints, "unwatch", "NAME", &[], "", "Remove a watch", Unwatch),

    entry(Look, "up", "", &["Up", "k"], "", "Select the node above; scroll or pan in other panes", Do(Ui::Move(Step::Up))),
    entry(Look, "down", "", &["Down", "j"], "", "Select the node below", Do(Ui::Move(Step::Down))),
    entry(Look, "left", "", &["Left", "h"], "", "Pan the shape", Do(Ui::Move(Step::Left))),
    entry(Look, "right", "", &["Right", "l"], "", "Pan the shape", Do(Ui::Move(Step::Right))),
    entry(Look, "page-up", "", &["PageUp"], "", "Move up by a page of nodes", Do(Ui::Move(Step::PageUp))),
    entry(Look, "page-down", "", &["PageDown"], "", "Move down by a page of nodes", Do(Ui::Move(Step::PageDown))),
    entry(Look, "first", "", &["Home", "g"], "", "Select the first node", Do(Ui::Move(Step::First))),
    entry(Look, "last", "", &["End", "G"], "", "Select the last node", Do(Ui::Move(Step::Last))),
    entry(Look, "node", "NAME", &["/"], "", "Find a slave node, branch or remedy by part of its name; `/` and Enter find the next", Node),
    entry(Look, "sort", "[ORDER]", &[">"], "", "Sort the nodes: as in the scene, by margin (closest to switching first), gap, change, ratio |F_t|/T_max or force", Sort),
    entry(Look, "sort-backward", "", &["<"], "", "Reverse the sort order", Do(Ui::SortBackward)),
    entry(Look, "filter", "[WHICH]", &["A"], "", "Show all nodes, active ones (in contact or changing), those on the same surface, the changing ones, or those of one mode", Filter),
    entry(Look, "monitor", "[NAME]", &["y"], "", "Plot the load against the next monitor, or the named one", Monitor),
    entry(Look, "explain", "", &["e"], "explain", "Show the selected node's decision in full", Do(Ui::Explain)),
    entry(Look, "diagnosis", "", &["d"], "diagnosis", "Show why it fails; Enter tries the selected remedy", Do(Ui::Page(Page::Diagnosis))),
    entry(Look, "remedies", "", &["r"], "remedies", "Try all remedies from here; Enter applies the selected one", Do(Ui::Page(Page::Remedies))),
    entry(Look, "timeline", "", &["t"], "timeline", "Show all modes by iteration; Left and Right move through the iterations", Do(Ui::Page(Page::Timeline))),
    entry(Look, "cone", "", &["E"], "cone", "Show the selected contact: its force in the friction cone, T_max by iteration, and who pushed it; Left and Right turn the pictures", Do(Ui::Page(Page::Contact))),
    entry(Look, "census", "[NODES]", &[], "", "Try all assignments of modes in the next frozen problem, for these nodes or for all that can touch (up to 8 one by one, up to 64 by branch and bound)", Census),
    entry(Look, "chart", "[FILE|PATH=A,B,C]", &[], "", "Show a work-precision chart: measure this scene (its own chart, or over settings), or read a table of `stickslip chart --csv`", Chart),
    entry(Look, "log", "", &["O"], "", "Show the log of an attached solver: its messages and its standard error", Do(Ui::Log)),
    entry(Look, "parameters", "", &[], "", "Show the parameters of an attached solver, with their values", Do(Ui::Parameters)),
    entry(Look, "pane", "", &["Tab"], "pane", "Go to the next pane; on small screens, to the next page", Do(Ui::NextPane)),
    entry(Look, "previous-pane", "", &["Shift-Tab"], "", "Go to the previous pane", Do(Ui::PreviousPane)),
    entry(Look, "zoom", "", &["z"], "zoom", "Show this pane alone, or all panes again", Do(Ui::Zoom)),
    entry(Look, "enlarge", "", &["+", "="], "", "Enlarge the shape", Do(Ui::Enlarge)),
    entry(Look, "shrink", "", &["-"], "", "Shrink the shape", Do(Ui::Shrink)),
    entry(Look, "fit", "", &["0"], "", "Show the whole shape", Do(Ui::Fit)),
    entry(Look, "magnify", "[FACTOR]", &["*"], "", "Magnify the displacements in the shape: automatically, to scale, ×10, ×100, or by a factor", Magnify),
    entry(Look, "view", "", &["V"], "", "Draw a scene in space in the next projection: oblique, from the top, from the side", Do(Ui::View)),
    entry(Look, "copy", "[WHAT]", &["Y"], "", "Copy the selection to the clipboard: a row, a value, a command; or name it: row, command, keys, gap, f_n, …", Copy),

    entry(Learn, "lesson", "[NAME]", &["L"], "", "Start a guided lesson, or continue it: a file, or a built-in one; `NAME@STEP` starts at a step", Lesson),
    entry(Learn, "on", "", &["Space"], "more", "Continue the lesson: more of its text, then the next step; at the end, the next lesson", Do(Ui::On)),
    entry(Learn, "reread", "", &["Backspace"], "", "Show the lesson text again from the top", Do(Ui::Reread)),
    entry(Learn, "hint", "", &["H"], "", "Show the hint of the lesson's question or task; it counts as a wrong answer", Do(Ui::Hint)),
    entry(Learn, "answer", "[WORD]", &["a"], "answer", "Answer the lesson's question, or predict the selected node's next mode", Answer),
    entry(Learn, "predict", "[WHOSE]", &["p"], "", "Hide decisions until predicted: any one (selected), every changed one, or off", Predict),

    entry(Program, "command", "", &[":"], "command", "Run any action by name; Tab completes, Up and Down recall", Do(Ui::CommandLine)),
    entry(Program, "snapshot", "[FILE]", &["w"], "", "Write a snapshot of the shown state", Snapshot { overwrite: false }),
    entry(Program, "snapshot!", "FILE", &[], "", "Write a snapshot over an existing file", Snapshot { overwrite: true }),
    entry(Program, "core", "FILE", &[], "", "Write the fewest nodes that still cycle as a separate scene", Export { what: ExportScope::Core, overwrite: false }),
    entry(Program, "core!", "FILE", &[], "", "Write the core over an existing file", Export { what: ExportScope::Core, overwrite: true }),
    entry(Program, "export", "[--frozen] FILE", &[], "", "Write the shown state to a file, by its extension: .svg, .png a picture; .ron the scene, with --frozen its interface problem; .dat, .mtx, .h5 the interface problem for other solvers; .vtu the state for ParaView", Export { what: ExportScope::Shown, overwrite: false }),
    entry(Program, "export!", "[--frozen] FILE", &[], "", "Export over an existing file", Export { what: ExportScope::Shown, overwrite: true }),
    entry(Program, "journal", "[FILE]", &[], "", "Write the journal to this new file, with all entries so far; or show its path", Journal),
    entry(Program, "open", "[SCENE]", &["o"], "", "Open another scene: a file, or a built-in one; a journal continues where it ended", Open),
    entry(Program, "keys", "", &[], "", "Show the current keys, in the format of the file that changes them", Do(Ui::Keys)),
    entry(Program, "colours", "[NAME]", &[], "", "Change the colours: dark, light, high contrast, none", Colours),
    entry(Program, "mouse", "[on|off]", &[], "", "Turn mouse support on or off", Mouse),
    entry(Program, "redraw", "", &["Ctrl-l"], "", "Redraw the screen", Do(Ui::Redraw)),
    entry(Program, "suspend", "", &["Ctrl-z"], "", "Suspend the program (fg returns)", Do(Ui::Suspend)),
    entry(Program, "cancel", "", &["Esc"], "", "Drop a count, close a prompt or unzoom", Do(Ui::Cancel)),
    entry(Program, "help", "[TOPIC]", &["?", "F1"], "help", "Show this list, or a page of the manual", Help),
    entry(Program, "quit", "", &["q"], "quit", "Leave", Do(Ui::Quit)),
];

/// The entry of this name.
pub fn named(name: &str) -> Option<&'static ActionEntry> {
    ACTIONS.iter().find(|entry| entry.name == name)
}

/// The entry of a key.
pub fn by_key(key: &str) -> Option<&'static ActionEntry> {
    ACTIONS.iter().find(|entry| entry.keys.contains(&key))
}

/// Maximum length of an action's name.
const LONGEST_NAME: usize = 40;

/// Finds an entry by name, one-letter key, or unique prefix.
pub fn by_name(word: &str) -> Result<&'static ActionEntry, Refusal> {
    if word.chars().count() > LONGEST_NAME {
        return Err(refusal!(
            "unknown action (name too long); ? lists all actions"
        ));
    }
    let of_key = || by_key(word).filter(|_| word.chars().count() == 1);
    match named(word).or_else(of_key) {
        Some(entry) => Ok(entry),
        None => begun(word),
    }
}

/// The only entry whose name begins with a word.
pub(super) fn begun(word: &str) -> Result<&'static ActionEntry, Refusal> {
    let found: Vec<_> = ACTIONS
        .iter()
        .filter(|entry| begins(entry.name, word))
        .collect();
    match found[..] {
        [entry] => Ok(entry),
        [] => {
            let near = did_you_mean(word, ACTIONS.iter().map(|entry| entry.name));
            let help = if near.is_empty() {
                "; ? lists all actions"
            } else {
                &near
            };
            Err(refusal!("unknown action '{word}'{help}"))
        }
        _ => {
            let names = joined(found.iter().map(|entry| entry.name), ", ");
            Err(refusal!("'{word}' is ambiguous: {names}"))
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
            Snapshot { .. } | Open | Monitor => usize::MAX,
            Lesson | Chart | Journal => usize::MAX,
            Export { .. } | Census => usize::MAX,
            Branch(None) | Rename | Compare => usize::MAX,
            Set => usize::MAX,
            Colours | Break | Watch | Unwatch => usize::MAX,
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
            let keys = joined(entry.keys.iter().map(|key| format!("`{key}`")), " ");
            let name = format!("{} {}", entry.name, entry.arguments);
            // In Markdown tables, a bar separates columns even in code.
            let [name, help] = [name.trim_end(), entry.help].map(|text| text.replace('|', "\\|"));
            text += &format!("| {keys} | `{name}` | {help} |\n");
        }
        text.push('\n');
    }
    text.pop();
    text
}
