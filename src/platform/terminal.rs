//! Size and capabilities of the terminal.
//!
//! The queries are those of ECMA-48 and of DEC terminals: CSI 6 n (cursor position), CSI ? mode $ p (is this mode supported?) and
//! CSI c (terminal type). Every terminal answers the last one, which ends the wait for the others.

use unicode_width::UnicodeWidthStr;

#[cfg_attr(unix, path = "unix_terminal.rs")]
#[cfg_attr(windows, path = "windows_terminal.rs")]
mod system;

pub use system::{ask, report_mouse, size};

/// The answers of a terminal.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Answers {
    /// The terminal type (DA1) as numbers; empty if it did not answer in time.
    pub kind: Vec<u16>,
    /// The queried modes, and whether the terminal supports them (DECRQM).
    pub modes: Vec<(u16, bool)>,
    /// The cursor's column after each of [`TEXTS`], from 1; shorter if answers are missing.
    pub columns: Vec<u16>,
}

/// Mode: mouse positions without a size limit (SGR).
const MOUSE: u16 = 1006;
/// Mode: synchronized updates.
const IN_ONE_GO: u16 = 2026;
/// Attribute in DA1: the clipboard can be written (OSC 52).
const CLIPBOARD: u16 = 52;

/// Texts whose width differs between terminals: the debugger's glyphs, and East Asian characters.
pub const TEXTS: [(&str, &str); 5] = [
    ("lines", "┏━│"),
    ("braille", "⠿⣀"),
    ("signs", "▸✗●→≤φ"),
    ("wide letters", "漢"),
    ("combined letters", "e\u{301}"),
];

impl Answers {
    /// Whether it supports a mode; `None` if it did not answer.
    fn knows(&self, mode: u16) -> Option<bool> {
        let found = self.modes.iter().find(|(own, _)| *own == mode);
        found.map(|(_, knows)| *knows)
    }

    /// Whether it supports the debugger's mouse reports.
    pub fn mouse(&self) -> Option<bool> {
        self.knows(MOUSE)
    }

    /// Whether it supports synchronized updates.
    pub fn in_one_go(&self) -> Option<bool> {
        self.knows(IN_ONE_GO)
    }

    /// Whether it reports that programs can write the clipboard; many terminals allow it without reporting it.
    pub fn clipboard(&self) -> bool {
        self.kind.contains(&CLIPBOARD)
    }

    /// The texts whose width in the terminal differs from the expected one: name, actual and expected columns. `None` if an answer
    /// is missing.
    pub fn other_widths(&self) -> Option<Vec<(&'static str, usize, usize)>> {
        if self.columns.len() != TEXTS.len() {
            return None;
        }
        let widths = TEXTS
            .iter()
            .zip(&self.columns)
            .map(|((what, text), column)| {
                (*what, usize::from(*column).saturating_sub(1), text.width())
            });
        Some(widths.filter(|(_, there, here)| there != here).collect())
    }
}

#[cfg(unix)]
fn questions() -> String {
    let widths = TEXTS.iter().map(|(_, text)| format!("\r{text}\x1b[6n"));
    let modes = [MOUSE, IN_ONE_GO].map(|mode| format!("\x1b[?{mode}$p"));
    // Erases what a terminal prints of unknown queries.
    format!(
        "{}\r\x1b[K{}\r\x1b[K\x1b[c",
        widths.collect::<String>(),
        modes.concat()
    )
}

#[cfg(any(unix, test))]
impl Answers {
    /// The answers so far, and whether the last one has arrived. Key presses in between are ignored.
    fn read(bytes: &[u8]) -> (Answers, bool) {
        let mut answers = Answers::default();
        let text = String::from_utf8_lossy(bytes);
        for answer in text.split("\x1b[").skip(1) {
            let end = answer.find(|c: char| c.is_ascii_alphabetic());
            let Some((numbers, end)) = end.map(|at| (&answer[..at], &answer[at..])) else {
                continue;
            };
            let asked = numbers.starts_with('?');
            let numbers: Vec<u16> = numbers
                .trim_matches(['?', '$'])
                .split(';')
                .filter_map(|n| n.parse().ok())
                .collect();
            match (&end[..1], asked, numbers.as_slice()) {
                ("R", false, [_, column]) => answers.columns.push(*column),
                // 0: not supported; other values: set or reset, possibly permanently.
                ("y", true, [mode, state]) => answers.modes.push((*mode, *state != 0)),
                ("c", true, kind) => {
                    answers.kind = kind.to_vec();
                    return (answers, true);
                }
                _ => {}
            }
        }
        (answers, false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_separated_from_keys_and_incomplete_input() {
        let whole = b"\x1b[5;4Rx\x1b[5;3R\x1b[5;7R\x1b[5;3R\x1b[5;3R\x1b[A\x1b[?1006;2$y\x1b[?2026;0$y\x1b[?62;52;c";
        let (answers, all) = Answers::read(whole);
        assert!(all);
        assert_eq!(answers.columns, [4, 3, 7, 3, 3]);
        assert_eq!(
            (answers.mouse(), answers.in_one_go()),
            (Some(true), Some(false))
        );
        assert!(answers.clipboard());
        assert_eq!(
            answers.other_widths(),
            Some(vec![("combined letters", 2, 1)])
        );
        for cut in 0..whole.len() {
            let (some, all) = Answers::read(&whole[..cut]);
            assert!(!all, "{cut}");
            assert!(answers.columns.starts_with(&some.columns), "{cut}");
        }
        assert_eq!(Answers::default().other_widths(), None);
    }
}
