//! The result of one run of a study.

use super::log::Outcome;
use super::read::AxisQuantity;
use super::reason::Reason;
use super::verdict::RunVerdict;
use serde::{Deserialize, Serialize};

/// A run, until its end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Names of the scene's monitors.
    pub monitors: Vec<String>,
    /// Load factor and monitors before the first increment.
    pub start: Row,
    /// One row per accepted increment.
    pub rows: Vec<Row>,
    /// Total number of major iterations started, including attempts that were cut or damped.
    pub begun: u64,
    /// Factorizations of the bodies, or of bodies and interface together.
    pub factorizations: u64,
    /// How the run ended.
    pub end: CaseEnd,
}

/// One accepted increment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Increment number, from 1.
    pub increment: u32,
    /// The load factor λ at its end.
    pub load: f64,
    /// Major iterations of the increment.
    pub majors: u32,
    /// All minor iterations, including those of repeated major iterations.
    pub minors: u64,
    /// Loops stopped by a limit that the settings accept.
    pub unsettled: u32,
    /// Whether it jumped to another branch of equilibrium.
    pub jumped: bool,
    /// Values of the run's monitors.
    pub monitors: Vec<f64>,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum CaseEnd {
    /// At the end of the history.
    Finished,
    /// An increment failed.
    Failed(RunFailure),
    /// Interrupted.
    Interrupted,
    /// Interrupted before the run started.
    NotRun,
}

/// Where and why a run failed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RunFailure {
    /// Reason.
    pub reason: Reason,
    /// Verdict on the run.
    pub verdict: RunVerdict,
    /// The increment that failed, from 1.
    pub increment: u32,
    /// Load factor of the failed increment.
    pub load: f64,
    /// The major iteration in which it failed, from 1.
    pub major: u32,
    /// Minor iterations of the increment before the failure.
    pub minors: u64,
    /// Loops stopped by a limit that the settings accept.
    pub unsettled: u32,
}

impl Outcome for Run {
    /// About 10,000 increments with 100 monitors.
    const MAX_BYTES: usize = 32 << 20;

    fn is_sound(&self) -> bool {
        let mut rows = std::iter::once(&self.start).chain(&self.rows);
        let failed = self.failed().is_none_or(|failed| failed.load.is_finite());
        failed && rows.all(|row| row.load.is_finite() && row.monitors.iter().all(|x| x.is_finite()))
    }

    fn is_over(&self) -> bool {
        matches!(self.end, CaseEnd::Finished | CaseEnd::Failed(_))
    }
}

impl Run {
    /// The value of a quantity in a row of this run; `None` if the scene has no such monitor.
    pub fn value(&self, row: &Row, quantity: &AxisQuantity) -> Option<f64> {
        match quantity {
            AxisQuantity::Increment => Some(f64::from(row.increment)),
            AxisQuantity::Load => Some(row.load),
            AxisQuantity::Majors => Some(f64::from(row.majors)),
            AxisQuantity::Minors => Some(row.minors as f64),
            AxisQuantity::Monitor(name) => {
                let k = self.monitors.iter().position(|monitor| monitor == name)?;
                row.monitors.get(k).copied()
            }
        }
    }

    /// The last accepted increment, or the start.
    pub fn last(&self) -> &Row {
        self.rows.last().unwrap_or(&self.start)
    }

    /// The failure, if there is one.
    pub fn failed(&self) -> Option<&RunFailure> {
        match &self.end {
            CaseEnd::Failed(failed) => Some(failed),
            _ => None,
        }
    }

    /// Total number of major iterations, including those of a failed increment.
    pub fn majors(&self) -> u64 {
        let accepted: u64 = self.rows.iter().map(|row| u64::from(row.majors)).sum();
        accepted + self.failed().map_or(0, |failed| u64::from(failed.major))
    }

    /// Total number of minor iterations, including those of a failed increment.
    pub fn minors(&self) -> u64 {
        let accepted: u64 = self.rows.iter().map(|row| row.minors).sum();
        accepted + self.failed().map_or(0, |failed| failed.minors)
    }

    /// Increments that jumped to another branch of equilibrium.
    pub fn jumped(&self) -> usize {
        self.rows.iter().filter(|row| row.jumped).count()
    }

    /// Number of increments accepted although a loop had not settled.
    pub fn unsettled(&self) -> usize {
        self.rows.iter().filter(|row| row.unsettled > 0).count()
    }
}
