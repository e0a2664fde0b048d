//! Watches: named quantities of the state that is looked at.

use crate::debug::report;
use crate::debug::session::Frame;
use crate::model::Model;
use serde::{Deserialize, Serialize};

/// A number of the last minor iteration. Forces and lengths as [`crate::contact::record::ContactRecord`] has them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Quantity {
    Gap,
    NormalForce,
    TangentialForce,
    BoundUpdate,
    Slip,
    Margin,
    /// Relative residual before the present major iteration.
    Residual,
    /// Violation of the interface conditions before it.
    Interface,
}

impl Quantity {
    pub const ALL: [Quantity; 8] = [
        Quantity::Gap,
        Quantity::NormalForce,
        Quantity::TangentialForce,
        Quantity::BoundUpdate,
        Quantity::Slip,
        Quantity::Margin,
        Quantity::Residual,
        Quantity::Interface,
    ];

    /// The word for it, as tables call it.
    pub fn word(self) -> &'static str {
        match self {
            Quantity::Gap => "gap",
            Quantity::NormalForce => "f_n",
            Quantity::TangentialForce => "f_t",
            Quantity::BoundUpdate => "t_max",
            Quantity::Slip => "slip",
            Quantity::Margin => "margin",
            Quantity::Residual => "residual",
            Quantity::Interface => "interface",
        }
    }

    /// Whether it is a slave node's.
    pub fn is_nodal(self) -> bool {
        !matches!(self, Quantity::Residual | Quantity::Interface)
    }
}

/// A watch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Watch {
    /// What the user calls it.
    pub name: String,
    pub quantity: Quantity,
    /// Slave number, where the quantity is a node's.
    pub slave: usize,
}

impl Watch {
    /// A watch with the name that it has where the user gives none: `gap beam.5`.
    pub fn new(model: &Model, quantity: Quantity, slave: usize) -> Watch {
        let name = match quantity.is_nodal() {
            true => format!("{} {}", quantity.word(), report::slave(model, slave)),
            false => quantity.word().into(),
        };
        Watch {
            name,
            quantity,
            slave,
        }
    }

    /// Its value at a whole frame; none where nothing was solved for it.
    pub fn value(&self, frame: &Frame) -> Option<f64> {
        let event = frame.event.as_deref()?;
        match self.quantity {
            Quantity::Residual => return Some(event.before.relative),
            Quantity::Interface => return Some(event.before.interface),
            _ => {}
        }
        let found = event.nodes.get(self.slave)?;
        Some(match self.quantity {
            Quantity::Gap => found.gap,
            Quantity::NormalForce => found.f_n,
            Quantity::TangentialForce => found.f_t,
            Quantity::BoundUpdate => found.t_max,
            Quantity::Slip => found.slip,
            _ => found.decision.margin(),
        })
    }
}
