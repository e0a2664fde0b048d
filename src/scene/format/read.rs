//! Reads the text of a file into a [`Spec`]; errors of syntax and type have a location.

use super::condensed::Problem;
use super::error::{Path, SceneError, Step, did_you_mean, quoted, shortened};
use super::locate::{byte_at, line_and_column, locate, path_at, too_deep};
use super::notation;
use super::spec::Spec;
use crate::shown;
use ron::error::SpannedError;
use serde::de::DeserializeOwned;
use std::borrow::Cow;
use stickslip_exchange::FormatError;
use stickslip_platform::input::{self, Unreadable};

/// Maximum size of a scene file in bytes: enough for a dense matrix of 2,500 contacts with all digits.
pub const FILE_BYTES: usize = 512 << 20;

/// Reads a scene from its text.
pub fn spec(file: &str, text: &str) -> Result<Spec, SceneError> {
    value(file, text, "scene")
}

/// Reads an interface problem from its text.
pub(crate) fn problem(file: &str, text: &str) -> Result<Problem, SceneError> {
    value(file, text, "scene")
}

/// Reads a file that contains one value; messages call it a `what`.
pub fn value<T: DeserializeOwned>(file: &str, text: &str, what: &str) -> Result<T, SceneError> {
    shallow(file, text, what)?;
    let mut read = notation::read(text);
    // `none`, as the manual writes an absent value, is RON's `None`.
    let mut spelt = Cow::Borrowed(text);
    while let Err(error) = &read
        && let absent = locate(&spelt, &path_of(&spelt, error))
        && spelt.get(absent.clone()) == Some("none")
    {
        spelt.to_mut().replace_range(absent, "None");
        read = notation::read(&spelt);
    }
    read.map_err(|error| unreadable(file, text, what, &error))
}

/// Rejects a text whose brackets are nested deeper than in any valid file; messages call it a `what`.
pub fn shallow(file: &str, text: &str, what: &str) -> Result<(), SceneError> {
    match too_deep(text) {
        None => Ok(()),
        Some(byte) => Err(SceneError {
            at: Some(line_and_column(text, byte)),
            ..SceneError::whole(file, format!("brackets are nested too deeply for a {what}"))
        }),
    }
}

/// Converts an error of ron.
fn unreadable(file: &str, text: &str, what: &str, error: &SpannedError) -> SceneError {
    let path = path_of(text, error);
    let value = locate(text, &path);
    let of_value = line_and_column(text, value.start);
    let cursor = (error.span.start.line, error.span.start.col);
    // If a whole value is wrong, report its start. Otherwise report ron's cursor: the start of its span is closer to the error
    // than the end.
    let (at, message) = match (brackets(text, error), expected(text, error, what)) {
        (Some(message), _) => (cursor, message),
        (_, Some(_)) if is_at_end(text, error) => (cursor, message(&ron::Error::Eof, what)),
        (_, Some(wanted)) if !path.0.is_empty() => {
            let shown = shortened(text.get(value).unwrap_or_default());
            let message = match shown.as_str() {
                "" => format!("{wanted} is missing"),
                _ => format!("{shown} is not valid; it must be {wanted}"),
            };
            (of_value, message)
        }
        _ => match &error.code {
            code @ ron::Error::MissingStructField { .. } => (of_value, message(code, what)),
            code => (cursor, message(code, what)),
        },
    };
    SceneError {
        file: file.to_owned(),
        at: Some(at),
        set: None,
        path: path.to_string(),
        message,
    }
}

/// What to write instead of a variant without its fields, or with brackets but without fields.
fn brackets(text: &str, error: &SpannedError) -> Option<String> {
    use ron::Error as E;
    let start = error.span.start;
    let (before, after) = text.split_at_checked(byte_at(text, start.line, start.col))?;
    let is_letter = |c: char| c.is_alphanumeric() || c == '_';
    let word = &before[before.trim_end_matches(is_letter).len()..];
    match error.code {
        _ if !word.starts_with(char::is_uppercase) => None,
        E::ExpectedComma if after.starts_with('(') => {
            Some(format!("{word} has no fields; write it without brackets"))
        }
        E::ExpectedStructLike | E::ExpectedNamedStructLike(_) => Some(format!(
            "{word} needs its fields in round brackets: {word}(...)"
        )),
        _ => None,
    }
}

