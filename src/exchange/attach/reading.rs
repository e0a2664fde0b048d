//! Converts messages to lines and back.
//!
//! An answer is parsed twice: first only its `type`, then the whole message as that type. This avoids an intermediate tree (a
//! state of 1,000 contacts is 0.3 MB), and errors have a path in the message and a column in the line.

use super::message::{Answer, MatrixMessage, Request};
use crate::FormatError;
use serde::de::{self, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;

/// Maximum number of characters of a message path in an error.
const MOST_PATH: usize = 60;
/// Maximum number of characters of serde's message.
const MOST_MESSAGE: usize = 300;
/// Spellings of non-finite numbers that languages write although JSON does not allow them.
const NO_NUMBERS: [&str; 6] = ["NaN", "nan", "Infinity", "inf", "Inf", "-Infinity"];

impl Request {
    /// The message as a line, with line feed.
    pub fn line(&self) -> String {
        line(self)
    }

    /// Parses a line.
    ///
    /// # Errors
    /// The error, with its column.
    pub fn read(line: &str) -> Result<Request, FormatError> {
        kind(line)?;
        body(line)
    }
}

impl Answer {
    /// The message as a line, with line feed.
    pub fn line(&self) -> String {
        line(self)
    }

    /// Parses a line.
    ///
    /// # Errors
    /// The error, with its column.
    pub fn read(line: &str) -> Result<Answer, FormatError> {
        Ok(match &*kind(line)? {
            "state" => Answer::State(body(line)?),
            "scene" => Answer::Scene(body(line)?),
            "problem" => Answer::Problem(body(line)?),
            "hello" => Answer::Hello(body(line)?),
            // The remaining messages are small or empty.
            _ => body(line)?,
        })
    }
}

/// Serialization can only fail for maps with non-text keys, which the messages do not have.
fn line(message: &impl Serialize) -> String {
    let text = serde_json::to_string(message);
    text.unwrap_or_default() + "\n"
}

/// The `type` of a message.
fn kind(line: &str) -> Result<Cow<'_, str>, FormatError> {
    // serde would also take a list of the values.
    if line.trim_start().starts_with('[') {
        return Err(FormatError::at(1, 1, "a message is an object, { }"));
    }
    #[derive(Deserialize)]
    struct Kind<'a> {
        #[serde(rename = "type", borrow)]
        kind: Cow<'a, str>,
    }
    body::<Kind<'_>>(line).map(|message| message.kind)
}

fn body<'a, T: Deserialize<'a>>(line: &'a str) -> Result<T, FormatError> {
    serde_json::from_str(line).map_err(|error| {
        // The path is only computed for errors; a message that ends too early has no meaningful path.
        let mut again = serde_json::Deserializer::from_str(line);
        let found = serde_path_to_error::deserialize::<_, T>(&mut again).err();
        let path = found.filter(|_| !error.is_eof());
        broken(
            line,
            &path
                .map(|found| found.path().to_string())
                .unwrap_or_default(),
            &error,
        )
    })
}

/// Converts a serde error to one with the message path and the column.
fn broken(line: &str, path: &str, error: &serde_json::Error) -> FormatError {
    let message = error.to_string();
    // The position is reported separately.
    let mut message = message
        .split(" at line ")
        .next()
        .unwrap_or(&message)
        .to_owned();
    // serde_json counts columns in bytes.
    let at = error.column().saturating_sub(1).min(line.len());
    let mut at = (0..=at)
        .rev()
        .find(|&at| line.is_char_boundary(at))
        .unwrap_or(0);
    // For text that starts like null, serde_json reports the error one letter later.
    let letters = line[..at].trim_end_matches(|c: char| c.is_ascii_alphanumeric() || c == '-');
    if NO_NUMBERS
        .iter()
        .any(|none| line[letters.len()..].starts_with(none))
    {
        message = "JSON has no NaN and infinity; write null instead".to_owned();
        at = letters.len();
    }
    message = plainly(&message);
    let path = beginning(path, MOST_PATH);
    // serde_path_to_error writes ? where the error is in a key.
    if !["", ".", "?"].contains(&path.as_str()) {
        message = format!("{path}: {message}");
    }
    match error.column() {
        0 => FormatError::whole(message),
        _ => FormatError::at(error.line().max(1), line[..at].chars().count() + 1, message),
    }
}

