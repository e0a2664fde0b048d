//! How the files of this program are written: RON in which `Some` may be left out.
//!
//! Whatever is written goes through one serializer that does not know its type: a serializer made for each type would be
//! a twentieth of the program. Whatever is read goes
//! through one deserializer.

use ron::error::SpannedError;
use ron::extensions::Extensions;
use ron::ser::PrettyConfig;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt;

/// How scene files are read and written: `Some` may be left out.
pub fn options() -> ron::Options {
    // The recursion limit is ron's own (128), spelled out because the stack depends on it.
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_recursion_limit(128)
}

/// The value that a text is.
///
/// # Errors
/// What is wrong with it, and where.
pub fn read<T: DeserializeOwned>(text: &str) -> Result<T, SpannedError> {
    options().from_str(text)
}

/// A value in one line.
///
/// # Errors
/// If RON cannot say it.
pub fn line(value: &impl Serialize) -> ron::Result<String> {
    let mut text = String::new();
    line_to(&mut text, value)?;
    Ok(text)
}

/// A value in one line, written as it comes.
///
/// # Errors
/// If RON cannot say it, or it cannot be written.
pub fn line_to(to: &mut dyn fmt::Write, value: &impl Serialize) -> ron::Result<()> {
    write(&options(), to, value, None)
}

/// A value in lines, laid out as asked.
///
/// # Errors
/// If RON cannot say it.
pub fn lines(value: &impl Serialize, layout: PrettyConfig) -> ron::Result<String> {
    let mut text = String::new();
    write(&options(), &mut text, value, Some(layout))?;
    Ok(text)
}

/// A value in one line, with `Some` spelled out.
///
/// # Errors
/// If RON cannot say it.
pub fn strict_line(value: &impl Serialize) -> ron::Result<String> {
    let mut text = String::new();
    write(&ron::Options::default(), &mut text, value, None)?;
    Ok(text)
}

/// A value in lines, laid out as asked, with `Some` spelled out.
///
/// # Errors
/// If RON cannot say it.
pub fn strict_lines(value: &impl Serialize, layout: PrettyConfig) -> ron::Result<String> {
    let mut text = String::new();
    write(&ron::Options::default(), &mut text, value, Some(layout))?;
    Ok(text)
}

/// Not for each type anew.
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
