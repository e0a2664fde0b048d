//! How large a scene may be, and checks of single numbers.
//!
//! The limits keep a slip of the finger (`elements: 100000000`) from taking the machine. What a large scene may have is a
//! matter of the memory that it takes ([`super::memory`], [`super::cost`]).

use crate::format::error::{Fault, Path};
use stickslip_core::linear::estimate::bytes;

/// Most nodes of a scene, after refinement: places in its stiffness have 32 bits.
pub const NODES: usize = 50_000_000;
/// Least bytes that a node takes, with its share of elements and stiffness.
pub const NODE_BYTES: f64 = 2000.0;
/// Most entries of a list of named things (materials, surfaces, monitors, ...).
pub const ENTRIES: usize = 1_000;
/// Bytes that a node takes of a chain that it is in.
pub const NAMED_BYTES: f64 = 64.0;
/// Bytes that an entry of a body's matrix takes, whether it is zero or not.
pub const ENTRY_BYTES: f64 = 100.0;
/// Most increments of a history.
pub const INCREMENTS: f64 = 1e6;
/// Most minor or major iterations that the settings may allow.
pub const ITERATIONS: u32 = 1_000_000;
/// Most characters of a name.
pub const NAME: usize = 64;
/// Words that mean something behind the id of nodes, so that no part of a mesh can be called so.
pub const TAKEN: [&str; 3] = ["all", "start", "end"];
/// Most characters of a title.
pub const TITLE: usize = 120;
/// Largest coordinate, load or prescribed value.
pub const MAGNITUDE: f64 = 1e12;
/// Smallest and largest stiffness: their squares are still far from the ends of floating-point range.
pub const STIFFNESS: (f64, f64) = (1e-30, 1e30);
/// Poisson's ratio is below this.
pub const POISSON: f64 = 0.5;
/// Largest grading of a block's side: last element over first, or first over last.
pub const GRADING: f64 = 1e6;
/// Shortest distance between two neighbours in an element, in diagonals of the scene.
pub const SHORTEST: f64 = 1e-9;

/// Refuses NaN, the infinities and sizes that no scene has.
pub(crate) fn finite(path: &Path, value: f64, what: &str) -> Result<(), Fault> {
    if value.abs() <= MAGNITUDE {
        return Ok(());
    }
    Err(Fault::new(
        path.clone(),
        format!("{what} is {value:?}; it must be a finite number between -1e12 and 1e12"),
    ))
}

/// Refuses what is no usable stiffness.
pub(crate) fn stiffness(path: &Path, value: f64, what: &str) -> Result<(), Fault> {
    if (STIFFNESS.0..=STIFFNESS.1).contains(&value) {
        return Ok(());
    }
    Err(Fault::new(
        path.clone(),
        format!("{what} is {value:?}; a stiffness must be positive and finite (1e-30 to 1e30)"),
    ))
}

/// Refuses a whole number outside of a range.
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
    Err(Fault::new(
        path.clone(),
        format!("{what} is {value}; it must be {least} to {most}"),
    ))
}

/// Refuses a list that is too long to be meant.
pub(crate) fn entries(list: &str, length: usize) -> Result<(), Fault> {
    if length <= ENTRIES {
        return Ok(());
    }
    let message = format!("the list has {length} entries; at most {ENTRIES} can be had");
    Err(Fault::new(crate::format::error::at![list], message))
}

/// What does not fit, if this many bytes are wanted at least; `setting` is `settings.memory`.
pub(crate) fn memory(wanted: f64, setting: Option<f64>) -> Result<(), String> {
    let budget = super::memory::budget(setting);
    if wanted <= budget {
        return Ok(());
    }
    Err(format!(
        "{} of memory at least, and {} are free; settings.memory sets what it may take (GB)",
        bytes(wanted),
        bytes(budget)
    ))
}

/// Refuses more element nodes in all, so that a chain that is used over and over does not fill the memory.
pub(crate) fn element_nodes(path: &Path, total: usize, setting: Option<f64>) -> Result<(), Fault> {
    memory(total as f64 * NODE_BYTES / 4.0, setting).map_err(|why| {
        let message =
            format!("with this, the elements have {total} nodes together, which take {why}");
        Fault::new(path.clone(), message)
    })
}

/// A valid id for a single node with this name: the name, cut to the maximum length, with - for invalid characters.
pub fn node_id_of(name: &str, most: usize) -> String {
    let letters: Vec<char> = name.chars().take(most).collect();
    let is_letter = |k: Option<usize>| k.and_then(|k| letters.get(k)).is_some_and(|c| *c != '.');
    let usable = |(k, c): (usize, &char)| match c {
        // Dots are valid between other characters.
        '.' if is_letter(k.checked_sub(1)) && is_letter(Some(k + 1)) => '.',
        '_' => '_',
        c if c.is_alphanumeric() => *c,
        _ => '-',
    };
    letters.iter().enumerate().map(usable).collect()
}

/// Refuses ids of single nodes as [`id`] does; dots are valid between other characters, as in the node names of a chain.
pub(crate) fn node_id(path: &Path, node: &str) -> Result<(), Fault> {
    match node.split('.').all(|part| !part.is_empty()) {
        true => id(path, &node.replace('.', "_")),
        false => id(path, node),
    }
}

/// Refuses names that could not be told apart in a command line, a CSV column or a message.
pub(crate) fn id(path: &Path, id: &str) -> Result<(), Fault> {
    let wrong = if id.is_empty() {
        "is empty"
    } else if id.chars().count() > NAME {
        "is longer than 64 characters"
    } else if !id
        .chars()
        .all(|c| c.is_alphanumeric() || c == '_' || c == '-')
    {
        "has other characters"
    } else {
        return Ok(());
    };
    let shown = crate::format::error::quoted(id);
    Err(Fault::new(
        path.clone(),
        format!("the id {shown} {wrong}; an id is made of letters, digits, - and _"),
    ))
}
