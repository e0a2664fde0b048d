//! The named ends of a solver that does not do what the protocol says.

use std::time::Duration;
use stickslip_exchange::attach::PROTOCOL;
use stickslip_scene::shown;

/// Most characters of a solver's own words in a fault.
const MOST: usize = 400;

/// Words of a solver, harmless and on one line.
fn plain(words: &str) -> String {
    shown::cut(words, MOST)
}

/// The reason that it gives, after what it does; nothing where it gives none.
fn why(reason: &str) -> String {
    match reason.trim() {
        "" => String::new(),
        reason => format!(": {}", plain(reason)),
    }
}

/// Why an attached solver cannot go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Fault {
    /// It could not be started.
    #[error("{} cannot be started: {why}", plain(command))]
    NotStarted {
        /// What was to be started.
        command: String,
        /// What the system says.
        why: String,
    },
    /// It ended, or closed its output.
    #[error("the solver ended ({}); {asked} is not answered", plain(how))]
    Died {
        /// Its exit status, and the last line of its standard error.
        how: String,
        /// What it was asked.
        asked: String,
    },
    /// It said that it ends.
    #[error("the solver answered {asked} with bye{}", why(reason))]
    Bye {
        /// Its reason; may be empty.
        reason: String,
        /// What it was asked.
        asked: String,
    },
    /// It does not answer in time.
    #[error(
        "the solver did not answer {asked} within {} s, and was stopped; {longer} gives it longer",
        after.as_secs_f64()
    )]
    Silent {
        /// What it was asked.
        asked: String,
        /// How long it had.
        after: Duration,
        /// The option by which it has longer.
        longer: &'static str,
    },
    /// It was interrupted, and had to be stopped.
    #[error("interrupted: the solver did not end {asked} when it was asked to, and was stopped")]
    Stopped {
        /// What it was asked.
        asked: String,
    },
    /// Something else than a message.
    #[error(
        "the solver wrote something to its standard output that is no message ({}): {line:?}; what it prints belongs on standard error",
        plain(why)
    )]
    Junk {
        /// What is wrong with it.
        why: String,
        /// Its beginning.
        line: String,
    },
    /// JSON, but no message that there is.
    #[error(
        "the solver's answer to {asked} cannot be read ({}): {line:?}",
        plain(why)
    )]
    Misformed {
        /// What it was asked.
        asked: String,
        /// What is wrong with it.
        why: String,
        /// What stands there.
        line: String,
    },
    /// A line without an end.
    #[error("the solver ended in the middle of a line: {0:?}")]
    Torn(String),
    /// A line that is too long.
    #[error("the solver wrote a line of more than {most} bytes: {line:?}")]
    TooLong {
        /// How long it may be.
        most: usize,
        /// Its beginning.
        line: String,
    },
    /// Another message than the one that answers.
    #[error("the solver answered {asked} with {answer}; {expected} is the answer to that")]
    OtherAnswer {
        /// What it was asked.
        asked: String,
        /// What it answered.
        answer: String,
        /// What would be right.
        expected: &'static str,
    },
    /// It speaks another version.
    #[error("the solver speaks version {0} of the protocol, and this program version {PROTOCOL}")]
    Version(u32),
    /// An answer to nothing.
    #[error(
        "the solver said {answer} unasked, before {asked}; each request has one answer, and what is told besides is a message"
    )]
    Unasked {
        /// What it said.
        answer: String,
        /// What it would have been asked next.
        asked: String,
    },
    /// It refused what it offers, or what every solver does.
    #[error("the solver refuses {asked}{}", self::why(why))]
    Refused {
        /// What it was asked.
        asked: String,
        /// Its words.
        why: String,
    },
    /// A message that does not fit the scene.
    #[error("the solver's {message} is unsound: {}", plain(why))]
    Unfit {
        /// Which message.
        message: &'static str,
        /// What is wrong, and what would be right.
        why: String,
    },
    /// Done again, it is not what it was.
    #[error(
        "done again, iteration {iteration} of the solver is not what it was ({}): it does not do the same twice, so nothing can follow from a state that it has left",
        plain(why)
    )]
    Changed {
        /// Number of the iteration, from 1.
        iteration: usize,
        /// What differs.
        why: String,
    },
    /// Started again, it solves something else.
    #[error(
        "started again, the solver tells another {what}; nothing of what it did before can be gone back to"
    )]
    OtherScene {
        /// What is another.
        what: &'static str,
    },
    /// A state of another session.
    #[error("this state is none that the solver has had since it was attached")]
    Unknown,
    /// A kept exchange without a scene.
    #[error("the file ends before the solver describes its scene")]
    NoScene,
    /// The exchange that was opened ends here.
    #[error("the kept exchange ends here, and there is no solver that could go on")]
    Past,
}
