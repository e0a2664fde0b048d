//! Sentences about a run that is over.

use super::run::{Past, face, limits};
use crate::explain::number::plain;
use stickslip_exchange::calculix::Stop;
use stickslip_exchange::calculix::past::{Beside, End};

/// What the files do not tell, and what they tell instead.
pub const NO_MODES: &str = "stick and slip are not in the file";
/// The same in full.
pub const NO_MODES_IN_FULL: &str = "Stick and slip are not in CalculiX's files: a contact is closed, where it has contact elements, \
    or open. Nor is the reason for which an attempt was given up: CalculiX tells that on its screen only.";
/// Why nothing can be done with it but look.
pub const READ_ONLY: &str = "read-only: a CalculiX run that is over";
/// Most members of a cycle that are named.
const MOST_MEMBERS: usize = 4;

/// So many of something.
pub fn counted(count: usize, what: &str) -> String {
    let end = if count == 1 { "" } else { "s" };
    format!("{count} {what}{end}")
}

/// How large the run is.
pub fn size(past: &Past) -> String {
    let run = &past.run;
    let keys = run
        .attempts
        .iter()
        .map(|attempt| (attempt.step, attempt.increment));
    let mut increments: Vec<_> = keys.collect();
    increments.dedup();
    let mut steps: Vec<_> = increments.iter().map(|(step, _)| step).collect();
    steps.dedup();
    [
        (steps.len(), "step"),
        (increments.len(), "increment"),
        (run.attempts.len(), "attempt"),
        (run.iterations.len(), "iteration"),
        (run.slaves.len(), "contact"),
    ]
    .map(|(count, what)| counted(count, what))
    .join(", ")
}

/// What is missing beside the .cel, breaks off, or does not fit.
pub fn notes(past: &Past) -> Vec<String> {
    let run = &past.run;
    let stem = past
        .name
        .rfind('.')
        .map_or(past.name.as_str(), |dot| &past.name[..dot]);
    let stopped = |end: &str, stop: Option<Stop>| {
        stop.map(|stop| match stop {
            Stop::Cut(line) => format!(
                "{stem}.{end} breaks off in line {line}: the run was stopped while it wrote, and is shown up to there"
            ),
            Stop::NoRoom(line) => format!(
                "{stem}.{end} has a number without room in line {line}, and is read up to there"
            ),
        })
    };
    let beside = |end: &str, file: Beside, without: &str| match file {
        Beside::Missing => Some(format!("{stem}.{end} is not there: {without}")),
        Beside::Read(stop) => stopped(end, stop),
    };
    let differs = run.differs.map(|(at, count)| {
        format!(
            "{stem}.cel and {stem}.cvg tell different numbers of contact elements in {}, first in step {}, increment {}, attempt {}, iteration {}: they may be of different runs, or *CONTACT FILE may stand in a later step only",
            counted(count, "iteration"), at.step, at.increment, at.attempt, at.iteration
        )
    });
    let sta = "times are unknown, and how an attempt ended is told by what follows it";
    let cvg = "there are no residuals, and iterations that have no contact element, or keep those before, are left out";
    let notes = [
        stopped("cel", run.cel),
        beside("sta", run.sta, sta),
        beside("cvg", run.cvg, cvg),
        differs,
    ];
    notes.into_iter().flatten().collect()
}

/// How an attempt ended, in a word.
pub fn end_word(past: &Past, attempt: usize) -> &'static str {
    match (past.run.attempts[attempt].end, follows(past, attempt)) {
        (End::Converged, _) => "converged",
        (End::NotConverged, true) => "cut",
        (End::NotConverged, false) => "failed",
        (End::Unknown, _) => "unknown",
    }
}

/// Whether the same increment is tried again after an attempt.
pub fn follows(past: &Past, attempt: usize) -> bool {
    let attempts = &past.run.attempts;
    let key = |k: usize| {
        attempts
            .get(k)
            .map(|attempt| (attempt.step, attempt.increment))
    };
    key(attempt) == key(attempt + 1)
}

