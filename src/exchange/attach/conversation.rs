//! A kept exchange: every line that went between debugger and solver, in order.
//!
//! The first line of such a file is [`HEAD`]; each other one begins with a sign that says where it went, and a blank: `>` to
//! the solver, `<` from it, `!` what it wrote to its standard error, `#` what happened besides (it was started, it ended).
//! Messages stand there as they went, so that the file can be read by eye, by a script, and by [`Kept::read`].

use crate::broken::Broken;

/// The first line.
pub const HEAD: &str = "# stickslip exchange 1";

/// Where a line went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// To the solver.
    Asked,
    /// From the solver.
    Answered,
    /// To the solver's standard error.
    Logged,
    /// Something happened.
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

/// What is noted where a solver was started.
pub const STARTED: &str = "started";

/// A line of a kept exchange.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kept {
    /// Where it went.
    pub side: Side,
    /// What it says, without its end.
    pub text: String,
}

impl Kept {
    /// The line of a file, with its end; several where the text has several.
    pub fn line(side: Side, text: &str) -> String {
        let text = text.trim_end_matches(['\n', '\r']);
        let mut whole = String::with_capacity(text.len() + 3);
        for line in text.split('\n') {
            whole.extend([side.sign(), ' ']);
            whole += line;
            whole.push('\n');
        }
        whole
    }

    /// Whether a text is a kept exchange.
    pub fn is_one(text: &str) -> bool {
        text.lines().next() == Some(HEAD)
    }

    /// Reads a file. A last line that is torn (the writer was killed) is left out.
    ///
    /// # Errors
    /// If it is no kept exchange, or a line has no sign.
    pub fn read(text: &str) -> Result<Vec<Kept>, Broken> {
        if !Kept::is_one(text) {
            let message = format!("the first line of a kept exchange is {HEAD:?}");
            return Err(Broken::at(1, 1, message));
        }
        let whole = match text.rfind('\n') {
            Some(end) => &text[..end],
            None => text,
        };
        let lines = whole.lines().enumerate().skip(1);
        lines
            .map(|(number, line)| {
                let (sign, text) = line.split_at_checked(1).unwrap_or((line, ""));
                let side = Side::ALL
                    .iter()
                    .find(|(_, known)| sign.starts_with(*known))
                    .map(|(side, _)| *side)
                    .ok_or_else(|| {
                        Broken::at(number + 1, 1, "a line begins with >, <, ! or # and a blank")
                    })?;
                let text = text.strip_prefix(' ').unwrap_or(text).to_owned();
                Ok(Kept { side, text })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_read_again_but_for_a_torn_end() {
        let lines = [
            (Side::Noted, STARTED),
            (Side::Asked, "{\"type\":\"step\"}\n"),
            (Side::Answered, "{\"type\":\"ok\"}"),
            (Side::Logged, "Intel MKL FATAL ERROR"),
        ];
        let mut text = format!("{HEAD}\n");
        lines
            .iter()
            .for_each(|(side, line)| text += &Kept::line(*side, line));
        let read = Kept::read(&text).expect("sound");
        assert_eq!(read.len(), 4);
        assert_eq!(
            (read[1].side, read[1].text.as_str()),
            (Side::Asked, "{\"type\":\"step\"}")
        );
        let torn = Kept::read(&(text + "< {\"type\":\"st")).expect("torn");
        assert_eq!(torn, read);
    }

    #[test]
    fn every_line_of_a_text_has_its_sign() {
        let text = format!("{HEAD}\n{}", Kept::line(Side::Noted, "lost:\nall\n"));
        let read = Kept::read(&text).expect("sound");
        let texts: Vec<&str> = read.iter().map(|kept| kept.text.as_str()).collect();
        assert_eq!(texts, ["lost:", "all"]);
        assert!(read.iter().all(|kept| kept.side == Side::Noted));
    }

    #[test]
    fn another_file_is_told_from_one() {
        assert!(Kept::read("Scene(").is_err());
        let broken = Kept::read(&format!("{HEAD}\n?\n")).expect_err("no sign");
        assert_eq!(broken.at, Some((2, 1)));
    }
}
