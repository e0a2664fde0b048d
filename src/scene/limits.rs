//! Limits on the size of a scene, and checks of single numbers.
//!
//! The limits protect the machine from typos (`elements: 100000000`). The size of a valid large scene is limited by its memory
//! ([`super::memory`], [`super::cost`]).

use crate::format::error::{Fault, Path, fault};
use crate::shortest;
use stickslip_core::linear::estimate::bytes;

/// Maximum number of nodes after refinement: indices in the stiffness have 32 bits.
pub const NODES: usize = 50_000_000;
/// Minimum memory per node in bytes, including its share of elements and stiffness.
pub const NODE_BYTES: f64 = 2000.0;
/// Maximum length of a list of named items (materials, surfaces, monitors, ...).
pub const ENTRIES: usize = 1_000;
/// Memory in bytes per node and chain that contains it.
pub const NAMED_BYTES: f64 = 64.0;
/// Memory in bytes per entry of a body's matrix, including zeros.
pub const ENTRY_BYTES: f64 = 100.0;
/// Maximum number of increments of a history.
pub const INCREMENTS: f64 = 1e6;
/// Maximum for the iteration limits in the settings.
pub const ITERATIONS: u32 = 1_000_000;
/// Maximum number of characters of a name.
pub const NAME: usize = 64;
/// Reserved words after the id of nodes; parts of a mesh cannot use them.
pub const TAKEN: [&str; 3] = ["all", "start", "end"];
/// Maximum number of characters of a title.
pub const TITLE: usize = 120;
/// Largest coordinate, load or prescribed value.
pub const MAGNITUDE: f64 = 1e12;
/// Smallest and largest stiffness; their squares are far from floating-point overflow and underflow.
pub const STIFFNESS: (f64, f64) = (1e-30, 1e30);
/// Upper bound of Poisson's ratio (exclusive).
pub const POISSON: f64 = 0.5;
/// Largest grading of a block's side: last element over first, or first over last.
pub const GRADING: f64 = 1e6;
/// Shortest distance of two neighbouring nodes in an element, relative to the diagonal of the scene.
pub const SHORTEST: f64 = 1e-9;

/// Rejects NaN, infinities and unreasonably large numbers.
pub(crate) fn finite(path: &Path, value: f64, what: &str) -> Result<(), Fault> {
    if value.abs() <= MAGNITUDE {
        return Ok(());
    }
    Err(fault!(
        path,
        "{what} is {value:?}; it must be a finite number between -1e12 and 1e12"
    ))
}

/// Rejects numbers that are not positive, too large or not finite.
pub(crate) fn positive(path: &Path, value: f64, what: &str) -> Result<(), Fault> {
    finite(path, value, what)?;
    if value > 0.0 {
        return Ok(());
    }
    Err(fault!(path, "{what} is {value:?}; it must be positive"))
}

/// Rejects invalid stiffnesses.
pub(crate) fn stiffness(path: &Path, value: f64, what: &str) -> Result<(), Fault> {
    if (STIFFNESS.0..=STIFFNESS.1).contains(&value) {
        return Ok(());
    }
    Err(fault!(
        path,
        "{what} is {value:?}; a stiffness must be positive and finite (1e-30 to 1e30)"
    ))
}

/// Rejects a whole number outside a range.
pub(crate) fn count(
    path: &Path,
    value: usize,
    range: std::ops::RangeInclusive<usize>,
    what: &str,
) -> Result<(), Fault> {
    if range.contains(&value) {
        return Ok(());
    }
    let (least, most) = (range.start(), range.end());
    Err(fault!(
        path,
        "{what} is {value}; it must be {least} to {most}"
    ))
}

/// Rejects a list that is unreasonably long.
pub(crate) fn entries(list: &str, length: usize) -> Result<(), Fault> {
    if length <= ENTRIES {
        return Ok(());
    }
    Err(fault!(
        crate::format::error::at![list],
        "the list has {length} entries; at most {ENTRIES} are allowed"
    ))
}

/// Error if at least this many bytes are needed but not available; `setting` is `settings.memory`.
pub(crate) fn memory(wanted: f64, setting: Option<f64>) -> Result<(), String> {
    let budget = super::memory::budget(setting);
    if wanted <= budget {
        return Ok(());
    }
    let limit = match setting {
        Some(limit) => format!("settings.memory sets the limit to {} GB", shortest(limit)),
        None => format!(
            "{} are free; settings.memory sets the limit (GB)",
            bytes(budget)
        ),
    };
    Err(format!("at least {} of memory, but {limit}", bytes(wanted)))
}

/// Limits the total number of element nodes, so that a chain used repeatedly does not fill the memory.
pub(crate) fn element_nodes(path: &Path, total: usize, setting: Option<f64>) -> Result<(), Fault> {
    memory(total as f64 * NODE_BYTES / 4.0, setting).map_err(|why| {
        fault!(
            path,
            "with this item, the elements have {total} nodes in total, which need {why}"
        )
    })
}

/// A valid id for a single node with this name: the name, truncated to the maximum length, with - for invalid characters.
pub fn node_id_of(name: &str, most: usize) -> String {
    let letters: Vec<char> = name.chars().take(most).collect();
    let is_letter = |k: Option<usize>| k.and_then(|k| letters.get(k)).is_some_and(|c| *c != '.');
    letters
        .iter()
        .enumerate()
        .map(|(k, c)| match c {
            // Dots are valid between other characters.
            '.' if is_letter(k.checked_sub(1)) && is_letter(Some(k + 1)) => '.',
            '_' => '_',
            c if c.is_alphanumeric() => *c,
            _ => '-',
        })
        .collect()
}

/// Rejects ids of single nodes as [`id`] does, but allows dots between other characters, as in the node names of a chain.
pub(crate) fn node_id(path: &Path, node: &str) -> Result<(), Fault> {
    if node.split('.').all(|part| !part.is_empty()) {
        id(path, &node.replace('.', "_"))
    } else {
        id(path, node)
    }
}

/// Rejects names that would be ambiguous in a command line, a CSV column or a message.
pub(crate) fn id(path: &Path, id: &str) -> Result<(), Fault> {
    let wrong = if id.is_empty() {
        "is empty"
    } else if id.chars().count() > NAME {
        "is longer than 64 characters"
    } else if !id
        .chars()
        .all(|c| c.is_alphanumeric() || c == '_' || c == '-')
    {
        "contains other characters"
    } else {
        return Ok(());
    };
    let shown = crate::format::error::quoted(id);
    Err(fault!(
        path,
        "the id {shown} {wrong}; an id consists of letters, digits, - and _"
    ))
}
