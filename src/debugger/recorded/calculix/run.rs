//! A finished CalculiX run: its iterations, the cycles in them, and the contacts that switch.

use super::cycle::{self, Cycle};
use std::fmt::Write;
use stickslip_core::RunFinding;
use stickslip_core::model::RunShape;
use stickslip_exchange::calculix::cel::{ClosedContact, Slave};
use stickslip_exchange::calculix::cvg::Norms;
use stickslip_exchange::calculix::files::{CalculixFiles, End};
use stickslip_exchange::inp::Deck;

/// A finished run.
#[derive(Debug, Clone, PartialEq)]
pub struct CalculixRun {
    /// Path of the .cel, as typed by the user.
    pub name: String,
    /// Contents of the files.
    pub files: CalculixFiles,
    /// The first cycle of each attempt.
    pub cycles: Vec<Option<Cycle>>,
    /// The contacts that switch, those with the most switches in one attempt first.
    pub switching: Vec<Switching>,
    /// The deck next to the files.
    pub deck: Option<Deck>,
    /// Why the run did not converge, by the rules.
    pub findings: Vec<RunFinding>,
    /// The contact surfaces of the deck.
    pub shape: RunShape,
    /// The attempt of each iteration.
    attempts: Vec<usize>,
    /// The largest number of contact elements of each slave.
    most: Vec<u32>,
    /// Index of each slave in `switching`.
    places: Vec<Option<usize>>,
}

/// Status of a slave in an iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Not in the files.
    Unknown,
    /// No contact elements.
    Open,
    /// At least one contact element.
    Closed,
    /// Contact elements on other master faces than in the previous iteration.
    Moved,
    /// A slave face with fewer integration points in contact than its maximum: 1 to 9 tenths of it.
    Part(u8),
}

/// How often a slave switched between consecutive iterations of an attempt: it closed, opened, moved to another
/// master face, or (a slave face) changed its number of points in contact.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Switching {
    /// The slave, by index in the run.
    pub slave: usize,
    /// Attempts in which it switched, by index in the run, with the number of switches.
    pub attempts: Vec<(usize, usize)>,
}

impl Switching {
    /// Number of switches in the whole run.
    pub fn total(&self) -> usize {
        self.attempts.iter().map(|(_, count)| count).sum()
    }

    /// The first attempt with the most switches, and their number.
    pub fn most(&self) -> (usize, usize) {
        let most = self
            .attempts
            .iter()
            .copied()
            .max_by(|a, b| a.1.cmp(&b.1).then(b.0.cmp(&a.0)));
        most.unwrap_or_default()
    }
}

/// Limit of the displacement correction in percent: CalculiX's default `C_n`.
pub const CORRECTION_LIMIT: f64 = 1.0;

/// Limit of the residual in percent, for CalculiX's defaults (`*CONTROLS`: R_n = 0.005, and R_p = 0.02 after
/// I_p = 9 iterations).
pub fn residual_limit(iteration: u32) -> f64 {
    if iteration <= 9 { 0.5 } else { 2.0 }
}

impl CalculixRun {
    /// Finds the cycles and the contacts that switch.
    pub fn new(name: impl Into<String>, files: CalculixFiles) -> CalculixRun {
        let mut attempts = vec![0; files.iterations.len()];
        for (index, attempt) in files.attempts.iter().enumerate() {
            attempts[attempt.iterations.clone()].fill(index);
        }
        let mut most = vec![0; files.slaves.len()];
        for k in 0..files.iterations.len() {
            let closed = files.closed(k).unwrap_or_default();
            for part in closed.chunk_by(|a, b| a.slave == b.slave) {
                let most = &mut most[part[0].slave as usize];
                *most = elements(part).max(*most);
            }
        }
        let cycle = |attempt| cycle::first(&files, attempt);
        let switching = switching(&files);
        let mut places = vec![None; files.slaves.len()];
        for (place, found) in switching.iter().enumerate() {
            places[found.slave] = Some(place);
        }
        CalculixRun {
            name: name.into(),
            deck: None,
            findings: Vec::new(),
            shape: RunShape::default(),
            cycles: files.attempts.iter().map(cycle).collect(),
            switching,
            files,
            attempts,
            most,
            places,
        }
    }

    /// Step and increment numbers of all increments, in order.
    pub fn increments(&self) -> Vec<(u32, u32)> {
        let attempts = self.files.attempts.iter();
        let mut all: Vec<_> = attempts.map(|a| (a.step, a.increment)).collect();
        all.dedup();
        all
    }

    /// The attempt of an iteration.
    pub fn attempt(&self, iteration: usize) -> usize {
        self.attempts[iteration]
    }

    /// Residuals of an iteration, if known.
    pub fn norms(&self, iteration: usize) -> Option<Norms> {
        self.files.iterations[iteration].norms
    }

