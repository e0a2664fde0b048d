//! `history.arc`: arc-length control.

use super::described::macros::described;
use stickslip_core::model::ArcLength;

described! {
    /// Arc-length control (`control: arc`): every increment advances a given distance along the equilibrium path, and the load
    /// factor is an unknown. Sizes are lengths, or in the unit of the followed monitor.
    #[serde(default)]
    pub struct ArcSpec {
        /// Displacement monitor whose changes define the increments. Default: none, all displacements are followed together along
        /// the tangent, and the size of an increment is the largest displacement along it.
        #[serde(skip_serializing_if = "String::is_empty")]
        pub monitor: String,
        /// Slave node whose net slip is followed instead. Default: none.
        #[serde(skip_serializing_if = "String::is_empty")]
        pub slip: String,
        /// Size of the first increment. Default: the change along the tangent for one `increment` of the load factor.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub step: Option<f64>,
        /// Maximum size of an increment. Default: ten times the first.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub largest: Option<f64>,
        /// Size below which a failing increment is no longer cut. Default: 1/1024 of the first.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub least: Option<f64>,
        /// Target number of major iterations: with fewer, the next increment is larger; with more, smaller. Default: 6.
        #[serde(skip_serializing_if = "is_usual")]
        pub iterations: u32,
        /// Total arc (the sum of all sizes) at which the history ends. Default: ten times the diagonal of the scene.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub length: Option<f64>,
        /// Monitor values that end the history; the first one reached counts. Default: none.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        pub ends: Vec<EndSpec>,
    }
}

described! {
    /// A displacement that ends an arc-length history.
    pub struct EndSpec {
        /// Name of a displacement monitor.
        pub monitor: String,
        /// Value at which the history ends.
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
    /// Whether this is the default, which scenes may omit.
    pub fn is_default(&self) -> bool {
        *self == ArcSpec::default()
    }
}
