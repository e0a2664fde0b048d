//! Line search of the semismooth Newton method ([`crate::strategy`]), for minor iterations that cycle with full steps.
//!
//! A minor iteration solves for the modes at the current point z, which gives the Newton point z'. The next point is
//! z + α (z' − z) with the first α of 1, 1/2, 1/4, ... that reduces the natural map (the projection equations' error, Pang, Math.
//! Oper. Res. 15, 1990); if none does, α is 1.

use crate::{Cycle, Friction, NodeIncrement};
use serde::{Deserialize, Serialize};

/// Number of halvings of a step.
const HALVINGS: u32 = 10;
/// Fraction of the error per unit of α by which a step must reduce it.
const LEAST: f64 = 1e-4;

/// State of a line search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LineSearch {
    /// The cycle of the full steps.
    pub cycle: Cycle,
    /// The current point, one entry per contact; empty before the first step.
    at: Vec<NodeIncrement>,
}

impl LineSearch {
    /// Before the first step.
    pub fn new(cycle: Cycle) -> Self {
        let at = Vec::new();
        LineSearch { cycle, at }
    }

    /// The current point of a contact.
    pub fn at(&self, contact: usize) -> NodeIncrement {
        self.at.get(contact).copied().unwrap_or_default()
    }

    /// Steps towards the Newton point `to`, with the squared natural map `error`; returns α. The first step is full.
    pub fn step(&mut self, to: Vec<NodeIncrement>, error: impl Fn(&[NodeIncrement]) -> f64) -> f64 {
        let before = error(&self.at);
        let mut part = 1.0;
        for _ in 0..=HALVINGS {
            let point = self.between(&to, part);
            if self.at.is_empty() || error(&point) <= (1.0 - LEAST * part) * before {
                self.at = point;
                return part;
            }
            part /= 2.0;
        }
        self.at = to;
        1.0
    }

    fn between(&self, to: &[NodeIncrement], part: f64) -> Vec<NodeIncrement> {
        if self.at.is_empty() || part == 1.0 {
            return to.to_vec();
        }
        let mix = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|k| a[k] + part * (b[k] - a[k]));
        self.at
            .iter()
            .zip(to)
            .map(|(from, to)| NodeIncrement {
                force: mix(from.force, to.force),
                motion: mix(from.motion, to.motion),
            })
            .collect()
    }
}

/// The squared natural map of a contact (force²), with the stiffness `spring` that relates lengths to forces.
pub fn natural_map([f_n, f_t, gap, slip]: [f64; 4], friction: &Friction, spring: f64) -> f64 {
    let pressure = (f_n - spring * gap).max(0.0);
    let limit = if pressure > 0.0 {
        friction.limit(pressure)
    } else {
        0.0
    };
    let normal = f_n - pressure;
    let tangential = f_t - (f_t + spring * slip).clamp(-limit, limit);
    normal * normal + tangential * tangential
}
