//! `monitors`: the numbers that a scene reports.

use super::described::macros::described;
use serde::{Deserialize, Serialize};
use stickslip_core::model::{Axis, Component, Mode};

described! {
    /// A number to report after every converged increment.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct MonitorSpec {
        /// Column name in `--csv`.
        pub name: String => name,
        /// What is reported.
        pub of: Quantity,
    }
}

described! {
    /// What a monitor reports.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub enum Quantity {
        /// A displacement (or rotation) of a node.
        Displacement {
            /// Name of the node.
            node: String,
            /// Along which degree of freedom.
            component: Component,
        },
        /// The interaction force on one slave node, or on all of them together.
        Contact {
            /// Name of the slave node. Default: all of them together.
            #[serde(default)]
            node: Option<String>,
            /// Along which axis.
            component: Axis,
        },
        /// The force of the support at a restrained degree of freedom.
        Reaction {
            /// Name of the node.
            node: String,
            /// Along which degree of freedom.
            component: Component,
        },
        /// How many slave nodes have a mode.
        Modes {
            /// The mode: free, sliding or fixed.
            mode: Mode,
        },
        /// The contact pressure F_n / A of one slave node, with its undeformed tributary area A, or the largest of all.
        Pressure {
            /// Name of the slave node. Default: the one where it is largest.
            #[serde(default)]
            node: Option<String>,
        },
        /// The contact shear F_t / A of one slave node, along t, or that of all which is largest in size.
        Shear {
            /// Name of the slave node. Default: the one where it is largest in size.
            #[serde(default)]
            node: Option<String>,
        },
        /// How far one slave node that sticks has gone along its surface from the point where it stuck (length, with the
        /// sign of slip; 0 where it slides or is free), or that of all which has gone furthest.
        Drift {
            /// Name of the slave node. Default: the one that has gone furthest.
            #[serde(default)]
            node: Option<String>,
        },
    }
}