    /// Number of slaves in contact in an iteration, if known.
    pub fn closed(&self, iteration: usize) -> Option<usize> {
        let closed = self.files.closed(iteration)?;
        Some(closed.chunk_by(|a, b| a.slave == b.slave).count())
    }

    /// The contact elements of a slave in an iteration, by master, if known.
    pub fn contact(&self, iteration: usize, slave: usize) -> Option<&[ClosedContact]> {
        let closed = self.files.closed(iteration)?;
        let from = closed.partition_point(|c| (c.slave as usize) < slave);
        let to = closed.partition_point(|c| c.slave as usize <= slave);
        Some(&closed[from..to])
    }

    /// Status of a slave in an iteration.
    pub fn status(&self, iteration: usize, slave: usize) -> Status {
        let Some(now) = self.contact(iteration, slave) else {
            return Status::Unknown;
        };
        let (part, whole) = (u64::from(elements(now)), u64::from(self.most[slave]));
        let masters =
            |closed: &[ClosedContact]| closed.iter().map(|c| c.master).collect::<Vec<_>>();
        let before = iteration.checked_sub(1);
        let before = before.filter(|before| self.attempt(*before) == self.attempt(iteration));
        let before = before.and_then(|before| self.contact(before, slave));
        match before.filter(|before| !before.is_empty()) {
            _ if now.is_empty() => Status::Open,
            _ if part < whole => Status::Part((10 * part / whole).clamp(1, 9) as u8),
            Some(before) if masters(before) != masters(now) => Status::Moved,
            _ => Status::Closed,
        }
    }

    /// Name of a slave: `node 9`; slave faces are numbered.
    pub fn slave(&self, slave: usize) -> String {
        match self.files.slaves[slave] {
            Slave::Node(node) => format!("node {node}"),
            Slave::Face(_) => format!("face {}", slave + 1),
        }
    }

    /// The name with the corners of a slave face.
    pub fn slave_with_corners(&self, slave: usize) -> String {
        let mut name = self.slave(slave);
        if let Slave::Face(corners) = &self.files.slaves[slave] {
            let _ = write!(name, " ({})", face(corners));
        }
        name
    }

    /// How often a slave switches, if it does.
    pub fn switching_of(&self, slave: usize) -> Option<&Switching> {
        self.places[slave].map(|place| &self.switching[place])
    }

    /// Whether the same increment is tried again after an attempt.
    pub fn is_tried_again(&self, attempt: usize) -> bool {
        let attempts = &self.files.attempts;
        let increment = |k: usize| attempts.get(k).map(|a| (a.step, a.increment));
        increment(attempt) == increment(attempt + 1)
    }

    /// How an attempt ended.
    pub fn end(&self, attempt: usize) -> &'static str {
        match (
            self.files.attempts[attempt].end,
            self.is_tried_again(attempt),
        ) {
            (End::Converged, _) => "converged",
            (End::NotConverged, true) => "cut",
            (End::NotConverged, false) => "failed",
            (End::Unknown, _) => "unknown",
        }
    }

    /// Number of iterations of an attempt; the .sta also counts those that the other files omit.
    pub fn iterations(&self, attempt: usize) -> usize {
        let attempt = &self.files.attempts[attempt];
        attempt
            .row
            .map(|row| row.iterations as usize)
            .unwrap_or(attempt.iterations.len())
    }

    /// Name of an attempt: step.increment.attempt.
    pub fn attempt_name(&self, attempt: usize) -> String {
        let attempt = &self.files.attempts[attempt];
        format!("{}.{}.{}", attempt.step, attempt.increment, attempt.attempt)
    }
}

/// All slaves that switch.
fn switching(files: &CalculixFiles) -> Vec<Switching> {
    let mut all: Vec<Switching> = (0..files.slaves.len())
        .map(|slave| Switching {
            slave,
            attempts: Vec::new(),
        })
        .collect();
    for (index, attempt) in files.attempts.iter().enumerate() {
        for k in attempt.iterations.clone().skip(1) {
            let (Some(before), Some(now)) = (files.closed(k - 1), files.closed(k)) else {
                continue;
            };
            for slave in cycle::changed(before, now) {
                match all[slave].attempts.last_mut() {
                    Some((last, count)) if *last == index => *count += 1,
                    _ => all[slave].attempts.push((index, 1)),
                }
            }
        }
    }
    all.retain(|switching| !switching.attempts.is_empty());
    all.sort_by_key(|switching| {
        let order = (switching.most().1, switching.total());
        (std::cmp::Reverse(order), switching.slave)
    });
    all
}

fn elements(closed: &[ClosedContact]) -> u32 {
    closed
        .iter()
        .map(|closed| closed.elements)
        .fold(0, u32::saturating_add)
}

/// A face by its corners; a triangle has three.
pub fn face(corners: &[u32; 4]) -> String {
    let [a, b, c, d] = corners;
    if c == d {
        format!("{a} {b} {c}")
    } else {
        format!("{a} {b} {c} {d}")
    }
}
