//! `--json`: the result of a subcommand as data, to standard output or to a file. The records are in [`super::records`].

use super::base::{Error, usage};
use super::sink::{Sink, is_input};
use serde::Serialize;
use std::fmt::Write;
use stickslip_platform::files::Output;
use stickslip_scene::shown;

#[derive(Debug, clap::Args)]
pub struct JsonArgs {
    /// Writes the result as JSON (page json): to FILE, or to standard output instead of the text there
    #[arg(long, value_name = "FILE|-", num_args = 0..=1, default_missing_value = "-")]
    json: Option<String>,
}

impl JsonArgs {
    /// The destination, if one is requested: a file, or `-`.
    pub fn to(&self) -> Option<&str> {
        self.json.as_deref()
    }

    /// Whether standard output carries JSON, and therefore no text.
    pub fn is_on_standard_output(&self) -> bool {
        self.to() == Some("-")
    }

    /// Opens the destination, if one is requested, before the results are computed.
    ///
    /// # Errors
    /// If the file exists and must not be overwritten, or cannot be written.
    pub fn open(&self, overwrite: bool) -> Result<Option<Sink>, Error> {
        if let Some(file) = self.to().filter(|file| is_input(file)) {
            return Err(usage!(
                "--json {file}: {file} is a scene, deck or snapshot, but the word after --json is the file to write; put --json at the end of the line"
            ));
        }
        self.to().map(|to| Sink::open(to, overwrite)).transpose()
    }
}

/// Writes a record whole, if it is requested.
///
/// # Errors
/// If it cannot be written. A reader that closes the pipe is no error.
pub fn write(to: Option<Sink>, record: &impl Serialize) -> Result<(), Error> {
    to.map_or(Ok(()), |sink| {
        Ok(unfinished(sink, record)?.map_or(Ok(()), Output::finish)?)
    })
}

/// Writes a record; a file does not get its name yet.
///
/// # Errors
/// If it cannot be written.
pub fn unfinished(mut sink: Sink, record: &impl Serialize) -> Result<Option<Output>, Error> {
    sink.send(&text(record)?)?;
    Ok(sink.into_file())
}

/// A record as text. Numbers have as many digits as needed to read back the same bits; those that are not finite are null.
fn text(record: &impl Serialize) -> Result<String, Error> {
    let text = serde_json::to_string_pretty(record).map_err(|error| usage!("--json: {error}"))?;
    let mut safe = String::with_capacity(text.len() + 1);
    let mut units = [0; 2];
    for letter in text.chars() {
        // Of these characters only line ends occur outside of strings.
        if letter == '\n' || !shown::is_order(letter) {
            safe.push(letter);
            continue;
        }
        for unit in letter.encode_utf16(&mut units) {
            // Writing to a string does not fail.
            let _ = write!(safe, "\\u{unit:04x}");
        }
    }
    safe.push('\n');
    Ok(safe)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::Value;

    #[test]
    fn numbers_that_are_not_finite_are_null() {
        let found = text(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0]).unwrap();
        let found: Value = serde_json::from_str(&found).unwrap();
        assert_eq!(found, serde_json::json!([null, null, null, -0.0]));
    }

    proptest! {
        #[test]
        fn text_is_safe_to_print_and_reads_back(words in any::<String>(), bits in any::<u64>()) {
            let words = format!("{words}\u{1b}\u{202e}\u{e0001}");
            let number = f64::from_bits(bits);
            let found = text(&(&words, number)).unwrap();
            prop_assert_eq!(shown::text(&found), found.as_str());
            let (same, read): (String, Option<f64>) = serde_json::from_str(&found).unwrap();
            prop_assert_eq!(same, words);
            let expected = Some(number).filter(|number| number.is_finite());
            prop_assert_eq!(read.map(f64::to_bits), expected.map(f64::to_bits));
        }
    }
}
