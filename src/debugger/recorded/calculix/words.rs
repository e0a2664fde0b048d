//! Describes a finished CalculiX run in words.

use super::run::{CORRECTION_LIMIT, CalculixRun, Status, face, residual_limit};
use std::fmt::Write;
use stickslip_core::counted;
use stickslip_exchange::calculix::Stop;
use stickslip_exchange::calculix::cel::Slave;
use stickslip_exchange::calculix::files::OptionalFile;
use stickslip_scene::{aligned, first_of, shortest};

/// Kind of the recording.
pub const READ_ONLY: &str = "finished CalculiX run (read-only)";
/// Hint shown when a run is opened.
pub const GREETING: &str = "d explains it; O: as text; ?: all keys";
/// What the files do not contain, in short.
pub const NO_MODES: &str = "stick and slip are not in the file";
/// What the files do not contain, in full.
pub const NO_MODES_IN_FULL: &str = "CalculiX's files do not distinguish stick from slip: a \
    contact is closed if it has contact elements, otherwise open. The reason why an attempt was \
    given up is only in CalculiX's screen output.";
/// Maximum number of cycle members named.
const MOST_MEMBERS: usize = 4;

/// Numbers of steps, increments, attempts, iterations and contacts.
fn size(run: &CalculixRun) -> String {
    let files = &run.files;
    let increments = run.increments();
    let mut steps: Vec<u32> = increments.iter().map(|(step, _)| *step).collect();
    steps.dedup();
    [
        (steps.len(), "step"),
        (increments.len(), "increment"),
        (files.attempts.len(), "attempt"),
        (files.iterations.len(), "iteration"),
        (files.slaves.len(), "contact"),
    ]
    .map(|(count, what)| counted(count, what))
    .join(", ")
}

/// Remarks on files that are missing, incomplete or inconsistent.
pub fn notes(run: &CalculixRun) -> Vec<String> {
    let files = &run.files;
    let stem = run
        .name
        .rsplit_once('.')
        .map_or(&*run.name, |(stem, _)| stem);
    let stopped = |end: &str, stop: Option<Stop>| {
        stop.map(|stop| match stop {
            Stop::Cut(line) => format!(
                "{stem}.{end} ends within line {line}, because the run was stopped; shown up to there"
            ),
            Stop::NoRoom(line) => format!(
                "{stem}.{end} has an overflowed number field in line {line}; read up to there"
            ),
        })
    };
    let note = |end: &str, file: OptionalFile, without: &str| match file {
        OptionalFile::Missing => Some(format!("{stem}.{end} is missing: {without}")),
        OptionalFile::Read(stop) => stopped(end, stop),
    };
    let differs = files.differs.map(|(at, count)| {
        format!(
            "{stem}.cel and {stem}.cvg differ in the number of contact elements in {}, first in step {}, increment {}, attempt {}, iteration {}. They may belong to different runs, or *CONTACT FILE is only in a later step",
            counted(count, "iteration"), at.step, at.increment, at.attempt, at.iteration
        )
    });
    let sta = "times are unknown, and how attempts ended is inferred from the next attempt";
    let cvg = "residuals are unknown, and iterations without contact elements, or with unchanged ones, are not shown";
    let notes = [
        stopped("cel", files.cel),
        note("sta", files.sta, sta),
        note("cvg", files.cvg, cvg),
        differs,
    ];
    notes.into_iter().flatten().collect()
}

/// How an attempt ended, its time, and its cycle.
pub fn attempt(run: &CalculixRun, attempt: usize) -> String {
    let this = &run.files.attempts[attempt];
    let iterations = counted(run.iterations(attempt), "iteration");
    let mut text = match run.end(attempt) {
        "converged" => format!("converged after {iterations}"),
        "cut" => {
            let next = run.files.attempts[attempt + 1].row;
            let size = next
                .map(|row| format!(" to {}", shortest(row.size)))
                .unwrap_or_default();
            format!("not converged in {iterations}; cut{size}")
        }
        "failed" => format!("not converged in {iterations}; the run ends here"),
        _ => format!("{iterations}; end unknown: the run was stopped or is still running"),
    };
    if let Some(cycle) = cycle(run, attempt) {
        let _ = write!(text, "; {cycle}");
    }
    if let Some(row) = this.row {
        let start = if row.converged {
            row.total_time - row.size
        } else {
            row.total_time
        };
        // Remove round-off from subtracting printed numbers.
        let start = (start * 1e6).round() / 1e6;
        let _ = write!(text, "; time {} + {}", shortest(start), shortest(row.size));
    }
    text
}

/// The cycle of an attempt.
fn cycle(run: &CalculixRun, attempt: usize) -> Option<String> {
    let cycle = run.cycles[attempt].as_ref()?;
    let number = run.files.iterations[cycle.iterations.start].number;
    let residuals: Vec<String> = cycle
        .iterations
        .clone()
        .filter_map(|k| Some(shortest(run.norms(k)?.residual)))
        .collect();
    let residuals = if residuals.is_empty() {
        String::new()
    } else {
        format!(", residuals {} %", residuals.join(", "))
    };
    let members = if cycle.members.is_empty() {
        format!("no contact element changes; {NO_MODES}")
    } else {
        let names = cycle.members.iter().map(|slave| run.slave(*slave));
        format!("{} change", first_of(names, MOST_MEMBERS, ", "))
    };
    Some(format!(
        "cycle of period {} from iteration {number}{residuals}; {members}",
        cycle.period()
    ))
}

