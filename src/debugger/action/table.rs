//! Every action by name: the one table behind keys, footer, help, completion and the README's list.
//!
//! Keys are plain strings here (`"s"`, `"F10"`, `"Ctrl-c"`); no terminal library is known to this file.

use super::meaning::{Page, Step, Ui};
use super::misread::Misread;
use crate::record::command::{Command, Exported, To, Unit};

/// Heading under which help lists an action.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// Going through the iterations.
    Go,
    /// Interfering with the solver.
    Change,
    /// Branches of the history.
    Branches,
    /// Breakpoints and watches.
    Breakpoints,
    /// Looking around.
    Look,
    /// Lessons and predictions.
    Learn,
    /// The program itself.
    Program,
}

stickslip_core::words! {
    Group, ALL, title:
    Go "Go through the iterations",
    Change "Interfere",
    Branches "Branches: what if",
    Breakpoints "Breakpoints and watches",
    Look "Look around",
    Learn "Learn",
    Program "The program",
}

/// One action: how it is called, which keys do it, what it does.
#[derive(Debug)]
pub struct Entry {
    /// Its name, as it is typed.
    pub name: &'static str,
    /// Arguments as help shows them; those in brackets may be left out.
    pub arguments: &'static str,
    /// The keys that do it.
    pub keys: &'static [&'static str],
    /// The heading under which help lists it.
    pub group: Group,
    /// Word in the footer; empty where the footer leaves it out.
    pub label: &'static str,
    /// What help says of it.
    pub help: &'static str,
    pub(super) verb: Verb,
}