/// How an attempt ended.
pub fn ended(past: &Past, attempt: usize) -> String {
    let attempts = &past.run.attempts;
    let this = &attempts[attempt];
    let count = match this.row {
        Some(row) => row.iterations as usize,
        None => this.iterations.len(),
    };
    let iterations = counted(count, "iteration");
    match (this.end, follows(past, attempt)) {
        (End::Converged, _) => format!("converged after {iterations}"),
        (End::NotConverged, true) => {
            let next = attempts[attempt + 1].row;
            let size = next.map_or(String::new(), |row| format!(" to {}", plain(row.size)));
            format!("not converged in {iterations}, and cut{size}")
        }
        (End::NotConverged, false) => {
            format!("not converged in {iterations}, and the run ends there")
        }
        (End::Unknown, _) => format!(
            "{iterations}, and no file tells how it ended: the run was stopped there, or goes on"
        ),
    }
}

/// The cycle of an attempt, if it has one.
pub fn cycle(past: &Past, attempt: usize) -> Option<String> {
    let round = past.rounds[attempt].as_ref()?;
    let first = round.iterations.start;
    let number = past.run.iterations[first].number;
    let residuals: Vec<String> = round
        .iterations
        .clone()
        .filter_map(|k| Some(plain(past.norms(k)?.residual)))
        .collect();
    let residuals = match residuals.is_empty() {
        true => String::new(),
        false => format!(", residual {} % in turn", residuals.join(", ")),
    };
    let named = round.members.iter().take(MOST_MEMBERS);
    let named: Vec<String> = named.map(|slave| past.slave(*slave)).collect();
    let more = round.members.len() - named.len();
    let members = match (named.is_empty(), more) {
        (true, _) => format!("no contact element changes in it, and {NO_MODES}"),
        (false, 0) => format!("{} change", named.join(", ")),
        (false, more) => format!("{} and {more} more change", named.join(", ")),
    };
    Some(format!(
        "{}-cycle from iteration {number} on{residuals}; {members}",
        round.period()
    ))
}

/// Where an iteration is: step, increment, attempt, iteration of how many.
pub fn place(past: &Past, iteration: usize) -> String {
    let attempt = &past.run.attempts[past.attempt(iteration)];
    let last = attempt.iterations.clone().last().unwrap_or(iteration);
    let number = |k: usize| past.run.iterations[k].number;
    format!(
        "step {}  increment {}  attempt {}  iteration {} of {}",
        attempt.step,
        attempt.increment,
        attempt.attempt,
        number(iteration),
        number(last)
    )
}

/// The time that an attempt goes for.
pub fn time(past: &Past, attempt: usize) -> Option<String> {
    let this = &past.run.attempts[attempt];
    let row = this.row?;
    let start = match row.converged {
        true => row.total_time - row.size,
        false => row.total_time,
    };
    Some(format!(
        "time {} + {}",
        plain(rounded(start)),
        plain(row.size)
    ))
}

/// A difference of printed numbers, without what only rounding left of it.
fn rounded(time: f64) -> f64 {
    (time * 1e6).round() / 1e6
}

/// How many contacts are closed in an iteration, of all that ever were.
pub fn closed(past: &Past, iteration: usize) -> String {
    match past.closed(iteration) {
        Some(closed) => {
            let held = match past.run.iterations[iteration].kept {
                true => ", held fixed",
                false => "",
            };
            format!("closed {closed} of {}{held}", past.run.slaves.len())
        }
        None => "contacts are not told".into(),
    }
}

/// Residual and correction of an iteration with the limits.
pub fn norms(past: &Past, iteration: usize) -> Option<String> {
    let norms = past.norms(iteration)?;
    let [residual, correction] = limits(past.run.iterations[iteration].number);
    Some(format!(
        "residual {} % (limit {residual})  correction {} % (limit {correction})",
        plain(norms.residual),
        plain(norms.correction)
    ))
}

/// The master faces that a slave touches in an iteration, with the number of contact elements where these are integration points.
pub fn masters(past: &Past, iteration: usize, slave: usize) -> String {
    let Some(closed) = past.contact(iteration, slave) else {
        return "not told".into();
    };
    if closed.is_empty() {
        return "open".into();
    }
    let points = past.corners(slave).is_some();
    let each = closed.iter().map(|closed| {
        let corners = face(&past.run.masters[closed.master as usize]);
        match points {
            true => format!(
                "{corners} at {}",
                counted(closed.elements as usize, "point")
            ),
            false => corners,
        }
    });
    format!("closed on {}", each.collect::<Vec<_>>().join("; "))
}
