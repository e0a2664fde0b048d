//! From the text of a file to a [`Spec`]: syntax and types, with the place of what is wrong.

use super::condensed::Problem;
use super::error::{Path, SceneError, did_you_mean, quoted, shortened};
use super::kind::{FileKind, mistaken};
use super::locate::{byte_at, line_and_column, locate, path_at, too_deep};
use super::notation;
use super::spec::Spec;
use crate::shown;
use ron::error::SpannedError;
use serde::de::DeserializeOwned;
use stickslip_exchange::broken::Broken;
use stickslip_platform::input::{self, Unreadable};

/// Most bytes of a scene file: a dense matrix of 2,500 contacts to the last digit.
pub const FILE_BYTES: usize = 512 << 20;

/// Reads a scene's text.
pub fn spec(file: &str, text: &str) -> Result<Spec, SceneError> {
    value(file, text, "scene").map_err(|error| or_mistaken(error, file, text, FileKind::Scene))
}

/// An error of reading a text, or, where the text is of another kind than wanted, that.
pub fn or_mistaken(error: SceneError, file: &str, text: &str, wanted: FileKind) -> SceneError {
    match mistaken(file, text, wanted) {
        Some(message) => SceneError::whole(file, message),
        None => error,
    }
}

/// Reads an interface problem's text.
pub(crate) fn problem(file: &str, text: &str) -> Result<Problem, SceneError> {
    value(file, text, "scene")
}

/// Reads the text of a file that holds one value; messages call it a `what`.
pub fn value<T: DeserializeOwned>(file: &str, text: &str, what: &str) -> Result<T, SceneError> {
    shallow(file, text, what)?;
    notation::read(text).map_err(|error| unreadable(file, text, what, &error))
}

/// Refuses a text whose brackets are nested deeper than those of any file; messages call it a `what`.
pub fn shallow(file: &str, text: &str, what: &str) -> Result<(), SceneError> {
    match too_deep(text) {
        None => Ok(()),
        Some(byte) => Err(SceneError {
            at: Some(line_and_column(text, byte)),
            ..SceneError::whole(
                file,
                format!("brackets are nested far too deep for a {what}"),
            )
        }),
    }
}

/// ron's error in our form.
fn unreadable(file: &str, text: &str, what: &str, error: &SpannedError) -> SceneError {
    let path = path_of(text, error);
    let value = locate(text, &path);
    let of_value = line_and_column(text, value.start);
    // Where a whole value is wrong, its start is the place. Else it is ron's cursor, of which the start of the span is
    // nearer to the fault than the end.
    let (at, message) = match (wanted(&error.code), &error.code) {
        (Some(wanted), _) if !path.0.is_empty() => {
            let shown = shortened(text.get(value).unwrap_or_default());
            (
                of_value,
                format!("{shown} will not do; it must be {wanted}"),
            )
        }
        (_, code @ ron::Error::MissingStructField { .. }) => (of_value, message(code, what)),
        (_, code) => (
            (error.span.start.line, error.span.start.col),
            message(code, what),
        ),
    };
    SceneError {
        file: file.to_owned(),
        at: Some(at),
        set: None,
        path: path.to_string(),
        message,
    }
}

/// The path to what ron cannot read.
pub fn path_of(text: &str, error: &SpannedError) -> Path {
    use ron::Error as E;
    // That a field is missing shows at the end of its struct.
    let place = match error.code {
        E::MissingStructField { .. } => error.span.end,
        _ => error.span.start,
    };
    let byte = byte_at(text, place.line, place.col);
    let mut path = path_at(text, byte);
    match &error.code {
        // What goes on wrongly behind a value is the value around it.
        E::ExpectedComma | E::ExpectedArrayEnd | E::ExpectedMapEnd | E::ExpectedStructLikeEnd => {
            path.0.pop();
        }
        E::MissingStructField { .. } if byte >= locate(text, &path).end => {
            path.0.pop();
        }
        E::NoSuchStructField { found, .. } => path = path.then(found.as_str()),
        _ => {}
    }
    path
}

