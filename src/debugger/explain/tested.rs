//! The quantities that Table 2 tests: their names and dimensions, and how a change of another node affects them.

use super::influence::{Influence, NodePush};
use stickslip_core::{Decision, TestedQuantity};

/// Dimension of a tested quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// A force.
    Force,
    /// A length.
    Length,
    /// A ratio.
    Ratio,
    /// Known only to the strategy.
    Unknown,
}

impl From<TestedQuantity> for Dimension {
    fn from(tested: TestedQuantity) -> Dimension {
        match tested {
            TestedQuantity::NormalForce
            | TestedQuantity::ShearForce
            | TestedQuantity::LeastFriction
            | TestedQuantity::Pressure
            | TestedQuantity::Drag => Dimension::Force,
            TestedQuantity::Slip | TestedQuantity::Room | TestedQuantity::Gap => Dimension::Length,
            TestedQuantity::Cover | TestedQuantity::Change | TestedQuantity::Error => {
                Dimension::Ratio
            }
            TestedQuantity::Own => Dimension::Unknown,
        }
    }
}

impl Dimension {
    /// What a margin is measured by, given the scene's force and length.
    pub fn scale(self, force: f64, length: f64) -> f64 {
        match self {
            Dimension::Force => force,
            Dimension::Length => length,
            Dimension::Ratio | Dimension::Unknown => 1.0,
        }
    }
}

/// The name of a quantity, and of the bound that it is compared with; `None` for 0.
pub fn sides(tested: TestedQuantity) -> (&'static str, Option<&'static str>) {
    match tested {
        TestedQuantity::NormalForce => ("F_n", None),
        TestedQuantity::ShearForce => ("|F_t|", Some("|T_max|")),
        TestedQuantity::Slip => ("slip·sgn T_max", None),
        TestedQuantity::LeastFriction => ("F_t against slip", Some("least")),
        TestedQuantity::Room => ("way", Some("room")),
        TestedQuantity::Gap => ("g", None),
        TestedQuantity::Pressure => ("F_n − k·g", None),
        TestedQuantity::Drag => ("|F_t + k·slip|", Some("limit")),
        TestedQuantity::Cover => ("z", None),
        TestedQuantity::Change => ("change", None),
        TestedQuantity::Error => ("error", None),
        TestedQuantity::Own => ("its own", None),
    }
}

/// The quantity of the test that fired, or otherwise of the first test.
pub fn deciding(decision: &Decision) -> TestedQuantity {
    let tests = || decision.tests.iter().flatten();
    let fired = tests().find(|test| test.margin < 0.0);
    fired
        .or(tests().next())
        .map_or(TestedQuantity::Gap, |test| test.tested)
}

/// The changes that moved a tested quantity, with their effect, largest first.
pub fn effects(tested: TestedQuantity, pushes: &[NodePush]) -> Vec<(&NodePush, f64)> {
    let all = pushes
        .iter()
        .map(|push| (push, effect(tested, &push.influence).1));
    let mut found: Vec<_> = all.filter(|(_, effect)| *effect != 0.0).collect();
    found.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    found
}

/// The effect on a tested quantity, or on the force that decides it, with its symbol.
pub fn effect(tested: TestedQuantity, influence: &Influence) -> (&'static str, f64) {
    match tested {
        TestedQuantity::Gap => ("Δg", influence.gap),
        TestedQuantity::NormalForce
        | TestedQuantity::Pressure
        | TestedQuantity::Cover
        | TestedQuantity::Change
        | TestedQuantity::Error
        | TestedQuantity::Own => ("ΔF_n", influence.f_n),
        TestedQuantity::ShearForce | TestedQuantity::LeastFriction | TestedQuantity::Drag => {
            ("ΔF_t", influence.f_t)
        }
        TestedQuantity::Slip | TestedQuantity::Room => ("Δslip", influence.slip),
    }
}
