//! Random mesh scenes of six families, as texts of scene files.
//!
//! Whether a scene has an answer is not asked: bodies may come loose, snap, or be pressed harder than they bear.

mod beams;
mod draft;
mod solids;

use super::draw::Draw;
use draft::Draft;

/// Draws a scene of a family.
type Make = fn(&mut Draw) -> Draft;

/// The families, in the order in which numbers go round them.
pub const FAMILIES: [(&str, Make); 6] = [
    ("beam-beam", beams::on_beam),
    ("beam-rigid", beams::on_rigid),
    ("beam-solid", beams::on_solid),
    ("solid-rigid", solids::on_rigid),
    ("solid-solid", solids::on_solid),
    ("stack", solids::stack),
];

/// A random scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    pub family: &'static str,
    /// Its scene file.
    pub text: String,
}

/// Scene `number` of a seed. The same forever, unless a family is changed.
pub fn draw(seed: u64, number: u64) -> Drawn {
    let (family, make) = FAMILIES[(number % FAMILIES.len() as u64) as usize];
    let mut draft = make(&mut Draw::new(seed, number));
    draft.title = format!("{family} {number} of seed {seed}: {}", draft.title);
    let text = draft.text();
    Drawn { family, text }
}