/// What a value should be that is something else.
fn wanted(error: &ron::Error) -> Option<&'static str> {
    use ron::Error as E;
    match error {
        E::ExpectedFloat => Some("a number"),
        E::ExpectedInteger => Some("a whole number"),
        E::IntegerOutOfBounds => Some("a whole number that is neither negative nor huge"),
        E::ExpectedBoolean => Some("true or false"),
        E::ExpectedString => Some("a text in quotes"),
        E::ExpectedArray => Some("a list in square brackets, [ ]"),
        E::ExpectedDifferentLength { .. } => Some("two numbers, (x, y)"),
        E::ExpectedStructLike | E::ExpectedNamedStructLike(_) => {
            Some("something in round brackets, ( )")
        }
        _ => None,
    }
}

/// The text of a scene file.
pub fn text(file: &str) -> Result<String, SceneError> {
    let most = FILE_BYTES as u64;
    input::text(std::path::Path::new(file), most, "a scene is a page or two")
        .map_err(|error| unread(file, error))
}

/// Why a file with a scene is not read.
pub fn unread(file: &str, error: Unreadable) -> SceneError {
    let mut error = not_read(file, &error);
    if error.at.is_some() {
        error.message += "; a scene is written in RON";
    }
    error
}

/// Why a file is not read.
pub fn not_read(file: &str, error: &Unreadable) -> SceneError {
    SceneError {
        at: match error {
            Unreadable::NoText { line, column } => Some((*line, *column)),
            _ => None,
        },
        ..SceneError::whole(file, error.to_string())
    }
}

/// What is wrong with a file of another program.
pub fn of_file(file: &str, broken: Broken) -> SceneError {
    SceneError {
        at: broken.at,
        ..SceneError::whole(file, broken.message)
    }
}

/// What ron refuses in a text that begins at this line, after words about it.
pub fn refused(file: &str, line: usize, words: &str, error: &SpannedError) -> SceneError {
    let start = error.span.start;
    SceneError {
        at: Some((line + start.line - 1, start.col)),
        ..SceneError::whole(file, format!("{words}{}", plainly(&error.code)))
    }
}

/// ron's message, in words for an author who is no programmer where that helps.
fn message(error: &ron::Error, what: &str) -> String {
    use ron::Error as E;
    match error {
        E::NoSuchStructField {
            expected, found, ..
        } => format!(
            "there is no field {} here{} (fields: {})",
            quoted(found),
            did_you_mean(found, expected.iter().copied()),
            expected.join(", ")
        ),
        E::NoSuchEnumVariant {
            expected, found, ..
        } => format!(
            "{} is none of the choices{} (choices: {})",
            quoted(found),
            did_you_mean(found, expected.iter().copied()),
            expected.join(", ")
        ),
        E::MissingStructField { field, .. } => {
            format!("the field {field:?} is missing; it has no default")
        }
        E::DuplicateStructField { field, .. } => format!("the field {field:?} stands here twice"),
        E::ExpectedStructLike | E::ExpectedNamedStructLike(_) => {
            let second = if what == "scene" { "nodes" } else { "steps" };
            format!(
                "a {what} is a list of fields in round brackets, (title: \"...\", {second}: [...], ...)"
            )
        }
        E::SuggestRawIdentifier(found) | E::InvalidIdentifier(found)
            if found.starts_with(|c: char| c.is_ascii_digit()) =>
        {
            format!(
                "{} stands where a field's name should; decimals have a point, not a comma",
                quoted(found)
            )
        }
        E::ExceededRecursionLimit => format!("brackets are nested far too deep for a {what}"),
        E::Eof => "the file ends too early; a bracket or a quote is not closed".to_owned(),
        E::TrailingCharacters => {
            format!("something follows the end of the {what}, its closing bracket")
        }
        other => plainly(other),
    }
}

/// ron's own message, not longer than one can read.
pub fn plainly(error: &ron::Error) -> String {
    const MOST: usize = 300;
    let text = shown::cut(&error.to_string(), MOST);
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_lowercase().chain(letters).collect()
    })
}