/// The path to the text that ron cannot read.
fn path_of(text: &str, error: &SpannedError) -> Path {
    use ron::Error as E;
    // A missing field is detected at the end of its struct.
    let place = match error.code {
        E::MissingStructField { .. } => error.span.end,
        _ => error.span.start,
    };
    let byte = byte_at(text, place.line, place.col);
    let mut path = path_at(text, byte);
    match &error.code {
        _ if half_read(text, byte).is_some() => {}
        // An error after a value concerns the enclosing value.
        E::ExpectedComma | E::ExpectedArrayEnd | E::ExpectedMapEnd | E::ExpectedStructLikeEnd => {
            path.0.pop();
        }
        E::MissingStructField { .. } if byte >= locate(text, &path).end => {
            path.0.pop();
        }
        E::NoSuchStructField { found, .. } => path = path.then(found.as_str()),
        _ => {}
    }
    // Behind a trailing comma there is no value.
    if let Some((Step::Index(_), enclosing)) = path.0.split_last() {
        let enclosing = Path(enclosing.to_vec());
        if locate(text, &enclosing) == locate(text, &path) {
            path = enclosing;
        }
    }
    path
}

/// Whether the file ends where a value was expected.
fn is_at_end(text: &str, error: &SpannedError) -> bool {
    let start = error.span.start;
    let rest = text.get(byte_at(text, start.line, start.col)..);
    start.col + start.line > 2 && rest.is_some_and(|rest| rest.trim().is_empty())
}

/// The kind of value that was expected, if ron has read only the beginning of a word as a number, up to here: `3.0` is not a whole
/// number, and `3mm` is not a number.
fn half_read(text: &str, byte: usize) -> Option<&'static str> {
    let (before, after) = text.split_at_checked(byte)?;
    let is_number = before.ends_with(|c: char| c.is_ascii_digit());
    match after.chars().next().filter(|_| is_number)? {
        '.' => Some("a whole number"),
        letter if letter.is_alphanumeric() => Some("a number"),
        _ => None,
    }
}

/// Whether a value begins here, and not the name of a field: after a colon, or in a list.
fn is_value(text: &str, byte: usize) -> bool {
    let mut path = path_at(text, byte);
    let begins = locate(text, &path).start >= byte;
    let in_list = begins && matches!(path.0.pop(), Some(Step::Index(_))) && {
        let list = locate(text, &path);
        text.get(list).is_some_and(|list| list.starts_with('['))
    };
    in_list
        || text
            .get(..byte)
            .unwrap_or_default()
            .trim_end()
            .ends_with(':')
}

/// The kind of value that ron expected.
fn kind(error: &ron::Error) -> Option<&'static str> {
    use ron::Error as E;
    Some(match error {
        E::ExpectedFloat => "a number",
        E::ExpectedInteger | E::InvalidIntegerDigit { .. } => "a whole number",
        E::IntegerOutOfBounds => "a whole number that is neither negative nor huge",
        E::ExpectedBoolean => "true or false",
        E::ExpectedString => "a text in quotes",
        E::ExpectedArray => "a list in square brackets, [ ]",
        _ => return None,
    })
}

/// What was expected instead of the value.
fn expected(text: &str, error: &SpannedError, what: &str) -> Option<&'static str> {
    use ron::Error as E;
    let start = error.span.start;
    let byte = byte_at(text, start.line, start.col);
    match &error.code {
        code if kind(code).is_some() => kind(code),
        E::ExpectedDifferentLength { expected, .. } if expected.ends_with('3') => {
            Some("three values, (a, b, c)")
        }
        // Pairs of a scene are points.
        E::ExpectedDifferentLength { .. } if what == "scene" => Some("two numbers, (x, y)"),
        E::ExpectedDifferentLength { .. } => Some("two values, (a, b)"),
        E::ExpectedStructLike | E::ExpectedNamedStructLike(_) => {
            Some("a value in round brackets, ( )")
        }
        E::ExpectedIdentifier | E::SuggestRawIdentifier(_) | E::InvalidIdentifier(_) => {
            is_value(text, byte).then_some("a name without quotes")
        }
        E::ExpectedComma | E::ExpectedArrayEnd | E::ExpectedStructLikeEnd => half_read(text, byte),
        _ => None,
    }
}

/// What a scene file that is no text should be.
pub const SCENE: &str = "a scene is written in RON";

/// The text of a file; `wanted` says what it should be, if it is no text.
///
/// # Errors
/// If it cannot be read, or is no text.
pub fn text(file: &str, wanted: &str) -> Result<String, SceneError> {
    let most = FILE_BYTES as u64;
    input::text(std::path::Path::new(file), most, "a scene is a page or two")
        .map_err(|error| unread(file, error, wanted))
}

/// Error for a file that cannot be read, or is no text; then `wanted` says what it should be.
pub fn unread(file: &str, error: Unreadable, wanted: &str) -> SceneError {
    let mut error = not_read(file, &error);
    if error.at.is_some() {
        error.message += &format!("; {wanted}");
    }
    error
}

