//! `stickslip --version --verbose` asks the terminal, and leaves it as it was.

use super::terminal::{Session, Start, modes, patiently};

/// The last of the questions.
const LAST: &[u8] = b"\x1b[c";

fn asked() -> Session {
    let session = Start::debugger(&["--version", "--verbose"]).go();
    let all = || {
        let seen = session.seen.lock().unwrap();
        seen.raw.windows(LAST.len()).any(|part| part == LAST)
    };
    assert!(patiently(|| all().then_some(())).is_some(), "it never asks");
    session
}

#[track_caller]
fn ends_well(mut session: Session, told: &str) {
    session.see("settings");
    // Lines may be wider than the terminal.
    let text = session.text().replace('\n', "");
    assert!(text.contains(told), "{text}");
    assert!(session.end().success());
    assert_eq!(modes(&*session.master), session.before);
}

#[test]
fn what_the_terminal_answers_is_told() {
    let mut session = asked();
    session.keys(
        "\x1b[1;4R\x1b[1;3R\x1b[1;7R\x1b[1;3R\x1b[1;2R\x1b[?1006;2$y\x1b[?2026;0$y\x1b[?62;52c",
    );
    let told = "mouse (SGR): yes; clipboard (OSC 52): yes; synchronized updates: no; widths: as expected; type: 62;52";
    ends_well(session, told);
}

#[test]
fn letters_that_the_terminal_draws_wider_are_told() {
    let mut session = asked();
    session.keys("\x1b[1;7R\x1b[1;3R\x1b[1;7R\x1b[1;3R\x1b[1;2R\x1b[?6c");
    let told = "mouse (SGR): not reported; clipboard (OSC 52): not reported; synchronized updates: not reported; \
                widths: lines take 6 columns instead of 3; type: 6";
    ends_well(session, told);
}

#[test]
fn a_terminal_that_does_not_answer_is_not_waited_for_long() {
    ends_well(asked(), "the terminal does not answer");
}
