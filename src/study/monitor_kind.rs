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

use MonitorKind::*;

impl MonitorKind {
    /// Whether runs are compared by it.
    pub fn is_compared(self) -> bool {
        !matches!(self, Drift | Count)
    }
}

/// The kind of a monitor.
pub fn kind(model: &Model, watched: &MonitorQuantity) -> MonitorKind {
    match watched {
        MonitorQuantity::Displacement { dof } => {
            // The rotation is the third unknown of a node.
            match model.dofs.node_of(*dof) {
                Some((_, 2)) => Rotation,
                _ => Length,
            }
        }
        MonitorQuantity::Contact { .. } | MonitorQuantity::Reaction { .. } => Force,
        MonitorQuantity::Modes { .. } => Count,
        MonitorQuantity::Drift { .. } => Drift,
        MonitorQuantity::Pressure { .. } => Pressure,
        MonitorQuantity::Arc => Length,
        MonitorQuantity::Reported { kind, .. } => match kind {
            ReportedKind::Length | ReportedKind::Other => Length,
            ReportedKind::Force => Force,
            ReportedKind::Pressure => Pressure,
            ReportedKind::Count => Count,
        },
    }
}