/// How an entry reads its arguments.
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
    Copy,
    Colours,
    Mouse,
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
    entry(Group::Change, "set", "PATH VALUE", &[], "", "Change friction.* or settings.*; in an attached solver, a parameter that it offers", Verb::Set),

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
    entry(Group::Look, "node", "NAME", &["/"], "", "Find a slave node, a branch or a remedy by a part of its name; `/` and Enter alone find the next", Verb::Node),
    entry(Group::Look, "sort", "[ORDER]", &[">"], "", "Sort the nodes: as in the scene, by margin (closest to switching first), by gap", Verb::Sort),
    entry(Group::Look, "sort-backward", "", &["<"], "", "Sort the other way round, and back", Verb::Do(Ui::SortBackward)),
    entry(Group::Look, "filter", "[WHICH]", &["A"], "", "Show all nodes, active ones (touching or changing), those on the selected one's surface", Verb::Filter),
    entry(Group::Look, "monitor", "[NAME]", &["y"], "", "The load over the next monitor, or the one of that name", Verb::Monitor),
    entry(Group::Look, "explain", "", &["e"], "explain", "The decision on the selected node in full, and who pushed it", Verb::Do(Ui::Explain)),
    entry(Group::Look, "diagnosis", "", &["d"], "diagnosis", "Why the minor iterations cycle, and which states are consistent; Enter starts from the selected one", Verb::Do(Ui::Page(Page::Diagnosis))),
    entry(Group::Look, "remedies", "", &["r"], "remedies", "Try every remedy from here; Enter takes the selected one", Verb::Do(Ui::Page(Page::Remedies))),
    entry(Group::Look, "timeline", "", &["t"], "timeline", "All modes by iteration; Left and Right go through them with the whole screen", Verb::Do(Ui::Page(Page::Timeline))),
    entry(Group::Look, "census", "[NODES]", &[], "", "Try every assignment of modes on the problem that is solved next: of these nodes, or of all that can touch (up to 8 one by one, up to 64 by branch and bound)", Verb::Census),
    entry(Group::Look, "chart", "[FILE|PATH=A,B,C]", &[], "", "Error over cost: of this scene, measured now (its own chart, or over settings), or a table that `stickslip chart --csv` made", Verb::Chart),
    entry(Group::Look, "log", "", &["O"], "", "What an attached solver says besides: its messages and its standard error", Verb::Do(Ui::Log)),
    entry(Group::Look, "parameters", "", &[], "", "What can be set in an attached solver, with its present values", Verb::Do(Ui::Parameters)),
    entry(Group::Look, "pane", "", &["Tab"], "pane", "To the next pane; a small screen turns the page", Verb::Do(Ui::NextPane)),
    entry(Group::Look, "previous-pane", "", &["Shift-Tab"], "", "To the pane before", Verb::Do(Ui::PreviousPane)),
    entry(Group::Look, "zoom", "", &["z"], "zoom", "This pane alone, and back", Verb::Do(Ui::Zoom)),
    entry(Group::Look, "enlarge", "", &["+", "="], "", "The shape larger", Verb::Do(Ui::Enlarge)),
    entry(Group::Look, "shrink", "", &["-"], "", "The shape smaller", Verb::Do(Ui::Shrink)),
    entry(Group::Look, "fit", "", &["0"], "", "The whole shape", Verb::Do(Ui::Fit)),
    entry(Group::Look, "copy", "[WHAT]", &["Y"], "", "Copy what is selected to the clipboard: a row, a value, a command; or row, command, keys, gap, f_n, …", Verb::Copy),

    entry(Group::Learn, "lesson", "[NAME]", &["L"], "", "A guided lesson: a file, or a built-in one", Verb::Lesson),
    entry(Group::Learn, "on", "", &["Space"], "go on", "On with the lesson: more of its words, then the next step", Verb::Do(Ui::On)),
    entry(Group::Learn, "reread", "", &["Backspace"], "", "The lesson's words once more from their beginning, where the screen has no room for all", Verb::Do(Ui::Reread)),
    entry(Group::Learn, "answer", "[WORD]", &["a"], "answer", "Answer the lesson's question, or predict the selected node's next mode", Verb::Answer),
    entry(Group::Learn, "predict", "[WHOSE]", &["p"], "", "Decisions hide until predicted: any one (selected), every changed one, or off", Verb::Predict),

    entry(Group::Program, "command", "", &[":"], "command", "Any action by its name; Tab completes, Up and Down recall", Verb::Do(Ui::CommandLine)),
    entry(Group::Program, "snapshot", "[FILE]", &["w"], "", "Write a snapshot of the shown state", Verb::Snapshot { overwrite: false }),
    entry(Group::Program, "snapshot!", "FILE", &[], "", "The same, over a file that is there already", Verb::Snapshot { overwrite: true }),
    entry(Group::Program, "core", "FILE", &[], "", "Write the fewest nodes that still cycle as a scene of their own", Verb::Export { what: Exported::Core, overwrite: false }),
    entry(Group::Program, "core!", "FILE", &[], "", "The same, over a file that is there already", Verb::Export { what: Exported::Core, overwrite: true }),
    entry(Group::Program, "export", "[--frozen] FILE", &[], "", "Make a file of the shown state, by its extension: .svg, .png a picture; .ron the scene, with --frozen its interface problem; .dat, .mtx, .h5 that for other solvers; .vtu the state for ParaView", Verb::Export { what: Exported::Shown, overwrite: false }),
    entry(Group::Program, "export!", "[--frozen] FILE", &[], "", "The same, over a file that is there already", Verb::Export { what: Exported::Shown, overwrite: true }),
    entry(Group::Program, "journal", "[FILE]", &[], "", "Keep the journal in this new file, with all that was done; or tell where it is", Verb::Journal),
    entry(Group::Program, "open", "[SCENE]", &["o"], "", "Another scene: a file, or a built-in one; a journal goes on where it was", Verb::Open),
    entry(Group::Program, "keys", "", &[], "", "The present keys, as the file has them that changes them", Verb::Do(Ui::Keys)),
    entry(Group::Program, "colours", "[NAME]", &[], "", "Other colours: dark, light, high contrast, none", Verb::Colours),
    entry(Group::Program, "mouse", "[on|off]", &[], "", "Heed the mouse, or leave it to the terminal", Verb::Mouse),
    entry(Group::Program, "redraw", "", &["Ctrl-l"], "", "Draw the screen anew", Verb::Do(Ui::Redraw)),
    entry(Group::Program, "suspend", "", &["Ctrl-z"], "", "Back to the shell for a while (fg returns)", Verb::Do(Ui::Suspend)),
    entry(Group::Program, "cancel", "", &["Esc"], "", "Drop a count, close a prompt, unzoom", Verb::Do(Ui::Cancel)),
    entry(Group::Program, "help", "[TOPIC]", &["?", "F1"], "help", "This list, or a page of the manual", Verb::Help),
    entry(Group::Program, "quit", "", &["q"], "quit", "Leave", Verb::Do(Ui::Quit)),
];

/// The entry that a key does.
pub fn by_key(key: &str) -> Option<&'static Entry> {
    ACTIONS.iter().find(|entry| entry.keys.contains(&key))
}

/// Most characters of an action's name.
const LONGEST_NAME: usize = 40;

/// The entry that a word names: its name, its one-letter key, or the beginning of one name only.
pub fn by_name(word: &str) -> Result<&'static Entry, Misread> {
    if word.chars().count() > LONGEST_NAME {
        return Err(Misread::LongName);
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
pub(super) fn begun(word: &str) -> Result<&'static Entry, Misread> {
    let found: Vec<_> = ACTIONS
        .iter()
        .filter(|entry| begins(entry.name, word))
        .collect();
    match found[..] {
        [entry] => Ok(entry),
        [] => Err(Misread::NoAction(word.into())),
        _ => {
            let names = found.iter().map(|entry| entry.name).collect();
            let word = word.into();
            Err(Misread::Ambiguous { word, names })
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

impl Entry {
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
