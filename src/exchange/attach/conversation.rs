//! A transcript: every line exchanged between debugger and solver, in order.
//!
//! The first line of such a file is [`SEALED_HEAD`]. Every other line starts with a character for its direction and a space: `>`
//! to the solver, `<` from the solver, `!` the solver's standard error, `#` other events (start, end). Messages are stored
//! verbatim, for people, scripts and [`TranscriptLine::read`]. Each line ends with its digest ([`crate::seal`]); files of earlier versions
//! start with just [`HEAD`] and have no digests.

use crate::FormatError;
use crate::seal;

/// Start of the first line.
pub const HEAD: &str = "# stickslip exchange 1";
/// The first line of a file whose lines have digests.
pub const SEALED_HEAD: &str = "# stickslip exchange 1, each line with its digest";

/// Error for a line whose digest does not match.
const CHANGED: &str = "the line was changed after it was written (its digest differs)";

/// Direction of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// To the solver.
    Asked,
    /// From the solver.
    Answered,
    /// To the solver's standard error.
    Logged,
    /// Another event.
    Noted,
}

impl Side {
    const ALL: [(Side, char); 4] = [
        (Side::Asked, '>'),
        (Side::Answered, '<'),
        (Side::Logged, '!'),
        (Side::Noted, '#'),
    ];

    fn sign(self) -> char {
        let sign = Side::ALL.iter().find(|(side, _)| *side == self);
        sign.map_or('#', |(_, sign)| *sign)
    }
}

/// Text of the event when a solver is started.
pub const STARTED: &str = "started";

/// A line of a transcript.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TranscriptLine {
    /// Direction.
    pub side: Side,
    /// Text without the line end.
    pub text: String,
}

impl TranscriptLine {
    /// The line of the file with its line end; several lines if the text has several.
    pub fn line(side: Side, text: &str) -> String {
        text.trim_end_matches(['\n', '\r'])
            .split('\n')
            .map(|line| seal::sealed(&format!("{} {line}", side.sign())) + "\n")
            .collect()
    }

    /// Whether a text is a transcript.
    pub fn is_one(text: &str) -> bool {
        matches!(text.lines().next(), Some(HEAD | SEALED_HEAD))
    }

    /// Reads a file. An incomplete last line (the writer was killed) is dropped.
    ///
    /// # Errors
    /// If the file is not a transcript, a line has no direction, or a line was changed after it was written.
    pub fn read(text: &str) -> Result<Vec<TranscriptLine>, FormatError> {
        if !TranscriptLine::is_one(text) {
            let message = format!("the first line of a transcript must begin with {HEAD:?}");
            return Err(FormatError::at(1, 1, message));
        }
        let are_sealed = text.starts_with(SEALED_HEAD);
        let whole = match text.rfind('\n') {
            Some(end) => &text[..end],
            None => text,
        };
        whole
            .lines()
            .enumerate()
            .skip(1)
            .map(|(number, line)| {
                let line = match are_sealed {
                    true => {
                        seal::opened(line).ok_or_else(|| FormatError::at(number + 1, 1, CHANGED))?
                    }
                    false => line,
                };
                let (sign, text) = line.split_at_checked(1).unwrap_or((line, ""));
                let side = Side::ALL
                    .iter()
                    .find(|(_, known)| sign.starts_with(*known))
                    .map(|(side, _)| *side)
                    .ok_or_else(|| {
                        FormatError::at(
                            number + 1,
                            1,
                            "a line must begin with >, <, ! or # and a space",
                        )
                    })?;
                let text = text.strip_prefix(' ').unwrap_or(text).to_owned();
                Ok(TranscriptLine { side, text })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transcript_is_read_back_without_its_incomplete_last_line() {
        let lines = [
            (Side::Noted, STARTED),
            (Side::Asked, "{\"type\":\"step\"}\n"),
            (Side::Answered, "{\"type\":\"ok\"}"),
            (Side::Logged, "Intel MKL FATAL ERROR"),
        ];
        let mut text = format!("{SEALED_HEAD}\n");
        lines
            .iter()
            .for_each(|(side, line)| text += &TranscriptLine::line(*side, line));
        let read = TranscriptLine::read(&text).expect("sound");
        assert_eq!(read.len(), 4);
        assert_eq!(
            (read[1].side, read[1].text.as_str()),
            (Side::Asked, "{\"type\":\"step\"}")
        );
        let torn = TranscriptLine::read(&(text + "< {\"type\":\"st")).expect("torn");
        assert_eq!(torn, read);
    }

    #[test]
    fn a_changed_digit_is_detected_and_a_file_without_digests_is_read() {
        let answer = "{\"type\":\"state\",\"f_n\":1.25}";
        let text = format!(
            "{SEALED_HEAD}\n{}",
            TranscriptLine::line(Side::Answered, answer)
        );
        assert_eq!(TranscriptLine::read(&text).expect("sound")[0].text, answer);
        let broken = TranscriptLine::read(&text.replace("1.25", "1.35")).expect_err("changed");
        assert_eq!(broken.at, Some((2, 1)));
        let bare = format!("{SEALED_HEAD}\n< {answer}\n");
        assert!(TranscriptLine::read(&bare).is_err());
        let old = TranscriptLine::read(&format!("{HEAD}\n< {answer}\n! a\t0123456789abcdef\n"));
        let texts: Vec<String> = old
            .expect("sound")
            .into_iter()
            .map(|kept| kept.text)
            .collect();
        assert_eq!(texts, [answer, "a\t0123456789abcdef"]);
    }

    #[test]
    fn every_line_of_a_text_has_its_direction() {
        let text = format!(
            "{SEALED_HEAD}\n{}",
            TranscriptLine::line(Side::Noted, "lost:\nall\n")
        );
        let read = TranscriptLine::read(&text).expect("sound");
        let texts: Vec<&str> = read.iter().map(|kept| kept.text.as_str()).collect();
        assert_eq!(texts, ["lost:", "all"]);
        assert!(read.iter().all(|kept| kept.side == Side::Noted));
    }

    #[test]
    fn other_files_are_not_transcripts() {
        assert!(TranscriptLine::read("Scene(").is_err());
        let broken = TranscriptLine::read(&format!("{HEAD}\n?\n")).expect_err("no sign");
        assert_eq!(broken.at, Some((2, 1)));
    }
}
