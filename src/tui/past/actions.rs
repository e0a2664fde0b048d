//! Which of the debugger's actions there are for a run that is over, under their names and keys, and what they do here. All
//! others need a solver.

use crate::action::{ACTIONS, Entry};

/// Name of each, and what it does here; empty where it does the same as in the debugger.
const HERE: [(&str, &str); 31] = [
    ("step", "One iteration forward"),
    ("next", "To the end of this attempt"),
    ("finish", "To the end of this increment"),
    (
        "continue",
        "On to the next attempt that cycles or did not converge, where its cycle begins or its end; else to the run's end",
    ),
    ("reverse-step", "One iteration back"),
    ("reverse-next", "Back to the end of the attempt before"),
    ("reverse-finish", "Back to the end of the increment before"),
    (
        "reverse-continue",
        "Back to the last attempt before that cycles or did not converge, or to the start",
    ),
    (
        "goto",
        "To an iteration by its number in the whole run, from 1",
    ),
    (
        "repeat",
        "The last motion again (digits before a motion are its count)",
    ),
    (
        "up",
        "Contact above; the attempt before, where attempts are listed",
    ),
    (
        "down",
        "Contact below; the next attempt, where attempts are listed",
    ),
    ("left", "One iteration back"),
    ("right", "One iteration forward"),
    ("page-up", "Ten contacts or attempts up"),
    ("page-down", "Ten contacts or attempts down"),
    ("first", "First contact or attempt"),
    ("last", "Last contact or attempt"),
    (
        "node",
        "Find a contact by a part of its name: a slave node's number, or a corner of a slave face",
    ),
    (
        "timeline",
        "All contacts by iteration, with the whole screen, and back",
    ),
    ("pane", ""),
    ("previous-pane", ""),
    ("zoom", ""),
    ("command", "Any of these actions by its name"),
    ("interrupt", "Nothing runs here; closes what is open"),
    ("redraw", ""),
    ("suspend", ""),
    ("cancel", ""),
    ("copy", "Copy what is said of this attempt to the clipboard"),
    ("help", "This list"),
    ("quit", ""),
];

/// The actions, in the order of the debugger's table, with what they do here.
pub fn all() -> impl Iterator<Item = (&'static Entry, &'static str)> {
    ACTIONS.iter().filter_map(|entry| {
        let (_, help) = HERE.iter().find(|(name, _)| *name == entry.name)?;
        Some((entry, if help.is_empty() { entry.help } else { *help }))
    })
}

/// Whether an action is one of them.
pub fn is_here(entry: &Entry) -> bool {
    HERE.iter().any(|(name, _)| *name == entry.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_of_them_are_actions_of_the_debugger() {
        assert_eq!(all().count(), HERE.len());
    }
}