/// Error for a file that cannot be read.
pub fn not_read(file: &str, error: &Unreadable) -> SceneError {
    SceneError {
        at: match error {
            Unreadable::NoText { line, column } => Some((*line, *column)),
            _ => None,
        },
        ..SceneError::whole(file, error.to_string())
    }
}

/// Error in a file of another program.
pub fn of_file(file: &str, broken: FormatError) -> SceneError {
    SceneError {
        at: broken.at,
        ..SceneError::whole(file, broken.message)
    }
}

/// Error of ron in a text that starts at this line, with an introduction.
pub fn refused(file: &str, line: usize, words: &str, error: &SpannedError) -> SceneError {
    let start = error.span.start;
    SceneError {
        at: Some((line + start.line - 1, start.col)),
        ..SceneError::whole(file, format!("{words}{}", plainly(&error.code)))
    }
}

/// ron's message, rephrased for authors who are not programmers where that helps.
fn message(error: &ron::Error, what: &str) -> String {
    use ron::Error as E;
    match error {
        E::ExpectedStructLike | E::ExpectedNamedStructLike(_) => {
            let fields = match what {
                "scene" => "title: \"...\", nodes: [...]",
                "study" => "title: \"...\", vary: [...]",
                "configuration" => "colours: dark, mouse: false",
                _ => "title: \"...\", steps: [...]",
            };
            format!("a {what} is a list of fields in round brackets, ({fields}, ...)")
        }
        E::ExpectedStructLikeEnd => {
            "expected a closing bracket, ); there are too many values, or it is missing".to_owned()
        }
        E::ExpectedIdentifier => "expected the name of a field, without quotes".to_owned(),
        E::ExpectedMapColon => "expected a colon after the name of the field".to_owned(),
        E::SuggestRawIdentifier(found) | E::InvalidIdentifier(found)
            if found.starts_with(|c: char| c.is_ascii_digit()) =>
        {
            format!(
                "{} is not a field name; decimals are written with a point, not a comma",
                quoted(found)
            )
        }
        E::SuggestRawIdentifier(found) | E::InvalidIdentifier(found) => {
            format!("{} is not a field name", quoted(found))
        }
        E::ExceededRecursionLimit => format!("brackets are nested too deeply for a {what}"),
        E::ExpectedComma => "expected comma or closing bracket".to_owned(),
        E::Eof | E::ExpectedStringEnd => {
            "the file ends too early; a bracket or a quote is not closed".to_owned()
        }
        E::TrailingCharacters => {
            format!("unexpected text after the closing bracket of the {what}")
        }
        other => plainly(other),
    }
}

/// ron's message in words that do not name types of this program, shortened to a readable length.
pub fn plainly(error: &ron::Error) -> String {
    use ron::Error as E;
    const MOST: usize = 300;
    match error {
        E::NoSuchStructField {
            expected, found, ..
        } => format!(
            "unknown field {}{} (fields: {})",
            quoted(found),
            did_you_mean(found, expected.iter().copied()),
            expected.join(", ")
        ),
        E::NoSuchEnumVariant {
            expected, found, ..
        } => format!(
            "{} is not one of the choices{} (choices: {})",
            quoted(found),
            did_you_mean(found, expected.iter().copied()),
            expected.join(", ")
        ),
        E::MissingStructField { field, .. } => {
            format!("the field {field:?} is missing; it has no default")
        }
        E::DuplicateStructField { field, .. } => format!("the field {field:?} is given twice"),
        E::ExpectedStructLike | E::ExpectedNamedStructLike(_) => {
            "a value in round brackets, ( ), was expected".to_owned()
        }
        E::ExpectedDifferentStructName { found, .. } => format!(
            "found {} where a value in round brackets, ( ), or a closing bracket was expected",
            quoted(found)
        ),
        E::ExpectedDifferentLength { expected, found } => {
            let count = expected.rsplit(' ').next().unwrap_or_default();
            format!("expected {count} values in round brackets, found {found}")
        }
        E::InvalidValueForType { expected, found } => {
            let found = found
                .replace("a sequence", "a list")
                .replace("a map", "a value in braces, { }");
            format!("expected {expected}, found {}", shortened(&found))
        }
        other => match kind(other) {
            Some(kind) => format!("expected {kind}"),
            None => {
                let text = shown::cut(&other.to_string(), MOST);
                let mut letters = text.chars();
                letters
                    .next()
                    .map(|first| first.to_lowercase().chain(letters).collect())
                    .unwrap_or_default()
            }
        },
    }
}
