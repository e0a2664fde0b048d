//! Numbers and vectors of findings, and of the lines of a deck.

use super::shape::Vector;
use stickslip_scene::number::sig4;

/// Numbers of a vector, shortened.
pub fn vector(of: Vector) -> String {
    let [x, y, z] = [of.x, of.y, of.z].map(|part| {
        sig4(if part.abs() < 1e-9 * of.norm() {
            0.0
        } else {
            part
        })
    });
    format!("({x}, {y}, {z})")
}

/// A number with one significant digit, as a deck has it.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.0e}").parse().unwrap_or(value)
}

/// The next larger number with two significant digits.
pub fn rounded_up(value: f64) -> f64 {
    format!("{:.1e}", 1.05 * value).parse().unwrap_or(value)
}

/// A number as a deck has it.
pub fn plain(value: f64) -> String {
    match value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        true => format!("{value}"),
        false => format!("{value:e}"),
    }
}
