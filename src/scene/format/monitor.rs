//! `monitors`: the quantities that a scene reports.

use super::described::macros::described;
use stickslip_core::Mode;
use stickslip_core::model::{Axis, Component};

described! {
    /// A quantity to report after every converged increment.
    pub struct MonitorSpec {
        /// Column name in `--csv`.
        pub name: String => name,
        /// The reported quantity.
        pub of: Quantity,
    }
}

described! {
    /// The quantity that a monitor reports.
    pub enum Quantity {
        /// A displacement (or rotation) of a node.
        Displacement {
            /// Name of the node.
            node: String,
            /// The reported degree of freedom.
            component: Component,
        },
        /// The contact force on one slave node or on all slave nodes together.
        Contact {
            /// Name of the slave node. Default: all of them together.
            #[serde(default)]
            node: Option<String>,
            /// The reported component.
            component: Axis,
        },
        /// The support force at a restrained degree of freedom.
        Reaction {
            /// Name of the node.
            node: String,
            /// The restrained degree of freedom.
            component: Component,
        },
        /// The number of slave nodes in a mode.
        Modes {
            /// The mode: free, sliding or fixed.
            mode: Mode,
        },
        /// The contact pressure F_n / A of one slave node, with its undeformed tributary area A, or the largest of all.
        Pressure {
            /// Name of the slave node. Default: the one with the largest pressure.
            #[serde(default)]
            node: Option<String>,
        },
        /// The contact shear F_t / A of one slave node along t, or the one with the largest magnitude.
        Shear {
            /// Name of the slave node. Default: the one with the largest magnitude.
            #[serde(default)]
            node: Option<String>,
        },
        /// Distance of a stuck slave node from its stick point along the surface (length, with the sign of slip; 0 if it slides
        /// or is free), or the one with the largest magnitude. The elastic slip of a pair with `stick` does not count.
        Drift {
            /// Name of the slave node. Default: the one with the largest drift.
            #[serde(default)]
            node: Option<String>,
        },
    }
}
