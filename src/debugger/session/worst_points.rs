//! The worst point of the solids in shown states, computed on the background thread: it takes a pass over all elements.

use std::collections::VecDeque;
use std::sync::{Arc, Weak};
use stickslip_core::fem::deformation::deformation;
use stickslip_core::{Model, PointDeformation};

/// Number of displacement fields whose worst points are kept.
const KEPT: usize = 64;

/// Worst points by displacements, latest last; `None` if no point is bad, or while it is being computed.
#[derive(Debug, Default)]
pub(super) struct WorstPoints(VecDeque<(Weak<Vec<f64>>, Option<PointDeformation>)>);

/// The point that is inverted or else furthest outside the range of its law, if any.
pub(super) fn worst_point(model: &Model, u: &[f64]) -> Option<PointDeformation> {
    let found = deformation(model, u)?;
    found.inverted().or(found.outside)
}

impl WorstPoints {
    /// The point at displacements; `None` if nobody asked for it.
    pub(super) fn find(&self, u: &Arc<Vec<f64>>) -> Option<Option<PointDeformation>> {
        let (_, found) = self
            .0
            .iter()
            .rev()
            .find(|(of, _)| of.as_ptr() == Arc::as_ptr(u))?;
        Some(*found)
    }

    /// Stores the result for displacements that were asked for.
    pub(super) fn keep(&mut self, u: &Arc<Vec<f64>>, found: Option<PointDeformation>) {
        self.0.retain(|(of, _)| of.as_ptr() != Arc::as_ptr(u));
        self.0.push_back((Arc::downgrade(u), found));
        if self.0.len() > KEPT {
            self.0.pop_front();
        }
    }
}