/// An iteration: closed contacts, residual and correction with their limits, and its attempt.
pub fn iteration(run: &CalculixRun, iteration: usize) -> String {
    let this = &run.files.iterations[iteration];
    let mut text = match run.closed(iteration) {
        Some(closed) => format!("closed {closed} of {}", run.files.slaves.len()),
        None => "contacts unknown".into(),
    };
    if this.kept {
        text += ", held fixed";
    }
    if let Some(norms) = this.norms {
        let _ = write!(
            text,
            ", residual {} % (limit {} %), correction {} % (limit {CORRECTION_LIMIT} %)",
            shortest(norms.residual),
            residual_limit(this.number),
            shortest(norms.correction)
        );
    }
    let attempt = run.attempt(iteration);
    format!("{text}. Attempt: {}", self::attempt(run, attempt))
}

/// A contact in an iteration: the master faces it touches (for a slave face, with the number of integration
/// points), and how often it switches.
pub fn contact(run: &CalculixRun, iteration: usize, slave: usize) -> String {
    let points = matches!(run.files.slaves[slave], Slave::Face(_));
    let mut text = match run.contact(iteration, slave) {
        None => "contact elements unknown".to_owned(),
        Some([]) => "open".to_owned(),
        Some(closed) => {
            let faces: Vec<String> = closed
                .iter()
                .map(|closed| {
                    let face = face(&run.files.masters[closed.master as usize]);
                    if points {
                        format!("{face} at {}", counted(closed.elements as usize, "point"))
                    } else {
                        face
                    }
                })
                .collect();
            format!("closed on {}", faces.join("; "))
        }
    };
    if let Some(switching) = run.switching_of(slave) {
        let attempt = run.attempt(iteration);
        let here = switching
            .attempts
            .iter()
            .find(|(own, _)| *own == attempt)
            .map_or(0, |(_, count)| *count);
        let (place, most) = switching.most();
        let _ = write!(
            text,
            "; switches: {here} in this attempt, {} in all, at most {most} ({})",
            switching.total(),
            run.attempt_name(place)
        );
    }
    text
}

/// The letter of a contact on the timeline; lower case if CalculiX kept the contacts fixed.
pub fn letter(run: &CalculixRun, iteration: usize, slave: usize) -> u8 {
    let letter = match run.status(iteration, slave) {
        Status::Unknown => b'?',
        Status::Open => b'.',
        Status::Closed => b'C',
        Status::Moved => b'M',
        Status::Part(tenths) => b'0' + tenths,
    };
    if run.files.iterations[iteration].kept {
        letter.to_ascii_lowercase()
    } else {
        letter
    }
}

/// The whole run as text: attempts, cycles, and contacts that switch.
pub fn text(run: &CalculixRun) -> String {
    let mut text = format!("{}: {READ_ONLY}\n{}\n", run.name, size(run));
    for note in notes(run) {
        let _ = writeln!(text, "note: {note}");
    }
    let _ = write!(text, "{NO_MODES_IN_FULL}\n\n{}", attempts(run));
    let cycles: Vec<String> = (0..run.files.attempts.len())
        .filter_map(|k| Some((k, cycle(run, k)?)))
        .map(|(k, cycle)| format!("{}: {cycle}\n", run.attempt_name(k)))
        .collect();
    text += &if cycles.is_empty() {
        "\nNo cycles.\n".into()
    } else {
        format!("\nCycles\n{}", cycles.concat())
    };
    text + &switching(run) + &causes(run)
}

/// The causes that the rules find, with their cures.
fn causes(run: &CalculixRun) -> String {
    let causes = run.findings.iter().enumerate().map(|(k, found)| {
        let (number, rule, cause, advice) = (k + 1, found.rule, &found.cause, found.advice());
        let cure = if advice.is_empty() {
            String::new()
        } else {
            format!("   Cure: {advice}\n")
        };
        format!("{number}. {rule}: {cause}\n{cure}")
    });
    if run.findings.is_empty() {
        "\nNo rule applies to this run.\n".into()
    } else {
        format!("\nCauses\n{}", causes.collect::<String>())
    }
}

/// One row per attempt.
fn attempts(run: &CalculixRun) -> String {
    let mut switches = vec![0; run.files.attempts.len()];
    for (attempt, count) in run.switching.iter().flat_map(|found| &found.attempts) {
        switches[*attempt] += count;
    }
    let headings = [
        "attempt",
        "iterations",
        "ended",
        "residual %",
        "correction %",
        "closed",
        "switches",
    ];
    let mut rows = vec![headings.map(str::to_owned)];
    for (index, attempt) in run.files.attempts.iter().enumerate() {
        let last = attempt.iterations.clone().last();
        let norms = last.and_then(|last| run.norms(last));
        let number = |value: Option<f64>| value.map_or("-".into(), shortest);
        let closed = last.and_then(|last| run.closed(last));
        rows.push([
            run.attempt_name(index),
            run.iterations(index).to_string(),
            run.end(index).to_owned(),
            number(norms.map(|norms| norms.residual)),
            number(norms.map(|norms| norms.correction)),
            closed.map_or("-".into(), |closed| closed.to_string()),
            switches[index].to_string(),
        ]);
    }
    aligned(&rows, 1).join("\n") + "\n"
}

/// The contacts that switch, those with the most switches in one attempt first.
fn switching(run: &CalculixRun) -> String {
    if run.switching.is_empty() {
        return "\nNo contact switches between the iterations of an attempt.\n".into();
    }
    let mut rows = vec![["contact", "switches", "most", "in", "attempts"].map(str::to_owned)];
    for found in &run.switching {
        let (place, most) = found.most();
        rows.push([
            run.slave_with_corners(found.slave),
            found.total().to_string(),
            most.to_string(),
            run.attempt_name(place),
            found.attempts.len().to_string(),
        ]);
    }
    let head = "\nContacts that switch between the iterations of an attempt: total, most in one attempt, number of attempts\n";
    head.to_owned() + &aligned(&rows, 1).join("\n") + "\n"
}
