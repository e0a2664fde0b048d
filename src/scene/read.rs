//! From the text of a file to a [`Spec`]: syntax and types, with the place of what is wrong.

use super::condensed::Problem;
use super::error::{Path, SceneError, Step, did_you_mean, shortened};
use super::limits;
use super::locate::{line_and_column, locate};
use super::spec::Spec;
use ron::error::SpannedError;
use ron::extensions::Extensions;
use serde::de::DeserializeOwned;
use serde_path_to_error::Segment;
use std::io::Read;

/// How scene files are read and written: `Some` may be left out.
pub fn options() -> ron::Options {
    // The recursion limit is ron's own (128), spelled out because the stack depends on it.
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_recursion_limit(128)
}

/// Reads a scene's text.
pub(crate) fn spec(file: &str, text: &str) -> Result<Spec, SceneError> {
    value(file, text, "scene")
}

/// Reads an interface problem's text.
pub(crate) fn problem(file: &str, text: &str) -> Result<Problem, SceneError> {
    value(file, text, "scene")
}

/// Reads the text of a file that holds one value; messages call it a `what`.
pub(crate) fn value<T: DeserializeOwned>(
    file: &str,
    text: &str,
    what: &str,
) -> Result<T, SceneError> {
    let options = options();
    let unread = |error: SpannedError, path: &Path| unreadable(file, text, what, &error, path);
    let mut reader = ron::Deserializer::from_str_with_options(text, &options)
        .map_err(|e| unread(e, &Path::default()))?;
    let value = serde_path_to_error::deserialize::<_, T>(&mut reader).map_err(|e| {
        let path = plain(e.path());
        unread(reader.span_error(e.into_inner()), &path)
    })?;
    reader
        .end()
        .map_err(|e| unread(reader.span_error(e), &Path::default()))?;
    Ok(value)
}

/// ron's error in our form.
fn unreadable(file: &str, text: &str, what: &str, error: &SpannedError, path: &Path) -> SceneError {
    let value = locate(text, path);
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
pub(crate) fn text(file: &str) -> Result<String, SceneError> {
    let whole = |message: String| SceneError::whole(file, message);
    let mut bytes = Vec::new();
    let most = limits::FILE_BYTES as u64;
    std::fs::File::open(file)
        .and_then(|open| open.take(most + 1).read_to_end(&mut bytes))
        .map_err(|e| whole(format!("the file cannot be read: {e}")))?;
    from_bytes(file, bytes)
}

/// A scene's text from the bytes of its file.
pub(crate) fn from_bytes(file: &str, bytes: Vec<u8>) -> Result<String, SceneError> {
    if bytes.len() > limits::FILE_BYTES {
        let most = limits::FILE_BYTES >> 20;
        return Err(SceneError::whole(
            file,
            format!("the file has more than {most} MiB; a scene is a page or two"),
        ));
    }
    let text = String::from_utf8(bytes).map_err(|e| {
        let good =
            String::from_utf8_lossy(&e.as_bytes()[..e.utf8_error().valid_up_to()]).into_owned();
        SceneError {
            at: Some(line_and_column(&good, good.len())),
            ..SceneError::whole(
                file,
                "the file is not text in UTF-8; a scene is written in RON",
            )
        }
    })?;
    // Some editors begin a file with a mark that RON does not know.
    Ok(text
        .strip_prefix('\u{feff}')
        .map(str::to_owned)
        .unwrap_or(text))
}

/// The path without names of variants.
fn plain(path: &serde_path_to_error::Path) -> Path {
    let step = |segment: &Segment| match segment {
        Segment::Seq { index } => Some(Step::Index(*index)),
        Segment::Map { key } => Some(Step::Key(key.clone())),
        Segment::Enum { .. } | Segment::Unknown => None,
    };
    Path(path.iter().filter_map(step).collect())
}

/// ron's message, in words for an author who is no programmer where that helps.
fn message(error: &ron::Error, what: &str) -> String {
    use ron::Error as E;
    match error {
        E::NoSuchStructField {
            expected, found, ..
        } => format!(
            "there is no field {found:?} here{} (fields: {})",
            did_you_mean(found, expected.iter().copied()),
            expected.join(", ")
        ),
        E::NoSuchEnumVariant {
            expected, found, ..
        } => format!(
            "{found:?} is none of the choices{} (choices: {})",
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
                "{found:?} stands where a field's name should; decimals have a point, not a comma"
            )
        }
        E::ExceededRecursionLimit => format!("brackets are nested far too deep for a {what}"),
        E::Eof => "the file ends too early; a bracket or a quote is not closed".to_owned(),
        E::TrailingCharacters => {
            format!("something follows the end of the {what}, its closing bracket")
        }
        other => {
            let text = other.to_string();
            let mut letters = text.chars();
            letters.next().map_or_else(String::new, |first| {
                first.to_lowercase().chain(letters).collect()
            })
        }
    }
}
