//! Watches: named quantities of the state that is looked at.

use crate::explain::names;
use crate::history::frame::Frame;
use serde::{Deserialize, Serialize};
use stickslip_core::model::Model;

/// A number of the last minor iteration. Forces and lengths as [`stickslip_core::contact::record::ContactRecord`] has them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename = "Quantity")]
pub enum WatchQuantity {
    /// Gap, length; negative is penetration.
    Gap,
    /// Normal force; compression is positive.
    NormalForce,
    /// Tangential force.
    TangentialForce,
    /// The friction bound T_max, force.
    BoundUpdate,
    /// Slip, length.
    Slip,
    /// How far the node is from switching, force or length.
    Margin,
    /// Relative residual before the present major iteration.
    Residual,
    /// Violation of the interface conditions before it.
    Interface,
}

stickslip_core::words! {
    WatchQuantity, ALL, word:
    Gap "gap",
    NormalForce "f_n",
    TangentialForce "f_t",
    BoundUpdate "t_max",
    Slip "slip",
    Margin "margin",
    Residual "residual",
    Interface "interface",
}

impl WatchQuantity {
    /// Whether it is a slave node's.
    pub fn is_nodal(self) -> bool {
        !matches!(self, WatchQuantity::Residual | WatchQuantity::Interface)
    }
}

/// A watch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Watch {
    /// What the user calls it.
    pub name: String,
    /// What is watched.
    pub quantity: WatchQuantity,
    /// Slave number, where the quantity is a node's.
    pub slave: usize,
}

impl Watch {
    /// A watch with the name that it has where the user gives none: `gap beam.5`.
    pub fn new(model: &Model, quantity: WatchQuantity, slave: usize) -> Watch {
        let name = match quantity.is_nodal() {
            true => format!("{} {}", quantity.word(), names::slave(model, slave)),
            false => quantity.word().into(),
        };
        Watch {
            name,
            quantity,
            slave,
        }
    }

    /// Its value at a whole frame; `None` if nothing was solved for it.
    pub fn value(&self, frame: &Frame) -> Option<f64> {
        let event = frame.event.as_deref()?;
        match self.quantity {
            WatchQuantity::Residual => return Some(event.before.relative),
            WatchQuantity::Interface => return Some(event.before.interface),
            _ => {}
        }
        let found = event.nodes.get(self.slave)?;
        Some(match self.quantity {
            WatchQuantity::Gap => found.gap,
            WatchQuantity::NormalForce => found.f_n,
            WatchQuantity::TangentialForce => found.f_t,
            WatchQuantity::BoundUpdate => found.t_max,
            WatchQuantity::Slip => found.slip,
            _ => found.decision.margin(),
        })
    }
}
