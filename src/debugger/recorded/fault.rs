//! Errors of attached solvers that fail or violate the protocol.

use std::time::Duration;
use stickslip_scene::shown;

/// Maximum number of characters of a solver's own words in a message.
const MOST: usize = 400;

/// Where messages are described.
const SEE: &str = "; `stickslip help protocol` describes the messages";

/// A solver's words as one line of safe characters.
fn plain(words: &str) -> String {
    shown::cut(words, MOST)
}

/// The solver's reason after a colon; empty if there is none.
fn why(reason: &str) -> String {
    match reason.trim() {
        "" => String::new(),
        reason => format!(": {}", plain(reason)),
    }
}

/// Why an attached solver cannot continue.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Fault {
    /// The solver cannot be started.
    #[error("{} cannot be started: {why}", plain(command))]
    NotStarted {
        /// The command.
        command: String,
        /// Error of the system.
        why: String,
    },
    /// The solver ended, or closed its output.
    #[error("the solver ended ({}) without answering {asked}", plain(how))]
    Died {
        /// Its exit status, and the last line of its standard error.
        how: String,
        /// The pending request.
        asked: String,
    },
    /// The solver announced that it ends.
    #[error("the solver answered {asked} with bye{}", why(reason))]
    Bye {
        /// Its reason; may be empty.
        reason: String,
        /// The pending request.
        asked: String,
    },
    /// The solver did not answer in time.
    #[error(
        "the solver did not answer {asked} within {} s and was stopped; allow more time with {longer}",
        after.as_secs_f64()
    )]
    Silent {
        /// The pending request.
        asked: String,
        /// The time limit.
        after: Duration,
        /// The option that extends the limit.
        longer: &'static str,
    },
    /// The solver did not react to an interrupt and was stopped.
    #[error("interrupted: the solver did not stop during {asked} and was ended")]
    Stopped {
        /// The pending request.
        asked: String,
    },
    /// Output that is not a message.
    #[error(
        "the solver wrote a line to standard output that is not a message ({}): {line:?}; it must print to standard error",
        plain(why)
    )]
    Junk {
        /// What is wrong with the line.
        why: String,
        /// Beginning of the line.
        line: String,
    },
    /// JSON that is not a known message.
    #[error(
        "the solver's answer to {asked} cannot be read ({}): {line:?}{SEE}",
        plain(why)
    )]
    Misformed {
        /// The pending request.
        asked: String,
        /// What is wrong with the message.
        why: String,
        /// The message.
        line: String,
    },
    /// An incomplete line.
    #[error("the solver ended in the middle of a line: {0:?}")]
    Torn(String),
    /// A line that is too long.
    #[error("the solver wrote a line longer than {most} bytes: {line:?}")]
    TooLong {
        /// Maximum length.
        most: usize,
        /// Beginning of the line.
        line: String,
    },
    /// A message of the wrong kind.
    #[error("the solver answered {asked} with {answer}; expected {expected}")]
    OtherAnswer {
        /// The pending request.
        asked: String,
        /// The answer.
        answer: String,
        /// The expected answer.
        expected: &'static str,
    },
    /// Unsupported protocol version.
    #[error("the solver uses version {0} of the protocol; this program supports versions 1 and 2")]
    Version(u32),
    /// An answer without a request.
    #[error(
        "the solver sent {answer} before {asked} was requested; send exactly one answer per request, and use log messages for anything else"
    )]
    Unasked {
        /// The message.
        answer: String,
        /// The next request.
        asked: String,
    },
    /// The solver refused something that it offers or that is mandatory.
    #[error("the solver refuses {asked}{}", self::why(why))]
    Refused {
        /// The request.
        asked: String,
        /// The solver's reason.
        why: String,
    },
    /// A message that does not match the scene.
    #[error("the solver's {message} is invalid: {}{SEE}", plain(why))]
    Unfit {
        /// Kind of the message.
        message: &'static str,
        /// What is wrong, and what was expected.
        why: String,
    },
    /// A repeated iteration gave another result.
    #[error(
        "when repeated, iteration {iteration} of the solver differed ({}): the solver is not deterministic, so it can continue only from its last state",
        plain(why)
    )]
    Changed {
        /// Number of the iteration, from 1.
        iteration: usize,
        /// What differs.
        why: String,
    },
    /// After a restart, the solver has another scene.
    #[error(
        "after a restart, the solver reports a different {what}; it cannot return to earlier states"
    )]
    OtherScene {
        /// What differs.
        what: &'static str,
    },
    /// A state of another session.
    #[error("the solver has not had this state since it was attached")]
    Unknown,
    /// A stored exchange without a scene.
    #[error("the file ends before the solver describes its scene")]
    NoScene,
    /// End of a stored exchange.
    #[error("the stored exchange ends here and cannot be continued")]
    Past,
}
