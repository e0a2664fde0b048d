//! The RON dialect of this program's files: `Some` may be omitted.
//!
//! All output goes through one serializer that is independent of the value's type, because a serializer per type would be a
//! twentieth of the program. All input goes through one deserializer.

use ron::error::SpannedError;
use ron::extensions::Extensions;
use ron::ser::PrettyConfig;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt;

/// Options for reading and writing scene files: `Some` may be omitted.
pub fn options() -> ron::Options {
    // The recursion limit is ron's default (128), stated explicitly because the stack size depends on it.
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_recursion_limit(128)
}

/// Reads a value from a text.
///
/// # Errors
/// A syntax or type error with its position.
pub fn read<T: DeserializeOwned>(text: &str) -> Result<T, SpannedError> {
    options().from_str(text)
}

/// A value on one line.
///
/// # Errors
/// If RON cannot represent it.
pub fn line(value: &impl Serialize) -> ron::Result<String> {
    let mut text = String::new();
    line_to(&mut text, value)?;
    Ok(text)
}

/// Writes a value on one line without building a string first.
///
/// # Errors
/// If RON cannot represent it, or writing fails.
pub fn line_to(to: &mut dyn fmt::Write, value: &impl Serialize) -> ron::Result<()> {
    write(&options(), to, value, None)
}

/// A value on several lines, with the given layout.
///
/// # Errors
/// If RON cannot represent it.
pub fn lines(value: &impl Serialize, layout: PrettyConfig) -> ron::Result<String> {
    let mut text = String::new();
    write(&options(), &mut text, value, Some(layout))?;
    Ok(text)
}

/// A value on one line, with `Some` spelled out.
///
/// # Errors
/// If RON cannot represent it.
pub fn strict_line(value: &impl Serialize) -> ron::Result<String> {
    let mut text = String::new();
    write(&ron::Options::default(), &mut text, value, None)?;
    Ok(text)
}

/// A value on several lines, with the given layout and with `Some` spelled out.
///
/// # Errors
/// If RON cannot represent it.
pub fn strict_lines(value: &impl Serialize, layout: PrettyConfig) -> ron::Result<String> {
    let mut text = String::new();
    write(&ron::Options::default(), &mut text, value, Some(layout))?;
    Ok(text)
}

/// Not generic, so that it is compiled only once.
fn write(
    options: &ron::Options,
    to: &mut dyn fmt::Write,
    value: &dyn erased_serde::Serialize,
    layout: Option<PrettyConfig>,
) -> ron::Result<()> {
    match layout {
        Some(layout) => options.to_writer_pretty(to, value, layout),
        None => options.to_writer(to, value),
    }
}
