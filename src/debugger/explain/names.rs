//! The words for things: slave nodes, modes, rules, places of the iteration, and Table 2 as it is printed.

use stickslip_core::contact::table2::Rule;
use stickslip_core::model::{Mode, Model};
use stickslip_core::step::event::Position;

/// Name of a slave node.
pub fn slave(model: &Model, slave: usize) -> &str {
    model
        .contacts
        .get(slave)
        .map_or("?", |s| model.nodes[s.node].name.as_str())
}

/// A mode's word.
pub fn mode(mode: Mode) -> &'static str {
    mode.word()
}

/// The status of a contact that has a mode next: a finished run does not distinguish stick from slip.
pub fn status(model: &Model, of: Mode) -> &'static str {
    match (&model.finished, of) {
        (None, _) => mode(of),
        (Some(_), Mode::Free) => "open",
        (Some(_), _) => "closed",
    }
}

/// Modes in the order of Table 2's rows and columns.
pub const MODES: [Mode; 3] = [Mode::Fixed, Mode::Sliding, Mode::Free];

/// Table 2: what sends a node from the mode of the row to that of the column, in two lines.
pub const TABLE_2: [[[&str; 2]; 3]; 3] = [
    [
        ["F_n > 0", "|F_t| < |T_max|"],
        ["F_n > 0", "|F_t| > |T_max|"],
        ["F_n ≤ 0", ""],
    ],
    [
        ["F_n > 0", "T_max·slip < 0"],
        ["F_n > 0", "T_max·slip > 0"],
        ["F_n ≤ 0", ""],
    ],
    [["g < 0, rough", ""], ["g < 0, smooth", ""], ["g > 0", ""]],
];

/// Newton's table, whose columns are Table 2's; it does not ask which mode a node has.
const NEWTON: [[&str; 2]; 3] = [
    ["F_n > k g", "|F_t+k s| ≤ lim"],
    ["F_n > k g", "|F_t+k s| > lim"],
    ["F_n ≤ k g", ""],
];

/// What sends a node from mode to mode, by the rule's strategy; empty where all nodes are looked at together.
pub fn table(rule: Rule) -> [[[&'static str; 2]; 3]; 3] {
    match rule {
        Rule::NewtonOpens | Rule::NewtonSticks | Rule::NewtonSlides => [NEWTON; 3],
        Rule::CornerReleases | Rule::Pivots | Rule::Sweeps | Rule::Found | Rule::Theirs => {
            [[["", ""]; 3]; 3]
        }
        Rule::FreeEnters => {
            let mut table = TABLE_2;
            table[2] = [["", ""], ["g < 0", ""], ["g > 0", ""]];
            table
        }
        _ => TABLE_2,
    }
}

/// Where an iteration of a scene was; a finished run has its own names.
pub fn position_in(model: &Model, at: Position) -> String {
    let increment = model.increment_name(at.increment);
    match model.finished {
        Some(_) => format!(
            "increment {increment}, attempt {}, iteration {}",
            at.attempt, at.minor
        ),
        None => position(at),
    }
}

/// Where a minor iteration was.
pub fn position(at: Position) -> String {
    let again = if at.attempt > 1 {
        format!(" (attempt {})", at.attempt)
    } else {
        String::new()
    };
    format!(
        "increment {}{again}, major {}, minor {}",
        at.increment, at.major, at.minor
    )
}
