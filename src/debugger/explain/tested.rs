//! The quantities that Table 2 tests: their names and dimensions, and how a change of another node affects them.

use super::influence::Influence;
use stickslip_core::contact::table2::{Decision, Tested};

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

impl From<Tested> for Dimension {
    fn from(tested: Tested) -> Dimension {
        match tested {
            Tested::NormalForce
            | Tested::ShearForce
            | Tested::LeastFriction
            | Tested::Pressure
            | Tested::Drag => Dimension::Force,
            Tested::Slip | Tested::Room | Tested::Gap => Dimension::Length,
            Tested::Cover | Tested::Change | Tested::Error => Dimension::Ratio,
            Tested::Own => Dimension::Unknown,
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
pub fn sides(tested: Tested) -> (&'static str, Option<&'static str>) {
    match tested {
        Tested::NormalForce => ("F_n", None),
        Tested::ShearForce => ("|F_t|", Some("|T_max|")),
        Tested::Slip => ("slip·sgn T_max", None),
        Tested::LeastFriction => ("F_t against slip", Some("least")),
        Tested::Room => ("way", Some("room")),
        Tested::Gap => ("g", None),
        Tested::Pressure => ("F_n − k·g", None),
        Tested::Drag => ("|F_t + k·slip|", Some("limit")),
        Tested::Cover => ("z", None),
        Tested::Change => ("change", None),
        Tested::Error => ("error", None),
        Tested::Own => ("its own", None),
    }
}

/// The quantity of the test that fired, or otherwise of the first test.
pub fn deciding(decision: &Decision) -> Tested {
    let tests = || decision.tests.iter().flatten();
    let fired = tests().find(|test| test.margin < 0.0);
    fired
        .or(tests().next())
        .map_or(Tested::Gap, |test| test.tested)
}

/// The effect on a tested quantity, or on the force that decides it, with its symbol.
pub fn effect(tested: Tested, influence: &Influence) -> (&'static str, f64) {
    match tested {
        Tested::Gap => ("Δg", influence.gap),
        Tested::NormalForce
        | Tested::Pressure
        | Tested::Cover
        | Tested::Change
        | Tested::Error
        | Tested::Own => ("ΔF_n", influence.f_n),
        Tested::ShearForce | Tested::LeastFriction | Tested::Drag => ("ΔF_t", influence.f_t),
        Tested::Slip | Tested::Room => ("Δslip", influence.slip),
    }
}