/// serde's message in the words of JSON instead of those of Rust, at a readable length.
fn plainly(message: &str) -> String {
    let (found, expected) = match message.split_once(", expected ") {
        Some((found, expected)) if !found.starts_with("unknown") => (found, Some(expected)),
        _ => (message, None),
    };
    let Some(expected) = expected else {
        return beginning(found, MOST_MESSAGE);
    };
    let found = found
        .trim_start_matches("invalid type: ")
        .trim_start_matches("invalid value: ");
    // The value stands in backquotes: integer `3`.
    let value = ["integer `", "floating point `", "boolean `"]
        .iter()
        .find_map(|kind| found.strip_prefix(kind)?.strip_suffix('`'));
    let found = match (value.unwrap_or(found), found.strip_prefix("string ")) {
        (_, Some(text)) => text,
        ("sequence", _) => "a list",
        ("map", _) => "an object",
        (value, _) => value,
    };
    let expected = match expected {
        "u32" | "u64" | "usize" => "a whole number from 0",
        "i64" => "a whole number",
        "f64" | "f32" => "a number",
        "a string" | "string or map" => "a text",
        "a boolean" => "true or false",
        "a sequence" => "a list",
        "a map" => "an object",
        rust if rust.starts_with("struct ") || rust.starts_with("internally tagged") => "an object",
        tuple if tuple.starts_with("a tuple of size ") => {
            &tuple.replace("a tuple of size", "a list of")
        }
        other => other,
    };
    format!(
        "{} is not valid; expected {expected}",
        beginning(found, MOST_PATH)
    )
}

/// The first characters of a text.
fn beginning(text: &str, most: usize) -> String {
    let mut letters = text.chars();
    let begun: String = letters.by_ref().take(most).collect();
    match letters.next() {
        Some(_) => begun + "…",
        None => begun,
    }
}

impl<'de> Deserialize<'de> for MatrixMessage {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<MatrixMessage, D::Error> {
        from.deserialize_any(MatrixReader)
    }
}

/// Reads a matrix, possibly with millions of numbers, directly from the stream.
struct MatrixReader;

impl<'de> Visitor<'de> for MatrixReader {
    type Value = MatrixMessage;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("rows of numbers, or an object with size and triplets")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, rows: A) -> Result<MatrixMessage, A::Error> {
        Deserialize::deserialize(de::value::SeqAccessDeserializer::new(rows))
            .map(MatrixMessage::Rows)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<MatrixMessage, A::Error> {
        #[derive(Deserialize)]
        struct Sparse {
            size: usize,
            triplets: Vec<(usize, usize, f64)>,
        }
        let Sparse { size, triplets } =
            Deserialize::deserialize(de::value::MapAccessDeserializer::new(map))?;
        Ok(MatrixMessage::Triplets { size, triplets })
    }
}

#[cfg(test)]
mod tests {
    use super::super::message::*;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn infinite_and_missing_numbers_are_null_and_read_as_none() {
        let norms = NormsMessage {
            relative: number(f64::INFINITY),
            force: number(-0.0),
            ..NormsMessage::default()
        };
        let text = line(&norms);
        assert_eq!(text, "{\"relative\":null,\"force\":-0.0}\n");
        let back: NormsMessage = body(&text).expect("its own text");
        assert_eq!(back.relative, None);
        assert_eq!(back.force.map(f64::to_bits), Some((-0.0_f64).to_bits()));
    }

