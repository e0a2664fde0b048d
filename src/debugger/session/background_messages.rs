//! What the session and its background thread send each other.

use super::exports::Export;
use crate::explain::influence::PushPath;
use crate::explain::reported_pushes::Iterations;
use crate::refusal::Refusal;
use crate::{DiagnosisPage, NodePush, RemedyTrial, ReportedIterations};
use std::sync::Arc;
use stickslip_core::{PointDeformation, State};

/// Position: branch, and step on its line.
pub type LinePlace = (usize, usize);

pub(super) enum BackgroundRequest {
    /// The last value is whether they may be costly.
    Pushes(LinePlace, usize, BetweenRuns, bool),
    WorstPoint(Arc<Vec<f64>>),
    Examination(LinePlace, Box<State>, Vec<usize>, Reported),
    Remedies(Box<State>),
    Export(Export),
}

/// What a line shows about an attached solver; for our own, the warnings of the run up to a failed state.
#[derive(Default)]
pub(super) struct Reported {
    /// How it failed or what law the accepted state breaks, and whether its modes repeat.
    pub findings: Vec<String>,
    /// Whether modes repeat or keep changing.
    pub changing: bool,
    /// The latest minor iterations of the frozen problem.
    pub iterations: ReportedIterations,
}

/// The two minor iterations whose difference is the push on a node.
pub(super) enum BetweenRuns {
    /// Steps to repeat to reach them again.
    Path(PushPath),
    /// Both iterations as reported by an attached solver.
    Reported(Iterations),
}

pub(super) enum BackgroundReply {
    Pushes(LinePlace, usize, Option<Vec<NodePush>>),
    /// The pushes at this position need a large solver.
    Costly(LinePlace),
    WorstPoint(Arc<Vec<f64>>, Option<PointDeformation>),
    /// The solver was busy.
    NotNow,
    /// The examination so far (`going_on`) or complete.
    Examination {
        place: LinePlace,
        nodes: Vec<usize>,
        found: Option<Box<DiagnosisPage>>,
        going_on: bool,
    },
    Trying {
        all: usize,
        now: String,
    },
    Trial(Box<RemedyTrial>),
    Done {
        stopped: bool,
    },
    Exported(Result<String, Refusal>),
}
