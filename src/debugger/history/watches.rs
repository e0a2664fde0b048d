//! Watches: named quantities of the shown state.

use crate::Frame;
use crate::explain::names;
use crate::refusal::{Refusal, refusal};
use serde::{Deserialize, Serialize};
use stickslip_core::Model;

stickslip_core::words! {
    /// A quantity of the last minor iteration. Forces and lengths are those of
    /// [`stickslip_core::contact::record::ContactRecord`].
    #[derive(Serialize, Deserialize)]
    #[serde(rename = "Quantity")]
    pub enum WatchQuantity, ALL, word {
        /// Gap (length), negative for penetration.
        Gap "gap",
        /// Normal force; compression is positive.
        NormalForce "f_n",
        /// Tangential force.
        TangentialForce "f_t",
        /// The friction bound T_max, force.
        BoundUpdate "t_max",
        /// Slip, length.
        Slip "slip",
        /// Distance from switching (force or length).
        Margin "margin",
        /// Relative residual at the start of the current major iteration.
        Residual "residual",
        /// Violation of the interface conditions at the same time.
        Interface "interface",
    }
}

impl WatchQuantity {
    /// Whether the quantity belongs to a slave node.
    pub fn is_nodal(self) -> bool {
        !matches!(self, WatchQuantity::Residual | WatchQuantity::Interface)
    }
}

/// A watch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Watch {
    /// Name given by the user.
    pub name: String,
    /// Quantity watched.
    pub quantity: WatchQuantity,
    /// Slave number, for a nodal quantity.
    pub slave: usize,
}

impl Watch {
    /// A watch with the default name, such as `gap beam.5`.
    pub fn new(model: &Model, quantity: WatchQuantity, slave: usize) -> Watch {
        let name = if quantity.is_nodal() {
            format!("{} {}", quantity.word(), names::slave(model, slave))
        } else {
            quantity.word().into()
        };
        Watch {
            name,
            quantity,
            slave,
        }
    }

    /// Its value at a whole frame; `None` if no value has been solved.
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

/// The watches of a session, oldest first.
#[derive(Debug, Default)]
pub struct Watches(Vec<Watch>);

impl Watches {
    /// Adds a watch.
    pub(crate) fn add(&mut self, watch: Watch) -> Result<String, Refusal> {
        if self.0.iter().any(|other| other.name == watch.name) {
            return Err(refusal!(
                "watch '{}' already exists; :unwatch removes it",
                watch.name
            ));
        }
        let reply = format!("watching {}", watch.name);
        self.0.push(watch);
        Ok(reply)
    }

    /// Removes the watch of this name.
    pub(crate) fn remove(&mut self, name: &str) -> Result<String, Refusal> {
        let names: Vec<&str> = self.0.iter().map(|watch| watch.name.as_str()).collect();
        if names.is_empty() {
            return Err(refusal!("there are no watches; :watch adds one"));
        }
        if !names.contains(&name) {
            return Err(refusal!(
                "watch '{name}' does not exist; watches: {}",
                names.join(", ")
            ));
        }
        self.0.retain(|watch| watch.name != name);
        Ok(format!("stopped watching {name}"))
    }

    /// The names of the watches with their values; `None` where no value has been solved.
    pub fn values(&self, frame: &Frame) -> Vec<(&str, Option<f64>)> {
        let value = |watch: &Watch| watch.value(frame);
        self.0
            .iter()
            .map(|watch| (watch.name.as_str(), value(watch)))
            .collect()
    }
}
