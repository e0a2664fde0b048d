//! What monitors are measured in: those of one kind can be compared, and have one scale.

use serde::{Deserialize, Serialize};
use stickslip_core::model::{Model, ToldKind, Watched};

/// What a monitor is: those of one kind have one scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename = "Kind")]
pub enum MonitorKind {
    /// A displacement or gap.
    Length,
    /// An angle, radians.
    Rotation,
    /// A force.
    Force,
    /// A number of nodes, which is not compared.
    Count,
    /// A force by area.
    Pressure,
    /// A length that is a measure of error, and is not compared.
    Drift,
}

impl MonitorKind {
    /// Whether runs are told apart by it.
    pub fn is_compared(self) -> bool {
        !matches!(self, MonitorKind::Drift | MonitorKind::Count)
    }
}

/// What a monitor is.
pub fn kind(model: &Model, watched: &Watched) -> MonitorKind {
    match watched {
        Watched::Displacement { dof } => {
            // The rotation is the third of a node.
            let turns = |n: usize| model.dofs.count[n] == 3 && model.dofs.first[n] + 2 == *dof;
            match (0..model.nodes.len()).any(turns) {
                true => MonitorKind::Rotation,
                false => MonitorKind::Length,
            }
        }
        Watched::Contact { .. } | Watched::Reaction { .. } => MonitorKind::Force,
        Watched::Modes { .. } => MonitorKind::Count,
        Watched::Drift { .. } => MonitorKind::Drift,
        Watched::Pressure { .. } => MonitorKind::Pressure,
        Watched::Arc => MonitorKind::Length,
        Watched::Told { kind, .. } => match kind {
            ToldKind::Length | ToldKind::Other => MonitorKind::Length,
            ToldKind::Force => MonitorKind::Force,
            ToldKind::Pressure => MonitorKind::Pressure,
            ToldKind::Count => MonitorKind::Count,
        },
    }
}