    #[test]
    fn invalid_json_is_reported_with_its_column() {
        for (none, column) in [("NaN", 25), ("Infinity", 25), ("nan", 25)] {
            let text = format!(r#"{{"type":"saved","token":{none}}}"#);
            let broken = Answer::read(&text).expect_err(none);
            assert_eq!(broken.at, Some((1, column)), "{broken}");
            assert!(broken.message.contains("null"), "{broken}");
        }
        let broken = Answer::read(r#"{"type":"sawed"}"#).expect_err("no such message");
        assert!(broken.message.contains("sawed"), "{broken}");
        let broken = Answer::read(r#"{"type":"ok"} ok"#).expect_err("two messages");
        assert!(broken.at.is_some(), "{broken}");
    }

    #[test]
    fn errors_have_a_path_in_the_message() {
        let text = r#"{"type":"state","at":{"increment":1},"ended":"iteration","contacts":[{"id":1,"mode":"free","next":"free","gap":0.5}]}"#;
        assert!(Answer::read(text).is_ok());
        for (that, this, told) in [
            (
                r#""increment":1"#,
                r#""increment":null"#,
                "at.increment: null is not valid; expected a whole number from 0",
            ),
            (
                r#""increment":1"#,
                r#""increment":-1"#,
                "at.increment: -1 is not valid; expected a whole number from 0",
            ),
            (
                "0.5",
                r#""much""#,
                r#"contacts[0].gap: "much" is not valid; expected a number"#,
            ),
            ("0.5", "1e999", "contacts[0].gap: number out of range"),
            (
                r#""free""#,
                r#""open""#,
                "contacts[0].mode: unknown variant `open`",
            ),
            (
                r#""id":1"#,
                r#""id":1.5"#,
                "contacts[0].id: an id is a whole number or a text",
            ),
            (
                r#""gap":0.5"#,
                r#""gap":0.5,"gap":1"#,
                "contacts[0]: duplicate field `gap`",
            ),
            (
                r#"{"type":"state","#,
                r#"{"type":"state","type":"ok","#,
                "duplicate field `type`",
            ),
            (r#"0.5}]}"#, "0.5}]", "EOF while parsing an object"),
        ] {
            let changed = text.replacen(that, this, 1);
            let broken = Answer::read(&changed).expect_err(&changed);
            assert!(broken.message.starts_with(told), "{broken}");
            let (_, column) = broken.at.expect("a column");
            let from = changed.find(this).expect("it stands there") + 1;
            assert!(
                (from..=from + this.len()).contains(&column),
                "{broken} at {column} of {changed}"
            );
        }
        let broken = Answer::read(&text.replace("contacts", "contact")).expect_err("no contacts");
        assert!(
            broken.message.starts_with("missing field `contacts`"),
            "{broken}"
        );
    }

    #[test]
    fn a_request_is_an_object_and_its_faults_have_no_words_of_rust() {
        for (text, told) in [
            (r#"["step"]"#, "a message is an object, { }"),
            ("3", "3 is not valid; expected an object"),
            (r#"{"type":5}"#, "type: 5 is not valid; expected a text"),
            (
                r#"{"type":"hello","protocol":1e99}"#,
                "1e+99 is not valid; expected a whole number from 0",
            ),
            (
                r#"{"type":"force","contact":1,"mode":"free","hold":"yes"}"#,
                "\"yes\" is not valid; expected true or false",
            ),
            (r#"{"type":"step"} {"#, "trailing characters"),
            (r#"{"type":"step"; }"#, "expected `,` or `}`"),
        ] {
            let broken = Request::read(text).expect_err(text);
            assert_eq!(broken.message, told);
        }
        let long = format!(r#"{{"type":"{}"}}"#, "x".repeat(20_000));
        let broken = Request::read(&long).expect_err("no such request");
        assert!(broken.message.chars().count() < 400, "{broken}");
    }

    #[test]
    fn excessive_nesting_is_rejected_or_skipped() {
        let deep = |depth: usize| "[".repeat(depth) + &"]".repeat(depth);
        let token = |depth| format!(r#"{{"type":"saved","token":{}}}"#, deep(depth));
        assert!(Answer::read(&token(50)).is_ok());
        let broken = Answer::read(&token(100_000)).expect_err("too deep");
        assert!(broken.message.contains("recursion"), "{broken}");
        let unknown = format!(
            r#"{{"type":"hello","protocol":1,"name":"a","deep":{}}}"#,
            deep(100_000)
        );
        assert!(
            Answer::read(&unknown).is_ok(),
            "what is not named is passed over"
        );
    }

    #[test]
    fn an_id_is_a_number_or_a_text() {
        let text = r#"{"type":"release","contact":"a.1"}"#;
        let request = Request::read(text).expect("sound");
        assert_eq!(request.line().trim_end(), text);
        let text = r#"{"type":"release","contact":-3}"#;
        assert_eq!(Request::read(text).expect("sound").line().trim_end(), text);
    }

    #[test]
    fn a_vector_has_one_to_three_components() {
        let read = |text: &str| serde_json::from_str::<Components>(text);
        for text in ["0.5", "[0.5,-1.0]", "[1.0,0.0,1e-300]"] {
            assert_eq!(line(&read(text).expect(text)).trim_end(), text);
        }
        assert_eq!(read("[3,4]").expect("two").size(), 5.0);
        for text in ["[]", "[1]", "[1,2,3,4]", "[1,null]", "\"1\"", "[1e999,0]"] {
            assert!(read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_matrix_is_rows_or_triplets() {
        let problem = |matrix: &str| {
            Answer::read(&format!(
                r#"{{"type":"problem","contacts":[1],"kind":"stiffness","matrix":{matrix},"q":[0,0],"mu":[0]}}"#
            ))
        };
        for matrix in [
            "[[1.0,0.0],[0.0,1.0]]",
            r#"{"size":2,"triplets":[[0,0,1.5]]}"#,
        ] {
            let answer = problem(matrix).expect("sound");
            assert!(answer.line().contains(matrix), "{}", answer.line());
        }
        for (matrix, told) in [
            ("[[1,0],[0,null]]", "matrix[1][1]: null is not valid"),
            ("3", "matrix: 3 is not valid; expected rows of numbers"),
            (r#"{"size":2}"#, "matrix: missing field `triplets`"),
        ] {
            let broken = problem(matrix).expect_err(matrix);
            assert!(broken.message.starts_with(told), "{broken}");
        }
    }

    fn mode() -> impl Strategy<Value = Mode> {
        prop_oneof![Just(Mode::Free), Just(Mode::Sliding), Just(Mode::Fixed)]
    }

    fn float() -> impl Strategy<Value = Option<f64>> {
        any::<u64>().prop_map(|bits| number(f64::from_bits(bits)))
    }

    fn slip(x: Option<f64>, in_space: bool) -> Option<Components> {
        x.map(|x| match in_space {
            true => Components::Two([x, -x]),
            false => Components::One(x),
        })
    }

    prop_compose! {
        fn contact()(
            id in prop_oneof![any::<i64>().prop_map(Id::Number), ".{0,6}".prop_map(Id::Text)],
            modes in (mode(), mode()),
            numbers in [float(), float(), float(), float(), float(), float()],
            rule in ".{0,8}",
            over in any::<bool>(),
            in_space in any::<bool>(),
        ) -> ContactResult {
            ContactResult {
                id: Some(id),
                mode: modes.0,
                next: modes.1,
                gap: numbers[0],
                f_n: numbers[1],
                f_t: numbers[2].map(Components::One),
                limit: numbers[3],
                slip: slip(numbers[4], in_space),
                rule,
                margin: numbers[5],
                tests: Vec::new(),
                wanted: None,
                limit_used: None,
                drift: None,
                normal: None,
                tangent: in_space.then_some(Components::Three([1.0, 0.0, 0.0])),
                foot: None,
                corner: None,
                carried: [over, false],
                forced: None,
                over,
            }
        }
    }

    prop_compose! {
        fn state()(
            contacts in prop::collection::vec(contact(), 0..4),
            counts in any::<[u32; 4]>(),
            numbers in [float(), float()],
            reason in ".{0,12}",
        ) -> Answer {
            let [increment, attempt, major, minor] = counts;
            Answer::State(Box::new(State {
                at: Position { increment, attempt, major, minor },
                load: numbers[0],
                ended: EndedLevel::Iteration,
                reason,
                size: numbers[1],
                contacts,
                residual: NormsMessage { relative: numbers[0], ..NormsMessage::default() },
                after: None,
                displacements: None,
                spring: None,
                monitors: numbers.to_vec(),
                arc: None,
                drag: None,
            }))
        }
    }

    proptest! {
        #[test]
        fn floats_keep_their_bits(bits in any::<u64>()) {
            let x = f64::from_bits(bits);
            let text = line(&number(x));
            let back: Option<f64> = body(&text).expect("its own text");
            prop_assert_eq!(back.map(f64::to_bits), x.is_finite().then_some(bits));
        }

        #[test]
        fn a_state_survives_a_round_trip(state in state()) {
            prop_assert_eq!(Answer::read(&state.line()), Ok(state));
        }

        #[test]
        fn a_damaged_line_is_read_or_rejected_with_a_valid_column(
            state in state(),
            place in any::<prop::sample::Index>(),
            damage in prop_oneof![Just(""), Just("\""), Just("}"), Just("]"), Just("NaN"), Just("é"), Just("\u{0}"), Just("-")],
        ) {
            let text = state.line();
            let text = text.trim_end();
            let letters: Vec<char> = text.chars().collect();
            let place = place.index(letters.len());
            let (before, after) = (&letters[..place], &letters[place + 1..]);
            let damaged = before.iter().chain(&damage.chars().collect::<Vec<_>>()).chain(after).collect::<String>();
            if let Err(broken) = Answer::read(&damaged) {
                let count = damaged.chars().count();
                prop_assert!(!broken.message.is_empty());
                prop_assert!(broken.at.is_none_or(|(line, column)| line == 1 && column <= count + 1), "{:?}", broken);
            }
        }

        #[test]
        fn a_state_is_completed_to_the_contacts_of_the_scene_or_rejected(
            mut before in prop::collection::vec(contact(), 0..4),
            sent in prop::collection::vec(contact(), 0..4),
            kept in prop::collection::vec(any::<bool>(), 4),
        ) {
            // A scene names each contact once.
            let ids: Vec<Id> = (0..).take(before.len()).map(Id::Number).collect();
            for (found, id) in before.iter_mut().zip(&ids) {
                found.id = Some(id.clone());
            }
            let Answer::State(mut state) = Answer::read(r#"{"type":"state","at":{"increment":1},"ended":"iteration","contacts":[]}"#).expect("sound") else {
                panic!("a state");
            };
            // A part of the contacts in their order is completed; others are not of this scene.
            state.contacts = before.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(found, _)| found.clone()).collect();
            let rows = state.contacts.len();
            let all = state.complete(&ids, &before).expect("in order");
            prop_assert_eq!(all.len(), before.len());
            let unchanged = all.iter().zip(&kept).filter(|(_, kept)| !**kept);
            prop_assert!(unchanged.clone().all(|(found, _)| found.mode == found.next));
            prop_assert_eq!(unchanged.count() + rows, before.len());
            state.contacts = sent;
            if state.complete(&ids, &before).is_ok() {
                prop_assert!(state.contacts.len() >= ids.len());
            }
        }

        #[test]
        fn no_line_makes_the_reader_panic(text in ".{0,200}") {
            let _ = Answer::read(&text);
            let _ = Request::read(&text);
        }
    }
}
