//! `history.arc`: how the path of equilibrium is followed.

use super::described::macros::described;
use serde::{Deserialize, Serialize};
use stickslip_core::model::ArcLength;

described! {
    /// How the path of equilibrium is followed (`control: arc`): every increment goes a given way along it, and the load
    /// factor follows. Sizes are lengths, or those of the monitor that is followed.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    pub struct ArcSpec {
        /// Monitor of a displacement, whose changes are the increments. Default: none, all displacements are followed together,
        /// along the tangent; the size of an increment is the largest displacement on the tangent.
        #[serde(skip_serializing_if = "String::is_empty")]
        pub monitor: String,
        /// Slave node whose net slip is followed instead. Default: none.
        #[serde(skip_serializing_if = "String::is_empty")]
        pub slip: String,
        /// Size of the first increment. Default: what the tangent goes while the load factor moves by `increment`.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub step: Option<f64>,
        /// Largest size of an increment. Default: ten times the first.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub largest: Option<f64>,
        /// Size below which an increment that fails is not cut any more. Default: a 1024th of the first.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub least: Option<f64>,
        /// Major iterations that keep the size: with fewer the next increment is larger, with more it is smaller. Default: 6.
        #[serde(skip_serializing_if = "is_usual")]
        pub iterations: u32,
        /// Arc at which the history ends, the sum of all sizes. Default: ten times the diagonal of the scene.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub length: Option<f64>,
        /// Monitors at whose values the history ends, whichever is met first. Default: none.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        pub ends: Vec<EndSpec>,
    }
}

described! {
    /// A displacement at which a history along the path ends.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct EndSpec {
        /// Name of the monitor, which is that of a displacement.
        pub monitor: String,
        /// Its value there.
        pub at: f64,
    }
}

fn is_usual(iterations: &u32) -> bool {
    *iterations == ArcLength::ITERATIONS
}

impl Default for ArcSpec {
    fn default() -> Self {
        ArcSpec {
            monitor: String::new(),
            slip: String::new(),
            step: None,
            largest: None,
            least: None,
            iterations: ArcLength::ITERATIONS,
            length: None,
            ends: Vec::new(),
        }
    }
}

impl ArcSpec {
    /// Whether it is what a scene that does not name it has.
    pub fn is_default(&self) -> bool {
        *self == ArcSpec::default()
    }
}
