//! Kinds of monitors: those of one kind share a unit and a scale, and can be compared.

use serde::{Deserialize, Serialize};
use stickslip_core::Model;
use stickslip_core::model::{MonitorQuantity, ReportedKind};

/// Kind of a monitor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename = "Kind")]
pub enum MonitorKind {
    /// A displacement or gap.
    Length,
    /// An angle in radians.
    Rotation,
    /// A force.
    Force,
    /// A number of nodes; not compared.
    Count,
    /// A force per area.
    Pressure,
    /// A length that measures an error; not compared.
    Drift,
}

impl MonitorKind {
    /// Whether runs are compared by it.
    pub fn is_compared(self) -> bool {
        !matches!(self, MonitorKind::Drift | MonitorKind::Count)
    }
}

/// The kind of a monitor.
pub fn kind(model: &Model, watched: &MonitorQuantity) -> MonitorKind {
    match watched {
        MonitorQuantity::Displacement { dof } => {
            // The rotation is the third unknown of a node.
            let turns = |n: usize| model.dofs.count[n] == 3 && model.dofs.first[n] + 2 == *dof;
            if (0..model.nodes.len()).any(turns) {
                MonitorKind::Rotation
            } else {
                MonitorKind::Length
            }
        }
        MonitorQuantity::Contact { .. } | MonitorQuantity::Reaction { .. } => MonitorKind::Force,
        MonitorQuantity::Modes { .. } => MonitorKind::Count,
        MonitorQuantity::Drift { .. } => MonitorKind::Drift,
        MonitorQuantity::Pressure { .. } => MonitorKind::Pressure,
        MonitorQuantity::Arc => MonitorKind::Length,
        MonitorQuantity::Reported { kind, .. } => match kind {
            ReportedKind::Length | ReportedKind::Other => MonitorKind::Length,
            ReportedKind::Force => MonitorKind::Force,
            ReportedKind::Pressure => MonitorKind::Pressure,
            ReportedKind::Count => MonitorKind::Count,
        },
    }
}
