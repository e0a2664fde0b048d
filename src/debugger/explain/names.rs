//! The words for slave nodes, modes, rules and positions, and Table 2 as printed.

use stickslip_core::step::intervene::Start;
use stickslip_core::{Mode, Model, Position, Rule};
use stickslip_scene::{few, shortest};

/// Name of a slave node.
pub fn slave(model: &Model, slave: usize) -> &str {
    model
        .contacts
        .get(slave)
        .map_or("?", |s| model.nodes[s.node].name.as_str())
}

/// The word for a mode.
pub fn mode(mode: Mode) -> &'static str {
    mode.word()
}

/// The word for a contact with this mode; a finished run does not distinguish stick from slip.
pub fn status(model: &Model, of: Mode) -> &'static str {
    match (&model.finished, of) {
        (None, _) => mode(of),
        (Some(_), Mode::Free) => "open",
        (Some(_), _) => "closed",
    }
}

/// Arrows by eighths of a turn, anticlockwise from the right.
pub const ARROWS: [&str; 8] = ["→", "↗", "↑", "↖", "←", "↙", "↓", "↘"];

/// The arrow of a direction in radians.
pub fn arrow(angle: f64) -> &'static str {
    let eighth = (angle / std::f64::consts::FRAC_PI_4).round();
    ARROWS[eighth.rem_euclid(8.0) as usize % ARROWS.len()]
}

/// Initial modes of slave nodes, in words; an ellipsis stands for further ones.
pub fn starts(model: &Model, starts: &[Start], most: usize) -> String {
    let words = |start: &Start| format!("{} {}", slave(model, start.slave), mode(start.mode));
    few(starts.iter().map(words), most)
}

/// Modes in the order of Table 2's rows and columns.
pub const MODES: [Mode; 3] = [Mode::Fixed, Mode::Sliding, Mode::Free];

/// Table 2: the conditions, in two lines, that send a node from the mode of the row to that of the column.
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

/// Newton's table, with the columns of Table 2; it does not depend on the node's mode.
const NEWTON: [[&str; 2]; 3] = [
    ["F_n > k g", "|F_t+k s| ≤ lim"],
    ["F_n > k g", "|F_t+k s| > lim"],
    ["F_n ≤ k g", ""],
];

/// The table of a rule's strategy; empty if the strategy treats all nodes together.
pub fn table(rule: Rule) -> [[[&'static str; 2]; 3]; 3] {
    match rule {
        Rule::NewtonOpens | Rule::NewtonSticks | Rule::NewtonSlides => [NEWTON; 3],
        Rule::CornerReleases
        | Rule::Pivots
        | Rule::Sweeps
        | Rule::Found
        | Rule::Settled
        | Rule::Theirs => [[["", ""]; 3]; 3],
        Rule::FreeEnters => {
            let mut table = TABLE_2;
            table[2] = [["", ""], ["g < 0", ""], ["g > 0", ""]];
            table
        }
        _ => TABLE_2,
    }
}

/// The position of an iteration; finished runs name it differently.
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

/// How far a run is: the load factor, where its leg of the path ends, and which leg that is if there are several.
pub fn load_of(model: &Model, leg: usize, load: f64) -> String {
    let legs = model.path.len().saturating_sub(1);
    // At the end of the path the last leg's end still applies.
    let leg = (leg + 1).min(legs);
    let end = model.path.get(leg).copied().unwrap_or(load);
    let which = match legs {
        0 | 1 => String::new(),
        _ => format!(" (leg {leg} of {legs})"),
    };
    format!("load {} of {}{which}", shortest(load), shortest(end))
}

/// The position of a minor iteration.
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
