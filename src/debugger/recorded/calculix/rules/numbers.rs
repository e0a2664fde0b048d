//! Numbers and vectors of findings, and lines of a deck.

use super::shape::Vector;
use std::fmt::Display;
use stickslip_scene::sig4;

/// Numbers of a vector, shortened.
pub fn vector(of: Vector) -> String {
    let is_zero = |part: f64| part.abs() < 1e-9 * of.norm();
    let [x, y, z] = [of.x, of.y, of.z].map(|part| sig4(if is_zero(part) { 0.0 } else { part }));
    format!("({x}, {y}, {z})")
}

/// A number with one significant digit, as a deck has it.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.0e}").parse().unwrap_or(value)
}

/// The next larger number with two significant digits.
pub fn rounded_up(value: f64) -> f64 {
    two_digits(1.05 * value)
}

/// A number with two significant digits.
pub fn two_digits(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// A number as a deck has it.
pub fn plain(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// A prescribed displacement as a line of `*BOUNDARY`; axes count from 0.
pub fn displaced(nodes: impl Display, axis: usize, value: impl Display) -> String {
    format!("{nodes}, {0}, {0}, {value}", axis + 1)
}

/// `*BOUNDARY` with its lines; empty without lines.
pub fn boundary(lines: impl IntoIterator<Item = String>) -> String {
    let lines = lines.into_iter().map(|line| format!("\n{line}"));
    match lines.collect::<String>() {
        lines if lines.is_empty() => lines,
        lines => format!("*BOUNDARY{lines}"),
    }
}
